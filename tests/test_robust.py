"""The one robust inequality: no H in the ball makes it worse than it says, and one comes near."""

from __future__ import annotations

import cvxpy as cp
import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.optimize import minimize

from hoverproof.certification.robust import (
    Inequality,
    Term,
    margins,
    optimise,
    reciprocals,
    worst_case,
)

SEEDS = range(8)


def symmetric(rng, *shape):
    a = rng.normal(size=(*shape, shape[-1]))
    return a + a.swapaxes(-1, -2)


def drawn(rng, n=6, m=3, terms=1, k=()):
    """Return random inequalities, one or k of them."""
    made = tuple(
        Term(
            rng.normal(size=(*k, m, n)),
            rng.normal(size=(m, n)),
            rng.uniform(0.1, 3, size=k or None),
        )
        for _ in range(terms)
    )
    return Inequality(symmetric(rng, *k, n), made)


def in_blocks(rng, k):
    """Return k inequalities that fall apart into three blocks, two of which are the same."""
    parts = [drawn(rng, n, 1, k=(k,)) for n in (4, 3)]
    (u, v, radius), (u2, v2, _) = (p.terms[0] for p in parts)
    S = np.array([block_diag(a, a, b) for a, b in zip(parts[0].S, parts[1].S, strict=True)])
    us = np.array([block_diag(a, a, b) for a, b in zip(u, u2, strict=True)])
    return Inequality(S, (Term(us, block_diag(v, v, v2), radius),))


def one_of(many, k):
    terms = tuple(Term(t.u[k], t.v, t.radius[k]) for t in many.terms)
    return Inequality(many.S[k], terms)


def least_eigenvalue(one, Hs):
    total = one.S + sum(t.u.T @ H @ t.v for t, H in zip(one.terms, Hs, strict=True))
    return np.linalg.eigvalsh((total + total.T) / 2)[0]


def lowest_found(one, rng, tries=6):
    """Return the lowest eigenvalue that a descent over H = -r a bᵀ, |a| = |b| = 1, comes to."""
    sizes = [(len(t.u), t.radius) for t in one.terms]

    def value(x):
        Hs, at = [], 0
        for m, r in sizes:
            a, b = x[at : at + m], x[at + m : at + 2 * m]
            at += 2 * m
            Hs.append(-r * np.outer(a, b) / (np.linalg.norm(a) * np.linalg.norm(b)))
        return least_eigenvalue(one, Hs)

    starts = [rng.normal(size=2 * sum(m for m, _ in sizes)) for _ in range(tries)]
    return min(minimize(value, x).fun for x in starts)


def by_cvxpy(one):
    """Return the margin as a semidefinite program, stated anew."""
    t, S = cp.Variable(), one.S - 0.0
    taus = [cp.Variable(nonneg=True) for _ in one.terms]
    n = len(S)
    corner = S - t * np.eye(n) - sum(x * p.v.T @ p.v for x, p in zip(taus, one.terms, strict=True))
    rows = [[corner, *(p.radius / 2 * p.u.T for p in one.terms)]]
    for i, p in enumerate(one.terms):
        m = len(p.u)
        tail = [taus[i] * np.eye(m) if j == i else np.zeros((m, m)) for j in range(len(taus))]
        rows.append([p.radius / 2 * p.u, *tail])
    block = cp.bmat(rows)
    cp.Problem(cp.Maximize(t), [(block + block.T) / 2 >> 0]).solve(solver=cp.CLARABEL)
    return float(t.value)


# --- one term -------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_no_matrix_of_the_ball_symmetric_or_not_lies_below_the_margin(seed):
    rng = np.random.default_rng(seed)
    one = drawn(rng)
    margin, _ = margins(one)
    radius = one.terms[0].radius
    for _ in range(300):
        H = rng.normal(size=(3, 3))
        H *= radius / np.linalg.norm(H, 2) * rng.choice([1, rng.uniform()])
        assert least_eigenvalue(one, [H]) >= margin - 1e-9
    assert lowest_found(one, rng) == pytest.approx(margin, abs=1e-5)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_worst_case_is_a_symmetric_matrix_that_comes_down_to_the_margin(seed):
    one = drawn(np.random.default_rng(seed))
    margin, tau = margins(one)
    x, w = worst_case(one, float(tau[0]))
    H = one.terms[0].radius * (np.eye(3) - 2 * np.outer(w, w) / (w @ w))
    u, v, _ = one.terms[0]
    value = x @ one.S @ x + (u @ x) @ H @ (v @ x)
    assert margin <= value / (x @ x) + 1e-12
    assert value / (x @ x) == pytest.approx(margin, abs=1e-6 * np.abs(one.S).max())


@pytest.mark.parametrize("seed", SEEDS)
def test_the_margin_is_that_of_the_semidefinite_program(seed):
    one = drawn(np.random.default_rng(seed), n=5, m=2)
    margin, tau = margins(one)
    assert margin == pytest.approx(by_cvxpy(one), abs=1e-6)
    assert np.linalg.eigvalsh(one.bound(tau))[0] == pytest.approx(margin, rel=1e-12)


@pytest.mark.parametrize("make", [in_blocks, lambda rng, k: drawn(rng, k=(k,))])
def test_many_at_once_are_what_each_is_alone(make):
    many = make(np.random.default_rng(3), 40)
    values, tau = margins(many)
    for k, value in enumerate(values):
        one = one_of(many, k)
        best, _ = margins(one)
        assert value == pytest.approx(best, rel=1e-8)
        ladder = tau[k, 0] * np.geomspace(0.01, 100, 400)
        assert np.linalg.eigvalsh(one.bound(ladder[:, None])).min(axis=1).max() <= value + 1e-9


def test_margins_below_a_floor_are_found_to_be_below_and_the_others_exactly():
    many = in_blocks(np.random.default_rng(4), 200)
    values, _ = margins(many)
    floor = float(np.quantile(values, 0.8))
    rough, _ = margins(many, floor)
    high = values >= floor
    assert rough[high] == pytest.approx(values[high], rel=1e-8)
    assert (rough[~high] < floor).all()


def test_a_term_that_vanishes_costs_nothing():
    rng = np.random.default_rng(5)
    one = drawn(rng)
    none = Inequality(one.S, (one.terms[0]._replace(u=np.zeros((3, 6))),))
    assert margins(none)[0] == pytest.approx(np.linalg.eigvalsh(one.S)[0], rel=1e-6)


def test_numbers_that_are_not_finite_are_refused():
    one = drawn(np.random.default_rng(6))
    with pytest.raises(np.linalg.LinAlgError):
        margins(Inequality(one.S * np.nan, one.terms))


# --- several terms --------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_with_several_terms_no_sample_lies_below(seed):
    rng = np.random.default_rng(seed)
    one = drawn(rng, terms=3, m=2)
    margin, tau = margins(one)
    assert tau.shape == (3,)
    assert (tau > 0).all()
    assert margin == pytest.approx(by_cvxpy(one), rel=1e-6)
    assert margin <= lowest_found(one, rng) + 1e-9


def test_terms_of_separate_blocks_cost_what_each_does():
    rng = np.random.default_rng(7)
    a, b = drawn(rng), drawn(rng)
    (ua, va, ra), (ub, vb, rb) = a.terms[0], b.terms[0]
    no = np.zeros((3, 6))
    terms = (
        Term(np.hstack([ua, no]), np.hstack([va, no]), ra),
        Term(np.hstack([no, ub]), np.hstack([no, vb]), rb),
    )
    both, _ = margins(Inequality(block_diag(a.S, b.S), terms))
    assert both == pytest.approx(min(margins(a)[0], margins(b)[0]), abs=1e-7)


# --- parameters -----------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_the_best_parameters_are_those_of_cvxpy(seed):
    """Minimise c·x with two corners, affine in x, and Σ 1/xᵢ bounded."""
    rng = np.random.default_rng(seed)
    corners = []
    for _ in range(2):
        parts = drawn(rng, n=5, m=2, k=(3,))
        plus = np.array([20 * np.eye(5), 2 * np.eye(5), np.eye(5)])
        term = parts.terms[0]._replace(radius=np.array(0.7))
        corners.append(Inequality(parts.S / 10 + plus, (term,)))
    cost = rng.uniform(0.5, 2, 2)
    rows = np.array([[4.0, -1, 0], [0, 0, 1]])
    found = optimise(cost, corners, rows=rows, pencils=[reciprocals(1.5, {1: 1, 2: 0.5}, 3)])
    x = cp.Variable(2)
    wanted = [x[0] <= 4, x[1] >= 0, cp.inv_pos(x[0]) + 0.5 * cp.inv_pos(x[1]) <= 1.5]
    for corner in corners:
        tau, (u, v, r) = cp.Variable(), corner.terms[0]
        S = corner.S[0] + x[0] * corner.S[1] + x[1] * corner.S[2] - tau * v.T @ v
        side = float(r) / 2 * (u[0] + x[0] * u[1] + x[1] * u[2])
        block = cp.bmat([[S, side.T], [side, tau * np.eye(2)]])
        wanted.append((block + block.T) / 2 >> 0)
    problem = cp.Problem(cp.Minimize(cost @ x), wanted)
    problem.solve(solver=cp.CLARABEL)
    assert cost @ found.x == pytest.approx(problem.value, rel=1e-5)
    for corner, tau in zip(corners, found.multipliers, strict=True):
        held = corner.at([1, *found.x])
        assert np.linalg.eigvalsh(held.bound(tau))[0] >= -1e-7
        assert margins(held)[0] >= -1e-7


def test_parameters_that_cannot_be_are_none():
    one = Inequality(
        -np.eye(3)[None], (Term(np.zeros((1, 1, 3)), np.zeros((1, 3)), np.array(1.0)),)
    )
    assert optimise([1.0], [one]) is None


def test_the_margin_of_scaled_variables_is_one_in_units_of_the_weights():
    rng = np.random.default_rng(8)
    one, w = drawn(rng), rng.uniform(0.5, 3, 6)
    margin, tau = margins(one.scaled(w))
    least = np.linalg.eigvalsh(one.bound(tau) - margin * np.diag(w))[0]
    assert least == pytest.approx(0, abs=1e-9)
