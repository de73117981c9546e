"""Verdicts and certificates of all eight laws, against a model of them written anew."""

from __future__ import annotations

import itertools
import time
from collections import Counter

import casadi as ca
import numpy as np
import pytest

from hoverproof.certification.gains import certify
from hoverproof.certification.verdict import Proved, Refuted
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.servo.laws.hamel_mahony import LAWS
from hoverproof.servo.linearised import slowest_rate
from hoverproof.servo.loop import LoopNumbers, loop_rate, parameters
from laws_kit import depth_matrix, numbers_of, seen, slope
from sampling import mostly_whole

CORNERS = np.array([[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]], float)

# --- random missions ----------------------------------------------------------------------------


def text(x, digits=3):
    return repr(float(f"{x:.{digits}g}"))


def ball_around(J, rng):
    """Return the ends of a ball around J with little or much to spare, or None."""

    def reach(j):
        return np.linalg.norm(J - j * np.eye(3), 2)

    j = min(np.linspace(0.05, 1, 96) * np.trace(J), key=reach) * 10 ** rng.uniform(-0.03, 0.03)
    most = reach(j) * 10 ** rng.uniform(0.02, 0.5)
    return (j - most, j + most) if most < 0.98 * j else None


def random_mission(rng, law):
    """Return a mission with such a law, all numbers of the claim at random, and its verdict."""
    feature, goal, force = law
    side = 10 ** rng.uniform(-1, 0.3) if feature == "scaled" else 1
    points, height = side * CORNERS, side * 10 ** rng.uniform(-0.1, 0.9)
    points = np.round(points, 3)
    aside = rng.normal(size=2) * height * rng.choice([0.05, 0.4]) * (goal == "image")
    position = np.array([*aside, -height])
    q = seen(points, position).round(4)
    flow = (slope if feature == "scaled" else depth_matrix)(points, position[None])[0]
    if feature == "scaled":
        ends = ball_around(flow, rng)
        if ends is None:
            return None
    else:
        least, *_, most = np.linalg.eigvalsh(flow)
        ends = least * 10 ** rng.uniform(-1.5, -0.02), most * 10 ** rng.uniform(0.02, 1)
    mass = float(text(9.6 * 10 ** rng.uniform(-0.3, 0.3)))
    size = 1 / np.trace(flow) if feature == "scaled" else 1
    thrust = mass * 9.8 * np.array([0.99 - rng.uniform(0, 0.5), 1.01 + rng.uniform(0, 1)])
    change = {
        "law.feature": feature,
        "law.goal": goal,
        "law.force": force,
        "target.points": str(points.tolist()),
        "vehicle.mass": text(mass),
        "goal": f"{{centroid = {q.tolist()}}}",
        "gains.k1": text(size * 10 ** rng.uniform(-0.8, 0.3)),
        "gains.k2": text(10 / size * 10 ** rng.uniform(-0.5, 0.5)),
        "gains.k3": text(30 * 10 ** rng.uniform(-1.2, 1)),
        "gains.k4": text(3 * 10 ** rng.uniform(-2, 1)),
        "bounds": f"{{eigenvalues = [{text(ends[0], 4)}, {text(ends[1], 4)}], "
        f"thrust = [{text(thrust[0])}, {text(thrust[1])}]}}",
        "start.position": f"[0, 0, {-height}]",
    }
    try:
        mission = load("x4-flyer", change)
        return mission, certify(mission)
    except InputError as error:  # rounded out of the bounds, or no thrust above the singularity
        told = ("sees", "at the goal", "singular", "must hold the weight", "must contain")
        assert any(word in str(error) for word in told), error
        return None


def drawn(rng, law):
    while (found := random_mission(rng, law)) is None:
        pass
    return found


SCALED = [law for law in LAWS if law[0] == "scaled"]
INERTIAL = [law for law in LAWS if law[1] == "inertial"]


def confirm_witness(numbers, verdict):
    """Confirm a refutation with equations of this file alone; return its quotient."""
    Q, X = (np.array(values, float) for values in (verdict.Q, verdict.X))
    f, value = float(verdict.f), float(verdict.value)
    assert (Q == Q.T).all()
    assert numbers.within(Q[None])[0] > -1e-12
    low, high = numbers.ends_of_f()
    assert low * (1 - 1e-12) <= f <= high * (1 + 1e-12)
    S = numbers.sigma(f, Q)
    found, size = X @ S @ X, np.abs(X) @ np.abs(S) @ np.abs(X)
    assert found <= value + 1e-12 * size
    assert value < 0
    return X @ S @ X / (X @ X)


def against_brute_force(seed, laws, count, starts=4):
    """Hold verdicts to the worst case found; return their numbers, the largest gap and seconds."""
    rng, counts, largest = np.random.default_rng(seed), Counter(), 0.0
    took = Counter()
    for law, _ in zip(itertools.cycle(laws), range(count), strict=False):
        began = time.process_time()
        mission, verdict = drawn(rng, law)
        took["certify"] += time.process_time() - began
        began = time.process_time()
        counts[verdict.status] += 1
        if not isinstance(verdict, Proved | Refuted):
            continue
        numbers = numbers_of(verdict.certificate.content)
        worst, size = numbers.worst(np.random.default_rng(0), starts)
        rounding = 1e-13 * size
        if isinstance(verdict, Proved):
            bound = float(verdict.margin)
            assert bound <= worst + rounding
            assert float(verdict.decay_rate) <= 2 * numbers.slowest() * (1 + 1e-9)
        else:
            bound = float(verdict.margin_above)
            assert confirm_witness(numbers, verdict) < 0
            assert worst <= bound + rounding
        gap = max(abs(worst - bound) - rounding, 0) / abs(bound)
        if gap > 1e-6:
            print(law, verdict.status, bound, worst, gap, mission)
        largest = max(largest, gap)
        took["brute force"] += time.process_time() - began
    print(dict(counts), "largest gap", largest, {k: f"{v:.1f} s" for k, v in took.items()})
    assert counts["undecided"] == 0
    assert min(counts["proved"], counts["refuted"]) > count / 8 or count < 20
    assert largest < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("laws", [SCALED, INERTIAL], ids=["scaled", "inertial"])
@pytest.mark.parametrize("block", mostly_whole(range(4), every=2))
def test_brute_force_agrees_with_verdicts_on_random_missions(laws, block, whole):
    """Of each kind of law 500 missions in `make trials`, and 12 of them by default."""
    against_brute_force([20261128, block], laws, 125 if whole else 6)


# --- the linearised loop ------------------------------------------------------------------------


@pytest.mark.parametrize("law", LAWS, ids="/".join)
def test_the_model_of_these_tests_moves_as_the_vehicle_does(law):
    """Each motion of the error chain is one of the flying vehicle, linearised at its hover."""
    choices = dict(zip(("law.feature", "law.goal", "law.force"), law, strict=True))
    aside = "{centroid = [0.3, -1.2, 3.1]}" if law[1] == "image" else "{centroid = [0, 0, 3.5]}"
    mission = load("x4-flyer", choices | {"goal": aside})
    loop = LoopNumbers.of(mission)
    (design, points), x = parameters(loop.target_size, loop.law), ca.SX.sym("x", STATE_SIZE)
    jacobian = ca.jacobian(loop_rate(x, design, points, loop.law), x)
    f = ca.Function("f", [x, design.vector(), points], [jacobian])
    vehicle = np.linalg.eigvals(np.array(f(loop.hover, loop.design, loop.points)))
    numbers = numbers_of(
        {
            "mission": mission.exact(),
            "goal_position": None,
            "region": {"eigenvalues": ["1", "2"]},
        }
    )
    B = numbers.loop(numbers.factor(loop.hover_thrust), numbers.at(numbers.goal[None])[0])
    motions = np.linalg.eigvals(B / numbers.m)
    assert np.abs(motions[:, None] - vehicle).min(axis=1).max() < 1e-5
    assert numbers.slowest() == pytest.approx(slowest_rate(mission), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("law", mostly_whole([(law,) for law in LAWS], every=3))
def test_a_certified_rate_is_one_that_the_linearised_loop_has(law, whole):
    rng, proved = np.random.default_rng(20261129), 0
    for _ in range(13 if whole else 7):
        mission, verdict = drawn(rng, law)
        if not isinstance(verdict, Proved):
            continue
        proved += 1
        slowest = numbers_of(verdict.certificate.content).slowest()
        assert slowest == pytest.approx(slowest_rate(mission), rel=1e-6)
        assert float(verdict.decay_rate) <= 2 * slowest * (1 + 1e-9)
    assert proved >= (2 if whole else 1)
