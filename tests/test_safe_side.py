"""Whatever tells a proved number rounds it to the side on which it is still proved."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from fractions import Fraction as F
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

from hoverproof.algebra import decimals
from hoverproof.algebra.decimals import at_least, at_most, degrees_at_most
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
from hoverproof.show import attraction as of_potential
from hoverproof.show import exponential as of_exponential
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
    rad, degrees = told(decimals.angle_at_most(ends[0]))
    assert rad >= ends[0]
    assert degrees >= math.degrees(ends[0]) * (1 - 1e-15)
    assert degrees <= math.degrees(ends[0]) * 1.002


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


def test_tolerances_are_told_with_all_the_digits_that_they_were_given_with():
    covers = {"thrust": F("0.0123456789"), "latency": F("0.0000123456789")}
    mission = load("crazyflie-2.1", {f"uncertainty.{key}": x for key, x in covers.items()})
    said = ", ".join(mission.covers())
    assert "thrust ±1.23456789 %" in said
    assert "latency up to 1.23456789e-05 s" in said


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


def labels(draw, *arguments):
    """Return the labels of what is drawn, one below the other."""
    axes = Figure().subplots()
    draw(axes, *arguments)
    return "\n".join(axes.get_legend_handles_labels()[1])


@pytest.mark.parametrize("scale", [F(1), F(98765, 3)])
def test_what_the_figures_say_is_proved(converges, scale):
    verdict = converges["crazyflie-2.1"]
    radius, time = (F(getattr(verdict.settling, k)) * scale for k in ("radius", "time"))
    verdict = replace(verdict, settling=Settling(radius, time), rate=verdict.rate * scale)
    view = of_exponential.View(verdict)
    text = labels(of_exponential.draw_distance, view, None)
    near, soon = line(text, "proved: within")
    assert near >= radius
    assert soon >= time
    assert told(text.split("exp(−")[1])[0] <= verdict.rate
    low, high = line(
        labels(of_exponential.draw_section, view, None), "nor this, as the theorem states it:"
    )
    assert low <= verdict.heights[0]
    assert high >= verdict.heights[1]
    region = converges["x4-flyer"]
    region = replace(region, level=F("3084.83") * scale, barrier_height=F("0.50785"))
    zero, true, times = np.zeros(1), np.ones(1, bool), np.arange(of_potential.SAMPLES + 1.0)
    still = of_potential.Flights(zero, zero, true, true, times, np.exp(-times)[None])
    assert line(labels(of_potential.draw_energy, region, still), "proved level")[0] <= region.level
    view = of_potential.View.of(region)
    text = labels(of_potential.draw_section, region, view, still)
    assert line(text, "barrier,")[0] >= region.barrier_height  # of which states it is said


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


def test_one_tilt_is_told_by_answer_report_and_package():
    from hoverproof.export.contents import _tilt
    from hoverproof.export.standing import checked
    from hoverproof.servo.laws.heading import flown_law

    mission, held = load("crazyflie-2.1"), json.loads(KEPT.read_text(encoding="utf-8"))
    standing = checked(Standing((F(0), F(1)), None, held), mission, flown_law(mission))
    _, package = _tilt(mission, standing.thrust[1] - mission.vehicle.weight, standing.tilt_cosine)
    proved = attraction_once(mission)
    answer = "\n".join(AttractionAnswer(proved, None, None).text())
    told = degrees_at_most(proved.tilt)
    assert proved.certificate.content["claim"] == held["claim"]
    assert package == f"{told} degrees (proved on the way)"
    assert f"rad ({told}°) or less" in answer
    assert f"({told}°) or less" in dict(exponential_table(proved).rows)["tilt on the way"]


def test_a_package_says_that_its_two_theorems_are_about_one_goal():
    starts = json.loads(KEPT.read_text(encoding="utf-8"))
    gains = json.loads(KEPT.with_name("crazyflie-2.1.cert.json").read_text(encoding="utf-8"))
    mission, both = load("crazyflie-2.1"), Standing((F(0), F(1)), gains, starts)
    said = "Both are about the same goal, the hover at (0, 0, -1) m: theorem 1 names the centroid"
    assert said in evidence(both, mission).statement
    assert "same goal" not in evidence(replace(both, certificate=None), mission).statement
    paper = load("x4-flyer")  # whose theorems name it alike
    assert "same goal" not in evidence(both, paper).statement


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
