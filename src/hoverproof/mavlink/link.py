"""The link to a vehicle, and the clock of a flight: UDP or a serial port, never waited for."""

from __future__ import annotations

import contextlib
import socket
import time
from abc import ABC, abstractmethod
from typing import Any

from hoverproof.errors import InputError, needing

LARGEST = 2048
"""Bytes of a datagram."""

AT_ONCE = 512
"""Pieces that are read at a step, so that a flood does not keep a step from coming."""


class Clock(ABC):
    """A clock that only goes forward."""

    @abstractmethod
    def now(self) -> float:
        """Return the time, s."""

    @abstractmethod
    def wall(self) -> float:
        """Return the time of day, s since 1970."""

    @abstractmethod
    def wait(self, until: float) -> None:
        """Wait until a time, s; at once if it is past.

        Parameters
        ----------
        until : float
            s.
        """


class Link(ABC):
    """A way for bytes to a vehicle and back."""

    @abstractmethod
    def receive(self) -> list[tuple[bytes, Any]]:
        """Return what has come in, each with its sender, without waiting."""

    @abstractmethod
    def send(self, data: bytes, to: Any) -> None:
        """Send without waiting.

        Parameters
        ----------
        data : bytes
        to : object
            A sender, as `receive` names it.
        """

    @abstractmethod
    def close(self) -> None:
        """Let go of it."""


class RealClock(Clock):
    """The clock of this computer."""

    def now(self) -> float:
        """Return the time, s."""
        return time.monotonic()

    def wall(self) -> float:
        """Return the time of day, s since 1970."""
        return time.time()

    def wait(self, until: float) -> None:
        """Sleep until a time, s.

        Parameters
        ----------
        until : float
            s.
        """
        left = until - time.monotonic()
        if left > 0:
            time.sleep(left)


class Udp(Link):
    """Datagrams: listened for at an address, or sent to one first.

    Parameters
    ----------
    place : (str, int)
        Host, and the number of a port.
    listens : bool
        Whether the vehicle sends there; else it is where the vehicle listens.
    """

    def __init__(self, place: tuple[str, int], *, listens: bool) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            if listens:
                self._socket.bind(place)
            else:
                self._socket.connect(place)
        except OSError as error:
            self._socket.close()
            where = f"{place[0]}:{place[1]}"
            raise InputError("--mavlink", where, f"cannot be used: {error.strerror}") from None
        self._listens = listens

    @property
    def port(self) -> int:
        """The number of its own port, bare."""
        return int(self._socket.getsockname()[1])

    def receive(self) -> list[tuple[bytes, Any]]:
        """Return what has come in, each with its sender."""
        found: list[tuple[bytes, Any]] = []
        while len(found) < AT_ONCE:
            try:
                found.append(self._socket.recvfrom(LARGEST))
            except (BlockingIOError, ConnectionRefusedError):
                break
        return found

    def send(self, data: bytes, to: Any) -> None:
        """Send a datagram; one that does not fit into the queue now is lost.

        Parameters
        ----------
        data : bytes
        to : (str, int)
        """
        with contextlib.suppress(BlockingIOError, ConnectionRefusedError):
            if self._listens:
                self._socket.sendto(data, to)
            else:
                self._socket.send(data)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class Serial(Link):
    """A serial port.

    Parameters
    ----------
    device : str
    baud : int
        Bits in a second, a bare number.
    """

    def __init__(self, device: str, baud: int) -> None:
        with needing("mavlink", "--mavlink", "needs pyserial"):
            import serial
        try:
            self._port = serial.Serial(device, baud, timeout=0, write_timeout=0)
        except (OSError, ValueError) as error:
            raise InputError("--mavlink", device, f"cannot be opened: {error}") from None

    def receive(self) -> list[tuple[bytes, Any]]:
        """Return what has come in."""
        data = self._port.read(LARGEST)
        return [(data, None)] if data else []

    def send(self, data: bytes, to: Any) -> None:
        """Write as much as the queue takes.

        Parameters
        ----------
        data : bytes
        to : object
            None.
        """
        self._port.write(data)

    def close(self) -> None:
        """Close the port, and forget what is not sent."""
        with contextlib.suppress(OSError):
            self._port.reset_output_buffer()
        self._port.close()


def link_to(where: str) -> Link:
    """Return the link that an address names.

    Parameters
    ----------
    where : str
        ``udp:HOST:PORT`` to listen on, ``udpout:HOST:PORT`` to send to, or
        ``serial:DEVICE:BAUD``.

    Raises
    ------
    InputError
        If it names none, or that cannot be opened.
    """
    kind, _, rest = where.partition(":")
    if kind in ("udp", "udpin", "udpout"):
        return Udp(address("--mavlink", rest), listens=kind != "udpout")
    if kind == "serial":
        device, _, baud = rest.rpartition(":")
        if device and baud.isascii() and baud.isdigit():
            return Serial(device, int(baud))
    reason = f"must be udp:HOST:PORT, udpout:HOST:PORT or serial:DEVICE:BAUD, not {where!r}"
    raise InputError("--mavlink", "", reason)


def address(option: str, text: str) -> tuple[str, int]:
    """Return host and port of ``HOST:PORT``.

    Parameters
    ----------
    option : str
        That it was given by.
    text : str

    Raises
    ------
    InputError
        If it is none.
    """
    host, _, port = text.rpartition(":")
    if not (host and port.isascii() and port.isdigit() and 0 < int(port) < 65536):
        raise InputError(option, "", f"must name HOST:PORT, a port from 1 to 65535, not {text!r}")
    return host, int(port)
