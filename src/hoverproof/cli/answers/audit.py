"""What `audit` answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.cli.answers.answer import EXIT, Answer
from hoverproof.cli.answers.exponential import settled_text
from hoverproof.cli.answers.words import wrapped

if TYPE_CHECKING:
    from hoverproof.audit.finding import Finding
    from hoverproof.audit.recertifying import Recertified
    from hoverproof.audit.verdict import Audit

HELD = {True: "held", False: "BROKEN", None: "not told"}


@dataclass(frozen=True)
class AuditAnswer(Answer):
    """An audit, why nothing is proved, the command that would cover, the page, a proof anew."""

    found: Audit
    reason: str
    command: str | None
    page: Path | None
    certify: Path | None = None
    certificate: Path | None = None
    anew: Recertified | None = None

    @property
    def status(self) -> int:
        """The exit status."""
        found = self.found
        if found.broken:
            return EXIT["refuted"]
        told = any(f.held is not None for f in found.findings)
        return EXIT["proved"] if found.claim is not None and told else EXIT["undecided"]

    @property
    def verdict(self) -> str:
        """The first line, without the file."""
        found, total = self.found, len(self.found.findings)
        told = total - len(found.untold)
        if found.broken:
            return f"{len(found.broken)} of {told} assumptions broken"
        if not told:
            return "nothing told"
        return f"all {told} assumptions {'that are told ' * (told < total)}held"

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        found, log = self.found, self.found.log
        partial = f" (partial: {log.partial})" if log.partial else ""
        yield f"{found.mission.name}: {self.verdict}{partial}"
        yield from wrapped("log", f"{log.source}, {log.kind}")
        ends = f"{log.times[0]:.4g} to {log.times[-1]:.4g} s"
        yield from wrapped("time", f"{ends}, {len(log.times)} samples")
        for note in log.notes:
            yield from wrapped("note", note)
        for name, lack in zip(("not in this log", *[""] * len(log.lacks)), log.lacks, strict=False):
            yield from wrapped(name, lack)
        if found.claim is None:
            yield from wrapped("theorem 5", f"not proved of this mission: {self.reason}")
        for finding in found.findings:
            yield from _lines(finding)
        if found.broken:
            yield from wrapped("first", _first(found.broken[0]))
        if found.of_another_vehicle:
            yield from wrapped("would be covered by", "no tolerance: is it of another vehicle?")
        for key, value in found.covering().items():
            yield f"  {'would be covered by':22}  uncertainty.{key} = {value}"
        yield from self.proof_anew()
        if self.page is not None:
            yield f"  {'page':22}  {self.page}"
        if self.command:
            yield f"Next: {self.command}"

    def proof_anew(self) -> Iterator[str]:
        """Yield what a proof with wider tolerances came to."""
        if self.certify is None:
            return
        if self.anew is None:
            yield from wrapped("proved again", f"nothing: {self._no_need()}")
            return
        verdict = self.anew.verdict
        if verdict is None:
            yield from wrapped("proved again", f"not with these: {self.anew.reason}")
            return
        whose = "tuned gains" if self.anew.tuned else "the mission's gains"
        yield from wrapped(
            "proved again", f"with these and {whose}: settled {settled_text(verdict)}"
        )
        if others := [f.name for f in self.found.broken if not f.key and not f.follows]:
            yield from wrapped("", f"covered by no tolerance: {', '.join(others)}")
        yield f"  {'mission':22}  {self.certify}"
        yield f"  {'certificate':22}  {self.certificate}"

    def _no_need(self) -> str:
        if self.found.broken:
            return "no tolerance covers what broke"
        return "the mission's own tolerances cover what is told"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        found, log = self.found, self.found.log
        return {
            "mission": found.mission.name,
            "log": log.source,
            "kind": log.kind,
            "partial": log.partial or None,
            "from": float(log.times[0]),
            "until": float(log.times[-1]),
            "notes": [*log.notes],
            "lacks": [*log.lacks],
            "proved": found.claim is not None,
            "reason": self.reason or None,
            "broken": [f.name for f in found.broken],
            "untold": [f.name for f in found.untold],
            "first": found.broken[0].as_json() if found.broken else None,
            "findings": [f.as_json() for f in found.findings],
            "covering": {k: float(v) for k, v in found.covering().items()},
            "anew": self._anew_as_json(),
            "command": self.command,
            "page": None if self.page is None else str(self.page),
        }

    def _anew_as_json(self) -> dict[str, Any] | None:
        if self.anew is None or self.certify is None:
            return None
        verdict = self.anew.verdict
        proved = verdict is not None
        return {
            "proved": proved,
            "tuned": self.anew.tuned,
            "reason": self.anew.reason or None,
            "settling_time": None if verdict is None else float(verdict.settling.time),
            "settling_radius": None if verdict is None else float(verdict.settling.radius),
            "mission": str(self.certify) if proved else None,
            "certificate": str(self.certificate) if proved else None,
        }


def _lines(f: Finding) -> Iterator[str]:
    """Yield what is found of one assumption."""
    if f.held is None:
        yield from wrapped(f.name, f"not told: {f.words}")
        return
    since = "" if f.at is None else f" from {f.at:.4g} s on"
    yield from wrapped(f.name, f"{HELD[f.held]}{since}: {f.found}, assumed {f.assumed}")
    yield from wrapped("", f.words)


def _first(f: Finding) -> str:
    when = "" if f.at is None else f" at {f.at:.4g} s"
    return f"{f.name}{when}, by {f.beyond}"
