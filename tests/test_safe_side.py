"""Whatever tells a proved number rounds it to the side on which it is still proved."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from fractions import Fraction as F
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hoverproof.algebra.decimals import at_least, at_most
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.attraction.verdict import Reach
from hoverproof.certification.exponential.verdict import Settling
from hoverproof.cli.answers import words
from hoverproof.cli.answers.attraction import AttractionAnswer, describe
from hoverproof.cli.answers.exponential import of_lens
from hoverproof.export.standing import Standing, evidence
from hoverproof.mission.reading import load
from hoverproof.reporting import numerals
from hoverproof.reporting.tables import attraction_table, exponential_table
from once import attraction_once

SUPERSCRIPT = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
NUMBER = re.compile(r"(?<![\w.])([-−]?\d+(?:\.\d+)?)(?:×10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?")
KEPT = Path(__file__).parent.parent / "proofs" / "crazyflie-2.1.attraction.cert.json"

above_zero = st.fractions(F(1, 10**7), 10**7, max_denominator=10**12)
intervals = st.tuples(above_zero, above_zero).map(sorted).filter(lambda ends: ends[0] < ends[1])
few = settings(max_examples=30, deadline=None)


def told(text):
    """Return the numbers in a text, exactly."""
    found = NUMBER.findall(text)
    return [
        F(a.replace("−", "-")) * F(10) ** int((b or "0").translate(SUPERSCRIPT)) for a, b in found
    ]


def line(text, begin):
    """Return the numbers of the line that begins so, after that."""
    (one,) = (x.strip() for x in text.splitlines() if x.strip().startswith(begin))
    return told(one.removeprefix(begin))


@given(st.fractions(-(10**9), 10**9), intervals)
def test_bounds_and_intervals_are_safe_and_near(value, ends):
    for low, high in (
        (at_least(value), at_most(value)),
        (numerals.at_least(value), numerals.at_most(value)),
    ):
        assert told(low)[0] <= value <= told(high)[0]
        assert told(high)[0] - told(low)[0] <= abs(value) / 999
    inner, outer = told(words.inside(ends)), told(words.enclosure(ends))
    assert outer[0] <= ends[0] <= inner[0]
    assert inner[1] <= ends[1] <= outer[1]
    rad, degrees = told(words.angle(ends[0]))
    assert rad >= ends[0]
    assert degrees >= math.degrees(ends[0]) * (1 - 1e-15)


@given(intervals, above_zero, above_zero)
def test_no_start_is_told_that_is_not_inside(side, x, speed):
    of = Start((side, (x, x), side), speed=speed)
    low, high, _, _, _, most = told(describe(of))
    assert side[0] <= low
    assert high <= side[1]
    assert most <= speed


@pytest.fixture(scope="module")
def converges():
    return {name: attraction_once(load(name)) for name in ("crazyflie-2.1", "x4-flyer")}


@few
@given(above_zero, above_zero, above_zero, above_zero, intervals, intervals, intervals)
def test_what_is_told_of_theorem_5_is_proved(
    converges, time, radius, rate, tilt, thrust, rotor, wedge
):
    verdict = replace(
        converges["crazyflie-2.1"],
        settling=Settling(radius, time),
        rate=rate,
        tilt=tilt,
        thrust=thrust,
        rotor_thrusts=(rotor,) * 4,
        field_of_view=tilt,
        ultimate_radius=radius,
        wedge=((F(0), F(1)), (F(0), F(1)), wedge),
    )
    text = "\n".join(AttractionAnswer(verdict, None, None).text())
    rows = dict(exponential_table(verdict).rows)
    for soon, near in (
        (line(text, "settled")[0], told(text.split("then on within")[1])[0]),
        reversed(told(rows["settled"])),
        reversed(told(verdict.gist)),
    ):
        assert soon >= time
        assert near >= radius
    assert line(text, "ultimate bound")[0] >= radius
    assert line(text, "decay rate              Ψ falls as exp(-r t), r =")[0] <= rate
    assert told(rows["decay rate of Ψ"])[0] <= rate
    for begin, row in (("tilt", "tilt on the way"), ("target points  ", "target points")):
        assert line(text, begin)[0] >= tilt
        assert told(rows[row])[0] >= tilt
    heights = 1 / wedge[1], 1 / wedge[0]
    for begin, row, ends in (
        ("height", "height above the target", heights),
        ("thrust                  in", "thrust on the way, × true / modelled mass", thrust),
        ("thrust of each rotor", "thrust of each rotor", rotor),
    ):
        for low, high in (line(text, begin)[:2], told(rows[row])[:2]):
            assert low <= ends[0]
            assert ends[1] <= high


@few
@given(above_zero, above_zero, above_zero, above_zero, intervals)
def test_what_is_told_of_theorem_3_is_proved(converges, level, height, far, tilt, thrust):
    verdict = replace(
        converges["x4-flyer"],
        level=level,
        barrier_height=height,
        reach=Reach(far, far, far),
        tilt=tilt,
        thrust=thrust,
    )
    text = "\n".join(AttractionAnswer(verdict, None, None).text())
    inside = re.search(r"at\s+least\s+(\S+) m\s.*?Λ\s+<=\s+(\S+);", text, re.DOTALL)
    assert told(inside[1])[0] >= height  # of which states it is said
    assert told(inside[2])[0] <= level
    rows = dict(attraction_table(verdict).rows)
    for way in ("sideways, all round", "up", "down"):
        assert line(text, way)[0] <= far
        assert told(rows[way])[0] <= far
    assert all(x <= far for x in told(verdict.gist))
    assert line(text, "tilt")[0] >= tilt
    assert line(text, "height")[0] <= height  # what is kept on the way
    for low, high in (line(text, "thrust")[:2], told(rows["thrust on the way"])[:2]):
        assert low <= thrust[0]
        assert thrust[1] <= high


@pytest.mark.parametrize("scale", [F(1), F(1, 12345), F(98765, 3)])
def test_what_a_package_says_is_proved(scale):
    held = json.loads(KEPT.read_text(encoding="utf-8"))
    claim = held["claim"]
    claim["settling"] |= {k: str(F(claim["settling"][k]) * scale) for k in ("time", "radius")}
    claim["rate"] = str(F(claim["rate"]) * scale)
    claim["rotors"] = [str(F(x) * scale) for x in claim["rotors"]]
    said = evidence(Standing((F(0), F(1)), None, held), load("crazyflie-2.1"))
    time, radius, rate = told(said.proofs[0].gist)[:3]
    assert time >= F(claim["settling"]["time"])
    assert radius >= F(claim["settling"]["radius"])
    assert F(claim["rate"]) * F(999, 1000) <= rate <= F(claim["rate"])
    low, high = told(said.rotors_in_words)
    assert low <= F(claim["rotors"][0])
    assert F(claim["rotors"][1]) <= high


def test_what_a_lens_must_see_is_told_where_nobody_said_what_it_sees(converges):
    proved = converges["crazyflie-2.1"]
    told_of = {}
    for half in (None, F(3, 2)):
        camera = proved.mission.camera.model_copy(update={"half_angle": half, "lens": None})
        mission = proved.mission.model_copy(update={"camera": camera})
        sensors = mission.sensors.model_copy(update={"width": None, "height": None})
        mission = mission.model_copy(update={"sensors": sensors})
        told_of[half] = of_lens(replace(proved, mission=mission, field_of_view=F(1)))
    assert told_of[F(3, 2)] == []
    must, nothing = told_of[None]
    (whole,) = told(must)
    assert 2 * math.degrees(1) <= whole <= 2 * math.degrees(1) * 1.001
    assert "camera.half_angle" in nothing
