"""Answers name what they rest on, and leave out what does not apply."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import pytest

from command_line import run
from hoverproof.algebra.decimals import angle_at_most, at_least, at_most
from hoverproof.certification.attraction.verdict import Sinks, not_covered
from hoverproof.certification.over_box import enclose
from hoverproof.certification.region import default_box
from hoverproof.cli.answers.glossary import legend
from hoverproof.cli.answers.words import enclosure, limits_text
from hoverproof.design.limits import Use
from hoverproof.mission.presets import preset_text
from hoverproof.mission.reading import load
from hoverproof.reporting.symbols import STATED, SYMBOLS
from hoverproof.simulation import runs


@pytest.mark.slow
def test_runs_of_which_none_is_complete_tell_nothing_of_settling(capsys, monkeypatch):
    def at_once(*_, **__):
        raise KeyboardInterrupt
        yield

    monkeypatch.setattr(runs, "spread", at_once)
    scatter = ("--set", "scatter.position=[1,1,1]", "--duration", 1)
    status, out, _ = run(capsys, "simulate", "x4-flyer", "--runs", 20, *scatter)
    assert status == 130
    assert "x4-flyer: 0 of 20 runs" in out
    assert not re.search("settled|error at the end", out)
    monkeypatch.undo()
    assert "settled within 10 %" in run(capsys, "simulate", "x4-flyer", "--runs", 20, *scatter)[1]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            (),
            "[0, 47.04] N each (--rotor-limits)\n"
            "          assumed: half the weight, as the mission names none",
        ),
        (("--rotor-limits", "0,40"), "[0, 40] N each\n          given to the export"),
        (
            ("--set", "rotors.max_thrust=40", "--set", "rotors.min_thrust=1"),
            "[1, 40] N each (--rotor-limits)\n          from [rotors] of the mission",
        ),
    ],
)
def test_export_tells_where_the_limits_of_the_rotors_come_from(options, words, capsys):
    status, out, _ = run(capsys, "export", "x4-flyer", "--out", "firmware", *options)
    assert status == 0
    assert f"  rotors  {words}" in out
    told = json.loads(Path("firmware/manifest.json").read_text("utf-8"))["rotor_limits_from"]
    assert told in out


NEAR = {
    "start.position": "[0.5, 0.5, -0.1]",
    "target.points": "[[1,1,0],[1,-1,0],[-1,-1,0],[0,0,0]]",
}


@pytest.mark.parametrize(
    ("more", "command", "key"),
    [
        ((), ["region"], "start.position"),
        ((), ["certify", "--over-box"], "start.position"),
        (("bounds.eigenvalues=auto",), ["certify"], "start.position"),
        (
            ("bounds.eigenvalues=auto", "bounds.box=[[-2, 2], [-2, 2], [-4, 1]]"),
            ["certify"],
            "bounds.box",
        ),
        ((), ["region", "--box=-2,2,-2,2,-4,1"], "--box"),
    ],
)
def test_a_box_that_holds_a_target_point_is_named_and_printed(more, command, key, capsys):
    settings = [f"{k}={v}" for k, v in NEAR.items()] + list(more)
    options = [part for setting in settings for part in ("--set", setting)]
    status, out, err = run(capsys, command[0], "x4-flyer", *command[1:], *options)
    assert (status, out) == (2, "")
    assert f": {key}: " in err
    assert re.search(r"\[\S+, \S+\] x \[\S+, \S+\] x \[\S+, \S+\] m holds a target point", err)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("bounds", "broken"),
    [("[0.9, 1]", {"lower", "upper"}), ("[0.9, 5]", {"lower"}), ("[0.01, 1]", {"upper"})],
)
def test_every_broken_bound_is_told(bounds, broken, capsys):
    setting = ("--set", f"bounds.eigenvalues={bounds}")
    status, out, _ = run(capsys, "region", "x4-flyer", "--no-figure", *setting)
    assert status == 1
    told = dict(re.findall(r"^  (lower|upper) bound broken.*?([\d.]+) 1/m", out, flags=re.M))
    assert set(told) == broken
    mission = load("x4-flyer")
    extremes = dict(
        zip(("lower", "upper"), enclose(mission, default_box(mission)).attained, strict=True)
    )
    for which, value in told.items():
        assert float(value) == pytest.approx(extremes[which], rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "without_barrier"),
    [
        (("--start", "0.1,0,-3", "--no-barrier"), True),
        (("--start", "0.1,0,-3", "--barrier"), False),
    ],
)
def test_the_ground_is_left_open_by_a_proof_without_a_barrier_alone(
    options, without_barrier, capsys
):
    status, out, _ = run(capsys, "attraction", "x4-flyer", "--no-figure", *options)
    assert status == 0
    assert ("the ground:" in out) == without_barrier


def test_a_refuted_start_leaves_no_ground_open():
    sinks = Sinks(mission=None, certificate=None, state=None, time=None)
    assert not [line for line in not_covered(sinks) if "ground" in line]


def test_check_of_a_mission_says_that_a_certificate_is_wanted(capsys):
    Path("quad.toml").write_text(preset_text("x4-flyer"), encoding="utf-8")
    status, _, err = run(capsys, "check", "quad.toml")
    assert status == 2
    assert "quad.toml: is not JSON, and so not a certificate, as certify" in err


def test_over_a_box_the_bounds_of_the_mission_are_said_to_be_unused(capsys):
    unused = "the mission's own bounds [0.01, 5] 1/m are not used"
    assert unused in run(capsys, "certify", "x4-flyer", "--over-box")[1]
    assert "not used" not in run(capsys, "certify", "x4-flyer")[1]
    auto = ("--set", "bounds.eigenvalues=auto")
    assert "not used" not in run(capsys, "certify", "x4-flyer", "--over-box", *auto)[1]


def test_bounds_are_written_on_the_safe_side():
    value = Fraction(123456, 1000)
    assert (at_least(value), at_most(value)) == ("123.4", "123.5")
    assert (at_least(-value), at_most(-value)) == ("-123.5", "-123.4")
    assert enclosure((Fraction(1, 3), Fraction(2, 3))) == "[0.3333, 0.6667]"
    assert angle_at_most(Fraction(1, 10)) == "0.1 rad (5.73°)"
    assert at_most(Fraction(1, 30000)) == "3.334×10⁻⁵"


def test_symbols_are_explained_at_the_foot_where_they_stand_alone():
    assert legend(["x4-flyer: proved", "written to  L.toml, Q-tuned.toml"]) == []
    assert " ".join(" ".join(legend(["  every Q"])).split()) == f"Symbols: Q: {SYMBOLS['Q']}"
    *told, where = legend(["  XᵀΣX <= -1, every Q", "  Ψ falls"])
    words = " ".join(" ".join(told).split())
    assert words == "Symbols: " + "; ".join(f"{s}: {SYMBOLS[s]}" for s in "QΣΨ")
    assert where == f"Theorems: {STATED}"
    assert legend(["  converges (theorem 5, exponential)"]) == [where]


@pytest.mark.parametrize(
    ("arguments", "symbols"),
    [
        (("certify", "x4-flyer"), "QTLΣ"),
        (("certify", "x4-flyer", "--set", "gains.k4=0.1"), "QTLΣf"),
        (("attraction", "x4-flyer", "--no-figure"), "Λ"),
        (("presets",), ""),
        (("presets", "x4-flyer"), ""),
        (("derive", "--equation", "31"), ""),
    ],
    ids=" ".join,
)
def test_an_answer_explains_its_symbols_before_what_comes_next(arguments, symbols, capsys):
    out = run(capsys, *arguments)[1]
    foot = re.search(r"(?ms)^Symbols: (.*?)(?=^Theorems:|^Next:|\Z)", out)
    assert (foot is None) == (not symbols)
    if foot is not None:
        told = " ".join(foot[1].split())
        assert [s for s in SYMBOLS if f"{s}: {SYMBOLS[s]}" in told] == [*symbols]


def test_digits_in_names_of_files_are_explained_where_they_are_printed(capsys):
    _, out, _ = run(capsys, "certify", "x4-flyer", "--set", "gains.k4=177")
    (digits,) = re.findall(r"x4-flyer\.([0-9a-f]{8})\.cert\.json$", out, re.MULTILINE)[:1]
    assert f"\n  {digits} in names of files stands for the settings made by --set\n" in out
    assert "in names of files" not in run(capsys, "certify", "x4-flyer")[1]


def test_a_limit_without_a_unit_has_none():
    use = Use("bandwidth times sampling period", 0.05, 0.2, "1")
    assert list(limits_text([use])) == [
        "  bandwidth times sampling period: 0.05, limit 0.2: does not bind"
    ]
