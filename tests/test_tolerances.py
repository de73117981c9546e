"""What a mission asks a proof to cover: read, written, certified with, never passed over."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

import hoverproof as hp
from command_line import run
from hoverproof import checker
from hoverproof.mission.presets import preset_text
from hoverproof.mission.reading import load
from hoverproof.mission.writing import mission_text
from hoverproof.reporting.tables import mission_tables
from small_kit import small_vehicle

PROOFS = Path(__file__).parents[1] / "proofs"
NOISE = {"feature": "0.01", "velocity": "0.05", "force": "0.02", "rate": "0.03"}
TOLERANCES = {
    **{"thrust": "0.2", "torque": "0.3", "latency": "0.083", "rotor_lag": "0.03"},
    **{"wind": "0.5", "yaw_rate": "1"},
}
ASKED = {
    "law.force": "measured",
    **{f"uncertainty.{key}": value for key, value in TOLERANCES.items()},
    **{f"uncertainty.noise.{key}": value for key, value in NOISE.items()},
    "camera.half_angle": "0.7",
}
WORDS = [
    *("thrust ±20 %", "torque ±30 %", "latency up to 0.083 s", "rotor lag up to 0.03 s"),
    *("steady wind up to 0.5 m/s²", "yaw rate up to 1 rad/s", "noise of the feature up to 0.01"),
    *("noise of the velocity up to 0.05 m/s", "noise of the force up to 0.02 N"),
    *("noise of the body rates up to 0.03 rad/s", "points seen within 0.7 rad of the optical axis"),
]


def resealed(content):
    content["mission_sha256"] = checker.digest(content["mission"])
    content["statement"] = checker.statement(content)
    rest = {key: part for key, part in content.items() if key != "sha256"}
    return rest | {"sha256": checker.digest(rest)}


def test_every_tolerance_is_read_exactly_and_told_with_its_unit():
    mission = load("x4-flyer", ASKED)
    told = mission.exact()["uncertainty"]
    assert told.pop("gyro_turned") == "false"  # as nothing in [sensors] says that it is
    assert told.pop("noise") == {key: str(Fraction(value)) for key, value in NOISE.items()}
    assert told == {key: str(Fraction(value)) for key, value in TOLERANCES.items()}
    assert mission.exact()["camera"] == {"half_angle": "7/10"}
    assert mission.uncertainty.wind == Fraction(1, 2)
    assert mission.asks_to_cover() == WORDS


def test_what_is_not_given_is_zero_and_one_key_writes_them_all():
    mission = load("x4-flyer", {"uncertainty.noise": "{rate = 0.1}"})
    told = mission.exact()["uncertainty"]
    assert told["noise"] == dict.fromkeys(NOISE, "0") | {"rate": "1/10"}
    assert {key: told[key] for key in TOLERANCES} == dict.fromkeys(TOLERANCES, "0")
    assert mission.asks_to_cover() == ["noise of the body rates up to 0.1 rad/s"]
    assert not mission.uncertainty.is_none


def test_a_mission_that_asks_for_nothing_hashes_as_in_the_shipped_certificate():
    shipped = json.loads((PROOFS / "x4-flyer.cert.json").read_text(encoding="utf-8"))
    nothing = {**{f"uncertainty.{k}": "0" for k in TOLERANCES}, "uncertainty.noise.rate": "0"}
    for change in ({}, nothing):
        mission = load("x4-flyer", change)
        assert mission.uncertainty.is_none
        assert checker.digest(mission.exact()) == shipped["mission_sha256"]
    for key in ("uncertainty.torque", "uncertainty.noise.rate", "camera.half_angle"):
        asked = load("x4-flyer", {key: "0.1"})
        assert checker.digest(asked.exact()) != shipped["mission_sha256"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"uncertainty.thrust": "1"}, "thrust: must be from 0 to 0.999 .a share: 0.2 is 20 %"),
        ({"uncertainty.torque": "-0.1"}, "uncertainty.torque: must be from 0 to"),
        ({"uncertainty.latency": "-1"}, "uncertainty.latency: must be from 0 to 1e3 s, not -1"),
        ({"uncertainty.latensy": "1"}, "unknown key .did you mean 'latency'"),
        ({"uncertainty.noise": "1"}, "uncertainty.noise: must be a section, not 1"),
        ({"uncertainty.noise.gyro": "1"}, "known here: feature, velocity, force, rate"),
        ({"uncertainty.noise.force": "true"}, "noise.force: must be a number in N, not True"),
        ({"law.force": "measured", "uncertainty.wind": "9.8"}, "wind: must be below gravity, 9.8"),
        ({"camera.half_angle": "40"}, "half_angle: must be above 0 and at most 1.5707 rad, not 40"),
        ({"camera.half_angle": "0"}, "half_angle: must be above 0"),
    ],
)
def test_what_cannot_be_covered_is_refused(change, message):
    with pytest.raises(hp.InputError, match=message) as refused:
        load("x4-flyer", change)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("key", ["thrust", "wind", "rotor_lag"])
def test_a_modelled_force_allows_no_error_of_force(key):
    change = {f"uncertainty.{key}": "0.1"}
    with pytest.raises(hp.InputError, match=f"uncertainty.{key}: must be 0 .*law.force = 'measu"):
        load("x4-flyer", change)
    assert load("x4-flyer", {**change, "law.force": "measured"}).asks_to_cover()


@pytest.mark.parametrize(
    "section",
    [
        "[uncertainty]\ntorque = 0.2  # inertia\nnoise = {rate = 0.1}\n",
        "[uncertainty]\ntorque = 0.2  # inertia\n[uncertainty.noise]\nrate = 0.1\n",
        "",
    ],
)
@pytest.mark.parametrize(
    "change",
    [
        {},
        ASKED,
        {"uncertainty.torque": "0.25"},
        {"uncertainty.noise.feature": "0.5"},
        {"camera.half_angle": "0.3"},
    ],
)
def test_what_is_written_loads_as_the_same_mission(section, change):
    Path("mine.toml").write_text(f"{preset_text('x4-flyer')}\n{section}", encoding="utf-8")
    mission = load("mine.toml", change)
    Path("again.toml").write_text(mission_text(mission), encoding="utf-8")
    assert load("again.toml").exact() == mission.exact()
    text = Path("again.toml").read_text("utf-8")
    assert "# Corners of a square in the world frame" in text
    assert ("# inertia" in text) == bool(section)


def test_a_certificate_says_that_it_considers_none_of_it(capsys):
    asked = ("--set", "uncertainty.torque=0.2", "--set", "camera.half_angle=0.7")
    status, out, _ = run(capsys, "certify", "x4-flyer", "--out", "asked.json", *asked)
    assert (status, out.count("\n  not considered          torque ±20 %, points seen")) == (0, 1)
    plain = hp.certify(load("x4-flyer")).statement
    said = checker.check_file("asked.json")
    assert "as modelled, [uncertainty] and [camera] not considered. The mission" in said
    assert "not considered" not in plain
    status, out, _ = run(capsys, "check", "asked.json", "--mission", "x4-flyer")
    assert status == 1
    assert "uncertainty.torque is 1/5 in the certificate and missing in the mission" in out


def test_every_answer_about_the_mission_says_what_it_leaves_out(capsys):
    asked = ("x4-flyer", "--set", "uncertainty.torque=0.2")
    _, out, _ = run(capsys, "simulate", *asked, "--no-figures")
    assert out.splitlines()[1] == "  one vehicle within      torque ±20 %"
    _, out, _ = run(capsys, "certify", *asked, "--json")
    assert "not considered: torque ±20 %" in json.loads(out)["warnings"]
    _, out, _ = run(capsys, "certify", "x4-flyer")
    assert "not considered" not in out


@pytest.mark.parametrize(
    ("flown", "said"),
    [
        ("model_error.mass=0.6", "a relative thrust error of 0.375 (uncertainty.thrust is 0.2)"),
        ("sensors.latency=0.1", "images as old as 0.1 s (uncertainty.latency is not given)"),
        ("rotors.time_constant=0.1", "rotors that lag by 0.1 s (uncertainty.rotor_lag is 0.03)"),
        ("start.rates=[0, 0, 0.5]", "a yaw rate at the start of 0.5 rad/s"),
        ("model_error.camera_tilt=[0, -0.1, 0]", "a camera turned by 0.1 rad against [camera]"),
        ("model_error.thrust=-0.2", None),
    ],
)
def test_a_flight_says_what_of_it_is_beyond_the_tolerances_and_is_within_them_else(
    flown, said, capsys
):
    asked = ["thrust=0.2", "torque=0.2", "rotor_lag=0.03", "yaw_rate=0.3", "noise.rate=0.01"]
    sets = ["law.force=measured", *(f"uncertainty.{it}" for it in asked), flown]
    words = ("small.toml", "--no-figures", "--duration", "1", *(f"--set={it}" for it in sets))
    Path("small.toml").write_text(small_vehicle("[4, 16]", "[0.3, 0, -1.4]"))
    _, out, _ = run(capsys, "simulate", *words)
    flat = " ".join(out.split())
    assert ("beyond the tolerances" in out, "one vehicle within" in out) == (bool(said), not said)
    assert (said or "not compared noise of the body rates up to 0.01 rad/s") in flat
    _, out, _ = run(capsys, "simulate", *words, "--json")
    told = json.loads(out)["warnings"]
    assert [said in it for it in told if it.startswith("beyond")] == ([True] if said else [])


def test_what_is_flown_with_and_compared_with_no_tolerance_is_told(capsys):
    asked = ("--set=uncertainty.torque=0.2", "--set=sensors.gyro_noise=0.01", "--duration", "1")
    moving = ("--set=wind.gust=0.1", "--set=wind.drag=0.1")
    out = run(capsys, "simulate", "x4-flyer", "--no-figures", *asked, *moving)[1]
    assert "  one vehicle within      torque ±20 %" in out
    told = "not compared noise of the sensors as flown, gusts as flown, air drag as flown"
    assert told in " ".join(out.split())


def test_of_vehicles_that_are_drawn_it_is_not_said_that_they_are_within_tolerances(capsys):
    sets = ("--set=uncertainty.torque=0.2", "--set=scatter.position=[1,1,1]")
    many = ("simulate", "x4-flyer", "--runs", "2", "--duration", "1", "--no-figures", *sets)
    assert "  vehicles within         torque ±20 %" in run(capsys, *many)[1]
    out = run(capsys, *many, "--set=scatter.inertia=[0.3,0.3,0]")[1]
    assert "vehicles within" not in out
    assert "  not compared            torque ±20 %" in out


@pytest.mark.parametrize(
    ("section", "change"),
    [
        ("uncertainty", {"thrust": "1"}),
        ("uncertainty", {"torque": "-1/10"}),
        ("uncertainty", {"latency": 0.1}),
        ("uncertainty", {"wind": "2/4"}),
        ("uncertainty", {"more": "0"}),
        ("uncertainty", {"noise": {"rate": "1/10"}}),
        ("camera", {"half_angle": "0"}),
        ("camera", {"more": "0"}),
    ],
)
def test_the_checker_reads_these_sections_in_one_form(section, change):
    asked = {"uncertainty.noise.rate": "0.1", "camera.half_angle": "0.5"}
    content = dict(hp.certify(load("x4-flyer", asked)).certificate.content)
    assert checker.check(resealed(content)) == content["statement"]
    mission = content["mission"]
    content["mission"] = mission | {section: mission[section] | change}
    with pytest.raises(checker.Rejected, match=section):
        resealed(content)
    left = dict(mission[section])
    left.popitem()
    content["mission"] = mission | {section: left}
    with pytest.raises(checker.Rejected, match=section):
        resealed(content)


def test_the_report_lists_what_was_asked_and_is_not_considered():
    title = "Asked to be covered (looked at under region of attraction alone)"
    asked, plain = (
        {
            table.title: table.rows
            for table in mission_tables(load("x4-flyer", change), [Fraction(3)] * 3)
        }
        for change in ({"uncertainty.torque": "0.2"}, {})
    )
    assert asked[title] == [("[uncertainty], [camera]", "torque ±20 %")]
    assert title not in plain


@pytest.mark.parametrize("turned", ["true", "false"])
def test_a_mission_written_back_says_as_before_whether_a_late_image_is_turned(tmp_path, turned):
    path = tmp_path / "late.toml"
    plain = load("x4-flyer", {"uncertainty.latency": "0.03", "sensors.gyro_turned": turned})
    path.write_text(mission_text(plain), encoding="utf-8")
    if turned == "true":
        path.write_text(mission_text(plain.model_copy(update={"source": "?"})), encoding="utf-8")
    assert load(path).exact() == plain.exact()
    assert ("gyro_turned" in plain.exact()["uncertainty"]) == (turned == "false")


def test_new_keys_leave_older_missions_as_they_were():
    """No key that came later is in what is hashed unless it is set."""
    told = load("x4-flyer", {"uncertainty.thrust": "0", "uncertainty.torque": "0.1"}).exact()
    assert not {"gust", "gyro_turned"} & told["uncertainty"].keys()
    assert "vertical" not in told["uncertainty"]["noise"]
    more = {"uncertainty.gust": "0.1", "uncertainty.noise.vertical": "0.01"}
    told = load("x4-flyer", more).exact()["uncertainty"]
    assert (told["gust"], told["noise"]["vertical"]) == ("1/10", "1/100")
