"""Pictures of many flights, drawn from flights of this package put together to a batch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from PIL import Image

from hoverproof.mission.reading import load
from hoverproof.show import runs
from hoverproof.show.runs_again import beginning_again
from hoverproof.simulation.flight import simulate, summary
from hoverproof.simulation.runs import simulate_batch

STARTS = [(5, 2.5, -4), (3, -2, -5), (-4, 1, -3), (0.5, 0.5, -6), (2, 2, -2.5), (-3, -3, -4)]
KEPT = ["position", "euler_angles", "lyapunov", "rotor_thrust", "tilt"]
CODES = {"flag_values": [-1, 0, 1], "flag_meanings": "not_flown flown diverged"}


@pytest.fixture(scope="module")
def flights():
    missions = [load("x4-flyer", {"start.position": list(start)}) for start in STARTS]
    return [simulate(mission, duration=800, every=400) for mission in missions]


@pytest.fixture(scope="module")
def batch(flights):
    """All of the flights whole, but one that ends after a quarter and one that was never flown."""
    runs = xr.concat([flight[KEPT] for flight in flights], "run", combine_attrs="drop_conflicts")
    runs = runs.assign_attrs({k: flights[0].attrs[k] for k in ("mission", "goal_position")})
    end = runs["time"].values[-1] / 4
    numbers = xr.DataArray(np.arange(len(flights)), dims="run")
    runs = runs.where((numbers < 4) | ((numbers == 4) & (runs["time"] <= end)))
    return runs.assign(outcome=("run", np.array([0, 0, 0, 0, 1, -1], np.int8), CODES))


@pytest.mark.slow
def test_every_axis_has_its_unit_and_no_legend_covers_data(batch):
    for figure in (runs.fans_figure(batch), runs.starts_figure(batch)):
        figure.draw_without_rendering()
        boxes = [axes.get_window_extent() for axes in figure.axes]
        for axes in figure.axes:
            for label in (axes.get_xlabel(), axes.get_ylabel()):
                assert label.endswith((")", "), down")), label
                assert any(f"({unit}" in label for unit in ("m", "s", "N", "deg", "%", "dim"))
            legends = [axes.get_legend(), *figure.legends]
            for legend in filter(None, legends):
                extent = legend.get_window_extent()
                assert not any(box.overlaps(extent.shrunk(0.98, 0.98)) for box in boxes)
                assert extent.x1 <= figure.bbox.x1


def test_bands_are_percentiles_of_the_runs_that_still_fly(batch):
    axes = runs.fans_figure(batch).axes[0]
    (median,) = (line for line in axes.lines if line.get_label() == "median")
    goal = batch.attrs["goal_position"]
    distance = np.linalg.norm(batch["position"].values - goal, axis=-1)
    early, late = 10, 150
    times = batch["time"].values
    for k, flying in ((early, 5), (late, 4)):
        assert median.get_xdata()[k] == times[k]
        expected = np.median(distance[:flying, k])
        assert median.get_ydata()[k] == pytest.approx(expected, rel=1e-6)
    (band,) = axes.collections
    corners = band.get_paths()[0].vertices
    at = corners[corners[:, 0] == times[late]][:, 1]
    assert [at.min(), at.max()] == pytest.approx(
        np.percentile(distance[:4, late], [5, 95]), rel=1e-6
    )


def test_settled_times_are_the_first_samples_after_those_of_the_single_flights(batch, flights):
    found = runs.settled_times(batch)
    wanted = [summary(flight)["settled_at"] for flight in flights[:4]]
    assert sum(w is not None for w in wanted) >= 2
    interval = float(batch["time"][1])
    for time, exact in zip(found, wanted, strict=False):
        assert np.isnan(time) if exact is None else 0 <= time - exact < interval
    assert np.isnan(found[4:]).all()
    recorded = batch.assign(settled_at=("run", np.arange(6.0)))
    assert runs.settled_times(recorded)[:4].tolist() == [0, 1, 2, 3]


def test_shares_count_every_run_that_was_flown(batch):
    axes = runs.fans_figure(batch).axes[2]
    flying, settled = axes.lines
    assert flying.get_ydata()[0] == 100
    assert flying.get_ydata()[-1] == 80
    done = np.isfinite(runs.settled_times(batch)).sum()
    assert settled.get_ydata()[-1] == pytest.approx(100 * done / 5)
    assert (np.diff(settled.get_ydata()) >= 0).all()


def test_starts_are_coloured_by_outcome_and_counted(batch):
    figure = runs.starts_figure(batch)
    plan = figure.axes[0]
    lines = {line.get_label(): line for line in plan.lines}
    assert np.allclose(lines["diverged: 1"].get_xydata(), [STARTS[4][:2]])
    drawn = np.vstack([line.get_xydata() for name, line in lines.items() if ": " in name])
    assert sorted(map(tuple, drawn.tolist())) == sorted(s[:2] for s in STARTS[:5])
    colours = [line.get_color() for name, line in lines.items() if ": " in name]
    assert len(set(colours)) == len(colours)
    side = figure.axes[1]
    assert side.yaxis_inverted()
    assert plan.yaxis_inverted()


def test_the_beginning_of_runs_is_that_of_the_same_runs_in_more_samples():
    mission = load("x4-flyer", {"scatter.position": "[1, 1, 1]"})
    with simulate_batch(mission, "many.nc", runs=5, seed=3, duration=600).open() as many:
        first = beginning_again(mission, many)
        assert float(first["time"][1]) < float(many["time"][1]) / 10
        kept = many["position"].sel(time=slice(0, float(first["time"][-1])))
        again = first["position"].interp(time=kept["time"])
        assert kept.sizes["time"] > 2
        assert np.abs(kept - again).max() < 1e-3
        figure = runs.fans_figure(many, first)
    tilt = figure.axes[4]
    assert max(line.get_ydata().max() for line in tilt.lines) > 0.05  # degrees, after 1 s
    assert tilt.get_xlim()[1] < 20
    assert "the beginning, a sample each" in tilt.get_xlabel()


def test_the_tilt_of_small_angles_keeps_its_digits(batch):
    axes = runs.fans_figure(batch).axes[4]
    (median,) = (line for line in axes.lines if line.get_label() == "median")
    tilt = np.degrees(batch["tilt"].values[:5, 1])
    assert tilt.max() < 0.1
    assert median.get_ydata()[1] == pytest.approx(np.median(tilt), rel=1e-5)


def test_only_the_position_must_be_there(batch):
    bare = batch[["position"]]
    figure = runs.fans_figure(bare)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "distance from the goal (m)",
        "share of the runs (%)",
        "position (m)",
    ]
    assert runs.outcomes(bare).tolist() == ["flown"] * 6
    assert len(runs.starts_figure(bare.isel(run=slice(0, 5))).axes) == 3


def test_outcomes_may_be_text(batch):
    words = ["flown", "flown", "flown", "flown", "diverged", "not_flown"]
    text = batch.drop_vars("outcome").assign(outcome=("run", words))
    assert runs.outcomes(text).tolist() == words == runs.outcomes(batch).tolist()


@pytest.mark.slow
def test_a_batch_in_a_file_is_drawn_block_by_block(batch, monkeypatch):
    batch.to_netcdf("b.nc", engine="h5netcdf")
    monkeypatch.setattr(runs, "BLOCK", 2)
    with xr.open_dataset("b.nc") as stored:
        paths = runs.save_runs_figures(stored, Path("b"))
    whole = runs.save_runs_figures(batch, Path("w"))
    assert [p.name for p in paths] == ["b.fans.png", "b.starts.png"]
    for ours, theirs in zip(paths, whole, strict=True):
        assert 30_000 < ours.stat().st_size < 2_000_000
        with Image.open(ours) as a, Image.open(theirs) as b:
            assert a.tobytes() == b.tobytes()


@pytest.mark.slow
def test_one_run_and_one_sample_can_be_drawn(batch):
    assert len(runs.save_runs_figures(batch.isel(run=[0]), Path("one"))) == 2
    assert len(runs.save_runs_figures(batch.isel(run=[0], time=[0]), Path("instant"))) == 2


def test_a_batch_of_which_nothing_is_flown_has_no_picture(batch):
    assert runs.save_runs_figures(batch.isel(run=[5]), Path("none")) == []
