"""Figures in a page: small ones that stay legible on a phone, in the colours of the page."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import matplotlib as mpl
from matplotlib.figure import Figure

from hoverproof.certification.attraction.verdict import Proved
from hoverproof.certification.over_box import RegionVerdict
from hoverproof.mission import Mission
from hoverproof.reporting.parts import Flown, Map
from hoverproof.show import attraction, fans, panels
from hoverproof.show.atlas import atlas_figure
from hoverproof.show.region import region_figure

WIDTH = 4.6
FLIGHTS = 30
MOST_SVG = 400_000
LOOKS = {
    "font.size": 9,
    "axes.titlesize": 9,
    "legend.fontsize": 8,
    "svg.hashsalt": "hoverproof",
    "svg.fonttype": "path",
}


@dataclass(frozen=True)
class Picture:
    """A figure, ready to stand in a page.

    Attributes
    ----------
    name : str
        An identifier that no other picture of the page has.
    markup : str
        An ``svg`` or ``img`` element.
    caption : str
        What it shows, and how it was computed.
    wide : bool
        Whether it needs a width that a phone does not have, and is to scroll in its own box.
    """

    name: str
    markup: str
    caption: str
    wide: bool = False


def picture(
    name: str, draw: Callable[[], Figure], alt: str, caption: str, *, wide: bool = False
) -> Picture:
    """Draw a figure as SVG, or as PNG where that is much smaller.

    Parameters
    ----------
    name : str
    draw : callable
        Takes nothing, returns the figure.
    alt : str
        What the figure shows, for those who do not see it.
    caption : str
    wide : bool
        See `Picture`.
    """
    with mpl.rc_context(LOOKS):
        figure = draw()
        written = io.BytesIO()
        none = {"Date": None, "Creator": None, "Format": None, "Type": None}
        figure.savefig(written, format="svg", transparent=True, dpi=160, metadata=none)
        if len(written.getvalue()) <= MOST_SVG:
            return Picture(name, _inline(written.getvalue().decode(), name, alt), caption, wide)
        written = io.BytesIO()
        figure.savefig(written, format="png", dpi=160, metadata={"Software": None})
    encoded = base64.b64encode(written.getvalue()).decode()
    source = f"data:image/png;base64,{encoded}"
    return Picture(name, f'<img src="{source}" alt="{_escaped(alt)}">', caption, wide)


def _inline(svg: str, name: str, alt: str) -> str:
    """Make an SVG file an element of a page: identifiers of its own, as wide as there is room."""
    body = svg[svg.index("<svg ") :]
    body = re.sub(r"(?s)<metadata>.*?</metadata>\s*", "", body)
    body = re.sub(r'(?<=[\s<])(id="|xlink:href="#)', rf"\g<1>{name}-", body)
    body = body.replace("url(#", f"url(#{name}-")
    view = re.search(r'viewBox="[^"]*"', body)
    assert view is not None
    head = f'<svg {view[0]} role="img" aria-label="{_escaped(alt)}">'
    return re.sub(r"\n\s*", "\n", head + body[body.index(">") + 1 :].strip())


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")


def map_picture(mission: Mission, found: Map) -> Picture:
    """Draw an atlas with the mission's point.

    Parameters
    ----------
    mission : Mission
    found : Map
    """

    def draw() -> Figure:
        figure = atlas_figure(mission, found.data, "margin", found.printed)
        return _narrow(figure, 5.0)

    y, x = (str(name) for name in found.data["margin"].dims)
    return picture(
        "atlas",
        draw,
        f"Map of the certified margin over the gains {x} and {y}, the mission's point marked.",
        f"Margin over {x} and {y}, everything else as in the mission; the star is the mission. The "
        "map is computed in floating point: a certificate exists for the mission's own point only.",
    )


def region_picture(mission: Mission, found: RegionVerdict) -> Picture:
    """Draw where the eigenvalue bounds of Q hold.

    Parameters
    ----------
    mission : Mission
    found : RegionVerdict
    """
    return picture(
        "region",
        lambda: _narrow(region_figure(mission, found.box), 4.6),
        "Cross-section of the positions in which the eigenvalues of Q keep to their bounds, with "
        "target, goal, start and the box of the question.",
        "Vertical cross-section through the goal. The shading is computed in floating point; what "
        "is said of the box is proved in exact arithmetic.",
    )


def attraction_pictures(region: Proved) -> list[Picture]:
    """Draw a region of attraction in cross-section, and Λ along flights.

    Parameters
    ----------
    region : Proved
    """
    view = attraction.View.of(region)
    flights = attraction.fly(region, view, FLIGHTS)

    def section() -> Figure:
        figure = Figure(figsize=(WIDTH, 5.6), layout="constrained")
        axes = figure.subplots()
        attraction.draw_section(axes, region, view, flights)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=1)
        return figure

    def energy() -> Figure:
        figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
        attraction.draw_energy(figure.subplots(), region, flights)
        return figure

    return [
        picture(
            "attraction-section",
            section,
            "Cross-section of the certified hovers, with target, goal, start and simulated starts.",
            "From every hover in the shaded set the vehicle reaches its goal: that is proved, the "
            f"shape is drawn in floating point. The {FLIGHTS} simulated starts are an illustration.",
        ),
        picture(
            "attraction-energy",
            energy,
            "The function Λ over time along simulated flights, and the proved level.",
            "Λ along those flights, from inside and outside of the certified set.",
        ),
    ]


def flight_pictures(flown: Flown) -> Iterator[Picture]:
    """Draw a flight, a panel at a time.

    Parameters
    ----------
    flown : Flown
    """
    flight = flown.whole
    first = flown.beginning if flown.beginning is not None else flight
    until = "" if flown.beginning is None else f" in the first {first['time'].values[-1]:g} s"

    def panel(draw: Callable[..., None], record: object, height: float, **options: object) -> Figure:
        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        axes = figure.add_subplot(projection=options.pop("projection", None))
        draw(axes, record, *options.values())
        if not axes.get_xlabel():
            axes.set_xlabel("time (s)")
        return figure

    yield picture(
        "flight-path",
        lambda: panel(panels.path, flight, 4.4, projection="3d"),
        "The path in space over the target, from start to goal.",
        "The path over the target; z is down, so up on the page is up in the world.",
    )
    yield picture(
        "flight-image",
        lambda: panel(panels.image_tracks, flight, 4.4),
        "Tracks of the target points in the image.",
        "What the camera sees: the tracks of the target points in the image plane.",
    )
    claim = "" if flown.decay is None else f" The straight line is proved: {flown.decay.label()}."
    yield picture(
        "flight-errors",
        lambda: panel(panels.errors, flight, 4.0, decay=flown.decay),
        "Sizes of the four errors and the Lyapunov function over time, on a logarithmic scale.",
        "The errors of the controller and the Lyapunov function L." + claim,
    )
    for name, draw, alt, record, when in (
        ("position", panels.position, "Position", flight, ""),
        ("attitude", panels.attitude, "Roll, pitch and yaw", first, until),
        ("rotors", panels.rotor_forces, "Thrust of each rotor", first, until),
        ("view", panels.required_view, "Angle of the farthest target point", first, until),
    ):
        yield picture(
            f"flight-{name}",
            lambda draw=draw, record=record: panel(draw, record, 3.0),  # type: ignore[misc]
            f"{alt} over time{when}.",
            f"{alt}{when}.",
        )


def batch_picture(flown: Flown) -> Picture:
    """Draw many flights as a fan.

    Parameters
    ----------
    flown : Flown
        With a batch.
    """
    assert flown.batch is not None
    batch = flown.batch
    runs = batch.sizes["run"]
    return picture(
        "flights",
        lambda: fans.fans_figure(batch),
        f"Bands that hold 90 % of {runs} flights, with their medians, over time.",
        f"{runs} flights drawn from the scatter of the mission (seed 0): median, and the band that "
        "holds 90 % of them.",
        wide=True,
    )


def _narrow(figure: Figure, height: float) -> Figure:
    """Fit a figure with one pair of axes and a legend below it to the width of a phone."""
    figure.set_size_inches(WIDTH, height)
    for axes in figure.axes[:1]:
        axes.set_title("")
    return figure
