"""The file of a batch: netCDF-4, laid out whole at the start, filled run by run.

All space is taken when the file is made, so a full disk shows before the first flight, and nothing
but numbers in their places is written later: whatever stops a batch, the file stays whole and says
in its attribute ``runs_complete`` how much of it has been flown. It holds no time of day and
nothing of the machine, so the same batch gives the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

import hoverproof
from hoverproof.errors import InputError
from hoverproof.files import replacing
from hoverproof.plant.rotors import ROTORS
from hoverproof.simulation.batch import OUTCOMES, Plan

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
    "largest_tilt": ("float64", "rad", "largest angle between body and world vertical"),
    "least_rotor_thrust": ("float64", "N", "least thrust of any rotor at a sample"),
    "greatest_rotor_thrust": ("float64", "N", "greatest thrust of any rotor at a sample"),
    "frames_lost": ("int32", "1", "frames in which a target point was out of view"),
    "left_view_at": ("float64", "s", "when a target point first left the view; missing: never"),
}
"""What is kept of each run, (run,): type, unit, meaning."""

SIZES = {"axis": 3, "body_axis": 3, "angle": 3, "rotor": 4}


def batch_size(plan: Plan, runs: int, precision: Precision) -> int:
    """Return about how many bytes the file of a batch takes."""
    numbers = sum(int(np.prod([SIZES[d] for d in dims])) for dims, _, _ in SERIES.values())
    each = numbers * np.dtype(precision).itemsize * (plan.samples + 1)
    return runs * (each + sum(np.dtype(kind).itemsize for kind, _, _ in OF_A_RUN.values()))


class BatchFile:
    """An open file of a batch; made by `create` or `reopen`.

    Attributes
    ----------
    path : Path
    runs_complete : int
        How many runs it holds, from the first on.
    """

    def __init__(self, path: Path, handle: h5py.File) -> None:
        self.path = path
        self._handle = handle
        self.runs_complete = _runs_complete(handle)

    def write(self, block: dict[str, NDArray[Any]]) -> None:
        """Put down the next runs.

        Parameters
        ----------
        block : dict
            From `hoverproof.simulation.batch.fly_block`.

        Raises
        ------
        InputError
            If the file cannot be written; what was complete before still is.
        """
        first, count = self.runs_complete, len(block["outcome"])
        try:
            for name, values in block.items():
                kept = self._handle[name]
                kept[first : first + count] = values.astype(kept.dtype)
            self._handle.flush()
            self._handle.attrs.modify("runs_complete", np.array([first + count], np.int64))
            self._handle.flush()
        except (OSError, RuntimeError) as error:
            raise InputError(
                str(self.path),
                "",
                f"cannot be written: {_reason(error)}; {first} runs are complete",
            ) from None
        self.runs_complete = first + count


@contextmanager
def create(path: Path, plan: Plan, runs: int, precision: Precision) -> Iterator[BatchFile]:
    """Make the file of a batch, all runs of it still to be flown, and open it.

    Parameters
    ----------
    path : Path
    plan : Plan
    runs : int
    precision : "float32" or "float64"

    Raises
    ------
    InputError
        If it cannot be written or there is no room for it; an old file then stays as it was.
    """
    size = batch_size(plan, runs, precision)
    try:
        with replacing(path) as beside:
            _skeleton(plan, runs, precision).to_netcdf(beside, engine="h5netcdf")
            with h5netcdf.File(beside, "r+") as file:
                _lay_out(file, plan, runs, precision)
    except RuntimeError as error:  # HDF5 may report a full disk so
        raise InputError(str(path), "", f"cannot be written: {_reason(error)}") from None
    except InputError as error:
        reason = f"{error.reason} (it takes {size / 1e6:,.0f} MB for {runs} runs)"
        raise InputError(error.where, error.key, reason) from None
    with _opened(path) as file:
        yield file


@contextmanager
def reopen(path: Path, plan: Plan, runs: int, precision: Precision) -> Iterator[BatchFile]:
    """Open the file of a batch that was cut short.

    Raises
    ------
    InputError
        If it is not the file of this very batch.
    """
    try:
        with h5py.File(path, "r") as file:
            found = json.loads(file.attrs["batch"])
            _runs_complete(file)
    except FileNotFoundError:
        raise InputError(str(path), "", "no such file to resume") from None
    except (OSError, KeyError, ValueError, TypeError):
        raise InputError(
            str(path), "", "is not the file of a batch, so not to be resumed"
        ) from None
    wanted = identity(plan, runs, precision)
    for key, value in wanted.items():
        if found.get(key) != value:
            reason = f"was made with another {key}, so it cannot be resumed"
            if not isinstance(value, dict):
                reason += f": {found.get(key)} there, {value} here"
            raise InputError(str(path), "", reason)
    with _opened(path) as opened:
        yield opened


def identity(plan: Plan, runs: int, precision: Precision) -> dict[str, Any]:
    """Return all that decides about the bytes of a batch's file."""
    return {
        "mission": plan.mission.exact(),
        "conditions": plan.mission.conditions(),
        "seed": plan.seed,
        "runs": runs,
        "step": plan.step,
        "samples": plan.samples,
        "every": plan.every,
        "precision": precision,
        "version": plan.version,
        "model": plan.model_sha256,
    }


@contextmanager
def _opened(path: Path) -> Iterator[BatchFile]:
    try:
        handle = h5py.File(path, "r+")
    except OSError as error:
        raise InputError(str(path), "", f"cannot be opened: {_reason(error)}") from None
    with handle:
        yield BatchFile(path, handle)


def _runs_complete(handle: h5py.File) -> int:
    (count,) = np.ravel(handle.attrs["runs_complete"])  # netCDF-4 keeps it as an array of one
    return int(count)


def _skeleton(plan: Plan, runs: int, precision: Precision) -> xr.Dataset:
    """Return coordinates and provenance, without runs."""
    mission, axes = plan.mission, list("xyz")
    return xr.Dataset(
        coords={
            "time": ("time", plan.times, {"units": "s"}),
            "axis": axes,
            "body_axis": axes,
            "angle": ["roll", "pitch", "yaw"],
            "rotor": list(ROTORS),
        },
        attrs={
            "title": f"closed-loop flights of {mission.name}",
            "goal_position": plan.numbers.goal,
            "goal_centroid": plan.numbers.design[-3:],
            "mission": json.dumps(mission.exact()),
            "conditions": json.dumps(mission.conditions()),
            "seed": np.uint64(plan.seed),
            "step": plan.step,
            "every": plan.every,
            "model_sha256": plan.model_sha256,
            "hoverproof_version": hoverproof.__version__,
            "runs": runs,
            "runs_complete": np.int64(0),
            "batch": json.dumps(identity(plan, runs, precision)),
        },
    )


def _lay_out(file: h5netcdf.File, plan: Plan, runs: int, precision: Precision) -> None:
    """Take the space of every variable, and mark all of it as missing."""
    early = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    early.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    file.dimensions["run"] = runs
    number = file.create_variable("run", ("run",), "int64", data=np.arange(runs))
    number.attrs["long_name"] = "number of the run, from 0"
    for name, (dims, units, words) in SERIES.items():
        variable = file.create_variable(
            name, ("run", "time", *dims), precision, fillvalue=np.nan, dcpl=early.copy()
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


def _reason(error: Exception) -> str:
    """Return what the system says in the long message of HDF5."""
    text = str(error)
    if "errno = " in text and "error message = '" in text:
        return text.split("error message = '")[1].split("'")[0]
    return getattr(error, "strerror", None) or text
