"""Hostile certificates of every vehicle within tolerances: rejected, or what they say is true."""

from __future__ import annotations

import contextlib
import copy
import time
from collections import Counter
from fractions import Fraction as F

import pytest

import test_hostile_attraction
from exponential_truth import OfPotential, Truth, potential, small
from hoverproof import checker
from test_hostile import is_about, mutants, put, with_another_key

CASES = {
    **{name: (small, name, Truth) for name in ("late", "lagged", "image")},
    "potential": (potential, "late", OfPotential),
}
STRIDE = 397
"""Of so many mutants one is tried in a part."""
ENOUGH = 8.0  # s; 3 s on a machine with nothing else to do


def named(value):
    """Name a case without the address of a function."""
    return value.__qualname__.split(".")[0] if callable(value) else str(value)


def made(name):
    make, of, truth = CASES[name]
    return make(of), truth


def remade(mutant):
    return test_hostile_attraction.remade(mutant)


def tried(mutant, tally, truth):
    """Check one mutant; whatever is accepted must be true, and nothing else may be raised."""
    began, theorem = time.process_time(), None
    with contextlib.suppress(checker.Rejected, checker.Unreadable):
        theorem = checker.check(mutant)
    took = time.process_time() - began
    tally["mutants"] += 1
    tally["slowest, ms"] = max(tally["slowest, ms"], int(1000 * took))
    assert took < ENOUGH
    if theorem is not None:
        tally["accepted"] += 1
        assert theorem == mutant["statement"]
        truth(mutant).holds()


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_no_mutant_is_accepted_unless_true(name, whole):
    (content, truth), tally = made(name), Counter()
    tried(content, tally, truth)
    assert tally["accepted"] == 1
    for number, mutant in mutants(content):
        if whole or number % STRIDE == 0:
            tried(remade(mutant), tally, truth)
        if whole and number % 5 == 0:
            tried(mutant, tally, truth)
    print(f"{name}:", dict(tally))
    assert not whole or tally["accepted"] > 100
    assert tally["mutants"] > (2000 if whole else 5)  # 8,000 whole with all names


# --- more than is proved, each with all hashes and the statement made anew ------------------------


def larger(share):
    return lambda x: str(F(x) * share)


def moved(by):
    return lambda x: str(F(x) + by)


def wider(share):
    return lambda sides: [[str(F(a) * 2 - F(b)), str(F(b) * share)] for a, b in sides]


MORE = {
    **{
        f"{name} {share}": (("mission", "uncertainty", name), larger(share))
        for name in ("thrust", "torque", "latency", "wind", "yaw_rate")
        for share in (2, 4)
    },
    "lag": (("mission", "uncertainty", "rotor_lag"), larger(3)),
    "no lag": (("lag",), None),
    "no memory": (("memory",), None),
    "little memory": (("memory",), larger(F(1, 1000))),
    "much memory": (("memory",), larger(1000)),
    "rate": (("claim", "rate"), larger(4)),
    "level": (("claim", "level"), larger(2)),
    "low level": (("claim", "level"), larger(F(1, 2))),
    "start above the level": (("claim", "start_level"), larger(100)),
    "start level": (("claim", "start_level"), larger(F(1, 2))),
    "time": (("claim", "settling", "time"), larger(F(4, 5))),
    "radius": (("claim", "settling", "radius"), larger(F(1, 3))),
    "settled offset": (("claim", "settling", "offset"), larger(2)),
    "cone": (("claim", "cone"), "999/1000"),
    "cone of the domain": (("domain", "cone"), "9999/10000"),
    "offset": (("domain", "offset"), larger(3)),
    "near offset": (("domain", "offset"), larger(F(4, 5))),
    "narrow ball": (
        ("domain", "bounds"),
        lambda x: [str(F(x[0]) * F(5, 4)), str(F(x[1]) * F(4, 5))],
    ),
    "wide ball": (("domain", "bounds"), lambda x: [str(F(x[0]) / 3), str(F(x[1]) * 3)]),
    "narrow wedge": (("domain", "wedge", 0, 1), larger(F(1, 3))),
    "wedge that is nearly cut": (("domain", "wedge", 1, 0), "1/1000"),
    "low wedge": (("domain", "wedge", 2, 0), larger(F(6, 5))),
    "goal": (("enclosures", "goal"), lambda x: [moved(F(1, 100))(c) for c in x]),
    "slope": (("multipliers", "slope"), larger(100)),
    "start": (
        ("claim", "starts", 0, "position"),
        lambda box: [[str(F(a) - F(1, 4)), str(F(b) + F(1, 4))] for a, b in box],
    ),
    "speed": (("claim", "starts", 0, "speed"), "2"),
    "tilt": (("claim", "starts", 0, "tilt"), "1"),
    "turning": (("claim", "starts", 0, "rate"), "10"),
    "thrust": (("claim", "starts", 0, "thrust"), "3"),
    "hover": (("hover", 0), "1/5"),
    "one multiplier less": (("multipliers", "terms"), lambda terms: terms[:-1]),
    "one multiplier more": (("multipliers", "terms"), lambda terms: [*terms, "1"]),
    "domain of one cell": (("domain", "tree"), "0"),
    "domain cut": (("domain", "tree"), lambda tree: pruned(tree)),
    "near of one cell": (("near", "tree"), "0"),
    "near cut": (("near", "tree"), lambda tree: pruned(tree) if len(tree) > 1 else tree + "0"),
    "near ball": (("near", "bounds", 0), larger(3)),
    "narrow near ball": (("near", "bounds", 1), larger(F(1, 10))),
    "loose near ball": (("near", "bounds", 0), larger(F(9, 10))),
    "an uneven target": (
        ("mission", "target", "points"),
        lambda points: [[str(F(points[0][0]) * 2), *points[0][1:]], *points[1:]],
    ),
    "a point seen twice": (("mission", "target", "points"), lambda points: [*points, points[0]]),
    "a mass": (("mission", "vehicle", "mass"), larger(F(3, 2))),
    "a gain": (("mission", "gains", "k2"), larger(2)),
    "noise": (("mission", "uncertainty", "noise", "rate"), "1/100"),
    "camera": (("mission", "camera"), {"half_angle": "1/4"}),
    **{f"kind {kind}": (("kind",), kind) for kind in checker.KINDS if kind != "exponential"},
}


def pruned(tree):
    """Return a tree in which the last halving is not made."""
    at = max(tree.rindex(f"{axis}00") for axis in "123" if f"{axis}00" in tree)
    return tree[:at] + "0" + tree[at + 3 :]


def changed(content, path, new):
    at = content
    for key in path[:-1]:
        at = at[key]
    if path[-1] == "camera":
        return remade(put(content, path, new))
    return remade(put(content, path, new(copy.deepcopy(at[path[-1]])) if callable(new) else new))


FORGED = ["late", "lagged", "image"]


@pytest.mark.slow
@pytest.mark.parametrize("name", FORGED)
def test_what_claims_more_is_rejected(name, whole):
    """A wider tolerance may be within what is proved; then it must be true."""
    (content, truth), tally = made(name), Counter()
    for number, (what, (path, new)) in enumerate(MORE.items()):
        if not whole and ("uncertainty" not in path if name != "late" else number % 2):
            continue  # the others are alike for all, and half of them are tried
        forged = changed(content, path, new)
        if forged == content:
            continue  # a tolerance that it has not
        before = tally["accepted"]
        tried(forged, tally, truth)
        assert tally["accepted"] == before or "uncertainty" in path, what
    assert tally["accepted"] < tally["mutants"] / 4


@pytest.mark.slow
@pytest.mark.parametrize("name", FORGED)
@pytest.mark.parametrize("share", [F(1, 10**6), F(10**6)])
def test_each_multiplier_and_weight_counts(name, share):
    content, _ = made(name)
    paths = [("multipliers", "terms", k) for k in range(len(content["multipliers"]["terms"]))]
    paths += [("weights", k) for k in range(3)]
    paths += [("lag", key) for key in content["lag"] or ()]
    for path in paths:
        with pytest.raises(checker.Rejected):
            checker.check(changed(content, path, larger(share)))
            pytest.fail(str(path))


@pytest.mark.parametrize("name", CASES)
def test_a_statement_names_the_target_and_has_no_keys_besides(name):
    content, _ = made(name)
    assert is_about(content)
    for _, mutant in with_another_key(content):
        with pytest.raises(checker.Rejected, match="must have the keys"):
            checker.check(mutant)


# --- the truth of this file -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "new"),
    [
        (("claim", "rate"), larger(5)),
        (("claim", "level"), larger(2)),
        (("claim", "start_level"), larger(F(1, 2))),
        (("claim", "start_level"), larger(100)),
        (("claim", "settling", "time"), larger(F(1, 2))),
        (("claim", "settling", "radius"), larger(F(1, 5))),
        (("claim", "starts", 0, "speed"), "2"),
        (("domain", "bounds"), lambda x: [str(F(x[0]) * F(6, 5)), str(F(x[1]) * F(4, 5))]),
        (("domain", "wedge", 2, 0), larger(F(6, 5))),
        (("mission", "uncertainty", "torque"), larger(4)),
        (("mission", "uncertainty", "latency"), larger(4)),
        (("multipliers", "slope"), larger(F(1, 100))),
    ],
    ids=named,
)
def test_the_truth_of_this_file_tells_a_false_claim(path, new):
    content, truth = made("late")
    truth(content).holds()
    with pytest.raises(AssertionError):
        truth(changed(content, path, new)).holds()


@pytest.mark.parametrize(
    ("path", "new"),
    [
        (("claim", "rate"), larger(100)),
        (("claim", "level"), larger(F(1, 2))),
        (("claim", "reach", "down"), "99/100"),
        (("mission", "uncertainty", "torque"), larger(4)),
        (("enclosures", "largest_eigenvalue"), larger(F(1, 3))),
    ],
    ids=named,
)
def test_the_truth_of_potentials_tells_a_false_claim(path, new):
    content, truth = made("potential")
    truth(content).holds()
    with pytest.raises(AssertionError):
        truth(changed(content, path, new)).holds()
