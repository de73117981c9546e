"""What turns a velocity into the rate of a law's feature: Q of the centroid, J of the scaled one.

Bounds are two numbers, low and high. Those of Q are of its eigenvalues; those of J are the ends of
a ball, |J - j I| <= ϱ, low = j - ϱ and high = j + ϱ.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification import scaled
from hoverproof.certification.cells import Told, View, largest_below, norms, smallest_above
from hoverproof.certification.pattern import Pattern
from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]
Spot = tuple[Array, Array, str, float]
Write = Callable[[Any], str]
"""How a number is written."""
GRID, COARSE = 25, 13
"""Positions to a side of a box that are looked at."""
BEYOND = 1e9
"""1/m, in place of what is no number."""


@dataclass(frozen=True)
class OfQ:
    """The eigenvalues of Q.

    Attributes
    ----------
    symbol : str
    words : str
        What is bounded.
    named : str
        The same in short.
    bounds : str
        What is proved or assumed of it.
    every : str
        For what a claim holds, before `within`.
    cost : int
        Of a cell, a bare number; see `checker.tree_of`.
    slacks : (k,)
        By which shares the narrowest bounds found are widened, one after the other.
    """

    symbol: str = "Q"
    words: str = "the eigenvalues of Q"
    named: str = "the eigenvalues of Q"
    bounds: str = "bounds of the eigenvalues"
    every: str = "every symmetric Q with eigenvalues in"
    cost: int = 5
    slacks: tuple[str, ...] = ("0.01", "0.03", "0.1", "0.3", "0.6")

    def within(self, ends: Sequence[Any], write: Write) -> str:
        """Write bounds, without what is bounded.

        Parameters
        ----------
        ends : (low, high)
            1/m.
        write : callable
            How a number is written.
        """
        return f"[{write(ends[0])}, {write(ends[1])}] 1/m"

    def kept(self, target: Pattern, positions: Array, low: float, high: float) -> Told:
        """Tell whether bounds hold at positions, (k,), in floating point.

        Parameters
        ----------
        target : Pattern
        positions : (k, 3)
            World frame, m.
        low, high : float
            1/m.
        """
        values = eigenvalues(target, positions)
        return np.asarray((values[:, 0] >= low) & (values[:, 2] <= high))

    def hold(self, target: Pattern, cells: Array, low: float, high: float) -> Told:
        """Tell whether bounds hold over cells, (k,).

        Parameters
        ----------
        target : Pattern
        cells : (k, 3, 2)
            Low and high ends, m.
        low, high : float
            1/m.
        """
        view = View.of(target, cells)
        return largest_below(view, high) & smallest_above(view, low)

    def needed(self, target: Pattern, box: Array) -> tuple[float, float]:
        """Return the narrowest bounds that are found over a box, 1/m.

        Parameters
        ----------
        target : Pattern
        box : (3, 2)
            Low and high ends, m.
        """
        places = samples(box)
        values = eigenvalues(target, places)
        found = [float(values[:, 0].min()), float(values[:, 2].max())]
        centers = [places[values[:, 0].argmin()], places[values[:, 2].argmax()]]
        size = np.ptp(box, axis=1) / (GRID - 1)
        for _ in range(2):
            for k, column in ((0, 0), (1, 2)):
                around = np.clip(centers[k] + size * _unit_grid(), box[:, 0], box[:, 1])
                values = eigenvalues(target, around)[:, column]
                best = values.argmin() if k == 0 else values.argmax()
                centers[k], found[k] = around[best], float(values[best])
            size = size / 6
        return found[0], found[1]

    def widened(self, low: float, high: float, slack: str) -> tuple[Fraction, Fraction]:
        """Return wider bounds, 1/m.

        Parameters
        ----------
        low, high : float
            1/m.
        slack : str
            A share, as an exact decimal.
        """
        return Fraction(low) * (1 - Fraction(slack)), Fraction(high) * (1 + Fraction(slack))

    def at(self, target: Pattern, position: Array, low: float, high: float) -> str:
        """Say that bounds do not hold at a position.

        Parameters
        ----------
        target : Pattern
        position : (3,)
            World frame, m.
        low, high : float
            1/m.
        """
        least, _, most = eigenvalues(target, position[None])[0]
        return (
            f"Q at the goal has eigenvalues from {least:.4g} to {most:.4g} 1/m, not within "
            f"[{low:g}, {high:g}]"
        )

    def out(self, target: Pattern, positions: Array, low: float, high: float) -> Iterator[Spot]:
        """Yield where bounds are farthest from holding: position, direction, bound and value.

        Parameters
        ----------
        target : Pattern
        positions : (k, 3)
            World frame, m.
        low, high : float
            1/m.
        """
        values, vectors = np.linalg.eigh(View.at(target, positions).depths)
        for column, bound in ((0, "lower"), (2, "upper")):
            at = int(values[:, 0].argmin() if column == 0 else values[:, 2].argmax())
            value = float(values[at, column])
            if value < low if bound == "lower" else value > high:
                yield positions[at], vectors[at, :, column], bound, value


@dataclass(frozen=True)
class OfJ:
    """A ball about a multiple of I that holds J, with the methods of `OfQ`.

    Attributes
    ----------
    symbol, words, named, bounds, every, slacks
        See `OfQ`.
    cost : int
        Of a cell, a bare number.
    """

    symbol: str = "J"
    words: str = "the ball [j - ϱ, j + ϱ] of J"
    named: str = "J"
    bounds: str = "bounds of J"
    every: str = "every 3 x 3 matrix J with"
    cost: int = 15
    slacks: tuple[str, ...] = ("0.05", "0.1", "0.25", "0.5", "1")

    def within(self, ends: Sequence[Any], write: Write) -> str:
        """See `OfQ.within`: |J - j I| <= ϱ.

        Parameters
        ----------
        ends : (low, high)
            1/m.
        write : callable
            How a number is written.
        """
        low, high = ends
        return f"|J - {write((low + high) / 2)} I| <= {write((high - low) / 2)} 1/m"

    def kept(self, target: Pattern, positions: Array, low: float, high: float) -> Told:
        """See `OfQ.kept`.

        Parameters
        ----------
        target : Pattern
        positions : (k, 3)
            World frame, m.
        low, high : float
            1/m.
        """
        far = self.far(target, positions, (low + high) / 2)
        return np.asarray(far <= (high - low) / 2)

    @staticmethod
    def far(target: Pattern, positions: Array, j: float) -> Array:
        """Return |J - j I| at positions, (k,), 1/m; `BEYOND` where J is not a number.

        Parameters
        ----------
        target : Pattern
        positions : (k, 3)
            World frame, m.
        j : float
            1/m.
        """
        J = np.nan_to_num(scaled.slopes_at(target, positions), nan=BEYOND)
        return _distances(J, j)

    def hold(self, target: Pattern, cells: Array, low: float, high: float) -> Told:
        """See `OfQ.hold`.

        Parameters
        ----------
        target : Pattern
        cells : (k, 3, 2)
            Low and high ends, m.
        low, high : float
            1/m.
        """
        return scaled.within_ball(target, cells, low, high)

    def needed(self, target: Pattern, box: Array) -> tuple[float, float]:
        """See `OfQ.needed`: on a grid.

        Parameters
        ----------
        target : Pattern
        box : (3, 2)
            Low and high ends, m.
        """
        from scipy.optimize import minimize_scalar

        J = scaled.slopes_at(target, samples(box, COARSE))

        def reach(j: float) -> float:
            return float(_distances(J, j).max())

        size = float(np.trace(J, axis1=1, axis2=2).max())  # of a sum of three slopes
        found = minimize_scalar(
            reach, bounds=(0, size), method="bounded", options={"xatol": 1e-6 * size}
        )
        return float(found.x - found.fun), float(found.x + found.fun)

    def widened(self, low: float, high: float, slack: str) -> tuple[Fraction, Fraction]:
        """See `OfQ.widened`: the ball, about its middle.

        Parameters
        ----------
        low, high : float
            1/m.
        slack : str
            A share, as an exact decimal.
        """
        j, reach = Fraction(low + high) / 2, Fraction(high - low) / 2 * (1 + Fraction(slack))
        return j - reach, j + reach

    def at(self, target: Pattern, position: Array, low: float, high: float) -> str:
        """See `OfQ.at`.

        Parameters
        ----------
        target : Pattern
        position : (3,)
            World frame, m.
        low, high : float
            1/m.
        """
        j, reach = (low + high) / 2, (high - low) / 2
        (far,) = self.far(target, position[None], j)
        return f"J at the goal is {far:.4g} 1/m from {j:g} I, not within {reach:g}"

    def out(self, target: Pattern, positions: Array, low: float, high: float) -> Iterator[Spot]:
        """See `OfQ.out`.

        Parameters
        ----------
        target : Pattern
        positions : (k, 3)
            World frame, m.
        low, high : float
            1/m.
        """
        j = (low + high) / 2
        far = self.far(target, positions, j)
        at = int(far.argmax())
        if far[at] > (high - low) / 2:
            (J,) = scaled.slopes_at(target, positions[at][None])
            yield positions[at], np.linalg.svd(J - j * np.eye(3))[2][0], "ball", float(far[at])


Flow = OfQ | OfJ


def flow_of(mission: Mission) -> Flow:
    """Return what the bounds of a mission are about.

    Parameters
    ----------
    mission : Mission
    """
    return OfJ() if mission.law.feature == "scaled" else OfQ()


def eigenvalues(target: Pattern, positions: Array) -> Array:
    """Return the eigenvalues of Q, ascending, (n, 3), 1/m, in floating point.

    Parameters
    ----------
    target : Pattern
    positions : (n, 3), world frame, m
    """
    return np.asarray(np.linalg.eigvalsh(View.at(target, positions).depths), np.float64)


def samples(box: Array, count: int = GRID) -> Array:
    """Return a grid of positions in a box, (count³, 3), m.

    Parameters
    ----------
    box : (3, 2)
        Low and high ends, m.
    count : int
        Number to a side.
    """
    lines = [np.linspace(a, b, count) for a, b in box]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)


def _distances(J: Array, j: float) -> Array:
    """Return |J - j I| of each, (k,)."""
    return norms(J - j * np.eye(3))


def _unit_grid() -> Array:
    return samples(np.array([[-1.0, 1.0]] * 3), 13)
