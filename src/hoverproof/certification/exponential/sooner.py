"""The search for a short proved settling time, with slopes, in floating point.

At a point, d, the share of the largest force and the rate are given, and gains where those are
searched too. One semidefinite program tells by how much the rate is missed there, and its dual
solution how that changes with all of them; so few programs do.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.candidate import Asked, Candidate, angle_seen
from hoverproof.certification.exponential.program import Solution
from hoverproof.certification.exponential.question import ROOM, Question
from hoverproof.sequential import AGAIN, FIRST, Descent, Value

Array = NDArray[np.float64]
Likely = tuple[int, ...]
LITTLE = np.array([-1e-2, 1e-3, 1e-3])
"""By how much d, share and rate, as they are searched, are changed to see what comes of it; d is
made less, as it may be the largest of which a bound of J is known."""
OUTSIDE, FAILED = 500.0, 1e3
"""Costs where the start is not held, and where nothing is found."""
KEEPS = 2e-3
"""A limit is kept that is exceeded by less than that share, or rad: for the view, which the proof
does not let be exceeded, it is spared."""
EDGE = math.sqrt(1 - ROOM)
"""How far out the starts may be, over d, where Ψ is that share of the level."""
FASTER, MOST_RATES = 1.6, 20
"""By which factor the rate is made faster, and how often, before a descent."""
SLOWER = 0.9995, 0.998, 0.99, 0.96, 0.9
"""Parts of the rate that was found, of which the first is taken with which the starts are held."""


class Found(NamedTuple):
    """What is at a point.

    Attributes
    ----------
    asked : Asked
    solution : Solution
    offset, tilt : float
        The largest |σ - σ*| and sine of the tilt from the starts on, over those of the limits,
        dimensionless; or what they are at most, see `Times.smooth`.
    """

    asked: Asked
    solution: Solution
    offset: float
    tilt: float


@dataclass(frozen=True)
class Times:
    """When the starts have settled, and what is beyond limits, at points.

    Attributes
    ----------
    whole : Question
        What is seen, and what settled means, are those of it at every point.
    pose : callable
        A point, (k,) ↦ what is asked there, or None.
    beyond : callable
        Points, (n, k) ↦ by which share they are beyond each of m limits, (n, m).
    little : (k,)
        See `LITTLE`.
    smooth : bool
        What is seen is bounded by d and the share of the force alone. Else it is that of the
        weights that are found, which is less where these are not what binds; but then its slopes
        are not those that are taken, and a descent may end short of the best place.
    tried : list of (k,)
        The points that were looked at.
    """

    whole: Question
    pose: Callable[[Array], Asked | None]
    beyond: Callable[[Array], Array]
    little: Array = field(default_factory=lambda: LITTLE)
    smooth: bool = False
    tried: list[Array] = field(default_factory=list, compare=False)

    @classmethod
    def of(cls, question: Question, starts: Array) -> Times:
        """Search for gains that are given; a point is d, share and rate.

        Parameters
        ----------
        question : Question
        starts : (j, 11)
            See `Question.terms`, bare numbers.
        """
        return cls(
            question,
            lambda z: question.pose(z[:2], math.exp(z[2]), starts, fill=1 - ROOM),
            lambda places: np.zeros((len(places), 0)),
        )

    def value(self, z: Array, likely: Likely = ()) -> Value | None:
        """Return the logarithm of the time at a point, and what is beyond a limit there.

        Parameters
        ----------
        z : (k,)
        likely : tuple of int
            See `program.solve`.
        """
        self.tried.append(z)
        asked = self.pose(z)
        solution = None if asked is None else asked.program.solve(likely)
        return None if asked is None or solution is None else self._at(z, asked, solution)

    def _at(self, z: Array, asked: Asked, solution: Solution) -> Value:
        """Return what is at a point where weights are found."""
        found = Found(asked, solution, *self._inside(asked, solution))
        missing, limited = float(solution.optimum.x[-1]), self.beyond(z[None])[0]
        return self._value(found, asked, missing, limited)

    def _inside(self, asked: Asked, solution: Solution) -> tuple[float, float]:
        """Return offset and tilt of `Found`."""
        if self.smooth:
            return EDGE, EDGE
        offset, tilt = asked.with_weights(solution).farthest(asked.limits.vehicles)
        return offset / asked.offset, tilt / asked.limits.tilt

    def slopes(self, z: Array, at: Value, first: int = 0) -> Array:
        """Return how the time and what is beyond limits change with a point, (1 + m, k - first).

        Parameters
        ----------
        z : (k,)
        at : Value
            What is there.
        first : int
            Number of the first parameter that changes.
        """
        found: Found = at.found
        places = z + np.diag(self.little)
        limited = self.beyond(places)
        result = np.zeros((len(at.all), len(z) - first))
        for k, step in list(enumerate(self.little))[first:]:
            new = self.pose(places[k])
            if new is not None:
                missing = found.solution.optimum.x[-1]
                missing += found.asked.program.change(found.solution, new.program)
                there = self._value(found, new, missing, limited[k]).all
                result[:, k - first] = (there - at.all) / step
        return result

    def descend(
        self,
        z: Array,
        at: Value,
        highest: Array,
        evaluations: int,
        enough: Callable[[Value], bool] | None = None,
    ) -> tuple[Array, Value]:
        """Return the best point that is found, and what is there.

        Where a camera has a half angle, the descent is first `smooth`.

        Parameters
        ----------
        z : (k,)
            Where to set out.
        at : Value
            What is there.
        highest : (k,)
            Upper bounds of the parameters.
        evaluations : int
            The largest number of programs, of either descent.
        enough : callable, optional
            See `Descent`.
        """
        first = FIRST
        if self.whole.half_angle is not None and not self.smooth:
            smooth = replace(self, smooth=True)
            begin = smooth._at(z, at.found.asked, at.found.solution)
            near, there = smooth.descend(z, begin, highest, evaluations, enough)
            new = self._at(near, there.found.asked, there.found.solution)
            if there.over[-1] < -KEEPS:  # it does not matter what is seen
                return near, new
            z, at, first = (near, new, AGAIN) if new.merit <= at.merit else (z, at, FIRST)
        likely = at.found.solution.tight

        def value(z: Array) -> Value | None:
            nonlocal likely
            new = self.value(z, likely)
            likely = likely if new is None else new.found.solution.tight
            return new

        return Descent(value, self.slopes, highest, enough, first).run(z, at, evaluations)

    def _value(self, found: Found, asked: Asked, missing: float, limited: Array) -> Value:
        """Return the value where so much of the rate is missing, 1/s, near what was found."""
        time = asked.time(self.whole.settled_offset, 1 - ROOM)
        over = [missing / asked.rate, *limited, *self._unseen(found, asked)]
        return Value(math.log(time) if 0 < time < math.inf else FAILED, np.array(over), found)

    def _unseen(self, found: Found, asked: Asked) -> list[float]:
        """Return how far beyond the half angle of the camera points may be, rad, if it is said."""
        half = self.whole.half_angle
        if half is None:
            return []
        cone = float(np.interp(asked.x[0] + math.log(found.offset), *self.whole.views))
        return [angle_seen(cone, min(found.tilt * asked.limits.tilt, 1.0)) + KEEPS - half]


def soonest(question: Question, first: Candidate, starts: Array, evaluations: int) -> Candidate:
    """Make the time short in which the starts have settled, from a candidate.

    Parameters
    ----------
    question : Question
    first : Candidate
    starts : (k, 11)
        See `Question.terms`.
    evaluations : int
        The largest number of places that are looked at.
    """
    first = _faster(question, first, starts)
    times, z = Times.of(question, starts), np.array([*first.x, math.log(first.rate)])
    at = times.value(z, first.solution.tight)
    if at is None:
        return first
    highest = np.array([math.log(question.highest * question.scene.wanted) - 1e-9, np.inf, np.inf])
    z, at = times.descend(z, at, highest, evaluations)
    likely = at.found.solution.tight
    for part in SLOWER:
        slower = times.value(z + np.array([0, 0, math.log(part)]), likely)
        if slower is not None and slower.over[0] <= 0:
            found: Found = slower.found
            candidate = found.asked.with_weights(found.solution)
            if question.holds(candidate):
                return candidate
    return first


def _faster(question: Question, found: Candidate, starts: Array) -> Candidate:
    """Return the same place with as fast a rate as holds the starts, within a factor."""
    for _ in range(MOST_RATES):
        new = question.at(found.x, FASTER * found.rate, starts, found.solution.tight)
        if new is None or not question.holds(new):
            break
        found = new
    return found
