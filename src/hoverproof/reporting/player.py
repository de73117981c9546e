"""The numbers from which a page shows a flight in motion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.reporting.parts import Flown
from hoverproof.show.image_plane import WIDEST, seen
from hoverproof.show.scene import Scene
from hoverproof.simulation.record import Record

MOST_SAMPLES = 500
DRAWN_SPAN = 0.2


def player_data(flown: Flown) -> dict[str, Any]:
    """Return what the player in a page is given, for JSON.

    Parameters
    ----------
    flown : Flown
    """
    flight, scene = flown.whole, Scene.of(flown.whole)
    yaw = float(flight["euler_angles"].values[-1, 2])
    duration = float(flight["time"].values[-1])
    spans = [{"name": f"whole flight, {duration:g} s", **_track(flight)}]
    if flown.beginning is not None:
        until = float(flown.beginning["time"].values[-1])
        spans.append({"name": f"first {until:g} s", **_track(flown.beginning)})
    extent = float(np.ptp(np.vstack([flight["position"].values, scene.points]), axis=0).max())
    size = DRAWN_SPAN * extent / (2 * math.sqrt(2) * scene.arm)
    return {
        "spans": spans,
        "target": _short(scene.points),
        "goal": _short(scene.goal),
        "goal_image": _short(scene.goal_image(yaw)),
        "image_size": scene.image_size,
        "lens": math.tan(half) if (half := scene.half_angle) and half <= WIDEST else None,
        "rotors": _short(scene.rotor_places),
        "arm": scene.arm,
        "drawn_size": 1 if size < 1.5 else round(size),
    }


def _track(flight: Record) -> dict[str, Any]:
    """Return a flight at so many times that a page need not hold more."""
    last = len(flight["time"].values) - 1
    kept = np.unique(np.linspace(0, last, min(MOST_SAMPLES, last + 1)).round().astype(int))
    turns = _quaternions(flight["rotation"].values[kept])
    for i in range(1, len(turns)):  # q and -q are one attitude: take the nearer
        if turns[i] @ turns[i - 1] < 0:
            turns[i] = -turns[i]
    return {
        "time": _short(flight["time"].values[kept], 8),
        "position": _short(flight["position"].values[kept]),
        "attitude": _short(turns),
        "tilt": _short(np.degrees(flight["tilt"].values[kept])),
        "thrust": _short(flight["thrust"].values[kept], 7),
        "image": _short(seen(flight)[kept].reshape(len(kept), -1)),
    }


def _quaternions(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return unit quaternions, scalar first, (k, 4), of rotations, (k, 3, 3).

    SciPy's `Rotation` does as much, and takes as long to import as a page takes to fill.
    """
    a, b, c = np.moveaxis(turns, 0, -1)
    four = np.array(  # 4 q qᵀ, of which every row is a multiple of q
        [
            [1 + a[0] + b[1] + c[2], c[1] - b[2], a[2] - c[0], b[0] - a[1]],
            [c[1] - b[2], 1 + a[0] - b[1] - c[2], b[0] + a[1], a[2] + c[0]],
            [a[2] - c[0], b[0] + a[1], 1 - a[0] + b[1] - c[2], c[1] + b[2]],
            [b[0] - a[1], a[2] + c[0], c[1] + b[2], 1 - a[0] - b[1] + c[2]],
        ]
    )
    largest = np.einsum("iik->ik", four).argmax(axis=0)
    rows = four[largest, :, np.arange(len(turns))]
    return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True))


def _short(values: NDArray[np.float64], digits: int = 5) -> Any:
    """Return nested lists, rounded to so many digits of the largest of all; None for NaN."""
    known = np.isfinite(values)
    largest = float(np.abs(values[known]).max(initial=0.0)) or 1.0
    places = digits - 1 - math.floor(math.log10(largest))
    told = (np.round(values, max(places, 0)) + 0.0).astype(object)
    told[~known] = None
    return told.tolist()
