"""What is told where every vehicle within tolerance is not proved: exact states, and a flight."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction as F
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from command_line import run
from exponential_truth import MISSION
from hoverproof import checker
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.form import Variables, Vertex
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.refuting import refused, without_noise
from hoverproof.certification.exponential.terms import terms
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.design.worst_vehicle import vehicles, worst_flight
from hoverproof.mission.reading import load
from papers_law import RACER

MUCH = {"uncertainty.thrust": "0.9"}
EVERYTHING = {
    **{"noise.feature": "0.01", "noise.velocity": "0.01", "noise.force": "0.02"},
    **{"noise.rate": "0.01", "noise.vertical": "0.002", "gust": "0.1"},
    **{"control_period": "0.004", "force_lag": "0.005"},
}
CASES = {
    "one vehicle": MUCH,
    "a start too far": {"uncertainty.latency": "0.4"},
    "no lag, image": {
        "uncertainty.rotor_lag": "0",
        "uncertainty.torque": "0.7",
        "law.goal": '"image"',
    },
}


@pytest.fixture(scope="module")
def found():
    """Return what refuses a case, found once."""
    made = {}

    def of(name):
        if name not in made:
            mission = load(MISSION, CASES[name])
            made[name] = refused(mission, [Start.of(mission)])
        return made[name]

    return of


# --- the states, by the forms of the checker ----------------------------------------------------


def vector(name, size=3):
    first = Variables.place(name).start
    return checker.Vector(checker.Form({(first + k,): F(1)} if k < size else {}) for k in range(3))


def claim(refusal, w, limits):
    """Return the checker's forms with weights w, by name, and its bounds of 1 in all places."""
    a, made = refusal.asked, object.__new__(checker.Exponential)
    content = refusal.content()["design"]
    m, (k1, k2, k3, k4) = content["mass"], (content[f"k{i}"] for i in (1, 2, 3, 4))
    made.k12, made.kappa, made.damping = k1 * k2 / m, (k1 * k2 + k3) / m, k4 / m
    lag = SimpleNamespace(torque=w["a5"], thrust=w["a6"]) if a.lagged else None
    made.c = SimpleNamespace(weights=(w["w2"], w["w3"], w["w4"]), lag=lag)
    each = [
        checker.Vector(
            checker.Form({(3 * k + i,): F(1)} if i < (2 if k == 3 else 3) else {}) for i in range(3)
        )
        for k in range(4)
    ]
    made.errors, made.Y, made.A = each, vector("flow"), vector("ahead")
    thrust = Variables.place("thrust").start
    made.lag = vector("torque", 2)
    made.lift = checker.Vector([checker.Form(), checker.Form(), checker.Form({(thrust,): F(1)})])
    made.may, made.late, made.noise, made.late_axes = limits, limits.latency, F(0), False
    made.wobble = made.twist = made.stray = F(0)
    made.C = made.G = made.H = checker.Vector([checker.Form()] * 3)
    for name in ("quick", "sunk", "cross", "sinking", "spread", "sink", "gyroscopic"):
        setattr(made, name, F(1))  # for radii, of which those of the file are taken
    return made


def value(form, x):
    """Return a linear or quadratic form at x."""
    return sum((c * np.prod([x[i] for i in key]) for key, c in form.items()), F(0))


def by_the_checker(refusal, mission, w):
    """Return the sum of the forms at all states, for weights and multipliers, from the checker."""
    a = refusal.asked
    made = claim(refusal, w, mission.uncertainty)
    goal = a.design[-1] if a.law.goal.name == "image" else F(0)
    j, radius = a.ball
    total = F(0)
    for corner in refusal.corners:
        at = dict(zip(Vertex.sizes(), corner.vertex, strict=True))
        chi, gain, tau, pi = (at[k] for k in ("lever_ratio", "thrust_gain", "lag", "swing"))
        fall = checker.Form() - made.nominal(chi, goal * at["quickness"], gain, tau, pi)
        D, weights = made.errors, (F(1), w["w2"], w["w3"], w["w4"])
        energy = checker.squares(weights, D)
        if a.lagged:
            energy += tau * (w["a5"] * (made.lag @ made.lag) + w["a6"] * (made.lift @ made.lift))
        fall -= (a.rate / 2) * energy
        V = (1 / a.slowness) * (D[0] + D[1])
        off = made.Y - j * V
        fall += w["slope"] * ((off @ off) - radius**2 * (V @ V))
        if a.latency:
            forgets = w["memory"] * a.fading / a.latency
            fall += forgets * (made.A @ made.A) - (w["memory"] * a.latency) * (made.Y @ made.Y)
        terms = made.terms(tau, pi)
        assert len(terms) == len(a.terms)
        for state in corner.states:
            x = state.variables
            total += value(fall, x)
            for k, ((u, v, _), (_, _, size)) in enumerate(zip(terms, a.terms, strict=True)):
                push, t = state.pushes[k], w[f"t{k + 1}"]
                rows = u[3 - len(push) :] if len(push) == 1 else u[:2]
                total += 2 * sum(p * value(row, x) for p, row in zip(push, rows, strict=True))
                total += t * (2 / size * sum(p * p for p in push))
                total -= t * size / 2 * sum(value(row, x) ** 2 for row in v)
    return total


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_whatever_the_weights_the_forms_of_the_checker_add_up_to_less_than_nothing(name, found):
    refusal, mission = found(name), load(MISSION, CASES[name])
    total, rng = refusal.total(), np.random.default_rng(1)
    assert total["1"] < 0
    assert all(c <= 0 for key, c in total.items() if key != "1")
    parts = [refusal.asked.at(corner) for corner in refusal.corners]
    for _ in range(5):
        drawn = {key: F(float(np.exp(3 * rng.normal()))) for key in total}
        w = {**drawn, "1": F(1)}
        forms = sum((c * w[key] for part in parts for key, c in part.items()), F(0))
        assert forms == by_the_checker(refusal, mission, w)
        start = refusal.asked.level - sum(c * w[k] for k, c in refusal.asked.start.items())
        reach = sum(
            most * z[0] ** 2 + 2 * z[0] * sum(z[1:]) + sum(w[n] * c**2 for n, c in names_of(k, z))
            for k, (most, zs) in enumerate(zip(refusal.asked.reach, refusal.vectors, strict=True))
            for z in zs
        )
        assert forms + refusal.start * start + reach < 0


def names_of(k, z):
    """Return the weights that a bound of the reach is of, each with its part of a vector."""
    names = (("w2", "w3"), ("w3",), ("w3", "w4"), ("w2",))[k]
    return zip(names, z[1:], strict=True)


@pytest.mark.parametrize("name", CASES)
def test_the_vehicles_and_the_bounds_are_within_those_of_the_mission(name, found):
    refusal, may = found(name), load(MISSION, CASES[name]).uncertainty
    for corner in refusal.corners:
        at = dict(zip(Vertex.sizes(), corner.vertex, strict=True))
        assert abs(at["thrust_gain"] - 1) <= may.thrust
        assert 0 <= at["lag"] <= may.rotor_lag
    radii = {(pushed, by): size for pushed, by, size in refusal.asked.terms}
    assert 0 < radii["d4", "applied"] <= may.torque


def test_the_modelled_vehicle_is_not_refused_by_the_states_of_another(found):
    refusal = found("one vehicle")
    (corner,) = refusal.corners
    place = list(Vertex.sizes()).index("thrust_gain")
    modelled = (*corner.vertex[:place], F(1), *corner.vertex[place + 1 :])
    assert refusal.total().is_negative
    assert not replace(refusal, corners=(replace(corner, vertex=modelled),)).total().is_negative


@pytest.mark.slow
def test_noise_and_steps_are_left_out_of_what_refuses_and_that_is_said(found):
    """The theorem asks for no less with them, so what refuses without refuses with them."""
    more = {"noise.rate": "0.01", "gust": "0.1", "control_period": "0.004"}
    noisy = load(MISSION, MUCH | {f"uncertainty.{key}": value for key, value in more.items()})
    refusal, calm = refused(noisy, [Start.of(noisy)]), found("one vehicle")
    assert refusal.corners == calm.corners
    assert "even without noise and gusts and steps, with which" in refusal.words
    assert not calm.left_out
    assert without_noise(noisy)[0] == load(MISSION, MUCH)


def test_what_is_left_out_lowers_every_bound_of_the_search():
    """So the form of a mission without it is nowhere lower, whatever the weights."""
    noisy = load(
        MISSION,
        {f"uncertainty.{key}": value for key, value in EVERYTHING.items()}
        | {"camera.position": "[0.02, 0, 0.01]"},
    )
    ball, weights = (4.0, 14.0), np.array([2.0, 1.5, 0.2])
    with_, without = (
        Limits(Vehicles.of(m).before(ball), Reach.of(weights, 10.0), ball[1])
        for m in (noisy, without_noise(noisy)[0])
    )
    assert with_.vehicles.is_shaken
    assert not without.vehicles.is_shaken
    assert with_.lever == without.lever
    more, less = ({(u, v): size for u, v, size in terms(x)} for x in (with_, without))
    assert set(less) <= set(more)
    assert all(less[key] <= more[key] for key in less)
    ends, narrow = (np.array(list(x.vertices())) for x in (with_, without))
    assert (ends.min(axis=0) <= narrow.min(axis=0)).all()
    assert (narrow.max(axis=0) <= ends.max(axis=0)).all()


@pytest.mark.slow
def test_what_is_proved_is_not_refused():
    mission = load(MISSION)
    assert refused(mission, [Start.of(mission)]) is None


# --- flights --------------------------------------------------------------------------------------


def test_vehicles_at_the_corners_differ_and_say_how():
    mission = load(MISSION)
    each = list(vehicles(mission))
    assert len({v.words for v in each}) == len(each) == 20
    for v in each:
        assert abs(v.mission.model_error.thrust) == mission.uncertainty.thrust
        assert {abs(1 / (1 + i) - 1) for i in v.mission.model_error.inertia} == {F(1, 5)}
        assert v.mission.rotors.time_constant == mission.uncertainty.rotor_lag
        pull = v.mission.wind.drag * np.array(v.mission.wind.mean) / mission.vehicle.mass
        assert np.linalg.norm(pull.astype(float)) == pytest.approx(0.2, rel=1e-3)


@pytest.mark.slow
def test_the_worst_flight_is_worse_with_more_doubt():
    mild, wild = (worst_flight(load(MISSION, change)) for change in ({}, MUCH))
    assert mild.settled is not None
    assert wild.settled is None
    assert wild.badness > mild.badness


# --- the command ----------------------------------------------------------------------------------


def answered(capsys, *options):
    status, out, _ = run(capsys, "attraction", *options)
    return status, out


@pytest.mark.slow
def test_the_command_tells_both_and_writes_the_states(capsys):
    settings = [f"--set={key}={value}" for key, value in MUCH.items()]
    status, out = answered(capsys, str(MISSION), *settings, "--json")
    assert status == 3
    told = json.loads(out)
    assert told["certificate"] is None
    refusal, flight = told["unproved"]["refusal"], told["unproved"]["flight"]
    assert flight["proof"] is False
    assert flight["settled_at"] is None
    content = json.loads(Path(refusal["file"]).read_text(encoding="utf-8"))
    assert F(content["sum"]["1"]) < 0
    assert all(F(c) <= 0 for name, c in content["sum"].items() if name != "1")
    assert sum(len(corner["states"]) for corner in content["corners"]) == refusal["states"]


@pytest.mark.slow
def test_what_is_a_simulation_is_said_to_be_no_proof(capsys):
    given = ["--set=uncertainty.torque=0.2", "--set=law.force=measured", "--no-barrier"]
    status, out = answered(capsys, RACER, *given)
    assert status == 3
    said = [line for line in out.splitlines() if not line.startswith("Next: ")]  # to be copied
    assert all(len(line) <= 80 for line in said)
    assert "a simulation, no proof: of 2 vehicles" in " ".join(out.split())


@pytest.mark.slow
def test_a_mission_without_tolerances_is_told_no_more(capsys):
    status, out = answered(capsys, RACER, "--no-barrier", "--json")
    assert status == 3
    assert json.loads(out)["unproved"] is None
