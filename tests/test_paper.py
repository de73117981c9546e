"""The ledger: verdicts, independent witnesses, and mutants that the prover must reject."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

import checker_kit
from command_line import run
from hoverproof import checker, cli
from hoverproof.algebra.identity import prove_equal
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.paper import equations, symbols, theorem
from hoverproof.paper import ledger as ledger_module
from hoverproof.paper.judge import Verdict, identity, proof_of
from hoverproof.paper.ledger import ORDER, all_proved, as_rows, derive, derive_once, ledger
from hoverproof.paper.notation import (
    Number,
    Power,
    Product,
    Quotient,
    Skew,
    SquaredNorm,
    Sum,
    Symbol,
    Transpose,
)
from hoverproof.paper.printed import Equation
from hoverproof.paper.symbols import d1, d1_rate, k1, k3, k4, m, number, sk
from hoverproof.paper.units import UnitError
from hoverproof.paper.worlds import closed_loop_no_yaw
from hoverproof.plant.camera import depth_matrix
from hoverproof.servo.loop import LoopNumbers
from hoverproof.show.ledger import claim_text
from hoverproof.simulation.flight import simulate
from sampling import share_of

FALSE = {"conditions", "theorem", "gains"}
CORRECTED = {
    *("6", "|δ1|²", "J", "29", "31", "k1", "33", "L̇ with A", "Σ"),
    *("T by errors", "T by L", "T0", "37", "38", "units of gains"),
}


@pytest.fixture(scope="module")
def judged():
    return {j.id: j for j in derive()}


def test_every_numbered_equation_is_judged(judged):
    assert {str(n) for n in range(1, 40)} <= set(judged)
    assert set(judged) == set(ORDER) == {c.id for c in ledger()}
    assert all_proved(list(judged.values()))


def test_the_verdicts(judged):
    by_verdict = {v: {j.id for j in judged.values() if j.verdict is v} for v in Verdict}
    assert by_verdict[Verdict.FALSE] == FALSE
    assert by_verdict[Verdict.CORRECTED] == CORRECTED
    assert by_verdict[Verdict.CONVENTION] == {"12"}
    assert not by_verdict[Verdict.UNPROVED]
    for id in ("8", "11", "22", "23", "24", "26", "27", "28", "30", "34", "35"):
        assert judged[id].verdict is Verdict.HOLDS


def test_each_failure_is_named(judged):
    assert judged["6"].reason.startswith("sign:")
    assert judged["J"].reason.startswith("sign:")
    assert judged["|δ1|²"].reason.startswith("factor: the right side must be 2 times")
    assert "units" in judged["k1"].reason
    assert "units" in judged["33"].reason
    assert "Ω̇, not δ̇3" in judged["29"].reason
    for id in CORRECTED | FALSE:
        assert judged[id].derived is not judged[id].printed or id == "gains"
        if id not in {"k1", "units of gains"}:
            assert judged[id].counterexample, id


def test_where_yaw_is_assumed_to_be_zero_the_ledger_says_so(judged):
    with_yaw = {"22", "23", "24", "26", "27", "28", "30", "34"}
    without = {"29", "31", "35", "L̇ with A", "Σ"}
    assert all("Ω3 = 0" not in judged[id].reason for id in with_yaw)
    assert all("Ω3 = 0" in judged[id].reason for id in without)


def test_where_yaw_is_assumed_to_be_zero_it_has_to_be():
    """With Ω3 free the same equations are refuted, so the assumption is not idle."""
    by_id = {c.id: c for c in equations.EQUATIONS}
    for id, anywhere in (
        *(("29", equations.FREE), ("35", equations.FREE)),
        *(("31", equations.LOOP), ("L̇ with A", equations.LOOP)),
    ):
        assert not proof_of(right_form(by_id[id]), anywhere), id


def test_each_fault_of_the_printed_torque_is_a_fault_of_its_own():
    """Mending two of the three still leaves an equation that does not hold."""
    e = equations
    right = e.inertia / e.distance
    torque = {
        "𝐈⁻¹ kept": e.inertia_inverse
        * (e.gyroscopic - right * (e.U * e.pi * e.Omega + e.levelled)),
        "U sk(e3) kept": e.gyroscopic - right * (e.U * sk(e.e3) * e.Omega + e.levelled),
        "factor kept": e.gyroscopic - right * e.U * e.pi * e.Omega - e.levelled,
    }
    for fault, formula in torque.items():
        assert not proof_of(Equation(e.Gamma, formula), e.LOOP_NO_YAW), fault


def test_the_counterexample_to_the_theorem_is_one_for_the_checker_too():
    gains = dict(zip(("k1", "k2", "k3", "k4"), theorem.GAINS, strict=True))
    Q = [[theorem.BETWEEN if i == j else Fraction(0) for j in range(3)] for i in range(3)]
    weight = theorem.MASS * theorem.GRAVITY
    stiffness = gains["k1"] ** 2 * gains["k2"] / theorem.MASS
    own = SimpleNamespace(k=theorem.GAINS, m=theorem.MASS, stiffness=stiffness)
    f = checker.Claim.factor(own, weight, theorem.GOAL[2])
    sigma = checker_kit.sigma(gains, [Fraction(1)] * 4, Q, f, theorem.GOAL)
    x = theorem.STATE
    value = sum(x[i] * sigma[i][j] * x[j] for i in range(11) for j in range(11))
    assert value < 0
    a, b, c, d = map(float, theorem.GAINS)
    low, high, q3 = float(theorem.LOW), float(theorem.HIGH), 1.0
    stiffness = a * a * b / float(theorem.MASS)
    f_min = a * b * (a * b + c) / (float(theorem.MASS) * stiffness * q3)
    assert b > high
    assert a < np.sqrt(2 * float(weight) * q3 / b)
    assert c > (b + high) * (high + f_min * q3) ** 2 / (low * (b - high))
    assert d > 0
    energy = sum(float(v) ** 2 for v in x) / 2
    assert energy < 0.5 * (float(weight) / (a * a * b) - 2 * q3) ** 2


# --- independent witnesses ----------------------------------------------------------------------

PROVED = [c for c in equations.EQUATIONS if isinstance(c.printed, Equation)]


def right_form(claim):
    """Return the printed equation, or the corrected one."""
    derived = claim.judge(claim).derived
    assert isinstance(derived, Equation)
    return derived


@pytest.mark.slow
@pytest.mark.parametrize("claim", PROVED, ids=lambda c: c.id)
def test_the_same_identities_hold_in_floating_point(claim):
    world, _ = claim.where()
    equation = right_form(claim)
    left, right = equation.left.value(world), equation.right.value(world)
    inputs = ca.symvar(ca.vertcat(ca.vec(left), ca.vec(right)))
    f = ca.Function("f", inputs, [left, right])
    rng = np.random.default_rng(11)
    for _ in range(20):
        a, b = (np.array(y) for y in f(*rng.uniform(0.5, 2, len(inputs))))
        assert np.abs(a - b).max() <= 1e-10 * max(1.0, np.abs(a).max())


def test_the_error_rates_are_the_finite_differences_of_a_flight():
    mission = load(
        "x4-flyer", {"gains.k1": "2", "gains.k4": "30", "start.rotation": "[0.1, -0.2, 0.3]"}
    )
    step = 1e-3
    flight = simulate(mission, duration=2, step=step, every=1)
    numbers = LoopNumbers.of(mission)
    world = closed_loop_no_yaw()
    rates = {c.id: right_form(c).right for c in PROVED if c.id in ("22", "23", "26", "27", "34")}
    law_symbols = ca.symvar(ca.vertcat(*(ca.vec(r.value(world)) for r in rates.values())))
    names = [s.name() for s in law_symbols]
    f = ca.Function("f", law_symbols, [r.value(world) for r in rates.values()])
    design = dict(zip(_design_names(), numbers.design, strict=True))
    records = {"22": "delta1", "23": "delta2", "26": "delta3", "27": "delta4", "34": "lyapunov"}
    for k in range(100, 1900, 300):
        now = flight.isel(time=k)
        R = now["rotation"].values
        seen = R.T @ (numbers.points - now["position"].values[:, None])
        Q = np.array(ca.DM(depth_matrix(ca.SX(seen))))
        state = {
            **{f"centroid_{i}": now["centroid"].values[i] for i in range(3)},
            **{f"velocity_{i}": now["velocity"].values[i] for i in range(3)},
            **{f"gravity_direction_{i}": R[2, i] for i in range(3)},
            **{f"rate_{i}": now["body_rate"].values[i] for i in range(3)},
            **{
                f"Q_{n}": Q[i, j]
                for n, (i, j) in enumerate([(0, 0), (1, 0), (2, 0), (1, 1), (2, 1), (2, 2)])
            },
            "thrust": float(now["thrust"]),
            **design,
        }
        values = f(*(state[name] for name in names))
        for (id, _), value in zip(rates.items(), values, strict=True):
            record = flight[records[id]].values
            near, far = record[k + 1] - record[k - 1], record[k + 2] - record[k - 2]
            measured = np.atleast_1d(8 * near - far) / (12 * step)  # error of order step⁴
            derived = np.array(value).ravel()[: len(measured)]
            assert np.abs(measured - derived).max() < 1e-5 * max(1, np.abs(derived).max()), id


def _design_names():
    return [
        *(
            "mass",
            "gravity",
            "inertia_0",
            "inertia_1",
            "inertia_2",
            "k1",
            "k2",
            "k3",
            "k4",
            "k_yaw",
        ),
        *("goal_centroid_0", "goal_centroid_1", "goal_centroid_2"),
    ]


# --- mutants ------------------------------------------------------------------------------------

SIBLINGS = {
    "k1": "k2",
    "k2": "k1",
    "k3": "k4",
    "k4": "k3",
    "δ1": "δ2",
    "δ2": "δ3",
    "δ3": "δ1",
    "T": "m",
}
BY_NAME = {s.name: s for s in vars(symbols).values() if isinstance(s, Symbol)}


def mutants(formula):
    """Yield formulas that differ in one place: sign, term, factor, order, symbol or power."""
    if isinstance(formula, Sum):
        signed = formula.signed
        for i, (sign, term) in enumerate(signed):
            yield Sum((*signed[:i], (-sign, term), *signed[i + 1 :]))
            if len(signed) > 1:
                yield Sum((*signed[:i], *signed[i + 1 :]))
            for other in mutants(term):
                yield Sum((*signed[:i], (sign, other), *signed[i + 1 :]))
    elif isinstance(formula, Product):
        parts = formula.parts
        for i, part in enumerate(parts):
            if len(parts) > 1:
                yield Product((*parts[:i], *parts[i + 1 :]))
            if i + 1 < len(parts):
                yield Product((*parts[:i], parts[i + 1], part, *parts[i + 2 :]))
            for other in mutants(part):
                yield Product((*parts[:i], other, *parts[i + 1 :]))
    elif isinstance(formula, Quotient):
        yield Quotient(formula.below, formula.above)
        for other in mutants(formula.above):
            yield Quotient(other, formula.below)
        for other in mutants(formula.below):
            yield Quotient(formula.above, other)
    elif isinstance(formula, Power):
        yield Power(formula.base, formula.exponent + 1)
    elif isinstance(formula, Transpose):
        yield formula.of
    elif isinstance(formula, Skew | SquaredNorm):
        for other in mutants(formula.of):
            yield replace(formula, of=other)
    elif isinstance(formula, Symbol) and formula.name in SIBLINGS:
        yield BY_NAME[SIBLINGS[formula.name]]


MUTATED = ("11", "22", "23", "24", "26", "27", "30", "31", "34", "35", "L̇ with A", "π sk π")


def rejected_mutants(claim, whole):
    """Return how many distinct mutants of a claim's right side the prover rejects: all tried."""
    world, roots = claim.where()
    equation = right_form(claim)
    left, right = equation.left.value(world), equation.right.value(world)
    inputs = ca.symvar(ca.vertcat(*(ca.vec(x) for x in world.values())))
    values = np.random.default_rng(5).uniform(0.5, 2, len(inputs))

    def numbers(expression):
        return np.array(ca.Function("f", inputs, [expression])(*values))

    expected, seen, rejected = numbers(left), set(), 0
    for mutant in share_of(mutants(equation.right), whole, every=3):
        if mutant.text() in seen:
            continue
        seen.add(mutant.text())
        try:
            value = mutant.value(world)
        except RuntimeError:  # the shapes do not fit: no formula at all
            continue
        if value.shape != left.shape or not np.isfinite(numbers(value)).all():
            continue
        if np.abs(numbers(value) - expected).max() < 1e-9 * np.abs(expected).max():
            assert prove_equal(value, right, roots), f"undecided mutant: {mutant.text()}"
            continue  # the same formula in other words, as when scalars are swapped
        assert not prove_equal(left, value, roots), mutant.text()
        rejected += 1
    return rejected


@pytest.mark.slow
def test_the_prover_rejects_every_mutant(record_property, whole):
    """One of three, and with `make trials` all."""
    counts = {c.id: rejected_mutants(c, whole) for c in PROVED if c.id in MUTATED}
    print(f"{sum(counts.values())} mutants rejected: {counts}")
    record_property("mutants", sum(counts.values()))
    assert sum(counts.values()) >= (200 if whole else 60)
    assert min(counts.values()) >= (3 if whole else 1)


def test_a_controller_with_one_wrong_sign_breaks_the_derivative_of_L():
    """Mutants of the control law itself, not of its closed form: eq. 34 must not survive them."""
    world = closed_loop_no_yaw()
    claim = next(c for c in PROVED if c.id == "34")
    assert prove_equal(claim.printed.left.value(world), claim.printed.right.value(world))
    for i, spoiled in enumerate(("k1", "k2", "k3", "k4")):
        changed = {
            **world,
            "L̇": ca.substitute(world["L̇"], world[spoiled], world[spoiled] * (i + 2)),
        }
        assert not prove_equal(
            claim.printed.left.value(changed), claim.printed.right.value(changed)
        )


# --- notation, units and the command ------------------------------------------------------------


def test_a_formula_prints_as_in_the_paper():
    formula = -sk(d1) * d1 - k1 / m * d1 + (k3 + k4) / m * d1
    assert formula.text() == "-sk(δ1) δ1 - (k1/m) δ1 + ((k3 + k4)/m) δ1"
    assert formula.latex().startswith(r"-\mathrm{sk}\left(\delta_1\right) \delta_1 - \frac{k_1}{m}")


def test_units_are_judged():
    assert Equation(d1_rate, k1 / m * d1).unit_fault().startswith("the left side is in s^-1")
    assert "is in kg" in Equation(m, m + k1).unit_fault()
    with pytest.raises(UnitError):
        (m + k1).unit()
    assert Equation(d1_rate, number(0)).unit_fault() == ""
    assert Number(Fraction(1, 2)).text() == "½"


def test_a_claim_with_no_true_form_is_unproved():
    wrong = identity("x", "x", Equation(d1_rate, k3 / m * d1), equations.FREE)
    judgement = wrong.judge(wrong)
    assert judgement.verdict is Verdict.UNPROVED
    assert judgement.counterexample
    assert not all_proved([judgement])
    wrong = identity(
        "x",
        "x",
        Equation(d1_rate, k3 / m * d1),
        equations.FREE,
        corrected=Equation(d1_rate, k4 / m * d1),
    )
    assert wrong.judge(wrong).verdict is Verdict.UNPROVED


def test_an_unknown_equation_is_refused():
    with pytest.raises(InputError, match="no claim '99'"):
        derive(["99"])


@pytest.mark.slow
@pytest.mark.parametrize("format_", ["text", "markdown", "latex", "json"])
def test_the_command_prints_each_format(format_, capsys):
    with pytest.raises(SystemExit) as exit_:
        cli.main(["derive", "--format", format_])
    out = capsys.readouterr().out
    assert exit_.value.code == 0
    if format_ == "json":
        rows = json.loads(out)["claims"]
        assert len(rows) == len(ORDER)
        assert {"id", "title", "verdict", "reason", "printed", "derived"} <= set(rows[0])
    elif format_ == "latex":
        assert out.count(r"\[") == out.count(r"\]")
    else:
        assert "torque control Γ" in out
    if format_ == "text":
        assert max(map(len, out.splitlines())) <= 100


def test_the_command_shows_one_equation_in_full(capsys):
    with pytest.raises(SystemExit) as exit_:
        cli.main(["derive", "--equation", "31"])
    out = capsys.readouterr().out
    assert exit_.value.code == 0
    for part in ("printed", "derived", "holds with correction", "𝐈⁻¹"):
        assert part in out
    assert "difference" not in out  # it would be both forms again
    assert "derived\n  the same" in run(capsys, "derive", "--equation", "11")[1]
    assert "difference\n  printed + " in run(capsys, "derive", "--equation", "6")[1]
    with pytest.raises(SystemExit) as exit_:
        cli.main(["derive", "--equation", "99"])
    assert exit_.value.code == 2


def test_the_command_fails_if_a_proof_fails(monkeypatch, capsys):
    wrong = identity("1", "x", Equation(d1_rate, k3 / m * d1), equations.FREE)
    monkeypatch.setattr("hoverproof.paper.ledger.ledger", lambda: [wrong])
    status, out, _ = run(capsys, "derive")
    assert status == 1
    assert "UNPROVED" in out


def test_no_formula_has_two_superscripts_in_a_row_which_latex_refuses():
    for judgement in derive():
        for shown in (judgement.printed, judgement.derived):
            assert not re.search(r"\^(\S|\{[^{}]*\})\^", shown.latex()), judgement.id


@pytest.mark.slow
def test_what_is_kept_of_the_judgement_is_what_is_judged(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    judged = derive()
    for _ in range(2):  # judged, then found in the file
        ledger_module._judged.cache_clear()
        kept = derive_once()
        assert as_rows(kept) == as_rows(judged)
        for one, other in zip(kept, judged, strict=True):
            assert one.printed.latex() == other.printed.latex()
            assert one.derived.latex() == other.derived.latex()
            assert (one.derived is one.printed) == (other.derived is other.printed)


@pytest.mark.parametrize(("form", "down"), [("printed", -1), ("derived", 1)])
def test_the_torques_as_printed_fit_axes_whose_z_is_up(form, down):
    """With -T e3 at (x, y, 0) the torque is (-y T, x T, 0): that tells where each name is."""
    roll, pitch = (getattr(j, form).right for j in derive(["37", "38"]))
    names = ("Trr", "Tfr", "Trl", "Tfl")

    def place(name):
        world = {other: ca.SX(float(other == name)) for other in names} | {"d": ca.SX(1)}
        x, y = (float(ca.evalf(side.value(world))) for side in (pitch, -roll))
        return np.array([x, y, 0])

    right, front = place("Trr") + place("Tfr"), place("Tfr") + place("Tfl")
    assert np.cross(front, right).tolist() == [0, 0, 4 * down]


def test_a_printed_form_fails_where_the_direction_of_gravity_is_a_unit_vector():
    (found,) = derive("31")
    point = found.counterexample
    assert sum(Fraction(point[f"gravity_direction_{i}"]) ** 2 for i in range(3)) == 1
    told = claim_text(found).split("printed form fails at")[1]
    names = re.findall(r"(\w+)=", told)
    assert names == sorted(point)
