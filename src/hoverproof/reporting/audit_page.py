"""The page of an audit: one HTML file that needs no other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from hoverproof.audit.verdict import Audit
from hoverproof.files import write_text
from hoverproof.reporting.assets import asset, pages
from hoverproof.reporting.pictures import Picture, picture
from hoverproof.show.audit import finding_figure
from hoverproof.version import __version__


def write_page(
    path: Path,
    audit: Audit,
    summary: str,
    lines: Sequence[str],
    command: str | None,
    anew: Sequence[str] = (),
) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
    audit : Audit
    summary : str
        What it came to, in a few words.
    lines : sequence of str
        What is printed.
    command : str, optional
        That asks for the proof with tolerances that would cover what was found.
    anew : sequence of str
        What such a proof came to, if it was asked for.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    log = audit.log
    told = [f for f in audit.findings if f.held is not None]
    tone = "refuted" if audit.broken else "proved" if told and audit.claim else "undecided"
    text = (
        pages()
        .get_template("audit.html.j2")
        .render(
            audit=audit,
            heading=f"{audit.mission.name}: was it flown as it is proved?",
            span=f"{log.times[0]:.4g} to {log.times[-1]:.4g} s",
            tone=tone,
            summary=summary,
            said=[*_said(audit)],
            told=told,
            untold=audit.untold,
            command=command,
            anew=anew,
            pictures=_pictures(audit),
            lines=lines,
            css=asset("report.css"),
            version=__version__,
        )
    )
    write_text(path, text)


def _said(audit: Audit) -> Iterator[str]:
    """Yield what is to be known before all else."""
    if audit.broken:
        first = audit.broken[0]
        when = "" if first.at is None else f", at {first.at:.4g} s"
        yield f"First broke: {first.name}{when}: {first.found}, where {first.assumed} is assumed."
    if audit.log.partial:
        yield f"The log is partial: {audit.log.partial}."
    if audit.claim is None:
        yield "Nothing is proved of this mission by theorem 5."
    yield from (f"{note[:1].upper()}{note[1:]}." for note in audit.log.notes)


def _pictures(audit: Audit) -> list[Picture]:
    drawn = [f for f in audit.findings if f.times is not None and f.values is not None]
    drawn.sort(key=lambda f: bool(f.held))  # what broke comes first
    found = []
    for k, f in enumerate(drawn):
        what = f"{f.name}, {'held' if f.held else 'broken'}: {f.found} of {f.assumed}"
        found.append(picture(f"finding-{k}", lambda f=f: finding_figure(f), f.name, what))  # type: ignore[misc]
    return found
