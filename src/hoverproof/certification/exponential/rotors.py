"""What each rotor makes, and is set to make, on a set, in floating point.

Rotors that lag are set to what they would settle at: a thrust that is ahead of theirs by the lag
times its rate, and the torque commanded. Both are of a vehicle whose mass, inertia, arm and drag
ratio are the mission's; `checker.Exponential` bounds the same exactly.
"""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.vehicles import Limits
from hoverproof.mission.sections import Mission
from hoverproof.plant.rotors import rotor_thrusts

Array = NDArray[np.float64]


def thrusts(limits: Limits, weights: Array, level: float, mission: Mission) -> tuple[float, float]:
    """Return the ends of the thrust of each rotor, N.

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
    yaw = (1 + v.torque) * (yaw + abs(i2 - i1) * (h * turn + v.gyro) ** 2 / 2)
    by_thrust, *by_torque = _shares(float(mission.vehicle.arm), float(mission.vehicle.drag_ratio))
    beside = np.hypot(i1, i2) * turned * by_torque[0] + yaw * by_torque[2]
    return float(by_thrust * (least - ahead) - beside), float(by_thrust * (most + ahead) + beside)


@cache
def _shares(arm: float, drag_ratio: float) -> tuple[float, ...]:
    """Return by how much the thrust of a rotor changes with thrust and torques, alike for each."""
    wrench = ca.SX.sym("wrench", 4)
    each = rotor_thrusts(wrench[0], wrench[1:], ca.SX(arm), ca.SX(drag_ratio))
    shares = np.abs(np.array(ca.DM(ca.jacobian(each, wrench))))
    return tuple(shares.max(axis=0))
