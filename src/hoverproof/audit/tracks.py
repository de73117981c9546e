"""Rows over time as they come out of a file, within bounded memory, and the log made of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.log import MOST_ROWS, FlightLog
from hoverproof.errors import InputError

Array = NDArray[np.float64]

MOST_IMAGES = 1_000_000
"""Of images none may be left out: of more the rest is not looked at."""
EPOCH = 1e6
"""Later times are dates, s: no autopilot runs for so long."""
LEAP = 1.0
"""A time that is off its neighbours' by more is damaged, s; in a slow log by five rows."""
MOST = {"rate": 200.0, "specific_force": 2000.0, "attitude": 2.0, "frames": 1.0}
"""What no sensor of a flying vehicle tells: rad/s, m/s², components of a quaternion, 0 or 1."""
MOST_OF_OTHERS = 1e6
EVER = -math.inf, math.inf
OWN_ORIGIN = "positions are about the autopilot's own origin: not told from the target"
"""What is to be known of the logs of autopilots."""
EACH = frozenset({"frames", "feature"})
"""Of which none may be left out. A row of a feature is the exposure, s, and the three numbers."""


class Track:
    """One quantity over time: of a long log every so many rows.

    Parameters
    ----------
    width : int
        Numbers in a row.
    most : int
        So many rows are kept at most, a bare number.
    each : bool
        Whether rows may not be left out: then those after the most are.
    """

    def __init__(self, width: int, most: int = MOST_ROWS, *, each: bool = False) -> None:
        self.most, self.each = most, each
        self.stride, self.count, self.kept = 1, 0, 0
        self._parts: list[Array] = [np.empty((0, 1 + width))]

    def add(self, times: Array, values: Array) -> None:
        """Add rows.

        Parameters
        ----------
        times : (k,)
            s.
        values : (k, width)
            Any unit.
        """
        first = -self.count % self.stride
        self.count += len(times)
        rows = np.column_stack([times[first :: self.stride], values[first :: self.stride]])
        if self.each:
            rows = rows[: self.most - self.kept]
        self._parts.append(rows)
        self.kept += len(rows)
        while self.kept > self.most:
            self._parts = [np.concatenate(self._parts)[::2].copy()]
            self.kept = len(self._parts[0])
            self.stride *= 2

    def rows(self) -> tuple[Array, Array]:
        """Return times, (n,), s, and values, (n, width), as they were added."""
        table = np.concatenate(self._parts)
        self._parts = [table]
        return table[:, 0], table[:, 1:]


@dataclass
class Tracks:
    """What was gathered of a log, by quantity.

    Attributes
    ----------
    held : dict of Track
    between : (2,)
        Of the times from the origin on, s: what is not is left out.
    origin : float
        What is taken from all times, s, where these are dates.
    damaged : dict of int
        By quantity, the bare number of rows left out since their times or values cannot be.
    """

    between: tuple[float, float] = EVER
    held: dict[str, Track] = field(default_factory=dict)
    origin: float | None = None
    damaged: dict[str, int] = field(default_factory=dict)

    def add(self, name: str, times: Array, values: Array) -> None:
        """Add rows of a quantity; see `Track.add`.

        Parameters
        ----------
        name : str
            As in `FlightLog`; and attitude, as quaternions, world_velocity, and mode.
        times : (k,)
            s.
        values : (k, width)
            Any unit.
        """
        if not len(times):
            return
        if self.origin is None:
            self.origin = float(np.floor(times[0])) if times[0] > EPOCH else 0.0
        begin, end = self.between
        if self.between != EVER:
            since = -math.inf if name == "mode" else begin  # that is as it was before
            kept = (times - self.origin >= since) & (times - self.origin <= end)
            times, values = times[kept], values[kept]
        if name not in self.held:
            each = name in EACH
            most = MOST_IMAGES if each else MOST_ROWS
            self.held[name] = Track(values.shape[1], most, each=each)
        self.held[name].add(times, values)

    def rows(self, name: str) -> tuple[Array, Array] | None:
        """Return times that rise, s, and values of a quantity; None if there are not two.

        Parameters
        ----------
        name : str
        """
        if name not in self.held:
            return None
        times, values = self.held[name].rows()
        most = MOST.get(name, MOST_OF_OTHERS)
        numbers = values[:, 1:] if name == "feature" else values
        usual = ~(abs(numbers) > most).any(axis=1)
        if name != "mode":  # that is written when it changes
            usual &= _usual(times)
        self.damaged[name] = int((~usual).sum())
        times, values = times[usual] - (self.origin or 0.0), values[usual]
        if name == "feature":
            values[:, 0] -= self.origin or 0.0
        if not len(times):
            return None
        rising = np.r_[True, times[1:] > np.maximum.accumulate(times)[:-1]]
        return (times[rising], values[rising]) if rising.sum() > 1 else None

    def stand_in(self, name: str, other: str) -> None:
        """Let another quantity stand in for one that is not there.

        Parameters
        ----------
        name, other : str
        """
        if other in self.held:
            self.held.setdefault(name, self.held[other])

    @property
    def short_of_images(self) -> float | None:
        """Until when there are images, s, if there were too many to keep."""
        full = [t for name, t in self.held.items() if name in EACH and t.count > t.most]
        ends = [float(track.rows()[0][-1]) - (self.origin or 0.0) for track in full]
        return min(ends, default=None)


def thinned(stride: int, count: int) -> str:
    """Say that of a long log not all rows are kept.

    Parameters
    ----------
    stride : int
        One row of so many is kept, a bare number.
    count : int
        Rows in the log, a bare number.
    """
    return f"one row in {stride} is looked at, of {count} rows of the log"


def doubles(column: NDArray[Any]) -> Array:
    """Return numbers in double precision, whatever damage made of them.

    Parameters
    ----------
    column : (n,)
        Any unit.
    """
    with np.errstate(invalid="ignore"):  # a number that is none is of one of two kinds
        return column.astype(np.float64)


def _usual(times: Array) -> NDArray[np.bool_]:
    """Tell which times are near the middle one of them and their four neighbours."""
    if len(times) < 3:
        return np.isfinite(times)
    leap = max(LEAP, 5 * float(np.median(abs(np.diff(times)))))
    ends = np.pad(times, 2, mode="reflect")
    middle = np.median(np.stack([ends[i : i + len(times)] for i in range(5)]), axis=0)
    return np.asarray(abs(times - middle) <= leap)


def rotations(q: Array) -> Array:
    """Return rotations, (n, 3, 3), body to world, of quaternions.

    Parameters
    ----------
    q : (n, 4)
        Scalar first, of any length but 0.
    """
    size = np.linalg.norm(q, axis=1, keepdims=True)
    w, x, y, z = (q / np.where(size > 0, size, np.nan)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows).transpose(2, 0, 1)


def _between(times: Array, at: Array, values: Array) -> Array:
    each = [np.interp(times, at, c, left=np.nan, right=np.nan) for c in values.T]
    return np.stack(each, axis=1)


def _turned(times: Array, at: Array, q: Array) -> Array:
    """Return rotations between those of quaternions, whose signs are made alike first."""
    flips = np.cumprod(np.where((q[1:] * q[:-1]).sum(axis=1) < 0, -1.0, 1.0))
    return rotations(_between(times, at, q * np.r_[1.0, flips][:, None]))


def _last(times: Array, at: Array, values: Array) -> Array:
    place = np.searchsorted(at, times, side="right") - 1
    return np.where(place[:, None] >= 0, values[np.maximum(place, 0)], np.nan)


def _held(tracks: Tracks, times: Array) -> dict[str, Any]:
    """Return what there is at the times of the rates; of commands those since the row before."""
    held: dict[str, Any] = {}
    before = np.r_[times[0] - np.median(np.diff(times)), times[:-1]]
    for name in ("specific_force", "position", "velocity"):
        if (found := tracks.rows(name)) is not None:
            held[name] = _between(times, *found)
    if (found := tracks.rows("attitude")) is not None:
        held["rotation"] = _turned(times, *found)
    if (found := tracks.rows("world_velocity")) is not None and "rotation" in held:
        held["velocity"] = np.einsum("nij,ni->nj", held["rotation"], _between(times, *found))
    for name in ("rate_command", "rotor_command"):
        if (found := tracks.rows(name)) is not None:
            held[name] = _last(before, *found)
    for name in ("throttle", "thrust_command"):
        if (found := tracks.rows(name)) is not None:
            held[name] = _last(before, *found)[:, 0]
    if (found := tracks.rows("feature")) is not None:
        seen = _last(before, *found)
        held |= {"feature": seen[:, 1:], "image_age": times - seen[:, 0]}
    if (found := tracks.rows("frames")) is not None:
        held |= {"frames": found[0], "frames_whole": found[1][:, 0] > 0}
    return held


def log_of(
    tracks: Tracks,
    source: str,
    kind: str,
    *,
    rates: str,
    partial: Iterable[str] = (),
    wanted: Mapping[str, str] | None = None,
    active: Mapping[int, str] | None = None,
    notes: tuple[str, ...] = (),
) -> FlightLog:
    """Return a log of what was gathered, at the times of the body rates.

    Parameters
    ----------
    tracks : Tracks
    source, kind : str
    rates : str
        Where the body rates were looked for, in the words of the format.
    partial : iterable of str
        Why it is not whole; empty words count for nothing.
    wanted : mapping, optional
        By quantity, where it was looked for and what it would tell.
    active : mapping, optional
        Names of modes by bare number, in which the law may fly: if it was in any, the log is of
        these times.
    notes : tuple of str

    Raises
    ------
    InputError
        If there are no body rates.
    """
    found = tracks.rows("rate")
    if found is None:
        while_ = "" if tracks.between == EVER else " between these times"
        raise InputError(source, "", f"holds no flight{while_}: no {rates} in it")
    times, rate = found
    notes += tuple(_noted(tracks))
    held = _held(tracks, times)
    left_out = sum(tracks.damaged.values())
    why = [*partial]
    if left_out:
        why.append(f"rows with impossible times or values, left out: {left_out}")
    until = tracks.short_of_images
    if until is not None:
        why.append(f"it has too many images: those after {until:.6g} s are not looked at")
    log = FlightLog(
        source=source,
        kind=kind,
        times=times,
        rate=rate,
        partial="; ".join(filter(None, why)),
        notes=notes,
        lacks=tuple(w for n, w in (wanted or {}).items() if tracks.rows(n) is None),
        ahead=1,
        **held,
    )
    if until is not None:
        log = log.rows(times <= until)
    return _in_mode(log, tracks.rows("mode"), active or {})


def _noted(tracks: Tracks) -> Iterator[str]:
    """Yield what is to be known of the times."""
    if tracks.origin:
        yield f"times are from {tracks.origin:.0f} s on, as the log has them"
    track = tracks.held["rate"]
    if track.stride > 1:
        yield thinned(track.stride, track.count)


def _in_mode(
    log: FlightLog, modes: tuple[Array, Array] | None, active: Mapping[int, str]
) -> FlightLog:
    """Return the part in which the vehicle was in one of some modes, if it ever was."""
    if modes is None or not active:
        return log
    flying = np.isin(_last(log.times, *modes)[:, 0], [*active])
    if flying.sum() > 1:
        return log.rows(flying)
    name = " or ".join(active.values())
    return replace(log, notes=(*log.notes, f"never in {name}: all of it is looked at"))
