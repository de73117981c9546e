"""Targets as other tools describe them: tag bundles, calibration grids and marker maps, in YAML.

These tools have x to the right of a tag, y up on it and z out of it; a tag that lies on the floor
is seen from above with z down, so that a point (x, y, z) of theirs is (x, -y, -z) here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from hoverproof.errors import InputError, suggestion
from hoverproof.mission.exact_yaml import exact, read_yaml
from hoverproof.mission.target import MAX_POINTS

Point = tuple[Fraction, Fraction, Fraction]
FORMATS = (
    "apriltag_ros (tag_bundles, standalone_tags), Kalibr (target_type: aprilgrid or checkerboard), "
    "ArUco (aruco_bc_markers)"
)
COUNTERCLOCKWISE, CLOCKWISE = (3, 2, 1, 0), (0, 1, 2, 3)
"""Which of the four corners of a tag, as a file orders them, is its top left, top right, bottom
right and bottom left: from below left, or from above left."""
FINEST = Fraction(1, 10**6)
"""m: what is not a decimal, as the corners of a tag that is turned, is rounded to that."""
UNTURNED = {"qw": Fraction(1), "qx": Fraction(0), "qy": Fraction(0), "qz": Fraction(0)}
MOST_TURNED = Fraction(1, 1000)
"""A quaternion is as long as 1 to within that."""


@dataclass(frozen=True)
class Print:
    """What is printed between four points of a file, one after the other.

    Attributes
    ----------
    number : int
        Of the tag in its family, a bare number.
    family : str, optional
        As the file says; None if it does not.
    order : (4,) ints
        `COUNTERCLOCKWISE` or `CLOCKWISE`.
    border : int
        Width of the black border, in bits.
    """

    number: int
    family: str | None = None
    order: tuple[int, int, int, int] = COUNTERCLOCKWISE
    border: int = 1


@dataclass(frozen=True)
class TargetFile:
    """A target that was read.

    Attributes
    ----------
    points : list of (3,)
        World frame, z down, m, their middle at x = y = z = 0.
    words : list of str
        What the file has, with units, and what was made of it.
    prints : list of Print
        The tags, each between four points in turn; none of a checkerboard.
    """

    points: list[Point]
    words: list[str]
    prints: list[Print]

    @property
    def side(self) -> Fraction:
        """How far it reaches along x or y, whichever is more, m."""
        x, y = ([point[k] for point in self.points] for k in (0, 1))
        return max(max(x) - min(x), max(y) - min(y))


@dataclass(frozen=True)
class _Held:
    """A part of a file: where it is, for messages, and what it holds."""

    where: str
    key: str
    value: Any

    def refuse(self, reason: str) -> InputError:
        return InputError(self.where, self.key, reason)

    def entries(self) -> Iterator[_Held]:
        if not isinstance(self.value, list) or len(self.value) > MAX_POINTS:
            raise self.refuse(f"must be a list of at most {MAX_POINTS} entries")
        for i, entry in enumerate(self.value):
            yield _Held(self.where, f"{self.key}[{i + 1}]", entry)

    def part(self, key: str) -> _Held:
        if not isinstance(self.value, Mapping):
            raise self.refuse(f"must hold {key}, as a mapping")
        whole = f"{self.key}.{key}" if self.key else key
        if key not in self.value:
            raise InputError(self.where, whole, "is missing")
        return _Held(self.where, whole, self.value[key])

    def number(self, unit: str, least: Fraction | None = None) -> Fraction:
        found = exact(self.value)
        if found is None or abs(found) > 10**6 or (least is not None and found <= least):
            above = "" if least is None else f" above {least}"
            raise self.refuse(f"must be a number{above}{f' in {unit}' if unit else ''}")
        return found

    def count(self) -> int:
        found = self.number("", Fraction(0))
        if found.denominator != 1 or found > MAX_POINTS:
            raise self.refuse(f"must be a whole number from 1 to {MAX_POINTS}")
        return int(found)

    def has(self, key: str) -> bool:
        return isinstance(self.value, Mapping) and key in self.value


def read_target(path: str, name: str | None = None) -> TargetFile:
    """Read a target.

    Parameters
    ----------
    path : str
        Of a YAML or JSON file: see `FORMATS`.
    name : str, optional
        Which bundle, or which tag by name or number, of a file that holds several.

    Raises
    ------
    InputError
        If it cannot be read or holds no target.
    """
    whole = _Held(path, "", read_yaml(path))
    if whole.has("target_type"):
        found = _grid(whole)
    elif whole.has("tag_bundles") or whole.has("standalone_tags"):
        found = _of_apriltag(whole, name)
        name = None
    elif whole.has("aruco_bc_markers"):
        found = _marker_map(whole)
    else:
        raise whole.refuse(f"holds no target that is known: {FORMATS}")
    if name is not None:
        raise InputError("--target-name", "", f"{path} holds one target, which has no name")
    points, words, prints = found
    if len(points) > MAX_POINTS:
        raise whole.refuse(f"has {len(points)} points, at most {MAX_POINTS} are taken")
    return TargetFile(*_centred(points, words), prints)


Found = tuple[list[Point], list[str], list[Print]]


def _grid(whole: _Held) -> Found:
    kind = whole.part("target_type")
    readers: dict[Any, Callable[[_Held], Found]] = {
        "aprilgrid": _aprilgrid,
        "checkerboard": _checkerboard,
    }
    if not isinstance(kind.value, str) or kind.value not in readers:
        raise kind.refuse(f"must be {' or '.join(map(repr, readers))}")
    return readers[kind.value](whole)


def _aprilgrid(whole: _Held) -> Found:
    columns, rows = whole.part("tagCols").count(), whole.part("tagRows").count()
    size = whole.part("tagSize").number("m", Fraction(0))
    spacing = whole.part("tagSpacing").number("(a share of tagSize)", Fraction(0))
    pitch = size * (1 + spacing)
    if 4 * rows * columns > MAX_POINTS:
        raise whole.refuse(f"has {4 * rows * columns} corners, at most {MAX_POINTS} are taken")
    points = [
        (column * pitch + x, row * pitch + y, Fraction(0))
        for row in range(rows)
        for column in range(columns)
        for x, y in ((0, 0), (size, 0), (size, size), (0, size))
    ]
    return (
        points,
        [
            f"AprilGrid: {columns} x {rows} tags of {_m(size)}, {_m(size * spacing)} between them "
            f"(tagSpacing {float(spacing):g})",
            f"{len(points)} corners, tag by tag from below left, counterclockwise",
        ],
        [Print(i, "36h11", border=2) for i in range(rows * columns)],
    )


def _checkerboard(whole: _Held) -> Found:
    columns, rows = whole.part("targetCols").count(), whole.part("targetRows").count()
    across = whole.part("colSpacingMeters").number("m", Fraction(0))
    up = whole.part("rowSpacingMeters").number("m", Fraction(0))
    if rows * columns > MAX_POINTS:
        raise whole.refuse(f"has {rows * columns} corners, at most {MAX_POINTS} are taken")
    points = [(j * across, i * up, Fraction(0)) for i in range(rows) for j in range(columns)]
    return (
        points,
        [
            f"checkerboard: {columns} x {rows} inner corners, {_m(across)} by {_m(up)} apart",
            f"{len(points)} corners, row by row from below left",
        ],
        [],
    )


def _of_apriltag(whole: _Held, name: str | None) -> Found:
    """Return a bundle, or a single tag, of apriltag_ros."""
    targets: dict[str, tuple[_Held, bool]] = {}
    for key in ("tag_bundles", "standalone_tags"):
        if whole.has(key) and whole.part(key).value is not None:
            for entry in whole.part(key).entries():
                targets.setdefault(_named(entry, key), (entry, key == "tag_bundles"))
    if not targets:
        raise whole.refuse("holds neither a tag bundle nor a standalone tag")
    if name is None and len(targets) > 1:
        bundles = [each for each, (_, is_bundle) in targets.items() if is_bundle]
        if len(bundles) != 1:
            raise InputError(
                "--target-name", "", f"is needed, for {whole.where} holds {_several(targets)}"
            )
        name = bundles[0]
    if name is not None and name not in targets:
        raise InputError("--target-name", "", f"{suggestion(name, list(targets), 'it holds')}")
    entry, is_bundle = targets[name or next(iter(targets))]
    return _bundle(entry, name or next(iter(targets))) if is_bundle else _single(entry)


def _several(targets: Mapping[str, object]) -> str:
    names = list(targets)
    more = f" and {len(names) - 8} more" if len(names) > 8 else ""
    return f"several targets: {', '.join(names[:8])}{more}"


def _named(entry: _Held, key: str) -> str:
    if entry.has("name"):
        return str(entry.part("name").value)[:64]
    return str(int(entry.part("id").number(""))) if key == "standalone_tags" else entry.key


def _single(entry: _Held) -> Found:
    size = entry.part("size").number("m", Fraction(0))
    number = int(entry.part("id").number(""))
    words = [f"tag {number}: a square of {_m(size)}", "4 corners, counterclockwise from below left"]
    return _corners(size), words, [Print(number)]


def _bundle(entry: _Held, name: str) -> Found:
    points: list[Point] = []
    prints: list[Print] = []
    sizes, turned = [], 0
    for tag in entry.part("layout").entries():
        size = tag.part("size").number("m", Fraction(0))
        place = [_or(tag, key, Fraction(0)).number("m") for key in ("x", "y", "z")]
        quaternion = [_or(tag, key, UNTURNED[key]).number("") for key in UNTURNED]
        rotation = _rotation(tag, quaternion)
        turned += quaternion[0] != 1
        prints.append(Print(int(_or(tag, "id", Fraction(len(prints))).number(""))))
        sizes.append(size)
        for corner in _corners(size):
            moved = [
                sum((a * c for a, c in zip(row, corner, strict=True)), p)
                for row, p in zip(rotation, place, strict=True)
            ]
            points.append(_point(moved))
    if not points:
        raise entry.refuse("has no tag in its layout")
    low, high = min(sizes), max(sizes)
    side = _m(low) if low == high else f"{_m(low)} to {_m(high)}"
    return (
        points,
        [
            f"tag bundle {name}: {len(sizes)} tags of {side}, {turned} of them turned",
            f"{len(points)} corners, tag by tag, counterclockwise from below left",
        ],
        prints,
    )


def _or(tag: _Held, key: str, value: Fraction | None) -> _Held:
    """Return a part; apriltag_ros lets places and turns be left out."""
    return tag.part(key) if tag.has(key) else _Held(tag.where, f"{tag.key}.{key}", value)


def _rotation(tag: _Held, quaternion: Sequence[Fraction]) -> list[list[Fraction]]:
    w, x, y, z = quaternion
    square = sum((c * c for c in quaternion), Fraction(0))
    if abs(square - 1) > 2 * MOST_TURNED:
        raise tag.refuse(
            f"has a quaternion (qw, qx, qy, qz) of length {math.sqrt(square):.4g}, which must be 1"
        )
    s = 2 / square
    return [
        [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
        [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
        [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
    ]


def _marker_map(whole: _Held) -> Found:
    """Return the corners of a marker map of ArUco."""
    unit = whole.part("aruco_bc_mInfoType")
    if unit.number("") != 1:
        raise unit.refuse("must be 1, for corners in metres; 0 is for pixels")
    points: list[Point] = []
    markers = list(whole.part("aruco_bc_markers").entries())
    named = _or(whole, "aruco_bc_dict", None).value
    family, prints = (named if isinstance(named, str) else None), []
    for i, marker in enumerate(markers):
        number = int(_or(marker, "id", Fraction(i)).number(""))
        prints.append(Print(number, family, CLOCKWISE))
        for corner in marker.part("corners").entries():
            point = [c.number("m") for c in corner.entries()]
            if len(point) != 3:
                raise corner.refuse("must be [x, y, z], m")
            points.append(_point(point))
    return (
        points,
        [
            f"ArUco marker map: {len(markers)} markers, corners in m",
            f"{len(points)} corners, in the order of the file",
        ],
        prints,
    )


def _corners(size: Fraction) -> list[Point]:
    h, zero = size / 2, Fraction(0)
    return [(-h, -h, zero), (h, -h, zero), (h, h, zero), (-h, h, zero)]


def _point(values: Sequence[Fraction]) -> Point:
    x, y, z = map(_short, values)
    return x, y, z


def _short(value: Fraction) -> Fraction:
    """Keep a decimal, and round what is none."""
    rest = value.denominator
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
    kept = rest == 1 and value.denominator < 10**12
    return value if kept else round(value / FINEST) * FINEST


def _centred(points: list[Point], words: list[str]) -> tuple[list[Point], list[str]]:
    """Move the middle to the origin, and turn y and z round: x ahead, y right, z down."""
    n = len(points)
    if n < 2:
        raise InputError("target", "", "must have 2 points at least")
    middle = [round(sum(axis) / n / FINEST) * FINEST for axis in zip(*points, strict=True)]
    x, y, z = middle
    moved = [(_short(a - x), _short(y - b), _short(z - c)) for a, b, c in points]
    where = ", ".join(f"{float(c):g}" for c in middle)
    return moved, [
        *words,
        f"laid flat on the floor, face up: x as in the file, y and z turned round; its middle, "
        f"({where}) m in the file, is the origin",
    ]


def _m(length: Fraction) -> str:
    return f"{float(length):g} m"
