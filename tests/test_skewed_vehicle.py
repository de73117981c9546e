"""A vehicle with unequal arms, products of inertia, and a camera ahead, tilted and turned."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

import hoverproof as hp
from hoverproof.certification.exponential.proof import converge
from hoverproof.cli.console import app
from hoverproof.cli.questions import placed
from hoverproof.compilers import find_compiler
from hoverproof.export.binding import Firmware
from hoverproof.firmware import export_c

SKEWED = """
name = "skewed"
[law]
feature = "scaled"
goal = "inertial"
force = "measured"
[vehicle]
mass = 0.5
inertia = [[0.0041, 0, 0.0004], [0, 0.0045, 0], [0.0004, 0, 0.0075]]
rotors = [
  {position = [0.13, 0.20, 0], spin = "ccw"},
  {position = [-0.12, -0.17, 0], spin = "ccw"},
  {position = [0.13, -0.20, 0], spin = "cw"},
  {position = [-0.12, 0.17, 0], spin = "cw"},
]
drag_ratio = 0.0221
gravity = 9.81
[target]
points = [[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, -0.1, 0], [-0.1, 0.1, 0]]
[goal]
height = 1.2
heading = 0
[gains]
k1 = 0.05
k2 = 28
k3 = 2.2
k4 = 5.5
k_yaw = 0.035
[bounds]
eigenvalues = "auto"
thrust = [4.4145, 5.3955]
[start]
position = [0.2, 0, -1.4]
[uncertainty]
thrust = 0.1
latency = 0.02
[camera]
position = [0.08, 0, 0]
rotation = [0, 0.17453, 1.5708]  # tilted by 10 degrees, turned by 90
"""
TURNED = {  # the same numbers, but in axes with x to the right and y to the rear
    "vehicle.inertia": "[[0.0045, 0, 0], [0, 0.0041, -0.0004], [0, -0.0004, 0.0075]]",
    "vehicle.rotors": "["
    '{position = [0.20, -0.13, 0], spin = "ccw"}, {position = [-0.17, 0.12, 0], spin = "ccw"}, '
    '{position = [-0.20, -0.13, 0], spin = "cw"}, {position = [0.17, 0.12, 0], spin = "cw"}]',
    "camera.position": "[0, -0.08, 0]",
    "camera.rotation": "[0, 0.17453, 0]",
}
GOAL = np.array([0, 0, -1.2])


@pytest.fixture
def load(tmp_path):
    def mission(overrides=None):
        path = tmp_path / "skewed.toml"
        path.write_text(SKEWED)
        return hp.load(path, overrides or {})

    return mission


@pytest.mark.skipif(not find_compiler(), reason="no C compiler")
def test_it_flies_by_its_c_to_its_goal_and_described_in_other_axes_it_does_not(load, tmp_path):
    for name, described in (("right", load()), ("wrong", load(TURNED))):
        export_c(described, tmp_path / name, name="fw", allow_uncertified=True)
    world = "example/vehicle.c"  # what is, whatever is said of it
    shutil.copy(tmp_path / "right" / world, tmp_path / "wrong" / world)
    flown = Firmware(tmp_path / "right").fly(0.002, 20, 500)
    assert not set(flown["status"]) - {64}  # nothing but that the gains alone are not proved
    assert np.linalg.norm(flown["state"][-1][:3] - GOAL) < 0.02

    flown = Firmware(tmp_path / "wrong").fly(0.002, 20, 500)
    ended = any(status & 7 for status in flown["status"])
    assert ended or np.linalg.norm(flown["state"][-1][:3] - GOAL) > 0.02


@pytest.mark.slow
def test_it_is_proved_for_every_vehicle_within_its_tolerances(load):
    verdict = converge(load())
    assert verdict.proved, verdict.reason
    assert "from the centre of mass" in verdict.statement


def test_new_takes_its_rotors_over_and_says_what_it_leaves_out(load, tmp_path, monkeypatch):
    load()
    monkeypatch.chdir(tmp_path)
    app(["new", "own.toml", "--vehicle", "skewed.toml", "--yes"], result_action="return_value")
    text = (tmp_path / "own.toml").read_text()
    own, given = hp.load(tmp_path / "own.toml").vehicle, load().vehicle
    assert own.rotors == given.rotors and own.inertia == given.inertia
    assert own.products is None and "products of inertia [0, 0.0004, 0] kg m²" in text


@pytest.mark.parametrize("layout", ["plus", "hex", "octo", "x"])
def test_new_takes_a_layout_over_with_propellers_that_turn_the_other_way(load, layout):
    said = f'{{mass = 0.5, inertia = [0.004, 0.004, 0.0075], layout = "{layout}", arm = 0.2, '
    mission = load({"vehicle": f"{said}reversed = true, drag_ratio = 0.02, gravity = 9.81}}"})
    assert "reversed = true" in placed(mission.vehicle)
    assert f'layout = "{layout}"' in placed(mission.vehicle)
