"""Verdicts of all theorems are read in one way; a new theorem adds what it claims and no more."""

from dataclasses import dataclass
from fractions import Fraction

import pytest

from hoverproof.algebra.decimals import at_least
from hoverproof.certification.attraction.proof import attraction
from hoverproof.certification.gains import certify
from hoverproof.certification.over_box import certify_region
from hoverproof.certification.region import default_box
from hoverproof.certification.verdict import Proved, Refuted, Undecided
from hoverproof.design.outcome import Infeasible
from hoverproof.design.tuning import tune
from hoverproof.mission.reading import load
from hoverproof.servo.variables import Design

WEAK = {"gains.k4": "0.1"}
WIDE = tuple((Fraction(a), Fraction(b)) for a, b in ((-1, 6), (-1, 4), (-5, -2)))
FAR = {"start.position": "[0.9, 0.9, -0.05]"}


@dataclass(frozen=True, kw_only=True)
class Sum(Proved):
    """A theorem of tomorrow."""

    total: Fraction


def verdicts():
    """Return what each command comes to, for a mission and for a worse one."""
    x4 = load("x4-flyer")
    yield certify(x4)
    yield certify(load("x4-flyer", WEAK))
    yield certify_region(x4, default_box(x4))
    yield certify_region(x4, default_box(x4), 1)
    yield certify_region(x4, WIDE)
    yield attraction(load("x4-flyer", FAR))


@pytest.mark.slow
def test_every_verdict_is_read_without_looking_at_the_kind():
    seen = set()
    for verdict in verdicts():
        kind = {"proved": Proved, "refuted": Refuted, "undecided": Undecided}[verdict.status]
        assert isinstance(verdict, kind)
        seen.add((verdict.status, type(verdict)))
        assert verdict.proved is (verdict if verdict.status == "proved" else None)
        assert verdict.refuted is (verdict if verdict.status == "refuted" else None)
        assert verdict.mission.name == "x4-flyer"
        assert (verdict.statement is None) == (verdict.status == "undecided")
        assert verdict.statement is None or verdict.statement == verdict.certificate.statement
        assert (verdict.reason is None) <= (verdict.status != "undecided")
        assert verdict.ending == ("refutation" if verdict.refuted else "cert")
        shown = repr(verdict)
        assert shown.startswith(f"<{type(verdict).__name__}, x4-flyer: {verdict.status}: ")
        assert len(shown) < 260
        assert "Fraction" not in shown
    assert {status for status, _ in seen} == {"proved", "refuted", "undecided"}


def test_the_point_of_a_reason_is_not_cut_off():
    point = f"the sides are {'very ' * 30}long"
    shown = repr(Undecided(mission=load("x4-flyer"), reason=f"{point}; and so on"))
    assert shown == f"<Undecided, x4-flyer: undecided: {point}>"


def test_gains_that_were_tuned_show_themselves_in_a_line_with_what_is_proved():
    found = tune("x4-flyer", objective="decay")
    rate = at_least(found.verdict.decay_rate, 6)
    gains = ", ".join(
        f"{k} = {float(getattr(found.mission.gains, k)):g} {u}" for k, u in Design.gains().items()
    )
    assert f"x4-flyer: tuned: {gains}; " in repr(found)
    assert f"decay rate of L {rate} 1/s>" in repr(found)
    assert "Fraction" not in repr(found)
    shown = repr(Infeasible(found.mission, "no way"))
    assert shown == "<Infeasible, x4-flyer: infeasible: no way>"


def test_a_mission_and_a_certificate_show_themselves_in_a_line():
    x4 = load("x4-flyer")
    shown = "<Mission x4-flyer: 9.6 kg, law centroid/image/modelled, 4 points, 3 m above them>"
    assert repr(x4) == str(x4) == shown
    seen = load("x4-flyer", {"goal": "{centroid = [0.1, 0, 3]}"})
    assert repr(seen).endswith("4 points, centroid (0.1, 0.0, 3.0)>")
    certificate = certify(x4).certificate
    assert repr(certificate).startswith("<Certificate, x4-flyer: gains, SHA-256 ")
    assert certificate.content["sha256"].startswith(repr(certificate)[-14:-2])


def test_bounds_are_asked_about_around_start_and_goal_by_default():
    x4 = load("x4-flyer")
    assert certify_region(x4) == certify_region(x4, default_box(x4))


def test_a_claim_is_added_by_its_dataclass_alone():
    found = certify(load("x4-flyer"))
    verdict = Sum(mission=found.mission, certificate=found.certificate, total=Fraction(1, 3))
    assert (verdict.status, verdict.proved.total) == ("proved", Fraction(1, 3))
    assert verdict.statement == found.certificate.statement
    with pytest.raises(TypeError):
        Sum(mission=found.mission, total=Fraction(1, 3))  # no proof without a certificate


def test_a_reason_is_completed_and_the_rest_is_kept():
    first = Undecided(mission=None, reason="too far", advice=("nearer",))
    assert first.because("too low") == Undecided(
        mission=None, reason="too far; too low", advice=("nearer",)
    )
