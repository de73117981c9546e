"""A vehicle of 0.5 kg above a tag of 20 cm, which the tests of the eight laws fly and certify."""

from __future__ import annotations

SMALL = """
name = "small"
[vehicle]
mass = 0.5
inertia = [2.32e-3, 2.32e-3, 4e-3]
lever = 0.12
drag_ratio = 0.016
gravity = 9.81
[target]
points = [[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, -0.1, 0], [-0.1, 0.1, 0]]
[goal]
height = 1.2
[gains]
k1 = 0.0566
k2 = 22
k3 = 1.75
k4 = 6
k_yaw = 0.05
[bounds]
eigenvalues = {bounds}
thrust = [4, 6]
[start]
position = {start}
"""
"""A mission file with gains for the scaled feature."""


def small_vehicle(bounds, start):
    """Return the mission file with bounds of eigenvalues and a start position, as TOML."""
    return SMALL.format(bounds=bounds, start=start)
