"""`see` and `simulate --pixels`, as a user meets them: films of known flights, and bad files."""

from __future__ import annotations

import csv
import json
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from command_line import refusal, run
from hoverproof.compilers import find_compiler
from hoverproof.eyes.renderer import Pose, Renderer
from hoverproof.eyes.video import video
from hoverproof.mavlink.sight import sighting_of
from hoverproof.mission.tags import board_of_tag
from hoverproof.plant.lens import LensModel, sight_of

EXAMPLES = Path(__file__).parents[1] / "examples"
INFO = """
image_width: 320
image_height: 240
camera_matrix: {rows: 3, cols: 3, data: [150, 0, 160, 0, 150, 120, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.1, 0.02, 0.0005, -0.0003, 0]}
"""
LENS = LensModel(320, 240, 150, 150, 160, 120, "plumb_bob", (-0.1, 0.02, 5e-4, -3e-4, 0.0))
TAG = ("--tag", "36h11:0:0.2")
CAMERA = ("--camera", "info.yaml")


def frames(count):
    drawing = Renderer(board_of_tag(TAG[1]), LENS, sight_of(LENS))
    for k in range(count):
        place = np.array([0.02, 0.01, -0.5])
        yield drawing.image(Pose(place, np.eye(3), np.zeros(3), np.zeros(3)), k)


@pytest.fixture
def film():
    Path("info.yaml").write_text(INFO, encoding="utf-8")
    with video(Path("film.avi"), 30.0, (320, 240)) as add:
        for image in frames(24):
            add(image)
    return "film.avi"


@pytest.fixture
def picture():
    import cv2

    Path("info.yaml").write_text(INFO, encoding="utf-8")
    cv2.imwrite("tag.png", next(frames(1)))
    return "tag.png"


@pytest.fixture
def mission():
    """A mission that flies above its tag, with a small image."""
    Path("info.yaml").write_text(INFO, encoding="utf-8")
    text = (EXAMPLES / "vehicles" / "hummingbird.toml").read_text(encoding="utf-8")
    text = text.replace("# [camera]", '[camera]\nfile = "info.yaml"')
    Path("m.toml").write_text(text, encoding="utf-8")
    return "m.toml"


FLY = ("simulate", "m.toml", "--pixels", "--no-figures", "--json")


def test_a_film_of_a_flight_shows_what_the_flight_saw(mission, capsys):
    status, out, _ = run(capsys, *FLY, "--duration", 0.8, "--film", "f.avi", "--out", "f.nc")
    facts = json.loads(out)["images"]
    assert (status, facts["frames"], facts["frames_missed"]) == (0, 24, 0)
    assert facts["centroid_largest"] < 0.3
    status, out, _ = run(capsys, "see", "f.avi", "--mission", mission, "--json", "--out", "s.nc")
    answer = json.loads(out)
    assert (status, answer["frames"], answer["frames_whole"], answer["partial"]) == (
        0,
        24,
        24,
        None,
    )
    flight, seen = xr.load_dataset("f.nc"), xr.load_dataset("s.nc")
    assert (seen.pixel.values == flight.pixel_found.values).all()  # AVI loses nothing
    off = (seen.pixel - flight.pixel_true.values).mean("point")
    assert np.linalg.norm(off, axis=1).max() < 0.3
    held = flight.centroid_held.interp(time=seen.time + 0.06, method="nearest")  # 40 ms late
    assert np.abs(seen.feature.values[:-3] - held.values[:-3]).max() < 0.2
    there = flight.position.interp(time=seen.time).values
    assert np.abs(seen.camera_position.values - there).max() < 0.1
    assert answer["law"] == flight.attrs["law"]


@pytest.mark.slow
@pytest.mark.skipif(find_compiler() is None, reason="no C compiler here")
def test_the_exported_c_flies_on_images_as_on_ideal_points(mission, capsys):
    flights = []
    for options in (FLY, [option for option in FLY if option != "--pixels"]):
        own = ("--duration", 0.4, "--controller", "firmware", "--out", "f.nc")
        status, out, _ = run(capsys, *options, *own)
        assert status == 0
        flights.append(json.loads(out))
    assert "firmware" in flights[0]["machine"] and "on images" in flights[0]["machine"]
    assert 0 < np.linalg.norm(np.subtract(*(f["final_position"] for f in flights))) < 1e-4


@pytest.mark.whole
def test_a_flight_on_images_keeps_to_what_is_proved_of_its_noise(mission, capsys):
    larger = "[400, 0, 319.5, 0, 400, 239.5, 0, 0, 1]"
    told = INFO.replace("[150, 0, 160, 0, 150, 120, 0, 0, 1]", larger)
    told = told.replace("320", "640").replace("240", "480")
    Path("info.yaml").write_text(told, encoding="utf-8")
    noisy = ("--set", "uncertainty.noise.feature=0.03")
    _, out, _ = run(capsys, "attraction", mission, "--no-figure", "--json", *noisy)
    proved = json.loads(out)
    end = proved["settling_time"] + 5
    status, out, _ = run(capsys, *FLY, "--duration", end, "--out", "f.nc", *noisy)
    flown = json.loads(out)
    assert (proved["verdict"], status, flown["images"]["frames_missed"]) == ("proved", 0, 0)
    assert flown["images"]["feature_largest"] < 0.03  # so the theorem is about it
    flight = xr.load_dataset("f.nc")
    away = np.linalg.norm(flight.position - flight.attrs["goal_position"], axis=1)
    assert away[flight.time >= proved["settling_time"]].max() < proved["settling_radius"]
    assert away[-1] < proved["ultimate_radius"]


def test_late_images_are_late_by_jitter(mission, capsys):
    flights = []
    for jitter in (0, 0.05):
        run(capsys, *FLY, "--duration", 0.6, "--jitter", jitter, "--out", "f.nc")
        flights.append(xr.load_dataset("f.nc"))
    changes = [np.abs(f.centroid_held.diff("time")).sum("body_axis") > 1e-3 for f in flights]
    assert changes[1].sum() < changes[0].sum()  # some wait for one before them
    assert (flights[0].pixel_found[0] == flights[1].pixel_found[0]).all()


def test_a_flight_does_not_begin_without_a_tag_in_its_first_image(mission, capsys):
    status, out, _ = run(capsys, *FLY, "--duration", 0.2, "--light", 0)
    answer = json.loads(out)
    assert status == 1
    assert answer["outcome"] == "ended before 0.01 s: a target point left the field of view"
    assert answer["images"]["frames_missed"] == answer["images"]["frames"]


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--jitter", 0.1), "--jitter: is for --pixels"),
        (("--pixels", "--runs", 3), "is for a single flight"),
        (("--pixels", "--light", 3), "--light: must be from 0 to 1.15, not 3"),
        (("--pixels", "--exposure", 3), "--exposure: must be from 0 to 1 s, not 3"),
        (("--pixels", "--film", "f.txt"), "f.txt: must end in .avi or .mkv or .mp4"),
        (("--pixels", "--tag", "36h11:0:0.2"), "have sides of 0.3 m, the tag 0.2 m"),
        (("--pixels", "--family", "36h11"), "--family: goes with --target"),
    ],
)
def test_what_images_are_not_taken_with_is_refused(mission, options, reason, capsys):
    assert reason in refusal(capsys, "simulate", mission, *options)


def test_images_need_a_lens(capsys):
    assert "camera.lens: is missing: images have pixels" in refusal(
        capsys, "simulate", "x4-flyer", "--pixels"
    )


def test_a_still_film_tells_its_noise_in_lines_for_a_mission(film, capsys):
    status, out, _ = run(capsys, "see", film, *CAMERA, *TAG, "--out", "seen.csv")
    assert status == 0
    assert "all of it found         in 24 of 24" in out
    assert "[sensors] pixel_noise = 0.0" in out
    with Path("seen.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 24
    assert float(rows[-1]["time"]) == pytest.approx(23 / 30)
    assert float(rows[0]["camera_position_z"]) == pytest.approx(-0.5, abs=2e-3)
    assert {"pixel_4_v", "centroid_x", "scaled_centroid_z", "angle"} <= rows[0].keys()
    assert all(len(line) <= 80 for line in out.splitlines())


def test_an_image_is_shown_with_what_was_found_in_it(picture, capsys):
    from PIL import Image

    status, out, _ = run(capsys, "see", picture, *CAMERA, *TAG, "--overlay", "o.png")
    assert status == 0
    assert "with what was found     o.png" in out
    plain, shown = (np.array(Image.open(f).convert("RGB"), int) for f in ("tag.png", "o.png"))
    assert 50 < (np.abs(shown - plain).max(axis=2) > 40).sum() < 5000
    assert Path("tag.seen.nc").exists()


def test_a_folder_is_read_in_the_order_of_its_numbers(picture, capsys):
    Path("many").mkdir()
    for k in (1, 2, 10):
        Path(f"many/{k}.png").write_bytes(Path(picture).read_bytes())
    Path("many/notes.txt").write_text("no image")
    options = ("--rate", 10, "--overlay", "o.avi", "--json", "--out", "s.csv")
    status, out, _ = run(capsys, "see", "many", *CAMERA, *TAG, *options)
    assert (status, json.loads(out)["frames"]) == (0, 3)
    assert Path("o.avi").stat().st_size > 1000


def test_images_without_the_tag_are_told_with_status_1_and_what_is_in_them(picture, capsys):
    asked = ("see", picture, *CAMERA, "--tag", "36h11:5:0.2")
    status, out, _ = run(capsys, *asked)
    assert status == 1
    assert "all of it found         in 0 of 1" in out
    assert "other tags seen         36h11:0 in 1" in out
    _, out, _ = run(capsys, *asked, "--json")
    assert json.loads(out)["others"] == {"36h11:0": 1}
    _, out, _ = run(capsys, "see", picture, *CAMERA, *TAG, "--json")
    assert json.loads(out)["others"] == {}


def test_a_film_that_was_cut_off_is_called_partial(film, capsys):
    whole = Path(film).read_bytes()
    Path(film).write_bytes(whole[: len(whole) // 2])
    status, out, _ = run(capsys, "see", film, *CAMERA, *TAG)
    assert status == 1
    assert "film.avi: partial: ends after " in out
    status, out, _ = run(capsys, "see", film, *CAMERA, *TAG, "--json")
    assert json.loads(out)["partial"].endswith("of 24 frames")
    with xr.open_dataset("film.seen.nc") as seen:
        assert seen.attrs["partial"]


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("none.png", None, "no such image, folder or video"),
        ("empty.mp4", b"", "is empty"),
        ("text.mp4", b"no film at all" * 99, "is damaged, or no image or video"),
        ("text.png", b"no image at all", "is damaged, or no image"),
        ("half.png", "half", "is damaged, or no image"),
        ("folder", "folder", "holds no images"),
        ("999", None, "no camera of this number can be opened"),
    ],
)
def test_what_is_no_image_is_one_line(picture, name, content, reason, capsys):
    if content == "half":
        whole = Path(picture).read_bytes()
        Path(name).write_bytes(whole[: len(whole) // 2])
    elif content == "folder":
        Path(name).mkdir()
    elif content is not None:
        Path(name).write_bytes(content)
    assert reason in refusal(capsys, "see", name, *CAMERA, *TAG)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (TAG, "--camera: is needed"),
        (CAMERA, "--tag: is needed"),
        ((*TAG, "--camera", "none.yaml"), "none.yaml: no such file"),
        ((*TAG, "--camera", "tag.png"), "tag.png: is not valid YAML"),
        ((*TAG, *CAMERA, "--out", "s.txt"), "s.txt: must end in .nc or .csv"),
        ((*TAG, *CAMERA, "--still", "3"), "--still: must be FROM,TO in s"),
        ((*TAG, *CAMERA, "--still", "0,1"), "--still: has 1 frames"),
        ((*TAG, *CAMERA, "--overlay", "o.gif"), "o.gif: must end in"),
        ((*TAG, *CAMERA, "--rate", "0"), "--rate: must be above 0"),
        ((*TAG, *CAMERA, "--set", "name=a"), "--set: goes with --mission"),
        ((*TAG, *CAMERA, "--target", "b.yaml"), "--tag: does not go with --target"),
    ],
)
def test_what_see_cannot_use_is_one_line(picture, options, reason, capsys):
    assert reason in refusal(capsys, "see", picture, *options)
    assert not list(Path().glob("*seen*"))


def test_images_of_another_size_than_the_calibration_are_refused(picture, capsys):
    Path("info.yaml").write_text(INFO.replace("width: 320", "width: 640"), encoding="utf-8")
    reason = "has images of 320 x 240 px, the calibration is for 640 x 240 px"
    assert reason in refusal(capsys, "see", picture, *CAMERA, *TAG)


def test_a_stream_is_lines_that_a_flight_takes_one_an_image(film, tmp_path, capsys):
    before = time.time()
    lines = run(capsys, "see", film, *CAMERA, *TAG, "--stream", "--late", 0.05, "--duration", 0.1)
    status, out, err = lines
    assert (status, out.count("\n"), err) == (0, 3, "")
    assert sorted(p.name for p in Path().iterdir()) == ["film.avi", "info.yaml"]  # none written
    for line in out.splitlines():
        seen = sighting_of(json.loads(line), 4, 10.0, time.time())
        assert seen.in_pixels
        assert before - 0.05 <= json.loads(line)["time"] <= time.time() - 0.05
        assert np.ptp(seen.seen, axis=0) == pytest.approx(60, abs=6)  # 0.2 m, 0.5 m below


def test_an_image_without_its_tag_is_a_line_without_pixels(picture, capsys):
    told = ("--camera", "info.yaml", "--tag", "36h11:5:0.2")  # another tag
    status, out, _ = run(capsys, "see", picture, *told, "--stream")
    assert (status, json.loads(out)["pixels"]) == (0, [])


def test_what_does_not_go_with_a_stream_is_refused(picture, capsys):
    told = ("see", picture, *CAMERA, *TAG)
    assert "--out: does not go with --stream" in refusal(
        capsys, *told, "--stream", "--out", "s.csv"
    )
    assert "--late: goes with --stream" in refusal(capsys, *told, "--late", 0.02)
    assert "--late: must be from 0 to 1 s, not 3" in refusal(capsys, *told, "--stream", "--late", 3)
