"""The closed loop as on a vehicle: a camera with frames, a controller with ticks, rotors, wind.

Three graphs of the same model functions as the paper's loop, which the driver calls when they are
due: ``frame`` (what the camera sees), ``control`` (what the controller makes of it and holds) and
``move`` (the body over one step). All that a vehicle remembers between them is in its memory.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import casadi as ca

from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.mission.frame import Frame, X
from hoverproof.plant import rotors
from hoverproof.plant.rigid_body import RigidBodyState, held_rate
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.layout import place
from hoverproof.servo.loop import command, parameters, readout
from hoverproof.servo.variables import Design
from hoverproof.simulation.flight_log import noted
from hoverproof.simulation.gyro import turned_on
from hoverproof.simulation.kernel import Loop
from hoverproof.simulation.noise import normal_pair
from hoverproof.simulation.sensing import imu_noise, look, read, used
from hoverproof.simulation.step import nearest_rotation, runge_kutta
from hoverproof.simulation.surroundings import LAYOUT, Features

IMU_CHANNEL, GUST_CHANNEL = 64, 72
CAMERA_CHANNEL = 128
"""Of a camera that draws more than 64 pairs of numbers; a smaller one has channels 0 to 63."""


@cache
def realistic_loop(n: int, features: Features, law: Law = HAMEL_MAHONY, frame: Frame = X) -> Loop:
    """Return the loop with sensors, rotors and wind.

    Parameters
    ----------
    n : int
        Number of target points.
    features : Features
    law : Law
    frame : Frame
        Of the rotors.
    """
    design, points = parameters(n, law)
    rotors_there = len(frame.names)
    around = features.surroundings(law, rotors_there).symbols()
    north, layout = law.sees_north, features.layout(law, rotors_there)
    memory = {name: ca.SX.sym(name, size) for name, size in layout.items()}
    packed = ca.vertcat(*memory.values())
    params = ca.vertcat(design.vector(), around.vector())
    imu = ca.SX.sym("imu", imu_noise(law))
    pixels, gust = ca.SX.sym("pixels", 2 * n + 3 * north), ca.SX.sym("gust", 3)

    def function(name: str, inputs: list[ca.SX], outputs: list[ca.SX]) -> ca.Function:
        outputs = [ca.densify(output) for output in ca.cse(outputs)]
        return share_reciprocals(ca.Function(f"hoverproof_{name}", inputs, outputs))

    seen = look(memory, around, points, pixels, law, features)
    decided = packed_with(memory, decide(memory, design, around, imu, law, frame))
    moved = packed_with(memory, move(memory, design, around, points, gust, (law, frame)))
    record = recorded(memory, design, around, points, law, frame)
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
            "SEEN": 6 if north else 3,
            "NORTH": place(layout, "north" if north else "held").start,
            "CAMERA_NOISE": pixels.numel(),
            "CAMERA_CHANNEL": CAMERA_CHANNEL if north or n > IMU_CHANNEL else 0,
            "CAMERA_NOISY": int(features.camera_noise or (north and features.imu_noise)),
            "IMU_NOISE": imu.numel(),
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
        By name, each (k, 1), with k and unit as in `Features.layout`.
    changes : dict of SX
        The new parts, each (k, 1) likewise.
    """
    return ca.vertcat(*(memory | changes).values())


def decide(
    memory: dict[str, ca.SX], design: Design, around: Any, noise: ca.SX, law: Law, frame: Frame
) -> dict[str, ca.SX]:
    """Return what a tick of the controller changes in the memory.

    The controller integrates the thrust it commands (Euler, over its period), keeps it within what
    the rotors can give, and shares it out among them.

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
    frame : Frame
        Of the rotors.
    """
    measured = read(memory, design, around, noise, law)
    thrust_rate, torque = command(measured, design, law)
    low, high = around.rotor_min, around.rotor_max
    thrust = measured.thrust + around.period * thrust_rate
    thrust = ca.fmin(ca.fmax(thrust, around.total_min), around.total_max)
    wanted = rotors.rotor_thrusts(frame, thrust, torque, around.arm, around.drag_ratio)
    lever = law.lever(law.force.thrust(measured, design), design)
    changes = {
        "thrust_margin": ca.fmin(memory["thrust_margin"], lever),
        "command": thrust,
        "rotor_commands": ca.fmin(ca.fmax(wanted, low), high),
    }
    if "attitude" in memory:
        changes["gyro_error"] = around.gyro_bias + around.gyro_noise * noise[0:3]
    return changes


def move(
    memory: dict[str, ca.SX],
    design: Design,
    around: Any,
    points: ca.SX,
    noise: ca.SX,
    made: tuple[Law, Frame],
) -> dict[str, ca.SX]:
    """Return what one step of the integrator changes in the memory.

    Commands are held over a step, so the lag of the rotors is solved exactly. The gyro adds up the
    mean of the body rates at both ends of the step, with the error of its last reading.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `Features.layout`.
    design : Design
    around : Surroundings
        Likewise.
    points : SX
        (3, n), world frame, m.
    noise : SX
        (3, 1), standard normal: the gust.
    made : tuple of Law and Frame
        The law, and the rotors.
    """
    law, frame = made
    gap = memory["rotors"] - memory["rotor_commands"]
    left = (around.left_now, around.left_half, around.left_whole)
    thrusts = [memory["rotor_commands"] + share * gap for share in left]
    wrenches = [around.wrench(frame, t) for t in thrusts]

    def rate(x: ca.SX, half: int) -> ca.SX:
        body = RigidBodyState.from_vector(ca.vertcat(x, wrenches[half][0]))
        return held_rate(
            body,
            torque=wrenches[half][1:],
            mass=around.mass,
            inertia=around.inertia,
            gravity=design.gravity,
            drag=around.drag(body, memory["gust"]),
        )

    now = memory["state"]
    after = RigidBodyState.from_vector(
        ca.vertcat(runge_kutta(rate, now[:-1], around.step), wrenches[2][0])
    )
    before = RigidBodyState.from_vector(now)
    depth = ca.mmin(around.seen(before, points, law)[2, :])
    changes = {
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
    if "attitude" in memory:
        rate_read = (before.rate + after.rate) / 2 + memory["gyro_error"]
        changes["attitude"] = turned_on(memory["attitude"], around.step * rate_read)
    if "accelerometer" in memory:
        first = replace(before, thrust=wrenches[0][0])  # rotors may have jumped at the last tick
        ends = (around.specific_force(body, memory["gust"]) for body in (first, after))
        changes["accelerometer"] = around.lagging(memory["accelerometer"], *ends)
    return changes


def recorded(
    memory: dict[str, ca.SX], design: Design, around: Any, points: ca.SX, law: Law, frame: Frame
) -> ca.SX:
    """Return a record, in the order of `Features.record`.

    Parameters
    ----------
    memory : dict of SX
        By name, each (k, 1), with k and unit as in `Features.layout`.
    design : Design
    around : Surroundings
    points : SX
        (3, n), world frame, m.
    law : Law
    frame : Frame
        Of the rotors.
    """
    body, own = RigidBodyState.from_vector(memory["state"]), []
    if law.force.sensed is not None:
        own = [around.specific_force(body, memory["gust"])]
    lengths = around.arm, around.drag_ratio
    force = own[0] if own else None
    read = readout(memory["state"], design, points, *lengths, law, force, frame)
    return ca.vertcat(
        memory["state"],
        read["lyapunov"],
        around.thrusts(memory["rotors"]),
        memory["command"],
        used(memory),
        around.wind + memory["gust"],
        memory["rotor_commands"],
        *own,
    )
