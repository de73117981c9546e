"""Read the netCDF files that `simulate`, `fly` and `see` write."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.log import MOST_ROWS, FlightLog
from hoverproof.audit.tracks import EVER, thinned
from hoverproof.errors import InputError
from hoverproof.mission.exact import exact
from hoverproof.plant.rigid_body import rotation_rows

Array = NDArray[np.float64]

AT_A_TIME = 100_000
"""So many rows of a column are read at once."""

COLUMNS = {
    "position": "position",
    "velocity": "velocity",
    "rotation": "rotation",
    "rate": "body_rate",
    "specific_force": "specific_force",
    "thrust_command": "thrust_command",
    "rotor_command": "rotor_command",
    "rate_command": "rate_setpoint",
    "image_age": "image_age",
    "status": "firmware_status",
}
"""What a log has, by the name that it has in the file."""


def read(path: Path, between: tuple[float, float] = EVER) -> FlightLog:
    """Read a file of ours.

    Parameters
    ----------
    path : Path
    between : (2,)
        s: what is not is left out.

    Raises
    ------
    InputError
        If it is damaged, or another kind of netCDF.
    """
    try:
        with h5py.File(path, "r") as file:
            return _read(file, str(path), between)
    except InputError:  # which is a ValueError
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, IndexError):
        reason = "is damaged or cut short, or was not written by simulate, fly or see"
        raise InputError(str(path), "", reason) from None


def _read(file: Any, source: str, between: tuple[float, float]) -> FlightLog:
    attrs = dict(file.attrs)
    title = str(attrs["title"])
    if "run" in file:
        raise InputError(source, "", "holds many flights: give the file of one")
    first, last = _places(file["time"], between)
    count = last - first
    step = max(1, -(-count // MOST_ROWS))

    def column(name: str) -> Array | None:
        if name not in file:
            return None
        data = file[name]
        parts = [
            data[i : min(i + AT_A_TIME * step, last) : step]
            for i in range(first, last, AT_A_TIME * step)
        ]
        return np.concatenate([np.asarray(p, np.float64) for p in parts]) if parts else None

    notes = (thinned(step, count),) if step > 1 else ()
    times = column("time")
    if times is None or (len(times) < 2 and between != EVER):
        raise InputError(source, "", "holds no flight between these times")
    held: dict[str, Any] = {"source": source, "times": times, "notes": notes}
    if "mission" in attrs:
        held["mission"] = json.loads(attrs["mission"])
    held["outcome"] = str(attrs.get("outcome", ""))
    if title.startswith("what was seen"):
        whole = _whole(file["pixel"], first, last)
        return FlightLog(
            kind="images, by see",
            partial=str(attrs.get("partial", "")),
            frames=np.asarray(file["time"][first:last], np.float64),
            frames_whole=whole,
            feature=column("feature"),
            **held,
        )
    held |= {ours: column(theirs) for ours, theirs in COLUMNS.items()}
    held["feature"] = column("feature" if "feature" in file else "centroid_held")
    if "phase" in file:
        return _flown(held, column)
    return _simulated(held, file, column, between)


def _simulated(
    held: dict[str, Any],
    file: Any,
    column: Callable[[str], Array | None],
    between: tuple[float, float],
) -> FlightLog:
    """Return the log of a flight by simulate, of which some is held."""
    held["step"] = float(np.ravel(file.attrs["step"])[0])
    held["ahead"] = 1
    if held["feature"] is not None and not held["feature"][0].any():
        held["feature"][0] = held["feature"][1]  # the first image is in use from the start on
    if "thrust_command" not in file:  # what is asked for is made, at once
        held |= {"thrust_command": column("thrust"), "rotor_command": column("rotor_thrust")}
        held |= {"feature": column("centroid"), "image_age": 0 * held["times"]}
        held |= {"ahead": 0, "continuous": True}
    if "frame" in file:
        begin, end = _places(file["frame"], between)
        held["frames"] = np.asarray(file["frame"][begin:end], np.float64)
        held["frames_whole"] = _whole(file["pixel_found"], begin, end)
    if held["specific_force"] is None:
        held["specific_force"] = _felt(held)
        held["notes"] += ("the specific force is made of the velocity, which is not noisy here",)
    return FlightLog(kind="flight, by simulate", **held)


def _places(times: Any, between: tuple[float, float]) -> tuple[int, int]:
    """Return which of the times, (n,), s, of a file are the first between two, and behind them."""
    if between == EVER:
        return 0, times.shape[0]
    begin, end = between
    all_ = np.asarray(times)
    return int(np.searchsorted(all_, begin)), int(np.searchsorted(all_, end, side="right"))


def _whole(pixels: Any, first: int, last: int) -> NDArray[np.bool_]:
    """Tell in which images all of the target was found, (m,), of (m, n, 2) px in a file."""
    parts = (pixels[i : min(i + AT_A_TIME, last)] for i in range(first, last, AT_A_TIME))
    return np.concatenate([np.zeros(0, bool), *(~np.isnan(p).any(axis=(1, 2)) for p in parts)])


def _felt(held: dict[str, Any]) -> Array:
    """Return V' + Ω × V - g ρ of a flight, (n, 3), body frame, m/s²."""
    gravity = float(exact(held["mission"]["vehicle"]["gravity"]))
    velocity, down = held["velocity"], held["rotation"][:, 2]
    change = np.gradient(velocity, held["times"], axis=0)
    return np.asarray(change + np.cross(held["rate"], velocity) - gravity * down)


def _flown(held: dict[str, Any], column: Callable[[str], Array | None]) -> FlightLog:
    """Return the part of a log of `fly` in which the law flies; its heading is not in it."""
    phase, down = column("phase"), column("gravity_direction")
    if phase is None or down is None:
        raise InputError(held["source"], "", "is no log of fly: it holds no gravity_direction")
    roll, pitch = np.arctan2(down[:, 1], down[:, 2]), -np.arcsin(np.clip(down[:, 0], -1, 1))
    angles = [roll, pitch, np.zeros(len(roll))]
    rows = rotation_rows([np.cos(a) for a in angles], [np.sin(a) for a in angles])
    held["rotation"] = np.array([[0 * roll + c for c in row] for row in rows]).transpose(2, 0, 1)
    held["notes"] += ("headings are not in the log: directions are told from the body's own",)
    log = FlightLog(kind="flight over MAVLink, by fly", **held)
    if not (phase == 2).any():
        raise InputError(log.source, "", "holds no flight: the law was never switched on")
    return log.rows(phase == 2)
