"""The vehicle beside its firmware, its motion and sensors: for the example and for tests."""

from __future__ import annotations

import casadi as ca

from hoverproof.export.flight_law import BODY_SENSORS
from hoverproof.plant.rigid_body import BODY_SIZE, RigidBodyState, held_rate
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import sense


def rate_function() -> ca.Function:
    """Return (state, thrust, torque, vehicle) ↦ (rate): thrust and torque are held.

    The state is the body's, (18,); the vehicle is its mass, gravity and inertia, (5,).
    """
    x, T = ca.SX.sym("x", BODY_SIZE), ca.SX.sym("T")
    torque, vehicle = ca.SX.sym("torque", 3), ca.SX.sym("vehicle", 5)
    body = RigidBodyState.from_vector(ca.vertcat(x, T))
    mass, gravity, inertia = vehicle[0], vehicle[1], vehicle[2:]
    rate = ca.cse(held_rate(body, torque=torque, mass=mass, inertia=inertia, gravity=gravity))
    names = ["x", "thrust", "torque", "vehicle"]
    return ca.Function("rate", [x, T, torque, vehicle], [rate], names, ["rate"])


def sense_function(n: int, sensing: str, law: Law = HAMEL_MAHONY) -> ca.Function:
    """Return (state, target points (3, n) in m) ↦ what the sensors deliver.

    Outputs: seen (image points (2, n), or the centroid (3,)), velocity, rate, gravity_direction.

    Parameters
    ----------
    n : int
        Number of target points.
    sensing : {"points", "centroid"}
        What the camera delivers.
    law : Law
    """
    x, points = ca.SX.sym("x", BODY_SIZE), ca.SX.sym("points", 3, n)
    body = RigidBodyState.from_vector(ca.vertcat(x, 0))
    measured, image, _ = sense(body, points, law)
    outputs = {
        "seen": image if sensing == "points" else measured.centroid,
        **{name: getattr(measured, name) for name in BODY_SENSORS},
    }
    values = ca.cse(list(outputs.values()))
    return ca.Function("sense", [x, points], values, ["x", "points"], list(outputs))
