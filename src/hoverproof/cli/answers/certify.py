"""What `certify` answers."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from hoverproof.algebra.decimals import at_least, at_most
from hoverproof.certification.gains import (
    GainsVerdict,
    ProvedGains,
    RefutedGains,
    UndecidedGains,
)
from hoverproof.certification.region import Box
from hoverproof.cli.answers.answer import EXIT, Answer
from hoverproof.cli.answers.words import (
    about,
    as_argument,
    bounds_as_json,
    goal_as_json,
    goal_text,
    inside,
    number,
    numbers,
    sides_text,
    whole,
)
from hoverproof.paper.conditions import Demand
from hoverproof.plausibility import Finding

CLAIM = {
    "proved": "{} ≻ 0 for",
    "refuted": "{} ≻ 0 does not hold for",
    "undecided": "not known whether {} ≻ 0 for",
}


@dataclass(frozen=True)
class CertifyAnswer(Answer):
    """A verdict on the gains, what the paper would ask of them, and where the certificate is.

    With what is strange about a loop for which they are proved. The paper asks nothing of another
    law than its own: ``demands`` are then None. ``asked`` is the box of which bounds were wanted;
    ``named`` the arguments with which the mission was given.
    """

    verdict: GainsVerdict
    path: Path | None
    demands: Sequence[Demand] | None
    weighted: bool
    strange: Sequence[Finding]
    asked: Box | None
    named: str

    @property
    def status(self) -> int:
        """The exit status."""
        return EXIT[self.verdict.status]

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        yield f"{self.verdict.problem.mission.name}: {self.verdict.status}"
        yield from self._question()
        match self.verdict:
            case ProvedGains() as proved:
                yield from self._proved(proved)
            case RefutedGains() as refuted:
                yield from self._refuted(refuted)
            case UndecidedGains() as undecided:
                yield f"  {undecided.reason}"
                if undecided.margin_above is not None:
                    yield _worst(undecided.margin_above)
        yield from self._demanded()
        if self.path is not None:
            yield f"Next: hoverproof check {as_argument(self.path)}"
        if self.verdict.proved and self.verdict.problem.box is None:
            yield f"Then: hoverproof region {self.named}, for bounds that are proved"

    def _demanded(self) -> Iterator[str]:
        if self.demands is None:
            return
        yield "The printed theorem of the paper (false, see hoverproof derive) asks for:"
        # broken between conditions, not within
        whole = "; ".join(d.text().replace(" ", "\xa0") for d in self.demands)
        for line in textwrap.wrap(whole, 76):
            yield "  " + line.replace("\xa0", " ")

    def _question(self) -> Iterator[str]:
        problem = self.verdict.problem
        flow, thrust = problem.flow, inside(problem.thrust)
        if self.asked is not None and problem.box != self.asked:  # nothing is known over that box
            yield f"  not known whether Σ({flow.symbol}, T) ≻ 0 with bounds over the box"
            yield f"  {sides_text(self.asked)} m and every thrust T in {thrust} N"
            return
        claim = CLAIM[self.verdict.status].format(f"Σ({flow.symbol}, T)")
        yield f"  {claim} {flow.every}"
        yield f"  {flow.within(problem.eigenvalues, whole)} and every thrust T in {thrust} N"
        if problem.box is not None:
            yield f"  ({flow.bounds} proved over the box"
            yield f"  {sides_text(problem.box)} m)"
            own = problem.mission.bounds.eigenvalues
            if isinstance(own, tuple):
                yield f"  the mission's own bounds {flow.within(own, whole)} are not used"
        else:
            yield f"  ({flow.bounds} assumed, not proved: see hoverproof region)"
        yield from goal_text(problem.mission)
        if self.weighted:
            yield f"  weights of L            {', '.join(map(number, problem.weights))}"

    def _proved(self, verdict: ProvedGains) -> Iterator[str]:
        ends = f"from {at_least(verdict.margin)} to {at_most(verdict.margin_above)}"
        what = "margin, Σ ⪰ margin·W   " if self.weighted else "worst eigenvalue of Σ  "
        yield f"  {what} {ends} kg/s, proved"
        yield f"  decay rate of L         {at_least(verdict.decay_rate)} 1/s, proved"
        yield f"  certificate             {self.path}"

    def _refuted(self, verdict: RefutedGains) -> Iterator[str]:
        yield _worst(verdict.margin_above)
        yield "  counterexample, exact:"
        rows = "; ".join(", ".join(map(str, row)) for row in verdict.Q)
        yield f"    {verdict.problem.flow.symbol} = [{rows}] 1/m"
        yield f"    f = {verdict.f} 1/m, T = {number(verdict.thrust)} N"
        yield f"    X = ({', '.join(map(str, verdict.X))})"
        yield f"    XᵀΣX <= {verdict.value} (about {about(verdict.value)}) < 0"
        yield f"  written to              {self.path}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        verdict, problem = self.verdict, self.verdict.problem
        proved, refuted = verdict.proved, verdict.refuted
        above = None if verdict.margin_above is None else float(verdict.margin_above)
        return {
            "mission": problem.mission.name,
            "verdict": verdict.status,
            "margin": float(proved.margin) if proved else above,
            "margin_bounds": [float(proved.margin) if proved else None, above],
            "decay_rate": float(proved.decay_rate) if proved else None,
            **bounds_as_json(problem),
            "thrust": numbers(problem.thrust),
            "goal_centroid": numbers(problem.goal.centroid_midpoint),
            "goal_position": goal_as_json(problem.mission),
            "weights": numbers(problem.weights),
            "box": None if problem.box is None else [numbers(side) for side in problem.box],
            "counterexample": refuted.certificate.content["counterexample"] if refuted else None,
            "reason": verdict.reason,
            "statement": verdict.statement,
            "certificate": None if self.path is None else str(self.path),
            "units": {
                "margin": "kg/s",
                "decay_rate": "1/s",
                "eigenvalues": "1/m",
                "ball": "1/m",
                "thrust": "N",
            },
            "paper_conditions": None
            if self.demands is None
            else [{"condition": d.text(), "met": d.met} for d in self.demands],
            "warnings": list(map(str, self.strange)),
        }


def _worst(margin_above: Fraction) -> str:
    return f"  worst eigenvalue of Σ   {at_most(margin_above)} kg/s or less, proved"
