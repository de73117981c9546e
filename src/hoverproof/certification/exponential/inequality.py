"""The inequality of Ψ at every vertex of the tolerances, affine in weights and multipliers.

Everything is in floating point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.form import ROWS, Variables, Weights, derive_form
from hoverproof.certification.exponential.vehicles import Limits
from hoverproof.certification.robust import Inequality, Term
from hoverproof.servo.law import Law

Array = NDArray[np.float64]
W2, W3, W4, TORQUE, THRUST, SLOPE, MEMORY, NOISE = range(1, 9)
"""Places among (1, parameters)."""
PARAMETERS = 8
ALONG_Y = 1, 4, 7, 10, 12, 15, 18
"""Places of what is along the second axis among the variables. No product in the inequality joins
it with the others, and it is in it as what is along the first: so it is left out."""


@dataclass(frozen=True)
class Falls:
    """The inequality at each vertex, affine in (1, parameters).

    Attributes
    ----------
    whole : Inequality
        Of all vertices: S is (k, 9, n, n), the u of the terms are (k, 9, m, n), their v (k, m, n).
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
            What 1 and the parameters that are used are multiplied by.
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
    kept = [
        place
        for name, there in (
            ("errors", True),
            ("flow", True),
            ("ahead", late),
            ("torque", lagged),
            ("thrust", lagged),
        )
        if there
        for place in range(Variables.size())[Variables.place(name)]
        if place not in ALONG_Y
    ]
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
    at = _at_vertices(limits, potential)
    S = np.zeros((len(at["fall"]), 1 + PARAMETERS, L.shape[1], L.shape[1]))
    S[:, :6] = L.T @ (at["fall"] - rate / 2 * at["energy"]) @ L
    S[:, SLOPE] = slope.lost(y, at["sum"][0, 0] @ L / float(v.design.slowness))
    S[:, NOISE] = nu.T @ nu
    if late:
        forgets = np.exp(-rate * v.latency)
        S[:, MEMORY] = forgets / v.latency * n.T @ n - v.latency * y.T @ y
    at["yaw"] = at["d4"].copy()
    at["yaw"][:, W4] -= at["h3"][:, 0]
    each = []
    for pushed, by, size in terms:
        u = np.zeros((len(S), 1 + PARAMETERS, at[pushed].shape[2], L.shape[1]))
        u[:, :6] = at[pushed] @ L
        each.append(Term(u, at[by][:, 0] @ L, np.array(size)))
    return Falls(Inequality(S, tuple(each)), used, L.T @ at["energy"][-1] @ L)


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
    form = _several(law, lagged, potential, len(given[0]))
    rows, columns = form.size_out(0)
    found = np.empty((len(given[0]), columns // len(given[0]), rows))
    buffer, evaluate = form.buffer()
    arrays: list[Any] = [np.ascontiguousarray(array, float) for array in given]
    for k, array in enumerate(arrays):  # casadi's stubs ask for a size besides
        buffer.set_arg(k, memoryview(array))  # type: ignore[call-arg]
    whole: Any = found
    buffer.set_res(0, memoryview(whole))  # type: ignore[call-arg]
    evaluate()
    return found.swapaxes(1, 2)


@cache
def _several(law: Law, lagged: bool, potential: bool, count: int) -> ca.Function:
    return derive_form(law, lagged, potential).map(count)
