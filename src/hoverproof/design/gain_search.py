"""The search for gains, in floating point, many at once.

For given k1, k2 and k3 a higher k4 never lowers the margin, so it is put at its limit; what is left
is searched on lattices that shrink about the best point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoverproof.design.limits import FirstCommand, Limits, highest_k4
from hoverproof.design.margins import Questions, margins
from hoverproof.servo.linearised import slowest_rates

Array = NDArray[np.float64]
Objective = Literal["decay", "settling"]

SAMPLES = 4096
STARTS = 2
DECADES = 5
COARSE = 0.02
FINEST = 1e-5
LEAST = 1e-6
GUARD = 1e-5
MOST_ROUNDS = 200


@dataclass(frozen=True)
class GainSearch:
    """What is searched; a point z is (log k1, log k1 k2, log k3) and k4 the highest allowed.

    For the objective "settling" z has a fourth entry: log of the part of the highest k4 that is
    taken.

    Attributes
    ----------
    questions : Questions
        The bounds and weights; its gains do not count.
    limits : Limits
    command : FirstCommand
        The first command at the mission's start.
    objective : str
        See `hoverproof.tune`.
    at_least : float
        For "settling": decay rate of L that must be certified, 1/s.
    """

    questions: Questions
    limits: Limits
    command: FirstCommand
    objective: Objective
    at_least: float = 0.0

    @property
    def size(self) -> int:
        """Number of entries of a point."""
        return 3 if self.objective == "decay" else 4

    def gains(self, z: Array) -> tuple[Array, ...]:
        """Return k1…k4 of points (n, size), NaN where the limits allow none.

        Parameters
        ----------
        z : (n, 3) or (n, 4)
            Points.
        """
        k1, stiff, k3 = np.exp(z[:, :3].T)
        low, high = highest_k4(self.limits, self.command, (k1, stiff / k1, k3))
        part = np.exp(z[:, 3]) if self.objective == "settling" else 1.0
        k4 = low + (high - low) * part
        return k1, stiff / k1, k3, np.where((low < high) & (part <= 1.0), k4, np.nan)

    def values(self, gains: tuple[Array, ...], floor: float = -math.inf) -> Array:
        """Return the rate to be made large of n sets of gains, 1/s; -inf where there is none.

        Parameters
        ----------
        gains : (4,) of (n,)
            Those of the error chain, in the order and units of the law's design; NaN where there
            are none.
        floor : float
            Rates below are only found to be so, 1/s.
        """
        good = np.isfinite(gains[3])
        held = tuple(np.where(good, k, 1.0) for k in gains)
        questions = replace(self.questions, gains=held)
        if self.objective == "settling":
            least = max(self.at_least * (1 + GUARD), LEAST * self.limits.fastest)
            rate = 2 * margins(questions) / questions.mass
            proved = rate > least
            slowest = np.full(len(good), -np.inf)
            slowest[proved] = slowest_rates(self.command.mission, tuple(k[proved] for k in held))
            rate = np.where(slowest > 0, slowest, np.minimum(rate - least, 0.0))
        else:
            rate = 2 * margins(questions, floor * questions.mass / 2) / questions.mass
        return np.where(good & np.isfinite(rate), rate, -np.inf)

    def starts(self) -> Array:
        """Return the best of a Halton sequence of points, best first, (STARTS, size).

        The best of its first points are the floor of all others.
        """
        top = math.log(self.limits.fastest * self.questions.mass)
        points = halton(SAMPLES, self.size)
        span = DECADES * math.log(10)
        z = top - span * points
        z[:, 0] += span / 2  # k1 has other units: about the square root of the others
        if self.size == 4:
            z[:, 3] = -3 * points[:, 3]
        first = self.values(self.gains(z[: SAMPLES // 8]))
        rest = self.values(self.gains(z[SAMPLES // 8 :]), np.sort(first)[-STARTS])
        values = np.concatenate([first, rest])
        best: Array = z[np.argsort(-values, kind="stable")[:STARTS]]
        return best

    def climb(self, start: Array, reach: float, finest: float) -> tuple[Array, float]:
        """Follow lattices about the best point so far, which shrink where it is inside.

        Parameters
        ----------
        start : (3,) or (4,)
            Point to set out from.
        reach, finest : float
            Half the width of the lattice at first, and at last; dimensionless, as z are logarithms.
        """
        line = np.linspace(-1, 1, 7 if self.size == 3 else 5)
        lattice = np.stack(np.meshgrid(*[line] * self.size, indexing="ij"), -1)
        lattice = lattice.reshape(-1, self.size)
        best, value = start, float(self.values(self.gains(start[None]))[0])
        for _ in range(MOST_ROUNDS if value > -np.inf else 0):
            trial = best + reach * lattice
            values = self.values(self.gains(trial), value)
            k = int(values.argmax())
            better = values[k] > value
            if better:
                best, value = trial[k], float(values[k])
            if not better or np.abs(lattice[k]).max() < 1:
                reach /= 2
            if reach < finest:
                break
        return best, value

    def run(self) -> tuple[Array, float]:
        """Return the best point and its rate, 1/s."""
        found = [self.climb(z, 1.0, COARSE) for z in self.starts()]
        best, _ = max(found, key=lambda one: one[1])
        return self.climb(best, 2 * COARSE, FINEST)


def halton(count: int, size: int) -> Array:
    """Return the first points of Halton's sequence in a cube, (count, size).

    As `scipy.stats.qmc.Halton` does, which takes as long to import as half the search.

    Parameters
    ----------
    count : int
        Number of points.
    size : int
        Number of dimensions, up to 4.
    """
    columns = []
    for base in (2, 3, 5, 7)[:size]:
        powers = base ** np.arange(1, math.ceil(math.log(count + 1, base)) + 1)
        digits = np.arange(1, count + 1)[:, None] * base // powers % base
        columns.append((digits / powers).sum(axis=1))
    return np.stack(columns, axis=1)
