"""How a report writes numbers, intervals and positions: bounds are rounded to where they hold."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from hoverproof.algebra import decimals
from hoverproof.algebra.decimals import DIGITS, written
from hoverproof.certification.flow import flow_of
from hoverproof.mission.sections import Mission


def short(value: float | Fraction, digits: int = DIGITS) -> str:
    """Write a number with so many digits: 3.488×10⁻⁴.

    Parameters
    ----------
    value : float or Fraction
        Any number.
    digits : int
        Number of digits.
    """
    return written(value, digits).replace("-", "−")


def at_least(value: float | Fraction, digits: int = DIGITS) -> str:
    """Write a proved lower bound, rounded down.

    Parameters
    ----------
    value : float or Fraction
        Any number.
    digits : int
        Number of digits.
    """
    return decimals.at_least(value, digits).replace("-", "−")


def at_most(value: float | Fraction, digits: int = DIGITS) -> str:
    """Write a proved upper bound, rounded up.

    Parameters
    ----------
    value : float or Fraction
        Any number.
    digits : int
        Number of digits.
    """
    return decimals.at_most(value, digits).replace("-", "−")


def interval(ends: Sequence[float | Fraction]) -> str:
    """Write an interval.

    Parameters
    ----------
    ends : (low, high)
        Any numbers.
    """
    return f"{short(ends[0], 6)} to {short(ends[1], 6)}"


def inside(ends: Sequence[Fraction]) -> str:
    """Write an interval over which something is proved, rounded inward.

    Parameters
    ----------
    ends : (low, high)
        Any numbers.
    """
    return f"{at_most(ends[0], 6)} to {at_least(ends[1], 6)}"


def bounded(mission: Mission, bounds: Sequence[float | Fraction], rounding: str = "") -> str:
    """Write bounds of Q, or of J.

    Parameters
    ----------
    mission : Mission
    bounds : (low, high)
        1/m.
    rounding : "inward", "outward" or ""
    """
    low, high = (Fraction(end) for end in bounds)
    if flow_of(mission).symbol == "Q":
        if rounding == "outward":
            return f"{at_least(low)} to {at_most(high)} 1/m"
        return f"{(inside if rounding else interval)((low, high))} 1/m"
    middle = Fraction(f"{float(low + high) / 2:.6g}")
    least, most = sorted((high - middle, middle - low))
    reach = {"inward": at_least(least, 6), "outward": at_most(most)}.get(rounding)
    return f"|J − {short(middle, 6)} I| ≤ {reach or short(most, 6)} 1/m"


def place(position: Sequence[float | Fraction]) -> str:
    """Write a position.

    Parameters
    ----------
    position : (3,)
        m.
    """
    return "(" + ",\u00a0".join(short(round(float(c), 4) + 0.0) for c in position) + ")\u00a0m"
