"""Short decimals on a chosen side of a number."""

from __future__ import annotations

import math
from fractions import Fraction


def decimal_below(value: float | Fraction, digits: int) -> Fraction:
    """Return the largest decimal of so many significant digits that is not above a value.

    Parameters
    ----------
    value : float or Fraction
    digits : int
    """
    if value == 0:
        return Fraction(0)
    places = digits - 1 - math.floor(math.log10(abs(float(value))))
    scale = Fraction(10) ** places
    return Fraction(value) * scale // 1 / scale


def decimal_above(value: float | Fraction, digits: int) -> Fraction:
    """Return the smallest decimal of so many significant digits that is not below a value.

    Parameters
    ----------
    value : float or Fraction
    digits : int
    """
    return -decimal_below(-value, digits)
