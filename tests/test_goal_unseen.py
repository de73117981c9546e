"""A hover that does not exist is refused in words and numbers, and never found as not a number."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.plant.goal import hover_goal

ROUGH = [[0.99, 0.4, -0.65], [1.09, 0.54, -0.27], [0.7, 0.44, 0.15], [0.03, 0.66, -0.37]]


def mission(points, centroid, **settings):
    return load(
        "x4-flyer",
        {
            "target.points": points,
            "goal": {"centroid": centroid},
            "start.position": [0.1, 0.2, -100],
            **settings,
        },
    )


def test_a_centroid_that_is_seen_below_the_highest_point_alone_is_refused_with_the_numbers():
    with pytest.raises(InputError, match=r"no level hover sees the centroid \[0, 0, 1.9641\]") as e:
        hover_goal(mission(ROUGH, [0, 0, 1.9641]))
    assert e.value.key == "goal.centroid"
    assert "z = -0.65 m" in str(e.value)  # where the highest point is
    assert "nan" not in str(e.value)


def test_a_centroid_toward_which_the_camera_comes_down_to_a_point_names_the_point():
    triangle = [[0, 0, 0], [1, 0, 0], [-0.5, 0.3, 0]]
    with pytest.raises(InputError, match=r"target point 1, \[0, 0, 0\] m"):
        hover_goal(mission(triangle, [0, 0, 0.1]))


def test_a_goal_is_finite_and_sees_what_is_asked_or_is_refused():
    rng = np.random.default_rng(7)
    found = refused = 0
    for _ in range(60):
        count, size = int(rng.integers(2, 6)), 10.0 ** rng.uniform(-3, 3)
        points = size * rng.uniform(-1, 1, (count, 3)) * [1, 1, 10 ** rng.uniform(-4, 0)]
        tilt, length = rng.uniform(0, 1.5), count * (1 - 10 ** -rng.uniform(0, 6))
        centroid = [length * math.sin(tilt), 0.0, length * math.cos(tilt)]
        start = [0.01, 0.02, float(-2 * size)]
        asked = mission(points.tolist(), centroid, **{"start.position": start})
        try:
            position = np.array(hover_goal(asked).position, float)
        except InputError as error:
            assert "no level hover sees the centroid" in str(error)
            refused += 1
            continue
        rays = points - position
        seen = (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)
        assert np.allclose(seen, centroid, atol=1e-6)
        assert position[2] < points[:, 2].min()
        found += 1
    assert found > 10
    assert refused > 0
