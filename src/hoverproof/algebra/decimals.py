"""Short numbers on a chosen side of a number: decimals, and multiples of a power of two."""

from __future__ import annotations

import math
from fractions import Fraction

DIGITS = 4
"""Of a proved bound, as it is told; certificates, and objects for machines, have all."""
PI_BELOW = Fraction(314159265358979, 10**14)
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def written(value: float | Fraction, digits: int) -> str:
    """Write a number with so many significant digits: 3.488×10⁻⁵.

    Parameters
    ----------
    value : float or Fraction
    digits : int
    """
    text, _, power = f"{float(value):.{digits}g}".partition("e")
    return f"{text}×10{str(int(power)).translate(SUPERSCRIPT)}" if power else text


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


def at_least(value: float | Fraction, digits: int = DIGITS) -> str:
    """Write a proved lower bound, rounded down.

    Parameters
    ----------
    value : float or Fraction
    digits : int
    """
    return written(decimal_below(value, digits), digits)


def at_most(value: float | Fraction, digits: int = DIGITS) -> str:
    """Write a proved upper bound, rounded up.

    Parameters
    ----------
    value : float or Fraction
    digits : int
    """
    return written(decimal_above(value, digits), digits)


def degrees_at_most(angle: float | Fraction) -> str:
    """Write a proved upper bound of an angle in degrees, rounded up.

    Parameters
    ----------
    angle : float or Fraction
        Not negative, rad.
    """
    return at_most(Fraction(angle) * 180 / PI_BELOW)


def angle_at_most(angle: float | Fraction) -> str:
    """Write a proved upper bound of an angle, in radians and in degrees.

    Parameters
    ----------
    angle : float or Fraction
        Not negative, rad.
    """
    return f"{at_most(angle)} rad ({degrees_at_most(angle)}°)"


def binary_below(value: Fraction, bits: int) -> Fraction:
    """Return the largest multiple of 2^-bits that is not above a value.

    Parameters
    ----------
    value : Fraction
    bits : int
        Number of binary digits after the point.
    """
    return Fraction((value.numerator << bits) // value.denominator, 1 << bits)


def binary_above(value: Fraction, bits: int) -> Fraction:
    """Return the smallest multiple of 2^-bits that is not below a value.

    Parameters
    ----------
    value : Fraction
    bits : int
        Number of binary digits after the point.
    """
    return -binary_below(-value, bits)
