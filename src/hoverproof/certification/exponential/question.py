"""The question which set holds starts, and what is asked at a point of it, in floating point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_below
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.candidate import LOUDEST, Asked, Candidate, Tilted
from hoverproof.certification.exponential.inequality import (
    MEMORY,
    PARAMETERS,
    THRUST,
    TORQUE,
    W2,
    W3,
    W4,
)
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.positions import Balls, Scene
from hoverproof.certification.exponential.program import Program
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles

Array = NDArray[np.float64]
HIGHEST = 0.835
"""Share of s3* that d is at most, unless said: |σ| is small near the target."""
SLOWEST = 0.05
"""The rate that is first asked for, as a share of 2 (k1/m)(j - ϱ)."""
SLOWEST_IN_NOISE = 0.5
"""The same with noise, of which more stays at a slow rate."""
ROOM = 0.01
"""Share of the level, and of the ball, that is spared for the proof."""
SETTLED = 0.1, 0.2, 0.4, 0.8
"""Of the largest distance of a start from the goal: there the vehicle has settled. With noise the
first of them that it allows."""
LEAST = 1e-3
"""A vehicle has settled that near to its goal, m; a start is taken to be twice as far, at least."""
PLACES = 60
"""So many offsets are looked at, up to the largest."""
NEAR = 0.04
"""Share of |σ - σ*| there that is spared for the proof."""


@dataclass(frozen=True)
class Question:
    """Which set holds these starts.

    Attributes
    ----------
    vehicles : Vehicles
    scene : Scene
    starts : tuple of Start
    balls : Balls
        Of J by d.
    wider : float
        By which share, a bare number, the narrowest ball of J, as sampled, is widened.
    half_angle : float or None
        Of the cone about the axis that the camera sees, rad, if it is said.
    highest : float
        Share of s3*, dimensionless, that d is at most.
    settled : float
        One of `SETTLED`, dimensionless.
    beyond : float
        By which share, a bare number, d is exceeded before J leaves its ball: where J changes fast
        it takes many cells to show that it does not.
    """

    vehicles: Vehicles
    scene: Scene
    starts: tuple[Start, ...]
    balls: Balls
    wider: float = ROOM
    half_angle: float | None = None
    highest: float = HIGHEST
    settled: float = SETTLED[0]
    beyond: float = 0.0

    @classmethod
    def of(cls, vehicles: Vehicles, scene: Scene, starts: tuple[Start, ...]) -> Question:
        """Pose it: sample J.

        Parameters
        ----------
        vehicles : Vehicles
        scene : Scene
        starts : tuple of Start
        """
        return cls(vehicles, scene, starts, Balls.of(scene))

    @cached_property
    def ends(self) -> tuple[float, float]:
        """The least d that may hold the starts, and the largest that is searched; NaN if none."""
        high = self.highest * self.scene.wanted
        return (self.least, high) if self.least < high else (np.nan, np.nan)

    @cached_property
    def least(self) -> float:
        """The least d that may hold the starts."""
        return max(float(np.sqrt(2 * self.terms()[:, 0].max())), 1e-3)

    @cached_property
    def known(self) -> float:
        """The largest d that is searched for which J has a ball; 0 if none."""
        places = np.linspace(1 / PLACES, 1, PLACES) * self.highest * self.scene.wanted
        return float(max((d for d in places if self.ball(d) is not None), default=0.0))

    @cached_property
    def radius(self) -> Fraction:
        """Where a vehicle has settled: that near to its goal, m."""
        far = max(
            float(np.linalg.norm(_corners(start) - self.scene.goal, axis=1).max())
            for start in self.starts
        )
        return decimal_below(max(self.settled * far, LEAST), 4)

    @cached_property
    def least_offset(self) -> float:
        """How large |σ - σ*| is taken to be at a start, at least."""
        return 2 * LEAST * float(self.scene.around(LEAST)[0])

    @cached_property
    def settled_offset(self) -> float:
        """What |σ - σ*| is surely below only within that radius."""
        return (1 - NEAR) * float(self.radius) * self.scene.around(float(self.radius))[0]

    def terms(self) -> Array:
        """Return what (1, parameters) are multiplied by in Ψ of each start, (k, 11)."""
        return np.array([self._terms(start) for start in self.starts])

    def _terms(self, start: Start) -> Array:
        off = self.scene.offset(np.unique(_corners(start), axis=0))
        away = max(np.linalg.norm(off, axis=1).max(), self.least_offset)
        level = np.linalg.norm(off[:, :2], axis=1).max()
        return np.asarray(self.terms_at(np.array([away]), np.array([level]), start)[0])

    def terms_at(self, away: Array, level: Array, start: Start) -> Array:
        """Return what (1, parameters) are multiplied by in Ψ of states, (k, 11).

        Parameters
        ----------
        away, level : (k,)
            |σ - σ*| where they are, and its horizontal part.
        start : Start
            Bounds of speed, tilt, rate and thrust; its position is not looked at.
        """
        v, lam = self.vehicles, self.balls.within(0.97 * self.scene.wanted)[1]
        d = v.design
        speed, tilt, rate, thrust = map(float, (start.speed, start.tilt, start.rate, start.thrust))
        force = thrust + v.weight * tilt
        lean = force / v.weight + v.wind / float(d.gravity)
        lean *= np.sqrt(2 / (1 + np.sqrt(max(1 - lean**2, 0.01))))
        whole = away + v.in_image * lean
        flat = np.minimum(whole, level + lean * (away + v.in_image))
        moved, pushed = float(d.slowness) * speed, force / v.stiffness
        lever = v.weight + force - v.stiffness * v.in_image
        turned = lever * rate / (v.stiffness * v.pace)
        d2, d3 = whole + moved, whole + moved + pushed
        d4 = flat + moved + pushed + turned
        asked = v.stiff * d4 + v.pull * pushed
        result = np.zeros((len(whole), 1 + PARAMETERS))
        result[:, [0, W2, W3, W4]] = np.stack([whole, d2, d3, d4], axis=1) ** 2 / 2
        result[:, TORQUE] = v.rotor_lag / 2 * asked**2
        result[:, THRUST] = v.rotor_lag / 2 * (v.pace * d3) ** 2
        flow = lam * speed
        if v.swept:
            turned = 2 * v.goal * rate + v.yaw_rate * (level + lean * (away + v.goal))
            flow = flow + turned
        result[:, MEMORY] = v.age**2 / 2 * flow**2
        return result

    def limits(self, x: Array, ball: tuple[float, float]) -> Limits:
        """Return the limits of a reach, of which the last parameter is the share of the largest.

        Parameters
        ----------
        x : (2,)
            See `Candidate`.
        ball : (low, high)
            j - ϱ and j + ϱ, 1/m.
        """
        v = self.vehicles.before(ball)
        low = v.weight - v.stiffness * v.in_image
        force = 0.95 * low / v.stiffness / (1 + np.exp(-x[1]))
        d = float(np.exp(x[0]))
        return Limits(v, Reach(d, force, 0.75 * force, 1.75 * force, 6 * d), ball[1])

    def asked(self, x: Array) -> tuple[tuple[float, float], Limits, float] | None:
        """Return the ball of J, the limits and ℓ that go with a point; None if it is too far out.

        Parameters
        ----------
        x : (2,)
            See `Candidate`.
        """
        d = float(np.exp(x[0]))
        if not d <= self.highest * self.scene.wanted:
            return None
        ball = self.ball(d)
        if ball is None:
            return None
        limits = self.limits(x, ball)
        if not np.isfinite(limits.lever).all() or not limits.tilt < 1:
            return None
        tilted = Tilted.of(limits)
        level = ((d - tilted.shift) ** 2 - tilted.factor * limits.reach.force**2) / 2
        return (ball, limits, float(level)) if d > tilted.shift and level > 0 else None

    def at(
        self,
        x: Array,
        rate: float,
        starts: Array,
        likely: Sequence[int] = (),
        floor: float = np.inf,
    ) -> Candidate | None:
        """Return d, the ball of J and the best weights, for the logarithm of d and the reach.

        Parameters
        ----------
        x : (2,)
            See `Candidate`.
        rate : float
            r, 1/s.
        starts : (k, 11)
            See `terms`.
        likely : sequence of int
            See `Program.solve`, bare numbers.
        floor : float
            What ℓ∞ is at most, dimensionless.
        """
        asked = self.pose(x, rate, starts, floor)
        return None if asked is None else asked.answer(likely)

    def pose(
        self,
        x: Array,
        rate: float,
        starts: Array,
        floor: float = np.inf,
        fill: float | None = None,
    ) -> Asked | None:
        """Return d, the ball of J and the program for the weights; see `at`.

        Parameters
        ----------
        x, rate, starts, floor
            See `at`, bare numbers.
        fill : float, optional
            See `Program.of`, dimensionless.
        """
        asked = self.asked(x)
        if asked is None:
            return None
        ball, limits, level = asked
        d, tilted = float(np.exp(x[0])), Tilted.of(limits)
        factor = 1 + tilted.factor * limits.reach.force**2 / (2 * level)
        most = max(self.settled_offset - tilted.shift, 0) ** 2 / (2 * factor)
        floor = min(floor, LOUDEST * most)
        program = Program.of(limits, ball, rate, level, starts, floor, fill)
        return None if program is None else Asked(x, d, limits, rate, tilted, program)

    def ball(self, d: float) -> tuple[float, float] | None:
        """Return j - ϱ and j + ϱ as they are asked of the proof, 1/m; None if that is no bound.

        Parameters
        ----------
        d : float
            A bare number, dimensionless.
        """
        low, high = self.balls.within(d * (1 + ROOM))
        middle, radius = (low + high) / 2, (high - low) / 2 * (1 + self.wider)
        if self.beyond:
            low, high = self.balls.within(d * (1 + self.beyond))
            radius = max(radius, high - middle, middle - low)
        return (middle - radius, middle + radius) if radius < middle else None

    def slow(self, d: float) -> float:
        """Return a slow rate, 1/s.

        Parameters
        ----------
        d : float
            A bare number, dimensionless.
        """
        low, high = self.balls.within(d)
        share = SLOWEST_IN_NOISE if self.vehicles.is_shaken else SLOWEST
        return share * 2 * max(low, 0.1 * high) / float(self.vehicles.design.slowness)

    def seen(self, found: Candidate) -> float:
        """Return the angle to the axis under which all is seen, rad.

        Parameters
        ----------
        found : Candidate
        """
        return found.seen(self.scene, self.vehicles)

    def sees(self, found: Candidate) -> bool:
        """Tell whether all is seen within the half angle of the camera, where one is said.

        Parameters
        ----------
        found : Candidate
        """
        return self.half_angle is None or self.seen(found) <= self.half_angle

    def holds(self, found: Candidate) -> bool:
        """Tell whether the starts are inside and all is seen.

        Parameters
        ----------
        found : Candidate
        """
        return found.solution.fill <= 1 - ROOM / 2 and self.sees(found)

    @cached_property
    def views(self) -> tuple[Array, Array]:
        """Logarithms of |σ - σ*|, ascending, and the largest angle to the vertical up to each."""
        far = np.linspace(1 / PLACES, 1, PLACES) * self.highest * self.scene.wanted
        return np.log(far), np.maximum.accumulate([self.scene.cone(d) for d in far])


def _corners(start: Start) -> Array:
    sides = np.array(start.position, float)
    return np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 3)
