"""Certificates in files, read and checked by the checker alone."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from hoverproof import checker
from hoverproof.errors import InputError
from hoverproof.mission.arguments import checked


@contextlib.contextmanager
def readable(path: str | Path) -> Iterator[None]:
    """Say of which file it is that it holds no certificate, if the checker finds that.

    Parameters
    ----------
    path : str or Path

    Raises
    ------
    InputError
        In place of `checker.Unreadable`.
    """
    try:
        yield
    except checker.Unreadable as error:
        raise InputError(str(path), "", str(error)) from None


@checked
def check(path: str | Path) -> str:
    """Return the theorem that a certificate file proves, in words.

    Parameters
    ----------
    path : str or Path
        A certificate or a counterexample.

    Raises
    ------
    checker.Rejected
        If it does not prove what it claims.
    InputError
        If it cannot be read, or is no certificate.
    """
    with readable(path):
        return checker.check_file(path)
