"""An audit: what broke first, and which tolerances would cover what was found."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from hoverproof.audit.camera import scale
from hoverproof.audit.claim import Claim, Poses, falls, in_view
from hoverproof.audit.finding import Finding
from hoverproof.audit.judge import judged
from hoverproof.audit.log import FlightLog
from hoverproof.mission.sections import Mission

ROOM = 0.05
"""What would cover is told with so much more, a share."""
MOST_SHARE = 0.99
"""A larger tolerance of thrust or torque covers no vehicle that answers at all."""


@dataclass(frozen=True, eq=False)
class Audit:
    """What is found of a flight.

    Attributes
    ----------
    log : FlightLog
    mission : Mission
    findings : list of Finding
    claim : Claim, optional
        None if nothing is proved of the mission.
    """

    log: FlightLog
    mission: Mission
    findings: list[Finding]
    claim: Claim | None

    @cached_property
    def broken(self) -> list[Finding]:
        """What did not hold, the first to break first; what follows from others comes last."""
        found = [f for f in self.findings if f.held is False]
        return sorted(
            found, key=lambda f: (f.follows, math.inf if f.at is None else f.at, _share(f))
        )

    @property
    def untold(self) -> list[Finding]:
        """What the log does not tell."""
        return [f for f in self.findings if f.held is None]

    @cached_property
    def _needed(self) -> dict[str, float]:
        """How large tolerances that cover what broke would be, by key, in their units."""
        needed: dict[str, float] = {}
        for f in self.broken:
            if f.key:
                sure = 0.0 if math.isnan(f.deviation) else 3 * f.deviation
                most = f.value if math.isnan(f.needed) else f.needed
                needed[f.key] = max(needed.get(f.key, 0.0), (most + sure) * (1 + ROOM))
        return needed

    @property
    def of_another_vehicle(self) -> bool:
        """Whether a share would be needed that is no tolerance."""
        return any(self._needed.get(key, 0) > MOST_SHARE for key in _SHARES)

    def covering(self) -> dict[str, str]:
        """Return the tolerances that would cover what broke, by key, as decimals."""
        if self.of_another_vehicle:
            return {}
        return {key: _upward(value) for key, value in self._needed.items()}


_SHARES = ("thrust", "torque")


def _share(f: Finding) -> float:
    """Return what sorts findings of one time: the one that is farthest above its bound first."""
    return -f.value / f.bound if f.bound > 0 else -math.inf


def _upward(value: float) -> str:
    """Write a number in two digits, rounded up."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return f"{math.ceil(value / unit - 1e-9) * unit:.6g}"


def flown_otherwise(numbers: Mapping[str, Any], mission: Mission) -> list[str]:
    """Say where what a log was flown with differs from a mission; tolerances and starts may.

    Parameters
    ----------
    numbers : mapping
        Exact numbers of the mission in the log.
    mission : Mission
    """
    ours = mission.exact()
    return [
        f"its {key} is not that of {mission.name}"
        for key in ("law", "vehicle", "target", "goal", "gains")
        if numbers.get(key) != ours.get(key)
    ]


def audit(log: FlightLog, mission: Mission, claim: Claim | None) -> Audit:
    """Hold a flight against the assumptions of theorem 5.

    Parameters
    ----------
    log : FlightLog
    mission : Mission
    claim : Claim, optional
        That of its certificate.
    """
    if log.mission is not None and (other := flown_otherwise(log.mission, mission)):
        log = replace(log, notes=(*log.notes, f"flown with another mission: {other[0]}"))
    poses = Poses(log, mission)
    findings: Sequence[Finding] = [
        *judged(log, mission),
        scale(poses),
        in_view(poses),
        falls(poses, claim),
    ]
    return Audit(log, mission, list(findings), claim)
