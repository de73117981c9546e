"""Autopilots that a package has glue for: a folder of templates each.

A template ``FILE.j2`` of a folder here becomes ``FILE`` in a folder of that name among the
adapters of a package, with ``NAME`` in it replaced by the name of the package. ``where.md.j2`` is a
paragraph of ``adapters/README.md``: where the files go, and what flies when the law cannot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources

WHERE = "where.md.j2"


@dataclass(frozen=True)
class Target:
    """An autopilot.

    Attributes
    ----------
    folder : str
        Of its templates, and of its files in a package.
    title : str
        As its people write it.
    """

    folder: str
    title: str

    @property
    def where(self) -> str:
        """The template that says where its files go."""
        return f"targets/{self.folder}/{WHERE}"

    def files(self) -> Mapping[str, str]:
        """Return the template of each of its files, by the path in a package."""
        found = resources.files("hoverproof.export.targets") / self.folder
        names = sorted(entry.name for entry in found.iterdir() if entry.name.endswith(".j2"))
        return {
            f"adapters/{self.folder}/{name.removesuffix('.j2').replace('NAME', '{name}')}": (
                f"targets/{self.folder}/{name}"
            )
            for name in names
            if name != WHERE
        }


TARGETS = (
    Target("crazyflie", "Crazyflie"),
    Target("px4", "PX4"),
    Target("ardupilot", "ArduPilot"),
)
"""In the order in which a package tells of them."""


def titles(targets: tuple[Target, ...] = TARGETS) -> str:
    """Return their titles as a list in words.

    Parameters
    ----------
    targets : tuple of Target
    """
    *some, last = (target.title for target in targets) if targets else ("no autopilot",)
    return f"{', '.join(some)} and {last}" if some else last
