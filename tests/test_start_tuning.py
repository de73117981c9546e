"""Gains by the start: soon settled for every vehicle within tolerance, and proved as printed."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hoverproof import checker, cli
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.program import Ball, falls, solve
from hoverproof.certification.exponential.search import FAILED, OUTSIDE, Search
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.design.limits import Limits
from hoverproof.design.start_search import Point, StartSearch
from hoverproof.design.start_tuning import why_not
from hoverproof.design.tuning import Wish, pareto, tune
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.servo.loop import slowest_rate
from small_kit import small_vehicle

DOUBTS = (
    "{thrust = 0.2, torque = 0.2, latency = 0.06, rotor_lag = 0.03, wind = 0.2, yaw_rate = 0.5}"
)
SCALED = {"law": '{feature = "scaled", goal = "inertial", force = "measured"}'}
GAINS = "{k1 = 0.0135, k2 = 65, k3 = 1.6, k4 = 6.3, k_yaw = 0.004}"
LATE = {**SCALED, "gains": GAINS, "uncertainty": DOUBTS, "sensors.gyro_turned": "true"}


@pytest.fixture
def small(tmp_path, monkeypatch):
    """Return a function (start, changes) ↦ mission."""
    monkeypatch.chdir(tmp_path)

    def made(start="[0.3, 0, -1.4]", changes=LATE):
        Path("small.toml").write_text(small_vehicle("[4, 16]", start))
        return load("small.toml", changes)

    return made


def resized(mission, times):
    """Return a mission with its vehicle, and its target and way there, as much larger."""
    vehicle, far = mission.vehicle, 1 if times > 1 else 2
    sizes = {"mass": vehicle.mass * times, "inertia": [i * times for i in vehicle.inertia]}
    return load(
        "small.toml",
        {
            **LATE,
            "bounds": "{eigenvalues = [4, 16], level = 20}",
            "vehicle.mass": str(float(sizes["mass"])),
            "vehicle.inertia": str([float(i) for i in sizes["inertia"]]),
            "start.position": str([0.3 / far, 0, -1.3]),
        },
    )


@pytest.mark.parametrize("mass_ratio", [0.04, 1, 40])
def test_the_search_sets_out_inside_for_vehicles_of_20_g_and_of_20_kg(small, mass_ratio):
    small()
    search = StartSearch.of(resized(small(), mass_ratio), Limits(20.0))
    assert min(search.at(z)[0] for z in itertools.islice(search.guesses(), 4)) < OUTSIDE


def test_few_vertices_give_the_weights_of_all(small):
    mission = small()
    search = replace(
        Search.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),)), wider=0.3
    )
    rate = 0.02
    first = search.deepest(search.terms())
    limits = search.limits(first.x, first.ball)
    every = range(len(list(limits.vertices())))
    level = first.solution.level
    few, whole = (
        solve(limits, first.ball, rate, level, search.terms(), likely) for likely in ((), every)
    )
    assert len(few.tight) < len(every)
    assert few.fill == pytest.approx(whole.fill, rel=1e-5)
    middle, radius = sum(first.ball) / 2, (first.ball[1] - first.ball[0]) / 2
    there, corners = falls(limits, Ball(middle, radius), rate).of_used()
    x = np.array([1, *few.weights, *few.lag, few.slope, few.memory])
    assert len(there) == len(x)
    for corner in corners:
        assert np.linalg.eigvalsh(corner.at(x).bound(few.multipliers))[0] > 0


def test_a_candidate_is_made_faster_and_stays_inside(small):
    mission = small()
    search = replace(
        Search.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),)), wider=0.3
    )
    terms, offset = search.terms(), search.settled_offset
    first = search.deepest(terms)
    last = search.soonest(first, terms, offset)
    assert last.time(offset) < first.time(offset) / 2
    assert last.solution.fill < 1


def test_the_rate_of_the_controller_and_the_rotors_are_the_mission_s(small):
    slow = {**LATE, "sensors": "{gyro_turned = true, control_rate = 20}"}
    mission = small(changes={**slow, "rotors": "{max_thrust = 1.5}"})
    limits = Wish(objective="start").limits(mission)
    assert (limits.fastest, limits.rotors) == (4.0, (0.0, 1.5))
    search = StartSearch.of(mission, limits)
    _, guess = itertools.islice(search.guesses(), 2)  # the first is the mission's own
    four = np.exp(guess[:4])
    assert search.beyond(four) == 0
    assert search.beyond(four * [1, 1, 10, 10]) > 0
    assert Wish(objective="start", rate=50).limits(mission).fastest == 10.0


def test_a_start_beyond_the_bounds_of_J_is_told_how_much_nearer_to_be(small):
    search = StartSearch.of(small("[0, 0, -60]"), Limits(20.0))
    assert search.run(lambda text: None) is None
    words = why_not(search, None)
    assert "no gains were searched" in words
    nearer = float(words.split("a start about ")[1].split(" m nearer")[0])
    assert 0 < nearer < 58.8


def test_from_as_near_as_is_advised_the_same_gains_hold_the_start(small):
    mission = small("[0.6, 0, -1.8]")
    search = StartSearch.of(mission, Limits(20.0))
    points = [Point(search.at(z)[0], z) for z in itertools.islice(search.guesses(), 1, 5)]
    point = max((p for p in points if p.cost < FAILED), key=lambda p: p.cost)
    assert point.cost > OUTSIDE
    words = why_not(search, point)
    assert "times the level" in words
    nearer = float(words.split("a start about ")[1].split(" m nearer")[0])
    goal = search.whole.scene.goal
    away = np.array(mission.start.position, float) - goal
    place = goal + away * (1 - 1.1 * nearer / np.linalg.norm(away))
    there = StartSearch.of(small(str(place.tolist())), Limits(20.0))
    assert there.at(point.z)[0] < OUTSIDE


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"at_least": 0.1}, "--at-least"),
        ({"minimum_decay": 0.1}, "--minimum-decay"),
        ({"weights": "search"}, "--weights"),
    ],
)
def test_wishes_about_other_things_are_refused(small, options, word):
    with pytest.raises(InputError, match=word):
        tune(small(), objective="start", **options)


def test_a_mission_of_the_centroid_is_refused(small):
    with pytest.raises(InputError, match=r'law.feature.*write feature = "scaled"'):
        tune(small(changes={}), objective="start")


def test_a_curve_is_refused(small):
    with pytest.raises(InputError, match="--pareto"):
        pareto(small(), 3, Wish(objective="start"))


@pytest.mark.slow
def test_tune_writes_a_mission_and_a_certificate_that_holds_its_start(small, capsys):
    small("[0.2, 0, -1.3]")
    words = [f"--set={key}={value}" for key, value in {**SCALED}.items()]
    with pytest.raises(SystemExit) as exit_:
        cli.main(
            ["tune", "small.toml", "--objective", "start", "--out", "t.toml", "--json", *words]
        )
    assert exit_.value.code == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["settling_time_flown"] < answer["settling_time"]
    assert answer["settling_time"] < answer["settling_time_before"]
    tuned = load("t.toml")
    assert {k: float(getattr(tuned.gains, k)) for k in ("k1", "k2")}.items() <= answer[
        "gains"
    ].items()
    assert slowest_rate(tuned) > 0
    assert "the controller may be switched on" in checker.check_file(answer["certificate"])
