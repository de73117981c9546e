"""What is released: a wheel that works alone, a whole sdist, and a public API that is typed."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from importlib.metadata import distribution, distributions
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement

import hoverproof

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src/hoverproof"
CONSUMER = """
from pathlib import Path

import xarray

import hoverproof as hp

mission = hp.load("x4-flyer", {"gains.k4": "4"})
verdict = hp.certify(mission)
if verdict.status == "proved":
    verdict.certificate.save(Path("c.json"))
    theorem: str = hp.check("c.json")
    flight: xarray.Dataset = hp.simulate(mission, duration=1.0)
    manifest = hp.export_c(mission, Path("firmware"), precision="float64")
    print(sorted(manifest), hp.atlas(mission).attrs["mission"])
region = hp.attraction(mission, starts=())
if isinstance(region, hp.Attraction):
    print(float(region.reach.sideways))
elif isinstance(region, hp.Exponential):
    print(float(region.settling.time))
tuned = hp.tune(mission, objective="decay")
print(hp.simulate_batch(mission, Path("flights.nc"), runs=2).runs_complete)
names: list[str] = hp.presets()
for judgement in hp.derive(["31"]):
    print(judgement.id, judgement.verdict, judgement.reason)
try:
    hp.load("nothing")
except hp.InputError as error:
    print(error.where, error.key, error.reason)
print(hp.__version__.upper(), float(mission.vehicle.mass))
"""


def run(*command, **options):
    done = subprocess.run(
        [str(c) for c in command], capture_output=True, text=True, check=False, **options
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


WRONG = {
    "hp.certifi(hp.load('x4-flyer'))": 'no attribute "certifi"',
    "hp.certify(9.6)": 'incompatible type "float"',
    "hp.simulate('x4-flyer', duration='1 s')": 'incompatible type "str"',
    "x: int = hp.presets()": "Incompatible types in assignment",
}


@pytest.mark.slow
def test_a_consumer_of_the_public_names_passes_strict_typing_and_each_misuse_is_found():
    Path("consumer.py").write_text(CONSUMER)
    Path("wrong.py").write_text("\n".join(["import hoverproof as hp", *WRONG]))
    mypy = [sys.executable, "-m", "mypy", "--strict", "--config-file", os.devnull]
    files = ["consumer.py", "wrong.py"]
    found = subprocess.run([*mypy, *files], capture_output=True, text=True, check=False).stdout
    for line, complaint in enumerate(WRONG.values(), start=2):
        assert re.search(rf"wrong.py:{line}: error: .*{re.escape(complaint)}", found), found
    assert f"Found {len(WRONG)} errors in 1 file (checked 2 source files)" in found


def test_the_version_is_semantic_and_stands_in_one_place():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert re.fullmatch(r"\d+\.\d+\.\d+(-[0-9A-Za-z.-]+)?", hoverproof.__version__)
    assert project["project"]["dynamic"] == ["version"]
    assert project["tool"]["hatch"]["version"]["path"] == "src/hoverproof/version.py"
    assert "version" not in yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def test_the_citation_has_what_its_format_asks_for():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert citation["cff-version"] == "1.2.0"
    assert citation["type"] == "software"
    assert citation["message"]
    assert citation["authors"]
    assert citation["title"].startswith("hoverproof")
    assert citation["license"] == project["license"]
    assert set(citation["keywords"]) == set(project["keywords"])


def test_what_CONTRIBUTING_names_exists():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    paths = re.findall(
        r"`((?:src|tests|docs|benchmarks|derivations|proofs|notebooks)/[^`]*)`", text
    )
    assert len(paths) > 10
    for path in paths:
        assert (ROOT / path).exists(), path
    targets = re.findall(r"(?m)(?:^|`)make ([a-z]+)", text)
    assert {"lint", "quick", "test"} <= set(targets)
    for target in targets:
        assert re.search(rf"^{target}:", makefile, flags=re.M), target


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Build the sdist, and the wheel from it."""
    folder = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, ROOT)
    (sdist,) = folder.glob("*.tar.gz")
    (wheel,) = folder.glob("*.whl")
    return sdist, wheel


@pytest.mark.slow
def test_the_wheel_holds_every_file_of_the_package_and_nothing_else(built):
    with zipfile.ZipFile(built[1]) as wheel:
        names = {n for n in wheel.namelist() if ".dist-info/" not in n}
        metadata = wheel.read(f"hoverproof-{hoverproof.__version__}.dist-info/METADATA").decode()
        licences = [n for n in wheel.namelist() if n.endswith("licenses/LICENSE")]
    files = [p for p in PACKAGE.rglob("*") if p.is_file() and "__pycache__" not in p.parts]
    coq = {name for name in names if name.startswith("hoverproof/coq/")}
    listed = (ROOT / "proofs" / "coq" / "_CoqProject").read_text().split()[3:]
    assert {f"hoverproof/coq/{name}" for name in ("_CoqProject", "literals.py", *listed)} <= coq
    assert not {name for name in coq if Path(name).suffix in (".vo", ".glob")}
    assert names - coq == {p.relative_to(PACKAGE.parent).as_posix() for p in files}
    assert {"hoverproof/py.typed", "hoverproof/checker.py"} <= names
    assert f"Version: {hoverproof.__version__}\n" in metadata
    assert licences


@pytest.mark.slow
def test_the_sdist_is_whole(built):
    with tarfile.open(built[0]) as sdist:
        names = {name.split("/", 1)[1] for name in sdist.getnames() if "/" in name}
    wanted = "LICENSE CHANGELOG.md CONTRIBUTING.md CITATION.cff README.md Makefile pyproject.toml"
    assert {*wanted.split(), "tests/conftest.py", "proofs/x4-flyer.cert.json"} <= names


def needed(names):
    """Yield the installed distributions that those named require, themselves, and so on."""
    seen, left = set(), [Requirement(name) for name in names]
    while left:
        wanted = left.pop()
        for extra in ("", *wanted.extras):
            if (wanted.name, extra) not in seen:
                seen.add((wanted.name, extra))
                found = distribution(wanted.name)
                yield found
                further = map(Requirement, found.requires or ())
                left += [r for r in further if not r.marker or r.marker.evaluate({"extra": extra})]


def link(found, folder):
    """Put links to the files of a distribution into a folder, to each of its folders one."""
    for part in {file.parts[0] for file in found.files} - {"..", "__pycache__"}:
        if not (folder / part).is_symlink():
            (folder / part).symlink_to(found.locate_file(part))


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("by", ["links", pytest.param("pip", marks=pytest.mark.whole)])
def test_the_wheel_works_alone_in_an_empty_environment(by, built, tmp_path):
    """Install it with what it requires and nothing else, and run it away from the checkout.

    In `make trials` pip installs all, as pipx does; else what is required is linked from here.
    """
    venv.create(tmp_path / "venv")
    home, work = tmp_path / "venv" / "bin", tmp_path / "work"
    work.mkdir()
    pip = (sys.executable, "-m", "pip", "--python", home / "python", "--disable-pip-version-check")
    alone = () if by == "pip" else ("--no-deps",)
    run(*pip, "install", "--quiet", "--no-compile", *alone, built[1])
    if by == "links":
        (site,) = (tmp_path / "venv" / "lib").glob("python*/site-packages")
        (own,) = distributions(name="hoverproof", path=[str(site)])
        plain = [r for r in own.requires if "extra ==" not in r]
        for found in needed(plain):
            link(found, site)
    names = {"PYTHONPATH", "VIRTUAL_ENV"}
    options = {"cwd": work, "env": {k: v for k, v in os.environ.items() if k not in names}}

    def hoverproof_(*arguments):
        return json.loads(run(home / "hoverproof", *arguments, "--json", **options))

    assert "x4-flyer" in hoverproof_("presets")["presets"]
    assert hoverproof_("certify", "x4-flyer")["verdict"] == "proved"
    assert hoverproof_("check", "x4-flyer.cert.json")["accepted"] is True
    assert hoverproof_("simulate", "x4-flyer", "--duration", "20")["outcome"] == "flown"
    exported = hoverproof_("export", "x4-flyer", "--out", "firmware")
    assert exported["certified"] is True
    assert (work / "firmware" / "x4_flyer.c").exists()
    slow = ("attraction", "atlas", "region")
    reported = hoverproof_("report", "x4-flyer", *(f"--without={part}" for part in slow))
    assert set(reported["missing"]) == set(slow)
    assert (work / reported["out"]).stat().st_size == reported["bytes"]
    assert hoverproof_("new", "mine.toml")["out"] == "mine.toml"
    assert hoverproof_("certify", "mine.toml")["verdict"] == "proved"
    place = run(home / "python", "-c", "import hoverproof; print(hoverproof.__file__)", **options)
    assert place.startswith(str(tmp_path))
    template = "from hoverproof.cli.interview import interview as i; i({}, lambda _: '')"
    assert "Your vehicle" in run(home / "python", "-c", template, **options)
