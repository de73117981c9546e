"""Where sightings of the target come from: lines of JSON, by a pipe or by UDP, or a camera.

A source is anything with `newest`, which is asked at each step and never waited for.
"""

from __future__ import annotations

import json
import math
import os
import socket
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.mavlink.link import address

Array = NDArray[np.float64]

LONGEST_LINE = 65536
"""Bytes of a line, and of a datagram."""


@dataclass(frozen=True)
class Sighting:
    """The target in an image.

    Attributes
    ----------
    at : float
        Middle of the exposure, by the clock of the flight, s.
    seen : (n, 2)
        Points in the order of the target: pixels through the mission's lens, else (X/Z, Y/Z).
    in_pixels : bool
    """

    at: float
    seen: Array
    in_pixels: bool = False


class Sight(ABC):
    """A source of sightings.

    Attributes
    ----------
    remark : str
        What is wrong with it, in words; empty if nothing is.
    """

    remark: str = ""

    @abstractmethod
    def newest(self, now: float) -> list[Sighting]:
        """Return what has come in since it was asked last, oldest first, without waiting.

        Parameters
        ----------
        now : float
            By the clock of the flight, s.
        """

    @abstractmethod
    def close(self) -> None:
        """Let go of what it holds."""


class Lines(Sight):
    """Sightings as lines of JSON, of bytes that come in as they do.

    A line is an object with ``"age"`` (s from the exposure to when it was written) or ``"time"``
    (of the exposure, s since 1970 by this computer's clock), and ``"image"`` ([[x, y], ...], focal
    length 1, undistorted) or ``"pixels"`` ([[u, v], ...], through the mission's lens). A line
    without points says that the target was not seen.

    Parameters
    ----------
    source : callable
        () ↦ pieces of bytes that have come in, none of them waited for.
    points : int
        Number of target points.
    close : callable
    wall : callable
        The time of day, s since 1970.
    """

    def __init__(
        self,
        source: Callable[[], Iterable[bytes]],
        points: int,
        close: Callable[[], None],
        wall: Callable[[], float],
    ) -> None:
        self._source, self._points, self._wall = source, points, wall
        self._close = close
        self._rest = b""

    def newest(self, now: float) -> list[Sighting]:
        """Return what has come in; what is no sighting becomes the remark.

        Parameters
        ----------
        now : float
            By the clock of the flight, s.
        """
        found: list[Sighting] = []
        for piece in self._source():
            self._rest += piece
        *lines, self._rest = self._rest.split(b"\n")
        if len(self._rest) > LONGEST_LINE:
            self._rest, self.remark = b"", "a line of the features has no end"
        for line in lines:
            if line.strip():
                self._take(line, now, found)
        return sorted(found, key=lambda sighting: sighting.at)

    def close(self) -> None:
        """Let go of what they come by."""
        self._close()

    def _take(self, line: bytes, now: float, found: list[Sighting]) -> None:
        try:
            seen = sighting_of(json.loads(line), self._points, now, self._wall())
        except (ValueError, RecursionError) as error:
            why = str(error) if isinstance(error, InputError) else "is no JSON"
            self.remark = f"a line of the features {why}"
            return
        self.remark = ""
        if seen is not None:
            found.append(seen)


def sighting_of(told: Any, points: int, now: float, wall: float) -> Sighting | None:
    """Return the sighting of an object of a line, None if the target was not seen.

    Parameters
    ----------
    told : object
        See `Lines`.
    points : int
        Number of target points.
    now, wall : float
        The clock of the flight and the time of day, s.

    Raises
    ------
    InputError
        If it is none.
    """
    if not isinstance(told, Mapping):
        raise InputError("", "", "is no JSON object")
    kind = "pixels" if "pixels" in told else "image"
    if not told.get(kind):
        return None
    if not any(_is_time(told.get(key)) for key in ("age", "time")):
        raise InputError("", "", 'has neither "age" nor "time" in s')
    age = told["age"] if _is_time(told.get("age")) else wall - told["time"]
    try:
        seen = np.array(told[kind], float)
    except (TypeError, ValueError):
        seen = np.empty(0)
    if seen.shape != (points, 2) or not np.isfinite(seen).all():
        raise InputError("", "", f'needs "{kind}" of {points} pairs of numbers')
    return Sighting(now - age, seen, kind == "pixels")


def _is_time(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def lines_from(where: str, points: int, wall: Callable[[], float]) -> Lines:
    """Return the sightings that come in by standard input or by UDP.

    Parameters
    ----------
    where : str
        ``"stdin"`` or ``"udp:HOST:PORT"``, to listen on.
    points : int
        Number of target points.
    wall : callable
        The time of day, s since 1970.

    Raises
    ------
    InputError
        If it is neither, or the port cannot be listened on.
    """
    if where == "stdin":
        return Lines(_from_stdin, points, lambda: None, wall)
    if not where.startswith("udp:"):
        raise InputError("--features", "", f"must be stdin or udp:HOST:PORT, not {where!r}")
    heard = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    heard.setblocking(False)
    try:
        heard.bind(address("--features", where.removeprefix("udp:")))
    except OSError as error:
        heard.close()
        raise InputError("--features", where, f"cannot be listened on: {error.strerror}") from None

    def datagrams() -> Iterable[bytes]:
        for _ in range(64):
            try:
                yield heard.recv(LONGEST_LINE).rstrip(b"\n") + b"\n"
            except BlockingIOError:
                return

    return Lines(datagrams, points, heard.close, wall)


def _from_stdin() -> Iterable[bytes]:
    import select

    for _ in range(64):
        if not select.select([sys.stdin], [], [], 0)[0]:
            return
        piece = os.read(sys.stdin.fileno(), LONGEST_LINE)
        if not piece:
            return
        yield piece
