"""The errors of a vehicle that is not the modelled one, under the controller of a law.

Mass, thrust, inertia and wind may be wrong, and all that is measured but the body rates. The
errors are those of the true vehicle, the controller has its own knowledge of them, and the goal is
straight below. All that is unknown stands in `Doubt`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import Controller, derive_controller
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY, horizontal
from hoverproof.servo.layout import Packed, column, scalar
from hoverproof.servo.true_vehicle import (
    QUARTER,
    kappa,
    outer_rates,
    true_errors,
    true_flow,
    true_force,
)
from hoverproof.servo.variables import Design, Errors, Measurement


@dataclass(frozen=True)
class Doubt(Packed):
    """What the controller does not know, each may change with time; every field is an SX.

    Attributes
    ----------
    thrust_gain : SX
        ς, (1, 1): T̃' = ς U, T̃ the true thrust over the true mass, times m.
    lever_ratio : SX
        χ = D/D_c, (1, 1): the true lever over that of the controller.
    lever_drift : SX
        ψ, (1, 1), 1/s: (Ḋ_c - what the controller takes for it)/D_c.
    angular_gain : SX
        γ, (4, 1), a (2, 2) matrix by columns: e₃ × Ω̇ = (I + γ) times what is commanded.
    gyroscopic : SX
        G, (4, 1), likewise: and Ω₃ G e₃ × Ω besides, where moments of inertia are wrong.
    feature : SX
        n, (3, 1), body axes: the image error δ1 that is used less the present one, less m/k1 times
        the same of the velocity.
    force : SX
        b, (3, 1): the force that is used less the true one, over c, body axes.
    """

    thrust_gain: ca.SX = scalar("1")
    lever_ratio: ca.SX = scalar("1")
    lever_drift: ca.SX = scalar("1/s")
    angular_gain: ca.SX = column("1", 4)
    gyroscopic: ca.SX = column("1", 4)
    feature: ca.SX = column("1")
    force: ca.SX = column("1")

    @classmethod
    def none(cls) -> Doubt:
        """Return what holds if the vehicle is the modelled one, and sees without error."""
        zeros = {name: ca.SX.zeros(size) for name, size in cls.sizes().items()}
        return cls(**{**zeros, "thrust_gain": ca.SX(1), "lever_ratio": ca.SX(1)})


@dataclass(frozen=True)
class Motion(Packed):
    """What the error rates depend on besides errors and doubt; every field is an SX.

    Attributes
    ----------
    depth_flow : SX
        y = J V, (3, 1), 1/s.
    rate : SX
        Ω, (3, 1), body frame, rad/s.
    goal : SX
        s3, (1, 1): s3* for a goal that is fixed in the image, 0 for an inertial one.
    quickness : SX
        h = c κ/D_c, (1, 1), 1/s: e₃ × Ω = h ζ with ζ = δ4 - P δ3.
    sinking : SX
        p1 = h δ3z, (1, 1), 1/s.
    sinking_by_error : SX
        p2 = h (n - b)z, (1, 1), 1/s.
    crosswind : SX
        p3, (1, 1), 1/s: what the controller takes for Ḋ_c less U, over D_c.
    """

    depth_flow: ca.SX = column("1/s")
    rate: ca.SX = column("rad/s")
    goal: ca.SX = scalar("1")
    quickness: ca.SX = scalar("1/s")
    sinking: ca.SX = scalar("1/s")
    sinking_by_error: ca.SX = scalar("1/s")
    crosswind: ca.SX = scalar("1/s")


def command(e: Errors, motion: Motion, doubt: Doubt, design: Design) -> ca.SX:
    """Return what the controller asks of e₃ × Ω̇, times what it takes δ4 for, (2, 1), 1/s².

    Parameters
    ----------
    e : Errors
    motion : Motion
    doubt : Doubt
    design : Design
    """
    k12, damping = design.k1 * design.k2 / design.mass, design.k4 / design.mass
    missed, h3 = horizontal(doubt.feature - doubt.force), horizontal(e.d3)
    p1, p2, p3 = motion.sinking, motion.sinking_by_error, motion.crosswind
    return (
        -(kappa(design) + damping) * (e.d4 - missed)
        - k12 * (h3 - horizontal(e.d2))
        - k12 * horizontal(doubt.force)
        - (2 * (p1 - p2) + p3) * (e.d4 - h3)
        + motion.rate[2] * QUARTER @ (h3 - missed)
    )


def error_rates(e: Errors, motion: Motion, doubt: Doubt, design: Design) -> ca.SX:
    """Return the error rates in closed form, (11, 1), 1/s; `UncertainLoop.rate` is derived.

    Where nothing is in doubt they are those of the modelled vehicle. Each term of `doubt` but that
    of n and b has an error as a factor.

    Parameters
    ----------
    e : Errors
        δ1 to δ4 of the true vehicle, δ4 with the lever that the controller has.
    motion : Motion
    doubt : Doubt
    design : Design
    """
    force_pace, damping = kappa(design), design.k4 / design.mass
    k12 = design.k1 * design.k2 / design.mass
    pull = k12 * (e.d3 - e.d2)
    zeta, h3 = e.d4 - horizontal(e.d3), horizontal(e.d3)
    missed, chi = doubt.feature - doubt.force, doubt.lever_ratio
    y, turn, yaw = motion.depth_flow, -skew(motion.rate), motion.rate[2] * QUARTER
    p2 = motion.sinking_by_error
    dragged = motion.goal * motion.quickness * ca.vertcat(zeta, 0)

    lift = doubt.thrust_gain * force_pace * (e.d3[2] - missed[2])
    pushed = ca.vertcat(force_pace * chi * zeta, -lift)
    d1, d2, d3 = outer_rates(e, turn=turn, depth_flow=y, pull=pull, dragged=dragged, pushed=pushed)
    d4 = (
        horizontal(y)
        - force_pace * h3
        - damping * e.d4
        + (force_pace + damping) * horizontal(missed)
        - k12 * horizontal(doubt.force)
        - yaw @ horizontal(missed)
        + (doubt.lever_drift + force_pace * (chi - 1) + p2) * zeta
        + ca.reshape(doubt.angular_gain, 2, 2) @ command(e, motion, doubt, design)
        + motion.rate[2] * ca.reshape(doubt.gyroscopic, 2, 2) @ zeta
    )
    return ca.vertcat(d1, d2, d3, d4)


@dataclass(frozen=True)
class UncertainLoop:
    """The errors of the true vehicle, differentiated along its motion under a law's controller.

    Attributes
    ----------
    design : Design
        Symbols of the design; the goal is straight below.
    body : Measurement
        Symbols of the true vehicle: present feature, V, ρ, Ω and T̃, N.
    wind : SX
        Symbols of the steady force of the wind, body axes, times m over the true mass, (3, 1), N.
    known : Measurement
        What the controller has in their place: symbols, but for the same Ω.
    errors : Errors
        δ1 to δ4.
    motion : Motion
    doubt : Doubt
        ς, ψ, γ and G are symbols; χ, n and b follow.
    thrust_rate : SX
        U, (1, 1), N/s.
    rate : SX
        δ̇1 to δ̇4, (11, 1), 1/s.
    """

    design: Design
    body: Measurement
    wind: ca.SX
    known: Any
    errors: Errors
    motion: Motion
    doubt: Doubt
    thrust_rate: ca.SX
    rate: ca.SX

    def closed_form(self) -> ca.SX:
        """Return what the rate is claimed to be, (11, 1), 1/s."""
        return error_rates(self.errors, self.motion, self.doubt, self.design)


def derive_uncertain_loop(law: Law = HAMEL_MAHONY) -> UncertainLoop:
    """Differentiate the errors of the true vehicle along its motion.

    Parameters
    ----------
    law : Law
    """
    design = law.design.symbols()
    design = replace(design, goal_centroid=design.goal_centroid[2] * E3)
    body, wind, doubt = Measurement.symbols(), ca.SX.sym("wind", 3), Doubt.symbols()
    known = replace(law.measurement.symbols(), rate=body.rate)
    thrust_rate, command, model_drift = _commanded(derive_controller(law), known, design)

    force = true_force(body, wind, design)
    lever = law.lever(law.force.thrust(known, design), design)
    held, depth_flow = ca.SX.sym("D_c"), ca.SX.sym("y", 3)  # D_c moves as it is said to
    errors = true_errors(law, body, force, held, design)
    spin = ca.reshape(doubt.gyroscopic, 2, 2) @ QUARTER @ body.rate[:2]
    turned = QUARTER @ command + ca.reshape(doubt.angular_gain, 2, 2) @ QUARTER @ command
    flow = ca.vertcat(
        true_flow(
            body,
            design,
            force=force,
            depth_flow=depth_flow,
            turning=turned + body.rate[2] * spin,
            thrust_rate=doubt.thrust_gain * thrust_rate,
        ),
        -skew(body.rate) @ wind,
        model_drift + doubt.lever_drift * lever,
    )
    rate = lie_derivative(errors.vector(), ca.vertcat(body.vector(), wind, held), flow)
    at_lever = ca.substitute([errors.vector(), rate], [held], [lever])
    errors, rate = Errors.from_vector(at_lever[0]), at_lever[1]
    doubt = replace(
        doubt,
        lever_ratio=law.lever(body.thrust, design) / lever,
        feature=errors.d2 - law.errors(known, design).d2,
        force=(law.force.force(known, design) - force) / design.stiffness,
    )
    quickness = design.stiffness * kappa(design) / lever
    motion = Motion(
        depth_flow=depth_flow,
        rate=body.rate,
        goal=law.goal.fixed(design)[2],
        quickness=quickness,
        sinking=quickness * errors.d3[2],
        sinking_by_error=quickness * (doubt.feature - doubt.force)[2],
        crosswind=(model_drift - thrust_rate) / lever,
    )
    return UncertainLoop(design, body, wind, known, errors, motion, doubt, thrust_rate, rate)


def _commanded(controller: Controller, known: Any, design: Design) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return U, the horizontal Ω̇ that is asked for, and what the controller takes for Ḋ_c."""
    law, z, d = controller.law, controller.measured, controller.design
    own = controller.measured_rate(ca.SX.zeros(3))
    drift = lie_derivative(law.lever(law.force.thrust(z, d), d), z.vector(), own)
    asked = [controller.thrust_rate, horizontal(controller.angular_acceleration), drift]
    old, new = [z.vector(), d.vector()], [known.vector(), design.vector()]
    thrust_rate, command, model_drift = ca.substitute(asked, old, new)
    return thrust_rate, command, model_drift
