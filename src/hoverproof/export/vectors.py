"""Vectors of the self-test: single steps, computed as the target computes them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.graph import evaluate
from hoverproof.export.chain import body_sensors
from hoverproof.export.flight_law import FlightLaw
from hoverproof.export.options import Options
from hoverproof.export.precision import Precision, Rounded
from hoverproof.mission.sections import Mission
from hoverproof.plant import camera

NOMINAL = 8
"""Vectors in which nothing is at a limit."""


@dataclass(frozen=True)
class InputBox:
    """What a step accepts as input; anything else is a fault.

    Attributes
    ----------
    image : Fraction
        Root of the sum of x² + y² over all image points, focal length 1: dimensionless.
    speed : Fraction
        m/s.
    rate : Fraction
        rad/s; gyroscopes of 2000 degrees/s stay inside.
    direction : (low, high)
        Length of the gravity direction, which should be 1: dimensionless.
    dt : Fraction
        Longest step, s.
    specific_force : Fraction, optional
        m/s², of a law that measures it; accelerometers of 16 g stay inside.
    spread : (low, high), optional
        n² - |q|², of a law whose feature tells the size of the target: dimensionless.
    heading : Fraction, optional
        Of a law that turns to one: the least length that is one, dimensionless; no fault below.
    """

    image: Fraction = Fraction(20)
    speed: Fraction = Fraction(30)
    rate: Fraction = Fraction(61)
    direction: tuple[Fraction, Fraction] = (Fraction(9, 10), Fraction(11, 10))
    dt: Fraction = Fraction(1, 10)
    specific_force: Fraction | None = None
    spread: tuple[Fraction, Fraction] | None = None
    heading: Fraction | None = None

    def as_json(self, sensing: str, whole: float) -> dict[str, Any]:
        """Return the box in words and numbers.

        Parameters
        ----------
        sensing : {"points", "centroid"}
            What the camera delivers.
        whole : float
            Sum of the weights of the target points: their number, if each counts once.
        """
        seen = (
            {"image_root_sum_of_squares": [0, float(self.image)]}
            if sensing == "points"
            else {"centroid_length": [0, 1.01 * whole]}
        )
        if self.spread is not None:  # times whole, of the angles from the middle
            radii = [math.sqrt(s) / whole for s in self.spread]
            seen = {**seen, "angular_radius_rad": radii}
        if self.specific_force is not None:
            felt = {"specific_force_length_m_per_s2": [0, float(self.specific_force)]}
        else:
            felt = {}
        if self.heading is not None:
            felt["heading_length"] = [float(self.heading), float(self.direction[1])]
        return {
            **seen,
            **felt,
            "velocity_length_m_per_s": [0, float(self.speed)],
            "rate_length_rad_per_s": [0, float(self.rate)],
            "gravity_direction_length": [float(d) for d in self.direction],
            "dt_s": [0, float(self.dt)],
        }


@dataclass(frozen=True)
class Step:
    """Input and state of one step, in the numbers of the target.

    Attributes
    ----------
    seen : (2, n) or (3,)
        Image points, or centroid.
    velocity, rate, gravity_direction : (3,)
    excess, dt : scalar
        T - m g in N, and s.
    specific_force : (3,)
        m/s²; of no account to a law that does not measure it.
    heading : (2,)
        (cos ψ, sin ψ); likewise.
    """

    seen: NDArray[Any]
    velocity: NDArray[Any]
    rate: NDArray[Any]
    gravity_direction: NDArray[Any]
    excess: np.floating
    dt: np.floating
    specific_force: NDArray[Any]
    heading: NDArray[Any]


@dataclass(frozen=True)
class Vector:
    """A step with what must come of it: literals of C, hexadecimal, bit for bit.

    Attributes
    ----------
    what : str
        In words.
    excess, dt : str
        T - m g in N, and s.
    seen : str
        In braces; see `Step`.
    body : sequence of str
        What else is taken in of the body, each in braces, in the order of the input.
    target_seen : int
        A bare number: 0 if the camera missed the target.
    status : int
        That the step must answer, a bare number.
    thrust, thrust_rate, next_excess : str
        N, N/s and N.
    torque, rotor : str
        In braces, N m and N.
    further : sequence of str
        To a rate loop: the throttle and, in braces, the body rates, rad/s.
    """

    what: str
    excess: str
    seen: str
    body: Sequence[str]
    dt: str
    target_seen: int
    status: int
    thrust: str
    torque: str
    rotor: str
    thrust_rate: str
    next_excess: str
    further: Sequence[str] = ()


def random_step(
    draw: np.random.Generator,
    mission: Mission,
    precision: Precision,
    sensing: str,
    thrust: tuple[Fraction, Fraction],
) -> Step:
    """Draw a step near a hover that sees the target, its thrust in an interval.

    Parameters
    ----------
    draw : numpy.random.Generator
        The source of chance.
    mission : Mission
        Gives the vehicle and how many target points there are.
    precision : Precision
        The type of the numbers drawn.
    sensing : {"points", "centroid"}
        What the camera delivers.
    thrust : (low, high)
        The interval, N.
    """
    n, weight, real = len(mission.target.points), float(mission.vehicle.weight), precision.scalar
    counts = np.array(mission.target.counts, float)
    image = draw.uniform(-1, 1, (2, n))
    rays = np.vstack([image, np.ones(n)])
    tilt = draw.normal(0, 0.1, 2)
    down = np.array([*tilt, 1.0]) / np.sqrt(1 + tilt @ tilt)
    step = Step(
        seen=(
            image if sensing == "points" else (counts * rays / np.linalg.norm(rays, axis=0)).sum(1)
        ).astype(real),
        velocity=draw.normal(0, 0.5, 3).astype(real),
        rate=draw.normal(0, 0.2, 3).astype(real),
        gravity_direction=down.astype(real),
        excess=real(draw.uniform(float(thrust[0]) - weight, float(thrust[1]) - weight)),
        dt=real(draw.uniform(0.0005, 0.02)),
        specific_force=np.zeros(3, real),
        heading=np.zeros(2, real),
    )
    (apart,) = draw.spawn(1)  # what few laws measure leaves what all of them do as it is
    across, along = apart.normal(0, 0.5, 2), apart.uniform(float(thrust[0]), float(thrust[1]))
    felt = np.array([*across, -along / float(mission.vehicle.mass)]).astype(real)
    yaw = apart.uniform(-math.pi, math.pi)
    heading = np.array([math.cos(yaw), math.sin(yaw)]).astype(real)
    return replace(step, specific_force=felt, heading=heading)


def law_at(law: FlightLaw, step: Step, precision: Precision) -> dict[str, list[np.floating]]:
    """Evaluate the law operation by operation, each rounded as on the target.

    What is checked before the law is computed before it, as there.

    Parameters
    ----------
    law : FlightLaw
        For points or for the centroid, as `step` has it.
    step : Step
        Where.
    precision : Precision
        The type of the target.
    """

    def rounded(function: ca.Function, arguments: list[list[Any]]) -> list[list[list[Any]]]:
        return evaluate(function, arguments, lambda c: Rounded(precision.round(c)))

    seen = [Rounded(x) for x in step.seen.ravel(order="F")]
    body = [[Rounded(x) for x in getattr(step, name)] for name in body_sensors(law.source)]
    numbers = [Rounded(precision.round(c)) for c in law.coefficients.values()]
    arguments = [seen, *body, [Rounded(step.excess)], numbers]
    for checked, of in ((law.spread, [seen]), (law.lift, [*body, numbers])):
        if checked is not None:
            arguments.append(rounded(checked, of)[0][0])
    values = rounded(law.after_checks, arguments)
    names = [law.after_checks.name_out(i) for i in range(law.after_checks.n_out())]
    return {
        n: [row[0].value for row in m] for n, m in zip(names, values, strict=True) if n in RESULTS
    }


RESULTS = ("thrust_rate", "torque", "rotor", "rate_command")


def test_vectors(
    mission: Mission,
    law: FlightLaw,
    options: Options,
    thrust: tuple[Fraction, Fraction],
    *,
    tilt_cosine: Fraction,
    certified: bool,
) -> list[Vector]:
    """Return the vectors as C text: steps of the law, and one for each fault.

    Parameters
    ----------
    mission : Mission
        Gives the weight and the target points.
    law : FlightLaw
        That of the mission.
    options : Options
        Of the package.
    thrust : (low, high)
        The interval that steps are drawn from, N.
    tilt_cosine : Fraction
        Dimensionless; a step tilted further has the status bit 16.
    certified : bool
        If not, each step of the law has the status bit 64.
    """
    draw, precision = np.random.default_rng(0), options.precision
    weight = mission.vehicle.weight
    highest = sum(high for _, high in options.each_rotor) - weight
    limits = [[precision.round(end) for end in ends] for ends in options.each_rotor]
    write = partial(_written, precision, body_sensors(law.source))
    scale = precision.round(options.throttle_per_newton)

    def throttled(thrust: list[Any]) -> dict[str, list[Any]]:
        return {"throttle": [scale * thrust[0]]} if options.rates else {}

    written: list[Vector] = []
    step = _random_step(draw, mission, law, options, thrust)
    for _ in range(100 * NOMINAL):
        if len(written) == NOMINAL:
            break
        given = step = _random_step(draw, mission, law, options, thrust)
        lost = law.source.heading is not None and not written
        if lost:  # what is no heading is taken for none
            step = replace(step, heading=np.zeros(2, precision.scalar))
            given = replace(step, heading=np.full(2, precision.scalar(1e30)))
        out = law_at(law, step, precision)
        following = step.excess + step.dt * out["thrust_rate"][0]
        made = zip(limits, out["rotor"], strict=True)
        inside = all(low < r < high for (low, high), r in made)
        if inside and abs(float(following)) < 0.9 * float(min(highest, weight / 2)):
            out["thrust"] = [precision.round(weight) + step.excess]
            out |= throttled(out["thrust"])
            status = 0 if certified else 64
            if step.gravity_direction[2] < precision.round(tilt_cosine):
                status += 16
            status += 128 if lost else 0
            words = "a step without a heading" if lost else "a step of the law"
            written.append(write(given, out, following, status, words))
    zero = precision.scalar(0)
    safe = {
        "thrust": [precision.round(weight)],
        "torque": [zero] * 3,
        "rotor": [precision.round(thrust) for thrust in mission.vehicle.hover_thrusts],
        "thrust_rate": [zero],
    }
    safe |= throttled(safe["thrust"]) | ({"rate_command": [zero] * 3} if options.rates else {})
    huge = precision.scalar(1e30)
    fast = replace(step, velocity=np.array([huge, zero, zero]))
    gone = replace(step, excess=-precision.round(weight))
    faults = [(fast, 1, "an input beyond all reason"), (step, 2, "target not seen")]
    faults.append((gone, 4, "no thrust"))
    if law.lift is not None:
        falls = replace(step, specific_force=np.zeros(3, precision.scalar))
        faults.append((falls, 4, "no thrust is felt"))
    if law.spread is not None:
        one = replace(step, seen=_one_point(step.seen, float(mission.target.whole)))
        faults.append((one, 1, "all points in one"))
    for at, status, words in faults:
        written.append(write(at, safe, zero, status, words))
    return written


def _random_step(
    draw: np.random.Generator,
    mission: Mission,
    law: FlightLaw,
    options: Options,
    thrust: tuple[Fraction, Fraction],
) -> Step:
    """Draw a step that takes in what the options say; a feature is that of drawn points."""
    if options.sensing != "feature":
        return random_step(draw, mission, options.precision, options.sensing, thrust)
    step = random_step(draw, mission, options.precision, "points", thrust)
    directions = camera.spherical(ca.SX(ca.DM(step.seen.astype(float))))
    feature = np.array(ca.evalf(law.source.look(directions))).ravel()
    return replace(step, seen=feature.astype(options.precision.scalar))


def _one_point(seen: NDArray[Any], whole: float) -> NDArray[Any]:
    """Return the image or the centroid of a target so small that its points are one."""
    if seen.ndim == 2:
        return np.broadcast_to(seen[:, :1], seen.shape)
    return np.array([0, 0, whole], seen.dtype)


def _written(
    precision: Precision,
    body: Sequence[str],
    step: Step,
    out: Mapping[str, list[Any]],
    following: Any,
    status: int,
    what: str,
) -> Vector:
    hexed = precision.hex_literal

    def braces(values: Any) -> str:
        return "{ " + ", ".join(map(hexed, values)) + " }"

    image = step.seen
    pairs = ",\n          ".join(braces(column) for column in image.T) if image.ndim == 2 else ""
    return Vector(
        what=what,
        excess=hexed(step.excess),
        seen=f"{{ {pairs} }}" if pairs else braces(image),
        body=[braces(getattr(step, name)) for name in body],
        dt=hexed(step.dt),
        target_seen=int(status != 2),
        status=status,
        thrust=hexed(out["thrust"][0]),
        torque=braces(out["torque"]),
        rotor=braces(out["rotor"]),
        thrust_rate=hexed(out["thrust_rate"][0]),
        next_excess=hexed(following),
        further=[hexed(out["throttle"][0]), braces(out["rate_command"])]
        if "throttle" in out
        else [],
    )
