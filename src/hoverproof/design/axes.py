"""The axes of an atlas: gains, bounds and tolerances of a mission, and their values."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from importlib.metadata import version
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.mission.fields import LEAST
from hoverproof.mission.reading import with_tolerance
from hoverproof.mission.sections import Mission
from hoverproof.mission.task import Bounds, Gains
from hoverproof.mission.tolerances import UNITS
from hoverproof.mission.uncertainty import LARGEST_SHARE
from hoverproof.servo.variables import Design
from hoverproof.simulation.record import Column, Record

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


GAINS = {
    name: Quantity(f"gains.{name}", None, Design.units()[name], f"gain {name}")
    for name in Design.chain_gains()
}
QUANTITIES = {
    **GAINS,
    "lowest_eigenvalue": Quantity("bounds.eigenvalues", 0, "1/m", "lowest eigenvalue of Q"),
    "highest_eigenvalue": Quantity("bounds.eigenvalues", 1, "1/m", "highest eigenvalue of Q"),
    "lowest_thrust": Quantity("bounds.thrust", 0, "N", "lowest thrust", "linear"),
    "highest_thrust": Quantity("bounds.thrust", 1, "N", "highest thrust", "linear"),
    "level": Quantity("bounds.level", None, "1", "level of L"),
}
"""What the theorem of the gains is mapped over."""
OF_START = GAINS | {
    name: Quantity(f"uncertainty.{name}", None, unit or "1", f"uncertainty.{name}", "linear")
    for name, unit in UNITS.items()
    if "." not in name
}
"""What the theorem of a start is mapped over."""
NOT_ASKED = -128
"""In the verdicts of a map, of a cell that was not decided exactly."""
MOST = 1e9
"""In any unit: what a gain, an eigenvalue or a level of a mission is at most."""
FACTOR, OF_START_FACTOR = 10, 3
"""By which a gain is divided and multiplied, for the ends of its range."""


@dataclass(frozen=True)
class Axis:
    """One axis of an atlas.

    Attributes
    ----------
    name : str
        One of `QUANTITIES` or `OF_START`.
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
        return {**OF_START, **QUANTITIES}[self.name]


def axis(
    mission: Mission,
    name: str,
    *,
    ends: tuple[float, float] | None = None,
    scale: Scale | None = None,
    cells: int = 200,
    option: str = "--x",
    of_start: bool = False,
) -> Axis:
    """Make an axis.

    Parameters
    ----------
    mission : Mission
    name : str
        One of `QUANTITIES`; of a start, of `OF_START`.
    ends : (low, high), optional
        Bare numbers in the unit of the quantity. By default a tenth and ten times of what the
        mission has, of a start a third and three times; for a thrust, the thrust of hover and half
        or three halves of it; for a tolerance, nothing and twice what the mission has.
    scale : str, optional
        "log" or "linear"; by default what suits the quantity.
    cells : int
        Number of values.
    option : str
        How the user calls it, for messages.
    of_start : bool
        Whether it is for a map of a start.

    Raises
    ------
    InputError
        If there is no such quantity, or its range cannot be used.
    """
    name, known = name.removeprefix("gains."), OF_START if of_start else QUANTITIES
    name = name.removeprefix("uncertainty.") if of_start else name
    if name not in known:
        raise InputError(option, "", f"must be one of {', '.join(known)}, not {name!r}")
    quantity = known[name]
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
        if not held:
            words = f"{name} cannot vary about 0: {option}-range says between what"
            raise InputError(option, "", words)
        ends = _ends(mission, name, float(held), OF_START_FACTOR if of_start else FACTOR)
    low, high = ends
    from_zero = quantity.key.startswith("uncertainty") and scale == "linear"
    least, most = (0.0, math.inf) if from_zero else (float(LEAST), MOST)
    if not least <= low < high <= most or math.isinf(high):
        within = "0 or more" if from_zero else f"from {LEAST} to {MOST:g} {quantity.unit}"
        what = f"two numbers in order, {within.removesuffix(' 1')}"
        raise InputError(f"{option}-range", "", f"must be {what}, not {low:g},{high:g}")
    line = np.geomspace(low, high, cells) if scale == "log" else np.linspace(low, high, cells)
    digits = DIGITS + max(0, math.ceil(math.log10(cells * high / (high - low))) - 3)
    made = Axis(name, np.array([float(f"{v:.{digits}g}") for v in line]), scale)
    if quantity.key.startswith("uncertainty"):
        try:
            with_value(mission, made, cells - 1)
        except InputError as error:
            raise InputError(f"{option}-range", name, error.reason) from None
    return made


def _ends(mission: Mission, name: str, held: float, factor: float) -> tuple[float, float]:
    """Return the ends of a range of which nothing is said."""
    weight = float(mission.vehicle.weight)
    special = {
        "lowest_thrust": (weight / 2, weight),
        "highest_thrust": (weight, 3 * weight / 2),
    }
    if name in OF_START and name not in GAINS:
        share = OF_START[name].unit == "1"
        return 0.0, min(2 * held, float(LARGEST_SHARE)) if share else 2 * held
    return special.get(name, (held / factor, held * factor))


def two_axes(
    mission: Mission, x: Axis | str, y: Axis | str, *, of_start: bool = False, cells: int = 200
) -> tuple[Axis, Axis]:
    """Return the axes of a map; a name stands for its default range.

    Parameters
    ----------
    mission, of_start
        See `axis`, also for what is raised.
    x, y : Axis, or str
    cells : int
        Number of values along each.
    """
    x, y = (
        one
        if isinstance(one, Axis)
        else axis(mission, one, option=option, of_start=of_start, cells=cells)
        for one, option in ((x, "--x"), (y, "--y"))
    )
    if x.name == y.name:
        raise InputError("--y", "", f"must differ from --x, {x.name}")
    return x, y


def with_value(mission: Mission, one: Axis, place: int) -> Mission:
    """Return a mission with a value of an axis, the short decimal that it is, exactly.

    Parameters
    ----------
    mission : Mission
    one : Axis
    place : int
        Number of the value.

    Raises
    ------
    InputError
        If a mission cannot have such a tolerance.
    """
    section, name = one.quantity.key.split(".")
    exact: Any = Fraction(repr(float(one.values[place])))
    if section == "uncertainty":
        return with_tolerance(mission, name, exact)
    part: Gains | Bounds = getattr(mission, section)
    if one.quantity.end is not None:
        pair = list(getattr(part, name))
        pair[one.quantity.end] = exact
        exact = tuple(pair)
    changed = part.model_copy(update={name: exact})
    return mission.model_copy(update={section: changed})


def cell_mission(mission: Mission, x: Axis, y: Axis, i: int, j: int) -> Mission:
    """Return the mission of cell (i, j), with the short decimals of the axes, exactly.

    Parameters
    ----------
    mission : Mission
    x, y : Axis
    i, j : int
        Numbers of the cell along y and along x.

    Raises
    ------
    InputError
        If a mission cannot have its tolerances.
    """
    return with_value(with_value(mission, x, j), y, i)


def map_record(
    mission: Mission,
    x: Axis,
    y: Axis,
    values: Mapping[str, NDArray[Any]],
    words: Mapping[str, tuple[str, str]],
    attrs: Mapping[str, Any],
) -> Record:
    """Return a map with names, units and axes.

    Parameters
    ----------
    mission : Mission
    x, y : Axis
    values : mapping of (m, n)
        By name, over (y, x), in the units of `words`.
    words : mapping
        By name, the unit and what it is.
    attrs : mapping
        What is true of this kind of map alone: title, the fingerprint of its model, and others.
    """
    dims = (y.name, x.name)
    return Record(
        {
            name: Column(dims, v, {"units": words[name][0], "long_name": words[name][1]})
            for name, v in values.items()
        },
        {
            one.name: Column(
                (one.name,),
                one.values,
                {"units": one.quantity.unit, "long_name": one.quantity.told(mission)},
            )
            for one in (x, y)
        },
        {
            "mission": json.dumps(mission.exact()),
            "law": mission.law.name,
            "scales": [x.scale, y.scale],
            **attrs,
            **{f"{name}_version": version(name) for name in ("hoverproof", "casadi", "numpy")},
        },
    )


def on_boundary(margin: Array) -> NDArray[np.bool_]:
    """Tell which cells have a margin, and a neighbour on whose side the sign is another.

    Parameters
    ----------
    margin : (m, n)
        Above 0 on one side, in any unit; NaN where no question is posed.
    """
    sign = np.where(np.isnan(margin), 0, np.where(margin > 0, 1, -1))
    edge = np.zeros(sign.shape, bool)
    for near, far in (
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
    ):
        turns = sign[near] * sign[far] < 0
        edge[near] |= turns
        edge[far] |= turns
    return edge
