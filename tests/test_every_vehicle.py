"""What a user meets of proofs about every vehicle within tolerance: answers, figure, report."""

from __future__ import annotations

import inspect
import json
import re
import typing
from dataclasses import replace
from fractions import Fraction as F
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import hoverproof as hp
from command_line import run
from exponential_truth import MISSION, NEAR, soon_found
from hoverproof import cli
from hoverproof.certification import convergence, largest
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.cli import attraction as command
from hoverproof.design.proved_and_flown import why_longer
from hoverproof.mission import tolerances
from hoverproof.mission.reading import load, with_tolerance
from hoverproof.mission.uncertainty import Uncertainty
from hoverproof.reporting import glance, parts
from hoverproof.show.exponential import View, fly, save_exponential_figure
from hoverproof.show.largest import largest_figure
from hoverproof.simulation.flight import flown
from hoverproof.simulation.timing import Timing
from once import attraction_once

GUIDE = Path(__file__).parents[1] / "docs" / "how-to" / "prove-every-vehicle.md"
COVERED = ["thrust ±20 %", "torque ±20 %", "latency up to 0.073 s"]


def guide_mission(folder):
    """Write the mission of the guide, and return its path."""
    text = GUIDE.read_text(encoding="utf-8").split("```{file} half-kilo.toml\n")[1].split("```")[0]
    path = Path(folder) / "half-kilo.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def proved(tmp_path_factory):
    mission = load(guide_mission(tmp_path_factory.mktemp("mission")))
    verdict = attraction_once(mission)
    assert isinstance(verdict, Exponential)
    return verdict


@pytest.fixture
def answer(proved, monkeypatch, capsys):
    """Return a function that runs `attraction` with what was proved once."""
    monkeypatch.setattr(convergence, "attraction", lambda *_, **__: proved)

    def attraction(*options):
        status, out, _ = run(capsys, "attraction", guide_mission("."), *options)
        return status, out

    return attraction


@pytest.mark.slow
def test_the_answer_names_the_theorem_what_is_covered_and_when_it_is_over(proved, answer):
    status, out = answer("--no-figure")
    assert status == 0
    assert all(len(line) <= 80 for line in out.splitlines())
    words = " ".join(out.split())
    assert f"every vehicle with {', '.join(COVERED)} converges to the goal (theorem 5" in words
    assert f"after {float(proved.settling.time):.6g} s: from then on within" in words
    assert "start (0.3, 0, -1.5) m, level hover" in words
    assert "control in steps" in words
    assert "not considered" not in words


def test_a_program_reads_the_same_with_units(proved, answer):
    _, out = answer("--no-figure", "--json")
    told = json.loads(out)
    assert told["theorem"] == "exponential"
    assert told["covers"] == COVERED
    assert told["settling_time"] == float(proved.settling.time)
    assert told["decay_rate"] == float(proved.rate)
    assert {"decay_rate", "settling_time", "field_of_view", "rotor_thrust"} <= set(told["units"])
    assert not [w for w in told["warnings"] if "not considered" in w]
    assert told["largest"] is None


def test_a_half_angle_that_is_not_shown_is_said_to_be_left_out(proved):
    from hoverproof.cli.answers.attraction import considered

    assert considered(proved) == COVERED


@pytest.mark.slow
def test_the_figure_is_drawn_beside_the_certificate(answer):
    _, out = answer()
    assert "half-kilo.attraction.png" in out
    assert Path("half-kilo.attraction.png").stat().st_size > 10_000


def test_what_is_drawn_agrees_with_what_is_proved(proved):
    view = View(proved)
    level = float(proved.start_level) * np.exp(-float(proved.rate) * float(proved.settling.time))
    assert view.distances(view.offset(np.array([level])))[0] <= float(proved.settling.radius)
    start = view.hovers(view.scene.offset(view.middles))
    assert 0.9 < start[0] / float(proved.start_level) <= 1
    assert view.offset(float(proved.level)) <= float(proved.offset)
    within = view.seen(view.scene.goal + view.scene.ends(float(proved.offset)))
    assert (view.out_of_wedge(*within) < 0).all()
    lowest, highest = map(float, proved.heights)
    heights = np.array([lowest - 1e-6, lowest + 1e-6, highest - 1e-6, highest + 1e-6])
    assert (view.out_of_wedge(np.zeros(4), heights) > 0).tolist() == [True, False, False, True]
    (a, b), *_ = proved.wedge
    assert a == 0  # the target is its own image, so the wedge is as far on the other side
    beside = np.array([-1.001, -0.999, 0.999, 1.001]) * float(b)
    outside = [True, False, False, True]
    assert (view.out_of_wedge(beside, np.ones(4)) > 0).tolist() == outside


def test_a_simulated_flight_stays_below_the_bound_of_the_figure(proved):
    view = View(proved)
    flight = fly(view)
    time = flight["time"].values
    far = np.linalg.norm(flight["position"].values - view.scene.goal, axis=1)
    bound = float(proved.start_level) * np.exp(-float(proved.rate) * time)
    assert (far <= view.distances(view.offset(bound))).all()
    late = time >= float(proved.settling.time)
    assert late.any()
    assert (far[late] <= float(proved.settling.radius)).all()


@pytest.mark.slow
def test_no_flight_is_drawn_from_a_start_of_which_nothing_is_proved(proved, tmp_path):
    elsewhere = replace(proved, starts=(hp.Start.hover(F(0), F(1, 5), F(-3, 2)),))
    assert fly(View(elsewhere)) is None
    save_exponential_figure(elsewhere, tmp_path / "other.png")
    assert (tmp_path / "other.png").exists()


@pytest.mark.slow
def test_the_report_shows_it(proved, monkeypatch, tmp_path):
    monkeypatch.setattr(parts, "start_or_ball", lambda mission: (proved, proved))
    without = ("atlas", "region", "firmware", "ledger", "flight")
    hp.report(proved.mission, tmp_path / "r.html", without=without)
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "decay rate of L" not in page.split("<nav")[0]  # that of the vehicle as modelled
    for words in (
        "exponentially (theorem 5)",
        "decay rate of Ψ, proved",
        f"≥\N{NO-BREAK SPACE}{float(proved.rate):.4g}"[:6],
        ", ".join(COVERED),
        "half-kilo.attraction.cert.json",
        'aria-label="Cross-section of the hovers inside',
        'aria-label="The proved bound of the distance',
    ):
        assert words in page


@pytest.mark.slow
def test_at_one_glance_a_report_says_for_whom_from_where_and_how_soon(
    proved, monkeypatch, tmp_path, capsys
):
    monkeypatch.setattr(parts, "start_or_ball", lambda mission: (proved, proved))
    path = str(guide_mission(tmp_path))
    without = ("atlas", "region", "firmware", "ledger", "flight")
    with pytest.raises(SystemExit):
        cli.main(["report", path, *[f"--without={part}" for part in without]])
    out = capsys.readouterr().out
    said = " ".join(out.split())
    assert f"for whom every vehicle with {', '.join(COVERED)} comes to the hover" in said
    assert "from where its start, (0.3, 0, −1.5) m" in said
    assert f"from {float(proved.settling.time):.4g} s on" in said
    assert "not covered goals from which the centroid" in said
    assert "not considered" not in said
    head = Path("half-kilo.report.html").read_text(encoding="utf-8").split("<nav")[0]
    assert head.index("For whom") < head.index("How soon") < head.index("Not covered")


def test_at_one_glance_a_start_that_is_not_proved_is_said_not_to_be(proved, monkeypatch):
    monkeypatch.setattr(glance, "headline", lambda parts: "The gains work.")
    undecided = hp.certification.verdict.Undecided(mission=proved.mission, reason="too far")
    rows = glance.rows(SimpleNamespace(attraction=parts.Attracted(undecided, None)))
    assert rows == [("Gains", "The gains work."), ("From its start", "undecided: too far")]


@pytest.mark.slow
def test_at_one_glance_a_flight_stands_beside_the_time_that_is_proved(proved, monkeypatch):
    monkeypatch.setattr(glance, "headline", lambda parts: "The gains work.")
    whole = flown(proved.mission, Timing(duration=float(proved.settling.time)))
    flight = SimpleNamespace(whole=whole)
    told = SimpleNamespace(attraction=parts.Attracted(proved, proved), flight=flight)
    (said,) = [words for question, words in glance.rows(told) if "flight" in question]
    since = float(re.search(r"from ([\d.]+) s on \(simulated", said)[1])
    far = np.linalg.norm(whole["position"].values - [0, 0, -1.2], axis=1)
    near = far <= float(proved.settling.radius)
    assert near[whole["time"].values >= since].all()
    assert not near[whole["time"].values < since - 0.1][-1]
    assert ("the proof takes" in said) is (proved.settling.time > 4 * since)


@pytest.mark.slow
def test_it_is_said_why_a_proof_takes_more_than_four_times_as_long_as_a_flight(proved):
    time = float(proved.settling.time)
    assert why_longer(proved, None) is None
    assert why_longer(proved, time / 3.9) is None
    said = why_longer(proved, time / 8)
    assert said.startswith("8 times as long as in a flight")
    assert 0 < float(re.search(r"the tolerances cost ([\d.]+) %", said)[1]) < 20
    assert f"it bounds J once for all the way, from {float(proved.slope[0]):.3g} to" in said
    exact = replace(
        proved, mission=proved.mission.model_copy(update={"uncertainty": Uncertainty()})
    )
    assert "tolerances" not in why_longer(exact, time / 8)


def test_a_scaled_mission_that_is_not_proved_has_no_ball_to_fall_back_on(monkeypatch, tmp_path):
    mission = load(guide_mission(tmp_path))
    undecided = hp.certification.verdict.Undecided(mission=mission, reason="nothing")
    monkeypatch.setattr(convergence, "attraction", lambda *_: undecided)
    assert convergence.start_or_ball(mission) == (undecided, None)


# --- the largest tolerance ------------------------------------------------------------------------


def test_numbers_of_two_digits_are_in_order():
    numbers = [largest.two_digits(place) for place in range(-180, 181)]
    assert numbers == sorted(set(numbers))
    assert {F(1, 100), F(99, 1000), F(1, 10), F(1), F(11, 10), F(99, 10), F(10)} <= set(numbers)
    assert all(len(str(int(x * 10**6)).rstrip("0")) <= 2 for x in numbers)


@pytest.mark.parametrize("ends_at", ["0.00023", "0.049", "0.1", "0.31", "2.4", "97"])
def test_the_search_ends_at_the_largest_number_of_two_digits_that_fits(
    ends_at, monkeypatch, tmp_path, proved
):
    limit, asked = F(ends_at), []

    def fill(trials, value):
        asked.append(value)
        return float(value / limit)

    def prove(mission, **_):
        asked.append(mission.uncertainty.latency)
        return proved

    monkeypatch.setattr(largest._Trials, "_fill", fill)
    monkeypatch.setattr(largest, "attraction", prove)
    found = largest.largest(load(guide_mission(tmp_path)), "latency")
    assert (found.value, asked[-1]) == (limit, limit)
    assert found.beyond == min(value for value, _ in found.fills if value > limit)
    assert found.beyond < limit * F(12, 10)
    assert len(asked) < 20
    (axes,) = largest_figure(found).axes
    assert axes.get_xlabel() == "uncertainty.latency (s)"
    assert len(axes.lines[0].get_xdata()) == len(found.fills)


@pytest.mark.slow
def test_where_not_even_zero_is_proved_nothing_is_claimed(monkeypatch, capsys):
    path = guide_mission(".")
    undecided = hp.certification.verdict.Undecided(mission=load(path), reason="too far")
    monkeypatch.setattr(largest._Trials, "_fill", lambda trials, value: 2.0)
    monkeypatch.setattr(largest, "attraction", lambda *_, **__: undecided)
    with pytest.raises(SystemExit) as done:
        cli.main(["attraction", str(path), "--largest", "wind"])
    out = capsys.readouterr().out
    assert done.value.code == 3
    assert "none: not even zero is proved" in out
    assert not list(Path().glob("*.json"))


@pytest.mark.parametrize(
    ("mission", "options", "words"),
    [
        ("x4-flyer", ["--largest", "thrust"], "uncertainty.thrust: must be 0"),
        ("x4-flyer", ["--largest", "torque", "--objective", "radius"], "--objective"),
        ("x4-flyer", ["--largest", "torque", "--barrier"], "--barrier"),
        ("x4-flyer", ["--largest", "mass"], "mass"),
    ],
)
def test_what_cannot_be_asked_for_is_refused(mission, options, words, capsys):
    with pytest.raises(SystemExit) as done:
        cli.main(["attraction", mission, *options])
    out, err = capsys.readouterr()
    assert (done.value.code, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


def test_every_number_of_uncertainty_may_be_asked_for():
    may = dict(Uncertainty())
    numbers = {*may, *(f"noise.{key}" for key in dict(may.pop("noise")))} - {"noise"}
    hint = inspect.signature(command.attraction).parameters["largest"].annotation
    names = typing.get_args(typing.get_args(eval(hint, vars(command)).__origin__)[0])
    assert numbers == set(tolerances.UNITS) == set(typing.get_args(largest.Tolerance)) == set(names)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["noise.velocity", pytest.param("control_period", marks=pytest.mark.whole)]
)
def test_the_largest_noise_and_period_are_proved_and_drawn(name, monkeypatch, capsys):
    """Of what is tried: 0 and 0.001."""
    thousandth = next(k for k in range(-300, 0) if largest.two_digits(k) == F("0.001"))
    for key, value in {"FIRST": thousandth, "HIGHEST": thousandth, "DOUBLED": 1}.items():
        monkeypatch.setattr(largest, key, value)
    near = [f"--set={key}={value}" for key, value in NEAR.items()]
    with soon_found(), pytest.raises(SystemExit) as done:
        cli.main(["attraction", str(MISSION), *near, "--largest", name, "--json"])
    told = json.loads(capsys.readouterr().out)
    assert done.value.code == 0
    assert (told["largest"]["tolerance"], told["largest"]["value"]) == (name, 0.001)
    words = "V by at most 1/1000" if "noise" in name else "runs at least every 1/1000"
    assert words in hp.check(told["certificate"])
    assert Path(told["search_figure"]).exists()


def test_another_tolerance_makes_another_mission(tmp_path):
    mission = load(guide_mission(tmp_path))
    other = with_tolerance(mission, "latency", F(1, 10))
    assert other == load(guide_mission(tmp_path), {"uncertainty.latency": "0.1"})
    noisy = with_tolerance(other, "noise.rate", F(1, 100))
    both = {"uncertainty.latency": "0.1", "uncertainty.noise.rate": "0.01"}
    assert noisy == load(guide_mission(tmp_path), both)
    with pytest.raises(hp.InputError, match=r"uncertainty.wind: must be below gravity"):
        with_tolerance(mission, "wind", F(10))


@pytest.mark.slow
@pytest.mark.parametrize("far", [False, pytest.param(True, marks=pytest.mark.whole)])
def test_the_largest_torque_of_the_papers_vehicle_is_proved_and_written(far, monkeypatch, capsys):
    """Of what is tried: 0 and 3 %, and with `make trials` whatever the search asks for."""
    if not far:
        three_percent = next(k for k in range(-180, 0) if largest.two_digits(k) == F("0.03"))
        for name, value in {"FIRST": three_percent, "HIGHEST": three_percent, "DOUBLED": 1}.items():
            monkeypatch.setattr(largest, name, value)
    status, out, _ = run(
        capsys, "attraction", "x4-flyer", "--largest", "torque", "--no-figure", "--json"
    )
    told = json.loads(out)
    assert status == 0
    value, beyond = told["largest"]["value"], told["largest"]["not_found_at"]
    assert 0 < value < beyond < 1.2 * value if far else (value, beyond) == (0.03, None)
    assert told["theorem"] == "potential"
    assert "norm at most" in hp.check(told["certificate"])
