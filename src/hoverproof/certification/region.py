"""Bounds of Q, or of J, over a box of positions, as they are found, in floating point."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.certification.cells import Told, grow_tree, most_cells
from hoverproof.certification.flow import flow_of, samples
from hoverproof.certification.pattern import Pattern
from hoverproof.errors import InputError
from hoverproof.mission.exact import exact
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import Interval, hover_goal

Array = NDArray[np.float64]
Box = tuple[Interval, ...]

WIDEN = Fraction(1, 10)


@dataclass(frozen=True)
class Enclosure:
    """Positions over which the eigenvalues of Q, or J in a ball, are proved to lie in an interval.

    Attributes
    ----------
    box : (3,) of (low, high)
        World frame, m.
    eigenvalues : (low, high)
        Proved bounds of every eigenvalue of Q over the box, or the ball [j - ϱ, j + ϱ] of J, 1/m.
    attained : (low, high)
        The narrowest bounds found in the box, 1/m: how tight those are.
    tree : str
        How the box is halved until the bounds are shown over each cell.
    """

    box: Box
    eigenvalues: Interval
    attained: tuple[float, float]
    tree: str


def parse_box(text: str) -> Box:
    """Read a box written as ``x0,x1,y0,y1,z0,z1`` in m, exact decimals.

    Parameters
    ----------
    text : str

    Raises
    ------
    InputError
        If it is not six numbers in order.
    """
    ends = text[:400].split(",")
    if len(ends) != 6:
        raise InputError("--box", "", f"must be x0,x1,y0,y1,z0,z1 in m, not {text!r}")
    return exact_box(tuple(zip(ends[::2], ends[1::2], strict=True)))


def exact_box(box: Sequence[Sequence[object]]) -> Box:
    """Return a box with exact ends.

    Parameters
    ----------
    box : (3,) of (low, high), numbers or texts of them
        World frame, m; see `hoverproof.mission.exact.exact`.

    Raises
    ------
    InputError
        If it has not three sides whose ends are in order and of a reasonable size.
    """
    try:
        sides = tuple((exact(low), exact(high)) for low, high in box)
    except (TypeError, ValueError):
        sides = ()
    if len(sides) != 3:
        reason = f"must be three sides (low, high) in m, not {box!r:.80}"
        raise InputError("--box", "", reason)
    if any(a > b or max(abs(a), abs(b)) > 10**6 for a, b in sides):
        reason = f"the ends must be in order and within 1e6 m, not {box!r:.80}"
        raise InputError("--box", "", reason)
    if any(x.denominator > 10**18 for side in sides for x in side):
        raise InputError("--box", "", f"the ends must have at most 18 decimals, not {box!r:.80}")
    return sides


def default_box(mission: Mission) -> Box:
    """Return the box of a mission: by default start and goal, with a tenth of their distance added.

    Parameters
    ----------
    mission : Mission

    Returns
    -------
    (3,) of (low, high)
        World frame, m.
    """
    if mission.bounds.box is not None:
        return mission.bounds.box
    start, goal = mission.start.position, hover_goal(mission).position
    square = sum(((a - b) ** 2 for a, b in zip(start, goal, strict=True)), Fraction(0))
    margin = decimal_above(WIDEN * sqrt_enclosure(square)[1], 2)
    return tuple(
        (decimal_below(min(a, b) - margin, 4), decimal_above(max(a, b) + margin, 4))
        for a, b in zip(start, goal, strict=True)
    )


def enclosures(mission: Mission, box: Box, most: int | None = None) -> Iterator[Enclosure]:
    """Yield bounds of Q, or of J, that seem to hold over a box, the narrowest first.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high), world frame, m
    most : int, optional
        Largest number of cells of the box; by default, and at most, as many as the checker takes.

    Raises
    ------
    InputError
        If the box holds a target point, where Q is infinite.
    """
    if holds_target_point(mission, box):
        raise _infinite_in(mission, box)
    flow = flow_of(mission)
    low, high = flow.needed(Pattern.of(mission), box_ends(box))
    for slack in flow.slacks:
        wide = flow.widened(low, high, slack)
        bounds = decimal_below(wide[0], 3), decimal_above(wide[1], 3)
        if bounds[0] <= 0:
            return
        tree = halved(mission, box, bounds, most)
        if tree is not None:
            yield Enclosure(box, bounds, (low, high), tree)


def _infinite_in(mission: Mission, box: Box) -> InputError:
    """Say of a box that it holds a target point, and where the box comes from."""
    sides = " x ".join(f"[{float(a):g}, {float(b):g}]" for a, b in box)
    fault = f"{sides} m holds a target point, where Q is infinite"
    if box != default_box(mission):
        return InputError(mission.source, "--box", fault)
    if mission.bounds.box is not None:
        return InputError(mission.source, "bounds.box", fault)
    return InputError(
        mission.source,
        "start.position",
        f"the box around start and goal, {fault}; start farther from the target, or give a "
        "smaller box as bounds.box or --box",
    )


def halved(mission: Mission, box: Box, bounds: Interval, most: int | None = None) -> str | None:
    """Return how to halve a box until Q, or J, is within bounds over each cell.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high), world frame, m
    bounds : (low, high), 1/m
    most : int, optional
        Largest number of cells, see `enclosures`.

    Returns
    -------
    str or None
        See `grow_tree`; None if it takes more cells, or if they do not hold.
    """
    target, (low, high), flow = Pattern.of(mission), map(float, bounds), flow_of(mission)

    def hold(cells: Array) -> Told:
        return flow.hold(target, cells, low, high)

    limit = most_cells(len(target.points), flow.cost)
    return grow_tree(np.array(box, float), hold, min(limit, most or limit))


@dataclass(frozen=True)
class Outside:
    """A position where Q has an eigenvalue out of bounds, or J is out of its ball.

    Attributes
    ----------
    position : (3,) Fractions
        World frame, m.
    direction : (3,) Fractions
        A vector x with xᵀQx out of bounds·|x|², or |(J - j I)x| > ϱ|x|.
    bound : str
        Which bound does not hold, ``"lower"``, ``"upper"`` or ``"ball"``.
    value : float
        The eigenvalue, or |J - j I|, there, 1/m.
    """

    position: list[Fraction]
    direction: list[Fraction]
    bound: str
    value: float

    @property
    def words(self) -> str:
        """What is out of bounds there, in words."""
        if self.bound == "ball":
            return "J is out of the ball, its distance from j I"
        return f"Q has an eigenvalue beyond the {self.bound} of them"


def outside(mission: Mission, box: Box, bounds: Interval) -> Iterator[Outside]:
    """Yield positions in a box where Q, or J, seems to be out of bounds.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high)
        m, world frame.
    bounds : (low, high)
        1/m.
    """
    flow, target, (low, high) = flow_of(mission), Pattern.of(mission), map(float, bounds)
    for spot in flow.out(target, samples(box_ends(box)), low, high):
        place = [_within(x, side) for x, side in zip(spot[0], box, strict=True)]
        for _, direction, bound, value in flow.out(target, np.array([place], float), low, high):
            x = [Fraction(float(c)).limit_denominator(10**6) for c in direction]
            yield Outside(place, x, bound, value)


def _within(x: float, side: Interval) -> Fraction:
    """Return a short rational near x in an interval."""
    return min(max(Fraction(float(x)).limit_denominator(10**6), side[0]), side[1])


def box_ends(box: Box) -> Array:
    """Return a box in floating point, (3, 2), m.

    Parameters
    ----------
    box : (3,) of (low, high)
        m.
    """
    return np.array([[float(a), float(b)] for a, b in box])


def holds_target_point(mission: Mission, box: Box) -> bool:
    """Tell whether a target point lies in a box.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high)
        World frame, m.
    """
    return any(
        all(a <= c <= b for c, (a, b) in zip(point, box, strict=True))
        for point in mission.target.points
    )
