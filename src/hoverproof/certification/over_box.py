"""Decide whether a mission's bounds of Q, or of J, hold for its target over a box of positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hoverproof.algebra.graph import fingerprint
from hoverproof.certification.certificate import Certificate, accepted, seal
from hoverproof.certification.region import (
    Box,
    Enclosure,
    Outside,
    default_box,
    enclosures,
    exact_box,
    halved,
    outside,
)
from hoverproof.certification.verdict import Proved, Refuted, Undecided
from hoverproof.errors import InputError
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import Interval, level_view_of
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.loop import level_slope

TOO_MANY = "the bounds were neither proved nor broken over the box within the limit of boxes"


@dataclass(frozen=True, kw_only=True, repr=False)
class _OverBox:
    box: Box
    bounds: Interval
    enclosure: Enclosure | None

    @property
    def gist(self) -> str:
        """The bounds that were asked about."""
        low, high = map(float, self.bounds)
        return f"bounds [{low:.6g}, {high:.6g}] 1/m over a box"


@dataclass(frozen=True, kw_only=True, repr=False)
class ProvedBounds(_OverBox, Proved):
    """The bounds of the eigenvalues of Q hold at every position in a box.

    Attributes
    ----------
    mission, certificate
        See `Proved` of `hoverproof.certification.verdict`.
    box : (3,) of (low, high)
        World frame, m.
    bounds : (low, high)
        What was asked: the bounds of the mission, or, if they are "auto", those that were proved,
        1/m.
    enclosure : Enclosure or None
        The narrowest bounds that were proved there; None if no others were.
    """


@dataclass(frozen=True, kw_only=True, repr=False)
class RefutedBounds(_OverBox, Refuted):
    """The bounds of the eigenvalues of Q do not hold somewhere in a box.

    Attributes
    ----------
    mission, certificate
        See `Refuted` of `hoverproof.certification.verdict`.
    box, bounds, enclosure
        See `ProvedBounds`.
    outside : Outside
        Where they do not hold.
    """

    outside: Outside


@dataclass(frozen=True, kw_only=True, repr=False)
class UndecidedBounds(_OverBox, Undecided):
    """Whether the bounds of the eigenvalues of Q hold all over a box is not known.

    Its certificate is that of the enclosure, if there is one.

    Attributes
    ----------
    mission, reason, advice, certificate
        See `Undecided` of `hoverproof.certification.verdict`.
    box, bounds, enclosure
        See `ProvedBounds`.
    """


BoundsVerdict = ProvedBounds | RefutedBounds | UndecidedBounds


@of_mission
def certify_region(
    mission: Mission, box: Box | None = None, most: int | None = None
) -> BoundsVerdict:
    """Prove or refute that the mission's eigenvalue bounds hold over a box.

    Bounds that are "auto" are those that hold over the box.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    box : (3,) of (low, high), optional
        World frame, m; by default one around start and goal, see `default_box`.
    most : int, optional
        Largest number of cells of the box; see `enclose`.

    Returns
    -------
    ProvedBounds, RefutedBounds or UndecidedBounds

    Raises
    ------
    InputError
        If the box holds a target point, where Q is infinite, or if the bounds are "auto" and none
        are proved.
    """
    box = default_box(mission) if box is None else exact_box(box)
    proved = _enclose(mission, box, most)
    wanted = mission.bounds.eigenvalues
    if not isinstance(wanted, tuple):
        if proved is None:
            raise none_proved(mission)
        held, certificate = proved
        return ProvedBounds(
            mission=mission,
            certificate=certificate,
            box=box,
            bounds=held.eigenvalues,
            enclosure=held,
        )
    narrowest, least = proved or (None, None)
    asked: dict[str, Any] = {
        "mission": mission,
        "box": box,
        "bounds": wanted,
        "enclosure": narrowest,
    }
    for spot in outside(mission, box, wanted):
        point = {key: value for key, value in vars(spot).items() if key != "value"}
        refutation = accepted(_seal(mission, "outside", box, wanted, None, outside=point))
        if refutation:
            return RefutedBounds(certificate=refutation, outside=spot, **asked)
    tree = halved(mission, box, wanted, most)
    if tree is not None:
        shown = accepted(_seal(mission, "region", box, wanted, tree))
        if shown:
            return ProvedBounds(certificate=shown, **asked)
    return UndecidedBounds(certificate=least, reason=TOO_MANY, **asked)


def enclose(mission: Mission, box: Box, most: int | None = None) -> Enclosure | None:
    """Find and prove an interval that holds every eigenvalue of Q over a box.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high), world frame, m
    most : int, optional
        Largest number of cells of the box; by default, and at most, as many as the checker takes.

    Returns
    -------
    Enclosure or None
        None if nothing is proved with that many cells.

    Raises
    ------
    InputError
        If the box holds a target point, where Q is infinite.
    """
    proved = _enclose(mission, box, most)
    return None if proved is None else proved[0]


def _enclose(mission: Mission, box: Box, most: int | None) -> tuple[Enclosure, Certificate] | None:
    for region in enclosures(mission, box, most):
        shown = accepted(_seal(mission, "region", box, region.eigenvalues, region.tree))
        if shown:
            return region, shown
    return None


def none_proved(mission: Mission) -> InputError:
    """Say that "auto" found nothing.

    Parameters
    ----------
    mission : Mission
    """
    return InputError(
        mission.source,
        "bounds.eigenvalues",
        '"auto": no bounds were proved over the box within the effort; give a smaller one as '
        "bounds.box, or two numbers",
    )


def _seal(
    mission: Mission, kind: str, box: Box, bounds: Interval, tree: str | None, **parts: object
) -> Certificate:
    """Complete a certificate about Q alone: gains and thrust play no part in it."""
    held = {"box": box, "eigenvalues": bounds, "tree": tree}
    n, centroid = len(mission.target.points), mission.law.feature == "centroid"
    model = fingerprint(level_view_of(mission) if centroid else level_slope(n, law_of(mission)))
    return seal(mission, kind, {"region": held, **parts}, model)
