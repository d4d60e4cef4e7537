"""The exact algebra in a browser's Python: Pyodide, whose words have 32 bits, without NumPy and the compiled core."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
WHEELS = Path(sys.prefix) / "browser"
"""Where `make test-slow` puts the wheels of requirements/browser.txt."""
FOLDERS = [f"tests/{name}" for name in ("algebra", "formula", "structure", "compile", "model", "report")]
LEAST = 1100
"""Tests that need neither NumPy nor the core: 1,158 when this was written."""


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_exact_algebra_in_a_browsers_python():
    if shutil.which("node") is None or not (ROOT / "web/node_modules/pyodide").is_dir():
        pytest.skip("needs node and the package pyodide: npm ci --prefix web")
    if not WHEELS.is_dir():
        pytest.skip("needs the wheels of requirements/browser.txt: make test-slow fetches them")
    command = ["node", "web/test/browser_python.mjs", str(ROOT), str(WHEELS), *FOLDERS]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    outcomes = json.loads(done.stdout.splitlines()[-1])
    assert not outcomes["failed"]
    assert outcomes["passed"] >= LEAST, outcomes
