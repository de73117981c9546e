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

from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import TOLERANCES
from hoverproof.servo.law import Design, Law
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.uncertain import kappa

Array = NDArray[np.float64]


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
        Bound of the error of the feature, less m/k1 times that of V, and for an inertial goal less
        s3* times that of ρ.
    felt, leaned : float
        Bounds of the error of a measured force that the accelerometer makes, with the gusts that it
        feels, and of that which ρ makes of any force, N.
    gyro : float
        Bound of the error of Ω, rad/s.
    gusts : float
        Bound of the wind less the steady one, m/s².
    turned : bool
        Whether a late feature is turned to the present axes.
    noise_of_velocity : float
        Bound of the error of V, m/s.
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
    felt: float = 0.0
    leaned: float = 0.0
    gyro: float = 0.0
    gusts: float = 0.0
    turned: bool = True
    noise_of_velocity: float = 0.0
    arm: float = 0.0

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
        each = {name: float(getattr(covered, name)) for name in TOLERANCES}
        noise, goal, mass = covered.noise, float(feature[2]), mission.vehicle.mass
        error = noise.feature + mass / mission.gains.k1 * noise.velocity
        leaned = goal * float(noise.vertical) if law.goal.name == "inertial" else 0.0
        felt = noise.force + mass * covered.gust if law.force.sensed else 0
        return cls(
            law,
            numbers,
            goal,
            **each,
            noise=float(error) + leaned,
            felt=float(felt),
            leaned=float(mission.vehicle.weight * noise.vertical),
            gyro=float(noise.rate),
            gusts=float(covered.gust),
            turned=mission.sensors.gyro_turned,
            noise_of_velocity=float(noise.velocity),
            arm=mission.camera.arm,
        )

    def before(self, ball: tuple[float, float]) -> Vehicles:
        """Return them with what a camera beside the centre of mass sees wrong, as noise.

        Parameters
        ----------
        ball : (low, high)
            j - ϱ and j + ϱ within the arm of all positions, 1/m: at most 2 ϱ times the arm.
        """
        beside = self.arm * (ball[1] - ball[0])
        return replace(self, noise=self.noise + beside) if beside else self

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
    def swept(self) -> float:
        """The latency, s, if a late feature stays in the axes its image was taken in, else 0."""
        return 0.0 if self.turned else self.latency

    @property
    def shock(self) -> float:
        """Bound of the error of the force over c, dimensionless."""
        return (self.felt + self.leaned) / self.stiffness

    @property
    def missed(self) -> float:
        """Bound of what is used of the image error less the present one, y and errors left out.

        What the wind leans the vehicle by turns with the yaw in a feature that is not turned.
        """
        leans = 0.0 if self.in_image else self.goal * self.wind / float(self.design.gravity)
        return self.noise + self.shock + self.swept * self.yaw_rate * leans

    @property
    def is_shaken(self) -> bool:
        """Whether something keeps the vehicle from coming to rest."""
        return bool(self.missed or self.gyro or self.gusts or self.arm)

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
    image : float
        Bound of |δ1|, dimensionless.
    force : float
        Bound of |δ3 - δ2|, dimensionless.
    d3 : float
        Of |δ3|, dimensionless.
    turn : float
        Of |ζ|, ζ = δ4 - P δ3, dimensionless.
    speed : float
        Of |δ1 + δ2|, dimensionless.
    """

    image: float
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
        parts = 1, 1 / w2 + 1 / w3, 1 / w3, 1 / w3 + 1 / w4, 1 + 1 / w2
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
        swept = v.swept * (self.sweep * self.reach.turn + v.yaw_rate * self.seen)
        return v.latency * self.largest * speed + swept + self.missed

    @property
    def missed(self) -> float:
        """Bound of |ν|: of that what is there without y and errors; a wrong gyroscope turns too."""
        v = self.vehicles
        return v.missed + (v.latency - v.swept) * v.gyro * self.seen

    @property
    def seen(self) -> float:
        """Bound of the length of the feature, dimensionless."""
        return self.vehicles.goal + self.reach.image

    @property
    def sweep(self) -> float:
        """Bound of how fast tilting turns the feature, over |ζ|, 1/s."""
        return self.quickness[1] * self.seen

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
    def stray(self) -> float:
        """Bound of the share by which the h that the controller has is wrong; NaN if by all."""
        felt, lever = self.vehicles.felt, self.lever[0]
        return felt / (lever - felt) if lever > felt else np.nan

    @cached_property
    def wobble(self) -> float:
        """Bound of the error of π that the controller has, 1/s."""
        v, stray = self.vehicles, self.stray
        turning = self.quickness[1] * self.reach.turn * v.felt + v.gyro * (v.gust + v.felt)
        own = stray * (2 * self.sinking + self.crosswind)
        return own + (1 + stray) * turning / self.lever[0]

    @cached_property
    def struck(self) -> float:
        """Bound of what errors of force and body rates, without others, add to the command, 1/s."""
        v, slow = self.vehicles, 1 / self.quickness[0]
        turning = v.stiff + 2 * self.sinking + self.crosswind + self.wobble
        turning += (v.yaw_rate + v.gyro) * v.gyroscopic
        return (1 + self.stray) * v.pull * v.shock + turning * v.gyro * slow

    @cached_property
    def misled(self) -> tuple[float, float, float]:
        """By how much ζ, P(δ3 - n) and P(δ3 - δ2) are wrong in the command at most, 1/s."""
        v, stray = self.vehicles, self.stray
        twisted = stray * (v.stiff + v.yaw_rate) + (1 + stray) * v.gyro
        return self.wobble + v.gyro * v.gyroscopic, twisted, stray * v.pull

    def disturbances(self) -> list[tuple[str, float]]:
        """Return the bounds of what is there without any error of the vehicle, by name.

        "noise" is in what is used of the image error, "command" in the command, and "gust" in the
        rates of δ2, δ3 and δ4.
        """
        v = self.vehicles
        shaken = 1.0 if v.rotor_lag else 1 + v.torque
        each = [
            ("noise", self.missed),
            ("command", shaken * self.struck),
            ("gust", float(v.design.slowness) * v.gusts),
        ]
        return [(name, bound) for name, bound in each if bound]

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
        is turned across P δ3; "flow" is 2 M τ̄ y, "level" its P y, "swept" 2 M τ̄ ζ and "aside" P s,
        where a late feature s is not turned.
        """
        v, h = self.vehicles, self.quickness[1]
        late = self.ahead * h + v.thrust * self.crosswind / 2
        wobble, twisted, strayed = self.misled
        if not v.rotor_lag:
            own = 1 + v.torque
            each = [
                ("d4", "applied", v.torque),
                ("d4", "zeta", late + v.yaw_rate * v.torque + own * wobble),
                ("d4", "ahead", v.yaw_rate if v.latency or v.missed else 0.0),
                ("d4", "missed", v.torque * v.yaw_rate + own * twisted),
                ("d4", "pulled", own * strayed),
            ]
        else:
            own = (1 + v.torque) * v.gyroscopic + v.torque
            late += (1 + v.thrust) * 2 * self.sinking + v.yaw_rate * own
            slow = v.rotor_lag * v.pull
            each = [
                ("d4", "applied", v.torque),
                ("d4", "zeta", late),
                ("yaw", "h3", v.yaw_rate),
                (
                    "torque",
                    "zeta",
                    v.yaw_rate * v.gyroscopic + slow * h * self.reach.force + wobble,
                ),
                ("torque", "missed", v.yaw_rate + twisted),
                ("torque", "pulled", slow * v.yaw_rate + strayed),
                ("lift", "zeta", v.rotor_lag * v.pace * h * self.reach.d3),
                ("torque", "applied", v.rotor_lag * self.stretching),
            ]
        if v.swept:
            each += [
                ("flow", "zeta", self.sweep),
                ("level", "aside", v.yaw_rate),
                ("swept", "aside", self.sweep * v.yaw_rate),
            ]
        return [term for term in each if term[2]]
