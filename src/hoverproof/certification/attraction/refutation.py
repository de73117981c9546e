"""Refute a start: show that the motion from it sinks to the target.

A simulation picks the state and the time; the checker then encloses all motions from there, and
what it accepts is a theorem.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from fractions import Fraction
from functools import cache
from typing import Literal

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof import checker
from hoverproof.algebra.graph import fingerprint
from hoverproof.certification.attraction.starts import Start, State
from hoverproof.certification.attraction.verdict import Sinks
from hoverproof.certification.certificate import rejection, seal
from hoverproof.certification.verdict import Undecided
from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import LoopNumbers, loop_rate, parameters

Array = NDArray[np.float64]
Vector = tuple[Fraction, ...]
Ending = Literal["sinks to the target", "settles", "breaks off", "goes on"]

SOON = 30.0
"""s; within that a motion sinks, or nobody could follow it rigorously."""
LATE = 5000.0
"""s; a simulation that has not ended by then goes on."""
FINEST = 1 << 14
"""Steps are multiples of 1/FINEST s."""
SHARES = (2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25)
"""Steps of the checker's series, over those of the method that is tried first."""
EVALUATIONS = 20_000
"""A simulation goes on if it is not over after so many evaluations of the rate: ten times what a
flight that a person would fly takes, but a loop with a very fast motion takes any number."""
PASSED = 1e-3
"""m; a motion is followed until it is so far below the target, where rounding does not matter."""


class _Endless(Exception):
    """A simulation that is not over after as many evaluations as it may take, and when, s."""


def worst_states(mission: Mission, start: Start) -> Iterator[State]:
    """Yield states of a set of starts from which a vehicle would sink soonest.

    As low, as fast downward and with as little thrust as may be; level, or leaning as far as may
    be in four directions and falling over further.

    Parameters
    ----------
    mission : Mission
    start : Start
    """
    *sides, (_, low) = start.position
    places = dict.fromkeys([tuple((a + b) / 2 for a, b in sides), *itertools.product(*sides)])
    zero, half = Fraction(0), start.tilt / 2  # tan(φ/2) of a φ that is at most the tilt
    sine, cosine = 2 * half / (1 + half**2), (1 - half**2) / (1 + half**2)
    leans: list[tuple[Vector, Vector]] = [((zero, zero, Fraction(1)), (zero,) * 3)]
    if start.tilt or start.rate:
        for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            over = (x * cosine, y * cosine, -sine)
            leans.append(((x * sine, y * sine, cosine), tuple(start.rate * a for a in over)))
    thrust = mission.vehicle.weight - start.thrust
    for place, (axis, turning) in itertools.product(places, leans):
        velocity = (zero, zero, start.speed)
        yield State.exactly((*place, low), velocity, axis, turning, thrust=thrust)


@cache
def flight_rate(n: int, law: Law = HAMEL_MAHONY) -> ca.Function:
    """Return (state (19,), design (13,), points (3, n)) ↦ its time derivative in closed loop.

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
        That of the paper, which tells how much each point counts.
    """
    (design, points), x = parameters(n), ca.SX.sym("x", STATE_SIZE)
    rate = loop_rate(x, design, points, law, all_round=True)  # it is followed below the target
    return ca.Function("flight", [x, design.vector(), points], [rate])


def simulate(mission: Mission, start: Array, most: float) -> tuple[Ending, float]:
    """Return how a motion ends, and when, s; a simulation proves nothing.

    Parameters
    ----------
    mission : Mission
    start : (19,)
        Packed state of the vehicle; see `RigidBodyState`.
    most : float
        s; when to give up. A loop with a very fast motion is given up sooner: see `EVALUATIONS`.
    """
    from scipy.integrate import solve_ivp

    numbers, law = LoopNumbers.of(mission), HAMEL_MAHONY.weighing(mission.target)
    design, points, goal = numbers.design, numbers.points, numbers.goal
    lowest, near = points[2].max(), 0.05 * np.linalg.norm(points.T - goal, axis=1).min()
    read, singular = (
        flight_rate(numbers.target_size, law),
        numbers.value(lambda d: d.singular_thrust),
    )
    if start[18] <= singular:
        return "breaks off", 0.0

    def below(t: float, x: Array) -> float:
        return float(x[2] - lowest - PASSED)

    def away(t: float, x: Array) -> float:
        return float(max(np.linalg.norm(x[:3] - goal), np.linalg.norm(x[3:6])) - near)

    def margin(t: float, x: Array) -> float:
        return float(x[18] - singular - 1e-6 * numbers.hover_thrust)

    for event in (below, away, margin):
        event.terminal = True  # type: ignore[attr-defined]
    left = itertools.repeat(None, EVALUATIONS)

    def rate(t: float, x: Array) -> Array:
        for _ in left:
            return np.array(read(x, design, points))[:, 0]
        raise _Endless(t)

    try:
        flown = solve_ivp(
            rate,
            (0.0, most),
            start,
            method="LSODA",
            rtol=1e-10,
            atol=1e-12,
            events=[below, away, margin],
        )
    except _Endless as endless:
        return "goes on", float(endless.args[0])
    ending: Ending = "goes on" if flown.status == 0 else "breaks off"
    if len(flown.t_events[0]):
        ending = "sinks to the target"
    elif len(flown.t_events[1]):
        ending = "settles"
    return ending, float(flown.t[-1])


def step_plans(mission: Mission, state: State, time: float) -> Iterator[list[Fraction]]:
    """Yield steps, s, in which the checker may be able to follow a motion; the longest first.

    They are in proportion to those of a method of high order at its finest; at last, all alike.

    Parameters
    ----------
    mission : Mission
    state : State
    time : float
        s; the sum of the steps is not less.
    """
    end = Fraction(math.ceil(time * FINEST), FINEST)
    most = checker.MAX_STEPS // (len(mission.target.places) + 3)
    times = _natural_times(mission, state, time, 8 * most)
    lengths = np.diff(times)
    lengths = np.maximum(lengths, np.append(lengths[1:], 0.0))  # its first is a careful one
    for share in SHARES if times[-1] > time else ():
        steps: list[Fraction] = []
        done = Fraction(0)
        while done < end and len(steps) < most:
            place = min(int(np.searchsorted(times, float(done), "right")) - 1, len(lengths) - 1)
            ahead = slice(place, np.searchsorted(times, float(done) + share * lengths[place]))
            longest = share * float(lengths[ahead].min(initial=lengths[place]))
            step = min(Fraction(max(math.floor(longest * FINEST), 1), FINEST), end - done)
            steps.append(step)
            done += step
        if done == end:
            yield steps
    places = [Fraction(k * int(end * FINEST) // most, FINEST) for k in range(most + 1)]
    yield [b - a for a, b in itertools.pairwise(places) if b > a]


def _natural_times(mission: Mission, state: State, time: float, most: int) -> Array:
    """Return where a method of high order steps, s, to beyond a time if that takes few steps."""
    from scipy.integrate import DOP853

    numbers = LoopNumbers.of(mission)
    read = flight_rate(numbers.target_size, HAMEL_MAHONY.weighing(mission.target))
    method = DOP853(
        lambda t, x: np.array(read(x, numbers.design, numbers.points))[:, 0],
        *(0.0, state.packed(), 1.5 * time),  # its last step is cut short
        rtol=1e-13,
        atol=1e-13,
    )
    times = [0.0]
    while method.status == "running" and len(times) <= most:
        method.step()
        times.append(method.t)
    return np.array(times)


def refute(
    mission: Mission, starts: Sequence[Start] | None, undecided: Undecided
) -> Sinks | Undecided:
    """Show that a wanted start sinks to the target; else tell what a simulation does.

    To sink is to come from above the lowest target point to its height or below. That is followed
    without a yaw rate, so nothing is said of a vehicle that turns to a heading.

    Parameters
    ----------
    mission : Mission
    starts : sequence of Start or None
        The sets that were asked for; None stands for the start of the mission.
    undecided : Undecided
        What the search for a region came to.

    Returns
    -------
    Sinks, or Undecided with the reason completed
    """
    if mission.goal.heading is not None:
        return undecided.because("a motion that turns to a heading is not followed")
    if starts is None:
        own = State.of(mission)
        states = [] if own is None else [own]
    else:
        states = [state for start in starts for state in worst_states(mission, start)]
    lowest = max(z for _, _, z in mission.target.points)
    above = [state for state in states if state.position[2][1] < lowest]
    if states and not above:
        return undecided.because("the start is not above the lowest target point, to sink to it")
    states, sinking = above, []
    for state in states:
        ending, time = simulate(mission, state.packed(), SOON)
        if ending == "sinks to the target":
            sinking.append((time, state))
        elif ending == "goes on" and time < SOON:  # given up: the other states would cost as much
            break
    for time, state in sorted(sinking, key=lambda pair: pair[0])[:1]:
        model = model_fingerprint(mission)
        reason = "it takes too many steps to follow"
        for steps in step_plans(mission, state, time):
            parts = {"motion": {**asdict(state), "time": sum(steps), "steps": steps}}
            certificate = seal(mission, "sinking", parts, model)
            reason = rejection(certificate)
            if not reason:
                spent = sum(steps, Fraction(0))
                return Sinks(mission=mission, certificate=certificate, state=state, time=spent)
        shown = f"sinks to the target within {time:.3g} s, but {reason}"
        return undecided.because(f"a simulation, which is no proof, {shown}")
    if not states:
        return undecided
    ending, time = simulate(mission, states[0].packed(), LATE)
    return undecided.because(f"a simulation, which is no proof, {ending} after {time:.3g} s")


def model_fingerprint(mission: Mission) -> str:
    """Return the SHA-256 of the graph of the closed loop that was simulated.

    Parameters
    ----------
    mission : Mission
    """
    return fingerprint(
        flight_rate(len(mission.target.points), HAMEL_MAHONY.weighing(mission.target))
    )
