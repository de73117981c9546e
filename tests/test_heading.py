"""A mission with a heading: read, flown, exported and certified."""

from __future__ import annotations

import math
import tomllib
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
import xarray as xr

import hoverproof
from firmware_kit import tool
from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.export.flight_law import flight_law
from hoverproof.export.same_controller import assert_is_the_controller
from hoverproof.mission.reading import load
from hoverproof.mission.writing import mission_text
from hoverproof.plant import rigid_body
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import LAWS, law_of
from hoverproof.servo.laws.heading import HEADED, flown_law
from hoverproof.simulation.runs import simulate_batch
from sampling import mostly_whole
from small_kit import small_vehicle

PAPERS, BEST = ("centroid", "image", "modelled"), ("scaled", "inertial", "measured")
EACH_LAW = pytest.mark.parametrize("choices", LAWS, ids="/".join)
BOTH = pytest.mark.parametrize("choices", [PAPERS, BEST], ids="/".join)
SMALL = small_vehicle(bounds="[0.04, 10]", start="[0.3, 0.2, -1.5]")
Q_GAINS = {"gains.k1": Fraction("0.5"), "gains.k2": Fraction("1.5")}
REAL = {
    "sensors": {
        **{"control_rate": 250, "frame_rate": 30, "latency": Fraction("0.04"), "gyro_turned": True},
        **{"focal_length": 600, "pixel_noise": 1, "gyro_noise": Fraction("0.01")},
        **{"heading_noise": Fraction("0.02")},
    },
    "rotors": {"time_constant": Fraction("0.03")},
}


def mission_of(choices, heading=1.2, overrides=()):
    named = dict(zip(("feature", "goal", "force"), choices, strict=True))
    small = tomllib.loads(SMALL, parse_float=Fraction)
    own = {} if heading is None else {"goal.heading": Fraction(heading)}
    gains = Q_GAINS if choices[0] == "centroid" else {}
    return load("x4-flyer", {**small, "law": named, **gains, **own, **dict(overrides)})


def yaw_of(flight):
    return flight["euler_angles"].sel(angle="yaw").values


# --- what a mission says --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"goal.heading": "4"}, r"goal\.heading: must be from -3\.1416 to 3\.1416 rad, not 4"),
        ({"goal.heading": "'north'"}, r"goal\.heading: must be a number in rad"),
        ({"gains.k_heading": "0.1"}, r"gains\.k_heading: turns to a heading: give goal\.heading"),
        (
            {"goal.heading": "1", "gains.k_heading": "-0.1"},
            r"gains\.k_heading: must be above 0 and at most 1e9 kg m²/s², not -0\.1",
        ),
        (
            {"goal": {"centroid": [Fraction("0.1"), 0, Fraction("3.6")], "heading": 1}},
            r"goal\.heading: needs a goal straight below",
        ),
        (
            {"goal.heading": "1", "sensors.heading_noise": "2"},
            r"sensors\.heading_noise: must be from 0 to 1 rad",
        ),
    ],
)
def test_a_heading_that_cannot_be_is_refused(overrides, message):
    with pytest.raises(InputError, match=message):
        load("x4-flyer", overrides)


def test_the_gain_left_out_damps_yaw_critically_but_turns_at_one_rad_per_second_at_most():
    slow = load("x4-flyer", {"goal.heading": "1", "gains.k_yaw": "0.1"})
    assert slow.k_heading == Fraction(1, 100) / 4 / slow.vehicle.inertia[2]
    fast = load("x4-flyer", {"goal.heading": "1", "gains.k_yaw": "100"})
    assert fast.k_heading == 100
    assert load("x4-flyer", {"goal.heading": "1", "gains.k_heading": "3"}).k_heading == 3


def test_a_mission_without_a_heading_is_the_one_it_was():
    mission = load("x4-flyer")
    assert "heading" not in str(mission.exact())
    assert flown_law(mission) is law_of(mission)


def test_a_heading_is_written_back_with_its_mission():
    mission = load("x4-flyer", {"goal.heading": "0.5", "gains.k_heading": "3"})
    text = mission_text(mission)
    assert "heading = 0.5" in text
    assert tomllib.loads(text, parse_float=Fraction)["gains"]["k_heading"] == 3


# --- the law --------------------------------------------------------------------------------------


@EACH_LAW
def test_the_controller_turns_by_the_sine_and_does_the_rest_as_without(choices):
    plain, headed = LAWS[choices], HEADED[choices]
    draw = np.random.default_rng(5)
    controllers = [derive_controller(law).function() for law in (plain, headed)]
    for _ in range(20):
        measured, design = (
            {name: draw.normal(0, 1, size) for name, size in layout.sizes().items()}
            for layout in (headed.measurement, headed.design)
        )
        design = {k: abs(v) + 0.1 for k, v in design.items()}
        design["goal_centroid"][:2] = 0  # straight below
        yaw, wanted = draw.uniform(-np.pi, np.pi, 2)
        measured["heading"] = [np.cos(yaw), np.sin(yaw)]
        design["goal_heading"] = [np.cos(wanted), np.sin(wanted)]
        (rate, torque), (own_rate, own_torque) = (
            [
                np.array(out).ravel()
                for out in controller(
                    np.concatenate([measured[k] for k in law.measurement.sizes()]),
                    np.concatenate([design[k] for k in law.design.sizes()]),
                )
            ]
            for law, controller in zip((plain, headed), controllers, strict=True)
        )
        assert own_rate == pytest.approx(rate, rel=1e-12)
        assert own_torque[:2] == pytest.approx(torque[:2], rel=1e-12)
        expected = -design["k_heading"][0] * np.sin(yaw - wanted)
        assert own_torque[2] - torque[2] == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_the_heading_moves_as_the_rotation_says():
    """Against central differences of R exp(sk(Ω) h)."""
    draw = np.random.default_rng(6)
    R, rate = ca.SX.sym("R", 3, 3), ca.SX.sym("rate", 3)
    told = rigid_body.heading(R)
    f = ca.Function("f", [R, rate], [told, rigid_body.heading_rate(told, R[2, :].T, rate)])
    for _ in range(50):
        at = rigid_body.rotation_matrix(*draw.uniform([-3, -1.3, -3], [3, 1.3, 3]))
        turn, h = draw.normal(0, 1, 3), 1e-6
        ahead, behind = (
            np.array(f(at @ np.array(rigid_body.rotation_matrix(*(s * h * turn))), turn)[0])
            for s in (1, -1)
        )
        slope = np.array(f(at, turn)[1])
        assert slope == pytest.approx((ahead - behind) / (2 * h), rel=1e-5, abs=1e-5)


# --- flights --------------------------------------------------------------------------------------


@EACH_LAW
def test_a_flight_turns_to_the_heading_and_goes_to_the_goal(choices):
    start = {"start.rotation": [Fraction("0.05"), Fraction("-0.05"), Fraction("-1.4")]}
    mission = mission_of(choices, overrides=start)
    flight = hoverproof.simulate(mission, duration=25)
    assert flight.attrs["outcome"] == "flown"
    assert yaw_of(flight)[0] == pytest.approx(-1.4)
    assert yaw_of(flight)[-1] == pytest.approx(1.2, abs=1e-4)
    within = np.abs(flight["body_rate"].sel(body_axis="z").values).max()
    assert within <= float(mission.k_heading / mission.gains.k_yaw)
    away = np.linalg.norm(flight["position"].values - flight.attrs["goal_position"], axis=1)
    assert away[-1] < (0.02 if choices[0] == "scaled" else away[0] / 2)


@BOTH
def test_with_sensors_and_rotors_it_keeps_the_heading_to_within_its_noise(choices):
    flight = hoverproof.simulate(mission_of(choices, overrides=REAL), duration=20)
    assert flight.attrs["outcome"] == "flown"
    last = yaw_of(flight)[-200:]
    assert abs(last.mean() - 1.2) < 0.01
    assert 0 < last.std() < 0.02


def test_the_bias_of_a_compass_is_that_of_the_heading_kept():
    biased = {"sensors": {"heading_bias": Fraction("0.1")}}
    ends = [
        yaw_of(hoverproof.simulate(mission_of(BEST, overrides=biased), duration=20, seed=s))[-1]
        for s in (1, 2)
    ]
    assert ends[0] != pytest.approx(ends[1], abs=1e-3)
    assert all(1e-4 < abs(end - 1.2) < 0.5 for end in ends)


def test_runs_differ_by_the_compass_alone_and_each_is_the_flight_of_its_own(tmp_path):
    mission = mission_of(BEST, overrides={"sensors": {"heading_noise": Fraction("0.05")}})
    simulate_batch(mission, tmp_path / "runs.nc", runs=5, duration=2, seed=3)
    with xr.open_dataset(tmp_path / "runs.nc") as runs:
        ends = runs["euler_angles"].sel(angle="yaw").values[:, -1]
    assert len(set(ends)) == 5
    alone = hoverproof.simulate(mission, duration=2, seed=3)
    assert yaw_of(alone)[-1] == pytest.approx(float(ends[0]), rel=1e-6)


@pytest.mark.parametrize("overrides", [{}, REAL], ids=["ideal", "real"])
def test_without_a_compiler_a_flight_to_a_heading_has_the_same_bits(overrides):
    tool("cc")
    mission = mission_of(BEST, overrides=overrides)
    fast, slow = (
        hoverproof.simulate(mission, duration=0.5, **own) for own in ({}, {"compiler": ""})
    )
    assert fast.attrs["machine"] != slow.attrs["machine"]
    assert np.array_equal(fast["euler_angles"].values, slow["euler_angles"].values)
    assert np.array_equal(fast["position"].values, slow["position"].values)


def test_the_law_without_heading_may_be_flown_by_name():
    mission = mission_of(BEST)
    flight = hoverproof.simulate(mission, duration=2, law=LAWS[BEST])
    assert np.abs(yaw_of(flight)).max() < 0.01


# --- firmware -------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("tunable", [False, True])
@pytest.mark.parametrize("choices", mostly_whole([(law,) for law in LAWS], every=3))
def test_the_printed_law_is_the_derived_one_exactly(choices, tunable):
    mission = mission_of(choices)
    law = flight_law(mission, sensing="feature", tunable=tunable)
    numbers, source = list(law.coefficients.values()), flown_law(mission)
    vehicle, goal = mission.vehicle, source.goal_feature(mission)
    design = [*source.design.values(mission, goal), vehicle.reach, vehicle.drag_ratio, Fraction(1)]
    for i, name in enumerate(law.coefficients):
        if "heading" in name:
            changed = [*numbers[:i], numbers[i] * (1 + Fraction(1, 10**12)), *numbers[i + 1 :]]
            with pytest.raises(AssertionError):
                assert_is_the_controller(law.function, design, changed, source)


@pytest.fixture(scope="module", params=["float32", "float64"])
def headed(request, tmp_path_factory):
    tool("cc")
    folder = tmp_path_factory.mktemp("headed")
    mission = mission_of(BEST)
    hoverproof.export_c(mission, folder, allow_uncertified=True, precision=request.param)
    return Firmware(folder), mission


def step_at(firmware, heading, yaw_rate=0.0):
    firmware.reset()
    square = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) / 12
    return firmware.step(
        square,
        velocity=[0, 0, 0],
        rate=[0, 0, yaw_rate],
        gravity_direction=[0, 0, 1],
        specific_force=[0, 0, -9.81],
        heading=heading,
        dt=0.004,
    )


def test_a_step_turns_to_the_heading(headed):
    firmware, mission = headed
    assert firmware.selftest() == 0
    for yaw in (-3, -1, 0, 1.2, 2, 3.1):
        out = step_at(firmware, [math.cos(yaw), math.sin(yaw)], yaw_rate=0.1)
        gains = float(mission.k_heading), float(mission.gains.k_yaw)
        expected = -gains[0] * math.sin(yaw - 1.2) - gains[1] * 0.1
        assert out.torque[2] == pytest.approx(expected, rel=1e-5, abs=1e-8)
        assert out.status & ~(32 | 64) == 0


@pytest.mark.parametrize(
    "heading",
    [[0, 0], [math.nan, 0], [0, math.nan], [math.inf, 0], [1, 1], [1e30, 1e30], [0.05, 0.05]],
    ids=str,
)
def test_without_a_heading_the_step_flies_on_and_damps_yaw_alone(headed, heading):
    firmware, mission = headed
    out = step_at(firmware, heading, yaw_rate=0.1)
    assert out.status & ~(32 | 64) == 128
    assert out.torque[2] == pytest.approx(-float(mission.gains.k_yaw) * 0.1, rel=1e-5)
    assert out.thrust == pytest.approx(4.905, rel=1e-6)


def apart(mission, step):
    """Fly the firmware and the model to the heading; return how far apart they come, m."""
    ours, theirs = (
        fly(mission, duration=8, step=step)
        for fly in (hoverproof.fly_firmware, hoverproof.simulate)
    )
    assert ours.attrs["outcome"] == theirs.attrs["outcome"] == "flown"
    assert yaw_of(ours)[-1] == pytest.approx(yaw_of(theirs)[-1], abs=2e-3)
    assert yaw_of(ours)[-1] == pytest.approx(1.2, abs=0.05)
    return np.linalg.norm(ours["position"].values - theirs["position"].values, axis=1).max()


@pytest.mark.slow
@pytest.mark.parametrize("choices", mostly_whole([(BEST,), (PAPERS,)], every=2))
def test_the_firmware_flies_as_the_simulation_does(choices):
    tool("cc")
    for overrides in ({}, REAL):
        mission = mission_of(choices, overrides=overrides)
        step = 0.002 if not overrides else None
        assert apart(mission, step) < 0.01


def test_a_package_without_heading_knows_nothing_of_it(tmp_path):
    manifest = hoverproof.export_c(mission_of(BEST, None), tmp_path, allow_uncertified=True)
    assert not [p for p in manifest["files"] if "HEADING" in (tmp_path / p).read_text()]


# --- certificates ---------------------------------------------------------------------------------


def test_a_certificate_says_that_it_holds_for_any_yaw_rate():
    plain, headed = (certify(load("x4-flyer", o)).proved for o in ({}, {"goal.heading": "0.5"}))
    assert "Ω3 = 0" in plain.statement
    assert "whatever the yaw rate Ω3 is" in headed.statement
    content = headed.certificate.content
    checker.check(content)
    bounds = [v.certificate.content["claim"] for v in (plain, headed)]
    assert bounds[0] == bounds[1]


def test_a_goal_above_an_irregular_target_holds_for_any_yaw_rate_too():
    """It is where the centroid is exactly straight below, so Ω3 is in no error."""
    points = [[1, 1, 0], [1, -1, 0], [-1, -1, Fraction("0.1")], [Fraction("-1.1"), 1, 0]]
    proved = certify(load("x4-flyer", {"goal.heading": "0.5", "target.points": points})).proved
    assert "whatever the yaw rate Ω3 is" in proved.statement


def test_a_gain_of_a_heading_without_one_is_rejected():
    content = dict(certify(load("x4-flyer", {"goal.heading": "0.5"})).proved.certificate.content)
    mission = {**content["mission"], "gains": {**content["mission"]["gains"], "k_heading": "1"}}
    mission["goal"] = {"height": mission["goal"]["height"]}
    content["mission"], content["mission_sha256"] = mission, checker.digest(mission)
    content["sha256"] = checker.digest({k: v for k, v in content.items() if k != "sha256"})
    with pytest.raises(checker.Rejected, match="no heading to turn to"):
        checker.check(content)


@pytest.mark.slow
def test_a_start_that_sinks_is_not_refuted_for_a_vehicle_that_turns():
    low = {"start.position": [0, 0, Fraction("-0.02")], "start.velocity": [0, 0, 3]}
    plain, headed = (
        hoverproof.attraction(load("x4-flyer", low | own), objective="start")
        for own in ({}, {"goal.heading": "0.5"})
    )
    assert plain.status == "refuted"
    assert headed.status == "undecided"
    assert "turns to a heading" in headed.reason
