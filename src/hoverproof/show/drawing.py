"""What Python shows of what a verb returns: its picture, and how a notebook displays it."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from functools import singledispatch
from html import escape

import xarray as xr
from matplotlib.figure import Figure

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.certification.largest import Largest
from hoverproof.certification.over_box import ProvedBounds, RefutedBounds, UndecidedBounds
from hoverproof.certification.verdict import Proved, Refuted, Undecided
from hoverproof.mission.sections import Mission
from hoverproof.show.attraction import attraction_figure
from hoverproof.show.exponential import exponential_figure
from hoverproof.show.figures import motion_figure
from hoverproof.show.largest import largest_figure
from hoverproof.show.region import region_figure
from hoverproof.show.runs import fans_figure
from hoverproof.show.style import laid_out


@singledispatch
def plot(found: object) -> Figure:
    """Draw what was found: a flight, many flights, a region or a verdict on convergence.

    Parameters
    ----------
    found : Dataset, or a verdict of `hoverproof.attraction` or `hoverproof.region`
        A Dataset of one flight, from `hoverproof.simulate`, or of many, opened from the file of
        `hoverproof.simulate_batch`.

    Returns
    -------
    matplotlib.figure.Figure
        ``figure.savefig`` writes it; a notebook shows it.

    Raises
    ------
    TypeError
        If there is no picture of such a thing.
    """
    raise TypeError(f"there is no picture of {type(found).__name__}")


@plot.register
def _(found: xr.Dataset) -> Figure:
    return fans_figure(found) if "run" in found.sizes else motion_figure(found)


plot.register(Attraction, attraction_figure)
plot.register(Exponential, exponential_figure)
plot.register(Largest, largest_figure)


@plot.register(ProvedBounds)
@plot.register(RefutedBounds)
@plot.register(UndecidedBounds)
def _(found: ProvedBounds | RefutedBounds | UndecidedBounds) -> Figure:
    return region_figure(found.mission, found)


def html(thing: Mission | Proved | Refuted | Undecided) -> str:
    """Say in HTML what a notebook shows of a mission or a verdict, with its picture if it has one.

    Parameters
    ----------
    thing : Mission or verdict
    """
    if isinstance(thing, Mission):
        return _table(f"Mission {thing.name}", _facts(thing))
    rows = [("verdict", thing.status), ("in short", thing.gist), *map(_advised, thing.advice)]
    said = _table(thing.mission.title, [row for row in rows if row[1]])
    if thing.statement:
        said += f"<details><summary>Statement</summary>{escape(thing.statement)}</details>"
    if plot.dispatch(type(thing)) is plot.dispatch(object):  # there is no picture of it
        return said
    picture = io.StringIO()
    laid_out(plot(thing), "svg").savefig(picture, format="svg")
    drawn = picture.getvalue()
    fitted = drawn[drawn.index("<svg") :].replace(
        "<svg", '<svg style="width: 100%; height: auto"', 1
    )
    return f'{said}<div style="max-width: 60em">{fitted}</div>'


def _advised(advice: str) -> tuple[str, str]:
    return "may help", advice


def _facts(mission: Mission) -> Iterator[tuple[str, str]]:
    gains = mission.gains
    yield "vehicle", f"{float(mission.vehicle.mass):g} kg"
    yield "target", f"{len(mission.target.points)} points"
    yield "law", mission.law.name
    yield "gains", ", ".join(f"{k} = {float(v):g}" for k, v in gains if v is not None)
    place = ", ".join(f"{float(c):g}" for c in mission.start.position)
    yield "start", f"({place}) m, world axes, z down"
    yield "a proof covers", "; ".join(mission.asks_to_cover()) or "the vehicle as modelled"


def _table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    lines = (f"<tr><th>{escape(name)}</th><td>{escape(words)}</td></tr>" for name, words in rows)
    return f"<table><caption>{escape(title)}</caption>{''.join(lines)}</table>"
