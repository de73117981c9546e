"""What `export` answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.words import as_argument, interval


@dataclass(frozen=True)
class ExportAnswer(Answer):
    """A folder of firmware, and its manifest."""

    mission: str
    out: Path
    manifest: Mapping[str, Any]
    precision: str
    limits_given: bool

    @property
    def considered(self) -> list[str]:
        """What its theorems cover of what the mission asks for."""
        return list(self.manifest["covers"])

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        manifest = self.manifest
        standing = "UNCERTIFIED: nothing is proved"
        if manifest["certified"]:
            symbol = "J" if manifest["law"]["feature"] == "scaled" else "Q"
            numbers = manifest["theorems"]
            standing = f"certified (theorem{'s' * (len(numbers) > 1)} {', '.join(numbers)})"
            if manifest["eigenvalue_bounds"]:
                bounds = f"bounds of {symbol} {manifest['eigenvalue_bounds']}"
                standing = standing.replace(")", f"; {bounds})")
        yield f"{self.mission}: firmware written, {self.precision}, {standing}"
        yield f"  folder  {self.out}"
        yield f"  thrust  {interval(manifest['thrust'])} N, monitored"
        if (commanded := manifest["commanded_thrust"]) != manifest["thrust"]:
            yield f"          as felt; as commanded within tolerance {interval(commanded)} N"
        option = "" if self.limits_given else " (--rotor-limits)"
        each = manifest.get("each_rotor")
        limits = f"{interval(manifest['rotor_limits'])} N each{option}"
        yield f"  rotors  {', '.join(map(interval, each)) + ' N' if each else limits}"
        kept = "; proved to hold" if manifest["rotor_limits_kept"] else ""
        yield f"          {manifest['rotor_limits_from']}{kept}"
        if "rate_bandwidth" in manifest:
            bandwidth = float(Fraction(manifest["rate_bandwidth"]))
            yield f"  rates   and throttle are commanded, to a rate loop of {bandwidth:g} rad/s"
        yield "SHA-256 of the law, and of the certificate of each theorem:"
        yield f"  law        {manifest['law_sha256']}"
        for theorem, sha256 in manifest["theorems"].items():
            yield f"  theorem {theorem}  {sha256}"
        build = "cc -std=c99 -O2 -I. *.c example/*.c -lm -o fly"
        yield f"Next: cd {as_argument(self.out)} && {build} && ./fly"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {"out": str(self.out), **self.manifest}


def refused_as_json(mission: str, verdict: str) -> dict[str, Any]:
    """Return that nothing was written, since nothing is proved, as an object for machines."""
    return {"mission": mission, "verdict": verdict, "out": None}
