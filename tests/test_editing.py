"""Mission files written back: the same mission, with the comments that were there."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hoverproof.errors import InputError
from hoverproof.mission.presets import preset_text
from hoverproof.mission.reading import load
from hoverproof.mission.writing import decimal, mission_text

CHANGES = [
    {},
    {"gains.k1": "0.000123", "gains.k_yaw": "7"},
    {"start.velocity": "[1, 0, -0.5]"},
    {"bounds": "{eigenvalues = [0.02, 4], level = 3}"},
    {"goal": "{centroid = [0.1, 0, 3]}"},
    {"bounds": '{eigenvalues = "auto", level = 3}'},
    {"target.points": "[[0, 0, 0], [1, 0, 0], [0, 2, 0.125]]"},
]


@pytest.mark.parametrize("change", CHANGES)
def test_what_is_written_loads_as_the_same_mission_with_its_comments(change):
    mission = load("x4-flyer", change)
    text = mission_text(mission, name="mine", note="two\nlines")
    Path("mine.toml").write_text(text)
    assert load("mine.toml").exact() == mission.exact() | {"name": "mine"}
    assert text.startswith("# two\n# lines\n# The X4-flyer")
    assert "# Corners of a square in the world frame" in text
    if not change:
        body = text.removeprefix("# two\n# lines\n")
        assert body.replace('"mine"', '"x4-flyer"') == preset_text("x4-flyer")
    again = load("mine.toml", {"gains.k2": "7.25"})
    Path("again.toml").write_text(mission_text(again))
    assert load("again.toml").exact() == again.exact()


def test_a_file_in_another_layout_keeps_it():
    text = preset_text("x4-flyer").split("[gains]")
    gains = "gains = {k1 = 0.2, k2 = 10, k3 = 30.5, k4 = 3, k_yaw = 1}\n"
    bounds = "[bounds]" + text[1].split("[bounds]")[1]
    Path("inline.toml").write_text(gains + text[0] + bounds)
    mission = load("inline.toml", {"gains.k4": "4.5"})
    edited = mission_text(mission)
    assert edited == Path("inline.toml").read_text().replace("k4 = 3", "k4 = 4.5")
    Path("out.toml").write_text(edited)
    assert load("out.toml").exact() == mission.exact()


def test_a_mission_whose_source_is_gone_is_written_plainly():
    mission = load("x4-flyer").model_copy(update={"source": "gone.toml"})
    Path("out.toml").write_text(mission_text(mission))
    assert load("out.toml").exact() == mission.exact()


@settings(max_examples=100)
@given(st.decimals(allow_nan=False, allow_infinity=False, places=12, min_value=-9, max_value=9))
def test_decimals_are_exact(value):
    assert Fraction(decimal(Fraction(value))) == Fraction(value)


def test_a_number_without_a_decimal_is_refused():
    with pytest.raises(InputError, match="is no decimal"):
        decimal(Fraction(1, 3))
