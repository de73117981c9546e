"""Every answer says which of the eight laws it is about, and only what holds for it."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import hoverproof as hp
from command_line import run
from hoverproof import checker
from hoverproof.algebra.decimals import decimal_below
from hoverproof.certification import robust
from hoverproof.certification.flow import flow_of
from hoverproof.certification.problem import gain_problem
from hoverproof.design.atlas import axis, cell_margins
from hoverproof.export.package import NotCertified, write_package
from hoverproof.export.standing import Standing
from hoverproof.mission.task import LawChoice
from hoverproof.plant.goal import hover_goal
from hoverproof.reporting import mathematics
from hoverproof.reporting.numerals import bounded
from hoverproof.servo.hover_error import hover_error
from hoverproof.show.decay import decay_along
from hoverproof.show.figures import features_figure
from hoverproof.show.region import region_figure
from sampling import mostly_whole
from small_kit import small_vehicle

SMALL = small_vehicle(bounds='"auto"', start="[0.1, 0, -1.3]")
PAPERS = ("centroid", "image", "modelled")
BEST = ("scaled", "inertial", "measured")
OTHERS = [law for law in hp.LAWS if law != PAPERS]
ALL = pytest.mark.parametrize("law", hp.LAWS, ids="/".join)
SOME = pytest.mark.parametrize("law", mostly_whole([(law,) for law in hp.LAWS], every=3))
"""Each choice of a law is in one of them."""


def named(law):
    return dict(zip(("law.feature", "law.goal", "law.force"), law, strict=True))


def options(law):
    return [word for key, value in named(law).items() for word in ("--set", f"{key}={value}")]


@pytest.fixture(autouse=True)
def small():
    Path("small.toml").write_text(SMALL, encoding="utf-8")


def mission_of(law, more=None):
    return hp.load("small.toml", {**named(law), **(more or {})})


def symbol(law):
    return "J" if law[0] == "scaled" else "Q"


@pytest.mark.slow
@SOME
def test_certify_and_region_say_their_law_and_what_is_bounded(law, capsys):
    name, of = "/".join(law), symbol(law)
    for command in ("certify", "region"):
        figure = ("--no-figure",) if command == "region" else ()
        status, out, err = run(capsys, command, "small.toml", *options(law), *figure)
        assert status in (0, 1), err
        first, second, *rest = out.splitlines()
        assert first.startswith("small: ")
        says = f"  law                     {name} (feature/goal/force)"
        assert (second == says) == (law != PAPERS)
        text = "\n".join([second, *rest])
        assert ("symmetric Q" in text) == (of == "Q" and command == "certify")
        assert ("eigenvalues" in text) == (of == "Q")
        assert ("|J - " in text) == (of == "J")
        assert ("printed theorem" in text) == (law == PAPERS and command == "certify")
        _, out, _ = run(capsys, command, "small.toml", *options(law), *figure, "--json")
        told = json.loads(out)
        assert told["law"] == dict(zip(("feature", "goal", "force"), law, strict=True))
        if command == "region":
            assert told["bounded"] == flow_of(mission_of(law)).words
            continue
        assert (told["eigenvalues"] is None, told["ball"] is None) == (of == "J", of == "Q")
        assert (told["paper_conditions"] is None) == (law != PAPERS)


@pytest.mark.slow
@SOME
def test_a_flight_says_its_law_in_its_file_and_in_its_figures(law, capsys):
    status, out, _ = run(capsys, "simulate", "small.toml", *options(law), "--no-figures", "--json")
    told = json.loads(out)
    assert (status, told["outcome"]) == (0, "flown")
    assert told["law"]["force"] == law[2]
    with xr.open_dataset(told["out"], engine="h5netcdf") as flight:
        assert flight.attrs["law"] == "/".join(law)
        assert ("centroid q" in flight["centroid"].attrs["long_name"]) == (law[0] == "centroid")
        title = features_figure(flight)._suptitle.get_text()
    assert ("/".join(law) in title) == (law != PAPERS)


def test_the_flight_of_a_law_that_is_made_elsewhere_is_said_to_be_its_own():
    mission = mission_of(PAPERS)
    flight = hp.simulate(mission, duration=0.1, law=replace(hp.LAWS[BEST], variant="mine"))
    assert flight.attrs["law"] == "scaled/inertial/measured (mine)"


@pytest.mark.slow
@ALL
def test_a_certificate_is_refused_for_every_other_law(law, capsys):
    status, out, err = run(capsys, "certify", "small.toml", *options(law), "--out", "c.json")
    assert status in (0, 1), err
    others = [other for other in hp.LAWS if other != law][:3]
    for other in (law, *others):
        about = ("check", "c.json", "--mission", "small.toml", *options(other))
        status, out, _ = run(capsys, *about)
        assert (status == 0) == (other == law)
        assert ("law." in out) == (other != law)


def test_a_package_takes_a_certificate_of_its_own_law_alone(tmp_path, capsys):
    above = ("centroid", "inertial", "modelled")
    tuned = {"bounds.eigenvalues": "[2.9, 4.1]"}
    own, papers = mission_of(above), mission_of(PAPERS)
    verdict = hp.certify(own)
    assert verdict.status == "proved"
    standing = Standing(verdict.problem.thrust, verdict.certificate.content)
    with pytest.raises(checker.Rejected, match="the law centroid/inertial/modelled, not about cen"):
        write_package(papers, tmp_path / "a", standing)
    with pytest.raises(checker.Rejected, match="not about centroid/image/modelled"):
        write_package(own, tmp_path / "a", standing, law=hp.LAWS[PAPERS])
    with pytest.raises(checker.Rejected, match="another mission"):
        write_package(mission_of(above, tuned), tmp_path / "a", standing)
    with pytest.raises(NotCertified, match="its certificate is about its law, centroid/inertial"):
        hp.export_c(own, tmp_path / "a", law=hp.LAWS[PAPERS])
    assert not (tmp_path / "a").exists()
    status, out, _ = run(capsys, "export", "small.toml", *options(above), "--out", tmp_path / "b")
    assert status == 0
    assert "law                     centroid/inertial/modelled" in out
    manifest = json.loads((tmp_path / "b" / "manifest.json").read_text("utf-8"))
    assert manifest["certified"]
    assert manifest["law"] == dict(zip(("feature", "goal", "force"), above, strict=True))
    assert "law centroid/inertial/modelled" in (tmp_path / "b" / "small.h").read_text("utf-8")
    held = json.loads((tmp_path / "b" / "small.cert.json").read_text("utf-8"))
    assert held["mission"]["law"] == manifest["law"]


@pytest.mark.parametrize("law", OTHERS, ids="/".join)
def test_what_is_about_the_law_of_the_paper_alone_refuses_another(law, capsys):
    words = ("tune", "small.toml", "--objective", "region", *options(law))
    status, out, err = run(capsys, *words)
    assert (status, out) == (2, "")
    assert err.splitlines()[-1].startswith(f"hoverproof: small.toml: law: {'/'.join(law)} is ")
    assert "gains are searched by their region of attraction for that law alone" in err
    assert len(re.findall("(?m)^hoverproof: ", err)) == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "law",
    [PAPERS, ("centroid", "inertial", "measured"), pytest.param(BEST, marks=pytest.mark.whole)],
    ids="/".join,
)
def test_tuned_gains_certify_for_their_own_law(law):
    found = hp.tune(mission_of(law), objective="decay")
    assert found.status == "tuned"
    assert found.mission.law.name == "/".join(law)
    again = hp.certify(found.mission)
    assert again.status == "proved"
    assert again.decay_rate == found.verdict.decay_rate
    assert checker.check(found.verdict.certificate.content)


@pytest.mark.slow
def test_a_tuned_mission_is_written_with_its_law(capsys):
    law = options(BEST)
    words = ["tune", "small.toml", "--objective", "decay", "--out", "tuned.toml", "--json"]
    status, out, _ = run(capsys, *words, *law)
    assert status == 0
    told = json.loads(out)
    assert told["hover_error"] is None
    assert told["ball"]["radius"] > 0
    assert hp.load("tuned.toml").law == LawChoice(**told["law"])
    assert hp.certify(hp.load("tuned.toml")).status == "proved"


@ALL
def test_a_map_has_the_margin_that_is_proved(law):
    """Cell by cell it is the margin of the very question that `certify` answers."""
    mission = mission_of(law)
    verdict = hp.certify(mission)
    k3, k4 = (float(getattr(mission.gains, k)) for k in ("k3", "k4"))
    ones = (Fraction(1),) * 4
    (found,) = cell_margins(mission, "k3", "k4", ones, np.array([[k3, k4]]))
    problem = gain_problem(mission)
    worst = min(float(robust.margins(problem.inequality(f))[0]) for f in problem.factor)
    assert found == pytest.approx(worst, rel=1e-6, abs=1e-9)
    assert (found > 0) == (verdict.status == "proved")


def test_an_axis_of_a_ball_is_no_eigenvalue():
    given = {"bounds.eigenvalues": "[5, 10]"}
    one = axis(mission_of(BEST, given), "highest_eigenvalue").quantity
    assert "eigenvalue" not in one.told(mission_of(BEST, given))
    assert one.told(mission_of(PAPERS, given)) == "highest eigenvalue of Q"


@pytest.mark.slow
@pytest.mark.parametrize(
    "law",
    mostly_whole([(("centroid", "inertial", "modelled"),), (BEST,)], every=2, first=1),
    ids=["inertial", "best"],
)
def test_a_report_of_another_law_says_what_it_is_about_and_leaves_out_the_rest(law, capsys):
    arguments = ("report", "small.toml", *options(law), "--without", "firmware", "-o", "r.html")
    brief = ("--without", "attraction") if law == BEST else ()
    status, *_ = run(capsys, *arguments, *brief)
    assert status == 0
    page = Path("r.html").read_text("utf-8")
    words = re.sub(r"(?s)<(style|script).*?</\1>|<[^>]*>", " ", page)
    before = words.partition("The paper, judged")[0]
    assert f"Law {'/'.join(law)}: " in before
    assert "It is not the paper&#39;s law." in before
    assert "asked for by the printed theorem" not in words
    assert "the equations behind the theorem" not in words
    assert "whose controller is another than this mission's" in words
    assert ("eigenvalues" in before) == (law != BEST)
    assert ("the sum of all forces, which is zero at rest" in words) == (law == BEST)
    assert ("scaled, s*, which the law uses" in words) == (law == BEST)
    assert "What the symbols mean" in words
    assert f"without any assumption on {symbol(law)}." in words
    assert ("hover, 1 % less thrust" in words) == (law != BEST)


def test_the_formula_of_a_ball_holds_no_more_than_is_proved():
    low, high = Fraction(1, 3), Fraction(10, 7)
    line, _ = mathematics.question((low, high), (Fraction(4), Fraction(6)), "J")
    j, reach = (Fraction(x) for x in re.findall(r"\d+\.\d+", line))
    assert low <= j - reach
    assert j + reach <= high
    words = bounded(mission_of(BEST), (low, high), "inward")
    j, reach = (Fraction(x) for x in re.findall(r"\d+\.\d+", words))
    assert low <= j - reach
    assert j + reach <= high
    words = bounded(mission_of(BEST), (low, high), "outward")
    j, reach = (Fraction(x) for x in re.findall(r"\d+\.\d+", words))
    assert j - reach <= low
    assert high <= j + reach


def test_the_decay_of_the_scaled_feature_ends_where_j_leaves_its_ball():
    mission = mission_of(BEST)
    verdict, flight = hp.certify(mission), hp.simulate(mission)
    assert decay_along(flight, verdict).until == flight["time"].values[-1]
    far = hp.simulate(mission_of(BEST, {"start.position": "[0.6, 0, -1.8]"}))
    assert decay_along(far, verdict) is None


def test_a_ball_that_is_broken_is_told_by_its_distance(capsys):
    given = ("--set", "bounds.eigenvalues=[7.9, 8.1]", "--no-figure")
    status, out, _ = run(capsys, "region", "small.toml", *options(BEST), *given)
    assert status == 1
    assert "distance from j I" in out
    _, out, _ = run(capsys, "region", "small.toml", *options(BEST), *given, "--json")
    witness = json.loads(out)["witness"]
    assert witness["distance"] > 0.1
    assert "eigenvalue" not in witness


@pytest.mark.slow
def test_a_figure_of_bounds_names_the_law():
    from hoverproof.certification.over_box import certify_region
    from hoverproof.certification.region import default_box

    for law in (PAPERS, BEST):
        mission = mission_of(law)
        figure = region_figure(mission, certify_region(mission, default_box(mission)))
        title = figure.axes[0].get_title()
        assert ("scaled/inertial/measured" in title) == (law == BEST)
        assert f"the bounds of {symbol(law)} hold" in title


def test_the_hover_of_an_inertial_goal_moves_as_is_said():
    mission = mission_of(("centroid", "inertial", "modelled"))
    told = hover_error(mission)
    heavy = mission_of(("centroid", "inertial", "modelled"), {"model_error.mass": "0.01"})
    end = hp.simulate(heavy, duration=3000)["position"].values[-1]
    assert -end[2] == pytest.approx(told.heavier, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("feature", ["centroid", "scaled"])
def test_the_hover_of_a_law_that_measures_its_force_does_not_move(feature):
    heavy = mission_of((feature, "inertial", "measured"), {"model_error.mass": "0.01"})
    end = hp.simulate(heavy, duration=3000 if feature == "centroid" else 100)
    goal = [float(x) for x in hover_goal(heavy).position]
    assert end["position"].values[-1] == pytest.approx(goal, abs=1e-3)


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("law.feature=centre", "law.feature: must be 'centroid' or 'scaled', not 'centre'"),
        ("law.goal=3", "law.goal: must be 'image' or 'inertial', not 3"),
        ("law.force=[1]", "law.force: must be 'modelled' or 'measured', not [1]"),
        ("law.forces=measured", "law.forces: unknown key (did you mean 'force'?)"),
        ("law=scaled", "law: must be a section, not 'scaled'"),
    ],
)
def test_a_bad_law_is_one_line_that_says_what_is_right(setting, words, capsys):
    status, out, err = run(capsys, "certify", "small.toml", "--set", setting)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert words in err


def test_an_inertial_goal_off_the_vertical_is_refused(capsys):
    aside = ("--set", "goal={centroid = [0.1, 0, 3.9]}", "--set", "law.goal=inertial")
    status, _, err = run(capsys, "certify", "small.toml", *aside)
    assert status == 2
    assert err.count("\n") == 1
    assert "goal.centroid: must be [0, 0, q3] for law.goal = 'inertial'" in err


def test_a_new_mission_names_the_law_of_the_paper_in_a_comment(capsys):
    assert run(capsys, "new", "mine.toml", "--from", "x4-flyer")[0] == 0
    text = Path("mine.toml").read_text("utf-8")
    assert '\n# [law]\n# feature = "centroid"' in text
    plain = hp.load("mine.toml")
    block = re.search(r"(?s)# \[law\].*?\n\n", text)[0]
    bare = re.sub("(?m)^# ", "", block)
    Path("mine.toml").write_text(text.replace(block, bare), encoding="utf-8")
    assert hp.load("mine.toml").exact() == plain.exact()


def test_the_rate_that_a_label_shows_is_no_more_than_proved():
    verdict = hp.certify(mission_of(BEST))
    shown = decay_along(hp.simulate(mission_of(BEST)), verdict).label()
    (rate,) = re.findall(r"exp\(-([\d.]+) t\)", shown)
    assert Fraction(rate) <= verdict.decay_rate
    assert Fraction(rate) >= decimal_below(verdict.decay_rate, 3) * Fraction(99, 100)
