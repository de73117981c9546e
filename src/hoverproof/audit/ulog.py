"""Read PX4's logs, .ulg, with pyulog: body axes forward, right, down; world axes z down."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.log import MOST_ROWS, FlightLog
from hoverproof.errors import InputError

Array = NDArray[np.float64]

TOPICS = {
    "vehicle_angular_velocity": ("xyz[0]", "xyz[1]", "xyz[2]"),
    "vehicle_acceleration": ("xyz[0]", "xyz[1]", "xyz[2]"),
    "vehicle_attitude": ("q[0]", "q[1]", "q[2]", "q[3]"),
    "vehicle_local_position": ("vx", "vy", "vz"),
    "vehicle_rates_setpoint": ("roll", "pitch", "yaw", "thrust_body[2]"),
    "landing_target_pose": ("rel_pos_valid",),
    "vehicle_status": ("nav_state",),
}
OFFBOARD = 14
HEADER, MESSAGE_HEADER = 16, 3


def read(path: Path) -> FlightLog:
    """Read a .ulg file.

    Parameters
    ----------
    path : Path

    Raises
    ------
    InputError
        If pyulog is not there, or nothing of a flight can be read.
    """
    try:
        from pyulog import ULog
    except ImportError:
        reason = "needs pyulog to be read: pip install 'hoverproof[logs]'"
        raise InputError(str(path), "", reason) from None
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # it prints what is damaged
            read = ULog(str(path), list(TOPICS))
    except Exception as error:  # pyulog raises what struct, numpy and its own parser do
        reason = f"is damaged: {' '.join(str(error).split())[:80] or type(error).__name__}"
        raise InputError(str(path), "", reason) from None
    topics = {d.name: d.data for d in read.data_list if d.multi_id == 0}
    rates = _values(topics, "vehicle_angular_velocity")
    if rates is None:
        raise InputError(str(path), "", "holds no flight: no vehicle_angular_velocity in it")
    times, rate = rates
    kept = slice(None, None, max(1, -(-len(times) // MOST_ROWS)))
    times, rate = times[kept], rate[kept]
    held: dict[str, Any] = {"rate": rate, "times": times}
    if (felt := _values(topics, "vehicle_acceleration")) is not None:
        held["specific_force"] = _between(times, *felt)
    if (attitude := _values(topics, "vehicle_attitude")) is not None:
        held["rotation"] = _rotations(_between(times, *attitude))
    if (moved := _values(topics, "vehicle_local_position")) is not None and "rotation" in held:
        world = _between(times, *moved)
        held["velocity"] = np.einsum("nij,ni->nj", held["rotation"], world)
    if (asked := _values(topics, "vehicle_rates_setpoint")) is not None:
        command = _last(times, *asked)
        held |= {"rate_command": command[:, :3], "throttle": -command[:, 3]}
    if (seen := _values(topics, "landing_target_pose")) is not None:
        held |= {"frames": seen[0], "frames_whole": seen[1][:, 0] > 0}
    short = "" if not read.file_corruption else "parts of it are damaged"
    log = FlightLog(
        source=str(path),
        kind="PX4 log",
        partial=_cut_short(path) or short,
        notes=("positions are about the autopilot's own origin: not told from the target",),
        **held,
    )
    status = _values(topics, "vehicle_status")
    if status is None or not (status[1] == OFFBOARD).any():
        return log
    return log.rows(_last(times, *status)[:, 0] == OFFBOARD)


def _values(topics: dict[str, Any], name: str) -> tuple[Array, Array] | None:
    """Return times, s, and the columns of a topic that rise in time, if all are there."""
    data, wanted = topics.get(name), TOPICS[name]
    if data is None or not all(key in data for key in wanted) or len(data["timestamp"]) < 2:
        return None
    times = np.asarray(data["timestamp"], np.float64) / 1e6
    first = np.maximum.accumulate(times)
    rising = np.r_[True, times[1:] > first[:-1]]
    return times[rising], np.stack([np.asarray(data[k], float) for k in wanted], 1)[rising]


def _between(times: Array, at: Array, values: Array) -> Array:
    each = [np.interp(times, at, c, left=np.nan, right=np.nan) for c in values.T]
    return np.stack(each, axis=1)


def _last(times: Array, at: Array, values: Array) -> Array:
    place = np.searchsorted(at, times, side="right") - 1
    return np.where(place[:, None] >= 0, values[np.maximum(place, 0)], np.nan)


def _rotations(q: Array) -> Array:
    """Return rotations, (n, 3, 3), body to world, of quaternions, scalar first."""
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows).transpose(2, 0, 1)


def _cut_short(path: Path) -> str:
    """Say whether the last message of a file is not whole."""
    size, at = path.stat().st_size, HEADER
    with path.open("rb") as file:
        while at + MESSAGE_HEADER <= size:
            file.seek(at)
            at += MESSAGE_HEADER + int.from_bytes(file.read(2), "little")
    return "it is cut short within a message" if at != size else ""
