"""What is derived is kept from one process to the next, beside the compiled loops.

A thing is found again by all that it is made from: the sources of algebra, plant, servo and of the
package of its maker, the arguments, and the version of CasADi. Files are written whole; one that is
damaged, or cannot be read or written, costs the time to derive anew and nothing else.
"""

from __future__ import annotations

import functools
import hashlib
import json
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import ParamSpec, TypeVar, cast

import casadi as ca

from hoverproof.files import cache_folder, keep, kept

Given = ParamSpec("Given")
Made = TypeVar("Made")

HOUSE = Path(__file__).parent.parent
BELOW = tuple(HOUSE / name for name in ("algebra", "plant", "servo"))
CONSTANTS = "hoverproof.servo."
"""Modules whose constants, alone or in a dict, may be arguments: their sources are read below."""
SOURCES = {".py", ".c", ".h"}


def kept_graph(make: Callable[Given, ca.Function]) -> Callable[Given, ca.Function]:
    """Keep the SX functions that a function of whole numbers and words makes.

    Parameters
    ----------
    make : callable
        What it makes may depend on its arguments and on the sources alone. With arguments that are
        neither numbers, words and tuples of them nor constants of `servo`, nothing is kept but in
        the process.
    """
    return _kept(make, ca.Function.serialize, ca.Function.deserialize)


def kept_json(make: Callable[Given, Made]) -> Callable[Given, Made]:
    """Keep what a function of whole numbers and words makes: strings, numbers, lists of them.

    Parameters
    ----------
    make : callable
        See `kept_graph`.
    """
    return _kept(make, json.dumps, json.loads)


def _kept(
    make: Callable[Given, Made], encode: Callable[[Made], str], decode: Callable[[str], Made]
) -> Callable[Given, Made]:
    def get(*args: Given.args, **kwargs: Given.kwargs) -> Made:
        path = None if kwargs else _place(make, args)
        if path is None:
            return make(*args, **kwargs)
        text = kept(path)
        if text is not None:
            return decode(text.decode())
        made = make(*args, **kwargs)
        keep(path, encode(made).encode())
        return made

    return cast(Callable[Given, Made], functools.wraps(make)(functools.cache(get)))


def _place(make: Callable[..., object], args: tuple[object, ...]) -> Path | None:
    """Return where the result of a call is kept; None if it cannot be told apart from others."""
    sources, words = _sources(make.__module__), [_word(a) for a in args]
    if sources is None or None in words:
        return None
    parts = (make.__module__, make.__qualname__, words, ca.CasadiMeta.version(), sources)
    digest = hashlib.sha256(repr(parts).encode()).hexdigest()[:32]
    return cache_folder() / f"{make.__name__.strip('_')}-{digest}.derived"


def _word(argument: object) -> str | None:
    """Return what stands for an argument; None if it is no number, word or constant below."""
    if type(argument) in (int, str, Fraction):
        return repr(argument)
    if isinstance(argument, tuple):
        words = [_word(entry) for entry in argument]
        return None if None in words else f"{type(argument).__name__}{words}"
    for name in sorted(sys.modules):  # a law, where its source is: that is in the key
        if name.startswith(CONSTANTS):
            for constant, value in vars(sys.modules[name]).items():
                if value is argument:
                    return f"{name}.{constant}"
                for key, entry in value.items() if isinstance(value, dict) else ():
                    if entry is argument:
                        return f"{name}.{constant}[{key!r}]"
    return None


@functools.cache
def _sources(module: str) -> str | None:
    """Return a digest of what a module's graphs are derived from; None if it is not to be read."""
    own = Path(sys.modules[module].__file__ or "")
    try:
        parts = [_content(folder) for folder in dict.fromkeys([*BELOW, own.parent])]
    except OSError:
        return None
    found = frozenset().union(*(paths for _, paths in parts))
    return " ".join(digest for digest, _ in parts) if {own, Path(__file__)} <= found else None


@functools.cache
def _content(folder: Path) -> tuple[str, frozenset[Path]]:
    """Return a digest of the sources in a folder, and where they are; read once for all makers."""
    digest, paths = hashlib.sha256(), sorted(p for p in folder.rglob("*") if p.suffix in SOURCES)
    for path in paths:
        content = path.read_bytes()
        digest.update(f"{path.relative_to(folder)}\0{len(content)}\0".encode() + content)
    return digest.hexdigest(), frozenset(paths)
