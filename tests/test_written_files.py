"""Where commands write: names of their own, and what cannot be written is refused first."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

from command_line import refusal, run
from hoverproof.errors import InputError
from hoverproof.files import require_file, write_text
from hoverproof.mission.presets import preset_text
from hoverproof.simulation import flight

BRIEF = ("--duration", "0.1", "--no-figures", "--json")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def nothing_flown(monkeypatch):
    def flown(*_, **__):
        raise AssertionError("flown before it was refused")

    monkeypatch.setattr(flight, "flown", flown)


def test_missions_that_differ_write_files_of_other_names(capsys):
    for name in ("mine", "copied"):
        Path(f"{name}.toml").write_text(preset_text("x4-flyer"))
    asked = (
        ("mine.toml",),
        ("copied.toml",),
        ("mine.toml", "--set", "gains.k1=0.3"),
        ("mine.toml", "--set", "sensors.latency=0.1"),
        ("mine.toml", "--set", "interface.rate_bandwidth=25"),
        ("mine.toml", "--set", "name=third"),
    )
    told = [json.loads(run(capsys, "simulate", *words, *BRIEF)[1])["out"] for words in asked]
    assert len({*told}) == len(asked)
    assert told[:2] + told[-1:] == ["mine.flight.nc", "copied.flight.nc", "third.flight.nc"]
    same = ("mine.toml", "--set", "sensors.latency=0")
    assert json.loads(run(capsys, "simulate", *same, *BRIEF)[1])["out"] == "mine.flight.nc"


def test_a_log_held_against_another_mission_has_a_page_of_its_own(capsys):
    run(capsys, "simulate", "crazyflie-2.1", *BRIEF)
    words = ("replay", "crazyflie-2.1.flight.nc", "--mission", "crazyflie-2.1", "--no-figure")
    for more in ((), ("--set", "gains.k1=0.01")):
        assert run(capsys, *words, *more)[0] == 0
    found = sorted(path.name for path in Path.cwd().glob("*.replay.nc"))
    assert len(found) == 2
    assert "crazyflie-2.1.flight.replay.nc" in found


@pytest.mark.usefixtures("nothing_flown")
@pytest.mark.parametrize(
    ("words", "ending"),
    [
        ("simulate x4-flyer --out x.txt", ".nc"),
        ("simulate x4-flyer --runs 3 --set scatter.mass=0.1 --out x.txt", ".nc"),
        ("atlas x4-flyer --out x.png", ".nc"),
        ("atlas x4-flyer --figure x.nc", ".png or .svg"),
        ("replay log.nc --mission x4-flyer --out x.txt", ".nc"),
        ("tune x4-flyer --out t.json", ".toml"),
        ("tune x4-flyer --trade latency --out t.toml", ".png or .svg"),
        ("certify x4-flyer --out c.toml", ".json"),
        ("region x4-flyer --out c.nc", ".json"),
        ("attraction x4-flyer --out c.png", ".json"),
        ("report x4-flyer --out r.pdf", ".html"),
        ("audit log.nc --mission x4-flyer --out a.pdf", ".html"),
        ("audit log.nc --mission x4-flyer --certify w.json", ".toml"),
        ("fly crazyflie-2.1 --rehearse px4 --duration 1 --log log.ulg", ".nc"),
        ("new mine.json --yes", ".toml"),
    ],
)
def test_another_ending_than_that_of_what_is_written_is_refused(words, ending, capsys):
    assert f"must end in {ending}\n" in refusal(capsys, *words.split())
    assert not list(Path.cwd().iterdir())


@pytest.mark.usefixtures("nothing_flown")
@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("simulate x4-flyer --out no/f.nc", "its folder is not there"),
        ("simulate x4-flyer --animate no/f.html", "its folder is not there"),
        ("simulate x4-flyer --out held.nc", "is a directory"),
        ("simulate x4-flyer --out file/f.nc", "Not a directory"),
        (f"simulate x4-flyer --out {'n' * 300}.nc", "File name too long"),
        ("atlas x4-flyer --figure no/f.png", "its folder is not there"),
        ("report x4-flyer --out no/r.html", "its folder is not there"),
        ("certify x4-flyer --out no/c.json", "its folder is not there"),
        ("new no/mine.toml --yes", "its folder is not there"),
        ("export x4-flyer --out file/fw", "file is no folder"),
        (f"export x4-flyer --out {'n' * 300}", "File name too long"),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_work(words, reason, capsys, folder):
    (folder / "held.nc").mkdir()
    (folder / "file").touch()
    assert reason in refusal(capsys, *words.split())


def test_a_file_that_is_read_only_stays(capsys, folder):
    kept = folder / "x4-flyer.cert.json"
    kept.write_text("mine", encoding="utf-8")
    kept.chmod(0o444)
    assert "x4-flyer.cert.json: cannot be written: it is read-only" in refusal(
        capsys, "certify", "x4-flyer"
    )
    assert kept.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("command", ["attraction", "region"])
def test_a_mission_whose_files_would_have_too_long_names_is_refused_first(command, capsys, folder):
    name = "n" * 240
    (folder / f"{name}.toml").write_text(preset_text("x4-flyer"), encoding="utf-8")
    assert "File name too long" in refusal(capsys, command, f"{name}.toml")  # no word of progress


def test_a_page_that_is_not_written_has_no_name(capsys):
    words = ("audit", "log.nc", "--mission", "x4-flyer", "--no-page", "--out", "a.html")
    assert "--out: does not go with --no-page" in refusal(capsys, *words)


def test_a_link_stays_and_what_it_points_to_is_replaced(folder):
    (folder / "far").mkdir()
    (folder / "far" / "a.txt").write_text("old")
    (folder / "a.txt").symlink_to("far/a.txt")
    write_text(folder / "a.txt", "new")
    assert (folder / "a.txt").is_symlink()
    assert (folder / "far" / "a.txt").read_text() == "new"


def test_no_file_takes_the_place_of_a_device():
    with pytest.raises(InputError, match="a device, not a file"):
        require_file("/dev/null")


def test_what_comes_next_may_be_typed_as_it_stands_whatever_the_file_is_called(capsys):
    name = "my 'flyer'; true.toml"
    Path(name).write_text(preset_text("x4-flyer"), encoding="utf-8")
    (line,) = (x for x in run(capsys, "certify", name)[1].splitlines() if x.startswith("Next: "))
    words = shlex.split(line.removeprefix("Next: "))
    assert words[:2] == ["hoverproof", "check"]
    assert run(capsys, *words[1:])[0] == 0


def test_an_answer_has_the_same_keys_whatever_it_says(capsys):
    run(capsys, "certify", "x4-flyer")
    Path("none.json").write_text("{}")
    asked = {
        "check": ("x4-flyer.cert.json", "none.json", "x4-flyer.cert.json --mission racer-250"),
        "simulate": ("x4-flyer --duration 1", "crazyflie-2.1 --duration 1"),
        "new": ("mine.toml --yes", "theirs.toml --from x4-flyer"),
    }
    for command, ways in asked.items():
        options = ("--no-figures",) if command == "simulate" else ()
        told = [run(capsys, command, *way.split(), *options, "--json")[1] for way in ways]
        keys = {frozenset(json.loads(one)) for one in told}
        assert len(keys) == 1, command
