"""Targets of other tools: the corners that a file describes, in metres and seen from above."""

import json
from fractions import Fraction as F
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from command_line import run
from hoverproof import cli
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.mission.target_files import read_target

GRID = "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\n"
BOARD = (
    "target_type: checkerboard\ntargetCols: 4\ntargetRows: 3\n"
    "rowSpacingMeters: 0.06\ncolSpacingMeters: 0.05\n"
)
TAG = "{id: 0, size: 0.2, x: 0.1, y: -0.2, z: 0.03, qw: 0.8, qx: 0.0, qy: 0.36, qz: 0.48}"
BUNDLE = f"tag_bundles:\n  - name: pad\n    layout:\n      - {TAG}\n      - {{id: 1, size: 1e-1}}\n"
SINGLE = "standalone_tags: [{id: 7, size: 0.05}, {id: 9, size: 0.1, name: door}]\n"
MAP = """%YAML:1.0
---
aruco_bc_mInfoType: 1
aruco_bc_markers:
  - {id: 0, corners: [[-0.1, 0.1, 0.], [0.1, 0.1, 0.], [0.1, -0.1, 0.], [-0.1, -0.1, 0.]]}
  - {id: 1, corners: [[0.3, 0.1, 0.], [0.5, 0.1, 0.], [0.5, -0.1, 0.], [0.3, -0.1, 0.]]}
"""


def read(text, name=None):
    Path("target.yaml").write_text(text, encoding="utf-8")
    return read_target("target.yaml", name)


def floats(found):
    return np.array(found.points, float)


def test_an_aprilgrid_has_four_corners_a_tag_and_its_middle_is_the_origin():
    found = read(GRID)
    points = floats(found)
    assert len(points) == 4 * 30
    assert points.mean(axis=0) == pytest.approx([0, 0, 0], abs=1e-12)
    pitch = 0.088 * 1.3
    assert points[4] - points[0] == pytest.approx([pitch, 0, 0])  # the next tag in the row
    assert points[24] - points[0] == pytest.approx([0, -pitch, 0])  # y of the file is up, here down
    assert points[2] - points[0] == pytest.approx([0.088, -0.088, 0])
    assert all(x.denominator < 10**7 for point in found.points for x in point)  # decimals, exactly
    assert "0.088 m" in found.words[0]
    assert "0.0264 m between" in found.words[0]


def test_a_checkerboard_has_its_inner_corners():
    points = floats(read(BOARD))
    assert len(points) == 12
    assert np.ptp(points, axis=0) == pytest.approx([0.15, 0.12, 0])


def test_a_bundle_has_its_tags_where_they_are_and_turned_as_they_are():
    points = floats(read(BUNDLE))
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) / 2
    turn = Rotation.from_quat([0.0, 0.36, 0.48, 0.8])
    place = np.array([0.1, -0.2, 0.03])
    wanted = np.vstack([turn.apply(0.2 * square) + place, 0.1 * square])
    wanted = wanted * [1, -1, -1]  # from x right, y up, z out of the tag
    assert points == pytest.approx(wanted - wanted.mean(axis=0), abs=2e-6)


def test_a_single_tag_is_named_if_there_are_several():
    found = read(SINGLE, "door")
    assert floats(found).max() == 0.05
    assert floats(read(SINGLE, "7")).max() == 0.025
    with pytest.raises(InputError, match="several targets: 7, door"):
        read(SINGLE)
    with pytest.raises(InputError, match="did you mean 'door'"):
        read(SINGLE, "doors")
    assert len(read(SINGLE + BUNDLE).points) == 8  # the one bundle is meant


def test_a_marker_map_has_the_corners_that_it_says_in_its_order():
    found = read(MAP)
    assert found.points[0] == (F("-0.3"), F("-0.1"), 0)
    assert found.side == F("0.6")


@pytest.mark.parametrize(
    ("text", "key", "reason"),
    [
        ("", "", "no target that is known"),
        ("a: [1, 2", "", "not valid YAML"),
        ("points: [[1, 2, 3]]", "", "tag_bundles"),
        ("target_type: chess", "target_type", "'aprilgrid' or 'checkerboard'"),
        (GRID.replace("tagCols: 6", ""), "tagCols", "is missing"),
        (GRID.replace("tagCols: 6", "tagCols: 6.5"), "tagCols", "a whole number"),
        (GRID.replace("tagCols: 6", "tagCols: 900"), "", "18000 corners, at most 1024"),
        (GRID.replace("0.088", "-0.088"), "tagSize", "above 0 in m"),
        (GRID.replace("0.088", "8.8 cm"), "tagSize", "a number above 0 in m"),
        (GRID.replace("0.088", ".nan"), "tagSize", "a number above 0 in m"),
        (GRID.replace("0.088", "1e999999999"), "tagSize", "a number above 0 in m"),
        (BUNDLE.replace("qw: 0.8", "qw: 2"), "tag_bundles[1].layout[1]", "length 2.088"),
        (BUNDLE.replace("size: 0.2", "size: [0.2]"), "tag_bundles[1].layout[1].size", "in m"),
        ("tag_bundles: []", "", "neither a tag bundle nor a standalone tag"),
        ("tag_bundles: 3", "tag_bundles", "must be a list"),
        ("tag_bundles: [3]", "tag_bundles[1].layout", "missing|mapping"),
        ("standalone_tags: [{size: 0.1}]", "standalone_tags[1].id", "is missing"),
        (MAP.replace("mInfoType: 1", "mInfoType: 0"), "aruco_bc_mInfoType", "pixels"),
        (
            MAP.replace("[-0.1, 0.1, 0.]", "[-0.1, 0.1]"),
            "aruco_bc_markers[1].corners[1]",
            "x, y, z",
        ),
        ("&a [*a]", "", "YAML|no target"),
    ],
)
def test_what_cannot_be_used_is_refused_by_file_key_and_reason(text, key, reason):
    with pytest.raises(InputError, match=reason) as error:
        read(text)
    assert str(error.value).startswith("target.yaml")
    assert error.value.key == key or "mapping" in error.value.reason


def test_json_is_read_too():
    held = {"target_type": "aprilgrid", "tagCols": 1, "tagRows": 1, "tagSize": 0.5, "tagSpacing": 1}
    assert len(read(json.dumps(held)).points) == 4


def test_new_writes_the_points_with_what_they_are(capsys):
    Path("grid.yaml").write_text(GRID.replace("tagCols: 6", "tagCols: 2"), encoding="utf-8")
    status, out, _ = run(capsys, "new", "mine.toml", "--from", "x4-flyer", "--target", "grid.yaml")
    assert status == 0
    assert "AprilGrid: 2 x 5 tags of 0.088 m" in out
    mission = load("mine.toml")
    assert mission.target.points == read_target("grid.yaml").points
    assert "# AprilGrid: 2 x 5 tags" in Path("mine.toml").read_text(encoding="utf-8")


def test_new_finds_gains_for_a_target_of_a_file():
    Path("tags.yaml").write_text(BUNDLE, encoding="utf-8")
    with pytest.raises(SystemExit) as exit_:
        cli.main(["new", "mine.toml", "--target", "tags.yaml", "--yes"])
    assert exit_.value.code == 0
    mission = load("mine.toml")
    assert mission.target.points == read_target("tags.yaml").points
    assert mission.law.feature == "scaled"


@pytest.mark.parametrize(
    ("options", "where"),
    [
        (["--target-name", "pad"], "--target-name"),
        (["--target", "tags.yaml", "--tag", "0.2"], "--tag"),
        (["--target", "tags.yaml", "--target-name", "dap"], "--target-name"),
        (["--target", "none.yaml"], "none.yaml"),
    ],
)
def test_options_of_a_target_that_do_not_go_are_refused(options, where, capsys):
    Path("tags.yaml").write_text(BUNDLE, encoding="utf-8")
    status, _, err = run(capsys, "new", "mine.toml", "--yes", *options)
    assert status == 2
    assert err.startswith(f"hoverproof: {where}")
    assert not Path("mine.toml").exists()
