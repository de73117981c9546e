"""Frames of any number of rotors: flown, exported and proved like four."""

from __future__ import annotations

from fractions import Fraction

import casadi as ca
import numpy as np
import pytest

from hoverproof import checker
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.firmware.exporting import export_c
from hoverproof.firmware.flying import fly_firmware
from hoverproof.mission.frame import names, of_layout, shares
from hoverproof.mission.reading import load
from hoverproof.mission.writing import mission_text
from hoverproof.plant import rotors
from hoverproof.simulation.flight import simulate
from test_vehicle import with_inertia, with_vehicle

UNEQUAL = """rotors = [
  {position = [0.1, 0.2, 0], spin = "cw"},
  {position = [0.1, -0.2, 0], spin = "ccw"},
  {position = [-0.12, 0.15, 0], spin = 1, drag_ratio = 0.02},
  {position = [-0.12, -0.15, 0], spin = -1, drag_ratio = 0.02},
  {position = [-0.02, -0.2, -0.1], spin = 1},
]"""
FRAMES = [
    'layout = "plus"\narm = 0.2',
    'layout = "h"\narm = [0.1, 0.2]',
    'layout = "hex"\narm = 0.2',
    'layout = "octo"\narm = 0.2\nreversed = true',
    UNEQUAL,
]
X_LISTED = """rotors = [
  {position = [-0.25, 0.25, 0], spin = "cw"},
  {position = [0.25, 0.25, 0], spin = "ccw"},
  {position = [-0.25, -0.25, 0], spin = "ccw"},
  {position = [0.25, -0.25, 0], spin = "cw"},
]"""


def mixing(vehicle):
    """Return the mixing matrix, by hand, (4, n), in SI units."""
    flown = vehicle.as_flown()
    d = vehicle.reach
    listed = flown.get("rotors") or [[-d, d, -1], [d, d, 1], [-d, -d, 1], [d, -d, -1]]
    columns = [[1, -y, x, turn * vehicle.drag_ratio] for x, y, turn in listed]
    return np.array(columns, float).T


@pytest.mark.parametrize("said", FRAMES)
def test_thrusts_are_the_pseudo_inverse_of_what_rotors_make(tmp_path, said):
    vehicle = load(with_vehicle(tmp_path, said)).vehicle
    lengths = ca.SX(float(vehicle.reach)), ca.SX(float(vehicle.drag_ratio))
    asked = np.array([20, 0.3, -0.2, 0.1])
    each = rotors.rotor_thrusts(vehicle.frame, ca.SX(asked[0]), ca.SX(asked[1:]), *lengths)
    made = rotors.wrench(vehicle.frame, each, *lengths)
    assert np.allclose(np.array(ca.DM(made)).ravel(), asked, rtol=1e-12)
    pseudo_inverse = np.linalg.pinv(mixing(vehicle))
    assert np.allclose(np.array(ca.DM(each)).ravel(), pseudo_inverse @ asked, rtol=1e-9)
    assert np.allclose(
        [float(t) for t in vehicle.hover_thrusts], pseudo_inverse[:, 0] * float(vehicle.weight)
    )


@pytest.mark.parametrize("said", FRAMES)
def test_the_checker_shares_thrusts_out_as_the_model_does(tmp_path, said):
    vehicle = load(with_vehicle(tmp_path, said)).vehicle
    lengths = 1, vehicle.reach, vehicle.reach, vehicle.drag_ratio
    ours = [[s / c for s, c in zip(row, lengths, strict=True)] for row in shares(vehicle.frame)]
    theirs = checker.Object()
    for key, value in vehicle.as_flown().items():
        setattr(theirs, key, value)
    assert checker.rotor_shares(theirs) == ours


def test_the_x_frame_by_its_rotors_is_the_x_frame(tmp_path):
    assert load(with_vehicle(tmp_path, X_LISTED)).exact() == load("x4-flyer").exact()


@pytest.mark.parametrize("said", FRAMES[2:])
def test_a_frame_flies_where_an_x_does_with_its_own_rotors(tmp_path, said):
    """The law asks for thrust and torque; without limits any frame makes them."""
    mission, plain = load(with_vehicle(tmp_path, said)), load("x4-flyer")
    for more in ({}, {"rotors.time_constant": "0.02", "sensors.control_rate": "200"}):
        path = str(tmp_path / "vehicle.toml")
        ours = simulate(load(path, more), duration=1.5)
        theirs = simulate(load("x4-flyer", more), duration=1.5)
        assert list(ours["rotor"].values) == list(mission.vehicle.frame.names)
        assert np.allclose(ours["position"], theirs["position"], atol=1e-9)
        made = ours["rotor_thrust"].values @ mixing(mission.vehicle).T
        assert np.allclose(made[:, 0], ours["thrust"], rtol=1e-9)
        assert np.allclose(made[:, 1:], ours["torque"], atol=1e-9)
    assert plain.vehicle.frame.names != mission.vehicle.frame.names


@pytest.mark.parametrize("said", FRAMES[2::2])
def test_exported_c_drives_each_rotor_as_the_simulation_does(tmp_path, said):
    mission = load(with_vehicle(tmp_path, said))
    by_c = fly_firmware(mission, duration=1, step=0.004)
    plain = simulate(mission, duration=1, step=0.004)
    assert by_c["rotor_thrust"].shape[1] == len(mission.vehicle.frame.names)
    made = by_c["rotor_thrust"].values @ mixing(mission.vehicle).T
    assert np.allclose(made[:, 0], by_c["thrust"], rtol=1e-6)  # float32
    assert np.allclose(by_c["rotor_thrust"].values[0], plain["rotor_thrust"].values[0], rtol=1e-5)


def test_exported_c_turns_a_body_with_products_of_inertia(tmp_path):
    said = "inertia = [[0.4, 0.02, 0.05], [0.02, 0.56, -0.03], [0.05, -0.03, 0.5]]"
    mission = load(with_inertia(tmp_path, said), {"start.rates": "[0.3, -0.2, 0.4]"})
    by_c = fly_firmware(mission, duration=1, step=0.002)
    plain = simulate(mission, duration=1, step=0.002)
    assert np.allclose(by_c["torque"].values[0], plain["torque"].values[0], rtol=1e-5)
    assert np.allclose(by_c["position"], plain["position"], atol=1e-3)
    assert np.allclose(by_c["body_rate"], plain["body_rate"], atol=5e-3)


def test_a_rotor_at_its_limit_is_clipped_and_it_alone(tmp_path):
    path = with_vehicle(tmp_path, 'layout = "hex"\narm = 0.2')
    free = load(path, {"sensors.control_rate": "100", "start.rates": "[2, 0, 0]"})
    unlimited = simulate(free, duration=0.05)["rotor_thrust"].values[1]
    limit = float(np.sort(unlimited)[-2] + np.sort(unlimited)[-1]) / 2
    held = {
        "sensors.control_rate": "100",
        "start.rates": "[2, 0, 0]",
        "rotors.max_thrust": str(limit),
    }
    limited = simulate(load(path, held), duration=0.05)["rotor_thrust"].values[1]
    assert limited.max() == pytest.approx(limit)
    assert np.allclose(np.sort(limited)[:-1], np.sort(unlimited)[:-1])


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("rotors = []", "a list of 4 to 16 rotors"),
        (X_LISTED.replace('"cw"', '"ccw"'), "turn to either side"),
        (X_LISTED.replace("[0.25,", "[-0.25,"), "in front and behind"),
        (X_LISTED.replace("[-0.25,", "[0.05,"), "rotor 2 (front right) would have to pull down"),
        (X_LISTED.replace('"cw"', '"left"', 1), '"ccw" (1) or "cw" (-1)'),
        (X_LISTED.replace(", 0]", "]", 1), "a list [x, y, z]"),
        (X_LISTED + '\nlayout = "x"', "goes without rotors"),
    ],
)
def test_rotors_that_cannot_fly_are_refused(tmp_path, said, told):
    with pytest.raises(InputError) as caught:
        load(with_vehicle(tmp_path, said))
    assert caught.value.key.startswith("vehicle.")
    assert told in str(caught.value)


@pytest.mark.parametrize("said", FRAMES)
def test_a_frame_is_written_back(tmp_path, said):
    path = with_vehicle(tmp_path, said)
    mission = load(path)
    for source in (str(path), "nothing there"):
        again = tmp_path / "again.toml"
        again.write_text(mission_text(mission.model_copy(update={"source": source})), "utf-8")
        assert load(again).vehicle == mission.vehicle


def test_rotors_are_called_by_where_they_are():
    assert of_layout("hex").names == (
        *("front right", "right", "rear right"),
        *("rear left", "left", "front left"),
    )
    assert len({*of_layout("octo").names}) == 8
    stacked = [(Fraction(1), Fraction(1), Fraction(z)) for z in (0, -1)]
    assert names(stacked) == ("front right lower", "front right upper")
    for name, turn in zip(of_layout("hex").names, of_layout("hex").turns, strict=True):
        assert (turn == 1) == (name in ("front right", "rear right", "left"))


def limited(tmp_path, *limits):
    """A cross whose rotors, front, right, rear and left, have limits of their own."""
    places = [(0.2, 0), (0, 0.2), (-0.2, 0), (0, -0.2)]
    rotors = ", ".join(
        f'{{position = [{x}, {y}, 0], spin = "{"ccw" if i % 2 else "cw"}"{more}}}'
        for i, ((x, y), more) in enumerate(zip(places, limits, strict=True))
    )
    return with_vehicle(tmp_path, f"rotors = [{rotors}]")


OWN = ", thrust_max = 30", ", thrust_min = 23, thrust_max = 24.5", "", ", thrust_max = 27"
ENDS = [(0, 30), (23, 24.5), (0, 26), (0, 27)]
HIT = {"start.rates": "[3, -3, 0]", "rotors.max_thrust": "26", "rotors.min_thrust": "0"}


def test_each_rotor_has_its_own_limits_in_flight_and_in_the_c(tmp_path):
    mission = load(limited(tmp_path, *OWN), HIT)
    low, high = np.array(ENDS).T
    free = {"start.rates": HIT["start.rates"], "sensors.control_rate": "100"}
    wanted = simulate(load(limited(tmp_path, "", "", "", ""), free), duration=0.05)
    limited(tmp_path, *OWN)
    flown = simulate(mission, duration=0.05)["rotor_thrust"].values[:5]
    assert (flown >= low - 1e-12).all() and (flown <= high + 1e-12).all()
    assert flown[1][1] in (23, 24.5) and (wanted["rotor_thrust"].values[:5] != flown).any()

    manifest = export_c(mission, tmp_path / "fw", name="fw", allow_uncertified=True)
    assert manifest["each_rotor"] == [list(map(float, ends)) for ends in ENDS]
    firmware = Firmware(tmp_path / "fw")
    image = np.array(mission.target.points, float)[:, :2] / 3
    rest = {"velocity": [0, 0, 0], "gravity_direction": [0, 0, 1], "dt": 0.002}
    for rate in ([3, -3, 0], [-3, 3, 0]):
        out = firmware.step(image, rate=rate, **rest)
        assert out.status & 32
        assert (np.array(out.rotor) >= low).all() and (np.array(out.rotor) <= high).all()
        assert set(np.round(out.rotor, 6)) & {0, 23, 24.5, 26, 27, 30}
    assert firmware.set_rotor_limits(1, 25) == 0  # of all, within those of their own
    out = firmware.step(image, rate=rate, **rest)
    assert (np.array(out.rotor) >= np.maximum(low, 1)).all()
    assert (np.array(out.rotor) <= np.minimum(high, 25)).all()


def test_a_throttle_is_of_all_rotors_at_their_own_limits(tmp_path):
    law = {"feature": "scaled", "goal": "inertial", "force": "measured"}
    loop = {"law": law, "interface.rate_bandwidth": "40", "rotors.max_thrust": "26"}
    options = {
        "name": "fw",
        "allow_uncertified": True,
        "interface": "rates",
        "precision": "float64",
    }
    export_c(load(limited(tmp_path, *OWN), loop), tmp_path / "fw", **options)
    assert Firmware(tmp_path / "fw").selftest() == 0
    told = (tmp_path / "fw" / "fw_params.h").read_text().split("THROTTLE_PER_NEWTON (")[1]
    assert float(told.split(")")[0]) == pytest.approx(1 / sum(high for _, high in ENDS))


def test_limits_of_a_rotor_that_are_none_are_refused(tmp_path):
    with pytest.raises(InputError, match="thrust_min: must be below thrust_max"):
        load(limited(tmp_path, ", thrust_min = 3, thrust_max = 2", "", "", ""))
    with pytest.raises(InputError, match=r"rotor right must be below its highest"):
        load(limited(tmp_path, "", ", thrust_max = 2", "", ""), {"rotors.min_thrust": "3"})
    with pytest.raises(InputError, match="must hold the share of a rotor in hover"):
        export_c(load(limited(tmp_path, "", "", "", ", thrust_max = 20")), tmp_path / "fw")
