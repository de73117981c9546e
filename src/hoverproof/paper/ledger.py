"""The ledger: every claim of the paper in its order, judged."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from hoverproof.algebra.derived import kept_json
from hoverproof.errors import InputError
from hoverproof.mission.arguments import checked
from hoverproof.paper.claims import CLAIMS
from hoverproof.paper.equations import EQUATIONS
from hoverproof.paper.judge import Claim, Judgement, Verdict, Words
from hoverproof.paper.rotors import ROTORS
from hoverproof.paper.theorem import THEOREM

ORDER = (
    *("1", "2", "3", "4", "5", "point", "point motion", "6", "7", "8", "9", "Q > 0", "10", "11"),
    *("|δ1|²", "skew", "J", "no depth", "12", "13", "14", "15", "16", "17", "18", "19", "20"),
    *("21", "22", "23", "24", "25", "26", "27", "28", "29", "30", "31", "32", "f(T)", "k1"),
    *("conditions", "33", "theorem", "Ω̇", "π sk π", "π δ4", "34", "35", "L̇ with A", "A", "Σ"),
    *("minors", "‖AAᵀ‖^½", "T by errors", "T by L", "T0", "36", "37", "38", "39", "start"),
    *("units of gains", "gains"),
)
"""The identifiers of all claims, in the order of the paper."""


def ledger() -> list[Claim]:
    """Return every claim of the paper, in its order."""
    claims = {claim.id: claim for claim in [*EQUATIONS, *CLAIMS, *THEOREM, *ROTORS]}
    return [claims[id] for id in ORDER]


@checked
def derive(ids: str | Iterable[str] | None = None) -> list[Judgement]:
    """Judge the claims of the paper; each verdict is computed when this is called.

    Parameters
    ----------
    ids : str or iterable of str, optional
        Equation numbers or names of claims, or one of them; by default all.

    Returns
    -------
    list of Judgement

    Raises
    ------
    InputError
        If there is no such claim.
    """
    claims = ledger()
    if ids is not None:
        known = {claim.id: claim for claim in claims}
        wanted = [ids] if isinstance(ids, str) else list(ids)
        for id in wanted:
            if id not in known:
                raise InputError(
                    "--equation", "", f"no claim {id!r}; there are: {', '.join(ORDER)}"
                )
        claims = [known[id] for id in wanted]
    return [claim.judge(claim) for claim in claims]


def derive_once() -> list[Judgement]:
    """Judge all claims of the paper, or find them judged by the same sources.

    Returns
    -------
    list of Judgement
        As `derive` returns it, but with formulas in words and LaTeX alone.
    """
    judged = []
    for id, title, verdict, reason, printed, derived, difference, example in _judged():
        shown = Words(*printed)
        other = shown if derived is None else Words(*derived)
        more = (shown, other, difference, example)
        judged.append(Judgement(id, title, Verdict(verdict), reason, *more))
    return judged


@kept_json
def _judged() -> list[Any]:
    return [
        (
            *(j.id, j.title, str(j.verdict), j.reason, (j.printed.text(), j.printed.latex())),
            None if j.derived is j.printed else (j.derived.text(), j.derived.latex()),
            *(j.difference, j.counterexample),
        )
        for j in derive()
    ]


def all_proved(judgements: Sequence[Judgement]) -> bool:
    """Tell whether no claim was left without a proof or a refutation.

    Parameters
    ----------
    judgements : sequence of Judgement
        From `derive`.
    """
    return all(j.verdict is not Verdict.UNPROVED for j in judgements)


def as_rows(judgements: Sequence[Judgement]) -> list[dict[str, object]]:
    """Return the judgements as objects for machines.

    Parameters
    ----------
    judgements : sequence of Judgement
        From `derive`.
    """
    return [
        {
            "id": j.id,
            "title": j.title,
            "verdict": str(j.verdict),
            "reason": j.reason,
            "printed": j.printed.text(),
            "derived": j.derived.text(),
            "difference": j.difference,
            "counterexample": j.counterexample,
        }
        for j in judgements
    ]
