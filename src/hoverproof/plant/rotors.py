"""Four rotors: where they are, and the thrust and torque they make.

The body axes are x forward, y right, z down. A rotor at r = (x, y, 0) makes the force f = -T e3,
hence the torque r × f = (-y T, x T, 0), and by its drag one about z against the sense in which it
turns.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from hoverproof.algebra.linear import solve_affine

PLACES = {
    "rear right": (-1, 1),
    "front right": (1, 1),
    "rear left": (-1, -1),
    "front left": (1, -1),
}
"""Where each rotor is, (x, y) in levers, body frame."""
SENSES = {"rear left": 1, "front right": 1, "front left": -1, "rear right": -1}
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
    each = dict(zip(ROTORS, ca.vertsplit(rotor_thrusts), strict=True))
    first, *others = each.values()
    return ca.vertcat(
        sum(others, first),
        arm * _balance(each, {name: -y for name, (_, y) in PLACES.items()}),
        arm * _balance(each, {name: x for name, (x, _) in PLACES.items()}),
        drag_ratio * _balance(each, SENSES),
    )


def _balance(each: Mapping[str, ca.SX], signs: Mapping[str, int]) -> ca.SX:
    """Return the thrusts that count for one side less those that count for the other."""
    ahead, behind = ([each[n] for n, sign in signs.items() if sign == side] for side in (1, -1))
    total = sum(ahead[1:], ahead[0])
    for thrust in behind:
        total = total - thrust
    return total


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
