"""The vehicle beside its firmware, its motion and sensors: for the example and for tests."""

from __future__ import annotations

import casadi as ca

from hoverproof.export.chain import body_sensors
from hoverproof.plant import camera
from hoverproof.plant.rate_loop import loop_torque
from hoverproof.plant.rigid_body import BODY_SIZE, RigidBodyState, held_rate
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import parameters, sense


def rate_function(moments: int = 3, *, rates: bool = False) -> ca.Function:
    """Return (state, thrust, torque, vehicle) ↦ (rate): thrust and torque are held.

    The state is the body's, (18,); the vehicle is its mass, gravity and inertia. With a rate loop
    body rates are commanded and held in place of the torque, and its bandwidth is of the vehicle.

    Parameters
    ----------
    moments : int
        Number of moments of inertia, with products of inertia if there are any.
    rates : bool
        Whether body rates are commanded.
    """
    x, T = ca.SX.sym("x", BODY_SIZE), ca.SX.sym("T")
    commanded, vehicle = ca.SX.sym("commanded", 3), ca.SX.sym("vehicle", 2 + moments + rates)
    body = RigidBodyState.from_vector(ca.vertcat(x, T))
    mass, gravity, inertia = vehicle[0], vehicle[1], vehicle[2 : 2 + moments]
    torque = loop_torque(commanded, body.rate, vehicle[-1], inertia) if rates else commanded
    rate = ca.cse(held_rate(body, torque=torque, mass=mass, inertia=inertia, gravity=gravity))
    names = ["x", "thrust", "commanded", "vehicle"]
    return ca.Function("rate", [x, T, commanded, vehicle], [rate], names, ["rate"])


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
