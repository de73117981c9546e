"""What a report is made of. Each part is computed, or there is a reason why it is not."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.convergence import Converges, start_or_ball
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.certification.gains import GainsVerdict, certify
from hoverproof.certification.over_box import BoundsVerdict, certify_region
from hoverproof.design.atlas import Axis, axis, cell_values, chart
from hoverproof.errors import InputError
from hoverproof.export.cost import Footprint, Rounding, footprint, rounding
from hoverproof.export.package import NotCertified, write_package
from hoverproof.export.standing import Standing
from hoverproof.mission.sections import Mission
from hoverproof.paper.conditions import Demand, demands_of, where_met
from hoverproof.paper.judge import Judgement
from hoverproof.paper.ledger import derive_once
from hoverproof.servo.linearised import slowest_rate
from hoverproof.show.decay import Decay, decay_along
from hoverproof.show.panels import beginning
from hoverproof.simulation.flight import flown, summary, without_conditions
from hoverproof.simulation.record import Record
from hoverproof.simulation.timing import Timing

if TYPE_CHECKING:
    import xarray as xr

PARTS = ("atlas", "region", "attraction", "flight", "firmware", "ledger")
"""The parts that a report may be asked to leave out."""

MAP_AXES = ("k3", "k4")
MAP_CELLS, FEW_CELLS = 80, 12
MAP_REACHES = 10, 100, 1000
"""So many times larger and smaller gains are looked at, until `MAP_EDGE` of them are refuted."""
MAP_EDGE = 0.05
CANNOT = (InputError, RuntimeError, ArithmeticError, OSError, np.linalg.LinAlgError)
"""What a part may end with, for the report to say so and go on; anything else is a mistake here."""

Show = Callable[[str], None]


@dataclass(frozen=True)
class Missing:
    """A part that is not there.

    Attributes
    ----------
    reason : str
        Why, in plain words.
    """

    reason: str


@dataclass(frozen=True)
class Map:
    """An atlas.

    Attributes
    ----------
    data : Record
        Of `hoverproof.atlas`.
    printed : (m, n), or None
        Where the conditions of the printed theorem are met, if it is about the law.
    reach : int
        The gains go from one over that to that times those of the mission, a bare number.
    """

    data: Record
    printed: np.ndarray | None
    reach: int


@dataclass(frozen=True)
class Flown:
    """A flight, and many if they were asked for.

    Attributes
    ----------
    whole : Record
        The flight.
    beginning : Record or None
        Its first seconds in finer samples; None if the whole flight is no longer than that.
    summary : dict
        What it came to: distances in m, times in s.
    decay : Decay or None
        The proved decay of L, if it is about this flight.
    runs, runs_beginning : Dataset or None
        Many flights, and their first seconds in finer samples if they are short.
    runs_summary : dict or None
        What they came to: distances in m, times in s.
    """

    whole: Record
    beginning: Record | None
    summary: dict[str, Any]
    decay: Decay | None
    runs: xr.Dataset | None
    runs_beginning: xr.Dataset | None
    runs_summary: dict[str, Any] | None


@dataclass(frozen=True)
class Firmware:
    """The exported C, in float32, and what it costs.

    Attributes
    ----------
    manifest : dict
        Of the package.
    footprint : Footprint or Missing
        Measured with a compiler for the target.
    rounding : list of Rounding
        What float32 loses.
    """

    manifest: dict[str, Any]
    footprint: Footprint | Missing
    rounding: list[Rounding]


@dataclass(frozen=True)
class Attracted:
    """From where the controller may be switched on.

    Attributes
    ----------
    start
        What `hoverproof.attraction` returned for the start of the mission.
    region : Attraction, Exponential or None
        What holds that start; where nothing does, the region with the largest ball, if any.
    """

    start: Converges
    region: Attraction | Exponential | None


@dataclass(frozen=True)
class Parts:
    """All that a report tells of a mission.

    Attributes
    ----------
    mission : Mission
    verdict
        What `hoverproof.certify` returned.
    demands : list of Demand, or None
        Conditions of the printed theorem, if it is about the law.
    atlas : Map or Missing
    region : ProvedBounds, RefutedBounds, UndecidedBounds or Missing
    attraction : Attracted or Missing
    flight : Flown or Missing
    firmware : Firmware or Missing
    ledger : list of Judgement, or Missing
    """

    mission: Mission
    verdict: GainsVerdict
    demands: Sequence[Demand] | None
    atlas: Map | Missing
    region: BoundsVerdict | Missing
    attraction: Attracted | Missing
    flight: Flown | Missing
    firmware: Firmware | Missing
    ledger: list[Judgement] | Missing


def gather(
    mission: Mission, *, without: Collection[str] = (), runs: int | None = None, show: Show
) -> Parts:
    """Compute the parts of a report.

    Parameters
    ----------
    mission : Mission
    without : collection of str
        Some of `PARTS`, to be left out.
    runs : int, optional
        Number of flights to be drawn from the scatter of the mission, besides the one.
    show : callable
        Told, in words, what is begun.

    Raises
    ------
    InputError
        If the mission poses no question, so that there is nothing to report on.
    """
    show("verdict")
    verdict = certify(mission)

    def part(name: str, words: str, work: Callable[[], Part]) -> Part | Missing:
        if name in without:
            return Missing("It was left out on request (--without).")
        show(words)
        return attempt(work)

    return Parts(
        mission=mission,
        verdict=verdict,
        demands=demands_of(mission, verdict.problem.eigenvalues),
        atlas=part("atlas", "atlas", lambda: _map(mission)),
        region=part("region", "eigenvalue region", lambda: certify_region(mission)),
        attraction=part(
            "attraction", "region of attraction", lambda: Attracted(*start_or_ball(mission))
        ),
        flight=part("flight", "flight", lambda: _fly(mission, verdict, runs)),
        firmware=part("firmware", "firmware", lambda: _export(mission, verdict)),
        ledger=part("ledger", "ledger of the paper", derive_once),
    )


Part = TypeVar("Part")


def attempt(work: Callable[[], Part]) -> Part | Missing:
    """Do some work, or say why it cannot be done.

    Parameters
    ----------
    work : callable
        Takes nothing, returns the part.
    """
    try:
        return work()
    except CANNOT as error:
        return Missing(sentence(str(error)))
    except NotCertified as error:
        return Missing(
            f"The gains are {error.status}, so no firmware is made of them: only certified gains "
            "are exported."
        )


def sentence(words: str) -> str:
    """Write a message as a sentence; the name of a file before it stays as it is.

    Parameters
    ----------
    words : str
    """
    line = " ".join(words.split()).rstrip(".")
    named = line.partition(" ")[0].endswith(":")
    return f"{line}." if named else f"{line[:1].upper()}{line[1:]}."


def _map(mission: Mission) -> Map:
    reach = next((r for r in MAP_REACHES if _has_edge(mission, r)), MAP_REACHES[-1])
    x, y = _map_axes(mission, reach, MAP_CELLS)
    data = chart(mission, x, y, processes=1)
    papers = mission.law.is_papers
    return Map(data, where_met(mission, cell_values(mission, x, y)) if papers else None, reach)


def _has_edge(mission: Mission, reach: int) -> bool:
    """Tell whether a map that far shows more than that all of it is certified."""
    margin = chart(mission, *_map_axes(mission, reach, FEW_CELLS), processes=1)["margin"].values
    return bool((margin > 0).mean() < 1 - MAP_EDGE)


def _map_axes(mission: Mission, reach: int, cells: int) -> list[Axis]:
    own = {name: float(getattr(mission.gains, name)) for name in MAP_AXES}
    return [axis(mission, k, ends=(v / reach, v * reach), cells=cells) for k, v in own.items()]


def _fly(mission: Mission, verdict: GainsVerdict, runs: int | None) -> Flown:
    if slowest_rate(mission) <= 0:
        raise RuntimeError(
            "The loop is not stable near its goal, so a flight has no natural length; "
            f"`hoverproof simulate {mission.source} --duration 20` flies it"
        )
    whole = flown(mission, Timing())
    decay = decay_along(whole, verdict)
    early = beginning(whole)
    first = None if early is None else flown(mission, Timing(duration=early))
    told = {**summary(whole), **without_conditions(mission, whole)}
    return Flown(whole, first, told, decay, *_fly_many(mission, runs))


def _fly_many(
    mission: Mission, runs: int | None
) -> tuple[xr.Dataset | None, xr.Dataset | None, dict[str, Any] | None]:
    if runs is None:
        return None, None, None
    import xarray as xr

    from hoverproof.show.runs_again import beginning_again
    from hoverproof.simulation.runs import runs_summary, simulate_batch

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "flights.nc"
        simulate_batch(mission, path, runs=runs)
        with xr.open_dataset(path, engine="h5netcdf") as flown:
            return flown.load(), beginning_again(mission, flown), runs_summary(path)


def _export(mission: Mission, verdict: GainsVerdict) -> Firmware:
    if verdict.status != "proved":
        raise NotCertified(mission.name, verdict.status)
    thrust: tuple[Fraction, Fraction] = verdict.problem.thrust
    with tempfile.TemporaryDirectory() as folder:
        manifest = write_package(mission, folder, Standing(thrust, verdict.certificate.content))
        measured = attempt(lambda: footprint(folder, manifest))
    return Firmware(manifest, measured, rounding(mission, thrust))
