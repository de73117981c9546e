"""Numbers with a unit and a range, as a mission file holds them: what pydantic is told of them."""

from __future__ import annotations

import sys
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from pydantic import BaseModel, BeforeValidator, ConfigDict
from pydantic_core import PydanticCustomError

MAX_DIGITS = 32
"""Of numerator and denominator; what follows from them must be short enough for the checker."""
LEAST = "1e-12"
"""The least that a positive quantity is, in the units of a mission file: far below anything built,
and far above what floating point, which looks for proofs, takes for zero."""


def reject(reason: str, *, key: str = "") -> PydanticCustomError:
    """Make the refusal of a value, or of the `key` below it.

    Parameters
    ----------
    reason : str
        What is wrong, for the user to read.
    key : str
        Empty for the value itself.
    """
    return PydanticCustomError("mission", "{reason}", {"reason": reason, "key": key})


def shown(value: object) -> str:
    """Write a value as it stands in a message.

    Parameters
    ----------
    value : object
        As read from a mission file.
    """
    if isinstance(value, Fraction):
        beyond = abs(value) > sys.float_info.max
        return f"a number beyond {'-' * (value < 0)}1e308" if beyond else f"{float(value):.12g}"
    if isinstance(value, list):
        return f"[{', '.join(map(shown, value))}]" if len(value) < 8 else f"{len(value)} entries"
    if isinstance(value, dict):
        return "a section"
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def quantity(
    unit: str, low: str, high: str, *, open_low: bool = False, least: str = LEAST
) -> BeforeValidator:
    """Accept an exact number in [low, high] (or in [least, high], if open_low).

    Parameters
    ----------
    unit : str
        Shown in messages; empty for a dimensionless number.
    low, high : str
        Ends of the range in that unit, as exact decimals.
    open_low : bool
        Whether `low` itself is refused, and what is nearer to it than `least`.
    least : str
        The least that counts, in that unit.
    """
    lowest, highest = Fraction(low), Fraction(high)
    suffix = f" {unit}" if unit else ""
    span = f"above {low} and at most {high}" if open_low else f"from {low} to {high}"

    def exact(value: object) -> Fraction:
        if isinstance(value, bool) or not isinstance(value, int | Fraction | float):
            kind = suffix if unit.startswith("(") else unit and f" in {unit}"
            raise reject(f"must be a number{kind}, not {shown(value)}")
        if isinstance(value, float) and not -1e308 < value < 1e308:
            raise reject(f"must be a number {span}{suffix}, not {value}")
        number = Fraction(value)
        if not lowest <= number <= highest or (open_low and number == lowest):
            raise reject(f"must be {span}{suffix}, not {shown(value)}")
        if open_low and number < lowest + Fraction(least):
            raise reject(f"must be from {least} to {high}{suffix}, not {shown(value)}")
        if max(abs(number.numerator), number.denominator) >= 10**MAX_DIGITS:
            raise reject(f"must be given in at most {MAX_DIGITS} digits, not {shown(value)}")
        return number

    return BeforeValidator(exact)


def array(*names: str, instead: str = "") -> Callable[[object], object]:
    """Return a validator that wants one entry for each name.

    Parameters
    ----------
    *names : str
        Of the entries, as shown in messages.
    instead : str
        A word that is taken in place of the list, by another validator.
    """
    word = f'"{instead}" or ' if instead else ""

    def check(value: object) -> object:
        if not isinstance(value, list | tuple) or len(value) != len(names):
            raise reject(f"must be {word}a list [{', '.join(names)}], not {shown(value)}")
        return tuple(value)

    return check


def list_of(what: str) -> Callable[[object], object]:
    """Return a validator that wants a list of numbers.

    Parameters
    ----------
    what : str
        What they are, as shown in messages.
    """

    def check(value: object) -> object:
        if not isinstance(value, list | tuple):
            raise reject(f"must be a list of {what}, one number for each point, not {shown(value)}")
        return list(value)

    return check


def one_of(*words: str) -> BeforeValidator:
    """Accept one of some words.

    Parameters
    ----------
    *words : str
    """

    def check(value: object) -> object:
        if value not in words:
            raise reject(f"must be {' or '.join(map(repr, words))}, not {shown(value)}")
        return value

    return BeforeValidator(check)


def true_or_false() -> BeforeValidator:
    """Accept true and false, and nothing that stands for them."""

    def check(value: object) -> object:
        if not isinstance(value, bool):
            raise reject(f"must be true or false, not {shown(value)}")
        return value

    return BeforeValidator(check)


_OF_THE_LIBRARY = {name for name in dir(BaseModel) if not name.startswith("__")}


class Section(BaseModel):
    """A section of a mission file: frozen, and no key but those it names."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)

    def __dir__(self) -> list[str]:
        """Return what a section is for, without what its making takes."""
        return [name for name in super().__dir__() if name not in _OF_THE_LIBRARY]


def as_text(value: Any) -> Any:
    """Write all numbers of nested dicts and lists as strings.

    Parameters
    ----------
    value : object
    """
    if isinstance(value, dict):
        return {key: as_text(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [as_text(entry) for entry in value]
    return str(value).lower() if isinstance(value, bool) else str(value)
