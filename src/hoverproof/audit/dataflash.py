"""Read ArduPilot's logs, .bin: body axes forward, right, down; world axes north, east, down."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.log import FlightLog
from hoverproof.audit.tracks import EVER, OWN_ORIGIN, Tracks, doubles, log_of
from hoverproof.errors import InputError, needing

Array = NDArray[np.float64]
Rows = dict[str, Array]

MAGIC = b"\xa3\x95"
FMT, FMT_LENGTH = 0x80, 89
PIECE = 8 << 20
GUIDED = {4: "GUIDED", 20: "GUIDED_NOGPS"}
"""Modes of ArduCopter in which a companion computer flies."""
WANTED = {
    "specific_force": "IMU.AccX to AccZ (LOG_BITMASK, IMU_FAST): wind, gusts",
    "attitude": "ATT (LOG_BITMASK, ATTITUDE_FAST): wind",
    "world_velocity": "XKF1.VN to VD (LOG_BITMASK, ATTITUDE_FAST): velocity",
    "rate_command": "RATE.RDes to YDes (LOG_BITMASK, ATTITUDE_FAST): rate loop",
    "frames": "PL.LastMeasMS (precision landing): images, whether the target was seen",
}
COLUMNS = {
    "IMU": ("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"),
    "ATT": ("Roll", "Pitch", "Yaw"),
    "RATE": ("RDes", "PDes", "YDes"),
    "XKF1": ("VN", "VE", "VD"),
    "PL": ("LastMeasMS",),
    "MODE": ("ModeNum",),
}
INSTANCES = ("I", "C")


@dataclass
class Format:
    """How one kind of message is laid out.

    Attributes
    ----------
    name : str
    length : int
        Bytes with its header of three, a bare number.
    layout : dtype
    factors : dict of float
        What the numbers of a column are times what is stored.
    waiting : bytearray
        Bodies not yet looked at.
    """

    name: str
    length: int
    layout: np.dtype[Any]
    factors: dict[str, float]
    waiting: bytearray = field(default_factory=bytearray)

    def take(self) -> Rows:
        """Return the columns of what was waiting, of the first instance, and forget it."""
        rows = np.frombuffer(bytes(self.waiting), self.layout)
        self.waiting.clear()
        for column in INSTANCES:
            if column in (self.layout.names or ()):
                rows = rows[rows[column] == 0]
        wanted = ("TimeUS", *COLUMNS[self.name], "AOut")
        return {
            c: doubles(rows[c]) * self.factors[c] for c in wanted if c in (self.layout.names or ())
        }


def read(path: Path, between: tuple[float, float] = EVER) -> FlightLog:
    """Read a .bin file.

    Parameters
    ----------
    path : Path
    between : (2,)
        s: what is not is left out.

    Raises
    ------
    InputError
        If pymavlink is not there, or nothing of a flight can be read.
    """
    with needing("logs", str(path), "needs pymavlink to be read"):
        from pymavlink import DFReader
    messages = Messages(DFReader.DFFormat, DFReader.FORMAT_TO_STRUCT)
    tracks = Tracks(between)
    for form in messages.read(path):
        rows = form.take()
        if {"TimeUS", *COLUMNS[form.name]} <= rows.keys():
            _add(tracks, form.name, rows)
    if not messages.formats:
        raise InputError(str(path), "", "is damaged: it holds the layout of no message")
    return log_of(
        tracks,
        str(path),
        "ArduPilot log",
        rates="IMU (LOG_BITMASK, IMU_FAST)",
        partial=messages.partial,
        wanted=WANTED,
        active=GUIDED,
        notes=(OWN_ORIGIN,),
    )


class Messages:
    """What is in the file, by kind of message.

    Parameters
    ----------
    format_of : callable
        That makes sense of a message FMT, of pymavlink.
    letters : dict
        What a letter of a layout is for `struct`, of pymavlink.
    """

    def __init__(self, format_of: Callable[..., Any], letters: dict[str, Any]) -> None:
        self.format_of, self.letters = format_of, letters
        self.lengths = {FMT: FMT_LENGTH}
        self.formats: dict[int, Format] = {}
        self.partial: list[str] = []
        self._skipped = self._blank = 0

    def read(self, path: Path) -> Iterator[Format]:
        """Yield kinds of message that are wanted, each time with some that wait.

        Parameters
        ----------
        path : Path
        """
        rest = b""
        with path.open("rb") as file:
            while piece := file.read(PIECE):
                data = rest + piece
                rest = data[self._walk(data) :]
                yield from self._waiting()
        if rest.strip(b"\x00\xff"):
            self.partial.append("it is cut short within a message")
        if self._skipped:
            self.partial.append(f"parts of it are damaged: {self._skipped} bytes are skipped")

    def _waiting(self) -> Iterator[Format]:
        yield from (form for form in self.formats.values() if form.waiting)

    def _walk(self, data: bytes) -> int:
        """Go through messages that are whole; return where the first is that is not."""
        at, size, lengths = 0, len(data), self.lengths
        while at + 3 <= size:
            kind = data[at + 2]
            length = lengths.get(kind, 0)
            if not length or not data.startswith(MAGIC, at):
                found = self._next(data, at + 1)
                self._blank += found - at  # which is no damage if nothing follows
                if data[at:found].strip(b"\x00\xff"):
                    self._skipped, self._blank = self._skipped + self._blank, 0
                at = found
                continue
            if at + length > size:
                return at
            if self._blank:
                self._skipped, self._blank = self._skipped + self._blank, 0
            if kind == FMT:
                self._learn(data[at + 3 : at + length])
            elif (form := self.formats.get(kind)) is not None:
                form.waiting += data[at + 3 : at + length]
            at += length
        return at

    def _next(self, data: bytes, at: int) -> int:
        """Return where the next message begins that another follows, or may."""
        while (at := data.find(MAGIC, at)) >= 0:
            length = self.lengths.get(data[at + 2], 0) if at + 2 < len(data) else 3
            if length and data[at + length : at + length + 2] in (MAGIC, MAGIC[:1], b""):
                return at
            at += 1
        return len(data) - (data[-1:] == MAGIC[:1])

    def _learn(self, body: bytes) -> None:
        """Take a message FMT: type, length, name, letters, columns."""
        kind, length = body[0], body[1]
        name, letters, columns = body[2:6], body[6:22], body[22:86]
        if kind in self.lengths or length < 4:
            return
        self.lengths[kind] = length
        try:
            with contextlib.redirect_stdout(io.StringIO()):  # it prints what it does not know
                form = self.format_of(
                    kind,
                    name,
                    length,
                    letters.rstrip(b"\0").decode(),
                    columns.decode().rstrip("\0"),
                )
            parts = [_numpy(self.letters[c][0]) for c in form.msg_fmts]
            layout = np.dtype(list(zip(form.columns, parts, strict=True)))
        except Exception:  # DFFormat raises Exception itself
            self._skipped += len(body)
            return
        if form.name not in COLUMNS or layout.itemsize != length - 3:
            return
        factors = {c: m or 1.0 for c, m in zip(form.columns, form.msg_mults, strict=True)}
        self.formats[kind] = Format(form.name, length, layout, factors)


def _numpy(part: str) -> str:
    """Return what numpy calls a part of a layout for `struct`."""
    return f"S{part[:-1]}" if part.endswith("s") else f"<{part}"


def _add(tracks: Tracks, name: str, rows: Rows) -> None:
    """Add what messages of one kind tell."""
    times = rows["TimeUS"] / 1e6
    values = np.column_stack([rows[c] for c in COLUMNS[name]])
    if name == "IMU":
        tracks.add("rate", times, values[:, :3])
        tracks.add("specific_force", times, values[:, 3:])
    elif name == "ATT":
        tracks.add("attitude", times, _quaternions(np.radians(values)))
    elif name == "RATE":
        tracks.add("rate_command", times, np.radians(values))
        if "AOut" in rows:
            tracks.add("throttle", times, rows["AOut"][:, None])
    elif name == "XKF1":
        tracks.add("world_velocity", times, values)
    elif name == "PL":
        seen, first = np.unique(values[:, 0], return_index=True)
        first = first[seen > 0]
        tracks.add("frames", values[first, 0] / 1e3, np.ones((len(first), 1)))
    else:
        tracks.add("mode", times, values)


def _quaternions(angles: Array) -> Array:
    """Return quaternions, (n, 4), scalar first, of roll, pitch and yaw, (n, 3), rad."""
    cos, sin = np.cos(angles / 2).T, np.sin(angles / 2).T
    (cr, cp, cy), (sr, sp, sy) = cos, sin
    parts = [
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ]
    return np.stack(parts, axis=1)
