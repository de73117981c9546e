from __future__ import annotations

import os

import pytest
from hypothesis import settings

from hoverproof.mission import Mission, load

settings.register_profile("ci", derandomize=True)  # the same examples each time, unlike at a desk
settings.load_profile("ci" if os.environ.get("CI") else "default")


@pytest.fixture(scope="session")
def x4() -> Mission:
    return load("x4-flyer")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
