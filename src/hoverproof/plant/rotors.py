"""The thrust and torque that rotors make, and the rotor thrusts that make a thrust and torque.

The body axes are x forward, y right, z down. A rotor at r = (x, y, 0) makes the force f = -T e3,
hence the torque r × f = (-y T, x T, 0), and by its drag one about z against the sense in which it
turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import casadi as ca

from hoverproof.mission.frame import Frame, mixing_rows, shares


def wrench(frame: Frame, rotor_thrusts: ca.SX, arm: ca.SX, drag_ratio: ca.SX) -> ca.SX:
    """Return (T, Γ₁, Γ₂, Γ₃), (4, 1), N and N m (eqs. 36-39, with 37 and 38 put right).

    Parameters
    ----------
    frame : Frame
        Of n rotors.
    rotor_thrusts : SX
        (n, 1), N, in the order of the frame.
    arm : SX
        The length that places are multiples of, m; in an X frame d, the lever of each rotor about
        the roll and the pitch axis.
    drag_ratio : SX
        κ, drag torque over thrust of a rotor, m.
    """
    each = ca.vertsplit(rotor_thrusts)
    total, roll, pitch, yaw = mixing_rows(frame)
    return ca.vertcat(
        _balance(each, total),
        arm * _balance(each, roll),
        arm * _balance(each, pitch),
        drag_ratio * _balance(each[::-1], yaw[::-1]),
    )


def _balance(each: Sequence[ca.SX], weights: Sequence[Fraction]) -> ca.SX:
    """Return the thrusts that count for one side less those that count for the other."""
    terms = [
        (thrust if abs(weight) == 1 else float(abs(weight)) * thrust, weight)
        for thrust, weight in zip(each, weights, strict=True)
    ]
    first, *others = [thrust for thrust, weight in terms if weight > 0]
    total = sum(others, first)
    for thrust in (thrust for thrust, weight in terms if weight < 0):
        total = total - thrust
    return total


def rotor_thrusts(
    frame: Frame, thrust: ca.SX, torque: ca.SX, arm: ca.SX, drag_ratio: ca.SX
) -> ca.SX:
    """Return the rotor thrusts that make a thrust and a torque, (n, 1), N.

    Of all that do it is the pseudo-inverse of `wrench`, the least sum of squares, with the same
    `frame`, `arm` and `drag_ratio`.

    Parameters
    ----------
    frame : Frame
        Of n rotors.
    thrust, torque : SX
        T, (1, 1), N and Γ, (3, 1), body frame, N m.
    arm, drag_ratio : SX
        m; see `wrench`.
    """
    firsts = [next(weight for weight in row if weight) for row in mixing_rows(frame)]
    signs = [1 if weight > 0 else -1 for weight in firsts]
    lengths = ca.vertcat(1, arm, arm, drag_ratio) * ca.DM(signs)
    rows = [[float(a) * sign for a, sign in zip(row, signs, strict=True)] for row in shares(frame)]
    return ca.sparsify(ca.DM(rows)) @ (ca.vertcat(thrust, torque) / lengths)
