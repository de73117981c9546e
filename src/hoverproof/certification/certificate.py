"""Certificates: what was proved or refuted, in a file that anyone can check."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hoverproof import checker
from hoverproof.algebra.derived import kept_json
from hoverproof.algebra.graph import fingerprint
from hoverproof.certification.problem import ONES, GainProblem, sigma_function
from hoverproof.certification.region import Box, Region
from hoverproof.errors import InputError
from hoverproof.files import write_text
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import Interval, hover_goal


@dataclass(frozen=True)
class Certificate:
    """A certificate or a counterexample, ready to be checked.

    Attributes
    ----------
    content : dict
        What is written to the file.
    """

    content: dict[str, Any]

    @property
    def statement(self) -> str:
        """The theorem in words."""
        return str(self.content["statement"])

    def text(self) -> str:
        """Return what is written to the file."""
        return json.dumps(self.content, indent=2, ensure_ascii=False) + "\n"

    def save(self, path: str | Path) -> None:
        """Write the certificate to a JSON file.

        Parameters
        ----------
        path : str or Path

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        write_text(path, self.text())


def seal(problem: GainProblem, kind: str, parts: dict[str, Any]) -> Certificate:
    """Complete a certificate: add the mission, the statement, versions and hashes.

    Parameters
    ----------
    problem : GainProblem
    kind : str
        One of `checker.KINDS`.
    parts : dict
        What belongs to this kind; Fractions become exact strings.
    """
    held = (problem.box, problem.eigenvalues)
    return _sealed(problem.mission, problem.weights, held, kind, parts)


def seal_region(mission: Mission, region: Region, kind: str, parts: dict[str, Any]) -> Certificate:
    """Complete a certificate about Q alone: gains and thrust play no part in it.

    Parameters
    ----------
    mission : Mission
    region : Region
        What is claimed, or refuted.
    kind : {"region", "outside"}
    parts : dict
        See `seal`.
    """
    return _sealed(mission, ONES, (region.box, region.eigenvalues), kind, parts)


def _sealed(
    mission: Mission,
    weights: tuple[Fraction, ...],
    held: tuple[Box | None, Interval],
    kind: str,
    parts: dict[str, Any],
) -> Certificate:
    box, eigenvalues = held
    own = {"weights": weights, "region": {"box": box, "eigenvalues": eigenvalues}, **parts}
    try:
        return seal_content(mission, kind, own, model_fingerprint())
    except checker.Rejected as rejected:  # numbers that grew too long, for one
        raise InputError(mission.source, "", f"makes no certificate: {rejected}") from None


def seal_content(mission: Mission, kind: str, parts: dict[str, Any], model: str) -> Certificate:
    """Complete a certificate of any kind about a mission.

    Parameters
    ----------
    mission : Mission
    kind, parts
        See `seal`.
    model : str
        SHA-256 of the graph from which the claim was computed.
    """
    numbers = mission.exact()
    by_height = mission.goal.height is not None
    content: dict[str, Any] = {
        "format": "hoverproof certificate",
        "version": 1,
        "kind": kind,
        "statement": "",
        "mission": numbers,
        "mission_sha256": checker.digest(numbers),
        "model_sha256": model,
        "tools": dict(_tools()),
        "goal_position": exact(hover_goal(mission).position) if by_height else None,
        **exact(parts),
    }
    content["statement"] = checker.statement(content)
    content["sha256"] = checker.digest(content)
    return Certificate(content)


def differences(content: Mapping[str, Any], mission: Mission) -> list[str]:
    """Say where the mission of a certificate differs from another one; nothing if it is the same.

    Parameters
    ----------
    content : mapping
        A certificate that the checker accepts.
    mission : Mission
        Of its keys, those that go into certificates.
    """
    if content["mission_sha256"] == checker.digest(mission.exact()):
        return []
    theirs, ours = (dict(_leaves(numbers)) for numbers in (content["mission"], mission.exact()))
    told = [
        f"{key} is {theirs.get(key, 'missing')} in the certificate "
        f"and {ours.get(key, 'missing')} in the mission"
        for key in {**ours, **theirs}
        if theirs.get(key) != ours.get(key)
    ]
    return told or ["its numbers have another SHA-256"]


def _leaves(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Yield the dotted key of each number, its places in lists counted from 1."""
    if isinstance(value, dict):
        for name, entry in value.items():
            yield from _leaves(entry, f"{key}.{name}".removeprefix("."))
    elif isinstance(value, list):
        for place, entry in enumerate(value, 1):
            yield from _leaves(entry, f"{key}[{place}]")
    else:
        yield key, str(value)


@cache
def _tools() -> tuple[tuple[str, str], ...]:
    return tuple((name, version(name)) for name in ("hoverproof", "casadi", "cvxpy", "clarabel"))


@kept_json
def model_fingerprint() -> str:
    """Return the SHA-256 of the graph of Σ from which the verdict was computed."""
    return fingerprint(sigma_function())


def exact(value: Any) -> Any:
    """Turn Fractions, in any nesting, into strings.

    Parameters
    ----------
    value : object
    """
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, dict):
        return {key: exact(entry) for key, entry in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [exact(entry) for entry in value]
    return value
