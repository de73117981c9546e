"""The question that a gain certificate answers, in exact numbers.

Is Σ(Q, f, q*) positive definite for every symmetric Q with eigenvalues in the given interval (or
every J in the given ball), every thrust in the given interval, and the q* of the goal? Σ is affine
in each of f and the components of q*, so the corners of a box around them suffice; Q enters through
one bilinear form (see `robust`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Literal

import casadi as ca
import numpy as np

from hoverproof.algebra.decimals import binary_above, binary_below
from hoverproof.algebra.derived import kept_graph
from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.certification.bounds import eigenvalue_bounds, goal_box, proved_bounds
from hoverproof.certification.flow import Flow, flow_of
from hoverproof.certification.region import Box, Enclosure
from hoverproof.certification.robust import Array, Inequality, Term
from hoverproof.errors import InputError
from hoverproof.mission.exact import exact
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import HoverGoal, Interval, hover_goal
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY, law_of
from hoverproof.servo.lyapunov import (
    derive_error_dynamics,
    derive_lyapunov_form,
    force_function,
)
from hoverproof.servo.variables import Errors

Rows = list[list[Fraction]]
BITS = 64


@kept_graph
def sigma_function(law: Law = HAMEL_MAHONY) -> ca.Function:
    """Return (design, weights, Q, f) ↦ (Σ, u, v) of the derived closed loop.

    Parameters
    ----------
    law : Law
    """
    return derive_lyapunov_form(derive_error_dynamics(law)).function()


def gain_inequality(
    design: Sequence[Any],
    weights: Sequence[Any],
    k1: Any,
    eigenvalues: tuple[Any, Any],
    f: Any,
    law: Law = HAMEL_MAHONY,
) -> Inequality:
    """Return Σ ≻ 0 for all Q (or J) within bounds in floating point, k questions at once.

    Parameters
    ----------
    design : (13,) of (k,) or numbers
        In the order of the law's design.
    weights : (4,) of (k,) or numbers
        w of L = ½ Σ wᵢ|δᵢ|².
    k1 : (k,) or number
        The gain, kg m/s.
    eigenvalues : (low, high) of (k,) or numbers
        Of Q, or the ends of the ball of J, 1/m.
    f : (k,) or number
        f(T), 1/m.
    law : Law
    """
    low, high = eigenvalues
    middle = (low + high) / 2
    inputs = [design, weights, [middle, 0, 0, middle, 0, middle], [f]]
    shape = np.broadcast_shapes(*(np.shape(x) for part in inputs for x in part))

    def stacked(rows: list[list[Any]]) -> Array:
        matrix = np.array([[np.broadcast_to(x, shape) for x in row] for row in rows], float)
        return np.moveaxis(matrix, (0, 1), (-2, -1))

    sigma, u, v = map(stacked, evaluate(sigma_function(law), inputs, float))
    first = v.reshape(-1, *v.shape[-2:])[0]
    v = first if (v == first).all() else v  # as it is in parameters
    return Inequality(sigma, (Term(u, v, np.asarray(k1 * (high - low) / 2)),))


def squares(weights: Sequence[Any]) -> list[Any]:
    """Return the diagonal of W, (11,): L = ½ XᵀWX.

    Parameters
    ----------
    weights : (4,)
    """
    sizes = Errors.sizes().values()
    return [w for w, size in zip(weights, sizes, strict=True) for _ in range(size)]


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
        Box around what of the wanted feature turns with the image: q*, s*, or nothing.
    thrust : (low, high)
        Interval that holds every thrust considered, N.
    factor : (low, high)
        Interval that holds f(T) for all of them, 1/m.
    factor_attained : (low, high)
        Interval of values that f(T) does take, 1/m; empty if low > high.
    eigenvalues : (low, high)
        Interval of the eigenvalues of Q, or the ends of the ball of J, 1/m.
    region : Enclosure or None
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
    region: Enclosure | None
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
        law = law_of(self.mission)
        inputs = [law.design.values(self.mission, q), self.weights, lower, [f]]
        sigma, u, v = evaluate(sigma_function(law), inputs)
        return sigma, u, v

    def inequality(self, f: Fraction, weights: Sequence[Any] | None = None) -> Inequality:
        """Return the question at one end of f in floating point, q* in the middle of its box.

        Parameters
        ----------
        f : Fraction, 1/m
        weights : (4,) of (k,) or numbers, optional
            In place of the problem's own.
        """
        q = [(low + high) / 2 for low, high in self.centroid]
        law = law_of(self.mission)
        design = [float(x) for x in law.design.values(self.mission, q)]
        low, high = (float(x) for x in self.eigenvalues)
        held = [float(w) for w in self.weights] if weights is None else weights
        k1 = float(self.mission.gains.k1)
        return gain_inequality(design, held, k1, (low, high), float(f), law)

    @property
    def origin(self) -> Literal["assumed", "proved"]:
        """Where the interval of the eigenvalues comes from: the mission, or a proof over `box`."""
        return "assumed" if self.box is None else "proved"

    @property
    def flow(self) -> Flow:
        """What the interval of the eigenvalues is about."""
        return flow_of(self.mission)

    @property
    def footing(self) -> str:
        """What a verdict rests on, in words."""
        how = "assumed" if self.box is None else "proved over a box"
        return f"bounds of {self.flow.symbol} {how}"

    @property
    def weight_diagonal(self) -> list[Fraction]:
        """Diagonal of W, (11,): L = ½ XᵀWX."""
        return squares(self.weights)

    def decay_rate(self, margin: Fraction) -> Fraction:
        """Return the rate of L, 1/s, that follows from Σ ⪰ margin·W: L' ≤ -rate·L.

        Parameters
        ----------
        margin : Fraction
            kg/s.
        """
        return 2 * margin / self.mission.vehicle.mass


ONES = (Fraction(1),) * 4


def fixed(mission: Mission, goal: HoverGoal) -> list[Interval]:
    """Enclose what of the wanted feature turns with the image, (3,): q*, s*, or nothing.

    Parameters
    ----------
    mission : Mission
    goal : HoverGoal
        Its hover.
    """
    if mission.law.goal == "inertial":
        return [(Fraction(0), Fraction(0))] * 3
    return wanted(mission, goal)


def wanted(mission: Mission, goal: HoverGoal) -> list[Interval]:
    """Enclose the wanted feature, (3,): q* or s*.

    Parameters
    ----------
    mission : Mission
    goal : HoverGoal
        Its hover.
    """
    if mission.law.feature == "centroid":
        return list(goal.centroid)
    return scaled_centroid(goal.centroid, mission.target.whole)


def scaled_centroid(q: Sequence[Interval], n: Fraction | int) -> list[Interval]:
    """Enclose s = √(n (n + a)/(2 (n² - a²))) q/a, a = |q|, (3,).

    Parameters
    ----------
    q : (3,) of (low, high)
        Small enclosures, |q| < n.
    n : Fraction or int
        Sum of the weights of the target points, a bare number.
    """
    ends = [
        sum((pick(side[0] ** 2, side[1] ** 2) for side in q), Fraction(0)) for pick in (min, max)
    ]
    a = sqrt_enclosure(ends[0])[0], sqrt_enclosure(ends[1])[1]
    grown = [n * (n + x) / (2 * (n**2 - x**2)) for x in a]
    low, high = sqrt_enclosure(grown[0])[0] / a[1], sqrt_enclosure(grown[1])[1] / a[0]
    return [(min(x * low, x * high), max(y * low, y * high)) for x, y in q]


def force_bound(stiffness: Fraction, level: Fraction, w2: Fraction, w3: Fraction) -> Fraction:
    """Return c √(2ℓ(1/w2 + 1/w3)) from above, N: |F| where ½(w2|δ2|² + w3|δ3|²) <= ℓ.

    Parameters
    ----------
    stiffness : Fraction
        c, N.
    level : Fraction
        ℓ, dimensionless or m, as the weights are.
    w2, w3 : Fraction
        Weights of δ2 and δ3, exact numbers.
    """
    return stiffness * sqrt_enclosure(2 * level * (1 / w2 + 1 / w3))[1]


def gain_problem(
    mission: Mission, weights: tuple[Fraction, ...] = ONES, region: Enclosure | None = None
) -> GainProblem:
    """Pose the question about the gains of a mission.

    Parameters
    ----------
    mission : Mission
    weights : (4,) Fractions
        w of L = ½ Σ wᵢ|δᵢ|².
    region : Enclosure, optional
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


def exact_weights(weights: Iterable[object]) -> tuple[Fraction, ...]:
    """Return weights of L as exact numbers.

    Parameters
    ----------
    weights : (4,) numbers, or texts of them
        See `hoverproof.mission.exact.exact`.

    Raises
    ------
    InputError
        If they are not four positive numbers of a reasonable size.
    """
    try:
        some = () if isinstance(weights, str) else tuple(map(exact, weights))
    except (TypeError, ValueError):
        some = ()
    if len(some) != 4 or not all(0 < w <= 10**9 and w.denominator <= 10**18 for w in some):
        reason = f"must be four positive numbers of at most 18 decimals, not {weights!r:.80}"
        raise InputError("--weights", "", reason)
    return some


def pose(
    mission: Mission, weights: tuple[Fraction, ...] = ONES, region: Enclosure | None = None
) -> GainProblem:
    """Put the numbers of a question together, wherever the goal is.

    Parameters
    ----------
    mission : Mission
    weights : (4,) Fractions
        w of L = ½ Σ wᵢ|δᵢ|².
    region : Enclosure, optional
        A box with proved eigenvalue bounds, to take the place of those in the mission.

    Raises
    ------
    InputError
        If the thrust interval reaches the singularity of the controller, T = c q3*, or if "auto"
        proves nothing.
    """
    weights = exact_weights(weights)
    goal, law = hover_goal(mission), law_of(mission)
    box = tuple(
        (low, high) if low == high else (binary_below(low, BITS), binary_above(high, BITS))
        for low, high in fixed(mission, goal)
    )

    def force(thrust: Fraction, q3: Fraction) -> list[Fraction]:
        q = [box[0][0], box[1][0], q3]
        outputs = evaluate(force_function(law), [law.design.values(mission, q), [thrust]])
        return [matrix[0][0] for matrix in outputs]

    weight = mission.vehicle.weight
    stiffness, singular, _ = force(2 * weight, box[2][1])
    if mission.bounds.thrust is not None:
        low, high = mission.bounds.thrust
        key = "bounds.thrust"
    else:
        assert mission.bounds.level is not None
        reach = binary_above(force_bound(stiffness, mission.bounds.level, *weights[1:3]), BITS)
        low, high = weight - reach, weight + reach
        key = "bounds.level"
    symbol = "s" if mission.law.feature == "scaled" else "q"
    if low <= singular:
        raise InputError(
            mission.source,
            key,
            f"lets the thrust sink to {float(low):g} N, but the controller is singular at "
            f"{f'c {symbol}3* = ' if singular else ''}{float(singular):g} N; the thrust must stay "
            "above that",
        )
    bottom, top = box[2]
    room = top - bottom  # a checker may enclose q* less tightly: a value of f is to be one for it
    return GainProblem(
        mission=mission,
        goal=goal,
        weights=weights,
        centroid=box,
        thrust=(low, high),
        factor=(
            binary_below(force(high, bottom)[2], BITS),
            binary_above(force(low, top)[2], BITS),
        ),
        factor_attained=(
            binary_above(force(high, top + room)[2], BITS),
            binary_below(force(low, bottom - room)[2], BITS),
        ),
        eigenvalues=eigenvalue_bounds(mission) if region is None else region.eigenvalues,
        region=region,
    )
