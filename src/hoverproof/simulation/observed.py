"""Graphs that look into a flight: its sensors, its images, and the specific force that acts."""

from __future__ import annotations

from functools import cache

import casadi as ca

from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState
from hoverproof.servo.law import Law
from hoverproof.servo.loop import parameters
from hoverproof.servo.variables import Design
from hoverproof.simulation.sensing import imu_noise, read, understood
from hoverproof.simulation.surroundings import Features, Surroundings


@cache
def read_function(n: int, features: Features, law: Law, rotors_there: int = 4) -> ca.Function:
    """Return (memory, parameters, noise of a tick) ↦ what the sensors tell, each by its name.

    Parameters
    ----------
    n : int
        Number of target points.
    features : Features
    law : Law
    rotors_there : int
        Number of rotors.
    """
    memory, around, design, _, given = _symbols(n, features, law, rotors_there)
    imu = ca.SX.sym("imu", imu_noise(law))
    told = vars(read(memory, design, around, imu, law))
    names = ["memory", "parameters", "noise"]
    return ca.Function("read", [*given, imu], list(told.values()), names, list(told))


@cache
def seen_function(n: int, features: Features, law: Law, rotors_there: int = 4) -> ca.Function:
    """Return (memory, parameters, points (3, n), image (2, n), noise (3,)) ↦ what a frame tells.

    Parameters
    ----------
    n : int
        Number of target points.
    features : Features
        With a lens the image is in px.
    law : Law
    rotors_there : int
        Number of rotors.
    """
    memory, around, _, points, given = _symbols(n, features, law, rotors_there)
    image, noise = ca.SX.sym("image", 2, n), ca.SX.sym("noise", 3)
    told = understood(memory, around, points, image, noise, law, features)
    return ca.Function("seen", [*given, points, image, noise], [ca.densify(told)])


@cache
def camera_function(n: int, features: Features, law: Law, rotors_there: int = 4) -> ca.Function:
    """Return (memory, parameters) ↦ where the camera is and how it moves.

    That is its place, m, and its axes, (3, 3), in the world frame, its velocity there, m/s, and its
    rate in its own axes, rad/s.

    Parameters
    ----------
    n : int
        Number of target points.
    features : Features
    law : Law
    rotors_there : int
        Number of rotors.
    """
    memory, around, _, _, given = _symbols(n, features, law, rotors_there)
    body = RigidBodyState.from_vector(memory["state"])
    axes = ca.horzcat(around.camera_x, around.camera_y, around.camera_z)
    place = law.mount.place(body.position, body.rotation)
    arm = law.mount.place(ca.SX.zeros(3), ca.SX.eye(3))
    velocity = body.rotation @ (body.velocity + ca.cross(body.rate, arm))
    looked = [place, body.rotation @ axes, velocity, axes.T @ body.rate]
    return ca.Function("camera", given, [ca.densify(part) for part in looked])


def _symbols(
    n: int, features: Features, law: Law, rotors_there: int
) -> tuple[dict[str, ca.SX], Surroundings, Design, ca.SX, list[ca.SX]]:
    """Return memory by name, surroundings, design and points; and the first two arguments."""
    design, points = parameters(n, law)
    around = features.surroundings(law, rotors_there).symbols()
    layout = features.layout(law, rotors_there)
    memory = {name: ca.SX.sym(name, size) for name, size in layout.items()}
    given = [ca.vertcat(*memory.values()), ca.vertcat(design.vector(), around.vector())]
    return memory, around, design, points, given


def specific_force_function(around: type[Surroundings]) -> ca.Function:
    """Return (state (19,), gust (3,) in m/s, surroundings) ↦ true specific force, (3,), m/s².

    Parameters
    ----------
    around : type of Surroundings
    """
    state, gust, symbols = ca.SX.sym("state", STATE_SIZE), ca.SX.sym("gust", 3), around.symbols()
    force = symbols.specific_force(RigidBodyState.from_vector(state), gust)
    return ca.Function("specific_force", [state, gust, symbols.vector()], [force])
