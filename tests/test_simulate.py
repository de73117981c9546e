"""The flight: against an independent model, with or without a compiler, and its honest ends."""

from __future__ import annotations

import json
import subprocess
from fractions import Fraction
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.servo.linearised import slowest_rate
from hoverproof.simulation import compiled
from hoverproof.simulation.flight import (
    default_duration,
    flown,
    save,
    simulate,
    summary,
)
from hoverproof.simulation.numbers import euler_angles
from hoverproof.simulation.timing import Timing
from papers_law import RESEARCH

needs_compiler = pytest.mark.skipif(not compiled.find_compiler(), reason="no C compiler here")


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def independent_rate(_, x, mission, q_star):
    """The closed loop in plain numpy, written from eqs. 1-9, 17, 18, 25 and the wanted δ̇4.

    U and Ω̇ come from the closed forms of the controller, in other words than the project's.
    """
    v, k = mission.vehicle, mission.gains
    m, g = float(v.mass), float(v.gravity)
    inertia = np.array([float(i) for i in v.inertia])
    k1, k2, k3, k4, k_yaw = (float(n) for n in (k.k1, k.k2, k.k3, k.k4, k.k_yaw))
    xi, V, R, Omega, T = x[:3], x[3:6], x[6:15].reshape(3, 3), x[15:18], x[18]
    e3, P = np.array([0, 0, 1.0]), np.diag([1.0, 1, 0])
    seen = np.array([R.T @ (np.array(p, float) - xi) for p in mission.target.points])
    q = sum(s / np.linalg.norm(s) for s in seen)
    F = -T * e3 + m * g * R.T @ e3
    c = k1**2 * k2 / m
    d1 = q - q_star
    d2 = m / k1 * V - d1
    d3 = F / c + d2
    lever = skew(T * e3 - c * q_star)
    beta = m**2 / (k1**2 * k2 * (k1 * k2 + k3))
    d4 = beta * P @ lever @ Omega + P @ d3
    w = (k1 * k2 + k3) / m
    U = c * (w * d3[2] - (skew(q_star) @ Omega)[2])
    # what remains of δ̇4 when Ω̇ is left out, without the depth terms that cancel
    known = beta * U * P @ skew(e3) @ Omega + P @ (
        -skew(Omega) @ d3 - k1 * k2 / m * d2 + w * d4 - k3 / m * P @ d3
    )
    wanted = -w * P @ d3 - k4 / m * d4
    yaw = -k_yaw / inertia[2] * Omega[2]
    rest = wanted - known - beta * P @ lever @ (yaw * e3)
    a = beta * (T - c * q_star[2])
    Omega_dot = np.array([rest[1] / a, -rest[0] / a, yaw])
    torque = inertia * Omega_dot + np.cross(Omega, inertia * Omega)
    return np.concatenate(
        [
            R @ V,
            -np.cross(Omega, V) + F / m,
            (R @ skew(Omega)).ravel(),
            (torque - np.cross(Omega, inertia * Omega)) / inertia,
            [U],
        ]
    )


STARTS = {
    "the paper's start": {},
    "moving, tilted and turning": {
        "start.velocity": "[0.2, -0.1, 0.05]",
        "start.rotation": "[0.02, -0.03, 0.4]",
        "start.rates": "[0.01, -0.02, 0]",
    },
    "an unsymmetric target": {"target.points": "[[0, 0, 0], [1, 0, 0], [0, 2, 0.1]]"},
    "a goal off the axis": {"goal": "{centroid = [0.2, -0.1, 3.5]}"},
}


@pytest.mark.slow
@pytest.mark.parametrize("start", STARTS)
def test_the_flight_agrees_with_an_independent_adaptive_integration(start):
    mission = load("x4-flyer", STARTS[start])
    flight = simulate(mission, duration=60)
    q_star = flight.attrs["goal_centroid"]
    state = np.concatenate(
        [
            *(flight[name].values[0].ravel() for name in ("position", "velocity", "rotation")),
            flight["body_rate"].values[0],
            flight["thrust"].values[:1],
        ]
    )
    times = flight["time"].values
    solution = solve_ivp(
        independent_rate,
        (0, times[-1]),
        state,
        method="DOP853",
        t_eval=times,
        rtol=1e-11,
        atol=1e-12,
        args=(mission, q_star),
    )
    assert solution.success
    y = solution.y.T
    for name, columns, shape in (
        ("position", slice(0, 3), (3,)),
        ("velocity", slice(3, 6), (3,)),
        ("rotation", slice(6, 15), (3, 3)),
        ("body_rate", slice(15, 18), (3,)),
        ("thrust", slice(18, 19), ()),
    ):
        expected = y[:, columns].reshape(-1, *shape)
        assert np.abs(flight[name].values - expected).max() < 1e-6, name


@pytest.mark.slow
def test_the_paper_s_flight_agrees_at_every_sample_of_1500_s(x4, whole):
    """Of the first 300 s, and with `make trials` of all."""
    duration = 1500 if whole else 300
    flight = simulate(x4, duration=duration)
    state = [5, 2.5, -4, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 94.08]
    solution = solve_ivp(
        independent_rate,
        (0, duration),
        state,
        method="DOP853",
        t_eval=flight["time"].values,
        rtol=1e-10,
        atol=1e-11,
        args=(x4, flight.attrs["goal_centroid"]),
    )
    assert np.abs(flight["position"].values - solution.y[:3].T).max() < 1e-6
    assert np.abs(flight["thrust"].values - solution.y[18]).max() < 1e-6


def test_the_paper_s_flight_settles_and_L_never_rises(x4):
    flight = simulate(x4, duration=1500, every=10)
    assert np.linalg.norm(flight["position"].values[-1] - [0, 0, -3]) < 0.02
    assert (np.diff(flight["lyapunov"].values) < 0).all()
    result = summary(flight)
    assert result["outcome"] == "flown"
    assert result["steps"] == 150_000
    error = np.linalg.norm(flight["position"].values - [0, 0, -3], axis=1)
    times = flight["time"].values
    assert (error[times >= result["settled_at"]] <= 0.1 * error[0]).all()
    assert error[times < result["settled_at"]][-1] > 0.1 * error[0]


@needs_compiler
def test_machine_code_and_virtual_machine_give_the_same_bits(x4):
    a, b = simulate(x4, duration=30, every=7), simulate(x4, duration=30, every=7, compiler="")
    assert a.attrs["machine"] == "compiled C"
    assert b.attrs["machine"] == "CasADi virtual machine"
    for name in a:
        assert np.array_equal(a[name].values, b[name].values), name


@pytest.mark.parametrize("compiler", ["false", "/no/such/compiler"])
def test_a_compiler_that_fails_leaves_the_virtual_machine(compiler, x4):
    flight = simulate(x4, duration=1, compiler=compiler)
    assert flight.attrs["machine"] == "CasADi virtual machine"


@needs_compiler
def test_a_second_flight_takes_the_library_from_the_cache(x4, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    compiled._library.cache_clear()
    simulate(x4, duration=1)
    (library,) = (tmp_path / "hoverproof").iterdir()
    made = library.stat().st_mtime_ns
    compiled._library.cache_clear()
    simulate(x4, duration=1)
    assert [p.stat().st_mtime_ns for p in (tmp_path / "hoverproof").iterdir()] == [made]
    compiled._library.cache_clear()


@needs_compiler
def test_the_c_code_holds_the_loop_so_that_python_stays_out_of_it():
    source = compiled.c_source(4)
    assert "hoverproof_run" in source
    assert "hoverproof_step(arg, res" in source


def test_halving_the_step_divides_the_error_by_sixteen():
    mission = load("x4-flyer", {"gains.k1": "2", "gains.k4": "30"})

    def end(step):
        return simulate(mission, duration=2, step=step, every=round(2 / step))["position"].values[
            -1
        ]

    tight = end(2**-10)
    ratio = np.linalg.norm(end(2**-4) - tight) / np.linalg.norm(end(2**-5) - tight)
    assert 15 < ratio < 17


@pytest.mark.parametrize(("angle", "stronger"), [(0, "right"), (1, "front")])
def test_a_vehicle_that_leans_to_a_side_is_pushed_up_there(angle, stronger):
    """Rolled to the right, or with its nose down; above the goal's place and at rest."""
    lean = ["0", "0", "0"]
    lean[angle] = "0.1" if stronger == "right" else "-0.1"
    start = {"start.position": "[0, 0, -2]", "start.rotation": f"[{', '.join(lean)}]"}
    flight = simulate(load(RESEARCH, start), duration=0.02)
    first = flight["rotor_thrust"].isel(time=0).to_series()
    there = [name for name in first.index if stronger in name]
    assert first[there].min() > first.drop(there).max()


def test_the_rotation_stays_a_rotation(x4):
    mission = load("x4-flyer", {"start.rotation": "[0.3, -0.2, 1]", "start.rates": "[0.5, 0.2, 1]"})
    R = simulate(mission, duration=60)["rotation"].values
    assert np.abs(R.transpose(0, 2, 1) @ R - np.eye(3)).max() < 1e-13


@pytest.mark.parametrize(
    ("change", "outcome"),
    [
        ({"gains.k1": "200", "gains.k2": "300"}, "thrust fell to the singularity at 0 s"),
        (
            {"gains.k4": "9000", "sensors.control_rate": "100"},
            "a target point came behind the camera",
        ),
        (
            {"start.rotation": "[2, 0, 0]"},
            "tipped over at 0 s",
        ),
    ],
)
def test_a_flight_that_cannot_go_on_says_so(change, outcome):
    flight = simulate(load("x4-flyer", change), duration=50)
    assert flight.attrs["outcome"] != "flown"
    assert outcome in flight.attrs["outcome"]
    assert summary(flight)["settled_at"] is None
    assert all(np.isfinite(flight[name].values).all() for name in flight)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"step": 0}, "step: must be a positive time"),
        ({"step": float("nan")}, "step"),
        ({"duration": -1}, "duration: must be at least one step"),
        ({"duration": float("inf")}, "duration"),
        ({"duration": 1, "every": 0}, "every: must be between 1 and the 100 steps"),
        ({"duration": 9e5, "every": 1}, "every: would keep 90000000 of 90000000 steps"),
    ],
)
def test_impossible_times_are_refused(x4, options, message):
    with pytest.raises(InputError, match=message):
        simulate(x4, **options)


def test_the_default_duration_is_seven_slowest_time_constants(x4):
    late = simulate(x4, duration=1500)["lyapunov"].values[-200:]
    measured = -np.polyfit(np.arange(200) * 0.75, np.log(late), 1)[0] / 2
    assert slowest_rate(x4) == pytest.approx(measured, rel=0.02)
    assert default_duration(x4) == pytest.approx(7 / slowest_rate(x4), rel=0.05)


def test_the_flight_file_opens_elsewhere_and_carries_units_and_mission(x4):
    save(flown(x4, Timing(duration=10)), "a.nc")
    with xr.open_dataset("a.nc") as flight:
        assert flight["position"].attrs["units"] == "m"
        assert all("units" in flight[name].attrs for name in flight)
        assert json.loads(flight.attrs["mission"])["gains"]["k3"] == "61/2"
        assert len(flight.attrs["model_sha256"]) == 64


@pytest.mark.slow
@pytest.mark.parametrize("change", [{}, {"wind": "{mean = [1, 0, 0], drag = 0.2}"}])
def test_the_flight_file_is_the_one_that_xarray_writes(x4, change):
    flight = flown(load("x4-flyer", change), Timing(duration=10))
    save(flight, "ours.nc")
    flight.dataset().to_netcdf("theirs.nc", engine="h5netcdf")
    files = [xr.open_dataset(name, engine="h5netcdf") for name in ("ours.nc", "theirs.nc")]
    ours, theirs = (file.load() for file in files)
    assert ours.identical(theirs) and ours.identical(flight.dataset())
    for name in theirs.variables:
        stored = [{**file[name].encoding, "source": ""} for file in files]
        numbers = theirs[name].dtype.kind in "fiu" and theirs[name].ndim > 0
        assert stored[0].pop("fletcher32", False) is numbers
        assert stored[1].pop("fletcher32", False) is False
        stored = [
            {k: v for k, v in each.items() if "chunk" not in k and k != "contiguous"}
            for each in stored
        ]
        assert str(stored[0]) == str(stored[1])


def test_a_failed_write_leaves_the_old_file(x4, monkeypatch):
    Path("a.nc").write_text("old")

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    flight = flown(x4, Timing(duration=1))
    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InputError, match="No space left"):
        save(flight, "a.nc")
    assert Path("a.nc").read_text() == "old"
    assert [p.name for p in Path.cwd().iterdir()] == ["a.nc"]


def test_euler_angles_are_the_inverse_of_the_rotation():
    angles = np.random.default_rng(3).uniform(-1.2, 1.2, (50, 3))
    R = np.array([rotation_matrix(*a) for a in angles])
    assert np.allclose(euler_angles(R), angles)


@needs_compiler
def test_the_generated_code_compiles_without_a_warning_of_ours():
    command = [compiled.find_compiler(), "-std=gnu11", "-Wall", "-Wextra", "-fsyntax-only"]
    quiet = ["-Wno-unused-function", "-Wno-unused-parameter", "-Wno-attributes", "-x", "c", "-"]
    done = subprocess.run(
        [*command, *quiet], input=compiled.c_source(4), capture_output=True, text=True, check=True
    )
    assert done.stderr == ""


def test_sharing_reciprocals_changes_no_value():
    x = ca.SX.sym("x", 3)
    plain = ca.Function("f", [x], [x[0] / x[1] + x[2] / x[1] - 1 / x[2], ca.sqrt(x[0] ** 2 + 1)])
    shared = share_reciprocals(plain)
    divisions = sum(
        shared.instruction_id(k) in (ca.OP_DIV, ca.OP_INV) for k in range(shared.n_instructions())
    )
    assert divisions == 2
    values = [Fraction(3), Fraction(-7, 5), Fraction(2, 9)]
    first = [ca.Function("g", [x], [f(x)[0]]) for f in (plain, shared)]
    assert evaluate(first[0], [values]) == evaluate(first[1], [values])
    numbers = [float(v) for v in values]
    assert float(plain(numbers)[1]) == pytest.approx(float(shared(numbers)[1]), rel=1e-15)
