"""The question that a gain certificate answers, in exact numbers.

Is Σ(Q, f, q*) positive definite for every symmetric Q with eigenvalues in the given interval, every
thrust in the given interval, and the q* of the goal? Σ is affine in each of f and the components of
q*, so the corners of a box around them suffice; Q enters through one bilinear form (see `lmi`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import casadi as ca

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.errors import InputError
from hoverproof.mission import Mission
from hoverproof.plant.goal import HoverGoal, Interval, hover_goal
from hoverproof.servo.error_chain import Design
from hoverproof.servo.lyapunov import derive_lyapunov_form, thrust_factor

Rows = list[list[Fraction]]
BITS = 64


@cache
def sigma_function() -> ca.Function:
    """Return (design, weights, Q, f) ↦ (Σ, u, v) of the derived closed loop."""
    return derive_lyapunov_form().function()


@cache
def _force_functions() -> ca.Function:
    d, thrust = Design.symbols(), ca.SX.sym("T")
    singular = d.stiffness * d.goal_centroid[2]
    outputs = [d.stiffness, singular, thrust_factor(thrust, d)]
    return ca.Function("force", [d.vector(), thrust], outputs)


@dataclass(frozen=True)
class GainProblem:
    """The question in exact numbers; a box (pair of ends) stands for what is irrational.

    Attributes
    ----------
    mission : Mission
    goal : HoverGoal
    weights : (4,) Fractions
        w of L = ½ Σ wᵢ|δᵢ|².
    centroid : (3,) of (low, high)
        Box around q*.
    thrust : (low, high)
        Interval that holds every thrust considered, N.
    factor : (low, high)
        Interval that holds f(T) for all of them, 1/m.
    factor_attained : (low, high)
        Interval of values that f(T) does take, 1/m; empty if low > high.
    """

    mission: Mission
    goal: HoverGoal
    weights: tuple[Fraction, ...]
    centroid: tuple[Interval, ...]
    thrust: Interval
    factor: Interval
    factor_attained: Interval

    @property
    def eigenvalues(self) -> Interval:
        """Interval of the eigenvalues of Q, 1/m."""
        return self.mission.bounds.eigenvalues

    def corners(self) -> Iterator[tuple[Fraction, ...]]:
        """Yield the corners of the box around q*."""
        return itertools.product(*(sorted(set(ends)) for ends in self.centroid))

    def matrices(self, Q: Rows, f: Fraction, q: tuple[Fraction, ...]) -> tuple[Rows, Rows, Rows]:
        """Return Σ (11, 11) and the matrices of u and v (3, 11) at one point, exactly.

        Parameters
        ----------
        Q : (3, 3) rows, symmetric, 1/m
        f : Fraction, 1/m
        q : (3,) corner of the box around q*
        """
        lower = [Q[i][j] for j in range(3) for i in range(j, 3)]
        design = Design.values(self.mission, q)
        sigma, u, v = evaluate(sigma_function(), [design, list(self.weights), lower, [f]])
        return sigma, u, v

    def decay_rate(self, margin: Fraction) -> Fraction:
        """Return the rate of L, 1/s, that follows from Σ ⪰ margin·I: L' ≤ -rate·L."""
        return 2 * margin / (self.mission.vehicle.mass * max(self.weights))


def gain_problem(mission: Mission) -> GainProblem:
    """Pose the question for a mission.

    Raises
    ------
    InputError
        If the thrust interval reaches the singularity of the controller, T = c q3*.
    """
    goal = hover_goal(mission)
    box = tuple((_down(low), _up(high)) for low, high in goal.centroid)
    weights = (Fraction(1),) * 4

    def force(thrust: Fraction, q3: Fraction) -> list[Fraction]:
        q = [box[0][0], box[1][0], q3]
        outputs = evaluate(_force_functions(), [Design.values(mission, q), [thrust]])
        return [matrix[0][0] for matrix in outputs]

    weight = mission.vehicle.weight
    stiffness, singular, _ = force(2 * weight, box[2][1])
    if mission.bounds.thrust is not None:
        low, high = mission.bounds.thrust
        key = "bounds.thrust"
    else:
        assert mission.bounds.level is not None
        spread = 2 * mission.bounds.level * (1 / weights[1] + 1 / weights[2])
        reach = _up(stiffness * sqrt_enclosure(spread)[1])
        low, high = weight - reach, weight + reach
        key = "bounds.level"
    if low <= singular:
        raise InputError(
            mission.source,
            key,
            f"lets the thrust sink to {float(low):g} N, but the controller is singular at "
            f"c q3* = {float(singular):g} N; the thrust must stay above that",
        )
    bottom, top = box[2]
    return GainProblem(
        mission=mission,
        goal=goal,
        weights=weights,
        centroid=box,
        thrust=(low, high),
        factor=(_down(force(high, bottom)[2]), _up(force(low, top)[2])),
        factor_attained=(_up(force(high, top)[2]), _down(force(low, bottom)[2])),
    )


def _down(value: Fraction) -> Fraction:
    return Fraction((value.numerator << BITS) // value.denominator, 1 << BITS)


def _up(value: Fraction) -> Fraction:
    return -_down(-value)
