"""Eigenvalue bounds of Q over a box of positions: found in floating point, proved exactly."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from hoverproof import checker
from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.errors import InputError
from hoverproof.mission import Mission
from hoverproof.plant.goal import Interval, hover_goal

Array = NDArray[np.float64]
Box = tuple[Interval, ...]

WIDEN = Fraction(1, 10)
SLACKS = ((0.03, 1500), (0.1, checker.MAX_BOXES), (0.3, checker.MAX_BOXES))
GRID = 25


@dataclass(frozen=True)
class Region:
    """Positions over which the eigenvalues of Q are proved to lie in an interval.

    Attributes
    ----------
    box : (3,) of (low, high)
        World frame, m.
    eigenvalues : (low, high)
        Proved bounds of every eigenvalue of Q over the box, 1/m.
    attained : (low, high)
        The lowest and the highest eigenvalue found in the box, 1/m: how tight the bounds are.
    """

    box: Box
    eigenvalues: Interval
    attained: tuple[float, float]


def parse_box(text: str) -> Box:
    """Read a box written as ``x0,x1,y0,y1,z0,z1`` in m, exact decimals.

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
    return box


def default_box(mission: Mission) -> Box:
    """Return the box that holds start and goal, wider by a tenth of their distance on each side."""
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
    return np.asarray(np.linalg.eigvalsh(_depth_matrices(points, positions)), np.float64)


def _depth_matrices(points: Array, positions: Array) -> Array:
    """Return Q at each position, (n, 3, 3), 1/m."""
    rays = points[None] - positions[:, None]
    distance = np.linalg.norm(rays, axis=2)[..., None, None]
    p = rays[..., None] / distance
    return np.asarray(((np.eye(3) - p * p.swapaxes(2, 3)) / distance).sum(axis=1))


def enclose(mission: Mission, box: Box) -> Region:
    """Find and prove an interval that holds every eigenvalue of Q over a box.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high), world frame, m

    Raises
    ------
    InputError
        If the box comes too near to a target point for a proof.
    """
    _check_box(mission, box)
    low, high = _extremes(mission, box)
    for slack, most in SLACKS:
        bounds = (
            decimal_below(Fraction(low) * Fraction(1 - slack), 3),
            decimal_above(Fraction(high) * Fraction(1 + slack), 3),
        )
        if holds_over(mission, box, bounds, most):
            return Region(box, bounds, (low, high))
    raise InputError(mission.source, "--box", "comes too near to a target point for a proof")


def holds_over(mission: Mission, box: Box, bounds: Interval, most: int = checker.MAX_BOXES) -> bool:
    """Tell whether it is proved that every eigenvalue of Q over a box lies within bounds.

    The proof is the checker's branch and bound, in rational arithmetic.
    """
    points = [list(p) for p in mission.target.points]
    return checker.eigenvalues_hold(points, [list(side) for side in box], *bounds, most)


def outside(mission: Mission, box: Box, bounds: Interval) -> tuple[list[Fraction], float] | None:
    """Return a position in a box, and the eigenvalue there that is out of bounds; None if none is.

    The position is rational, and that the eigenvalue is out of bounds is decided exactly.
    """
    places = _samples(box)
    values = eigenvalues(_points(mission), places)
    for index, value, bound, sign in (
        (int(values[:, 0].argmin()), float(values[:, 0].min()), bounds[0], 1),
        (int(values[:, 2].argmax()), float(values[:, 2].max()), bounds[1], -1),
    ):
        place = [Fraction(float(x)).limit_denominator(10**6) for x in places[index]]
        if _is_outside(mission, place, bound, sign):
            return place, value
    return None


def _is_outside(mission: Mission, place: list[Fraction], bound: Fraction, sign: int) -> bool:
    """Decide exactly whether some x has sign·(xᵀQx - bound xᵀx) < 0 at a position."""
    (matrix,) = _depth_matrices(_points(mission), np.array([place], float))
    _, vectors = np.linalg.eigh(matrix)
    x = [Fraction(float(c)).limit_denominator(10**6) for c in vectors[:, 0 if sign > 0 else 2]]
    total = Fraction(0)
    for point in mission.target.points:
        ray = [a - b for a, b in zip(point, place, strict=True)]
        square = sum((c * c for c in ray), Fraction(0))
        along = sum((a * b for a, b in zip(ray, x, strict=True)), Fraction(0))
        part = sum((c * c for c in x), Fraction(0)) - along**2 / square  # |x|² - (p·x)² >= 0
        below, above = sqrt_enclosure(square)
        total += part / (below if sign > 0 else above)
    return sign * (total - bound * sum((c * c for c in x), Fraction(0))) < 0


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


def _check_box(mission: Mission, box: Box) -> None:
    for point in mission.target.points:
        if all(a <= c <= b for c, (a, b) in zip(point, box, strict=True)):
            raise InputError(mission.source, "--box", "holds a target point, where Q is infinite")
