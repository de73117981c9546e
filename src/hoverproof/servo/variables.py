"""The variables of a law: what it is made of and measures, its errors, and the rates it wants.

Each is a packed vector of SX with names, sizes and units; a law with more than that extends it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from fractions import Fraction

import casadi as ca

from hoverproof.mission.sections import Mission
from hoverproof.servo.layout import Packed, column, scalar


@dataclass(frozen=True)
class Design(Packed):
    """What a law is made of besides measurements; every field is an SX.

    A law with more than that extends it.

    Attributes
    ----------
    mass, gravity : SX
        kg and m/s².
    inertia : SX
        I11, I22, I33, (3, 1), kg m²; with products of inertia I12, I13, I23 besides, (6, 1).
    k1, k2, k3, k4, k_yaw : SX
        Gains: k1 in kg m/s, k2 in 1/m, k3 and k4 in kg/s, k_yaw in kg m²/s.
    goal_centroid : SX
        q*, (3, 1), wanted image centroid, camera frame.
    """

    mass: ca.SX = scalar("kg")
    gravity: ca.SX = scalar("m/s²")
    inertia: ca.SX = column("kg m²")
    k1: ca.SX = scalar("kg m/s", gain=True)
    k2: ca.SX = scalar("1/m", gain=True)
    k3: ca.SX = scalar("kg/s", gain=True)
    k4: ca.SX = scalar("kg/s", gain=True)
    k_yaw: ca.SX = scalar("kg m²/s", gain=True)
    goal_centroid: ca.SX = column("1")

    @classmethod
    def gains(cls) -> dict[str, str]:
        """Return the unit of each gain by its name, in order."""
        return {f.name: f.metadata["unit"] for f in fields(cls) if f.metadata["gain"]}

    @classmethod
    def chain_gains(cls) -> tuple[str, ...]:
        """Return the names of the gains of the error chain: all but those of yaw."""
        return tuple(name for name in cls.gains() if name not in ("k_yaw", "k_heading"))

    @classmethod
    def numbers(cls, mission: Mission) -> dict[str, Sequence[Fraction]]:
        """Return the exact numbers of the fields of a mission, by name, all but q*.

        Parameters
        ----------
        mission : Mission
        """
        v = mission.vehicle
        gains = {name: (getattr(mission.gains, name),) for name in cls.gains()}
        moments = v.moments[: cls.sizes()["inertia"]]
        return {"mass": (v.mass,), "gravity": (v.gravity,), "inertia": moments, **gains}

    @classmethod
    def values(cls, mission: Mission, goal_centroid: Sequence[Fraction]) -> list[Fraction]:
        """Return the numbers of a mission in the order of `vector`, exact.

        Parameters
        ----------
        mission : Mission
        goal_centroid : (3,) Fractions
            q*.
        """
        numbers = {**cls.numbers(mission), "goal_centroid": goal_centroid}
        return [number for name in cls.sizes() for number in numbers[name]]

    @property
    def stiffness(self) -> ca.SX:
        """c = k1² k2/m, N: the force that one unit of error asks for."""
        return self.k1**2 * self.k2 / self.mass

    @property
    def slowness(self) -> ca.SX:
        """m/k1, s/m: the error that a speed of 1 m/s makes."""
        return self.mass / self.k1

    @property
    def singular_thrust(self) -> ca.SX:
        """c q3*, N: at this thrust the paper's controller is singular."""
        return self.stiffness * self.goal_centroid[2]


@dataclass(frozen=True)
class Measurement(Packed):
    """What the vehicle knows in flight; every field is an SX, in the body frame.

    A law that measures more extends it, and says how it is `completed` and moves.

    Attributes
    ----------
    centroid : SX
        q, (3, 1), or the feature that a law makes of it.
    velocity : SX
        V, (3, 1), m/s.
    gravity_direction : SX
        ρ = Rᵀe₃, (3, 1).
    rate : SX
        Ω, (3, 1), rad/s.
    thrust : SX
        T, (1, 1), N.
    """

    centroid: ca.SX = column("1")
    velocity: ca.SX = column("m/s")
    gravity_direction: ca.SX = column("1")
    rate: ca.SX = column("rad/s")
    thrust: ca.SX = scalar("N")


@dataclass(frozen=True)
class Errors(Packed):
    """The error vector X = (δ1, δ2, δ3, δ4) ∈ R¹¹; δ4 has no e₃ component.

    Attributes
    ----------
    d1, d2, d3 : SX
        (3, 1): image, velocity and force error.
    d4 : SX
        (2, 1): body-rate error.
    """

    d1: ca.SX = column("1")
    d2: ca.SX = column("1")
    d3: ca.SX = column("1")
    d4: ca.SX = column("1", 2)


@dataclass(frozen=True)
class WantedRates:
    """What a controller is to bring about; it is solved for these.

    Attributes
    ----------
    d3_vertical : SX
        The e₃ row of δ̇3, (1, 1), 1/s: what the thrust rate U is for.
    d4 : SX
        δ̇4, (2, 1), 1/s: what the horizontal torque is for.
    yaw : SX
        Ω̇3, (1, 1), rad/s²: what the torque about the vertical axis is for.
    """

    d3_vertical: ca.SX
    d4: ca.SX
    yaw: ca.SX
