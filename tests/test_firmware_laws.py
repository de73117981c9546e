"""The exported firmware of each of the eight laws."""

from __future__ import annotations

import itertools
import tomllib
from fractions import Fraction

import numpy as np
import pytest

import hoverproof
from firmware_kit import export, tool
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.export.chain import body_sensors
from hoverproof.export.flight_law import flight_law
from hoverproof.export.same_controller import assert_is_the_controller
from hoverproof.mission.reading import load
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.choices import WithAccelerometer
from hoverproof.servo.laws.hamel_mahony import LAWS, law_of
from hoverproof.servo.loop import LoopNumbers
from sampling import mostly_whole
from small_kit import small_vehicle

EACH_LAW = pytest.mark.parametrize("choices", LAWS, ids="/".join)
SMALL = small_vehicle(bounds="[0.04, 10]", start="[0.3, 0.2, -1.5]")
"""A small vehicle with gains for the scaled feature, over a small target."""

Q_GAINS = {"gains.k1": Fraction("0.5"), "gains.k2": Fraction("1.5")}
"""Gains for the centroid of that target, which moves far less than the scaled feature."""


def mission_of(choices, overrides=()):
    named = dict(zip(("feature", "goal", "force"), choices, strict=True))
    small = tomllib.loads(SMALL, parse_float=Fraction)
    return load("x4-flyer", {**small, "law": named, **dict(overrides)})


def made(folder, choices, overrides=(), **options):
    tool("cc")
    mission = mission_of(choices, overrides)
    hoverproof.export_c(mission, folder, allow_uncertified=True, **options)
    return Firmware(folder), mission


def step_at(firmware, seen, **changes):
    calm = {"velocity": [0, 0, 0], "rate": [0, 0, 0], "gravity_direction": [0, 0, 1], "dt": 0.001}
    if "specific_force_length_m_per_s2" in firmware.manifest["input_box"]:
        calm["specific_force"] = [0, 0, -9.8]
    return firmware.step(seen, **{**calm, **changes})


UNPROVED = 64  # a bit of all steps with gains of which nothing is proved
SQUARE = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) / 12


def centroid_of(image):
    rays = np.column_stack([image, np.ones(len(image))])
    return (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)


def feature_of(image, name):
    """What a law makes of an image, written down apart, as one finds it in words."""
    q, n = centroid_of(image), len(image)
    a = np.linalg.norm(q)
    return q if name == "centroid" else q / a / np.sqrt(2 * (1 - a / n))


# --- it is the controller -------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("choices", "tunable"), mostly_whole(itertools.product(LAWS, [False, True]), every=3)
)
def test_the_law_is_the_derived_controller_exactly(choices, tunable):
    mission = mission_of(choices)
    law = flight_law(mission, sensing="feature", tunable=tunable)
    assert law.function.n_instructions() < 250
    numbers, source = list(law.coefficients.values()), law_of(mission)
    vehicle, goal = mission.vehicle, source.goal_feature(mission)
    design = [*source.design.values(mission, goal), vehicle.reach, vehicle.drag_ratio, Fraction(1)]
    assert_is_the_controller(law.function, design, numbers, source)
    for i in range(len(numbers)):
        changed = [*numbers[:i], numbers[i] * (1 + Fraction(1, 10**12)), *numbers[i + 1 :]]
        with pytest.raises(AssertionError):
            assert_is_the_controller(law.function, design, changed, source)


@pytest.mark.parametrize(
    ("choices", "sensing"),
    [
        case
        for number, law in enumerate(LAWS)
        for case in mostly_whole([(law, "points"), (law, "centroid")], every=4, first=number % 4)
    ],
)
def test_the_c_computes_the_law_of_a_feature_worked_out_apart(choices, sensing, tmp_path):
    firmware, mission = made(tmp_path, choices, precision="float64", sensing=sensing)
    assert firmware.selftest() == 0
    law, numbers = law_of(mission), LoopNumbers.of(mission)
    controller, draw = derive_controller(law).function(), np.random.default_rng(1)
    weight, mass = numbers.hover_thrust, float(mission.vehicle.mass)
    for _ in range(50):
        image = SQUARE + draw.normal(0, 0.1, (4, 2))
        body = {name: draw.normal(0, 0.3, 3) for name in body_sensors(law)}
        body["gravity_direction"] = np.array([*draw.normal(0, 0.1, 2), 1])
        thrust = weight * draw.uniform(0.9, 1.1)
        if "specific_force" in body:
            body["specific_force"][2] -= thrust / mass * draw.uniform(0.95, 1.05)
        assert firmware.reset(thrust) == 0
        seen = image if sensing == "points" else centroid_of(image)
        out = step_at(firmware, seen, **body)
        parts = {**body, "centroid": feature_of(image, law.feature.name), "thrust": [thrust]}
        measured = np.concatenate([parts[name] for name in law.measurement.sizes()])
        thrust_rate, torque = (np.array(v).ravel() for v in controller(measured, numbers.design))
        tight = 1e-9 if sensing == "points" else 1e-7
        assert [out.thrust_rate, *out.torque] == pytest.approx(
            [*thrust_rate, *torque], rel=tight, abs=tight
        )
        assert out.thrust == pytest.approx(thrust, rel=1e-12)


@pytest.mark.parametrize("choices", mostly_whole([(law,) for law in LAWS], every=3))
def test_float32_is_within_a_hundred_thousandth_of_the_scale_of_float64(choices, tmp_path):
    pair = [made(tmp_path / p, choices, precision=p)[0] for p in ("float32", "float64")]
    draw, rows = np.random.default_rng(2), []
    for _ in range(500):
        image = np.float32(SQUARE + draw.normal(0, 0.1, (4, 2)))
        body = {name: np.float32(draw.normal(0, 0.5, 3)) for name in ("velocity", "rate")}
        if choices[2] == "measured":
            body["specific_force"] = np.float32([*draw.normal(0, 1, 2), -draw.uniform(8.5, 11)])
        row = []
        for firmware in pair:
            assert firmware.reset(4.905) == 0
            out = step_at(firmware, image, **body)
            assert not out.status & 7
            row.append([out.thrust_rate, *out.torque])
        rows.append(row)
    single, double = np.array(rows).transpose(1, 0, 2)
    worst = np.abs(single - double).max(axis=0) / np.abs(double).max(axis=0)
    assert (worst <= 1e-5).all(), worst


# --- it flies -------------------------------------------------------------------------------------


@pytest.mark.parametrize("choices", mostly_whole([(law,) for law in LAWS], every=3, first=1))
def test_the_firmware_flies_as_the_simulation_does(choices):
    tool("cc")
    mission = mission_of(choices, Q_GAINS if choices[0] == "centroid" else ())
    flown, ideal = (
        fly(mission, duration=8, step=0.001)
        for fly in (hoverproof.fly_firmware, hoverproof.simulate)
    )
    assert flown.attrs["outcome"] == ideal.attrs["outcome"] == "flown"
    ours, theirs = (f["position"].values for f in (flown, ideal))
    apart = np.linalg.norm(ours - theirs, axis=1).max()
    gone = np.linalg.norm(theirs[-1] - theirs[0])
    assert gone > 0.2
    assert apart < 1e-2 * gone


@pytest.mark.slow
@pytest.mark.parametrize("choices", mostly_whole([(law,) for law in LAWS], every=3, first=2))
def test_a_start_from_any_thrust_commands_just_that_and_goes_on_from_there(choices, tmp_path):
    firmware, _ = made(tmp_path, choices)
    for thrust in (4.2, 4.905, 5.7):
        assert firmware.reset(thrust) == 0
        felt = {"specific_force": [0, 0, -thrust / 0.5]} if choices[2] == "measured" else {}
        first = step_at(firmware, SQUARE, **felt)
        assert first.status & ~UNPROVED == 0
        assert first.thrust == pytest.approx(thrust, rel=1e-6)
        second = step_at(firmware, SQUARE, **felt)
        assert second.thrust == pytest.approx(thrust + 0.001 * first.thrust_rate, rel=1e-6)


# --- force measured ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def feeling(tmp_path_factory):
    folder = tmp_path_factory.mktemp("feeling")
    return made(folder, ("centroid", "inertial", "measured"))[0]


@pytest.mark.parametrize(
    ("force", "status"),
    [
        ([0, 0, 0], 4),  # falls
        ([0, 0, 9.8], 4),  # upside down, or the axes are the wrong way round
        ([0, 0, -99.0], 4),  # more than any rotor gives
        ([0, np.nan, -9.8], 1),
        ([0, 0, -np.inf], 1 + 4),
        ([150, 60, -9.8], 1),
        ([0, 0, -13.0], 8),  # out of the interval, 6 N
        ([0.3, -0.2, -9.8], 0),
    ],
)
def test_what_is_felt_of_the_thrust_has_its_status(feeling, force, status):
    feeling.reset()
    out = step_at(feeling, SQUARE, specific_force=force)
    assert out.status & ~UNPROVED == status
    if status & 7:
        assert out.thrust == pytest.approx(4.905, rel=1e-6)
        assert (out.torque, out.thrust_rate, feeling.thrust_excess) == ((0, 0, 0), 0, 0)


def test_a_step_that_is_told_nothing_of_the_force_is_a_fault(feeling):
    feeling.reset()
    still = {"velocity": [0, 0, 0], "rate": [0, 0, 0], "gravity_direction": [0, 0, 1], "dt": 0.001}
    assert feeling.step(SQUARE, **still).status == 4


def test_the_thrust_that_counts_in_the_lever_is_the_one_felt(feeling):
    tilted = {"rate": [0.4, -0.3, 0.1], "gravity_direction": [0.1, 0.05, 0.99]}
    torques = []
    for commanded, felt in ((4.5, -9.0), (5.5, -9.0), (5.5, -11.0)):
        feeling.reset(commanded)
        out = step_at(feeling, SQUARE, specific_force=[0, 0, felt], **tilted)
        assert out.thrust == pytest.approx(commanded, rel=1e-6)
        torques.append(out.torque)
    assert torques[0] == torques[1]
    assert torques[1] != pytest.approx(torques[2], rel=1e-3)


def test_an_ideal_accelerometer_feels_minus_g_in_hover(feeling):
    numbers = LoopNumbers.of(mission_of(("centroid", "inertial", "measured")))
    felt = numbers.measured()[WithAccelerometer.place("specific_force")]
    assert felt == pytest.approx([0, 0, -9.81])
    assert feeling.manifest["input_box"]["specific_force_length_m_per_s2"] == [0, 160.0]


# --- the feature of the target's size -----------------------------------------------------------


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_a_target_without_size_is_a_fault(precision, tmp_path):
    firmware, _ = made(tmp_path, ("scaled", "inertial", "modelled"), precision=precision)
    low = firmware.manifest["input_box"]["angular_radius_rad"][0]
    at = np.array([0.3, -0.2])
    for size, status in ((0, 1), (0.5 * low, 1), (2 * low, 0), (0.1, 0)):
        firmware.reset()
        assert step_at(firmware, at + 12 * size * SQUARE).status & ~(32 | UNPROVED) == status


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_a_centroid_that_no_target_has_is_a_fault(precision, tmp_path):
    scaled = ("scaled", "image", "modelled")
    firmware, _ = made(tmp_path, scaled, precision=precision, sensing="centroid")
    for length, status in ((0, 1), (0.1, 1), (4, 1), (4.01, 1), (3.9, 0), (-3.9, 0)):
        firmware.reset()
        assert step_at(firmware, [0, 0, length]).status & ~(32 | UNPROVED) == status


@pytest.mark.slow
def test_in_float32_a_centroid_tells_the_size_to_a_thousandth_where_it_is_taken(tmp_path):
    """Close to the smallest target that is taken; image points lose nothing there."""
    errors = {}
    for sensing in ("points", "centroid"):
        scaled, rates = ("scaled", "inertial", "modelled"), []
        for precision in ("float32", "float64"):
            folder = tmp_path / sensing / precision
            firmware, _ = made(folder, scaled, precision=precision, sensing=sensing)
            draw, row = np.random.default_rng(3), []
            for _ in range(200):
                image = draw.uniform(-0.3, 0.3, 2) + 12 * 0.0105 * SQUARE / np.sqrt(2)
                seen = image if sensing == "points" else centroid_of(image)
                firmware.reset()
                out = step_at(firmware, seen)
                row.append([out.thrust_rate] if not out.status & 1 else [np.nan])
            rates.append(row)
        single, double = np.array(rates)
        assert np.isfinite(double).mean() > 0.9
        errors[sensing] = np.nanmax(np.abs(single / double - 1))
    assert errors["points"] < 1e-5
    assert 1e-5 < errors["centroid"] < 2e-3


def test_a_target_too_small_for_a_centroid_in_float32_is_refused(tmp_path):
    far = {"goal": {"height": 12}}
    mission = mission_of(("scaled", "inertial", "modelled"), far)
    options = {"sensing": "centroid", "allow_uncertified": True}
    with pytest.raises(InputError, match=r"target: .* lost in rounding; take sensing points or"):
        hoverproof.export_c(mission, tmp_path / "fw", **options)
    assert not (tmp_path / "fw").exists()
    hoverproof.export_c(mission, tmp_path / "fw", precision="float64", **options)
    hoverproof.export_c(mission, tmp_path / "other", allow_uncertified=True)


def test_the_paper_s_law_takes_in_what_it_always_did(tmp_path):
    package = export(tmp_path)
    header = (tmp_path / f"{package.name}.h").read_text()
    assert "specific_force" not in header
    assert "SPREAD" not in (tmp_path / f"{package.name}_params.h").read_text()
    felt = export(
        tmp_path / "felt", overrides={"law": {"force": "measured"}}, allow_uncertified=True
    )
    assert "(0, 0, -g) in hover" in (tmp_path / "felt" / f"{felt.name}.h").read_text()
