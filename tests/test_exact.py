"""Exact arithmetic: square roots, definiteness, and graphs evaluated without rounding."""

from __future__ import annotations

import itertools
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from checker_kit import definite
from hoverproof import checker
from hoverproof.algebra.definite import is_positive_definite, quadratic_form
from hoverproof.algebra.graph import evaluate, fingerprint
from hoverproof.algebra.linear import is_zero, solve_affine
from hoverproof.algebra.surd import Surd, sqrt_enclosure

small = st.fractions(min_value=-4, max_value=4, max_denominator=6)


@st.composite
def symmetric(draw):
    n = draw(st.integers(1, 5))
    entries = {(i, j): draw(small) for i in range(n) for j in range(i + 1)}
    return [[entries[max(i, j), min(i, j)] for j in range(n)] for i in range(n)]


@given(symmetric(), st.integers(0, 6))
def test_both_deciders_agree_with_sympy(matrix, shift):
    n = len(matrix)
    m = [[matrix[i][j] + shift * (i == j) for j in range(n)] for i in range(n)]
    expected = bool(sympy.Matrix(m).is_positive_definite)
    assert is_positive_definite(m) == expected
    assert definite(m) == expected


@pytest.mark.parametrize("decide", [is_positive_definite, definite])
def test_semidefinite_and_deceptive_matrices_are_not_positive_definite(decide):
    F = Fraction
    assert not decide([[F(1), F(1)], [F(1), F(1)]])
    assert not decide([[F(0), F(1)], [F(1), F(0)]])
    deceptive = [[F(int(i == j)) for j in range(4)] for i in range(4)]
    deceptive[3][3] = F(-1)  # its leading 3 x 3 minors are positive
    assert not decide(deceptive)
    hair = Fraction(1, 10**5000)
    assert not decide([[F(1), F(1)], [F(1), 1 - hair]])
    assert decide([[F(1), F(1)], [F(1), 1 + hair]])


@given(st.fractions(min_value=0, max_value=10**6))
def test_a_square_root_lies_in_its_enclosure(value):
    low, high = sqrt_enclosure(value)
    assert low * low <= value <= high * high
    assert high - low <= Fraction(1, 2**96)
    low, high = checker.square_root(value)
    assert low * low <= value <= high * high


@given(st.fractions(min_value=0, max_value=100))
def test_the_root_of_a_square_is_rational(value):
    root = Surd.of(value * value).sqrt()
    assert abs(root.enclosure()[0] - value) <= Fraction(1, 2**96)


def test_surds_at_equal_distance_cancel_exactly():
    ray = Surd.of(1) / Surd.of(11).sqrt()
    assert (ray - ray).terms == {}
    assert (ray * ray).rational() == Fraction(1, 11)
    with pytest.raises(NotImplementedError):
        (Surd.of(2).sqrt() + Surd.of(1)).rational()


@given(st.lists(small, min_size=3, max_size=3))
def test_a_graph_is_evaluated_without_rounding(values):
    a, b, c = values
    assume(c != 0 and a + b != 0)
    x = ca.SX.sym("x", 3)
    expression = (x[0] * x[1] - 0.375) / (x[0] + x[1]) + x[2] ** 2 - 1 / x[2] + 2 * x[0]
    (result,) = evaluate(ca.Function("f", [x], [expression]), [values])
    assert result[0][0] == (a * b - Fraction(3, 8)) / (a + b) + c * c - 1 / c + 2 * a


def test_an_operation_without_exact_counterpart_is_refused():
    x = ca.SX.sym("x")
    with pytest.raises(NotImplementedError):
        evaluate(ca.Function("f", [x], [ca.sin(x)]), [[Fraction(1)]])


def test_a_fingerprint_tells_graphs_apart():
    x = ca.SX.sym("x", 2)
    graphs = [x[0] + x[1], x[0] - x[1], x[0] + 2 * x[1], x[0] + 3 * x[1]]
    prints = {fingerprint(ca.Function("f", [x], [g])) for g in graphs}
    assert len(prints) == 4
    assert fingerprint(ca.Function("g", [x], [graphs[0]])) in prints


def test_affine_equations_are_solved_and_others_refused():
    x, a = ca.SX.sym("x", 2), ca.SX.sym("a")
    solved = solve_affine(ca.vertcat(a * x[0] - 3, x[1] - x[0]), x)
    assert np.allclose(np.array(ca.Function("s", [a], [solved])(2.0)).ravel(), [1.5, 1.5])
    with pytest.raises(ValueError, match="not affine"):
        solve_affine(ca.vertcat(x[0] * x[1] - 1, x[0]), x)
    with pytest.raises(ValueError, match="1 equations for 2 unknowns"):
        solve_affine(x[0] + x[1], x)


def test_coupled_equations_are_solved_without_square_roots():
    """Four equations that no order makes triangular, with numbers and symbols as coefficients."""
    x, p = ca.SX.sym("x", 4), ca.SX.sym("p", 6)
    slope = ca.vertcat(
        ca.horzcat(p[0], 1, p[1], 0),
        ca.horzcat(2, p[2], p[3], 1),
        ca.horzcat(p[4], p[5], -1, p[0]),
        ca.horzcat(0, p[1], 3, p[2]),
    )
    right = ca.vertcat(p[5], p[0] * p[1], 3, p[4])
    solved = solve_affine(slope @ x - right, x)
    f = ca.Function("f", [p], [slope @ solved, right])
    left, wanted = evaluate(f, [[Fraction(n, 7) for n in (3, -5, 11, 2, 9, -4)]])
    assert left == wanted


def test_only_a_literal_zero_is_zero():
    x = ca.SX.sym("x")
    assert is_zero(x - x)
    assert not is_zero(x)


@pytest.mark.slow
@given(symmetric(), st.data())
def test_a_quadratic_form_is_the_double_sum(matrix, data):
    n = len(matrix)
    x = [data.draw(small) for _ in range(n)]
    pairs = itertools.product(range(n), repeat=2)
    assert quadratic_form(matrix, x) == sum(x[i] * matrix[i][j] * x[j] for i, j in pairs)
