"""How large is the package, and how long does its import take?  Sizes with and without dependencies, medians of times.

After `make wheel-check`:

    target/wheel-check/bin/python benchmarks/installed.py dist/*.whl
"""

from __future__ import annotations

import re
import statistics
import subprocess
import sys
import time
from importlib import metadata
from pathlib import Path

RUNS = 15
PROGRAMS = {
    "python alone": "pass",
    "import numpy": "import numpy",
    "import liepoisson": "import liepoisson",
    "and a first orbit": "import liepoisson as lp; top = lp.Top.twisted_kovalevskaya(); "
    "lp.integrate(top, lp.sample_states(top, 1, seed=1), t_end=10)",
}
"""What is timed, each in a new process."""


def size_of(name: str) -> int:
    """Bytes of the files of an installed distribution, without compiled Python."""
    files = metadata.files(name) or []
    return sum(Path(str(file.locate())).stat().st_size for file in files if file.suffix != ".pyc")


def with_dependencies(name: str) -> set[str]:
    """The distributions that one needs, itself among them, as far as they are installed here."""
    found: set[str] = set()
    open_names = [name]
    while open_names:
        one = re.sub(r"[-_.]+", "-", open_names.pop()).lower()
        try:
            requirements = metadata.requires(one) or []
        except metadata.PackageNotFoundError:  # for another system
            continue
        if one not in found:
            found.add(one)
            open_names += [re.match(r"[\w.-]+", text)[0] for text in requirements if "extra ==" not in text]
    return found


def seconds(program: str) -> list[float]:
    """Times of new processes, the first of which is not counted: it fills the caches of the disk."""
    times: list[float] = []
    for _ in range(RUNS + 1):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", program], check=True, cwd="/")
        times.append(time.perf_counter() - start)
    return times[1:]


def main() -> None:
    """Prints the sizes and the times."""
    for path in map(Path, sys.argv[1:]):
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB")
    names = with_dependencies("liepoisson")
    print(f"installed, the package alone: {size_of('liepoisson') / 1e6:.1f} MB")
    print(f"installed, with its {len(names) - 1} dependencies: {sum(map(size_of, names)) / 1e6:.0f} MB")
    for size, name in sorted(((size_of(name), name) for name in names), reverse=True)[:6]:
        print(f"  {name}: {size / 1e6:.1f} MB")
    for name, program in PROGRAMS.items():
        times = seconds(program)
        print(f"{name}: {statistics.median(times):.3f} s, from {min(times):.3f} to {max(times):.3f} ({RUNS} processes)")


if __name__ == "__main__":
    main()
