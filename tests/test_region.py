"""Eigenvalue bounds of a real target over a box, and certificates that rest on them."""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from command_line import run
from hoverproof import checker
from hoverproof.certification.cells import View, grow_tree, largest_below, smallest_above
from hoverproof.certification.flow import eigenvalues
from hoverproof.certification.gains import certify, search_weights
from hoverproof.certification.over_box import certify_region, enclose
from hoverproof.certification.pattern import Pattern
from hoverproof.certification.region import (
    default_box,
    halved,
    outside,
    parse_box,
)
from hoverproof.certification.verdict import Proved
from hoverproof.errors import InputError
from hoverproof.mission.reading import load

F = Fraction
SMALL = ((F(4), F(5)), (F(2), F(5, 2)), (F(-4), F(-3)))


@pytest.fixture(scope="module")
def mission():
    return load("x4-flyer")


@pytest.fixture(scope="module")
def region(mission):
    return enclose(mission, default_box(mission))


def points(mission):
    return np.array(mission.target.points, float)


def sampled(mission, box, count, seed=0):
    low, high = np.array(box, float).T
    places = low + (high - low) * np.random.default_rng(seed).random((count, 3))
    return eigenvalues(Pattern.of(mission), places)


def test_the_eigenvalues_are_those_of_the_matrix_summed_by_hand(mission):
    place = np.array([5, 2.5, -4.0])
    Q = np.zeros((3, 3))
    for point in points(mission):
        r = np.linalg.norm(point - place)
        p = (point - place) / r
        Q += (np.eye(3) - np.outer(p, p)) / r
    assert np.allclose(eigenvalues(Pattern.of(mission), place[None])[0], np.linalg.eigvalsh(Q))


@pytest.mark.slow
def test_the_enclosure_holds_a_million_sampled_eigenvalues(mission, region):
    low, high = map(float, region.eigenvalues)
    for seed in range(10):
        values = sampled(mission, region.box, 100_000, seed)
        assert low < values.min()
        assert values.max() < high


UNFLYABLE = {"bounds.thrust": "[0.1, 200]"}  # down to where the law is singular


@pytest.mark.parametrize(
    ("eigenvalues", "status"),
    [("[0.01, 5]", "proved"), ("[0.2, 0.5]", "refuted"), ('"auto"', "proved")],
)
def test_bounds_of_Q_are_decided_whatever_the_thrust(eigenvalues, status):
    """Q depends on target and place alone; only a question about gains is refused."""
    mission = load("x4-flyer", {**UNFLYABLE, "bounds.eigenvalues": eigenvalues})
    verdict = certify_region(mission, default_box(mission))
    assert verdict.status == status
    theorem = checker.check(verdict.certificate.content)
    assert "eigenvalue" in theorem
    assert "thrust" not in theorem
    with pytest.raises(InputError, match=r"bounds\.thrust: lets the thrust sink to 0\.1 N"):
        certify(load("x4-flyer", UNFLYABLE))


def test_a_claim_about_gains_still_needs_a_thrust_that_the_law_can_have(mission):
    content = copy.deepcopy(certify(mission).certificate.content)
    content["mission"]["bounds"]["thrust"] = ["1/10", "200"]
    content["mission_sha256"] = checker.digest(content["mission"])
    content["sha256"] = checker.digest({k: v for k, v in content.items() if k != "sha256"})
    with pytest.raises(checker.Rejected, match="the thrust interval reaches the singularity"):
        checker.check(content)


def test_the_enclosure_is_tight(region):
    low, high = map(float, region.eigenvalues)
    assert low < region.attained[0] <= 1.1 * low
    assert 0.9 * high <= region.attained[1] < high


def test_the_mission_s_bounds_hold_around_start_and_goal(mission, region):
    assert halved(mission, region.box, mission.bounds.eigenvalues)
    assert not list(outside(mission, region.box, mission.bounds.eigenvalues))


def test_bounds_that_are_broken_are_not_proved_but_refuted(mission):
    wide = ((F(-1), F(6)), (F(-1), F(4)), (F(-5), F(-2)))
    assert not halved(mission, wide, mission.bounds.eigenvalues, most=50)
    spot, *_ = outside(mission, wide, mission.bounds.eigenvalues)
    assert spot.bound == "lower"
    assert spot.value < 0.01
    exact = eigenvalues(Pattern.of(mission), np.array([[float(c) for c in spot.position]]))[0]
    assert exact[0] == pytest.approx(spot.value)


@pytest.mark.parametrize("side", [0, 1])
def test_no_bound_inside_the_attained_values_is_ever_shown(mission, side):
    values = sampled(mission, SMALL, 2000)
    low, high = F(values.min()), F(values.max())
    bounds = (low * F(101, 100), high * 2) if side == 0 else (low / 2, high * F(99, 100))
    assert not halved(mission, SMALL, bounds, most=60)


def test_certifying_over_a_box_uses_what_is_proved_there(mission, region):
    verdict = certify(mission, region=region)
    assert isinstance(verdict, Proved)
    assert verdict.problem.eigenvalues == region.eigenvalues
    theorem = checker.check(verdict.certificate.content)
    assert "every position in the box" in theorem
    forged = copy.deepcopy(verdict.certificate.content)
    forged["region"]["box"][0][1] = "9"
    forged["statement"] = checker.statement(forged)
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    with pytest.raises(checker.Rejected, match="over a cell of the box"):
        checker.check(forged)


def test_a_refutation_over_a_box_is_confirmed_with_the_box(mission, region):
    weak = load("x4-flyer", {"gains.k4": "0.01"})
    verdict = certify(weak, region=region)
    assert verdict.status == "refuted"
    assert "It is not true" in checker.check(verdict.certificate.content)
    forged = copy.deepcopy(verdict.certificate.content)
    forged["region"]["box"][0][1] = "9"
    forged["statement"] = checker.statement(forged)
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    with pytest.raises(checker.Rejected, match="over a cell of the box"):
        checker.check(forged)


def test_searched_weights_certify_a_faster_decay(mission):
    plain, best = certify(mission), search_weights(mission)
    verdict = certify(mission, weights=best)
    assert isinstance(verdict, Proved)
    assert verdict.decay_rate > plain.decay_rate * F(11, 10)
    assert verdict.margin_above < verdict.margin * (1 + F(1, 10**6))
    checker.check(verdict.certificate.content)
    rng = np.random.default_rng(0)
    for _ in range(10):
        factors = np.exp(rng.normal(size=4) * 0.1)
        other = tuple(
            F(float(w) * f).limit_denominator(1000) for w, f in zip(best, factors, strict=True)
        )
        nearby = certify(mission, weights=other)
        if isinstance(nearby, Proved):
            assert nearby.decay_rate < verdict.decay_rate * F(1001, 1000)


@pytest.mark.parametrize(
    "text", ["1,2,3", "a,b,c,d,e,f", "1,0,0,1,0,1", "0,1,0,1,0,1e9", "1/0,1,0,1,0,1"]
)
def test_a_box_that_is_none_is_refused(text):
    with pytest.raises(InputError, match="box"):
        parse_box(text)


def test_a_box_with_a_target_point_in_it_is_refused(mission):
    with pytest.raises(InputError, match="holds a target point"):
        enclose(mission, ((F(-2), F(2)), (F(-2), F(2)), (F(-3), F(1))))


def test_the_command_proves_draws_and_certifies(capsys):
    status, out, _ = run(capsys, "region", "x4-flyer", "--box=4,5,2,2.5,-4,-3", "--json")
    answer = json.loads(out)
    assert status == 0
    assert answer["verdict"] == "proved"
    assert Path(answer["figure"]).read_bytes().startswith(b"\x89PNG")
    assert "every position in the box" in checker.check_file(answer["certificate"])
    status, out, _ = run(
        capsys, "region", "x4-flyer", "--box=5,6,3,4,-5,-4", "--json", "--no-figure"
    )
    answer = json.loads(out)
    assert status == 1
    assert answer["witness"]["eigenvalue"] < 0.01


@pytest.mark.parametrize("weights", ["1,2,3", "1,1,1,0", "best", "1,1,1,-1"])
def test_weights_that_are_none_are_refused(weights, capsys):
    status, _, err = run(capsys, "certify", "x4-flyer", f"--weights={weights}")
    assert status == 2
    assert err.count("\n") == 1


def test_a_broken_bound_is_refuted_by_a_certificate_of_its_own(mission, capsys):
    wide = "--box=-1,6,-1,4,-5,-2"
    status, out, _ = run(capsys, "region", "x4-flyer", wide, "--json", "--no-figure")
    answer = json.loads(out)
    assert status == 1
    assert answer["witness"]["bound"] == "lower"
    assert "It is not true" in checker.check_file(answer["certificate"])
    content = json.loads(Path(answer["certificate"]).read_text())
    spot = content["outside"]
    for key, value, reason in (
        ("position", ["7", "0", "-3"], "not in the box"),
        ("position", ["0", "0", "-3"], "not shown to be out of bounds"),
        ("direction", ["0", "0", "0"], "not shown to be out of bounds"),
        ("bound", "upper", "not shown to be out of bounds"),
        ("bound", "middle", "neither lower nor upper"),
    ):
        forged = copy.deepcopy(content)
        forged["outside"] = spot | {key: value}
        with pytest.raises(checker.Rejected, match=reason):
            forged["statement"] = checker.statement(forged)
            forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
            checker.check(forged)


def test_a_limit_of_boxes_that_is_hit_leaves_the_question_undecided(capsys):
    for command in ("region", "certify"):
        status, out, _ = run(
            capsys, command, "x4-flyer", "--box=-5,5,-3,3,-6,-0.5", "--boxes=2", "--json"
        )
        answer = json.loads(out)
        assert status == 3
        assert answer["verdict"] == "undecided"
        assert answer["certificate"] is None


def test_a_box_beside_a_target_point_is_enclosed(mission):
    near = ((F(9, 10), F(11, 10)), (F(9, 10), F(11, 10)), (F(-1, 2), F(-1, 20)))
    region = enclose(mission, near)
    values = sampled(mission, near, 20_000)
    assert region.eigenvalues[0] < values.min()
    assert values.max() < region.eigenvalues[1] < 2 * values.max()


@pytest.mark.slow
@settings(deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 5), st.floats(0.01, 2))
def test_no_box_is_shown_to_hold_what_a_sample_in_it_breaks(seed, n, size):
    rng = np.random.default_rng(seed)
    target = [[F(int(c), 100) for c in p] for p in rng.integers(-200, 200, (n, 3))]
    center = rng.uniform(-3, 3, 3)
    box = [[F(float(c - size)), F(float(c + size))] for c in center]
    ends = np.array([[float(a), float(b)] for a, b in box])
    places = ends[:, 0] + (ends[:, 1] - ends[:, 0]) * rng.random((400, 3))
    values = eigenvalues(Pattern.plain(np.array(target, float)), places)
    for low, high in ((1.01, 1e6), (0.99, 0.99 * values.max()), (0.99, 1.01 * values.max())):
        bounds = F(low * values.min()), F(high)
        if shown_exactly(target, box, *bounds):
            assert low < 1 < high / values.max()


def shown_exactly(target, box, low, high):
    """Halve a box as a certificate would, and ask the checker of each cell."""
    at = Pattern.plain(np.array(target, float))

    def hold(cells):
        view = View.of(at, cells)
        return largest_below(view, float(high)) & smallest_above(view, float(low))

    tree = grow_tree(np.array(box, float), hold, 300)
    pattern = checker.Pattern(target, [F(1)] * len(target))
    grid, holds = checker.Grid(pattern), checker.Eigenvalues.hold
    bounds = SimpleNamespace(target=pattern, low=low, high=high, scaled=False)
    try:
        checker.cover(
            tree or "0",
            grid.cell(box),
            lambda cell: holds(bounds, grid, cell),
            "not shown",
        )
    except checker.Rejected:
        return False
    return True


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.text("0123", min_size=1, max_size=12))
def test_a_tree_is_a_cover_or_is_refused(seed, letters):
    """What a tree leaves uncovered, or halves again and again, is never passed over."""
    rng = np.random.default_rng(seed)
    box = [(0, int(n)) for n in rng.integers(1, 10**6, 3)]
    held = []
    try:
        checker.cover(letters, box, lambda cell: held.append(cell) or True, "it is not shown")
    except checker.Rejected:
        return
    place = [int(rng.integers(0, side[1] + 1)) for side in box]
    assert any(all(a <= x <= b for x, (a, b) in zip(place, cell, strict=True)) for cell in held)
    assert sum(np.prod([b - a for a, b in cell]) for cell in held) == np.prod([b for _, b in box])


@pytest.mark.parametrize(("tree", "word"), [("00", "longer"), ("10", "shorter"), ("1", "shorter")])
def test_a_tree_too_long_or_too_short_is_refused(tree, word):
    with pytest.raises(checker.Rejected, match=word):
        checker.cover(tree, [(0, 8), (0, 8), (0, 8)], lambda cell: True, "")


def test_the_cells_of_a_search_are_those_of_the_checker(mission):
    """Both halve alike, so what holds over a cell here is asked over the same cell there."""
    box, mine, theirs = np.array([[0.0, 1.0], [-2.0, 1.5], [0.25, 0.5]]), [], []

    def hold(cells):
        large = np.ptp(cells, axis=2).max(axis=1) > 0.3
        mine.extend(cells[~large].tolist())
        return ~large | (np.ptp(cells, axis=2).max(axis=1) == 0)

    tree = grow_tree(box, hold, 1000)
    cells = [(round(a * 2**40), round(b * 2**40)) for a, b in box]
    checker.cover(tree, cells, lambda cell: theirs.append(cell) or True, "")
    asked = [[[a / 2**40, b / 2**40] for a, b in cell] for cell in theirs]
    assert len(asked) == tree.count("0") > 1
    assert all(cell in mine for cell in asked)


def test_a_box_is_halved_where_halves_hold_and_not_where_it_is_longest():
    """What holds over thin cells alone takes two of them, not four."""

    def thin(cells):
        return np.ptp(cells[:, 1], axis=1) <= 0.5

    assert grow_tree(np.array([[0.0, 4.0], [0.0, 1.0]]), thin, 10) == "200"


def test_a_box_of_too_many_decimals_is_refused():
    with pytest.raises(InputError, match="at most 18 decimals"):
        parse_box("0,1,0,1,-4,-3.0000000000000000001")
