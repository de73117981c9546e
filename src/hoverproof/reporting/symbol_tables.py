"""The symbols beside the formulas of a report: of its theorems and its law."""

from __future__ import annotations

from collections.abc import Iterator

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.mission.sections import Mission
from hoverproof.reporting.numerals import at_most
from hoverproof.reporting.symbols import IN_FORMULAS, SYMBOLS


def of_gains(mission: Mission, symbol: str) -> Iterator[tuple[str, str]]:
    """Yield the symbols of theorem 1, with what they mean.

    Parameters
    ----------
    mission : Mission
    symbol : str
        "Q" or "J".
    """
    yield from _named(SYMBOLS, symbol, "T", "Σ")
    yield from _named(IN_FORMULAS, "X")
    yield from _errors(mission)
    yield "ℒ", SYMBOLS["L"]
    yield from _named(IN_FORMULAS, "margin", "r")


def of_starts(verdict: Attraction | Exponential) -> Iterator[tuple[str, str]]:
    """Yield the symbols of the theorem about starts, with what they mean.

    Parameters
    ----------
    verdict : Attraction or Exponential
    """
    if isinstance(verdict, Exponential):
        yield from _named(SYMBOLS, "Ψ")
    else:
        yield from _named(SYMBOLS, verdict.symbol)
        yield from _named(IN_FORMULAS, "W")
    yield from _errors(verdict.mission)
    content = verdict.certificate.content
    if content.get("lag"):
        yield from _named(IN_FORMULAS, "τ", "μ, μT")
    if content.get("memory"):
        yield from _named(IN_FORMULAS, "τ̄", "y")
    yield from _named(IN_FORMULAS, "ξ, ξ*")
    yield from _of_time(verdict) if isinstance(verdict, Exponential) else _of_region(verdict)


def _of_time(verdict: Exponential) -> Iterator[tuple[str, str]]:
    yield from _named(IN_FORMULAS, "r")
    yield "σ, σ*", "feature that a level camera sees from a position, and from the goal"
    yield "ℓ", f"level that Ψ never passes on the way, {at_most(verdict.level)}"
    yield "d", f"|σ − σ*| is no larger on the way, {at_most(verdict.offset)}"
    if verdict.ultimate_radius is not None:
        yield "ℓ∞", "what noise and gusts leave of Ψ at most"


def _of_region(verdict: Attraction) -> Iterator[tuple[str, str]]:
    if verdict.mission.law.goal == "image":  # else it is among the errors
        yield from _named(IN_FORMULAS, "ρ")
    if verdict.barrier_height is not None:
        yield from _named(IN_FORMULAS, "h")


def _named(meanings: dict[str, str], *symbols: str) -> Iterator[tuple[str, str]]:
    yield from ((symbol, meanings[symbol]) for symbol in symbols)


def _errors(mission: Mission) -> Iterator[tuple[str, str]]:
    """Yield the errors of a law: those of its feature and its goal."""
    scaled, image = mission.law.feature == "scaled", mission.law.goal == "image"
    feature = "s" if scaled else "q"
    total = "weighted sum" if mission.target.weights else "sum"
    told = f"centroid of the target points in the image, the {total} of the unit vectors to them"
    yield feature, f"{told}; scaled by the size of the target" if scaled else told
    yield f"{feature}*", "the same, seen from the goal"
    wanted = f"{feature}*" if image else f"{feature}3* ρ"
    yield "δ1", f"image error, {feature} − {wanted}"
    if not image:
        yield from _named(IN_FORMULAS, "ρ")
    yield from _named(IN_FORMULAS, "δ2", "δ3")
    lever = f"P((T e3 − c {feature}*)×Ω)" if image else "T e3×Ω"
    yield "δ4", f"body-rate error, (m/(c (k1 k2 + k3))) {lever} + P δ3, Ω the body rate"
    yield from _named(IN_FORMULAS, "P")
