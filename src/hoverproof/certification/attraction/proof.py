"""Decide where a controller may be switched on: a region of attraction, proved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from hoverproof import checker
from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.algebra.graph import fingerprint
from hoverproof.certification.attraction.form import derive_form
from hoverproof.certification.attraction.inequality import Loop, rate_and_multiplier
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.refutation import refute
from hoverproof.certification.attraction.search import (
    SLACKS,
    Found,
    Objective,
    Search,
    Slack,
    find,
    reach_along,
)
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.attraction.verdict import Proved, Reach, Undecided, Verdict
from hoverproof.certification.certificate import Certificate, exact, seal_content
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal

BITS = 64
DIGITS = 6
MOST_STARTS = 16
Progress = Callable[[str], None]


def attraction(
    mission: Mission,
    *,
    objective: Objective = "start",
    starts: Sequence[Start] | None = None,
    barrier: bool | None = None,
    progress: Progress | None = None,
) -> Verdict:
    """Find and prove a region of attraction of the goal.

    Parameters
    ----------
    mission : Mission
    objective : {"start", "radius", "volume"}
        Prove the given starts; or make the largest ball of certified hovers about the goal, or
        their volume, as large as can be.
    starts : sequence of Start, optional
        Sets of states to be inside; by default, with the objective "start", that of the mission.
    barrier : bool, optional
        Whether to use that motions do not sink to the target. By default both are tried, with a
        barrier first if k3 >= 3 k1 k2.
    progress : callable, optional
        Is told what is being done.

    Returns
    -------
    Proved; Refuted if a wanted start is shown to sink to the target; or Undecided

    Raises
    ------
    InputError
        If the goal is not axial, or the mission poses no question.
    """
    tell = progress or (lambda text: None)
    verdict = _search_and_prove(mission, objective, starts, barrier, tell)
    if isinstance(verdict, Undecided) and (objective == "start" or starts):
        tell("following the motion from the start")
        return refute(mission, starts or None, verdict)
    return verdict


def start_or_ball(mission: Mission) -> tuple[Verdict, Proved | None]:
    """Decide about the start of a mission, and find a region whatever becomes of it.

    Parameters
    ----------
    mission : Mission

    Returns
    -------
    verdict
        Of `attraction`, about the start of the mission.
    region : Proved or None
        The region that holds that start; where none is proved to, the one with the largest ball.

    Raises
    ------
    InputError
        See `attraction`.
    """
    start = attraction(mission)
    found = start if isinstance(start, Proved) else attraction(mission, objective="radius")
    return start, found if isinstance(found, Proved) else None


def _search_and_prove(
    mission: Mission,
    objective: Objective,
    starts: Sequence[Start] | None,
    barrier: bool | None,
    tell: Progress,
) -> Proved | Undecided:
    """Try with and without a barrier."""
    potential = Potential.of(mission)
    loop = Loop.of(mission, potential.q3)
    if loop.largest_force <= 0:
        raise InputError(mission.source, "gains", "the hover is beyond the singularity T = c q3*")
    wanted = tuple(starts) if starts is not None else ()
    if objective == "start" and not wanted:
        wanted = (Start.of(mission),)
    if len(wanted) > MOST_STARTS:
        raise InputError("--start", "", f"at most {MOST_STARTS} starts go into one certificate")
    _require_clear(mission, potential, wanted)
    gains = mission.gains
    possible = gains.k3 >= 3 * gains.k1 * gains.k2
    if barrier and not possible:
        return Undecided("a barrier needs k3 >= 3 k1 k2", mission)
    kinds = [k for k in (True, False) if (barrier is None or k is barrier) and (possible or not k)]
    reasons = []
    for with_barrier in kinds:
        verdict: Proved | str
        try:
            verdict = _attempt(mission, potential, loop, objective, wanted, with_barrier, tell)
        except (checker.Rejected, ArithmeticError, np.linalg.LinAlgError) as error:
            verdict = f"these numbers are beyond what can be computed with ({error})"
        if isinstance(verdict, Proved):
            return verdict
        reasons.append(("with" if with_barrier else "without") + f" a barrier: {verdict}")
    return Undecided("; ".join(reasons), mission, _advice(mission, bool(wanted)))


def _advice(mission: Mission, asked: bool) -> tuple[str, ...]:
    """Say what may help."""
    k, lines = mission.gains, []
    if k.k3 < 3 * k.k1 * k.k2:
        needed = f"k3 >= 3 k1 k2 = {float(3 * k.k1 * k.k2):.6g} kg/s"
        lines.append(f"{needed} (now {float(k.k3):.6g}): then a barrier makes regions far larger")
    else:
        lines.append("smaller k1 or k2, which ask for less force and tilt")
    if asked:
        lines.append("a start nearer to the goal; --objective radius tells how near")
    return tuple(lines)


def estimate(mission: Mission, *, objective: Objective = "radius", barrier: bool = False) -> Found:
    """Search without proving: for tuning, where many gains are tried.

    Parameters
    ----------
    mission : Mission
    objective, barrier
        See `attraction`.

    Returns
    -------
    Found
        In floating point; `HoverGrid.of(potential).radius` or `volume` tells its size.

    Raises
    ------
    InputError
        See `attraction`.
    ValueError
        If no weights satisfy the inequality.
    """
    potential = Potential.of(mission)
    loop = Loop.of(mission, potential.q3)
    starts = (Start.of(mission),) if objective == "start" else ()
    search = _search(mission, potential, loop, SLACKS[0], barrier, starts)
    found = find(search, objective, _start_terms(mission, potential, starts))
    if found is None:
        raise ValueError("no weights satisfy the inequality for these gains")
    return found


def _search(
    mission: Mission,
    potential: Potential,
    loop: Loop,
    slack: Slack,
    barrier: bool,
    starts: Sequence[Start],
) -> Search:
    k2 = float(mission.gains.k2)
    sinking = [_sinking(mission, start) for start in starts]
    deepest = max((z for z, _, _ in sinking), default=-float("inf"))
    first = max((x for _, x, _ in sinking), default=0.0)
    second = max((x for _, _, x in sinking), default=0.0)
    mass, k1 = float(mission.vehicle.mass), float(mission.gains.k1)
    slow, fast = _poles(mission)

    def lag(most: float) -> float:
        one = max(first, k1 / mass * most / fast)
        return max(most / k2, one + max(second, fast * one / slow))

    return Search(potential, loop, slack, barrier, deepest, lag)


def _attempt(
    mission: Mission,
    potential: Potential,
    loop: Loop,
    objective: Objective,
    starts: tuple[Start, ...],
    barrier: bool,
    tell: Progress,
) -> Proved | str:
    """Search with more and more room for the proof; return what was proved, or why not."""
    terms = _start_terms(mission, potential, starts)
    reason = ""
    for slack in SLACKS:
        tell("searching for weights" + (" with a barrier" if barrier else ""))

        search = _search(mission, potential, loop, slack, barrier, starts)
        found = find(search, objective, terms)
        if found is None:
            below = ", with a barrier below the starts" if barrier and starts else ""
            return reason or f"no weights were found that satisfy the inequality{below}"
        if starts and found.fill > 1:
            return (
                f"Λ at the start is {found.fill:.3g} times the highest level found "
                f"({found.binding})"
            )
        tell("proving")
        proved = prove(mission, found, starts, slack)
        if isinstance(proved, Proved):
            return proved
        reason = proved
    return reason


def prove(
    mission: Mission, found: Found, starts: Sequence[Start] = (), slack: Slack = SLACKS[0]
) -> Proved | str:
    """Round what was found, and prove it exactly.

    Parameters
    ----------
    mission : Mission
    found : Found
    starts : sequence of Start
    slack : Slack
        Of its fields, how much of the reach is given away.

    Returns
    -------
    Proved, or the reason why the checker rejects it
    """
    draft = _draft(mission, found, starts, 1 - slack.reach)
    try:
        _complete(draft, mission, found)
        certificate = seal_content(mission, "attraction", draft, model_fingerprint())
        checker.check(certificate.content)
    except checker.Rejected as rejected:
        return str(rejected)
    return _verdict(mission, certificate, starts)


def _draft(mission: Mission, found: Found, starts: Sequence[Start], share: float) -> dict[str, Any]:
    """Return claim and hints as far as they follow from the search alone."""
    potential = Potential.of(mission)
    weights = [decimal_below(float(w), 4) for w in found.weights]
    level = decimal_below(found.level, DIGITS)
    a, size = [float(w) for w in weights], float(level)
    plane = mission.height_of_target
    height = None if found.bottom is None else plane - Fraction(f"{found.bottom:.6f}")
    hover = hover_goal(mission).position

    def reach(*directions: tuple[float, float, float]) -> Fraction:
        least = min(
            reach_along(potential, np.array(d), np.array(a), size, None) for d in directions
        )
        return decimal_below(least * share, 3)

    down = reach((0, 0, 1))
    if height is not None:  # the barrier is exact: nothing of that needs to be given away
        down = min(down, decimal_below(plane - height - hover[2], 3))
    turns = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    around = [(float(np.cos(t)), float(np.sin(t)), 0.0) for t in turns]
    return {
        "weights": weights,
        "hover": list(hover),
        "enclosures": {},
        "multipliers": [],
        "claim": {
            "level": level,
            "rate": Fraction(1),
            "barrier_height": height,
            "reach": {
                "sideways": reach(*around),
                "up": reach((0, 0, -1)),
                "down": down,
            },
            "starts": [start.content() for start in starts],
        },
    }


def _complete(draft: dict[str, Any], mission: Mission, found: Found) -> None:
    """Add the bounds that follow from the level, rounded outward, the multipliers and the rate."""
    p = bounds_of(mission, draft)
    s, weight = p.s, p.s.m * p.s.gravity
    goal = [_down(p.q3[0]), _up(p.q3[1])]
    ends = [
        checker.factor(s.m, s.g, weight + sign * p.force, q)
        for sign, q in ((1, p.q3[0]), (-1, p.q3[1]))
    ]
    factor = [decimal_below(ends[0], 12), decimal_above(ends[1], 12)]
    tilt = decimal_above(p.sine / (1 + p.cosine), 9)
    largest = decimal_above(found.largest, 5)
    loop = Loop.of(mission, float(goal[0]))
    weights = np.array([float(a) for a in p.a])
    rates, multipliers = [], []
    for f in factor:
        least, tau = rate_and_multiplier(
            loop, weights, f=float(f), theta=float(tilt), largest=float(largest)
        )
        rates.append(least)
        multipliers.append(decimal_below(tau, DIGITS))
    rate = decimal_below(min(rates) * (1 - 1e-6), DIGITS)
    if rate <= 0:
        raise checker.Rejected("the inequality fails after rounding")
    draft["claim"]["rate"] = rate
    draft["multipliers"] = multipliers
    draft["enclosures"] = {
        "goal": goal,
        "factor": factor,
        "tilt": tilt,
        "largest_eigenvalue": largest,
    }


def bounds_of(mission: Mission, draft: dict[str, Any]) -> checker.Attraction:
    """Return what follows from mission, weights and level alone, exactly.

    Parameters
    ----------
    mission : Mission
    draft : dict
        The hover point, weights, level and other choices, exact; see `checker.read_attraction`.
    """
    text = mission.exact()
    by_height = mission.goal.height is not None
    content = {
        "mission": text,
        "mission_sha256": checker.digest(text),
        "goal_position": exact(draft["hover"]) if by_height else None,
        **exact(draft),
    }
    return checker.read_attraction(content)


def _verdict(mission: Mission, certificate: Certificate, starts: Sequence[Start]) -> Proved:
    content = certificate.content
    claim, p = content["claim"], checker.read_attraction(content)
    weight = p.s.m * p.s.gravity
    height = claim["barrier_height"]
    return Proved(
        level=p.level,
        weights=tuple(p.a),
        rate=Fraction(claim["rate"]),
        tilt=decimal_above(2 * Fraction(content["enclosures"]["tilt"]), 6),
        thrust=(weight - p.force, weight + p.force),
        largest_eigenvalue=Fraction(content["enclosures"]["largest_eigenvalue"]),
        barrier_height=None if height is None else Fraction(height),
        reach=Reach(**{k: Fraction(v) for k, v in claim["reach"].items()}),
        starts=tuple(starts),
        mission=mission,
        certificate=certificate,
    )


@cache
def model_fingerprint() -> str:
    """Return the SHA-256 of the graph of Λ' from which the region was found."""
    return fingerprint(derive_form().function())


def _start_terms(
    mission: Mission, potential: Potential, starts: Sequence[Start]
) -> np.ndarray[Any, Any]:
    """Return the terms of Λ at the corners and the centre of each set of starts, (k, 4)."""
    if not starts:
        return np.zeros((0, 4))
    one = Fraction(1)
    tiny = {"level": Fraction(1, 10**9), "rate": one, "barrier_height": None}
    claim: dict[str, Any] = {
        **tiny,
        "reach": {"sideways": one, "up": one, "down": one},
        "starts": [],
    }
    draft = {"weights": [one] * 3, "hover": list(hover_goal(mission).position), "claim": claim}
    p = bounds_of(mission, draft)
    rows = []
    for start in starts:
        shares = checker.shares_of(p, start.for_checker())
        for corner in np.stack(np.meshgrid([0, 1], [0, 1], [0, 1]), axis=-1).reshape(-1, 3):
            place = [[side[k]] * 2 for side, k in zip(start.position, corner, strict=True)]
            terms = checker.start_terms(p, shares, p.grid.cover(place))
            if terms is None:
                raise InputError("--start", "", "is at a target point, or a hair's breadth from it")
            rows.append([float(x) * 1.001 for x in terms])
    return np.unique(np.array(rows), axis=0)


def _poles(mission: Mission) -> tuple[float, float]:
    """Return r <= s of the height's equation, 1/s; see `checker.barrier_holds`."""
    m, k = float(mission.vehicle.mass), mission.gains
    k12 = float(k.k1 * k.k2)
    kappa = (k12 + float(k.k3)) / m
    root = np.sqrt(max(kappa**2 - 4 * kappa * k12 / m, 0.0))
    return float((kappa - root) / 2), float((kappa + root) / 2)


def _sinking(mission: Mission, start: Start) -> tuple[float, float, float]:
    """Return how deep (z, m) a start sinks by its own motion, and the two lags it has, m."""
    slow, fast = _poles(mission)
    speed = float(start.speed)
    v = mission.vehicle
    second_rate = float((start.thrust + v.weight * start.tilt) / v.mass)
    ahead = max(speed / slow, (speed + second_rate / (slow + fast)) * (1 / slow + 1 / fast))
    lag = (second_rate + slow * speed) / (slow * fast)
    return float(start.position[2][1]) + ahead, lag, speed / slow


def _require_clear(mission: Mission, potential: Potential, starts: Sequence[Start]) -> None:
    for start in starts:
        for point in mission.target.points:
            if all(a <= c <= b for c, (a, b) in zip(point, start.position, strict=True)):
                raise InputError(mission.source, "--start", "holds a target point")


def _down(value: Fraction) -> Fraction:
    return Fraction((value.numerator << BITS) // value.denominator, 1 << BITS)


def _up(value: Fraction) -> Fraction:
    return -_down(-value)
