"""When a flight settled and how it ended: noted at each step, the same for one flight and many."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import xarray as xr

from command_line import run
from hoverproof.compilers import find_compiler
from hoverproof.firmware.flying import fly_firmware
from hoverproof.mission.reading import load
from hoverproof.simulation.cut_short import last_good_step, up_to
from hoverproof.simulation.flight import simulate, summary
from hoverproof.simulation.flight_log import OUTCOMES
from hoverproof.simulation.runs import simulate_batch
from papers_law import CRAZYFLIE
from sampling import mostly_whole

SOON = {"start.position": "[0.3, 0.2, -1.2]"}
CONDITIONS = [{}, {"sensors.latency": "0.02"}]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("every", "conditions"), mostly_whole(itertools.product([None, 1, 300], CONDITIONS), every=2)
)
def test_one_flight_and_many_settle_at_the_same_time_whatever_is_kept(conditions, every):
    mission = load(CRAZYFLIE, SOON | conditions)
    one = simulate(mission, duration=30, every=every)
    simulate_batch(mission, "many.nc", runs=2, duration=30)
    at = summary(one)["settled_at"]
    with xr.open_dataset("many.nc", engine="h5netcdf") as many:
        assert many["settled_at"].values.tolist() == [at, at]
    fine = simulate(mission, duration=30, every=1)
    error = np.linalg.norm(fine["position"].values - fine.attrs["goal_position"], axis=1)
    first = round(at / 0.01)
    assert (error[first:] <= 0.1 * error[0]).all()
    assert error[first - 1] > 0.1 * error[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "outcome"),
    [
        ({"model_error.mass": "0.005"}, "hit the height of the target"),
        ({"start.rotation": "[1.5, 0, 0]"}, "tipped over"),
        (
            {"start.velocity": "[0, 0, 9]", "start.position": "[0, 0, -1]"},
            "hit the height of the target",
        ),
        (
            {"start.rotation": "[0.8, 0, 0]", "start.position": "[0, -9, -2]"},
            "a target point came behind the camera",
        ),
        ({"gains.k1": "200", "gains.k2": "300"}, "thrust fell to the singularity"),
    ],
)
@pytest.mark.parametrize("conditions", mostly_whole(CONDITIONS, every=2, first=1))
def test_what_ended_a_flight_is_said_with_its_time_whatever_is_kept(change, outcome, conditions):
    mission = load("x4-flyer", change | conditions)
    told = {simulate(mission, duration=50, every=e).attrs["outcome"] for e in (1, 40, 1000)}
    assert len(told) == 1
    assert outcome in told.pop()
    simulate_batch(mission, "many.nc", runs=2, duration=50)
    with xr.open_dataset("many.nc", engine="h5netcdf") as many:
        for code in many["outcome"].values:
            assert OUTCOMES[code].replace("_", " ") in (outcome, "target point behind the camera")


ENDINGS = [
    {"model_error.mass": "0.005"},
    {"start.rotation": "[1.5, 0, 0]"},
    {"sensors": "{focal_length=400, width=1220, height=1220, out_of_view='abort'}"}
    | {"start.rates": "[0.2, 0, 0]", "gains.k1": "1"},
]


@pytest.mark.parametrize(
    ("change", "compiler"),
    [(ENDINGS[0], None), (ENDINGS[1], None), (ENDINGS[1], ""), (ENDINGS[2], None)],
    ids=["as built", "ideal", "on the virtual machine", "out of view"],
)
def test_a_flight_that_ends_early_is_recorded_up_to_its_end(change, compiler):
    mission = load("x4-flyer", change)
    each = simulate(mission, duration=30, every=1, compiler=compiler)  # nothing lies in between
    assert each.attrs["outcome"] != "flown"
    for every in (None, 1000):
        flight = simulate(mission, duration=3000, every=every, compiler=compiler)
        assert flight.attrs["outcome"] == each.attrs["outcome"]
        told = summary(flight)
        for key in ("duration", "steps", "final_position", "final_error"):
            assert told[key] == summary(each)[key]
        assert told["duration"] == told["steps"] * flight.attrs["step"] > 0
        if every is None:
            assert flight.sizes["time"] >= min(50, told["steps"] + 1)
            assert told["largest_tilt"] == pytest.approx(summary(each)["largest_tilt"], abs=0.02)


@pytest.mark.parametrize("end", [0, 1, 1199, 1200, 1234])
def test_an_end_that_no_log_holds_is_found_at_its_step(end):
    def fly(samples, every):
        good = min(samples, end // every)
        return every * np.arange(good + 1.0)[:, None], good == samples

    for every in (1, 60, 5000):
        rows, whole = fly(10_000 // every, every)
        assert not whole
        assert last_good_step(fly, rows, every, None) == end
        for samples in (None, 100):
            rows_kept, steps = up_to(fly, rows, every, end, samples)
            assert rows_kept[:, 0].tolist() == steps.tolist()
            assert steps[-1] == end
        assert len(steps) >= min(50, end + 1)


def printed(capsys, *arguments):
    status, out, _ = run(capsys, "simulate", *arguments, "--no-figures")
    return status, out.splitlines()


def test_the_command_tells_one_time_of_a_flight_that_ends_early(capsys):
    status, lines = printed(capsys, "x4-flyer", "--set", "model_error.mass=0.005", "--out", "f.nc")
    assert status == 1
    told = summary(xr.open_dataset("f.nc", engine="h5netcdf"))
    time = f"{told['duration']:g} s"
    assert lines[0] == f"x4-flyer: hit the height of the target at {time}"
    ideal = "with ideal sensors and rotors, no wind or errors: not before"
    assert f"  {ideal} {time}" in lines


def test_a_whole_flight_that_misses_its_goal_says_so(capsys):
    status, lines = printed(capsys, "x4-flyer", "--duration", "50")
    away = summary(xr.open_dataset("x4-flyer.flight.nc", engine="h5netcdf"))["final_error"]
    assert status == 0
    assert lines[0] == "x4-flyer: flown, 50 s"
    assert lines[1] == f"  did not come to its goal: {away:.3g} m away at the end"
    status, lines = printed(capsys, "x4-flyer")
    assert status == 0
    assert not [line for line in lines if "goal" in line]


@pytest.mark.slow
def test_without_a_compiler_the_same_is_noted():
    mission = load("x4-flyer", {"model_error.mass": "0.005"})
    ideal = load("x4-flyer", {"start.rotation": "[1.5, 0, 0]"})
    for flown in (mission, ideal):
        told = [simulate(flown, duration=30, compiler=c).attrs["outcome"] for c in (None, "")]
        assert told[0] == told[1] != "flown"


def test_a_flight_that_starts_at_its_goal_has_no_distance_to_settle_within():
    flight = simulate(load("x4-flyer", {"start.position": "[0, 0, -3]"}), duration=5)
    assert flight.attrs["outcome"] == "flown"
    assert summary(flight)["settled_at"] is None


@pytest.mark.skipif(not find_compiler(), reason="no C compiler here")
def test_firmware_says_where_and_why_its_flight_ended():
    rolled = load("x4-flyer", {"start.rotation": "[2, 0, 0]"})
    told = fly_firmware(rolled, duration=5).attrs["outcome"]
    assert "an input out of its box (firmware status 1), 4 m above the target" in told
    assert told.endswith("tilted by 115 degrees")
    assert told.startswith("ended at 0 s")


@pytest.mark.skipif(not find_compiler(), reason="no C compiler here")
def test_a_flight_of_firmware_that_ends_early_is_recorded_up_to_the_fault():
    mission = load("x4-flyer", {"start.rotation": "[1.2, 0, 0]"})
    each, some = (fly_firmware(mission, duration=3000, every=e) for e in (1, None))
    assert some.attrs["outcome"] == each.attrs["outcome"] != "flown"
    assert some.sizes["time"] >= 50
    for key in ("duration", "steps", "final_position"):
        assert summary(some)[key] == summary(each)[key]
