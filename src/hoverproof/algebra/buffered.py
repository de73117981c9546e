"""A graph that is called with many plain numbers: its places are laid out once."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray


class Buffered:
    """A function called with plain numbers, without making a matrix of CasADi's of each.

    Parameters
    ----------
    function : casadi.Function
        With dense results. Its matrices are given and come as vectors, column by column.
    """

    def __init__(self, function: ca.Function) -> None:
        buffer: Any
        buffer, self._run = function.buffer()
        self._buffer = buffer
        self._given = [np.zeros(function.numel_in(i)) for i in range(function.n_in())]
        self._results = [np.zeros(function.numel_out(i)) for i in range(function.n_out())]
        for i, place in enumerate(self._given):
            buffer.set_arg(i, place.data)
        for i, place in enumerate(self._results):
            buffer.set_res(i, place.data)

    def __call__(self, *given: Any) -> list[NDArray[np.float64]]:
        """Return the results, each a vector, in the units of the function.

        Parameters
        ----------
        *given
            Numbers or vectors of its arguments.
        """
        for place, values in zip(self._given, given, strict=True):
            place[:] = values
        self._run()
        return [result.copy() for result in self._results]
