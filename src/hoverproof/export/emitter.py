"""Print an SX graph as plain C99 statements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from hoverproof.export.precision import Precision

LONGEST = 72
"""Characters of an expression that is still written within another."""

_SIGNS = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/"}


@dataclass
class _Value:
    """A value of the graph, computed once: SSA form."""

    op: int
    operands: tuple[int, ...] = ()
    text: str = ""  # C text of an input or a constant; later of anything
    uses: int = 0
    name: str = ""


def statements(
    function: ca.Function,
    inputs: Sequence[Sequence[str]],
    results: Mapping[str, Sequence[str | None]],
    precision: Precision,
) -> list[str]:
    """Return the C statements that compute some outputs of an SX function.

    Each value that is used more than once, or bears a name, becomes a constant of its own; what no
    result needs is left out. The order of operations within the C text is that of the graph.

    Parameters
    ----------
    function : casadi.Function
        An SX function of sums, products, quotients and square roots. Outputs that are not among
        the results lend their names to the values they hold.
    inputs : sequence of sequences of str
        C text of each nonzero of each input.
    results : dict of str to sequence of str
        Output name to where each of its nonzeros is stored; None for what is not wanted.
    precision : Precision

    Raises
    ------
    NotImplementedError
        If the graph uses another operation.
    """
    values, outputs = _single_assignments(function, inputs, precision)
    names = [function.name_out(i) for i in range(function.n_out())]
    stored = [
        (target, values_of[k])
        for name, values_of in zip(names, outputs, strict=True)
        for k, target in enumerate(results.get(name, ()))
        if target is not None and k in values_of
    ]
    _count_uses(values, [v for _, v in stored])
    for name, values_of in zip(names, outputs, strict=True):
        for k, v in values_of.items():
            needed = values[v].uses > (1 if name in results else 0)
            if needed and values[v].operands and not values[v].name and k < 3:
                values[v].name = name if len(values_of) == 1 else f"{name}_{'xyz'[k]}"
    lines = []
    taken = 0
    for value in values:
        if not value.uses or not value.operands:
            continue
        value.text = _expression(value, [values[i] for i in value.operands], precision)
        if value.name or value.uses > 1 or len(value.text) > LONGEST:
            if not value.name:
                value.name = f"t{taken}"
                taken += 1
            lines.append(_declaration(precision.c_type, value.name, value.text))
            value.text, value.op = value.name, ca.OP_INPUT
    return [*lines, *(f"{target} = {values[v].text};" for target, v in stored)]


def literals(numbers: dict[str, Fraction], precision: Precision) -> dict[str, str]:
    """Return the typed literal of each number, rounded once from its exact value.

    Parameters
    ----------
    numbers : dict of str to Fraction
        Name to exact number.
    precision : Precision
        The type of the literals.
    """
    return {name: precision.literal(value) for name, value in numbers.items()}


def _single_assignments(
    function: ca.Function, inputs: Sequence[Sequence[str]], precision: Precision
) -> tuple[list[_Value], list[dict[int, int]]]:
    values: list[_Value] = []
    work: dict[int, int] = {}
    outputs: list[dict[int, int]] = [{} for _ in range(function.n_out())]
    for k in range(function.n_instructions()):
        op = function.instruction_id(k)
        i, o = function.instruction_input(k), function.instruction_output(k)
        if op == ca.OP_OUTPUT:
            outputs[o[0]][o[1]] = work[i[0]]
            continue
        if op == ca.OP_CONST:
            text = precision.literal(Fraction(function.instruction_constant(k)))
            value = _Value(op, text=text)
        elif op == ca.OP_INPUT:
            text = inputs[i[0]][i[1]]
            value = _Value(op, text=f"({text})" if text.startswith("-") else text)
        else:
            value = _Value(op, tuple(work[j] for j in i))
        work[o[0]] = len(values)
        values.append(value)
    return values, outputs


def _count_uses(values: list[_Value], wanted: Sequence[int]) -> None:
    for v in wanted:
        values[v].uses += 1
    for value in reversed(values):
        if value.uses:
            twice = 2 if value.op in (ca.OP_SQ, ca.OP_FMAX) else 1  # x * x names x twice
            for operand in value.operands:
                values[operand].uses += twice


def _expression(value: _Value, operands: Sequence[_Value], precision: Precision) -> str:
    plain = (ca.OP_INPUT, ca.OP_CONST, ca.OP_SQRT)
    texts = [o.text if o.op in plain else f"({o.text})" for o in operands]
    if value.op in _SIGNS:
        return f"{texts[0]} {_SIGNS[value.op]} {texts[1]}"
    if value.op == ca.OP_SQ:
        return f"{texts[0]} * {texts[0]}"
    if value.op == ca.OP_TWICE:
        return f"{precision.literal(Fraction(2))} * {texts[0]}"
    if value.op == ca.OP_INV:
        return f"{precision.literal(Fraction(1))} / {texts[0]}"
    if value.op == ca.OP_NEG:
        return f"-{texts[0]}"
    if value.op == ca.OP_SQRT:
        return f"{precision.sqrt}({operands[0].text})"
    if value.op == ca.OP_FMAX:
        return (
            f"({texts[0]} > {texts[1]}) ? {texts[0]} : {texts[1]}"  # the second for a NaN, as fmax
        )
    raise NotImplementedError(f"no C for CasADi operation {value.op}")


def _declaration(c_type: str, name: str, text: str) -> str:
    line = f"const {c_type} {name} = {text};"
    if len(line) <= 96:
        return line
    at = max(line.rfind(sign, 0, 94) for sign in (" + ", " - ", " * ", " / "))
    return f"{line[:at]}\n     {line[at:]}"
