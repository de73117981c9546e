"""The camera of a package that keeps frames: a slow and late camera for a fast step."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from command_line import run
from firmware_kit import export, tool
from hoverproof.export.binding import Firmware
from hoverproof.export.vehicle import rate_function
from hoverproof.servo.loop import LoopNumbers
from test_firmware_laws import SQUARE, centroid_of, feature_of, made, mission_of, step_at

DT = 1 / 400
BEST = ("scaled", "inertial", "measured")


def watching(folder, choices=BEST, **options):
    firmware, _ = made(folder, choices, camera=True, precision="float64", **options)
    assert firmware.watch(0.2) == 0
    return firmware


@pytest.fixture(scope="module")
def firmware(tmp_path_factory):
    return watching(tmp_path_factory.mktemp("camera"))


def rates_at(t):
    """A turn about an axis that itself turns, 1 to 2 rad/s."""
    return np.array([1.2 * np.cos(3 * t), 0.9 * np.sin(4 * t), 0.5 + 0.4 * np.sin(2 * t)])


def turns(times):
    """The rotation body to world at each time, by steps much finer than those of the firmware."""
    return turned(tuple(times))


@cache
def turned(times, fine=200):
    rotation, found = Rotation.identity(), [Rotation.identity()]
    for a, b in pairwise(times):
        for k in range(fine):
            t = a + (b - a) * (k + 0.5) / fine
            rotation = rotation * Rotation.from_rotvec(rates_at(t) * (b - a) / fine)
        found.append(rotation)
    return found


def image_at(rotation):
    """The image of directions that are fixed in the world."""
    rays = rotation.inv().apply(np.column_stack([SQUARE, np.ones(4)]))
    return rays[:, :2] / rays[:, 2:]


@pytest.fixture(scope="module", params=[BEST, ("centroid", "image", "modelled")], ids="/".join)
def of_a_law(request, tmp_path_factory):
    return request.param, watching(tmp_path_factory.mktemp("camera"), request.param)


@pytest.mark.slow
@pytest.mark.parametrize("age", [0.0, 0.4 * DT, DT, 2.7 * DT, 20 * DT, 60.5 * DT])
def test_a_frame_of_any_age_is_turned_to_the_step(of_a_law, age):
    choices, firmware = of_a_law
    firmware.watch(0.5)
    times = np.arange(120) * DT
    rotations = turns(times)
    frame_at = 80 - age / DT  # in steps; it comes in before step 80
    before = int(np.floor(frame_at))
    part = times[before] + (frame_at - before) * DT
    (taken,) = turns(np.array([times[before], part]))[1:] or [Rotation.identity()]
    seen = image_at(rotations[before] * taken)
    for k, t in enumerate(times):
        if k == 80:
            assert firmware.frame(seen, age) == 0
        status, feature = firmware.turn(rates_at(t), DT)
        assert status == (2 if k < 80 else 0)
        if k >= 80 and k % 10 == 0:
            wanted = feature_of(image_at(rotations[k]), choices[0])
            assert np.linalg.norm(np.array(feature) - wanted) < 2e-5 * np.linalg.norm(wanted)


def test_turned_the_wrong_way_or_not_at_all_it_would_be_seen(firmware):
    """The turn of the test above is hundreds of times what it allows."""
    there, here = turns(np.arange(61) * DT)[0], turns(np.arange(61) * DT)[-1]
    apart = feature_of(image_at(there), "scaled") - feature_of(image_at(here), "scaled")
    assert np.linalg.norm(apart) > 1e-2 * np.linalg.norm(feature_of(SQUARE, "scaled"))


def test_a_turn_is_a_rotation_about_the_rate(firmware):
    for rate in ([0, 0, 2.0], [1.0, -2.0, 0.5], [20.0, 5.0, -30.0]):
        firmware.watch(0.5)
        firmware.turn(rate, DT)
        assert firmware.frame(SQUARE, DT) == 0
        _, feature = firmware.turn(rate, DT)
        exact = Rotation.from_rotvec(-np.array(rate) * DT).apply(feature_of(SQUARE, "scaled"))
        assert np.linalg.norm(np.array(feature) - exact) < 1e-10 * np.linalg.norm(exact)


def test_a_step_without_a_frame_or_with_one_too_old_is_a_fault(firmware):
    firmware.watch(0.03)
    firmware.reset()
    status, feature = firmware.turn([0, 0, 0], 0.01)
    assert status == 2
    assert step_at(firmware, feature, target_seen=status == 0).status == 2
    assert firmware.frame(SQUARE, 0.005) == 0
    found = []
    for _ in range(5):
        status, feature = firmware.turn([0, 0, 0], 0.01)
        found.append((status, step_at(firmware, feature, target_seen=status == 0).status & 7))
    assert found == [(0, 0), (0, 0), (0, 0), (2, 2), (2, 2)]  # 5, 15, 25, 35, 45 ms


def test_a_frame_that_cannot_be_used_leaves_the_one_that_is_there(firmware):
    firmware.watch(0.2)
    firmware.turn([0, 0, 0], DT)
    for _ in range(10):
        firmware.turn([0, 0, 0], DT)
    assert firmware.frame(SQUARE, DT) == 0
    nan = SQUARE.copy()
    nan[2, 0] = np.nan
    bad = [(nan, DT), (30 * SQUARE * 12, DT), (0 * SQUARE, DT), (SQUARE, -1e-3), (SQUARE, np.nan)]
    bad += [(SQUARE, 0.3), (SQUARE, 2 * DT), (SQUARE, 0.1)]  # too old; older than the other; unkept
    for seen, age in bad:
        assert firmware.frame(seen, age) == 1
    status, feature = firmware.turn([0, 0, 0], DT)
    assert (status, feature) == (0, pytest.approx(tuple(feature_of(SQUARE, "scaled"))))


def test_a_frame_older_than_the_turns_that_are_kept_is_refused(firmware):
    firmware.watch(1.0)
    for k in range(200):
        firmware.turn([0, 0, 0], DT)
        kept = min(k, 64)
        assert firmware.frame(SQUARE, (kept + 1) * DT + 1e-4) == 1
    assert firmware.frame(SQUARE, 65 * DT - 1e-4) == 0


@pytest.mark.parametrize(
    ("rate", "dt"),
    [
        ([np.nan, 0, 0], DT),
        ([0, np.inf, 0], DT),
        ([70, 0, 0], DT),
        ([0, 0, 0], 0.0),
        ([0, 0, 0], np.nan),
        ([0, 0, 0], 0.2),
    ],
)
def test_a_gap_in_the_rates_forgets_the_frame_and_the_turns(firmware, rate, dt):
    firmware.watch(0.2)
    for _ in range(10):
        firmware.turn([0.1, 0, 0], DT)
    assert firmware.frame(SQUARE, DT) == 0
    assert firmware.turn([0.1, 0, 0], DT)[0] == 0
    assert firmware.turn(rate, dt)[0] == 1
    assert firmware.turn([0.1, 0, 0], DT)[0] == 2
    assert firmware.frame(SQUARE, 3 * DT) == 1  # no turn is kept so far back
    assert firmware.frame(SQUARE, 0.5 * DT) == 0


def test_a_turn_of_more_than_half_a_radian_a_step_forgets_the_frame(firmware):
    firmware.watch(0.2)
    firmware.turn([40, 0, 0], 0.01)
    assert firmware.frame(SQUARE, 0.0) == 0
    assert firmware.turn([40, 0, 0], 0.02)[0] == 0  # 0.4 rad
    assert firmware.turn([40, 0, 0], 0.01)[0] == 1  # 0.8 rad
    assert firmware.turn([0, 0, 0], 0.01)[0] == 2


@pytest.mark.parametrize("oldest", [0.0, -1.0, 1.1, np.nan])
def test_a_longest_age_that_cannot_be_uses_no_frame(firmware, oldest):
    assert firmware.watch(oldest) == 1
    firmware.turn([0, 0, 0], DT)
    assert firmware.frame(SQUARE, 0.0) == 1
    assert firmware.turn([0, 0, 0], DT)[0] == 2


def test_a_camera_that_delivers_the_centroid_gives_the_same_feature(tmp_path):
    by_points = watching(tmp_path / "p")
    by_centroid = watching(tmp_path / "c", sensing="centroid")
    for firmware, seen in ((by_points, SQUARE), (by_centroid, centroid_of(SQUARE))):
        firmware.turn([0.3, 0, 0], DT)
        assert firmware.frame(seen, 0.5 * DT) == 0
    features = [f.turn([0.3, 0, 0], DT)[1] for f in (by_points, by_centroid)]
    assert features[0] == pytest.approx(features[1], rel=1e-11)


def test_a_package_with_a_camera_steps_as_one_without(tmp_path):
    plain, kept = (made(tmp_path / str(c), BEST, camera=c)[0] for c in (False, True))
    assert kept.selftest() == 0
    kept.watch(0.2)
    kept.turn([0, 0, 0], 0.001)
    assert kept.frame(SQUARE, 0.0) == 0
    status, feature = kept.turn([0, 0, 0], 0.001)
    rest = {"velocity": [0.1, -0.2, 0.05], "gravity_direction": [0.02, -0.01, 1]}
    a, b = step_at(plain, SQUARE, **rest), step_at(kept, feature, target_seen=status == 0, **rest)
    assert (a.torque, a.thrust_rate) == (
        pytest.approx(b.torque, rel=1e-5),
        pytest.approx(b.thrust_rate, rel=1e-5),
    )


def fly(firmware, mission, frame_rate, latency, *, seconds=3.0, rate=250):
    """Fly in Python: rigid body by RK4, frames seldom and late, a gust that turns the vehicle.

    Return how far, and the errors of the feature that the step has, and of the frame as it came in.
    """
    v, move = mission.vehicle, rate_function()
    vehicle = ca.DM([float(c) for c in (v.mass, v.gravity, *v.inertia)])
    x = LoopNumbers.of(mission).start[:18].copy()
    points = np.array(mission.target.points, float)
    dt, thrust = 1 / rate, float(v.weight)
    firmware.watch(0.5)
    firmware.reset()
    waiting, last, flown, errors = [], None, [], []
    for k in range(int(seconds * rate)):
        R = x[6:15].reshape(3, 3).T
        seen = (points - x[:3]) @ R
        image = seen[:, :2] / seen[:, 2:]
        if k % round(rate / frame_rate) == 0:
            waiting.append((k, image))
        if waiting and (k - waiting[0][0]) * dt >= latency:
            taken, late = waiting.pop(0)
            last = feature_of(late, mission.law.feature)
            assert firmware.frame(late, (k - taken) * dt) == 0
        status, feature = firmware.turn(x[15:18], dt)
        if status:
            assert not flown
            continue  # it stays where it is until the first frame has come
        force = [0, 0, -thrust / float(v.mass)]
        body = {"velocity": x[3:6], "rate": x[15:18], "gravity_direction": R[2]}
        out = firmware.step(feature, dt=dt, specific_force=force, **body)
        assert not out.status & 7
        thrust = out.thrust
        here = feature_of(image, mission.law.feature)
        errors.append([np.linalg.norm(here - feature), np.linalg.norm(here - last)])
        x = rk4(move, x, thrust, out.torque, vehicle, dt)
        if len(flown) == rate // 2:
            x[15:18] += [3.0, -2.0, 1.0]
        flown.append(x[:3].copy())
    return np.array(flown), np.array(errors)


def rk4(move, x, thrust, torque, vehicle, dt):
    def rate(at):
        return np.array(move(at, thrust, list(torque), vehicle)).ravel()

    a = rate(x)
    b = rate(x + dt / 2 * a)
    c = rate(x + dt / 2 * b)
    return x + dt / 6 * (a + 2 * b + 2 * c + rate(x + dt * c))


@pytest.mark.slow
@pytest.mark.parametrize(("frame_rate", "latency"), [(10, 0.1), (25, 0.08), (50, 0.04)])
def test_with_a_slow_and_late_camera_it_flies_and_knows_the_feature(firmware, frame_rate, latency):
    """What is left of the error is what the vehicle has moved; the frame itself is far off."""
    mission = mission_of(BEST)
    best, _ = fly(firmware, mission, 250, 0)
    flown, errors = fly(firmware, mission, frame_rate, latency)
    assert np.linalg.norm(best[: len(flown)] - flown, axis=1).max() < 0.05
    turned, held = errors.max(axis=0)
    assert turned < 0.25 * held


def test_without_the_option_there_is_no_camera(tmp_path):
    tool("cc")
    package = export(tmp_path)
    assert not list(tmp_path.glob("*camera*"))
    assert "camera" not in package.manifest
    assert Firmware(tmp_path).selftest() == 0


def test_the_command_writes_one(tmp_path, capsys):
    status, _, _ = run(capsys, "export", "x4-flyer", "--out", str(tmp_path / "fw"), "--camera")
    assert status == 0
    assert (tmp_path / "fw" / "x4_flyer_camera.c").exists()
