"""The lossless linear matrix inequality for Σ ≻ 0 over all Q with bounded eigenvalues.

Σ = [terms without Q] + k1 sym(uᵀQv). With Q = λ̄I + ϱH, |H| ≤ 1, Petersen's lemma gives: Σ ⪰ t I for
all such Q if and only if, for some τ > 0,

    M(τ) = Σ(λ̄I) - (k1 ϱ/2)(τ vᵀv + uᵀu/τ) ⪰ t I.

This module works in floating point: it finds a multiplier and a worst case. What they are worth is
decided elsewhere, exactly.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

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
    """

    sigma: Array
    u: Array
    v: Array
    spread: float

    def bound(self, tau: float) -> Array:
        """Return M(τ), (11, 11)."""
        loss = tau * self.v.T @ self.v + self.u.T @ self.u / tau
        return np.asarray(self.sigma - self.spread * loss)

    def margin(self, tau: float) -> float:
        """Return the smallest eigenvalue of M(τ), kg/s."""
        return float(np.linalg.eigvalsh(self.bound(tau))[0])


def best_multiplier(vertex: Vertex) -> float:
    """Return the τ that maximises the smallest eigenvalue of M(τ) at a vertex.

    Raises
    ------
    RuntimeError
        If the solver finds nothing.
    """
    n = len(vertex.sigma)
    tau, t = cp.Variable(), cp.Variable()
    root = np.sqrt(vertex.spread)
    block = cp.bmat(
        [
            [
                vertex.sigma - vertex.spread * tau * (vertex.v.T @ vertex.v) - t * np.eye(n),
                root * vertex.u.T,
            ],
            [root * vertex.u, tau * np.eye(3)],
        ]
    )
    problem = cp.Problem(cp.Maximize(t), [(block + block.T) / 2 >> 0])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # an inaccurate multiplier costs margin, never soundness
        try:
            problem.solve(solver=cp.CLARABEL)
        except cp.SolverError as error:
            raise RuntimeError(f"the solver failed: {error}") from None
    if tau.value is None or not np.isfinite(tau.value) or tau.value <= 0:
        raise RuntimeError(f"the solver found no multiplier ({problem.status})")
    return _polish(vertex, float(tau.value))


def _polish(vertex: Vertex, tau: float) -> float:
    """Sharpen τ by golden-section search: the margin is a concave function of τ."""
    golden = (np.sqrt(5) - 1) / 2
    low, high = tau * (1 - 1e-3), tau * (1 + 1e-3)
    for _ in range(60):
        a, b = high - golden * (high - low), low + golden * (high - low)
        if vertex.margin(a) < vertex.margin(b):
            low = a
        else:
            high = b
    middle = (low + high) / 2
    return max((tau, middle), key=vertex.margin)


def worst_direction(vertex: Vertex, tau: float) -> tuple[Array, Array]:
    """Return the worst case found: the error vector X (11,) and the axis w (3,) of the extremal Q.

    The extremal Q = λ̄I + ϱ(I - 2wwᵀ/wᵀw) mirrors v into the direction opposite to u, which gives
    XᵀΣX = XᵀΣ(λ̄I)X - k1 ϱ|u||v|.

    At the best τ some X in the lowest eigenspace of M has |u| = τ|v|; if that space has several
    dimensions, X is mixed from the two directions in which |u|² - τ²|v|² has opposite signs.
    """
    values, vectors = np.linalg.eigh(vertex.bound(tau))
    scale = np.abs(values).max()
    candidates = []
    for tolerance in (0.0, 1e-9, 1e-6, 1e-4):
        space = vectors[:, values <= values[0] + tolerance * scale]
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
        return float((x @ vertex.sigma @ x - 2 * vertex.spread * u * v) / (x @ x))

    x = min(candidates, key=quotient)
    u, v = vertex.u @ x, vertex.v @ x
    tiny = np.finfo(float).tiny
    return x, u / max(float(np.linalg.norm(u)), tiny) + v / max(float(np.linalg.norm(v)), tiny)
