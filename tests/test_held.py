"""A controller that runs in steps, an accelerometer that lags: proved, flown, forged."""

from __future__ import annotations

from fractions import Fraction as F

import numpy as np
import pytest

import hoverproof as hp
import uncertain_body as kit
from exponential_truth import MISSION, NEAR, soon_found
from hoverproof import checker
from hoverproof.certification.exponential import proof
from hoverproof.certification.exponential.held import moved
from hoverproof.certification.exponential.inequality import HOLD, Ball, falls
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.mission.reading import load
from sampling import mostly_whole
from sharing import kept_value
from test_hostile_exponential import changed, larger
from uncertain_body import Case, View, dot, size
from uncertain_flights import Nature, hovers

CASES = {
    "steps": {"control_period": "0.004", "wind": "0"},
    "image": {"control_period": "0.003", "force_lag": "0.004", "wind": "0"},
    "both": {"control_period": "0.003", "force_lag": "0.01", "wind": "0.1"},
    "low-pass": {"force_lag": "0.02", "wind": "0", "latency": "0"},
}


def mission(name, **more):
    keys = {f"uncertainty.{key}": value for key, value in CASES[name].items()}
    goal = {"law.goal": "image", "uncertainty.thrust": "0.1"} if name == "image" else {}
    return load(MISSION, NEAR | goal | keys | more)


@pytest.fixture(scope="module", params=mostly_whole(CASES, every=2))
def proved(request):
    with soon_found():
        found = kept_value(("held", request.param), lambda: proof.converge(mission(request.param)))
    assert found.status == "proved", found.reason
    return found


# --- what is said ---------------------------------------------------------------------------------


def test_it_is_proved_and_said(proved):
    may, said = proved.mission.uncertainty, checker.check(proved.certificate.content)
    period, lag = may.control_period, may.force_lag
    assert (f"runs at least every {checker.about(period)} s" in said) == (period > 0)
    assert (f"one constant time of at most {checker.about(lag)} s, settled" in said) == (lag > 0)
    assert ("In continuous time" in said) == (period == 0)
    covers = proved.mission.asks_to_cover()
    assert ("control period up to" in str(covers)) == (period > 0)
    assert ("low-pass of the force up to" in str(covers)) == (lag > 0)
    assert (proved.ultimate_radius is not None) == bool(lag and may.wind)


def test_a_mission_without_them_has_the_hash_it_had():
    told = mission("steps", **{"uncertainty.control_period": "0"}).exact()["uncertainty"]
    assert not {"control_period", "force_lag"} & set(told)
    assert mission("both").exact()["uncertainty"]["force_lag"] == "1/100"


@pytest.mark.parametrize("key", ["control_period", "force_lag"])
def test_they_go_with_rotors_that_lag_and_images_that_are_turned(key):
    change = {f"uncertainty.{key}": "0.001"}
    with pytest.raises(hp.InputError, match=f"{key}: is proved for rotors that lag"):
        load(MISSION, change | {"uncertainty.rotor_lag": "0"})
    with pytest.raises(hp.InputError, match="turned to the present axes"):
        load(MISSION, change | {"sensors.gyro_turned": "false"})


# --- checker and search ---------------------------------------------------------------------------


class Held:
    """A certificate, and its numbers as the checker and as the search have them."""

    def __init__(self, found):
        self.content = found.certificate.content
        self.case, self.claim = Case(self.content), checker.claim_of(self.content)
        self.vehicles = Vehicles.of(found.mission)
        reach = Reach.of(self.case.w[1:], self.case.level)
        self.limits = Limits(self.vehicles, reach, self.case.slope)
        self.weights = {k: float(x) for k, x in vars(self.claim.hold).items()}
        each = self.claim.changes()
        self.radii = {k: [float(r) for _, r in v] for k, (_, v, _) in each.items()}
        self.factors = {k: float(x) for k, (*_, x) in each.items()}


def test_search_and_checker_bound_what_is_held_alike(proved):
    held = Held(proved)
    claim, limits = held.claim, held.limits
    own = {
        **{"missed": limits.ahead, "sunk": limits.sunk, "stray": limits.stray},
        **{"turning": limits.turning, "wobble": limits.misled[0], "noise": limits.missed},
    }
    for name, value in own.items():
        assert float(getattr(claim, name)) == pytest.approx(value, rel=1e-6), name
    radii = {k: [r for _, r in v if r] for k, v in moved(limits).items()}
    assert held.radii == {k: pytest.approx(v, rel=1e-6) for k, v in radii.items()}


def test_the_graphs_form_is_the_checkers(proved):
    """Both write the inequality: their eigenvalues, diagonals brought to 1, are the same."""
    held, c = Held(proved), proved.certificate.content
    low, high = map(F, c["domain"]["bounds"])
    ball = Ball(float(low + high) / 2, float(high - low) / 2)
    posed = falls(held.limits, ball, held.case.r)
    shaken = [name for name, _ in held.limits.disturbances()]
    numbers = [1.0, *held.case.w[1:], held.case.a5, held.case.a6]
    numbers += [float(F(c["multipliers"]["slope"]))] + ([held.case.M] if c["memory"] else [])
    numbers += [float(F(c["multipliers"][name])) for name in shaken]
    numbers += [held.weights[name] for name in moved(held.limits)]
    terms = np.array([float(F(t)) for t in c["multipliers"]["terms"]])
    whole = posed.bound(np.array(numbers), terms)
    corners = list(held.claim.vertices())
    assert len(corners) == len(whole)
    for matrix, at in zip(whole, corners, strict=True):
        theirs = _spectrum(_matrix(held.claim.decrease(*at), held.claim.size))
        assert _spectrum(matrix) == pytest.approx(theirs, abs=1e-6)
    assert set(HOLD) >= set(moved(held.limits))


def _matrix(form, n):
    at = np.zeros((n, n))
    for (i, j), x in form.items():
        at[i, j] += float(x) / 2
        at[j, i] += float(x) / 2
    return at


def _spectrum(matrix):
    scale = np.sqrt(np.diag(matrix))
    return tuple(np.linalg.eigvalsh(matrix / np.outer(scale, scale)))


MORE = {
    **{("mission", "uncertainty", key): larger(3) for key in ("control_period", "force_lag")},
    **{("hold", key): larger(s) for key in ("level", "lift", "command") for s in (F(1, 10**4),)},
    ("hold",): None,
    ("claim", "rate"): larger(300),
}


def test_what_claims_more_is_rejected(proved):
    content, tried = proved.certificate.content, 0
    for path, new in MORE.items():
        at = content
        for key in path:
            at = at.get(key) if isinstance(at, dict) else None
        if at is None:
            continue
        with pytest.raises(checker.Rejected):
            checker.check(changed(content, path, new))
            pytest.fail(str(path))
        tried += 1
    assert tried > 2


@pytest.mark.parametrize("key", ["control_period", "force_lag"])
def test_what_is_held_needs_its_weights(key, proved):
    content = proved.certificate.content
    new = ("hold",), None
    if key not in content["mission"]["uncertainty"]:
        new = ("mission", "uncertainty", key), "1/1000"
        if content["hold"] is not None and "level" in content["hold"]:
            return  # the low-pass has the weight that the period has
    with pytest.raises(checker.Rejected, match="weights of what is held belong to it"):
        checker.check(changed(content, *new))


# --- flights of an independent body ---------------------------------------------------------------


class Holding(View):
    """A view whose controller has run some time ago."""

    held = None

    def commanded(self, level):
        return self.held


class Flight:
    """Bodies under a controller that runs now and then, with an accelerometer that lags.

    At each step it knows what was asked for, and the integrals that the proof is about.
    """

    def __init__(self, held, rng, count, step):
        case, may = held.case, held.claim
        self.known, self.case, self.rng, self.step, self.count = held, case, rng, step, count
        self.period, self.slow = float(may.period), float(may.slow)
        nature = Nature(case, rng, count, step, 0)
        self.doubt = nature.doubt
        self.doubt.lag = case.rotor_lag * rng.choice([0.5, 1, 1], count)
        self.doubt.gain = 1 + case.thrust * rng.choice([-1.0, 1.0], count)
        self.doubt.yaw = case.yaw_rate * rng.choice([-1.0, 0.0, 1.0], count)
        start = np.tile(np.reshape(case.start, (3, 1)), count)
        self.x, self.time, self.age = hovers(case, rng, self.doubt, start), 0.0, np.inf
        view = View(case, self.x, self.doubt)
        self.felt = view.felt.copy()
        frames = round((float(may.late) if may.c.memory else 0) / step)
        self.levels = [view.level_image] * (round(case.latency / step) + 1)
        self.squares, self.thetas, self.lifts = [np.zeros(count)] * (frames + 1), [], []
        self.wait = 0.0

    def run(self, view):
        """Let the controller run: an image up to the latency old, the felt force."""
        late = self.rng.integers(0, len(self.levels), self.count)
        stacked = np.stack(self.levels)
        level = stacked[-1 - late, :, np.arange(self.count)].T
        own = View(self.case, view.x, self.doubt)
        own.felt = self.felt
        self.u, self.angular = own.commanded(level)
        self.ahead = view.feature(level - view.level_image)  # ñ at tk
        own_errors = own.errors()  # with the force that is felt, the true feature
        self.used = own_errors[6:9] - self.ahead  # δ3 that is used
        self.yawed = self.doubt.yaw.copy()
        self.age, self.flow = 0.0, 0 * self.ahead
        self.passed = {name: np.zeros(self.count) for name in ("level", "command", "sinks")}
        most = round(self.period / self.step)
        self.wait = self.step * self.rng.integers(1, most + 1) if most else 0.0

    def begin(self):
        """Let the controller run if it is time, and doubts change; return what there is."""
        case, doubt = self.case, self.doubt
        view = View(case, self.x, doubt)
        if self.age >= self.wait - self.step / 2:
            self.run(view)
        if self.rng.random() < 0.02:
            doubt.gain = 1 + case.thrust * self.rng.choice([-1.0, 1.0], self.count)
            doubt.yaw = case.yaw_rate * self.rng.choice([-1.0, 0.0, 1.0], self.count)
        return self.look(view)

    def advance(self, looked):
        case, h, doubt, view = self.case, self.step, self.doubt, looked["view"]
        rate = self.rate(self.x)
        middle = self.rate(self.x + h / 2 * rate)
        self.x = self.x + h * middle
        after = View(case, self.x, doubt)
        if self.slow:
            late = np.exp(-h / self.slow)
            self.felt = late * self.felt + (1 - late) * (view.felt + after.felt) / 2
        else:
            self.felt = after.felt
        self.flow = self.flow + h * (self.y(view) + self.y(after)) / 2
        self.time, self.age = self.time + h, self.age + h
        self.levels = [*self.levels[1:], after.level_image]
        self.squares = [*self.squares[1:], dot(self.y(after), self.y(after))]
        for name in self.passed:
            self.passed[name] = self.passed[name] + h * looked["moves"][name]
        most = round((self.period + 6 * self.slow) / h) + 1  # beyond that nothing is left
        self.thetas = [*self.thetas, looked["theta"]["lift"]][-most:]
        self.lifts = [*self.lifts, looked["lifting"]][-most:]

    def y(self, view):
        return view.feature(view.level_flow)

    def rate(self, x):
        view = Holding(self.case, x, self.doubt)
        view.held = self.u, self.angular
        return kit.body_rate(view, None)

    def look(self, view):
        """Return what the proof bounds: how fast what is held moves, Θ, E, H, -Ψ' - rΨ."""
        case, known, d = self.case, self.known, view.errors()
        _, d2, d3, d4 = kit.parts(d)
        mu = view.lagging(d, (view.x[kit.ANGULAR], view.x[kit.LIFT]))
        zeta, apart = d4 - d3[:2], d3 - d2
        smooth = -case.K4 * d4 - case.k12 * apart[:2]
        v = {
            "level": [size(apart[:2]), size(zeta), size(d3[:2])],
            "command": [size(apart[:2]), size(zeta), size(smooth + mu[:2]) / case.K4],
            "lift": [np.abs(apart[2]), size(zeta), np.abs(d3[2] + mu[2] / case.kappa)],
        }
        if not self.period:
            v["lift"] = v["lift"][2:]
        if not case.yaw_rate:
            v["level"], v["command"] = v["level"][:2], v["command"][1:]
        parts = {k: [r * x for r, x in zip(known.radii[k], v[k], strict=True)] for k in known.radii}
        moves = {"level": 0, "command": 0, "sinks": 0} | {k: sum(x) for k, x in parts.items()}
        moves["sinks"] = sum(parts["lift"][:-1])
        theta = {
            k: sum(radii) * sum(r * x**2 for r, x in zip(radii, v[k], strict=True))
            for k, radii in known.radii.items()
        }
        A = d3 - self.used
        h = case.c * case.kappa / view.D
        wind = case.m * view.wind
        pi = 2 * h * self.used[2] + kit.cross(view.Omega, wind)[2] / view.D
        asked = self.angular / h - (smooth + case.K4 * A[:2] - pi * zeta)
        return {
            "view": view,
            "moves": moves,
            "theta": theta,
            "E": A - self.ahead - self.flow,
            "command": asked,
            "used": (zeta, self.used[:2], apart[:2]),
            "lift": self.u / case.c - case.kappa * self.used[2],
            "lifting": parts["lift"][-1],
        }

    def kernel(self):
        """Return κ' at all steps until now: a bound of what is not yet in the felt force."""
        ages = self.step * np.arange(len(self.thetas), 0, -1)
        if not self.slow:
            return (ages <= self.period + 1e-12) * 1.0
        return np.minimum(1, np.exp(-(ages - self.period) / self.slow))

    def forgotten(self, looked):
        """Return -(Ψ' + r Ψ), by differences of E along the motion and the integrals."""
        case, known, view = self.case, self.known, looked["view"]
        small = 1e-30
        ahead = Holding(case, view.x + 1j * small * self.rate(view.x), self.doubt)
        rises = ahead.energy().imag / small + case.r * view.energy()
        y2 = dot(self.y(view), self.y(view))
        if case.M:
            late = float(known.claim.late)
            past = self.step * np.arange(len(self.squares) - 1, -1, -1)
            kept = np.exp(-case.r * past) @ np.stack(self.squares) * self.step
            rises = rises + case.M * (late * y2 - kept)
        for name, weight in known.weights.items():
            rises = rises + weight * known.factors[name] * looked["theta"][name]
            if name != "lift":
                rises = rises - weight * self.passed[name] ** 2
        if self.thetas:
            kept = self.kernel() @ np.stack(self.thetas) * self.step
            rises = rises - known.weights["lift"] * (self.period + self.slow) * kept
        return -rises


STEP, LONG = 0.0005, 1.0


@pytest.fixture(scope="module")
def flown(proved):
    """What flights came to, against what is proved of them: shares of the bounds."""
    held, rng = Held(proved), np.random.default_rng(41)
    flight, claim, case = Flight(held, rng, 24, STEP), held.claim, held.case
    swayed = float(claim.slow * (claim.quick * claim.turn + claim.may.yaw_rate) * claim.push)
    swayed /= case.c
    floor, most = float(claim.floor()), {}
    wobble, twist, stray = (float(x) for x in (claim.wobble, claim.twist, claim.stray))
    yaw, own = float(claim.may.yaw_rate), float(claim.gyroscopic)

    def note(name, value, bound):
        assert (value <= bound * 1.002 + 2e-4).all(), (name, flight.time)
        most[name] = max(most.get(name, 0), float(np.max(value / (bound + 1e-3))))

    fell = []
    while flight.time < LONG:
        at = flight.begin()
        lifted = flight.kernel() @ np.stack(flight.lifts) * STEP if flight.lifts else 0.0
        passed = flight.passed
        note("level", size(at["E"][:2]), passed["level"] + swayed)
        lifted = lifted + STEP * at["lifting"]  # it may have grown within a step
        note("lift", np.abs(at["E"][2]), passed["sinks"] + lifted + swayed)
        assert np.abs(at["lift"]).max() < 1e-9
        zeta, missed, pulled = at["used"]
        beside = (yaw * own + wobble) * size(zeta) + (yaw + twist) * size(missed)
        beside = beside + stray * case.k12 * size(pulled) + float(claim.struck)
        note("command", size(at["command"]), passed["command"] + beside)
        energy = at["view"].energy()
        assert (energy <= case.start_level * np.exp(-case.r * flight.time) + floor).all()
        if round(flight.time / STEP) % 20 == 0:
            fell.append((flight.forgotten(at) + case.r * floor) / (energy + 1e-6))
        flight.advance(at)
    return most, np.array(fell), flight


@pytest.mark.slow
def test_no_flight_is_beyond_what_is_proved_of_what_is_held(flown):
    """E, H and Ψ: see `flown`, which holds each step to its bound; none of them is idle."""
    most, fell, flight = flown
    assert (fell > -1e-3).all()
    assert most["lift"] > 0.02
    if flight.period:
        assert most["level"] > 0.02
        assert most["command"] > 0.1
