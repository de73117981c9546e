"""A verdict is about motions that come to the goal: bounds that Q leaves there give none."""

import json
from fractions import Fraction

import numpy as np
import pytest

from command_line import run
from hoverproof import checker
from hoverproof.certification import bounds, problem
from hoverproof.certification.attraction.proof import attraction
from hoverproof.certification.bounds import eigenvalues_at_goal
from hoverproof.certification.gains import certify
from hoverproof.certification.over_box import certify_region
from hoverproof.certification.problem import gain_problem, pose
from hoverproof.certification.region import default_box
from hoverproof.certification.verdict import Proved, Undecided
from hoverproof.design.atlas import atlas, axis
from hoverproof.design.tuning import tune
from hoverproof.errors import InputError
from hoverproof.mission.presets import presets
from hoverproof.mission.reading import load
from hoverproof.servo.linearised import slowest_rate
from papers_law import CRAZYFLIE
from test_brute_force import random_mission
from test_tuning import tuned_once

WITHOUT_GOAL = {"bounds.eigenvalues": "[0.01, 0.1]"}
AUTO = {"bounds.eigenvalues": "auto"}
BY_CENTROID = {"goal": "{centroid = [0.2, -0.1, 3.2]}"}


# --- bounds that leave out Q at the goal --------------------------------------------------------


@pytest.mark.parametrize("command", ["certify", "tune", "export", "atlas"])
def test_bounds_that_leave_out_q_at_the_goal_give_no_verdict(
    command, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    written = ("--out", tmp_path / "firmware") if command == "export" else ()
    written = ("--objective", "decay") if command == "tune" else written
    ends = ("--set", "bounds.eigenvalues=[0.01,0.1]")
    status, out, err = run(capsys, command, "x4-flyer", *ends, *written)
    assert status == 2
    assert not out
    assert "bounds.eigenvalues" in err
    assert "0.2193" in err
    assert "1.096" in err
    assert "[0.01, 0.1]" in err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("ends", ["[0.01, 1.09]", "[0.22, 5]", "[2, 5]", "[0.01, 0.02]"])
@pytest.mark.parametrize("goal", [{}, {"goal": "{centroid = [0, 0, 3.618136]}"}])
def test_either_bound_may_leave_it_out(ends, goal):
    with pytest.raises(InputError, match="Q at the goal has eigenvalues from 0"):
        gain_problem(load("x4-flyer", goal | {"bounds.eigenvalues": ends}))


def test_a_box_far_from_the_goal_is_refused_if_its_bounds_leave_the_goal_out(tmp_path, capsys):
    file = tmp_path / "far.json"
    far = ("certify", "x4-flyer", "--box=9,10,9,10,-20,-19", "--out", file)
    status, _, err = run(capsys, *far)
    assert status == 2
    assert "take a box that holds the goal" in err
    assert not file.exists()


def test_cells_of_an_atlas_whose_bounds_leave_it_out_are_no_verdict():
    mission = load("x4-flyer")
    x = axis(mission, "highest_eigenvalue", ends=(0.5, 2.0), cells=6)
    drawn = atlas(mission, x, axis(mission, "k3", cells=2), processes=1)
    unasked = np.isnan(drawn["margin"].values)
    assert (unasked == (x.values < eigenvalues_at_goal(mission)[1])[None]).all()


@pytest.mark.parametrize("goal", [{}, BY_CENTROID])
def test_the_checker_rejects_a_proof_whose_bounds_leave_it_out(goal, monkeypatch):
    mission = load("x4-flyer", goal | WITHOUT_GOAL)
    position = pose(mission).goal.position
    spot = tuple((x - Fraction(1, 10**6), x + Fraction(1, 10**6)) for x in position)
    monkeypatch.setattr(problem, "goal_box", lambda *_: spot)
    verdict = certify(mission)
    assert isinstance(verdict, Undecided)
    assert "Q at the goal" in verdict.reason


def sealed(content):
    """Make the hash of a changed certificate anew."""
    rest = {k: v for k, v in content.items() if k != "sha256"}
    return rest | {"sha256": checker.digest(rest)}


@pytest.mark.parametrize("goal", [{}, BY_CENTROID])
@pytest.mark.parametrize("moved", [Fraction(1, 10**6), Fraction(-1, 100), Fraction(1)])
def test_the_checker_rejects_a_box_that_does_not_hold_the_goal(goal, moved):
    content = certify(load("x4-flyer", goal)).certificate.content
    ends = content["enclosures"]["goal"]
    for axis_ in range(3):
        other = [list(side) for side in ends]
        other[axis_] = [str(Fraction(end) + moved) for end in ends[axis_]]
        forged = content | {"enclosures": content["enclosures"] | {"goal": other}}
        with pytest.raises(checker.Rejected, match="Q at the goal"):
            checker.check(sealed(forged))


# --- what is proved is no faster than the loop itself -------------------------------------------


def agrees_with_the_loop(mission, verdict):
    """Hold a certified rate of L against the slowest motion at the goal: L falls as its square."""
    slowest = slowest_rate(mission)
    assert slowest > 0
    assert float(verdict.decay_rate) <= 2 * slowest * (1 + 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", presets())
@pytest.mark.parametrize("change", [{}, AUTO])
def test_the_certified_rate_of_a_preset_is_one_that_its_loop_has(name, change):
    mission = load(name, change)
    verdict = certify(mission)
    assert isinstance(verdict, Proved)
    agrees_with_the_loop(mission, verdict)


@pytest.mark.slow
def test_the_certified_rate_of_a_random_mission_is_one_that_its_loop_has(whole):
    """Of 60 missions, and with `make trials` of 200."""
    rng, proved = np.random.default_rng(20261126), 0
    for _ in range(200 if whole else 60):
        while (drawn := random_mission(rng)) is None:
            pass
        mission, verdict = drawn
        if isinstance(verdict, Proved):
            proved += 1
            agrees_with_the_loop(mission, verdict)
    assert proved > (40 if whole else 10)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("objective", "change"),
    [
        *[("decay", {}), ("decay", AUTO)],
        pytest.param("settling", AUTO, marks=pytest.mark.whole),
        pytest.param("settling", {}, marks=pytest.mark.whole),
        pytest.param("region", AUTO, marks=pytest.mark.whole),
    ],
)
def test_tuned_gains_settle(objective, change):
    """Those for a region with assumed bounds are looked at in `tests/test_region_gains.py`."""
    mission = load("x4-flyer", change)
    tuned = tuned_once(change) if objective == "decay" else tune(mission, objective=objective)
    assert tuned.status == "tuned"
    assert tuned.slowest_rate > 0
    assert slowest_rate(tuned.mission) == pytest.approx(tuned.slowest_rate)


# --- bounds that are proved ---------------------------------------------------------------------


def test_auto_proves_the_bounds_over_a_box_around_start_and_goal():
    mission = load("x4-flyer", AUTO)
    verdict = certify(mission)
    assert isinstance(verdict, Proved)
    assert verdict.problem.box == default_box(mission)
    places = [mission.start.position, verdict.problem.goal.position]
    for place in places:
        sides = zip(place, verdict.problem.box, strict=True)
        assert all(low <= x <= high for x, (low, high) in sides)
    assert "every position in the box" in checker.check(verdict.certificate.content)


@pytest.mark.slow
def test_auto_takes_a_box_of_the_mission():
    box = "[[-1, 6], [-1, 3], [-5, -2]]"
    mission = load("x4-flyer", AUTO | {"bounds.box": box})
    verdict = certify(mission)
    assert [[float(end) for end in side] for side in verdict.problem.box] == json.loads(box)
    assert checker.check(verdict.certificate.content)
    assert certify_region(mission, default_box(mission)).status == "proved"


def test_a_box_of_the_mission_holds_its_start_and_its_goal():
    goal_only = AUTO | {"bounds.box": "[[-1, 1], [-1, 1], [-4, -2]]"}
    with pytest.raises(InputError, match=r"bounds\.box: must hold the start"):
        certify(load("x4-flyer", goal_only))
    start_only = AUTO | {"bounds.box": "[[4, 6], [2, 3], [-5, -4]]"}
    with pytest.raises(InputError, match=r"bounds\.box: Q at the goal has eigenvalues"):
        certify(load("x4-flyer", start_only))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"bounds.eigenvalues": "automatic"}, 'must be "auto" or a list [lowest, highest]'),
        (AUTO | {"bounds.box": "[[-1, 6], [-1, 3], [-5, 1]]"}, "holds a target point"),
        (AUTO | {"bounds.box": "[[-1, -2], [-1, 1], [-2, -1]]"}, "from its lowest to its highest"),
        ({"bounds.box": "[[-1, 1], [-1, 1], [-4, -2]]"}, 'is for eigenvalues = "auto"'),
        (AUTO | {"bounds.box": "[[-1, 1], [-1, 1]]"}, "must be a list [x, y, z]"),
    ],
)
def test_what_auto_cannot_use_is_refused(change, told):
    with pytest.raises(InputError) as refused:
        gain_problem(load("x4-flyer", change))
    assert told in str(refused.value)
    assert "bounds." in str(refused.value)


def test_an_atlas_cannot_vary_bounds_that_are_proved():
    with pytest.raises(InputError, match="cannot vary"):
        axis(load("x4-flyer", AUTO), "lowest_eigenvalue")


def test_a_certificate_without_a_box_must_have_numbers_for_its_bounds():
    content = certify(load("x4-flyer", AUTO)).certificate.content
    assumed = content | {"region": content["region"] | {"box": None}}
    with pytest.raises(checker.Rejected, match="without a box"):
        checker.check(sealed(assumed))


# --- assumed and proved are told apart ----------------------------------------------------------


@pytest.mark.parametrize(("change", "footing"), [({}, "assumed"), (AUTO, "proved")])
def test_every_verdict_tells_assumed_bounds_from_proved_ones(
    change, footing, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    settings = [f"--set={key}={value}" for key, value in change.items()]
    _, out, _ = run(capsys, "certify", "x4-flyer", *settings)
    assert f"bounds of the eigenvalues {footing}" in out
    _, out, _ = run(capsys, "certify", "x4-flyer", *settings, "--json")
    answer = json.loads(out)
    assert answer["eigenvalue_bounds"] == footing
    assert ("which is assumed of Q" in answer["statement"]) == (footing == "assumed")
    _, out, _ = run(capsys, "export", "x4-flyer", *settings, "--out", tmp_path / "firmware")
    assert f"certified (theorem 1; bounds of Q {footing}" in out


def test_goals_known_to_rounding_are_enclosed():
    mission = load("x4-flyer", BY_CENTROID)
    question = gain_problem(mission)
    assert question.goal_box is not None
    held = [list(side) for side in question.goal_box]
    asked = checker.claim_of(certify(mission).certificate.content)
    asked.verify_goal(held)
    aside = ((Fraction(1, 4),) * 2, *question.centroid[1:])
    asked.centroid = list(aside)
    with pytest.raises(checker.Rejected, match="not shown to hold the goal"):
        asked.verify_goal(held)


@pytest.mark.slow
def test_bounds_are_proved_once_for_all_gains(monkeypatch):
    calls = []
    monkeypatch.setattr(bounds, "_held", {})
    monkeypatch.setattr(
        bounds, "enclose", lambda *a, old=bounds.enclose: calls.append(a) or old(*a)
    )
    mission = load(CRAZYFLIE, AUTO)
    for k3 in ("0.055", "0.06", "0.07"):
        gain_problem(load(CRAZYFLIE, AUTO | {"gains.k3": k3}))
    attraction(mission, objective="radius", barrier=False)
    assert len(calls) == 1
