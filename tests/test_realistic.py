"""The flight as on a vehicle: against independent physics, and each condition on its own."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hoverproof.mission.presets import conditions_text, preset_text
from hoverproof.mission.reading import load
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.servo.layout import place
from hoverproof.simulation import compiled
from hoverproof.simulation.block import fly_raw
from hoverproof.simulation.draws import memory_and_parameters
from hoverproof.simulation.flight import simulate, summary, without_conditions
from hoverproof.simulation.plan import Plan, is_ideal
from hoverproof.simulation.realistic import LAYOUT

needs_compiler = pytest.mark.skipif(not compiled.find_compiler(), reason="no C compiler here")
CAMERA = {"sensors.focal_length": "400"}
TILTED = {"start.rotation": "[0.03, -0.02, 0.4]", "start.rates": "[0.01, -0.02, 0.01]"}


def everything():
    """The x4-flyer with every key of the commented template."""
    keys = re.sub(r"(?m)^# (?=\[|\w+ = )", "", conditions_text())
    Path("full.toml").write_text(preset_text("x4-flyer") + keys)
    return load("full.toml")


def state_of(plan, memory, name):
    return memory[..., place(LAYOUT, name)]


def test_the_template_names_every_key_and_can_be_read():
    mission = everything()
    named = mission.conditions()
    for section in ("sensors", "rotors", "wind", "model_error", "scatter"):
        keys = set(type(getattr(mission, section)).model_fields)
        assert keys - set(named[section]) <= {"out_of_view", "distribution"}
    for line in ("out_of_view =", "distribution ="):
        assert line in conditions_text()


def test_what_is_named_changes_neither_the_certificate_s_mission_nor_the_ideal_loop(x4):
    mission = everything()
    assert mission.exact() == x4.exact() | {"name": mission.name}
    assert is_ideal(x4)
    assert is_ideal(load("x4-flyer", {"scatter.position": "[1, 1, 1]"}))
    assert not is_ideal(mission)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sensors.frame_rat": "30"}, "sensors.frame_rat: unknown key.*'frame_rate'"),
        ({"sensors.frame_rate": "0"}, "sensors.frame_rate: must be above 0 .* Hz, not 0"),
        ({"sensors.pixel_noise": "1"}, "sensors.focal_length: is missing"),
        ({"sensors.width": "640", **CAMERA}, "give both width and height"),
        ({"sensors.out_of_view": '"stop"'}, "sensors.out_of_view: must be 'hold' or 'abort'"),
        ({"rotors.min_thrust": "9", "rotors.max_thrust": "8"}, "must be below max_thrust, 8 N"),
        ({"wind.mean": "[1, 0, 0]"}, "wind.drag: is missing"),
        ({"model_error.mass": "-1"}, "model_error.mass: must be from -0.9 to 10"),
        ({"scatter.position": "1"}, r"scatter.position: must be a list \[x, y, z\], not 1"),
    ],
)
def test_impossible_conditions_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        load("x4-flyer", change)


def test_a_camera_faster_than_the_integrator_is_refused():
    mission = load("x4-flyer", {"sensors.frame_rate": "120"})
    with pytest.raises(ValueError, match=r"sensors.frame_rate: must be at most one in a step"):
        simulate(mission, duration=1, step=0.01)


@needs_compiler
def test_machine_code_and_virtual_machine_give_the_same_bits_with_everything_on():
    mission = everything()
    fast, slow = (simulate(mission, duration=2, seed=4, compiler=c) for c in (None, ""))
    assert fast.attrs["machine"] != slow.attrs["machine"]
    for name in fast:
        assert np.array_equal(fast[name].values, slow[name].values), name


@pytest.mark.slow
@needs_compiler
@pytest.mark.parametrize("latency", ["0.01", "0.054", "0.5"])
@pytest.mark.parametrize("rate", [{}, {"sensors.frame_rate": "29.97"}, {"sensors.frame_rate": "3"}])
def test_no_frame_on_its_way_is_overwritten(latency, rate):
    mission = load("x4-flyer", {**TILTED, "sensors.latency": latency, **rate})
    fast, slow = (simulate(mission, duration=1.5, every=1, compiler=c) for c in (None, ""))
    assert np.array_equal(fast["centroid_held"], slow["centroid_held"])
    assert np.unique(fast["centroid_held"][1:, 0]).size > 2


def plain_control(mission, q_star, q, V, rho, Omega, T):
    """U and Γ in plain numpy, from the closed forms."""
    v, k = mission.vehicle, mission.gains
    m, g = float(v.mass), float(v.gravity)
    inertia = np.array([float(i) for i in v.inertia])
    k1, k2, k3, k4, k_yaw = (float(n) for n in (k.k1, k.k2, k.k3, k.k4, k.k_yaw))
    e3, P = np.array([0, 0, 1.0]), np.diag([1.0, 1, 0])
    F = -T * e3 + m * g * rho
    c = k1**2 * k2 / m
    d2 = m / k1 * V - (q - q_star)
    d3 = F / c + d2
    w = (k1 * k2 + k3) / m
    beta = 1 / (c * w)
    lever = T * e3 - c * q_star
    d4 = beta * P @ np.cross(lever, Omega) + P @ d3
    U = c * (w * d3[2] - np.cross(q_star, Omega)[2])
    known = beta * U * P @ np.cross(e3, Omega) + P @ (
        -np.cross(Omega, d3) - k1 * k2 / m * d2 + w * d4 - k3 / m * P @ d3
    )
    yaw = -k_yaw / inertia[2] * Omega[2]
    rest = -w * P @ d3 - k4 / m * d4 - known - beta * P @ np.cross(lever, yaw * e3)
    a = beta * (T - c * q_star[2])
    Omega_dot = np.array([rest[1] / a, -rest[0] / a, yaw])
    return U, inertia * Omega_dot + np.cross(Omega, inertia * Omega)


def test_the_flight_agrees_with_independent_physics_between_independent_ticks():
    """Frames at 20 Hz, 0.1 s late, ticks at 10 Hz, slow rotors, wind, another mass and camera."""
    mission = load(
        "x4-flyer",
        {
            **TILTED,
            "gains.k1": "2",
            "gains.k4": "10",
            "sensors": "{control_rate = 10, frame_rate = 20, latency = 0.1}",
            "rotors": "{time_constant = 0.05, min_thrust = 22.8, max_thrust = 24}",
            "wind": "{mean = [1, -0.5, 0.2], drag = 0.3}",
            "model_error": "{mass = 0.02, inertia = [0.1, -0.1, 0.2]}",
            "model_error.camera_tilt": "[0.05, 0, 0.1]",
        },
    )
    step, seconds = 0.005, 3.0
    flight = simulate(mission, duration=seconds, step=step, every=10)
    q_star = flight.attrs["goal_centroid"]
    m, tilt = 9.6 * 1.02, rotation_matrix(0.05, 0, 0.1)
    inertia = np.array([0.4, 0.56, 0.22]) * [1.1, 0.9, 1.2]
    d, kappa, e3 = 0.25, 0.01, np.array([0, 0, 1.0])
    mix = np.array([[1, 1, 1, 1], [-d, -d, d, d], [-d, d, -d, d], [-kappa, kappa, kappa, -kappa]])
    targets = np.array([[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0.0]])

    def rate(t, x, command, thrusts, begin):
        V, R, Omega = x[3:6], x[6:15].reshape(3, 3), x[15:18]
        T, *torque = mix @ (command + (thrusts - command) * np.exp(-(t - begin) / 0.05))
        drag = 0.3 * (R.T @ [1, -0.5, 0.2] - V)
        turn = np.array([np.cross(Omega, row) for row in np.eye(3)]).T
        return np.concatenate(
            [
                R @ V,
                -np.cross(Omega, V) + (-T * e3 + m * 9.8 * R.T @ e3 + drag) / m,
                (R @ turn).ravel(),
                (np.array(torque) - np.cross(Omega, inertia * Omega)) / inertia,
            ]
        )

    R0 = rotation_matrix(0.03, -0.02, 0.4)
    x = np.concatenate([[5, 2.5, -4, 0, 0, 0], R0.ravel(), [0.01, -0.02, 0.01]])
    thrust = 9.6 * 9.8
    rotors, frames, found = np.full(4, thrust / 4), [], [x[:3]]
    for i in range(int(seconds * 20)):  # from frame to frame
        seen = (targets - x[:3]) @ x[6:15].reshape(3, 3) @ tilt
        frames.append((seen / np.linalg.norm(seen, axis=1)[:, None]).sum(axis=0))
        if i % 2 == 0:
            held, R = frames[max(0, i - 2)], x[6:15].reshape(3, 3)
            U, torque = plain_control(mission, q_star, held, x[3:6], R[2], x[15:18], thrust)
            thrust = np.clip(thrust + U / 10, 4 * 22.8, 4 * 24)
            command = np.clip(np.linalg.solve(mix, [thrust, *torque]), 22.8, 24)
        span, held_at = (i / 20, (i + 1) / 20), rotors
        done = solve_ivp(
            rate, span, x, method="DOP853", rtol=1e-11, atol=1e-12, args=(command, held_at, i / 20)
        )
        x = done.y[:, -1]
        rotors = command + (held_at - command) * np.exp(-0.05 / 0.05)
        found.append(x[:3])
    flown = flight["position"].values
    assert np.abs(flown - found).max() < 1e-7
    assert np.abs(flight["rotor_thrust"].values[-1] - rotors).max() < 1e-6
    thrusts = flight["rotor_thrust"].values  # the limits were met, so they were tested
    assert thrusts.min() == pytest.approx(22.8, abs=0.01)
    assert thrusts.max() <= 24


def test_halving_the_step_divides_the_error_by_sixteen_between_ticks():
    mission = load(
        "x4-flyer",
        {
            "start.rates": "[0.5, 0.4, 0.8]",
            "sensors": "{control_rate = 4, frame_rate = 4}",
            "rotors": "{time_constant = 0.3, min_thrust = 0, max_thrust = 40}",
            "wind": "{mean = [3, 0, 0], drag = 2}",
        },
    )

    def end(step):
        flight = simulate(mission, duration=1, step=step, every=round(1 / step))
        return flight["position"].values[-1]

    tight = end(2**-12)
    ratio = np.linalg.norm(end(2**-6) - tight) / np.linalg.norm(end(2**-7) - tight)
    assert 15 < ratio < 17


def test_with_ever_faster_ticks_the_flight_becomes_the_paper_s():
    change = {"gains.k1": "2", "gains.k4": "10"}
    ideal = simulate(load("x4-flyer", change), duration=20, step=0.001, every=1000)
    apart = []
    for rate in (125, 250, 500):
        flight = simulate(
            load("x4-flyer", change | {"sensors.control_rate": str(rate)}),
            duration=20,
            step=0.001,
            every=1000,
        )
        apart.append(np.abs(flight["position"].values - ideal["position"].values).max())
    assert apart[0] / apart[1] == pytest.approx(2, rel=0.1)
    assert apart[1] / apart[2] == pytest.approx(2, rel=0.1)


def test_frames_are_held_and_come_late():
    mission = load("x4-flyer", {**TILTED, "sensors": "{frame_rate = 30, latency = 0.05}"})
    flight = simulate(mission, duration=2, every=1)
    held, seen = flight["centroid_held"].values, flight["centroid"].values
    taken = [-(-100 * k // 30) for k in range(60)]  # the first step at or after each frame
    for step in range(1, 200):  # a record follows its step
        arrived = [t for t in taken if t + 5 <= step - 1] or [0]
        assert np.abs(held[step] - seen[arrived[-1]]).max() < 1e-14, step


def test_energy_is_kept_in_free_fall():
    """A tumbling vehicle with dead rotors, in still air."""
    mission = load(
        "x4-flyer",
        {
            "start.velocity": "[1, -2, 0.5]",
            "start.rates": "[1.5, -2, 1]",
            "start.position": "[0, 0, -100000]",
            "rotors": "{min_thrust = 0, max_thrust = 1e-30}",
        },
    )
    plan = Plan(mission, 0.002, 1, 5000)
    begin, _ = memory_and_parameters(plan, np.arange(1))
    _, end, _ = fly_raw(plan, 0, 1)

    def energy(memory):
        x = memory[0, :19]
        inertia = np.array([0.4, 0.56, 0.22])
        return 4.8 * x[3:6] @ x[3:6] + 0.5 * x[15:18] @ (inertia * x[15:18]) - 9.6 * 9.8 * x[2]

    assert end[0, 2] - begin[0, 2] == pytest.approx(0.5 * 9.8 * 10**2 + 0.5 * 10, rel=1e-3)
    assert energy(end) == pytest.approx(energy(begin), rel=1e-12)


def test_a_heavier_vehicle_hovers_where_the_image_error_carries_the_difference():
    """At rest T = m g of the true mass, and δ3 = F/c - δ1 = 0 of the modelled one."""
    mission = load("x4-flyer", {"model_error.mass": "0.0002", "start.position": "[0, 0, -3]"})
    flight = simulate(mission, duration=2000)
    stiffness = 0.2**2 * 10 / 9.6
    assert flight["delta1"].values[-1] == pytest.approx(
        [0, 0, -0.0002 * 9.6 * 9.8 / stiffness], abs=1e-6
    )
    sunk = simulate(load("x4-flyer", {"model_error.mass": "0.005"}), duration=100)
    assert "hit the height of the target at" in sunk.attrs["outcome"]


def test_thirty_frames_a_second_fifty_ms_late_with_a_pixel_of_noise_still_settle():
    sensors = "{frame_rate = 30, latency = 0.05, focal_length = 400, pixel_noise = 1}"
    mission = load("x4-flyer", {"sensors": sensors})
    flight = simulate(mission, duration=1500)
    result = summary(flight) | without_conditions(mission, flight)
    assert result["outcome"] == "flown"
    assert result["settled_at"] == pytest.approx(result["ideal_settled_at"], abs=10)
    assert 0 < result["greatest_distance_from_ideal"] < 0.05
    assert result["final_error"] < 0.05


VIEW = "focal_length = 400, width = 1220, height = 1220"


def test_a_target_that_leaves_the_view_is_reported_and_held_or_ends_the_flight():
    change = {"start.rates": "[0.2, 0, 0]", "gains.k1": "1"}
    hold, abort = (
        simulate(
            load("x4-flyer", change | {"sensors": f'{{{VIEW}, out_of_view = "{word}"}}'}),
            duration=20,
            every=10,
        )
        for word in ("hold", "abort")
    )
    assert summary(hold)["frames_lost"] > 0
    assert 0 < summary(hold)["left_view_at"] < 20
    assert abort.attrs["outcome"].endswith("a target point left the field of view")
    assert 0 < abort["time"].values[-1] < summary(hold)["left_view_at"] + 0.11
    for flight in (hold, abort):
        assert all(np.isfinite(flight[name].values).all() for name in flight)


def test_without_a_first_frame_there_is_nothing_to_hold():
    mission = load("x4-flyer", {"sensors": "{focal_length = 400, width = 600, height = 600}"})
    flight = simulate(mission, duration=2)
    assert flight.attrs["outcome"].endswith("a target point left the field of view")
    assert flight.attrs["left_view_at"] == 0


def test_pixels_are_rounded_to_their_resolution():
    far = {"sensors": "{focal_length = 1, pixel_resolution = 100}"}  # every point at the middle
    flight = simulate(load("x4-flyer", far), duration=1, every=1)
    assert np.allclose(flight["centroid_held"].values[1:], [0, 0, 4])


RISING = {"gains.k1": "4", "start.position": "[0, 0, -3]", "start.velocity": "[0, 0, -3]"}
"""Straight up and stiff: braking takes the thrust down to T = c q3*."""


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (RISING, "thrust fell to the singularity at"),
        ({"gains.k1": "200", "gains.k2": "300"}, "thrust fell to the singularity at"),
    ],
)
@pytest.mark.parametrize("condition", [{}, {"sensors.control_rate": "100"}])
def test_bad_gains_end_a_flight_with_a_word(change, told, condition):
    flight = simulate(load("x4-flyer", change | condition), duration=50)
    assert re.search(told, flight.attrs["outcome"])
    assert all(np.isfinite(flight[name].values).all() for name in flight)


def test_gusts_have_the_deviation_and_the_memory_they_are_given():
    wind = "{mean = [1, 0, 0], gust = 0.5, gust_time = 2, drag = 0.001}"
    plan = Plan(load("x4-flyer", {"wind": wind}), 0.01, 2, 200)
    records, _, _ = fly_raw(plan, 0, 4000)
    wind = records[..., place(plan.record, "wind")] - [1, 0, 0]
    assert wind.std(axis=(0, 2)) == pytest.approx([0.5] * 3, rel=0.03)
    kept = (wind[:, 1] * wind[:, 0]).mean() / 0.25
    assert kept == pytest.approx(np.exp(-1), abs=0.03)


def test_biases_differ_between_runs_and_noise_between_ticks():
    plan = Plan(
        load("x4-flyer", {"sensors": "{gyro_bias = 0.1, velocity_noise = 0.01}"}), 0.01, 1, 1
    )
    _, params = memory_and_parameters(plan, np.arange(3000))
    spread = params[:, np.abs(params).max(axis=0) < 1e9].std(axis=0)
    assert np.isclose(spread, 0.1, rtol=0.05).sum() == 3
    records, _, _ = fly_raw(plan, 0, 50)
    assert np.unique(records[:, 1, place(plan.record, "thrust_command")]).size == 50
