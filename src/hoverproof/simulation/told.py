"""Graphs that look into a flight: what its sensors tell, and the specific force that acts."""

from __future__ import annotations

from functools import cache

import casadi as ca

from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState
from hoverproof.servo.law import Law
from hoverproof.servo.loop import parameters
from hoverproof.simulation.realistic import imu_noise, read
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
    design, _ = parameters(n, law)
    around = features.surroundings(law, rotors_there).symbols()
    layout = features.layout(law, rotors_there)
    memory = {name: ca.SX.sym(name, size) for name, size in layout.items()}
    imu = ca.SX.sym("imu", imu_noise(law))
    told = vars(read(memory, design, around, imu, law))
    given = [ca.vertcat(*memory.values()), ca.vertcat(design.vector(), around.vector()), imu]
    names = ["memory", "parameters", "noise"]
    return ca.Function("read", given, list(told.values()), names, list(told))


def specific_force_function(around: type[Surroundings]) -> ca.Function:
    """Return (state (19,), gust (3,) in m/s, surroundings) ↦ true specific force, (3,), m/s².

    Parameters
    ----------
    around : type of Surroundings
    """
    state, gust, symbols = ca.SX.sym("state", STATE_SIZE), ca.SX.sym("gust", 3), around.symbols()
    force = symbols.specific_force(RigidBodyState.from_vector(state), gust)
    return ca.Function("specific_force", [state, gust, symbols.vector()], [force])
