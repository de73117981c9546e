"""The questions of `new`: a vehicle, answer by answer, each checked as the mission file would be.

What is not asked follows by similarity: lengths, masses and times of the preset x4-flyer are scaled
to the answers, so that a vehicle of the same shape has the same proof. (Length scales with the
height, mass with the mass, time with √(height/gravity); the inertia and the yaw gain with the arm.)
"""

from __future__ import annotations

import contextlib
import json
import math
import re
import string
import tomllib
from collections.abc import Callable, Iterable
from decimal import Decimal
from fractions import Fraction
from importlib import resources
from typing import NamedTuple

from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.mission.sections import Mission

MODEL = "x4-flyer"
Answers = dict[str, str]


class Question(NamedTuple):
    """What to ask, under which key of the mission, and what Enter stands for."""

    name: str
    key: str
    words: str
    default: Callable[[Answers, Mission], str]


QUESTIONS = (
    Question("name", "name", "name of the mission", lambda a, m: a["name"]),
    Question("mass", "vehicle.mass", "mass, kg", lambda a, m: _text(m.vehicle.mass)),
    Question(
        "arm",
        "vehicle.arm",
        "arm, from the centre of mass to a rotor, m",
        lambda a, m: _text(m.vehicle.arm * _ratio(a["mass"], m.vehicle.mass) ** (1 / 3)),
    ),
    Question(
        "inertia",
        "vehicle.inertia",
        "inertia about x y z, kg m²",
        lambda a, m: _row(i * _inertia_scale(a, m) for i in m.vehicle.inertia),
    ),
    Question(
        "drag_ratio",
        "vehicle.drag_ratio",
        "drag torque of a rotor over its thrust, m",
        lambda a, m: _text(m.vehicle.drag_ratio * _ratio(a["arm"], m.vehicle.arm)),
    ),
    Question("gravity", "vehicle.gravity", "gravity, m/s²", lambda a, m: _text(m.vehicle.gravity)),
    Question(
        "side",
        "target.points",
        "side of the square of four target points, m",
        lambda a, m: _text(_side(m) * _ratio(a["arm"], m.vehicle.arm)),
    ),
    Question(
        "height",
        "goal.height",
        "height to hover at, above the target, m",
        lambda a, m: _text(float(m.goal.height or 0) * _ratio(a["side"], _side(m))),
    ),
    Question(
        "position",
        "start.position",
        "start x y z (world, z down), m",
        lambda a, m: _row(x * _length_scale(a, m) for x in m.start.position),
    ),
)


def interview(
    name: str, ask: Callable[[str], str] = input, say: Callable[[str], None] = print
) -> str:
    """Ask for a vehicle and return its mission as commented TOML.

    Parameters
    ----------
    name : str
        Name of the mission.
    ask, say : callable
        How to ask a question and how to print a line.

    Raises
    ------
    KeyboardInterrupt
        If the user leaves, by Ctrl-C or Ctrl-D.
    """
    with contextlib.suppress(ImportError):  # there is none on Windows
        import readline  # noqa: F401  # lets answers be edited with the arrow keys
    model = load(MODEL)
    answers: Answers = {"name": json.dumps(name)}
    say("Your vehicle, its target and its start. Enter keeps the value in brackets;")
    say("Ctrl-C leaves, with nothing written.")
    for question in QUESTIONS:
        default = question.default(answers, model)
        while True:
            shown = default.strip('"[]')
            try:
                given = ask(f"  {question.words} [{shown}]: ").strip()
            except (EOFError, KeyboardInterrupt):
                say("")
                raise KeyboardInterrupt from None
            answer = _toml(given, like=default) if given else default
            reason = _refusal(question, answer)
            if reason is None:
                answers[question.name] = answer
                break
            say(f"    {reason}")
    template = (resources.files("hoverproof.cli") / "new-mission.toml").read_text(encoding="utf-8")
    return _aligned(string.Template(template).substitute(_completed(answers, model)))


def _refusal(question: Question, answer: str) -> str | None:
    """Say what a mission file would say of this answer; None if nothing."""
    key = question.key
    if question.name == "side":
        try:  # a length above 0, as a height is
            load(MODEL, {"goal.height": answer})
        except InputError as error:
            return error.reason
        answer = _square(answer)
    try:
        load(MODEL, {key: answer})
    except InputError as error:
        return error.reason if error.key.startswith(key) else None
    return None


def _toml(given: str, *, like: str) -> str:
    """Read an answer as what the default is, a name, a number or a row of numbers, if it can be."""
    if like.startswith('"'):
        return json.dumps(given)
    if like.startswith("[") and not given.startswith("["):
        given = "[" + ", ".join(re.split(r"[\s,;]+", given)) + "]"
    try:
        value = tomllib.loads(f"value = {given}", parse_float=Decimal)["value"]
    except (tomllib.TOMLDecodeError, ArithmeticError, ValueError):
        return json.dumps(given)
    entries = value if isinstance(value, list) else [value]
    if not all(type(e) is int or (type(e) is Decimal and e.is_finite()) for e in entries):
        return json.dumps(given)
    return f"[{', '.join(map(str, value))}]" if isinstance(value, list) else str(value)


def _completed(answers: Answers, model: Mission) -> Answers:
    """Add what is not asked: the target's points, and gains and thrust by similarity."""
    length = _length_scale(answers, model)
    mass = _ratio(answers["mass"], model.vehicle.mass)
    pull = _ratio(answers["gravity"], model.vehicle.gravity)
    rate = math.sqrt(pull / length)
    turning = _inertia_scale(answers, model) * rate
    weight = float(Fraction(answers["mass"])) * float(Fraction(answers["gravity"]))
    gains = model.gains
    return {
        **answers,
        "points": _square(answers["side"]),
        "k1": _text(gains.k1 * mass * length * rate),
        "k2": _text(gains.k2 / length),
        "k3": _text(gains.k3 * mass * rate),
        "k4": _text(gains.k4 * mass * rate),
        "k_yaw": _text(gains.k_yaw * turning),
        "thrust": f"[{0.9 * weight:.6g}, {1.1 * weight:.6g}]",
    }


def _square(side: str) -> str:
    half = Fraction(side) / 2
    a, b = f"{float(half)!r}", f"{float(-half)!r}"
    return f"[[{a}, {a}, 0], [{a}, {b}, 0], [{b}, {b}, 0], [{b}, {a}, 0]]"


def _side(model: Mission) -> float:
    across = [float(x) for x, _, _ in model.target.points]
    return max(across) - min(across)


def _ratio(answer: str, of: float | Fraction) -> float:
    return float(Fraction(answer)) / float(of)


def _length_scale(answers: Answers, model: Mission) -> float:
    return _ratio(answers["height"], model.goal.height or 1)


def _inertia_scale(answers: Answers, model: Mission) -> float:
    arm = _ratio(answers["arm"], model.vehicle.arm)
    return _ratio(answers["mass"], model.vehicle.mass) * arm**2


def _text(value: float | Fraction) -> str:
    return f"{float(value):.4g}"


def _row(values: Iterable[float | Fraction]) -> str:
    return f"[{', '.join(map(_text, values))}]"


def _aligned(text: str) -> str:
    """Put the comments behind values under one another."""
    lines = [re.split(r"  (?=# )", line, maxsplit=1) for line in text.splitlines()]
    rows = [f"{row[0]:28}  {row[1]}" if len(row) == 2 else row[0] for row in lines]
    return "\n".join(rows) + "\n"
