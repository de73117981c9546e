"""An attitude that a gyro adds up, and directions turned with it.

Between frames the controller knows how it has turned: a feature that is held in axes that do not
turn, those of the added-up attitude, is turned back into the body when it is used. Frames that come
late are right by that too, since they are put into those axes when they are taken.
"""

from __future__ import annotations

import casadi as ca

START = (1.0, 0.0, 0.0, 0.0)
"""The attitude at the start, a unit quaternion: scalar, then vector."""


def turned_on(attitude: ca.SX, turn: ca.SX) -> ca.SX:
    """Return the attitude after a turn of the body, (4, 1), again of length 1.

    It is a rotation about the turn by its length θ, but for θ⁵/720: half the tangent of θ/2 is
    taken as θ/2 (1 + θ²/12), so that no sine is needed.

    Parameters
    ----------
    attitude : SX
        Unit quaternion, (4, 1).
    turn : SX
        Body rate times time, (3, 1), body frame, rad.
    """
    half = turn / 2 * (1 + ca.sumsqr(turn) / 12)
    scalar, vector = attitude[0], attitude[1:]
    after = ca.vertcat(
        scalar - ca.dot(vector, half), vector + scalar * half + ca.cross(vector, half)
    )
    return after / ca.norm_2(after)


def held_still(attitude: ca.SX, direction: ca.SX) -> ca.SX:
    """Return a vector of the body in the axes that do not turn, (3, 1), in its own unit.

    Parameters
    ----------
    attitude : SX
        Unit quaternion, (4, 1).
    direction : SX
        (3, 1), body frame, any unit.
    """
    scalar, vector = attitude[0], attitude[1:]
    across = 2 * ca.cross(vector, direction)
    return direction + scalar * across + ca.cross(vector, across)


def in_body(attitude: ca.SX, direction: ca.SX) -> ca.SX:
    """Return what `held_still` was given, (3, 1), body frame, in its own unit.

    Parameters
    ----------
    attitude : SX
        Unit quaternion, (4, 1).
    direction : SX
        (3, 1), in the axes that do not turn, any unit.
    """
    return held_still(ca.vertcat(attitude[0], -attitude[1:]), direction)
