"""The numbers that the page shows, read from Chromium, against those that its own lines of Python compute.

The page has other last bits than Python: each step rounds a state to a few units, and the flow stretches what was
rounded.  Numbers are compared as long as that leaves them known, with the bound computed from the tangent flow; long
exponents of chaotic orbits are two realisations of one number, and are compared with the spread over starts on the
same orbit.
"""

import contextlib
import io
import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.laboratory.tops import presets

ROOT = Path(__file__).resolve().parents[2]
WEB = ROOT / "web"
PAGE = ROOT / "python" / "liepoisson" / "laboratory" / "page" / "index.html"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
EPSILON = float(np.finfo(float).eps)
UNITS = 8
"""Of the last place, to which a step may round a state."""
KNOWN = 1e-7
"""Beyond such an error a state is no longer compared."""
END = 100.0
"""States are compared up to here."""
CHAOTIC = {"twisted-kovalevskaya", "charged", "sticky", "collinear"}


@pytest.fixture(scope="module")
def page(request):
    """The presets of the page, and what it shows of those that the tests of this run ask for."""
    node = shutil.which("node")
    if node is None or not Path(CHROMIUM).exists() or not (WEB / "node_modules" / "playwright-core").is_dir():
        pytest.skip("to compare the page with Python, install node, Chromium and, in web/, the packages (npm ci)")
    here = (item for item in request.session.items if item.path == request.path)
    wanted = dict.fromkeys(item.callspec.params["key"] for item in here if hasattr(item, "callspec"))
    command = [node, str(WEB / "test" / "numbers.mjs"), str(PAGE), *wanted]
    done = subprocess.run(command, capture_output=True, text=True, timeout=400, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def shown(page):
    return page["found"]


@pytest.fixture(scope="module")
def computed(shown):
    """What the copied lines of each preset compute: their variables."""
    found = {}
    for key, page in shown.items():
        variables = {}
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(page["lines"], f"<copied from {key}>", "exec"), variables)
        found[key] = variables
    return found


KEYS = [preset["key"] for preset in presets()]
QUICK = {"twisted-lagrange", "twisted-kovalevskaya", "charged"}
"""A regular orbit, a chaotic one, and two constant fields."""
each_preset = pytest.mark.parametrize(
    "key", [pytest.param(key, marks=[pytest.mark.slow] if key not in QUICK else []) for key in KEYS]
)


def errors(top, start, times, method):
    """How far two computations of the orbit may be apart at each time, by round-off."""
    orbit = lp.integrate(top, start, times=times, tangents=np.eye(9)[None], method=method, threads=1)
    flow = orbit.tangent[0].swapaxes(-1, -2)
    back = np.linalg.pinv(flow)
    size = np.abs(orbit.state[0]).max()
    stretched = [max(np.linalg.norm(flow[k] @ back[j], 2) for j in range(k + 1)) for k in range(len(times))]
    steps = np.maximum(orbit.n_steps[0] * times / times[-1], 1)
    return UNITS * EPSILON * steps * size * np.array(stretched)


def test_all_presets_are_on_the_page(page):
    assert page["keys"] == KEYS


@each_preset
def test_the_lines_are_of_the_preset(shown, computed, key):
    preset = next(preset for preset in presets() if preset["key"] == key)
    top = computed[key]["top"]
    assert [str(value) for value in (*top.inertia, *top.a, *top.b, top.epsilon)] == preset["parameters"]


@each_preset
def test_invariants(shown, computed, key):
    page, orbit = shown[key], computed[key]["orbit"]
    values = {name: row[0, 0] for name, row in orbit.invariants.items()}
    missing = [name for name in values if name not in page["names"] and name not in {"l^2", "P"}]
    assert not missing
    for name, first, text in zip(page["names"], page["first"], page["shown"], strict=True):
        if name in values:
            assert abs(first - values[name]) <= UNITS * EPSILON * max(1, abs(first)), name
        assert abs(text - first) <= 5.1e-7, name
    assert page["drift"] < 1e-11  # measured at most 1e-12


@each_preset
def test_crossings(shown, computed, key):
    page, variables = shown[key]["crossings"], computed[key]
    section, top = variables["section"], variables["top"]
    # about as many: long orbits are two realisations
    assert abs(page["shown"] - len(section.time)) <= max(2, 6 * np.sqrt(len(section.time)))
    assert page["shown"] == len(page["time"])
    times = np.concatenate([[0.0], section.time[section.time < END]])
    error = errors(top, variables["start"], times, variables["method"])
    n = int(np.searchsorted(error[1:], KNOWN))
    assert n >= (2 if key == "charged" else 5)  # the charged top crosses seldom, and the flow stretches by e^0.27 t
    surface = list(top.component_names).index(section.surface)
    for k in range(n):
        state = section.state[k]
        rates = top.vector_field(state)
        slope = abs(rates[surface])
        bound = error[k + 1] * (1 + (1 + np.abs(rates).max()) / slope)
        assert abs(page["time"][k] - section.time[k]) <= bound, f"time of crossing {k}"
        assert np.abs(np.array(page["state"][k]) - state).max() <= bound, f"crossing {k}"


@each_preset
def test_exponents(shown, computed, key):
    page, variables = shown[key]["exponent"], computed[key]
    growth, start = variables["growth"], np.array(variables["start"], dtype=float)
    chart = dict(zip(page["time"], page["value"], strict=True))
    python = dict(zip(growth.time.tolist(), growth.exponent[0].tolist(), strict=True))
    assert set(python) <= set(chart)
    assert max(python) == max(chart)
    times = np.array([0.0, *(time for time in python if time <= END)])
    error = errors(variables["top"], start, times, variables["method"])
    # an exponent reads the state through the Jacobian, which is linear in it: its error is a few times that of states
    compared = [(time, bound) for time, bound in zip(times[1:], error[1:], strict=True) if bound < KNOWN]
    assert len(compared) >= 20
    for time, bound in compared:
        assert abs(chart[time] - python[time]) <= 10 * bound, f"t = {time}"
    last = max(chart)
    digits = len(page["shown"].partition(".")[2])
    assert abs(float(page["shown"]) - chart[last]) <= 0.51 * 10.0**-digits
    assert abs(chart[last] - python[last]) <= spread(variables, last, key)


def spread(variables, time, key):
    """Between realisations of a chaotic orbit six standard deviations; of a regular one rounding."""
    if key not in CHAOTIC:
        return 1e-6
    orbit = lp.integrate(variables["top"], variables["start"], times=np.linspace(0, 2000, 25)[1:], threads=1)
    found = lp.finite_time_exponents(
        variables["top"], orbit.state[0], times=[time], tangents=np.ones(9), method=lp.Taylor(tol=1e-12), threads=1
    )
    return 6 * float(found.exponent.std())
