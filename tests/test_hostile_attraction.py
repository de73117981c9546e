"""Hostile certificates of regions of attraction: rejected, or what they say is true."""

from __future__ import annotations

import contextlib
import copy
import itertools
import time
from collections import Counter
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hoverproof import checker
from hoverproof.certification.attraction.proof import attraction, estimate, prove
from hoverproof.certification.attraction.refutation import refute
from hoverproof.certification.attraction.search import SLACKS
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.verdict import Undecided
from hoverproof.mission.reading import load
from sampling import mostly_whole
from sharing import kept_value
from test_hostile import floats, is_about, mutants, put, with_another_key

F = Fraction
STEP = 10
"""Of so many mutants one gets its hashes made anew, of half as many in `make trials`: to read them
takes far longer."""
NAMES = ("barrier", "no barrier")
ENOUGH = 6.0  # s; 2 s on a machine with nothing else to do


def remade(mutant):
    """Return a copy with hashes and statement made anew where the checker has a statement."""
    forged = copy.copy(mutant)
    try:
        if forged["mission"]["goal"].get("height") and "hover" in forged:
            forged["hover"] = forged["goal_position"]
        if "motion" in forged:
            time = str(sum(map(F, forged["motion"]["steps"])))
            forged["motion"] = {**forged["motion"], "time": time}
        forged["mission_sha256"] = checker.digest(forged["mission"])
        forged["statement"] = checker.statement(forged)
    except (checker.Rejected, ArithmeticError, KeyError, TypeError, ValueError, AttributeError):
        pass
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    return forged


def claiming_less(content, **claim):
    """Return a certificate that claims less than it could, so that many mutants stay true."""
    less = copy.deepcopy(content)
    less["claim"] |= {"rate": str(F(content["claim"]["rate"]) / 2), **claim}
    less["enclosures"]["tilt"] = str(F(content["enclosures"]["tilt"]) * F(1001, 1000))
    return remade(less)


@pytest.fixture(scope="module")
def certificates():
    return kept_value("hostile attraction", made_whole)


@pytest.fixture(scope="module")
def short():
    return kept_value("hostile attraction, short", made_short)


def made_whole():
    """Certificates whose trees are those of all that is proved."""
    found, reach = {}, {"sideways": "1/2", "up": "1/2", "down": "1/2"}
    for name, barrier in (("barrier", True), ("no barrier", False)):
        asked = {"objective": "start"} if barrier else {"objective": "radius"}
        region = attraction(load("x4-flyer"), barrier=barrier, **asked)
        found[name] = claiming_less(region.certificate.content, reach=reach)
    return found


def made_short():
    """The same certificates of four fifths of their reach, to be seen from far fewer cells."""
    mission, found = load("x4-flyer"), {}
    for name, barrier in (("barrier", True), ("no barrier", False)):
        asked = {"objective": "start"} if barrier else {"objective": "radius"}
        starts = [Start.of(mission)] if barrier else []
        numbers = estimate(mission, barrier=barrier, **asked)
        region = prove(mission, numbers, starts, replace(SLACKS[0], reach=0.2))
        found[name] = claiming_less(region.certificate.content)
    return found


class Truth:
    """An accepted certificate in floating point, read without the checker."""

    def __init__(self, content):
        self.content = content
        mission, claim = content["mission"], content["claim"]
        self.k1, self.k2, self.k3, self.k4 = (
            floats(mission["gains"][k]) for k in ("k1", "k2", "k3", "k4")
        )
        self.m = floats(mission["vehicle"]["mass"])
        self.weight = self.m * floats(mission["vehicle"]["gravity"])
        self.c = self.k1**2 * self.k2 / self.m
        self.points, self.hover = floats(mission["target"]["points"]), floats(content["hover"])
        q = self.seen(self.hover)
        self.q3 = q[2]
        assert np.abs(q[:2]).max() < 1e-9
        if "height" in mission["goal"]:
            plane = self.points[:, 2].mean()
            assert plane - self.hover[2] == pytest.approx(floats(mission["goal"]["height"]))
        self.a, self.level = floats(content["weights"]), floats(claim["level"])
        self.rate, self.reach = floats(claim["rate"]), claim["reach"]
        self.high = floats(content["enclosures"]["largest_eigenvalue"])
        height = claim["barrier_height"]
        self.bottom = None if height is None else self.points[:, 2].mean() - floats(height)
        self.force = self.c * np.sqrt(2 * self.level * (1 / self.a[0] + 1 / self.a[1]))
        assert self.weight - self.force > self.c * self.q3

    def seen(self, x):
        rays = self.points - x
        return (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)

    def W(self, x):
        def raw(y):
            return np.linalg.norm(self.points - y, axis=1).sum() + self.q3 * y[2]

        return raw(np.asarray(x)) - raw(self.hover)

    def depths(self, x):
        rays = self.points - x
        r = np.linalg.norm(rays, axis=1)[:, None, None]
        p = rays[..., None] / r
        return ((np.eye(3) - p * p.swapaxes(1, 2)) / r).sum(axis=0)

    def form(self, Q, f, theta):
        """Return the matrices of -(m/k1) Λ' in Y, of each Q, from the equations of the δs."""
        e, d2, d3, d4 = np.eye(12)[:, :11].reshape(4, 3, 11)
        P = np.diag([1.0, 1, 0])
        lean = P - np.outer([0, 0, 1], [*theta, 0])
        v = e + self.q3 * self.c / self.weight * lean @ (d3 - d2) + d2
        k12, turn = self.k1 * self.k2, self.k1 * f * self.q3 * P @ (d4 - d3)
        flow = self.k1 * Q @ v
        r2 = flow - k12 * d2 + k12 * d3 - turn
        r3 = flow - k12 * d2 + (k12 + self.k3) * d4 - self.k3 * d3
        r4 = P @ (flow - (k12 + self.k3) * d3) - self.k4 * d4
        pairs = ((self.a[0], d2, r2), (self.a[1], d3, r3), (self.a[2], d4, r4))
        B = e.T @ v - sum(w * d.T @ r for w, d, r in pairs) / self.k1
        return (B + B.swapaxes(-1, -2)) / 2

    def hover_energy(self, x):
        d1 = self.seen(np.asarray(x)) - [0, 0, self.q3]
        a2, a3, a4 = self.a
        return self.W(x) + ((a2 + a3) * d1 @ d1 + a4 * d1[:2] @ d1[:2]) / 2

    def holds(self):
        rng = np.random.default_rng(0)
        sine = self.force / self.weight
        t = sine / (1 + np.sqrt(1 - sine**2))
        k12 = self.k1 * self.k2
        factors = [
            k12 * (k12 + self.k3) / (self.m * (self.weight + s * self.force - self.c * self.q3))
            for s in (1, -1)
        ]
        near = np.vstack([p + rng.normal(size=(40, 3)) * 0.4 for p in self.points])
        places = np.vstack([near, self.hover + rng.normal(size=(60, 3)) * 2])
        if self.bottom is not None:
            places[:, 2] = np.minimum(places[:, 2], self.bottom)
        Q = np.array([self.depths(x) for x in places if self.W(x) <= self.level])
        if len(Q):
            assert np.linalg.eigvalsh(Q).max() <= self.high * (1 + 1e-9)
            for f, sign in itertools.product(factors, (1, -1)):
                values = np.linalg.eigvalsh(self.form(Q, f, [sign * t, 0]))
                rounding = 1e-12 * np.abs(values).max(axis=1)
                assert (values[:, 0] >= self.rate * (1 - 1e-9) - rounding).all()
        self.starts_hold(rng)
        if self.bottom is not None:
            self.barrier_holds(sine)

    def starts_hold(self, rng):
        side, up, down = (floats(self.reach[k]) for k in ("sideways", "up", "down"))
        assert min(side, up, down) >= 0
        angles = rng.uniform(0, 2 * np.pi, 20)
        places = [self.hover + side * np.array([np.cos(b), np.sin(b), 0]) for b in angles]
        places += [self.hover + np.array([0, 0, z]) for z in (-up, down)]
        for start in self.content["claim"]["starts"]:
            low, high = floats(start["position"]).T
            assert (low <= high).all()
            places += [low + (high - low) * share for share in rng.random((10, 3))]
        for x in places:
            assert self.hover_energy(x) <= self.level * (1 + 1e-9)
            assert self.bottom is None or x[2] <= self.bottom + 1e-9
        for start in self.content["claim"]["starts"]:  # a fast start is not in slow sets
            speed = floats(start["speed"]) * self.m / self.k1
            assert self.a[0] * speed**2 / 2 <= self.level + 2 * self.a[0] * speed * len(self.points)

    def barrier_holds(self, sine):
        assert self.k3 >= 3 * self.k1 * self.k2 * (1 - 1e-12)
        gain = self.c * self.q3 / (self.weight - self.force - self.c * self.q3)
        spread = np.sqrt(2 * self.level * ((1 + gain) ** 2 / self.a[2] + gain**2 / self.a[1]))
        omega = self.q3 * (1 - np.sqrt(1 - sine**2)) + sine * spread
        z = self.bottom - (len(self.points) - self.q3 + omega) / self.k2
        over = np.vstack([self.points[:, :2], self.hover[:2]])
        grid = np.stack(np.meshgrid(*[np.linspace(-1.5, 1.5, 31)] * 2), axis=-1).reshape(-1, 2)
        for x, y in np.vstack([over, grid]):
            assert self.seen(np.array([x, y, z]))[2] <= self.q3 - omega + 1e-9


def tried(mutant, tally, truth=Truth):
    """Check one mutant; whatever is accepted must be true, and nothing else may be raised."""
    try:
        theorem = checker.check(mutant)
    except (checker.Rejected, checker.Unreadable):
        theorem = None
    tally["mutants"] += 1
    if theorem is not None:
        tally["accepted"] += 1
        assert theorem == mutant["statement"]
        truth(mutant).holds()


def refuses_more_keys(content):
    for _, mutant in with_another_key(content):
        with pytest.raises(checker.Rejected, match="must have the keys"):
            checker.check(mutant)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_statement_names_the_target_and_says_what_it_knows_of_the_ground(short, name):
    content = short[name]
    assert is_about(content)
    assert ("knows no ground" in content["statement"]) is (name == "no barrier")
    refuses_more_keys(content)


def crowded(content):
    """Return it with as many starts as there may be, each all but as wide as what is proved."""
    crowd = copy.deepcopy(content)
    x, y, z = (F(c) for c in content["hover"])
    side = F(content["claim"]["reach"]["sideways"]) * F(7, 5)
    box = [[str(c - side), str(c + side)] for c in (x, y)]
    still = dict.fromkeys(("speed", "tilt", "rate", "thrust"), "0")
    crowd["claim"]["starts"] = [{"position": [*box, [str(z), str(z)]], **still}] * 16
    disc, line = content["trees"]["starts"][:2]
    crowd["trees"]["starts"] = [disc, line, *[disc] * 16]
    return remade(crowd)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("share", [F(9, 10), F(999, 1000)])
def test_a_region_that_asks_for_much_is_soon_answered(certificates, name, share):
    hints = certificates[name]["enclosures"]
    sharp = str(F(hints["largest_eigenvalue"]) * share)
    for content in (
        crowded(certificates[name]),
        remade(put(certificates[name], ("enclosures", "largest_eigenvalue"), sharp)),
    ):
        began = time.process_time()
        with contextlib.suppress(checker.Rejected):
            checker.check(content)
        assert time.process_time() - began < ENOUGH


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "worse",
    [
        ("claim", "rate", "2"),
        ("enclosures", "largest_eigenvalue", "1/2"),
        ("claim", "reach", {"sideways": "1", "up": "1", "down": "3"}),
        ("claim", "level", "1/1000"),
    ],
    ids=lambda worse: worse[1],
)
def test_the_truth_of_this_file_tells_a_false_claim(certificates, worse, name):
    Truth(certificates[name]).holds()
    with pytest.raises(AssertionError):
        Truth(put(certificates[name], worse[:2], worse[2])).holds()


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_no_mutant_is_accepted_unless_true(short, name, whole):
    content, tally = short[name], Counter()
    tried(content, tally)
    assert tally["accepted"] == 1
    for number, mutant in mutants(content):
        if number % (2 if whole else 8) == 0:
            tried(mutant, tally)
        if number % (STEP // 2 if whole else 2 * STEP) == 0:
            tried(remade(mutant), tally)
    print(f"{name}:", dict(tally))
    assert tally["accepted"] > (20 if whole else 10)
    assert tally["mutants"] >= (1200 if whole else 350)


# --- motions that sink --------------------------------------------------------------------------

FALLING = {"start": "{position = [0.1, 0.2, -0.2], velocity = [0.1, 0, 1.5]}"}


class Sunk:
    """An accepted motion in floating point, from the error chain, read without the checker."""

    def __init__(self, content):
        mission, motion = content["mission"], content["motion"]
        k1, k2, k3, k4 = (floats(mission["gains"][k]) for k in ("k1", "k2", "k3", "k4"))
        m, g = (floats(mission["vehicle"][k]) for k in ("mass", "gravity"))
        self.points, self.time = floats(mission["target"]["points"]), floats(motion["time"])
        sides = [floats(motion[k]) for k in ("position", "velocity", "axis", "turning")]
        sides.append(floats(motion["thrust"])[None])
        self.low, self.high = np.vstack(sides).T
        if "height" in mission["goal"]:
            hover = floats(content["goal_position"])
            rays = self.points - hover
            self.q3 = (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)[2]
        else:
            self.q3 = floats(mission["goal"]["centroid"])[2]
        self.m, self.g, self.c, self.k1 = m, g, k1**2 * k2 / m, k1
        self.k12, self.K, self.k4 = k1 * k2, k1 * k2 + k3, k4

    def errors(self, z):
        """Return q, δ2, δ3 and T b - c q* in world axes."""
        x, v, b, T = z[:3], z[3:6], z[6:9], z[12]
        rays = self.points - x
        q = (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)
        d2 = self.m / self.k1 * v - (q - self.q3 * b)
        return q, d2, (self.m * self.g * np.array([0, 0, 1]) - T * b) / self.c + d2

    def rate(self, _, z):
        """Differentiate δ4 = Pδ3 - ((T - c q3*)/(c κ)) b' numerically; no closed form of b''."""
        v, b, w, T = z[3:6], z[6:9], z[9:12], z[12]
        D, kappa = T - self.c * self.q3, self.K / self.m
        _, d2, d3 = self.errors(z)
        across = np.eye(3) - np.outer(b, b)
        d4 = across @ d3 - D / (self.c * kappa) * w
        rays = self.points - z[:3]
        r = np.linalg.norm(rays, axis=1)[:, None]
        flow = (v / r - rays * (rays @ v)[:, None] / r**3).sum(axis=0)  # Q v
        d4_rate = across @ (flow - kappa * d3) - self.k4 / self.m * d4 - (w @ d4) * b
        d2_rate = flow + (self.c / self.k1) * (d3 - d2) + self.q3 * w
        acceleration = (self.c / self.m) * (d3 - d2)
        d3_rate = flow + (self.K * (d4 - d3) + self.k12 * (d3 - d2)) / self.m
        jerk = (self.c / self.m) * (d3_rate - d2_rate)
        T_rate = -self.m * jerk @ b
        wanted = across @ d3_rate - (w @ d3) * b - (b @ d3) * w - d4_rate
        w_rate = (self.c * kappa * wanted - T_rate * w) / D
        return np.concatenate([v, acceleration, w, w_rate, [T_rate]])

    def holds(self):
        """Fly from corners and the middle."""
        rng, flown_from = np.random.default_rng(0), 0
        assert self.time > 0
        for share in (0.5, *(rng.integers(0, 2, 13) for _ in range(2))):
            z = self.low + share * (self.high - self.low)
            z[6:9] /= np.linalg.norm(z[6:9])  # of a box, only unit vectors are meant
            if not ((self.low - 1e-9 <= z) & (z <= self.high + 1e-9)).all():
                continue
            assert z[12] > self.c * self.q3
            assert z[2] < self.points[:, 2].max()
            flown = solve_ivp(self.rate, (0, self.time), z, rtol=1e-9, atol=1e-11)
            assert flown.success
            assert (flown.y[12] > self.c * self.q3).all()
            assert flown.y[2, -1] >= self.points[:, 2].max() - 1e-7
            flown_from += 1
        assert flown_from  # the start is not empty


@pytest.fixture(scope="module")
def motions():
    """Motions followed a little longer than needed, so that many mutants stay true."""
    exact = load("x4-flyer", FALLING)
    found = {"state": refute(exact, None, Undecided(mission=exact, reason="")).certificate.content}
    wide = copy.deepcopy(found["state"])
    for name in ("position", "velocity"):
        wide["motion"][name] = [[str(F(a) - F(1, 10**4)), a] for a, _ in wide["motion"][name]]
    wide["motion"]["steps"] += ["1/100"]
    found["box"] = remade(wide)
    return found


@pytest.mark.parametrize("worse", [("time", "1/100"), ("velocity", [["0", "0"]] * 3)])
def test_the_truth_about_motions_tells_a_false_claim(motions, worse):
    Sunk(motions["state"]).holds()
    with pytest.raises(AssertionError):
        Sunk(put(motions["state"], ("motion", worse[0]), worse[1])).holds()


def test_a_statement_of_a_motion_names_the_target_and_the_mission(motions):
    assert is_about(motions["box"])
    refuses_more_keys(motions["box"])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "k3"), mostly_whole(itertools.product([2, 4, 64], ["61/2", "100000"]), every=3)
)
def test_a_motion_without_an_end_is_soon_given_up(motions, points, k3):
    content = copy.deepcopy(motions["state"])
    ring = [2 * np.pi * k / points for k in range(points)]
    places = [[str(F(round(100 * c), 100)) for c in (np.cos(a), np.sin(a))] for a in ring]
    content["mission"]["target"]["points"] = [[*place, "0"] for place in places]
    content["mission"]["goal"] = {"centroid": ["0", "0", str(F(points) * F(9, 10))]}
    content["mission"]["gains"] |= {"k1": "1/20", "k3": k3}
    content["goal_position"] = None
    content["motion"]["position"] = [["0", "0"]] * 2 + [["-3", "-3"]]
    content["motion"]["steps"] = ["1/16"] * (checker.MAX_STEPS // (points + 3))
    content["motion"]["velocity"] = [["0", "0"]] * 3
    began = time.process_time()
    with pytest.raises(checker.Rejected, match=r"not followed to its end|not shown to sink"):
        checker.check(remade(content))
    assert time.process_time() - began < ENOUGH


@pytest.mark.slow
@pytest.mark.parametrize("name", ["state", "box"])
def test_no_mutant_of_a_motion_is_accepted_unless_true(motions, name, whole):
    content, tally = motions[name], Counter()
    tried(content, tally, Sunk)
    assert tally["accepted"] == 1
    for number, mutant in mutants(content):
        if whole or number % 6 == 0:
            tried(mutant, tally, Sunk)
        if number % (STEP // 2 if whole else 2 * STEP) == 0:
            tried(remade(mutant), tally, Sunk)
    print(f"{name}:", dict(tally))
    assert tally["accepted"] > (20 if whole else 10)
    assert tally["mutants"] >= (2000 if whole else 400)
