"""Random numbers by counting: each is a function of seed, run, step and channel alone.

So a run has the same noise whichever thread, chunk or machine flies it, with or without a
compiler. No function of the C library is in it: only exact integers, + - * / and square roots.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.uint64]
Array = NDArray[np.float64]

ROUNDS = 10
MULTIPLIERS = (0xD2511F53, 0xCD9E8D57)
WEYL = (0x9E3779B9, 0xBB67AE85)
LOW = 0xFFFFFFFF
ONE = 0x3FF0000000000000
"""The bits of 1.0."""

FLIGHT, DRAW = 0, 1
"""Last word of a counter: noise in flight, and what is drawn before it."""


def philox(counter: tuple[Any, Any, Any, Any], seed: int) -> tuple[Words, Words, Words, Words]:
    """Return four random 32-bit words of Philox4x32-10 (Salmon et al., 2011).

    Parameters
    ----------
    counter : four integers or arrays of them that broadcast, below 2**32
    seed : int
        Key, a number below 2**64.
    """
    c = [np.asarray(word, np.uint64) for word in counter]
    key = [np.uint64(seed & LOW), np.uint64(seed >> 32)]
    low, half = np.uint64(LOW), np.uint64(32)
    for _ in range(ROUNDS):
        a, b = (np.uint64(m) * word for m, word in zip(MULTIPLIERS, (c[0], c[2]), strict=True))
        c = [(b >> half) ^ c[1] ^ key[0], b & low, (a >> half) ^ c[3] ^ key[1], a & low]
        key = [np.uint64((int(k) + w) & LOW) for k, w in zip(key, WEYL, strict=True)]
    return c[0], c[1], c[2], c[3]


def uniforms(counter: tuple[Any, Any, Any, Any], seed: int) -> tuple[Array, Array]:
    """Return two independent numbers, u in (0, 1] and v in [-1/2, 1/2), of 52 bits each.

    Parameters
    ----------
    counter : four integers or arrays of them that broadcast, below 2**32
    seed : int
        Key, a number below 2**64.
    """
    w = philox(counter, seed)
    half, twelve = np.uint64(32), np.uint64(12)
    one = np.uint64(ONE)
    first, second = (
        ((((a << half) | b) >> twelve) | one).view(np.float64) for a, b in (w[:2], w[2:])
    )
    return 2.0 - first, second - 1.5


def normals(counter: tuple[Any, Any, Any, Any], seed: int) -> tuple[Array, Array]:
    """Return two independent standard normal numbers for each counter.

    Parameters
    ----------
    counter : four integers or arrays of them that broadcast, below 2**32
    seed : int
        Key, a number below 2**64.
    """
    u, v = uniforms(counter, seed)
    shape = np.shape(u)
    mantissa, exponent = np.frexp(np.ravel(u))
    inputs = [2.0 * mantissa, exponent - 1.0, np.ravel(v)]
    mapped = normal_pair().map(max(1, np.size(u)))
    first, second = mapped(*(np.reshape(part, (1, -1)) for part in inputs))
    return np.array(first).reshape(shape), np.array(second).reshape(shape)


@cache
def normal_pair() -> ca.Function:
    """Return (m, e, v) ↦ two normal numbers, by Box and Muller's formula.

    The uniform numbers are u = m 2**e with m in [1, 2), and v in [-1/2, 1/2): the radius is
    sqrt(-2 ln u), the angle 2π v. Logarithm, sine and cosine are series, right to 1e-11.
    """
    m, e, v = (ca.SX.sym(name) for name in "mev")
    s = (m - 1) / (m + 1)
    logarithm = e * math.log(2) + 2 * s * _series(s * s, [1 / (2 * k + 1) for k in range(13)])
    radius = ca.sqrt(ca.fmax(-2 * logarithm, 0))
    quarter = math.pi / 2 * v  # a quarter of the angle, at most π/4 in size
    square = quarter * quarter
    sign = [(-1) ** k for k in range(8)]
    sine = quarter * _series(square, [sign[k] / math.factorial(2 * k + 1) for k in range(8)])
    cosine = _series(square, [sign[k] / math.factorial(2 * k) for k in range(8)])
    for _ in range(2):
        sine, cosine = 2 * sine * cosine, 1 - 2 * sine * sine
    return ca.Function("hoverproof_normals", [m, e, v], [radius * cosine, radius * sine])


def _series(x: ca.SX, coefficients: list[float]) -> ca.SX:
    """Return Σ coefficients[k] x^k by Horner's rule."""
    total = ca.SX(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        total = total * x + coefficient
    return total
