"""Numbers with a unit and a range, as a mission file holds them: what pydantic is told of them."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from pydantic import BaseModel, BeforeValidator, ConfigDict
from pydantic_core import PydanticCustomError

LEAST = "1e-12"
"""The least that a positive quantity is, in the units of a mission file: far below anything built,
and far above what floating point, which looks for proofs, takes for zero."""

MAX_DIGITS = 40


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
        return f"{float(value):g}"
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
    longest = 10**MAX_DIGITS
    suffix = f" {unit}" if unit else ""
    span = f"above {low} and at most {high}" if open_low else f"from {low} to {high}"

    def exact(value: object) -> Fraction:
        if isinstance(value, bool) or not isinstance(value, int | Fraction | float):
            raise reject(f"must be a number{f' in {unit}' if unit else ''}, not {shown(value)}")
        if isinstance(value, float) and not -1e308 < value < 1e308:
            raise reject(f"must be a number {span}{suffix}, not {value}")
        number = Fraction(value)
        if not lowest <= number <= highest or (open_low and number == lowest):
            raise reject(f"must be {span}{suffix}, not {shown(value)}")
        if open_low and number < lowest + Fraction(least):
            raise reject(f"must be from {least} to {high}{suffix}, not {shown(value)}")
        if max(abs(number.numerator), number.denominator) > longest:
            raise reject(f"must be a number of at most {MAX_DIGITS} digits, not {shown(value)}")
        return number

    return BeforeValidator(exact)


def array(*names: str) -> Callable[[object], object]:
    """Return a validator that wants one entry for each name.

    Parameters
    ----------
    *names : str
        Of the entries, as shown in messages.
    """

    def check(value: object) -> object:
        if not isinstance(value, list | tuple) or len(value) != len(names):
            raise reject(f"must be a list [{', '.join(names)}], not {shown(value)}")
        return tuple(value)

    return check


class Section(BaseModel):
    """A section of a mission file: frozen, and no key but those it names."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)
