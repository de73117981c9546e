"""What `attraction` answers if the errors are proved to fall exponentially."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from hoverproof.algebra.decimals import angle_at_most, at_least, at_most
from hoverproof.certification.certificate import exact
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.cli.answers.words import enclosure, number, numbers

PER_MASS = "N × true / modelled mass"
"""After bounds of the thrust of vehicles whose mass is not the modelled one."""


def lines(verdict: Exponential, starts: Sequence[str]) -> Iterator[str]:
    """Yield the lines for people, after the one that says which vehicles converge.

    Parameters
    ----------
    verdict : Exponential
    starts : sequence of str
        Its starts in words.
    """
    settling = verdict.settling
    for start in starts:
        yield f"  start                   {start}"
    yield f"  settled                 after {at_most(settling.time)} s: from then on within"
    yield f"                          {at_most(settling.radius)} m of the goal"
    yield f"  decay rate              Ψ falls as exp(-r t), r = {at_least(verdict.rate)} 1/s"
    if verdict.ultimate_radius is not None:
        yield f"  ultimate bound          {at_most(verdict.ultimate_radius)} m from the goal"
    yield "  On the way:"
    yield f"  height                  in {enclosure(verdict.heights)} m above the target"
    yield f"  tilt                    {angle_at_most(verdict.tilt)} or less"
    yield f"  thrust                  in {enclosure(verdict.thrust)} {PER_MASS}"
    yield from view_text(verdict)
    yield f"  thrust of each rotor    in {enclosure(verdict.rotor_thrust)} N"
    if verdict.mission.vehicle.own_limits:
        names = verdict.mission.vehicle.frame.names
        for name, ends in zip(names, verdict.rotor_thrusts, strict=True):
            yield f"    {name:20}  in {enclosure(ends)} N"
    yield from map("  {}".format, beyond(verdict))


def settled_text(verdict: Exponential) -> str:
    """Write how soon every vehicle is proved to settle, and how near to its goal.

    Parameters
    ----------
    verdict : Exponential
    """
    settling = verdict.settling
    return f"within {at_most(settling.radius)} m after {at_most(settling.time)} s"


def view_text(verdict: Exponential) -> Iterator[str]:
    """Yield in which cone the target points stay, if it is proved, and what a lens must see.

    Parameters
    ----------
    verdict : Exponential
    """
    if verdict.field_of_view is not None:
        view, axis = angle_at_most(verdict.field_of_view), verdict.mission.camera.axis_seen
        yield f"  target points           within {view} of the {axis}"
        yield from map("  {:24}".format("").__add__, of_lens(verdict))


def of_lens(verdict: Exponential) -> list[str]:
    """Say what a lens must see, or what the image holds, where nobody asked for points in view.

    Parameters
    ----------
    verdict : Exponential
    """
    camera, cone = verdict.mission.camera, verdict.image_cone
    if camera.half_angle is not None or verdict.field_of_view is None:
        return []
    if cone is None:
        whole = at_most(2 * math.degrees(verdict.field_of_view + camera.tilt))
        return [
            f"so the lens must see {whole}° across the image;",
            "yours is not checked: give camera.half_angle",
        ]
    held = number(cone)  # rounded down as it is
    if verdict.field_of_view <= cone - camera.tilt:
        return [f"the image holds {held} rad about the optical axis: all in it"]
    return [
        f"the image holds {held} rad about the optical axis:",
        f"they may leave it; camera.half_angle = {held} asks for",
        "a proof that they do not",
    ]


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
        f"{limit}{of} may be violated by up to {at_most(far)} N"
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
        "heights": numbers(verdict.heights),
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
            "thrust": "N, of T times modelled over true mass",
            "slope": "1/m",
            "ultimate_radius": "m from the goal, in the end",
            "field_of_view": "rad from the optical axis",
            "rotor_thrust": "N, of each rotor",
        },
    }
