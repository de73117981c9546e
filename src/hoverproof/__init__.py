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
    from hoverproof.certification.attraction.proof import attraction as attraction
    from hoverproof.certification.gains import certify as certify
    from hoverproof.checker import check_file as check
    from hoverproof.errors import InputError as InputError
    from hoverproof.mission import load as load
    from hoverproof.mission import presets as presets
    from hoverproof.paper.ledger import derive as derive
    from hoverproof.simulation.flight import simulate as simulate

_HOMES = {
    "InputError": ("hoverproof.errors", "InputError"),
    "attraction": ("hoverproof.certification.attraction.proof", "attraction"),
    "certify": ("hoverproof.certification.gains", "certify"),
    "check": ("hoverproof.checker", "check_file"),
    "derive": ("hoverproof.paper.ledger", "derive"),
    "load": ("hoverproof.mission", "load"),
    "presets": ("hoverproof.mission", "presets"),
    "simulate": ("hoverproof.simulation.flight", "simulate"),
}

__all__ = [
    "InputError",
    "__version__",
    "attraction",
    "certify",
    "check",
    "derive",
    "load",
    "presets",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Import what a verb needs when it is first used."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, attribute = _HOMES[name]
    return getattr(importlib.import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted(__all__)
