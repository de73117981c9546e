"""Where the feature is near the one wanted, and how far J is there from j I, as sampled."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification import scaled
from hoverproof.certification.attraction.potential import sphere
from hoverproof.certification.cells import View, norms
from hoverproof.certification.flow import Flow, OfJ, flow_of
from hoverproof.certification.pattern import Pattern
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.loop import level_feature

Array = NDArray[np.float64]
DIRECTIONS, STEPS = 160, 40
MIDDLES, FINE = 20, 12
"""So many j are looked at, and so many times as many where that matters."""
EVEN = 40
"""So many d: between them balls change evenly, so that a search is not led astray."""
ALONG = 5
"""So many positions are looked at along each side of a box about the goal."""
AROUND = 14
"""So many directions are looked at from a position to where the camera may be."""
ARMS = 1.5
"""So many arms of it far: cells at the rim of the domain hold more than an arm around."""
FARTHEST = 1e3
"""In heights of the goal."""


@dataclass(frozen=True)
class Scene:
    """A target, a feature of it, and the goal.

    Attributes
    ----------
    target : Pattern
    law : Law
    flow : Flow
        What is bounded: Q of the centroid, J of the scaled one.
    goal : (3,)
        Hover point ξ*, world frame, m.
    wanted : float
        s3* of σ* = (0, 0, s3*).
    arm : float
        How far the camera is from the centre of mass, m.
    boxes : dict
        What `around` has found, 1/m, by the radius, m.
    """

    target: Pattern
    law: Law
    flow: Flow
    goal: Array
    wanted: float
    arm: float = 0.0
    boxes: dict[float, tuple[float, float]] = field(default_factory=dict, compare=False)

    @classmethod
    def of(cls, mission: Mission) -> Scene:
        """Take target and goal of a mission.

        Parameters
        ----------
        mission : Mission
        """
        goal = np.array([float(c) for c in hover_goal(mission).position])
        law, target = law_of(mission), Pattern.of(mission)
        wanted = float(law.goal_feature(mission)[2])
        return cls(target, law, flow_of(mission), goal, wanted, mission.camera.arm)

    @property
    def points(self) -> Array:
        """Target points, (n, 3), world frame, m; those that coincide are one."""
        return self.target.points

    def feature(self, positions: Array) -> Array:
        """Return σ, what a level camera sees in world axes, (k, 3).

        Parameters
        ----------
        positions : (k, 3)
            World frame, m.
        """
        look = level_feature(len(self.points), _counting(self.law, self.target))
        found: Array = np.array(look(self.points.T, positions.T), float).T
        return found

    def offset(self, positions: Array) -> Array:
        """Return σ - σ*, (k, 3).

        Parameters
        ----------
        positions : (k, 3)
            World frame, m.
        """
        return self.feature(positions) - [0, 0, self.wanted]

    def reach(self, offset: float) -> Array:
        """Return the ends of x, y and u where |σ - σ*| <= offset, sampled along rays, (3, 2).

        Parameters
        ----------
        offset : float
            A bare number, dimensionless.
        """
        places = self.goal + self.ends(offset)[:, None] * np.linspace(0, 1, 40)[None, :, None]
        ray = self.target.mean - places.reshape(-1, 3)
        seen = np.column_stack([ray[:, :2] / ray[:, 2:], 1 / ray[:, 2]])
        return np.stack([seen.min(axis=0), seen.max(axis=0)], axis=1)

    def ends(self, offset: float) -> Array:
        """Return where rays from the goal leave {|σ - σ*| <= offset}, from there, (k, 3), m.

        Parameters
        ----------
        offset : float
            A bare number, dimensionless.
        """
        directions, radii, far = self._rays
        last, row = np.argmax(far >= offset, axis=1), np.arange(len(far))
        before = np.maximum(last - 1, 0)
        low, high = far[row, before], far[row, last]
        known = np.isfinite(high) & (high > low)
        part = np.divide(offset - low, high - low, out=np.ones(len(far)), where=known)
        ends = radii[before] + part.clip(0, 1) * (radii[last] - radii[before])
        return np.asarray(directions * ends[:, None])

    @cached_property
    def _rays(self) -> tuple[Array, Array, Array]:
        """Directions, distances from the goal, m, and |σ - σ*| there, (k, 3), (n,) and (k, n)."""
        height = float(self.target.mean[2] - self.goal[2])
        radii = height * np.geomspace(0.01, FARTHEST, 400)
        directions = sphere(DIRECTIONS)
        places = self.goal + directions[:, None] * radii[None, :, None]
        with np.errstate(all="ignore"):
            far = np.linalg.norm(self.offset(places.reshape(-1, 3)), axis=1)
        return directions, radii, np.nan_to_num(far, nan=np.inf).reshape(len(directions), -1)

    def outward(self) -> tuple[Array, Array]:
        """Return |σ - σ*|, ascending, and positions, (k,) and (k, 3), where it is below s3*."""
        parts = np.linspace(0, 1, STEPS) ** 0.7
        places = self.goal + self.ends(0.97 * self.wanted)[:, None] * parts[None, :, None]
        places = places.reshape(-1, 3)
        far = np.linalg.norm(self.offset(places), axis=1)
        order = np.argsort(far)
        return far[order], places[order]

    def angles(self, positions: Array) -> Array:
        """Return the largest angle to the vertical under which the camera sees a point, (k,), rad.

        Parameters
        ----------
        positions : (k, 3)
            World frame, m.
        """
        rays = self.points[None] - positions[:, None]
        far = np.linalg.norm(rays, axis=2)
        more = np.arcsin(np.minimum(self.arm / far, 1)) if self.arm else 0.0
        return np.asarray((np.arccos(rays[..., 2] / far) + more).max(axis=1))

    def cone(self, offset: float) -> float:
        """Return the largest of these angles where |σ - σ*| <= offset, as sampled, rad.

        Parameters
        ----------
        offset : float
            A bare number, dimensionless.
        """
        return float(self.angles(self.goal + self.ends(offset)).max())

    def slopes(self, positions: Array) -> Array:
        """Return J, or Q, (k, 3, 3), 1/m.

        Parameters
        ----------
        positions : (k, 3)
            World frame, m.
        """
        if isinstance(self.flow, OfJ):
            return scaled.slopes_at(self.target, positions)
        return View.at(self.target, positions).depths

    def around(self, radius: float) -> tuple[float, float]:
        """Return the ends of a ball that holds J all over a box about the goal, as sampled, 1/m.

        It is the one whose lower end is highest.

        Parameters
        ----------
        radius : float
            Half the side of the box, m.
        """
        if radius not in self.boxes:
            self.boxes[radius] = self._around(radius)
        return self.boxes[radius]

    def _around(self, radius: float) -> tuple[float, float]:
        side = self.goal + radius * np.linspace(-1, 1, ALONG)[:, None]
        J = self.slopes(np.stack(np.meshgrid(*side.T), axis=-1).reshape(-1, 3))
        middles = np.linspace(0.7, 3, FINE * MIDDLES) * norms(J).max()
        radii = _away(J[None], middles)[-1]
        best = int((middles - radii).argmax())
        return float(middles[best] - radii[best]), float(middles[best] + radii[best])


@dataclass(frozen=True)
class Balls:
    """The narrowest balls about multiples of I that hold J wherever |σ - σ*| <= d, as sampled.

    Attributes
    ----------
    offsets : (k,)
        d, ascending.
    low, high : (k,)
        j - ϱ and j + ϱ, 1/m.
    """

    offsets: Array
    low: Array
    high: Array

    @classmethod
    def of(cls, scene: Scene) -> Balls:
        """Sample along rays from the goal, outward as long as |σ - σ*| is below s3*.

        Parameters
        ----------
        scene : Scene
        """
        offsets, places = scene.outward()
        beside = np.vstack([np.zeros(3), ARMS * scene.arm * sphere(AROUND if scene.arm else 0)])
        J = np.array([scene.slopes(places + step) for step in beside])
        size = float(np.median(norms(J[0])))
        farthest = _away(J, np.linspace(0.2, 1.2, MIDDLES) * size)
        rises = (np.diff(farthest, axis=0, prepend=-1) > 0).any(axis=1)
        middles = np.linspace(0.2, 1.2, FINE * MIDDLES) * size
        farthest, offsets = _away(J[:, rises], middles), offsets[rises]
        best = (farthest / middles).argmin(axis=1)
        j, radius = middles[best], farthest[np.arange(len(best)), best]
        even = np.linspace(offsets[0], offsets[-1], EVEN)
        low, high = (np.interp(even, offsets, end) for end in (j - radius, j + radius))
        return cls(even, low, high)

    def within(self, d: float) -> tuple[float, float]:
        """Return j - ϱ and j + ϱ where |σ - σ*| <= d, 1/m.

        Parameters
        ----------
        d : float
            A bare number, dimensionless.
        """
        ends = (np.interp(d, self.offsets, side) for side in (self.low, self.high))
        low, high = map(float, ends)
        return low, high


def _counting(law: Law, target: Pattern) -> Law:
    """Return the law with the weights of a target whose coinciding points are one."""
    if (target.weights == 1).all():
        return (
            replace(law, feature=replace(law.feature, weights=())) if law.feature.weights else law
        )
    return replace(law, feature=replace(law.feature, weights=tuple(map(float, target.weights))))


def _away(J: Array, middles: Array) -> Array:
    """Return the largest |J - j I| up to each place, of all J there, for each j, (k, m)."""
    each = (norms(j[:, None] - middles[:, None, None] * np.eye(3)) for j in J)
    return np.asarray(np.maximum.accumulate(np.max(list(each), axis=0), axis=0))
