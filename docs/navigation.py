"""The tree of all pages, which stands beside each of them, is made of their titles alone.

Sphinx makes it for each page anew, from copies of all that every page holds, down to the last
function, and then leaves out all but the titles: half of the time that the documentation took.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from docutils.nodes import bullet_list
from sphinx.addnodes import toctree

_titles: dict[str, bullet_list] = {}


def of_titles(app: Any, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Let a page that asks for titles only have them of a tree that holds nothing else."""
    resolved: Callable[..., str] | None = context.get("toctree")
    if resolved is None:
        return
    everything = app.env.tocs
    if not _titles:
        _titles.update({name: _short(contents) for name, contents in everything.items()})

    def tree(**options: Any) -> str:
        app.env.tocs = _titles if options.get("titles_only") else everything
        try:
            return resolved(**options)
        finally:
            app.env.tocs = everything

    context["toctree"] = tree


def _short(contents: bullet_list) -> bullet_list:
    """Return the contents of a page without its sections, but with the trees in these."""
    short = contents.deepcopy()
    for title in short.children:
        if len(title) > 1:
            if trees := list(title.findall(toctree)):
                title[1][:] = trees
            else:
                title.pop(1)
    return short


def setup(app: Any) -> dict[str, bool]:
    """Come before the theme, which asks at the usual priority, 500."""
    app.connect("html-page-context", of_titles, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
