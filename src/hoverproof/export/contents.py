"""What the files of a firmware package are filled with: the templates name these values."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from hoverproof.algebra.decimals import decimal_above, decimal_below, degrees_at_most
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.errors import InputError
from hoverproof.export.adapter import Adapter, adapter
from hoverproof.export.camera import CameraText, camera_text
from hoverproof.export.flight_law import FlightLaw
from hoverproof.export.law_text import LawText, VehicleText, law_text, vehicle_text
from hoverproof.export.lens import LensText, lens_text
from hoverproof.export.options import Options
from hoverproof.export.precision import FLOAT32
from hoverproof.export.standing import Evidence, Standing, evidence
from hoverproof.export.vectors import InputBox, Vector, test_vectors
from hoverproof.mission.frame import Place, shares
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.servo.hover_error import hover_error, rests_as_modelled
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.version import __version__


@dataclass(frozen=True)
class Origin:
    """Where a package comes from.

    Attributes
    ----------
    text : str
        In a sentence or two, with a warning if nothing is proved.
    banner : str
        The comment that begins each file of C.
    size : int
        Number of characters of the text in the C, with the one that ends it.
    """

    text: str
    banner: str
    size: int


@dataclass(frozen=True)
class Design:
    """What the law is made of.

    Attributes
    ----------
    weight : Fraction
        m g, N.
    gains : tuple of Fraction
        Numbers in the order and the units of the law.
    gains_text : str
        Their names with their units.
    goal_centroid : sequence of Fraction
        q*, (3,), dimensionless.
    rotors : tuple of (str, (2,))
        Names of the rotors and where they are, (x, y) in arms, in their order.
    hover : tuple of Fraction
        What each gives in hover, N.
    throttle_per_newton : Fraction
        The throttle, 0 to 1, over the thrust of all rotors that give their highest at 1, 1/N.
    allocation : tuple of (4,) Fractions
        What share of T, Γ1, Γ2 and Γ3 each takes over, 1, 1/m, 1/m and 1/m.
    """

    weight: Fraction
    gains: tuple[Fraction, ...]
    gains_text: str
    goal_centroid: Sequence[Fraction]
    rotors: tuple[tuple[str, Place], ...]
    hover: tuple[Fraction, ...]
    throttle_per_newton: Fraction
    allocation: tuple[tuple[Fraction, ...], ...]


@dataclass(frozen=True)
class Limits:
    """What the firmware watches while it flies.

    Attributes
    ----------
    thrust, commanded : (low, high)
        Interval of T that is certified or assumed, and of what commands it: for every vehicle
        within the tolerance of the thrust, N.
    singular : Fraction
        T - m g at which the law is singular, N.
    floor : Fraction
        The lowest T - m g at which the law is computed: half-way between singular and lowest, N.
    tilt_cosine : Fraction
        Lowest cosine of the tilt, dimensionless.
    tilt_words : str
        That tilt, and where it comes from.
    box : InputBox
        What is accepted as input.
    centroid_square, feature_square : Fraction
        The largest square of the centroid, and of the feature, that is accepted, dimensionless.
    """

    thrust: tuple[Fraction, Fraction]
    commanded: tuple[Fraction, Fraction]
    singular: Fraction
    floor: Fraction
    tilt_cosine: Fraction
    tilt_words: str
    box: InputBox
    centroid_square: Fraction
    feature_square: Fraction


@dataclass(frozen=True)
class Contents:
    """All that the templates name.

    Attributes
    ----------
    name, NAME : str
        Prefix of files and symbols, and the same in capitals.
    real : str
        The type of numbers in C.
    mission : Mission
    options : Options
    evidence : Evidence
    origin : Origin
    design : Design
    limits : Limits
    law : LawText
    vehicle : VehicleText
    camera : CameraText or None
        If frames are kept between steps.
    lens : LensText or None
        If the mission has one, and points are taken in.
    adapter : Adapter
    hover_error : list of (str, str)
        What errors of thrust and mass do to the hover; empty where that is not known of the law.
    vectors : list of Vector
        Of the self-test.
    """

    name: str
    NAME: str
    real: str
    mission: Mission
    options: Options
    evidence: Evidence
    origin: Origin
    design: Design
    limits: Limits
    law: LawText
    vehicle: VehicleText
    camera: CameraText | None
    lens: LensText | None
    adapter: Adapter
    hover_error: Sequence[tuple[str, str]]
    vectors: Sequence[Vector]

    @property
    def rate_bandwidth(self) -> str:
        """Of the rate loop that is commanded, rad/s, an exact number; empty without."""
        return str(self.mission.interface.rate_bandwidth) if self.options.rates else ""

    @property
    def points(self) -> int:
        """Number of target points."""
        return len(self.mission.target.points)

    @property
    def centroid_words(self) -> str:
        """What the image centroid is."""
        by_weight = "" if self.mission.target.weights is None else ", each times its weight"
        return f"sum of the unit vectors toward the {self.points} target points{by_weight}"

    @property
    def in_order(self) -> bool:
        """Whether image points are to be in the order of the target."""
        return self.law.from_image or self.mission.target.weights is not None

    @property
    def keeps_rotor_limits(self) -> bool:
        """Whether every rotor is proved to be set to a thrust within its limits."""
        proved, limits = self.evidence.rotor_thrusts, self.options.each_rotor
        several = proved * (len(limits) if len(proved) == 1 else 1)
        return bool(several) and all(
            low <= least and most <= high
            for (low, high), (least, most) in zip(limits, several, strict=True)
        )

    @property
    def tells_gains(self) -> bool:
        """Whether a step may have to say that nothing is proved of its gains."""
        return self.options.tunable or not self.evidence.certified


def contents(
    mission: Mission, standing: Standing, law: FlightLaw, name: str, options: Options
) -> Contents:
    """Return what the templates are filled with.

    Parameters
    ----------
    mission : Mission
    standing : Standing
    law : FlightLaw
        Of the mission, for the options.
    name : str
        Prefix of files and symbols.
    options : Options
    """
    camera = camera_text(mission, law, options)
    sized = law.spread is not None or (camera is not None and bool(camera.spread))
    spread = _spread(mission, options) if sized else None
    proved, limits = evidence(standing, mission), _limits(mission, standing, law, spread)
    text, design = law_text(mission, options, law), _design(mission, options, law.source)
    return Contents(
        name=name,
        NAME=name.upper(),
        real=options.precision.c_type,
        mission=mission,
        options=options,
        evidence=proved,
        origin=_origin(mission, proved, text, law.source),
        design=design,
        limits=limits,
        law=text,
        vehicle=vehicle_text(mission, options, law.source),
        camera=camera,
        adapter=adapter(mission, options, design.gains, law.source.design.gains()),
        lens=lens_text(mission, options),
        hover_error=hover_error(mission, law.source).rows()
        if rests_as_modelled(law.source)
        else [],
        vectors=test_vectors(
            mission,
            law,
            options,
            standing.thrust,
            tilt_cosine=limits.tilt_cosine,
            certified=proved.certified,
        ),
    )


def _origin(mission: Mission, proved: Evidence, text: LawText, law: Law) -> Origin:
    flies = "" if law.name == HAMEL_MAHONY.name else f", law {law.name}"
    made = f"Made by hoverproof {__version__} from the mission {mission.name}{flies}. Do not edit."
    in_c = f"mission {mission.name}; certificate SHA-256 {proved.sha256}; law SHA-256 {text.sha256}"
    return Origin(
        text=made if proved.certified else f"{made} UNCERTIFIED.",
        banner=f"/* {made}\n * {proved.claim} */",
        size=len(in_c) + 1,
    )


def _design(mission: Mission, options: Options, law: Law) -> Design:
    v, frame = mission.vehicle, mission.vehicle.frame
    units, numbers = law.design.gains(), law.design.numbers(mission)
    words = ", ".join(f"{gain} {unit}" for gain, unit in units.items())
    lengths = Fraction(1), v.reach, v.reach, v.drag_ratio
    return Design(
        weight=mission.vehicle.weight,
        gains=tuple(numbers[gain][0] for gain in units),
        gains_text=words.replace("²", "^2"),
        goal_centroid=law.goal_feature(mission),
        rotors=tuple(zip(frame.names, frame.places, strict=True)),
        hover=v.hover_thrusts,
        throttle_per_newton=options.throttle_per_newton,
        allocation=tuple(
            tuple(share / length for share, length in zip(row, lengths, strict=True))
            for row in shares(frame)
        ),
    )


def _limits(
    mission: Mission,
    standing: Standing,
    law: FlightLaw,
    spread: tuple[Fraction, Fraction] | None,
) -> Limits:
    low, high = (thrust - mission.vehicle.weight for thrust in standing.thrust)
    cosine, words = _tilt(mission, high, standing.tilt_cosine)
    return Limits(
        thrust=standing.thrust,
        commanded=_commanded(mission, standing, law),
        singular=law.singular_excess,
        floor=(law.singular_excess + low) / 2,
        tilt_cosine=cosine,
        tilt_words=words,
        box=InputBox(
            specific_force=None if law.lift is None else Fraction(160),
            spread=spread,
            heading=None if law.source.heading is None else Fraction(1, 10),
        ),
        centroid_square=(Fraction(101, 100) * mission.target.whole) ** 2,
        feature_square=_longest_feature(law.source, mission.target.whole, spread) ** 2,
    )


def _commanded(mission: Mission, standing: Standing, law: FlightLaw) -> tuple[Fraction, Fraction]:
    """Return the thrusts whose commands make what is proved, of vehicles within the tolerance, N.

    A vehicle makes 1 - e to 1 + e times what is commanded, over its mass; what it feels is proved.
    """
    low, high = standing.thrust
    tolerance = mission.uncertainty.thrust
    if standing.attraction is None or law.lift is None or not tolerance:
        return low, high
    return decimal_below(low / (1 + tolerance), 9), decimal_above(high / (1 - tolerance), 9)


def _spread(mission: Mission, options: Options) -> tuple[Fraction, Fraction]:
    """Return the n² - |q|² that a feature of the target's size is computed from.

    n is the sum of the weights. The target is no smaller than what keeps rounding to about a
    thousandth; its points are before the camera, so that their centroid is longer than n/25.
    """
    n, q = mission.target.whole, hover_goal(mission).centroid_midpoint
    by_centroid = options.precision == FLOAT32 and "centroid" in (options.sensing, options.camera)
    radius = Fraction(1, 100 if by_centroid else 10_000)
    if n**2 - sum(c**2 for c in q) < (2 * n * radius) ** 2:
        reason = (
            f"seen from the goal the target is so small (an angular radius below "
            f"{float(2 * radius):g} rad) that its size is lost in rounding"
        )
        hint = "; take --sensing points or --precision float64" if by_centroid else ""
        raise InputError(mission.source, "target", reason + hint)
    return (n * radius) ** 2, n**2 * (1 - Fraction(1, 625))


def _longest_feature(law: Law, n: Fraction, spread: tuple[Fraction, Fraction] | None) -> Fraction:
    """Return the longest feature that is accepted: a hundredth more than of the smallest target."""
    square = Fraction(0) if spread is None else spread[0]
    along = ca.SX([0, 0, math.sqrt(n**2 - square)])
    feature = ca.evalf(law.feature.of(along, ca.SX(float(square)), float(n)))
    beside = ca.norm_2(law.mount.made_up(ca.SX.zeros(3)))
    return Fraction(101, 100) * Fraction(float(ca.norm_2(feature) + beside))


def _tilt(mission: Mission, excess: Fraction, proved: Fraction | None) -> tuple[Fraction, str]:
    """Return the lowest cosine of the tilt that is certified, and the tilt in words."""
    sine = excess / mission.vehicle.weight  # a level gives |F| <= excess, of which m g sin(tilt)
    if proved is None and (mission.bounds.level is None or sine >= 1):  # is the horizontal part
        return Fraction(0), "90 degrees (the certificate sets no bound of its own)"
    cosine = proved or decimal_below(sqrt_enclosure(1 - sine**2)[0], 9)
    degrees = degrees_at_most(math.acos(float(cosine)))
    origin = "follows from the level" if proved is None else "proved on the way"
    return cosine, f"{degrees} degrees ({origin})"
