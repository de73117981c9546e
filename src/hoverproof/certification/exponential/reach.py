"""How large errors are on a set {Ψ <= ℓ}, in floating point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reach:
    """How large errors are on a set {Ψ <= ℓ}, dimensionless.

    Attributes
    ----------
    image : float
        Bound of |δ1|, dimensionless.
    force : float
        Bound of |δ3 - δ2|, dimensionless.
    d3 : float
        Of |δ3|, dimensionless.
    turn : float
        Of |ζ|, ζ = δ4 - P δ3, dimensionless.
    speed : float
        Of |δ1 + δ2|, dimensionless.
    """

    image: float
    force: float
    d3: float
    turn: float
    speed: float

    @classmethod
    def of(cls, weights: Array, level: float) -> Reach:
        """Return the reach that weights give.

        Parameters
        ----------
        weights : (3,)
            w2, w3, w4.
        level : float
            ℓ, dimensionless.
        """
        w2, w3, w4 = weights
        parts = 1, 1 / w2 + 1 / w3, 1 / w3, 1 / w3 + 1 / w4, 1 + 1 / w2
        return cls(*(float(np.sqrt(2 * level * x)) for x in parts))
