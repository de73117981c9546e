"""Make all certificates here anew: ``python proofs/make.py [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from hoverproof.certification.attraction.lemmas import LEMMAS
from hoverproof.certification.convergence import attraction, start_or_ball
from hoverproof.certification.exponential.lemmas import LEMMAS as TOLERANCES
from hoverproof.certification.gains import Proved, certify
from hoverproof.certification.lemma import Lemma
from hoverproof.certification.over_box import certify_region
from hoverproof.certification.region import default_box
from hoverproof.mission.presets import presets
from hoverproof.mission.reading import load

EXAMPLE = Path(__file__).parents[1] / "examples" / "half-kilo.toml"
LEDGERS = {
    "attraction-lemmas.md": ("The lemmas behind a region of attraction", LEMMAS),
    "exponential-lemmas.md": ("The lemmas behind every vehicle within tolerances", TOLERANCES),
}


def make(folder: Path) -> None:
    """Write the ledgers, and the certificates of each preset."""
    for name, (title, proved) in LEDGERS.items():
        (folder / name).write_text(lemmas(title, proved), encoding="utf-8")
    for name in presets():
        certificates(name, folder)


def certificates(name: str, folder: Path) -> None:
    """Write the certificates of a preset: gains, region, over-box, attraction."""
    mission = load(name)
    box = default_box(mission)
    over_box = certify_region(mission, box)
    if over_box.status != "proved" or over_box.certificate is None:
        raise SystemExit(f"{name}: eigenvalue bounds over its box: {over_box.status}")
    over_box.certificate.save(folder / f"{name}.region.cert.json")
    for ending, enclosed in (("cert", None), ("over-box.cert", over_box.enclosure)):
        verdict = certify(mission, region=enclosed)
        if not isinstance(verdict, Proved):
            raise SystemExit(f"{name}: {verdict.status}")
        verdict.certificate.save(folder / f"{name}.{ending}.json")
    start, attracted = start_or_ball(mission)
    if attracted is None:
        raise SystemExit(f"{name}: no region of attraction, its start is {start.status}")
    if attracted is not start:
        print(f"{name}: its start is {start.status}, so the largest ball about the goal is made")
    attracted.certificate.save(folder / f"{name}.attraction.cert.json")


def every_vehicle(folder: Path) -> None:
    """Write the certificate of the example whose proof is about every vehicle within tolerances."""
    mission = load(EXAMPLE)
    verdict = attraction(mission)
    if verdict.proved is None:
        raise SystemExit(f"{mission.name}: {verdict.status}, {verdict.reason}")
    verdict.proved.certificate.save(folder / f"{mission.name}.attraction.cert.json")


def lemmas(title: str, proved: tuple[Lemma, ...]) -> str:
    """Return a ledger of lemmas as Markdown; each identity is proved now."""
    parts = [f"# {title}\n\nMade by `make proofs`.\n"]
    for lemma in proved:
        identities = lemma.identities()
        if not all(identities.values()):
            raise SystemExit(f"lemma {lemma.id}: not proved: {identities}")
        parts.append(f"## {lemma.id}: {lemma.title}\n\n{_plain(lemma.statement)}\n")
        parts.append(f"*Proof.* {_plain(lemma.proof)} ∎\n")
        parts.append("Proved exactly, all parameters symbolic:\n")
        parts.append("".join(f"- {_plain(name)}\n" for name in identities))
    return "\n".join(parts)


def _plain(words: str) -> str:
    """Escape what Markdown would read as markup."""
    return "".join(rf"\{c}" if c in "*_[]<>|" else c for c in words)


if __name__ == "__main__":
    FOLDER = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    make(FOLDER)
    every_vehicle(FOLDER)
