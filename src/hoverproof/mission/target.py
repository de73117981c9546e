"""The target of a mission: the points that the camera sees, and how much each counts."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator

from hoverproof.mission.fields import Section, array, list_of, quantity, reject

MAX_POINTS = 1024

_Length = Annotated[Fraction, quantity("m", "-1e6", "1e6")]
_Weight = Annotated[Fraction, quantity("", "0", "1e6", open_low=True, least="1e-6")]
Point = Annotated[tuple[_Length, _Length, _Length], BeforeValidator(array("x", "y", "z"))]


class Target(Section):
    """The target: points in the world frame, m, z down, and how much each counts.

    Points may coincide, as the centres of nested tags do: each is counted. A weight of 2 counts a
    point twice; left out, each counts once: `weights`, (n,), bare numbers.
    """

    points: Annotated[list[Point], Field(min_length=2, max_length=MAX_POINTS)]
    weights: Annotated[list[_Weight], BeforeValidator(list_of("weights"))] | None = None

    @model_validator(mode="before")
    @classmethod
    def _plain_if_all_count_once(cls, given: Any) -> Any:
        """Leave weights out that say what is said without them, so that it is the same mission."""
        if isinstance(given, dict) and isinstance(given.get("points"), list | tuple):
            weights, n = given.get("weights"), len(given["points"])
            if isinstance(weights, list | tuple) and len(weights) == n:
                once = all(not isinstance(w, bool | str) and w == 1 for w in weights)
                return {k: v for k, v in given.items() if k != "weights"} if once else given
        return given

    @model_validator(mode="after")
    def _is_seen(self) -> Self:
        if self.weights is not None and len(self.weights) != len(self.points):
            raise reject(
                f"must hold one number for each of the {len(self.points)} points, "
                f"not {len(self.weights)}",
                key="weights",
            )
        if len(set(self.points)) == 1:
            raise reject("are all one point; move at least one of them", key="points")
        return self

    @property
    def counts(self) -> list[Fraction]:
        """How much each point counts, (n,), bare numbers."""
        return list(self.weights or [Fraction(1)] * len(self.points))

    @property
    def places(self) -> dict[tuple[Fraction, Fraction, Fraction], Fraction]:
        """How much each place counts, m, world frame: points that coincide are counted together."""
        found: dict[tuple[Fraction, Fraction, Fraction], Fraction] = {}
        for point, count in zip(self.points, self.counts, strict=True):
            found[point] = found.get(point, Fraction(0)) + count
        return found

    @property
    def whole(self) -> Fraction:
        """W, the sum of the weights: the number of points, if each counts once."""
        return sum(self.counts, Fraction(0))

    @property
    def mean(self) -> tuple[Fraction, Fraction, Fraction]:
        """The weighted mean of the points, (3,), world frame, m."""
        x, y, z = (
            sum((w * p[k] for w, p in zip(self.counts, self.points, strict=True)), Fraction(0))
            / self.whole
            for k in range(3)
        )
        return x, y, z


def on_one_line(points: Sequence[Sequence[Fraction]]) -> bool:
    """Tell whether all points lie on one line.

    Parameters
    ----------
    points : (n, 3), m
    """
    origin, *others = points
    rays = [[a - b for a, b in zip(p, origin, strict=True)] for p in others]
    first = next((r for r in rays if any(r)), [Fraction(1), Fraction(0), Fraction(0)])
    return all(
        first[i] * r[j] == first[j] * r[i] for r in rays for i, j in ((0, 1), (0, 2), (1, 2))
    )
