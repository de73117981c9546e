"""Maps of what is certified: every cell means what `certify` says of it."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from command_line import run
from hoverproof.certification.gains import certify
from hoverproof.design.atlas import (
    QUANTITIES,
    VERDICTS,
    atlas,
    axis,
    cell_values,
)
from hoverproof.design.axes import NOT_ASKED, cell_mission, on_boundary
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.paper.conditions import printed_demands, where_met
from hoverproof.show.atlas import atlas_figure
from sampling import mostly_whole

BY_LEVEL = {"bounds": "{eigenvalues = [0.01, 5], level = 10}"}
OFF_AXIS = {"goal": "{centroid = [0.3, 0.2, 3.5]}"}
PAIRS = [
    ({}, "k1", "k2"),
    ({}, "k4", "k3"),
    ({}, "lowest_eigenvalue", "highest_eigenvalue"),
    ({}, "lowest_thrust", "k1"),
    ({}, "highest_thrust", "k4"),
    (BY_LEVEL, "level", "k2"),
    (OFF_AXIS, "k1", "k4"),
]


def agree(mission, x, y, drawn, cells):
    """Compare cells with `certify` on a mission loaded anew; return what kinds were seen."""
    kinds = set()
    for i, j in cells:
        margin = float(drawn["margin"].values[i, j])
        setting = {}
        for one, place in ((x, j), (y, i)):
            value, quantity = repr(float(one.values[place])), one.quantity
            if quantity.end is not None:
                held = setting.get(quantity.key) or [
                    repr(float(v)) for v in getattr(mission.bounds, quantity.key.split(".")[1])
                ]
                held[quantity.end] = value
                setting[quantity.key] = held
            else:
                setting[quantity.key] = value
        texts = {
            key: f"[{', '.join(v)}]" if isinstance(v, list) else v for key, v in setting.items()
        }
        try:
            verdict = certify(load("x4-flyer", mission_changes(mission) | texts))
        except InputError:
            assert np.isnan(margin)
            kinds.add("none")
            continue
        kinds.add(verdict.status)
        assert verdict.status == ("proved" if margin > 0 else "refuted")
        assert margin == pytest.approx(float(verdict.margin_above), rel=1e-6)
    return kinds


def mission_changes(mission):
    changes = BY_LEVEL if mission.bounds.level is not None else {}
    return changes | (OFF_AXIS if mission.goal.centroid is not None else {})


@pytest.mark.slow
@pytest.mark.parametrize(("change", "across", "along"), PAIRS)
def test_random_cells_agree_with_certify(change, across, along):
    mission = load("x4-flyer", change)
    x = axis(mission, across, cells=12)
    y = axis(mission, along, cells=11, option="--y")
    drawn = atlas(mission, x, y, processes=1)
    assert drawn["margin"].shape == (11, 12)
    rng = np.random.default_rng(3)
    cells = np.stack([rng.integers(0, 11, 12), rng.integers(0, 12, 12)], axis=1)
    assert agree(mission, x, y, drawn, cells)


@pytest.mark.slow
@pytest.mark.parametrize(("change", "across", "along"), mostly_whole(PAIRS[:2], every=2))
def test_many_random_cells_of_a_full_atlas_agree_with_certify(change, across, along, whole):
    """Of each map 30, and 250 with `make trials`."""
    mission = load("x4-flyer", change)
    x, y = axis(mission, across), axis(mission, along)
    drawn = atlas(mission, x, y)
    rng = np.random.default_rng(5)
    cells = rng.integers(0, 200, (250 if whole else 30, 2))
    assert {"proved", "refuted"} <= agree(mission, x, y, drawn, cells)


@pytest.mark.slow
def test_cells_at_the_boundary_are_decided_exactly_and_in_any_number_of_processes(x4):
    x, y = axis(x4, "k3", cells=12), axis(x4, "k4", cells=12)
    drawn = atlas(x4, x, y, exact=True, processes=2)
    margin, verdict = drawn["margin"].values, drawn["verdict"].values
    assert ((verdict != NOT_ASKED) == on_boundary(margin)).all()
    asked = verdict != NOT_ASKED
    assert set(np.unique(verdict[asked])) == {-1, 1}
    assert (np.sign(margin[asked]) == verdict[asked]).all()
    i, j = np.argwhere(verdict == VERDICTS["refuted"])[0]
    assert certify(cell_mission(x4, x, y, i, j)).status == "refuted"
    alone = atlas(x4, x, y, exact=True, processes=1)
    assert alone.identical(drawn)


def test_the_boundary_lies_between_neighbours_of_unlike_sign():
    margin = np.array([[1.0, 1.0, -1.0], [1.0, np.nan, -1.0], [2.0, 3.0, np.nan]])
    expected = np.array([[0, 1, 1], [0, 0, 0], [0, 0, 0]], bool)
    assert (on_boundary(margin) == expected).all()


def test_cells_are_short_decimals_that_stay_apart(x4):
    for name in QUANTITIES:
        mission = load("x4-flyer", BY_LEVEL) if name == "level" else x4
        values = axis(mission, name).values
        assert (np.diff(values) > 0).all()
        assert all(Fraction(repr(float(v))).denominator <= 10**9 for v in values)
    close = axis(x4, "k1", ends=(0.2, 0.20001), cells=500).values
    assert (np.diff(close) > 0).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"name": "k9"}, "must be one of k1"),
        ({"name": "level"}, "gives bounds.thrust instead"),
        ({"name": "k1", "ends": (2.0, 1.0)}, "in order"),
        ({"name": "k1", "ends": (-1.0, 1.0)}, "from 1e-12 to"),
        ({"name": "k1", "cells": 1}, "from 2 to 5000"),
    ],
)
def test_an_axis_that_cannot_be_used_is_refused(x4, options, message):
    with pytest.raises(InputError, match=message):
        axis(x4, **options)


def test_two_axes_of_the_same_quantity_are_refused(x4):
    with pytest.raises(InputError, match="must differ"):
        atlas(x4, "k1", "k1")


def test_the_printed_conditions_are_those_that_certify_reports():
    heavy = {"vehicle.mass": "10000", "goal": "{centroid = [0, 0, 1]}"}
    bounds = {"bounds": "{eigenvalues = [1, 3], thrust = [9e4, 11e4]}"}
    gains = {"gains.k1": "100", "gains.k2": "4", "gains.k3": "1000"}
    mission = load("x4-flyer", heavy | bounds | gains)
    x, y = axis(mission, "k1", cells=8), axis(mission, "k2", cells=8)
    met = where_met(mission, cell_values(mission, x, y))
    assert met.any()
    assert not met.all()
    for i in range(8):
        for j in range(8):
            cell = cell_mission(mission, x, y, i, j)
            demands = printed_demands(cell, cell.bounds.eigenvalues)
            assert met[i, j] == all(d.met for d in demands if d.name != "L(0)")


def test_the_figure_shows_the_mission_s_point_only_where_it_is(x4):
    def labels(x, y):
        drawn = atlas(x4, x, y, processes=1)
        figure = atlas_figure(x4, drawn, "margin", np.zeros(drawn["margin"].shape, bool))
        entries = [text.get_text() for text in figure.legends[0].get_texts()]
        return [*entries, figure.axes[0].get_title()]

    here = labels(axis(x4, "k1", cells=9), axis(x4, "k2", cells=9))
    away = labels(axis(x4, "k1", ends=(1, 2), cells=9), axis(x4, "k2", cells=9))
    assert "the mission's own point" in here
    assert "the mission's own point" not in away
    assert "boundary (floating point)" in here
    assert here[-1].endswith("conditions of the printed theorem: met nowhere here")
    assert not any("printed" in entry for entry in here[:-1])  # what has no mark


@pytest.mark.slow
def test_atlas_writes_a_map_with_units_and_a_figure(capsys):
    options = ("--x", "k3", "--y", "k4", "--cells", 12, "--exact-boundary", "--processes", 1)
    status, out, _ = run(capsys, "atlas", "x4-flyer", *options, "--out", "m.nc", "--json")
    answer = json.loads(out)
    assert status == 0
    assert answer["disagree"] == 0
    assert answer["cells"] == 144
    assert answer["decided_exactly"]["proved"] > 0
    assert Path("m.png").read_bytes().startswith(b"\x89PNG")
    with xr.open_dataset("m.nc", engine="h5netcdf") as kept:
        assert kept["k3"].attrs["units"] == "kg/s"
        assert kept["decay_rate"].attrs["units"] == "1/s"
        assert json.loads(kept.attrs["mission"])["name"] == "x4-flyer"
        assert int((kept["margin"] > 0).sum()) == answer["certified"]
    status, out, _ = run(
        capsys, "atlas", "x4-flyer", "--cells", 9, "--figure", "a.svg", "--x-range", "0.1,0.3"
    )
    assert status == 0
    assert "<svg" in Path("a.svg").read_text()
    assert run(capsys, "atlas", "x4-flyer", "--x-range", "nonsense")[0] == 2
    assert run(capsys, "atlas", "x4-flyer", "--x", "k7")[0] == 2
    assert run(capsys, "atlas", "x4-flyer", "--figure", "a.pdf")[0] == 2
