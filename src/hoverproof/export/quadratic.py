"""Short evaluation schemes of quadratic polynomials, their coefficients known exactly.

The control law is rational; written as a chain of quadratic polynomials it takes few operations.
Every coefficient is derived from the law by differentiation, so no formula is typed again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import casadi as ca

from hoverproof.algebra.graph import evaluate

Values = tuple[Fraction, ...]


@dataclass
class Coefficients:
    """The numbers of a scheme: named symbols with their expressions in the design.

    Attributes
    ----------
    design : SX
        Symbols of the design, (k, 1).
    samples : list of lists of Fractions
        Designs at which coefficients are compared; the first is the one of the mission. What is 0,
        ±1 or ±2, or the same as another up to its sign, in all of them needs no number of its own.
    expressions : dict of str to SX
        Name to expression in `design`, a scalar.
    symbols : dict of str to SX
        Name to the symbol, a scalar, that stands for it in the scheme.
    """

    design: ca.SX
    samples: Sequence[Sequence[Fraction]]
    expressions: dict[str, ca.SX] = field(default_factory=dict)
    symbols: dict[str, ca.SX] = field(default_factory=dict)
    _known: dict[Values, ca.SX] = field(default_factory=dict)

    def at_samples(self, expressions: ca.SX) -> list[Values]:
        """Return the exact values of a column of expressions, one tuple over the samples each.

        Parameters
        ----------
        expressions : SX
            In `design`, (n, 1).
        """
        look = ca.Function("look", [self.design], [ca.densify(expressions)])
        columns = [evaluate(look, [sample])[0] for sample in self.samples]
        return [tuple(c[i][0] for c in columns) for i in range(expressions.shape[0])]

    def times(self, values: Values, expression: ca.SX, name: str, factor: ca.SX) -> _Term:
        """Return a coefficient times a factor, with the sign set apart.

        Parameters
        ----------
        values : tuple of Fractions
            The coefficient at each sample, exact numbers.
        expression : SX
            The coefficient in `design`, a scalar.
        name : str
            For its symbol, if it needs one of its own.
        factor : SX
            Product of variables, a scalar.
        """
        sign = 1 if values[0] > 0 else -1
        size = tuple(sign * v for v in values)
        if set(size) == {Fraction(1)}:
            return _Term(sign, factor)
        if set(size) == {Fraction(2)}:
            return _Term(sign, factor + factor)
        if size not in self._known:
            while name in self.symbols:
                name += "_"
            self._known[size] = self.symbols[name] = ca.SX.sym(name)
            self.expressions[name] = sign * expression
        number = self._known[size]
        return _Term(sign, number if factor.is_one() else number * factor)


@dataclass(frozen=True)
class _Term:
    sign: int
    value: ca.SX


@dataclass(frozen=True)
class Variables:
    """Named scalar variables, in the order in which they are factored out.

    Attributes
    ----------
    names : tuple of str
        One a variable.
    vector : SX
        Their symbols, (n, 1).
    """

    names: tuple[str, ...]
    vector: ca.SX


def quadratic(
    expressions: ca.SX,
    names: Sequence[str],
    variables: Variables,
    numbers: Coefficients,
    *,
    factored: int = 0,
) -> list[ca.SX]:
    """Rewrite expressions that are quadratic in some variables as short schemes.

    Parameters
    ----------
    expressions : SX, (n, 1)
        In the variables and the design alone; each a polynomial of degree two or less in the
        variables (it may be written otherwise). The caller makes sure of that by comparing.
    names : sequence of str
        One a row; begins the names of its coefficients.
    variables : Variables
    numbers : Coefficients
        Takes up the coefficients that are needed.
    factored : int
        The number of first variables to factor out: ``x1*(a + b*x1 + c*x2)``.

    Returns
    -------
    list of SX, in the variables and the symbols of `numbers`
    """
    x = variables.vector
    origin = ca.SX.zeros(x.shape)
    slope = ca.jacobian(expressions, x)
    schemes = []
    for i, name in enumerate(names):
        curvature = ca.jacobian(slope[i, :], x)
        at_origin = ca.substitute([expressions[i], slope[i, :], curvature], [x], [origin])
        constant, linear, square = at_origin
        n = x.shape[0]
        pairs = [(j, k) for j in range(n) for k in range(j, n)]
        halves = [square[j, k] / (2 if j == k else 1) for j, k in pairs]
        column = ca.vertcat(constant, linear.T, *halves)
        values = numbers.at_samples(column)
        found = {
            key: (v, column[at])
            for at, (key, v) in enumerate(
                zip([(), *((j,) for j in range(n)), *pairs], values, strict=True)
            )
            if any(v)
        }

        def term(key: tuple[int, ...], rest: tuple[int, ...]) -> _Term:
            value, expression = found.pop(key)  # noqa: B023 - used within this turn alone
            label = "_".join([name, *(variables.names[j] for j in key)])  # noqa: B023
            factor = ca.SX(1)
            for j in rest:
                factor = factor * x[j]
            return numbers.times(value, expression, label, factor)

        terms = []
        for j in range(factored):
            keys = [key for key in list(found) if j in key]
            inner = [term(key, _without(key, j)) for key in keys]
            if inner:
                total = signed_sum(inner)
                terms.append(_Term(total.sign, x[j] * total.value))
        plain = [term(key, key) for key in list(found)]
        schemes.append(_value(signed_sum([*plain, *terms])))
    return schemes


def signed_sum(terms: Sequence[_Term]) -> _Term:
    """Add terms pair by pair, so that sums of the same two terms are found to be the same.

    Parameters
    ----------
    terms : sequence of terms
        Each a sign and a scalar SX.
    """
    if not terms:
        return _Term(1, ca.SX(0))
    while len(terms) > 1:
        pairs = [terms[i : i + 2] for i in range(0, len(terms), 2)]
        terms = [p[0] if len(p) == 1 else _pair(*p) for p in pairs]
    return terms[0]


def _pair(a: _Term, b: _Term) -> _Term:
    if a.sign == b.sign:
        return _Term(a.sign, a.value + b.value)
    return _Term(1, a.value - b.value) if a.sign > 0 else _Term(1, b.value - a.value)


def _value(term: _Term) -> ca.SX:
    return term.value if term.sign > 0 else -term.value


def _without(key: tuple[int, ...], j: int) -> tuple[int, ...]:
    at = key.index(j)
    return key[:at] + key[at + 1 :]
