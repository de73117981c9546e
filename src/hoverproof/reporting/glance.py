"""What a report says at one glance: what is proved, for whom, from where, how soon; what is not."""

from __future__ import annotations

from collections.abc import Iterator

from hoverproof.algebra.decimals import degrees_at_most
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.convergence import Converges, not_covered
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.design.proved_and_flown import why_longer
from hoverproof.reporting.numerals import at_least, at_most, place, short
from hoverproof.reporting.parts import Flown, Missing, Parts
from hoverproof.reporting.wording import headline, settled_in_flight

Line = tuple[str, str]
NOT_COVERED, IN_A_FLIGHT = "Not covered", "In a flight"
NOT_PROVED = NOT_COVERED, IN_A_FLIGHT
"""Questions whose answers are no proof."""


def rows(parts: Parts) -> list[Line]:
    """Return questions and their answers.

    Parameters
    ----------
    parts : Parts
    """
    attracted, gains = parts.attraction, headline(parts)
    if isinstance(attracted, Missing):
        return [("Gains", gains)]
    start, region = attracted.start, attracted.region
    if region is None:
        return [("Gains", gains), ("From its start", _unproved(start))]
    found = [
        ("For whom", f"{_whom(region)} comes to the hover at its goal"),
        ("From where", _where(region)),
        ("How soon", _how_soon(region)),
        *_in_flight(region, parts.flight),
        ("On the way", "; ".join(_on_the_way(region))),
    ]
    if start.status == "proved":
        found.append(("Gains", gains))
    else:
        found = [("Gains", gains), ("From its start", _unproved(start)), *found]
    return [*found, (NOT_COVERED, "; ".join(not_covered(region)))]


def _whom(region: Attraction | Exponential) -> str:
    covers = ", ".join(region.mission.covers())
    return f"every vehicle with {covers}" if covers else "the vehicle, exactly as modelled,"


def _where(region: Attraction | Exponential) -> str:
    starts = ", ".join(
        place([(low + high) / 2 for low, high in start.position]) for start in region.starts
    )
    if isinstance(region, Exponential):
        return f"its start, {starts}"
    reach = region.reach
    hovers = (
        f"hovers up to {at_least(reach.sideways)} m sideways, {at_least(reach.up)} m up and "
        f"{at_least(reach.down)} m down of the goal"
    )
    return f"its start, {starts}, and {hovers}" if starts else hovers


def _how_soon(region: Attraction | Exponential) -> str:
    if isinstance(region, Attraction):
        return "eventually; no time is proved"
    settling, last = region.settling, region.ultimate_radius
    words = f"within {at_most(settling.radius)} m of its goal from {at_most(settling.time)} s on"
    return words if last is None else f"{words}, in the end within {at_most(last)} m"


def _in_flight(region: Attraction | Exponential, flight: Flown | Missing) -> Iterator[Line]:
    """Yield when the flight of the page has settled, and why the proof takes longer if it does."""
    if isinstance(flight, Missing):
        return
    settled, near = settled_in_flight(flight, region)
    if settled is None:
        yield IN_A_FLIGHT, f"not within {near} at its end (simulated)"
        return
    words = f"within {near} from {short(settled)} s on (simulated, the vehicle as modelled)"
    longer = why_longer(region, settled) if isinstance(region, Exponential) else None
    yield IN_A_FLIGHT, words if longer is None else f"{words}; the proof takes {longer}"


def _on_the_way(region: Attraction | Exponential) -> Iterator[str]:
    yield f"tilt up to {degrees_at_most(region.tilt)}°"
    if isinstance(region, Attraction):
        low, high = region.thrust
        yield f"thrust from {at_least(low, 4)} to {at_most(high, 4)} N"
        return
    if region.field_of_view is not None:
        axis = region.mission.camera.axis_seen
        yield f"every target point within {degrees_at_most(region.field_of_view)}° of the {axis}"
    low, high = region.rotor_thrust
    yield f"each rotor from {at_least(low)} to {at_most(high)} N"


def _unproved(start: Converges) -> str:
    return f"{start.status}: {start.reason}"
