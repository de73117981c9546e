"""What is found about one assumption."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDING = 1e-9
"""What is less, in any unit, is the rounding of computers."""


@dataclass(frozen=True, eq=False)
class Finding:
    """An assumption, held against a log.

    Attributes
    ----------
    name : str
        In words.
    key : str
        Of `[uncertainty]`, by which it could be covered; empty if by none.
    held : bool or None
        None if the log does not tell.
    value, bound : float
        What was found at the worst, and what is assumed: dimensionless, or rad/s and
        the like, as `unit` says.
    unit : str
    deviation : float
        One standard deviation of the value: dimensionless, or rad/s and the like.
    at : float or None
        When it first broke, s.
    words : str
        What was found, for people; or why it is not told.
    times, values : (k,)
        Over time, s and any unit; for a picture.
    needed : float
        What the tolerance would have to be, dimensionless or as `unit` says, s for one; not a
        number if that is the value.
    follows : bool
        Whether it is what is proved, which breaks only if something that is assumed does.
    """

    name: str
    key: str = ""
    held: bool | None = None
    value: float = float("nan")
    bound: float = float("nan")
    unit: str = "1"
    deviation: float = float("nan")
    at: float | None = None
    words: str = ""
    times: Array | None = None
    values: Array | None = None
    needed: float = float("nan")
    follows: bool = False

    @property
    def margin(self) -> float:
        """What is left up to the bound, in the unit; below 0 if it is broken."""
        return self.bound - self.value

    @property
    def found(self) -> str:
        """The value with its error bar and unit, in the digits that the bound gives sense to."""
        spread = _digits(self.deviation, self._scale, 1)
        bar = "" if spread in ("nan", "inf", "0") else f" ± {spread}"
        return f"{_digits(self.value, self._scale)}{bar}{self._unit}"

    @property
    def assumed(self) -> str:
        """The bound with its unit."""
        return f"{_digits(self.bound, self._scale)}{self._unit}"

    @property
    def beyond(self) -> str:
        """By how much the value is above the bound, with the unit."""
        return f"{_digits(-self.margin, self._scale)}{self._unit}"

    @property
    def _unit(self) -> str:
        return "" if self.unit == "1" else f" {self.unit}"

    @property
    def _scale(self) -> float:
        return max(abs(self.bound), abs(self.value) if abs(self.value) > ROUNDING else 0.0)

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines, without what is over time."""

        def plain(x: float | None) -> float | None:
            return None if x is None or not np.isfinite(x) else float(x)

        return {
            "name": self.name,
            "follows": self.follows,
            "key": self.key or None,
            "held": self.held,
            "value": plain(self.value),
            "deviation": plain(self.deviation),
            "bound": plain(self.bound),
            "margin": plain(self.margin),
            "unit": self.unit,
            "broken_at": plain(self.at),
            "words": self.words,
        }


def _digits(value: float, scale: float, digits: int = 4) -> str:
    """Write a number without what is below a ten-thousandth of a scale."""
    if not math.isfinite(value) or scale <= 0:
        return f"{value:.{digits}g}"
    places = 3 - math.floor(math.log10(scale))
    return f"{round(value, places) + 0.0:.{digits}g}"


def untold(name: str, why: str) -> Finding:
    """Return that a log does not tell of an assumption.

    Parameters
    ----------
    name, why : str
    """
    return Finding(name, words=why)


def over_time(
    name: str, key: str, times: Array, values: Array, bound: float, unit: str, **more: Any
) -> Finding:
    """Return whether what is assumed to be at most so much was so at all times.

    Parameters
    ----------
    name, key : str
    times, values : (k,)
        s, and dimensionless or in any unit.
    bound : float
        Dimensionless, or in the unit of the values, rad/s for one.
    unit : str
    **more
        Further attributes; `allowed` (k,) or bare, in the unit, is what counts as broken only if it
        is above the bound by more.
    """
    allowed = more.pop("allowed", 0.0)
    known = np.isfinite(values)
    times, values = times[known], values[known]
    allowed = allowed[known] if isinstance(allowed, np.ndarray) else allowed
    if not len(times):
        return untold(name, "the log has no number of it")
    broken = values > bound + np.maximum(allowed, 1e-9 * abs(bound))
    first = float(times[broken.argmax()]) if broken.any() else None
    worst = int(np.argmax(values - allowed))
    return Finding(
        name,
        key,
        first is None,
        float(values[worst]),
        bound,
        unit,
        at=first,
        times=times,
        values=values,
        **more,
    )
