"""The command `simulate`: a mission, flown."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from hoverproof.cli.console import (
    Json,
    MissionName,
    Set,
    app,
    load_mission,
    position_text,
    print_json,
)


@app.command
def simulate(
    mission: MissionName,
    *,
    duration: Annotated[
        float | None,
        Parameter(help="Length in s; by default seven time constants of the slowest motion."),
    ] = None,
    step: Annotated[float, Parameter(help="Step of the integrator in s.")] = 0.01,
    every: Annotated[
        int | None, Parameter(help="Keep every so many steps; by default about 2000 are kept.")
    ] = None,
    out: Annotated[Path | None, Parameter(help="Flight file to write; default: see above.")] = None,
    figures: Annotated[bool, Parameter(help="Draw the flight beside the file.")] = True,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Fly a mission from its start, with the camera in the loop.

    Writes NAME.flight.nc (netCDF-4, with units and the mission inside) and two figures beside it.

    Example: `hoverproof simulate x4-flyer --duration 1500`

    Example: `hoverproof simulate x4-flyer --set "start.position=[3, 1, -5]" --json`
    """
    from hoverproof.show.figures import save_figures
    from hoverproof.simulation.flight import save, summary
    from hoverproof.simulation.flight import simulate as fly

    loaded = load_mission(mission, set_)
    flight = fly(loaded, duration=duration, step=step, every=every)
    path = out or Path(f"{loaded.name}.flight.nc")
    save(flight, path)
    pictures = save_figures(flight, path.with_suffix("")) if figures else []
    result: dict[str, Any] = {
        "mission": loaded.name,
        **summary(flight),
        "figures": [str(p) for p in pictures],
        "out": str(path),
    }
    status = 0 if result["outcome"] == "flown" else 1
    if json_:
        print_json(result)
        return status

    settled = result["settled_at"]
    print(f"{loaded.name}: {result['outcome']}, {result['duration']:g} s")
    print(f"  {result['steps']} steps in {result['seconds']:.2f} s: {result['machine']}")
    if result["machine"] != "compiled C":
        print("  (no C compiler works here; with one this is much faster)")
    print(
        f"  start     {position_text(result['start_position'])}, {result['start_error']:.3g} m away"
    )
    print(
        f"  end       {position_text(result['final_position'])}, {result['final_error']:.3g} m away"
    )
    reached = "not reached" if settled is None else f"from {settled:g} s on"
    print(f"  within 10 % of the distance at the start: {reached}")
    print(f"  flight    {path}")
    for picture in pictures:
        print(f"  figure    {picture}")
    return status
