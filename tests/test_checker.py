"""The checker: alone with the standard library, it accepts what is true and nothing more."""

from __future__ import annotations

import ast
import copy
import io
import json
import os
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import pytest

from hoverproof import checker, cli
from hoverproof.certification.gains import certify
from hoverproof.certification.over_box import certify_region
from hoverproof.mission.reading import load

CHECKER = Path(checker.__file__)
WIDE = ((-1, 6), (-1, 4), (-5, -2))


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
    assert checker.check(forge(weaker, ("version",), checker.VERSION))


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
        a_version = path[0] == "tools" and wrong in ("x", "-0", "01", "1e3")
        if path[0] in ("mission_sha256", "sha256") or a_version:
            continue
        older = (checker.Unreadable,) if path == ("version",) and wrong == 1 else ()
        with pytest.raises((checker.Rejected, *older)):
            checker.check(broken)


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


def test_numbers_of_eighty_digits_are_read_and_longer_ones_are_not():
    for text in ("9" * 80, "-" + "9" * 80 + "/" + "7" * 79 + "1"):
        assert str(checker.number(text)) == text
    for text in ("9" * 81, "1/" + "9" * 81):
        with pytest.raises(checker.Rejected, match="longer than 80 digits"):
            checker.number(text)


@pytest.mark.parametrize("version", [True, "2", 0, 3, 2.0, None, [2]])
def test_only_the_number_two_is_version_two(proved, version):
    with pytest.raises((checker.Rejected, checker.Unreadable), match=r"not version 2|older"):
        checker.check(rehashed(proved | {"version": version}))


def test_a_file_of_an_older_version_is_not_called_false_but_to_be_made_anew(proved):
    done = run(rehashed(proved | {"version": 1}))
    assert (done.returncode, done.stdout) == (2, "")
    assert "made by an older version of hoverproof; make it anew" in done.stderr


def test_nothing_that_must_hold_stands_in_an_assert():
    tree = ast.parse(CHECKER.read_text(encoding="utf-8"))
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.Assert)]


# --- what it is about ---------------------------------------------------------------------------


def test_certificates_about_other_targets_under_the_same_name_do_not_read_alike(proved):
    plane = "[[10, 10, 2], [10, -10, 2], [-10, -10, 2], [-10, 10, 2]]"
    other = certify(load("x4-flyer", {"target.points": plane})).certificate.content
    assert "(10, 10, 2), (10, -10, 2), (-10, -10, 2), (-10, 10, 2) m" in other["statement"]
    assert "(1, 1, 0), (1, -1, 0), (-1, -1, 0), (-1, 1, 0) m" in proved["statement"]
    for content in (proved, other):
        assert content["mission_sha256"] in content["statement"]
        assert content["mission_sha256"] == checker.digest(content["mission"])


def test_the_hash_must_be_that_of_the_numbers(proved):
    other = {**proved, "mission_sha256": "0" * 64}
    with pytest.raises(checker.Rejected, match="not the one that was hashed"):
        checker.check(rehashed_but_for_the_mission(other))


def rehashed_but_for_the_mission(content):
    statement = content["statement"].replace(
        checker.digest(content["mission"]), content["mission_sha256"]
    )
    forged = {k: v for k, v in content.items() if k != "sha256"} | {"statement": statement}
    return forged | {"sha256": checker.digest(forged)}


def asked(*words, capsys):
    with pytest.raises(SystemExit) as done:
        cli.main(["check", *words])
    return done.value.code, capsys.readouterr().out


@pytest.mark.parametrize("margin", [None, "1"], ids=["accepted", "rejected"])
def test_check_says_just_what_the_checker_alone_says(proved, margin, capsys):
    content = proved if margin is None else changed(proved, ("claim", "margin"), margin)
    Path("x4.json").write_text(json.dumps(content))
    alone = checker.main(["x4.json"]), capsys.readouterr().out
    assert asked("x4.json", capsys=capsys) == alone


def test_check_says_whether_a_certificate_is_about_a_mission(proved, capsys):
    Path("x4.json").write_text(json.dumps(proved))
    status, said = asked("x4.json", "--mission", "x4-flyer", capsys=capsys)
    assert status == 0
    assert said.startswith("x4.json: accepted, and it is about the mission x4-flyer\n")
    changed = ("--set", "target.points=[[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0.5]]")
    status, said = asked("x4.json", "--mission", "x4-flyer", *changed, capsys=capsys)
    assert status == 1
    assert said.splitlines()[0] == (
        "x4.json: accepted, but it is about another mission than x4-flyer: "
        "target.points[4][3] is 0 in the certificate and 1/2 in the mission"
    )
    status, said = asked("x4.json", "--mission", "racer-250", "--json", capsys=capsys)
    answer = json.loads(said)
    assert status == 1
    assert answer["accepted"]
    assert not answer["about_mission"]
    assert "gains.k1 is 1/5 in the certificate and " in " ".join(answer["differences"])


def test_a_rejected_certificate_is_about_no_mission(proved, capsys):
    Path("x4.json").write_text(json.dumps(changed(proved, ("claim", "margin"), "1")))
    status, said = asked("x4.json", "--mission", "x4-flyer", "--json", capsys=capsys)
    assert status == 1
    assert not json.loads(said)["about_mission"]
    status, said = asked("x4.json", "--mission", "x4-flyer", capsys=capsys)
    assert status == 1
    assert "is about" not in said
    assert said.startswith("x4.json: rejected: ")


def test_a_mission_to_compare_with_that_cannot_be_read_is_bad_input(proved, capsys):
    Path("x4.json").write_text(json.dumps(proved))
    assert asked("x4.json", "--mission", "nowhere.toml", capsys=capsys)[0] == 2
    assert asked("x4.json", "--set", "gains.k4=1", capsys=capsys)[0] == 2


# --- a terminal that knows few letters ----------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "environment"),
    [
        (["-S"], {"PYTHONIOENCODING": "ascii"}),
        (["-S"], {"PYTHONIOENCODING": "latin-1"}),
        (["-X", "utf8=0", "-I", "-S"], {"LC_ALL": "C"}),
    ],
)
def test_an_accepted_certificate_is_accepted_in_any_encoding(proved, options, environment):
    Path("x4.json").write_text(json.dumps(proved))
    done = subprocess.run(
        [sys.executable, *options, CHECKER, "x4.json"],
        capture_output=True,
        check=False,
        env={**os.environ, **environment},
    )
    assert done.returncode == 0, done.stderr
    assert b"x4.json: accepted" in done.stdout
    assert done.stderr == b""


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["check", "x4.json"], 0),
        (["check", "x4.json", "--json"], 0),
        (["check", "\udcff.json"], 2),
        (["certify", "x4-flyer"], 0),
        (["certify", "x4-flyer", "--set", "gains.k4=0.1", "--json"], 1),
        (["region", "x4-flyer", "--no-figure"], 0),
        (["derive", "--equation", "31"], None),
        (["presets"], 0),
        (["attraction", "--help"], 0),
    ],
)
def test_every_command_can_print_in_ascii(proved, words, status, monkeypatch):
    Path("x4.json").write_text(json.dumps(proved))
    out, err = (io.TextIOWrapper(io.BytesIO(), encoding="ascii") for _ in range(2))
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    with pytest.raises(SystemExit) as done:
        cli.main(words)
    out.flush()
    said = out.buffer.getvalue().decode("ascii")
    assert status in (None, done.value.code)
    if "--json" in words:
        answer = json.loads(said)
        assert "Σ" in answer["statement"]


# --- files that ask for much --------------------------------------------------------------------

ENOUGH = 6.0  # s; 2 s on a machine with nothing else to do


def answered(content):
    """Return the reason why a forged certificate is rejected, and that it took not too long."""
    with pytest.raises(checker.Rejected) as reason:
        began = time.process_time()
        checker.check(forge(content, ("version",), checker.VERSION))
    assert time.process_time() - began < ENOUGH
    return str(reason.value)


def test_a_long_list_is_refused_before_it_is_read(proved):
    for path, count in ((("mission", "target", "points"), 40_000), (("weights",), 190_000)):
        entry = ["0", "0", "0"] if len(path) > 1 else "1"
        began = time.process_time()
        with pytest.raises(checker.Rejected, match="misshapen"):
            checker.check(rehashed(changed(proved, path, [entry] * count)))
        assert time.process_time() - began < 2


@pytest.mark.slow
@pytest.mark.parametrize("share", [Fraction(99, 100), 1 - Fraction(1, 10**9)])
def test_bounds_that_are_all_but_sharp_are_soon_given_up(share):
    mission = load("x4-flyer", {"bounds.eigenvalues": '"auto"'})
    over = certify_region(mission, tuple((Fraction(a), Fraction(b)) for a, b in WIDE))
    content, (low, high) = over.certificate.content, over.enclosure.attained
    ends = [Fraction(low) * share, Fraction(high) / share]
    content["region"]["eigenvalues"] = [str(end.limit_denominator(10**12)) for end in ends]
    two = [["1", "0", "0"], ["-1", "1/3", "1/7"]]
    assert "over a cell of the box" in answered(content)
    content["mission"]["target"]["points"] = two
    content["mission"]["goal"], content["goal_position"] = {"centroid": ["0", "0", "1"]}, None
    assert "over a cell of the box" in answered(content)


@pytest.mark.slow
def test_a_certificate_of_long_numbers_is_soon_answered(proved):
    long = copy.deepcopy(proved)

    def grown(text):
        return str(Fraction(text) + Fraction(1, 7**80))

    for name in ("k1", "k2", "k3", "k4"):
        long["mission"]["gains"][name] = grown(long["mission"]["gains"][name])
    long["weights"] = [grown(w) for w in long["weights"]]
    for vertex in long["vertices"]:
        vertex["multiplier"] = grown(vertex["multiplier"])
    began = time.process_time()
    assert checker.check(forge(long, ("version",), checker.VERSION))
    assert time.process_time() - began < ENOUGH


@pytest.mark.slow
def test_nesting_at_the_edge_of_what_python_bears_gives_no_traceback(proved):
    text = json.dumps(proved)
    for depth in range(980, 1000):
        nested = text.replace('"tools": {', '"tools": {"deep": ' + "[" * depth + "]" * depth + ", ")
        done = run(nested)
        assert done.returncode in (1, 2), depth
        assert "Traceback" not in done.stderr, depth
