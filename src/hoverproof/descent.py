"""Descent without derivatives, for costs of a few parameters that take long or are not smooth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Ends:
    """When a descent ends: after so many evaluations, where all corners are near, or is enough.

    Attributes
    ----------
    evaluations : int
        The largest number of them.
    values, places : float
        Largest difference of costs, and of parameters: bare numbers in the units of each.
    enough : float
        A cost below it is low enough: a bare number in the unit of costs.
    """

    evaluations: int
    values: float
    places: float
    enough: float = -np.inf


class _Spent(Exception):
    """No evaluation is left."""


def descend(cost: Callable[[Array], float], simplex: Array, ends: Ends) -> tuple[float, Array]:
    """Return the lowest cost that the simplex method of Nelder and Mead (1965) finds, and where.

    It is SciPy's, corner by corner, without the import of all of ``scipy.optimize``, which takes
    longer than many a search.

    Parameters
    ----------
    cost : callable
        Parameters (k,) ↦ what is to be made small.
    simplex : (m, k)
        The m = k + 1 corners from which to set out, in the units of the parameters.
    ends : Ends
    """
    left = ends.evaluations

    def value(x: Array) -> float:
        nonlocal left
        if not left:
            raise _Spent
        left -= 1
        return cost(x)

    places, values = np.array(simplex, float), np.full(len(simplex), np.inf)
    try:
        for j, place in enumerate(places):
            values[j] = value(place)
        while left and not values.min() < ends.enough:
            places, values = _in_order(places, values)
            near = np.abs(places[1:] - places[0]).max() <= ends.places
            if near and np.abs(values[1:] - values[0]).max() <= ends.values:
                break
            _step(value, places, values)
    except _Spent:
        pass
    places, values = _in_order(places, values)
    return float(values[0]), places[0]


def _in_order(places: Array, values: Array) -> tuple[Array, Array]:
    order = np.argsort(values)
    return places[order], values[order]


def _step(value: Callable[[Array], float], places: Array, values: Array) -> None:
    """Reflect, expand or contract the highest corner, or shrink all to the lowest, in place."""
    middle, last = np.add.reduce(places[:-1], 0) / (len(places) - 1), places[-1]
    moved = 2 * middle - last
    found = value(moved)
    if found < values[0]:
        farther = 3 * middle - 2 * last
        beyond = value(farther)
        places[-1], values[-1] = (farther, beyond) if beyond < found else (moved, found)
        return
    if found < values[-2]:
        places[-1], values[-1] = moved, found
        return
    outside = found < values[-1]
    nearer = 1.5 * middle - 0.5 * last if outside else 0.5 * middle + 0.5 * last
    between = value(nearer)
    if between <= found if outside else between < values[-1]:
        places[-1], values[-1] = nearer, between
        return
    for j in range(1, len(places)):
        place = places[0] + 0.5 * (places[j] - places[0])
        places[j], values[j] = place, value(place)
