"""Fly a mission many times, into a file, here or on a cluster."""

from __future__ import annotations

import contextlib
import signal
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from hoverproof.errors import InputError
from hoverproof.files import locked
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.simulation import kernel
from hoverproof.simulation.block import fly_block
from hoverproof.simulation.flight_log import OUTCOMES
from hoverproof.simulation.plan import AT_LEAST, Plan, check_seed
from hoverproof.simulation.results import Batch, Precision, create, reopen
from hoverproof.simulation.surroundings import RECORD
from hoverproof.simulation.timing import Timing
from hoverproof.spread import spread

SAMPLES = 200
MAX_RUNS = 2**32 - 1


@dataclass(frozen=True)
class Flown:
    """What came of runs.

    Attributes
    ----------
    path : Path
    runs, runs_complete : int
        Numbers of runs asked for, and complete in the file.
    steps : int
        Vehicle-steps taken now, without those of an earlier part.
    seconds : float
        Time it took, s.
    machine : str
        What flew.
    interrupted : bool
        Whether the user ended it early.
    """

    path: Path
    runs: int
    runs_complete: int
    steps: int
    seconds: float
    machine: str
    interrupted: bool

    def open(self) -> xr.Dataset:
        """Open the file: one variable a quantity, over runs and time, with units."""
        return xr.open_dataset(self.path, engine="h5netcdf")


@of_mission
def simulate_batch(
    mission: Mission,
    path: str | Path | None = None,
    *,
    runs: int,
    seed: int = 0,
    duration: float | None = None,
    step: float | None = None,
    every: int | None = None,
    precision: Precision = "float32",
    threads: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    progress: Callable[[int, int], None] | None = None,
    law: Law | None = None,
) -> Flown:
    """Fly a mission many times, drawn from its ``[scatter]``, into a netCDF-4 file.

    The file depends on mission, `runs`, `seed`, times and `precision` alone, byte for byte: not on
    threads, compiler, width of vectors or interruptions. Between different kinds of processors
    numpy's sines may differ in the last bit, and so may what is made of them.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    path : str or Path, optional
        File to write, see `hoverproof.simulation.results`; by default
        ``<name of the mission>.flights.nc``.
    runs : int
        Number of flights.
    seed : int
        Of all that is drawn, a number from 0 to 2**63 - 1.
    duration, step : float, optional
        s, as in `hoverproof.simulate`.
    every : int, optional
        Keep every so many steps; by default about 200 samples of a run are kept.
    precision : "float32" or "float64"
        Of the numbers kept over time.
    threads : int, optional
        Their number; by default as many as there are processors.
    scheduler : str, optional
        Address of a Dask scheduler whose workers fly instead; they need this hoverproof.
    resume : bool
        Go on with a file that was cut short.
    progress : callable, optional
        Told (runs complete, steps of a run) now and then.
    law : Law, optional
        What flies it; by default the law of the mission.

    Raises
    ------
    InputError
        If anything asked for is not possible, or the file cannot be written, or is being written by
        another process.
    """
    in_memory = 8 * AT_LEAST * sum(RECORD.values())
    steps = Timing(duration, step, every).steps(mission, SAMPLES, in_memory, law)
    check_seed(seed)
    if not 1 <= runs <= MAX_RUNS:
        raise InputError("--runs", "", f"must be from 1 to {MAX_RUNS}, not {runs}")
    if threads is not None and not 1 <= threads <= 1024:
        raise InputError("--threads", "", f"must be from 1 to 1024, not {threads}")
    if precision not in ("float32", "float64"):
        raise InputError("--precision", "", f"must be float32 or float64, not {precision}")
    plan = Plan(mission, steps.step, steps.samples, steps.every, seed, law=law)
    plan.prepare()
    machine = kernel.machine(plan.loop, plan.schedule)  # compiled before threads want it
    begin, path = time.perf_counter(), Path(path or f"{mission.name}.flights.nc")
    opening = reopen if resume else create
    stop, interrupted = kernel.Stop(), False
    with locked(path), opening(path, Batch(plan, runs, precision)) as file:
        earlier = file.runs_complete
        parts = [(a, min(plan.block, runs - a)) for a in range(earlier, runs, plan.block)]
        fly = partial(fly_block, plan) if scheduler else partial(fly_block, plan, stop=stop)
        blocks = spread(fly, parts, threads=threads, scheduler=scheduler, stop=stop.set)
        try:
            with contextlib.closing(blocks):
                for block in blocks:
                    with _undisturbed():
                        file.write(block)
                    if progress is not None:
                        progress(file.runs_complete, steps.count)
        except KeyboardInterrupt:
            interrupted = True
        complete = file.runs_complete
    return Flown(
        path=path,
        runs=runs,
        runs_complete=complete,
        steps=(complete - earlier) * plan.samples * plan.every,
        seconds=time.perf_counter() - begin,
        machine=f"Dask at {scheduler}" if scheduler else machine,
        interrupted=interrupted,
    )


def runs_summary(path: str | Path) -> dict[str, Any]:
    """Return what the runs in a file came to: errors in m, times in s.

    Parameters
    ----------
    path : str or Path
    """
    with xr.open_dataset(path, engine="h5netcdf") as runs:
        count = int(runs.attrs["runs_complete"])
        done = runs[["outcome", "start_error", "final_error", "settled_at", "frames_lost"]]
        done = done.isel(run=slice(count)).load()
        duration = float(runs["time"][-1])
    codes = done["outcome"].values
    good = codes == 0
    settled = done["settled_at"].values[good]
    reached = settled[np.isfinite(settled)]

    def quantiles(values: Any) -> list[float] | None:
        return np.quantile(values, [0.05, 0.5, 0.95]).tolist() if len(values) else None

    return {
        "runs": int(runs.attrs["runs"]),
        "runs_complete": count,
        "duration": duration,
        "outcomes": {name: int((codes == i).sum()) for i, name in enumerate(OUTCOMES)},
        "settled": len(reached),
        "settled_at": quantiles(reached),
        "start_error": quantiles(done["start_error"].values),
        "final_error": quantiles(done["final_error"].values[good]),
        "runs_that_lost_frames": int((done["frames_lost"].values > 0).sum()),
    }


@contextlib.contextmanager
def _undisturbed() -> Iterator[None]:
    """Put an interruption off to the end of this block."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    asked: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: asked.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if asked:
        raise KeyboardInterrupt
