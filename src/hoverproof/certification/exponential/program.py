"""Weights and multipliers by one semidefinite program, in floating point.

For a given reach of the errors, a ball of J and a rate, everything is convex in the weights, the
multipliers and what the memory of the latency weighs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
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
W2, W3, W4, TORQUE, THRUST, SLOPE, MEMORY, NOISE, COMMAND, GUST = range(1, 11)
"""Places among (1, parameters)."""
PARAMETERS = 10
SHAKEN = {"noise": NOISE, "command": COMMAND, "gust": GUST}
"""The places of what weighs each disturbance, by its name in `Limits.disturbances`."""
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
    lagged, late = v.rotor_lag > 0, v.latency > 0
    has = {"ahead": late, "torque": lagged, "thrust": lagged}
    kept = [
        place
        for name in Variables.sizes()
        if has.get(name, True)
        for place in range(Variables.size())[Variables.place(name)]
        if place not in ALONG_Y
    ]
    shaken = [name for name, _ in limits.disturbances()]
    L, own = _variables(kept, shaken)
    y, n = (np.pad(x, ((0, 0), (0, L.shape[1] - len(kept)))) for x in _flow_and_ahead(kept))
    terms = limits.terms()
    there = ((TORQUE, lagged), (THRUST, lagged), (SLOPE, True), (MEMORY, late))
    used = (W2, W3, W4, *(name for name, has in there if has), *(SHAKEN[name] for name in shaken))
    corners = []
    for at in _at_vertices(limits, potential):
        S = np.zeros((1 + PARAMETERS, L.shape[1], L.shape[1]))
        S[:6] = L.T @ (at["fall"] - rate / 2 * at["energy"]) @ L
        S[SLOPE] = slope.lost(y, at["sum"][0] @ L / float(v.design.slowness))
        for name, d in own.items():
            S[SHAKEN[name]] = d.T @ d
        if "command" in own:
            S[:6] -= _symmetric(at["torque" if lagged else "d4"][:, :1] @ L, own["command"])
        if "gust" in own:  # in the forms it is in the place of y, but it is not in δ1'
            S[0] -= _symmetric(L[[0, 2]], own["gust"])
        if late:
            forgets = np.exp(-rate * v.latency)
            S[MEMORY] = forgets / v.latency * n.T @ n - v.latency * y.T @ y
        at["yaw"] = at["d4"].copy()
        at["yaw"][W4] -= at["h3"][0]
        pushed = {name: at[name] @ L for name in ("d4", "yaw", "torque", "lift")}
        parts = {name: at[name][0] @ L for name in ROWS if name not in (*pushed, "fall", "energy")}
        parts["aside"] = _aside(at, v, potential) @ L
        if v.swept:
            swept = limits.sweep * parts["zeta"], v.yaw_rate * parts["aside"]
            S[MEMORY] -= v.latency * sum(x.T @ x for x in swept)
            mine = {"flow": y, "level": y[:2], "swept": parts["zeta"]}
            pushed |= {name: _of_memory(2 * v.latency * x) for name, x in mine.items()}
        each = [
            Term(_over_parameters(pushed[name]), parts[by], np.array(size))
            for name, by, size in terms
        ]
        corners.append(Inequality(S, tuple(each)))
    return Falls(tuple(corners), used)


def _variables(kept: Sequence[int], shaken: Sequence[str]) -> tuple[Array, dict[str, Array]]:
    """Return the variables of `form` by those that are left and by disturbances, and the latter.

    Noise is in the forms as what is used less what is now, and a gust as y.
    """
    L, own = np.eye(Variables.size())[:, kept], {}
    places = {"noise": "ahead", "gust": "flow"}
    for name in shaken:
        sides = range(Variables.size())[Variables.place(places.get(name, "flow"))]
        columns = np.eye(len(L))[:, [k for k in sides if k not in ALONG_Y]]
        columns = columns if name in places else np.zeros((len(L), 1))
        own[name] = L.shape[1] + np.arange(columns.shape[1])
        L = np.hstack([L, columns])
    return L, {name: np.eye(L.shape[1])[at] for name, at in own.items()}


def _flow_and_ahead(kept: Sequence[int]) -> Iterator[Array]:
    """Yield y and n of the variables that are left."""
    for name in ("flow", "ahead"):
        yield np.eye(Variables.size())[:, kept][Variables.place(name)]


def _symmetric(left: Array, right: Array) -> Array:
    """Return the matrix of the form (left X)ᵀ(right X)."""
    product: Array = np.asarray(np.swapaxes(left, -1, -2) @ right)
    return np.asarray(product + np.swapaxes(product, -1, -2)) / 2.0


def _aside(at: dict[str, Array], v: Vehicles, potential: bool) -> Array:
    """Return P s: P δ1, and s3* Pρ besides where the goal, or e, is not fixed in the image."""
    leans = 0.0 if v.in_image and not potential else v.goal * v.stiffness / v.weight
    return np.eye(2, Variables.size()) + leans * at["pulled"][0]


def _of_memory(rows: Array) -> Array:
    """Return rows that M alone multiplies, (1 + PARAMETERS, ..)."""
    u = np.zeros((1 + PARAMETERS, *rows.shape))
    u[MEMORY] = rows
    return u


def _over_parameters(rows: Array) -> Array:
    """Return rows of what 1, w2, w3, w4, a5 and a6 multiply, with a zero for all else."""
    rest = np.zeros((1 + PARAMETERS - len(rows), *rows.shape[1:]))
    return np.concatenate([rows, rest])


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
    noise : dict
        σ by the name of the disturbance: what its square adds to the rate of Ψ, 1/s.
    floor : float
        ℓ∞, dimensionless: what disturbances leave of Ψ.
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
    noise: dict[str, float] = field(default_factory=dict)
    floor: float = 0.0
    tight: tuple[int, ...] = ()

    @property
    def fill(self) -> float:
        """Ψ at the starts over ℓ: they are inside if it is 1 or less."""
        return self.start / self.level

    @property
    def reach(self) -> Reach:
        """How large the errors are on the set."""
        return Reach.of(self.weights, self.level)


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
    starts : (k, 11)
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
    low, high = ball
    found = falls(limits, Ball((low + high) / 2, (high - low) / 2), rate)
    there, corners = found.of_used()
    place = {name: there.index(name) for name in found.used}
    size = len(there) + 1  # and the largest Ψ/ℓ of the starts, the last
    spare = np.zeros_like(corners[0].S)
    spare[0] = SPARE * np.eye(spare.shape[1]) / max(1.0, high)
    corners = [c.less(spare) for c in corners]
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
    shaken = {name: bound**2 / rate for name, bound in limits.disturbances()}
    if shaken and np.isfinite(floor):
        left = np.eye(size)[0] * floor
        left -= sum(x * np.eye(size)[place[SHAKEN[name]]] for name, x in shaken.items())
        rows = np.vstack([rows, left / max(floor, 1e-300)])
    found_at = _over_few(size, corners, rows, pencils, likely)
    if found_at is None or not (found_at[0].x[:-1] > 0).all():
        return None
    answer, tight = found_at
    values = {name: float(answer.x[place[name] - 1]) for name in found.used}
    return Solution(
        weights=np.array([values[w] for w in (W2, W3, W4)]),
        lag=np.array([values[TORQUE], values[THRUST]]) if TORQUE in values else None,
        memory=values.get(MEMORY),
        slope=values[SLOPE],
        multipliers=answer.multipliers[0],
        level=level,
        noise={name: values[SHAKEN[name]] for name in shaken},
        floor=sum(x * values[SHAKEN[name]] for name, x in shaken.items()),
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
