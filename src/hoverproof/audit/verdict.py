"""An audit: what broke first, and which tolerances would cover what was found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from hoverproof.audit.claim import Claim, Poses, falls, in_view
from hoverproof.audit.finding import Finding
from hoverproof.audit.judge import judged
from hoverproof.audit.log import FlightLog
from hoverproof.mission.sections import Mission

ROOM = 0.05
"""What would cover is told with so much more, a share."""
MOST_SHARE = 0.99


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

    def covering(self) -> dict[str, str]:
        """Return the tolerances that would cover what broke, by key, as decimals."""
        needed: dict[str, float] = {}
        for f in self.broken:
            if f.key:
                sure = 0.0 if math.isnan(f.deviation) else 3 * f.deviation
                needed[f.key] = max(needed.get(f.key, 0.0), (f.value + sure) * (1 + ROOM))
        shares = {key: min(v, MOST_SHARE) for key, v in needed.items() if key in _SHARES}
        return {key: _upward(value) for key, value in (needed | shares).items()}


_SHARES = ("thrust", "torque")


def _share(f: Finding) -> float:
    """Return what sorts findings of one time: the one that is farthest above its bound first."""
    return -f.value / f.bound if f.bound > 0 else -math.inf


def _upward(value: float) -> str:
    """Write a number in two digits, rounded up."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return f"{math.ceil(value / unit - 1e-9) * unit:.6g}"


def audit(log: FlightLog, mission: Mission, claim: Claim | None) -> Audit:
    """Hold a flight against the assumptions of theorem 5.

    Parameters
    ----------
    log : FlightLog
    mission : Mission
    claim : Claim, optional
        That of its certificate.
    """
    poses = Poses(log, mission)
    findings: Sequence[Finding] = [*judged(log, mission), in_view(poses), falls(poses, claim)]
    return Audit(log, mission, list(findings), claim)
