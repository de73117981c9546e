"""From pixels to undistorted image points, as C: the lens of the mission, its graphs printed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import casadi as ca
import numpy as np

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.export.emitter import statements
from hoverproof.export.options import Options
from hoverproof.export.precision import FLOAT64, Precision, Rounded
from hoverproof.mission.sections import Mission
from hoverproof.plant.lens import LensModel, seeing_lens

VECTORS = 8
"""Pixels of its self-test."""
LEFT = Fraction(1, 10**8)
"""Square of what may be left between a pixel and that of its point, in focal lengths."""
SPARE = Fraction(101, 100)
"""By how much points may be farther from the axis than the corners of the image."""


@dataclass(frozen=True)
class LensText:
    """The lens in C.

    Attributes
    ----------
    ray, begin, better, left, point : tuple of str
        Statements: from a pixel to a distorted point, to where Newton's method begins, from what is
        found to what is better, to the square of what is left, and to the point.
    model : str
        Of the distortion.
    size, steps : int
        How many numbers are sought, and the steps of Newton's method: bare numbers.
    left_square, reach_square : Fraction
        The largest squares of what is left and of a point, dimensionless.
    seen : tuple of str
        Of the example's vehicle: from image points to pixels, in double.
    vectors : tuple of (str, str)
        A pixel and its point, bit for bit.
    """

    ray: tuple[str, ...]
    begin: tuple[str, ...]
    better: tuple[str, ...]
    left: tuple[str, ...]
    point: tuple[str, ...]
    model: str
    size: int
    steps: int
    left_square: Fraction
    reach_square: Fraction
    seen: tuple[str, ...]
    vectors: tuple[tuple[str, str], ...]


def lens_text(mission: Mission, options: Options) -> LensText | None:
    """Write the lens of a mission in C, if it has one and firmware takes points.

    Parameters
    ----------
    mission : Mission
    options : Options

    Raises
    ------
    InputError
        If a pixel of the image has no one direction.
    """
    seeing = seeing_lens(mission)
    if seeing is None or "points" not in (options.sensing, options.camera):
        return None
    lens, sight = seeing
    graphs, real = _graphs(lens), options.precision.c_type
    size = graphs["begin"].numel_out(0)
    found, ray = [f"found[{k}]" for k in range(size)], ["ray_x", "ray_y"]
    to = {
        "ray": ([["pixel[0]", "pixel[1]"]], [f"const {real} {name}" for name in ray]),
        "begin": ([ray], found),
        "better": ([found, ray], [f"next[{k}]" for k in range(size)]),
        "left": ([found, ray], [f"const {real} left"]),
        "point": ([found, ray], ["point[0]", "point[1]"]),
    }
    written = {
        name: tuple(statements(graphs[name], given, {"to": places}, options.precision))
        for name, (given, places) in to.items()
    }
    return LensText(
        **written,
        model=lens.model,
        size=size,
        steps=sight.steps,
        left_square=LEFT,
        reach_square=(SPARE * Fraction(sight.reach)) ** 2,
        seen=_seen(lens, len(mission.target.points), real),
        vectors=tuple(_vectors(lens, graphs, sight.steps, options.precision)),
    )


def _graphs(lens: LensModel) -> dict[str, ca.Function]:
    pixel, ray = ca.SX.sym("pixel", 2), ca.SX.sym("ray", 2)
    found = ca.SX.sym("found", lens.begin(ray).numel())
    of = {
        "ray": ([pixel], lens.ray(pixel)),
        "begin": ([ray], lens.begin(ray)),
        "better": ([found, ray], lens.better(found, ray)),
        "left": ([found, ray], lens.left(found, ray)),
        "point": ([found, ray], lens.point(found, ray)),
    }
    return {
        name: share_reciprocals(
            ca.Function(
                name, given, [ca.densify(ca.cse(to))], [f"i{k}" for k in range(len(given))], ["to"]
            )
        )
        for name, (given, to) in of.items()
    }


def _seen(lens: LensModel, points: int, real: str) -> tuple[str, ...]:
    point = ca.SX.sym("point", 2)
    look = ca.Function("look", [point], [ca.cse(lens.pixel(point))], ["p"], ["to"])
    lines: list[str] = []
    for i in range(points):
        given, places = (
            [f"seen[{i}][{k}]" for k in range(2)],
            ["const double u", "const double v"],
        )
        lines += ["{", *statements(look, [given], {"to": places}, FLOAT64)]
        lines += [f"pixel[{i}][{k}] = ({real}){c};" for k, c in enumerate("uv")] + ["}"]
    return tuple(lines)


def _vectors(
    lens: LensModel, graphs: dict[str, ca.Function], steps: int, precision: Precision
) -> Sequence[tuple[str, str]]:
    """Return pixels with their points, computed operation by operation as on the target."""
    draw = np.random.default_rng(0)

    def rounded(name: str, *given: list[Any]) -> list[Any]:
        (rows,) = evaluate(graphs[name], list(given), lambda c: Rounded(precision.round(c)))
        return [row[0] for row in rows]

    def braces(values: Iterable[Any]) -> str:
        return "{ " + ", ".join(precision.hex_literal(value) for value in values) + " }"

    vectors = []
    for _ in range(VECTORS):
        pixel = draw.uniform([0, 0], [lens.width, lens.height]).astype(precision.scalar)
        ray = rounded("ray", [Rounded(c) for c in pixel])
        found = rounded("begin", ray)
        for _ in range(steps):
            found = rounded("better", found, ray)
        point = rounded("point", found, ray)
        vectors.append((braces([*pixel]), braces([c.value for c in point])))
    return vectors
