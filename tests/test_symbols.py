"""Every symbol in the formulas of a report is explained beside them."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

import pytest

from hoverproof.algebra.graph import evaluate
from hoverproof.certification.gains import certify
from hoverproof.cli.answers.glossary import legend
from hoverproof.mission.reading import load
from hoverproof.reporting import mathematics, symbol_tables
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.lyapunov import force_function
from once import attraction_once

NAMES = {
    r"\\Psi": "Ψ",
    r"\\Lambda": "Λ",
    r"\\Sigma": "Σ",
    r"\\mathcal\{L\}": "ℒ",
    r"\\delta_(\d)": r"δ\1",
    r"\\mu(?!_)": "μ",
    r"\\mu_T": "μT",
    r"(?<!bar)\\tau": "τ",
    r"\\bar\\tau": "τ̄",
    r"\\xi": "ξ",
    r"\\rho": "ρ",
    r"\\ell_\\infty": "ℓ∞",
    r"\\mathrm\{margin\}": "margin",
    r"\b([XJQTWhryq])(?![A-Za-z])": r"\1",
}
"""How a symbol is written in formulas, and in words."""
NO_SYMBOL = r"\\mathrm\{(?!margin)[^}]*\}|\\(?:left|right|quad|tfrac|frac)|\^T"


def unexplained(lines, symbols):
    """Return the symbols of formulas that are not among those explained."""
    text = re.sub(NO_SYMBOL, " ", " ".join(lines))
    used = {match.expand(name) for mark, name in NAMES.items() for match in re.finditer(mark, text)}
    assert len(used) > 5
    return used - {name for names, _ in symbols for name in names.split(", ")}


@pytest.mark.parametrize("name", ["crazyflie-2.1", "x4-flyer"])
def test_every_symbol_of_the_theorem_about_gains_is_explained(name):
    verdict = certify(load(name))
    problem, symbol = verdict.problem, verdict.problem.flow.symbol
    given = problem.eigenvalues, problem.thrust, verdict.margin, verdict.decay_rate
    told = list(symbol_tables.of_gains(verdict.mission, symbol))
    assert unexplained(mathematics.claim(*given, symbol), told) == set()


def test_every_symbol_of_the_potential_theorem_is_explained():
    region = attraction_once(load("x4-flyer"))
    told = symbol_tables.of_starts(region)
    assert unexplained(mathematics.attraction_claim(region), told) == set()


def test_every_symbol_of_the_exponential_theorem_is_explained_and_noise_leaves_something():
    proved = attraction_once(load("crazyflie-2.1"))
    noisy = replace(proved, ultimate_radius=Fraction(1, 100))
    for verdict, left in ((proved, set()), (noisy, {"ℓ∞"})):
        lines = mathematics.exponential_claim(verdict)
        assert unexplained(lines, symbol_tables.of_starts(verdict)) == set()
        assert unexplained(lines, symbol_tables.of_starts(proved)) == left


def factor_of(mission, thrust):
    """Return f(T), from the graph."""
    law = law_of(mission)
    design = law.design.values(mission, law.goal_feature(mission))
    return evaluate(force_function(law), [design, [thrust]])[2][0][0]


@pytest.mark.parametrize("law", [{}, {"law.goal": "inertial"}], ids=["paper's", "inertial"])
def test_a_counterexample_tells_a_thrust_in_the_interval_that_has_its_f(law):
    refuted = certify(load("x4-flyer", {"gains.k4": "0.1", **law}))
    low, high = refuted.problem.thrust
    assert low <= refuted.thrust <= high
    assert float(factor_of(refuted.mission, refuted.thrust)) == pytest.approx(
        float(refuted.f), rel=1e-12
    )


def test_the_formula_of_f_is_that_of_the_graph():
    told = " ".join(" ".join(legend(["  f = 1 1/m"])).split())
    formula = re.search(r"f\(T\) = (.*?), how", told)[1]
    mission = load("x4-flyer")
    given = {k: getattr(mission.gains, k) for k in ("k1", "k2", "k3")}
    given |= {"m": mission.vehicle.mass, "s": law_of(mission).goal_feature(mission)[2]}
    given |= {"T": Fraction(90), "c": given["k1"] ** 2 * given["k2"] / given["m"]}
    times = re.sub(r"(?<=[\w)]) (?=[\w(])|(?<=/\(m) (?=\()", " * ", formula)
    assert eval(times, {}, given) == factor_of(mission, Fraction(90))
