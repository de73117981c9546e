"""Exact numbers, of what a user writes or a program gives."""

from __future__ import annotations

import re
from fractions import Fraction

LONGEST = 400
"""Of exponents: such a number is beyond floating point, and one of 1e9 would fill the memory."""


def exact(value: object) -> Fraction:
    """Return a number exactly: what a text writes, as 0.1, 1e-3 or 1/3, or any number of Python.

    Parameters
    ----------
    value : str or number
        A float is taken for the shortest decimal that is read as it.

    Raises
    ------
    ValueError
        If it is none, or one beyond all that is computed with.
    """
    if isinstance(value, Fraction):
        return value
    text = str(value)
    exponent = re.search(r"[eE]([+-]?[\d_]+)\s*$", text)
    if len(text) > LONGEST or (exponent and abs(int(exponent[1])) > LONGEST):
        raise ValueError("a number of so many digits")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError("a number over 0") from None
