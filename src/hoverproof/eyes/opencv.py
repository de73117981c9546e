"""OpenCV, which is installed on request, and the markers that it knows."""

from __future__ import annotations

import os
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError, needing
from hoverproof.mission.tags import FAMILIES, Board

PUBLISHED = (1, 1, 0, 1, 0, 1)
"""The uppermost bits of tag 0 of 36h11, from the left, as its inventors print it; white is 1."""


@cache
def opencv() -> Any:
    """Return the module cv2, which says nothing by itself.

    Raises
    ------
    InputError
        If it is not installed.
    """
    os.environ.setdefault("OPENCV_LOG_LEVEL", "SILENT")
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    with needing("vision", "OpenCV", "is missing, which finds tags in images"):
        import cv2
    return cv2


def dictionary(board: Board) -> Any:
    """Return OpenCV's dictionary of the tags of a board.

    Parameters
    ----------
    board : Board

    Raises
    ------
    InputError
        If it has no tag of a number.
    """
    cv2 = opencv()
    name = f"DICT_{FAMILIES[board.family]}"
    if not hasattr(cv2.aruco, name):
        raise InputError("--tag", "", f"OpenCV {cv2.__version__} does not know {board.family}")
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))
    count = len(known.bytesList)
    for number in board.numbers:
        if not 0 <= number < count:
            raise InputError("--tag", "", f"{board.family} has tags 0 to {count - 1}, not {number}")
    return known


def bits(board: Board, number: int) -> NDArray[np.uint8]:
    """Return a tag as it is printed, (k, k), 255 where it is white, with its black border.

    Parameters
    ----------
    board : Board
    number : int
        Of the tag, a bare number.
    """
    known = dictionary(board)
    side = known.markerSize + 2 * board.border
    drawn = opencv().aruco.generateImageMarker(known, number, side, borderBits=board.border)
    return np.rot90(drawn, half_turns(board.family) * 2)


def half_turns(family: str) -> int:
    """Return by how many half turns OpenCV has the tags of a family the other way up, 0 or 1.

    Before a release of version 5 it has AprilTags upside down.

    Parameters
    ----------
    family : str
    """
    return _upside_down() if FAMILIES[family].startswith("APRILTAG") else 0


@cache
def _upside_down() -> int:
    cv2 = opencv()
    known = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    drawn = cv2.aruco.generateImageMarker(known, 0, 8)
    return int(tuple(drawn[1, 1:-1] // 255) != PUBLISHED)
