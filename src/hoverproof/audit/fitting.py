"""Least squares with error bars, means over time, and commands as rotors that lag follow them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fit:
    """What was identified.

    Attributes
    ----------
    value : (k,)
        In the unit of the ratio of what was fitted.
    deviation : (k,)
        One standard deviation of each, likewise.
    residual : float
        Root of the mean square of what is left: dimensionless, or N or rad/s² as fitted.
    """

    value: Array
    deviation: Array
    residual: float


def least_squares(matrix: Array, wanted: Array) -> Fit:
    """Return x that matrix x ≈ wanted, with deviations that count what is left as noise.

    Neighbouring residuals are alike: the variance is that of so many fewer of them, by their
    correlation ρ, (1 + ρ)/(1 - ρ) times as few.

    Parameters
    ----------
    matrix : (n, k)
        Any unit.
    wanted : (n,)
        Any unit.
    """
    n, k = matrix.shape
    if n <= k:
        return Fit(np.full(k, np.nan), np.full(k, np.inf), np.nan)
    solved, _, rank, _ = np.linalg.lstsq(matrix, wanted, rcond=None)
    x = np.asarray(solved, np.float64)
    left = wanted - matrix @ x
    variance = float(left @ left) / (n - k)
    if rank < k:
        return Fit(x, np.full(k, np.inf), float(np.sqrt(variance)))
    alike = float(left[1:] @ left[:-1]) / max(float(left @ left), 1e-300)
    alike = min(max(alike, 0.0), 0.999)
    spread = np.diag(np.linalg.pinv(matrix.T @ matrix)) * variance * (1 + alike) / (1 - alike)
    return Fit(x, np.asarray(np.sqrt(np.maximum(spread, 0)), np.float64), float(np.sqrt(variance)))


def instrumented(given: Array, wanted: Array) -> Fit:
    """Return x that given x ≈ wanted, where both share the noise of neighbouring samples.

    What was given two samples before is the instrument: noise that is in both is not in it.

    Parameters
    ----------
    given, wanted : (n,)
        Any unit.
    """
    known = np.isfinite(given) & np.isfinite(wanted)
    known[:2] = False
    known[2:] &= np.isfinite(given[:-2])
    before = np.concatenate([given[:2], given[:-2]])[known]
    common = float(before @ given[known])
    if known.sum() < 4 or common <= 0:
        return Fit(np.full(1, np.nan), np.full(1, np.inf), np.nan)
    x = float(before @ wanted[known]) / common
    left = wanted[known] - x * given[known]
    size = float(np.sqrt(left @ left / (known.sum() - 1)))
    return Fit(np.array([x]), np.array([size * np.linalg.norm(before) / common]), size)


def over(times: Array, values: Array, window: float) -> Array:
    """Return means over a window of time around each sample, (n,) or (n, k).

    Parameters
    ----------
    times : (n,)
        s, rising.
    values : (n,) or (n, k)
        Any unit; what is no number is left out.
    window : float
        s.
    """
    known, none = np.isfinite(values), np.zeros_like(values[:1])
    total = np.cumsum(np.concatenate([none, np.where(known, values, 0)]), axis=0)
    count = np.cumsum(np.concatenate([none, known]), axis=0)
    first = np.searchsorted(times, times - window / 2)
    last = np.searchsorted(times, times + window / 2, side="right")
    number = count[last] - count[first]
    mean = (total[last] - total[first]) / np.where(number > 0, number, 1)
    return np.where(number > 0, mean, np.nan)


def noise_over(times: Array, values: Array, window: float) -> float:
    """Return one standard deviation of means over a window, by how neighbours differ.

    Parameters
    ----------
    times : (n,)
        s, rising.
    values : (n,)
        Any unit.
    window : float
        s.
    """
    each = np.median(np.abs(np.diff(values[np.isfinite(values)]))) / 0.9539  # of normal numbers
    return float(each / np.sqrt(max(window / np.median(np.diff(times)), 1.0)))


def followed(times: Array, commands: Array, lag: float) -> Array:
    """Return the mean over each step of what follows commands with a first-order lag, (n - 1, k).

    The command at a sample is what was asked for since the sample before. At the start all is as
    it was first asked for.

    Parameters
    ----------
    times : (n,)
        s, rising.
    commands : (n, k)
        Any unit.
    lag : float
        s.
    """
    if lag <= 0:
        return commands[1:]
    steps = np.diff(times)
    kept = np.exp(-steps / lag)
    if np.ptp(steps) < 1e-9 and np.isfinite(commands).all():
        one = kept[0]
        gaps = lfilter([1.0], [1.0, -one], np.diff(commands, axis=0), axis=0)  # before each step
        return np.asarray(commands[1:] - gaps * lag * (1 - one) / steps[0])
    share = lag * (1 - kept) / steps
    now, means = commands[0].copy(), np.empty_like(commands[1:])
    for k, command in enumerate(commands[1:]):
        gap = now - command
        means[k] = command + share[k] * gap
        now = command + kept[k] * gap
    return means
