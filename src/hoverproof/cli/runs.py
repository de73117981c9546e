"""Many flights of one mission: the part of the command `simulate` behind --runs."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.cli.console import progress
from hoverproof.cli.interruption import interruption

if TYPE_CHECKING:
    from hoverproof.cli.answers.runs import RunsAnswer
    from hoverproof.mission.sections import Mission

SECONDS_TO_CLOSE = 5
"""How long runs may take to bring their file in order when they are interrupted."""


def fly_many(
    mission: Mission, path: Path, *, draw: bool, runs: int, seed: int, **options: Any
) -> RunsAnswer:
    """Fly a mission many times into one file, with a bar on stderr, and draw what came of it."""
    from hoverproof.cli.answers.runs import RunsAnswer
    from hoverproof.simulation.plan import check_runs_differ
    from hoverproof.simulation.runs import runs_summary, simulate_batch

    check_runs_differ(mission, runs)
    begin = time.perf_counter()
    before: list[int] = []
    with progress("flying") as report:
        report(0, runs, "runs, starting")

        def show(complete: int, steps: int) -> None:
            before.append(complete)
            interruption.grace = SECONDS_TO_CLOSE  # there is something to keep
            flown = (complete - (before[0] if options["resume"] else 0)) * steps
            rate = flown / (time.perf_counter() - begin) / 1e6
            report(complete, runs, f"runs, {rate:.1f} million steps/s")

        flown = simulate_batch(mission, path, runs=runs, seed=seed, progress=show, **options)
    interruption.said |= flown.interrupted
    pictures = _draw(mission, path) if draw and not flown.interrupted else []
    return RunsAnswer(mission, flown, runs_summary(path), seed, pictures)


def _draw(mission: Mission, path: Path) -> list[Path]:
    import xarray as xr

    from hoverproof.show.runs import save_runs_figures
    from hoverproof.show.runs_again import beginning_again

    with xr.open_dataset(path, engine="h5netcdf") as runs:
        first = beginning_again(mission, runs)
        return save_runs_figures(runs, path.with_suffix(""), first=first)
