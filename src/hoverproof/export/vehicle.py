"""The vehicle beside its firmware, its motion and sensors: for the example and for tests."""

from __future__ import annotations

import casadi as ca

from hoverproof.export.chain import body_sensors
from hoverproof.plant import camera
from hoverproof.plant.rigid_body import BODY_SIZE, RigidBodyState, held_rate
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import parameters, sense


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
    """Return (state, target points (3, n) in m, thrust in N, design) ↦ what the sensors deliver.

    Outputs: seen (image points (2, n), the centroid or the feature (3,)), and what the law takes in
    of the body.

    Parameters
    ----------
    n : int
        Number of target points.
    sensing : {"points", "centroid", "feature"}
        What a step takes in of the image.
    law : Law
    """
    x, T, (design, points) = ca.SX.sym("x", BODY_SIZE), ca.SX.sym("T"), parameters(n, law)
    body = RigidBodyState.from_vector(ca.vertcat(x, T))
    measured, image, _ = sense(body, points, law, design)
    centroid = camera.centroid(camera.spherical(image), law.feature.weights or None)
    outputs = {
        "seen": {"points": image, "centroid": centroid, "feature": measured.centroid}[sensing],
        **{name: getattr(measured, name) for name in body_sensors(law)},
    }
    values = ca.cse(list(outputs.values()))
    inputs = {"x": x, "points": points, "thrust": T, "design": design.vector()}
    return ca.Function("sense", list(inputs.values()), values, list(inputs), list(outputs))
