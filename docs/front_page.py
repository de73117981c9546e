"""Make the pictures of the front page: a vehicle, what is proved of it, its flight and its C code.

    python docs/front_page.py [FOLDER [NAME.png]]

Everything in them is computed here: the maps of gains, what is proved, the flights and the code.
The second is of the paper's vehicle and law.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
import textwrap
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

import hoverproof as hp
from hoverproof.algebra.decimals import at_most, decimal_below
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.design.atlas import axis
from hoverproof.design.start_atlas import start_chart
from hoverproof.mission.presets import preset_text
from hoverproof.mission.sections import Mission
from hoverproof.reporting import glance
from hoverproof.reporting.parts import gather
from hoverproof.show import exponential, panels
from hoverproof.show.atlas import draw_atlas
from hoverproof.show.attraction import View, outside_by
from hoverproof.show.image_plane import draw_image
from hoverproof.show.start_atlas import draw_start_atlas
from hoverproof.show.style import COLOURS

VEHICLE, PAPERS = "crazyflie-2.1", "x4-flyer"
FRONT, SECOND = "front-page.png", "paper-vehicle.png"
DURATION = 1500.0  # s, of the paper's flight
HERE = Path(__file__).parent
WIDTH, HEIGHT, DPI = 12.4, 10.6, 150  # inches, and pixels per inch
LOW = 4.7  # inches, of the second picture
ROWS, HIGH = (0.452, 0.05), 0.28  # lower edges and height of the panels, in parts of the figure
CODE = {"family": "monospace", "fontsize": 8.5, "va": "top", "linespacing": 1.09}
OPENING, CLOSING = 10, 13  # lines of the control law that are shown
CELLS, START_CELLS = 120, 10
AROUND = 5  # times as small and as large as those of the mission are the gains of the map
PLAIN = {"facecolor": "#D0D0D0", "edgecolor": "none", "pad": 2}
INSIDE = {"ha": "right", "va": "top", "fontsize": 9, "bbox": PLAIN}
LEFT_OUT = ("vehicle", "sensors", "rotors", "bounds")
"""Sections of the mission that the picture has no room for."""
Box = tuple[float, float, float, float]


class Page:
    """A figure of panels, and how its parts are laid out."""

    def __init__(self, height: float, rows: Sequence[float], high: float):
        self.figure = Figure(figsize=(WIDTH, height), dpi=DPI)
        self.rows, self.high, self.step = rows, high, HEIGHT / height

    def panel(self, row: int, left: float, right: float, title: str, below: str) -> Box:
        """Write a title and a line below it; return the place under them."""
        top = self.rows[row] + self.high
        self.figure.text(
            left, top + 0.039 * self.step, title, fontsize=13, fontweight="bold", va="center"
        )
        self.figure.text(
            left, top + 0.018 * self.step, below, fontsize=10, va="center", color="#444444"
        )
        return left, self.rows[row], right - left, self.high


def front_page() -> Figure:
    """Draw what is proved of a vehicle that exists, and six panels, in the order of reading."""
    mission = hp.load(VEHICLE)
    parts = gather(mission, without=("atlas", "region", "firmware", "ledger"), show=print)
    proved = parts.attraction.region
    assert isinstance(proved, Exponential)
    same_as_shipped(settled(proved.settling.time), settled(claim(VEHICLE)["settling"]["time"]))
    flight = parts.flight.whole
    page = Page(HEIGHT, ROWS, HIGH)
    draw_glance(page.figure, f"{VEHICLE}, at one glance", glance.rows(parts), 0.978, 150)
    below = "a TOML file of exact decimals"
    box = page.panel(0, 0.012, 0.295, "1  You describe the mission", below)
    draw_text(page.figure.add_axes(lower(box)), mission_lines(VEHICLE), longest=42)
    below = "★ proved; colours: found by search; grey: none"
    box = page.panel(0, 0.335, 0.628, "2  Gains that hold its start", below)
    axes = page.figure.add_axes(indented(box))
    draw_start_atlas(axes, mission, start_map(mission))
    below = "for every vehicle within tolerance"
    box = page.panel(0, 0.695, 0.988, "3  In how many seconds, proved", below)
    axes = page.figure.add_axes(indented(box))
    exponential.draw_distance(axes, exponential.View(proved), parts.flight.whole)
    axes.legend(loc="lower left", fontsize=7.5)
    box = page.panel(1, 0.012, 0.235, "4  It flies", "● start   ★ goal   ■ target points")
    draw_path(page.figure.add_axes(box, projection="3d"), flight)
    below = "directions alone, no distance; orange: its lens"
    box = page.panel(1, 0.318, 0.585, "5  What its camera sees", below)
    draw_tracks(page.figure.add_axes(indented(box)), flight)
    below = "the same law in float32, with the hash of its certificate"
    box = page.panel(1, 0.618, 0.988, "6  It is C that you can fly", below)
    draw_text(page.figure.add_axes(lower(box)), code(mission), longest=56)
    return page.figure


def paper_vehicle() -> Figure:
    """Draw which gains of the paper's vehicle are certified, and from where it converges."""
    mission = hp.load(PAPERS)
    parts = gather(mission, without=("atlas", "region", "flight", "firmware", "ledger"), show=print)
    verdict, region = parts.verdict.proved, parts.attraction.region
    assert verdict
    assert isinstance(region, Attraction)
    same_as_shipped(far(region.reach.sideways), far(claim(PAPERS)["reach"]["sideways"]))
    flight = hp.simulate(mission, duration=DURATION)
    rate = float(decimal_below(verdict.decay_rate, 3))
    page = Page(LOW, (0.14,), 0.66)
    draw_glance(page.figure, f"{PAPERS}, the paper's vehicle", glance.rows(parts), 0.95, 48)
    below = f"dL/dt ≤ -({rate:g}/s) L for all Q, T in bounds, Ω3 = 0"
    box = page.panel(0, 0.345, 0.638, "Its gains are proved", below)
    draw_gains(page.figure.add_axes(indented(box)), mission)
    below = "● start   ★ goal   ■ target points   ― simulated"
    box = page.panel(0, 0.705, 0.988, "From here it converges", below)
    draw_region(page.figure.add_axes(indented(box)), region, flight)
    return page.figure


def claim(preset: str) -> dict[str, dict[str, str]]:
    """Return what the shipped certificate of a preset claims."""
    path = HERE.parent / "proofs" / f"{preset}.attraction.cert.json"
    return json.loads(path.read_text(encoding="utf-8"))["claim"]


def same_as_shipped(found: str, shipped: str) -> None:
    """Stop if a picture would tell something else than the certificate in proofs/."""
    if found != shipped:
        raise SystemExit(
            f"certificates in proofs/ say {shipped}, not {found}: first run make proofs"
        )


def far(sideways: str | Fraction) -> str:
    """Return how far hovers are certified sideways, as the picture and its metadata say it."""
    return f"{int(Fraction(sideways))} m"


def settled(time: str | Fraction) -> str:
    """Return when every vehicle has settled, as the metadata of the picture say it."""
    return f"{at_most(Fraction(time))} s"


def start_map(mission: Mission) -> xr.Dataset:
    """Return a map of the gains with which the start is held, about those of the mission."""
    gains = mission.gains
    ends = {
        name: (float(getattr(gains, name)) / low, float(getattr(gains, name)) * high)
        for name, low, high in (("k1", 3, 1.6), ("k2", 2.2, 3))
    }
    across, along = (
        axis(mission, name, ends=ends[name], cells=START_CELLS, of_start=True) for name in ends
    )
    return start_chart(mission, across, along)


def draw_glance(
    figure: Figure, title: str, rows: Sequence[glance.Line], top: float, wide: int
) -> None:
    """Write what is proved, for whom, from where and how soon, and what is not, but of gains."""
    inch = 1 / figure.get_figheight()
    figure.text(0.012, top, title, fontsize=15, fontweight="bold", va="center")
    at = top - 0.24 * inch
    for question, words in rows:
        if question == "Gains":  # a panel is about that
            continue
        lines = textwrap.wrap(words, wide)
        tone = "#777777" if question in glance.NOT_PROVED else COLOURS[2]
        aside = wide > 80
        figure.text(0.012, at, question, fontsize=9.5, fontweight="bold", va="top", color=tone)
        place, at = (0.14, at) if aside else (0.012, at - 0.155 * inch)
        figure.text(place, at, "\n".join(lines), fontsize=9.5, va="top", linespacing=1.2)
        at -= (0.165 * len(lines) + (0.03 if aside else 0.07)) * inch


def indented(box: Box) -> Box:
    """Make room for labels on the left."""
    left, bottom, width, height = box
    return left + 0.042, bottom, width - 0.042, height


def lower(box: Box) -> Box:
    """Use the room that labels would take below."""
    left, bottom, width, height = box
    return left, bottom - 0.045, width, height + 0.045


def mission_lines(preset: str) -> list[str]:
    """Return most of a preset, without the lines that only comment; of comments, the units."""
    sections = re.split(r"(?m)^(?=\[)", preset_text(preset))
    kept = [
        part for part in sections if not part.startswith(tuple(f"[{name}]" for name in LEFT_OUT))
    ]
    lines = [line for line in "".join(kept).splitlines() if line and line[0] != "#"]
    return [re.sub(r"  +#([^,;:]*)[,;:]?.*", r"  #\1", line) for line in lines]


def code(mission: Mission) -> list[str]:
    """Return the beginning and the end of the control law that `export` writes."""
    with tempfile.TemporaryDirectory() as folder:
        hp.export_c(mission, folder, name="flyer")
        text = (Path(folder) / "flyer.c").read_text(encoding="utf-8")
    law = text[text.index("static void control_law(") :]
    lines = [re.sub(r" */\*.*?\*/", "", line) for line in law[: law.index("\n}") + 2].splitlines()]
    return [*lines[:OPENING], "  ...", *lines[-CLOSING:]]


def draw_text(axes: Axes, lines: list[str], longest: int) -> None:
    """Show lines of code, cut where they are too long."""
    cut = [line if len(line) <= longest else line[: longest - 3] + "..." for line in lines]
    axes.set_facecolor("#F6F8FA")
    axes.set(xticks=[], yticks=[])
    for side in axes.spines.values():
        side.set_color("#D0D7DE")
    axes.text(0.02, 0.98, "\n".join(cut), transform=axes.transAxes, clip_on=True, **CODE)


def draw_gains(axes: Axes, mission: Mission) -> None:
    """Draw which gains are certified, the boundary decided exactly."""
    own = {name: float(getattr(mission.gains, name)) for name in ("k1", "k2")}
    across, along = (
        axis(mission, name, cells=CELLS, ends=(value / AROUND, value * AROUND))
        for name, value in own.items()
    )
    atlas = hp.atlas(mission, across, along, exact=True)
    draw_atlas(axes, mission, atlas, "decay_rate", np.zeros(atlas["margin"].shape, bool))
    axes.text(0.97, 0.96, "grey: refuted\n★: its gains", **INSIDE, transform=axes.transAxes)


def draw_region(axes: Axes, region: Attraction, flight: xr.Dataset) -> None:
    """Draw from which hovers convergence is proved, in a plane through start and goal."""
    view = View.of(region)
    across, height, places = view.grid()
    outside = outside_by(region, places, view.potential.hover_terms(places))
    outside = outside.reshape(len(height), len(across))
    inside = [outside.min(), 0]
    axes.contourf(across, height, outside, levels=inside, colors=[COLOURS[5]], alpha=0.45)
    p, position = view.potential, flight["position"].values
    axes.plot((position - p.goal) @ view.along, p.plane - position[:, 2], color=COLOURS[0])
    axes.plot((position[0] - p.goal) @ view.along, p.plane - position[0, 2], "o", color=COLOURS[3])
    axes.plot((p.points - p.goal) @ view.along, p.plane - p.points[:, 2], "s", color=COLOURS[1])
    axes.plot(0, p.height(float(p.goal[2])), "*", color=COLOURS[2], markersize=13)
    axes.set_xlim(-view.side, view.side)
    axes.set_ylim(view.bottom, view.top)
    words = f"proved, to {far(region.reach.sideways)} on all sides"
    axes.text(0, 0.9 * view.top, words, ha="center", va="top")
    axes.set_xlabel("horizontal distance from the goal (m)")
    axes.set_ylabel("height (m)")
    axes.grid(alpha=0.3)


def draw_path(axes: Axes, flight: xr.Dataset) -> None:
    """Draw the path in space."""
    panels.path(axes, flight)
    axes.get_legend().remove()
    axes.set_zlabel("z (m), down", labelpad=12)
    axes.xaxis.set_major_locator(MaxNLocator(2))


def draw_tracks(axes: Axes, flight: xr.Dataset) -> None:
    """Draw the tracks of the points in the image."""
    draw_image(axes, flight)
    axes.get_legend().remove()


def draw(name: str, folder: Path) -> None:
    """Draw one of the pictures, with what the certificates in proofs/ say in its metadata."""
    if name == FRONT:
        told = {"Settled": settled(claim(VEHICLE)["settling"]["time"])}
        front_page().savefig(folder / FRONT, metadata=told)
    else:
        told = {"Proved sideways": far(claim(PAPERS)["reach"]["sideways"])}
        paper_vehicle().savefig(folder / SECOND, metadata=told)


if __name__ == "__main__":
    for picture in sys.argv[2:] or (FRONT, SECOND):
        draw(picture, Path(sys.argv[1]) if len(sys.argv) > 1 else HERE)
