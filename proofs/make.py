"""Make the certificates of all presets anew: ``python proofs/make.py [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from hoverproof.certification.certificate import seal
from hoverproof.certification.gains import Proved, certify
from hoverproof.certification.problem import gain_problem
from hoverproof.certification.region import Region, default_box, enclose, holds_over
from hoverproof.mission import load, presets


def make(folder: Path) -> None:
    """Write, for each preset, NAME.cert.json, NAME.region.cert.json and NAME.over-box.cert.json."""
    for name in presets():
        mission = load(name)
        box, bounds = default_box(mission), mission.bounds.eigenvalues
        if not holds_over(mission, box, bounds):
            raise SystemExit(f"{name}: the eigenvalue bounds are not proved around start and goal")
        region = Region(box, bounds, (float("nan"), float("nan")))
        seal(gain_problem(mission, region=region), "region", {}).save(
            folder / f"{name}.region.cert.json"
        )
        for ending, enclosed in (("cert", None), ("over-box.cert", enclose(mission, box))):
            verdict = certify(mission, region=enclosed)
            if not isinstance(verdict, Proved):
                raise SystemExit(f"{name}: {verdict.status}")
            verdict.certificate.save(folder / f"{name}.{ending}.json")


if __name__ == "__main__":
    make(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
