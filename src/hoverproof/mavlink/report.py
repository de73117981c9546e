"""How a flight over MAVLink stands, for who looks on."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Report:
    """How a flight stands.

    Attributes
    ----------
    time : float
        Since its begin, s.
    phase : str
        ``"waiting"``, ``"ready"``, ``"flying"`` or ``"over"``.
    why : str
        What it waits for, or why it is over, in words.
    autopilot, mode : str
        That of the vehicle, and the mode that takes setpoints; empty before it is heard.
    armed, in_mode : bool
    image_age : float or None
        s.
    error : float or None
        Of the image, dimensionless.
    metres : float or None
        About what that is, m, if the feature tells.
    rates : tuple of float or None
        That are sent, rad/s.
    throttle, hover_throttle : float or None
        That is sent, and that hovers: numbers from 0 to 1.
    watched : tuple of str
        What the monitor of the package says that ends no flight.
    sent : int
        Setpoints so far: a bare number.
    """

    time: float
    phase: str
    why: str
    autopilot: str = ""
    mode: str = ""
    armed: bool = False
    in_mode: bool = False
    image_age: float | None = None
    error: float | None = None
    metres: float | None = None
    rates: tuple[float, ...] | None = None
    throttle: float | None = None
    hover_throttle: float | None = None
    watched: tuple[str, ...] = ()
    sent: int = 0
