"""Weights, level and multipliers of Λ for every vehicle within tolerance, and for other laws.

As in `inequality`, everything is convex in μ = 1/ℓ and in all that is weighed, over ℓ, for given
bounds of the force, of |δ3| and of the eigenvalues of Q.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.inequality import (
    LEAST_RATE,
    Bounds,
    Loop,
    Solution,
    barrier_pencil,
)
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.exponential.program import MEMORY, SLOPE, SPARE, Sector, falls
from hoverproof.certification.exponential.vehicles import Limits, Reach, Vehicles
from hoverproof.certification.robust import Inequality, optimise, reciprocals
from hoverproof.mission.sections import Mission
from hoverproof.servo.lyapunov import ERROR_SIZE

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TolerantLoop(Loop):
    """The vehicles within tolerance under a law of the centroid.

    Attributes
    ----------
    design, weight, stiffness, q3
        See `Loop`; q3 is 0 for an inertial goal.
    vehicles : Vehicles
    farthest : float
        Bound of |δ1|, dimensionless.
    """

    vehicles: Vehicles
    farthest: float

    @classmethod
    def of_mission(cls, mission: Mission) -> TolerantLoop:
        """Take vehicles and law of a mission.

        Parameters
        ----------
        mission : Mission
        """
        v = Vehicles.of(mission)
        farthest = len(mission.target.points) + v.goal
        return cls(v.numbers, v.weight, v.stiffness, v.in_image, v, farthest)

    @property
    def gust(self) -> float:
        """The largest force of the wind, N."""
        return float(self.vehicles.design.mass) * self.vehicles.wind

    @property
    def largest_force(self) -> float:
        """The bound of |F|, N, at which the thrust, less the wind, could reach the singularity."""
        return super().largest_force - self.gust

    def tilt(self, force: float) -> tuple[float, float, float]:
        """Return sin φ, cos φ and tan(φ/2) for |F| <= force.

        Parameters
        ----------
        force : float
            Bound of |F|, N.
        """
        return super().tilt(force + self.gust)

    def limits(self, force: float, largest: float, d3: float) -> Limits:
        """Return what follows from the bounds of the errors.

        Parameters
        ----------
        force : float
            Bound of |F|, N.
        largest : float
            Bound of the eigenvalues of Q, 1/m.
        d3 : float
            Bound of |δ3| as a share of that of |δ3 - δ2|.
        """
        apart = force / self.stiffness
        reach = Reach(apart, d3 * apart, 2 * apart, self.farthest + apart)
        return Limits(self.vehicles, reach, largest)

    def solve(self, bounds: Bounds, hovers: Array) -> Solution | None:
        """Find weights and a level; see `Loop.solve`.

        Parameters
        ----------
        bounds : Bounds
        hovers : (k, ..)
        """
        found = [self._solve(bounds, hovers, share) for share in D3_SHARES]
        return min((x for x in found if x is not None), key=lambda x: x.fill, default=None)

    def _solve(self, bounds: Bounds, hovers: Array, d3: float) -> Solution | None:
        limits = self.limits(bounds.force, bounds.largest, d3)
        if not np.isfinite(limits.lever).all() or limits.tilt >= 1:
            return None
        there, corners = falls(limits, Sector(bounds.largest), 0.0, potential=True).of_used()
        unit = limits.reach.force**-2
        size = len(there) + 2  # of 1, μ, what is weighed, and the largest Λ/ℓ
        asked = np.zeros((2, *corners[0].S.shape[1:]))
        asked[0] = SPARE * np.eye(asked.shape[1]) / max(1.0, bounds.largest)
        asked[1, :ERROR_SIZE, :ERROR_SIZE] = (
            LEAST_RATE / float(limits.vehicles.design.slowness) * np.eye(ERROR_SIZE)
        )
        corners = [_later(c).less(asked) for c in corners]
        pencils = [
            reciprocals(0.5, {2: 1, 3: 1}, size),
            reciprocals(d3**2 / 2, {3: 1}, size),
        ]
        if limits.vehicles.wind:
            pencils.append(reciprocals(2.0, {3: 1, 4: 1}, size))
        if bounds.omega is not None:
            pencil = barrier_pencil(self, bounds, unit, size)
            if pencil is None:
                return None
            pencils.append(pencil)
        least = np.eye(size)[1] - np.eye(size)[0] / (bounds.most_level * unit)
        weighed = [k + 1 for k, name in enumerate(there) if name != SLOPE]
        inside = np.zeros((len(hovers), size))
        inside[:, weighed] = -hovers
        inside[:, -1] = 1
        rows = np.vstack([least, inside, np.eye(size)[1:]])
        found = optimise([0] * (size - 2) + [1], corners, rows=rows, pencils=pencils, shared=True)
        if found is None or not (found.x > 0).all():
            return None
        x = found.x[:-1] / found.x[0]
        level = float(1 / (found.x[0] * unit))
        return Solution(x[[k - 1 for k in weighed[1:]]], level, float(found.x[-1] * unit))


def _later(corner: Inequality) -> Inequality:
    """Put a place of what 1 multiplies before what all else multiplies."""

    def led(x: Array) -> Array:
        return np.concatenate([np.zeros_like(x[:1]), x])

    return Inequality(led(corner.S), tuple(t._replace(u=led(t.u)) for t in corner.terms))
