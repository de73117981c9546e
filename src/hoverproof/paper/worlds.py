"""Worlds in which the paper's symbols have values, each a graph of the derived model."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from hoverproof.algebra.linear import lie_derivative
from hoverproof.paper.notation import World
from hoverproof.plant import camera, rigid_body
from hoverproof.plant.rigid_body import RigidBodyState
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.lyapunov import lyapunov, symmetric_matrix, thrust_factor
from hoverproof.servo.variables import Design, Measurement


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


def body_in_flight() -> tuple[World, Mapping[ca.SX, ca.SX]]:
    """Return the rigid body with R written by a quaternion, so that RᵀR = I identically."""
    h = ca.SX.sym("h", 4)
    w, v = h[0], h[1:]
    rotation = ca.SX.eye(3) + 2 * (w * ca.skew(v) + ca.skew(v) @ ca.skew(v)) / ca.dot(h, h)
    x, target = RigidBodyState.symbols(), ca.SX.sym("P_world", 3)
    mass, gravity, moments = ca.SX.sym("m"), ca.SX.sym("g"), ca.SX.sym("inertia", 3)
    torque, thrust_rate = ca.SX.sym("Gamma", 3), ca.SX.sym("U")
    rate = rigid_body.state_rate(
        x, torque=torque, thrust_rate=thrust_rate, mass=mass, inertia=moments, gravity=gravity
    )
    seen = camera.body_points(target, x.position, x.rotation)
    values = {
        **{"ξ̇": rate.position, "R": x.rotation, "V": x.velocity, "V̇": rate.velocity},
        **{"Ω": x.rate, "Ω̇": rate.rate, "Ṙ": rate.rotation, "m": mass, "g": gravity},
        "F": rigid_body.force(x.thrust, x.gravity_direction, mass, gravity),
        **{"T": x.thrust, "e3": rigid_body.E3, "Rᵀe3": x.gravity_direction, "Γ": torque},
        **{"𝐈": ca.diag(moments), "𝐈⁻¹": ca.diag(1 / moments), "P'ᵢ": target, "ξ": x.position},
        **{"Pᵢ": seen, "Ṗᵢ": lie_derivative(seen, x.vector(), rate.vector())},
    }
    flat = ca.vec(x.rotation)
    return {n: ca.substitute(y, flat, ca.vec(rotation)) for n, y in values.items()}, {}


def two_points_in_view() -> tuple[World, Mapping[ca.SX, ca.SX]]:
    """Return the spherical image of two points that move as Ṗᵢ = -Ω × Pᵢ - V."""
    points, r = ca.SX.sym("P", 3, 2), ca.SX.sym("r", 2)
    velocity, rate = ca.SX.sym("V", 3), ca.SX.sym("Omega", 3)
    motion = -ca.skew(rate) @ points - ca.repmat(velocity, 1, 2)
    norms = ca.sqrt(ca.sum1(points * points))
    p = points / ca.repmat(norms, 3, 1)
    centroid = camera.centroid(p)

    def change(x: ca.SX) -> ca.SX:
        return lie_derivative(x, ca.vec(points), ca.vec(motion))

    first = p[:, 0]
    projection = ca.SX.eye(3) - first @ first.T
    second = ca.SX.eye(3) - p[:, 1] @ p[:, 1].T
    values = {
        **{"Ω": rate, "V": velocity, "Pᵢ": points[:, 0], "pᵢ": first, "ṗᵢ": change(first)},
        **{"rᵢ": norms[0], "π_p": projection, "q": centroid, "q̇": change(centroid)},
        **{"Q": camera.depth_matrix(points), "Σ pᵢ": p[:, 0] + p[:, 1]},
        "Σ π_pᵢ/rᵢ": projection / norms[0] + second / norms[1],
    }
    roots = {r[i]: ca.dot(points[:, i], points[:, i]) for i in range(2)}
    return values, roots
