"""Tags in rendered images: where they are found, in which order, and what that tells."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import hoverproof as hp
from hoverproof.errors import InputError
from hoverproof.eyes.at_rest import at_rest
from hoverproof.eyes.detector import Detector
from hoverproof.eyes.opencv import bits
from hoverproof.eyes.renderer import Pose, Renderer, Shot
from hoverproof.eyes.sightings import Sightings, Viewer
from hoverproof.eyes.video import Source
from hoverproof.mission.tags import board_of_file, board_of_mission, board_of_tag
from hoverproof.plant.lens import LensModel, sight_of
from hoverproof.plant.rigid_body import rotation_matrix

PLAIN = LensModel(320, 240, 220, 220, 159.5, 119.5, "plumb_bob", (0.0,) * 5)
BARREL = LensModel(320, 240, 200, 205, 165, 118, "plumb_bob", (-0.28, 0.07, 5e-4, -3e-4, 0.01))
FISHEYE = LensModel(320, 240, 150, 152, 165, 118, "equidistant", (-0.01, 0.02, -5e-3, 1e-3))
LENSES = {"plain": PLAIN, "barrel": BARREL, "fisheye": FISHEYE}
STILL = np.zeros(3)
TAG = "36h11:0:0.2"


def renderer(board, lens=PLAIN, **shot):
    return Renderer(board, lens, sight_of(lens), Shot(**shot))


def pose(x=0.0, y=0.0, height=0.7, roll=0.0, pitch=0.0, yaw=0.0, velocity=STILL, rate=STILL):
    place = np.array([x, y, -height])
    return Pose(place, rotation_matrix(roll, pitch, yaw), np.array(velocity), np.array(rate))


def found(board, at, lens=PLAIN, number=0, **shot):
    """Return corners found less true ones, (m, 4, 2), px."""
    drawing = renderer(board, lens, **shot)
    image = drawing.image(at, number)
    return Detector(board, lens, sight_of(lens)).corners(image) - drawing.pixels(at)


def test_a_tag_is_drawn_as_its_inventors_print_it():
    drawn = bits(board_of_tag(TAG), 0) // 255
    assert drawn.shape == (8, 8)
    assert [list(row) for row in drawn[1:3, 1:-1]] == [[1, 1, 0, 1, 0, 1], [0, 1, 1, 1, 0, 1]]
    assert not drawn[[0, -1]].any()  # the black border


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("tag", [TAG, "4x4_50:7:0.2", "mip_36h12:3:0.2"])
def test_corners_are_found_as_printed_whichever_way_the_tag_is_seen(tag, lens):
    board = board_of_tag(tag)
    for k, yaw in enumerate(np.arange(-3, 5) * np.pi / 4):
        leaning = pose(0.05, -0.04, 0.6, roll=0.2 * np.cos(k), pitch=0.2 * np.sin(k), yaw=yaw)
        assert np.abs(found(board, leaning, LENSES[lens], k)).max() < 0.25


def test_the_top_left_of_a_tag_is_toward_the_upper_left_of_a_camera_that_is_not_turned():
    pixels = renderer(board_of_tag(TAG)).pixels(pose())[0]
    assert (pixels[0] < pixels[2]).all()  # top left, bottom right
    assert pixels[1][0] > pixels[3][0] and pixels[1][1] < pixels[3][1]


def test_corners_are_not_drawn_to_one_side_by_blur_and_noise():
    board = board_of_tag(TAG)
    moving = {"velocity": (0.5, -0.3, 0.2), "rate": (0.3, -0.4, 1.0)}
    errors = np.concatenate(
        [
            found(board, pose(0.03 * k % 0.2, -0.1, 0.6, yaw=k, **moving), BARREL, k, exposure=0.01)
            for k in range(16)
        ]
    )
    assert np.abs(errors.mean(axis=0)).max() < 0.1
    assert np.abs(errors.mean(axis=(0, 1))).max() < 0.02
    assert errors.std() < 0.1


def test_a_light_that_is_low_is_noisier_and_none_finds_nothing():
    board = board_of_tag(TAG)
    dim, lit = (found(board, pose(), light=light, grey_noise=2) for light in (0.15, 1))
    assert np.abs(dim).max() > np.abs(lit).max()
    assert np.isnan(found(board, pose(), light=0)).all()


def test_a_tag_that_is_partly_out_of_the_image_or_another_one_is_not_found():
    board = board_of_tag(TAG)
    assert np.isnan(found(board, pose(x=0.52))).all()
    other = Detector(board_of_tag("36h11:1:0.2"), PLAIN, sight_of(PLAIN))
    assert np.isnan(other.corners(renderer(board).image(pose()))).all()


def test_a_tag_is_not_drawn_from_behind():
    under = Pose(np.array([0, 0, 0.7]), np.diag([1.0, -1.0, -1.0]), STILL, STILL)
    drawing = renderer(board_of_tag(TAG), grey_noise=0)
    assert np.ptp(drawing.image(under)) == 0


BOARDS = {
    "grid": "target_type: aprilgrid\ntagCols: 2\ntagRows: 2\ntagSize: 0.08\ntagSpacing: 0.3\n",
    "bundle": "tag_bundles:\n  - name: pad\n    layout:\n      - {id: 4, size: 0.1, x: -0.1}\n"
    "      - {id: 2, size: 0.08, x: 0.08, qw: 0.8, qz: 0.6}\n",
    "map": "%YAML:1.0\n---\naruco_bc_mInfoType: 1\naruco_bc_dict: DICT_5X5_100\n"
    "aruco_bc_markers:\n"
    "  - {id: 9, corners: [[-0.2, 0.1, 0], [-0.1, 0.1, 0], [-0.1, 0.0, 0], [-0.2, 0.0, 0]]}\n"
    "  - {id: 3, corners: [[0.0, 0.1, 0], [0.1, 0.1, 0], [0.1, 0.0, 0], [0.0, 0.0, 0]]}\n",
}


@pytest.mark.parametrize("kind", BOARDS)
def test_boards_of_other_tools_are_found_in_the_order_of_their_points(kind):
    Path("board.yaml").write_text(BOARDS[kind], encoding="utf-8")
    board = board_of_file("board.yaml")
    told = hp.load("research-1.5kg", {"target": {"points": board.points.tolist()}})
    placed = board_of_mission(told, board)
    assert np.abs(placed.points - np.array(told.target.points, float)).max() < 1e-9
    for yaw in (0.4, 2.5, -1.7):
        assert np.abs(found(placed, pose(yaw=yaw, height=0.55))).max() < 0.3


def test_a_board_without_tags_or_with_one_twice_is_refused():
    Path("b.yaml").write_text(
        "target_type: checkerboard\ntargetCols: 3\ntargetRows: 3\n"
        "rowSpacingMeters: 0.05\ncolSpacingMeters: 0.05\n"
    )
    with pytest.raises(InputError, match=r"b\.yaml: holds no tags"):
        board_of_file("b.yaml")
    Path("b.yaml").write_text(BOARDS["map"].replace("id: 3", "id: 9"))
    with pytest.raises(InputError, match="has one tag twice"):
        board_of_file("b.yaml")


def test_the_tag_of_a_mission_lies_on_its_square_and_another_is_refused():
    mission = hp.load("crazyflie-2.1")
    points = np.array(mission.target.points, float)
    board = board_of_mission(mission, None)
    assert (board.family, board.numbers) == ("36h11", (0,))
    assert (board.points == points).all()
    left, right = board.corners[0][[0, 3]].mean(axis=0), board.corners[0][[1, 2]].mean(axis=0)
    assert (right - left)[0] > 0 == (right - left)[1]
    with pytest.raises(InputError, match=r"have sides of .* m, the tag 0\.9 m"):
        board_of_mission(mission, board_of_tag("36h11:0:0.9"))
    odd = hp.load("crazyflie-2.1", {"target.points": "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]"})
    with pytest.raises(InputError, match=r"target\.points: are not the corners of one tag"):
        board_of_mission(odd, None)


@pytest.mark.parametrize(
    ("tag", "reason"),
    [
        ("36h11:0", "must be FAMILY:ID:SIZE"),
        ("36h11:0:-1", "must be FAMILY:ID:SIZE"),
        ("36h12:0:0.2", "did you mean '36h11'"),
        ("36h11:x:0.2", "must be FAMILY:ID:SIZE"),
    ],
)
def test_a_tag_that_is_none_is_refused(tag, reason):
    with pytest.raises(InputError, match=reason):
        board_of_tag(tag)


def test_a_number_that_a_family_has_not_is_refused():
    with pytest.raises(InputError, match="4x4_50 has tags 0 to 49, not 50"):
        bits(board_of_tag("4x4_50:50:0.2"), 50)


@pytest.mark.parametrize("lens", LENSES)
def test_the_pose_of_the_camera_is_told_by_the_tag(lens):
    board, at = board_of_tag(TAG), pose(0.1, -0.05, 0.6, 0.15, -0.1, 2.0)
    viewer = Viewer(board, LENSES[lens], sight_of(LENSES[lens]))
    pixels = renderer(board, LENSES[lens]).pixels(at).reshape(-1, 2)[board.order]
    position, rotation = viewer.pose(pixels)
    assert position == pytest.approx(at.position, abs=1e-6)
    assert rotation == pytest.approx(at.rotation, abs=1e-6)
    assert viewer.fitted(position, rotation) == pytest.approx(pixels, abs=1e-4)


def test_what_a_law_sees_vanishes_at_its_goal_and_is_in_body_axes():
    told = "{width = 320, height = 240, fx = 150, fy = 150, cx = 160, cy = 120}"
    settings = {"camera.lens": told, "camera.rotation": "[0.1, 0, 1.5707963]", "sensors": "{}"}
    mission = hp.load("crazyflie-2.1", settings)
    board = board_of_mission(mission, None)
    lens = LensModel.of(mission)
    viewer = Viewer(board, lens, sight_of(lens), mission)
    goal = viewer.numbers.goal
    axes = np.array(viewer.mount.rotation)
    down = np.array([[0, 0, 1.0]])
    seen = Sightings(viewer, Source("", 0, 30.0))
    errors = []
    for place in (goal, goal + np.array([0.05, 0, 0])):
        pixels = renderer(board, lens).pixels(Pose(place, axes, STILL, STILL))
        errors.append(seen.told(pixels.reshape(-1, 2)[board.order][None], down)[3][0])
    assert np.abs(errors[0]).max() < 1e-3
    assert errors[1][0] < -0.01 and abs(errors[1][1]) < 1e-3  # it is behind the vehicle


def still(board, count, **shot):
    viewer = Viewer(board, PLAIN, sight_of(PLAIN))
    drawing = renderer(board, **shot)
    images = ((k / 30, drawing.image(pose(0.02, 0.01, 0.6, yaw=0.3), k)) for k in range(count))
    seen = Sightings(viewer, Source("still", count, 30.0, images))
    seen.look(lambda image, pixels: None, lambda done, total: None)
    return seen, drawing.pixels(pose(0.02, 0.01, 0.6, yaw=0.3)).reshape(-1, 2)[board.order]


def test_the_noise_of_a_still_camera_is_that_of_its_corners():
    seen, true = still(board_of_tag(TAG), 40, grey_noise=4)
    rest = at_rest(seen)
    errors = np.array(seen.pixels) - true
    assert rest.frames == 40
    assert rest.pixel_noise == pytest.approx(errors.std(axis=0).mean(), rel=0.15)
    features = seen.record()["scaled_centroid"].values
    away = np.linalg.norm(features - features.mean(axis=0), axis=1)
    assert rest.largest == pytest.approx(away.max(), rel=0.3)
    assert rest.bound >= rest.bias + rest.largest
    pixel, feature = (line.split("] ")[1] for line in rest.lines())
    told = {
        f"sensors.{pixel.split(' = ')[0]}": pixel.split(" = ")[1],
        "sensors.focal_length": "220",
    }
    told["uncertainty.noise"] = feature.split("noise = ")[1]
    mission = hp.load("x4-flyer", told)
    assert float(mission.uncertainty.noise.feature) >= rest.bound
    assert float(mission.sensors.pixel_noise) >= rest.pixel_noise


def test_a_corner_that_is_off_shows_as_a_bias():
    Path("board.yaml").write_text(BOARDS["grid"], encoding="utf-8")
    seen, _ = still(board_of_file("board.yaml"), 24)
    plain = at_rest(seen)
    for pixels in seen.pixels:
        pixels[0] += [1.5, 0]
    off = at_rest(seen)
    assert off.pixel_bias > 4 * plain.pixel_bias
    assert off.bias > 4 * plain.bias


def test_the_longest_still_stretch_is_found_and_too_short_a_one_is_none():
    seen, _ = still(board_of_tag(TAG), 30)
    for k, pixels in enumerate(seen.pixels):
        pixels += 5.0 * max(0, k - 24)
    rest = at_rest(seen)
    assert (rest.frames, rest.end) == (25, 24 / 30)
    for k, pixels in enumerate(seen.pixels):
        pixels += 5.0 * k
    assert at_rest(seen) is None
    with pytest.raises(InputError, match="still: has 4 frames"):
        at_rest(seen, (0.0, 0.1))


def test_without_opencv_it_says_what_to_install(monkeypatch):
    from hoverproof.eyes import opencv

    opencv.opencv.cache_clear()
    monkeypatch.setitem(__import__("sys").modules, "cv2", None)
    with pytest.raises(InputError, match=r"pip install 'hoverproof\[vision\]'"):
        opencv.opencv()
    opencv.opencv.cache_clear()


def test_the_same_frame_is_the_same_image_and_noise_differs_from_frame_to_frame():
    drawing = renderer(board_of_tag(TAG))
    again = replace(drawing)
    assert (drawing.image(pose(), 3) == again.image(pose(), 3)).all()
    assert (drawing.image(pose(), 3) != drawing.image(pose(), 4)).any()
