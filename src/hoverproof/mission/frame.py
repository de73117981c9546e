"""Frames: where the rotors of a vehicle are, how they turn, and what they are called.

The body axes are x forward, y right, z down.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Final, NamedTuple

LAYOUTS = ("x", "plus", "h")
"""Frames that lengths of arms describe."""

Place = tuple[Fraction, Fraction]


class Frame(NamedTuple):
    """The rotors of a vehicle, whatever its size.

    Attributes
    ----------
    names : tuple of str
        Of the rotors, by where they are.
    places : (n, 2) Fractions
        (x, y), where each is, body axes, over a length that the vehicle says (`Vehicle.reach`).
    turns : (n,) Fractions
        Drag torque of each about z over its thrust, over the drag ratio that the vehicle says:
        above 0 for a rotor that turns to the left, seen from above.
    """

    names: tuple[str, ...]
    places: tuple[Place, ...]
    turns: tuple[Fraction, ...]


def _whole(*pairs: tuple[int, int]) -> tuple[Place, ...]:
    return tuple((Fraction(x), Fraction(y)) for x, y in pairs)


_DIAGONAL = "rear right", "front right", "rear left", "front left"
_CORNERS = _whole((-1, 1), (1, 1), (-1, -1), (1, -1))
_LEFT_RIGHT = tuple(map(Fraction, (-1, 1, 1, -1)))

X: Final = Frame(_DIAGONAL, _CORNERS, _LEFT_RIGHT)
"""Four rotors at the same lever about roll and pitch axis, as in the paper."""
PLUS: Final = Frame(
    ("front", "right", "rear", "left"),
    _whole((1, 0), (0, 1), (-1, 0), (0, -1)),
    tuple(map(Fraction, (1, -1, 1, -1))),
)
"""Four rotors on the axes."""


def h_frame(forward: Fraction, sideways: Fraction) -> Frame:
    """Return four rotors at the corners of a rectangle, in units of the way sideways.

    Parameters
    ----------
    forward, sideways : Fraction
        From the centre of mass to each rotor along x and y, m.
    """
    if forward == sideways:
        return X
    return X._replace(places=tuple((x * forward / sideways, y) for x, y in _CORNERS))


def lever_of(arm: Fraction) -> Fraction:
    """Return arm/√2, m: the lever of an X frame, in 12 digits.

    Parameters
    ----------
    arm : Fraction
        From the centre of mass to each rotor, m.
    """
    return Fraction(f"{float(arm) / math.sqrt(2):.12g}")


def mean_distance(frame: Frame) -> float:
    """Return the root mean square of the distances of the rotors from the centre of mass.

    Parameters
    ----------
    frame : Frame
    """
    squares = [float(x * x + y * y) for x, y in frame.places]
    return math.sqrt(sum(squares) / len(squares))


def shares(frame: Frame) -> list[list[Fraction]]:
    """Return the pseudo-inverse of the mixing matrix, (n, 4), exact.

    A row is how much of T, Γ1, Γ2 and Γ3 a rotor takes over, with lengths in the units of the
    frame: among all thrusts that make them those of the least sum of squares.

    Parameters
    ----------
    frame : Frame

    Raises
    ------
    ZeroDivisionError
        If the rotors cannot make every thrust and torque.
    """
    mixing = mixing_rows(frame)
    square = [[_dot(a, b) for b in mixing] for a in mixing]
    solved = _solved(square, [list(column) for column in mixing])
    return [list(rotor) for rotor in zip(*solved, strict=True)]


def mixing_rows(frame: Frame) -> list[list[Fraction]]:
    """Return what T, Γ1, Γ2 and Γ3 are made of, (4, n), with lengths in the units of the frame.

    Parameters
    ----------
    frame : Frame
    """
    return [
        [Fraction(1)] * len(frame.names),
        [-y for _, y in frame.places],
        [x for x, _ in frame.places],
        list(frame.turns),
    ]


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def _solved(left: list[list[Fraction]], right: list[list[Fraction]]) -> list[list[Fraction]]:
    """Solve linear equations with several right sides, by elimination."""
    rows, n = [[*a, *b] for a, b in zip(left, right, strict=True)], len(left)
    for i in range(n):
        pivot = next((k for k in range(i, n) if rows[k][i]), i)
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [entry / rows[i][i] for entry in rows[i]]
        for k in range(n):
            if k != i:
                rows[k] = [a - rows[k][i] * b for a, b in zip(rows[k], rows[i], strict=True)]
    return [row[n:] for row in rows]
