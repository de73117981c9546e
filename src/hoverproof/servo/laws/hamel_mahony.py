"""The law of the paper: centroid, goal fixed in the image, modelled force (eqs. 10-31)."""

from __future__ import annotations

from typing import Any

import casadi as ca

from hoverproof.plant import rigid_body
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.law import Design, Errors, Law, Measurement, WantedRates


def horizontal(a: ca.SX) -> ca.SX:
    """Return the components of P a that are not zero, (2, 1), P = I - e₃e₃ᵀ.

    Parameters
    ----------
    a : SX
        (3, 1).
    """
    return a[:2]


def horizontal_lever(thrust: ca.SX, design: Design) -> ca.SX:
    """Return sk(T e₃ - c q*), (3, 3), N: how body rates turn the force error.

    Parameters
    ----------
    thrust : SX
        T, (1, 1), N.
    design : Design
    """
    return skew(thrust * E3 - design.stiffness * design.goal_centroid)


def lever(thrust: ca.SX, design: Design) -> ca.SX:
    """Return D = T - c q3*, (1, 1), N: at zero the controller is singular.

    Parameters
    ----------
    thrust : SX
        T, (1, 1), N.
    design : Design
    """
    return thrust - design.singular_thrust


def errors(measured: Measurement, design: Design) -> Errors:
    """Return δ1…δ4 of a measurement (eqs. 10, 17, 18, 25).

    Parameters
    ----------
    measured : Measurement
    design : Design
    """
    d, z = design, measured
    return chain(
        d,
        image_error=z.centroid - d.goal_centroid,
        velocity=z.velocity,
        force=rigid_body.force(z.thrust, z.gravity_direction, d.mass, d.gravity),
        turn=horizontal_lever(z.thrust, d) @ z.rate,
    )


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
    name="hamel-mahony",
    errors=errors,
    wanted_rates=wanted_rates,
    lever=lever,
    turning=turning,
    bandwidth=bandwidth,
)
