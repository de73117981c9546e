"""Λ of a state of the vehicle, in floating point: for flights, samples and pictures."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.form import half_squares
from hoverproof.certification.attraction.verdict import Proved
from hoverproof.mission.sections import Mission
from hoverproof.plant.camera import body_points
from hoverproof.plant.goal import hover_goal
from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState
from hoverproof.servo.error_chain import Design, Measurement, errors

Array = NDArray[np.float64]


@cache
def energy_function(n: int) -> ca.Function:
    """Return (state (19,), design (13,), points (3, n), goal (3,), a (3,)) ↦ (Λ, Y (11,)).

    Parameters
    ----------
    n : int
        Number of target points.
    """
    x, d, points = ca.SX.sym("x", STATE_SIZE), Design.symbols(), ca.SX.sym("points", 3, n)
    goal, a = ca.SX.sym("goal", 3), ca.SX.sym("a", 3)
    body = RigidBodyState.from_vector(x)
    rays = body_points(points, body.position, body.rotation)
    distance = ca.sqrt(ca.sum1(rays * rays))
    at_goal = ca.sqrt(ca.sum1((points - ca.repmat(goal, 1, n)) ** 2))
    q = ca.sum2(rays / ca.repmat(distance, 3, 1))
    measured = Measurement(q, body.velocity, body.gravity_direction, body.rate, body.thrust)
    e = errors(measured, d)
    q3 = d.goal_centroid[2]
    W = ca.sum2(distance - at_goal) + q3 * (body.position[2] - goal[2])
    energy = W + half_squares(a, e)
    Y = ca.vertcat(q - q3 * body.gravity_direction, e.d2, e.d3, e.d4)
    return ca.Function(
        "energy",
        [x, d.vector(), points, goal, a],
        [energy, Y],
        ["x", "design", "points", "goal", "a"],
        ["energy", "Y"],
    )


def energies(region: Proved, states: Array) -> Array:
    """Return Λ, (k,), at states (k, 19) of the vehicle.

    Parameters
    ----------
    region : Proved
    states : (k, 19)
        Packed states; see `RigidBodyState`.
    """
    mission = region.mission
    points = np.array(mission.target.points, float).T
    read = energy_function(points.shape[1]).map(len(states))
    design, goal, a = numbers(mission, region)
    k = len(states)
    held = [np.tile(design[:, None], k), np.tile(points, k)]
    held += [np.tile(goal[:, None], k), np.tile(a[:, None], k)]
    value: Array = np.array(read(states.T, *held)[0])[0]
    return value


def numbers(mission: Mission, region: Proved) -> tuple[Array, Array, Array]:
    """Return design (13,), goal (3,) and weights (3,) in floating point.

    Parameters
    ----------
    mission : Mission
    region : Proved
    """
    goal = hover_goal(mission)
    design = [float(v) for v in Design.values(mission, goal.centroid_midpoint)]
    position = [float(c) for c in goal.position]
    return np.array(design), np.array(position), np.array([float(w) for w in region.weights])
