"""Missions with the law of the paper, by name: its vehicle and others. Not a test itself.

The presets of vehicles that are built have the law that `new` recommends; these are the same
vehicles with the centroid, a goal in the image and a modelled force, tuned for the decay of L.
"""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parent / "missions"
CRAZYFLIE, RACER, RESEARCH = (
    str(FOLDER / f"{name}.toml") for name in ("crazyflie-2.1", "racer-250", "research-1.5kg")
)
PAPERS = {Path(path).stem: path for path in (CRAZYFLIE, RACER, RESEARCH)}
PAPERS |= {name: name for name in ("x4-flyer", "x4-flyer-tuned")}
