"""Descent without derivatives, against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from hoverproof.descent import Ends, descend


def steep(x):
    return float(100 * (x[1:] - x[:-1] ** 2) @ (x[1:] - x[:-1] ** 2) + (1 - x[:-1]) @ (1 - x[:-1]))


def rough(x):
    return float(np.abs(x).sum() + np.cos(9 * x).sum())


def walled(x):
    return 1e6 if x[0] < 0.3 else float(x @ x)


@pytest.mark.parametrize("cost", [steep, rough, walled])
@pytest.mark.parametrize("size", [2, 4])
@pytest.mark.parametrize("most", [3, 40, 41, 42, 43, 70, 2000])
def test_it_goes_where_that_of_scipy_goes_to_the_last_bit(cost, size, most):
    rng = np.random.default_rng(most + size)
    simplex = rng.normal(size=(size + 1, size))
    seen, theirs = [], []
    value, place = descend(
        lambda x: seen.append(x.copy()) or cost(x), simplex, Ends(most, values=1e-7, places=1e-4)
    )
    options = {"maxfev": most, "fatol": 1e-7, "xatol": 1e-4, "initial_simplex": simplex}
    found = minimize(
        lambda x: theirs.append(x.copy()) or cost(x),
        simplex[0],
        method="Nelder-Mead",
        options=options,
    )
    assert np.array_equal(seen, theirs)
    assert value == found.fun == cost(place)
    assert len(seen) <= most
