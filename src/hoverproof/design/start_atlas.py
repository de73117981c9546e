"""Maps of from which gains the start of a mission is held, for every vehicle within tolerance.

The theorem is that of `certification.exponential`. For each cell weights are searched in floating
point, as `tune` does: where some are found, the cell is *found* to hold the start, and in which
time. Where none are found nothing is refuted. A cell is *proved* where its own certificate says so,
which is asked for where found cells end, and at the soonest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.proof import converge, model_fingerprint, require_question
from hoverproof.certification.exponential.question import SETTLED
from hoverproof.certification.exponential.sooner import OUTSIDE
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.design.axes import NOT_ASKED, Axis, cell_mission, map_record, on_boundary, two_axes
from hoverproof.design.limits import ANY, Limits
from hoverproof.design.start_search import Point, StartSearch
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.variables import Design
from hoverproof.simulation.record import Record
from hoverproof.spread import collected, count

Array = NDArray[np.float64]
Report = Callable[[int, int], None]
CELLS = 16
"""Along each axis, unless said."""
NOT_PROVED, PROVED = 0, 1
"""Of a cell for which a certificate was asked: whether it came."""
FIRST, HOPELESS = 5, 0.5
"""So many programs, at most, tell whether it is worth to go on: where no more than that share of
the rate is missing then, or what is beyond a limit in rad."""
AGAIN, WORTH, ALIKE = 4, 0.02, 0.1
"""So often, at most, a search goes on that makes the time shorter by that share, until it is longer
than a neighbour's by no more than that share."""
WORDS = {
    "settling_time": ("s", "when the start has settled, found by search, floating point"),
    "verdict": ("1", "certificate: 1 proved, 0 not proved, -128 not asked"),
    "proved_time": ("s", "when the start has settled, proved"),
}


def time_of(cell: Point | None) -> float:
    """Return when the start has settled, s; NaN if it is not found to be held.

    Parameters
    ----------
    cell : Point or None
        The best that was found.
    """
    return math.exp(cell.cost) if cell is not None and cell.cost < OUTSIDE else math.nan


def start_chart(
    mission: Mission,
    x: Axis | str,
    y: Axis | str,
    *,
    exact: bool = False,
    processes: int | None = None,
    scheduler: str | None = None,
    report: Report = lambda done, total: None,
) -> Record:
    """Map in how many seconds every vehicle within tolerance has settled from the start.

    Parameters
    ----------
    mission : Mission
    x, y : Axis, or str
        What varies, of `axes.OF_START`.
    exact : bool
        Prove the cells that are found and have a neighbour that is not, and the soonest.
    processes : int, optional
        A bare number: see `hoverproof.atlas`, also for scheduler and report.
    scheduler : str, optional
    report : callable

    Returns
    -------
    Record
        ``settling_time`` s over (y, x), NaN where no weights are found; ``verdict``, 1 proved, 0
        not proved, -128 not asked; ``proved_time`` s, NaN where nothing is proved.

    Raises
    ------
    InputError
        If an axis cannot be used, or the mission poses no question.
    """
    require_question(mission, [Start.of(mission)])
    x, y = two_axes(mission, x, y, of_start=True, cells=CELLS)
    search = _prepared(mission)
    seed = search.run(lambda text: None)
    rest = None if seed is None or seed.cost >= OUTSIDE else seed.z[4:]
    look = partial(row, mission, x, y, search.whole.settled, rest)
    cells = collected(look, range(len(y.values)), processes, scheduler, report, parts=len(x.values))
    time = np.array([[time_of(cell) for cell in line] for line in cells])
    verdict = np.full(time.shape, NOT_ASKED, np.int16)
    proved = np.full(time.shape, math.nan)
    if exact and (asked := to_prove(time)):
        prove = partial(prove_cell, mission, x, y)
        times = collected(prove, asked, processes, scheduler, report)
        for place, shown in zip(asked, times, strict=True):
            verdict[place] = NOT_PROVED if math.isnan(shown) else PROVED
            proved[place] = shown
    data = {"settling_time": time, "verdict": verdict, "proved_time": proved}
    attrs = {
        "title": f"atlas of the start of {mission.name}",
        "settled_within": float(search.whole.radius),
        "model_sha256": model_fingerprint(law_of(mission)),
    }
    return map_record(mission, x, y, data, WORDS, attrs)


def _prepared(mission: Mission) -> StartSearch:
    """Return a search for the first share of the way, as settled, at which gains are found."""
    search = StartSearch.of(mission, Limits(bandwidth=ANY))
    for share in SETTLED if search.whole.vehicles.is_shaken else ():
        search = replace(search, whole=replace(search.whole, settled=share))
        own = _best(search, search.own, None, None)
        if own is not None and own.cost < OUTSIDE:
            break
        if search.held(None) is not None:
            break
    return search


def row(
    mission: Mission, x: Axis, y: Axis, settled: float, seed: Array | None, i: int
) -> list[Point | None]:
    """Look at the cells of a row, from left to right, and at those not found from right to left.

    Each sets out where its neighbour ended, too.

    Parameters
    ----------
    mission : Mission
    x, y : Axis
    settled : float
        One of `SETTLED`, dimensionless.
    seed : (3,), or None
        d, share and rate of the best gains, as in `Point`.
    i : int
        Number of the row.
    """
    places = range(len(x.values))
    searches = list(_searches(mission, x, y, settled, i))
    cells: list[Point | None] = [None for _ in places]
    for again, order in enumerate((places, reversed(places))):
        beside = None
        for j in order:
            before, asked = cells[j], searches[j]
            if asked is not None:
                if before is None or (before.cost >= OUTSIDE and beside is not None):
                    point = _best(*asked, beside, seed)
                    if point is not None and (before is None or point.cost < before.cost):
                        cells[j] = before = point
                beside = None if before is None or before.cost >= OUTSIDE else before
            if not again:
                count()
    return cells


def _searches(
    mission: Mission, x: Axis, y: Axis, settled: float, i: int
) -> Iterator[tuple[StartSearch, Array] | None]:
    """Yield the search of each cell of a row and its gains; None where no question is posed."""
    whole, names = None, Design.chain_gains()
    same = not any(one.quantity.key.startswith("uncertainty") for one in (x, y))
    for j in range(len(x.values)):
        try:
            cell = cell_mission(mission, x, y, i, j)
        except InputError:
            yield None
            continue
        if whole is None:
            whole = StartSearch.of(cell, Limits(bandwidth=ANY))
            whole = replace(whole, whole=replace(whole.whole, settled=settled))
        asks = replace(whole.whole, vehicles=Vehicles.of(cell))
        search = whole if same else replace(whole, mission=cell, whole=asks, tried=[])
        yield search, np.array([getattr(cell.gains, name) for name in names], float)


def _best(
    search: StartSearch, four: Array, beside: Point | None, seed: Array | None
) -> Point | None:
    """Return the best point for gains; None if there is none to set out from."""
    near = search.places(four)[:1] if beside is None else [beside.z[4:]]
    like = -math.inf if beside is None else beside.cost + ALIKE
    near += [] if seed is None else [seed]
    if not near:
        return None
    point = search.best_for(four, np.array(near), FIRST)
    for _ in range(AGAIN if point.cost < OUTSIDE + HOPELESS else 0):
        before, new = point, search.best_for(four, point.z[None, 4:])
        point = min(point, new, key=lambda point: point.cost)
        if point.cost <= like or point.cost > before.cost - WORTH:
            break
    return point


def to_prove(time: Array) -> list[tuple[int, int]]:
    """Return the cells that are found and have a neighbour that is not, and the soonest.

    Parameters
    ----------
    time : (m, n)
        s; NaN where none is found.
    """
    found = ~np.isnan(time)
    if not found.any():
        return []
    edge = found & on_boundary(np.where(found, 1.0, -1.0))
    edge[np.unravel_index(np.nanargmin(time), time.shape)] = True
    return [(int(i), int(j)) for i, j in np.argwhere(edge)]


def prove_cell(mission: Mission, x: Axis, y: Axis, place: tuple[int, int]) -> float:
    """Return when the start has settled with the gains of a cell, proved, s; NaN if it is not.

    Parameters
    ----------
    mission : Mission
    x, y : Axis
    place : (i, j)
        Its numbers along y and x.
    """
    verdict = converge(cell_mission(mission, x, y, *place)).proved
    return math.nan if verdict is None else float(verdict.settling.time)
