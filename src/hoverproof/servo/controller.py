"""The controller, solved for from the error dynamics it must bring about (eqs. 20, 30, 31)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from hoverproof.algebra.linear import is_zero, lie_derivative, solve_affine
from hoverproof.plant.rigid_body import skew, torque_balance
from hoverproof.servo.error_chain import (
    Design,
    Errors,
    Measurement,
    errors,
    horizontal,
    measured_rate,
)


@dataclass(frozen=True)
class Controller:
    """The control law as a graph over its own symbols.

    Attributes
    ----------
    measured : Measurement
        Symbols of the measurements.
    design : Design
        Symbols of the design.
    thrust_rate : SX
        U, (1, 1), N/s.
    angular_acceleration : SX
        Ω̇, (3, 1), rad/s²: what the torque brings about.
    torque : SX
        Γ, (3, 1), body frame, N m.
    """

    measured: Measurement
    design: Design
    thrust_rate: ca.SX
    angular_acceleration: ca.SX
    torque: ca.SX

    def function(self) -> ca.Function:
        """Return (measurement, design) ↦ (U, Γ): vectors (13,), (13,) to (1,), (3,)."""
        return ca.Function(
            "controller",
            [self.measured.vector(), self.design.vector()],
            [self.thrust_rate, self.torque],
            ["measured", "design"],
            ["thrust_rate", "torque"],
        )


def wanted_error_rates(
    e: Errors, rate: ca.SX, design: Design, depth_flow: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """Return the wanted e₃ row of δ̇3 (1, 1) and δ̇4 (2, 1), in 1/s.

    The depth flow stands for (k1/m) Q (δ1 + δ2) = QV; the choice of δ̇4 makes the cross terms of
    δ3 and δ4 cancel in the derivative of |δ3|² + |δ4|².

    Parameters
    ----------
    e : Errors
    rate : SX
        Ω, (3, 1), body frame, rad/s.
    design : Design
    depth_flow : SX
        y = QV, (3, 1), 1/s.
    """
    d = design
    k12 = d.k1 * d.k2
    d3_rate = -skew(rate) @ e.d3 + depth_flow - (k12 * e.d2 + d.k3 * e.d3) / d.mass
    d4_rate = horizontal(depth_flow) - ((k12 + d.k3) * horizontal(e.d3) + d.k4 * e.d4) / d.mass
    return d3_rate[2], d4_rate


def derive_controller() -> Controller:
    """Solve for U and Γ, all parameters symbolic, and make sure that no depth is in them.

    Raises
    ------
    AssertionError
        If the unknown depths do not drop out of the equations to be solved.
    """
    z, d = Measurement.symbols(), Design.symbols()
    thrust_rate = ca.SX.sym("U")
    alpha = ca.SX.sym("alpha", 3)
    depth_flow = ca.SX.sym("y", 3)
    e = errors(z, d)
    flow = measured_rate(
        z, d, angular_acceleration=alpha, thrust_rate=thrust_rate, depth_flow=depth_flow
    )

    d3_wanted, d4_wanted = wanted_error_rates(e, z.rate, d, depth_flow)
    residual_3 = lie_derivative(e.d3, z.vector(), flow)[2] - d3_wanted
    residual_4 = lie_derivative(e.d4, z.vector(), flow) - d4_wanted

    solved_rate = solve_affine(_without_depth(residual_3, depth_flow), thrust_rate)
    yaw = -d.k_yaw / d.inertia[2] * z.rate[2]
    residual_4 = ca.substitute(
        _without_depth(residual_4, depth_flow),
        ca.vertcat(thrust_rate, alpha[2]),
        ca.vertcat(solved_rate, yaw),
    )
    acceleration = ca.vertcat(solve_affine(residual_4, alpha[:2]), yaw)

    torque = ca.SX.sym("Gamma", 3)
    solved_torque = solve_affine(torque_balance(z.rate, acceleration, d.inertia, torque), torque)
    return Controller(z, d, solved_rate, acceleration, solved_torque)


def _without_depth(residual: ca.SX, depth_flow: ca.SX) -> ca.SX:
    """Drop the depth flow from an equation in which its coefficient is literally zero."""
    if not is_zero(ca.jacobian(residual, depth_flow)):
        raise AssertionError("the controller would need the depths")
    return ca.substitute(residual, depth_flow, ca.SX.zeros(3))
