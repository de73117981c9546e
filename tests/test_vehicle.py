"""A vehicle is said without ambiguity: where its rotors are is what the file says."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest

from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.mission.writing import mission_text
from hoverproof.plant import rotors
from hoverproof.simulation.flight import simulate

PLAIN = "x4-flyer"


def with_vehicle(tmp_path, said):
    """Return a preset whose file says otherwise where its rotors are."""
    from hoverproof.mission.presets import preset_text

    lines = [line for line in preset_text(PLAIN).splitlines() if not line.startswith("lever")]
    lines.insert(lines.index("[vehicle]") + 1, said)
    path = tmp_path / "vehicle.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_an_arm_alone_is_refused_with_both_readings(tmp_path):
    with pytest.raises(InputError) as caught:
        load(with_vehicle(tmp_path, "arm = 0.17"))
    said = str(caught.value)
    assert caught.value.key == "vehicle.arm"
    for reading in (
        "lever = 0.17",
        'layout = "x" with arm = 0.2404',
        'layout = "x" with arm = 0.17',
    ):
        assert reading in said
    assert "lever = 0.1202" in said


def test_both_readings_are_missions_of_the_vehicles_they_name(tmp_path):
    was = load(with_vehicle(tmp_path, "lever = 0.17")).vehicle
    same = load(with_vehicle(tmp_path, 'layout = "x"\narm = 0.2404163056')).vehicle
    other = load(with_vehicle(tmp_path, 'layout = "x"\narm = 0.17')).vehicle
    assert float(same.reach) == pytest.approx(float(was.reach), rel=1e-9)
    assert float(other.reach) == pytest.approx(0.17 / math.sqrt(2), rel=1e-11)


@pytest.mark.parametrize(
    ("said", "key", "told"),
    [
        ("", "vehicle.layout", "is missing"),
        ('layout = "x"', "vehicle.arm", "is missing"),
        ('layout = "y"\narm = 0.2', "vehicle.layout", "'x' or 'plus' or 'h'"),
        ('layout = "x"\narm = [0.1, 0.2]', "vehicle.arm", "a length in m"),
        ('layout = "h"\narm = 0.2', "vehicle.arm", "[forward, sideways]"),
        ('layout = "h"\narm = [0.1, 0.2, 0.3]', "vehicle.arm", "[forward, sideways]"),
        ('layout = "h"\narm = [0.1, -0.2]', "vehicle.arm", "above 0"),
        ('layout = "plus"\nlever = 0.2', "vehicle.lever", "without layout"),
        ("arm = [0.1, 0.2]", "vehicle.arm", 'layout = "h"'),
    ],
)
def test_what_does_not_say_where_rotors_are_is_refused(tmp_path, said, key, told):
    with pytest.raises(InputError) as caught:
        load(with_vehicle(tmp_path, said))
    assert caught.value.key == key
    assert told in caught.value.reason


PLACED = {
    'layout = "x"\narm = 0.2': [(-1, 1), (1, 1), (-1, -1), (1, -1), 0.2 / math.sqrt(2)],
    'layout = "plus"\narm = 0.2': [(1, 0), (0, 1), (-1, 0), (0, -1), 0.2],
    'layout = "h"\narm = [0.1, 0.2]': [(-0.1, 0.2), (0.1, 0.2), (-0.1, -0.2), (0.1, -0.2), 1],
}


@pytest.mark.parametrize("said", PLACED)
def test_a_torque_that_is_asked_for_acts_on_the_real_frame(tmp_path, said):
    """The moments of the rotor thrusts about the axes, by hand, are what was asked for."""
    vehicle, *places, unit = load(with_vehicle(tmp_path, said)).vehicle, *PLACED[said]
    asked = [20.0, 0.05, -0.03, 0.02]
    thrusts = rotors.rotor_thrusts(
        vehicle.frame,
        ca.SX(asked[0]),
        ca.SX(asked[1:]),
        ca.SX(float(vehicle.reach)),
        ca.SX(float(vehicle.drag_ratio)),
    )
    each = np.array(ca.DM(thrusts)).ravel()
    x, y = unit * np.array(places, float).T
    assert each.sum() == pytest.approx(asked[0])
    assert -(y * each).sum() == pytest.approx(asked[1])
    assert (x * each).sum() == pytest.approx(asked[2])
    for name, (px, py) in zip(vehicle.frame.names, places, strict=True):
        assert ("front" in name) == (px > 0) and ("rear" in name) == (px < 0)
        assert ("right" in name) == (py > 0) and ("left" in name) == (py < 0)


@pytest.mark.parametrize("said", PLACED)
def test_a_mission_is_written_in_the_words_it_was_read_in(tmp_path, said):
    path = with_vehicle(tmp_path, said)
    mission = load(path)
    for source in (str(path), "nothing there"):
        text = mission_text(mission.model_copy(update={"source": source}))
        assert all(line in text for line in said.splitlines())
        again = tmp_path / "again.toml"
        again.write_text(text, encoding="utf-8")
        assert load(again).vehicle == mission.vehicle


def test_a_lever_stands_in_certificates_as_it_did():
    vehicle = load(PLAIN).exact()["vehicle"]
    assert vehicle["arm"] == "1/4"
    assert "lever" not in vehicle and "layout" not in vehicle


SKEWED = "inertia = [[0.4, 0.02, 0.05], [0.02, 0.56, -0.03], [0.05, -0.03, 0.5]]"


def with_inertia(tmp_path, said, preset=PLAIN):
    """Return a preset whose file says otherwise what its inertia is."""
    from hoverproof.mission.presets import preset_text

    lines = [said if x.startswith("inertia") else x for x in preset_text(preset).splitlines()]
    path = tmp_path / "body.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("inertia = [[1, 0.1, 0], [0.2, 1, 0], [0, 0, 1]]", "symmetric"),
        ("inertia = [[1, 2, 0], [2, 1, 0], [0, 0, 1]]", "positive definite"),
        ("inertia = [[1, 0.99, 0], [0.99, 1, 0], [0, 0, 0.5]]", "sum of the other two"),
        ("inertia = [[1, 0], [0, 1]]", "a matrix of 3 rows of 3"),
        ('inertia = [[1, 0, 0], [0, 1, 0], [0, 0, "1"]]', "must be a number"),
        ("inertia = [1, 1, 1]\nproducts = [0, 0, 0.1]", "3 x 3 matrix"),
    ],
)
def test_a_matrix_that_is_no_inertia_is_refused(tmp_path, said, told):
    with pytest.raises(InputError) as caught:
        load(with_inertia(tmp_path, said))
    assert told in str(caught.value)


def test_a_diagonal_matrix_is_three_moments(tmp_path):
    said = "inertia = [[0.4, 0, 0], [0, 0.56, 0], [0, 0, 0.22]]"
    assert load(with_inertia(tmp_path, said)).exact() == load(PLAIN).exact()


def test_a_matrix_is_written_back(tmp_path):
    mission = load(with_inertia(tmp_path, SKEWED))
    for source in (mission.source, "nothing there"):
        again = tmp_path / "again.toml"
        again.write_text(mission_text(mission.model_copy(update={"source": source})), "utf-8")
        assert load(again).vehicle == mission.vehicle


def test_the_torque_turns_a_body_with_products_of_inertia_as_the_law_wants(tmp_path):
    """By Euler's equation with the whole matrix, typed here, torque and motion fit."""
    path = with_inertia(tmp_path, SKEWED)
    inertia = np.array(load(path).vehicle.matrix, float)
    start = {"start.rates": "[0.3, -0.2, 0.4]", "gains.k_yaw": "0.5"}
    same_yaw = start | {"gains.k_yaw": "0.22"}  # of 0.22 kg m² in place of 0.5
    ours = simulate(load(path, start), duration=1, step=0.002, every=1)
    theirs = simulate(load(PLAIN, same_yaw), duration=1, step=0.002, every=1)
    assert np.allclose(ours["position"], theirs["position"], atol=1e-9)
    assert not np.allclose(ours["torque"], theirs["torque"], atol=1e-2)
    rate, torque = ours["body_rate"].values, ours["torque"].values
    free = torque - np.cross(rate, rate @ inertia)
    happened = np.gradient(rate, 0.002, axis=0)[2:-2]
    assert np.allclose(np.linalg.solve(inertia, free.T).T[2:-2], happened, atol=1e-4)


def test_a_tolerance_that_products_of_inertia_do_not_go_with_is_refused(tmp_path):
    path = with_inertia(tmp_path, SKEWED)
    assert load(path)
    with pytest.raises(InputError, match="must be 0 for a vehicle with products of inertia"):
        load(path, {"uncertainty.torque": "0.1"})
