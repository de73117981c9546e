"""The vehicle of a mission: its mass and inertia, and where its rotors are."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, PlainValidator, model_validator

from hoverproof.mission.fields import Section, array, one_of, quantity, reject, shown
from hoverproof.mission.frame import LAYOUTS, PLUS, Frame, X, h_frame, lever_of, mean_distance

_LENGTH = quantity("m", "0", "1e6", open_low=True)
_PositiveLength = Annotated[Fraction, _LENGTH]
_Inertia = Annotated[Fraction, quantity("kg m²", "0", "1e6", open_low=True, least="1e-15")]
_WANTED = {
    "x": "a length in m, from the centre of mass to each rotor",
    "plus": "a length in m, from the centre of mass to each rotor",
    "h": "[forward, sideways] in m, from the centre of mass to each rotor",
}


def _one_or_two(value: object) -> Fraction | tuple[Fraction, Fraction]:
    """Read a length, or two in a list."""
    length: Any = _LENGTH.func
    if isinstance(value, list | tuple):
        if len(value) != 2:
            raise reject(f"must be a length or [forward, sideways], not {shown(list(value))}")
        return length(value[0]), length(value[1])
    number: Fraction = length(value)
    return number


class Vehicle(Section):
    """The vehicle: mass kg, inertia kg m² (principal), its rotors, drag_ratio m, gravity m/s².

    Where the rotors are is said in one of two ways: `lever`, m, of each rotor about the roll and
    the pitch axis, the d of the paper, in an X frame; or `layout`, "x", "plus" or "h", with `arm`,
    m, from the centre of mass to each rotor, of "h" [forward, sideways].
    """

    mass: Annotated[Fraction, quantity("kg", "0", "1e6", open_low=True)]
    inertia: Annotated[
        tuple[_Inertia, _Inertia, _Inertia], BeforeValidator(array("I1", "I2", "I3"))
    ]
    lever: _PositiveLength | None = None
    layout: Annotated[Literal["x", "plus", "h"], one_of(*LAYOUTS)] | None = None
    arm: Annotated[Any, PlainValidator(_one_or_two)] = None
    drag_ratio: _PositiveLength
    gravity: Annotated[Fraction, quantity("m/s²", "0", "1e3", open_low=True)]

    @model_validator(mode="after")
    def _is_a_body(self) -> Self:
        a, b, c = sorted(self.inertia)
        if a + b < c:
            raise reject(
                "no rigid body has one moment above the sum of the other two", key="inertia"
            )
        return self

    @model_validator(mode="after")
    def _says_where_rotors_are(self) -> Self:
        layout, arm = self.layout, self.arm
        if layout is None:
            if arm is not None:
                raise reject(_two_readings(arm), key="arm")
            if self.lever is None:
                raise reject(
                    'is missing: give layout ("x", "plus" or "h") with arm (m, from the centre of '
                    "mass to a rotor), or lever (m, of each rotor about roll and pitch axis)",
                    key="layout",
                )
            return self
        if self.lever is not None:
            raise reject("is of an X frame without layout; with one, give arm", key="lever")
        if arm is None:
            raise reject(f"is missing: {_WANTED[layout]}", key="arm")
        if isinstance(arm, tuple) != (layout == "h"):
            given = shown(list(arm) if isinstance(arm, tuple) else arm)
            raise reject(f"must be {_WANTED[layout]} for layout {layout!r}, not {given}", key="arm")
        return self

    @property
    def weight(self) -> Fraction:
        """m g, N."""
        return self.mass * self.gravity

    @cached_property
    def frame(self) -> Frame:
        """Where its rotors are, in multiples of `reach`, and how they turn."""
        if self.layout == "plus":
            return PLUS
        return h_frame(*self.arm) if isinstance(self.arm, tuple) else X

    @cached_property
    def reach(self) -> Fraction:
        """The length that places of the frame are multiples of, m: in an X frame its lever."""
        arm: Fraction = self.arm[1] if isinstance(self.arm, tuple) else self.arm
        if self.layout is None:
            return self.lever or Fraction(0)
        return lever_of(arm) if self.layout == "x" else arm

    @property
    def distance(self) -> float:
        """Root mean square of the distances of the rotors from the centre of mass, m."""
        return float(self.reach) * mean_distance(self.frame)

    def as_flown(self) -> dict[str, Any]:
        """Return what counts of it: `arm`, the lever of an X frame, m, or all rotors.

        A rotor is [x, y, turn]: where it is, m, and how it turns, as in `Frame`.
        """
        held = self.model_dump(include={"mass", "inertia", "drag_ratio", "gravity"})
        if self.frame == X:
            return held | {"arm": self.reach}
        places, turns = self.frame.places, self.frame.turns
        rotors = [
            [x * self.reach, y * self.reach, turn]
            for (x, y), turn in zip(places, turns, strict=True)
        ]
        return held | {"rotors": rotors}


def _two_readings(arm: Fraction | tuple[Fraction, Fraction]) -> str:
    """Say what an arm without a layout may mean."""
    if isinstance(arm, tuple):
        return 'needs layout = "h"'
    length, across = f"{float(arm):g}", f"{float(arm) * 2**0.5:.4g}"
    return (
        f"has two readings: lever = {length} is what it was, each rotor {length} m from the roll "
        f'and the pitch axis (layout = "x" with arm = {across}); layout = "x" with arm = {length} '
        f"is {length} m from the centre of mass (lever = {float(lever_of(arm)):.4g})"
    )
