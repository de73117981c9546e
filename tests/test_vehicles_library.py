"""The vehicles of examples/vehicles: sane, with sources, proved from their starts, and flown."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hoverproof.certification.exponential.proof import converge
from hoverproof.mission.reading import load
from hoverproof.plausibility import warnings
from hoverproof.simulation.flight import simulate
from sampling import mostly_whole

FOLDER = Path(__file__).parent.parent / "examples" / "vehicles"
FILES = sorted(FOLDER.glob("*.toml"))


def test_there_are_ten_of_four_layouts_and_one_has_six_rotors():
    frames = [load(path).vehicle.frame for path in FILES]
    assert len(FILES) >= 10
    assert len({frame.places for frame in frames}) >= 4
    assert max(len(frame.names) for frame in frames) == 6


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_a_vehicle_has_sources_is_sane_and_flies_to_its_goal(path):
    head = path.read_text(encoding="utf-8").partition("name =")[0]
    assert any(source in head for source in ("RotorPy", "RotorS", "PX4", "MuJoCo", "assumed"))
    mission = load(path)
    assert warnings(mission) == []
    start, goal = (np.array([float(c) for c in p]) for p in (mission.start.position, (0, 0, 0)))
    goal[2] = -float(mission.goal.height)
    flight = simulate(
        mission, duration=6, step=0.01 if float(mission.vehicle.mass) > 0.1 else 0.004
    )
    assert flight.attrs["outcome"] == "flown"
    way = np.linalg.norm(flight["position"].values - goal, axis=1)
    assert way[-1] < 0.5 * np.linalg.norm(start - goal)


@pytest.mark.slow
@pytest.mark.parametrize("path", mostly_whole(FILES, every=5), ids=lambda p: p.stem)
def test_a_vehicle_is_proved_from_its_start(path):
    mission = load(path)
    assert converge(mission).proved  # which the checker has accepted
