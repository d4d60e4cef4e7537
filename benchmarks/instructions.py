"""Counts the instructions of the hot kernels and compares them with what is recorded: a guard against slow changes.

    python benchmarks/instructions.py            fails when a kernel takes over 3% more than recorded
    python benchmarks/instructions.py --record   writes the present counts

Instructions per step of one trajectory on the AVX2 path: the difference between two lengths of the same run, so that
starting up does not count.  valgrind knows no AVX-512.  Counts repeat exactly for one compiler; another version of
rustc may need them recorded anew, and the message says so.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
RECORD = Path(__file__).parent / "instructions.json"
BOUND = 0.03
"""Largest relative excess: what rearranging code costs without anybody meaning to, and no more."""
T_END = 8.0


def main() -> int:
    """Counts, prints a line for each kernel, and says whether all are within the bound."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--record", action="store_true", help="write the present counts")
    record = parser.parse_args().record
    if shutil.which("valgrind") is None:
        print("instructions: skipped, valgrind is not installed (Debian and Ubuntu: apt install valgrind)")
        return 0
    program = build()
    names = subprocess.run([program, "list"], capture_output=True, text=True, check=True).stdout.split()
    counts = {name: count(program, name) for name in names}
    compiler = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True).stdout.strip()
    if record:
        RECORD.write_text(json.dumps({"rustc": compiler, "instructions per step": counts}, indent=2) + "\n")
        print(f"recorded {len(counts)} kernels in {RECORD.relative_to(ROOT)}")
        return 0
    recorded = json.loads(RECORD.read_text())
    return compare(counts, recorded["instructions per step"], compiler, recorded["rustc"])


def compare(counts: dict[str, float], recorded: dict[str, float], compiler: str, recorded_with: str) -> int:
    """1 if a kernel takes more than recorded, by more than the bound; else 0."""
    failed = False
    for name, now in counts.items():
        before = recorded.get(name)
        change = None if before is None else now / before - 1
        verdict = "new: record it" if change is None else f"{change:+.2%}"
        if change is None or change > BOUND:
            failed = True
            verdict += "  TOO MANY" if change is not None else ""
        elif change < -BOUND:
            verdict += "  fewer: record them"
        print(f"{name:22} {now:10.1f} instructions per step  {verdict}")
    if failed and compiler != recorded_with:
        print(f"recorded with {recorded_with}, this is {compiler}: if the code is the same, record anew (--record)")
    return int(failed)


def build() -> str:
    """The example that does the work."""
    command = [
        "cargo",
        "build",
        "--release",
        "--locked",
        "--quiet",
        "-p",
        "liepoisson-core",
        "--example",
        "instructions",
    ]
    subprocess.run(command, cwd=ROOT, check=True)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    return str(target / "release" / "examples" / "instructions")


def count(program: str, kernel: str) -> float:
    """Instructions per step: twice the time less once."""
    (short, few), (long, many) = (_run(program, kernel, t_end) for t_end in (T_END, 2 * T_END))
    return round((long - short) / (many - few), 1)


def _run(program: str, kernel: str, t_end: float) -> tuple[int, int]:
    """Instructions of a whole run, and its steps."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program, kernel, str(t_end)]
    # the kernels, also those that compiled code replaces in long runs
    environment = os.environ | {"LIEPOISSON_SIMD": "avx2", "LIEPOISSON_JIT": "0"}
    run = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    collected = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode or not collected:
        raise SystemExit(f"{kernel}: the count failed\n{run.stderr[-2000:]}")
    return int(collected.group(1)), int(run.stdout)


if __name__ == "__main__":
    sys.exit(main())
