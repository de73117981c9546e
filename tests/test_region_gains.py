"""Gains for a large region of attraction: fast enough, within limits, and proved as printed."""

from __future__ import annotations

import json
import math
from contextlib import chdir, redirect_stdout
from fractions import Fraction
from io import StringIO
from pathlib import Path

import numpy as np
import pytest

from command_line import run
from hoverproof import checker, cli
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.proof import estimate
from hoverproof.certification.attraction.search import HoverGrid
from hoverproof.design.limits import Limits, bandwidth
from hoverproof.design.outcome import Infeasible, RegionTuned
from hoverproof.design.region_search import GainRegionSearch
from hoverproof.design.region_tuning import tune_region
from hoverproof.design.tuning import tune
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.servo.linearised import slowest_rate
from hoverproof.simulation.flight import simulate, summary
from papers_law import CRAZYFLIE
from sharing import kept

FIVE_TIMES = 0.02337
"""1/s, five times the slowest motion of the paper's gains."""


@pytest.fixture(scope="module")
def folder():
    """Where the command has tuned the paper's vehicle, five times as fast."""

    def make(made):
        made.mkdir()
        options = ["--minimum-decay", str(FIVE_TIMES), "--out", "wide.toml", "--json"]
        words = StringIO()
        with chdir(made), redirect_stdout(words), pytest.raises(SystemExit) as exit_:
            cli.main(["tune", "x4-flyer", "--objective", "region", *options])
        assert exit_.value.code == 0
        (made / "answer.json").write_text(words.getvalue())

    return kept("gains for a region", make)


@pytest.fixture(scope="module")
def out(folder):
    return folder / "wide.toml"


@pytest.fixture(scope="module")
def answer(folder):
    """What the command says."""
    said = json.loads((folder / "answer.json").read_text())
    return said | {"certificate": str(folder / said["certificate"])}


def four(mission):
    g = mission.gains
    return [float(k) for k in (g.k1, g.k2, g.k3, g.k4)]


def ball(mission):
    """Return the radius of the ball of hovers that the search for a region finds, m."""
    found = estimate(mission)
    return HoverGrid.of(Potential.of(mission)).radius(found.weights, found.level, None)


def test_five_times_faster_the_region_is_larger_than_that_of_the_paper_s_gains(answer, x4):
    assert answer["slowest_rate"] >= 5 * slowest_rate(x4)
    assert answer["slowest_rate_before"] == pytest.approx(slowest_rate(x4), rel=1e-9)
    for way, wanted in (("sideways", 2), ("up", 3), ("down", 2)):
        assert answer["reach"][way] > max(wanted, answer["reach_before"][way])
    assert answer["time_constant"] == pytest.approx(1 / answer["slowest_rate"])


def test_the_gains_in_the_file_are_the_proved_ones_within_the_limits(answer, out):
    mission = load(str(out))
    assert {k: float(v) for k, v in mission.gains} == answer["gains"]
    assert bandwidth(mission) <= 20
    assert slowest_rate(mission) >= FIVE_TIMES
    assert "bandwidth" in answer["binds"]
    path = Path(answer["certificate"])
    assert path == out.with_suffix(".tuned.cert.json")  # `attraction` writes another
    content = json.loads(path.read_text())
    assert content["mission"] == mission.exact()
    assert checker.check(content) == content["statement"]
    claimed = {way: float(Fraction(v)) for way, v in content["claim"]["reach"].items()}
    assert claimed == answer["reach"]
    for gain in four(mission):
        assert len(f"{gain:g}".replace(".", "").strip("0")) <= 5


def test_a_flight_from_the_edge_of_the_region_settles(answer, out):
    side = repr(answer["reach"]["sideways"])
    mission = load(str(out), {"start.position": f"[{side}, 0, -3]"})
    assert summary(simulate(mission))["outcome"] == "flown"
    assert summary(simulate(mission))["settled_at"] < 10 / FIVE_TIMES


@pytest.mark.parametrize(("stiff", "k3"), [(3, 20), (20, 20), (50, 5)])
def test_k1_is_the_smallest_that_settles_fast_enough(x4, stiff, k3):
    search = GainRegionSearch.of(x4, Limits(20.0), FIVE_TIMES)
    k1, k2, k3, k4 = search.gains(stiff, k3)
    assert k1 * k2 == pytest.approx(stiff)
    assert stiff + k3 + k4 == pytest.approx(20 * 9.6)

    def rate(k1):
        gains = zip(("k1", "k2", "k3", "k4"), (k1, stiff / k1, k3, k4), strict=True)
        return slowest_rate(load("x4-flyer", {f"gains.{k}": repr(float(v)) for k, v in gains}))

    assert rate(k1) >= FIVE_TIMES * (1 - 1e-9)
    assert rate(k1 * 0.99) < FIVE_TIMES


@pytest.mark.slow
@pytest.mark.long
def test_no_random_feasible_gains_have_a_larger_ball(answer, out, whole):
    """The rule for k1 and k4 included: the random gains keep the limits, and no more.

    There are 2 of them, and 40 with `make trials`.
    """
    most, rng, seen = 20 * 9.6, np.random.default_rng(3), []
    best, tuned = ball(load(str(out))), four(load(str(out)))
    while len(seen) < (40 if whole else 2):
        wide = 10 ** rng.uniform((-1.5, -1, 0, 0), (1.5, 2.3, 2.3, 2.3))
        k1, k2, k3, k4 = wide if len(seen) % 2 else tuned * np.exp(rng.normal(0, 0.3, 4))
        gains = zip(("k1", "k2", "k3", "k4"), (k1, k2, k3, k4), strict=True)
        mission = load("x4-flyer", {f"gains.{k}": repr(float(v)) for k, v in gains})
        if k1 * k2 + k3 + k4 > most or slowest_rate(mission) < FIVE_TIMES:
            continue
        try:
            seen.append(ball(mission))
        except (ValueError, InputError):
            seen.append(0.0)
    assert max(seen) <= 1.02 * best
    assert max(seen) > 0.8 * best  # the sample does come near


# --- wishes that cannot be met --------------------------------------------------------------------


def test_a_speed_beyond_the_bandwidth_is_answered_with_the_fastest_there_is(capsys):
    options = ("--objective", "region", "--minimum-decay", 5, "--out", "no.toml", "--json")
    status, words, _ = run(capsys, "tune", "x4-flyer", *options)
    answer = json.loads(words)
    assert (status, answer["status"]) == (1, "infeasible")
    assert "no gains settle as fast as 5 1/s" in answer["reason"]
    assert "1/s short" in answer["reason"]
    assert not list(Path().glob("no.*"))


@pytest.mark.slow
def test_a_speed_without_a_region_is_answered_with_one_that_has_a_region(x4, whole):
    refused = tune(x4, objective="region", minimum_decay=0.3)
    assert isinstance(refused, Infeasible)
    assert "no region of attraction was found" in refused.reason
    possible = float(refused.reason.rsplit(" ", 1)[1].rstrip(")"))
    assert FIVE_TIMES < possible < 0.3
    if whole:
        tuned = tune(x4, objective="region", minimum_decay=possible)
        assert tuned.slowest_rate >= possible


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"objective": "region", "at_least": 1e-3}, "at_least: is about L"),
        ({"objective": "region", "weights": "search"}, "weights: is about L"),
        ({"objective": "decay", "minimum_decay": 1e-3}, "minimum_decay: is for"),
        ({"objective": "region", "minimum_decay": -1.0}, "minimum_decay: must be a rate from"),
    ],
)
def test_options_of_another_objective_are_refused(x4, options, message):
    with pytest.raises(InputError, match=message):
        tune(x4, **options)


def test_a_goal_off_the_axis_is_refused():
    mission = load("x4-flyer", {"goal": "{centroid = [0.3, 0.2, 3.5]}"})
    with pytest.raises(InputError, match="is not straight below"):
        tune_region(mission, Limits(20.0))


# --- the curve ------------------------------------------------------------------------------------


@pytest.mark.whole
def test_the_curve_of_region_against_speed_falls_and_each_point_is_proved(capsys):
    count = 3
    options = ("--objective", "region", "--pareto", count, "--out", "curve.svg", "--json")
    status, words, _ = run(capsys, "tune", CRAZYFLIE, *options)
    answer = json.loads(words)
    assert status == 0
    points = answer["points"]
    assert len(points) == count
    speeds = [p["slowest_rate"] for p in points]
    floors = [p["minimum_decay"] for p in points]
    assert all(a >= b for a, b in zip(speeds, floors, strict=True))
    assert floors == sorted(floors)
    assert math.isclose(floors[0] * floors[2], floors[1] ** 2, rel_tol=0.02)
    for way in ("sideways", "up", "down"):
        reach = [p["reach"][way] for p in points]
        assert reach == sorted(reach, reverse=True)
    assert "<svg" in Path("curve.svg").read_text()


@pytest.mark.slow
def test_a_wish_that_asks_for_next_to_nothing_has_an_answer(x4):
    assert isinstance(tune(x4, objective="region", minimum_decay=1e-6), RegionTuned | Infeasible)


@pytest.mark.slow
def test_where_those_of_a_barrier_reach_farther_it_is_said_of_which_gains(capsys):
    out = " ".join(run(capsys, "tune", "x4-flyer", "--objective", "region")[1].split())
    assert "both are sets of all states, moving or not" in out
    assert (
        "with a barrier attraction may prove level hovers much farther away: of the mission's own "
        "gains, not of the new ones (a barrier needs k3 >= 3 k1 k2)"
    ) in out
