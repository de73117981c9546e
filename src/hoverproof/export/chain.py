"""The law in the variables in which it is short: a chain of quadratic polynomials."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca

from hoverproof.algebra.linear import lie_derivative, solve_affine
from hoverproof.export.closed_form import closed_forms
from hoverproof.plant import rigid_body
from hoverproof.plant.rate_loop import rate_command
from hoverproof.servo.controller import Controller, derive_controller
from hoverproof.servo.law import Law
from hoverproof.servo.variables import Design, Measurement


@dataclass(frozen=True)
class Chain:
    """The law as a chain of quadratic polynomials, each over the results before it.

    Names that end in ``_of``, and those of commands, are the polynomials; the others are the
    symbols that these are in.

    Attributes
    ----------
    design : SX
        Symbols: the vector of `parts`, then arm, drag ratio and rate bandwidth, (k, 1).
    parts : Design
        Of the law, symbols.
    arm, drag : SX
        Of the rotors, (1, 1), m; see `hoverproof.plant.rotors.wrench`.
    bandwidth : SX
        ω_r of an autopilot's rate loop, (1, 1), rad/s.
    sensors : dict of str to SX
        What is taken in of the body, each (3, 1); a heading is (2, 1).
    excess : SX
        T - m g of the thrust that is commanded, (1, 1), N.
    image_error, tilt : SX
        q - q* and ρ - e₃, (3, 1).
    felt, felt_of : SX
        What is measured besides, less what that is in hover, (m, 1), m/s².
    lift, lift_of : SX
        T - m g of the thrust that the law knows, (1, 1), N; `excess` itself if it is that.
    drift, drift_of : SX
        Ṫ - U of that thrust, (1, 1), N/s.
    d2, d2_of : SX
        δ2, (3, 1).
    s, s_of : SX
        κ δ3, (3, 1), N/s.
    acceleration : SX
        Ω̇, (3, 1), rad/s².
    thrust_rate : SX
        U, (1, 1), N/s.
    direct, divided : SX
        The horizontal Ω̇ is direct + divided/gap, (2, 1), rad/s² and N rad/s².
    gap : SX
        The lever of the law, as T - c q3*, (1, 1), N.
    singular : SX
        The lift at which it vanishes, (1, 1), N.
    yaw : SX
        Ω̇3, (1, 1), rad/s².
    torque : SX
        Γ, (3, 1), N m.
    rate_command : SX
        Ω_c = Ω + Ω̇/ω_r, (3, 1), rad/s.
    """

    design: ca.SX
    parts: Design
    arm: ca.SX
    drag: ca.SX
    bandwidth: ca.SX
    sensors: dict[str, ca.SX]
    excess: ca.SX
    image_error: ca.SX
    tilt: ca.SX
    felt: ca.SX
    lift: ca.SX
    drift: ca.SX
    d2: ca.SX
    s: ca.SX
    acceleration: ca.SX
    felt_of: ca.SX
    lift_of: ca.SX
    drift_of: ca.SX
    d2_of: ca.SX
    s_of: ca.SX
    thrust_rate: ca.SX
    direct: ca.SX
    divided: ca.SX
    gap: ca.SX
    singular: ca.SX
    yaw: ca.SX
    torque: ca.SX
    rate_command: ca.SX

    @property
    def measures_thrust(self) -> bool:
        """Whether the law's thrust is measured, and not the one commanded."""
        return self.lift is not self.excess


_BODY_SENSORS = ("velocity", "rate", "gravity_direction")
"""What every law takes in of the body, each (3,), in the firmware's own order."""


def body_sensors(law: Law) -> tuple[str, ...]:
    """Return the names of what firmware takes in of the body for a law, in its order.

    Parameters
    ----------
    law : Law
    """
    return (*_BODY_SENSORS, *_besides(law), *(() if law.heading is None else ("heading",)))


def _besides(law: Law) -> list[str]:
    """Return the names of what a law measures of the force, besides what every law measures."""
    return [name for name in law.force.measurement.sizes() if name not in Measurement.sizes()]


@cache
def chain_of(law: Law) -> Chain:
    """Put the derived controller into the variables δ2, s = κ δ3, Ω and T - m g.

    κ is the coefficient of δ3 in U. Over the gap T - c q3* the horizontal Ω̇ is affine plus a
    fraction: its numerator is divided by the gap as polynomials in T.

    Parameters
    ----------
    law : Law
    """
    controller = derive_controller(law)
    z, d = controller.measured, controller.design
    weight = d.mass * d.gravity
    d1, d2, d3, s, tilt = (ca.SX.sym(n, 3) for n in ("image_error", "d2", "d3", "s", "tilt"))
    excess, alpha = ca.SX.sym("thrust_excess"), ca.SX.sym("alpha", 3)
    besides, at_hover = _measured_besides(z, d, law, weight)
    felt = ca.SX.sym("felt", besides.shape[0])
    lift = ca.SX.sym("lift") if _besides(law) else excess
    drift, drift_of = ca.SX.sym("drift"), _drift(controller)
    thrust, e = weight + lift, law.errors(z, d)

    commands = _by_errors(controller, thrust, ca.vertcat(d1, d2, d3), drift, drift_of)
    scale = ca.jacobian(commands[0], d3[2])
    old, new = ca.vertcat(d1, d3), ca.vertcat(ca.SX.zeros(3), s / scale)  # δ1 is in δ2 and δ3 alone
    rate_of_thrust, turn = ca.substitute(commands, [old], [new])

    gap = law.lever(thrust, d)
    numerator = turn[:2] * gap
    direct = ca.jacobian(numerator, lift)
    shifted = ca.vertcat(z.centroid, z.gravity_direction, z.thrust, besides)
    hover = [d1 + d.goal_centroid, tilt + rigid_body.E3, weight + excess, felt + at_hover]
    of = [e.d2, e.d3, law.force.thrust(z, d), drift_of]
    d2_of, d3_of, thrust_of, drift_of = ca.substitute(of, [shifted], [ca.vertcat(*hover)])
    torque = ca.SX.sym("torque", 3)
    balance = rigid_body.torque_balance(z.rate, alpha, d.inertia, torque)
    arm, drag, bandwidth = (ca.SX.sym(n) for n in ("arm", "drag_ratio", "rate_bandwidth"))
    return Chain(
        design=ca.vertcat(d.vector(), arm, drag, bandwidth),
        parts=d,
        arm=arm,
        drag=drag,
        bandwidth=bandwidth,
        sensors={name: getattr(z, name) for name in body_sensors(law)},
        excess=excess,
        image_error=d1,
        tilt=tilt,
        felt=felt,
        lift=lift,
        drift=drift,
        d2=d2,
        s=s,
        acceleration=alpha,
        felt_of=besides - at_hover,
        lift_of=thrust_of - weight,
        drift_of=drift_of,
        d2_of=d2_of,
        s_of=scale * (d3_of - d2_of + d2),
        thrust_rate=rate_of_thrust,
        direct=direct,
        divided=numerator - direct * gap,
        gap=gap,
        singular=solve_affine(gap, lift),
        yaw=turn[2],
        torque=solve_affine(balance, torque),
        rate_command=rate_command(z.rate, alpha, bandwidth),
    )


def _by_errors(
    controller: Controller, thrust: ca.SX, errors: ca.SX, drift: ca.SX, drift_of: ca.SX
) -> list[ca.SX]:
    """Return U and Ω̇ in the errors, the thrust and its drift; a symbol stands for the last.

    What a law measures besides acts through these alone. So it may be what it ideally is at this
    thrust, where nothing drifts; what the drift adds is read off the way in which it comes in.
    """
    z, d, law = controller.measured, controller.design, controller.law
    e = law.errors(z, d)
    unknown = ca.vertcat(z.centroid, z.velocity, z.gravity_direction)
    back = solve_affine(ca.vertcat(e.d1, e.d2, e.d3) - errors, unknown)
    besides, ideal = _measured_besides(z, d, law, thrust)
    old, new = ca.vertcat(z.thrust, besides), ca.vertcat(thrust, ideal)
    commands = [controller.thrust_rate, controller.angular_acceleration]
    free = ca.substitute(commands, [unknown], [back])
    rate_of_thrust, turn = ca.substitute(free, [old], [new])
    if _besides(law):
        way = ca.jacobian(drift_of, besides).T
        slope = ca.substitute(ca.jacobian(free[1], besides) @ way / ca.sumsqr(way), old, new)
        turn += drift * ca.vertcat(*(form.value for form in closed_forms(slope)))
    return [rate_of_thrust, turn]


def _drift(controller: Controller) -> ca.SX:
    """Return what the thrust that a law knows changes by besides U, (1, 1), N/s."""
    z, law = controller.measured, controller.law
    none = ca.SX.zeros(3)
    flow = law.measured_rate(
        z, controller.design, angular_acceleration=none, thrust_rate=ca.SX(0), depth_flow=none
    )
    return lie_derivative(law.force.thrust(z, controller.design), z.vector(), flow)


def _measured_besides(z: Measurement, d: Design, law: Law, thrust: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return what a law measures besides, and what that ideally is at a thrust, (m, 1) each."""
    plain = {name: getattr(z, name) for name in Measurement.sizes()}
    ideal = law.force.ideal(Measurement(**{**plain, "thrust": thrust}), d)
    columns = [[getattr(of, name) for name in _besides(law)] for of in (z, ideal)]
    return ca.vertcat(ca.SX(0, 1), *columns[0]), ca.vertcat(ca.SX(0, 1), *columns[1])
