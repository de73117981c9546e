"""A flight that ends before its time, told up to the step at which it ended.

Samples may be minutes apart, and a fall takes seconds.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Fly = Callable[[int, int], tuple[Array, bool]]
"""Flies from the start: given the number of samples and the steps between them, returns the good
samples from the start on, (m, k), and whether the flight went on to the end."""

FEW = 50
"""Of fewer samples nobody can tell how a flight went."""


def last_good_step(fly: Fly, rows: Array, every: int, told: float | None) -> int:
    """Return the last step to which a flight goes that ended before its time.

    Parameters
    ----------
    fly : callable
        See `Fly`.
    rows : (m, k)
        Its good samples.
    every : int
        Steps between them.
    told : float, optional
        The step, if it was noted, a bare number.
    """
    low = (len(rows) - 1) * every
    high = low + every  # a flight of so many steps is not good
    if told is not None and low <= told < high:
        return int(told)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if fly(1, middle)[1] else (low, middle)
    return low


def up_to(
    fly: Fly, rows: Array, every: int, last: int, samples: int | None
) -> tuple[Array, NDArray[np.int64]]:
    """Return the samples of a flight, and one more of the step at which it ended.

    Parameters
    ----------
    fly : callable
        See `Fly`.
    rows : (m, k)
        Its good samples.
    every : int
        Steps between them.
    last : int
        Number of the last good step, from `last_good_step`.
    samples : int or None
        Number of samples to keep about, if there are few; None if as many are kept as was asked.

    Returns
    -------
    rows : (n, k)
    steps : (n,)
        At which they were taken, from 0.
    """
    if samples is not None and len(rows) < FEW and every > 1 and last:
        every = max(1, last // samples)
        rows, _ = fly(last // every, every)
    steps = every * np.arange(len(rows))
    if steps[-1] == last:
        return rows, steps
    end, _ = fly(1, last)
    return np.vstack([rows, end[-1:]]), np.append(steps, last)
