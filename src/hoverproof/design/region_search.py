"""The search for gains with a large region of attraction, in floating point.

For given k1 k2 and k3, k1 is the smallest that settles fast enough, and k4 the highest that the
limits allow. What is left is searched together with the bounds of force and of Q, one semidefinite
program each.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification.attraction.inequality import Loop
from hoverproof.certification.attraction.potential import Potential, sphere, undominated
from hoverproof.certification.attraction.search import SLACKS, Search, reach_along
from hoverproof.descent import Ends, descend
from hoverproof.design.limits import (
    FirstCommand,
    Limits,
    designed_gains,
    highest_k4,
)
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.mission.task import Gains
from hoverproof.servo.linearised import slowest_rates
from hoverproof.servo.variables import Design

Array = NDArray[np.float64]
ROUNDS = 4
STEPS = Ends(evaluations=70, values=1e-4, places=1e-4)
ENOUGH = 0.01
"""A ball that grows by less than this part ends the search."""
CLOSE = 1e-9
"""m: a ball so small is none."""
LOSS = 0.005
"""Part of the level that rounding may cost."""
SHARES = (0.01, 0.03, 0.1, 0.3)
"""Parts of the bandwidth that k1 k2 and k3 take where the search sets out."""
GUESSES = tuple(itertools.product((0.03, 0.2), (1.3, 2.0, 4.0)))
"""Parts of the largest force, and λ₊ in units of its value at the goal, likewise."""
NONE = 1e6


class Point(NamedTuple):
    """A point of the search: (log k1 k2, log k3, logit of the force's part, log λ₊), and its cost.

    Attributes
    ----------
    cost : float
        Log of the largest Λ/ℓ of the wanted hovers, dimensionless; `NONE` where there is no region.
    z : (4,)
        Logarithms of kg/s, kg/s and 1/m; the third is dimensionless.
    """

    cost: float
    z: tuple[float, ...]


@dataclass(frozen=True)
class GainRegionSearch:
    """What is searched.

    Attributes
    ----------
    mission : Mission
        Its gains do not count.
    limits : Limits
    command : FirstCommand
    potential : Potential
    floor : float
        Least decay rate of the slowest motion at the goal, 1/s.
    """

    mission: Mission
    limits: Limits
    command: FirstCommand
    potential: Potential
    floor: float

    @classmethod
    def of(cls, mission: Mission, limits: Limits, floor: float) -> GainRegionSearch:
        """Prepare a search.

        Parameters
        ----------
        mission : Mission
        limits : Limits
        floor : float
            Least decay rate of the slowest motion at the goal, 1/s.

        Raises
        ------
        InputError
            If the law is not the paper's.
        """
        if not mission.law.is_papers:
            raise InputError(
                mission.source,
                "law",
                f"{mission.law.name} is not the paper's law: gains are searched by their region "
                "of attraction for that law alone",
            )
        return cls(mission, limits, FirstCommand.of(mission), Potential.of(mission), floor)

    @property
    def most(self) -> float:
        """The largest k1 k2 + k3 + k4 that the bandwidth allows, kg/s."""
        return self.limits.fastest * float(self.mission.vehicle.mass)

    def gains(self, stiff: float, k3: float) -> tuple[float, ...] | None:
        """Return k1…k4 with the smallest k1 that settles fast enough; None if there is none.

        Parameters
        ----------
        stiff : float
            k1 k2, kg/s.
        k3 : float
            kg/s.
        """
        middle = float(self.mission.vehicle.mass) * self.floor / self.potential.largest_at_goal
        k1 = np.geomspace(middle / 10, 1e3 * middle, 49)
        for _ in range(3):
            four = self._with_highest_k4(k1, stiff, k3)
            fast = self._rates(four) >= self.floor
            if not fast.any():
                return None
            first = int(fast.argmax())
            k1 = np.geomspace(k1[max(first - 1, 0)], k1[first], 17)
        return tuple(float(k[first]) for k in four)

    def _with_highest_k4(self, k1: Array, stiff: float, k3: float) -> tuple[Array, ...]:
        three = (k1, stiff / k1, np.full(len(k1), k3))
        low, high = highest_k4(self.limits, self.command, three)
        return (*three, np.where((high > 0) & (low < high), high, np.nan))

    def _rates(self, gains: tuple[Array, ...]) -> Array:
        rates = np.full(len(gains[0]), -np.inf)
        good = np.isfinite(gains[3])
        if good.any():
            rates[good] = slowest_rates(self.mission, tuple(k[good] for k in gains))
        return rates

    def fastest(self) -> float:
        """Return the fastest rate of the slowest motion within the limits, 1/s, with a region or
        without one, of a lattice of gains.
        """
        least = float(self.mission.vehicle.mass) * 1e-3 / self.potential.largest_at_goal
        k1 = np.geomspace(least, 1e6 * least, 60)
        shares = itertools.product((*SHARES, 0.6), repeat=2)
        fours = [self._with_highest_k4(k1, a * self.most, b * self.most) for a, b in shares]
        return max(float(self._rates(four).max()) for four in fours)

    def cost(self, gains: Sequence[float], x: Sequence[float] | Array, hovers: Array) -> float:
        """Return the log of the largest Λ/ℓ of hovers, `NONE` where the inequality fails.

        Parameters
        ----------
        gains : (4,)
            Those of the error chain, in the order and units of the law's design.
        x : (2,)
            See `Search.bounds`.
        hovers : (k, 4)
            See `Potential.hover_terms`.
        """
        found = self._inner(gains).solve(x, hovers)
        return NONE if found is None or found[1].fill <= 0 else math.log(found[1].fill)

    def _inner(self, gains: Sequence[float]) -> Search:
        update = dict(zip(Design.chain_gains(), map(Fraction, gains), strict=True))
        mission = self.mission.model_copy(
            update={"gains": self.mission.gains.model_copy(update=update)}
        )
        loop = Loop.of(mission, self.potential.q3)
        return Search(self.potential, loop, SLACKS[0], None)

    def run(self) -> Point | None:
        """Return the best point; None where no region is found."""
        size = self.potential.height(float(self.potential.goal[2])) / 2
        best = self.first(size)
        for _ in range(ROUNDS if best.cost < NONE else 0):
            best = self._descend(best, self._ball(size))
            radius = self._radius(best, size)
            if abs(radius / size - 1) < ENOUGH:
                break
            size = radius
        return best if best.cost < NONE else None

    def first(self, size: float, enough: float = -np.inf) -> Point:
        """Return the best point of a lattice.

        Parameters
        ----------
        size : float
            Radius of the ball of hovers to be inside, m.
        enough : float
            The first point whose cost is below is taken; dimensionless.
        """
        hovers, here = self._ball(size), math.log(self.potential.largest_at_goal)
        best = Point(NONE, ())
        for stiff, k3 in itertools.product(SHARES, repeat=2):
            gains = self.gains(stiff * self.most, k3 * self.most)
            if gains is None:
                continue
            start = (math.log(stiff * self.most), math.log(k3 * self.most))
            for share, times in GUESSES:
                x = (-math.log(1 / share - 1), here + math.log(times))
                best = min(best, Point(self.cost(gains, x, hovers), (*start, *x)))
                if best.cost < enough:
                    return best
        return best

    def _ball(self, size: float) -> Array:
        return undominated(self.potential.hover_terms(self.potential.goal + size * sphere(200)))

    def _at(self, z: Sequence[float] | Array, hovers: Array) -> float:
        gains = self.gains(math.exp(z[0]), math.exp(z[1]))
        return NONE if gains is None else self.cost(gains, z[2:], hovers)

    def _descend(self, start: Point, hovers: Array) -> Point:
        corners = np.array(start.z) + 0.3 * np.eye(5, 4, -1)
        value, lowest = descend(lambda z: self._at(z, hovers), corners, STEPS)
        return Point(value, tuple(lowest))

    def _radius(self, point: Point, size: float) -> float:
        """Return the radius of the ball about the goal that a point's level holds, m."""
        gains = self.gains(math.exp(point.z[0]), math.exp(point.z[1]))
        assert gains is not None
        inner = self._inner(gains)
        while (found := inner.solve(point.z[2:], self._ball(size))) is None:
            size /= 2  # so far away the inequality fails, whatever the level is
            if size < CLOSE:
                raise ArithmeticError("no ball of hovers is held")
        s = found[1]
        reached = reach_along(self.potential, sphere(60), s.weights, s.level)
        return min(float(reached.min()), 3 * size)

    def short(self, point: Point) -> Iterator[Gains]:
        """Yield the shortest decimals that keep the limits and all but `LOSS` of the level.

        Parameters
        ----------
        point : Point
        """
        exact = self.gains(math.exp(point.z[0]), math.exp(point.z[1]))
        assert exact is not None
        hovers = self._ball(self._radius(point, 1e3))
        aim = self.cost(exact, point.z[2:], hovers) + LOSS
        for digits in range(3, 7):
            around = [
                sorted({decimal_below(k, digits), decimal_above(k, digits)}) for k in exact[:3]
            ]
            tried = []
            for three in itertools.product(*around):
                columns = tuple(np.array([float(k)]) for k in three)
                low, high = highest_k4(self.limits, self.command, columns)  # type: ignore[arg-type]
                if not max(low[0], 0) < high[0]:
                    continue
                k4 = decimal_below(float(high[0]), digits + 1)
                four = (*columns, np.array([float(k4)]))
                if float(k4) > low[0] and self._rates(four)[0] >= self.floor:
                    plain = [float(k) for k in (*three, k4)]
                    tried.append((self.cost(plain, point.z[2:], hovers), (*three, k4)))
            if tried and min(tried)[0] <= aim:
                yield designed_gains(self.mission, min(tried)[1], self.limits.fastest)
