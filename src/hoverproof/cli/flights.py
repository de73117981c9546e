"""Many flights of one mission: the part of the command `simulate` behind --runs."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.cli.console import number, print_json
from hoverproof.cli.interruption import STATUS, interruption

if TYPE_CHECKING:
    from hoverproof.mission.sections import Mission

SECONDS_TO_CLOSE = 5
"""How long a batch may take to bring its file in order when it is interrupted."""


def fly_many(
    mission: Mission, path: Path, *, json_: bool, draw: bool, runs: int, **options: Any
) -> int:
    """Fly a mission many times into one file, with a bar on stderr, and say what came of it."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Remaining

    from hoverproof.simulation.campaign import batch_summary, simulate_batch
    from hoverproof.simulation.plan import check_runs_differ

    check_runs_differ(mission, runs)
    columns = (
        TextColumn("flying"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("runs, {task.fields[rate]}, left"),
        Remaining(),
    )
    quiet = not sys.stderr.isatty()
    with Progress(
        *columns, console=Console(stderr=True), transient=True, disable=quiet
    ) as progress:
        task = progress.add_task("flying", total=runs, rate="starting")
        before: list[int] = []

        def show(complete: int, steps: int) -> None:
            before.append(complete)
            interruption.grace = SECONDS_TO_CLOSE  # there is something to keep
            elapsed = progress.tasks[task].elapsed or 0
            flown = (complete - (before[0] if options["resume"] else 0)) * steps
            rate = f"{flown / elapsed / 1e6:.1f} million steps/s" if elapsed else "starting"
            progress.update(task, completed=complete, rate=rate)

        flown = simulate_batch(mission, path, runs=runs, progress=show, **options)
    interruption.said |= flown.interrupted
    pictures = _draw(path) if draw and not flown.interrupted else []
    result: dict[str, Any] = {
        "mission": mission.name,
        **batch_summary(path),
        "interrupted": flown.interrupted,
        "steps": flown.steps,
        "seconds": flown.seconds,
        "machine": flown.machine,
        "seed": options["seed"],
        "figures": [str(p) for p in pictures],
        "out": str(path),
    }
    status = STATUS if flown.interrupted else int(result["outcomes"]["flown"] < runs)
    if json_:
        print_json(result, mission)
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
            print(f"  {name.replace('_', ' '):28}  {count}")
    if complete:
        settled = f"{result['settled']}{_range(result['settled_at'], 's')}"
        print(f"  {'settled within 10 %':28}  {settled}")
        error = _range(result["final_error"], "m").strip() or "none flown"
        print(f"  {'error at the end':28}  {error}")
    if result["runs_that_lost_frames"]:
        print(f"  {'target left the view':28}  {result['runs_that_lost_frames']}")
    print(f"  flights   {path}")
    for picture in pictures:
        print(f"  figure    {picture}")
    if flown.interrupted:
        print("interrupted; the complete runs are kept, and --resume flies the rest")
    return status


def _draw(path: Path) -> list[Path]:
    import xarray as xr

    from hoverproof.show.fans import save_batch_figures

    with xr.open_dataset(path, engine="h5netcdf") as batch:
        return save_batch_figures(batch, path.with_suffix(""))


def _range(quantiles: list[float] | None, unit: str) -> str:
    if quantiles is None or not all(map(math.isfinite, quantiles)):
        return ""
    low, middle, high = map(number, quantiles)
    return f"  median {middle} {unit}, 90 % within [{low}, {high}] {unit}"
