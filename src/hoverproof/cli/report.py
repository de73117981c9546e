"""The command `report`: all that is known of a mission, in one file."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter, validators

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.console import Json, MissionName, Set, load_mission
from hoverproof.cli.reading import default_stem, file_to_write


def report(
    mission: MissionName,
    *,
    out: Annotated[
        Path | None,
        Parameter(
            name=["--out", "-o"],
            help="File to write; default NAME.report.html, NAME as for `certify`.",
        ),
    ] = None,
    without: Annotated[
        list[Literal["atlas", "region", "attraction", "flight", "firmware", "ledger"]] | None,
        Parameter(negative="", help="Leave this part out (repeatable)."),
    ] = None,
    runs: Annotated[
        int | None,
        Parameter(
            help="Also fly this many times, drawn from [scatter] of the mission.",
            validator=validators.Number(gte=1),
        ),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Write all that is known of a mission into one HTML file that opens without a network.

    Verdict and theorem in words and formulas, margins, atlas, eigenvalue region, region of
    attraction, the flight in motion, firmware figures, the ledger of the paper, and provenance,
    with the certificates inside. A part that cannot be computed says why. Opens in any browser,
    on a desk or a phone. The same mission and versions make the same bytes.

    Status as that of `certify`: 0 proved, 1 refuted, 3 undecided; the report is written all the
    same.

    Example: `hoverproof report x4-flyer -o report.html`

    Example: `hoverproof report crazyflie-2.1 --without attraction --json`
    """
    from hoverproof.cli.answers.report import ReportAnswer
    from hoverproof.reporting.document import report as write

    loaded = load_mission(mission, set_)
    words = ["hoverproof", "report", mission]
    words += [w for setting in set_ or [] for w in ("--set", setting)]
    words += [w for part in without or [] for w in ("--without", part)]
    words += [] if runs is None else ["--runs", str(runs)]
    path = file_to_write(out, f"{default_stem(loaded, mission, set_)}.report.html")
    written = write(
        loaded,
        path,
        without=without or (),
        runs=runs,
        command=shlex.join(words),
        show=lambda text: print(f"{text} ...", file=sys.stderr),
    )
    return tell(ReportAnswer(loaded.name, written, path), json_, loaded)
