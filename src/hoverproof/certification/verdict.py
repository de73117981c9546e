"""What a question comes to: proved, refuted or undecided, whatever the theorem.

A theorem adds what it claims as dataclasses under these, such as `ProvedGains` of
`hoverproof.certification.gains`; what all verdicts have is asked for without looking at the kind.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Literal, Self

from hoverproof.certification.certificate import Certificate
from hoverproof.mission.sections import Mission

SHORT = 160
"""Letters: of what is longer the first part alone is shown, whole."""


class _OfMission:
    """What all verdicts have: a short word of themselves."""

    mission: Mission
    status: ClassVar[str]

    @property
    def gist(self) -> str:
        """The answer in a few words."""
        return ""

    def __repr__(self) -> str:
        first, *more = self.gist.split("; ")
        gist = first if len(self.gist) > SHORT and more else self.gist
        words = f"{self.status}: {gist}" if gist else self.status
        return f"<{type(self).__name__}, {self.mission.name}: {words}>"


@dataclass(frozen=True, kw_only=True, repr=False)
class Proved(_OfMission):
    """What was asked holds, and the checker accepts the certificate.

    Attributes
    ----------
    status : str
        ``"proved"``.
    mission : Mission
    certificate : Certificate
    """

    status: ClassVar[Literal["proved"]] = "proved"
    ending: ClassVar[str] = "cert"  # of the names of files with its certificate
    refuted: ClassVar[None] = None
    reason: ClassVar[None] = None  # only what is not proved has one
    advice: ClassVar[tuple[str, ...]] = ()
    mission: Mission
    certificate: Certificate

    @property
    def proved(self) -> Self:
        """This verdict; None of one that is not proved."""
        return self

    @property
    def statement(self) -> str:
        """The theorem in words."""
        return self.certificate.statement


@dataclass(frozen=True, kw_only=True, repr=False)
class Refuted(_OfMission):
    """What was asked does not hold: the checker accepts the counterexample in the certificate.

    Attributes
    ----------
    status : str
        ``"refuted"``.
    mission : Mission
    certificate : Certificate
    """

    status: ClassVar[Literal["refuted"]] = "refuted"
    ending: ClassVar[str] = "refutation"
    proved: ClassVar[None] = None
    advice: ClassVar[tuple[str, ...]] = ()
    mission: Mission
    certificate: Certificate

    @property
    def refuted(self) -> Self:
        """This verdict; None of one that is not refuted."""
        return self

    @property
    def reason(self) -> str | None:
        """What happens, if the counterexample is a motion."""
        return None

    @property
    def gist(self) -> str:
        """What happens, if it is said in words."""
        return self.reason or ""

    @property
    def statement(self) -> str:
        """What the counterexample shows, in words."""
        return self.certificate.statement


@dataclass(frozen=True, kw_only=True, repr=False)
class Undecided(_OfMission):
    """Neither a proof nor a counterexample was found.

    Attributes
    ----------
    status : str
        ``"undecided"``.
    mission : Mission
    reason : str
        What stood in the way.
    advice : tuple of str
        What may help.
    certificate : Certificate or None
        Of less than what was asked, if that much is proved.
    """

    status: ClassVar[Literal["undecided"]] = "undecided"
    ending: ClassVar[str] = "cert"
    proved: ClassVar[None] = None
    refuted: ClassVar[None] = None
    statement: ClassVar[None] = None  # nothing is claimed of what was asked
    mission: Mission
    reason: str
    advice: tuple[str, ...] = ()
    certificate: Certificate | None = None

    @property
    def gist(self) -> str:
        """What stood in the way."""
        return self.reason

    def because(self, more: str) -> Self:
        """Return it with more to the reason.

        Parameters
        ----------
        more : str
        """
        return replace(self, reason=f"{self.reason}; {more}")


Verdict = Proved | Refuted | Undecided
