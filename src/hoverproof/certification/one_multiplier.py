"""The largest margin over one multiplier, for many inequalities at once.

The margin is the least of concave functions of the multiplier, one a block, each with its slope.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.semidefinite import separate

Array = NDArray[np.float64]

RELATIVE = 1e-9
ROUNDING = 1e-15
MOST_STEPS = 80
MOST_TAU = 1e15
REACH = 1.3


def climbed(parts: Array, floor: float) -> tuple[Array, Array]:
    """Maximise over a single τ: the margin is the least of concave functions of it, one a block.

    Two points with slopes of either sign enclose the maximum. The next is, in turns, where tangents
    at these come down to each other, which is right where blocks meet, or where the slope between
    them vanishes, which is right where it is smooth. Besides, no margin is above
    XᵀSX - r|uX||vX| for any unit vector X, so each point brings a bound from above too.

    Parameters
    ----------
    parts : (3, k, n, n)
        Of k inequalities, as `robust.Inequality.parts` gives them.
    floor : float
        Of margins that are surely below, no more than that is found out; in the unit of S.

    Returns
    -------
    margins, multipliers : (k,) each
    """
    size = np.abs(parts[0]).max(axis=(1, 2))
    blocks = [np.ascontiguousarray(parts[:, :, i][..., i]) for i in separate(parts)]
    blocks = [b for i, b in enumerate(blocks) if not any(np.array_equal(b, a) for a in blocks[:i])]
    v, u = np.trace(parts[1:], axis1=2, axis2=3)
    with np.errstate(all="ignore"):
        tau = np.sqrt(u / v)
    tau[~np.isfinite(tau) | (tau == 0)] = 1.0
    tangents, above = _tangents(blocks, tau)
    low = high = np.array([tau, *tangents])
    index, reach = np.arange(len(tau)), REACH
    result = np.empty((2, len(tau)))
    for step in range(MOST_STEPS + 1):
        (best, rise), (other, fall) = _lowest(low), _lowest(high)
        enclosed = (rise > 0) & (fall < 0)
        meet, peak = _crossing(low, high)
        above = np.where(enclosed, np.minimum(above, peak), above)
        at, best = np.where(best > other, low[0], high[0]), np.maximum(best, other)
        done = above - best <= RELATIVE * np.abs(best) + ROUNDING * size
        done |= (above < floor) | (rise == 0) | (fall == 0) | (step == MOST_STEPS)
        done |= (low[0] > MOST_TAU) | (high[0] < 1 / MOST_TAU)
        result[:, index[done]] = best[done], at[done]
        if done.all():
            break
        reach = min(reach**1.5, 1e4)
        with np.errstate(all="ignore"):  # for a fixed X the slope is linear in 1/τ²
            flat = np.sqrt((rise - fall) / (rise / high[0] ** 2 - fall / low[0] ** 2))
        tau = np.clip(flat if step % 2 else meet, low[0], high[0])
        tau = np.where(enclosed, tau, np.where(rise > 0, low[0] * reach, high[0] / reach))[~done]
        index, size, above, low, high, *blocks = (
            x[..., ~done] if x.ndim < 3 else x[:, ~done]
            for x in (index, size, above, low, high, *blocks)
        )
        tangents, new = _tangents(blocks, tau)
        above, point = np.minimum(above, new), np.array([tau, *tangents])
        rising = _lowest(point)[1] >= 0
        low, high = np.where(rising, point, low), np.where(rising, high, point)
    return result[0], result[1]


def _tangents(blocks: list[Array], tau: Array) -> tuple[Array, Array]:
    """Return least eigenvalues and slopes of all blocks, (2 blocks, k), and bounds from above."""
    values, v, u = np.empty((3, len(blocks), len(tau)))
    for i, (S, for_v, for_u) in enumerate(blocks):
        each = tau[:, None, None]
        found, vectors = np.linalg.eigh(S + each * for_v + for_u / each)
        x = vectors[:, :, :1]
        values[i] = found[:, 0]
        v[i], u[i] = (-(x * (m @ x)).sum(axis=(1, 2)) for m in (for_v, for_u))
    v, u = np.maximum(v, 0), np.maximum(u, 0)  # (r/2)|vX|² and (r/2)|uX|²
    above = (values + (np.sqrt(tau * v) - np.sqrt(u / tau)) ** 2).min(axis=0)
    return np.concatenate([values, u / tau**2 - v]), above


def _lowest(point: Array) -> tuple[Array, Array]:
    """Return the least of the values at τ, and the slope there, (k,) each."""
    half = len(point) // 2 + 1
    lowest, each = point[1:half].argmin(axis=0), np.arange(point.shape[1])
    return point[1 + lowest, each], point[half + lowest, each]


def _crossing(low: Array, high: Array) -> tuple[Array, Array]:
    """Return where the least of all tangents is highest, and how high, (k,) each.

    That is the lowest crossing of one that rises with one that falls.
    """
    ends = [(p[0], *np.split(p[1:], 2)) for p in (low, high)]
    slopes = np.concatenate([slope for _, _, slope in ends])
    starts = np.concatenate([value - slope * tau for tau, value, slope in ends])
    with np.errstate(all="ignore"):
        at = (starts[None] - starts[:, None]) / (slopes[:, None] - slopes[None])
        turns = (slopes[:, None] > 0) & (slopes[None] <= 0)
        height = np.where(turns, starts[:, None] + slopes[:, None] * at, np.inf)
    at, height = (x.reshape(-1, len(low[0])) for x in (at, height))
    lowest = height.argmin(axis=0), np.arange(len(low[0]))
    return at[lowest], height[lowest]
