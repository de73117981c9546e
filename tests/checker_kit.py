"""What the checker has in forms, as matrices, for tests to compare with."""

from __future__ import annotations

import math
from fractions import Fraction

from hoverproof import checker


def matrix(form, n=11):
    """Return the symmetric matrix of a quadratic form in n components."""
    half = [[0] * n for _ in range(n)]
    for (i, j), c in form.items():
        half[i][j] = half[j][i] = c if i == j else c / 2
    return half


def sigma(gains, weights, Q, f, q):
    """Return the Σ of the checker, (11, 11), for gains by name."""
    named = [gains[name] for name in checker.GAINS[:4]]
    return matrix(checker.sigma(named, weights, Q, f, q))


def definite(rows):
    """Tell by the checker whether a symmetric matrix of fractions is positive definite."""
    scale = math.lcm(*(Fraction(x).denominator for row in rows for x in row))
    return checker.definite([[int(x * scale) for x in row] for row in rows])
