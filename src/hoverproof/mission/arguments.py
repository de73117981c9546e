"""What the public functions are given, taken as what they say that they take, or refused.

The words of an annotation are enough: ``bool``, ``int``, ``float``, ``str``, what can be called or
gone through, and some classes. A number may be one of numpy or a decimal, and a sequence an array.
What a number may be, and which names there are, is for the functions to say.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping
from decimal import Decimal
from numbers import Integral, Real
from pathlib import Path
from typing import Any, NamedTuple, ParamSpec, TypeVar

from hoverproof.errors import InputError
from hoverproof.mission.exact import exact

_P = ParamSpec("_P")
_R = TypeVar("_R")


class Kind(NamedTuple):
    """What an argument may be.

    Attributes
    ----------
    take : callable
        Returns a value of that kind; raises ValueError if it cannot be taken for one.
    words : str
        What to give.
    """

    take: Callable[[Any], Any]
    words: str


def _if(fits: Callable[[Any], bool], make: Callable[[Any], Any] = lambda value: value) -> Any:
    """Return what takes a value that fits, as what is made of it."""

    def take(value: Any) -> Any:
        if not fits(value):
            raise ValueError
        return make(value)

    return take


def _is_a(*names: str) -> Callable[[Any], bool]:
    """Tell a class by its name, without importing it."""
    return lambda value: any(kind.__name__ in names for kind in type(value).__mro__)


def _is_number(value: object) -> bool:
    return isinstance(value, Real | Decimal) and not isinstance(value, bool)


CALLED = Kind(_if(callable), "something to call")
MANY = Kind(
    _if(lambda value: isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)),
    "a list or a tuple",
)
KINDS: dict[str, Kind] = {
    "bool": Kind(_if(_is_a("bool", "bool_"), bool), "True or False"),
    "int": Kind(
        _if(lambda value: isinstance(value, Integral) and not isinstance(value, bool), int),
        "a whole number",
    ),
    "float": Kind(_if(_is_number, lambda value: float(exact(value))), "a finite number"),
    "Fraction": Kind(_if(_is_number, exact), "a finite number"),
    "str": Kind(_if(lambda value: isinstance(value, str)), "text"),
    "Path": Kind(_if(lambda value: isinstance(value, Path)), "a path"),
    "None": Kind(_if(lambda value: value is None), "None"),
    "dict": Kind(_if(lambda value: isinstance(value, Mapping)), "a dictionary"),
    **dict.fromkeys(("Callable", "Progress", "Report", "Show"), CALLED),
    **dict.fromkeys(("Sequence", "Collection", "Iterable", "tuple", "Box"), MANY),
    **{
        name: Kind(_if(_is_a(name)), f"of the class {name}")
        for name in ("Axis", "Certificate", "Enclosure", "Firmware", "Law", "Start", "Wish")
    },
}
"""By the first word of an annotation."""


def checked(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Take arguments for what a function says that it takes, see `taken`.

    Parameters
    ----------
    function : callable
        With annotations that are not evaluated.
    """

    @functools.wraps(function)
    def called(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        bound = taken(function, args, kwargs)
        return function(*bound.args, **bound.kwargs)

    return called


def taken(
    function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]
) -> inspect.BoundArguments:
    """Return arguments as what a function says that it takes: an int of numpy as an int.

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
    bound = asked.bind(*args, **kwargs)
    for name, value in bound.arguments.items():
        kinds = str(asked.parameters[name].annotation).split(" | ")
        if all(kind.split("[")[0] in KINDS for kind in kinds):
            bound.arguments[name] = _as_one_of(kinds, value, name)
    return bound


def _as_one_of(kinds: list[str], value: Any, name: str) -> Any:
    if isinstance(value, Iterator):
        value = tuple(value)  # it can be gone through once
    for kind in kinds:
        with contextlib.suppress(ValueError, OverflowError):
            return _as(kind, value)
    right = " or ".join(map(_words, kinds))
    raise InputError(f"--{name.replace('_', '-')}", "", f"must be {right}, not {value!r:.80}")


def _as(kind: str, value: Any) -> Any:
    part, made = _part(kind), KINDS[kind.split("[")[0]].take(value)
    return made if part is None else tuple(map(part.take, made))


def _part(kind: str) -> Kind | None:
    """Return of what kind the parts of a sequence are: the one that it names, if it is known."""
    outer, _, inner = kind.partition("[")
    return KINDS.get(inner.rstrip("]").split(",")[0]) if KINDS[outer] is MANY else None


def _words(kind: str) -> str:
    part, right = _part(kind), KINDS[kind.split("[")[0]].words
    return right if part is None else f"{right}, each {part.words}"
