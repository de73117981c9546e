"""Tests of many like cases: a part of them in CI, all with `make trials`. Not a test itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

import pytest

Case = TypeVar("Case")


def mostly_whole(cases: Iterable[Any], *, every: int, first: int = 0) -> list[Any]:
    """Return parameters of a test, of which most are tried with `make trials` alone.

    Parameters
    ----------
    cases : iterable
        Values of a test's parameters, tuples if there are several.
    every : int
        CI tries one of so many.
    first : int
        Which is the first that CI tries.
    """
    found = []
    for number, case in enumerate(cases):
        parts = case if isinstance(case, tuple) else (case,)
        marks = () if (number - first) % every == 0 else (pytest.mark.whole,)
        found.append(pytest.param(*parts, marks=marks))
    return found


def share_of(cases: Iterable[Case], whole: bool, *, every: int) -> Iterator[Case]:
    """Yield all cases if they are wanted whole, else one of so many."""
    return (case for number, case in enumerate(cases) if whole or number % every == 0)
