"""Formulas in the paper's own symbols: one object that is shown, valued and checked for units.

A formula is a small tree. It prints itself as text and as LaTeX, gives its CasADi value in a world
(a mapping from symbol names to SX), and knows the physical unit that it has.
"""

# ruff: noqa: D102 - the nodes' methods are documented once, in Formula

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from hoverproof.algebra.decimals import SUPERSCRIPT
from hoverproof.paper.units import Unit, UnitError

World = Mapping[str, ca.SX]


class Formula(ABC):
    """A node of a formula; the operators build new nodes."""

    level: int = 3  # how tightly the node binds: 0 sum, 1 product or quotient, 2 power, 3 atom

    @abstractmethod
    def value(self, world: World) -> ca.SX:
        """Return the value in a world; a KeyError names a symbol that the world lacks.

        Parameters
        ----------
        world : mapping of str to SX
            Symbols by name.
        """

    @abstractmethod
    def unit(self) -> Unit:
        """Return the physical unit; raises UnitError if the parts do not fit together."""

    @abstractmethod
    def text(self) -> str:
        """Return the formula as plain text."""

    @abstractmethod
    def latex(self) -> str:
        """Return the formula as LaTeX."""

    def __add__(self, other: Formula) -> Formula:
        return Sum((*terms(self), *terms(other)))

    def __sub__(self, other: Formula) -> Formula:
        return self + -other

    def __neg__(self) -> Formula:
        return Sum(tuple((-sign, term) for sign, term in terms(self)))

    def __mul__(self, other: Formula) -> Formula:
        signed = terms(self)
        if len(signed) == 1 and signed[0][0] < 0:  # -a * b is -(a b)
            return -(signed[0][1] * other)
        return Product((*factors(self), *factors(other)))

    def __truediv__(self, other: Formula) -> Formula:
        return Quotient(self, other)

    def __pow__(self, exponent: int) -> Formula:
        return Power(self, exponent)

    @property
    def T(self) -> Formula:
        """The transpose."""
        return Transpose(self)


def terms(formula: Formula) -> tuple[tuple[int, Formula], ...]:
    """Return the signed terms of a sum; a formula that is no sum is its only term.

    Parameters
    ----------
    formula : Formula
    """
    return formula.signed if isinstance(formula, Sum) else ((1, formula),)


def factors(formula: Formula) -> tuple[Formula, ...]:
    """Return the factors of a product; a formula that is no product is its only factor.

    Parameters
    ----------
    formula : Formula
    """
    return formula.parts if isinstance(formula, Product) else (formula,)


def bracketed(formula: Formula, level: int, show: str) -> str:
    """Show a formula inside one that binds at a level, in brackets if need be.

    Parameters
    ----------
    formula : Formula
    level : int
        A number; see `Formula.level`.
    show : "text" or "latex"
    """
    shown = formula.latex() if show == "latex" else formula.text()
    if formula.level >= level:
        return shown
    return rf"\left({shown}\right)" if show == "latex" else f"({shown})"


def _latex_base(formula: Formula) -> str:
    """Return a formula to be raised: in braces if it has a superscript, as LaTeX takes but one."""
    base = bracketed(formula, 3, "latex")
    return f"{{{base}}}" if "^" in base else base


@dataclass(frozen=True)
class Symbol(Formula):
    """A symbol of the paper, looked up in the world by its text.

    Attributes
    ----------
    name : str
        As text.
    tex : str
        As LaTeX.
    dimension : Unit
    """

    name: str
    tex: str
    dimension: Unit

    def value(self, world: World) -> ca.SX:
        return world[self.name]

    def unit(self) -> Unit:
        return self.dimension

    def text(self) -> str:
        return self.name

    def latex(self) -> str:
        return self.tex


@dataclass(frozen=True)
class Number(Formula):
    """An exact number.

    Attributes
    ----------
    number : Fraction
        An exact number.
    """

    number: Fraction

    def value(self, world: World) -> ca.SX:
        return ca.SX(self.number.numerator) / self.number.denominator

    def unit(self) -> Unit:
        return Unit()

    def text(self) -> str:
        return {Fraction(1, 2): "½"}.get(self.number, str(self.number))

    def latex(self) -> str:
        if self.number.denominator == 1:
            return str(self.number)
        return rf"\frac{{{self.number.numerator}}}{{{self.number.denominator}}}"


@dataclass(frozen=True)
class Sum(Formula):
    """Signed terms; all must have one unit.

    Attributes
    ----------
    signed : tuple of (sign, Formula)
        Each sign is the number 1 or -1.
    """

    signed: tuple[tuple[int, Formula], ...]
    level = 0

    def value(self, world: World) -> ca.SX:
        total: ca.SX = ca.SX(0)
        for sign, term in self.signed:
            total = total + term.value(world) if sign > 0 else total - term.value(world)
        return total

    def unit(self) -> Unit:
        first, *others = (term for _, term in self.signed)
        for term in others:
            if term.unit() != first.unit():
                raise UnitError(
                    f"{first.text()} is in {first.unit()} but {term.text()} in {term.unit()}"
                )
        return first.unit()

    def _show(self, show: str) -> str:
        shown = ""
        for sign, term in self.signed:
            mark = ("- " if sign < 0 else "+ ") if shown else ("-" if sign < 0 else "")
            shown += f"{' ' if shown else ''}{mark}{bracketed(term, 1, show)}"
        return shown or "0"

    def text(self) -> str:
        return self._show("text")

    def latex(self) -> str:
        return self._show("latex")


@dataclass(frozen=True)
class Product(Formula):
    """A product of scalars, matrices and vectors, in this order.

    Attributes
    ----------
    parts : tuple of Formula
    """

    parts: tuple[Formula, ...]
    level = 1

    def value(self, world: World) -> ca.SX:
        total = self.parts[0].value(world)
        for part in self.parts[1:]:
            other = part.value(world)
            scalar = total.is_scalar() or other.is_scalar()
            total = total * other if scalar else total @ other
        return total

    def unit(self) -> Unit:
        total = Unit()
        for part in self.parts:
            total = total * part.unit()
        return total

    def text(self) -> str:
        shown = [
            f"({p.text()})" if isinstance(p, Quotient) else bracketed(p, 2, "text")
            for p in self.parts
        ]
        return " ".join(shown)

    def latex(self) -> str:
        return " ".join(
            p.latex() if isinstance(p, Quotient) else bracketed(p, 2, "latex") for p in self.parts
        )


@dataclass(frozen=True)
class Quotient(Formula):
    """One formula over a scalar one.

    Attributes
    ----------
    above, below : Formula
    """

    above: Formula
    below: Formula
    level = 1

    def value(self, world: World) -> ca.SX:
        return self.above.value(world) / self.below.value(world)

    def unit(self) -> Unit:
        return self.above.unit() / self.below.unit()

    def text(self) -> str:
        below = bracketed(self.below, 2, "text")
        return f"{bracketed(self.above, 1, 'text')}/{below}"

    def latex(self) -> str:
        return rf"\frac{{{self.above.latex()}}}{{{self.below.latex()}}}"


@dataclass(frozen=True)
class Power(Formula):
    """A scalar to a whole power.

    Attributes
    ----------
    base : Formula
    exponent : int
        A number.
    """

    base: Formula
    exponent: int
    level = 2

    def value(self, world: World) -> ca.SX:
        return self.base.value(world) ** self.exponent

    def unit(self) -> Unit:
        return self.base.unit() ** self.exponent

    def text(self) -> str:
        return f"{bracketed(self.base, 3, 'text')}{str(self.exponent).translate(SUPERSCRIPT)}"

    def latex(self) -> str:
        return f"{_latex_base(self.base)}^{{{self.exponent}}}"


@dataclass(frozen=True)
class Skew(Formula):
    """sk(a), the matrix of the cross product with a.

    Attributes
    ----------
    of : Formula
    """

    of: Formula

    def value(self, world: World) -> ca.SX:
        return ca.skew(self.of.value(world))

    def unit(self) -> Unit:
        return self.of.unit()

    def text(self) -> str:
        return f"sk({self.of.text()})"

    def latex(self) -> str:
        return rf"\mathrm{{sk}}\left({self.of.latex()}\right)"


@dataclass(frozen=True)
class Transpose(Formula):
    """The transpose of a vector or matrix.

    Attributes
    ----------
    of : Formula
    """

    of: Formula

    def value(self, world: World) -> ca.SX:
        return self.of.value(world).T

    def unit(self) -> Unit:
        return self.of.unit()

    def text(self) -> str:
        return f"{bracketed(self.of, 3, 'text')}ᵀ"

    def latex(self) -> str:
        return f"{_latex_base(self.of)}^T"


@dataclass(frozen=True)
class SquaredNorm(Formula):
    """|a|² of a vector.

    Attributes
    ----------
    of : Formula
    """

    of: Formula

    def value(self, world: World) -> ca.SX:
        a = self.of.value(world)
        return ca.dot(a, a)

    def unit(self) -> Unit:
        return self.of.unit() ** 2

    def text(self) -> str:
        return f"|{self.of.text()}|²"

    def latex(self) -> str:
        return rf"\left|{self.of.latex()}\right|^2"
