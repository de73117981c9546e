"""Weights and multipliers by one semidefinite program, in floating point.

For a given reach of the errors, a ball of J and a rate, everything is convex in the weights, the
multipliers and what the memory of the latency weighs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.form import ROWS, Variables, Weights, derive_form
from hoverproof.certification.exponential.vehicles import Limits, Reach, Vehicles
from hoverproof.certification.robust import Inequality, Term, optimise, reciprocals
from hoverproof.certification.robust import Solution as Optimum
from hoverproof.servo.law import Law

Array = NDArray[np.float64]
W2, W3, W4, TORQUE, THRUST, SLOPE, MEMORY, NOISE = range(1, 9)
"""Places among (1, parameters)."""
PARAMETERS = 8
ALONG_Y = 1, 4, 7, 10, 12, 15, 18
"""Places of what is along the second axis among the variables. No product in the inequality joins
it with the others, and it is in it as what is along the first: so it is left out."""
SPARE = 1e-6
"""What -(E' + …) is asked to be above, as a share of 2 E and of the other squares."""
BROKEN, TIGHT = -1e-10, 1e-7
"""Lowest over largest eigenvalue below which a vertex is not kept, and above which it is free."""


@dataclass(frozen=True)
class Falls:
    """The inequality at each vertex, affine in (1, parameters).

    Attributes
    ----------
    corners : tuple of Inequality
    used : (k,)
        Which parameters have a part in it, as places among (1, parameters).
    """

    corners: tuple[Inequality, ...]
    used: tuple[int, ...]

    def of_used(self) -> tuple[list[int], list[Inequality]]:
        """Return the places of (1, parameters) that have a part in it, and what these multiply."""
        there = [0, *self.used]
        return there, [
            Inequality(c.S[there], tuple(t._replace(u=t.u[there]) for t in c.terms))
            for c in self.corners
        ]


@dataclass(frozen=True)
class Ball:
    """|J - j I| <= ϱ.

    Attributes
    ----------
    middle, radius : float
        j and ϱ, 1/m.
    """

    middle: float
    radius: float

    def lost(self, flow: Array, velocity: Array) -> Array:
        """Return |y - j V|² - ϱ²|V|².

        Parameters
        ----------
        flow, velocity : (3, N)
            y and V of the variables.
        """
        off = flow - self.middle * velocity
        return np.asarray(off.T @ off - self.radius**2 * velocity.T @ velocity)


@dataclass(frozen=True)
class Sector:
    """0 ⪯ Q ⪯ λ I, so yᵀ(λV - y) >= 0.

    Attributes
    ----------
    largest : float
        λ, 1/m.
    """

    largest: float

    def lost(self, flow: Array, velocity: Array) -> Array:
        """Return -yᵀ(λV - y).

        Parameters
        ----------
        flow, velocity : (3, N)
            y and V of the variables.
        """
        cross = self.largest / 2 * flow.T @ velocity
        return np.asarray(flow.T @ flow - cross - cross.T)


def variables(v: Vehicles) -> list[int]:
    """Return the places of the variables that the inequality has, but for noise.

    Parameters
    ----------
    v : Vehicles
    """
    late, lagged = v.latency > 0, v.rotor_lag > 0
    there = {"errors": True, "flow": True, "ahead": late, "torque": lagged, "thrust": lagged}
    every = range(Variables.size())
    held = [place for name, has in there.items() if has for place in every[Variables.place(name)]]
    return [place for place in held if place not in ALONG_Y]


def falls(limits: Limits, slope: Ball | Sector, rate: float, potential: bool = False) -> Falls:
    """Return -Ψ' - r Ψ ⪰ 0 at every vertex, for all J or Q.

    Parameters
    ----------
    limits : Limits
    slope : Ball or Sector
        What is known of J, or Q: its form is 0 or less.
    rate : float
        r, 1/s.
    potential : bool
        See `derive_form`; then r is to be 0.
    """
    v = limits.vehicles
    lagged, late, noisy = v.rotor_lag > 0, v.latency > 0, v.noise > 0
    kept = variables(v)
    terms = limits.terms()
    L = np.eye(Variables.size())[:, kept]  # from the variables that are kept
    y, n = (L[Variables.place(name)] for name in ("flow", "ahead"))
    if noisy:  # ν comes last, and is in the forms as n is
        ahead = [k for k in range(len(L))[Variables.place("ahead")] if k not in ALONG_Y]
        L = np.hstack([L, np.eye(len(L))[:, ahead]])
        y, n = (np.pad(x, ((0, 0), (0, len(ahead)))) for x in (y, n))
    nu = np.eye(L.shape[1])[len(kept) :]
    there = ((TORQUE, lagged), (THRUST, lagged), (SLOPE, True), (MEMORY, late), (NOISE, noisy))
    used = (W2, W3, W4, *(name for name, has in there if has))
    corners = []
    for at in _at_vertices(limits, potential):
        S = np.zeros((1 + PARAMETERS, L.shape[1], L.shape[1]))
        S[:6] = L.T @ (at["fall"] - rate / 2 * at["energy"]) @ L
        S[SLOPE] = slope.lost(y, at["sum"][0] @ L / float(v.design.slowness))
        S[NOISE] = nu.T @ nu
        if late:
            forgets = np.exp(-rate * v.latency)
            S[MEMORY] = forgets / v.latency * n.T @ n - v.latency * y.T @ y
        at["yaw"] = at["d4"].copy()
        at["yaw"][W4] -= at["h3"][0]
        each = []
        for pushed, by, size in terms:
            u = np.zeros((1 + PARAMETERS, at[pushed].shape[1], L.shape[1]))
            u[:6] = at[pushed] @ L
            each.append(Term(u, at[by][0] @ L, np.array(size)))
        corners.append(Inequality(S, tuple(each)))
    return Falls(tuple(corners), used)


def _at_vertices(limits: Limits, potential: bool) -> Iterator[dict[str, Array]]:
    """Yield the matrices of each vertex by name, (6, ..): what 1, w2, w3, w4, a5, a6 multiply."""
    v, k = limits.vehicles, 1 + Weights.size()
    vertices = np.array(list(limits.vertices()))
    weights = np.vstack([np.zeros(Weights.size()), np.eye(Weights.size())])
    count = len(vertices)
    several = _several(v.law, v.rotor_lag > 0, potential, k * count)
    found = np.array(
        several(v.numbers, vertices.repeat(k, axis=0).T, np.tile(weights, (count, 1)).T)
    )
    found = found.reshape(len(found), count, k, -1).transpose(1, 2, 0, 3)
    ends = np.cumsum(list(ROWS.values()))
    for matrices in found:
        matrices[1:, : ends[4]] -= matrices[0, : ends[4]]
        yield dict(zip(ROWS, np.split(matrices, ends[:-1], axis=1), strict=True))


@cache
def _several(law: Law, lagged: bool, potential: bool, count: int) -> ca.Function:
    return derive_form(law, lagged, potential).map(count)


@dataclass(frozen=True)
class Solution:
    """What the program found.

    Attributes
    ----------
    weights : (3,)
        w2, w3, w4.
    lag : (2,) or None
        a5 and a6, s².
    memory : float or None
        M.
    slope : float
        The multiplier of the ball of J, a bare number.
    multipliers : (k,)
        Of the terms.
    level : float
        ℓ, dimensionless.
    start : float
        Bound of Ψ at the starts, dimensionless.
    noise : float or None
        σν, what |ν|² adds to the rate of Ψ, 1/s.
    tight : tuple of int
        The numbers of the vertices that keep it from being lower.
    """

    weights: Array
    lag: Array | None
    memory: float | None
    slope: float
    multipliers: Array
    level: float
    start: float
    noise: float | None = None
    tight: tuple[int, ...] = ()

    @property
    def fill(self) -> float:
        """Ψ at the starts over ℓ: they are inside if it is 1 or less."""
        return self.start / self.level

    @property
    def reach(self) -> Reach:
        """How large the errors are on the set."""
        return Reach.of(self.weights, self.level)


@dataclass(frozen=True)
class Posed:
    """The program for a reach: affine in (1, what is sought, the largest Ψ/ℓ of the starts).

    Attributes
    ----------
    corners : list of Inequality
        At each vertex.
    there : list of int
        What is sought, as places among (1, parameters); first 0.
    level : float
        ℓ, dimensionless.
    starts : (k, ..)
        What 1 and what is sought are multiplied by in Ψ of each start.
    rows, pencils
        See `optimise`, numbers: the first rows are of the starts, the pencils of the reach.
    """

    corners: list[Inequality]
    there: list[int]
    level: float
    starts: Array
    rows: Array
    pencils: list[Array]

    @property
    def place(self) -> dict[int, int]:
        """Where each of what is sought is among these."""
        return {name: k for k, name in enumerate(self.there) if k}

    @property
    def cost(self) -> list[float]:
        """The largest Ψ/ℓ of the starts."""
        return [0.0] * (len(self.there) - 1) + [1.0]


def pose(
    limits: Limits,
    ball: tuple[float, float],
    rate: float,
    level: float,
    starts: Array,
    floor: float = np.inf,
) -> Posed:
    """Pose the program.

    Parameters
    ----------
    limits, ball, rate, level, starts, floor
        See `solve`, numbers, 1/m and 1/s.
    """
    low, high = ball
    found = falls(limits, Ball((low + high) / 2, (high - low) / 2), rate)
    there, corners = found.of_used()
    place = {name: there.index(name) for name in found.used}
    size = len(there) + 1  # and the largest Ψ/ℓ of the starts, the last
    r, two = limits.reach, 2 * level
    w2, w3, w4 = (place[w] for w in (W2, W3, W4))
    pencils = [
        reciprocals(r.force**2 / two, {w2: 1, w3: 1}, size),
        reciprocals(r.d3**2 / two, {w3: 1}, size),
        reciprocals(r.turn**2 / two, {w3: 1, w4: 1}, size),
        reciprocals(r.speed**2 / two - 1, {w2: 1}, size),
    ]
    inside = np.column_stack([-starts[:, there] / level, np.ones(len(starts))])
    rows = np.vstack([inside, np.eye(size)[1:]])
    if NOISE in place:
        most = np.eye(size)[0] * floor * rate / limits.vehicles.noise**2
        rows = np.vstack([rows, most - np.eye(size)[place[NOISE]]])
    return Posed(corners, there, level, starts[:, there], rows, pencils)


def solve(
    limits: Limits,
    ball: tuple[float, float],
    rate: float,
    level: float,
    starts: Array,
    likely: Sequence[int] = (),
    floor: float = np.inf,
) -> Solution | None:
    """Find the weights that bring the starts as deep as can be below a level.

    Parameters
    ----------
    limits : Limits
        Of a reach that the weights are to keep to.
    ball : (low, high)
        j - ϱ and j + ϱ, 1/m.
    rate : float
        r, 1/s.
    level : float
        ℓ, dimensionless.
    starts : (k, 8)
        What (1, parameters) are multiplied by in Ψ of each start; see `starts.terms`.
    likely : sequence of int
        The numbers of the vertices that were tight in a program like this.
    floor : float
        What ℓ∞ is at most, where there is noise, dimensionless.

    Returns
    -------
    Solution, or None if there is none
    """
    if not np.isfinite(limits.lever).all() or limits.tilt >= 1:
        return None
    posed = pose(limits, ball, rate, level, starts, floor)
    corners, there, place = posed.corners, posed.there, posed.place
    spare = np.zeros_like(corners[0].S)
    spare[0] = SPARE * np.eye(spare.shape[1]) / max(1.0, ball[1])
    corners = [c.less(spare) for c in corners]
    found_at = _over_few(len(there) + 1, corners, posed.rows, posed.pencils, likely)
    if found_at is None or not (found_at[0].x[:-1] > 0).all():
        return None
    answer, tight = found_at
    values = {name: float(answer.x[k - 1]) for name, k in place.items()}
    return Solution(
        weights=np.array([values[w] for w in (W2, W3, W4)]),
        lag=np.array([values[TORQUE], values[THRUST]]) if TORQUE in values else None,
        memory=values.get(MEMORY),
        slope=values[SLOPE],
        multipliers=answer.multipliers[0],
        level=level,
        noise=values.get(NOISE),
        start=float(answer.x[-1]) * level,
        tight=tight,
    )


def _over_few(
    size: int,
    corners: Sequence[Inequality],
    rows: Array,
    pencils: Sequence[Array],
    likely: Sequence[int],
) -> tuple[Optimum, tuple[int, ...]] | None:
    """Make the last parameter small at few vertices, and at more until all are kept.

    Returns the optimum and the vertices that are tight there.
    """
    cost, working = [0.0] * (size - 2) + [1.0], list(likely) or [len(corners) - 1]
    while True:
        few = [corners[k] for k in working]
        answer = optimise(cost, few, rows=rows, pencils=pencils, shared=True)
        if answer is None:
            return None
        x = [1.0, *answer.x[:-1]]
        values = np.linalg.eigvalsh([c.at(x).bound(answer.multipliers[0]) for c in corners])
        lowest = values[:, 0] / np.abs(values).max(axis=1)
        broken = [int(k) for k in np.argsort(lowest)[:2] if lowest[k] < BROKEN and k not in working]
        if not broken:
            return answer, tuple(k for k in working if lowest[k] < TIGHT)
        working += broken
