"""What a report says in sentences."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.certification.over_box import BoundsVerdict
from hoverproof.design.proved_and_flown import near_goal_from
from hoverproof.mission.sections import Mission
from hoverproof.reporting.numerals import at_least, at_most, bounded, inside, place, short
from hoverproof.reporting.parts import Attracted, Firmware, Flown, Map, Missing, Parts

YAW_RATE = (
    "Anything about a vehicle that turns about its vertical axis: Ω3 = 0 is assumed, which the "
    "controller maintains if it holds at the start.",
)
ALWAYS_BEYOND = (
    "Anything about sampling, noise, delay, limits of the rotors, wind, or errors of the model.",
)
OF_J = (
    "J turns a velocity into the rate of the scaled centroid, so it holds the unknown depths; I is "
    "the unit matrix."
)
FLIGHT = (
    "A simulation of the closed loop from the start of the mission, with the camera in it. It "
    "illustrates; it proves nothing."
)


def law(mission: Mission) -> str:
    """Say which law a report is about; nothing for the paper's.

    Parameters
    ----------
    mission : Mission
    """
    told = {
        "scaled": "the centroid scaled by the size of the target",
        "centroid": "the centroid of the image",
        "image": "a goal fixed in the image",
        "inertial": "a goal fixed to the vertical",
        "modelled": "a force that is modelled",
        "measured": "a force that is measured",
    }
    choice = mission.law
    if choice.is_papers:
        return ""
    words = ", ".join(told[one] for one in (choice.feature, choice.goal, choice.force))
    return f"Law {choice.name}: {words}. It is not the paper's law."


def heading(words: str, parts: Parts) -> str:
    """Return the heading of a section, as it is for this mission.

    Parameters
    ----------
    words : str
        As it is for the paper's law.
    parts : Parts
    """
    of_q = parts.verdict.problem.flow.symbol == "Q"
    return words if of_q else words.replace("Eigenvalue region", "Bounds of J")


def not_said(parts: Parts) -> Sequence[str]:
    """Return what the verdict does not say.

    Parameters
    ----------
    parts : Parts
    """
    symbol, papers = parts.verdict.problem.flow.symbol, parts.mission.law.is_papers
    if parts.verdict.status == "refuted":
        rests = (
            ", and the region of attraction, where one is proved below, rests on another function"
            if papers
            else ""
        )
        within = (
            "within the bounds of its eigenvalues, which is" if symbol == "Q" else "in the ball,"
        )
        return (
            f"That the vehicle falls: for a {symbol} and a thrust within the assumed bounds this "
            f"function L grows, and so its guarantee is gone. A flight may settle all the same"
            f"{rests}.",
            f"That the {symbol} of the counterexample belongs to this target: it lies {within} all "
            "that was assumed.",
        )
    look = (
        "The sections on the eigenvalue region and the region of attraction look at that."
        if papers
        else "The section on where they hold looks at that."
    )
    return (
        f"That {symbol} and the thrust stay within their bounds: the theorem holds while they do. "
        f"{look}",
        *(YAW_RATE if parts.mission.goal.heading is None else ()),
        *ALWAYS_BEYOND,
    )


def theorem(parts: Parts) -> str:
    """Say what the theorem says, before its formulas.

    Parameters
    ----------
    parts : Parts
    """
    of_q = parts.verdict.problem.flow.symbol == "Q"
    if parts.verdict.status == "proved":
        what = "Q, the matrix of the unknown depths," if of_q else "a 3 x 3 matrix J"
        return (
            f"Let {what} and the thrust T be anything within the bounds below. Then Σ is positive "
            "definite, with a margin; so while they stay within bounds, the Lyapunov function "
            f"falls exponentially.{'' if of_q else f' {OF_J}'}"
        )
    if parts.verdict.status == "refuted":
        symbol = "Q" if of_q else "J"
        return (
            f"There are a matrix {symbol} and a thrust T within the bounds, and errors X, for "
            "which XᵀΣX is negative: there the Lyapunov function grows."
            f"{'' if of_q else f' {OF_J}'}"
        )
    return ""


def inside_words(parts: Parts) -> str:
    """Say where the matrix of a counterexample lies.

    Parameters
    ----------
    parts : Parts
    """
    of_q = parts.verdict.problem.flow.symbol == "Q"
    where = "The eigenvalues of this Q lie inside the interval" if of_q else "This J is in the ball"
    return (
        f"{where}, and a thrust inside its interval has this f(T). Along the error X the Lyapunov "
        "function grows."
    )


def supposed(parts: Parts) -> str:
    """Say what the theorem supposes that depends on where the vehicle is.

    Parameters
    ----------
    parts : Parts
    """
    flow = parts.verdict.problem.flow
    keep = f"{flow.named} {'stay' if flow.symbol == 'Q' else 'stays'} within the bounds"
    return (
        f"The theorem assumes that {keep}. {flow.symbol} depends on where the vehicle is; here it "
        "is decided for the real target, over a box of positions around start and goal."
    )


def headline(parts: Parts) -> str:
    """Say in one sentence what the verdict about the gains is.

    Parameters
    ----------
    parts : Parts
    """
    problem, verdict = parts.verdict.problem, parts.verdict
    symbol = problem.flow.symbol
    every = (
        "every symmetric Q with eigenvalues from" if symbol == "Q" else "every 3 x 3 matrix J with"
    )
    question = (
        f"{every} {bounded(parts.mission, problem.eigenvalues, 'inward')} "
        f"({problem.footing}) and every "
        f"thrust from {inside(problem.thrust)} N"
    )
    if verdict.status == "proved":
        return (
            f"The gains work for the vehicle as modelled: Σ({symbol}, T) is positive definite for "
            f"{question}, and while {symbol} and T stay there the Lyapunov function L falls at "
            f"least as fast as exp(−{at_least(verdict.decay_rate)} t), t in s (theorem 1)."
        )
    if verdict.status == "refuted":
        return (
            f"The gains do not work for {question}: at an exact counterexample Σ({symbol}, T) has "
            f"an eigenvalue of {at_most(verdict.margin_above)} kg/s or less."
        )
    return f"Whether the gains work for {question} was not decided."


def merits(parts: Parts) -> Iterable[tuple[str, str, str]]:
    """Yield the figures at the head of the page: name, value, note.

    Parameters
    ----------
    parts : Parts
    """
    attracted, flight, firmware = parts.attraction, parts.flight, parts.firmware
    if isinstance(attracted, Attracted) and _is_timed(attracted):
        yield from _timed(attracted)
    else:
        yield from _nominal(parts)
        if isinstance(attracted, Attracted):
            yield _switched_on(attracted)
    if isinstance(flight, Flown):
        region = attracted.region if isinstance(attracted, Attracted) else None
        settled, near = settled_in_flight(flight, region)
        value = "not reached" if settled is None else f"{short(settled)} s"
        yield "simulated flight settles after", value, f"within {near}"
    if isinstance(firmware, Firmware):
        used = firmware.footprint
        flash = "flash not measured here" if isinstance(used, Missing) else f"{used.flash} B flash"
        count = firmware.manifest["budgets"]["instructions"]
        yield "firmware, Cortex-M4F", f"≤ {count} instructions", flash


def settled_in_flight(
    flight: Flown, region: Attraction | Exponential | None
) -> tuple[float | None, str]:
    """Return since when a flight is near its goal, s, and how near in words: as is proved, if so.

    Parameters
    ----------
    flight : Flown
    region : Attraction, Exponential or None
        What is proved of its mission.
    """
    if isinstance(region, Exponential):
        radius = region.settling.radius
        near = f"{at_most(radius)} m of its goal"
        return near_goal_from(region.mission, flight.whole, float(radius)), near
    return flight.summary["settled_at"], "a tenth of the way to go"


def nominal(parts: Parts) -> str:
    """Say what the theorem about the gains is about.

    Parameters
    ----------
    parts : Parts
    """
    symbol = parts.verdict.problem.flow.symbol
    return f"the vehicle as modelled, while {symbol} and T stay in their bounds"


def _nominal(parts: Parts) -> Iterator[tuple[str, str, str]]:
    verdict = parts.verdict
    if verdict.status == "proved":
        yield "margin of Σ, proved", f"≥ {at_least(verdict.margin)} kg/s", "theorem 1"
        rate = f"≥ {at_least(verdict.decay_rate)} 1/s"
        yield "decay rate of L, proved", rate, f"theorem 1: {nominal(parts)}"
    elif verdict.margin_above is not None:
        yield "worst eigenvalue of Σ", f"≤ {at_most(verdict.margin_above)} kg/s", "proved"


def _is_timed(attracted: Attracted) -> bool:
    """Tell whether it is proved how soon the start has settled, which counts for more."""
    return isinstance(attracted.region, Exponential) and attracted.start.status == "proved"


def _timed(attracted: Attracted) -> Iterator[tuple[str, str, str]]:
    region = attracted.region
    assert isinstance(region, Exponential)
    near, soon = at_most(region.settling.radius), at_most(region.settling.time)
    every = "every vehicle within tolerance" if region.mission.covers() else "as modelled"
    yield "settles after", f"{soon} s", f"within {near} m of its goal; proved, {every}"
    yield "decay rate of Ψ, proved", f"≥ {at_least(region.rate)} 1/s", f"theorem 5: {every}"


def _switched_on(attracted: Attracted) -> tuple[str, str, str]:
    region = attracted.region
    if region is None:
        return "region of attraction", "undecided", ""
    if isinstance(region, Exponential):
        return next(_timed(attracted))
    reach = region.reach
    holds = "" if attracted.start is region else ", start not inside"
    return (
        "may be switched on",
        f"{at_least(reach.sideways)} m sideways",
        f"{at_least(reach.down)} m down, {at_least(reach.up)} m up; proved{holds}",
    )


def conditions(parts: Parts) -> str:
    """Say how the conditions of the printed theorem compare with the verdict.

    Parameters
    ----------
    parts : Parts
    """
    if parts.demands is None:
        return (
            "The conditions of the printed theorem are about the paper's law, not about this one."
        )
    met = "meets all of them" if all(d.met for d in parts.demands) else "does not meet all of them"
    verdict = "undecided" if parts.verdict.status == "undecided" else f"{parts.verdict.status} here"
    return (
        f"The mission {met}. They are to ensure Σ(Q, T) ≻ 0; that is {verdict}, whatever they say."
    )


def atlas(found: Map) -> str:
    """Say how much of an atlas is certified.

    Parameters
    ----------
    found : Map
    """
    margin = found.data["margin"].values
    return (
        f"How the verdict on the gains changes with two of them, from 1/{found.reach} to "
        f"{found.reach} times their values in the mission, for the vehicle as modelled: of "
        f"{margin.size} cells, {int((margin > 0).sum())} are certified."
    )


def attraction(region: Attraction | Exponential) -> str:
    """Say from where the motion comes to the goal.

    Parameters
    ----------
    region : Attraction or Exponential
    """
    covers = ", ".join(region.mission.covers())
    who = f"every vehicle with {covers}" if covers else "the exact model"
    if isinstance(region, Exponential):
        settling = region.settling
        return (
            f"From the starts below the motion of {who} comes to the hover at the goal, "
            f"exponentially (theorem 5), while all target points are seen: from "
            f"{at_most(settling.time)} s on it is within {at_most(settling.radius)} m of it."
        )
    height = region.barrier_height
    symbol, turning = region.symbol, "heading" if region.tolerant else "heading and yaw rate"
    where = "state" if height is None else "level hover at rest"
    above = "" if height is None else f" and at least {at_most(height)} m above the target"
    return (
        f"From every {where} with {symbol} at most {at_least(region.level, 6)}{above}, with any "
        f"{turning}, the motion of {who} comes to the hover at the goal, while all target points "
        "are seen."
    )


def region(found: BoundsVerdict, mission: Mission) -> str:
    """Say whether the eigenvalue bounds of a mission hold over a box.

    Parameters
    ----------
    found : ProvedBounds, RefutedBounds or UndecidedBounds
    mission : Mission
    """
    bounds = bounded(mission, found.bounds)
    if found.status == "proved":
        return f"The bounds of the mission, {bounds}, hold at every position in the box."
    if found.status == "refuted":
        spot = found.outside
        return (
            f"The bounds {bounds} break at {place(spot.position)}: {spot.words}, near "
            f"{short(spot.value)} 1/m. The theorem says nothing there."
        )
    return f"Whether the bounds {bounds} hold all over the box was not decided within the effort."
