"""When a flight settled and how it ended: noted at each step, the same for one flight and many."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from hoverproof.compilers import find_compiler
from hoverproof.firmware import fly_firmware
from hoverproof.mission.reading import load
from hoverproof.simulation.campaign import simulate_batch
from hoverproof.simulation.flight import simulate, summary
from hoverproof.simulation.flight_log import OUTCOMES

SOON = {"start.position": "[0.3, 0.2, -1.2]"}
CONDITIONS = [{}, {"sensors.latency": "0.02"}]


@pytest.mark.parametrize("conditions", CONDITIONS, ids=["ideal", "late frames"])
@pytest.mark.parametrize("every", [None, 1, 300])
def test_one_flight_and_many_settle_at_the_same_time_whatever_is_kept(conditions, every):
    mission = load("crazyflie-2.1", SOON | conditions)
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


@pytest.mark.parametrize(
    ("change", "outcome"),
    [
        ({"model_error.mass": "0.005"}, "reached the target"),
        ({"start.rotation": "[1.5, 0, 0]"}, "tipped over"),
        ({"start.velocity": "[0, 0, 9]", "start.position": "[0, 0, -1]"}, "reached the target"),
        (
            {"start.rotation": "[0.8, 0, 0]", "start.position": "[0, -9, -2]"},
            "a target point came behind the camera",
        ),
        ({"gains.k1": "200", "gains.k2": "300"}, "thrust fell to the singularity"),
    ],
)
@pytest.mark.parametrize("conditions", CONDITIONS, ids=["ideal", "late frames"])
def test_what_ended_a_flight_is_said_with_its_time_whatever_is_kept(change, outcome, conditions):
    mission = load("x4-flyer", change | conditions)
    told = {simulate(mission, duration=50, every=e).attrs["outcome"] for e in (1, 40, 1000)}
    assert len(told) == 1
    assert outcome in told.pop()
    simulate_batch(mission, "many.nc", runs=2, duration=50)
    with xr.open_dataset("many.nc", engine="h5netcdf") as many:
        for code in many["outcome"].values:
            assert OUTCOMES[code].replace("_", " ") in (outcome, "target point behind the camera")


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
