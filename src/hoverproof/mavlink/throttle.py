"""Thrust in newtons as a throttle from 0 to 1, by what hovers the vehicle.

The throttle of hover is given, or learned while another mode flies: the autopilot tells what
throttle it asks for, the accelerometer what thrust that gives. It is kept while the law flies, and
is good to what the battery loses meanwhile: a law that measures its force makes that up.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field

LEARNED_FROM = 2.0
"""s that are looked at."""

FEWEST = 15
"""Numbers that are looked at, at least."""

PLAUSIBLE = (0.05, 0.9)
"""The throttle that a vehicle may hover at."""


@dataclass
class HoverThrottle:
    """The throttle that hovers a vehicle.

    Attributes
    ----------
    gravity : float
        m/s².
    given : float or None
        A number from 0 to 1; learned if there is none.
    """

    gravity: float
    given: float | None = None
    _heard: deque[tuple[float, float, float]] = field(default_factory=deque)

    def take(self, at: float, throttle: float, felt: float) -> None:
        """Learn from a moment of a flight in another mode.

        Parameters
        ----------
        at : float
            s.
        throttle : float
            That the autopilot asks for, a number from 0 to 1.
        felt : float
            Thrust over mass that the accelerometer feels, m/s².
        """
        self._heard.append((at, throttle, felt))
        while self._heard and self._heard[0][0] < at - LEARNED_FROM:
            self._heard.popleft()

    @property
    def steady(self) -> tuple[float, float] | None:
        """Thrust over mass, m/s², and the throttle that gives it, 0 to 1; None if not known."""
        if self.given is not None:
            return self.gravity, self.given
        heard = self._heard
        if len(heard) < FEWEST or heard[-1][0] - heard[0][0] < LEARNED_FROM / 2:
            return None
        throttle, felt = (math.fsum(row[k] for row in heard) / len(heard) for k in (1, 2))
        within = felt > 0 and PLAUSIBLE[0] <= throttle / felt * self.gravity <= PLAUSIBLE[1]
        return (felt, throttle) if within else None

    @property
    def value(self) -> float | None:
        """The throttle of hover, 0 to 1; None if it is not known."""
        steady = self.steady
        return None if steady is None else steady[1] / steady[0] * self.gravity
