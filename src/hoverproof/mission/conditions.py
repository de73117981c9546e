"""What a real flight adds to the model: sensors, rotors, wind, errors of the model, scatter.

Each is off unless the mission file names it. None of it bears on a certificate, so none of it is
part of what `Mission.exact` returns.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, model_validator

from hoverproof.mission.fields import Section, array, one_of, quantity, reject, shown, true_or_false

Ends = tuple[Fraction | None, Fraction | None]
"""The lowest and the highest of something, without a limit where it is None."""
_ZERO = Fraction(0)
_ZEROS = (_ZERO, _ZERO, _ZERO)

_Rate = Annotated[Fraction, quantity("Hz", "0", "1e6", open_low=True)]
_Time = Annotated[Fraction, quantity("s", "0", "1e3")]
_PositiveTime = Annotated[Fraction, quantity("s", "0", "1e6", open_low=True)]
_Pixels = Annotated[Fraction, quantity("px", "0", "1e6")]
_PositivePixels = Annotated[Fraction, quantity("px", "0", "1e6", open_low=True)]
_BodyRate = Annotated[Fraction, quantity("rad/s", "0", "1e3")]
_Acceleration = Annotated[Fraction, quantity("m/s²", "0", "1e3")]
_Speed = Annotated[Fraction, quantity("m/s", "0", "1e4")]
_SignedSpeed = Annotated[Fraction, quantity("m/s", "-1e4", "1e4")]
_SmallAngle = Annotated[Fraction, quantity("rad", "0", "1")]
_Tilt = Annotated[Fraction, quantity("rad", "-1", "1")]
_Angle = Annotated[Fraction, quantity("rad", "0", "3.1416")]
_Length = Annotated[Fraction, quantity("m", "0", "1e6")]
_Force = Annotated[Fraction, quantity("N", "0", "1e9")]
_Drag = Annotated[Fraction, quantity("kg/s", "0", "1e6")]
_Relative = Annotated[Fraction, quantity("(a share: 0.05 is 5 %)", "-0.9", "10")]
_Share = Annotated[Fraction, quantity("(a share: 0.05 is 5 %)", "0", "0.5")]


def _several(value: object) -> object:
    """Accept a list, of whatever length: the mission knows how many rotors there are."""
    if not isinstance(value, list | tuple):
        raise reject(f"must be a list, one share for each rotor, not {shown(value)}")
    return tuple(value)


_Wind = Annotated[
    tuple[_SignedSpeed, _SignedSpeed, _SignedSpeed], BeforeValidator(array("x", "y", "z"))
]
_Tilts = Annotated[tuple[_Tilt, _Tilt, _Tilt], BeforeValidator(array("roll", "pitch", "yaw"))]
_Relatives = Annotated[
    tuple[_Relative, _Relative, _Relative], BeforeValidator(array("I1", "I2", "I3"))
]
_OfRotors = Annotated[tuple[_Relative, ...], BeforeValidator(_several)]
_Lengths = Annotated[tuple[_Length, _Length, _Length], BeforeValidator(array("x", "y", "z"))]
_Speeds = Annotated[tuple[_Speed, _Speed, _Speed], BeforeValidator(array("v1", "v2", "v3"))]
_Angles = Annotated[tuple[_Angle, _Angle, _Angle], BeforeValidator(array("roll", "pitch", "yaw"))]
_BodyRates = Annotated[
    tuple[_BodyRate, _BodyRate, _BodyRate], BeforeValidator(array("p", "q", "r"))
]
_Shares = Annotated[tuple[_Share, _Share, _Share], BeforeValidator(array("I1", "I2", "I3"))]


class Sensors(Section):
    """What the controller knows, and when; noise is the standard deviation of each reading.

    Biases are standard deviations too: each run draws one and keeps it.

    Attributes
    ----------
    control_rate : Hz
        The controller runs so often and holds its output between; by default at each step.
    frame_rate : Hz
        Of the camera; by default at each step. The last frame that has arrived is held.
    latency : s
        From the frame to its arrival at the controller.
    focal_length : px
        Of the camera; where `[camera.lens]` tells it, this and the next are left out.
    width, height : px
        Of the image, with the optical axis in its middle; by default without an edge.
    pixel_noise : px
        On each image coordinate of a point.
    pixel_resolution : px
        Image coordinates are rounded to multiples of it; 0 does not round.
    out_of_view : "hold" or "abort"
        When a point leaves the image: go on with the last whole frame, or end the flight.
    gyro_noise, gyro_bias : rad/s
        Of each body rate.
    velocity_noise, velocity_bias : m/s
        Of each component of the velocity, body frame.
    gravity_noise, gravity_bias : rad
        Of the direction of gravity that an attitude filter makes of the accelerometer.
    accelerometer_noise, accelerometer_bias : m/s²
        Of each component of the specific force, for a law that measures the force (`law.force`).
    accelerometer_time_constant : s
        Of its first-order low-pass, before the noise; 0 is none.
    heading_noise, heading_bias : rad
        Of the yaw that a compass tells, for a mission with a heading (`goal.heading`) from one.
    gyro_turned : true or false
        Whether the controller turns the feature it holds with the gyro, from when the frame was
        taken, so that late and rare frames tell old positions and no old attitudes. The gyro is
        read for that at each step of the flight.
    """

    control_rate: _Rate | None = None
    frame_rate: _Rate | None = None
    latency: _Time = _ZERO
    focal_length: _PositivePixels | None = None
    width: _PositivePixels | None = None
    height: _PositivePixels | None = None
    pixel_noise: _Pixels = _ZERO
    pixel_resolution: _Pixels = _ZERO
    out_of_view: Annotated[Literal["hold", "abort"], one_of("hold", "abort")] = "hold"
    gyro_noise: _BodyRate = _ZERO
    gyro_bias: _BodyRate = _ZERO
    velocity_noise: _Speed = _ZERO
    velocity_bias: _Speed = _ZERO
    gravity_noise: _SmallAngle = _ZERO
    gravity_bias: _SmallAngle = _ZERO
    accelerometer_noise: _Acceleration = _ZERO
    accelerometer_bias: _Acceleration = _ZERO
    accelerometer_time_constant: _Time = _ZERO
    heading_noise: _SmallAngle = _ZERO
    heading_bias: _SmallAngle = _ZERO
    gyro_turned: Annotated[bool, true_or_false()] = False

    @model_validator(mode="after")
    def _has_both_sides(self) -> Self:
        if (self.width is None) != (self.height is None):
            raise reject("give both width and height (px) or neither")
        return self


class Rotors(Section):
    """What the rotors make of their commands.

    Attributes
    ----------
    time_constant : s
        Of the first-order lag of each rotor's thrust.
    min_thrust, max_thrust : N
        Of what each rotor is asked for; by default without limits.
    """

    time_constant: _Time = _ZERO
    min_thrust: _Force | None = None
    max_thrust: _Force | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        low, high = self.min_thrust, self.max_thrust
        if low is not None and high is not None and low >= high:
            raise reject(f"must be below max_thrust, {shown(high)} N", key="min_thrust")
        return self

    def of_each(self, own: tuple[Ends, ...], count: int) -> tuple[Ends, ...]:
        """Return the lowest and the highest thrust of each rotor, N.

        Parameters
        ----------
        own : tuple of (low, high)
            What rotors have of their own, N; may be empty.
        count : int
            Number of rotors.
        """
        low, high = self.min_thrust, self.max_thrust
        return tuple(
            (low if least is None else least, high if most is None else most)
            for least, most in own or ((None, None),) * count
        )


def common_limits(limits: tuple[Ends, ...]) -> Ends:
    """Return the thrusts that every rotor can make, N.

    Parameters
    ----------
    limits : tuple of (low, high)
        Of each, N.
    """
    lows, highs = ([end for end in ends if end is not None] for ends in zip(*limits, strict=True))
    return max(lows, default=None), min(highs, default=None)


def out_of_order(limits: tuple[Ends, ...]) -> int | None:
    """Return the place of a rotor whose lowest thrust is not below its highest, if there is one.

    Parameters
    ----------
    limits : tuple of (low, high)
        Of each, N.
    """
    wrong = (i for i, (a, b) in enumerate(limits) if a is not None and b is not None and a >= b)
    return next(wrong, None)


class Wind(Section):
    """Moving air, which drags the vehicle along: F = drag (wind - velocity).

    Attributes
    ----------
    mean : m/s
        World frame, z down.
    gust : m/s
        Standard deviation of each component of a first-order Gauss-Markov process around the mean.
    gust_time : s
        Its correlation time.
    drag : kg/s
        Drag force over air speed, the same in all directions. In still air it brakes.
    """

    mean: _Wind = _ZEROS
    gust: _Speed = _ZERO
    gust_time: _PositiveTime = Fraction(1)
    drag: _Drag = _ZERO

    @model_validator(mode="after")
    def _moves_something(self) -> Self:
        if (any(self.mean) or self.gust) and not self.drag:
            raise reject("is missing; wind without drag (kg/s) moves nothing", key="drag")
        return self


class ModelError(Section):
    """What the vehicle is, against what the controller was told.

    Attributes
    ----------
    mass : share
        True mass over that of the mission, less 1.
    inertia : shares
        The same for each principal moment.
    camera_tilt : rad
        Roll, pitch and yaw of the camera in the body.
    thrust : share
        True thrust of each rotor over what it is asked for, less 1.
    rotors : shares
        The same of single rotors, in the order of the vehicle, beside that of all.
    arm : share
        True arm of the rotors over that of the mission, less 1.
    """

    mass: _Relative = _ZERO
    inertia: _Relatives = _ZEROS
    camera_tilt: _Tilts = _ZEROS
    thrust: _Relative = _ZERO
    rotors: _OfRotors = ()
    arm: _Relative = _ZERO


class Scatter(Section):
    """How runs differ: each number is drawn around that of the mission.

    Attributes
    ----------
    distribution : "uniform" or "normal"
        The numbers below are half-widths or standard deviations.
    position : m
        World frame.
    velocity : m/s
        Body frame.
    rotation : rad
        Roll, pitch, yaw.
    rates : rad/s
        Body frame.
    mass, inertia : shares
        Of the true vehicle; the controller keeps the mission's.
    camera_tilt : rad
        Roll, pitch and yaw of the camera in the body.
    thrust, arm : shares
        Of the true rotors, all four alike.
    """

    distribution: Annotated[Literal["uniform", "normal"], one_of("uniform", "normal")] = "uniform"
    position: _Lengths = _ZEROS
    velocity: _Speeds = _ZEROS
    rotation: _Angles = _ZEROS
    rates: _BodyRates = _ZEROS
    mass: _Share = _ZERO
    inertia: _Shares = _ZEROS
    camera_tilt: _Angles = _ZEROS
    thrust: _Share = _ZERO
    arm: _Share = _ZERO

    @property
    def of_the_vehicle(self) -> bool:
        """Whether vehicles differ, and not their starts alone."""
        single = (self.mass, self.thrust, self.arm)
        return any((*single, *self.inertia, *self.camera_tilt))
