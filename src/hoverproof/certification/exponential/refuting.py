"""Find the states that refuse all weights, by the multipliers of the program without a solution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.form import Variables
from hoverproof.certification.exponential.inequality import (
    MEMORY,
    THRUST,
    TORQUE,
    W2,
    W3,
    W4,
    variables,
)
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.program import Program
from hoverproof.certification.exponential.proof import ROOMS, candidate
from hoverproof.certification.exponential.question import Question
from hoverproof.certification.exponential.refusal import (
    Asked,
    Corner,
    Refusal,
    State,
    Vector,
)
from hoverproof.certification.exponential.terms import terms
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.certification.robust import Inequality, refuse
from hoverproof.certification.semidefinite import Multipliers
from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import Uncertainty

Array = NDArray[np.float64]
DIGITS, PLACES = 10, 9
LEAST = 1e-9
"""Of the multipliers, as a share of the largest: what is less is left out."""
BARELY = 1e-6
"""By so much more than its bound what is asked has to be, bare numbers, for it to be refused."""
SHRINK = 1e-6, 1e-5, 1e-4, 1e-3, 1e-2
"""By what shares y - jV, and four and eight times as much n and pushes, are made smaller, one after
the other: then their own multipliers make the sum less."""
GUESSES = (0.3, -1.7), (0.6, -1.7), (0.3, -3.0), (0.85, -0.5)
"""Where no weights satisfy the inequality: shares of the span of log d, and of force; see `at`."""
BESIDE = {"1": 0, "w2": W2, "w3": W3, "w4": W4, "a5": TORQUE, "a6": THRUST, "memory": MEMORY}


def refused(mission: Mission, starts: Sequence[Start]) -> Refusal | None:
    """Show that no weights prove that starts converge, with the reach, ball and rate found best.

    Parameters
    ----------
    mission : Mission
    starts : sequence of Start

    Returns
    -------
    Refusal, or None if none was found: what `without_noise` leaves out is not looked at

    Raises
    ------
    InputError
        See `converge`.
    """
    mission, left_out = without_noise(mission)
    vehicles = Vehicles.of(mission)
    wider, highest = ROOMS[0]
    question = Question.of(vehicles, Scene.of(mission), tuple(starts))
    question = replace(question, wider=wider, highest=highest)
    low, high = np.log(question.ends)
    if not low < high:
        return None
    found = candidate(mission, starts, None)
    if found is not None and found.solution.fill <= 1:
        return None
    guesses = [np.array([low + part * (high - low), share]) for part, share in GUESSES]
    places = guesses if found is None else [found.x]
    tight = None if found is None else found.solution.tight
    made = (_at(mission, question, x, tight) for x in places)
    refusal = next((found for found in made if found is not None), None)
    return None if refusal is None else replace(refusal, left_out=left_out)


def without_noise(mission: Mission) -> tuple[Mission, tuple[str, ...]]:
    """Return a mission for which the theorem asks for no more, and what it leaves out, in words.

    Noise, gusts, steps, a low-pass, a feature in the axes of its frame and a camera aside have
    variables of their own, which may be 0, and else lower the form: by wider vertices and radii,
    an older image, more of the start. So weights that prove the mission prove that one.

    Parameters
    ----------
    mission : Mission
    """
    none, may, camera, sensors = Uncertainty(), mission.uncertainty, mission.camera, mission.sensors
    names = {
        **{"noise": "noise", "gust": "gusts", "control_period": "steps"},
        "force_lag": "a low-pass of the force",
    }
    there = {
        name: words for name, words in names.items() if getattr(may, name) != getattr(none, name)
    }
    left_out = list(there.values())
    may = may.model_copy(update={name: getattr(none, name) for name in there})
    if may.latency and not sensors.gyro_turned:
        sensors = sensors.model_copy(update={"gyro_turned": True})
        left_out.append("a late image that is not turned")
    if camera.has_arm:
        camera = camera.model_copy(update={"position": type(camera)().position})
        left_out.append("a camera beside the centre of mass")
    changed = {"uncertainty": may, "sensors": sensors, "camera": camera}
    return mission.model_copy(update=changed), tuple(left_out)


def _at(
    mission: Mission, question: Question, x: Array, tight: tuple[int, ...] | None
) -> Refusal | None:
    """Refuse all weights at a point of the search, by vertices that are tight, if known."""
    asked = question.asked(x)
    if asked is None:
        return None
    ball, limits, level = asked
    rate = float(decimal_below(question.slow(question.ends[0]), DIGITS))
    posed = Program.of(limits, ball, rate, level, question.terms())
    if posed is None:
        return None
    vertices, most = posed.falls.of_used()[1], 1.0
    few: list[tuple[int, ...]] = [] if tight is None else [tight]
    if tight is None:
        posed, vertices, most = *_raised(posed, vertices), 0.0
        few = [*((k,) for k in range(len(vertices))), tuple(range(len(vertices)))]
    for each in few:
        corners = [vertices[k] for k in each]
        told = refuse(posed.cost, corners, rows=posed.rows, pencils=posed.pencils)
        if told is not None and told[0] > most + BARELY:
            made = _rounded(mission, limits, ball, rate, posed, each, told[1])
            if made is not None:
                return made
    return None


def _raised(posed: Program, vertices: Sequence[Inequality]) -> tuple[Program, list[Inequality]]:
    """Return the program of how far each form has to be raised, whatever the starts.

    What shows that it is by more than nothing are few states.
    """
    size, count = len(posed.falls.there) + 1, len(posed.starts)
    by = np.zeros((size, *vertices[0].S.shape[1:]))
    by[-1] = -np.eye(len(by[-1]))
    rows = posed.rows.copy()
    rows[:count] = np.eye(size)[0]
    rows[-1, 0] = 1  # it may be lowered too, but by 1 at most
    return replace(posed, rows=rows), [c.less(by) for c in vertices]


def _rounded(
    mission: Mission,
    limits: Limits,
    ball: tuple[float, float],
    rate: float,
    posed: Program,
    few: Sequence[int],
    told: Multipliers,
) -> Refusal | None:
    """Round to rational numbers, a little on the safe side; None if the sum is not negative."""
    count = len(few)
    whole = sum(float(np.trace(z)) for z in told.pencils[:count])
    if not whole > 0:
        return None
    shares = told.rows[: len(posed.starts)] * posed.rows[: len(posed.starts), -1] / whole
    asked = _asked(mission, limits, ball, rate, posed, shares)
    vertices = list(limits.vertices())
    vectors = tuple(
        tuple(tuple(map(_short, v)) for v in _factors(_unscaled(z / whole, most)))
        for z, most in zip(told.pencils[count:], asked.reach, strict=True)
    )
    start = Fraction(float(shares.sum()) / float(asked.level))
    for share in SHRINK:
        corners = tuple(
            Corner(
                _inside(mission, limits, vertices[k]),
                tuple(_state(limits.vehicles, asked, v, share) for v in _factors(z / whole)),
            )
            for k, z in zip(few, told.pencils[:count], strict=True)
        )
        made = Refusal(asked, corners, _short(float(start)), vectors)
        over = [
            value / asked.start[name]
            for name, value in made.total().items()
            if name != "1" and value > 0 and asked.start.get(name)
        ]
        made = replace(made, start=made.start + decimal_above(max(over, default=Fraction(0)), 3))
        if made.total().is_negative:
            return made
    return None


def _asked(
    mission: Mission,
    limits: Limits,
    ball: tuple[float, float],
    rate: float,
    posed: Program,
    shares: Array,
) -> Asked:
    v, reach, covered = limits.vehicles, limits.reach, mission.uncertainty
    level = float(posed.level)
    by = shares if shares.sum() > LEAST else np.ones(len(shares))
    mean = (by @ posed.starts) / by.sum()
    places = posed.falls.there
    there = {places.index(k): name for name, k in BESIDE.items() if k in places}
    sizes = reach.force, reach.d3, reach.turn, reach.speed
    most = [x**2 / (2 * level) - (x is reach.speed) for x in sizes]
    middle, radius = (ball[0] + ball[1]) / 2, (ball[1] - ball[0]) / 2
    k1, mass = mission.gains.k1, mission.vehicle.mass
    feature = v.law.goal_feature(mission)
    return Asked(
        law=v.law,
        design=tuple(map(Fraction, v.law.design.values(mission, feature))),
        rate=decimal_below(rate, DIGITS),
        latency=covered.latency,
        fading=decimal_above(float(np.exp(-rate * v.latency)), DIGITS),
        ball=(decimal_below(middle, DIGITS), decimal_below(radius * (1 - 1e-8), DIGITS)),
        slowness=mass / k1,
        lagged=v.rotor_lag > 0,
        terms=tuple((a, b, decimal_below(size, DIGITS)) for a, b, size in terms(limits)),
        level=decimal_above(level, DIGITS),
        start={name: decimal_below(max(mean[k], 0.0), DIGITS) for k, name in there.items()},
        reach=tuple(decimal_above(x, DIGITS) for x in most),
    )


def _inside(mission: Mission, limits: Limits, vertex: Sequence[float]) -> Vector:
    """Return a vertex in short numbers, those that are bounds a hair inside."""
    ratio, quick, gain, lag, swing, lean = vertex
    covered, middle = mission.uncertainty, sum(limits.quickness) / 2
    turned = covered.thrust * int(np.sign(gain - 1))
    own = middle if quick else 0.0
    return (
        _pulled(ratio, 1.0),
        _pulled(quick, own),
        1 + turned,
        covered.rotor_lag if lag else Fraction(0),
        _pulled(swing, 0.0),
        _pulled(lean, 0.0),
    )


def _pulled(value: float, middle: float) -> Fraction:
    return decimal_below(middle + (value - middle) * (1 - 1e-9), DIGITS + 2)


def _factors(z: Array) -> list[Array]:
    """Return vectors of which the squares add up to a matrix, but for what is nearly nothing."""
    values, vectors = np.linalg.eigh(z)
    least = LEAST * max(float(np.trace(z)), 1e-3)
    return [np.sqrt(a) * v for a, v in zip(values, vectors.T, strict=True) if a > least]


def _unscaled(z: Array, most: Fraction) -> Array:
    """Return the multiplier of a bound of reciprocals whose first row is √most times as large."""
    scale = np.ones(len(z))
    scale[0] = float(most) ** -0.5
    return np.asarray(z * np.outer(scale, scale))


def _state(v: Vehicles, asked: Asked, vector: Array, share: float) -> State:
    kept, x = variables(v), np.zeros(Variables.size())
    x[kept], rest = vector[: len(kept)], vector[len(kept) :]
    errors = x[Variables.place("errors")]
    y, n = (x[Variables.place(name)] for name in ("flow", "ahead"))
    aim = float(asked.ball[0]) * (errors[:3] + errors[3:6]) / float(asked.slowness)
    y += share * (aim - y)
    n *= 1 - 4 * share
    pushes, rows = [], {"lift": 1}
    for pushed, _, size in asked.terms:
        own, rest = np.split(rest, [rows.get(pushed, 2)])
        pushes.append((float(size) / 2) ** 0.5 * (1 - 8 * share) * own)
    return State(tuple(map(_short, x)), tuple(tuple(map(_short, p)) for p in pushes))


def _short(value: float) -> Fraction:
    return Fraction(round(value * 10**PLACES), 10**PLACES)
