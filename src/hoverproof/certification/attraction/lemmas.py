"""The second ledger: the lemmas behind a region of attraction, each with its proof.

Whatever is an identity is proved by `algebra.identity` from the derived model, all parameters
symbolic; an inequality is reduced to an identity whose sign can be seen, or proved in words. The
goal is axial, q* = q3* e3; the yaw rate is arbitrary, for it drops out of everything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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


@dataclass(frozen=True)
class Lemma:
    """A statement, its proof in words, and the identities that the proof leans on.

    Attributes
    ----------
    id, title : str
    statement, proof : str
        In words and formulas.
    identities : callable
        Returns whether each identity holds, by exact computation, under its name.
    """

    id: str
    title: str
    statement: str
    proof: str
    identities: Callable[[], dict[str, bool]]

    def proved(self) -> bool:
        """Compute whether every identity of the proof holds."""
        return all(self.identities().values())


def _potential() -> dict[str, bool]:
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


def _height() -> dict[str, bool]:
    d, h, r = map(ca.SX.sym, ("d", "h", "r"))
    part = h / ca.sqrt(d**2 + h**2)
    return {
        "∂(h/r)/∂h = d²/r³, r² = d² + h²": bool(
            prove_equal(ca.jacobian(part, h), d**2 / r**3, {r: d**2 + h**2})
        )
    }


def _slope() -> dict[str, bool]:
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


def _tilt() -> dict[str, bool]:
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


def _closed_loop() -> dict[str, bool]:
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


def _quadratic_form() -> dict[str, bool]:
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


def _convexity() -> dict[str, bool]:
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


def _symmetry() -> dict[str, bool]:
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


def _bilinear() -> dict[str, bool]:
    form = derive_form()
    u, v = form.flow_weight @ form.errors, form.scaled_velocity @ form.errors
    without = ca.substitute(form.dissipation, form.Q_lower, ca.SX.zeros(6))
    return {
        "the form = [terms without Q] + uᵀQv, u = -(a2 δ2 + a3 δ3 + a4 δ4), v = e + η + δ2": bool(
            prove_equal(form.dissipation, without + u.T @ form.Q @ v)
        ),
    }


def _vertical() -> dict[str, bool]:
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


def _cascade() -> dict[str, bool]:
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


def _weighted_sums() -> dict[str, bool]:
    a, b, s, t, x, y = map(ca.SX.sym, ("a", "b", "s", "t", "x", "y"))
    bound = (s**2 / a + t**2 / b) * (a * x**2 + b * y**2)
    return {
        "(s²/a + t²/b)(a x² + b y²) - (s x + t y)² = (s b y - t a x)²/(a b)": bool(
            prove_equal(bound - (s * x + t * y) ** 2, (s * b * y - t * a * x) ** 2 / (a * b))
        )
    }


def _sinking() -> dict[str, bool]:
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


def _hover() -> dict[str, bool]:
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


def _starts() -> dict[str, bool]:
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


def _factor() -> dict[str, bool]:
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


LEMMAS = (
    Lemma(
        "W",
        "the natural potential",
        "Let 0 < q3* < n and the points not all on one vertical line. G(ξ) = Σ |P'ᵢ - ξ| + q3* z "
        "is least at exactly one point ξ*. W = G - G(ξ*) is convex, W > 0 but at ξ*, and its level "
        "sets are compact. Where ξ is no target point, W is smooth, its Hessian is Q, its gradient "
        "is -Re, e = q - q3* ρ, and W' = -eᵀV along the motion. If ξ* is no target point, it is "
        "the only one from which a level camera sees q = q3* e3; if it is one, no level camera "
        "sees that.",
        "G is convex and continuous, and G ≥ (n - q3*)|ξ| - Σ |P'ᵢ|: so it has a minimum, and its "
        "level sets are compact. Were it least at two points, it would be so on the segment "
        "between them, of direction x; take a ξ of that which is no target point. There ∇G = 0, so "
        "the unit vectors along the rays from ξ add up to q3* e3; and xᵀQx = Σ |pᵢ × x|²/rᵢ = 0, "
        "so all rays are along x. As q3* e3 ≠ 0, x is vertical, and all points are on one vertical "
        "line, which is excluded. Off the target points, a level camera sees q3* e3 just where ∇G "
        "= 0, and a convex G is least there.",
        _potential,
    ),
    Lemma(
        "height",
        "the part qz of the centroid",
        "Let h be the height of ξ above a target point, r its distance and d that from the "
        "vertical line through the point. Where r > 0, h/r does not fall as h grows with d fixed. "
        "So, if z ≥ z_s and ξ is no target point, qz(ξ) = Σ hᵢ/rᵢ is at most the sum of hᵢ/√(hᵢ² + "
        "dᵢ²) over the points deeper than z_s, hᵢ > 0 taken at z_s.",
        "If d > 0, h/r grows with h, by the identity. On the point's own vertical line, d = 0, it "
        "is -1 below the point and 1 above it: it jumps where it is not defined, and it jumps "
        "upward. So a term with hᵢ > 0 at z is at most what it is at z_s ≤ z, where hᵢ is larger; "
        "a term with hᵢ ≤ 0 at z is at most 0.",
        _height,
    ),
    Lemma(
        "slope",
        "how fast Q changes with the position",
        "Along a unit vector h the derivative of (I - ppᵀ)/r has norm at most (2/√3)/r².",
        "Its eigenvalues times r² are α = pᵀh, |α| ≤ 1, and the roots μ of μ² - α μ - (1 - α²), "
        "real as D is symmetric; by the last identity 3μ² ≤ 4.",
        _slope,
    ),
    Lemma(
        "tilt",
        "force, thrust and tilt",
        "With F = c(δ3 - δ2), η = δ1 - e = (q3* c/(m g)) (P - e3 θᵀ)(δ3 - δ2), θ = Pρ/(1 + ρ3), "
        "|θ| = tan(φ/2). While T > 0 and |F| < m g: |T - m g| <= |F|, sin φ <= |F|/(m g), φ < 90°.",
        "|F|² is (T - m g)² plus a term that is not negative. If ρ3 <= 0, that term is at least 2 "
        "T m g, so |F|² >= T² + (m g)², against |F| < m g. Hence ρ3 > 0, φ < 90°. |Pρ| = sin φ, "
        "and P F = m g Pρ gives the rest.",
        _tilt,
    ),
    Lemma(
        "loop",
        "the closed loop",
        "For an axial goal, and any yaw rate Ω3, with v = δ1 + δ2 = (m/k1) V, "
        "m δ2' = -m Ω×δ2 + k1 Q v - k1 k2 δ2 + k1 k2 δ3 - k1 f q3* P(δ4 - δ3), "
        "m δ3' = -m Ω×δ3 + k1 Q v - k1 k2 δ2 + (k1 k2 + k3) δ4 - k3 δ3, "
        "m δ4' = k1 P Q v - (k1 k2 + k3) Pδ3 - k4 δ4.",
        "By differentiation along the derived closed loop.",
        _closed_loop,
    ),
    Lemma(
        "form",
        "the derivative of Λ",
        "For Λ = W + ½(a2|δ2|² + a3|δ3|² + a4|δ4|²) and K = (k1 k2 + k3)/k1, "
        "-(m/k1) Λ' = eᵀv + a2 [k2|δ2|² - k2 δ2ᵀδ3 + f q3* δ2ᵀP(δ4 - δ3) - δ2ᵀQv] "
        "+ a3 [k2 δ3ᵀδ2 - K δ3ᵀδ4 + (k3/k1)|δ3|² - δ3ᵀQv] "
        "+ a4 [K δ4ᵀδ3 + (k4/k1)|δ4|² - δ4ᵀQv], v = e + η + δ2: a quadratic form of "
        "Y = (e, δ2, δ3, δ4), whatever Ω is.",
        "By differentiation; the terms in Ω drop out.",
        _quadratic_form,
    ),
    Lemma(
        "Q",
        "one bilinear form in Q",
        "For symmetric Q with eigenvalues in [0, λ] and any τ > 0, "
        "uᵀQv >= (λ/2)(uᵀv - ½(τ|v|² + |u|²/τ)).",
        "Q = (λ/2)(I + H), |H| <= 1, and uᵀHv >= -|u||v| >= -½(τ|v|² + |u|²/τ).",
        _bilinear,
    ),
    Lemma(
        "corners",
        "corners suffice",
        "If the form minus ε|Y|² is positive for every Q in [0, λ], at both ends of f and q3* (all "
        "four pairs), and at the one tilt θ = (t, 0), it is so for all f and q3* between and all "
        "|θ| <= t.",
        "A turn about e3 carries θ = (t, 0) to any θ with |θ| = t, and the set of all Q to itself. "
        "For fixed Q the form is affine in each of f, q3*, θ, and a disc is the hull of its edge.",
        lambda: _convexity() | _symmetry(),
    ),
    Lemma(
        "factor",
        "the factor f(T), and the body rates",
        "For T > c q3* > 0, f(T) falls with T and grows with q3*, and δ4 - Pδ3 tells the rates of "
        "roll and pitch: |δ4 - Pδ3| = (m/(c (k1 k2 + k3))) (T - c q3*) √(Ω1² + Ω2²).",
        "By the signs of the derivatives, as f > 0. |e3 × Ω|² = Ω1² + Ω2².",
        _factor,
    ),
    Lemma(
        "sums",
        "what a level bounds",
        "If a|x|² + b|y|² <= 2ℓ then |s x + t y| <= √(2ℓ(s²/a + t²/b)).",
        "Apply the identity to |s||x| + |t||y|.",
        _weighted_sums,
    ),
    Lemma(
        "z",
        "the vertical motion",
        "With κ = (k1 k2 + k3)/m, N = z + (m/(k1 k2))(z' + z''/κ) obeys N' = (k1/m) w, "
        "w = ρᵀq - q3* cos φ + (Pρ)ᵀ[(1 + γ) δ4 - γ Pδ3], γ = c q3*/(T - c q3*), ρᵀq = qz. "
        "While Λ <= ℓ, T >= T₋ > c q3* and φ <= φ̄ < 90°: w <= qz - q3* + ω with "
        "ω = q3*(1 - cos φ̄) + sin φ̄ √(2ℓ((1 + γ)²/a4 + γ²/a3)), γ taken at T₋.",
        "By differentiation. w - qz + q3* is at most q3*(1 - cos φ) + |Pρ|((1 + γ)|δ4| + γ|δ3|), "
        "where |Pρ| = sin φ, and a3|δ3|² + a4|δ4|² <= 2ℓ as W >= 0, so the lemma on sums gives ω "
        "with φ and T in the place of φ̄ and T₋. It grows with γ > 0, and γ falls as T grows; it "
        "grows with φ, as 1 - cos φ and sin φ do up to 90°.",
        _vertical,
    ),
    Lemma(
        "barrier",
        "nothing sinks below the barrier",
        "Let k3 >= 3 k1 k2, let r <= s be the roots of x² - κ x + κ k1 k2/m, and let "
        "D1 >= (k1/m) w_max/s, D2 >= s D1/r, w_max > 0, z_b = z_s + D1 + D2. Let z <= z_b, "
        "x = z + z'/r <= z_b, N <= z_b, N - x <= D1 and x - z <= D2 at the start, and on the way "
        "w <= w_max, and w <= 0 wherever z >= z_s. Then these five bounds hold on the way. "
        "At rest, z' = z'' = 0, N = x = z, and the least lags will do: D1 + D2 = w_max/k2.",
        "As κ >= 4 k1 k2/m, the roots are real, and positive. (N - x)' <= 0 where N - x >= D1, so "
        "N - x stays at most D1; then x - z stays at most D2 likewise. If N were above z_b at some "
        "time, let t0 be the last time before at which N = z_b: from then on N > z_b, so "
        "z = N - (N - x) - (x - z) > z_s, so N' <= 0, and N could not have grown. "
        "x' <= 0 where x >= z_b >= N, so x stays at most z_b; z follows x likewise.",
        _cascade,
    ),
    Lemma(
        "sinking",
        "the motion in world axes",
        "With Ω3 = 0, b = R e3, w = b', D = T - c q3*, κ = (k1 k2 + k3)/m: T' = κ(c bᵀy - D), "
        "w' = (cκ/D)(I - bbᵀ)a - |w|² b - h w, y = (m g/c) e3 + (m/k1) ξ' - Rq, "
        "a = (m g/k1) e3 + (κ + k4/m) y, h = (T' + cκ bᵀy)/D + k4/m; no heading is in it.",
        "Seen from the body, b is e3, w is Ω × e3 and w' is d(Ω × e3)/dt + Ω × (Ω × e3).",
        _sinking,
    ),
    Lemma(
        "hover",
        "a level hover",
        "In a level hover with T = m g, Λ = W + ½((a2 + a3)|δ1|² + a4|Pδ1|²), δ1 = q - q*.",
        "δ2 = δ3 = -δ1 and δ4 = -Pδ1 there.",
        _hover,
    ),
    Lemma(
        "starts",
        "a start that moves",
        "Let |V| <= v, φ <= φ0, √(Ω1² + Ω2²) <= ω0, |T - m g| <= τ0 < m g - c q3*, and let "
        "q_w = Rq = Σ (P'ᵢ - ξ)/rᵢ be what a level camera sees. Then |δ1| <= |q_w - q*| + q3* φ0, "
        "|δ2| <= (m/k1) v + |δ1|, |F| <= τ0 + m g φ0, |δ3| <= |F|/c + |δ2|, "
        "|Pδ3| <= (m g/c) φ0 + (m/k1) v + |P q_w| + n φ0, and |δ4| is at most the bound of |Pδ3| "
        "plus (m/(c (k1 k2 + k3)))(m g + τ0 - c q3*) ω0; |z'| <= v and |z''| <= |F|/m.",
        "Two unit vectors at an angle φ are 2 sin(φ/2) <= φ apart. R turns e3 by φ: "
        "|δ1| = |q_w - q3* R e3|, |R e3 - e3| <= φ, |ρ - e3| <= φ, |Pρ| = sin φ <= φ. R = R₂ R₁, "
        "where R₁ turns about e3 and R₂ by φ about a horizontal axis. q = R₁ᵀ R₂ᵀ q_w, and R₁ does "
        "not change the length of a P-part, so |P q| = |P R₂ᵀ q_w| <= |P q_w| + φ |q_w|, "
        "|q_w| <= n. The last term of δ4 is that of the lemma on the factor, with "
        "0 < T - c q3* <= m g + τ0 - c q3*. z' = (R V)₃ and z'' = (R F)₃/m.",
        _starts,
    ),
)
