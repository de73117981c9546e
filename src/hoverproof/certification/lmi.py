"""The lossless linear matrix inequality for Σ ≻ 0 over all Q with bounded eigenvalues.

Σ = [terms without Q] + k1 sym(uᵀQv). With Q = λ̄I + ϱH, |H| ≤ 1, Petersen's lemma gives: Σ ⪰ t W for
all such Q if and only if, for some τ > 0,

    M(τ) = Σ(λ̄I) - (k1 ϱ/2)(τ vᵀv + uᵀu/τ) ⪰ t W,      W = diag(w1 I, w2 I, w3 I, w4 I).

This module works in floating point: it finds multipliers, worst cases and weights. What they are
worth is decided elsewhere, exactly.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import clarabel
import numpy as np
import scipy.linalg  # noqa: F401  clarabel loads it, and takes Ctrl-C meanwhile for a fault of its own
from numpy.typing import NDArray
from scipy import sparse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Vertex:
    """One corner of the question, in floating point.

    Attributes
    ----------
    sigma : (11, 11)
        Σ at Q = λ̄I, kg/s.
    u, v : (3, 11)
        Matrices of the bilinear form k1 uᵀQv.
    spread : float
        k1 ϱ/2, kg/s.
    weights : (11,)
        Diagonal of W.
    """

    sigma: Array
    u: Array
    v: Array
    spread: float
    weights: Array

    def bound(self, tau: float) -> Array:
        """Return W^(-½) M(τ) W^(-½), (11, 11), kg/s.

        Parameters
        ----------
        tau : float
            τ, a positive number.
        """
        loss = tau * self.v.T @ self.v + self.u.T @ self.u / tau
        root = np.sqrt(self.weights)
        return np.asarray((self.sigma - self.spread * loss) / np.outer(root, root))

    def margin(self, tau: float) -> float:
        """Return the largest t with M(τ) ⪰ t W, kg/s.

        Parameters
        ----------
        tau : float
            τ, a positive number.
        """
        return float(np.linalg.eigvalsh(self.bound(tau))[0])


def inequality(vertex: Vertex) -> tuple[Array, Array, Array]:
    """Return B0, B1, B2, each (14, 14), of the inequality B0 + τ B1 + t B2 ⪰ 0.

    It is M(τ) ⪰ t W with uᵀu/τ written as a Schur complement.

    Parameters
    ----------
    vertex : Vertex
    """
    n = len(vertex.sigma)
    constant, by_tau, by_t = (np.zeros((n + 3, n + 3)) for _ in range(3))
    constant[:n, :n] = vertex.sigma
    constant[n:, :n] = np.sqrt(vertex.spread) * vertex.u
    constant[:n, n:] = constant[n:, :n].T
    by_tau[:n, :n] = -vertex.spread * vertex.v.T @ vertex.v
    by_tau[n:, n:] = np.eye(3)
    by_t[:n, :n] = -np.diag(vertex.weights)
    return constant, by_tau, by_t


def best_multiplier(vertex: Vertex) -> float:
    """Return the τ that maximises the margin at a vertex.

    Parameters
    ----------
    vertex : Vertex

    Raises
    ------
    RuntimeError
        If the solver finds nothing.
    """
    constant, by_tau, by_t = inequality(vertex)
    columns = np.column_stack([-_stacked(by_tau), -_stacked(by_t)])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solution = clarabel.DefaultSolver(
        sparse.csc_matrix((2, 2)),
        np.array([0.0, -1.0]),
        sparse.csc_matrix(columns),
        _stacked(constant),
        [clarabel.PSDTriangleConeT(len(constant))],
        settings,
    ).solve()
    tau = float(solution.x[0])
    if not np.isfinite(tau) or tau <= 0:
        raise RuntimeError(f"the solver found no multiplier ({solution.status})")
    return _polish(vertex, tau)


def _stacked(matrix: Array) -> Array:
    """Return the upper triangle, column by column, its off-diagonal entries times √2."""
    columns, rows = np.tril_indices(len(matrix))
    scale = np.where(rows == columns, 1.0, np.sqrt(2))
    return np.asarray(matrix[rows, columns] * scale)


def _polish(vertex: Vertex, tau: float) -> float:
    """Sharpen τ by golden-section search: the margin is a concave function of τ."""
    golden = (np.sqrt(5) - 1) / 2
    low, high, middle = tau / 1.05, tau * 1.05, vertex.margin(tau)
    while low > 1e-12 and vertex.margin(low) >= middle:  # the solver may be off by some percent
        low /= 2
    while high < 1e12 and vertex.margin(high) >= middle:
        high *= 2
    a, b = high - golden * (high - low), low + golden * (high - low)
    at_a, at_b = vertex.margin(a), vertex.margin(b)
    for _ in range(40):
        if at_a < at_b:
            low, a, at_a = a, b, at_b
            b = low + golden * (high - low)
            at_b = vertex.margin(b)
        else:
            high, b, at_b = b, a, at_a
            a = high - golden * (high - low)
            at_a = vertex.margin(a)
    candidates: list[float] = [tau, float(a), float(b)]
    return max(candidates, key=vertex.margin)


def worst_direction(vertex: Vertex, tau: float) -> tuple[Array, Array]:
    """Return the worst case found: the error vector X (11,) and the axis w (3,) of the extremal Q.

    The extremal Q = λ̄I + ϱ(I - 2wwᵀ/wᵀw) mirrors v into the direction opposite to u, which gives
    XᵀΣX = XᵀΣ(λ̄I)X - k1 ϱ|u||v|.

    At the best τ some X in the lowest eigenspace has |u| = τ|v|; if that space has several
    dimensions, X is mixed from the two directions in which |u|² - τ²|v|² has opposite signs.

    Parameters
    ----------
    vertex : Vertex
    tau : float
        τ, a positive number.
    """
    values, vectors = np.linalg.eigh(vertex.bound(tau))
    scale = np.abs(values).max()
    root = np.sqrt(vertex.weights)
    candidates = []
    for tolerance in (0.0, 1e-9, 1e-6, 1e-4):
        space = vectors[:, values <= values[0] + tolerance * scale] / root[:, None]
        U, V = vertex.u @ space, vertex.v @ space
        balance, mix = np.linalg.eigh(U.T @ U - tau**2 * V.T @ V)
        low, high = balance[0], balance[-1]
        if low < 0 < high:
            share = np.arctan(np.sqrt(-low / high))
            y = np.cos(share) * mix[:, 0] + np.sin(share) * mix[:, -1]
        else:
            y = mix[:, np.argmin(np.abs(balance))]
        candidates.append(space @ y)

    def quotient(x: Array) -> float:
        u, v = np.linalg.norm(vertex.u @ x), np.linalg.norm(vertex.v @ x)
        lost = 2 * vertex.spread * u * v
        return float((x @ vertex.sigma @ x - lost) / (x @ (vertex.weights * x)))

    x = min(candidates, key=quotient)
    u, v = vertex.u @ x, vertex.v @ x
    tiny = np.finfo(float).tiny
    return x, u / max(float(np.linalg.norm(u)), tiny) + v / max(float(np.linalg.norm(v)), tiny)


def best_weights(families: Sequence[Sequence[Vertex]]) -> Array:
    """Return the weights w, (4,), w1 = 1, that maximise the margin over all vertices.

    For a fixed margin the inequality is linear in (w, τ); the margin is found by bisection.

    Parameters
    ----------
    families : one sequence a vertex, of four `Vertex` each
        The vertex with one weight 1 and the others 0: Σ and u are linear in w.
    """
    import cvxpy as cp

    weights = cp.Variable(4, nonneg=True)
    margin = cp.Parameter(nonneg=True)
    slack = cp.Variable()
    constraints = [weights[0] == 1]
    for family in families:
        parts = [inequality(vertex) for vertex in family]
        tau = cp.Variable(nonneg=True)
        constant = sum(weights[i] * parts[i][0] for i in range(4))
        lost = sum(margin * weights[i] * parts[i][2] for i in range(4))
        block = constant + tau * parts[0][1] + lost - slack * np.eye(len(parts[0][0]))
        constraints.append((block + block.T) / 2 >> 0)
    problem = cp.Problem(cp.Maximize(slack), [*constraints, slack <= 1])

    def feasible(value: float) -> Array | None:
        margin.value = value
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # inaccurate weights cost decay, never soundness
            try:
                problem.solve(solver=cp.CLARABEL)
            except cp.SolverError:
                return None
        good = slack.value is not None and slack.value > 0 and weights.value.min() > 0
        return np.array(weights.value) if good else None

    ones = np.ones(4)
    low, high, best = 0.0, 1.0, ones
    while (found := feasible(high)) is not None and high < 1e9:
        low, high, best = high, 2 * high, found
    for _ in range(40):
        middle = (low + high) / 2
        found = feasible(middle)
        if found is None:
            high = middle
        else:
            low, best = middle, found
    return best
