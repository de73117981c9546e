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
from functools import cache, lru_cache

import casadi as ca

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.linear import solve_affine
from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.export.closed_form import closed_forms
from hoverproof.export.quadratic import Coefficients, Variables, quadratic
from hoverproof.mission.sections import Mission
from hoverproof.plant import camera, rigid_body, rotors
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.law import Design, Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY, law_of
from hoverproof.servo.layout import place

ROTORS = {"arm": 1, "drag_ratio": 1}
"""What the firmware needs beside the design of its law, both in m."""

BODY_SENSORS = ("velocity", "rate", "gravity_direction")
"""What the firmware takes in of the body, each (3,), in its own order."""

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
        The closed form of each in m, g, I1, I2, I3, the gains by name, q = q*, d and kappa.
    of_gains : casadi.Function
        (gains (5,), rest of the design) ↦ coefficients, the gains in the order of the law's design.
    fixed : list of Fractions
        The rest of the design, (10,): vehicle and q*.
    tuned : tuple of str
        The coefficients that depend on the gains.
    singular_excess : Fraction
        T - m g at which the law is singular, N.
    source : Law
        The law that it computes.
    """

    function: ca.Function
    coefficients: dict[str, Fraction]
    meanings: dict[str, str]
    of_gains: ca.Function
    fixed: list[Fraction]
    tuned: tuple[str, ...]
    singular_excess: Fraction
    source: Law


def flight_law(
    mission: Mission,
    *,
    sensing: str = "points",
    tunable: bool = False,
    law: Law | None = None,
) -> FlightLaw:
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
    law : Law, optional
        By default that of the mission.

    Raises
    ------
    AssertionError
        If the graph is not the derived controller, compared in exact arithmetic.
    """
    law, points = (
        law or law_of(mission),
        len(mission.target.points) if sensing == "points" else None,
    )
    return _flight_law(law, tuple(_design_values(mission, law)), points, tunable)


@lru_cache(maxsize=8)
def _flight_law(
    law: Law, here: tuple[Fraction, ...], points: int | None, tunable: bool
) -> FlightLaw:
    """Return the law of a design, for so many points in the image or for their centroid."""
    chain = _chain(law)
    samples = [list(here), *(_with_gains(law, here, g) for g in _other_gains(law, here))]
    numbers = Coefficients(chain.design, samples if tunable else samples[:1])
    by_centroid = _function(_scheme(chain, numbers, ca.SX.sym("centroid", 3)), chain, numbers)
    forms = closed_forms(ca.vertcat(*numbers.expressions.values()))
    expressions = ca.vertcat(*(form.value for form in forms))
    at_samples = numbers.at_samples(expressions)
    for i, sample in enumerate(numbers.samples):
        assert_is_the_controller(by_centroid, sample, [values[i] for values in at_samples], law)
    function = by_centroid
    if points is not None:  # the same behind the camera's own equations
        image = ca.SX.sym("image", 2, points)
        function = _function(_scheme(chain, numbers, image), chain, numbers)
    tuned, rest = _gains_and_rest(law)
    (singular,) = numbers.at_samples(chain.singular)
    return FlightLaw(
        function=function,
        coefficients={k: v[0] for k, v in zip(numbers.expressions, at_samples, strict=True)},
        meanings={k: form.text for k, form in zip(numbers.expressions, forms, strict=True)},
        of_gains=ca.Function(
            "of_gains", [chain.design[tuned], chain.design[rest]], [ca.cse(expressions)]
        ),
        fixed=[here[i] for i in rest],
        tuned=tuple(
            k
            for k, form in zip(numbers.expressions, forms, strict=True)
            if ca.depends_on(form.value, chain.design[tuned])
        ),
        singular_excess=singular[0],
        source=law,
    )


def assert_is_the_controller(
    function: ca.Function,
    design: Sequence[Fraction],
    coefficients: Sequence[Fraction],
    law: Law = HAMEL_MAHONY,
) -> None:
    """Compare a law with the derived controller and rotor mixing, exactly, at random points.

    Two rational functions of such low degree that agree at a random point of so many digits are
    the same but for a chance that is nil.

    Parameters
    ----------
    function : casadi.Function
        The law by its centroid, as in `FlightLaw`.
    design : sequence of Fractions
        That of the law, then the arm in m and the drag ratio in m.
    coefficients : sequence of Fractions
        Those of the law in this design, (n,).
    law : Law

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
    *own, arm, drag = design
    thrust = own[law.design.place("mass").start] * own[law.design.place("gravity").start] + excess
    parts = {
        "centroid": centroid,
        "velocity": velocity,
        "gravity_direction": gravity_direction,
        "rate": rate,
        "thrust": [thrust],
    }
    measured = [number for name in law.measurement.sizes() for number in parts[name]]
    thrust_rate, torque = evaluate(derive_controller(law).function(), [measured, own])
    T, Gamma, d, k = ca.SX.sym("T"), ca.SX.sym("Gamma", 3), ca.SX.sym("d"), ca.SX.sym("k")
    mixing = ca.Function("mixing", [T, Gamma, d, k], [rotors.rotor_thrusts(T, Gamma, d, k)])
    (mixed,) = evaluate(mixing, [[thrust], [row[0] for row in torque], [arm], [drag]])
    for name, wanted in (("thrust_rate", thrust_rate), ("torque", torque), ("rotor", mixed)):
        if named[name] != wanted:  # not an assert statement, which `python -O` leaves out
            raise AssertionError(f"{name} of the C is not that of the derived controller")


def _design_values(mission: Mission, law: Law) -> list[Fraction]:
    """Return the numbers of a mission in the order of the chain's design."""
    vehicle = mission.vehicle
    return [*law.design.values(mission, law.goal_feature(mission)), vehicle.arm, vehicle.drag_ratio]


def _gains_and_rest(law: Law) -> tuple[list[int], list[int]]:
    """Return the places of the gains in the chain's design, and all others."""
    sizes = law.design.sizes() | ROTORS
    places = {name: range(sum(sizes.values()))[place(sizes, name)] for name in sizes}
    gains = [i for name in law.design.gains() for i in places[name]]
    return gains, [i for at in places.values() for i in at if i not in gains]


def _other_gains(law: Law, design: Sequence[Fraction]) -> list[list[Fraction]]:
    draw = random.Random(0)
    gains, _ = _gains_and_rest(law)
    return [[design[i] * Fraction(draw.randint(500, 2000), 1009) for i in gains] for _ in range(2)]


def _with_gains(law: Law, design: Sequence[Fraction], gains: Sequence[Fraction]) -> list[Fraction]:
    others = dict(zip(_gains_and_rest(law)[0], gains, strict=True))
    return [others.get(i, number) for i, number in enumerate(design)]


def _function(named: dict[str, ca.SX], chain: _Chain, numbers: Coefficients) -> ca.Function:
    seen = named.pop("seen")
    inputs = {
        "seen": seen,
        **{name: getattr(chain, name) for name in BODY_SENSORS},
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

    law: Law
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
def _chain(law: Law) -> _Chain:
    """Put the derived controller into the variables δ2, s = κ δ3, Ω and T - m g.

    κ is the coefficient of δ3 in U. Over the gap T - c q3* the horizontal Ω̇ is affine plus a
    fraction: its numerator is divided by the gap as polynomials in T.
    """
    controller = derive_controller(law)
    z, d = controller.measured, controller.design
    arm, drag = ca.SX.sym("arm"), ca.SX.sym("drag_ratio")
    weight = d.mass * d.gravity
    d1, d2, s, tilt = (ca.SX.sym(name, 3) for name in ("image_error", "d2", "s", "tilt"))
    excess, alpha = ca.SX.sym("thrust_excess"), ca.SX.sym("alpha", 3)
    thrust = weight + excess
    e = law.errors(z, d)

    unknown = ca.vertcat(z.centroid, z.velocity, z.gravity_direction)
    d3 = ca.SX.sym("d3", 3)
    back = solve_affine(ca.vertcat(e.d1, e.d2, e.d3) - ca.vertcat(d1, d2, d3), unknown)
    back = ca.substitute(back, z.thrust, thrust)
    old, new = ca.vertcat(unknown, z.thrust), ca.vertcat(back, thrust)
    commands = [controller.thrust_rate, controller.angular_acceleration]
    rate_of_thrust, turn = ca.substitute(commands, [old], [new])
    scale = ca.jacobian(rate_of_thrust, d3[2])
    old, new = ca.vertcat(d1, d3), ca.vertcat(ca.SX.zeros(3), s / scale)  # δ1 is in δ2 and δ3 alone
    rate_of_thrust, turn = ca.substitute([rate_of_thrust, turn], [old], [new])

    gap = law.lever(thrust, d)
    numerator = turn[:2] * gap
    direct = ca.jacobian(numerator, excess)
    shifted = ca.vertcat(z.centroid, z.gravity_direction, z.thrust)
    deviations = ca.vertcat(d1 + d.goal_centroid, tilt + rigid_body.E3, thrust)
    d2_of, d3_of = ca.substitute([e.d2, e.d3], [shifted], [deviations])
    torque = ca.SX.sym("torque", 3)
    balance = rigid_body.torque_balance(z.rate, alpha, d.inertia, torque)
    return _Chain(
        law=law,
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


def _scheme(chain: _Chain, numbers: Coefficients, seen: ca.SX) -> dict[str, ca.SX]:
    """Build the graph; every value in it that has a meaning comes with a name."""
    rate = _variables("rate", chain.rate)

    def over(*parts: tuple[str, ca.SX]) -> Variables:
        packed = [_variables(name, value) for name, value in parts]
        names = tuple(n for p in packed for n in p.names)
        return Variables(names, ca.vertcat(*(p.vector for p in packed)))

    q = seen
    if seen.shape[0] == 2:
        q = chain.law.feature.seen(camera.spherical(seen))
    goal = quadratic(chain.parts.goal_centroid, [f"goal_{a}" for a in AXES], rate, numbers)
    image_error = q - ca.vertcat(*goal)
    tilt = chain.gravity_direction - rigid_body.E3
    d2 = quadratic(
        chain.d2_of,
        [f"d2_{a}" for a in AXES],
        over(("velocity", chain.velocity), ("image", chain.image_error), ("tilt", chain.tilt)),
        numbers,
    )
    s = quadratic(
        chain.s_of,
        [f"s_{a}" for a in AXES],
        over(("d2", chain.d2), ("tilt", chain.tilt), ("excess", chain.excess)),
        numbers,
    )
    state = over(("rate", chain.rate), ("s", chain.s), ("d2", chain.d2), ("excess", chain.excess))
    outputs = ca.vertcat(chain.thrust_rate, chain.direct, chain.divided, chain.yaw, chain.gap)
    names = ["U", "roll", "pitch", "roll_gap", "pitch_gap", "yaw", "hover_gap"]
    U, *rest = quadratic(outputs, names, state, numbers, factored=3)
    direct, divided, yaw, gap = rest[0:2], rest[2:4], rest[4], rest[5]
    alpha = ca.vertcat(*(a + b / gap for a, b in zip(direct, divided, strict=True)), yaw)
    torque = quadratic(
        chain.torque,
        [f"torque_{a}" for a in AXES],
        over(("rate", chain.rate), ("alpha", chain.acceleration)),
        numbers,
    )
    wrench = over(("thrust", chain.excess), ("torque", chain.s))  # any symbols do
    mixing = rotors.rotor_thrusts(
        chain.excess + chain.parts.mass * chain.parts.gravity, chain.s, chain.arm, chain.drag
    )
    mixed = quadratic(mixing, ["rotor"] * 4, wrench, numbers)

    graph = {"seen": seen, "centroid": q, "image_error": image_error, "tilt": tilt}
    held = ca.vertcat(chain.image_error, chain.tilt)
    graph["d2"] = ca.substitute(ca.vertcat(*d2), held, ca.vertcat(image_error, tilt))
    graph["s"] = ca.substitute(
        ca.vertcat(*s), ca.vertcat(chain.d2, chain.tilt), ca.vertcat(graph["d2"], tilt)
    )
    inner, outer = ca.vertcat(chain.d2, chain.s), ca.vertcat(graph["d2"], graph["s"])
    graph["thrust_rate"] = ca.substitute(U, inner, outer)
    graph["gap"] = gap
    graph["alpha"] = ca.substitute(alpha, inner, outer)
    graph["torque"] = ca.substitute(ca.vertcat(*torque), chain.acceleration, graph["alpha"])
    graph["rotor"] = ca.substitute(ca.vertcat(*mixed), chain.s, graph["torque"])
    return graph


def _variables(name: str, vector: ca.SX) -> Variables:
    names = [name] if vector.shape[0] == 1 else [f"{name}_{a}" for a in AXES]
    return Variables(tuple(names), vector)
