"""Worst eigenvalues of Σ for many questions at once, in floating point.

For each question it maximises the concave margin of M(τ) over the multiplier τ (see `lmi`), block
by block: where the goal is on the axis, Σ falls apart into two equal 4×4 blocks and one 3×3 block.
What a margin is worth is decided elsewhere, exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from hoverproof.algebra.graph import evaluate
from hoverproof.certification.problem import GainProblem, sigma_function
from hoverproof.servo.lyapunov import ERROR_SIZE, force_function

Array = NDArray[np.float64]
Numbers = float | Array

GAINS = ("k1", "k2", "k3", "k4")
COLD, WARM = 8.0, 1.5
RELATIVE = 1e-9
ROUNDING = 1e-15
MOST_STEPS = 80
MOST_TAU = 1e15


@dataclass(frozen=True)
class Questions:
    """Many gain problems for one vehicle and goal, n of them; scalars stand for all.

    Attributes
    ----------
    mass, gravity : float
        kg and m/s².
    centroid : (3,)
        q*.
    gains : (4,) of (n,)
        k1 kg m/s, k2 1/m, k3 and k4 kg/s.
    eigenvalues : (low, high) of (n,)
        Interval of the eigenvalues of Q, 1/m.
    thrust : (low, high) of (n,), or None
        Interval of the thrust, N.
    level : (n,), or None
        Level of L from which the thrust interval follows, where none is given.
    weights : (4,)
        w of L = ½ Σ wᵢ|δᵢ|².
    """

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

    def design(self) -> list[Any]:
        """Return the numbers in the order of `Design`; inertia and k_yaw do not enter Σ."""
        return [self.mass, self.gravity, 1.0, 1.0, 1.0, *self.gains, 1.0, *self.centroid]

    def thrust_interval(self) -> tuple[Array, Array]:
        """Return the ends of the thrust interval, N, (n,) each."""
        if self.thrust is not None:
            low, high = self.thrust
        else:
            assert self.level is not None
            stiffness, *_ = _force(self, 0.0)
            spread = 2 * np.asarray(self.level) * (1 / self.weights[1] + 1 / self.weights[2])
            reach = stiffness * np.sqrt(spread)
            weight = self.mass * self.gravity
            low, high = weight - reach, weight + reach
        ones = np.ones(len(self.gains[0]))
        return low * ones, high * ones


class _Family(NamedTuple):
    """One block of the inequality for n questions: M(τ) = sigma - spread (τ vv + uu/τ)."""

    sigma: Array
    vv: Array
    uu: Array


def _force(questions: Questions, thrust: Numbers) -> list[Array]:
    """Return c, the singular thrust c q3*, and f(T), (n,) each."""
    with np.errstate(divide="ignore", invalid="ignore"):
        outputs = evaluate(force_function(), [questions.design(), [thrust]], float)
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


def margins(questions: Questions) -> Array:
    """Return the worst eigenvalue of W^(-½) Σ W^(-½) of each question, kg/s, (n,).

    NaN where no question is posed.

    Parameters
    ----------
    questions : Questions
    """
    good = posed(questions)
    low, high = questions.thrust_interval()
    worst = np.full(len(good), np.inf)
    tau, step = np.ones(len(good)), COLD
    for thrust in (low, high):
        f = factor_of(questions, np.where(good, thrust, 2 * questions.mass * questions.gravity))
        best, tau = _best(*_families(questions, f, good), tau, step)
        worst, step = np.minimum(worst, best), WARM  # τ of one end is near that of the other
    return np.where(good, worst, np.nan)


def _families(
    questions: Questions, f: Array, good: NDArray[np.bool_]
) -> tuple[list[_Family], Array]:
    """Return the blocks of the inequality at one end of f, and k1 ϱ/2, (n,)."""
    n = len(good)
    least, most = (
        np.asarray(np.where(good, x, 1.0 + i)) for i, x in enumerate(questions.eigenvalues)
    )
    middle = (least + most) / 2
    zero = np.zeros(n)
    lower = [middle, zero, zero, middle, zero, middle]
    ends = [np.where(good, f, 1.0)]
    inputs: list[list[Any]] = [questions.design(), list(questions.weights), lower, ends]
    sigma, u, v = (_stack(rows, n) for rows in evaluate(sigma_function(), inputs, float))
    root = np.sqrt(np.repeat(questions.weights, (3, 3, 3, 2)))
    vv = np.einsum("nki,nkj->nij", v, v) / np.outer(root, root)
    uu = np.einsum("nki,nkj->nij", u, u) / np.outer(root, root)
    sigma = sigma / np.outer(root, root)
    blocks: list[_Family] = []
    for index in _blocks(sigma, vv, uu):
        family = _Family(*(np.ascontiguousarray(a[:, index][:, :, index]) for a in (sigma, vv, uu)))
        if not any(_same(family, other) for other in blocks):
            blocks.append(family)
    return blocks, questions.gains[0] * (most - least) / 4


def _stack(rows: list[list[Numbers]], n: int) -> Array:
    matrix = np.zeros((n, len(rows), len(rows[0])))
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            matrix[:, i, j] = entry
    return matrix


def _blocks(*matrices: Array) -> list[NDArray[np.intp]]:
    """Return the sets of coordinates between which no matrix of any question has an entry."""
    linked = np.zeros((ERROR_SIZE, ERROR_SIZE), bool)
    for matrix in matrices:
        linked |= (matrix != 0).any(axis=0)
    count, label = connected_components(csr_array(linked), directed=False)
    return [np.flatnonzero(label == i) for i in range(count)]


def _same(a: _Family, b: _Family) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


def _best(blocks: list[_Family], spread: Array, start: Array, reach: float) -> tuple[Array, Array]:
    """Return the largest margin over τ of each question, and where it was found, (n,) each.

    The search sets out from `start`, by factors of `reach` until there are τ on both sides.

    Two tangents of the concave margin enclose its maximum. The next τ is where they meet, which
    is right at a kink, or where the slope between them vanishes, which is right where it is smooth.
    """
    n = len(spread)
    result, at = np.empty(n), np.empty(n)
    index = np.arange(n)
    best, slope = _margin(blocks, spread, start)
    low, low_value, low_slope = start.copy(), best.copy(), slope.copy()
    high, high_value, high_slope = start.copy(), best.copy(), slope.copy()
    size = np.max([np.abs(b.sigma).max(axis=(1, 2)) for b in blocks], axis=0)
    for step in range(MOST_STEPS):
        rising, falling = low_slope > 0, high_slope < 0
        bracketed = rising & falling
        with np.errstate(divide="ignore", invalid="ignore"):
            change = low_slope - high_slope
            meet = (high_value - low_value + low_slope * low - high_slope * high) / change
            bound = low_value + low_slope * (meet - low)
            flat = (low_slope * high - high_slope * low) / change
        meet = np.clip(meet, low, high)
        best = np.maximum(low_value, high_value)
        enough = RELATIVE * np.abs(best) + ROUNDING * size
        done = (low_slope == 0) | (high_slope == 0) | (bracketed & (bound - best <= enough))
        done |= (low > MOST_TAU) | (high < 1 / MOST_TAU)
        if step == MOST_STEPS - 1:
            done[:] = True
        result[index[done]] = best[done]
        at[index[done]] = np.where(low_value > high_value, low, high)[done]
        if done.all():
            break
        inner = meet if step % 2 else flat
        tau = np.where(bracketed, inner, np.where(rising, low * reach, high / reach))
        keep = ~done
        index, spread, tau, size = index[keep], spread[keep], tau[keep], size[keep]
        blocks = [_Family(*(a[keep] for a in b)) for b in blocks]
        value, slope = _margin(blocks, spread, tau)
        up = slope >= 0
        ends = (low, low_value, low_slope), (high, high_value, high_slope)
        (low, low_value, low_slope), (high, high_value, high_slope) = (
            tuple(
                np.where(mine, new, old[keep])
                for new, old in zip((tau, value, slope), end, strict=True)
            )
            for mine, end in ((up, ends[0]), (~up, ends[1]))
        )
    return result, at


def _margin(blocks: list[_Family], spread: Array, tau: Array) -> tuple[Array, Array]:
    """Return the lowest eigenvalue of M(τ) over all blocks, and its slope in τ, (n,) each."""
    lowest = np.full(len(tau), np.inf)
    slope = np.empty(len(tau))
    for block in blocks:
        loss = tau[:, None, None] * block.vv + block.uu / tau[:, None, None]
        values, vectors = np.linalg.eigh(block.sigma - spread[:, None, None] * loss)
        x = vectors[:, :, 0]
        uu, vv = (((a @ x[..., None])[..., 0] * x).sum(axis=1) for a in (block.uu, block.vv))
        mine = values[:, 0] < lowest
        lowest = np.where(mine, values[:, 0], lowest)
        slope = np.where(mine, spread * (uu / tau**2 - vv), slope)
    return lowest, slope
