"""What every command has for being one: help, completion, suggestions, and a width of 80 columns.

The tests go over the commands that are registered, so that a new one is held to the same.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pexpect
import pytest
from rich.cells import cell_len

from command_line import refusal, run
from hoverproof.cli.console import app, at_work
from hoverproof.mission.presets import preset_text, presets

COMMANDS = sorted(name for name in app if not name.startswith("-"))
PROGRAM = Path(sys.executable).parent / "hoverproof"
SCATTERED = ("--set", "scatter.position=[1,1,1]")
PLAIN = {"COLUMNS": "80", "TERM": "xterm-256color", "LC_ALL": "C.UTF-8"}


def narrow(text):
    return [line for line in text.splitlines() if cell_len(line.rstrip()) > 80] == []


@pytest.fixture(autouse=True)
def _eighty_columns(monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")


@pytest.mark.parametrize("command", [*COMMANDS, "--install-completion"])
def test_help_has_examples_that_parse_and_says_what_each_option_is(command, capsys):
    _, out, _ = run(capsys, command, "--help")
    assert narrow(out)
    assert "Exit status: 0 done or proved" in out
    examples = re.findall(r"Example: `(hoverproof [^`]*)`", app[command].help)
    assert examples
    for example in examples:
        app.parse_args(shlex.split(example)[1:], exit_on_error=False, print_error=False)
    if command in COMMANDS:
        for argument in app[command].assemble_argument_collection():
            assert argument.parameter.help, f"{command} {argument.name} has no help"


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_answers_machines(command):
    assert "--json" in {
        name for a in app[command].assemble_argument_collection() for name in a.names
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["presets"],
        ["certify", "x4-flyer"],
        ["certify", "x4-flyer", "--set", "gains.k4=0.1"],
        ["check", "c.json"],
        ["simulate", "x4-flyer", "--duration", "20", "--no-figures"],
        ["new", "my.toml"],
        ["export", "x4-flyer", "--out", "firmware"],
        ["simulate", "x4-flyer", "--runs=4", "--duration=20", "--no-figures", *SCATTERED],
        pytest.param(
            ["tune", "x4-flyer", "--objective", "decay", "--out", "tuned.toml"],
            marks=pytest.mark.slow,
        ),
        pytest.param(
            ["tune", "x4-flyer", "--objective", "decay", "--at-least", "1"], marks=pytest.mark.slow
        ),
        pytest.param(["atlas", "x4-flyer", "--cells", "20"], marks=pytest.mark.slow),
        pytest.param(["attraction", "x4-flyer", "--no-figure"], marks=pytest.mark.slow),
        pytest.param(["derive"], marks=pytest.mark.slow),
        pytest.param(["derive", "--equation", "31"], marks=pytest.mark.slow),
        pytest.param(["region", "x4-flyer", "--no-figure"], marks=pytest.mark.slow),
        pytest.param(["certify", "x4-flyer", "--over-box"], marks=pytest.mark.slow),
    ],
    ids=lambda a: a and " ".join(a),
)
def test_what_is_printed_fits_80_columns_and_has_no_escape_codes(arguments, capsys):
    if arguments[0] == "check":
        run(capsys, "certify", "x4-flyer", "--out", "c.json")
    _, out, err = run(capsys, *arguments)
    assert out
    assert narrow(out)
    assert "\x1b" not in out + err


@pytest.mark.parametrize(("no_color", "coloured"), [("1", False), ("", True)])
def test_NO_COLOR_leaves_no_escape_codes_even_in_a_terminal(no_color, coloured):
    out = pexpect.run(
        f"{PROGRAM} certify --help",
        env={**os.environ, **PLAIN, "NO_COLOR": no_color},
        encoding="utf-8",
    )
    assert "Usage: " in out
    assert ("\x1b" in out) is coloured


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["certfy", "x4-flyer"], "did you mean 'certify'?"),
        (["frobnicate"], "there are: certify, region, check"),
        (["--versoin"], "did you mean '--version'?"),
        (["certify", "x4-flyer", "--jsn"], "Did you mean --json?"),
        (["certify", "x4-flier"], "did you mean 'x4-flyer'?"),
        (["certify", "X4-Flyer"], "did you mean 'x4-flyer'?"),
        (["certify", "my-flier.toml"], "did you mean 'my-flyer.toml'?"),
        (["presets", "x4flyer"], "did you mean 'x4-flyer'?"),
        (["new", "a.toml", "--from", "x4flyer"], "did you mean 'x4-flyer'?"),
        (["certify", "x4-flyer", "--set", "gain.k4=1"], "--set gain.k4: unknown key (did you mean"),
        (["certify", "x4-flyer", "--set", "gains.k_4=1"], "did you mean 'k4'?"),
        (["certify", "x4-flyer", "--set", "k4=1"], "did you mean 'gains.k4'?"),
        (["certify", "x4-flyer", "--set", "gains.mass=1"], "did you mean 'vehicle.mass'?"),
        (["certify", "x4-flyer", "--set", "zzz=1"], "known here: name, vehicle"),
        (["certify", "typo.toml"], "typo.toml: gains.k44: unknown key (did you mean 'k4'?)"),
        (["certify", "source.toml"], "source.toml: source: unknown key"),
        (["derive", "--format", "markdwn"], 'Did you mean "markdown"?'),
        (["certify"], "certify needs MISSION: Name of a preset"),
        (["certify", "x4-flyer", "--out"], "--out needs a value: Certificate"),
        (["export", "x4-flyer"], "export needs --out: Folder"),
        (["certify", "x4-flyer", "--box", "-1,5"], "an equals sign before a minus: --box=-1,5"),
        (["simulate", "x4-flyer", "--set", "sensors.out_of_view=hld"], "'hold' or 'abort', not"),
        (["check", "a.json", "b.json"], "'b.json' is one argument too many"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_slip_is_answered_with_what_was_meant(arguments, hint, capsys):
    text = preset_text("x4-flyer")
    Path("my-flyer.toml").write_text(text)
    Path("typo.toml").write_text(text.replace("k4 =", "k44 ="))
    Path("source.toml").write_text(f'source = "mine"\n{text}')
    assert hint in refusal(capsys, *arguments)


def candidates(*words):
    done = subprocess.run(
        [PROGRAM, "__complete", *words], capture_output=True, text=True, check=True
    )
    lines = done.stdout.split("\x1fbegin\n", 1)[1].splitlines()
    return [line.split("\t")[0] for line in lines]


def test_tab_offers_presets_and_mission_files():
    Path("my-flyer.toml").touch()
    Path("other.txt").touch()
    Path("sub").mkdir()
    Path("sub/deep.toml").touch()
    assert candidates("certify", "") == [*presets(), "my-flyer.toml", "sub/deep.toml"]
    assert candidates("simulate", "sub/") == ["sub/deep.toml"]
    assert candidates("new", "a.toml", "--from", "") == presets()


def test_tab_offers_the_numbers_of_the_mission_to_change():
    Path("my.toml").write_text(preset_text("x4-flyer").replace("k4 = 3 ", "k4 = 7 "))
    assert "gains.k4=3" in candidates("certify", "x4-flyer", "--set", "")
    assert "gains.k4=7" in candidates("certify", "my.toml", "--set", "")


@pytest.mark.parametrize(
    ("shell", "check"), [("bash", "bash -n"), ("zsh", "zsh -n"), ("fish", "fish -n")]
)
def test_completion_can_be_installed_for_each_shell(shell, check, capsys, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))  # whose start-up files it adds to
    status, _, _ = run(capsys, "--install-completion", "--shell", shell, "--output", "script")
    script = Path("script").read_text()
    assert status == 0
    assert all(command in script for command in COMMANDS)
    if shutil.which(shell):
        assert subprocess.run([*check.split(), "script"], check=False).returncode == 0


@pytest.mark.skipif(not shutil.which("bash"), reason="there is no bash")
def test_bash_completes_a_command_and_a_preset(capsys, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    run(capsys, "--install-completion", "--shell", "bash", "--output", "script")
    shell = pexpect.spawn(
        "bash --norc --noprofile",
        env={**os.environ, **PLAIN, "PS1": "$ ", "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"},
        encoding="utf-8",
        timeout=30,
    )
    shell.sendline("source ./script; echo rea''dy")
    shell.expect("ready")
    shell.send("hoverproof cert\t")
    shell.expect("hoverproof certify ")
    shell.send("craz\t")
    shell.expect("crazyflie-2.1 ")
    shell.close(force=True)


@pytest.mark.slow
def test_attraction_shows_a_person_that_it_is_at_work_and_a_program_what_it_does(capsys):
    words = ("attraction", "x4-flyer", "--no-figure")
    terminal = pexpect.spawn(
        str(PROGRAM), list(words), env={**os.environ, **PLAIN}, encoding="utf-8", timeout=60
    )
    terminal.expect(r"searching for weights with a barrier \.\.\. .*0:00:0\d")
    terminal.expect(r"proving \.\.\. ")
    terminal.expect("x4-flyer: ")
    terminal.close(force=True)
    _, out, err = run(capsys, *words)
    assert err.splitlines() == ["searching for weights with a barrier ...", "proving ..."]
    assert "..." not in out


def test_what_is_being_done_is_said_once_where_nobody_looks(capsys):
    with at_work() as doing:
        for text in ("looking", "looking", "proving", "looking"):
            doing(text)
    assert capsys.readouterr().err == "looking ...\nproving ...\nlooking ...\n"
