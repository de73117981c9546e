"""The derivative of Λ = W + ½ Σ aᵢ|δᵢ|² as a quadratic form of Y = (e, δ2, δ3, δ4) ∈ R¹¹.

The goal is axial, q* = q3* e3. W is the natural potential, Σ |P'ᵢ - ξ| + q3* e3ᵀξ less its minimum.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca

from hoverproof.algebra.linear import lie_derivative
from hoverproof.certification.exponential.form import tilted_goal
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.lyapunov import (
    ERROR_SIZE,
    at_origin,
    derive_error_dynamics,
    symmetric_matrix,
    thrust_factor,
)
from hoverproof.servo.variables import Design, Errors, Measurement


@dataclass(frozen=True)
class AxialLoop:
    """The closed loop for a goal straight below, any Ω, in measured quantities.

    Attributes
    ----------
    measured : Measurement
        Symbols.
    design : Design
        Symbols; `goal_centroid` is (0, 0, q3*).
    Q_lower, Q : SX
        Lower triangle, column by column, (6, 1), and the symmetric matrix, (3, 3), 1/m.
    errors : Errors
        δ1…δ4 of the measurement.
    factor : SX
        f(T), (1, 1), 1/m.
    """

    measured: Measurement
    design: Design
    Q_lower: ca.SX
    Q: ca.SX
    errors: Errors
    factor: ca.SX
    _state: ca.SX
    _rate: ca.SX

    def dot(self, value: ca.SX) -> ca.SX:
        """Return the derivative along the motion.

        Parameters
        ----------
        value : SX
            Any shape; a function of the measured quantities.
        """
        return self.axial(lie_derivative(value, self._state, self._rate))

    def axial(self, value: ca.SX) -> ca.SX:
        """Put q1* = q2* = 0.

        Parameters
        ----------
        value : SX
            Any shape.
        """
        return ca.substitute(value, self.design.goal_centroid[:2], ca.SX.zeros(2))


@cache
def axial_loop() -> AxialLoop:
    """Close the loop with the derived controller; no assumption on Ω."""
    law = derive_controller()
    z, d = law.measured, law.design
    lower = ca.SX.sym("Q", 6)
    Q = symmetric_matrix(lower)
    rate = HAMEL_MAHONY.measured_rate(
        z,
        d,
        angular_acceleration=law.angular_acceleration,
        thrust_rate=law.thrust_rate,
        depth_flow=Q @ z.velocity,
    )
    e = HAMEL_MAHONY.errors(z, d)
    axial = [ca.substitute(part, d.goal_centroid[:2], ca.SX.zeros(2)) for part in vars(e).values()]
    f = ca.substitute(thrust_factor(z.thrust, d), d.goal_centroid[:2], ca.SX.zeros(2))
    return AxialLoop(z, d, lower, Q, Errors(*axial), f, z.vector(), rate)


@dataclass(frozen=True)
class AttractionForm:
    """-(m/k1) Λ̇ as a quadratic form of Y = (e, δ2, δ3, δ4).

    Attributes
    ----------
    design : Design
        Symbols; of `goal_centroid` only q3* is used.
    weights : SX
        a2, a3, a4, (3, 1).
    Q_lower, Q : SX
        Lower triangle of Q, (6, 1), and Q, (3, 3), 1/m.
    f : SX
        f(T), 1/m.
    theta : SX
        θ = Pρ/(1 + ρ3), (2, 1).
    errors : SX
        Y, (11, 1), symbols.
    dissipation : SX
        -(m/k1) Λ̇ in these variables, (1, 1).
    without_Q : SX
        The matrix of the terms without Q, (11, 11), symmetric.
    flow_weight, scaled_velocity : SX
        The matrices of u and v, (3, 11): Q enters as uᵀQv alone.
    """

    design: Design
    weights: ca.SX
    Q_lower: ca.SX
    Q: ca.SX
    f: ca.SX
    theta: ca.SX
    errors: ca.SX
    dissipation: ca.SX
    without_Q: ca.SX
    flow_weight: ca.SX
    scaled_velocity: ca.SX

    def function(self) -> ca.Function:
        """Return (design, weights, f, θ) ↦ (terms without Q, u, v)."""
        return ca.Function(
            "attraction",
            [self.design.vector(), self.weights, self.f, self.theta],
            [self.without_Q, self.flow_weight, self.scaled_velocity],
            ["design", "weights", "f", "theta"],
            ["without_Q", "flow_weight", "scaled_velocity"],
        )


def half_squares(weights: ca.SX, e: Errors) -> ca.SX:
    """Return ½(a2|δ2|² + a3|δ3|² + a4|δ4|²), (1, 1).

    Parameters
    ----------
    weights : SX
        a2, a3, a4, (3, 1), m.
    e : Errors
    """
    squares = ca.vertcat(*(ca.dot(part, part) for part in (e.d2, e.d3, e.d4)))
    return ca.dot(weights, squares) / 2


@cache
def derive_form() -> AttractionForm:
    """Differentiate Λ along the derived closed loop in the errors, and put δ1 = e + η."""
    loop = derive_error_dynamics()
    d, x = loop.design, loop.errors
    weights, lower, theta = ca.SX.sym("a", 3), ca.SX.sym("Q", 6), ca.SX.sym("theta", 2)
    Y = ca.SX.sym("Y", ERROR_SIZE)
    part = Errors.from_vector(Y)  # its first is e
    back = ca.vertcat(part.d1 + tilted_goal(HAMEL_MAHONY, d, theta, part), Y[3:])
    e = Errors.from_vector(x)
    energy = half_squares(weights, e)
    rate = lie_derivative(energy, x, loop.rate)  # without the potential, whose rate is -eᵀV

    def put(value: ca.SX) -> ca.SX:
        return ca.substitute(
            value,
            ca.vertcat(x, d.goal_centroid[:2]),
            ca.vertcat(back, ca.SX.zeros(2)),
        )

    scale = d.mass / d.k1
    velocity = put(loop.velocity)
    u = -scale * ca.jacobian(ca.jacobian(put(rate), loop.depth_flow), Y) / scale
    v = scale * ca.jacobian(velocity, Y)
    still = scale * ca.dot(part.d1, velocity) - scale * put(
        ca.substitute(rate, loop.depth_flow, ca.SX.zeros(3))
    )
    Q = symmetric_matrix(lower)
    u, v = at_origin(u, Y), at_origin(v, Y)
    hessian, _ = ca.hessian(still, Y)
    return AttractionForm(
        design=d,
        weights=weights,
        Q_lower=lower,
        Q=Q,
        f=loop.f,
        theta=theta,
        errors=Y,
        dissipation=still + (u @ Y).T @ Q @ (v @ Y),
        without_Q=at_origin(hessian, Y) / 2,
        flow_weight=u,
        scaled_velocity=v,
    )
