"""What somebody with a vehicle of their own does first, and what goes wrong then."""

import warnings
from pathlib import Path

import pytest

import hoverproof as hp
from command_line import refusal
from hoverproof.cli import main
from hoverproof.errors import InputError

TUNED = """
name = "small-tag"
law = {feature = "scaled", goal = "inertial", force = "measured"}
gains = {k1 = 0.032, k2 = 32, k3 = 1.5, k4 = 6.4, k_yaw = 0.029}
bounds = {eigenvalues = "auto", thrust = [3.97305, 4.85595]}
goal = {height = 0.9}
start = {position = [0.27, 0, -1.17]}
rotors = {time_constant = 0.02896}
sensors = {gyro_turned = true, frame_rate = 30, latency = 0.04}

[vehicle]
mass = 0.45
inertia = [0.003226, 0.003226, 0.00599]
layout = "x"
arm = 0.16
drag_ratio = 0.0208
gravity = 9.81

[target]
points = [[0.075, 0.075, 0], [0.075, -0.075, 0], [-0.075, -0.075, 0], [-0.075, 0.075, 0]]

[uncertainty]
thrust = 0.2
torque = 0.1
latency = 0.0734
rotor_lag = 0.02896
wind = 0.2
yaw_rate = 0.3
"""
BY_TUNE = 5.934
"""In which time, s, `tune` proves it settled with these gains."""


@pytest.fixture
def mission(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("small-tag.toml").write_text(TUNED)
    return hp.load("small-tag.toml")


@pytest.mark.slow
def test_attraction_finds_a_time_like_that_which_tune_proved_with_the_same_gains(mission):
    assert float(hp.attraction(mission).settling.time) < 1.1 * BY_TUNE


@pytest.mark.slow
def test_a_start_at_the_goal_is_proved_without_a_warning(mission):
    there = hp.replace(mission, {"start.position": [0, 0, -0.9]})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert hp.attraction(there).proved


@pytest.mark.parametrize("verb", [hp.tune, hp.attraction])
def test_an_objective_that_is_none_is_refused(mission, verb):
    with pytest.raises(InputError, match=r"objective: must be one of start, .*, not 'soonest'"):
        verb(mission, objective="soonest")


def test_one_claim_is_judged_by_its_name_alone():
    (judged,) = hp.derive("31")
    assert judged.id == "31"
    with pytest.raises(InputError, match="no claim 'nope'"):
        hp.derive("nope")


def test_a_path_needs_no_quotes_in_set(mission):
    with pytest.raises(InputError, match=r"lenses/down\.yaml: no such file"):
        hp.load("small-tag.toml", {"camera.file": "lenses/down.yaml"})


def test_a_tuned_mission_is_not_written_as_a_picture(mission, capsys):
    assert "--trade" in refusal(capsys, "tune", "small-tag.toml", "--out", "trade.png")


@pytest.mark.parametrize("command", ["tune", "attraction"])
def test_a_folder_that_is_not_there_is_said_before_the_work(mission, capsys, command):
    err = refusal(capsys, command, "small-tag.toml", "--out", "nowhere/x.toml")
    assert "its folder is not there" in err  # and no line of what is being done


@pytest.mark.parametrize(
    ("option", "how"),
    [
        (["--interface", "rates"], "--set interface.rate_bandwidth="),
        (["--pixels"], '[camera] file = "camera_info.yaml"'),
    ],
)
def test_export_says_how_to_give_what_it_needs(mission, capsys, option, how):
    assert how in refusal(capsys, "export", "small-tag.toml", "--out", "c", *option)


def test_what_is_not_considered_fits_the_terminal(mission, capsys):
    with pytest.raises(SystemExit):
        main(["certify", "small-tag.toml"])
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 80
