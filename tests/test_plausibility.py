"""What no vehicle has is said, once and by name; what vehicles have is not."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

from command_line import run
from hoverproof.mission.presets import presets
from hoverproof.mission.reading import load
from hoverproof.plausibility import warnings
from hoverproof.reporting.tables import strange_tables
from papers_law import CRAZYFLIE

STRANGE = {
    "inertia in g cm²": (
        {"vehicle.inertia": "[165.7,166.6,292.6]"},
        "inertia against mass and arm",
    ),
    "inertia in kg cm²": (
        {"vehicle.inertia": "[0.166,0.167,0.293]"},
        "inertia against mass and arm",
    ),
    "no inertia": ({"vehicle.inertia": "[1e-9,1e-9,1e-9]"}, "inertia against mass and arm"),
    "arm in mm": ({"vehicle.lever": "32.5"}, "arm against mass"),
    "arm in cm": ({"vehicle.lever": "3.25"}, "arm against mass"),
    "mass in g": (
        {"vehicle.mass": "27", "bounds": "{eigenvalues=[0.25,3.7], level=0.1}"},
        "arm against mass",
    ),
    "mass in mg": (
        {"vehicle.mass": "2.7e4", "bounds": "{eigenvalues=[0.25,3.7], level=0.1}"},
        "mass",
    ),
    "gravity": ({"vehicle.gravity": "98.1", "bounds.thrust": "[2.4,2.9]"}, "gravity"),
    "drag ratio in mm": ({"vehicle.drag_ratio": "5.96"}, "drag ratio against arm"),
    "rotors too weak": ({"rotors.max_thrust": "0.06"}, "thrust without the weight"),
    "rotors too strong": (
        {"rotors.min_thrust": "0.07", "rotors.max_thrust": "0.15"},
        "thrust without the weight",
    ),
    "thrust in g": ({"rotors.max_thrust": "15"}, "thrust to weight"),
    "fast gains": ({"gains.k4": "10"}, "bandwidth"),
    "fast yaw": ({"gains.k_yaw": "0.014"}, "yaw bandwidth"),
    "slow rotors": ({"rotors.time_constant": "0.2"}, "bandwidth"),
    "time constant in ms": ({"rotors.time_constant": "30"}, "rotor time constant"),
}


@pytest.mark.parametrize("preset", presets())
def test_no_preset_is_strange(preset):
    assert warnings(load(preset)) == []


@pytest.mark.parametrize("grams", [20, 100, 500, 2000, 8000, 20000])
@pytest.mark.parametrize("slender", [Fraction(4, 5), Fraction(2)])
def test_vehicles_of_usual_shape_are_not_strange_at_any_size(grams, slender):
    """Similar vehicles: length with the root of the mass, inertia with mass times its square."""
    mass = grams / 1000
    arm = 0.1 * float(slender) * mass ** (1 / 3)
    moments = [0.5 * mass * arm**2, 0.5 * mass * arm**2, 0.9 * mass * arm**2]
    vehicle = {
        "vehicle.mass": repr(mass),
        "vehicle.lever": repr(arm),
        "vehicle.inertia": repr(moments),
        "vehicle.drag_ratio": repr(0.2 * arm),
        "vehicle.gravity": "9.81",
        "bounds.thrust": f"[{8.8 * mass}, {10.8 * mass}]",
        "gains.k1": repr(0.02 * mass),
        "gains.k3": repr(3 * mass),
        "gains.k4": repr(10 * mass),
        "gains.k_yaw": repr(moments[2]),
        "rotors.max_thrust": repr(5 * mass),
        "rotors.time_constant": "0.05",
    }
    assert warnings(load("x4-flyer", vehicle)) == []


@pytest.mark.parametrize(("overrides", "name"), STRANGE.values(), ids=STRANGE)
def test_what_no_vehicle_has_is_named(overrides, name):
    found = warnings(load(CRAZYFLIE, overrides))
    assert name in [finding.name for finding in found]
    assert len({finding.name for finding in found}) == len(found)


def test_the_report_says_it_too():
    heavy = load("x4-flyer", {"vehicle.lever": "25"})
    (table,) = strange_tables(heavy)
    assert {key for key, _ in table.rows} >= {"vehicle.lever"}
    assert strange_tables(load("x4-flyer")) == []


def test_a_command_warns_once_and_goes_on(capsys):
    strange = ("--set", "vehicle.inertia=[165.7,166.6,292.6]")
    status, out, err = run(capsys, "certify", CRAZYFLIE, *strange, "--json")
    assert status == 0
    assert err.count("\n") == err.count("warning") == 1
    assert f"warning: {CRAZYFLIE}: vehicle.inertia: a radius of gyration of 104 m" in err
    (warned,) = json.loads(out)["warnings"]
    assert warned in err
    status, out, err = run(capsys, "certify", CRAZYFLIE, "--json")
    assert (json.loads(out)["warnings"], err) == ([], "")


@pytest.mark.slow
def test_tune_warns_of_gains_that_no_rotor_follows(capsys):
    status, out, err = run(
        capsys, *["tune", CRAZYFLIE, "--objective", "decay", "--bandwidth", "300", "--json"]
    )
    assert status == 0
    assert err.count("warning") == 1
    assert "no rotor follows a bandwidth of" in err
    assert "(bandwidth)" in json.loads(out)["warnings"][0]


def test_a_proof_about_a_loop_that_hardly_moves_comes_with_a_warning(capsys):
    slow = ("--set", "gains.k1=0.002")
    status, out, err = run(capsys, "certify", "x4-flyer", *slow, "--json")
    assert status == 0
    assert err.startswith("hoverproof: warning: x4-flyer: gains: the time constant of the slowest")
    assert err.count("\n") == 1
    (warned,) = json.loads(out)["warnings"]
    assert warned in err
    assert run(capsys, "certify", "x4-flyer", "--set", "gains.k4=0.1")[::2] == (1, "")
