"""Weights and multipliers by one semidefinite program, in floating point.

For a given reach of the errors, a ball of J and a rate, everything is convex in the weights, the
multipliers and what the memory of the latency weighs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.held import is_kept
from hoverproof.certification.exponential.inequality import (
    HOLD,
    MEMORY,
    SHAKEN,
    SLOPE,
    THRUST,
    TORQUE,
    W2,
    W3,
    W4,
    Ball,
    Falls,
    falls,
)
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.certification.robust import Solution as Optimum
from hoverproof.certification.robust import optimise, reciprocals

Array = NDArray[np.float64]
SPARE = 4e-6
"""What -(E' + …) is asked to be above, as a share of 2 E and of the other squares."""
BROKEN, TIGHT = -1e-10, 1e-7
"""Lowest over largest eigenvalue below which a vertex is not kept, and above which it is free."""
LIKELY = 0.25, 0.16, 0.05
"""w2, w3 and w4 as they may be."""
TOLERANCE = 1e-9
"""Of the solver."""
MOST_NEW = 2
"""So many vertices that are not kept are added at once."""


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
    noise : dict
        σ by the name of the disturbance: what its square adds to the rate of Ψ, 1/s.
    hold : dict
        What the memory of each part of what is held weighs, by its name in `held.moved`, s.
    floor : float
        ℓ∞, dimensionless: what disturbances leave of Ψ.
    tight : tuple of int
        The numbers of the vertices that keep it from being lower.
    optimum : robust.Solution
        What the solver found.
    working : tuple of int
        The numbers of the vertices that it was given.
    """

    weights: Array
    lag: Array | None
    memory: float | None
    slope: float
    multipliers: Array
    level: float
    start: float
    noise: dict[str, float]
    hold: dict[str, float]
    floor: float
    tight: tuple[int, ...]
    optimum: Optimum
    working: tuple[int, ...]

    @property
    def fill(self) -> float:
        """Ψ at the starts over ℓ: they are inside if it is 1 or less."""
        return self.start / self.level

    @property
    def reach(self) -> Reach:
        """How large the errors are on the set."""
        return Reach.of(self.weights, self.level)


@dataclass(frozen=True)
class Program:
    """The question which weights bring starts below a level: as deep as can be, or soonest.

    Attributes
    ----------
    falls : Falls
    spare : (n, n)
        What M(τ) is asked to be above.
    missed : (n, n)
        What the last parameter multiplies that is added to M(τ): nothing, or 2 E as it is likely.
    rows : (j, 1 + k)
        Each times (1, parameters that are used, the last parameter) is 0 or more. The last is what
        is made small: the largest Ψ/ℓ of the starts, or the rate that is missing for it to be as
        wished, 1/s.
    pencils : tuple of arrays, (1 + k, p, p)
        Bare numbers; likewise positive semidefinite.
    level : float
        ℓ, dimensionless.
    ball : (low, high)
        j - ϱ and j + ϱ, 1/m.
    starts : (k, j)
        What 1 and the parameters that are used are multiplied by in Ψ of each start.
    shaken : dict
        What the σ of each disturbance adds to ℓ∞, dimensionless, by its name.
    """

    falls: Falls
    spare: Array
    missed: Array
    rows: Array
    pencils: tuple[Array, ...]
    level: float
    ball: tuple[float, float]
    starts: Array
    shaken: dict[str, float]

    @classmethod
    def of(
        cls,
        limits: Limits,
        ball: tuple[float, float],
        rate: float,
        level: float,
        starts: Array,
        floor: float = np.inf,
        fill: float | None = None,
    ) -> Program | None:
        """Pose it; None if thrust or lever may vanish.

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
        starts : (k, 11)
            What (1, parameters) are multiplied by in Ψ of each start; see `Question.terms`.
        floor : float
            What ℓ∞ is at most, where there is noise, dimensionless.
        fill : float, optional
            What the largest Ψ/ℓ of the starts is to be, dimensionless; by default it is made small.
        """
        if not np.isfinite(limits.lever).all() or limits.tilt >= 1 or not is_kept(limits, rate):
            return None
        low, high = ball
        found = falls(limits, Ball((low + high) / 2, (high - low) / 2), rate)
        there, size = found.there, len(found.there) + 1
        place = {name: there.index(name) for name in found.used}
        r, two = limits.reach, 2 * level
        w2, w3, w4 = (place[w] for w in (W2, W3, W4))
        pencils = (
            reciprocals(r.force**2 / two, {w2: 1, w3: 1}, size),
            reciprocals(r.d3**2 / two, {w3: 1}, size),
            reciprocals(r.turn**2 / two, {w3: 1, w4: 1}, size),
            reciprocals(r.speed**2 / two - 1, {w2: 1}, size),
        )
        missed = np.zeros(found.energy.shape[1:])
        inside = np.column_stack([-starts[:, there] / level, np.ones(len(starts))])
        if fill is not None:
            missed = np.tensordot(_likely(limits.vehicles), found.energy, 1) / 2
            inside[:, 0] += fill
            inside[:, -1] = 1 / rate
        rows = np.vstack([inside, np.eye(size)[1 : None if fill is None else -1]])
        shaken = {name: bound**2 / rate for name, bound in limits.disturbances()}
        if shaken and np.isfinite(floor):
            left = np.eye(size)[0] * floor
            left -= sum(x * np.eye(size)[place[SHAKEN[name]]] for name, x in shaken.items())
            rows = np.vstack([rows, left / max(floor, 1e-300)])
        spare = SPARE / max(1.0, high) * np.eye(len(missed))
        return cls(found, spare, missed, rows, pencils, level, ball, starts[:, there], shaken)

    @property
    def cost(self) -> list[float]:
        """What is made small: the last parameter, dimensionless."""
        return [0.0] * len(self.falls.used) + [1.0]

    def solve(self, likely: Sequence[int] = ()) -> Solution | None:
        """Solve it.

        Parameters
        ----------
        likely : sequence of int
            The numbers of the vertices that were tight in a program like this.
        """
        found_at = self._over_few(likely)
        if found_at is None or not (found_at[0].x[:-1] > 0).all():
            return None
        answer, working, tight = found_at
        values = dict(zip(self.falls.used, map(float, answer.x[:-1]), strict=True))
        return Solution(
            weights=np.array([values[w] for w in (W2, W3, W4)]),
            lag=np.array([values[TORQUE], values[THRUST]]) if TORQUE in values else None,
            memory=values.get(MEMORY),
            slope=values[SLOPE],
            multipliers=answer.multipliers[0],
            level=self.level,
            noise={name: values[SHAKEN[name]] for name in self.shaken},
            hold={name: values[place] for name, place in HOLD.items() if place in values},
            floor=sum(x * values[SHAKEN[name]] for name, x in self.shaken.items()),
            start=float((self.starts @ [1.0, *answer.x[:-1]]).max()),
            tight=tight,
            optimum=answer,
            working=working,
        )

    def change(self, found: Solution, other: Program) -> float:
        """Return by how much the optimum of another program like this is larger, to first order.

        Parameters
        ----------
        found : Solution
            Of this program.
        other : Program
            With data that are little different.
        """
        at, working = found.optimum, list(found.working)
        x = np.array([1.0, *at.x])
        corners = np.subtract(*(p.bound(at)[working] for p in (other, self)))
        lifted = sum(float((z * m).sum()) for z, m in zip(at.prices, corners, strict=False))
        for z, p, q in zip(at.prices[len(working) :], other.pencils, self.pencils, strict=True):
            lifted += float((z * np.tensordot(x, p - q, 1)).sum())
        return -lifted - float(at.row_prices @ (other.rows - self.rows) @ x)

    def bound(self, at: Optimum) -> Array:
        """Return what is to be positive semidefinite at every vertex, (k, n, n).

        Parameters
        ----------
        at : robust.Solution
        """
        every = self.falls.bound(np.array([1.0, *at.x[:-1]]), at.multipliers[0])
        return np.asarray(every - self.spare + at.x[-1] * self.missed)

    def _over_few(
        self, likely: Sequence[int]
    ) -> tuple[Optimum, tuple[int, ...], tuple[int, ...]] | None:
        """Make the last parameter small at few vertices, and at more until all are kept.

        Returns the optimum, these vertices, and which of them are tight there.
        """
        corners = self.falls.of_used()[1]
        less = np.zeros((len(self.falls.there) + 1, *self.spare.shape))
        less[0], less[-1] = self.spare, -self.missed
        working = list(likely) or [len(corners) - 1]
        while True:
            few = [corners[k].less(less) for k in working]
            answer = optimise(
                self.cost,
                few,
                rows=self.rows,
                pencils=self.pencils,
                shared=True,
                tolerance=TOLERANCE,
            )
            if answer is None:
                return None
            values = np.linalg.eigvalsh(self.bound(answer))
            lowest = values[:, 0] / np.abs(values).max(axis=1)
            others = [int(k) for k in np.argsort(lowest) if k not in working]
            broken = [k for k in others[:MOST_NEW] if lowest[k] < BROKEN]
            if not broken:
                return answer, tuple(working), tuple(k for k in working if lowest[k] < TIGHT)
            working += broken


def _likely(v: Vehicles) -> Array:
    """Return 1 and weights as they may be: w2, w3, w4, a5 and a6, (6,)."""
    w2, w3, w4 = LIKELY
    lag = v.rotor_lag or 1.0
    return np.array([1, w2, w3, w4, w4 / (lag * v.stiff**2), w3 / (lag * v.pace**2)])
