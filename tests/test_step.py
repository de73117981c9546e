"""The step of a flight follows from its loop, and what is beyond reason is refused in figures."""

from __future__ import annotations

import numpy as np
import pytest

from hoverproof import cli
from hoverproof.errors import InputError
from hoverproof.firmware.flying import fly_firmware
from hoverproof.mission.reading import load
from hoverproof.servo.linearised import slowest_rate
from hoverproof.simulation.flight import simulate, without_conditions
from hoverproof.simulation.runs import simulate_batch
from hoverproof.simulation.timing import STEP, fastest_rate, flight_step
from papers_law import CRAZYFLIE, PAPERS

FAST = {"gains.k1": "0.0056", "gains.k2": "4.8", "gains.k3": "0.064", "gains.k4": "8"}
"""Gains for a Crazyflie with an attitude bandwidth of 300 rad/s."""


@pytest.fixture(scope="module")
def fast():
    return load(CRAZYFLIE, FAST)


def test_gains_of_a_high_bandwidth_fly_without_being_told_a_step(fast):
    flight = simulate(fast, duration=5)
    assert flight.attrs["outcome"] == "flown"
    finer = simulate(fast, duration=5, step=flight.attrs["step"] / 10)
    apart = flight["position"].values[-1] - finer["position"].values[-1]
    assert np.abs(apart).max() < 1e-4


@pytest.mark.parametrize("k4", ["0.9", "9", "2700", "2699.5", "26999.93", "1e9"])
def test_however_fast_a_loop_is_there_is_a_step_no_longer_than_its_fastest_motion(k4):
    mission = load(CRAZYFLIE, {"gains.k4": k4})
    assert 0.1 < flight_step(mission, None) * fastest_rate(mission) <= 1


def test_firmware_and_batches_take_the_same_step(fast, tmp_path):
    assert fly_firmware(fast, duration=1).attrs["step"] == flight_step(fast, None)
    flown = simulate_batch(fast, tmp_path / "runs.nc", runs=2, duration=1)
    assert flown.steps == 2 * round(1 / flight_step(fast, None))


@pytest.mark.parametrize("preset", PAPERS.values(), ids=PAPERS)
def test_presets_fly_in_the_steps_that_they_did(preset):
    assert flight_step(load(preset), None) == STEP


def test_the_fastest_motion_is_that_of_the_attitude(fast):
    g, mass = fast.gains, float(fast.vehicle.mass)
    bandwidth = float(g.k1 * g.k2 + g.k3 + g.k4) / mass
    assert fastest_rate(fast) == pytest.approx(bandwidth, rel=0.1)
    assert fastest_rate(fast) > slowest_rate(fast)


def test_a_step_too_long_for_the_loop_is_refused_with_one_that_will_do(fast):
    with pytest.raises(InputError, match=r"step: 0.01 s is too long .* 0.002 s will do"):
        simulate(fast, step=0.01)
    assert simulate(fast, step=0.002, duration=1).attrs["outcome"] == "flown"


@pytest.mark.parametrize(
    ("sensors", "step"),
    [
        ({"control_rate": 500}, 1 / 500),  # no tick is between two steps
        ({"control_rate": 400, "frame_rate": 50}, 1 / 400),
        ({"frame_rate": 200}, 1 / 200),
        ({"control_rate": 30, "frame_rate": 30}, STEP),  # as ever
    ],
)
def test_no_step_is_longer_than_from_tick_to_tick(sensors, step):
    mission = load("x4-flyer", {f"sensors.{k}": v for k, v in sensors.items()})
    assert flight_step(mission, None) == pytest.approx(step)
    assert simulate(mission, duration=1).attrs["outcome"] == "flown"


def test_what_is_lighter_than_modelled_moves_faster_and_gets_a_shorter_step():
    light = load(CRAZYFLIE, {"model_error.mass": "-0.9"})
    assert flight_step(light, None) < STEP


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"duration": 1e12}, r"1e\+14 steps of 0.01 s, of which 2(e\+03|00) are kept \(.* MB\)"),
        ({"step": 1e-9}, r"1.5e\+12 steps of 1e-09 s"),
        ({"duration": 1e12, "every": 10}, r"of which 1e\+13 are kept \(.* GB\)"),
        ({"duration": 9e5, "every": 1}, r"every: would keep .* GB; .* take \d+ or more"),
    ],
)
def test_a_flight_beyond_reason_is_refused_with_its_steps_and_bytes(options, words, tmp_path):
    mission = load("x4-flyer")
    with pytest.raises(InputError, match=words):
        simulate(mission, **options)
    with pytest.raises(InputError, match=words):
        fly_firmware(mission, **options)
    with pytest.raises(InputError, match=words):
        simulate_batch(mission, tmp_path / "runs.nc", runs=2, **options)


@pytest.mark.parametrize("change", [{}, {"wind.drag": "0.1", "wind.mean": "[1, 0, 0]"}])
def test_without_a_compiler_fewer_steps_are_flown_and_the_refusal_says_why(change):
    mission = load("x4-flyer", change)
    with pytest.raises(InputError, match=r"20000 s .* 2e\+06 steps .* without a C compiler: .* 1e"):
        simulate(mission, duration=20_000, compiler="")
    assert simulate(mission, duration=1, compiler="").attrs["outcome"] == "flown"


def test_a_held_controller_is_compared_with_a_loop_that_is_too_fast_for_its_step(fast):
    held = load(CRAZYFLIE, {**FAST, "sensors.control_rate": "100"})
    flight = simulate(held, duration=1)
    assert flight.attrs["step"] == 0.01
    assert flight.attrs["step"] * fastest_rate(fast) > 2
    found = without_conditions(held, flight)
    assert found["compared_until"] == flight["time"].values[-1]
    assert found["greatest_distance_from_ideal"] > 0


def test_a_flight_is_written_though_the_one_it_is_compared_with_is_beyond_reason(tmp_path, capsys):
    out, sets = tmp_path / "f.nc", ("gains.k_yaw=1e6", "sensors.control_rate=100")
    words = ["simulate", CRAZYFLIE, *(w for s in sets for w in ("--set", s)), "--no-figures"]
    with pytest.raises(SystemExit) as end:
        cli.main([*words, "--duration", "1", "--out", str(out)])
    assert end.value.code in (0, 1)
    assert out.exists()
    assert "without sensors" not in capsys.readouterr().out
