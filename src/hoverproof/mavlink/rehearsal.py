"""A flight over MAVLink without a vehicle: bytes both ways, and time that need not pass."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hoverproof.mavlink.link import Clock, Link
from hoverproof.mavlink.sight import Sight, Sighting
from hoverproof.mavlink.stand_in import STEP, TAKES, Habits, StandIn

UNIX = 1.7e9
"""s since 1970, at the begin."""


@dataclass
class Wire:
    """One way of a link: what is put in comes out later, or never, or after what came behind it.

    Attributes
    ----------
    habits : Habits
    seed : int
        A bare number.
    """

    habits: Habits
    seed: int
    _queue: list[tuple[float, int, bytes]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._draw, self._count = np.random.default_rng(self.seed), itertools.count()

    def put(self, data: bytes, now: float) -> None:
        """Send.

        Parameters
        ----------
        data : bytes
        now : float
            s.
        """
        late, lost = self._draw.random(2)
        if lost >= self.habits.lost:
            due = now + self.habits.delay + self.habits.jitter * late
            heapq.heappush(self._queue, (due, next(self._count), data))

    def due(self, now: float) -> Iterator[bytes]:
        """Yield what has arrived.

        Parameters
        ----------
        now : float
            s.
        """
        while self._queue and self._queue[0][0] <= now:
            yield heapq.heappop(self._queue)[2]


@dataclass
class Rehearsal(Clock, Link, Sight):
    """A vehicle that is not there, with its link, its camera and its clock.

    It is clock, link and sight at once: whoever waits lets it fly on.

    Attributes
    ----------
    vehicle : StandIn
    pilot : callable
        Called with the vehicle at each of its steps.
    blind : bool
        Whether no images come any more.
    remark : str
        See `Sight`.
    sent : list of float
        When something was sent to the vehicle, s.
    closed : bool
        Whether the flight has let go.
    """

    vehicle: StandIn
    pilot: Callable[[StandIn], None]
    blind: bool = False
    remark: str = ""
    sent: list[float] = field(default_factory=list)
    closed: bool = False
    _images: list[tuple[float, int, Sighting]] = field(default_factory=list)

    def __post_init__(self) -> None:
        habits, seed = self.vehicle.habits, self.vehicle.seed
        self._up, self._down = Wire(habits, 2 * seed + 1), Wire(habits, 2 * seed + 2)
        self._latency = float(self.vehicle.mission.sensors.latency)
        self._count, self._steps = itertools.count(), 0

    def now(self) -> float:
        """Return the time, s."""
        return self._steps * STEP

    def wall(self) -> float:
        """Return the time of day, s since 1970."""
        return UNIX + self.now()

    def wait(self, until: float) -> None:
        """Let the vehicle fly until a time, s.

        Parameters
        ----------
        until : float
            s.
        """
        while self.now() < until - STEP / 2:
            self._fly()

    def _fly(self) -> None:
        now, vehicle = self.now(), self.vehicle
        for data in self._up.due(now):
            vehicle.hear(data)
        self.pilot(vehicle)
        vehicle.step()
        self._steps += 1
        for data in vehicle.tell():
            self._down.put(data, now)
        sighting = vehicle.photograph(self.now())
        if sighting is not None and not self.blind:
            arrival = self.now() + self._latency
            heapq.heappush(self._images, (arrival, next(self._count), sighting))

    def receive(self) -> list[tuple[bytes, Any]]:
        """Return what the vehicle told, and has arrived."""
        return [(data, None) for data in self._down.due(self.now())]

    def send(self, data: bytes, to: Any) -> None:
        """Send to the vehicle.

        Parameters
        ----------
        data : bytes
        to : object
        """
        self.sent.append(self.now())
        self._up.put(data, self.now())

    def newest(self, now: float) -> list[Sighting]:
        """Return the images that have arrived.

        Parameters
        ----------
        now : float
            s.
        """
        found = []
        while self._images and self._images[0][0] <= now:
            found.append(heapq.heappop(self._images)[2])
        return found

    def close(self) -> None:
        """Note that the flight has let go."""
        self.closed = True


def patient_pilot(ready: Callable[[], bool], after: float = 1.5) -> Callable[[StandIn], None]:
    """Return a pilot who enters the mode that takes setpoints once, a while after it may be.

    Parameters
    ----------
    ready : callable
        () ↦ whether the flight is ready.
    after : float
        s.
    """
    since: list[float] = []
    done: list[bool] = []

    def pilot(vehicle: StandIn) -> None:
        if done:
            return
        if not ready():
            since.clear()
        elif not since:
            since.append(vehicle.time)
        elif vehicle.time - since[0] >= after and vehicle.enter(TAKES):
            done.append(True)

    return pilot
