"""Regions of attraction: the lemmas, the proofs, and what flights say about them."""

from __future__ import annotations

import copy
import json
import re
import runpy
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from checker_kit import matrix
from command_line import run
from hoverproof import checker
from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.identity import prove_equal
from hoverproof.certification.attraction import refutation
from hoverproof.certification.attraction.form import derive_form
from hoverproof.certification.attraction.lemmas import LEMMAS
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.proof import attraction, estimate
from hoverproof.certification.attraction.search import HoverGrid
from hoverproof.certification.attraction.starts import Start, State
from hoverproof.certification.attraction.trees import Set
from hoverproof.certification.exponential.lemmas import LEMMAS as TOLERANCES
from hoverproof.certification.pattern import Pattern
from hoverproof.certification.verdict import Proved, Undecided
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.servo.linearised import slowest_rate
from hoverproof.servo.variables import Design
from papers_law import PAPERS
from random_missions import case
from sharing import kept_value

F = Fraction
ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))
TUNED = {"gains.k1": "1.01", "gains.k4": "10"}


@pytest.fixture(scope="module")
def paper():
    return kept_value("attraction", lambda: attraction(load("x4-flyer")))


@pytest.fixture(scope="module")
def without_barrier():
    asked = {"objective": "volume", "barrier": False}
    return kept_value(("attraction", asked), lambda: attraction(load("x4-flyer"), **asked))


# --- the lemmas ---------------------------------------------------------------------------------


@pytest.mark.whole  # the next test proves them all
@pytest.mark.parametrize("lemma", (*LEMMAS, *TOLERANCES), ids=lambda lemma: lemma.id)
def test_every_identity_of_a_lemma_is_proved(lemma):
    identities = lemma.identities()
    assert identities
    assert all(identities.values()), identities


@pytest.mark.slow
def test_the_ledgers_in_proofs_are_those_of_today():
    make = runpy.run_path(str(ROOT / "proofs/make.py"))
    for name, ledger in make["LEDGERS"].items():
        made = make["lemmas"](*ledger)
        assert (ROOT / "proofs" / name).read_text(encoding="utf-8") == made


def test_the_proofs_name_every_lemma_and_no_other():
    text = (ROOT / "proofs/README.md").read_text(encoding="utf-8")
    lemmas = [lemma.id for lemma in (*LEMMAS, *TOLERANCES)]
    assert sorted(set(re.findall(r"\[(\w+)\]", text))) == sorted(lemmas)


def test_the_prover_tells_a_wrong_quadratic_form():
    form = derive_form()
    wrong = form.dissipation + form.weights[0] * form.errors[3] * form.errors[6] / 1000
    assert not prove_equal(wrong, form.dissipation)


def test_the_checker_has_the_matrix_of_the_derived_form(x4, paper):
    """The checker's lower bound at a multiplier is the derived form less Petersen's term."""
    weights = [F(3, 2), F(5, 4), F(7, 3)]
    p = checker.claim_of(paper.certificate.content)
    p.a = weights
    high, f, q3, t, tau = F(7, 2), F(1, 50), F(18, 5), F(1, 30), F(4, 3)
    design = Design.values(x4, [F(0), F(0), q3])
    S, u, v = evaluate(derive_form().function(), [design, weights, [f], [t, F(0)]])
    expected = [
        [
            S[i][j]
            + high / 4 * sum(u[k][i] * v[k][j] + u[k][j] * v[k][i] for k in range(3))
            - high / 4 * sum(tau * v[k][i] * v[k][j] + u[k][i] * u[k][j] / tau for k in range(3))
            for j in range(11)
        ]
        for i in range(11)
    ]
    assert matrix(p.dissipation(high, f, q3, t, tau)) == expected


@pytest.mark.parametrize("seed", range(5))
def test_petersens_bound_is_below_the_form_at_any_depths(x4, seed):
    rng = np.random.default_rng(seed)
    form = derive_form()
    design = [float(x) for x in Design.values(x4, [F(0), F(0), F(18, 5)])]
    S, u, v = (np.array(x) for x in form.function()(design, [1.5, 1.2, 2], 0.02, [0.01, 0.02]))
    high = 3.0
    for _ in range(200):
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        Q = turn @ np.diag(high * rng.uniform(size=3)) @ turn.T
        y, tau = rng.normal(size=11), rng.uniform(0.1, 10)
        a, b = u @ y, v @ y
        bound = y @ S @ y + high / 2 * (a @ b - (tau * b @ b + a @ a / tau) / 2)
        assert bound <= y @ S @ y + a @ Q @ b + 1e-9


# --- what is proved -----------------------------------------------------------------------------


def test_the_papers_start_is_proved(paper):
    assert isinstance(paper, Proved)
    assert paper.starts == (Start.hover(F(5), F(5, 2), F(-4)),)
    assert paper.barrier_height > 0
    assert checker.check(paper.certificate.content) == paper.certificate.statement
    p = Potential.of(paper.mission)
    place = np.array([[5, 2.5, -4]])
    energy = p.hover_terms(place) @ [1, *map(float, paper.weights)]
    assert energy[0] <= float(paper.level)


def test_the_statement_says_what_it_is_about(paper):
    words = paper.certificate.statement
    for part in (
        "level hover",
        "straight below",
        "any heading and yaw rate",
        "continuous time",
        "exact model",
        "all target points seen",
        "converges",
        "level hover at rest with position in (5, 5/2, -4) m",
    ):
        assert part in words


@pytest.mark.slow
def test_hover_far_away_is_proved():
    region = attraction(load("x4-flyer"), starts=[Start.hover(F(20), F(0), F(-20))])
    assert isinstance(region, Proved)


@pytest.mark.slow
def test_the_region_without_a_barrier_is_as_large_as_asked(without_barrier):
    assert isinstance(without_barrier, Proved)
    assert without_barrier.barrier_height is None
    reach = without_barrier.reach
    assert reach.sideways >= 2
    assert reach.up >= 10
    assert reach.down >= F(5, 2)


@pytest.mark.slow
def test_tuned_gains_are_five_times_as_fast_with_a_region_as_large_as_asked():
    tuned = load("x4-flyer", TUNED)
    assert slowest_rate(tuned) >= 5 * slowest_rate(load("x4-flyer"))
    region = attraction(tuned, objective="volume", barrier=False)
    assert isinstance(region, Proved)
    assert region.reach.sideways >= 2
    assert region.reach.up >= 3
    assert region.reach.down >= 2


@pytest.mark.slow
@pytest.mark.parametrize("barrier", [True, False])
def test_a_set_of_moving_starts_is_proved_and_its_states_are_inside(barrier):
    import attraction_flights as flights

    mission = load("x4-flyer")
    position = ((F(-1, 2), F(1, 2)), (F(-1, 2), F(1, 2)), (F(-4), F(-3)))
    start = Start(position, F(1, 100), F(1, 1000), F(1, 1000), F(1, 20))
    region = attraction(mission, starts=[start], barrier=barrier)
    assert isinstance(region, Proved)
    case, rng = flights.Case(region), np.random.default_rng(0)
    states = np.array([state_in(start, case, rng) for _ in range(500)])
    assert (case_energy(case, states) <= float(region.level)).all()


def state_in(start, case, rng):
    """Return a state at the edge of a set of starts."""
    import attraction_flights as flights

    low, high = np.array(start.position, float).T
    lean, heading = float(start.tilt), rng.uniform(0, 2 * np.pi, 3)
    rho = [np.sin(lean) * np.cos(heading[0]), np.sin(lean) * np.sin(heading[0]), np.cos(lean)]
    R = flights.rotation_with(np.array(rho), heading[1])
    V = rng.normal(size=3)
    V *= float(start.speed) / np.linalg.norm(V)
    omega = float(start.rate) * np.array([np.cos(heading[2]), np.sin(heading[2]), 1])
    T = case.weight + rng.choice([-1, 1]) * float(start.thrust)
    return np.concatenate([rng.uniform(low, high), V, R.T.ravel(), omega, [T]])


def case_energy(case, states):
    from hoverproof.certification.attraction.motion import energies

    return energies(case.region, states)


@pytest.mark.slow
def test_a_start_at_the_target_plane_is_not_proved():
    verdict = attraction(load("x4-flyer", {"start.position": "[0.9, 0.9, -0.05]"}))
    assert isinstance(verdict, Undecided)
    assert "with a barrier" in verdict.reason
    assert "without a barrier" in verdict.reason


def test_a_barrier_needs_k3_large_enough():
    slow = load("x4-flyer", {"gains.k3": "5"})
    verdict = attraction(slow, barrier=True)
    assert isinstance(verdict, Undecided)
    assert "k3 >= 3 k1 k2" in verdict.reason


def test_a_goal_that_is_not_straight_below_is_refused():
    tilted = load("x4-flyer", {"goal": "{centroid = [0.3, 0.2, 3.5]}"})
    with pytest.raises(InputError, match="straight below"):
        attraction(tilted)


@pytest.mark.slow
def test_a_goal_by_centroid_over_an_uneven_target_is_proved():
    """ξ* is irrational here; its potential is enclosed."""
    points = "{points = [[1, 1, 0], [1, -1, 0.2], [-1.2, -1, 0], [-1, 1.1, -0.1]]}"
    mission = load("x4-flyer", {"target": points, "goal": "{centroid = [0, 0, 3.6]}"})
    region = attraction(mission, objective="radius", barrier=False)
    assert isinstance(region, Proved)
    assert region.reach.sideways > 1


@pytest.mark.slow
def test_an_estimate_for_tuning_is_near_what_is_proved(x4):
    found = estimate(x4)
    grid = HoverGrid.of(Potential.of(x4))
    radius = grid.radius(found.weights, found.level, found.bottom)
    assert 2 < radius < 3


# --- what flights say ---------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("count", [40, pytest.param(100, marks=pytest.mark.slow)])
def test_flights_from_inside_keep_inside_and_reach_the_goal(paper, count, whole):
    """The paper's vehicle alone, 100 times; `make trials` flies 1,500 times."""
    import attraction_flights as flights

    count *= 15 if whole else 1
    flown, excess = flights.trial(paper, count, 20 * count)
    assert flown == {
        "flights": count,
        "reach the goal": count,
        "Λ rises": 0,
        "leave the level": 0,
        "pass the barrier": 0,
        "lose the target": 0,
    }
    assert (excess <= 0).all()


def test_the_trial_tells_a_rate_that_is_too_high(paper):
    import attraction_flights as flights

    boast = copy.copy(paper)
    object.__setattr__(boast, "rate", paper.rate * 10_000)
    _, excess = flights.trial(boast, 1, 500)
    assert (excess > 0).any()


# --- the certificate and the command ------------------------------------------------------------


def test_the_checker_alone_accepts_the_file(paper):
    paper.certificate.save("a.json")
    done = subprocess.run(
        [sys.executable, "-I", "-S", checker.__file__, "a.json"], capture_output=True, check=False
    )
    assert done.returncode == 0, done.stdout


def claimed(content, **changes):
    """Return a certificate with other claims, hashes and statement made anew."""
    forged = copy.deepcopy(content)
    for path, value in changes.items():
        *above, last = path.split("__")
        spot = forged
        for key in above:
            spot = spot[key]
        spot[last] = value
    forged["statement"] = checker.statement(forged)
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    return forged


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"claim__level": "100000"}, "singularity|tan|interval of f"),
        ({"claim__rate": "2"}, "not shown to be above"),
        ({"claim__barrier_height": "1/100"}, "largest eigenvalue"),
        ({"claim__barrier_height": "5"}, "below the barrier|sinks"),
        ({"claim__barrier_height": None, "trees__barrier": None}, "largest eigenvalue"),
        ({"claim__barrier_height": None}, "a tree belongs to a barrier"),
        ({"trees__starts": ["0"]}, "a tree a start"),
        ({"trees__positions": "0"}, "largest eigenvalue"),
        ({"trees__barrier": "0"}, "barrier is not shown"),
        ({"enclosures__largest_eigenvalue": "1"}, "largest eigenvalue|barrier"),
        ({"enclosures__tilt": "1/1000"}, "tan"),
        ({"enclosures__factor": ["1/1000", "1/999"]}, "interval of f"),
        ({"claim__reach": {"sideways": "100000", "up": "1", "down": "1"}}, "start is not shown"),
        (
            {"claim__reach": {"sideways": "1", "up": "1", "down": "29/10"}},
            "below the barrier|sinks",
        ),
        ({"weights": ["100", "100", "100"]}, "tan|not shown|interval of f"),
        ({"multipliers": ["1000000", "1000000"]}, "not shown to be above"),
        ({"hover": ["0", "0", "-4"]}, "hover point"),
    ],
)
def test_a_claim_beyond_what_is_proved_is_rejected(paper, change, reason):
    with pytest.raises(checker.Rejected, match=reason):
        checker.check(claimed(paper.certificate.content, **change))


def test_a_barrier_without_real_poles_is_rejected(paper):
    forged = copy.deepcopy(paper.certificate.content)
    forged["mission"]["gains"]["k3"] = "5"
    forged["mission_sha256"] = checker.digest(forged["mission"])
    with pytest.raises(checker.Rejected, match=r"k3 >= 3 k1 k2|interval of f|not shown"):
        checker.check(claimed(forged))


def over_five_points(content, q3, hover):
    """Forge a small region for a square with a point in its middle, seen as q3* from a hover."""
    forged = copy.deepcopy(content)
    forged["mission"]["target"]["points"].append(["0", "0", "0"])
    targets = [[F(c) for c in point] for point in forged["mission"]["target"]["points"]]
    forged["mission"]["goal"] = {"centroid": ["0", "0", q3]}
    forged |= {"goal_position": None, "hover": hover, "weights": ["2/25", "3/200", "2/125"]}
    still = {"sideways": "0", "up": "0", "down": "0"}
    forged["claim"] |= {"level": "1/100", "rate": "1/1000", "barrier_height": None, "reach": still}
    forged["claim"]["starts"], forged["multipliers"] = [], ["27/250", "27/250"]
    points, place = (np.array(x, float) for x in (targets, [F(c) for c in hover]))
    potential = Potential(Pattern.plain(points), place, float(F(q3)))
    region = Set(potential, None, None, 0.01, 7.0, 0.0, None)
    halved = region.positions() or "0"  # it has none where no hover sees the goal
    forged["trees"] = {"positions": halved, "barrier": None, "starts": ["0", "0"]}
    forged["mission_sha256"] = checker.digest(forged["mission"])
    p = checker.claim_of(forged)
    thrusts = (p.weight + p.force, p.weight - p.force)
    low, high = (p.factor(thrust, p.q3[0]) for thrust in thrusts)
    factors = [str(decimal_below(low, 9)), str(decimal_above(high, 9))]
    forged["enclosures"] |= {"goal": [q3, q3], "factor": factors}
    forged["enclosures"]["largest_eigenvalue"] = "7"
    return claimed(forged)


@pytest.mark.slow
def test_no_region_is_proved_where_no_hover_sees_the_goal(paper):
    """Over a point in the middle, at height 0, qz is 1 at least: then W is least in that point."""
    content = paper.certificate.content
    seen = over_five_points(content, "21/5", ["0", "0", "-1885618083/1000000000"])
    assert "converges" in checker.check(seen)
    for hover in ("-1/1000000", "1/100"):
        unseen = over_five_points(content, "1/2", ["0", "0", hover])
        with pytest.raises(checker.Rejected, match="largest eigenvalue"):
            checker.check(unseen)


@pytest.mark.slow
def test_the_command_writes_a_certificate_and_tells_in_json(capsys):
    status, out, _ = run(capsys, "attraction", "x4-flyer", "--no-figure", "--json")
    assert status == 0
    answer = json.loads(out)
    assert answer["verdict"] == "proved"
    assert {"level", "weights", "tilt", "barrier_height", "reach", "certificate"} <= set(answer)
    assert set(answer["reach"]) == {"sideways", "up", "down"}
    assert len(answer["not_covered"]) >= 4
    assert checker.check_file(answer["certificate"]) == answer["statement"]


@pytest.mark.parametrize(
    "options",
    [
        ["--start", "1,2"],
        ["--start", "a,b,c"],
        ["--start", "0,0,1e99"],
        ["--speed", "-1"],
        ["--start=1,1,0"],
    ],
)
def test_a_start_that_cannot_be_used_is_refused_in_one_line(options, capsys):
    status, _, err = run(capsys, "attraction", "x4-flyer", *options)
    assert status == 2
    assert err.count("\n") == 1


def test_undecided_has_its_own_exit_status(capsys):
    status, out, _ = run(
        capsys, "attraction", "x4-flyer", "--barrier", "--set", "gains.k3=5", "--json"
    )
    assert status == 3
    answer = json.loads(out)
    assert answer["verdict"] == "undecided"
    assert answer["level"] is None
    assert "k3" in answer["reason"]


@pytest.mark.slow
def test_flights_of_a_picture_are_those_of_three_times_the_steps_flown_to_the_end(x4, monkeypatch):
    from hoverproof.show import attraction as picture

    region = attraction(x4)
    view = picture.View.of(region)
    drawn = picture.fly(region, view, 20)
    axes = Figure().subplots()
    picture.draw_energy(axes, region, drawn)
    lowest, ends = axes.get_ylim()[0], axes.get_xlim()[1]
    still = drawn.time[(drawn.energy > lowest).any(axis=0)].max()
    assert still < ends < still + 2 * drawn.time[1]  # the time axis ends with what is drawn
    monkeypatch.setattr(picture, "STEPS_PER_FASTEST", 3 * picture.STEPS_PER_FASTEST)
    monkeypatch.setattr(picture, "AT_REST", 0.0)
    fine = picture.fly(region, view, 20)
    assert (drawn.settled == fine.settled).all()
    assert np.isnan(drawn.energy).any()
    for one, other in zip(drawn.energy, fine.energy, strict=True):
        seen = one > 1e-6 * float(region.level)
        there = np.interp(drawn.time[seen], fine.time, np.log10(other))
        assert np.abs(np.log10(one[seen]) - there).max() < 0.02


def test_the_trade_off_is_drawn_at_the_speed_and_the_reach_of_each_region():
    from types import SimpleNamespace

    from hoverproof.show.trade_off import trade_off_figure

    missions = [load("x4-flyer", {"gains.k1": k1}) for k1 in ("0.3", "0.2")]
    reaches = [
        SimpleNamespace(sideways=F(2), down=F(1), up=F(9)),
        SimpleNamespace(sideways=F(3), down=F(5), up=F(7)),
    ]
    pairs = zip(missions, reaches, strict=True)
    regions = [SimpleNamespace(mission=m, reach=reach) for m, reach in pairs]
    (axes,) = trade_off_figure(regions, own=regions[0]).axes
    speeds = [slowest_rate(m) for m in reversed(missions)]
    lines = {line.get_label(): line for line in axes.get_lines()}
    for way, drawn in {"sideways": [3, 2], "down": [5, 1], "up": [7, 9]}.items():
        assert list(lines[way].get_xdata()) == speeds
        assert list(lines[way].get_ydata()) == drawn
    drawn_stars = (line for line in axes.get_lines() if line.get_marker() == "*")
    stars = [line for line in drawn_stars if len(line.get_xdata())]
    assert {float(star.get_xdata()[0]) for star in stars} == {speeds[1]}
    assert sorted(float(star.get_ydata()[0]) for star in stars) == [1, 2, 9]


def test_a_motion_that_takes_too_many_steps_to_follow_is_given_up(tmp_path, monkeypatch):
    (tmp_path / "m.toml").write_bytes(case(997).text)  # it shakes just above the singularity
    mission = load(str(tmp_path / "m.toml"))
    monkeypatch.setattr(refutation, "EVALUATIONS", 2000)
    ending, time = refutation.simulate(mission, State.of(mission).packed(), refutation.LATE)
    assert ending == "goes on"
    assert 0 < time < 10


def test_the_states_of_a_set_are_not_all_followed_where_one_is_given_up(tmp_path, monkeypatch):
    (tmp_path / "m.toml").write_bytes(case(997).text)
    mission = load(str(tmp_path / "m.toml"))
    followed = []
    simulate = refutation.simulate
    monkeypatch.setattr(refutation, "EVALUATIONS", 2000)
    monkeypatch.setattr(refutation, "simulate", lambda *a: followed.append(a[2]) or simulate(*a))
    start = Start.hover(*(F(c) for c in mission.start.position))
    box = replace(start, position=((F(1), F(2)), *start.position[1:]), tilt=F(1, 10))
    assert len(list(refutation.worst_states(mission, box))) > 10
    verdict = refutation.refute(mission, [box], Undecided(mission=mission, reason=""))
    assert verdict.status == "undecided"
    assert followed == [refutation.SOON, refutation.LATE]


@pytest.mark.slow
def test_a_flight_that_a_person_would_fly_is_followed_to_its_end(monkeypatch):
    for preset in PAPERS.values():
        mission = load(preset)
        monkeypatch.setattr(refutation, "EVALUATIONS", refutation.EVALUATIONS // 2)
        ending, _ = refutation.simulate(mission, State.of(mission).packed(), refutation.LATE)
        monkeypatch.undo()
        assert ending == "settles", preset
