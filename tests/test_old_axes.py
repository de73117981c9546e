"""A late image that is used in the axes the camera had then: proved, flown, forged."""

from __future__ import annotations

import copy
from fractions import Fraction as F

import numpy as np
import pytest

import test_potential
import uncertain_body as kit
from exponential_truth import MISSION, NEAR, OfPotential, Truth, soon_found
from hoverproof import checker
from hoverproof.certification.attraction.proof import attraction
from hoverproof.certification.exponential import proof
from hoverproof.mission.reading import load
from papers_law import CRAZYFLIE
from test_hostile_exponential import changed, larger, pruned
from test_uncertain_flights import EIGHT, content, holds, in_doubt
from uncertain_body import Case, View, size
from uncertain_flights import fly, strongest

OLD = NEAR | {"sensors.gyro_turned": "false", "uncertainty.wind": "0"}
CASES = {
    "inertial": OLD | {"uncertainty.rotor_lag": "0"},
    "image": OLD | {"law.goal": "image", "uncertainty.latency": "0.03"},
}


@pytest.fixture(scope="module")
def proofs():
    made = {}

    def of(name):
        if name not in made:
            with soon_found():
                made[name] = proof.converge(load(MISSION, CASES[name]))
        return made[name]

    return of


@pytest.fixture(scope="module")
def natural():
    keys = test_potential.GAINS | test_potential.LATE | {"law.force": "measured"}
    more = {"uncertainty.yaw_rate": "0.2", "uncertainty.torque": "0.1"}
    return attraction(load(CRAZYFLIE, keys | more), barrier=False)


# --- how it moves -------------------------------------------------------------------------------


@pytest.mark.parametrize("law", EIGHT, ids="/".join)
def test_a_feature_in_old_axes_changes_by_the_depth_flow_and_the_turn(law):
    """s' = -y - Ω×s, and the part of Ω×s that is not of tilting is Ω3 e3×(Pδ1 or Pδ1 + s3*Pρ)."""
    made = content("all at once", law)
    made["mission"]["uncertainty"]["gyro_turned"] = "false"
    case, step = Case(made), 1e-30
    view, level = in_doubt(case, np.random.default_rng(31), 200)
    ahead = View(case, view.x + 1j * step * kit.body_rate(view, level), view.doubt)
    s, flow = view.feature(view.level_image), view.feature(view.level_flow)
    rate = ahead.feature(ahead.level_image).imag / step
    assert rate == pytest.approx(-flow - kit.cross(view.Omega, s), rel=1e-9, abs=1e-9)
    d1, d2, d3, d4 = kit.parts(view.errors())
    wind = view.wind if case.measured else 0 * view.wind
    lean = (case.c * (d3 - d2)[:2] - case.m * wind[:2]) / (case.m * case.g)
    aside = d1[:2] + (0 if case.fixed else case.s3 * lean)
    assert s[:2] == pytest.approx(aside, rel=1e-9, abs=1e-9)
    tilting = kit.cross(view.Omega * [[1], [1], [0]], s)
    most = case.c * case.kappa / view.D * size(d4 - d3[:2]) * size(s)
    assert (size(tilting) <= most * (1 + 1e-9)).all()


# --- proofs -------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_it_is_proved_and_said(name, proofs):
    found = proofs(name)
    assert found.status == "proved", found.reason
    said = checker.check(found.certificate.content)
    assert "in the axes that the camera had then, not turned to now" in said
    assert "y = J V + Ω×s" in said
    Truth(found.certificate.content).holds()


@pytest.mark.slow
def test_the_natural_potential_proves_it_too(natural):
    assert natural.status == "proved", natural.reason
    assert "in the axes that the camera had then" in checker.check(natural.certificate.content)
    OfPotential(natural.certificate.content).holds()


@pytest.mark.slow
def test_turning_the_image_costs_less(proofs):
    turned = CASES["inertial"] | {"sensors.gyro_turned": "true"}
    with soon_found():
        sooner = proof.converge(load(MISSION, turned)).settling.time
    assert sooner < proofs("inertial").settling.time


def test_a_certificate_is_about_its_own_class(proofs):
    """The key that tells them apart is part of what is hashed, and of what is compared."""
    held = proofs("inertial").certificate.content
    assert held["mission"]["uncertainty"]["gyro_turned"] == "false"
    other = copy.deepcopy(held)
    del other["mission"]["uncertainty"]["gyro_turned"]
    with pytest.raises(checker.Rejected):
        checker.check(changed(other, ("claim", "rate"), held["claim"]["rate"]))
    turned = load(MISSION, CASES["inertial"] | {"sensors.gyro_turned": "true"})
    assert "gyro_turned" not in turned.exact()["uncertainty"]


@pytest.mark.slow
def test_wind_on_a_vehicle_that_yaws_leaves_it_near_the_goal():
    """It leans, and what it sees of that turns: a bound in metres, and nothing by the potential."""
    with soon_found():
        windy = CASES["inertial"] | {"uncertainty.wind": "0.05", "uncertainty.yaw_rate": "0.2"}
        found = proof.converge(load(MISSION, windy))
    assert found.status == "proved", found.reason
    assert 0 < found.ultimate_radius < found.settling.radius
    keys = {
        "uncertainty.wind": "0.1",
        "uncertainty.yaw_rate": "0.1",
        "sensors.gyro_turned": "false",
    }
    keys |= test_potential.LATE | test_potential.INERTIAL
    refused = attraction(test_potential.crazyflie(**keys))
    assert refused.status == "undecided"
    assert "sensors.gyro_turned = true is" in refused.reason


# --- flights ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("anywhere", [False, True], ids=["start", "anywhere"])
def test_every_vehicle_within_tolerance_falls_as_is_claimed(name, anywhere, proofs, whole):
    case = Case(proofs(name).certificate.content)
    start = None if anywhere else case.start
    count = (200 if start is not None else 600) * (10 if whole else 1)
    holds(case, fly(case, np.random.default_rng(32), count, 1.0, case.settling()[0], start=start))


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("near", [1, 0.03])
def test_evolution_finds_no_state_and_delay_that_break_the_inequality(name, near, proofs, whole):
    case = Case(proofs(name).certificate.content)
    assert strongest(case, 33, 600 if whole else 60, near=near)[0] < 0


@pytest.mark.slow
def test_evolution_tells_old_axes_where_they_are_not_proved():
    """Three times the yaw rate is within what weights allow if the image is turned, else not."""
    with soon_found():
        turned = CASES["inertial"] | {"sensors.gyro_turned": "true"}
        made = copy.deepcopy(proof.converge(load(MISSION, turned)).certificate.content)
    made["mission"]["uncertainty"]["yaw_rate"] = "3"
    assert strongest(Case(made), 34, 60, near=0.03)[0] < 0
    made["mission"]["uncertainty"]["gyro_turned"] = "false"
    assert strongest(Case(made), 34, 60, near=0.03)[0] > 0


# --- forgeries ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_what_claims_more_is_rejected(name, proofs):
    held = proofs(name).certificate.content
    count = len(held["multipliers"]["terms"])
    forged = [
        *[
            (("multipliers", "terms", k), larger(x))
            for k in range(count)
            for x in (F(1, 10**6), 10**6)
        ],
        (("multipliers", "terms"), lambda terms: terms[:-1]),
        (("memory",), larger(1000)),
        (("memory",), larger(F(1, 1000))),
        (("claim", "rate"), larger(4)),
        (("claim", "start_level"), larger(F(1, 2))),
        (("claim", "starts", 0, "rate"), "10"),
        (("mission", "uncertainty", "yaw_rate"), larger(8)),
        (("mission", "uncertainty", "latency"), larger(4)),
        (("mission", "uncertainty", "gyro_turned"), "true"),
        (("domain", "tree"), pruned),
    ]
    for path, new in forged:
        with pytest.raises(checker.Rejected):
            checker.check(changed(held, path, new))
            pytest.fail(str(path))


def test_a_turning_start_counts_in_the_memory(proofs):
    """Its past turns the image: Ψ at the start is higher by what a turn leaves."""
    held = proofs("inertial").certificate.content
    claim = checker.claim_of(held)
    start = copy.copy(claim.c.claim.starts[0])
    before = claim.at_start(start, F(1), F(1))
    claim.late_axes, turned = False, []
    for start.rate in (F(0), F(1)):
        turned.append(claim.at_start(start, F(1), F(1)))
    claim.late_axes = True
    assert before > turned[0]  # any yaw turns what is seen sideways
    whole = claim.at_start(start, F(1), F(1)) - turned[1]
    past = float(claim.reach + claim.may.yaw_rate)
    assert float(whole) == pytest.approx(
        float(claim.c.memory) / 2 * float(claim.may.latency) ** 2 * past**2, rel=1e-9
    )
