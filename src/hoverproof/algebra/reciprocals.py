"""Rewrite a graph so that each divisor is inverted once."""

from __future__ import annotations

import casadi as ca


def share_reciprocals(function: ca.Function) -> ca.Function:
    """Return an SX function in which ``a / b`` is ``a * (1 / b)``, each ``1 / b`` taken once.

    A division takes many times as long as a product, and several by the same divisor need but one.
    CasADi would turn a * (1 / b) back into a / b, so its simplification is off meanwhile.

    Parameters
    ----------
    function : casadi.Function
        An SX function.
    """
    simplifying = ca.GlobalOptions.getSimplificationOnTheFly()
    ca.GlobalOptions.setSimplificationOnTheFly(False)
    try:
        return _rebuilt(function)
    finally:
        ca.GlobalOptions.setSimplificationOnTheFly(simplifying)


def _rebuilt(function: ca.Function) -> ca.Function:
    arguments = function.sx_in()
    results = [ca.SX.zeros(function.sparsity_out(i)) for i in range(function.n_out())]
    work: list[ca.SX] = [ca.SX(0)] * function.sz_w()
    for k in range(function.n_instructions()):
        op = function.instruction_id(k)
        inputs, outputs = function.instruction_input(k), function.instruction_output(k)
        if op == ca.OP_CONST:
            work[outputs[0]] = ca.SX(function.instruction_constant(k))
        elif op == ca.OP_INPUT:
            work[outputs[0]] = arguments[inputs[0]].nz[inputs[1]]
        elif op == ca.OP_OUTPUT:
            results[outputs[0]].nz[outputs[1]] = work[inputs[0]]
        elif op == ca.OP_DIV:
            work[outputs[0]] = work[inputs[0]] * (1 / work[inputs[1]])
        elif len(inputs) == 2:
            work[outputs[0]] = ca.SX.binary(op, work[inputs[0]], work[inputs[1]])
        else:
            work[outputs[0]] = ca.SX.unary(op, work[inputs[0]])
    names = function.name_in(), function.name_out()
    return ca.Function(function.name(), arguments, ca.cse(results), *names)
