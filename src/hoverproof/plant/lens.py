"""What a lens makes of directions, and back: pixels, with the distortions of ROS and OpenCV.

All is made of + - * / and square roots alone, so that it is computed alike, bit for bit, wherever
it is flown. Backward there is no formula; Newton's method finds the point whose pixel it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.mission.camera import Lens, number_of
from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]

MOST_STEPS = 12
"""Of Newton's method: a lens that takes more is not one that is used for flight."""
ENOUGH = 1e-12
"""In focal lengths: what is left of the distance at the last step, in floating point."""
BEHIND = 1e-9
"""In focal lengths: so near to the axis a point has no direction from it."""
ON_AN_EDGE = 1024
"""Into how many parts the edges of the image are divided, to find how far it reaches."""


@dataclass(frozen=True)
class LensModel:
    """A lens as numbers: pixels from points (X/Z, Y/Z), and back.

    Attributes
    ----------
    width, height, fx, fy, cx, cy : float
        Of the image, focal lengths and the pixel of the axis: numbers of px.
    model : str
        As in `hoverproof.mission.camera.COEFFICIENTS`.
    coefficients : tuple of float
        In their order there, bare numbers.
    """

    width: float
    height: float
    fx: float
    fy: float
    cx: float
    cy: float
    model: str
    coefficients: tuple[float, ...]

    @classmethod
    def of(cls, mission: Mission) -> LensModel | None:
        """Return the lens of a mission, if it has one.

        Parameters
        ----------
        mission : Mission
        """
        return None if mission.camera.lens is None else cls.of_section(mission.camera.lens)

    @classmethod
    def of_section(cls, lens: Lens) -> LensModel:
        """Return the lens of a section `[camera.lens]`.

        Parameters
        ----------
        lens : Lens
        """
        missing = number_of(lens.distortion_model) - len(lens.distortion)
        coefficients = (*map(float, lens.distortion), *[0.0] * missing)
        names = ("width", "height", "fx", "fy", "cx", "cy")
        sides = {name: float(getattr(lens, name)) for name in names}
        return cls(**sides, model=lens.distortion_model, coefficients=coefficients)

    def pixel(self, point: ca.SX) -> ca.SX:
        """Return the pixel of a point, (2, 1), px.

        Parameters
        ----------
        point : SX
            (X/Z, Y/Z), (2, 1).
        """
        x, y = ca.vertsplit(self._distorted(point))
        return ca.vertcat(self.fx * x + self.cx, self.fy * y + self.cy)

    def ray(self, pixel: ca.SX) -> ca.SX:
        """Return a pixel in focal lengths from that of the axis, (2, 1): still distorted.

        Parameters
        ----------
        pixel : SX
            (2, 1), px.
        """
        return ca.vertcat((pixel[0] - self.cx) / self.fx, (pixel[1] - self.cy) / self.fy)

    def begin(self, ray: ca.SX) -> ca.SX:
        """Return where Newton's method begins, (k, 1): the point, or its angle in rad of a fisheye.

        Parameters
        ----------
        ray : SX
            Of `ray`, (2, 1).
        """
        return _length(ray) if self.model == "equidistant" else ray

    def better(self, found: ca.SX, ray: ca.SX) -> ca.SX:
        """Return what a step of Newton's method makes of what is found, (k, 1), in its unit.

        Parameters
        ----------
        found : SX
            (k, 1); see `begin`.
        ray : SX
            Of `ray`, (2, 1).
        """
        symbol = ca.SX.sym("found", found.shape[0])
        missed = self._missed(symbol, ray)
        slope = ca.jacobian(missed, symbol)
        if symbol.shape[0] == 1:
            step = missed / slope
        else:
            (a, b), (c, d) = (ca.horzsplit(row) for row in ca.vertsplit(slope))
            over = 1 / (a * d - b * c)
            step = over * ca.vertcat(d * missed[0] - b * missed[1], a * missed[1] - c * missed[0])
        return ca.substitute(symbol - step, symbol, found)

    def point(self, found: ca.SX, ray: ca.SX) -> ca.SX:
        """Return the point (X/Z, Y/Z) of what is found, (2, 1).

        Parameters
        ----------
        found : SX
            (k, 1); see `begin`.
        ray : SX
            Of `ray`, (2, 1).
        """
        if self.model != "equidistant":
            return found
        return ray * (_tangent_over(found) / self._stretch(found))

    def left(self, found: ca.SX, ray: ca.SX) -> ca.SX:
        """Return the square of the distance from the ray to what is found, (1, 1), distorted.

        Parameters
        ----------
        found : SX
            (k, 1); see `begin`.
        ray : SX
            Of `ray`, (2, 1).
        """
        return ca.sumsqr(self._missed(found, ray))

    def undistorted(self, pixel: ca.SX, steps: int) -> ca.SX:
        """Return the point (X/Z, Y/Z) of a pixel, (2, 1), after so many steps.

        Parameters
        ----------
        pixel : SX
            (2, 1), px.
        steps : int
            A bare number.
        """
        ray = self.ray(pixel)
        found = self.begin(ray)
        for _ in range(steps):
            found = self.better(found, ray)
        return self.point(found, ray)

    def _distorted(self, point: ca.SX) -> ca.SX:
        if self.model == "equidistant":
            radius = _length(point)
            angle = _arctangent(radius)
            return point * (angle * self._stretch(angle) / ca.fmax(radius, BEHIND))
        k1, k2, p1, p2, k3 = self.coefficients
        x, y = ca.vertsplit(point)
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return ca.vertcat(
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        )

    def _stretch(self, angle: ca.SX) -> ca.SX:
        """Return the distance from the axis over the angle of a fisheye, (1, 1), 1/rad."""
        k1, k2, k3, k4 = self.coefficients
        square = angle * angle
        return 1 + square * (k1 + square * (k2 + square * (k3 + square * k4)))

    def _missed(self, found: ca.SX, ray: ca.SX) -> ca.SX:
        if self.model == "equidistant":
            return found * self._stretch(found) - _length(ray)
        return self._distorted(found) - ray


@dataclass(frozen=True)
class Sight:
    """How far an image reaches.

    Attributes
    ----------
    steps : int
        Of Newton's method, enough for each pixel.
    reach : float
        The farthest point from the axis, in focal lengths, dimensionless.
    edge : (3, m) array
        Unit vectors toward points along the edge of the image, around it; camera frame.
    """

    steps: int
    reach: float
    edge: Array

    def half_angle(self, axis: Array) -> float:
        """Return the half angle of the largest cone about an axis that is in the image, rad.

        Less than what the nearest two points along the edge allow in between; 0 if the axis is
        outside. In floating point.

        Parameters
        ----------
        axis : (3,)
            Unit vector, camera frame.
        """
        angles = np.arctan2(np.linalg.norm(np.cross(self.edge.T, axis), axis=1), axis @ self.edge)
        after = np.roll(self.edge, -1, axis=1)
        apart = np.linalg.norm(after - self.edge, axis=0) * 1.01  # an arc, a little bent
        least = float(np.min((angles + np.roll(angles, -1) - apart) / 2))
        turns = np.cross(self.edge.T, after.T) @ axis
        return max(least, 0.0) if (turns > 0).all() and axis[2] > 0 else 0.0


@cache
def sight_of(lens: LensModel) -> Sight | None:
    """Return how far the image of a lens reaches; None if a pixel has no one direction.

    The edge and a grid within are looked at, in floating point: Newton's method must come to a
    point from each, and the distortion must not fold the image over up to there.

    Parameters
    ----------
    lens : LensModel
    """
    grid = _edge(lens.width, lens.height)
    inside = np.linspace(0, 1, 33)
    u, v = np.meshgrid(inside * lens.width, inside * lens.height)
    pixels = np.hstack([grid, np.array([u.ravel(), v.ravel()])])
    pixel, found, ray = ca.SX.sym("pixel", 2), ca.SX.sym("found", 2), ca.SX.sym("ray", 2)
    if lens.model == "equidistant":
        found = ca.SX.sym("found", 1)
    slope = ca.det(ca.jacobian(lens._missed(found, ray), found))
    rays = np.array(ca.Function("ray", [pixel], [lens.ray(pixel)]).map(pixels.shape[1])(pixels))
    count = rays.shape[1]
    here = np.array(ca.Function("begin", [ray], [lens.begin(ray)]).map(count)(rays))
    better = ca.Function("better", [found, ray], [lens.better(found, ray)]).map(count)
    left = ca.Function("left", [found, ray], [lens.left(found, ray), slope]).map(count)
    steps = 0
    gap, upright = map(np.array, left(here, rays))
    while steps < MOST_STEPS and not (gap < ENOUGH**2).all():
        here, steps = np.array(better(here, rays)), steps + 1
        gap, upright = map(np.array, left(here, rays))
    folded = not ((gap < ENOUGH**2).all() and (upright > 0).all() and _rises(lens, here))
    if folded or not np.isfinite(here).all():
        return None
    points = np.array(
        ca.Function("point", [found, ray], [lens.point(found, ray)]).map(count)(here, rays)
    )
    edge = np.vstack([points[:, : grid.shape[1]], np.ones(grid.shape[1])])
    reach = float(np.linalg.norm(points, axis=0).max())
    return Sight(max(steps, 1), reach, edge / np.linalg.norm(edge, axis=0))


def _rises(lens: LensModel, found: Array) -> bool:
    """Tell whether the distance from the axis grows with the angle as far as there is an image."""
    far = np.linspace(0, 1, 257)[1:] * np.linalg.norm(found, axis=0).max()
    if lens.model == "equidistant":
        if far[-1] > np.radians(80):  # beyond it X/Z and Y/Z are no measure of a direction
            return False
        powers = [1.0, *lens.coefficients]
    else:
        powers = [1.0, lens.coefficients[0], lens.coefficients[1], lens.coefficients[4]]
    slopes = sum((2 * i + 1) * c * far ** (2 * i) for i, c in enumerate(powers))
    return bool(np.all(slopes > 0))


def seeing_lens(mission: Mission) -> tuple[LensModel, Sight] | None:
    """Return the lens of a mission and how far it sees, if it has one.

    Parameters
    ----------
    mission : Mission

    Raises
    ------
    InputError
        If a pixel of the image has no one direction.
    """
    lens = LensModel.of(mission)
    return None if lens is None else seeing(lens, mission.source, "camera.lens.distortion")


def seeing(lens: LensModel, where: str, key: str) -> tuple[LensModel, Sight]:
    """Return a lens and how far it sees.

    Parameters
    ----------
    lens : LensModel
    where, key : str
        Of its distortion, for the message.

    Raises
    ------
    InputError
        If a pixel of the image has no one direction.
    """
    sight = sight_of(lens)
    if sight is None:
        reason = (
            "leaves pixels of the image without a direction of their own: the model folds over "
            "within it, or sees beyond 80 degrees from the axis; crop the image or calibrate again"
        )
        raise InputError(where, key, reason)
    return lens, sight


def cone_in_image(mission: Mission) -> float | None:
    """Return the half angle of the largest cone about the optical axis that is in the image, rad.

    None where the mission tells no lens. Rounded down, to four digits after the point.

    Parameters
    ----------
    mission : Mission

    Raises
    ------
    InputError
        If a pixel of the image has no one direction.
    """
    seeing = seeing_lens(mission)
    if seeing is None:
        return None
    return math.floor(1e4 * seeing[1].half_angle(np.array([0.0, 0.0, 1.0]))) / 1e4


def check_cone(mission: Mission) -> None:
    """Refuse a half angle that reaches beyond the image, where the lens is told.

    Parameters
    ----------
    mission : Mission

    Raises
    ------
    InputError
        If it does, or a pixel of the image has no one direction.
    """
    largest, half = cone_in_image(mission), mission.camera.half_angle
    if largest is not None and half is not None and half > largest:
        reason = (
            f"reaches beyond the image: the largest cone about the optical axis within it has "
            f"{largest:g} rad, not {float(half):g}"
        )
        raise InputError(mission.source, "camera.half_angle", reason)


def _edge(width: float, height: float) -> Array:
    part = np.linspace(0, 1, ON_AN_EDGE, endpoint=False)
    none, whole = np.zeros_like(part), np.ones_like(part)
    u = np.concatenate([part, whole, 1 - part, none]) * width
    v = np.concatenate([none, part, whole, 1 - part]) * height
    return np.array([u, v])


def _length(a: ca.SX) -> ca.SX:
    return ca.sqrt(ca.sumsqr(a))


def _arctangent(x: ca.SX) -> ca.SX:
    """Return the angle of a tangent that is not negative, rad, to rounding: halved thrice first."""
    for _ in range(3):
        x = x / (1 + ca.sqrt(1 + x * x))
    square, total = x * x, ca.SX(0)
    for k in reversed(range(11)):
        total = ca.SX(1) / (2 * k + 1) - square * total
    return 8 * x * total


def _tangent_over(angle: ca.SX) -> ca.SX:
    """Return tan θ/θ by Lambert's fraction, to rounding for θ up to 80 degrees."""
    square, below = angle * angle, ca.SX(21)
    for k in reversed(range(10)):
        below = (2 * k + 1) - square / below
    return 1 / below
