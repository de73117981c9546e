"""Pages that are made from the program itself, so that they cannot tell anything else.

The commands from their help, the keys of a mission file from its models, the ledger of the paper
from the judge, and the notebooks as they are kept.
"""

from __future__ import annotations

import importlib
import inspect
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, get_args
from unittest import mock

from pydantic import BaseModel, BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from hoverproof.cli import console
from hoverproof.mission.presets import preset_text
from hoverproof.mission.sections import Mission
from hoverproof.reporting.symbols import SYMBOLS

ROOT = Path(__file__).parents[1]
HUGE = 10**300
NO_KEYS = {"products"}  # of inertia: an entry of a matrix, not a key
NOTEBOOKS = """
Executed, with their outputs. Each is made from a script in `derivations/` or `examples/` of a
checkout, which runs by itself too, as `python derivations/01_rigid_body.py`. They need nothing but
hoverproof; two examples that need more say so. To learn the theory, begin with *The rigid body*; to
see what the program does, with *Certify your own quadrotor*.
""".strip()


def write(source: Path) -> None:
    """Write all generated pages below the folder of the documentation.

    Parameters
    ----------
    source : Path
        The folder of ``conf.py``; pages go to ``generated/`` in it.
    """
    folder = source / "generated"
    folder.mkdir(exist_ok=True)
    pages = {
        "commands.md": commands(),
        "mission-file.md": mission_file(),
        "ledger.md": ledger(),
        "notebooks.md": notebooks(),
        "internals.md": internals(documented=(source / "reference" / "api.md").read_text("utf-8")),
    }
    for name, text in pages.items():
        _write_if_changed(folder / name, text)
    for notebook in sorted((ROOT / "notebooks").rglob("*.ipynb")):
        _write_if_changed(folder / notebook.name, notebook.read_text(encoding="utf-8"))


def commands() -> str:
    """Return the reference of the commands, from the help of each, and of their symbols."""
    with mock.patch.object(sys, "argv", ["hoverproof"]):  # else the usage names this build
        text = console.app.generate_docs(output_format="markdown")
    _, *sections = re.split(r"(?m)^## hoverproof ", text)
    parts = ["# Commands", _examples_as_code(console.app.help), str(console.app.help_epilogue)]
    for section in sorted(sections, key=lambda section: section.startswith("-")):
        name, body = section.split("\n", 1)
        name = name.strip()
        title = f"`{name}`" if name.startswith("-") else name
        parts.append(f"(command-{name})=\n## {title}\n{_examples_as_code(body)}")
    meanings = [(symbol, _plain(means)) for symbol, means in SYMBOLS.items()]
    parts += ["(symbols)=\n## Symbols of the answers", _table(("symbol", "meaning"), meanings)]
    return "\n\n".join(parts) + "\n"


def mission_file() -> str:
    """Return the reference of the mission file, from the models that read it."""
    parts = [
        "# Mission file",
        "A mission is one TOML file. Numbers are read as exact decimals and stay exact. A key that "
        "is unknown, missing or impossible is refused with one line that names the file, the key, "
        "the value and what would be right. How to write one: {doc}`../how-to/write-a-mission`.",
    ]
    for name, field, model in _sections(Mission):
        optional = "" if field.is_required() else " (may be left out)"
        parts.append(f"## [{name}]{optional}")
        words, meanings = _attributes(model.__doc__ or "")
        parts.append(_line(words))
        head: tuple[str, ...] = ("key", "accepted", "if left out")
        rows: list[tuple[str, ...]]
        keys = {key: f for key, f in model.model_fields.items() if key not in NO_KEYS}
        rows = [(f"`{key}`", *_accepted(model, key, f)) for key, f in keys.items()]
        if meanings:
            head += ("meaning",)
            rows = [(*row, meanings[key]) for row, key in zip(rows, keys, strict=True)]
        parts.append(_table(head, rows))
    parts.append("## A complete file\n\nThis is the preset `x4-flyer`, as `hoverproof presets")
    parts[-1] += " x4-flyer` prints it.\n\n```toml\n" + preset_text("x4-flyer") + "```"
    return "\n\n".join(parts) + "\n"


def ledger() -> str:
    """Return the paper's claims with their verdicts, as `hoverproof derive` prints them.

    It prints a table with a row for each claim; on a page a section for each reads better.
    """
    done = subprocess.run(
        [sys.executable, "-m", "hoverproof", "derive", "--format", "markdown"],
        capture_output=True,
        text=True,
        check=True,
    )
    rows = [re.split(r"(?<!\\)\|", line)[1:-1] for line in done.stdout.splitlines()[2:]]
    claims = [[cell.strip().replace(r"\|", "|") for cell in row] for row in rows]
    counts = Counter(verdict for _, _, verdict, *_ in claims)
    parts = [
        "# The paper, judged",
        "The controller is that of Hamel and Mahony (2004). Its equations and claims are judged "
        "one by one, as printed, against what is derived from the rigid body and the image: exact "
        "identities of rational functions with every parameter symbolic, and units checked beside "
        "them. This page was made by `hoverproof derive --format markdown` when it was built.",
        f"{len(claims)} claims: " + ", ".join(f"{n} {v}" for v, n in counts.items()) + ".",
    ]
    for name, title, verdict, reason, *forms in claims:
        name = f"Eq. {name}" if name.isdigit() else _plain(name)
        parts.append(f"## {name}: {_plain(title)}\n\n**{verdict}**: {_plain(reason)}")
        for kind, form in zip(("printed", "derived"), forms, strict=True):
            if form:
                parts.append(f"{kind}\n\n$${form.strip('$')}$$")
    return "\n\n".join(parts) + "\n"


def notebooks() -> str:
    """Return the list of notebooks for the table of contents."""
    steps = sorted(p.stem for p in (ROOT / "notebooks").glob("*.ipynb"))
    examples = sorted(p.stem for p in (ROOT / "notebooks" / "examples").glob("*.ipynb"))
    parts = ["# Notebooks", NOTEBOOKS]
    for title, group in (("Worked examples", examples), ("The derivation", steps)):
        parts.append(f"## {title}\n\n```{{toctree}}\n:maxdepth: 1\n\n" + "\n".join(group) + "\n```")
    return "\n\n".join(parts) + "\n"


def internals(documented: str) -> str:
    """Return the reference of all modules that the page of the public interface leaves out.

    Parameters
    ----------
    documented : str
        That page.
    """
    parts = ["# Inside", "Every module, from the algebra up to the figures. Imports run downward."]
    group = ""
    for path in sorted((ROOT / "src" / "hoverproof").rglob("*.py")):
        names = path.relative_to(ROOT / "src").with_suffix("").parts
        module = ".".join(names).removesuffix(".__init__")
        in_public = re.search(rf"automodule:: {re.escape(module)}$", documented, flags=re.M)
        if in_public or names[1] in {"cli", "__main__", "__init__"}:
            continue
        if names[-1] == "__init__":
            text = importlib.import_module(module).__doc__ or ""
            parts.append(f"## {module}\n\n{text}")
            group = module
            continue
        title = f"{'###' if group and module.startswith(group) else '##'} {module}"
        parts.append(f"{title}\n\n```{{eval-rst}}\n.. automodule:: {module}\n```")
    return "\n\n".join(parts) + "\n"


def _attributes(docstring: str) -> tuple[str, dict[str, str]]:
    """Split a docstring into its words and the meaning of each attribute."""
    words, _, section = inspect.cleandoc(docstring).partition("Attributes\n----------\n")
    meanings: dict[str, str] = {}
    for entry in re.split(r"\n(?=\S)", section):
        names, *lines = entry.splitlines() or [""]
        for key in names.split(" : ")[0].split(", "):
            meanings[key] = _plain(_line(" ".join(lines)))
    return words, meanings if section else {}


def _accepted(model: type[BaseModel], key: str, field: FieldInfo) -> tuple[str, str]:
    """Return what a key accepts, in the words of its own refusals, and its default."""
    words = dict.fromkeys(_refusals(model, key, field))
    default = "must be given"
    if field.default is not PydanticUndefined:
        default = "" if field.default is None else _shown(field.default)
    found = "; ".join(words) or ("a section of its own" if _model_of(field) else "see above")
    return found, default


def _refusals(model: type[BaseModel], key: str, field: FieldInfo) -> Iterator[str]:
    """Yield what the validators of a key ask for: of the whole, then of a number in it."""
    for validator in _validators((field.annotation, *field.metadata)):
        for value in (None, HUGE):
            try:
                validator.func(value)  # type: ignore[call-arg]
            except Exception as error:
                said = re.match(r"must be (?:a )?(.*), not .*", str(error))
                if said and not said[1].startswith("number"):
                    yield said[1].replace("[", r"\[")


def _validators(annotations: Any) -> Iterator[BeforeValidator]:
    """Yield the validators in annotations, at any depth, the outermost first."""
    for annotation in annotations:
        if isinstance(annotation, BeforeValidator):
            yield annotation
    for annotation in annotations:
        yield from _validators(get_args(annotation))


def _sections(
    model: type[BaseModel], prefix: str = ""
) -> Iterator[tuple[str, FieldInfo, type[BaseModel]]]:
    """Yield the name of each section, its field and its model, those within it after it."""
    for key, field in model.model_fields.items():
        inner = _model_of(field)
        if inner is not None:
            yield prefix + key, field, inner
            yield from _sections(inner, f"{prefix}{key}.")


def _model_of(field: FieldInfo) -> type[BaseModel] | None:
    for annotation in (field.annotation, *get_args(field.annotation)):
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            return annotation
    return None


def _examples_as_code(body: str) -> str:
    """Set the line `Example: ...` of a help as a block that can be copied."""
    body = re.sub(r"(?m)^Example: `(.*)`$", r"```sh\n\1\n```", body)
    body = re.sub(r"(?m)^Example: `(.*)` \((.*)\)$", r"```sh\n\1  # \2\n```", body)
    return re.sub(r"(?m)^\*\*Parameters\*\*:", "Options:", body)


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _plain(words: str) -> str:
    """Escape what Markdown would read as markup, outside of code."""
    parts = words.split("`")
    parts[::2] = [re.sub(r"([*_$<|])", r"\\\1", part) for part in parts[::2]]
    return "`".join(parts)


def _shown(value: object) -> str:
    if isinstance(value, BaseModel):
        return "see below"
    if isinstance(value, tuple):
        return r"\[" + ", ".join(map(_shown, value)) + "]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _line(text: str | None) -> str:
    return " ".join((text or "").split())


def _write_if_changed(path: Path, text: str) -> None:
    """Leave a file alone that is right already, so that a second build is quick."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
