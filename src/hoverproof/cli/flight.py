"""The command `simulate`: a mission, flown once or many times."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from hoverproof.cli.console import (
    Json,
    MissionName,
    Set,
    app,
    load_mission,
    number,
    position_text,
    print_json,
)
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.mission import Mission


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
        int | None,
        Parameter(help="Keep every so many steps; by default about 2000 are kept, of runs 200."),
    ] = None,
    out: Annotated[Path | None, Parameter(help="Flight file to write, netCDF-4.")] = None,
    figures: Annotated[bool, Parameter(help="Draw the flight beside the file.")] = True,
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
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Fly a mission from its start, with the camera in the loop.

    With --runs, fly it many times: starts and vehicles are drawn from [scatter] of the mission,
    and the file depends on mission, seed and times alone, not on threads or interruptions.
    `hoverproof new` writes all that [sensors], [rotors], [wind], [model_error] and [scatter] know.

    Example: `hoverproof simulate x4-flyer --duration 1500`

    Example: `hoverproof simulate x4-flyer --runs 1000 --set scatter.position=[1,1,1]`
    """
    loaded = load_mission(mission, set_)
    if runs is not None:
        return _fly_many(
            loaded,
            out or Path(f"{loaded.name}.flights.nc"),
            json_=json_,
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
    return _fly_once(loaded, out, figures, json_, duration, step, every, seed)


def _fly_once(
    mission: Mission,
    out: Path | None,
    figures: bool,
    json_: bool,
    duration: float | None,
    step: float,
    every: int | None,
    seed: int,
) -> int:
    from hoverproof.show.figures import save_figures
    from hoverproof.simulation.flight import save, summary, without_conditions
    from hoverproof.simulation.flight import simulate as fly

    flight = fly(mission, duration=duration, step=step, every=every, seed=seed)
    path = out or Path(f"{mission.name}.flight.nc")
    save(flight, path)
    pictures = save_figures(flight, path.with_suffix("")) if figures else []
    result: dict[str, Any] = {
        "mission": mission.name,
        **summary(flight),
        **without_conditions(mission, flight),
        "figures": [str(p) for p in pictures],
        "out": str(path),
    }
    status = 0 if result["outcome"] == "flown" else 1
    if json_:
        print_json(result)
        return status

    settled = result["settled_at"]
    print(f"{mission.name}: {result['outcome']}, {result['duration']:g} s")
    print(f"  {result['steps']} steps in {result['seconds']:.2f} s: {result['machine']}")
    if result["machine"] != "compiled C":
        print("  (no C compiler works here; with one this is much faster)")
    print(
        f"  start     {position_text(result['start_position'])}, {result['start_error']:.3g} m away"
    )
    print(
        f"  end       {position_text(result['final_position'])}, {result['final_error']:.3g} m away"
    )
    print(f"  within 10 % of the distance at the start: {_since(settled)}")
    if "ideal_settled_at" in result:
        print(f"  without sensors, rotors, wind and errors: {_since(result['ideal_settled_at'])}")
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
    return status


def _fly_many(mission: Mission, path: Path, *, json_: bool, runs: int, **options: Any) -> int:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Remaining

    from hoverproof.simulation.campaign import batch_summary, simulate_batch

    columns = (
        TextColumn("flying"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("runs, {task.fields[rate]}, left"),
        Remaining(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("flying", total=runs, rate="starting")
        before: list[int] = []

        def show(complete: int, steps: int) -> None:
            before.append(complete)
            elapsed = progress.tasks[task].elapsed or 0
            flown = (complete - (before[0] if options["resume"] else 0)) * steps
            rate = f"{flown / elapsed / 1e6:.1f} million steps/s" if elapsed else "starting"
            progress.update(task, completed=complete, rate=rate)

        flown = simulate_batch(mission, path, runs=runs, progress=show, **options)
    result: dict[str, Any] = {
        "mission": mission.name,
        **batch_summary(path),
        "interrupted": flown.interrupted,
        "steps": flown.steps,
        "seconds": flown.seconds,
        "machine": flown.machine,
        "seed": options["seed"],
        "out": str(path),
    }
    status = 130 if flown.interrupted else int(result["outcomes"]["flown"] < runs)
    if json_:
        print_json(result)
        return status

    complete = result["runs_complete"]
    print(f"{mission.name}: {complete} of {runs} runs of {result['duration']:g} s")
    rate = flown.steps / flown.seconds / 1e6
    print(
        f"  {flown.steps} steps in {flown.seconds:.1f} s, {rate:.1f} million a second: "
        f"{flown.machine}"
    )
    for name, count in result["outcomes"].items():
        if count or name == "flown":
            print(f"  {name.replace('_', ' '):24}  {count}")
    print(f"  {'settled within 10 %':24}  {result['settled']}{_range(result['settled_at'], 's')}")
    print(f"  {'error at the end':24}  {_range(result['final_error'], 'm') or 'none flown'}")
    if result["runs_that_lost_frames"]:
        print(f"  {'target left the view':24}  {result['runs_that_lost_frames']}")
    print(f"  flights   {path}")
    if flown.interrupted:
        print("interrupted; the complete runs are kept, and --resume flies the rest")
    return status


def _since(settled: float | None) -> str:
    return "not reached" if settled is None else f"from {settled:g} s on"


def _range(quantiles: list[float] | None, unit: str) -> str:
    if quantiles is None or not all(map(math.isfinite, quantiles)):
        return ""
    low, middle, high = map(number, quantiles)
    return f"  median {middle} {unit}, 90 % within [{low}, {high}] {unit}"
