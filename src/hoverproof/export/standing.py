"""What is proved of a mission when its firmware is written, and how its files say so."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from hoverproof import checker
from hoverproof.algebra.decimals import at_least, at_most, decimal_above, decimal_below
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.mission.sections import Mission
from hoverproof.mission.task import LawChoice
from hoverproof.plant.goal import hover_goal
from hoverproof.servo.law import Law
from hoverproof.servo.laws.heading import flown_law

THEOREMS = {"attraction": 3, "exponential": 5, "potential": 6}
"""The theorem of each kind of certificate that is about starts, by its number."""


@dataclass(frozen=True)
class Standing:
    """What is known of a mission before its firmware is written.

    Attributes
    ----------
    thrust : (low, high)
        Interval of T that is assumed in flight, N; that of a certificate takes its place.
    certificate : mapping, optional
        Content of a gain certificate.
    attraction : mapping, optional
        Content of a certificate of from where the vehicle converges; without either, every file
        says that nothing is proved.
    tilt_cosine : Fraction, optional
        Bound from below of the cosine of the tilt on the way, where that certificate has it;
        dimensionless.
    """

    thrust: tuple[Fraction, Fraction]
    certificate: Mapping[str, Any] | None = None
    attraction: Mapping[str, Any] | None = None
    tilt_cosine: Fraction | None = None

    @property
    def certificates(self) -> dict[str, Mapping[str, Any]]:
        """What is proved, by the end of the name of its file."""
        ours = {"cert": self.certificate, "attraction.cert": self.attraction}
        return {ending: content for ending, content in ours.items() if content is not None}

    def texts(self, name: str) -> dict[str, str]:
        """Return the certificates of a package as they are written, by the names of their files.

        Parameters
        ----------
        name : str
            Prefix of files.
        """
        return {
            f"{name}.{ending}.json": json.dumps(dict(held), indent=2, ensure_ascii=False) + "\n"
            for ending, held in self.certificates.items()
        }


@dataclass(frozen=True)
class Proof:
    """One theorem with its certificate, as the files tell it.

    Attributes
    ----------
    theorem : int
        Its number in the proofs.
    gist, statement : str
        In a sentence, and in full.
    sha256 : str
        Of the certificate.
    ending : str
        Of the name of its file.
    """

    theorem: int
    gist: str
    statement: str
    sha256: str
    ending: str


@dataclass(frozen=True)
class Evidence:
    """What is proved of the gains, as the files tell it.

    Attributes
    ----------
    proofs : tuple of Proof
    eigenvalue_bounds : str or None
        Whether the certificate of the gains assumes the bounds of Q or has them proved.
    from_starts : bool
        Whether all of it is about starts, with what is on the way proved and not assumed.
    covers : tuple of str
        What it covers beside the vehicle as modelled, in words.
    rotor_thrusts : tuple of (low, high)
        What all rotors, or each, are proved to make, and to be set to make, on the way, N.
    one_goal : str
        That the theorems are about one goal, where they name it by different numbers.
    """

    proofs: tuple[Proof, ...]
    eigenvalue_bounds: str | None
    from_starts: bool
    covers: tuple[str, ...] = ()
    rotor_thrusts: tuple[tuple[Fraction, Fraction], ...] = ()
    one_goal: str = ""

    @property
    def certified(self) -> bool:
        """Whether anything is proved."""
        return bool(self.proofs)

    @property
    def sha256(self) -> str:
        """Of the first certificate, or ``"none"``."""
        return self.proofs[0].sha256 if self.proofs else "none"

    @property
    def claim(self) -> str:
        """What is proved in a line for each certificate."""
        if not self.proofs:
            return "UNCERTIFIED: nothing is proved of these gains."
        return "\n * ".join(
            f"Theorem {p.theorem}: certificate SHA-256 {p.sha256}." for p in self.proofs
        )

    @property
    def statement(self) -> str:
        """What is proved, in full."""
        if not self.proofs:
            return f"**{self.claim} Not for flight.**"
        proofs = [
            f"**What is proved: theorem {p.theorem}.** {p.gist} {p.statement}" for p in self.proofs
        ]
        return "\n\n".join([*proofs, *filter(None, [self.one_goal])])

    @property
    def rotors_in_words(self) -> str:
        """The same in N, rounded outward."""
        return ", ".join(f"{at_least(low)} to {at_most(high)}" for low, high in self.rotor_thrusts)

    @property
    def interval(self) -> str:
        """Whether the interval of thrusts is certified or assumed."""
        return "certified" if self.certified else "assumed"


def checked(standing: Standing, mission: Mission, law: Law) -> Standing:
    """Check the certificates once more, and take the bounds of the flight from the last.

    Parameters
    ----------
    standing : Standing
    mission : Mission
    law : Law
        What the firmware computes.

    Raises
    ------
    checker.Rejected
        If one does not prove that the gains of this mission work with this law.
    """
    for held in standing.certificates.values():
        own = flown_law(mission)
        about = f"a certificate of {mission.name} is about {own.name}, not about {law.name}"
        checker.require(law == own, about)
        checker.check(held)
        theirs = LawChoice(**held["mission"].get("law", {})).name
        about = f"the certificate is about the law {theirs}, not about {mission.law.name}"
        checker.require(theirs == mission.law.name, about)
        same = held["mission"] == mission.exact()
        checker.require(same, "the certificate is about another mission")
    if standing.certificate is not None:
        gains = standing.certificate["kind"] == "gains"
        checker.require(gains, "this is no certificate of gains")
        low, high = checker.claim_of(standing.certificate).thrust
        standing = replace(standing, thrust=(low, high))
    if standing.attraction is not None:  # the flight is that of its theorem
        starts = standing.attraction["kind"] in THEOREMS
        checker.require(starts, "this is no certificate of where the vehicle converges from")
        return _on_the_way(standing, checker.claim_of(standing.attraction))
    return standing


def _on_the_way(standing: Standing, claim: Any) -> Standing:
    """Take thrust and tilt as they are proved to be on the way: |F| <= f, and the wind beside."""
    push = getattr(claim, "push", Fraction(0))
    low = sqrt_enclosure((claim.weight - claim.force) ** 2 - push**2)[0]
    thrust = decimal_below(low, 9), decimal_above(claim.weight + claim.force, 9)
    return replace(standing, thrust=thrust, tilt_cosine=decimal_below(claim.cosine, 9))


def evidence(standing: Standing, mission: Mission) -> Evidence:
    """Return what the files say is proved.

    Parameters
    ----------
    standing : Standing
        Its certificates are checked.
    mission : Mission
        That they are about.
    """
    proofs: list[Proof] = []
    bounds = None
    covers: tuple[str, ...] = ()
    rotors: tuple[tuple[Fraction, Fraction], ...] = ()
    if (gains := standing.certificate) is not None:
        boxed = gains["region"]["box"] is not None
        bounds = "proved over a box" if boxed else "assumed"
        origin = f"{bounds} by theorem 2" if boxed else bounds
        gist = (
            f"L falls while what this theorem assumes holds; its bounds of the slope are {origin}."
        )
        proofs.append(Proof(1, gist, gains["statement"], gains["sha256"], "cert"))
    if (held := standing.attraction) is not None:
        gist, theorem = _gist(held), THEOREMS[held["kind"]]
        proofs.append(Proof(theorem, gist, held["statement"], held["sha256"], "attraction.cert"))
        covers, rotors = _covered(held, mission), _rotors(held)
    on_the_way = standing.attraction is not None
    return Evidence(tuple(proofs), bounds, on_the_way, covers, rotors, _one_goal(proofs, mission))


def _one_goal(proofs: Sequence[Proof], mission: Mission) -> str:
    """Say that both theorems are about one goal, where its numbers differ."""
    if len(proofs) < 2 or mission.law.feature == "centroid":
        return ""
    place = ", ".join(f"{float(c):.6g}" for c in hover_goal(mission).position)
    gains, starts = (p.theorem for p in proofs)
    return (
        f"Both are about the same goal, the hover at ({place}) m: theorem {gains} names the "
        f"centroid q* seen from there, theorem {starts} the law's feature, which is that centroid "
        "scaled by the size of the target."
    )


def _covered(held: Mapping[str, Any], mission: Mission) -> tuple[str, ...]:
    """Say what a certificate about starts covers of what a mission asks for."""
    if held["kind"] != "exponential":
        return tuple(mission.uncertainty.covers())
    sees = held["claim"]["cone"] is not None
    views = mission.camera.covers() if sees else mission.camera.beside()
    return (*mission.uncertainty.covers(), *views)


def _rotors(held: Mapping[str, Any]) -> tuple[tuple[Fraction, Fraction], ...]:
    ends = held["claim"].get("rotors", [])
    each = [ends] if ends and isinstance(ends[0], str) else ends
    return tuple((Fraction(low), Fraction(high)) for low, high in each)


def _gist(held: Mapping[str, Any]) -> str:
    """Say for whom, from where, and how soon."""
    claim = held["claim"]
    if held["kind"] != "exponential":
        who = "The vehicle as modelled"
        if held["kind"] == "potential":
            who = "Every vehicle within the tolerances of the mission"
        return f"{who} converges to its goal from every state named here."
    soon = claim["settling"]
    time, radius = (at_most(Fraction(soon[key])) for key in ("time", "radius"))
    last = "" if "ultimate" not in claim else " to what the noise leaves"
    return (
        "Every vehicle within the tolerances of the mission, switched on in a state named here, is "
        f"from {time} s on within {radius} m of its hover, and Ψ falls{last} as exp(-r t), r = "
        f"{at_least(Fraction(claim['rate']))} 1/s."
    )
