"""One step of a flight in the closed loop: RK4 as a CasADi graph, and what is noted in it."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.derived import kept_graph
from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import loop_rate, parameters, sense
from hoverproof.servo.variables import Design
from hoverproof.simulation.flight_log import LOG_SIZE, begin, noted

GUARDS = ("depth of the nearest target point", "thrust above the singularity")
"""What must stay positive in flight, in m and N; each step keeps the lowest value so far."""

GUARDED_SIZE = STATE_SIZE + len(GUARDS)
FLIGHT_SIZE = GUARDED_SIZE + LOG_SIZE


def flight_states(
    states: NDArray[np.float64], goal: NDArray[np.float64], points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return flight states at the start, (count, FLIGHT_SIZE).

    Parameters
    ----------
    states : (m, 19)
        Packed, as by `RigidBodyState`, SI units.
    goal : (3,)
        ξ*, world frame, m.
    points : (3, n)
        Target, world frame, m.
    """
    guards = np.full((len(states), len(GUARDS)), np.finfo(float).max)
    return np.hstack([states, guards, begin(goal, points, states[:, :3])])


def guards(state: ca.SX, design: Design, points: ca.SX, law: Law = HAMEL_MAHONY) -> ca.SX:
    """Return the values named in `GUARDS`, (2, 1).

    Parameters
    ----------
    state : SX
        (19, 1), packed as by `RigidBodyState`.
    design : Design
    points : SX
        (3, n), world frame, m.
    law : Law
    """
    body = RigidBodyState.from_vector(state)
    _, _, depths = sense(body, points, law, design)
    return ca.vertcat(ca.mmin(depths), law.lever(body.thrust, design))


def runge_kutta(rate: Callable[[ca.SX, int], ca.SX], x: ca.SX, dt: ca.SX) -> ca.SX:
    """Return x after one step of the Runge-Kutta method of order 4.

    Parameters
    ----------
    rate : callable
        (x, half) ↦ derivative, `half` half steps (0, 1 or 2) after the beginning.
    x : SX
        (k, 1), in SI units.
    dt : SX
        Step, s.
    """
    a = rate(x, 0)
    b = rate(x + dt / 2 * a, 1)
    c = rate(x + dt / 2 * b, 1)
    d = rate(x + dt * c, 2)
    return x + dt / 6 * (a + 2 * b + 2 * c + d)


def nearest_rotation(rotation: ca.SX) -> ca.SX:
    """Return R(3I - RᵀR)/2, (3, 3): a step of Newton and Schulz toward the nearest rotation.

    An error of size ε in orthonormality becomes one of size ε².

    Parameters
    ----------
    rotation : SX
        R, (3, 3).
    """
    return rotation @ (3 * ca.SX.eye(3) - rotation.T @ rotation) / 2


@kept_graph
def step_function(n: int, law: Law = HAMEL_MAHONY) -> ca.Function:
    """Return (flight state, design, points, dt) ↦ flight state after one step of RK4.

    The flight state, (FLIGHT_SIZE,), is the packed state of the vehicle, the lowest guards so far
    and the log.

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    """
    design, points = parameters(n, law)

    def rate(x: ca.SX, _: int) -> ca.SX:
        return loop_rate(x, design, points, law)

    flight, dt = ca.SX.sym("flight", FLIGHT_SIZE), ca.SX.sym("dt")
    x, lowest, log = ca.vertsplit(flight, [0, STATE_SIZE, GUARDED_SIZE, FLIGHT_SIZE])
    body = RigidBodyState.from_vector(runge_kutta(rate, x, dt))
    after = RigidBodyState(
        body.position, body.velocity, nearest_rotation(body.rotation), body.rate, body.thrust
    ).vector()
    now = guards(x, design, points, law)
    log = noted(log, RigidBodyState.from_vector(x), body.position, now[0], now[1])
    lowest = ca.fmin(lowest, now)
    inputs = [flight, design.vector(), points, dt]
    outputs = [ca.cse(ca.vertcat(after, lowest, log))]
    return share_reciprocals(ca.Function("hoverproof_step", inputs, outputs))
