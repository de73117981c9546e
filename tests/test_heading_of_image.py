"""A heading that the image tells: exact as a compass, right when frames are late, the same in C."""

from __future__ import annotations

from fractions import Fraction

import casadi as ca
import numpy as np
import pytest

import hoverproof
from firmware_kit import tool
from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.mission.reading import load
from hoverproof.mission.writing import mission_text
from hoverproof.plant import camera
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.servo.laws.heading import flown_law
from hoverproof.simulation.plan import check_runs_differ
from sampling import mostly_whole
from test_heading import BEST, BOTH, PAPERS, REAL, apart, mission_of, yaw_of

IMAGE = {"goal.heading_from": "image"}
LATE = {"frame_rate": 10, "latency": Fraction("0.1"), "control_rate": 250}


def turned(yaw, roll="0.1", pitch="-0.15"):
    return {"start.rotation": [Fraction(roll), Fraction(pitch), Fraction(yaw)]}


def late(*, gyro):
    return {"sensors": {**LATE, "gyro_turned": gyro}}


def north_of(image, down, points):
    n = len(points)
    seen, rho, target = ca.SX.sym("seen", 2, n), ca.SX.sym("rho", 3), ca.SX.sym("target", 3, n)
    told = ca.Function(
        "north", [seen, rho, target], [camera.north(camera.spherical(seen), rho, target)]
    )
    return np.array(told(np.transpose(image), down, np.transpose(points))).ravel()


def view(draw, points, tilt=0.5):
    """Return an image from above, not farther aside than up, and R, tilted by up to so much."""
    height = draw.uniform(0.5, 8)
    position = np.array([*draw.uniform(-1, 1, 2) * height, -height])
    while True:
        angles = draw.uniform([-tilt, -tilt, -np.pi], [tilt, tilt, np.pi])
        R = np.array(ca.DM(rotation_matrix(*angles)))
        seen = (points - position) @ R
        if (seen[:, 2] > 0.1).all():
            return seen[:, :2] / seen[:, 2:], R


def rotation_by(turn):
    """Return exp(sk(turn)), by Rodrigues' formula."""
    angle = np.linalg.norm(turn)
    K = np.cross(np.eye(3), turn / angle)
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def target(draw, n):
    return np.column_stack([draw.normal(0, 0.3, (n, 2)), np.full(n, draw.normal(0, 0.2))])


# --- what a mission says --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"goal.heading_from": "image"}, r"goal\.heading_from: says where .* give goal\.heading"),
        ({"goal.heading_from": "compass"}, r"goal\.heading_from: says where .* give goal\.heading"),
        (
            {"goal.heading": "1", "goal.heading_from": "sun"},
            r"goal\.heading_from: must be 'compass' or 'image', not 'sun'",
        ),
        (
            {
                "goal.heading": "1",
                "goal.heading_from": "image",
                "target.points": [[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, Fraction("0.1")]],
            },
            r"goal\.heading_from: 'image' needs a target that is flat and level",
        ),
    ],
)
def test_a_source_that_cannot_be_is_refused(overrides, message):
    with pytest.raises(InputError, match=message):
        load("x4-flyer", overrides)


def test_a_compass_that_is_named_is_the_one_left_out():
    plain, named = (
        load("x4-flyer", {"goal.heading": "1", **own})
        for own in ({}, {"goal.heading_from": "compass"})
    )
    assert named.exact() == plain.exact()
    assert flown_law(named) == flown_law(plain)
    assert "heading_from" not in mission_text(named)


def test_the_source_is_written_back_with_its_mission():
    mission = load("x4-flyer", {"goal.heading": "1", **IMAGE})
    assert 'heading_from = "image"' in mission_text(mission)
    assert flown_law(mission).name == "centroid/image/modelled with image"


def test_a_certificate_has_the_bounds_that_it_has_with_a_compass():
    image, compass = (
        certify(load("x4-flyer", {"goal.heading": "0.5", **own})).proved for own in (IMAGE, {})
    )
    content = image.certificate.content
    checker.check(content)
    assert content["mission"]["goal"]["heading_from"] == "image"
    assert content["claim"] == compass.certificate.content["claim"]
    assert "whatever the yaw rate Ω3 is" in image.statement


def test_the_checker_knows_no_other_source():
    content = dict(
        certify(load("x4-flyer", {"goal.heading": "0.5", **IMAGE})).proved.certificate.content
    )
    content["mission"] = {
        **content["mission"],
        "goal": {**content["mission"]["goal"], "heading_from": "compass"},
    }
    content["mission_sha256"] = checker.digest(content["mission"])
    content["sha256"] = checker.digest({k: v for k, v in content.items() if k != "sha256"})
    with pytest.raises(checker.Rejected):
        checker.check(content)


# --- the fit --------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [2, 3, 4, 7])
def test_north_is_exact_from_any_position_at_any_tilt(n):
    draw = np.random.default_rng(n)
    for _ in range(50):
        points = target(draw, n)
        image, R = view(draw, points)
        assert north_of(image, R[2], points) == pytest.approx(R[0], abs=1e-9)


def test_points_in_another_order_tell_another_heading():
    draw = np.random.default_rng(1)
    points = target(draw, 4)
    image, R = view(draw, points)
    assert np.abs(north_of(image[[1, 0, 2, 3]], R[2], points) - R[0]).max() > 0.01


def test_of_a_noisy_image_it_is_the_best_turn_about_the_vertical():
    """The level image, turned by that yaw, is along the pattern more than turned by any other."""
    draw = np.random.default_rng(2)
    for _ in range(20):
        points = target(draw, 5)
        image, R = view(draw, points)
        image += draw.normal(0, 0.01, image.shape)
        north = north_of(image, R[2], points)
        rays = np.column_stack([image, np.ones(5)])
        level = rays / (rays @ R[2])[:, None]
        east = np.cross(R[2], north)
        pattern = points[:, :2] - points[:, :2].mean(axis=0)

        def along(by, level=level, north=north, east=east, pattern=pattern):
            x, y = np.cos(by) * north + np.sin(by) * east, np.cos(by) * east - np.sin(by) * north
            return (np.column_stack([level @ x, level @ y]) * pattern).sum()

        best = along(0)
        assert all(along(by) < best for by in (-3, -1, -1e-3, 1e-3, 1, 3))


def test_a_point_at_the_horizon_leaves_a_heading_that_is_a_number():
    points = np.array([[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, -0.1, 0], [-0.1, 0.1, 0]])
    image = points[:, :2] + [1.0, 0.0]
    for down in ([-np.sqrt(0.5), 0, np.sqrt(0.5)], [-0.8, 0, 0.6]):
        assert np.linalg.norm(north_of(image, down, points)) == pytest.approx(1)
    assert (north_of(np.zeros((4, 2)), [0, 0, 1], points) == 0).all()  # of a point: none


# --- flights --------------------------------------------------------------------------------------


@BOTH
@pytest.mark.parametrize(
    ("yaw", "position"),
    [("-1.4", ["0.3", "0.2", "-1.5"]), ("2.9", ["-0.5", "0.4", "-2"]), ("0", ["0.1", "0", "-1"])],
)
def test_an_ideal_flight_is_the_one_with_a_compass(choices, yaw, position):
    start = {**turned(yaw), "start.position": [Fraction(c) for c in position]}
    image, compass = (
        hoverproof.simulate(mission_of(choices, overrides=start | own), duration=12)
        for own in (IMAGE, {})
    )
    assert image.attrs["outcome"] == compass.attrs["outcome"] == "flown"
    assert image["position"].values == pytest.approx(compass["position"].values, abs=1e-6)
    assert np.unwrap(yaw_of(image)) == pytest.approx(np.unwrap(yaw_of(compass)), abs=1e-6)
    assert yaw_of(image)[-1] == pytest.approx(1.2, abs=1e-4)


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("gyro", [True, False])
def test_from_a_wrong_heading_it_comes_to_the_right_one_with_late_noisy_frames(choices, gyro):
    sensors = {**REAL["sensors"], "gyro_turned": gyro, "gravity_noise": Fraction("0.01")}
    overrides = {**REAL, **IMAGE, **turned("-1.5", "0", "0"), "sensors": sensors}
    flight = hoverproof.simulate(mission_of(choices, overrides=overrides), duration=20)
    assert flight.attrs["outcome"] == "flown"
    last = yaw_of(flight)[-200:]
    assert abs(last.mean() - 1.2) < 0.01
    assert 0 < last.std() < 0.02


@pytest.mark.slow
def test_a_late_heading_is_turned_with_the_gyro():
    by_compass, turning, held = (
        yaw_of(hoverproof.simulate(mission_of(BEST, overrides=own | turned("-1.5")), duration=6))
        for own in (late(gyro=True), late(gyro=True) | IMAGE, late(gyro=False) | IMAGE)
    )
    off, without = (np.abs(yaw - by_compass).max() for yaw in (turning, held))
    assert off < 0.01
    assert without > 5 * off


@pytest.mark.slow
def test_the_errors_of_a_compass_are_not_those_of_the_image():
    biased = {"sensors": {"heading_bias": Fraction("0.3"), "heading_noise": Fraction("0.1")}}
    compass, image = (mission_of(BEST, overrides=biased | own) for own in ({}, IMAGE))
    off = [abs(yaw_of(hoverproof.simulate(m, duration=15))[-1] - 1.2) for m in (compass, image)]
    assert off[0] > 0.01
    assert off[1] < 1e-3
    check_runs_differ(compass, 3)
    with pytest.raises(InputError, match="all 3 flights would be the same"):
        check_runs_differ(image, 3)


@pytest.mark.parametrize("gyro", [True, False])
def test_without_a_compiler_it_has_the_same_bits(gyro):
    tool("cc")
    sensors = {**REAL["sensors"], "gyro_turned": gyro, "gravity_noise": Fraction("0.01")}
    mission = mission_of(BEST, overrides={**REAL, **IMAGE, "sensors": sensors})
    fast, slow = (
        hoverproof.simulate(mission, duration=0.5, **own) for own in ({}, {"compiler": ""})
    )
    assert fast.attrs["machine"] != slow.attrs["machine"]
    assert np.array_equal(fast["euler_angles"].values, slow["euler_angles"].values)
    assert np.array_equal(fast["position"].values, slow["position"].values)


# --- firmware -------------------------------------------------------------------------------------


def made(folder, **options):
    tool("cc")
    mission = mission_of(BEST, overrides=IMAGE)
    hoverproof.export_c(mission, folder, allow_uncertified=True, **options)
    return Firmware(folder), np.array(mission.target.points, float)


@pytest.mark.slow
@pytest.mark.parametrize(("precision", "error"), [("float32", 2e-5), ("float64", 1e-12)])
def test_the_heading_in_c_is_that_of_the_model(tmp_path, precision, error):
    firmware, points = made(tmp_path, precision=precision)
    assert firmware.manifest["law"]["heading"] == "image"
    assert firmware.selftest() == 0
    draw = np.random.default_rng(3)
    for _ in range(50):
        image, R = view(draw, points)
        image += draw.normal(0, 1e-3, image.shape)
        north = north_of(image, R[2], points)
        told = np.array([north[0], np.cross(R[2], north)[0]])
        expected = told / np.linalg.norm(told)
        assert firmware.see_heading(image, R[2]) == pytest.approx(expected, abs=error)


def test_of_a_target_seen_as_a_point_there_is_no_heading_and_the_step_says_so(tmp_path):
    firmware, points = made(tmp_path, precision="float64")
    heading = firmware.see_heading(np.zeros((len(points), 2)), [0, 0, 1])
    assert heading == (0, 0)


@pytest.mark.slow
@pytest.mark.parametrize(("precision", "error"), [("float32", 1e-4), ("float64", 1e-6)])
def test_a_frame_that_is_kept_is_turned_to_the_heading_of_now(tmp_path, precision, error):
    """The vehicle turns at a steady rate about an axis of its own; frames are 40 ms old."""
    firmware, points = made(tmp_path, precision=precision, camera=True)
    assert firmware.watch(0.2) == 0
    rate, dt, steps = np.array([0.3, -0.4, 1.5]), 0.004, 60
    turn = rotation_by(rate * dt)
    R = np.array(ca.DM(rotation_matrix(0.1, 0.05, -0.7)))
    attitudes = [R]
    for _ in range(steps):
        attitudes.append(attitudes[-1] @ turn)
    known = 0
    for k, now in enumerate(attitudes):
        if k % 8 == 0 and k >= 10:
            then = attitudes[k - 10]
            seen = (points - [0.2, -0.1, -1.2]) @ then
            image = seen[:, :2] / seen[:, 2:]
            assert firmware.frame(image, 10 * dt, gravity_direction=then[2]) == 0
        status, _, heading = firmware.turn_heading(rate, dt, now[2])
        if status == 0:
            known += 1
            yaw = np.arctan2(now[1, 0], now[0, 0])
            assert heading == pytest.approx((np.cos(yaw), np.sin(yaw)), abs=error)
    assert known > 40


@pytest.mark.slow
@pytest.mark.parametrize("down", [[0, 0, 0.5], [0, 0, 2], [np.nan, 0, 1], [0, 0, np.inf]], ids=str)
def test_a_frame_without_a_direction_of_gravity_is_refused(tmp_path, down):
    firmware, points = made(tmp_path, camera=True)
    firmware.watch(0.2)
    firmware.turn_heading([0, 0, 0], 0.004, [0, 0, 1])
    assert firmware.frame(points[:, :2], 0.002, gravity_direction=down) == 1
    assert firmware.frame(points[:, :2], 0.002, gravity_direction=[0, 0, 1]) == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("choices", "overrides"),
    mostly_whole([(PAPERS, {}), (BEST, {}), (BEST, REAL), (PAPERS, REAL)], every=2),
)
def test_the_firmware_flies_as_the_simulation_does(choices, overrides):
    tool("cc")
    mission = mission_of(choices, overrides=overrides | IMAGE)
    step = 0.002 if not overrides else None
    assert apart(mission, step) < 0.01


@pytest.mark.parametrize("camera", [False, True])
def test_a_centroid_tells_no_heading(tmp_path, camera):
    mission = mission_of(BEST, overrides=IMAGE)
    with pytest.raises(InputError, match=r"sensing: must be points .* a centroid tells no head"):
        hoverproof.export_c(
            mission, tmp_path, allow_uncertified=True, sensing="centroid", camera=camera
        )


@pytest.mark.parametrize("camera", [False, True])
def test_a_package_with_a_compass_knows_nothing_of_it(tmp_path, camera):
    manifest = hoverproof.export_c(
        mission_of(BEST), tmp_path, allow_uncertified=True, camera=camera
    )
    text = "".join((tmp_path / p).read_text() for p in manifest["files"])
    assert "see_heading" not in text
    assert "north[" not in text
