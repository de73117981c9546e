"""What a user chooses of a firmware package, held to what can be exported."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from hoverproof.errors import InputError
from hoverproof.export.precision import PRECISIONS, Precision
from hoverproof.mission.exact import exact
from hoverproof.mission.sections import Mission


@dataclass(frozen=True)
class Options:
    """What a user chooses.

    Attributes
    ----------
    precision : Precision
        Of the numbers on the target.
    sensing : str
        What a step takes in of the image, ``"points"``, ``"centroid"`` or, where frames are kept
        apart from the step, the ``"feature"`` of the law.
    tunable : bool
        Whether the gains stay parameters.
    each_rotor : tuple of (low, high)
        The thrust of each, N: the same unless the mission has limits of its own for some.
    rotor_limits_from : str
        Where these limits come from, in words.
    pixels : bool
        Whether the glue for autopilots takes raw pixels, and sees them through the mission's lens.
    camera : str or None
        What a frame that is kept holds, ``"points"`` or ``"centroid"``; None without.
    rates : bool
        Whether body rates and thrust are commanded, to an autopilot's own rate loop.
    """

    precision: Precision
    sensing: str
    tunable: bool
    each_rotor: tuple[tuple[Fraction, Fraction], ...]
    rotor_limits_from: str
    camera: str | None = None
    pixels: bool = False
    rates: bool = False

    @classmethod
    def of(
        cls,
        mission: Mission,
        *,
        precision: str,
        sensing: str,
        tunable: bool,
        rotor_limits: tuple[Fraction, Fraction] | None,
        camera: bool = False,
        pixels: bool = False,
        interface: str | None = None,
    ) -> Options:
        """Take the options of a user.

        Parameters
        ----------
        mission : Mission
            Its rotors set the limits, if the user does not.
        precision, sensing : str
            To be one of those that there are.
        tunable : bool
        rotor_limits : (low, high), optional
            N.
        camera : bool
            Whether frames are kept and turned between steps.
        pixels : bool
            Whether autopilots are given raw pixels.
        interface : str, optional
            What is commanded, ``"torques"`` or ``"rates"``; by default rates where the mission has
            the bandwidth of a rate loop.

        Raises
        ------
        InputError
            If one of them cannot be used.
        """
        if precision not in PRECISIONS:
            raise InputError("--precision", "", f"must be float32 or float64, not {precision!r}")
        if sensing not in ("points", "centroid"):
            raise InputError("--sensing", "", f"must be points or centroid, not {sensing!r}")
        if pixels and (mission.camera.lens is None or sensing != "points"):
            lens = 'camera.lens in the mission: give [camera] file = "camera_info.yaml"'
            needs = lens if sensing == "points" else "--sensing points"
            raise InputError("--pixels", "", f"needs {needs}")
        limits = _each_rotor(mission, None if rotor_limits is None else _pair(rotor_limits))
        origin = _origin_of_limits(mission, given=rotor_limits is not None)
        kept = sensing if camera else None
        taken = "feature" if camera else sensing
        rates = _commands_rates(mission, interface)
        return cls(PRECISIONS[precision], taken, tunable, limits, origin, kept, pixels, rates)

    @property
    def rotor_limits(self) -> tuple[Fraction, Fraction]:
        """The thrusts that each rotor can make, N."""
        lows, highs = zip(*self.each_rotor, strict=True)
        return max(lows), min(highs)

    @property
    def rotors_differ(self) -> bool:
        """Whether some rotors have other limits than others."""
        return len({*self.each_rotor}) > 1

    @property
    def of_points(self) -> bool:
        """Whether a step takes in points, and not what is made of them."""
        return self.sensing == "points"

    @property
    def field(self) -> str:
        """The field of the input that holds what the camera saw."""
        return "image" if self.of_points else self.sensing

    @property
    def throttle_per_newton(self) -> Fraction:
        """The throttle, 0 to 1, over the thrust of rotors that give their highest at 1, 1/N."""
        return 1 / sum((high for _, high in self.each_rotor), Fraction(0))

    def seen(self, points: int) -> list[str]:
        """Return the fields of the input that hold what the camera saw.

        Parameters
        ----------
        points : int
            Number of target points.
        """
        if self.of_points:
            return [f"in->image[{i}][{k}]" for i in range(points) for k in range(2)]
        return [f"in->{self.field}[{k}]" for k in range(3)]


def _commands_rates(mission: Mission, interface: str | None) -> bool:
    """Tell whether rates are commanded, and refuse a mission of which they cannot be."""
    if interface not in (None, "torques", "rates"):
        raise InputError("--interface", "", f"must be torques or rates, not {interface!r}")
    known = mission.interface.rate_bandwidth is not None
    if interface == "torques" or not (known or interface):
        return False
    if not known:
        raise InputError(
            mission.source,
            "interface.rate_bandwidth",
            "is missing (rad/s): rates are commanded to a rate loop of known bandwidth, "
            "as --set interface.rate_bandwidth=VALUE tells",
        )
    if mission.law.force != "measured":
        raise InputError(
            mission.source,
            "law.force",
            "must be 'measured' to command rates and thrust: what an autopilot makes of a thrust "
            "is not known in N, and a law that takes that for its force hovers elsewhere",
        )
    return True


def _pair(limits: Sequence[object]) -> tuple[Fraction, Fraction]:
    try:
        low, high = map(exact, limits)
    except (TypeError, ValueError):
        reason = f"must be two numbers, lowest and highest in N, not {limits!r:.80}"
        raise InputError("--rotor-limits", "", reason) from None
    return low, high


def _each_rotor(
    mission: Mission, limits: tuple[Fraction, Fraction] | None
) -> tuple[tuple[Fraction, Fraction], ...]:
    weight, shares = mission.vehicle.weight, mission.vehicle.hover_thrusts
    twice, held = 2 * weight / len(shares), []
    for (least, most), share in zip(mission.rotor_limits, shares, strict=True):
        low, high = limits or (least or Fraction(0), most or twice)
        if not (0 <= low < share < high <= weight * 5 / 2):
            where = ("--rotor-limits", "") if limits else (mission.source, "rotors")
            raise InputError(
                *where,
                f"must hold the share of a rotor in hover, {float(share):g} N, be at least 0 and "
                f"at most 2.5 times the weight, not [{float(low):g}, {float(high):g}] N",
            )
        held.append((low, high))
    return tuple(held)


def _origin_of_limits(mission: Mission, *, given: bool) -> str:
    """Say where the limits of the rotors come from, for who flashes the package."""
    low, high = mission.rotors.min_thrust, mission.rotors.max_thrust
    if given:
        return "given to the export"
    if mission.vehicle.own_limits and all(most is not None for _, most in mission.rotor_limits):
        return "from vehicle.rotors of the mission, each its own"
    if high is None:
        half = "half the weight" if len(mission.vehicle.frame.names) == 4 else "twice its share"
        half += "" if low is None else " at most"
        return f"assumed: {half}, as the mission names none"
    return "from [rotors] of the mission" + ("" if low is not None else ", which names no lowest")
