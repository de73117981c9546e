"""What `attraction` answers if the errors are proved to fall exponentially."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import Any

from hoverproof.certification.certificate import exact
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.cli.answers.words import interval, number, numbers


def lines(verdict: Exponential, starts: Sequence[str]) -> Iterator[str]:
    """Yield the lines for people.

    Parameters
    ----------
    verdict : Exponential
    starts : sequence of str
        Its starts in words.
    """
    covers = verdict.mission.uncertainty.covers()
    who = f"with {', '.join(covers)}" if covers else "that is just as modelled"
    yield from textwrap.wrap(
        f"every vehicle {who} converges to the goal (theorem 5), with any heading, from",
        80,
        initial_indent="  ",
        subsequent_indent="  ",
    )
    settling, slope = verdict.settling, verdict.slope
    for start in starts:
        yield f"  start                   {start}"
    near, time = number(settling.radius), number(settling.time)
    yield f"  settled                 within {near} m after {time} s"
    yield f"  Ψ falls as exp(-r t)    r = {number(verdict.rate)} 1/s"
    yield f"  Ψ from the start on     {number(verdict.level)} or less"
    yield f"  weights w2, w3, w4      {', '.join(map(number, verdict.weights))}"
    if verdict.ultimate_radius is not None:
        yield f"  in the end              within {number(verdict.ultimate_radius)} m, by the noise"
    yield "  On the way:"
    low, high = (1 / u for u in reversed(verdict.wedge[2]))
    yield f"  height over the target  in {interval((low, high))} m"
    yield f"  tilt                    {number(verdict.tilt)} rad or less"
    yield f"  thrust over mass, × m   in {interval(verdict.thrust)} N"
    if verdict.field_of_view is not None:
        angle = verdict.field_of_view
        degrees = f"{math.degrees(angle):.3g}°"
        yield f"  points are seen within  {number(angle)} rad ({degrees}) of the axis"
    yield f"  thrust of each rotor    in {interval(verdict.rotor_thrust)} N"
    yield from map("  {}".format, beyond(verdict))
    middle, radius = sum(slope) / 2, (slope[1] - slope[0]) / 2
    symbol = "J" if verdict.mission.law.feature == "scaled" else "Q"
    yield f"  |{symbol} - j I| <= ϱ           j = {number(middle)}, ϱ = {number(radius)} 1/m"


def beyond(verdict: Exponential) -> list[str]:
    """Say which limits of the rotors the bounds of their thrust pass, and by how much.

    Parameters
    ----------
    verdict : Exponential
    """
    (low, high), rotors = verdict.rotor_thrust, verdict.mission.rotors
    said = []
    if rotors.min_thrust is not None and low < rotors.min_thrust:
        short = number(rotors.min_thrust - low)
        said.append(
            f"min_thrust is not shown to be kept, by {short} N: the proof has no such limit"
        )
    if rotors.max_thrust is not None and high > rotors.max_thrust:
        over = number(high - rotors.max_thrust)
        said.append(f"max_thrust is not shown to be kept, by {over} N: the proof has no such limit")
    return said


def as_json(verdict: Exponential) -> dict[str, Any]:
    """Return the object for machines.

    Parameters
    ----------
    verdict : Exponential
    """
    view = verdict.field_of_view
    return {
        "level": float(verdict.level),
        "start_level": float(verdict.start_level),
        "weights": numbers(verdict.weights),
        "decay_rate": float(verdict.rate),
        "settling_time": float(verdict.settling.time),
        "settling_radius": float(verdict.settling.radius),
        "heights": numbers(1 / u for u in reversed(verdict.wedge[2])),
        "tilt": float(verdict.tilt),
        "thrust": numbers(verdict.thrust),
        "slope": numbers(verdict.slope),
        "field_of_view": None if view is None else float(view),
        "ultimate_radius": float(verdict.ultimate_radius or 0),
        "rotor_thrust": numbers(verdict.rotor_thrust),
        "rotor_limits_kept": not beyond(verdict),
        "starts": [exact(start.content()) for start in verdict.starts],
        "units": {
            "decay_rate": "1/s, of Ψ",
            "settling_time": "s, to settling_radius for good",
            "settling_radius": "m from the goal",
            "heights": "m, above the mean of the target",
            "tilt": "rad",
            "thrust": "N, over the true mass, times the modelled",
            "slope": "1/m",
            "ultimate_radius": "m from the goal, in the end",
            "rotor_thrust": "N",
            "field_of_view": "rad from the optical axis",
        },
    }
