"""What a proof is asked to cover: the tolerances of vehicle, wind and camera."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from hoverproof.mission.fields import Section, quantity, shown

TOLERANCES = (
    *("thrust", "torque", "latency", "rotor_lag", "wind", "yaw_rate"),
    *("control_period", "force_lag"),
)
"""Keys of `Uncertainty` that leave a vehicle at rest where it is: all but noise and gusts."""
_ZERO = Fraction(0)

LARGEST_SHARE = "0.999"
"""The largest tolerance of what is a share."""
_Share = Annotated[Fraction, quantity("(a share: 0.2 is 20 %)", "0", LARGEST_SHARE)]
_Time = Annotated[Fraction, quantity("s", "0", "1e3")]
_Acceleration = Annotated[Fraction, quantity("m/s²", "0", "1e3")]
_BodyRate = Annotated[Fraction, quantity("rad/s", "0", "1e3")]


class Noise(Section):
    """Bounds of what is measured less what is true, as the length of each vector.

    Attributes
    ----------
    feature : 1
        Of the image feature, q or scaled.
    velocity : m/s
        Body frame.
    force : N
        Of mass times what the accelerometer measures, for a law with `law.force = "measured"`.
    rate : rad/s
        Of the body rates.
    vertical : 1
        Of the direction of gravity in body axes; for a small one about the angle in rad.
    """

    feature: Annotated[Fraction, quantity("", "0", "1e3")] = _ZERO
    velocity: Annotated[Fraction, quantity("m/s", "0", "1e4")] = _ZERO
    force: Annotated[Fraction, quantity("N", "0", "1e9")] = _ZERO
    rate: _BodyRate = _ZERO
    vertical: Annotated[Fraction, quantity("rad", "0", "1")] = _ZERO


class Uncertainty(Section):
    """Tolerances: a proof about them holds for every vehicle and wind within all of them at once.

    Attributes
    ----------
    thrust : share
        The specific thrust changes by 1 - thrust to 1 + thrust times what is commanded: mass,
        rotors and battery together.
    torque : share
        Likewise each torque: inertia and rotors.
    latency : s
        Most time from the exposure of a frame to its use, the time to the next frame included.
        Whether the feature is turned meanwhile is `sensors.gyro_turned`: if not, it is used in
        the axes that the camera had then.
    rotor_lag : s
        The rotors follow their commands with a first-order lag of any time constant up to this.
    wind : m/s²
        Steady force of wind over mass, in any direction; below gravity.
    yaw_rate : rad/s
        Bound of |Ω3|.
    control_period : s
        Most time from one run of the controller to the next. Between them the torques are held,
        and the thrust goes on changing at the rate that was asked for. With rotors that lag.
    force_lag : s
        Time constant, at most, of a first-order low-pass of the accelerometer. Likewise.
    gust : m/s²
        Bound of the wind less the steady one, which may change at will, as force over mass.
    noise : Noise
        Bounds of the errors of what is measured.
    """

    thrust: _Share = _ZERO
    torque: _Share = _ZERO
    latency: _Time = _ZERO
    rotor_lag: _Time = _ZERO
    wind: _Acceleration = _ZERO
    yaw_rate: _BodyRate = _ZERO
    noise: Noise = Noise()
    gust: _Acceleration = _ZERO
    control_period: _Time = _ZERO
    force_lag: _Time = _ZERO

    @property
    def is_shaken(self) -> bool:
        """Whether something is in doubt that keeps a vehicle from coming to rest."""
        return bool(self.gust) or self.noise != Noise()

    @property
    def of_torques(self) -> str | None:
        """The first key in doubt by which another torque is made than the one that is meant."""
        asked = {"torque": self.torque, "rotor_lag": self.rotor_lag, "noise.rate": self.noise.rate}
        return next((key for key, value in asked.items() if value), None)

    @property
    def is_tolerant(self) -> bool:
        """Whether something is in doubt of the vehicles themselves: one of `TOLERANCES`."""
        return any(getattr(self, name) for name in TOLERANCES)

    @property
    def is_none(self) -> bool:
        """Whether all is as modelled: every tolerance is zero."""
        return self == Uncertainty()

    def covers(self) -> list[str]:
        """Return each tolerance that is not zero in words, with its unit."""
        noise = self.noise
        each = [
            (self.thrust, f"thrust ±{shown(100 * self.thrust)} %"),
            (self.torque, f"torque ±{shown(100 * self.torque)} %"),
            (self.latency, f"latency up to {shown(self.latency)} s"),
            (self.rotor_lag, f"rotor lag up to {shown(self.rotor_lag)} s"),
            (self.wind, f"steady wind up to {shown(self.wind)} m/s²"),
            (self.gust, f"gusts up to {shown(self.gust)} m/s²"),
            (self.yaw_rate, f"yaw rate up to {shown(self.yaw_rate)} rad/s"),
            (self.control_period, f"control period up to {shown(self.control_period)} s"),
            (self.force_lag, f"low-pass of the force up to {shown(self.force_lag)} s"),
            (noise.feature, f"noise of the feature up to {shown(noise.feature)}"),
            (noise.velocity, f"noise of the velocity up to {shown(noise.velocity)} m/s"),
            (noise.force, f"noise of the force up to {shown(noise.force)} N"),
            (noise.rate, f"noise of the body rates up to {shown(noise.rate)} rad/s"),
            (noise.vertical, f"noise of the vertical up to {shown(noise.vertical)} rad"),
        ]
        return [words for size, words in each if size]
