"""The slope J of the scaled centroid over cells of positions, in floating point.

The same as `checker.scaled_slope`, where the equations stand, for many cells at once.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.cells import ROOM, Told

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tangent:
    """What is within `rest` of mid + slope·x for x in [-1, 1]³, the place in a cell.

    Attributes
    ----------
    mid, rest : (k,) or number
    slope : (3, k) or number
    """

    mid: Any
    slope: Any
    rest: Any

    @property
    def spread(self) -> Any:
        """How far it is from mid at most, (k,)."""
        return np.abs(self.slope).sum(axis=0) + self.rest

    def __add__(self, other: Tangent | float) -> Tangent:
        if not isinstance(other, Tangent):
            return Tangent(self.mid + other, self.slope, self.rest)
        return Tangent(self.mid + other.mid, self.slope + other.slope, self.rest + other.rest)

    def __sub__(self, other: Tangent) -> Tangent:
        return self + -1 * other

    def __rmul__(self, c: float) -> Tangent:
        return Tangent(c * self.mid, c * self.slope, abs(c) * self.rest)

    def __mul__(self, other: Tangent) -> Tangent:
        rest = np.abs(self.mid) * other.rest + np.abs(other.mid) * self.rest
        return Tangent(
            self.mid * other.mid,
            self.mid * other.slope + other.mid * self.slope,
            rest + self.spread * other.spread,
        )

    def inverse(self) -> Tangent:
        """Return 1/x; not a number where x is not shown to be positive."""
        lowest = self._lowest()
        bend = self.spread**2 / (self.mid**2 * lowest) / 2
        slope = -1 / self.mid**2
        return Tangent(1 / self.mid + bend, slope * self.slope, -slope * self.rest + bend)

    def root(self) -> Tangent:
        """Return √x; not a number where x is not shown to be positive."""
        value, low = np.sqrt(self.mid), np.sqrt(self._lowest())
        bend = self.spread**2 / (2 * value * (value + low) ** 2) / 2
        slope = 1 / (2 * value)
        return Tangent(value - bend, slope * self.slope, slope * self.rest + bend)

    def _lowest(self) -> Any:
        lowest = self.mid - self.spread
        return np.where(lowest > 0, lowest, np.nan)


Three = list[Tangent]
NOTHING = Tangent(0.0, np.zeros((3, 1)), 0.0)


def slopes(points: Array, cells: Array) -> list[Three]:
    """Enclose J over cells, (3, 3), 1/m.

    Parameters
    ----------
    points : (n, 3)
        World frame, m.
    cells : (k, 3, 2)
        Low and high ends, m.
    """
    n, C, axes = len(points), points.mean(axis=0), range(3)
    half, middle = (cells[..., 1] - cells[..., 0]) / 2, cells.mean(axis=2)
    ray = [Tangent(C[k] - middle[:, k], -np.eye(3)[k][:, None] * half[:, k], 0.0) for k in axes]
    t = _along(ray, ray).root().inverse()
    p0 = [x * t for x in ray]
    rays = []
    for e in points - C:
        d = 2 * _sum(e[k] * p0[k] for k in axes) + float(e @ e) * t
        far = (t * d + 1).root()
        near = far.inverse()
        bend = -1 * (d * near * (far + 1).inverse())
        w = [bend * p0[k] + e[k] * near for k in axes]
        rays.append((w, [p0[k] + t * w[k] for k in axes], near, bend))
    mean = [1 / n * _sum(w[k] for w, *_ in rays) for k in axes]
    apart = [[w[k] - mean[k] for k in axes] for w, *_ in rays]
    S = n * _sum(_along(u, u) for u in apart)
    a = (-1 * (t * t * S) + n * n).root()
    whole, short, less = a + n, a.inverse(), S.inverse()
    q = [n * (p0[k] + t * mean[k]) * short for k in axes]
    N = [[NOTHING] * 3 for _ in axes]
    falling = [NOTHING] * 3
    for u, (w, p, near, bend) in zip(apart, rays, strict=True):
        up, uw = _along(u, p0), _along(u, w) * near
        kp, bent = [near * x for x in p], up * near
        for i in axes:
            falling[i] += bend * (u[i] - up * p0[i]) - uw * p[i] - bent * w[i]
            for j in range(i + 1):
                N[i][j] += (near if i == j else NOTHING) - kp[i] * p[j]
    N = [[N[max(i, j)][min(i, j)] for j in axes] for i in axes]
    seen = [_along(q, row) for row in N]
    first = 0.5 * whole.inverse() - short
    h = [first * seen[k] - n * (falling[k] * less) for k in axes]
    stretch = (n / 2 * (whole * less)).root()
    return [[stretch * (N[i][j] * short + q[i] * h[j]) for j in axes] for i in axes]


def slopes_at(points: Array, positions: Array) -> Array:
    """Return J at positions, (k, 3, 3), 1/m.

    Parameters
    ----------
    points : (n, 3)
        World frame, m.
    positions : (k, 3)
        World frame, m.
    """
    with np.errstate(all="ignore"):
        J = slopes(points, positions[..., None].repeat(2, axis=2))
    return _matrices([[x.mid for x in row] for row in J], len(positions))


def within_ball(points: Array, cells: Array, low: float, high: float) -> Told:
    """Tell whether |J - j I| < ϱ over each cell, low = j - ϱ and high = j + ϱ, (k,).

    Parameters
    ----------
    points : (n, 3)
        World frame, m.
    cells : (k, 3, 2)
        Low and high ends, m.
    low, high : float
        1/m.
    """
    count, j, reach = len(cells), (low + high) / 2, (high - low) / 2 * (1 - ROOM)
    with np.errstate(all="ignore"):
        J = slopes(points, cells)
    mid = _matrices([[x.mid for x in row] for row in J], count) - j * np.eye(3)
    slope = [_matrices([[x.slope[k] for x in row] for row in J], count) for k in range(3)]
    rest = np.sqrt(sum(np.broadcast_to(x.rest, count) ** 2 for row in J for x in row))
    known = np.isfinite(mid).all(axis=(1, 2)) & np.isfinite(rest) & (rest < reach)
    told = known.copy()
    for signs in product((-1, 1), repeat=3):
        ends = mid + sum(sign * part for sign, part in zip(signs, slope, strict=True))
        norms = np.linalg.norm(np.where(known[:, None, None], ends, 0.0), 2, axis=(1, 2))
        told &= norms + rest < reach
    return told


def _matrices(rows: list[list[Any]], count: int) -> Array:
    return np.array([[np.broadcast_to(x, count) for x in row] for row in rows]).transpose(2, 0, 1)


def _sum(values: Iterable[Tangent]) -> Tangent:
    return sum(values, NOTHING)


def _along(x: Iterable[Tangent], y: Iterable[Tangent]) -> Tangent:
    return _sum(a * b for a, b in zip(x, y, strict=True))
