"""Directives that run what a page shows: what the reader sees is what the program said.

``file`` shows a file and writes it; ``run`` shows a command and what it prints, and stops the build
unless it ends with the status that the page says. The commands of a page share a folder.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from forked import ran
from sphinx.directives.code import container_wrapper
from sphinx.errors import ExtensionError
from sphinx.util.docutils import SphinxDirective

_folders: dict[str, tempfile.TemporaryDirectory[str]] = {}


class File(SphinxDirective):
    """Show a file and write it to the folder of the page: the argument is its name."""

    has_content = True
    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Write the file and return the block that shows it, under its name."""
        name, text = self.arguments[0], "\n".join(self.content) + "\n"
        (_folder(self.env.docname) / name).write_text(text, encoding="utf-8")
        block = nodes.literal_block(text, text, language=Path(name).suffix.removeprefix("."))
        return [container_wrapper(self, block, name)]


class Run(SphinxDirective):
    """Show a command, run in the folder of the page, with what it prints."""

    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        "status": directives.nonnegative_int,
        "figure": directives.unchanged_required,
        "alt": directives.unchanged_required,
        "head": directives.positive_int,
        "needs": directives.unchanged_required,  # programs, without which it is shown, not run
    }

    def run(self) -> list[nodes.Node]:
        """Run the command and return the block that shows it, and the figure it drew."""
        command = "\n".join(self.content)
        typed = "\n".join(_as_typed(command))
        missing = [p for p in self.options.get("needs", "").split() if not shutil.which(p)]
        if missing:
            text = (
                f"{typed}\n(not run when this page was built: {', '.join(missing)} not installed)"
            )
            return [nodes.literal_block(text, text, language="console")]
        folder = _folder(self.env.docname)
        status, printed = ran(command, folder)
        wanted = self.options.get("status", 0)
        if status != wanted:
            raise ExtensionError(
                f"{self.env.docname}:{self.lineno}: `{command}` ended with {status}, "
                f"not {wanted}:\n{printed}"
            )
        shown = printed.splitlines()
        if "head" in self.options and len(shown) > self.options["head"]:
            shown = [*shown[: self.options["head"]], "..."]
        text = "\n".join([typed, *(line.rstrip() for line in shown)])
        result: list[nodes.Node] = [nodes.literal_block(text, text, language="console")]
        if "figure" in self.options:
            name = f"{self.env.docname.replace('/', '-')}-{self.options['figure']}"
            shutil.copy(folder / self.options["figure"], Path(self.env.srcdir, "generated", name))
            uri = os.path.relpath(f"generated/{name}", Path(self.env.docname).parent)
            result.append(nodes.image(uri=uri, alt=self.options["alt"]))
        return result


def _as_typed(command: str) -> list[str]:
    """Put the prompts of a shell before the lines of a command, long ones broken at an option."""
    lines = [part for line in command.splitlines() for part in _broken(line)]
    continues = [False, *(line.endswith("\\") for line in lines)]
    return [("> " if rest else "$ ") + line for rest, line in zip(continues, lines, strict=False)]


def _broken(line: str, columns: int = 78) -> list[str]:
    """Break a line of the shell before its options, where it would be longer."""
    first, *options = re.split(r" (?=--)", line)
    parts = [first]
    for option in options:
        if len(parts[-1]) + len(option) < columns:
            parts[-1] += f" {option}"
        else:
            parts[-1:] = [f"{parts[-1]} \\", f"    {option}"]
    return parts


def _folder(page: str) -> Path:
    if page not in _folders:
        _folders[page] = tempfile.TemporaryDirectory(prefix="hoverproof-docs-")
    return Path(_folders[page].name)


def setup(app: Any) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("file", File)
    app.add_directive("run", Run)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
