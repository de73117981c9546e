"""Exact sums of square roots, and rational intervals that enclose them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

BITS = 96


def sqrt_enclosure(value: Fraction, bits: int = BITS) -> tuple[Fraction, Fraction]:
    """Return rationals ``a <= sqrt(value) <= b`` at most ``2**-bits`` apart.

    Parameters
    ----------
    value : Fraction
        Not negative.
    bits : int
        Binary digits after the point.
    """
    if value < 0:
        raise ValueError(f"square root of a negative number: {value}")
    floor = math.isqrt((value.numerator << (2 * bits)) // value.denominator)
    exact = floor * floor * value.denominator == value.numerator << (2 * bits)
    return Fraction(floor, 1 << bits), Fraction(floor if exact else floor + 1, 1 << bits)


@dataclass(frozen=True)
class Surd:
    """The number ``Σ coefficient·√radicand`` over distinct positive rational radicands.

    Attributes
    ----------
    terms : dict of Fraction to Fraction
        Radicand to coefficient; no coefficient is zero.
    """

    terms: dict[Fraction, Fraction]

    @classmethod
    def of(cls, value: Fraction | int) -> Surd:
        """Return a rational number as a surd.

        Parameters
        ----------
        value : Fraction or int
        """
        return cls._of_terms({Fraction(1): Fraction(value)})

    @classmethod
    def _of_terms(cls, terms: dict[Fraction, Fraction]) -> Surd:
        return cls({s: c for s, c in terms.items() if c != 0})

    def rational(self) -> Fraction:
        """Return the value of a surd that has no root in it.

        Raises
        ------
        NotImplementedError
            If there is a root in it.
        """
        if self.terms.keys() - {Fraction(1)}:
            raise NotImplementedError("the value is irrational")
        return self.terms.get(Fraction(1), Fraction(0))

    def __add__(self, other: Surd) -> Surd:
        terms = dict(self.terms)
        for s, c in other.terms.items():
            terms[s] = terms.get(s, Fraction(0)) + c
        return self._of_terms(terms)

    def __neg__(self) -> Surd:
        return Surd({s: -c for s, c in self.terms.items()})

    def __sub__(self, other: Surd) -> Surd:
        return self + -other

    def __mul__(self, other: Surd) -> Surd:
        total = Surd({})
        for s, c in self.terms.items():
            for r, d in other.terms.items():
                term = (Fraction(1), c * d * s) if s == r else (s * r, c * d)
                total = total + Surd._of_terms(dict([term]))
        return total

    def __truediv__(self, other: Surd) -> Surd:
        if not other.terms:
            raise ZeroDivisionError("division of a surd by zero")
        if len(other.terms) > 1:
            raise NotImplementedError("division by a sum of roots")
        ((s, c),) = other.terms.items()
        return self * Surd({s: 1 / (c * s)})

    def sqrt(self) -> Surd:
        """Return the square root of a rational surd."""
        value = self.rational()
        root, above = sqrt_enclosure(value)
        if root == above:
            return Surd.of(root)
        return Surd({value: Fraction(1)})

    def enclosure(self) -> tuple[Fraction, Fraction]:
        """Return rational bounds of the value, equal if it is rational."""
        low = high = Fraction(0)
        for s, c in self.terms.items():
            a, b = sqrt_enclosure(s)
            low += c * (a if c > 0 else b)
            high += c * (b if c > 0 else a)
        return low, high
