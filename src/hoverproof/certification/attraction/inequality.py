"""Weights, level and multipliers of Λ by one semidefinite program, in floating point.

For a given bound |F| <= d and a given bound λ of the eigenvalues of Q, everything is convex in
μ = 1/ℓ and b = a/ℓ: the inequality -(m/k1) Λ̇/ℓ ⪰ ε μ |Y|², the bound of the force
d²/c² >= 2 (1/b2 + 1/b3), the bound of the term w of the height, and Λ/ℓ at hovers.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.form import derive_form
from hoverproof.mission import Mission
from hoverproof.servo.error_chain import Design
from hoverproof.servo.lyapunov import ERROR_SIZE, thrust_factor

Array = NDArray[np.float64]
LEAST_RATE = 0.1
"""ε that the program asks for; what is proved in the end is what the rounded numbers give."""


@cache
def _form_function() -> ca.Function:
    return derive_form().function()


@cache
def _factor_function() -> ca.Function:
    d, thrust = Design.symbols(), ca.SX.sym("T")
    return ca.Function("factor", [d.vector(), thrust], [thrust_factor(thrust, d)])


@dataclass(frozen=True)
class Loop:
    """The numbers of a loop that the inequality needs.

    Attributes
    ----------
    design : (13,)
        In the order of `Design`.
    weight, stiffness : float
        m g and c = k1² k2/m, N.
    q3 : float
        q3*, dimensionless.
    """

    design: Array
    weight: float
    stiffness: float
    q3: float

    @classmethod
    def of(cls, mission: Mission, q3: float) -> Loop:
        """Round the numbers of a mission.

        Parameters
        ----------
        mission : Mission
        q3 : float
            q3*, dimensionless.
        """
        design = np.array([float(x) for x in Design.values(mission, [0, 0, q3])])  # type: ignore[list-item]
        gains = mission.gains
        stiffness = float(gains.k1**2 * gains.k2 / mission.vehicle.mass)
        return cls(design, float(mission.vehicle.weight), stiffness, q3)

    @property
    def largest_force(self) -> float:
        """The bound of |F|, N, at which the thrust could reach the singularity T = c q3*."""
        return self.weight - self.stiffness * self.q3

    def factor(self, force: float) -> tuple[float, float]:
        """Return the ends of f(T) for |T - m g| <= force.

        Parameters
        ----------
        force : float
            Bound of |T - m g|, N.
        """
        f = _factor_function()
        low, high = (float(f(self.design, self.weight + s * force)) for s in (1, -1))
        return low, high

    def tilt(self, force: float) -> tuple[float, float, float]:
        """Return sin φ, cos φ and tan(φ/2) for |F| <= force.

        Parameters
        ----------
        force : float
            Bound of |F|, N.
        """
        sine = force / self.weight
        cosine = float(np.sqrt(1 - sine**2))
        return sine, cosine, sine / (1 + cosine)

    def turn_gain(self, force: float) -> float:
        """Return γ = c q3*/(T - c q3*) at the lowest thrust.

        Parameters
        ----------
        force : float
            Bound of |F|, N.
        """
        singular = self.stiffness * self.q3
        return singular / (self.weight - force - singular)

    def blocks(self, f: float, theta: float) -> list[tuple[Array, Array, Array]]:
        """Return (terms without Q, u, v) of the potential alone, and of each weight alone.

        Parameters
        ----------
        f : float
            f(T), 1/m.
        theta : float
            tan(φ/2), dimensionless.
        """
        read = _form_function()
        base = [np.array(x) for x in read(self.design, np.zeros(3), f, [theta, 0])]
        parts = [(base[0], base[1], base[2])]
        for unit in np.eye(3):
            S, u, v = (np.array(x) for x in read(self.design, unit, f, [theta, 0]))
            parts.append((S - base[0], u, v))
        return parts


@dataclass(frozen=True)
class Solution:
    """What the program found: weights, level, and how near the hovers come to it.

    Attributes
    ----------
    weights : (3,)
        a2, a3, a4, m.
    level : float
        ℓ, m.
    fill : float
        Largest Λ/ℓ of the hovers, dimensionless.
    """

    weights: Array
    level: float
    fill: float


def solve(
    loop: Loop,
    *,
    force: float,
    largest: float,
    hovers: Array,
    least_level: float = 0.0,
    most_level: float = np.inf,
    omega: float | None = None,
) -> Solution | None:
    """Find weights and a level that bring the hovers as deep as can be below the level.

    Parameters
    ----------
    loop : Loop
    force : float
        Bound of |F|, N.
    largest : float
        Bound of the eigenvalues of Q, 1/m.
    hovers : (k, 4)
        `Potential.hover_terms` of hovers that are to be inside.
    least_level, most_level : float
        Bounds of ℓ, m.
    omega : float, optional
        Bound of what tilt may add to the height's equation, for a barrier; dimensionless.

    Returns
    -------
    Solution, or None if there is none
    """
    import cvxpy as cp

    low, high = loop.factor(force)
    sine, cosine, theta = loop.tilt(force)
    b, mu, fill = cp.Variable(3, nonneg=True), cp.Variable(nonneg=True), cp.Variable()
    constraints = [cp.sum(cp.inv_pos(b[:2])) <= (force / loop.stiffness) ** 2 / 2]
    constraints += [hovers @ cp.hstack([mu, b]) <= fill]
    if np.isfinite(most_level):
        constraints.append(mu * most_level >= 1)
    if least_level > 0:
        constraints.append(mu * least_level <= 1)
    if omega is not None:
        left = (omega - loop.q3 * (1 - cosine)) / sine
        if left <= 0:
            return None
        gamma = loop.turn_gain(force)
        constraints.append(
            (1 + gamma) ** 2 * cp.inv_pos(b[2]) + gamma**2 * cp.inv_pos(b[1]) <= left**2 / 2
        )
    scale = np.sqrt(largest / 4)
    for f in (low, high):
        parts = loop.blocks(f, theta)
        tau = cp.Variable(nonneg=True)
        v = parts[0][2]
        top = mu * (parts[0][0] - LEAST_RATE * np.eye(ERROR_SIZE)) - tau * largest / 4 * v.T @ v
        corner = np.zeros((3, ERROR_SIZE))
        for i in range(3):
            S, u, _ = parts[i + 1]
            cross = u.T @ v
            top = top + b[i] * (S + largest / 4 * (cross + cross.T))
            corner = corner + scale * b[i] * u
        block = cp.bmat([[top, corner.T], [corner, tau * np.eye(3)]])
        constraints.append((block + block.T) / 2 >> 0)
    problem = cp.Problem(cp.Minimize(fill), constraints)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # inaccurate numbers cost size, never soundness
        try:
            problem.solve(solver=cp.CLARABEL)
        except cp.SolverError:
            return None
    if b.value is None or mu.value is None or not mu.value > 0 or not (b.value > 0).all():
        return None
    return Solution(np.array(b.value / mu.value), float(1 / mu.value), float(fill.value))


def rate_and_multiplier(
    loop: Loop, weights: Array, *, f: float, theta: float, largest: float
) -> tuple[float, float]:
    """Return the largest ε found for given weights at one end of f, and its multiplier τ.

    Parameters
    ----------
    loop : Loop
    weights : (3,)
        a2, a3, a4, m.
    f : float
        f(T), 1/m.
    theta : float
        tan(φ/2), dimensionless.
    largest : float
        Bound of the eigenvalues of Q, 1/m.
    """
    from scipy.optimize import minimize_scalar

    parts = loop.blocks(f, theta)
    S = parts[0][0] + sum(w * p[0] for w, p in zip(weights, parts[1:], strict=True))
    u = sum(w * p[1] for w, p in zip(weights, parts[1:], strict=True))
    v = parts[0][2]
    middle = S + largest / 4 * (u.T @ v + v.T @ u)

    def rate(log_tau: float) -> float:
        tau = np.exp(log_tau)
        M = middle - largest / 4 * (tau * v.T @ v + u.T @ u / tau)
        return float(np.linalg.eigvalsh(M)[0])

    start = np.linspace(-12, 12, 49)
    best = start[np.argmax([rate(x) for x in start])]
    found = minimize_scalar(
        lambda x: -rate(x),
        bounds=(best - 0.6, best + 0.6),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return rate(found.x), float(np.exp(found.x))
