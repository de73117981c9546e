"""Make the certificates of all presets anew: ``python proofs/make.py [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from hoverproof.certification.gains import Proved, certify
from hoverproof.certification.over_box import certify_region
from hoverproof.certification.region import default_box
from hoverproof.mission import load, presets


def make(folder: Path) -> None:
    """Write, for each preset, NAME.cert.json, NAME.region.cert.json and NAME.over-box.cert.json."""
    for name in presets():
        mission = load(name)
        box = default_box(mission)
        over_box = certify_region(mission, box)
        if over_box.status != "proved" or over_box.certificate is None:
            raise SystemExit(f"{name}: eigenvalue bounds over its box: {over_box.status}")
        over_box.certificate.save(folder / f"{name}.region.cert.json")
        for ending, enclosed in (("cert", None), ("over-box.cert", over_box.enclosure)):
            verdict = certify(mission, region=enclosed)
            if not isinstance(verdict, Proved):
                raise SystemExit(f"{name}: {verdict.status}")
            verdict.certificate.save(folder / f"{name}.{ending}.json")


if __name__ == "__main__":
    make(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
