"""The paper's equations 36 to 39, of four rotors, beside what positions and senses give."""

from __future__ import annotations

import casadi as ca

from hoverproof.mission.frame import X
from hoverproof.paper.judge import Claim, definition, identity, setting
from hoverproof.paper.notation import Symbol, World
from hoverproof.paper.printed import Equation as E
from hoverproof.paper.symbols import NEWTON, Gamma3, M, T
from hoverproof.plant import rotors

Trr, Trl = Symbol("Trr", "T_{rr}", NEWTON), Symbol("Trl", "T_{rl}", NEWTON)
Tfr, Tfl = Symbol("Tfr", "T_{fr}", NEWTON), Symbol("Tfl", "T_{fl}", NEWTON)
d_arm, kappa = Symbol("d", "d", M), Symbol("κ", r"\kappa", M)
Gamma1 = Symbol("Γ1", r"\Gamma_1", NEWTON * M)
Gamma2 = Symbol("Γ2", r"\Gamma_2", NEWTON * M)

PLACED = (
    "torque r × f of the force f = -T e3 of each rotor at r = (±d, ±d, 0), x forward, y right, "
    "z down; d is then the lever about each axis, and each rotor √2 d from the centre of mass"
)


def four_rotors() -> World:
    """Return the thrust and torque that four rotors make."""
    short = ["T" + "".join(word[0] for word in name.split()) for name in X.names]
    each, d, k = [ca.SX.sym(name) for name in short], ca.SX.sym("d"), ca.SX.sym("kappa")
    made = rotors.wrench(X, ca.vertcat(*each), d, k)
    return {
        **dict(zip(short, each, strict=True)),
        **{"d": d, "κ": k, "T": made[0], "Γ1": made[1], "Γ2": made[2], "Γ3": made[3]},
    }


ROTORS: list[Claim] = [
    definition("36", "thrust of the rotors", E(T, Trr + Trl + Tfr + Tfl), setting(four_rotors)),
    identity(
        "37",
        "roll torque",
        E(Gamma1, d_arm * (Tfr + Tfl - Trr - Trl)),
        setting(four_rotors),
        corrected=E(Gamma1, d_arm * (Trl + Tfl - Trr - Tfr)),
        note=PLACED,
        how="the right sides of 37 and 38 have changed places: as printed they fit x to the left "
        "and y to the rear, and then z is up",
    ),
    identity(
        "38",
        "pitch torque",
        E(Gamma2, d_arm * (Trl + Tfl - Trr - Tfr)),
        setting(four_rotors),
        corrected=E(Gamma2, d_arm * (Tfr + Tfl - Trr - Trl)),
        note=PLACED,
        how="the right sides of 37 and 38 have changed places",
    ),
    definition(
        "39",
        "yaw torque",
        E(Gamma3, kappa * (Tfr + Trl - Tfl - Trr)),
        setting(four_rotors),
        note="front right and rear left turn to the left, seen from above",
    ),
]
