"""What web/test/browser_python.mjs runs in Pyodide: pytest on the folders in FOLDERS; the last line printed is JSON.

NumPy is a part of Pyodide that no package registry offers, and the compiled core is not there: tests that end for want
of NumPy are counted as left out, all others have to pass.
"""

import json
import os
import sys
from pathlib import Path

sys.path[:0] = ["/repository/python", "/packages"]
sys.dont_write_bytecode = True
os.chdir("/repository")

import pytest  # noqa: E402  (from the packages)

HELPERS = ("tests", "tests/algebra/ideals", "tests/structure", "tests/compile", "tests/catalog")
WITHOUT_NUMPY = "ModuleNotFoundError: No module named 'numpy'"
SETTINGS = Path("/home/pytest.ini")
SETTINGS.write_text(
    "[pytest]\nmarkers =\n    slow: at full size\n    thorough: longer\npythonpath = "
    + " ".join(f"/repository/{h}" for h in HELPERS)
)


class Outcomes:
    """Counts of tests, and the texts of those that failed."""

    def __init__(self):
        self.passed, self.left_out, self.failed = 0, 0, {}

    def pytest_collectreport(self, report):
        self.take(report)

    def pytest_runtest_logreport(self, report):
        self.passed += report.when == "call" and report.passed
        self.take(report)

    def take(self, report):
        if report.failed:
            if report.longreprtext.rstrip().endswith(WITHOUT_NUMPY):
                self.left_out += 1
            else:
                self.failed[report.nodeid] = report.longreprtext[-2000:]


outcomes = Outcomes()
pytest.main(
    [
        *("-c", str(SETTINGS), "--rootdir=/repository", "--import-mode=importlib", "--tb=short", "-q"),
        *("-p", "no:cacheprovider", "-m", "not slow", "--continue-on-collection-errors"),
        *FOLDERS,  # noqa: F821  (set by browser_python.mjs)
    ],
    plugins=[outcomes],
)
print()
print(json.dumps(vars(outcomes)))
