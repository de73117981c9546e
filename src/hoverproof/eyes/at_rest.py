"""The noise of what a camera sees while nothing moves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.eyes.sightings import Sightings

Array = NDArray[np.float64]

MOVED = 1.0
"""px: a camera is still as long as no corner moves by more."""
FEWEST = 20
"""Frames that noise is estimated from, at least."""
SPREAD = 4.0
"""A bound is so many standard deviations, or the largest that was seen, if that is more."""


@dataclass(frozen=True)
class Rest:
    """Noise at rest, about a line over time, so that a slow drift is no noise.

    Attributes
    ----------
    begin, end : float
        s: the stretch.
    frames : int
        Their number.
    pixel_noise : float
        Standard deviation of a coordinate of a corner, a number of px.
    pixel_bias : float
        How far the mean corners are from those of any pose of the board, root mean
        square, a number of px.
    feature : str
        Whose noise it is: that of the law, or the scaled centroid.
    deviation : (3,) array
        Standard deviation of the feature, body axes, dimensionless.
    bias : float
        Length of the mean feature less that of the pose that fits the mean corners,
        dimensionless.
    largest : float
        The largest deviation of the feature that was seen, as a length, dimensionless.
    """

    begin: float
    end: float
    frames: int
    pixel_noise: float
    pixel_bias: float
    feature: str
    deviation: Array
    bias: float
    largest: float

    @property
    def bound(self) -> float:
        """A bound for `uncertainty.noise.feature` that all that was seen is within."""
        return self.bias + max(self.largest, SPREAD * float(np.linalg.norm(self.deviation)))

    def lines(self) -> list[str]:
        """Return what a mission file says of it."""
        return [
            f"[sensors] pixel_noise = {_two(self.pixel_noise)}",
            f"[uncertainty] noise = {{feature = {_two(self.bound)}}}",
        ]


def _two(value: float) -> str:
    """Write two digits, not less than the value."""
    if value <= 0:
        return "0"
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return f"{math.ceil(value / unit - 1e-9) * unit:.2g}"


def at_rest(seen: Sightings, stretch: tuple[float, float] | None = None) -> Rest | None:
    """Return the noise over a stretch in which nothing moved; None if there is none.

    Parameters
    ----------
    seen : Sightings
    stretch : (float, float), optional
        s; by default the longest in which no corner moved by more than `MOVED`.

    Raises
    ------
    InputError
        If the stretch that was given has fewer than `FEWEST` frames with all of the target.
    """
    times = np.array(seen.times)
    if stretch is None:
        first, last = _longest(seen)
        chosen = np.zeros(len(times), bool)
        chosen[first:last] = True
    else:
        chosen = (times >= stretch[0]) & (times <= stretch[1]) & seen.whole
    count = int(chosen.sum())
    if count < FEWEST:
        if stretch is None:
            return None
        reason = f"has {count} frames with all of the target in them, at least {FEWEST} are needed"
        raise InputError("--still", "", reason)
    pixels = np.array(seen.pixels)[chosen]
    mean = pixels.mean(axis=0)
    pose = seen.viewer.pose(mean)
    fitted = seen.viewer.fitted(*pose)
    downs = np.repeat(seen.downs([pose]), count + 2, axis=0)
    several = np.concatenate([pixels, mean[None], fitted[None]])
    told = seen.told(several, downs)
    name, features = ("of the law", told[2]) if told[2].shape[1] else ("scaled centroid", told[1])
    rest = _about_a_line(times[chosen], features[:-2])
    noise = _about_a_line(times[chosen], pixels.reshape(count, -1))
    return Rest(
        begin=float(times[chosen][0]),
        end=float(times[chosen][-1]),
        frames=count,
        pixel_noise=float(np.sqrt((noise**2).sum() / (noise.size - 2 * noise.shape[1]))),
        pixel_bias=float(np.sqrt(((mean - fitted) ** 2).mean())),
        feature=name,
        deviation=np.sqrt((rest**2).sum(axis=0) / (count - 2)),
        bias=float(np.linalg.norm(features[-2] - features[-1])),
        largest=float(np.linalg.norm(rest, axis=1).max()),
    )


def _longest(seen: Sightings) -> tuple[int, int]:
    """Return where the longest stretch begins, and the frame behind it."""
    best, begin = (0, 0), 0
    low = high = np.empty(0)
    for k, (pixels, whole) in enumerate(zip(seen.pixels, seen.whole, strict=True)):
        flat = pixels.ravel()
        if k > begin and whole:
            low, high = np.minimum(low, flat), np.maximum(high, flat)
        if not whole or k == begin or (high - low).max() > MOVED:
            begin = k if whole else k + 1
            low = high = flat
        if k + 1 - begin > best[1] - best[0]:
            best = begin, k + 1
    return best


def _about_a_line(times: Array, values: Array) -> Array:
    """Return values, (frames, k), less a line over time."""
    basis = np.stack([np.ones_like(times), times - times.mean()], axis=1)
    fitted: Array = values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]
    return fitted
