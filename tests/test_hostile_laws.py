"""Forged certificates of all eight laws: the checker rejects each, or what it accepts is true.

A forger changes numbers, words or trees, then makes anew all that a checker could compare:
enclosures, vertices, rates, statement and hashes. What is accepted is held to floating point.
"""

from __future__ import annotations

import copy
import itertools
import re
import time
from collections import Counter
from fractions import Fraction as F

import numpy as np
import pytest

from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.certification.over_box import certify_region, enclose
from hoverproof.mission.reading import load
from hoverproof.servo.laws.hamel_mahony import LAWS
from laws_kit import floats, numbers_of
from sampling import mostly_whole
from sharing import kept_value
from test_hostile import at, mutants, nodes, put, remade

ROUNDING = 1e-9
SLOWEST = 3.0  # s of computing
FORGED = 200
"""Of each certificate, by one to three changes, in `make trials`; a quarter in a part."""
STEP = (
    60  # one of so many of what is tried with certificates of the paper's law is tried with these
)
AUTO = {"bounds.eigenvalues": '"auto"'}
SCALED = {"law.feature": "scaled", "bounds.eigenvalues": "[0.4, 0.95]"}
INERTIAL = {"law.goal": "inertial"}
ASIDE = {"goal": "{centroid = [0.2, -0.3, 3.4]}"}
WEAK = {"gains.k4": "0.02"}
NEAR = tuple((F(a), F(b)) for a, b in ((0, "1/20"), (0, "1/20"), ("-61/20", "-59/20")))
BELOW = tuple((F(a), F(b)) for a, b in ((-3, 3), (-3, 3), (-4, -2)))


def missions():
    """Return missions that are proved, and some that are refuted, by name."""
    measured = {"law.force": "measured"}
    proved = {
        "scaled": SCALED,
        "scaled, general q*": SCALED | ASIDE | measured,
        "scaled, inertial, level": SCALED
        | INERTIAL
        | {"bounds": "{eigenvalues = [0.4, 0.95], level = 1}"},
        "inertial": INERTIAL | measured,
    }
    refuted = {
        "scaled, refuted": SCALED | ASIDE | WEAK,
        "scaled, inertial, refuted": SCALED | INERTIAL | WEAK,
        "inertial, refuted": INERTIAL | WEAK,
    }
    return proved, refuted


def weakened(content):
    """Return the same certificate with margins a tenth lower, so that many forgeries stay true."""
    weaker = copy.deepcopy(content)
    for vertex in weaker["vertices"]:
        vertex["margin"] = str(F(vertex["margin"]) * F(9, 10))
    return fitted(weaker)


@pytest.fixture(scope="module")
def certificates():
    return kept_value("hostile laws", made_certificates)


def made_certificates():
    proved, refuted = missions()
    made = {name: certify(load("x4-flyer", change)) for name, change in (proved | refuted).items()}
    assert {made[name].status for name in proved} == {"proved"}
    assert {made[name].status for name in refuted} == {"refuted"}
    mission = load("x4-flyer", SCALED | AUTO)
    region = enclose(mission, NEAR)
    made["scaled, over box"] = certify(mission, region=region)
    made["scaled, region"] = certify_region(mission, NEAR)
    made["scaled, outside"] = certify_region(load("x4-flyer", SCALED), BELOW, most=100)
    assert made["scaled, outside"].status == "refuted"
    made = {name: verdict.certificate.content for name, verdict in made.items()}
    return {name: weakened(c) if c["kind"] == "gains" else c for name, c in made.items()}


NAMES = [*itertools.chain(*missions()), "scaled, over box", "scaled, region", "scaled, outside"]

# --- what a forger makes anew -------------------------------------------------------------------


def fitted(content):
    """Return a copy in which all follows from mission, bounds, weights and margins that can."""
    forged = copy.deepcopy(content)
    mission = forged["mission"]
    try:
        if forged["region"]["box"] is None:
            mission["bounds"]["eigenvalues"] = forged["region"]["eigenvalues"]
        if "height" in mission["goal"]:
            points = floats_exact(mission["target"]["points"])
            height = sum(p[2] for p in points) / len(points) - F(mission["goal"]["height"])
            forged["goal_position"][2] = str(height)
        forged["mission_sha256"] = checker.digest(mission)
        if forged["kind"] == "gains":
            fit_gains(forged)
        forged["statement"] = checker.statement(forged)
    except (checker.Rejected, KeyError, ValueError, ArithmeticError):
        pass
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    return forged


def floats_exact(rows):
    return [[F(x) for x in row] for row in rows]


def fit_gains(forged):
    question = checker.claim_of(forged)
    unit = 1 << 64
    around = [
        [str(F(int(a * unit) - 1, unit)), str(F(int(b * unit) + 1, unit))]
        if a < b
        else [str(a)] * 2
        for a, b in question.fixed
    ]
    low, high = question.f
    ends = [str(F(int(low * unit), unit)), str(F(int(high * unit) + 1, unit))]
    forged["enclosures"] |= {"centroid": around, "factor": ends}
    for vertex, f in zip(forged["vertices"], ends, strict=True):
        vertex["factor"] = f
    forged["claim"]["margin"] = min((v["margin"] for v in forged["vertices"]), key=F)
    mass = F(forged["mission"]["vehicle"]["mass"])
    for part in (forged["claim"], *forged["vertices"]):
        part["decay_rate"] = str(2 * F(part["margin"]) / mass)
    goal = forged["enclosures"]["goal"]
    if forged["goal_position"] is not None:
        forged["enclosures"]["goal"] = [[x, x] for x in forged["goal_position"]]
    assert len(goal) == 3


# --- what a forger changes ----------------------------------------------------------------------


def other_law(content, rng):
    """Swap words of the law."""
    law = LAWS_IN_WORDS[rng.integers(len(LAWS_IN_WORDS))]
    content["mission"]["law"] = dict(law)


LAWS_IN_WORDS = [dict(zip(("feature", "goal", "force"), law, strict=True)) for law in LAWS]


def other_bounds(content, rng):
    """Widen, narrow or shift the interval, or the ball."""
    low, high = (F(x) for x in content["region"]["eigenvalues"])
    step = F(float(10 ** rng.uniform(-7, 0))).limit_denominator(10**9) * (high - low) / 2
    signs = [(-1, 1), (1, -1), (1, 1), (-1, -1), (0, 1), (1, 0), (0, -1), (-1, 0)][rng.integers(8)]
    ends = [str(x + s * step) for x, s in zip((low, high), signs, strict=True)]
    content["region"]["eigenvalues"] = ends


def other_tree(content, rng):
    """Prune a branch, change a letter, halve a cell once more, or cut it short."""
    tree = content["region"]["tree"]
    if not tree:
        return
    k = int(rng.integers(len(tree)))
    choice = rng.integers(5)
    if choice == 0:  # the branch that begins at k
        end, open_ = k, 1
        while open_ and end < len(tree):
            open_ += 1 if tree[end] != "0" else -1
            end += 1
        tree = f"{tree[:k]}0{tree[end:]}"
    elif choice == 1:
        tree = tree[:k] + str(rng.integers(4)) + tree[k + 1 :]
    elif choice == 2 and tree[k] == "0":
        tree = f"{tree[:k]}{rng.integers(1, 4)}00{tree[k + 1 :]}"
    elif choice == 3:
        tree = tree[:k]
    else:
        tree = tree.translate(str.maketrans("123", "".join(rng.permutation(list("123")))))
    content["region"]["tree"] = tree


def other_number(*paths):
    """Return what changes one of the numbers that lie under paths."""

    def change(content, rng):
        found = [
            path
            for path in nodes(content)
            if path[: len(paths[0])] in paths
            and isinstance(at(content, path), str)
            and re.fullmatch(r"-?\d+(/\d+)?", at(content, path))
        ]
        if not found:
            return
        *above, last = found[rng.integers(len(found))]
        spot = at(content, above)
        share = F(float(rng.choice([-1, 1]) * 10 ** rng.uniform(-9, 0))).limit_denominator(10**12)
        spot[last] = str(F(spot[last]) * (1 + share) if spot[last] != "0" else share)

    return change


of_the_mission = other_number(
    *((("mission", key)) for key in ("gains", "vehicle", "target", "goal", "bounds"))
)
of_the_claim = other_number(
    *(
        (key,)
        for key in (
            "weights",
            "counterexample",
            "outside",
            "vertices",
            "goal_position",
            "enclosures",
        )
    )
)
of_the_box = other_number(("region", "box"))
CHANGES = [
    *(other_law, other_bounds, other_bounds, other_tree, other_tree),
    *(of_the_mission, of_the_claim, of_the_claim, of_the_box),
]


def forgeries(content, rng, count):
    """Yield certificates with one to three changes, all else made to fit."""
    for law in LAWS_IN_WORDS:
        yield fitted(put(content, ("mission", "law"), law))
    for _ in range(count):
        forged = copy.deepcopy(content)
        for k in rng.choice(len(CHANGES), size=rng.integers(1, 4), replace=False):
            CHANGES[k](forged, rng)
        yield fitted(forged)


# --- what is true -------------------------------------------------------------------------------


def gains_hold(content, numbers):
    margin = floats(content["claim"]["margin"])
    worst, size = numbers.worst(np.random.default_rng(0), starts=2, rounds=0)
    assert 0 < margin <= worst + 1e-12 * size
    assert floats(content["claim"]["decay_rate"]) == pytest.approx(2 * margin / numbers.m)
    weight = numbers.m * numbers.gravity
    assert numbers.thrust[0] <= weight * (1 + ROUNDING)
    assert weight <= numbers.thrust[1] * (1 + ROUNDING)
    assert numbers.within(numbers.at(numbers.goal[None]))[0] > -ROUNDING
    if content["region"]["box"] is None:
        bounds = content["mission"]["bounds"]
        assert content["region"]["eigenvalues"] == bounds["eigenvalues"]
    else:
        region_holds(content, numbers)


def region_holds(content, numbers):
    low, high = floats(content["region"]["box"]).T
    assert (low <= high).all()
    share = np.random.default_rng(0).random((500, 3))
    share[:8] = list(itertools.product((0, 1), repeat=3))
    assert numbers.within(numbers.at(low + (high - low) * share)).min() > -ROUNDING


def outside_holds(content, numbers):
    position, x = (floats(content["outside"][k]) for k in ("position", "direction"))
    low, high = floats(content["region"]["box"]).T
    assert (low - ROUNDING <= position).all()
    assert (position <= high + ROUNDING).all()
    flow = numbers.at(position[None])[0]
    if numbers.scaled:
        assert content["outside"]["bound"] == "ball"
        j, reach = (numbers.low + numbers.high) / 2, (numbers.high - numbers.low) / 2
        assert np.linalg.norm(flow @ x - j * x) >= reach * np.linalg.norm(x) * (1 - ROUNDING)
        return
    value = x @ flow @ x / (x @ x)
    lower = content["outside"]["bound"] == "lower"
    assert (
        value <= numbers.low * (1 + ROUNDING) if lower else value >= numbers.high * (1 - ROUNDING)
    )


def counterexample_holds(content, numbers):
    point = content["counterexample"]
    Q, X, f, value = (floats(point[k]) for k in ("Q", "X", "f", "value"))
    assert (Q == Q.T).all()
    assert numbers.within(Q[None])[0] > -ROUNDING
    low, high = numbers.ends_of_f()
    assert low * (1 - ROUNDING) <= f <= high * (1 + ROUNDING)
    S = numbers.sigma(f, Q)
    found, size = X @ S @ X, np.abs(X) @ np.abs(S) @ np.abs(X)
    assert found <= value + 1e-12 * size
    assert value < 0
    if content["region"]["box"] is not None:
        region_holds(content, numbers)


HOLDS = {
    "gains": gains_hold,
    "region": region_holds,
    "outside": outside_holds,
    "counterexample": counterexample_holds,
}


def says_its_law(content):
    """Tell whether the statement is about the law of the mission, as far as it bears on it."""
    law, said = content["mission"].get("law", LAWS_IN_WORDS[0]), content["statement"]
    of_j = ("J" in said) == (law["feature"] == "scaled")
    if content["kind"] in ("region", "outside") or law == LAWS_IN_WORDS[0]:
        return of_j
    return of_j and f"(law {law['feature']}/{law['goal']}/{law['force']}, " in said


def true(content):
    HOLDS[content["kind"]](content, numbers_of(content))
    assert says_its_law(content)


def tried(forged, tally):
    """Check a forgery; whatever is accepted must be true, and nothing else may be raised."""
    began = time.process_time()
    try:
        theorem = checker.check(forged)
    except (checker.Rejected, checker.Unreadable):
        theorem = None
    took = time.process_time() - began
    tally["slowest, ms"] = max(tally["slowest, ms"], int(1000 * took))
    assert took < SLOWEST
    tally["tried"] += 1
    if theorem is not None:
        tally["accepted"] += 1
        assert theorem == forged["statement"]
        true(forged)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_each_certificate_itself_is_accepted_and_true(certificates, name):
    tally = Counter()
    tried(certificates[name], tally)
    assert tally["accepted"] == 1


@pytest.mark.parametrize(
    ("name", "path", "worse"),
    [
        ("scaled", ("claim", "margin"), "1"),
        ("scaled", ("region", "eigenvalues"), ["2/3", "7/10"]),
        ("inertial", ("mission", "gains", "k4"), "1/100"),
        ("scaled, refuted", ("counterexample", "value"), "-1000"),
        ("scaled, over box", ("region", "eigenvalues"), ["69/100", "7/10"]),
        ("scaled, region", ("region", "box", 2, 1), "-1"),
        ("scaled, region", ("mission", "law", "feature"), "centroid"),
        ("scaled, outside", ("region", "eigenvalues"), ["1/100", "9"]),
    ],
)
def test_the_truth_of_this_file_tells_a_false_claim(certificates, name, path, worse):
    with pytest.raises(AssertionError):
        true(put(certificates[name], path, worse))


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_whole(NAMES, every=2))
def test_no_forgery_is_accepted_unless_true(certificates, name, whole):
    tally, began, count = Counter(), time.process_time(), FORGED if whole else FORGED // 4
    rng = np.random.default_rng([20261126, NAMES.index(name)])
    for forged in forgeries(certificates[name], rng, count):
        tried(forged, tally)
    for number, mutant in mutants(certificates[name]):
        if number % (STEP if whole else 2 * STEP) == 0:
            tried(remade(mutant, cunning=True), tally)
    print(f"{name}:", dict(tally), f"{time.process_time() - began:.1f} s")
    assert tally["tried"] >= count
    least = 5 if whole else 2  # a forger who is always refused has tried too little
    assert tally["accepted"] >= least


def test_the_forgeries_number_two_thousand():
    assert FORGED * len(NAMES) >= 2000
