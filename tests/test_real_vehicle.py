"""The law that measures its force on a vehicle as built: weak, heavy, in wind, with late frames."""

from __future__ import annotations

import re
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import fsolve

from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.firmware.exporting import export_c
from hoverproof.firmware.flying import fly_firmware
from hoverproof.mission.presets import conditions_text
from hoverproof.mission.reading import load
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.layout import place
from hoverproof.simulation import compiled, gyro
from hoverproof.simulation.block import fly_raw
from hoverproof.simulation.draws import lag_shares, memory_and_parameters
from hoverproof.simulation.flight import simulate, summary, without_conditions
from hoverproof.simulation.plan import Plan, check_runs_differ
from hoverproof.simulation.sensing import felt
from hoverproof.simulation.surroundings import FurtherSurroundings
from hoverproof.simulation.timing import fastest_rate
from sampling import mostly_whole
from small_kit import small_vehicle

needs_compiler = pytest.mark.skipif(not compiled.find_compiler(), reason="no C compiler here")

VEHICLE = small_vehicle(bounds="[0.1, 10]", start="[0.6, 0, -1.8]")
LAW = {"law": '{feature = "scaled", goal = "inertial", force = "measured"}'}
IMAGE = {"law": '{feature = "scaled", goal = "image", force = "measured"}'}
SENSORS = (
    "{control_rate = 250, frame_rate = 30, latency = 0.04, focal_length = 600, pixel_noise = 1, "
    "gyro_turned = true}"
)
ERRORS = {"model_error": "{mass = 0.15, thrust = -0.15}"}
WIND = {"wind": "{mean = [0.5, 0, 0], drag = 0.5}"}  # 0.25 N at rest
REAL = {"sensors": SENSORS, "rotors.time_constant": "0.03", **WIND, **ERRORS}
CORNERS = np.array([[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, -0.1, 0], [-0.1, 0.1, 0]])
START_ERROR = np.linalg.norm([0.6, 0, -0.6])


@pytest.fixture
def vehicle(tmp_path):
    """Make a mission of the vehicle of 0.5 kg."""
    path = tmp_path / "small.toml"
    path.write_text(VEHICLE)
    return lambda *changes: load(path, {k: v for change in changes for k, v in change.items()})


def centroid(position, rotation):
    seen = (CORNERS - position) @ rotation
    return (seen / np.linalg.norm(seen, axis=1)[:, None]).sum(axis=0)


def feature(position, rotation):
    """The scaled feature, in plain numpy."""
    q = centroid(position, rotation)
    length = np.linalg.norm(q)
    return q / length / np.sqrt(2 * (1 - length / len(CORNERS)))


LEVEL = np.eye(3)
WANTED = feature(np.array([0, 0, -1.2]), LEVEL)[2]
"""s3*: the third component of the feature at the goal."""


def hover_that_sees(wanted, rotation):
    """Where a vehicle of that attitude has that feature."""
    return fsolve(lambda p: feature(p, rotation) - wanted, [0, 0, -1.2], xtol=1e-12)


def settled_before(flight, place, seconds):
    """Whether a flight is within a tenth of its start's distance of a place, then and for good."""
    far = np.linalg.norm(flight["position"].values - place, axis=1)
    return (far[flight["time"].values >= seconds] < 0.1 * START_ERROR).all()


def mean_end(flight):
    time = flight["time"].values
    return flight["position"].values[time > time[-1] - 4].mean(axis=0)


def test_it_is_at_its_goal_in_three_seconds_ideal_or_weak_heavy_in_wind_and_late(vehicle):
    for change in ({}, *({**REAL, "start.rotation": f"[0, 0, {yaw}]"} for yaw in (0, 0.5))):
        for seed in range(3 if change else 1):
            flight = simulate(vehicle(LAW, change), duration=10, seed=seed)
            assert flight.attrs["outcome"] == "flown"
            assert settled_before(flight, [0, 0, -1.2], 3)
            assert np.linalg.norm(mean_end(flight) - [0, 0, -1.2]) < 0.02


def test_fixed_in_the_image_it_hovers_where_the_leaning_camera_has_the_target_in_its_axis(vehicle):
    down = np.array([0.25, 0, 0.575 * 9.81])  # wind and weight, which the thrust carries
    leaning = rotation_matrix(0, np.arctan2(down[0], down[2]), 0)
    assert leaning[:, 2] == pytest.approx(down / np.linalg.norm(down))
    there = hover_that_sees([0, 0, WANTED], leaning)
    assert np.linalg.norm(there - [0, 0, -1.2]) > 0.05  # else this would show nothing
    for seed in range(3):
        flight = simulate(vehicle(IMAGE, REAL), duration=10, seed=seed)
        assert settled_before(flight, there, 3)
        assert np.linalg.norm(mean_end(flight) - there) < 0.02
        assert abs(flight["euler_angles"].values[-1, 2]) < 0.01
    ideal = simulate(vehicle(IMAGE), duration=10)
    assert settled_before(ideal, [0, 0, -1.2], 3)


@pytest.mark.slow
def test_the_law_of_the_paper_is_lost_where_its_force_is_not_the_modelled_one(vehicle):
    bare = {name: value for name, value in REAL.items() if name not in ("model_error", "wind")}
    assert simulate(vehicle(bare), duration=10).attrs["outcome"] == "flown"
    lost = simulate(vehicle(REAL), duration=10)
    assert "hit the height of the target" in lost.attrs["outcome"]


# The accelerometer


def at_start(mission, **memory):
    """Return a plan, and memory by name and surroundings of one vehicle at its start."""
    plan = Plan(mission, 0.002, 1, 1)
    values, params = memory_and_parameters(plan, np.arange(1))
    layout, law = plan.features.layout(plan.numbers.law), plan.numbers.law
    parts = {name: ca.DM(values[0, place(layout, name)]) for name in layout} | memory
    around = FurtherSurroundings.from_vector(ca.DM(params[0, law.design.size() :]))
    return plan, parts, around


def reading(mission, noise=(0, 0, 0)):
    _, memory, around = at_start(mission)
    return np.array(ca.evalf(ca.SX(felt(memory, around, ca.DM(noise))))).ravel()


def test_at_rest_it_reads_what_holds_the_vehicle_up(vehicle):
    still = {"start.position": "[0, 0, -1.2]", "sensors.control_rate": "250"}
    assert reading(vehicle(LAW, still)) == pytest.approx([0, 0, -9.81], rel=1e-12)
    weak = still | {"model_error": "{mass = 0.15, thrust = -0.15}"}  # as it falls
    assert reading(vehicle(LAW, weak)) == pytest.approx([0, 0, -9.81 * 0.85 / 1.15], rel=1e-12)
    blown = still | WIND | {"start.rotation": "[0, 0, 1.5707963267948966]"}
    assert reading(vehicle(LAW, blown)) == pytest.approx([0, -0.5, -9.81], abs=1e-9)
    hover = simulate(vehicle(LAW, REAL, {"sensors": "{control_rate = 250}"}), duration=15)
    assert np.degrees(hover["tilt"].values[-1]) == pytest.approx(2.54, abs=0.01)
    down = hover["rotation"].values[-1].T @ [0, 0, 1]
    assert hover["specific_force"].values[-1] == pytest.approx(-9.81 * down, abs=1e-4)


def test_noise_and_bias_come_on_top_and_each_run_draws_its_bias_once(vehicle):
    change = {"sensors": "{control_rate = 250, accelerometer_noise = 0.3, accelerometer_bias = 2}"}
    mission = vehicle(LAW, change)
    plan = Plan(mission, 0.004, 1, 1)
    _, params = memory_and_parameters(plan, np.arange(2000))
    first = law_of(mission).design.size()
    biases = params[:, first:][:, FurtherSurroundings.place("accelerometer_bias")]
    assert biases.std(axis=0) == pytest.approx([2, 2, 2], rel=0.05)
    quiet = reading(mission)
    assert quiet == pytest.approx(np.array([0, 0, -9.81]) + biases[0], rel=1e-12)
    assert reading(mission, (1, -2, 0.5)) - quiet == pytest.approx([0.3, -0.6, 0.15], rel=1e-9)
    one, other = (simulate(mission, duration=1, seed=seed) for seed in (0, 1))
    assert not np.array_equal(one["position"], other["position"])
    check_runs_differ(mission, 2)
    with pytest.raises(ValueError, match="flights would be the same"):
        check_runs_differ(vehicle(change), 2)  # the law of the paper reads no accelerometer


def test_what_is_recorded_is_the_acceleration_that_the_velocity_shows(vehicle):
    """V' by differences of the flight, of the true mass, thrust and drag; and δ3 is made of it."""
    unsteady = {"rotors.time_constant": "0.03", "sensors.control_rate": "100", **WIND, **ERRORS}
    mission = vehicle(LAW, unsteady, {"start.rates": "[1, -0.5, 2]"})
    flight = simulate(mission, duration=2, step=0.001, every=1)
    V, R, Omega = (flight[name].values for name in ("velocity", "rotation", "body_rate"))
    shown = (V[2:] - V[:-2]) / 0.002 + np.cross(Omega, V)[1:-1]
    down = R[1:-1, 2, :]
    recorded = flight["specific_force"].values[1:-1]
    assert np.abs(recorded - (shown - 9.81 * down)).max() < 2e-3
    assert np.ptp(recorded, axis=0).max() > 1
    stiffness = 0.0566**2 * 22 / 0.5
    force = 0.5 * (recorded + 9.81 * down)  # of the modelled mass: that is what the law divides by
    d3 = force / stiffness + flight["delta2"].values[1:-1]
    assert flight["delta3"].values[1:-1] == pytest.approx(d3, rel=1e-9, abs=1e-9)
    squares = sum((flight[f"delta{i}"].values ** 2).sum(axis=1) for i in (1, 2, 3, 4))
    assert flight["lyapunov"].values == pytest.approx(squares / 2, rel=1e-9)
    plan = Plan(mission, 0.001, 2000, 1, scattered=False)
    level = fly_raw(plan, 0, 1)[0][0][:, place(plan.record, "lyapunov")]
    assert level[:, 0] == pytest.approx(squares / 2, rel=1e-9)


def test_what_it_divides_by_is_made_of_the_thrust_that_it_measures(vehicle):
    """The margin that ends a flight is T - c s3* of T = 0.5 kg times what is felt."""
    mission = vehicle(IMAGE, {"start.position": "[0, 0, -1.2]", **ERRORS})
    plan, memory, _ = at_start(mission)
    _, params = memory_and_parameters(plan, np.arange(1))
    after = plan.loop.functions["control"](ca.vertcat(*memory.values()), params[0], np.zeros(12))
    margin = float(after[place(plan.features.layout(plan.numbers.law), "thrust_margin")])
    stiffness = 0.0566**2 * 22 / 0.5
    assert margin == pytest.approx(0.5 * 9.81 * 0.85 / 1.15 - stiffness * WANTED, rel=1e-6)


def test_its_low_pass_answers_a_step_and_a_ramp_as_a_first_order_lag_does(vehicle):
    change = {"sensors": "{control_rate = 250, accelerometer_time_constant = 0.02}"}
    still = {"start.position": "[0, 0, -1.2]"}
    asked = ca.DM.ones(4) * 1.2 * 0.5 * 9.81 / 4  # which rotors without a lag give at once
    begin = {"accelerometer": ca.DM.zeros(3), "rotor_commands": asked}
    plan, memory, _ = at_start(vehicle(LAW, change, still), **begin)
    _, params = memory_and_parameters(plan, np.arange(1))
    now, move = ca.vertcat(*memory.values()), plan.loop.functions["move"]
    place_of_it = place(plan.features.layout(plan.numbers.law), "accelerometer")
    for step in range(1, 40):
        now = move(now, params[0], plan.numbers.points, np.zeros(3))
        told = -1.2 * 9.81 * (1 - np.exp(-step * 0.002 / 0.02))
        assert np.array(now[place_of_it]).ravel() == pytest.approx([0, 0, told], abs=1e-9)
    for late in (0.003, 0.2):
        kept, newest = lag_shares(late, 0.01)
        around = SimpleNamespace(accelerometer_kept=kept, accelerometer_newest=newest)
        held = 0.0
        for step in range(1, 30):
            t = step * 0.01
            held = FurtherSurroundings.lagging(around, held, t - 0.01, t)
            assert held == pytest.approx(t - late * (1 - np.exp(-t / late)), abs=1e-12)
    assert lag_shares(0.0, 0.01) == (0, 1)


def test_a_lag_that_is_gone_changes_nothing_and_a_long_one_does(vehicle):
    flights = [
        simulate(vehicle(LAW, REAL, {"sensors.accelerometer_time_constant": late}), duration=4)
        for late in ("0", "1e-9", "0.01")
    ]
    none, short, long = (flight["position"].values for flight in flights)
    assert np.abs(short - none).max() < 1e-9
    assert 1e-5 < np.abs(long - none).max() < 0.02


@pytest.mark.parametrize("seed", [0, 1])
def test_a_biased_one_moves_the_hover_by_the_image_error_that_carries_the_bias(vehicle, seed):
    """At rest thrust and rates stay, though the law takes V' = b: that is so where, with f = m b/c,
    k1 k2 f = k1 k2 δ1 - k3 δ3 along e3 and k1 k2 f = -(k1 k2 + k3 + k4) δ3 across, δ3 = f - δ1.
    """
    biased = {"sensors": "{control_rate = 250, accelerometer_bias = 0.05}", **ERRORS}
    mission = vehicle(LAW, biased)
    _, params = memory_and_parameters(Plan(mission, 0.004, 1, 1, seed), np.arange(1))
    first = law_of(mission).design.size()
    bias = params[0, first:][FurtherSurroundings.place("accelerometer_bias")]
    k12, error = 0.0566 * 22, 0.5 * bias / (0.0566**2 * 22 / 0.5)
    error[:2] *= 1 + k12 / (k12 + 1.75 + 6)
    there = hover_that_sees(np.add([0, 0, WANTED], error), LEVEL)
    assert np.linalg.norm(there - [0, 0, -1.2]) > 0.02
    flight = simulate(mission, duration=25, seed=seed)
    assert flight["position"].values[-1] == pytest.approx(there, abs=2e-4)


# The gyro between frames


def rotation(turn):
    """Return the rotation matrix of a rotation vector, by Rodrigues' formula."""
    angle = np.linalg.norm(turn)
    K = np.array([np.cross(turn / angle, row) for row in np.eye(3)]).T
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def taken_at(rate, latency, step, steps):
    """The step at which the frame was taken that is used in each step."""
    frames = [-(-int(k / step) // rate) for k in range(steps)]
    used = []
    for now in range(steps):
        used.append(([f for f in frames if f + round(latency / step) <= now] or [0])[-1])
    return used


@pytest.mark.slow
def test_under_pure_rotation_a_late_feature_is_the_true_one(x4_far):
    """Far above its target in free fall, tumbling: the target stays where it is, the body turns."""
    flight = simulate(x4_far(True), duration=1.2, step=0.01, every=1)
    held, true = (flight[name].values[1:] for name in ("centroid_held", "centroid"))
    assert np.degrees(flight["tilt"].values[-1]) > 20
    assert np.abs(held - true).max() < 1e-3 * 4
    unturned = simulate(x4_far(False), duration=1.2, step=0.01, every=1)["centroid_held"].values[1:]
    assert np.abs(unturned - true).max() > 0.2


@pytest.fixture
def x4_far():
    def made(turned):
        sensors = f"{{frame_rate = 10, latency = 0.15, gyro_turned = {str(turned).lower()}}}"
        return load(
            "x4-flyer",
            {
                "law.goal": '"inertial"',  # it knows no singularity with little thrust
                "start.position": "[0, 0, -50000]",
                "start.rates": "[0.3, -0.2, 1]",
                "rotors": "{min_thrust = 0, max_thrust = 1e-30}",
                "sensors": sensors,
            },
        )

    return made


@pytest.mark.parametrize("bias", [0, 0.3])
def test_in_flight_a_held_feature_is_turned_from_its_frame_on_by_what_the_gyro_says(vehicle, bias):
    sensors = f"{{frame_rate = 25, latency = 0.1, gyro_turned = true, gyro_bias = {bias}}}"
    mission = vehicle(LAW, {"start.rates": "[1, -0.5, 2]", "sensors": sensors})
    flight = simulate(mission, duration=2, step=0.004, every=1)
    _, params = memory_and_parameters(Plan(mission, 0.004, 1, 1), np.arange(1))
    own = params[0, law_of(mission).design.size() :]
    rates = flight["body_rate"].values + own[FurtherSurroundings.place("gyro_bias")]
    R = [np.eye(3)]
    for turn in 0.004 * (rates[1:] + rates[:-1]) / 2:
        R.append(R[-1] @ rotation(turn))
    seen, used = flight["centroid"].values, taken_at(25, 0.1, 0.004, 500)
    told = [R[now + 1].T @ R[used[now]] @ seen[used[now]] for now in range(500)]
    assert np.abs(flight["centroid_held"].values[1:] - told).max() < 1e-8 * WANTED
    true = flight["rotation"].values
    truly = [true[now + 1].T @ true[used[now]] @ seen[used[now]] for now in range(500)]
    apart = np.abs(np.subtract(truly, told)).max() / WANTED
    assert apart > 1e-2 if bias else apart < 1e-5
    assert np.abs(seen[1:] - told).max() > 1e-2 * WANTED
    assert flight["centroid_held"].attrs["long_name"].startswith("scaled feature of the image")
    assert flight["centroid"].attrs["long_name"] == "scaled feature of the image"


def test_the_attitude_is_added_up_as_the_rotations_it_is_made_of():
    attitude, turn = ca.SX.sym("attitude", 4), ca.SX.sym("turn", 3)
    step = ca.Function("step", [attitude, turn], [gyro.turned_on(attitude, turn)])
    out = ca.Function("out", [attitude, turn], [gyro.held_still(attitude, turn)])
    back = ca.Function("back", [attitude, turn], [gyro.in_body(attitude, turn)])
    draw = np.random.default_rng(3)
    R, q = np.eye(3), ca.DM(gyro.START)
    for w in draw.normal(size=(200, 3)) * 0.1:
        R, q = R @ rotation(w), step(q, w)
    for vector in np.eye(3):
        assert np.array(out(q, vector)).ravel() == pytest.approx(R @ vector, abs=1e-4)
        assert np.array(back(q, R @ vector)).ravel() == pytest.approx(vector, abs=1e-4)
    assert float(ca.norm_2(q)) == pytest.approx(1, abs=1e-15)


# Rotors and arms that are not as modelled

BUILT = {"sensors.control_rate": "250", "rotors.time_constant": "0.03"}
TURNING = {"start.rates": "[1, -0.5, 0]"}


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({"thrust": "0.25", "mass": "0.25", "inertia": "[0.25, 0.25, 0.25]"}, {}),
        ({"arm": "0.25", "inertia": "[0.25, 0.25, 0]"}, {}),
        ({"rotors": "[-0.1, -0.1, -0.1, -0.1]"}, {"thrust": "-0.1"}),
        ({"rotors": "[0.5, 0.5, 0.5, 0.5]", "thrust": "-0.5"}, {"thrust": "-0.25"}),
    ],
)
def test_errors_that_cancel_are_no_error_and_those_of_rotors_multiply(vehicle, one, other):
    flights = [
        simulate(
            vehicle(LAW, BUILT, TURNING, {f"model_error.{k}": v for k, v in errors.items()}),
            duration=2,
            step=0.004,
        )
        for errors in (one, other)
    ]
    ours, theirs = (flight["position"].values for flight in flights)
    assert np.abs(ours - theirs).max() < 1e-9
    exact = simulate(vehicle(LAW, BUILT, TURNING), duration=2, step=0.004)["position"].values
    assert (np.abs(ours - exact).max() > 1e-3) == bool(other)


def test_a_strong_rotor_turns_the_vehicle_about_itself(vehicle):
    """At the start: rear right 10 % stronger than asked for."""
    strong = {"model_error.rotors": "[0.1, 0, 0, 0]", "start.position": "[0, 0, -1.2]"}
    flight = simulate(vehicle(LAW, BUILT, strong), duration=0.1, every=1)
    quarter = 0.5 * 9.81 / 4
    rotors = flight["rotor_thrust"].values[0]
    assert rotors == pytest.approx(np.array([1.1, 1, 1, 1]) * quarter)
    assert flight["thrust"].values[0] == pytest.approx(4.1 * quarter)
    assert flight["torque"].values[0] == pytest.approx(
        np.array([-0.12, -0.12, -0.016]) * 0.1 * quarter
    )
    assert flight["thrust_command"].values[0] == pytest.approx(4 * quarter)
    assert (flight["body_rate"].values[1] < 0).all()


def test_runs_differ_by_the_thrust_and_arm_that_scatter_says(vehicle):
    change = {"scatter": "{thrust = 0.2, arm = 0.1}", "model_error.thrust": "-0.1"}
    mission = vehicle(LAW, BUILT, change)
    _, params = memory_and_parameters(Plan(mission, 0.004, 1, 1), np.arange(2000))
    own = params[:, law_of(mission).design.size() :]
    shares = own[:, FurtherSurroundings.place("rotor_shares")]
    arms = own[:, FurtherSurroundings.place("true_arm")].ravel() / 0.12
    assert (shares == shares[:, :1]).all()
    assert (shares.min(), shares.max()) == pytest.approx((0.7, 1.1), abs=0.002)
    assert (arms.min(), arms.max()) == pytest.approx((0.9, 1.1), abs=0.002)
    alone = Plan(vehicle({"scatter.thrust": "0.2"}), 0.004, 1, 1)
    assert not alone.ideal
    assert alone.features.rotors_differ


def test_what_is_stronger_than_the_controller_knows_is_stepped_through_faster(vehicle):
    strong = {"model_error": "{thrust = 0.5, arm = 0.2, rotors = [0, 0, 0.1, 0]}"}
    slow = fastest_rate(vehicle(LAW))
    assert fastest_rate(vehicle(LAW, strong)) == pytest.approx(slow * 1.5 * 1.2 * 1.1)
    assert fastest_rate(vehicle(LAW, {"model_error.thrust": "-0.5"})) == slow


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sensors.gyro_turned": "1"}, "sensors.gyro_turned: must be true or false, not 1"),
        ({"sensors.accelerometer_noise": "-1"}, "accelerometer_noise: must be from 0 to"),
        ({"model_error.rotors": "[0.1]"}, "rotors: must be a list .rear right, front right, rear"),
        ({"model_error.thrust": "-1"}, "model_error.thrust: must be from -0.9 to 10"),
    ],
)
def test_impossible_sensors_and_errors_are_refused(vehicle, change, message):
    with pytest.raises(ValueError, match=message):
        vehicle(change)


# The bits


@pytest.fixture
def everything(tmp_path):
    """The law that measures, with every key of the commented template."""
    keys = re.sub(r"(?m)^# (?=\[|\w+ = )", "", conditions_text())
    path = tmp_path / "all.toml"
    path.write_text(VEHICLE + keys)
    return load(path, LAW | {"rotors.max_thrust": "5", "rotors.min_thrust": "0.1"})


@needs_compiler
def test_alone_in_a_vector_and_on_the_virtual_machine_it_is_one_flight(everything):
    plan = Plan(everything, 0.004, 20, 10, seed=4)
    assert plan.features.turned
    assert plan.features.lags(plan.numbers.law)
    assert plan.features.rotors_differ
    fast, slow = (fly_raw(plan, 0, 5, compiler=compiler) for compiler in (None, ""))
    for ours, theirs in zip(fast, slow, strict=True):
        assert np.array_equal(ours, theirs, equal_nan=True)
    assert (fast[2] == 20).all()
    for run in range(5):
        assert np.array_equal(fly_raw(plan, run, 1)[0][0], fast[0][run])


def test_what_the_law_of_the_paper_does_not_use_makes_no_other_loop(vehicle):
    plain = vehicle({"sensors": "{control_rate = 250}"})
    keys = "accelerometer_noise = 1, accelerometer_bias = 1, accelerometer_time_constant = 1"
    named = vehicle({"sensors": f"{{control_rate = 250, gyro_turned = false, {keys}}}"})
    one, other = (Plan(mission, 0.004, 10, 10) for mission in (plain, named))
    assert one.model_sha256 == other.model_sha256
    assert np.array_equal(fly_raw(one, 0, 1)[0], fly_raw(other, 0, 1)[0])


PRINTS = {
    "x4-flyer": "4e27cc1efe80c113",
    "x4-flyer with ticks": "21efd0bf0cd3cf3d",
}
"""Beginnings of the SHA-256 of the graphs of the ideal loop's step and of the loop with sensors."""


@pytest.mark.skipif(ca.CasadiMeta.version() != "3.8.2", reason="graphs of another CasADi")
def test_the_loops_of_the_paper_s_law_are_what_they_were(x4):
    """A change of either changes the bits of every flight, and is to be meant."""
    ticks = load("x4-flyer", {"sensors.control_rate": "100"})
    prints = {
        "x4-flyer": simulate(x4, duration=0.1).attrs["model_sha256"],
        "x4-flyer with ticks": Plan(ticks, 0.01, 1, 1).model_sha256,
    }
    assert {name: text[:16] for name, text in prints.items()} == PRINTS


def test_a_summary_compares_it_with_the_ideal_flight(vehicle):
    mission = vehicle(LAW, REAL)
    flight = simulate(mission, duration=6)
    told = summary(flight) | without_conditions(mission, flight)
    assert told["outcome"] == "flown"
    assert told["ideal_settled_at"] < 3
    assert told["greatest_distance_from_ideal"] < 0.3
    assert told["final_distance_from_ideal"] < 0.02


# --- the exported C in its place ----------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("law", mostly_whole([LAW, IMAGE], every=2), ids=["inertial", "image"])
@needs_compiler
def test_the_exported_c_flies_it_as_the_model_does(vehicle, law):
    """The model commands the thrust of the tick's end, the C that of its beginning."""
    mission = vehicle(law, REAL)
    flown, model = fly_firmware(mission, duration=10), simulate(mission, duration=10)
    assert flown.attrs["machine"] == "firmware, float32"
    came, other = summary(flown), summary(model)
    assert came["outcome"] == other["outcome"] == "flown"
    assert came["settled_at"] == pytest.approx(other["settled_at"], abs=0.05)
    assert came["settled_at"] < 3
    apart = np.linalg.norm(flown["position"].values - model["position"].values, axis=1)
    assert 0 < apart.max() < 0.01
    assert flown["thrust_command"].values[-1] == pytest.approx(0.5 * 9.81 * 1.15 / 0.85, rel=0.05)


@needs_compiler
def test_a_doubt_of_the_exported_c_ends_the_flight_in_words(vehicle):
    deaf = vehicle(LAW, {"sensors": "{accelerometer_noise = 1000}"})
    flown = fly_firmware(deaf, duration=2)
    assert re.fullmatch(
        r"ended at \S+ s: (an input out of its box|thrust near the singularity)[^.]*",
        flown.attrs["outcome"],
    )
    assert len(flown["time"]) < 100


@needs_compiler
def test_firmware_without_a_camera_entry_is_not_flown_with_sensors(vehicle, tmp_path):
    mission = vehicle(LAW, {"sensors": SENSORS})
    export_c(mission, tmp_path, allow_uncertified=True)
    with pytest.raises(InputError, match="with camera=True"):
        fly_firmware(mission, Firmware(tmp_path), duration=1)


def test_a_control_rate_too_slow_for_the_exported_c_is_refused(vehicle):
    slow = vehicle(LAW, {"sensors": "{control_rate = 5}"})
    with pytest.raises(InputError, match="at least 10 Hz"):
        fly_firmware(slow, duration=1)
