"""The exported firmware: what is in the package, and that it is the controller."""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import casadi as ca
import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

import hoverproof
from firmware_kit import C_WARNINGS, FLAGS, LEVEL, OFF_AXIS, export, export_anew, run, tool
from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.cli import main
from hoverproof.errors import InputError
from hoverproof.export import targets
from hoverproof.export.binding import Firmware
from hoverproof.export.flight_law import flight_law
from hoverproof.export.package import NotCertified, write_package
from hoverproof.export.precision import FLOAT32, FLOAT64
from hoverproof.export.same_controller import assert_is_the_controller
from hoverproof.export.standing import Standing
from hoverproof.mission.reading import load
from hoverproof.plant.goal import hover_goal
from hoverproof.plant.rotors import wrench
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.variables import Design
from papers_law import CRAZYFLIE, PAPERS
from sampling import mostly_whole

CALM = {"velocity": [0, 0, 0], "rate": [0, 0, 0], "gravity_direction": [0, 0, 1], "dt": 0.001}


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    return export(tmp_path_factory.mktemp("firmware") / "x4")


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Each preset in float32 and float64, compiled for this computer."""
    tool("cc")
    made = {}
    for preset in PAPERS.values():
        for precision in ("float32", "float64"):
            folder = tmp_path_factory.mktemp("both")
            export(folder, preset, precision=precision)
            made[preset, precision] = Firmware(folder)
    return made


@pytest.fixture
def firmware(both):
    fresh = both["x4-flyer", "float32"]
    fresh.reset()
    fresh.set_rotor_limits(0, 47)
    return fresh


def seen_from_goal(firmware):
    """Return image points that give q* up to rounding, for the square of the x4-flyer."""
    return np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) / 3


# --- the law ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("overrides", "tunable"),
    mostly_whole([(o, t) for t in (False, True) for o in ({}, OFF_AXIS, LEVEL)], every=4),
)
def test_the_law_is_the_derived_controller_exactly(overrides, tunable):
    for preset in PAPERS.values():
        law = flight_law(load(preset, overrides), sensing="centroid", tunable=tunable)
        assert law.function.n_instructions() < 250


def test_a_law_with_one_number_changed_is_not_the_controller(x4):
    law = flight_law(x4, sensing="centroid")
    goal = hover_goal(x4).centroid_midpoint
    design = [*Design.values(x4, goal), x4.vehicle.reach, x4.vehicle.drag_ratio, Fraction(1)]
    numbers = list(law.coefficients.values())
    assert_is_the_controller(law.function, design, numbers)
    for i in range(len(numbers)):
        changed = [*numbers[:i], numbers[i] * (1 + Fraction(1, 10**12)), *numbers[i + 1 :]]
        with pytest.raises(AssertionError):
            assert_is_the_controller(law.function, design, changed)


def test_coefficients_that_are_tuned_follow_from_the_gains_exactly(x4):
    from hoverproof.algebra.graph import evaluate

    law = flight_law(x4, tunable=True)
    gains = [getattr(x4.gains, k) for k in ("k1", "k2", "k3", "k4", "k_yaw")]
    (column,) = evaluate(law.of_gains, [gains, law.fixed])
    assert [row[0] for row in column] == list(law.coefficients.values())


@given(st.fractions(min_value=-(10**30), max_value=10**30))
def test_rounding_is_once_and_to_nearest(value):
    assert FLOAT64.round(value) == float(value)
    rounded = FLOAT32.round(value)
    error = abs(Fraction(float(rounded)) - value)
    for side in (-np.inf, np.inf):
        neighbour = Fraction(float(np.nextafter(rounded, np.float32(side))))
        assert error <= abs(neighbour - value)


@given(st.fractions(min_value=-(10**12), max_value=10**12))
def test_literals_read_back_as_the_number_they_stand_for(value):
    assert np.float32(FLOAT32.literal(value).rstrip("F")) == FLOAT32.round(value)
    assert float(FLOAT64.literal(value)) == float(value)
    assert float.fromhex(FLOAT32.hex_literal(FLOAT32.round(value))[:-1]) == FLOAT32.round(value)


def test_a_number_halfway_between_two_doubles_is_not_rounded_twice():
    value = 1 + Fraction(1, 2**24) + Fraction(1, 2**60)  # as a double it would be a tie
    assert FLOAT32.round(value) == np.nextafter(np.float32(1), np.float32(2))


# --- what it computes ---------------------------------------------------------------------------


def draw_input(draw, manifest, *, calm):
    """Draw an input of the box in the manifest, or one near hover, in numbers of float32."""
    box, n = manifest["input_box"], len(manifest["mission"]["target"]["points"])
    weight = np.prod(
        [float(Fraction(manifest["mission"]["vehicle"][k])) for k in ("mass", "gravity")]
    )

    def ball(size, radius):
        x = draw.normal(size=size)
        return x / np.linalg.norm(x) * radius * draw.uniform() ** (1 / size)

    if calm:
        image, down = draw.uniform(-1, 1, (n, 2)), np.array([*draw.normal(0, 0.1, 2), 1])
        velocity, rate = draw.normal(0, 0.5, 3), draw.normal(0, 0.5, 3)
    else:
        image = ball(2 * n, box["image_root_sum_of_squares"][1]).reshape(n, 2)
        velocity = ball(3, box["velocity_length_m_per_s"][1])
        rate = ball(3, box["rate_length_rad_per_s"][1])
        down = np.abs(draw.normal(size=3))
    down /= np.linalg.norm(down)
    excess = draw.uniform(*manifest["thrust"]) - weight
    numbers = (image, velocity, rate, down, excess, 0.001)
    return [np.float32(x).astype(float) for x in numbers]


def outputs(firmware, numbers):
    image, velocity, rate, down, excess, dt = numbers
    firmware.thrust_excess = float(excess)
    out = firmware.step(image, velocity=velocity, rate=rate, gravity_direction=down, dt=float(dt))
    assert not out.status & 7
    return out


@pytest.mark.slow
@pytest.mark.parametrize("preset", PAPERS.values(), ids=PAPERS)
def test_casadis_own_c_of_the_derived_controller_agrees(both, preset, tmp_path):
    """CasADi prints the derived controller by itself; only the model is shared."""
    mission = load(preset)
    law = derive_controller()
    image = ca.SX.sym("image", 2, len(mission.target.points))
    rays = ca.vertcat(image, ca.SX.ones(1, image.shape[1]))
    q = ca.sum2(rays / ca.repmat(ca.sqrt(ca.sum1(rays**2)), 3, 1))
    rest = law.measured.vector()[3:]
    thrust_rate, torque = law.function()(ca.vertcat(q, rest), law.design.vector())
    oracle = ca.Function("oracle", [image, rest, law.design.vector()], [thrust_rate, torque])
    oracle.generate("oracle.c")
    run("cc", "-O1", "-fPIC", "-shared", "-w", "oracle.c", "-o", "oracle.so", "-lm")
    compiled = ca.external("oracle", "./oracle.so")
    design = [float(v) for v in Design.values(mission, hover_goal(mission).centroid_midpoint)]
    firmware, draw = both[preset, "float64"], np.random.default_rng(1)
    found, expected = [], []
    for _ in range(500):
        numbers = draw_input(draw, firmware.manifest, calm=True)
        out = outputs(firmware, numbers)
        seen, velocity, rate, down, excess, _ = numbers
        measured = [*velocity, *down, *rate, float(mission.vehicle.weight) + excess]
        found.append([out.thrust_rate, *out.torque])
        expected.append(np.vstack([np.array(x) for x in compiled(seen.T, measured, design)])[:, 0])
    scale = np.abs(expected).max(axis=0)
    assert (np.abs(np.subtract(found, expected)) <= 1e-12 * scale).all()


@pytest.mark.slow
@pytest.mark.parametrize("preset", PAPERS.values(), ids=PAPERS)
def test_rotors_make_the_thrust_and_torque(both, preset):
    firmware, draw = both[preset, "float64"], np.random.default_rng(2)
    vehicle = load(preset).vehicle
    for _ in range(100):
        out = outputs(firmware, draw_input(draw, firmware.manifest, calm=True))
        if out.status & 32:
            continue
        made = np.array(
            wrench(
                vehicle.frame,
                ca.DM(list(out.rotor)),
                float(vehicle.reach),
                float(vehicle.drag_ratio),
            )
        )
        wanted = [out.thrust, *out.torque]
        assert np.allclose(made[:, 0], wanted, rtol=1e-12, atol=1e-12 * out.thrust)


@pytest.mark.slow
@pytest.mark.parametrize("calm", [True, False])
@pytest.mark.parametrize("preset", PAPERS.values(), ids=PAPERS)
def test_float32_is_within_a_millionth_of_the_scale_of_float64(both, preset, calm, whole):
    """Of 1,000 inputs, and with `make trials` of 4,000."""
    draw = np.random.default_rng(3)
    pair = [both[preset, p] for p in ("float32", "float64")]
    weight = float(load(preset).vehicle.weight)
    for firmware in pair:
        assert firmware.set_rotor_limits(0, 2.49 * weight) == 0
    rows = []
    for _ in range(4000 if whole else 1000):
        numbers = draw_input(draw, pair[0].manifest, calm=calm)
        row = []
        for firmware in pair:
            out = outputs(firmware, numbers)
            row.append(
                [out.thrust, out.thrust_rate, *out.torque, *out.rotor, firmware.thrust_excess]
            )
        rows.append(row)
    single, double = np.array(rows).transpose(1, 0, 2)
    worst = np.abs(single - double).max(axis=0) / np.abs(double).max(axis=0)
    assert (worst <= 1e-6).all(), worst


def test_the_selftest_passes_on_this_computer(both):
    assert all(firmware.selftest() == 0 for firmware in both.values())


def test_the_selftest_finds_one_wrong_bit(package, tmp_path):
    tool("cc")
    for path in package.folder.rglob("*"):
        if path.is_file():
            copy = tmp_path / "copy" / path.relative_to(package.folder)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(path.read_bytes())
    source = tmp_path / "copy" / f"{package.name}.c"
    text = source.read_text()
    assert "48.0F" in text
    source.write_text(text.replace("48.0F", "48.000004F"))
    assert Firmware(tmp_path / "copy").selftest() != 0


# --- status, start and limits -------------------------------------------------------------------


def test_at_the_goal_all_is_well_and_the_thrust_is_that_of_hover(firmware):
    out = firmware.step(seen_from_goal(firmware), **CALM)
    assert out.status == 0
    assert out.thrust == pytest.approx(94.08, abs=1e-5)
    assert out.torque == pytest.approx((0, 0, 0), abs=1e-5)


def test_the_first_step_commands_the_thrust_it_was_started_with(firmware):
    for thrust in (80.0, 94.08, 101.5):
        assert firmware.reset(thrust) == 0
        out = firmware.step(seen_from_goal(firmware), **CALM)
        assert out.thrust == pytest.approx(thrust, rel=1e-6)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e30])
@pytest.mark.parametrize("key", ["image", "velocity", "rate", "gravity_direction", "dt"])
def test_an_input_that_is_no_number_is_a_fault_with_safe_outputs(firmware, key, bad):
    image, rest = seen_from_goal(firmware), dict(CALM)
    if key == "image":
        image[2, 1] = bad
    elif key == "dt":
        rest["dt"] = bad
    else:
        rest[key] = [0, bad, 1]
    out = firmware.step(image, **rest)
    assert out.status == 1
    assert out.thrust == pytest.approx(94.08, rel=1e-6)
    assert (out.torque, out.thrust_rate) == ((0, 0, 0), 0)
    assert out.rotor == pytest.approx([23.52] * 4, rel=1e-6)
    assert firmware.thrust_excess == 0


@pytest.mark.parametrize("dt", [0.0, -0.001, 0.11])
def test_a_step_of_no_time_or_too_long_is_a_fault(firmware, dt):
    assert firmware.step(seen_from_goal(firmware), **{**CALM, "dt": dt}).status == 1


def test_each_condition_has_its_bit(firmware):
    image = seen_from_goal(firmware)
    assert firmware.step(image, **CALM, target_seen=False).status == 2
    for excess in (-94.0, -60.0, np.nan, np.inf):
        firmware.thrust_excess = excess
        assert firmware.step(image, **CALM).status == 4
    firmware.thrust_excess = 10.0  # the certificate ends at 1.1 m g
    assert firmware.step(image, **CALM).status & 8
    firmware.reset()
    upside_down = {**CALM, "gravity_direction": [0.1, 0, -0.995]}
    assert firmware.step(image, **upside_down).status & 16
    firmware.reset()
    spinning = {**CALM, "rate": [0, 0, 5.0]}
    out = firmware.step(image, **spinning)
    assert out.status & 32
    assert min(out.rotor) == 0


def test_the_tilt_follows_from_a_level(tmp_path):
    tool("cc")
    made = export(tmp_path, overrides=LEVEL)
    assert 0.999 < made.manifest["tilt_cosine"] < 1
    firmware = Firmware(tmp_path)
    tilted = {**CALM, "gravity_direction": [0.02, 0, 0.9998]}
    assert firmware.step(seen_from_goal(firmware), **tilted).status & 16
    assert firmware.step(seen_from_goal(firmware), **CALM).status == 0


def test_limits_of_the_rotors_that_cannot_be_are_refused(firmware):
    for low, high in ((1, 0), (-1, 40), (24, 40), (0, 20), (0, 1e6), (np.nan, 40), (0, np.nan)):
        assert firmware.set_rotor_limits(low, high) == 1
    assert firmware.set_rotor_limits(1, 40) == 0


def test_a_start_beyond_the_limits_is_limited_and_a_start_from_nan_hovers(firmware):
    assert firmware.reset(1e5) == 1
    assert firmware.reset(float("nan")) == 1
    assert firmware.thrust_excess == 0
    assert firmware.reset(300.0) == 32
    assert firmware.thrust_excess == pytest.approx(4 * 47 - 94.08, rel=1e-6)


@pytest.mark.slow
def test_tuned_gains_fly_as_those_folded_in_and_say_that_nothing_is_proved(tmp_path):
    tool("cc")
    export(tmp_path / "tunable", overrides=OFF_AXIS, tunable=True, precision="float64")
    firmware = Firmware(tmp_path / "tunable")
    other = {"k1": 0.25, "k2": 9.0, "k3": 28.0, "k4": 3.5, "k_yaw": 1.2}
    gains = {f"gains.{k}": v for k, v in other.items()}
    options = {"precision": "float64", "allow_uncertified": True}
    export(tmp_path / "folded", overrides={**OFF_AXIS, **gains}, **options)
    folded, draw = Firmware(tmp_path / "folded"), np.random.default_rng(4)
    assert firmware.step(seen_from_goal(firmware), **CALM).status & 64 == 0
    assert firmware.set_gains(list(other.values())) == 0
    for _ in range(200):
        numbers = draw_input(draw, firmware.manifest, calm=True)
        a, b = outputs(firmware, numbers), outputs(folded, numbers)
        assert a.status & 64
        assert a.torque == pytest.approx(b.torque, rel=1e-9, abs=1e-10)
        assert a.thrust_rate == pytest.approx(b.thrust_rate, rel=1e-9, abs=1e-10)
    for bad in (float("nan"), 0.0, -1.0, 1e9):
        assert firmware.set_gains([bad, *list(other.values())[1:]]) == 1
    assert firmware.set_gains([50.0, 9.0, 28.0, 3.5, 1.2]) == 1  # c q3* would exceed m g


def test_the_rotors_of_the_mission_are_the_limits_unless_others_are_asked_for(tmp_path):
    rotors = {"rotors": {"min_thrust": 2, "max_thrust": 40}}
    made = export(tmp_path / "own", overrides=rotors)
    assert made.manifest["rotor_limits"] == [2, 40]
    limits = (Fraction(1), Fraction(44))
    made = export(tmp_path / "other", overrides=rotors, rotor_limits=limits)
    assert made.manifest["rotor_limits"] == [1, 44]
    weak = {"rotors": {"max_thrust": 20}}
    with pytest.raises(InputError, match=r"x4-flyer: rotors: must hold .* 23.52 N"):
        export(tmp_path / "weak", overrides=weak)


# --- the flight ---------------------------------------------------------------------------------


def test_the_firmware_flies_as_the_simulation_does(both, x4):
    """Held outputs at 1 kHz against the continuous controller: the sampling is the difference."""
    flown = both["x4-flyer", "float32"].fly(0.001, 30, 1000)
    ideal = hoverproof.simulate(x4, duration=30.0, step=0.001, every=1000)
    assert flown["any_status"] == 0
    error = np.abs(flown["state"][:, :3] - ideal["position"].values).max()
    assert error < 2e-4, error  # m, of 1.6 m flown


def test_a_step_takes_what_the_header_has_a_place_for(firmware):
    image = np.zeros((4, 2))
    with pytest.raises(ValueError, match=r"image has the shape \(4, 2\), not \(3, 2\)"):
        firmware.step(image[:3])
    with pytest.raises(AttributeError, match="speed"):
        firmware.step(image, speed=1.0)


def test_a_record_of_a_flight_holds_what_the_package_itself_flew(both, x4):
    firmware = both["x4-flyer", "float64"]
    flight = hoverproof.fly_firmware(x4, firmware, duration=2.0, step=0.001, every=100)
    flown = firmware.fly(0.001, 20, 100)
    assert flight.attrs["outcome"] == "flown"
    assert flight.attrs["machine"] == "firmware, float64"
    assert (flight["position"].values == flown["state"][:, :3]).all()
    assert (flight["rotor_thrust"].values == flown["rotor"]).all()
    assert (flight["firmware_status"].values == 0).all()
    assert float(flight["time"][-1]) == pytest.approx(2.0)


def test_the_firmware_of_another_mission_is_refused(both, x4):
    with pytest.raises(InputError, match="not the mission of the firmware crazyflie_2_1"):
        hoverproof.fly_firmware(x4, both[CRAZYFLIE, "float64"], duration=1.0)


@pytest.mark.parametrize(
    ("overrides", "times", "told"),
    [
        ({"sensors.control_rate": "5"}, {}, "sensors.control_rate"),
        ({}, {"step": 0.2}, "step"),
        ({}, {"step": 0.0}, "step"),
        ({}, {"duration": 0.0}, "duration"),
        ({}, {"duration": float("inf")}, "duration"),
        ({}, {"duration": 1.0, "every": 0}, "every"),
        ({}, {"duration": 1.0, "every": 101}, "every"),
    ],
)
def test_a_flight_of_firmware_that_cannot_be_is_refused(overrides, times, told):
    with pytest.raises(InputError) as refused:
        hoverproof.fly_firmware(load("x4-flyer", overrides), **times)
    assert told in str(refused.value)


def test_one_flies_it_from_the_command_line(capsys):
    tool("cc")
    arguments = ["simulate", "x4-flyer", "--controller", "firmware", "--duration", "20", "--json"]
    with pytest.raises(SystemExit) as stop:
        main([*arguments, "--no-figures"])
    assert stop.value.code == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["outcome"] == "flown"
    assert summary["machine"] == "firmware, float32"


# --- the package --------------------------------------------------------------------------------


def test_the_package_is_complete_and_hashed(package):
    name, listed = package.name, package.manifest["files"]
    for wanted in (f"{name}.c", f"{name}.h", f"{name}_params.h", f"{name}_selftest.c", "README.md"):
        assert wanted in listed
    for path, sha in listed.items():
        assert hashlib.sha256((package.folder / path).read_bytes()).hexdigest() == sha
    assert json.loads((package.folder / "manifest.json").read_text()) == package.manifest
    on_disk = {str(p.relative_to(package.folder)) for p in package.folder.rglob("*") if p.is_file()}
    assert on_disk == {*listed, "manifest.json"}


def test_a_package_has_the_files_and_the_words_of_every_target_folder(package):
    home = Path(targets.__file__).parent
    folders = {path.name for path in home.iterdir() if list(path.glob("*.j2"))}
    assert folders == {target.folder for target in targets.TARGETS}
    told = (package.folder / "adapters/README.md").read_text()
    for target in targets.TARGETS:
        written = {p.name for p in (package.folder / "adapters" / target.folder).iterdir()}
        templates = {p.name.removesuffix(".j2") for p in (home / target.folder).glob("*.j2")}
        named = {name.replace("NAME", package.name) for name in templates}
        only_if_asked = {name for name in named if re.search("_?(camera|lens)[.]c", name)}
        assert named == written | {"where.md"} | only_if_asked
        assert not only_if_asked & written
        assert f"## {target.title}\n" in told


def test_the_certificate_travels_with_the_code(package):
    sealed = package.folder / f"{package.name}.cert.json"
    assert "positive definite" in checker.check_file(sealed)
    sha = json.loads(sealed.read_text())["sha256"]
    assert sha == package.manifest["certificate_sha256"]
    assert sha in (package.folder / f"{package.name}_params.h").read_text()


def test_the_same_mission_gives_the_same_bytes(package, tmp_path):
    again = export_anew(tmp_path / "again")
    assert again.manifest == package.manifest


def test_gains_that_are_refuted_are_not_exported(tmp_path, capsys):
    arguments = ["export", "x4-flyer", "--out", "fw", "--set", "gains.k4=0.1"]
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 1
    assert "refuted" in capsys.readouterr().err
    assert not (tmp_path / "fw").exists()
    with pytest.raises(NotCertified):
        hoverproof.export_c(load("x4-flyer", {"gains.k4": "0.1"}), tmp_path / "fw")


def test_an_uncertified_package_says_so_in_every_file(tmp_path):
    made = export(tmp_path, overrides={"gains.k4": "0.1"}, allow_uncertified=True)
    assert made.manifest["certified"] is False
    for path in made.manifest["files"]:
        assert "UNCERTIFIED" in (tmp_path / path).read_text(), path
    assert not list(tmp_path.glob("*.cert.json"))


def test_a_certificate_of_another_mission_or_one_tampered_with_is_refused(x4, tmp_path):
    proved = certify(x4)
    content = proved.certificate.content
    forged = {**content, "claim": {**content["claim"], "margin": "1"}}
    other = load("x4-flyer", {"gains.k4": "3.1"})
    for mission, certificate in ((other, content), (x4, forged)):
        standing = replace(Standing(proved.problem.thrust), certificate=certificate)
        with pytest.raises(checker.Rejected):
            write_package(mission, tmp_path / "fw", standing)
    assert not (tmp_path / "fw").exists()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"name": "1abc"}, "name"),
        ({"name": "a" * 21}, "name"),
        ({"name": "x-y"}, "name"),
        ({"precision": "float16"}, "precision"),
        ({"sensing": "lidar"}, "sensing"),
        ({"rotor_limits": (Fraction(0), Fraction(10))}, "rotor_limits"),
        ({"rotor_limits": (Fraction(-1), Fraction(40))}, "rotor_limits"),
    ],
)
def test_options_that_cannot_be_are_refused(x4, tmp_path, options, told):
    with pytest.raises(InputError, match=told):
        hoverproof.export_c(x4, tmp_path / "fw", **options)
    assert not (tmp_path / "fw").exists()


def test_an_out_that_is_a_file_is_refused(x4, tmp_path, capsys):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(SystemExit) as stop:
        main(["export", "x4-flyer", "--out", "file"])
    assert stop.value.code == 2
    assert (tmp_path / "file").read_text() == "mine"


def test_the_command_answers_in_json(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["export", "x4-flyer", "--out", "fw", "--rotor-limits", "0.5,40", "--json"])
    assert stop.value.code == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["certified"] is True
    assert answer["rotor_limits"] == [0.5, 40.0]


def test_the_plain_package_compiles_without_a_warning(package, tmp_path):
    for source in package.sources:
        run(tool("gcc"), *FLAGS, *C_WARNINGS, *package.includes, "-c", source, "-o", "made.o")


def test_two_packages_link_into_one_program(tmp_path):
    tool("cc")
    made = [export(tmp_path / n, name=n) for n in ("first", "second")]
    calls = " + ".join(f"{p.name}_selftest()" for p in made)
    headers = "".join(f'#include "{p.name}.h"\n' for p in made)
    (tmp_path / "main.c").write_text(f"{headers}int main(void) {{ return (int)({calls}); }}\n")
    includes = [f"-I{p.folder}" for p in made]
    sources = [s for p in made for s in p.sources]
    run("cc", *FLAGS, *includes, "main.c", *sources, "-lm", "-o", "both")
    run("./both")
