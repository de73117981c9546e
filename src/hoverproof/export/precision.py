"""Numbers of a target: exact rationals rounded once, and how C writes them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np


@dataclass(frozen=True)
class Precision:
    """A floating-point type of IEEE 754.

    Attributes
    ----------
    name : str
        ``"float32"`` or ``"float64"``.
    c_type, sqrt, suffix : str
        The type in C, its square root, and the suffix of its literals.
    digits : int
        Binary digits of the significand.
    lowest_exponent : int
        Exponent of the smallest normal number, 2**lowest_exponent.
    """

    name: str
    c_type: str
    sqrt: str
    suffix: str
    digits: int
    lowest_exponent: int

    @property
    def scalar(self) -> type[np.floating]:
        """The numpy type."""
        return np.float32 if self.name == "float32" else np.float64

    def round(self, value: Fraction) -> np.floating:
        """Return the nearest number of this type, ties to even: rounded once, from the exact value.

        Parameters
        ----------
        value : Fraction
            Any exact number.

        Raises
        ------
        OverflowError
            If the value is too large for the type.
        """
        if value == 0:
            return self.scalar(0)
        size = abs(value)
        exponent = size.numerator.bit_length() - size.denominator.bit_length()
        if Fraction(2) ** exponent > size:
            exponent -= 1
        unit = Fraction(2) ** (max(exponent, self.lowest_exponent) - self.digits + 1)
        rounded = float(round(value / unit) * unit)  # exact: float64 holds every number of the type
        with np.errstate(over="ignore"):
            result = self.scalar(rounded)
        if not np.isfinite(result):
            raise OverflowError(f"{rounded:g} does not fit {self.name}")
        return result

    def literal(self, value: Fraction | np.floating) -> str:
        """Return the shortest decimal literal of C that reads back as the value, rounded once.

        Parameters
        ----------
        value : Fraction or numpy.floating
            An exact number, or one of this type.
        """
        number = self.round(value) if isinstance(value, Fraction) else value
        text = np.format_float_positional(number, unique=True, trim="0")
        if len(text) > 16:
            text = np.format_float_scientific(number, unique=True, trim="0")
        return text + self.suffix

    def lit(self, value: Fraction | int | str) -> str:
        """Return the literal of an exact number; short, for the templates.

        Parameters
        ----------
        value : Fraction, int, or str
            An exact number; a str is a decimal.
        """
        return self.literal(Fraction(value))

    def braces(self, values: Iterable[Fraction | int]) -> str:
        """Return the literals of exact numbers, as C fills an array with them.

        Parameters
        ----------
        values : iterable of Fraction or int
            Exact numbers.
        """
        return "{ " + ", ".join(map(self.lit, values)) + " }"

    def hex_literal(self, value: np.floating) -> str:
        """Return a hexadecimal literal of C, bit for bit.

        Parameters
        ----------
        value : numpy.floating
            A number of this type.
        """
        return float(value).hex() + self.suffix


FLOAT32 = Precision("float32", "float", "sqrtf", "F", 24, -126)
FLOAT64 = Precision("float64", "double", "sqrt", "", 53, -1022)
PRECISIONS = {p.name: p for p in (FLOAT32, FLOAT64)}


class Rounded:
    """A number of a precision that computes as the target does: every operation rounded once.

    Parameters
    ----------
    value : numpy.floating
        A number of that precision.
    """

    __slots__ = ("value",)

    def __init__(self, value: np.floating) -> None:
        self.value = value

    def __add__(self, other: Rounded) -> Rounded:
        return Rounded(self.value + other.value)

    def __sub__(self, other: Rounded) -> Rounded:
        return Rounded(self.value - other.value)

    def __mul__(self, other: Rounded) -> Rounded:
        return Rounded(self.value * other.value)

    def __truediv__(self, other: Rounded) -> Rounded:
        return Rounded(self.value / other.value)

    def __neg__(self) -> Rounded:
        return Rounded(-self.value)

    def sqrt(self) -> Rounded:
        """Return the square root, correctly rounded as IEEE 754 has it."""
        return Rounded(np.sqrt(self.value))
