"""What `attraction` answers if the errors are proved to fall exponentially."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import Any

from hoverproof.certification.certificate import exact
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.cli.answers.words import interval, number, numbers, sides_text


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
    yield f"  settled                 within {number(settling.radius)} m after {number(settling.time)} s"
    yield f"  Ψ falls as exp(-r t)    r = {number(verdict.rate)} 1/s"
    yield f"  Ψ at the start          {number(verdict.start_level)}, inside up to {number(verdict.level)}"
    yield f"  weights w2, w3, w4      {', '.join(map(number, verdict.weights))}"
    yield "  On the way:"
    yield f"  positions in            {sides_text(verdict.box)} m"
    yield f"  tilt                    {number(verdict.tilt)} rad or less"
    yield f"  thrust over mass, × m   in {interval(verdict.thrust)} N"
    if verdict.field_of_view is not None:
        degrees = math.degrees(verdict.field_of_view)
        yield f"  points are seen within  {number(verdict.field_of_view)} rad ({degrees:.3g}°) of the axis"
    middle, radius = sum(slope) / 2, (slope[1] - slope[0]) / 2
    symbol = "J" if verdict.mission.law.feature == "scaled" else "Q"
    yield f"  |{symbol} - j I| <= ϱ           j = {number(middle)}, ϱ = {number(radius)} 1/m"


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
        "box": [numbers(side) for side in verdict.box],
        "tilt": float(verdict.tilt),
        "thrust": numbers(verdict.thrust),
        "slope": numbers(verdict.slope),
        "field_of_view": None if view is None else float(view),
        "starts": [exact(start.content()) for start in verdict.starts],
        "units": {
            "decay_rate": "1/s, of Ψ",
            "settling_time": "s, to settling_radius for good",
            "settling_radius": "m from the goal",
            "box": "m, world axes",
            "tilt": "rad",
            "thrust": "N, over the true mass, times the modelled",
            "slope": "1/m",
            "field_of_view": "rad from the optical axis",
        },
    }
