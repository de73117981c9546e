"""The camera as it is built and mounted, and what it is sure to see."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from hoverproof.mission.fields import Section, array, one_of, quantity, reject, shown

COEFFICIENTS = {"plumb_bob": "k1, k2, p1, p2, k3", "equidistant": "k1, k2, k3, k4"}
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


def _several(value: object) -> object:
    """Take any list for a tuple of its entries."""
    if not isinstance(value, list | tuple):
        raise reject(f"must be a list of numbers, not {shown(value)}")
    return tuple(value)


def number_of(model: str) -> int:
    """Return how many coefficients a model of distortion has.

    Parameters
    ----------
    model : str
        One of `COEFFICIENTS`.
    """
    return len(COEFFICIENTS[model].split())


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
    distortion: Annotated[tuple[_Coefficient, ...], BeforeValidator(_several)] = ()

    @model_validator(mode="after")
    def _hangs_together(self) -> Self:
        names, count = COEFFICIENTS[self.distortion_model], len(self.distortion)
        if count > number_of(self.distortion_model):
            raise reject(
                f"has at most the numbers [{names}] for {self.distortion_model!r}, not {count}",
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
    def axis_seen(self) -> str:
        """About which axis a proof bounds the angle under which points are seen, in words."""
        return "z axis of the body" if self.tilt else "optical axis"

    @property
    def about_vertical(self) -> Fraction | None:
        """The half angle of a cone about the z axis of the body that is in the one said, rad.

        Not positive where the camera leans by more; None if none is said.
        """
        return None if self.half_angle is None else self.half_angle - self.tilt

    def covers(self) -> list[str]:
        """Return in words how far it is from the centre of mass, and what it is sure to see."""
        if self.half_angle is None:
            return self.beside()
        seen = f"points seen within {shown(self.half_angle)} rad of the optical axis"
        return [*self.beside(), seen]

    def beside(self) -> list[str]:
        """Return in words how far it is from the centre of mass, if it is not there."""
        return [f"a camera {self.arm:.3g} m from the centre of mass"] if self.has_arm else []

    def told(self) -> dict[str, Any]:
        """Return what is not as by default, by key, as values of pydantic."""
        return self.model_dump(exclude_none=True, exclude_defaults=True)
