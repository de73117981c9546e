"""Solve the linear equations that a design poses, on the CasADi graph itself."""

from __future__ import annotations

import casadi as ca


def solve_affine(residual: ca.SX, unknown: ca.SX) -> ca.SX:
    """Return the `unknown` that makes an affine `residual` vanish.

    Parameters
    ----------
    residual : SX, (n, 1)
        Expression that is affine in `unknown`.
    unknown : SX, (n, 1)
        Symbols to solve for.

    Returns
    -------
    SX, (n, 1)
        The solution, free of `unknown`.

    Raises
    ------
    ValueError
        If the residual is not affine in the unknown, or not square.
    """
    slope = ca.jacobian(residual, unknown)
    if slope.shape[0] != slope.shape[1]:
        raise ValueError(f"{slope.shape[0]} equations for {slope.shape[1]} unknowns")
    if ca.depends_on(slope, unknown):
        raise ValueError("the residual is not affine in the unknown")
    offset = ca.substitute(residual, unknown, ca.SX.zeros(unknown.shape))
    scale = ca.vertcat(*(_divisor(slope, i) for i in range(slope.shape[0])))
    slope = ca.simplify(slope / ca.repmat(scale, 1, slope.shape[1]))
    if slope.is_constant():  # as for rotor mixing: keeps the solution rational and short
        return ca.inv(ca.DM(slope)) @ (-offset / scale)
    blocks, *_ = slope.sparsity().btf()
    if blocks < slope.shape[0]:  # CasADi would take square roots
        return _eliminate(slope, -offset / scale)
    return ca.solve(slope, -offset / scale)


def _divisor(slope: ca.SX, i: int) -> ca.SX:
    """Return what a row is divided by: an entry that is not zero.

    A full matrix is one of inertia, of which entries off the diagonal may be zero as numbers.
    """
    full = ca.sparsify(slope).nnz() == slope.numel()
    return slope[i, i] if full else ca.sparsify(slope[i, :]).nz[0]


def _eliminate(slope: ca.SX, right: ca.SX) -> ca.SX:
    """Solve linear equations by elimination, which keeps what is rational rational.

    Pivots are numbers, where there are any, in columns with few entries.
    """
    n = slope.shape[0]
    rows, columns = [ca.horzcat(slope[i, :], right[i]) for i in range(n)], list(range(n))
    pivots: list[tuple[ca.SX, int]] = []
    while rows:
        candidates = [
            (not row[j].is_constant(), sum(not _is_nothing(row[k]) for k in columns), i, j)
            for i, row in enumerate(rows)
            for j in columns
            if not _is_nothing(row[j])
        ]
        *_, i, j = min(candidates)
        pivot = rows.pop(i)
        columns.remove(j)
        pivots.append((pivot, j))
        for at, row in enumerate(rows):
            if not _is_nothing(row[j]):
                rows[at] = ca.simplify(row - row[j] / pivot[j] * pivot)
                rows[at][j] = 0
    solved = ca.SX.zeros(n)
    for pivot, j in reversed(pivots):
        known = [k for k in range(n) if k != j and not _is_nothing(pivot[k])]
        solved[j] = (pivot[n] - sum(pivot[k] * solved[k] for k in known)) / pivot[j]
    return solved


def _is_nothing(entry: ca.SX) -> bool:
    return bool(ca.sparsify(entry).nnz() == 0)


def lie_derivative(expression: ca.SX, state: ca.SX, rate: ca.SX) -> ca.SX:
    """Return the derivative of `expression` along the motion ``state' = rate``.

    Parameters
    ----------
    expression : SX, (n, m)
        Function of `state`.
    state, rate : SX, (k, 1)
        The state symbols and their time derivatives, in the same order.

    Returns
    -------
    SX, (n, m)
    """
    return ca.jtimes(expression, state, rate)


def is_zero(expression: ca.SX) -> bool:
    """Tell whether every entry of `expression` is literally the constant 0.

    Parameters
    ----------
    expression : SX
        Of any shape.
    """
    return bool(ca.sparsify(ca.simplify(expression)).nnz() == 0)
