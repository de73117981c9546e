"""What a log tells of the images: their age, gaps between them, and where the target was."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.log import FlightLog

Array = NDArray[np.float64]

LOST = 0.5
"""A target that was not seen for so long is called lost, s."""


@dataclass(frozen=True, eq=False)
class Images:
    """Images in use over a log with their ages.

    Attributes
    ----------
    log : FlightLog
    """

    log: FlightLog

    @cached_property
    def exposures(self) -> tuple[Array, Array]:
        """When each image in use came into use, and when it was exposed, (m,), s."""
        if self.log.image_age is not None:
            known = np.isfinite(self.log.image_age)
            times, exposed = self.log.times[known], (self.log.times - self.log.image_age)[known]
            fresh = np.r_[True, np.diff(exposed) > 1e-6] if len(times) else np.zeros(0, bool)
            return times[fresh], exposed[fresh]
        assert self.log.frames is not None and self.log.frames_whole is not None
        seen = self.log.frames[self.log.frames_whole]
        return seen, seen

    @cached_property
    def period(self) -> float:
        """From image to image where none is missing, the mean, s."""
        gaps = np.diff(self.exposures[1])
        return float(gaps[gaps <= 1.5 * np.median(gaps)].mean()) if len(gaps) else float("nan")

    @cached_property
    def fresh(self) -> Array:
        """Age of each image when it came into use, (m,), s, and so, as a rule, the latency."""
        arrived, exposed = self.exposures
        used = self.log.ahead * float(np.median(np.diff(self.log.times)))  # from that row on
        return np.asarray(arrived - exposed - used)

    @property
    def latency(self) -> float:
        """From exposure to use as a rule, s."""
        return float(np.median(self.fresh[1:])) if len(self.fresh) > 1 else float("nan")

    @property
    def jitter(self) -> float:
        """Standard deviation of that, s."""
        return float(self.fresh[1:].std()) if len(self.fresh) > 2 else float("nan")

    @cached_property
    def gaps(self) -> list[tuple[float, float, int]]:
        """Begin, length, both s, and images missed of each time without a new image in use."""
        _, exposed = self.exposures
        if len(exposed) < 2:
            return []
        ends = np.r_[exposed[1:], self.log.times[-1] - max(self.latency, 0.0)]
        found = []
        for begin, end in zip(exposed, ends, strict=True):
            if end - begin > 1.5 * self.period:
                missed = max(1, round((end - begin) / self.period) - 1)
                found.append((float(begin), float(end - begin), missed))
        return found
