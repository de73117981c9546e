"""How fast images are drawn and searched, and how well corners are found, beside OpenCV's own.

Run ``python benchmarks/eyes.py``; ``--write`` puts the tables into the README beside it. Frames are
of 640 x 480 px through a lens, on one processor, counted in its time.
"""

from __future__ import annotations

import time

import numpy as np

from hoverproof.eyes.detector import Detector
from hoverproof.eyes.opencv import dictionary, half_turns, opencv
from hoverproof.eyes.renderer import Image, Pose, Renderer
from hoverproof.mission.tags import Board, board_of_tag
from hoverproof.plant.lens import LensModel, sight_of
from hoverproof.plant.rigid_body import rotation_matrix
from tables import report

BARREL = (-0.28, 0.07, 5e-4, -3e-4, 0.01)
LENS = LensModel(640, 480, 400, 410, 330, 236, "plumb_bob", BARREL)
FRAMES = 150
HEIGHTS = {"far, 2 m above a tag of 0.2 m": 2.0, "as it flies, 1 m": 1.0, "near, 0.4 m": 0.4}
OWN = "edges and where they meet (hoverproof)"
PEERS = {
    "OpenCV, `CORNER_REFINE_SUBPIX`": "CORNER_REFINE_SUBPIX",
    "OpenCV, `CORNER_REFINE_CONTOUR`": "CORNER_REFINE_CONTOUR",
    "OpenCV, none": "CORNER_REFINE_NONE",
}


def poses(height: float) -> list[Pose]:
    """Return flights over the tag: leaning, turning, moving."""
    draw = np.random.default_rng(1)
    return [
        Pose(
            np.array([*draw.uniform(-0.1, 0.1, 2) * height, -height]),
            rotation_matrix(*draw.uniform(-0.15, 0.15, 2), draw.uniform(-3, 3)),
            draw.uniform(-0.4, 0.4, 3),
            draw.uniform(-0.5, 0.5, 3),
        )
        for _ in range(FRAMES)
    ]


def peer(board: Board, refinement: str, image: Image) -> np.ndarray:
    """Return the corners of OpenCV itself, (4, 2), px."""
    cv2 = opencv()
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = getattr(cv2.aruco, refinement)
    found, _, _ = cv2.aruco.ArucoDetector(dictionary(board), parameters).detectMarkers(image)
    turn = 2 * half_turns(board.family)
    return np.roll(found[0].reshape(4, 2), turn, axis=0) if found else np.full((4, 2), np.nan)


def main() -> None:
    """Draw, search, compare."""
    opencv().setNumThreads(1)
    board, sight = board_of_tag("36h11:0:0.2"), sight_of(LENS)
    drawing, detector = Renderer(board, LENS, sight), Detector(board, LENS, sight)
    speed = [
        "| tag | drawn, frames a second | searched, frames a second |",
        "| --- | ---: | ---: |",
    ]
    errors: dict[str, list[np.ndarray]] = {name: [] for name in (OWN, *PEERS)}
    drawing.image(poses(1.0)[0])
    for name, height in HEIGHTS.items():
        begin = time.process_time()
        images = [drawing.image(pose, k) for k, pose in enumerate(poses(height))]
        drawn = time.process_time()
        found = [detector.corners(image)[0] for image in images]
        searched = time.process_time()
        rates = FRAMES / (drawn - begin), FRAMES / (searched - drawn)
        speed.append(f"| {name} | {rates[0]:.0f} | {rates[1]:.0f} |")
        for pose, image, own in zip(poses(height), images, found, strict=True):
            true = drawing.pixels(pose)[0]
            errors[OWN].append(own - true)
            for words, refinement in PEERS.items():
                errors[words].append(peer(board, refinement, image) - true)
    lines = ["| corners | root mean square, px | centroid, most, px | missed |"]
    lines.append("| --- | ---: | ---: | ---: |")
    for words, each in errors.items():
        whole = np.array([e for e in each if not np.isnan(e).any()])
        size = np.sqrt((whole**2).sum(axis=2).mean())
        middle = np.linalg.norm(whole.mean(axis=1), axis=1).max()
        lines.append(f"| {words} | {size:.3f} | {middle:.2f} | {len(each) - len(whole)} |")
    report("eyes", "\n".join([*speed, "", *lines]))


if __name__ == "__main__":
    main()
