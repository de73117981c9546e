"""How far hovers are certified, against the speed near the goal: regions to choose from."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.servo.linearised import slowest_rate
from hoverproof.show.style import COLOURS, round_numbers, save_figure

Array = NDArray[np.float64]


def trade_off_figure(regions: Sequence[Attraction], own: Attraction | None = None) -> Figure:
    """Draw how far hovers are certified, against the speed near the goal.

    Parameters
    ----------
    regions : sequence of Attraction
        Of the same vehicle with other gains, proved without a barrier.
    own : Attraction, optional
        Of the gains that the mission has, for comparison.
    """
    figure = Figure(figsize=(7, 5.5), layout="constrained")
    axes = figure.subplots()
    speed = np.array([slowest_rate(region.mission) for region in regions])
    order = np.argsort(speed)
    for way, marker, colour in (
        ("up", "^-.", COLOURS[2]),
        ("down", "s--", COLOURS[1]),
        ("sideways", "o-", COLOURS[0]),
    ):
        reach = np.array([float(getattr(region.reach, way)) for region in regions])
        axes.loglog(speed[order], reach[order], marker, color=colour, label=way)
        if own is not None:
            held = float(getattr(own.reach, way))
            axes.plot(slowest_rate(own.mission), held, "*", color=colour, markersize=14, zorder=3)
    if own is not None:
        axes.plot([], [], "k*", markersize=14, linestyle="none", label="the mission's own gains")
    for axis in (axes.xaxis, axes.yaxis):
        round_numbers(axis)
    axes.set_xlabel("decay rate of the slowest motion at the goal (1/s, linearised)")
    axes.set_ylabel("certified hovers reach from the goal (m)")
    axes.set_title(f"{regions[0].mission.name}: what speed costs, each point proved")
    axes.grid(alpha=0.3, which="both")
    figure.legend(loc="outside lower center", ncols=4)
    return figure


def save_trade_off_figure(
    regions: Sequence[Attraction], own: Attraction | None, path: Path
) -> None:
    """Write the curve as PNG or SVG.

    Parameters
    ----------
    regions, own
        See `trade_off_figure`.
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(trade_off_figure(regions, own), path)
