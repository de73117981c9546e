"""What is seen, and what rotors make, on the way of every vehicle that is proved to converge."""

from __future__ import annotations

import copy
import json
import math
import re
from dataclasses import replace
from fractions import Fraction as F
from pathlib import Path

import numpy as np
import pytest

from hoverproof import checker
from hoverproof.certification.exponential.proof import converge
from hoverproof.cli.answers.exponential import as_json, beyond, lines
from hoverproof.export.binding import Firmware
from hoverproof.firmware.exporting import export_c
from hoverproof.mission.reading import load
from sharing import kept_value
from uncertain_body import LIFT, THRUST, Case, View, times
from uncertain_flights import LONGEST_STEP, Nature, anywhere, fly

SHIPPED = Path(__file__).parents[1] / "proofs/crazyflie-2.1.attraction.cert.json"
MISSION = """
name = "tag"
law = {feature = "scaled", goal = "inertial", force = "measured"}
target = {points = [[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, -0.1, 0], [-0.1, 0.1, 0]]}
goal = {height = 1.2}
gains = {k1 = 0.0153, k2 = 71, k3 = 1.25, k4 = 7.65, k_yaw = 0.004}
bounds = {eigenvalues = [4.59, 13.41], level = 28.125}
uncertainty = {torque = 0.2, rotor_lag = 0.03, wind = 0.2, yaw_rate = 1.0}
start = {position = [0.3, 0, -1.5]}
[vehicle]
mass = 0.5
inertia = [2.1e-3, 2.5e-3, 4e-3]
lever = 0.12
drag_ratio = 0.016
gravity = 9.81
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    made = tmp_path_factory.mktemp("missions") / "tag.toml"
    made.write_text(MISSION, encoding="utf-8")
    return made


@pytest.fixture(scope="module")
def proved(path):
    return kept_value("on the way", lambda: converge(load(path)))


@pytest.mark.slow
def test_what_is_told_is_what_the_checker_says(proved):
    said = checker.check(proved.certificate.content)
    low, high = proved.rotor_thrust
    assert checker.about(low, high) in said
    degrees = said.partition("at most ")[2].rpartition("°")[0].rpartition(" ")[2]
    assert float(degrees) == pytest.approx(math.degrees(proved.field_of_view), abs=0.01)
    assert proved.field_of_view >= F(math.acos(F(proved.certificate.content["claim"]["cone"])))
    told = as_json(proved)
    assert told["rotor_thrust"] == [float(low), float(high)]
    assert told["field_of_view"] == float(proved.field_of_view)


def in_flight(case, count=4000):
    """Return views of vehicles within tolerance all over the set that is proved."""
    rng = np.random.default_rng(11)
    nature = Nature(case, rng, count, LONGEST_STEP, 0)
    nature.doubt.yaw = case.yaw_rate * rng.choice([-1.0, 1.0], count)
    x = anywhere(case, rng, nature.doubt)
    view = View(case, x, nature.doubt)
    good = np.isfinite(view.energy()) & (view.energy() <= case.level)
    assert good.sum() > count / 20
    return view, good


def rotors(view, angular, thrust):
    """Return the thrusts of rotors that give e3 × Γ/I, rad/s², and a thrust, (4, N)."""
    mission = view.case.content["mission"]
    arm, ratio = (float(F(mission["vehicle"][key])) for key in ("arm", "drag_ratio"))
    first, second, _ = view.case.inertia
    Gamma1, Gamma2 = first * angular[1], -second * angular[0]
    p, q, r = view.Omega
    Gamma3 = -float(F(mission["gains"]["k_yaw"])) * r + (second - first) * p * q
    ahead, left, turn = Gamma1 / arm, Gamma2 / arm, Gamma3 / ratio
    ways = ((-1, -1), (-1, 1), (1, -1), (1, 1))
    return np.stack([(thrust + a * ahead + b * left - a * b * turn) / 4 for a, b in ways])


def test_no_rotor_leaves_its_bounds_anywhere_on_the_set(proved):
    case = Case(proved.certificate.content)
    view, good = in_flight(case)
    _, angular = view.commanded(view.level_image)
    doubt, low, high = view.doubt, *map(float, proved.rotor_thrust)
    ahead = doubt.lag * doubt.gain * view.x[LIFT]
    turned = angular + times(doubt.torque, angular)
    each = rotors(view, turned, view.x[THRUST] + ahead)[:, good]
    assert each.min() >= low
    assert each.max() <= high
    middle = (low + high) / 2
    assert np.abs(each - middle).max() > 0.3 * (high - middle)


def test_every_point_stays_within_the_angle_on_every_flight(proved):
    case = Case(proved.certificate.content)
    flown = fly(case, np.random.default_rng(12), 150, 2, 0.1)
    cone = float(F(proved.certificate.content["claim"]["cone"]))
    assert (flown.cosine >= cone).all()
    assert flown.cosine.min() < 0.9


def forged(content, keys, value):
    """Return the certificate with another entry, its statement and hashes made to fit."""
    made = copy.deepcopy(content)
    at = made
    for key in keys[:-1]:
        at = at[key]
    at[keys[-1]] = value
    made["mission_sha256"] = checker.digest(made["mission"])
    made["statement"] = checker.statement(made)
    made["sha256"] = checker.digest({k: v for k, v in made.items() if k != "sha256"})
    return made


@pytest.mark.parametrize(
    ("keys", "change", "reason"),
    [
        (("claim", "cone"), lambda x: x + F(1, 1000), "angle under which"),
        (("domain", "cone"), lambda x: x + F(1, 10), "domain is not shown"),
        (("domain", "cone"), lambda x: None, "needs a cone"),
        (("claim", "rotors", 0), lambda x: x + F(1, 1000), "rotor"),
        (("claim", "rotors", 1), lambda x: x - F(1, 1000), "rotor"),
        (("mission", "vehicle", "arm"), lambda x: x / 2, "rotor"),
        (("mission", "vehicle", "drag_ratio"), lambda x: x / 2, "rotor"),
        (("mission", "gains", "k_yaw"), lambda x: 2 * x, "rotor"),
    ],
)
def test_what_claims_more_is_rejected(keys, change, reason, proved):
    content = at = proved.certificate.content
    for key in keys:
        at = at[key]
    new = change(F(at))
    with pytest.raises(checker.Rejected, match=reason):
        checker.check(forged(content, keys, None if new is None else str(new)))


def test_a_heading_to_turn_to_asks_more_of_the_rotors(proved):
    content = copy.deepcopy(proved.certificate.content)
    content["mission"]["goal"]["heading"] = "0"
    content["mission_sha256"] = checker.digest(content["mission"])
    (low, high), *_ = checker.claim_of(content).rotors()
    own, *_ = checker.claim_of(proved.certificate.content).rotors()
    more = F("0.004") ** 2 / (4 * F("0.004")) * F("1.2") / (4 * F("0.016"))
    assert (own[0] - low, high - own[1]) == (more, more)


@pytest.mark.slow
def test_a_camera_that_sees_enough_is_claimed_and_one_that_does_not_is_said(path, proved):
    content = proved.certificate.content
    for half, fits in ((proved.field_of_view + F(1, 1000), True), (F(1, 2), False)):
        made = copy.deepcopy(content)
        made["mission"]["camera"] = {"half_angle": str(half)}
        made = forged(made, ("claim", "level"), content["claim"]["level"])
        if fits:
            assert checker.check(made)
        else:
            with pytest.raises(checker.Rejected, match="half angle of the camera"):
                checker.check(made)


@pytest.mark.whole  # CI proves a preset with its camera
def test_a_narrow_camera_gets_a_smaller_set_and_a_narrower_one_none(path, proved):
    narrow = proved.field_of_view - F(1, 100)
    verdict = converge(load(path, {"camera.half_angle": str(float(narrow))}))
    assert verdict.status == "proved"
    assert verdict.field_of_view <= narrow
    verdict = converge(load(path, {"camera.half_angle": "0.5"}))
    assert verdict.status == "undecided"
    assert "rad more than the half angle of the camera" in verdict.reason


def test_limits_of_rotors_that_are_not_shown_to_be_kept_are_named(path, proved):
    low, high = proved.rotor_thrust

    def limited(least, most):
        limits = {"rotors.min_thrust": str(least), "rotors.max_thrust": str(most)}
        return replace(proved, mission=load(path, limits))

    kept = limited(float(low) - 0.01, float(high) + 0.01)
    assert beyond(kept) == []
    assert as_json(kept)["rotor_limits_kept"]
    passed = limited(float(low) + 0.01, float(high) - 0.01)
    assert [text.split()[0] for text in beyond(passed)] == ["min_thrust", "max_thrust"]
    assert "0.01 N" in "\n".join(lines(passed, ["here"]))


def test_a_package_with_a_proof_from_the_start_watches_what_that_proves():
    held = json.loads(SHIPPED.read_text(encoding="utf-8"))
    plain = export_c(load("crazyflie-2.1"), "plain", name="fw")
    watched = export_c(load("crazyflie-2.1"), "watched", name="fw", certificate=held)
    assert len(watched["theorems"]) == len(plain["theorems"]) + 1
    claim = checker.claim_of(held)
    said = Path("watched/README.md").read_text(encoding="utf-8")
    low, high = map(float, re.search(r"`THRUST` .* \[([\d.]+), ([\d.]+)\] N", said).groups())
    assert high == pytest.approx(float(claim.weight + claim.force), rel=1e-5)
    assert low < float(claim.weight) < high
    assert "(proved on the way)" in said
    assert "(proved on the way)" not in Path("plain/README.md").read_text(encoding="utf-8")


def test_the_monitor_is_silent_of_every_vehicle_within_the_tolerance_that_hovers(tmp_path):
    held, mission = json.loads(SHIPPED.read_text(encoding="utf-8")), load("crazyflie-2.1")
    export_c(mission, tmp_path / "fw", name="fw", certificate=held)
    firmware, corner = Firmware(tmp_path / "fw"), float(mission.target.points[0][0])
    seen = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * corner / float(mission.goal.height)
    weight, e = float(mission.vehicle.weight), float(mission.uncertainty.thrust)
    still = {"velocity": [0, 0, 0], "rate": [0, 0, 0], "gravity_direction": [0, 0, 1]}
    still |= {"specific_force": [0, 0, -float(mission.vehicle.gravity)], "dt": 0.001}
    told = {}
    for made in (1 - e, 1 - e / 2, 1, 1 + e, 1 - 3 * e, 1 + 3 * e):
        firmware.reset(weight / made)  # it hovers, commanded as much
        told[made] = firmware.step(seen, **still).status
    *within, weak, strong = told.values()
    assert within == [0, 0, 0, 0]
    assert weak == 8
    assert strong == 8
