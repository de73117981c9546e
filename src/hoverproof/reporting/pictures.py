"""Figures in a page: small ones that stay legible on a phone, in the colours of the page."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.certification.flow import flow_of
from hoverproof.certification.over_box import BoundsVerdict
from hoverproof.mission.sections import Mission
from hoverproof.reporting.parts import Flown, Map
from hoverproof.show import attraction, exponential, panels, style
from hoverproof.show.atlas import atlas_figure
from hoverproof.show.image_plane import draw_image
from hoverproof.show.region import region_figure

WIDTH = 4.2
LONG_LABEL = 24
"""So many letters, and a panel is too narrow for three columns."""
FLIGHTS = 30
MOST_SVG = 400_000
COLOURS = {
    "#000000": "currentColor",
    "#808080": "var(--muted)",
    "#cccccc": "var(--line)",
    "#ffffff": "var(--paper)",
    **dict(
        zip(
            map(str.lower, style.COLOURS),
            (f"var(--{n})" for n in ("blue", "orange", "green", "pink", "amber", "sky")),
            strict=True,
        )
    ),
    **dict.fromkeys(("#f2f2f2", "#e6e6e6", "#ececec"), "var(--card)"),
}
"""Colours of a figure that follow those of the page, light or dark."""

LOOKS: Any = {
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
    """Draw a figure as SVG, or as PNG where an SVG would be large.

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
        figure = style.laid_out(draw(), "svg")
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
    body = re.sub(r"(?s)<(metadata|style).*?</\1>\s*", "", body)
    for fixed, follows in COLOURS.items():
        body = body.replace(f": {fixed}", f": {follows}")
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
        return _narrow(figure, 5.2, columns=1)

    y, x = (str(name) for name in found.data["margin"].dims)
    return picture(
        "atlas",
        draw,
        f"Map of the certified margin over the gains {x} and {y}, the mission's point marked.",
        f"Margin over {x} and {y}, everything else as in the mission; the star is the mission. The "
        "map is computed in floating point; only the mission's own point was decided exactly.",
    )


def region_picture(mission: Mission, found: BoundsVerdict) -> Picture:
    """Draw where the bounds of Q, or of J, hold.

    Parameters
    ----------
    mission : Mission
    found : ProvedBounds, RefutedBounds or UndecidedBounds
    """

    def draw() -> Figure:
        figure = region_figure(mission, found)
        wide, high = figure.get_size_inches()
        return _narrow(figure, WIDTH * high / wide + 0.35, columns=2)

    return picture(
        "region",
        draw,
        f"Cross-section of the positions in which the bounds of {flow_of(mission).symbol} hold, "
        "with target, goal, start and the box of the question.",
        "Vertical cross-section through the goal. The shading is computed in floating point; what "
        "is said of the box is proved in exact arithmetic.",
    )


def attraction_pictures(region: Attraction) -> list[Picture]:
    """Draw a region of attraction in cross-section, and Λ, or Ψ, along flights.

    Parameters
    ----------
    region : Attraction
    """
    if not region.mission.law.is_papers:  # whose flights and potential are drawn
        return []
    view = attraction.View.of(region)
    flights = attraction.fly(region, view, FLIGHTS)

    def section() -> Figure:
        figure = Figure(figsize=(WIDTH, 5.6), layout="constrained")
        axes = figure.subplots()
        attraction.draw_section(axes, region, view, flights)
        axes.set_title("")
        labels = axes.get_legend_handles_labels()
        figure.legend(*labels, loc="outside lower left", ncols=1, frameon=False)
        return figure

    def energy() -> Figure:
        figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
        axes = figure.subplots()
        attraction.draw_energy(axes, region, flights)
        return figure

    return [
        picture(
            "attraction-section",
            section,
            "Cross-section of the certified hovers, with target, goal, start and simulated starts.",
            "From every hover in the shaded set the vehicle reaches its goal: that is proved; the "
            f"shape is drawn in floating point, and the {FLIGHTS} simulated starts illustrate.",
        ),
        picture(
            "attraction-energy",
            energy,
            f"{region.symbol} over time along simulated flights, and the proved level.",
            f"{region.symbol} along those flights, of the vehicle as modelled, from inside and "
            "outside of the certified set.",
        ),
    ]


def exponential_pictures(verdict: Exponential) -> list[Picture]:
    """Draw where every vehicle within tolerance stays, and how soon it is near its goal.

    Parameters
    ----------
    verdict : Exponential
    """
    view = exponential.View(verdict)
    flight = exponential.fly(view)

    def section() -> Figure:
        figure = Figure(figsize=(WIDTH, 5.6), layout="constrained")
        axes = figure.subplots()
        exponential.draw_section(axes, view, flight)
        labels = axes.get_legend_handles_labels()
        figure.legend(*labels, loc="outside lower left", ncols=1, frameon=False)
        return figure

    def distance() -> Figure:
        figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
        exponential.draw_distance(figure.subplots(), view, flight)
        return figure

    return [
        picture(
            "attraction-section",
            section,
            "Cross-section of the hovers inside and of what no motion leaves, with target, goal "
            "and starts.",
            "Hovers inside, and what no motion from there leaves: where the error of the feature "
            "is within its bound, and the heights and directions around it that the theorem "
            "states. The shapes are drawn in floating point from proved numbers, and the "
            "simulated flight illustrates.",
        ),
        picture(
            "attraction-distance",
            distance,
            "The proved bound of the distance from the goal over time, and a simulated flight.",
            "The distance from the goal that the bound of Ψ allows, where it is proved small, "
            "and that of a simulated flight.",
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
    when = "" if flown.beginning is None else f" in the first {first['time'].values[-1]:g} s"

    def panel(
        draw: Callable[..., None], record: object, height: float, **options: object
    ) -> Figure:
        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        axes = figure.add_subplot(projection=options.pop("projection", None))
        draw(axes, record, *options.values())
        _legend_above(axes)
        if not axes.get_xlabel():
            axes.set_xlabel("time (s)")
        return figure

    yield picture(
        "flight-path",
        lambda: _with_room(panel(panels.path, flight, 4.6, projection="3d")),
        "The path in space over the target, from start to goal.",
        "The path over the target; z is down, so up on the page is up in the world.",
    )
    yield picture(
        "flight-image",
        lambda: panel(draw_image, flight, 4.4),
        "Tracks of the target points in the image.",
        "What the camera sees: the tracks of the target points in the image plane.",
    )
    if len(flight["time"].values) < 2:
        return
    claim = ""
    if flown.decay is not None:
        ends = flown.decay.until < float(flight["time"].values[-1])
        until = f", until {flown.decay.until:g} s, when it leaves its bounds" if ends else ""
        claim = f" The straight line is {flown.decay.label()}{until}."
    yield picture(
        "flight-errors",
        lambda: panel(panels.errors, flight, 4.0, decay=flown.decay),
        "Sizes of the four errors and the Lyapunov function over time, on a logarithmic scale.",
        "The errors of the controller and the Lyapunov function L." + claim,
    )
    for name, draw, what, record in (
        ("position", panels.position, "Position x, y and z", flight),
        ("attitude", panels.attitude, "Roll, pitch and yaw", first),
        ("rotors", panels.rotor_forces, "Thrust of each rotor", first),
        ("view", panels.required_view, "Angle of the farthest target point off the axis", flight),
    ):
        yield picture(
            f"flight-{name}",
            lambda draw=draw, record=record: panel(draw, record, 3.0),  # type: ignore[misc]
            f"{what} over time{when if record is first else ''}.",
            f"{what}{when if record is first else ''}.",
        )


def runs_picture(flown: Flown) -> Picture:
    """Draw many flights as a fan.

    Parameters
    ----------
    flown : Flown
        With runs.
    """

    from hoverproof.show.runs import fans_figure

    assert flown.runs is not None
    runs = flown.runs
    count = runs.sizes["run"]
    return picture(
        "flights",
        lambda: fans_figure(runs, flown.runs_beginning),
        f"Bands that hold 90 % of {count} flights, with their medians, over time.",
        f"{count} flights drawn from the scatter of the mission (seed 0): median, and the band "
        "that holds 90 % of them.",
        wide=True,
    )


def _with_room(figure: Figure) -> Figure:
    """Leave room in a small picture of space for the names of its axes."""
    (axes,) = figure.axes
    assert isinstance(axes, Axes3D)
    ends = (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())
    axes.set_box_aspect([abs(b - a) for a, b in ends], zoom=0.74)
    axes.tick_params(labelsize=7, pad=1)
    return figure


def _narrow(figure: Figure, height: float, columns: int) -> Figure:
    """Fit a figure of one map, with a legend below it, to the width of a phone."""
    figure.set_size_inches(WIDTH, height)
    figure.axes[0].set_title("")
    (legend,) = figure.legends
    handles = [h for h in legend.legend_handles if h is not None]
    labels = [text.get_text() for text in legend.get_texts()]
    legend.remove()
    figure.legend(handles, labels, loc="outside lower left", ncols=columns, frameon=False)
    return figure


def _legend_above(axes: Axes) -> None:
    """Put the legend of a panel above it in columns that a phone has room for."""
    handles, labels = axes.get_legend_handles_labels()
    labels = [one.partition(": ")[0] if one.startswith("certified") else one for one in labels]
    axes.legend(
        handles,
        labels,
        loc="lower left",
        bbox_to_anchor=(0, 1),
        ncols=2 if max(map(len, labels)) > LONG_LABEL else 3,
        frameon=False,
        borderaxespad=0.2,
        handlelength=1.8,
        columnspacing=1.0,
    )
