"""Templates compiled on this machine: filled as if compiled anew, and never in the way."""

from __future__ import annotations

import jinja2
import pytest

from hoverproof.templates import templates

NAME = "templates/firmware.h.j2"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "hoverproof"


@pytest.fixture
def compiled(monkeypatch):
    """Return the names of the templates that were compiled so far."""
    names, compile = [], jinja2.Environment.compile

    def noted(environment, source, name, filename):
        names.append(name)
        return compile(environment, source, name, filename)

    monkeypatch.setattr(jinja2.Environment, "compile", noted)
    return names


def code(**options):
    """Return the code of a template, as another process finds it."""
    template = templates("hoverproof.export", ".", **options).get_template(NAME)
    return template.root_render_func.__code__


def test_a_template_is_compiled_once_on_a_machine(compiled):
    assert code() == code()
    assert compiled == [NAME]


def test_with_other_options_it_is_another_template(compiled):
    assert code(trim_blocks=True) != code()
    assert compiled == [NAME, NAME]


@pytest.mark.parametrize("damage", ["cut", "changed", "folder"])
def test_a_damaged_file_is_ignored_and_made_good(compiled, folder, damage):
    own = code()
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    if damage == "folder":
        path.unlink()
        path.mkdir()
    else:
        middle = len(whole) // 2
        changed = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
        path.write_bytes({"cut": whole[:-3], "changed": changed}[damage])
    assert code() == own and compiled == [NAME, NAME]
    assert damage == "folder" or path.read_bytes() == whole


def test_where_nothing_can_be_written_it_is_compiled(compiled, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file" / "in between"))
    assert code() == code()
    assert compiled == [NAME, NAME]
