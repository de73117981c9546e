from __future__ import annotations

import pytest

from hoverproof.mission import Mission, load


@pytest.fixture(scope="session")
def x4() -> Mission:
    return load("x4-flyer")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
