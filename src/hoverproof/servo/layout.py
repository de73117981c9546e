"""Layouts: named quantities with units that also stand as one vector."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, fields
from functools import cache
from typing import Any, Self, TypeVar, cast

import casadi as ca


def scalar(unit: str, *, gain: bool = False) -> Any:
    """Declare a scalar field of a layout.

    Parameters
    ----------
    unit : str
        As ``"kg"``; ``"1"`` if it has none.
    gain : bool
        Whether it is one of the gains of a law.
    """
    return field(metadata={"size": 1, "unit": unit, "gain": gain})


def column(unit: str, size: int = 3) -> Any:
    """Declare a field of a layout that is a column.

    Parameters
    ----------
    unit : str
        Of its components.
    size : int
        Number of components.
    """
    return field(metadata={"size": size, "unit": unit, "gain": False})


def place(sizes: Mapping[str, int], name: str) -> slice:
    """Return where a part of a layout stands.

    Parameters
    ----------
    sizes : dict of int
        Sizes of the parts, bare numbers, in order.
    name : str
        Of the part.
    """
    names = list(sizes)
    begin = sum(sizes[before] for before in names[: names.index(name)])
    return slice(begin, begin + sizes[name])


class Packed:
    """A dataclass of `scalar` and `column` fields, which also stand as one vector in their order.

    A dataclass that extends one has its own fields after those.
    """

    @classmethod
    def sizes(cls) -> dict[str, int]:
        """Return the layout: the size of each field by its name, in order."""
        return {f.name: f.metadata["size"] for f in fields(cls)}  # type: ignore[arg-type]

    @classmethod
    def units(cls) -> dict[str, str]:
        """Return the unit of each field by its name, in order."""
        return {f.name: f.metadata["unit"] for f in fields(cls)}  # type: ignore[arg-type]

    @classmethod
    def size(cls) -> int:
        """Return the size of the vector."""
        return sum(cls.sizes().values())

    @classmethod
    def place(cls, name: str) -> slice:
        """Return where a field stands in the vector.

        Parameters
        ----------
        name : str
            Of the field.
        """
        return place(cls.sizes(), name)

    @classmethod
    def symbols(cls) -> Self:
        """Return an object of fresh symbols."""
        return cls(**{name: ca.SX.sym(name, size) for name, size in cls.sizes().items()})

    @classmethod
    def from_vector(cls, vector: ca.SX) -> Self:
        """Unpack a column.

        Parameters
        ----------
        vector : SX
            (n, 1), n the size of the layout, in the order of the fields.
        """
        return cls(**{name: vector[cls.place(name)] for name in cls.sizes()})

    def vector(self) -> ca.SX:
        """Pack into one column, in the order of the fields."""
        packed: ca.SX = ca.vertcat(*(getattr(self, name) for name in self.sizes()))
        return packed


Layout = TypeVar("Layout", bound=Packed)


def resized(layout: type[Layout], sizes: tuple[tuple[str, int], ...]) -> type[Layout]:
    """Return a layout with other sizes of some of its parts; the same type for the same sizes.

    Parameters
    ----------
    layout : type of Packed
    sizes : tuple of (str, int)
        Names of parts and their numbers of components; those that it has not are left out.
    """
    own = layout.sizes()
    other = tuple((name, size) for name, size in sizes if own.get(name, size) != size)
    kind: Any = layout
    return cast(type[Layout], _resized(kind, other)) if other else layout


@cache
def _resized(layout: Any, sizes: tuple[tuple[str, int], ...]) -> Any:
    class Resized(layout):  # type: ignore[misc]
        @classmethod
        def sizes(cls) -> dict[str, int]:
            own: dict[str, int] = super().sizes()
            return own | dict(sizes)

    return Resized
