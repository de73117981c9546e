"""The command `simulate`: a mission, flown."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from hoverproof.cli.console import (
    Json,
    MissionName,
    Set,
    app,
    load_mission,
    position_text,
    print_json,
    progress,
)
from hoverproof.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from hoverproof.mission import Mission
    from hoverproof.show.decay import Decay


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
    out: Annotated[Path | None, Parameter(help="Flight file to write, netCDF-4.")] = None,
    figures: Annotated[
        list[Literal["motion", "features", "path"]] | None,
        Parameter(negative="--no-figures", help="Draw this one (repeatable); by default all."),
    ] = None,
    animate: Annotated[
        Path | None, Parameter(help="Animation to write: FILE.mp4, FILE.gif or FILE.html.")
    ] = None,
    speed_up: Annotated[
        float | None,
        Parameter(help="Flight seconds in a second of animation; by default about 12 s in all."),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Fly a mission from its start, with the camera in the loop.

    Draws the flight beside its file; where the gains are proved for the mission's bounds, and the
    flight keeps to them, with the certified decay of L as a line.

    Example: `hoverproof simulate x4-flyer --duration 1500`
    """
    from hoverproof.show.figures import FIGURES, save_figures
    from hoverproof.simulation.flight import save, summary
    from hoverproof.simulation.flight import simulate as fly

    loaded = load_mission(mission, set_)
    if animate is not None:
        from hoverproof.show.animation import check_request

        check_request(animate, speed_up)
    elif speed_up is not None:
        raise InputError("--speed-up", "", "is for --animate")
    flight = fly(loaded, duration=duration, step=step, every=every)
    path = out or Path(f"{loaded.name}.flight.nc")
    save(flight, path)
    which = FIGURES if figures is None else figures
    decay = _certified_decay(loaded, flight) if "features" in which else None
    pictures = save_figures(flight, path.with_suffix(""), which, decay)
    if animate is not None:
        from hoverproof.show.animation import save_animation

        with progress("animation") as report:
            save_animation(flight, animate, speed_up=speed_up, report=report)
    result: dict[str, Any] = {
        "mission": loaded.name,
        **summary(flight),
        "figures": [str(p) for p in pictures],
        "certified_decay": None if decay is None else {"rate": decay.rate, "until": decay.until},
        "animation": None if animate is None else str(animate),
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
    if decay is not None:
        print(f"  drawn in features, {decay.label()}")
    if animate is not None:
        print(f"  animation {animate}")
    return status


def _certified_decay(mission: Mission, flight: xr.Dataset) -> Decay | None:
    """Return the decay that is proved for a flight of a mission; None if none is."""
    from hoverproof.certification.gains import Proved, certify
    from hoverproof.show.decay import decay_along

    try:
        verdict = certify(mission)
    except InputError:  # the mission's bounds pose no question: nothing to draw
        return None
    return decay_along(flight, verdict) if isinstance(verdict, Proved) else None
