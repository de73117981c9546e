"""What a search for gains comes to: gains that are proved, or what stands in the way."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.exponential.verdict import Exponential, Settling
from hoverproof.certification.gains import ProvedGains
from hoverproof.design.gain_search import Objective
from hoverproof.design.limits import Use, bandwidth
from hoverproof.mission.sections import Mission
from hoverproof.mission.writing import decimal
from hoverproof.servo.hover_error import HoverError, hover_error, rests_as_modelled
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.variables import Design

UNITS = Design.gains()
"""Of the gains, by their names."""


class _OfMission:
    """What follows from the gains of a mission, and a line that shows them with what is proved."""

    mission: Mission
    status: ClassVar[str]

    @property
    def gist(self) -> str:
        """What is proved, in a few words."""
        raise NotImplementedError

    def __repr__(self) -> str:
        gains = self.mission.gains
        words = ", ".join(f"{k} = {decimal(getattr(gains, k))} {u}" for k, u in UNITS.items())
        return f"<{type(self).__name__}, {self.mission.name}: {self.status}: {words}; {self.gist}>"

    @property
    def bandwidth(self) -> float:
        """Attitude bandwidth, rad/s."""
        return bandwidth(self.mission)

    @property
    def hover_error(self) -> HoverError | None:
        """What an error of thrust or mass does to the hover; None where its law does not say."""
        known = rests_as_modelled(law_of(self.mission))
        return hover_error(self.mission) if known else None


@dataclass(frozen=True, repr=False)
class Tuned(_OfMission):
    """Gains that are proved, and what was traded for them.

    Attributes
    ----------
    mission : Mission
        The mission with the new gains.
    verdict : ProvedGains
        What `certify` says of just these gains.
    before : Fraction or None
        Decay rate of L that is proved for the gains the mission had, 1/s; with the same weights, or
        with those that suit them best if weights were searched.
    estimate : float
        Decay rate before rounding to short decimals, in floating point, 1/s.
    slowest_rate : float
        Decay rate of the slowest motion of the loop linearised at the goal, 1/s.
    uses : list of Use
        How much of each limit the gains use.
    objective : str
        What was made as large as possible.
    """

    status: ClassVar[str] = "tuned"
    mission: Mission
    verdict: ProvedGains
    before: Fraction | None
    estimate: float
    slowest_rate: float
    uses: list[Use]
    objective: Objective

    @property
    def gist(self) -> str:
        """Decay rate, proved."""
        return self.verdict.gist


@dataclass(frozen=True, repr=False)
class RegionTuned(_OfMission):
    """Gains whose region of attraction is proved, and what was traded for it.

    Attributes
    ----------
    mission : Mission
        The mission with the new gains.
    region : Attraction
        What `attraction` proves of just these gains, without a barrier.
    before : Attraction or None
        The same of the gains that the mission had.
    slowest_rate, slowest_rate_before : float
        Decay rate of the slowest motion of the loop linearised at the goal, 1/s.
    decay_rate, decay_rate_before : Fraction or None
        Decay rate of L that `certify` proves, 1/s; None if it proves none.
    uses : list of Use
        How much of each limit, and of the wished decay, the gains use.
    """

    status: ClassVar[str] = "tuned"
    objective: ClassVar[str] = "region"
    mission: Mission
    region: Attraction
    before: Attraction | None
    slowest_rate: float
    slowest_rate_before: float
    decay_rate: Fraction | None
    decay_rate_before: Fraction | None
    uses: list[Use]

    @property
    def gist(self) -> str:
        """How far hovers are proved."""
        return self.region.gist


@dataclass(frozen=True, repr=False)
class StartTuned(_OfMission):
    """Gains with which every vehicle within tolerance has soon settled, from the mission's start.

    Attributes
    ----------
    mission : Mission
        The mission with the new gains.
    verdict : Exponential
        What is proved of just these gains.
    before : Settling or None
        When the start has settled with the gains that the mission had, as the search of
        `attraction` finds it, without the proof; None if it finds none.
    estimate : float
        Settling time before rounding to short decimals, s, in floating point.
    flown, flown_before : float or None
        When the mission has settled as near in a flight, s, with the new gains and with those that
        it had; None if not within `flown_for`.
    flown_for : float
        How long they were flown, s.
    why_longer : str or None
        Where the proof takes much longer than the flight, why.
    uses : list of Use
        How much of each limit the gains use.
    """

    status: ClassVar[str] = "tuned"
    objective: ClassVar[str] = "start"
    mission: Mission
    verdict: Exponential
    before: Settling | None
    estimate: float
    flown: float | None
    flown_before: float | None
    flown_for: float
    why_longer: str | None
    uses: list[Use]

    @property
    def gist(self) -> str:
        """How soon it is how near, proved."""
        return self.verdict.gist


@dataclass(frozen=True)
class Advice:
    """A change of a mission with which gains are proved.

    Attributes
    ----------
    words : str
    settings : tuple of str
        The same as values of ``--set``.
    time : Fraction
        Settling time that is proved with it, s.
    """

    words: str
    settings: tuple[str, ...]
    time: Fraction


@dataclass(frozen=True, repr=False)
class Infeasible:
    """No gains meet the wish within the limits: what was found, and what binds.

    Attributes
    ----------
    mission : Mission
    reason : str
        What binds, and by how much.
    best : Tuned or None
        The best that can be done within the limits.
    needed_bandwidth : float or None
        The bandwidth that would do, estimated in floating point, rad/s.
    advice : tuple of Advice
        What would help, each alone, and was proved to.
    """

    status: ClassVar[str] = "infeasible"
    mission: Mission
    reason: str
    best: Tuned | None = None
    needed_bandwidth: float | None = None
    advice: tuple[Advice, ...] = ()

    def __repr__(self) -> str:
        words = "; ".join([self.reason, *(f"would help: {a.words}" for a in self.advice)])
        return f"<{type(self).__name__}, {self.mission.name}: {self.status}: {words}>"
