"""Gains of few digits near those that a search for a start has found."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.design.start_search import Point, StartSearch

LOSS = 0.006
"""Part of the time by which rounding may make it longer."""
ROUNDED, TRIED = 2, 8
"""So many of all of so many digits are tried, each with so many programs."""


def rounded(search: StartSearch, point: Point) -> Iterator[tuple[tuple[Fraction, ...], Point]]:
    """Yield gains of few digits that are hardly slower, and their point, then longer ones.

    Parameters
    ----------
    search : StartSearch
    point : Point
        Where the starts are inside.
    """
    exact, at = np.exp(point.z[:4]), search.value(point.z)
    if at is None:
        return
    slopes = search.times.slopes(point.z, at)
    for digits in range(2, 7):
        around = [(decimal_below(k, digits), decimal_above(k, digits)) for k in exact]
        fours = list(itertools.product(*around))
        moved = np.log(np.array(fours, float)) - point.z[:4]
        over = at.over + moved @ slopes[1:, :4].T
        order = np.argsort(np.maximum(over, 0).sum(axis=1), kind="stable")
        for k in order[:ROUNDED]:
            near = search.best_for(np.array(fours[k], float), point.z[None, 4:], TRIED)
            if near.cost < point.cost + LOSS:
                yield fours[k], near
                break
