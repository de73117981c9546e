"""The proof assistant's library builds, replays certificates of gains, and rejects forged ones."""

from __future__ import annotations

import contextlib
import copy
import importlib.util
import json
import os
import random
import shutil
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from firmware_kit import tool
from hoverproof import checker
from hoverproof.certification import replay
from hoverproof.certification.gains import certify
from hoverproof.mission.reading import load

PROOFS = Path(__file__).parents[1] / "proofs"
pytestmark = [pytest.mark.slow]
WORSE = {
    "mass": ("3/2",),
    "k": ("3/2", "3/2", "1/2", "1/2"),
    "weights": ("2", "2", "2", "2"),
    "low": ("1/2",),
    "high": ("11/10",),
    "thrust": ("9/10", "11/10"),
    "box": ("1001/1000", "1001/1000", "1001/1000"),
    "factor": ("101/100", "99/100"),
    "margin": ("1001/1000",),
    "multipliers": ("3", "3"),
}
"""By what each number of a certificate is multiplied so that it claims more than is shown."""


@pytest.fixture(scope="module")
def literals():
    spec = importlib.util.spec_from_file_location("literals", PROOFS / "coq" / "literals.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["literals"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def library(tmp_path_factory, whole):
    """A copy of the library, built, and what its build says of the certificates shipped.

    Of gains of two presets; with `make trials` of all, and of vehicles within tolerances too.
    """
    tool("coqc")
    folder = tmp_path_factory.mktemp("proofs") / "coq"
    shutil.copytree(PROOFS / "coq", folder, ignore=shutil.ignore_patterns("*.vo*", "*.glob"))
    shutil.copy(checker.__file__, folder.parent)
    for path in shipped(whole):
        shutil.copy(path, folder.parent)
    return folder, make(folder)


def shipped(whole):
    """Return certificates: all, or those of gains of two presets with other laws."""
    found = sorted(PROOFS.glob("*.cert.json"))
    few = ("x4-flyer.", "racer-250.")
    return [p for p in found if whole or (p.name.startswith(few) and kind_of(p) == "gains")]


def kind_of(path):
    return json.loads(path.read_text(encoding="utf-8"))["kind"]


def make(folder, *targets):
    command = ["make", "-C", str(folder), *targets]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stdout + made.stderr
    return made.stdout


@pytest.fixture(scope="module")
def kept(library, tmp_path_factory):
    """A cache folder that holds the library as `check --coq` would have built it."""
    cache = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(cache))
        folder = replay.library_folder(PROOFS / "coq")
    folder.parent.mkdir(parents=True)
    folder.symlink_to(library[0], target_is_directory=True)
    return cache


def checked(certificate, cache, *options):
    """Return the status of `check --coq`, and what it says."""
    command = [sys.executable, "-m", "hoverproof", "check", str(certificate), "--coq", *options]
    env = {**os.environ, "XDG_CACHE_HOME": str(cache)}
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def test_check_has_coq_decide_a_certificate_and_says_what_it_covers(kept):
    status, out, err = checked(PROOFS / "x4-flyer.over-box.cert.json", kept, "--json")
    coq = json.loads(out)["coq"]
    assert status == 0, err
    assert coq["refused"] is None
    assert [words.split(":")[0] for words in coq["shown"]] == [
        "gains_sound",
        "lyapunov_decays",
        "target_sound",
    ]
    assert "over the box, and at the goal, is left to checker.py" in coq["left"]


def test_check_says_of_a_kind_that_coq_does_not_know_it(kept):
    status, out, err = checked(PROOFS / "x4-flyer.region.cert.json", kept)
    assert status == 3, err
    assert "Coq: not covered" in out
    assert "Not by Coq: " in out


def test_check_says_what_coq_does_not_find_true(kept, monkeypatch):
    """Had the checker a mistake, and let a margin pass that is not proved."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(kept))
    content = json.loads((PROOFS / "x4-flyer.cert.json").read_text())
    content["claim"]["margin"] = str(2 * Fraction(content["claim"]["margin"]))
    said = []
    found = replay.replay(content, said.append)
    assert (found.shown, found.refused) == ((), "gains")
    assert said == ["Coq decides the certificate"]


def test_check_says_where_coq_is_missing(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    status, out, err = checked(PROOFS / "x4-flyer.cert.json", tmp_path)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert "--coq: needs the proof assistant Coq" in err


def gains_of(literals, name):
    return literals.Gains(json.loads((PROOFS / name).read_text()), name)


def test_it_replays_every_certificate_that_is_shipped_of_the_kinds_that_it_knows(library, whole):
    _, said = library
    kinds = [kind_of(path) for path in shipped(whole)]
    assert kinds.count("gains") >= 4
    assert f"Replayed: {kinds.count('gains')} certificates of gains" in said
    assert f"the matrices of {kinds.count('attraction')} of regions" in said
    assert f"those of {kinds.count('exponential')} of vehicles" in said


def test_nothing_is_admitted_and_the_axioms_are_those_of_the_real_numbers(library):
    _, said = library
    allowed = (PROOFS / "coq" / "allowed.txt").read_text().split()
    assert said.split("real numbers:")[1].split()[: len(allowed)] == allowed


OTHERS = [
    ({"bounds": "{eigenvalues = [0.01, 5], level = 20}"}, "level_sound"),
    ({"target.weights": "[1, 2, 1, 2]"}, "target_sound"),
    ({"goal": "{centroid = [0.1, -0.2, 3.5]}"}, "given_sound"),
    ({"law": '{feature = "centroid", goal = "inertial", force = "measured"}'}, "given_sound"),
]


def test_it_replays_levels_weights_goals_by_centroid_and_other_laws(library, literals, tmp_path):
    """Each names the theorem that it is there for, which stands in the library."""
    folder, _ = library
    paths = []
    for number, (settings, theorem) in enumerate(OTHERS):
        verdict = certify(load("x4-flyer", settings))
        said = literals.about(verdict.certificate.content)
        assert any(words.startswith(f"{theorem}: ") for words in said["shown"])
        for words in said["shown"]:
            name = words.partition(":")[0]
            assert any(f"Theorem {name} " in path.read_text() for path in PROOFS.glob("coq/*.v"))
        paths.append(str(tmp_path / f"other{number}.cert.json"))
        verdict.certificate.save(paths[-1])
    made = subprocess.run(
        ["make", "-s", "-C", str(folder), "replay", f"CERTIFICATES={' '.join(paths)}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Replayed: 4 certificates of gains, 4 of them" in made.stdout, made.stderr


def forged(literals, name):
    """Yield a certificate as it is, and with one number changed and the hints as they were."""
    held = gains_of(literals, name)
    hints = held.hints()
    held.hints = lambda: hints
    yield "as it is", held
    for key, factors in WORSE.items():
        for i, factor in enumerate(map(Fraction, factors)):
            other, value = copy.copy(held), getattr(held, key)
            if not isinstance(value, list):
                changed = factor * value
            else:
                part = [factor * x for x in value[i]] if key == "box" else factor * value[i]
                changed = [*value[:i], part, *value[i + 1 :]]
            if changed == value:  # of zero
                continue
            setattr(other, key, changed)
            yield f"{key} {i}", other


def program_says(folder, plain):
    """Return what the extracted program says of each certificate: whether all of it holds."""
    tool("ocamlfind")
    make(folder, "extracted")
    command = [folder / "extracted" / "decide"]
    said = subprocess.run(command, input=plain, capture_output=True, text=True, check=True).stdout
    return ["false" not in line for line in said.splitlines()]


def passing(folder, tried):
    """Return which of certificates with a name pass all that the extracted program decides."""
    passed = program_says(folder, "".join(each.plain() for _, each in tried))
    return [what for (what, _), good in zip(tried, passed, strict=True) if good]


def test_no_certificate_of_gains_passes_with_a_number_for_the_worse(library, literals):
    for name in ("x4-flyer", "x4-flyer-tuned", "x4-flyer.over-box", "racer-250"):
        tried = [*forged(literals, f"{name}.cert.json")]
        assert passing(library[0], tried) == ["as it is"], name


def test_the_extracted_program_decides_every_certificate_of_a_kind_that_it_knows(
    library, literals, whole
):
    """And the start and the settling of vehicles within tolerances with it."""
    paths = sorted(PROOFS.glob("*.cert.json"))
    if not whole:
        paths = [p for p in paths if p.name.startswith("racer-250.")]
    known = [*literals.certificates(map(str, paths))]
    kinds = [kind_of(path) for path in paths]
    assert len(known) == len(kinds) - kinds.count("region")
    assert program_says(library[0], "".join(c.plain() for c in known)) == [True] * len(known)


CLAIMED = {
    "setting": (1, 1, 1, 1, 1, -1),
    "limits": (*[1] * 8, 0, *[-1] * 4, 1, *[-1] * 4, -1),
    "settling": (-1, -1, *[1] * 8),
}
"""Whether each number of a vehicle within tolerances claims more if it is larger, or smaller."""
OF_STARTS = (1, 1, 0, 0, 0, 1, -1, -1, 0)


def claims_more(known, draw):
    """Return a certificate of vehicles within tolerances with a number for the worse, and which."""
    other = copy.copy(known)
    lists = {**{key: (getattr(known, key), ways) for key, ways in CLAIMED.items()}}
    lists["starts"] = (known.starts[0], OF_STARTS)
    places = [(key, i) for key, (_, ways) in lists.items() for i, way in enumerate(ways) if way]
    key, i = draw.choice(places)
    values, ways = lists[key]
    part = Fraction(draw.randint(1, 5), 10 ** draw.randint(1, 3))
    changed = [*values[:i], values[i] * (1 + ways[i] * part), *values[i + 1 :]]
    setattr(other, key, [changed, *known.starts[1:]] if key == "starts" else changed)
    return f"{key} {i} by {part}", other


def test_no_vehicle_within_tolerances_passes_with_a_number_for_the_worse(library, literals, whole):
    """Of bounds, start and settling; with `make trials` 500 of all four presets."""
    presets = ("crazyflie-2.1", "half-kilo", "racer-250", "research-1.5kg")
    draw, tried, names = random.Random(5), [], presets if whole else ("racer-250",)
    for name in names:
        path = PROOFS / f"{name}.attraction.cert.json"
        known = literals.tolerant_of(json.loads(path.read_text()), name)
        hints = known.hints()
        known.hints = lambda hints=hints: hints
        tried += [("as it is", known), *of_matrices(known)]
        tried += [claims_more(known, draw) for _ in range(125 if whole else 12)]
    assert passing(library[0], tried) == ["as it is"] * len(names)


def of_matrices(known):
    """Yield a higher rate, a larger ball, and more torque, with bounds as they were."""
    changes = {"constants": (9, 10), "ball": (1, Fraction(3, 2)), "radii": (0, 3)}
    for key, (place, by) in changes.items():
        other = copy.copy(known)
        value = [*getattr(known, key)]
        value[place] *= by
        setattr(other, key, value)
        yield key, other


def test_no_region_of_attraction_passes_with_a_number_for_the_worse(library, literals):
    for name in ("x4-flyer", "x4-flyer-tuned"):
        path = PROOFS / f"{name}.attraction.cert.json"
        held = literals.Region(json.loads(path.read_text()), name)
        hints, tried = held.hints(), []
        held.hints = lambda hints=hints: hints
        for key in (None, "high", "rate", "tilt", "weights", "factor", "goal", "multipliers"):
            other = copy.copy(held)
            if key:
                value, more = getattr(held, key), Fraction(1001, 1000)
                worse = [*(2 * x for x in value)] if isinstance(value, list) else value * more
                setattr(other, key, worse)
            tried.append((key, other))
        assert passing(library[0], tried) == [None], name


def mutants(content, draw, count):
    """Yield what is changed and a certificate with that changed, sealed and worded anew."""
    for _ in range(count):
        mutant = copy.deepcopy(content)
        vertices, hints = mutant["vertices"], mutant["enclosures"]
        by = 1 + Fraction(draw.choice((-1, 1)) * draw.randint(1, 99), 10 ** draw.randint(2, 20))
        what = draw.choice(["weights", "margin", "multiplier", "factor", "centroid"])
        side = draw.randrange(2)
        if what == "weights":
            i = draw.randrange(4)
            mutant["weights"][i] = str(by * Fraction(mutant["weights"][i]))
        elif what == "margin":
            margin = by * Fraction(mutant["claim"]["margin"])
            rate = 2 * margin / Fraction(mutant["mission"]["vehicle"]["mass"])
            for part in (mutant["claim"], *vertices):
                part["margin"], part["decay_rate"] = str(margin), str(rate)
        elif what == "multiplier":
            vertices[side]["multiplier"] = str(by * Fraction(vertices[side]["multiplier"]))
        elif what == "factor":
            hints["factor"][side] = str(by * Fraction(hints["factor"][side]))
            vertices[side]["factor"] = hints["factor"][side]
        else:
            hints["centroid"][2][side] = str(by * Fraction(hints["centroid"][2][side]))
        with contextlib.suppress(checker.Rejected):  # as it cannot even be read
            mutant["statement"] = checker.statement(mutant)
        seal = {key: value for key, value in mutant.items() if key != "sha256"}
        yield what, {**mutant, "sha256": checker.digest(seal)}


def accepted(content):
    try:
        checker.check(content)
    except checker.Rejected:
        return False
    return True


def test_the_extracted_program_agrees_with_the_checker(library, literals, whole):
    """On 50 mutants of the paper's certificate, and with `make trials` on 5,000."""
    content = json.loads((PROOFS / "x4-flyer.cert.json").read_text())
    for vertex in content["vertices"]:  # the program knows one margin
        vertex |= content["claim"]
    tried = [*mutants(content, random.Random(20), 5000 if whole else 50)]
    plain = "".join(literals.Gains(each, what).plain() for what, each in tried)
    found = program_says(library[0], plain)
    expected = [accepted(each) for _, each in tried]
    for (what, _), mine, checkers in zip(tried, found, expected, strict=True):
        # the program bounds f over the box of q*, the checker over what it knows of q*
        assert mine == checkers or (what == "centroid" and checkers)
    assert 0.1 * len(tried) < sum(expected) < 0.9 * len(tried)
