"""A camera anywhere in the vehicle: what it sees, flown, as C, and what is proved of it."""

from __future__ import annotations

import json
import shutil

import casadi as ca
import numpy as np
import pytest

import hoverproof as hp
from hoverproof import checker
from hoverproof.certification.exponential.proof import converge
from hoverproof.compilers import find_compiler
from hoverproof.export.binding import Firmware
from hoverproof.firmware.exporting import export_c
from hoverproof.plant.mount import Mount
from hoverproof.plant.rigid_body import RigidBodyState, rotation_matrix
from hoverproof.servo.laws.heading import flown_law
from hoverproof.servo.laws.mounted import heading_at_hover
from hoverproof.servo.loop import LoopNumbers, sense

MISSION = """
name = "mounted"
[law]
feature = "scaled"
goal = "inertial"
force = "measured"
[vehicle]
mass = 0.5
inertia = [0.004046, 0.004046, 0.007514]
lever = 0.1202
drag_ratio = 0.0221
gravity = 9.81
[target]
points = [[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, -0.1, 0], [-0.1, 0.1, 0]]
[goal]
height = 1.2
heading = 0.4
[gains]
k1 = 0.05
k2 = 28
k3 = 2.2
k4 = 5.5
k_yaw = 0.035
[bounds]
eigenvalues = "auto"
thrust = [4.4145, 5.3955]
[start]
position = [0.2, 0, -1.4]
"""
MOUNT = """
[camera]
position = [0.08, 0, 0]
rotation = [0, 0.17453, 1.5708]  # tilted by 10 degrees, turned by 90
"""
LENS = """
[camera.lens]
width = 1280
height = 960
fx = 500
fy = 505
cx = 650
cy = 470
distortion = [-0.28, 0.07, 0.0005, -0.0003, 0.01]
"""
GOAL = np.array([0, 0, -1.2])
needs_compiler = pytest.mark.skipif(not find_compiler(), reason="no C compiler")


@pytest.fixture
def load(tmp_path):
    def mission(text="", overrides=None):
        path = tmp_path / "mounted.toml"
        path.write_text(MISSION + text)
        return hp.load(path, overrides or {})

    return mission


def seen(mission, state):
    """Return the feature that the law of a mission makes of what it sees in a state, (3,)."""
    numbers, x = LoopNumbers.of(mission), ca.SX.sym("x", 19)
    law, design = numbers.law, numbers.law.design.symbols()
    points = ca.SX(ca.DM(numbers.points))
    measured, _, _ = sense(RigidBodyState.from_vector(x), points, law, design)
    look = ca.Function("look", [x, design.vector()], [measured.centroid])
    return np.array(look(state, numbers.design)).ravel()


def state_at(position, *angles):
    state = np.zeros(19)
    state[:3], state[6:15] = position, rotation_matrix(*angles).T.ravel()
    return state


def test_a_camera_that_is_only_turned_sees_the_same(load):
    state = state_at([0.3, -0.2, -1.5], 0.1, -0.2, 0.7)
    turned = load("[camera]\nrotation = [0.1, -0.3, 2]\n")
    assert seen(turned, state) == pytest.approx(seen(load(), state), abs=1e-12)


def test_a_camera_as_usual_is_no_mount(load):
    assert Mount.of(load("[camera]\nposition = [0, 0, 0]\n")).is_central
    assert flown_law(load()).mount.is_central


def test_x_and_y_of_a_camera_with_its_top_to_the_front_are_right_and_back(load):
    axes = np.array(Mount.of(load("[camera]\nrotation = [0, 0, 1.5707963267948966]\n")).rotation)
    assert axes @ [1, 0, 0] == pytest.approx([0, 1, 0], abs=1e-15)
    assert axes @ [0, 1, 0] == pytest.approx([-1, 0, 0], abs=1e-15)
    assert axes @ [0, 0, 1] == pytest.approx([0, 0, 1], abs=1e-15)


def test_the_error_of_a_camera_with_an_arm_vanishes_just_at_the_hover(load):
    mission = load("[camera]\nposition = [0.08, -0.03, 0.02]\nrotation = [0.1, 0.2, 2]\n")
    hover = state_at(GOAL, 0, 0, 0.4)
    numbers = LoopNumbers.of(mission)
    assert seen(mission, hover) == pytest.approx(numbers.goal_centroid, abs=1e-12)
    beside = (
        seen(mission, state_at(GOAL + np.array([0.02, 0, 0]), 0, 0, 0.4)) - numbers.goal_centroid
    )
    assert np.linalg.norm(beside) > 0.1


def test_what_an_arm_leaves_is_as_derived(load):
    """The rate of s against -Ω × s - J V - (J - j I)(Ω × r) + Ω × (J̄ - j I) r, for any j."""
    mission = load("[camera]\nposition = [0.08, -0.03, 0.02]\n")
    arm, rng = np.array([0.08, -0.03, 0.02]), np.random.default_rng(2)
    law, bare = flown_law(mission), load()
    position, angles = np.array([0.1, 0.2, -1.4]), (0.1, -0.15, 0.3)
    R, V, rate = rotation_matrix(*angles), rng.normal(size=3), rng.normal(size=3)
    step = 1e-6

    def at(time):
        turn = np.array([[0, -rate[2], rate[1]], [rate[2], 0, -rate[0]], [-rate[1], rate[0], 0]])
        moved = R @ (np.eye(3) + time * turn + time**2 / 2 * turn @ turn)
        state = state_at(position + time * R @ V, 0, 0, 0)
        state[6:15] = moved.T.ravel()
        return seen(mission, state)

    def feature(place):  # in world axes, of a camera at the centre of mass
        return seen(bare, state_at(place, 0, 0, 0))

    def slope(place):
        steps = np.eye(3) * 1e-6
        columns = [(feature(place - s) - feature(place + s)) / 2e-6 for s in steps]
        return R.T @ np.array(columns).T @ R

    s, J = at(0.0), slope(position + R @ arm)
    turned = rotation_matrix(0, 0, heading_at_hover(mission))
    at_hover = np.array(law.mount.offset)  # a = J̄ r
    mean = turned.T @ (feature(GOAL) - feature(GOAL + turned @ arm))
    assert at_hover == pytest.approx(mean, abs=1e-9)
    for j in (0.0, 8.0):
        left = -(J - j * np.eye(3)) @ np.cross(rate, arm) + np.cross(rate, at_hover - j * arm)
        predicted = -np.cross(rate, s) - J @ V + left
        assert (at(step) - at(-step)) / (2 * step) == pytest.approx(predicted, rel=1e-6, abs=1e-6)


@needs_compiler
def test_a_mounted_camera_flies_by_its_c_and_its_wrong_description_does_not(load, tmp_path):
    """8 cm ahead, tilted by 10 degrees, turned by 90, raw pixels: to within 2 cm; else not."""
    mission = load(MOUNT + LENS)
    export_c(mission, tmp_path / "right", name="fw", allow_uncertified=True)
    firmware = Firmware(tmp_path / "right")
    assert firmware.selftest() == 0
    flown = firmware.fly(0.002, 20, 500)
    assert not set(flown["status"]) - {64}  # nothing but that nothing is proved of the gains
    assert np.linalg.norm(flown["state"][-1][:3] - GOAL) < 0.02

    R = rotation_matrix(0, 0.17453, 1.5708).T  # the rotation transposed: body to camera
    pitch, yaw, roll = (
        -np.arcsin(R[2, 0]),
        np.arctan2(R[1, 0], R[0, 0]),
        np.arctan2(R[2, 1], R[2, 2]),
    )
    wrong = load(MOUNT + LENS, {"camera.rotation": f"[{roll:.9f}, {pitch:.9f}, {yaw:.9f}]"})
    export_c(wrong, tmp_path / "wrong", name="fw", allow_uncertified=True)
    world = "example/vehicle.c"  # what is: the camera as it is mounted
    shutil.copy(tmp_path / "right" / world, tmp_path / "wrong" / world)
    flown = Firmware(tmp_path / "wrong").fly(0.002, 20, 500)
    ended = any(status & 7 for status in flown["status"])
    assert ended or np.linalg.norm(flown["state"][-1][:3] - GOAL) > 0.02


@needs_compiler
@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("model", ["plumb_bob", "equidistant"])
def test_the_lens_in_c_undistorts_as_the_model_does(load, tmp_path, precision, model):
    from hoverproof.plant.lens import LensModel, sight_of

    own = {"camera.lens.distortion_model": model, "camera.lens.distortion": "[-0.02, 0.01]"}
    mission = load(MOUNT + LENS, {**own, "camera.lens.fx": "700", "camera.lens.fy": "710"})
    export_c(mission, tmp_path, name="fw", allow_uncertified=True, precision=precision)
    firmware, lens = Firmware(tmp_path), LensModel.of(mission)
    assert firmware.selftest() == 0
    pixels = np.random.default_rng(3).uniform([0, 0], [1280, 960], (4, 2))
    status, points = firmware.lens(pixels)
    symbol = ca.SX.sym("pixel", 2)
    graph = ca.Function("f", [symbol], [lens.undistorted(symbol, sight_of(lens).steps)])
    assert status == 0
    close = 1e-5 if precision == "float32" else 1e-12
    assert points == pytest.approx(np.array(graph.map(4)(pixels.T)).T, abs=close)
    pixels[1] = [5000, 20]
    pixels[2] = [np.nan, 20]
    status, points = firmware.lens(pixels)
    assert status == 1 and not points[1:3].any() and points[[0, 3]].all()


@needs_compiler
def test_the_frames_of_a_mounted_camera_make_the_same_feature(load, tmp_path):
    mission = load(MOUNT)
    export_c(mission, tmp_path, name="fw", allow_uncertified=True, camera=True, precision="float64")
    firmware = Firmware(tmp_path)
    state = state_at([0.2, -0.1, -1.4], 0.05, -0.08, 0.4)
    law, points = flown_law(mission), np.array(mission.target.points, float).T
    before = np.array(
        ca.evalf(
            law.mount.before(
                *map(ca.SX, map(ca.DM, (points, state[:3], state[6:15].reshape(3, 3).T)))
            )
        )
    )
    assert firmware.watch(0.5) == 0
    firmware.turn([0, 0, 0], 0.01)
    assert firmware.frame((before[:2] / before[2]).T, 0.0) == 0
    _, feature = firmware.turn([0, 0, 0], 0.01)
    assert feature == pytest.approx(seen(mission, state), abs=1e-9)


def test_flights_with_sensors_see_through_the_lens(load):
    mission = load(MOUNT + LENS, {"sensors.pixel_noise": "0.2", "sensors.frame_rate": "30"})
    flown = hp.simulate(mission, duration=15)
    assert flown.attrs["outcome"] == "flown" and flown.attrs["frames_lost"] == 0
    assert np.linalg.norm(flown["position"].values[-1] - GOAL) < 0.02


def test_a_point_outside_of_the_image_is_not_seen(load):
    narrow = {"camera.lens.width": "240", "camera.lens.height": "180", "camera.lens.cx": "120"}
    mission = load(MOUNT + LENS, {**narrow, "camera.lens.cy": "90"})
    assert "left the field of view" in hp.simulate(mission, duration=1).attrs["outcome"]


def test_gains_are_not_proved_with_an_arm_and_the_reason_is_said(load):
    verdict = hp.certify(load("[camera]\nposition = [0.08, 0, 0]\n"))
    assert verdict.status == "undecided"
    assert "not at the centre of mass" in verdict.reason


def test_gains_with_a_camera_that_is_only_turned_are_proved_as_ever(load):
    text = "[camera]\nrotation = [0, 0.17453, 1.5708]\n"
    one, other = (hp.certify(load(more)) for more in ("", text))
    assert one.status == other.status == "proved"
    assert one.margin == other.margin


def test_a_region_of_attraction_is_not_proved_with_an_arm():
    mission = hp.load("x4-flyer", {"camera.position": "[0.01, 0, 0]"})
    verdict = hp.attraction(mission, objective="radius")
    assert verdict.status == "undecided"
    assert "not at the centre of mass" in verdict.reason


def test_a_checker_refuses_what_says_nothing_of_an_arm(load):
    content = json.loads(hp.certify(load()).certificate.text())
    content["mission"]["camera"] = {"position": ["1/50", "0", "0"]}
    content["mission_sha256"] = checker.digest(content["mission"])
    content["sha256"] = checker.digest({k: v for k, v in content.items() if k != "sha256"})
    with pytest.raises(checker.Rejected, match="not at the centre of mass"):
        checker.check(content)


@pytest.fixture(scope="module")
def proved(tmp_path_factory):
    path = tmp_path_factory.mktemp("mounted") / "mounted.toml"
    path.write_text(MISSION + MOUNT.replace("0.08", "0.03"))
    verdict = converge(hp.load(path, {"uncertainty.latency": "0.02", "uncertainty.thrust": "0.1"}))
    assert verdict.proved, verdict.reason
    return verdict


@pytest.mark.slow
def test_theorem_5_covers_an_arm_as_an_error_of_the_feature(proved):
    content = proved.certificate.content
    low, high = map(checker.number, content["domain"]["bounds"])
    said = float(0.03 * (high - low))
    assert f"about {said:.6g}"[:12] in proved.statement
    assert "m from the centre of mass" in proved.statement
    assert content["claim"]["ultimate"]  # it ends near the hover, not at it


@pytest.mark.slow
@pytest.mark.parametrize("position", [["2/25", "0", "0"], ["0", "0", "-1/25"]])
def test_a_longer_arm_than_was_proved_is_rejected(proved, position):
    content = json.loads(proved.certificate.text())
    content["mission"]["camera"]["position"] = position
    content["mission_sha256"] = checker.digest(content["mission"])
    with pytest.raises(checker.Rejected):
        claim = checker.claim_of(content)
        claim.verify()


@pytest.mark.slow
def test_no_arm_within_the_one_proved_breaks_the_bound(proved):
    """|Rᵀ(σ(ξ + R r) - σ(ξ)) + a| against the bound, over positions and attitudes of the domain."""
    mission, content = proved.mission, proved.certificate.content
    low, high = (float(checker.number(x)) for x in content["domain"]["bounds"])
    offset, rng = float(checker.number(content["domain"]["offset"])), np.random.default_rng(4)
    central = mission.model_copy(update={"camera": type(mission.camera)()})
    wanted, worst = LoopNumbers.of(central).goal_centroid, 0.0
    for _ in range(300):
        place = rng.uniform([-0.5, -0.5, -2.2], [0.5, 0.5, -0.6])
        angles = (*rng.uniform(-0.5, 0.5, 2), rng.uniform(-3, 3))
        if np.linalg.norm(seen(central, state_at(place, 0, 0, 0)) - wanted) > offset:
            continue
        state = state_at(place, *angles)
        worst = max(worst, np.linalg.norm(seen(mission, state) - seen(central, state)))
    assert 0 < worst <= 0.03 * (high - low)
