"""The third ledger: the lemmas behind convergence of every vehicle within tolerances.

As in the second one, an identity is proved from the derived model, all parameters symbolic, and an
inequality is reduced to identities, or proved in words. The goal is straight below, Ω₃ arbitrary.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.certification.exponential.form import (
    ROWS,
    Variables,
    Vertex,
    Weights,
    derive_form,
)
from hoverproof.certification.exponential.noise_lemmas import axes, held, noise
from hoverproof.certification.lemma import Lemma
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
from hoverproof.servo.uncertain import QUARTER, Doubt, Motion, command, error_rates, kappa
from hoverproof.servo.variables import Design, Errors, Measurement

GOALS = {goal: LAWS["scaled", goal, "measured"] for goal in ("image", "inertial")}
"""Beyond the rates, which are those of all eight laws, only the goal makes a difference."""


def _latency() -> dict[str, bool]:
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


def _rates() -> dict[str, bool]:
    loops = {law.name: derive_lagged_loop(law) for law in LAWS.values()}
    proved = {
        f"δ1' to δ4', τ μ' and τ μT' of {name}": bool(prove_equal(loop.rate, loop.closed_form()))
        for name, loop in loops.items()
    }
    return proved | {"with the lag τ = 0 they are those without lag": _no_lag()}


def _no_lag() -> bool:
    """At τ μ' = 0 and τ μT' = 0, τ = 0, against the closed form of `servo.uncertain`."""
    d, e, at, rotors = Design.symbols(), *_free(), Rotors.symbols()
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


def _free() -> tuple[Errors, Setting]:
    return Errors.symbols(), Setting.symbols()


def _upright() -> dict[str, bool]:
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


def _energy() -> dict[str, bool]:
    return {
        f"-E' of {goal}, rotors {'that lag' if lagged else 'without lag'}": _falls(law, lagged)
        for goal, law in GOALS.items()
        for lagged in (True, False)
    }


def _matrices(form: ca.SX) -> dict[str, ca.SX]:
    return dict(zip(ROWS, ca.vertsplit(form, [0, *_ends()]), strict=True))


def _ends() -> list[int]:
    rows = list(ROWS.values())
    return [sum(rows[: i + 1]) for i in range(len(rows))]


def _falls(law: Law, lagged: bool) -> bool:
    """E' by the rates, against the form at ς, χ, h, τ and π and the terms of bounded norm."""
    d, w, x, (_, at), rotors = (
        law.design.symbols(),
        Weights.symbols(),
        Variables.symbols(),
        _free(),
        Rotors.symbols(),
    )
    e = Errors.from_vector(x.errors)
    at = replace(at, depth_flow=x.flow, ahead=x.ahead, goal=law.goal.fixed(d)[2])
    gain, turned = (ca.reshape(g, 2, 2) for g in (rotors.angular_gain, rotors.gyroscopic))
    h, n, p3, k = at.quickness, x.ahead, at.crosswind, kappa(d)
    own, k12, zeta = own_gyroscopic(d), d.k1 * d.k2 / d.mass, e.d4 - e.d3[:2]
    swing = 2 * h * (e.d3 - n)[2] + p3
    if not lagged:  # of the identity above, at τ = 0
        asked = smooth_command(e, d) + (k + d.k4 / d.mass) * n[:2] - swing * zeta
        asked += at.yaw * QUARTER @ (e.d3 - n)[:2] + at.yaw * own @ zeta
        rotors = replace(rotors, lag=ca.SX(0), thrust=-k * n[2])
        rotors = replace(rotors, torque=asked - smooth_command(e, d))
    else:
        rotors = replace(rotors, torque=x.torque, thrust=x.thrust)
    tau, gained = rotors.lag, rotors.thrust_gain
    rates = lagged_rates(e, at, rotors, d)
    sizes = ca.vertcat(ca.SX.ones(3), *(ca.repmat(x, k) for x, k in _weighted(w)))
    change = ca.dot(sizes * x.errors, rates[:11])
    if lagged:
        change += w.torque * ca.dot(x.torque, rates[11:13]) + w.thrust * x.thrust * rates[13]
    vertex = Vertex(at.lever_ratio, h, gained, tau, swing, lean=ca.SX(0))
    form = derive_form(law, lagged)(d.vector(), vertex.vector(), w.vector())
    X, m = x.vector(), _matrices(form)
    by = {name: m[name] @ X for name in ROWS}
    beyond = h * n[2] - (gained - 1) * p3 / 2  # p2 - (ς - 1) p3/2
    terms = ca.dot(by["d4"], gain @ by["applied"])
    if not lagged:
        gyroscopic = (ca.SX.eye(2) + gain) @ own - turned
        terms += ca.dot(by["d4"], beyond * zeta + at.yaw * gyroscopic @ by["zeta"])
        terms += ca.dot(by["d4"], at.yaw * QUARTER @ -by["ahead"])
        terms += ca.dot(by["d4"], at.yaw * gain @ QUARTER @ by["missed"])
        return bool(prove_equal(change, terms - ca.dot(X, m["fall"] @ X)))
    follows = h * (e.d3[2] + x.thrust / k)  # U_a/D_c
    drift, apart = gained * follows + p3, gained * (follows - h * (e.d3 - n)[2])
    torque, own_turn = by["torque"], by["d4"] - w.d4 * by["h3"]
    terms += ca.dot(by["d4"], (beyond + apart) * by["zeta"] - at.yaw * turned @ by["zeta"])
    terms -= ca.dot(own_turn, at.yaw * QUARTER @ by["h3"])
    terms += ca.dot(torque, at.yaw * own @ by["zeta"])
    terms += ca.dot(torque, tau * k12 * h * (e.d3 - e.d2)[2] * by["zeta"])
    terms += ca.dot(torque, at.yaw * QUARTER @ by["missed"])
    terms -= ca.dot(torque, tau * k12 * at.yaw * QUARTER @ by["pulled"])
    terms += by["lift"] * tau * k * h * ca.dot(by["zeta"], e.d3[:2])
    terms += ca.dot(torque, tau * drift * by["applied"])
    return bool(prove_equal(change, terms - ca.dot(X, m["fall"] @ X)))


def _weighted(w: Weights) -> tuple[tuple[ca.SX, int], ...]:
    return (w.d2, 3), (w.d3, 3), (w.d4, 2)


def _vertices() -> dict[str, bool]:
    """Second derivatives of what the inequality is made of."""
    proved: dict[str, bool] = {}
    for goal, law in GOALS.items():
        for lagged in (True, False):
            d, at, w = law.design.symbols(), Vertex.symbols(), Weights.symbols()
            m = _matrices(derive_form(law, lagged)(d.vector(), at.vector(), w.vector()))
            whole, pushed = ca.vec(m["fall"]), ca.vertcat(*(ca.vec(m[n]) for n in PUSHED))
            fixed = ca.vertcat(*(ca.vec(m[n]) for n in ROWS if n not in MOVED))
            others = ca.vertcat(at.lever_ratio, at.quickness, at.thrust_gain)
            name = f"{goal}, rotors {'that lag' if lagged else 'without lag'}"
            proved[f"{name}: -E' without terms is affine in each of χ, h, ς, τ, π"] = all(
                prove_zero(ca.jacobian(ca.jacobian(whole, x), x)) for x in ca.vertsplit(at.vector())
            )
            proved[f"{name}: E and all u are affine in τ, and know no other"] = all(
                prove_zero(x)
                for z in (pushed, ca.vec(m["energy"]))
                for x in (
                    ca.jacobian(ca.jacobian(z, at.lag), at.lag),
                    ca.jacobian(z, ca.vertcat(others, at.swing)),
                )
            )
            swung = ca.vec(m["applied"])
            proved[f"{name}: of all v only s moves, affine in π"] = all(
                prove_zero(x)
                for x in (
                    ca.jacobian(ca.jacobian(swung, at.swing), at.swing),
                    ca.jacobian(swung, ca.vertcat(others, at.lag)),
                    ca.jacobian(fixed, at.vector()),
                )
            )
    return proved


PUSHED = "d4", "torque", "lift"
MOVED = "fall", "energy", "applied", *PUSHED


def _alike() -> dict[str, bool]:
    """A turn about e3, and a mirror, of all variables."""
    t = ca.SX.sym("t")
    turn = ca.vertcat(ca.horzcat(1 - t**2, -2 * t), ca.horzcat(2 * t, 1 - t**2)) / (1 + t**2)
    proved: dict[str, bool] = {}
    for name, flat in {"turned": turn, "mirrored": ca.diag(ca.SX([1, -1]))}.items():
        whole = ca.diagcat(flat, 1)
        T = ca.diagcat(whole, whole, whole, flat, whole, whole, flat, 1)
        sides = {20: T, 2: flat, 1: ca.SX(1), 3: whole}
        for goal, law in GOALS.items():
            symbols = law.design.symbols(), Vertex.symbols(), Weights.symbols()
            for lagged in (True, False):
                m = _matrices(derive_form(law, lagged)(*(x.vector() for x in symbols)))
                lag = "that lag" if lagged else "without lag"
                proved[f"{goal}, rotors {lag}, {name}: all is the same"] = all(
                    prove_equal(sides[ROWS[n]].T @ m[n] @ T, m[n]) for n in ROWS
                )
    return proved


def _bounded() -> dict[str, bool]:
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


def _offset() -> dict[str, bool]:
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


def _begin() -> dict[str, bool]:
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


def _natural() -> dict[str, bool]:
    lower, V, most = ca.SX.sym("H", ca.Sparsity.lower(3)), ca.SX.sym("V", 3), ca.SX.sym("lambda")
    H = ca.tril2symm(lower)
    y = most / 2 * (V + H @ V)
    sector = 4 * ca.dot(y, most * V - y)
    d, e, at, rotors = Design.symbols(), *_free(), Rotors.symbols()
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


def _height() -> dict[str, bool]:
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


LEMMAS = (
    Lemma(
        "late",
        "an image that is late, and the memory of it",
        "In a controller that turns the feature of t - τ(t), 0 <= τ(t) <= τ̄, to now by the turn "
        "since, n, what is used less the present one, has |n|² <= τ̄ ∫ |y|² over the last τ̄. "
        "With Z = ∫_{-τ̄}^0 ∫_{t+x}^t e^{r(z-t)} |y(z)|² dz dx, for almost all t, Z' <= -r Z + "
        "τ̄|y|² - (ε/τ̄)|n|², ε = 1 - x + x²/2 - x³/6 at x = r τ̄. If |y| <= b on [t - τ̄, t], Z "
        "<= τ̄² b²/2.",
        "n = Rᵀ(t) ∫ R y over [t - τ(t), t], by the first identity, in which R is a rotation; "
        "Cauchy and Schwarz give the first bound. Z = ∫ K |y(z)|² dz over [t - τ̄, t], K = (z - t "
        "+ τ̄) e^{r(z-t)}, which is 0 at the lower end and τ̄ at the upper one: so Z' = τ̄|y|² - "
        "r Z - ∫ e^{r(z-t)}|y|² dz by the second identity, and e^{r(z-t)} >= e^{-rτ̄} there. e^x "
        "(1 - x + x²/2 - x³/6) is 1 at x = 0 and does not grow with x >= 0, by the third "
        "identity: so ε <= e^{-rτ̄}. The last claim is K <= z - t + τ̄.",
        _latency,
    ),
    Lemma(
        "rates",
        "how the errors of a vehicle with rotor lag move",
        "With Ω = (-h ζ turned by 90°, Ω3), U_a/c = κ δ3z + μT, η = ς U_a/D_c + p3, π = 2 h (δ3 - "
        "n)z + p3, s_n = -(κ + k4/m) δ4 - k12 P(δ3 - δ2): δ1' = -Ω×δ1 - y + s3 h ζ, δ2' = -Ω×δ2 + "
        "y + k12 (δ3 - δ2) - s3 h ζ, δ3' = -Ω×δ3 + y + k12 (δ3 - δ2) + κ χ ζ - ς (U_a/c) e3, δ4' "
        "= P y + k12 P(δ3 - δ2) + (κ χ + η + h δ3z) ζ - Ω3 e3×Pδ3 + (I + γ)(s_n + μ) - Ω3 G_t ζ, "
        "τ μ' = (κ + k4/m) P n - π ζ - μ + Ω3 e3×P(δ3 - n) + Ω3 G_c ζ + τ [η (s_n + μ) + (κ + "
        "k4/m) δ4' + k12 P(δ3' - δ2')], τ μT' = -κ nz - μT - τ κ δ3z'. With τ = 0, τ μ' = 0, τ "
        "μT' = 0 and G = (I + γ) G_c - G_t they are the rates without lag.",
        "By differentiation along the motion of the true vehicle under the derived controller.",
        _rates,
    ),
    Lemma(
        "upright",
        "force, thrust and tilt in the wind",
        "Let |F| <= f, |w̃| <= w, f + w < m g. T̃ > 0, T_c > 0 and ρ3 > 0 say the same; and if "
        "they hold, (m g - f)² - w² <= T_c² <= (m g + f)², and sin φ <= (f + w)/(m g), φ < 90°. "
        "With D_lo <= D_c, D_lo > 0, h <= h̄ = cκ/D_lo: |χ - 1| <= w/D_lo, |p3| <= h̄ |ζ| w/D_lo, "
        "and |(Ω×u)3| <= h̄ |ζ||Pu| for any u.",
        "Let A = F - w̃ = m g ρ - T̃ e3, |A| < m g. If T̃ > 0, the lemma on the tilt has ρ3 > 0. "
        "If ρ3 > 0 and T̃ <= 0, |A|² = (m g)² - 2 T̃ m g ρ3 + T̃² >= (m g)², against |A| < m g. "
        "If ρ3 > 0 and T_c <= 0, by the third identity F3 = m g ρ3 - T_c >= m g ρ3 >= 0 and P F = "
        "P(m g ρ + w̃), so |F| >= |m g ρ + P w̃| >= m g - w > f. If ρ3 <= 0 and T_c > 0, F3 = m g "
        "ρ3 - T_c <= m g ρ3 <= 0, and |F| > f in the same way. Hence the three say the same. The "
        "bounds of T_c are the second identity with m g - f <= |F - m g ρ| <= m g + f and 0 <= |P "
        "w̃| <= w, that of sin φ is |P A| = m g |Pρ|. The rest is read off the identities.",
        _upright,
    ),
    Lemma(
        "falls",
        "the derivative of E",
        "With E = ½ Σ wᵢ|δᵢ|² + ½ τ (a5|μ|² + a6 μT²), E' is a quadratic form whose coefficients "
        "are the ends of χ, h, ς, τ and π, the turns -Ω×δᵢ having dropped out, plus terms uᵀHv. "
        "Without lag, u = w4 δ4: (s, γ), (ζ, p2 - (ς - 1) p3/2 + Ω3 G), (P n, -Ω3 e3×), (P(δ3 - "
        "n), Ω3 γ e3×), as (v, H). With lag, u = w4 δ4 + τ (κ + k4/m) a5 μ: (s_n + μ, γ), (ζ, p2 "
        "- (ς - 1) p3/2 + ς (U_a - U)/D_c - Ω3 G_t); u = w4 ζ + τ (κ + k4/m) a5 μ: (Pδ3, -Ω3 "
        "e3×); u = a5 μ: (ζ, Ω3 G_c + τ k12 h (δ3 - δ2)z), (P(δ3 - n), Ω3 e3×), (P(δ3 - δ2), -τ "
        "k12 Ω3 e3×), (s_n + μ, τ η); u = a6 μT: (ζ, τ κ h (Pδ3)ᵀ).",
        "By the rates of the lemma above; δ4 = ζ + Pδ3, and (Pδ3)ᵀ(e3×Pδ3) = 0. The form is that "
        "of the derived graph.",
        _energy,
    ),
    Lemma(
        "vertices",
        "vertices suffice",
        "For any fixed variables and multipliers, the form of the inequality is concave in each "
        "of χ, s3 h, ς, τ and π while the others are fixed. So it is positive all over a box of "
        "them if it is so at its vertices.",
        "-E' without the terms is affine in each; so is -r E. Of the terms, u is affine in τ and "
        "v in π, and -½(t|v|² + |u|²/t) is concave in u and in v; the radii are the same all over "
        "the box. h stands in it only where it is multiplied by s3. A function that is concave in "
        "each variable is least at a vertex: move one variable after the other to an end.",
        _vertices,
    ),
    Lemma(
        "alike",
        "x and y are alike",
        "The form does not change if all variables are turned about e3, or mirrored at a vertical "
        "plane. So no product of components along different axes is in it, and those along y "
        "stand in it as those along x.",
        "A mirror at the plane of x and e3 changes the sign of the products of a y with another "
        "component, and a quarter turn carries x to y.",
        _alike,
    ),
    Lemma(
        "terms",
        "terms of bounded norm",
        "uᵀHv <= (R/2)(t|v|² + |u|²/t) for |H| <= R, t > 0. If |J - jI| <= ϱ, y = JV has ϱ²|V|² - "
        "|y - jV|² >= 0.",
        "uᵀHv <= R|u||v|, and the first identity with |u| and |v|. |(J - jI)V| <= ϱ|V|.",
        _bounded,
    ),
    Lemma(
        "offset",
        "how far off the feature of a level camera is",
        "Let σ = R s be what a level camera sees and w1 = 1. For an inertial goal |σ - s3* e3| = "
        "|δ1|. For one in the image, with ρ3 > 0, sin φ <= (c|δ3 - δ2| + w)/(m g) <= sin φ̄ and "
        "κ_t = 1/√((1 + cos φ̄)/2): |σ - s3* e3| <= √(2 A E) + s3* κ_t w/(m g), A = 1 + (s3* κ_t "
        "c/(m g))² (1/w2 + 1/w3).",
        "R δ1 = σ - s3* e3 or σ - s3* R e3, and |R e3 - e3| = |ρ - e3| = sin φ/√((1 + cos φ)/2) "
        "<= κ_t sin φ. |δ1| + a|δ2| + a|δ3| <= √((1 + a²/w2 + a²/w3) 2 E) by the second identity.",
        _offset,
    ),
    Lemma(
        "begin",
        "a start within tolerance",
        "Let |V| <= v, |F| <= f0, √(Ω1² + Ω2²) <= ω0, T_c > 0, e1 >= |σ - s3* e3|, e_h >= |P(σ - "
        "s3* e3)|, and let a >= 2 sin(φ/2). Then |δ1| <= d1 and |Pδ1| <= min(d1, e_h + a(e1 + "
        "s3)), d1 = e1 + s3 a, s3 = s3* for a goal in the image, else 0; |δ2| <= d1 + (m/k1) v, "
        "|δ3| <= |δ2| + f0/c, |δ4| <= |Pδ1| + (m/k1) v + f0/c + (m g + f0 - c s3) ω0/(c κ), |s_n| "
        "<= (κ + k4/m)|δ4| + k12 f0/c.",
        "R = R₂ R₁, R₁ a turn about e3 and R₂ one by φ about a horizontal axis: |R₂ᵀx - x| <= 2 "
        "sin(φ/2)|x|, and R₁ does not change the length of a P-part. So |P Rᵀ x| <= |P x| + a|x|, "
        "with x = σ - s3* e3 or, for a goal in the image, x = σ, P x = P(σ - s3* e3), |x| <= e1 + "
        "s3. 0 < D_c = T_c - c s3 <= |F - m g ρ| - c s3. The rest is read off the identities.",
        _begin,
    ),
    Lemma(
        "axes",
        "a late image that is not turned",
        "A feature s in the axes of the camera has s' = -Ω×s - y. Used at the age τ(t) in the axes "
        "that the camera had then, it is n more than the present one, |n|² <= τ̄ ∫ |y + Ω×s|² over "
        "the last τ̄. Ω×s is the sum of Ω_h×s, |Ω_h×s| <= h|s||ζ|, and Ω3 e3×s, of which P s = Pδ1 "
        "for a goal in the image, and P s = Pδ1 + (s3*/(m g))(c P(δ3 - δ2) - P w̃) for an inertial "
        "one.",
        "n = ∫ (y + Ω×s) over [t - τ(t), t]; Cauchy and Schwarz. |Ω_h| = h|ζ| [upright].",
        axes,
    ),
    Lemma(
        "noise",
        "noise and gusts",
        "Let a controller have its feature wrong by n + b, V, ρ and P Ω, turned by e3×, by v, d "
        "and ω, Ω3 by ω3, and a measured specific force by α/m; else α = 0. φ = (α + m g d)/c, "
        "B = b - (m/k1) v - φ, for an inertial goal less s3* d. Then it has δ3 - n - B and (δ3 "
        "- δ2) + φ, its lever is D_c - αz, so its h is (1 + ι) h, ι = D_c/(D_c - αz) - 1. U = "
        "cκ (δ3 - n - B)z, and its command over h, with what it adds for its gyroscopic torque, "
        "is s_n + K P(n + B) - π ζ + Ω3 e3×q + Ω3 G_c ζ + C - (π_c - π) ζ + ω3 G_c ζ + (1 + ι) "
        "ω3 e3×q - ι (K q - Ω3 e3×q) - ι k12 P(δ3 - δ2), q = P(δ3 - n - B), C = -(1 + ι) k12 Pφ "
        "- (K + π_c) ω/h + (Ω3 + ω3) G_c ω/h, π_c the π of what it has, K = κ + k4/m. A gust g "
        "beside F is in V' alone, and adds (m/k1) g to δ2' and δ3', and P of it to δ4'.",
        "By the controller of each law at any measurement, and by differences.",
        noise,
    ),
    Lemma(
        "held",
        "a controller that runs in steps, and an accelerometer that lags",
        "Let U and the torque commanded at t be those asked for at tk, t - p' <= tk <= t, by what "
        "is measured then, the specific force with a low-pass whose time is f' at most and which "
        "was settled at the start. Let n be the n of tk and ∫ y over [tk, t], κ = 1 on [tk, t] and "
        "0 <= κ <= e^{(x - tk)/f'} before. The lemma on noise holds with Ω3(tk) for Ω3 + ω3, its "
        "own noise, αz at most c ∫ κ (|ς u| + |p3| D_c/c) more, B more by E and a b of at most f' "
        "|Ω×w̃|/c, φ more by as much, and C by H: E = ∫_{tk}^t (k12 (δ3 - δ2) + P κχζ - Ω×δ3) - e3 "
        "∫ κ ς u, H = ∫_{tk}^t ((1 + ι) k12 P(κχζ + s3 h ζ - Ω×(δ3 - δ2)) + (K + π_c - Ω3(tk) G_c) "
        "(h/h(t)) ((I + γ)(s_n + μ) - Ω3 G_t ζ)). |n|² <= (τ̄ + p') ∫ |y|² over the last τ̄ + p'. "
        "If w = ∫_{tk}^t g, Z = ∫_{tk}^t e^{r(x - t)} ((2p'/π)² e^{rp'} g² - w²) dx >= 0 and Z' = "
        "-r Z + (2p'/π)² e^{rp'} g² - w². If w <= ∫ κ g, w² <= (p' + f') ∫ κ g², and with k(x) = "
        "∫_x^∞ e^{r(z - x)} κ'(z) dz, κ'(z) = 1 up to p' and e^{(p' - z)/f'} beyond, Z = ∫ k(t - x"
        ") g² dx has Z' <= -r Z + k(0) g² - w²/(p' + f') and k(0) <= (p' + f'/(1 - r f'))/(1 - r "
        "p').",
        "What is measured at tk less what is now are errors b, v, d, ω and α, of coordinates in "
        "body axes, as in the lemma on noise: that of δ3 is n and the integral of δ3' - y, but for "
        "the force; m a = w̃ - T̃ e3 has (m a)' = -Ω×w̃ - ς U_a e3, and what a low-pass of it is "
        "behind is the integral of that with κ. By the first two identities B, and φ, are then "
        "what is said. ω = -∫ (h ζ)', by the third, and D_c(t)/D_c = h/h(t). w(tk) = 0. With ψ = a "
        "cot(a (x - tk)), a = π/(2p'), w²ψ is 0 at tk, as w² <= (x - tk) ∫ g², and 0 or more until "
        "tk + p': so by the fourth identity ∫ g² >= a² ∫ w² up to any t, and e^{rp'} e^{r(x - t)} "
        ">= 1. The last two identities are -k' - r k = κ' beyond and up to p', and κ(x) <= κ'(t - "
        "x). (e^{rp'} - 1)/r <= p' e^{rp'}, e^{rp'} <= 1/(1 - r p').",
        held,
    ),
    Lemma(
        "natural",
        "the natural potential and vehicles within tolerance",
        "For 0 ⪯ Q ⪯ λI, y = QV has yᵀ(λV - y) >= 0. With the centroid as feature and e = q - q3* "
        "ρ, δ1 = e for an inertial goal and δ1 = e + q3*(ρ - e3) for one in the image; δ1 is in "
        "no other rate than its own, but through y. For an inertial goal, with the thrust as "
        "commanded, N of the lemma on the vertical motion obeys N' = (k1/m) w, w = qz - q3* + "
        "(Pρ)ᵀδ4: so w <= qz - q3* + sin φ √(2ℓ/a4) while Λ <= ℓ.",
        "|H| <= 1 in the first identity. |ρ| = 1, |Pρ| = sin φ, and a4|δ4|² <= 2ℓ as W >= 0.",
        lambda: _natural() | _height(),
    ),
)
