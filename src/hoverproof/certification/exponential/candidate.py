"""A set that was found for starts, in floating point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.program import Program, Solution
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles

Array = NDArray[np.float64]
LOUDEST = 0.5
"""Share of Ψ where a vehicle has settled that noise may leave."""
VIEW_ROOM = 0.012
"""Of the angle under which points are seen: a share that is spared for the proof, and rad."""


@dataclass(frozen=True)
class Tilted:
    """What a fixed goal in the image adds to |σ - σ*|: at most √(2 Ψ A) + b.

    Attributes
    ----------
    factor, shift : float
        A is 1 + factor (1/w2 + 1/w3), and shift is b, dimensionless; 0 for an inertial goal.
    """

    factor: float
    shift: float

    @classmethod
    def of(cls, limits: Limits) -> Tilted:
        """Bound it by the tilt.

        Parameters
        ----------
        limits : Limits
        """
        v = limits.vehicles
        lean = v.in_image / np.sqrt((1 + np.sqrt(1 - limits.tilt**2)) / 2)
        by_force = (lean * v.stiffness / v.weight) ** 2
        return cls(by_force, float(lean * v.wind / v.design.gravity))

    def stretch(self, weights: Sequence[Any] | Array) -> float:
        """Return A.

        Parameters
        ----------
        weights : (3,)
            w2, w3, w4.
        """
        w2, w3, _ = map(float, weights)
        return 1 + self.factor * (1 / w2 + 1 / w3)

    def offset(self, weights: Sequence[Any] | Array, level: float | Array) -> Array:
        """Return what |σ - σ*| is at most where Ψ is at most a level.

        Parameters
        ----------
        weights : (3,)
            w2, w3, w4.
        level : float or array
            Dimensionless.
        """
        return np.asarray(np.sqrt(2 * level * self.stretch(weights)) + self.shift)


@dataclass(frozen=True)
class Candidate:
    """A set that is to be rounded and proved.

    Attributes
    ----------
    x : (2,)
        Where it was found: the logarithm of d, and of the odds of the share of the largest force.
    offset : float
        d, dimensionless: |σ - σ*| is at most that on the set.
    ball : (low, high)
        j - ϱ and j + ϱ, 1/m.
    rate : float
        r, 1/s.
    tilted : Tilted
    solution : Solution
    """

    x: Array
    offset: float
    ball: tuple[float, float]
    rate: float
    tilted: Tilted
    solution: Solution

    def time(self, offset: float) -> float:
        """Return when |σ - σ*| is at most an offset for good, s.

        Parameters
        ----------
        offset : float
            A bare number, dimensionless.
        """
        factor = 1 + self.tilted.factor * (self.solution.reach.force**2 / (2 * self.solution.level))
        if offset <= self.tilted.shift:
            return float("inf")
        level = (offset - self.tilted.shift) ** 2 / (2 * factor) - self.solution.floor
        return float(np.log(max(self.solution.start / level, 1.0)) / self.rate)

    def seen(self, scene: Scene, vehicles: Vehicles) -> float:
        """Return the angle to the axis under which all is seen from the starts on, rad.

        Parameters
        ----------
        scene : Scene
        vehicles : Vehicles
        """
        offset, tilt = self.farthest(vehicles.before(self.ball))
        return angle_seen(scene.cone(offset), tilt) if np.isfinite(offset) else np.pi

    def farthest(self, vehicles: Vehicles) -> tuple[float, float]:
        """Return the largest |σ - σ*| and sine of the tilt from the starts on.

        Parameters
        ----------
        vehicles : Vehicles
            With what the camera sees wrong, see `Vehicles.before`.
        """
        s = self.solution
        limits = Limits(vehicles, Reach.of(s.weights, s.start), self.ball[1])
        if not limits.tilt < 1:  # then there is no bound
            return float("inf"), 1.0
        return float(Tilted.of(limits).offset(s.weights, s.start)), float(limits.tilt)


def angle_seen(cone: float, tilt: float) -> float:
    """Return the angle to the axis under which all is seen, with room for the proof, rad.

    Parameters
    ----------
    cone : float
        The largest angle of a target point to the vertical, rad.
    tilt : float
        Sine of the largest tilt, dimensionless.
    """
    return float((1 + VIEW_ROOM) * cone + np.arcsin(tilt) + VIEW_ROOM)


@dataclass(frozen=True)
class Asked:
    """A set of which the weights are to be found.

    Attributes
    ----------
    x : (2,)
        See `Candidate`.
    offset : float
        d, dimensionless.
    rate : float
        r, 1/s.
    tilted : Tilted
    limits : Limits
        Of a reach that the weights are to keep to.
    program : Program
    """

    x: Array
    offset: float
    limits: Limits
    rate: float
    tilted: Tilted
    program: Program

    def answer(self, likely: Sequence[int] = ()) -> Candidate | None:
        """Find them.

        Parameters
        ----------
        likely : sequence of int
            See `Program.solve`, bare numbers.
        """
        found = self.program.solve(likely)
        return None if found is None else self.with_weights(found)

    def with_weights(self, found: Solution) -> Candidate:
        """Return the candidate with weights.

        Parameters
        ----------
        found : Solution
        """
        ball = self.program.ball
        return Candidate(self.x, self.offset, ball, self.rate, self.tilted, found)

    def time(self, offset: float, fill: float) -> float:
        """Return when |σ - σ*| is at most an offset for good, s, if there are weights.

        Parameters
        ----------
        offset : float
            A bare number, dimensionless.
        fill : float
            Ψ at the start over ℓ, dimensionless.
        """
        level, force = self.program.level, self.limits.reach.force
        factor = 1 + self.tilted.factor * force**2 / (2 * level)
        last = max(offset - self.tilted.shift, 0.0) ** 2 / (2 * factor)
        last *= 1 - LOUDEST if self.limits.vehicles.is_shaken else 1.0
        return float(np.log(max(fill * level / last, 1.0)) / self.rate) if last else np.inf
