"""The glue for autopilots between stand-ins of their trees: who has the motors, and when."""

from __future__ import annotations

import itertools
import struct
from functools import partial

import numpy as np
import pytest

import harnesses
from firmware_kit import LENS, export, run, tool
from hoverproof.export.adapter import oldest_image
from hoverproof.export.binding import Firmware
from hoverproof.mission.reading import load
from sampling import mostly_whole

BEST = {"law": {"feature": "scaled", "goal": "inertial", "force": "measured"}}
CRAZYFLIE = "crazyflie-2.1"
EITHER = [("float32", False), ("float32", True), ("float64", True), ("float64", False)]
pytestmark = pytest.mark.slow

best = partial(export, mission=CRAZYFLIE, overrides=BEST, allow_uncertified=True)


def compiled(autopilot, compiler, package, folder, *extra, plain=None):
    """Compile the glue for an autopilot with its harness."""
    tool(compiler)
    return getattr(harnesses, autopilot)(package, folder, *extra, plain=plain)


crazyflie = partial(compiled, "crazyflie", "gcc")
px4 = partial(compiled, "px4", "g++")
ardupilot = partial(compiled, "ardupilot", "g++")


def fail_selftest(package):
    """Let the self-test of a package answer that a vector does not hold."""
    source = package.sources[1]
    text = source.read_text()
    assert text.count("  return failed;") == 1
    source.write_text(text.replace("  return failed;", "  return failed + 1U;"))


@pytest.mark.parametrize(("precision", "tunable"), mostly_whole(EITHER, every=2, first=0))
def test_the_crazyflie_flies_by_pid_unless_all_is_well_and_cuts_power_in_one_step(
    precision, tunable, tmp_path
):
    """Null setpoint, disarm, stale and old images, NaN, hand-over both ways, at both parities."""
    package = best(tmp_path / "fw", precision=precision, tunable=tunable)
    assert run(crazyflie(package, tmp_path), "safety").stdout == "safe\n"


def test_without_its_self_test_the_law_never_has_the_crazyflie(tmp_path):
    package = best(tmp_path / "fw")
    fail_selftest(package)
    program = crazyflie(package, tmp_path)
    assert run(program, "sick").stdout == "sick\n"


def test_an_image_is_never_taken_torn(tmp_path):
    package = best(tmp_path / "fw")
    assert run(crazyflie(package, tmp_path), "torn").stdout == "whole\n"


def test_an_image_without_its_sequence_is_torn_and_found_out(tmp_path):
    package = best(tmp_path / "fw")
    controller = package.folder / "adapters" / "crazyflie" / f"controller_{package.name}.c"
    text = controller.read_text()
    whole = "((before & 1U) == 0U) && (before == __atomic_load_n(&sequence, __ATOMIC_RELAXED))"
    assert text.count(whole) == 1
    age = "posted.age = seconds;"  # written late, so that even one busy core finds it out
    assert text.count(age) == 1
    late = f"for (volatile int late = 0; late < 2000; late++) {{ }}\n    {age}"
    controller.write_text(text.replace(whole, "true").replace(age, late))
    with pytest.raises(AssertionError, match=r"image\.(seen|age)"):
        run(crazyflie(package, tmp_path), "torn")


def packed(package, number, first, age, values):
    """Return a packet in hexadecimal, by the words of `struct` that the header gives."""
    header = package.folder / "adapters" / "crazyflie" / f"{package.name}_observe.h"
    (words,) = [w for w in header.read_text().split('"') if w.startswith("<BBH")]
    words = f"<BBH{len(values)}h" if words.endswith("h") else words
    return struct.pack(words, number, first, age, *values).hex()


def test_a_packet_of_the_app_channel_holds_an_image_and_its_age(tmp_path):
    package = best(tmp_path / "fw")
    image = [0.25, -0.5, 0.333, 1.5, -1.75, 0.1, 0.7, -0.9]
    packet = packed(package, 7, 0, 45, [round(8192 * c) for c in image])
    assert len(packet) <= 2 * 30
    program = crazyflie(package, tmp_path)
    taken, age, *seen = run(program, "packets", packet).stdout.split()
    assert taken == "1"
    assert float(age) == pytest.approx(0.045)
    assert [float(c) for c in seen] == pytest.approx(image, abs=1 / 16384 + 1e-7)
    half, twice = packet[: 8 + 16], packet + packet[8:]
    beyond = packed(package, 8, 2, 0, [0] * 6)  # points 2 to 4 of four
    for broken in ("", "0700", half + "ff", twice, beyond):
        assert run(program, "packets", broken).stdout == "0\n"


def test_a_packet_of_raw_pixels_is_seen_through_the_lens(tmp_path):
    package = best(tmp_path / "fw", overrides={**BEST, "camera.lens": LENS}, pixels=True)
    program = crazyflie(package, tmp_path, package.folder / f"{package.name}_lens.c")
    pixels = [[700.125, 480], [100, 400.5], [640, 90], [1200.25, 800]]
    scaled = [round(8 * c) for point in pixels for c in point]
    taken, _, *seen = run(program, "packets", packed(package, 7, 0, 45, scaled)).stdout.split()
    assert taken == "1"
    status, points = Firmware(package.folder).lens(pixels)
    assert status == 0
    assert [float(c) for c in seen] == pytest.approx(points.ravel().tolist(), rel=1e-6)
    past = [*scaled[:-2], 8 * 4000, 8 * 4000]  # no point: the image is left out
    assert run(program, "packets", packed(package, 8, 0, 45, past)).stdout == "1\n"


def test_an_image_of_many_points_comes_in_parts_in_any_order(tmp_path):
    points = [[x / 5, y / 5, 0] for x in range(-1, 2) for y in range(-1, 2)]
    wider = {"target": {"points": points}, "bounds.eigenvalues": "[0.1, 8.0]"}
    package = best(tmp_path / "fw", overrides={**BEST, **wider})
    values = [100 * k for k in range(18)]
    first, second = (packed(package, 3, 0, 20, values[:12]), packed(package, 3, 6, 20, values[12:]))
    stale = packed(package, 2, 6, 20, [0] * 6)
    program = crazyflie(package, tmp_path)
    said = run(program, "packets", first, second, stale, second, first, first).stdout.splitlines()
    assert [line[0] for line in said] == ["0", "1", "0", "0", "1", "0"]
    for line in (said[1], said[4]):
        seen = [float(c) for c in line.split()[2:]]
        assert seen == pytest.approx([v / 8192 for v in values], rel=1e-8)


def test_a_packet_of_a_centroid_is_exact(tmp_path):
    package = best(tmp_path / "fw", sensing="centroid")
    packet = packed(package, 0, 0, 0, [0.1, -0.2, 3.7])
    seen = run(crazyflie(package, tmp_path), "packets", packet).stdout.split()[2:]
    assert np.float32(seen).tolist() == np.float32([0.1, -0.2, 3.7]).tolist()


def holding(first):
    """Hold the height with one share of thrust and one precision in three; all in `make trials`."""
    cases = itertools.product(("float32", "float64"), (0.85, 1, 1.15))
    return pytest.mark.parametrize(
        ("precision", "share"), mostly_whole(cases, every=3, first=first)
    )


def holds_its_height(program, share, late):
    """Fly 20 s with rotors that give that share of what they are told, images at 30 Hz."""
    lowest, highest, x, y = harnesses.flown(program, share, late)
    assert lowest == pytest.approx(-1, abs=0.01)
    assert highest == pytest.approx(-1, abs=0.01)
    assert max(abs(x), abs(y)) < 0.01


@holding(first=0)
def test_the_crazyflie_holds_its_height_by_its_mixer_with_less_and_more_thrust(
    precision, share, tmp_path
):
    package = best(tmp_path / "fw", precision=precision, camera=True)
    plain = best(tmp_path / "plain", name="plain")
    holds_its_height(crazyflie(package, tmp_path, plain=plain), share, 20)


def test_an_image_may_miss_two_frames_of_a_slow_camera():
    slow = load(CRAZYFLIE, {"sensors": {"frame_rate": 9, "latency": 0.06}})
    age, why = oldest_image(slow)
    assert age == 394  # 60 ms and three frames of 1000/9 ms
    assert "the mission's" in why
    assert oldest_image(load(CRAZYFLIE, {"sensors": {"frame_rate": 200}}))[0] == 100
    assert "names no" in oldest_image(load("x4-flyer"))[1]


@pytest.mark.parametrize(("precision", "tunable"), mostly_whole(EITHER, every=2, first=1))
def test_the_mode_of_px4_levels_on_faults_and_says_nothing_in_other_modes(
    precision, tunable, tmp_path
):
    """Armed and in the mode, it publishes at each step; its state is frozen everywhere else."""
    package = best(tmp_path / "fw", precision=precision, tunable=tunable)
    assert run(px4(package, tmp_path), "safety").stdout == "safe\n"


def test_without_its_self_test_the_mode_of_px4_does_not_start(tmp_path):
    package = best(tmp_path / "fw")
    fail_selftest(package)
    assert run(px4(package, tmp_path), "sick").stdout == "sick\n"


def test_px4_makes_the_thrust_and_the_torque_that_are_asked_for(tmp_path):
    """By a control allocation that is scaled as that of PX4 is."""
    said = run(px4(best(tmp_path / "fw"), tmp_path), "scale").stdout.splitlines()
    made, asked = ([float(v) for v in line.split()] for line in said)
    assert made == pytest.approx(asked, rel=1e-6)


@holding(first=2)
def test_px4_holds_its_height_by_its_allocation_with_less_and_more_thrust(
    precision, share, tmp_path
):
    package = best(tmp_path / "fw", precision=precision, camera=True)
    plain = best(tmp_path / "plain", name="plain")
    holds_its_height(px4(package, tmp_path, plain=plain), share, 20)


@pytest.mark.parametrize(("precision", "camera"), mostly_whole(EITHER, every=2, first=0))
def test_ardupilot_gives_the_motors_back_in_the_loop_in_which_they_are_not_the_laws(
    precision, camera, tmp_path
):
    """Failsafe and landing, a missing axis, disarm, ground, stale image, NaN."""
    package = best(tmp_path / "fw", precision=precision, camera=camera)
    plain = best(tmp_path / "plain", name="plain")
    assert run(ardupilot(package, tmp_path, plain=plain), "safety").stdout == "safe\n"


def test_without_its_self_test_the_law_never_has_ardupilot(tmp_path):
    package = best(tmp_path / "fw")
    fail_selftest(package)
    assert run(ardupilot(package, tmp_path), "sick").stdout == "sick\n"


@holding(first=1)
def test_ardupilot_holds_its_height_by_its_mixer_with_less_and_more_thrust(
    precision, share, tmp_path
):
    package = best(tmp_path / "fw", precision=precision, camera=True)
    plain = best(tmp_path / "plain", name="plain")
    holds_its_height(ardupilot(package, tmp_path, plain=plain), share, 8)
