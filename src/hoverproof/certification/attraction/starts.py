"""Sets of states in which a controller may be switched on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from mpmath.ctx_iv import MPIntervalContext
from mpmath.libmp import to_rational
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.certification.region import Box, holds_target_point
from hoverproof.errors import InputError
from hoverproof.mission.exact import exact
from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import rotation_rows

Interval = tuple[Fraction, Fraction]
MOST_STARTS = 16
BITS = 256
GRID = 1 << 204
"""Enclosures end at multiples of 1/GRID."""
TURNING_GRID = 1 << 188
"""Coarser for the derivative of the axis, so that the checker sees that one is across the axis."""
ZERO = Fraction(0)
SIZES = "speed", "tilt", "rate", "thrust"


@dataclass(frozen=True)
class Start:
    """All states in these bounds, with any heading and any yaw rate.

    Numbers may be given as any that `hoverproof.mission.exact.exact` takes.

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
        try:
            position = tuple((exact(low), exact(high)) for low, high in self.position)
            sizes = {name: exact(getattr(self, name)) for name in SIZES}
        except (TypeError, ValueError):
            reason = f"must be numbers, its position three sides (low, high), not {self!r:.160}"
            raise InputError("start", "", reason) from None
        if len(position) != 3 or any(a > b for a, b in position):
            raise InputError("start", "position", "must have three sides, from low to high each")
        for name, value in sizes.items():
            if value < 0:
                raise InputError("start", name, f"must not be negative, not {value}")
            object.__setattr__(self, name, value)
        object.__setattr__(self, "position", position)

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


def require_starts(mission: Mission, starts: Sequence[Start]) -> None:
    """Refuse starts that no certificate holds.

    Parameters
    ----------
    mission : Mission
    starts : sequence of Start

    Raises
    ------
    InputError
        If there are too many, or one holds a target point.
    """
    if len(starts) > MOST_STARTS:
        raise InputError("--start", "", f"at most {MOST_STARTS} starts go into one certificate")
    if any(holds_target_point(mission, start.position) for start in starts):
        raise InputError(mission.source, "--start", "holds a target point")


@dataclass(frozen=True)
class State:
    """A state, or a box of states, without yaw rate; world axes; each number is (low, high).

    Attributes
    ----------
    position, velocity : (3,) of (low, high)
        m, m/s.
    axis, turning : (3,) of (low, high)
        The body axis e3, and its derivative, 1/s.
    thrust : (low, high)
        N.
    """

    position: tuple[Interval, ...]
    velocity: tuple[Interval, ...]
    axis: tuple[Interval, ...]
    turning: tuple[Interval, ...]
    thrust: Interval

    @classmethod
    def exactly(
        cls,
        position: Sequence[Fraction],
        velocity: Sequence[Fraction],
        axis: Sequence[Fraction],
        turning: Sequence[Fraction],
        thrust: Fraction,
    ) -> State:
        """Return one state.

        Parameters
        ----------
        position, velocity : (3,)
            m, m/s.
        axis, turning : (3,)
            The body axis e3, and its derivative, 1/s.
        thrust : Fraction
            N.
        """
        place, speed, e3, turn = map(_exactly, (position, velocity, axis, turning))
        return cls(place, speed, e3, turn, (thrust, thrust))

    @classmethod
    def of(cls, mission: Mission) -> State | None:
        """Return the start of a mission; None if it has a yaw rate.

        Parameters
        ----------
        mission : Mission
        """
        start, thrust = mission.start, mission.vehicle.weight
        rates = start.rates
        if rates[2]:
            return None
        turning = (rates[1], -rates[0], ZERO)  # Ω × e3
        e3 = (ZERO, ZERO, Fraction(1))
        if not any(start.rotation):
            return cls.exactly(start.position, start.velocity, e3, turning, thrust)
        iv = MPIntervalContext()
        iv.prec = BITS

        def enclosed(x: Fraction) -> Any:
            return iv.mpf(x.numerator) / x.denominator

        angles = [enclosed(x) for x in start.rotation]
        R = rotation_rows([iv.cos(x) for x in angles], [iv.sin(x) for x in angles])

        def turned(v: Sequence[Fraction], grid: int = GRID) -> tuple[Interval, ...]:
            rows = (sum(r * enclosed(x) for r, x in zip(row, v, strict=True))._mpi_ for row in R)
            ends = [[Fraction(*to_rational(x)) for x in row] for row in rows]
            return tuple(_outward(low, high, grid) for low, high in ends)

        velocity, axis, turn = turned(start.velocity), turned(e3), turned(turning, TURNING_GRID)
        return cls(_exactly(start.position), velocity, axis, turn, (thrust, thrust))

    def packed(self) -> NDArray[np.float64]:
        """Return the middle of the box as a state of the vehicle with some heading, (19,)."""

        def middle(sides: Sequence[Interval]) -> NDArray[np.float64]:
            return np.array([float((a + b) / 2) for a, b in sides])

        x, v, b, w = map(middle, (self.position, self.velocity, self.axis, self.turning))
        aside = np.cross([0.0, 1.0, 0.0] if abs(b[1]) < 0.9 else [1.0, 0.0, 0.0], b)
        aside /= np.linalg.norm(aside)
        R = np.stack([aside, np.cross(b, aside), b], axis=1)
        turn = R.T @ w  # Ω × e3
        rates = [-turn[1], turn[0], 0.0]
        return np.concatenate([x, R.T @ v, R.T.ravel(), rates, middle((self.thrust,))])


def _outward(low: Fraction, high: Fraction, grid: int) -> Interval:
    """Round the ends to a grid, and one step further out; keep a zero."""
    if low == high == 0:
        return ZERO, ZERO
    return Fraction(math.floor(low * grid) - 1, grid), Fraction(math.ceil(high * grid) + 1, grid)


def _exactly(v: Sequence[Fraction]) -> tuple[Interval, ...]:
    return tuple((x, x) for x in v)


def _length(*parts: Fraction) -> Fraction:
    square = sum((x * x for x in parts), ZERO)
    return decimal_above(sqrt_enclosure(square)[1], 6) if square else ZERO
