"""How large a tolerance may be with which starts are still proved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from hoverproof.certification.attraction import proof as potential
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.convergence import Converges, attraction
from hoverproof.certification.exponential import proof as exponential
from hoverproof.certification.exponential.question import ROOM, Array
from hoverproof.errors import InputError
from hoverproof.mission.reading import with_tolerance
from hoverproof.mission.sections import Mission
from hoverproof.mission.tolerances import Tolerance

Progress = Callable[[str], None]

LOWEST, FIRST, HIGHEST = -360, -90, 270
"""Places of 1e-4, 0.1 and 1e3, see `two_digits`."""
DOUBLED = 27
"""About so many places are from a number to its double."""
MOST_PROOFS = 5


def two_digits(place: int) -> Fraction:
    """Return the numbers of two digits in their order: 1 at 0, 1.1 at 1, and 10 at 90.

    Parameters
    ----------
    place : int
        How many numbers of two digits it is from 1.
    """
    decade, digits = divmod(place, 90)
    return Fraction(10 + digits, 10) * Fraction(10) ** decade


@dataclass(frozen=True)
class Largest:
    """The largest tolerance, of two digits, with which starts are proved.

    Attributes
    ----------
    name : str
        Of the tolerance.
    value : Fraction
        In its unit, s, m/s², m/s, N, rad/s, rad or a share; see `hoverproof.mission.tolerances`.
    verdict : Attraction, Exponential, Sinks or Undecided
        About the mission with that value; not proved only if it is zero.
    fills : tuple of (value, fill)
        What was tried, ascending, and the Lyapunov function at the starts over the highest level
        found, a number in floating point; infinite where nothing was found.
    """

    name: Tolerance
    value: Fraction
    verdict: Converges
    fills: tuple[tuple[Fraction, float], ...]

    @property
    def beyond(self) -> Fraction | None:
        """The least value tried with which the search found nothing; None if there was none."""
        return next((value for value, fill in self.fills if fill > 1 and value > self.value), None)


def largest(
    mission: Mission,
    name: Tolerance,
    *,
    starts: Sequence[Start] | None = None,
    progress: Progress | None = None,
) -> Largest:
    """Find the largest tolerance with which starts are proved, all else as in the mission.

    It is found by bisection of a search in floating point, and proved; a larger one may be true.

    Parameters
    ----------
    mission : Mission
        What it says of that tolerance is not looked at.
    name : str
        Of a number of `[uncertainty]`.
    starts : sequence of Start, optional
        Sets of states to be inside; by default the start of the mission.
    progress : callable, optional
        Is told what is being done.

    Raises
    ------
    InputError
        If the goal is not axial, or the mission poses no question.
    """
    tell = progress or (lambda text: None)
    wanted = list(starts or [Start.of(mission)])
    asked = _Trials(mission, name, wanted, tell)
    with_tolerance(mission, name, two_digits(LOWEST))  # which the law may not allow at all
    place = asked.highest()
    places = [] if place is None else [place + 1 - 2**back for back in range(MOST_PROOFS)]
    for value in map(two_digits, places):
        tell(f"{name} = {float(value):g}")
        changed = with_tolerance(mission, name, value)
        verdict = attraction(changed, starts=starts, progress=progress)
        if verdict.proved:
            return Largest(name, value, verdict, asked.fills)
    zero = attraction(with_tolerance(mission, name, Fraction(0)), starts=starts, progress=progress)
    return Largest(name, Fraction(0), zero, asked.fills)


@dataclass
class _Trials:
    """A search at one value after the other, each begun where the last one succeeded."""

    mission: Mission
    name: Tolerance
    starts: list[Start]
    tell: Progress
    near: Array | None = None
    tried: dict[Fraction, float] = field(default_factory=dict)

    @property
    def fills(self) -> tuple[tuple[Fraction, float], ...]:
        return tuple(sorted(self.tried.items()))

    def highest(self) -> int | None:
        """Return the place of the largest number of two digits that fits; None if none does."""
        if self.fill(Fraction(0)) > 1:
            return None
        low, high = FIRST, FIRST + DOUBLED
        while low > LOWEST and not self.fits(low):
            low, high = low - DOUBLED, low
        if not self.fits(low):
            return None
        while high <= HIGHEST and self.fits(high):
            low, high = high, high + DOUBLED
        while high - low > 1:
            middle = (low + high) // 2
            if self.fits(middle):
                low = middle
            else:
                high = middle
        return low

    def fits(self, place: int) -> bool:
        """Tell whether the starts are inside with the number at a place."""
        return self.fill(two_digits(place)) <= 1

    def fill(self, value: Fraction) -> float:
        """Return how full the highest level found is with a value."""
        if value not in self.tried:
            self.tell(f"searching with {self.name} = {float(value):g}")
            self.tried[value] = self._fill(value)
        return self.tried[value]

    def _fill(self, value: Fraction) -> float:
        try:
            mission = with_tolerance(self.mission, self.name, value)
        except InputError:
            return float("inf")  # beyond what a mission may have
        fill = float("inf")
        if mission.law.feature == "centroid":
            fill = min(_of_potential(mission, self.starts, b) for b in (True, False))
        if fill > 1:
            found = exponential.candidate(mission, self.starts, self.near)
            if found is not None and found.solution.fill <= 1 - ROOM:
                self.near = found.x
            if found is not None:
                fill = min(fill, found.solution.fill / (1 - ROOM))
        return float(fill)


def _of_potential(mission: Mission, starts: Sequence[Start], barrier: bool) -> float:
    if potential.why_not_covered(mission) or (barrier and potential.why_no_barrier(mission)):
        return float("inf")
    try:
        return potential.estimate(mission, objective="start", starts=starts, barrier=barrier).fill
    except (ValueError, ArithmeticError, np.linalg.LinAlgError):
        return float("inf")
