"""Worst eigenvalues of Σ for many questions at once, in floating point.

What a margin is worth is decided elsewhere, exactly.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.graph import evaluate
from hoverproof.certification import robust
from hoverproof.certification.problem import GainProblem, gain_inequality, squares
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.lyapunov import force_function
from hoverproof.servo.variables import Design

Array = NDArray[np.float64]
Numbers = float | Array

GAINS = Design.chain_gains()


@dataclass(frozen=True)
class Questions:
    """Many gain problems for one vehicle, law and goal, n of them; scalars stand for all.

    Attributes
    ----------
    law : Law
    mass, gravity : float
        kg and m/s².
    centroid : (3,)
        q*, or what of the wanted feature turns with the image.
    gains : (4,) of (n,)
        k1 kg m/s, k2 1/m, k3 and k4 kg/s.
    eigenvalues : (low, high) of (n,)
        Interval of the eigenvalues of Q, or the ends of the ball of J, 1/m.
    thrust : (low, high) of (n,), or None
        Interval of the thrust, N.
    level : (n,), or None
        Level of L from which the thrust interval follows, where none is given.
    weights : (4,)
        w of L = ½ Σ wᵢ|δᵢ|².
    """

    law: Law
    mass: float
    gravity: float
    centroid: tuple[float, ...]
    gains: tuple[Array, ...]
    eigenvalues: tuple[Numbers, Numbers]
    thrust: tuple[Numbers, Numbers] | None
    level: Numbers | None
    weights: tuple[float, ...]

    @classmethod
    def of(cls, problem: GainProblem) -> Questions:
        """Round the numbers of one problem; `dataclasses.replace` varies them.

        Parameters
        ----------
        problem : GainProblem
        """
        mission, bounds = problem.mission, problem.mission.bounds
        return cls(
            law=law_of(mission),
            mass=float(mission.vehicle.mass),
            gravity=float(mission.vehicle.gravity),
            centroid=tuple(float(low + high) / 2 for low, high in problem.centroid),
            gains=tuple(np.array([float(getattr(mission.gains, k))]) for k in GAINS),
            eigenvalues=(float(problem.eigenvalues[0]), float(problem.eigenvalues[1])),
            thrust=None
            if bounds.thrust is None
            else (float(bounds.thrust[0]), float(bounds.thrust[1])),
            level=None if bounds.level is None else float(bounds.level),
            weights=tuple(float(w) for w in problem.weights),
        )

    def where(self, chosen: NDArray[np.bool_]) -> Questions:
        """Return those that are chosen.

        Parameters
        ----------
        chosen : (n,)
        """

        def part(x: Any) -> Any:
            return np.broadcast_to(x, chosen.shape)[chosen]

        return replace(
            self,
            gains=tuple(map(part, self.gains)),
            eigenvalues=(part(self.eigenvalues[0]), part(self.eigenvalues[1])),
            thrust=self.thrust and (part(self.thrust[0]), part(self.thrust[1])),
            level=None if self.level is None else part(self.level),
        )

    def design(self) -> list[Any]:
        """Return the numbers in the order of `Design`; inertia and k_yaw do not enter Σ."""
        gains = {name: [values] for name, values in zip(GAINS, self.gains, strict=True)}
        own = {"mass": [self.mass], "gravity": [self.gravity], "goal_centroid": self.centroid}
        numbers: dict[str, Sequence[Any]] = {**own, **gains}
        parts = (numbers.get(name, [1.0] * size) for name, size in Design.sizes().items())
        return list(itertools.chain(*parts))

    def thrust_interval(self) -> tuple[Array, Array]:
        """Return the ends of the thrust interval, N, (n,) each."""
        if self.thrust is not None:
            low, high = self.thrust
        else:
            stiffness, *_ = _force(self, 0.0)
            spread = 2 * np.asarray(self.level, float) * (1 / self.weights[1] + 1 / self.weights[2])
            reach = stiffness * np.sqrt(spread)
            weight = self.mass * self.gravity
            low, high = weight - reach, weight + reach
        ones = np.ones(len(self.gains[0]))
        return low * ones, high * ones


def _force(questions: Questions, thrust: Numbers) -> list[Array]:
    """Return c, the singular thrust c q3*, and f(T), (n,) each."""
    with np.errstate(divide="ignore", invalid="ignore"):
        outputs = evaluate(force_function(questions.law), [questions.design(), [thrust]], float)
    return [np.asarray(matrix[0][0], float) for matrix in outputs]


def factor_of(questions: Questions, thrust: Numbers) -> Array:
    """Return f(T), 1/m, (n,).

    Parameters
    ----------
    questions : Questions
    thrust : (n,) or one for all, N
    """
    return _force(questions, thrust)[2]


def posed(questions: Questions) -> NDArray[np.bool_]:
    """Tell which questions are posed at all, (n,).

    Gains and eigenvalues must be positive and in order, and the thrust interval must hold the
    thrust of hover and stay above the singularity of the controller.

    Parameters
    ----------
    questions : Questions
    """
    low, high = questions.thrust_interval()
    _, singular, _ = _force(questions, low)
    weight = questions.mass * questions.gravity
    least, most = questions.eigenvalues
    good = (low > singular) & (low <= weight * (1 + 1e-12)) & (high >= weight * (1 - 1e-12))
    for gain in questions.gains:
        good = good & (gain > 0)
    return np.asarray(good & (np.asarray(least) > 0) & (np.asarray(most) > least), bool)


def margins(questions: Questions, floor: float = -np.inf) -> Array:
    """Return the worst eigenvalue of W^(-½) Σ W^(-½) of each question, kg/s, (n,).

    NaN where no question is posed.

    Parameters
    ----------
    questions : Questions
    floor : float
        Where the worst eigenvalue is surely below, what is returned is below too, kg/s.
    """
    good = posed(questions)
    worst = np.full(len(good), np.nan)
    one = questions.where(good)
    weights = np.array(squares(one.weights))
    values = np.full(good.sum(), np.inf)
    for thrust in one.thrust_interval() if good.any() else ():
        f = factor_of(one, thrust)
        low, high = one.eigenvalues
        corner = gain_inequality(one.design(), one.weights, one.gains[0], (low, high), f, one.law)
        values = np.minimum(values, robust.margins(corner.scaled(weights), floor)[0])
    worst[good] = values
    return worst
