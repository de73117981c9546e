"""Numbers that no vehicle has are refused by name, or answered in one line: never a traceback."""

from __future__ import annotations

import pytest

from command_line import refusal, run
from hoverproof.errors import InputError
from hoverproof.mission.reading import load

TINY = "1e-300"
KEYS = {
    "vehicle.mass": "from 1e-12 to 1e6 kg",
    "vehicle.lever": "from 1e-12 to 1e6 m",
    "vehicle.gravity": "from 1e-12 to 1e3 m/s²",
    "gains.k1": "from 1e-12 to 1e9 kg m/s",
    "gains.k2": "from 1e-12 to 1e9 1/m",
    "gains.k3": "from 1e-12 to 1e9 kg/s",
    "gains.k4": "from 1e-12 to 1e9 kg/s",
    "gains.k_yaw": "from 1e-15 to 1e9 kg m²/s",
    "goal.height": "from 1e-12 to 1e6 m",
}


@pytest.mark.parametrize("key", KEYS)
def test_a_positive_number_too_small_to_compute_with_is_refused_with_the_range(key):
    with pytest.raises(InputError, match=f"{key}: must be {KEYS[key]}, not 1e-300"):
        load("x4-flyer", {key: TINY})


def test_what_insects_have_is_no_absurdity():
    insect = {"vehicle.mass": "8e-5", "vehicle.inertia": "[1e-9, 1e-9, 5e-10]"}
    load("x4-flyer", {**insect, "bounds.thrust": "[7e-4, 8.6e-4]"})


def test_a_number_of_more_digits_than_can_be_handled_is_refused():
    with pytest.raises(InputError, match="at most 32 digits"):
        load("x4-flyer", {"start.position": f"[5, 2.5, -4.{'3' * 60}]"})
    with pytest.raises(InputError, match="at most 32 digits"):
        load("x4-flyer", {"start.position": "[5, 1e-300, -4]"})


EXTREME = [
    ["certify", "--set", "gains.k1=1e-12", "--set", "gains.k4=1e9"],
    ["certify", "--set", "bounds.eigenvalues=[1e-12, 1e6]"],
    ["region", "--boxes", "20", "--set", "start.position=[1e6, 1e6, -1e6]"],
    ["simulate", "--no-figures", "--set", "gains.k4=1e9"],
    ["simulate", "--no-figures", "--duration", "1", "--set", "gains.k1=1e9"],
    ["atlas", "--cells", "4", "--set", "gains.k3=1e9", "--set", "gains.k1=1e-12"],
    ["export", "--out", "fw", "--set", "gains.k2=1e-12", "--allow-uncertified"],
    # the goal comes so near that no force is small enough
    pytest.param(
        [
            *("attraction", "--set", "gains.k1=3856", "--set", "gains.k3=1439"),
            *("--set", "goal.height=1e-12", "--set", "start.position=[0, 0.001, -1e-12]"),
        ],
        marks=pytest.mark.whole,
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize("words", EXTREME, ids=" ".join)
def test_extreme_numbers_get_an_answer(words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command, *options = words
    status, _, err = run(capsys, command, "x4-flyer", *options)
    assert status in (0, 1, 2, 3)
    assert "Traceback" not in err


def test_arithmetic_that_gives_up_is_one_line_and_proves_nothing(monkeypatch, capsys):
    def give_up(*_, **__):
        raise OverflowError("numerical result out of range")

    monkeypatch.setattr("hoverproof.certification.gains.certify", give_up)
    status, _, err = run(capsys, "certify", "x4-flyer")
    assert status == 3
    assert err.startswith("hoverproof: undecided: these numbers are beyond")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (
            "new mine.toml --yes --height 0.001",
            "--height: must be from 0.1 to 1000 sides of the tag",
        ),
        ("new mine.toml --yes --height 1e5", "--height: must be from 0.1 to 1000 sides of the tag"),
        ("new mine.toml --yes --tag 1e-5", "--tag: must be from 0.001 to 100 m, not"),
        ("atlas x4-flyer --x-range=1e-300,1e300", "--x-range: must be two numbers in order, from"),
        ("atlas x4-flyer --y-range=1,1e308", "--y-range: must be two numbers in order, from 1e-12"),
        (
            "atlas x4-flyer --theorem start --x thrust --x-range=0,1e300",
            "--x-range: thrust: must be from 0 to 0.999",
        ),
    ],
)
def test_what_nobody_computes_with_is_refused_in_words_of_the_option(words, reason, capsys):
    assert reason in refusal(capsys, *words.split())


@pytest.mark.parametrize(
    "words",
    [
        "attraction x4-flyer --speed {}",
        "attraction x4-flyer --start=0,0,-{}",
        "certify x4-flyer --weights {},1,1,1",
        "certify x4-flyer --box=-1,{},-1,1,-4,-3",
        "export x4-flyer --out fw --rotor-limits 0,{}",
        "see 0 --tag 36h11:0:{}",
    ],
)
def test_an_exponent_that_would_fill_the_memory_is_refused_at_once(words, capsys):
    for number in ("1e999999999", "1e-999999999", "1e٩٩٩٩٩٩٩٩٩"):
        assert "must be" in refusal(capsys, *words.format(number).split())
