"""Weights, level and multipliers of Λ by one semidefinite program, in floating point.

For a given bound |F| <= d and a given bound λ of the eigenvalues of Q, everything is convex in
μ = 1/ℓ and b = a/ℓ: the inequality -(m/k1) Λ̇/ℓ ⪰ ε μ |Y|², the bound of the force
d²/c² >= 2 (1/b2 + 1/b3), the bound of the term w of the height, and Λ/ℓ at hovers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.form import derive_form
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.robust import Inequality, Term, optimise, reciprocals
from hoverproof.mission.sections import Mission
from hoverproof.servo.lyapunov import ERROR_SIZE, force_function
from hoverproof.servo.variables import Design

Array = NDArray[np.float64]
LEAST_RATE = 0.1
"""ε that the program asks for; what is proved in the end is what the rounded numbers give."""
ZERO_AND_UNITS = np.vstack([np.zeros(3), np.eye(3)])


@cache
def _form_function() -> ca.Function:
    return derive_form().function()


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
        ends = (force_function()(self.design, self.weight + s * force) for s in (1, -1))
        low, high = (float(f) for _, _, f in ends)
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

    def corner(self, f: float, theta: float, largest: float) -> Inequality:
        """Return -(m/k1) Λ̇ ⪰ 0 for all Q with eigenvalues in [0, largest], at one end of f.

        It is affine in 1 (which has no part in it), the factor of the potential, and a2, a3, a4.

        Parameters
        ----------
        f : float
            f(T), 1/m.
        theta : float
            tan(φ/2), dimensionless.
        largest : float
            Bound of the eigenvalues of Q, 1/m.
        """
        outputs = _form_function()(self.design, ZERO_AND_UNITS.T, f, [theta, 0])  # four at once
        S, u, v = (np.array(np.hsplit(np.array(x), 4)) for x in outputs)
        S[1:] -= S[0]
        none = np.zeros_like(S[:1]), np.zeros_like(u[:1])
        S, u = np.concatenate([none[0], S]), np.concatenate([none[1], u])
        cross = largest / 4 * u.swapaxes(1, 2) @ v[0]
        S += cross + cross.swapaxes(1, 2)
        return Inequality(S, (Term(u, v[0], np.array(largest / 2)),))

    def at_start(
        self, mission: Mission, start: Start, whole: Array, level: Array, force: float
    ) -> Array:
        """Return what a2, a3, a4 are multiplied by at most in Λ, (k, 3).

        Parameters
        ----------
        mission : Mission
        start : Start
        whole, level : (k,)
            Bounds of |q - q3* e3| and of its horizontal part, q as seen by a level camera.
        force : float
            Bound of |F| in the set, N.
        """
        m, gains, q3 = float(mission.vehicle.mass), mission.gains, self.q3
        speed, tilt, rate, thrust = map(float, (start.speed, start.tilt, start.rate, start.thrust))
        moved, lean = m / float(gains.k1) * speed, self.weight / self.stiffness * tilt
        quick = self.stiffness * float(gains.k1 * gains.k2 + gains.k3)
        turned = m / quick * (self.weight + thrust - self.stiffness * q3) * rate
        d2 = whole + q3 * tilt + moved
        d3 = d2 + thrust / self.stiffness + lean
        d4 = level + turned + lean + moved + float(mission.target.whole) * tilt
        return np.stack([d2**2 / 2, d3**2 / 2, d4**2 / 2], axis=1)

    def path_before(self, start: Start) -> float:
        """Return how far before the start positions matter, m.

        Parameters
        ----------
        start : Start
        """
        return 0.0

    def nominal(self) -> Loop | None:
        """Return a loop from whose weights to search on, if there is one."""
        return None

    def solve(self, bounds: Bounds, hovers: Array) -> Solution | None:
        """Find weights and a level that bring hovers as deep as can be below the level.

        Parameters
        ----------
        bounds : Bounds
        hovers : (k, 4)
            `Potential.hover_terms` of hovers that are to be inside.

        Returns
        -------
        Solution, or None if there is none
        """
        return _solve(self, bounds, hovers)


@dataclass(frozen=True)
class Bounds:
    """What the program is given beside the loop.

    Attributes
    ----------
    force : float
        Bound of |F|, N.
    largest : float
        λ₊, bound of the eigenvalues of Q, 1/m.
    most_level : float
        Bound of ℓ, m.
    bottom, omega : float or None
        For a barrier: its z, m, and a bound of what tilt may add to the height's equation,
        dimensionless.
    """

    force: float
    largest: float
    most_level: float = np.inf
    bottom: float | None = None
    omega: float | None = None


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
        Largest Λ/ℓ of the hovers, dimensionless; they are inside if it is below 1.
    multipliers : (j,)
        Of a tolerant loop, bare numbers.
    """

    weights: Array
    level: float
    fill: float
    multipliers: Array


def _solve(loop: Loop, bounds: Bounds, hovers: Array) -> Solution | None:
    force, theta = bounds.force, loop.tilt(bounds.force)[2]
    asked = LEAST_RATE * np.array([np.zeros((ERROR_SIZE, ERROR_SIZE)), np.eye(ERROR_SIZE)])
    ends = loop.factor(force)
    corners = [loop.corner(f, theta, bounds.largest).less(asked) for f in ends]
    unit = (loop.stiffness / force) ** 2  # of μ, b and the largest Λ/ℓ, so that b is about 1
    least = [
        -1 / (bounds.most_level * unit),
        1,
        0,
        0,
        0,
        0,
    ]  # of 1, μ, b2, b3, b4 and the largest Λ/ℓ
    inside = np.column_stack([np.zeros(len(hovers)), -hovers, np.ones(len(hovers))])
    pencils = [reciprocals(0.5, {2: 1, 3: 1}, 6)]
    if bounds.omega is not None:
        barrier = barrier_pencil(loop, bounds, unit, 6)
        if barrier is None:
            return None
        pencils.append(barrier)
    rows = np.vstack([least, inside, np.eye(6)[2:5]])
    found = optimise([0, 0, 0, 0, 1], corners, rows=rows, pencils=pencils)
    if found is None or not (found.x[:4] > 0).all():
        return None
    mu, *b, fill = found.x
    return Solution(np.array(b) / mu, float(1 / (mu * unit)), float(fill * unit), np.zeros(0))


def barrier_pencil(loop: Loop, bounds: Bounds, unit: float, size: int) -> Array | None:
    """Return that tilt adds at most ω to the height's equation, as a pencil; None if it does not.

    Parameters
    ----------
    loop : Loop
    bounds : Bounds
        Of a barrier.
    unit : float
        Of b, 1/m.
    size : int
        Of (1, μ, b2, b3, b4, …).
    """
    sine, cosine, _ = loop.tilt(bounds.force)
    left = ((bounds.omega or 0.0) - loop.q3 * (1 - cosine)) / sine
    if left <= 0:
        return None
    gamma = loop.turn_gain(bounds.force)
    factors = {3: gamma**2, 4: (1 + gamma) ** 2}
    return reciprocals(unit * left**2 / 2, {k: x for k, x in factors.items() if x}, size)
