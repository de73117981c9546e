"""What the question of attraction came to."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from hoverproof.algebra.decimals import at_least, at_most
from hoverproof.certification.attraction.starts import Start, State
from hoverproof.certification.verdict import Proved, Refuted, Undecided

NOT_COVERED = (
    "goals from which the centroid is not seen straight below",
    "sampling, delay and noise of measurements",
    "errors of the model: mass, inertia, wind, drag, rotors at their limits",
    "a camera that loses the target: every point is taken to be seen at all times",
)
"""What no theorem says, in words."""

OF_TOLERANT = (
    "goals from which the centroid is not seen straight below",
    "noise of measurements, gusts, and control in steps",
    "flexible frames, ground effect, drag, rotors at their limits",
    "a camera that loses the target: every point is taken to be seen at all times",
)
"""What no theorem about every vehicle within tolerance says, in words."""

GROUND = "the ground: without a barrier, a motion may pass below the target points"


def not_covered(verdict: AttractionVerdict) -> tuple[str, ...]:
    """Return what the theorem of a verdict does not say, in words.

    Parameters
    ----------
    verdict : Attraction, Sinks or Undecided
    """
    region = verdict.proved
    grounded = region is not None and region.barrier_height is None
    common = OF_TOLERANT if region is not None and region.tolerant else NOT_COVERED
    return (*common, *([GROUND] if grounded else []))


@dataclass(frozen=True)
class Reach:
    """How far hovers about the goal are certified: a disc at its height, up, and down.

    Attributes
    ----------
    sideways, up, down : Fraction
        m.
    """

    sideways: Fraction
    up: Fraction
    down: Fraction


@dataclass(frozen=True, kw_only=True, repr=False)
class Attraction(Proved):
    """A region of attraction.

    Attributes
    ----------
    mission, certificate
        See `Proved` of `hoverproof.certification.verdict`.
    level : Fraction
        ℓ, m: the set is {Λ <= ℓ}, above the barrier if there is one.
    weights : (3,) Fractions
        a2, a3, a4 of Λ = W + ½ Σ aᵢ|δᵢ|², m.
    rate : Fraction
        ε, dimensionless: Λ̇ <= -(k1/m) ε |Y|² in the set.
    tilt : Fraction
        Bound of the tilt in the set, rad.
    thrust : (low, high)
        Bounds of the thrust in the set, N.
    largest_eigenvalue : Fraction
        Bound of the eigenvalues of Q in the set, 1/m.
    barrier_height : Fraction or None
        No motion comes below this height above the mean of the target, m.
    reach : Reach
    starts : tuple of Start
        Other sets of states that are proved to be inside.
    """

    level: Fraction
    weights: tuple[Fraction, ...]
    rate: Fraction
    tilt: Fraction
    thrust: tuple[Fraction, Fraction]
    largest_eigenvalue: Fraction
    barrier_height: Fraction | None
    reach: Reach
    starts: tuple[Start, ...]

    @property
    def gist(self) -> str:
        """How far the hovers inside reach from the goal."""
        sides = ("sideways", "up", "down")
        return ", ".join(f"{at_least(getattr(self.reach, side))} m {side}" for side in sides)

    @property
    def tolerant(self) -> bool:
        """Whether it is about every vehicle within tolerance: of Ψ in place of Λ."""
        return bool(self.certificate.content["kind"] == "potential")

    @property
    def symbol(self) -> str:
        """What its Lyapunov function is called; of the vehicle as modelled, both are the same."""
        return "Ψ" if self.tolerant else "Λ"


@dataclass(frozen=True, kw_only=True, repr=False)
class Sinks(Refuted):
    """A start that was asked for sinks: from above the lowest target point to its height.

    What the motion does after that is not said.

    Attributes
    ----------
    mission, certificate
        See `Refuted` of `hoverproof.certification.verdict`.
    state : State
        Where the motion starts.
    time : Fraction
        At that time, s, it is as low as the lowest target point, or lower.
    """

    state: State
    time: Fraction

    @property
    def reason(self) -> str:
        """What happens."""
        return f"the vehicle sinks to the target within {at_most(self.time)} s"


AttractionVerdict = Attraction | Sinks | Undecided
