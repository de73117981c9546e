"""The questions of `new`, in their order: what to ask, and what Enter stands for.

What Enter stands for suits vehicles from 20 g to 20 kg: lengths and the lag of brushless motors go
with the cube root of the mass, inertias and drag with what was measured of such vehicles.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, NamedTuple

from cyclopts import Parameter

from hoverproof.cli.completion import mission_names

if TYPE_CHECKING:
    from hoverproof.mission.vehicle import Rotor, Vehicle

Answers = dict[str, str]
OWN, NONE = "own", "none"
CONTROL_RATES = {"none": 0, "crazyflie": 500, "px4": 400, "ardupilot": 400}
"""Hz at which an autopilot runs its attitude control, unless it is told otherwise."""
LAYOUTS = ("x", "plus", "hex", "octo")
"""Of rotors at one distance from the centre."""
CHOICES = {"layout": LAYOUTS, "autopilot": tuple(CONTROL_RATES)}
"""Questions that are answered by one of some names."""
NAMES = ("vehicle", *CHOICES)
"""Questions that are answered by a name, never by a number."""
USUAL_MASS, USUAL_ARM, USUAL_LAG = 0.5, 0.17, 0.03
"""kg, m, s: a vehicle to which others are compared."""
BRUSHED, BRUSHED_LAG = 0.1, 0.05
"""kg, s: lighter vehicles have brushed motors, which no ESC spurs on: that of the preset
crazyflie-2.1. (RotorPy has 0.072 s for the rotor speed of a Crazyflie.)"""
GYRATION = 0.28, 0.28, 0.52
"""Inertia over mass and squared distance of a rotor: 0.25 to 0.38 and 0.49 to 0.56 of vehicles that
were measured."""
DRAG = 0.13
"""Drag ratio over that distance, of the same vehicles."""
SIDES = 6
"""Height over the side of the tag."""
ASIDE, ABOVE = 0.3, 1.3
"""Where the start is, over the height."""


class Question(NamedTuple):
    """A question.

    Attributes
    ----------
    name : str
        Of the answer, and of the option.
    key : str
        Of the mission file: an answer must be what this key accepts.
    words : str
        With the unit.
    default : callable
        What Enter stands for, from the answers before.
    """

    name: str
    key: str
    words: str
    default: Callable[[Answers], str]

    def assumed(self, answer: str) -> str:
        """Say what is assumed if nobody answers: the option, the number, the unit."""
        _, comma, unit = self.words.rpartition(", ")
        said = f"{answer} {unit}" if comma and self.name not in NAMES else answer.strip('"')
        return f"--{self.name.replace('_', '-')} {said}"


def _scale(a: Answers) -> float:
    return math.cbrt(float(a["mass"]) / USUAL_MASS)


def _lag(a: Answers) -> str:
    return text(BRUSHED_LAG if float(a["mass"]) < BRUSHED else USUAL_LAG * _scale(a))


def _inertia(a: Answers) -> str:
    mass, distance = float(a["mass"]), float(a["rotor_distance"])
    return row(share * mass * distance**2 for share in GYRATION)


def _start(a: Answers) -> str:
    height = float(a["height"])
    return row([ASIDE * height, 0.0, -ABOVE * height])


QUESTIONS = (
    Question(
        "vehicle", "", "preset or mission file with the vehicle, or own", lambda a: f'"{OWN}"'
    ),
    Question("mass", "vehicle.mass", "mass with battery and camera, kg", lambda a: "0.5"),
    Question(
        "layout",
        "",
        "rotors: x (4, diagonal), plus (4, on axes), hex (6), octo (8)",
        lambda a: '"x"',
    ),
    Question(
        "rotor_distance",
        "vehicle.lever",
        "distance of a rotor from the centre of mass, m",
        lambda a: text(USUAL_ARM * _scale(a)),
    ),
    Question("inertia", "vehicle.inertia", "inertia about x y z, kg m²", _inertia),
    Question(
        "drag_ratio",
        "vehicle.drag_ratio",
        "drag torque of a rotor over its thrust, m",
        lambda a: text(DRAG * float(a["rotor_distance"])),
    ),
    Question(
        "rotor_lag",
        "uncertainty.rotor_lag",
        "lag of the rotors, s",
        _lag,
    ),
    Question("tag", "", "side of the square tag, m", lambda a: "0.2"),
    Question(
        "height",
        "goal.height",
        "height to hover at, above the tag, m",
        lambda a: text(SIDES * float(a["tag"])),
    ),
    Question("frame_rate", "sensors.frame_rate", "frame rate of the camera, Hz", lambda a: "30"),
    Question(
        "latency",
        "sensors.latency",
        "latency from an image to its use, s",
        lambda a: "0.04",
    ),
    Question(
        "half_angle",
        "camera.half_angle",
        "angle from the axis to the edge of the image, rad, or none",
        lambda a: f'"{NONE}"',
    ),
    Question("thrust", "uncertainty.thrust", "thrust may be off by this share", lambda a: "0.2"),
    Question("torque", "uncertainty.torque", "torque and inertia: by this share", lambda a: "0.1"),
    Question("wind", "uncertainty.wind", "steady wind, its force over mass, m/s²", lambda a: "0.2"),
    Question("yaw_rate", "uncertainty.yaw_rate", "largest yaw rate, rad/s", lambda a: "0.3"),
    Question("autopilot", "", "autopilot: crazyflie, px4, ardupilot or none", lambda a: '"none"'),
    Question("start", "start.position", "start x y z (world, z down), m", _start),
)
START = QUESTIONS[-1]
WORDS = {question.name: question.words for question in QUESTIONS}


def _says(name: str) -> Parameter:
    words = WORDS[name]
    return Parameter(help=f"{words[0].upper()}{words[1:]}.")


@dataclass(frozen=True)
class Given:
    """Answers that were given as options; None is still to be asked, or left to its default."""

    vehicle: Annotated[
        str | None, Parameter(help="Take the vehicle from this mission.", completer=mission_names)
    ] = None
    mass: Annotated[str | None, _says("mass")] = None
    layout: Annotated[str | None, _says("layout")] = None
    rotor_distance: Annotated[str | None, _says("rotor_distance")] = None
    inertia: Annotated[str | None, _says("inertia")] = None
    drag_ratio: Annotated[str | None, _says("drag_ratio")] = None
    rotor_lag: Annotated[str | None, _says("rotor_lag")] = None
    tag: Annotated[str | None, _says("tag")] = None
    height: Annotated[str | None, _says("height")] = None
    frame_rate: Annotated[str | None, _says("frame_rate")] = None
    latency: Annotated[str | None, _says("latency")] = None
    half_angle: Annotated[str | None, _says("half_angle")] = None
    thrust: Annotated[str | None, _says("thrust")] = None
    torque: Annotated[str | None, _says("torque")] = None
    wind: Annotated[str | None, _says("wind")] = None
    yaw_rate: Annotated[str | None, _says("yaw_rate")] = None
    autopilot: Annotated[str | None, _says("autopilot")] = None
    start: Annotated[str | None, _says("start")] = None

    def answers(self) -> Answers:
        """Return those that were given."""
        return {name: given for name, given in vars(self).items() if given is not None}


def placed(vehicle: Vehicle) -> str:
    """Write where the rotors of a vehicle are, as lines of a mission file."""
    from hoverproof.mission.writing import decimal  # help, which asks nothing, comes at once

    if vehicle.lever is not None:
        return f"lever = {decimal(vehicle.lever)}  # m, of each rotor about roll and pitch axis"
    if vehicle.rotors is not None:
        return in_rotors(map(_rotor, vehicle.rotors))
    arms = vehicle.arm if isinstance(vehicle.arm, tuple) else (vehicle.arm or Fraction(0),)
    lengths = ", ".join(map(decimal, arms))
    layout = in_layout(vehicle.layout or "", f"[{lengths}]" if len(arms) > 1 else lengths)
    return layout + ("\nreversed = true  # propellers turn the other way" * vehicle.reversed)


def _rotor(rotor: Rotor) -> str:
    from hoverproof.mission.writing import decimal

    position = ", ".join(map(decimal, rotor.position))
    keys = ("drag_ratio", "thrust_min", "thrust_max")
    said = ((key, getattr(rotor, key)) for key in keys)
    own = "".join(f", {key} = {decimal(value)}" for key, value in said if value is not None)
    return in_rotor(f"[{position}]", f"{rotor.spin}", own)


def in_rotor(position: str, spin: str, own: str = "") -> str:
    """Write a rotor with its position, TOML, and what else is its own, as a line of `in_rotors`."""
    return f'  {{position = {position}, spin = "{spin}"{own}}},'


def in_rotors(lines: Iterable[str]) -> str:
    """Write rotors, a line each, as lines of a mission file."""
    axes = "x forward, y right, z down, m; spin seen from above"
    return "\n".join([f"rotors = [  # body axes {axes}", *lines, "]"])


def in_layout(layout: str, arm: str) -> str:
    """Write a layout with its arms, TOML, as lines of a mission file."""
    of = "forward and sideways" if layout == "h" else "from the centre of mass to a rotor"
    return f'layout = "{layout}"  # of the rotors\narm = {arm}  # m, {of}'


def text(value: float) -> str:
    """Write a number with four digits."""
    return f"{value:.4g}" if math.isfinite(value) else "nan"


def row(values: Iterable[float]) -> str:
    """Write a row of numbers."""
    return f"[{', '.join(map(text, values))}]"
