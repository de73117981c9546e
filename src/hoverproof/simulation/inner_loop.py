"""An autopilot's own rate loop in a simulated flight: body rates and thrust in, rotors out."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.mission.sections import Mission
from hoverproof.plant import rotors
from hoverproof.plant.rate_loop import loop_torque

Array = NDArray[np.float64]


def inner_loop(mission: Mission) -> Callable[[Array, Array, float], Array]:
    """Return (Ω_c and Ω as measured, (3,), rad/s, T in N) ↦ commands of the rotors, (n,), N.

    The loop is of first order and has the bandwidth of the mission for the mission's inertia and
    rotors: it is faster or slower where those are not the true ones.

    Parameters
    ----------
    mission : Mission
        With `interface.rate_bandwidth`.
    """
    vehicle, limits = mission.vehicle, mission.rotors
    wanted, rate, thrust = ca.SX.sym("wanted", 3), ca.SX.sym("rate", 3), ca.SX.sym("thrust")
    inertia = ca.SX(ca.DM([float(i) for i in vehicle.moments]))
    bandwidth = ca.SX(float(mission.interface.rate_bandwidth or 0))
    torque = loop_torque(wanted, rate, bandwidth, inertia)
    arm, drag = (ca.SX(float(x)) for x in (vehicle.reach, vehicle.drag_ratio))
    each = rotors.rotor_thrusts(vehicle.frame, thrust, torque, arm, drag)
    low, high = limits.min_thrust, limits.max_thrust
    each = each if low is None else ca.fmax(each, float(low))
    each = each if high is None else ca.fmin(each, float(high))
    mixed = ca.Function("inner_loop", [wanted, rate, thrust], [ca.densify(each)])

    def rotor_commands(wanted: Array, rate: Array, thrust: float) -> Array:
        return np.array(mixed(wanted, rate, thrust)).ravel()

    return rotor_commands
