"""Write the firmware package of a mission: C99, its origin, its vectors, an example, adapters."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hoverproof import checker
from hoverproof.errors import InputError
from hoverproof.export.contents import Standing, contents
from hoverproof.export.flight_law import flight_law
from hoverproof.export.names import package_name
from hoverproof.export.precision import PRECISIONS
from hoverproof.files import write_text
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.version import __version__

ADAPTERS = {
    "adapters/crazyflie/controller_{name}.c": "crazyflie.c.j2",
    "adapters/crazyflie/Kbuild": "crazyflie.kbuild.j2",
    "adapters/px4/{name}_module.cpp": "px4.cpp.j2",
    "adapters/px4/CMakeLists.txt": "px4.cmake.j2",
    "adapters/ardupilot/AC_CustomControl_{name}.cpp": "ardupilot.cpp.j2",
    "adapters/ardupilot/AC_CustomControl_{name}.h": "ardupilot.h.j2",
    "adapters/README.md": "adapters.md.j2",
}
FILES = {
    "{name}.h": "firmware.h.j2",
    "{name}.c": "firmware.c.j2",
    "{name}_params.h": "params.h.j2",
    "{name}_selftest.c": "selftest.c.j2",
    "example/main.c": "main.c.j2",
    "example/vehicle.h": "vehicle.h.j2",
    "example/vehicle.c": "vehicle.c.j2",
    "CMakeLists.txt": "CMakeLists.txt.j2",
    "README.md": "README.md.j2",
    **ADAPTERS,
}

STACK_BUDGET = 160
"""Bytes of stack that a step may take on a Cortex-M4F, in float32."""


class NotCertified(Exception):
    """Firmware was asked for, but its gains are refuted or undecided.

    Parameters
    ----------
    mission : str
        Name of the mission.
    status : str
        ``"refuted"`` or ``"undecided"``.
    why : str, optional
        What is wrong; by default that the gains have this status.
    """

    def __init__(self, mission: str, status: str, why: str | None = None) -> None:
        self.status = status
        super().__init__(
            f"{mission}: {why or f'the gains are {status}'}, so no firmware is written "
            f"(see `hoverproof certify`; --allow-uncertified writes a package that says so)"
        )


def write_package(
    mission: Mission,
    out: str | Path,
    standing: Standing,
    *,
    precision: str = "float32",
    sensing: str = "points",
    tunable: bool = False,
    name: str | None = None,
    rotor_limits: tuple[Fraction, Fraction] | None = None,
    law: Law = HAMEL_MAHONY,
) -> dict[str, Any]:
    """Write the package and return its manifest.

    Parameters
    ----------
    mission : Mission
    out : str or Path
        Folder to write to; made if needed. A package in it is replaced, files of other names stay.
    standing : Standing
        The certificate, which is checked here once more, or none.
    precision : {"float32", "float64"}
    sensing : {"points", "centroid"}
        What the camera delivers.
    tunable : bool
        Keep the gains as parameters.
    name : str, optional
        Prefix of every file and symbol, a C identifier of up to 20 characters that is not taken
        (see `hoverproof.export.names`); by default made of the mission's name.
    rotor_limits : (low, high), optional
        Thrust of one rotor, N; by default as the mission's rotors have, else 0 to half the
        weight.
    law : Law
        What the firmware computes; by default the law of the paper.

    Raises
    ------
    InputError
        If an argument cannot be used, or the folder cannot be written to or holds files of no
        package by the names of ours.
    checker.Rejected
        If the certificate does not prove that the gains of this mission work with this law.
    """
    if precision not in PRECISIONS:
        raise InputError("--precision", "", f"must be float32 or float64, not {precision!r}")
    if sensing not in ("points", "centroid"):
        raise InputError("--sensing", "", f"must be points or centroid, not {sensing!r}")
    if standing.certificate is not None:
        own = law == HAMEL_MAHONY
        checker.require(own, f"the certificate is about the paper's law, not about {law.name}")
        standing = replace(standing, thrust=_check(standing.certificate, mission))
    limits = _rotor_limits(mission, rotor_limits)
    context = contents(
        mission,
        standing,
        PRECISIONS[precision],
        flight_law(mission, sensing=sensing, tunable=tunable, law=law),
        package_name(name, mission.name),
        {
            "sensing": sensing,
            "tunable": tunable,
            "rotor_limits": limits,
            "rotor_limits_from": _origin_of_limits(mission, given=rotor_limits is not None),
        },
    )
    prefix = context["name"]
    texts = {
        path.format(name=prefix): _templates().get_template(template).render(context)
        for path, template in FILES.items()
    }
    if standing.certificate is not None:
        sealed = json.dumps(dict(standing.certificate), indent=2, ensure_ascii=False) + "\n"
        texts[context["certificate_file"]] = sealed
    manifest = _manifest(context, texts)
    texts["manifest.json"] = json.dumps(manifest, indent=2, ensure_ascii=False) + "\n"
    folder = Path(out)
    foreign = (
        [] if (folder / "manifest.json").exists() else [p for p in texts if (folder / p).exists()]
    )
    if foreign:
        reason = f"holds a {foreign[0]} that is of no package; give a folder of its own"
        raise InputError(str(out), "", reason)
    for path, text in texts.items():  # the manifest last: it stands for the whole
        try:
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(str(out), "", f"cannot be made: {error.strerror}") from None
        write_text(folder / path, text)
    return manifest


def _check(certificate: Mapping[str, Any], mission: Mission) -> tuple[Fraction, Fraction]:
    """Check a certificate and return the interval of thrusts that it is about, N."""
    checker.check(certificate)
    checker.require(certificate["kind"] == "gains", "this is no certificate of gains")
    same = certificate["mission"] == mission.exact()
    checker.require(same, "the certificate is about another mission")
    low, high = checker.read_gains(certificate).thrust
    return low, high


def _rotor_limits(
    mission: Mission, limits: tuple[Fraction, Fraction] | None
) -> tuple[Fraction, Fraction]:
    weight, rotors = mission.vehicle.weight, mission.rotors
    low, high = limits or (rotors.min_thrust or Fraction(0), rotors.max_thrust or weight / 2)
    if not 0 <= low < weight / 4 < high <= weight * 5 / 2:
        where = ("--rotor-limits", "") if limits else (mission.source, "rotors")
        raise InputError(
            *where,
            f"must hold the share of a rotor in hover, {float(weight / 4):g} N, be at least 0 and "
            f"at most 2.5 times the weight, not [{float(low):g}, {float(high):g}] N",
        )
    return low, high


def _origin_of_limits(mission: Mission, *, given: bool) -> str:
    """Say where the limits of the rotors come from, for who flashes the package."""
    low, high = mission.rotors.min_thrust, mission.rotors.max_thrust
    if given:
        return "given to the export"
    if high is None:
        half = "half the weight" if low is None else "half the weight at most"
        return f"an assumption: {half}; the mission does not say"
    return "from [rotors] of the mission" + ("" if low is not None else ", which names no lowest")


@cache
def _templates() -> Any:
    import jinja2

    return jinja2.Environment(
        loader=jinja2.PackageLoader("hoverproof.export"),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        autoescape=False,
    )


def _manifest(context: dict[str, Any], texts: Mapping[str, str]) -> dict[str, Any]:
    box, n = context["box"], context["points"]
    return {
        "format": "hoverproof firmware",
        "version": 1,
        "name": context["name"],
        "mission": context["mission"].exact(),
        "certified": context["certified"],
        "eigenvalue_bounds": context["eigenvalue_bounds"],
        "certificate_sha256": context["certificate_sha256"] if context["certified"] else None,
        "law_sha256": context["law_sha256"],
        "precision": context["precision"].name,
        "sensing": context["sensing"],
        "tunable": context["tunable"],
        "tools": {"hoverproof": __version__, "casadi": version("casadi")},
        "thrust": [float(t) for t in context["thrust"]],
        "tilt_cosine": float(context["tilt_cosine"]),
        "rotor_limits": [float(r) for r in context["rotor_limits"]],
        "rotor_limits_from": context["rotor_limits_from"],
        "input_box": box.as_json(context["sensing"], n),
        "budgets": {
            "target": "Cortex-M4F, float32, gcc -O2 -fno-math-errno -ffp-contract=off",
            "instructions": _instruction_budget(context),
            "stack_bytes": STACK_BUDGET,
            "flash_bytes": _flash_budget(context),
        },
        "files": {
            path: hashlib.sha256(text.encode()).hexdigest() for path, text in sorted(texts.items())
        },
    }


def _instruction_budget(context: dict[str, Any]) -> int:
    """Most instructions of a step: a part for each point, one for each number, and the rest."""
    points: int = 12 * context["points"] if context["sensing"] == "points" else 0
    return points + 4 * _numbers(context) + 175


def _flash_budget(context: dict[str, Any]) -> int:
    """Most bytes of code and constants of NAME.c, without the self-test."""
    points: int = 40 * context["points"] if context["sensing"] == "points" else 0
    tuning = 900 if context["tunable"] else 0
    return points + 25 * _numbers(context) + 1400 + tuning


def _numbers(context: dict[str, Any]) -> int:
    """Return how many numbers the law has."""
    return len({**context["coefficients"], **context["tuned"]})
