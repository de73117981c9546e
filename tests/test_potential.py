"""Regions of attraction of every vehicle within tolerances, and of all laws of the centroid."""

from __future__ import annotations

import copy
import itertools
from dataclasses import replace
from fractions import Fraction as F
from functools import cache

import numpy as np
import pytest

import uncertain_body as kit
from hoverproof import checker
from hoverproof.certification.attraction.proof import attraction, prove
from hoverproof.certification.attraction.search import SLACKS, Found, Search, find
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.attraction.tolerant import posed
from hoverproof.certification.exponential.inequality import Sector, falls
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.reach import Reach
from hoverproof.mission.reading import load
from papers_law import CRAZYFLIE
from sampling import mostly_whole
from sharing import kept_value
from uncertain_flights import fly

GAINS = {"gains.k1": "0.00466", "gains.k2": "18.1", "gains.k3": "0.114", "gains.k4": "0.3416"}
MEASURED = {"law.force": "measured", "sensors.gyro_turned": "true"}
BOTH = {"uncertainty.thrust": "0.2", "uncertainty.torque": "0.2"}
LATE = {"uncertainty.latency": "0.083"}
LAGGED = {"uncertainty.rotor_lag": "0.03"}
INERTIAL = {"law.goal": "inertial"}
ALL = {
    **INERTIAL,
    "uncertainty.rotor_lag": "0.02",
    "uncertainty.thrust": "0.1",
    "uncertainty.torque": "0.05",
    "uncertainty.latency": "0.03",
    "uncertainty.yaw_rate": "0.1",
    "uncertainty.wind": "0.1",
}
CASES = {"late": {**BOTH, **LATE}, "lagged": LAGGED, "all": ALL}
slow = pytest.mark.slow


def crazyflie(**extra):
    return load(CRAZYFLIE, {**GAINS, **MEASURED, **extra})


@pytest.fixture(scope="module")
def proofs():
    """Return the verdict on a case, reached once."""
    return cache(proof)


def proof(name):
    """Return the verdict on a case, reached once a run."""
    mission = crazyflie(**CASES[name])
    return kept_value(("potential", name), lambda: attraction(mission, barrier=False))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["late", "lagged", pytest.param("all", marks=pytest.mark.whole)])
def test_the_start_is_proved_and_the_statement_names_the_tolerances(name, proofs):
    verdict = proofs(name)
    assert verdict.status == "proved"
    assert verdict.certificate.content["kind"] == "potential"
    said = checker.check(verdict.certificate.content)
    for tolerance in CASES[name].values():
        if tolerance != "inertial":
            ends = [F(tolerance), 1 - F(tolerance)]
            assert any(str(x) in said for x in ends), tolerance


def matrix(form, size):
    made = np.zeros((size, size))
    for (i, j), c in form.items():
        made[i, j] += float(c) / 2
        made[j, i] += float(c) / 2
    return made


@pytest.mark.parametrize("name", ["late", "lagged", pytest.param("all", marks=pytest.mark.whole)])
def test_the_checker_writes_the_inequality_that_the_graph_gives(name, proofs):
    content = proofs(name).certificate.content
    claim = checker.claim_of(content)
    _, loop = posed(crazyflie(**CASES[name]))
    c, largest = claim.c, float(claim.high)
    a, level = np.array([float(x) for x in c.weights]), float(claim.level)
    reach = replace(Reach.of(a, level), speed=loop.farthest + float(np.sqrt(2 * level / a[0])))
    limits = Limits(loop.vehicles, reach, largest)
    _, corners = falls(limits, Sector(largest), 0.0, potential=True).of_used()
    lag = [] if c.lag is None else [float(c.lag.torque), float(c.lag.thrust)]
    memory = [] if c.memory is None else [float(c.memory)]
    numbers = [1.0, *a, *lag, float(c.multipliers.slope), *memory]
    terms = [float(t) for t in c.multipliers.terms]
    lean = float(c.enclosures.tilt)
    compared = zip(corners, limits.vertices(), claim.vertices(), strict=True)
    for corner, ours, theirs in compared:
        # the two have s3 h and h, and the tilt is rounded
        assert [float(x) for x in theirs[2:]] == pytest.approx(list(ours[2:5]))
        assert ours[5] == pytest.approx(lean if loop.q3 else 0, rel=1e-6)
        mine = corner.at(numbers).bound(terms)
        each = np.arange(7)
        mine[each, each] -= float(c.claim.rate) * float(claim.k[0] / claim.m)
        other = matrix(claim.decrease(claim.q3[0], *theirs), claim.size)
        assert np.abs(mine - other).max() < 1e-6 * np.abs(other).max()


@pytest.mark.slow
def test_without_tolerance_it_is_the_region_of_the_modelled_vehicle():
    found = []
    for force in ("modelled", "measured"):
        mission = load(CRAZYFLIE, {**GAINS, "law.force": force})
        potential, loop = posed(mission)
        starts = potential.hover_terms(np.array([[0.3, 0.2, -1.2]]))
        found.append(find(Search(potential, loop, SLACKS[0], None), "start", starts))
    assert isinstance(found[1], Found)
    assert found[0].fill == pytest.approx(found[1].fill, rel=1e-3)
    assert found[0].level == pytest.approx(found[1].level, rel=1e-3)


# --- forgeries ----------------------------------------------------------------------------------


def leaves(value, path=()):
    if isinstance(value, dict):
        for key, part in value.items():
            yield from leaves(part, (*path, key))
    elif isinstance(value, list):
        for key, part in enumerate(value):
            yield from leaves(part, (*path, key))
    elif isinstance(value, str):
        yield path, value


def forged(content, path, text):
    """Return the certificate with another entry, its statement and hashes made to fit."""
    made = copy.deepcopy(content)
    at = made
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = text
    made["mission_sha256"] = checker.digest(made["mission"])
    made["statement"] = checker.statement(made)
    made["sha256"] = checker.digest({k: v for k, v in made.items() if k != "sha256"})
    return made


WIDER = [
    *[(("mission", "uncertainty", name), x) for name, x in (("thrust", "2/5"), ("torque", "2/5"))],
    (("mission", "uncertainty", "latency"), "1/4"),
    (("mission", "uncertainty", "yaw_rate"), "20"),
    (("claim", "level"), "7/5"),
    (("claim", "rate"), "1/4"),
    (("multipliers", "slope"), "1/1000"),
    (("multipliers", "terms", 0), "1000"),
    (("multipliers", "terms", 1), "1000"),
    (("memory",), "1/1000"),
    (("enclosures", "tilt"), "1/20"),
    (("enclosures", "largest_eigenvalue"), "5"),
    (("enclosures", "largest_eigenvalue"), "40"),
    (("weights", 0), "1/1000"),
    (("weights", 2), "1/1000"),
    (("mission", "gains", "k1"), "1/50"),
    (("claim", "reach", "down"), "99/100"),
]


@pytest.mark.parametrize(("path", "text"), WIDER, ids=str)
def test_what_claims_more_is_rejected(path, text, proofs):
    content = proofs("late").certificate.content
    with pytest.raises(checker.Rejected):
        checker.check(forged(content, path, text))


@pytest.mark.parametrize("part", ["lag", "memory"])
def test_a_tolerance_needs_its_part_of_the_functional(part, proofs):
    content = proofs("late").certificate.content
    other = None if content[part] is not None else {"torque": "1", "thrust": "1"}
    with pytest.raises(checker.Rejected, match="belong"):
        checker.check(forged(content, (part,), other))


def test_a_vertex_more_or_a_multiplier_less_is_noticed(proofs):
    content = proofs("late").certificate.content
    for terms in (content["multipliers"]["terms"][:1], [*content["multipliers"]["terms"], "1"]):
        with pytest.raises(checker.Rejected, match="a multiplier a term"):
            checker.check(forged(content, ("multipliers", "terms"), terms))


def test_a_tree_that_is_cut_is_noticed(proofs):
    content = proofs("late").certificate.content
    tree = content["trees"]["positions"]
    last = tree.rindex("1") if "1" in tree else len(tree) - 1
    with pytest.raises(checker.Rejected):
        checker.check(forged(content, ("trees", "positions"), tree[:last] + "0" + tree[last + 3 :]))


def test_no_barrier_stands_where_the_height_is_not_driven_as_modelled(proofs):
    content = proofs("late").certificate.content
    made = forged(content, ("claim", "level"), content["claim"]["level"])
    made["claim"]["barrier_height"], made["trees"]["barrier"] = "1/10", "0"
    with pytest.raises(checker.Rejected, match="barrier"):
        checker.statement(made)


# --- flights ------------------------------------------------------------------------------------


class Case(kit.Case):
    """The numbers of a claim by the potential; w1 stands for none."""

    def _claim(self, content):
        lag, claim = content["lag"] or {"torque": "0", "thrust": "0"}, content["claim"]
        self.w = np.array([1.0, *kit.floats(content["weights"])])
        self.a5, self.a6 = (float(F(lag[k])) for k in ("torque", "thrust"))
        self.M, self.r = float(F(content["memory"] or "0")), 1e-9
        self.slope = float(F(content["enclosures"]["largest_eigenvalue"]))
        self.level = float(F(claim["level"]))

    def bounds(self):
        first = super().bounds()
        n = len(self.points)
        speed = self.k[0] / self.m * (n + self.s3 + np.sqrt(2 * self.level / self.w[1]))
        ahead = self.latency * self.slope * speed
        more = first["h"] * (ahead - first["n"])
        found = {"b1": n + self.s3, "v": speed, "n": ahead, "pi": first["pi"] + 2 * more}
        found["u"] = first["u"] + self.kappa * (ahead - first["n"])
        return {**first, **found, "q": first["q"] + (1 + self.thrust) * more}


def energy_of(view):
    """Return Λ, by the distances of the target points."""
    case, x, d = view.case, view.x, view.errors()
    rest = sum(w * kit.dot(p, p) for w, p in zip(case.w[1:], kit.parts(d)[1:], strict=True))
    mu = view.lagging(d, (x[kit.ANGULAR], x[kit.LIFT]))
    rest = rest + view.doubt.lag * (case.a5 * kit.dot(mu[:2], mu[:2]) + case.a6 * mu[2] ** 2)
    W = case.s3 * (x[kit.POSITION][2] - case.goal[2])
    for point in case.points:
        W = W + kit.size(point[:, None] - x[kit.POSITION])
        W = W - np.linalg.norm(point - case.goal)
    return W + rest / 2


@pytest.mark.slow
@pytest.mark.parametrize("name", ["late", "lagged", pytest.param("all", marks=pytest.mark.whole)])
def test_along_flights_at_the_corners_the_functional_falls(name, proofs, monkeypatch, whole):
    monkeypatch.setattr(kit.View, "energy", energy_of)
    case, count = Case(proofs(name).certificate.content), 150 if whole else 40
    made = fly(case, np.random.default_rng(1), count, 6.0, 0.05, start=case.start)
    assert len(made.level) == count
    assert made.level.max() < 1
    assert made.ratio.max() < 1 + 1e-9
    assert made.fall.min() > 0
    assert max(made.used.values()) < 1


@pytest.mark.slow
def test_the_functional_rises_for_vehicles_far_out_of_tolerance(proofs, monkeypatch):
    monkeypatch.setattr(kit.View, "energy", energy_of)
    content = copy.deepcopy(proofs("late").certificate.content)
    content["mission"]["uncertainty"] |= {"torque": "0.9", "thrust": "0.9", "latency": "0.4"}
    case = Case(content)
    with np.errstate(all="ignore"):
        made = fly(case, np.random.default_rng(1), 100, 3.0, 0.05, start=case.start)
    assert made.fall.min() < 0


# --- what is not proved, and why ----------------------------------------------------------------


def test_wind_with_a_goal_in_the_image_says_why_not():
    verdict = attraction(crazyflie(**{"uncertainty.wind": "0.2"}))
    assert verdict.status == "undecided"
    assert "wind moves the hover" in verdict.reason


@pytest.mark.parametrize("name", ["thrust", "latency", "rotor_lag", "wind"])
def test_without_a_barrier_it_is_said_why(name):
    wide = {"gains.k1": "0.0046", "gains.k2": "3", "gains.k3": "0.0552"}
    mission = crazyflie(**{**wide, **INERTIAL, f"uncertainty.{name}": "0.01"})
    verdict = attraction(mission, barrier=True)
    assert verdict.status == "undecided"
    assert f"uncertainty.{name}" in verdict.reason


@pytest.mark.slow
@pytest.mark.parametrize(
    ("goal", "torque"),
    mostly_whole(itertools.product(("image", "inertial"), ("0", "0.03")), every=3),
)
def test_a_barrier_holds_with_any_torque_within_tolerance(goal, torque):
    wide = {"law.goal": goal, "uncertainty.torque": torque}
    mission = load("x4-flyer", {"law.force": "measured", **wide})
    verdict = attraction(mission, barrier=True)
    assert verdict.status == "proved", verdict.reason
    assert verdict.barrier_height > 0
    assert checker.check(verdict.certificate.content)


@pytest.mark.slow
def test_a_start_that_moves_counts_the_flow_of_its_past():
    mission, box = crazyflie(**CASES["late"]), ((F(0), F(0)), (F(0), F(0)), (F(-1), F(-1)))
    potential, loop = posed(mission)
    slow_one, quick = (Start(box, speed=F(v)) for v in ("0.05", "0.5"))
    starts = potential.hover_terms(potential.goal[None])
    found = find(Search(potential, loop, SLACKS[0], None), "start", starts + 1e-3)
    assert not isinstance(prove(mission, found, [slow_one]), str)
    assert isinstance(prove(mission, found, [quick]), str)
