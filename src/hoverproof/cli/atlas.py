"""The command `atlas`: maps of what is certified."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from hoverproof.cli.certification import parse_weights
from hoverproof.cli.console import (
    NO_FOLDER,
    Json,
    MissionName,
    Set,
    app,
    load_mission,
    number,
    print_json,
)
from hoverproof.cli.tuning import picture_path, progress
from hoverproof.errors import InputError

VARY = (
    "k1, k2, k3, k4, lowest_eigenvalue, highest_eigenvalue, lowest_thrust, highest_thrust or level"
)


@app.command
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
    import numpy as np

    from hoverproof.design.atlas import NOT_ASKED, VERDICTS, axis, cell_values
    from hoverproof.design.atlas import atlas as draw_map
    from hoverproof.files import write_bytes
    from hoverproof.paper.conditions import where_met
    from hoverproof.show.atlas import save_atlas_figure

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
    save_atlas_figure(
        loaded, drawn, show, where_met(loaded, cell_values(loaded, across, along)), picture
    )
    margin, verdict = drawn["margin"].values, drawn["verdict"].values
    certified = int((margin > 0).sum())
    best = np.unravel_index(np.nanargmax(margin), margin.shape) if certified else None
    counts = {word: int((verdict == code).sum()) for word, code in VERDICTS.items()}
    asked = verdict != NOT_ASKED
    result = {
        "mission": loaded.name,
        "x": across.name,
        "y": along.name,
        "cells": margin.size,
        "certified": certified,
        "no_question": int(np.isnan(margin).sum()),
        "best": None
        if best is None
        else {
            across.name: float(across.values[best[1]]),
            along.name: float(along.values[best[0]]),
            "decay_rate": float(drawn["decay_rate"].values[best]),
        },
        "decided_exactly": counts if exact_boundary else None,
        "disagree": int((np.sign(margin[asked]) != verdict[asked]).sum()),
        "out": str(path),
        "figure": str(picture),
    }
    if json_:
        print_json(result, loaded)
        return 0
    share = 100 * certified / margin.size
    print(f"{loaded.name}: a map of what is certified")
    for one in (across, along):
        ends = f"{number(one.values[0])} to {number(one.values[-1])} {one.quantity.unit}"
        print(f"  {one.name:23} from {ends}")
    print(
        f"  certified               {certified} of {margin.size} cells, {share:.1f} % "
        "(floating point)"
    )
    if best is not None:
        places = ((across, best[1]), (along, best[0]))
        words = ", ".join(f"{one.name} = {number(one.values[i])}" for one, i in places)
        print(f"  best cell               {words}")
        print(f"  its decay rate          {number(drawn['decay_rate'].values[best])} 1/s")
    if exact_boundary:
        words = ", ".join(f"{n} {word}" for word, n in counts.items())
        print(f"  at the boundary         {words}, exactly; {result['disagree']} unlike the map")
    print(f"  map                     {path}")
    print(f"  figure                  {picture}")
    return 0


def _ends(option: str, text: str | None) -> tuple[float, float] | None:
    """Read a range LOW,HIGH."""
    if text is None:
        return None
    try:
        low, high = (float(part) for part in text[:100].split(","))
    except ValueError:
        raise InputError(option, "", f"must be LOW,HIGH, not {text!r}") from None
    return low, high
