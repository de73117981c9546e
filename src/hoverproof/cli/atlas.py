"""The command `atlas`: maps of what is certified."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.console import Json, MissionName, Set, load_mission, progress
from hoverproof.cli.reading import default_stem, file_to_write, parse_weights, refuse_given
from hoverproof.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from hoverproof.cli.answers.start_atlas import StartAtlasAnswer
    from hoverproof.design.atlas import Axis
    from hoverproof.mission.sections import Mission

VARY = (
    "k1, k2, k3, k4, lowest_eigenvalue, highest_eigenvalue, lowest_thrust, highest_thrust or "
    "level; of a start k1 to k4, or a tolerance such as thrust or latency"
)


def atlas(
    mission: MissionName,
    *,
    theorem: Annotated[
        Literal["gains", "start"],
        Parameter(
            help="Of the gains, as certify decides it, or of the start, as attraction proves it of "
            "every vehicle within tolerance."
        ),
    ] = "gains",
    x: Annotated[str, Parameter(help=f"What varies across: {VARY}.")] = "k1",
    y: Annotated[str, Parameter(help="What varies upward: another of these.")] = "k2",
    x_range: Annotated[
        str | None,
        Parameter(help="Range LOW,HIGH of x; by default /10 to x10, of a start /3 to x3."),
    ] = None,
    y_range: Annotated[str | None, Parameter(help="Range LOW,HIGH of y.")] = None,
    x_scale: Annotated[Literal["log", "linear"] | None, Parameter(help="Scale of x.")] = None,
    y_scale: Annotated[Literal["log", "linear"] | None, Parameter(help="Scale of y.")] = None,
    cells: Annotated[
        int | None, Parameter(help="Cells along each axis; by default 200, of a start 16.")
    ] = None,
    show: Annotated[
        Literal["decay_rate", "margin"] | None,
        Parameter(help="What the colours show of gains; by default decay_rate."),
    ] = None,
    exact_boundary: Annotated[
        bool,
        Parameter(
            negative="",
            help="Decide each cell at the boundary exactly; of a start, prove those that are "
            "found there, and the soonest.",
        ),
    ] = False,
    processes: Annotated[
        int | None, Parameter(help="How many work at once; by default one for each CPU.")
    ] = None,
    scheduler: Annotated[
        str | None, Parameter(help="Work on a Dask cluster: tcp://host:8786 (extra cluster).")
    ] = None,
    weights: Annotated[str | None, Parameter(help="Weights of L: w1,w2,w3,w4.")] = None,
    out: Annotated[Path | None, Parameter(help="Map file to write, netCDF-4.")] = None,
    figure: Annotated[
        Path | None,
        Parameter(help="Figure to write, PNG or SVG; by default beside the map."),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Map the certified decay rate over two gains or bounds, or the settling time from the start.

    The map is in floating point; with --exact-boundary each cell that has a neighbour on the other
    side is decided exactly, as `certify` does. Writes NAME.atlas.nc and a figure; NAME is
    as for `certify`.

    With --theorem start the map says in how many seconds every vehicle within [uncertainty] has
    settled from the mission's start, as found by search; each cell takes about half a second. With
    --exact-boundary cells at the boundary are proved, a few seconds each, and the figure marks
    which are. Where nothing is found, nothing is refuted. Writes NAME.start-atlas.nc.

    Example: `hoverproof atlas x4-flyer --x k3 --y k4 --exact-boundary`

    Example: `hoverproof atlas x4-flyer --cells 50 --show margin --figure k1-and-k2.svg`

    Example: `hoverproof atlas crazyflie-2.1 --theorem start --cells 12 --exact-boundary`

    Example: `hoverproof atlas racer-250 --theorem start --x k1 --y latency`
    """
    from hoverproof.cli.answers.atlas import AtlasAnswer
    from hoverproof.design.atlas import atlas as draw_map
    from hoverproof.design.atlas_summary import atlas_summary
    from hoverproof.files import write_bytes

    loaded, of_start = load_mission(mission, set_), theorem == "start"
    if processes is not None and scheduler is not None:
        raise InputError("--processes", "", "does not go with --scheduler")
    if of_start:
        refuse_given({"--weights": weights, "--show": show}, "is for --theorem gains")
    asked = ("--x", x, x_range, x_scale), ("--y", y, y_range, y_scale)
    across, along = (_axis(loaded, one, cells, of_start=of_start) for one in asked)
    kind = "start-atlas" if of_start else "atlas"
    path = file_to_write(out, f"{default_stem(loaded, mission, set_, proof=True)}.{kind}.nc")
    picture = file_to_write(figure, f"{path.with_suffix('.png')}", ".svg")
    with progress("atlas") as report:
        drawn = draw_map(
            loaded,
            across,
            along,
            theorem=theorem,
            weights=parse_weights(loaded, weights, None),
            exact=exact_boundary,
            processes=processes,
            scheduler=scheduler,
            report=report,
        )
    write_bytes(path, drawn.to_netcdf(engine="h5netcdf"))
    if of_start:
        return tell(_of_start(loaded, drawn, (across, along), path, picture), json_, loaded)
    _draw(loaded, drawn, across, along, show or "decay_rate", picture)
    found = atlas_summary(drawn)
    answer = AtlasAnswer(loaded.name, across, along, found, exact_boundary, path, picture)
    return tell(answer, json_, loaded)


def _axis(
    mission: Mission,
    asked: tuple[str, str, str | None, Literal["log", "linear"] | None],
    cells: int | None,
    *,
    of_start: bool,
) -> Axis:
    """Make an axis of what was asked for: its option, what varies, the range and the scale."""
    from hoverproof.design.axes import axis
    from hoverproof.design.start_atlas import CELLS

    option, name, ends, scale = asked
    return axis(
        mission,
        name,
        ends=_ends(f"{option}-range", ends),
        scale=scale,
        cells=(CELLS if of_start else 200) if cells is None else cells,
        option=option,
        of_start=of_start,
    )


def _of_start(
    mission: Mission, drawn: xr.Dataset, axes: tuple[Axis, Axis], path: Path, picture: Path
) -> StartAtlasAnswer:
    """Draw a map of settling times from the start, and sum it up."""
    from hoverproof.cli.answers.start_atlas import StartAtlasAnswer
    from hoverproof.design.atlas_summary import start_summary
    from hoverproof.show.start_atlas import save_start_atlas_figure

    save_start_atlas_figure(mission, drawn, picture)
    return StartAtlasAnswer(mission, axes, start_summary(drawn), path, picture)


def _draw(mission: Mission, drawn: xr.Dataset, x: Axis, y: Axis, show: str, picture: Path) -> None:
    """Draw a map, with the conditions of the printed theorem if it is about the mission's law."""
    from hoverproof.design.atlas import cell_values
    from hoverproof.paper.conditions import where_met
    from hoverproof.show.atlas import save_atlas_figure

    met = where_met(mission, cell_values(mission, x, y)) if mission.law.is_papers else None
    save_atlas_figure(mission, drawn, show, met, picture)


def _ends(option: str, text: str | None) -> tuple[float, float] | None:
    """Read a range LOW,HIGH."""
    if text is None:
        return None
    try:
        low, high = (float(part) for part in text[:100].split(","))
    except ValueError:
        raise InputError(option, "", f"must be LOW,HIGH, not {text!r}") from None
    return low, high
