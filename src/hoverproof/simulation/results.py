"""The file of many runs: netCDF-4, laid out whole at the start, filled run by run.

All space is taken when the file is made, so a full disk shows before the first flight. Later the
numbers of a run are written to their places without HDF5, whose metadata a failing disk would tear:
whatever stops the runs, the file stays whole. A run is complete when its ``outcome`` is not -1; the
attribute ``runs_complete`` counts them. The file holds no time of day and nothing of the machine,
so the same runs give the same bytes.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.files import replacing
from hoverproof.simulation.flight_log import OUTCOMES
from hoverproof.simulation.plan import Plan
from hoverproof.version import __version__

Precision = str
"""``"float32"`` or ``"float64"``: how numbers over time are kept; those of a run are float64."""

SERIES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "position": (("axis",), "m", "position ξ, world frame, z down"),
    "velocity": (("body_axis",), "m/s", "velocity V, body frame"),
    "euler_angles": (("angle",), "rad", "R = Rz(yaw) Ry(pitch) Rx(roll)"),
    "body_rate": (("body_axis",), "rad/s", "angular velocity Ω, body frame"),
    "thrust": ((), "N", "thrust T"),
    "lyapunov": ((), "1", "L = ½ Σ|δᵢ|²"),
    "rotor_thrust": (("rotor",), "N", "thrust of each rotor"),
}
"""What is kept over time, (run, time, ...): dimensions, unit, meaning."""

OF_A_RUN: dict[str, tuple[str, str, str]] = {
    "outcome": ("int8", "1", "what became of the run"),
    "flown_until": ("float64", "s", "time of the last good sample"),
    "start_error": ("float64", "m", "distance from the goal at the start"),
    "final_error": ("float64", "m", "distance from the goal at the last good sample"),
    "settled_at": ("float64", "s", "within 10 % of the start error from then on; missing: never"),
    "largest_tilt": ("float64", "rad", "largest angle between body and world vertical at a sample"),
    "least_rotor_thrust": ("float64", "N", "least thrust of any rotor at a sample"),
    "greatest_rotor_thrust": ("float64", "N", "greatest thrust of any rotor at a sample"),
    "frames_lost": ("int32", "1", "frames in which a target point was out of view"),
    "left_view_at": ("float64", "s", "when a target point first left the view; missing: never"),
}
"""What is kept of each run, (run,): type, unit, meaning."""

HEADER_BYTES = 200_000
SECONDS_BETWEEN_NOTES = 2
SIZES = {"axis": 3, "body_axis": 3, "angle": 3}


@dataclass(frozen=True)
class Batch:
    """The runs of a file: all that decides about its bytes.

    Attributes
    ----------
    plan : Plan
    runs : int
        Number of runs.
    precision : "float32" or "float64"
        Of the numbers kept over time.
    """

    plan: Plan
    runs: int
    precision: Precision

    @property
    def file_size(self) -> int:
        """About how many bytes the file takes."""
        sizes = SIZES | {"rotor": self.plan.rotors}
        numbers = sum(int(np.prod([sizes[d] for d in dims])) for dims, _, _ in SERIES.values())
        each = numbers * np.dtype(self.precision).itemsize * (self.plan.samples + 1)
        of_a_run = 8 + sum(np.dtype(kind).itemsize for kind, _, _ in OF_A_RUN.values())
        return HEADER_BYTES + 8 * self.plan.samples + self.runs * (each + of_a_run)

    @property
    def identity(self) -> dict[str, Any]:
        """What tells it from other batches, by name, as JSON has it."""
        plan = self.plan
        return {
            "mission": plan.mission.exact(),
            "conditions": plan.mission.conditions(),
            "seed": plan.seed,
            "runs": self.runs,
            "step": plan.step,
            "samples": plan.samples,
            "every": plan.every,
            "precision": self.precision,
            "version": plan.version,
            "model": plan.model_sha256,
        }


class RunsFile:
    """A file of runs that is being filled; made by `create` or `reopen`.

    Attributes
    ----------
    path : Path
    runs_complete : int
        How many runs it holds, from the first on.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        with h5py.File(path, "r", locking=False) as file:
            self._places = {
                name: (int(file[name].id.get_offset()), file[name].dtype)
                for name in (*SERIES, *OF_A_RUN)
            }
            missing = file["outcome"][:] < 0
        self.runs_complete = int(np.argmax(missing)) if missing.any() else len(missing)
        self._file = path.open("r+b", buffering=0)
        self._noted = time.monotonic()

    def write(self, block: dict[str, NDArray[Any]]) -> None:
        """Put down the next runs.

        Parameters
        ----------
        block : dict
            From `hoverproof.simulation.block.fly_block`: by name, each (k, ...) for k runs, in the
            units of `SERIES` and `OF_A_RUN`.

        Raises
        ------
        InputError
            If the file cannot be written; what was complete before still is.
        """
        first, count = self.runs_complete, len(block["outcome"])
        try:
            for name in sorted(block, key="outcome".__eq__):  # the outcome last: it says complete
                offset, kind = self._places[name]
                values = np.ascontiguousarray(block[name], kind)
                self._file.seek(offset + first * values[:1].nbytes)
                left = values.tobytes()
                while left:
                    left = left[self._file.write(left) :]
        except OSError as error:
            reason = f"cannot be written: {error.strerror}; {first} runs are complete in it"
            raise InputError(str(self.path), "", reason) from None
        self.runs_complete = first + count
        if time.monotonic() > self._noted + SECONDS_BETWEEN_NOTES:
            self.note()

    def note(self) -> None:
        """Bring the attribute ``runs_complete`` up to date, if the disk lets us."""
        count = np.array([self.runs_complete], np.int64)
        with (
            contextlib.suppress(OSError, RuntimeError),
            h5py.File(self.path, "r+", locking=False) as file,
        ):
            file.attrs.modify("runs_complete", count)
        self._noted = time.monotonic()

    def close(self) -> None:
        """Note how much is complete, and close."""
        self._file.close()
        self.note()


@contextmanager
def create(path: Path, batch: Batch) -> Iterator[RunsFile]:
    """Make the file of runs, all still to be flown, and open it.

    Parameters
    ----------
    path : Path
    batch : Batch

    Raises
    ------
    InputError
        If it cannot be written or there is no room for it; an old file then stays as it was.
    """
    try:
        with replacing(path) as beside:
            _reserve(beside, batch.file_size)
            _skeleton(batch).to_netcdf(beside, engine="h5netcdf")
            with h5netcdf.File(beside, "r+") as file:
                _lay_out(file, batch)
    except RuntimeError as error:  # of HDF5
        raise InputError(str(path), "", f"cannot be written: {error}") from None
    with contextlib.closing(RunsFile(path)) as opened:
        yield opened


@contextmanager
def reopen(path: Path, batch: Batch) -> Iterator[RunsFile]:
    """Open the file of runs that was cut short.

    Parameters
    ----------
    path : Path
    batch : Batch

    Raises
    ------
    InputError
        If it is not the file of these very runs.
    """
    try:
        with h5py.File(path, "r") as file:
            found = json.loads(file.attrs["batch"])
            (_,) = file["outcome"].shape
    except FileNotFoundError:
        raise InputError(str(path), "", "no such file to resume") from None
    except (OSError, KeyError, ValueError, TypeError):
        raise InputError(
            str(path), "", "is not the file of a batch, so not to be resumed"
        ) from None
    for key, value in batch.identity.items():
        if found.get(key) != value:
            other = "other" if key.endswith("s") else "another"
            reason = f"was made with {other} {key}, so it cannot be resumed"
            if not isinstance(value, dict):
                reason += f": {found.get(key)} there, {value} here"
            raise InputError(str(path), "", reason)
    try:
        opened = RunsFile(path)
    except OSError as error:
        raise InputError(str(path), "", f"cannot be opened: {error.strerror}") from None
    with contextlib.closing(opened):
        yield opened


def _reserve(path: Path, size: int) -> None:
    """Make sure that there is room for so many bytes, before HDF5 meets the end of it."""
    room = f"for {size / 1e6:,.0f} MB of results"
    try:
        with path.open("r+b") as file:
            if hasattr(os, "posix_fallocate"):
                with _unless_unknown():
                    os.posix_fallocate(file.fileno(), 0, size)
            elif shutil.disk_usage(path.parent).free < size:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            file.truncate(0)
    except OSError as error:
        raise OSError(error.errno, f"{error.strerror}, no room {room}") from None


@contextmanager
def _unless_unknown() -> Iterator[None]:
    """Go on where a file system cannot reserve."""
    try:
        yield
    except OSError as error:
        if error.errno not in (errno.EOPNOTSUPP, errno.EINVAL):
            raise


def _skeleton(batch: Batch) -> xr.Dataset:
    """Return coordinates and provenance, without runs."""
    plan, mission, axes = batch.plan, batch.plan.mission, list("xyz")
    return xr.Dataset(
        coords={
            "time": ("time", plan.times, {"units": "s"}),
            "axis": axes,
            "body_axis": axes,
            "angle": ["roll", "pitch", "yaw"],
            "rotor": list(mission.vehicle.frame.names),
        },
        attrs={
            "title": f"closed-loop flights of {mission.name}",
            "goal_position": plan.numbers.goal,
            "goal_centroid": plan.numbers.goal_centroid,
            "mission": json.dumps(mission.exact()),
            "law": plan.numbers.law.name,
            "conditions": json.dumps(mission.conditions()),
            "seed": np.uint64(plan.seed),
            "step": plan.step,
            "every": plan.every,
            "model_sha256": plan.model_sha256,
            "hoverproof_version": __version__,
            "runs": batch.runs,
            "runs_complete": np.int64(0),
            "batch": json.dumps(batch.identity),
        },
    )


def _lay_out(file: h5netcdf.File, batch: Batch) -> None:
    """Take the space of every variable, and mark all of it as missing."""
    early = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    early.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    file.dimensions["run"] = runs = batch.runs
    number = file.create_variable("run", ("run",), "int64", data=np.arange(runs))
    number.attrs["long_name"] = "number of the run, from 0"
    for name, (dims, units, words) in SERIES.items():
        variable = file.create_variable(
            name, ("run", "time", *dims), batch.precision, fillvalue=np.nan, dcpl=early.copy()
        )
        variable.attrs.update({"units": units, "long_name": words})
    for name, (kind, units, words) in OF_A_RUN.items():
        fill = np.nan if kind.startswith("float") else None
        variable = file.create_variable(
            name,
            ("run",),
            kind,
            fillvalue=fill,
            data=None if fill is not None else np.full(runs, -1, kind),
            **({"dcpl": early.copy()} if fill is not None else {}),
        )
        variable.attrs.update({"units": units, "long_name": words})
    outcome = file.variables["outcome"]
    outcome.attrs["flag_values"] = np.arange(-1, len(OUTCOMES), dtype=np.int8)
    outcome.attrs["flag_meanings"] = " ".join(["not_flown", *OUTCOMES])
