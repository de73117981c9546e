"""Images of printed tags as a camera takes them: perspective, lens, blur, light and noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline

from hoverproof.eyes.opencv import bits, opencv
from hoverproof.mission.tags import Board
from hoverproof.plant.lens import LensModel, Sight, sight_of

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

FINER = 2
"""So many samples are taken along each side of a pixel."""
COARSE = 8
"""px: rays are found so far apart by the formula of the lens, and by splines between."""
CELLS = (1, 2, 4, 8, 16, 32, 64)
"""Texels along the side of a bit, of the textures that a tag is drawn from."""
MARGIN = 1
"""Bits of white around a tag."""
NEAREST = 0.02
"""m: a tag with a corner that is not farther before the camera is not drawn."""
MOST_POSES = 8
ALONG, AROUND = 9, 4
"""Points along the edge of a tag that are looked at to find the part of the image it is in, and px
around that."""


@dataclass(frozen=True)
class Shot:
    """How an image is taken.

    Attributes
    ----------
    exposure : float
        s, its middle at the time of the frame.
    focus_blur : float
        Standard deviation of the spot that a point makes, a number of px.
    grey_noise : float
        Standard deviation of each pixel, a number of grey levels of 255.
    light : float
        Grey levels over those of an image that is well lit, dimensionless.
    black, white, floor : float
        Grey levels of ink, paper and the floor around, well lit, numbers up to 255.
    """

    exposure: float = 0.004
    focus_blur: float = 0.6
    grey_noise: float = 2.0
    light: float = 1.0
    black: float = 25.0
    white: float = 215.0
    floor: float = 150.0


@dataclass(frozen=True)
class Pose:
    """Where a camera is and how it moves.

    Attributes
    ----------
    position : (3,) array
        World frame, m.
    rotation : (3, 3) array
        Camera to world.
    velocity : (3,) array
        World frame, m/s.
    rate : (3,) array
        Camera axes, rad/s.
    """

    position: Array
    rotation: Array
    velocity: Array
    rate: Array

    def after(self, time: float) -> Pose:
        """Return the pose a short time later, turned at a steady rate.

        Parameters
        ----------
        time : float
            s; negative for before.
        """
        turn, _ = opencv().Rodrigues(self.rate * time)
        return Pose(
            self.position + time * self.velocity, self.rotation @ turn, self.velocity, self.rate
        )

    def points(self, points: Array) -> Array:
        """Return points of the world in the axes of the camera, (..., 3), m.

        Parameters
        ----------
        points : (..., 3)
            World frame, m.
        """
        seen: Array = (points - self.position) @ self.rotation
        return seen


@lru_cache(maxsize=4)
def sampled_rays(lens: LensModel) -> NDArray[np.float32]:
    """Return (X/Z, Y/Z) of each sample of an image, (FINER height, FINER width, 2).

    Parameters
    ----------
    lens : LensModel
        Each pixel of which has a direction.
    """
    sight = sight_of(lens)
    assert sight is not None
    u, v = (np.arange(-COARSE, s + 2 * COARSE, COARSE) for s in (lens.width, lens.height))
    at = np.array([part.ravel() for part in np.meshgrid(u, v)], float)
    pixel = ca.SX.sym("pixel", 2)
    ray = ca.Function("ray", [pixel], [lens.undistorted(pixel, sight.steps)])
    found = np.asarray(ray.map(at.shape[1])(at).full()).reshape(2, len(v), len(u))
    within = (np.arange(FINER) + 0.5) / FINER - 0.5
    sizes = round(lens.height), round(lens.width)
    fine = [(np.arange(size)[:, None] + within).ravel() for size in sizes]
    sides = [RectBivariateSpline(v, u, side)(*fine) for side in found]
    return np.stack(sides, axis=-1).astype(np.float32)


@dataclass(frozen=True, eq=False)
class Renderer:
    """Draws the tags of a board as a camera sees them.

    Attributes
    ----------
    board : Board
    lens : LensModel
    sight : Sight
        How far its image reaches.
    shot : Shot
    seed : int
        Of the noise, a bare number.
    """

    board: Board
    lens: LensModel
    sight: Sight
    shot: Shot = Shot()
    seed: int = 0

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the image, px."""
        return round(self.lens.width), round(self.lens.height)

    @cached_property
    def textures(self) -> list[list[NDArray[np.float32]]]:
        """Each tag with its white margin, in grey levels, by the size of a bit in texels."""
        black, white = self.shot.light * self.shot.black, self.shot.light * self.shot.white
        drawn = []
        for number in self.board.numbers:
            tag = np.pad(bits(self.board, number), MARGIN, constant_values=255)
            grey = np.where(tag > 0, white, black).astype(np.float32)
            drawn.append([np.kron(grey, np.ones((c, c), np.float32)) for c in CELLS])
        return drawn

    @cached_property
    def _project(self) -> ca.Function:
        """(2, 1) (X/Z, Y/Z) ↦ (2, 1) px."""
        point = ca.SX.sym("point", 2)
        return ca.Function("project", [point], [self.lens.pixel(point)])

    def _projected(self, points: Array) -> Array:
        """Return the pixels of points (X/Z, Y/Z), (k, 2) both, those far outside moved nearer."""
        far = np.linalg.norm(points, axis=1, keepdims=True) / (1.05 * self.sight.reach)
        near = points / np.maximum(far, 1)
        return np.array(self._project.map(len(points))(near.T)).T

    def pixels(self, pose: Pose) -> Array:
        """Return where the corners of the tags are in the image, (m, 4, 2), px.

        Parameters
        ----------
        pose : Pose
        """
        seen = pose.points(self.board.corners.reshape(-1, 3))
        return self._projected(seen[:, :2] / seen[:, 2:]).reshape(-1, 4, 2)

    @cached_property
    def _noise(self) -> NDArray[np.float32]:
        """Normal numbers, of which a frame takes a part from anywhere on."""
        width, height = self.size
        drawn = np.random.default_rng(self.seed).standard_normal(3 * width * height, np.float32)
        return self.shot.grey_noise * drawn

    def image(self, pose: Pose, number: int = 0) -> Image:
        """Return the image of a camera, (height, width), grey levels.

        Parameters
        ----------
        pose : Pose
            In the middle of the exposure.
        number : int
            Of the frame, a bare number: what its noise is drawn by.
        """
        width, height = self.size
        shot, cv2 = self.shot, opencv()
        picture = np.full((height, width), shot.light * shot.floor, np.float32)
        poses = [pose.after(shot.exposure * part) for part in self._parts(pose)]
        quads = [self._quads(each) for each in poses]
        box = self._box([*quads[0].values(), *quads[-1].values()])
        if box is not None:
            left, top, right, bottom = box
            total = self._sampled(quads[0], box)
            for each in quads[1:]:
                cv2.accumulate(self._sampled(each, box), total)
            inside = cv2.resize(
                total / len(quads), (right - left, bottom - top), interpolation=cv2.INTER_AREA
            )
            if shot.focus_blur:
                inside = cv2.GaussianBlur(inside, (0, 0), shot.focus_blur)
            picture[top:bottom, left:right] = inside
        if shot.grey_noise:
            first = int(np.random.default_rng((self.seed, number)).integers(2 * width * height))
            picture += self._noise[first : first + width * height].reshape(height, width)
        return np.asarray(cv2.convertScaleAbs(cv2.max(picture, 0)))

    def _parts(self, pose: Pose) -> Array:
        """Return at which parts of the exposure the camera is looked through."""
        half = self.shot.exposure / 2
        if not half:
            return np.zeros(1)
        ends = [self.pixels(pose.after(time)) for time in (-half, half)]
        most = float(np.nan_to_num(np.linalg.norm(ends[1] - ends[0], axis=-1)).max())
        count = min(MOST_POSES, max(1, math.ceil(most)))
        return (np.arange(count) + 0.5) / count - 0.5

    def _quads(self, pose: Pose) -> dict[int, Array]:
        """Return (X/Z, Y/Z) of the corners of each tag with its margin that can be seen, (4, 2)."""
        found = {}
        for i, corners in enumerate(self.board.corners):
            side = len(self.textures[i][0]) - 2 * MARGIN
            middle = corners.mean(axis=0)
            seen = pose.points(middle + (corners - middle) * (1 + 2 * MARGIN / side))
            if (seen[:, 2] > NEAREST).all():
                quad = seen[:, :2] / seen[:, 2:]
                (ax, ay), (bx, by) = quad[1] - quad[0], quad[3] - quad[0]
                if ax * by > ay * bx:  # else it is seen from behind
                    found[i] = quad
        return found

    def _box(self, quads: list[Array]) -> tuple[int, int, int, int] | None:
        """Return the part of the image that quads are in, px: left, top, right, bottom."""
        if not quads:
            return None
        along = np.linspace(0, 1, ALONG)[:, None, None]
        edges = [q + along * (np.roll(q, -1, axis=0) - q) for q in quads]
        at = self._projected(np.concatenate(edges).reshape(-1, 2))
        low, high = np.floor(at.min(axis=0)) - AROUND, np.ceil(at.max(axis=0)) + AROUND
        left, top = (int(max(0, edge)) for edge in low)
        right, bottom = (int(min(size, edge)) for edge, size in zip(high, self.size, strict=True))
        return (left, top, right, bottom) if left < right and top < bottom else None

    def _sampled(
        self, quads: dict[int, Array], box: tuple[int, int, int, int]
    ) -> NDArray[np.float32]:
        """Return the samples of a part of the image, in grey levels."""
        cv2 = opencv()
        left, top, right, bottom = (FINER * edge for edge in box)
        part = sampled_rays(self.lens)[top:bottom, left:right]
        grey = np.full(part.shape[:2], self.shot.light * self.shot.floor, np.float32)
        for i, quad in quads.items():
            seen = math.sqrt(abs(cv2.contourArea(quad.astype(np.float32))))
            bit = FINER * self.lens.fx * seen / len(self.textures[i][0])  # samples along one
            level = int(np.clip(math.ceil(math.log2(max(bit, 1))), 0, len(CELLS) - 1))
            texture = self.textures[i][level]
            side = float(len(texture))
            whole = np.array([[0, 0], [side, 0], [side, side], [0, side]]) - 0.5
            to_texture = cv2.getPerspectiveTransform(
                quad.astype(np.float32), whole.astype(np.float32)
            )
            at = cv2.perspectiveTransform(np.ascontiguousarray(part), to_texture)
            cv2.remap(
                texture, at, None, cv2.INTER_LINEAR, dst=grey, borderMode=cv2.BORDER_TRANSPARENT
            )
        return grey
