"""What `tune --trade` answers: proved settling times along what is traded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hoverproof.algebra.decimals import at_most
from hoverproof.cli.answers.attraction import considered
from hoverproof.cli.answers.curve import CurveAnswer, Found, gains_row, nothing_row
from hoverproof.cli.answers.words import about, number, wrapped
from hoverproof.design.outcome import StartTuned
from hoverproof.design.start_trade import TRADED
from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import TOLERANCES, Uncertainty
from hoverproof.servo.variables import Design


@dataclass(frozen=True)
class StartCurveAnswer(CurveAnswer):
    """The proved settling time against what is traded.

    Attributes
    ----------
    traded : str
        One of `TRADED`.
    mission_of : Mission
        What was asked about.
    """

    traded: str
    mission_of: Mission

    @property
    def own(self) -> list[str]:
        """What the mission itself asks of what is traded, in words."""
        if self.traded not in TOLERANCES:
            return []
        size = getattr(self.mission_of.uncertainty, self.traded)
        return Uncertainty(**{self.traded: size}).covers()

    @property
    def beside(self) -> list[str]:
        """What it asks besides: all points cover that."""
        return [words for words in self.mission_of.asks_to_cover() if words not in self.own]

    @property
    def considered(self) -> list[str]:
        """What the proofs cover: of what is traded what stands in the table."""
        tuned = [found for _, found in self.points if isinstance(found, StartTuned)]
        return [*considered(tuned[0].verdict), *self.own] if tuned else []

    def about_tolerances(self, left: list[str]) -> dict[str, list[str]]:
        """Say of tolerances whether they are left out, or asked for in vain."""
        some = any(isinstance(found, StartTuned) for _, found in self.points)
        return {"not considered" if some else "asked for": left}

    @property
    def title(self) -> str:  # type: ignore[override]
        """What it is about."""
        return f"proved settling time from the start against {self.traded.replace('_', ' ')}"

    @property
    def along(self) -> str:  # type: ignore[override]
        """The key of the value."""
        return self.traded

    @property
    def head(self) -> str:  # type: ignore[override]
        """The heads of the columns."""
        words = f"{TRADED[self.traded] or 'share':>8}", f"{'s proved':>9}", f"{'s flown':>8}"
        return "  ".join(["", *words, *(f"{k:>9}" for k in Design.chain_gains())])

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        first, *rest = super().text()
        yield first
        yield from wrapped("for every vehicle", ", ".join(self.beside) or "just as modelled")
        yield from rest
        option = {"bandwidth": "--bandwidth RAD/S", "distance": "--set start.position=[X,Y,Z]"}
        alone = option.get(self.traded, f"--set uncertainty.{self.traded}=VALUE")
        yield f"Next: tune with {alone} --out FILE.toml"
        yield "  writes the mission of a point, and its certificate"

    def row(self, at: float, found: Found) -> str:
        """Write a point of the curve."""
        if not isinstance(found, StartTuned):
            return nothing_row(f"{number(at):>8}", found)
        flown = "-" if found.flown is None else about(found.flown)
        time = at_most(found.verdict.settling.time)
        return "  ".join(
            ["", f"{number(at):>8}", f"{time:>9}", f"{flown:>8}", *gains_row(found, 9)]
        )
