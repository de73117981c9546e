"""Exponential convergence of every vehicle within tolerances, held to other ways."""

from __future__ import annotations

import itertools
from fractions import Fraction as F
from types import SimpleNamespace

import cvxpy as cp
import numpy as np
import pytest

from exponential_truth import MISSION, SMALL, Truth, small
from hoverproof import checker
from hoverproof.certification import scaled
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.inequality import (
    MEMORY,
    SLOPE,
    THRUST,
    TORQUE,
    W2,
    W3,
    W4,
    Ball,
    falls,
)
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.program import SPARE
from hoverproof.certification.exponential.question import Question
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.certification.pattern import Pattern
from hoverproof.mission.reading import load
from laws_kit import feature, seen, slope

TAG = [[F(x, 10), F(y, 10), F(0)] for x, y in itertools.product((-1, 1), repeat=2)]


# --- certificates -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["late", *(pytest.param(n, marks=pytest.mark.slow) for n in list(SMALL)[1:])]
)
def test_what_is_proved_is_accepted_and_true(name):
    content = small(name)
    assert content["kind"] == "exponential"
    assert checker.check(content) == content["statement"]
    Truth(content).holds()


# --- wedges -------------------------------------------------------------------------------------


def wedges(points, sides, feature_is="scaled", goal=("8", "8")):
    """Return the wedges of a target, and their sides in floats."""
    held = [[F(x) for x in side] for side in sides]
    c = SimpleNamespace(
        domain=SimpleNamespace(wedge=held),
        enclosures=SimpleNamespace(goal=[F(x) for x in goal]),
    )
    target = checker.Pattern(points, [F(1)] * len(points))
    return checker.Wedges(c, target, feature_is == "scaled", F(0)), np.array(held, float)


def cells_of(rng, place, many):
    """Return cells of a wedge: parts of it, as whole numbers."""
    found = []
    for _ in range(many):
        size = 2 ** rng.integers(1, 6)
        at = rng.integers(0, size, 3)
        found.append(
            [
                (a + (b - a) * int(k) // int(size), a + (b - a) * int(k + 1) // int(size))
                for (a, b), k in zip(place.whole, at, strict=True)
            ]
        )
    return found


def positions_in(rng, place, cell, many=20):
    x, y, u = (np.array(cell, float)[:, :, None] / place.unit).transpose(0, 1, 2)
    x, y, u = (a + (b - a) * rng.random(many) for a, b in (x, y, u))
    mean = np.array(place.mean, float)
    return mean - np.stack([x, y, np.ones(many)]).T / u[:, None]


def enclosed(x, values, share=1e-9):
    unit = 2.0**-checker.BITS
    return (abs(values - x.mid * unit) <= x.far * unit + share * abs(values).max()).all()


@pytest.mark.parametrize("feature_is", ["scaled", "centroid"])
def test_what_is_seen_from_a_cell_encloses_what_is_seen_from_each_of_its_positions(feature_is):
    rng = np.random.default_rng(5)
    for points in (TAG, [*TAG, [F(1, 20), F(-1, 30), F(1, 50)]]):
        place, _ = wedges(points, [["-1/2", "1/2"], ["-1/3", "1/2"], ["1/2", "3/2"]], feature_is)
        dots = np.array(points, float)
        for cell in cells_of(rng, place, 12):
            sight = place.sight(cell)
            off, at = place.off(sight), positions_in(rng, place, cell)
            if feature_is == "scaled":
                sigma = feature(dots, at) - [0, 0, 8]
                J = slope(dots, at)
                found = sight.slope()
                for row, column in itertools.product(range(3), repeat=2):
                    assert enclosed(found[row][column], J[:, row, column])
            else:
                sigma = np.array([seen(dots, p) for p in at]) - [0, 0, 8]
            for k in range(3):
                assert enclosed(off[k], sigma[:, k])


def test_many_cells_at_once_are_seen_as_each_is_by_the_checker():
    rng, points = np.random.default_rng(6), [*TAG, [F(1, 20), F(-1, 30), F(1, 50)]]
    place, _ = wedges(points, [["-1/2", "1/2"], ["-1/3", "1/2"], ["1/2", "3/2"]])
    cells = cells_of(rng, place, 30)
    many = scaled.Sight.over_wedges(
        Pattern.plain(np.array(points, float)), np.array(cells, float) / place.unit
    )
    J, s, unit = many.slope(), many.scaled(), 2.0**-checker.BITS
    for k, cell in enumerate(cells):
        sight = place.sight(cell)
        exact_s = sight.scaled()
        pairs = [(s[i], exact_s[i]) for i in range(3)]
        exact_J = sight.slope()
        pairs += [(J[i][j], exact_J[i][j]) for i, j in itertools.product(range(3), repeat=2)]
        for ours, theirs in pairs:
            size = abs(theirs.mid * unit) + theirs.far * unit + 1
            assert ours.mid[k] == pytest.approx(theirs.mid * unit, abs=1e-9 * size)
            spread = np.broadcast_to(ours.spread, len(cells))[k]
            assert spread == pytest.approx(theirs.far * unit, rel=1e-3, abs=1e-7 * size)


SIDES = ["0", "1/2"], ["0", "1/2"], ["1/2", "3/2"]
TARGETS = {
    "tag": (TAG, (True, True), True),
    "more on one side": ([*TAG, [F(7, 100), F(0), F(0)]], (False, True), False),
    "on the diagonal": ([*TAG, [F(7, 100), F(7, 100), F(0)]], (False, False), True),
    "longer": ([[2 * x, y, z] for x, y, z in TAG], (True, True), False),
    "a point off the plane": ([*TAG[:3], [*TAG[3][:2], F(1, 50)]], (False, False), None),
    # as sets of places these are alike, but some places have more points than their images
    "seen more often": (
        [[F(x), F(y), F(0)] for x in (1, 1, 1, -1, 2, -2, -2) for y in (-1, 1)],
        (False, True),
        False,
    ),
}


@pytest.mark.parametrize("name", TARGETS)
def test_half_of_a_wedge_is_left_out_only_where_what_is_seen_is_alike(name):
    points, mirrored, swapped = TARGETS[name]
    place, _ = wedges(points, SIDES)
    assert tuple(place.halved(k) for k in (0, 1)) == mirrored
    assert swapped is None or place.swapped == swapped
    rng, dots = np.random.default_rng(7), np.array(points, float)
    mean = dots.mean(axis=0)
    away = rng.uniform([-2, -2, 3], [2, 2, 6], size=(50, 3))
    images = [away * flip for k, flip in enumerate(([-1, 1, 1], [1, -1, 1])) if place.halved(k)]
    images += [away[:, [1, 0, 2]]] if place.swapped else []
    for image in images:
        sizes = [np.linalg.norm(feature(dots, mean - x), axis=1) for x in (away, image)]
        assert sizes[0] == pytest.approx(sizes[1], rel=1e-9)
        norms = [
            np.linalg.norm(slope(dots, mean - x) - 5 * np.eye(3), 2, axis=(1, 2))
            for x in (away, image)
        ]
        assert norms[0] == pytest.approx(norms[1], rel=1e-6)


def test_a_wedge_that_ends_in_the_middle_of_an_uneven_target_has_a_face_there():
    even, _ = wedges(TAG, SIDES)
    uneven, _ = wedges(TARGETS["more on one side"][0], SIDES)
    assert (0, 0) not in even.faces()
    assert (0, 0) in uneven.faces()
    cell = [(a, (a + b) // 2) for a, b in uneven.whole]
    cell[2] = tuple((k * a + (4 - k) * b) // 4 for k in (3, 2) for a, b in [even.whole[2]])
    assert uneven.at_face(cell)
    assert not even.at_face(cell)


# --- the program --------------------------------------------------------------------------------


def by_another_solver(limits, candidate, starts):
    """Return the least Ψ/ℓ of the starts, by SCS, from the inequality and not its pencils."""
    low, high = candidate.ball
    made = falls(limits, Ball((low + high) / 2, (high - low) / 2), candidate.rate)
    there, corners = made.of_used()
    s = candidate.solution
    near = {W2: s.weights[0], W3: s.weights[1], W4: s.weights[2], SLOPE: s.slope}
    near |= {MEMORY: s.memory} if s.memory is not None else {}
    near |= {TORQUE: s.lag[0], THRUST: s.lag[1]} if s.lag is not None else {}
    scale = np.array([near[k] for k in there[1:]])
    x, t, fill = cp.Variable(len(scale)), cp.Variable(len(s.multipliers)), cp.Variable()
    value = cp.hstack([1, cp.multiply(scale, x)])
    size = np.sqrt(np.abs(np.diag(np.tensordot(np.r_[1, scale], corners[0].S, 1))) + 1e-6)
    limits_ = [x >= 0, t >= 0]
    for corner in corners:
        n = corner.S.shape[1]
        S = corner.S.copy()
        S[0] -= SPARE * np.eye(n) / max(1.0, high)
        form = sum(value[k] * (S[k] / np.outer(size, size)) for k in range(len(S)))
        below, of = [], []
        for k, (u, v, radius) in enumerate(corner.terms):
            v, half = v / size, float(radius) / 2
            form -= half * s.multipliers[k] * t[k] * (v.T @ v)
            rows = sum(value[j] * (u[j] / size) for j in range(len(u)))
            below.append(np.sqrt(half / s.multipliers[k]) * rows)
            of += [k] * u.shape[1]
        if below:
            rows = cp.vstack(below)
            form = cp.bmat([[form, rows.T], [rows, cp.diag(t[of])]])
        limits_.append((form + form.T) / 2 >> 0)
    r, two = limits.reach, 2 * s.level
    w = {k: value[there.index(k)] for k in (W2, W3, W4)}
    most = ((r.force, (W2, W3)), (r.d3, (W3,)), (r.turn, (W3, W4)))
    limits_ += [sum(cp.inv_pos(w[k]) for k in of) <= far**2 / two for far, of in most]
    limits_ += [cp.inv_pos(w[W2]) <= r.speed**2 / two - 1]
    limits_ += [start[there] @ value <= fill * s.level for start in starts]
    problem = cp.Problem(cp.Minimize(fill), limits_)
    problem.solve(solver=cp.SCS, eps=1e-5, max_iters=100_000)
    return float(fill.value)


def asked(number):
    """Return a mission: tolerances at random, a start some way off."""
    rng = np.random.default_rng(number)
    law = {"law.goal": '"image"'} if number % 4 == 3 else {}
    most = {"thrust": 0.2, "torque": 0.2, "latency": 0.07, "rotor_lag": 0.03, "wind": 0.2}
    changes = {f"uncertainty.{key}": f"{x * rng.random():.3f}" for key, x in most.items()}
    if number % 2:
        changes["uncertainty.rotor_lag"] = "0"
    x, z = rng.uniform(0, 0.3), rng.uniform(1.1, 1.5)
    return load(MISSION, law | changes | {"start.position": f"[{x:.3f}, 0, -{z:.3f}]"})


@pytest.mark.slow
@pytest.mark.parametrize("number", range(20))
def test_the_program_finds_what_another_solver_finds(number, whole):
    if number >= 1 and not whole:
        pytest.skip("with --whole")
    mission = asked(number)
    question = Question.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),))
    starts, (low, high) = question.terms(), np.log(question.ends)
    x = np.array([low + 0.6 * (high - low), -1.7])
    found = question.at(x, question.slow(float(np.exp(low))), starts)
    assert found is not None
    fill = by_another_solver(question.limits(x, found.ball), found, starts)
    assert found.solution.fill == pytest.approx(fill, rel=0.01)
