"""The identities behind every vehicle within tolerances, each proved from the derived model.

Each function returns whether identities hold, by name, for the lemma in `lemmas` that leans on
them; those of the energy are in `energy_identities`, those of noise in `noise_identities`.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import rigid_body
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.lagged import (
    LaggedLoop,
    Rotors,
    Setting,
    derive_lagged_loop,
    lagged_rates,
    own_gyroscopic,
    smooth_command,
)
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import LAWS
from hoverproof.servo.true_vehicle import QUARTER, kappa
from hoverproof.servo.uncertain import Doubt, Motion, command, error_rates
from hoverproof.servo.variables import Design, Errors, Measurement

GOALS = {goal: LAWS["scaled", goal, "measured"] for goal in ("image", "inertial")}
"""Beyond the rates, which are those of all eight laws, only the goal makes a difference."""


def latency() -> dict[str, bool]:
    """A feature that is late, and the memory of it."""
    rotation, s, y, rate = (
        ca.SX.sym(n, *k) for n, k in (("R", (3, 3)), ("s", (3,)), ("y", (3,)), ("Omega", (3,)))
    )
    moved = rotation @ skew(rate) @ s + rotation @ (-skew(rate) @ s - y)
    x, time, b, fading, r = map(ca.SX.sym, ("x", "t", "b", "E", "r"))
    series = 6 - 6 * x + 3 * x**2 - x**3
    kernel = (x - time + b) * fading
    slope = ca.jacobian(kernel, time) - r * fading * ca.jacobian(kernel, fading)
    return {
        "(R s)' = -R y": bool(prove_equal(moved, -rotation @ y)),
        "K' = -E - r K, K = (x - t + τ̄) E, E' = -r E": bool(
            prove_equal(slope, -fading - r * kernel)
        ),
        "6 (p' + p) = -x³, p = 1 - x + x²/2 - x³/6": bool(
            prove_equal(ca.jacobian(series, x) + series, -(x**3))
        ),
    }


def rates() -> dict[str, bool]:
    """How errors and rotors that lag move, for each of the eight laws."""
    loops = {law.name: derive_lagged_loop(law) for law in LAWS.values()}
    proved = {
        f"δ1' to δ4', τ μ' and τ μT' of {name}": bool(prove_equal(loop.rate, loop.closed_form()))
        for name, loop in loops.items()
    }
    return proved | {"with the lag τ = 0 they are those without lag": _no_lag()}


def _no_lag() -> bool:
    """At τ μ' = 0 and τ μT' = 0, τ = 0, against the closed form of `servo.uncertain`."""
    d, e, at, rotors = Design.symbols(), Errors.symbols(), Setting.symbols(), Rotors.symbols()
    rotors = replace(rotors, lag=ca.SX(0))
    n, h, own = at.ahead, at.quickness, own_gyroscopic(d)
    gain, gyroscopic = (ca.reshape(x, 2, 2) for x in (rotors.angular_gain, rotors.gyroscopic))
    p1, p2 = h * e.d3[2], h * n[2]
    zeta = e.d4 - e.d3[:2]
    motion = Motion(
        depth_flow=at.depth_flow,
        rate=ca.vertcat(-QUARTER @ (h * zeta), at.yaw),
        goal=at.goal,
        quickness=h,
        sinking=p1,
        sinking_by_error=p2,
        crosswind=at.crosswind,
    )
    doubt = Doubt(
        thrust_gain=rotors.thrust_gain,
        lever_ratio=at.lever_ratio,
        lever_drift=(rotors.thrust_gain - 1) * (p1 - p2),
        angular_gain=rotors.angular_gain,
        gyroscopic=ca.vec((ca.SX.eye(2) + gain) @ own - gyroscopic),
        feature=n,
        force=ca.SX.zeros(3),
    )
    asked = command(e, motion, doubt, d) + at.yaw * own @ zeta
    steady = replace(rotors, torque=asked - smooth_command(e, d), thrust=-kappa(d) * n[2])
    claimed = ca.vertcat(error_rates(e, motion, doubt, d), ca.SX.zeros(3))
    return bool(prove_equal(lagged_rates(e, at, steady, d), claimed))


def upright() -> dict[str, bool]:
    """Force, thrust and tilt in the wind."""
    proved: dict[str, bool] = {}
    for goal, law in GOALS.items():
        loop, body, wind, thrust = _measured(law)
        d, e, at = loop.design, loop.errors, loop.setting
        felt, weight, c = wind - body.thrust * E3, d.mass * d.gravity, d.stiffness
        force = weight * body.gravity_direction + felt
        zeta, h = e.d4 - e.d3[:2], at.quickness
        apart = ca.SX.sym("u", 3)
        square = ca.dot(felt, felt)
        proved |= {
            f"{goal}: F = c(δ3 - δ2) = m g ρ + w̃ - T̃ e3": bool(
                prove_equal(c * (e.d3 - e.d2), force)
            ),
            f"{goal}: |F - m g ρ|² = T_c² + |P w̃|²": bool(
                prove_equal(square, thrust**2 + ca.dot(wind[:2], wind[:2]))
            ),
            f"{goal}: F + T_c e3 = m g ρ + P w̃": bool(
                prove_equal(
                    force + thrust * E3,
                    weight * body.gravity_direction + ca.vertcat(wind[:2], 0),
                )
            ),
            f"{goal}: D = D_c + w̃3, D_c = T_c - c s3, T_c = T̃ - w̃3": bool(
                prove_equal(at.lever_ratio, 1 + wind[2] * h / (c * kappa(d)))
            )
            and bool(prove_equal(h * (thrust - c * at.goal), c * kappa(d))),
            f"{goal}: e3×Ω = h ζ": bool(prove_equal(QUARTER @ body.rate[:2], h * zeta)),
            f"{goal}: p3 D_c = h ζᵀP w̃": bool(
                prove_equal(at.crosswind * c * kappa(d) / h, h * ca.dot(zeta, wind[:2]))
            ),
            f"{goal}: (Ω×u)3 = h ζᵀPu": bool(
                prove_equal(ca.cross(body.rate, apart)[2], h * ca.dot(zeta, apart[:2]))
            ),
            f"{goal}: δ1 + δ2 = (m/k1) V": bool(
                prove_equal(e.d1 + e.d2, d.slowness * body.velocity)
            ),
        }
    return proved


def _measured(law: Law) -> tuple[LaggedLoop, Measurement, ca.SX, ca.SX]:
    """Return the loop, the true state and wind in it, and the thrust that is measured."""
    loop = derive_lagged_loop(law)
    thrust = loop.body.thrust - loop.wind[2]
    return loop, loop.body, loop.wind, thrust


def bounded() -> dict[str, bool]:
    """Terms of bounded norm."""
    t, a, b = map(ca.SX.sym, ("t", "a", "b"))
    y, V, j, radius = ca.SX.sym("y", 3), ca.SX.sym("V", 3), *map(ca.SX.sym, ("j", "rho"))
    J, p, turned = ca.SX.sym("J", 3, 3), ca.SX.sym("p", 2), QUARTER
    out = y - j * V
    ball = ca.substitute(radius**2 * ca.dot(V, V) - ca.dot(out, out), y, J @ V)
    off = (J - j * ca.SX.eye(3)) @ V
    return {
        "½(t b² + a²/t) - a b = (t b - a)²/(2 t)": bool(
            prove_equal((t * b**2 + a**2 / t) / 2 - a * b, (t * b - a) ** 2 / (2 * t))
        ),
        "ϱ²|V|² - |y - jV|² = ϱ²|V|² - |(J - jI)V|², y = JV": bool(
            prove_equal(ball, radius**2 * ca.dot(V, V) - ca.dot(off, off))
        ),
        "pᵀ(e3×p) = 0": bool(prove_zero(ca.dot(p, turned @ p))),
        "|e3×p| = |p|": bool(prove_equal(ca.dot(turned @ p, turned @ p), ca.dot(p, p))),
    }


def offset() -> dict[str, bool]:
    """How far off the feature of a level camera is."""
    theta = ca.SX.sym("theta", 2)
    size = ca.dot(theta, theta)
    rho = ca.vertcat(2 * theta, 1 - size) / (1 + size)
    a, x, y, z, w2, w3 = map(ca.SX.sym, ("a", "x", "y", "z", "w2", "w3"))
    gap = (1 + a**2 * (1 / w2 + 1 / w3)) * (x**2 + w2 * y**2 + w3 * z**2) - (x + a * (y + z)) ** 2
    squares = (w2 * y - a * x) ** 2 / w2 + (w3 * z - a * x) ** 2 / w3
    squares += a**2 * (w3 * z - w2 * y) ** 2 / (w2 * w3)
    proved = {
        "|ρ - e3|² (1 + ρ3)/2 = |Pρ|²": bool(
            prove_equal(ca.dot(rho - E3, rho - E3) * (1 + rho[2]) / 2, ca.dot(rho[:2], rho[:2]))
        ),
        "(1 + a²/w2 + a²/w3)(x² + w2 y² + w3 z²) - (x + a y + a z)² = squares": bool(
            prove_equal(gap, squares)
        ),
    }
    for goal, law in GOALS.items():
        loop, body, *_ = _measured(law)
        s3 = loop.design.goal_centroid[2]
        wanted = s3 * (E3 if goal == "image" else body.gravity_direction)
        proved[f"{goal}: δ1 = s - s3* {'e3' if goal == 'image' else 'ρ'}"] = bool(
            prove_equal(loop.errors.d1, body.centroid - wanted)
        )
    return proved


def begin() -> dict[str, bool]:
    """The errors at a start."""
    proved: dict[str, bool] = {}
    for goal, law in GOALS.items():
        loop, body, _, thrust = _measured(law)
        d, e, at = loop.design, loop.errors, loop.setting
        c, k = d.stiffness, kappa(d)
        force, lever = c * (e.d3 - e.d2), thrust - c * at.goal
        moved, k12 = d.slowness * body.velocity, d.k1 * d.k2 / d.mass
        proved |= {
            f"{goal}: δ2 = (m/k1) V - δ1": bool(prove_equal(e.d2, moved - e.d1)),
            f"{goal}: δ3 = F/c + (m/k1) V - δ1": bool(prove_equal(e.d3, force / c + moved - e.d1)),
            f"{goal}: δ4 = Pδ3 + (D_c/(cκ)) e3×Ω": bool(
                prove_equal(e.d4, e.d3[:2] + lever / (c * k) * QUARTER @ body.rate[:2])
            ),
            f"{goal}: s_n = -(κ + k4/m) δ4 - (k12/c) P F": bool(
                prove_equal(smooth_command(e, d), -(k + d.k4 / d.mass) * e.d4 - k12 / c * force[:2])
            ),
        }
    return proved


def natural() -> dict[str, bool]:
    """The natural potential, with tolerances."""
    lower, V, most = ca.SX.sym("H", ca.Sparsity.lower(3)), ca.SX.sym("V", 3), ca.SX.sym("lambda")
    H = ca.tril2symm(lower)
    y = most / 2 * (V + H @ V)
    sector = 4 * ca.dot(y, most * V - y)
    d, e, at, rotors = Design.symbols(), Errors.symbols(), Setting.symbols(), Rotors.symbols()
    rates = lagged_rates(e, at, rotors, d)
    image, inertial = (derive_lagged_loop(LAWS["centroid", g, "measured"]) for g in GOALS)
    q3 = image.design.goal_centroid[2]
    natural = image.body.centroid - q3 * image.body.gravity_direction
    own = inertial.body.centroid - inertial.design.goal_centroid[2] * (
        inertial.body.gravity_direction
    )
    theta, x, t = ca.SX.sym("theta", 2), ca.SX.sym("x", 3), ca.SX.sym("t")
    turn = ca.vertcat(ca.horzcat(1 - t**2, -2 * t), ca.horzcat(2 * t, 1 - t**2)) / (1 + t**2)
    whole, P = ca.diagcat(turn, 1), ca.diag(ca.SX([1, 1, 0]))

    def leaned(theta: ca.SX, x: ca.SX) -> ca.SX:
        return (P - E3 @ ca.vertcat(theta, 0).T) @ x

    return {
        "4 yᵀ(λV - y) = λ²(|V|² - |HV|²), y = QV, Q = (λ/2)(I + H)": bool(
            prove_equal(sector, most**2 * (ca.dot(V, V) - ca.dot(H @ V, H @ V)))
        ),
        "δ1 is in no rate but its own": bool(prove_zero(ca.jacobian(rates[3:], e.d1))),
        "image: δ1 - e = q3*(ρ - e3)": bool(
            prove_equal(image.errors.d1 - natural, q3 * (image.body.gravity_direction - E3))
        ),
        "inertial: δ1 = e": bool(prove_equal(inertial.errors.d1, own)),
        "(P - e3 θᵀ) x turns with θ and x": bool(
            prove_equal(leaned(turn @ theta, whole @ x), whole @ leaned(theta, x))
        ),
    }


def height() -> dict[str, bool]:
    """The vertical motion with an inertial goal and no tolerance of the thrust."""
    law = LAWS["centroid", "inertial", "modelled"]
    control, Q = derive_controller(law), ca.tril2symm(ca.SX.sym("Q", ca.Sparsity.lower(3)))
    at, d = control.measured, control.design
    rho, aim = at.gravity_direction, at.centroid - d.goal_centroid[2] * at.gravity_direction
    rate = law.measured_rate(
        at,
        d,
        angular_acceleration=control.angular_acceleration,
        thrust_rate=control.thrust_rate,
        depth_flow=Q @ at.velocity,
    )
    rises = ca.dot(rho, at.velocity)
    second = ca.dot(rho, rigid_body.force(at.thrust, rho, d.mass, d.gravity)) / d.mass
    third = lie_derivative(second, at.vector(), rate)
    change = rises + d.mass / (d.k1 * d.k2) * (second + third / kappa(d))
    w = ca.dot(rho, aim) + ca.dot(rho[:2], law.errors(at, d).d4)
    return {
        "inertial: N' = (k1/m) (ρᵀ(q - q3* ρ) + (Pρ)ᵀδ4)": bool(
            prove_equal(change, d.k1 / d.mass * w)
        )
    }
