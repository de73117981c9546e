"""Four rotors: where they are, and the thrust and torque they make.

The body axes are x forward, y right, z down. A rotor at r makes the force f = -T e3, hence the
torque r × f, and by its drag a torque about z against the sense in which it turns.
"""

from __future__ import annotations

import casadi as ca

from hoverproof.algebra.linear import solve_affine

PLACES = {
    "rear right": (-1, 1),
    "front right": (1, 1),
    "rear left": (-1, -1),
    "front left": (1, -1),
}
"""Where each rotor is, (x, y) in levers, body frame."""
SENSES = {"rear right": -1, "front right": 1, "rear left": 1, "front left": -1}
"""The sign of its drag torque about z, + for a rotor that turns to the left, seen from above."""
ROTORS = tuple(PLACES)
"""Their names, in their order."""


def wrench(rotor_thrusts: ca.SX, arm: ca.SX, drag_ratio: ca.SX) -> ca.SX:
    """Return (T, Γ₁, Γ₂, Γ₃), (4, 1), N and N m (eqs. 36-39, with 37 and 38 put right).

    Parameters
    ----------
    rotor_thrusts : SX
        (4, 1), N, in the order of `ROTORS`.
    arm : SX
        d, lever of each rotor about the roll and the pitch axis, m.
    drag_ratio : SX
        κ, drag torque over thrust of a rotor, m.
    """
    torque = ca.SX(3, 1)
    for i, name in enumerate(ROTORS):
        x, y = PLACES[name]
        force = ca.vertcat(0, 0, -rotor_thrusts[i])
        torque += arm * ca.cross(ca.vertcat(x, y, 0), force)
        torque[2] += drag_ratio * SENSES[name] * rotor_thrusts[i]
    return ca.vertcat(ca.sum1(rotor_thrusts), torque)


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
