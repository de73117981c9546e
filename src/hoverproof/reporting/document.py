"""Write the report of a mission."""

from __future__ import annotations

import hashlib
import os
import shlex
from collections.abc import Collection, Mapping
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from pathlib import Path

from hoverproof.certification.convergence import Converges
from hoverproof.certification.gains import GainsVerdict
from hoverproof.errors import InputError, suggestion
from hoverproof.files import replacing
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.reporting import glance
from hoverproof.reporting.page import Origin, render
from hoverproof.reporting.parts import PARTS, Attracted, Missing, Parts, Show, gather
from hoverproof.simulation.plan import check_runs_differ


@dataclass(frozen=True)
class Report:
    """What was written.

    Attributes
    ----------
    path : Path
        The file.
    size : int
        Its number of bytes.
    sha256 : str
        Of it.
    verdict
        What `hoverproof.certify` returned.
    start : Attraction, Exponential, Sinks, Undecided or None
        What `hoverproof.attraction` returned for the start of the mission, if it was asked.
    glance : list of Line
        Questions and answers at its head: what is proved, for whom, from where, how soon.
    missing : dict of str to str
        Parts that are not in it, and why.
    """

    path: Path
    size: int
    sha256: str
    verdict: GainsVerdict
    start: Converges | None
    glance: list[glance.Line]
    missing: Mapping[str, str]


@of_mission
def report(
    mission: Mission,
    path: str | Path,
    *,
    without: Collection[str] = (),
    runs: int | None = None,
    command: str | None = None,
    show: Show = lambda words: None,
) -> Report:
    """Write all that is known of a mission into one HTML file that needs no other.

    The same mission and versions make the same bytes. A date is in it only if the environment
    variable ``SOURCE_DATE_EPOCH`` gives one.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    path : str or Path
        The file, HTML.
    without : collection of str
        Parts to leave out: some of "atlas", "region", "attraction", "flight", "firmware", "ledger".
    runs : int, optional
        Number of flights to fly, drawn from the scatter of the mission, besides the one.
    command : str, optional
        How it was made, as told in it.
    show : callable
        Told, in words, what is begun.

    Returns
    -------
    Report

    Raises
    ------
    InputError
        If the mission poses no question, an argument cannot be used, or the file cannot be written.
    """
    for name in without:
        if name not in PARTS:
            raise InputError(
                "--without", "", f"no part {name!r} ({suggestion(name, PARTS, 'parts')})"
            )
    if runs is not None and runs < 1:
        raise InputError("--runs", "", f"must be at least 1, not {runs}")
    if runs is not None:
        check_runs_differ(mission, runs)
    made_at = _date()
    with replacing(path) as beside:  # first, so that nothing is computed in vain
        parts = gather(mission, without=without, runs=runs, show=show)
        show("page")
        how = command or f"hoverproof report {shlex.quote(mission.source)}"
        rows = glance.rows(parts)
        written = render(parts, Origin(how, mission.source, made_at), rows).encode()
        beside.write_bytes(written)
    digest = hashlib.sha256(written).hexdigest()
    start = parts.attraction.start if isinstance(parts.attraction, Attracted) else None
    return Report(Path(path), len(written), digest, parts.verdict, start, rows, _missing(parts))


def _missing(parts: Parts) -> dict[str, str]:
    held = {f.name: getattr(parts, f.name) for f in fields(parts)}
    return {name: part.reason for name, part in held.items() if isinstance(part, Missing)}


def _date() -> str | None:
    seconds = os.environ.get("SOURCE_DATE_EPOCH")
    if not seconds:
        return None
    try:
        return datetime.fromtimestamp(int(seconds), UTC).strftime("%Y-%m-%d")
    except (ValueError, OverflowError, OSError):
        reason = f"must be a number of seconds since 1970, not {seconds!r}"
        raise InputError("SOURCE_DATE_EPOCH", "", reason) from None
