"""The core in WebAssembly, as it is shipped: made from these sources, and with the numbers that Python has.

WebAssembly has no fused multiply-add, so that the last bits of its numbers are others.  Each step rounds both to a few
units, and the flow stretches what was rounded; bounds are eight units in every step, stretched as much as the tangent
flow stretches anything from an earlier time to this one.
"""

import importlib.util
import json
import os
import re
import shutil
import subprocess
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.compile.field import TapeField, TapeFunction, record_of
from liepoisson.laboratory.description import description_of
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.sampling import sample_alignment_vectors, sample_tangents
from liepoisson.numeric.systems import as_field
from liepoisson.numeric.time_scale import orbit_units

ROOT = Path(__file__).resolve().parents[2]
WEB = ROOT / "web"
PAGE = ROOT / "python" / "liepoisson" / "laboratory" / "page"
EPSILON = float(np.finfo(float).eps)
UNITS = 8
"""Of the last place, to which a step may round a state."""

TOP = lp.Top.twisted_kovalevskaya()
START = np.array([0.3, 0.2, 0.5, 1, 0, 0, 0, 1, 0])
PENDULUM = TapeField(
    2,
    (("sin", (0,), ()), ("exp", (0,), ()), ("linear", (2, 3), (-1.0, -0.25, 0.0))),
    (1, 4),
)
"""q' = p, p' = -sin q - exp(q)/4."""
ROTOR = TapeField(2, (("sin", (0,), ()), ("linear", (2,), (-1.0, 0.0))), (1, 3))
"""q' = p, p' = -sin q: the first start goes round forwards, the second backwards, which alone is crossed."""
PENDULUM_ENERGY = TapeFunction(
    2,
    (("product", (1, 1), ()), ("cos", (0,), ()), ("exp", (0,), ()), ("linear", (2, 3, 4), (0.5, -1.0, 0.25, 0.0))),
    (5,),
)
CIRCLE = TapeFunction(1, (("sin", (0,), ()), ("cos", (0,), ())), (1, 2))
ROTATION = TapeFunction(2, (("sin", (0,), ()), ("cos", (0,), ())), (2,), 3)
"""Where q is a multiple of a whole turn."""
N_DRIFTING = 100
"""Orbits whose Casimirs are looked at."""


def builder():
    spec = importlib.util.spec_from_file_location("build_core", WEB / "build_core.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_program_is_made_from_these_sources():
    build = builder()
    record = json.loads((PAGE / "core.json").read_text(encoding="utf-8"))
    assert record["program"] == build.hash_of(PAGE / "core.wasm")
    assert record["sources"] == build.hash_of_sources(), (
        "the core was changed since core.wasm was built; `make wasm` builds it again"
    )


def bounds(system, start, times, method=None):
    """How far two computations of a state may be apart at each time, by round-off."""
    n = as_field(system).n_components
    orbit = lp.integrate(system, start, times=times, tangents=np.eye(n)[None], method=method, threads=1)
    flow = orbit.tangent[0].swapaxes(-1, -2)
    back = np.linalg.pinv(flow)
    size = np.abs(orbit.state[0]).max()
    stretched = [max(np.linalg.norm(flow[k] @ back[j], 2) for j in range(k + 1)) for k in range(len(times))]
    steps = np.maximum(orbit.n_steps[0] * (times - times[0]) / (times[-1] - times[0]), 1)
    return UNITS * EPSILON * steps * size * np.array(stretched)


def orbit_case(name, system, start, times, method=None, *, field=None):
    orbit = lp.integrate(
        system, start, times=times, method=method, kernel="lanes" if system is TOP else None, threads=1
    )
    method = lp.Taylor() if method is None else method
    return {
        "name": name,
        "field": field or record_of(as_field(system)),
        "method": {"kind": method.name, **asdict(method)},
        "start": list(start),
        "times": times.tolist(),
        "state": orbit.state[0].tolist(),
        "bounds": bounds(system, start, times, method).tolist(),
        "dense": isinstance(method, lp.Taylor),
    }


def section_case(name, system, tape, starts, *, end, direction, rate, kept_slope=1.0):
    """`rate` gives the derivatives of the surface function and of the state along the orbit."""
    found = lp.section(system, starts, surface=tape, t_end=end, direction=direction, threads=1)
    margin = []
    for member, start in enumerate(starts):
        of_member = found.crossing_trajectory == member
        if not of_member.any():
            continue
        times = np.concatenate([[0.0], found.time[of_member]])
        states = lp.integrate(system, start, times=times, threads=1).state[0][1:]
        for error, state in zip(bounds(system, start, times)[1:], states, strict=True):
            surface_rate, rates = rate(state)
            margin.append(kept_slope * error * (1 + (1 + np.abs(rates).max()) / abs(surface_rate)))
    return {
        "name": name,
        "field": record_of(as_field(system)),
        "surface": asdict(tape),
        "starts": np.asarray(starts).tolist(),
        "end": end,
        "direction": direction,
        "count": np.bincount(found.crossing_trajectory, minlength=len(starts)).tolist(),
        "time": found.time.tolist(),
        "sign": found.sign.tolist(),
        "state": found.state.tolist(),
        "bounds": margin,
    }


def exponent_case(name, system, starts, tangents, times):
    growth = lp.finite_time_exponents(system, starts, times=times, tangents=tangents, threads=1)
    from_zero = np.concatenate([[0.0], times])
    errors = [bounds(system, start, from_zero)[1:] for start in starts]
    return {
        "name": name,
        "field": record_of(as_field(system)),
        "starts": np.asarray(starts).tolist(),
        "tangents": np.asarray(tangents).tolist(),
        "times": from_zero.tolist(),
        "exponent": growth.exponent.tolist(),
        # the vector is stretched along an orbit that is off by the error of the state
        "bounds": (4 * np.array(errors)).ravel().tolist(),
    }


def verdict_case(name, system, starts, end, distance):
    """Verdicts with Python's tangent vectors; `distance` is that of indicators, for orbits that are regular."""
    found, n = lp.decide(system, starts, t_end=end), len(starts[0])
    units = orbit_units(system, starts, RunOptions.read(None, 1, 60.0, system=system))
    growing = sample_tangents(n, len(starts), seed=0)[:, None]
    vectors = np.concatenate([growing, sample_alignment_vectors(n, len(starts), 2, seed=0)], axis=1)
    return {
        "name": name,
        "field": record_of(as_field(system)),
        "starts": np.asarray(starts).tolist(),
        "tangents": (units.component[:, None] * vectors).tolist(),
        "times": units.time.tolist(),
        "units": units.component.tolist(),
        "end": end,
        "kinds": [("regular", "undecided", "chaotic").index(kind) - 1 for kind in found.verdict],
        "indicators": np.stack([found.growth_power, found.mean_megno, found.sali, found.average_drift], -1).tolist(),
        "distance": distance,
    }


def typed_case(name, system, description, start, *, surface, equations=None):
    """A system as a page gives it, against the same one of Python; `surface` is the name of a coordinate."""
    start, times, end = np.array(start), np.linspace(0, 10, 11), 10.0
    number = system.component_names.index(surface)
    exponent_times, tangent = np.array([5.0, 10.0]), np.arange(1.0, len(start) + 1)
    plane = TapeFunction(len(start), (), (number,))
    crossings = section_case(
        name, system, plane, [start], end=end, direction=1, rate=rate_of(number, system.vector_field)
    )
    growth = exponent_case(name, system, [start], [tangent], exponent_times)
    return {
        "name": name,
        "description": description,
        "equations": [{"name": name, "rate": rate} for name, rate in (equations or {}).items()],
        "start": start.tolist(),
        "times": times.tolist(),
        "state": lp.integrate(system, start, times=times, threads=1).state[0].tolist(),
        "bounds": bounds(system, start, times).tolist(),
        "section": {
            "surface": surface,
            "end": end,
            **{key: crossings[key] for key in ("count", "time", "state", "bounds")},
        },
        "exponent": {
            "tangent": tangent.tolist(),
            "times": growth["times"],
            "value": growth["exponent"][0],
            "bounds": growth["bounds"],
        },
    }


DOUBLE_PENDULUM = """\
(m[2]*l[2]^2*p_theta1^2 + (m[1] + m[2])*l[1]^2*p_theta2^2 - 2*m[2]*l[1]*l[2]*p_theta1*p_theta2*cos(theta1 - theta2))\
/(2*m[2]*l[1]^2*l[2]^2*(m[1] + m[2]*sin(theta1 - theta2)^2))\
 - (m[1] + m[2])*g*l[1]*cos(theta1) - m[2]*g*l[2]*cos(theta2)"""


def typed_cases():
    """Three systems that are typed."""
    return [
        typed_case(
            "Hénon–Heiles",
            lp.catalog.system("henon-heiles"),
            {
                "bracket": {"name": "canonical", "coordinates": ["x", "y"]},
                "hamiltonian": "(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3",
            },
            [0.0, 0.1, 0.35, 0.1],
            surface="x",
            equations={"x": "p_x", "y": "p_y", "p_x": "-x - 2*x*y"},
        ),
        typed_case(
            "twisted top",
            lp.Top.twisted(inertia=(2, "3/2", 1), a=(-1, 0, "1/2"), epsilon=0.3),
            {
                "bracket": {"name": "leibniz", "n": 3, "epsilon": "epsilon"},
                "hamiltonian": "dot(l, inv(I)*l)/2 + dot(a, alpha)",
                "parameters": {"I": [2, "3/2", 1], "a": [-1, 0, "1/2"], "epsilon": 0.3},
            },
            START,
            surface="alpha3",
        ),
        typed_case(
            "double pendulum",
            lp.catalog.system("double-pendulum"),
            {
                "bracket": {"name": "canonical", "coordinates": ["theta1", "theta2"]},
                "hamiltonian": DOUBLE_PENDULUM,
                "parameters": {"m": [1, 1], "l": [1, "1"], "g": 1},
            },
            [0.5, 0.2, 0.1, -0.3],
            surface="theta1",
        ),
    ]


def value_case(name, functions, states, values):
    terms = len(functions.instructions) + 1
    return {
        "name": name,
        "functions": asdict(functions),
        "states": states.tolist(),
        "values": values.tolist(),
        "bounds": [UNITS * EPSILON * terms * max(1.0, float(np.abs(row).max())) for row in values],
    }


def rate_case(name, system, states):
    rates = system.vector_field(states)
    return {
        "name": name,
        "field": record_of(as_field(system)),
        "states": states.tolist(),
        "rates": rates.tolist(),
        "bounds": [UNITS * EPSILON * max(1.0, float(np.abs(row).max()) ** 2) for row in states],
    }


PROJECTED = {
    "twisted Kovalevskaya": lp.Top.twisted_kovalevskaya(),
    "twisted Lagrange": lp.Top.twisted_lagrange(axial="3/5", a3=1, b3="1/2", epsilon="1/3"),
    "charged heavy top": lp.Top.charged_heavy((1, "3/2", 2), (1, 0, "1/2"), (0, 1, 0)),
    "heavy top": lp.Top.heavy((2, 2, "6/5"), (-1, 0, 0)),
    "weak field": lp.Top(inertia=(1, 2, 3), a=(1000, 0, 0), b=(0, 0, 1000), epsilon="1/2"),
}
CLOSE = 1e-14
"""Relative distance of two projections: each Newton step is a rounded solution of the same equations."""


def projection_case(name, top):
    """From a state that is not on the leaf, to a leaf and an energy through another state."""
    rng = np.random.default_rng(len(name))
    there = rng.normal(size=9)
    there[3:] /= np.repeat([max(1, *(abs(float(x)) for x in v)) for v in (top.a, top.b)], 3)
    start = there * (1 + 0.05 * rng.normal(size=9))
    leaf, energy = lp.Leaf.through(top, there), float(top.functions.energy(there))
    view = leaf.in_units(energy)
    tape = top.function_tape(*(top.invariants[key] for key in ("H", *leaf.casimirs)))
    return {
        "name": name,
        "functions": asdict(tape),
        "start": start.tolist(),
        "values": [energy, *leaf.casimirs.values()],
        "units": view.units.tolist(),
        "state": leaf.project(start, energy=energy).tolist(),
        "bound": CLOSE,
    }


def drift_case():
    """The rms error of a Casimir, and whether it has a sign.

    Along orbits that start close together errors in [0, t] and in [t, 16 t] are independent, of variances as 1 to 15 if
    errors of single steps are.  The logarithm of their ratio has the standard deviation sqrt(4/n), and both tests fail
    once in a million times; measured: a ratio of 1.2, and errors 0.9 standard errors off zero.  With an error that has
    a sign, as t^0.8, the ratio is 4.5 times as large.
    """
    invariants = description_of(TOP)["invariants"]
    noise = np.random.default_rng(7).normal(size=(N_DRIFTING, 9))
    width = float(np.exp(4.9 * np.sqrt(4 / N_DRIFTING)))
    return {
        "field": record_of(as_field(TOP)),
        "invariants": invariants["functions"],
        "index": invariants["names"].index("C1"),
        "starts": (START + 1e-3 * noise).tolist(),
        "short": 250.0,
        "long": 4000.0,
        "limits": [1 / width, width, 5.3],
    }


def rate_of(component, field):
    def rate(state):
        rates = field(state)
        return rates[component], rates

    return rate


def pendulum_rates(x):
    return np.array([x[1], -np.sin(x[0]) - np.exp(x[0]) / 4])


def cases():
    henon = lp.catalog.system("henon-heiles")
    times, rng = np.linspace(0, 30, 31), np.random.default_rng(1)
    starts = [START, START + 0.1]
    states = rng.normal(size=(5, 9))
    plane = TapeFunction(9, (), (2,))
    half = TapeFunction(4, (("linear", (1,), (2.0, 0.0)), ("product", (1, 3), ())), (0, 4, 5))
    wave = TapeFunction(2, (("linear", (0,), (1.0, 0.5)), ("sin", (2,), ())), (3,))
    tangents, angles = rng.normal(size=(2, 9)), np.geomspace(1, 1e8, 200)[:, None]
    invariants = TOP.function_tape(*TOP.invariants.values())
    return {
        "orbits": [
            orbit_case("twisted Kovalevskaya top", TOP, START, times),
            orbit_case("quadratic field", henon, np.array([0.0, 0.1, 0.35, 0.1]), times),
            orbit_case("tape with sine and exponential", PENDULUM, np.array([0.4, 1.2]), times),
            orbit_case("pieces", TOP.pieces(), START, times[:6], lp.Splitting(order=4, step=0.02)),
            orbit_case("backwards", TOP, START, -times[:11]),
        ],
        "sections": [
            section_case("top", TOP, plane, starts, end=30.0, direction=1, rate=rate_of(2, TOP.vector_field)),
            section_case(
                "kept functions", henon, half, [[0.0, 0.1, 0.35, 0.1]],
                end=60.0, direction=0, rate=rate_of(0, henon.vector_field), kept_slope=2.0,
            ),
            section_case(
                "surface with a sine", PENDULUM, wave, [[0.4, 1.2]],
                end=30.0, direction=-1, rate=lambda x: (np.cos(x[0] + 0.5) * x[1], pendulum_rates(x)),
            ),
            section_case(
                "angle modulo a turn", ROTOR, ROTATION, [[0.4, 3.0], [1.0, -3.0]],
                end=30.0, direction=-1, rate=lambda x: (np.cos(x[0]) * x[1], np.array([x[1], -np.sin(x[0])])),
            ),
        ],
        "typed": typed_cases(),
        "exponents": [exponent_case("top", TOP, starts, tangents, np.array([5.0, 10.0, 20.0]))],
        "verdicts": [
            verdict_case("henon-heiles", henon, [[0.0, 0.1, 0.3, 0.0], [0.0, -0.1, 0.5, 0.0]], 1000.0, 1e-6),
            verdict_case("top", TOP, starts, 300.0, 1e-6),
        ],
        "values": [
            value_case("invariants", invariants, states, np.stack(list(TOP.invariant_values(states).values()), -1)),
            value_case(
                "energy of a pendulum",
                PENDULUM_ENERGY,
                states[:, :2],
                (states[:, 1] ** 2 / 2 - np.cos(states[:, 0]) + np.exp(states[:, 0]) / 4)[:, None],
            ),
            value_case("sine and cosine of large angles", CIRCLE, angles, np.hstack([np.sin(angles), np.cos(angles)])),
        ],
        "rates": [rate_case("top", TOP, states), rate_case("quadratic field", henon, states[:, :4])],
        "projections": [projection_case(name, top) for name, top in PROJECTED.items()],
        "drift": drift_case(),
    }  # fmt: skip


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """What each test in node says: its name, and whether it passed; and all of it as text."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("to test the core in WebAssembly, install Node.js 20 or newer (Debian, Ubuntu: apt install nodejs)")
    file = tmp_path_factory.mktemp("web") / "cases.json"
    file.write_text(json.dumps(cases(), allow_nan=False), encoding="utf-8")
    done = subprocess.run(
        [node, "--test", "--test-reporter=tap", str(WEB / "test" / "core.test.mjs")],
        env={**os.environ, "LIEPOISSON_CASES": str(file), "LIEPOISSON_CORE": str(PAGE / "core.wasm")},
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    found = re.findall(r"^ *(not ok|ok) \d+ - (.*)$", done.stdout, re.MULTILINE)
    return {name: verdict == "ok" for verdict, name in found}, done.stdout + done.stderr


NAMES = [
    "orbit: twisted Kovalevskaya top",
    "orbit: quadratic field",
    "orbit: tape with sine and exponential",
    "orbit: pieces",
    "orbit: backwards",
    "section: top",
    "section: kept functions",
    "section: surface with a sine",
    "section: angle modulo a turn",
    "exponents: top",
    "verdicts: henon-heiles",
    "verdicts: top",
    "a system is written as trees that the core derives",
    "typed: Hénon–Heiles",
    "typed: twisted top",
    "typed: double pendulum",
    "a formula that is refused says where",
    "values: invariants",
    "values: energy of a pendulum",
    "values: sine and cosine of large angles",
    "rates: top",
    "rates: quadratic field",
    *(f"projection: {name}" for name in PROJECTED),
    "a projection that has no solution says how far it is",
    "coefficients are divided by their order as IEEE 754 divides",
    "errors of Casimirs grow as the square root of time",
    "what is refused has a kind and a message, and the core goes on",
    "memory is given back",
    "a core that has stopped says so, and a new one starts",
]


@pytest.mark.parametrize("name", NAMES)
def test_in_node(results, name):
    verdicts, text = results
    assert verdicts.get(name), text


def test_all_tests_in_node_are_known(results):
    verdicts, text = results
    assert {name for name in verdicts if not name.endswith(".mjs")} == set(NAMES), text
