"""Starts that are refuted: the motion is shown to sink to the target."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from command_line import run
from hoverproof import checker
from hoverproof.certification.attraction.proof import attraction
from hoverproof.certification.attraction.refutation import flight_rate, refute, worst_states
from hoverproof.certification.attraction.starts import Start, State
from hoverproof.certification.verdict import Refuted, Undecided
from hoverproof.mission.reading import load
from hoverproof.plant.goal import hover_goal
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.servo.loop import LoopNumbers, loop_rate, parameters
from papers_law import CRAZYFLIE, PAPERS, RACER, RESEARCH
from sampling import mostly_whole

F = Fraction
FALLING = {"start": "{position = [0.1, 0.2, -0.5], velocity = [0.1, 0, 1.5]}"}
LEANING = {
    "start": "{position = [0.1, 0.2, -0.5], velocity = [0.1, 0, 1.5], rotation = [0.1, -0.2, 1], "
    "rates = [0.3, 0.1, 0]}"
}


def numbers(mission):
    numbers = LoopNumbers.of(mission)
    return numbers.design, numbers.points.T


def fly(mission, start, duration, **options):
    """Integrate the simulator's own closed loop, (19,), by another method, from pinhole images."""
    design, points = numbers(mission)
    x = ca.SX.sym("x", 19)
    d, p = parameters(len(points))
    read = ca.Function("f", [x, d.vector(), p], [loop_rate(x, d, p)])

    def rate(t, x):
        return np.array(read(x, design, points.T))[:, 0]

    def sunk(t, x):
        return x[2] - points[:, 2].max()

    sunk.terminal = options.pop("stop", True)
    settings = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-12, "events": sunk, **options}
    return solve_ivp(rate, (0, duration), start, **settings)


def refuted(mission, start=None):
    return refute(mission, start and [start], Undecided(mission=mission, reason="not searched"))


# --- the checker's equations and enclosures -----------------------------------------------------


@pytest.mark.parametrize("name", PAPERS.values(), ids=PAPERS)
def test_the_checker_has_the_motion_of_the_derived_loop(name):
    mission = load(name, LEANING)
    state = State.of(mission)
    parts = {"motion": {**vars(state), "time": F(1), "steps": [F(1)]}}
    p = checker.claim_of(content(mission, parts))
    series = p.taylor(p.unknowns(), F(1), 1)
    mine = np.array([line[1].mid / 2**checker.FINE for line in series])
    design, points = numbers(mission)
    x = state.packed()
    rate = np.array(flight_rate(len(points))(x, design, points.T))[:, 0]
    R, spin = x[6:15].reshape(3, 3).T, rate[6:15].reshape(3, 3).T
    turn, turned = np.cross(x[15:18], [0, 0, 1]), np.cross(rate[15:18], [0, 0, 1])
    wanted = [rate[:3], spin @ x[3:6] + R @ rate[3:6], spin[:, 2], spin @ turn + R @ turned]
    assert mine[:12] == pytest.approx(np.concatenate(wanted), rel=1e-9, abs=1e-9)
    assert mine[12] == pytest.approx(rate[18], rel=1e-9)
    assert max(line[1].rad for line in series) < 2 ** (checker.FINE - 100)


def content(mission, parts):
    from hoverproof.certification.certificate import seal

    return seal(mission, "sinking", parts, "0").content


def enclosures(p, step, count):
    z, found = p.unknowns(), []
    for _ in range(count):
        z = p.advance(z, step)
        found.append(z)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_whole(list(PAPERS.values()), every=3))
def test_the_enclosure_holds_the_motion(name, monkeypatch):
    """Another integrator stays near it; enclosures by other steps and orders overlap it."""
    mission = load(name, LEANING)
    state, step = State.of(mission), F(1, 256)
    p = checker.claim_of(
        content(mission, {"motion": {**vars(state), "time": F(1), "steps": [F(1)]}})
    )
    boxes = enclosures(p, step, 12)
    flown = fly(mission, state.packed(), 12 / 256, t_eval=np.arange(1, 13) / 256)
    for box, x in zip(boxes, flown.y.T, strict=False):
        middle = [ball.mid / 2**checker.FINE for ball in box]
        assert middle[:3] == pytest.approx(x[:3], abs=1e-8)
        assert middle[6:9] == pytest.approx(x[12:15], abs=1e-7)
        assert middle[12] == pytest.approx(x[18], abs=1e-7)
    monkeypatch.setattr(checker, "ORDER", 31)
    others = enclosures(p, step / 2, 24)
    for ball, other in zip(boxes[-1], others[-1], strict=True):
        assert abs(ball.mid - other.mid) <= ball.rad + other.rad
        assert 0 < ball.rad < 2 ** (checker.FINE - 40)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(*[st.fractions(-50, 50, max_denominator=999)] * 2), min_size=2))
def test_a_product_of_series_is_enclosed(pairs):
    lines = zip(*pairs, strict=True)
    x, y = (checker.Series(list(map(checker.Ball.over, line)).__getitem__) for line in lines)
    y[len(pairs) - 1]  # how far a factor has been computed already makes no difference
    exact = sum(a[0] * b[1] for a, b in zip(pairs, reversed(pairs), strict=True))
    found = (x * y)[len(pairs) - 1]
    first = (x * y)[0]
    assert abs(F(first.mid, 2**checker.FINE) - pairs[0][0] * pairs[0][1]) < F(1, 2**180)
    assert abs(F(found.mid, 2**checker.FINE) - exact) <= F(found.rad, 2**checker.FINE)


# --- which starts are refuted -------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_whole(list(PAPERS.values()), every=2, first=1))
def test_what_is_refuted_is_what_another_integrator_sees_sink(name, whole):
    """Of two starts, and with `make trials` of four."""
    for seed in range(4 if whole else 2):
        refuted_if_it_sinks(load(name), np.random.default_rng(seed))


def refuted_if_it_sinks(mission, rng):
    goal = hover_goal(mission).position
    height = float(mission.height_of_target - goal[2])
    aside, up = rng.uniform(-1, 1, 2) * height, rng.uniform(0.1, 0.6) * height
    place = [F(str(round(float(c), 3))) for c in (*aside, float(mission.height_of_target) - up)]
    speed = F(str(round(float(rng.uniform(0, 2)), 2)))
    start = Start(tuple((c, c) for c in place), speed)
    (state,) = worst_states(mission, start)
    flown = fly(mission, state.packed(), 30)
    verdict = refuted(mission, start)
    if len(flown.t_events[0]):
        assert isinstance(verdict, Refuted)
        assert flown.t[-1] < verdict.time < flown.t[-1] + 0.05
    else:
        assert isinstance(verdict, Undecided)


def test_both_kinds_occur_among_the_starts_of_that_test():
    fast, slow = (Start(((F(0),) * 2, (F(0),) * 2, (F(-1, 2),) * 2), F(v)) for v in (2, 0))
    mission = load(RACER)
    assert isinstance(refuted(mission, fast), Refuted)
    told = refuted(mission, slow)
    assert isinstance(told, Undecided)
    assert "a simulation, which is no proof, settles after" in told.reason


sizes = st.fractions(0, F(1, 2), max_denominator=100)


@settings(max_examples=50, deadline=None)
@given(speed=sizes, tilt=sizes, rate=sizes, thrust=sizes)
def test_the_states_tried_are_in_the_set(speed, tilt, rate, thrust):
    mission = load("x4-flyer")
    box = ((F(-1), F(1)), (F(0), F(2)), (F(-3), F(-2)))
    states = list(worst_states(mission, Start(box, speed, tilt, rate, thrust)))
    assert states
    for s in states:
        axis, turning = ([a for a, _ in part] for part in (s.axis, s.turning))
        assert all(low <= a <= high for (a, _), (low, high) in zip(s.position, box, strict=True))
        assert sum(a * a for a in axis) == 1
        assert sum(a * b for a, b in zip(axis, turning, strict=True)) == 0
        assert np.arccos(min(1.0, float(axis[2]))) <= float(tilt) + 1e-7
        assert sum(a * a for a in turning) <= rate**2
        assert sum(a * a for a, _ in s.velocity) <= speed**2
        assert abs(s.thrust[0] - mission.vehicle.weight) <= thrust


def test_the_start_of_a_mission_is_enclosed_with_its_attitude():
    mission = load("x4-flyer", LEANING)
    state = State.of(mission)
    R = rotation_matrix(0.1, -0.2, 1.0)
    for sides, wanted in (
        (state.velocity, R @ [0.1, 0, 1.5]),
        (state.axis, R[:, 2]),
        (state.turning, R @ np.cross([0.3, 0.1, 0], [0, 0, 1])),
    ):
        assert [float(a) for a, _ in sides] == pytest.approx(wanted)
        assert all(0 <= high - low < F(1, 2**180) for low, high in sides)
    assert checker.inhabited(list(state.axis), list(state.turning))
    packed = state.packed()
    assert packed[3:6] @ packed[3:6] == pytest.approx(0.1**2 + 1.5**2)
    assert isinstance(refuted(mission), Refuted)


def test_a_start_with_yaw_rate_is_not_refuted():
    mission = load("x4-flyer", {"start": "{position = [0, 0, -1], rates = [0, 0, 1]}"})
    assert isinstance(refuted(mission), Undecided)


@pytest.mark.parametrize("z", [F(0), F(1), F(-1, 10**6)])
def test_only_a_start_above_the_target_is_said_to_sink_to_it(z):
    verdict = refuted(load("x4-flyer"), Start(((F(0),) * 2, (F(0),) * 2, (z, z)), F(2)))
    assert isinstance(verdict, Refuted) == (z < 0)
    if z >= 0:
        assert "not above the lowest target point" in verdict.reason
    else:
        assert verdict.time > 0


def test_of_a_target_on_two_heights_the_lowest_point_counts():
    points = "[[1, 1, 0.5], [1, -1, 0], [-1, -1, 0], [-1, 1, 0.5]]"
    start = FALLING | {"target.points": points, "goal": "{centroid = [0, 0, 3.5]}"}
    verdict = refuted(load("x4-flyer", start))
    assert isinstance(verdict, Refuted)
    assert "z >= 1/2 m" in verdict.certificate.content["statement"]


sides = st.tuples(*[st.fractions(-2, 2, max_denominator=8)] * 2).map(sorted)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(st.lists(sides, min_size=3, max_size=3), st.lists(sides, min_size=3, max_size=3))
def test_a_start_that_is_shown_to_be_inhabited_has_a_state(axis, turning):
    if not checker.inhabited(axis, turning):
        return
    near = np.array([float(min(max(a, 0), b)) for a, b in axis])
    far = np.array([float(max(a, b, key=abs)) for a, b in axis])
    shares = np.linspace(0, 1, 100_001)[:, None]
    line = near + shares * (far - near)
    b = line[np.abs((line**2).sum(axis=1) - 1).argmin()]
    assert b @ b == pytest.approx(1, abs=1e-3)
    ends = np.sort(np.array(turning, float).T * b, axis=0).sum(axis=1)
    assert ends[0] <= 1e-9
    assert ends[1] >= -1e-9


@pytest.mark.parametrize(
    ("axis", "turning", "found"),
    [
        (["0", "0", "1"], ["0", "0", "0"], True),
        (["3/5", "0", "4/5"], ["-4", "7", "3"], True),
        (["3/5", "0", "4/5"], ["-4", "7", "2"], False),
        (["-1 1", "-1 1", "11/10 6/5"], ["0", "0", "0"], False),  # [-1, 1]² is [0, 1]
        (["-1/2 1/2", "-1/2 1/2", "-1/2 1/2"], ["0", "0", "0"], False),
        (["0 1", "0", "0"], ["1", "0", "0"], False),  # |b| = 1 here, b·w = 0 there
        (["-1 1", "0", "0"], ["1", "0", "0"], False),
        (["0", "-1 1", "0 1"], ["0", "-1 1", "-1 1"], True),
    ],
)
def test_a_start_without_a_state_is_told(axis, turning, found):
    read = [[[F(x) for x in (e.split() * 2)[:2]] for e in part] for part in (axis, turning)]
    assert checker.inhabited(*read) is found


def test_a_proved_start_settles():
    told = refuted(load(CRAZYFLIE))
    assert isinstance(told, Undecided)
    assert "settles" in told.reason


# --- the certificate and the command ------------------------------------------------------------


@pytest.fixture(scope="module")
def sinking():
    return refuted(load("x4-flyer", FALLING))


def changed(certificate, path, value):
    forged = copy.deepcopy(certificate.content)
    if path[-1] == "time":  # followed in one step
        forged["motion"]["steps"] = [value]
    *above, last = path
    spot = forged
    for key in above:
        spot = spot[key]
    spot[last] = value
    forged["mission_sha256"] = checker.digest(forged["mission"])
    forged["statement"] = checker.statement(forged)
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    return forged


def test_the_checker_alone_accepts_the_file(sinking):
    sinking.certificate.save("sinking.json")
    command = [sys.executable, "-I", "-S", checker.__file__, "sinking.json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    words = " ".join(done.stdout.split())
    assert "It is not true" in words
    assert "the vehicle stays above the lowest target point, z < 0 m" in words
    assert "What comes after is not said." in words
    assert "switched on" not in words


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        (("motion", "time"), "1/64", "not shown to sink"),
        (("motion", "velocity", 2), ["-1", "-1"], "not shown to sink"),
        (("motion", "position", 2), ["-4", "-4"], "not shown to sink"),
        (("motion", "axis", 2), ["99/100", "99/100"], "no state"),
        (("motion", "axis"), [["-1", "1"], ["-1", "1"], ["11/10", "6/5"]], "no state"),
        (("motion", "turning", 2), ["1", "1"], "no state"),
        (("motion", "time"), "0", "time is not above 0"),
        (("motion", "time"), "-1", "time is not above 0"),
        (("motion", "time"), "61", "time is not above 0 s and at most 60"),
        (("motion", "steps"), ["1/8"], "do not fill the time"),
        (("motion", "steps"), [], "do not fill the time"),
        (("motion", "steps"), ["1/1000000"] * 200, "too many steps"),
        (("motion", "position", 2), ["0", "0"], "not above the lowest target point"),
        (("motion", "position", 2), ["-1/2", "1/10"], "not above the lowest target point"),
        (("motion", "position", 2), ["1", "1"], "not above the lowest target point"),
        (("mission", "target", "points", 0, 2), "-1/2", "not the goal|vertical|axial|height"),
        (("motion", "thrust"), ["0", "0"], "singularity"),
        (("motion", "thrust"), ["95", "94"], "not in order"),
        (("motion", "velocity", 2), [str(10**40)] * 2, "not followed to its end"),
    ],
)
def test_a_motion_that_does_not_sink_as_claimed_is_rejected(sinking, path, value, reason):
    with pytest.raises(checker.Rejected, match=reason):
        checker.check(changed(sinking.certificate, path, value))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("motion", "time"), "60"),
        (("motion", "velocity", 2), ["-1", "3/2"]),
        (("mission", "gains", "k1"), "3"),
    ],
)
def test_a_motion_that_the_steps_do_not_follow_is_rejected(sinking, path, value):
    with pytest.raises(checker.Rejected, match=r"not followed to its end|not shown to sink"):
        checker.check(changed(sinking.certificate, path, value))


def test_a_step_too_long_is_not_taken(sinking):
    p = checker.claim_of(sinking.certificate.content)
    with pytest.raises(checker.Rejected, match="not followed to its end"):
        p.advance(p.unknowns(), F(4))


@pytest.mark.slow
def test_a_search_that_fails_goes_on_to_refute(capsys):
    command = ["attraction", RESEARCH, "--start=0,0,-1", "--speed", "3", "--json"]
    status, out, _ = run(capsys, *command)
    assert status == 1
    answer = json.loads(out)
    assert answer["verdict"] == "refuted"
    assert answer["certificate"] == "research-1.5kg.attraction.refutation.json"
    assert answer["level"] is answer["reach"] is answer["figure"] is None
    assert "sinks to the target within" in answer["reason"]
    assert set(answer["motion"]) == {
        *("position", "velocity", "axis", "turning", "thrust", "time", "steps"),
    }
    assert checker.check_file(answer["certificate"]) == answer["statement"]
    status, _, _ = run(capsys, "check", answer["certificate"])
    assert status == 0


@pytest.mark.slow
def test_attraction_in_python_returns_the_refutation():
    verdict = attraction(load("x4-flyer", FALLING), barrier=True)
    assert isinstance(verdict, Refuted)
    assert verdict.status == "refuted"
