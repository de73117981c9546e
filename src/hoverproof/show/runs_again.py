"""The beginning of many flights, flown again for more samples of it than their file has."""

from __future__ import annotations

import tempfile
from pathlib import Path

import xarray as xr

from hoverproof.mission.sections import Mission
from hoverproof.show.panels import beginning
from hoverproof.simulation.flight import flown
from hoverproof.simulation.runs import simulate_batch
from hoverproof.simulation.timing import Timing

MOST_AGAIN = 2000
"""So many runs are flown again, the first of them."""


def beginning_again(mission: Mission, runs: xr.Dataset) -> xr.Dataset | None:
    """Fly runs again for as long as tilt and thrusts stray, if that is short; else return None.

    Parameters
    ----------
    mission : Mission
        That of the runs.
    runs : Dataset
        From `hoverproof.simulate_batch`: the seed and step of them make them the same again.
    """
    step = float(runs.attrs["step"])
    early = beginning(flown(mission, Timing(float(runs["time"].values[-1]), step)))
    if early is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        again = simulate_batch(
            mission,
            Path(folder) / "again.nc",
            runs=min(int(runs.attrs["runs"]), MOST_AGAIN),
            seed=int(runs.attrs["seed"]),
            duration=early,
            step=step,
        )
        if again.interrupted:
            raise KeyboardInterrupt
        with again.open() as found:
            return found.load()
