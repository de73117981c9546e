"""Descent under constraints, those with edges among them."""

from __future__ import annotations

import numpy as np
import pytest

from hoverproof.sequential import Descent, Value


def descent(cost, over):
    """Return a descent from functions that give a value and its slopes."""

    def value(z):
        (c, _), pairs = cost(z), over(z)
        return Value(c, np.array([v for v, _ in pairs]), None)

    def slopes(z, at):
        return np.array([cost(z)[1], *(slope for _, slope in over(z))])

    return Descent(value, slopes, np.full(2, np.inf))


def far(z):
    return -z[0], np.array([-1.0, 0.0])


def disc(z):
    return [(z @ z - 1, 2 * z)]


def test_it_follows_a_valley_with_an_edge_at_its_bottom():
    """The largest x with |y - x²| + x <= 1: x = 1, y = 1, along a bent valley."""

    def over(z):
        x, y = z
        sign = np.sign(y - x * x) or 1.0
        slope = np.array([1 - 2 * sign * x, sign])
        return [(abs(y - x * x) + x - 1, slope)]

    made = descent(far, over)
    z, at = made.run(np.array([-1.0, 1.0]), made.value(np.array([-1.0, 1.0])), 120)
    assert z[0] > 0.99
    assert at.over[0] < 1e-3


def test_smooth_constraints_end_where_their_slopes_balance():
    made = descent(lambda z: (z[0] + z[1], np.ones(2)), disc)
    z, at = made.run(np.array([2.0, -0.5]), made.value(np.array([2.0, -0.5])), 60)
    assert z.sum() == pytest.approx(-np.sqrt(2), abs=5e-3)
    assert at.over[0] < 1e-4
