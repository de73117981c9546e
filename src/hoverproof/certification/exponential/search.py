"""Find the set and the weights that bring starts inside, in floating point."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.candidate import Candidate
from hoverproof.certification.exponential.question import ROOM, Question
from hoverproof.descent import Ends, descend

Array = NDArray[np.float64]
EVALUATIONS = 24
QUIETER, SHARE = 20, 0.7
"""So often what noise leaves is asked to be less, by that share."""
SLOWER = 0.1
"""Times the slow rate, where none are found at that."""
FAILED = 1e3


def deepest(question: Question, starts: Array, near: Array | None = None) -> Candidate | None:
    """Bring the starts as deep inside as can be, at a slow rate.

    Parameters
    ----------
    question : Question
    starts : (k, 11)
        See `Question.terms`.
    near : (2,), optional
        Where a candidate was found for a question that is much the same.
    """
    low, high = question.ends
    if not low < high:
        return None
    rate = question.slow(low)
    for slower, largest in ((1.0, high), (1.0, question.known), (SLOWER, question.known)):
        ends = math.log(low), math.log(max(min(largest, high), low))
        found = _deepest(question, starts, slower * rate, ends, near)
        if found is not None:
            return found
    return None


def _deepest(
    question: Question, starts: Array, rate: float, ends: tuple[float, float], near: Array | None
) -> Candidate | None:
    """Return the deepest at a rate, 1/s, from places between logarithms of d; None if none is."""
    low, high = ends
    likely: tuple[int, ...] = ()

    def cost(x: Array) -> float:
        nonlocal likely
        found = question.at(x, rate, starts, likely)
        if found is None:
            return FAILED
        likely = found.solution.tight
        return float(np.log(found.solution.fill))

    guesses = [
        np.array([low + part * (high - low), share])
        for part in (0.6, 0.85, 0.3)
        for share in (-1.7, -3.0, -0.5)
    ]
    guesses = guesses if near is None else [near, *guesses]
    begin, least = None, FAILED
    for guess in guesses:
        if (value := cost(guess)) < least:
            begin, least = guess, value
        if least < np.log(1 - ROOM):
            break
    if begin is None:
        return None
    if least > np.log(1 - ROOM):
        steps = np.diag([0.15 * (high - low), 0.5])
        begin = _minimum(cost, np.vstack([begin, begin + steps]), float(np.log(1 - ROOM)))
    return question.at(begin, rate, starts)


def quietest(question: Question, found: Candidate, starts: Array) -> Candidate:
    """Let noise leave as little as can be, at the rate of a candidate.

    Parameters
    ----------
    question : Question
    found : Candidate
    starts : (k, 11)
        See `Question.terms`.
    """
    for share in (SHARE,) * QUIETER if question.vehicles.is_shaken else ():
        new = question.at(
            found.x, found.rate, starts, found.solution.tight, share * found.solution.floor
        )
        if new is None or not question.holds(new):
            break
        found = new
    return found


def narrowest(question: Question, first: Candidate, starts: Array) -> Candidate:
    """Make the angle to the axis narrow under which all is seen, from a candidate.

    Parameters
    ----------
    question : Question
    first : Candidate
    starts : (k, 11)
        See `Question.terms`.
    """
    best = first

    def cost(x: Array) -> float:
        nonlocal best
        found = question.at(x, first.rate, starts)
        if found is None or found.solution.fill > 1 - ROOM:
            return FAILED
        seen = question.seen(found)
        if seen < question.seen(best):
            best = found
        return float(np.log(seen))

    begin = first.x
    _minimum(cost, np.vstack([begin, begin + np.diag([-0.04, -0.4])]))
    return best


def _minimum(cost: Callable[[Array], float], simplex: Array, enough: float = -np.inf) -> Array:
    return descend(cost, simplex, Ends(EVALUATIONS, values=1e-3, places=1e-3, enough=enough))[1]
