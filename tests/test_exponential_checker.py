"""Every vehicle within tolerances: the inequality of the checker against one that flies."""

from __future__ import annotations

import copy
import math
from fractions import Fraction as F
from unittest.mock import patch

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exponential_kit import (
    E3,
    SCALED,
    TOLERANCES,
    Balance,
    Vehicle,
    claim_of,
    drawn,
    mission,
    parts,
    proved,
    sealed,
)
from hoverproof import checker
from hoverproof.servo.uncertain import Doubt, Motion, error_rates
from hoverproof.servo.variables import Design, Errors

GAINS = (0.03, 20, 2.6, 5.8)
NO_LAG = {**TOLERANCES, "rotor_lag": "0"}
IMAGE = "scaled", "image", "measured"
MANY, FEW = 300, 40
NOISE = 1e-7  # share of the squares of errors by which differences may be off


def balances(law, tolerances, level, many, seed=1):
    """Return what Ψ falls more than the checker's bound, and what each term takes of it."""
    content = parts(mission(law, GAINS, **tolerances), level=level)
    vehicle, rng = Vehicle(content), np.random.default_rng(seed)
    spare, taken = [], []
    for _ in range(many):
        balance = Balance(vehicle, *drawn(rng, vehicle))
        bare, most = balance.bound()
        spare.append((balance.truth() - bare + most.sum()) / balance.scale())
        taken.append(most / balance.scale())
    return np.array(spare), np.array(taken)


# --- the inequality -----------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "tolerances"),
    [
        (SCALED, TOLERANCES),
        (IMAGE, TOLERANCES),
        (("centroid", "inertial", "measured"), NO_LAG),
        (("centroid", "image", "measured"), {**TOLERANCES, "latency": "0"}),
        (IMAGE, {**TOLERANCES, "wind": "4", "yaw_rate": "3", "rotor_lag": "1/5"}),
        (checker.PAPERS, {"torque": "1/5", "latency": "73/1000", "yaw_rate": "1"}),
        (("scaled", "inertial", "modelled"), {"torque": "1/2", "yaw_rate": "2"}),
    ],
)
def test_no_vehicle_within_tolerances_has_psi_fall_less_than_the_bound(law, tolerances, whole):
    """It is a rigid body with rotors, in wind; E is by definition, E' by differences."""
    many = MANY if whole else FEW
    spare, _ = balances(law, tolerances, 0.5, many)
    assert spare.min() > -NOISE
    assert (spare < 1e-3).sum() > many / 20  # and often it is no higher


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tolerances", "level", "soon", "needed"),
    [
        ({"rotor_lag": "3/1000", "yaw_rate": "1"}, 1e-4, [3, 4], [0, 1, 2, 3, 4]),
        ({"rotor_lag": "3/10"}, 0.5, [3], [0, 2, 3]),
        ({"rotor_lag": "3/100", "torque": "1/5"}, 1e-4, [0], [0]),
        (NO_LAG, 0.5, [0, 2, 3], [0, 1, 2, 3]),
    ],
)
def test_without_one_of_its_terms_the_bound_is_wrong(tolerances, level, soon, needed, whole):
    """Of the eight terms with lag and the four without, where tolerances make them count."""
    spare, taken = balances(SCALED, tolerances, level, MANY if whole else 2 * FEW)
    wrong = (spare[:, None] - taken < -NOISE).any(axis=0)
    assert set(needed if whole else soon) <= set(np.flatnonzero(wrong))


@pytest.mark.parametrize("law", [SCALED, IMAGE])
def test_what_is_not_bounded_by_a_norm_is_the_graph(law):
    """Where n, p3, γ, G and Ω3 are zero the checker's E' is that of `error_rates`."""
    content = parts(mission(law, GAINS, thrust="1/5", wind="1/5"), level=0.5)
    v, rng = Vehicle(content), np.random.default_rng(2)
    kinds = [layout.symbols() for layout in (Errors, Motion, Doubt, Design)]
    f = ca.Function("f", [kind.vector() for kind in kinds], [error_rates(*kinds)])
    for _ in range(5):
        d, y = rng.normal(size=11), rng.normal(size=3)
        chi, gain, h = rng.uniform(0.5, 1.5, size=3)
        p1 = h * d[8]
        motion = np.r_[y, 0, 0, 0, v.fixed, h, p1, 0, 0]
        doubt = np.r_[gain, chi, (gain - 1) * p1, np.zeros(14)]
        rates = np.array(f(d, motion, doubt, v.design)).ravel()
        whole = np.repeat(v.weights, [3, 3, 3, 2]) @ (d * rates)
        corner = [F(float(x)) for x in (chi, v.fixed * h, gain, 0, 2 * p1)]
        form = v.claim.nominal(*corner)
        held = [*np.split(np.r_[d, 0], 4), y]
        total = 0.0
        for axis in (0, 1):
            pairs = [np.array([e[axis], 0 if axis else e[2]]) for e in held]
            pairs[3] = pairs[3][:1]
            total += float(form.value([F(float(c)) for c in np.concatenate(pairs)]))
        assert total == pytest.approx(whole, rel=1e-9)


@pytest.mark.slow
def test_the_corners_are_the_worst():
    content = parts(mission(IMAGE, GAINS, **TOLERANCES), level=0.5)
    claim, rng = claim_of(content), np.random.default_rng(3)
    corners = list(claim.vertices())
    assert len(corners) == 32
    lows, highs = (list(map(best, zip(*corners, strict=True))) for best in (min, max))
    forms = [claim.decrease(*corner) for corner in corners]
    for _ in range(10):
        at = [a + F(float(rng.uniform())) * (b - a) for a, b in zip(lows, highs, strict=True)]
        inside = claim.decrease(*at)
        for _ in range(10):
            X = [F(float(x)) for x in rng.normal(size=claim.size)]
            assert inside.value(X) >= min(form.value(X) for form in forms)


# --- where it starts ----------------------------------------------------------------------------


@pytest.mark.parametrize("law", [SCALED, IMAGE])
def test_no_state_of_a_start_has_a_higher_psi(law):
    content = parts(mission(law, GAINS, **TOLERANCES), level=0.5)
    start = content["claim"]["starts"][0]
    start |= {"speed": "1/50", "tilt": "1/100", "rate": "1/10", "thrust": "1/100"}
    v, rng = Vehicle(content), np.random.default_rng(4)
    asked = v.claim.c.claim.starts[0]
    moved = float(v.claim.c.memory) * (v.may.latency * float(v.claim.high) / 50) ** 2 / 2
    most = []
    for _ in range(500):
        high, level = sorted(rng.uniform(0, 0.3, size=2))[::-1]
        e = level * pointed(rng, 2)
        e = np.r_[e, rng.choice([-1, 1]) * np.sqrt(high**2 - level**2)]
        bound = float(v.claim.at_start(asked, F(high), F(level)))
        most.append((v.energy(at_start(v, rng, e), v.may.rotor_lag) + moved) / bound)
    assert max(most) < 1
    assert max(most) > 0.5


def pointed(rng, n=3):
    x = rng.normal(size=n)
    return x / np.linalg.norm(x)


def at_start(v, rng, e):
    """Return a state of the start of the test above, at which σ - σ* is e."""
    force = (0.01 + v.m * v.g * 0.01) * pointed(rng)
    wind = v.m * v.may.wind * pointed(rng)
    up = v.m * v.g * E3 + wind - force
    thrust = np.linalg.norm(up)
    third = up / thrust
    first = np.cross(pointed(rng), third)
    first /= np.linalg.norm(first)
    R = np.column_stack([first, np.cross(third, first), third])
    turning = 0.1 * pointed(rng, 2)
    body = R.T @ (v.s3 * E3 + e), R.T @ (0.02 * pointed(rng)), R.T @ E3
    return np.r_[*body, turning, 0.7, thrust, R.T @ wind, 0, 0, 0]


# --- certificates -------------------------------------------------------------------------------


def touches(wedges, cell):
    """Tell whether a cell is at a face of the wedge of `parts`."""
    one = wedges.unit
    faces = {-one, one}, {-one, one}, {one // 2, 5 * one}
    return any(set(side) & ends for side, ends in zip(cell, faces, strict=True))


def small(wedges, cell):
    return cell[0][1] - cell[0][0] < wedges.unit


def held(self, cell, grid, domain):
    seen = domain.cone is None or domain.cone <= F(1, 2)
    return small(self, cell) if touches(self, cell) else seen and not self.at_face(cell)


def halved(depth):
    """Return the tree of a box that is halved along each axis in turn."""
    return "123"[depth % 3] + 2 * halved(depth - 1) if depth else "0"


PLACES = {
    "hold": held,
    "start": lambda self, grid, cell: (
        (F(3), F(2)) if cell[2][0] * 5 < -6 * grid.unit else (F(0),) * 2
    ),
}


def bounded(target, scaled, grid, cell, low, high):
    return low < 7 and high > 15 and 4 * (cell[0][1] - cell[0][0]) < grid.unit


@pytest.fixture(scope="module")
def content():
    """Return a certificate that stands if cells are as `PLACES` says."""
    found = proved(**TOLERANCES)
    found["claim"]["starts"][0]["position"][2] = ["-13/10", "-13/10"]
    bound = claim_of(found).at_start(claim_of(found).c.claim.starts[0], F(3), F(2))
    found["domain"] |= {"offset": "751/100", "cone": "1/2", "tree": halved(6)}
    found["near"]["tree"] = "100"
    found["claim"] |= {"start_level": str(F(math.ceil(bound * 1000), 1000)), "cone": "39/100"}
    found["claim"]["settling"] |= {"offset": "1", "radius": "1/5", "time": "24"}
    return found


def checked(content):
    with patch.multiple(checker.Wedges, **PLACES), patch.object(checker, "bounded", bounded):
        return checker.check(sealed(content))


def changed(content, path, new):
    found = copy.deepcopy(content)
    spot = found
    for key in path[:-1]:
        spot = spot[key]
    spot[path[-1]] = new(spot[path[-1]]) if callable(new) else new
    return found


def test_a_certificate_of_all_tolerances_at_once_is_accepted(content):
    said = checked(content)
    for what in ("4/5 to", "1/5", "73/1000", "3/100", "|Ω3| <= 1 rad/s", "m/s²", "exp(-r t)"):
        assert what in said


@pytest.mark.parametrize("what", list(TOLERANCES))
def test_a_wider_tolerance_is_noticed_though_its_hashes_are_made_anew(content, what):
    wider = changed(content, ("mission", "uncertainty", what), lambda x: str(F(x) * F(3, 2)))
    with pytest.raises(checker.Rejected, match=r"Ψ is not shown to fall|below the weight"):
        checked(wider)


@pytest.mark.parametrize(
    ("path", "new", "reason"),
    [
        (("claim", "rate"), "1/5", "Ψ is not shown"),
        (("claim", "level"), "29", "within the domain"),
        (("domain", "offset"), "37/5", "within the domain"),
        (("claim", "start_level"), lambda x: str(F(x) - F(1, 100)), "a start is not shown"),
        (("claim", "start_level"), "30", "a start is above the level"),
        (("claim", "settling", "time"), "20", "settling time"),
        (("claim", "settling", "radius"), "1/100", "within the radius"),
        (("domain", "tree"), "0", "domain"),
        (("domain", "tree"), halved(6)[:-1], "shorter"),
        (("domain", "wedge", 0, 1), "2", "domain"),
        (("near", "tree"), "0", "not bounded near the goal"),
        (("near", "bounds", 0), "8", "not bounded near the goal"),
        (("near", "bounds", 0), "4", "within the radius"),
        (("near", "bounds", 1), "5", "not in order"),
        (("claim", "settling", "offset"), "8", "beyond the domain"),
        (("claim", "cone"), "1/2", "angle"),
        (("domain", "cone"), None, "angle"),
        (("domain", "cone"), "3/4", "domain"),
        (("domain", "bounds"), ["4", "15"], "Ψ is not shown"),
        (("multipliers", "slope"), lambda x: str(F(x) / 2), "Ψ is not shown"),
        (("memory",), lambda x: str(F(x) / 50), "Ψ is not shown"),
        (("memory",), None, "belongs to a latency"),
        (("lag",), None, "belong to a lag"),
        (("multipliers", "terms"), lambda x: x[:-1], "a multiplier a term"),
        (("mission", "uncertainty", "noise", "rate"), "1/100", "noise"),
        (("enclosures", "goal"), lambda x: [x[0], x[0]], "s3"),
        (("hover",), ["0", "0", "-1"], "hover point"),
        (("claim", "starts", 0, "position", 0), ["0", "3/2"], "not in the wedge"),
        (("claim", "starts"), [], "no start"),
        (("hold",), {"lift": "1"}, "weights of what is held"),
    ],
)
def test_what_does_not_follow_is_noticed(content, path, new, reason):
    with pytest.raises(checker.Rejected, match=reason):
        checked(changed(content, path, new))


@pytest.mark.parametrize("k", range(8))
def test_a_multiplier_that_is_weakened_is_noticed(content, k):
    for share in (F(1, 10**6), F(10**6)):
        weaker = changed(content, ("multipliers", "terms", k), lambda x, s=share: str(F(x) * s))
        with pytest.raises(checker.Rejected, match="Ψ is not shown"):
            checked(weaker)


@pytest.mark.parametrize("which", [0, 1, 2])
def test_other_weights_are_noticed(content, which):
    other = changed(content, ("weights", which), lambda x: str(F(x) / 4))
    with pytest.raises(checker.Rejected):
        checked(other)


def test_the_cone_of_the_camera_is_held_to(content):
    """The proved cone is that of arccos 0.39 = 1.1702 rad."""
    for half_angle, fits in ((F("1.171"), True), (F("1.17"), False)):
        seen = copy.deepcopy(content)
        seen["mission"]["camera"] = {"half_angle": str(half_angle)}
        if fits:
            checked(seen)
        else:
            with pytest.raises(checker.Rejected, match="half angle of the camera"):
                checked(seen)


def test_where_nothing_may_be_wrong_it_says_so():
    said = claim_of(parts(mission(SCALED, GAINS, thrust="1/5"), level=0.5)).words()
    for what in ("no wind", "no latency", "no rotor lag", "any Ω3", "4/5 to", "γ"):
        assert (what in said) == (what != "γ")


# --- numbers ------------------------------------------------------------------------------------


@given(st.fractions(0, 200, max_denominator=10**6))
def test_the_exponential_is_bounded_from_below(x):
    assert checker.exponential_above(x, F(math.exp(x)) * F(999_999_999, 10**9))
    assert not checker.exponential_above(x, F(math.exp(x)) * F(1_000_000_001, 10**9))


@given(st.fractions(0, 1, max_denominator=10**6).map(lambda x: x * F(157, 100)))
def test_the_cosine_is_bounded_from_above(x):
    assert checker.cosine_below(x, F(math.cos(x)) + F(1, 10**12))
    assert not checker.cosine_below(x, F(math.cos(x)) - F(1, 10**12))


@given(st.fractions(0, 10**9))
def test_rounding_upward_is_close_and_short(x):
    up = checker.upward(x)
    assert x <= up <= x * (1 + F(1, 2**60))
    assert math.gcd(up.denominator, 2**400) == up.denominator or x == 0
    assert up.numerator.bit_length() <= 66 or up.denominator == 1
