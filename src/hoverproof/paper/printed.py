"""An equation as the paper prints it: shown, checked for units, and compared with another."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from hoverproof.paper.notation import Formula, Number, bracketed, terms
from hoverproof.paper.units import UnitError


@dataclass(frozen=True)
class Equation:
    """Two formulas that are said to be equal (or ordered, where a relation is given).

    Attributes
    ----------
    left, right : Formula
    relation : str
        What stands between them, as text.
    """

    left: Formula
    right: Formula
    relation: str = "="

    def text(self) -> str:
        """Return the equation as plain text."""
        return f"{self.left.text()} {self.relation} {self.right.text()}"

    def latex(self) -> str:
        """Return the equation as LaTeX."""
        relation = {"≤": r"\le", "≥": r"\ge", "⪰": r"\succeq"}.get(self.relation, self.relation)
        return f"{self.left.latex()} {relation} {self.right.latex()}"

    def unit_fault(self) -> str:
        """Return what is wrong with the units, empty if nothing is."""
        try:
            left = self.left.unit()
            right = left if self.right == Number(Fraction(0)) else self.right.unit()
        except UnitError as error:
            return str(error)
        return "" if left == right else f"the left side is in {left}, the right side in {right}"

    def difference(self, other: Equation) -> tuple[list[str], list[str]]:
        """Return the terms that only this right side has, and those that only the other has.

        Parameters
        ----------
        other : Equation
        """
        mine = [_signed(t) for t in terms(self.right)]
        others = [_signed(t) for t in terms(other.right)]
        for shown in list(mine):
            if shown in others:
                mine.remove(shown)
                others.remove(shown)
        return mine, others


def _signed(term: tuple[int, Formula]) -> str:
    sign, formula = term
    return f"{'-' if sign < 0 else '+'} {bracketed(formula, 1, 'text')}"
