"""The one error that users cause, which every command turns into one line and status 2."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Sequence


class InputError(ValueError):
    """Something that a user gave cannot be used.

    As a string it speaks to a user of Python, of arguments; its `line` speaks to one of the command
    line, of options.

    Parameters
    ----------
    where : str
        The file (or the preset, or the option, such as ``--duration``) that holds the mistake.
    key : str
        The key inside it, dotted; empty if the whole is meant.
    reason : str
        What is wrong and what would be right.

    Attributes
    ----------
    line : str
        The message for the command line.
    """

    def __init__(self, where: str, key: str, reason: str) -> None:
        self.where, self.key, self.reason = where, key, reason
        self.line = ": ".join(part for part in (where, key, reason) if part)
        super().__init__(_in_python(self.line))

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str, str]]:
        """Let it cross from a process that works to the one that asked."""
        return InputError, (self.where, self.key, self.reason)


def _in_python(line: str) -> str:
    """Name options as the arguments that they are in Python."""
    arguments = re.sub(r"--set (?=[a-z])", "", line)
    return re.sub(r"(?<![\w-])--([a-z][a-z-]*)", lambda m: m[1].replace("-", "_"), arguments)


@contextlib.contextmanager
def needing(extra: str, where: str, reason: str) -> Iterator[None]:
    """Say which extra has what is imported here, if it is not installed.

    Parameters
    ----------
    extra : str
        As pip knows it, ``hoverproof[extra]``.
    where, reason : str
        See `InputError`.

    Raises
    ------
    InputError
        In place of ImportError.
    """
    try:
        yield
    except ImportError:
        raise InputError(where, "", f"{reason}: pip install 'hoverproof[{extra}]'") from None


def suggestion(word: str, known: Sequence[str], title: str, *, shown: Sequence[str] = ()) -> str:
    """Suggest the nearest of what is known; list it (or what is to be `shown`) if nothing is near.

    Parameters
    ----------
    word : str
        What was given.
    known : sequence of str
        What would have been understood.
    title : str
        Words before the list.
    shown : sequence of str, optional
        A shorter list.
    """
    import difflib

    by_lower = {name.lower(): name for name in known}
    near = difflib.get_close_matches(word.lower(), by_lower, n=1)
    return (
        f"did you mean {by_lower[near[0]]!r}?" if near else f"{title}: {', '.join(shown or known)}"
    )


def in_short(error: BaseException, most: int = 80) -> str:
    """Return what a library says that an error is, in one line; its type if it says nothing.

    Parameters
    ----------
    error : BaseException
    most : int
        Number of letters that are kept.
    """
    return " ".join(str(error).split())[:most].rstrip(".") or type(error).__name__
