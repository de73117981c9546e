"""Decide whether a mission's eigenvalue bounds of Q hold for its target over a box of positions."""

from __future__ import annotations

from dataclasses import dataclass

from hoverproof.certification.certificate import Certificate, seal
from hoverproof.certification.problem import gain_problem
from hoverproof.certification.region import Box, Outside, Region, enclose, holds_over, outside
from hoverproof.mission import Mission


@dataclass(frozen=True)
class RegionVerdict:
    """What is known of the eigenvalues of Q over a box.

    Attributes
    ----------
    status : str
        Of the mission's bounds over the box: ``"proved"``, ``"refuted"`` or ``"undecided"``.
    box : (3,) of (low, high)
        World frame, m.
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
    enclosure: Region | None
    outside: Outside | None
    certificate: Certificate | None


def certify_region(mission: Mission, box: Box, most: int | None = None) -> RegionVerdict:
    """Prove or refute that the mission's eigenvalue bounds hold over a box.

    Parameters
    ----------
    mission : Mission
    box : (3,) of (low, high), world frame, m
    most : int, optional
        Most boxes in the branch and bound (see `enclose`).

    Raises
    ------
    InputError
        If the box holds a target point, where Q is infinite.
    """
    enclosed = enclose(mission, box, most)
    wanted = mission.bounds.eigenvalues
    spot = outside(mission, box, wanted)
    if spot is not None:
        point = {
            "position": spot.position,
            "direction": spot.direction,
            "bound": spot.bound,
        }
        shown = Region(box, wanted, (spot.eigenvalue, spot.eigenvalue))
        refutation = seal(gain_problem(mission, region=shown), "outside", {"outside": point})
        return RegionVerdict("refuted", box, enclosed, spot, refutation)
    proved = holds_over(mission, box, wanted, most)
    held = enclosed
    if proved:
        attained = enclosed.attained if enclosed else (float(wanted[0]), float(wanted[1]))
        held = Region(box, wanted, attained)
    if held is None:
        return RegionVerdict("undecided", box, None, None, None)
    certificate = seal(gain_problem(mission, region=held), "region", {})
    return RegionVerdict("proved" if proved else "undecided", box, enclosed, None, certificate)
