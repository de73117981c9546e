"""The built documentation: every link inside it leads somewhere, and nothing is fetched."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from fractions import Fraction
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from PIL import Image, ImageChops, ImageStat

from hoverproof.algebra.decimals import at_most

ROOT = Path(__file__).parents[1]
SITE = ROOT / "docs" / "_build" / "html"


class Page(HTMLParser):
    """The links, the anchors and the resources of a page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.anchors, self.resources = [], set(), []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[key] for key in ("id", "name") if values.get(key)}
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        elif values.get("src"):
            self.resources.append(values["src"])
        elif tag == "link" and values.get("rel") in ("stylesheet", "icon", "preload"):
            self.resources.append(values["href"])


page = cache(Page)


@pytest.fixture(scope="module")
def pages():
    found = sorted(SITE.rglob("*.html"))
    assert len(found) > 30, "run `make docs`"
    return found


def broken(path, link):
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return False
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if not target.exists():
        return True
    wants_anchor = parts.fragment and target.suffix == ".html"
    return bool(wants_anchor and unquote(parts.fragment) not in page(target).anchors)


@pytest.mark.slow
def test_every_link_inside_leads_somewhere(pages):
    links = [(p, link) for p in pages for link in page(p).links]
    assert len(links) > 1000
    assert not [(p.name, link) for p, link in links if broken(p, link)]


@pytest.mark.slow
def test_no_page_needs_the_network(pages):
    resources = [(p, link) for p in pages for link in page(p).resources]
    assert len(resources) > 100
    assert not [(p.name, r) for p, r in resources if urlsplit(r).netloc or broken(p, r)]


@pytest.mark.slow
def test_every_page_is_in_the_table_of_contents_and_every_notebook_is_there(pages):
    contents = page(SITE / "index.html").links
    reachable = {(SITE / link.split("#")[0]).resolve() for link in contents if ":" not in link}
    written = [p.relative_to(ROOT / "docs").with_suffix("") for p in (ROOT / "docs").rglob("*.md")]
    notebooks = [Path("generated", p.stem) for p in (ROOT / "notebooks").rglob("*.ipynb")]
    for name in {*written, *notebooks} - {Path("index")}:
        assert SITE / f"{name}.html" in reachable, name


@pytest.mark.slow
def test_each_command_and_each_public_name_has_its_place():
    from hoverproof.cli.console import app

    commands = page(SITE / "generated" / "commands.html")
    assert {f"command-{name}" for name in app if not name.startswith("-")} <= commands.anchors
    everything = set().union(*(page(p).anchors for p in SITE.rglob("*.html")))
    import hoverproof

    assert "hoverproof.servo.laws.hamel_mahony.LAWS" in everything  # a dict does not know its place
    for name in set(hoverproof.__all__) - {"__version__", "LAWS"}:
        thing = getattr(hoverproof, name)
        assert f"{thing.__module__}.{thing.__qualname__}" in everything


def test_each_public_name_is_in_the_table_of_the_interface():
    import hoverproof

    page_ = (ROOT / "docs" / "reference" / "api.md").read_text(encoding="utf-8")
    rows = set(re.findall(r"^\| \{\w+\}`hp\.(\w+) <", page_, flags=re.M))
    assert rows == set(hoverproof.__all__) - {"__version__"}


@pytest.mark.slow
def test_each_condition_of_a_flight_says_what_it_means():
    text = (SITE / "generated" / "mission-file.html").read_text(encoding="utf-8")
    assert "-----" not in text
    assert "From the frame to its arrival at the controller" in text


WIDE = ["tutorial", "how-to/fly-less-than-ideal", "explanation/theorems", "generated/05_controller"]
"""Pages with long lines of code and output, wide tables, formulas and notebooks."""


@pytest.mark.slow
@pytest.mark.parametrize("name", WIDE)
def test_a_phone_shows_a_page_and_each_line_of_code_whole(name, browser):
    page_ = browser.new_page(viewport={"width": 390, "height": 844})
    page_.goto((SITE / f"{name}.html").as_uri())
    too_wide = page_.evaluate(
        "[document.documentElement, ...document.querySelectorAll('pre')]"
        ".filter(e => e.scrollWidth > e.clientWidth && e.clientWidth).length"
    )
    page_.close()
    assert too_wide == 0


@pytest.mark.slow
def test_each_picture_of_a_page_opens_by_itself():
    text = (SITE / "tutorial.html").read_text(encoding="utf-8")
    pictures = re.findall(r'<img [^>]*src="(_images/[^"]*)"', text)
    assert len(pictures) >= 2
    assert [p for p in pictures if f'href="{p}"' not in text] == []


def shipped_claim(preset):
    path = ROOT / "proofs" / f"{preset}.attraction.cert.json"
    return json.loads(path.read_text(encoding="utf-8"))["claim"]


def test_the_front_page_tells_the_time_and_the_region_of_the_shipped_certificates():
    with Image.open(ROOT / "docs" / "front-page.png") as picture:
        told = picture.text["Settled"]
    time = Fraction(shipped_claim("crazyflie-2.1")["settling"]["time"])
    assert told == f"{at_most(time)} s"
    with Image.open(ROOT / "docs" / "paper-vehicle.png") as picture:
        told = picture.text["Proved sideways"]
    assert told == f"{int(Fraction(shipped_claim('x4-flyer')['reach']['sideways']))} m"


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param("front-page.png", marks=pytest.mark.whole), "paper-vehicle.png"]
)
def test_the_pictures_of_the_front_page_can_be_drawn_anew(name, tmp_path):
    subprocess.run([sys.executable, ROOT / "docs" / "front_page.py", tmp_path, name], check=True)
    with Image.open(tmp_path / name) as new, Image.open(ROOT / "docs" / name) as kept:
        assert new.size == kept.size
        apart = ImageChops.difference(new.convert("L"), kept.convert("L"))
        assert ImageStat.Stat(apart).mean[0] < 10  # of 255: fonts may differ, what is drawn may not


def test_no_page_tells_a_number_that_a_command_did_not_print():
    """In running text figures with three digits or more after the point must be computed."""
    for path in [*(ROOT / "docs").glob("[!_g]*/*.md"), *(ROOT / "docs").glob("*.md")]:
        text = re.sub(r"(?ms)^```.*?^```", "", path.read_text(encoding="utf-8"))
        assert not re.findall(r"\d\.\d{3,}", text), path.name
