"""The true vehicle, which is not the modelled one: what moves it, and how its errors are turned.

It is in a steady wind, and its thrust and torque are not what is commanded; the goal is straight
below. How far off it is, `uncertain` says, and with rotors that lag, `lagged`.
"""

from __future__ import annotations

import casadi as ca

from hoverproof.plant import camera, rigid_body
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.law import Law
from hoverproof.servo.variables import Design, Errors, Measurement

QUARTER = ca.SX([[0, -1], [1, 0]])
"""e₃ × of a horizontal vector, (2, 2)."""


def kappa(design: Design) -> ca.SX:
    """Return κ = (k1 k2 + k3)/m, (1, 1), 1/s: 1/(c κ) is the β of δ4.

    Parameters
    ----------
    design : Design
    """
    return (design.k1 * design.k2 + design.k3) / design.mass


def true_force(body: Measurement, wind: ca.SX, design: Design) -> ca.SX:
    """Return F, (3, 1), body axes, N: of thrust and weight, and of the wind.

    Parameters
    ----------
    body : Measurement
        Of the true vehicle; its thrust is times m over the true mass.
    wind : SX
        The steady force of the wind, likewise, (3, 1), body axes, N.
    design : Design
    """
    return wind + rigid_body.force(body.thrust, body.gravity_direction, design.mass, design.gravity)


def true_errors(law: Law, body: Measurement, force: ca.SX, lever: ca.SX, design: Design) -> Errors:
    """Return δ1 to δ4 of the true vehicle, δ4 with the lever that the controller has.

    Parameters
    ----------
    law : Law
    body : Measurement
    force : SX
        F, (3, 1), body axes, N.
    lever : SX
        D_c, (1, 1), N.
    design : Design
    """
    return law.chain(
        design,
        image_error=law.goal.error(body, design),
        velocity=body.velocity,
        force=force,
        turn=lever * skew(E3) @ body.rate,
    )


def true_flow(
    body: Measurement,
    design: Design,
    *,
    force: ca.SX,
    depth_flow: ca.SX,
    turning: ca.SX,
    thrust_rate: ca.SX,
) -> ca.SX:
    """Return the time derivative of the true vehicle's measurement, (13, 1).

    Parameters
    ----------
    body : Measurement
    design : Design
    force : SX
        F, (3, 1), body axes, N.
    depth_flow : SX
        y, (3, 1), 1/s.
    turning : SX
        e₃ × Ω̇, (2, 1), rad/s².
    thrust_rate : SX
        T̃', (1, 1), N/s.
    """
    return ca.vertcat(
        camera.centroid_rate(body.centroid, body.rate, depth_flow),
        rigid_body.acceleration(body.velocity, body.rate, force, design.mass),
        rigid_body.gravity_direction_rate(body.gravity_direction, body.rate),
        -QUARTER @ turning,
        ca.SX.sym("yaw_acceleration"),
        thrust_rate,
    )


def outer_rates(
    e: Errors, *, turn: ca.SX, depth_flow: ca.SX, pull: ca.SX, dragged: ca.SX, pushed: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return δ1' to δ3' in closed form, (3, 1) each, 1/s.

    Parameters
    ----------
    e : Errors
    turn : SX
        -Ω×, (3, 3), rad/s.
    depth_flow : SX
        y, (3, 1), 1/s.
    pull : SX
        (k1 k2/m)(δ3 - δ2), (3, 1), 1/s.
    dragged : SX
        s3 h ζ, (3, 1), 1/s: what a goal that is fixed in the image turns with.
    pushed : SX
        (3, 1), 1/s: what tilting and the thrust do to the force, over c.
    """
    d1 = turn @ e.d1 - depth_flow + dragged
    d2 = turn @ e.d2 + depth_flow + pull - dragged
    d3 = turn @ e.d3 + depth_flow + pull + pushed
    return d1, d2, d3
