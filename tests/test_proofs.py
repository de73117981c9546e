"""The shipped certificates: accepted, and the same as what the presets give today."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import defaultdict
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from hoverproof import checker
from hoverproof.mission.presets import presets
from hoverproof.mission.reading import load
from hoverproof.paper.conditions import printed_demands
from hoverproof.simulation.flight import simulate
from once import attraction_once, start_or_ball_once

PROOFS = Path(__file__).parents[1] / "proofs"
sys.path.append(str(PROOFS))

import make  # noqa: E402 - the script of `make proofs`

ENDINGS = ("cert", "region.cert", "over-box.cert", "attraction.cert")
EXAMPLE = "half-kilo.attraction.cert.json"
FILES = sorted(PROOFS.glob("*.json"))


def test_every_preset_has_its_proofs_and_the_example_its_own():
    names = {f.name for f in FILES}
    assert names == {*(f"{n}.{e}.json" for n in presets() for e in ENDINGS), EXAMPLE}


@pytest.mark.slow
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_a_shipped_certificate_is_accepted(path):
    done = subprocess.run(
        [sys.executable, "-I", "-S", checker.__file__, path], capture_output=True, check=False
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_a_shipped_certificate_is_about_the_mission_of_today(path):
    about = [n for n in presets() if path.name.startswith(f"{n}.")] or [make.EXAMPLE]
    mission = load(about[0])
    assert json.loads(path.read_text())["mission"] == mission.exact()


def test_shipped_certificates_of_a_kind_and_a_law_are_of_one_graph():
    """One that was left behind when the others were made anew would be of another."""
    graphs = defaultdict(set)
    for path in FILES:
        content = json.loads(path.read_text())
        graphs[content["kind"], repr(content["mission"].get("law"))].add(content["model_sha256"])
    assert [len(found) for found in graphs.values()] == [1] * len(graphs)
    assert len(graphs) >= 6


MADE = ["x4-flyer", "x4-flyer-tuned", "half-kilo", "crazyflie-2.1", "racer-250", "research-1.5kg"]
"""CI makes the first three anew: each kind of certificate and of region is among them."""


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [*MADE[:3], *(pytest.param(n, marks=pytest.mark.whole) for n in MADE[3:])]
)
def test_the_proofs_made_today_are_the_shipped_ones(name, monkeypatch):
    monkeypatch.setattr(make, "attraction", attraction_once)
    monkeypatch.setattr(make, "start_or_ball", start_or_ball_once)
    if name in presets():
        make.certificates(name, Path.cwd())
    else:
        make.every_vehicle(Path.cwd())
    made = sorted(Path.cwd().glob("*.json"))
    assert [p.name for p in made] == [p.name for p in FILES if p.name.startswith(f"{name}.")]
    for path in made:
        old, new = (json.loads(p.read_text()) for p in (PROOFS / path.name, path))
        same = ("kind", "mission", "mission_sha256", "goal_position")
        for key in (*same, *({"weights"} & old.keys())) if "region" in old else same:
            assert new[key] == old[key], (path.name, key)
        for key in ("box", "eigenvalues") if "region" in old else ():
            assert new["region"][key] == old["region"][key], (path.name, key)
        if "margin" in old.get("claim", {}):
            margins = [Fraction(c["claim"]["margin"]) for c in (old, new)]
            assert abs(margins[0] - margins[1]) < margins[0] / 10**6
        if "reach" in old.get("claim", {}):  # solvers differ a little from machine to machine
            for way, far in old["claim"]["reach"].items():
                again = Fraction(new["claim"]["reach"][way])
                assert abs(again - Fraction(far)) < Fraction(far) / 50, (path.name, way)


def test_what_is_made_anew_is_all_there_is():
    assert {*MADE} == {*presets(), load(make.EXAMPLE).name}


def test_the_printed_conditions_are_reported_with_their_numbers(x4):
    demands = {d.name: d for d in printed_demands(x4, x4.bounds.eigenvalues)}
    assert demands["k3"].limit == pytest.approx(8416875)
    assert [name for name, d in demands.items() if not d.met] == ["k3"]
    start = simulate(x4, duration=1)["lyapunov"].values[0]
    assert demands["L(0)"].value == pytest.approx(start)
    assert demands["k1"].limit == pytest.approx(np.sqrt(2 * 94.08 * 12 / np.sqrt(11) / 10))
    assert "not met" in demands["k3"].text()
