"""Find weights, level and bounds that fit each other, in floating point."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.inequality import Bounds, Loop, Solution
from hoverproof.certification.attraction.potential import Potential, sphere, undominated
from hoverproof.certification.attraction.sinking import Sinking
from hoverproof.descent import Ends, descend

Array = NDArray[np.float64]
Objective = Literal["start", "radius", "volume"]
ENOUGH = Ends(evaluations=60, values=1e-4, places=0.01)
LARGEST_RADIUS = 1e4
"""m; nobody flies farther from a target that a camera is to see."""


@dataclass(frozen=True)
class Slack:
    """By what share bounds are kept from where they fail, so that a proof has room.

    Attributes
    ----------
    level, eigenvalue, omega, reach : float
        Shares of the level, of λ₊, of what tilt may add to the height, and of how far hovers
        reach; dimensionless.
    """

    level: float
    eigenvalue: float
    omega: float
    reach: float


SLACKS = (
    Slack(0.03, 0.03, 0.03, 0.005),
    Slack(0.08, 0.06, 0.06, 0.02),
    Slack(0.2, 0.1, 0.1, 0.05),
)


@dataclass(frozen=True)
class Found(Solution):
    """A consistent set of numbers, to be rounded and proved.

    Attributes
    ----------
    weights : (3,)
        a2, a3, a4, m.
    level : float
        ℓ, m.
    fill : float
        Largest Λ/ℓ of the hovers, dimensionless.
    largest : float
        λ₊, 1/m.
    bottom : float or None
        z of the barrier, m.
    binding : str
        What keeps the level from being higher.
    """

    largest: float
    bottom: float | None
    binding: str


@dataclass(frozen=True)
class Search:
    """The parameters of the search: the force, and λ₊ or the height where the barrier acts.

    Attributes
    ----------
    potential : Potential
    loop : Loop
    slack : Slack
    sinking : Sinking or None
        Of the starts, for a barrier, which must not be above where they sink to; None without one.
    known : dict
        What is known of barriers, by the log of their heights, a bare number: with many a force
        each is asked for.
    """

    potential: Potential
    loop: Loop
    slack: Slack
    sinking: Sinking | None
    known: dict[float, Bounds | None] = field(default_factory=dict, repr=False, compare=False)

    def bounds(self, x: Sequence[float] | Array) -> Bounds | None:
        """Return the bounds of a point of the search, (2,); None if they contradict each other.

        Parameters
        ----------
        x : (2,)
            Logit of the part of the largest force; log of λ₊, 1/m, or of the barrier's height, m.
        """
        force = self.loop.largest_force / (1 + np.exp(-x[0]))
        if self.sinking is None:
            largest = float(np.exp(x[1]))
            limit = self.potential.level_limit(largest)
            if limit == 0:
                return None
            return Bounds(force, largest, limit * (1 - self.slack.level))
        if x[1] not in self.known:
            self.known[x[1]] = self._at_barrier(self.sinking, float(np.exp(x[1])))
        at = self.known[x[1]]
        return None if at is None else replace(at, force=force)

    def _at_barrier(self, sinking: Sinking, height: float) -> Bounds | None:
        """Return the bounds with a barrier that acts at a height, m, whatever the force."""
        p = self.potential
        z = p.plane - height
        omega = (p.q3 - p.largest_height_part(z)) * (1 - self.slack.omega)
        if omega <= 0 or omega >= p.q3:
            return None
        bottom = z + sinking.lag(p.whole - p.q3 + omega) * (1 + self.slack.omega / 10)
        if not sinking.deepest <= bottom <= p.points[:, 2].min() - 1e-3:
            return None
        largest = p.largest_eigenvalue(bottom) * (1 + self.slack.eigenvalue)
        return Bounds(np.inf, largest, bottom=bottom, omega=omega)

    def solve(self, x: Sequence[float] | Array, hovers: Array) -> tuple[Bounds, Solution] | None:
        """Return the best weights at a point of the search.

        Parameters
        ----------
        x : (2,)
            Logit of the part of the largest force; log of λ₊, 1/m, or of the barrier's height, m.
        hovers : (k, 4)
            `Potential.hover_terms` of hovers that are to be inside.
        """
        bounds = self.bounds(x)
        found = None if bounds is None else self.loop.solve(bounds, hovers)
        return None if bounds is None or found is None else (bounds, found)

    def first_guess(self) -> list[tuple[float, float]]:
        """Return points from which to search."""
        p = self.potential
        if self.sinking is not None:
            above = p.height(float(p.goal[2]))
            second = [np.log(above * share) for share in (0.85, 0.6, 0.3, 0.15)]
        else:
            here = p.largest_eigenvalue(float(p.goal[2]))
            second = [np.log(here * times) for times in (1.1, 1.3, 2.0, 4.0, 8.0)]
        return [(-np.log(1 / share - 1), y) for y in second for share in (0.003, 0.03, 0.2, 0.6)]

    def best(self, hovers: Array, value: Callable[[Bounds, Solution], float]) -> Found | None:
        """Minimise a value of the solution over the parameters.

        Parameters
        ----------
        hovers : (k, 4)
            `Potential.hover_terms` of hovers that are to be inside.
        value : callable
            Takes bounds and solution; returns what is to be made small.
        """
        found = self.solve(self._point(hovers, value), hovers)
        if found is None:
            return None
        b, s = found
        binding = _binding(self, b, s)
        return Found(s.weights, s.level, s.fill, s.multipliers, b.largest, b.bottom, binding)

    def _point(
        self, hovers: Array, value: Callable[[Bounds, Solution], float]
    ) -> tuple[float, float]:
        """Return where the value is least; without tolerances first, if there are any."""

        hovers = undominated(hovers)

        def cost(x: Sequence[float] | Array) -> float:
            found = self.solve(x, hovers)
            return 1e6 if found is None else value(*found)

        nominal, guesses, evaluations = self.loop.nominal(), self.first_guess(), ENOUGH.evaluations
        if nominal is not None:
            x, y = replace(self, loop=nominal)._point(hovers, value)
            near = [(x, y), (x - 0.5, y), (x, y - 0.3), (x - 1, y - 0.6), (x - 2, y - 0.3)]
            if min(map(cost, near)) < 1e6:
                guesses, evaluations = near, evaluations // 2
        start = min((cost(x), x) for x in guesses)[1]
        simplex = [start, (start[0] + 0.5, start[1]), (start[0], start[1] + 0.15)]
        _, lowest = descend(cost, np.array(simplex), replace(ENOUGH, evaluations=evaluations))
        return float(lowest[0]), float(lowest[1])


def find(search: Search, objective: Objective, starts: Array) -> Found | None:
    """Search for what is asked for.

    Parameters
    ----------
    search : Search
    objective : {"start", "radius", "volume"}
        Bring the starts as deep inside as can be; or make the ball of certified hovers about the
        goal, or the volume of all certified hovers, as large as can be.
    starts : (k, 4)
        Terms of the wanted starts; see `Potential.hover_terms`.
    """
    if objective == "start":
        return search.best(starts, lambda b, s: float(np.log(max(s.fill, 1e-300))))
    p = search.potential
    grid = HoverGrid.of(p)

    def cost(b: Bounds, s: Solution) -> float:
        if len(starts) and (starts @ [1, *s.weights]).max() > s.level:
            return 1e3 * s.fill
        if objective == "volume":
            return -float(np.log(grid.volume(s.weights, s.level, b.bottom)))
        return -float(np.log(grid.radius(s.weights, s.level, b.bottom)))

    found, size, bottom = None, 0.1 * p.height(float(p.goal[2])), None
    for _ in range(8):  # aim at the ball, or the set, that was reached, a little larger
        places = p.goal + size * sphere(200)
        rows = p.hover_terms(places if bottom is None else places[places[:, 2] <= bottom])
        wanted = np.vstack([starts, rows if objective == "radius" else rows.mean(axis=0)])
        new = search.best(wanted, cost)
        if new is None:
            break
        reached = grid.radius(new.weights, new.level, new.bottom)
        if found is not None and reached < 1.02 * size / 1.05:
            break
        found, size, bottom = new, min(reached * 1.05, LARGEST_RADIUS), new.bottom
    if found is None or not len(starts):
        return found
    fill = float((starts @ [1, *found.weights]).max() / found.level)
    return replace(found, fill=fill)


@dataclass(frozen=True)
class HoverGrid:
    """Hovers along rays from the goal, to see which of them are inside.

    Attributes
    ----------
    radii : (m,)
        m.
    depth : (k, m)
        z, m.
    terms : (k, m, 4)
        See `Potential.hover_terms`.
    """

    radii: Array
    depth: Array
    terms: Array

    @classmethod
    def of(cls, p: Potential, rays: int = 300, steps: int = 160) -> HoverGrid:
        """Lay rays in all directions.

        Parameters
        ----------
        p : Potential
        rays, steps : int
            Numbers of rays, and of hovers along each.
        """
        radii = np.geomspace(0.02, LARGEST_RADIUS, steps)
        places = p.goal + sphere(rays)[:, None] * radii[None, :, None]
        terms = p.hover_terms(places.reshape(-1, 3)).reshape(rays, steps, -1)
        return cls(radii, places[..., 2], terms)

    def reach(self, weights: Array, level: float, bottom: float | None) -> tuple[Array, Array]:
        """Return how far each ray is inside, m, and whether Λ ends it (or the barrier).

        Parameters
        ----------
        weights : (3,)
            a2, a3, a4, m.
        level : float
            ℓ, m.
        bottom : float or None
            z of the barrier, m.
        """
        value = self.terms @ [1, *weights]
        outside = value > level
        below = np.zeros_like(outside) if bottom is None else self.depth > bottom
        ended = outside | below
        first = np.where(ended.any(axis=1), ended.argmax(axis=1), len(self.radii) - 1)
        rows, last = np.arange(len(first)), np.maximum(first - 1, 0)
        near, far = value[rows, last], value[rows, first]
        by_level = outside[rows, first]
        crosses = by_level & (far > near)
        part = np.divide(level - near, far - near, out=np.zeros(len(rows)), where=crosses)
        reach = self.radii[last] * (self.radii[first] / self.radii[last]) ** part.clip(0, 1)
        return np.asarray(reach), by_level

    def volume(self, weights: Array, level: float, bottom: float | None) -> float:
        """Return the volume of the hovers inside that are seen from the goal, m³.

        Parameters
        ----------
        weights : (3,)
            a2, a3, a4, m.
        level : float
            ℓ, m.
        bottom : float or None
            z of the barrier, m.
        """
        reach, _ = self.reach(weights, level, bottom)
        return float(4 * np.pi / 3 * (reach**3).mean())

    def radius(self, weights: Array, level: float, bottom: float | None) -> float:
        """Return the radius of the largest ball inside, m; what is below a barrier is left out.

        Parameters
        ----------
        weights : (3,)
            a2, a3, a4, m.
        level : float
            ℓ, m.
        bottom : float or None
            z of the barrier, m.
        """
        reach, by_level = self.reach(weights, level, bottom)
        return float(reach[by_level].min()) if by_level.any() else LARGEST_RADIUS


def reach_along(p: Potential, directions: Array, weights: Array, level: float) -> Array:
    """Return how far from the goal, m, hovers in directions have Λ <= ℓ without a gap, (k,).

    Parameters
    ----------
    p : Potential
    directions : (k, 3)
        Unit vectors, world frame.
    weights : (3,)
        a2, a3, a4, m.
    level : float
        ℓ, m.
    """
    a, steps = np.array([1, *weights]), np.geomspace(0.01, LARGEST_RADIUS, 400)
    places = p.goal + steps[:, None] * directions[:, None]
    outside = (p.hover_terms(places.reshape(-1, 3)) @ a > level).reshape(places.shape[:2])
    first = np.where(outside.any(axis=1), outside.argmax(axis=1), len(steps))
    low = np.where(first > 0, steps[first - 1], 0.0)
    crosses = (first > 0) & (first < len(steps))
    near, far = low[crosses], steps[first[crosses]]
    for _ in range(30):
        middle = (near + far) / 2
        good = p.hover_terms(p.goal + middle[:, None] * directions[crosses]) @ a <= level
        near, far = np.where(good, middle, near), np.where(good, far, middle)
    low[crosses] = near
    return low


def _binding(search: Search, b: Bounds, s: Solution) -> str:
    a2, a3 = s.weights[:2]
    force = search.loop.stiffness * np.sqrt(2 * s.level * (1 / a2 + 1 / a3))
    parts = []
    if s.level > 0.99 * b.most_level:
        parts.append("near a target point Q grows beyond every bound")
    if force > 0.99 * b.force:
        parts.append("the force, hence thrust and tilt, must stay small")
    if b.bottom is not None:
        parts.append("the barrier allows only little tilt")
    return ", and ".join(parts) or "the gains"
