"""Decide whether a mission's eigenvalue bounds of Q hold for its target over a box of positions."""

from __future__ import annotations

from dataclasses import dataclass

from hoverproof.certification.bounds import none_proved
from hoverproof.certification.certificate import Certificate, seal_region
from hoverproof.certification.region import Box, Outside, Region, enclose, holds_over, outside
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import Interval


@dataclass(frozen=True)
class RegionVerdict:
    """What is known of the eigenvalues of Q over a box.

    Attributes
    ----------
    status : str
        Of the mission's bounds over the box: ``"proved"``, ``"refuted"`` or ``"undecided"``.
    box : (3,) of (low, high)
        World frame, m.
    bounds : (low, high)
        What was asked: the bounds of the mission, or, if they are "auto", those that were proved,
        1/m.
    enclosure : Region or None
        The narrowest bounds that were proved there; None if none were.
    outside : Outside or None
        Where the mission's bounds do not hold; None if that was not shown.
    certificate : Certificate or None
        Of the mission's bounds if they are proved, of the position if they are refuted, and
        otherwise of the enclosure.
    """

    status: str
    box: Box
    bounds: Interval
    enclosure: Region | None
    outside: Outside | None
    certificate: Certificate | None


def certify_region(mission: Mission, box: Box, most: int | None = None) -> RegionVerdict:
    """Prove or refute that the mission's eigenvalue bounds hold over a box.

    Bounds that are "auto" are those that hold over the box.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high), world frame, m
    most : int, optional
        Most boxes in the branch and bound (see `enclose`).

    Raises
    ------
    InputError
        If the box holds a target point, where Q is infinite, or if the bounds are "auto" and none
        are proved.
    """
    enclosed = enclose(mission, box, most)
    wanted = mission.bounds.eigenvalues
    if not isinstance(wanted, tuple):
        if enclosed is None:
            raise none_proved(mission)
        certificate = seal_region(mission, enclosed, "region", {})
        return RegionVerdict("proved", box, enclosed.eigenvalues, enclosed, None, certificate)
    spot = outside(mission, box, wanted)
    if spot is not None:
        point = {
            "position": spot.position,
            "direction": spot.direction,
            "bound": spot.bound,
        }
        shown = Region(box, wanted, (spot.eigenvalue, spot.eigenvalue))
        refutation = seal_region(mission, shown, "outside", {"outside": point})
        return RegionVerdict("refuted", box, wanted, enclosed, spot, refutation)
    proved = holds_over(mission, box, wanted, most)
    held = enclosed
    if proved:
        attained = enclosed.attained if enclosed else (float(wanted[0]), float(wanted[1]))
        held = Region(box, wanted, attained)
    if held is None:
        return RegionVerdict("undecided", box, wanted, None, None, None)
    certificate = seal_region(mission, held, "region", {})
    status = "proved" if proved else "undecided"
    return RegionVerdict(status, box, wanted, enclosed, None, certificate)
