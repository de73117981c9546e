"""`hoverproof new` in a terminal: a conversation that ends in a mission file, or in nothing."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pexpect
import pytest

from hoverproof import cli
from hoverproof.certification.gains import certify
from hoverproof.cli.console import app
from hoverproof.cli.interview import QUESTIONS, interview
from hoverproof.mission.reading import load

PROGRAM = Path(sys.executable).parent / "hoverproof"


def converse(answers):
    """Hold the interview with lists of answers by question; return text and what was said."""
    left = {name: list(given) for name, given in answers.items()}
    names = {question.words: question.name for question in QUESTIONS}
    said = []

    def ask(prompt):
        said.append(prompt)
        name = names[prompt.strip().rsplit(" [", 1)[0]]
        return left.get(name, []).pop(0) if left.get(name) else ""

    text = interview("mine", ask, said.append)
    assert not any(left.values())
    return text, "\n".join(said)


def written(text):
    Path("mine.toml").write_text(text, encoding="utf-8")
    return load("mine.toml")


def test_enter_throughout_gives_the_vehicle_of_the_paper():
    mission = written(converse({})[0])
    model = load("x4-flyer")
    assert mission.name == "mine"
    for part in ("vehicle", "target", "goal", "gains", "start"):
        assert getattr(mission, part) == getattr(model, part)
    assert mission.bounds.thrust == model.bounds.thrust


def test_the_bounds_of_q_in_a_new_mission_are_proved_not_assumed():
    mission = written(converse({})[0])
    verdict = certify(mission)
    assert mission.bounds.eigenvalues == "auto"
    assert verdict.status == "proved"
    assert verdict.problem.box is not None


def test_answers_are_written_as_they_were_typed():
    text, said = converse({"mass": ["0.0270"], "inertia": ["1.66e-5, 1.66e-5 2.93e-5"]})
    mission = written(text)
    assert "mass = 0.0270 " in text
    assert mission.vehicle.mass * 1000 == 27
    assert [float(i) for i in mission.vehicle.inertia] == [1.66e-5, 1.66e-5, 2.93e-5]
    assert "kg m²" in said
    prompts = [line for line in said.splitlines() if line.endswith("]: ")]
    assert max(map(len, prompts)) <= 72  # leaves room for an answer in 80 columns
    assert all(line.split("#")[1].strip() for line in text.splitlines() if " = " in line[8:])


@pytest.mark.parametrize(
    "answers",
    [
        {"mass": ["0.027"]},
        {"mass": ["1.5"], "height": ["10"], "position": ["3 2 -14"]},
        {"mass": ["1200"], "gravity": ["1.62"]},
        {"side": ["0.4"], "height": ["0.6"]},
    ],
)
def test_a_vehicle_scaled_by_similarity_keeps_its_proof(answers):
    assert certify(written(converse(answers)[0])).status == "proved"


@pytest.mark.parametrize(
    ("name", "slip", "reason"),
    [
        ("name", "a name", "must be a short name of letters"),
        ("mass", "-3", "must be above 0 and at most 1e6 kg, not -3"),
        ("mass", "0.5 kg", "must be a number in kg, not '0.5 kg'"),
        ("mass", "0,5", "must be a number in kg"),
        ("mass", "nan", "must be a number in kg, not 'nan'"),
        ("mass", "true", "must be a number in kg"),
        ("mass", "1\\n[x]", "must be a number in kg"),
        ("inertia", "1 2", "must be a list [I1, I2, I3]"),
        ("inertia", "1 1 5", "no rigid body has one moment above the sum"),
        ("arm", "x", "must be a number in m"),
        ("side", "0", "must be above 0 and at most 1e6 m, not 0"),
        ("height", "-1", "must be above 0"),
        ("position", "1 1 3", "must be above every target point (z is down)"),
    ],
)
def test_a_slip_is_refused_on_the_spot_in_the_words_of_the_mission_file(name, slip, reason):
    text, said = converse({name: [slip]})
    assert reason in said
    assert written(text).vehicle == load("x4-flyer").vehicle


def spawn(*arguments):
    return pexpect.spawn(
        str(PROGRAM),
        list(arguments),
        env={**os.environ, "TERM": "dumb", "LC_ALL": "C.UTF-8"},
        encoding="utf-8",
        timeout=60,
    )


def test_in_a_terminal_it_asks_and_writes():
    terminal = spawn("new", "my-flyer.toml")
    for question in QUESTIONS:
        terminal.expect_exact(question.words)
        terminal.sendline("1.5" if question.name == "mass" else "")
    terminal.expect("my-flyer.toml: written, own vehicle")
    terminal.expect(pexpect.EOF)
    assert float(load("my-flyer.toml").vehicle.mass) == 1.5


@pytest.mark.parametrize("key", ["c", "d"])
def test_leaving_writes_nothing(key):
    terminal = spawn("new", "my-flyer.toml")
    terminal.expect("name of the mission")
    terminal.sendline("")
    terminal.expect("mass, kg")
    for _ in range(5):  # one that comes just before readline listens is lost
        terminal.sendcontrol(key)
        if terminal.expect(["interrupted", pexpect.TIMEOUT], timeout=5) == 0:
            break
    terminal.expect(pexpect.EOF)
    terminal.close()
    assert terminal.exitstatus == 130
    assert list(Path.cwd().iterdir()) == []


@pytest.mark.parametrize("option", [["--yes"], ["--from", "x4-flyer"], ["--json"]])
def test_nothing_is_asked_of_those_who_say_so(option):
    terminal = spawn("new", "my-flyer.toml", *option)
    terminal.expect(pexpect.EOF)
    assert "[9.6]" not in terminal.before
    assert load("my-flyer.toml").name == "my-flyer"


def test_an_existing_file_is_refused_before_the_first_question():
    Path("my-flyer.toml").write_text("mine")
    terminal = spawn("new", "my-flyer.toml")
    terminal.expect("--force")
    terminal.expect(pexpect.EOF)
    assert "mass" not in terminal.before
    assert Path("my-flyer.toml").read_text() == "mine"


def test_what_it_names_next_are_commands_as_they_stand(capsys):
    with pytest.raises(SystemExit):
        cli.main(["new", "mine.toml"])
    named = [line.split() for line in capsys.readouterr().out.splitlines() if line[:2] == "  "]
    assert [words[1] for words in named] == ["certify", "tune", "simulate"]
    for words in named:
        app.parse_args(words[1:], exit_on_error=False, print_error=False)
