"""The batch kernel: each lane is the scalar run, bit for bit; noise is counted, not streamed."""

from __future__ import annotations

import shutil
import subprocess

import numpy as np
import pytest
from scipy import stats

from hoverproof.mission.reading import load
from hoverproof.servo.loop import LoopNumbers
from hoverproof.simulation import compiled, kernel, noise
from hoverproof.simulation.flight import simulate
from hoverproof.simulation.realistic import Features, realistic_loop
from hoverproof.simulation.step import flight_states

needs_compiler = pytest.mark.skipif(not compiled.find_compiler(), reason="no C compiler here")
TILTED = {"start.rotation": "[0.1, -0.05, 0.4]", "start.rates": "[0.1, -0.1, 0.2]"}
SCHEDULE = kernel.Schedule(samples=20, every=50)


@pytest.fixture(scope="module")
def flights():
    """Numbers of a mission, and 21 scattered starts, one of them too low to go on."""
    numbers = LoopNumbers.of(load("x4-flyer", TILTED))
    starts = np.tile(numbers.start, (21, 1))
    starts[:, :3] += np.random.default_rng(0).uniform(-1, 1, (21, 3))
    starts[5, 2] = -0.1
    starts = flight_states(starts, numbers.goal, numbers.points)
    parameters = np.tile(np.r_[numbers.design, 0.01, 0.25, 0.01], (21, 1))
    return numbers, starts, parameters


@pytest.fixture(scope="module")
def flown(flights):
    numbers, starts, parameters = flights
    return kernel.fly(kernel.ideal_loop(4), SCHEDULE, starts, parameters, numbers.points)


def test_each_lane_has_the_bits_of_the_scalar_run(flights, flown):
    numbers, starts, _ = flights
    records, memory, taken = flown
    scalar = compiled.runner(4)
    for i, start in enumerate(starts):
        states, good = scalar.run(start, numbers.design, numbers.points, 0.01, 20, 50)
        assert good == (taken[i] == 20)
        assert np.array_equal(records[i, 1 : taken[i] + 1, :19], states[: taken[i], :19])
        assert np.array_equal(memory[i], states[-1])
    assert taken[5] < 20
    assert sorted(taken)[1] == 20


def test_what_comes_after_the_end_of_a_flight_is_marked(flown):
    records, _, taken = flown
    for record, good in zip(records, taken, strict=True):
        assert np.isfinite(record[: good + 1]).all()
        assert np.isnan(record[good + 1 :]).all()


@needs_compiler
@pytest.mark.parametrize("lanes", [2, 4, 8])
def test_lane_width_and_grouping_change_no_bit(flights, flown, lanes):
    numbers, starts, parameters = flights
    loop, points = kernel.ideal_loop(4), numbers.points
    parts = [
        kernel.fly(loop, SCHEDULE, starts[part], parameters[part], points, lanes=lanes)
        for part in (slice(0, 3), slice(3, 14), slice(14, 21))
    ]
    for whole, pieces in zip(flown, zip(*parts, strict=True), strict=True):
        assert np.array_equal(whole, np.concatenate(pieces), equal_nan=True)


def test_the_virtual_machine_has_the_same_bits(flights, flown):
    numbers, starts, parameters = flights
    loop = kernel.ideal_loop(4)
    slow = kernel.fly(loop, SCHEDULE, starts, parameters, numbers.points, compiler="")
    for a, b in zip(flown, slow, strict=True):
        assert np.array_equal(a, b, equal_nan=True)
    assert kernel.machine(loop, SCHEDULE, "") == "CasADi virtual machine"


@pytest.mark.parametrize("compiler", [pytest.param(None, marks=needs_compiler), ""])
def test_a_flag_ends_the_flights(flights, compiler):
    numbers, starts, parameters = flights
    stop = kernel.Stop()
    stop.set()
    loop, endless = kernel.ideal_loop(4), kernel.Schedule(samples=1, every=10**12)
    flights = starts[:1], parameters[:1], numbers.points
    with pytest.raises(kernel.Stopped):
        kernel.fly(loop, endless, *flights, stop=stop, compiler=compiler)


def test_without_a_compiler_the_noise_of_many_steps_is_drawn_at_once(monkeypatch):
    draws = []

    def counted(counter, seed):
        draws.append(counter)
        return noise.normals(counter, seed)

    monkeypatch.setattr(kernel, "normals", counted)
    gusty = load("x4-flyer", {"wind.drag": "0.1", "wind.gust": "0.5"})
    simulate(gusty, duration=5, compiler="")
    assert 0 < len(draws) < 10


ALL = Features(camera_noise=True, rounded=True, imu_noise=True, gusts=True, abort=True)


@pytest.mark.slow
@needs_compiler
@pytest.mark.parametrize("n", [2, 3, 7])
def test_every_loop_compiles_for_any_number_of_points(n):
    for loop in (kernel.ideal_loop(n), realistic_loop(n, Features()), realistic_loop(n, ALL)):
        assert kernel.machine(loop, SCHEDULE).startswith("compiled C")


@pytest.mark.skipif(not shutil.which("clang"), reason="no second compiler here")
def test_another_compiler_gives_the_same_bits(flights, flown):
    numbers, starts, parameters = flights
    loop = kernel.ideal_loop(4)
    assert kernel.machine(loop, SCHEDULE, "clang").startswith("compiled C")
    other = kernel.fly(loop, SCHEDULE, starts, parameters, numbers.points, compiler="clang")
    for a, b in zip(flown, other, strict=True):
        assert np.array_equal(a, b, equal_nan=True)


@needs_compiler
@pytest.mark.parametrize("ideal", [True, False])
def test_the_vector_code_compiles_without_a_warning_of_ours(ideal):
    loop = kernel.ideal_loop(4) if ideal else realistic_loop(4, ALL)
    command = [compiled.find_compiler(), "-std=gnu11", "-march=native", "-Wall", "-Wextra"]
    quiet = ["-Wno-unused-function", "-Wno-unused-parameter", "-Wno-attributes"]
    done = subprocess.run(
        [*command, *quiet, "-fsyntax-only", "-x", "c", "-"],
        input=kernel.source(loop, SCHEDULE),
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""


F = 0xFFFFFFFF


@pytest.mark.parametrize(
    ("counter", "key", "words"),
    [
        ((0, 0, 0, 0), 0, (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
        ((F, F, F, F), F << 32 | F, (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD)),
        (
            (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
            0x299F31D0_A4093822,
            (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
        ),
    ],
)
def test_philox_gives_the_known_answers_of_its_authors(counter, key, words):
    assert tuple(int(w) for w in noise.philox(counter, key)) == words


def test_the_normal_numbers_are_normal_and_independent():
    a, b = noise.normals((np.arange(200_000), 7, 3, 0), seed=5)
    c, _ = noise.normals((np.arange(200_000), 8, 3, 0), seed=5)
    for x in (a, b, c):
        assert stats.kstest(x, "norm").pvalue > 1e-3
    assert np.abs(np.corrcoef([a, b, c, np.roll(a, 1)]) - np.eye(4)).max() < 0.01


def test_the_normal_numbers_are_those_of_box_and_muller():
    counter = (np.arange(1000), 0, 0, 0)
    u, v = noise.uniforms(counter, 1)
    a, b = noise.normals(counter, 1)
    assert np.abs(a - np.sqrt(-2 * np.log(u)) * np.cos(2 * np.pi * v)).max() < 1e-11
    assert np.abs(b - np.sqrt(-2 * np.log(u)) * np.sin(2 * np.pi * v)).max() < 1e-11


@needs_compiler
def test_the_rotation_stays_a_rotation_over_a_million_steps(flights):
    numbers, starts, parameters = flights
    starts = starts[:4].copy()
    starts[:, 15:18] = [0.5, -0.3, 1]
    parameters = parameters[:4].copy()
    parameters[:, 9] = 1e-9  # no yaw damping: it turns all the time
    schedule = kernel.Schedule(samples=100, every=10_000)
    records, _, taken = kernel.fly(
        kernel.ideal_loop(4), schedule, starts, parameters, numbers.points
    )
    assert (taken == 100).all()
    assert (np.abs(records[:, -1, 17]) > 0.9).all()
    R = records[..., 6:15].reshape(4, 101, 3, 3)
    assert np.abs(R @ R.swapaxes(-1, -2) - np.eye(3)).max() < 1e-12
