"""From a camera, a target and a hovering vehicle to gains with a proof, a flight and C code.

>>> import hoverproof as hp
>>> verdict = hp.certify(hp.load("x4-flyer"))
>>> verdict.status
'proved'
"""

from __future__ import annotations

import importlib
import sys
from typing import TYPE_CHECKING, Any

from hoverproof.version import __version__

if TYPE_CHECKING:
    from hoverproof.certification.attraction.starts import Start as Start
    from hoverproof.certification.attraction.verdict import Attraction as Attraction
    from hoverproof.certification.convergence import attraction as attraction
    from hoverproof.certification.exponential.verdict import Exponential as Exponential
    from hoverproof.certification.gains import certify as certify
    from hoverproof.certification.over_box import certify_region as region
    from hoverproof.certification.reading import check as check
    from hoverproof.design.atlas import atlas as atlas
    from hoverproof.design.tuning import pareto as pareto
    from hoverproof.design.tuning import tune as tune
    from hoverproof.errors import InputError as InputError
    from hoverproof.export.binding import Firmware as Firmware
    from hoverproof.firmware.exporting import export_c as export_c
    from hoverproof.firmware.flying import fly_firmware as fly_firmware
    from hoverproof.mission.presets import presets as presets
    from hoverproof.mission.reading import load as load
    from hoverproof.mission.reading import replace as replace
    from hoverproof.paper.ledger import derive as derive
    from hoverproof.reporting.document import report as report
    from hoverproof.servo.law import Law as Law
    from hoverproof.servo.laws.hamel_mahony import LAWS as LAWS
    from hoverproof.show.drawing import plot as plot
    from hoverproof.simulation.flight import simulate as simulate
    from hoverproof.simulation.runs import simulate_batch as simulate_batch

_HOMES = {
    "Attraction": ("hoverproof.certification.attraction.verdict", "Attraction"),
    "Exponential": ("hoverproof.certification.exponential.verdict", "Exponential"),
    "Firmware": ("hoverproof.export.binding", "Firmware"),
    "InputError": ("hoverproof.errors", "InputError"),
    "LAWS": ("hoverproof.servo.laws.hamel_mahony", "LAWS"),
    "Law": ("hoverproof.servo.law", "Law"),
    "Start": ("hoverproof.certification.attraction.starts", "Start"),
    "atlas": ("hoverproof.design.atlas", "atlas"),
    "attraction": ("hoverproof.certification.convergence", "attraction"),
    "certify": ("hoverproof.certification.gains", "certify"),
    "check": ("hoverproof.certification.reading", "check"),
    "derive": ("hoverproof.paper.ledger", "derive"),
    "export_c": ("hoverproof.firmware.exporting", "export_c"),
    "fly_firmware": ("hoverproof.firmware.flying", "fly_firmware"),
    "load": ("hoverproof.mission.reading", "load"),
    "pareto": ("hoverproof.design.tuning", "pareto"),
    "region": ("hoverproof.certification.over_box", "certify_region"),
    "plot": ("hoverproof.show.drawing", "plot"),
    "presets": ("hoverproof.mission.presets", "presets"),
    "replace": ("hoverproof.mission.reading", "replace"),
    "report": ("hoverproof.reporting.document", "report"),
    "simulate": ("hoverproof.simulation.flight", "simulate"),
    "simulate_batch": ("hoverproof.simulation.runs", "simulate_batch"),
    "tune": ("hoverproof.design.tuning", "tune"),
}

__all__ = [
    "LAWS",
    "Attraction",
    "Exponential",
    "Firmware",
    "InputError",
    "Law",
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
    "plot",
    "presets",
    "region",
    "replace",
    "report",
    "simulate",
    "simulate_batch",
    "tune",
]


if not TYPE_CHECKING:  # a type checker is to find what does not exist

    def __getattr__(name: str) -> Any:
        """Import what a verb needs when it is first used."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module, attribute = _HOMES[name]
        return getattr(importlib.import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted(__all__)


_SHOWN = {
    "hoverproof.certification.attraction.verdict": ("Attraction", "Sinks"),
    "hoverproof.certification.exponential.verdict": ("Exponential",),
    "hoverproof.certification.gains": ("ProvedGains", "RefutedGains", "UndecidedGains"),
    "hoverproof.certification.over_box": ("ProvedBounds", "RefutedBounds", "UndecidedBounds"),
    "hoverproof.certification.verdict": ("Undecided",),
    "hoverproof.mission.sections": ("Mission",),
}


def _show_in(shell: Any) -> None:
    """Tell a notebook how to display missions and verdicts, with nothing imported before."""

    def html(thing: Any) -> str:
        return str(importlib.import_module("hoverproof.show.drawing").html(thing))

    display = shell.display_formatter.formatters["text/html"]
    for module, names in _SHOWN.items():
        for name in names:
            display.for_type_by_name(module, name, html)


if "IPython" in sys.modules and (_shell := sys.modules["IPython"].get_ipython()) is not None:
    _show_in(_shell)
