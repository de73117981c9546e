"""The one robust inequality, S + Σ sym(uᵀHv) ≻ 0 for every H with |H| <= r, in floating point.

Each term of the sum has an H of its own, and sym A = (A + Aᵀ)/2. Petersen's step: the inequality
holds if some τ > 0, one a term, give

    M(τ) = S - Σ (r/2)(τ vᵀv + uᵀu/τ) ≻ 0,

and with a single term only if. A matrix Q in a ball about jI is H = Q - jI, its middle being part
of S; whether Q is symmetric makes no difference.

`margins` asks how far M can be from singular, for many inequalities at once. `optimise` asks which
parameters are best, where S and u are affine in them. What the numbers are worth is decided
elsewhere, exactly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.one_multiplier import climbed
from hoverproof.certification.semidefinite import TOLERANCE, Multipliers, minimise

Array = NDArray[np.float64]


class Term(NamedTuple):
    """One uncertain term, sym(uᵀHv) for every H with |H| <= radius.

    Attributes
    ----------
    u, v : (..., m, n)
        Matrices of the bilinear form.
    radius : (...)
        r; its unit is that of S over that of uᵀv.
    """

    u: Array
    v: Array
    radius: Array


@dataclass(frozen=True)
class Inequality:
    """S + Σ sym(uᵀHv) ≻ 0: one, or k of them, or one that is affine in parameters.

    Attributes
    ----------
    S : (..., n, n)
        Symmetric. Its first axis counts inequalities, or what 1 and each parameter multiply.
    terms : tuple of Term
        Their u have that axis too; v and radius have it, if at all, where it counts inequalities.
    """

    S: Array
    terms: tuple[Term, ...]

    def at(self, x: Sequence[float] | Array) -> Inequality:
        """Put in parameters.

        Parameters
        ----------
        x : (k,)
            What S[0], S[1], … are multiplied by.
        """
        terms = (t._replace(u=np.tensordot(x, t.u, 1)) for t in self.terms)
        return Inequality(np.tensordot(x, self.S, 1), tuple(terms))

    def scaled(self, weights: Array) -> Inequality:
        """Return the inequality in √w X, so that a margin of it is one in units of w.

        Parameters
        ----------
        weights : (n,)
            Positive.
        """
        root = np.sqrt(weights)
        terms = (Term(t.u / root, t.v / root, t.radius) for t in self.terms)
        return Inequality(self.S / np.outer(root, root), tuple(terms))

    def less(self, matrices: Array) -> Inequality:
        """Take matrices from what 1 and the parameters multiply, new parameters among them.

        Parameters
        ----------
        matrices : (j, n, n)
        """
        size = max(len(self.S), len(matrices))
        terms = (t._replace(u=_lengthened(t.u, size)) for t in self.terms)
        return Inequality(_lengthened(self.S, size) - _lengthened(matrices, size), tuple(terms))

    def bound(self, tau: Array | Sequence[float]) -> Array:
        """Return M(τ), (..., n, n).

        Parameters
        ----------
        tau : (..., number of terms)
            Positive.
        """
        parts = self.parts()
        each = np.moveaxis(np.asarray(tau, float), -1, 0)[..., None, None]
        return np.asarray(parts[0] + (each * parts[1::2] + parts[2::2] / each).sum(axis=0))

    def parts(self) -> Array:
        """Return S, and -(r/2) vᵀv and -(r/2) uᵀu of each term, (1 + 2 terms, ..., n, n)."""
        parts = [self.S]
        for u, v, radius in self.terms:
            half = -np.asarray(radius)[..., None, None] / 2
            parts += [half * (x.swapaxes(-1, -2) @ x) for x in (v, u)]
        return np.array(np.broadcast_arrays(*parts))


def _lengthened(array: Array, size: int) -> Array:
    return np.concatenate([array, np.zeros((size - len(array), *array.shape[1:]))])


def margins(inequality: Inequality, floor: float = -np.inf) -> tuple[Array, Array]:
    """Return the largest least eigenvalue of M(τ) over τ, and where it is, (..., terms).

    It is a lower bound of the least eigenvalue of S + Σ sym(uᵀHv) over all H, and with a single
    term it is that.

    Parameters
    ----------
    inequality : Inequality
        One, or k of them if it has a single term.
    floor : float
        Of margins that are surely below, no more than that is found out; in the unit of S.

    Raises
    ------
    LinAlgError
        If the numbers are not finite, or the solver finds no multipliers.
    """
    if len(inequality.terms) == 1:
        parts = inequality.parts()
        values, tau = climbed(parts.reshape(3, -1, *parts.shape[-2:]), floor)
        lead = inequality.S.shape[:-2]
        return values.reshape(lead), tau.reshape(*lead, 1)
    S, terms = inequality.S[None], tuple(t._replace(u=t.u[None]) for t in inequality.terms)
    by_margin = np.stack([np.zeros_like(S[0]), np.eye(len(S[0]))])
    solution = optimise([-1.0], [Inequality(S, terms).less(by_margin)])
    if solution is None:
        raise np.linalg.LinAlgError("the solver found no multipliers")
    found = np.maximum(solution.multipliers[0], np.finfo(float).tiny)
    return np.linalg.eigvalsh(inequality.bound(found))[0], found


def worst_case(inequality: Inequality, tau: float) -> tuple[Array, Array]:
    """Return the worst case found: a vector X, (n,), and the axis w, (m,), of the extremal H.

    H = r(I - 2wwᵀ/wᵀw) mirrors v X into the direction opposite to u X, so that the inequality's
    form comes down to XᵀSX - r|uX||vX|.

    At the best τ some X in the lowest eigenspace of M has |u| = τ|v|; if that space has several
    dimensions, X is mixed from the two directions in which |u|² - τ²|v|² has opposite signs.

    Parameters
    ----------
    inequality : Inequality
        One, of a single term.
    tau : float
        The best τ, a scalar.
    """
    ((u, v, radius),) = inequality.terms
    values, vectors = np.linalg.eigh(inequality.bound([tau]))
    scale = np.abs(values).max()

    def mixed(tolerance: float) -> Array:
        space = vectors[:, values <= values[0] + tolerance * scale]
        U, V = u @ space, v @ space
        balance, mix = np.linalg.eigh(U.T @ U - tau**2 * V.T @ V)
        low, high = balance[0], balance[-1]
        if not low < 0 < high:
            return np.asarray(space @ mix[:, np.argmin(np.abs(balance))])
        share = np.arctan(np.sqrt(-low / high))
        return np.asarray(space @ (np.cos(share) * mix[:, 0] + np.sin(share) * mix[:, -1]))

    def quotient(x: Array) -> float:
        lost = radius * np.linalg.norm(u @ x) * np.linalg.norm(v @ x)
        return float((x @ inequality.S @ x - lost) / (x @ x))

    x = min((mixed(tolerance) for tolerance in (0.0, 1e-9, 1e-6, 1e-4)), key=quotient)
    tiny = np.finfo(float).tiny
    axes = [y / max(float(np.linalg.norm(y)), tiny) for y in (u @ x, v @ x)]
    return x, axes[0] + axes[1]


class Solution(NamedTuple):
    """What the solver found.

    Attributes
    ----------
    x : (k,)
        Parameters.
    multipliers : list of (m,) each
        Of the m terms of each corner.
    prices : list of (n, n) each
        By how much the cost falls at most, to first order, as M(τ) of each corner grows, and then
        each pencil: for a small change A of it by the trace of prices times A.
    row_prices : (j,)
        The same of the rows, bare numbers.
    """

    x: Array
    multipliers: list[Array]
    prices: list[Array]
    row_prices: Array


def optimise(
    cost: Sequence[float],
    corners: Sequence[Inequality],
    *,
    rows: Array | None = None,
    pencils: Sequence[Array] = (),
    shared: bool = False,
    tolerance: float = TOLERANCE,
) -> Solution | None:
    """Minimise a linear function of parameters for which M(τ) ⪰ 0 at every corner, for some τ.

    Parameters
    ----------
    cost : (k,)
        What the parameters x are multiplied by.
    corners : sequence of Inequality
        Affine in (1, x); where there is nothing for the last of these, it may be left out.
    rows : (j, 1 + k), optional
        Each times (1, x) is to be 0 or more.
    pencils : sequence of (1 + k, p, p)
        Each times (1, x) is to be positive semidefinite.
    shared : bool
        Whether all corners are to have the same τ.
    tolerance : float
        Of the solver, a bare number.

    Returns
    -------
    Solution, or None if the solver finds none
    """
    posed, places = _posed(cost, corners, rows, pencils, shared)
    x, found = minimise(*posed, tolerance)
    if x is None or found is None:
        return None
    each = [x[p - 1 : p - 1 + len(c.terms)] for p, c in zip(places, corners, strict=True)]
    sizes = [c.S.shape[-1] for c in corners] + [p.shape[-1] for p in pencils]
    prices = [z[:n, :n] for z, n in zip(found.pencils, sizes, strict=True)]
    return Solution(x[: len(cost)], each, prices, found.rows)


def refuse(
    cost: Sequence[float],
    corners: Sequence[Inequality],
    *,
    rows: Array,
    pencils: Sequence[Array] = (),
) -> tuple[float, Multipliers] | None:
    """Return how low `optimise`, with shared multipliers, comes, and what shows that it is no less.

    What belongs to corners belongs to M with each uᵀu/τ a Schur complement: the rows of √(r/2) u
    stand below S, in the order of the terms, and τ I beside them.

    Parameters
    ----------
    cost, corners, rows, pencils
        See `optimise`; numbers.

    Returns
    -------
    The least cost, infinite if nothing is allowed, and the multipliers of rows, and of corners and
    pencils; None if the solver comes to no end
    """
    x, multipliers = minimise(*_posed(cost, corners, rows, pencils, shared=True)[0])
    if multipliers is None:
        return None
    return np.inf if x is None else float(np.dot(cost, x[: len(cost)])), multipliers


def _posed(
    cost: Sequence[float],
    corners: Sequence[Inequality],
    rows: Array | None,
    pencils: Sequence[Array],
    shared: bool,
) -> tuple[tuple[Array, Array, list[Array]], list[int]]:
    """Return cost, rows and pencils of (1, x, all τ), and the places of the first τ of corners."""
    first, counts = 1 + len(cost), [len(c.terms) for c in corners]
    places = [first + (0 if shared else sum(counts[:k])) for k in range(len(corners))]
    size = places[-1] + counts[-1]
    matrices = [_pencil(c, p, size) for c, p in zip(corners, places, strict=True)]
    matrices += [_lengthened(p, size) for p in pencils]
    linear = np.zeros((size, 0)) if rows is None else _lengthened(np.transpose(rows), size)
    return (_lengthened(np.array(cost, float), size - 1), linear, matrices), places


def _pencil(corner: Inequality, place: int, size: int) -> Array:
    """Return M(τ) ⪰ 0, each uᵀu/τ a Schur complement, as what (1, x, all τ) multiply.

    The first multiplier of the corner is at that place among so many.
    """
    k, n = corner.S.shape[:2]
    result = np.zeros((size, *[n + sum(t.u.shape[1] for t in corner.terms)] * 2))
    result[:k, :n, :n] = corner.S
    end = n
    for j, (u, v, radius) in enumerate(corner.terms, place):
        rows, end = slice(end, end + u.shape[1]), end + u.shape[1]
        result[:k, rows, :n] = np.sqrt(radius / 2) * u
        result[:k, :n, rows] = result[:k, rows, :n].swapaxes(1, 2)
        result[j, :n, :n] = -radius / 2 * v.T @ v
        result[j, rows, rows] = np.eye(u.shape[1])
    return result


def reciprocals(most: float, factors: Mapping[int, float], size: int) -> Array:
    """Return Σ pᵢ/xᵢ <= most as a pencil, (size, p, p), of (1, x); all these xᵢ are then positive.

    Parameters
    ----------
    most : float
        A positive scalar.
    factors : mapping
        From the place among (1, x) to pᵢ, positive.
    size : int
        Number of (1, x).
    """
    pencil = np.zeros((size, len(factors) + 1, len(factors) + 1))
    pencil[0, 0, 0] = 1
    for i, (place, factor) in enumerate(factors.items(), 1):
        pencil[0, 0, i] = pencil[0, i, 0] = np.sqrt(factor / most)
        pencil[place, i, i] = 1
    return pencil
