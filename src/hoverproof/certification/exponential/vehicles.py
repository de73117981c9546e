"""The vehicles within tolerance: a design, and how far each of its numbers may be off."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import TOLERANCES
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.true_vehicle import kappa
from hoverproof.servo.variables import Design

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
    arm : float
        From the centre of mass to the camera, m.
    control_period, force_lag : float
        From one run of the controller to the next, and of the low-pass of the accelerometer, s.
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
    control_period: float = 0.0
    force_lag: float = 0.0
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
    def age(self) -> float:
        """Bound of the age of an image, until the controller runs again, s."""
        return self.latency + self.control_period

    @property
    def behind(self) -> float:
        """Bound of how far the force that is used is behind, s."""
        return self.control_period + self.force_lag

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
        jolted = self.control_period * float(self.design.slowness) * self.gusts
        return self.noise + self.shock + jolted + self.swept * self.yaw_rate * leans

    @property
    def is_shaken(self) -> bool:
        """Whether something keeps the vehicle from coming to rest."""
        lasting = self.missed, self.gyro, self.gusts, self.arm, self.force_lag * self.wind
        return any(lasting)

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
        i1, i2, i3 = self.design.inertia[:3]
        return float(max(abs(i3 - i2) / i1, abs(i3 - i1) / i2))
