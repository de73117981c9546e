"""The vehicles within tolerance, and what the errors, the thrust and the tilt come to on a set.

All in floating point; `checker.Exponential` bounds the same exactly.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Design, Law
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.uncertain import kappa

Array = NDArray[np.float64]


def require_turned(mission: Mission) -> None:
    """Refuse a latency through which the feature is not turned with the gyroscope.

    Parameters
    ----------
    mission : Mission

    Raises
    ------
    InputError
        If there is one.
    """
    if mission.uncertainty.latency and not mission.sensors.gyro_turned:
        raise InputError(
            mission.source,
            "uncertainty.latency",
            "is covered only if the controller turns the feature it holds with the gyroscope; "
            "set gyro_turned = true in [sensors]",
        )


@dataclass(frozen=True)
class Vehicles:
    """A design, and the tolerances within which the vehicle is.

    Attributes
    ----------
    law : Law
    numbers : (13,)
        Of the design, in its order.
    goal : float
        s3*, of the law's feature at the goal.
    thrust, torque : float
        θ and γ̄, shares, dimensionless.
    latency, rotor_lag : float
        τ̄ and τr, s.
    wind : float
        w̄, m/s².
    yaw_rate : float
        Bound of |Ω3|, rad/s.
    noise : float
        Bound of |ν|: of the noise of the feature less m/k1 times that of V.
    noise_of_velocity : float
        Bound of that of V, m/s.
    """

    law: Law
    numbers: Array
    goal: float
    thrust: float
    torque: float
    latency: float
    rotor_lag: float
    wind: float
    yaw_rate: float
    noise: float = 0.0
    noise_of_velocity: float = 0.0

    @classmethod
    def of(cls, mission: Mission) -> Vehicles:
        """Take the tolerances of a mission.

        Parameters
        ----------
        mission : Mission
        """
        law, covered = law_of(mission), mission.uncertainty
        feature = law.goal_feature(mission)
        numbers = np.array([float(x) for x in law.design.values(mission, feature)])
        names = ("thrust", "torque", "latency", "rotor_lag", "wind", "yaw_rate")
        each = {name: float(getattr(covered, name)) for name in names}
        slowness = mission.vehicle.mass / mission.gains.k1
        noise = float(covered.noise.feature + slowness * covered.noise.velocity)
        speeds = float(covered.noise.velocity)
        return cls(law, numbers, float(feature[2]), **each, noise=noise, noise_of_velocity=speeds)

    def allowing(self, name: str, size: float) -> Vehicles:
        """Return them with another tolerance.

        Parameters
        ----------
        name : str
            thrust, torque, latency, rotor_lag, wind or yaw_rate.
        size : float
            In its unit, a bare number.
        """
        return replace(self, **{name: size})  # type: ignore[arg-type]

    def with_numbers(self, numbers: Array) -> Vehicles:
        """Return them with another design, such as other gains.

        Parameters
        ----------
        numbers : (13,)
            Of the design.
        """
        slow = replace(self, numbers=numbers)
        moved = float(slow.design.slowness - self.design.slowness)
        return replace(slow, noise=self.noise + moved * self.noise_of_velocity)

    @cached_property
    def design(self) -> Design:
        """The design, of floats."""
        places = ((name, self.law.design.place(name)) for name in self.law.design.sizes())
        sides = ((name, self.numbers[at]) for name, at in places)
        return self.law.design(**{n: x if len(x) > 1 else float(x[0]) for n, x in sides})  # type: ignore[arg-type]

    @property
    def weight(self) -> float:
        """m g, N."""
        return float(self.design.mass * self.design.gravity)

    @property
    def stiffness(self) -> float:
        """c, N."""
        return float(self.design.stiffness)

    @property
    def pace(self) -> float:
        """κ, 1/s."""
        return float(kappa(self.design))

    @property
    def pull(self) -> float:
        """k1 k2/m, 1/s."""
        return float(self.design.k1 * self.design.k2 / self.design.mass)

    @property
    def in_image(self) -> float:
        """The part of s3* that turns with the image: all of it or nothing."""
        return 0.0 if self.law.goal.name == "inertial" else self.goal

    @property
    def gust(self) -> float:
        """m w̄, the largest force of the wind, N."""
        return float(self.design.mass) * self.wind

    @property
    def stiff(self) -> float:
        """κ + k4/m, 1/s."""
        return self.pace + float(self.design.k4 / self.design.mass)

    @property
    def gyroscopic(self) -> float:
        """How much of Ω3 e3 × Ω the gyroscopic torque is at most, by the mission's inertia."""
        i1, i2, i3 = self.design.inertia
        return float(max(abs(i3 - i2) / i1, abs(i3 - i1) / i2))


@dataclass(frozen=True)
class Reach:
    """How large errors are on a set {Ψ <= ℓ}, dimensionless.

    Attributes
    ----------
    force : float
        Bound of |δ3 - δ2|, dimensionless.
    d3 : float
        Of |δ3|, dimensionless.
    turn : float
        Of |ζ|, ζ = δ4 - P δ3, dimensionless.
    speed : float
        Of |δ1 + δ2|, dimensionless.
    """

    force: float
    d3: float
    turn: float
    speed: float

    @classmethod
    def of(cls, weights: Array, level: float) -> Reach:
        """Return the reach that weights give.

        Parameters
        ----------
        weights : (3,)
            w2, w3, w4.
        level : float
            ℓ, dimensionless.
        """
        w2, w3, w4 = weights
        parts = 1 / w2 + 1 / w3, 1 / w3, 1 / w3 + 1 / w4, 1 + 1 / w2
        return cls(*(float(np.sqrt(2 * level * x)) for x in parts))


@dataclass(frozen=True)
class Limits:
    """What follows from the reach of the errors, for the vehicles and a ball of J.

    Attributes
    ----------
    vehicles : Vehicles
    reach : Reach
    largest : float
        Bound of |J|, 1/m.
    """

    vehicles: Vehicles
    reach: Reach
    largest: float

    @cached_property
    def force(self) -> float:
        """Bound of |F|, N."""
        return self.vehicles.stiffness * self.reach.force

    @cached_property
    def thrust(self) -> tuple[float, float]:
        """Ends of the thrust that is measured, N; not a number if it may vanish."""
        v = self.vehicles
        gust, low = v.gust, v.weight - self.force
        lowest = np.sqrt(low**2 - gust**2) if low > gust else np.nan
        return float(lowest), v.weight + self.force

    @cached_property
    def lever(self) -> tuple[float, float]:
        """Ends of D_c, N; not a number if it may vanish."""
        singular = self.vehicles.stiffness * self.vehicles.in_image
        low, high = (x - singular for x in self.thrust)
        return (low if low > 0 else np.nan), high

    @cached_property
    def quickness(self) -> tuple[float, float]:
        """Ends of h = c κ/D_c, 1/s."""
        low, high = self.lever
        gain = self.vehicles.stiffness * self.vehicles.pace
        return gain / high, gain / low

    @cached_property
    def tilt(self) -> float:
        """Bound of the sine of the tilt."""
        v = self.vehicles
        return (self.force + v.gust) / v.weight

    @cached_property
    def ahead(self) -> float:
        """Bound of |n + ν|: what is used of the feature and of V, less what is now."""
        v = self.vehicles
        speed = self.reach.speed / float(v.design.slowness)
        return v.latency * self.largest * speed + v.noise

    @cached_property
    def gust(self) -> float:
        """m w̄ over the least lever: bound of |χ - 1|."""
        return self.vehicles.gust / self.lever[0]

    @cached_property
    def crosswind(self) -> float:
        """Bound of |p3|, 1/s."""
        return self.quickness[1] * self.reach.turn * self.gust

    @cached_property
    def sinking(self) -> float:
        """Bound of |p1 - p2|, 1/s."""
        return self.quickness[1] * (self.reach.d3 + self.ahead)

    @cached_property
    def lean(self) -> float:
        """Bound of the tangent of half the tilt."""
        return float(self.tilt / (1 + np.sqrt(1 - self.tilt**2)))

    @cached_property
    def stretching(self) -> float:
        """Bound of |D_c'/D_c| with rotors that lag, 1/s."""
        return (1 + self.vehicles.thrust) * self.sinking + self.crosswind

    def vertices(self) -> Iterator[tuple[float, ...]]:
        """Yield χ, h, ς, τ and π at all vertices, and how the vehicle leans most."""
        v = self.vehicles
        swing = 2 * self.sinking + self.crosswind if v.thrust or v.torque or v.rotor_lag else 0.0
        sides = (
            (1 - self.gust, 1 + self.gust),
            self.quickness if v.in_image else (0.0,),
            (1 - v.thrust, 1 + v.thrust),
            (0.0, v.rotor_lag),
            (-swing, swing),
            (self.lean if v.in_image else 0.0,),
        )
        yield from itertools.product(*(sorted(set(side)) for side in sides))

    def terms(self) -> list[tuple[str, str, float]]:
        """Return the norm-bounded terms that are there: what they push, by what, and the radius.

        What they push are names of `form.Push`, by which of `form.PARTS`. "yaw" is d4 without what
        is turned across P δ3.
        """
        v, h = self.vehicles, self.quickness[1]
        late = self.ahead * h + v.thrust * self.crosswind / 2
        if not v.rotor_lag:
            each = [
                ("d4", "applied", v.torque),
                ("d4", "zeta", late + v.yaw_rate * v.torque),
                ("d4", "ahead", v.yaw_rate if v.latency or v.noise else 0.0),
                ("d4", "missed", v.torque * v.yaw_rate),
            ]
        else:
            own = (1 + v.torque) * v.gyroscopic + v.torque
            late += (1 + v.thrust) * 2 * self.sinking + v.yaw_rate * own
            slow = v.rotor_lag * v.pull
            each = [
                ("d4", "applied", v.torque),
                ("d4", "zeta", late),
                ("yaw", "h3", v.yaw_rate),
                ("torque", "zeta", v.yaw_rate * v.gyroscopic + slow * h * self.reach.force),
                ("torque", "missed", v.yaw_rate),
                ("torque", "pulled", slow * v.yaw_rate),
                ("lift", "zeta", v.rotor_lag * v.pace * h * self.reach.d3),
                ("torque", "applied", v.rotor_lag * self.stretching),
            ]
        return [term for term in each if term[2]]
