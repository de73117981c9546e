"""The hovering vehicle as a rigid body (eqs. 1-5 and 21).

World frame with z down; the body frame is the camera frame; `R` maps body to world.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.linear import solve_affine

E3 = ca.SX([0, 0, 1])


def skew(a: ca.SX) -> ca.SX:
    """Return the matrix with ``skew(a) @ b == cross(a, b)``, (3, 3).

    Parameters
    ----------
    a : SX
        (3, 1).
    """
    return ca.skew(a)


@dataclass(frozen=True)
class RigidBodyState:
    """State of the vehicle; every field is a CasADi expression.

    Attributes
    ----------
    position : SX
        ξ, (3, 1), world frame, m.
    velocity : SX
        V, (3, 1), body frame, m/s.
    rotation : SX
        R, (3, 3), body to world.
    rate : SX
        Ω, (3, 1), body frame, rad/s.
    thrust : SX
        T, (1, 1), N.
    """

    position: ca.SX
    velocity: ca.SX
    rotation: ca.SX
    rate: ca.SX
    thrust: ca.SX

    @classmethod
    def symbols(cls) -> RigidBodyState:
        """Return a state of fresh symbols."""
        return cls(
            position=ca.SX.sym("xi", 3),
            velocity=ca.SX.sym("V", 3),
            rotation=ca.SX.sym("R", 3, 3),
            rate=ca.SX.sym("Omega", 3),
            thrust=ca.SX.sym("T"),
        )

    @classmethod
    def from_vector(cls, x: ca.SX) -> RigidBodyState:
        """Unpack a (19, 1) vector: ξ, V, R column by column, Ω, T.

        Parameters
        ----------
        x : SX
            (19, 1).
        """
        return cls(x[0:3], x[3:6], ca.reshape(x[6:15], 3, 3), x[15:18], x[18])

    def vector(self) -> ca.SX:
        """Pack into a (19, 1) vector: ξ, V, R column by column, Ω, T."""
        return ca.vertcat(
            self.position, self.velocity, ca.vec(self.rotation), self.rate, self.thrust
        )

    @property
    def gravity_direction(self) -> ca.SX:
        """ρ = Rᵀe₃, (3, 1), body frame: where an accelerometer at rest says down is."""
        return self.rotation.T @ E3


BODY_SIZE = 18
"""ξ, V, R column by column, Ω: the state of the vehicle without its thrust."""

STATE_SIZE = 19


def force(thrust: ca.SX, gravity_direction: ca.SX, mass: ca.SX, gravity: ca.SX) -> ca.SX:
    """Return the exogenous force F = -T e₃ + m g ρ, (3, 1), body frame, N (eq. 5).

    Parameters
    ----------
    thrust : SX
        T, (1, 1), N.
    gravity_direction : SX
        ρ = Rᵀe₃, (3, 1), body frame.
    mass : SX
        (1, 1), kg.
    gravity : SX
        (1, 1), m/s².
    """
    return -thrust * E3 + mass * gravity * gravity_direction


def specific_force(thrust: ca.SX, mass: ca.SX, drag: ca.SX) -> ca.SX:
    """Return a = V̇ + Ω × V - g ρ, (3, 1), body frame, m/s²: what an accelerometer measures.

    Parameters
    ----------
    thrust : SX
        T, (1, 1), N.
    mass : SX
        (1, 1), kg.
    drag : SX
        A force beside thrust and weight, (3, 1), body frame, N.
    """
    return (drag - thrust * E3) / mass


def acceleration(velocity: ca.SX, rate: ca.SX, force: ca.SX, mass: ca.SX) -> ca.SX:
    """Return V̇ = -Ω × V + F/m, (3, 1), body frame, m/s² (eq. 2).

    Parameters
    ----------
    velocity : SX
        V, (3, 1), body frame, m/s.
    rate : SX
        Ω, (3, 1), body frame, rad/s.
    force : SX
        F, (3, 1), body frame, N.
    mass : SX
        (1, 1), kg.
    """
    return -skew(rate) @ velocity + force / mass


def gravity_direction_rate(gravity_direction: ca.SX, rate: ca.SX) -> ca.SX:
    """Return ρ̇ = -Ω × ρ, (3, 1), 1/s (from eq. 3).

    Parameters
    ----------
    gravity_direction : SX
        ρ = Rᵀe₃, (3, 1), body frame.
    rate : SX
        Ω, (3, 1), body frame, rad/s.
    """
    return -skew(rate) @ gravity_direction


def heading(rotation: ca.SX) -> ca.SX:
    """Return (cos ψ, sin ψ), (2, 1), of the yaw ψ in R = Rz(ψ) Ry(θ) Rx(φ).

    Parameters
    ----------
    rotation : SX
        R, (3, 3), body to world.
    """
    forward = rotation[:2, 0]
    return forward / ca.norm_2(forward)


def direction_of(vector: ca.SX) -> ca.SX:
    """Return a vector over its length, (k, 1); one of next to none, below 1e-9, stays that.

    Parameters
    ----------
    vector : SX
        (k, 1), dimensionless.
    """
    return vector / ca.fmax(ca.norm_2(vector), 2**-30)


def heading_of_north(north: ca.SX, gravity_direction: ca.SX) -> ca.SX:
    """Return (cos ψ, sin ψ), (2, 1), of two axes of the world that are known in the body frame.

    Parameters
    ----------
    north : SX
        Rᵀe₁, (3, 1), body frame.
    gravity_direction : SX
        ρ = Rᵀe₃, (3, 1), body frame.
    """
    return direction_of(ca.vertcat(north[0], (skew(gravity_direction) @ north)[0]))


def heading_rate(heading: ca.SX, gravity_direction: ca.SX, rate: ca.SX) -> ca.SX:
    """Return the time derivative of (cos ψ, sin ψ), (2, 1), 1/s: ψ̇ = (Ω2 ρ2 + Ω3 ρ3)/(ρ2² + ρ3²).

    Parameters
    ----------
    heading : SX
        (cos ψ, sin ψ), (2, 1).
    gravity_direction : SX
        ρ = Rᵀe₃, (3, 1), body frame.
    rate : SX
        Ω, (3, 1), body frame, rad/s.
    """
    across, turn = gravity_direction[1:], rate[1:]
    yaw_rate = ca.dot(turn, across) / ca.dot(across, across)
    return yaw_rate * ca.vertcat(-heading[1], heading[0])


def angular_momentum(inertia: ca.SX, rate: ca.SX) -> ca.SX:
    """Return I Ω, (3, 1), kg m²/s.

    Parameters
    ----------
    inertia : SX
        I11, I22, I33, (3, 1), kg m²; with products of inertia I12, I13, I23 besides, (6, 1).
    rate : SX
        Ω, (3, 1), body frame, rad/s.
    """
    if inertia.shape[0] == 3:
        return inertia * rate
    xx, yy, zz, xy, xz, yz = ca.vertsplit(inertia)
    rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return ca.vertcat(*(ca.horzcat(*row) for row in rows)) @ rate


def torque_balance(
    rate: ca.SX, angular_acceleration: ca.SX, inertia: ca.SX, torque: ca.SX
) -> ca.SX:
    """Return I Ω̇ + Ω × I Ω - Γ, (3, 1), N m, which eq. 4 sets to zero.

    Parameters
    ----------
    rate, angular_acceleration : SX
        Ω and Ω̇, (3, 1), body frame, rad/s and rad/s².
    inertia : SX
        Moments and, if there are any, products of inertia, kg m²; see `angular_momentum`.
    torque : SX
        Γ, (3, 1), body frame, N m.
    """
    gyroscopic = skew(rate) @ angular_momentum(inertia, rate)
    return angular_momentum(inertia, angular_acceleration) + gyroscopic - torque


def state_rate(
    state: RigidBodyState,
    *,
    torque: ca.SX,
    thrust_rate: ca.SX,
    mass: ca.SX,
    inertia: ca.SX,
    gravity: ca.SX,
    drag: ca.SX | None = None,
) -> RigidBodyState:
    """Return the time derivative of the state (eqs. 1-5 and 21).

    Parameters
    ----------
    state : RigidBodyState
    torque : SX
        Γ, (3, 1), body frame, N m.
    thrust_rate : SX
        U, (1, 1), N/s.
    mass, gravity : SX
        kg and m/s².
    inertia : SX
        Moments and, if there are any, products of inertia, kg m²; see `angular_momentum`.
    drag : SX, optional
        A force beside thrust and weight, (3, 1), body frame, N; the paper has none.
    """
    alpha = ca.SX.sym("alpha", 3)
    exogenous = force(state.thrust, state.gravity_direction, mass, gravity)
    if drag is not None:
        exogenous += drag
    return RigidBodyState(
        position=state.rotation @ state.velocity,
        velocity=acceleration(state.velocity, state.rate, exogenous, mass),
        rotation=state.rotation @ skew(state.rate),
        rate=solve_affine(torque_balance(state.rate, alpha, inertia, torque), alpha),
        thrust=thrust_rate,
    )


def held_rate(
    state: RigidBodyState,
    *,
    torque: ca.SX,
    mass: ca.SX,
    inertia: ca.SX,
    gravity: ca.SX,
    drag: ca.SX | None = None,
) -> ca.SX:
    """Return the time derivative of the body's state, (18, 1), while the thrust is held.

    Parameters
    ----------
    state : RigidBodyState
    torque : SX
        Γ, (3, 1), body frame, N m.
    mass, gravity : SX
        kg and m/s².
    inertia : SX
        Moments and, if there are any, products of inertia, kg m²; see `angular_momentum`.
    drag : SX, optional
        A force beside thrust and weight, (3, 1), body frame, N.
    """
    rate = state_rate(
        state,
        torque=torque,
        thrust_rate=ca.SX(0),
        mass=mass,
        inertia=inertia,
        gravity=gravity,
        drag=drag,
    )
    return rate.vector()[:BODY_SIZE]


def rotation_matrix(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """Return R = Rz(yaw) Ry(pitch) Rx(roll), (3, 3), from angles in rad.

    Parameters
    ----------
    roll, pitch, yaw : float
        rad.
    """
    angles = [roll, pitch, yaw]
    return np.array(rotation_rows(list(np.cos(angles)), list(np.sin(angles))))


def rotation_rows(cosines: Sequence[Any], sines: Sequence[Any]) -> list[list[Any]]:
    """Return the rows of R = Rz(yaw) Ry(pitch) Rx(roll), (3, 3), in any arithmetic.

    Parameters
    ----------
    cosines, sines : (3,)
        Of roll, pitch and yaw.
    """
    (cr, cp, cy), (sr, sp, sy) = cosines, sines
    return [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
