"""Maps of the start: what is found in a cell is what its own certificate says, if one is asked."""

from __future__ import annotations

import json
import time
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import hoverproof as hp
from command_line import refusal, run
from hoverproof.certification.exponential.proof import converge
from hoverproof.design.atlas_summary import start_summary
from hoverproof.design.axes import NOT_ASKED, axis, cell_mission
from hoverproof.design.start_atlas import (
    PROVED,
    prove_cell,
    row,
    start_chart,
    time_of,
    to_prove,
)
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.show.start_atlas import start_atlas_figure
from hoverproof.spread import collected, count
from small_kit import small_vehicle

LAW = {"law": '{feature = "scaled", goal = "inertial", force = "measured"}'}
GAINS = {"gains": "{k1 = 0.0135, k2 = 65, k3 = 1.6, k4 = 6.3, k_yaw = 0.004}"}
DOUBTS = {"uncertainty": "{thrust = 0.1, latency = 0.02}", "sensors.gyro_turned": "true"}
CHANGES = LAW | GAINS | DOUBTS


@pytest.fixture(scope="module")
def mission(tmp_path_factory):
    path = tmp_path_factory.mktemp("mission") / "small.toml"
    path.write_text(small_vehicle("[4, 16]", "[0.2, 0, -1.3]"))
    return load(path, CHANGES)


@pytest.fixture(scope="module")
def drawn(mission):
    """Draw a map of six cells, those asked for proved."""
    x = axis(mission, "k1", cells=3, of_start=True, ends=(0.005, 0.5))
    y = axis(mission, "thrust", cells=2, of_start=True)
    return x, y, start_chart(mission, x, y, exact=True, processes=1).dataset()


@pytest.mark.slow
def test_a_cell_is_proved_just_where_its_own_mission_is(mission, drawn):
    x, y, atlas = drawn
    time, proved = atlas["settling_time"].values, atlas["proved_time"].values
    verdict = atlas["verdict"].values
    assert np.isfinite(time).any()
    assert np.isnan(time).any()  # with a k1 a hundred times as large nothing is found
    assert ((verdict == PROVED) == np.isfinite(proved)).all()
    assert (verdict[np.isnan(time)] == NOT_ASKED).all()
    asked = np.isfinite(proved)
    assert asked.any()
    assert proved[asked] == pytest.approx(time[asked], rel=0.05)
    i, j = np.argwhere(asked)[0]
    cell = cell_mission(mission, x, y, i, j)
    assert cell.uncertainty.thrust == Fraction(repr(float(y.values[i])))
    alone = converge(cell).proved
    assert alone is not None
    assert float(alone.settling.time) == proved[i, j]  # as `attraction` says of that mission


@pytest.mark.slow
def test_a_row_is_the_same_wherever_it_is_looked_at(mission, drawn):
    x, y, atlas = drawn
    cells = row(mission, x, y, 0.1, None, 1)
    found = [time_of(cell) for cell in cells]
    assert np.isnan(found).tolist() == np.isnan(atlas["settling_time"].values[1]).tolist()


@pytest.mark.slow
def test_no_cell_is_proved_from_where_it_is_not_held(mission, drawn):
    x, y, _ = drawn
    cell = row(mission, x, y, 0.1, None, 0)[2]
    assert cell is not None
    assert np.isnan(time_of(cell))
    assert np.isnan(prove_cell(mission, x, y, (0, 2)))


@pytest.mark.slow
def test_a_map_of_a_start_in_few_numbers_and_as_a_picture(mission, drawn):
    _, _, atlas = drawn
    summed = start_summary(atlas)
    time = atlas["settling_time"].values
    assert summed.found == np.isfinite(time).sum()
    assert summed.time == np.nanmin(time)
    assert summed.soonest.keys() == {"k1", "thrust"}
    assert summed.proved == (atlas["verdict"].values == PROVED).sum() > 0
    words = [text.get_text() for text in start_atlas_figure(mission, atlas).legends[0].get_texts()]
    assert {"no weights found (not refuted)", "proved exactly"} <= set(words)


def counted(item):
    """Count two parts, the second of them late."""
    count()
    time.sleep(0.6)
    count()
    return item


@pytest.mark.parametrize("processes", [1, 2])
def test_parts_are_counted_as_they_are_done(processes):
    told = []
    items = collected(
        counted, [0, 1, 2], processes, None, lambda done, total: told.append((done, total)), 2
    )
    assert items == [0, 1, 2]
    assert told == sorted(told)
    assert told[-1] == (6, 6)
    assert any(done % 2 for done, _ in told)  # told while an item is under way


def test_the_soonest_and_found_cells_beside_others_are_proved():
    nan = np.nan
    time = np.array([[5, 4, 3, nan], [5, 4, 3, nan], [5, 4, 2.5, nan], [1, 4, 3, nan]])
    assert to_prove(time) == [(0, 2), (1, 2), (2, 2), (3, 0), (3, 2)]
    assert to_prove(np.full((2, 2), nan)) == []


def test_a_tolerance_varies_from_nothing_to_twice_and_a_gain_by_three(mission):
    assert axis(mission, "thrust", cells=3, of_start=True).values.tolist() == [0, 0.1, 0.2]
    ends = axis(mission, "k1", cells=3, of_start=True).values
    assert ends[2] / ends[1] == pytest.approx(3, rel=1e-4)
    with pytest.raises(InputError, match="wind cannot vary about 0"):
        axis(mission, "wind", of_start=True)
    with pytest.raises(InputError, match="must be one of k1"):
        axis(mission, "lowest_thrust", of_start=True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--show", "margin"], "--show: is for --theorem gains"),
        (["--weights", "1,1,1,1"], "--weights: is for --theorem gains"),
        (["--x", "level"], "must be one of k1"),
        (["--x", "k1", "--y", "k1"], "must differ from --x"),
        (["--y", "thrust", "--y-range=-0.1,0.2"], "0 or more"),
        (["--out", "nowhere/map.nc"], "nowhere"),
    ],
)
def test_what_is_no_map_of_a_start_is_refused(options, message, capsys):
    assert message in refusal(capsys, "atlas", "crazyflie-2.1", "--theorem", "start", *options)


def test_a_theorem_that_is_none_is_refused_in_python():
    with pytest.raises(InputError, match="gains, start"):
        hp.atlas("x4-flyer", theorem="region")


@pytest.mark.slow
def test_the_command_writes_map_and_figure_and_says_what_is_found_and_what_proved(
    mission, capsys, monkeypatch, drawn, tmp_path
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("hoverproof.design.atlas.start_chart", lambda *_, **__: Kept(drawn[2]))
    words = ["atlas", mission.source, "--theorem", "start", "--x", "k1", "--y", "thrust"]
    words += [f"--set={key}={value}" for key, value in CHANGES.items()]
    said = json.loads(run(capsys, *words, "--json")[1])
    assert said["covers"] == ["latency up to 0.02 s"]  # of thrust the axis tells
    assert said["found"] < said["cells"] == 6
    assert said["proved"] == said["asked_exactly"] > 0
    assert xr.open_dataset(said["out"]).equals(drawn[2])
    assert Path(said["figure"]).stat().st_size > 0
    out = run(capsys, *words)[1]
    assert "(found by search, not proved)" in out
    assert f"{said['proved']} of {said['asked_exactly']} cells at the boundary" in out


class Kept:
    """What was drawn before, as a record that has become a data set."""

    def __init__(self, data):
        self.data = data

    def dataset(self):
        """Return it."""
        return self.data
