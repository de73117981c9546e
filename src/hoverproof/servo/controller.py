"""The controller, solved for from the error dynamics it must bring about (eqs. 20, 30, 31)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from hoverproof.algebra.linear import is_zero, lie_derivative, solve_affine
from hoverproof.errors import InputError
from hoverproof.plant.rigid_body import torque_balance
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.variables import Design, Measurement


@dataclass(frozen=True)
class Controller:
    """The controller of a law as a graph over its own symbols.

    Attributes
    ----------
    law : Law
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

    law: Law
    measured: Measurement
    design: Design
    thrust_rate: ca.SX
    angular_acceleration: ca.SX
    torque: ca.SX

    def function(self) -> ca.Function:
        """Return (measurement, design) ↦ (U, Γ), each packed as the law lays it out."""
        return ca.Function(
            "controller",
            [self.measured.vector(), self.design.vector()],
            [self.thrust_rate, self.torque],
            ["measured", "design"],
            ["thrust_rate", "torque"],
        )

    def measured_rate(self, depth_flow: ca.SX) -> ca.SX:
        """Return the time derivative of the packed measurement in the closed loop.

        Parameters
        ----------
        depth_flow : SX
            y = QV, (3, 1), 1/s.
        """
        return self.law.measured_rate(
            self.measured,
            self.design,
            angular_acceleration=self.angular_acceleration,
            thrust_rate=self.thrust_rate,
            depth_flow=depth_flow,
        )


def derive_controller(law: Law = HAMEL_MAHONY) -> Controller:
    """Solve for U and Γ, all parameters symbolic, and make sure that no depth is in them.

    Parameters
    ----------
    law : Law

    Raises
    ------
    InputError
        If the unknown depths do not drop out of the equations to be solved.
    """
    z, d = law.measurement.symbols(), law.design.symbols()
    thrust_rate = ca.SX.sym("U")
    alpha = ca.SX.sym("alpha", 3)
    depth_flow = ca.SX.sym("y", 3)
    e = law.errors(z, d)
    flow = law.measured_rate(
        z, d, angular_acceleration=alpha, thrust_rate=thrust_rate, depth_flow=depth_flow
    )

    wanted = law.wanted_rates(e, z, d, depth_flow)
    if law.heading is not None:
        wanted = replace(wanted, yaw=wanted.yaw + law.heading.turning(z, d))
    residual_3 = lie_derivative(e.d3, z.vector(), flow)[2] - wanted.d3_vertical
    residual_4 = lie_derivative(e.d4, z.vector(), flow) - wanted.d4

    solved_rate = solve_affine(_without_depth(residual_3, depth_flow, law), thrust_rate)
    residual_4 = ca.substitute(
        _without_depth(residual_4, depth_flow, law),
        ca.vertcat(thrust_rate, alpha[2]),
        ca.vertcat(solved_rate, wanted.yaw),
    )
    acceleration = ca.vertcat(solve_affine(residual_4, alpha[:2]), wanted.yaw)

    torque = ca.SX.sym("Gamma", 3)
    solved_torque = solve_affine(torque_balance(z.rate, acceleration, d.inertia, torque), torque)
    return Controller(law, z, d, solved_rate, acceleration, solved_torque)


def _without_depth(residual: ca.SX, depth_flow: ca.SX, law: Law) -> ca.SX:
    """Drop the depth flow from an equation in which its coefficient is literally zero."""
    if not is_zero(ca.jacobian(residual, depth_flow)):
        raise InputError(
            law.name,
            "wanted_rates",
            "its wanted rates would need a controller that knows the depths",
        )
    return ca.substitute(residual, depth_flow, ca.SX.zeros(3))
