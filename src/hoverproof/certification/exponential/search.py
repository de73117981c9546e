"""Find the set, the weights and the rate that bring starts inside, in floating point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.candidate import Candidate
from hoverproof.certification.exponential.question import ROOM, Question
from hoverproof.descent import Ends, descend

Array = NDArray[np.float64]
EVALUATIONS = 24
MOST_RATES, FIRST_STEP = 20, 1.6
MOST_AGAIN, WORTH = 3, 0.1
"""So often a descent of the time is begun anew where it ended, while that takes this share away."""
OUTSIDE, FAILED = 500.0, 1e3
SHORT = 1e-3
"""Times are as good as that, s, if they are shorter."""


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
    low, high = np.log(question.ends)
    if not low < high:
        return None
    rate = question.slow(question.ends[0])

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
        begin = _minimum(cost, np.vstack([begin, begin + steps]), EVALUATIONS)
    return question.at(begin, rate, starts)


def cost_of(question: Question, found: Candidate | None, offset: float) -> float:
    """Return the logarithm of the time until |σ - σ*| is below an offset, or more.

    Parameters
    ----------
    question : Question
    found : Candidate or None
    offset : float
        A bare number, dimensionless.
    """
    if found is None:
        return FAILED
    if found.solution.fill > 1 - ROOM:
        return OUTSIDE + float(np.log(found.solution.fill))
    if not question.sees(found):
        return OUTSIDE + question.seen(found)
    return float(np.log(max(found.time(offset), SHORT)))


def soonest(
    question: Question, first: Candidate, starts: Array, offset: float, worth: float = WORTH
) -> Candidate:
    """Make the time short in which |σ - σ*| is surely below an offset, from a candidate.

    One descent may end early, at the edge of what holds the starts; it is begun anew there.

    Parameters
    ----------
    question : Question
    first : Candidate
    starts : (k, 11)
        See `Question.terms`.
    offset : float
        A bare number, dimensionless.
    worth : float
        Share of the time that a descent takes away if another is begun, dimensionless.
    """
    best = first
    for _ in range(1 + MOST_AGAIN):
        before, best = best, _sooner(question, best, starts, offset)
        if cost_of(question, best, offset) > cost_of(question, before, offset) + np.log(1 - worth):
            break
    return best


def _sooner(question: Question, first: Candidate, starts: Array, offset: float) -> Candidate:
    """Make one descent of the time; see `soonest`."""
    best = first

    def cost(z: Array) -> float:
        nonlocal best
        found = question.at(z[:2], float(np.exp(z[2])), starts, best.solution.tight)
        value = cost_of(question, found, offset)
        if found is not None and value < cost_of(question, best, offset):
            best = found
        return value

    for _ in range(MOST_RATES):
        if cost(np.array([*first.x, np.log(FIRST_STEP * best.rate)])) >= OUTSIDE:
            break
    begin = np.array([*best.x, np.log(best.rate)])
    _minimum(cost, np.vstack([begin, begin + np.diag([-0.03, 0.4, 0.2])]), 2 * EVALUATIONS)
    return best


def quietest(question: Question, found: Candidate, starts: Array) -> Candidate:
    """Let noise leave as little as can be, at the rate of a candidate.

    Parameters
    ----------
    question : Question
    found : Candidate
    starts : (k, 11)
        See `Question.terms`.
    """
    for share in (0.7,) * MOST_RATES if question.vehicles.is_shaken else ():
        new = question.at(
            found.x, found.rate, starts, found.solution.tight, share * found.solution.floor
        )
        if new is None or new.solution.fill > 1 - ROOM / 2 or not question.sees(new):
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
    _minimum(cost, np.vstack([begin, begin + np.diag([-0.04, -0.4])]), EVALUATIONS)
    return best


def _minimum(cost: Callable[[Array], float], simplex: Array, evaluations: int) -> Array:
    return descend(cost, simplex, Ends(evaluations, values=1e-3, places=1e-3))[1]
