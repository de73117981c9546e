"""A mission file is read exactly, or refused in one line that names file, key and reason."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from command_line import run
from hoverproof import cli
from hoverproof.errors import InputError
from hoverproof.mission.presets import preset_text, presets
from hoverproof.mission.reading import load
from hoverproof.mission.target import on_one_line
from hoverproof.plant.goal import hover_goal

BASE = preset_text("x4-flyer")
POINTS = "[[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]]"

BROKEN = [
    # (what stands in the preset, what stands in its place, key, part of the reason)
    ("mass = 9.6", "mass = -9.6", "vehicle.mass", "above 0"),
    ("mass = 9.6", "mass = 0", "vehicle.mass", "above 0"),
    ("mass = 9.6", "mass = 1e308", "vehicle.mass", "at most 1e6 kg"),
    ("mass = 9.6", "mass = 1e999999999", "vehicle.mass", "at most 1e6 kg"),
    ("mass = 9.6", "mass = 1e400", "vehicle.mass", "not a number beyond 1e308"),
    ("mass = 9.6", "mass = -1e400", "vehicle.mass", "not a number beyond -1e308"),
    ("mass = 9.6", "mass = nan", "vehicle.mass", "nan"),
    ("mass = 9.6", "mass = inf", "vehicle.mass", "inf"),
    ("mass = 9.6", 'mass = "9.6"', "vehicle.mass", "a number in kg"),
    ("mass = 9.6", "mass = true", "vehicle.mass", "a number in kg"),
    ("mass = 9.6", "mass = [9.6]", "vehicle.mass", "a number in kg"),
    ("mass = 9.6", "mas = 9.6", "vehicle.mas", "did you mean 'mass'"),
    ("mass = 9.6", "", "vehicle.mass", "is missing"),
    ("[vehicle]", "[vehicel]", "vehicel", "did you mean 'vehicle'"),
    ("[0.4, 0.56, 0.22]", "[0.4, 0.56]", "vehicle.inertia", "[I1, I2, I3]"),
    ("[0.4, 0.56, 0.22]", "[0.1, 0.1, 0.9]", "vehicle.inertia", "no rigid body"),
    ("lever = 0.25", "lever = -1", "vehicle.lever", "above 0"),
    (POINTS, "[]", "target.points", "at least 2"),
    (POINTS, "[[0, 0, 0]]", "target.points", "at least 2"),
    (POINTS, "3", "target.points", "list of points"),
    (POINTS, "[[0, 0], [1, 0]]", "target.points[1]", "[x, y, z]"),
    (POINTS, '[[0, 0, "0"], [1, 0, 0]]', "target.points[1][3]", "a number in m"),
    (POINTS, "[[1, 0, 0], [1, 0, 0], [1, 0, 0]]", "target.points", "all one point"),
    (POINTS, f"{POINTS}\nweights = [1, 2]", "target.weights", "one number for each"),
    (POINTS, f"{POINTS}\nweights = [1, 1, 0, 1]", "target.weights[3]", "above 0"),
    (POINTS, f"{POINTS}\nweights = 2", "target.weights", "list of weights"),
    (POINTS, "[[0, 0, 0], [0, 0, 1]]", "target.points", "in line with a camera"),
    ("height = 3.0", "height = -3", "goal.height", "above 0"),
    ("height = 3.0", "", "goal", "either height"),
    ("height = 3.0", "height = 3.0\ncentroid = [0, 0, 3]", "goal", "either height"),
    ("height = 3.0", "centroid = [0, 0, 4]", "goal.centroid", "number of points"),
    ("height = 3.0", "centroid = [0, 0, -1]", "goal.centroid", "above 0"),
    ("k4 = 3 ", "k4 = 0 ", "gains.k4", "above 0"),
    ("k4 = 3 ", "k4 = 3\nk5 = 1 ", "gains.k5", "known here: k1"),
    ("[0.01, 5.0]", "[5.0, 0.01]", "bounds.eigenvalues", "must be below"),
    ("[0.01, 5.0]", "[5.0, 5.0]", "bounds.eigenvalues", "must be below"),
    ("[0.01, 5.0]", "[0, 5.0]", "bounds.eigenvalues[1]", "above 0"),
    ("[84.672, 103.488]", "[50, 60]", "bounds.thrust", "94.08 N"),
    ("[84.672, 103.488]", "[103, 84]", "bounds.thrust", "must not be above"),
    ("thrust = [84.672", "level = 1\nthrust = [84.672", "bounds", "either thrust"),
    ("[5, 2.5, -4]", "[5, 2.5, 4]", "start.position", "above every target point"),
    ("[5, 2.5, -4]", "[5, 2.5]", "start.position", "[x, y, z]"),
    ("[start]", "[[start]]", "start", "a section"),
    ('name = "x4-flyer"', "name = 3", "name", "short name"),
    ('name = "x4-flyer"', 'name = "../../etc"', "name", "short name"),
    ("[gains]", "[gains", "", "not valid TOML"),
    (BASE[200:], "", "", "TOML"),
    ("mass = 9.6", "mass = " + "9" * 5000, "", "too many digits"),
    ("mass = 9.6", "mass = " + "[" * 5000, "", "nested too deep"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("old", "new", "key", "reason"), BROKEN)
@pytest.mark.parametrize("command", ["certify", "simulate"])
def test_a_broken_mission_gives_one_line_and_status_2(command, old, new, key, reason, capsys):
    assert BASE.count(old) == 1
    Path("my.toml").write_text(BASE.replace(old, new), encoding="utf-8")
    with pytest.raises(SystemExit) as exit_:
        cli.main([command, "my.toml"])
    captured = capsys.readouterr()
    assert exit_.value.code == 2
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert captured.err.startswith(f"hoverproof: my.toml: {key + ': ' if key else ''}")
    assert reason in captured.err
    assert [p.name for p in Path.cwd().iterdir()] == ["my.toml"]


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        (".", "directory"),
        ("no-such.toml", "no such mission file"),
        ("x4-flier", "did you mean 'x4-flyer'"),
        ("binary.toml", "UTF-8"),
        ("big.toml", "larger than"),
        ("a\0b", "null byte"),
    ],
)
def test_a_file_that_cannot_be_read_gives_one_line_and_status_2(name, reason, capsys):
    Path("binary.toml").write_bytes(b"\xff\xfe\x00")
    Path("big.toml").write_bytes(b"#" * 2_000_000)
    status, _, err = run(capsys, "certify", name)
    assert status == 2
    assert err.count("\n") == 1
    assert reason in err


def test_an_unreadable_file_is_refused(monkeypatch):
    Path("secret.toml").write_text(BASE)

    def denied(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", denied)
    with pytest.raises(InputError, match=r"secret\.toml: cannot be read: Permission denied"):
        load("secret.toml")


def test_a_goal_that_no_hover_reaches_is_refused():
    # q* inside the unit ball that the centroid jumps across at the target point (1, 1, 0)
    with pytest.raises(InputError, match=r"goal\.centroid: no level hover"):
        hover_goal(load("x4-flyer", {"goal": "{centroid = [-2.4, -2.4, 0.01]}"}))


def test_numbers_are_exact_decimals(x4):
    assert x4.vehicle.mass == Fraction(96, 10)
    assert x4.bounds.thrust == (Fraction("84.672"), Fraction("103.488"))
    assert x4.vehicle.weight == Fraction("94.08")


@given(st.decimals(min_value="0.001", max_value=1000, places=12))
def test_any_decimal_is_read_exactly(mass):
    thrust = {"bounds.thrust": f"[{mass * 9}, {mass * 10}]", "vehicle.mass": f"{mass:f}"}
    assert load("x4-flyer", thrust).vehicle.mass == Fraction(mass)


@pytest.mark.parametrize("name", presets())
def test_each_preset_loads_under_its_own_name(name):
    assert load(name).name == name


def test_a_file_says_the_same_as_the_preset_it_was_copied_from(x4):
    Path("copy.toml").write_text(BASE, encoding="utf-8")
    assert load("copy.toml").exact() == x4.exact()


def test_overrides_take_the_place_of_values_in_the_file():
    assert load("x4-flyer", {"gains.k4": "0.1"}).gains.k4 == Fraction(1, 10)
    with pytest.raises(InputError, match=r"^gains\.k4: '\]' is not a TOML value"):
        load("x4-flyer", {"gains.k4": "]"})


def test_a_bare_word_in_an_override_needs_no_quotes():
    for word in ("abort", '"abort"'):
        assert load("x4-flyer", {"sensors.out_of_view": word}).sensors.out_of_view == "abort"
    with pytest.raises(InputError, match=r"gains\.k4: must be .*, not 'fast'"):
        load("x4-flyer", {"gains.k4": "fast"})


def test_points_on_one_line_are_found_in_any_direction():
    line = [[Fraction(t), Fraction(2 * t), Fraction(-t)] for t in range(4)]
    assert on_one_line(line)
    assert not on_one_line([*line, [Fraction(0), Fraction(0), Fraction(1)]])


@pytest.mark.parametrize("dotted", ["a." * 5000 + "b", '"a" . ' * 5000 + "b", "1." * 5000 + "2"])
def test_a_key_of_thousands_of_parts_is_refused_before_it_takes_minutes(dotted):
    for line in (f"{dotted} = 1", f"[{dotted}]", f"x = {{{dotted} = 1}}"):
        Path("deep.toml").write_text(f"{BASE}\n{line}\n")
        with pytest.raises(InputError, match=r"line \d+ has a key of more than 64 parts"):
            load("deep.toml")


@pytest.mark.parametrize("text", ["0.2" + "0" * 31 + "1", "1.00000000000000000000001e-10"])
def test_a_number_too_long_for_a_certificate_is_refused(text):
    with pytest.raises(InputError, match=r"gains\.k1: must be given in at most 32 digits"):
        load("x4-flyer", {"gains.k1": text})
    assert load("x4-flyer", {"gains.k1": "0.2" + "0" * 29 + "1"})


@pytest.mark.parametrize(
    ("key", "value", "hint"),
    [
        ("start.position", "0.2,0.1,-1", "; a list is written [0.2, 0.1, -1]"),
        ("start.position", "(1 2 -3)", "; a list is written [1, 2, -3]"),
        ("uncertainty.thrust", "20%", "; a share is written 0.2"),
        ("uncertainty.thrust", "2 0 %%", " is not a TOML value"),
        ("start.position", "1,x,-3", " is not a TOML value"),
    ],
)
def test_a_list_or_a_share_that_is_not_toml_is_told_how_it_is_written(key, value, hint):
    with pytest.raises(InputError, match=f"{re.escape(hint)}$"):
        load("x4-flyer", {key: value})
