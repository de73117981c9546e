"""What stands in the way of a wish for gains, and by how much."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from hoverproof.certification.flow import flow_of
from hoverproof.design.gain_search import COARSE, GainSearch
from hoverproof.mission.task import Gains

STEP = 8.0
STEPS = 4
SATURATED = 0.01
"""A bandwidth `STEP` times as high that brings less than this part of what is missing is the last
that is tried.
"""


def start_words(search: GainSearch) -> str:
    """Say by how much the first command misses the limits even with hardly any gain.

    Parameters
    ----------
    search : GainSearch
    """
    limits, none = search.limits, tuple(np.array([k]) for k in (1e-6, 1e-3, 1e-3, 1e-3))
    thrusts, tilt = search.command(none)
    low, high = float(thrusts.min()), float(thrusts.max())
    words = []
    if limits.rotors is not None:
        least, most = limits.rotors
        beyond = max(least - low, high - most)
        if beyond > 0:
            words.append(
                f"rotor thrusts from {low:.4g} to {high:.4g} N, {beyond:.3g} N beyond "
                f"[{least:g}, {most:g}] N"
            )
    if limits.tilt is not None and tilt[0] > limits.tilt:
        most, asked = math.degrees(limits.tilt), math.degrees(tilt[0])
        words.append(f"a tilt of {asked:.3g} deg, {asked - most:.2g} deg beyond {most:g} deg")
    if not words:
        return "no gains were found that keep the limits at the start and pose a question"
    held = " and ".join(words)
    return f"no gains keep the limits at the start: even hardly any gain asks for {held}"


def margin_words(search: GainSearch, value: float) -> str:
    """Say how far the best gains found are from a certificate.

    Parameters
    ----------
    search : GainSearch
    value : float
        Their rate, 1/s, not above 0.
    """
    flow = flow_of(search.command.mission)
    held = flow.within([float(x) for x in search.questions.eigenvalues], "{:g}".format)
    bounded = f"{flow.words} in {held}" if flow.symbol == "Q" else held
    margin = value * search.questions.mass / 2
    return (
        f"no gains are certified within a bandwidth of {search.limits.fastest:g} rad/s: the best "
        f"margin found is {margin:.3g} kg/s (floating point), short of 0 by {-margin:.3g}; what "
        f"binds are the bounds: {bounded.removeprefix('the ')}, and the thrust"
    )


def needed_bandwidth(
    search: GainSearch, gains: Gains, rate: float, at_least: float
) -> float | None:
    """Return the bandwidth at which a rate is reached, rad/s; None if that is out of reach.

    Parameters
    ----------
    search : GainSearch
        Its limit of bandwidth does not count.
    gains : Gains
        The best within that limit.
    rate : float
        Their decay rate of L, 1/s, below what is wished for.
    at_least : float
        Decay rate of L that is wished for, 1/s.
    """
    from scipy.optimize import brentq  # as long to import as all that `tune` needs besides

    z = np.log([float(k) for k in (gains.k1, gains.k1 * gains.k2, gains.k3)])
    low, short = math.log(search.limits.fastest), at_least - rate
    known = {low: short}

    def missing(log_bandwidth: float) -> float:
        nonlocal z
        if log_bandwidth not in known:
            limits = replace(search.limits, bandwidth=math.exp(log_bandwidth), rate=None)
            z_new, value = replace(search, limits=limits).climb(z, 0.3, 2 * COARSE)
            if np.isfinite(value):
                z = z_new
            known[log_bandwidth] = at_least - value
        return known[log_bandwidth]

    for _ in range(STEPS):
        high = low + math.log(STEP)
        still = missing(high)
        if still <= 0:
            return math.exp(brentq(missing, low, high, xtol=0.005))
        if short - still < SATURATED * short:
            return None
        low, short = high, still
    return None
