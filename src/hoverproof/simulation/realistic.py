"""The closed loop as on a vehicle: a camera with frames, a controller with ticks, rotors, wind.

Three graphs of the same model functions as the paper's loop, which the driver calls when they are
due: ``frame`` (what the camera sees), ``control`` (what the controller makes of it and holds) and
``move`` (the body over one step). `Memory` is all that a vehicle remembers between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca

from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.plant import camera, rotors
from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState, held_rate
from hoverproof.servo.law import Design, Law, Measurement
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.layout import Packed, column, place, scalar
from hoverproof.servo.loop import command, parameters, readout
from hoverproof.simulation.flight_log import LOG_SIZE, noted
from hoverproof.simulation.kernel import Loop
from hoverproof.simulation.noise import normal_pair
from hoverproof.simulation.step import nearest_rotation, runge_kutta

LAYOUT = {
    "state": STATE_SIZE,
    "depth": 1,
    "thrust_margin": 1,
    "view": 1,
    "lost": 1,
    "lost_at": 1,
    "held": 3,
    "command": 1,
    "rotors": 4,
    "rotor_commands": 4,
    "gust": 3,
    "log": LOG_SIZE,
}
"""What a vehicle remembers: its state; the lowest depth (m), thrust margin (N) and view margin so
far; frames lost and the step of the first; the image centroid held; the thrust commanded (N); the
rotors' thrusts and commands (N); the gust (m/s, world frame); the log of the flight."""

REALISTIC_RECORD = {
    "state": STATE_SIZE,
    "lyapunov": 1,
    "rotor_thrust": 4,
    "thrust_command": 1,
    "centroid_held": 3,
    "wind": 3,
}

IMU_NOISE = 9
IMU_CHANNEL, GUST_CHANNEL = 64, 72  # a camera has at most 64 points: channels 0 to 63


@dataclass(frozen=True)
class Surroundings(Packed):
    """The true vehicle, its sensors, rotors and air; every field is an SX, scalar or (3, 1).

    Attributes
    ----------
    mass, inertia : SX
        Of the true vehicle, kg and kg m².
    camera_x, camera_y, camera_z : SX
        Axes of the camera in the body frame, (3, 1), dimensionless.
    wind : SX
        Mean, world frame, m/s.
    gyro_bias, velocity_bias, gravity_bias : SX
        rad/s, m/s and rad, body frame.
    arm, drag_ratio : SX
        Of the rotors, m.
    air_drag : SX
        kg/s.
    step, period : SX
        Of the integrator and of the controller, s.
    left_now, left_half, left_whole : SX
        What share of the gap to its command a rotor keeps at once, after half a step and a step;
        dimensionless.
    gust_kept, gust_added : SX
        A gust's share kept over a step, dimensionless, and the deviation added, m/s.
    rotor_min, rotor_max : SX
        N.
    image_noise, image_resolution, half_width, half_height : SX
        In focal lengths, dimensionless.
    gyro_noise, velocity_noise, gravity_noise : SX
        rad/s, m/s and rad.
    """

    mass: ca.SX = scalar("kg")
    inertia: ca.SX = column("kg m²")
    camera_x: ca.SX = column("1")
    camera_y: ca.SX = column("1")
    camera_z: ca.SX = column("1")
    wind: ca.SX = column("m/s")
    gyro_bias: ca.SX = column("rad/s")
    velocity_bias: ca.SX = column("m/s")
    gravity_bias: ca.SX = column("rad")
    arm: ca.SX = scalar("m")
    drag_ratio: ca.SX = scalar("m")
    air_drag: ca.SX = scalar("kg/s")
    step: ca.SX = scalar("s")
    period: ca.SX = scalar("s")
    left_now: ca.SX = scalar("1")
    left_half: ca.SX = scalar("1")
    left_whole: ca.SX = scalar("1")
    gust_kept: ca.SX = scalar("1")
    gust_added: ca.SX = scalar("m/s")
    rotor_min: ca.SX = scalar("N")
    rotor_max: ca.SX = scalar("N")
    image_noise: ca.SX = scalar("1")
    image_resolution: ca.SX = scalar("1")
    half_width: ca.SX = scalar("1")
    half_height: ca.SX = scalar("1")
    gyro_noise: ca.SX = scalar("rad/s")
    velocity_noise: ca.SX = scalar("m/s")
    gravity_noise: ca.SX = scalar("rad")

    def seen(self, body: RigidBodyState, points: ca.SX) -> ca.SX:
        """Return the target points in the frame of the camera as it is mounted, (3, n), m.

        Parameters
        ----------
        body : RigidBodyState
        points : SX
            (3, n), world frame, m.
        """
        mounted = ca.horzcat(self.camera_x, self.camera_y, self.camera_z)
        return camera.body_points(points, body.position, body.rotation @ mounted)


@dataclass(frozen=True)
class Features:
    """What a loop has beside its numbers, each a reason to compile another one.

    Attributes
    ----------
    camera_noise : bool
        Whether image points are noisy.
    rounded : bool
        Whether image coordinates are rounded.
    imu_noise : bool
        Whether gyro, velocity or gravity are noisy.
    gusts : bool
        Whether the wind has gusts.
    abort : bool
        Whether a flight ends when a target point leaves the view.
    """

    camera_noise: bool = False
    rounded: bool = False
    imu_noise: bool = False
    gusts: bool = False
    abort: bool = False


@cache
def realistic_loop(n: int, features: Features, law: Law = HAMEL_MAHONY) -> Loop:
    """Return the loop with sensors, rotors and wind.

    Parameters
    ----------
    n : int
        Number of target points.
    features : Features
    law : Law
    """
    (design, points), around = parameters(n, law), Surroundings.symbols()
    memory = {name: ca.SX.sym(name, size) for name, size in LAYOUT.items()}
    packed = ca.vertcat(*memory.values())
    params = ca.vertcat(design.vector(), around.vector())
    pixels, imu, gust = ca.SX.sym("pixels", 2 * n), ca.SX.sym("imu", 9), ca.SX.sym("gust", 3)

    def function(name: str, inputs: list[ca.SX], outputs: list[ca.SX]) -> ca.Function:
        outputs = [ca.densify(output) for output in ca.cse(outputs)]
        return share_reciprocals(ca.Function(f"hoverproof_{name}", inputs, outputs))

    seen = look(memory, around, points, pixels, law, rounded=features.rounded)
    decided = packed_with(memory, decide(memory, design, around, imu, law))
    moved = packed_with(memory, move(memory, design, around, points, gust))
    record = recorded(memory, design, around, points, law)
    return Loop(
        {
            "frame": function("frame", [packed, params, points, pixels], list(seen)),
            "control": function("control", [packed, params, imu], [decided]),
            "move": function("move", [packed, params, points, gust], [moved]),
            "record": function("record", [packed, params, points], [record]),
            "normals": normal_pair(),
        },
        {
            "CONDITIONS": 1,
            "MEMORY": packed.numel(),
            "GUARDS": 3,
            "PARAMS": params.numel(),
            "POINTS": 3 * n,
            "RECORD": record.numel(),
            "VIEW": place(LAYOUT, "view").start,
            "LOST": place(LAYOUT, "lost").start,
            "LOST_AT": place(LAYOUT, "lost_at").start,
            "HELD": place(LAYOUT, "held").start,
            "CAMERA_NOISE": 2 * n,
            "CAMERA_CHANNEL": 0,
            "CAMERA_NOISY": int(features.camera_noise),
            "IMU_NOISE": IMU_NOISE,
            "IMU_CHANNEL": IMU_CHANNEL,
            "IMU_NOISY": int(features.imu_noise),
            "GUST_CHANNEL": GUST_CHANNEL,
            "GUSTY": int(features.gusts),
            "ABORT": int(features.abort),
        },
    )


def packed_with(memory: dict[str, ca.SX], changes: dict[str, ca.SX]) -> ca.SX:
    """Return the memory as one vector, some parts replaced.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `LAYOUT`.
    changes : dict of SX
        The new parts, each (k, 1) likewise.
    """
    return ca.vertcat(*(memory | changes).values())


def look(
    memory: dict[str, ca.SX],
    around: Surroundings,
    points: ca.SX,
    noise: ca.SX,
    law: Law,
    *,
    rounded: bool,
) -> tuple[ca.SX, ca.SX]:
    """Return the feature of a frame, (3, 1), and a margin above 0 if all points are in it.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `LAYOUT`.
    around : Surroundings
    points : SX
        (3, n), world frame, m.
    noise : SX
        (2 n, 1), standard normal, point by point.
    law : Law
    rounded : bool
        Whether image coordinates are rounded.
    """
    seen = around.seen(RigidBodyState.from_vector(memory["state"]), points)
    image = camera.pinhole(seen)
    size = ca.fabs(image)
    margin = ca.fmin(
        ca.fmin(ca.mmin(around.half_width - size[0, :]), ca.mmin(around.half_height - size[1, :])),
        ca.mmin(seen[2, :]),
    )
    image = image + around.image_noise * ca.reshape(noise, 2, points.shape[1])
    if rounded:
        image = ca.floor(image / around.image_resolution + 0.5) * around.image_resolution
    return law.feature.seen(camera.spherical(image)), margin


def decide(
    memory: dict[str, ca.SX], design: Design, around: Surroundings, noise: ca.SX, law: Law
) -> dict[str, ca.SX]:
    """Return what a tick of the controller changes in the memory.

    The controller integrates the thrust it commands (Euler, over its period), keeps it within what
    the rotors can give, and shares it out among them.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `LAYOUT`.
    design : Design
    around : Surroundings
    noise : SX
        (9, 1), standard normal: gyro, velocity, gravity.
    law : Law
    """
    body = RigidBodyState.from_vector(memory["state"])
    down = body.gravity_direction + around.gravity_bias + around.gravity_noise * noise[6:9]
    measured = Measurement(
        centroid=memory["held"],
        velocity=body.velocity + around.velocity_bias + around.velocity_noise * noise[3:6],
        gravity_direction=down / ca.norm_2(down),
        rate=body.rate + around.gyro_bias + around.gyro_noise * noise[0:3],
        thrust=memory["command"],
    )
    thrust_rate, torque = command(law.force.ideal(measured, design), design, law)
    low, high = around.rotor_min, around.rotor_max
    thrust = measured.thrust + around.period * thrust_rate
    thrust = ca.fmin(ca.fmax(thrust, 4 * low), 4 * high)
    wanted = rotors.rotor_thrusts(thrust, torque, around.arm, around.drag_ratio)
    margin = ca.fmin(memory["thrust_margin"], law.lever(measured.thrust, design))
    return {
        "thrust_margin": margin,
        "command": thrust,
        "rotor_commands": ca.fmin(ca.fmax(wanted, low), high),
    }


def move(
    memory: dict[str, ca.SX], design: Design, around: Surroundings, points: ca.SX, noise: ca.SX
) -> dict[str, ca.SX]:
    """Return what one step of the integrator changes in the memory.

    Commands are held over a step, so the lag of the rotors is solved exactly.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `LAYOUT`.
    design : Design
    around : Surroundings
    points : SX
        (3, n), world frame, m.
    noise : SX
        (3, 1), standard normal: the gust.
    """
    gap = memory["rotors"] - memory["rotor_commands"]
    left = (around.left_now, around.left_half, around.left_whole)
    thrusts = [memory["rotor_commands"] + share * gap for share in left]
    wrenches = [rotors.wrench(t, around.arm, around.drag_ratio) for t in thrusts]

    def rate(x: ca.SX, half: int) -> ca.SX:
        body = RigidBodyState.from_vector(ca.vertcat(x, wrenches[half][0]))
        air = body.rotation.T @ (around.wind + memory["gust"])
        return held_rate(
            body,
            torque=wrenches[half][1:],
            mass=around.mass,
            inertia=around.inertia,
            gravity=design.gravity,
            drag=around.air_drag * (air - body.velocity),
        )

    now = memory["state"]
    after = RigidBodyState.from_vector(
        ca.vertcat(runge_kutta(rate, now[:-1], around.step), wrenches[2][0])
    )
    before = RigidBodyState.from_vector(now)
    depth = ca.mmin(around.seen(before, points)[2, :])
    return {
        "state": RigidBodyState(
            after.position,
            after.velocity,
            nearest_rotation(after.rotation),
            after.rate,
            after.thrust,
        ).vector(),
        "depth": ca.fmin(memory["depth"], depth),
        "rotors": thrusts[2],
        "gust": around.gust_kept * memory["gust"] + around.gust_added * noise,
        "log": noted(memory["log"], before, after.position, depth, memory["thrust_margin"]),
    }


def recorded(
    memory: dict[str, ca.SX], design: Design, around: Surroundings, points: ca.SX, law: Law
) -> ca.SX:
    """Return a record, in the order of `REALISTIC_RECORD`.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `LAYOUT`.
    design : Design
    around : Surroundings
    points : SX
        (3, n), world frame, m.
    law : Law
    """
    read = readout(memory["state"], design, points, around.arm, around.drag_ratio, law)
    wind = around.wind + memory["gust"]
    return ca.vertcat(
        memory["state"],
        read["lyapunov"],
        memory["rotors"],
        memory["command"],
        memory["held"],
        wind,
    )
