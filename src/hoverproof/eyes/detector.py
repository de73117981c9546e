"""Find the tags of a board in an image, their corners to a fraction of a pixel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.eyes.opencv import dictionary, half_turns, opencv
from hoverproof.mission.tags import Board
from hoverproof.plant.lens import LensModel, Sight

Array = NDArray[np.float64]
Image = NDArray[np.uint8]


PROFILES, SHARE = 16, 0.8
"""Along each side of a tag its edge is looked for at so many places, over that share of it."""
STEP = 0.25
"""px: so far apart an image is read across an edge."""
WIDEST = 3.0
"""px to each side, at most, and at most `WITHIN` of the width of a bit."""
WITHIN = 0.55
PASSES = 3
APART = 0.02
"""Of their outline: squares so far apart are two, as a tag and the white margin around it are."""


@dataclass(frozen=True, eq=False)
class Detector:
    """Finds the tags of a board.

    Attributes
    ----------
    board : Board
    lens : LensModel
    sight : Sight
        How far its image reaches.
    """

    board: Board
    lens: LensModel
    sight: Sight

    @cached_property
    def _opencv(self) -> Any:
        cv2 = opencv()
        parameters = cv2.aruco.DetectorParameters()
        parameters.markerBorderBits = self.board.border
        parameters.minMarkerDistanceRate = APART
        return cv2.aruco.ArucoDetector(dictionary(self.board), parameters)

    @cached_property
    def _straight(self) -> ca.Function:
        """(2, 1) px ↦ (2, 1) (X/Z, Y/Z)."""
        pixel = ca.SX.sym("pixel", 2)
        point = self.lens.undistorted(pixel, self.sight.steps)
        return ca.Function("straight", [pixel], [point])

    @cached_property
    def _bent(self) -> ca.Function:
        """(2, 1) (X/Z, Y/Z) ↦ (2, 1) px."""
        point = ca.SX.sym("point", 2)
        return ca.Function("bent", [point], [self.lens.pixel(point)])

    def corners(self, image: Image) -> Array:
        """Return the corners of each tag of the board; see `found`.

        Parameters
        ----------
        image : (height, width) uint8
            Grey levels.
        """
        return self.found(image)[0]

    def found(self, image: Image) -> tuple[Array, list[int]]:
        """Return the corners of each tag, (m, 4, 2), px, and which others of its family there are.

        Corners are not a number where the tag is not found.

        Pixel (0, 0) is the middle of the first pixel, as in OpenCV and ROS. The corners are in the
        order of the board: as the tag is printed, whichever way it is seen.

        Parameters
        ----------
        image : (height, width) uint8
            Grey levels.
        """
        found, numbers, _ = self._opencv.detectMarkers(image)
        corners = np.full((len(self.board.numbers), 4, 2), np.nan)
        turn, others = 2 * half_turns(self.board.family), []
        for quad, number in zip(found, [] if numbers is None else np.ravel(numbers), strict=True):
            if number in self.board.numbers:
                place = self.board.numbers.index(int(number))
                corners[place] = np.roll(quad.reshape(4, 2), turn, axis=0)
            else:
                others.append(int(number))
        seen = np.flatnonzero(~np.isnan(corners).any(axis=(1, 2)))
        if len(seen):
            for _ in range(PASSES):
                corners[seen] = self._between_edges(image, corners[seen])
        return corners, sorted(set(others))

    def _between_edges(self, image: Image, corners: Array) -> Array:
        """Return where straight edges of the tags meet, (k, 4, 2), px: a blurred corner is round.

        Across an edge the grey levels go from i₋ to i₊ within r to both sides; if they are alike on
        both sides of it, it is at (r (i₊ + i₋) - ∫ i)/(i₊ - i₋).

        Parameters
        ----------
        image : (height, width) uint8
        corners : (k, 4, 2)
            Near, px.
        """
        rays = _each(self._straight, corners)
        along = (1 + SHARE * np.linspace(-1, 1, PROFILES)) / 2
        between = (np.roll(rays, -1, axis=1) - rays)[:, :, None]
        places = _each(self._bent, rays[:, :, None] + along[:, None] * between)
        lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=-1, keepdims=True)
        ahead = np.gradient(places, axis=2)
        outward = np.stack([ahead[..., 1], -ahead[..., 0]], axis=-1)
        outward /= np.linalg.norm(outward, axis=-1, keepdims=True)
        reach = np.minimum(WIDEST, WITHIN * lengths / self._bits)[..., None]
        samples = np.linspace(-1, 1, 1 + 2 * round(WIDEST / STEP))
        at = places[..., None, :] + reach[..., None] * samples[:, None] * outward[..., None, :]
        flat = at.reshape(len(corners) * 4, -1, 2).astype(np.float32)
        read = opencv().remap(image.astype(np.float32), flat, None, 1)
        grey = read.reshape(at.shape[:-1]).astype(float)
        inner, outer = (grey[..., end].mean(axis=-1, keepdims=True) for end in (0, -1))
        mean = (grey.sum(axis=-1) - (grey[..., 0] + grey[..., -1]) / 2) / (len(samples) - 1)
        contrast = np.maximum(outer - inner, 1.0)
        edge = reach[..., 0] * np.clip((outer + inner - 2 * mean) / contrast, -1, 1)
        pixels = places + edge[..., None] * outward
        points = _each(self._straight, pixels)
        middle = points.mean(axis=2)
        spread = points - middle[:, :, None]
        _, _, axes = np.linalg.svd(spread)
        normal = axes[..., 1, :]
        offset = (normal * middle).sum(axis=-1)
        lines = np.stack([np.roll(normal, 1, axis=1), normal], axis=-2)
        offsets = np.stack([np.roll(offset, 1, axis=1), offset], axis=-1)
        meet = _each(self._bent, np.linalg.solve(lines, offsets[..., None])[..., 0])
        near = np.linalg.norm(meet - corners, axis=-1, keepdims=True) < 2 * WIDEST
        return np.where(near, meet, corners)

    @cached_property
    def _bits(self) -> int:
        """Number of bits along a tag, with its border."""
        return int(dictionary(self.board).markerSize) + 2 * self.board.border


def _each(function: ca.Function, pairs: Array) -> Array:
    flat = pairs.reshape(-1, 2)
    mapped = function.map(len(flat))(flat.T)
    return np.asarray(mapped.full()).T.reshape(pairs.shape)
