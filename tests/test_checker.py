"""The checker: alone with the standard library, it accepts what is true and nothing more."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.mission import load

CHECKER = Path(checker.__file__)


@pytest.fixture(scope="module")
def proved():
    return certify(load("x4-flyer")).certificate.content


@pytest.fixture(scope="module")
def refuted():
    return certify(load("x4-flyer", {"gains.k4": "0.1"})).certificate.content


def run(content, name="x4.cert.json"):
    Path(name).write_text(content if isinstance(content, str) else json.dumps(content))
    return subprocess.run(
        [sys.executable, "-I", "-S", CHECKER, name], capture_output=True, text=True, check=False
    )


def leaves(value, path=()):
    """Yield the path of every string that is a number."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from leaves(entry, (*path, key))
    elif isinstance(value, list):
        for i, entry in enumerate(value):
            yield from leaves(entry, (*path, i))
    elif isinstance(value, str) and path[-1] not in ("sha256", "mission_sha256", "model_sha256"):
        try:
            Fraction(value)
        except ValueError:
            return
        yield path


def changed(content, path, new):
    """Return a copy with one entry changed, hashes and statement made anew as a forger would."""
    forged = copy.deepcopy(content)
    spot = forged
    for key in path[:-1]:
        spot = spot[key]
    spot[path[-1]] = new
    return forged


def forge(content, path, new):
    forged = changed(content, path, new)
    forged["mission_sha256"] = checker.digest(forged["mission"])
    forged["statement"] = checker.statement(forged)
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    return forged


def test_it_runs_without_any_package_and_says_the_theorem(proved):
    done = run(proved)
    assert done.returncode == 0
    assert "x4.cert.json: accepted" in done.stdout
    assert proved["statement"] in " ".join(done.stdout.split())


def test_it_confirms_a_counterexample(refuted):
    done = run(refuted)
    assert done.returncode == 0
    assert "It is not true that" in done.stdout


def test_it_imports_the_standard_library_alone():
    probe = "import sys, checker; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    done = subprocess.run(
        [
            sys.executable,
            "-I",
            "-S",
            "-c",
            f"import sys; sys.path.insert(0, {str(CHECKER.parent)!r}); {probe}",
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert set(done.stdout.split()) <= {*sys.stdlib_module_names, "checker", "__main__"}


@pytest.mark.parametrize("kind", ["proved", "refuted"])
def test_a_changed_number_is_noticed(kind, request):
    content = request.getfixturevalue(kind)
    paths = list(leaves(content))
    assert len(paths) > 40
    for path in paths:
        value = content
        for key in path:
            value = value[key]
        for new in (Fraction(value) * Fraction(11, 10) + 1, -Fraction(value) - 1):
            with pytest.raises(checker.Rejected):
                checker.check(changed(content, path, str(new)))


WORSE = [
    # (path, factor): forged with all hashes made anew, the claim is no longer true
    (("claim", "margin"), 2),
    (("claim", "decay_rate"), 2),
    (("vertices", 0, "margin"), 2),
    (("vertices", 1, "margin"), Fraction(1001, 1000)),
    (("vertices", 0, "multiplier"), 3),
    (("vertices", 1, "multiplier"), Fraction(1, 3)),
    (("vertices", 0, "multiplier"), -1),
    (("vertices", 0, "factor"), Fraction(101, 100)),
    (("vertices", 1, "factor"), Fraction(99, 100)),
    (("enclosures", "factor", 0), Fraction(101, 100)),
    (("enclosures", "factor", 1), Fraction(99, 100)),
    (("enclosures", "centroid", 2, 0), Fraction(101, 100)),
    (("enclosures", "centroid", 2, 1), Fraction(99, 100)),
    (("goal_position", 2), Fraction(1, 2)),
    (("weights", 0), 2),
    (("weights", 3), Fraction(1, 2)),
    (("mission", "gains", "k1"), 2),
    (("mission", "gains", "k2"), Fraction(1, 3)),
    (("mission", "gains", "k3"), Fraction(1, 30)),
    (("mission", "gains", "k4"), Fraction(1, 30)),
    (("mission", "vehicle", "mass"), Fraction(1, 2)),
    (("mission", "vehicle", "gravity"), 2),
    (("mission", "bounds", "eigenvalues", 0), Fraction(1, 2)),
    (("mission", "bounds", "eigenvalues", 1), 2),
    (("region", "eigenvalues", 0), Fraction(3, 2)),
    (("region", "eigenvalues", 1), Fraction(1, 2)),
    (("mission", "bounds", "thrust", 0), Fraction(9, 10)),
    (("mission", "bounds", "thrust", 1), Fraction(11, 10)),
    (("mission", "goal", "height"), 2),
    (("mission", "target", "points", 0, 0), 2),
]


@pytest.mark.parametrize(
    ("path", "times"),
    WORSE,
    ids=lambda v: ".".join(map(str, v)) if isinstance(v, tuple) else str(v),
)
def test_a_skilful_forgery_is_rejected(proved, path, times):
    value = proved
    for key in path:
        value = value[key]
    with pytest.raises(checker.Rejected):
        checker.check(forge(proved, path, str(Fraction(value) * times)))


@pytest.mark.parametrize(
    ("path", "new"),
    [
        (("counterexample", "X"), ["0"] * 11),
        (("counterexample", "value"), "-100"),
        (("counterexample", "value"), "1"),
        (("counterexample", "f"), "1"),
        (("counterexample", "Q", 0, 0), "6"),
        (("counterexample", "Q", 0, 1), "1"),
        (("mission", "gains", "k4"), "3"),
    ],
)
def test_a_forged_counterexample_is_rejected(refuted, path, new):
    with pytest.raises(checker.Rejected):
        checker.check(forge(refuted, path, new))


def test_a_weaker_claim_is_still_a_theorem(proved):
    """Half the margin everywhere is true too, and so accepted."""
    weaker = copy.deepcopy(proved)
    for part in [weaker["claim"], *weaker["vertices"]]:
        part["margin"] = str(Fraction(part["margin"]) / 2)
        part["decay_rate"] = str(Fraction(part["decay_rate"]) / 2)
    assert checker.check(forge(weaker, ("version",), 1))


@pytest.mark.parametrize(
    ("text", "status"),
    [
        ("", 2),
        ("{", 2),
        ("[" * 100_000, 2),
        ('{"a": 1.5}', 2),
        ('{"a": NaN}', 2),
        ('{"a": 1, "a": 2}', 2),
        ('{"a": ' + "9" * 10_000 + "}", 2),
        ("[]", 1),
        ("{}", 1),
        ('{"kind": ["gains"]}', 1),
        ('{"kind": "gains"}', 1),
        ("\x00", 2),
        ("null", 1),
    ],
)
def test_what_is_no_certificate_gets_a_word_and_a_status(text, status):
    done = run(text)
    assert done.returncode == status
    assert "Traceback" not in done.stderr + done.stdout
    assert (done.stderr + done.stdout).startswith("x4.cert.json: ")


def test_a_file_too_large_or_missing_is_refused():
    assert run(" " * 10_000_000).returncode == 2
    Path("x4.cert.json").unlink()
    done = subprocess.run(
        [sys.executable, CHECKER, "x4.cert.json"], capture_output=True, check=False
    )
    assert done.returncode == 2


@pytest.mark.parametrize(
    "wrong", [None, 1, "x", [], {}, "1/0", "2/4", "-0", "01", "1e3", "١", "9" * 5000]
)
def test_every_part_may_be_nonsense(proved, wrong):
    def parts(value, path=()):
        if path:
            yield path
        children = value.items() if isinstance(value, dict) else enumerate(value)
        for key, entry in children:
            yield from (
                parts(entry, (*path, key)) if isinstance(entry, dict | list) else [(*path, key)]
            )

    for path in parts(proved):
        broken = changed(proved, path, wrong)
        if broken == proved:
            continue
        broken["mission_sha256"] = checker.digest(broken["mission"])
        broken["sha256"] = checker.digest({k: v for k, v in broken.items() if k != "sha256"})
        if path[0] in ("tools", "model_sha256", "mission_sha256", "sha256") or _bears_no_claim(
            path
        ):
            continue
        with pytest.raises(checker.Rejected):
            checker.check(broken)


def _bears_no_claim(path):
    return path[:2] == ("mission", "start") or path[:3] in {
        ("mission", "vehicle", key) for key in ("inertia", "arm", "drag_ratio")
    }


def rehashed(content):
    """Return a copy with hashes made anew; the statement is left, as it may not be sayable."""
    forged = copy.deepcopy(content)
    forged["mission_sha256"] = checker.digest(forged["mission"])
    forged["sha256"] = checker.digest({k: v for k, v in forged.items() if k != "sha256"})
    return forged


def test_numbers_out_of_any_reason_are_rejected(proved):
    huge, tiny = copy.deepcopy(proved), copy.deepcopy(proved)
    del huge["mission"]["bounds"]["thrust"]
    huge["mission"]["bounds"]["level"] = "1"
    huge["mission"]["vehicle"] |= {"mass": "9" * 300, "gravity": "9" * 300}
    e = "1/1" + "0" * 40
    tiny["mission"]["target"]["points"] = [[e, "0", "0"], ["-" + e, "0", "0"]]
    tiny["mission"]["goal"] = {"height": e}
    tiny["goal_position"] = ["0", "0", "-" + e]
    crowd = copy.deepcopy(proved)
    crowd["mission"]["target"]["points"] = [[str(i), "0", "0"] for i in range(65)]
    for forged in (huge, tiny, crowd):
        with pytest.raises(checker.Rejected):
            checker.check(rehashed(forged))


@pytest.mark.slow
def test_nesting_at_the_edge_of_what_python_bears_gives_no_traceback(proved):
    text = json.dumps(proved)
    for depth in range(980, 1000):
        nested = text.replace('"tools": {', '"tools": {"deep": ' + "[" * depth + "]" * depth + ", ")
        done = run(nested)
        assert done.returncode in (1, 2), depth
        assert "Traceback" not in done.stderr, depth
