"""Where the search for gains sets out.

Gains over mass are rates, 1/s; these stand in fixed proportions, and the fastest of them suits
latency and lag of the rotors, the force that the way there takes, and the bandwidth that is
allowed. So the search sets out alike for small vehicles and large ones.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.question import Question
from hoverproof.design.limits import Limits

Array = NDArray[np.float64]
RATES = 0.02, 0.14, 0.26, 1.0
"""j k1/m, k1 k2/m, k3/m and k4/m where the search sets out, over the last of them."""
WAITS = 1.3
"""The last of them times latency and lag of the rotors is at most that there."""
FORCE = 0.04
"""And the force that d asks for at most that share of the weight."""
OF_BANDWIDTH = 0.9
SCALES = 1.0, 0.6, 0.36, 0.2, 0.1
PARTS, SHARES = (0.9, 0.5), (-1.5, -2.5)
FIRST_RATE = 0.3


def guesses(whole: Question, limits: Limits, ends: tuple[float, float]) -> Iterator[Array]:
    """Yield points to set out from, (7,) each, see `start_search.Point`; the fastest first.

    Parameters
    ----------
    whole : Question
    limits : Limits
    ends : (low, high)
        The least d that may hold the start, and the largest that is searched, dimensionless.
    """
    low, high = ends
    if not low < high:
        return
    v = whole.vehicles
    mass, gravity = float(v.design.mass), float(v.design.gravity)
    wait = v.latency + v.rotor_lag
    for scale, part in itertools.product(SCALES, PARTS):
        d = low * (high / low) ** part
        j = sum(whole.balls.within(d)) / 2
        slow, pull = RATES[0], RATES[1]
        quick = math.sqrt(FORCE * gravity * j / (d * slow * pull))
        quick = min(quick, OF_BANDWIDTH * limits.fastest / sum(RATES[1:]))
        if wait:
            quick = min(quick, WAITS / wait)
        rates = scale * quick * np.array(RATES)
        k1 = mass * rates[0] / j
        gains = [k1, mass * rates[1] / k1, mass * rates[2], mass * rates[3]]
        for share in SHARES:
            last = math.log(d), share, math.log(FIRST_RATE * rates[0])
            yield np.array([*np.log(gains), *last])
