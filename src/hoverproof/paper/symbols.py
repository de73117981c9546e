"""The symbols of the paper, their units, and what they stand for in the derived model."""

from __future__ import annotations

from fractions import Fraction

import casadi as ca

from hoverproof.algebra.linear import lie_derivative
from hoverproof.paper.notation import Formula, Number, Skew, SquaredNorm, Symbol, Unit, World
from hoverproof.plant import rigid_body
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.lyapunov import lyapunov, symmetric_matrix, thrust_factor
from hoverproof.servo.variables import Design, Measurement

ONE = Unit()
KG, M, S = Unit(kg=Fraction(1)), Unit(m=Fraction(1)), Unit(s=Fraction(1))
NEWTON = KG * M / S**2


def number(value: int | Fraction) -> Number:
    """Return an exact number as a formula.

    Parameters
    ----------
    value : int or Fraction
        An exact number.
    """
    return Number(Fraction(value))


def sk(a: Formula) -> Formula:
    """Return sk(a).

    Parameters
    ----------
    a : Formula
    """
    return Skew(a)


def sq(a: Formula) -> Formula:
    """Return |a|².

    Parameters
    ----------
    a : Formula
    """
    return SquaredNorm(a)


m, g = Symbol("m", "m", KG), Symbol("g", "g", M / S**2)
k1, k2 = Symbol("k1", "k_1", KG * M / S), Symbol("k2", "k_2", M**-1)
k3, k4 = Symbol("k3", "k_3", KG / S), Symbol("k4", "k_4", KG / S)
k_Omega = Symbol("kΩ", r"k_\Omega", KG * M**2 / S)
inertia = Symbol("𝐈", r"\mathbf{I}", KG * M**2)
inertia_inverse = Symbol("𝐈⁻¹", r"\mathbf{I}^{-1}", KG**-1 * M**-2)
q, q_star = Symbol("q", "q", ONE), Symbol("q*", "q^*", ONE)
q3_star = Symbol("q3*", "q_3^*", ONE)
Q = Symbol("Q", "Q", M**-1)
V, Omega = Symbol("V", "V", M / S), Symbol("Ω", r"\Omega", S**-1)
Omega3 = Symbol("Ω3", r"\Omega_3", S**-1)
V_rate, Omega_rate = Symbol("V̇", r"\dot V", M / S**2), Symbol("Ω̇", r"\dot\Omega", S**-2)
q_rate = Symbol("q̇", r"\dot q", S**-1)
R_T_e3 = Symbol("Rᵀe3", "R^Te_3", ONE)
e3, pi, identity_matrix = (
    Symbol("e3", "e_3", ONE),
    Symbol("π", r"\pi_{e_3}", ONE),
    Symbol("I", "I", ONE),
)
F, T = Symbol("F", "F", NEWTON), Symbol("T", "T", NEWTON)
T_rate, U = Symbol("Ṫ", r"\dot T", NEWTON / S), Symbol("U", "U", NEWTON / S)
Gamma = Symbol("Γ", r"\Gamma", NEWTON * M)
Gamma3 = Symbol("Γ3", r"\Gamma_3", NEWTON * M)
d1, d2 = Symbol("δ1", r"\delta_1", ONE), Symbol("δ2", r"\delta_2", ONE)
d3, d4 = Symbol("δ3", r"\delta_3", ONE), Symbol("δ4", r"\delta_4", ONE)
d1_rate, d2_rate = Symbol("δ̇1", r"\dot\delta_1", S**-1), Symbol("δ̇2", r"\dot\delta_2", S**-1)
d3_rate, d4_rate = Symbol("δ̇3", r"\dot\delta_3", S**-1), Symbol("δ̇4", r"\dot\delta_4", S**-1)
f, A = Symbol("f(T)", "f(T)", M**-1), Symbol("A", "A", ONE)
L, L_rate = Symbol("L", r"\mathcal{L}", ONE), Symbol("L̇", r"\dot{\mathcal{L}}", S**-1)
d1_square_rate = Symbol("d|δ1|²/dt", r"\tfrac{d}{dt}|\delta_1|^2", S**-1)


def _world(z: Measurement, d: Design, *, alpha: ca.SX, thrust_rate: ca.SX, torque: ca.SX) -> World:
    """Return the value of every symbol along the motion with Ω̇ = alpha and Ṫ = thrust_rate."""
    lower = ca.SX.sym("Q", 6)
    depth = symmetric_matrix(lower)
    flow = HAMEL_MAHONY.measured_rate(
        z,
        d,
        angular_acceleration=alpha,
        thrust_rate=thrust_rate,
        depth_flow=depth @ z.velocity,
    )
    e = HAMEL_MAHONY.errors(z, d)
    delta = [e.d1, e.d2, e.d3, ca.vertcat(e.d4, 0)]
    energy = lyapunov(e, ca.SX.ones(4))
    square = ca.dot(e.d1, e.d1)

    def rate(x: ca.SX) -> ca.SX:
        return lie_derivative(x, z.vector(), flow)

    moments = ca.diag(d.inertia)
    values = {
        **{"m": d.mass, "g": d.gravity, "k1": d.k1, "k2": d.k2, "k3": d.k3, "k4": d.k4},
        **{"kΩ": d.k_yaw, "𝐈": moments, "𝐈⁻¹": ca.diag(1 / d.inertia)},
        **{"q": z.centroid, "q*": d.goal_centroid, "q3*": d.goal_centroid[2], "Q": depth},
        **{"V": z.velocity, "Ω": z.rate, "Ω3": z.rate[2], "Rᵀe3": z.gravity_direction},
        **{"V̇": rate(z.velocity), "Ω̇": alpha, "q̇": rate(z.centroid)},
        **{"e3": rigid_body.E3, "π": ca.diag(ca.SX([1, 1, 0])), "I": ca.SX.eye(3)},
        "F": rigid_body.force(z.thrust, z.gravity_direction, d.mass, d.gravity),
        **{"T": z.thrust, "Ṫ": thrust_rate, "U": thrust_rate, "Γ": torque, "Γ3": torque[2]},
        **{f"δ{i + 1}": x for i, x in enumerate(delta)},
        **{f"δ̇{i + 1}": rate(x) for i, x in enumerate(delta)},
        **{"f(T)": thrust_factor(z.thrust, d), "L": energy, "L̇": rate(energy)},
        "d|δ1|²/dt": rate(square),
    }
    values["A"] = -ca.skew(values["q*"]) @ ca.skew(values["e3"])
    return values


def any_motion() -> World:
    """Return the world in which Ω̇ and U are free: what holds here holds for any controller."""
    z, d = Measurement.symbols(), Design.symbols()
    alpha, thrust_rate = ca.SX.sym("Omega_dot", 3), ca.SX.sym("U")
    torque = ca.diag(d.inertia) @ alpha + ca.skew(z.rate) @ (ca.diag(d.inertia) @ z.rate)
    return _world(z, d, alpha=alpha, thrust_rate=thrust_rate, torque=torque)


def no_yaw_motion() -> World:
    """Return the same world with Ω3 = 0 kept: the third components of Ω and Ω̇ are zero."""
    world = any_motion()
    third = ca.vertcat(world["Ω"][2], world["Ω̇"][2])
    return {name: ca.substitute(x, third, ca.SX.zeros(2)) for name, x in world.items()}


def closed_loop() -> World:
    """Return the world in which the derived controller flies, yaw rate included."""
    law = derive_controller()
    return _world(
        law.measured,
        law.design,
        alpha=law.angular_acceleration,
        thrust_rate=law.thrust_rate,
        torque=law.torque,
    )


def closed_loop_no_yaw() -> World:
    """Return the closed loop with Ω3 = 0, which the controller keeps."""
    world = closed_loop()
    yaw = world["Ω3"]
    return {name: ca.substitute(x, yaw, ca.SX(0)) for name, x in world.items()}
