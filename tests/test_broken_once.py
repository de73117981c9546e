"""Files and options with which a hostile tester once broke something."""

import json
from pathlib import Path

import pytest

from command_line import run
from hoverproof import checker
from hoverproof.certification.certificate import differences
from hoverproof.errors import InputError
from hoverproof.firmware.exporting import export_c
from hoverproof.mission.presets import preset_text
from hoverproof.mission.reading import load

PROOFS = Path(__file__).parents[1] / "proofs"


def resealed(content):
    """Make hashes and statement of a changed certificate anew."""
    content = json.loads(json.dumps(content))
    content["mission_sha256"] = checker.digest(content["mission"])
    rest = {k: v for k, v in content.items() if k != "sha256"}
    rest["statement"] = checker.statement(rest)
    return rest | {"sha256": checker.digest(rest)}


def test_a_device_without_end_is_no_mission(capsys):
    status, _, err = run(capsys, "certify", "/dev/zero")
    assert status == 2
    assert "is larger than" in err


@pytest.mark.parametrize("number", ["9." + "6" * 5000, "1e-999", "9" * 5000])
def test_a_number_that_no_vehicle_has_is_refused_and_not_rounded(number):
    text = preset_text("x4-flyer").replace("position = [5,", f"position = [{number},")
    Path("long.toml").write_text(text)
    with pytest.raises(InputError, match="a number of too many digits"):
        load("long.toml")
    with pytest.raises(InputError, match=r"is not a TOML value$") as refused:
        load("x4-flyer", {"start.position": f"[{number}, 0, -4]"})
    assert len(str(refused.value)) < 100


@pytest.mark.parametrize("out", ["/", "", "."])
@pytest.mark.parametrize("command", ["certify", "region", "attraction", "atlas", "simulate"])
def test_a_folder_is_no_file_to_write(command, out, capsys):
    status, _, err = run(capsys, command, "x4-flyer", "--out", out)
    assert status == 2
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize("kind", ["attraction.cert", "cert", "region.cert"])
@pytest.mark.parametrize(
    "bounds",
    [
        {"eigenvalues": {"proved": "anything"}, "thrust": ["85", "103"]},
        {"eigenvalues": ["1/100", "5", {}, []], "thrust": ["85", "103"]},
        {"eigenvalues": ["1/100", "5"], "thrust": "whatever"},
        {"eigenvalues": ["1/100", "5"], "level": {}},
        {"eigenvalues": "auto", "box": [], "thrust": ["85", "103"]},
    ],
)
def test_bounds_that_are_none_are_rejected_in_every_kind(kind, bounds):
    content = json.loads((PROOFS / f"x4-flyer.{kind}.json").read_text())
    content["mission"]["bounds"] = bounds
    with pytest.raises(checker.Rejected):
        checker.check(resealed(content))


def test_a_certificate_of_other_numbers_is_never_about_a_mission():
    content = json.loads((PROOFS / "x4-flyer.cert.json").read_text())
    mission = load("x4-flyer")
    assert differences(content, mission) == []
    content["mission"]["bounds"]["box"] = []
    content["mission_sha256"] = checker.digest(content["mission"])
    assert differences(content, mission)


def test_a_package_does_not_replace_files_that_are_of_none(tmp_path):
    own = tmp_path / "own"
    own.mkdir()
    (own / "README.md").write_text("MINE")
    mission = load("x4-flyer")
    with pytest.raises(InputError, match=r"README\.md that is of no package"):
        export_c(mission, own)
    assert (own / "README.md").read_text() == "MINE"
    export_c(mission, tmp_path / "package")
    assert export_c(mission, tmp_path / "package", precision="float64")["precision"] == "float64"
