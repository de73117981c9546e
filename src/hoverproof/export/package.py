"""Write the firmware package of a mission: C99, its origin, its vectors, an example, adapters."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import hoverproof
from hoverproof import checker
from hoverproof.algebra.decimals import decimal_below
from hoverproof.algebra.graph import fingerprint
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.errors import InputError
from hoverproof.export.emitter import literals, statements
from hoverproof.export.flight_law import GAINS, FlightLaw, flight_law
from hoverproof.export.precision import PRECISIONS, Precision
from hoverproof.export.vectors import InputBox, test_vectors
from hoverproof.export.vehicle import rate_function, sense_function
from hoverproof.files import write_text
from hoverproof.mission import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.plant.rotors import ROTORS

ADAPTERS = {
    "adapters/crazyflie/controller_{name}.c": "crazyflie.c.j2",
    "adapters/crazyflie/Makefile": "crazyflie.mk.j2",
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


@dataclass(frozen=True)
class Standing:
    """What is known of a mission before its firmware is written.

    Attributes
    ----------
    thrust : (low, high)
        Interval of T that is assumed in flight, N; a certificate has its own, which takes its place.
    certificate : mapping, optional
        Content of a gain certificate; without one, every file says that nothing is proved.
    """

    thrust: tuple[Fraction, Fraction]
    certificate: Mapping[str, Any] | None = None


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
) -> dict[str, Any]:
    """Write the package and return its manifest.

    Parameters
    ----------
    mission : Mission
    out : str or Path
        Folder to write to; made if needed. Files of other names in it stay.
    standing : Standing
        The certificate, which is checked here once more, or none.
    precision : {"float32", "float64"}
    sensing : {"points", "centroid"}
        What the camera delivers.
    tunable : bool
        Keep the gains as parameters.
    name : str, optional
        Prefix of every file and symbol, a C identifier of up to 20 characters; by default made of
        the mission's name.
    rotor_limits : (low, high), optional
        Thrust of one rotor, N; by default 0 to half the weight.

    Raises
    ------
    InputError
        If an argument cannot be used or the folder cannot be written to.
    checker.Rejected
        If the certificate does not prove that the gains of this mission work.
    """
    if precision not in PRECISIONS:
        raise InputError("--precision", "", f"must be float32 or float64, not {precision!r}")
    if sensing not in ("points", "centroid"):
        raise InputError("--sensing", "", f"must be points or centroid, not {sensing!r}")
    if standing.certificate is not None:
        standing = replace(standing, thrust=_check(standing.certificate, mission))
    limits = _rotor_limits(mission, rotor_limits)
    context = _context(
        mission,
        standing,
        PRECISIONS[precision],
        flight_law(mission, sensing=sensing, tunable=tunable),
        _prefix(mission, name),
        {"sensing": sensing, "tunable": tunable, "rotor_limits": limits},
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
    low, high = checker.read_mission(certificate).thrust
    return low, high


def _prefix(mission: Mission, name: str | None) -> str:
    prefix = name if name is not None else re.sub(r"\W", "_", mission.name, flags=re.A).lower()
    if name is None and prefix[0].isdigit():
        prefix = f"m{prefix}"
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,19}", prefix, re.A):
        raise InputError(
            "--name", "", f"must be a C identifier of up to 20 characters, not {prefix!r}"
        )
    return prefix


def _rotor_limits(
    mission: Mission, limits: tuple[Fraction, Fraction] | None
) -> tuple[Fraction, Fraction]:
    weight = mission.vehicle.weight
    low, high = limits or (Fraction(0), weight / 2)
    if not 0 <= low < weight / 4 < high <= weight * 5 / 2:
        raise InputError(
            "--rotor-limits",
            "",
            f"must hold the share of a rotor in hover, {float(weight / 4):g} N, be at least 0 and at "
            f"most 2.5 times the weight, not [{float(low):g}, {float(high):g}] N",
        )
    return low, high


@cache
def _templates() -> Any:
    import jinja2

    return jinja2.Environment(
        loader=jinja2.PackageLoader("hoverproof.export"),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        autoescape=False,
    )


def _context(
    mission: Mission,
    standing: Standing,
    precision: Precision,
    law: FlightLaw,
    name: str,
    options: dict[str, Any],
) -> dict[str, Any]:
    weight, n = mission.vehicle.weight, len(mission.target.points)
    goal = hover_goal(mission).centroid_midpoint
    low, high = (thrust - weight for thrust in standing.thrust)
    if mission.bounds.level is not None:  # |F| <= reach, and its horizontal part is m g sin(tilt)
        sine = (standing.thrust[1] - weight) / weight
        cosine = decimal_below(sqrt_enclosure(max(1 - sine**2, Fraction(0)))[0], 9)
        tilt_words = f"{math.degrees(math.acos(float(cosine))):.4g} degrees (follows from the level)"
    else:
        cosine = Fraction(0)
        tilt_words = "90 degrees (the certificate sets no bound of its own)"
    certified = standing.certificate is not None
    sha = standing.certificate["sha256"] if standing.certificate is not None else "none"
    origin = f"Made by hoverproof {hoverproof.__version__} from the mission {mission.name}. Do not edit."
    box = InputBox()
    gains = [getattr(mission.gains, gain) for gain in GAINS]
    in_ = {
        "points": [f"in->image[{i}][{k}]" for i in range(n) for k in range(2)],
        "centroid": [f"in->centroid[{k}]" for k in range(3)],
    }[options["sensing"]]
    tuned = law.tuned if options["tunable"] else ()
    inputs = [
        in_,
        *([f"in->{v}[{k}]" for k in range(3)] for v in ("velocity", "rate", "gravity_direction")),
        ["thrust_excess"],
        [f"params->{c}" if c in tuned else c for c in law.coefficients],
    ]
    results = {
        "thrust_rate": ["out->thrust_rate"],
        "torque": [f"out->torque[{i}]" for i in range(3)],
        "rotor": [f"out->rotor[{i}]" for i in range(4)],
    }
    coefficients = literals(law.coefficients, precision)
    law_sha = hashlib.sha256(
        json.dumps([fingerprint(law.function), {k: str(v) for k, v in law.coefficients.items()}]).encode()
    ).hexdigest()

    def lit(value: Any) -> str:
        return precision.literal(Fraction(value))

    of_gains = statements(
        law.of_gains,
        [[f"gains[{i}]" for i in range(5)], [lit(v) for v in law.fixed]],
        {law.of_gains.name_out(0): [f"params->{c}" if c in tuned else None for c in coefficients]},
        precision,
    )
    vehicle = _vehicle_texts(mission, options["sensing"], precision)
    return {
        **options,
        **vehicle,
        "mission": mission,
        "name": name,
        "NAME": name.upper(),
        "precision": precision,
        "real": precision.c_type,
        "points": n,
        "origin": origin if certified else f"{origin} UNCERTIFIED.",
        "banner": f"/* {origin}\n * {_claim(certified, sha)} */",
        "standing": _standing(standing),
        "certificate_note": f"`{name}.cert.json` is the certificate: `hoverproof check {name}.cert.json`."
        if certified
        else "There is no certificate.",
        "certificate_file": f"{name}.cert.json" if certified else "no certificate",
        "certificate_sha256": sha,
        "certified": certified,
        "law_sha256": law_sha,
        "interval_kind": "certified" if certified else "assumed",
        "tilt_words": tilt_words,
        "tilt_cosine": cosine,
        "lit": lit,
        "zero": lit(0),
        "four": lit(4),
        "thousand": lit(1000),
        "thousandth": lit(Fraction(1, 1000)),
        "braces": lambda values: "{ " + ", ".join(map(lit, values)) + " }",
        "goal_centroid": goal,
        "gains": gains,
        "gains_status": f"{name.upper()}_{'OK' if certified else 'GAINS'}",
        "weight": weight,
        "weight_text": repr(float(weight)),
        "singular": law.singular_excess,
        "floor": (law.singular_excess + low) / 2,
        "thrust": standing.thrust,
        "thrust_excess": (low, high),
        "rotor_lowest_text": f"{float(options['rotor_limits'][0]):g}",
        "rotor_highest_text": f"{float(options['rotor_limits'][1]):g}",
        "rotor_order": ", ".join(ROTORS),
        "box": box,
        "centroid_square": (Fraction(101, 100) * n) ** 2,
        "image_square": _sum_of_squares(in_),
        "coefficients": {c: v for c, v in coefficients.items() if c not in tuned},
        "tuned": {c: v for c, v in coefficients.items() if c in tuned},
        "meanings": law.meanings,
        "law": statements(law.function, inputs, results, precision),
        "of_gains": of_gains,
        "inputs_text": "the target points in the undistorted image (x = X/Z, y = Y/Z, focal length 1; any order),"
        if options["sensing"] == "points"
        else "the image centroid (sum of the unit vectors toward the target points),",
        "vectors": test_vectors(mission, law, precision, options, standing.thrust, tilt_cosine=cosine, certified=certified),
    }


def _claim(certified: bool, sha: str) -> str:
    if certified:
        return f"Certificate of the gains, SHA-256 {sha}."
    return "UNCERTIFIED: nothing is proved of these gains."


def _standing(standing: Standing) -> str:
    if standing.certificate is None:
        return "**UNCERTIFIED: nothing is proved of these gains. Not for flight.**"
    return f"**What is proved.** {standing.certificate['statement']}"


def _sum_of_squares(names: Sequence[str]) -> str:
    """Write Σ x², each pair x² + y² as the law has it, so that a compiler computes it once."""
    pairs = [names[i : i + 2] for i in range(0, len(names), 2)]
    squares = ["(" + " + ".join(f"({x} * {x})" for x in pair) + ")" for pair in pairs]
    return " +\n      ".join(squares)


def _vehicle_texts(mission: Mission, sensing: str, precision: Precision) -> dict[str, Any]:
    double = PRECISIONS["float64"]
    v, n, start = mission.vehicle, len(mission.target.points), mission.start
    x = [f"x[{i}]" for i in range(18)]
    numbers = [double.literal(c) for c in (v.mass, v.gravity, *v.inertia)]
    torque = [f"torque[{i}]" for i in range(3)]
    rate = statements(
        rate_function(),
        [x, ["thrust"], torque, numbers],
        {"rate": [f"rate[{i}]" for i in range(18)]},
        double,
    )
    points = [double.literal(c) for p in mission.target.points for c in p]
    targets = {
        "seen": [f"in->image[{i}][{k}]" for i in range(n) for k in range(2)]
        if sensing == "points"
        else [f"in->centroid[{k}]" for k in range(3)],
        **{u: [f"in->{u}[{k}]" for k in range(3)] for u in ("velocity", "rate", "gravity_direction")},
    }
    sense = statements(sense_function(n, sensing), [x, points], targets, double)
    if precision.name == "float32":
        sense = [re.sub(r"^(in->.*?) = (.*);$", r"\1 = (float)(\2);", line) for line in sense]
    turn = rotation_matrix(*map(float, start.rotation)).T.ravel()
    state = [*map(float, start.position), *map(float, start.velocity), *turn, *map(float, start.rates)]
    return {"rate": rate, "sense": sense, "start": ", ".join(repr(float(s) + 0.0) for s in state)}


def _manifest(context: dict[str, Any], texts: Mapping[str, str]) -> dict[str, Any]:
    box, n = context["box"], context["points"]
    return {
        "format": "hoverproof firmware",
        "version": 1,
        "name": context["name"],
        "mission": context["mission"].exact(),
        "certified": context["certified"],
        "certificate_sha256": context["certificate_sha256"] if context["certified"] else None,
        "law_sha256": context["law_sha256"],
        "precision": context["precision"].name,
        "sensing": context["sensing"],
        "tunable": context["tunable"],
        "tools": {"hoverproof": hoverproof.__version__, "casadi": version("casadi")},
        "thrust": [float(t) for t in context["thrust"]],
        "tilt_cosine": float(context["tilt_cosine"]),
        "rotor_limits": [float(r) for r in context["rotor_limits"]],
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
    points = 23 * context["points"] if context["sensing"] == "points" else 0
    return points + 4 * (len(context["coefficients"]) + len(context["tuned"])) + 150


def _flash_budget(context: dict[str, Any]) -> int:
    """Most bytes of code and constants of NAME.c, without the self-test."""
    return 6 * _instruction_budget(context) + 1000
