"""Decide the definiteness of rational matrices exactly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

Matrix = Sequence[Sequence[Fraction]]


def is_positive_definite(matrix: Matrix) -> bool:
    """Tell whether a symmetric rational matrix is positive definite, without rounding.

    Fraction-free LDLᵀ (Bareiss): the pivots are the leading principal minors of the matrix
    scaled to integers; by Sylvester's criterion it is positive definite iff all are positive.

    Parameters
    ----------
    matrix : (n, n) rows of Fractions, symmetric

    Raises
    ------
    ValueError
        If the matrix is not square and symmetric.
    """
    n = len(matrix)
    if any(len(row) != n for row in matrix) or any(
        matrix[i][j] != matrix[j][i] for i in range(n) for j in range(i)
    ):
        raise ValueError("the matrix is not symmetric")
    scale = math.lcm(*(entry.denominator for row in matrix for entry in row), 1)
    a = [[int(entry * scale) for entry in row] for row in matrix]
    previous = 1
    for k in range(n):
        pivot = a[k][k]
        if pivot <= 0:
            return False
        for i in range(k + 1, n):
            for j in range(k + 1, i + 1):
                a[i][j] = (a[i][j] * pivot - a[i][k] * a[j][k]) // previous
        previous = pivot
    return True


def quadratic_form(matrix: Matrix, x: Sequence[Fraction]) -> Fraction:
    """Return xᵀMx.

    Parameters
    ----------
    matrix : (n, n) rows of Fractions
    x : (n,) Fractions
    """
    zero = Fraction(0)
    rows = (
        xi * sum((entry * xj for entry, xj in zip(row, x, strict=True) if entry), zero)
        for xi, row in zip(x, matrix, strict=True)
        if xi
    )
    return sum(rows, zero)
