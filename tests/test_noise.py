"""What noise of the feature and of the velocity leaves, proved and held against flying bodies."""

from __future__ import annotations

import copy
from fractions import Fraction as F

import numpy as np
import pytest

import uncertain_body as kit
from hoverproof import checker
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.proof import converge
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.cli.answers.exponential import as_json, lines
from hoverproof.mission.reading import load
from sampling import mostly_whole
from sharing import kept_value
from test_on_the_way import MISSION, forged
from test_uncertain_flights import EIGHT, claimed_rates, content, in_doubt
from uncertain_body import Case, View, size
from uncertain_flights import LONGEST_STEP, Nature, anywhere, hovers

NOISES = {
    "image": {"noise.feature": "0.1", "noise.velocity": "0.002"},
    "all": {
        **{"noise.feature": "0.02", "noise.velocity": "0.0005", "noise.force": "0.001"},
        **{"noise.rate": "0.0005", "noise.vertical": "0.0001", "gust": "0.001"},
    },
    "late": {
        "rotor_lag": "0",
        "latency": "0.03",
        "noise.force": "0.002",
        "noise.rate": "0.001",
        "gust": "0.001",
    },
}


@pytest.fixture(
    scope="module",
    params=mostly_whole(["all", "image", "late"], every=3),
)
def proved(tmp_path_factory, request):
    path = tmp_path_factory.mktemp("missions") / "tag.toml"
    path.write_text(MISSION, encoding="utf-8")
    keys = {f"uncertainty.{key}": value for key, value in NOISES[request.param].items()}
    keys["sensors.gyro_turned"] = "true"
    found = kept_value(("noise", request.param), lambda: converge(load(path, keys)))
    assert found.status == "proved", found.reason
    return found


class Wrong:
    """What is measured less what is true, body axes, and a gust, (3, N) each.

    Attributes
    ----------
    feature, velocity, vertical, rate : (3, N)
        1, m/s, 1 and rad/s.
    felt : (3, N)
        Of the accelerometer, m/s², the gust left out.
    gust : (3, N)
        Wind less the steady one, m/s².
    """

    NAMES = "feature", "velocity", "vertical", "rate", "felt", "gust"

    def __init__(self, **errors):
        for name in self.NAMES:
            setattr(self, name, errors.get(name, np.zeros((3, 1))))

    @classmethod
    def anyhow(cls, rng, count, **sizes):
        return cls(**{k: x * rng.normal(size=(3, count)) for k, x in sizes.items()})


class Unsure(View):
    """A view whose controller is told what is wrong."""

    wrong = Wrong()

    def commanded(self, level):
        wrong, other = self.wrong, copy.copy(self)
        other.V, other.rho = self.V + wrong.velocity, self.rho + wrong.vertical
        other.Omega = self.Omega + wrong.rate
        other.felt = self.felt + wrong.felt + wrong.gust
        return View.commanded(other, level + kit.times(self.R, wrong.feature + 0 * self.V))


def unsure(view, wrong):
    """Return a view in which that is wrong."""
    made = Unsure(view.case, view.x, view.doubt)
    made.wrong = wrong
    return made


def moves(view, level):
    """Return how a state moves, with the gust."""
    rate = kit.body_rate(view, level)
    if isinstance(view, Unsure):
        rate[kit.VELOCITY] += kit.times(view.R, view.wrong.gust + 0 * view.V)
    return rate


def along(view, value, step=1e-30, level=None):
    """Return how something of a view moves with it, by a complex step."""
    level = view.level_image if level is None else level
    x = view.x + 1j * step * moves(view, level)
    return value(View(view.case, x, view.doubt)).imag / step


def all_errors(at):
    d = at.errors()
    return np.concatenate([d, at.doubt.lag * at.lagging(d, (at.x[kit.ANGULAR], at.x[kit.LIFT]))])


def disturbances(view, wrong):
    """Return B, φ, α/m and G: see the proof of theorem 5; (3, N) each."""
    case = view.case
    alpha = wrong.felt + wrong.gust if case.measured else 0 * wrong.felt
    phi = case.m * (alpha + case.g * wrong.vertical) / case.c
    seen = wrong.feature - case.m / case.k[0] * wrong.velocity
    if not case.fixed:
        seen = seen - case.s3 * wrong.vertical
    return seen - phi, phi, alpha, case.m / case.k[0] * wrong.gust


def misled(view, wrong, n):
    """Return what errors of force and of Ω add to the command, over h, beside n + B, (2, N)."""
    case, doubt = view.case, view.doubt
    B, phi, alpha, _ = disturbances(view, wrong)
    _, d2, d3, d4 = kit.parts(view.errors())
    h, zeta, yaw = case.c * case.kappa / view.D, d4 - d3[:2], doubt.yaw
    lever = view.D - case.m * alpha[2]
    iota = view.D / lever - 1
    wind = case.m * (view.wind if case.measured else 0 * view.wind)
    flat = np.array([[1], [1], [0]])
    Omega = view.Omega + wrong.rate
    p3, told = (
        kit.cross(rate, flat * x)[2] / D
        for rate, x, D in ((view.Omega, wind, view.D), (Omega, wind + case.m * alpha, lever))
    )
    missed, missed_z = (d3 - n - B)[:2], (d3 - n - B)[2]
    pi, pi_told = 2 * h * missed_z + p3, 2 * h * (1 + iota) * missed_z + told
    omega, w3 = kit.quarter(wrong.rate), wrong.rate[2]
    own = np.tensordot(case.compensated, zeta, 1)
    more = -(1 + iota) * case.k12 * phi[:2] - (case.K4 + pi_told) * omega / h
    more = more + (yaw + w3) * np.tensordot(case.compensated, omega, 1) / h
    twisted = w3 * (1 + iota) * kit.quarter(missed)
    twisted = twisted - iota * (case.K4 * missed - yaw * kit.quarter(missed))
    more = more + twisted - iota * case.k12 * (d3 - d2)[:2]
    return more + w3 * own - (pi_told - pi) * zeta


def claimed_in_noise(view, wrong, n):
    """Return the rates of δ1 to δ4, and τ times those of μ and μT, in closed form, (14, N)."""
    case, doubt = view.case, view.doubt
    B, _, _, G = disturbances(view, wrong)
    claimed = claimed_rates(view, view.level_image + kit.times(view.R, n + B))
    more, slow = misled(view, wrong, n), doubt.lag > 0
    zero = 0 * view.V
    quick = np.where(slow, 0, more + kit.times(doubt.torque, more))
    fourth = quick + (zero + G)[:2]
    torque = slow * (more + doubt.lag * case.K4 * (zero + G)[:2])
    lift = -doubt.lag * case.kappa * (zero + G)[2]
    return claimed + np.concatenate([zero, zero + G, zero + G, fourth, torque, [lift]])


SIZES = {"feature": 0.3, "velocity": 0.05, "vertical": 0.02, "rate": 0.3, "felt": 0.3, "gust": 0.3}


@pytest.mark.parametrize("law", EIGHT, ids="/".join)
def test_the_error_rates_in_noise_and_gusts_are_the_closed_form(law):
    case, rng = Case(content("all at once", law)), np.random.default_rng(21)
    view, _ = in_doubt(case, rng, 300)
    wrong = Wrong.anyhow(rng, 300, **SIZES)
    n = 0.3 * rng.normal(size=view.V.shape)
    level = view.level_image + kit.times(view.R, n)
    shown = along(unsure(view, wrong), all_errors, level=level)
    assert shown == pytest.approx(claimed_in_noise(view, wrong, n), rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("name", Wrong.NAMES)
def test_every_noise_counts_in_the_error_rates(name):
    case, rng = Case(content("all at once")), np.random.default_rng(25)
    view, _ = in_doubt(case, rng, 20)
    wrong = Wrong.anyhow(rng, 20, **SIZES)
    shown = along(unsure(view, wrong), all_errors)
    setattr(wrong, name, 1.2 * getattr(wrong, name))
    claimed = claimed_in_noise(view, wrong, 0 * view.V)
    assert np.abs(claimed - shown).max() > 0.001


class Bounds:
    """What a certificate says of noise: the size of each, Σ σ max|·|² and ℓ∞."""

    def __init__(self, proved):
        held = proved.certificate.content
        self.case, may = Case(held), held["mission"]["uncertainty"]
        said = {**may["noise"], "gust": may.get("gust", "0")}
        said["felt"] = F(said.pop("force")) / F(held["mission"]["vehicle"]["mass"])
        self.sizes = {name: float(F(x)) for name, x in said.items()}
        vehicles = Vehicles.of(proved.mission)
        reach = Reach.of(self.case.w[1:], self.case.level)
        limits = Limits(vehicles, reach, self.case.slope)
        known, self.misled, self.struck = limits.disturbances(), limits.misled, limits.struck
        sigma = {name: float(F(held["multipliers"][name])) for name, _ in known}
        self.limits = dict(known)
        self.risen = sum(sigma[name] * x**2 for name, x in known)
        self.floor = self.risen / self.case.r

    def worst(self, view):
        """Return noises that are as large as they may be and make E fall least."""
        calm, found = along(view, View.energy), {}
        for name, most in self.sizes.items():
            tried = [Wrong(**{name: np.eye(3)[:, [k]] * 1e-6}) for k in range(3)]
            slope = np.stack([along(unsure(view, each), View.energy) - calm for each in tried])
            found[name] = most * slope / (size(slope) + 1e-300)
        return Wrong(**found)


@pytest.mark.slow
def test_nowhere_on_the_set_does_noise_make_it_rise_by_more_than_is_claimed(proved):
    known = Bounds(proved)
    case, rng = known.case, np.random.default_rng(22)
    nature = Nature(case, rng, 4000, LONGEST_STEP, 0)
    nature.doubt.yaw = case.yaw_rate * rng.choice([-1.0, 1.0], 4000)
    for near in (1, 1e-2, 1e-4):
        part = copy.copy(case)
        part.level, part.offset = case.level * near, case.offset * near**0.5
        view = View(case, anywhere(part, rng, nature.doubt), nature.doubt)
        E = view.energy()
        good = np.isfinite(E) & (part.level >= E)
        with np.errstate(invalid="ignore"):  # where a draw was outside
            wrong = known.worst(view)
            risen = along(unsure(view, wrong), View.energy) + case.r * E
            B, _, _, G = disturbances(view, wrong)
            more = misled(view, wrong, 0 * view.V)
        assert (risen[good] <= known.risen).all()
        assert (size(B)[good] <= known.limits["noise"] * (1 + 1e-9)).all()
        assert (size(G + 0 * view.V)[good] <= known.limits.get("gust", 0) * (1 + 1e-9)).all()
        _, d2, d3, d4 = kit.parts(view.errors())
        parts = d4 - d3[:2], (d3 - B)[:2], (d3 - d2)[:2]
        most = sum(x * size(part) for x, part in zip(known.misled, parts, strict=True))
        assert (size(more)[good] <= (most + known.struck)[good] * (1 + 1e-9)).all()
    assert good.sum() > 20
    assert risen[good].max() > 0.01 * known.risen


@pytest.mark.slow
def test_flights_in_the_worst_noise_end_where_it_is_claimed(proved):
    known, rng = Bounds(proved), np.random.default_rng(23)
    case = known.case
    nature = Nature(case, rng, 60, LONGEST_STEP, 0)
    nature.doubt.yaw = case.yaw_rate * rng.choice([-1.0, 1.0], 60)
    x = hovers(case, rng, nature.doubt, np.tile(np.reshape(case.goal, (3, 1)), 60))
    radius, least = float(proved.ultimate_radius), 0
    for tick in range(400):
        view = View(case, x, nature.doubt)
        if tick % 10 == 0:
            wrong = known.worst(view)
        assert (view.energy() <= known.floor).all()
        least = size(x[kit.POSITION] - case.goal[:, None])
        assert (least <= radius).all()
        x = x + LONGEST_STEP * moves(unsure(view, wrong), view.level_image)
    assert least.max() > 0.02 * radius


@pytest.mark.slow
def test_what_is_told_is_what_the_checker_says(proved):
    said = checker.check(proved.certificate.content)
    assert f"in the end within {checker.about(proved.ultimate_radius)} m" in said
    noise = proved.mission.uncertainty.noise
    wrong = f"the feature of that image is wrong by at most {checker.about(noise.feature)}"
    assert (wrong in said) == (noise.feature > 0)
    assert ("Ω by at most" in said) == (noise.rate > 0)
    assert ("ρ by at most" in said) == (noise.vertical > 0)
    assert ("accelerometer is wrong by at most" in said) == (noise.force > 0)
    assert ("gusts besides" in said) == (proved.mission.uncertainty.gust > 0)
    assert as_json(proved)["ultimate_radius"] == float(proved.ultimate_radius)
    assert any("ultimate bound" in line for line in lines(proved, ["here"]))
    assert proved.ultimate_radius < proved.settling.radius


MORE = {
    ("mission", "uncertainty", "noise", "feature"): 3,
    ("mission", "uncertainty", "noise", "velocity"): 50,
    ("mission", "uncertainty", "noise", "force"): 4,
    ("mission", "uncertainty", "noise", "rate"): 6,
    ("mission", "uncertainty", "noise", "vertical"): 12,
    ("mission", "uncertainty", "gust"): 8,
    ("claim", "ultimate", "offset"): F(4, 5),
    ("claim", "ultimate", "radius"): F(4, 5),
    ("claim", "settling", "time"): F(9, 10),
    **{("multipliers", k): 0 for k in ("noise", "command", "gust")},
}


@pytest.mark.slow
@pytest.mark.parametrize("keys", MORE, ids=".".join)
def test_what_claims_more_is_rejected(keys, proved):
    at = proved.certificate.content
    for key in keys:
        at = at.get(key, "0")
    if at == "0":
        pytest.skip("it says nothing of that")
    for factor in (F(1, 3), 500) if keys[0] == "multipliers" else (MORE[keys],):
        with pytest.raises(checker.Rejected):
            checker.check(forged(proved.certificate.content, keys, str(F(at) * factor)))


@pytest.mark.parametrize("name", ["noise", "command", "gust"])
def test_noise_needs_its_multiplier(name, proved):
    made = copy.deepcopy(proved.certificate.content)
    if made["multipliers"].pop(name, None) is None:
        made["multipliers"][name] = "1"
    with pytest.raises(checker.Rejected, match="noise is to have its multiplier"):
        checker.claim_of(made)


@pytest.mark.parametrize("name", ["noise", "stray", "wobble", "twist", "struck", "jolt", "shock"])
def test_search_and_checker_bound_what_noise_does_alike(name, proved):
    """Search and checker have the same bound of each."""
    claim = checker.claim_of(proved.certificate.content)
    vehicles, case = Vehicles.of(proved.mission), Case(proved.certificate.content)
    limits = Limits(vehicles, Reach.of(case.w[1:], case.level), case.slope)
    own = {
        **{"stray": limits.stray, "wobble": limits.misled[0], "twist": limits.misled[1]},
        **{"noise": limits.missed, "struck": limits.struck, "shock": vehicles.shock},
        "jolt": float(vehicles.design.slowness) * vehicles.gusts,
    }
    assert float(getattr(claim, name)) == pytest.approx(own[name], rel=1e-6)
