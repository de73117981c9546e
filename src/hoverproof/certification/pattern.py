"""The target as proofs look for it in floating point: distinct points, and how much each counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pattern:
    """Target points and their weights.

    Attributes
    ----------
    points : (n, 3)
        World frame, m.
    weights : (n,)
        How much each counts in q = Σ wᵢ pᵢ, bare numbers.
    """

    points: Array
    weights: Array

    @classmethod
    def of(cls, mission: Mission) -> Pattern:
        """Take the target of a mission; points that coincide are one that counts as much as they.

        Parameters
        ----------
        mission : Mission
        """
        found = mission.target.places
        return cls(np.array(list(found), float), np.array(list(found.values()), float))

    @classmethod
    def plain(cls, points: Array) -> Pattern:
        """Count each point once.

        Parameters
        ----------
        points : (n, 3)
            World frame, m.
        """
        return cls(points, np.ones(len(points)))

    @property
    def whole(self) -> float:
        """W, the sum of the weights: the number of points, if each counts once."""
        return float(self.weights.sum())

    @property
    def mean(self) -> Array:
        """The weighted mean of the points, (3,), world frame, m."""
        total: Array = (self.weights[:, None] * self.points).sum(axis=0)
        return total / self.whole
