"""The page of an audit: one HTML file that needs no other."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from jinja2 import Environment

from hoverproof.audit.verdict import Audit
from hoverproof.files import write_text
from hoverproof.show.audit import findings_figure
from hoverproof.show.style import laid_out
from hoverproof.version import __version__

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Audit of {{ audit.log.source }}</title>
<style>
body { font: 15px/1.45 system-ui, sans-serif; max-width: 62em; margin: 1em auto; padding: 0 1em }
table { border-collapse: collapse; width: 100% }
td, th { text-align: left; vertical-align: top; padding: .25em .6em; border-bottom: 1px solid #ddd }
.broken { background: #fbe3d6 } .untold { color: #666 } pre { white-space: pre-wrap }
svg { width: 100%; height: auto }
</style></head><body>
<h1>{{ heading }}</h1>
<p>{{ audit.log.source }}, {{ audit.log.kind }}{% if audit.log.partial %}.
<strong>Partial: {{ audit.log.partial }}.</strong>{% endif %}</p>
<table><tr><th>Assumption</th><th></th><th>Found</th><th>Assumed</th><th>Since</th><th></th></tr>
{% for f in audit.findings %}
<tr class="{{ 'untold' if f.held is none else '' if f.held else 'broken' }}">
<td>{{ f.name }}{{ ' (follows)' if f.follows }}</td>
<td>{{ 'not told' if f.held is none else 'held' if f.held else 'broken' }}</td>
<td>{% if f.held is not none %}{{ '%.4g' % f.value }}
{%- if f.deviation == f.deviation %} ± {{ '%.1g' % f.deviation }}{% endif %}
{{ '' if f.unit == '1' else f.unit }}{% endif %}</td>
<td>{% if f.held is not none %}{{ '%.4g' % f.bound }}{% endif %}</td>
<td>{% if f.at is not none %}{{ '%.4g' % f.at }} s{% endif %}</td>
<td>{{ f.words }}</td></tr>
{% endfor %}</table>
{% if command %}<p>Tolerances that would cover it, to be proved by</p>
<pre>{{ command }}</pre>{% endif %}
{% if picture %}<h2>Over time</h2>
<p>Dashed: what is assumed. Upright: when it first broke.</p>
{{ picture|safe }}{% endif %}
<details><summary>As printed</summary><pre>{{ lines|join("\n") }}</pre></details>
<p>hoverproof {{ version }}. Assumptions that are not told may be broken all the same.</p>
</body></html>
"""


def write_page(path: Path, audit: Audit, lines: Sequence[str], command: str | None) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
    audit : Audit
    lines : sequence of str
        What is printed; its first is the heading.
    command : str, optional
        That asks for the proof with tolerances that would cover what was found.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    page = Environment(autoescape=True).from_string(PAGE)
    text = page.render(
        audit=audit,
        heading=lines[0],
        lines=lines,
        command=command,
        picture=_picture(audit),
        version=__version__,
    )
    write_text(path, text + "\n")


def _picture(audit: Audit) -> str:
    if not any(f.times is not None for f in audit.findings):
        return ""
    drawn = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "audit"}):
        figure = laid_out(findings_figure(audit.findings), "svg")
        figure.savefig(drawn, format="svg", metadata={"Date": None})
    text = drawn.getvalue()
    return text[text.index("<svg") :]
