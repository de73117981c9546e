"""Vehicles within tolerances whose rotors lag: rates, forms, and mutants of them."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import pytest

from hoverproof.algebra.identity import prove_equal
from hoverproof.certification.exponential import energy_identities
from hoverproof.certification.exponential.form import ROWS, derive_form
from hoverproof.certification.exponential.identities import GOALS
from hoverproof.servo.lagged import (
    Rotors,
    Setting,
    derive_lagged_loop,
    lagged_rates,
    own_gyroscopic,
    smooth_command,
)
from hoverproof.servo.laws.hamel_mahony import LAWS
from hoverproof.servo.variables import Design, Errors
from sampling import share_of
from test_uncertain import MEASURED, MODELLED, graph_mutants, rejected, swapped


@pytest.mark.parametrize("law", LAWS.values(), ids=lambda law: law.name)
def test_the_rates_of_errors_and_rotors(law):
    loop = derive_lagged_loop(law)
    assert prove_equal(loop.rate, loop.closed_form())


def named_mutants(loop):
    """Yield the closed form with one thing in it wrong that a hand would get wrong."""
    parts = {"at": loop.setting, "rotors": loop.rotors}

    def say(name, **changed):
        e, d = changed.pop("e", loop.errors), changed.pop("design", loop.design)
        return name, lagged_rates(e, *{**parts, **changed}.values(), d)

    for which, part in parts.items():
        for name in type(part).sizes():
            own = getattr(part, name)
            for how, other in {"dropped": 0 * own, "negated": -own, "doubled": 2 * own}.items():
                yield say(f"{name} {how}", **{which: replace(part, **{name: other})})
    for name in ("angular_gain", "gyroscopic"):
        turned = ca.vec(ca.reshape(getattr(loop.rotors, name), 2, 2).T)
        yield say(f"{name} transposed", rotors=replace(loop.rotors, **{name: turned}))
    yield say("γ and G_t swapped", rotors=swapped(loop.rotors, "angular_gain", "gyroscopic"))
    yield say("h inverted", at=replace(loop.setting, quickness=1 / loop.setting.quickness))
    yield say("inertia reversed", design=replace(loop.design, inertia=loop.design.inertia[::-1]))
    for one, two in (("k1", "k2"), ("k2", "k3"), ("k3", "k4"), ("mass", "k1")):
        d = loop.design
        yield say(f"{one} for {two}", design=replace(d, **{one: getattr(d, two)}))
    yield "the lever held still", without(loop, "drift")
    yield "the rate of δ4 left out of the smooth command", without(loop, "d4")


def without(loop, what):
    """Return the closed form with a term of τ μ' left out."""
    e, at, rotors, d = loop.errors, loop.setting, loop.rotors, loop.design
    right = loop.closed_form()
    k = (d.k1 * d.k2 + d.k3) / d.mass
    missing = (k + d.k4 / d.mass) * right[9:11]
    if what == "drift":
        follows = k * e.d3[2] + rotors.thrust
        applied = smooth_command(e, d) + rotors.torque
        missing = (rotors.thrust_gain * at.quickness / k * follows + at.crosswind) * applied
    return right - ca.vertcat(ca.SX.zeros(11), rotors.lag * missing, 0)


@pytest.mark.slow
def test_the_prover_rejects_every_named_mutant_of_the_lagged_rates(whole):
    """All of one law, a third of two others, and with `make trials` all."""
    for every, law in zip((1, 3, 3), (*MEASURED.values(), MODELLED), strict=True):
        loop = derive_lagged_loop(law)
        mutants = share_of(named_mutants(loop), whole, every=every)
        assert rejected(loop.rate, mutants) >= (30 if whole else 30 // every), law.name


@pytest.mark.slow
def test_the_prover_rejects_every_wrong_operation_in_the_lagged_rates(record_property, whole):
    """One of five, and with `make trials` all."""
    loop = derive_lagged_loop(MEASURED["image"])
    parts = [layout.symbols() for layout in (Errors, Setting, Rotors, Design)]
    own = ca.vertcat(*(part.vector() for part in parts))
    values = [part.vector() for part in (loop.errors, loop.setting, loop.rotors, loop.design)]
    mutants = graph_mutants(own, lagged_rates(*parts), ca.vertcat(*values))
    count = rejected(loop.rate, share_of(mutants, whole, every=10))
    record_property("mutants", count)
    assert count >= (200 if whole else 20)


def spoiled(block, factor):
    """Return `derive_form` with one block of its matrices times a factor."""

    def derive(law, lagged):
        inputs = [ca.SX.sym(f"x{i}", derive_form(law, lagged).size1_in(i)) for i in range(3)]
        m = energy_identities.matrices(derive_form(law, lagged)(*inputs))
        m[block] = factor * m[block]
        return ca.Function("falls", inputs, [ca.vertcat(*m.values())])

    return derive


@pytest.mark.slow
@pytest.mark.parametrize("goal", ["image", "inertial"])
@pytest.mark.parametrize(("lagged", "unused"), [(True, {"ahead"}), (False, {"torque", "lift"})])
def test_the_form_of_the_search_is_told_from_a_spoiled_one(
    monkeypatch, goal, lagged, unused, whole
):
    """Of `energy`, `pull`, `sum` nothing is in E'; those in `unused` belong to the other rotors.

    Each block is negated, and with `make trials` doubled as well.
    """
    law = GOALS[goal]
    unused |= {"energy", "pull", "sum"} | (set() if lagged else {"h3", "pulled"})
    for block in ROWS:
        for factor in (-1, 2) if whole else (-1,):
            monkeypatch.setattr(energy_identities, "derive_form", spoiled(block, factor))
            assert energy_identities.falls(law, lagged) == (block in unused), (block, factor)


def test_the_gyroscopic_torque_is_what_the_controller_makes_up_for():
    """|G_c| <= max(|I3 - I2|/I1, |I3 - I1|/I2): it is a turn by 90° with two scales."""
    own = own_gyroscopic(Design.symbols())
    square = own.T @ own
    assert prove_equal(square[0, 1], ca.SX(0))
    assert prove_equal(ca.vertcat(own[0, 0], own[1, 1]), ca.SX.zeros(2))
