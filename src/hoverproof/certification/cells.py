"""How a box is halved until something holds over each cell: the trees that certificates carry.

In floating point, and with a little to spare, as the checker asks the same of each cell exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hoverproof import checker
from hoverproof.certification.pattern import Pattern

Array = NDArray[np.float64]
Told = NDArray[np.bool_]
Holds = Callable[[Array], Told]

ROOM = 1e-8
"""What is spared, as a share: far above the rounding of both sides."""
SMALLEST = 1e-9
"""m; cells that are as small as that are not halved."""
STEEPEST = 1.155
"""Bounds 2/√3: the derivative of (I - ppᵀ)/r along a unit vector has norm at most that over r²."""


def most_cells(points: int, cost: int) -> int:
    """Return how many cells the checker takes in a tree.

    Parameters
    ----------
    points : int
        Number of target points.
    cost : int
        Of a cell, a bare number; see `checker.require_little`.
    """
    return checker.MAX_WORK // (checker.price(points) * cost)


def norms(matrices: Array) -> Array:
    """Return the spectral norms of matrices, (...); sooner than by singular values.

    Parameters
    ----------
    matrices : (..., n, n)
    """
    return np.asarray(np.sqrt(np.linalg.eigvalsh(matrices.swapaxes(-1, -2) @ matrices)[..., -1]))


def grow_tree(
    box: Array, holds: Holds, most: int, scale: Sequence[float] | None = None
) -> str | None:
    """Halve a box until something holds over every cell.

    A cell is halved across the side that leaves most halves over which it holds, the longest of
    them.

    Parameters
    ----------
    box : (d, 2)
        Low and high ends, m.
    holds : callable
        Takes cells, (k, d, 2); tells for each whether it holds, (k,).
    most : int
        Largest number of cells at the end.
    scale : (d,), optional
        What the sides are multiplied by when they are compared, bare numbers.

    Returns
    -------
    str or None
        In preorder: 0 for a cell that is not halved, and 1, 2, ... for one that is, across that
        axis. None if it takes more cells, or if it does not hold in the middle of one.
    """
    cells = np.array(box, float)[None]
    held = holds(cells)
    levels, leaves = [], 0
    while len(cells):
        leaves += int(held.sum())
        letters = np.zeros(len(cells), int)
        levels.append(letters)
        cells = cells[~held]
        if leaves + len(cells) > most:
            return None
        if not len(cells):
            break
        sides, middles = np.ptp(cells, axis=2), cells.mean(axis=2, keepdims=True).repeat(2, axis=2)
        if (sides.max(axis=1) <= SMALLEST).any() or not holds(middles).all():
            return None
        halves = _halves(cells)
        told = holds(halves.reshape(-1, *cells.shape[1:])).reshape(halves.shape[:3])
        sides = sides * (1.0 if scale is None else np.array(scale))
        axis = (told.sum(axis=2) + sides / (2 * sides.max(axis=1, keepdims=True))).argmax(axis=1)
        letters[~held] = axis + 1
        row = np.arange(len(cells))
        cells, held = halves[row, axis].reshape(-1, *cells.shape[1:]), told[row, axis].ravel()
    return _preorder(levels)


def _halves(cells: Array) -> Array:
    """Return the halves of cells across each axis, (k, d, 2, d, 2)."""
    count, axes = cells.shape[:2]
    halves = np.broadcast_to(cells[:, None, None], (count, axes, 2, axes, 2)).copy()
    for k in range(axes):
        halves[:, k, 0, k, 1] = halves[:, k, 1, k, 0] = cells[:, k].mean(axis=1)
    return halves


def _preorder(levels: Sequence[NDArray[np.int_]]) -> str:
    """Write a tree that is given level by level, the halves of a cell side by side."""
    first = [2 * (np.cumsum(letters > 0) - 1) for letters in levels]  # place of the first half
    found, waiting = [], [(0, 0)]
    while waiting:
        depth, place = waiting.pop()
        letter = levels[depth][place]
        found.append(str(letter))
        if letter:
            half = int(first[depth][place])
            waiting += [(depth + 1, half + 1), (depth + 1, half)]
    return "".join(found)


@dataclass(frozen=True)
class View:
    """The target as it is seen from the middle of each cell of positions.

    Attributes
    ----------
    center, half : (k, 3)
        Middle, and half the length of each side, m.
    radius : (k,)
        Half the diagonal, m.
    rays : (k, n, 3)
        From the middle to each target point, m.
    distance : (k, n)
        Their lengths, m.
    weights : (n,)
        How much each point counts.
    """

    center: Array
    half: Array
    radius: Array
    rays: Array
    distance: Array
    weights: Array

    @classmethod
    def of(cls, target: Pattern, cells: Array) -> View:
        """Look at a target.

        Parameters
        ----------
        target : Pattern
        cells : (k, 3, 2)
            Low and high ends, m.
        """
        half = (cells[..., 1] - cells[..., 0]) / 2
        seen = cls.at(target, cells.mean(axis=2))
        return replace(seen, half=half, radius=np.linalg.norm(half, axis=1))

    @classmethod
    def at(cls, target: Pattern, positions: Array) -> View:
        """Look at a target from positions alone.

        Parameters
        ----------
        target : Pattern
        positions : (k, 3)
            World frame, m.
        """
        rays = target.points[None] - positions[:, None]
        distance, none = lengths(rays), np.zeros_like(positions)
        return cls(positions, none, none[:, 0], rays, distance, target.weights)

    @property
    def centroid(self) -> Array:
        """The q that a level camera sees in the middle of each cell, (k, 3), dimensionless."""
        shares = self.weights / np.maximum(self.distance, 1e-12)
        return np.asarray(np.einsum("kn,kni->ki", shares, self.rays))

    @property
    def depths(self) -> Array:
        """Q in the middle of each cell, (k, 3, 3), 1/m."""
        return self.turns(self.weights / np.maximum(self.distance, 1e-12) ** 3)

    @property
    def apart(self) -> Array:
        """How far each cell is at least from each point, m, (k, n); tiny if it may hold it."""
        return np.maximum(self.distance - self.radius[:, None], 1e-12)

    def turns(self, weights: Array) -> Array:
        """Return the matrix of Σ wi |x × di|², (k, 3, 3), for weights (k, n).

        Parameters
        ----------
        weights : (k, n)
        """
        return _across(np.einsum("kn,kni,knj->kij", weights, self.rays, self.rays))


def lengths(vectors: Array) -> Array:
    """Return the length of each, (...), as `numpy.linalg.norm` does, in a sixth of its time.

    Parameters
    ----------
    vectors : (..., 3)
    """
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return np.asarray(np.sqrt(x * x + y * y + z * z))


def _across(outer: Array) -> Array:
    """Return tr(A) I - A of each matrix, (k, 3, 3)."""
    return np.asarray(np.trace(outer, axis1=1, axis2=2)[:, None, None] * np.eye(3) - outer)


def largest_below(view: View, high: float) -> Told:
    """Tell whether Q ≺ high I over each cell, (k,); see `checker.largest_below`.

    Parameters
    ----------
    view : View
    high : float
        1/m.
    """
    high *= 1 - ROOM
    clear, near = (view.distance > view.radius[:, None]).all(axis=1), view.apart
    steep = (view.weights * STEEPEST * view.radius[:, None] / near**2).sum(axis=1)
    at_center = np.linalg.eigvalsh(view.depths)[:, 2]
    below: Told = clear & (((view.weights / near).sum(axis=1) < high) | (at_center + steep < high))
    return below


def smallest_above(view: View, low: float) -> Told:
    """Tell whether Q ≻ low I over each cell, (k,); see `checker.smallest_above`.

    Parameters
    ----------
    view : View
    low : float
        1/m.
    """
    weights = view.weights / (view.distance + view.radius[:, None]) ** 3
    whole = weights.sum(axis=1)
    s = (weights[..., None] * view.rays).sum(axis=1)
    below, lost = view.turns(weights), _across(s[:, :, None] * s[:, None, :])
    found = np.zeros(len(whole), bool)
    for k in (2, 4, 16, 64, 2**20):
        least = np.linalg.eigvalsh(below - lost / (k * whole)[:, None, None])[:, 0]
        found |= least > low * (1 + ROOM) + (k - 1) * whole * view.radius**2
    return found
