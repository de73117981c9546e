"""Sets of states in which a controller may be switched on."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

from hoverproof import checker
from hoverproof.algebra.decimals import decimal_above
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.certification.region import Box
from hoverproof.errors import InputError
from hoverproof.mission import Mission

ZERO = Fraction(0)


@dataclass(frozen=True)
class Start:
    """All states in these bounds, with any heading and any yaw rate.

    Attributes
    ----------
    position : (3,) of (low, high)
        World frame, m.
    speed : Fraction
        Bound of |V|, m/s.
    tilt : Fraction
        Bound of the angle between body and world vertical, rad.
    rate : Fraction
        Bound of the roll and pitch rates together, √(Ω1² + Ω2²), rad/s.
    thrust : Fraction
        Bound of |T - m g|, N.
    """

    position: Box
    speed: Fraction = ZERO
    tilt: Fraction = ZERO
    rate: Fraction = ZERO
    thrust: Fraction = ZERO

    def __post_init__(self) -> None:
        if any(a > b for a, b in self.position):
            raise InputError("start", "position", "has an end below its beginning")
        for name in ("speed", "tilt", "rate", "thrust"):
            if getattr(self, name) < 0:
                raise InputError("start", name, f"must not be negative, not {getattr(self, name)}")

    @classmethod
    def hover(cls, x: Fraction, y: Fraction, z: Fraction) -> Start:
        """Return the level hovers at one position, world frame, m.

        Parameters
        ----------
        x, y, z : Fraction
            World frame, m.
        """
        return cls(((x, x), (y, y), (z, z)))

    @classmethod
    def of(cls, mission: Mission) -> Start:
        """Return the start of a mission; its attitude may be turned about the vertical.

        Parameters
        ----------
        mission : Mission
        """
        start = mission.start
        roll, pitch, _ = start.rotation
        return cls(
            position=tuple((c, c) for c in start.position),
            speed=_length(*start.velocity),
            tilt=abs(roll) + abs(pitch),
            rate=_length(*start.rates[:2]),
        )

    def content(self) -> dict[str, Any]:
        """Return what a certificate holds of it."""
        return asdict(self)

    def for_checker(self) -> checker.Start:
        """Return it as the checker has it."""
        box = [list(side) for side in self.position]
        return checker.Start(box, None, self.speed, self.tilt, self.rate, self.thrust)


def _length(*parts: Fraction) -> Fraction:
    square = sum((x * x for x in parts), ZERO)
    return decimal_above(sqrt_enclosure(square)[1], 6) if square else ZERO
