"""How long does a person wait for a command?  Whole processes, from the shell's point of view, beside NumPy's import.

`python benchmarks/commands.py [--rounds N]`.  Each line is one command as it is typed; its time is that of the
processor, in the program and in the system, the least of five, which a busy machine disturbs less than the time on the
wall.  Targets were set where `import numpy` takes 0.12 s, and are scaled by what it takes here.  Compiled modules are
written to a folder of their own by a first run that is not counted, as an installation has them.  Results:
benchmarks/results/.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

ROUNDS = 5
REFERENCE = 0.12
"""Seconds of `import numpy` where the targets were set."""
COMMAND = ("-m", "liepoisson")


@dataclass(frozen=True)
class Case:
    """One process.

    Attributes:
        name: What the table calls it.
        arguments: Of Python.
        target: The most seconds that it may take where NumPy's import takes `REFERENCE`; None without a target.
    """

    name: str
    arguments: tuple[str, ...]
    target: float | None = None


def command(line: str, target: float | None) -> Case:
    """A call of `liepoisson`."""
    return Case(f"liepoisson {line}", (*COMMAND, *line.split()), target)


NUMPY = Case("import numpy", ("-c", "import numpy"))
CASES = (
    Case("import liepoisson", ("-c", "import liepoisson"), 0.04),
    command("orbit kovalevskaya", 0.5),
    command("section kovalevskaya --starts 4 --crossings 50", 0.5),
    command("lyapunov kovalevskaya --starts 4", 0.5),
    command("orbit kovalevskaya --plot", 1.5),
    command("section kovalevskaya --starts 4 --crossings 50 --plot", 1.5),
    command("lyapunov kovalevskaya --starts 4 --plot", 1.5),
    command("orbit henon-heiles", 0.5),
    command("orbit twisted-kovalevskaya", 0.5),
    command("orbit toda", 0.5),
    command("inspect kovalevskaya", 1.0),
    command("inspect zeitlin-5", 2.0),
    command("--help", None),
)


def seconds_of(case: Case, folder: Path, rounds: int) -> float:
    """Time of the processor, in the program and in the system, of one whole process: the least of some, in seconds.

    Raises:
        RuntimeError: the process failed; the message is what it wrote.
    """
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = str(folder / "compiled")
    times: list[float] = []
    for _ in range(rounds + 1):
        before = _seconds_so_far()
        done = subprocess.run(
            [sys.executable, *case.arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise RuntimeError(f"{case.name} ended with {done.returncode}:\n{done.stderr}")
        times.append(_seconds_so_far() - before)
    return min(times[1:])


def _seconds_so_far() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def lines(data: dict[str, Any]) -> list[list[str]]:
    """The table: seconds of each case, times NumPy's import, and the target as it is here."""
    unit = data["numpy"]
    table = [
        ["process", "seconds of the processor", "times `import numpy`", "target here"],
        [NUMPY.name, f"{unit:.2f}", "1.0", ""],
    ]
    for one in data["cases"]:
        target = None if one["target"] is None else one["target"] * unit / REFERENCE
        late = " (MISSED)" if target is not None and one["seconds"] > target else ""
        shown = "" if target is None else f"{target:.2f}{late}"
        table.append([f"`{one['name']}`", f"{one['seconds']:.2f}", f"{one['seconds'] / unit:.1f}", shown])
    return table


def run(rounds: int) -> dict[str, Any]:
    """Time all cases, as plain data for `report`."""
    with tempfile.TemporaryDirectory() as name:
        unit = seconds_of(NUMPY, Path(name), rounds)
        cases = [asdict(case) | {"seconds": seconds_of(case, Path(name), rounds)} for case in CASES]
    return {
        "kind": "commands",
        "title": "Commands as whole processes",
        "numpy": unit,
        "cases": cases,
        "rounds": rounds,
    }


def main() -> None:
    """Time all cases, print the table, and write its data."""
    import report
    import run as runs

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--rounds", type=int, default=ROUNDS, help="Processes of each case; fewer do not go to the docs."
    )
    parser.add_argument("--core", type=int, help="core to use; by default the last one")
    arguments = parser.parse_args()
    facts = runs.facts(arguments.core)
    data = run(arguments.rounds)
    report.save(report.TABLES if arguments.rounds >= ROUNDS else report.QUICK, "commands", data, facts)
    print(report.render(data))


if __name__ == "__main__":
    main()
