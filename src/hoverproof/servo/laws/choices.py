"""The choices of a law inside one error chain: feature, goal and force, two of each."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from hoverproof.plant import rigid_body
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.feature import Feature
from hoverproof.servo.law import Force, Goal
from hoverproof.servo.layout import column
from hoverproof.servo.variables import Design, Measurement


def _centroid(q: ca.SX, spread: ca.SX, n: float) -> ca.SX:
    return q


def _scaled(q: ca.SX, spread: ca.SX, n: float) -> ca.SX:
    """φ(a) q/a, φ(a) = 1/√(2(1 - a/n)), a = |q|, n - a = (n² - a²)/(n + a), n the whole weight."""
    a = ca.norm_2(q)
    return ca.sqrt(n * (n + a) / (2 * spread)) * q / a


CENTROID = Feature("centroid", _centroid)
"""q, the feature of the paper."""

SCALED = Feature("scaled", _scaled)
"""For a small target the position of the target over its size, as the image alone tells it."""


def _image_error(z: Measurement, d: Design) -> ca.SX:
    return z.centroid - d.goal_centroid


def _all_of_it(d: Design) -> ca.SX:
    return d.goal_centroid


def _inertial_error(z: Measurement, d: Design) -> ca.SX:
    return z.centroid - d.goal_centroid[2] * z.gravity_direction


def _none_of_it(d: Design) -> ca.SX:
    return ca.SX.zeros(3)


IMAGE = Goal("image", _image_error, _all_of_it)
"""Fixed in the image, as in the paper: δ1 = q - q*."""

INERTIAL = Goal("inertial", _inertial_error, _none_of_it)
"""Fixed to the vertical: δ1 = q - q3* ρ."""


def _modelled_force(z: Measurement, d: Design) -> ca.SX:
    return rigid_body.force(z.thrust, z.gravity_direction, d.mass, d.gravity)


def _commanded_thrust(z: Measurement, d: Design) -> ca.SX:
    return z.thrust


def _itself(z: Measurement, d: Design) -> Measurement:
    return z


def _nothing(z: Measurement, d: Design, thrust_rate: ca.SX) -> ca.SX:
    return ca.SX(0, 1)


@dataclass(frozen=True)
class WithAccelerometer(Measurement):
    """What an accelerometer measures, besides.

    Attributes
    ----------
    specific_force : SX
        a = V̇ + Ω × V - g ρ, (3, 1), body frame, m/s²: in hover (0, 0, -g).
    """

    specific_force: ca.SX = column("m/s²")


def _measured_force(z: WithAccelerometer, d: Design) -> ca.SX:
    """m (a + g ρ): V̇ = -Ω × V + F/m whatever mass, thrust and wind are."""
    return d.mass * (z.specific_force + d.gravity * z.gravity_direction)


def _measured_thrust(z: WithAccelerometer, d: Design) -> ca.SX:
    return -d.mass * z.specific_force[2]


def _with_accelerometer(z: Measurement, specific_force: ca.SX) -> WithAccelerometer:
    return WithAccelerometer(**vars(z), specific_force=specific_force)


def _with_ideal_accelerometer(z: Measurement, d: Design) -> WithAccelerometer:
    return _with_accelerometer(z, -z.thrust / d.mass * E3)


def _specific_force_rate(z: WithAccelerometer, d: Design, thrust_rate: ca.SX) -> ca.SX:
    """Return ȧ; what is not thrust in it is taken to be steady, fixed in the world."""
    others = z.specific_force - z.specific_force[2] * E3
    return -thrust_rate / d.mass * E3 - skew(z.rate) @ others


MODELLED = Force("modelled", _modelled_force, _commanded_thrust, Measurement, _itself, _nothing)
"""F = -T e₃ + m g ρ of the commanded thrust, as in the paper."""

MEASURED = Force(
    "measured",
    _measured_force,
    _measured_thrust,
    WithAccelerometer,
    _with_ideal_accelerometer,
    _specific_force_rate,
    _with_accelerometer,
)
"""F = m(a + g ρ) of an accelerometer: errors of mass, thrust and steady wind are in δ3."""
