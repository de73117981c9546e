"""What a law makes of the image: one vector that turns with the camera, of all target points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from hoverproof.plant import camera


@dataclass(frozen=True)
class Feature:
    """What a law makes of the image.

    Attributes
    ----------
    name : str
    of : callable
        (q (3, 1), W² - |q|² (1, 1), sum W of the weights) ↦ what stands in place of q, (3, 1). It
        turns with the camera as q does.
    weights : tuple
        How much each target point counts in q; none if each counts once, and W is their number.
    """

    name: str
    of: Callable[[ca.SX, ca.SX, float], ca.SX]
    weights: tuple[float, ...] = ()

    def whole(self, points: int) -> float:
        """Return W, a bare number.

        Parameters
        ----------
        points : int
            Number of target points.
        """
        return sum(self.weights) if self.weights else points

    def seen(self, directions: ca.SX) -> ca.SX:
        """Return the feature of an image, (3, 1), without cancellation for a small target.

        Parameters
        ----------
        directions : SX
            p, (3, n), unit vectors.
        """
        weights = self.weights or None
        q = camera.centroid(directions, weights)
        size = camera.spread(directions, q, weights)
        return self.of(q, size, self.whole(directions.shape[1]))

    def at(self, centroid: ca.SX, points: int) -> ca.SX:
        """Return the feature of a centroid, (3, 1).

        Parameters
        ----------
        centroid : SX
            q, (3, 1).
        points : int
            Number of target points.
        """
        whole = self.whole(points)
        return self.of(centroid, whole**2 - ca.dot(centroid, centroid), whole)
