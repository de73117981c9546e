"""What a command reads is not written over, and ranges of tolerances are those of missions."""

from __future__ import annotations

import pytest

import hoverproof as hp
from command_line import refusal, run
from hoverproof.cli.reading import keep_what_is_read
from hoverproof.design.axes import axis
from hoverproof.errors import InputError
from hoverproof.mission.presets import preset_text


@pytest.fixture
def mission(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(preset_text("crazyflie-2.1"))
    return path


COMMANDS = {
    "simulate": ("simulate", "{mission}", "--out", "{mission}"),
    "film": ("simulate", "{mission}", "--pixels", "--film", "{mission}"),
    "certify": ("certify", "{mission}", "--out", "{folder}/./mine.toml"),
    "report": ("report", "{mission}", "-o", "{mission}"),
    "atlas": ("atlas", "{mission}", "--figure", "{mission}"),
    "fly": ("fly", "{mission}", "--rehearse", "px4", "--log", "{mission}"),
    "audit": ("audit", "{mission}", "--mission", "x4-flyer", "--out", "{mission}"),
    "replay": ("replay", "{mission}", "--mission", "x4-flyer", "--out", "{mission}"),
    "see": ("see", "{mission}", "--tag", "36h11:0:0.2", "--overlay", "{mission}"),
}


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_a_file_that_is_read_is_not_written_over(words, mission, capsys):
    before = mission.read_bytes()
    filled = [word.format(mission=mission, folder=mission.parent) for word in words]
    line = refusal(capsys, *filled)
    assert "that is read; give another name" in line
    assert mission.read_bytes() == before


def test_a_mission_may_be_replaced_by_what_is_made_of_it(mission):
    keep_what_is_read("tune", mission=str(mission), out=mission)
    keep_what_is_read("audit", mission=str(mission), log=mission, certify=mission.parent / "new")
    with pytest.raises(InputError, match="certificate that is read"):
        keep_what_is_read("audit", certificate=mission, certify=mission)


def test_a_range_holds_tolerances_that_a_mission_may_have(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ("atlas", "crazyflie-2.1", "--theorem", "start", "--x", "thrust", "--x-range", "0.5,2")
    assert "--x-range: thrust: must be from 0 to 0.999" in refusal(capsys, *words)
    wide = hp.replace("crazyflie-2.1", {"uncertainty.thrust": 0.6})
    assert axis(wide, "thrust", cells=2, of_start=True).values.tolist() == [0, 0.999]


def test_wrong_types_are_named():
    with pytest.raises(hp.InputError, match=r"^x: must be of the class Axis or text, not 3"):
        hp.atlas("crazyflie-2.1", 3, "k2")
    with pytest.raises(hp.InputError, match=r"^starts: must be .*, each of the class Start"):
        hp.attraction("crazyflie-2.1", starts=[(1, 2, -3)])


def test_a_stretch_without_a_flight_is_not_called_damage(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(capsys, "simulate", "crazyflie-2.1", "--duration", "0.1", "--no-figures")[0] == 0
    log = ("crazyflie-2.1.flight.nc", "--mission", "crazyflie-2.1")
    line = refusal(capsys, "replay", *log, "--between", "0,0.001")
    assert "holds no flight between these times" in line


def test_a_folder_that_is_not_there_is_refused_first(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for command in ("audit", "replay"):
        words = (command, "none.nc", "--mission", "x4-flyer", "--out", "none/out.html")
        assert "its folder is not there" in refusal(capsys, *words)


def test_new_names_the_file_that_was_asked_for(capsys, tmp_path):
    path = tmp_path / "tiny.toml"
    status, _, said = run(capsys, "new", path, "--yes", "--mass", "1e-12")
    assert status == 2
    assert f"hoverproof: {path}: vehicle.inertia" in said
    assert list(tmp_path.iterdir()) == []
    line = refusal(capsys, "new", path, "--yes", "--thrust", "20%")
    assert "must be a number (a share: 0.2 is 20 %), not '20%'" in line
