"""A package that commands body rates and thrust to an autopilot's own rate loop."""

from __future__ import annotations

import re
import shutil
from fractions import Fraction

import numpy as np
import pytest

import hoverproof
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.export.flight_law import flight_law
from hoverproof.export.options import Options
from hoverproof.export.same_controller import assert_is_the_controller
from hoverproof.mission.reading import load
from hoverproof.servo.laws.heading import flown_law
from test_firmware_laws import SQUARE, feature_of, made, mission_of, step_at

BEST = ("scaled", "inertial", "measured")
BANDWIDTH = 25
LOOP = {"interface": {"rate_bandwidth": BANDWIDTH}}
SEEN = feature_of(SQUARE, "scaled")
HOVERING = [0.0, 0.0, -9.81]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("rates")


@pytest.fixture(scope="module")
def loop(folder):
    return made(folder, BEST, LOOP, precision="float64", camera=True)


@pytest.fixture
def firmware(loop):
    loop[0]._call("init", loop[0]._params)  # whatever a test took over from
    loop[0].reset()
    return loop[0]


def test_the_rates_commanded_are_those_of_the_derived_controller_exactly():
    mission = mission_of(BEST, LOOP)
    law = flight_law(mission, sensing="feature", rates=True)
    source = flown_law(mission).flying(mission)
    design = [
        *source.design.values(mission, source.goal_feature(mission)),
        mission.vehicle.reach,
        mission.vehicle.drag_ratio,
        Fraction(BANDWIDTH),
    ]
    numbers = list(law.coefficients.values())
    assert_is_the_controller(law.function, design, numbers, source)
    with pytest.raises(AssertionError, match="rate_command"):
        assert_is_the_controller(law.function, [*design[:-1], Fraction(24)], numbers, source)


def test_the_c_commands_the_rate_and_the_acceleration_of_its_torque_over_the_bandwidth(loop):
    firmware, mission = loop
    inertia, draw = np.array(mission.vehicle.inertia, float), np.random.default_rng(0)
    for _ in range(50):
        rate, velocity = draw.normal(0, 1, 3), draw.normal(0, 0.5, 3)
        firmware.reset()
        out = step_at(firmware, SEEN, rate=rate, velocity=velocity)
        gyroscopic = np.cross(rate, inertia * rate)
        wanted = (np.array(out.torque) - gyroscopic) / inertia
        assert out.rate_command == pytest.approx(rate + wanted / BANDWIDTH, rel=1e-9, abs=1e-12)


def test_the_selftest_passes_and_covers_the_rates(loop, folder, tmp_path):
    firmware, _ = loop
    assert firmware.selftest() == 0
    changed = shutil.copytree(folder, tmp_path / "changed")
    source = changed / f"{firmware.name}.c"
    text = source.read_text()
    assert "out->rate_command[1] = " in text
    source.write_text(text.replace("out->rate_command[1] = ", "out->rate_command[1] = 2.0 * "))
    assert Firmware(changed).selftest() == 1


def test_by_an_ideal_loop_the_vehicle_flies_as_the_model_does(loop):
    firmware, mission = loop
    modelled = hoverproof.simulate(mission, duration=4, step=0.001, every=100)["position"].values
    assert np.linalg.norm(modelled[-1, :2]) < np.linalg.norm(modelled[0, :2]) / 2
    apart = []
    for dt in (0.002, 0.001):
        firmware.reset()
        flown = firmware.fly(dt, 40, round(0.1 / dt))["state"][:, :3]
        apart.append(np.abs(flown - modelled).max())
    assert apart[0] < 5e-3  # what a command that is held makes
    assert apart[1] < 0.6 * apart[0]


@pytest.mark.parametrize("throttle", [0.12, 0.4, 0.9])
@pytest.mark.parametrize("felt", [-8.5, -9.8, -11.0])
def test_the_first_step_after_a_take_over_has_the_throttle_before(firmware, throttle, felt):
    """Whatever mass, battery and rotors are; and a newton goes on to cost as much throttle."""
    assert firmware.take_over([0.1, -0.1, felt], throttle) == 0
    first = step_at(firmware, SEEN, specific_force=[0, 0, felt], velocity=[0, 0, 0.2])
    assert first.throttle == pytest.approx(throttle, rel=1e-12)
    second = step_at(firmware, SEEN, specific_force=[0, 0, felt])
    assert second.thrust != first.thrust
    assert second.throttle / second.thrust == pytest.approx(throttle / first.thrust, rel=1e-12)


def test_the_throttle_ends_at_full(firmware):
    assert firmware.take_over(HOVERING, 0.99) == 0
    status = 0
    for _ in range(400):
        out = step_at(firmware, SEEN, velocity=[0, 0, 2.0], specific_force=HOVERING)
        status |= out.status
        assert out.throttle <= 1
    assert out.throttle == pytest.approx(1)
    assert status & 32


@pytest.mark.parametrize(
    ("felt", "throttle"),
    [
        (HOVERING, 0.0),
        (HOVERING, 1.01),
        (HOVERING, np.nan),
        ([0, 0, 0], 0.4),
        ([0, 0, 9.8], 0.4),
        ([0, 0, np.nan], 0.4),
        ([0, 0, -30.0], 0.4),
    ],
)
def test_a_take_over_from_what_is_no_steady_flight_is_refused(firmware, felt, throttle):
    before = step_at(firmware, SEEN)
    firmware.reset()
    assert firmware.take_over(felt, throttle) == 1
    assert step_at(firmware, SEEN) == before


def test_a_fault_commands_no_rate_and_the_throttle_of_hover(firmware):
    assert firmware.take_over(HOVERING, 0.4) == 0
    out = step_at(firmware, SEEN, target_seen=False, rate=[1, 2, 3])
    assert out.status == 2
    assert out.rate_command == (0, 0, 0)
    assert out.throttle == pytest.approx(0.4)


def test_a_loop_within_a_fifth_late_images_and_noise_still_settle(loop):
    """A rate loop that runs at each step, with inertia that is not the mission's."""
    rough = {
        "model_error.inertia": "[0.2, -0.15, 0]",
        "model_error.thrust": "-0.1",
        "sensors.control_rate": "125",
        "sensors.frame_rate": "31.25",
        "sensors.latency": "0.016",
        "sensors.gyro_turned": "true",
        "sensors.gyro_noise": "0.02",
        "rotors.time_constant": "0.02",
    }
    mission = mission_of(BEST, LOOP | rough)
    flight = hoverproof.fly_firmware(mission, loop[0], duration=4, step=0.008)
    assert flight.attrs["outcome"] == "flown"
    goal = [0, 0, -float(mission.goal.height)]
    assert np.abs(flight["position"].values[-1] - goal).max() < 0.05
    assert '"control_rate": "125"' in flight.attrs["conditions"]


def test_the_package_says_what_it_relies_on_and_has_no_adapter_for_torques(loop):
    firmware, _ = loop
    assert firmware.manifest["rate_bandwidth"] == str(BANDWIDTH)
    assert not [p for p in firmware.manifest["files"] if p.startswith("adapters/px4")]
    with pytest.raises(InputError, match=r"interface.rate_bandwidth.*25"):
        other = mission_of(BEST, {"interface": {"rate_bandwidth": 26}})
        hoverproof.fly_firmware(other, firmware, duration=1)


@pytest.mark.parametrize(
    ("overrides", "interface", "told"),
    [
        ({}, "rates", "interface.rate_bandwidth: is missing"),
        ({"interface.rate_bandwidth": "25"}, "rate", "interface: must be torques or rates"),
        (
            {"law.force": "modelled", "interface.rate_bandwidth": "25"},
            None,
            "law.force: must be 'measured'",
        ),
        ({"interface.rate_bandwidth": "0"}, None, "interface.rate_bandwidth: must be"),
        (
            {"interface.rate_bandwidth": "25", "uncertainty.control_period": "0.004"},
            None,
            "uncertainty.control_period: is proved for torques that are held",
        ),
    ],
)
def test_what_no_rate_loop_can_be_commanded_with_is_refused(overrides, interface, told):
    if "law.force" in overrides:
        overrides |= {f"uncertainty.{key}": "0" for key in ("thrust", "wind", "rotor_lag")}
    fixed = {"precision": "float32", "sensing": "points", "tunable": False, "rotor_limits": None}
    with pytest.raises(InputError, match=re.escape(told)):
        Options.of(load("crazyflie-2.1", overrides), **fixed, interface=interface)


def test_a_mission_without_a_rate_loop_commands_torques_and_one_with_it_either():
    fixed = {"precision": "float32", "sensing": "points", "tunable": False, "rotor_limits": None}
    mission = load("crazyflie-2.1")
    assert not Options.of(mission, **fixed).rates
    looped = load("crazyflie-2.1", {"interface.rate_bandwidth": "25"})
    assert Options.of(looped, **fixed).rates
    assert not Options.of(looped, **fixed, interface="torques").rates
    assert looped.exact() == mission.exact()
