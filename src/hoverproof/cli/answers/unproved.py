"""What `attraction` answers besides where every vehicle within tolerance is not proved."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hoverproof.certification.exponential.form import Vertex
from hoverproof.certification.exponential.refusal import Corner, Refusal
from hoverproof.cli.answers.words import about
from hoverproof.design.unproved import Unproved

NO_REFUSAL = (
    "no states were found that refuse all weights of theorem 5, so others may prove it; noise, "
    "gusts, steps and a low-pass are left out where such states are looked for"
)


def lines(found: Unproved, path: Path | None) -> Iterator[str]:
    """Yield the lines for people.

    Parameters
    ----------
    found : Unproved
    path : Path or None
        Where the states are that refuse all weights.
    """
    if found.refusal is not None:
        yield from _filled(found.refusal.words)
        for corner in found.refusal.corners:
            yield from _filled(f"vehicle: {vehicle(found.refusal, corner)}", "    ")
        yield f"    in exact numbers    {path}"
    else:
        yield from _filled(NO_REFUSAL)
    if found.flown is not None:
        flown = found.flown
        yield from _filled(
            f"a simulation, no proof: of {flown.count} vehicles at corners of the tolerances the "
            f"one that does worst {flown.outcome}; switched on with the thrust that the modelled "
            f"one hovers with, it has {', '.join(flown.vehicle.words)}"
        )


def _filled(words: str, indent: str = "  ") -> list[str]:
    return textwrap.wrap(words, 80, initial_indent=indent, subsequent_indent=f"{indent}  ")


def vehicle(refusal: Refusal, corner: Corner) -> str:
    """Say what vehicle a corner is.

    Parameters
    ----------
    refusal : Refusal
    corner : Corner
    """
    at = dict(zip(Vertex.sizes(), map(float, corner.vertex), strict=True))
    lag = f", rotor lag {about(at['lag'])} s" if refusal.asked.lagged else ""
    late = f", latency {about(refusal.asked.latency)} s" if refusal.asked.latency else ""
    return (
        f"thrust changes by {about(at['thrust_gain'])} times the command{late}{lag}, "
        f"lever ratio χ = {about(at['lever_ratio'])}, swing π = {about(at['swing'])} 1/s"
    )


def as_json(found: Unproved, path: Path | None) -> dict[str, Any]:
    """Return the object for machines.

    Parameters
    ----------
    found : Unproved
    path : Path or None
        See `lines`.
    """
    refusal, flown = found.refusal, found.flown
    return {
        "refusal": refusal
        and {
            "file": str(path),
            "shows": refusal.words,
            "vehicles": [vehicle(refusal, corner) for corner in refusal.corners],
            "states": sum(len(corner.states) for corner in refusal.corners),
            "left_out": list(refusal.left_out),
        },
        "flight": flown
        and {
            "proof": False,
            "vehicles": flown.count,
            "worst": list(flown.vehicle.words),
            "outcome": flown.outcome,
            "settled_at": flown.settled,
            "duration": flown.duration,
            "distance": flown.distance,
            "units": {"settled_at": "s", "duration": "s", "distance": "m from the goal at the end"},
        },
    }
