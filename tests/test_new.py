"""What a user of Python types: names for missions, other values, pictures, notebooks."""

from __future__ import annotations

import json
import math
import os
import random
import re
import sys
import tomllib
from fractions import Fraction
from pathlib import Path

import pexpect
import pytest

from command_line import run
from hoverproof import cli
from hoverproof.certification.convergence import attraction
from hoverproof.certification.gains import certify
from hoverproof.cli.console import app
from hoverproof.cli.first_mission import decided, first_gains, make, written
from hoverproof.cli.interview import interview, without_asking
from hoverproof.cli.questions import CONTROL_RATES, QUESTIONS, WORDS
from hoverproof.errors import InputError
from hoverproof.mission.presets import preset_text, with_conditions
from hoverproof.mission.reading import load
from hoverproof.mission.uncertainty import Noise, Uncertainty
from hoverproof.simulation.flight import simulate, summary
from new_trials import outcome
from sampling import mostly_whole

PROGRAM = Path(sys.executable).parent / "hoverproof"
DEFAULTS = without_asking({})


def converse(typed, given=None):
    """Hold the interview with lists of answers by question; return answers and what was said."""
    left = {name: list(lines) for name, lines in typed.items()}
    names = {words: name for name, words in WORDS.items()}
    said = []

    def ask(prompt):
        said.append(prompt)
        name = names[prompt.strip().rsplit(" [", 1)[0]]
        return left.get(name, []).pop(0) if left.get(name) else ""

    answers = interview(given or {}, ask, said.append)
    assert not any(left.values())
    return answers, "\n".join(said)


def of(answers):
    """Return the mission of answers, with gains that are no one's."""
    Path("mine.toml").write_text(written(decided("mine", answers)), encoding="utf-8")
    return load("mine.toml")


def beginning(**given):
    """Return the mission that `new` writes for options."""
    Path("mine.toml").write_text(make(Path("draft.toml"), "mine", without_asking(given)))
    return load("mine.toml")


def test_enter_throughout_gives_what_is_written_without_asking():
    assert converse({})[0] == DEFAULTS


def test_every_question_has_an_option_that_gives_the_same_and_is_not_asked():
    typed = {"mass": "0.031", "start": "0.1 0 -0.9", "autopilot": "crazyflie", "half_angle": "1.2"}
    answers, said = converse({}, typed)
    assert answers == converse({name: [line] for name, line in typed.items()})[0]
    assert not any(WORDS[name] in said for name in typed)


def test_answers_are_written_as_they_were_typed():
    answers, said = converse({"mass": ["0.0270"], "inertia": ["1.66e-5, 1.66e-5 2.93e-5"]})
    mission = of(answers)
    assert "mass = 0.0270 " in Path("mine.toml").read_text()
    assert mission.vehicle.mass * 1000 == 27
    assert [float(i) for i in mission.vehicle.inertia] == [1.66e-5, 1.66e-5, 2.93e-5]
    assert "kg m²" in said
    prompts = [line for line in said.splitlines() if line.endswith("]: ")]
    assert len(prompts) == len(QUESTIONS)
    assert max(map(len, prompts)) <= 72  # leaves room for an answer in 80 columns


def test_the_arm_is_the_lever_of_rotors_in_x_and_latency_is_all_that_ages_an_image():
    mission = of(without_asking({"rotor_distance": "0.17", "autopilot": "px4"}))
    assert (mission.vehicle.layout, mission.vehicle.arm) == ("x", Fraction("0.17"))
    assert float(mission.vehicle.reach) == pytest.approx(0.17 / 2**0.5, rel=1e-11)
    assert mission.uncertainty.latency >= mission.sensors.latency + Fraction(1, 30) + Fraction(
        1, 400
    )
    assert mission.sensors.control_rate == CONTROL_RATES["px4"]


def test_a_vehicle_is_taken_from_a_mission_but_for_what_is_given():
    taken, own = load("research-1.5kg"), of(without_asking({"vehicle": "research-1.5kg"}))
    assert own.vehicle == taken.vehicle
    heavier = of(without_asking({"vehicle": "research-1.5kg", "mass": "1.6"})).vehicle
    assert heavier == taken.vehicle.model_copy(update={"mass": Fraction("1.6")})
    _, said = converse({"vehicle": ["research-1.5kg"]})
    assert WORDS["inertia"] not in said


@pytest.mark.parametrize(("layout", "rotors"), [("x", 4), ("plus", 4), ("hex", 6), ("octo", 8)])
def test_a_vehicle_has_the_layout_that_is_named(layout, rotors):
    vehicle = of(without_asking({"layout": layout, "rotor_distance": "0.3"})).vehicle
    assert (vehicle.layout, float(vehicle.arm), len(vehicle.frame.names)) == (layout, 0.3, rotors)
    taken = of(without_asking({"vehicle": "research-1.5kg", "layout": layout})).vehicle
    assert taken.layout == layout


def test_each_number_has_a_comment():
    text = written(decided("mine", DEFAULTS))
    values = [line for line in text.splitlines() if re.match(r"\w+ = [\d.]", line)]
    assert len(values) > 15
    assert all("#" in line for line in values)


@pytest.mark.parametrize(
    ("name", "slip", "reason"),
    [
        ("mass", "-3", "must be above 0 and at most 1e6 kg, not -3"),
        ("mass", "0.5 kg", "must be a number in kg, not '0.5 kg'"),
        ("mass", "0,5", "must be a number in kg"),
        ("mass", "nan", "must be a number in kg, not 'nan'"),
        ("mass", "true", "must be a number in kg"),
        ("mass", "1\\n[x]", "must be a number in kg"),
        ("inertia", "1 2", "must be a list [I1, I2, I3]"),
        ("inertia", "1 1 5", "no rigid body has one moment above the sum"),
        ("rotor_distance", "x", "must be a number in m"),
        ("tag", "0", "must be above 0 and at most 1e6 m, not 0"),
        ("height", "-1", "must be above 0"),
        ("frame_rate", "0", "must be above 0"),
        ("half_angle", "wide", "must be a number in rad"),
        ("thrust", "20", "must be from 0 to 0.999"),
        ("wind", "10", "must be below gravity"),
        ("autopilot", "betaflight", "must be one of none, crazyflie, px4, ardupilot"),
        ("vehicle", "crazyfly", "did you mean"),
        ("vehicle", "2.5", "no such mission file or preset"),
        ("vehicle", "0", "no such mission file or preset"),
        ("layout", "hexa", "must be one of x, plus, hex, octo, not 'hexa'"),
        ("layout", "6", "must be one of x, plus, hex, octo, not '6'"),
        ("start", "1 1 3", "must be above every target point (z is down)"),
    ],
)
def test_a_slip_is_refused_on_the_spot_in_the_words_of_the_mission_file(name, slip, reason):
    answers, said = converse({name: [slip]})
    assert reason in said
    assert answers == DEFAULTS
    with pytest.raises(InputError, match=rf"^{name}: "):
        without_asking({name: slip})


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"half_angle": "0.05"}, "half_angle: 0.05 rad does not see the target at the goal"),
        ({"latency": "100"}, "no vehicle hovers by images with an age of 101 s, 1 s at most"),
        ({"rotor_lag": "5"}, "no vehicle hovers on rotors that lag by 5 s, 1 s at most"),
    ],
)
def test_what_no_gains_make_up_for_is_refused_before_any_are_looked_for(given, told, monkeypatch):
    monkeypatch.setattr("hoverproof.cli.first_mission.first_gains", None)
    with pytest.raises(InputError, match=told):
        beginning(**given)


@pytest.mark.slow
def test_a_start_out_of_reach_is_refused_with_one_that_is_held():
    with pytest.raises(InputError, match="would be held") as refused:
        beginning(start="3,0,-1.5")
    start = refused.value.held
    assert f"{start} would be held" in str(refused.value)
    assert first_gains(of(without_asking({"start": start}))) is not None


FAR = ("--mass=2.5", "--rotor-distance=0.3", "--tag=0.5", "--height=4", "--half-angle=0.6")
FAR += ("--frame-rate=60", "--latency=0.03")


@pytest.mark.slow
def test_a_start_that_nobody_gave_is_taken_nearer_until_it_is_held(capsys):
    status, out, _ = run(capsys, "new", "far.toml", *FAR, "--yes")
    said = "--start [0.96, 0, -4.96] m (nearer than usual, to be held)"
    assert (status, said in " ".join(out.split())) == (0, True)
    assert said in Path("far.toml").read_text("utf-8").replace("\n# ", " ")
    assert list(map(float, load("far.toml").start.position)) == [0.96, 0, -4.96]


@pytest.mark.slow
def test_a_start_that_is_not_held_is_asked_for_again_and_no_answer_is_lost():
    terminal = spawn("new", "far.toml", *FAR)
    said = ""
    while terminal.expect(["]: ", "written, own vehicle"]) == 0:
        said += terminal.before
        terminal.sendline("")
    assert "start x y z (world, z down), m [1.2, 0, -5.2" in said
    assert "start x y z (world, z down), m [0.96, 0, -4.96" in said
    assert list(map(float, load("far.toml").start.position)) == [0.96, 0, -4.96]


@pytest.mark.slow
def test_what_was_typed_is_told_as_options_where_it_does_not_go_together():
    terminal = spawn("new", "late.toml", "--rotor-lag=5")
    while terminal.expect(["]: ", "The same answers as options"]) == 0:
        terminal.sendline("0.7" if WORDS["mass"] in terminal.before else "")
    terminal.expect_exact("--mass=0.7 --layout=x ")
    terminal.expect("no vehicle hovers on rotors that lag by 5 s")


def test_a_copy_of_a_preset_says_the_same_under_another_name(capsys):
    assert run(capsys, "new", "copy.toml", "--from", "x4-flyer")[0] == 0
    preset, copy = load("x4-flyer").exact(), load("copy.toml").exact()
    assert copy == preset | {"name": "copy"}


def sensible(seed):
    """Draw a vehicle from 20 g to 20 kg over a tag of 8 cm to 2 m, a camera and tolerances."""
    draw = random.Random(seed)
    mass, tag = 0.02 * 1000 ** draw.random(), 0.08 * 25 ** draw.random()
    height, turn = tag * draw.uniform(3, 12), draw.uniform(0, 2 * math.pi)
    aside, up = height * draw.uniform(0, 0.45), height * draw.uniform(0.75, 1.4)
    size = (mass / 0.5) ** (1 / 3)
    numbers = {
        "mass": mass,
        "rotor_distance": 0.17 * size * draw.uniform(0.7, 1.4),
        "rotor_lag": 0.03 * size * draw.uniform(0.6, 1.6),
        "tag": tag,
        "height": height,
        "frame_rate": draw.choice([15, 20, 30, 60, 90, 120]),
        "latency": draw.uniform(0.005, 0.08),
        "thrust": draw.uniform(0, 0.3),
        "torque": draw.uniform(0, 0.2),
        "wind": draw.uniform(0, 0.3),
        "yaw_rate": draw.uniform(0, 0.3),
    }
    start = aside * math.cos(turn), aside * math.sin(turn), -up
    return {name: f"{value:.4g}" for name, value in numbers.items()} | {
        "autopilot": draw.choice(list(CONTROL_RATES)),
        "start": ",".join(f"{c:.4g}" for c in start),
    }


@pytest.mark.slow
@pytest.mark.long
def test_for_every_answer_that_makes_sense_the_mission_is_proved_and_flies_as_written(whole):
    for seed in range(300 if whole else 1):
        mission = beginning(**sensible(seed))
        proof = attraction(mission)
        assert proof.status == "proved", (seed, proof)
        assert certify(mission).status == "proved", seed  # so that it can be exported
        time = float(proof.settling.time)
        flown = summary(simulate(mission, duration=time))
        assert flown["outcome"] == "flown", seed
        assert flown["settled_at"] < time, seed


@pytest.mark.parametrize("name", ["x4-flyer"])
def test_what_is_not_said_stands_in_comments_once_and_in_its_section(name):
    for text in (preset_text(name), written(decided("mine", DEFAULTS))):
        whole = with_conditions(text)
        assert tomllib.loads(whole) == tomllib.loads(text)
        shown = re.sub(r"(?m)^# (?=\[|\w+ = )", "", whole)
        keys = {k: set(part) for k, part in tomllib.loads(shown).items() if isinstance(part, dict)}
        assert {"law", "sensors", "rotors", "wind", "model_error", "scatter"} < keys.keys()
        assert "heading_noise" in keys["sensors"]


def test_every_tolerance_is_named_in_what_is_written():
    text = re.sub(r"(?m)^# (?=\[|\w+ = )", "", written(decided("mine", DEFAULTS)))
    named = tomllib.loads(text)["uncertainty"]
    assert set(named) == set(Uncertainty.model_fields)
    assert set(named["noise"]) == set(Noise.model_fields)


def spawn(*arguments):
    return pexpect.spawn(
        str(PROGRAM),
        list(arguments),
        env={**os.environ, "TERM": "dumb", "LC_ALL": "C.UTF-8"},
        encoding="utf-8",
        timeout=120,
    )


@pytest.mark.slow
def test_in_a_terminal_it_asks_and_writes():
    terminal = spawn("new", "my-flyer.toml", "--height", "1.0")
    for question in QUESTIONS:
        if question.name != "height":
            terminal.expect_exact(question.words)
            terminal.sendline("1.5" if question.name == "mass" else "")
    terminal.expect("my-flyer.toml: written, own vehicle")
    terminal.expect(pexpect.EOF)
    mission = load("my-flyer.toml")
    assert (float(mission.vehicle.mass), float(mission.goal.height)) == (1.5, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("key", ["c", "d"])
def test_leaving_writes_nothing(key):
    terminal = spawn("new", "my-flyer.toml")
    terminal.expect_exact(WORDS["vehicle"])
    terminal.sendline("")
    terminal.expect_exact(WORDS["mass"])
    for _ in range(5):  # one that comes just before readline listens is lost
        terminal.sendcontrol(key)
        if terminal.expect(["interrupted", pexpect.TIMEOUT], timeout=5) == 0:
            break
    terminal.expect(pexpect.EOF)
    terminal.close()
    assert terminal.exitstatus == 130
    assert list(Path.cwd().iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "option", mostly_whole([["--yes"], ["--from", "x4-flyer"], ["--json"]], every=3)
)
def test_nothing_is_asked_of_those_who_say_so(option):
    terminal = spawn("new", "my-flyer.toml", *option)
    terminal.expect(pexpect.EOF)
    assert WORDS["vehicle"] not in terminal.before
    assert load("my-flyer.toml").name == "my-flyer"


def test_an_existing_file_is_refused_before_the_first_question():
    Path("my-flyer.toml").write_text("mine")
    terminal = spawn("new", "my-flyer.toml")
    terminal.expect("--force")
    terminal.expect(pexpect.EOF)
    assert "mass" not in terminal.before
    assert Path("my-flyer.toml").read_text() == "mine"


def test_an_option_that_cannot_be_used_is_refused_before_the_first_question():
    terminal = spawn("new", "my-flyer.toml", "--start", "1 1 3", "--height", "300")
    terminal.expect("--start: must be above every target point")
    terminal.expect(pexpect.EOF)
    assert WORDS["vehicle"] not in terminal.before
    answers, _ = converse({"tag": ["3"]}, {"height": "300"})
    assert answers["height"] == "300"


def test_answers_do_not_go_with_a_preset(capsys):
    with pytest.raises(SystemExit):
        cli.main(["new", "mine.toml", "--from", "x4-flyer", "--rotor-lag", "0.1"])
    assert "--rotor-lag: does not go with --from" in capsys.readouterr().err
    assert not Path("mine.toml").exists()


@pytest.mark.parametrize(
    ("options", "verbs"),
    [
        ([], ["attraction", "tune", "simulate"]),
        (["--from", "x4-flyer"], ["certify", "tune", "simulate"]),
    ],
)
def test_what_it_names_next_are_commands_as_they_stand(options, verbs, capsys):
    with pytest.raises(SystemExit):
        cli.main(["new", "mine.toml", *options])
    said = capsys.readouterr().out.splitlines()
    named = [line.split() for line in said if line.startswith("  hoverproof")]
    assert [words[1] for words in named] == verbs
    for words in named:
        app.parse_args(words[1:], exit_on_error=False, print_error=False)


@pytest.mark.slow
@pytest.mark.whole
@pytest.mark.parametrize("number", range(300))
def test_sensible_answers_at_random_are_proved_and_fly_there(number):
    became = outcome(number)
    assert became.startswith("proved"), became
    assert "flown in" in became, became


def test_what_nobody_said_is_told_and_stands_in_the_file(capsys):
    words = ("new", "light.toml", "--mass", "0.03", "--yes", "--json")
    with pytest.raises(SystemExit):
        cli.main([*words])
    told = json.loads(capsys.readouterr().out)["assumed"]
    assert "--rotor-lag 0.05 s" in told
    assert not any(item.startswith("--mass") for item in told)
    shown = [
        f"--{q.name.replace('_', '-')} "
        for q in QUESTIONS[2:]
        if q.name not in ("half_angle", "autopilot")
    ]
    assert [item.split()[0] + " " for item in told] == shown
    head = " ".join(
        Path("light.toml").read_text("utf-8").split("name =")[0].replace("\n#", "").split()
    )
    assert f"as nobody said them: {', '.join(told)}" in head
    with pytest.raises(SystemExit):
        cli.main([*words, "--force", "--rotor-lag", "0.02"])
    said = json.loads(capsys.readouterr().out)["assumed"]
    assert said == [item for item in told if "--rotor-lag" not in item]


def test_a_light_vehicle_is_not_taken_to_have_quicker_rotors_than_a_crazyflie():
    lag = {
        mass: float(without_asking({"mass": mass})["rotor_lag"]) for mass in ("0.02", "0.09", "0.5")
    }
    crazyflie = float(load("crazyflie-2.1").rotors.time_constant)
    assert lag == {"0.02": crazyflie, "0.09": crazyflie, "0.5": 0.03}
