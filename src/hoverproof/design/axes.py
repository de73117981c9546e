"""The axes of an atlas: gains and bounds of a mission, and the values that they take."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.servo.variables import Design

Array = NDArray[np.float64]
Scale = Literal["log", "linear"]

DIGITS = 6


@dataclass(frozen=True)
class Quantity:
    """Something that an axis of an atlas can run over.

    Attributes
    ----------
    key : str
        As in a mission file.
    end : int or None
        Which end of an interval, None if the value is a number.
    unit : str
    words : str
        What it is.
    scale : str
        The scale that suits it.
    """

    key: str
    end: int | None
    unit: str
    words: str
    scale: Scale = "log"

    def told(self, mission: Mission) -> str:
        """Return what it is in a mission, where bounds may be of J in place of Q.

        Parameters
        ----------
        mission : Mission
        """
        if self.key == "bounds.eigenvalues" and mission.law.feature == "scaled":
            return f"{('j - ϱ', 'j + ϱ')[self.end or 0]}, an end of the ball of J"
        return self.words

    def value(self, mission: Mission) -> Fraction | None:
        """Return what a mission has; None if it has another kind of bound.

        Parameters
        ----------
        mission : Mission
        """
        section, name = self.key.split(".")
        held = getattr(getattr(mission, section), name)
        if held == "auto":
            return None
        value: Fraction | None = held if held is None or self.end is None else held[self.end]
        return value


QUANTITIES = {
    **{
        name: Quantity(f"gains.{name}", None, Design.units()[name], f"gain {name}")
        for name in Design.chain_gains()
    },
    "lowest_eigenvalue": Quantity("bounds.eigenvalues", 0, "1/m", "lowest eigenvalue of Q"),
    "highest_eigenvalue": Quantity("bounds.eigenvalues", 1, "1/m", "highest eigenvalue of Q"),
    "lowest_thrust": Quantity("bounds.thrust", 0, "N", "lowest thrust", "linear"),
    "highest_thrust": Quantity("bounds.thrust", 1, "N", "highest thrust", "linear"),
    "level": Quantity("bounds.level", None, "1", "level of L"),
}


@dataclass(frozen=True)
class Axis:
    """One axis of an atlas.

    Attributes
    ----------
    name : str
        One of `QUANTITIES`.
    values : (n,)
        Short decimals, so that a cell can be decided exactly.
    scale : str
    """

    name: str
    values: Array
    scale: Scale

    @property
    def quantity(self) -> Quantity:
        """What the axis runs over."""
        return QUANTITIES[self.name]


def axis(
    mission: Mission,
    name: str,
    *,
    ends: tuple[float, float] | None = None,
    scale: Scale | None = None,
    cells: int = 200,
    option: str = "--x",
) -> Axis:
    """Make an axis.

    Parameters
    ----------
    mission : Mission
    name : str
        One of `QUANTITIES`.
    ends : (low, high), optional
        Bare numbers in the unit of the quantity. By default a tenth and ten times of what the
        mission has; for a thrust, the thrust of hover and half or three halves of it.
    scale : str, optional
        "log" or "linear"; by default what suits the quantity.
    cells : int
        Number of values.
    option : str
        How the user calls it, for messages.

    Raises
    ------
    InputError
        If there is no such quantity, or its range cannot be used.
    """
    name = name.removeprefix("gains.")
    if name not in QUANTITIES:
        raise InputError(option, "", f"must be one of {', '.join(QUANTITIES)}, not {name!r}")
    quantity = QUANTITIES[name]
    held = quantity.value(mission)
    if held is None:
        other = "bounds.level" if name.endswith("thrust") else "bounds.thrust"
        if name.endswith("eigenvalue"):
            other = '"auto" for them'
        raise InputError(option, "", f"{name} cannot vary: {mission.source} gives {other} instead")
    if not 2 <= cells <= 5000:
        raise InputError("--cells", "", f"must be from 2 to 5000, not {cells}")
    scale = scale or quantity.scale
    if ends is None:
        weight = float(mission.vehicle.weight)
        special = {
            "lowest_thrust": (weight / 2, weight),
            "highest_thrust": (weight, 3 * weight / 2),
        }
        ends = special.get(name, (float(held) / 10, float(held) * 10))
    low, high = ends
    if not 0 < low < high < math.inf:
        what = f"two numbers in order, above 0 {quantity.unit}"
        raise InputError(f"{option}-range", "", f"must be {what}, not {low:g},{high:g}")
    line = np.geomspace(low, high, cells) if scale == "log" else np.linspace(low, high, cells)
    digits = DIGITS + max(0, math.ceil(math.log10(cells * high / (high - low))) - 3)
    return Axis(name, np.array([float(f"{v:.{digits}g}") for v in line]), scale)
