"""A law is a value: what it measures and is made of, its errors, and what it wants of them.

Everything else is derived from that value: the controller is solved for, the dissipation
differentiated, the flight compiled and the firmware printed. A file of `hoverproof.servo.laws`
holds a law.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Any

import casadi as ca

from hoverproof.mission.sections import Mission
from hoverproof.plant import camera, rigid_body
from hoverproof.plant.goal import hover_goal
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
        Principal moments, (3, 1), kg m².
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
        """Return the names of the gains of the error chain: all but that of yaw."""
        return tuple(name for name in cls.gains() if name != "k_yaw")

    @classmethod
    def numbers(cls, mission: Mission) -> dict[str, Sequence[Fraction]]:
        """Return the exact numbers of the fields of a mission, by name, all but q*.

        Parameters
        ----------
        mission : Mission
        """
        v = mission.vehicle
        gains = {name: (getattr(mission.gains, name),) for name in cls.gains()}
        return {"mass": (v.mass,), "gravity": (v.gravity,), "inertia": v.inertia, **gains}

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


def itself(centroid: ca.SX, points: int) -> ca.SX:
    """Return the image centroid: the feature of the paper.

    Parameters
    ----------
    centroid : SX
        q, (3, 1).
    points : int
        Number of target points.
    """
    return centroid


def nothing_more(measured: Measurement, design: Design) -> Measurement:
    """Return the measurement as it is: the paper's law measures nothing more.

    Parameters
    ----------
    measured : Measurement
    design : Design
    """
    return measured


def measured_rate(
    measured: Measurement,
    design: Design,
    *,
    angular_acceleration: ca.SX,
    thrust_rate: ca.SX,
    depth_flow: ca.SX,
) -> ca.SX:
    """Return the time derivative of a measurement's vector, (13, 1).

    The unknown depths act on what is measured through one vector only, the depth flow ``y = QV``;
    keeping it as a symbol of its own is what shows that a controller does not use it.

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


@dataclass(frozen=True, repr=False)
class Law:
    """A control law as a value, from which everything is derived; hashable, so graphs are cached.

    What a law chooses stands in its functions: what it makes of the image (`feature`), where its
    goal is fixed and how it knows the force (`errors`, `lever`), what it asks for (`wanted_rates`).

    Attributes
    ----------
    name : str
    errors : callable
        (Measurement, Design) ↦ `Errors`: δ1…δ4.
    wanted_rates : callable
        (Errors, Measurement, Design, y) ↦ `WantedRates`, y = QV, (3, 1), 1/s.
    lever : callable
        (thrust T in N, Design) ↦ D, (1, 1), N: how body rates turn the force error. The controller
        divides by it, and may be flown where it is positive.
    turning : callable
        Design ↦ the factor of f(T) = turning/(m D), (1, 1), kg²/s², by which the error rates depend
        on the thrust.
    bandwidth : callable
        (mass, gains of the error chain) ↦ attitude bandwidth, rad/s: the damping of the loop of
        δ3 and δ4. Of exact numbers, floats or arrays.
    measurement : type of Measurement
        The layout of what it measures.
    design : type of Design
        The layout of what it is made of.
    feature : callable
        (q (3, 1), number of target points) ↦ what stands in place of q, (3, 1). It turns with the
        camera as q does.
    completed : callable
        (Measurement, Design) ↦ its own measurement: with what ideal sensors deliver besides.
    measured_rate : callable
        As `measured_rate`, for its measurement.
    """

    name: str
    errors: Callable[[Any, Any], Errors]
    wanted_rates: Callable[[Errors, Any, Any, ca.SX], WantedRates]
    lever: Callable[[ca.SX, Any], ca.SX]
    turning: Callable[[Any], ca.SX]
    bandwidth: Callable[..., Any]
    measurement: type[Measurement] = Measurement
    design: type[Design] = Design
    feature: Callable[[ca.SX, int], ca.SX] = itself
    completed: Callable[[Measurement, Any], Measurement] = nothing_more
    measured_rate: Callable[..., ca.SX] = measured_rate

    def __repr__(self) -> str:
        return f"Law({self.name!r})"

    def goal_feature(self, mission: Mission) -> list[Fraction]:
        """Return what stands in place of q* in the design, (3,): exact if it is q* itself.

        Parameters
        ----------
        mission : Mission

        Raises
        ------
        InputError
            If no hover sees the goal of the mission.
        """
        q = hover_goal(mission).centroid_midpoint
        if self.feature is itself:
            return q
        seen = self.feature(ca.SX([float(c) for c in q]), len(mission.target.points))
        return [Fraction(float(c)) for c in ca.vertsplit(ca.evalf(seen))]
