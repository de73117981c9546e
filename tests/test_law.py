"""A law is a value: another one, made here, is derived, flown and exported by the same code."""

from __future__ import annotations

import importlib
import pickle
import re
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.compilers import find_compiler
from hoverproof.export.binding import Firmware
from hoverproof.export.package import NotCertified, write_package
from hoverproof.export.standing import Standing
from hoverproof.firmware.exporting import export_c
from hoverproof.firmware.flying import fly_firmware
from hoverproof.mission.reading import load
from hoverproof.mission.task import Gains
from hoverproof.plant import camera
from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.feature import Feature
from hoverproof.servo.laws.choices import WithAccelerometer
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY, LAWS, horizontal, wanted_rates
from hoverproof.servo.laws.heading import DesignWithHeading
from hoverproof.servo.layout import scalar
from hoverproof.servo.linearised import slowest_rate
from hoverproof.servo.loop import LoopNumbers, loop_rate, parameters, sense
from hoverproof.servo.lyapunov import (
    derive_error_dynamics,
    derive_lyapunov_form,
    linearised_loop,
    thrust_factor,
)
from hoverproof.servo.variables import Design, Errors, Measurement
from hoverproof.simulation.block import fly_raw
from hoverproof.simulation.flight import simulate, summary
from hoverproof.simulation.plan import Plan

needs_compiler = pytest.mark.skipif(not find_compiler(), reason="no C compiler here")


@dataclass(frozen=True)
class OtherDesign(Design):
    """One gain more than the paper's law has; here it follows from k4."""

    k5: ca.SX = scalar("kg/s", gain=True)

    @classmethod
    def numbers(cls, mission):
        gains = {**dict(mission.gains), "k5": mission.gains.k4 / 4}
        others = Design.numbers(mission)
        return {**others, **{name: (gains[name],) for name in cls.gains()}}


def other_rates(e, measured, design, depth_flow):
    """The body-rate error is to answer the velocity error too, through k5."""
    wanted = wanted_rates(e, measured, design, depth_flow)
    return replace(wanted, d4=wanted.d4 - design.k5 * horizontal(e.d2) / design.mass)


OTHER = replace(HAMEL_MAHONY, variant="other", wanted_rates=other_rates, design=OtherDesign)


def stretched(q, spread, points):
    """A feature that grows faster than q as |q| nears the number of points."""
    return q / ca.sqrt(spread / points**2)


STRETCHED = replace(HAMEL_MAHONY, feature=Feature("stretched", stretched))


ABOVE = LAWS["centroid", "inertial", "modelled"]
FEELING = LAWS["centroid", "image", "measured"]
SCALED = LAWS["scaled", "image", "modelled"]
BEST = LAWS["scaled", "inertial", "measured"]
TILTED = {"start.rotation": "[0.03, -0.02, 0]", "start.rates": "[0.01, -0.02, 0]"}


@pytest.fixture(scope="module")
def x4():
    return load("x4-flyer-tuned", TILTED)


@pytest.fixture(scope="module")
def flight(x4):
    return simulate(x4, law=OTHER)


def test_the_law_of_the_guide_is_one_file_and_flies(x4, tmp_path, monkeypatch):
    guide = (Path(__file__).parent.parent / "CONTRIBUTING.md").read_text(encoding="utf-8")
    diff = re.search(r"```diff\n\+\+\+ (\S+)\n(.*?)```", guide, re.S)
    assert diff[1].startswith("src/hoverproof/servo/laws/")
    lines = [line.removeprefix("+") for line in diff[2].splitlines()]
    (tmp_path / Path(diff[1]).name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    law = importlib.import_module("softer").SOFTER
    assert law.name == "centroid/image/modelled (softer)"
    flown = simulate(x4, duration=20, law=law)
    papers = simulate(x4, duration=20)
    assert flown.attrs["outcome"] == "flown"
    assert flown.attrs["model_sha256"] != papers.attrs["model_sha256"]


def test_the_gains_of_a_law_are_those_of_a_mission():
    assert tuple(DesignWithHeading.gains()) == tuple(Gains.model_fields)
    for name, unit in Design.gains().items():
        assert unit in Gains.__doc__, name


def test_a_layout_that_extends_another_has_its_own_after_it():
    assert OtherDesign.sizes() == Design.sizes() | {"k5": 1}
    assert OtherDesign.place("k5") == slice(13, 14)
    design = OtherDesign.symbols()
    again = OtherDesign.from_vector(design.vector())
    for name in OtherDesign.sizes():
        assert ca.is_equal(getattr(design, name), getattr(again, name), 1)
    assert (Measurement.size(), Errors.size()) == (13, 11)


def test_a_law_travels_and_is_a_key():
    for law in (HAMEL_MAHONY, OTHER):
        assert pickle.loads(pickle.dumps(law)) == law
    assert len({HAMEL_MAHONY, OTHER, replace(OTHER)}) == 2


def test_its_controller_brings_about_what_it_wants():
    controller = derive_controller(OTHER)
    z, d, y = controller.measured, controller.design, ca.SX.sym("y", 3)
    assert isinstance(d, OtherDesign)
    e = OTHER.errors(z, d)
    got = ca.jtimes(e.vector(), z.vector(), controller.measured_rate(y))
    wanted = other_rates(e, z, d, y)
    papers = wanted_rates(e, z, d, y)
    outputs = [got[9:11], wanted.d4, papers.d4, got[8], wanted.d3_vertical]
    f = ca.Function("f", [z.vector(), d.vector(), y], outputs)
    draw = np.random.default_rng(1)
    for _ in range(20):
        measured = np.r_[draw.normal(size=12), 50]
        values = f(measured, draw.uniform(0.5, 2, 14), draw.normal(size=3))
        d4, wanted_d4, papers_d4, d3, wanted_d3 = (np.array(v).ravel() for v in values)
        assert d4 == pytest.approx(wanted_d4, rel=1e-9, abs=1e-9)
        assert d3 == pytest.approx(wanted_d3, rel=1e-9, abs=1e-9)
        assert np.abs(d4 - papers_d4).max() > 1e-3


def test_it_flies_to_the_goal_on_a_way_of_its_own(x4, flight):
    came = summary(flight)
    assert came["outcome"] == "flown"
    assert came["settled_at"] is not None
    assert came["final_error"] < 1e-2 * came["start_error"]
    ours = flight["position"].values
    papers = simulate(x4, duration=came["duration"], law=HAMEL_MAHONY)
    assert papers.attrs["model_sha256"] != flight.attrs["model_sha256"]
    theirs = papers["position"].interp(time=flight["time"]).values
    assert np.nanmax(np.linalg.norm(ours - theirs, axis=1)) > 1e-2 * came["start_error"]


@pytest.mark.parametrize("other", [OTHER, STRETCHED, ABOVE], ids=lambda law: law.name)
def test_near_the_goal_its_errors_move_as_its_vehicle_does(x4, other):
    """Each motion of the linearised error chain is one of the linearised vehicle."""
    numbers = LoopNumbers.of(x4, other)
    (design, points), x = parameters(numbers.target_size, other), ca.SX.sym("x", STATE_SIZE)
    slope = ca.jacobian(loop_rate(x, design, points, other), x)
    f = ca.Function("f", [x, design.vector(), points], [slope])
    vehicle = np.linalg.eigvals(np.array(f(numbers.hover, numbers.design, numbers.points)))

    def farthest(law):
        own = LoopNumbers.of(x4, law)
        d, Q = law.design.symbols(), own.depth_matrix()
        factor = ca.Function("f", [d.vector()], [thrust_factor(ca.SX(own.hover_thrust), d, law)])
        B = linearised_loop(law)(own.design, Q, factor(own.design))
        motions = np.linalg.eigvals(np.array(B))
        return np.abs(motions[:, None] - vehicle).min(axis=1).max()

    assert farthest(other) < 1e-5 < 1e-3 < farthest(HAMEL_MAHONY)
    assert slowest_rate(x4, other) == pytest.approx(-vehicle.real[vehicle.real < -1e-6].max())


def test_what_it_makes_of_the_image_it_makes_of_the_goal(x4):
    flown = simulate(x4, law=STRETCHED)
    assert summary(flown)["final_error"] < 1e-2 * summary(flown)["start_error"]
    goal, papers = flown.attrs["goal_centroid"], LoopNumbers.of(x4).goal_centroid
    assert np.linalg.norm(goal) > 1.1 * np.linalg.norm(papers)
    assert np.cross(goal, papers) == pytest.approx([0, 0, 0], abs=1e-12)


def test_it_may_measure_more(x4):
    """With an ideal accelerometer in place of the modelled force it is the same flight."""
    measured = LoopNumbers.of(x4, FEELING).measured()
    assert measured[WithAccelerometer.place("specific_force")] == pytest.approx(
        [0, 0, -9.8], abs=0.05
    )
    flown, modelled = (simulate(x4, duration=20, law=law) for law in (FEELING, HAMEL_MAHONY))
    assert flown.attrs["model_sha256"] != modelled.attrs["model_sha256"]
    ours, theirs = (f["position"].values for f in (flown, modelled))
    assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-9)
    assert slowest_rate(x4, FEELING) == pytest.approx(slowest_rate(x4), rel=1e-9)


def lyapunov_rate(law, points):
    """Return (state, design) ↦ L' by the derived dissipation, with Q and f(T) of the state."""
    form = derive_lyapunov_form(derive_error_dynamics(law))
    x, design = ca.SX.sym("x", STATE_SIZE), law.design.symbols()
    body = RigidBodyState.from_vector(x)
    seen = camera.body_points(ca.SX(points), body.position, body.rotation)
    measured, _, _ = sense(body, ca.SX(points), law, design, all_round=True)
    Q = camera.depth_matrix(seen)
    lower = ca.vertcat(*(Q[i, j] for j in range(3) for i in range(j, 3)))
    old = ca.vertcat(form.errors, form.Q_lower, form.f, form.weights, form.design.vector())
    new = ca.vertcat(
        law.errors(measured, design).vector(),
        lower,
        thrust_factor(body.thrust, design, law),
        ca.SX.ones(4),
        design.vector(),
    )
    rate = -ca.substitute(form.dissipation, old, new) / design.mass
    return ca.Function("rate", [x, design.vector()], [rate])


def test_its_dissipation_is_what_its_flight_shows(x4):
    """L' that is derived agrees with differences of L along the compiled flight."""
    step, numbers = 1e-3, LoopNumbers.of(x4, OTHER)
    flown = simulate(x4, duration=3, step=step, every=1, law=OTHER)
    level = flown["lyapunov"].values
    parts = [flown[name].values for name in ("position", "velocity")]
    columns = flown["rotation"].values.transpose(0, 2, 1).reshape(len(level), 9)
    states = np.column_stack([*parts, columns, flown["body_rate"].values, flown["thrust"].values])
    rate = lyapunov_rate(OTHER, numbers.points)
    papers = lyapunov_rate(HAMEL_MAHONY, numbers.points)
    shown = (level[2:] - level[:-2]) / (2 * step)
    inside = states[1:-1:100].T
    derived = np.array([float(rate(x, numbers.design)) for x in inside.T])
    assert derived == pytest.approx(shown[::100], rel=1e-3, abs=1e-5 * np.abs(shown).max())
    design = LoopNumbers.of(x4).design
    of_the_paper = np.array([float(papers(x, design)) for x in inside.T])
    assert np.abs(of_the_paper / derived - 1).max() > 0.1


@needs_compiler
def test_compiled_alone_in_a_batch_and_on_the_virtual_machine_it_is_one_flight(x4):
    compiled = simulate(x4, duration=2, step=0.01, every=10, law=OTHER)
    virtual = simulate(x4, duration=2, step=0.01, every=10, law=OTHER, compiler="")
    plan = Plan(x4, 0.01, 20, 10, scattered=False, law=OTHER)
    records, _, good = fly_raw(pickle.loads(pickle.dumps(plan)), 0, 3)
    assert compiled.attrs["machine"] != virtual.attrs["machine"]
    assert (good == 20).all()
    for name, at in (("position", slice(3)), ("body_rate", slice(15, 18))):
        assert (compiled[name].values == virtual[name].values).all()
        assert (records[:, :, at] == compiled[name].values).all()


def test_it_flies_with_sensors_and_rotors_of_a_vehicle(x4):
    real = {"sensors.frame_rate": "60", "sensors.control_rate": "200", "rotors.time_constant": 0.01}
    built = load("x4-flyer-tuned", TILTED | real)
    flown = simulate(built, duration=5, law=OTHER)
    assert flown.attrs["outcome"] == "flown"
    ideal = simulate(x4, duration=5, law=OTHER)
    far = np.linalg.norm(flown["position"].values[-1] - ideal["position"].values[-1])
    papers = simulate(built, duration=5)
    assert far < np.linalg.norm(papers["position"].values[-1] - ideal["position"].values[-1])


@pytest.mark.slow
@needs_compiler
@pytest.mark.parametrize(
    ("law", "tunable"),
    [(OTHER, False), (OTHER, True), (STRETCHED, False), (ABOVE, False)],
    ids=lambda x: getattr(x, "name", "tunable" if x else "fixed"),
)
def test_its_firmware_computes_it(x4, tmp_path, law, tunable):
    export_c(x4, tmp_path, law=law, allow_uncertified=True, precision="float64", tunable=tunable)
    firmware = Firmware(tmp_path)
    assert firmware.selftest() == 0  # bit for bit what the graph gives
    assert not firmware.manifest["certified"]
    says = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "hovers at another height" in says
    assert ("is not computed where" in says) == (law is STRETCHED)
    numbers = LoopNumbers.of(x4, law)
    design, gains = numbers.design.copy(), list(law.design.gains())
    if tunable:
        for name in gains:
            design[law.design.place(name)] *= 1.1
        firmware.set_gains([float(design[law.design.place(name)][0]) for name in gains])
    ours, papers = (derive_controller(a).function() for a in (law, HAMEL_MAHONY))
    draw, weight = np.random.default_rng(2), numbers.hover_thrust
    for _ in range(20):
        image = draw.uniform(-0.5, 0.5, (4, 2))
        rays = np.column_stack([image, np.ones(4)])
        centroid = (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(0)
        velocity, rate = draw.normal(0, 0.1, 3), draw.normal(0, 0.1, 3)
        down = np.array([0.02, -0.01, 1]) / np.linalg.norm([0.02, -0.01, 1])
        firmware.reset()
        out = firmware.step(image, velocity=velocity, rate=rate, gravity_direction=down, dt=0.001)
        feature = np.array(ca.evalf(law.feature.at(ca.SX(centroid), 4))).ravel()
        measured = np.r_[feature, velocity, down, rate, weight]
        thrust_rate, torque = ours(measured, design)
        assert out.thrust_rate == pytest.approx(float(thrust_rate), rel=1e-9, abs=1e-9)
        assert out.torque == pytest.approx(np.array(torque).ravel().tolist(), rel=1e-9, abs=1e-9)
        papers_measured = np.r_[centroid, measured[3:]]
        _, other_torque = papers(papers_measured, LoopNumbers.of(x4).design)
        assert np.abs(np.array(torque) - np.array(other_torque)).max() > 1e-6


@needs_compiler
def test_its_firmware_flies_as_it_does(x4):
    flown, ideal = (f(x4, duration=10, step=0.002, law=OTHER) for f in (fly_firmware, simulate))
    assert flown.attrs["outcome"] == "flown"
    apart = np.linalg.norm(flown["position"].values - ideal["position"].values, axis=1)
    assert apart.max() < 1e-2 * summary(ideal)["start_error"]


def test_its_firmware_has_no_certificate_of_the_papers_law(x4, tmp_path):
    with pytest.raises(NotCertified, match=r"not about centroid/image/modelled \(other\)"):
        export_c(x4, tmp_path, law=OTHER)
    certificate = certify(x4).certificate.content
    standing = Standing((Fraction(1), Fraction(2)), certificate)
    with pytest.raises(checker.Rejected, match=r"not about centroid/image/modelled \(other\)"):
        write_package(x4, tmp_path, standing, law=OTHER)
    assert not list(tmp_path.iterdir())
