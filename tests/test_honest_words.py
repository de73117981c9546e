"""What commands say is so: no question where a statement stands, no file that is not there."""

from __future__ import annotations

import json
import os
from fractions import Fraction
from pathlib import Path

import pytest

from command_line import run
from hoverproof.errors import InputError
from hoverproof.files import locked
from hoverproof.mission.presets import preset_text
from hoverproof.mission.reading import load
from hoverproof.paper.conditions import printed_demands
from hoverproof.reporting.document import report

# --- many flights -------------------------------------------------------------------------------


def test_many_flights_that_would_be_the_same_are_refused(capsys):
    status, out, err = run(capsys, "simulate", "x4-flyer", "--runs", 400, "--duration", 1)
    assert (status, out) == (2, "")
    assert "all 400 flights would be the same" in err
    assert "[scatter]" in err
    with pytest.raises(InputError, match="would be the same"):
        report(load("x4-flyer"), "report.html", runs=400)
    assert list(Path.cwd().iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "setting",
    [
        "scatter.position=[1,0,0]",
        "scatter.mass=0.01",
        "sensors.gyro_noise=0.01",
        "sensors.gravity_bias=0.01",
        "sensors={focal_length=400, pixel_noise=1}",
        "wind={gust=1, drag=0.1}",
    ],
)
def test_flights_that_differ_by_anything_drawn_are_flown(setting, capsys):
    few = ("--runs", 2, "--duration", 0.1, "--no-figures", "--json")
    status, out, _ = run(capsys, "simulate", "x4-flyer", *few, "--set", setting)
    assert status == 0
    assert json.loads(out)["runs_complete"] == 2


def test_one_flight_needs_no_scatter(capsys):
    few = ("--runs", 1, "--duration", 0.1, "--no-figures")
    assert run(capsys, "simulate", "x4-flyer", *few)[0] == 0


FEW = ("--runs", 2, "--duration", 0.1, "--no-figures", "--set", "scatter.position=[1,1,1]")


def test_a_second_run_into_the_same_file_is_refused_while_the_first_one_writes(capsys):
    with locked("few.nc"):
        status, out, err = run(capsys, "simulate", "x4-flyer", *FEW, "--out", "few.nc")
        assert (status, out) == (2, "")
        assert "few.nc: is being written by another run" in err
        status, _, err = run(capsys, "simulate", "x4-flyer", *FEW, "--out", "few.nc", "--resume")
        assert status == 2
        assert "is being written by another run" in err
        assert run(capsys, "simulate", "x4-flyer", *FEW, "--out", "other.nc")[0] == 0
    assert run(capsys, "simulate", "x4-flyer", *FEW, "--out", "few.nc")[0] == 0
    assert not list(Path.cwd().glob(".*"))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes cannot be forked here")
def test_the_lock_of_a_process_that_was_killed_holds_nobody_up(capsys):
    child = os.fork()
    if not child:
        with locked("few.nc"):
            os._exit(0)  # without a word, as when killed
    os.waitpid(child, 0)
    assert Path(".few.nc.lock").exists()
    assert run(capsys, "simulate", "x4-flyer", *FEW, "--out", "few.nc")[0] == 0


# --- verdicts -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("k4", "claim"),
    [("3", "Σ(Q, T) ≻ 0 for every"), ("0.1", "Σ(Q, T) ≻ 0 does not hold for every")],
)
def test_certify_states_its_verdict_and_asks_nothing(k4, claim, capsys):
    _, out, _ = run(capsys, "certify", "x4-flyer", "--set", f"gains.k4={k4}")
    assert "?" not in out
    assert claim in out


def test_no_option_replaces_the_plain_certificate(capsys):
    run(capsys, "certify", "x4-flyer")
    plain = Path("x4-flyer.cert.json").read_bytes()
    names = set()
    for options in (
        ("--box=-1,1,-1,1,-4,-2.5",),
        ("--weights", "2,2,2,2"),
        ("--set", "gains.k4=4"),
        ("--set", "gains.k4=5"),
    ):
        status, out, _ = run(capsys, "certify", "x4-flyer", *options, "--json")
        assert status == 0
        names.add(json.loads(out)["certificate"])
    assert len(names) == 4
    assert {"x4-flyer.over-box.cert.json", "x4-flyer.weighted.cert.json"} < names
    assert Path("x4-flyer.cert.json").read_bytes() == plain


def test_settings_that_change_nothing_that_is_proved_keep_the_name(capsys):
    for setting in ("gains.k4=3", "sensors.latency=0.1", "name=other"):
        _, out, _ = run(capsys, "certify", "x4-flyer", "--set", setting, "--json")
        assert json.loads(out)["certificate"] in ("x4-flyer.cert.json", "other.cert.json")


def test_a_mission_changed_in_its_file_replaces_its_own_certificate(capsys):
    text = preset_text("x4-flyer")
    for k4 in ("3 ", "4 "):
        Path("my.toml").write_text(text.replace("k4 = 3 ", f"k4 = {k4}"))
        assert run(capsys, "certify", "my.toml")[0] == 0
    assert [p.name for p in Path.cwd().glob("*.json")] == ["my.cert.json"]


def test_a_condition_that_nothing_meets_is_said_so_and_not_by_infinity(capsys):
    soft = ("--set", "gains.k2=1", "--set", "gains.k1=0.2")
    _, out, _ = run(capsys, "certify", "x4-flyer", *soft)
    assert "inf" not in out
    assert "k3: none is enough with such a k2 (30.5: not met)" in " ".join(out.split())
    demands = printed_demands(load("x4-flyer", {"gains.k2": "1"}), (Fraction("0.01"), Fraction(5)))
    (k3,) = (d for d in demands if d.name == "k3")
    assert not (k3.possible or k3.met)


def test_a_wish_that_is_not_met_names_the_mission_and_not_a_file_that_is_not_there(capsys):
    wish = ("--objective", "region", "--minimum-decay", 1000, "--out", "wide.toml")
    status, out, _ = run(capsys, "tune", "x4-flyer", *wish)
    assert status == 1
    assert out.startswith("x4-flyer: infeasible")
    assert "wide" not in out
    assert not list(Path.cwd().iterdir())


def test_a_curve_without_a_point_names_no_figure(capsys):
    wish = ("--objective", "decay", "--pareto", 2, "--rotor-thrust", 1, "--out", "curve.png")
    status, out, _ = run(capsys, "tune", "x4-flyer", *wish, "--json")
    assert status == 1
    assert json.loads(out)["figure"] is None
    assert not Path("curve.png").exists()
    assert "curve.png" not in run(capsys, "tune", "x4-flyer", *wish)[1]
