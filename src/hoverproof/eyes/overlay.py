"""Images with what was found in them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoverproof.eyes.detector import Image
from hoverproof.eyes.opencv import opencv
from hoverproof.mission.tags import Board

Array = NDArray[np.float64]

EDGE, TOP, MIDDLE = (60, 200, 60), (40, 90, 240), (240, 160, 40)
"""Blue, green and red of edges, of the upper edge as printed, and of the centroid."""
FINE = 4
"""Pixels are divided by 2**FINE to draw in."""


def drawn(image: Image, pixels: Array, board: Board, axis: tuple[float, float]) -> Image:
    """Return an image with the tags that were found, and the middle of their corners.

    Parameters
    ----------
    image : (height, width) uint8
        Grey levels.
    pixels : (n, 2)
        Target points, px; not a number of what was not found.
    board : Board
    axis : (float, float)
        Pixel of the optical axis, numbers of px.
    """
    cv2 = opencv()
    picture = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    corners = np.full((4 * len(board.numbers), 2), np.nan)
    corners[board.order] = pixels
    thick = max(1, round(image.shape[0] / 400))

    def at(point: Array) -> tuple[int, int]:
        x, y = (round(float(c) * 2**FINE) for c in point)
        return x, y

    smooth = {"lineType": cv2.LINE_AA, "shift": FINE}
    cv2.drawMarker(picture, tuple(round(c) for c in axis), MIDDLE, cv2.MARKER_CROSS, 12, thick)
    for number, quad in zip(board.numbers, corners.reshape(-1, 4, 2), strict=True):
        if np.isnan(quad).any():
            continue
        for k in range(4):
            colour = TOP if k == 0 else EDGE
            cv2.line(picture, at(quad[k]), at(quad[(k + 1) % 4]), colour, 2 * thick, **smooth)
        cv2.circle(picture, at(quad[0]), 3 * thick << FINE, TOP, -1, **smooth)
        if len(board.numbers) <= 12:
            _write(picture, f"{board.family}:{number}", quad.max(axis=0) + 8 * thick, thick)
    whole = not np.isnan(pixels).any()
    if whole:
        cv2.circle(picture, at(pixels.mean(axis=0)), 4 * thick << FINE, MIDDLE, -1, **smooth)
    found = len({i // 4 for i in np.flatnonzero(~np.isnan(corners).any(axis=1))})
    told = "" if whole else f"{found} of {len(board.numbers)} tags found"
    _write(picture, told, np.array([8.0, image.shape[0] - 10.0]), thick)
    return np.asarray(picture)


def _write(picture: Image, text: str, place: Array, thick: int) -> None:
    cv2 = opencv()
    x, y = (round(float(c)) for c in place)
    for colour, wide in (((0, 0, 0), 3 * thick), (TOP, thick)):  # to be read on light and dark
        style = cv2.FONT_HERSHEY_SIMPLEX, 0.5 * thick, colour, wide, cv2.LINE_AA
        cv2.putText(picture, text, (x, y), *style)
