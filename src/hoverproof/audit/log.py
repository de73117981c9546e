"""What an audit needs of a log, whatever wrote it."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_ROWS = 400_000
"""Of a longer log every so many rows are kept."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FlightLog:
    """A log as arrays over time; None where the log has no such thing, NaN where it has a gap.

    Attributes
    ----------
    source, kind : str
        The file, and what wrote it, in words.
    partial : str
        Why it is not whole; empty if it is.
    times : (n,)
        s, rising.
    position, velocity : (n, 3)
        World frame, z down, m; body frame, m/s: as estimated.
    rotation : (n, 3, 3)
        Body to world.
    rate, specific_force : (n, 3)
        Body frame, rad/s and m/s².
    thrust_command : (n,)
        N.
    rotor_command : (n, r)
        What each rotor is asked for, N.
    rate_command : (n, 3)
        Body frame, rad/s, of an autopilot that is given rates.
    throttle : (n,)
        Share of the full thrust that is asked for, 0 to 1.
    feature : (n, 3)
        That the law used, body frame.
    image_age : (n,)
        s, since the exposure of the image in use.
    status : (n,)
        Of the firmware, where that flew.
    frames : (m,)
        Exposures of the images, s.
    frames_whole : (m,) bool
        Whether all of the target was found in each.
    step : float
        From one step of the integrator to the next, s; NaN if not told.
    ahead : int
        How many rows before a command, and the feature that it was made with, stands all else that
        it was made of, a bare number.
    continuous : bool
        Whether commands are those at each time, and not held from one row to the next.
    outcome : str
        How the flight ended, if it is told.
    mission : mapping, optional
        Exact numbers of the mission that the log holds.
    notes : tuple of str
        What was taken for something else.
    lacks : tuple of str
        What was looked for and is not in it, in the words of its format, and what it would tell.
    """

    source: str
    kind: str
    times: Array
    partial: str = ""
    position: Array | None = None
    velocity: Array | None = None
    rotation: Array | None = None
    rate: Array | None = None
    specific_force: Array | None = None
    thrust_command: Array | None = None
    rotor_command: Array | None = None
    rate_command: Array | None = None
    throttle: Array | None = None
    feature: Array | None = None
    image_age: Array | None = None
    status: Array | None = None
    frames: Array | None = None
    frames_whole: NDArray[np.bool_] | None = None
    step: float = float("nan")
    ahead: int = 0
    continuous: bool = False
    outcome: str = ""
    mission: dict[str, Any] | None = None
    notes: tuple[str, ...] = field(default=())
    lacks: tuple[str, ...] = field(default=())

    def has(self, *names: str) -> bool:
        """Tell whether there is a number of each of these.

        Parameters
        ----------
        *names : str
        """
        held = (getattr(self, name) for name in names)
        return all(value is not None and bool(np.isfinite(value).any()) for value in held)

    def rows(self, kept: NDArray[np.bool_]) -> FlightLog:
        """Return the part in which a condition holds.

        Parameters
        ----------
        kept : (n,) bool
        """
        cut: dict[str, Any] = {}
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, np.ndarray) and not each.name.startswith("frames"):
                cut[each.name] = value[kept]
        return replace(self, **cut)
