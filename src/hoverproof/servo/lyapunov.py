"""The Lyapunov function, its derivative, and Σ read off from it (eqs. 32-35)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import casadi as ca

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.linear import lie_derivative, solve_affine
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import Interval
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY, law_of
from hoverproof.servo.variables import Design, Errors, Measurement

ERROR_SIZE = Errors.size()


@dataclass(frozen=True)
class LyapunovForm:
    """-m L̇ as the quadratic form XᵀΣX of the error vector X ∈ R¹¹, with Ω₃ = 0.

    Attributes
    ----------
    design : Design
        Symbols of the design.
    weights : SX
        w, (4, 1): L = ½ Σ wᵢ|δᵢ|².
    Q_lower : SX
        Lower triangle of the symmetric Q, column by column, (6, 1), 1/m.
    f : SX
        f(T), 1/m: see `thrust_factor`.
    errors : SX
        X, (11, 1), symbols.
    dissipation : SX
        -m L̇ in the variables (X, Q, f), (1, 1).
    Sigma : SX
        Σ(Q, f), (11, 11), symmetric.
    flow_weight : SX
        The matrix of u, (3, 11): Q enters Σ as a multiple of uᵀQv alone.
    scaled_velocity : SX
        The matrix of v, (3, 11): V times m/k1, the error that a speed makes.
    """

    design: Design
    weights: ca.SX
    Q_lower: ca.SX
    f: ca.SX
    errors: ca.SX
    dissipation: ca.SX
    Sigma: ca.SX
    flow_weight: ca.SX
    scaled_velocity: ca.SX

    def function(self) -> ca.Function:
        """Return (design, weights, Q's lower triangle by columns, f) ↦ (Σ, u, v)."""
        return ca.Function(
            "Sigma",
            [self.design.vector(), self.weights, self.Q_lower, self.f],
            [self.Sigma, self.flow_weight, self.scaled_velocity],
            ["design", "weights", "Q", "f"],
            ["Sigma", "flow_weight", "scaled_velocity"],
        )


def lyapunov(e: Errors, weights: ca.SX) -> ca.SX:
    """Return L = ½ Σ wᵢ|δᵢ|², (1, 1) (eq. 32 with all wᵢ = 1).

    Parameters
    ----------
    e : Errors
    weights : SX
        w, (4, 1), dimensionless.
    """
    squares = ca.vertcat(*(ca.dot(part, part) for part in (e.d1, e.d2, e.d3, e.d4)))
    return ca.dot(weights, squares) / 2


def thrust_factor(thrust: ca.SX, design: Design, law: Law = HAMEL_MAHONY) -> ca.SX:
    """Return f(T), by which the error rates depend on the thrust, 1/m.

    For the paper's law it is k1 k2 (k1 k2 + k3)/(m (T - c q3*)).

    Parameters
    ----------
    thrust : SX
        T, (1, 1), N.
    design : Design
    law : Law
    """
    numerator, denominator = _thrust_factor_parts(thrust, design, law)
    return numerator / denominator


@cache
def force_function(law: Law = HAMEL_MAHONY) -> ca.Function:
    """Return (design, thrust) ↦ (c, the singular thrust, f(T)): to N, N and 1/m.

    Parameters
    ----------
    law : Law
    """
    d, thrust = law.design.symbols(), ca.SX.sym("T")
    outputs = [d.stiffness, thrust - law.lever(thrust, d), thrust_factor(thrust, d, law)]
    return ca.Function("force", [d.vector(), thrust], outputs)


def thrust_of_factor(f: ca.SX, design: Design, law: Law = HAMEL_MAHONY) -> ca.SX:
    """Return the thrust T, N, at which f(T) has a given value: the inverse of `thrust_factor`.

    Parameters
    ----------
    f : SX
        f(T), (1, 1), 1/m.
    design : Design
    law : Law
    """
    thrust = ca.SX.sym("T")
    numerator, denominator = _thrust_factor_parts(thrust, design, law)
    return solve_affine(denominator - numerator / f, thrust)


def thrust_at(f: Fraction, mission: Mission, wanted: Sequence[Interval]) -> Fraction:
    """Return the thrust T, N, at which f(T) has a given value, with the gains of a mission.

    Parameters
    ----------
    f : Fraction
        f(T), 1/m.
    mission : Mission
    wanted : (3,) of (low, high)
        Box around q* or what stands in its place, whose middle is taken.
    """
    law, factor = law_of(mission), ca.SX.sym("f")
    d, middle = law.design.symbols(), [(low + high) / 2 for low, high in wanted]
    inverse = ca.Function("thrust", [d.vector(), factor], [thrust_of_factor(factor, d, law)])
    (((thrust,),),) = evaluate(inverse, [law.design.values(mission, middle), [f]])
    return Fraction(thrust)


def _thrust_factor_parts(thrust: ca.SX, design: Design, law: Law) -> tuple[ca.SX, ca.SX]:
    return law.turning(design), design.mass * law.lever(thrust, design)


def measurement_of_errors(
    e: ca.SX, thrust: ca.SX, design: Design, law: Law = HAMEL_MAHONY
) -> Measurement:
    """Return the measurement with errors X and thrust T while Ω₃ = 0: inverts the error chain.

    Parameters
    ----------
    e : SX
        X, (11, 1).
    thrust : SX
        T, (1, 1), N.
    design : Design
    law : Law
    """
    z = Measurement.symbols()
    unknown = ca.vertcat(z.centroid, z.velocity, z.gravity_direction, z.rate[:2])
    known = ca.vertcat(thrust, 0)
    chain = ca.substitute(
        law.errors(law.known(z, design), design).vector(),
        ca.vertcat(z.thrust, z.rate[2]),
        known,
    )
    s = solve_affine(chain - e, unknown)
    back = Measurement(s[0:3], s[3:6], s[6:9], ca.vertcat(s[9:11], 0), thrust)
    measured: Measurement = law.known(back, design)
    return measured


@dataclass(frozen=True)
class ErrorDynamics:
    """The closed loop in the error coordinates, Ω₃ = 0.

    Attributes
    ----------
    design : Design
        Symbols of the design.
    errors : SX
        X, (11, 1), symbols.
    f : SX
        f(T), 1/m, symbol.
    depth_flow : SX
        y = QV, (3, 1), 1/s, symbols.
    velocity : SX
        V as a function of X, (3, 1), m/s.
    rate : SX
        Ẋ as a function of (X, f, y), (11, 1), 1/s.
    """

    design: Design
    errors: ca.SX
    f: ca.SX
    depth_flow: ca.SX
    velocity: ca.SX
    rate: ca.SX

    def rate_with_depths(self, Q: ca.SX) -> ca.SX:
        """Return Ẋ with y = QV put in, (11, 1), 1/s, for a Q in 1/m, (3, 3).

        Parameters
        ----------
        Q : SX
            (3, 3), 1/m.
        """
        return ca.substitute(self.rate, self.depth_flow, Q @ self.velocity)


def derive_error_dynamics(law: Law = HAMEL_MAHONY) -> ErrorDynamics:
    """Differentiate the error chain along the closed loop and express the result in the errors.

    Parameters
    ----------
    law : Law
    """
    controller = derive_controller(law)
    z, d = controller.measured, controller.design
    depth_flow = ca.SX.sym("y", 3)
    flow = controller.measured_rate(depth_flow)
    rate = lie_derivative(law.errors(z, d).vector(), z.vector(), flow)
    x, f = ca.SX.sym("X", ERROR_SIZE), ca.SX.sym("f")
    back = measurement_of_errors(x, thrust_of_factor(f, d, law), d, law)
    rate = ca.substitute(rate, z.vector(), back.vector())
    return ErrorDynamics(d, x, f, depth_flow, back.velocity, rate)


def derive_lyapunov_form(dynamics: ErrorDynamics | None = None) -> LyapunovForm:
    """Differentiate L along the closed loop and read Σ off as its quadratic form.

    Parameters
    ----------
    dynamics : ErrorDynamics, optional
        The closed loop of a law; by default that of the paper.
    """
    loop = dynamics or derive_error_dynamics()
    x, d = loop.errors, loop.design
    weights, Q_lower = ca.SX.sym("w", 4), ca.SX.sym("Q", 6)
    L = lyapunov(Errors.from_vector(x), weights)
    flow_weight = -ca.jacobian(lie_derivative(L, x, loop.rate), loop.depth_flow)
    scaled_velocity = d.slowness * loop.velocity
    closed = loop.rate_with_depths(symmetric_matrix(Q_lower))
    dissipation = -d.mass * lie_derivative(L, x, closed)
    return LyapunovForm(
        design=d,
        weights=weights,
        Q_lower=Q_lower,
        f=loop.f,
        errors=x,
        dissipation=dissipation,
        Sigma=at_origin(ca.hessian(dissipation, x)[0] / 2, x),
        flow_weight=at_origin(ca.jacobian(flow_weight, x), x),
        scaled_velocity=at_origin(ca.jacobian(scaled_velocity, x), x),
    )


def linearised_loop(law: Law = HAMEL_MAHONY) -> ca.Function:
    """Return (design, Q, f) ↦ B of Ẋ = B X near the goal: (3, 3) and () to (11, 11).

    Parameters
    ----------
    law : Law
    """
    loop = derive_error_dynamics(law)
    Q = ca.SX.sym("Q", 3, 3)
    B = at_origin(ca.jacobian(loop.rate_with_depths(Q), loop.errors), loop.errors)
    return ca.Function("linearised_loop", [loop.design.vector(), Q, loop.f], [B])


def at_origin(expression: ca.SX, x: ca.SX) -> ca.SX:
    """Return an expression at x = 0.

    Parameters
    ----------
    expression : SX
        Of any shape.
    x : SX
        Symbols in it, (n, 1).
    """
    return ca.substitute(expression, x, ca.SX.zeros(x.shape))


def symmetric_matrix(lower: ca.SX) -> ca.SX:
    """Return the symmetric (3, 3) matrix of a lower triangle, column by column, (6, 1).

    Parameters
    ----------
    lower : SX
        (6, 1).
    """
    return ca.tril2symm(ca.SX(ca.Sparsity.lower(3), lower))
