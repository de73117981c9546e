"""What a flight is flown with that a proof could cover: each tolerance that it takes."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import NamedTuple

from hoverproof.mission.sections import Mission


class Beyond(NamedTuple):
    """A tolerance that a flight exceeds.

    Attributes
    ----------
    name : str
        Of `Mission.uncertainty`.
    flown, covered : float
        What it takes, and what the mission has, bare numbers in its unit.
    """

    name: str
    flown: float
    covered: float


def beyond_tolerances(mission: Mission) -> list[Beyond]:
    """Return the tolerances that are smaller than what a mission is flown with.

    Noise, gusts, and what scatters are left out.

    Parameters
    ----------
    mission : Mission
    """
    taken = {
        "thrust": _thrust(mission),
        "torque": _torque(mission),
        "latency": _latency(mission),
        **_in_steps(mission),
        "rotor_lag": float(mission.rotors.time_constant),
        "wind": _wind(mission),
        **_turning(mission),
    }
    each = [Beyond(n, x, float(getattr(mission.uncertainty, n))) for n, x in taken.items()]
    return [it for it in each if it.flown > it.covered * (1 + 1e-9) + 1e-12]


def not_compared(mission: Mission) -> list[str]:
    """Return in words what a mission is flown with that is not compared with any tolerance.

    Parameters
    ----------
    mission : Mission
    """
    sensors, wind = mission.sensors, mission.wind
    drawn = [
        k for k in type(sensors).model_fields if k.endswith(("_noise", "_bias", "_resolution"))
    ]
    low_pass = mission.law.force == "measured" and not mission.uncertainty.force_lag
    each = {
        "noise of the sensors": any(getattr(sensors, k) for k in drawn),
        "gusts": wind.gust,
        "air drag": wind.drag,
        "low-pass of the accelerometer": low_pass and sensors.accelerometer_time_constant,
    }
    found = [f"{words} as flown" for words, there in each.items() if there]
    if _thrust(mission):
        found.append("the start, where it accelerates: its rotors begin with the modelled weight")
    return found


def _thrust(mission: Mission) -> float:
    error = mission.model_error
    mean = sum(error.rotors, Fraction(0)) / max(len(error.rotors), 1)
    return abs(float((1 + error.thrust) * (1 + mean) / (1 + error.mass) - 1))


def _torque(mission: Mission) -> float:
    error = mission.model_error
    push = (1 + error.thrust) * (1 + error.arm)
    return max(abs(float(push / (1 + share) - 1)) for share in error.inertia[:2])


def _latency(mission: Mission) -> float:
    """Return the age of an image; a control period that is not covered itself counts in it."""
    sensors, held = mission.sensors, mission.uncertainty.control_period
    rates = (sensors.frame_rate, None if held else sensors.control_rate)
    periods = (1 / rate for rate in rates if rate)
    return float(sensors.latency + sum(periods, Fraction(0)))


def _in_steps(mission: Mission) -> dict[str, float]:
    """Return control period and low-pass of the accelerometer, s, as far as they are covered."""
    may, sensors = mission.uncertainty, mission.sensors
    taken = {}
    if may.control_period and sensors.control_rate:
        taken["control_period"] = float(1 / sensors.control_rate)
    if may.force_lag:
        taken["force_lag"] = float(sensors.accelerometer_time_constant)
    return taken


def _turning(mission: Mission) -> dict[str, float]:
    """Return the yaw rate at the start, rad/s, if one is covered: else any may be."""
    covered = mission.uncertainty.yaw_rate
    return {"yaw_rate": abs(float(mission.start.rates[2]))} if covered else {}


def _wind(mission: Mission) -> float:
    true_mass = float(mission.vehicle.mass * (1 + mission.model_error.mass))
    return float(mission.wind.drag) * math.hypot(*map(float, mission.wind.mean)) / true_mass
