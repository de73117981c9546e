"""The identities behind the energy E of every vehicle within tolerances: E' as a form."""

from __future__ import annotations

import itertools
from dataclasses import replace

import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.certification.exponential.form import (
    ROWS,
    Variables,
    Vertex,
    Weights,
    derive_form,
)
from hoverproof.certification.exponential.identities import GOALS
from hoverproof.servo.lagged import (
    Rotors,
    Setting,
    lagged_rates,
    own_gyroscopic,
    smooth_command,
)
from hoverproof.servo.law import Law
from hoverproof.servo.true_vehicle import QUARTER, kappa
from hoverproof.servo.variables import Errors


def energy() -> dict[str, bool]:
    """How the energy falls, for each goal and kind of rotors."""
    return {
        f"-E' of {goal}, rotors {'that lag' if lagged else 'without lag'}": falls(law, lagged)
        for goal, law in GOALS.items()
        for lagged in (True, False)
    }


def matrices(form: ca.SX) -> dict[str, ca.SX]:
    """Return the matrices of a form by their names.

    Parameters
    ----------
    form : SX
        (62, 20), one above the other, as `derive_form` gives them.
    """
    return dict(
        zip(
            ROWS,
            ca.vertsplit(form, list(itertools.accumulate(ROWS.values(), initial=0))),
            strict=True,
        )
    )


def falls(law: Law, lagged: bool) -> bool:
    """E' by the rates, against the form at ς, χ, h, τ and π and the terms of bounded norm.

    Parameters
    ----------
    law : Law
    lagged : bool
        Whether the rotors lag.
    """
    d, w, x = law.design.symbols(), Weights.symbols(), Variables.symbols()
    at, rotors = Setting.symbols(), Rotors.symbols()
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
    X, m = x.vector(), matrices(form)
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


def vertices() -> dict[str, bool]:
    """Second derivatives of what the inequality is made of."""
    proved: dict[str, bool] = {}
    for goal, law in GOALS.items():
        for lagged in (True, False):
            d, at, w = law.design.symbols(), Vertex.symbols(), Weights.symbols()
            m = matrices(derive_form(law, lagged)(d.vector(), at.vector(), w.vector()))
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


def alike() -> dict[str, bool]:
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
                m = matrices(derive_form(law, lagged)(*(x.vector() for x in symbols)))
                lag = "that lag" if lagged else "without lag"
                proved[f"{goal}, rotors {lag}, {name}: all is the same"] = all(
                    prove_equal(sides[ROWS[n]].T @ m[n] @ T, m[n]) for n in ROWS
                )
    return proved
