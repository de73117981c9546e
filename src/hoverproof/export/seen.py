"""The feature that a law makes of what firmware takes in of the image."""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca

from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.plant import camera
from hoverproof.servo.law import Law


@dataclass(frozen=True)
class SeenFeature:
    """A feature of what is taken in of the image.

    Attributes
    ----------
    seen : SX
        Symbols: what is taken in, (2, n) image points, or (3, 1).
    feature : SX
        In these, and in the symbol `spread`, (3, 1).
    spread, spread_of : SX
        n² - |q|² as a symbol and in what is seen, (1, 1), or (0, 1) where the feature does without.
    """

    seen: ca.SX
    feature: ca.SX
    spread: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    spread_of: ca.SX = field(default_factory=lambda: ca.SX(0, 1))

    def spread_function(self) -> ca.Function | None:
        """Return (what is seen) ↦ n² - |q|², if the feature needs it."""
        if self.spread_of.is_empty():
            return None
        return share_reciprocals(
            ca.Function("spread", [self.seen], [self.spread_of], ["seen"], ["spread"])
        )


def seen_feature(law: Law, sensing: str, points: int) -> SeenFeature:
    """Return the feature of what is taken in of the image.

    Parameters
    ----------
    law : Law
    sensing : {"points", "centroid", "feature"}
        What is taken in.
    points : int
        Number of target points.
    """
    seen, spread = ca.SX.sym("centroid", 3), ca.SX.sym("spread")
    if sensing == "feature":
        return SeenFeature(seen, seen)
    feature = law.feature
    whole, weights = feature.whole(points), feature.weights or None
    q, spread_of = law.in_body(seen), whole**2 - ca.dot(seen, seen)
    if sensing == "points":
        seen = ca.SX.sym("image", 2, points)
        directions = law.in_body(camera.spherical(seen))
        q = camera.centroid(directions, weights)
        spread_of = camera.spread(directions, q, weights)
    found = law.made_up(feature.of(q, spread, whole))
    if not ca.depends_on(found, spread):
        return SeenFeature(seen, found)
    return SeenFeature(seen, found, spread, spread_of)
