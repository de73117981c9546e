"""What a vehicle is to do: law, goal and gains, the bounds that hold on the way, and the start."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Discriminator, Tag, model_validator

from hoverproof.mission.fields import Section as _Section
from hoverproof.mission.fields import array as _array
from hoverproof.mission.fields import one_of as _one_of
from hoverproof.mission.fields import quantity as _quantity
from hoverproof.mission.fields import reject as _reject
from hoverproof.mission.fields import shown as _shown
from hoverproof.mission.target import Point

_Length = Annotated[Fraction, _quantity("m", "-1e6", "1e6")]
_PositiveLength = Annotated[Fraction, _quantity("m", "0", "1e6", open_low=True)]
_Speed = Annotated[Fraction, _quantity("m/s", "-1e4", "1e4")]
_Angle = Annotated[Fraction, _quantity("rad", "-3.1416", "3.1416")]
_BodyRate = Annotated[Fraction, _quantity("rad/s", "-1e3", "1e3")]
_Eigenvalue = Annotated[Fraction, _quantity("1/m", "0", "1e6", open_low=True)]
_Force = Annotated[Fraction, _quantity("N", "0", "1e9", open_low=True)]
_Direction = Annotated[Fraction, _quantity("", "-1e3", "1e3")]
_MassPerTime = Annotated[Fraction, _quantity("kg/s", "0", "1e9", open_low=True)]


class LawChoice(_Section):
    """Which law flies: feature, goal and force; by default the paper's.

    Bounds, gains and certificates are about the law of the mission. Where it converges is proved by
    theorem 3 for the paper's law and the vehicle as modelled, else by theorems 5 and 6.

    Attributes
    ----------
    feature : "centroid" or "scaled"
        The image centroid q of the paper, or q scaled so that a small target keeps its height; then
        bounds.eigenvalues are the ends [j - ϱ, j + ϱ] of a ball about j I that holds J, the slope
        of the scaled centroid, in the place of Q.
    goal : "image" or "inertial"
        Fixed in the image as in the paper, or to the vertical, which a centroid [0, 0, q3] needs.
    force : "modelled" or "measured"
        That of the commanded thrust as in the paper, or that which an accelerometer measures.
    """

    feature: Annotated[Literal["centroid", "scaled"], _one_of("centroid", "scaled")] = "centroid"
    goal: Annotated[Literal["image", "inertial"], _one_of("image", "inertial")] = "image"
    force: Annotated[Literal["modelled", "measured"], _one_of("modelled", "measured")] = "modelled"

    @property
    def name(self) -> str:
        """The three choices in a word."""
        return f"{self.feature}/{self.goal}/{self.force}"

    @property
    def is_papers(self) -> bool:
        """Whether it is the law of the paper."""
        return self == LawChoice()


class Goal(_Section):
    """Where to hover: height m above the target, or the wanted image centroid; and the heading.

    The heading is the yaw to turn to, rad; by default yaw is damped alone, at whatever heading.
    It is known from a compass, or from the image (heading_from): points in order, flat and level.
    """

    height: _PositiveLength | None = None
    centroid: (
        Annotated[
            tuple[_Direction, _Direction, _Direction], BeforeValidator(_array("q1", "q2", "q3"))
        ]
        | None
    ) = None
    heading: _Angle | None = None
    heading_from: Annotated[Literal["compass", "image"], _one_of("compass", "image")] | None = None

    @model_validator(mode="after")
    def _has_a_heading(self) -> Self:
        if self.heading_from is not None and self.heading is None:
            raise _reject(
                "says where the heading is known from: give goal.heading (rad), or leave it out",
                key="heading_from",
            )
        return self

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if (self.height is None) == (self.centroid is None):
            raise _reject("give either height (m) or centroid ([q1, q2, q3]), one of the two")
        return self


class Gains(_Section):
    """Control gains: k1 kg m/s, k2 1/m, k3 and k4 kg/s, k_yaw kg m²/s, k_heading kg m²/s².

    The last goes with goal.heading; left out it is k_yaw²/(4 I3), but at most k_yaw times 1 rad/s.
    """

    k1: Annotated[Fraction, _quantity("kg m/s", "0", "1e9", open_low=True)]
    k2: Annotated[Fraction, _quantity("1/m", "0", "1e9", open_low=True)]
    k3: _MassPerTime
    k4: _MassPerTime
    k_yaw: Annotated[Fraction, _quantity("kg m²/s", "0", "1e9", open_low=True, least="1e-15")]
    k_heading: (
        Annotated[Fraction, _quantity("kg m²/s²", "0", "1e9", open_low=True, least="1e-15")] | None
    ) = None

    def __iter__(self) -> Iterator[tuple[str, Any]]:  # type: ignore[override]
        """Yield name and value of each gain that there is."""
        return ((name, value) for name, value in super().__iter__() if value is not None)


_ends = BeforeValidator(_array("lowest", "highest"))
_Side = Annotated[tuple[_Length, _Length], _ends]
TAGS = _AUTO, _NUMBERS = "auto", "two numbers"  # tags, left out of messages


class Bounds(_Section):
    """What holds in flight: eigenvalues of Q 1/m, and thrust N or a level of L.

    Eigenvalues are assumed, or ``"auto"``: proved over `box`, m, by default about start and goal.
    """

    eigenvalues: Annotated[
        Annotated[Literal["auto"], Tag(_AUTO)]
        | Annotated[
            tuple[_Eigenvalue, _Eigenvalue],
            BeforeValidator(_array("lowest", "highest", instead=_AUTO)),
            Tag(_NUMBERS),
        ],
        Discriminator(lambda value: _AUTO if value == _AUTO else _NUMBERS),
    ]
    box: Annotated[tuple[_Side, _Side, _Side], BeforeValidator(_array("x", "y", "z"))] | None = None
    thrust: Annotated[tuple[_Force, _Force], _ends] | None = None
    level: Annotated[Fraction, _quantity("", "0", "1e9", open_low=True)] | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if isinstance(self.eigenvalues, tuple):
            low, high = self.eigenvalues
            if low >= high:
                raise _reject(
                    f"the lowest, {_shown(low)}, must be below the highest, {_shown(high)}",
                    key="eigenvalues",
                )
            if self.box is not None:
                raise _reject('is for eigenvalues = "auto", which are proved over it', key="box")
        if any(low > high for low, high in self.box or ()):
            raise _reject("each side goes from its lowest to its highest", key="box")
        if (self.thrust is None) == (self.level is None):
            raise _reject(
                "give either thrust ([lowest, highest] in N) or level (of L), one of the two"
            )
        if self.thrust is not None and self.thrust[0] > self.thrust[1]:
            low, high = self.thrust
            raise _reject(
                f"the lowest, {_shown(low)}, must not be above the highest, {_shown(high)}",
                key="thrust",
            )
        return self


_Velocity = Annotated[tuple[_Speed, _Speed, _Speed], BeforeValidator(_array("v1", "v2", "v3"))]
_Euler = Annotated[tuple[_Angle, _Angle, _Angle], BeforeValidator(_array("roll", "pitch", "yaw"))]
_Rates = Annotated[tuple[_BodyRate, _BodyRate, _BodyRate], BeforeValidator(_array("p", "q", "r"))]
_ZERO = (Fraction(0), Fraction(0), Fraction(0))


class Start(_Section):
    """Where a flight starts: by default level, at rest, with the thrust of hover.

    position m (world frame), velocity m/s (body frame), rotation rad (roll, pitch, yaw; R =
    Rz(yaw) Ry(pitch) Rx(roll)), rates rad/s (body frame).
    """

    position: Point
    velocity: _Velocity = _ZERO
    rotation: _Euler = _ZERO
    rates: _Rates = _ZERO
