"""YAML files of other tools, their numbers as they are written."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

from hoverproof.errors import InputError, in_short

MAX_BYTES = 1_000_000
MAX_DIGITS = 40


def read_yaml(where: str, absent: str = "no such file") -> Any:
    """Return what a YAML or JSON file holds; its decimals are `Fraction`.

    Parameters
    ----------
    where : str
        Path of the file.
    absent : str
        What is said where there is none.

    Raises
    ------
    InputError
        If it cannot be read or is no YAML.
    """
    import yaml

    class Exact(yaml.SafeLoader):  # type: ignore[misc]
        """Reads a number as it is written."""

    Exact.add_constructor(
        "tag:yaml.org,2002:float", lambda loader, node: exact(loader.construct_scalar(node))
    )
    try:
        with Path(where).open("rb") as file:
            held = file.read(MAX_BYTES + 1)
        if len(held) > MAX_BYTES:
            raise InputError(where, "", f"is larger than {MAX_BYTES} bytes")
        text = held.decode("utf-8")
        first, _, rest = text.partition("\n")
        return yaml.load(rest if first.startswith("%YAML:") else text, Loader=Exact)  # a SafeLoader
    except FileNotFoundError:
        raise InputError(where, "", absent) from None
    except OSError as error:
        raise InputError(where, "", f"cannot be read: {error.strerror}") from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputError(where, "", f"is not valid YAML: {in_short(error, 120)}") from None


def exact(value: Any) -> Fraction | None:
    """Return a number as it is written; None if it is none, or too long.

    YAML takes 1e-05, as some tools write it, for a word.

    Parameters
    ----------
    value : object
        As read.
    """
    if isinstance(value, bool) or not isinstance(value, int | Fraction | str):
        return None
    try:
        text = str(value).replace("_", "")
        mantissa, _, exponent = text.lower().partition("e")
        if len(mantissa) > MAX_DIGITS or abs(int(exponent or 0)) > MAX_DIGITS:
            return None
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        return None
