"""A map of what is certified, in a few numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hoverproof.design.atlas import VERDICTS
from hoverproof.design.axes import NOT_ASKED
from hoverproof.design.start_atlas import PROVED
from hoverproof.simulation.record import Recorded


@dataclass(frozen=True)
class AtlasSummary:
    """How much of a map is certified, and where best.

    Attributes
    ----------
    cells, certified, no_question : int
        Numbers of cells: all, those with a margin above 0, and those that pose no question.
    best : dict or None
        Where the margin is largest: the numbers of x and y by name; None if nothing is certified.
    best_decay_rate : float or None
        Decay rate of L there, 1/s.
    decided : dict
        Numbers of cells decided exactly, by verdict.
    disagree : int
        Number of these that are unlike the map.
    """

    cells: int
    certified: int
    no_question: int
    best: dict[str, float] | None
    best_decay_rate: float | None
    decided: dict[str, int]
    disagree: int


def atlas_summary(drawn: Recorded) -> AtlasSummary:
    """Sum up a map.

    Parameters
    ----------
    drawn : Dataset or Record
        From `atlas` or `chart`.
    """
    margin, verdict = drawn["margin"].values, drawn["verdict"].values
    certified, asked = int((margin > 0).sum()), verdict != NOT_ASKED
    best = rate = None
    if certified:
        y, x = (str(name) for name in drawn["margin"].dims)
        j, i = np.unravel_index(np.nanargmax(margin), margin.shape)
        best = {x: float(drawn[x].values[i]), y: float(drawn[y].values[j])}
        rate = float(drawn["decay_rate"].values[j, i])
    return AtlasSummary(
        cells=margin.size,
        certified=certified,
        no_question=int(np.isnan(margin).sum()),
        best=best,
        best_decay_rate=rate,
        decided={word: int((verdict == code).sum()) for word, code in VERDICTS.items()},
        disagree=int((np.sign(margin[asked]) != verdict[asked]).sum()),
    )


@dataclass(frozen=True)
class StartSummary:
    """How much of a map is found to hold the start, and where it has settled soonest.

    Attributes
    ----------
    cells, found, asked, proved : int
        Numbers of cells: all, those of which weights are found, those of which a certificate was
        asked for, and those that have one.
    soonest : dict or None
        Where the time is shortest: the numbers of x and y by name; None if none is found.
    time : float or None
        When the start has settled there, s, found in floating point.
    proved_time : float or None
        The same as its certificate says it, s; None without one.
    radius : float
        A vehicle has settled that near to its goal, m.
    """

    cells: int
    found: int
    asked: int
    proved: int
    soonest: dict[str, float] | None
    time: float | None
    proved_time: float | None
    radius: float


def start_summary(drawn: Recorded) -> StartSummary:
    """Sum up a map of a start.

    Parameters
    ----------
    drawn : Dataset or Record
        From `atlas` with the theorem "start", or `start_chart`.
    """
    time, verdict = drawn["settling_time"].values, drawn["verdict"].values
    found = ~np.isnan(time)
    soonest = shortest = proved = None
    if found.any():
        y, x = (str(name) for name in drawn["settling_time"].dims)
        j, i = np.unravel_index(np.nanargmin(time), time.shape)
        soonest = {x: float(drawn[x].values[i]), y: float(drawn[y].values[j])}
        shortest = float(time[j, i])
        shown = float(drawn["proved_time"].values[j, i])
        proved = None if np.isnan(shown) else shown
    return StartSummary(
        cells=time.size,
        found=int(found.sum()),
        asked=int((verdict != NOT_ASKED).sum()),
        proved=int((verdict == PROVED).sum()),
        soonest=soonest,
        time=shortest,
        proved_time=proved,
        radius=float(drawn.attrs["settled_within"]),
    )
