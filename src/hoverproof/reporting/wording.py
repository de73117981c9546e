"""What a report says in sentences."""

from __future__ import annotations

from collections.abc import Iterable

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.over_box import BoundsVerdict
from hoverproof.mission.sections import Mission
from hoverproof.reporting.parts import Attracted, Firmware, Flown, Map, Missing, Parts
from hoverproof.reporting.tables import at_least, at_most, inside, interval, place, short

NOT_REFUTED = (
    "That the vehicle falls: for a Q and a thrust within the assumed bounds this function L grows, "
    "and so its guarantee is gone. A flight may settle all the same, and the region of attraction, "
    "where one is proved below, rests on another function.",
    "That the Q of the counterexample belongs to this target: it lies within the bounds of its "
    "eigenvalues, which is all that was assumed.",
)
NOT_CLAIMED = (
    "That Q and the thrust stay within their bounds: the theorem holds while they do. The sections "
    "on the eigenvalue region and the region of attraction look at that.",
    "Anything about a vehicle that turns about its vertical axis: Ω3 = 0 is supposed, which the "
    "controller keeps if it holds at the start.",
    "Anything about sampling, noise, delay, limits of the rotors, wind, or errors of the model.",
)
THEOREM = {
    "proved": "Let Q, the matrix of the unknown depths, and the thrust T be anything within the "
    "bounds below. Then Σ is positive definite, with a margin; so while they keep to these bounds, "
    "the Lyapunov function falls exponentially.",
    "refuted": "There are a matrix Q and a thrust T within the bounds, and errors X, for which "
    "XᵀΣX is negative: there the Lyapunov function grows.",
    "undecided": "",
}
FLIGHT = (
    "A simulation of the closed loop from the start of the mission, with the camera in it. It "
    "illustrates; it proves nothing."
)


def headline(parts: Parts) -> str:
    """Say in one sentence what the verdict is.

    Parameters
    ----------
    parts : Parts
    """
    problem, verdict = parts.verdict.problem, parts.verdict
    question = (
        f"every symmetric Q with eigenvalues from {inside(problem.eigenvalues)} 1/m "
        f"({problem.footing}) and every "
        f"thrust from {inside(problem.thrust)} N"
    )
    if verdict.status == "proved":
        return (
            f"The gains work for {question}: Σ(Q, T) is positive definite there, and the Lyapunov "
            f"function falls at least as fast as exp(−{at_least(verdict.decay_rate)} t), t in s."
        )
    if verdict.status == "refuted":
        return (
            f"The gains do not work for {question}: at an exact counterexample Σ(Q, T) has an "
            f"eigenvalue of {at_most(verdict.margin_above)} kg/s or less."
        )
    return f"Whether the gains work for {question} was not decided."


def merits(parts: Parts) -> Iterable[tuple[str, str, str]]:
    """Yield the figures at the head of the page: name, value, note.

    Parameters
    ----------
    parts : Parts
    """
    verdict, attracted = parts.verdict, parts.attraction
    flight, firmware = parts.flight, parts.firmware
    if verdict.status == "proved":
        yield "margin of Σ, proved", f"≥ {at_least(verdict.margin)} kg/s", ""
        yield "decay rate of L, proved", f"≥ {at_least(verdict.decay_rate)} 1/s", ""
    elif verdict.margin_above is not None:
        yield "worst eigenvalue of Σ", f"≤ {at_most(verdict.margin_above)} kg/s", "proved"
    if isinstance(attracted, Attracted) and attracted.region is not None:
        reach = attracted.region.reach
        holds = "" if attracted.start is attracted.region else ", start not inside"
        yield (
            "may be switched on",
            f"{at_least(reach.sideways)} m sideways",
            f"{at_least(reach.down)} m down, {at_least(reach.up)} m up; proved{holds}",
        )
    elif not isinstance(attracted, Missing):
        yield "region of attraction", "undecided", ""
    if isinstance(flight, Flown):
        settled = flight.summary["settled_at"]
        value = "not reached" if settled is None else f"{short(settled)} s"
        yield "simulated flight settles after", value, "to 10 % of its distance at the start"
    if isinstance(firmware, Firmware):
        used = firmware.footprint
        flash = "flash not measured here" if isinstance(used, Missing) else f"{used.flash} B flash"
        count = firmware.manifest["budgets"]["instructions"]
        yield "firmware, Cortex-M4F", f"≤ {count} instructions", flash


def conditions(parts: Parts) -> str:
    """Say how the conditions of the printed theorem compare with the verdict.

    Parameters
    ----------
    parts : Parts
    """
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
        "How the verdict changes with two of the gains, from a tenth to ten times of what the "
        f"mission has: of {margin.size} cells, {int((margin > 0).sum())} are certified."
    )


def attraction(region: Attraction) -> str:
    """Say from where the motion comes to the goal.

    Parameters
    ----------
    region : Attraction
    """
    height = region.barrier_height
    where = "state" if height is None else "level hover at rest"
    above = "" if height is None else f" and at least {at_least(height)} m above the target"
    return (
        f"From every {where} with Λ at most {at_least(region.level, 6)}{above}, with any heading "
        "and yaw rate, the motion of the exact model comes to the hover at the goal, while all "
        "target points are seen."
    )


def region(found: BoundsVerdict, mission: Mission) -> str:
    """Say whether the eigenvalue bounds of a mission hold over a box.

    Parameters
    ----------
    found : ProvedBounds, RefutedBounds or UndecidedBounds
    mission : Mission
    """
    bounds = f"{interval(found.bounds)} 1/m"
    if found.status == "proved":
        return f"The bounds of the mission, {bounds}, hold at every position in the box."
    if found.status == "refuted":
        spot = found.outside
        return (
            f"The bounds {bounds} break at {place(spot.position)}: {spot.words}, near "
            f"{short(spot.value)} 1/m. The theorem says nothing there."
        )
    return f"Whether the bounds {bounds} hold all over the box was not decided within the effort."
