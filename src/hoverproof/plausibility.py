"""What no vehicle has: numbers of a mission that are most likely meant in other units.

Nothing here is refused: a strange vehicle is allowed, and a proof about it is a proof. The limits
are wide; within them lie the vehicles from 20 g to 20 kg whose measured parameters were published,
and the presets.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

from hoverproof.design.limits import bandwidth
from hoverproof.mission.conditions import common_limits
from hoverproof.mission.sections import Mission
from hoverproof.mission.vehicle import Vehicle

MASSES = (0.003, 300.0)
"""kg: from the smallest that carry a camera to what carries a person."""

GRAVITIES = (1.0, 30.0)
"""m/s²: the Moon has 1.6, Jupiter 25."""

ARM_SCALES = (0.02, 1.0)
"""m/kg^(1/3), lever of a rotor over the cube root of the mass: 0.08 to 0.35 in vehicles, as a
heavier one of the same shape is longer by that root. An arm in mm or a mass in g is off by a factor
of 10 or more.
"""

GYRATION = (0.1, 4.0)
"""√(I/m) over the lever: 0.3 to 1.6 in vehicles, whose mass lies about between hub and rotors."""

DRAG_RATIOS = (1e-3, 10.0)
"""Drag torque over thrust, over the lever: 0.03 to 2 in vehicles."""

THRUST_TO_WEIGHT = 30.0
"""Greatest thrust over weight: racing vehicles reach 15."""

BANDWIDTH = 200.0
"""rad/s. Rotors follow a step of thrust in some 5 ms (20 g) to 100 ms (20 kg), so even the smallest
follow no motion much faster than 1/5 ms = 200 rad/s.
"""

SLOWEST_MOTION = 1000.0
"""s: time constant of a motion about the goal. No battery lasts for several of them."""

SLOWEST_ROTOR = 1.0
"""s: time constant of a rotor that helps no vehicle to stay level."""


OLDEST_IMAGE = 1.0
"""s: a vehicle that hovers has fallen over by the time that an older image is used."""

TOLERATED = "tolerance"
"""The name of what is found of tolerances for time."""


class Finding(NamedTuple):
    """Something that no vehicle has.

    Attributes
    ----------
    name : str
        Of the check.
    key : str
        Of the mission file, dotted.
    reason : str
        What is strange, with numbers, and what it may be.
    """

    name: str
    key: str
    reason: str

    def __str__(self) -> str:
        return f"{self.key}: {self.reason} ({self.name})"


def warnings(mission: Mission) -> list[Finding]:
    """Return what is strange about a mission; nothing for vehicles as they are built.

    Parameters
    ----------
    mission : Mission
    """
    return [found for check in CHECKS for found in check(mission)]


def _mass(mission: Mission) -> Iterator[Finding]:
    mass = float(mission.vehicle.mass)
    if not MASSES[0] <= mass <= MASSES[1]:
        yield Finding("mass", "vehicle.mass", f"{mass:g} kg is no hovering vehicle's; is it in g?")


def _gravity(mission: Mission) -> Iterator[Finding]:
    gravity = float(mission.vehicle.gravity)
    if not GRAVITIES[0] <= gravity <= GRAVITIES[1]:
        yield Finding(
            "gravity", "vehicle.gravity", f"{gravity:g} m/s² is that of no planet; Earth has 9.81"
        )


def mean_lever(vehicle: Vehicle) -> float:
    """Return the root mean square of the levers about roll and pitch axis, m.

    Parameters
    ----------
    vehicle : Vehicle
    """
    return vehicle.distance / math.sqrt(2)


def _arm_key(vehicle: Vehicle) -> str:
    return "vehicle.lever" if vehicle.layout is None else "vehicle.arm"


def _arm(mission: Mission) -> Iterator[Finding]:
    v = mission.vehicle
    low, high = (scale * float(v.mass) ** (1 / 3) for scale in ARM_SCALES)
    if not low <= (lever := mean_lever(v)) <= high:
        yield Finding(
            "arm against mass",
            _arm_key(v),
            f"a lever of {lever:g} m does not go with {float(v.mass):g} kg, which suggests "
            f"{low:.2g} to {high:.2g} m; is the arm in mm or cm, or the mass in g?",
        )


def _inertia(mission: Mission) -> Iterator[Finding]:
    v = mission.vehicle
    lever = mean_lever(v)
    radii = [math.sqrt(moment / v.mass) / lever for moment in v.inertia]
    wrong = max(radii, key=lambda r: abs(math.log(r)))
    if not GYRATION[0] <= wrong <= GYRATION[1]:
        yield Finding(
            "inertia against mass and arm",
            "vehicle.inertia",
            f"a radius of gyration of {wrong * lever:.3g} m does not go with a lever of "
            f"{lever:g} m; is it in kg m²? (1 g cm² = 1e-7 kg m²)",
        )


def _drag(mission: Mission) -> Iterator[Finding]:
    v = mission.vehicle
    lever = mean_lever(v)
    if not DRAG_RATIOS[0] <= float(v.drag_ratio) / lever <= DRAG_RATIOS[1]:
        yield Finding(
            "drag ratio against arm",
            "vehicle.drag_ratio",
            f"{float(v.drag_ratio):g} m does not go with a lever of {lever:g} m; "
            "it is the drag torque of a rotor over its thrust",
        )


def _thrust(mission: Mission) -> Iterator[Finding]:
    weight, n = mission.vehicle.weight, len(mission.vehicle.frame.names)
    low, high = common_limits(mission.rotor_limits)
    part = "a quarter" if n == 4 else f"1/{n}"
    share = f"{part} of the weight, {float(weight / n):.4g} N"
    if high is not None and n * high <= weight:
        reason = f"{float(high):g} N cannot carry {share}"
        yield Finding("thrust without the weight", "rotors.max_thrust", reason)
    elif high is not None and n * high > THRUST_TO_WEIGHT * weight:
        times = float(n * high / weight)
        reason = (
            f"{float(high):g} N for each rotor is {times:.3g} times the weight in all; is it g?"
        )
        yield Finding("thrust to weight", "rotors.max_thrust", reason)
    if low is not None and n * low >= weight:
        reason = f"{float(low):g} N is not below {share}: it cannot sink"
        yield Finding("thrust without the weight", "rotors.min_thrust", reason)


def _bandwidth(mission: Mission) -> Iterator[Finding]:
    constant = float(mission.rotors.time_constant)
    g, v = mission.gains, mission.vehicle
    for name, key, fast in (
        ("bandwidth", "gains", bandwidth(mission)),
        ("yaw bandwidth", "gains.k_yaw", float(g.k_yaw / v.inertia[2])),
        *_heading_bandwidth(mission),
    ):
        if constant and fast * constant > 1:
            yield Finding(
                name,
                key,
                f"a {name} of {fast:.4g} rad/s is more than rotors with a time constant of "
                f"{constant:g} s follow, {1 / constant:.4g} rad/s",
            )
        elif fast > BANDWIDTH:
            yield Finding(
                name, key, f"no rotor follows a {name} of {fast:.4g} rad/s ({BANDWIDTH:g} at most)"
            )


def _heading_bandwidth(mission: Mission) -> list[tuple[str, str, float]]:
    if mission.goal.heading is None:
        return []
    fast = math.sqrt(mission.k_heading / mission.vehicle.inertia[2])
    return [("heading bandwidth", "gains.k_heading", fast)]


def _rotors(mission: Mission) -> Iterator[Finding]:
    constant = float(mission.rotors.time_constant)
    if constant > SLOWEST_ROTOR:
        yield Finding(
            "rotor time constant", "rotors.time_constant", f"{constant:g} s is slow; is it in ms?"
        )


def _late(mission: Mission) -> Iterator[Finding]:
    covered = mission.uncertainty
    for key, value, most, what in (
        ("rotor_lag", covered.rotor_lag, SLOWEST_ROTOR, "no vehicle hovers on rotors that lag by"),
        ("latency", covered.latency, OLDEST_IMAGE, "no vehicle hovers by images with an age of"),
    ):
        if value > most:
            reason = f"{what} {float(value):g} s, {most:g} s at most; is it in ms?"
            yield Finding(TOLERATED, f"uncertainty.{key}", reason)


CHECKS: tuple[Callable[[Mission], Iterator[Finding]], ...] = (
    _mass,
    _gravity,
    _arm,
    _inertia,
    _drag,
    _thrust,
    _bandwidth,
    _rotors,
    _late,
)
"""All that is looked at, in the order of the mission file."""


def slow_motion(mission: Mission) -> Iterator[Finding]:
    """Yield that a loop is very slow about its goal, though stable; this derives the loop.

    Parameters
    ----------
    mission : Mission
    """
    from hoverproof.servo.linearised import slowest_rate

    rate = slowest_rate(mission)
    if rate * SLOWEST_MOTION < 1:
        constant = f"{1 / rate:.3g} s" if rate > 0 else "longer than can be computed"
        fast = f"the fastest takes {1 / bandwidth(mission):.3g} s"
        reason = f"the time constant of the slowest motion about the goal is {constant}; {fast}"
        yield Finding("slow motion", "gains", reason)
