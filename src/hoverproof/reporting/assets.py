"""What comes along for pages: style sheets, scripts, templates."""

from __future__ import annotations

import re
from functools import cache
from importlib import resources

import jinja2

from hoverproof.templates import templates


@cache
def asset(name: str) -> str:
    """Return a style sheet or a script without what only its reader needs.

    Parameters
    ----------
    name : str
        Of its file.
    """
    folder = resources.files("hoverproof.reporting") / "templates"
    return re.sub(r"(?m)\s+$", "", (folder / name).read_text(encoding="utf-8")) + "\n"


def pages() -> jinja2.Environment:
    """Return the templates of pages."""
    layout = {"autoescape": True, "trim_blocks": True, "lstrip_blocks": True}
    return templates("hoverproof.reporting", "templates", **layout)
