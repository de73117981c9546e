"""Rational functions over Q in several variables, with adjoined square roots.

A number type for `hoverproof.algebra.graph.evaluate`: running a graph over it gives the normal
form of every output, and an output is identically zero iff its numerator is the zero polynomial.
"""

from __future__ import annotations

import importlib
import importlib.util
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

Poly = Any  # a polynomial of the library in use: it knows + - * ** divmod == len degrees
Terms = Mapping[tuple[int, ...], Fraction]  # exponents to coefficient
Factors = tuple[tuple[Poly, int], ...]  # distinct monic polynomials and their exponents


@dataclass(frozen=True)
class Polynomials:
    """A polynomial ring Q[x₁…xₙ]: the little that its libraries spell differently.

    Attributes
    ----------
    generators : tuple of n polynomials
    of_terms, terms : callable
        From and to a mapping of exponents to coefficient.
    squarefree : callable
        Coefficient and factors (polynomial, exponent) of a polynomial.
    """

    generators: tuple[Poly, ...]
    of_terms: Callable[[Terms], Poly]
    terms: Callable[[Poly], Terms]
    squarefree: Callable[[Poly], tuple[Any, list[tuple[Poly, int]]]]

    @classmethod
    def over(cls, names: Sequence[str], backend: str | None = None) -> Polynomials:
        """Return the ring in variables of these distinct names.

        Parameters
        ----------
        names : (n,) str
        backend : {"flint", "sympy"}, optional
            The library that computes; by default python-flint if it is there, otherwise sympy.
        """
        backend = backend or ("flint" if importlib.util.find_spec("flint") else "sympy")
        if backend == "flint":
            flint = importlib.import_module("flint")
            ring = flint.fmpq_mpoly_ctx.get(tuple(names), flint.Ordering.lex)
            rational, squarefree = flint.fmpq, flint.fmpq_mpoly.factor_squarefree
            generators, to_dict = ring.gens(), flint.fmpq_mpoly.to_dict
        else:
            sympy, rings = importlib.import_module("sympy"), importlib.import_module("sympy.polys")
            ring = rings.ring([sympy.Symbol(name) for name in names], sympy.QQ)[0]
            rational, squarefree = sympy.QQ, lambda p: p.sqf_list()
            generators, to_dict = ring.gens, dict

        def of_terms(terms: Terms) -> Poly:
            return ring.from_dict(
                {e: rational(c.numerator, c.denominator) for e, c in terms.items()}
            )

        def terms(p: Poly) -> Terms:
            return {e: _fraction(c) for e, c in to_dict(p).items()}

        return cls(tuple(generators), of_terms, terms, squarefree)


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
        """Return a rational number as an element."""
        exponents = (0,) * len(self.polynomials.generators)
        terms = {exponents: Fraction(value)} if value != 0 else {}
        return Rational(self, self.polynomials.of_terms(terms), (), 1)

    def variables(self) -> list[Rational]:
        """Return the n variables as elements."""
        found = [Rational(self, x, (), 1) for x in self.polynomials.generators]
        for root in self.roots:
            found[root.index] = replace(root.value, field=self)
        return found

    def with_root(self, index: int, radicand: Rational) -> Field:
        """Return the field in which variable `index` is the square root ≥ 0 of an element."""
        one = self.constant(1).numerator
        scale = _product(one, radicand.denominator)
        square = self.reduced(radicand.numerator * scale)
        value = Rational(self, self.polynomials.generators[index], radicand.denominator, 1)
        return replace(self, roots=(*self.roots, Root(index, square, scale, radicand, value)))

    def reduced(self, p: Poly) -> Poly:
        """Return the polynomial with every R² replaced, so that no root is left squared."""
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
        """Return (p·c, c), c the product of conjugates that makes p·c free of roots."""
        cofactor = self.constant(1).numerator
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
        """Return the square root ≥ 0: a declared root, or of an obvious square.

        Raises
        ------
        NotImplementedError
            If it is neither; √x² = |x| is not, for the sign of x is not known.
        """
        for root in self.field.roots:
            if self == root.radicand:
                return replace(root.value, field=self.field)
        if self.is_zero():
            return self
        polynomials = self.field.polynomials
        coefficient, factors = polynomials.squarefree(self.numerator)
        c = _fraction(coefficient)
        above, below = math.isqrt(abs(c.numerator)), math.isqrt(c.denominator)
        obvious = Fraction(above**2, below**2) == c and all(
            k % 4 == 0 or (k % 2 == 0 and _is_positive(polynomials.terms(f)))
            for f, k in (*factors, *self.denominator)
        )
        if not obvious:
            raise NotImplementedError(f"square root of an undeclared radicand: {self}")
        one = self.field.constant(Fraction(above, below)).numerator
        top = _product(one, ((f, k // 2) for f, k in factors))
        return replace(
            self, numerator=top, denominator=tuple((f, k // 2) for f, k in self.denominator)
        )

    def at(self, values: Sequence[Fraction]) -> Fraction:
        """Return the value at a point, (n,), which gives roots their value, too."""
        terms, x = self.field.polynomials.terms, list(values)
        for root in self.field.roots:
            x[root.index] *= _value(terms(root.scale), values)
        below = math.prod(
            (_value(terms(f), x) ** k for f, k in self.denominator), start=Fraction(1)
        )
        return _value(terms(self.numerator), x) / below

    def __str__(self) -> str:
        below = "".join(f" / ({f})^{k}" for f, k in self.denominator)
        return f"({self.numerator}){below}"


def _element(a: Rational, b: Rational, top: Poly, below: Factors) -> Rational:
    """Return top/below as a result of a and b, factors that divide the numerator cancelled."""
    size = max(a.size, b.size, len(top))
    if top == 0:
        return Rational(a.field, top, (), size)
    kept = []
    for f, k in below:
        top, left = _divided(top, f, k)
        if left:
            kept.append((f, left))
    return Rational(a.field, top, tuple(kept), size)


def _divided(p: Poly, f: Poly, times: int) -> tuple[Poly, int]:
    """Divide p by f as often as it goes, at most `times`; also return how often it did not go."""
    while times:
        quotient, rest = divmod(p, f)
        if rest != 0:
            break
        p, times = quotient, times - 1
    return p, times


def _factors(polynomials: Polynomials, p: Poly, known: Iterable[Poly]) -> tuple[Poly, Factors]:
    """Return the (c, factors) of 1/p = c/product: known factors, variables and what is left."""
    found = []
    terms = polynomials.terms(p)
    lowest = [min(exponents) for exponents in zip(*terms, strict=True)]
    for x, k in zip(polynomials.generators, lowest, strict=True):
        if k:
            found.append((x, k))
            p, _ = _divided(p, x, k)
    for f in known:
        if len(f) > 1:
            most = p.degrees()
            limit = max(most, default=0)
            p, left = _divided(p, f, limit)
            if left < limit:
                found.append((f, limit - left))
    terms = polynomials.terms(p)
    lead = terms[max(terms)]
    scale = polynomials.of_terms({(0,) * len(polynomials.generators): 1 / lead})
    if len(terms) > 1:
        found.append((p * scale, 1))
    return scale, tuple(found)


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


def _fraction(c: Any) -> Fraction:
    return Fraction(int(c.numerator), int(c.denominator))


def _is_positive(terms: Terms) -> bool:
    """Tell whether only even powers with positive coefficients occur."""
    return all(c > 0 and not any(k % 2 for k in e) for e, c in terms.items())


def _value(terms: Terms, x: Sequence[Fraction]) -> Fraction:
    return sum(
        (c * math.prod(v**k for v, k in zip(x, e, strict=True) if k) for e, c in terms.items()),
        Fraction(0),
    )
