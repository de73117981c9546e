"""Make the picture of the front page: a mission, what is proved of it, its flight and its C code.

    python docs/front_page.py [FILE]

Everything in it is computed here: the map of gains, the region, the flight, the rate and the code.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import hoverproof as hp
from hoverproof.algebra.decimals import decimal_below
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.design.atlas import axis
from hoverproof.mission.presets import preset_text
from hoverproof.mission.sections import Mission
from hoverproof.show import panels
from hoverproof.show.atlas import draw_atlas
from hoverproof.show.attraction import View, hovers_inside
from hoverproof.show.style import COLOURS

PRESET = "x4-flyer"
DURATION = 1500.0  # s
FILE = Path(__file__).with_name("front-page.png")
SHIPPED = Path(__file__).parents[1] / "proofs" / f"{PRESET}.attraction.cert.json"
WIDTH, HEIGHT, DPI = 12.4, 8.2, 150  # inches, and pixels per inch
ROWS, HIGH = (0.57, 0.065), 0.345  # lower edges and height of the panels, in parts of the figure
CODE = {"family": "monospace", "fontsize": 8.5, "va": "top", "linespacing": 1.13}
OPENING, CLOSING = 10, 13  # lines of the control law that are shown
CELLS = 120
Box = tuple[float, float, float, float]


def front_page() -> Figure:
    """Draw the six panels, in the order of reading."""
    mission = hp.load(PRESET)
    verdict, region = hp.certify(mission).proved, hp.attraction(mission).proved
    assert verdict and region
    same_as_shipped(region)
    flight = hp.simulate(mission, duration=DURATION)
    rate = float(decimal_below(verdict.decay_rate, 3))
    figure = Figure(figsize=(WIDTH, HEIGHT), dpi=DPI)

    def panel(row: int, left: float, right: float, title: str, below: str) -> Box:
        """Write a title and a line below it; return the place under them."""
        top = ROWS[row] + HIGH
        figure.text(left, top + 0.052, title, fontsize=13, fontweight="bold", va="center")
        figure.text(left, top + 0.024, below, fontsize=10, va="center", color="#444444")
        return left, ROWS[row], right - left, HIGH

    below = "a TOML file of exact decimals"
    box = panel(0, 0.012, 0.295, "1  You describe the mission", below)
    draw_text(figure.add_axes(lower(box)), mission_lines(), longest=42)
    below = f"dL/dt ≤ -({rate:g}/s) L for all Q, T in bounds, Ω3 = 0"
    box = panel(0, 0.335, 0.628, "2  Its gains are proved", below)
    draw_gains(figure.add_axes(indented(box)), mission)
    below = "proved in exact arithmetic; the flight simulated"
    box = panel(0, 0.695, 0.988, "3  From here it converges", below)
    draw_region(figure.add_axes(indented(box)), region, flight)
    below = "● start   ★ goal   ■ target points"
    box = panel(1, 0.012, 0.235, "4  It flies", below)
    draw_path(figure.add_axes(box, projection="3d"), flight)
    below = "directions alone; no distance is ever known"
    box = panel(1, 0.318, 0.585, "5  What its camera sees", below)
    draw_tracks(figure.add_axes(indented(box)), flight)
    below = "the same law in float32, with the hash of its certificate"
    box = panel(1, 0.618, 0.988, "6  It is C that you can fly", below)
    draw_text(figure.add_axes(lower(box)), code(mission), longest=56)
    return figure


def same_as_shipped(region: Attraction) -> None:
    """Stop if the picture would tell another region than the certificate in proofs/."""
    claim = json.loads(SHIPPED.read_text(encoding="utf-8"))["claim"]
    if far(region.reach.sideways) != far(claim["reach"]["sideways"]):
        raise SystemExit(f"{SHIPPED.name} is about another region; first run: make proofs")


def far(sideways: str | Fraction) -> str:
    """Return how far hovers are certified sideways, as the picture and its metadata say it."""
    return f"{int(Fraction(sideways))} m"


def indented(box: Box) -> Box:
    """Make room for labels on the left."""
    left, bottom, width, height = box
    return left + 0.042, bottom, width - 0.042, height


def lower(box: Box) -> Box:
    """Use the room that labels would take below."""
    left, bottom, width, height = box
    return left, bottom - 0.053, width, height + 0.053


def mission_lines() -> list[str]:
    """Return the preset, without the lines that only comment; of comments, the units."""
    lines = [line for line in preset_text(PRESET).splitlines() if line and line[0] != "#"]
    return [re.sub(r"  +#([^,;]*)[,;]?.*", r"  #\1", line) for line in lines]


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
    across, along = (axis(mission, name, cells=CELLS) for name in ("k1", "k2"))
    atlas = hp.atlas(mission, across, along, exact=True)
    draw_atlas(axes, mission, atlas, "decay_rate", np.zeros(atlas["margin"].shape, bool))


def draw_region(axes: Axes, region: Attraction, flight: xr.Dataset) -> None:
    """Draw from which hovers convergence is proved, in a plane through start and goal."""
    view = View.of(region)
    across, height, places = view.grid()
    inside = hovers_inside(region, places).reshape(len(height), len(across))
    axes.contourf(across, height, inside, levels=[0.5, 1.5], colors=[COLOURS[5]], alpha=0.45)
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
    axes.set_zlabel("z (m), down", labelpad=1)


def draw_tracks(axes: Axes, flight: xr.Dataset) -> None:
    """Draw the tracks of the points in the image."""
    panels.image_tracks(axes, flight)
    axes.get_legend().remove()


if __name__ == "__main__":
    claim = json.loads(SHIPPED.read_text(encoding="utf-8"))["claim"]
    told = {"Proved sideways": far(claim["reach"]["sideways"])}
    front_page().savefig(sys.argv[1] if len(sys.argv) > 1 else FILE, metadata=told)
