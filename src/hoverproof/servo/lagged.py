"""The errors of a vehicle within tolerance whose rotors follow with a lag, late images included.

It measures its force exactly, or flies as modelled without wind. Thrust and torque follow what is
commanded with one first-order lag τ. Beside the errors there are what the rotors are ahead of the
smooth part of the command,

    μ = s_a - s_n,   s_n = -(κ + k4/m) δ4 - (k1 k2/m) P(δ3 - δ2),   μT = U_a/c - κ δ3z,

s_a = D_c a_a/(c κ) of the angular acceleration a_a that the torque of the rotors is worth to the
controller, and U_a the rate of the thrust that they follow with.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import horizontal
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
class Rotors(Packed):
    """What the rotors do, and how; every field is an SX.

    Attributes
    ----------
    lag : SX
        τ, (1, 1), s.
    thrust_gain : SX
        ς, (1, 1): T̃' = ς U_a.
    angular_gain, gyroscopic : SX
        γ and G_t, (4, 1), (2, 2) matrices by columns: e₃ × Ω̇ = (I + γ) a_a - Ω₃ G_t e₃ × Ω.
    torque : SX
        μ, (2, 1), 1/s.
    thrust : SX
        μT, (1, 1), 1/s.
    """

    lag: ca.SX = scalar("s")
    thrust_gain: ca.SX = scalar("1")
    angular_gain: ca.SX = column("1", 4)
    gyroscopic: ca.SX = column("1", 4)
    torque: ca.SX = column("1/s", 2)
    thrust: ca.SX = scalar("1/s")


@dataclass(frozen=True)
class Setting(Packed):
    """What the rates depend on besides errors and rotors; every field is an SX.

    Attributes
    ----------
    depth_flow : SX
        y = J V, (3, 1), 1/s.
    ahead : SX
        n, (3, 1): the feature that is used less the present one, body axes.
    yaw : SX
        Ω₃, (1, 1), rad/s.
    goal : SX
        s3, (1, 1): s3* for a goal that is fixed in the image, 0 for an inertial one.
    quickness : SX
        h = c κ/D_c, (1, 1), 1/s.
    lever_ratio : SX
        χ = D/D_c, (1, 1).
    crosswind : SX
        p3 = e₃ᵀ(Ω × w̃)/D_c, (1, 1), 1/s.
    """

    depth_flow: ca.SX = column("1/s")
    ahead: ca.SX = column("1")
    yaw: ca.SX = scalar("rad/s")
    goal: ca.SX = scalar("1")
    quickness: ca.SX = scalar("1/s")
    lever_ratio: ca.SX = scalar("1")
    crosswind: ca.SX = scalar("1/s")


def own_gyroscopic(design: Design) -> ca.SX:
    """Return G_c, (2, 2): the controller makes up for Ω₃ G_c e₃ × Ω in the torque it commands.

    Parameters
    ----------
    design : Design
    """
    i1, i2, i3 = ca.vertsplit(design.inertia[:3])
    return ca.vertcat(ca.horzcat(0, (i3 - i1) / i2), ca.horzcat((i2 - i3) / i1, 0))


def smooth_command(e: Errors, design: Design) -> ca.SX:
    """Return s_n, (2, 1), 1/s: the command without what jumps with an image, turns or swings.

    Parameters
    ----------
    e : Errors
    design : Design
    """
    damping, k12 = design.k4 / design.mass, design.k1 * design.k2 / design.mass
    return -(kappa(design) + damping) * e.d4 - k12 * horizontal(e.d3 - e.d2)


def lagged_rates(e: Errors, at: Setting, rotors: Rotors, design: Design) -> ca.SX:
    """Return δ1' to δ4', τ μ' and τ μT', (14, 1), in closed form; `LaggedLoop.rate` is derived.

    Parameters
    ----------
    e : Errors
        δ1 to δ4 of the true vehicle, δ4 with the lever that the controller has.
    at : Setting
    rotors : Rotors
    design : Design
    """
    k, damping = kappa(design), design.k4 / design.mass
    k12 = design.k1 * design.k2 / design.mass
    zeta, h, n, y, tau = e.d4 - horizontal(e.d3), at.quickness, at.ahead, at.depth_flow, rotors.lag
    turn = -skew(ca.vertcat(-QUARTER @ (h * zeta), at.yaw))
    yaw, pull = at.yaw * QUARTER, k12 * (e.d3 - e.d2)
    dragged = at.goal * h * ca.vertcat(zeta, 0)
    follows = k * e.d3[2] + rotors.thrust  # U_a/c
    drift = rotors.thrust_gain * h / k * follows + at.crosswind  # D_c'/D_c
    swing = 2 * h * (e.d3 - n)[2] + at.crosswind
    applied = smooth_command(e, design) + rotors.torque
    gain, own = ca.reshape(rotors.angular_gain, 2, 2), own_gyroscopic(design)

    lift = rotors.thrust_gain * follows
    pushed = ca.vertcat(k * at.lever_ratio * zeta, -lift)
    d1, d2, d3 = outer_rates(e, turn=turn, depth_flow=y, pull=pull, dragged=dragged, pushed=pushed)
    d4 = (
        horizontal(y + pull)
        + (k * at.lever_ratio + drift + h * e.d3[2]) * zeta
        - yaw @ horizontal(e.d3)
        + applied
        + gain @ applied
        - at.yaw * ca.reshape(rotors.gyroscopic, 2, 2) @ zeta
    )
    torque = (
        (k + damping) * horizontal(n)
        - swing * zeta
        - rotors.torque
        + yaw @ horizontal(e.d3 - n)
        + at.yaw * own @ zeta
        + tau * (drift * applied + (k + damping) * d4 + k12 * horizontal(d3 - d2))
    )
    thrust = -k * n[2] - rotors.thrust - tau * k * d3[2]
    return ca.vertcat(d1, d2, d3, d4, torque, thrust)


@dataclass(frozen=True)
class LaggedLoop:
    """Errors and rotors, differentiated along the true motion under a law's controller.

    Attributes
    ----------
    design : Design
        Symbols of the design; the goal is straight below.
    body : Measurement
        Symbols of the true vehicle: present feature, V, ρ, Ω and T̃, N.
    wind : SX
        w̃, the force of the steady wind, body axes, times m over the true mass, (3, 1), N: symbols,
        or zero for a modelled force.
    errors : Errors
    setting : Setting
    rotors : Rotors
        μ and μT follow, the others are symbols.
    rate : SX
        δ1' to δ4', τ μ' and τ μT', (14, 1).
    """

    design: Design
    body: Measurement
    wind: ca.SX
    errors: Errors
    setting: Setting
    rotors: Rotors
    rate: ca.SX

    def closed_form(self) -> ca.SX:
        """Return what the rate is claimed to be, (14, 1)."""
        return lagged_rates(self.errors, self.setting, self.rotors, self.design)


def derive_lagged_loop(law: Law) -> LaggedLoop:
    """Differentiate errors and rotors along the motion of the true vehicle.

    Parameters
    ----------
    law : Law
        With a measured force in any steady wind, with the modelled one in none.
    """
    controller = derive_controller(law)
    design = replace(controller.design, goal_centroid=controller.design.goal_centroid[2] * E3)
    body, ahead, rotors = Measurement.symbols(), ca.SX.sym("n", 3), Rotors.symbols()
    wind = ca.SX.sym("wind", 3) if law.force.sensed else ca.SX.zeros(3)
    late, applied = ca.SX.sym("U_a"), ca.SX.sym("a_a", 2)
    force = true_force(body, wind, design)
    known = replace(body, centroid=body.centroid + ahead)
    if law.force.sensed:
        known = law.force.sensed(known, (wind - body.thrust * E3) / design.mass)
    asked, torque = ca.substitute(
        [controller.thrust_rate, controller.torque],
        [controller.measured.vector(), controller.design.vector()],
        [known.vector(), design.vector()],
    )
    lever, c, k = (
        law.lever(law.force.thrust(known, design), design),
        design.stiffness,
        kappa(design),
    )
    e = true_errors(law, body, force, lever, design)
    mu = lever / (c * k) * applied - smooth_command(e, design)
    mu_thrust = late / c - k * e.d3[2]

    depth_flow, turned = ca.SX.sym("y", 3), QUARTER @ body.rate[:2]
    gain, gyroscopic = (ca.reshape(x, 2, 2) for x in (rotors.angular_gain, rotors.gyroscopic))
    spun = applied + gain @ applied - body.rate[2] * gyroscopic @ turned
    flow = ca.vertcat(
        true_flow(
            body,
            design,
            force=force,
            depth_flow=depth_flow,
            turning=spun,
            thrust_rate=rotors.thrust_gain * late,
        ),
        (QUARTER @ (torque / design.inertia[:3])[:2] - applied) / rotors.lag,
        (asked - late) / rotors.lag,
    )
    state = ca.vertcat(body.vector(), applied, late)
    if law.force.sensed:
        state, flow = ca.vertcat(state, wind), ca.vertcat(flow, -skew(body.rate) @ wind)
    rate = lie_derivative(ca.vertcat(e.vector(), mu, mu_thrust), state, flow)
    rate = ca.vertcat(rate[:11], rotors.lag * rate[11:])
    setting = Setting(
        depth_flow=depth_flow,
        ahead=ahead,
        yaw=body.rate[2],
        goal=law.goal.fixed(design)[2],
        quickness=c * k / lever,
        lever_ratio=law.lever(body.thrust, design) / lever,
        crosswind=(skew(body.rate) @ wind)[2] / lever,
    )
    rotors = replace(rotors, torque=mu, thrust=mu_thrust)
    return LaggedLoop(design, body, wind, e, setting, rotors, rate)
