"""The world: rigid body, camera, rotors and the hover asked for."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hoverproof.mission.frame import X
from hoverproof.mission.reading import load
from hoverproof.plant import camera, rigid_body, rotors
from hoverproof.plant.goal import hover_goal

rng = np.random.default_rng(7)


def call(expression, **values):
    """Evaluate an expression in the symbols that were made with the same names."""
    symbols, numbers = zip(*values.values(), strict=True)
    return np.array(ca.Function("f", list(symbols), [expression])(*numbers))


def random_rotation():
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q @ np.diag(np.sign(np.diag(r)))
    return q * np.sign(np.linalg.det(q))


def test_skew_is_the_cross_product():
    a, b = rng.normal(size=(2, 3))
    assert np.allclose(np.array(ca.DM(rigid_body.skew(ca.SX(a)))) @ b, np.cross(a, b))


def test_rotors_make_the_wrench_that_was_asked_for():
    wanted = rng.normal(size=4)
    forces = rotors.rotor_thrusts(X, ca.SX(wanted[0]), ca.SX(wanted[1:]), ca.SX(0.25), ca.SX(0.01))
    made = rotors.wrench(X, forces, ca.SX(0.25), ca.SX(0.01))
    assert np.allclose(np.array(ca.DM(made)).ravel(), wanted, rtol=1e-13, atol=1e-13)


def test_each_rotor_turns_the_body_about_its_place_and_against_its_sense():
    """Pushed up on the right a vehicle rolls to the left, pushed up in front it noses up."""
    for i, name in enumerate(X.names):
        push = [float(k == i) for k in range(4)]
        made = rotors.wrench(X, ca.SX(push), ca.SX(0.25), ca.SX(0.01))
        thrust, roll, pitch, yaw = np.array(ca.DM(made)).ravel()
        assert thrust == 1
        assert roll == (-0.25 if "right" in name else 0.25)
        assert pitch == (0.25 if "front" in name else -0.25)
        assert yaw == (0.01 if name in ("front right", "rear left") else -0.01)


def test_the_body_turns_as_euler_says():
    inertia, rate, torque = np.array([0.4, 0.56, 0.22]), rng.normal(size=3), rng.normal(size=3)
    state = rigid_body.RigidBodyState(*map(ca.SX, (np.zeros(3), np.zeros(3), np.eye(3), rate, 1.0)))
    change = rigid_body.state_rate(
        state,
        torque=ca.SX(torque),
        thrust_rate=ca.SX(0),
        mass=ca.SX(2),
        inertia=ca.SX(inertia),
        gravity=ca.SX(9.8),
    )
    expected = (torque - np.cross(rate, inertia * rate)) / inertia
    assert np.allclose(np.array(ca.DM(change.rate)).ravel(), expected)


def test_the_pinhole_image_gives_back_the_directions():
    points = rng.normal(size=(3, 5)) + np.array([[0], [0], [4]])
    p = np.array(ca.DM(camera.spherical(camera.pinhole(ca.SX(points)))))
    assert np.allclose(p, points / np.linalg.norm(points, axis=0))


def test_the_centroid_of_the_full_plant_moves_as_eq_8_says():
    points = rng.normal(size=(3, 4)) + np.array([[0], [0], [5]])
    n = points.shape[1]
    state = rigid_body.RigidBodyState.symbols()
    x = state.vector()
    seen = camera.body_points(ca.SX(points), state.position, state.rotation)
    q = camera.centroid(camera.spherical(camera.pinhole(seen)))
    change = rigid_body.state_rate(
        state,
        torque=ca.SX.zeros(3),
        thrust_rate=ca.SX(0),
        mass=ca.SX(1),
        inertia=ca.SX.ones(3),
        gravity=ca.SX(1),
    )
    flow = camera.depth_matrix(seen) @ state.velocity
    both = ca.horzcat(ca.jtimes(q, x, change.vector()), camera.centroid_rate(q, state.rate, flow))
    f = ca.Function("f", [x], [both, seen])
    compared = 0
    while compared < 20:
        values = np.concatenate(
            [rng.normal(size=6), random_rotation().T.ravel(), rng.normal(size=3), [1.0]]
        )
        result, p = map(np.array, f(values))
        if (p[2] > 0.3).all():
            assert np.allclose(result[:, 0], result[:, 1], rtol=1e-10, atol=1e-10 * n)
            compared += 1


def test_depth_matrix_is_the_hessian_of_the_sum_of_distances():
    points, xi = ca.SX(rng.normal(size=(3, 4))), ca.SX.sym("xi", 3)
    rays = points - ca.repmat(xi, 1, 4)
    hessian, gradient = ca.hessian(ca.sum2(ca.sqrt(ca.sum1(rays * rays))), xi)
    Q = camera.depth_matrix(rays)
    at = rng.normal(size=3) + 3
    values = ca.Function("f", [xi], [hessian, Q, gradient])(at)
    assert np.allclose(np.array(values[0]), np.array(values[1]))


def test_the_goal_of_the_square_is_exactly_on_its_axis(x4):
    goal = hover_goal(x4)
    assert goal.position == (0, 0, -3)
    assert goal.centroid[0] == goal.centroid[1] == (0, 0)
    low, high = goal.centroid[2]
    assert low * low * 11 <= 144 <= high * high * 11  # q3* = 4 · 3/√11


@pytest.mark.parametrize("q", ["[0.3, 0.2, 3.5]", "[1, -1, 2]", "[-0.1, 0, 0.7]"])
def test_a_goal_by_centroid_is_found_where_the_camera_sees_it(q):
    mission = load("x4-flyer", {"goal": f"{{centroid = {q}}}"})
    goal = hover_goal(mission)
    rays = np.array(mission.target.points, float) - np.array(goal.position, float)
    seen = (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)
    assert np.allclose(seen, [float(c) for c in mission.goal.centroid], atol=1e-12)


coordinate = st.decimals(min_value=-3, max_value=3, places=2)


@given(st.lists(st.tuples(coordinate, coordinate), min_size=3, max_size=6, unique=True))
def test_a_goal_by_height_sees_its_centroid_straight_below(corners):
    points = [[x, y, 0] for x, y in corners]
    sides = np.array(corners[1:], float) - np.array(corners[0], float)
    assume(np.linalg.matrix_rank(sides, tol=1e-9) == 2)  # not all on one line
    text = "[" + ", ".join(f"[{x}, {y}, {z}]" for x, y, z in points) + "]"
    goal = hover_goal(load("x4-flyer", {"target.points": text, "start.position": "[0, 0, -9]"}))
    assert goal.position[2] == -3
    assert all(abs(end) < 1e-12 for ends in goal.centroid[:2] for end in ends)
