"""The search for gains with which a start is soon settled, in floating point.

Gains, the largest offset of the feature on the way, the share of the largest force and the rate are
searched together, one semidefinite program each. Gains over mass are rates, 1/s; where the search
sets out, these stand in fixed proportions, and the fastest of them suits latency and lag of the
rotors, the force that the way there takes, and the bandwidth that is allowed. So it sets out alike
for small vehicles and large ones.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.candidate import Candidate
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.proof import ROOMS
from hoverproof.certification.exponential.search import FAILED, OUTSIDE, ROOM, Search
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.descent import Ends, descend
from hoverproof.design.limits import FirstCommand, Limits
from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]
Likely = tuple[int, ...]
Progress = Callable[[str], None]
RATES = 0.02, 0.14, 0.26, 1.0
"""j k1/m, k1 k2/m, k3/m and k4/m where the search sets out, over the last of them."""
WAITS = 1.3
"""The last of them times latency and lag of the rotors is at most that there."""
FORCE = 0.04
"""And the force that d asks for at most that share of the weight."""
OF_BANDWIDTH = 0.9
SCALES = 1.0, 0.6, 0.36, 0.2, 0.1
PARTS, SHARES = (0.9, 0.5), (-1.5, -2.5)
FIRST_RATE = 0.3
STEPS = 0.15, 0.15, 0.15, 0.15, -0.04, 0.3, 0.2
ROUNDS, EVALUATIONS, ENOUGH = 3, 130, 0.02
STEEP = 20.0
"""What the logarithm of Ψ at the start over the level weighs more than that of the time."""
LOSS = 0.01
"""Part of the time by which rounding may make it longer."""


class Point(NamedTuple):
    """A point of the search, and its cost.

    Attributes
    ----------
    cost : float
        See `Search.cost`, a bare number.
    z : (7,)
        The logarithms of k1 to k4 and of d, the odds' of the share of the force, and that of r.
    """

    cost: float
    z: Array

    @property
    def set_out(self) -> tuple[Array, float]:
        """Where the proof sets out: see `converge`."""
        return self.z[4:6], math.exp(self.z[6])


@dataclass(frozen=True)
class StartSearch:
    """What is searched.

    Attributes
    ----------
    mission : Mission
        Its gains do not count.
    limits : Limits
    command : FirstCommand
    whole : Search
        With the gains of the mission.
    """

    mission: Mission
    limits: Limits
    command: FirstCommand
    whole: Search

    @classmethod
    def of(cls, mission: Mission, limits: Limits) -> StartSearch:
        """Prepare a search.

        Parameters
        ----------
        mission : Mission
        limits : Limits
        """
        whole = Search.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),))
        wider, highest = ROOMS[0]
        whole = replace(whole, wider=wider, highest=highest)
        return cls(mission, limits, FirstCommand.of(mission), whole)

    def with_gains(self, four: Array) -> Search:
        """Return the search of weights for gains.

        Parameters
        ----------
        four : (4,)
            k1 to k4, in the units of the design.
        """
        v = self.whole.vehicles
        numbers, design = v.numbers.copy(), v.law.design
        for name, value in zip(design.chain_gains(), four, strict=True):
            numbers[design.place(name)] = value
        return replace(self.whole, vehicles=replace(v, numbers=numbers))

    def beyond(self, four: Array) -> float:
        """Return by which share gains are beyond the limits, 0 if they keep them all.

        Parameters
        ----------
        four : (4,)
            k1 to k4.
        """
        k1, k2, k3, k4 = four
        excess = [float(k1 * k2 + k3 + k4) / float(self.mission.vehicle.mass) / self.limits.fastest]
        if self.limits.tilt is not None or self.limits.rotors is not None:
            thrusts, tilt = self.command(tuple(np.array([k]) for k in four))
            if self.limits.tilt is not None:
                excess.append(float(tilt[0]) / self.limits.tilt)
            if self.limits.rotors is not None:
                least, most = self.limits.rotors
                hover = float(self.mission.vehicle.weight) / 4
                excess.append(float(thrusts.max()) / most)
                excess.append(1 + (least - float(thrusts.min())) / hover)
        return float(max(max(excess) - 1, 0.0))

    def at(self, z: Array, likely: Likely = ()) -> tuple[float, Candidate | None]:
        """Return the cost of a point and what it is of.

        Parameters
        ----------
        z : (7,)
            See `Point`.
        likely : tuple of int
            See `program.solve`.
        """
        four = np.exp(z[:4])
        over = self.beyond(four)
        if over > 0:
            return FAILED * (1 + over), None
        search = self.with_gains(four)
        d = min(z[4], math.log(search.highest * search.scene.wanted) - 1e-9)
        found = search.at(np.array([d, z[5]]), math.exp(z[6]), search.terms(), likely)
        return search.cost(found, search.settled_offset), found

    def guesses(self) -> Iterator[Array]:
        """Yield points to set out from: that of the mission's own gains, then the fastest first."""
        low, high = self.whole.ends
        if not low < high:
            return
        if self.own is not None:
            names = self.whole.vehicles.law.design.chain_gains()
            four = np.array([getattr(self.mission.gains, name) for name in names], float)
            yield np.array([*np.log(four), *self.own.x, math.log(self.own.rate)])
        v = self.whole.vehicles
        mass, gravity = float(v.design.mass), float(v.design.gravity)
        wait = v.latency + v.rotor_lag
        for scale, part in itertools.product(SCALES, PARTS):
            d = low * (high / low) ** part
            j = sum(self.whole.balls.within(d)) / 2
            slow, pull = RATES[0], RATES[1]
            quick = math.sqrt(FORCE * gravity * j / (d * slow * pull))
            quick = min(quick, OF_BANDWIDTH * self.limits.fastest / sum(RATES[1:]))
            if wait:
                quick = min(quick, WAITS / wait)
            rates = scale * quick * np.array(RATES)
            k1 = mass * rates[0] / j
            gains = [k1, mass * rates[1] / k1, mass * rates[2], mass * rates[3]]
            for share in SHARES:
                last = math.log(d), share, math.log(FIRST_RATE * rates[0])
                yield np.array([*np.log(gains), *last])

    @cached_property
    def own(self) -> Candidate | None:
        """What is found for the mission's own gains; None if they do not hold the start."""
        terms = self.whole.terms()
        first = self.whole.deepest(terms)
        if first is None or first.solution.fill > 1:
            return None
        return self.whole.soonest(first, terms, self.whole.settled_offset)

    @property
    def settled_before(self) -> float | None:
        """When the mission's own gains settle, s, as it is found."""
        return None if self.own is None else self.own.time(self.whole.settled_offset)

    def run(self, tell: Progress) -> Point | None:
        """Return the best point; None if all programs fail where it sets out.

        Parameters
        ----------
        tell : callable
            Is told what is being done.
        """
        tell("searching for weights for the mission's own gains")
        self.own  # noqa: B018
        tell("looking for gains to set out from")
        best, likely = Point(FAILED, np.zeros(7)), Likely()
        for z in self.guesses():
            cost, found = self.at(z, likely)
            best = min(best, Point(cost, z), key=lambda p: p.cost)
            likely = likely if found is None else found.solution.tight
        if best.cost >= FAILED:
            return None
        for k in range(ROUNDS):
            tell(f"searching for gains: {self.words(best.cost)}")
            new = self._descend(best, np.array(STEPS) * (-1) ** k)
            gained, best = best.cost - new.cost, new
            if k and gained < ENOUGH:
                break
        return best

    def words(self, cost: float) -> str:
        """Say what a cost means.

        Parameters
        ----------
        cost : float
            A bare number, dimensionless.
        """
        if cost >= OUTSIDE:
            return f"Ψ at the start {math.exp(cost - OUTSIDE):.3g} times the level"
        return f"settled after {math.exp(cost):.3g} s (floating point)"

    def _descend(self, best: Point, steps: Array) -> Point:
        """Descend along where the starts are just inside, and return the best point on the way."""
        likely, offset = Likely(), self.whole.settled_offset

        def cost(z: Array) -> float:
            nonlocal likely, best
            value, found = self.at(z, likely)
            best = min(best, Point(value, z), key=lambda p: p.cost)
            if found is None:
                return value
            likely = found.solution.tight
            over = max(math.log(found.solution.fill / (1 - ROOM)), 0.0)
            return math.log(found.time(offset)) + STEEP * over

        corners = np.vstack([best.z, best.z + np.diag(steps)])
        descend(cost, corners, Ends(EVALUATIONS, values=1e-3, places=1e-3))
        return best

    def short(self, point: Point) -> Iterator[tuple[tuple[Fraction, ...], Point]]:
        """Yield gains of few digits that are hardly slower, and their point, then longer ones.

        Parameters
        ----------
        point : Point
            Where the starts are inside.
        """
        exact = np.exp(point.z[:4])
        for digits in range(2, 7):
            around = [(decimal_below(k, digits), decimal_above(k, digits)) for k in exact]
            for four in itertools.product(*around):
                z = np.array([*np.log(np.array(four, float)), *point.z[4:]])
                near = Point(self.at(z)[0], z)
                if near.cost < point.cost + LOSS:
                    yield four, near
                    break
