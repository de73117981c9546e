"""The identities behind a region of attraction, each proved from the derived model.

Each function returns whether identities hold, by name, for the lemma in `lemmas` that leans on
them. The goal is axial, q* = q3* e3; the yaw rate is arbitrary, for it drops out of everything.
"""

from __future__ import annotations

import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.certification.attraction.form import (
    AttractionForm,
    axial_loop,
    derive_form,
    half_squares,
)
from hoverproof.plant import camera, rigid_body
from hoverproof.plant.rigid_body import E3
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.lyapunov import thrust_factor

P = ca.diag(ca.SX([1, 1, 0]))


def potential() -> dict[str, bool]:
    """One point of the target; Φ is a sum of such terms."""
    point, xi, velocity, r = (ca.SX.sym(n, k) for n, k in (("P", 3), ("xi", 3), ("V", 3), ("r", 1)))
    rotation, q3 = ca.SX.sym("R", 3, 3), ca.SX.sym("q3")
    ray = point - xi
    roots = {r: ca.dot(ray, ray)}
    distance = ca.sqrt(ca.dot(ray, ray))
    seen = rotation.T @ ray / r
    W = distance + q3 * xi[2]
    e = seen - q3 * rotation.T @ E3
    hessian, _ = ca.hessian(distance, xi)
    x = ca.SX.sym("x", 3)
    turned = ca.cross(ray / r, x)
    return {
        "d/dt (|P' - ξ| + q3* e3ᵀξ) = -eᵀV": bool(
            prove_equal(lie_derivative(W, xi, rotation @ velocity), -e.T @ velocity, roots)
        ),
        "the Hessian of |P' - ξ| is (I - ppᵀ)/r": bool(
            prove_equal(hessian, camera.depth_matrix(ray), roots)
        ),
        "xᵀ(I - ppᵀ)x/r = |p × x|²/r": bool(
            prove_equal(x.T @ hessian @ x, ca.dot(turned, turned) / r, roots)
        ),
    }


def height() -> dict[str, bool]:
    """How the vertical part of the unit vector to a point changes with height."""
    d, h, r = map(ca.SX.sym, ("d", "h", "r"))
    part = h / ca.sqrt(d**2 + h**2)
    return {
        "∂(h/r)/∂h = d²/r³, r² = d² + h²": bool(
            prove_equal(ca.jacobian(part, h), d**2 / r**3, {r: d**2 + h**2})
        )
    }


def slope() -> dict[str, bool]:
    """The derivative of one term of Q while ξ moves along h; α = pᵀh, g = h - α p."""
    ray, h = ca.SX.sym("P", 3), ca.SX.sym("h", 3)
    r, mu, c = map(ca.SX.sym, ("r", "mu", "c"))
    roots = {r: ca.dot(ray, ray)}
    p = ray / r
    along = ca.dot(p, h)
    across = h - along * p
    slope = ca.reshape(-ca.jtimes(ca.vec(camera.depth_matrix(ray)), ray, h), 3, 3)
    D = across @ p.T + p @ across.T + along * (ca.SX.eye(3) - p @ p.T)
    shifted = mu * ca.SX.eye(3) - D
    det = ca.dot(shifted[:, 0], ca.cross(shifted[:, 1], shifted[:, 2]))
    square = ca.dot(across, across)
    return {
        "the derivative is D/r², D = g pᵀ + p gᵀ + α (I - ppᵀ)": bool(
            prove_equal(r**2 * slope, D, roots)
        ),
        "|g|² + α² = |h|²": bool(prove_equal(square + along**2, ca.dot(h, h), roots)),
        "det(μ I - D) = (μ - α)(μ² - α μ - |g|²)": bool(
            prove_equal(det, (mu - along) * (mu**2 - along * mu - square), roots)
        ),
        "4(μ² - α μ - (1 - α²)) = (2α - μ)² + 3μ² - 4": bool(
            prove_equal(4 * (mu**2 - c * mu - (1 - c**2)), (2 * c - mu) ** 2 + 3 * mu**2 - 4)
        ),
    }


def tilt() -> dict[str, bool]:
    """θ = Pρ/(1 + ρ3) names every unit vector ρ but -e3, by rational functions."""
    theta, q3, thrust, weight = (ca.SX.sym("theta", 2), *map(ca.SX.sym, ("q3", "T", "mg")))
    size = ca.dot(theta, theta)
    rho = ca.vertcat(2 * theta, 1 - size) / (1 + size)
    flat = ca.vertcat(theta, 0)
    force = weight * rho - thrust * E3
    eta = q3 * (rho - E3)
    claimed = q3 / weight * (P - E3 @ flat.T) @ force
    horizontal = P @ rho
    return {
        "|ρ| = 1": bool(prove_equal(ca.dot(rho, rho), ca.SX(1))),
        "Pρ/(1 + ρ3) = θ": bool(prove_equal(horizontal / (1 + rho[2]), flat)),
        "η = (q3*/(m g)) (P - e3 θᵀ) F": bool(prove_equal(eta, claimed)),
        "|F|² = (T - m g)² + 2 T m g (1 - ρ3)": bool(
            prove_equal(
                ca.dot(force, force),
                (thrust - weight) ** 2 + 2 * thrust * weight * (1 - rho[2]),
            )
        ),
        "P F = m g Pρ": bool(prove_equal(P @ force, weight * horizontal)),
        "1 - ρ3 = |θ|² (1 + ρ3)": bool(prove_equal(1 - rho[2], size * (1 + rho[2]))),
    }


def closed_loop() -> dict[str, bool]:
    """How the errors move in the closed loop, whatever Ω is."""
    loop = axial_loop()
    d, e, f, Q = loop.design, loop.errors, loop.factor, loop.Q
    d4 = ca.vertcat(e.d4, 0)
    v = e.d1 + e.d2
    k12 = d.k1 * d.k2
    flow, turn = d.k1 * Q @ v, d.k1 * f * d.goal_centroid[2] * P @ (d4 - e.d3)
    spin = d.mass * ca.skew(loop.measured.rate)
    rates = {
        "m δ2'": (e.d2, -spin @ e.d2 + flow - k12 * e.d2 + k12 * e.d3 - turn),
        "m δ3'": (
            e.d3,
            -spin @ e.d3 + flow - k12 * e.d2 + (k12 + d.k3) * d4 - d.k3 * e.d3,
        ),
        "m δ4'": (e.d4, (flow - (k12 + d.k3) * e.d3)[:2] - d.k4 * e.d4),
    }
    return {
        f"{name} = …, any Ω": bool(prove_equal(d.mass * loop.dot(part), right))
        for name, (part, right) in rates.items()
    } | {"v = (m/k1) V": bool(prove_equal(v, d.mass / d.k1 * loop.measured.velocity))}


def quadratic_form() -> dict[str, bool]:
    """Λ' along the motion against the form in Y, with F = c(δ3 - δ2) and η from the tilt."""
    loop, form = axial_loop(), derive_form()
    d, e, z = loop.design, loop.errors, loop.measured
    a = form.weights
    energy = half_squares(a, e)
    potential_rate = -ca.dot(z.centroid - d.goal_centroid[2] * z.gravity_direction, z.velocity)
    rate = -d.mass / d.k1 * (potential_rate + loop.dot(energy))
    theta = form.theta
    size = ca.dot(theta, theta)
    rho = ca.vertcat(2 * theta, 1 - size) / (1 + size)
    Y = ca.vertcat(z.centroid - d.goal_centroid[2] * z.gravity_direction, e.d2, e.d3, e.d4)
    claimed = ca.substitute(
        form.dissipation,
        ca.vertcat(form.design.vector(), form.f, form.Q_lower, form.errors),
        ca.vertcat(d.vector(), loop.factor, loop.Q_lower, Y),
    )

    def at_tilt(value: ca.SX) -> ca.SX:
        return ca.substitute(loop.axial(value), z.gravity_direction, rho)

    return {
        "-(m/k1) Λ' = the form in Y, any Ω": bool(prove_equal(at_tilt(rate), at_tilt(claimed))),
        "the form as stated": bool(prove_equal(form.dissipation, _stated_form(form))),
    }


def _stated_form(form: AttractionForm) -> ca.SX:
    """Return the quadratic form as the lemma states it."""
    d, Y, f, (a2, a3, a4) = form.design, form.errors, form.f, ca.vertsplit(form.weights)
    e, d2, d3, d4 = Y[0:3], Y[3:6], Y[6:9], ca.vertcat(Y[9:11], 0)
    q3, K = d.goal_centroid[2], (d.k1 * d.k2 + d.k3) / d.k1
    lean = P - E3 @ ca.vertcat(form.theta, 0).T
    eta = q3 * d.stiffness / (d.mass * d.gravity) * lean @ (d3 - d2)
    v = e + eta + d2
    flow = form.Q @ v
    second = d.k2 * ca.dot(d2, d2) - d.k2 * ca.dot(d2, d3) + f * q3 * ca.dot(d2, P @ (d4 - d3))
    third = d.k2 * ca.dot(d3, d2) - K * ca.dot(d3, d4) + d.k3 / d.k1 * ca.dot(d3, d3)
    fourth = K * ca.dot(d4, d3) + d.k4 / d.k1 * ca.dot(d4, d4)
    return (
        ca.dot(e, v)
        + a2 * (second - ca.dot(d2, flow))
        + a3 * (third - ca.dot(d3, flow))
        + a4 * (fourth - ca.dot(d4, flow))
    )


def convexity() -> dict[str, bool]:
    """In what the form is affine."""
    form = derive_form()
    q = form.design.goal_centroid[2]
    value = form.dissipation
    second = {
        "f": ca.jacobian(ca.jacobian(value, form.f), form.f),
        "q3*": ca.jacobian(ca.jacobian(value, q), q),
        "θ": ca.jacobian(ca.jacobian(value, form.theta), form.theta),
        "Q": ca.jacobian(ca.jacobian(value, form.Q_lower), form.Q_lower),
    }
    return {f"affine in {name}": bool(prove_zero(h)) for name, h in second.items()} | {
        "f and θ, and f and η, do not meet": bool(
            prove_zero(ca.jacobian(ca.jacobian(value, form.f), form.theta))
        )
    }


def symmetry() -> dict[str, bool]:
    """A turn of all variables about e3."""
    form = derive_form()
    t = ca.SX.sym("t")
    turn = ca.vertcat(ca.horzcat(1 - t**2, -2 * t), ca.horzcat(2 * t, 1 - t**2)) / (1 + t**2)
    whole = ca.diagcat(turn, 1)
    turned = whole @ form.Q @ whole.T
    lower = ca.vertcat(*(turned[i, j] for j in range(3) for i in range(j, 3)))
    Y = ca.diagcat(whole, whole, whole, turn) @ form.errors
    other = ca.substitute(
        form.dissipation,
        ca.vertcat(form.errors, form.theta, form.Q_lower),
        ca.vertcat(Y, turn @ form.theta, lower),
    )
    return {
        "the form is the same after a turn about e3": bool(prove_equal(other, form.dissipation))
    }


def bilinear() -> dict[str, bool]:
    """The form as terms without Q and one bilinear form in Q."""
    form = derive_form()
    u, v = form.flow_weight @ form.errors, form.scaled_velocity @ form.errors
    without = ca.substitute(form.dissipation, form.Q_lower, ca.SX.zeros(6))
    return {
        "the form = [terms without Q] + uᵀQv, u = -(a2 δ2 + a3 δ3 + a4 δ4), v = e + η + δ2": bool(
            prove_equal(form.dissipation, without + u.T @ form.Q @ v)
        ),
    }


def vertical() -> dict[str, bool]:
    """The vertical motion z, and N, which its cascade begins with."""
    loop = axial_loop()
    d, e, z = loop.design, loop.errors, loop.measured
    rho, q3 = z.gravity_direction, d.goal_centroid[2]
    d3, d4 = e.d3[:2], e.d4
    sink = ca.dot(rho, z.velocity)
    force = rigid_body.force(z.thrust, rho, d.mass, d.gravity)
    second = ca.dot(rho, force) / d.mass
    k123 = d.k1 * d.k2 + d.k3
    kappa = k123 / d.mass
    p = ca.dot(rho[:2], k123 * d4 + d.k1 * loop.factor * q3 * (d4 - d3))
    old = ca.dot(rho[:2], k123 * d3 + (k123 + d.k1 * loop.factor * q3) * (d4 - d3))
    w = ca.dot(rho, z.centroid) - q3 * rho[2] + p / k123
    third = -kappa * second - kappa * d.k1 * d.k2 / d.mass * sink + kappa * d.stiffness / d.mass * w
    gain = d.stiffness * q3 / (z.thrust - d.stiffness * q3)
    rest = sink + d.mass / (d.k1 * d.k2) * (second + loop.dot(second) / kappa)
    axial = ca.substitute(ca.vertcat(rest), d.goal_centroid[:2], ca.SX.zeros(2))
    return {
        "z'' = ρᵀF/m": bool(prove_equal(loop.dot(sink), second)),
        "z''' = -κ z'' - κ (k1 k2/m) z' + κ (c/m) w": bool(
            prove_equal(loop.dot(second), loop.axial(third))
        ),
        "both forms of p": bool(prove_equal(p, old)),
        "k1 f q3*/(k1 k2 + k3) = c q3*/(T - c q3*)": bool(
            prove_equal(loop.axial(d.k1 * loop.factor * q3 / k123), loop.axial(gain))
        ),
        "N' = (k1/m) w, N = z + (m/(k1 k2)) (z' + z''/κ)": bool(
            prove_equal(axial, loop.axial(d.k1 / d.mass * w))
        ),
    }


def cascade() -> dict[str, bool]:
    """The poles are -r and -s, r + s = κ, r s = κ k1 k2/m; b = k1/m and W = w_max."""
    z, z1, z2, r, s, w, b, W = map(ca.SX.sym, ("z", "z'", "z''", "r", "s", "w", "b", "W"))
    kappa, k2 = r + s, r * s / (b * (r + s))
    N = z + kappa / (r * s) * (z1 + z2 / kappa)
    x = z + z1 / r
    # κ c/m = κ (k1/m)(k1 k2/m) = b r s
    rates = ca.vertcat(z1, z2, -kappa * z2 - r * s * z1 + b * r * s * w)

    def dot(value: ca.SX) -> ca.SX:
        return lie_derivative(value, ca.vertcat(z, z1, z2), rates)

    first, second = b * W / s, b * W / r
    spec = (b * r * s / s + s * b) * W / (r * s)
    return {
        "N' = b w": bool(prove_equal(dot(N), b * w)),
        "x' = s (N - x), x = z + z'/r": bool(prove_equal(dot(x), s * (N - x))),
        "z' = r (x - z)": bool(prove_equal(dot(z), r * (x - z))),
        "(N - x)' = -s (N - x) + b w": bool(prove_equal(dot(N - x), -s * (N - x) + b * w)),
        "(x - z)' = -r (x - z) + s (N - x)": bool(
            prove_equal(dot(x - z), -r * (x - z) + s * (N - x))
        ),
        "N - x = (z'' + r z')/(r s)": bool(prove_equal(N - x, (z2 + r * z1) / (r * s))),
        "b W/s + b W/r = W/k2": bool(prove_equal(first + second, W / k2)),
        "= (κ (c/m)/s + s k1/m) W m/(κ k1 k2)": bool(prove_equal(first + second, spec)),
    }


def weighted_sums() -> dict[str, bool]:
    """What a weighted sum of squares bounds."""
    a, b, s, t, x, y = map(ca.SX.sym, ("a", "b", "s", "t", "x", "y"))
    bound = (s**2 / a + t**2 / b) * (a * x**2 + b * y**2)
    return {
        "(s²/a + t²/b)(a x² + b y²) - (s x + t y)² = (s b y - t a x)²/(a b)": bool(
            prove_equal(bound - (s * x + t * y) ** 2, (s * b * y - t * a * x) ** 2 / (a * b))
        )
    }


def sinking() -> dict[str, bool]:
    """The motion in terms of the body axis b = R e3 and its derivative w, seen from the body."""
    loop = axial_loop()
    d, z, c = loop.design, loop.measured, loop.design.stiffness
    kappa, room = (d.k1 * d.k2 + d.k3) / d.mass, z.thrust - c * d.goal_centroid[2]
    y = d.mass * d.gravity / c * z.gravity_direction + d.mass / d.k1 * z.velocity - z.centroid
    climb = kappa * (c * y[2] - room)
    a = d.mass * d.gravity / d.k1 * z.gravity_direction + (kappa + d.k4 / d.mass) * y
    w = ca.cross(z.rate, E3)
    right = c * kappa / room * P @ a - ca.dot(w, w) * E3
    right -= ((climb + c * kappa * y[2]) / room + d.k4 / d.mass) * w
    gap = loop.dot(w) + ca.cross(z.rate, w) - loop.axial(right)
    ray, velocity, r, D, climbing = (
        ca.SX.sym(n, k) for n, k in (("P", 3), ("v", 3), ("r", 1), ("D", 1), ("T'", 1))
    )
    nearer = -ca.jtimes(1 / ca.sqrt(ca.dot(ray, ray)), ray, velocity)
    return {
        "T' = κ(c bᵀy - D), any Ω": bool(prove_equal(loop.dot(z.thrust), loop.axial(climb))),
        "w', Ω3 = 0": bool(prove_zero(ca.substitute(gap, z.rate[2], 0))),
        "(1/r)' = (P' - ξ)ᵀξ'/r³": bool(
            prove_equal(nearer, ca.dot(ray, velocity) / r**3, {r: ca.dot(ray, ray)})
        ),
        "(1/D)' = -T'/D²": bool(prove_equal(ca.jtimes(1 / D, D, climbing), -climbing / D**2)),
    }


def hover() -> dict[str, bool]:
    """The errors in a level hover."""
    loop = axial_loop()
    d, z = loop.design, loop.measured
    still = ca.vertcat(z.velocity, z.gravity_direction, z.rate[:2], z.thrust)
    level = ca.vertcat(ca.SX.zeros(3), E3, ca.SX.zeros(2), d.mass * d.gravity)
    e = HAMEL_MAHONY.errors(z, d)
    at = ca.substitute(e.vector(), still, level)
    d1 = loop.axial(z.centroid - d.goal_centroid)
    return {
        "δ1 = q - q*, δ2 = δ3 = -δ1, δ4 = -Pδ1 in a level hover": bool(
            prove_equal(loop.axial(at), ca.vertcat(d1, -d1, -d1, -d1[:2]))
        )
    }


def starts() -> dict[str, bool]:
    """The errors at a start that moves."""
    loop = axial_loop()
    d, z, e, c = loop.design, loop.measured, loop.errors, loop.design.stiffness
    rho, weight = z.gravity_direction, d.mass * d.gravity
    force = rigid_body.force(z.thrust, rho, d.mass, d.gravity)
    moved = d.mass / d.k1 * z.velocity
    flat = (weight / c * rho + moved - z.centroid)[:2]
    theta = ca.SX.sym("theta", 2)
    size = ca.dot(theta, theta)
    gap = ca.vertcat(2 * theta, 1 - size) / (1 + size) - E3
    return {
        "F = (m g - T) e3 + m g (ρ - e3)": bool(
            prove_equal(force, (weight - z.thrust) * E3 + weight * (rho - E3))
        ),
        "δ2 = (m/k1) V - δ1": bool(prove_equal(e.d2, moved - e.d1)),
        "δ3 = F/c + δ2": bool(prove_equal(e.d3, force / c + e.d2)),
        "Pδ3 = (m g/c) Pρ + (m/k1) P V - P q": bool(prove_equal(e.d3[:2], flat)),
        "|ρ - e3|² = 4|θ|²/(1 + |θ|²), θ = Pρ/(1 + ρ3)": bool(
            prove_equal(ca.dot(gap, gap), 4 * size / (1 + size))
        ),
    }


def factor() -> dict[str, bool]:
    """The factor f(T), and δ4 less Pδ3."""
    loop = axial_loop()
    d, thrust = loop.design, loop.measured.thrust
    f = thrust_factor(thrust, d)
    room = thrust - d.stiffness * d.goal_centroid[2]
    return {
        "∂f/∂T = -f/(T - c q3*)": bool(prove_equal(ca.jacobian(f, thrust), -f / room)),
        "∂f/∂q3* = c f/(T - c q3*)": bool(
            prove_equal(ca.jacobian(f, d.goal_centroid[2]), d.stiffness * f / room)
        ),
        "δ4 = (m/(c (k1 k2 + k3))) (T - c q3*) e3 × Ω + Pδ3": bool(
            prove_equal(
                loop.errors.d4 - loop.errors.d3[:2],
                loop.axial(
                    d.mass
                    / (d.stiffness * (d.k1 * d.k2 + d.k3))
                    * room
                    * ca.cross(E3, loop.measured.rate)[:2]
                ),
            )
        ),
    }
