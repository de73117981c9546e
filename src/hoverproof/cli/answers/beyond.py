"""What a mission is flown with beyond its tolerances, in words, and what would cover it."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from hoverproof.algebra.decimals import decimal_above
from hoverproof.mission.flown import beyond_tolerances, not_compared
from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import Noise

WORDS = {
    "thrust": "a relative thrust error of",
    "torque": "a relative torque error of",
    "latency": "images as old as",
    "rotor_lag": "rotors that lag by",
    "wind": "wind of",
    "yaw_rate": "a yaw rate at the start of",
    "control_period": "a control period of",
    "force_lag": "a low-pass of the accelerometer of",
}
UNITS = {
    **{"thrust": "", "torque": "", "latency": " s", "rotor_lag": " s", "wind": " m/s²"},
    **{"yaw_rate": " rad/s", "control_period": " s", "force_lag": " s"},
}
"""Of tolerances."""


def beyond_text(mission: Mission) -> Iterator[str]:
    """Yield, for each tolerance that is too small, what is flown with and what is covered."""
    for name, flown, covered in beyond_tolerances(mission):
        has = f"is {covered:g}" if covered else "is not given"
        yield f"{WORDS[name]} {flown:.3g}{UNITS[name]} (uncertainty.{name} {has})"
    if any(tilt := mission.model_error.camera_tilt):
        most = max(map(abs, tilt))
        yield f"a camera turned by {float(most):.3g} rad against [camera] (no tolerance is of that)"


def about_flight(mission: Mission, label: str, *, drawn: bool = False) -> dict[str, list[str]]:
    """Return what is beyond the tolerances of a flight, or that nothing is, in words by label.

    Parameters
    ----------
    mission : Mission
    label : str
        Of the tolerances, where it is within all that are compared.
    drawn : bool
        Whether vehicles are drawn, each another one.
    """
    beyond, asked = list(beyond_text(mission)), mission.asks_to_cover()
    still = {"noise": Noise(), "gust": Fraction(0)}
    compared = [] if drawn else mission.uncertainty.model_copy(update=still).covers()
    if beyond:
        return {"beyond the tolerances": beyond}
    rest = [words for words in asked if words not in compared] + not_compared(mission)
    told = {label: compared, "not compared": rest if asked else []}
    return {name: words for name, words in told.items() if words}


def needs_measured_force(mission: Mission) -> bool:
    """Tell whether it is flown with what only a law that measures the force can cover."""
    names = {it.name for it in beyond_tolerances(mission)}
    return mission.law.force == "modelled" and bool(names & {"thrust", "rotor_lag", "wind"})


def covering(mission: Mission) -> list[str]:
    """Return values of ``--set`` with which a proof is asked about all that is flown with."""
    found = beyond_tolerances(mission)
    names = {it.name for it in found}
    sets = [f"uncertainty.{n}={_enough(flown):g}" for n, flown, _ in found]
    if needs_measured_force(mission):
        sets.append("law.force=measured")
    if "latency" in names and not mission.sensors.gyro_turned:
        sets.append("sensors.gyro_turned=true")
    return sets


def _enough(flown: float) -> float:
    """Return three digits that cover it, and no more for a float that is a little above them."""
    return float(decimal_above(Fraction(f"{flown:.10g}"), 3))
