"""Lenses: against OpenCV, and what cannot be one is refused."""

from __future__ import annotations

import math
import re

import casadi as ca
import numpy as np
import pytest

import hoverproof as hp
from hoverproof.cli.answers.exponential import lines
from hoverproof.errors import InputError
from hoverproof.plant import lens as of_lens
from hoverproof.plant.lens import LensModel, check_cone, cone_in_image, seeing_lens, sight_of
from once import attraction_once

BARREL = LensModel(640, 480, 400, 410, 330, 236, "plumb_bob", (-0.28, 0.07, 5e-4, -3e-4, 0.01))
CUSHION = LensModel(640, 480, 400, 410, 330, 236, "plumb_bob", (0.1, -0.2, 1e-3, 5e-4, 0.05))
FISHEYE = LensModel(640, 480, 300, 305, 330, 236, "equidistant", (-0.01, 0.02, -5e-3, 1e-3))
LENSES = {"barrel": BARREL, "cushion": CUSHION, "fisheye": FISHEYE}
PLAIN = "{width = 640, height = 480, fx = 400, fy = 400, cx = 320, cy = 240}"


def over(graph, size, columns):
    symbol = ca.SX.sym("x", size)
    return np.array(ca.Function("f", [symbol], [graph(symbol)]).map(columns.shape[1])(columns))


def points_of(lens, pixels):
    return over(lambda pixel: lens.undistorted(pixel, sight_of(lens).steps), 2, pixels)


@pytest.fixture(params=LENSES)
def lens(request):
    return LENSES[request.param]


@pytest.fixture
def pixels(lens):
    draw = np.random.default_rng(1)
    return draw.uniform([[0], [0]], [[lens.width], [lens.height]], (2, 500))


def test_each_pixel_is_that_of_its_point(lens, pixels):
    back = over(lens.pixel, 2, points_of(lens, pixels))
    assert np.abs(back - pixels).max() < 1e-9


def test_points_and_pixels_are_those_of_opencv(lens, pixels):
    cv2 = pytest.importorskip("cv2")
    K = np.array([[lens.fx, 0, lens.cx], [0, lens.fy, lens.cy], [0, 0, 1.0]])
    points = points_of(lens, pixels)
    rays = np.vstack([points, np.ones(points.shape[1])]).T.reshape(-1, 1, 3)
    own = np.array(lens.coefficients)
    if lens.model == "equidistant":
        seen, _ = cv2.fisheye.projectPoints(rays, np.zeros(3), np.zeros(3), K, own)
        theirs = cv2.fisheye.undistortPoints(pixels.T.reshape(-1, 1, 2), K, own)
    else:
        seen, _ = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), K, own)
        often = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 500, 1e-14)
        theirs = cv2.undistortPoints(pixels.T.reshape(-1, 1, 2), K, own, None, None, None, often)
    assert np.abs(seen.reshape(-1, 2).T - pixels).max() < 1e-9
    assert np.abs(theirs.reshape(-1, 2).T - points).max() < 1e-9


@pytest.mark.parametrize("tangent", [0.0, 1e-9, 0.2, 1.0, 3.0, math.tan(math.radians(80))])
def test_angles_are_those_of_the_library(tangent):
    angle = float(ca.evalf(of_lens._arctangent(ca.SX(tangent))))
    assert angle == pytest.approx(math.atan(tangent), rel=1e-14, abs=1e-300)
    back = float(ca.evalf(of_lens._tangent_over(ca.SX(angle)))) * angle
    assert back == pytest.approx(tangent, rel=1e-13, abs=1e-300)


def test_a_lens_that_folds_over_within_the_image_is_refused():
    told = PLAIN[:-1] + ", distortion = [-0.6]}"
    with pytest.raises(InputError, match=r"camera\.lens\.distortion: leaves pixels"):
        seeing_lens(hp.load("x4-flyer", {"camera.lens": told}))


def test_a_fisheye_that_sees_almost_sideways_is_refused():
    told = PLAIN[:-1].replace("400", "200") + ', distortion_model = "equidistant"}'
    with pytest.raises(InputError, match="beyond 80 degrees"):
        seeing_lens(hp.load("x4-flyer", {"camera.lens": told}))


def test_the_cone_within_an_image_ends_at_its_nearest_edge():
    _, sight = seeing_lens(hp.load("x4-flyer", {"camera.lens": PLAIN}))
    axis = np.array([0.0, 0.0, 1.0])
    nearest = math.atan(240 / 400)
    assert nearest - 2e-3 < sight.half_angle(axis) < nearest
    leaning = np.array([0.0, math.sin(0.2), math.cos(0.2)])
    assert nearest - 0.2 - 2e-3 < sight.half_angle(leaning) < nearest - 0.2
    assert sight.half_angle(-axis) == 0
    assert sight.half_angle(np.array([math.sin(1.2), 0.0, math.cos(1.2)])) == 0


def test_a_half_angle_beyond_the_image_is_refused_with_the_one_that_fits():
    told = {"camera.lens": PLAIN, "camera.half_angle": "0.54"}
    check_cone(hp.load("x4-flyer", {**told, "camera.half_angle": "0.53"}))
    with pytest.raises(
        InputError, match=r"camera\.half_angle: .* within it has 0\.53\d* rad, not 0\.54"
    ):
        check_cone(hp.load("x4-flyer", told))


WRITTEN = """
image_width: 640
image_height: 480
camera_name: bottom
camera_matrix:
  rows: 3
  cols: 3
  data: [400.25, 0., 330, 0., 410, 236.125, 0., 0., 1.]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 0.07, 5e-04, -3.0e-4, 0]
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
"""
PUBLISHED = """
header: {frame_id: bottom}
height: 480
width: 640
distortion_model: equidistant
d: [-0.01, 0.02, -0.005, 0.001]
k: [300.0, 0.0, 330.0, 0.0, 305.0, 236.0, 0.0, 0.0, 1.0]
"""


@pytest.fixture
def mission_with(tmp_path):
    from hoverproof.mission.presets import preset_text

    def load(info, more=""):
        (tmp_path / "camera_info.yaml").write_text(info)
        section = f'\n[camera]\nfile = "camera_info.yaml"\n{more}'
        (tmp_path / "mission.toml").write_text(preset_text("x4-flyer") + section)
        return hp.load(tmp_path / "mission.toml")

    return load


def test_the_lens_of_a_calibration_file_is_read_exactly(mission_with):
    told = mission_with(WRITTEN).exact()["camera"]["lens"]
    assert told["fx"] == "1601/4" and told["cy"] == "1889/8"
    assert told["distortion"] == ["-7/25", "7/100", "1/2000", "-3/10000", "0"]
    assert "distortion_model" not in told  # it is the usual one


def test_the_lens_of_a_message_is_read(mission_with):
    mission = mission_with(PUBLISHED)
    assert LensModel.of(mission) == FISHEYE
    seeing_lens(mission)


@pytest.mark.parametrize(
    ("wrong", "instead", "reason"),
    [
        ("plumb_bob", "rational_polynomial", "distortion_model: must be plumb_bob or equidistant"),
        ("400.25, 0.", "400.25, 1.", "camera_matrix: must have no skew"),
        ("image_width: 640", "", "image_width: is missing"),
        ("-0.28,", "x,", "distortion_coefficients: must hold a list of numbers"),
        ("data: [400.25, 0.,", "data: [400.25,", "camera_matrix: must be"),
        ("image_height: 480", "image_height: [", "is not valid YAML"),
    ],
)
def test_a_calibration_that_cannot_be_used_is_refused(mission_with, wrong, instead, reason):
    with pytest.raises(InputError, match=reason) as refused:
        mission_with(WRITTEN.replace(wrong, instead))
    assert "camera_info.yaml" in str(refused.value)


def test_what_a_calibration_holds_is_held_to_the_ranges_of_a_mission(mission_with):
    with pytest.raises(InputError, match=r"camera\.lens\.cx: must be within the image"):
        mission_with(WRITTEN.replace("330", "700"))
    with pytest.raises(InputError, match=r"camera\.lens\.fy: must be above 0"):
        mission_with(WRITTEN.replace("410", "-410"))


def test_a_file_and_a_lens_are_not_both_given(mission_with):
    with pytest.raises(InputError, match=r"give either the file or camera\.lens"):
        mission_with(WRITTEN, f"lens = {PLAIN}")


def test_a_file_that_is_not_there_is_said(tmp_path):
    with pytest.raises(InputError, match=r"no such file; camera\.file is relative to the mission"):
        hp.load("x4-flyer", {"camera.file": f'"{tmp_path / "none.yaml"}"'})


def test_a_lens_takes_the_place_of_what_sensors_say(mission_with):
    with pytest.raises(InputError, match=r"sensors\.width: is told by camera\.lens"):
        hp.load("x4-flyer", {"camera.lens": PLAIN, "sensors.width": "640", "sensors.height": "480"})
    hp.load("x4-flyer", {"camera.lens": PLAIN, "sensors.pixel_noise": "1"})
    with pytest.raises(InputError, match=r"sensors\.focal_length: is missing"):
        hp.load("x4-flyer", {"sensors.pixel_noise": "1"})


def test_a_key_that_a_lens_has_not_is_told_with_those_that_it_has():
    with pytest.raises(InputError, match=r"lens\.fc: unknown key \(known here: width, .*fx"):
        hp.load("x4-flyer", {"camera.lens.fc": 400})


@pytest.mark.slow
def test_points_that_may_leave_the_image_are_told_where_nobody_asked_that_they_do_not():
    verdict = attraction_once(hp.load("crazyflie-2.1", {"camera": f"{{lens = {PLAIN}}}"}))
    said = " ".join("\n".join(lines(verdict, [])).split())
    assert float(verdict.field_of_view) > cone_in_image(verdict.mission)
    asked = re.search(r"they may leave it; camera\.half_angle = ([\d.]+) asks", said)
    assert float(asked[1]) == cone_in_image(verdict.mission)
