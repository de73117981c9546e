"""Identities behind noise, gusts, late images that are not turned, and what is held in steps.

`lemmas` has the ledger that leans on them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca

from hoverproof.algebra.identity import prove_equal
from hoverproof.plant import camera
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.lagged import (
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
from hoverproof.servo.variables import Design, Errors, Measurement


def axes() -> dict[str, bool]:
    """Prove how a feature that is not turned changes, and what is sideways in it."""
    s, rate, y = (ca.SX.sym(name, 3) for name in ("s", "Omega", "y"))
    proved = {
        "s' = -Ω×s - y": bool(prove_equal(camera.centroid_rate(s, rate, y), -skew(rate) @ s - y))
    }
    for goal in ("image", "inertial"):
        law = LAWS["scaled", goal, "measured"]
        loop = derive_lagged_loop(law)
        d, e, body, wind = loop.design, loop.errors, loop.body, loop.wind
        felt = d.stiffness * (e.d3 - e.d2)[:2] - wind[:2]
        lean = 0 if goal == "image" else d.goal_centroid[2] / (d.mass * d.gravity) * felt
        name = "P δ1" if goal == "image" else "P δ1 + (s3*/(m g)) (c P(δ3 - δ2) - P w̃)"
        proved[f"{goal}: P s = {name}"] = bool(prove_equal(body.centroid[:2], e.d1[:2] + lean))
    return proved


def noise() -> dict[str, bool]:
    """Prove what controllers make of measurements that are wrong, and what a gust changes."""
    proved = {"what noise adds to the command": _misled()}
    for law in LAWS.values():
        controller = derive_controller(law)
        d = replace(controller.design, goal_centroid=controller.design.goal_centroid[2] * E3)
        z: Any = controller.measured
        asked, turn, torque = ca.substitute(
            [controller.thrust_rate, controller.angular_acceleration, controller.torque],
            [controller.design.vector()],
            [d.vector()],
        )
        e, k, c = law.errors(z, d), kappa(d), d.stiffness
        lever = law.lever(law.force.thrust(z, d), d)
        h, zeta = c * k / lever, e.d4 - e.d3[:2]
        others = d.mass * z.specific_force if law.force.sensed else ca.SX.zeros(3)
        swing = 2 * h * e.d3[2] + ca.dot(QUARTER @ z.rate[:2], others[:2]) / lever
        command = smooth_command(e, d) - swing * zeta + z.rate[2] * QUARTER @ e.d3[:2]
        proved |= {
            f"{law.name}: U = c κ δ3z": bool(prove_equal(asked, c * k * e.d3[2])),
            f"{law.name}: e3×Ω' = h (s_n - π ζ + Ω3 e3×Pδ3)": bool(
                prove_equal(QUARTER @ turn[:2], h * command)
            ),
            f"{law.name}: its torque makes up for Ω×IΩ": bool(
                prove_equal(torque, d.inertia * turn + skew(z.rate) @ (d.inertia * z.rate))
            ),
            f"{law.name}: what errors it has": _measured_errors(law, d),
        }
    return proved


def _measured_errors(law: Law, d: Design) -> bool:
    """Its δ2 is δ2 - b + (m/k1) v [+ s3* d], its δ3 - δ2 is that plus φ; gusts are in V' alone."""
    true = Measurement.symbols()
    felt = -true.thrust / d.mass * E3 + ca.SX.sym("wind", 3) / d.mass
    b, v, tipped, alpha = (ca.SX.sym(n, 3) for n in ("b", "v", "d", "alpha"))
    told = replace(
        true,
        centroid=true.centroid + b,
        velocity=true.velocity + v,
        gravity_direction=true.gravity_direction + tipped,
    )
    if law.force.sensed:
        known, own = law.force.sensed(told, felt + alpha / d.mass), law.force.sensed(true, felt)
    else:
        known, own, alpha = told, true, ca.SX.zeros(3)
    e, m = law.errors(own, d), law.errors(known, d)
    leans = d.goal_centroid[2] * tipped if law.goal.name == "inertial" else ca.SX.zeros(3)
    nu = b - d.slowness * v - leans
    phi = (alpha + d.mass * d.gravity * tipped) / d.stiffness
    told_lever = law.lever(law.force.thrust(known, d), d)
    lever = law.lever(law.force.thrust(own, d), d)
    by_speed = ca.jacobian(ca.vertcat(e.d1, e.d2, e.d3), true.velocity)
    eye = ca.SX.eye(3)
    return all(
        prove_equal(left, right)
        for left, right in (
            (m.d2, e.d2 - nu),
            (m.d3, e.d3 - (nu - phi)),
            (told_lever, lever - alpha[2]),
            (ca.vec(by_speed), ca.vec(d.slowness * ca.vertcat(0 * eye, eye, eye))),
            (ca.vec(ca.jacobian(e.d4, true.velocity)), ca.vec(d.slowness * eye[:2, :])),
        )
    )


def _misled() -> bool:
    """The command of measured errors, its gyroscopic part included, over the true h."""
    d, e = Design.symbols(), Errors.symbols()
    A, phi, omega = ca.SX.sym("A", 3), ca.SX.sym("phi", 2), ca.SX.sym("omega", 2)
    iota, yaw, w3, h, pi, told = map(ca.SX.sym, ("iota", "yaw", "w3", "h", "pi", "pi_c"))
    K, k12 = kappa(d) + d.k4 / d.mass, d.k1 * d.k2 / d.mass
    own, zeta, missed = own_gyroscopic(d), e.d4 - e.d3[:2], (e.d3 - A)[:2]
    seen = (h * zeta + omega) / (h * (1 + iota))  # ζ of the controller
    pulled = (e.d3 - e.d2)[:2]
    asked = -K * (seen + missed) - k12 * (pulled + phi) - told * seen
    asked += (yaw + w3) * QUARTER @ missed
    asked = (1 + iota) * asked + (yaw + w3) * own @ (h * zeta + omega) / h
    calm = smooth_command(e, d) + K * A[:2] - pi * zeta
    calm += yaw * QUARTER @ missed + yaw * own @ zeta
    C = -(1 + iota) * k12 * phi - (K + told) * omega / h + (yaw + w3) * own @ omega / h
    more = C - (told - pi) * zeta + w3 * own @ zeta + (1 + iota) * w3 * QUARTER @ missed
    more -= iota * (K * missed - yaw * QUARTER @ missed) + iota * k12 * pulled
    return bool(prove_equal(asked, calm + more))


def held() -> dict[str, bool]:
    """Prove how errors change while an output is held, and what remembers by how much."""
    d, e, at, rotors = Design.symbols(), Errors.symbols(), Setting.symbols(), Rotors.symbols()
    rates = lagged_rates(e, at, rotors, d)
    d2, d3, d4 = rates[3:6], rates[6:9], rates[9:11]
    k, k12, h, zeta = kappa(d), d.k1 * d.k2 / d.mass, at.quickness, e.d4 - e.d3[:2]
    turn = -skew(ca.vertcat(-QUARTER @ (h * zeta), at.yaw))
    lifted = rotors.thrust_gain * (k * e.d3[2] + rotors.thrust)  # ς u
    pushed = ca.vertcat(k * at.lever_ratio * zeta, -lifted)
    dragged = ca.vertcat(at.goal * h * zeta, 0)
    applied = smooth_command(e, d) + rotors.torque
    gain, turned = (ca.reshape(x, 2, 2) for x in (rotors.angular_gain, rotors.gyroscopic))
    drift = h / k * lifted + at.crosswind  # D_c'/D_c
    return {
        "δ3' - y = k12 (δ3 - δ2) + P κχζ - Ω×δ3 - ς u e3": bool(
            prove_equal(d3 - at.depth_flow, k12 * (e.d3 - e.d2) + pushed + turn @ e.d3)
        ),
        "(δ3 - δ2)' = P (κχ + s3 h) ζ - Ω×(δ3 - δ2) - ς u e3": bool(
            prove_equal(d3 - d2, pushed + dragged + turn @ (e.d3 - e.d2))
        ),
        "(h ζ)'/h = (I + γ)(s_n + μ) - Ω3 G_t ζ": bool(
            prove_equal(
                d4 - d3[:2] - drift * zeta,
                applied + gain @ applied - at.yaw * turned @ zeta,
            )
        ),
        **_memories(),
    }


def _memories() -> dict[str, bool]:
    """Prove what an integral that begins anew, and one that fades, come to."""
    w, g, psi, a = map(ca.SX.sym, ("w", "g", "psi", "a"))
    grows = 2 * w * g * psi - w**2 * (a**2 + psi**2)  # of w² ψ, w' = g, ψ' = -a² - ψ²
    r, f, early, late = map(ca.SX.sym, ("r", "f", "A", "B"))
    first = (early - 1) / r + early * f / (1 - r * f)
    return {
        "g² - a² w² - (w²ψ)' = (g - wψ)², w' = g, ψ' = -a² - ψ²": bool(
            prove_equal(g**2 - (a * w) ** 2 - grows, (g - w * psi) ** 2)
        ),
        "k' = -r k - 1, k = (A - 1)/r + A f'/(1 - r f'), A' = -r A": bool(
            prove_equal(-r * early * ca.jacobian(first, early), -r * first - 1)
        ),
        "k' = -r k - B, k = B f'/(1 - r f'), B' = -B/f'": bool(
            prove_equal(-late / (1 - r * f), -r * late * f / (1 - r * f) - late)
        ),
    }
