"""The law of the paper (eqs. 10-31), and its kin with another feature, goal or force."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca

from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import skew
from hoverproof.servo.law import Law
from hoverproof.servo.laws.choices import (
    CENTROID,
    IMAGE,
    INERTIAL,
    MEASURED,
    MODELLED,
    SCALED,
)
from hoverproof.servo.variables import Design, Errors, Measurement, WantedRates


def horizontal(a: ca.SX) -> ca.SX:
    """Return the components of P a that are not zero, (2, 1), P = I - e₃e₃ᵀ.

    Parameters
    ----------
    a : SX
        (3, 1).
    """
    return a[:2]


def chain(
    design: Design, *, image_error: ca.SX, velocity: ca.SX, force: ca.SX, turn: ca.SX
) -> Errors:
    """Return the error chain over an image error and a force, however a law has them.

    Parameters
    ----------
    design : Design
    image_error : SX
        δ1, (3, 1).
    velocity : SX
        V, (3, 1), m/s.
    force : SX
        F, (3, 1), N.
    turn : SX
        (3, 1), N/s: what the body rates add to the rate of the force error, times c.
    """
    d = design
    d1 = image_error
    d2 = d.slowness * velocity - d1
    d3 = force / d.stiffness + d2
    beta = d.mass / (d.stiffness * (d.k1 * d.k2 + d.k3))
    d4 = beta * horizontal(turn) + horizontal(d3)
    return Errors(d1, d2, d3, d4)


def wanted_rates(
    e: Errors, measured: Measurement, design: Design, depth_flow: ca.SX
) -> WantedRates:
    """Return the wanted δ̇3 along e₃, δ̇4 and Ω̇3.

    The depth flow stands for (k1/m) Q (δ1 + δ2) = QV; the choice of δ̇4 makes the cross terms of
    δ3 and δ4 cancel in the derivative of |δ3|² + |δ4|².

    Parameters
    ----------
    e : Errors
    measured : Measurement
    design : Design
    depth_flow : SX
        y = QV, (3, 1), 1/s.
    """
    d = design
    k12 = d.k1 * d.k2
    d3 = -skew(measured.rate) @ e.d3 + depth_flow - (k12 * e.d2 + d.k3 * e.d3) / d.mass
    d4 = horizontal(depth_flow) - ((k12 + d.k3) * horizontal(e.d3) + d.k4 * e.d4) / d.mass
    return WantedRates(d3[2], d4, yaw=-d.k_yaw / d.inertia[2] * measured.rate[2])


def turning(design: Design) -> ca.SX:
    """Return k1 k2 (k1 k2 + k3), (1, 1), kg²/s²: f(T) is this over m D.

    Parameters
    ----------
    design : Design
    """
    k12 = design.k1 * design.k2
    return k12 * (k12 + design.k3)


def bandwidth(mass: Any, k1: Any, k2: Any, k3: Any, k4: Any) -> Any:
    """Return the attitude bandwidth (k1 k2 + k3 + k4)/m, rad/s.

    It is the damping of the loop of δ3 and δ4, the fastest of the error chain.

    Parameters
    ----------
    mass : number or array
        kg.
    k1, k2, k3, k4 : number or array
        Gains, kg m/s, 1/m, kg/s and kg/s.
    """
    return (k1 * k2 + k3 + k4) / mass


HAMEL_MAHONY = Law(
    feature=CENTROID,
    goal=IMAGE,
    force=MODELLED,
    chain=chain,
    wanted_rates=wanted_rates,
    turning=turning,
    bandwidth=bandwidth,
)
"""The law of the paper."""

LAWS = {
    (feature.name, goal.name, force.name): replace(
        HAMEL_MAHONY, feature=feature, goal=goal, force=force
    )
    for feature in (CENTROID, SCALED)
    for goal in (IMAGE, INERTIAL)
    for force in (MODELLED, MEASURED)
}
"""The eight laws of this error chain by their choices; the paper's is one of them."""


def choices_of(law: Law) -> dict[str, str]:
    """Return the choices of a law by name, that of its heading if it turns to one.

    Parameters
    ----------
    law : Law
    """
    own = {} if law.heading is None else {"heading": law.heading.name}
    return {"feature": law.feature.name, "goal": law.goal.name, "force": law.force.name, **own}


def law_of(mission: Mission) -> Law:
    """Return the law that a mission names.

    Parameters
    ----------
    mission : Mission
    """
    chosen = mission.law
    return LAWS[chosen.feature, chosen.goal, chosen.force].flying(mission)
