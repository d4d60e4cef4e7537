"""Starts with prescribed energy and Casimirs."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.compile.field import TopField
from liepoisson.errors import LeafError, ParameterError
from liepoisson.sweeps.run import sweep
from liepoisson.sweeps.starts import TopRows, project, system_functions

NAMES = ("energy", "C1", "C2", "C3")
TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.5, 0.2), b=(0.3, 0, -0.4), epsilon=0.5)


@pytest.mark.parametrize("epsilon", [0, 0.5, "7/10", -1 / 3, 0.1 + 0.2])
def test_the_functions_of_a_top_are_those_of_its_bracket(epsilon):
    top = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.5, 0.2), b=(0.3, 0, -0.4), epsilon=epsilon)
    x = lp.sample_states(top, 20, seed=1, ensemble="gaussian")
    rows = np.arange(20)
    values, gradients = TopRows.of([top.field()], 20).functions(NAMES)(x, rows)
    exact_values, exact_gradients = system_functions(top, NAMES)(x, rows)
    np.testing.assert_allclose(values, exact_values, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(gradients, exact_gradients, rtol=1e-13, atol=1e-13)


def test_a_row_does_not_depend_on_its_neighbours():
    x = lp.sample_states(TOP, 50, seed=2)
    wanted = np.tile([0.8, 1.0, 0.2, 1.0], (50, 1))
    functions = TopRows.of([TOP.field()], 50).functions(NAMES)
    together, _ = project(functions, wanted, x)
    for k in (0, 7, 49):
        alone, _ = project(TopRows.of([TOP.field()], 1).functions(NAMES), wanted[k : k + 1], x[k : k + 1])
        np.testing.assert_array_equal(alone[0], together[k])


NO_TOP = {
    "name": "quadratic",
    "bracket": {"algebra": "so(3)", "extension": "leibniz(3, epsilon)", "variables": ["l", "alpha", "beta"]},
    "parameters": {"symbols": ["epsilon", "k"]},
    "hamiltonian": {"expression": "dot(l, l)/2 + k*alpha[1]^2 + alpha[2]"},
}


def worst_first_casimir(system, x0, **_):
    """How far |alpha|^2 + 2 epsilon l.beta, in the documented form, is from 1 at the starts."""
    epsilon = float(system.bracket.extension.tensor[2][1][1])
    l, alpha, beta = x0[:, :3], x0[:, 3:6], x0[:, 6:]
    return np.abs((alpha**2 + 2 * epsilon * l * beta).sum(-1) - 1)


def test_casimirs_of_a_varying_bracket_are_one_function_at_all_points():
    given = {"system": NO_TOP, "n_starts": 2, "t_end": 1.0, "threads": 1, "quantity": worst_first_casimir}
    found = sweep(**given, parameters={"k": 1}, axes={"epsilon": [0.0, 0.25, 0.3, 0.51]}, starts={"C1": 1})
    assert found.outcomes == {"finished": 8}
    assert np.max(found.value) < 1e-11


def fourth_order(epsilon):
    return lp.System(lp.so(3) @ lp.leibniz(4, epsilon), lambda l, x, y, z: l.dot(l) / 2 + x[0])


@pytest.mark.thorough
def test_points_where_casimirs_are_other_functions_have_no_starts():
    """With epsilon = 0 the bracket has six Casimirs, and C1 is |x_1|^2 instead of x_1.x_2 + epsilon x_0.x_3."""
    given = {"system": fourth_order, "n_starts": 2, "t_end": 1.0, "threads": 1, "starts": {"C1": 1}}
    given["quantity"] = lambda system, x0, **_: np.zeros(len(x0))
    found = sweep(**given, axes={"epsilon": [-0.5, 0.0, 0.25, 0.5, 1.0]})
    assert found.outcomes == {"finished": 8, "no start": 2}
    assert "no start at 1 point; the first of them: no start: ParameterError: C1, C2, ..." in found.remarks[0]
    with pytest.raises(ParameterError, match=r"same functions at all points.*has 6 with .*have 4 with"):
        sweep(**given, axes={"epsilon": [-0.5, -0.25, 0.0]})
    assert sweep(**given, axes={"epsilon": [0.0]}).outcomes == {"finished": 2}


@pytest.mark.parametrize(("u", "v"), [(1e-9, 1.0), (1.0, 1e6), (1e9, 1e-6)])
def test_states_are_found_where_fields_have_units_of_their_own(u, v):
    """alpha in units 1/u, beta in units 1/v: the values are right relative to their own size."""
    top = TopField((1.5, 1.1, 0.8), (0.5 * u, -0.2 * u, 0.9 * u), (0.3 * v, 0.4 * v, -0.2 * v), 0.75 * v / u**2)
    functions = TopRows.of([top], 50).functions(["energy", "C1", "C2", "C3"])
    wanted = np.tile([1.0, u**-2, 0.3 / (u * v), 0.9 * v**-2], (50, 1))
    x = np.random.default_rng(0).standard_normal((50, 9)) / np.repeat([1.0, u, v], 3)
    moved, found = project(functions, wanted, x, length=3)
    assert found.sum() >= 45
    np.testing.assert_allclose(functions(moved[found], np.arange(found.sum()))[0], wanted[found], rtol=1e-11)


def test_energy_and_casimirs_are_given_side_by_side_or_nested():
    given = {"system": "heavy-top", "axes": {"I1": [1.5, 2]}, "n_starts": 4, "t_end": 10}
    flat = sweep(**given, starts={"energy": 0.5, "C1": 0.2, "C2": 1})
    nested = sweep(**given, starts={"energy": 0.5, "casimirs": {"C1": 0.2, "C2": 1}})
    assert flat.spec == nested.spec
    np.testing.assert_array_equal(flat.mean, nested.mean)
    with pytest.raises(ParameterError, match="starts: wanted C1 beside energy, or all in casimirs"):
        sweep(**given, starts={"C1": 0.2, "casimirs": {"C2": 1}})
    with pytest.raises(ParameterError, match="casimirs: wanted a mapping"):
        sweep(**given, starts={"casimirs": 3})


FAR = """
name = "far"
[bracket]
canonical = ["x", "y"]
[hamiltonian]
expression = "(p_x^2 + p_y^2)/2 + x^2/2 + y^2 + 6*x^2*y^2/5 + x^4/10"
"""


def test_starts_far_from_their_ensemble_are_found(tmp_path, capsys):
    """From unit vectors, H = 0.6, a leap to H = 12 overshot and stopped for two of three of them."""
    path = tmp_path / "far.toml"
    path.write_text(FAR)
    found = sweep(system=str(path), axes={"energy": [1, 12]}, n_starts=32, t_end=1)
    assert found.outcomes == {"finished": 64}
    system = lp.systems.read_system(path)
    guesses = lp.sample_states(system, 32, seed=0)
    states = lp.Leaf(system, {}).project(guesses, energy=12)
    np.testing.assert_allclose(system.functions.energy(states), 12, rtol=1e-13)
    one_by_one = [lp.Leaf(system, {}).project(guess, energy=12) for guess in guesses]
    np.testing.assert_array_equal(states, one_by_one)
    with pytest.raises(LeafError, match="On this leaf the energy lies between 0 and inf; -1 was asked for"):
        lp.Leaf(system, {}).project(guesses, energy=-1)
