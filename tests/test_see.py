"""`see` and `simulate --pixels`, as a user meets them: films of known flights, and bad files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hoverproof import cli
from hoverproof.eyes.renderer import Pose, Renderer
from hoverproof.eyes.video import video
from hoverproof.mission.presets import preset_text
from hoverproof.mission.tags import board_of_tag
from hoverproof.plant.lens import LensModel, sight_of

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


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as exit_:
        cli.main([str(a) for a in arguments])
    captured = capsys.readouterr()
    return exit_.value.code, captured.out, captured.err


def refusal(capsys, *arguments):
    status, out, err = run(capsys, *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    return err


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
    """A mission that flies above its tag, fast, with a small image."""
    text = preset_text("crazyflie-2.1")
    text = "\n".join(line for line in text.splitlines() if not line.startswith("half_angle"))
    text = text.replace("\n[camera]\n", "\n") if "\n[camera]\n" in text else text
    Path("info.yaml").write_text(INFO, encoding="utf-8")
    Path("m.toml").write_text(text + '\n[camera]\nfile = "info.yaml"\n', encoding="utf-8")
    return "m.toml"
