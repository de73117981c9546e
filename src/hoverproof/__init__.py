"""From a camera, a target and a hovering vehicle to gains with a proof, a flight and C code.

>>> import hoverproof as hp
>>> verdict = hp.certify(hp.load("x4-flyer"))
>>> verdict.status
'proved'
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from pathlib import Path

    from hoverproof.certification.atlas import atlas as atlas
    from hoverproof.certification.attraction.proof import attraction as attraction
    from hoverproof.certification.attraction.starts import Start as Start
    from hoverproof.certification.gains import certify as certify
    from hoverproof.certification.tuning import pareto as pareto
    from hoverproof.certification.tuning import tune as tune
    from hoverproof.checker import check_file as check
    from hoverproof.errors import InputError as InputError
    from hoverproof.export.binding import Firmware as Firmware
    from hoverproof.firmware_flight import fly_firmware as fly_firmware
    from hoverproof.mission import Mission
    from hoverproof.mission import load as load
    from hoverproof.mission import presets as presets
    from hoverproof.paper.ledger import derive as derive
    from hoverproof.reporting.document import report as report
    from hoverproof.simulation.campaign import simulate_batch as simulate_batch
    from hoverproof.simulation.flight import simulate as simulate

_HOMES = {
    "Firmware": ("hoverproof.export.binding", "Firmware"),
    "InputError": ("hoverproof.errors", "InputError"),
    "Start": ("hoverproof.certification.attraction.starts", "Start"),
    "atlas": ("hoverproof.certification.atlas", "atlas"),
    "attraction": ("hoverproof.certification.attraction.proof", "attraction"),
    "certify": ("hoverproof.certification.gains", "certify"),
    "check": ("hoverproof.checker", "check_file"),
    "derive": ("hoverproof.paper.ledger", "derive"),
    "fly_firmware": ("hoverproof.firmware_flight", "fly_firmware"),
    "load": ("hoverproof.mission", "load"),
    "pareto": ("hoverproof.certification.tuning", "pareto"),
    "presets": ("hoverproof.mission", "presets"),
    "report": ("hoverproof.reporting.document", "report"),
    "simulate": ("hoverproof.simulation.flight", "simulate"),
    "simulate_batch": ("hoverproof.simulation.campaign", "simulate_batch"),
    "tune": ("hoverproof.certification.tuning", "tune"),
}

__all__ = [
    "Firmware",
    "InputError",
    "Start",
    "__version__",
    "atlas",
    "attraction",
    "certify",
    "check",
    "derive",
    "export_c",
    "fly_firmware",
    "load",
    "pareto",
    "presets",
    "report",
    "simulate",
    "simulate_batch",
    "tune",
]


def export_c(
    mission: Mission, out: str | Path, *, allow_uncertified: bool = False, **options: Any
) -> dict[str, Any]:
    """Certify a mission and write its control firmware, a C99 package, with the certificate.

    Parameters
    ----------
    mission : Mission
    out : str or Path
        Folder to write to; made if needed.
    allow_uncertified : bool
        Write a package even if the gains are not proved; every file of it then says so.
    **options
        precision, sensing, tunable, name, rotor_limits: see
        `hoverproof.export.package.write_package`.

    Returns
    -------
    dict
        The manifest.

    Raises
    ------
    hoverproof.export.package.NotCertified
        If the gains are refuted or undecided, and that is not allowed; nothing is written.
    InputError
        If an argument cannot be used or the folder cannot be written to.
    """
    from hoverproof.certification.gains import Proved, certify
    from hoverproof.export.contents import Standing
    from hoverproof.export.package import NotCertified, write_package

    verdict = certify(mission)
    proved = isinstance(verdict, Proved)
    if not proved and not allow_uncertified:
        raise NotCertified(mission.name, verdict.status)
    certificate = verdict.certificate.content if isinstance(verdict, Proved) else None
    return write_package(mission, out, Standing(verdict.problem.thrust, certificate), **options)


if not TYPE_CHECKING:  # a type checker is to find what does not exist

    def __getattr__(name: str) -> Any:
        """Import what a verb needs when it is first used."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module, attribute = _HOMES[name]
        return getattr(importlib.import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted(__all__)
