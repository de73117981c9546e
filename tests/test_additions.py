"""A kind of certificate, a command and an export target, each added as CONTRIBUTING says.

They are added to a copy of the package. A law is added in `test_law`.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import hoverproof
from hoverproof import checker

NEW = {
    "certification/lightness.py": '''
"""The thrust that a hover surely takes less than."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from hoverproof.certification.certificate import rejection, seal
from hoverproof.certification.verdict import Proved, Undecided
from hoverproof.mission.sections import Mission


@dataclass(frozen=True, kw_only=True, repr=False)
class Light(Proved):
    """A hover takes less than a thrust, N."""

    thrust: Fraction


def light(mission: Mission, thrust: Fraction) -> Light | Undecided:
    """Prove that a hover takes less than a thrust, N."""
    sealed = seal(mission, "light", {"claim": {"thrust": thrust}}, 64 * "0")
    reason = rejection(sealed)
    if reason:
        return Undecided(mission=mission, reason=reason)
    return Light(mission=mission, certificate=sealed, thrust=thrust)
''',
    "cli/answers/light.py": '''
"""What `light` answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from hoverproof.certification.verdict import Verdict
from hoverproof.cli.answers.answer import EXIT, Answer


@dataclass(frozen=True)
class LightAnswer(Answer):
    """What was proved of the hover."""

    verdict: Verdict

    @property
    def status(self) -> int:
        """The exit status."""
        return EXIT[self.verdict.status]

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        yield f"{self.verdict.mission.name}: {self.verdict.status}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {"verdict": self.verdict.status, "reason": self.verdict.reason}
''',
    "cli/lightness.py": '''
"""The command `light`."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.console import Json, MissionName, Set, load_mission


def light(
    mission: MissionName,
    *,
    thrust: Annotated[str, Parameter(help="Of a hover, at most, N.")] = "100",
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Prove that a hover takes less than a thrust.

    Example: `hoverproof light x4-flyer --thrust 99.5`
    """
    from fractions import Fraction

    from hoverproof.certification.lightness import light
    from hoverproof.cli.answers.light import LightAnswer

    loaded = load_mission(mission, set_)
    verdict = light(loaded, Fraction(thrust))
    if verdict.certificate is not None:
        verdict.certificate.save("light.cert.json")
    return tell(LightAnswer(verdict), json_, loaded)
''',
    "export/targets/rover/NAME_rover.h.j2": "/* {{ name }}: {{ options.of_points }} */\n",
    "export/targets/rover/where.md.j2": "## Rover\n\nPut `{{ name }}_rover.h` anywhere.\n",
}
CHAPTER = '''
class Light(Claim):
    """A hover takes less than a thrust."""

    own: ClassVar[dict[str, Any]] = {"claim": {"thrust": positive}}

    def verify(self) -> None:
        """Compare the two."""
        require(self.weight < self.c.claim.thrust, "a hover takes as much, or more")

    def words(self) -> str:
        """Say what is claimed."""
        return f"A hover of {self.name} takes less than {self.c.claim.thrust} N."


'''
KINDS = "KINDS: dict[str, Any] = {\n"
LINES = {
    "checker.py": (
        "KINDS: dict[str, Any] = {\n",
        f'{CHAPTER}KINDS: dict[str, Any] = {{\n    "light": Light,\n',
    ),
    "cli/__init__.py": ("COMMANDS = (\n", 'COMMANDS = (\n    "lightness:light",\n'),
    "export/targets/__init__.py": ("TARGETS = (\n", 'TARGETS = (\n    Target("rover", "Rover"),\n'),
}
"""A line in a list each, with a chapter of the checker above the first."""


@pytest.fixture(scope="module")
def house(tmp_path_factory):
    """Return the folder of a package with all that is new."""
    folder = tmp_path_factory.mktemp("house")
    package = folder / "hoverproof"
    old = Path(hoverproof.__file__).parent
    shutil.copytree(old, package, ignore=shutil.ignore_patterns("__pycache__"))
    for path, text in NEW.items():
        (package / path).parent.mkdir(exist_ok=True)
        (package / path).write_text(text.removeprefix("\n"), encoding="utf-8")
    for path, (before, after) in LINES.items():
        text = (package / path).read_text(encoding="utf-8")
        assert text.count(before) == 1
        (package / path).write_text(text.replace(before, after), encoding="utf-8")
    return folder


@pytest.fixture
def told(house, tmp_path, monkeypatch):
    """Return what runs a command of that package: its status, and what it said."""
    monkeypatch.chdir(tmp_path)

    def run(*words):
        command = [sys.executable, "-m", "hoverproof", *words]
        done = subprocess.run(
            command, env=os.environ | {"PYTHONPATH": str(house)}, capture_output=True, text=True
        )
        return done.returncode, done.stdout + done.stderr

    return run


def test_a_new_command_is_listed_and_answers(told):
    assert "Prove that a hover takes less than a thrust." in told("--help")[1]
    assert "hoverproof light x4-flyer --thrust 99.5" in told("light", "--help")[1]
    status, said = told("light", "x4-flyer", "--thrust", "1", "--json")
    assert (status, json.loads(said)["verdict"]) == (3, "undecided")


def test_a_new_kind_of_certificate_is_proved_checked_and_told_from_a_forgery(told, house):
    assert told("light", "x4-flyer") == (0, "x4-flyer: proved\n")
    status, said = told("check", "light.cert.json", "--mission", "x4-flyer")
    assert (status, "A hover of x4-flyer takes less than 100 N." in said) == (0, True)
    held = json.loads(Path("light.cert.json").read_text())
    with pytest.raises(checker.Rejected, match="unknown kind"):
        checker.check(held)
    del held["sha256"]
    held["claim"]["thrust"], held["statement"] = "1", held["statement"].replace("100 N", "1 N")
    forged = json.dumps(held | {"sha256": checker.digest(held)})
    Path("forged.json").write_text(forged)
    alone = [sys.executable, "-I", "-S", house / "hoverproof/checker.py", "forged.json"]
    done = subprocess.run(alone, capture_output=True, text=True)
    assert (done.returncode, "rejected: a hover takes as much" in done.stdout) == (1, True)


def test_a_new_export_target_is_in_every_package(told):
    status, said = told("export", "x4-flyer", "--out", "fw")
    assert status == 0, said
    manifest = json.loads(Path("fw/manifest.json").read_text())
    name = f"adapters/rover/{manifest['name']}_rover.h"
    assert name in manifest["files"]
    assert Path("fw", name).read_text().startswith(f"/* {manifest['name']}: ")
    assert (
        f"## Rover\n\nPut `{manifest['name']}_rover.h`" in Path("fw/adapters/README.md").read_text()
    )
