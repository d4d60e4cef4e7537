"""On what was it measured?  The peers' own environments, the core that is used, the facts that go with the numbers."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import time
import venv
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import measure

FLAGS = ("avx", "avx2", "fma", "avx512f", "avx512dq", "avx512vl")
"""Processor flags that decide which kernels either side may use."""
QUIET = 0.7
"""Load average below which nothing else is computing."""
PATIENCE = 180.0
"""Seconds to wait for it: the load average still counts what ended a minute ago, such as the benchmark before."""


def ensure_peer() -> None:
    """Make benchmarks/.venv with the pinned heyoka, unless it is there and matches requirements.txt."""
    _ensure(measure.HERE / ".venv", measure.HERE / "requirements.txt")


def ensure_peers() -> dict[str, str]:
    """Make target/benchmark-peers with the other tools; those that cannot be installed, and why."""
    _ensure(measure.PEERS_VENV, measure.HERE / "requirements-peers.txt")
    failure = _install_numbalsoda(measure.PYTHON["numbalsoda"])
    return {"numbalsoda": failure} if failure else {}


def _ensure(folder: Path, requirements: Path) -> None:
    stamp = folder / "installed.txt"
    if stamp.exists() and stamp.read_text() == requirements.read_text():
        return
    venv.create(folder, clear=True, symlinks=True, with_pip=True)
    python = str(folder / "bin" / "python")
    subprocess.run([python, "-m", "pip", "install", "--quiet", "-r", str(requirements)], check=True)
    stamp.write_text(requirements.read_text())


def _install_numbalsoda(python: Path) -> str:
    """Install it if it is not there yet; why that failed, or nothing."""
    present = subprocess.run([str(python), "-c", "import numbalsoda"], capture_output=True, check=False)
    if present.returncode == 0:
        return ""
    requirements = str(measure.HERE / "requirements-numbalsoda.txt")
    command = [str(python), "-m", "pip", "install", "--quiet", "--no-deps", "-r", requirements]
    installed = subprocess.run(command, capture_output=True, text=True, check=False)
    if installed.returncode == 0:
        return ""
    if shutil.which("gfortran") is None:
        return "not installable: no wheel for this Python, and no Fortran compiler (gfortran) to build it with"
    return f"not installable: {installed.stderr.strip().splitlines()[-1]}"


def pin(core: int | None) -> int:
    """Keep this process and all that it starts on one core, by default the last that it may use.

    Raises:
        RuntimeError: The system cannot pin processes (Linux can).
    """
    if not hasattr(os, "sched_setaffinity"):
        raise RuntimeError("the benchmark pins processes to one core, which needs Linux")
    chosen = max(os.sched_getaffinity(0)) if core is None else core
    os.sched_setaffinity(0, {chosen})
    return chosen


def _processor() -> dict[str, Any]:
    first = Path("/proc/cpuinfo").read_text().split("\n\n", maxsplit=1)[0].splitlines()
    lines = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in first)}
    flags = set(lines.get("flags", "").split())
    names = ("vendor_id", "cpu family", "model", "model name", "cache size")
    return {name: lines.get(name, "unknown") for name in names} | {"flags": [f for f in FLAGS if f in flags]}


def quiet_load(patience: float = PATIENCE) -> float:
    """The load average, once it is below `QUIET`, or what it is when patience ends."""
    end = time.monotonic() + patience
    if os.getloadavg()[0] > QUIET:
        print(f"waiting for a load below {QUIET}, at most {patience:g} seconds", file=sys.stderr, flush=True)
    while os.getloadavg()[0] > QUIET and time.monotonic() < end:
        time.sleep(1.0)
    return os.getloadavg()[0]


def facts(core: int) -> dict[str, Any]:
    """Date, commit, machine, versions, and the kernels of liepoisson that this processor has."""
    commit = ["git", "-C", str(measure.ROOT), "describe", "--always", "--dirty", "--exclude=*"]
    return {
        "date": datetime.now(UTC).isoformat(timespec="minutes"),
        "commit": subprocess.run(commit, capture_output=True, text=True, check=False).stdout.strip(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "pinned_to": core,
        "system": platform.platform(),
        "python": sys.version.split()[0],
        "load_at_start": quiet_load(),
        "heyoka": measure.call("heyoka", {"task": "versions"})[0],
        "liepoisson": measure.call("liepoisson", {"task": "versions"})[0],
    }
