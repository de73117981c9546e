"""Many flights in one file: the same bytes however they are flown, and whole whatever happens."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from command_line import run
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.simulation import plan
from hoverproof.simulation.draws import memory_and_parameters
from hoverproof.simulation.flight import simulate
from hoverproof.simulation.runs import runs_summary, simulate_batch
from hoverproof.spread import spread

SCATTER = {"scatter.position": "[1, 1, 0.5]", "scatter.rotation": "[0.05, 0.05, 1]"}
NOISY = SCATTER | {
    "sensors": "{frame_rate = 30, latency = 0.05, focal_length = 400, pixel_noise = 1, "
    "width = 1220, height = 1220, gyro_noise = 0.001, gyro_bias = 0.001}",
    "wind": "{gust = 0.05, drag = 0.1}",
    "scatter.mass": "0.001",
}


@pytest.fixture(params=[SCATTER, NOISY], ids=["ideal", "noisy"])
def mission(request):
    return load("x4-flyer", request.param)


def fly(mission, path, runs=50, duration=20, **options):
    options = {"seed": 7, "every": 100} | options
    return simulate_batch(mission, path, runs=runs, duration=duration, **options)


@pytest.mark.slow
def test_threads_and_blocks_change_no_byte(mission, monkeypatch):
    fly(mission, "a.nc", threads=1)
    monkeypatch.setattr(plan, "STEPS_IN_A_BLOCK", 2000 * 16)
    fly(mission, "b.nc", threads=2)
    fly(mission, "c.nc", threads=1)
    assert Path("a.nc").read_bytes() == Path("b.nc").read_bytes() == Path("c.nc").read_bytes()


@pytest.mark.slow
def test_another_seed_gives_other_flights_and_a_run_does_not_depend_on_how_many(mission):
    fly(mission, "a.nc")
    fly(mission, "b.nc", seed=8)
    fly(mission, "c.nc", runs=20)
    a, b, c = (xr.load_dataset(f"{name}.nc") for name in "abc")
    assert (a["position"][:, 0] != b["position"][:, 0]).all()
    xr.testing.assert_identical(a.isel(run=slice(20)).drop_attrs(), c.drop_attrs())


def test_without_scatter_each_run_of_a_batch_is_the_single_flight(x4):
    fly(x4, "a.nc", runs=3, precision="float64")
    single = simulate(x4, duration=20, every=100)
    with xr.open_dataset("a.nc") as many:
        for name in ("position", "velocity", "euler_angles", "body_rate", "thrust"):
            for run in range(3):
                assert np.array_equal(many[name][run], single[name]), name
        assert many["lyapunov"][0].values == pytest.approx(single["lyapunov"].values, rel=1e-13)


def test_a_single_flight_is_not_scattered(x4):
    scattered = simulate(load("x4-flyer", {"scatter.mass": "0.01"}), duration=2)
    assert np.array_equal(scattered["position"], simulate(x4, duration=2)["position"])


def test_vehicles_differ_as_the_scatter_says():
    scattered = plan.Plan(load("x4-flyer", {"scatter.mass": "0.01"}), 0.01, 1, 1)
    _, params = memory_and_parameters(scattered, np.arange(2000))
    assert not scattered.ideal
    mass = params[:, 13] / 9.6 - 1
    assert np.abs(mass).max() == pytest.approx(0.01, rel=0.01)
    assert mass.std() == pytest.approx(0.01 / 3**0.5, rel=0.05)
    assert (params[:, 0] == 9.6).all()  # the controller's own


def test_the_scatter_is_what_the_mission_says():
    scatter = {"scatter.position": "[1, 2, 0.5]", "scatter.rates": "[0, 0, 0.1]"}
    for kind, deviation in (("uniform", 1 / 3**0.5), ("normal", 1)):
        mission = load("x4-flyer", scatter | {"scatter.distribution": f'"{kind}"'})
        fly(mission, "a.nc", runs=4000, duration=0.02, every=1)
        start = xr.load_dataset("a.nc").isel(time=0)
        offset = start["position"].values - [5, 2.5, -4]
        assert offset.std(axis=0) == pytest.approx(np.array([1, 2, 0.5]) * deviation, rel=0.04)
        assert np.abs(offset.mean(axis=0)).max() < 0.1
        if kind == "uniform":
            assert np.abs(offset).max(axis=0) == pytest.approx([1, 2, 0.5], rel=0.01)
        assert start["body_rate"].values[:, 2].std() == pytest.approx(0.1 * deviation, rel=0.04)
        assert not start["body_rate"].values[:, :2].any()


def test_a_resumed_file_has_the_bytes_of_an_uninterrupted_one(mission, monkeypatch):
    monkeypatch.setattr(plan, "STEPS_IN_A_BLOCK", 2000 * 16)
    fly(mission, "whole.nc")

    def interrupt(complete, _):
        if complete >= 32:
            raise KeyboardInterrupt

    flown = fly(mission, "part.nc", progress=interrupt)
    assert (flown.interrupted, flown.runs_complete) == (True, 32)
    with xr.open_dataset("part.nc") as part:
        assert part.attrs["runs_complete"] == 32
        assert (part["outcome"][:32] >= 0).all()
        assert (part["outcome"][32:] == -1).all()
        assert part["position"][32:].isnull().all()
    flown = fly(mission, "part.nc", resume=True)
    assert (flown.interrupted, flown.runs_complete, flown.steps) == (False, 50, 18 * 2000)
    assert Path("part.nc").read_bytes() == Path("whole.nc").read_bytes()
    assert fly(mission, "part.nc", resume=True).steps == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seed": 9}, "another seed.*7 there, 9 here"),
        ({"runs": 60}, "with other runs"),
        ({"every": 50}, "(other samples|another every)"),
        ({"precision": "float64"}, "another precision"),
    ],
)
def test_only_the_same_batch_is_resumed(x4, change, message):
    fly(x4, "a.nc")
    before = Path("a.nc").read_bytes()
    with pytest.raises(InputError, match=message):
        fly(x4, "a.nc", **({"resume": True} | change))
    with pytest.raises(InputError, match="another mission"):
        fly(load("x4-flyer", {"gains.k4": "4"}), "a.nc", resume=True)
    with pytest.raises(InputError, match="with other conditions"):
        fly(load("x4-flyer", SCATTER), "a.nc", resume=True)
    assert Path("a.nc").read_bytes() == before


def test_what_is_no_batch_is_not_resumed(x4):
    with pytest.raises(InputError, match="no such file"):
        fly(x4, "none.nc", resume=True)
    Path("text.nc").write_text("not a batch")
    with pytest.raises(InputError, match="is not the file of a batch"):
        fly(x4, "text.nc", resume=True)


def test_every_number_that_is_missing_is_marked_and_explained():
    change = {"scatter.position": "[1, 1, 6]", "gains.k1": "2"}  # some start below the target
    fly(load("x4-flyer", change), "a.nc", runs=100, duration=400, every=500)
    with xr.open_dataset("a.nc", decode_cf=False) as raw:
        outcome, until = raw["outcome"].values, raw["flown_until"].values
        words = dict(
            zip(
                raw["outcome"].attrs["flag_values"],
                raw["outcome"].attrs["flag_meanings"].split(),
                strict=True,
            )
        )
        ends = {words[o] for o in outcome}
        assert {"flown", "hit_the_height_of_the_target"} <= ends
        assert ends <= {"flown", "hit_the_height_of_the_target", "target_point_behind_the_camera"}
        after = raw["time"].values[None] > until[:, None]
        assert after.any()
        for name in raw.data_vars:
            values = raw[name].values
            if values.dtype.kind == "f" and np.isnan(values).any():
                assert np.isnan(raw[name].attrs["_FillValue"])
            if values.ndim > 1:
                assert (np.isnan(values).reshape(*after.shape, -1).all(axis=2) == after).all()
        ended = outcome != 0
        assert np.isnan(raw["settled_at"].values[ended]).all()
        assert np.isfinite(raw["final_error"].values).all()
        assert "units" in raw["position"].attrs
    told = runs_summary("a.nc")
    assert sum(told["outcomes"][name] for name in ends) == 100


def test_a_seed_that_is_no_key_is_refused(x4):
    with pytest.raises(InputError, match="seed: must be from 0"):
        simulate(x4, duration=1, seed=-1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"runs": 0}, "runs: must be from 1"),
        ({"seed": -1}, "seed: must be from 0"),
        ({"threads": 0}, "threads: must be from 1"),
        ({"precision": "float16"}, "precision"),
        ({"duration": -1}, "duration"),
    ],
)
def test_impossible_batches_are_refused(x4, options, message):
    with pytest.raises(InputError, match=message):
        fly(x4, "a.nc", **options)
    assert not Path("a.nc").exists()


def run_in_python(code, *arguments):
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False
    )


FULL = """
import resource, sys
from hoverproof import cli
resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
cli.main(["simulate", "x4-flyer", "--runs", "1000", "--duration", "10",
          "--set", "scatter.position=[1,1,1]", "--out", "x4-flyer.flights.nc"])
"""


def test_a_full_disk_shows_before_the_first_flight_and_leaves_nothing():
    Path("x4-flyer.flights.nc").write_text("old")
    done = run_in_python(FULL)
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert "x4-flyer.flights.nc: cannot be written" in done.stderr
    assert "no room for 15 MB" in done.stderr
    assert [p.name for p in Path.cwd().iterdir()] == ["x4-flyer.flights.nc"]
    assert Path("x4-flyer.flights.nc").read_text() == "old"


LATE = """
import resource
from hoverproof import cli
from hoverproof.simulation import plan, results

plan.STEPS_IN_A_BLOCK = 100 * 16
write = results.RunsFile.write


def until_the_disk_is_full(self, block):
    if self.runs_complete == 32:
        resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, resource.RLIM_INFINITY))
    write(self, block)


results.RunsFile.write = until_the_disk_is_full
cli.main(["simulate", "x4-flyer", "--runs", "100", "--duration", "1", "--every", "1",
          "--set", "scatter.position=[1,1,1]", "--out", "x4-flyer.flights.nc"])
"""


@pytest.mark.slow
def test_a_disk_that_fails_later_keeps_what_is_complete():
    done = run_in_python(LATE)
    assert done.returncode == 2, done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert "cannot be written" in done.stderr
    assert "32 runs are complete" in done.stderr
    told = runs_summary("x4-flyer.flights.nc")
    assert told["runs_complete"] == told["outcomes"]["flown"] == 32
    options = {"runs": 100, "duration": 1, "every": 1, "seed": 0}
    mission = load("x4-flyer", {"scatter.position": "[1,1,1]"})
    simulate_batch(mission, "x4-flyer.flights.nc", resume=True, **options)
    simulate_batch(mission, "whole.nc", **options)
    assert Path("x4-flyer.flights.nc").read_bytes() == Path("whole.nc").read_bytes()


@pytest.mark.slow
def test_ctrl_c_keeps_what_is_complete():
    command = [sys.executable, "-m", "hoverproof", "simulate", "x4-flyer", "--runs", "100000"]
    options = ["--duration", "400", "--every", "20000", "--set", "scatter.mass=0.001", "--json"]
    options += ["--out", "x4-flyer.flights.nc"]
    process = subprocess.Popen(
        [*command, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    path = Path("x4-flyer.flights.nc")
    for _ in range(600):
        time.sleep(0.1)
        if path.exists() and runs_summary(path)["runs_complete"]:
            break
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert process.returncode == 130, err
    told = json.loads(out)
    assert told["interrupted"]
    assert 0 < told["runs_complete"] < 100_000
    assert told["outcomes"]["flown"] == told["runs_complete"]


COMMAND = ["--runs", "20", "--duration", "30", "--set", "scatter.position=[1,1,1]"]


@pytest.mark.slow
def test_the_command_says_what_became_of_the_runs(capsys):
    for extra in ([], ["--json"]):
        status, out, _ = run(capsys, "simulate", "x4-flyer", *COMMAND, *extra)
        assert status == 0
    told = json.loads(out)
    assert told["outcomes"]["flown"] == 20
    assert told["steps"] == 20 * 3000
    status, _, err = run(capsys, "simulate", "x4-flyer", "--resume")
    assert status == 2
    assert "--resume: is for --runs" in err


def test_work_is_spread_in_order_and_stopped_when_nobody_wants_it():
    stopped = []
    squares = spread(lambda x: x * x, range(100), threads=3)
    assert list(squares) == [x * x for x in range(100)]
    half = spread(lambda x: x, iter(range(10**9)), threads=2, stop=lambda: stopped.append(1))
    assert [next(half) for _ in range(3)] == [0, 1, 2]
    half.close()
    assert stopped == [1]


GROW = """
import resource, sys
from hoverproof.mission.reading import load
from hoverproof.simulation.runs import simulate_batch
simulate_batch(load("x4-flyer"), "a.nc", runs=int(sys.argv[1]), duration=2, every=1)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@pytest.mark.slow
def test_memory_does_not_grow_with_the_runs():
    few, many = (
        int(run_in_python(GROW, runs).stdout)
        for runs in ("3000", "9000")  # 44 and 131 MB
    )
    assert many < few + 60_000  # kB
