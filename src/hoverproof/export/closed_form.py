"""Expressions in the design as short rational functions: to compute on a target, and to read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from hoverproof.algebra.identity import normal_form

Terms = Mapping[tuple[int, ...], Fraction]


@dataclass(frozen=True)
class ClosedForm:
    """A quotient of polynomials, equal to an expression wherever that is defined.

    Attributes
    ----------
    value : SX
        Scalar, without the differences that cancel in the graph it came from.
    text : str
        The same in words of the design's symbols.
    """

    value: ca.SX
    text: str


def closed_forms(expressions: ca.SX) -> list[ClosedForm]:
    """Return the closed form of each entry of a column of rational expressions.

    Parameters
    ----------
    expressions : SX
        (n, 1).
    """
    symbols = ca.symvar(expressions)
    forms = []
    for (entry,) in normal_form(expressions):
        terms = entry.field.polynomials.terms
        top, top_text = _polynomial(terms(entry.numerator), symbols)
        below, below_texts = ca.SX(1), []
        for factor, power in entry.denominator:
            value, text = _polynomial(terms(factor), symbols)
            for _ in range(power):
                below = below * value
                below_texts.append(text)
        if below_texts:
            product = "*".join(sorted(below_texts))
            bottom = product if len(below_texts) == 1 else f"({product})"
            top_text = f"{top_text}/{bottom}"
        forms.append(ClosedForm(top / below, top_text))
    return forms


def _polynomial(terms: Terms, symbols: list[ca.SX]) -> tuple[ca.SX, str]:
    total, texts = ca.SX(0), []
    for powers, coefficient in sorted(terms.items(), reverse=True):
        product, names = ca.SX(1), []
        for symbol, power in zip(symbols, powers, strict=True):
            for _ in range(power):
                product = product * symbol
            names += [_name(symbol) + (f"^{power}" if power > 1 else "")] * (power > 0)
        total = total + product * coefficient.numerator / coefficient.denominator
        size = [] if abs(coefficient) == 1 and names else [str(abs(coefficient))]
        texts.append(("- " if coefficient < 0 else "+ ") + "*".join([*size, *names]))
    text = " ".join(sorted(texts, key=lambda t: t.startswith("-"))).removeprefix("+ ")
    return total, text if len(texts) == 1 else f"({text})"


def _name(symbol: ca.SX) -> str:
    """Write a symbol as the field does: ``m g I1 q1*``."""
    name = str(symbol)
    stem, _, index = name.rpartition("_")
    if stem == "goal_centroid":
        return f"q{int(index) + 1}"
    if stem == "inertia":
        return ("I1", "I2", "I3", "I12", "I13", "I23")[int(index)]
    if stem == "goal_heading":
        return ("cos(yaw*)", "sin(yaw*)")[int(index)]
    plain = {"mass": "m", "gravity": "g", "arm": "d", "drag_ratio": "kappa"}
    return plain.get(name, name.replace("rate_bandwidth", "omega_r"))
