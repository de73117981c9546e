"""The equations of the paper as printed, each beside the corrected form where one is needed."""

from __future__ import annotations

from fractions import Fraction

from hoverproof.paper.judge import Claim, Setting, definition, identity, setting
from hoverproof.paper.notation import Symbol
from hoverproof.paper.printed import Equation
from hoverproof.paper.symbols import (
    ONE,
    A,
    F,
    Gamma,
    Gamma3,
    L,
    L_rate,
    M,
    Omega,
    Omega3,
    Omega_rate,
    Q,
    R_T_e3,
    S,
    T,
    T_rate,
    U,
    V,
    V_rate,
    d1,
    d1_rate,
    d1_square_rate,
    d2,
    d2_rate,
    d3,
    d3_rate,
    d4,
    d4_rate,
    e3,
    f,
    g,
    identity_matrix,
    inertia,
    inertia_inverse,
    k1,
    k2,
    k3,
    k4,
    k_Omega,
    m,
    number,
    pi,
    q,
    q3_star,
    q_rate,
    q_star,
    sk,
    sq,
)
from hoverproof.paper.worlds import (
    any_motion,
    body_in_flight,
    closed_loop,
    closed_loop_no_yaw,
    no_yaw_motion,
    two_points_in_view,
)

E = Equation
I3 = identity_matrix
FREE, FREE_NO_YAW = setting(any_motion), setting(no_yaw_motion)
LOOP, LOOP_NO_YAW = setting(closed_loop), setting(closed_loop_no_yaw)
NO_YAW = "Ω3 = 0"

# --- the rigid body and the image ---------------------------------------------------------------

xi_rate, R, R_rate = (
    Symbol("ξ̇", r"\dot\xi", M / S),
    Symbol("R", "R", ONE),
    Symbol("Ṙ", r"\dot R", S**-1),
)
P, P_rate = Symbol("Pᵢ", "P_i", M), Symbol("Ṗᵢ", r"\dot P_i", M / S)
P_world, xi = Symbol("P'ᵢ", "P'_i", M), Symbol("ξ", r"\xi", M)
p, p_rate = Symbol("pᵢ", "p_i", ONE), Symbol("ṗᵢ", r"\dot p_i", S**-1)
r, pi_p = Symbol("rᵢ", "r_i", M), Symbol("π_p", r"\pi_p", ONE)
p_sum, Q_sum = (
    Symbol("Σ pᵢ", r"\sum_i p_i", ONE),
    Symbol("Σ π_pᵢ/rᵢ", r"\sum_i \pi_{p_i}/r_i", M**-1),
)


BODY: Setting = body_in_flight
VIEW: Setting = two_points_in_view

RIGID_BODY_AND_IMAGE = [
    definition("1", "position", E(xi_rate, R * V), BODY),
    definition("2", "velocity", E(m * V_rate, -m * sk(Omega) * V + F), BODY),
    definition("3", "attitude", E(R_rate, R * sk(Omega)), BODY),
    definition(
        "4", "angular velocity", E(inertia * Omega_rate, -sk(Omega) * inertia * Omega + Gamma), BODY
    ),
    definition("5", "force", E(F, -T * e3 + m * g * R_T_e3), BODY),
    definition("point", "target point in the camera frame", E(P, R.T * (P_world - xi)), BODY),
    identity(
        "point motion",
        "motion of a target point (not printed; eq. 6 needs it)",
        E(P_rate, -sk(Omega) * P - V),
        BODY,
    ),
    identity(
        "6",
        "motion of a point of the spherical image",
        E(p_rate, -sk(Omega) * p + pi_p * (V / r)),
        VIEW,
        corrected=E(p_rate, -sk(Omega) * p - pi_p * (V / r)),
    ),
    definition("7", "centroid", E(q, p_sum), VIEW),
    identity(
        "8",
        "motion of the centroid",
        E(q_rate, -sk(Omega) * q - Q * V),
        VIEW,
        note="for two points; each further point adds a term of the same form",
    ),
    definition("9", "the matrix Q", E(Q, Q_sum), VIEW),
]

# --- the error chain ----------------------------------------------------------------------------

c = k1**2 * k2 / m
K = k1 * k2 + k3
beta = m**2 / (k1**2 * k2 * K)
lever = sk(T * e3 - c * q_star)
distance = T - c * q3_star
damping = k2 * I3 - Q

kinematics = -sk(Omega) * d1 - Q * V - sk(Omega) * q_star
d1_square = -d1.T * sk(Omega) * d1 - d1.T * Q * V - d1.T * sk(Omega) * q_star
common = k1 / m * Q * d1 - k1 / m * damping * d2
e3_part = sk(q_star) * Omega - K / m * d3 + m / (k1**2 * k2) * U * e3
e3_part_no_yaw = sk(q_star) * pi * Omega - K / m * d3 + m / (k1**2 * k2) * U * e3
d3_rate_26 = -sk(Omega) * d3 + common + K / m * pi * d4 - k3 / m * d3
d4_rate_27 = (
    -pi * sk(Omega) * d3
    + k1 / m * pi * Q * d1
    - k1 / m * pi * damping * d2
    + K / m * pi * d4
    + beta * pi * U * sk(e3) * Omega
    - k3 / m * pi * d3
)
d4_rate_29 = (
    -pi * sk(Omega) * d3
    + k1 / m * pi * Q * d1
    - k1 / m * pi * damping * d2
    + K / m * pi * d4
    + beta * pi * U * sk(e3) * pi * Omega
    - k3 / m * pi * d3
)

ERROR_CHAIN = [
    definition("10", "image error", E(d1, q - q_star), FREE),
    identity("11", "motion of the image error", E(d1_rate, kinematics), FREE),
    identity(
        "|δ1|²",
        "derivative of the storage function |δ1|²",
        E(d1_square_rate, d1_square),
        FREE,
        corrected=E(d1_square_rate, number(2) * d1_square),
    ),
    identity(
        "skew",
        "the first term of it is zero",
        E(d1.T * sk(Omega) * d1, number(0)),
        FREE,
    ),
    identity(
        "J",
        "image Jacobian: δ̇1 = [Q  sk(q*) + sk(δ1)] (V, Ω)",
        E(d1_rate, Q * V + (sk(q_star) + sk(d1)) * Omega),
        FREE,
        corrected=E(d1_rate, -Q * V + (sk(q_star) + sk(d1)) * Omega),
    ),
    identity("13", "full dynamics: image error", E(d1_rate, kinematics), FREE),
    definition("14", "full dynamics: velocity", E(m * V_rate, -m * sk(Omega) * V + F), BODY),
    definition("15", "full dynamics: attitude", E(R_rate, R * sk(Omega)), BODY),
    definition(
        "16",
        "full dynamics: angular velocity",
        E(inertia * Omega_rate, -sk(Omega) * inertia * Omega + Gamma),
        BODY,
    ),
    definition("17", "velocity error", E(d2, m / k1 * V - d1), FREE),
    definition(
        "18", "force error", E(d3, m / (k1**2 * k2) * (-T * e3 + m * g * R_T_e3) + d2), FREE
    ),
    definition(
        "20",
        "yaw torque",
        E(Gamma3, e3.T * (sk(Omega) * inertia * Omega) - k_Omega * Omega3),
        LOOP,
        note="then I3 Ω̇3 = -kΩ Ω3",
    ),
    definition("21", "thrust as a state", E(T_rate, U), FREE),
    identity(
        "22",
        "motion of δ1 in the errors",
        E(d1_rate, -sk(Omega) * d1 - k1 / m * Q * d1 - k1 / m * Q * d2 + sk(q_star) * Omega),
        FREE,
    ),
    identity(
        "23",
        "motion of δ2",
        E(d2_rate, -sk(Omega) * d2 + common + k1 * k2 / m * d3 - sk(q_star) * Omega),
        FREE,
    ),
    identity(
        "24",
        "motion of δ3",
        E(
            d3_rate,
            -sk(Omega) * d3
            + common
            + k1 * k2 / m * d3
            + m / (k1**2 * k2) * (lever * Omega - T_rate * e3),
        ),
        FREE,
    ),
    definition("25", "body-rate error", E(d4, beta * pi * lever * Omega + pi * d3), FREE),
    identity(
        "26", "motion of δ3 with δ4 put in", E(d3_rate, d3_rate_26 - (I3 - pi) * e3_part), FREE
    ),
    identity("27", "motion of δ4", E(d4_rate, d4_rate_27 + beta * pi * lever * Omega_rate), FREE),
    identity(
        "28",
        "motion of δ3 without yaw",
        E(d3_rate, d3_rate_26 - (I3 - pi) * e3_part_no_yaw),
        FREE,
        note="for any Ω3 even, as e3ᵀ sk(q*) e3 = 0",
    ),
    identity(
        "29",
        "motion of δ4 without yaw",
        E(d4_rate, d4_rate_29 + beta * pi * lever * pi * d3_rate),
        FREE_NO_YAW,
        corrected=E(d4_rate, d4_rate_29 + beta * pi * lever * pi * Omega_rate),
        note=NO_YAW,
        how="wrong factor: the last one is Ω̇, not δ̇3",
    ),
]

# --- the controller and the Lyapunov function ---------------------------------------------------

half = number(Fraction(1, 2))
wish = sk(Omega) * d3 + k1 * k2 / m * d2 - k1 * k2 / m * d3 - (K + k4) / m * d4
levelled = k1**2 * k2 * K / m**2 * sk(e3) * wish
gyroscopic = sk(Omega) * inertia * Omega - k_Omega * Omega3 * e3
cross_terms = (
    k1 / m * d3.T * Q * d1
    + k1 / m * d3.T * Q * d2
    + k1 / m * d4.T * Q * d1
    + k1 / m * d4.T * Q * d2
)
decay = -(k1 / m * d1.T * Q * d1) - k1 / m * d2.T * damping * d2 - k3 / m * sq(d3) - k4 / m * sq(d4)


CONTROLLER = [
    identity(
        "30",
        "thrust control U",
        E(U, c * (K / m) * e3.T * d3 - c * e3.T * sk(q_star) * Omega),
        LOOP,
        note="it makes the e3 part of eq. 26 vanish; for any Ω3",
    ),
    identity(
        "31",
        "torque control Γ",
        E(
            Gamma,
            inertia_inverse * (gyroscopic - inertia / distance * U * sk(e3) * Omega - levelled),
        ),
        LOOP_NO_YAW,
        corrected=E(Gamma, gyroscopic - inertia / distance * (U * pi * Omega + levelled)),
        note=NO_YAW,
        how="factors: no 𝐈⁻¹ in front; U π Ω, not U sk(e3) Ω; 𝐈/(T - (k1² k2/m) q3*) before the "
        "last bracket too",
    ),
    definition(
        "32",
        "Lyapunov function",
        E(L, half * sq(d1) + half * sq(d2) + half * sq(d3) + half * sq(d4)),
        FREE,
    ),
    definition("f(T)", "thrust factor", E(f, k1 * k2 * K / (m * distance)), FREE),
    identity(
        "Ω̇",
        "angular acceleration, in the proof",
        E(Omega_rate, -inertia_inverse * sk(Omega) * inertia * Omega + inertia_inverse * Gamma),
        FREE,
    ),
    identity(
        "π sk π",
        "the projected lever",
        E(pi * lever * pi, distance * sk(e3)),
        FREE,
        note="so Γ is unique while T ≠ (k1² k2/m) q3*",
    ),
    identity("π δ4", "δ4 is horizontal", E(pi * d4, d4), FREE),
    identity(
        "34",
        "derivative of L",
        E(L_rate, decay + cross_terms + (d1 - d2).T * sk(q_star) * Omega),
        LOOP,
        note="with the derived Γ, and then for any Ω3",
    ),
    identity(
        "35",
        "body rates from the errors",
        E(pi * Omega, -(k1 / m * f * sk(e3) * (d4 - d3))),
        FREE_NO_YAW,
        note=NO_YAW,
    ),
    identity(
        "L̇ with A",
        "derivative of L with eq. 35 put in",
        E(
            L_rate,
            decay
            + k1 / m * d3.T * (Q - f * A) * d1
            + k1 / m * d3.T * (Q + f * A) * d2
            + k1 / m * d4.T * (Q + f * A) * d1
            + k1 / m * d4.T * (Q - f * A) * d2,
        ),
        LOOP_NO_YAW,
        corrected=E(
            L_rate,
            decay
            + k1 / m * d3.T * (Q - f * A.T) * d1
            + k1 / m * d3.T * (Q + f * A.T) * d2
            + k1 / m * d4.T * (Q + f * A.T) * d1
            + k1 / m * d4.T * (Q - f * A.T) * d2,
        ),
        note=f"{NO_YAW}; as printed only where A = Aᵀ, that is for q* along e3",
        how="transpose: Aᵀ is right, not A",
    ),
    identity(
        "A",
        "A = -sk(q*) sk(e3) written out",
        E(A, q3_star * I3 - e3 * q_star.T),
        FREE,
        note="the product as printed, in simpler form",
    ),
]

EQUATIONS: list[Claim] = [*RIGID_BODY_AND_IMAGE, *ERROR_CHAIN, *CONTROLLER]
