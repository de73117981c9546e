"""Prove identities between CasADi expressions: their graphs, run over rational functions.

What is proved is the very graph that is evaluated or compiled elsewhere, instruction by
instruction; nothing is sampled, rounded or written down a second time.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.rational import Field, Polynomials, Rational

Roots = Mapping[ca.SX, ca.SX]
ATTEMPTS = 100


@dataclass(frozen=True)
class Identity:
    """Whether an expression is zero at every point where it is defined; true if it is.

    Attributes
    ----------
    holds : bool
        Whether the normal form is zero.
    terms : int
        Terms of the largest numerator met.
    counterexample : dict of str to Fraction, or None
        If it does not hold: a point where the expression is defined and not zero. The second
        symbol called ``x`` is listed as ``x#2``. None if no point was found that makes all roots
        rational; the answer is open then if the roots depend on each other.
    difference : Fraction or None
        The first nonzero entry, row by row, at the counterexample.
    """

    holds: bool
    terms: int
    counterexample: dict[str, Fraction] | None = None
    difference: Fraction | None = None

    def __bool__(self) -> bool:
        return self.holds


def normal_form(expression: ca.SX, roots: Roots | None = None) -> list[list[Rational]]:
    """Return the entries of an expression as rational functions of its symbols.

    Parameters
    ----------
    expression : SX, (n, m)
        A graph of ``+ - * /``, squares, and square roots of what `roots` declares.
    roots : mapping of SX to SX, optional
        Scalar symbols to scalar radicands: ``r = sqrt(s) ≥ 0``. A radicand may contain the
        roots before it. Radicands should be independent: no product of some of them a square.

    Returns
    -------
    n rows of m `Rational`
        The variables are those of ``symvar([expression; roots; radicands])``, in that order.

    Raises
    ------
    NotImplementedError
        If the graph uses another operation, or the square root of something not declared.
    ZeroDivisionError
        If the graph divides by something that is identically zero.
    ValueError
        If the roots are not scalar symbols with scalar radicands that contain no later root.
    """
    graph = _Graph.of([expression], roots or {})
    field = graph.field()
    return evaluate(graph.expressions, [field.variables()], field.constant)[0]


def prove_zero(expression: ca.SX, roots: Roots | None = None) -> Identity:
    """Prove that an expression is zero at every point where it is defined, or refute it.

    Parameters
    ----------
    expression : SX, (n, m)
    roots
        See `normal_form`, also for what is raised.
    """
    return prove_equal(expression, ca.SX.zeros(expression.shape), roots)


def prove_equal(left: ca.SX, right: ca.SX, roots: Roots | None = None) -> Identity:
    """Prove that two expressions agree at every point where both are defined, or refute it.

    Parameters
    ----------
    left, right : SX, (n, m)
    roots
        See `normal_form`, also for what is raised.
    """
    if left.shape != right.shape:
        raise ValueError(f"the shapes {left.shape} and {right.shape} differ")
    # Subtracting here and not in CasADi, which would fold constants in floating point.
    graph = _Graph.of([left, right], roots or {})
    field = graph.field()
    entries = graph.difference(field, field.variables())
    terms = max((entry.size for entry in entries), default=0)
    if all(entry.is_zero() for entry in entries):
        return Identity(True, terms)
    point, value = graph.counterexample() or (None, None)
    return Identity(False, terms, point, value)


@dataclass(frozen=True)
class _Graph:
    """Expressions and roots as graphs over one vector of all their symbols.

    Attributes
    ----------
    names : list of str
        Distinct, one a symbol; symbols are told apart by their position alone.
    expressions : Function
        All symbols to the expressions.
    roots : list of (int, Function)
        Position of a root among the symbols, and all symbols to its radicand.
    """

    names: list[str]
    expressions: ca.Function
    roots: list[tuple[int, ca.Function]]

    @classmethod
    def of(cls, expressions: Sequence[ca.SX], roots: Roots) -> _Graph:
        pairs = list(roots.items())
        if not all(root.is_valid_input() and radicand.is_scalar() for root, radicand in pairs):
            raise ValueError("a root is a scalar symbol, declared with its scalar radicand")
        everything = [*expressions, *(root for root, _ in pairs), *(s for _, s in pairs)]
        symbols = ca.symvar(ca.vertcat(*(ca.vec(e) for e in everything)))
        position = {symbol: i for i, symbol in enumerate(symbols)}
        for k, (root, radicand) in enumerate(pairs):
            if ca.depends_on(radicand, ca.vertcat(*(later for later, _ in pairs[k:]))):
                raise ValueError(f"the radicand of {root} contains it or a later root")
        x = ca.vertcat(*symbols) if symbols else ca.SX(0, 1)
        functions = [(position[r], ca.Function("radicand", [x], [s])) for r, s in pairs]
        return cls(_distinct(symbols), ca.Function("graph", [x], list(expressions)), functions)

    def field(self) -> Field:
        """Return the field of the symbols with all roots."""
        field = Field(Polynomials.over(self.names))
        for index, radicand in self.roots:
            value = evaluate(radicand, [field.variables()], field.constant)[0][0][0]
            field = field.with_root(index, value)
        return field

    def difference(self, field: Field, values: list[Rational]) -> list[Rational]:
        """Return the entries of the first expression less the second, row by row."""
        left, right = evaluate(self.expressions, [values], field.constant)
        return [a - b for p, q in zip(left, right, strict=True) for a, b in zip(p, q, strict=True)]

    def counterexample(self) -> tuple[dict[str, Fraction], Fraction] | None:
        """Return a point of small integers where the difference is not zero, and its value.

        The graph itself is run at the point, so this does not rely on the normal form.
        """
        constants, draw = Field(Polynomials.over(["none"])), random.Random(0)
        for attempt in range(ATTEMPTS):
            bound = 3 + attempt // 4  # no nonzero polynomial vanishes on every grid
            try:
                point = self._point(constants, draw, bound)
                entries = [_number(entry) for entry in self.difference(constants, point)]
            except (ZeroDivisionError, NotImplementedError):  # not defined, or a root irrational
                continue
            for value in entries:
                if value != 0:
                    return dict(zip(self.names, map(_number, point), strict=True)), value
        return None

    def _point(self, constants: Field, draw: random.Random, bound: int) -> list[Rational]:
        def integer() -> Rational:
            return constants.constant(draw.randint(-bound, bound))

        point, settled = [integer() for _ in self.names], {index for index, _ in self.roots}
        for index, radicand in self.roots:
            involved = sorted(set(radicand.jac_sparsity(0, 0).get_col()) - settled)
            for _ in range(ATTEMPTS if involved else 1):  # draw anew until the root is rational
                try:
                    point[index] = evaluate(radicand, [point], constants.constant)[0][0][0].sqrt()
                    break
                except (ZeroDivisionError, NotImplementedError):
                    for i in involved:
                        point[i] = integer()
            else:
                raise NotImplementedError("no rational root found")
            settled.update(involved)
        return point


def _number(constant: Rational) -> Fraction:
    return constant.at([Fraction(0)])


def _distinct(symbols: Sequence[ca.SX]) -> list[str]:
    names: list[str] = []
    for symbol in symbols:
        name, k = symbol.name(), 1
        while name in names:
            k += 1
            name = f"{symbol.name()}#{k}"
        names.append(name)
    return names
