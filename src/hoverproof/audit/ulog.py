"""Read PX4's logs, .ulg, with pyulog: body axes forward, right, down; world axes z down."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.log import FlightLog
from hoverproof.audit.tracks import EVER, OWN_ORIGIN, Tracks, doubles, log_of
from hoverproof.errors import InputError, in_short, needing

Array = NDArray[np.float64]

XYZ = ("xyz[0]", "xyz[1]", "xyz[2]")
TOPICS: dict[str, dict[str, tuple[str, ...]]] = {
    "vehicle_angular_velocity": {"rate": XYZ},
    "vehicle_acceleration": {"specific_force": XYZ},
    "vehicle_attitude": {"attitude": ("q[0]", "q[1]", "q[2]", "q[3]")},
    "vehicle_local_position": {"world_velocity": ("vx", "vy", "vz")},
    "vehicle_rates_setpoint": {
        "rate_command": ("roll", "pitch", "yaw"),
        "throttle": ("thrust_body[2]",),
    },
    "landing_target_pose": {"frames": ("rel_pos_valid",)},
    "vehicle_status": {"mode": ("nav_state",)},
    "sensor_combined": {
        "older rate": ("gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"),
        "older force": ("accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"),
    },
}
OLDER = {"rate": "older rate", "specific_force": "older force"}
"""What stands in where a quantity is not there, of releases that did not log it."""
WANTED = {
    "specific_force": "vehicle_acceleration: wind, gusts",
    "attitude": "vehicle_attitude: wind",
    "world_velocity": "vehicle_local_position: velocity",
    "rate_command": "vehicle_rates_setpoint: rate loop",
    "frames": "landing_target_pose: images, whether the target was seen",
}
OFFBOARD = {14: "OFFBOARD"}
HEADER, MESSAGE_HEADER = 16, 3
FLAGS, ADDED, DATA = b"BAD"
DEFINITIONS, KNOWN = b"BFIMPQ", b"ABCDFILMOPQRS"
FLAGS_LENGTH = 40
SYNC = b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"
PIECE = 8 << 20
"""So many bytes of what is wanted are given to pyulog at once."""


def read(path: Path, between: tuple[float, float] = EVER) -> FlightLog:
    """Read a .ulg file.

    Parameters
    ----------
    path : Path
    between : (2,)
        s: what is not is left out.

    Raises
    ------
    InputError
        If pyulog is not there, or nothing of a flight can be read.
    """
    with needing("logs", str(path), "needs pyulog to be read"):
        from pyulog import ULog
    tracks, damaged = Tracks(between), False
    with path.open("rb") as file:
        pieces = Pieces(file, path.stat().st_size)
        for piece in pieces:
            try:
                with contextlib.redirect_stdout(io.StringIO()):  # it prints what is damaged
                    read = ULog(io.BytesIO(piece), [*TOPICS])
            except Exception as error:  # pyulog raises what struct, numpy and its own parser do
                raise InputError(str(path), "", f"is damaged: {in_short(error)}") from None
            damaged |= read.file_corruption
            for topic in read.data_list:
                _add(tracks, topic.name, topic.data)
    for name, older in OLDER.items():
        tracks.stand_in(name, older)
    partial = ["parts of it are damaged" if damaged or pieces.damaged else "", pieces.cut]
    return log_of(
        tracks,
        str(path),
        "PX4 log",
        rates="vehicle_angular_velocity",
        partial=partial,
        wanted=WANTED,
        active=OFFBOARD,
        notes=(OWN_ORIGIN,),
    )


def _add(tracks: Tracks, topic: str, data: dict[str, Any]) -> None:
    """Add what a topic tells, if it has the fields."""
    for name, fields in TOPICS[topic].items():
        if {"timestamp", *fields} <= data.keys():
            values = np.stack([doubles(data[key]) for key in fields], axis=1)
            times = doubles(data["timestamp"]) / 1e6
            tracks.add(name, times, -values if name == "throttle" else values)


class Pieces:
    """A .ulg file in pieces that are such files themselves, of the topics that are wanted.

    Parameters
    ----------
    file : binary file
    size : int
        Bytes, a bare number.
    """

    def __init__(self, file: BinaryIO, size: int) -> None:
        self.file, self.size = file, size
        self.damaged, self.cut = False, ""
        self._ids: set[bytes] = set()

    def __iter__(self) -> Iterator[bytes]:
        """Yield pieces."""
        head, added, piece = bytearray(self.file.read(HEADER)), bytearray(), bytearray()
        begins, ends = self._parts()
        for begin, end in zip(begins, ends, strict=True):
            for kind, message in self._messages(begin, end):
                if kind in DEFINITIONS and not added:
                    head += _alone(message) if kind == FLAGS else message
                elif kind == ADDED and self._is_wanted(message):
                    added += message
                elif kind == DATA and message[3:5] in self._ids:
                    piece += message
                if len(piece) >= PIECE:
                    yield bytes(head + added + piece)
                    piece.clear()
        yield bytes(head + added + piece)

    def _parts(self) -> tuple[list[int], list[int]]:
        """Return where what was written at once begins and ends: more may have been appended."""
        self.file.seek(HEADER)
        first = self.file.read(MESSAGE_HEADER + FLAGS_LENGTH)
        places: list[int] = []
        if first[2:3] == bytes([FLAGS]) and first[11:12] and first[11] & 1:
            places = [int.from_bytes(first[at : at + 8], "little") for at in (19, 27, 35)]
        appended = sorted({p for p in places if HEADER < p < self.size})
        return [HEADER, *appended], [*appended, self.size]

    def _messages(self, at: int, end: int) -> Iterator[tuple[int, bytes]]:
        """Yield kinds and messages that are whole."""
        self.file.seek(at)
        while at + MESSAGE_HEADER <= end:
            header = self.file.read(MESSAGE_HEADER)
            length = MESSAGE_HEADER + int.from_bytes(header[:2], "little")
            if header[2] not in KNOWN or length == MESSAGE_HEADER:
                self.damaged = True
                at = self._after_next_sync(at + 1, end)
                continue
            if at + length > end:
                break
            yield header[2], header + self.file.read(length - MESSAGE_HEADER)
            at += length
        if end == self.size and at != end:
            self.cut = "it is cut short within a message"

    def _after_next_sync(self, at: int, end: int) -> int:
        """Return where messages go on behind a mark for that, and go there; else the end."""
        while at < end:
            self.file.seek(at)
            part = self.file.read(PIECE)
            if (found := part.find(SYNC)) >= 0:
                at += found + len(SYNC)
                self.file.seek(at)
                return at
            at += max(len(part) - len(SYNC) + 1, 1)
        return end

    def _is_wanted(self, message: bytes) -> bool:
        """Tell whether what is to follow is of a topic that is wanted, and remember its number."""
        wanted = message[3] == 0 and message[6:].decode(errors="replace") in TOPICS
        if wanted:
            self._ids.add(message[4:6])
        return wanted


def _alone(flags: bytes) -> bytes:
    """Return a message of flags that tells of nothing appended."""
    return flags[:11] + bytes([flags[11] & ~1]) + flags[12:19] + bytes(24) + flags[43:]
