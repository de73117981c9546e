"""Vehicles of other tools' files: masses, inertias and rotors are those that the files mean."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from command_line import run
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.mission.vehicle_files import read_vehicle

LINK = (
    "<inertial><origin xyz='{xyz}' rpy='{rpy}'/><mass value='{m}'/>"
    "<inertia ixx='{i[0]}' iyy='{i[1]}' izz='{i[2]}' ixy='0' ixz='0' iyz='0'/></inertial>"
)
URDF = (
    "<robot name='r'><link name='base'>"
    + LINK.format(xyz="0 0 0", rpy="0 0 1.5707963267948966", m=1, i=(0.01, 0.02, 0.03))
    + "</link><link name='battery'>"
    + LINK.format(xyz="0.1 0 0", rpy="0 0 0", m=1, i=(0, 0, 0))
    + "</link><joint name='b' type='fixed'><parent link='base'/><child link='battery'/>"
    "<origin xyz='0.1 0 -0.1' rpy='0 0 0'/></joint>"
    + "".join(
        f"<link name='prop_{i}'/><joint name='p{i}' type='continuous'><parent link='base'/>"
        f"<child link='prop_{i}'/><origin xyz='{x} {y} 0.05' rpy='0 0 0'/></joint>"
        for i, (x, y) in enumerate([(0.3, 0.2), (0.3, -0.2), (-0.1, 0.2), (-0.1, -0.2)])
    )
    + "</robot>"
)
MOTOR = (
    "<plugin name='m{i}' filename='f'><linkName>rotor_{i}</linkName>"
    "<turningDirection>{spin}</turningDirection><timeConstantUp>0.0125</timeConstantUp>"
    "<motorConstant>8.5e-06</motorConstant><momentConstant>0.016</momentConstant></plugin>"
)
PLACES = [(0.17, -0.17, "ccw"), (-0.17, 0.17, "ccw"), (0.17, 0.17, "cw"), (-0.17, -0.17, "cw")]
SDF = (
    "<sdf version='1.9'><model name='m'><link name='base'><inertial><mass>2</mass><inertia>"
    "<ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz><ixy>0.001</ixy></inertia></inertial></link>"
    + "".join(
        f"<link name='rotor_{i}'><pose relative_to='base'>{x} {y} 0 0 0 0</pose></link>"
        + MOTOR.format(i=i, spin=spin)
        for i, (x, y, spin) in enumerate(PLACES)
    )
    + "</model></sdf>"
)
MJCF = """<mujoco><default><default class="x"><geom mass="0"/>
<default class="r"><geom type="ellipsoid" size=".1 .1 .01"/></default></default></default>
<worldbody><body name="x" pos="0 0 1" childclass="x"><geom type="box" size=".1 .1 .1" mass="1"/>
<geom class="r" pos=".1 .2 0" mass=".5"/><geom class="r" pos="-.1 -.2 0" mass=".5"/>
<site name="a" pos=".1 -.2 0"/><site name="b" pos="-.1 .2 0"/><site name="c" pos=".1 .2 0"/>
<site name="d" pos="-.1 -.2 0"/></body></worldbody><actuator>
<motor site="a" gear="0 0 1 0 0 -.02"/><motor site="b" gear="0 0 1 0 0 -.02"/>
<motor site="c" gear="0 0 1 0 0 .02"/><motor site="d" gear="0 0 1 0 0 .02"/></actuator></mujoco>"""
ROTORPY = """import numpy as np
d = 0.2/np.sqrt(2)
quad_params = {'mass': 0.5, 'Ixx': 3e-3, 'Iyy': 4e-3, 'Izz': 5e-3, 'Ixy': 1e-4,
  'rotor_pos': {'r1': d*np.array([1, 1, 0]), 'r2': d*np.array([1, -1, 0]),
                'r3': d*np.array([-1, -1, 0]), 'r4': d*np.array([-1, 1, 0])},
  'rotor_directions': np.array([1, -1, 1, -1]), 'k_eta': 5e-6, 'k_m': 1e-7, 'tau_m': 0.05}
open('touched', 'w')
"""
PX4 = "\n".join(
    f"1\t1\tCA_ROTOR{i}_{key}\t{value}\t9"
    for i, (x, y, km) in enumerate(
        [(0.15, 0.2, 0.05), (-0.15, -0.2, 0.05), (0.15, -0.2, -0.05), (-0.15, 0.2, -0.05)]
    )
    for key, value in (("PX", x), ("PY", y), ("KM", km))
)


def read(tmp_path, text):
    path = tmp_path / "vehicle.txt"
    path.write_text(text, encoding="utf-8")
    return read_vehicle(path)


def places(found):
    return {tuple(np.round(r.position[:2], 9)): r.spin for r in found.rotors}


def test_bodies_of_urdf_are_put_together_about_their_centre_as_turned(tmp_path):
    """Two bodies of 1 kg, one turned by 90 degrees, the other 0.2 m ahead and 0.1 m below."""
    found = read(tmp_path, URDF)
    assert found.mass == pytest.approx(2)
    assert np.allclose(np.diag(found.inertia), [0.02 + 0.005, 0.01 + 0.02 + 0.005, 0.03 + 0.02])
    assert found.inertia[0, 2] == pytest.approx(-0.01)  # ahead and below: x z > 0 with z down
    assert set(places(found)) == {(0.2, -0.2), (0.2, 0.2), (-0.2, -0.2), (-0.2, 0.2)}
    assert places(found)[0.2, 0.2] == 1
    assert any("by turns" in word for word in found.words)


def test_sdf_says_how_rotors_turn_and_what_they_make(tmp_path):
    found = read(tmp_path, SDF)
    assert (found.mass, found.drag_ratio, found.rotor_lag) == (2, 0.016, 0.0125)
    assert places(found) == {(x, -y): 1 if spin == "ccw" else -1 for x, y, spin in PLACES}
    assert found.inertia[0, 1] == pytest.approx(-0.001)


def test_mjcf_has_the_inertia_of_its_solids_and_rotors_that_turn_against_the_body(tmp_path):
    found = read(tmp_path, MJCF)
    discs = 2 * 0.5 / 5 * np.array([0.1**2 + 0.01**2] * 2 + [2 * 0.1**2])
    aside = 2 * 0.5 * np.array([0.2**2, 0.1**2, 0.2**2 + 0.1**2])
    assert found.mass == pytest.approx(2)
    assert np.allclose(np.diag(found.inertia), 2 / 3 * 0.1**2 + discs + aside)
    assert found.drag_ratio == pytest.approx(0.02)
    assert places(found) == {(0.1, 0.2): 1, (-0.1, -0.2): 1, (0.1, -0.2): -1, (-0.1, 0.2): -1}


def test_rotorpy_is_read_as_data_and_not_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = read(tmp_path, ROTORPY)
    assert not Path("touched").exists()
    assert found.mass == 0.5
    assert found.inertia[0, 1] == pytest.approx(-1e-4)
    d = round(0.2 / 2**0.5, 9)
    assert set(places(found)) == {(d, d), (d, -d), (-d, d), (-d, -d)}
    assert places(found)[d, -d] == -1  # left of straight ahead; the body is turned to the left
    assert found.drag_ratio == pytest.approx(0.02)


def test_px4_has_positions_and_senses_in_our_axes(tmp_path):
    found = read(tmp_path, PX4)
    assert places(found) == {(0.15, 0.2): 1, (-0.15, -0.2): 1, (0.15, -0.2): -1, (-0.15, 0.2): -1}
    assert (found.mass, found.inertia) == (None, None)
    assert any("default" in word for word in found.words)


PROP = "<link name='prop{i}'>{link}</link><joint name='j{i}' type='fixed'>{ends}</joint>"
ENDS = "<parent link='base'/><child link='prop{i}'/>"


def test_propellers_of_urdf_are_where_their_masses_are_and_say_what_they_make(tmp_path):
    """As gym-pybullet-drones writes them: joints at the centre, links of no mass."""
    base = "<link name='base'>" + LINK.format(xyz="0 0 0", rpy="0 0 0", m=0.5, i=(1, 1, 1))
    props = "".join(
        PROP.format(
            i=i,
            link=LINK.format(xyz=f"{x} {y} 0", rpy="0 0 0", m=0, i=(0, 0, 0)),
            ends=ENDS.format(i=i),
        )
        for i, (x, y) in enumerate([(0.03, 0.03), (0.03, -0.03), (-0.03, 0.03), (-0.03, -0.03)])
    )
    told = "<properties kf='2e-8' km='5e-10' thrust2weight='2'/>"
    found = read(tmp_path, f"<robot name='cf'>{told}{base}</link>{props}</robot>")
    assert set(places(found)) == {(0.03, 0.03), (0.03, -0.03), (-0.03, 0.03), (-0.03, -0.03)}
    assert found.drag_ratio == pytest.approx(0.025)
    assert [r.thrust_max for r in found.rotors] == [pytest.approx(2 * 0.5 * 9.8 / 4)] * 4


def test_a_model_that_sdf_includes_is_looked_for_beside_it(tmp_path):
    base = SDF.split("<link name='rotor_0'>")[0] + "</model></sdf>"
    rest = SDF.replace(base.removesuffix("</model></sdf>"), "<sdf version='1.9'><model name='m'>")
    uri = "<include merge='true'><uri>model://base</uri></include>"
    folder = tmp_path / "whole"
    folder.mkdir()
    (folder / "model.sdf").write_text(rest.replace("name='m'>", f"name='m'>{uri}", 1))
    bare = f"<sdf version='1.9'><model name='m'>{uri}</model></sdf>"
    with pytest.raises(InputError, match=r"it includes base, and there is no base/model\.sdf"):
        read(folder, bare)
    (tmp_path / "base").mkdir()
    (tmp_path / "base" / "model.sdf").write_text(base)
    whole, apart = read(tmp_path, SDF), read_vehicle(folder / "model.sdf")
    assert (apart.mass, apart.drag_ratio) == (whole.mass, whole.drag_ratio)
    assert places(apart) == places(whole)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (SDF.replace("0.17 -0.17 0 0 0 0", "0.17 -0.17 0 0 0.3 0"), "rotor_0 leans by 17.2 deg"),
        (MJCF.replace('gear="0 0 1', 'gear="0.3 0 1'), "rotor a leans by 16.7 degrees"),
        (f"{PX4}\n1\t1\tCA_ROTOR_COUNT\t5\t6\n1\t1\tCA_ROTOR4_AX\t1\t9", "CA_ROTOR4_AX turns"),
        (PX4.replace("CA_ROTOR3", "CA_ROTOR2"), "PX4 has 3 rotors: vehicles of 4 to 16"),
    ],
)
def test_rotors_that_the_law_cannot_use_are_refused_with_the_reason(tmp_path, text, told):
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("places_of", "layout"),
    [
        ([(1, 1, 0.05), (-1, -1, 0.05), (1, -1, -0.05), (-1, 1, -0.05)], "x"),
        ([(1, 1, -0.05), (-1, -1, -0.05), (1, -1, 0.05), (-1, 1, 0.05)], "x\nreversed = true"),
        ([(0, 1, 0.05), (0, -1, 0.05), (1, 0, -0.05), (-1, 0, -0.05)], "plus\nreversed = true"),
    ],
)
def test_generic_frames_of_px4_say_a_layout_and_no_length(tmp_path, places_of, layout):
    lines = [
        f"param set-default CA_ROTOR{i}_{key} {value}"
        for i, at in enumerate(places_of)
        for key, value in zip(("PX", "PY", "KM"), at, strict=True)
    ]
    found = read(tmp_path, "\n".join(lines))
    assert (found.layout, found.rotors, found.drag_ratio) == (layout, (), None)
    assert any("no length" in word for word in found.words)


def test_betaflight_without_a_mixer_is_its_own_default(tmp_path):
    found = read(tmp_path, "# version\n# Betaflight / STM32F405 (S405) 4.4.2\n#mixer HEX6X\n")
    assert found.layout == "x" and any("QUADX" in word for word in found.words)


@pytest.mark.parametrize(
    ("text", "most"),
    [
        (
            SDF.replace("<motorC", "<maxRotVelocity>1000</maxRotVelocity><motorC"),
            8.5,
        ),
        (MJCF.replace("<motor ", '<motor ctrlrange="0 13" '), 13),
        (ROTORPY.replace("'tau_m'", "'rotor_speed_max': 1500, 'tau_m'"), 11.25),
        ("\n".join([PX4, *(f"1\t1\tCA_ROTOR{i}_CT\t9.5\t9" for i in range(4))]), 9.5),
        (PX4, None),
        (SDF, None),
    ],
)
def test_the_highest_thrust_of_a_rotor_is_taken_where_it_is_said(tmp_path, text, most):
    found = read(tmp_path, text)
    assert [r.thrust_max for r in found.rotors] == [most and pytest.approx(most)] * 4


def test_units_of_doubt_are_flagged(tmp_path):
    in_g_cm2 = (
        SDF.replace("0.02<", "200000<").replace("0.03<", "300000<").replace("0.04<", "400000<")
    )
    assert any("g cm²" in word for word in read(tmp_path, in_g_cm2).words)
    assert not any("g cm²" in word for word in read(tmp_path, SDF).words)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "neither XML nor parameters"),
        ("<robot", "not valid XML"),
        ("<html></html>", "neither <robot>"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><robot/>", "entities"),
        ("<robot/>", "no mass"),
        ("<sdf/>", "no <model>"),
        ("<mujoco/>", "no <body>"),
        (MJCF.replace('type="box"', 'type="mesh"'), "'mesh' has a mass"),
        (URDF.replace("mass value='1'", "mass value='x'"), "could not convert"),
        ("quad_params = {'mass': 1}", "lacks mass, Ixx"),
        ("mixer TRI", "none of QUADX"),
    ],
)
def test_what_describes_no_vehicle_is_refused(tmp_path, text, told):
    with pytest.raises(InputError, match="describes no vehicle") as caught:
        read(tmp_path, text)
    assert told in str(caught.value)


@pytest.mark.parametrize(("text", "rotors"), [(SDF, 4), (PX4, 4), ("mixer HEX6X\n", 6)])
def test_new_takes_a_vehicle_and_says_what_it_has(tmp_path, monkeypatch, capsys, text, rotors):
    monkeypatch.chdir(tmp_path)
    Path("vehicle.txt").write_text(text, encoding="utf-8")
    options = ["--yes", "--json", "--tag", "0.3", "--mass", "1.5"]
    status, out, _ = run(capsys, "new", "mine.toml", "--from", "vehicle.txt", *options)
    assert status == 0
    json.loads(out)
    vehicle = load("mine.toml").vehicle
    assert len(vehicle.frame.names) == rotors
    assert float(vehicle.mass) == 1.5
    if text is SDF:
        assert [float(i) for i in vehicle.inertia] == [0.02, 0.03, 0.04]
        assert "products of inertia" in Path("mine.toml").read_text(encoding="utf-8")
