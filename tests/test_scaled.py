"""The slope J of the scaled centroid over cells, against a derivative that shares nothing with it.

See `laws_kit`: s is written anew, and differentiated by a complex step.
"""

from __future__ import annotations

import itertools
from fractions import Fraction as F
from types import SimpleNamespace
from unittest.mock import patch

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hoverproof import checker
from hoverproof.certification import scaled
from hoverproof.certification.over_box import certify_region, enclose
from hoverproof.certification.pattern import Pattern
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from laws_kit import feature, slope

CORNERS = np.array(list(itertools.product((-1, 1), repeat=3)), float)
BEYOND = 1e-9  # share of |J| by which floating point may differ

# --- the same, written anew ---------------------------------------------------------------------


def in_digits(x):
    return mpmath.mpf(x.numerator) / x.denominator


def exact_slope(points, position):
    """Return J at a rational position to more than a hundred digits, rows of mpf."""
    h, points = mpmath.mpf(10) ** -70, [[in_digits(x) for x in point] for point in points]

    def at(place):
        rays = [[x - c for x, c in zip(point, place, strict=True)] for point in points]
        p = [[x / mpmath.sqrt(sum(c * c for c in ray)) for x in ray] for ray in rays]
        q, n = [sum(column) for column in zip(*p, strict=True)], len(points)
        a2 = sum(c * c for c in q)
        a = mpmath.sqrt(a2)
        return [c / a * mpmath.sqrt(n * (n + a) / (2 * (n * n - a2))) for c in q]

    columns = []
    for k in range(3):
        place = [in_digits(x) for x in position]
        place[k] = mpmath.mpc(place[k], h)
        columns.append([-mpmath.im(c) / h for c in at(place)])
    return [list(row) for row in zip(*columns, strict=True)]


def target(rng, size):
    """Return 2 to 12 points without symmetry, in any plane or none, with short coordinates."""
    n = int(rng.integers(2, 13))
    tilt = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    flat = rng.choice([0, 0.05, 1])
    points = size / 2 * rng.uniform(-1, 1, size=(n, 3)) * [1, rng.uniform(0.3, 1), flat] @ tilt
    points += size * rng.normal(size=3) * rng.choice([0, 3])
    return [[F(round(x * 10**6), 10**6) for x in point] for point in points.tolist()]


def cell_before(rng, points, size):
    """Return a cell whose middle is 0.6 to 12 sizes from the target, its sides up to a third."""
    way = rng.normal(size=3)
    away = size * 10 ** rng.uniform(-0.2, 1.1)
    middle = np.array(points, float).mean(axis=0) + way / np.linalg.norm(way) * away
    half = away * 10 ** rng.uniform(-4, -0.8) * rng.choice([0, 0.1, 1], size=3)
    ends = np.stack([middle - half, middle + half], axis=1).tolist()
    return [[F(x).limit_denominator(10**7) for x in side] for side in ends]


def in_floats(J):
    """Return mid (3, 3), slope (3, 3, 3) by axis first, and rest (3, 3), 1/m."""
    unit = 2.0**-checker.BITS
    mid = np.array([[x.mid * unit for x in row] for row in J])
    rest = np.array([[x.rest * unit for x in row] for row in J])
    return mid, np.array([[[x.slope[k] * unit for x in row] for row in J] for k in range(3)]), rest


def enclosed(points, box):
    target = counted(points)
    grid = checker.Grid(target)
    return checker.slope_over(target, grid, grid.cell(box))


def counted(points):
    """Count each point once, for the checker."""
    return checker.Pattern(points, [F(1)] * len(points))


def excess(points, box, J, x):
    """Return by how much J at places x, (k, 3) in [-1, 1]³, is out of what encloses it, 1/m."""
    mid, steep, rest = J
    middle, half = np.mean(box, axis=1), np.ptp(box, axis=1) / 2
    off = slope(points, middle + half * x) - mid - np.einsum("ka,aij->kij", x, steep)
    return np.abs(off) - rest


def worst_found(rng, points, box, J):
    """Search each entry for the place in a cell where it is the farthest out."""
    x = np.r_[CORNERS, rng.uniform(-1, 1, size=(60, 3))]
    worst = excess(points, box, J, x)
    best = worst.max(axis=0)
    place = x[worst.argmax(axis=0)]  # (3, 3, 3), a place for each entry
    reach = 0.5
    for _ in range(12):
        tries = np.clip(place[None] + reach * rng.normal(size=(6, 3, 3, 3)), -1, 1)
        found = excess(points, box, J, tries.reshape(-1, 3)).reshape(6, 3, 3, 3, 3)
        own = found[:, range(3), :, range(3), :][:, :, range(3), range(3)]  # (3, 6, 3)
        own = own.transpose(1, 0, 2)
        at = own.argmax(axis=0)
        better = np.take_along_axis(own, at[None], axis=0)[0]
        new = np.take_along_axis(tries, at[None, ..., None], axis=0)[0]
        place = np.where((better > best)[..., None], new, place)
        best = np.maximum(best, better)
        reach *= 0.7
    return best


# --- enclosures ---------------------------------------------------------------------------------


def test_the_complex_step_agrees_with_differences_and_with_many_digits():
    rng = np.random.default_rng(0)
    for _ in range(10):
        exact = target(rng, 1.0)
        points, place = np.array(exact, float), np.array([[0.25, 1.5, -6.0]])
        J = slope(points, place)[0]
        ends = [feature(points, place - e) - feature(points, place + e) for e in 1e-5 * np.eye(3)]
        differences = np.array([side[0] / 2e-5 for side in ends]).T
        assert differences == pytest.approx(J, rel=1e-6, abs=1e-6)
        with mpmath.workdps(160):
            digits = exact_slope(exact, [F(1, 4), F(3, 2), F(-6)])
        assert np.array(digits, float) == pytest.approx(J, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("unit", [F(1, 1000), F(1), F(1000)], ids=["1e-3 m", "1 m", "1e3 m"])
def test_j_is_within_its_enclosure_all_over_a_cell(unit):
    rng = np.random.default_rng([7, unit.numerator])
    shown = missed = 0
    while shown < 25:
        size = 10 ** rng.uniform(np.log10(0.08), np.log10(2))
        exact = [[unit * x for x in point] for point in target(rng, size)]
        box = cell_before(rng, exact, size * float(unit))
        J = enclosed(exact, box)
        if J is None:
            missed += 1
            continue
        shown += 1
        points, ends = np.array(exact, float), np.array(box, float)
        J = in_floats(J)
        far = worst_found(rng, points, ends, J)
        assert far.max() <= BEYOND * np.abs(J[0]).max()
    assert missed < shown


def test_the_search_for_a_place_outside_finds_one():
    """With rests an eighth smaller than is true in the corner, it is seen that J is not within."""
    rng = np.random.default_rng(3)
    points = np.array([[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, -0.1, 0], [-0.1, 0.1, 0]])
    box = np.array([[0, 0.3], [-0.2, 0.2], [-1.4, -1.1]])
    mid, steep, rest = in_floats(enclosed([[F(x) for x in p] for p in points.tolist()], box))
    rest = np.maximum(excess(points, box, (mid, steep, 0 * rest), CORNERS).max(axis=0), 0)
    assert (worst_found(rng, points, box, (mid, steep, rest * 7 / 8)) > 0).any()


def test_j_at_a_single_place_is_enclosed_to_fifty_digits():
    """Where a cell is a point, rounding alone is in the rests: here it is all that is tried."""
    rng = np.random.default_rng(11)
    for _ in range(25):
        size = 10 ** rng.uniform(-4, 3)
        points = [[x * F(size) for x in point] for point in target(rng, 1.0)]
        place = [side[0] for side in cell_before(rng, points, size)]
        with mpmath.workdps(160), with_bits(192):
            J = checker.scaled_slope(
                checker.Target(counted(points)), [checker.Tangent.constant(x) for x in place]
            )
            unit = mpmath.mpf(2) ** -checker.BITS
            for row, wanted in zip(J, exact_slope(points, place), strict=True):
                for x, value in zip(row, wanted, strict=True):
                    assert abs(value - x.mid * unit) <= x.spread() * unit
                    assert x.spread() * unit * size < mpmath.mpf(10) ** -30


def test_a_grid_cell_that_is_a_point_is_enclosed_too():
    points = [[F(x) for x in p] for p in ((1, 1, 0), (1, -1, 0), (-1, -1, F(1, 3)), (-1, 1, 0))]
    place = [F(1, 7), F(2, 5), F(-3)]
    J = in_floats(enclosed(points, [[x, x] for x in place]))
    assert J[2].max() < 1e-9  # the grid is finer than that
    far = excess(np.array(points, float), np.array([[x, x] for x in place], float), J, CORNERS)
    assert far.max() < 1e-12


def test_the_search_sees_what_the_checker_sees():
    rng = np.random.default_rng(5)
    for _ in range(12):
        exact = target(rng, 0.5)
        box = cell_before(rng, exact, 0.5)
        J = enclosed(exact, box)
        with np.errstate(all="ignore"):
            ours = scaled.slopes(Pattern.plain(np.array(exact, float)), np.array([box], float))
        if J is None:
            assert not all(np.isfinite(x.rest).all() for row in ours for x in row)
            continue
        for theirs, row in zip(J, ours, strict=True):
            for x, y in zip(theirs, row, strict=True):
                unit = 2.0**-checker.BITS
                values = [v * unit for v in (x.mid, *x.slope, x.rest)]
                seen = [*np.ravel(y.mid), *np.ravel(y.slope), *np.ravel(y.rest)]
                assert seen == pytest.approx(values, rel=1e-6, abs=1e-8)


# --- cells that hold a target point -------------------------------------------------------------

SQUARE = [[F(x), F(y), F(0)] for x, y in ((1, 1), (1, -1), (-1, -1), (-1, 1))]


@pytest.mark.parametrize(
    "box",
    [
        [[0, 2], [0, 2], [-1, 1]],  # inside
        [[0, 1], [0, 1], [-1, 0]],  # in a corner
        [[1, 2], [0, 2], [-1, 1]],  # on a side
        [[1, 1], [1, 1], [0, 0]],  # is it
        [[-2, 2], [-2, 2], [-1, 0]],  # all of them
        [[-2, 2], [1, 1], [0, 0]],  # two, on an edge
        [[0, 0], [0, 0], [0, 0]],  # the middle of the target, where q is zero
    ],
)
def test_a_cell_that_holds_a_target_point_or_touches_it_is_refused(box):
    exact = [[F(x) for x in side] for side in box]
    J = enclosed(SQUARE, exact)
    assert J is None
    assert not checker.within_ball(J, F(1, 10**9), F(10**9))
    cells = np.array([box], float)
    told = scaled.within_ball(Pattern.plain(np.array(SQUARE, float)), cells, 1e-9, 1e9)
    assert not told.any() or (cells[..., 0] == cells[..., 1]).all()  # no search comes to a point


@given(st.integers(0, 3), st.lists(st.tuples(st.integers(0, 40), st.integers(0, 40)), min_size=3))
def test_no_cell_around_a_target_point_is_ever_enclosed(k, sides):
    box = [[c - F(a, 100), c + F(b, 100)] for c, (a, b) in zip(SQUARE[k], sides, strict=False)]
    assert enclosed(SQUARE, box) is None


def test_a_box_that_holds_a_target_point_is_refused_in_words():
    box = ((F(0), F(2)), (F(0), F(2)), (F(-3), F(0)))
    with pytest.raises(InputError, match="holds a target point"):
        certify_region(load("x4-flyer", SCALED), box)


# --- the ball -----------------------------------------------------------------------------------

SCALED = {"law.feature": "scaled", "bounds.eigenvalues": '"auto"'}


def test_what_is_within_a_ball_over_a_cell_is_so_at_every_place_found():
    rng, told = np.random.default_rng(23), 0
    while told < 30:
        exact = target(rng, 0.4)
        box = cell_before(rng, exact, 0.4)
        points, ends = np.array(exact, float), np.array(box, float)
        middle, half = ends.mean(axis=1), np.ptp(ends, axis=1) / 2
        x = np.r_[CORNERS, rng.uniform(-1, 1, size=(200, 3))]
        J = slope(points, middle + half * x)
        j = float(np.trace(J[0]) / 3)
        most = float(np.linalg.norm(J - j * np.eye(3), 2, axis=(1, 2)).max())
        found = enclosed(exact, box)
        if found is None:
            continue
        told += 1
        below = F(most * (1 - 1e-6))
        assert not checker.within_ball(found, F(j) - below, F(j) + below)
        loss = float(np.linalg.norm(in_floats(found)[2]) * 2)
        above = F(most * (1 + 1e-6) + loss)
        assert checker.within_ball(found, F(j) - above, F(j) + above)


def test_bounds_over_a_box_hold_at_every_place_found_and_are_not_far_wider():
    mission = load("x4-flyer", SCALED)
    box = ((F(-1, 5), F(1, 5)), (F(0), F(2, 5)), (F(-16, 5), F(-3)))
    shown = enclose(mission, box)
    low, high = map(float, shown.eigenvalues)
    x = np.random.default_rng(1).uniform(*np.array(box, float).T, size=(20_000, 3))
    J = slope(np.array(mission.target.points, float), x) - (low + high) / 2 * np.eye(3)
    most = np.linalg.norm(J, 2, axis=(1, 2)).max()
    assert most < (high - low) / 2 < 1.5 * most


# --- each operation, with few digits, where rounding is all that matters ------------------------


@st.composite
def tangents(draw, most=1 << 14, *, positive=False):
    """Draw a tangent; with `positive` one whose inverse and root are defined."""
    mid = draw(st.integers(1 if positive else -most, most))
    slope_ = [draw(st.integers(-most, most)) for _ in range(3)]
    rest = draw(st.integers(0, most))
    if positive:
        spread = sum(map(abs, slope_)) + rest + 1
        share = F(mid - 1, spread) * draw(st.sampled_from([F(1), F(1), F(1, 2), F(1, 100)]))
        slope_, rest = [int(x * share) for x in slope_], int(rest * share)
    return checker.Tangent(mid, tuple(slope_), rest)


share = st.one_of(st.sampled_from([F(-1), F(1)]), st.fractions(-1, 1, max_denominator=8))
place = st.tuples(share, share, share)
bits = st.integers(2, 20)


def line(tangent, x):
    return tangent.mid + sum(a * b for a, b in zip(tangent.slope, x, strict=True))


def holds(tangent, x, value):
    """Tell whether a value, in the unit of the tangent, is within its rest."""
    return abs(value - line(tangent, x)) <= tangent.rest


def with_bits(count):
    one = 1 << count
    whole = checker.Tangent(one, (0, 0, 0), 0)
    return patch.multiple(checker, BITS=count, ONE_OF_THEM=one, ONE_TANGENT=whole)


@given(bits, tangents(), tangents(), place, share, share)
def test_sums_and_products_hold_the_exact_ones(count, a, b, x, e, f):
    u, v = line(a, x) + e * a.rest, line(b, x) + f * b.rest
    with with_bits(count):
        assert holds(a + b, x, u + v)
        assert holds(a - b, x, u - v)
        assert holds(a * b, x, u * v / 2**count)


@given(bits, tangents(), place, share, st.integers(-30, 30), st.integers(1, 30))
def test_times_holds_the_exact_one(count, a, x, e, n, d):
    with with_bits(count):
        assert holds(a.times(n, d), x, (line(a, x) + e * a.rest) * n / d)


@given(bits, tangents(positive=True), place, share)
def test_an_inverse_holds_the_exact_one(count, a, x, e):
    with with_bits(count):
        assert holds(a.inverse(), x, F(4**count) / (line(a, x) + e * a.rest))


@given(bits, tangents(positive=True), place, share)
def test_a_root_holds_the_exact_one(count, a, x, e):
    square = (line(a, x) + e * a.rest) * 2**count
    with with_bits(count):
        root = a.root()
        low, high = line(root, x) - root.rest, line(root, x) + root.rest
    assert low <= 0 or low**2 <= square
    assert high >= 0
    assert square <= high**2


@given(bits, st.fractions(-100, 100, max_denominator=50))
def test_a_constant_and_a_place_hold_the_exact_ones(count, c):
    with with_bits(count):
        assert holds(checker.Tangent.constant(c), (0, 0, 0), c * 2**count)


@given(
    bits,
    st.integers(1, 50),
    st.lists(st.tuples(st.integers(-999, 999), st.integers(0, 99)), min_size=3, max_size=3),
    place,
)
def test_the_places_of_a_cell_are_in_its_tangents(count, unit, sides, x):
    cell = [(a, a + b) for a, b in sides]
    with with_bits(count):
        xi = checker.place_in(SimpleNamespace(unit=unit), cell)
    for tangent, (a, b), c in zip(xi, cell, x, strict=True):
        assert holds(tangent, x, (F(a + b, 2) + c * F(b - a, 2)) * F(2**count, unit))


@given(bits, tangents())
def test_what_may_be_zero_has_neither_inverse_nor_root(count, a):
    near = a._replace(rest=max(0, a.mid - sum(map(abs, a.slope))))  # spread >= mid
    with with_bits(count):
        for operation in (near.inverse, near.root):
            with pytest.raises(checker.Rejected, match="not shown to be positive"):
                operation()
