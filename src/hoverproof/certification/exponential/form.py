"""How the squares of the errors of an uncertain vehicle fall, as quadratic forms, from the graph.

Besides the errors δ of `servo.uncertain`, the forms have as variables the depth flow y = J V, what
the feature that is used is ahead of the present one, n, and for rotors that follow with a lag τ
what their torque and thrust are ahead of the smooth part of the command:

    μ = s_a - s_n, s_n = -(κ + k4/m) δ4 - (k1 k2/m) P(δ3 - δ2),   μT = U_a/c - κ δ3z,

s_a and U_a being what the rotors do. In

    E = ½ Σ wᵢ|δᵢ|² + ½ τ (a5 |μ|² + a6 μT²)

the lag is a factor, so that its derivative is affine in τ, and a lag of zero is none. With the
natural potential W of the centroid q, of which W' = -eᵀV, e = q - q3 ρ, that stands in place of
½ w1 |δ1|², and e in place of δ1 = e + η,

    η = (q3 c/(m g)) (P - e3 θᵀ)(δ3 - δ2),   θ = Pρ/(1 + ρ3),

for a goal that is fixed in the image, without wind, and η = 0 for an inertial one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from hoverproof.algebra.derived import kept_graph
from hoverproof.plant.rigid_body import E3
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import horizontal
from hoverproof.servo.layout import Packed, column, scalar
from hoverproof.servo.true_vehicle import kappa
from hoverproof.servo.uncertain import Doubt, Motion, command, error_rates
from hoverproof.servo.variables import Design, Errors


@dataclass(frozen=True)
class Weights(Packed):
    """What E is made of besides w1 = 1, or W; every field is an SX.

    Attributes
    ----------
    d2, d3, d4 : SX
        w2, w3, w4, (1, 1).
    torque, thrust : SX
        a5, s², and a6, s², (1, 1).
    """

    d2: ca.SX = scalar("1")
    d3: ca.SX = scalar("1")
    d4: ca.SX = scalar("1")
    torque: ca.SX = scalar("s²")
    thrust: ca.SX = scalar("s²")


@dataclass(frozen=True)
class Vertex(Packed):
    """What is in doubt and appears in the forms; they are affine in each.

    Attributes
    ----------
    lever_ratio, quickness, thrust_gain : SX
        χ, h in 1/s, and ς; see `servo.uncertain`.
    lag : SX
        τ, s.
    swing : SX
        π = 2 (p1 - p2) + p3, 1/s.
    lean : SX
        The first of θ, (1, 1), the other is 0: with the potential it matters how the vehicle leans.
    """

    lever_ratio: ca.SX = scalar("1")
    quickness: ca.SX = scalar("1/s")
    thrust_gain: ca.SX = scalar("1")
    lag: ca.SX = scalar("s")
    swing: ca.SX = scalar("1/s")
    lean: ca.SX = scalar("1")


@dataclass(frozen=True)
class Variables(Packed):
    """The variables of the forms; every field is an SX.

    Attributes
    ----------
    errors : SX
        δ1 to δ4, (11, 1); with the potential e in place of δ1.
    flow : SX
        y, (3, 1), 1/s.
    ahead : SX
        n, (3, 1).
    torque, thrust : SX
        μ, (2, 1), 1/s², and μT, (1, 1), 1/s.
    """

    errors: ca.SX = column("1", 11)
    flow: ca.SX = column("1/s")
    ahead: ca.SX = column("1")
    torque: ca.SX = column("1/s²", 2)
    thrust: ca.SX = scalar("1/s")


@dataclass(frozen=True)
class Push(Packed):
    """What the norm-bounded terms add to rates; every field is an SX.

    Attributes
    ----------
    d4 : SX
        To δ4', (2, 1).
    torque : SX
        To τ μ', (2, 1).
    lift : SX
        To τ μT', (1, 1).
    """

    d4: ca.SX = column("1/s", 2)
    torque: ca.SX = column("1/s²", 2)
    lift: ca.SX = scalar("1/s")


ROWS = {
    **{"fall": 20, "energy": 20, "d4": 2, "torque": 2, "lift": 1},
    **{"applied": 2, "zeta": 2, "ahead": 2, "h3": 2, "missed": 2, "pulled": 2, "sum": 3},
}
"""The matrices of the forms, one above the other, and how many rows each has: -E' without the
norm-bounded terms, and 2 E; what each push adds to E'; then s or s_a, ζ, P n, P δ3, P(δ3 - n),
P(δ3 - δ2) and δ1 + δ2."""


def tilted_goal(law: Law, design: Design, theta: ca.SX, e: Errors) -> ca.SX:
    """Return η = s3 (ρ - e3), (3, 1), s3 of what is fixed in the image.

    Parameters
    ----------
    law : Law
    design : Design
    theta : SX
        θ = Pρ/(1 + ρ3), (2, 1).
    e : Errors
        Of a vehicle without wind.
    """
    goal = law.goal.fixed(design)[2]
    to_tilt = ca.SX.eye(3) - E3 @ (E3 + ca.vertcat(theta, 0)).T  # P - e3 θᵀ
    return goal * design.stiffness / (design.mass * design.gravity) * to_tilt @ (e.d3 - e.d2)


@kept_graph
def derive_form(law: Law, lagged: bool, potential: bool = False) -> ca.Function:
    """Return (design, vertex, weights) ↦ the matrices of `ROWS`, one above the other, (62, 20).

    Parameters
    ----------
    law : Law
    lagged : bool
        Whether rotors lag; without lag the last three variables have no part in it.
    potential : bool
        Whether the natural potential is in place of ½ |δ1|²; 2 E is without it.
    """
    d, at, w = law.design.symbols(), Vertex.symbols(), Weights.symbols()
    x, push = Variables.symbols(), Push.symbols()
    e = Errors.from_vector(x.errors)
    if potential:
        e = replace(e, d1=e.d1 + tilted_goal(law, d, ca.vertcat(at.lean, 0), e))
    motion = Motion(
        depth_flow=x.flow,
        rate=ca.SX.zeros(3),  # what turns all errors alike does not change their squares
        goal=law.goal.fixed(d)[2],
        quickness=at.quickness,
        sinking=at.swing / 2,
        sinking_by_error=ca.SX(0),
        crosswind=ca.SX(0),
    )
    doubt = replace(
        Doubt.none(),
        thrust_gain=at.thrust_gain,
        lever_ratio=at.lever_ratio,
        lever_drift=(at.thrust_gain - 1) * at.swing / 2,
        feature=x.ahead,
    )
    rates = error_rates(e, motion, doubt, d)
    asked = applied = command(e, motion, doubt, d)
    torque_rate, thrust_rate = ca.SX.zeros(2), ca.SX.zeros(1)
    to_d4 = ca.vertcat(ca.SX.zeros(9, 2), ca.SX.eye(2))
    if lagged:
        smooth = command(e, replace(motion, sinking=ca.SX(0)), Doubt.none(), d)
        applied = smooth + x.torque
        lift = kappa(d) * (e.d3[2] - x.ahead[2])
        lifted = kappa(d) * e.d3[2] + x.thrust
        rates += to_d4 @ (applied - asked)
        rates[8] -= at.thrust_gain * (lifted - lift)
    rates += to_d4 @ push.d4
    if lagged:
        smooth_rate = ca.jtimes(smooth, x.errors, rates)
        torque_rate = asked - applied + push.torque - at.lag * smooth_rate
        thrust_rate = lift - lifted - at.lag * kappa(d) * rates[8] + push.lift
    first = ca.SX(0 if potential else 1)
    sizes = ca.vertcat(
        *(
            ca.repmat(ca.SX(x), n)
            for x, n in zip((first, w.d2, w.d3, w.d4), (3, 3, 3, 2), strict=True)
        )
    )
    change = (
        ca.dot(sizes * x.errors, rates)
        - (1 - first) * ca.dot(x.errors[:3], e.d1 + e.d2) / d.slowness
        + w.torque * ca.dot(x.torque, torque_rate)
        + w.thrust * x.thrust * thrust_rate
    )
    squares = ca.dot(sizes * x.errors, x.errors) + at.lag * (
        w.torque * ca.dot(x.torque, x.torque) + w.thrust * x.thrust**2
    )
    X, P = x.vector(), push.vector()
    calm = ca.substitute(change, P, ca.SX.zeros(P.shape))
    pushes = ca.jacobian(ca.gradient(change, P), X)
    matrices = [-ca.hessian(calm, X)[0] / 2, ca.hessian(squares, X)[0] / 2]
    matrices += [pushes[Push.place(name), :] for name in Push.sizes()]
    n, h3 = horizontal(x.ahead), horizontal(e.d3)
    parts = [applied, e.d4 - h3, n, h3, h3 - n, h3 - horizontal(e.d2), e.d1 + e.d2]
    matrices += [ca.jacobian(part, X) for part in parts]
    return ca.Function(
        "falls",
        [d.vector(), at.vector(), w.vector()],
        [ca.densify(ca.vertcat(*matrices))],
        ["design", "vertex", "weights"],
        ["matrices"],
    )
