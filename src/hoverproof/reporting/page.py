"""The page of a report: what its template is filled with."""

from __future__ import annotations

import base64
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import jinja2
from markupsafe import Markup

from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.certificate import Certificate
from hoverproof.certification.convergence import not_covered
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.export.cost import STEPS
from hoverproof.paper.judge import Verdict
from hoverproof.reporting import mathematics, pictures, symbol_tables, tables, wording
from hoverproof.reporting.assets import asset, pages
from hoverproof.reporting.glance import NOT_PROVED, Line
from hoverproof.reporting.numerals import short
from hoverproof.reporting.parts import Attracted, Firmware, Flown, Map, Missing, Parts, sentence
from hoverproof.reporting.player import player_data
from hoverproof.reporting.symbols import STATED
from hoverproof.version import __version__

CONTENTS = (
    ("theorem", "Verdict and theorem"),
    ("mission", "Mission"),
    ("margins", "Margins"),
    ("atlas", "Atlas"),
    ("region", "Eigenvalue region"),
    ("attraction", "Region of attraction"),
    ("flight", "Flight"),
    ("firmware", "Firmware"),
    ("ledger", "The paper, judged"),
    ("provenance", "Provenance"),
)
UNITS = "kg|m|N|s|rad|1/m|1/s|bytes"
MENDED = (Verdict.CORRECTED, Verdict.FALSE, Verdict.UNPROVED)
"""Verdicts on claims that a reader should see first."""

TONES = {
    Verdict.HOLDS: "proved",
    Verdict.CORRECTED: "undecided",
    Verdict.FALSE: "refuted",
    Verdict.UNPROVED: "undecided",
}


@dataclass(frozen=True)
class Origin:
    """Where a report comes from.

    Attributes
    ----------
    command : str
        That made it.
    source : str
        Mission file or preset.
    made_at : str or None
        Date, if it is to be in the file.
    """

    command: str
    source: str
    made_at: str | None


@dataclass(frozen=True)
class File:
    """A file inside a page.

    Attributes
    ----------
    name : str
        To be saved as.
    link : str
        A ``data:`` address that holds it.
    """

    name: str
    link: str


def render(parts: Parts, origin: Origin, glance: Sequence[Line]) -> str:
    """Return the page, HTML in one piece.

    Parameters
    ----------
    parts : Parts
    origin : Origin
    glance : sequence of Line
        Questions and answers at its head.
    """
    return _template().render(context(parts, origin, glance))


def context(parts: Parts, origin: Origin, glance: Sequence[Line]) -> dict[str, Any]:
    """Return what the template asks for, by name.

    Parameters
    ----------
    parts, origin, glance
        See `render`.
    """
    files = _files(parts)
    return {
        "mission": parts.mission,
        "parts": parts,
        "verdict": parts.verdict,
        "version": __version__,
        "contents": [(anchor, wording.heading(words, parts)) for anchor, words in CONTENTS],
        "css": asset("report.css"),
        "js": asset("player.js"),
        "headline": wording.headline(parts),
        "glance": glance,
        "not_proved": NOT_PROVED,
        "merits": list(wording.merits(parts)),
        "certificate": files.get("gains"),
        "region_file": files.get("region"),
        "attraction_file": files.get("attraction"),
        "sinks_file": files.get("sinks"),
        "files": list(files.values()),
        "rounding_steps": STEPS,
        "not_claimed": wording.not_said(parts),
        "law_words": wording.law(parts.mission),
        "nominal": wording.nominal(parts),
        "stated": STATED,
        **vars(origin),
        **_theorem(parts),
        **_tables(parts),
        **_pictures(parts),
        **_provenance(parts),
    }


def _theorem(parts: Parts) -> dict[str, Any]:
    verdict, problem = parts.verdict, parts.verdict.problem
    told: dict[str, Any] = {"claim": None, "counterexample": None}
    symbol = problem.flow.symbol
    told["symbol"] = symbol
    told["theorem_words"] = wording.theorem(parts)
    told["inside_words"] = wording.inside_words(parts)
    told["question"] = mathematics.question(problem.eigenvalues, problem.thrust, symbol)
    told["statement"] = verdict.statement
    if verdict.status == "proved":
        told["claim"] = mathematics.claim(
            problem.eigenvalues, problem.thrust, verdict.margin, verdict.decay_rate, symbol
        )
    if verdict.status == "refuted":
        told["counterexample"] = mathematics.counterexample(
            verdict.Q, verdict.f, verdict.thrust, verdict.X, verdict.value, symbol
        )
    judged = {} if isinstance(parts.ledger, Missing) else {j.id: j for j in parts.ledger}
    papers = judged if parts.mission.law.is_papers else {}  # the ledger is about no other law
    told["meanings"] = [
        (id, words, papers[id].derived.latex()) for id, words in mathematics.IMPLIED if papers
    ]
    told["symbols"] = [] if papers else list(symbol_tables.of_gains(parts.mission, symbol))
    told["ledger_reasons"] = [(id, papers[id].reason) for id in ("conditions", "theorem") if papers]
    told["conditions_words"] = wording.conditions(parts)
    if (attracted := _attraction(parts)) is not None:
        told["not_covered"] = not_covered(attracted)
        told["attraction_words"] = wording.attraction(attracted)
        told["attraction_symbols"] = list(symbol_tables.of_starts(attracted))
        told["attraction_statement"] = attracted.certificate.statement
        told["attraction_claim"] = (
            mathematics.exponential_claim(attracted)
            if isinstance(attracted, Exponential)
            else mathematics.attraction_claim(attracted)
        )
    told["mended"] = [j for j in judged.values() if j.verdict in MENDED]
    told["unmended"] = [j for j in judged.values() if j.verdict not in MENDED]
    counts = Counter(str(j.verdict) for j in judged.values())
    order = [str(v) for v in Verdict]
    told["tally"] = sorted(counts.items(), key=lambda item: order.index(item[0]))
    return told


def _tables(parts: Parts) -> dict[str, Any]:
    goal = parts.verdict.problem.goal
    told: dict[str, Any] = {
        "tables": [
            *tables.mission_tables(parts.mission, goal.centroid_midpoint),
            *tables.hover_error_tables(parts.mission),
            *tables.strange_tables(parts.mission),
        ],
        "margins": tables.margins_table(parts.verdict),
        "demands": parts.demands,
    }
    if isinstance(parts.atlas, Map):
        told["atlas_words"] = wording.atlas(parts.atlas)
    told["supposed_words"] = wording.supposed(parts)
    if not isinstance(parts.region, Missing):
        told["region_table"] = tables.region_table(parts.region)
        told["region_words"] = wording.region(parts.region, parts.mission)
    if (attracted := _attraction(parts)) is not None:
        told["attraction_table"] = (
            tables.exponential_table(attracted)
            if isinstance(attracted, Exponential)
            else tables.attraction_table(attracted)
        )
    if isinstance(parts.flight, Flown):
        told["flight_table"] = tables.flight_table(parts.flight)
        told["flight_words"] = wording.FLIGHT
        told["player"] = player_data(parts.flight)
        if parts.flight.runs_summary is not None:
            told["runs_table"] = tables.runs_table(parts.flight.runs_summary)
    if isinstance(parts.firmware, Firmware):
        told["firmware_table"] = tables.firmware_table(parts.firmware)
    return told


def _pictures(parts: Parts) -> dict[str, Any]:
    drawn: dict[str, Any] = {}
    if isinstance(parts.atlas, Map):
        drawn["atlas"] = pictures.map_picture(parts.mission, parts.atlas)
    if not isinstance(parts.region, Missing):
        drawn["region"] = pictures.region_picture(parts.mission, parts.region)
    if (attracted := _attraction(parts)) is not None:
        drawn["attraction"] = (
            pictures.exponential_pictures(attracted)
            if isinstance(attracted, Exponential)
            else pictures.attraction_pictures(attracted)
        )
    if isinstance(parts.flight, Flown):
        drawn["flight"] = list(pictures.flight_pictures(parts.flight))
        many = parts.flight.runs is not None
        drawn["runs"] = pictures.runs_picture(parts.flight) if many else None
    return {"pictures": drawn}


def _attraction(parts: Parts) -> Attraction | Exponential | None:
    """Return what is shown of where it may be switched on, if there is anything."""
    return parts.attraction.region if isinstance(parts.attraction, Attracted) else None


def _certificates(parts: Parts) -> Iterable[tuple[str, str, Certificate]]:
    """Yield what is proved or refuted here: kind, ending of the file's name, certificate."""
    verdict = parts.verdict
    if verdict.certificate is not None:
        yield "gains", verdict.ending, verdict.certificate
    region = parts.region
    if not isinstance(region, Missing) and region.certificate is not None:
        yield "region", f"region.{region.ending}", region.certificate
    if isinstance(parts.attraction, Attracted):
        start = parts.attraction.start
        if start.status == "refuted":
            yield "sinks", "attraction.refutation", start.certificate
        if parts.attraction.region is not None:
            yield "attraction", "attraction.cert", parts.attraction.region.certificate


def _files(parts: Parts) -> dict[str, File]:
    files = {}
    for kind, ending, certificate in _certificates(parts):
        encoded = base64.b64encode(certificate.text().encode()).decode()
        link = f"data:application/json;base64,{encoded}"
        files[kind] = File(f"{parts.mission.name}.{ending}.json", link)
    return files


def _provenance(parts: Parts) -> dict[str, Any]:
    certificates = list(_certificates(parts))
    hashes: dict[str, str] = {}
    versions = {"hoverproof": __version__}
    for _, ending, certificate in certificates:
        hashes.setdefault("mission", certificate.content["mission_sha256"])
        hashes[f"{parts.mission.name}.{ending}.json"] = certificate.content["sha256"]
        versions |= certificate.content["tools"]
    if parts.verdict.certificate is not None:
        hashes["derived model, Σ"] = parts.verdict.certificate.content["model_sha256"]
    if isinstance(parts.flight, Flown):
        hashes["derived model, flight"] = parts.flight.whole.attrs["model_sha256"]
    if isinstance(parts.firmware, Firmware):
        hashes["firmware, law"] = parts.firmware.manifest["law_sha256"]
    return {
        "hashes": list(hashes.items()),
        "versions": tables.Table("Versions", list(versions.items())),
    }


def _anchor(id: str) -> str:
    """Return the place of a claim of the paper in the page."""
    return "eq-" + "".join(c if c.isascii() and c.isalnum() else f"-{ord(c):x}" for c in id)


def _equation(id: str) -> str:
    return f"eq. {id}" if id.isdigit() else id


def _tight(words: str) -> str:
    """Keep a number and its unit on one line."""
    return re.sub(
        rf"(?<=[\d)⁰¹²³⁴-⁹]) (?=(?:{UNITS})\b|%)|(?<=kg) (?=m)|(?<=N) (?=m)|(?<=[≥≤]) ",
        "\N{NO-BREAK SPACE}",
        words,
    )


def _tone(verdict: Verdict) -> str:
    return TONES.get(verdict, "")


@cache
def _template() -> jinja2.Template:
    environment = pages()

    def mathml(latex: str, *, block: bool = False) -> Markup:
        return Markup(mathematics.mathml(latex, block=block))

    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    environment.filters |= {
        "mathml": mathml,
        "short": short,
        "sentence": sentence,
        "anchor": _anchor,
        "equation": _equation,
        "tone": _tone,
        "tight": _tight,
    }
    return environment.get_template("report.html.j2")
