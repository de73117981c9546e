"""The theorem of exponential convergence, attacked with vehicles that are not the modelled one.

The kit is independent of the graphs of the package, but for the controller. Weights and levels here
are hints, as a search finds them: what is asked is whether any flight contradicts them.
"""

from __future__ import annotations

import copy

import numpy as np
import pytest

import uncertain_body as kit
from uncertain_body import Case, Doubt, View, quarter, times
from uncertain_flights import any_matrix, fly, strongest

EIGHT = [
    (feature, goal, force)
    for feature in ("centroid", "scaled")
    for goal in ("image", "inertial")
    for force in ("modelled", "measured")
]
EVERYTHING = {
    "thrust": "0.2",
    "torque": "0.2",
    "latency": "0.073",
    "rotor_lag": "0.03",
    "wind": "0.2",
    "yaw_rate": "1",
}
CLAIMS = {
    "all at once": (
        EVERYTHING,
        ["0.11179", "0.10385", "0.038579"],
        ["0.003456", "0.00716"],
        "3.446",
    ),
    "no lag": (
        {**EVERYTHING, "rotor_lag": "0"},
        ["0.10711", "0.10824", "0.022502"],
        None,
        "0.2833",
    ),
    "no latency": (
        {**EVERYTHING, "latency": "0"},
        ["0.11179", "0.10385", "0.037927"],
        ["0.003263", "0.00712"],
        None,
    ),
}
"""Tolerances, w2 to w4, a5 and a6, and M."""
TOO_MUCH = {"thrust": "0.9", "torque": "0.6", "rotor_lag": "0.09", "yaw_rate": "10"}
"""Each alone is too much for these weights, by what is found."""
each_claim = pytest.mark.parametrize(
    "name", [k if k == "all at once" else pytest.param(k, marks=pytest.mark.slow) for k in CLAIMS]
)
LEVEL, OFFSET, RATE = "28.125", "7.5", "0.1"


def content(name, law=("scaled", "inertial", "measured"), **changes):
    """Return what a certificate says: the parts that flights are held to."""
    asked, weights, lag, memory = CLAIMS[name]
    feature, goal, force = law
    corner = ("1/10", "-1/10")
    return {
        "goal_position": ["0", "0", "-1.2"],
        "mission": {
            "law": {"feature": feature, "goal": goal, "force": force},
            "vehicle": {"mass": "0.5", "gravity": "9.81", "inertia": ["0.0021", "0.0025", "0.004"]},
            "gains": {"k1": "0.015", "k2": "55", "k3": "2.4", "k4": "6", "k_yaw": "0.05"},
            "target": {"points": [[x, y, "0"] for x in corner for y in corner]},
            "start": {"position": ["0.6", "0", "-1.8"]},
            "uncertainty": {**asked, **changes},
        },
        "weights": weights,
        "lag": lag and dict(zip(("torque", "thrust"), lag, strict=True)),
        "memory": memory,
        "domain": {"bounds": ["4.59", "13.41"], "offset": OFFSET},
        "claim": {
            "level": LEVEL,
            "rate": RATE,
            "start_level": "24.95",
            "settling": {"offset": "0.6", "radius": "0.085", "time": "49.4"},
        },
    }


def claiming(rate, name="all at once", **changes):
    """Return the case of a certificate that claims another rate, or for more vehicles."""
    made = content(name, **changes)
    made["claim"]["rate"] = rate
    return Case(made)


# --- the error rates ----------------------------------------------------------------------------


def claimed_rates(view, level):
    """Return the rates of δ1 to δ4, and τ times those of μ and μT, in closed form, (14, N)."""
    case, x, doubt, d = view.case, view.x, view.doubt, view.errors()
    d1, d2, d3, d4 = kit.parts(d)
    fixed, tau, yaw, gain, slow = case.fixed, doubt.lag, doubt.yaw, doubt.gain, doubt.lag > 0
    y, n = view.feature(view.level_flow), view.feature(level - view.level_image)
    h, zeta, wind = case.c * case.kappa / view.D, d4 - d3[:2], case.m * view.wind
    chi = (x[kit.THRUST] - case.c * fixed) / view.D
    p1, p2, p3 = h * d3[2], h * n[2], kit.cross(view.Omega, wind)[2] / view.D
    pi = 2 * (p1 - p2) + p3
    mu = np.where(slow, view.lagging(d, (x[kit.ANGULAR], x[kit.LIFT])), 0)
    u = np.where(slow, case.kappa * d3[2] + mu[2], case.kappa * (d3[2] - n[2]))
    lag = gain * (case.c * u / view.D - (p1 - p2))
    pull, yawed = case.k12 * (d3 - d2), yaw * quarter(d3[:2] - n[:2])
    s_n = -case.K4 * d4 - pull[:2]
    compensated = yaw * np.tensordot(case.compensated, zeta, 1)
    missed = case.K4 * n[:2] - pi * zeta + yawed + compensated
    s = s_n + np.where(slow, mu[:2], missed)
    dragged = fixed * h * np.stack([*zeta, 0 * h])
    turned = [-kit.cross(view.Omega, part) for part in (d1, d2, d3)]
    d1r = turned[0] - y + dragged
    d2r = turned[1] + y + pull - dragged
    d3r = turned[2] + y + pull + np.stack([*(case.kappa * chi * zeta), -gain * u])
    factor = case.kappa * chi + (gain - 1) * pi / 2 + pi + p2 - (gain - 1) * p3 / 2 + lag
    d4r = y[:2] + factor * zeta + pull[:2] - yaw * quarter(d3[:2])
    d4r = d4r + s + times(doubt.torque, s) - yaw * times(doubt.turn, zeta)
    apart = case.kappa * chi * zeta + (fixed + d3[2] - d2[2]) * h * zeta
    apart = apart - yaw * quarter((d3 - d2)[:2])
    lever = gain * case.c * u / view.D + p3
    mu_rate = missed - mu[:2] + tau * (case.K4 * d4r + case.k12 * apart + lever * s)
    lift_rate = -case.kappa * n[2] - mu[2] - tau * case.kappa * d3r[2]
    return np.concatenate([d1r, d2r, d3r, d4r, slow * mu_rate, [slow * lift_rate]])


def in_doubt(case, rng, count):
    """Return vehicles far outside of what they should be, and states far from the goal."""

    def draw(*shape):
        return rng.normal(size=(*shape, count))

    measured, reach = case.measured, 3 if case.scaled else 0.3
    slow = np.where(rng.random(count) < 0.5, 0.03 * rng.random(count), 0) * measured
    matrices = any_matrix(rng, 0.3, count), any_matrix(rng, 1.5, count)
    gain = 1 + 0.3 * rng.uniform(-1, 1, count) * measured
    doubt = Doubt(gain, *matrices, draw(), draw(3), slow)
    position = np.array([[0.1], [0.2], [-1.5]]) + 0.3 * draw(3)
    wind = 0.3 * draw(3) * measured
    x = kit.state_of(case, position, reach * draw(8), reach * draw(3), wind, draw(), doubt)
    return View(case, x, doubt), case.image(position + 0.05 * draw(3), 0 * position)[0]


def along(view, level, step=1e-30):
    """Return what `claimed_rates` claims, of the motion itself, by a complex step."""
    ahead = View(view.case, view.x + 1j * step * kit.body_rate(view, level), view.doubt)
    d = ahead.errors()
    mu = ahead.lagging(d, (ahead.x[kit.ANGULAR], ahead.x[kit.LIFT]))
    return np.concatenate([d, view.doubt.lag * mu]).imag / step


@pytest.mark.parametrize("law", EIGHT, ids="/".join)
def test_the_error_rates_of_any_vehicle_are_the_closed_form_with_rotor_lag_too(law):
    case = Case(content("all at once", law))
    view, level = in_doubt(case, np.random.default_rng(3), 400)
    claimed = claimed_rates(view, level)
    assert along(view, level) == pytest.approx(claimed, rel=1e-9, abs=1e-9)


def test_the_complex_step_is_the_difference_along_the_motion():
    view, level = in_doubt(Case(content("all at once")), np.random.default_rng(4), 50)

    def after(time):
        x, dt = view.x, time
        for part in (0.5, 1):
            middle = View(view.case, x, view.doubt)
            x = view.x + part * dt * kit.body_rate(middle, level)
        return View(view.case, x, view.doubt).errors()

    step = 1e-5
    shown = (after(step) - after(-step)) / (2 * step)
    assert shown == pytest.approx(along(view, level)[:11], rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("wrong", ["gain", "torque", "turn", "yaw", "wind", "lag"])
def test_every_doubt_counts_in_the_error_rates(wrong):
    view, level = in_doubt(Case(content("all at once")), np.random.default_rng(5), 20)
    shown, doubt = along(view, level), copy.copy(view.doubt)
    setattr(doubt, wrong, 1.2 * getattr(doubt, wrong))
    claimed = claimed_rates(View(view.case, view.x, doubt), level)
    assert np.abs(claimed - shown).max() > 0.01


# --- flights ------------------------------------------------------------------------------------


def holds(case, flown):
    """Assert that no flight contradicts the claim, and that bounds are bounds."""
    assert len(flown.fall) > 10
    assert flown.contradicts(case) == []


@pytest.mark.slow
@each_claim
@pytest.mark.parametrize("anywhere", [False, True], ids=["start", "anywhere"])
def test_every_vehicle_within_tolerance_falls_as_is_claimed(name, anywhere, whole):
    case = Case(content(name))
    start = None if anywhere else case.start
    count = 200 if start is not None else 600
    count = count * 10 if whole else count // 2
    holds(case, fly(case, np.random.default_rng(6), count, 1.5, case.settling()[0], start=start))


@pytest.mark.slow
def test_every_vehicle_settles_before_the_proved_time_and_stays(whole):
    case = Case(content("all at once"))
    radius, soon = case.settling()
    count = 2000 if whole else 20
    flown = fly(case, np.random.default_rng(7), count, 14, radius, start=case.start)
    holds(case, flown)
    assert (flown.level * case.level <= case.start_level).all()
    assert (flown.settled <= min(soon, 14)).all()


def test_hovers_in_the_wind_have_no_force_and_no_motion():
    case = Case(content("all at once"))
    flown = fly(case, np.random.default_rng(8), 50, 0.1, 0.1, start=case.goal)
    assert (flown.level < 1e-20).all()


# --- the inequality by itself -------------------------------------------------------------------


@each_claim
@pytest.mark.parametrize("near", [1, 0.03])
def test_evolution_finds_no_state_vehicle_and_delay_that_break_the_inequality(name, near, whole):
    value, _ = strongest(Case(content(name)), 9, 600 if whole else 60, near=near)
    assert value < 0


# --- the attack tells a boast -------------------------------------------------------------------


def test_flights_tell_a_rate_that_is_too_high():
    case = claiming("0.6")
    flown = fly(case, np.random.default_rng(6), 100, 1.5, 0.1, start=case.start)
    assert (flown.ratio > 1).any()
    assert (flown.fall < case.r).any()


def test_evolution_tells_a_rate_that_is_too_high():
    value, _ = strongest(claiming("0.4"), 9)
    assert value > 0


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", TOO_MUCH)
def test_evolution_tells_a_tolerance_that_is_too_wide(tolerance):
    case = claiming(RATE, **{tolerance: TOO_MUCH[tolerance]})
    assert strongest(case, 9, near=0.03)[0] > 0


def test_evolution_tells_a_memory_that_is_too_short():
    made = content("all at once")
    made["memory"] = "0.01"
    assert strongest(Case(made), 9, near=0.03)[0] > 0
