"""Maps of what is certified, over any two gains or bounds.

The map itself is in floating point, many cells at once. Where it turns from certified to refuted
each cell can be decided exactly, by `certify`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.bounds import eigenvalues_at_goal
from hoverproof.certification.gains import certify, model_fingerprint
from hoverproof.certification.problem import ONES, exact_weights, gain_problem, pose
from hoverproof.design.axes import NOT_ASKED, cell_mission, map_record, on_boundary, two_axes
from hoverproof.design.axes import QUANTITIES as QUANTITIES
from hoverproof.design.axes import Axis as Axis
from hoverproof.design.axes import axis as axis
from hoverproof.design.margins import Questions, margins
from hoverproof.design.start_atlas import start_chart
from hoverproof.errors import InputError
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.variables import Design
from hoverproof.simulation.record import Record
from hoverproof.spread import collected

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Report = Callable[[int, int], None]
Theorem = Literal["gains", "start"]

CHUNK = 4000
BARELY = 1e-6  # how near to its bounds Q at the goal may come, as a part
EXACT_CHUNK = 16
VERDICTS = {"refuted": -1, "undecided": 0, "proved": 1}


@of_mission
def atlas(
    mission: Mission,
    x: Axis | str = "k1",
    y: Axis | str = "k2",
    *,
    theorem: Theorem = "gains",
    weights: tuple[Fraction, ...] = ONES,
    exact: bool = False,
    processes: int | None = None,
    scheduler: str | None = None,
    report: Report = lambda done, total: None,
) -> xr.Dataset:
    """Map the certified margin and decay rate over two gains or bounds.

    With the theorem "start": in how many seconds every vehicle within tolerance has settled from
    the mission's start, over two gains or tolerances; see `start_atlas.start_chart`.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    x, y : Axis, or str
        What varies; a name stands for its default range (see `axis`).
    theorem : {"gains", "start"}
        What `certify` decides, or what `attraction` proves of every vehicle.
    weights : (4,) Fractions
        w of L = ½ Σ wᵢ|δᵢ|²; for the gains.
    exact : bool
        Decide with `certify` each cell that has a neighbour of another sign; of a start, prove
        those that have a neighbour where none is found, and the soonest.
    processes : int, optional
        Number of those that work at once; by default one for each CPU.
    scheduler : str, optional
        Address of a Dask scheduler whose workers do it instead; they need this hoverproof.
    report : callable
        Called with how much is done, of how much.

    Returns
    -------
    xarray.Dataset
        Of gains ``margin`` kg/s and ``decay_rate`` 1/s over (y, x), in floating point, NaN where no
        question is posed; ``verdict``, 1 proved, -1 refuted, 0 undecided, -128 where `certify`
        was not asked. Of a start see `start_atlas.start_chart`.

    Raises
    ------
    InputError
        If an axis or the scheduler cannot be used, or there is no such theorem.
    """
    if theorem not in get_args(Theorem):
        known = ", ".join(get_args(Theorem))
        raise InputError("--theorem", "", f"must be one of {known}, not {theorem!r}")
    weights = exact_weights(weights)
    work: dict[str, Any] = {"processes": processes, "scheduler": scheduler, "report": report}
    if theorem == "start":
        if weights != ONES:
            raise InputError("--weights", "", "is for --theorem gains")
        return start_chart(mission, x, y, exact=exact, **work).dataset()
    return chart(mission, x, y, weights=weights, exact=exact, **work).dataset()


def chart(
    mission: Mission,
    x: Axis | str,
    y: Axis | str,
    *,
    weights: tuple[Fraction, ...] = ONES,
    exact: bool = False,
    processes: int | None = None,
    scheduler: str | None = None,
    report: Report = lambda done, total: None,
) -> Record:
    """Map the margin and the decay rate: `atlas`, without the time that it takes to import xarray.

    Parameters
    ----------
    mission, x, y, exact, scheduler, report
        See `atlas`, also for what is raised.
    weights : (4,) Fractions
        w of L = ½ Σ wᵢ|δᵢ|².
    processes : int, optional
        A bare number.
    """
    x, y = two_axes(mission, x, y)
    pairs = np.stack(np.meshgrid(x.values, y.values), axis=-1).reshape(-1, 2)
    parts = [pairs[i : i + CHUNK] for i in range(0, len(pairs), CHUNK)]
    measure = partial(cell_margins, mission, x.name, y.name, weights)
    done = collected(measure, parts, processes, scheduler, report)
    margin = np.concatenate(done).reshape(len(y.values), len(x.values))
    verdict = np.full(margin.shape, NOT_ASKED, np.int16)
    if exact:
        asked = np.argwhere(on_boundary(margin))
        groups = [asked[i : i + EXACT_CHUNK] for i in range(0, len(asked), EXACT_CHUNK)]
        decide = partial(cell_verdicts, mission, x, y, weights)
        found = collected(decide, groups, processes, scheduler, report)
        if len(asked):
            verdict[tuple(asked.T)] = np.concatenate(found)
    return _record(mission, x, y, weights, margin, verdict)


def cell_margins(
    mission: Mission, x: str, y: str, weights: tuple[Fraction, ...], pairs: Array
) -> Array:
    """Return the worst eigenvalue of each cell, kg/s, (n,), in floating point.

    NaN where no question is posed, as where Q (or J) at the goal is not within the bounds.

    Parameters
    ----------
    mission : Mission
    x, y : str
        Of `QUANTITIES`.
    weights : (4,) Fractions
    pairs : (n, 2)
        Values of x and y.
    """
    questions = questions_of(mission, x, y, weights, pairs)
    low, high = questions.eigenvalues
    least, most = eigenvalues_at_goal(mission)
    asked = (low < least * (1 - BARELY)) & (most * (1 + BARELY) < high)
    return np.where(asked, margins(questions), np.nan)


def questions_of(
    mission: Mission, x: str, y: str, weights: tuple[Fraction, ...], pairs: Array
) -> Questions:
    """Return the questions of cells.

    Parameters
    ----------
    mission : Mission
    x, y : str
        Of `QUANTITIES`.
    weights : (4,) Fractions
    pairs : (n, 2)
        Values of x and y.
    """
    varied = "bounds.eigenvalues" in (QUANTITIES[x].key, QUANTITIES[y].key)
    problem = pose(mission, weights) if varied else gain_problem(mission, weights)
    questions = Questions.of(problem)
    ones = np.ones(len(pairs))
    gains = [g * ones for g in questions.gains]
    eigenvalues: list[Any] = list(questions.eigenvalues)
    thrust: list[Any] = list(questions.thrust or ())
    level: Any = questions.level
    for name, values in zip((x, y), pairs.T, strict=True):
        key, end = QUANTITIES[name].key, QUANTITIES[name].end
        if key == "bounds.level":
            level = values
        elif end is None:
            gains[int(name[1]) - 1] = values
        else:
            (eigenvalues if key == "bounds.eigenvalues" else thrust)[end] = values
    return replace(
        questions,
        gains=tuple(gains),
        eigenvalues=(eigenvalues[0], eigenvalues[1]),
        thrust=(thrust[0], thrust[1]) if thrust else None,
        level=level,
    )


def cell_verdicts(
    mission: Mission, x: Axis, y: Axis, weights: tuple[Fraction, ...], cells: NDArray[np.intp]
) -> NDArray[np.int16]:
    """Decide cells exactly, (n,), as numbers of `VERDICTS`.

    Parameters
    ----------
    mission : Mission
    x, y : Axis
    weights : (4,) Fractions
    cells : (n, 2)
        Their places along y and x.
    """
    verdicts = [
        VERDICTS[certify(cell_mission(mission, x, y, i, j), weights=weights).status]
        for i, j in cells
    ]
    return np.array(verdicts, np.int16)


def _record(
    mission: Mission,
    x: Axis,
    y: Axis,
    weights: tuple[Fraction, ...],
    margin: Array,
    verdict: NDArray[np.int16],
) -> Record:
    words = {
        "margin": ("kg/s", "worst eigenvalue of W^(-1/2) Σ W^(-1/2), floating point"),
        "decay_rate": ("1/s", "decay rate of L that follows, floating point"),
        "verdict": ("1", "certify: 1 proved, -1 refuted, 0 undecided, -128 not asked"),
    }
    values: dict[str, NDArray[Any]] = {
        "margin": margin,
        "decay_rate": 2 * margin / float(mission.vehicle.mass),
        "verdict": verdict,
    }
    attrs = {
        "title": f"atlas of {mission.name}",
        "weights": [float(w) for w in weights],
        "model_sha256": model_fingerprint(law_of(mission)),
    }
    return map_record(mission, x, y, values, words, attrs)


def cell_values(mission: Mission, x: Axis, y: Axis) -> dict[str, Array]:
    """Return the gains and eigenvalue bounds of all cells, (ny, nx) each.

    Parameters
    ----------
    mission : Mission
    x, y : Axis

    Returns
    -------
    dict
        ``k1`` kg m/s, ``k2`` 1/m, ``k3`` and ``k4`` kg/s, ``lowest`` and ``highest`` 1/m.
    """
    pairs = np.stack(np.meshgrid(x.values, y.values), axis=-1).reshape(-1, 2)
    questions = questions_of(mission, x.name, y.name, ONES, pairs)
    named = dict(zip(Design.chain_gains(), questions.gains, strict=True))
    named |= {"lowest": questions.eigenvalues[0], "highest": questions.eigenvalues[1]}  # type: ignore[dict-item]
    shape = (len(y.values), len(x.values))
    return {k: np.broadcast_to(v, len(pairs)).reshape(shape) for k, v in named.items()}
