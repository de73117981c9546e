"""What the glue for autopilots says of a mission: scales, time-outs, packets."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from hoverproof.export.options import Options
from hoverproof.export.precision import FLOAT32
from hoverproof.mission.frame import mixing_rows, shares
from hoverproof.mission.sections import Mission
from hoverproof.mission.vehicle import Vehicle

POINTS_IN_A_PACKET = 6
"""That the 30 bytes of the Crazyflie's app channel hold, with a head of four bytes."""

POINT_SCALE, PIXEL_SCALE = 8192, 8
"""Units of a packet's int16 to 1, for points within 4, and to 1 px, for pixels within 4096."""

SHORTEST, LONGEST = 100, 1000
"""ms: the bounds of the age beyond which an image is not flown by."""

UNKNOWN_CAMERA = Fraction(1, 15)
"""s: the frame period that is reckoned with where the mission does not say."""


@dataclass(frozen=True)
class Adapter:
    """What the glue for autopilots says, in float.

    Attributes
    ----------
    weight : str
        A literal: m g, N.
    rotor_max : str
        A decimal: the most that one rotor gives, N.
    rotors : str
        A literal: how many there are.
    px4_levers, ardupilot_levers : str
        Literals with commas: the torques, roll, pitch and yaw, that a setpoint of 1 makes with
        rotors of 1 N, m. See `px4_levers` and `ardupilot_levers`.
    inertia : str
        Literals with commas, kg m².
    seen_size : int
        How many numbers the camera delivers.
    seen_words : str
        What they are.
    of_points : bool
        Whether they are of points, and not the centroid.
    packet_scale : int
        How many units of a packet's whole numbers make 1, or 1 px.
    packet : str
        A packet of an image in the words of Python's `struct`.
    oldest_ms : int
        Age of the oldest image that is flown by, ms: 1000 are 1 s.
    oldest_from : str
        Where that comes from, in words.
    gains : str
        Literals in braces, in the order and the units of the law.
    gain_units : sequence of (str, str)
        Their names and units.
    """

    weight: str
    rotor_max: str
    rotors: str
    px4_levers: str
    ardupilot_levers: str
    inertia: str
    seen_size: int
    seen_words: str
    of_points: bool
    packet_scale: int
    packet: str
    oldest_ms: int
    oldest_from: str
    gains: str
    gain_units: Sequence[tuple[str, str]]


def adapter(
    mission: Mission, options: Options, gains: Sequence[Fraction], units: dict[str, str]
) -> Adapter:
    """Return what the glue says of a mission.

    Parameters
    ----------
    mission : Mission
    options : Options
    gains : sequence of Fraction
        Shape (k,), in the order and the units of the law.
    units : dict
        The unit of each gain by its name.
    """
    v = mission.vehicle
    of_points, n = "points" in (options.sensing, options.camera), len(mission.target.points)
    packed = f"{2 * min(n, POINTS_IN_A_PACKET)}h" if of_points else "3f"
    oldest, origin = oldest_image(mission)
    return Adapter(
        weight=_single(v.weight),
        rotor_max=_single(options.rotor_limits[1]).removesuffix("f"),
        rotors=_single(Fraction(len(v.frame.names))),
        px4_levers=", ".join(map(_single, px4_levers(v))),
        ardupilot_levers=", ".join(map(_single, ardupilot_levers(v))),
        inertia=", ".join(map(_single, v.inertia)),
        seen_size=2 * n if of_points else 3,
        seen_words=_seen_words(of_points, options.pixels),
        of_points=of_points,
        packet_scale=PIXEL_SCALE if options.pixels else POINT_SCALE,
        packet=f"<BBH{packed}",
        oldest_ms=oldest,
        oldest_from=origin,
        gains="{ " + ", ".join(map(_single, gains)) + " }",
        gain_units=list(units.items()),
    )


def _seen_words(of_points: bool, pixels: bool) -> str:
    if pixels:
        return "u and v of each target point, raw pixels"
    return "x and y of each target point" if of_points else "the image centroid"


def oldest_image(mission: Mission) -> tuple[int, str]:
    """Return the age of the oldest image that is flown by, ms, and where it comes from, in words.

    It is the latency of the camera and three of its frames: two may be missed.

    Parameters
    ----------
    mission : Mission
    """
    sensors = mission.sensors
    period = 1 / sensors.frame_rate if sensors.frame_rate else UNKNOWN_CAMERA
    age = math.ceil(1000 * (sensors.latency + 3 * period))
    known = "the mission's" if sensors.frame_rate else "a camera of 15 Hz: the mission names no"
    origin = f"latency and three frames of {known} frame_rate"
    return min(max(age, SHORTEST), LONGEST), origin


def px4_levers(vehicle: Vehicle) -> list[Fraction]:
    """Return the torques that PX4's allocation makes of setpoints of 1 with rotors of 1 N, m.

    The allocation is the pseudo-inverse of what the rotors make, each column divided by its scale:
    for roll and pitch the larger of √(Σ a²/(k/2)) over the k entries a of either that are not zero,
    for yaw the largest entry (PX4, ControlAllocationPseudoInverse). A column of the
    pseudo-inverse makes a torque of 1, so that 1 over its scale is made by a setpoint of 1.

    Parameters
    ----------
    vehicle : Vehicle
    """
    _, *columns = zip(*shares(vehicle.frame), strict=True)
    roll, pitch, yaw = columns
    norms = [sum(a**2 for a in c) / Fraction(sum(map(bool, c)), 2) for c in (roll, pitch)]
    level = Fraction(1 / math.sqrt(max(norms))) * vehicle.reach
    return [level, level, vehicle.drag_ratio / max(yaw)]


def ardupilot_levers(vehicle: Vehicle) -> list[Fraction]:
    """Return the torques that ArduPilot's mixer makes of inputs of 1 with rotors of 1 N, m.

    Its factors about an axis are the levers, brought to at most a half (ArduPilot,
    AP_MotorsMatrix::normalise_rpy_factors).

    Parameters
    ----------
    vehicle : Vehicle
    """
    _, *rows = mixing_rows(vehicle.frame)
    squares = [sum((a**2 for a in row), Fraction(0)) for row in rows]
    sums = [a / (2 * max(map(abs, row))) for a, row in zip(squares, rows, strict=True)]
    lengths = (vehicle.reach, vehicle.reach, vehicle.drag_ratio)
    return [a * b for a, b in zip(sums, lengths, strict=True)]


def _single(value: Fraction) -> str:
    return FLOAT32.literal(value).replace("F", "f")
