"""What the page knows of tops: written by this code, with the equations and invariants of `Top` at every parameter."""

import importlib.util
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.compile.field import TapeField, TapeFunction, field_of
from liepoisson.laboratory.tops import PARAMETERS, description_of_tops, presets

WEB = Path(__file__).resolve().parents[2] / "web"
STATE = np.array([0.3, -0.7, 1.1, 0.4, 0.9, -0.2, -0.5, 0.6, 0.8])

TOPS = {
    "top": lp.Top(inertia=(1, 2, "5/2"), a=("1/3", -1, 2), b=(1, "1/2", -2), epsilon="2/3"),
    "heavy top": lp.Top.heavy((1, 2, "5/2"), ("1/3", -1, 2)),
    "twisted Lagrange": lp.Top.twisted_lagrange(axial="3/5", a3=2, b3=1, epsilon="1/3"),
    "charged Lagrange": lp.Top.charged_lagrange(axial="3/5", a3=2, b3=3),
    "Lagrange": lp.Top.lagrange(axial="3/5", a3=2),
    "Kovalevskaya": lp.Top.kovalevskaya(),
    "two-field Kovalevskaya": lp.Top.charged_heavy((2, 2, 1), (-1, 0, 0), (0, -1, 0)),
}


@cache
def description():
    return description_of_tops()


def parameters_of(top):
    return np.array([float(value) for value in (*top.inertia, *top.a, *top.b, top.epsilon)])


def values(functions, point):
    """A tape of functions, run line by line."""
    tape = TapeFunction(functions["n_components"], functions["instructions"], functions["outputs"])
    registers = list(point)
    for name, read, numbers in tape.instructions:
        operands = [registers[register] for register in read]
        match name:
            case "linear":
                registers.append(sum(c * r for c, r in zip(numbers, operands, strict=False)) + numbers[-1])
            case "product":
                registers.append(operands[0] * operands[1])
            case "quotient":
                registers.append(operands[0] / operands[1])
            case "power":
                registers.append(operands[0] ** numbers[0])
            case _:
                raise AssertionError(f"no polynomial needs {name}")
    return np.array([registers[register] for register in tape.outputs])


def test_the_file_of_the_page_is_written_by_this_code():
    spec = importlib.util.spec_from_file_location("build_tops", WEB / "build_tops.py")
    build = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(build)
    assert build.FILE.read_text(encoding="utf-8") == build.text(), "run `python web/build_tops.py`"


def family_of(point):
    """As the page finds it."""
    return [
        family
        for family in description()["families"]
        if family["conditions"] is None or not values(family["conditions"], point).any()
    ][-1]


@pytest.mark.parametrize("name", TOPS)
def test_the_last_family_of_a_top_has_its_invariants(name):
    top = TOPS[name]
    parameters = parameters_of(top)
    family = family_of(np.concatenate([STATE, parameters]))
    assert family["name"] == name
    assert len(set(family["names"])) == len(family["names"]) >= 4
    orbit = lp.integrate(top, STATE[None], times=[0, 1, 2, 3], threads=1)
    rows = np.array([values(family["functions"], np.concatenate([state, parameters])) for state in orbit.state[0]])
    assert not np.allclose(rows[0], 0)
    np.testing.assert_allclose(rows, np.broadcast_to(rows[0], rows.shape), rtol=0, atol=1e-12)  # measured 4e-14


@pytest.mark.parametrize("name", TOPS)
def test_state_and_attitude_move_together(name):
    top = TOPS[name]
    attitude = np.array([0.5, -0.1, 0.7, 0.5])
    point = np.concatenate([STATE, attitude, np.zeros(3), parameters_of(top)])
    moving = field_of(description()["moving"])
    assert isinstance(moving, TapeField)
    start = point[None]
    orbit = lp.integrate(moving, start, times=[0, 1], threads=1).state[0]
    alone = lp.integrate(top, STATE[None], times=[0, 1], threads=1).state[0]
    np.testing.assert_allclose(orbit[-1, :9], alone[-1], rtol=0, atol=1e-12)
    assert (orbit[-1, 16:] == point[16:]).all()
    np.testing.assert_allclose(orbit[-1, 9:13] @ orbit[-1, 9:13], attitude @ attitude, rtol=0, atol=1e-13)
    # the second field stands still in space, whatever the twist
    first, last = (turned(state[9:13]) @ state[6:9] for state in orbit)
    np.testing.assert_allclose(last, first, rtol=0, atol=1e-12)


def test_the_position_is_that_of_the_rod():
    top = TOPS["twisted Lagrange"]
    attitude = np.array([0.5, -0.1, 0.7, 0.5])
    rod = lp.orbits.rod(top, STATE, length=5, n_points=6, attitude=attitude, threads=1)
    point = np.concatenate([STATE, attitude, np.zeros(3), parameters_of(top)])
    orbit = lp.integrate(field_of(description()["moving"]), point[None], times=rod.arclength, threads=1).state[0]
    np.testing.assert_allclose(orbit[:, 13:16], rod.centre_line[0], rtol=0, atol=1e-13)  # measured 1e-15


@pytest.mark.parametrize("name", TOPS)
def test_the_ellipsoid_has_the_kinetic_energy_of_the_state(name):
    top = TOPS[name]
    squares = values(description()["ellipsoid"], np.concatenate([STATE, parameters_of(top)]))
    inertia, momentum = np.array([float(moment) for moment in top.inertia]), STATE[:3]
    energy = momentum @ (momentum / inertia) / 2
    np.testing.assert_allclose(squares, [*(2 * energy * inertia), momentum @ momentum], rtol=1e-14)


def turned(q):
    """The rotation of a unit quaternion."""
    w, x, y, z = q / np.linalg.norm(q)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


@pytest.mark.parametrize("preset", presets(), ids=lambda preset: preset["key"])
def test_presets_are_tops_with_their_parts(preset):
    numbers = [Fraction(text) for text in preset["parameters"]]
    assert len(numbers) == len(PARAMETERS)
    assert all(moment > 0 for moment in numbers[:3])
    assert len([float(Fraction(text)) for text in preset["start"]]) == len(description()["components"])
    assert {preset["surface"], *preset["axes"]} <= set(description()["components"])


def test_the_sticky_start_is_the_one_of_the_guide():
    top = lp.Top.heavy(inertia=(2, 2, 1.2), a=(-1, 0, 0))
    sticky = next(preset for preset in presets() if preset["key"] == "sticky")
    wanted = lp.sample_states(top, 1, seed=100, first=424)[0]
    assert [float(text) for text in sticky["start"]] == wanted.tolist()
