"""Weights, level and multipliers of Λ for every vehicle within tolerance, and for other laws.

As in `inequality`, everything is convex in μ = 1/ℓ and in all that is weighed, over ℓ, for given
bounds of the force, of |δ3| and of the eigenvalues of Q.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_below
from hoverproof.certification.attraction.inequality import (
    LEAST_RATE,
    Bounds,
    Loop,
    Solution,
    barrier_pencil,
)
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.search import Found
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.inequality import MEMORY, SLOPE, Sector, falls
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.program import SPARE
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.certification.robust import Inequality, optimise, reciprocals
from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import TOLERANCES

Array = NDArray[np.float64]
D3_SHARE, TURN = 0.65, 2.0
"""Bounds of |δ3| and |ζ| over that of |δ3 - δ2|."""
DIGITS = 10
SHARE = 1e-7
"""Of the level, that is given away to rounding."""
ERRORS = 7
"""Number of the errors that are not along the second axis."""


@dataclass(frozen=True)
class Rounded:
    """What a search found, in short exact numbers.

    Attributes
    ----------
    weights : (3,)
        a2, a3, a4, m.
    lag : (2,) or None
        a5 and a6, m s².
    memory : Fraction or None
        M, m s.
    multipliers : (1 + k,)
        Of the bound of Q, and of the terms, bare numbers.
    level : Fraction
        ℓ, m.
    """

    weights: tuple[Fraction, ...]
    lag: tuple[Fraction, ...] | None
    memory: Fraction | None
    multipliers: tuple[Fraction, ...]
    level: Fraction

    def weighed(self, largest: float) -> Array:
        """Return what the terms of a start are multiplied by beside W, (..,).

        Parameters
        ----------
        largest : float
            λ, bound of the eigenvalues of Q, 1/m.
        """
        memory = [] if self.memory is None else [float(self.memory) * largest**2]
        return np.array([*map(float, (*self.weights, *(self.lag or ()))), *memory])


@dataclass(frozen=True)
class TolerantLoop(Loop):
    """The vehicles within tolerance under a law of the centroid.

    Attributes
    ----------
    design, weight, stiffness, q3
        See `Loop`: numbers; q3 is 0 for an inertial goal.
    vehicles : Vehicles
    farthest : float
        Bound of |δ1|, dimensionless.
    steepest : float
        The least that the largest eigenvalue of Q may be on a set, 1/m: its third of the trace at
        the goal.
    """

    vehicles: Vehicles
    farthest: float
    steepest: float

    @classmethod
    def of_mission(cls, mission: Mission) -> TolerantLoop:
        """Take vehicles and law of a mission.

        Parameters
        ----------
        mission : Mission
        """
        v = Vehicles.of(mission)
        farthest = float(mission.target.whole) + v.goal
        scene = Scene.of(mission)
        near = np.linalg.norm(scene.points - scene.goal, axis=1)
        steepest = float((2 * scene.target.weights / near).sum() / 3)
        return cls(v.numbers, v.weight, v.stiffness, v.in_image, v, farthest, steepest)

    @property
    def gust(self) -> float:
        """The largest force of the wind, N."""
        return self.vehicles.gust

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
            Bound of |δ3|, dimensionless, as a share of that of |δ3 - δ2|.
        """
        apart = force / self.stiffness
        seen = self.farthest - 2 * self.vehicles.goal  # so that the feature has n at most
        reach = Reach(seen, apart, d3 * apart, TURN * apart, self.farthest + apart)
        return Limits(self.vehicles, reach, largest)

    def nominal(self) -> TolerantLoop | None:
        """Return the loop without tolerances, whose inequality is smaller."""
        zeros = dict.fromkeys(TOLERANCES, 0.0)
        plain = replace(self.vehicles, **zeros)  # type: ignore[arg-type]
        any_ = any(getattr(self.vehicles, name) for name in TOLERANCES)
        return replace(self, vehicles=plain) if any_ else None

    def path_before(self, start: Start) -> float:
        """Return how far the vehicle moves within the latency, m.

        Parameters
        ----------
        start : Start
        """
        return float(start.speed) * self.vehicles.latency

    def at_start(
        self, mission: Mission, start: Start, whole: Array, level: Array, force: float
    ) -> Array:
        """Return what all that is weighed is multiplied by at most in Ψ, (k, ..).

        These are a2, a3, a4; with a lag a5 and a6; with a latency M λ², λ the bound of Q.

        Parameters
        ----------
        mission, start, whole, level, force
            See `Loop.at_start`, bare numbers and N.
        """
        v = self.vehicles
        speed, tilt, rate, thrust = map(float, (start.speed, start.tilt, start.rate, start.thrust))
        most = thrust + self.weight * tilt
        lean = (most + self.gust) / self.weight / np.sqrt((1 + self.tilt(force)[1]) / 2)
        d1 = whole + self.q3 * lean
        flat = np.minimum(d1, level + lean * (whole + self.q3))
        moved, pushed = float(v.design.slowness) * speed, most / self.stiffness
        lever = self.weight + most - self.stiffness * self.q3
        d2, d3 = d1 + moved, d1 + moved + pushed
        d4 = flat + moved + pushed + lever * rate / (self.stiffness * v.pace)
        columns = [d2**2 / 2, d3**2 / 2, d4**2 / 2]
        if v.rotor_lag:
            asked = v.stiff * d4 + v.pull * pushed
            columns += [v.rotor_lag / 2 * asked**2, v.rotor_lag / 2 * (v.pace * d3) ** 2]
        if v.latency:
            flow = np.full(len(d1), speed)
            if v.swept:
                turned = self.farthest * rate + v.yaw_rate * (level + lean * (whole + v.goal))
                flow = flow + turned / self.steepest
            columns.append((v.latency * flow) ** 2 / 2)
        return np.stack(columns, axis=1)

    def solve(self, bounds: Bounds, hovers: Array) -> Solution | None:
        """Find weights and a level; see `Loop.solve`.

        Parameters
        ----------
        bounds : Bounds
        hovers : (k, ..)
            As of `TolerantPotential.hover_terms`; what is not weighed gets a weight of zero.
        """
        d3 = D3_SHARE
        limits = self.limits(bounds.force, bounds.largest, d3)
        if not np.isfinite(limits.lever).all() or limits.tilt >= 1:
            return None
        there, corners = falls(limits, Sector(bounds.largest), 0.0, potential=True).of_used()
        unit = limits.reach.force**-2
        size = len(there) + 2  # of 1, μ, what is weighed, and the largest Λ/ℓ
        corners = [_later(c).less(self._asked(c, bounds)) for c in corners]
        pencils = [reciprocals(0.5, {2: 1, 3: 1}, size), reciprocals(d3**2 / 2, {3: 1}, size)]
        if self.vehicles.wind or self.vehicles.swept:
            pencils.append(reciprocals(TURN**2 / 2, {3: 1, 4: 1}, size))
        if bounds.omega is not None:
            pencil = barrier_pencil(self, bounds, unit, size)
            if pencil is None:
                return None
            pencils.append(pencil)
        least = np.eye(size)[1] - np.eye(size)[0] / (bounds.most_level * unit)
        weighed = [k + 1 for k, name in enumerate(there) if name != SLOPE]
        shares = np.array([bounds.largest**2 if there[k - 1] == MEMORY else 1 for k in weighed])
        inside = np.zeros((len(hovers), size))
        inside[:, weighed] = -hovers[:, : len(weighed)] * shares
        inside[:, -1] = 1
        rows = np.vstack([least, inside, np.eye(size)[1:]])
        found = optimise([0] * (size - 2) + [1], corners, rows=rows, pencils=pencils, shared=True)
        if found is None or not (found.x > 0).all():
            return None
        mu = found.x[0]
        weights = np.zeros(hovers.shape[1] - 1)
        weights[: len(weighed) - 1] = (found.x[[k - 1 for k in weighed]] / mu * shares)[1:]
        multipliers = np.array([found.x[there.index(SLOPE)], *found.multipliers[0]]) / mu
        return Solution(weights, float(1 / (mu * unit)), float(found.x[-1] * unit), multipliers)

    def rate(self, rounded: Rounded, largest: float) -> float:
        """Return ε: -Ψ' is at least (k1/m) ε |Y|² by rounded numbers; 0 or less if by none.

        Parameters
        ----------
        rounded : Rounded
        largest : float
            Bound of the eigenvalues of Q, 1/m.
        """
        v, least = self.vehicles, np.inf
        a, level = np.array(rounded.weights, float), float(rounded.level)
        reach = Reach.of(a, level)
        speed = self.farthest + float(np.sqrt(2 * level / a[0]))
        seen = self.farthest - 2 * v.goal
        limits = Limits(v, replace(reach, speed=speed, image=seen), largest)
        if not np.isfinite(limits.lever).all() or limits.tilt >= 1:
            return -np.inf
        slope, *terms = map(float, rounded.multipliers)
        values = [1.0, *a, *map(float, rounded.lag or ()), slope]
        values += [] if rounded.memory is None else [float(rounded.memory)]
        _, corners = falls(limits, Sector(largest), 0.0, potential=True).of_used()
        for corner in corners:
            found = corner.at(values).bound(terms)
            rest = found[ERRORS:, ERRORS:]
            if np.linalg.eigvalsh(rest)[0] <= 0:
                return -np.inf
            across = found[:ERRORS, ERRORS:]
            left = found[:ERRORS, :ERRORS] - across @ np.linalg.solve(rest, across.T)
            least = min(least, float(np.linalg.eigvalsh(left)[0]))
        return least * float(v.design.slowness)

    def rounded(self, found: Found) -> Rounded:
        """Round what was found.

        Parameters
        ----------
        found : Found
        """

        def short(x: float) -> Fraction:
            return decimal_below(float(x), DIGITS)

        v, more = self.vehicles, list(found.weights[3:])
        memory = short(more.pop() / found.largest**2) if v.latency else None
        return Rounded(
            weights=tuple(map(short, found.weights[:3])),
            lag=tuple(map(short, more)) if v.rotor_lag else None,
            memory=memory,
            multipliers=tuple(map(short, found.multipliers)),
            level=decimal_below(found.level * (1 - SHARE), DIGITS),
        )

    def _asked(self, corner: Inequality, bounds: Bounds) -> Array:
        """Return what the inequality is to be above, of what 1 and μ multiply."""
        asked = np.zeros((2, *corner.S.shape[1:]))
        asked[0] = SPARE * np.eye(asked.shape[1]) / max(1.0, bounds.largest)
        each = np.arange(ERRORS)
        asked[1, each, each] = LEAST_RATE / float(self.vehicles.design.slowness)
        return asked


def _later(corner: Inequality) -> Inequality:
    """Put a place of what 1 multiplies before what all else multiplies."""

    def led(x: Array) -> Array:
        return np.concatenate([np.zeros_like(x[:1]), x])

    return Inequality(led(corner.S), tuple(t._replace(u=led(t.u)) for t in corner.terms))


@dataclass(frozen=True)
class TolerantPotential(Potential):
    """The natural potential of a law of the centroid, and what Ψ is made of besides.

    Attributes
    ----------
    target, goal, q3
        See `Potential`, m and numbers.
    mission : Mission
    loop : TolerantLoop
    """

    mission: Mission
    loop: TolerantLoop

    def hover_terms(self, positions: Array) -> Array:
        """Return (k, ..): Ψ <= terms · (1, what is weighed) for a hover at positions (k, 3).

        Parameters
        ----------
        positions : (k, 3)
            World frame, m.
        """
        d1 = self.centroid(positions) - [0, 0, self.q3]
        whole, level = np.linalg.norm(d1, axis=1), np.linalg.norm(d1[:, :2], axis=1)
        hover = Start.hover(*map(Fraction, map(float, self.goal)))
        rest = self.loop.at_start(self.mission, hover, whole, level, self.loop.weight / 2)
        return np.column_stack([self.value(positions), rest])


def is_plain(mission: Mission) -> bool:
    """Tell whether the law is the paper's and nothing but noise is in doubt.

    Parameters
    ----------
    mission : Mission
    """
    return mission.law.is_papers and not mission.uncertainty.is_tolerant


def posed(mission: Mission) -> tuple[Potential, Loop]:
    """Return the potential and the loop that a mission is about.

    Parameters
    ----------
    mission : Mission
    """
    p = Potential.of(mission)
    if is_plain(mission):
        return p, Loop.of(mission, p.q3)
    loop = TolerantLoop.of_mission(mission)
    return TolerantPotential(p.target, p.goal, p.q3, mission, loop), loop
