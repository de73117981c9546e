"""What a mission is flown with beyond its tolerances, in words, and what would cover it."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from hoverproof.algebra.decimals import decimal_above
from hoverproof.mission.flown import beyond_tolerances
from hoverproof.mission.sections import Mission

WORDS = {
    "thrust": "a relative thrust error of",
    "torque": "a relative torque error of",
    "latency": "images as old as",
    "rotor_lag": "rotors that lag by",
    "wind": "wind of",
    "control_period": "a control period of",
    "force_lag": "a low-pass of the accelerometer of",
}
UNITS = {
    **{"thrust": "", "torque": "", "latency": " s", "rotor_lag": " s", "wind": " m/s²"},
    **{"control_period": " s", "force_lag": " s"},
}
"""Of tolerances."""


def beyond_text(mission: Mission) -> Iterator[str]:
    """Yield, for each tolerance that is too small, what is flown with and what is covered."""
    for name, flown, covered in beyond_tolerances(mission):
        has = f"is {covered:g}" if covered else "is not given"
        yield f"{WORDS[name]} {flown:.3g}{UNITS[name]}; uncertainty.{name} {has}"


def covering(mission: Mission) -> list[str]:
    """Return values of ``--set`` with which a proof is asked about all that is flown with."""
    found = beyond_tolerances(mission)
    names = {it.name for it in found}
    sets = [f"uncertainty.{n}={_enough(flown):g}" for n, flown, _ in found]
    if mission.law.force == "modelled" and names & {"thrust", "rotor_lag", "wind"}:
        sets.append("law.force=measured")  # only that can cover these
    if "latency" in names and not mission.sensors.gyro_turned:
        sets.append("sensors.gyro_turned=true")
    return sets


def _enough(flown: float) -> float:
    """Return three digits that cover it, and no more for a float that is a little above them."""
    return float(decimal_above(Fraction(f"{flown:.10g}"), 3))
