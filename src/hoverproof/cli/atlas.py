"""The command `atlas`: maps of what is certified."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.console import NO_FOLDER, Json, MissionName, Set, load_mission, progress
from hoverproof.cli.reading import parse_weights, picture_path
from hoverproof.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from hoverproof.design.atlas import Axis
    from hoverproof.mission.sections import Mission

VARY = (
    "k1, k2, k3, k4, lowest_eigenvalue, highest_eigenvalue, lowest_thrust, highest_thrust or level"
)


def atlas(
    mission: MissionName,
    *,
    x: Annotated[str, Parameter(help=f"What varies across: {VARY}.")] = "k1",
    y: Annotated[str, Parameter(help="What varies upward: another of these.")] = "k2",
    x_range: Annotated[
        str | None, Parameter(help="Range LOW,HIGH of x; by default /10 to x10.")
    ] = None,
    y_range: Annotated[str | None, Parameter(help="Range LOW,HIGH of y.")] = None,
    x_scale: Annotated[Literal["log", "linear"] | None, Parameter(help="Scale of x.")] = None,
    y_scale: Annotated[Literal["log", "linear"] | None, Parameter(help="Scale of y.")] = None,
    cells: Annotated[int, Parameter(help="Cells along each axis.")] = 200,
    show: Annotated[
        Literal["decay_rate", "margin"], Parameter(help="What the colours show.")
    ] = "decay_rate",
    exact_boundary: Annotated[
        bool, Parameter(negative="", help="Decide each cell at the boundary exactly.")
    ] = False,
    processes: Annotated[
        int | None, Parameter(help="How many work at once; by default one for each CPU.")
    ] = None,
    scheduler: Annotated[
        str | None, Parameter(help="Work on a Dask cluster: tcp://host:8786 (extra cluster).")
    ] = None,
    weights: Annotated[str | None, Parameter(help="Weights of L: w1,w2,w3,w4.")] = None,
    out: Annotated[
        Path | None, Parameter(help="Map file to write, netCDF-4.", validator=NO_FOLDER)
    ] = None,
    figure: Annotated[
        Path | None,
        Parameter(
            help="Figure to write, PNG or SVG; by default beside the map.", validator=NO_FOLDER
        ),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Map the certified decay rate over two gains or bounds.

    The map is in floating point; with --exact-boundary each cell that has a neighbour on the other
    side is decided exactly, as `certify` does. Writes NAME.atlas.nc and a figure.

    Example: `hoverproof atlas x4-flyer --x k3 --y k4 --exact-boundary`

    Example: `hoverproof atlas x4-flyer --cells 50 --show margin --figure k1-and-k2.svg`
    """
    from hoverproof.cli.answers.atlas import AtlasAnswer
    from hoverproof.design.atlas import atlas as draw_map
    from hoverproof.design.atlas import axis
    from hoverproof.design.atlas_summary import atlas_summary
    from hoverproof.files import write_bytes

    loaded = load_mission(mission, set_)
    if processes is not None and not 1 <= processes <= 1024:
        raise InputError("--processes", "", f"must be from 1 to 1024, not {processes}")
    if processes is not None and scheduler is not None:
        raise InputError("--processes", "", "does not go with --scheduler")
    across = axis(loaded, x, ends=_ends("--x-range", x_range), scale=x_scale, cells=cells)
    along = axis(
        loaded, y, ends=_ends("--y-range", y_range), scale=y_scale, cells=cells, option="--y"
    )
    path = out or Path(f"{loaded.name}.atlas.nc")
    picture = picture_path(figure or path.with_suffix(".png"))
    with progress("atlas") as report:
        drawn = draw_map(
            loaded,
            across,
            along,
            weights=parse_weights(loaded, weights, None),
            exact=exact_boundary,
            processes=processes,
            scheduler=scheduler,
            report=report,
        )
    write_bytes(path, drawn.to_netcdf(engine="h5netcdf"))
    _draw(loaded, drawn, across, along, show, picture)
    found = atlas_summary(drawn)
    answer = AtlasAnswer(loaded.name, across, along, found, exact_boundary, path, picture)
    return tell(answer, json_, loaded)


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
