"""Random mission files through the commands: forty; ``make missions`` takes two thousand."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

import mission_trials
from hoverproof.mission.presets import preset_text
from random_missions import KINDS, case
from sharing import kept_value

FIRST = [*range(40), 166]
"""They meet every verdict of every command; from 166 nothing is decided about the start."""


@pytest.fixture(scope="module")
def tally(whole):
    """What the first missions came to, of 200 with `make trials`."""

    def make():
        found = mission_trials.Tally()
        numbers = list(range(200)) if whole else FIRST
        mission_trials.spread(numbers, whole=False, jobs=1, report=found.add)
        return found

    return kept_value("random missions", make)


def faults(tally, *, contradict):
    found = [f for f in tally.faults if (f.kind == "contradiction") is contradict]
    return [f"mission {f.number}, {f.command}: {f.kind}: {f.words}" for f in found]


@pytest.mark.slow
@pytest.mark.long
def test_no_random_mission_gives_a_traceback_a_hang_or_a_bad_message(tally):
    assert faults(tally, contradict=False) == []


@pytest.mark.slow
def test_no_verdict_on_a_random_mission_contradicts_that_of_another_command(tally):
    assert faults(tally, contradict=True) == []


@pytest.mark.slow
def test_random_missions_go_through_every_command_and_meet_every_verdict(tally):
    assert set(mission_trials.ALL) <= {command for command, _ in tally.status}
    for command in ("certify", "over-box", "region", "export"):
        assert {s for c, s in tally.status if c == command} >= {0, 1, 2}, command
    for command in ("tune", "simulate", "runs"):
        assert {s for c, s in tally.status if c == command} >= {0, 2}, command
    starts = {s for c, s in tally.status if c == "attraction"}
    assert starts >= {0, 2}
    assert starts & {1, 3}  # few are asked about, since they cost most


@pytest.mark.slow
def test_a_random_mission_is_made_again_by_its_number():
    assert [case(i) for i in range(60)] == [case(i) for i in range(60)]
    many = [case(i) for i in range(600)]
    assert len({one.text for one in many}) > 500
    assert {n // 200 for n in Counter(one.kind for one in many).values()} == {1}
    assert {case(i).kind for i in range(3)} == set(KINDS)


@pytest.mark.parametrize("number", [1387, 1648, 2344, 3184])
def test_absurdities_upon_each_other_still_make_a_mission(number):
    assert case(number).text


def compared(mission, statuses, folder):
    """Return what the trials find contradictory in statuses of commands on a mission file."""
    answers = {c: mission_trials.Answer(c, [c], status=s) for c, s in statuses.items()}
    (folder / "m.toml").write_text(mission, encoding="utf-8")
    one = mission_trials.Case(7, "absurd", b"", refused=False)
    found = mission_trials.contradictions(one, answers, str(folder / "m.toml"), whole=False)
    return [f.command for f in found]


def test_commands_are_compared_when_the_process_of_another_has_died(tmp_path):
    paper = preset_text("x4-flyer")
    assert compared(paper, {"export": 0, "region": 3, "tune": 1}, tmp_path) == []
    assert compared(paper, {"export": 0, "certify": 1}, tmp_path) == ["export"]


@pytest.mark.parametrize(
    ("rotors", "faults"),
    [("min_thrust = 30", {0: ["export"], 2: []}), ("max_thrust = 30", {0: [], 2: ["export"]})],
)
def test_only_firmware_has_to_keep_to_the_limits_of_rotors(rotors, faults, tmp_path):
    mission = f"{preset_text('x4-flyer')}\n[rotors]\n{rotors}\n"  # m g/4 = 23.5 N
    for status, found in faults.items():
        assert compared(mission, {"certify": 0, "export": status}, tmp_path) == found


def command_that(does):
    """Return an answer of a made-up command."""
    answer = mission_trials.Answer("certify", ["certify", "7.toml", "--json"])
    for key, value in does.items():
        setattr(answer, key, value)
    return answer


REFUSED = {"status": 2, "err": "hoverproof: 7.toml: vehicle.mass: must be positive\n"}


@pytest.mark.parametrize(
    ("does", "kind"),
    [
        (REFUSED, None),
        ({"error": "Traceback ...\nValueError: no"}, "traceback"),
        ({"status": -11, "out": '{"a": 1}'}, "status"),
        ({"status": 1, "out": '{"verdict": "refuted"}'}, "file"),
        ({"status": 3, "out": '{"verdict": "undecided"}', "files": ["x.txt"]}, "file"),
        ({"status": 3, "out": '{"reason": "k3 > inf"}'}, "message"),
        ({"status": 3, "out": "no object"}, "message"),
        ({"status": 3, "out": '{"a": 1}', "err": "x.py: RuntimeWarning: overflow"}, "chatter"),
        (REFUSED | {"err": "hoverproof: must be positive\n"}, "message"),
        (REFUSED | {"err": 2 * REFUSED["err"]}, "message"),
        (REFUSED | {"out": "x"}, "message"),
        (REFUSED | {"files": ["x.txt"]}, "file"),
        (REFUSED | {"seconds": 61}, "hang"),
    ],
)
def test_the_trials_tell_a_bad_answer(does, kind):
    one = mission_trials.Case(7, "absurd", b"", refused=False)
    found = [f.kind for f in mission_trials.plain_faults(one, command_that(does), "7.toml")]
    assert found == ([] if kind is None else [kind])


DEADLY = """
import os, resource
import mission_trials

def call(command, arguments):
    if command == "certify":
        os.abort()
    if command == "region":
        resource.setrlimit(resource.RLIMIT_CPU, (1, resource.RLIM_INFINITY))
        while True:
            pass
    return mission_trials.Answer(command, arguments, status=0)

def report(message):
    print(*message.get("seconds", ()), message.get("fault", {}).get("words", ""))

mission_trials.call, mission_trials.warm_up = call, lambda: None
mission_trials.run([1], whole=True, report=report)
"""


@pytest.mark.slow
def test_the_trials_tell_a_crash_and_a_hang_and_go_on_with_the_next_command():
    paths = [str(Path(mission_trials.__file__).parent), os.environ.get("PYTHONPATH", "")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))}
    words = [sys.executable, "-c", DEADLY]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
    assert "ended by SIGABRT" in done.stdout
    assert "ended by SIGXCPU" in done.stdout
    assert "export" in done.stdout
