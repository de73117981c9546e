"""Ten million calls of the firmware under sanitizers: ``make fuzz``."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from firmware_kit import kinds
from test_firmware_target import fuzz_guided, fuzz_random, fuzzer

CALLS = 10_000_000


def main() -> None:
    """Share the calls among the kinds of package, half of them guided by coverage."""
    total, share = 0, -(-CALLS // (2 * len(kinds())))
    for kind in kinds():
        with tempfile.TemporaryDirectory() as name:
            begin = time.perf_counter()
            program = fuzzer(kind.export(Path(name) / "fw"), Path(name))
            done = fuzz_random(program, share) + fuzz_guided(program, share)
            total += done
            print(f"{kind}: {done} calls, {time.perf_counter() - begin:.1f} s", flush=True)
    print(f"{total:,} calls: no trap, no NaN, no wrong status")


if __name__ == "__main__":
    main()
