"""The control design: errors, a controller without depths, and Σ."""

from __future__ import annotations

from dataclasses import fields, replace
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import checker_kit
from hoverproof.algebra.graph import evaluate
from hoverproof.errors import InputError
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY, wanted_rates
from hoverproof.servo.lyapunov import (
    Errors,
    derive_error_dynamics,
    derive_lyapunov_form,
    measurement_of_errors,
    thrust_factor,
    thrust_of_factor,
)
from hoverproof.servo.variables import Design, Measurement

positive = st.fractions(min_value=Fraction(1, 9), max_value=9, max_denominator=9)
signed = st.fractions(min_value=-3, max_value=3, max_denominator=9)


def test_the_controller_knows_its_measurements_and_design_and_nothing_else():
    law = derive_controller()
    f = ca.Function(
        "f", [law.measured.vector(), law.design.vector()], [law.thrust_rate, law.torque]
    )
    assert not f.free_sx()
    assert [f.name for f in fields(Measurement)] == [
        *("centroid", "velocity", "gravity_direction", "rate", "thrust"),
    ]


def test_a_wish_that_needs_the_depths_is_refused():
    def blind(e, measured, design, depth_flow):
        return wanted_rates(e, measured, design, ca.SX.zeros(3))

    with pytest.raises(InputError, match="depths"):
        derive_controller(replace(HAMEL_MAHONY, wanted_rates=blind))


def test_the_controller_does_what_it_was_solved_for():
    """δ̇3 and δ̇4 along the closed loop, Ω3 not zero, any depth flow."""
    controller = derive_controller()
    z, d, y = controller.measured, controller.design, ca.SX.sym("y", 3)
    e = HAMEL_MAHONY.errors(z, d)
    wanted = wanted_rates(e, z, d, y)
    got = ca.jtimes(e.vector(), z.vector(), controller.measured_rate(y))
    difference = ca.vertcat(got[8] - wanted.d3_vertical, got[9:11] - wanted.d4)
    f = ca.Function("f", [z.vector(), d.vector(), y], [difference, got])
    rng = np.random.default_rng(1)
    for _ in range(50):
        design = rng.uniform(0.5, 2, 13)
        measured = rng.normal(size=13) + np.r_[np.zeros(12), 50]
        error, size = f(measured, design, rng.normal(size=3))
        assert np.abs(np.array(error)).max() <= 1e-10 * max(1, np.abs(np.array(size)).max())


def test_errors_and_measurements_are_one_to_one():
    x, thrust, d = ca.SX.sym("X", 11), ca.SX.sym("T"), Design.symbols()
    back = HAMEL_MAHONY.errors(measurement_of_errors(x, thrust, d), d).vector()
    f = ca.Function("f", [x, thrust, d.vector()], [back])
    rng = np.random.default_rng(2)
    values = rng.normal(size=11)
    assert np.allclose(np.array(f(values, 50, rng.uniform(0.5, 2, 13))).ravel(), values)


def test_the_thrust_factor_and_its_inverse():
    thrust, d = ca.SX.sym("T"), Design.symbols()
    back = thrust_of_factor(thrust_factor(thrust, d), d)
    f = ca.Function("f", [thrust, d.vector()], [back])
    assert float(f(50, np.linspace(0.5, 2, 13))) == pytest.approx(50)


@pytest.mark.slow
@given(
    gains=st.tuples(*[positive] * 4),
    mass=positive,
    goal=st.tuples(*[signed] * 3),
    weights=st.tuples(*[positive] * 4),
    depths=st.tuples(*[signed] * 6),
    f=positive,
)
def test_sigma_of_the_graph_is_the_sigma_of_the_checker(gains, mass, goal, weights, depths, f):
    """Two independent sources of Σ agree in every bit: the derived graph, and checker.py."""
    one = Fraction(1)
    design = [mass, one, one, one, one, *gains, one, *goal]
    sigma, u, v = evaluate(_SIGMA, [design, weights, depths, [f]])
    a, b, c, d, e, g = depths
    Q = [[a, b, c], [b, d, e], [c, e, g]]
    names = dict(zip(("k1", "k2", "k3", "k4"), gains, strict=True))
    assert sigma == checker_kit.sigma(names, weights, Q, f, goal)

    w1, w2, w3, w4 = weights
    rows = [[0] * 11 for _ in range(3)]
    for i in range(3):
        rows[i][i], rows[i][3 + i], rows[i][6 + i] = w1, -w2, -w3
        if i < 2:
            rows[i][9 + i] = -w4
    assert u == rows
    assert v == [[int(j in (i, 3 + i)) for j in range(11)] for i in range(3)]


_SIGMA = derive_lyapunov_form().function()


@pytest.mark.slow
@given(
    numbers=st.lists(positive, min_size=13, max_size=13),
    weights=st.tuples(*[positive] * 4),
    depths=st.tuples(*[signed] * 6),
    x=st.lists(signed, min_size=11, max_size=11),
    f=positive,
)
def test_the_dissipation_is_the_quadratic_form_of_sigma(numbers, weights, depths, x, f):
    """-m L̇ = XᵀΣX exactly, at rational points."""
    (value,), sigma = evaluate(_DISSIPATION, [numbers, weights, depths, [f], x])
    assert value[0] == sum(
        a * entry * b
        for a, row in zip(x, sigma, strict=True)
        for entry, b in zip(row, x, strict=True)
    )


def _dissipation():
    form = derive_lyapunov_form()
    inputs = [form.design.vector(), form.weights, form.Q_lower, form.f, form.errors]
    return ca.Function("dissipation", inputs, [form.dissipation, form.Sigma])


_DISSIPATION = _dissipation()


@pytest.mark.slow
@given(
    numbers=st.lists(positive, min_size=13, max_size=13),
    flow=st.tuples(*[signed] * 3),
    x=st.lists(signed, min_size=11, max_size=11),
    f=positive,
)
def test_the_error_rates_have_the_closed_form(numbers, flow, x, f):
    """m δ̇i as in the docstring of checker.py, rotation terms included, at rational points."""
    (derived,), (closed,) = ([column] for column in evaluate(_RATES, [numbers, flow, x, [f]]))
    assert derived == closed


def _rates():
    loop = derive_error_dynamics()
    d, x, f, y = loop.design, loop.errors, loop.f, loop.depth_flow
    e = Errors.from_vector(x)
    omega = ca.skew(measurement_of_errors(x, thrust_of_factor(f, d), d).rate)
    q = d.goal_centroid
    A = q[2] * ca.SX.eye(3) - ca.SX([0, 0, 1]) @ q.T
    d4 = ca.vertcat(e.d4, 0)
    k12 = d.k1 * d.k2
    turn = d.k1 * f * A @ (d4 - e.d3)
    m = d.mass
    closed = ca.vertcat(
        -m * omega @ e.d1 - m * y + turn,
        -m * omega @ e.d2 + m * y - k12 * e.d2 + k12 * e.d3 - turn,
        -m * omega @ e.d3 + m * y - k12 * e.d2 + (k12 + d.k3) * d4 - d.k3 * e.d3,
        (m * y - (k12 + d.k3) * e.d3)[:2] - d.k4 * e.d4,
    )
    return ca.Function("rates", [d.vector(), y, x, f], [m * loop.rate, closed])


_RATES = _rates()
