"""The proof assistant's library builds, replays certificates of gains, and rejects forged ones."""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import pytest

from firmware_kit import tool

PROOFS = Path(__file__).parents[1] / "proofs"
pytestmark = [pytest.mark.slow]


@pytest.fixture(scope="module")
def literals():
    spec = importlib.util.spec_from_file_location("literals", PROOFS / "coq" / "literals.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """A copy of the library, built, and what its build says of the certificates shipped."""
    tool("coqc")
    folder = tmp_path_factory.mktemp("proofs") / "coq"
    shutil.copytree(PROOFS / "coq", folder, ignore=shutil.ignore_patterns("*.vo*", "*.glob"))
    for path in PROOFS.glob("*.cert.json"):
        shutil.copy(path, folder.parent)
    made = subprocess.run(["make", "-C", folder], capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stdout + made.stderr
    return folder, made.stdout


def decided(folder, certificates):
    """Return what Coq decides of certificates given as terms, and of their targets."""
    lines = ["From Hoverproof Require Import Forms Gains Target.", "Require Import QArith List."]
    lines += ["Import ListNotations."]
    for term, target in certificates:
        lines.append(
            f"Eval vm_compute in (let c := {term} in (certificate_ok c, target_ok ({target}) c))."
        )
    (folder / "Trial.v").write_text("\n".join(lines), encoding="utf-8")
    command = ["coqc", "-q", "-Q", ".", "Hoverproof", "Trial.v"]
    out = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout
    return [(a == "true", b == "true") for a, b in re.findall(r"= \((\w+), (\w+)\)", out)]


def test_it_replays_every_certificate_of_gains_that_is_shipped(library):
    _, said = library
    names = {path.name for path in PROOFS.glob("*.cert.json")}
    gains = [
        name for name in names if '"kind":"gains"' in (PROOFS / name).read_text().replace(" ", "")
    ]
    assert f"Replayed: {len(gains)} certificates of gains" in said
    assert len(gains) >= 8


def test_nothing_is_admitted_and_the_axioms_are_those_of_the_real_numbers(library):
    _, said = library
    listed = said.split("real numbers:")[1].split()
    assert set(listed[:4]) == set((PROOFS / "coq" / "allowed.txt").read_text().split())


WORSE = {
    "mass": ("3/2",),
    "k": ("3/2", "3/2", "1/2", "1/2"),
    "weights": ("2", "2", "2", "2"),
    "low": ("1/2",),
    "high": ("11/10",),
    "thrust": ("9/10", "11/10"),
    "box": ("1001/1000", "1001/1000", "1001/1000"),
    "factor": ("101/100", "99/100"),
    "margin": ("1001/1000",),
    "multipliers": ("3", "3"),
}
"""By what each number of a certificate is multiplied so that it claims more than is shown."""


def forged(literals, name):
    """Yield a certificate as it is, and with one number changed and the hints as they were."""
    held = literals.Gains(PROOFS / name)
    hints = dict(zip(held.factor, map(held.hint, held.factor, held.multipliers), strict=True))
    yield "as it is", held.literal()
    for key, factors in WORSE.items():
        for i, factor in enumerate(map(Fraction, factors)):
            other, value = literals.Gains(PROOFS / name), getattr(held, key)
            if not isinstance(value, list):
                changed = factor * value
            else:
                part = [factor * x for x in value[i]] if key == "box" else factor * value[i]
                changed = [*value[:i], part, *value[i + 1 :]]
            if changed == value:  # of zero
                continue
            setattr(other, key, changed)
            kept = iter(hints.values())
            other.hint = lambda *_, kept=kept: next(kept)
            yield f"{key} {i}", other.literal()


def test_a_certificate_with_a_number_for_the_worse_is_rejected(library, literals, whole):
    """Of one certificate, and with `make trials` of all."""
    folder, _ = library
    names = ["x4-flyer.cert.json"]
    if whole:
        names = [
            p.name for p in PROOFS.glob("*.cert.json") if not re.search("attraction|region", p.name)
        ]
    for name in names:
        trials = list(forged(literals, name))
        target = literals.Gains(PROOFS / name).target()
        answers = decided(folder, [(term, target) for _, term in trials])
        accepted = [what for (what, _), both in zip(trials, answers, strict=True) if all(both)]
        assert accepted == ["as it is"], name
