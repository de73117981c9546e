"""What the question of exponential convergence came to."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from hoverproof.algebra.decimals import at_most
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.region import Box
from hoverproof.certification.verdict import Proved
from hoverproof.plant.lens import cone_in_image

NOT_COVERED = (
    "goals from which the centroid is not seen straight below",
    "thrust commanded in steps, not by its rate",
    "flexible frames, ground effect, drag, rotors at their limits",
    "a camera that loses the target: every point is taken to be seen at all times",
)
"""What no theorem about vehicles within tolerance says, in words."""

HIDDEN = "target points that are hidden, or were out of view before the start"
"""What is left of the last of them where all points are proved to be in view."""


@dataclass(frozen=True)
class Settling:
    """When the vehicle is near its goal for good.

    Attributes
    ----------
    radius : Fraction
        About the hover point, m.
    time : Fraction
        s, from switching on.
    """

    radius: Fraction
    time: Fraction


@dataclass(frozen=True, kw_only=True, repr=False)
class Exponential(Proved):
    """From all starts every vehicle within tolerance converges, Ψ(t) <= Ψ(0) exp(-r t).

    Attributes
    ----------
    mission, certificate
        See `Proved` of `hoverproof.certification.verdict`.
    level : Fraction
        ℓ: the set is {Ψ <= ℓ}, dimensionless.
    start_level : Fraction
        Bound of Ψ at the starts, dimensionless.
    weights : (3,) Fractions
        w2, w3, w4 of Ψ; w1 = 1.
    rate : Fraction
        r, 1/s.
    settling : Settling
    wedge : (3, 2)
        No motion leaves it: ends of x, y and u; see `domain`.
    slope : (low, high)
        Bounds of J, or Q, on the way: j - ϱ and j + ϱ, 1/m.
    offset : Fraction
        |σ - σ*| on the way is at most that, dimensionless.
    tilt : Fraction
        Bound of the tilt on the way, rad.
    thrust : (low, high)
        Bounds of the thrust over the true mass, times m, on the way, N.
    field_of_view : Fraction or None
        Every target point is seen within that angle of the optical axis on the way, rad; not said
        where it is not shown to be below a right angle.
    ultimate_radius : Fraction or None
        In the end the vehicle is within that of the hover point, m; without noise it comes to it.
    rotor_thrusts : tuple of (low, high)
        Bounds of what each rotor makes, and is set to make, on the way, N; see `rotors`.
    starts : tuple of Start
    """

    level: Fraction
    start_level: Fraction
    weights: tuple[Fraction, ...]
    rate: Fraction
    settling: Settling
    wedge: Box
    slope: tuple[Fraction, Fraction]
    offset: Fraction
    tilt: Fraction
    thrust: tuple[Fraction, Fraction]
    field_of_view: Fraction | None
    ultimate_radius: Fraction | None
    rotor_thrusts: tuple[tuple[Fraction, Fraction], ...]
    starts: tuple[Start, ...]

    @property
    def rotor_thrust(self) -> tuple[Fraction, Fraction]:
        """Bounds of the thrust of every rotor on the way, N."""
        return min(low for low, _ in self.rotor_thrusts), max(h for _, h in self.rotor_thrusts)

    @property
    def heights(self) -> tuple[Fraction, Fraction]:
        """Between which heights above the mean of the target it stays, m."""
        low, high = self.wedge[2]
        return 1 / high, 1 / low

    @property
    def image_cone(self) -> float | None:
        """Half angle of the largest cone about the optical axis in the image, rad, if told."""
        return cone_in_image(self.mission)

    @property
    def gist(self) -> str:
        """How soon it is how near."""
        radius, time = at_most(self.settling.radius), at_most(self.settling.time)
        return f"within {radius} m of the goal from {time} s on"
