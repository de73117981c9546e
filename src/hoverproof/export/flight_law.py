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
from functools import lru_cache

import casadi as ca

from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.export.chain import Chain, chain_of
from hoverproof.export.closed_form import closed_forms
from hoverproof.export.quadratic import Coefficients, Variables, quadratic
from hoverproof.export.same_controller import assert_is_the_controller
from hoverproof.export.seen import SeenFeature, seen_feature
from hoverproof.mission.frame import Frame
from hoverproof.mission.sections import Mission
from hoverproof.plant import rigid_body, rotors
from hoverproof.servo.law import Law
from hoverproof.servo.laws.heading import flown_law
from hoverproof.servo.layout import place

BESIDES = {"arm": 1, "drag_ratio": 1, "rate_bandwidth": 1}
"""What the firmware needs beside the design of its law, in m, m and rad/s."""

AXES = ("x", "y", "z")


@dataclass(frozen=True)
class FlightLaw:
    """The law as one graph, with the numbers in it.

    Attributes
    ----------
    function : casadi.Function
        (image, centroid or feature, what the law takes in of the body, thrust_excess, coefficients)
        ↦ the outputs thrust_rate in N/s, torque in N m and rotor in N, and what else is worth a
        name.
    after_checks : casadi.Function
        The same as it is printed: what is checked before, spread and lift, are further inputs of
        it, where the law has them. With a rate loop a further output is rate_command, in rad/s.
    coefficients : dict of str to Fraction
        The numbers, exact, in the order of the last input.
    meanings : dict of str to str
        The closed form of each in m, g, I1, I2, I3, the gains by name, q = q*, d, kappa, omega_r.
    of_gains : casadi.Function
        (gains (5,), rest of the design) ↦ coefficients, the gains in the order of the law's design.
    fixed : list of Fractions
        The rest of the design, (11,): vehicle, q* and bandwidth.
    tuned : tuple of str
        The coefficients that depend on the gains.
    singular_excess : Fraction
        T - m g at which the law is singular, N.
    lift : casadi.Function or None
        (what the law takes in of the body, coefficients) ↦ T - m g in N, if the law measures its
        thrust; else it is the one commanded.
    spread : casadi.Function or None
        (image or centroid) ↦ n² - |q|², if the law's feature can be told by it alone.
    source : Law
        The law that it computes.
    """

    function: ca.Function
    after_checks: ca.Function
    coefficients: dict[str, Fraction]
    meanings: dict[str, str]
    of_gains: ca.Function
    fixed: list[Fraction]
    tuned: tuple[str, ...]
    singular_excess: Fraction
    lift: ca.Function | None
    spread: ca.Function | None
    source: Law


def flight_law(
    mission: Mission,
    *,
    sensing: str = "points",
    tunable: bool = False,
    law: Law | None = None,
    rates: bool = False,
) -> FlightLaw:
    """Return the law of a mission.

    Parameters
    ----------
    mission : Mission
    sensing : {"points", "centroid", "feature"}
        What the law takes in of the image: pinhole image points (2, n), focal length 1, the image
        centroid (3,) already summed, or the feature (3,) that the law makes of it.
    tunable : bool
        Keep the five gains as parameters: a coefficient is then left out only if it vanishes
        whatever they are.
    law : Law, optional
        By default that of the mission.
    rates : bool
        Whether it commands body rates too, to the rate loop of the mission's interface.

    Raises
    ------
    AssertionError
        If the graph is not the derived controller, compared in exact arithmetic.
    """
    law, points = (law or flown_law(mission)).flying(mission), len(mission.target.points)
    here = tuple(_design_values(mission, law))
    return _flight_law(law, mission.vehicle.frame, here, (sensing, points), tunable, rates)


@lru_cache(maxsize=8)
def _flight_law(
    law: Law,
    frame: Frame,
    here: tuple[Fraction, ...],
    sensing: tuple[str, int],
    tunable: bool,
    rates: bool,
) -> FlightLaw:
    """Return the law of a design, for what it takes in of so many target points."""
    chain = chain_of(law)
    samples = [list(here), *(_with_gains(law, here, g) for g in _other_gains(law, here))]
    numbers = Coefficients(chain.design, samples if tunable else samples[:1])
    feature = ca.SX.sym("feature", 3)
    by_feature, _ = _functions(chain, numbers, SeenFeature(feature, feature), frame, rates)
    forms = closed_forms(ca.vertcat(*numbers.expressions.values()))
    expressions = ca.vertcat(*(form.value for form in forms))
    at_samples = numbers.at_samples(expressions)
    for i, sample in enumerate(numbers.samples):
        at_sample = [values[i] for values in at_samples]
        assert_is_the_controller(by_feature, sample, at_sample, law, frame)
    seen = seen_feature(law, *sensing)
    function, after_checks = _functions(chain, numbers, seen, frame, rates)
    tuned, rest = _gains_and_rest(law)
    (singular,) = numbers.at_samples(chain.singular)
    return FlightLaw(
        function=function,
        after_checks=after_checks,
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
        lift=_lift(chain, numbers, by_feature) if chain.measures_thrust else None,
        spread=seen.spread_function(),
        source=law,
    )


def _design_values(mission: Mission, law: Law) -> list[Fraction]:
    """Return the numbers of a mission in the order of the chain's design."""
    vehicle = mission.vehicle
    return [
        *law.design.values(mission, law.goal_feature(mission)),
        vehicle.reach,
        vehicle.drag_ratio,
        mission.interface.rate_bandwidth or Fraction(1),
    ]


def _gains_and_rest(law: Law) -> tuple[list[int], list[int]]:
    """Return the places of the gains in the chain's design, and all others."""
    sizes = law.design.sizes() | BESIDES
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


def _lift(chain: Chain, numbers: Coefficients, law: ca.Function) -> ca.Function:
    """Return the thrust that a law measures, computed as within the law."""
    coefficients = ca.vertcat(*numbers.symbols.values())
    inputs = [ca.SX.zeros(3), *chain.sensors.values(), chain.excess, coefficients]
    found = dict(zip(law.name_out(), law.call(inputs), strict=True))
    names = [*chain.sensors, "coefficients"]
    return ca.Function(
        "lift", [*chain.sensors.values(), coefficients], [found["lift"]], names, ["lift"]
    )


def _functions(
    chain: Chain, numbers: Coefficients, seen: SeenFeature, frame: Frame, rates: bool
) -> tuple[ca.Function, ca.Function]:
    """Return the law, and the law for what is checked before it."""
    named = _scheme(chain, numbers, seen.feature, frame)
    if rates:
        named["rate_command"] = _rate_command(chain, numbers, named["alpha"])
    checked = {"spread": (seen.spread, seen.spread_of)}
    if chain.measures_thrust:
        checked["lift"] = chain.lift, named["lift"]
    symbols, values = (ca.vertcat(*parts) for parts in zip(*checked.values(), strict=True))
    inputs = {
        "seen": seen.seen,
        **chain.sensors,
        "thrust_excess": chain.excess,
        "coefficients": ca.vertcat(*numbers.symbols.values()),
    }
    if symbols.is_empty():
        law = _function(inputs, named)
        return law, law
    whole = dict(zip(named, ca.substitute(list(named.values()), [symbols], [values]), strict=True))
    further = {name: symbol for name, (symbol, _) in checked.items() if not symbol.is_empty()}
    others = {name: value for name, value in named.items() if name not in further}
    return _function(inputs, whole), _function(inputs | further, others)


def _function(inputs: dict[str, ca.SX], named: dict[str, ca.SX]) -> ca.Function:
    law = ca.Function("law", list(inputs.values()), list(named.values()), list(inputs), list(named))
    return share_reciprocals(law)


def _scheme(chain: Chain, numbers: Coefficients, feature: ca.SX, frame: Frame) -> dict[str, ca.SX]:
    """Build the graph, with a symbol for the lift that a law measures.

    Every value in it that has a meaning comes with a name.
    """
    rate = _variables("rate", chain.sensors["rate"])

    def over(*parts: tuple[str, ca.SX]) -> Variables:
        packed = [_variables(name, value) for name, value in parts]
        names = tuple(n for p in packed for n in p.names)
        return Variables(names, ca.vertcat(*(p.vector for p in packed)))

    goal = quadratic(chain.parts.goal_centroid, [f"goal_{a}" for a in AXES], rate, numbers)
    image_error = feature - ca.vertcat(*goal)
    tilt = chain.sensors["gravity_direction"] - rigid_body.E3
    sensed = over(*chain.sensors.items())
    felt = quadratic(
        chain.felt_of, [f"rest_{a}" for a in AXES[: chain.felt.shape[0]]], sensed, numbers
    )
    d2 = quadratic(
        chain.d2_of,
        [f"d2_{a}" for a in AXES],
        over(
            ("velocity", chain.sensors["velocity"]),
            ("image", chain.image_error),
            ("tilt", chain.tilt),
        ),
        numbers,
    )
    s = quadratic(
        chain.s_of,
        [f"s_{a}" for a in AXES],
        over(
            ("d2", chain.d2), ("tilt", chain.tilt), ("excess", chain.excess), ("felt", chain.felt)
        ),
        numbers,
    )
    known = over(("rate", rate.vector), ("felt", chain.felt))
    lift, drift = chain.excess, ca.SX(0)
    if chain.measures_thrust:
        changes = ca.vertcat(chain.lift_of, chain.drift_of)
        lift, drift = quadratic(changes, ["lift", "drift"], known, numbers)
    state = over(
        ("rate", rate.vector),
        ("s", chain.s),
        ("d2", chain.d2),
        ("excess", chain.lift),
        ("drift", chain.drift),
        *((name, chain.sensors[name]) for name in chain.sensors if name == "heading"),
    )
    outputs = ca.vertcat(chain.thrust_rate, chain.direct, chain.divided, chain.yaw, chain.gap)
    names = ["U", "roll", "pitch", "roll_gap", "pitch_gap", "yaw", "hover_gap"]
    U, *rest = quadratic(outputs, names, state, numbers, factored=3)
    direct, divided, yaw, gap = rest[0:2], rest[2:4], rest[4], rest[5]
    alpha = ca.vertcat(*(a + b / gap for a, b in zip(direct, divided, strict=True)), yaw)
    torque = quadratic(
        chain.torque,
        [f"torque_{a}" for a in AXES],
        over(("rate", rate.vector), ("alpha", chain.acceleration)),
        numbers,
    )
    wrench = over(("thrust", chain.excess), ("torque", chain.s))  # any symbols do
    lift_off = chain.excess + chain.parts.mass * chain.parts.gravity
    mixing = rotors.rotor_thrusts(frame, lift_off, chain.s, chain.arm, chain.drag)
    mixed = quadratic(mixing, ["rotor"] * len(frame.names), wrench, numbers)

    graph = {"centroid": feature, "image_error": image_error, "tilt": tilt}
    if chain.measures_thrust:
        graph["felt"] = ca.vertcat(*felt)
        graph["lift"], graph["drift"] = (
            ca.substitute(value, chain.felt, graph["felt"]) for value in (lift, drift)
        )
    held = ca.vertcat(chain.image_error, chain.tilt)
    graph["d2"] = ca.substitute(ca.vertcat(*d2), held, ca.vertcat(image_error, tilt))
    graph["s"] = ca.substitute(
        ca.vertcat(*s),
        ca.vertcat(chain.d2, chain.tilt, chain.felt),
        ca.vertcat(graph["d2"], tilt, graph.get("felt", ca.SX(0, 1))),
    )
    inner = ca.vertcat(chain.d2, chain.s, chain.drift)
    outer = ca.vertcat(graph["d2"], graph["s"], graph.get("drift", drift))
    graph["thrust_rate"], graph["gap"], graph["alpha"] = (
        ca.substitute(value, inner, outer) for value in (U, gap, alpha)
    )
    graph["torque"] = ca.substitute(ca.vertcat(*torque), chain.acceleration, graph["alpha"])
    graph["rotor"] = ca.substitute(ca.vertcat(*mixed), chain.s, graph["torque"])
    return graph


def _rate_command(chain: Chain, numbers: Coefficients, alpha: ca.SX) -> ca.SX:
    """Return the body rates that are commanded, in a symbol of the rate and the graph of alpha."""
    rate = _variables("rate", chain.sensors["rate"])
    turn = _variables("alpha", chain.acceleration)
    both = Variables((*rate.names, *turn.names), ca.vertcat(rate.vector, turn.vector))
    lead = quadratic(chain.rate_command, [f"lead_{a}" for a in AXES], both, numbers)
    command: ca.SX = ca.substitute(ca.vertcat(*lead), chain.acceleration, alpha)
    return command


def _variables(name: str, vector: ca.SX) -> Variables:
    size = vector.shape[0]
    names = [name] if size == 1 else [f"{name}_{a}" for a in AXES[:size]]
    return Variables(tuple(names), vector)
