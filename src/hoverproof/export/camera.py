"""What keeps the newest frame of a slow camera for a fast controller: its graphs, as C."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from hoverproof.export.emitter import statements
from hoverproof.export.flight_law import FlightLaw
from hoverproof.export.heading import heading_kept, north_seen
from hoverproof.export.law_text import sum_of_squares
from hoverproof.export.options import Options
from hoverproof.export.seen import seen_feature
from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import skew

KEPT = 64
"""Turns between steps that are kept: a frame may be that many steps old when it comes in."""

LARGEST_TURN = Fraction(1, 2)
"""rad from one step to the next; beyond that the frame is given up."""

OLDEST = Fraction(1)
"""s: the longest time that a frame may be used for."""


@dataclass(frozen=True)
class CameraText:
    """The camera in C.

    Attributes
    ----------
    field : str
        Of a frame: ``"image"`` or ``"centroid"``.
    feature, spread, turned : tuple of str
        Statements: from a frame and its n² - |q|² to the feature, from a frame to the latter (empty
        where the law does without), and from a feature and a turn to the feature after it.
    image_square : str
        An expression: the sum of the squares of what the camera saw.
    north, heading : tuple of str
        Statements: from a frame to the x axis of the world, and from that to the heading; empty
        where the image does not tell it.
    kept : int
        How many turns are kept: a bare number.
    largest_turn_square, oldest : Fraction
        rad² and s.
    """

    field: str
    feature: tuple[str, ...]
    spread: tuple[str, ...]
    turned: tuple[str, ...]
    image_square: str
    north: tuple[str, ...] = ()
    heading: tuple[str, ...] = ()
    kept: int = KEPT
    largest_turn_square: Fraction = LARGEST_TURN**2
    oldest: Fraction = OLDEST


def turned_function() -> ca.Function:
    """Return (feature, turn in rad) ↦ the feature after the camera has turned by that, (3,) each.

    It is the rotation whose Rodrigues vector is tan(θ/2) along the axis, exactly; tan is cut after
    its fifth power, so that a turn of half a radian is right to 7e-6 rad, one of a tenth to 2e-11.
    """
    feature, turn = ca.SX.sym("feature", 3), ca.SX.sym("turn", 3)
    square = ca.dot(turn, turn)
    half = turn * ((1 + square * (ca.SX(1) / 12 + square / 120)) / 2)
    once = skew(half) @ feature
    moved = feature + 2 / (1 + ca.dot(half, half)) * (skew(half) @ once - once)
    names = ["feature", "turn"]
    return ca.Function("turned", [feature, turn], [ca.cse(moved)], names, ["turned"])


def camera_text(mission: Mission, law: FlightLaw, options: Options) -> CameraText | None:
    """Write the camera in C, if there is one.

    Parameters
    ----------
    mission : Mission
    law : FlightLaw
        Of the mission.
    options : Options
    """
    if options.camera is None:
        return None
    points = len(mission.target.points)
    field = {"points": "image", "centroid": "centroid"}[options.camera]
    names = (
        [f"frame->image[{i}][{k}]" for i in range(points) for k in range(2)]
        if field == "image"
        else [f"frame->centroid[{k}]" for k in range(3)]
    )
    seen = seen_feature(law.source, options.camera, points)
    inputs = [seen.seen, seen.spread]
    of_seen = ca.Function("feature", inputs, [ca.cse(seen.feature)])
    spread = seen.spread_function()
    places = [f"feature[{k}]" for k in range(3)]
    real = options.precision.c_type
    axis, kept = ([f"{of}north[{k}]" for k in range(3)] for of in ("", "camera->"))
    headed = law.source.sees_north
    return CameraText(
        field=field,
        feature=tuple(statements(of_seen, [names, ["spread"]], {"o0": places}, options.precision)),
        spread=()
        if spread is None
        else tuple(
            statements(spread, [names], {"spread": [f"const {real} spread"]}, options.precision)
        ),
        turned=tuple(
            statements(
                turned_function(),
                [places, [f"turn[{k}]" for k in range(3)]],
                {"turned": [f"const {real} turned_{a}" for a in "xyz"]},
                options.precision,
            )
        ),
        image_square=sum_of_squares(names),
        north=north_seen(mission, options, law.source, names, "frame->", axis) if headed else (),
        heading=heading_kept(options, kept, "in->") if headed else (),
    )
