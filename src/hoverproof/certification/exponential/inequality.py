"""The inequality of Ψ at every vertex of the tolerances, affine in weights and multipliers.

Everything is in floating point.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.buffered import Buffered
from hoverproof.certification.exponential.form import ROWS, Variables, Weights, derive_form
from hoverproof.certification.exponential.held import factor, moved
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.terms import terms
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.certification.robust import Inequality, Term
from hoverproof.servo.law import Law

Array = NDArray[np.float64]
W2, W3, W4, TORQUE, THRUST, SLOPE, MEMORY, NOISE, COMMAND, GUST = range(1, 11)
LEVEL, LIFT, HELD = range(11, 14)
"""Places among (1, parameters)."""
PARAMETERS = 13
SHAKEN = {"noise": NOISE, "command": COMMAND, "gust": GUST}
"""The places of what weighs each disturbance, by its name in `Limits.disturbances`."""
HOLD = {"level": LEVEL, "lift": LIFT, "command": HELD}
"""Likewise of the memory of each part of what is held, by its name in `held.moved`."""
ALONG_Y = 1, 4, 7, 10, 12, 15, 18
"""Places of what is along the second axis among the variables. No product in the inequality joins
it with the others, and it is in it as what is along the first: so it is left out."""


@dataclass(frozen=True)
class Falls:
    """The inequality at each vertex, affine in (1, parameters).

    Attributes
    ----------
    whole : Inequality
        Of all vertices: S is (k, 11, n, n), the u of the terms (k, 11, m, n), their v (k, m, n).
    used : (k,)
        Which parameters have a part in it, as places among (1, parameters).
    energy : (6, n, n)
        2 E, as what 1, w2, w3, w4, a5 and a6 multiply, with the largest lag.
    """

    whole: Inequality
    used: tuple[int, ...]
    energy: Array

    @property
    def there(self) -> list[int]:
        """Places of what has a part in it among (1, parameters)."""
        return [0, *self.used]

    def of_used(self) -> tuple[list[int], list[Inequality]]:
        """Return the places of (1, parameters) that have a part in it, and what these multiply."""
        S, terms, there = self.whole.S, self.whole.terms, self.there
        return there, [
            Inequality(S[k][there], tuple(Term(t.u[k][there], t.v[k], t.radius) for t in terms))
            for k in range(len(S))
        ]

    def bound(self, x: Array, tau: Array) -> Array:
        """Return M(τ) at every vertex, (k, n, n).

        Parameters
        ----------
        x : (j,)
            Bare numbers: what 1 and the parameters that are used are multiplied by.
        tau : (number of terms,)
            Positive.
        """
        values = np.zeros(1 + PARAMETERS)
        values[self.there] = x
        terms = (t._replace(u=np.einsum("p,kpmn->kmn", values, t.u)) for t in self.whole.terms)
        S = np.einsum("p,kpmn->kmn", values, self.whole.S)
        return Inequality(S, tuple(terms)).bound(np.tile(tau, (len(S), 1)))


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
    """Return the places of the variables that the inequality has, but for disturbances.

    Parameters
    ----------
    v : Vehicles
    """
    late, lagged = v.age > 0, v.rotor_lag > 0
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
    lagged, late, kept = v.rotor_lag > 0, v.age > 0, variables(v)
    shaken, held = [name for name, _ in limits.disturbances()], moved(limits)
    L, own = _variables(kept, [*shaken, *(f"held {name}" for name in held)])
    y, n = (np.pad(x, ((0, 0), (0, L.shape[1] - len(kept)))) for x in _flow_and_ahead(kept))
    there = ((TORQUE, lagged), (THRUST, lagged), (SLOPE, True), (MEMORY, late))
    used = (W2, W3, W4, *(name for name, has in there if has))
    used += (*(SHAKEN[name] for name in shaken), *(HOLD[name] for name in held))
    at = _at_vertices(limits, potential)
    S = np.zeros((len(at["fall"]), 1 + PARAMETERS, L.shape[1], L.shape[1]))
    S[:, :6] = L.T @ (at["fall"] - rate / 2 * at["energy"]) @ L
    S[:, SLOPE] = slope.lost(y, at["sum"][0, 0] @ L / float(v.design.slowness))
    for name in shaken:
        S[:, SHAKEN[name]] = own[name].T @ own[name]
    for d in (own[name] for name in ("command", "held command") if name in own):
        S[:, :6] -= _symmetric(at["torque" if lagged else "d4"][:, :, :1] @ L, d)
    if "gust" in own:  # in the forms it is in the place of y, but it is not in δ1'
        S[:, 0] -= _symmetric(L[[0, 2]], own["gust"])
    if late:
        S[:, MEMORY] = np.exp(-rate * v.age) / v.age * n.T @ n - v.age * y.T @ y
    at["yaw"] = at["d4"].copy()
    at["yaw"][:, W4] -= at["h3"][:, 0]
    pushed = {name: at[name] @ L for name in ("d4", "yaw", "torque", "lift")}
    parts = {name: at[name][:, 0] @ L for name in ROWS if name not in (*pushed, "fall", "energy")}
    parts["aside"], parts["slowly"] = _aside(at, v, potential) @ L, parts["applied"] / v.stiff
    for name, moves in held.items():
        S[:, HOLD[name]] = own[f"held {name}"].T @ own[f"held {name}"]
        S[:, HOLD[name]] -= factor(name, v, rate) * _spread(moves, parts | _upward(v, L))
    if v.swept:
        for x in (limits.sweep * parts["zeta"], v.yaw_rate * parts["aside"]):
            S[:, MEMORY] -= v.latency * x.swapaxes(-1, -2) @ x
        mine = {"flow": y, "level": y[:2], "swept": parts["zeta"]}
        pushed |= {name: _of_memory(2 * v.latency * x, len(S)) for name, x in mine.items()}
    each = [
        Term(_over_parameters(pushed[name]), parts[by], np.array(size))
        for name, by, size in terms(limits)
    ]
    return Falls(Inequality(S, tuple(each)), used, L.T @ at["energy"][-1] @ L)


def _variables(kept: Sequence[int], shaken: Sequence[str]) -> tuple[Array, dict[str, Array]]:
    """Return the variables of `form` by those that are left and by disturbances, and the latter.

    Noise is in the forms as what is used less what is now, and a gust as y.
    """
    L, own = np.eye(Variables.size())[:, kept], {}
    every = range(Variables.size())
    (ahead_x, _, ahead_z), (flow_x, _, flow_z) = (
        every[Variables.place(name)] for name in ("ahead", "flow")
    )
    places = {"noise": [ahead_x, ahead_z], "gust": [flow_x, flow_z]}
    places |= {"held level": [ahead_x], "held lift": [ahead_z]}
    for name in shaken:
        columns = np.zeros((len(L), 1))  # what is in no form
        if name in places:
            columns = np.eye(len(L))[:, places[name]]
        own[name] = L.shape[1] + np.arange(columns.shape[1])
        L = np.hstack([L, columns])
    return L, {name: np.eye(L.shape[1])[at] for name, at in own.items()}


def _spread(moves: Sequence[tuple[str, float]], parts: dict[str, Array]) -> Array:
    """Return ΣR Σ R|v|², above (Σ R|v|)²."""
    whole = sum(radius for _, radius in moves)
    return np.asarray(sum(whole * r * np.swapaxes(parts[n], -1, -2) @ parts[n] for n, r in moves))


def _upward(v: Vehicles, L: Array) -> dict[str, Array]:
    """Return (δ3 - δ2)z and δ3z + μT/κ."""
    row = np.eye(Variables.size())
    d2, d3, thrust = row[5], row[8], row[Variables.place("thrust")]
    return {"sinks": (d3 - d2)[None] @ L, "lifted": (d3[None] + thrust / v.pace) @ L}


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
    return np.asarray(np.eye(2, Variables.size()) + leans * at["pulled"][:, 0])


def _of_memory(rows: Array, count: int) -> Array:
    """Return rows that M alone multiplies at every vertex, (count, 1 + PARAMETERS, ..)."""
    u = np.zeros((count, 1 + PARAMETERS, *rows.shape[-2:]))
    u[:, MEMORY] = rows
    return u


def _over_parameters(rows: Array) -> Array:
    """Return rows of what 1, w2, w3, w4, a5 and a6 multiply, with a zero for all else."""
    u = np.zeros((len(rows), 1 + PARAMETERS, *rows.shape[2:]))
    u[:, : rows.shape[1]] = rows
    return u


def _at_vertices(limits: Limits, potential: bool) -> dict[str, Array]:
    """Return the matrices of k vertices by name, (k, 6, ..): what 1, w2 to w4, a5, a6 multiply."""
    v, k = limits.vehicles, 1 + Weights.size()
    vertices = np.array(list(limits.vertices()))
    weights = np.vstack([np.zeros(Weights.size()), np.eye(Weights.size())])
    count = len(vertices)
    given = np.tile(v.numbers, (k * count, 1)), vertices.repeat(k, axis=0)
    found = _at(v.law, v.rotor_lag > 0, potential, [*given, np.tile(weights, (count, 1))])
    found = found.reshape(count, k, *found.shape[1:])
    ends = np.cumsum(list(ROWS.values()))
    found[:, 1:, : ends[4]] -= found[:, :1, : ends[4]]
    return dict(zip(ROWS, np.split(found, ends[:-1], axis=2), strict=True))


def _at(law: Law, lagged: bool, potential: bool, given: Sequence[Array]) -> Array:
    """Evaluate the form at rows of designs, vertices and weights: (rows, 62, 20)."""
    count = len(given[0])
    form = _several(law, lagged, potential, count)
    rows, columns = form.size_out(0)
    (found,) = Buffered(form)(*(array.ravel() for array in given))
    return found.reshape(count, columns // count, rows).swapaxes(1, 2)


@cache
def _several(law: Law, lagged: bool, potential: bool, count: int) -> ca.Function:
    return derive_form(law, lagged, potential).map(count)
