"""Weights, level and multipliers of Λ by one semidefinite program, in floating point.

For a given bound |F| <= d and a given bound λ of the eigenvalues of Q, everything is convex in
μ = 1/ℓ and b = a/ℓ: the inequality -(m/k1) Λ̇/ℓ ⪰ ε μ |Y|², the bound of the force
d²/c² >= 2 (1/b2 + 1/b3), the bound of the term w of the height, and Λ/ℓ at hovers.
"""

from __future__ import annotations

import itertools
import warnings
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from hoverproof.certification.attraction.form import derive_form
from hoverproof.mission.sections import Mission
from hoverproof.servo.error_chain import Design
from hoverproof.servo.lyapunov import ERROR_SIZE, thrust_factor

if TYPE_CHECKING:
    import cvxpy as cp

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


@dataclass(frozen=True)
class _Program:
    """The semidefinite program with parameters for all numbers, so that it is compiled once.

    Attributes
    ----------
    problem : Problem
    b, mu, fill : Variable
        a/ℓ, 1/ℓ and the largest Λ/ℓ of the hovers.
    hovers, least_mu, force : Parameter
        Terms of the hovers; lower bound of μ; bound of 1/b2 + 1/b3.
    lag : list of Parameter
        Factors of 1/b2 and 1/b3, and bound of their sum, for a barrier; empty without.
    ends : list of (5,) Parameter
        For each end of f and each block: the matrices that μ, b2, b3, b4 and τ multiply.
    """

    problem: cp.Problem
    b: cp.Variable
    mu: cp.Variable
    fill: cp.Variable
    hovers: cp.Parameter
    least_mu: cp.Parameter
    force: cp.Parameter
    lag: list[cp.Parameter]
    ends: list[list[cp.Parameter]]


@cache
def _program(count: int, sizes: tuple[int, ...], barrier: bool) -> _Program:
    """Pose the program for so many hovers, and blocks of these sizes."""
    import cvxpy as cp

    b, mu, fill = cp.Variable(3, nonneg=True), cp.Variable(nonneg=True), cp.Variable()
    hovers, force = cp.Parameter((count, 4)), cp.Parameter(nonneg=True)
    least_mu = cp.Parameter(nonneg=True)
    constraints = [
        cp.sum(cp.inv_pos(b[:2])) <= force,
        hovers @ cp.hstack([mu, b]) <= fill,
        mu >= least_mu,
    ]
    lag = [cp.Parameter(nonneg=True) for _ in range(3 if barrier else 0)]
    if barrier:
        constraints.append(lag[0] * cp.inv_pos(b[1]) + lag[1] * cp.inv_pos(b[2]) <= lag[2])
    ends = []
    for _ in range(2):
        tau = cp.Variable(nonneg=True)
        for n in sizes:
            matrices = [cp.Parameter((n, n), symmetric=True) for _ in range(5)]
            multiplied = zip((mu, b[0], b[1], b[2], tau), matrices, strict=True)
            constraints.append(sum(x * matrix for x, matrix in multiplied) >> 0)
            ends.append(matrices)
    problem = cp.Problem(cp.Minimize(fill), constraints)
    return _Program(problem, b, mu, fill, hovers, least_mu, force, lag, ends)


def _matrices(loop: Loop, f: float, theta: float, largest: float) -> list[Array]:
    """Return the matrices (14, 14) that μ, b2, b3, b4 and τ multiply in the inequality."""
    parts = loop.blocks(f, theta)
    v = parts[0][2]
    matrices = [np.zeros((ERROR_SIZE + 3, ERROR_SIZE + 3)) for _ in range(5)]
    matrices[0][:ERROR_SIZE, :ERROR_SIZE] = parts[0][0] - LEAST_RATE * np.eye(ERROR_SIZE)
    for matrix, (S, u, _) in zip(matrices[1:4], parts[1:], strict=True):
        cross = u.T @ v
        matrix[:ERROR_SIZE, :ERROR_SIZE] = S + largest / 4 * (cross + cross.T)
        matrix[ERROR_SIZE:, :ERROR_SIZE] = np.sqrt(largest / 4) * u
        matrix[:ERROR_SIZE, ERROR_SIZE:] = np.sqrt(largest / 4) * u.T
    matrices[4][:ERROR_SIZE, :ERROR_SIZE] = -largest / 4 * v.T @ v
    matrices[4][ERROR_SIZE:, ERROR_SIZE:] = np.eye(3)
    return [(matrix + matrix.T) / 2 for matrix in matrices]


def solve(
    loop: Loop,
    *,
    force: float,
    largest: float,
    hovers: Array,
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
    most_level : float
        Bound of ℓ, m.
    omega : float, optional
        Bound of what tilt may add to the height's equation, for a barrier; dimensionless.

    Returns
    -------
    Solution, or None if there is none
    """
    import cvxpy as cp

    sine, cosine, theta = loop.tilt(force)
    ends = [_matrices(loop, f, theta, largest) for f in loop.factor(force)]
    linked = sum(np.abs(matrix) for end in ends for matrix in end) > 0
    count, label = connected_components(linked, directed=False)
    blocks = [np.flatnonzero(label == i) for i in range(count)]
    program = _program(len(hovers), tuple(map(len, blocks)), omega is not None)
    if omega is not None:
        left = (omega - loop.q3 * (1 - cosine)) / sine
        if left <= 0:
            return None
        gamma = loop.turn_gain(force)
        values = (gamma**2, (1 + gamma) ** 2, left**2 / 2)
        for parameter, value in zip(program.lag, values, strict=True):
            parameter.value = value
    program.hovers.value = hovers
    program.force.value = (force / loop.stiffness) ** 2 / 2
    program.least_mu.value = 1 / most_level
    places = itertools.product(ends, blocks)
    for parameters, (end, block) in zip(program.ends, places, strict=True):
        for parameter, matrix in zip(parameters, end, strict=True):
            parameter.value = matrix[np.ix_(block, block)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # inaccurate numbers cost size, never soundness
        try:
            program.problem.solve(solver=cp.CLARABEL)
        except cp.SolverError:
            return None
    mu, b = program.mu.value, program.b.value
    if b is None or mu is None or not mu > 0 or not (b > 0).all():
        return None
    return Solution(np.array(b / mu), float(1 / mu), float(program.fill.value))


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
