"""What the files of a firmware package are filled with."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from hoverproof.algebra.decimals import decimal_below
from hoverproof.algebra.graph import fingerprint
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.export.emitter import literals, statements
from hoverproof.export.flight_law import BODY_SENSORS, FlightLaw
from hoverproof.export.precision import PRECISIONS, Precision
from hoverproof.export.vectors import InputBox, test_vectors
from hoverproof.export.vehicle import rate_function, sense_function
from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import BODY_SIZE
from hoverproof.plant.rotors import ROTORS
from hoverproof.servo.hover_error import hover_error, rests_as_modelled
from hoverproof.servo.law import Law
from hoverproof.servo.loop import LoopNumbers
from hoverproof.version import __version__


@dataclass(frozen=True)
class Standing:
    """What is known of a mission before its firmware is written.

    Attributes
    ----------
    thrust : (low, high)
        Interval of T that is assumed in flight, N; that of a certificate takes its place.
    certificate : mapping, optional
        Content of a gain certificate; without one, every file says that nothing is proved.
    """

    thrust: tuple[Fraction, Fraction]
    certificate: Mapping[str, Any] | None = None


def contents(
    mission: Mission,
    standing: Standing,
    precision: Precision,
    law: FlightLaw,
    name: str,
    options: dict[str, Any],
) -> dict[str, Any]:
    """Return what the templates ask for, by name.

    Parameters
    ----------
    mission : Mission
    standing : Standing
    precision : Precision
    law : FlightLaw
    name : str
        Prefix of files and symbols.
    options : dict
        sensing, tunable and rotor_limits, as in `write_package`.
    """
    weight, n = mission.vehicle.weight, len(mission.target.points)
    goal = law.source.goal_feature(mission)
    low, high = (thrust - weight for thrust in standing.thrust)
    sine = high / weight  # a level gives |F| <= high, and its horizontal part is m g sin(tilt)
    if mission.bounds.level is not None and sine < 1:
        cosine = decimal_below(sqrt_enclosure(1 - sine**2)[0], 9)
        tilt_words = (
            f"{math.degrees(math.acos(float(cosine))):.4g} degrees (follows from the level)"
        )
    else:
        cosine = Fraction(0)
        tilt_words = "90 degrees (the certificate sets no bound of its own)"
    certified = standing.certificate is not None
    sha = standing.certificate["sha256"] if standing.certificate is not None else "none"
    origin = f"Made by hoverproof {__version__} from the mission {mission.name}. Do not edit."
    box = InputBox()
    units = law.source.design.gains()
    gains = [law.source.design.numbers(mission)[gain][0] for gain in units]
    in_ = {
        "points": [f"in->image[{i}][{k}]" for i in range(n) for k in range(2)],
        "centroid": [f"in->centroid[{k}]" for k in range(3)],
    }[options["sensing"]]
    tuned = law.tuned if options["tunable"] else ()
    inputs = [
        in_,
        *([f"in->{v}[{k}]" for k in range(3)] for v in BODY_SENSORS),
        ["thrust_excess"],
        [f"params->{c}" if c in tuned else c for c in law.coefficients],
    ]
    results = {
        "thrust_rate": ["out->thrust_rate"],
        "torque": [f"out->torque[{i}]" for i in range(3)],
        "rotor": [f"out->rotor[{i}]" for i in range(4)],
    }
    coefficients = literals(law.coefficients, precision)
    exact = {k: str(v) for k, v in law.coefficients.items()}
    identity = json.dumps([fingerprint(law.function), exact])
    law_sha = hashlib.sha256(identity.encode()).hexdigest()
    origin_text = f"mission {mission.name}; certificate SHA-256 {sha}; law SHA-256 {law_sha}"

    def lit(value: Any) -> str:
        return precision.literal(Fraction(value))

    def from_gains(targets: Mapping[str, str]) -> list[str]:
        """Return the statements that compute some coefficients from the gains."""
        of_gains = law.of_gains
        inputs = [[f"gains[{i}]" for i in range(len(gains))], [lit(v) for v in law.fixed]]
        results = {of_gains.name_out(0): [targets.get(c) for c in law.coefficients]}
        return statements(of_gains, inputs, results, precision)

    vehicle = _vehicle_texts(mission, options["sensing"], precision, law.source)
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
        "certificate_note": f"`{name}.cert.json` is the certificate: `hoverproof check`."
        if certified
        else "There is no certificate.",
        "certificate_file": f"{name}.cert.json" if certified else "no certificate",
        "certificate_sha256": sha,
        "certified": certified,
        "eigenvalue_bounds": _bounds_origin(standing),
        "law_sha256": law_sha,
        "origin_size": len(origin_text) + 1,
        "tells_gains": options["tunable"] or not certified,
        "interval_kind": "certified" if certified else "assumed",
        "tilt_words": tilt_words,
        "hover_error": hover_error(mission, law.source).rows()
        if rests_as_modelled(law.source)
        else [],
        "tilt_cosine": cosine,
        "lit": lit,
        "zero": lit(0),
        "one": lit(1),
        "four": lit(4),
        "thousand": lit(1000),
        "thousandth": lit(Fraction(1, 1000)),
        "braces": lambda values: "{ " + ", ".join(map(lit, values)) + " }",
        "goal_centroid": goal,
        "gains": gains,
        "gains_text": ", ".join(f"{k} {unit}" for k, unit in units.items()).replace("²", "^2"),
        "gains_status": f"{name.upper()}_{'OK' if certified else 'GAINS'}",
        "weight": weight,
        "weight_text": repr(float(weight)),
        **_adapter_texts(mission, options),
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
        "of_gains": from_gains({c: f"params->{c}" for c in tuned}),
        "gap_of_gains": from_gains({"hover_gap": f"const {precision.c_type} hover_gap"}),
        "inputs_text": "the target points in the undistorted image (x = X/Z, y = Y/Z; any order),"
        if options["sensing"] == "points"
        else "the image centroid (sum of the unit vectors toward the target points),",
        "vectors": test_vectors(
            mission,
            law,
            precision,
            options,
            standing.thrust,
            tilt_cosine=cosine,
            certified=certified,
        ),
    }


def _adapter_texts(mission: Mission, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return what adapters say in float: full scales of thrust and torque."""

    def single(value: Fraction) -> str:
        return PRECISIONS["float32"].literal(value).replace("F", "f")

    v, (low, high) = mission.vehicle, options["rotor_limits"]
    reach = 2 * (high - low)  # two rotors high and two low
    torques = [reach * v.arm, reach * v.arm, reach * v.drag_ratio]
    of_points = options["sensing"] == "points"
    return {
        "weight_f": single(v.weight),
        "highest_f": single(4 * high),
        "torque_f": ", ".join(map(single, torques)),
        "seen_size": 2 * len(mission.target.points) if of_points else 3,
        "seen_words": "x and y of each target point" if of_points else "the image centroid",
    }


def _claim(certified: bool, sha: str) -> str:
    if certified:
        return f"Certificate of the gains, SHA-256 {sha}."
    return "UNCERTIFIED: nothing is proved of these gains."


def _bounds_origin(standing: Standing) -> str | None:
    """Say whether the certificate assumes the bounds of Q or has them proved."""
    if standing.certificate is None:
        return None
    return "assumed" if standing.certificate["region"]["box"] is None else "proved over a box"


def _standing(standing: Standing) -> str:
    if standing.certificate is None:
        return "**UNCERTIFIED: nothing is proved of these gains. Not for flight.**"
    return f"**What is proved.** {standing.certificate['statement']}"


def _sum_of_squares(names: Sequence[str]) -> str:
    """Write Σ x², each pair x² + y² as the law has it, so that a compiler computes it once."""
    pairs = [names[i : i + 2] for i in range(0, len(names), 2)]
    squares = ["(" + " + ".join(f"({x} * {x})" for x in pair) + ")" for pair in pairs]
    return " +\n      ".join(squares)


def _vehicle_texts(
    mission: Mission, sensing: str, precision: Precision, law: Law
) -> dict[str, Any]:
    double = PRECISIONS["float64"]
    v, n = mission.vehicle, len(mission.target.points)
    x = [f"x[{i}]" for i in range(BODY_SIZE)]
    numbers = [double.literal(c) for c in (v.mass, v.gravity, *v.inertia)]
    torque = [f"torque[{i}]" for i in range(3)]
    rate = statements(
        rate_function(),
        [x, ["thrust"], torque, numbers],
        {"rate": [f"rate[{i}]" for i in range(BODY_SIZE)]},
        double,
    )
    points = [double.literal(c) for p in mission.target.points for c in p]
    targets = {
        "seen": [f"in->image[{i}][{k}]" for i in range(n) for k in range(2)]
        if sensing == "points"
        else [f"in->centroid[{k}]" for k in range(3)],
        **{u: [f"in->{u}[{k}]" for k in range(3)] for u in BODY_SENSORS},
    }
    sense = statements(sense_function(n, sensing, law), [x, points], targets, double)
    if precision.name == "float32":
        sense = [re.sub(r"^(in->.*?) = (.*);$", r"\1 = (float)(\2);", line) for line in sense]
    start = ", ".join(repr(float(s) + 0.0) for s in LoopNumbers.of(mission).start[:BODY_SIZE])
    return {"rate": rate, "sense": sense, "start": start}
