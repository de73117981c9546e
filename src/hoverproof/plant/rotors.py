"""Four rotors: their thrusts, and the thrust and torque they make (eqs. 36-39)."""

from __future__ import annotations

import casadi as ca

from hoverproof.algebra.linear import solve_affine

ROTORS = ("rear right", "rear left", "front right", "front left")


def wrench(rotor_thrusts: ca.SX, arm: ca.SX, drag_ratio: ca.SX) -> ca.SX:
    """Return (T, Γ₁, Γ₂, Γ₃), (4, 1), N and N m (eqs. 36-39).

    Parameters
    ----------
    rotor_thrusts : SX
        (4, 1), N, in the order of `ROTORS`.
    arm : SX
        d, distance of each rotor from the centre of mass, m.
    drag_ratio : SX
        κ, drag torque over thrust of a rotor, m.
    """
    rr, rl, fr, fl = (rotor_thrusts[i] for i in range(4))
    return ca.vertcat(
        rr + rl + fr + fl,
        arm * (fr + fl - rr - rl),
        arm * (rl + fl - rr - fr),
        drag_ratio * (fr + rl - fl - rr),
    )


def rotor_thrusts(thrust: ca.SX, torque: ca.SX, arm: ca.SX, drag_ratio: ca.SX) -> ca.SX:
    """Return the rotor thrusts that make a thrust and a torque, (4, 1), N.

    The inverse of `wrench`, with the same `arm` and `drag_ratio`.

    Parameters
    ----------
    thrust, torque : SX
        T, (1, 1), N and Γ, (3, 1), body frame, N m.
    arm, drag_ratio : SX
        d and κ, m.
    """
    unknown = ca.SX.sym("rotor_thrusts", 4)
    wanted = ca.vertcat(thrust, torque)
    return solve_affine(wrench(unknown, arm, drag_ratio) - wanted, unknown)
