"""Printed tags: which are on a target, and where their corners are."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError, suggestion
from hoverproof.mission.exact import exact
from hoverproof.mission.sections import Mission
from hoverproof.mission.target_files import Print, read_target

Array = NDArray[np.float64]

FAMILIES = {
    **{name: f"APRILTAG_{name}" for name in ("36h11", "36h10", "25h9", "16h5")},
    **{f"{s}x{s}_{n}": f"{s}X{s}_{n}" for s in (4, 5, 6, 7) for n in (50, 100, 250, 1000)},
    "mip_36h12": "ARUCO_MIP_36h12",
    "original": "ARUCO_ORIGINAL",
}
"""Names of OpenCV's dictionaries, by ours."""
USUAL = "36h11"
TOO_FAR = 1e-4
"""m: a corner is a point of the target if it is no farther from it."""


@dataclass(frozen=True, eq=False)
class Board:
    """Tags of one family, and the points that a mission makes of their corners.

    Attributes
    ----------
    family : str
        One of `FAMILIES`.
    border : int
        Width of the black border, in bits.
    numbers : (m,) tuple of int
        Which tags.
    corners : (m, 4, 3) array
        World frame, m: top left, top right, bottom right, bottom left of each tag as it is printed.
    order : (n,) array of int
        For each target point its place among all corners, tag by tag.
    """

    family: str
    border: int
    numbers: tuple[int, ...]
    corners: Array
    order: NDArray[np.int64]

    @property
    def points(self) -> Array:
        """The target points, (n, 3), world frame, m."""
        points: Array = self.corners.reshape(-1, 3)[self.order]
        return points

    @property
    def words(self) -> str:
        """What is printed."""
        side = np.linalg.norm(self.corners[0, 1] - self.corners[0, 0])
        few = ", ".join(map(str, self.numbers[:6])) + (", ..." if len(self.numbers) > 6 else "")
        tags = f"tag {few}" if len(self.numbers) == 1 else f"{len(self.numbers)} tags ({few})"
        return f"{self.family}, {tags} of {side:g} m"


def family_named(name: str, where: str) -> str:
    """Return the family of a name as tools write it: `tag36h11`, `DICT_4X4_50`.

    Parameters
    ----------
    name : str
    where : str
        Of it, for messages.

    Raises
    ------
    InputError
        If there is none.
    """
    plain = re.sub(r"^(dict_|apriltag_|aruco_|tag)+", "", name.strip().lower())
    if plain not in FAMILIES:
        near = suggestion(plain[:40], list(FAMILIES), "there are")
        raise InputError(where, "", f"has no family of tags {name[:40]!r}; {near}")
    return plain


def board_of_tag(text: str) -> Board:
    """Return the board of one tag, FAMILY:ID:SIZE, with the size in m.

    Parameters
    ----------
    text : str
        As 36h11:0:0.2.
    """
    parts = text.split(":")
    try:
        family, number, size = parts[0], int(parts[1]), float(exact(parts[2]))
        if len(parts) != 3 or number < 0 or not 0 < size < 1e3:
            raise ValueError
    except (IndexError, ValueError, OverflowError):
        wanted = "must be FAMILY:ID:SIZE, with SIZE the black square's side in m, as 36h11:0:0.2"
        raise InputError("--tag", "", f"{wanted}, not {text[:60]!r}") from None
    h = size / 2
    square = [(-h, h, 0.0), (h, h, 0.0), (h, -h, 0.0), (-h, -h, 0.0)]
    return _board(square, [Print(number)], family_named(family, "--tag"), "--tag")


def board_of_file(path: str, name: str | None = None, family: str | None = None) -> Board:
    """Return the board that a file describes; see `hoverproof.mission.target_files`.

    Parameters
    ----------
    path : str
    name : str, optional
        Which of several.
    family : str, optional
        Of the tags, where the file does not say.

    Raises
    ------
    InputError
        If it cannot be read or holds no tags.
    """
    found = read_target(path, name)
    if not found.prints or len(found.points) != 4 * len(found.prints):
        raise InputError(path, "", "holds no tags of four corners each, which `see` looks for")
    named = found.prints[0].family or family or USUAL
    points = [(float(x), float(y), float(z)) for x, y, z in found.points]
    return _board(points, found.prints, family_named(named, path), path)


def _board(
    points: Sequence[tuple[float, ...]], prints: Sequence[Print], family: str, where: str
) -> Board:
    numbers = tuple(each.number for each in prints)
    if len(set(numbers)) < len(numbers):
        raise InputError(where, "", "has one tag twice: which of them is seen cannot be told")
    turned = np.array([4 * i + k for i, each in enumerate(prints) for k in each.order])
    corners = np.array(points)[turned].reshape(-1, 4, 3)
    return Board(family, prints[0].border, numbers, corners, np.argsort(turned))


def board_of_mission(mission: Mission, given: Board | None) -> Board:
    """Return the tags on the target of a mission, where it lies.

    One tag lies on the square that the mission's four points are, its right side toward +x as
    nearly as may be; by default it is number 0 of `USUAL`. Several lie so that their corners are
    the points.

    Parameters
    ----------
    mission : Mission
    given : Board or None
        The tags; where they lie does not count.

    Raises
    ------
    InputError
        If they are not what the mission sees.
    """
    points = np.array(mission.target.points, float)
    if given is None or len(given.numbers) == 1:
        return _on_the_square(mission, points, given)
    corners = given.corners - given.points.mean(axis=0) + points.mean(axis=0)
    apart = np.linalg.norm(points[:, None] - corners.reshape(1, -1, 3), axis=2)
    order = apart.argmin(axis=1)
    if (
        len(points) != apart.shape[1]
        or len(set(order)) < len(order)
        or apart.min(1).max() > TOO_FAR
    ):
        raise _not_these(mission, f"are not the corners of the {given.words}")
    return Board(given.family, given.border, given.numbers, corners, order)


def _on_the_square(mission: Mission, points: Array, given: Board | None) -> Board:
    middle = points.mean(axis=0)
    arms = points - middle
    around = np.argsort(np.arctan2(arms[:, 1], arms[:, 0]))
    sides = np.linalg.norm(points[around] - np.roll(points[around], -1, axis=0), axis=1)
    across = np.linalg.norm(arms, axis=1)
    flat = len(points) == 4 and np.ptp(np.hstack([sides, math.sqrt(2) * across])) < TOO_FAR
    if not flat or np.ptp(points[:, 2]) > TOO_FAR:
        raise _not_these(mission, "are not the corners of one tag, a level square")
    if given is not None:
        size = np.linalg.norm(given.corners[0, 1] - given.corners[0, 0])
        if abs(size - sides[0]) > TOO_FAR:
            raise _not_these(mission, f"have sides of {sides[0]:g} m, the tag {size:g} m")
    first = int(np.argmin(arms[around, 0] + arms[around, 1]))  # clockwise from above, z down
    turned = np.roll(around, -first)
    family, numbers, border = (
        (USUAL, (0,), 1) if given is None else (given.family, given.numbers, given.border)
    )
    return Board(family, border, numbers, points[turned][None], np.argsort(turned))


def _not_these(mission: Mission, reason: str) -> InputError:
    more = "give the tags of the mission's target by --tag FAMILY:ID:SIZE or --target FILE"
    return InputError(mission.source, "target.points", f"{reason}; {more}")
