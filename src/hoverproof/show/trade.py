"""A picture of what a tolerance, the bandwidth or a farther start costs in settling time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from hoverproof.design.outcome import StartTuned
from hoverproof.design.start_trade import TRADED, value_of
from hoverproof.design.tuning import Found
from hoverproof.mission.sections import Mission
from hoverproof.show.style import COLOURS, save_figure

Points = Sequence[tuple[float, Found]]
WORDS = {"bandwidth": "largest attitude bandwidth", "distance": "start from the goal"}


def trade_figure(mission: Mission, traded: str, points: Points) -> Figure:
    """Draw the settling times, proved and flown.

    Parameters
    ----------
    mission : Mission
    traded : str
        One of `TRADED`.
    points : sequence of (value, what was found)
        From `hoverproof.design.start_trade`; at least one is tuned.
    """
    figure = Figure(figsize=(5.2, 4.4), layout="constrained")  # to be read 390 px wide, too
    axes = figure.subplots()
    tuned = [(at, found) for at, found in points if isinstance(found, StartTuned)]
    none = [at for at, found in points if not isinstance(found, StartTuned)]
    values = np.array([at for at, _ in tuned])
    proved = np.array([float(found.verdict.settling.time) for _, found in tuned])
    flown = np.array([np.nan if found.flown is None else found.flown for _, found in tuned])
    axes.plot(values, proved, "o-", color=COLOURS[0], label="proved, every vehicle covered")
    axes.plot(values, flown, "s--", color=COLOURS[1], label="flown, as the mission says")
    if none:
        axes.plot(none, np.zeros(len(none)), "x", color="black", clip_on=False, label="no gains")
    own = value_of(mission, traded)
    if own is not None:
        axes.axvline(own, color=COLOURS[2], linestyle=":", label="of the mission")
    unit = TRADED[traded]
    what = WORDS.get(traded, f"uncertainty.{traded}")
    axes.set_xlabel(f"{what} ({unit})" if unit else what)
    axes.set_ylabel("settled after (s)")
    axes.set_title(f"{mission.name}: gains tuned for each, proved")
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=2, fontsize="small")
    return figure


def save_trade_figure(mission: Mission, traded: str, points: Points, path: Path) -> None:
    """Write the figure as PNG or SVG.

    Parameters
    ----------
    mission, traded, points
        See `trade_figure`.
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(trade_figure(mission, traded, points), path)
