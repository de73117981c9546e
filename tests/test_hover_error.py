"""What an error of thrust or mass does to the hover: computed, and seen in flight."""

from __future__ import annotations

import json

import casadi as ca
import numpy as np
import pytest

import hoverproof as hp
from hoverproof import cli
from hoverproof.mission.reading import load
from hoverproof.plant.goal import hover_at_height, hover_goal
from hoverproof.plant.rigid_body import RigidBodyState, state_rate
from hoverproof.reporting.tables import hover_error_tables
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.hover_error import hover_error
from hoverproof.servo.loop import LoopNumbers, command, parameters, sense
from hoverproof.servo.variables import Design
from hoverproof.simulation.flight import simulate
from hoverproof.simulation.step import runge_kutta
from papers_law import CRAZYFLIE


def final_height(mission, **overrides):
    flight = simulate(mission, **overrides)
    assert flight.attrs["outcome"] == "flown"
    return float(mission.height_of_target) - float(flight["position"][-1, 2])


def thrust_loop(mission, error):
    """One step of the paper's loop whose rotors give (1 + error) times the thrust asked for."""
    numbers = LoopNumbers.of(mission)
    design, points = parameters(numbers.points.shape[1])
    x, dt = ca.SX.sym("x", 19), ca.SX.sym("dt")

    def rate(x, _):
        body = RigidBodyState.from_vector(x)
        measured, _, _ = sense(body, points)
        thrust_rate, torque = command(measured, design)
        given = RigidBodyState(
            body.position, body.velocity, body.rotation, body.rate, body.thrust * (1 + error)
        )
        return state_rate(
            given,
            torque=torque,
            thrust_rate=thrust_rate,
            mass=design.mass,
            inertia=design.inertia,
            gravity=design.gravity,
        ).vector()

    after = runge_kutta(rate, x, dt)
    step = ca.Function("step", [x, design.vector(), points, dt], [after])
    return lambda state, dt, steps: np.array(
        step.fold(steps)(
            state,
            np.tile(numbers.design[:, None], steps),
            np.tile(numbers.points, steps),
            np.full((1, steps), dt),
        )
    )[:, 0]


def test_one_percent_of_mass_nearly_halves_the_height_of_the_crazyflie_preset():
    mission = load(CRAZYFLIE)
    told = hover_error(mission)
    assert told.height == 1
    assert told.heavier == pytest.approx(0.56, abs=0.005)
    heavy = load(CRAZYFLIE, {"model_error.mass": "0.01"})
    assert final_height(heavy, duration=60) == pytest.approx(told.heavier, rel=1e-3)


def test_one_percent_less_thrust_sinks_as_far_as_is_told():
    mission = load(CRAZYFLIE)
    state = LoopNumbers.of(mission).start
    end = thrust_loop(mission, -0.01)(state, 0.01, 6000)
    assert -end[2] == pytest.approx(hover_error(mission).less_thrust, rel=1e-3)


def test_a_vehicle_that_is_told_to_have_no_hover_has_none_in_flight():
    told = hover_error(load(CRAZYFLIE))
    assert told.lighter is None
    light = load(CRAZYFLIE, {"model_error.mass": repr(told.leaving_load - 1 - 1e-2)})
    assert final_height(light, duration=120) > final_height(light, duration=60) + 2
    sunk = {"model_error.mass": repr(told.target_load - 1 + 2e-3)}
    assert "flown" not in simulate(load(CRAZYFLIE, sunk), duration=60).attrs["outcome"]


@pytest.mark.parametrize("error", [-0.01, 0.01])
@pytest.mark.parametrize(
    "overrides",
    [
        {},
        {"target.points": "[[1, 1, 0], [0, 0.5, -1], [-1, -1, 0.3], [-2, 1, 0]]"},
        {"goal": "{centroid = [0.3, 0.1, 2]}"},
    ],
    ids=["square", "not planar", "seen aslant"],
)
def test_the_controller_rests_where_it_is_told_to_hover(overrides, error):
    """At that place, level, with the thrust that carries the vehicle, its own rates are zero."""
    mission = load("x4-flyer", {"gains.k1": "3", "gains.k2": "8", **overrides})
    told, goal = hover_error(mission), hover_goal(mission)
    height = told.more_thrust if error > 0 else told.less_thrust
    z = float(mission.height_of_target) - height
    found = hover_at_height(mission, goal, z)
    assert found is not None
    seen = found[1]
    thrust = float(mission.vehicle.weight) / (1 + error)
    measured = [*seen, *[0, 0, 0], *[0, 0, 1], *[0, 0, 0], thrust]
    design = [float(x) for x in Design.values(mission, goal.centroid_midpoint)]
    thrust_rate, torque = derive_controller().function()(measured, design)
    assert abs(float(thrust_rate)) < 1e-6
    assert np.abs(np.array(torque)).max() < 1e-6
    assert (height > told.height) == (error > 0)


def test_it_is_told_in_words_with_the_signs_of_a_vehicle(x4):
    rows = dict(hover_error(load(CRAZYFLIE)).rows())
    assert rows["hover, 1 % less thrust"] == "at 0.558 m, not 1 m (1 % more mass: at 0.561 m)"
    assert rows["hover, 1 % more thrust"] == "none: it climbs away (1 % less mass: none)"
    sinks = "6.96 % less thrust or 7.48 % more mass, at the latest"
    assert rows["sinks to the target"] == sinks
    assert rows["climbs away"] == "0.649 % more thrust or 0.645 % less mass"
    soft = dict(hover_error(x4).rows())
    assert soft["hover, 1 % less thrust"] == "none: it sinks to the target (1 % more mass: none)"


def test_stiff_gains_never_leave(x4):
    stiff = load("x4-flyer", {"gains.k1": "50", "gains.k2": "80"})
    told = hover_error(stiff)
    assert told.leaving_load <= 0
    assert dict(told.rows())["climbs away"] == "never"
    assert abs(told.heavier - 3) < 0.01
    soft = hover_error(x4)
    assert soft.heavier is soft.more_thrust is None
    assert 0.5e-2 > soft.target_load - 1 > 0


@pytest.mark.slow
def test_tune_and_the_firmware_say_what_an_error_does(tmp_path, capsys):
    mission = load(CRAZYFLIE)
    rows = hover_error(mission).rows()
    with pytest.raises(SystemExit):
        cli.main(["tune", CRAZYFLIE, "--objective", "decay", "--json"])
    told = json.loads(capsys.readouterr().out)["hover_error"]
    assert told["heavier"] == pytest.approx(hover_error(mission).heavier, rel=0.05)
    hp.export_c(mission, tmp_path)
    text = (tmp_path / "README.md").read_text()
    for name, value in rows:
        assert f"| {name} | {value} |" in text
    assert "your vehicle, or its pilot" in text


def test_the_report_says_what_an_error_does():
    (table,) = hover_error_tables(load(CRAZYFLIE))
    assert ("hover, 1 % more thrust", "none: it climbs away (1 % less mass: none)") in table.rows


def test_any_target_has_an_answer():
    """Also where the hovers end at a target point, or far aside of where they began."""
    draw = np.random.default_rng(0)
    for n in (2, 3, 5, 9) * 5:
        points = draw.normal(size=(n, 3)) * [1, 1, draw.choice([0, 0.3])]
        mission = load(
            "x4-flyer",
            {
                "target.points": repr(points.round(3).tolist()),
                "goal": "{height = 4}",
                "gains.k1": repr(round(float(draw.uniform(0.5, 5)), 2)),
            },
        )
        told = hover_error(mission)
        heights = [told.less_thrust or 0, told.height, told.more_thrust or np.inf]
        assert heights == sorted(heights)
        assert told.target_load > 1 > told.leaving_load
        assert (told.heavier is None) == (told.target_load <= 1.01)
