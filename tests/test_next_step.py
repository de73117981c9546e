"""What an answer names next: the step that is true of what was found."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from command_line import run
from hoverproof.certification import convergence
from hoverproof.certification.verdict import Undecided
from hoverproof.cli.answers.answer import tell
from hoverproof.cli.answers.tuned import InfeasibleAnswer
from hoverproof.cli.console import app
from hoverproof.design import unproved as design
from hoverproof.design.outcome import Infeasible
from hoverproof.design.unproved import Unproved
from hoverproof.mission.flown import beyond_tolerances
from hoverproof.mission.reading import load
from small_kit import small_vehicle

LAW = {"law.force": "measured"}


def named(out):
    """Return the tolerances of the command that comes next, which is one that parses."""
    (command,) = re.findall(r"(?m)^Next: hoverproof (attraction .*)$", out)
    app.parse_args(command.split(), exit_on_error=False, print_error=False)
    return dict(re.findall(r"--set ([\w.]+)=(\S+)", command))


@pytest.mark.parametrize(
    ("flown", "name", "size"),
    [
        ({"model_error.mass": "0.25"}, "thrust", 0.2),
        (
            {"model_error.thrust": "-0.15", "model_error.inertia": "[-0.15, -0.15, 0]"},
            "thrust",
            0.15,
        ),
        ({"model_error.rotors": "[0.4, 0, 0, 0]"}, "thrust", 0.1),
        ({"model_error.inertia": "[0, 0.25, 0.1]"}, "torque", 0.2),
        ({"model_error.arm": "0.1"}, "torque", 0.1),
        ({"sensors.latency": "0.04", "sensors.frame_rate": "25"}, "latency", 0.08),
        ({"rotors.time_constant": "0.05"}, "rotor_lag", 0.05),
        ({"wind.mean": "[3, 0, -4]", "wind.drag": "0.96"}, "wind", 0.5),
    ],
)
def test_what_is_flown_is_the_tolerance_that_covers_it_and_no_other(flown, name, size):
    (found,) = beyond_tolerances(load("x4-flyer", flown | LAW))
    assert found.name == name
    assert found.flown == pytest.approx(size, abs=1e-12)
    assert found.covered == 0
    assert not beyond_tolerances(load("x4-flyer", flown | LAW | {f"uncertainty.{name}": str(size)}))


def test_after_a_crash_the_tolerance_that_would_have_said_so_is_named(capsys):
    slow = ("--set", "law.force=measured", "--set", "rotors.time_constant=0.5")
    status, out, _ = run(capsys, "simulate", "x4-flyer", "--no-figures", *slow)
    assert status == 1
    sets = named(out)
    assert sets["rotors.time_constant"] == "0.5"  # of the mission that was flown
    assert float(sets["uncertainty.rotor_lag"]) == 0.5
    load("x4-flyer", sets)  # which is not refused


def test_where_only_another_law_can_cover_a_crash_a_mission_with_it_is_named(capsys):
    heavy = ("--set", "model_error.mass=0.02")
    status, out, _ = run(capsys, "simulate", "x4-flyer", "--no-figures", *heavy)
    assert status == 1
    assert "hit the height of the target" in out
    (command,) = re.findall(r"(?m)^Next: hoverproof (.*)$", out)
    assert run(capsys, *shlex.split(command))[0] == 0
    made = load("measured.toml")
    assert made.law.force == "measured"
    assert made.vehicle == load("x4-flyer").vehicle


def test_where_a_start_is_not_proved_with_the_centroid_a_ball_that_is_comes_next(capsys):
    near = ("--set", "gains.k3=11", "--set", "gains.k2=5.9", "--set", "gains.k1=0.78")
    status, out, _ = run(capsys, "attraction", "x4-flyer", "--no-figure", *near)
    assert status == 3
    (command,) = re.findall(r"(?m)^Next: hoverproof (.*)$", out)
    assert run(capsys, *shlex.split(command), "--no-figure")[0] == 0


def test_after_a_flight_that_came_to_its_goal_none_is(capsys):
    late = ("--set", "sensors.latency=0.01", "--duration", "600")
    status, out, _ = run(capsys, "simulate", "x4-flyer", "--no-figures", *late)
    assert status == 0
    assert "Next: hoverproof attraction" not in out


def test_tolerances_that_no_gains_were_found_for_were_asked_for(capsys):
    mission = load("x4-flyer", {"uncertainty.torque": "0.2", "camera.half_angle": "0.4"})
    assert tell(InfeasibleAnswer(Infeasible(mission, "too much")), False, mission) == 1
    out = capsys.readouterr().out
    assert "  asked for               torque ±20 %, points seen within 0.4 rad" in out
    assert "not considered" not in out


def test_tuning_for_decay_names_what_says_whether_the_start_is_still_held(capsys):
    out = run(capsys, "tune", "x4-flyer", "--objective", "decay", "--out", "fast.toml")[1]
    assert "\nThen: hoverproof attraction fast.toml, for whether the start\n" in out


@pytest.mark.parametrize(("option", "assumed"), [((), True), (("--over-box",), False)])
def test_region_comes_next_where_bounds_are_assumed(option, assumed, capsys):
    sets = ("--set", "start.position=[0, 1, -6]")
    _, out, _ = run(capsys, "certify", "x4-flyer", *sets, *option)
    named = f"Then: hoverproof region {shlex.join(['x4-flyer', *sets])}, for bounds"
    assert (named in out) is assumed


@pytest.mark.parametrize(
    ("option", "named"), [((), "hoverproof tune far.toml"), (("--start", "0,0,-9"), None)]
)
def test_gains_come_next_where_the_start_is_not_proved(option, named, capsys, monkeypatch):
    mission_file = Path("far.toml")
    mission_file.write_text(small_vehicle("[4, 16]", "[0.9, 0, -2.2]"))
    sets = ["--set", "uncertainty.thrust=0.2", "--set", "law.feature=scaled"]
    sets += ["--set", "law.goal=inertial", "--set", "law.force=measured"]
    mission = load(mission_file, dict(setting.split("=", 1) for setting in sets[1::2]))
    verdict = Undecided(mission=mission, reason="too far")
    monkeypatch.setattr(convergence, "attraction", lambda *_, **__: verdict)
    monkeypatch.setattr(design, "unproved", lambda *_: Unproved(None, None))
    status, out, _ = run(capsys, "attraction", str(mission_file), *sets, *option)
    assert status == 3
    assert "\n  asked for               thrust ±20 %" in out
    assert "not considered" not in out
    found = re.findall(r"(?m)^Next: (hoverproof tune .*)$", out)
    assert found == ([] if named is None else [shlex.join([*shlex.split(named), *sets])])
    for command in found:
        app.parse_args(shlex.split(command)[1:], exit_on_error=False, print_error=False)
