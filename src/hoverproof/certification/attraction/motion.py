"""Λ of a state of the vehicle, in floating point: for flights, samples and pictures."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.form import half_squares
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.plant.camera import body_points
from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import LoopNumbers, parameters, sense

Array = NDArray[np.float64]


@cache
def energy_function(n: int, law: Law = HAMEL_MAHONY) -> ca.Function:
    """Return (state (19,), design (13,), points (3, n), goal (3,), a (3,)) ↦ (Λ, Y (11,)).

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
        That of the paper, which tells how much each point counts.
    """
    (d, points), x = parameters(n), ca.SX.sym("x", STATE_SIZE)
    goal, a = ca.SX.sym("goal", 3), ca.SX.sym("a", 3)
    body = RigidBodyState.from_vector(x)
    rays = body_points(points, body.position, body.rotation)
    distance = ca.sqrt(ca.sum1(rays * rays))
    at_goal = ca.sqrt(ca.sum1((points - ca.repmat(goal, 1, n)) ** 2))
    measured, _, _ = sense(body, points, law, all_round=True)  # a region holds leaning vehicles too
    e = HAMEL_MAHONY.errors(measured, d)
    q3 = d.goal_centroid[2]
    far = distance - at_goal
    counts = law.feature.weights
    W = (far @ ca.SX(counts) if counts else ca.sum2(far)) + q3 * (body.position[2] - goal[2])
    energy = W + half_squares(a, e)
    Y = ca.vertcat(measured.centroid - q3 * body.gravity_direction, e.d2, e.d3, e.d4)
    return ca.Function(
        "energy",
        [x, d.vector(), points, goal, a],
        [energy, Y],
        ["x", "design", "points", "goal", "a"],
        ["energy", "Y"],
    )


def energies(region: Attraction, states: Array) -> Array:
    """Return Λ, (k,), at states (k, 19) of the vehicle.

    Parameters
    ----------
    region : Attraction
    states : (k, 19)
        Packed states; see `RigidBodyState`.
    """
    numbers = LoopNumbers.of(region.mission, HAMEL_MAHONY.weighing(region.mission.target))
    a = np.array([float(w) for w in region.weights])
    k = len(states)
    read = energy_function(numbers.target_size, numbers.law).map(k)
    held = [np.tile(numbers.design[:, None], k), np.tile(numbers.points, k)]
    held += [np.tile(numbers.goal[:, None], k), np.tile(a[:, None], k)]
    value: Array = np.array(read(states.T, *held)[0])[0]
    return value
