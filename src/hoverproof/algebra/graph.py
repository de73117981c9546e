"""Evaluate a CasADi SX graph in exact arithmetic, instruction by instruction."""

from __future__ import annotations

import hashlib
import operator
import sys
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

import casadi as ca

_BINARY: dict[int, Callable[[Any, Any], Any]] = {
    ca.OP_ADD: operator.add,
    ca.OP_SUB: operator.sub,
    ca.OP_MUL: operator.mul,
    ca.OP_DIV: operator.truediv,
}
_UNARY: dict[int, Callable[[Any], Any]] = {
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_NEG: operator.neg,
    ca.OP_SQ: lambda a: a * a,
    ca.OP_TWICE: lambda a: a + a,
    ca.OP_SQRT: lambda a: a.sqrt(),
}
SHORT = 2000
"""Instructions of a graph that the standard library evaluates sooner than FLINT is there."""


def evaluate(
    function: ca.Function,
    arguments: Sequence[Sequence[Any]],
    number: Callable[[Fraction], Any] = Fraction,
) -> list[list[list[Any]]]:
    """Run the graph of an SX function over an exact number type.

    Parameters
    ----------
    function : casadi.Function
        An SX function.
    arguments : sequence of sequences
        The nonzeros of each input, column by column, as exact numbers that know ``+ - * /``
        (and have a method ``sqrt`` if the graph takes square roots).
    number : callable
        Makes such a number of a Fraction; constants of the graph, which are floats, are taken
        at their exact value.

    Returns
    -------
    list of matrices, each a list of rows

    Raises
    ------
    NotImplementedError
        If the graph uses an operation that has no exact counterpart here.
    ZeroDivisionError
        If the graph divides by zero.
    """
    if number is Fraction and ("flint" in sys.modules or function.n_instructions() > SHORT):
        return _by_flint(function, arguments)
    work: list[Any] = [None] * function.sz_w()
    zero = number(Fraction(0))
    results: list[list[Any]] = [[zero] * function.nnz_out(i) for i in range(function.n_out())]
    for op, inputs, outputs, constant in _instructions(function):
        if op == ca.OP_CONST:
            work[outputs[0]] = number(constant)
        elif op == ca.OP_INPUT:
            work[outputs[0]] = arguments[inputs[0]][inputs[1]]
        elif op == ca.OP_OUTPUT:
            results[outputs[0]][outputs[1]] = work[inputs[0]]
        elif op == ca.OP_INV:
            work[outputs[0]] = number(Fraction(1)) / work[inputs[0]]
        elif op in _BINARY:
            work[outputs[0]] = _BINARY[op](work[inputs[0]], work[inputs[1]])
        elif op in _UNARY:
            work[outputs[0]] = _UNARY[op](work[inputs[0]])
        else:
            name = next((n for n, v in vars(ca).items() if n[:3] == "OP_" and v == op), op)
            raise NotImplementedError(f"no exact counterpart of CasADi operation {name}")
    return [_dense(values, function.sparsity_out(i), zero) for i, values in enumerate(results)]


def _by_flint(
    function: ca.Function, arguments: Sequence[Sequence[Fraction]]
) -> list[list[list[Fraction]]]:
    """Run a graph over the rationals of FLINT, which are as exact and faster, once imported."""
    from flint import fmpq

    given = [[fmpq(a.numerator, a.denominator) for a in values] for values in arguments]
    found = evaluate(function, given, lambda c: fmpq(c.numerator, c.denominator))
    return [[[Fraction(int(x.p), int(x.q)) for x in row] for row in rows] for rows in found]


@lru_cache(maxsize=16)
def _instructions(function: ca.Function) -> list[tuple[int, list[int], list[int], Fraction]]:
    """Read the graph once: operation, inputs, outputs and constant of each instruction."""
    return [
        (
            op := function.instruction_id(k),
            function.instruction_input(k),
            function.instruction_output(k),
            Fraction(function.instruction_constant(k) if op == ca.OP_CONST else 0),
        )
        for k in range(function.n_instructions())
    ]


def fingerprint(function: ca.Function) -> str:
    """Return the SHA-256 of the graph of an SX function: its instructions, in order.

    Parameters
    ----------
    function : Function
        Of CasADi, made of SX graphs.
    """
    digest = hashlib.sha256()
    for k in range(function.n_instructions()):
        op = function.instruction_id(k)
        constant = function.instruction_constant(k).hex() if op == ca.OP_CONST else ""
        line = (op, function.instruction_input(k), function.instruction_output(k), constant)
        digest.update(repr(line).encode())
    return digest.hexdigest()


def _dense(values: list[Any], sparsity: ca.Sparsity, zero: Any) -> list[list[Any]]:
    rows, columns = sparsity.shape
    dense = [[zero] * columns for _ in range(rows)]
    for value, i, j in zip(values, sparsity.row(), sparsity.get_col(), strict=True):
        dense[i][j] = value
    return dense
