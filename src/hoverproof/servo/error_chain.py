"""The error chain δ1…δ4 and its motion (eqs. 10, 17, 18, 25).

The unknown depths act on the measured quantities through one vector only, the depth flow
``y = QV``; keeping it as a symbol of its own is what shows that a controller does not use it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import ClassVar, Self

import casadi as ca

from hoverproof.mission.sections import Mission
from hoverproof.plant import camera, rigid_body
from hoverproof.plant.rigid_body import E3, skew


class Packed:
    """A dataclass of column vectors, which also stand as one vector in the order of the fields."""

    vectors: ClassVar[frozenset[str]] = frozenset()
    """Names of the fields with three components; the others are scalars."""

    @classmethod
    def symbols(cls) -> Self:
        """Return an object of fresh symbols."""
        names = [f.name for f in fields(cls)]  # type: ignore[arg-type]
        return cls(**{name: ca.SX.sym(name, 3 if name in cls.vectors else 1) for name in names})

    def vector(self) -> ca.SX:
        """Pack into one column, in the order of the fields."""
        names = [f.name for f in fields(self)]  # type: ignore[arg-type]
        packed: ca.SX = ca.vertcat(*(getattr(self, name) for name in names))
        return packed


@dataclass(frozen=True)
class Design(Packed):
    """What the control law is made of besides measurements; every field is an SX.

    Attributes
    ----------
    mass, gravity : SX
        kg and m/s².
    inertia : SX
        Principal moments, (3, 1), kg m².
    k1, k2, k3, k4, k_yaw : SX
        Gains: k1 in kg m/s, k2 in 1/m, k3 and k4 in kg/s, k_yaw in kg m²/s.
    goal_centroid : SX
        q*, (3, 1), wanted image centroid, camera frame.
    """

    vectors = frozenset({"inertia", "goal_centroid"})

    mass: ca.SX
    gravity: ca.SX
    inertia: ca.SX
    k1: ca.SX
    k2: ca.SX
    k3: ca.SX
    k4: ca.SX
    k_yaw: ca.SX
    goal_centroid: ca.SX

    @staticmethod
    def values(mission: Mission, goal_centroid: Sequence[Fraction]) -> list[Fraction]:
        """Return the numbers of a mission in the order of `vector`, (13,), exact.

        Parameters
        ----------
        mission : Mission
        goal_centroid : (3,) Fractions
            q*.
        """
        v, k = mission.vehicle, mission.gains
        gains = (k.k1, k.k2, k.k3, k.k4, k.k_yaw)
        return [v.mass, v.gravity, *v.inertia, *gains, *goal_centroid]

    @property
    def stiffness(self) -> ca.SX:
        """c = k1² k2/m, N: the force that one unit of error asks for."""
        return self.k1**2 * self.k2 / self.mass

    @property
    def singular_thrust(self) -> ca.SX:
        """c q3*, N: at this thrust the controller is singular."""
        return self.stiffness * self.goal_centroid[2]


@dataclass(frozen=True)
class Measurement(Packed):
    """What the vehicle knows in flight; every field is an SX, in the body frame.

    Attributes
    ----------
    centroid : SX
        q, (3, 1).
    velocity : SX
        V, (3, 1), m/s.
    gravity_direction : SX
        ρ = Rᵀe₃, (3, 1).
    rate : SX
        Ω, (3, 1), rad/s.
    thrust : SX
        T, (1, 1), N.
    """

    vectors = frozenset({"centroid", "velocity", "gravity_direction", "rate"})

    centroid: ca.SX
    velocity: ca.SX
    gravity_direction: ca.SX
    rate: ca.SX
    thrust: ca.SX


@dataclass(frozen=True)
class Errors:
    """The error vector X = (δ1, δ2, δ3, δ4) ∈ R¹¹; δ4 has no e₃ component.

    Attributes
    ----------
    d1, d2, d3 : SX
        (3, 1): image, velocity and force error.
    d4 : SX
        (2, 1): body-rate error.
    """

    d1: ca.SX
    d2: ca.SX
    d3: ca.SX
    d4: ca.SX

    @classmethod
    def from_vector(cls, x: ca.SX) -> Errors:
        """Unpack X, (11, 1).

        Parameters
        ----------
        x : SX
            (11, 1).
        """
        return cls(x[0:3], x[3:6], x[6:9], x[9:11])

    def vector(self) -> ca.SX:
        """Pack into X, (11, 1)."""
        return ca.vertcat(self.d1, self.d2, self.d3, self.d4)


def horizontal(a: ca.SX) -> ca.SX:
    """Return the components of P a that are not zero, (2, 1), P = I - e₃e₃ᵀ.

    Parameters
    ----------
    a : SX
        (3, 1).
    """
    return a[:2]


def horizontal_lever(thrust: ca.SX, design: Design) -> ca.SX:
    """Return sk(T e₃ - c q*), (3, 3), N: how body rates turn the force error.

    Parameters
    ----------
    thrust : SX
        T, (1, 1), N.
    design : Design
    """
    return skew(thrust * E3 - design.stiffness * design.goal_centroid)


def errors(measured: Measurement, design: Design) -> Errors:
    """Return δ1…δ4 of a measurement (eqs. 10, 17, 18, 25).

    Parameters
    ----------
    measured : Measurement
    design : Design
    """
    d = design
    force = rigid_body.force(measured.thrust, measured.gravity_direction, d.mass, d.gravity)
    d1 = measured.centroid - d.goal_centroid
    d2 = d.mass / d.k1 * measured.velocity - d1
    d3 = force / d.stiffness + d2
    lever = horizontal_lever(measured.thrust, d) @ measured.rate
    beta = d.mass / (d.stiffness * (d.k1 * d.k2 + d.k3))
    d4 = beta * horizontal(lever) + horizontal(d3)
    return Errors(d1, d2, d3, d4)


def measured_rate(
    measured: Measurement,
    design: Design,
    *,
    angular_acceleration: ca.SX,
    thrust_rate: ca.SX,
    depth_flow: ca.SX,
) -> ca.SX:
    """Return the time derivative of ``measured.vector()``, (13, 1).

    Parameters
    ----------
    measured : Measurement
    design : Design
    angular_acceleration : SX
        Ω̇, (3, 1), rad/s².
    thrust_rate : SX
        U, N/s.
    depth_flow : SX
        y = QV, (3, 1), 1/s.
    """
    d, z = design, measured
    force = rigid_body.force(z.thrust, z.gravity_direction, d.mass, d.gravity)
    return ca.vertcat(
        camera.centroid_rate(z.centroid, z.rate, depth_flow),
        rigid_body.acceleration(z.velocity, z.rate, force, d.mass),
        rigid_body.gravity_direction_rate(z.gravity_direction, z.rate),
        angular_acceleration,
        thrust_rate,
    )
