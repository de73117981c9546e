"""Eigenvalue bounds of Q over a box of positions, as they are found, in floating point."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.certification.cells import (
    Told,
    View,
    grow_tree,
    largest_below,
    most_cells,
    smallest_above,
)
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import Interval, hover_goal

Array = NDArray[np.float64]
Box = tuple[Interval, ...]

WIDEN = Fraction(1, 10)
SLACKS = (Fraction(1, 100), Fraction(3, 100), Fraction(1, 10), Fraction(3, 10), Fraction(3, 5))
GRID = 25


@dataclass(frozen=True)
class Enclosure:
    """Positions over which the eigenvalues of Q are proved to lie in an interval.

    Attributes
    ----------
    box : (3,) of (low, high)
        World frame, m.
    eigenvalues : (low, high)
        Proved bounds of every eigenvalue of Q over the box, 1/m.
    attained : (low, high)
        The lowest and the highest eigenvalue found in the box, 1/m: how tight the bounds are.
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
    try:
        x0, x1, y0, y1, z0, z1 = (Fraction(part.strip()) for part in text[:400].split(","))
    except (ValueError, ZeroDivisionError):
        raise InputError("--box", "", f"must be x0,x1,y0,y1,z0,z1 in m, not {text!r}") from None
    box = ((x0, x1), (y0, y1), (z0, z1))
    if any(a > b or max(abs(a), abs(b)) > 10**6 for a, b in box):
        raise InputError("--box", "", f"the ends must be in order and within 1e6 m, not {text!r}")
    if any(x.denominator > 10**18 for side in box for x in side):
        raise InputError("--box", "", f"the ends must have at most 18 decimals, not {text!r}")
    return box


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


def eigenvalues(points: Array, positions: Array) -> Array:
    """Return the eigenvalues of Q, ascending, (n, 3), 1/m, in floating point.

    Parameters
    ----------
    points : (k, 3), target, world frame, m
    positions : (n, 3), world frame, m
    """
    return np.asarray(np.linalg.eigvalsh(View.at(points, positions).depths), np.float64)


def enclosures(mission: Mission, box: Box, most: int | None = None) -> Iterator[Enclosure]:
    """Yield bounds that seem to hold for every eigenvalue of Q over a box, the narrowest first.

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
    low, high = _extremes(mission, box)
    for slack in SLACKS:
        bounds = (
            decimal_below(Fraction(low) * (1 - slack), 3),
            decimal_above(Fraction(high) * (1 + slack), 3),
        )
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
    """Return how to halve a box until the eigenvalues of Q lie within bounds over each cell.

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
    points, (low, high) = _points(mission), map(float, bounds)

    def hold(cells: Array) -> Told:
        view = View.of(points, cells)
        return largest_below(view, high) & smallest_above(view, low)

    limit = most_cells(len(points), 5)
    return grow_tree(np.array(box, float), hold, min(limit, most or limit))


@dataclass(frozen=True)
class Outside:
    """A position where Q has an eigenvalue out of bounds.

    Attributes
    ----------
    position : (3,) Fractions
        World frame, m.
    direction : (3,) Fractions
        A vector x with xᵀQx out of bounds·|x|².
    bound : str
        Which bound does not hold, ``"lower"`` or ``"upper"``.
    eigenvalue : float
        The eigenvalue there, 1/m.
    """

    position: list[Fraction]
    direction: list[Fraction]
    bound: str
    eigenvalue: float


def outside(mission: Mission, box: Box, bounds: Interval) -> Iterator[Outside]:
    """Yield positions in a box where an eigenvalue of Q seems to be out of bounds.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high)
        m, world frame.
    bounds : (low, high)
        1/m.
    """
    places, points = _samples(box), _points(mission)
    values = eigenvalues(points, places)
    for column, index, bound in (
        (0, int(values[:, 0].argmin()), "lower"),
        (2, int(values[:, 2].argmax()), "upper"),
    ):
        place = [_within(x, side) for x, side in zip(places[index], box, strict=True)]
        (matrix,) = View.at(points, np.array([place], float)).depths
        ends, vectors = np.linalg.eigh(matrix)
        x = [Fraction(float(c)).limit_denominator(10**6) for c in vectors[:, column]]
        value, (low, high) = float(ends[column]), bounds
        if value < low if bound == "lower" else value > high:
            yield Outside(place, x, bound, value)


def _within(x: float, side: Interval) -> Fraction:
    """Return a short rational near x in an interval."""
    return min(max(Fraction(float(x)).limit_denominator(10**6), side[0]), side[1])


def _extremes(mission: Mission, box: Box) -> tuple[float, float]:
    """Return the lowest and the highest eigenvalue on a grid that is refined about them twice."""
    points = _points(mission)
    places = _samples(box)
    values = eigenvalues(points, places)
    found = [float(values[:, 0].min()), float(values[:, 2].max())]
    centers = [places[values[:, 0].argmin()], places[values[:, 2].argmax()]]
    size = np.array([float(b - a) for a, b in box]) / (GRID - 1)
    ends = np.array([[float(a), float(b)] for a, b in box])
    for _ in range(2):
        for k, column in ((0, 0), (1, 2)):
            around = np.clip(centers[k] + size * _unit_grid(), ends[:, 0], ends[:, 1])
            values = eigenvalues(points, around)[:, column]
            best = values.argmin() if k == 0 else values.argmax()
            centers[k], found[k] = around[best], float(values[best])
        size = size / 6
    return found[0], found[1]


def _unit_grid() -> Array:
    line = np.linspace(-1, 1, 13)
    return np.stack(np.meshgrid(line, line, line), axis=-1).reshape(-1, 3)


def _samples(box: Box) -> Array:
    lines = [np.linspace(float(a), float(b), GRID) for a, b in box]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)


def _points(mission: Mission) -> Array:
    return np.array(mission.target.points, float)


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
