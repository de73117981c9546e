"""Descent with slopes under constraints: quadratic programs, one after the other (S.-P. Han, 1977).

Each is solved within a trust region. What is beyond a constraint is not forbidden but costs `STEEP`
times as much, so that a descent may set out where constraints are not kept. A constraint may have
edges, as the largest eigenvalue of a matrix has: planes that touch it at places that were seen
before are kept, as in a bundle method (C. Lemaréchal, 1975), lowered where they would lie above it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEEP = 20.0
FIRST, SMALLEST, LARGEST = 0.3, 3e-4, 1.0
"""Of the trust region: the largest step of each parameter, at first, at last and ever."""
ENOUGH = 3e-4
"""A descent ends where no more than that is promised."""
AGAIN = 0.03
"""The trust region with which a descent that is at its end goes on without the planes it kept."""
KEPT = 12
"""So many of the planes that touch the constraints at places before are kept."""
CURVED = 0.3
"""The curvature that is supposed at first."""


class Value(NamedTuple):
    """What there is at a place.

    Attributes
    ----------
    cost : float
        A bare number, dimensionless.
    over : (m,)
        What is above 0 is beyond a constraint.
    found : object
        What the slopes are to be taken of.
    """

    cost: float
    over: Array
    found: Any

    @property
    def merit(self) -> float:
        """The cost, and what it costs to be beyond constraints."""
        return self.cost + STEEP * float(np.maximum(self.over, 0).sum())

    @property
    def all(self) -> Array:
        """The cost and what is over, (1 + m,)."""
        return np.array([self.cost, *self.over])


@dataclass
class Descent:
    """A descent: what is asked at a place.

    Attributes
    ----------
    value : callable
        Parameters (k,) ↦ `Value`, or None where there is nothing.
    slopes : callable
        Parameters and what `value` has given there ↦ how the cost and what is over change with the
        parameters, (1 + m, k).
    highest : (k,)
        Upper bounds of the parameters.
    enough : callable
        `Value` ↦ whether no better one is looked for; by default none is enough.
    first : float
        The largest step of each parameter at first, a bare number.
    """

    value: Callable[[Array], Value | None]
    slopes: Callable[[Array, Value], Array]
    highest: Array
    enough: Callable[[Value], bool] | None = None
    first: float = FIRST

    def run(self, z: Array, at: Value, evaluations: int) -> tuple[Array, Value]:
        """Return the best place that is found, and what is there.

        Parameters
        ----------
        z : (k,)
            Where to set out.
        at : Value
            What is there.
        evaluations : int
            The largest number of places that are looked at.
        """
        radius, bend = self.first, CURVED * np.eye(len(z))
        slopes = self.slopes(z, at)
        seen: list[tuple[Array, Array, Array]] = []
        before = np.inf
        for _ in range(evaluations):
            if self.enough is not None and self.enough(at):
                break
            cuts = [(np.minimum(over + S @ (z - y), at.over), S) for y, over, S in seen]
            step, prices, promised = _step(at, slopes, cuts, bend, radius, self.highest - z)
            if promised < ENOUGH or radius < SMALLEST:
                if not seen or before - at.merit < ENOUGH:
                    break
                before, seen, radius = at.merit, [], max(radius, AGAIN)
                continue
            new = self.value(z + step)
            size = float(np.abs(step).max())
            if new is None:
                radius = 0.4 * min(radius, size)
                continue
            gained, there = at.merit - new.merit, self.slopes(z + step, new)
            if gained > 0:
                bend = _bent(bend, step, prices @ (there - slopes))
                seen = [*seen, (z, at.over, slopes[1:])][-KEPT:]
            else:
                seen = [*seen, (z + step, new.over, there[1:])][-KEPT:]
            if gained > 0.7 * promised:
                radius = min(max(radius, 2 * size), LARGEST)
            elif gained < 0.1 * promised:
                radius = 0.5 * min(radius, size)
            if gained > 0:
                z, at, slopes = z + step, new, there
        return z, at


def _step(
    at: Value,
    slopes: Array,
    cuts: list[tuple[Array, Array]],
    bend: Array,
    radius: float,
    room: Array,
) -> tuple[Array, Array, float]:
    """Return the best step in a trust region, the prices of all, and what it promises."""
    import clarabel
    from scipy.sparse import csc_array

    k, m = slopes.shape[1], len(slopes) - 1
    values = np.stack([at.over, *(value for value, _ in cuts)])
    planes = np.stack([slopes[1:], *(slope for _, slope in cuts)])
    rows, share = planes.reshape(-1, k), np.tile(-np.eye(m), (len(values), 1))
    most = np.minimum(radius, np.maximum(room, 0))
    none, sides = np.zeros((k, m)), np.eye(k)
    A = np.block([[rows, share], [np.zeros((m, k)), -np.eye(m)], [sides, none], [-sides, none]])
    b = np.concatenate([-values.ravel(), np.zeros(m), most, np.full(k, radius)])
    P = np.zeros((k + m, k + m))
    P[:k, :k] = np.triu(bend)
    q = np.concatenate([slopes[0], np.full(m, STEEP)])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.NonnegativeConeT(len(b))]
    solver = clarabel.DefaultSolver(csc_array(P), q, csc_array(A), b, cones, settings)
    solution = solver.solve()
    step = np.array(solution.x)[:k]
    prices = np.array(solution.z)[: values.size].reshape(values.shape).sum(axis=0)
    over = (values + planes @ step).max(axis=0)
    model = at.cost + slopes[0] @ step + step @ bend @ step / 2
    model += STEEP * float(np.maximum(over, 0).sum())
    return step, np.array([1.0, *prices]), float(at.merit - model)


def _bent(bend: Array, step: Array, turned: Array) -> Array:
    """Return the curvature after a step, by the damped rule of Powell (1978)."""
    along = bend @ step
    size, seen = float(step @ along), float(step @ turned)
    part = 1.0 if seen >= 0.2 * size else 0.8 * size / (size - seen)
    y = part * turned + (1 - part) * along
    return bend - np.outer(along, along) / size + np.outer(y, y) / float(step @ y)
