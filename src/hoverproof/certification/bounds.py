"""The bounds of Q, or of J, that a verdict rests on: assumed or proved, the goal in them.

A verdict about gains is about motions that come to the goal. Bounds that Q violates there
would make it true of nothing, so they are refused.
"""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from hoverproof.certification.cells import View
from hoverproof.certification.flow import eigenvalues, flow_of
from hoverproof.certification.over_box import enclose, none_proved
from hoverproof.certification.pattern import Pattern
from hoverproof.certification.region import Box, Enclosure, box_ends, default_box
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import HoverGoal, Interval, hover_goal
from hoverproof.servo.loop import LoopNumbers

KEY = "bounds.eigenvalues"
BITS = (24, 18, 12)
"""Boxes around a goal that is known to rounding are tried with sides of 2^-BITS of its height."""


def proved_bounds(mission: Mission) -> Enclosure | None:
    """Return the bounds that ``eigenvalues = "auto"`` stands for; None if a mission assumes some.

    Parameters
    ----------
    mission : Mission

    Raises
    ------
    InputError
        If nothing can be proved over the box of the mission, or it holds a target point.
    """
    return None if isinstance(mission.bounds.eigenvalues, tuple) else _proved(mission)


def eigenvalue_bounds(mission: Mission) -> Interval:
    """Return the bounds of the eigenvalues of Q, proved or assumed, 1/m.

    Parameters
    ----------
    mission : Mission

    Raises
    ------
    InputError
        See `proved_bounds`.
    """
    assumed = mission.bounds.eigenvalues
    return assumed if isinstance(assumed, tuple) else _proved(mission).eigenvalues


def _proved(mission: Mission) -> Enclosure:
    """Return what is proved over the box of a mission."""
    box = default_box(mission)
    start = mission.start.position
    if not all(low <= x <= high for x, (low, high) in zip(start, box, strict=True)):
        raise InputError(mission.source, "bounds.box", "must hold the start of the mission")
    region = _enclosed(mission, box)
    if region is None:
        raise none_proved(mission)
    return region


def eigenvalues_at_goal(mission: Mission) -> tuple[float, float]:
    """Return the narrowest bounds of Q, or of J, at the goal, 1/m, in floating point.

    Parameters
    ----------
    mission : Mission
    """
    numbers = LoopNumbers.of(mission)
    return flow_of(mission).needed(Pattern.of(mission), numbers.goal[:, None].repeat(2, axis=1))


def goal_box(mission: Mission, bounds: Interval, box: Box | None) -> Box:
    """Return a box that holds the goal, and over which Q is within bounds, for the checker to see.

    Parameters
    ----------
    mission : Mission
    bounds : (low, high)
        Of the eigenvalues of Q, 1/m.
    box : (3,) of (low, high), or None
        Positions over which they were proved, m; None if they are assumed.

    Raises
    ------
    InputError
        If Q at the goal is not within the bounds: they say nothing about a motion that comes there.
    """
    goal, target, flow = hover_goal(mission), Pattern.of(mission), flow_of(mission)
    low, high = (float(x) for x in bounds)
    for sides in _boxes(mission, goal):
        cell = box_ends(sides)[None]
        view = View.of(target, cell)
        off = float(np.linalg.norm(view.centroid - np.array(goal.centroid_midpoint, float)))
        least = float(eigenvalues(target, view.center)[0, 0])
        holds = goal.exact or off < 0.4 * least * float(view.half.min()) / 2
        if holds and flow.hold(target, cell, low, high).all():
            return sides
    fault = flow.at(target, np.array(goal.position, float), low, high)
    told = f"{fault}: a verdict would say nothing about a motion that comes to the goal; "
    if box is not None:
        key = "bounds.box" if box == mission.bounds.box else "--box"
        raise InputError(mission.source, key, told + "take a box that holds the goal")
    advice = 'take bounds that hold them, or "auto", which proves bounds around start and goal'
    raise InputError(mission.source, KEY, told + advice)


def _boxes(mission: Mission, goal: HoverGoal) -> list[Box]:
    if goal.exact:
        return [tuple((x, x) for x in goal.position)]
    size = math.frexp(float(mission.height_of_target - goal.position[2]))[1]
    boxes: list[Box] = []
    for bits in BITS:
        half = Fraction(2) ** (size - bits)
        middle = [round(x / half * 2**16) * half / 2**16 for x in goal.position]  # short numbers
        boxes.append(tuple((x - half, x + half) for x in middle))
    return boxes


_held: dict[tuple[object, ...], Enclosure | None] = {}


def _enclosed(mission: Mission, box: Box) -> Enclosure | None:
    """Enclose once for a target and a box: searches for gains ask again and again."""
    target = mission.target
    key = (tuple(target.points), tuple(target.counts), box, mission.law.feature)
    if key not in _held:
        _held[key] = enclose(mission, box)
    return _held[key]
