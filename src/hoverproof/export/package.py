"""Write the firmware package of a mission: C99, its origin, its vectors, an example, adapters."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hoverproof.errors import InputError
from hoverproof.export.contents import Contents, contents
from hoverproof.export.flight_law import flight_law
from hoverproof.export.heading import check_sees_points
from hoverproof.export.names import package_name
from hoverproof.export.options import Options
from hoverproof.export.standing import Standing, checked
from hoverproof.export.targets import TARGETS, titles
from hoverproof.files import write_text
from hoverproof.mission import arguments
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import choices_of
from hoverproof.servo.laws.heading import flown_law
from hoverproof.version import __version__

FILES = {
    "{name}.h": "templates/firmware.h.j2",
    "{name}.c": "templates/firmware.c.j2",
    "{name}_params.h": "templates/params.h.j2",
    "{name}_selftest.c": "templates/selftest.c.j2",
    "example/main.c": "templates/main.c.j2",
    "example/vehicle.h": "templates/vehicle.h.j2",
    "example/vehicle.c": "templates/vehicle.c.j2",
    "CMakeLists.txt": "templates/CMakeLists.txt.j2",
    "README.md": "templates/README.md.j2",
    "adapters/README.md": "templates/adapters.md.j2",
}
"""The template of each file; those of `TARGETS` come to these."""

CAMERA_FILES = {
    "{name}_camera.h": "templates/camera.h.j2",
    "{name}_camera.c": "templates/camera.c.j2",
}
"""Those of a package that keeps the frames of a camera."""

LENS_FILES = {
    "{name}_lens.h": "templates/lens.h.j2",
    "{name}_lens.c": "templates/lens.c.j2",
}
"""Those of a package that takes raw pixels."""

STACK_BUDGET = 160
"""Bytes of stack that a step may take on a Cortex-M4F, in float32."""


class NotCertified(Exception):
    """Firmware was asked for, but nothing is proved of its mission.

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
            f"(see `hoverproof certify`; --certificate takes a proof of `hoverproof attraction`, "
            "--allow-uncertified writes a package that says so)"
        )


@arguments.checked
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
    camera: bool = False,
    pixels: bool = False,
    interface: str | None = None,
    law: Law | None = None,
) -> dict[str, Any]:
    """Write the package and return its manifest.

    Parameters
    ----------
    mission : Mission
    out : str or Path
        Folder to write to; made if needed. A package in it is replaced, files of other names stay.
    standing : Standing
        The certificates, which are checked here once more, or none.
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
    camera : bool
        Keep the newest frame of a slow camera, and turn it with the gyroscope from step to step.
    pixels : bool
        Let the glue for autopilots take raw pixels, seen through the mission's lens.
    interface : {"torques", "rates"}, optional
        What is commanded; by default body rates and thrust where the mission has the bandwidth of a
        rate loop, `interface.rate_bandwidth`.
    law : Law, optional
        What the firmware computes; by default the law of the mission.

    Raises
    ------
    InputError
        If an argument cannot be used, or the folder cannot be written to or holds files of no
        package by the names of ours.
    checker.Rejected
        If a certificate does not prove that the gains of this mission work with this law.
    """
    options = Options.of(
        mission,
        precision=precision,
        sensing=sensing,
        tunable=tunable,
        rotor_limits=rotor_limits,
        camera=camera,
        pixels=pixels,
        interface=interface,
    )
    law = (law or flown_law(mission)).flying(mission)
    check_sees_points(law, options)
    standing = checked(standing, mission, law)
    sensing, rates = options.sensing, options.rates
    flown = flight_law(mission, sensing=sensing, tunable=tunable, law=law, rates=rates)
    filled = contents(mission, standing, flown, package_name(name, mission.name), options)
    texts = _rendered(filled)
    texts |= standing.texts(filled.name)
    manifest = _manifest(filled, texts, law)
    texts["manifest.json"] = json.dumps(manifest, indent=2, ensure_ascii=False) + "\n"
    _write(out, texts)
    return manifest


@arguments.checked
def check_options(
    mission: Mission,
    *,
    precision: str = "float32",
    sensing: str = "points",
    tunable: bool = False,
    name: str | None = None,
    **more: Any,
) -> None:
    """Refuse what `write_package` would.

    Parameters
    ----------
    mission : Mission
    precision, sensing, tunable, name, **more
        As there.

    Raises
    ------
    InputError
        If one of them cannot be used.
    """
    given: dict[str, Any] = {"rotor_limits": None, **more}
    Options.of(mission, precision=precision, sensing=sensing, tunable=tunable, **given)
    package_name(name, mission.name)


def _write(out: str | Path, texts: Mapping[str, str]) -> None:
    """Write the files of a package; the manifest comes last, as it stands for the whole."""
    folder = Path(out)
    foreign = (
        [] if (folder / "manifest.json").exists() else [p for p in texts if (folder / p).exists()]
    )
    if foreign:
        reason = f"holds a {foreign[0]} that is of no package; give a folder of its own"
        raise InputError(str(out), "", reason)
    for path, text in texts.items():
        try:
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(str(out), "", f"cannot be made: {error.strerror}") from None
        write_text(folder / path, text)


@cache
def _templates() -> Any:
    from hoverproof.templates import templates

    return templates("hoverproof.export", ".", autoescape=False)


def _rendered(filled: Contents) -> dict[str, str]:
    """Fill the templates; return the texts by their paths, without those that come out empty."""
    files = FILES | (CAMERA_FILES if filled.camera else {}) | (LENS_FILES if filled.lens else {})
    targets = () if filled.options.rates else TARGETS
    for target in targets:
        files |= target.files()
    named = {
        **vars(filled),
        "points": filled.points,
        "centroid_words": filled.centroid_words,
        "in_order": filled.in_order,
        "tells_gains": filled.tells_gains,
        "keeps_rotor_limits": filled.keeps_rotor_limits,
        "lit": filled.options.precision.lit,
        "braces": filled.options.precision.braces,
        "targets": targets,
        "target_titles": titles(targets),
    }
    texts = {
        path.format(name=filled.name): _templates().get_template(template).render(named)
        for path, template in files.items()
    }
    return {path: text for path, text in texts.items() if text.strip()}


def _whole(mission: Mission) -> float:
    """Return the sum of the weights, which is the number of points if each counts once."""
    whole = mission.target.whole
    return len(mission.target.points) if mission.target.weights is None else float(whole)


def _manifest(filled: Contents, texts: Mapping[str, str], law: Law) -> dict[str, Any]:
    options, limits, evidence = filled.options, filled.limits, filled.evidence
    return {
        "format": "hoverproof firmware",
        "version": 1,
        "name": filled.name,
        "mission": filled.mission.exact(),
        "law": choices_of(law),
        "certified": evidence.certified,
        "eigenvalue_bounds": evidence.eigenvalue_bounds,
        "certificate_sha256": evidence.sha256 if evidence.certified else None,
        "theorems": {str(proof.theorem): proof.sha256 for proof in evidence.proofs},
        "covers": list(evidence.covers),
        "law_sha256": filled.law.sha256,
        "precision": options.precision.name,
        "sensing": options.sensing,
        **({"camera": options.camera} if options.camera else {}),
        **({"lens": filled.lens.model} if filled.lens else {}),
        **({"pixels": True} if options.pixels else {}),
        **({"rate_bandwidth": filled.rate_bandwidth} if filled.rate_bandwidth else {}),
        "tunable": options.tunable,
        "tools": {"hoverproof": __version__, "casadi": version("casadi")},
        "thrust": [float(t) for t in limits.thrust],
        "commanded_thrust": [float(t) for t in limits.commanded],
        "tilt_cosine": float(limits.tilt_cosine),
        "rotor_limits": [float(r) for r in options.rotor_limits],
        **(
            {"each_rotor": [[float(end) for end in ends] for ends in options.each_rotor]}
            if options.rotors_differ
            else {}
        ),
        "rotor_limits_from": options.rotor_limits_from,
        "rotor_limits_kept": filled.keeps_rotor_limits,
        "input_box": limits.box.as_json(options.sensing, _whole(filled.mission)),
        "budgets": {
            "target": "Cortex-M4F, float32, gcc -O2 -fno-math-errno -ffp-contract=off",
            "instructions": _instruction_budget(filled),
            "stack_bytes": STACK_BUDGET,
            "flash_bytes": _flash_budget(filled),
        },
        "files": {
            path: hashlib.sha256(text.encode()).hexdigest() for path, text in sorted(texts.items())
        },
    }


def _instruction_budget(filled: Contents) -> int:
    """Most instructions of a step: a part for each point, one for each number, and the rest."""
    points = 12 * filled.points if filled.options.of_points else 0
    felt, sized = 50 if filled.law.lift else 0, 24 + points if filled.law.spread else 0
    headed, rates = 16 if filled.law.heading else 0, 20 if filled.options.rates else 0
    return points + 4 * filled.law.numbers + 175 + felt + sized + headed + rates


def _flash_budget(filled: Contents) -> int:
    """Most bytes of code and constants of NAME.c, without the self-test."""
    points = 40 * filled.points if filled.options.of_points else 0
    tuning = 180 * len(filled.design.gains) if filled.options.tunable else 0
    felt, sized = 100 if filled.law.lift else 0, 60 + points if filled.law.spread else 0
    headed = 60 if filled.law.heading else 0
    seen = 120 * filled.points + 200 if filled.law.seen_heading else 0
    seen += 500 if filled.options.rates else 0
    return points + 25 * filled.law.numbers + 1400 + tuning + felt + sized + headed + seen
