"""Judge what is printed: each verdict is the outcome of a computation."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from typing import Any

import casadi as ca

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.identity import Identity as Proof
from hoverproof.algebra.identity import prove_equal
from hoverproof.paper.notation import World
from hoverproof.paper.printed import Equation


class Verdict(StrEnum):
    """What a claim of the paper turned out to be."""

    HOLDS = "holds"
    CORRECTED = "holds with correction"
    FALSE = "false"
    DEFINITION = "definition"
    CONVENTION = "convention"
    UNPROVED = "unproved"


Setting = Callable[[], tuple[World, Mapping[ca.SX, ca.SX]]]


@dataclass(frozen=True)
class Words:
    """A claim that is no equation, in words and LaTeX.

    Attributes
    ----------
    plain : str
        As text.
    tex : str
        As LaTeX.
    """

    plain: str
    tex: str

    def text(self) -> str:
        """Return the claim as plain text."""
        return self.plain

    def latex(self) -> str:
        """Return the claim as LaTeX."""
        return self.tex


Shown = Equation | Words


@dataclass(frozen=True)
class Judgement:
    """A claim with its verdict.

    Attributes
    ----------
    id, title : str
        Number of the equation, or a short name; what it is about.
    verdict : Verdict
    reason : str
        One line.
    printed : Equation or Words
        As the paper has it.
    derived : Equation or Words
        What follows from eqs. 1-5 and 7; the printed form if that holds.
    difference : str
        Terms that only the printed form has, and those that only the derived one has.
    counterexample : dict of str to str, or None
        An exact rational point at which the printed form fails.
    """

    id: str
    title: str
    verdict: Verdict
    reason: str
    printed: Shown
    derived: Shown
    difference: str = ""
    counterexample: dict[str, str] | None = None


@dataclass(frozen=True)
class Claim:
    """A printed claim and how it is judged.

    Attributes
    ----------
    id, title : str
    printed : Equation or Words
        As printed; where the print is ambiguous, in the reading that is kindest to the authors.
    judge : callable
        Takes the claim, returns its judgement.
    where : Setting, optional
        Of an equation: the values of its symbols, that is what is assumed of the motion.
    """

    id: str
    title: str
    printed: Shown
    judge: Callable[[Claim], Judgement]
    where: Setting | None = None

    def judged(
        self, verdict: Verdict, reason: str, derived: Shown | None = None, **more: Any
    ) -> Judgement:
        """Return the judgement of this claim.

        Parameters
        ----------
        verdict : Verdict
        reason : str
            One line.
        derived : Equation or Words, optional
            By default the printed form.
        more : object
            Further fields of `Judgement`.
        """
        shown = self.printed if derived is None else derived
        return Judgement(self.id, self.title, verdict, reason, self.printed, shown, **more)


def setting(world: Callable[[], World]) -> Setting:
    """Return a setting without square roots.

    Parameters
    ----------
    world : callable
        Makes the world.
    """
    return lambda: (world(), {})


def proof_of(equation: Equation, where: Setting) -> Proof:
    """Prove an equation in a setting, or refute it.

    Parameters
    ----------
    equation : Equation
    where : Setting
    """
    world, roots = where()
    return prove_equal(equation.left.value(world), equation.right.value(world), roots)


def identity(
    id: str,
    title: str,
    printed: Equation,
    where: Setting,
    *,
    corrected: Equation | None = None,
    note: str = "",
    how: str = "",
) -> Claim:
    """Claim an equation that is to follow from the model.

    It holds if it is proved as printed and its units agree; it holds with correction if the
    corrected form is proved instead.

    Parameters
    ----------
    id, title, printed
        See `Claim`.
    where : Setting
        The values of the symbols: what is assumed of the motion.
    corrected : Equation, optional
        What is right if the print is not.
    note : str
        What is assumed, or how the print was read.
    how : str
        How the print fails, where that is clearer in words than as a difference of terms.
    """

    def judge(claim: Claim) -> Judgement:
        suffix = f" ({note})" if note else ""
        fault = printed.unit_fault()
        proof = proof_of(printed, where)
        if proof and not fault:
            return claim.judged(Verdict.HOLDS, f"proved, all parameters symbolic{suffix}")
        point = _counterexample(printed, where, proof)
        if corrected is None or corrected.unit_fault() or not proof_of(corrected, where):
            reason = f"units: {fault}" if fault else "no proof of the printed or a corrected form"
            return claim.judged(Verdict.UNPROVED, reason + suffix, counterexample=point)
        extra, missing = printed.difference(corrected)
        return claim.judged(
            Verdict.CORRECTED,
            f"{how or _how_it_fails(printed, corrected, where)}"
            f"{f'; units: {fault}' if fault and not how else ''}{suffix}",
            corrected,
            difference=_differs(extra, missing),
            counterexample=point,
        )

    return Claim(id, title, printed, judge, where)


def definition(id: str, title: str, printed: Equation, where: Setting, *, note: str = "") -> Claim:
    """Claim an equation that defines its left side; the model is proved to use it so.

    Parameters
    ----------
    id, title : str
        See `Judgement`.
    printed : Equation
    where : Setting
    note : str
        What to add to the reason.
    """
    inner = identity(id, title, printed, where)

    def judge(claim: Claim) -> Judgement:
        outcome = inner.judge(inner)
        if outcome.verdict is not Verdict.HOLDS:
            return outcome
        reason = "the model is proved to use it so" + (f" ({note})" if note else "")
        return replace(outcome, verdict=Verdict.DEFINITION, reason=reason)

    return Claim(id, title, printed, judge, where)


def statement(id: str, title: str, printed: Shown, judge: Callable[[Claim], Judgement]) -> Claim:
    """Claim something that has a judge of its own.

    Parameters
    ----------
    id, title : str
        See `Judgement`.
    printed : Equation or Words
    judge : callable
        Returns the judgement of the claim.
    """
    return Claim(id, title, printed, judge)


def exact_point(**values: Fraction | int | str | list[Any]) -> dict[str, str]:
    """Write an exact point so that it can be shown and read by programs.

    Parameters
    ----------
    values : Fraction, int, str or list
        Coordinates by name.
    """
    return {name: _shown(value) for name, value in values.items()}


def _shown(value: Any) -> str:
    return f"({', '.join(map(_shown, value))})" if isinstance(value, list | tuple) else str(value)


DOWN = {f"gravity_direction_{i}": Fraction(share, 7) for i, share in enumerate((2, 3, 6))}
"""A unit vector, by the symbols of the model."""


def witness(left: ca.SX, right: ca.SX) -> dict[str, str] | None:
    """Return a point of small positive integers at which two expressions differ, exactly.

    A direction of gravity is a unit vector there.

    Parameters
    ----------
    left, right : SX
        Of one shape, without roots.
    """
    symbols = ca.symvar(ca.horzcat(ca.vec(left), ca.vec(right)))
    graph = ca.Function("sides", [ca.vertcat(*symbols)], [left, right])
    draw = random.Random(0)
    for _ in range(100):
        drawn = [Fraction(draw.randint(1, 9)) for _ in symbols]
        point = [DOWN.get(s.name(), x) for s, x in zip(symbols, drawn, strict=True)]
        try:
            one, other = evaluate(graph, [point])
        except ZeroDivisionError:
            continue
        if one != other:
            return {s.name(): str(x) for s, x in zip(symbols, point, strict=True)}
    return None


def _counterexample(printed: Equation, where: Setting, proof: Proof) -> dict[str, str] | None:
    world, roots = where()
    if proof.holds:  # then it is only the units that fail
        return None
    if roots:
        found = proof.counterexample
        return None if found is None else {name: str(value) for name, value in found.items()}
    return witness(printed.left.value(world), printed.right.value(world))


def _differs(extra: list[str], missing: list[str]) -> str:
    parts = [
        f"printed {' '.join(extra)}" if extra else "",
        f"derived {' '.join(missing)}" if missing else "",
    ]
    return "; ".join(part for part in parts if part)


def _how_it_fails(printed: Equation, corrected: Equation, where: Setting) -> str:
    """Name the failure: sign, factor, a missing or an extra term, or a wrong term."""
    extra, missing = printed.difference(corrected)
    if extra and [_flipped(t) for t in extra] == missing:
        return f"sign: {' '.join(missing)} is right, not {' '.join(extra)}"
    world, roots = where()
    left, right = printed.right.value(world), corrected.right.value(world)
    for factor in (Fraction(2), Fraction(1, 2), Fraction(-1)):
        scaled = left * factor.numerator / factor.denominator
        if left.shape == right.shape and prove_equal(scaled, right, roots):
            return f"factor: the right side must be {factor} times what is printed"
    if not extra:
        return f"missing term: {' '.join(missing)}"
    if not missing:
        return f"extra term: {' '.join(extra)}"
    return f"wrong term: {' '.join(missing)} is right, not {' '.join(extra)}"


def _flipped(term: str) -> str:
    return ("+" if term[0] == "-" else "-") + term[1:]
