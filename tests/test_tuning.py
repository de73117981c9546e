"""Gains by design: as fast as the literature promises, within limits, and proved as printed."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path

import casadi as ca
import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given as drawn
from hypothesis import settings
from hypothesis import strategies as st
from scipy.stats import qmc

import checker_kit
from command_line import run
from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.certification.problem import ONES, gain_problem
from hoverproof.certification.verdict import Proved
from hoverproof.design import tuning
from hoverproof.design.gain_search import GainSearch, halton
from hoverproof.design.limits import FirstCommand, Limits, highest_k4, uses
from hoverproof.design.margins import Questions, margins
from hoverproof.design.outcome import Infeasible, Tuned
from hoverproof.design.tuning import pareto
from hoverproof.design.tuning import tune as any_gains
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.servo.linearised import slowest_rate, slowest_rates
from hoverproof.servo.loop import LoopNumbers, loop_rate, parameters
from hoverproof.simulation.flight import simulate
from sharing import kept_value

PROVED = {"bounds.eigenvalues": "auto"}
OFF_AXIS = {"goal": "{centroid = [0.3, 0.2, 3.5]}"}
BY_LEVEL = {"bounds": "{eigenvalues = [0.01, 5], level = 10}"}


TUNE = "tune", "x4-flyer", "--objective", "decay"
tune = partial(any_gains, objective="decay")


@pytest.fixture(scope="module")
def fast():
    return tuned_once({})


@pytest.fixture(scope="module")
def fast_over_box():
    return tuned_once(PROVED)


def tuned_once(change):
    """Return the gains for the fastest decay of the paper's vehicle after a change of it."""
    return kept_value(("tuned", change), lambda: tune(load("x4-flyer", change)))


def random_gains(rng, count):
    spans = ((-2, 1), (-1, 2), (0, 2.3), (-1, 2))
    return tuple(10 ** rng.uniform(low, high, count) for low, high in spans)


# --- margins, many at once ------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("change", [{}, OFF_AXIS, BY_LEVEL])
@pytest.mark.parametrize("weights", [ONES, tuple(map(Fraction, ("1", "0.5", "2", "0.3")))])
def test_margins_agree_with_the_exact_bounds_of_certify(change, weights, whole):
    questions = Questions.of(gain_problem(load("x4-flyer", change), weights))
    gains = random_gains(np.random.default_rng(1), 25 if whole else 8)
    found = margins(replace(questions, gains=gains))
    for i, margin in enumerate(found):
        setting = {f"gains.k{j + 1}": repr(float(gains[j][i])) for j in range(4)}
        try:
            verdict = certify(load("x4-flyer", change | setting), weights=weights)
        except InputError:
            assert np.isnan(margin)
            continue
        assert margin == pytest.approx(float(verdict.margin_above), rel=1e-6)
        assert (margin > 0) == (verdict.status == "proved")


@settings(deadline=None, max_examples=50)
@drawn(
    st.tuples(*(st.floats(0.01, 30) for _ in range(4))),
    st.floats(1, 10),
)
def test_a_higher_k4_never_lowers_the_margin(gains, times):
    questions = Questions.of(gain_problem(load("x4-flyer")))
    k1, k2, k3, k4 = gains
    pair = (*(np.array([k, k]) for k in (k1, k2, k3)), np.array([k4, k4 * times]))
    low, high = margins(replace(questions, gains=pair))
    if not np.isnan(low):
        assert high >= low - 1e-8 * (abs(low) + k3 + k1 * k2)


# --- what is asked of tune ------------------------------------------------------------------------


@pytest.mark.slow
def test_tuned_gains_of_the_paper_s_vehicle_decay_3_7_times_faster(x4, fast):
    paper = certify(x4)
    assert isinstance(fast, Tuned)
    assert fast.before == paper.decay_rate
    assert fast.verdict.decay_rate >= Fraction("3.7") * paper.decay_rate


@pytest.mark.slow
def test_with_proved_eigenvalue_bounds_they_decay_10_times_faster(fast_over_box):
    assert fast_over_box.verdict.decay_rate >= 10 * fast_over_box.before


@pytest.mark.parametrize("which", ["fast", "fast_over_box"])
def test_the_gains_that_are_printed_are_the_proved_ones(which, request):
    tuned = request.getfixturevalue(which)
    again = certify(load("x4-flyer", given(tuned)))
    assert isinstance(again, Proved)
    assert again.decay_rate == tuned.verdict.decay_rate
    assert checker.check(tuned.verdict.certificate.content)
    assert float(again.decay_rate) >= tuned.estimate * (1 - 3e-4)
    g = tuned.mission.gains
    assert g.k1 * g.k2 + g.k3 + g.k4 <= 20 * tuned.mission.vehicle.mass
    for gain in (g.k1, g.k2, g.k3, g.k4):
        assert len(f"{float(gain):g}".replace(".", "").strip("0")) <= 5


def given(tuned):
    """Return overrides for the preset that put in the tuned gains and bounds."""
    gains = {f"gains.{k}": str(float(v)) for k, v in tuned.mission.gains}
    bounds = tuned.mission.bounds.eigenvalues
    text = bounds if bounds == "auto" else str([float(end) for end in bounds])
    return {**gains, "bounds.eigenvalues": text}


@pytest.mark.parametrize("which", ["fast", "fast_over_box"])
def test_for_its_k1_and_k2_an_sdp_solver_finds_nothing_better(which, request):
    """The inequality is linear in (k3, k4, τ, t), here built from the checker's own Σ."""
    mission = request.getfixturevalue(which).mission
    m, g = float(mission.vehicle.mass), {k: float(v) for k, v in mission.gains}
    problem = gain_problem(mission)
    q = [float(c) for c in problem.goal.centroid_midpoint]
    low, high = map(float, problem.eigenvalues)
    Q = ((low + high) / 2 * np.eye(3)).tolist()
    eye = np.eye(12)[:, :11].reshape(4, 3, 11)
    v, u = eye[0] + eye[1], eye[0] - eye[1] - eye[2] - eye[3]
    spread = g["k1"] * (high - low) / 4
    k3, k4, t = cp.Variable(nonneg=True), cp.Variable(nonneg=True), cp.Variable()
    constraints = [g["k1"] * g["k2"] + k3 + k4 <= 20 * m]

    def sigma(k3, k4, thrust):
        k12 = g["k1"] * g["k2"]
        f = k12 * (k12 + k3) / (m * (thrust - g["k1"] * k12 / m * q[2]))
        names = g | {"k3": k3, "k4": k4}
        return np.array(checker_kit.sigma(names, [1, 1, 1, 1], Q, f, q), float)

    for thrust in map(float, problem.thrust):
        constant = sigma(0, 0, thrust)
        by_k3, by_k4 = sigma(1, 0, thrust) - constant, sigma(0, 1, thrust) - constant
        tau = cp.Variable()
        corner = constant + k3 * by_k3 + k4 * by_k4 - spread * tau * v.T @ v - t * np.eye(11)
        side = np.sqrt(spread) * u
        block = cp.bmat([[corner, side.T], [side, tau * np.eye(3)]])
        constraints.append((block + block.T) / 2 >> 0)
    cp.Problem(cp.Maximize(t), constraints).solve(solver=cp.CLARABEL)
    best = 2 * float(t.value) / m
    assert best == pytest.approx(request.getfixturevalue(which).estimate, rel=1e-3)
    assert best <= float(request.getfixturevalue(which).verdict.decay_rate) * 1.001


@pytest.mark.slow
@pytest.mark.parametrize("which", ["fast", "fast_over_box"])
def test_no_random_feasible_gains_are_better_by_a_thousandth(which, request, whole):
    """Of 20,000, and with `make trials` of 100,000."""
    tuned = request.getfixturevalue(which)
    questions = Questions.of(gain_problem(tuned.mission))
    rng, count = np.random.default_rng(7), 100_000 if whole else 20_000
    most = 20 * questions.mass
    g = [float(k) for k in (tuned.mission.gains.k1, tuned.mission.gains.k2)]
    wide = 10 ** rng.uniform(-3, 2, (2, count // 2))
    near = np.array(g)[:, None] * np.exp(rng.normal(0, 0.2, (2, count - count // 2)))
    k1, k2 = np.concatenate([wide, near], axis=1)
    k1 = np.where(k1 * k2 < most, k1, rng.uniform(0, 1, count) * most / k2)
    left = most - k1 * k2
    share = 10 ** rng.uniform(-4, 0, count)
    k3 = left * share
    k4 = (left - k3) * rng.uniform(0, 1, count) ** 0.2
    rates = 2 * margins(replace(questions, gains=(k1, k2, k3, k4))) / questions.mass
    assert (k1 * k2 + k3 + k4 <= most * (1 + 1e-12)).all()
    best = float(tuned.verdict.decay_rate)
    assert np.nanmax(rates) <= 1.001 * best
    assert np.nanmax(rates) > 0.9 * best  # the sample does come near


@pytest.mark.slow
def test_settling_is_faster_than_with_decay_and_certified(x4, fast):
    quick = tune(x4, objective="settling", at_least=5e-4)
    assert isinstance(certify(quick.mission), Proved)
    assert quick.verdict.decay_rate >= Fraction("0.0005") * Fraction(999, 1000)
    assert quick.slowest_rate > 1.2 * fast.slowest_rate
    assert quick.slowest_rate == pytest.approx(slowest_rate(quick.mission), rel=1e-9)


@pytest.mark.parametrize("change", [{}, OFF_AXIS, {"gains.k4": "50", "gains.k1": "0.7"}])
def test_the_slowest_rate_is_that_of_the_loop_that_flies(change):
    """Its 19 states linearised at the hover: 11 errors, yaw, and what keeps R a rotation."""
    mission = load("x4-flyer", change)
    numbers, (design, points), x = LoopNumbers.of(mission), parameters(4), ca.SX.sym("x", 19)
    slope = ca.jacobian(loop_rate(x, design, points), x)
    read = ca.Function("slope", [x, design.vector(), points], [slope])
    spectrum = np.linalg.eigvals(np.array(read(numbers.hover, numbers.design, numbers.points)))
    yaw = float(mission.gains.k_yaw / mission.vehicle.inertia[2])
    slow = np.sort(-spectrum.real[(abs(spectrum) > 1e-7) & (abs(spectrum + yaw) > 1e-9 * yaw)])
    assert len(slow) == 11
    assert slowest_rate(mission) == pytest.approx(slow[0], rel=1e-6)


def test_slowest_rates_are_those_of_each_set_of_gains(x4):
    missions = [load("x4-flyer", {"gains.k4": k4}) for k4 in ("0.05", "0.2", "1")]
    gains = tuple(np.concatenate(k) for k in zip(*map(four, missions), strict=True))
    assert slowest_rates(x4, gains) == pytest.approx([slowest_rate(m) for m in missions])
    assert len(slowest_rates(x4, tuple(k[:0] for k in gains))) == 0


@pytest.mark.whole
def test_a_search_of_weights_certifies_a_faster_decay(fast_over_box):
    weighed = tune(fast_over_box.mission, weights="search")
    assert weighed.verdict.decay_rate > fast_over_box.verdict.decay_rate
    assert weighed.verdict.problem.weights != ONES
    assert isinstance(certify(weighed.mission, weights=weighed.verdict.problem.weights), Proved)


# --- limits ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"start.rotation": "[0.1, -0.2, 0.3]", "start.velocity": "[0.5, 0, 1]"},
        {"start.rates": "[0.1, 0.2, 0]"},
    ],
)
def test_the_first_command_is_what_the_simulator_flies(fast, change):
    mission = load("x4-flyer", given(fast) | change)
    thrusts, _ = FirstCommand.of(mission)(four(mission))
    first = simulate(mission, duration=0.1)["rotor_thrust"].values[0]
    assert thrusts[:, 0] == pytest.approx(first, rel=1e-12)


def four(mission):
    g = mission.gains
    return tuple(np.array([float(k)]) for k in (g.k1, g.k2, g.k3, g.k4))


def test_the_tilt_asked_for_is_that_of_the_thrust_which_cancels_the_force_error(x4):
    _, tilt = FirstCommand.of(x4)(four(x4))
    flight = simulate(x4, duration=0.1)
    g, m = x4.gains, x4.vehicle.mass
    asked = float(g.k1**2 * g.k2 / m) * flight["delta2"].values[0] + [0, 0, float(m) * 9.8]
    assert tilt[0] == pytest.approx(math.atan2(math.hypot(*asked[:2]), asked[2]), rel=1e-12)


@pytest.mark.slow
@settings(deadline=None, max_examples=30)
@drawn(st.floats(0.1, 5), st.floats(1, 20), st.floats(1, 100), st.floats(23.7, 60))
def test_k4_at_its_limit_keeps_every_limit_and_more_breaks_one(k1, k2, k3, most):
    mission = load("x4-flyer")
    command, limits = FirstCommand.of(mission), Limits(20.0, rotor_thrust=most)
    one = tuple(np.array([k]) for k in (k1, k2, k3))
    low, high = highest_k4(limits, command, one)
    if not low < high:
        return
    for factor, inside in ((1 - 1e-9, True), (1 + 1e-6, False)):
        thrusts, _ = command((*one, high * factor))
        bandwidth = (k1 * k2 + k3 + high[0] * factor) / 9.6
        kept = thrusts.min() >= 0 and thrusts.max() <= most and bandwidth <= 20
        assert kept == inside


@pytest.mark.slow
def test_tilt_and_rotor_limits_bind_and_are_kept(x4, fast):
    tuned = tune(x4, tilt=math.radians(0.6), rotor_thrust=23.6)
    flight = simulate(tuned.mission, duration=1)
    assert flight["rotor_thrust"].values[0].max() <= 23.6
    binding = [u.name for u in tuned.uses if u.binds]
    assert binding
    assert "bandwidth" not in binding
    assert tuned.verdict.decay_rate < fast.verdict.decay_rate
    for use in tuned.uses:
        assert use.value <= use.limit or use.name.startswith("lowest")


@pytest.mark.slow
def test_a_sampling_rate_limits_the_bandwidth(x4):
    tuned = tune(x4, rate=25)
    used = {u.name: u for u in uses(Limits(20.0, 25.0), FirstCommand.of(x4), tuned.mission)}
    assert used["bandwidth"].value <= 5
    assert used["bandwidth times sampling period"].binds
    assert not used["bandwidth"].binds


@pytest.mark.slow
def test_limits_of_the_mission_s_rotors_are_kept_unless_another_is_given(x4, whole):
    """The command at the start as the simulator flies it, with and without the limits."""
    rotors = {"rotors": "{min_thrust = 23.47, max_thrust = 23.56}"}
    weak = load("x4-flyer", rotors)
    free, kept, given_one = tune(x4, bandwidth=5.0), tune(weak, bandwidth=5.0), 24.0

    def first(tuned):
        ideal = load("x4-flyer", given(tuned))
        return simulate(ideal, duration=0.1)["rotor_thrust"].values[0]

    assert first(free).max() > 23.56
    assert first(free).min() < 23.47
    assert 23.47 <= first(kept).min() <= first(kept).max() <= 23.56
    used = {u.name: u for u in kept.uses}
    assert used["highest rotor thrust at the start"].limit == 23.56
    assert used["lowest rotor thrust at the start"].limit == 23.47
    if whole:
        asked = tune(weak, bandwidth=5.0, rotor_thrust=given_one)
        assert {u.limit for u in asked.uses} >= {24.0, 23.47}


def test_rotors_that_cannot_hover_are_named():
    for rotors, words in (
        ("{max_thrust = 20}", "3.52 N below"),
        ("{min_thrust = 25}", "above m g"),
    ):
        answer = tune(load("x4-flyer", {"rotors": rotors}))
        assert isinstance(answer, Infeasible)
        assert words in answer.reason


# --- wishes that cannot be met --------------------------------------------------------------------


def test_a_rotor_that_cannot_carry_its_part_of_the_weight_is_named(x4):
    answer = tune(x4, rotor_thrust=20.0)
    assert isinstance(answer, Infeasible)
    assert "3.52 N below m g/4 = 23.52 N" in answer.reason


@pytest.mark.slow
def test_a_wish_for_decay_says_what_binds_and_which_bandwidth_would_do(x4, whole):
    answer = tune(x4, bandwidth=1.0, at_least=0.0012)
    assert isinstance(answer, Infeasible)
    assert "what binds: bandwidth" in answer.reason
    assert 1 < answer.needed_bandwidth < 20
    enough = tune(x4, bandwidth=answer.needed_bandwidth * 1.02, at_least=0.0012)
    assert isinstance(enough, Tuned)
    if whole:
        short = tune(x4, bandwidth=answer.needed_bandwidth * 0.95, at_least=0.0012)
        assert isinstance(short, Infeasible)


@pytest.mark.slow
def test_bounds_that_no_gain_meets_are_blamed(x4):
    answer = tune(x4, at_least=0.1)
    assert isinstance(answer, Infeasible)
    assert answer.needed_bandwidth is None
    assert "the bounds of Q and of the thrust bind" in answer.reason
    assert answer.best is not None


def test_a_start_that_no_command_can_leave_is_blamed():
    mission = load("x4-flyer", {"start.rates": "[8, -8, 3]"})
    answer = tune(mission, rotor_thrust=23.53, bandwidth=0.1)
    assert isinstance(answer, Infeasible)
    assert "N beyond [0, 23.53] N" in answer.reason


@pytest.mark.slow
def test_settling_with_too_high_a_rate_says_what_rate_there_is(x4, fast):
    answer = tune(x4, objective="settling", at_least=0.002)
    assert isinstance(answer, Infeasible)
    assert answer.best.verdict.decay_rate == fast.verdict.decay_rate


@pytest.mark.parametrize(
    ("option", "value"),
    [("bandwidth", -1.0), ("rate", 0.0), ("tilt", 2.0), ("rotor_thrust", -3.0), ("at_least", 0.0)],
)
def test_an_option_out_of_range_is_refused(x4, option, value):
    with pytest.raises(InputError, match=option):
        tune(x4, **{option: value})


# --- the curve ------------------------------------------------------------------------------------


def curve_once():
    """Return three points of the curve, and what was reported meanwhile."""

    def made():
        seen = []

        def report(done, total):
            seen.append((done, total))

        return pareto(load("x4-flyer"), 3, bandwidth=8.0, report=report), seen

    return kept_value("curve of decay", made)


@pytest.mark.slow
def test_decay_grows_with_bandwidth_along_the_curve(x4):
    points, seen = curve_once()
    rates = [t.verdict.decay_rate for _, t in points]
    assert rates == sorted(rates)
    assert [b for b, _ in points] == [0.4, 1.789, 8.0]
    assert seen == [(1, 3), (2, 3), (3, 3)]


# --- on the command line --------------------------------------------------------------------------


@pytest.mark.slow
def test_tune_writes_a_mission_file_that_certifies_at_the_rate_it_states(capsys):
    status, out, err = run(capsys, *TUNE, "--out", "quick.toml", "--json")
    answer = json.loads(out)
    assert (status, err) == (0, "")
    assert answer["binds"] == ["bandwidth"]
    assert answer["improvement"] > 3.7
    text = Path("quick.toml").read_text(encoding="utf-8")
    assert 'name = "quick"' in text
    assert "# kg m², about the body axes" in text  # comments are kept
    certified = json.loads(run(capsys, "certify", "quick.toml", "--json")[1])
    assert certified["decay_rate"] == answer["decay_rate"]
    assert {k: float(v) for k, v in load("quick.toml").gains} == answer["gains"]


def test_an_infeasible_wish_has_status_1_and_writes_nothing(capsys):
    options = ("--rotor-thrust", 20, "--out", "no.toml")
    status, out, _ = run(capsys, *TUNE, *options)
    assert status == 1
    assert "infeasible" in out
    assert not Path("no.toml").exists()
    answer = json.loads(run(capsys, *TUNE, "--json", *options)[1])
    assert answer["status"] == "infeasible"


@pytest.mark.slow
def test_the_curve_is_drawn(capsys, monkeypatch):
    assert run(capsys, *TUNE, "--pareto", 1)[0] == 2
    monkeypatch.setattr(tuning, "pareto", lambda *_, **__: curve_once()[0][:2])
    status, out, _ = run(capsys, *TUNE, "--pareto", 2, "--out", "curve.svg", "--json")
    assert status == 0
    assert len(json.loads(out)["points"]) == 2
    assert "<svg" in Path("curve.svg").read_text()


def test_the_search_is_the_same_each_time(x4):
    limits = Limits(20.0)
    search = GainSearch(
        Questions.of(gain_problem(x4)), limits, FirstCommand.of(x4), objective="decay"
    )
    assert (search.starts() == search.starts()).all()


def test_the_points_of_the_search_are_halton_s():
    wanted = qmc.Halton(4, scramble=False).random(1001)[1:]
    assert halton(1000, 4) == pytest.approx(wanted, abs=1e-12)
