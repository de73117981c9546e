"""The law, and the vehicle that flies it in the example, as C statements."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from hoverproof.algebra.graph import fingerprint
from hoverproof.export.chain import body_sensors
from hoverproof.export.emitter import literals, statements
from hoverproof.export.flight_law import FlightLaw
from hoverproof.export.heading import north_seen
from hoverproof.export.options import Options
from hoverproof.export.precision import FLOAT64
from hoverproof.export.vehicle import rate_function, sense_function
from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import BODY_SIZE
from hoverproof.servo.law import Law
from hoverproof.servo.loop import LoopNumbers


@dataclass(frozen=True)
class LawText:
    """The law in C.

    Attributes
    ----------
    sha256 : str
        Of its graph and its exact numbers.
    coefficients, tuned : dict of str to str
        Literals of its numbers, by name: those that are constants, and those that follow from gains
        that may be set.
    meanings : mapping of str to str
        The closed form of each number.
    statements : tuple of str
        From the input, the excess of thrust and what is checked before (`spread`, `lift`) to the
        outputs.
    of_gains, gap_of_gains : tuple of str
        From gains to the numbers that follow from them, and to m g less the singular thrust.
    image_square : str
        An expression: the sum of the squares of what the camera saw.
    lift, spread : tuple of str
        From the input to the T - m g that the law measures, and to n² - |q|²; empty where the law
        does without.
    heading : bool
        Whether the law turns to a heading.
    from_image : bool
        Whether it is the image that tells it.
    seen_heading : tuple of str
        From the image and the direction of gravity in the input to the heading there; empty where
        it comes from elsewhere, or from frames that are kept.
    """

    sha256: str
    coefficients: Mapping[str, str]
    tuned: Mapping[str, str]
    meanings: Mapping[str, str]
    statements: tuple[str, ...]
    of_gains: tuple[str, ...]
    gap_of_gains: tuple[str, ...]
    image_square: str
    lift: tuple[str, ...]
    spread: tuple[str, ...]
    heading: bool
    from_image: bool
    seen_heading: tuple[str, ...]

    @property
    def numbers(self) -> int:
        """How many numbers the law has."""
        return len(self.coefficients) + len(self.tuned)


@dataclass(frozen=True)
class VehicleText:
    """The simulated vehicle of the example, in double.

    Attributes
    ----------
    rate, sense : tuple of str
        Statements: the derivative of its state, and what its sensors deliver.
    start : str
        Where it starts: numbers of its state, with commas.
    hover : str
        The thrust with which it starts, N.
    """

    rate: tuple[str, ...]
    sense: tuple[str, ...]
    start: str
    hover: str


def law_text(mission: Mission, options: Options, law: FlightLaw) -> LawText:
    """Write a law in C.

    Parameters
    ----------
    mission : Mission
    options : Options
    law : FlightLaw
        Of the mission, for what the camera delivers.
    """
    tuned = law.tuned if options.tunable else ()
    seen = options.seen(len(mission.target.points))
    body = [
        ["heading[0]", "heading[1]"] if v == "heading" else [f"in->{v}[{k}]" for k in range(3)]
        for v in body_sensors(law.source)
    ]
    numbers = literals(law.coefficients, options.precision)
    named = [f"params->{c}" if c in tuned else c for c in law.coefficients]
    function = law.after_checks
    checked = [[name] for name in ("spread", "lift") if name in function.name_in()]
    inputs: list[Sequence[str]] = [seen, *body, ["thrust_excess"], named, *checked]
    results = {
        "thrust_rate": ["out->thrust_rate"],
        "torque": [f"out->torque[{i}]" for i in range(3)],
        "rotor": [f"out->rotor[{i}]" for i in range(len(mission.vehicle.frame.names))],
    }
    if options.rates:
        results["rate_command"] = [f"out->rate_command[{i}]" for i in range(3)]
    gap = {"hover_gap": f"const {options.precision.c_type} hover_gap"}
    return LawText(
        sha256=_law_sha256(law),
        coefficients={c: v for c, v in numbers.items() if c not in tuned},
        tuned={c: v for c, v in numbers.items() if c in tuned},
        meanings=law.meanings,
        statements=tuple(statements(function, inputs, results, options.precision)),
        of_gains=_from_gains(law, options, {c: f"params->{c}" for c in tuned}),
        gap_of_gains=_from_gains(law, options, gap),
        image_square=sum_of_squares(seen),
        lift=_told(law.lift, [*body, list(numbers.values())], options),
        spread=_told(law.spread, [seen], options),
        heading=law.source.heading is not None,
        from_image=law.source.sees_north,
        seen_heading=_seen_heading(mission, options, law.source),
    )


def vehicle_text(mission: Mission, options: Options, law: Law) -> VehicleText:
    """Write the vehicle of the example in C.

    Parameters
    ----------
    mission : Mission
    options : Options
    law : Law
    """
    v, n = mission.vehicle, len(mission.target.points)
    x = [f"x[{i}]" for i in range(BODY_SIZE)]
    numbers = [FLOAT64.literal(c) for c in (v.mass, v.gravity, *v.moments)]
    if options.rates:
        numbers.append(FLOAT64.literal(mission.interface.rate_bandwidth or Fraction(1)))
    commanded = [f"{'rate_command' if options.rates else 'torque'}[{i}]" for i in range(3)]
    rate = statements(
        rate_function(len(v.moments), rates=options.rates),
        [x, ["thrust"], commanded, numbers],
        {"rate": [f"rate[{i}]" for i in range(BODY_SIZE)]},
        FLOAT64,
    )
    points = [FLOAT64.literal(c) for p in mission.target.points for c in p]
    sizes = law.measurement.sizes()
    fields = {u: [f"in->{u}[{k}]" for k in range(sizes[u])] for u in body_sensors(law)}
    if law.sees_north and options.of_points:
        del fields["heading"]  # the firmware makes it of the image
    sensors, goal = sense_function(n, options.sensing, law), law.goal_feature(mission)
    design = [FLOAT64.literal(c) for c in law.design.values(mission, goal)]
    inputs = [x, points, ["vehicle->thrust"], design]
    raw = options.of_points and mission.camera.lens is not None  # then a lens makes pixels of it
    seen = [f"seen[{i}][{k}]" for i in range(n) for k in range(2)] if raw else options.seen(n)
    sense = statements(sensors, inputs, {"seen": seen, **fields}, FLOAT64)
    if options.precision.name == "float32":
        sense = [re.sub(r"^(in->.*?) = (.*);$", r"\1 = (float)(\2);", line) for line in sense]
    start = ", ".join(repr(float(s) + 0.0) for s in LoopNumbers.of(mission).start[:BODY_SIZE])
    return VehicleText(tuple(rate), tuple(sense), start, FLOAT64.literal(v.weight))


def _seen_heading(mission: Mission, options: Options, law: Law) -> tuple[str, ...]:
    if not (law.sees_north and options.of_points):
        return ()
    image, places = options.seen(len(mission.target.points)), ["in->heading[0]", "in->heading[1]"]
    return north_seen(mission, options, law, image, "in->", places)


def _law_sha256(law: FlightLaw) -> str:
    exact = {name: str(value) for name, value in law.coefficients.items()}
    return hashlib.sha256(json.dumps([fingerprint(law.function), exact]).encode()).hexdigest()


def _told(
    function: ca.Function | None, inputs: Sequence[Sequence[str]], options: Options
) -> tuple[str, ...]:
    """Return the statements that compute the one number of a function, by the function's name."""
    if function is None:
        return ()
    name = function.name_out(0)
    results = {name: [f"const {options.precision.c_type} {name}"]}
    return tuple(statements(function, inputs, results, options.precision))


def _from_gains(law: FlightLaw, options: Options, targets: Mapping[str, str]) -> tuple[str, ...]:
    """Return the statements that compute some coefficients from the gains."""
    count = len(law.source.design.gains())
    fixed = [options.precision.literal(v) for v in law.fixed]
    inputs = [[f"gains[{i}]" for i in range(count)], fixed]
    results = {law.of_gains.name_out(0): [targets.get(c) for c in law.coefficients]}
    return tuple(statements(law.of_gains, inputs, results, options.precision))


def sum_of_squares(names: Sequence[str]) -> str:
    """Write Σ x², each pair x² + y² as the law has it, so that a compiler computes it once.

    Parameters
    ----------
    names : sequence of str
        What the camera delivers, in C.
    """
    pairs = [names[i : i + 2] for i in range(0, len(names), 2)]
    squares = ["(" + " + ".join(f"({x} * {x})" for x in pair) + ")" for pair in pairs]
    return " +\n      ".join(squares)
