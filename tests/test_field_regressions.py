"""Failures known from proofs that rest on a solver's word, each by its name."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest

from checker_kit import definite
from hoverproof import checker
from hoverproof.algebra.definite import is_positive_definite
from hoverproof.certification import gains
from hoverproof.certification.gains import certify
from hoverproof.certification.robust import Inequality
from hoverproof.certification.verdict import Proved
from hoverproof.errors import InputError
from hoverproof.mission.reading import load

F = Fraction
DECIDERS = pytest.mark.parametrize("decide", [is_positive_definite, definite])
WEAK = {"gains.k4": "0.1"}


def forged(content, **parts):
    """Return a copy of a certificate with parts replaced, statement and hashes made anew."""
    new = copy.deepcopy(content) | parts
    new["statement"] = checker.statement(new)
    new["sha256"] = checker.digest({k: v for k, v in new.items() if k != "sha256"})
    return new


@pytest.fixture(scope="module")
def proved():
    return certify(load("x4-flyer")).certificate.content


@pytest.mark.parametrize("tau", [1e-9, 1e-3, 0.99, 1.0, 1.7, 1e9])
def test_a_solver_that_says_optimal_with_an_infeasible_matrix(monkeypatch, tau):
    """Whatever multiplier and margin a solver reports, gains that do not work are not proved."""
    monkeypatch.setattr(gains, "margins", lambda _: (np.array(0.5), np.array([tau])))
    monkeypatch.setattr(Inequality, "bound", lambda *_: 0.5 * np.eye(11))  # "optimal", it says
    assert not isinstance(certify(load("x4-flyer", WEAK)), Proved)


def test_weights_from_a_solver_that_are_infeasible(monkeypatch):
    monkeypatch.setattr(gains, "_best_weights", lambda _: np.array([1.0, 50.0, 1e-3, 1e3]))
    mission = load("x4-flyer")
    assert not isinstance(certify(mission, weights=gains.search_weights(mission)), Proved)


@pytest.mark.parametrize("margin", ["-1/1000000000000", "0", "-0"])
def test_a_margin_just_below_zero_is_no_proof(proved, margin):
    mass = F(proved["mission"]["vehicle"]["mass"])
    rate = "-0" if margin == "-0" else str(2 * F(margin) / mass)
    claim = {"margin": margin, "decay_rate": rate}
    vertices = [vertex | claim for vertex in proved["vertices"]]
    with pytest.raises(checker.Rejected, match=r"zero or less|lowest terms"):
        checker.check(forged(proved, claim=claim, vertices=vertices))


@pytest.mark.slow
def test_a_margin_is_never_proved_where_the_worst_eigenvalue_is_a_hair_below_zero():
    """The gain k4 is moved until Σ turns; on either side by 1e-12 nothing false is proved."""
    low, high = F(1, 10), F(3)  # refuted, proved
    for _ in range(50):
        middle = (low + high) / 2
        verdict = certify(load("x4-flyer", {"gains.k4": f"{float(middle)!r}"}))
        if isinstance(verdict, Proved):
            assert 0 < verdict.margin <= verdict.margin_above
            high = middle
        else:
            low = middle
    edge = float(low)
    for k4 in (edge - 1e-9, edge - 1e-12, edge, edge + 1e-12, edge + 1e-9):
        verdict = certify(load("x4-flyer", {"gains.k4": f"{k4!r}"}))
        if isinstance(verdict, Proved):
            assert 0 < verdict.margin <= verdict.margin_above
            checker.check(verdict.certificate.content)


@DECIDERS
def test_an_indefinite_matrix_with_positive_leading_minors_of_order_three(decide):
    matrix = [[F(int(i == j)) for j in range(11)] for i in range(11)]
    matrix[3][3] = -F(1, 10**30)
    assert not decide(matrix)


@DECIDERS
def test_a_zero_pivot(decide):
    assert not decide([[F(0), F(1)], [F(1), F(5)]])
    assert not decide([[F(1), F(1), F(0)], [F(1), F(1), F(1)], [F(0), F(1), F(9)]])


@DECIDERS
@pytest.mark.parametrize("sign", [-1, 0, 1])
def test_integers_of_five_thousand_digits(decide, sign):
    """The determinant is s/10^5000, of numbers near 10^5000."""
    n = F(10**5000 + 7)
    hair = (1 + F(sign, 10**5000)) / n
    assert decide([[n, n + 1], [n + 1, n + 2 + hair]]) is (sign > 0)


def test_a_file_with_integers_of_five_thousand_digits_is_refused_at_once(proved, tmp_path):
    for name, text in (("string", '"' + "9" * 5000 + '"'), ("bare", "9" * 5000)):
        path = tmp_path / f"{name}.json"
        path.write_text(json.dumps(forged(proved) | {"weights": "@"}).replace('"@"', text))
        run = [sys.executable, "-I", "-S", checker.__file__, str(path)]
        done = subprocess.run(run, capture_output=True, text=True, timeout=20)
        assert done.returncode in (1, 2)
        assert "Traceback" not in done.stderr
    with pytest.raises(InputError):
        load("x4-flyer", {"gains.k1": "9" * 5000})
