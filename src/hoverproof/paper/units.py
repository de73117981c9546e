"""Physical units of the paper's symbols: exponents of kilogram, metre and second."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Unit:
    """Exponents of kilogram, metre and second.

    Attributes
    ----------
    kg, m, s : Fraction
        The exponents, each a number.
    """

    kg: Fraction = Fraction(0)
    m: Fraction = Fraction(0)
    s: Fraction = Fraction(0)

    def __mul__(self, other: Unit) -> Unit:
        return Unit(self.kg + other.kg, self.m + other.m, self.s + other.s)

    def __pow__(self, exponent: Fraction | int) -> Unit:
        return Unit(self.kg * exponent, self.m * exponent, self.s * exponent)

    def __truediv__(self, other: Unit) -> Unit:
        return self * other**-1

    def __str__(self) -> str:
        parts = [("kg", self.kg), ("m", self.m), ("s", self.s)]
        return " ".join(n if e == 1 else f"{n}^{e}" for n, e in parts if e) or "1"


class UnitError(ValueError):
    """The units of a formula do not fit together."""
