"""Verdicts on gains: bounds from both sides, exact witnesses, and nothing certified that is not."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from checker_kit import sigma
from hoverproof.certification.gains import certify
from hoverproof.certification.problem import gain_problem
from hoverproof.certification.verdict import Proved, Refuted, Undecided
from hoverproof.errors import InputError
from hoverproof.mission.reading import load


def sampled_worst(mission, count=300, seed=0):
    """Return the smallest eigenvalue of Σ over random extremal and interior Q, both ends of f."""
    problem = gain_problem(mission)
    rng = np.random.default_rng(seed)
    low, high = map(float, problem.eigenvalues)
    g = {k: float(v) for k, v in mission.gains if v is not None}
    q = [float(c) for c in problem.goal.centroid_midpoint]
    worst = np.inf
    for _ in range(count):
        basis, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        values = rng.choice([low, high, rng.uniform(low, high)], size=3)
        Q = (basis * values) @ basis.T
        for f in map(float, problem.factor):
            found = np.array(sigma(g, [1, 1, 1, 1], Q.tolist(), f, q), float)
            worst = min(worst, np.linalg.eigvalsh(found)[0])
    return worst


def test_the_paper_s_gains_are_proved(x4):
    verdict = certify(x4)
    assert isinstance(verdict, Proved)
    assert 1.0e-3 < verdict.margin <= verdict.margin_above < 1.8e-3
    assert verdict.margin_above - verdict.margin < verdict.margin / 10**6
    assert verdict.decay_rate == 2 * verdict.margin / x4.vehicle.mass


def test_at_the_thrust_of_hover_alone_the_worst_eigenvalue_is_that_of_the_literature():
    verdict = certify(load("x4-flyer", {"bounds.thrust": "[94.08, 94.08]"}))
    assert float(verdict.margin) == pytest.approx(1.735e-3, abs=5e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        {},
        {"goal": "{centroid = [0.3, 0.2, 3.5]}"},
        {"goal": "{centroid = [-1, 1.5, 1]}", "bounds.eigenvalues": "[0.01, 6]"},
        {"target.points": "[[0, 0, 0], [1, 0, 0], [0, 2, 0.1]]"},
        {"bounds": "{eigenvalues = [0.01, 5], level = 10}"},
        {"gains.k3": "40", "gains.k4": "10"},
        {"bounds.eigenvalues": "[0.0164, 1.2]"},
    ],
)
def test_no_sample_lies_below_the_proved_margin(change):
    mission = load("x4-flyer", change)
    verdict = certify(mission)
    assert isinstance(verdict, Proved)
    assert float(verdict.margin) <= sampled_worst(mission) + 1e-12
    assert verdict.margin_above - verdict.margin < verdict.margin / 10**6


@pytest.mark.parametrize("k4", ["0.1", "0.3", "0.5"])
def test_gains_with_a_small_k4_are_refuted_by_an_exact_witness(k4):
    mission = load("x4-flyer", {"gains.k4": k4})
    verdict = certify(mission)
    assert isinstance(verdict, Refuted)
    names = dict(mission.gains)
    low, high = verdict.problem.goal.centroid[2]
    for q3 in (low, high):
        S = sigma(names, [1, 1, 1, 1], verdict.Q, verdict.f, [0, 0, q3])
        value = sum(verdict.X[i] * S[i][j] * verdict.X[j] for i in range(11) for j in range(11))
        assert value <= verdict.value < 0
    eigenvalues = np.linalg.eigvalsh(np.array(verdict.Q, float))
    assert 0.01 < eigenvalues.min() <= eigenvalues.max() < 5
    lowest, highest = verdict.problem.factor_attained
    assert lowest <= verdict.f <= highest


def test_the_verdict_turns_once_along_a_gain():
    """From refuted to proved as k4 grows, with margins that pass through zero together."""
    verdicts = [
        certify(load("x4-flyer", {"gains.k4": f"{k4:.2f}"})) for k4 in np.arange(0.2, 1.6, 0.2)
    ]
    kinds = [v.status for v in verdicts]
    turn = kinds.index("proved")
    assert turn > 0
    assert set(kinds[:turn]) == {"refuted"}
    assert set(kinds[turn:]) == {"proved"}
    above = [v.margin_above for v in verdicts]
    assert above == sorted(above)


def test_a_thrust_interval_that_reaches_the_singularity_is_refused():
    with pytest.raises(
        InputError, match=r"bounds\.thrust: lets the thrust sink to 0\.1 N.*0\.1507"
    ):
        certify(load("x4-flyer", {"bounds.thrust": "[0.1, 100]"}))
    with pytest.raises(InputError, match=r"bounds\.level: lets the thrust sink"):
        certify(load("x4-flyer", {"bounds": "{eigenvalues = [0.01, 5], level = 1e9}"}))


def test_a_level_gives_the_thrust_interval_that_it_implies():
    problem = gain_problem(load("x4-flyer", {"bounds": "{eigenvalues = [0.01, 5], level = 4}"}))
    c = Fraction("0.04") * 10 / Fraction("9.6")
    assert abs(problem.thrust[0] - (Fraction("94.08") - 4 * c)) < Fraction(1, 10**18)
    assert abs(problem.thrust[1] - (Fraction("94.08") + 4 * c)) < Fraction(1, 10**18)


def test_a_solver_that_finds_nothing_leaves_the_question_undecided(x4, monkeypatch):
    def nothing(_):
        raise np.linalg.LinAlgError("eigenvalues did not converge")

    monkeypatch.setattr("hoverproof.certification.gains.margins", nothing)
    assert isinstance(certify(x4), Undecided)


@pytest.mark.parametrize("tau", [1e-6, 0.5, 1.5, 1e6])
def test_a_bad_multiplier_never_proves_too_much(x4, monkeypatch, tau):
    best = certify(x4)
    found = (None, np.array([tau]))
    monkeypatch.setattr("hoverproof.certification.gains.margins", lambda _: found)
    verdict = certify(x4)
    assert not isinstance(verdict, Refuted)
    if isinstance(verdict, Proved):
        assert verdict.margin <= best.margin_above
