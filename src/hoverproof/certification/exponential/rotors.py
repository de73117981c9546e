"""What each rotor makes, and is set to make, on a set, in floating point.

Rotors that lag are set to what they would settle at: a thrust that is ahead of theirs by the lag
times its rate, and the torque commanded. Both are of a vehicle whose mass, inertia, rotors and drag
ratio are the mission's; `checker.Exponential` bounds the same exactly.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.limits import Limits
from hoverproof.mission.frame import Frame, shares
from hoverproof.mission.sections import Mission
from hoverproof.mission.vehicle import Vehicle

Array = NDArray[np.float64]


def thrusts(limits: Limits, weights: Array, level: float, mission: Mission) -> Array:
    """Return the ends of the thrust of each rotor, (n, 2), N.

    Parameters
    ----------
    limits : Limits
        Of the set {Ψ <= ℓ}.
    weights : (3,)
        w2, w3, w4.
    level : float
        ℓ, dimensionless.
    mission : Mission
    """
    v, h = limits.vehicles, limits.quickness[1]
    i1, i2, _ = map(float, mission.vehicle.inertia)
    turn = limits.reach.turn
    least = v.weight - limits.force - v.gust
    most = v.weight + limits.force + v.gust
    ahead = v.rotor_lag * (1 + v.thrust) * v.stiffness * v.pace * (limits.reach.d3 + limits.ahead)
    w2, w3, w4 = weights
    asked = np.sqrt(2 * level * (v.stiff**2 / w4 + v.pull**2 * (1 / w2 + 1 / w3)))
    asked += v.stiff * limits.ahead + (2 * limits.sinking + limits.crosswind) * turn
    asked += v.yaw_rate * (limits.reach.d3 + limits.ahead)
    wobble, twisted, strayed = limits.misled
    asked += limits.struck + wobble * turn + strayed * limits.reach.force
    asked += twisted * (limits.reach.d3 + limits.ahead)
    own = (1 + v.torque) * v.gyroscopic + v.torque
    turned = h * ((1 + v.torque) * asked + v.yaw_rate * own * turn)
    yaw = float(mission.gains.k_yaw) * (v.yaw_rate + v.gyro)
    if mission.goal.heading is not None:
        yaw += float(mission.k_heading)
    plain, about_it = h * asked, yaw / float(mission.vehicle.inertia[2])
    yaw = (1 + v.torque) * (yaw + abs(i2 - i1) * (h * turn + v.gyro) ** 2 / 2)
    by_thrust, roll, pitch, spin = _shares(mission.vehicle)
    beside = np.hypot(i1 * roll, i2 * pitch) * turned + yaw * np.abs(spin)
    if mission.vehicle.products is not None:
        matrix, way = np.array(mission.vehicle.matrix, float), np.stack([roll, pitch, spin])
        x, y, z = matrix @ way
        uneven = np.linalg.norm(matrix - np.eye(3) * matrix.trace() / 3)
        beside = np.hypot(x, y) * plain + np.abs(z) * about_it
        beside += uneven * np.linalg.norm(way, axis=0) * ((h * turn) ** 2 + v.yaw_rate**2)
    ends = np.stack([by_thrust * (least - ahead), by_thrust * (most + ahead)])
    return np.stack([ends.min(axis=0) - beside, ends.max(axis=0) + beside], axis=1)


def _shares(vehicle: Vehicle) -> Array:
    """Return by how much each rotor's thrust changes with thrust and torques, (4, n)."""
    reach, drag_ratio = float(vehicle.reach), float(vehicle.drag_ratio)
    return np.divide(_shares_of(vehicle.frame).T, [[1.0], [reach], [reach], [drag_ratio]])


@cache
def _shares_of(frame: Frame) -> Array:
    return np.array(shares(frame), float)
