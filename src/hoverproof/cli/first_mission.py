"""What `new` decides from the answers, and the mission that it writes of them."""

from __future__ import annotations

import json
import math
import re
import string
from collections.abc import Callable, Sequence
from fractions import Fraction
from importlib import resources
from pathlib import Path

import numpy as np

from hoverproof.algebra.decimals import decimal_above
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.proof import candidate
from hoverproof.certification.exponential.question import HIGHEST, ROOM
from hoverproof.cli.described import comment
from hoverproof.cli.questions import CONTROL_RATES, NONE, Answers, in_layout, row
from hoverproof.design.limits import designed_gains
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.mission.sections import Mission
from hoverproof.mission.task import Gains
from hoverproof.mission.writing import decimal
from hoverproof.plausibility import TOLERATED, warnings

Progress = Callable[[str], None]
GRAVITY = "9.81"
RATES = 0.019, 0.14, 0.156, 1.0
"""j k1/m, k1 k2/m, k3/m and k4/m over the last: those of the half-kilogram example, tuned."""
WAITS = 1.5
"""The last of them times latency and lag of the rotors is at most that."""
FORCE = 0.05
"""And the force that the way from the start asks for at most that share of the weight."""
OF_CONTROL = 0.18
"""And all of them together at most that share of the control rate."""
QUICKEST = 40.0
"""1/s."""
SLOWER = 1.0, 0.7, 0.5, 0.35, 0.25, 0.17, 0.12
NEARER = 0.8, 0.6, 0.4, 0.2


class NotHeldError(InputError):
    """No gains are found that hold a start.

    Parameters
    ----------
    reason : str
        With what would help.
    held : str or None
        A start that is held, on the way to the goal, m, as TOML.
    """

    def __init__(self, reason: str, held: str | None) -> None:
        super().__init__("start", "", f"no gains were found that hold it: {reason}")
        self.held = held


def decided(name: str, answers: Answers) -> Answers:
    """Return what a mission file says, but for the gains.

    Parameters
    ----------
    name : str
        Of the mission.
    answers : dict
        As TOML.
    """
    mass, gravity = Fraction(answers["mass"]), Fraction(answers.get("gravity", GRAVITY))
    frames, control = (
        Fraction(answers["frame_rate"]),
        CONTROL_RATES[json.loads(answers["autopilot"])],
    )
    age = Fraction(answers["latency"]) + 1 / frames + (Fraction(1, control) if control else 0)
    weight = float(mass * gravity)
    half = None if answers["half_angle"] == f'"{NONE}"' else answers["half_angle"]
    return answers | {
        "assumed": "",
        "name": json.dumps(name),
        "placed": answers.get(
            "placed", in_layout(json.loads(answers["layout"]), answers["rotor_distance"])
        ),
        "gravity": decimal(gravity),
        "points": answers.get("points", _square(answers["tag"])),
        "target": answers.get("target", f"# Corners of a square tag of side {answers['tag']} m."),
        "bounds": f"[{0.9 * weight:.6g}, {1.1 * weight:.6g}]",
        "age": decimal(decimal_above(age, 3)),
        "aging": f"latency, frame{' and control' if control else ''} period",
        "camera": f"{_off(half)}[camera]\n{_off(half)}half_angle = {half or 0.7}",
        "control": f"{_off(control)}control_rate = {control or 400}",
    }


def _off(answer: str | int | None) -> str:
    return "" if answer else "# "


def first_gains(mission: Mission) -> Mission | None:
    """Return a mission with gains that are found to hold its start; None if there are none.

    Gains over mass are rates, 1/s, in fixed proportions. The quickest that are tried suit latency
    and rotors, the force that the way from the start takes, and the rate of the control.

    Parameters
    ----------
    mission : Mission
        Its gains do not count.
    """
    near, scene = None, Scene.of(mission)
    start = np.array([[float(c) for c in mission.start.position]])
    if np.linalg.norm(scene.offset(start)) >= HIGHEST * scene.wanted:
        return None  # J is bounded no further, whatever the gains
    for slower in SLOWER:
        tried = mission.model_copy(update={"gains": _gains(mission, slower * _quickest(mission))})
        found = candidate(tried, (Start.of(tried),), near)
        if found is not None and found.solution.fill < 1 - ROOM:
            return tried
        near = near if found is None else found.x
    return None


def _quickest(mission: Mission) -> float:
    """Return k4/m, 1/s."""
    covered, rate = mission.uncertainty, mission.sensors.control_rate
    height = float(mission.goal.height or 0)
    x, y, z = (float(c) for c in mission.start.position)
    way = max(math.hypot(x, y, z + height), 0.1 * height)
    ends = [
        QUICKEST,
        math.sqrt(FORCE * float(mission.vehicle.gravity) / (way * RATES[0] * RATES[1])),
    ]
    if wait := float(covered.latency + covered.rotor_lag):
        ends.append(WAITS / wait)
    if rate:
        ends.append(OF_CONTROL * float(rate) / sum(RATES[1:]))
    return min(ends)


def _gains(mission: Mission, quick: float) -> Gains:
    """Return gains whose last rate is given, 1/s, rounded to two digits."""
    mass = float(mission.vehicle.mass)
    flat = [[float(c) for c in point[:2]] for point in mission.target.points]
    size = math.sqrt(sum(x * x + y * y for x, y in flat) / len(flat))  # near the hover J is I/size
    slow, pull, force, turn = (rate * quick for rate in RATES)
    k1 = _two(mass * slow * size)
    four = k1, _two(mass * pull / float(k1)), _two(mass * force), _two(mass * turn)
    return designed_gains(mission, four, pull + force + turn)


def _two(value: float) -> Fraction:
    return Fraction(f"{value:.2g}")


def written(decisions: Answers, gains: Gains | None = None) -> str:
    """Return a mission as commented TOML.

    Parameters
    ----------
    decisions : dict
        Of `decided`.
    gains : Gains, optional
        By default ones, in their units.
    """
    template = (resources.files("hoverproof.cli") / "new-mission.toml").read_text(encoding="utf-8")
    values = dict.fromkeys(Gains.model_fields, "1")
    if gains is not None:
        values |= {name: decimal(value) for name, value in gains}
    return _aligned(string.Template(template).substitute(decisions | values))


def make(
    path: Path,
    name: str,
    answers: Answers,
    assumed: Sequence[str] = (),
    tell: Progress = lambda text: None,
) -> str:
    """Return the mission of some answers, with gains that are found to hold its start.

    Parameters
    ----------
    path : Path
        A file to write to on the way.
    name : str
        Of the mission.
    answers : dict
        As TOML.
    assumed : sequence of str
        Which of them nobody gave, in words.
    tell : callable
        Is told what is being done.

    Raises
    ------
    NotHeldError
        If no gains are found that hold the start.
    InputError
        If the answers do not go together.
    """
    told = f"Assumed by `hoverproof new`, as nobody said them: {', '.join(assumed)}"
    decisions = decided(name, answers) | ({"assumed": comment(told)} if assumed else {})
    path.write_text(written(decisions), encoding="utf-8", newline="\n")
    mission = load(path)
    _require_possible(mission)
    tell("looking for gains that hold the start")
    held = first_gains(mission)
    if held is None:
        raise _not_held(mission, tell)
    return written(decisions, held.gains)


def _require_possible(mission: Mission) -> None:
    """Refuse what no gains can make up for, before any are looked for."""
    for finding in warnings(mission):
        if finding.name == TOLERATED:
            raise InputError(finding.key, "", finding.reason)
    half, scene = mission.camera.about_vertical, Scene.of(mission)
    seen = float(scene.angles(scene.goal[None])[0])
    if half is not None and half < seen:
        reason = f"{float(half):g} rad does not see the target at the goal, {seen:.3g} rad does"
        raise InputError("camera.half_angle", "", f"{reason}; wider lenses see more of the way")


def _not_held(mission: Mission, tell: Progress) -> NotHeldError:
    """Say which start would be held, if one on the way is, and whether the lens binds."""
    x, y, z = mission.start.position
    goal = -(mission.goal.height or Fraction(0))
    for part in NEARER:
        tell(f"looking for a start that is held, {100 * (1 - part):.0f} % nearer")
        share = Fraction(part)
        place = [share * x, share * y, goal + share * (z - goal)]
        start = mission.start.model_copy(update={"position": tuple(map(_four, place))})
        if first_gains(mission.model_copy(update={"start": start})) is not None:
            held = row(map(float, start.position))
            nearer = f"{held} would be held, {100 * (1 - part):.0f} % nearer to the goal"
            return NotHeldError(nearer + _lens_binds(mission), held)
    covered = ", ".join(mission.asks_to_cover())
    near = f"{100 * (1 - NEARER[-1]):.0f} % nearer to the goal"
    none = f"nor would one {near} be held; smaller tolerances would help: {covered}"
    return NotHeldError(none + _lens_binds(mission), None)


def _lens_binds(mission: Mission) -> str:
    """Say that a wider lens would do, if it would."""
    half = mission.camera.half_angle
    anyhow = mission.model_copy(
        update={"camera": mission.camera.model_copy(update={"half_angle": None})}
    )
    if half is None or first_gains(anyhow) is None:
        return ""
    return f"; a lens that sees further than {float(half):g} rad (--half-angle) would hold it"


def _four(value: Fraction) -> Fraction:
    return Fraction(f"{float(value):.4g}")


def _square(side: str) -> str:
    a, b = decimal(Fraction(side) / 2), decimal(-Fraction(side) / 2)
    return f"[[{a}, {a}, 0], [{a}, {b}, 0], [{b}, {b}, 0], [{b}, {a}, 0]]"


def _aligned(text: str) -> str:
    """Put the comments behind values under one another."""
    lines = [re.split(r"  (?=# )", line, maxsplit=1) for line in text.splitlines()]
    rows = [f"{row[0]:28}  {row[1]}" if len(row) == 2 else row[0] for row in lines]
    return "\n".join(rows) + "\n"
