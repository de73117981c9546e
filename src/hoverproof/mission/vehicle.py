"""The vehicle of a mission: its mass and inertia, and where its rotors are."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PlainValidator, model_validator

from hoverproof.mission import frame as frames
from hoverproof.mission.fields import Section, array, one_of, quantity, reject, shown, true_or_false
from hoverproof.mission.frame import LAYOUTS, ROTORS, Frame, X

_LENGTH = quantity("m", "0", "1e6", open_low=True)
_PositiveLength = Annotated[Fraction, _LENGTH]
_Coordinate = Annotated[Fraction, quantity("m", "-1e6", "1e6")]
_Inertia = Annotated[Fraction, quantity("kg m²", "0", "1e6", open_low=True, least="1e-15")]
_ARM = "a length in m, from the centre of mass to each rotor"
_WANTED = dict.fromkeys(LAYOUTS, _ARM) | {
    "h": "[forward, sideways] in m, from the centre of mass to each rotor"
}
_Thrust = Annotated[Fraction, quantity("N", "0", "1e9")]
_MOMENT = quantity("kg m²", "-1e6", "1e6")
_ASIDE = (0, 1), (0, 2), (1, 2)
_TURN = {"ccw": 1, "cw": -1}
_NEEDED = (
    f"is missing: give layout ({', '.join(LAYOUTS)}) with arm (m, from the centre of mass to a "
    "rotor), lever (m, of each rotor of an X frame about roll and pitch axis), or rotors (a list)"
)


def _one_or_two(value: object) -> Fraction | tuple[Fraction, Fraction]:
    """Read a length, or two in a list."""
    length: Any = _LENGTH.func
    if isinstance(value, list | tuple):
        if len(value) != 2:
            raise reject(f"must be a length or [forward, sideways], not {shown(list(value))}")
        return length(value[0]), length(value[1])
    number: Fraction = length(value)
    return number


def _spin(value: object) -> str:
    """Read how a rotor turns, seen from above."""
    known = {"ccw": "ccw", "cw": "cw", 1: "ccw", -1: "cw"}
    if isinstance(value, bool) or not isinstance(value, str | int) or value not in known:
        raise reject(f'must be "ccw" (1) or "cw" (-1), seen from above, not {shown(value)}')
    return known[value]


def _listed(value: object) -> object:
    """Accept a list of so many entries as a vehicle may have rotors."""
    least, most = ROTORS
    if not isinstance(value, list) or not least <= len(value) <= most:
        raise reject(
            f"must be a list of {least} to {most} rotors {{position = [x, y, z], spin}}, "
            f"not {shown(value)}"
        )
    return value


class Rotor(Section):
    """A rotor: position m (body axes, x forward, y right, z down), spin, drag_ratio m.

    The spin is "ccw" (or 1) or "cw" (or -1), seen from above. The drag ratio is that of the
    vehicle, unless it is said here; thrust_min and thrust_max, N, are those of `[rotors]`.
    """

    position: Annotated[
        tuple[_Coordinate, _Coordinate, _Coordinate], BeforeValidator(array("x", "y", "z"))
    ]
    spin: Annotated[Any, PlainValidator(_spin)]
    drag_ratio: _PositiveLength | None = None
    thrust_min: _Thrust | None = None
    thrust_max: _Thrust | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        low, high = self.thrust_min, self.thrust_max
        if low is not None and high is not None and low >= high:
            raise reject(f"must be below thrust_max, {shown(high)} N", key="thrust_min")
        return self


class Vehicle(Section):
    """The vehicle: mass kg, inertia kg m², its rotors, drag_ratio m, gravity m/s².

    The inertia is about the body axes: three moments, or a symmetric matrix of three rows, which is
    kept as `inertia` and `products`. Where the rotors are is said in one of three ways: `lever`, m,
    of each rotor about the roll and the pitch axis, the d of the paper, in an X frame; `layout`,
    "x", "plus", "h", "hex" or "octo", with `arm`, m, from the centre of mass to each rotor, of "h"
    [forward, sideways], and `reversed` if propellers turn the other way; or a list `rotors`.
    """

    mass: Annotated[Fraction, quantity("kg", "0", "1e6", open_low=True)]
    inertia: Annotated[
        tuple[_Inertia, _Inertia, _Inertia], BeforeValidator(array("I1", "I2", "I3"))
    ]
    products: Annotated[tuple[Fraction, Fraction, Fraction] | None, Field(exclude=True)] = None
    lever: _PositiveLength | None = None
    layout: Annotated[Literal["x", "plus", "h", "hex", "octo"], one_of(*LAYOUTS)] | None = None
    arm: Annotated[Any, PlainValidator(_one_or_two)] = None
    reversed: Annotated[bool, true_or_false()] = False
    rotors: Annotated[list[Rotor], BeforeValidator(_listed)] | None = None
    drag_ratio: _PositiveLength
    gravity: Annotated[Fraction, quantity("m/s²", "0", "1e3", open_low=True)]

    @model_validator(mode="before")
    @classmethod
    def _apart(cls, data: Any) -> Any:
        """Take a matrix of inertia apart: its diagonal, and what stands beside it."""
        if not isinstance(data, dict):
            return data
        if "products" in data:
            raise reject("unknown key; give inertia as a 3 x 3 matrix", key="products")
        given = data.get("inertia")
        if not isinstance(given, list) or not any(isinstance(row, list) for row in given):
            return data
        if not all(isinstance(row, list) and len(row) == 3 for row in given) or len(given) != 3:
            raise reject("must be [I1, I2, I3] or a matrix of 3 rows of 3", key="inertia")
        number: Any = _MOMENT.func
        rows = [[number(entry) for entry in row] for row in given]
        if any(rows[i][j] != rows[j][i] for i, j in _ASIDE):
            raise reject("must be a symmetric matrix", key="inertia")
        aside = tuple(rows[i][j] for i, j in _ASIDE)
        diagonal = [rows[i][i] for i in range(3)]
        return data | {"inertia": diagonal} | ({"products": aside} if any(aside) else {})

    @model_validator(mode="after")
    def _is_a_body(self) -> Self:
        a, b, c = sorted(self.inertia)
        if self.products is None:
            if a + b < c:
                raise reject(
                    "no rigid body has one moment above the sum of the other two", key="inertia"
                )
            return self
        if not _is_semidefinite(self.matrix, strictly=True):
            raise reject("must be positive definite, as that of a rigid body is", key="inertia")
        half = sum(self.inertia, Fraction(0)) / 2
        rest = [[half * (i == j) - self.matrix[i][j] for j in range(3)] for i in range(3)]
        if not _is_semidefinite(rest):
            raise reject(
                "no rigid body has one principal moment above the sum of the other two; are the "
                "products of inertia in another unit?",
                key="inertia",
            )
        return self

    @property
    def moments(self) -> tuple[Fraction, ...]:
        """I11, I22, I33, kg m², and I12, I13, I23 if one of these is not zero."""
        return (*self.inertia, *(self.products or ()))

    @property
    def matrix(self) -> list[list[Fraction]]:
        """The matrix of inertia, (3, 3), kg m²."""
        rows = [[self.inertia[i] * (i == j) for j in range(3)] for i in range(3)]
        for (i, j), entry in zip(_ASIDE, self.products or (), strict=False):
            rows[i][j] = rows[j][i] = entry
        return rows

    @model_validator(mode="after")
    def _says_where_rotors_are(self) -> Self:
        layout, arm = self.layout, self.arm
        if self.rotors is not None:
            more = [k for k in ("lever", "layout", "arm", "reversed") if getattr(self, k)]
            if more:
                raise reject("goes without rotors, which say all of it", key=more[0])
            return self
        if layout is None:
            if arm is not None:
                raise reject(_two_readings(arm), key="arm")
            if self.lever is None:
                raise reject(_NEEDED, key="layout")
            return self
        if self.lever is not None:
            raise reject("is of an X frame without layout; with one, give arm", key="lever")
        if arm is None:
            raise reject(f"is missing: {_WANTED[layout]}", key="arm")
        if isinstance(arm, tuple) != (layout == "h"):
            given = shown(list(arm) if isinstance(arm, tuple) else arm)
            raise reject(f"must be {_WANTED[layout]} for layout {layout!r}, not {given}", key="arm")
        return self

    @model_validator(mode="after")
    def _can_hover(self) -> Self:
        if self.rotors is None:
            return self
        try:
            lifts = [row[0] for row in frames.shares(self.frame)]
        except ZeroDivisionError:
            raise reject(
                "cannot make every thrust and torque: some must be in front and behind, right and "
                "left, and turn to either side, and not all alike",
                key="rotors",
            ) from None
        for i, (name, lift) in enumerate(zip(self.frame.names, lifts, strict=True), 1):
            if lift <= 0:
                raise reject(
                    f"rotor {i} ({name}) would have to pull down in hover: "
                    "positions are from the centre of mass",
                    key="rotors",
                )
        return self

    @property
    def weight(self) -> Fraction:
        """m g, N."""
        return self.mass * self.gravity

    @cached_property
    def frame(self) -> Frame:
        """Where its rotors are, in multiples of `reach`, and how they turn."""
        if self.rotors is not None:
            placed = [rotor.position for rotor in self.rotors]
            return Frame(
                frames.names(placed),
                tuple((x / self.reach, y / self.reach) for x, y, _ in placed),
                tuple(
                    _TURN[r.spin] * (r.drag_ratio or self.drag_ratio) / self.drag_ratio
                    for r in self.rotors
                ),
            )
        frame = frames.h_frame(*self.arm) if self.layout == "h" else X
        if self.layout is not None and self.layout != "h":
            frame = frames.of_layout(self.layout)
        return frames.turned_round(frame) if self.reversed else frame

    @cached_property
    def reach(self) -> Fraction:
        """The length that places of the frame are multiples of, m: in an X frame its lever."""
        if self.rotors is not None:
            longest = max(abs(c) for rotor in self.rotors for c in rotor.position[:2])
            return longest or Fraction(1)
        arm: Fraction = self.arm[1] if isinstance(self.arm, tuple) else self.arm
        if self.layout is None:
            return self.lever or Fraction(0)
        return frames.lever_of(arm) if self.layout == "x" else arm

    @property
    def own_limits(self) -> tuple[tuple[Fraction | None, Fraction | None], ...]:
        """What each rotor of a list says of its thrust, N; nothing if none says anything."""
        own = tuple((r.thrust_min, r.thrust_max) for r in self.rotors or ())
        return own if any(end is not None for ends in own for end in ends) else ()

    @property
    def distance(self) -> float:
        """Root mean square of the distances of the rotors from the centre of mass, m."""
        return float(self.reach) * frames.mean_distance(self.frame)

    @cached_property
    def hover_thrusts(self) -> tuple[Fraction, ...]:
        """What each rotor gives in hover, N."""
        return tuple(row[0] * self.weight for row in frames.shares(self.frame))

    def as_matrix(self) -> dict[str, Any]:
        """Return the inertia as a file says it with products of inertia, kg m²."""
        return {"inertia": self.matrix}

    def as_flown(self) -> dict[str, Any]:
        """Return what counts of it: `arm`, the lever of an X frame, m, or all rotors.

        A rotor is [x, y, turn]: where it is, m, and how it turns, as in `Frame`.
        """
        held: dict[str, Any] = {
            "mass": self.mass,
            "inertia": self.inertia,
            "drag_ratio": self.drag_ratio,
            "gravity": self.gravity,
        }
        if self.products is not None:
            held["products"] = self.products
        if self.frame == X:
            return held | {"arm": self.reach}
        places, turns = self.frame.places, self.frame.turns
        rotors = [
            [x * self.reach, y * self.reach, turn]
            for (x, y), turn in zip(places, turns, strict=True)
        ]
        return held | {"rotors": rotors}


def _is_semidefinite(rows: list[list[Fraction]], *, strictly: bool = False) -> bool:
    """Tell whether a symmetric matrix of order 3 is positive (semi)definite, by its minors."""
    (a, d, e), (_, b, f), (_, _, c) = rows
    pairs = [a * b - d * d, a * c - e * e, b * c - f * f]
    determinant = a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)
    minors = [a, b, c, *pairs, determinant]
    return all(x > 0 if strictly else x >= 0 for x in minors)


def _two_readings(arm: Fraction | tuple[Fraction, Fraction]) -> str:
    """Say what an arm without a layout may mean."""
    if isinstance(arm, tuple):
        return 'needs layout = "h"'
    length, across = f"{float(arm):g}", f"{float(arm) * 2**0.5:.4g}"
    return (
        f"has two readings: lever = {length} is what it was, each rotor {length} m from the roll "
        f'and the pitch axis (layout = "x" with arm = {across}); layout = "x" with arm = {length} '
        f"is {length} m from the centre of mass (lever = {float(frames.lever_of(arm)):.4g})"
    )
