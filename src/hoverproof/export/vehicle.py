"""The vehicle beside its firmware, its motion and sensors: for the example and for tests."""

from __future__ import annotations

import casadi as ca

from hoverproof.plant import camera
from hoverproof.plant.rigid_body import RigidBodyState, state_rate

BODY_SIZE = 18
"""ξ, V, R column by column, Ω: the state of the vehicle without its thrust."""


def body_rate(state: ca.SX, thrust: ca.SX, torque: ca.SX, vehicle: ca.SX) -> ca.SX:
    """Return the time derivative of the body's state, (18, 1), thrust and torque held.

    Parameters
    ----------
    state : SX
        (18, 1).
    thrust, torque : SX
        T, (1, 1), N and Γ, (3, 1), body frame, N m.
    vehicle : SX
        Mass, gravity and inertia, (5, 1).
    """
    body = RigidBodyState.from_vector(ca.vertcat(state, thrust))
    rate = state_rate(
        body,
        torque=torque,
        thrust_rate=ca.SX(0),
        mass=vehicle[0],
        inertia=vehicle[2:5],
        gravity=vehicle[1],
    )
    return rate.vector()[:BODY_SIZE]


def rate_function() -> ca.Function:
    """Return (state, thrust, torque, vehicle) ↦ (rate)."""
    x, T = ca.SX.sym("x", BODY_SIZE), ca.SX.sym("T")
    torque, vehicle = ca.SX.sym("torque", 3), ca.SX.sym("vehicle", 5)
    rate = ca.cse(body_rate(x, T, torque, vehicle))
    names = ["x", "thrust", "torque", "vehicle"]
    return ca.Function("rate", [x, T, torque, vehicle], [rate], names, ["rate"])


def sense_function(n: int, sensing: str) -> ca.Function:
    """Return (state, target points (3, n) in m) ↦ what the sensors deliver.

    Outputs: seen (image points (2, n), or the centroid (3,)), velocity, rate, gravity_direction.

    Parameters
    ----------
    n : int
        Number of target points.
    sensing : {"points", "centroid"}
        What the camera delivers.
    """
    x, points = ca.SX.sym("x", BODY_SIZE), ca.SX.sym("points", 3, n)
    body = RigidBodyState.from_vector(ca.vertcat(x, 0))
    image = camera.pinhole(camera.body_points(points, body.position, body.rotation))
    seen = image if sensing == "points" else camera.centroid(camera.spherical(image))
    outputs = {
        "seen": seen,
        "velocity": body.velocity,
        "rate": body.rate,
        "gravity_direction": body.gravity_direction,
    }
    values = ca.cse(list(outputs.values()))
    return ca.Function("sense", [x, points], values, ["x", "points"], list(outputs))
