from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from hoverproof.mission.reading import load
from hoverproof.mission.sections import Mission
from sharing import share

BUSY = [HealthCheck.too_slow]  # a busy machine is no failure
FEW = {"max_examples": 25, "suppress_health_check": BUSY}
settings.register_profile("desk", **FEW)
settings.register_profile("ci", derandomize=True, **FEW)  # the same each time
settings.register_profile("trials", max_examples=400, suppress_health_check=BUSY)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--whole", action="store_true", help="random trials at their full number: make trials"
    )


@pytest.fixture(scope="session")
def whole(request: pytest.FixtureRequest) -> bool:
    """Whether random trials are to run at their full number."""
    return bool(request.config.getoption("whole"))


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A chromium that shows pages."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        if os.environ.get("HOVERPROOF_REQUIRE_TOOLS"):
            pytest.fail("chromium is needed here: tools/install-system-tools.sh")
        pytest.skip("not run: chromium is not installed (tools/install-system-tools.sh)")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        root = os.geteuid() == 0
        options = ["--no-sandbox"] if root else []
        chromium = driver.chromium.launch(executable_path=path, args=options)
        yield chromium
        chromium.close()


def pytest_configure(config: pytest.Config) -> None:
    share()  # before pytest-xdist starts its processes
    usual = "ci" if os.environ.get("CI") else "desk"
    settings.load_profile("trials" if config.getoption("whole") else usual)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Begin with what takes longest, so that no process is left alone with it at the end.

    With `--whole` nothing is run but what is more with it, without it nothing that is only so.
    """
    items.sort(key=lambda item: item.get_closest_marker("long") is None)
    whole = config.getoption("whole")
    wanted = more_if_whole if whole else not_only_whole
    config.hook.pytest_deselected(items=[item for item in items if not wanted(item)])
    items[:] = filter(wanted, items)


def not_only_whole(item: pytest.Item) -> bool:
    """Tell whether a test is run without `--whole`, too."""
    return item.get_closest_marker("whole") is None


def more_if_whole(item: pytest.Item) -> bool:
    """Tell whether a test does more with `--whole`, or is run with it alone."""
    return "whole" in getattr(item, "fixturenames", ()) or not not_only_whole(item)


@pytest.fixture(scope="session")
def x4() -> Mission:
    return load("x4-flyer")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
