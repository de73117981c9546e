"""Where the feature is near the one wanted: how wedges of positions are halved to show it.

A wedge is a box of x, y, u, where (x, y, 1)/u is where the mean of the target lies from the camera:
x and y are sideways over the height, and u is one over the height, 1/m. The domain is a wedge at
whose faces |σ - σ*| > d. A target that is its own mirror image needs half of it, one that is the
same along x and y half of that.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification import scaled
from hoverproof.certification.cells import ROOM, Told, grow_tree, most_cells
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.flow import OfJ
from hoverproof.certification.region import Box
from hoverproof.mission.target import Target

Array = NDArray[np.float64]
SPARE, SPARE_BESIDE = 1.08, 1.15
"""By what factor faces are beyond the domain, as sampled; and where the camera is not at the centre
of mass: a cell that holds all within its arm holds more than that."""
COST, COST_BESIDE = 15, 40
"""Of a cell of which J is bounded, and the same with a camera beside the centre of mass."""
HALVED = 2
"""So often is halved along each axis what lies within the arm of a cell."""


def mirrored(target: Target, axis: int) -> bool:
    """Tell whether a target is its own mirror image across the plane through its mean.

    Parameters
    ----------
    target : Target
        Of a mission.
    axis : int
        Across which axis, a bare number.
    """
    places, twice = target.places, 2 * target.mean[axis]
    images = {(*p[:axis], twice - p[axis], *p[axis + 1 :]): w for p, w in places.items()}
    return images == places


def swapped(target: Target) -> bool:
    """Tell whether a target is its own image if x and y, from its mean, change places.

    Parameters
    ----------
    target : Target
        Of a mission.
    """
    places, (x, y, _) = target.places, target.mean
    return {(x + p[1] - y, y + p[0] - x, p[2]): w for p, w in places.items()} == places


@dataclass(frozen=True)
class Domain:
    """A wedge, a distance of the feature and bounds of J.

    Attributes
    ----------
    scene : Scene
    wedge : (3, 2)
        Ends of x, y and u.
    swapped : bool
        Whether the part with y > x is left out.
    offset : float
        d, dimensionless.
    bounds : (low, high)
        j - ϱ and j + ϱ, 1/m.
    """

    scene: Scene
    wedge: Box
    swapped: bool
    offset: float
    bounds: tuple[float, float]

    @classmethod
    def of(
        cls,
        scene: Scene,
        target: Target,
        offset: float,
        bounds: tuple[float, float],
    ) -> Domain:
        """Lay a wedge around the domain, as it is sampled.

        Parameters
        ----------
        scene : Scene
        target : Target
            The exact one, of the mission.
        offset : float
            d, dimensionless.
        bounds : (low, high)
            j - ϱ and j + ϱ, 1/m.
        """
        ends = _widened(scene.reach(offset)[None], scene.arm)[0]
        spare = SPARE_BESIDE if scene.arm else SPARE
        low = [decimal_below(spare * x if x < 0 else x / spare, 3) for x in ends[:, 0]]
        high = [decimal_above(x * spare, 3) for x in ends[:, 1]]
        both = swapped(target)
        for axis in (0, 1):
            if mirrored(target, axis):
                low[axis], high[axis] = Fraction(0), max(high[axis], -low[axis])
        both &= low[0] == low[1]
        if both:
            high[:2] = [max(high[:2])] * 2
        return cls(scene, tuple(zip(low, high, strict=True)), both, offset, bounds)

    def _left_out(self, cells: Array) -> Told:
        if not self.swapped:
            return np.zeros(len(cells), bool)
        return np.asarray(cells[:, 1, 0] >= cells[:, 0, 1])

    def _sight(self, cells: Array) -> scaled.Sight:
        return scaled.Sight.over_wedges(self.scene.target, cells)

    def _beyond(self, sight: scaled.Sight, count: int, offset: float) -> Told:
        """Tell where |σ - σ*| > offset is shown, along the direction in the middle."""
        seen = sight.scaled() if isinstance(self.scene.flow, OfJ) else sight.centroid()
        mid = np.array([np.broadcast_to(x.mid, count) for x in seen])
        mid[2] -= self.scene.wanted
        slope = np.array([np.broadcast_to(x.slope, (3, count)) for x in seen])
        rest = np.array([np.broadcast_to(x.rest, count) for x in seen])
        size = np.sqrt((mid**2).sum(axis=0))
        along = mid / size
        least = size - np.abs((along[:, None] * slope).sum(axis=0)).sum(axis=0)
        least -= (np.abs(along) * rest).sum(axis=0)
        return np.asarray(least > offset * (1 + ROOM))

    def _beyond_around(self, cells: Array, sight: scaled.Sight) -> Told:
        """Tell around which cells |σ - σ*| > d is shown, as far as the arm of the camera."""
        told = self._beyond(sight, len(cells), self.offset)
        if self.scene.arm and told.any():
            told[told] = self._all_beyond(_widened(cells[told], self.scene.arm), HALVED)
        return told

    def _all_beyond(self, cells: Array, halved: int) -> Told:
        """Tell where it is shown over cells, or over their eight parts, halved so often."""
        told = self._beyond(self._sight(cells), len(cells), self.offset)
        rest = ~told
        if halved and rest.any():
            middle = cells[rest].mean(axis=2)
            ends = np.stack([cells[rest, :, 0], middle, cells[rest, :, 1]], axis=2)
            which = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1]), axis=-1).reshape(-1, 3)
            sides = [ends[:, k][:, which[:, k, None] + [0, 1]] for k in range(3)]
            parts = np.stack(sides, axis=2).reshape(-1, 3, 2)
            told[rest] = self._all_beyond(parts, halved - 1).reshape(-1, 8).all(axis=1)
        return told

    def _held(self, cells: Array, sight: scaled.Sight) -> Told:
        if isinstance(self.scene.flow, OfJ):
            return scaled.in_ball(sight.slope(), len(cells), *self.bounds)
        return self.scene.flow.hold(self.scene.target, self._boxes(cells), *self.bounds)

    def _corners(self, cells: Array) -> Array:
        """Return the positions of the corners of wedges, (k, 8, 3), m."""
        ends = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1]), axis=-1).reshape(-1, 3)
        x, y, u = (cells[:, k, ends[:, k]] for k in range(3))
        rays = np.stack([x, y, np.ones_like(x)], axis=-1) / u[..., None]
        return np.asarray(self.scene.target.mean - rays)

    def _boxes(self, cells: Array) -> Array:
        corners = self._corners(cells)
        return np.stack([corners.min(axis=1), corners.max(axis=1)], axis=-1)

    @cached_property
    def _sides(self) -> Array:
        return np.array(self.wedge, float)

    @cached_property
    def _scale(self) -> tuple[float, ...]:
        """What sides count for when the longest is halved."""
        return 1.0, 1.0, 0.4 / float(self.wedge[2][0] * self.wedge[2][1]) ** 0.5

    def tree(self, cosine: float | None = None, part: float = 1.0) -> str | None:
        """Halve the wedge until each cell is beyond the domain, or J is in its bounds over it.

        Parameters
        ----------
        cosine : float or None
            Dimensionless, of the angle to the vertical in which all target points are to be.
        part : float
            Of the cells that are checked, the part that it may take, dimensionless.
        """
        whole = self._sides

        def hold(cells: Array) -> Told:
            with np.errstate(all="ignore"):
                sight = self._sight(cells)
                told = self._left_out(cells) | self._beyond_around(cells, sight)
                inner = self._held(cells, sight)
            for k in range(3):
                inner &= cells[:, k, 1] < whole[k, 1]
                inner &= (cells[:, k, 0] > whole[k, 0]) | (k < 2 and whole[k, 0] == 0)
            if cosine is not None:
                inner &= self._steep(cells) >= cosine * (1 + ROOM)
            told |= inner
            return told

        return grow_tree(whole, hold, int(part * self.most_cells), self._scale)

    @property
    def most_cells(self) -> int:
        """Into how many cells its box may be halved."""
        cost = COST_BESIDE if self.scene.arm else COST
        return most_cells(len(self.scene.points), cost)

    def _steep(self, cells: Array) -> Array:
        """Return the least cosine of the angle to the vertical of all points at the corners."""
        rays = self.scene.points[None, None] - self._corners(cells)[:, :, None]
        return np.asarray((rays[..., 2] / np.linalg.norm(rays, axis=3)).min(axis=(1, 2)))

    def near(self, radius: float, bounds: tuple[float, float]) -> str | None:
        """Halve the box within a radius of the goal until J is in bounds over each cell.

        Parameters
        ----------
        radius : float
            m.
        bounds : (low, high)
            1/m.
        """
        box = self.scene.goal[:, None] + radius * np.array([-1.0, 1.0])
        target = self.scene.target

        def hold(cells: Array) -> Told:
            with np.errstate(all="ignore"):
                return np.asarray(self.scene.flow.hold(target, cells, *bounds))

        return grow_tree(box, hold, most_cells(len(self.scene.points), COST))


def _widened(cells: Array, arm: float) -> Array:
    """Return cells that hold all positions within an arm, m, from cells, (k, 3, 2)."""
    if not arm:
        return cells
    moved = arm * cells[:, 2, 1]
    moved[moved >= 1] = np.nan  # then nothing is shown
    wide = cells.copy()
    low, high = (cells[:, :2, k] + (2 * k - 1) * moved[:, None] for k in (0, 1))
    near, far = 1 - moved[:, None], 1 + moved[:, None]
    wide[:, :2, 0] = low / np.where(low < 0, near, far)
    wide[:, :2, 1] = high / np.where(high > 0, near, far)
    wide[:, 2, 0] /= 1 + arm * cells[:, 2, 0]
    wide[:, 2, 1] /= 1 - moved
    return wide
