"""Targets as they are: weights, points that coincide or lie in a row, goals above any of them."""

import copy
import json
from fractions import Fraction as F
from pathlib import Path

import cvxpy as cp
import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hoverproof import checker, cli
from hoverproof.certification import scaled
from hoverproof.certification.attraction.at_goal import no_weights
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.exponential.domain import mirrored, swapped
from hoverproof.certification.flow import eigenvalues
from hoverproof.certification.gains import certify
from hoverproof.certification.pattern import Pattern
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.plant.goal import hover_goal, level_view
from hoverproof.simulation.flight import simulate

SQUARE = [[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]]
ROW = [[0, 0.5, 0], [0, 0, 0], [0, -0.5, 0]]
IRREGULAR = [[0, 0, 0], [0.8, 0, -0.05], [1.6, 0.1, 0], [0, -0.7, -0.2], [0.1, -1.5, 0]]
WEIGHED = {"target.weights": "[2, 1, 1, 1]"}
REPEATED = {"target.points": str([SQUARE[0], *SQUARE])}
SCALED = {"law.feature": "scaled", "law.goal": "inertial", "law.force": "measured"}


def flyer(*settings, **more):
    return load("x4-flyer-tuned", {k: v for part in (*settings, more) for k, v in part.items()})


def feature(points, weights, position, feature_is):
    """Return q or s as they are defined; of complex numbers too."""
    rays = points - position
    q = (weights[:, None] * rays / np.sqrt((rays**2).sum(axis=1))[:, None]).sum(axis=0)
    if feature_is == "centroid":
        return q
    n, a = weights.sum(), np.sqrt((q**2).sum())
    return q / a / np.sqrt(2 * (1 - a / n))


def slope(points, weights, position, feature_is):
    """Return Q or J by steps into the complex plane, of no step size to speak of."""
    steps = (position + 1e-30j * e for e in np.eye(3))
    return -np.array([feature(points, weights, x, feature_is).imag / 1e-30 for x in steps]).T


def some_target(rng, count):
    points = rng.uniform(-0.4, 0.4, (count, 3)) * [1, 1, 0.2]
    return points, rng.uniform(0.2, 3, count), rng.uniform([-0.5, -0.5, -2.5], [0.5, 0.5, -1.2])


# --- weights ------------------------------------------------------------------------------------


def test_weights_of_one_are_the_mission_without_them():
    plain, said = flyer(), flyer({"target.weights": "[1, 1.0, 1, 1]"})
    assert said.exact() == plain.exact()
    assert said.target == plain.target


def test_a_weight_of_two_is_a_point_that_is_counted_twice():
    weighed, repeated = flyer(WEIGHED), flyer(REPEATED)
    assert weighed.target.places == repeated.target.places
    assert hover_goal(weighed) == hover_goal(repeated)
    one, other = certify(weighed).proved, certify(repeated).proved
    assert one
    assert one.margin == other.margin
    assert one.problem.goal == other.problem.goal
    for proved in (one, other):
        assert checker.check(proved.certificate.content)
    assert "which count 2, 1, 1, 1 times" in one.certificate.content["statement"]


def test_it_is_so_in_flight():
    ends = [
        simulate(flyer(part, SCALED), duration=1.5)["position"].values[-1]
        for part in (WEIGHED, REPEATED, {})
    ]
    assert np.allclose(ends[0], ends[1], rtol=0, atol=1e-9)
    assert np.abs(ends[0] - ends[2]).max() > 1e-4  # and it matters


@pytest.mark.parametrize("count", [3, 7, 16, 17, 40])
@pytest.mark.parametrize("feature_is", ["centroid", "scaled"])
def test_model_search_and_checker_have_the_slope_that_follows_from_the_definition(
    count, feature_is
):
    rng = np.random.default_rng(count)
    points, weights, place = some_target(rng, count)
    wanted = slope(points, weights, place, feature_is)
    target = Pattern(points, weights)
    exact = checker.Pattern([[F(c) for c in p] for p in points], [F(w) for w in weights])
    if feature_is == "centroid":
        view = level_view(count, tuple(weights.tolist()))(points.T, place)
        q, Q = (np.array(m) for m in view)
        assert np.allclose(np.ravel(q), feature(points, weights, place, feature_is))
        assert np.allclose(Q, wanted)
        assert np.allclose(eigenvalues(target, place[None])[0], np.linalg.eigvalsh(wanted))
        seen = checker.centroid_seen(exact, [F(c) for c in place])
        assert np.allclose([float(a) for a, _ in seen], np.ravel(q))
        return
    assert np.allclose(scaled.slopes_at(target, place[None])[0], wanted)
    at = [checker.Tangent.constant(F(c)) for c in place]
    J = checker.scaled_slope(checker.Target(exact), at)
    assert np.allclose([[x.mid * 2.0**-checker.BITS for x in row] for row in J], wanted)


@pytest.mark.parametrize("count", [4, 30])
def test_enclosures_over_a_cell_hold_what_is_sampled_in_it(count):
    rng = np.random.default_rng(3)
    for _ in range(3):
        points, weights, place = some_target(rng, count)
        pattern = checker.Pattern([[F(c) for c in p] for p in points], [F(w) for w in weights])
        half = 0.04
        box = [[F(c - half), F(c + half)] for c in place]
        grid = checker.Grid(pattern)
        J = checker.slope_over(pattern, grid, grid.cell(box))
        view, unit = checker.View(grid, grid.cell(box)), 2.0**-checker.BITS
        for x in rng.uniform(-1, 1, (20, 3)):
            at = place + half * x
            true = slope(points, weights, at, "scaled")
            for row, values in zip(J, true, strict=True):
                for t, value in zip(row, values, strict=True):
                    line = (t.mid + np.dot(t.slope, x)) * unit
                    assert abs(value - line) <= t.rest * unit + 1e-9 * abs(value)
            low, _, high = np.linalg.eigvalsh(slope(points, weights, at, "centroid"))
            assert not checker.largest_below(view, F(high * 0.999))
            assert not checker.smallest_above(view, F(low * 1.001))
        low, _, high = np.linalg.eigvalsh(slope(points, weights, place, "centroid"))
        assert checker.largest_below(view, F(high * 1.6))
        assert checker.smallest_above(view, F(low * 0.3))


def test_a_target_with_weights_is_alike_on_both_sides_if_they_are():
    even = flyer({"target.weights": "[2, 2, 2, 2]"}).target
    assert all(mirrored(even, axis) for axis in (0, 1))
    assert swapped(even)
    ahead = flyer({"target.weights": "[2, 2, 1, 1]"}).target  # heavier at positive x
    assert not mirrored(ahead, 0)
    assert mirrored(ahead, 1)
    assert not swapped(ahead)


# --- certificates with weights ------------------------------------------------------------------


@pytest.fixture(scope="module")
def proved():
    return certify(flyer(WEIGHED)).proved.certificate.content


@pytest.mark.parametrize(
    "weights",
    [
        ["3", "1", "1", "1"],  # another place to hover at
        ["2", "2", "2", "2"],  # another q*
        ["2", "1", "1"],
        ["2", "1", "1", "1", "1"],
        ["2", "1", "1", "0"],
        ["2", "1", "1", "-1"],
        ["2", "1", "1", "1.0"],
        "2",
        None,
    ],
)
def test_a_certificate_is_about_its_weights(proved, weights):
    forged = copy.deepcopy(proved)
    if weights is None:
        del forged["mission"]["target"]["weights"]
    else:
        forged["mission"]["target"]["weights"] = weights
    assert rejected(forged)


def rejected(forged):
    forged["mission_sha256"] = checker.digest(forged["mission"])
    try:
        forged["statement"] = checker.statement(forged)
        body = {k: v for k, v in forged.items() if k != "sha256"}
        forged["sha256"] = checker.digest(body)
        checker.check(forged)
    except checker.Rejected:
        return True
    return False


def test_the_forger_of_these_tests_can_seal(proved):
    assert not rejected(copy.deepcopy(proved))


# --- goals above any target ---------------------------------------------------------------------


def irregular(**more):
    settings = {"target.points": str(IRREGULAR), "start.position": "[0.6, -0.4, -3.5]", **more}
    return flyer(settings)


def test_the_goal_above_an_irregular_target_is_where_the_centroid_is_straight_below():
    mission = irregular()
    goal = hover_goal(mission)
    mean, target = mission.target.mean, np.array(IRREGULAR)
    assert goal.position[2] == mean[2] - 3
    assert goal.centroid[:2] == ((0, 0), (0, 0))
    assert not goal.is_above_middle_of(mission)
    with mpmath.workdps(60):  # another search, in many digits

        def aside(x, y):
            seen = [mpmath.mpf(0)] * 3
            for point in mission.target.points:
                ray = [
                    mpmath.mpf(c.numerator) / c.denominator - at
                    for c, at in zip(point, (x, y, z), strict=True)
                ]
                r = mpmath.sqrt(sum(c * c for c in ray))
                seen = [s + c / r for s, c in zip(seen, ray, strict=True)]
            return seen

        z = mpmath.mpf(goal.position[2].numerator) / goal.position[2].denominator
        start = tuple(map(float, target.mean(axis=0)[:2]))
        x, y = mpmath.findroot(lambda x, y: aside(x, y)[:2], start)
        q3 = aside(x, y)[2]
        low, high = (mpmath.mpf(e.numerator) / e.denominator for e in goal.centroid[2])
        assert low < q3 < high
        assert high - low < 1e-10
        assert abs(x - float(goal.position[0])) + abs(y - float(goal.position[1])) < 1e-14
        pattern = checker.Pattern([list(p) for p in mission.target.points], [F(1)] * 5)
        (*_, (below, above)), moved = checker.seen_near(pattern, list(goal.position))
        assert mpmath.mpf(below.numerator) / below.denominator < q3
        assert q3 < mpmath.mpf(above.numerator) / above.denominator
        assert 0 < moved < 1e-14
        assert Potential.of(mission).q3 == pytest.approx(float(q3), abs=1e-12)


def test_a_certificate_says_where_that_is_and_nowhere_else():
    content = certify(irregular(**{"bounds.eigenvalues": "[0.01, 5]"})).proved.certificate.content
    assert not rejected(copy.deepcopy(content))
    for k in (0, 1):
        forged = copy.deepcopy(content)
        forged["goal_position"][k] = str(F(forged["goal_position"][k]) + F(1, 1000))
        assert rejected(forged)


def test_regions_are_not_refused_for_a_target_that_is_alike_on_no_side():
    goal = hover_goal(irregular(**SCALED))
    assert goal.centroid[:2] == ((0, 0), (0, 0))  # the scaled centroid has the same direction


def test_a_goal_aside_is_certified_and_has_no_region_for_it_turns_with_the_heading(tmp_path):
    aside = flyer({"goal": "{centroid = [0.3, 0.2, 3.5]}"})
    assert certify(aside).proved
    with pytest.raises(InputError, match="one for each heading"):
        Potential.of(aside)


# --- rows, nests and grids ----------------------------------------------------------------------


@pytest.mark.parametrize("points", [ROW, [*SQUARE, SQUARE[0]], [[0, 0, 0], *SQUARE, [0, 0, 0]]])
def test_points_in_a_row_and_points_that_coincide_are_certified(points):
    wide = {"bounds.eigenvalues": "[0.01, 5]"}
    mission = flyer({"target.points": str(points), "start.position": "[1, 0.5, -4]"}, wide)
    assert certify(mission).status in ("proved", "refuted")
    if len(points) == 5:
        assert certify(mission).proved


def test_a_point_more_in_a_row_of_two_changes_nothing_but_the_count():
    two, three = (
        flyer({"target.points": str(p), "start.position": "[1, 0.5, -4]"})
        for p in ([ROW[0], ROW[2]], ROW)
    )
    assert hover_goal(two).position == hover_goal(three).position
    q = [hover_goal(m).centroid_midpoint[2] for m in (two, three)]
    assert q[1] == q[0] + 1


def test_144_corners_are_a_mission():
    grid = [[F(i, 10), F(j, 10), F(0)] for i in range(12) for j in range(12)]
    text = str([[float(c) for c in p] for p in grid])
    mission = flyer({"target.points": text, "start.position": "[1, 0.5, -4]"})
    goal = hover_goal(mission)
    assert goal.exact
    assert goal.position == (F("0.55"), F("0.55"), F(-3))
    with pytest.raises(InputError, match="at most 1024 points"):
        flyer({"target.points": str([[i / 100, 0, 0] for i in range(1025)])})


@settings(max_examples=3, deadline=None)
@given(st.integers(0, 10**6))
def test_every_random_target_is_answered(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 9))
    points = np.round(rng.uniform(-1, 1, (count, 3)) * [1, 1, rng.choice([0, 0.3])], 2)
    points[-1] = points[0] if rng.random() < 0.3 else points[-1]
    weights = np.round(rng.uniform(0.1, 4, count), 1)
    goal = rng.choice(["height = 3.0", f"centroid = [0, 0, {0.7 * weights.sum():.2f}]"])
    text = Path(__file__).parent.parent / "src/hoverproof/presets/x4-flyer-tuned.toml"
    held = text.read_text(encoding="utf-8").replace("height = 3.0", goal, 1)
    held = held.replace(str(SQUARE), f"{points.tolist()}\nweights = {weights.tolist()}", 1)
    assert "weights" in held
    Path("random.toml").write_text(held, encoding="utf-8")
    for command in (["certify"], ["simulate", "--duration", "0.2", "--no-figures"]):
        with pytest.raises(SystemExit) as exit_:
            cli.main([command[0], "random.toml", *command[1:]])
        assert exit_.value.code in (0, 1, 2, 3), seed


def test_answers_say_where_the_goal_is(capsys):
    Path("odd.toml").write_text(_odd(), encoding="utf-8")
    with pytest.raises(SystemExit):
        cli.main(["certify", "odd.toml"])
    assert "goal                    (0.4" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        cli.main(["certify", "odd.toml", "--json"])
    told = json.loads(capsys.readouterr().out)
    assert told["goal_position"] == [float(c) for c in hover_goal(load("odd.toml")).position]


def test_gains_without_weights_at_the_goal_are_told_and_one_that_has_some(tmp_path):
    """By the project's program, and the linear inequality at the goal itself by another one."""
    vehicle = (
        '{mass = 0.5, inertia = [0.004, 0.004, 0.007], layout = "x", arm = 0.12, '
        "drag_ratio = 0.024, gravity = 9.81}"
    )
    gains = "{k1 = 0.05, k2 = 2, k3 = 0.7, k4 = 8, k_yaw = 0.05}"
    start = {"start.position": "[0.6, -0.4, -2.5]", "bounds.thrust": "[4.4, 5.4]"}
    given = {"target.points": str(IRREGULAR), "goal.height": "2", "vehicle": vehicle, **start}
    mission = load("x4-flyer", {**given, "gains": gains, "bounds.eigenvalues": "[0.2, 3]"})
    reason, advice = no_weights(mission)
    assert "even at the goal, where Q has an eigenvalue of 2.236 1/m" in reason
    assert advice == ("k2 = 4: then there are weights at the goal",)
    assert _margin(mission, 2.2355) < 0 < _margin(mission, 1.5)
    helped = load("x4-flyer", {**given, "gains": gains.replace("k2 = 2", "k2 = 4")})
    assert no_weights(helped) is None and _margin(helped, 2.2355) > 0


def _margin(mission, largest):
    """Return the best least eigenvalue of -Λ' at the goal for y = Q V, 0 ⪯ Q ⪯ largest, by hand."""
    k1, k2, k3, k4 = (float(getattr(mission.gains, f"k{i}")) for i in (1, 2, 3, 4))
    m, weight, q3 = 0.5, 0.5 * 9.81, hover_goal(mission).centroid_midpoint[2]
    c, pace, k12 = k1**2 * k2 / m, (k1 * k2 + k3) / m, k1 * k2 / m
    quick = c * pace / (weight - c * float(q3))

    def form(level):
        e, d2, d3, d4, y = (
            np.eye(5) if level else np.vstack([np.eye(4)[:3], np.zeros(4), np.eye(4)[3]])
        )
        drag = float(q3) * quick * (d4 - d3) if level else 0 * e
        lean = float(q3) * c / weight * (d3 - d2) if level else 0 * e
        speed, pull = k1 / m * (e + lean + d2), y + k12 * (d3 - d2)
        third = pull + pace * (d4 - d3 if level else -d3)
        rates = pull - drag, third, y - pace * d3 - k4 / m * d4

        def product(u, v):
            return (np.outer(u, v) + np.outer(v, u)) / 2

        fall = product(e, speed) - sum(
            a * product(d, r) for a, d, r in zip(weights, (d2, d3, d4), rates, strict=True)
        )
        return fall - sector[level] * (largest * product(y, speed) - product(y, y))

    weights, sector, least = cp.Variable(3), cp.Variable(2), cp.Variable()
    held = [form(1) >> least * np.eye(5), form(0) >> least * np.eye(4), weights >= 0, sector >= 0]
    cp.Problem(cp.Maximize(least), [*held, least <= 1]).solve(solver=cp.CLARABEL)
    return float(least.value)


def _odd():
    text = Path(__file__).parent.parent / "src/hoverproof/presets/x4-flyer-tuned.toml"
    return text.read_text(encoding="utf-8").replace(str(SQUARE), str(IRREGULAR), 1)
