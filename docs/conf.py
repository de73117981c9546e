"""The documentation: `make docs` builds it without a network, warnings as errors."""

from __future__ import annotations

import importlib
import inspect
import sys
from pathlib import Path
from typing import Any

from docutils.nodes import Text, image, reference
from pydantic import BaseModel
from sphinx.addnodes import pending_xref

import hoverproof

HERE = Path(__file__).parent
COLON = "\uf8ff"  # of no meaning to anybody
sys.path.insert(0, str(HERE))

import generate  # noqa: E402 - it stands beside this file

project = "hoverproof"
author = "the authors of hoverproof"
version = release = hoverproof.__version__
copyright = author

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "navigation",
    "run",
    "sphinx-mathjax-offline",
]
exclude_patterns = ["_build"]

# Pages
myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
smartquotes_action = "qe"  # dashes stay: --help is not –help
nb_execution_mode = "off"  # the notebooks are kept with their outputs
nb_merge_streams = True

# Reference
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # types and units stand in the docstrings
autodoc_default_options = {"members": True, "exclude-members": "model_config"}
viewcode_follow_imported_members = False  # a constant belongs to its module, not to builtins
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(?!hoverproof).*")]  # names of other packages, and shapes

# Looks
html_theme = "furo"
html_title = f"hoverproof {version}"
html_static_path = ["_static"]
html_css_files = ["hoverproof.css"]
html_theme_options = {"footer_icons": []}
html_copy_source = False
html_show_sphinx = False
pygments_style = "friendly"


def colons_stay(app: Any, what: str, *arguments: Any) -> None:
    """Keep "a: b" of a property from being read as "type: description", until that is done."""
    lines: list[str] = arguments[-1]
    if what in {"attribute", "data", "property"} and lines:
        lines[0] = lines[0].replace(": ", f"{COLON} ")


def bars_are_bars(*arguments: Any) -> None:
    """Keep |x| from being read as a substitution, outside of code."""
    lines: list[str] = arguments[-1]
    lines[:] = [line.replace(COLON, ":") for line in lines]
    for i, line in enumerate(lines):
        parts = line.split("``")
        parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
        lines[i] = "``".join(parts)


def short_signatures(
    app: Any, what: str, name: str, thing: Any, options: Any, signature: str | None, *rest: Any
) -> tuple[str, None] | None:
    """Show the keys of a section of a mission without their defaults, which fill a page."""
    if what != "class" or not issubclass(thing, BaseModel):
        return None
    return f"(*, {', '.join(thing.model_fields)})", None


def names_as_imported(app: Any, doctree: Any) -> None:
    """Let a class in a docstring be the one that its module imports, if several bear the name."""
    for node in doctree.findall(pending_xref):
        if node.get("refdomain") != "py" or not node.get("py:module"):
            continue
        module = importlib.import_module(node["py:module"])
        thing = getattr(module, node["reftarget"], None)
        if inspect.isclass(thing) and thing.__module__.startswith("hoverproof"):
            node["reftarget"] = f"{thing.__module__}.{thing.__qualname__}"


def dashes_are_dashes(app: Any, doctree: Any) -> None:
    """Part an argument from its meaning by a dash."""
    for text in list(doctree.findall(Text)):
        if text.startswith(" -- "):
            text.parent.replace(text, Text(f" – {text[4:]}"))


def words_lead_nowhere(app: Any, doctree: Any) -> None:
    """Unlink what is no class where types and attributes are told: it would lead to a namesake."""
    for node in list(doctree.findall(pending_xref)):
        told = node.get("refdomain") == "py" and node.get("refspecific")
        if told and not node["reftarget"].rpartition(".")[2][:1].isupper():
            node.replace_self(node.children)


def pictures_open(app: Any, doctree: Any, page: str) -> None:
    """Give each picture its size: Sphinx then links it to itself, to be looked at closely."""
    for picture in doctree.findall(image):
        if not isinstance(picture.parent, reference):
            picture.setdefault("scale", 100)


def setup(app: Any) -> None:
    """Write the pages that are made from the program before the pages are read."""
    app.connect("builder-inited", lambda app: generate.write(Path(app.srcdir)))
    app.connect("autodoc-process-docstring", colons_stay, priority=400)  # before napoleon
    app.connect("autodoc-process-docstring", bars_are_bars)
    app.connect("autodoc-process-signature", short_signatures)
    app.connect("doctree-read", names_as_imported)
    app.connect("doctree-read", words_lead_nowhere)
    app.connect("doctree-read", dashes_are_dashes)
    app.connect("doctree-resolved", pictures_open)
