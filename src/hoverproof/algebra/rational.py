"""Rational functions over Q in several variables, with adjoined square roots.

A number type for `hoverproof.algebra.graph.evaluate`: running a graph over it gives the normal
form of every output, and an output is identically zero iff its numerator is the zero polynomial.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpq_mpoly_ctx

Poly = Any  # fmpq_mpoly
Terms = Mapping[tuple[int, ...], Fraction]  # exponents to coefficient
Factors = tuple[tuple[Poly, int], ...]  # distinct monic polynomials and their exponents


@dataclass(frozen=True)
class Polynomials:
    """A polynomial ring Q[x₁…xₙ] of python-flint, with coefficients that are Fractions.

    Attributes
    ----------
    context : fmpq_mpoly_ctx
    """

    context: fmpq_mpoly_ctx

    @classmethod
    def over(cls, names: Sequence[str]) -> Polynomials:
        """Return the ring in variables of these distinct names.

        Parameters
        ----------
        names : (n,) str
        """
        return cls(fmpq_mpoly_ctx.get(tuple(names), "lex"))

    @property
    def generators(self) -> tuple[Poly, ...]:
        """The variables."""
        return self.context.gens()

    def of_terms(self, terms: Terms) -> Poly:
        """Return a polynomial of a mapping of exponents to coefficient.

        Parameters
        ----------
        terms : mapping
        """
        return self.context.from_dict(
            {e: fmpq(c.numerator, c.denominator) for e, c in terms.items()}
        )

    def terms(self, p: Poly) -> Terms:
        """Return a mapping of exponents to coefficient.

        Parameters
        ----------
        p : polynomial
        """
        return {
            tuple(map(int, e)): Fraction(int(c.numerator), int(c.denominator))
            for e, c in p.to_dict().items()
        }

    def quotient(self, p: Poly, f: Poly) -> Poly | None:
        """Return p/f if f divides p, otherwise None.

        Parameters
        ----------
        p, f : polynomials
        """
        quotient, rest = divmod(p, f)
        return quotient if rest == 0 else None

    def constant(self, value: Fraction | int) -> Poly:
        """Return a number as a polynomial.

        Parameters
        ----------
        value : Fraction or int
        """
        return self.of_terms({(0,) * len(self.generators): Fraction(value)} if value else {})


@dataclass(frozen=True)
class Root:
    """An adjoined square root r of a rational function s = n/d, as the generator R = r·d.

    Attributes
    ----------
    index : int
        Which generator R is.
    square : polynomial
        R² = n·d, free of R and of the roots declared later.
    scale : polynomial
        d.
    radicand, value : Rational
        s and r.
    """

    index: int
    square: Poly
    scale: Poly
    radicand: Rational
    value: Rational


@dataclass(frozen=True)
class Field:
    """The rational functions in named variables, some of which may be roots of others.

    Attributes
    ----------
    polynomials : Polynomials
    roots : tuple of Root
        In the order of declaration.
    """

    polynomials: Polynomials
    roots: tuple[Root, ...] = ()

    def constant(self, value: Fraction | int) -> Rational:
        """Return a rational number as an element.

        Parameters
        ----------
        value : Fraction or int
        """
        return Rational(self, self.polynomials.constant(value), (), 1)

    def variables(self) -> list[Rational]:
        """Return the n variables as elements."""
        found = [Rational(self, x, (), 1) for x in self.polynomials.generators]
        for root in self.roots:
            found[root.index] = replace(root.value, field=self)
        return found

    def with_root(self, index: int, radicand: Rational) -> Field:
        """Return the field in which variable `index` is the square root ≥ 0 of an element.

        Parameters
        ----------
        index : int
            Position of the variable.
        radicand : Rational
            The element; only roots declared earlier may be in it.
        """
        scale = _product(self.polynomials.constant(1), radicand.denominator)
        square = self.reduced(radicand.numerator * scale)
        value = Rational(self, self.polynomials.generators[index], radicand.denominator, 1)
        return replace(self, roots=(*self.roots, Root(index, square, scale, radicand, value)))

    def reduced(self, p: Poly) -> Poly:
        """Return the polynomial with every R² replaced, so that no root is left squared.

        Parameters
        ----------
        p : polynomial
        """
        for root in reversed(self.roots):  # a square may contain earlier roots only
            if p.degrees()[root.index] > 1:
                parts: dict[int, dict[tuple[int, ...], Fraction]] = {}
                for e, c in self.polynomials.terms(p).items():
                    pairs, left = divmod(e[root.index], 2)
                    rest = (*e[: root.index], left, *e[root.index + 1 :])
                    parts.setdefault(pairs, {})[rest] = c
                p = sum(self.polynomials.of_terms(t) * root.square**k for k, t in parts.items())
        return p

    def rationalised(self, p: Poly) -> tuple[Poly, Poly]:
        """Return (p·c, c), c the product of conjugates that makes p·c free of roots.

        Parameters
        ----------
        p : polynomial
        """
        cofactor = self.polynomials.constant(1)
        for root in reversed(self.roots):
            if p.degrees()[root.index] > 0:
                signs = {
                    e: -c if e[root.index] else c for e, c in self.polynomials.terms(p).items()
                }
                conjugate = self.polynomials.of_terms(signs)
                p = self.reduced(p * conjugate)
                cofactor = self.reduced(cofactor * conjugate)
        return p, cofactor


@dataclass(frozen=True, eq=False)
class Rational:
    """An element of a `Field`: a numerator over a product of powers of root-free polynomials.

    The factors of the denominator stay apart, so sums take least common multiples by comparing
    them and no greatest common divisor is ever computed. Factors that happen to share a divisor
    cost size, not truth: the element is zero iff its numerator is.

    Attributes
    ----------
    field : Field
    numerator : polynomial
    denominator : tuple of (polynomial, exponent)
        Distinct, monic, free of roots, none dividing the numerator.
    size : int
        Terms of the largest numerator on the way here.
    """

    field: Field = field(repr=False)
    numerator: Poly
    denominator: Factors
    size: int

    def is_zero(self) -> bool:
        """Tell whether this is zero wherever it is defined."""
        return bool(self.numerator == 0)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, int | Fraction):
            other = self.field.constant(other)
        return (self - other).is_zero() if isinstance(other, Rational) else NotImplemented

    def __add__(self, other: Rational) -> Rational:
        a, b = self.denominator, other.denominator
        if a == b:
            return _element(self, other, self.numerator + other.numerator, a)
        common = _merge(a, b, max)
        left = _product(self.numerator, _missing(common, a))
        right = _product(other.numerator, _missing(common, b))
        return _element(self, other, left + right, common)

    def __neg__(self) -> Rational:
        return replace(self, numerator=-self.numerator)

    def __sub__(self, other: Rational) -> Rational:
        return self + -other

    def __mul__(self, other: Rational) -> Rational:
        top = self.field.reduced(self.numerator * other.numerator)
        return _element(self, other, top, _merge(self.denominator, other.denominator, _sum))

    def __truediv__(self, other: Rational) -> Rational:
        norm, cofactor = self.field.rationalised(other.numerator)
        if norm == 0:
            raise ZeroDivisionError("division by a rational function that is identically zero")
        known = [f for f, _ in self.denominator]
        coefficient, factors = _factors(self.field.polynomials, norm, known)
        top = _product(self.numerator * cofactor, other.denominator) * coefficient
        below = _merge(self.denominator, factors, _sum)
        return _element(self, other, self.field.reduced(top), below)

    def sqrt(self) -> Rational:
        """Return the square root ≥ 0, as far as it is declared or obvious.

        Raises
        ------
        NotImplementedError
            If it is no product of a declared root, fourth powers and the square of a number;
            √x² = |x| is not, for the sign of x is not known: declare r with r² = x².
        """
        if self.is_zero():
            return self
        one = self.field.constant(1)
        for radicand, value in [(one, one), *((r.radicand, r.value) for r in self.field.roots)]:
            square = _root_of_square(self / radicand)
            if square is not None:
                return square * value
        raise NotImplementedError(f"square root of an undeclared radicand: {self}")

    def at(self, values: Sequence[Fraction]) -> Fraction:
        """Return the value at a point, (n,), which gives roots their value, too.

        Parameters
        ----------
        values : (n,) Fractions
            One for each variable; those of roots are taken as the roots.
        """
        terms, x = self.field.polynomials.terms, list(values)
        for root in self.field.roots:
            x[root.index] *= _value(terms(root.scale), values)
        below = math.prod(
            (_value(terms(f), x) ** k for f, k in self.denominator), start=Fraction(1)
        )
        return _value(terms(self.numerator), x) / below

    def polynomial(self) -> Terms:
        """Return the terms of an element that is a polynomial.

        Raises
        ------
        ValueError
            If it has a denominator.
        """
        if self.denominator:
            raise ValueError(f"not a polynomial: {self}")
        return self.field.polynomials.terms(self.numerator)

    def __str__(self) -> str:
        return f"({self.numerator})" + "".join(f"/({f})^{k}" for f, k in self.denominator)


def _element(a: Rational, b: Rational, top: Poly, below: Factors) -> Rational:
    """Return top/below as a result of a and b, factors that divide the numerator cancelled."""
    size = max(a.size, b.size, len(top))
    if top == 0:
        return Rational(a.field, top, (), size)
    kept = []
    for f, k in below:
        top, left = _divided(a.field.polynomials, top, f, k)
        if left:
            kept.append((f, left))
    return Rational(a.field, top, tuple(kept), size)


def _divided(ring: Polynomials, p: Poly, f: Poly, times: int) -> tuple[Poly, int]:
    """Divide p by f as often as it goes, at most `times`; also return how often it did not go."""
    while times and (quotient := ring.quotient(p, f)) is not None:
        p, times = quotient, times - 1
    return p, times


def _factors(ring: Polynomials, p: Poly, known: Iterable[Poly]) -> tuple[Poly, Factors]:
    """Return c and the factors of 1/p = c/∏: variables, known polynomials and what is left."""
    found = []
    most = int(max(p.degrees(), default=0))
    lowest = (min(exponents) for exponents in zip(*ring.terms(p), strict=True))
    divisors = [(x, k) for x, k in zip(ring.generators, lowest, strict=True) if k]
    for f, limit in [*divisors, *((f, most) for f in known if len(f) > 1)]:
        p, left = _divided(ring, p, f, limit)
        if left < limit:
            found.append((f, limit - left))
    terms = ring.terms(p)
    scale = ring.constant(1 / terms[max(terms)])
    if len(terms) > 1:
        found.append((p * scale, 1))
    return scale, tuple(found)


def _root_of_square(x: Rational) -> Rational | None:
    """Return the root of a square of a number and fourth powers: no other sign is known."""
    terms = x.field.polynomials.terms(x.numerator)
    ((e, c),) = terms.items() if len(terms) == 1 else [((1,), Fraction(-1))]
    if c < 0 or any(k % 4 for k in e) or any(k % 4 for _, k in x.denominator):
        return None
    root = Fraction(math.isqrt(c.numerator), math.isqrt(c.denominator))
    if root**2 != c:
        return None
    top = x.field.polynomials.of_terms({tuple(k // 2 for k in e): root})
    return replace(x, numerator=top, denominator=tuple((f, k // 2) for f, k in x.denominator))


def _merge(a: Factors, b: Factors, combine: Callable[[int, int], int]) -> Factors:
    if not a or not b:
        return a or b
    merged = list(a)
    for f, k in b:
        for i, (g, j) in enumerate(merged):
            if f == g:
                merged[i] = (g, combine(j, k))
                break
        else:
            merged.append((f, k))
    return tuple(merged)


def _sum(a: int, b: int) -> int:
    return a + b


def _missing(common: Factors, part: Factors) -> Factors:
    """Return the factors that make `part` the multiple `common` of it."""
    return tuple((f, k - sum(j for g, j in part if f == g)) for f, k in common)


def _product(p: Poly, factors: Iterable[tuple[Poly, int]]) -> Poly:
    for f, k in factors:
        if k:
            p = p * f**k
    return p


def _value(terms: Terms, x: Sequence[Fraction]) -> Fraction:
    return sum(
        (c * math.prod(v**k for v, k in zip(x, e, strict=True) if k) for e, c in terms.items()),
        Fraction(0),
    )
