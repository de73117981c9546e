"""Random missions through the commands, and what must hold of the answers: ``make missions``.

Every mission gets a process of its own, made by a fork of one that has imported and derived what
all of them need; each command in it has a limit of processor time that native code keeps too.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import re
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

for _library in ("OPENBLAS", "OMP", "MKL"):  # one thread each: a fork copies no others
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

from random_missions import Case, case  # noqa: E402  (numpy reads the lines above)

SECONDS = 60
BYTES = 8 << 30
ALL = ("certify", "over-box", "region", "attraction", "tune", "simulate", "runs", "export")
STATUS = {"proved": 0, "refuted": 1, "undecided": 3}
ROUNDING = 1e-6
MANY_STEPS = 50_000
"""What takes about half a minute where there is no compiler."""


@dataclass
class Answer:
    """What a command said, and what it left."""

    command: str
    arguments: list[str]
    status: int | None = None
    out: str = ""
    err: str = ""
    error: str = ""
    seconds: float = 0.0
    files: list[str] = field(default_factory=list)

    @property
    def said(self) -> dict[str, Any]:
        """The JSON object that was printed; empty if there is none."""
        try:
            found = json.loads(self.out)
        except json.JSONDecodeError:
            return {}
        return found if isinstance(found, dict) else {}


@dataclass(frozen=True)
class Fault:
    """Something that must not be."""

    kind: str
    number: int
    command: str
    words: str


# --- one mission, in a process of its own -------------------------------------------------------


def plan(one: Case, whole: bool) -> list[str]:
    """Return which commands a mission goes through: all of them, or a few that cost little."""
    if whole or one.refused:
        return list(ALL)
    turn = one.number // 3
    chosen = ["certify"]
    every = {"over-box": 8, "region": 8, "simulate": 10, "export": 10, "runs": 30}
    chosen += [command for command, n in every.items() if turn % n == 0]
    if turn % 22 == 1:
        chosen += ["tune", "export"]
    if turn % 22 == 11:  # among the first 200 starts: proved, undecided and refused ones
        chosen += ["attraction", "simulate"]
    return [command for command in ALL if command in chosen]


def words_of(command: str, number: int, file: str, whole: bool) -> list[str]:
    """Return the command line; now and then it is to answer in words and not in JSON."""
    answer = [] if whole and number // 6 % 3 == 0 else ["--json"]
    length = [] if _flies_long(number, whole) else ["--duration", "5"]
    return {
        "certify": ["certify", file, "--json", "--out", "c.json"],
        "over-box": ["certify", file, "--over-box", "--boxes", "300", "--out", "box.json"],
        "region": ["region", file, *answer, "--no-figure", "--out", "r.json", "--boxes", "1000"],
        "attraction": ["attraction", file, *answer, "--no-figure", "--out", "a.json"],
        "tune": ["tune", file, "--objective", "decay", *answer, "--out", "tuned.toml"],
        "simulate": ["simulate", file, *answer, "--no-figures", *length, "--out", "f.nc"],
        "runs": [
            "simulate",
            file,
            "--runs",
            "3",
            "--no-figures",
            "--duration",
            "1",
            "--out",
            "r.nc",
        ],
        "export": ["export", file, *answer, "--out", "fw"],
    }[command]


def _flies_long(number: int, whole: bool) -> bool:
    """Tell whether a flight is to have its natural length."""
    return whole and number // 18 % 2 == 1


def _few_steps(file: str) -> bool:
    """Tell whether five seconds of flight have few steps, or the mission is none."""
    from hoverproof.mission.reading import load
    from hoverproof.simulation.timing import flight_step

    try:
        return bool(flight_step(load(file), None) > 5 / MANY_STEPS)
    except Exception:
        return True  # the commands will tell


def _file(one: Case) -> str:
    return f"{one.number}.toml"


def call(command: str, arguments: list[str]) -> Answer:
    """Run a command in this process, under a limit of processor time."""
    from hoverproof import cli

    used = resource.getrusage(resource.RUSAGE_SELF)
    now = used.ru_utime + used.ru_stime
    limit = int(now) + SECONDS + 1
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
    answer = Answer(command, arguments)
    before = _files()
    with _captured(answer):
        try:
            cli.main(arguments)
        except SystemExit as end:
            answer.status = end.code if isinstance(end.code, int) else -1
        except BaseException:
            answer.error = traceback.format_exc()
    answer.seconds = time.process_time() - now
    answer.files = sorted(_files() - before)
    return answer


def _files() -> set[str]:
    return {str(p) for p in Path().rglob("*") if p.is_file() and not p.name.startswith("stdout")}


@contextlib.contextmanager
def _captured(answer: Answer) -> Iterator[None]:
    """Catch what Python and native libraries print."""
    sys.stdout.flush(), sys.stderr.flush()
    saved = os.dup(1), os.dup(2)
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        os.dup2(out.fileno(), 1), os.dup2(err.fileno(), 2)
        try:
            yield
        finally:
            with contextlib.suppress(ValueError):
                sys.stdout.flush(), sys.stderr.flush()
            os.dup2(saved[0], 1), os.dup2(saved[1], 2)
            os.close(saved[0]), os.close(saved[1])
            for file, name in ((out, "out"), (err, "err")):
                file.seek(0)
                setattr(answer, name, file.read().decode("utf-8", "replace"))


def trial(one: Case, commands: list[str], whole: bool, send: Callable[[Any], None]) -> None:
    """Run the commands on a mission in this folder, and look for faults."""
    file = _file(one)
    answers: dict[str, Answer] = {}
    for command in commands:
        send({"began": command})
        answer = call(command, words_of(command, one.number, file, whole))
        answers[command] = answer
        send({"seconds": {command: answer.seconds}, "status": {command: answer.status}})
        for fault in plain_faults(one, answer, file):
            send({"fault": asdict(fault)})
    send({"began": "comparison"})
    try:
        for fault in contradictions(one, answers, file, whole):
            send({"fault": asdict(fault)})
    except Exception:
        send(
            {"fault": asdict(Fault("traceback", one.number, "comparison", traceback.format_exc()))}
        )


# --- what must hold of one answer ---------------------------------------------------------------


def plain_faults(one: Case, answer: Answer, file: str) -> Iterator[Fault]:
    """Yield what no answer may be, whatever the mission."""

    def fault(kind: str, words: str) -> Fault:
        return Fault(kind, one.number, answer.command, words)

    if answer.error:
        last = [line for line in answer.error.splitlines() if "hoverproof/" in line][-1:]
        yield fault("traceback", f"{answer.error.splitlines()[-1]} at {' '.join(last).strip()}")
        return
    if "Traceback" in answer.err + answer.out:
        yield fault("traceback", answer.err[-500:])
    if answer.status not in (0, 1, 2, 3):
        yield fault("status", f"status {answer.status}")
    if answer.seconds > SECONDS:
        yield fault("hang", f"{answer.seconds:.0f} s")
    if "Warning" in answer.err or "WARNING" in answer.err + answer.out:
        yield fault("chatter", answer.err.strip()[-300:])
    if one.refused and answer.status != 2:
        yield fault("broken mission taken", f"status {answer.status}")
    if answer.status == 2:
        lines = [line for line in answer.err.splitlines() if ": warning: " not in line]
        if len(lines) != 1 or not lines[0].startswith((f"hoverproof: {file}: ", "hoverproof: --")):
            yield fault("message", f"status 2 with {answer.err.strip()[:300]!r}")
        if answer.out:
            yield fault("message", f"status 2, and on stdout {answer.out[:100]!r}")
    elif "--json" in answer.arguments and not answer.said:
        yield fault("message", f"no JSON object but {answer.out[:100]!r}")
    odd = re.search(r".*\b(nan|inf|infinity)\b.*", answer.out, re.IGNORECASE)
    if odd:
        yield fault("message", f"no number but {odd[1]}: {odd[0].strip()[:120]}")
    writes = {"region": (0, 1, 3), "tune": (0,), "export": (0,)}
    if answer.files and answer.status not in writes.get(answer.command, (0, 1)):
        yield fault("file", f"status {answer.status}, yet it wrote {answer.files}")
    if not answer.files and answer.status in (0, 1) and answer.command in ("certify", "attraction"):
        yield fault("file", f"status {answer.status}, yet nothing is written")
    for name in answer.files:
        yield from _rejected(fault, name)


def _rejected(fault: Callable[[str, str], Fault], name: str) -> Iterator[Fault]:
    """Yield a fault if a certificate is not accepted."""
    from hoverproof import checker

    if not name.endswith(".json") or name.endswith("manifest.json"):
        return
    began = time.process_time()
    try:
        checker.check_file(name)
    except (checker.Rejected, checker.Unreadable) as error:
        yield fault("certificate rejected", f"{name}: {error}")
    except Exception as error:
        yield fault("traceback", f"checker: {error!r}")
    took = time.process_time() - began
    if took > SECONDS:
        yield fault("hang", f"the checker took {took:.0f} s for {name}")


# --- what must hold between answers -------------------------------------------------------------


def contradictions(
    one: Case, answers: dict[str, Answer], file: str, whole: bool
) -> Iterator[Fault]:
    """Yield what commands say of one mission that cannot both be so."""
    from hoverproof.errors import InputError
    from hoverproof.mission.reading import load

    def fault(command: str, words: str) -> Fault:
        return Fault("contradiction", one.number, command, words)

    try:
        mission = load(file)
    except InputError as error:
        for command, answer in answers.items():
            if answer.status != 2 or error.line not in answer.err:
                yield fault(command, "does not refuse what cannot be loaded, or in other words")
        return
    except Exception:
        return  # told of each command already
    answers = {"certify": Answer("certify", []), **answers}  # one whose process died says nothing
    own = answers["certify"].status
    yield from _rates(fault, answers, mission)
    if "export" in answers and own is not None:
        wanted = 2 if own == 0 and not _rotors_fit(mission) else own
        if answers["export"].status != wanted:
            yield fault("export", f"status {answers['export'].status}, but certify {own}")
    if "region" in answers:
        yield from _region(fault, answers, mission)
    if "attraction" in answers:
        yield from _attraction(fault, answers, mission)
    if "tune" in answers:
        yield from _tuned(fault, answers, mission)


Say = Callable[[str, str], Fault]


def _rotors_fit(mission: Any) -> bool:
    """Tell whether rotors can be limited as the mission says: firmware must, theorems do not."""
    rotors, share = mission.rotors, mission.vehicle.weight / 4
    low, high = rotors.min_thrust, rotors.max_thrust
    return (low is None or low < share) and (high is None or share < high <= 10 * share)


def _slowest(mission: Any) -> float:
    from hoverproof.servo.linearised import slowest_rate

    return slowest_rate(mission)


def _bandwidth(mission: Any) -> float:
    g = mission.gains
    return float((g.k1 * g.k2 + g.k3 + g.k4) / mission.vehicle.mass)


def _beside(mission: Any) -> str:
    """Say whether bounds that leave out Q at the goal are what makes a rate empty."""
    if mission.bounds.eigenvalues == "auto":
        return ""
    low, high = mission.bounds.eigenvalues
    values = _at_goal(mission)
    return (
        "" if low <= values[0] and values[-1] <= high else " (the bounds leave out Q at the goal)"
    )


def _too_fast(rate: float, slowest: float, mission: Any) -> str:
    allowed = f"the loop allows {2 * slowest:.6g}{_beside(mission)}"
    return f"L falls at {rate:.6g} 1/s, proved; {allowed}"


def _rates(fault: Say, answers: dict[str, Answer], mission: Any) -> Iterator[Fault]:
    """Nothing is proved of a loop that grows, and L falls no faster than its slowest motion.

    Along the slowest motion of the loop linearised at the goal, at the rate s, the quadratic L
    falls as exp(-2 s t); the theorem is about that motion too, so a proved rate is at most 2 s.
    """
    proved = [c for c in ("certify", "over-box", "attraction") if c in answers]
    proved = [c for c in proved if answers[c].status == 0]
    if not proved:
        return
    slowest, rounding = _slowest(mission), 1e-9 * _bandwidth(mission)
    for command in proved:
        if not slowest > -rounding:
            yield fault(
                command,
                f"proved, but the loop grows at the goal, at {-slowest:.4g} 1/s{_beside(mission)}",
            )
    rate = answers["certify"].said.get("decay_rate")
    if rate is not None and rate > 2 * slowest * (1 + ROUNDING) + rounding:
        yield fault("certify", _too_fast(rate, slowest, mission))


def _region(fault: Say, answers: dict[str, Answer], mission: Any) -> Iterator[Fault]:
    """What is proved for wide bounds is proved for narrower ones, and Q of the goal is in both."""
    said = answers["region"].said
    if answers["region"].status == 2 or not said:
        return
    (low, high), found = said["bounds"], said["enclosure"]
    inside = found is not None and low <= found[0] and found[1] <= high
    if inside and said["verdict"] == "refuted":
        yield fault("region", "the bounds are refuted, yet narrower ones are proved")
    if said["verdict"] == "proved" and "over-box" in answers and inside:
        plain, over_box = answers["certify"].status, answers["over-box"].status
        if plain == 0 and over_box == 1:
            yield fault("certify --over-box", "refuted for bounds inside those of a proof")
    if said["verdict"] == "proved":
        values = _at_goal(mission)
        if not (low <= values[0] * (1 + ROUNDING) and values[-1] <= high * (1 + ROUNDING)):
            yield fault("region", f"proved, but Q at the goal has eigenvalues {values}")


def _at_goal(mission: Any) -> Any:
    import numpy as np

    from hoverproof.certification.flow import eigenvalues
    from hoverproof.certification.pattern import Pattern
    from hoverproof.plant.goal import hover_goal

    goal = np.array([float(c) for c in hover_goal(mission).position])
    return eigenvalues(Pattern.of(mission), goal[None])[0]


LONG = 5000.0
"""s; a longer flight takes too long where there is no compiler, and one of many steps as well."""


def _attraction(fault: Say, answers: dict[str, Answer], mission: Any) -> Iterator[Fault]:
    """From a start that is proved nothing sinks to the target, and the ideal flight arrives."""
    if answers["attraction"].status != 0:
        return
    from hoverproof.certification.attraction.refutation import SOON
    from hoverproof.certification.attraction.refutation import simulate as follow
    from hoverproof.certification.attraction.starts import State
    from hoverproof.mission.sections import CONDITIONS
    from hoverproof.simulation.flight import simulate, summary
    from hoverproof.simulation.timing import MAX_SLOW_STEPS, default_duration, flight_step

    state = State.of(mission)
    if state is not None and follow(mission, state.packed(), SOON)[0] == "sinks to the target":
        yield fault("attraction", "proved, but within seconds it sinks to the target")
    bare = mission.model_copy(update={name: type(getattr(mission, name))() for name in CONDITIONS})
    try:
        time = min(default_duration(bare), LONG)
        if time / flight_step(bare, None) > MAX_SLOW_STEPS:
            return
        came = summary(simulate(bare, duration=time))
    except ValueError as error:  # no default duration, say
        yield fault("simulate", f"attraction is proved from the start, but: {error}")
        return
    away, before = came["final_error"], came["start_error"]
    if came["outcome"] != "flown" or away > before * (1 + ROUNDING) + 1e-9:
        yield fault(
            "simulate",
            f"attraction is proved from the start, but the flight ends {came['outcome']} after "
            f"{came['duration']:g} s, {away:.3g} m away, from {before:.3g} m",
        )


def _tuned(fault: Say, answers: dict[str, Answer], mission: Any) -> Iterator[Fault]:
    """What is tuned is stable, certified as said, and not the gains that certify refutes."""
    tuned, own, said = answers["tune"].status, answers["certify"].status, answers["tune"].said
    limited = mission.conditions().get("rotors") or _bandwidth(mission) > 20
    if tuned == 1 and own == 0 and not limited:
        yield fault("tune", f"no gains, but the mission's own are proved: {said.get('reason')}")
    if tuned != 0 or not said:
        return
    keys = ("k1", "k2", "k3", "k4")
    if own == 1 and all(said["gains"][k] == float(getattr(mission.gains, k)) for k in keys):
        yield fault("tune", "gives the gains that certify refutes")
    slowest, rate = said["slowest_rate"], said["decay_rate"]
    if not slowest > 0:
        yield fault(
            "tune",
            f"proved, but the loop grows at the goal, at {-slowest:.4g} 1/s{_beside(mission)}",
        )
    if rate > 2 * slowest * (1 + ROUNDING):
        yield fault("tune", _too_fast(rate, slowest, mission))
    again = call("certify", ["certify", "tuned.toml", "--json", "--out", "tuned.json"])
    if again.status != 0 or again.said.get("decay_rate") != rate:
        yield fault("certify", f"of what tune has proved: {again.status} {again.err or again.out}")


# --- many missions ------------------------------------------------------------------------------


def warm_up() -> None:
    """Import and derive once what every mission needs."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for command in ALL:
            call(command, words_of(command, 0, "nothing.toml", False))
        for command in ("certify", "over-box", "region", "simulate", "export"):
            call(command, words_of(command, 0, "x4-flyer", False))


def run(numbers: list[int], *, whole: bool, report: Callable[[Any], None]) -> None:
    """Try missions one after the other, each in a fork of this process."""
    warm_up()
    for number in numbers:
        one = case(number)
        commands = plan(one, whole)
        while commands:
            commands = _in_a_fork(one, commands, whole, report)


def _in_a_fork(
    one: Case, commands: list[str], whole: bool, report: Callable[[Any], None]
) -> list[str]:
    """Run commands in a child; return those still to be run if it did not survive one."""
    read, write = os.pipe()
    folder = tempfile.mkdtemp(prefix="mission-")
    child = os.fork()
    if child == 0:
        try:
            os.close(read)
            os.chdir(folder)
            resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

            def send(message: Any) -> None:
                os.write(write, (json.dumps(message) + "\n").encode())

            Path(_file(one)).write_bytes(one.text)
            if not _flies_long(one.number, whole) and _few_steps(_file(one)):
                os.environ["CC"] = "no-compiler"  # it would work longer than a short flight takes
            trial(one, commands, whole, send)
        finally:
            os._exit(0)
    os.close(write)
    began, finished = "", False
    with os.fdopen(read, "rb") as pipe:
        while True:
            if not select.select([pipe], [], [], 10 * SECONDS)[0]:
                os.kill(child, signal.SIGKILL)
            line = pipe.readline()
            if not line:
                break
            message = json.loads(line)
            began = message.get("began", began)
            finished = finished or began == "comparison"
            if "began" not in message:
                report({"number": one.number, "kind": one.kind, **message})
    _, status = os.waitpid(child, 0)
    shutil.rmtree(folder, ignore_errors=True)
    if not os.WIFSIGNALED(status):
        return []
    ended = signal.Signals(os.WTERMSIG(status)).name
    kind = "hang" if ended in ("SIGXCPU", "SIGKILL") else "crash"
    report({"fault": asdict(Fault(kind, one.number, began, f"ended by {ended}"))})
    return [] if finished else commands[commands.index(began) + 1 :]


def spread(numbers: list[int], *, whole: bool, jobs: int, report: Callable[[Any], None]) -> None:
    """Try missions in so many processes, each started afresh so that it may fork."""
    program = [sys.executable, __file__, *(["--whole"] if whole else []), "--lines"]
    workers = [
        subprocess.Popen([*program, *map(str, numbers[k::jobs])], stdout=subprocess.PIPE, text=True)
        for k in range(min(jobs, len(numbers)))
    ]
    pipes = [w.stdout for w in workers if w.stdout]
    while pipes:
        for pipe in select.select(pipes, [], [])[0]:
            line = pipe.readline()
            if line:
                report(json.loads(line))
            else:
                pipes.remove(pipe)
                pipe.close()
    if any(w.wait() for w in workers):
        raise RuntimeError("a worker failed")


@dataclass
class Tally:
    """What the trials came to."""

    faults: list[Fault] = field(default_factory=list)
    seconds: Counter[str] = field(default_factory=Counter)
    status: Counter[tuple[str, int]] = field(default_factory=Counter)
    slowest: float = 0.0

    def add(self, message: Any) -> None:
        """Take in one message of a worker."""
        if "fault" in message:
            self.faults.append(Fault(**message["fault"]))
        for command, seconds in message.get("seconds", {}).items():
            self.seconds[command] += seconds
            self.slowest = max(self.slowest, seconds)
            self.status[command, message["status"][command]] += 1


def main() -> int:
    """Try missions, and list the faults."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("numbers", type=int, nargs="*", help="missions to try; default: the first")
    parser.add_argument("--count", type=int, default=2000, help="how many, if none is named")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--whole", action="store_true", help="every command on every mission")
    parser.add_argument("--lines", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    numbers = options.numbers or list(range(options.count))
    if options.lines:
        run(numbers, whole=options.whole, report=lambda m: print(json.dumps(m), flush=True))
        return 0
    tally = Tally()

    def report(message: Any) -> None:
        tally.add(message)
        if "fault" in message:
            fault = tally.faults[-1]
            print(f"{fault.number} {fault.command}: {fault.kind}: {fault.words}", flush=True)

    spread(numbers, whole=options.whole, jobs=options.jobs, report=report)
    print(f"{len(numbers)} missions, {sum(tally.seconds.values()):.0f} s of processor time")
    for command in ALL:
        ended = {s: n for (c, s), n in sorted(tally.status.items(), key=str) if c == command}
        print(f"  {command:10} {tally.seconds[command]:6.0f} s, by status {ended}")
    print(f"the slowest command took {tally.slowest:.1f} s")
    kinds = Counter(fault.kind for fault in tally.faults)
    print("faults:", ", ".join(f"{n} {kind}" for kind, n in kinds.most_common()) or "none")
    return 1 if tally.faults else 0


if __name__ == "__main__":
    sys.exit(main())
