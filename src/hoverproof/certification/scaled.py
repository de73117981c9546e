"""The slope J of the scaled centroid over many cells of positions, in floating point.

The equations stand in `checker.scaled_slope`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof import checker
from hoverproof.certification.cells import ROOM, Told, norms
from hoverproof.certification.pattern import Pattern

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

    @cached_property
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
AXES = np.eye(3)[..., None]


@dataclass(frozen=True)
class Ray:
    """What is seen of one target point.

    Attributes
    ----------
    far, near, bend : Tangent
        r/r0, κ = r0/r and λ.
    v, w : (3,) of Tangent
        p = p0 + t w, w = e - (e·p0) p0 + t v.
    eta : Tangent
        η.
    apart : (3,)
        e, m.
    square : float
        |e|², m².
    gap : Tangent
        r - r0, m.
    """

    far: Tangent
    near: Tangent
    bend: Tangent
    v: Three
    w: Three
    eta: Tangent
    apart: Array
    square: float
    gap: Tangent


@dataclass(frozen=True)
class Sight:
    """A target seen from cells of positions; see `checker.Sight`, where the equations stand.

    Attributes
    ----------
    target : Pattern
    p0 : (3,) of Tangent
        Direction of the mean.
    t : Tangent
        One over its distance, 1/m.
    """

    target: Pattern
    p0: Three
    t: Tangent

    @classmethod
    def over(cls, target: Pattern, cells: Array) -> Sight:
        """See a target from boxes of positions.

        Parameters
        ----------
        target : Pattern
        cells : (k, 3, 2)
            Low and high ends, m.
        """
        C, middle, half = target.mean, cells.mean(axis=2), np.ptp(cells, axis=2) / 2
        ray = [Tangent(C[k] - middle[:, k], -AXES[k] * half[:, k], 0.0) for k in range(3)]
        t = _along(ray, ray).root().inverse()
        return cls(target, [x * t for x in ray], t)

    @classmethod
    def over_wedges(cls, target: Pattern, wedges: Array) -> Sight:
        """See a target from wedges of positions.

        Parameters
        ----------
        target : Pattern
        wedges : (k, 3, 2)
            Ends of the x and y of the mean over the height below, and of one over that, 1/m.
        """
        middle, half = wedges.mean(axis=2), np.ptp(wedges, axis=2) / 2
        x, y, t = (Tangent(middle[:, k], AXES[k] * half[:, k], 0.0) for k in range(3))
        z = (x * x + y * y + 1).root().inverse()
        return cls(target, [x * z, y * z, z], t * z)

    @cached_property
    def rays(self) -> list[Ray]:
        """Each point."""
        return [self._ray(e) for e in self.target.points - self.target.mean]

    def _ray(self, e: Array) -> Ray:
        p0, t, square = self.p0, self.t, float(e @ e)
        b = _sum(x * y for x, y in zip(e, p0, strict=True) if x)
        d = 2 * b + square * t
        far = (t * d + 1).root()
        near, short = far.inverse(), (far + 1).inverse()
        scale = near * short
        bend = -1 * (d * scale)
        eta = (b * d * (short + 1) + -square) * scale
        v = [eta * x + y * bend for x, y in zip(p0, e, strict=True)]
        w = [t * y + -1 * (b * x) + z for x, y, z in zip(p0, v, e, strict=True)]
        return Ray(far, near, bend, v, w, eta, e, square, d * short)

    def _whole(self, values: Iterable[Tangent]) -> Tangent:
        """Return Σ wᵢ xᵢ over the points."""
        return _sum(w * x for w, x in zip(self.target.weights.tolist(), values, strict=True))

    @cached_property
    def _pairs(self) -> list[tuple[int, int, Tangent, Tangent]]:
        """Each pair: which, 2 g κ κ and its part of S."""
        found, weights = [], self.target.weights.tolist()
        for (i, one), (j, other) in combinations(enumerate(self.rays), 2):
            e, more = one.apart - other.apart, one.square - other.square
            d = _sum(2 * x * y for x, y in zip(e, self.p0, strict=True) if x) + more * self.t
            g = d * (one.far + other.far).inverse()
            both = weights[i] * weights[j] * (one.near * other.near)
            found.append((i, j, 2 * (g * both), both * (-1 * (g * g) + float(e @ e))))
        return found

    @cached_property
    def _parts(self) -> list[Tangent]:
        """Of each point |w|², (n,)."""
        return [ray.square * ray.near + ray.bend * ray.gap for ray in self.rays]

    @cached_property
    def _aside(self) -> Three:
        """The mean of w, (3,)."""
        return [self.t * x for x in self._mean]

    @cached_property
    def _spread(self) -> Tangent:
        """S = (W² - |q|²)/t²."""
        if len(self.rays) <= checker.PAIRED:
            return _sum(part for *_, part in self._pairs)
        W, aside = self.target.whole, self._aside
        return W * (self._whole(self._parts) - W * _along(aside, aside))

    @cached_property
    def _length(self) -> Tangent:
        """The length a of q."""
        return (-1 * (self.t * self.t * self._spread) + self.target.whole**2).root()

    @cached_property
    def _sizes(self) -> tuple[Tangent, Tangent, Tangent]:
        """1/a, 1/(W + a) and 1/S."""
        a = self._length
        return a.inverse(), (a + self.target.whole).inverse(), self._spread.inverse()

    @cached_property
    def _gain(self) -> Tangent:
        n, (short, _, less) = self.target.whole, self._sizes
        return float(n**1.5) * ((0.5 * ((self._length + n) * less)).root() * short)

    @cached_property
    def _mean(self) -> Three:
        return [
            1 / self.target.whole * self._whole(ray.v[k] for ray in self.rays) for k in range(3)
        ]

    @cached_property
    def lead(self) -> Three:
        """q/W, (3,)."""
        square = self.t * self.t
        return [x + square * y for x, y in zip(self.p0, self._mean, strict=True)]

    def centroid(self) -> Three:
        """Return q, (3,)."""
        return [self.target.whole * x for x in self.lead]

    def scaled(self) -> Three:
        """Return the scaled centroid s, (3,)."""
        size = self._gain * self.t.inverse()
        return [size * x for x in self.lead]

    def slope(self) -> list[Three]:
        """Return J, (3, 3), 1/m."""
        p0, axes, square, share = self.p0, range(3), self.t * self.t, 1 / self.target.whole
        short, whole, less = self._sizes
        R, mean = self._bent(), self._mean
        many = len(self.rays) > checker.PAIRED
        falling = self._fall_of_points(R) if many else self._fall_of_pairs()
        scale = (0.5 * whole - short) * short * square
        ahead = [
            scale * (self._spread * p0[k] + 0.5 * falling[k]) + 0.5 * (falling[k] * less)
            for k in axes
        ]
        J = [[share * R[i][j] + mean[i] * p0[j] for j in axes] for i in axes]
        J = [[square * J[i][j] + self.lead[i] * ahead[j] for j in axes] for i in axes]
        return [[self._gain * (J[i][j] + float(i == j)) for j in axes] for i in axes]

    def _bent(self) -> list[Three]:
        """Return W R̄, (3, 3)."""
        p0, axes, rays = self.p0, range(3), self.rays
        near = [[ray.near * x for x in ray.w] for ray in rays]
        side = [self._whole(ray.bend * ray.w[k] + ray.v[k] for ray in rays) for k in axes]
        eta = self._whole(ray.eta for ray in rays)
        turned = [side[k] + 0.5 * (eta * p0[k]) for k in axes]
        R = [[NOTHING] * 3 for _ in axes]
        for i in axes:
            for j in range(i + 1):
                both = self._whole(x[i] * ray.w[j] for x, ray in zip(near, rays, strict=True))
                R[i][j] = R[j][i] = -1 * both - turned[i] * p0[j] - turned[j] * p0[i]
        for i in axes:
            R[i][i] += eta
        return R

    def _fall_of_pairs(self) -> Three:
        """Return -S', (3,)."""
        t, n, axes = self.t, len(self.rays), range(3)
        weights, turns = [NOTHING] * n, [NOTHING] * n
        for i, j, twice, part in self._pairs:
            weights[i], weights[j] = weights[i] + part, weights[j] + part
            turns[i], turns[j] = turns[i] + twice, turns[j] - twice
        bent = _sum(ray.bend * weight for ray, weight in zip(self.rays, weights, strict=True))
        falling = [(t * bent) * x for x in self.p0]
        for ray, weight, turn in zip(self.rays, weights, turns, strict=True):
            thin = t * weight
            falling = [falling[k] + thin * (ray.near * ray.w[k]) + turn * ray.w[k] for k in axes]
        return falling

    def _fall_of_points(self, bent: list[Three]) -> Three:
        """Return -S', (3,)."""
        p0, axes, t, W, aside = self.p0, range(3), self.t, self.target.whole, self._aside
        thin = [t * part for part in self._parts]
        straight = self._whole(x * ray.bend for x, ray in zip(thin, self.rays, strict=True))
        turns = [x * ray.near + -2 * ray.bend for x, ray in zip(thin, self.rays, strict=True)]
        size = W * _along(aside, aside)
        return [
            W
            * (
                straight * p0[k]
                + self._whole(x * ray.w[k] for x, ray in zip(turns, self.rays, strict=True))
                + 2 * (size * p0[k] + t * _along(bent[k], aside))
            )
            for k in axes
        ]


def slopes(target: Pattern, cells: Array) -> list[Three]:
    """Enclose J over cells, (3, 3), 1/m.

    Parameters
    ----------
    target : Pattern
    cells : (k, 3, 2)
        Low and high ends, m.
    """
    return Sight.over(target, cells).slope()


def slopes_at(target: Pattern, positions: Array) -> Array:
    """Return J at positions, (k, 3, 3), 1/m.

    Parameters
    ----------
    target : Pattern
    positions : (k, 3)
        World frame, m.
    """
    with np.errstate(all="ignore"):
        J = slopes(target, positions[..., None].repeat(2, axis=2))
    return _matrices([[x.mid for x in row] for row in J], len(positions))


def within_ball(target: Pattern, cells: Array, low: float, high: float) -> Told:
    """Tell whether |J - j I| < ϱ over each cell, low = j - ϱ and high = j + ϱ, (k,).

    Parameters
    ----------
    target : Pattern
    cells : (k, 3, 2)
        Low and high ends, m.
    low, high : float
        1/m.
    """
    with np.errstate(all="ignore"):
        return in_ball(slopes(target, cells), len(cells), low, high)


def in_ball(J: list[Three], count: int, low: float, high: float) -> Told:
    """Tell whether |J - j I| < ϱ for enclosures of J, low = j - ϱ and high = j + ϱ, (k,).

    Parameters
    ----------
    J : (3, 3) of Tangent
        Of k cells.
    count : int
        k, a bare number.
    low, high : float
        1/m.
    """
    j, reach = (low + high) / 2, (high - low) / 2 * (1 - ROOM)
    mid = _matrices([[x.mid for x in row] for row in J], count) - j * np.eye(3)
    slope = [_matrices([[x.slope[k] for x in row] for row in J], count) for k in range(3)]
    rest = np.sqrt(sum(np.broadcast_to(x.rest, count) ** 2 for row in J for x in row))
    told = np.isfinite(mid).all(axis=(1, 2)) & np.isfinite(rest) & (rest < reach)
    for signs in product((-1, 1), repeat=3):
        at = np.flatnonzero(told)
        ends = mid[at] + sum(sign * part[at] for sign, part in zip(signs, slope, strict=True))
        told[at] = norms(ends) + rest[at] < reach
    return told


def _matrices(rows: list[list[Any]], count: int) -> Array:
    return np.array([[np.broadcast_to(x, count) for x in row] for row in rows]).transpose(2, 0, 1)


def _sum(values: Iterable[Tangent]) -> Tangent:
    return sum(values, NOTHING)


def _along(x: Iterable[Tangent], y: Iterable[Tangent]) -> Tangent:
    return _sum(a * b for a, b in zip(x, y, strict=True))
