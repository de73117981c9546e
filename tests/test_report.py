"""The report of a mission: one file that opens without a network and tells what is known."""

from __future__ import annotations

import base64
import io
import itertools
import json
import re
from fractions import Fraction
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

import hoverproof as hp
from command_line import run
from hoverproof import checker
from hoverproof.certification.gains import UndecidedGains, certify
from hoverproof.certification.problem import gain_problem
from hoverproof.errors import InputError
from hoverproof.export import cost
from hoverproof.mission.presets import presets
from hoverproof.paper.ledger import derive
from hoverproof.reporting import document, mathematics, parts, wording
from hoverproof.reporting.numerals import at_least, at_most, short
from hoverproof.reporting.page import CONTENTS
from hoverproof.reporting.player import _quaternions, player_data
from hoverproof.simulation.flight import flown
from hoverproof.simulation.timing import Timing
from once import start_or_ball_once
from papers_law import PAPERS
from sampling import mostly_whole

MEGABYTE = 1_000_000
VOID = {"meta", "link", "br", "img", "input", "hr"}
SLOW_PARTS = ("atlas", "region", "attraction", "firmware")


class Page(HTMLParser):
    """What a page is made of; feeding it fails where tags do not close in order."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.ids, self.links, self.loads, self.texts = [], [], [], [], {}
        self.tags, self.downloads = [], {}
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.tags.append((tag, values))
        if values.get("id"):
            self.ids.append(values["id"])
        if tag == "a" and "download" in values:
            self.downloads[values["download"]] = values["href"]
        elif tag == "a":
            self.links.append(values["href"])
        self.loads += [values[k] for k in ("src", "srcset", "data") if values.get(k)]
        if tag in ("link", "use", "image"):
            self.loads += [values.get("href") or values.get("xlink:href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, f"</{tag}> closes nothing"

    def handle_data(self, data):
        if self.open:
            self.texts[self.open[-1]] = self.texts.get(self.open[-1], "") + data


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A proved and a refuted mission, without the parts that take long."""
    folder = tmp_path_factory.mktemp("reports")
    missions = {
        "proved": hp.load("x4-flyer"),
        "refuted": hp.load("x4-flyer", {"gains.k4": "0.1"}),
    }
    without = SLOW_PARTS[:3]
    return {
        name: document.report(mission, folder / f"{name}.html", without=without)
        for name, mission in missions.items()
    }


@pytest.fixture(autouse=True)
def _regions_are_found_once(monkeypatch):
    monkeypatch.setattr(parts, "start_or_ball", start_or_ball_once)


def text_of(report):
    return report.path.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["proved", "refuted"])
def test_a_page_is_whole_and_well_formed(written, kind):
    text = text_of(written[kind])
    page = Page(text)
    assert len(page.ids) == len(set(page.ids))
    for anchor, words in CONTENTS:
        assert anchor in page.ids
        assert words in text
    fragments = {link.removeprefix("#") for link in page.links if link.startswith("#")}
    assert fragments <= set(page.ids)
    headings = [int(tag[1]) for tag, _ in page.tags if re.fullmatch(r"h[1-6]", tag)]
    assert headings[0] == 1
    assert headings.count(1) == 1
    assert all(b - a <= 1 for a, b in itertools.pairwise(headings))
    assert ("html", {"lang": "en"}) in page.tags


@pytest.mark.parametrize("kind", ["proved", "refuted"])
def test_a_page_loads_nothing_from_outside(written, kind):
    text = text_of(written[kind])
    page = Page(text)
    assert page.loads
    assert all(load.startswith(("data:", "#")) for load in page.loads), page.loads
    assert not re.findall(r"(?:https?:)?//[a-z]", re.sub(r'(?s)<a [^>]*href="[^"]*"', "", text))
    assert "@import" not in text
    assert not re.findall(r"url\((?!#)", text)


@pytest.mark.parametrize("kind", ["proved", "refuted"])
def test_every_figure_has_words_for_those_who_do_not_see_it(written, kind):
    page = Page(text_of(written[kind]))
    drawn = [values for tag, values in page.tags if tag in ("svg", "img", "canvas")]
    assert len(drawn) > 8
    assert all(len(v.get("aria-label") or v.get("alt") or "") > 20 for v in drawn)


def test_the_verdict_comes_first_in_words_and_formulas(written):
    text = text_of(written["proved"])
    assert text.index("Proved") < text.index('id="theorem"') < text.index('id="flight"')
    assert "<math" in text
    assert "0.001674424151" in text  # the certified margin, every digit of it
    verdict = certify(hp.load("x4-flyer"))
    assert verdict.certificate.statement.split(":")[0] in Page(text).texts["p"]


def test_the_certificate_inside_is_accepted_by_the_checker(written):
    page = Page(text_of(written["proved"]))
    name, link = next(iter(page.downloads.items()))
    assert name == "x4-flyer.cert.json"
    encoded = link.removeprefix("data:application/json;base64,")
    Path(name).write_bytes(base64.b64decode(encoded))
    assert "positive definite" in checker.check_file(name)


def test_a_refuted_mission_has_its_exact_counterexample_inside(written):
    text = text_of(written["refuted"])
    page = Page(text)
    assert "counterexample" in page.ids
    assert "Refuted" in text
    link = page.downloads["x4-flyer.refutation.json"]
    content = json.loads(base64.b64decode(link.partition("base64,")[2]))
    assert checker.check(content).startswith("It is not true")
    for value in set(content["counterexample"]["X"]) - {"0", "1", "-1"}:
        above, _, below = value.removeprefix("-").partition("/")
        assert f"<mn>{above}</mn></mrow><mrow><mn>{below}</mn>" in text
    assert "no firmware is made" in text


def test_what_is_left_out_is_said_to_be(written):
    assert set(written["proved"].missing) == {"atlas", "region", "attraction"}
    assert text_of(written["proved"]).count("left out on request") == 3
    assert set(written["refuted"].missing) == {"atlas", "region", "attraction", "firmware"}


@pytest.mark.slow
def test_a_part_that_fails_is_told_in_words_and_the_report_is_written(monkeypatch):
    def broken(*_):
        raise RuntimeError("the solver found nothing < & >")

    monkeypatch.setattr(parts, "start_or_ball", broken)
    off_axis = hp.load("x4-flyer", {"goal": {"centroid": [0.1, -0.2, 3.5]}})
    report = document.report(off_axis, "r.html", without=("atlas", "firmware", "ledger"))
    assert report.missing["attraction"] == "The solver found nothing < & >."
    assert "The solver found nothing &lt; &amp; &gt;." in text_of(report)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("preset", "changes", "said"),
    [
        ("x4-flyer", {}, "The start of the mission is among them."),
        ("x4-flyer-tuned", {}, "The start of the mission: undecided."),
        pytest.param(
            "x4-flyer",
            {"start.position": [0, 0, -0.5], "start.velocity": [0, 0, 3]},
            "The start of the mission: refuted.",
            marks=pytest.mark.whole,
        ),
    ],
)
def test_a_region_is_shown_whatever_becomes_of_the_start(preset, changes, said):
    without = [part for part in parts.PARTS if part != "attraction"]
    report = document.report(hp.load(preset, changes), "r.html", without=without)
    assert said in text_of(report)
    files = list(Page(text_of(report)).downloads)
    assert f"{preset}.attraction.cert.json" in files
    assert (f"{preset}.attraction.refutation.json" in files) == ("refuted" in said)


def test_a_goal_for_which_no_region_can_be_asked_says_so():
    off_axis = hp.load("x4-flyer", {"goal": {"centroid": [0.1, -0.2, 3.5]}})
    held = parts.attempt(lambda: hp.attraction(off_axis))
    assert isinstance(held, parts.Missing)
    assert "is not straight below" in held.reason


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"sensors": {"width": 640, "height": 480, "focal_length": 300}}, "left the field of view"),
        ({"start.position": [0, 0, -3]}, "0 m from the goal"),
    ],
)
def test_a_flight_that_ends_at_once_or_does_not_move_is_reported(changes, said):
    without = ("atlas", "region", "attraction", "firmware", "ledger")
    report = document.report(hp.load("x4-flyer", changes), "r.html", without=without)
    text = text_of(report)
    assert "flight" not in report.missing
    assert said in text.replace("\N{NO-BREAK SPACE}", " ")
    Page(text)


def test_a_loop_that_is_not_stable_has_no_flight_and_the_page_says_why(monkeypatch):
    monkeypatch.setattr(parts, "slowest_rate", lambda mission: -1.0)
    without = ("atlas", "region", "attraction", "firmware", "ledger")
    report = document.report(hp.load("x4-flyer"), "r.html", without=without)
    assert report.missing["flight"].startswith("The loop is not stable near its goal")
    assert report.missing["flight"] in text_of(report)


@pytest.mark.slow
@pytest.mark.parametrize("above", [None, Fraction(1, 10**9)])
def test_an_undecided_mission_has_a_report_that_claims_nothing(capsys, monkeypatch, above):
    def undecided(mission):
        reason = "the worst eigenvalue of Σ is too near zero"
        problem = gain_problem(mission)
        return UndecidedGains(mission=mission, reason=reason, problem=problem, margin_above=above)

    monkeypatch.setattr(parts, "certify", undecided)
    options = [word for part in SLOW_PARTS[:3] for word in ("--without", part)]
    status, out, _ = run(capsys, "report", "x4-flyer", "-o", "r.html", *options)
    assert status == 3
    assert "undecided" in out
    text = Path("r.html").read_text(encoding="utf-8")
    assert "The worst eigenvalue of Σ is too near zero." in text
    assert "nothing is claimed" in text
    assert "Proved" not in re.sub(r'(?s)<section id="region".*?</section>', "", text)
    assert "The gains are undecided, so no firmware" in text
    assert "x4-flyer.cert.json" not in text
    Page(text)


def test_a_mistake_of_the_program_is_not_taken_for_a_missing_part():
    with pytest.raises(KeyError):
        parts.attempt(lambda: {}["x"])


def test_the_command_says_what_it_wrote_and_has_the_status_of_the_verdict(capsys):
    options = [word for part in parts.PARTS for word in ("--without", part)]
    status, out, err = run(capsys, "report", "x4-flyer", "--json", *options)
    answer = json.loads(out)
    assert status == 0
    assert "verdict ..." in err
    assert answer["verdict"] == "proved"
    assert answer["out"] == "x4-flyer.report.html"
    assert answer["bytes"] == Path(answer["out"]).stat().st_size
    assert set(answer["missing"]) == set(parts.PARTS)
    page = Path(answer["out"]).read_text(encoding="utf-8")
    assert "hoverproof report x4-flyer --without atlas" in page
    settings = ("--set", "gains.k4=0.1", "-o", "r.html")
    status, out, _ = run(capsys, "report", "x4-flyer", *settings, *options)
    assert status == 1
    assert "refuted" in out
    assert "--set gains.k4=0.1" in Path("r.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nothing"], "no such mission file or preset"),
        (["x4-flyer", "-o", "no/such/folder/r.html"], "cannot be written"),
        (["x4-flyer", "-o", "."], "is a directory"),
        (["x4-flyer", "--without", "figures"], "figures"),
        (["x4-flyer", "--runs", "0"], "Must be >= 1"),
        (["x4-flyer", "--set", "bounds.thrust=[0.1, 100]"], "singular"),
    ],
)
def test_bad_input_is_one_line_and_status_2(capsys, arguments, said):
    status, out, err = run(capsys, "report", *arguments)
    assert (status, out) == (2, "")
    assert said in err.splitlines()[-1]
    assert not list(Path.cwd().glob("*.html"))


def test_a_folder_that_cannot_be_written_to_is_found_before_anything_is_computed():
    begun = []
    with pytest.raises(InputError, match="cannot be written"):
        document.report(hp.load("x4-flyer"), "no/folder/r.html", show=begun.append)
    assert begun == []


def test_an_interrupted_report_leaves_the_old_file_whole(monkeypatch):
    Path("r.html").write_text("old")

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(document, "render", interrupted)
    with pytest.raises(KeyboardInterrupt):
        document.report(hp.load("x4-flyer"), "r.html", without=parts.PARTS)
    assert Path("r.html").read_text() == "old"
    assert [p.name for p in Path.cwd().iterdir()] == ["r.html"]


@pytest.mark.slow
def test_the_same_mission_makes_the_same_bytes_and_a_date_only_if_it_is_given(written, monkeypatch):
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    again = document.report(hp.load("x4-flyer"), "again.html", without=SLOW_PARTS[:3])
    assert again.sha256 == written["proved"].sha256
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    dated = document.report(hp.load("x4-flyer"), "dated.html", without=parts.PARTS)
    assert "2001-09-09" in text_of(dated)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "soon")
    with pytest.raises(InputError, match="SOURCE_DATE_EPOCH"):
        document.report(hp.load("x4-flyer"), "bad.html", without=parts.PARTS)


@pytest.mark.slow
def test_every_formula_of_the_ledger_becomes_mathml_without_a_rest_of_latex():
    for judgement in derive():
        for shown in (judgement.printed, judgement.derived):
            made = mathematics.mathml(shown.latex(), block=True)
            page = Page(made)
            assert page.tags[0][0] == "math"
            assert "\\" not in made, judgement.id


@pytest.mark.parametrize("mission", PAPERS.values(), ids=PAPERS)
def test_the_formulas_of_a_theorem_hold_no_more_than_is_proved(mission):
    """Read the numbers back out of the formulas, and compare with what was proved."""
    verdict = certify(hp.load(mission))
    problem = verdict.problem
    lines = mathematics.claim(
        problem.eigenvalues, problem.thrust, verdict.margin, verdict.decay_rate
    )
    plain = [line.replace("^{-1}", "") for line in lines]
    numbers = [[Fraction(n) for n in re.findall(r"(?<![\w.])\d[\d.]*", x)] for x in plain]
    (low, high), (least, most), _, (margin,), _, (*_, rate) = numbers
    assert problem.eigenvalues[0] <= low < high <= problem.eigenvalues[1]
    assert problem.thrust[0] <= least < most <= problem.thrust[1]
    assert margin == verdict.margin
    assert Fraction(999, 1000) * verdict.decay_rate <= rate <= verdict.decay_rate


def test_proved_bounds_are_rounded_to_the_safe_side():
    assert at_least(Fraction(19999, 10000)) == "1.999"
    assert at_most(Fraction(20001, 10000)) == "2.001"
    assert at_most(Fraction(-20009, 10000)) == "−2"
    assert short(3.4884e-4) == "0.0003488"
    assert short(3.4884e-5) == "3.488×10⁻⁵"


def test_the_rounding_of_float32_is_measured_against_float64():
    mission = hp.load("crazyflie-2.1")
    found = {r.output: r for r in cost.rounding(mission, certify(mission).problem.thrust)}
    assert set(found) == {"thrust_rate", "torque", "rotor"}
    for r in found.values():
        assert 2**-30 < r.error / r.largest < 2**-16


def test_without_a_compiler_for_the_target_nothing_is_measured_and_that_is_said(monkeypatch):
    monkeypatch.setattr(cost.shutil, "which", lambda name: None)
    held = parts.attempt(lambda: cost.footprint(".", {"name": "x"}))
    assert "not installed here" in held.reason


# --- in a browser -------------------------------------------------------------------------------

VIEWS = ((1280, "light"), (390, "light"), (390, "dark"))
"""Widths in pixels and colour schemes: a desk, a phone, a phone at night."""


def opened(browser, path, width, scheme="light"):
    """Open a file without a network; return the page and all that it asked for or complained of."""
    context = browser.new_context(
        viewport={"width": width, "height": 844}, color_scheme=scheme, offline=True
    )
    page, trouble, requests = context.new_page(), [], []
    page.on("console", lambda message: trouble.append(message.text))
    page.on("pageerror", lambda error: trouble.append(str(error)))
    page.on("requestfailed", lambda request: trouble.append(request.url))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(Path(path).resolve().as_uri())
    until(page, lambda: page.locator("[data-part=clock]").inner_text())
    return page, trouble, requests


def until(page, holds):
    """Wait for something; the page's own policy forbids scripts from a string, and so waits."""
    for _ in range(200):
        if holds():
            return
        page.wait_for_timeout(25)
    pytest.fail("did not happen within 5 s")


def pixels(page, part):
    shot = page.locator(f"canvas[data-part={part}]").screenshot()
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), int)


def check_in_browser(browser, path, views=VIEWS):
    """Hold a report to all that is asked of it in a browser; in one view, to what fits there."""
    backgrounds, every = {}, views == VIEWS
    for width, scheme in views:
        page, trouble, requests = opened(browser, path, width, scheme)
        wide = page.evaluate("[document.scrollingElement.scrollWidth, innerWidth]")
        assert wide[0] <= wide[1], (width, wide)
        for state in ("true", "false"):  # folded or not
            page.evaluate(f"document.querySelectorAll('details').forEach(d => d.open = {state})")
            assert page.evaluate("document.scrollingElement.scrollWidth") <= width
        broken = page.evaluate(
            "[...document.querySelectorAll('a[href^=\"#\"]')]"
            ".map(a => a.getAttribute('href').slice(1)).filter(id => !document.getElementById(id))"
        )
        assert broken == []
        backgrounds[scheme] = page.evaluate("getComputedStyle(document.body).backgroundColor")
        if every and scheme == "light":
            check_player(page)
        assert trouble == []
        assert [r for r in requests if not r.startswith("data:")] == [Path(path).resolve().as_uri()]
        page.context.close()
    assert not every or backgrounds["light"] != backgrounds["dark"]


def check_player(page):
    """Move through the flight with slider, keys, mouse and button."""
    slider, clock = page.locator("[data-part=time]"), page.locator("[data-part=clock]")
    before = {part: pixels(page, part) for part in ("space", "image")}
    assert all(len(np.unique(p.reshape(-1, 3), axis=0)) > 5 for p in before.values())
    slider.evaluate("s => { s.value = s.max / 3; s.dispatchEvent(new Event('input')); }")
    assert clock.inner_text() != "0.0 s"
    for part, image in before.items():
        assert (pixels(page, part) != image).any(), part
    at, told = pixels(page, "space"), clock.inner_text()
    slider.press("ArrowRight")
    assert clock.inner_text() != told
    page.locator("canvas[data-part=space]").press("ArrowLeft")
    turned = pixels(page, "space")
    assert (turned != at).any()
    box = page.locator("canvas[data-part=space]").bounding_box()
    page.mouse.move(box["x"] + 60, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 160, box["y"] + 80)
    page.mouse.up()
    assert (pixels(page, "space") != turned).any()
    told = clock.inner_text()
    button = page.locator("[data-part=play]")
    button.click()
    assert button.inner_text() == "Pause"
    until(page, lambda: clock.inner_text() != told)
    button.click()
    assert button.inner_text() == "Play"


@pytest.mark.slow
@pytest.mark.parametrize("preset", mostly_whole(sorted(presets(), reverse=True), every=2, first=1))
def test_the_report_of_a_preset_opens_offline_and_reads_on_desk_and_phone(browser, preset):
    """Style and script are the same on every page: what differs is tried where it is narrowest."""
    report = document.report(hp.load(preset), "report.html")
    assert report.size < 6 * MEGABYTE
    assert report.missing == {}
    Page(text_of(report))
    check_in_browser(browser, "report.html", VIEWS if preset == "x4-flyer" else VIEWS[1:2])


@pytest.mark.slow
def test_the_report_of_a_refuted_mission_opens_as_well(browser, written):
    check_in_browser(browser, written["refuted"].path)


@pytest.mark.slow
def test_many_flights_join_the_report_and_scroll_in_their_own_box(browser):
    mission = hp.load("x4-flyer", {"scatter.position": [1, 1, 1]})
    without = ("atlas", "region", "attraction", "firmware", "ledger")
    document.report(mission, "report.html", runs=8, without=without)
    check_in_browser(browser, "report.html", VIEWS[1:2])
    assert "8 flights drawn from the scatter" in Path("report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("preset", ["x4-flyer", "crazyflie-2.1"])
def test_the_map_goes_as_far_as_it_takes_to_see_an_edge(preset, monkeypatch):
    monkeypatch.setattr(parts, "MAP_CELLS", 20)
    found = parts._map(hp.load(preset))
    assert found.reach == {"x4-flyer": 10, "crazyflie-2.1": 100}[preset]
    assert 0.1 < (found.data["margin"].values > 0).mean() < 0.9
    assert f"from 1/{found.reach} to {found.reach} times" in wording.atlas(found)


def test_a_player_has_the_lens_and_no_image_of_what_is_not_seen():
    change = {"model_error.mass": "0.005", "camera.half_angle": "1.2"}
    crash = flown(hp.load("x4-flyer", change), Timing())
    told = player_data(parts.Flown(crash, None, {}, None, None, None, None))
    assert told["lens"] == pytest.approx(np.tan(1.2))
    image = told["spans"][0]["image"]
    assert image[-1] == [None] * 8
    assert np.allclose(image[0], crash["image"].values[0].ravel(), atol=1e-3)
    json.dumps(told, allow_nan=False)


def test_the_attitudes_of_a_player_are_those_of_scipy():
    half = Rotation.from_euler("z", [[180]], degrees=True)
    turns = Rotation.concatenate([Rotation.random(200, random_state=0), half])
    own, other = _quaternions(turns.as_matrix()), turns.as_quat(scalar_first=True)
    nearer = np.where((own * other).sum(axis=1, keepdims=True) < 0, -own, own)
    assert np.abs(nearer - other).max() < 1e-14
