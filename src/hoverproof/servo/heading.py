"""How a law may know where the vehicle heads: an interface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca


@dataclass(frozen=True)
class Heading:
    """How a law knows where the vehicle heads, and what it does about it.

    Attributes
    ----------
    name : str
    measurement : callable
        The layout of what a law measures ↦ that layout with `heading`, (cos ψ, sin ψ), behind.
    seen : callable
        (R (3, 3), ρ (3, 1), image directions (3, n), target points (3, n) in m) ↦ (cos ψ, sin ψ),
        (2, 1), ψ the yaw in R = Rz(ψ) Ry Rx.
    turning : callable
        (Measurement, Design) ↦ what it adds to Ω̇3, (1, 1), rad/s².
    rate : callable
        Measurement ↦ the time derivative of `heading`, (2, 1), 1/s.
    of_image : bool
        Whether `seen` is made of the image and ρ alone: as the heading of `camera.north`, which
        frames then tell.
    """

    name: str
    measurement: Callable[[Any], Any]
    seen: Callable[[ca.SX, ca.SX, ca.SX, ca.SX], ca.SX]
    turning: Callable[[Any, Any], ca.SX]
    rate: Callable[[Any], ca.SX]
    of_image: bool = False
