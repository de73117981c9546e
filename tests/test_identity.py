"""Identities between graphs, proved exactly; rational functions as numbers of a graph."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca
import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.identity import normal_form, prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import camera
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.lyapunov import (
    derive_error_dynamics,
    derive_lyapunov_form,
    measurement_of_errors,
    thrust_of_factor,
)
from hoverproof.servo.variables import Errors

X = ca.vertcat(*(ca.SX.sym("x") for _ in range(3)))  # three symbols of one name
x, y, z = ca.vertsplit(X)
number = st.fractions(min_value=-4, max_value=4, max_denominator=4)
points = st.lists(number, min_size=3, max_size=3)

UNARY = [lambda a: -a, lambda a: a * a, lambda a: 2 * a, lambda a: a + a, lambda a: 1 / a]
BINARY = [lambda a, b: a + b, lambda a, b: a - b, lambda a, b: a * b, lambda a, b: a / b]


@st.composite
def graphs(draw, most=7):
    """Draw an expression in x, y, z whose parts are used more than once."""
    constants = st.sampled_from([1.0, -2.0, 0.5, 3.0, 0.1, -7.25])
    parts = [x, y, z, ca.SX(draw(constants)), ca.SX(draw(constants))]
    for _ in range(draw(st.integers(1, most))):
        a, b = (parts[-1 - draw(st.integers(0, len(parts) - 1))] for _ in range(2))
        op = draw(st.sampled_from(BINARY * 2 + UNARY))
        parts.append(op(a) if op in UNARY else op(a, b))
    return parts[-1]


def at(expression, values, symbols=X):
    """Evaluate a scalar expression over Fractions: independent of polynomials."""
    function = ca.Function("f", [symbols], [expression])
    return evaluate(function, [values])[0][0][0]


def form(expression, **options):
    """Return the normal form of a scalar expression with all of x, y, z as its variables."""
    try:
        return normal_form(ca.vertcat(X, expression), **options)[3][0]
    except OverflowError:  # CasADi has folded 1/0 into a constant
        raise ZeroDivisionError from None


@dataclass
class Rounded:
    """A number and a bound of the error of its floating point evaluation."""

    value: Fraction
    error: Fraction = Fraction(0)

    def _of(self, value, error):
        return Rounded(value, error + abs(value) * Fraction(2) ** -52)

    def __neg__(self):
        return Rounded(-self.value, self.error)

    def __add__(self, other):
        return self._of(self.value + other.value, self.error + other.error)

    def __sub__(self, other):
        return self + -other

    def __mul__(self, other):
        a, b = abs(self.value) + self.error, abs(other.value) + other.error
        return self._of(self.value * other.value, a * b - abs(self.value * other.value))

    def __truediv__(self, other):
        least = abs(other.value) - other.error
        assume(least > 0)
        ratio = self.value / other.value
        return self._of(ratio, (self.error + abs(ratio) * other.error) / least)


@settings(max_examples=150, deadline=None)
@given(graphs(), points)
def test_a_normal_form_has_the_values_of_its_graph(expression, values):
    try:
        expected = at(expression, values)
    except (ZeroDivisionError, OverflowError):
        assume(False)
    assert form(expression).at(values) == expected

    function = ca.Function("f", [X], [expression])
    dyadic = [Fraction(round(v * 8), 8) for v in values]
    try:
        exact = form(expression).at(dyadic)
        rounded = evaluate(function, [[Rounded(v) for v in dyadic]], Rounded)[0][0][0]
    except ZeroDivisionError:
        assume(False)
    result = float(function([float(v) for v in dyadic]))
    assume(math.isfinite(result) and (exact == 0 or 1e-200 < abs(exact) < 1e200))
    assert abs(Fraction(result) - exact) <= rounded.error
    if rounded.error < Fraction(1e-12) * abs(exact):
        assert result == pytest.approx(float(exact), rel=1e-9)


@settings(max_examples=80, deadline=None)
@given(graphs(), points)
def test_a_normal_form_with_a_root_has_the_values_of_its_graph(expression, values):
    _, b, c = values
    a = abs(values[0])
    assume(c)  # x² is y/z but for a factor: it has no value at z = 0
    try:
        point = [a, a * a * c / b, c]
        expected = at(expression, point)
        reduced = form(expression, roots={x: y * b.numerator / (z * b.denominator)})
    except (ZeroDivisionError, OverflowError):
        assume(False)
    assert reduced.at(point) == expected
    assert all(power[0] < 2 for power in reduced.field.polynomials.terms(reduced.numerator))


SYMPY = sympy.QQ.frac_field(*sympy.symbols("x:z"))


@settings(max_examples=60, deadline=None)
@given(graphs())
def test_sympy_finds_the_same_rational_function(expression):
    """Its field cancels every common divisor, ours none but those that it meets as factors."""
    function = ca.Function("f", [X], [expression])
    try:
        expected = evaluate(function, [SYMPY.gens], SYMPY.convert)[0][0][0]
        found = form(expression)
    except (ZeroDivisionError, OverflowError):
        assume(False)

    def same(p):
        terms = found.field.polynomials.terms(p).items()
        return SYMPY.field.ring.from_dict(
            {e: sympy.QQ(c.numerator, c.denominator) for e, c in terms}
        )

    below = math.prod((same(f) ** k for f, k in found.denominator), start=SYMPY.field.ring.one)
    assert same(found.numerator) * expected.denom == expected.numer * below


@settings(max_examples=100, deadline=None)
@given(graphs(), graphs(), points)
def test_a_verdict_is_right(left, right, values):
    try:
        proof = prove_equal(ca.vertcat(X, left), ca.vertcat(X, right))
    except (ZeroDivisionError, OverflowError):
        assume(False)
    assert proof.terms >= 1
    if not proof:
        values = list(proof.counterexample.values())
        assert list(proof.counterexample) == ["x", "x#2", "x#3"]
        assert at(left, values) - at(right, values) == proof.difference != 0
        return
    try:
        assert at(left, values) == at(right, values)
    except ZeroDivisionError:
        assume(False)


@settings(max_examples=60, deadline=None)
@given(graphs(most=5), graphs(most=5), graphs(most=5))
def test_the_laws_of_a_field(a, b, c):
    try:
        a, b, c = (row[0] for row in normal_form(ca.vertcat(X, a, b, c))[3:])
        assert a / b / c == a / (b * c)
        assert a / b + c / b == (a + c) / b
        assert b * (a / b) == a and a / (a / b) == b
    except (ZeroDivisionError, OverflowError):
        assume(False)
    assert a * (b + c) == c * a + a * b
    assert (a - b) * (a + b) == a * a - b * b
    assert a - a == 0 and a + (b - b) == a


def test_matrix_identities():
    A = ca.SX.sym("A", 3, 3)
    assert prove_equal(ca.inv(A) @ A, ca.SX.eye(3))
    assert prove_equal(ca.det(A @ A), ca.det(A) ** 2)
    assert prove_equal(ca.solve(A, X), ca.inv(A) @ X)
    proof = prove_equal(A @ A.T, A.T @ A)
    M = {name: float(v) for name, v in proof.counterexample.items()}
    M = ca.DM([M[f"A_{i}"] for i in range(9)]).reshape((3, 3))
    assert float(ca.norm_1(ca.vec(M @ M.T - M.T @ M))) > 0


def test_numbers_are_taken_at_their_exact_value():
    assert not prove_equal(ca.SX(0.1) * x, x / 10)
    assert prove_equal(ca.SX(0.25) * x, x / 4)
    assert prove_equal(ca.SX(2), ca.SX(2)) and not prove_equal(ca.SX(2), ca.SX(3))
    # in floating point the constants of the difference would cancel
    assert prove_equal(x + 1e16, x + 1e16 + 1).difference == -1


def test_symbols_of_one_name_are_not_confused():
    assert prove_zero(x - x) and not prove_zero(x - y)
    assert prove_zero((x - y) ** 2).counterexample.keys() == {"x", "x#2"}
    a = ca.vertcat(ca.SX.sym("x#2"), x, y)
    assert len(prove_zero(ca.sum1(a)).counterexample) == 3


@pytest.mark.parametrize(
    ("expression", "name"),
    [(ca.sin(x), "OP_SIN"), (ca.fabs(x), "OP_FABS"), (ca.if_else(x > 0, x, y), "OP_LT")],
)
def test_other_operations_are_refused(expression, name):
    with pytest.raises(NotImplementedError, match=name):
        prove_zero(expression + y)


def test_what_is_never_defined_is_refused():
    with pytest.raises(ZeroDivisionError):
        prove_zero(1 / ((x + y) ** 2 - x * x - 2 * x * y - y * y))
    with pytest.raises(ValueError, match="shapes"):
        prove_equal(X, x)


def test_declared_roots():
    r, s, t = (ca.SX.sym(name) for name in "rst")
    square = x * x + y * y
    roots = {r: square, s: x / y, t: 2 + r}

    def proved(expression):
        return prove_zero(expression, roots)

    assert proved(ca.sqrt(square) - r)
    assert proved(r**4 - square**2) and proved(
        (r + x) ** 3 - r * (square + 3 * x * x) - (3 * x * square + x**3)
    )
    assert proved((t * r) * t - 2 * r - square)
    assert proved(1 / (r + z) - (r - z) / (square - z * z))
    assert proved(1 / (r + s) + 1 / (r - s) - 2 * r / (square - x / y))
    assert proved(ca.sqrt(x / y) ** 3 - s * x / y)
    assert proved(ca.sqrt(4 * square / z**4) - 2 * r / z**2)  # a declared root, up to squares
    assert proved(t * t * (r - 2) - square + 4) and proved(ca.sqrt(2 + ca.sqrt(square)) - t)
    assert proved(ca.sqrt(x**4 * ca.SX(9) / 4) - 1.5 * x * x)
    assert not proved(r - x)
    with pytest.raises(ZeroDivisionError):
        proved(1 / (r * r - square))


@pytest.mark.parametrize("expression", [x, x + y**2, -(x**4), x**4 * 2, x**2 * y**2, x * x - y * y])
def test_the_root_of_something_else_is_refused(expression):
    r = ca.SX.sym("r")
    with pytest.raises(NotImplementedError, match="undeclared"):
        prove_zero(ca.sqrt(expression) - 1, {r: x * x + y * y})


def test_a_root_of_a_square_is_not_its_base():
    r = ca.SX.sym("r")
    proof = prove_zero(r - x, {r: x * x})  # r = |x|
    assert not proof and proof.counterexample["r"] == -proof.counterexample["x"] > 0
    assert prove_zero(r * r - x * x, {r: x * x})
    with pytest.raises(ZeroDivisionError):  # the product of r - x and r + x is zero
        prove_zero(1 / (r - x), {r: x * x})


def test_a_counterexample_has_rational_roots_or_there_is_none():
    P = ca.SX.sym("P", 3)
    r, s = ca.SX.sym("r"), ca.SX.sym("s")
    roots = {r: ca.sumsqr(P), s: ca.sumsqr(P[:2]) + x}
    point = prove_zero(ca.sqrt(ca.sumsqr(P)) - P[2] - s, roots).counterexample
    assert point["r"] ** 2 == sum(point[f"P_{i}"] ** 2 for i in range(3))
    assert point["s"] ** 2 == point["P_0"] ** 2 + point["P_1"] ** 2 + point["x"]
    assert point["r"] >= 0 <= point["s"] and point["r"] - point["P_2"] - point["s"] != 0
    open_answer = prove_zero(r - 1, {r: ca.SX(2)})
    assert not open_answer and open_answer.counterexample is None


def test_roots_are_declared_in_order_and_of_symbols():
    r, s = ca.SX.sym("r"), ca.SX.sym("s")
    assert prove_zero(s * s - r - 1, {r: x, s: r + 1})
    for roots in ({s: r + 1, r: x}, {r: r + x}, {x + y: z}, {r: X}):
        with pytest.raises(ValueError, match=r"root|symbol"):
            prove_zero(x, roots)


@pytest.fixture(scope="module")
def loop():
    return derive_error_dynamics()


def test_the_closed_loop_in_error_coordinates(loop):
    d, f, e = loop.design, loop.f, Errors.from_vector(loop.errors)
    Omega = measurement_of_errors(loop.errors, thrust_of_factor(f, d), d).rate
    Q, P = ca.SX.sym("Q", 3, 3), ca.SX.eye(3)[:2, :]
    m, k1, k12, q = d.mass, d.k1, d.k1 * d.k2, d.goal_centroid
    d4 = ca.vertcat(e.d4, 0)
    Qv = Q @ (e.d1 + e.d2)
    turn = k1 * f * (q[2] * ca.SX.eye(3) - E3 @ q.T) @ (d4 - e.d3)
    chain = -k12 * e.d2
    rate = ca.vertcat(
        -m * skew(Omega) @ e.d1 - k1 * Qv + turn,
        -m * skew(Omega) @ e.d2 + k1 * Qv + chain + k12 * e.d3 - turn,
        -m * skew(Omega) @ e.d3 + k1 * Qv + chain + (k12 + d.k3) * d4 - d.k3 * e.d3,
        P @ (k1 * Qv - (k12 + d.k3) * e.d3) - d.k4 * e.d4,
    )
    assert prove_equal(m * loop.rate_with_depths(Q), rate)

    for i in range(11):  # any one component that is off by a term is refuted
        off = ca.SX(ca.Sparsity(11, 1))
        off[i] = f * e.d3[0]
        proof = prove_equal(m * loop.rate_with_depths(Q), rate + off)
        point = proof.counterexample
        assert proof.difference == -point["f"] * point["X_6"] != 0


def test_the_dissipation_is_the_quadratic_form_of_sigma(loop):
    form = derive_lyapunov_form(loop)
    X = form.errors
    assert prove_equal(form.dissipation, X.T @ form.Sigma @ X)
    assert prove_equal(form.Sigma, form.Sigma.T)
    assert not prove_equal(form.dissipation, 2 * X.T @ form.Sigma @ X)


def test_the_centroid_of_a_moving_camera():
    P, V, Omega, r = ca.SX.sym("P", 3, 2), ca.SX.sym("V", 3), ca.SX.sym("Om", 3), ca.SX.sym("r", 2)
    distances = {r[i]: ca.sumsqr(P[:, i]) for i in range(2)}
    q = camera.centroid(P / ca.repmat(ca.sqrt(ca.sum1(P * P)), 3, 1))
    motion = -skew(Omega) @ P - ca.repmat(V, 1, 2)
    flow = lie_derivative(q, ca.vec(P), ca.vec(motion))
    expected = camera.centroid_rate(q, Omega, camera.depth_matrix(P) @ V)
    assert prove_equal(flow, expected, distances)
    proof = prove_equal(flow, expected + V / r[0], distances)
    assert proof.difference != 0 and proof.counterexample["r_0"] > 0
