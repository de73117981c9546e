"""What `audit` answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.cli.answers.answer import EXIT, Answer
from hoverproof.cli.answers.words import wrapped

if TYPE_CHECKING:
    from hoverproof.audit.finding import Finding
    from hoverproof.audit.verdict import Audit

HELD = {True: "held", False: "BROKEN", None: "not told"}


@dataclass(frozen=True)
class AuditAnswer(Answer):
    """An audit, why nothing is proved, the command that would cover, and the page."""

    found: Audit
    reason: str
    command: str | None
    page: Path | None

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
            return f"{len(found.broken)} of {told} broken"
        if not told:
            return "nothing told"
        return f"all {told} that are told held" if told < total else f"all {told} held"

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
        for key, value in found.covering().items():
            yield f"  {'would be covered by':22}  uncertainty.{key} = {value}"
        if self.page is not None:
            yield f"  {'page':22}  {self.page}"
        if self.command:
            yield f"Next: {self.command}"

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
            "command": self.command,
            "page": None if self.page is None else str(self.page),
        }


def _lines(f: Finding) -> Iterator[str]:
    """Yield what is found of one assumption."""
    if f.held is None:
        yield from wrapped(f.name, f"not told: {f.words}")
        return
    unit = "" if f.unit == "1" else f" {f.unit}"
    since = "" if f.at is None else f" from {f.at:.4g} s on"
    yield from wrapped(
        f.name, f"{HELD[f.held]}{since}: {_number(f.value)} of {_number(f.bound)}{unit}"
    )
    yield from wrapped("", f.words)


def _first(f: Finding) -> str:
    unit = "" if f.unit == "1" else f" {f.unit}"
    when = "" if f.at is None else f" at {f.at:.4g} s"
    return f"{f.name}{when}, by {_number(-f.margin)}{unit}"


def _number(value: float) -> str:
    return f"{value:.4g}"
