"""The conversation of `new`: asks what was not given, and checks each answer as a mission is."""

from __future__ import annotations

import contextlib
import json
import re
import shlex
import textwrap
import tomllib
from collections.abc import Callable
from decimal import Decimal

from hoverproof.cli.described import comment, products_left_out
from hoverproof.cli.questions import (
    CHOICES,
    LAYOUTS,
    NAMES,
    NONE,
    OWN,
    QUESTIONS,
    START,
    Answers,
    Question,
    placed,
    text,
)
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.mission.target_files import TargetFile
from hoverproof.mission.writing import decimal

MODEL = "x4-flyer"
"""An answer is tried in its place."""
SIDES_OF_TAGS = 0.001, 100.0
"""m: of tags that are printed, or painted on a field."""
SIDES_ABOVE = 0.1, 1000.0
"""Height over the side of the tag: nearer, corners are 82° off the axis; farther, it is a pixel."""
LAW = {"law.feature": "scaled", "law.goal": "inertial", "law.force": "measured"}


def interview(
    given: Answers,
    ask: Callable[[str], str] = input,
    say: Callable[[str], None] = print,
    known: Answers | None = None,
) -> Answers:
    """Ask all that is not given, and return the answers as TOML.

    Parameters
    ----------
    given : dict
        Answers that were given as options.
    ask, say : callable
        How to ask a question and how to print a line.
    known : dict, optional
        What a target file answers: see `answers_of_target`.

    Raises
    ------
    KeyboardInterrupt
        If the user leaves, by Ctrl-C or Ctrl-D.
    """
    alone = {name: answer for name, answer in given.items() if name != "height"}  # of a tag
    without_asking(alone, known)  # what cannot be used is refused before anything is asked
    with contextlib.suppress(ImportError):  # there is none on Windows
        import readline  # noqa: F401  # lets answers be edited with the arrow keys
    say("Your vehicle, its tag, its camera and its start. Enter keeps the value in brackets;")
    say("Ctrl-C leaves, with nothing written.")
    for line in (known or {}).get("target", "").splitlines():
        say(f"  target: {line.removeprefix('# ')}")

    def asked(question: Question, default: str, answers: Answers) -> str:
        return asked_once(question, default, answers, ask, say)

    return _answered(given, asked, known or {})


def asked_once(
    question: Question,
    default: str,
    before: Answers,
    ask: Callable[[str], str] = input,
    say: Callable[[str], None] = print,
) -> str:
    """Ask one question until the answer can be used, and return it as TOML.

    Parameters
    ----------
    question : Question
    default : str
        What Enter stands for, TOML.
    before : dict
        The answers before it.
    ask, say : callable
        See `interview`.

    Raises
    ------
    KeyboardInterrupt
        If the user leaves, by Ctrl-C or Ctrl-D.
    """
    while True:
        shown = default.strip('"[]')
        try:
            typed = ask(f"  {question.words} [{shown}]: ").strip()
        except UnicodeDecodeError:
            say("    what was typed is not text in the encoding of this terminal")
            continue
        except (EOFError, KeyboardInterrupt):
            say("")
            raise KeyboardInterrupt from None
        answer = _toml(question, typed, default) if typed else default
        reason = refusal(question, answer, before)
        if reason is None:
            return answer
        say(f"    {reason}")


def without_asking(
    given: Answers,
    known: Answers | None = None,
    assumed: list[str] | None = None,
) -> Answers:
    """Return the answers as TOML, defaults where none is given.

    Parameters
    ----------
    given : dict
        Answers that were given as options.
    known : dict, optional
        What a target file answers: see `answers_of_target`.
    assumed : list of str, optional
        Gets what nobody said, in words, but for what an answer of none leaves out.
    """

    def assume(question: Question, default: str, answers: Answers) -> str:
        if assumed is not None and default not in (f'"{OWN}"', f'"{NONE}"'):
            assumed.append(question.assumed(default))
        return default

    return _answered(given, assume, known or {})


def start_again(
    reason: str,
    held: str,
    before: Answers,
    ask: Callable[[str], str] = input,
    say: Callable[[str], None] = print,
) -> str:
    """Ask for the start once more, after it was refused, and return it as TOML.

    Parameters
    ----------
    reason : str
        Why it was refused.
    held : str
        A start that is held, TOML: what Enter stands for.
    before : dict
        All answers.
    ask, say : callable
        See `interview`.
    """
    for line in textwrap.wrap(reason, 80, initial_indent="  ", subsequent_indent="    "):
        say(line)
    return asked_once(START, held, before, ask, say)


def say_as_options(
    answers: Answers, given: Answers, known: Answers, say: Callable[[str], None] = print
) -> None:
    """Say the options that give the same answers, but for what a file tells.

    Parameters
    ----------
    answers : dict
        Of `interview`, as TOML.
    given, known : dict
        See `interview`.
    say : callable
        How to print a line.
    """
    source = json.loads(answers["vehicle"])
    told = {*known, *({} if source == OWN else _known(source))} - given.keys()
    names = [question.name for question in QUESTIONS if question.name not in told]
    words = (f"--{name.replace('_', '-')}={answers[name].strip(chr(34))}" for name in names)
    say("  The same answers as options, of which one may be changed:")
    say(f"  {shlex.join(words)}")


def answers_of_target(found: TargetFile) -> Answers:
    """Return what a target file answers: its points, what they are, and its side, m.

    Parameters
    ----------
    found : TargetFile
    """
    said = textwrap.wrap("; ".join(found.words), 96, break_long_words=False)
    return {
        "tag": text(float(found.side)),
        "points": points_text(found),
        "target": "\n".join(f"# {line}" for line in said),
    }


def points_text(found: TargetFile) -> str:
    """Write the points of a target as TOML, four on a line.

    Parameters
    ----------
    found : TargetFile
    """
    rows = [f"[{', '.join(map(decimal, point))}]" for point in found.points]
    if len(rows) <= 4:
        return f"[{', '.join(rows)}]"
    lines = [", ".join(rows[i : i + 4]) for i in range(0, len(rows), 4)]
    return "[\n" + "".join(f"  {line},\n" for line in lines) + "]"


def _answered(
    given: Answers, asked: Callable[[Question, str, Answers], str], known: Answers
) -> Answers:
    """Go through the questions: what is given, what is known of the vehicle, and what is asked."""
    answers: Answers = dict(known)
    for question in QUESTIONS:
        name = question.name
        if name in given:
            answers[name] = _toml(question, given[name], question.default(answers))
            if (reason := refusal(question, answers[name], answers)) is not None:
                raise InputError(f"--{name.replace('_', '-')}", "", reason)
            if name in ("layout", "rotor_distance"):
                answers.pop("placed", None)
        elif name not in answers:
            answers[name] = asked(question, question.default(answers), answers)
        if name == "vehicle" and json.loads(answers[name]) != OWN:
            answers |= {
                n: t for n, t in _known(json.loads(answers[name])).items() if n not in given
            }
    return answers


def _known(source: str) -> Answers:
    """Return the answers that the vehicle of a mission gives."""
    mission = load(source)
    vehicle, lag = mission.vehicle, mission.uncertainty.rotor_lag or mission.rotors.time_constant
    aside = vehicle.products
    said = comment(f"Of {source} {products_left_out(map(float, aside))}") if aside else ""
    known = {
        "mass": decimal(vehicle.mass),
        "layout": json.dumps(vehicle.layout if vehicle.layout in LAYOUTS else "x"),
        "rotor_distance": text(vehicle.distance),
        "placed": said + placed(vehicle),
        "inertia": f"[{', '.join(map(decimal, vehicle.inertia))}]",
        "drag_ratio": decimal(vehicle.drag_ratio),
        "gravity": decimal(vehicle.gravity),
    }
    return known | ({"rotor_lag": decimal(lag)} if lag else {})


def refusal(question: Question, answer: str, before: Answers) -> str | None:
    """Say what a mission file would say of this answer, or why nobody sees by it; None if nothing.

    Parameters
    ----------
    question : Question
    answer : str
        TOML.
    before : dict
        The answers before it.
    """
    key = question.key
    if question.name == "vehicle":
        return None if answer == f'"{OWN}"' else _unreadable(json.loads(answer))
    if names := CHOICES.get(question.name):
        named = json.loads(answer)
        return None if named in names else f"must be one of {', '.join(names)}, not {named!r:.40}"
    if question.name == "half_angle" and answer == f'"{NONE}"':
        return None
    if question.name == "tag":  # a length above 0, as a height is
        key, points = "goal.height", "[[1e-7, 0, 0], [-1e-7, 0, 0]]"
        low, high = SIDES_OF_TAGS
        reason = _refused({"target.points": points, key: answer}, key)
        return reason or (
            None
            if low <= float(answer) <= high
            else f"must be from {low:g} to {high:g} m, not {answer}"
        )
    reason = _refused({key: answer}, key)
    if question.name == "height" and reason is None:
        least, most = (sides * float(before["tag"]) for sides in SIDES_ABOVE)
        if not least <= float(answer) <= most:
            low, high = SIDES_ABOVE
            reason = f"must be from {low:g} to {high:g} sides of the tag, {least:g} to {most:g} m, "
            reason += f"not {answer}"
    return reason


def _refused(settings: Answers, key: str) -> str | None:
    try:
        load(MODEL, LAW | settings)
    except InputError as error:
        return error.reason if error.key.startswith(key) else None
    return None


def _unreadable(source: str) -> str | None:
    try:
        load(source)
    except InputError as error:
        return error.reason
    return None


def _toml(question: Question, given: str, like: str) -> str:
    """Read an answer as what the default is, a name, a number or a row of numbers, if it can be."""
    if question.name in NAMES or (like.startswith('"') and not re.match(r"[-+.\d]", given)):
        return json.dumps(given)
    if like.startswith("[") and not given.startswith("["):
        given = "[" + ", ".join(re.split(r"[\s,;]+", given.strip())) + "]"
    try:
        value = tomllib.loads(f"value = {given}", parse_float=Decimal)["value"]
    except (tomllib.TOMLDecodeError, ArithmeticError, ValueError):
        return json.dumps(given)
    entries = value if isinstance(value, list) else [value]
    if not all(type(e) is int or (type(e) is Decimal and e.is_finite()) for e in entries):
        return json.dumps(given)
    return f"[{', '.join(map(str, value))}]" if isinstance(value, list) else str(value)
