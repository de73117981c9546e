"""The control law as firmware computes it: from what sensors deliver to rotor thrusts.

The law is the derived controller, exactly; only its variables are others. In the errors δ2 and δ3,
and in deviations from hover (q - q*, ρ - e3, T - m g), it takes few operations, none of them the
difference of two large numbers: near hover every quantity is small, and so is its rounding.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import casadi as ca

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.linear import solve_affine
from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.export.closed_form import closed_forms
from hoverproof.export.quadratic import Coefficients, Variables, quadratic
from hoverproof.mission.sections import Mission
from hoverproof.plant import camera, rigid_body, rotors
from hoverproof.plant.goal import hover_goal
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.error_chain import Design, errors
from hoverproof.servo.loop import thrust_margin

GAINS = ("k1", "k2", "k3", "k4", "k_yaw")
GAINS_AT = slice(5, 10)
"""Where they stand among the numbers of `Design`."""

AXES = ("x", "y", "z")


@dataclass(frozen=True)
class FlightLaw:
    """The law as one graph, with the numbers in it.

    Attributes
    ----------
    function : casadi.Function
        (image or centroid, velocity, rate, gravity_direction, thrust_excess, coefficients) ↦ the
        outputs thrust_rate in N/s, torque in N m and rotor in N, and what else is worth a name.
    coefficients : dict of str to Fraction
        The numbers, exact, in the order of the last input.
    meanings : dict of str to str
        The closed form of each in m, g, I1, I2, I3, k1, k2, k3, k4, k_yaw, q = q*, d and kappa.
    of_gains : casadi.Function
        (gains (5,), rest of the design) ↦ coefficients, the gains in the order of `GAINS`.
    fixed : list of Fractions
        The rest of the design, (10,): vehicle and q*.
    tuned : tuple of str
        The coefficients that depend on the gains.
    singular_excess : Fraction
        T - m g at which the law is singular, N.
    """

    function: ca.Function
    coefficients: dict[str, Fraction]
    meanings: dict[str, str]
    of_gains: ca.Function
    fixed: list[Fraction]
    tuned: tuple[str, ...]
    singular_excess: Fraction


def flight_law(mission: Mission, *, sensing: str = "points", tunable: bool = False) -> FlightLaw:
    """Return the law of a mission.

    Parameters
    ----------
    mission : Mission
    sensing : {"points", "centroid"}
        What the camera delivers: pinhole image points (2, n), focal length 1, or the image centroid
        (3,) already summed.
    tunable : bool
        Keep the five gains as parameters: a coefficient is then left out only if it vanishes
        whatever they are.

    Raises
    ------
    AssertionError
        If the graph is not the derived controller, compared in exact arithmetic.
    """
    chain = _chain()
    here = _design_values(mission)
    samples = [here, *(_with_gains(here, g) for g in _other_gains(here))] if tunable else [here]
    numbers = Coefficients(chain.design, samples)
    by_centroid = _function(_scheme(chain, numbers, ca.SX.sym("centroid", 3)), chain, numbers)
    forms = closed_forms(ca.vertcat(*numbers.expressions.values()))
    expressions = ca.vertcat(*(form.value for form in forms))
    at_samples = numbers.at_samples(expressions)
    for i, sample in enumerate(samples):
        assert_is_the_controller(by_centroid, sample, [values[i] for values in at_samples])
    function = by_centroid
    if sensing == "points":  # the same behind the camera's own equations
        image = ca.SX.sym("image", 2, len(mission.target.points))
        function = _function(_scheme(chain, numbers, image), chain, numbers)
    gains, rest = chain.design[GAINS_AT], ca.vertcat(chain.design[:5], chain.design[10:])
    (singular,) = numbers.at_samples(chain.singular)
    return FlightLaw(
        function=function,
        coefficients={k: v[0] for k, v in zip(numbers.expressions, at_samples, strict=True)},
        meanings={k: form.text for k, form in zip(numbers.expressions, forms, strict=True)},
        of_gains=ca.Function("of_gains", [gains, rest], [ca.cse(expressions)]),
        fixed=[*here[:5], *here[10:]],
        tuned=tuple(
            k
            for k, form in zip(numbers.expressions, forms, strict=True)
            if ca.depends_on(form.value, gains)
        ),
        singular_excess=singular[0],
    )


def assert_is_the_controller(
    function: ca.Function, design: Sequence[Fraction], coefficients: Sequence[Fraction]
) -> None:
    """Compare a law with the derived controller and rotor mixing, exactly, at random points.

    Two rational functions of such low degree that agree at a random point of so many digits are
    the same but for a chance that is nil.

    Parameters
    ----------
    function : casadi.Function
        The law by its centroid, as in `FlightLaw`.
    design : sequence of Fractions
        (15,): that of `Design`, then the arm in m and the drag ratio in m.
    coefficients : sequence of Fractions
        Those of the law in this design, (n,).

    Raises
    ------
    AssertionError
        If they differ.
    """
    draw = random.Random(1)

    def some(n: int) -> list[Fraction]:
        return [Fraction(draw.randint(-(10**9), 10**9), 10**8 + 7) for _ in range(n)]

    centroid, velocity, rate, gravity_direction, (excess,) = map(some, (3, 3, 3, 3, 1))
    got = evaluate(
        function, [centroid, velocity, rate, gravity_direction, [excess], list(coefficients)]
    )
    named = dict(zip((function.name_out(i) for i in range(function.n_out())), got, strict=True))
    mass, gravity, arm, drag = design[0], design[1], design[13], design[14]
    thrust = mass * gravity + excess
    measured = [*centroid, *velocity, *gravity_direction, *rate, thrust]
    thrust_rate, torque = evaluate(derive_controller().function(), [measured, design[:13]])
    T, Gamma, d, k = ca.SX.sym("T"), ca.SX.sym("Gamma", 3), ca.SX.sym("d"), ca.SX.sym("k")
    mixing = ca.Function("mixing", [T, Gamma, d, k], [rotors.rotor_thrusts(T, Gamma, d, k)])
    (mixed,) = evaluate(mixing, [[thrust], [row[0] for row in torque], [arm], [drag]])
    for name, wanted in (("thrust_rate", thrust_rate), ("torque", torque), ("rotor", mixed)):
        if named[name] != wanted:  # not an assert statement, which `python -O` leaves out
            raise AssertionError(f"{name} of the C is not that of the derived controller")


def _design_values(mission: Mission) -> list[Fraction]:
    """Return the numbers of a mission in the order of the chain's design, (15,)."""
    goal = hover_goal(mission).centroid_midpoint
    vehicle = mission.vehicle
    return [*Design.values(mission, goal), vehicle.arm, vehicle.drag_ratio]


def _other_gains(design: Sequence[Fraction]) -> list[list[Fraction]]:
    draw = random.Random(0)
    return [
        [gain * Fraction(draw.randint(500, 2000), 1009) for gain in design[GAINS_AT]]
        for _ in range(2)
    ]


def _with_gains(design: Sequence[Fraction], gains: Sequence[Fraction]) -> list[Fraction]:
    return [*design[: GAINS_AT.start], *gains, *design[GAINS_AT.stop :]]


def _function(named: dict[str, ca.SX], chain: _Chain, numbers: Coefficients) -> ca.Function:
    seen = named.pop("seen")
    inputs = {
        "seen": seen,
        "velocity": chain.velocity,
        "rate": chain.rate,
        "gravity_direction": chain.gravity_direction,
        "thrust_excess": chain.excess,
        "coefficients": ca.vertcat(*numbers.symbols.values()),
    }
    law = ca.Function("law", list(inputs.values()), list(named.values()), list(inputs), list(named))
    return share_reciprocals(law)


@dataclass(frozen=True)
class _Chain:
    """The law as a chain of quadratic polynomials, each over the results before it.

    First the symbols: of design, inputs, and what is worked out on the way (image_error = q - q*,
    tilt = ρ - e₃, d2 = δ2, s, acceleration = Ω̇). Then the polynomials: δ2 and s of what comes
    before them; U, the two parts of the horizontal Ω̇ (direct + divided/gap), the gap T - c q3*
    and the T - m g where it vanishes; Ω̇3; and the torque.
    """

    design: ca.SX
    parts: Design
    arm: ca.SX
    drag: ca.SX
    velocity: ca.SX
    rate: ca.SX
    gravity_direction: ca.SX
    excess: ca.SX
    image_error: ca.SX
    tilt: ca.SX
    d2: ca.SX
    s: ca.SX
    acceleration: ca.SX
    d2_of: ca.SX
    s_of: ca.SX
    thrust_rate: ca.SX
    direct: ca.SX
    divided: ca.SX
    gap: ca.SX
    singular: ca.SX
    yaw: ca.SX
    torque: ca.SX


@cache
def _chain() -> _Chain:
    """Put the derived controller into the variables δ2, s = κ δ3, Ω and T - m g.

    κ is the coefficient of δ3 in U. Over the gap T - c q3* the horizontal Ω̇ is affine plus a
    fraction: its numerator is divided by the gap as polynomials in T.
    """
    law = derive_controller()
    z, d = law.measured, law.design
    arm, drag = ca.SX.sym("arm"), ca.SX.sym("drag_ratio")
    weight = d.mass * d.gravity
    d1, d2, s, tilt = (ca.SX.sym(name, 3) for name in ("image_error", "d2", "s", "tilt"))
    excess, alpha = ca.SX.sym("thrust_excess"), ca.SX.sym("alpha", 3)
    thrust = weight + excess
    e = errors(z, d)

    unknown = ca.vertcat(z.centroid, z.velocity, z.gravity_direction)
    d3 = ca.SX.sym("d3", 3)
    back = solve_affine(ca.vertcat(e.d1, e.d2, e.d3) - ca.vertcat(d1, d2, d3), unknown)
    back = ca.substitute(back, z.thrust, thrust)
    old, new = ca.vertcat(unknown, z.thrust), ca.vertcat(back, thrust)
    rate_of_thrust, turn = ca.substitute([law.thrust_rate, law.angular_acceleration], [old], [new])
    scale = ca.jacobian(rate_of_thrust, d3[2])
    old, new = ca.vertcat(d1, d3), ca.vertcat(ca.SX.zeros(3), s / scale)  # δ1 is in δ2 and δ3 alone
    rate_of_thrust, turn = ca.substitute([rate_of_thrust, turn], [old], [new])

    gap = thrust_margin(thrust, d)
    numerator = turn[:2] * gap
    direct = ca.jacobian(numerator, excess)
    shifted = ca.vertcat(z.centroid, z.gravity_direction, z.thrust)
    deviations = ca.vertcat(d1 + d.goal_centroid, tilt + rigid_body.E3, thrust)
    d2_of, d3_of = ca.substitute([e.d2, e.d3], [shifted], [deviations])
    torque = ca.SX.sym("torque", 3)
    balance = rigid_body.torque_balance(z.rate, alpha, d.inertia, torque)
    return _Chain(
        design=ca.vertcat(d.vector(), arm, drag),
        parts=d,
        arm=arm,
        drag=drag,
        velocity=z.velocity,
        rate=z.rate,
        gravity_direction=z.gravity_direction,
        excess=excess,
        image_error=d1,
        tilt=tilt,
        d2=d2,
        s=s,
        acceleration=alpha,
        d2_of=d2_of,
        s_of=scale * (d3_of - d2_of + d2),
        thrust_rate=rate_of_thrust,
        direct=direct,
        divided=numerator - direct * gap,
        gap=gap,
        singular=solve_affine(gap, excess),
        yaw=turn[2],
        torque=solve_affine(balance, torque),
    )


def _scheme(law: _Chain, numbers: Coefficients, seen: ca.SX) -> dict[str, ca.SX]:
    """Build the graph; every value in it that has a meaning comes with a name."""
    rate = _variables("rate", law.rate)

    def over(*parts: tuple[str, ca.SX]) -> Variables:
        packed = [_variables(name, value) for name, value in parts]
        names = tuple(n for p in packed for n in p.names)
        return Variables(names, ca.vertcat(*(p.vector for p in packed)))

    q = camera.centroid(camera.spherical(seen)) if seen.shape[0] == 2 else seen
    goal = quadratic(law.parts.goal_centroid, [f"goal_{a}" for a in AXES], rate, numbers)
    image_error = q - ca.vertcat(*goal)
    tilt = law.gravity_direction - rigid_body.E3
    d2 = quadratic(
        law.d2_of,
        [f"d2_{a}" for a in AXES],
        over(("velocity", law.velocity), ("image", law.image_error)),
        numbers,
    )
    s = quadratic(
        law.s_of,
        [f"s_{a}" for a in AXES],
        over(("d2", law.d2), ("tilt", law.tilt), ("excess", law.excess)),
        numbers,
    )
    state = over(("rate", law.rate), ("s", law.s), ("d2", law.d2), ("excess", law.excess))
    outputs = ca.vertcat(law.thrust_rate, law.direct, law.divided, law.yaw, law.gap)
    names = ["U", "roll", "pitch", "roll_gap", "pitch_gap", "yaw", "hover_gap"]
    U, *rest = quadratic(outputs, names, state, numbers, factored=3)
    direct, divided, yaw, gap = rest[0:2], rest[2:4], rest[4], rest[5]
    alpha = ca.vertcat(*(a + b / gap for a, b in zip(direct, divided, strict=True)), yaw)
    torque = quadratic(
        law.torque,
        [f"torque_{a}" for a in AXES],
        over(("rate", law.rate), ("alpha", law.acceleration)),
        numbers,
    )
    wrench = over(("thrust", law.excess), ("torque", law.s))  # any symbols do
    mixing = rotors.rotor_thrusts(
        law.excess + law.parts.mass * law.parts.gravity, law.s, law.arm, law.drag
    )
    mixed = quadratic(mixing, ["rotor"] * 4, wrench, numbers)

    graph = {"seen": seen, "centroid": q, "image_error": image_error, "tilt": tilt}
    held = ca.vertcat(law.image_error, law.tilt)
    graph["d2"] = ca.substitute(ca.vertcat(*d2), held, ca.vertcat(image_error, tilt))
    graph["s"] = ca.substitute(
        ca.vertcat(*s), ca.vertcat(law.d2, law.tilt), ca.vertcat(graph["d2"], tilt)
    )
    inner, outer = ca.vertcat(law.d2, law.s), ca.vertcat(graph["d2"], graph["s"])
    graph["thrust_rate"] = ca.substitute(U, inner, outer)
    graph["gap"] = gap
    graph["alpha"] = ca.substitute(alpha, inner, outer)
    graph["torque"] = ca.substitute(ca.vertcat(*torque), law.acceleration, graph["alpha"])
    graph["rotor"] = ca.substitute(ca.vertcat(*mixed), law.s, graph["torque"])
    return graph


def _variables(name: str, vector: ca.SX) -> Variables:
    names = [name] if vector.shape[0] == 1 else [f"{name}_{a}" for a in AXES]
    return Variables(tuple(names), vector)
