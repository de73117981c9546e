"""Thousands of hostile certificates: the checker rejects each, or what it accepts is true."""

from __future__ import annotations

import copy
import functools
import itertools
import json
import time
from collections import Counter
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.certification.over_box import certify_region, enclose
from hoverproof.mission.reading import load
from sharing import kept_value

F = Fraction
SMALL = ((F(0), F(1)), (F(0), F(1, 2)), (F(-4), F(-3)))
ROUNDING = 1e-9
WIDE = ((F(-1), F(6)), (F(-1), F(4)), (F(-5), F(-2)))
SLOWEST = 3.0  # s of computing; 2 s on a machine with nothing else to do
DROPPED, DOUBLED = object(), object()
LEAST = {  # so many mutants of each must have been tried
    "gains": 2400,
    "gains, weaker": 2400,
    "gains, level": 2400,
    "gains, general q*": 2400,
    "counterexample": 2400,
    "region": 1900,
    "outside": 2200,
    "gains over box": 2400,
}
SHARES = 4


def weakened(content):
    """Return the same certificate with margins a tenth lower, so that many mutants stay true."""
    weaker = copy.deepcopy(content)
    for part in [weaker["claim"], *weaker["vertices"]]:
        part["margin"] = str(F(part["margin"]) * F(9, 10))
    return remade(weaker, cunning=True)


@pytest.fixture(scope="module")
def certificates():
    return kept_value("hostile", made)


def made():
    mission = load("x4-flyer")
    region = enclose(mission, SMALL)
    level = {"bounds": "{eigenvalues = [0.01, 5], level = 10}"}
    tilted = {"goal": "{centroid = [0.3, 0.2, 3.5]}"}
    plain = certify(mission).certificate.content
    return {
        "gains": plain,
        "gains, weaker": weakened(plain),
        "gains, level": weakened(certify(load("x4-flyer", level)).certificate.content),
        "gains, general q*": weakened(certify(load("x4-flyer", tilted)).certificate.content),
        "counterexample": certify(load("x4-flyer", {"gains.k4": "0.1"})).certificate.content,
        "region": certify_region(
            load("x4-flyer", {"bounds.eigenvalues": '"auto"'}), SMALL
        ).certificate.content,
        "outside": certify_region(mission, WIDE).certificate.content,
        "gains over box": weakened(certify(mission, region=region).certificate.content),
    }


# --- the mutants --------------------------------------------------------------------------------


def nodes(value, path=()):
    """Yield the path of every leaf and node below a value."""
    children = value.items() if isinstance(value, dict) else enumerate(value)
    for key, entry in children:
        yield (*path, key)
        if isinstance(entry, dict | list):
            yield from nodes(entry, (*path, key))


def at(content, path):
    for key in path:
        content = content[key]
    return content


def copied(content, path):
    """Return a copy that shares all with it but what lies on a path, and the entry at its end."""
    made = here = copy.copy(content)
    for key in path:
        here[key] = copy.copy(here[key])
        here = here[key]
    return made, here


def put(content, path, new):
    """Return a copy with one entry replaced, dropped or doubled."""
    *above, last = path
    mutant, spot = copied(content, above)
    if new is DROPPED:
        del spot[last]
    elif new is DOUBLED:
        if isinstance(spot, list):
            spot.insert(last, copy.deepcopy(spot[last]))
        else:
            spot[f"{last}_"] = copy.deepcopy(spot[last])
    else:
        spot[last] = new
    return mutant


def nested(value, depth):
    for _ in range(depth):
        value = [value]
    return value


def replacements(content, path):
    """Yield what to put in place of the entry at a path."""
    value = at(content, path)
    yield from (
        DROPPED,
        DOUBLED,
        None,
        True,
        1,
        0.5,
        "",
        "junk \ud800\x00'",
        [],
        {},
        nested(value, 60),
    )
    if isinstance(value, dict):
        yield value | {"extra": "1"}
    elif isinstance(value, list):
        yield from ([*value, "1"], value[::-1], [value] * 3)
    if isinstance(value, str) and ("trees" in path or path[-1] == "tree"):
        yield from (value[1:], value[:-1], f"{value}0", f"1{value}", f"1{value}0", "0", "100")
        yield from (value.replace(a, b, 1) for a, b in itertools.permutations("0123", 2))
        return
    try:
        x = F(value) if isinstance(value, str) else None
    except ValueError:
        x = None
    if x is None:
        return
    for factor in (F(1, 10**12), F(1, 1000), F(1, 4)):
        yield from (str(x * (1 + factor)), str(x * (1 - factor)))
    yield from (
        str(-x),
        str(x + 1),
        str(x - 1),
        "0",
        "9" * 300,
        "9" * 301,
        "1/0",
        f"{x}/1",
        f" {x}",
    )
    yield from ("1/" + "9" * 300, "-" + "9" * 300 + "/7", "1/1" + "0" * 40)
    siblings = at(content, path[:-1])
    keys = list(siblings) if isinstance(siblings, dict) else range(len(siblings))
    other = siblings[keys[(list(keys).index(path[-1]) + 1) % len(keys)]]
    yield copy.deepcopy(other)


def swaps(content):
    """Yield copies with two neighbours exchanged."""
    for path in nodes(content):
        siblings = at(content, path[:-1])
        if isinstance(siblings, list) and path[-1] + 1 < len(siblings):
            (mutant, here), i = copied(content, path[:-1]), path[-1]
            if here[i] != here[i + 1]:
                here[i], here[i + 1] = here[i + 1], here[i]
                yield mutant


def idle(path):
    """Tell whether an entry bears no claim: its mutants are all accepted, so a few will do."""
    return path[0] in ("tools", "model_sha256") or path[:2] == ("mission", "start")


def mutants(content):
    """Yield every replacement of every leaf and node, and every swap, with their number."""
    count = itertools.count()
    for path in nodes(content):
        for new in replacements(content, path):
            number = next(count)
            if not (idle(path) and number % 10):
                mutant = put(content, path, new)
                if mutant != content:
                    yield number, mutant
    yield from zip(itertools.count(0, 3), swaps(content), strict=False)


def remade(mutant, *, cunning=False):
    """Return a copy with hashes and statement made anew; cunning: and all that follows from else.

    Where the checker itself has no statement for it, the old one stays.
    """
    forged = copy.deepcopy(mutant) if cunning else copy.copy(mutant)
    if cunning:
        try:
            if forged["region"]["box"] is None:
                forged["region"]["eigenvalues"] = forged["mission"]["bounds"]["eigenvalues"]
            mass = F(forged["mission"]["vehicle"]["mass"])
            for vertex, f in zip(forged["vertices"], forged["enclosures"]["factor"], strict=True):
                vertex["factor"] = f
            lowest = min((v["margin"] for v in forged["vertices"]), key=F)
            forged["claim"]["margin"] = lowest
            for part in [forged["claim"], *forged["vertices"]]:
                part["decay_rate"] = str(2 * F(part["margin"]) / mass)
        except (KeyError, ValueError, TypeError, ZeroDivisionError):
            pass
    try:
        forged["mission_sha256"] = checker.digest(forged["mission"])
        forged["statement"] = checker.statement(forged)
    except (checker.Rejected, KeyError, TypeError):
        pass
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    return forged


# --- what is true -------------------------------------------------------------------------------


def floats(values):
    if isinstance(values, list):
        return np.array([floats(v) for v in values])
    return float(F(values))


class Truth:
    """The mission of an accepted certificate in floating point, read without the checker."""

    def __init__(self, content):
        self.content = content
        mission = content["mission"]
        self.gains = [floats(mission["gains"][k]) for k in ("k1", "k2", "k3", "k4")]
        self.m = floats(mission["vehicle"]["mass"])
        self.w = floats(content.get("weights", ["1"] * 4))
        self.points = floats(mission["target"]["points"])
        if "height" in mission["goal"]:
            rays = self.points - floats(content["goal_position"])
            self.q = (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)
        else:
            self.q = floats(mission["goal"]["centroid"])
        self.eigenvalues = floats(content["region"]["eigenvalues"])

    @functools.cached_property
    def f(self):
        """The ends of f(T), 1/m; a claim about Q alone has nothing to do with it."""
        k1, k2, k3, _ = self.gains
        mission = self.content["mission"]
        weight, bounds = self.m * floats(mission["vehicle"]["gravity"]), mission["bounds"]
        if "thrust" in bounds:
            thrust = floats(bounds["thrust"])
        else:
            spread = np.sqrt(2 * floats(bounds["level"]) * (1 / self.w[1] + 1 / self.w[2]))
            thrust = weight + np.array([-1, 1]) * k1**2 * k2 / self.m * spread
        assert thrust[0] <= weight * (1 + ROUNDING)
        assert weight <= thrust[1] * (1 + ROUNDING)
        singular = k1**2 * k2 / self.m * self.q[2]
        assert thrust[0] > singular
        return k1 * k2 * (k1 * k2 + k3) / (self.m * (thrust[::-1] - singular))

    def sigma(self, f, Q):
        """Return Σ, from the equations of the δs."""
        k1, k2, k3, k4 = self.gains
        d1, d2, d3, d4 = np.eye(12)[:, :11].reshape(4, 3, 11)
        A = self.q[2] * np.eye(3) - np.outer([0, 0, 1], self.q)
        flow, turn = k1 * Q @ (d1 + d2), k1 * f * A @ (d4 - d3)
        rows = [
            -flow + turn,
            flow - k1 * k2 * d2 + k1 * k2 * d3 - turn,
            flow - k1 * k2 * d2 + (k1 * k2 + k3) * d4 - k3 * d3,
            (flow - (k1 * k2 + k3) * d3 - k4 * d4)[:2],
        ]
        B = np.repeat(self.w, [3, 3, 3, 2])[:, None] * np.concatenate(rows)
        return -(B + B.T) / 2

    def worst(self, turns=12):
        """Return the lowest eigenvalue of W^(-½) Σ W^(-½) found, and the size of that matrix."""
        root = np.sqrt(np.repeat(self.w, [3, 3, 3, 2]))
        (low, high), rng = self.eigenvalues, np.random.default_rng(0)
        lowest, size = np.inf, 0.0
        for f, _ in itertools.product(self.f, range(2)):
            w = rng.normal(size=3)
            for _ in range(turns):
                w /= np.linalg.norm(w) + 1e-300
                Q = high * np.eye(3) - (high - low) * np.outer(w, w)
                values, vectors = np.linalg.eigh(self.sigma(f, Q) / np.outer(root, root))
                lowest, size = min(lowest, values[0]), max(size, np.abs(values).max())
                d1, d2, d3 = (vectors[:9, 0] / root[:9]).reshape(3, 3)
                d4 = np.append(vectors[9:, 0] / root[9:], 0)
                u, v = self.w @ np.array([d1, -d2, -d3, -d4]), d1 + d2
                w = u / (np.linalg.norm(u) + 1e-300) + v / (np.linalg.norm(v) + 1e-300)
        return lowest, size

    def gains_hold(self):
        margin = floats(self.content["claim"]["margin"])
        worst, size = self.worst()
        assert 0 < margin <= worst + 1e-13 * size
        rate = floats(self.content["claim"]["decay_rate"])
        assert rate == pytest.approx(2 * margin / self.m)
        if self.content["region"]["box"] is None:
            bounds = self.content["mission"]["bounds"]
            assert self.content["region"]["eigenvalues"] == bounds["eigenvalues"]
        else:
            self.region_holds()

    def region_holds(self):
        low, high = floats(self.content["region"]["box"]).T
        assert (low <= high).all()
        share = np.random.default_rng(0).random((500, 3))
        share[:8] = list(itertools.product((0, 1), repeat=3))
        rays = self.points - (low + (high - low) * share)[:, None]
        r = np.linalg.norm(rays, axis=2)[..., None, None]
        p = rays[..., None] / r
        values = np.linalg.eigvalsh(((np.eye(3) - p * p.swapaxes(2, 3)) / r).sum(axis=1))
        assert self.eigenvalues[0] <= values.min() * (1 + ROUNDING)
        assert values.max() <= self.eigenvalues[1] * (1 + ROUNDING)

    def outside_holds(self):
        spot = self.content["outside"]
        position = floats(spot["position"])
        low, high = floats(self.content["region"]["box"]).T
        assert (low - ROUNDING <= position).all()
        assert (position <= high + ROUNDING).all()
        rays = self.points - position
        r = np.linalg.norm(rays, axis=1)[:, None, None]
        p = rays[..., None] / r
        values = np.linalg.eigvalsh(((np.eye(3) - p * p.swapaxes(1, 2)) / r).sum(axis=0))
        if spot["bound"] == "lower":
            assert values[0] <= self.eigenvalues[0] + ROUNDING * values[2]
        else:
            assert values[2] >= self.eigenvalues[1] * (1 - ROUNDING)

    def counterexample_holds(self):
        point = self.content["counterexample"]
        Q, X, f, value = (floats(point[k]) for k in ("Q", "X", "f", "value"))
        assert (Q == Q.T).all()
        values = np.linalg.eigvalsh(Q)
        assert self.eigenvalues[0] <= values[0] + ROUNDING * values[2]
        assert values[2] <= self.eigenvalues[1] * (1 + ROUNDING)
        assert self.f[0] * (1 - ROUNDING) <= f <= self.f[1] * (1 + ROUNDING)
        scale = np.abs(X) @ np.abs(self.sigma(f, Q)) @ np.abs(X)
        assert X @ self.sigma(f, Q) @ X <= value + 1e-13 * scale
        assert value < 0

    def holds(self):
        holds = {
            "gains": self.gains_hold,
            "region": self.region_holds,
            "outside": self.outside_holds,
            "counterexample": self.counterexample_holds,
        }
        holds[self.content["kind"]]()


# --- the trial ----------------------------------------------------------------------------------


def tried(mutant, tally):
    """Check one mutant; whatever is accepted must be true, and nothing else may be raised."""
    began = time.process_time()
    try:
        theorem = checker.check(mutant)
    except (checker.Rejected, checker.Unreadable):
        theorem = None
    took = time.process_time() - began
    tally["mutants"] += 1
    tally["slowest, ms"] = max(tally["slowest, ms"], int(1000 * took))
    assert took < SLOWEST
    if theorem is not None:
        tally["accepted"] += 1
        assert theorem == mutant["statement"]
        Truth(mutant).holds()


STEP = 4  # of so many mutants one gets its hashes made anew: reading it takes far longer


@pytest.mark.parametrize("name", LEAST)
def test_each_certificate_itself_is_accepted_and_true(certificates, name):
    tally = Counter()
    tried(certificates[name], tally)
    assert tally["accepted"] == 1


def is_about(content):
    """Tell whether the statement names each target point and the hash of the mission's numbers."""
    points = ", ".join(f"({', '.join(p)})" for p in content["mission"]["target"]["points"])
    said = content["statement"]
    return f"points are {points} m" in said and checker.digest(content["mission"]) in said


def with_another_key(content):
    """Yield copies with one key more in one of the objects, however deep, hashes made anew."""
    for path in [(), *nodes(content)]:
        if isinstance(at(content, path), dict):
            mutant = copy.deepcopy(content)
            at(mutant, path)["extra"] = "1"
            yield path, remade(mutant)


@pytest.mark.parametrize("name", LEAST)
def test_each_statement_names_the_target_and_the_mission(certificates, name):
    assert is_about(certificates[name])
    other = put(certificates[name], ("statement",), "It is about another mission.")
    with pytest.raises(checker.Rejected, match="not what is proved"):
        checker.check(other | {"sha256": sealed(other)})


def sealed(content):
    return checker.digest({k: v for k, v in content.items() if k != "sha256"})


@pytest.mark.parametrize("name", LEAST)
def test_an_unknown_key_is_refused_however_deep_it_is(certificates, name):
    found = set()
    for path, mutant in with_another_key(certificates[name]):
        found.add(path)
        with pytest.raises(checker.Rejected, match="must have the keys"):
            checker.check(mutant)
    assert {(), ("tools",), ("mission", "start"), ("mission", "bounds")} <= found


@pytest.mark.parametrize(
    ("worse", "name"),
    [
        (("claim", "margin", "1/10"), "gains"),
        (("region", "eigenvalues", ["1/10", "5"]), "region"),
        (("region", "eigenvalues", ["1/1000", "1/10"]), "gains over box"),
        (("counterexample", "value", "-1000"), "counterexample"),
        (("outside", "bound", "upper"), "outside"),
    ],
    ids=lambda value: value if isinstance(value, str) else value[1],
)
def test_the_truth_of_this_file_tells_a_false_claim(certificates, worse, name):
    with pytest.raises(AssertionError):
        Truth(put(certificates[name], worse[:2], worse[2])).holds()


@pytest.mark.slow
@pytest.mark.parametrize("name", LEAST)
def test_no_mutant_is_accepted_unless_true(certificates, name, whole):
    """Each has its own share of the mutants, a quarter; in `make trials` all of them."""
    content, tally, began = certificates[name], Counter(), time.perf_counter()
    share = None if whole else [*LEAST].index(name) % SHARES
    for number, mutant in mutants(content):
        if share is not None and number // STEP % SHARES != share:
            continue
        tried(mutant, tally)
        if number % STEP:
            continue
        skilful = remade(mutant)
        tried(skilful, tally)
        cunning = remade(mutant, cunning=True)
        if cunning != skilful:
            tried(cunning, tally)
    print(f"{name}:", dict(tally), f"{time.perf_counter() - began:.0f} s")
    assert tally["mutants"] >= (LEAST[name] if share is None else LEAST[name] / SHARES)


def test_the_mutants_number_eighteen_thousand_and_a_quarter_of_them_in_a_part():
    assert sum(LEAST.values()) >= 18_000


@pytest.mark.parametrize("depth", [10, 900, 1100, 100_000])
@pytest.mark.parametrize("key", ["tools", "mission", "weights", "kind", "sha256"])
def test_a_file_nested_deep_is_refused(certificates, key, depth):
    text = json.dumps({**certificates["gains"], key: "@"})
    Path("deep.json").write_text(text.replace('"@"', "[" * depth + "]" * depth))
    with pytest.raises((checker.Rejected, checker.Unreadable)):
        checker.check_file("deep.json")
