"""Gains by the start: soon settled for every vehicle within tolerance, and proved as printed."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from command_line import run
from exponential_truth import MISSION, SMALL, soon_found
from hoverproof import checker, cli
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.cells import most_cells
from hoverproof.certification.convergence import attraction
from hoverproof.certification.exponential.closeness import FEW, closest, is_shown
from hoverproof.certification.exponential.domain import COST_BESIDE, Domain
from hoverproof.certification.exponential.inequality import Ball, falls
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.program import Program
from hoverproof.certification.exponential.proof import converge, settling
from hoverproof.certification.exponential.question import Question
from hoverproof.certification.exponential.search import deepest
from hoverproof.certification.exponential.sooner import soonest
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.cli.answers.beyond import beyond_text, covering
from hoverproof.cli.answers.start_tuned import _flown
from hoverproof.cli.answers.words import limits_text
from hoverproof.design import start_trade
from hoverproof.design.limits import Limits, Use
from hoverproof.design.start_guesses import guesses
from hoverproof.design.start_search import StartSearch
from hoverproof.design.start_tuning import Failed, ill_conditioned, why_not
from hoverproof.design.tuning import Wish, pareto, tune
from hoverproof.errors import InputError
from hoverproof.mission.conditions import Rotors
from hoverproof.mission.reading import load
from hoverproof.servo.linearised import slowest_rate
from sampling import mostly_whole
from small_kit import small_vehicle
from start_trials import sooner, soonest_at_random, vehicle

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


@pytest.mark.slow
@pytest.mark.parametrize("mass_ratio", mostly_whole([0.04, 1, 40], every=3, first=2))
def test_the_search_sets_out_near_for_vehicles_of_20_g_and_of_20_kg(small, mass_ratio):
    small()
    search = StartSearch.of(resized(small(), mass_ratio), Limits(20.0))
    assert search.held(None) is not None


def test_few_vertices_give_the_weights_of_all(small):
    mission = small()
    question = replace(
        Question.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),)), wider=0.3
    )
    rate = 0.02
    first = deepest(question, question.terms())
    limits = question.limits(first.x, first.ball)
    every = range(len(list(limits.vertices())))
    level = first.solution.level
    program = Program.of(limits, first.ball, rate, level, question.terms())
    few, whole = (program.solve(likely) for likely in ((), every))
    assert len(few.tight) < len(every)
    assert few.fill == pytest.approx(whole.fill, rel=1e-5)
    middle, radius = sum(first.ball) / 2, (first.ball[1] - first.ball[0]) / 2
    there, corners = falls(limits, Ball(middle, radius), rate).of_used()
    x = np.array([1, *few.weights, *few.lag, few.slope, few.memory])
    assert len(there) == len(x)
    for corner in corners:
        assert np.linalg.eigvalsh(corner.at(x).bound(few.multipliers))[0] > 0


NEW = {
    "the field of view": "--mass 0.06 --rotor-distance 0.06 --tag 0.1 --height 0.8 --frame-rate 60 "
    "--latency 0.03 --rotor-lag 0.03 --half-angle 0.7 --start 0.2,0.1,-1",
    "the bandwidth": "--mass 0.04 --rotor-distance 0.05 --tag 0.2 --height 1 --frame-rate 100 "
    "--latency 0.01 --rotor-lag 0.03 --half-angle 1.1 --start 0.2,0,-1.2",
}


@pytest.fixture(params=NEW)
def new(request, tmp_path, monkeypatch, capsys):
    """Return what binds in a mission of `new`, and the mission."""
    monkeypatch.chdir(tmp_path)
    status, _, err = run(capsys, "new", "new.toml", *NEW[request.param].split(), "--yes")
    assert not status, err
    return request.param, load("new.toml")


@pytest.mark.slow
def test_wherever_the_search_sets_out_it_comes_to_gains_that_settle_as_soon(new):
    binding, mission = new
    search = StartSearch.of(mission, Limits(20.0))
    begin = [search.beginnings(lambda text: None)[0], search.from_own()]
    points = [search.descend(z, at) for z, at in begin]
    assert np.ptp([point.cost for point in points]) < 0.02
    over = dict(zip(search.held_to.names(), search.value(points[0].z).over[1:], strict=True))
    assert over[binding] > -0.01


@pytest.mark.whole
def test_no_gains_that_are_given_or_at_random_settle_sooner_than_those_found(new):
    binding, mission = new
    found = tune(mission)
    time = found.verdict.settling.time
    assert found.before is None or time <= found.before.time
    assert time <= 1.02 * float(soonest_at_random(mission, 60))
    names = {"the field of view": "angle", "the bandwidth": "bandwidth"}
    assert any(use.name.startswith(names[binding]) for use in found.uses if use.binds)
    assert converge(found.mission).settling == found.verdict.settling


def test_what_is_short_is_said_alike_as_it_searches_and_in_the_end(small):
    search = StartSearch.of(small(changes={**LATE, "camera.half_angle": "0.3"}), Limits(20.0))
    point = search.point(*search.beginnings(lambda text: None)[0])
    short = search.words(point).removeprefix("not held, ")
    assert "rad beyond the half angle" in short
    assert f"with the best, {short}" in why_not(search, point)


@pytest.mark.parametrize(("time", "said"), [(None, "not within 40 s"), (18.62, "after 18.6 s")])
def test_a_flight_that_does_not_settle_says_within_which_time(time, said):
    assert _flown(time, SimpleNamespace(flown_for=40.0)) == said


def test_a_limit_that_the_search_came_to_binds_though_rounding_leaves_some_of_it():
    use = Use("bandwidth", 19.7, 20.0, "rad/s", "--bandwidth")
    assert not use.binds
    assert list(limits_text([replace(use, reached=True)])) == [
        "  bandwidth: 19.7, limit 20 rad/s: binds (--bandwidth)"
    ]


@pytest.mark.slow
def test_the_dual_tells_how_time_and_rate_change_with_gains_d_share_and_rate(small):
    search = StartSearch.of(small(), Limits(20.0))
    z, at = search.beginnings(lambda text: None)[0]
    slopes = search.times.slopes(z, at)
    for k, step in enumerate([1e-3, 1e-3, 1e-3, 1e-3, -1e-3, 1e-3, 1e-3]):
        new = search.value(z + step * np.eye(7)[k])
        seen = (new.all - at.all) / step
        assert slopes[:, k] == pytest.approx(seen, rel=0.05, abs=0.02), k


@pytest.mark.slow
def test_tune_says_of_gains_what_attraction_says(small):
    found = tune(small("[0.2, 0, -1.3]"))
    assert attraction(found.mission).settling == found.verdict.settling
    assert attraction(small("[0.2, 0, -1.3]")).settling == found.before


def test_where_a_time_is_found_without_a_proof_the_proof_has_that_time():
    mission = load(MISSION, SMALL["late"])
    with soon_found():
        assert settling(mission) == converge(mission).settling


@pytest.mark.slow
def test_a_candidate_is_made_faster_and_stays_inside(small):
    mission = small()
    question = replace(
        Question.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),)), wider=0.3
    )
    terms, offset = question.terms(), question.settled_offset
    first = deepest(question, terms)
    last = soonest(question, first, terms, 40)
    assert last.time(offset) < first.time(offset) / 2
    assert last.solution.fill < 1


def test_the_rate_of_the_controller_and_the_rotors_are_the_mission_s(small):
    slow = {**LATE, "sensors": "{gyro_turned = true, control_rate = 20}"}
    mission = small(changes={**slow, "rotors": "{max_thrust = 1.5}"})
    limits = Wish().limits(mission)
    assert (limits.fastest, limits.rotors) == (4.0, (0.0, 1.5))
    search = StartSearch.of(mission, limits)
    guess = next(guesses(search.whole, limits, search.ends))
    four = np.exp(guess[:4])
    assert (search.held_to.beyond(four[None]) <= 0).all()
    assert (search.held_to.beyond(four[None] * [1, 1, 10, 10]) > 0).any()
    assert Wish(rate=50).limits(mission).fastest == 10.0


def test_a_start_beyond_the_bounds_of_J_is_said_to_be(small):
    search = StartSearch.of(small("[0, 0, -60]"), Limits(20.0))
    assert search.run(lambda text: None) is None
    assert "no gains were searched" in why_not(search, None)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("start", "said"),
    [
        pytest.param(
            "[0.65, 0, -1.9]",
            ("sets of gains were searched", "what binds"),
            marks=pytest.mark.whole,
        ),
        ("[0.9, 0, -2.2]", ("no gains were searched", "off its goal, and the search bounds")),
    ],
)
def test_whoever_follows_the_advice_gets_the_gains_that_were_proved(
    small, capsys, start, said, whole
):
    """Of one piece of advice, and with `make trials` of each."""
    small(start)
    options = [f"--set={key}={value}" for key, value in LATE.items()]
    status, out, _ = run(capsys, "tune", "small.toml", "--json", *options)
    assert status == 1
    answer = json.loads(out)
    assert all(words in answer["reason"] for words in said), answer["reason"]
    assert answer["advice"]
    for advice in answer["advice"] if whole else answer["advice"][:1]:
        followed = [f"--set={setting}" for setting in advice["set"]]
        status, out, _ = run(capsys, "tune", "small.toml", "--json", *options, *followed)
        assert status == 0, advice
        told = json.loads(out)
        assert told["settling_time"] == advice["settling_time"]
        assert not [words for words in told["warnings"] if "not considered" in words]


def test_with_the_centroid_over_a_small_target_height_is_said_to_be_ill_conditioned(small):
    words = ill_conditioned(small(changes={}))
    factor = float(words.split("a factor of ")[1].split(";")[0])
    rays = [np.array([x, y, 1.2]) for x in (0.1, -0.1) for y in (0.1, -0.1)]
    Q = sum((np.eye(3) - np.outer(r, r) / (r @ r)) / np.linalg.norm(r) for r in rays)
    values = np.linalg.eigvalsh(Q)
    assert factor == pytest.approx(values[-1] / values[0], rel=5e-3)
    assert "the scaled feature" in words


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"at_least": 0.1}, "^at_least: "),
        ({"minimum_decay": 0.1}, "^minimum_decay: "),
        ({"weights": "search"}, "^weights: "),
    ],
)
def test_wishes_about_other_things_are_refused(small, options, word):
    with pytest.raises(InputError, match=word):
        tune(small(), **options)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("thrust", [0, 0.2, 0.4]),
        ("latency", [0, 0.06, 0.12]),
        ("bandwidth", [4, 8.944, 20]),
        ("distance", [0.1803, 0.3606, 0.5408]),
    ],
)
def test_what_is_traded_goes_about_what_the_mission_has(small, monkeypatch, name, values):
    asked = []

    def attempt(mission, limits, tell):
        asked.append((mission, limits))
        return Failed("not looked for", None)

    monkeypatch.setattr(start_trade, "attempt", attempt)
    mission = small()
    points = pareto(mission, 3, Wish(trade=name))
    assert [value for value, _ in points] == pytest.approx(values, rel=1e-3)
    assert {found.reason for _, found in points} == {"not looked for"}
    for (changed, limits), value in zip(asked, values, strict=True):
        there = start_trade.value_of(changed, name)
        assert (limits.bandwidth if there is None else there) == pytest.approx(value, rel=1e-3)
    middle, _ = asked[1]
    assert start_trade.value_of(middle, name) == pytest.approx(start_trade.value_of(mission, name))


@pytest.mark.parametrize(
    ("trade", "changes", "said"),
    [
        ("speed", {}, "must be one of thrust"),
        ("thrust", {"uncertainty": "{torque = 0.1}"}, "uncertainty.thrust=…"),
        ("distance", {"start.position": "[0, 0, -1.2]"}, "the start is the goal"),
    ],
)
def test_what_cannot_be_traded_is_refused(small, trade, changes, said):
    with pytest.raises(InputError, match="trade") as error:
        pareto(small(changes=LATE | changes), 3, Wish(trade=trade))
    assert said in str(error.value)


def test_only_a_start_is_traded_for():
    with pytest.raises(InputError, match="trade"):
        Wish(objective="decay", trade="thrust")


def test_where_nothing_is_found_along_a_trade_nothing_is_said_to_be_covered(
    small, monkeypatch, capsys
):
    small()
    monkeypatch.setattr(start_trade, "attempt", lambda *_: Failed("not looked for", None))
    words = [f"--set={key}={value}" for key, value in LATE.items()]
    with pytest.raises(SystemExit) as exit_:
        cli.main(["tune", "small.toml", "--trade", "thrust", *words])
    out = capsys.readouterr().out
    assert exit_.value.code == 1
    assert out.count("infeasible: not looked for") == 5
    assert "asked for               thrust ±20 %" in out
    assert "figure" not in out


@pytest.mark.whole
def test_each_point_of_a_trade_is_proved_with_what_it_says(small, capsys):
    small("[0.2, 0, -1.3]")
    words = [f"--set={key}={value}" for key, value in LATE.items()]
    options = ["--trade", "thrust", "--pareto", "2", "--out", "t.svg", "--json"]
    status, out, _ = run(capsys, "tune", "small.toml", *options, *words)
    assert status == 0
    told = json.loads(out)
    assert [point["thrust"] for point in told["points"]] == [0, 0.4]
    assert ["thrust ±40 %" in point["covers"] for point in told["points"]] == [False, True]
    first, last = (point["settling_time"] for point in told["points"])
    assert first < last
    assert Path("t.svg").stat().st_size > 0


@pytest.mark.whole  # CI tunes the vehicle of the README
def test_tune_writes_a_mission_and_a_certificate_that_holds_its_start(small, capsys):
    small("[0.2, 0, -1.3]")
    words = [f"--set={key}={value}" for key, value in {**SCALED}.items()]
    status, out, _ = run(capsys, "tune", "small.toml", "--out", "t.toml", "--json", *words)
    assert status == 0
    answer = json.loads(out)
    assert answer["settling_time_flown"] < answer["settling_time"]
    assert answer["settling_time"] < answer["settling_time_before"]
    tuned = load("t.toml")
    assert {k: float(getattr(tuned.gains, k)) for k in ("k1", "k2")}.items() <= answer[
        "gains"
    ].items()
    assert slowest_rate(tuned) > 0
    assert "the controller may be switched on" in checker.check_file(answer["certificate"])


def test_the_ball_of_J_is_as_close_as_few_cells_show(small):
    mission, taken = small(), []
    question = replace(
        Question.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),)), wider=0.35
    )
    low, high = question.ends
    for share in (0.2, 0.98):
        d = low + share * (high - low)
        closer = closest(question, mission.target, d)
        assert closer is not None
        assert is_shown(closer, mission.target, d, FEW)
        nearer = closest(replace(question, wider=closer.wider), mission.target, d)
        assert nearer is None  # none that is closer takes few cells
        taken.append(closer.wider)
    assert taken[0] < taken[1] < question.wider


@pytest.mark.parametrize(("position", "shown"), [("[0, 0, 0]", True), ("[0.01, 0, 0]", False)])
def test_a_camera_beside_the_centre_leaves_fewer_cells(position, shown, small, monkeypatch):
    """Its cells cost more to check, so that what is shown without an arm is too much with one."""
    mission = small(changes=LATE | {"camera.position": position})
    question = Question.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),))
    most = most_cells(len(question.scene.points), COST_BESIDE)
    monkeypatch.setattr(Domain, "tree", lambda *_, **__: "0" * most)
    assert is_shown(question, mission.target, 0.1) == shown


@pytest.mark.whole
def test_none_of_many_random_gains_settles_two_percent_sooner():
    better, _ = sooner(vehicle(3), 10_000)
    assert better == []


@pytest.mark.whole
def test_nine_in_ten_random_vehicles_get_gains_that_are_proved_for_their_start():
    held = [tune(vehicle(number)).status == "tuned" for number in range(50)]
    assert sum(held) >= 0.9 * len(held)


def test_what_is_flown_with_beyond_the_tolerances_is_said_with_what_would_cover_it(small):
    late = small(changes={**LATE, "sensors": "{gyro_turned = true, frame_rate = 20}"})
    mission = late.model_copy(update={"rotors": Rotors(time_constant=Fraction("0.05"))})
    assert list(beyond_text(small())) == covering(small()) == []
    assert covering(mission) == ["uncertainty.rotor_lag=0.05"]
    assert list(beyond_text(mission)) == [
        "rotors that lag by 0.05 s (uncertainty.rotor_lag is 0.03)"
    ]
    slow = {**LATE, "sensors": "{gyro_turned = true, frame_rate = 20, latency = 0.02}"}
    settings = dict(text.split("=", 1) for text in covering(small(changes=slow)))
    assert settings == {"uncertainty.latency": "0.07"}
    covered = {k: v for k, v in slow.items() if k != "uncertainty"}
    more = DOUBTS.replace("latency = 0.06", "latency = 0.07")
    assert covering(small(changes={**covered, "uncertainty": more})) == []
