"""The natural potential and what bounds positions, in floating point: hints for a proof."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.cells import View, lengths
from hoverproof.certification.flow import eigenvalues
from hoverproof.certification.pattern import Pattern
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal

Array = NDArray[np.float64]
UP = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True)
class Potential:
    """W(ξ) = Σ wᵢ|P'ᵢ - ξ| + q3* z less its minimum, for an axial goal.

    Attributes
    ----------
    target : Pattern
    goal : (3,)
        Hover point ξ*, world frame, m.
    q3 : float
        q3* of q* = (0, 0, q3*).
    """

    target: Pattern
    goal: Array
    q3: float

    @classmethod
    def of(cls, mission: Mission) -> Potential:
        """Take the potential of a mission.

        Parameters
        ----------
        mission : Mission

        Raises
        ------
        InputError
            If the goal is not straight below: q1* = q2* = 0; or if the feature is scaled.
        """
        if mission.law.feature != "centroid":
            raise InputError(
                mission.source,
                "law.feature",
                f"is {mission.law.feature}, but the natural potential is that of the centroid",
            )
        goal = hover_goal(mission)
        if any(end != 0 for ends in goal.centroid[:2] for end in ends):
            raise off_the_vertical(mission)
        if len({(x, y) for x, y, _ in mission.target.points}) == 1:
            raise InputError(mission.source, "target.points", "all lie on one vertical line")
        position = np.array([float(c) for c in goal.position])
        return cls(Pattern.of(mission), position, float(goal.centroid_midpoint[2]))

    @property
    def points(self) -> Array:
        """Target points, (n, 3), world frame, m."""
        return self.target.points

    @property
    def whole(self) -> float:
        """W, the sum of their weights."""
        return self.target.whole

    @property
    def plane(self) -> float:
        """Mean z of the target, m."""
        return float(self.target.mean[2])

    def height(self, z: float) -> float:
        """Return the height above the mean of the target, m.

        Parameters
        ----------
        z : float
            World frame, m.
        """
        return self.plane - z

    def value(self, positions: Array) -> Array:
        """Return W, (k,), at positions (k, 3).

        Parameters
        ----------
        positions : (k, 3)
            World frame, m.
        """

        def raw(x: Array) -> Array:
            far = self.target.weights * lengths(self.points[None] - x[:, None])
            return np.asarray(far.sum(axis=1) + self.q3 * x[:, 2])

        return np.asarray(raw(positions) - raw(self.goal[None]))

    def centroid(self, positions: Array) -> Array:
        """Return q of a level camera, (k, 3), at positions (k, 3).

        Parameters
        ----------
        positions : (k, 3)
            World frame, m.
        """
        return View.at(self.target, positions).centroid

    def hover_terms(self, positions: Array) -> Array:
        """Return (k, 4): Λ = terms · (1, a2, a3, a4) for a level hover at positions (k, 3).

        Parameters
        ----------
        positions : (k, 3)
            World frame, m.
        """
        d1 = self.centroid(positions) - [0, 0, self.q3]
        whole, flat = (d1**2).sum(axis=1) / 2, (d1[:, :2] ** 2).sum(axis=1) / 2
        return np.stack([self.value(positions), whole, whole, flat], axis=1)

    def largest_eigenvalue(self, bottom: float) -> float:
        """Return the largest eigenvalue of Q, 1/m, found at and above z = bottom.

        Parameters
        ----------
        bottom : float
            z, m.
        """
        best = 0.0
        span = self._span()
        for rise in (0.0, 0.1):
            places = self._plane_grid(bottom - rise * span)
            far = lengths(self.points[None] - places[:, None])
            above = (self.target.weights / far).sum(axis=1)
            first = eigenvalues(self.target, places[[above.argmax()]])[0, 2]
            best = max(best, float(first))
            places = places[above > best]  # no eigenvalue is above Σ 1/rᵢ
            if len(places):
                best = max(best, float(eigenvalues(self.target, places)[:, 2].max()))
        return best

    def largest_height_part(self, z: float) -> float:
        """Return the largest qz = Σ wᵢ hᵢ/rᵢ found on the plane at z.

        Parameters
        ----------
        z : float
            World frame, m.
        """
        return float(self.centroid(self._plane_grid(z))[:, 2].max())

    def level_limit(self, largest: float) -> float:
        """Return the lowest W found where an eigenvalue of Q reaches `largest`.

        Infinite if that is nowhere, 0 if it does so at the goal.

        Parameters
        ----------
        largest : float
            1/m.
        """
        if largest <= self.largest_at_goal:
            return 0.0
        size, value = self._rays
        inner, outer = size[:, :-1], size[:, 1:]
        crosses = (inner >= largest) != (outer >= largest)
        if not crosses.any():
            return np.inf
        part = (inner[crosses] - largest) / (inner[crosses] - outer[crosses])
        low, high = value[:, :-1][crosses], value[:, 1:][crosses]
        return float((low + part * (high - low)).min())

    @cached_property
    def largest_at_goal(self) -> float:
        """The largest eigenvalue of Q at the goal, 1/m."""
        return float(eigenvalues(self.target, self.goal[None])[0, 2])

    @cached_property
    def _rays(self) -> tuple[Array, Array]:
        """Largest eigenvalue of Q, 1/m, and W, (rays, radii) each, from the target and the goal.

        Rays from the target points reach as far as the eigenvalue of the goal does (none is above W
        over the distance to the nearest point); those from the goal, along which W grows, reach
        beyond all of these.
        """
        far = self.whole / self.largest_at_goal
        beyond = far + float(np.linalg.norm(self.points - self.goal, axis=1).max())
        reaches = [(point, 200, far * np.geomspace(1e-3, 1.0, 120)) for point in self.points]
        nearer = beyond * np.concatenate([[0.0], np.geomspace(1e-3, 1.0, 119)])
        sizes, values = [], []
        for start, rays, radii in [*reaches, (self.goal, 600, nearer)]:
            places = (start + sphere(rays)[:, None] * radii[None, :, None]).reshape(-1, 3)
            sizes.append(eigenvalues(self.target, places)[:, 2].reshape(rays, -1))
            values.append(self.value(places).reshape(rays, -1))
        return np.concatenate(sizes), np.concatenate(values)

    def _span(self) -> float:
        return float(np.ptp(self.points[:, :2], axis=0).max())

    def _plane_grid(self, z: float, cells: int = 81) -> Array:
        low, high = self.points[:, :2].min(axis=0), self.points[:, :2].max(axis=0)
        room = 0.5 * (high - low).max()
        x, y = (np.linspace(a, b, cells) for a, b in zip(low - room, high + room, strict=True))
        grid = np.stack(np.meshgrid(x, y, [z]), axis=-1).reshape(-1, 3)
        over = np.column_stack([self.points[:, :2], np.full(len(self.points), z)])
        return np.vstack([grid, over])


def off_the_vertical(mission: Mission) -> InputError:
    """Say why nothing is shown of a goal that is not straight below.

    Parameters
    ----------
    mission : Mission
    """
    return InputError(
        mission.source,
        "goal.centroid",
        "is not straight below: hovers that see it lie all around the target, one for each "
        "heading, and convergence is shown to one place alone; certify is about such a goal too, "
        "as long as it does not turn; or give goal.height, or centroid = [0, 0, q3]",
    )


def undominated(rows: Array) -> Array:
    """Return the rows than which none other is larger or equal throughout: (j, m) of (k, m).

    With weights that are not negative, the largest of all weighted sums is one of theirs.

    Parameters
    ----------
    rows : (k, m)
        Of any units, those of a column alike.
    """
    rows = np.unique(rows, axis=0)
    above = (rows[:, None] <= rows).all(axis=2).sum(axis=1)
    return np.asarray(rows[above == 1])  # itself


def sphere(k: int) -> Array:
    """Return k directions spread over the sphere, (k, 3).

    Parameters
    ----------
    k : int
        Number of directions.
    """
    i = np.arange(k) + 0.5
    polar, around = np.arccos(1 - 2 * i / k), np.pi * (1 + 5**0.5) * i
    flat = np.sin(polar)
    return np.stack([flat * np.cos(around), flat * np.sin(around), np.cos(polar)], axis=1)
