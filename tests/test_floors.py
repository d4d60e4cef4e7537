"""Dependencies at the floors that pyproject.toml declares: what it says is enough is enough."""

import os
import re
import subprocess
import tomllib
from pathlib import Path

import pytest

import liepoisson

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
ENVIRONMENT = ROOT / ".venv" / "floors"
"""Made by `make test-slow` from requirements/floors.txt, which `make lock` makes."""


def floors():
    """The floor of each direct dependency, by name."""
    project = PROJECT["project"]
    wanted = [
        *project["dependencies"],
        *project["optional-dependencies"]["notebook"],
        *PROJECT["dependency-groups"]["test"],
    ]
    return dict(re.fullmatch(r"([\w-]+)>=([\d.]+).*", text).groups() for text in wanted)


def numbers(version):
    """A version without the zeros at its end."""
    return re.sub(r"(\.0)+$", "", version)


def test_the_lock_file_has_every_dependency_at_its_floor():
    text = (ROOT / "requirements" / "floors.txt").read_text(encoding="utf-8")
    locked = dict(re.findall(r"^([\w-]+)==([\w.]+)", text, re.MULTILINE))
    assert {name: numbers(locked[name]) for name in floors()} == {name: numbers(v) for name, v in floors().items()}


@pytest.mark.slow
@pytest.mark.timeout(7200)
def test_the_quick_tests_pass_at_the_floors():
    """Old packages beside new ones under them warn of what they call; that is no fault of this package."""
    if not ENVIRONMENT.exists():
        pytest.skip(f"there is no {ENVIRONMENT}: make test-slow makes it")
    ignored = [option for kind in ("Deprecation", "Future") for option in ("-W", f"ignore::{kind}Warning")]
    call = [ENVIRONMENT / "bin" / "python", "-m", "pytest", "-n", "auto", "--dist", "loadfile", *ignored]
    environment = {**os.environ, "PYTHONPATH": str(Path(liepoisson.__file__).parents[1]), "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [*call, "-m", "not slow and not thorough"],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-4000:]
