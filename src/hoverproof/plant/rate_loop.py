"""An autopilot's own rate loop, which takes body rates in place of torques."""

from __future__ import annotations

import casadi as ca

from hoverproof.algebra.linear import solve_affine
from hoverproof.plant.rigid_body import torque_balance


def rate_command(rate: ca.SX, angular_acceleration: ca.SX, bandwidth: ca.SX) -> ca.SX:
    """Return Ω_c = Ω + Ω̇/ω_r, (3, 1), rad/s, which a loop of bandwidth ω_r answers with Ω̇.

    Parameters
    ----------
    rate, angular_acceleration : SX
        Ω, and the Ω̇ that is wanted, (3, 1), body frame, rad/s and rad/s².
    bandwidth : SX
        ω_r, (1, 1), rad/s.
    """
    return rate + angular_acceleration / bandwidth


def loop_acceleration(command: ca.SX, rate: ca.SX, bandwidth: ca.SX) -> ca.SX:
    """Return Ω̇ = ω (Ω_c - Ω), (3, 1), rad/s², of a first-order rate loop.

    Parameters
    ----------
    command, rate : SX
        Ω_c and Ω, (3, 1), body frame, rad/s.
    bandwidth : SX
        ω, (1, 1) or (3, 1), rad/s.
    """
    return bandwidth * (command - rate)


def loop_torque(command: ca.SX, rate: ca.SX, bandwidth: ca.SX, inertia: ca.SX) -> ca.SX:
    """Return the torque by which a vehicle of this inertia answers so, (3, 1), body frame, N m.

    Parameters
    ----------
    command, rate : SX
        Ω_c and Ω, (3, 1), body frame, rad/s.
    bandwidth : SX
        ω, (1, 1) or (3, 1), rad/s.
    inertia : SX
        Moments and, if there are any, products of inertia, kg m².
    """
    torque = ca.SX.sym("torque", 3)
    wanted = loop_acceleration(command, rate, bandwidth)
    return solve_affine(torque_balance(rate, wanted, inertia, torque), torque)
