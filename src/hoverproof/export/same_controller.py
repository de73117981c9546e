"""The law of a package is the derived controller: compared in exact arithmetic."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction

import casadi as ca

from hoverproof.algebra.graph import evaluate
from hoverproof.export.chain import body_sensors
from hoverproof.mission.frame import Frame, X
from hoverproof.plant import rotors
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY


def assert_is_the_controller(
    function: ca.Function,
    design: Sequence[Fraction],
    coefficients: Sequence[Fraction],
    law: Law = HAMEL_MAHONY,
    frame: Frame = X,
) -> None:
    """Compare a law with derived controller, rotor mixing and rates, exactly, at random points.

    Two rational functions of such low degree that agree at a random point of so many digits are
    the same but for a chance that is nil.

    Parameters
    ----------
    function : casadi.Function
        The law by its feature, as in `FlightLaw`.
    design : sequence of Fractions
        That of the law, then what places of the frame are multiples of, and the drag ratio, in m,
        and the bandwidth of a rate loop, in rad/s.
    coefficients : sequence of Fractions
        Those of the law in this design, (n,).
    law : Law
    frame : Frame
        Of the rotors.

    Raises
    ------
    AssertionError
        If they differ.
    """
    draw = random.Random(1)

    def some(n: int) -> list[Fraction]:
        return [Fraction(draw.randint(-(10**9), 10**9), 10**8 + 7) for _ in range(n)]

    feature = some(3)
    parts = {name: some(law.measurement.sizes()[name]) for name in body_sensors(law)}
    (excess,) = some(1)
    got = evaluate(function, [feature, *parts.values(), [excess], list(coefficients)])
    named = dict(zip((function.name_out(i) for i in range(function.n_out())), got, strict=True))
    *own, arm, drag, bandwidth = design
    thrust = own[law.design.place("mass").start] * own[law.design.place("gravity").start] + excess
    parts |= {"centroid": feature, "thrust": [thrust]}
    measured = [number for name in law.measurement.sizes() for number in parts[name]]
    controller = derive_controller(law)
    thrust_rate, torque = evaluate(controller.function(), [measured, own])
    T, Gamma, d, k = ca.SX.sym("T"), ca.SX.sym("Gamma", 3), ca.SX.sym("d"), ca.SX.sym("k")
    each = rotors.rotor_thrusts(frame, T, Gamma, d, k)
    mixing = ca.Function("mixing", [T, Gamma, d, k], [each])
    (mixed,) = evaluate(mixing, [[thrust], [row[0] for row in torque], [arm], [drag]])
    wanted_of = {"thrust_rate": thrust_rate, "torque": torque, "rotor": mixed}
    if "rate_command" in named:
        turning = [controller.measured.vector(), controller.design.vector()]
        turned = ca.Function("turned", turning, [controller.angular_acceleration])
        (alpha,) = evaluate(turned, [measured, own])
        pairs = zip(parts["rate"], alpha, strict=True)
        wanted_of["rate_command"] = [[rate + row[0] / bandwidth] for rate, row in pairs]
    for name, wanted in wanted_of.items():
        if named[name] != wanted:  # not an assert statement, which `python -O` leaves out
            raise AssertionError(f"{name} of the C is not that of the derived controller")
