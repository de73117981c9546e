"""The search for gains with which a start is soon settled, in floating point.

Gains, the largest offset of the feature on the way, the share of the largest force and the rate are
searched together, one semidefinite program each, whose dual solution tells how its value changes
with all of them. It sets out from a few guesses (`start_guesses`) and descends; what gains may not
exceed is in `start_limits`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential import sooner
from hoverproof.certification.exponential.candidate import Asked
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.proof import ROOMS
from hoverproof.certification.exponential.question import ROOM, Question
from hoverproof.certification.exponential.sooner import FAILED, KEEPS, OUTSIDE, Likely, Times
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.design.limits import FirstCommand, Limits
from hoverproof.design.start_guesses import guesses
from hoverproof.design.start_limits import VIEW, StartLimits
from hoverproof.mission.sections import Mission
from hoverproof.sequential import Descent, Value

Array = NDArray[np.float64]
Progress = Callable[[str], None]
LITTLE = np.array([1e-3, 1e-3, 1e-3, 1e-3, *sooner.LITTLE])
"""By how much each parameter is changed to see what comes of it."""
BEGINNINGS, EVALUATIONS = 2, 70
OWN, FEW = 14, 25
"""So many, at most, for gains that are given, and to find out whether any hold the start."""
SPARED = (0.35, 0.06), (0.6, 0.1)
"""By which shares the ball of J is widened, and d exceeded, for the proof, one after the other."""


class Point(NamedTuple):
    """A point of the search, and its cost.

    Attributes
    ----------
    cost : float
        The logarithm of the time; at least `OUTSIDE` where the start is not held, a bare number.
    z : (7,)
        The logarithms of k1 to k4 and of d, the odds' of the share of the force, and that of r.
    """

    cost: float
    z: Array


@dataclass(frozen=True)
class StartSearch:
    """What is searched.

    Attributes
    ----------
    mission : Mission
        Its gains do not count.
    limits : Limits
    command : FirstCommand
    whole : Question
        With the gains of the mission.
    tried : list of (7,)
        The points that were looked at.
    """

    mission: Mission
    limits: Limits
    command: FirstCommand
    whole: Question
    tried: list[Array] = field(default_factory=list, compare=False)

    @classmethod
    def of(cls, mission: Mission, limits: Limits) -> StartSearch:
        """Prepare a search, with little room for the proof.

        Parameters
        ----------
        mission : Mission
        limits : Limits
        """
        whole = Question.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),))
        wider, beyond = SPARED[0]
        half = mission.camera.about_vertical
        half_angle = None if half is None else float(half)
        highest = ROOMS[0][1]
        whole = replace(whole, highest=highest, half_angle=half_angle)
        whole = replace(whole, wider=wider, beyond=beyond)
        return cls(mission, limits, FirstCommand.of(mission), whole)

    def with_gains(self, four: Array) -> Question:
        """Return the question with other gains.

        Parameters
        ----------
        four : (4,)
            k1 to k4, in the units of the design.
        """
        v = self.whole.vehicles
        numbers, design = v.numbers.copy(), v.law.design
        for name, value in zip(design.chain_gains(), four, strict=True):
            numbers[design.place(name)] = value
        return replace(self.whole, vehicles=v.with_numbers(numbers))

    @cached_property
    def held_to(self) -> StartLimits:
        """What a point may not exceed."""
        return StartLimits(self.mission, self.limits, self.command, self.whole)

    def pose(self, z: Array) -> Asked | None:
        """Return what is asked at a point; None if that is no question.

        Parameters
        ----------
        z : (7,)
            See `Point`.
        """
        question = self.with_gains(np.exp(z[:4]))
        return question.pose(z[4:6], math.exp(z[6]), question.terms(), fill=1 - ROOM)

    @cached_property
    def times(self) -> Times:
        """What is at points."""
        return Times(
            self.whole,
            self.pose,
            lambda z: self.held_to.beyond(np.exp(z[:, :4])),
            LITTLE,
            tried=self.tried,
        )

    def value(self, z: Array, likely: Likely = ()) -> Value | None:
        """Return the logarithm of the time at a point, and what is beyond a limit there.

        Parameters
        ----------
        z : (7,)
            See `Point`.
        likely : tuple of int
            See `program.solve`.
        """
        return self.times.value(z, likely)

    @property
    def highest(self) -> Array:
        """Upper bounds of the parameters, (7,)."""
        most = np.full(7, np.inf)
        most[4] = math.log(max(self.ends[1], 1e-9)) - 1e-9
        return most

    @property
    def ends(self) -> tuple[float, float]:
        """The least d that may hold the start, and the largest that is searched."""
        return self.whole.least, self.whole.known

    def best_for(self, four: Array, near: Array, evaluations: int = OWN) -> Point:
        """Return the best point for gains that are given.

        Parameters
        ----------
        four : (4,)
            k1 to k4.
        near : (k, 3)
            From which d, share and rate to set out, as in `Point`.
        evaluations : int
            The largest number of programs, beside those.
        """
        fixed = np.log(four)
        whole = [np.array([*fixed, *rest]) for rest in near]
        tried = [(z, at) for z in whole if (at := self.value(z)) is not None]
        if not tried:
            return Point(FAILED, whole[0])

        def value(rest: Array) -> Value | None:
            return self.value(np.array([*fixed, *rest]), tried[0][1].found.solution.tight)

        def slopes(rest: Array, at: Value) -> Array:
            return self.times.slopes(np.array([*fixed, *rest]), at, first=4)

        z, at = min(tried, key=lambda pair: pair[1].merit)
        rest, at = Descent(value, slopes, self.highest[4:]).run(z[4:], at, evaluations)
        return self.point(np.array([*fixed, *rest]), at)

    @property
    def own(self) -> Array:
        """The mission's own gains, k1 to k4."""
        names = self.whole.vehicles.law.design.chain_gains()
        return np.array([getattr(self.mission.gains, name) for name in names], float)

    @property
    def keeps_limits(self) -> bool:
        """Whether the mission's own gains keep what gains alone may not exceed."""
        return bool((self.held_to.beyond(self.own[None]) <= 0).all())

    def from_own(self) -> tuple[Array, Value] | None:
        """Return the best point that has the mission's own gains, and what is there, if any."""
        places = self.places(self.own)
        point = self.best_for(self.own, np.array(places)) if places else None
        at = None if point is None else self.value(point.z)
        return None if point is None or at is None else (point.z, at)

    def places(self, four: Array) -> list[Array]:
        """Return from which d, share and rate to set out where nothing is known, (3,) each.

        Parameters
        ----------
        four : (4,)
            k1 to k4.
        """
        low, high = self.ends
        if not low < high:
            return []
        rate = math.log(self.with_gains(four).slow(low))
        return [
            np.array([math.log(low * (high / low) ** part), share, rate])
            for part, share in itertools.product((0.6, 0.85), (-1.7, -3.0))
        ]

    def point(self, z: Array, at: Value | None) -> Point:
        """Return a point with its cost.

        Parameters
        ----------
        z : (7,)
            See `Point`.
        at : Value or None
            What is there.
        """
        if at is None:
            return Point(FAILED, z)
        beyond = float(np.maximum(at.over, 0).sum())
        return Point(at.cost if _is_held(at) else OUTSIDE + beyond, z)

    def run(self, tell: Progress) -> Point | None:
        """Return the best point; None if all programs fail where it sets out.

        Parameters
        ----------
        tell : callable
            Is told what is being done.
        """
        best = None
        for z, at in self.beginnings(tell):
            if best is None or best.cost >= OUTSIDE:
                tell("searching for gains")
                point = self.descend(z, at)
                best = point if best is None or point.cost < best.cost else best
                tell(f"searching for gains: {self.words(best)}")
        return best

    def beginnings(self, tell: Progress) -> list[tuple[Array, Value]]:
        """Return the best of the guesses, and what is there.

        Parameters
        ----------
        tell : callable
            Is told what is being done.
        """
        tell("looking for first gains")
        likely, tried = Likely(), []
        for z in guesses(self.whole, self.limits, self.ends):
            at = self.value(z, likely)
            if at is not None:
                tried.append((z, at))
                likely = at.found.solution.tight
        return sorted(tried, key=lambda pair: pair[1].merit)[:BEGINNINGS]

    def descend(self, z: Array, at: Value, evaluations: int = EVALUATIONS) -> Point:
        """Return the best point that a descent finds.

        Parameters
        ----------
        z : (7,)
            Where it sets out.
        at : Value
            What is there.
        evaluations : int
            The largest number of programs.
        """
        return self.point(*self.times.descend(z, at, self.highest, evaluations))

    def held(self, near: Array | None) -> Array | None:
        """Return a point with which the start is held, the first that is found; None if none is.

        Parameters
        ----------
        near : (7,) or None
            Where to set out; by default as `run` does.
        """
        if near is None:
            begin = self.beginnings(lambda text: None)
        else:
            begin = [] if (at := self.value(near)) is None else [(near, at)]
        for z, at in begin:
            z, at = self.times.descend(z, at, self.highest, FEW, _is_held)
            if _is_held(at):
                return z
        return None

    def words(self, point: Point) -> str:
        """Say what a point means.

        Parameters
        ----------
        point : Point
        """
        if point.cost < OUTSIDE:
            return f"settled after {math.exp(point.cost):.3g} s, not yet proved"
        at = self.value(point.z)
        return "nothing is found" if at is None else f"not held, {self.short(at)}"

    def short(self, at: Value) -> str:
        """Say by how much the start is not held.

        Parameters
        ----------
        at : Value
        """
        names = ("rate", *self.held_to.names())
        told = []
        for name, over in zip(names, at.over, strict=True):
            if over < KEEPS:
                continue
            if name == "rate":
                rate = at.found.asked.rate
                told.append(f"Ψ falls at a rate {100 * over:.3g} % below the {rate:.3g} 1/s wished")
            elif name == VIEW:
                told.append(f"points are seen up to {over:.3g} rad beyond the half angle")
            else:
                told.append(f"{name} is {100 * over:.3g} % beyond its limit")
        return ", and ".join(told)


def _is_held(at: Value) -> bool:
    return bool((at.over < KEEPS).all())
