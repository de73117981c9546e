"""What noise of the feature and of the velocity leaves, proved and held against flying bodies."""

from __future__ import annotations

import copy
from fractions import Fraction as F

import numpy as np
import pytest

import uncertain_body as kit
from hoverproof import checker
from hoverproof.certification.exponential.proof import converge
from hoverproof.cli.answers.exponential import as_json, lines
from hoverproof.mission.reading import load
from sharing import kept_value
from test_on_the_way import MISSION, forged
from test_uncertain_flights import EIGHT, claimed_rates, content, in_doubt
from uncertain_body import Case, View, size
from uncertain_flights import LONGEST_STEP, Nature, anywhere, hovers

NOISE = {"uncertainty.noise.feature": "0.1", "uncertainty.noise.velocity": "0.002"}


@pytest.fixture(scope="module")
def proved(tmp_path_factory):
    path = tmp_path_factory.mktemp("missions") / "tag.toml"
    path.write_text(MISSION, encoding="utf-8")
    return kept_value("noise", lambda: converge(load(path, NOISE)))


class Unsure(View):
    """A view in which the controller has another feature (level axes) and another velocity."""

    wrong = (0, 0)

    def commanded(self, level):
        feature, velocity = self.wrong
        other = copy.copy(self)
        other.V = self.V + velocity
        return View.commanded(other, level + feature)


def unsure(view, feature, velocity):
    """Return a view in which both are wrong by that, (3, N)."""
    made = Unsure(view.case, view.x, view.doubt)
    made.wrong = feature, velocity
    return made


def along(view, value, step=1e-30):
    """Return how something of a view moves with it, by a complex step."""
    x = view.x + 1j * step * kit.body_rate(view, view.level_image)
    return value(View(view.case, x, view.doubt)).imag / step


@pytest.mark.parametrize("law", EIGHT, ids="/".join)
def test_noise_of_the_velocity_counts_as_noise_of_the_feature_by_the_slowness(law):
    case, rng = Case(content("all at once", law)), np.random.default_rng(21)
    view, _ = in_doubt(case, rng, 200)
    feature, velocity = rng.normal(size=(2, *view.V.shape))

    def all_errors(at):
        d = at.errors()
        return np.concatenate(
            [d, at.doubt.lag * at.lagging(d, (at.x[kit.ANGULAR], at.x[kit.LIFT]))]
        )

    shown = along(unsure(view, feature, velocity), all_errors)
    nu = feature - case.m / case.k[0] * kit.times(view.R, velocity)
    claimed = claimed_rates(view, view.level_image + nu)
    assert shown == pytest.approx(claimed, rel=1e-9, abs=1e-9)


def bounds(proved):
    """Return the case, σν, the bounds of both noises and ℓ∞."""
    held = proved.certificate.content
    sigma = float(F(held["multipliers"]["noise"]))
    case, noise = Case(held), [float(x) for x in NOISE.values()]
    nu = noise[0] + case.m / case.k[0] * noise[1]
    return case, sigma, noise, sigma * nu**2 / case.r


def worst(view, noise):
    """Return noises that are as large as they may be and make E fall least."""
    calm = along(view, View.energy)
    slope = [along(unsure(view, np.eye(3)[:, [k]] * 1e-3, 0), View.energy) - calm for k in range(3)]
    way = np.stack(slope) / (size(np.stack(slope)) + 1e-300)
    return noise[0] * way, -noise[1] * kit.back(view.R, way)


def test_nowhere_on_the_set_does_noise_make_it_rise_by_more_than_is_claimed(proved):
    case, sigma, noise, _ = bounds(proved)
    rng = np.random.default_rng(22)
    nature = Nature(case, rng, 4000, LONGEST_STEP, 0)
    nature.doubt.yaw = case.yaw_rate * rng.choice([-1.0, 1.0], 4000)
    nu = noise[0] + case.m / case.k[0] * noise[1]
    for near in (1, 1e-2):
        part = copy.copy(case)
        part.level, part.offset = case.level * near, case.offset * near**0.5
        view = View(case, anywhere(part, rng, nature.doubt), nature.doubt)
        E = view.energy()
        good = np.isfinite(E) & (part.level >= E)
        with np.errstate(invalid="ignore"):  # where a draw was outside
            risen = along(unsure(view, *worst(view, noise)), View.energy) + case.r * E
        assert (risen[good] <= sigma * nu**2).all()
    assert good.sum() > 20
    assert risen[good].max() > 0.02 * sigma * nu**2


def test_flights_in_the_worst_noise_end_where_it_is_claimed(proved):
    case, _, noise, floor = bounds(proved)
    rng = np.random.default_rng(23)
    nature = Nature(case, rng, 60, LONGEST_STEP, 0)
    nature.doubt.yaw = case.yaw_rate * rng.choice([-1.0, 1.0], 60)
    x = hovers(case, rng, nature.doubt, np.tile(np.reshape(case.goal, (3, 1)), 60))
    radius, least = float(proved.ultimate_radius), 0
    for tick in range(400):
        view = View(case, x, nature.doubt)
        if tick % 10 == 0:
            both = worst(view, noise)
        assert (view.energy() <= floor).all()
        least = size(x[kit.POSITION] - case.goal[:, None])
        assert (least <= radius).all()
        x = x + LONGEST_STEP * kit.body_rate(unsure(view, *both), view.level_image)
    assert least.max() > 0.02 * radius


def test_what_is_told_is_what_the_checker_says(proved):
    said = checker.check(proved.certificate.content)
    assert f"in the end within {checker.about(proved.ultimate_radius)} m" in said
    assert "the feature of that image is wrong by at most 1/10" in said
    assert as_json(proved)["ultimate_radius"] == float(proved.ultimate_radius)
    assert any("in the end" in line for line in lines(proved, ["here"]))
    assert proved.ultimate_radius < proved.settling.radius


@pytest.mark.parametrize(
    ("keys", "factor", "reason"),
    [
        (("mission", "uncertainty", "noise", "feature"), 3, "rotor|noise|fall"),
        (("mission", "uncertainty", "noise", "velocity"), 50, "rotor|noise|fall"),
        (("multipliers", "noise"), F(1, 3), "Ψ is not shown to fall"),
        (("multipliers", "noise"), 500, "noise is not shown"),
        (("claim", "ultimate", "offset"), F(4, 5), "by more than the offset"),
        (("claim", "ultimate", "radius"), F(4, 5), "within the radius"),
        (("claim", "settling", "time"), F(9, 10), "settling time"),
    ],
)
def test_what_claims_more_is_rejected(keys, factor, reason, proved):
    at = proved.certificate.content
    for key in keys:
        at = at[key]
    with pytest.raises(checker.Rejected, match=reason):
        checker.check(forged(proved.certificate.content, keys, str(F(at) * factor)))


@pytest.mark.parametrize("name", ["force", "rate"])
def test_noise_of_other_measurements_is_not_covered(name, proved):
    keys = ("mission", "uncertainty", "noise", name)
    with pytest.raises(checker.Rejected, match="force and of the body rates is not covered"):
        checker.check(forged(proved.certificate.content, keys, "1/1000"))


def test_noise_needs_its_multiplier(proved):
    made = copy.deepcopy(proved.certificate.content)
    del made["multipliers"]["noise"]
    with pytest.raises(checker.Rejected, match="noise is to have its multiplier"):
        checker.claim_of(made)
