"""Round what a search found to the exact numbers and the hints of a certificate."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification.exponential.search import Candidate, Search, Tilted
from hoverproof.certification.exponential.vehicles import Limits, Reach

DIGITS = 8
SPARE = 1e-7
"""By what share numbers that are compared with exact ones are on the safe side."""


@dataclass(frozen=True)
class Rounded:
    """A candidate in short exact numbers.

    Attributes
    ----------
    weights : (3,)
        w2, w3, w4.
    lag : (2,) or None
        a5 and a6, s².
    memory : Fraction or None
        M.
    slope : Fraction
        The multiplier of the ball of J.
    multipliers : (k,)
        Of the terms.
    ball : (low, high)
        j - ϱ and j + ϱ, 1/m.
    offset, level, rate : Fraction
        d, ℓ, and r in 1/s.
    tilted : Tilted
        Of the rounded numbers.
    factor : float
        A.
    """

    weights: tuple[Fraction, ...]
    lag: tuple[Fraction, ...] | None
    memory: Fraction | None
    slope: Fraction
    multipliers: tuple[Fraction, ...]
    ball: tuple[Fraction, Fraction]
    offset: Fraction
    level: Fraction
    rate: Fraction
    limits: Limits
    tilted: Tilted

    @classmethod
    def of(cls, search: Search, found: Candidate) -> Rounded:
        """Round a candidate; its level is what the rounded weights and d give.

        Parameters
        ----------
        search : Search
        found : Candidate
        """
        s = found.solution

        def short(x: float) -> Fraction:
            return decimal_below(float(x), DIGITS)

        weights = tuple(map(short, s.weights))
        offset = short(found.offset)
        w2, w3, _ = map(float, weights)
        level = found.solution.level
        for _ in range(3):
            limits = Limits(
                search.vehicles, Reach.of(np.array(weights, float), level), found.ball[1]
            )
            tilted = Tilted.of(limits)
            factor = 1 + tilted.factor * (1 / w2 + 1 / w3)
            level = (float(offset) - tilted.shift) ** 2 / (2 * factor)
        return cls(
            weights=weights,
            lag=None if s.lag is None else tuple(map(short, s.lag)),
            memory=None if s.memory is None else short(s.memory),
            slope=short(s.slope),
            multipliers=tuple(map(short, s.multipliers)),
            ball=(decimal_above(found.ball[0], 5), decimal_below(found.ball[1], 5)),
            offset=offset,
            level=decimal_below(level * (1 - SPARE), DIGITS),
            rate=short(found.rate),
            limits=limits,
            tilted=tilted,
        )

    def offset_at(self, level: float) -> float:
        """Return what |σ - σ*| is at most where Ψ is at most a level.

        Parameters
        ----------
        level : float
        """
        w2, w3, _ = map(float, self.weights)
        factor = 1 + self.tilted.factor * (1 / w2 + 1 / w3)
        return float(np.sqrt(2 * level * factor) + self.tilted.shift)

    def settling_time(self, start_level: Fraction, offset: Fraction) -> Fraction:
        """Return when |σ - σ*| is at most an offset for good, s, rounded up.

        Parameters
        ----------
        start_level : Fraction
            Bound of Ψ at the start.
        offset : Fraction
        """
        w2, w3, _ = map(float, self.weights)
        factor = 1 + self.tilted.factor * (1 / w2 + 1 / w3)
        level = (float(offset) - self.tilted.shift) ** 2 / (2 * factor)
        time = math.log(max(float(start_level) / level, 1.0)) / float(self.rate)
        return decimal_above(time * (1 + SPARE) + 1e-6, 4)


@dataclass(frozen=True)
class Parts:
    """What belongs to a certificate, exact.

    Attributes
    ----------
    content : dict
        Of the file, beside what all kinds have.
    rounded : Rounded
    """

    content: dict[str, Any]
    rounded: Rounded


def draft(mission: Mission, search: Search, found: Candidate) -> Parts:
    """Return the parts of a certificate of exponential convergence.

    Parameters
    ----------
    mission : Mission
    search : Search
    found : Candidate

    Raises
    ------
    NotShown
        If the checker would not be shown what it asks for.
    """
    r = Rounded.of(search, found)
    low, high = feature_interval(mission)
    start_level = decimal_above(found.solution.start * (1 + START_ROOM), DIGITS)
    if start_level > r.level:
        raise NotShown("a start is not inside after rounding")
    radius, near = search.settled()
    offset = decimal_below(near, DIGITS)
    domain = search.domain(r.offset, r.ball)
    trees = {
        "near": domain.near(offset, radius),
        "starts": [domain.start(start) for start in search.starts],
    }
    content = {
        "weights": list(r.weights),
        "lag": None if r.lag is None else dict(zip(("torque", "thrust"), r.lag, strict=True)),
        "memory": r.memory,
        "multipliers": {"slope": r.slope, "terms": list(r.multipliers)},
        "domain": {
            "box": domain.box,
            "bounds": list(r.ball),
            "offset": r.offset,
            "cone": None,
            "tree": domain.tree(),
        },
        "enclosures": {"goal": [binary_below(low, BITS), binary_above(high, BITS)]},
        "hover": list(hover_goal(mission).position),
        "claim": {
            "level": r.level,
            "rate": r.rate,
            "start_level": start_level,
            "starts": [start.content() for start in search.starts],
            "settling": {
                "offset": offset,
                "radius": radius,
                "time": r.settling_time(start_level, offset),
            },
            "cone": None,
        },
        "trees": trees,
    }
    return Parts(content, r)
