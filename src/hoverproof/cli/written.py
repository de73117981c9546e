"""Mission files that commands write, each with the certificate of what is proved beside it."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from hoverproof.cli.reading import mission_name

if TYPE_CHECKING:
    from hoverproof.certification.certificate import Certificate
    from hoverproof.mission.sections import Mission


def certificate_beside(mission: Path, maker: str) -> Path:
    """Return where the certificate of a mission file is written, another one than by `attraction`.

    Parameters
    ----------
    mission : Path
    maker : str
        What wrote the mission, in a word: tuned, audit.
    """
    return mission.with_suffix(f".{maker}.cert.json")


def write_mission(
    path: Path, mission: Mission, proved: str, certificate: Certificate | None, maker: str
) -> Path | None:
    """Write a mission file that says which command made it, and its certificate beside it.

    Parameters
    ----------
    path : Path
    mission : Mission
    proved : str
        What is proved of it, in a line.
    certificate : Certificate, optional
        None writes none.
    maker : str
        See `certificate_beside`, which is returned if there is a certificate.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    from hoverproof.files import write_text
    from hoverproof.mission.writing import mission_text

    beside = None if certificate is None else certificate_beside(path, maker)
    if certificate is not None and beside is not None:
        certificate.save(beside)
    note = f"{shlex.join(['hoverproof', *sys.argv[1:]])}\n{proved}"
    write_text(path, mission_text(mission, name=mission_name(path), note=note))
    return beside
