"""The command `simulate`: a mission, flown once or many times."""

from __future__ import annotations

from collections.abc import Sequence
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
from hoverproof.cli.flights import fly_many
from hoverproof.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from hoverproof.mission.sections import Mission
    from hoverproof.show.decay import Decay


@app.command
def simulate(
    mission: MissionName,
    *,
    duration: Annotated[
        float | None,
        Parameter(help="Length in s; by default seven time constants of the slowest motion."),
    ] = None,
    step: Annotated[
        float | None,
        Parameter(help="Step of the integrator in s; by default 0.01, or what a fast loop needs."),
    ] = None,
    every: Annotated[
        int | None,
        Parameter(help="Keep every so many steps; by default about 2000 are kept, of runs 200."),
    ] = None,
    out: Annotated[
        Path | None, Parameter(help="Flight file to write; by default named after the mission.")
    ] = None,
    figures: Annotated[
        list[Literal["motion", "features", "path"]] | None,
        Parameter(
            negative="--no-figures",
            help="Draw this one (repeatable); by default all. Of runs: all or none.",
        ),
    ] = None,
    animate: Annotated[
        Path | None, Parameter(help="Animation to write: FILE.mp4, FILE.gif or FILE.html.")
    ] = None,
    speed_up: Annotated[
        float | None,
        Parameter(help="Flight seconds in a second of animation; by default about 12 s in all."),
    ] = None,
    runs: Annotated[
        int | None, Parameter(help="Fly so often, drawn from [scatter] of the mission.")
    ] = None,
    seed: Annotated[int, Parameter(help="Of all that is drawn: noise, wind, scatter.")] = 0,
    threads: Annotated[
        int | None, Parameter(help="For runs; by default as many as processors.")
    ] = None,
    scheduler: Annotated[
        str | None, Parameter(help="Fly runs on a Dask cluster: tcp://host:8786 (extra cluster).")
    ] = None,
    resume: Annotated[
        bool, Parameter(negative="", help="Go on with a file of runs that was cut short.")
    ] = False,
    precision: Annotated[
        Literal["float32", "float64"], Parameter(help="Of the numbers kept over time, of runs.")
    ] = "float32",
    controller: Annotated[
        Literal["model", "firmware"],
        Parameter(help="Fly the model's controller, or the exported C in float32, at every step."),
    ] = "model",
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Fly a mission from its start, with the camera in the loop.

    Writes NAME.flight.nc (netCDF-4, with units and the mission inside) and draws the flight beside
    it, in NAME.flight.motion.png, features and path; where the gains are proved for the mission's
    bounds, and the flight keeps to them, with the certified decay of L as a line.

    With --runs, fly it many times, into NAME.flights.nc: starts and vehicles are drawn from
    [scatter] of the mission, and the file depends on mission, seed and times alone, not on threads
    or interruptions.
    `hoverproof new` writes all that [sensors], [rotors], [wind], [model_error] and [scatter] know.

    Example: `hoverproof simulate x4-flyer --duration 1500`

    Example: `hoverproof simulate x4-flyer --set "start.position=[3, 1, -5]" --json`

    Example: `hoverproof simulate x4-flyer --runs 1000 --set scatter.position=[1,1,1]`

    Example: `hoverproof simulate crazyflie-2.1 --controller firmware --step 0.001`
    """
    loaded = load_mission(mission, set_)
    if runs is not None:
        firmware = controller == "firmware" or None
        single = {"--animate": animate, "--speed-up": speed_up, "--controller": firmware}
        for option, unfit in single.items():
            if unfit is not None:
                raise InputError(option, "", "is for a single flight, not for --runs")
        return fly_many(
            loaded,
            out or Path(f"{loaded.name}.flights.nc"),
            json_=json_,
            draw=figures is None or bool(figures),
            runs=runs,
            seed=seed,
            duration=duration,
            step=step,
            every=every,
            precision=precision,
            threads=threads,
            scheduler=scheduler,
            resume=resume,
        )
    for option, given in (("--resume", resume), ("--scheduler", scheduler), ("--threads", threads)):
        if given:
            raise InputError(option, "", "is for --runs")
    timing = {"duration": duration, "step": step, "every": every, "seed": seed}
    return _fly_once(loaded, out, figures, animate, speed_up, controller, json_, timing)


def _fly_once(
    mission: Mission,
    out: Path | None,
    figures: Sequence[str] | None,
    animate: Path | None,
    speed_up: float | None,
    controller: str,
    json_: bool,
    timing: dict[str, Any],
) -> int:
    from hoverproof.show.figures import FIGURES, save_figures
    from hoverproof.simulation.flight import save, summary, without_conditions
    from hoverproof.simulation.flight import simulate as fly
    from hoverproof.simulation.numbers import SETTLED

    if animate is not None:
        from hoverproof.show.animation import check_request

        check_request(animate, speed_up)
    elif speed_up is not None:
        raise InputError("--speed-up", "", "is for --animate")
    path = out or Path(f"{mission.name}.flight.nc")
    if controller == "firmware":
        from hoverproof.firmware import fly_firmware

        seed = timing.pop("seed")
        if seed:
            raise InputError("--seed", "", "is not for --controller firmware: nothing is drawn")
        flight = fly_firmware(mission, **timing)
    else:
        flight = fly(mission, **timing)
    save(flight, path)
    which = FIGURES if figures is None else figures
    decay = _certified_decay(mission, flight) if "features" in which else None
    pictures = save_figures(flight, path.with_suffix(""), which, decay)
    if animate is not None:
        from hoverproof.show.animation import save_animation

        with progress("animation") as report:
            save_animation(flight, animate, speed_up=speed_up, report=report)
    result: dict[str, Any] = {
        "mission": mission.name,
        **summary(flight),
        **without_conditions(mission, flight),
        "figures": [str(p) for p in pictures],
        "certified_decay": None if decay is None else {"rate": decay.rate, "until": decay.until},
        "animation": None if animate is None else str(animate),
        "out": str(path),
    }
    status = 0 if result["outcome"] == "flown" else 1
    if json_:
        print_json(result, mission)
        return status

    settled = result["settled_at"]
    whole = result["outcome"] == "flown"  # else it says when it ended
    length = f", {result['duration']:g} s" if whole else ""
    print(f"{mission.name}: {result['outcome']}{length}")
    if whole and result["final_error"] > SETTLED * result["start_error"] > 0:
        print(f"  did not come to its goal: {result['final_error']:.3g} m away at the end")
    print(f"  {result['steps']} steps in {result['seconds']:.2f} s: {result['machine']}")
    if result["machine"] == "CasADi virtual machine":
        print("  (no C compiler works here; with one this is much faster)")
    print(
        f"  start     {position_text(result['start_position'])}, {result['start_error']:.3g} m away"
    )
    print(
        f"  end       {position_text(result['final_position'])}, {result['final_error']:.3g} m away"
    )
    print(f"  within 10 % of the distance at the start: {_since(settled)}")
    if "ideal_settled_at" in result:
        told, until = _since(result["ideal_settled_at"]), result["compared_until"]
        if result["ideal_settled_at"] is None:
            told = f"not within {until:g} s, to which the two are compared"
        print(f"  without sensors, rotors, wind and errors: {told}")
        print(
            f"  from that flight at most {result['greatest_distance_from_ideal']:.3g} m away, "
            f"at the end {result['final_distance_from_ideal']:.3g} m"
        )
    if result["frames_lost"] and mission.sensors.width is not None:
        print(
            f"  a target point was out of view in {result['frames_lost']} frames, "
            f"first at {result['left_view_at']:g} s"
        )
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


def _since(settled: float | None) -> str:
    return "not reached" if settled is None else f"from {settled:g} s on"
