"""Verdicts of all theorems are read in one way; a new theorem adds what it claims and no more."""

from dataclasses import dataclass
from fractions import Fraction

import pytest

from hoverproof.certification.attraction.proof import attraction
from hoverproof.certification.gains import certify
from hoverproof.certification.over_box import certify_region
from hoverproof.certification.region import default_box
from hoverproof.certification.verdict import Proved, Refuted, Undecided
from hoverproof.mission.reading import load

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
    assert {status for status, _ in seen} == {"proved", "refuted", "undecided"}


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
