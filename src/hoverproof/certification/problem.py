"""The question that a gain certificate answers, in exact numbers.

Is Σ(Q, f, q*) positive definite for every symmetric Q with eigenvalues in the given interval, every
thrust in the given interval, and the q* of the goal? Σ is affine in each of f and the components of
q*, so the corners of a box around them suffice; Q enters through one bilinear form (see `lmi`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from typing import Literal

import casadi as ca

from hoverproof.algebra.derived import kept_graph, kept_json
from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.certification.bounds import eigenvalue_bounds, goal_box, proved_bounds
from hoverproof.certification.region import Box, Region
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import HoverGoal, Interval, hover_goal
from hoverproof.servo.error_chain import Design
from hoverproof.servo.lyapunov import ERROR_SIZE, derive_lyapunov_form, force_function

Rows = list[list[Fraction]]
Terms = list[tuple[Fraction, list[int]]]
BITS = 64


@kept_graph
def sigma_function() -> ca.Function:
    """Return (design, weights, Q, f) ↦ (Σ, u, v) of the derived closed loop."""
    return derive_lyapunov_form().function()


@cache
def _sigma_polynomials() -> list[tuple[int, int, int, Terms]]:
    """Return the nonzero entries of Σ, u and v as polynomials: (matrix, row, column, terms).

    A term is a coefficient with the positions of its factors among the inputs of `sigma_function`.
    """
    return [
        (matrix, row, column, [(Fraction(coefficient), factors) for coefficient, factors in terms])
        for matrix, row, column, terms in _sigma_terms()
    ]


@kept_json
def _sigma_terms() -> list[tuple[int, int, int, list[tuple[str, list[int]]]]]:
    """Return `_sigma_polynomials` with its coefficients in words."""
    from hoverproof.algebra.identity import normal_form  # its library of polynomials is large

    form = derive_lyapunov_form()
    inputs = ca.vertcat(form.design.vector(), form.weights, form.Q_lower, form.f)
    stacked = ca.vertcat(form.Sigma, form.flow_weight, form.scaled_velocity)
    used = ca.symvar(ca.vec(stacked))
    position = {symbol: i for i, symbol in enumerate(ca.vertsplit(inputs))}
    entries = []
    for i, row in enumerate(normal_form(stacked)):
        matrix, row_of_it = (0, i) if i < ERROR_SIZE else divmod(i - ERROR_SIZE + 3, 3)
        for column, value in enumerate(row):
            terms = [
                (
                    str(coefficient),
                    [position[s] for s, n in zip(used, powers, strict=True) for _ in range(n)],
                )
                for powers, coefficient in value.polynomial().items()
            ]
            if terms:
                entries.append((matrix, row_of_it, column, terms))
    return entries


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
    eigenvalues : (low, high)
        Interval of the eigenvalues of Q, 1/m.
    region : Region or None
        Positions over which that interval was proved; None if it is the mission's assumption.
    goal_box : (3,) of (low, high), or None
        Holds the goal, and Q is within that interval there, m; None where the question is not
        about gains.
    """

    mission: Mission
    goal: HoverGoal
    weights: tuple[Fraction, ...]
    centroid: tuple[Interval, ...]
    thrust: Interval
    factor: Interval
    factor_attained: Interval
    eigenvalues: Interval
    region: Region | None
    goal_box: Box | None = None

    @property
    def box(self) -> Box | None:
        """Positions over which the interval of eigenvalues was proved, m; None if assumed."""
        return None if self.region is None else self.region.box

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
        inputs = [*Design.values(self.mission, q), *self.weights, *lower, f]
        zero = Fraction(0)
        sigma = [[zero] * ERROR_SIZE for _ in range(ERROR_SIZE)]
        u, v = ([[zero] * ERROR_SIZE for _ in range(3)] for _ in range(2))
        for matrix, i, j, terms in self._entries:
            value = zero
            for coefficient, factors in terms:
                for k in factors:
                    coefficient *= inputs[k]
                value += coefficient
            (sigma, u, v)[matrix][i][j] = value
        return sigma, u, v

    @cached_property
    def _entries(self) -> list[tuple[int, int, int, Terms]]:
        """Σ, u and v with the numbers of this mission put in, but q*, Q and f left."""
        design = Design.values(self.mission, (Fraction(1),) * 3)  # ends with q*
        held = [*design, *self.weights]
        q_star, after = range(len(design) - 3, len(design)), range(len(held), len(held) + 7)
        free = {*q_star, *after}  # after the weights come the six entries of Q, and f
        entries = []
        for matrix, i, j, terms in _sigma_polynomials():
            short = [
                (
                    math.prod((held[k] for k in factors if k not in free), start=coefficient),
                    [k for k in factors if k in free],
                )
                for coefficient, factors in terms
            ]
            entries.append((matrix, i, j, short))
        return entries

    @property
    def origin(self) -> Literal["assumed", "proved"]:
        """Where the interval of the eigenvalues comes from: the mission, or a proof over `box`."""
        return "assumed" if self.box is None else "proved"

    @property
    def footing(self) -> str:
        """What a verdict rests on, in words."""
        return "bounds of Q assumed" if self.box is None else "bounds of Q proved over a box"

    @property
    def weight_diagonal(self) -> list[Fraction]:
        """Diagonal of W, (11,): L = ½ XᵀWX."""
        w1, w2, w3, w4 = self.weights
        return [w1] * 3 + [w2] * 3 + [w3] * 3 + [w4] * 2

    def decay_rate(self, margin: Fraction) -> Fraction:
        """Return the rate of L, 1/s, that follows from Σ ⪰ margin·W: L' ≤ -rate·L.

        Parameters
        ----------
        margin : Fraction
            kg/s.
        """
        return 2 * margin / self.mission.vehicle.mass


ONES = (Fraction(1),) * 4


def gain_problem(
    mission: Mission, weights: tuple[Fraction, ...] = ONES, region: Region | None = None
) -> GainProblem:
    """Pose the question about the gains of a mission.

    Parameters
    ----------
    mission : Mission
    weights : (4,) Fractions
        w of L = ½ Σ wᵢ|δᵢ|².
    region : Region, optional
        A box with proved eigenvalue bounds; by default those of the mission, proved if they are
        "auto".

    Raises
    ------
    InputError
        If the thrust interval reaches the singularity of the controller, T = c q3*, if Q at the
        goal is not within the bounds, or if "auto" proves none.
    """
    problem = pose(mission, weights, proved_bounds(mission) if region is None else region)
    return replace(problem, goal_box=goal_box(mission, problem.eigenvalues, problem.box))


def pose(
    mission: Mission, weights: tuple[Fraction, ...] = ONES, region: Region | None = None
) -> GainProblem:
    """Put the numbers of a question together, wherever the goal is.

    Parameters
    ----------
    mission : Mission
    weights : (4,) Fractions
        w of L = ½ Σ wᵢ|δᵢ|².
    region : Region, optional
        A box with proved eigenvalue bounds, to take the place of those in the mission.

    Raises
    ------
    InputError
        If the thrust interval reaches the singularity of the controller, T = c q3*, or if "auto"
        proves nothing.
    """
    goal = hover_goal(mission)
    box = tuple((_down(low), _up(high)) for low, high in goal.centroid)

    def force(thrust: Fraction, q3: Fraction) -> list[Fraction]:
        q = [box[0][0], box[1][0], q3]
        outputs = evaluate(force_function(), [Design.values(mission, q), [thrust]])
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
        eigenvalues=eigenvalue_bounds(mission) if region is None else region.eigenvalues,
        region=region,
    )


def _down(value: Fraction) -> Fraction:
    return Fraction((value.numerator << BITS) // value.denominator, 1 << BITS)


def _up(value: Fraction) -> Fraction:
    return -_down(-value)
