"""What the sensors of a simulated vehicle tell: camera, gyro, accelerometer and compass."""

from __future__ import annotations

from typing import Any

import casadi as ca

from hoverproof.plant import camera, rigid_body
from hoverproof.plant.lens import sight_of
from hoverproof.plant.rigid_body import RigidBodyState
from hoverproof.servo.law import Law
from hoverproof.servo.variables import Design, Measurement
from hoverproof.simulation.gyro import held_still, in_body
from hoverproof.simulation.surroundings import (
    Features,
    FurtherSurroundings,
    HeadedSurroundings,
    Surroundings,
)

IMU_NOISE = 9
"""Numbers that a tick draws for gyro, velocity and gravity; see `imu_noise`."""


def look(
    memory: dict[str, ca.SX],
    around: Surroundings,
    points: ca.SX,
    noise: ca.SX,
    law: Law,
    features: Features,
) -> tuple[ca.SX, ca.SX]:
    """Return what a frame tells, (3, 1), and a margin above 0 if all points are in it.

    That is the feature and, where the image tells the heading, the x axis of the world below it,
    (6, 1). With a gyro that turns what is held, they are in the axes of the attitude added up.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `Features.layout`.
    around : Surroundings
    points : SX
        (3, n), world frame, m.
    noise : SX
        (2 n, 1), standard normal, point by point; with three more of the gravity direction where
        the image tells the heading.
    law : Law
    features : Features
    """
    seen = around.seen(RigidBodyState.from_vector(memory["state"]), points, law)
    image = camera.pinhole(seen)
    count, lens = 2 * points.shape[1], features.lens
    image, inside = around.projected(image, lens)
    margin = ca.fmin(inside, ca.mmin(seen[2, :]))
    image = image + around.image_noise * ca.reshape(noise[:count], 2, points.shape[1])
    if features.rounded:
        image = ca.floor(image / around.image_resolution + 0.5) * around.image_resolution
    return understood(memory, around, points, image, noise[count:], law, features), margin


def understood(
    memory: dict[str, ca.SX],
    around: Surroundings,
    points: ca.SX,
    image: ca.SX,
    noise: ca.SX,
    law: Law,
    features: Features,
) -> ca.SX:
    """Return what is told by what is read of an image, (3, 1) or (6, 1): see `look`.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `Features.layout`.
    around : Surroundings
    points : SX
        (3, n), world frame, m.
    image : SX
        (2, n), px through a lens, else in focal lengths.
    noise : SX
        (3, 1), standard normal, of the gravity direction where the image tells the heading.
    law : Law
    features : Features
    """
    lens = features.lens
    if lens is not None and (sight := sight_of(lens)) is not None:
        image = ca.horzcat(*(lens.undistorted(p, sight.steps) for p in ca.horzsplit(image)))
    directions = law.mount.in_body(camera.spherical(image))
    told = [law.look(directions)]
    if law.sees_north:
        down = gravity_read(RigidBodyState.from_vector(memory["state"]), around, noise)
        told.append(camera.north(directions, down, points))
    if "attitude" in memory:
        told = [held_still(memory["attitude"], vector) for vector in told]
    return ca.vertcat(*told)


def gravity_read(body: RigidBodyState, around: Surroundings, noise: ca.SX) -> ca.SX:
    """Return ρ as it is measured, (3, 1), body frame, a unit vector.

    Parameters
    ----------
    body : RigidBodyState
    around : Surroundings
    noise : SX
        (3, 1), standard normal.
    """
    down = body.gravity_direction + around.gravity_bias + around.gravity_noise * noise
    return down / ca.norm_2(down)


def used(memory: dict[str, ca.SX]) -> ca.SX:
    """Return the feature that the controller uses, (3, 1), body frame, dimensionless.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `Features.layout`.
    """
    return now_in_body(memory, "held")


def now_in_body(memory: dict[str, ca.SX], name: str) -> ca.SX:
    """Return a vector that is held from a frame, (3, 1), body frame, in its own unit.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `Features.layout`.
    name : str
        Its name there.
    """
    held = memory[name]
    return in_body(memory["attitude"], held) if "attitude" in memory else held


def felt(memory: dict[str, ca.SX], around: FurtherSurroundings, noise: ca.SX) -> ca.SX:
    """Return the reading of the accelerometer, (3, 1), body frame, m/s².

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `Features.layout`.
    around : FurtherSurroundings
    noise : SX
        (3, 1), standard normal.
    """
    now = memory.get("accelerometer")
    if now is None:
        now = around.specific_force(RigidBodyState.from_vector(memory["state"]), memory["gust"])
    return now + around.accelerometer_bias + around.accelerometer_noise * noise


def headed(body: RigidBodyState, around: HeadedSurroundings, noise: ca.SX) -> ca.SX:
    """Return what a compass tells, (cos ψ, sin ψ), (2, 1).

    Parameters
    ----------
    body : RigidBodyState
    around : HeadedSurroundings
    noise : SX
        (1, 1), standard normal.
    """
    told = rigid_body.heading(body.rotation)
    error = around.heading_bias + around.heading_noise * noise
    turned = told + error * ca.vertcat(-told[1], told[0])
    return turned / ca.norm_2(turned)


def imu_noise(law: Law) -> int:
    """Return how many numbers a tick draws: an accelerometer takes three more, a compass one.

    Parameters
    ----------
    law : Law
    """
    return IMU_NOISE + 3 * (law.force.sensed is not None) + law.has_compass


def read(
    memory: dict[str, ca.SX], design: Design, around: Any, noise: ca.SX, law: Law
) -> Measurement:
    """Return what the sensors tell the controller at a tick.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `Features.layout`.
    design : Design
    around : Surroundings
        Those that `Features.surroundings` says.
    noise : SX
        (k, 1), standard normal, k = `imu_noise`: gyro, velocity, gravity, accelerometer, compass.
    law : Law
    """
    body = RigidBodyState.from_vector(memory["state"])
    measured = Measurement(
        centroid=used(memory),
        velocity=body.velocity + around.velocity_bias + around.velocity_noise * noise[3:6],
        gravity_direction=gravity_read(body, around, noise[6:9]),
        rate=body.rate + around.gyro_bias + around.gyro_noise * noise[0:3],
        thrust=memory["command"],
    )
    force = felt(memory, around, noise[IMU_NOISE : IMU_NOISE + 3]) if law.force.sensed else None
    heading = headed(body, around, noise[-1]) if law.has_compass else None
    if law.sees_north:
        north = now_in_body(memory, "north")
        heading = rigid_body.heading_of_north(north, measured.gravity_direction)
    known: Measurement = law.known(measured, design, force, heading)
    return known
