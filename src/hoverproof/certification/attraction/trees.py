"""How positions, the plane of the barrier and the starts are halved, for a certificate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.inequality import Loop
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.sinking import Sinking
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.cells import (
    ROOM,
    Told,
    View,
    grow_tree,
    largest_below,
    most_cells,
)
from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Set:
    """The set of states that is to be shown not to be left, {Λ <= ℓ} above a barrier.

    Attributes
    ----------
    potential : Potential
    loop : Loop
    weights : (3,) or more
        a2, a3, a4, m, and what else a tolerant loop weighs.
    level : float
        ℓ, m.
    largest : float
        λ₊, 1/m.
    force : float
        Bound of |F|, N.
    bottom : float or None
        z of the barrier, m.
    """

    potential: Potential
    loop: Loop
    weights: Array
    level: float
    largest: float
    force: float
    bottom: float | None

    def positions(self) -> str | None:
        """Halve all positions near the target until Q ≺ λ₊ I, or W > ℓ, over each cell."""
        p = self.potential
        box = _widened(p.points, p.whole / self.largest)
        if self.bottom is not None:
            box[2, 1] = max(min(box[2, 1], self.bottom), box[2, 0])
        high = self.level * (1 + ROOM) + 1e-11 * np.abs(box).max()

        def hold(cells: Array) -> Told:
            view = View.of(p.target, cells)
            slope = np.abs(view.centroid - [0, 0, p.q3])
            least = p.value(view.center) - (slope * view.half).sum(axis=1)
            return np.asarray(largest_below(view, self.largest) | (least > high))

        return grow_tree(box, hold, most_cells(len(p.points), 3))

    def barrier(self, sinking: Sinking) -> str | None:
        """Halve the plane where the barrier acts until qz < q3* - ω over each cell.

        Parameters
        ----------
        sinking : Sinking
            Of all starts.
        """
        if self.bottom is None:
            return None
        p = self.potential
        sine, cosine, _ = self.loop.tilt(self.force)
        gamma, (_, a3, a4) = self.loop.turn_gain(self.force), self.weights[:3]
        spread = np.sqrt(2 * self.level * ((1 + gamma) ** 2 / a4 + gamma**2 / a3))
        omega = self.loop.q3 * (1 - cosine) + sine * spread
        limit = (p.q3 - omega) * (1 - ROOM)
        z = self.bottom - sinking.lag(p.whole - p.q3 + omega)
        heights = np.maximum(p.points[:, 2] - z, 0) * (1 + ROOM)
        if limit <= 0:
            return None

        def hold(cells: Array) -> Told:
            gaps = np.maximum(cells[:, None, :, 0] - p.points[None, :, :2], 0)
            gaps = np.maximum(gaps, p.points[None, :, :2] - cells[:, None, :, 1])
            distance = np.sqrt((gaps**2).sum(axis=2) + heights**2)
            parts = np.divide(heights, distance, out=np.zeros_like(distance), where=distance > 0)
            return np.asarray((p.target.weights * parts).sum(axis=1) < limit)

        box = _widened(p.points[:, :2], float((p.target.weights * heights).sum()) / limit)
        return grow_tree(box, hold, most_cells(len(p.points), 1))

    def start(self, mission: Mission, start: Start, radius: float | None = None) -> str | None:
        """Halve a set of states until Λ <= ℓ over each cell.

        Parameters
        ----------
        mission : Mission
        start : Start
        radius : float or None
            Bound of the horizontal distance from the middle of its box, m.
        """
        p, before = self.potential, self.loop.path_before(start)
        whole = np.add(np.array(start.position, float), [-before, before])
        middle, weights = whole[:2].mean(axis=1), np.array([1, *self.weights])
        limit = self.level * (1 - ROOM) - 1e-11 * np.abs(whole).max()

        def hold(cells: Array) -> Told:
            inside = start_terms(mission, p, self.loop, start, cells, self.force) @ weights <= limit
            if radius is not None:
                gaps = np.maximum(cells[:, :2, 0] - middle, middle - cells[:, :2, 1])
                far = np.linalg.norm(np.maximum(gaps, 0), axis=1) > radius * (1 + ROOM) + 1e-9
                inside |= far
            return np.asarray(inside)

        return grow_tree(whole, hold, most_cells(len(p.points), 4))


def _widened(points: Array, room: float) -> Array:
    """Return the box around points (n, d) with room on all sides, (d, 2)."""
    return np.stack([points.min(axis=0) - room, points.max(axis=0) + room], axis=1)


def start_terms(
    mission: Mission, potential: Potential, loop: Loop, start: Start, cells: Array, force: float
) -> Array:
    """Return (k, 4): Λ <= terms · (1, a2, a3, a4) in cells, of states that move as in a start.

    A tolerant loop has further terms; see `tolerant.TolerantLoop`.

    See `checker.Attraction.added` and `below_level` there. Infinite where a cell may hold a target
    point.

    Parameters
    ----------
    mission : Mission
    potential : Potential
    loop : Loop
    start : Start
    cells : (k, 3, 2)
        Low and high ends, world frame, m.
    force : float
        Bound of |F| in the set, N.
    """
    view = View.of(potential.target, cells)
    ends = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1]), axis=-1).reshape(-1, 3)
    corners = cells[:, np.arange(3)[None], ends]
    value = potential.value(corners.reshape(-1, 3)).reshape(-1, 8).max(axis=1)
    change = (view.weights * view.radius[:, None] / view.apart).sum(axis=1)
    d1 = view.centroid - [0, 0, potential.q3]
    level, whole = (np.linalg.norm(d1[:, :k], axis=1) + change for k in (2, 3))
    rest = loop.at_start(mission, start, whole, level, force)
    terms = np.column_stack([value, rest])
    terms[(view.distance <= view.radius[:, None]).any(axis=1)] = np.inf
    return terms
