"""Round what a search found to the exact numbers and the hints of a certificate."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import binary_above, binary_below, decimal_above, decimal_below
from hoverproof.certification.attraction.draft import NotShown
from hoverproof.certification.exponential.candidate import Candidate, Tilted
from hoverproof.certification.exponential.domain import Domain
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.question import Question
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.rotors import thrusts
from hoverproof.certification.exponential.verdict import Settling
from hoverproof.certification.problem import wanted
from hoverproof.mission.frame import X
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal

BITS = 64
START_ROOM = 3e-3
DIGITS = 8
RATE_ROOM = 1e-4
"""Share of the rate that is given up, so that the inequality holds with rounded weights."""
CONE_ROOMS = 0.01, 0.05
"""By which shares the angle to the vertical under which points are seen is widened, in turn."""
WIDEST = math.pi / 2 - 1e-3
"""Of the angles to the axis that are claimed, rad."""
LITTLE = 1e-5
"""By what share the bound of J about the goal is above what is needed of it."""
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
        The multiplier of the ball of J, a bare number.
    multipliers : (k,)
        Of the terms.
    ball : (low, high)
        j - ϱ and j + ϱ, 1/m.
    offset, level, rate : Fraction
        d, ℓ, and r in 1/s.
    tilted : Tilted
        Of the rounded numbers.
    noise : dict
        σ by the name of the disturbance: what its square adds to the rate of Ψ, 1/s.
    hold : dict
        What the memory of each part of what is held weighs, s.
    limits : Limits
        Of the rounded numbers.
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
    noise: dict[str, Fraction]
    hold: dict[str, Fraction]

    @classmethod
    def of(cls, question: Question, found: Candidate) -> Rounded:
        """Round a candidate; its level is that of the starts, and d what follows from it.

        Parameters
        ----------
        question : Question
        found : Candidate
        """
        s = found.solution

        def short(x: float) -> Fraction:
            return decimal_below(float(x), DIGITS)

        weights = tuple(map(short, s.weights))
        level = decimal_above(s.start * (1 + START_ROOM), DIGITS)
        if level > s.level:
            raise NotShown("a start is not inside after rounding")
        reach = Reach.of(np.array(weights, float), float(level))
        limits = Limits(question.vehicles.before(found.ball), reach, found.ball[1])
        tilted = Tilted.of(limits)
        return cls(
            weights=weights,
            lag=None if s.lag is None else tuple(map(short, s.lag)),
            memory=None if s.memory is None else short(s.memory),
            slope=short(s.slope),
            multipliers=tuple(map(short, s.multipliers)),
            ball=(decimal_above(found.ball[0], 5), decimal_below(found.ball[1], 5)),
            offset=decimal_above(float(tilted.offset(weights, float(level))) * (1 + SPARE), DIGITS),
            level=level,
            rate=short(found.rate * (1 - RATE_ROOM)),
            limits=limits,
            tilted=tilted,
            noise={name: short(x) for name, x in s.noise.items()},
            hold={name: short(x) for name, x in s.hold.items()},
        )

    @property
    def floor(self) -> float:
        """ℓ∞: what disturbances leave of Ψ."""
        bounds = self.limits.disturbances()
        return sum(float(self.noise[name]) * x**2 for name, x in bounds) / float(self.rate)

    def cone(self, cosine: Fraction) -> Fraction | None:
        """Return the cosine of an angle to the vertical and the tilt together, rounded down.

        Parameters
        ----------
        cosine : Fraction
            Of the angle to the vertical, dimensionless.
        """
        angle = math.acos(cosine) + math.asin(self.limits.tilt)
        return decimal_below(math.cos(angle) - SPARE, DIGITS) if angle < WIDEST else None

    def settling(self, question: Question) -> Settling:
        """Return when the starts have settled for good, the time rounded up.

        Parameters
        ----------
        question : Question
        """
        stretch = self.tilted.stretch(self.weights)
        offset = float(settled_offset(question))
        level = max(offset - self.tilted.shift, 0.0) ** 2 / (2 * stretch) - self.floor
        if level <= 0:
            raise NotShown("disturbances leave more than the radius in which it has settled")
        time = math.log(max(float(self.level) / level, 1.0)) / float(self.rate)
        return Settling(question.radius, decimal_above(time * (1 + SPARE) + 1e-6, 4))


def settled_offset(question: Question) -> Fraction:
    """Return what |σ - σ*| is below only where a vehicle has settled, rounded down.

    Parameters
    ----------
    question : Question
    """
    return decimal_below(question.settled_offset, DIGITS)


def _seen(domain: Domain, r: Rounded) -> tuple[str | None, Fraction | None]:
    """Halve the wedge of a domain, and return the cosine of the angle under which all is seen."""
    angle, plain = domain.scene.cone(float(r.offset)), None
    for room in CONE_ROOMS:
        cosine = decimal_below(math.cos(angle * (1 + room)), DIGITS)
        if angle * (1 + room) + math.asin(r.limits.tilt) < WIDEST:
            tree = domain.tree(float(cosine))
            if tree is not None:
                return tree, cosine
            plain = plain or domain.tree()
            if plain is None:
                break
    return plain or domain.tree(), None


def _rotors(mission: Mission, ends: NDArray[np.float64]) -> list[Any]:
    """Round the ends of the thrust of each rotor, N: one interval for rotors of an X frame."""
    spare = SPARE * ends[:, 1].max()
    rounded = [
        [decimal_below(low - spare, 6), decimal_above(high + spare, 6)]
        for low, high in ends.tolist()
    ]
    if mission.vehicle.frame != X:
        return rounded
    return [min(low for low, _ in rounded), max(high for _, high in rounded)]


def _ultimate(r: Rounded, low: float) -> dict[str, Fraction]:
    """Return where the vehicle is in the end, low a lower bound of J about the goal, 1/m."""
    offset = decimal_above(float(r.tilted.offset(r.weights, r.floor)) * (1 + SPARE), DIGITS)
    return {"offset": offset, "radius": decimal_above(float(offset) / low * (1 + LITTLE), 4)}


def _near(question: Question, offset: Fraction) -> tuple[Fraction, Fraction]:
    """Return bounds of J about the goal with which |σ - σ*| is below an offset only near it."""
    low, high = question.scene.around(float(question.radius))
    least = decimal_above(float(offset / question.radius) * (1 + LITTLE), DIGITS)
    return least, decimal_above(low + high, DIGITS) - least


@dataclass(frozen=True)
class Parts:
    """What belongs to a certificate, exact.

    Attributes
    ----------
    content : dict
        Of the file, beside what all kinds have.
    rounded : Rounded
    domain : Domain
    """

    content: dict[str, Any]
    rounded: Rounded
    domain: Domain


def draft(mission: Mission, question: Question, found: Candidate) -> Parts:
    """Return the parts of a certificate of exponential convergence.

    Parameters
    ----------
    mission : Mission
    question : Question
    found : Candidate

    Raises
    ------
    NotShown
        If the checker would not be shown what it asks for.
    """
    r, hover = Rounded.of(question, found), hover_goal(mission)
    below, above = wanted(mission, hover)[2]
    goal = [binary_below(below, BITS), binary_above(above, BITS)]
    offset, settling = settled_offset(question), r.settling(question)
    bounds = float(r.ball[0]), float(r.ball[1])
    domain = Domain.of(question.scene, mission.target, float(r.offset), bounds)
    tree, cosine = _seen(domain, r)
    near = _near(question, offset)
    trees = {
        "domain": tree,
        "near": domain.near(float(question.radius), (float(near[0]), float(near[1]))),
    }
    for name, tree in trees.items():
        if tree is None:
            raise NotShown(f"the {name} takes more cells than are checked")
    rotors = _rotors(
        mission, thrusts(r.limits, np.array(r.weights, float), float(r.level), mission)
    )
    content: dict[str, Any] = {
        "weights": list(r.weights),
        "lag": None if r.lag is None else dict(zip(("torque", "thrust"), r.lag, strict=True)),
        "memory": r.memory,
        "hold": r.hold or None,
        "multipliers": {"slope": r.slope, "terms": list(r.multipliers), **r.noise},
        "domain": {
            "wedge": [list(side) for side in domain.wedge],
            "bounds": list(r.ball),
            "offset": r.offset,
            "cone": cosine,
            "tree": trees["domain"],
        },
        "enclosures": {"goal": goal},
        "hover": list(hover.position),
        "claim": {
            "level": r.level,
            "rate": r.rate,
            "start_level": r.level,
            "starts": [start.content() for start in question.starts],
            "settling": {
                "offset": offset,
                "radius": settling.radius,
                "time": settling.time,
            },
            "cone": None if cosine is None else r.cone(cosine),
            "rotors": rotors,
        },
        "near": {"bounds": list(near), "tree": trees["near"]},
    }
    if r.noise:
        content["claim"]["ultimate"] = _ultimate(r, float(near[0]))
    return Parts(content, r, domain)
