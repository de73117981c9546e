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
from hoverproof.errors import InputError
from hoverproof.files import write_text
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal


@dataclass(frozen=True, repr=False)
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

    def __repr__(self) -> str:
        kind, mission = self.content["kind"], self.content["mission"]["name"]
        return f"<Certificate, {mission}: {kind}, SHA-256 {self.content['sha256'][:12]}…>"

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


def rejection(certificate: Certificate) -> str:
    """Return why the checker rejects a certificate; nothing if it accepts it.

    Parameters
    ----------
    certificate : Certificate
    """
    try:
        checker.check(certificate.content)
    except checker.Rejected as rejected:
        return str(rejected) or "rejected"
    return ""


def accepted(certificate: Certificate) -> Certificate | None:
    """Return a certificate if the checker accepts it.

    Parameters
    ----------
    certificate : Certificate
    """
    return None if rejection(certificate) else certificate


def seal(mission: Mission, kind: str, parts: dict[str, Any], model: str) -> Certificate:
    """Complete a certificate about a mission: add the mission, statement, versions and hashes.

    Parameters
    ----------
    mission : Mission
    kind : str
        One of `checker.KINDS`.
    parts : dict
        What belongs to this kind; Fractions become exact strings.
    model : str
        SHA-256 of the graph from which the claim was computed.

    Raises
    ------
    InputError
        If the numbers make no certificate: they have grown too long, for one.
    """
    numbers = mission.exact()
    by_height = mission.goal.height is not None
    content: dict[str, Any] = {
        "format": "hoverproof certificate",
        "version": checker.VERSION,
        "kind": kind,
        "statement": "",
        "mission": numbers,
        "mission_sha256": checker.digest(numbers),
        "model_sha256": model,
        "tools": dict(_tools()),
        "goal_position": exact(hover_goal(mission).position) if by_height else None,
        **exact(parts),
    }
    try:
        content["statement"] = checker.statement(content)
    except checker.Rejected as rejected:
        raise InputError(mission.source, "", f"makes no certificate: {rejected}") from None
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
