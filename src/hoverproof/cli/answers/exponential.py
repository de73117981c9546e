"""What `attraction` answers if the errors are proved to fall exponentially."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from hoverproof.certification.certificate import exact
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.cli.answers.words import interval, number, numbers


def lines(verdict: Exponential, starts: Sequence[str]) -> Iterator[str]:
    """Yield the lines for people, after the one that says which vehicles converge.

    Parameters
    ----------
    verdict : Exponential
    starts : sequence of str
        Its starts in words.
    """
    settling, (low, high) = verdict.settling, verdict.slope
    for start in starts:
        yield f"  start                   {start}"
    yield f"  settled                 after {number(settling.time)} s: from then on within"
    yield f"                          {number(settling.radius)} m of the goal"
    yield f"  decay rate              Ψ falls as exp(-r t), r = {number(verdict.rate)} 1/s"
    yield f"  Ψ                       {number(verdict.level)} or less from the start on"
    yield f"  weights w2, w3, w4      {', '.join(map(number, verdict.weights))}"
    if verdict.ultimate_radius is not None:
        last = f"{number(verdict.ultimate_radius)} m, by what is not steady"
        yield f"  in the end              within {last}"
    yield "  On the way:"
    yield f"  height                  in {interval(heights(verdict))} m above the target"
    yield f"  tilt                    {number(verdict.tilt)} rad or less"
    yield f"  thrust                  in {interval(verdict.thrust)} N,"
    yield "                          over the true mass times the modelled"
    if verdict.field_of_view is not None:
        angle = f"{number(verdict.field_of_view)} rad ({math.degrees(verdict.field_of_view):.3g}°)"
        yield f"  target points           within {angle} of the {verdict.mission.camera.axis_seen}"
        yield from map("  {:24}".format("").__add__, _out_of_image(verdict))
    yield f"  thrust of each rotor    in {interval(verdict.rotor_thrust)} N"
    if verdict.mission.vehicle.own_limits:
        names = verdict.mission.vehicle.frame.names
        for name, ends in zip(names, verdict.rotor_thrusts, strict=True):
            yield f"    {name:20}  in {interval(ends)} N"
    yield from map("  {}".format, beyond(verdict))
    symbol = "J" if verdict.mission.law.feature == "scaled" else "Q"
    ball = f"j = {number((low + high) / 2)}, ϱ = {number((high - low) / 2)} 1/m"
    yield f"  |{symbol} - j I| <= ϱ          {ball}"


def settled_text(verdict: Exponential) -> str:
    """Write how soon every vehicle is proved to settle, and how near to its goal.

    Parameters
    ----------
    verdict : Exponential
    """
    settling = verdict.settling
    return f"within {number(settling.radius)} m after {number(settling.time)} s"


def _out_of_image(verdict: Exponential) -> list[str]:
    """Say what the image holds, where points may leave it: that they do not was not asked for."""
    camera, cone = verdict.mission.camera, verdict.image_cone
    if cone is None or camera.half_angle is not None or verdict.field_of_view is None:
        return []
    if verdict.field_of_view <= cone - camera.tilt:
        return [f"the image holds {cone:g} rad about the optical axis: all in it"]
    return [
        f"the image holds {cone:g} rad about the optical axis:",
        f"they may leave it; camera.half_angle = {cone:g} asks for",
        "a proof that they do not",
    ]


def heights(verdict: Exponential) -> tuple[float, float]:
    """Return the ends of the heights above the mean of the target on the way, m.

    Parameters
    ----------
    verdict : Exponential
    """
    low, high = verdict.wedge[2]
    return float(1 / high), float(1 / low)


def beyond(verdict: Exponential) -> list[str]:
    """Say which limits of the rotors the bounds of their thrust pass, and by how much.

    Parameters
    ----------
    verdict : Exponential
    """
    names = verdict.mission.vehicle.frame.names
    own = verdict.mission.vehicle.own_limits
    below: dict[str, Fraction] = {}
    above: dict[str, Fraction] = {}
    each = zip(names, verdict.mission.rotor_limits, verdict.rotor_thrusts, strict=True)
    for name, (least, most), (low, high) in each:
        of = f" of the {name} rotor" if own else ""
        if least is not None and low < least:
            below[of] = max(least - low, below.get(of, least - low))
        if most is not None and high > most:
            above[of] = max(high - most, above.get(of, high - most))
    return [
        f"{limit}{of} is not shown to be kept, by {number(far)} N: the proof has no such limit"
        for limit, beside in (("min_thrust", below), ("max_thrust", above))
        for of, far in beside.items()
    ]


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
        "heights": numbers(heights(verdict)),
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
            "heights": "m above the mean of the target",
            "tilt": "rad",
            "thrust": "N, over the true mass times the modelled",
            "slope": "1/m",
            "ultimate_radius": "m from the goal, in the end",
            "field_of_view": "rad from the optical axis",
            "rotor_thrust": "N, of each rotor",
        },
    }
