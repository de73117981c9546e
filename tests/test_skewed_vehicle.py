"""A vehicle with unequal arms, products of inertia, and a camera ahead, tilted and turned."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import hoverproof as hp
from hoverproof.certification.exponential.proof import converge
from hoverproof.certification.verdict import Undecided
from hoverproof.checker import Rejected, check, claim_of
from hoverproof.cli import main
from hoverproof.cli.answers.exponential import beyond
from hoverproof.cli.console import app
from hoverproof.cli.questions import placed
from hoverproof.compilers import find_compiler
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.export.package import NotCertified
from hoverproof.firmware import exporting
from hoverproof.firmware.exporting import export_c
from test_on_the_way import forged

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


@pytest.fixture(scope="module")
def proved(tmp_path_factory):
    path = tmp_path_factory.mktemp("skewed") / "skewed.toml"
    path.write_text(SKEWED)
    return converge(hp.load(path))


@pytest.mark.slow
def test_it_is_proved_for_every_vehicle_within_its_tolerances(proved):
    assert proved.proved, proved.reason
    assert "from the centre of mass" in proved.statement


@pytest.mark.slow
def test_each_rotor_has_bounds_of_its_own(proved, load):
    content, ends = proved.certificate.content, proved.rotor_thrusts
    assert len(ends) == 4 and len({*ends}) > 1
    least, most = proved.rotor_thrust
    of_all = {**content["claim"], "rotors": [str(least), str(most)]}
    claim = claim_of({**content, "claim": of_all})
    assert len(claim.rotors()) == 4 and claim.c.claim.rotors == [[least, most]]
    made = claim_of(content).rotors()
    assert all(a <= c < d <= b for (a, b), (c, d) in zip(ends, made, strict=True))

    for wrong in (
        [*content["claim"]["rotors"][:3], ["-1/2", "2"]],  # one of a rotor does not follow
        content["claim"]["rotors"][:3],
        [],
    ):
        with pytest.raises(Rejected, match="the thrust of a rotor does not follow"):
            check(forged(content, ("claim", "rotors"), wrong))

    def told(*cut):
        held = [(a, b - c) for (a, b), c in zip(ends, cut, strict=True)]
        limits = [f", thrust_min = {float(a)}, thrust_max = {float(b)}" for a, b in held]
        text = SKEWED.split("rotors = [")[1].split("]\n")[0]
        for spin, limit in zip(text.splitlines()[1:], limits, strict=True):
            text = text.replace(spin, spin.replace("}", f"{limit}}}"))
        return beyond(replace(proved, mission=load({"vehicle.rotors": f"[{text}]"})))

    floor = [a for a, _ in ends]
    assert min(floor) < 0  # so that one cannot be said
    ends = tuple((max(a, 0), b) for a, b in ends)
    assert len(told(0, 0, 0, 0)) == sum(a < 0 for a in floor)
    words = "max_thrust of the rear left rotor may be violated by up to 0.25 N"
    assert told(0, Fraction(1, 4), 0, 0)[-1] == words


@pytest.mark.slow
@pytest.mark.skipif(not find_compiler(), reason="no C compiler")
def test_it_is_certified_and_flies_by_its_c_to_its_goal_and_described_in_other_axes_does_not(
    load, proved, tmp_path
):
    held, folders = proved.certificate.content, (tmp_path / "right", tmp_path / "wrong")
    manifest = export_c(load(), folders[0], name="fw", certificate=held)
    assert manifest["theorems"] == {"5": held["sha256"]}
    assert json.loads((folders[0] / "fw.attraction.cert.json").read_text()) == held
    for file in ("fw.h", "fw_params.h", "manifest.json"):
        assert held["sha256"] in (folders[0] / file).read_text()
    assert held["statement"] in (folders[0] / "README.md").read_text()
    flown = Firmware(folders[0]).fly(0.002, 20, 500)
    assert not any(flown["status"])
    assert np.linalg.norm(flown["state"][-1][:3] - GOAL) < 0.02

    with pytest.raises(Rejected, match="another mission"):
        export_c(load(TURNED), folders[1], name="fw", certificate=held)
    export_c(load(TURNED), folders[1], name="fw", allow_uncertified=True)
    world = "example/vehicle.c"  # what is, whatever is said of it
    shutil.copy(folders[0] / world, folders[1] / world)
    flown = Firmware(folders[1]).fly(0.002, 20, 500)
    ended = any(status & 7 for status in flown["status"])
    assert ended or np.linalg.norm(flown["state"][-1][:3] - GOAL) > 0.02


@pytest.mark.slow
def test_the_command_proves_it_where_the_gains_alone_are_not_and_takes_a_file(
    load, proved, tmp_path, monkeypatch, capsys
):
    load()
    monkeypatch.chdir(tmp_path)
    proved.certificate.save("held.json")
    monkeypatch.setattr(exporting, "attraction", lambda mission, progress: proved)
    bare = ["export", "skewed.toml", "--out"]
    assert app([*bare, "a"], result_action="return_value") == 0
    given = [*bare, "b", "--certificate", "held.json"]
    assert app(given, result_action="return_value") == 0
    told = capsys.readouterr().out
    assert "certified (theorem 5)" in told
    assert "not considered" not in told
    assert Path("a/manifest.json").read_bytes() == Path("b/manifest.json").read_bytes()
    assert "not proved to be respected" in Path("a/README.md").read_text()

    mission, open_ = load(), Undecided(mission=load(), reason="no proof")
    monkeypatch.setattr(exporting, "attraction", lambda mission, progress: open_)
    with pytest.raises(NotCertified, match="from its start it is undecided too: no proof"):
        export_c(mission, "c")
    with pytest.raises(InputError, match="needs camera"):  # before anything is searched
        export_c(mission, "c", pixels=True)
    changed = ["export", "skewed.toml", "--out", "c", "--certificate", "changed.json"]
    text = Path("held.json").read_text().replace('"level"', '"lever"')
    Path("changed.json").write_text(text)
    with pytest.raises(SystemExit) as stop:
        main(changed)
    assert stop.value.code == 2
    assert "changed.json: is rejected" in capsys.readouterr().err
    assert not Path("c").exists()


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
