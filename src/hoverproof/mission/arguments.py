"""What the public functions are given, held against what they say that they take.

The words of an annotation are enough: ``bool``, ``int``, ``float``, ``str``, what can be called or
gone through, and some classes. What a number may be, and which names there are, is for the
functions to say.
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable, Mapping
from numbers import Integral, Real
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from hoverproof.errors import InputError

_P = ParamSpec("_P")
_R = TypeVar("_R")


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def _is_whole(value: object) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)


def _is_many(value: object) -> bool:
    return isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)


def _is_a(name: str) -> Callable[[object], bool]:
    """Tell a class by its name, without importing it."""
    return lambda value: any(kind.__name__ == name for kind in type(value).__mro__)


Told = tuple[Callable[[object], bool], str]
FLOAT = "a finite number"
CALLED: Told = callable, "something to call"
MANY: Told = _is_many, "a list or a tuple"
KINDS: dict[str, Told] = {
    "bool": (lambda value: isinstance(value, bool), "True or False"),
    "int": (_is_whole, "a whole number"),
    "float": (lambda value: isinstance(value, float | Integral) and _is_number(value), FLOAT),
    "str": (lambda value: isinstance(value, str), "text"),
    "Path": (lambda value: isinstance(value, Path), "a path"),
    "Fraction": (_is_number, FLOAT),
    "None": (lambda value: value is None, "None"),
    **dict.fromkeys(("Callable", "Progress", "Report", "Show"), CALLED),
    **dict.fromkeys(("Sequence", "Collection", "Iterable", "tuple", "Box"), MANY),
    **{
        name: (_is_a(name), f"of the class {name}")
        for name in ("Axis", "Enclosure", "Firmware", "Law", "Start", "Wish")
    },
}
"""By the first word of an annotation: how it is told, and what to give, in words."""


def checked(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Refuse arguments that are not of the kind that a function takes, see `require_arguments`.

    Parameters
    ----------
    function : callable
        With annotations that are not evaluated.
    """

    @functools.wraps(function)
    def called(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        require_arguments(function, args, kwargs)
        return function(*args, **kwargs)

    return called


def require_arguments(function: Callable[..., Any], args: tuple[Any, ...], kwargs: Any) -> None:
    """Refuse arguments that are not of the kind that a function takes.

    Parameters
    ----------
    function : callable
        With annotations that are not evaluated.
    args, kwargs
        What it is to be called with.

    Raises
    ------
    InputError
        Which names the argument and what would be right.
    TypeError
        If there are too many arguments, too few, or ones with other names.
    """
    asked = inspect.signature(function)
    for name, value in asked.bind(*args, **kwargs).arguments.items():
        kinds = str(asked.parameters[name].annotation).split(" | ")
        told = [KINDS.get(kind.split("[")[0]) for kind in kinds]
        if None in told or any(_fits(kind, value) for kind in kinds):
            continue
        right = " or ".join(_words(kind) for kind in kinds)
        raise InputError(f"--{name.replace('_', '-')}", "", f"must be {right}, not {value!r:.80}")


def _parts(kind: str) -> str | None:
    """Return of what kind the parts of a sequence are: of the one that it names, if it is known."""
    outer, _, inner = kind.partition("[")
    part = inner.rstrip("]").split(",")[0]
    return part if KINDS[outer] is MANY and part in KINDS else None


def _fits(kind: str, value: Any) -> bool:
    tells, _ = KINDS[kind.split("[")[0]]
    part = _parts(kind)
    return tells(value) and (part is None or all(KINDS[part][0](one) for one in value))


def _words(kind: str) -> str:
    part, (_, right) = _parts(kind), KINDS[kind.split("[")[0]]
    return right if part is None else f"{right}, each {KINDS[part][1]}"
