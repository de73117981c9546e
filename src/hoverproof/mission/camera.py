"""The camera as it is built and mounted, and what it is sure to see."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from hoverproof.mission.fields import Section, array, one_of, quantity, reject, shown

COEFFICIENTS = {
    "plumb_bob": ("k1", "k2", "p1", "p2", "k3"),
    "equidistant": ("k1", "k2", "k3", "k4"),
}
"""The names of the coefficients of each model of distortion, in the order of ROS and OpenCV."""

_ZERO = Fraction(0)
_HalfAngle = Annotated[Fraction, quantity("rad", "0", "1.5707", open_low=True)]
_Angle = Annotated[Fraction, quantity("rad", "-3.1416", "3.1416")]
_Length = Annotated[Fraction, quantity("m", "-100", "100")]
_Pixels = Annotated[Fraction, quantity("px", "-1e6", "1e6")]
_PositivePixels = Annotated[Fraction, quantity("px", "0", "1e6", open_low=True)]
_Coefficient = Annotated[Fraction, quantity("", "-1e3", "1e3")]
_Place = Annotated[tuple[_Length, _Length, _Length], BeforeValidator(array("x", "y", "z"))]
_Euler = Annotated[tuple[_Angle, _Angle, _Angle], BeforeValidator(array("roll", "pitch", "yaw"))]
Model = Literal["plumb_bob", "equidistant"]


class Lens(Section):
    """How the camera makes pixels of directions, as calibrated.

    Attributes
    ----------
    width, height : px
        Of the image.
    fx, fy, cx, cy : px
        Focal lengths and the pixel of the optical axis; u grows to the right, v downward.
    distortion_model : "plumb_bob" or "equidistant"
        As ROS and OpenCV have them: the first by radial and tangential terms of X/Z and Y/Z, the
        second, of a fisheye, by a polynomial of the angle from the axis.
    distortion : numbers
        k1, k2, p1, p2, k3, or k1 to k4; those left out at the end are 0.
    """

    width: _PositivePixels
    height: _PositivePixels
    fx: _PositivePixels
    fy: _PositivePixels
    cx: _Pixels
    cy: _Pixels
    distortion_model: Annotated[Model, one_of(*COEFFICIENTS)] = "plumb_bob"
    distortion: Annotated[list[_Coefficient], Field(max_length=5, default_factory=list)]

    @model_validator(mode="after")
    def _hangs_together(self) -> Self:
        names = COEFFICIENTS[self.distortion_model]
        if len(self.distortion) > len(names):
            raise reject(
                f"has at most {len(names)} numbers for {self.distortion_model!r}, "
                f"[{', '.join(names)}], not {len(self.distortion)}",
                key="distortion",
            )
        for key, size in (("cx", self.width), ("cy", self.height)):
            at = getattr(self, key)
            if not 0 < at < size:
                raise reject(
                    f"must be within the image, from 0 to {shown(size)} px, not {shown(at)}: "
                    "a camera that does not see along its axis is not covered",
                    key=key,
                )
        return self


class Camera(Section):
    """How the camera is mounted, what its pixels are, and what it is sure to see.

    Attributes
    ----------
    half_angle : rad
        Of the cone about the optical axis in which every point is seen; by default not said.
    position : m
        Of the camera from the centre of mass, body axes: x forward, y right, z down.
    rotation : rad
        Roll, pitch, yaw of its axes in those of the body, R = Rz(yaw) Ry(pitch) Rx(roll), camera to
        body. Its z axis looks out of the lens, x is to the right in the image and y down; where all
        is 0 it looks straight down, the right of the image to the front of the vehicle.
    lens : Lens, optional
        By default what the camera delivers is undistorted, in focal lengths.
    file : str, optional
        Of a `camera_info`, relative to the mission file: the lens, read in its place.
    """

    half_angle: _HalfAngle | None = None
    position: _Place = (_ZERO, _ZERO, _ZERO)
    rotation: _Euler = (_ZERO, _ZERO, _ZERO)
    lens: Lens | None = None
    file: Annotated[str | None, Field(exclude=True)] = None

    @model_validator(mode="after")
    def _is_read(self) -> Self:
        if self.file is not None:  # `load` has put the lens in its place
            raise reject("is read in a mission file alone; give the lens", key="file")
        return self

    @property
    def has_arm(self) -> bool:
        """Whether it is not at the centre of mass."""
        return any(self.position)

    @property
    def arm(self) -> float:
        """How far it is from the centre of mass, m."""
        return math.hypot(*map(float, self.position))

    @property
    def is_mounted(self) -> bool:
        """Whether it is anywhere else than at the centre of mass, its axes those of the body."""
        return self.has_arm or any(self.rotation)

    @property
    def tilt(self) -> Fraction:
        """Bound of the angle from the z axis of the body to the optical axis, rad."""
        roll, pitch, _ = self.rotation
        return abs(roll) + abs(pitch)

    @property
    def about_vertical(self) -> Fraction | None:
        """The half angle of a cone about the z axis of the body that is in the one said, rad.

        Not positive where the camera leans by more; None if none is said.
        """
        return None if self.half_angle is None else self.half_angle - self.tilt

    def covers(self) -> list[str]:
        """Return what is sure to be seen in words, if it is said."""
        if self.half_angle is None:
            return []
        return [f"points seen within {shown(self.half_angle)} rad of the optical axis"]

    def told(self) -> dict[str, Any]:
        """Return what is not as by default, by key, as values of pydantic."""
        return self.model_dump(exclude_none=True, exclude_defaults=True)
