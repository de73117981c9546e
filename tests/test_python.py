"""What a user of Python types: names for missions, other values, pictures, notebooks."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction as F
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import hoverproof as hp
from hoverproof.certification.certificate import Certificate
from hoverproof.certification.over_box import ProvedBounds
from hoverproof.mission.presets import preset_text
from hoverproof.show.drawing import html

VEHICLES = sorted((Path(__file__).parent.parent / "examples" / "vehicles").glob("*.toml"))


def test_a_verb_takes_a_name_a_path_or_a_mission(tmp_path):
    mission = hp.load("x4-flyer")
    by_name = hp.certify("x4-flyer")
    assert by_name.certificate == hp.certify(mission).certificate
    assert by_name.certificate == hp.certify(mission=mission).certificate
    path = tmp_path / "other.toml"
    path.write_text(preset_text("x4-flyer").replace('name = "x4-flyer"', 'name = "other"'))
    assert hp.certify(path).mission.name == "other"
    with pytest.raises(hp.InputError, match="no such mission file or preset"):
        hp.certify("x5-flyer")


@given(st.floats(0.001, 1000))
def test_a_float_is_the_shortest_decimal_that_is_read_as_it(gain):
    for value in (gain, np.float64(gain)):
        assert hp.load("x4-flyer", {"gains.k4": value}).gains.k4 == F(repr(gain))
    start = hp.load("x4-flyer", {"start.position": np.array([gain, 0.1, -4])}).start
    assert start.position == (F(repr(gain)), F(1, 10), -4)


ONES = (F(1), F(1), F(1), F(1))
BOX = ((F(-1, 10), F(1, 10)), (F(-1, 10), F(1, 10)), (F(-4), F(-3)))


def hovers(*place):
    start = hp.Start.hover(*place)
    assert start == hp.Start(((F(1, 10),) * 2, (F(0),) * 2, (F(-4),) * 2))
    return hp.attraction("x4-flyer", starts=iter([start]))


@pytest.mark.parametrize(
    ("verb", "plain", "others"),
    [
        (
            lambda w: hp.certify("x4-flyer", weights=w),
            ONES,
            ([1, 1.0, Decimal(1), np.int64(1)], np.ones(4), np.ones(4, np.int32)),
        ),
        (
            lambda box: hp.region("x4-flyer", box),
            BOX,
            (np.array(BOX, float), [[-0.1, 0.1], [-0.1, Decimal("0.1")], [-4, np.float64(-3)]]),
        ),
        (
            lambda place: hovers(*place),
            (F(1, 10), F(0), F(-4)),
            ((0.1, 0, -4), np.array([0.1, 0, -4]), (Decimal("0.1"), np.int8(0), "-4")),
        ),
    ],
    ids=["weights", "box", "start"],
)
def test_any_number_of_python_is_taken_exactly(verb, plain, others):
    expected = verb(plain).certificate
    for other in others:
        assert verb(other).certificate == expected


def test_numbers_of_numpy_are_those_of_python(tmp_path):
    flown = hp.simulate("crazyflie-2.1", duration=0.1, step=0.001, seed=3, every=2)
    for real, whole in ((np.float32, np.int64), (F, np.uint8)):
        again = hp.simulate(
            "crazyflie-2.1", duration=real("0.1"), step=real("0.001"), seed=whole(3), every=whole(2)
        )
        assert again.equals(flown)
    for runs in (2, np.int64(2)):
        hp.simulate_batch(
            "x4-flyer", tmp_path / f"{runs!r}.nc", runs=runs, duration=np.float64(0.1)
        )
    one, other = (path.read_bytes() for path in tmp_path.iterdir())
    assert one == other


def test_a_package_takes_the_certificate_of_a_verdict_and_limits_of_any_sequence(tmp_path):
    kept = Path(__file__).parent.parent / "proofs" / "crazyflie-2.1.attraction.cert.json"
    shown = Certificate(json.loads(kept.read_text(encoding="utf-8")))
    told = [
        hp.export_c("crazyflie-2.1", tmp_path / f"{k}", certificate=given, rotor_limits=limits)
        for k, (given, limits) in enumerate(
            ((shown, (0, F(1, 5))), (shown.content, np.array([0, 0.2])))
        )
    ]
    assert told[0] == told[1]
    for wrong in ("x", (1,)):
        with pytest.raises(hp.InputError, match=r"^rotor_limits: must be"):
            hp.export_c("crazyflie-2.1", tmp_path / "no", certificate=shown, rotor_limits=wrong)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: hp.certify("x4-flyer", weights=np.ones(3)), "weights: must be four positive"),
        (lambda: hp.certify("x4-flyer", weights=(1, 1, 1, np.nan)), "weights: must be a list"),
        (lambda: hp.tune("x4-flyer", objective="decay", weights="1111"), "weights: must be four"),
        (lambda: hp.region("x4-flyer", ((0, np.inf), (0, 1), (-4, -3))), "box: must be three"),
        (lambda: hp.region("x4-flyer", ((0, 1e9), (0, 1), (-4, -3))), "box: the ends must be"),
        (lambda: hp.Start.hover(0, 0, np.nan), "start: must be numbers"),
        (lambda: hp.Start(((0, 0), (0, 0))), "start: position: must have three"),
        (lambda: hp.simulate("x4-flyer", duration=10**400), "duration: must be a finite number"),
        (lambda: hp.simulate("x4-flyer", seed=True), "seed: must be a whole number"),
        (lambda: hp.export_c("x4-flyer", "no", certificate="x.json"), "certificate: must be of"),
        (lambda: hp.export_c("x4-flyer", "no", camera="yes"), "camera: must be True or False"),
        (lambda: hp.export_c("x4-flyer", "no", name=3), "name: must be text or None"),
        (lambda: hp.replace("x4-flyer", {"camera.file": Path("no.yaml")}), r"no\.yaml: "),
    ],
)
def test_what_is_none_is_refused_by_the_name_of_the_argument(call, said):
    with pytest.raises(hp.InputError, match=f"^{said}"):
        call()


@pytest.mark.parametrize("path", [*hp.presets(), *VEHICLES], ids=lambda path: Path(path).stem)
def test_a_mission_with_its_own_values_in_their_place_is_the_same(path):
    mission = hp.load(path)
    for section in ("vehicle", "gains", "target", "bounds", "start", "sensors", "uncertainty"):
        held = getattr(mission, section)
        for key in held.model_fields_set:
            again = hp.replace(mission, {f"{section}.{key}": getattr(held, key)})
            assert again.exact() == mission.exact()
            assert again.conditions() == mission.conditions()


def test_another_value_is_checked_as_in_a_file():
    mission = hp.load("x4-flyer")
    other = hp.replace(mission, {"gains.k4": 0.3, "uncertainty.noise.rate": 0.01})
    assert other.gains.k4 == F(3, 10)
    assert other.uncertainty.noise.rate == F(1, 100)
    assert mission.gains.k4 != F(3, 10)
    with pytest.raises(hp.InputError, match=r"gains.k1: must be above 0"):
        hp.replace(mission, {"gains.k1": -1})
    with pytest.raises(hp.InputError, match=r"^gains.k9: unknown key"):
        hp.replace(mission, {"gains.k9": 1})


def test_an_error_names_arguments_in_python_and_options_on_the_command_line():
    with pytest.raises(hp.InputError, match=r"^duration: must be") as caught:
        hp.simulate("x4-flyer", duration=-1)
    assert caught.value.line.startswith("--duration: must be")
    with pytest.raises(hp.InputError, match=r"^at_least: ") as caught:
        hp.tune("x4-flyer", objective="region", at_least=0.1)
    assert caught.value.line.startswith("--at-least: ")


@pytest.mark.parametrize(
    ("verb", "given", "told"),
    [
        (hp.attraction, {"barrier": "x"}, "barrier: must be True or False or None, not 'x'"),
        (hp.attraction, {"starts": ["x"]}, "starts: must be a list or a tuple, each of the class"),
        (hp.attraction, {"progress": 1}, "progress: must be something to call or None"),
        (hp.simulate, {"step": "a"}, "step: must be a finite number or None, not 'a'"),
        (hp.simulate, {"seed": "a"}, "seed: must be a whole number, not 'a'"),
        (hp.simulate, {"every": 1.5}, "every: must be a whole number or None, not 1.5"),
        (hp.simulate, {"duration": float("nan")}, "duration: must be a finite number or None"),
        (hp.simulate, {"law": "x"}, "law: must be of the class Law or None"),
        (hp.certify, {"weights": ()}, "weights: must be four positive numbers"),
        (hp.tune, {"objective": "decay", "weights": -1}, "weights: must be four positive numbers"),
        (hp.tune, {"bandwidth": True}, "bandwidth: must be a finite number, not True"),
        (hp.pareto, {"count": 2, "lowest": 0}, "lowest: must be above 0 and at most the highest"),
        (hp.region, {"box": [1, 2, 3]}, "box: must be "),
        (hp.atlas, {"processes": 0}, "processes: must be from 1 to 1024, not 0"),
        (hp.atlas, {"x": []}, "x: must be of the class Axis or text"),
        (hp.simulate_batch, {"runs": "3"}, "runs: must be a whole number, not '3'"),
        (hp.report, {"path": 3}, "path: must be text or a path, not 3"),
    ],
)
def test_an_argument_of_another_kind_is_refused_by_its_name(verb, given, told):
    with pytest.raises(hp.InputError, match="^" + re.escape(told)):
        verb("x4-flyer", **given)


def test_numbers_of_numpy_are_numbers():
    given = {"duration": np.float64(0.5), "step": np.float64(0.002), "seed": np.int64(2)}
    flight = hp.simulate("crazyflie-2.1", **given)
    assert float(flight["time"][-1]) == pytest.approx(0.5)


def test_completion_offers_what_a_mission_is_for():
    offered = {name for name in dir(hp.load("x4-flyer")) if not name.startswith("_")}
    assert {"vehicle", "gains", "uncertainty", "exact"} <= offered
    assert not {name for name in offered if name.startswith(("model_", "parse_", "json"))} - {
        "model_error"
    }


def test_what_has_a_picture_is_drawn_and_the_rest_is_refused():
    flight = hp.simulate("crazyflie-2.1", duration=1.0)
    assert hp.plot(flight).axes
    region = hp.region("x4-flyer")
    assert isinstance(region, ProvedBounds)
    assert hp.plot(region).axes
    with pytest.raises(TypeError, match="no picture of Mission"):
        hp.plot(hp.load("x4-flyer"))


def test_a_notebook_shows_a_mission_and_a_verdict_with_statement_and_picture():
    mission = hp.load("x4-flyer", {"name": '"x4"'})
    assert "9.6 kg" in html(mission)
    proved = html(hp.certify(mission))
    assert "proved" in proved
    assert "<details>" in proved
    assert "<svg" in html(hp.region(mission))
    refuted = html(hp.certify("x4-flyer", weights=(F(1), F(1), F(1), F(100))))
    assert "undecided" in refuted or "refuted" in refuted


def test_a_notebook_is_told_how_to_show_them_without_an_import_of_what_draws():
    code = (
        "from IPython.testing.globalipapp import start_ipython; shell = start_ipython();"
        "shell.display_formatter.active_types = ['text/plain', 'text/html'];"
        "import sys, json, hoverproof as hp; early = 'hoverproof.show.drawing' in sys.modules;"
        "shown, _ = shell.display_formatter.format(hp.load('x4-flyer'));"
        "print(json.dumps([early, shown['text/html']]))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    early, shown = json.loads(run.stdout.splitlines()[-1])
    assert not early
    assert "<table>" in shown


def test_many_flights_are_opened_as_a_dataset(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    flown = hp.simulate_batch("x4-flyer", runs=3, duration=0.2)
    assert flown.path == Path("x4-flyer.flights.nc")
    with flown.open() as runs:
        assert runs.sizes["run"] == 3
        assert hp.plot(runs).axes


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: hp.certify(9.6), "name of a preset or the path of a file, not float"),
        (lambda: hp.replace(5, {}), "name of a preset or the path of a file, not int"),
        (lambda: hp.replace("x4-flyer", 5), "by dotted key"),
        (lambda: hp.load("x4-flyer", [1]), "by dotted key"),
        (lambda: hp.replace("x4-flyer", {5: 1}), "by dotted key"),
    ],
)
def test_what_is_no_mission_and_no_values_is_told(call, said):
    with pytest.raises(TypeError, match=said):
        call()


def test_a_certificate_that_is_not_there_is_named():
    with pytest.raises(hp.InputError, match=r"missing\.json: No such file"):
        hp.check("missing.json")


def test_a_flight_that_starts_at_its_goal_is_drawn(tmp_path):
    flight = hp.simulate(hp.replace("crazyflie-2.1", {"start.position": [0, 0, -1]}), duration=0.5)
    hp.plot(flight).savefig(tmp_path / "still.png")  # a warning is an error here
