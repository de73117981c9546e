"""Semidefinite programs in floating point, and the multipliers of their bounds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Places = NDArray[np.intp]
TOLERANCE = 1e-11


class Multipliers(NamedTuple):
    """Why nothing does better: Σ λ · row + Σ <pencil, Z>, of (1, x), is bounded for every x.

    Attributes
    ----------
    rows : (j,)
        λ, bare numbers, not negative.
    pencils : list of symmetric matrices
        Z, positive semidefinite, of numbers.
    """

    rows: Array
    pencils: list[Array]


class Ended(NamedTuple):
    """What the solver found.

    Attributes
    ----------
    x : (k,) or None
        The best parameters; None if there are none.
    multipliers : Multipliers or None
        For all x that are allowed, what they are multiplied with is 0 or more; it is less by what
        the cost is below the optimum, or by something if there is none. None if that is not known.
    """

    x: Array | None
    multipliers: Multipliers | None


def minimise(
    cost: Array, rows: Array, pencils: Sequence[Array], tolerance: float = TOLERANCE
) -> Ended:
    """Minimise cost·x with rows and pencils times (1, x) positive and positive semidefinite.

    The unknowns of each pencil are measured so that its diagonal is about 1, without which the
    solver goes wrong.

    Parameters
    ----------
    cost : (k,)
        Numbers.
    rows : (1 + k, j)
        What 1 and each parameter multiply, numbers.
    pencils : sequence of (1 + k, p, p)
        Likewise, numbers.
    tolerance : float
        Of the solver, a bare number.
    """
    import clarabel
    import scipy.linalg  # noqa: F401  clarabel loads it, and takes Ctrl-C for a fault of its own
    from scipy.sparse import csc_array

    triangles, cones = [rows.T], [clarabel.NonnegativeConeT(rows.shape[1])]
    blocks = [_Block.of(*found) for found in _different(pencils)]
    for _, _, block, lines, columns, twice, units in blocks:
        scale = twice * units
        triangles.append((block[:, lines, columns] * scale).T)
        cones.append(clarabel.PSDTriangleConeT(block.shape[1]))
    stacked = np.concatenate(triangles)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    none, matrix = csc_array((len(cost), len(cost))), csc_array(-stacked[:, 1:])
    solver = clarabel.DefaultSolver(none, cost, matrix, stacked[:, 0], cones, settings)
    solution = solver.solve()
    solved = str(solution.status) in ("Solved", "AlmostSolved")
    told = solved or str(solution.status) in ("PrimalInfeasible", "AlmostPrimalInfeasible")
    found = _multipliers(np.array(solution.z), rows.shape[1], pencils, blocks) if told else None
    return Ended(np.array(solution.x) if solved else None, found)


class _Block(NamedTuple):
    """A block of a pencil: of which, its coordinates there, and it as the solver has triangles.

    Attributes
    ----------
    pencil : int
    places : (p,)
    block : (1 + k, p, p)
    lines, columns : (p (p + 1)/2,)
        Of the entries of the triangle.
    twice, units : (p (p + 1)/2,)
        Factors of these: of the triangle, and of the units of the unknowns.
    """

    pencil: int
    places: Places
    block: Array
    lines: Places
    columns: Places
    twice: Array
    units: Array

    @classmethod
    def of(cls, pencil: int, places: Places, block: Array) -> _Block:
        lines, columns, twice = _triangle(block.shape[1])
        sizes = np.abs(np.diagonal(block, axis1=1, axis2=2)).max(axis=0)
        units = 1 / np.sqrt(np.where(sizes > 0, sizes, 1))
        return cls(pencil, places, block, lines, columns, twice, units[lines] * units[columns])


def _multipliers(
    z: Array, end: int, pencils: Sequence[Array], blocks: Sequence[_Block]
) -> Multipliers:
    """Read them off the solver's; of blocks of a pencil that are alike the first."""
    rows, each = z[:end], [np.zeros(pencil.shape[1:]) for pencil in pencils]
    for k, places, _, lines, columns, twice, units in blocks:
        begin, end = end, end + len(twice)
        for first, second in ((lines, columns), (columns, lines)):
            each[k][places[first], places[second]] = z[begin:end] / twice * units
    return Multipliers(rows, each)


def _different(pencils: Sequence[Array]) -> Iterator[tuple[int, Places, Array]]:
    """Yield the blocks of pencils, none of one twice: of which, its coordinates, and the block."""
    for k, pencil in enumerate(pencils):
        seen = set()
        for places in separate(pencil):
            block = np.ascontiguousarray(pencil[:, places][..., places])
            if block.tobytes() not in seen:
                seen.add(block.tobytes())
                yield k, places, block


@cache
def _triangle(size: int) -> tuple[Places, Places, Array]:
    columns, lines = np.tril_indices(size)
    return lines, columns, np.where(lines == columns, 1.0, np.sqrt(2))


def separate(matrices: Array) -> list[NDArray[np.intp]]:
    """Return the sets of coordinates between which no matrix has an entry.

    Parameters
    ----------
    matrices : (..., n, n)
        Numbers.
    """
    linked = (matrices != 0).any(axis=tuple(range(matrices.ndim - 2)))
    linked |= np.eye(len(linked), dtype=bool)
    for _ in range(len(linked).bit_length()):
        linked = linked @ linked
    return [np.flatnonzero(row) for row in sorted(set(map(tuple, linked.tolist())))]
