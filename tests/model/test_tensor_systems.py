"""Systems on brackets that are given by formulas: the same engine, sections, exponents, leaves and files."""

import pickle

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import BracketError, LiePoissonError, ParameterError, SystemFileError, UnsupportedFieldError

VOLTERRA = lp.System(
    lp.PoissonTensor(
        ["x1", "x2", "x3", "x4"], {("x1", "x2"): "a*x1*x2", ("x2", "x3"): "x2*x3", ("x3", "x4"): "x3*x4"}, {"a": "3/2"}
    ),
    "x1 + x2 + x3 + x4 - log(x1) - 2*log(x2) - log(x3) - log(x4)",
    name="a chain of four species",
)
PENDULUM = {("c", "p"): "-s", ("s", "p"): "c"}
"""{q, p} = 1 in c = cos q, s = sin q, written with a factor that is 1 on the circle."""
ROUND = {pair: f"({entry})/sqrt(c^2 + s^2)*(1 + p^2*(1 - c^2 - s^2)^2)" for pair, entry in PENDULUM.items()}
ROTOR = lp.System(
    lp.brackets.nambu("x^4/4 + y^4/4 + z^4/4 + x*y*z", ["x", "y", "z"]), "x^2/2 + y^2 + 3*z^2/2 + x*y/5", name="rotor"
)
START = [0.4, -0.7, 0.9]


def rates_by_hand(x):
    """x' = J grad H of the chain, as it is written in books."""
    x1, x2, x3, x4 = x
    s = [x1 - 1, x2 - 2, x3 - 1, x4 - 1]  # x dH/dx
    return [1.5 * x1 * s[1], x2 * (s[2] - 1.5 * s[0]), x3 * (s[3] - s[1]), -x4 * s[2]]


def test_equations_are_those_by_hand():
    rng = np.random.default_rng(1)
    for x in rng.uniform(0.5, 3, (5, 4)):
        np.testing.assert_allclose(VOLTERRA.vector_field(x), rates_by_hand(x), rtol=1e-13)
    np.testing.assert_allclose(VOLTERRA.vector_field([1, 2, 1, 1]), 0, atol=1e-15)


def test_the_core_follows_the_same_equations():
    """An orbit of the core against SciPy's, which is given the equations by hand."""
    from scipy.integrate import solve_ivp

    start = [1.2, 1.5, 0.8, 1.1]
    run = lp.integrate(VOLTERRA, start, times=[0, 5, 10], method=lp.Taylor(tol=1e-15))
    other = solve_ivp(lambda _, x: rates_by_hand(x), (0, 10), start, t_eval=[0, 5, 10], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(run.state[0], other.y.T, rtol=1e-9)


def test_bits_do_not_depend_on_how_the_hamiltonian_is_given():
    expression = lp.System(ROTOR.bracket, ROTOR.hamiltonian)
    runs = [lp.integrate(one, START, t_end=5).end_state for one in (ROTOR, expression)]
    np.testing.assert_allclose(runs[0], runs[1], rtol=1e-13)
    assert lp.System(ROTOR.bracket, "x").field().kind == "tape"  # cubic rates
    assert lp.System(lp.brackets.log_canonical([[0, 1], [-1, 0]]), "x1 + x2").field().kind == "quadratic"


def test_invariants_are_kept():
    assert list(ROTOR.invariants) == ["H", "C1"]
    run = lp.integrate(ROTOR, START, t_end=200, method=lp.Taylor(tol=1e-15))
    for name, values in ROTOR.invariant_values(run.state[0]).items():
        drift = np.abs(values - values[0]).max()
        assert drift < 1e-12, f"{name} drifts by {drift}"


def test_sections_and_exponents():
    points = lp.section(ROTOR, START, surface="y + 7/10", direction=1, t_end=200)
    assert points.count[0] > 10
    assert np.abs(points.state[:, 1] + 0.7).max() < 1e-12
    growth = lp.lyapunov_exponent(ROTOR, START, t_end=2000)
    assert abs(growth.exponent[0]) < 0.01  # two integrals in three dimensions
    spectrum = lp.lyapunov_spectrum(ROTOR, START, t_end=200)
    assert spectrum.exponent.shape[-1] == 3


def test_derivatives_of_the_tensor_and_of_the_field():
    x, h = np.array(START), 1e-6
    functions = ROTOR.functions
    slopes = np.stack(
        [(functions.poisson_tensor(x + h * e) - functions.poisson_tensor(x - h * e)) / (2 * h) for e in np.eye(3)]
    )
    np.testing.assert_allclose(functions.poisson_slopes(x), slopes, atol=1e-8)
    rates = np.stack([(ROTOR.vector_field(x + h * e) - ROTOR.vector_field(x - h * e)) / (2 * h) for e in np.eye(3)], 1)
    np.testing.assert_allclose(functions.jacobian(x), rates, atol=1e-8)
    top = lp.Top.kovalevskaya().functions
    assert top.poisson_slopes(np.ones((2, 9))).shape == (2, 9, 9, 9)
    np.testing.assert_array_equal(
        np.einsum("m,mij->ij", np.arange(9.0), top.poisson_slopes(np.ones(9))), top.poisson_tensor(np.arange(9.0))
    )


def test_leaves_and_equilibria():
    leaf = lp.Leaf.through(ROTOR, START)
    assert leaf.rank == 2
    x = np.array(START)
    assert leaf.casimirs["C1"] == pytest.approx(float(np.sum(x**4) / 4 + x.prod()))
    found = lp.equilibria(ROTOR, leaf=leaf)
    assert len(found) >= 2
    for one in found:
        assert np.abs(ROTOR.vector_field(one.state)).max() < 1e-10


def test_states_of_a_leaf_are_sampled_where_volume_is_kept():
    states = lp.Leaf.through(ROTOR, [0.4, 0.7, 0.9]).sample(50, seed=1)  # of one part: where C1 < 0 there are four
    values = ROTOR.invariant_values(states)["C1"]
    np.testing.assert_allclose(values, values[0], rtol=1e-9)
    with pytest.raises(LiePoissonError, match="unimodular"):
        lp.Leaf.through(VOLTERRA, [1, 1, 1, 1]).sample(5)


def test_the_report_and_the_words():
    report = lp.inspect(ROTOR)
    assert report.failed == ()
    assert "Jacobi identity proved (computed: the one triple of coordinates)" in str(report)
    assert "C₁ = x⁴/4 + x y z + y⁴/4 + z⁴/4" in str(report)
    assert "rotor" in str(ROTOR)
    assert report.record()["bracket"]["jacobi"]["proved"]
    assert "J(" in ROTOR.bracket._repr_latex_()
    assert lp.inspect(VOLTERRA).failed == ()


@pytest.mark.parametrize("system", [VOLTERRA, ROTOR, lp.System(lp.PoissonTensor(["c", "s", "p"], ROUND), "p^2/2 - c")])
def test_files_give_the_same_system_again(system, tmp_path):
    path = lp.systems.write_system(system, tmp_path / "system.toml")
    again = lp.read_system(path)
    assert again.bracket.poisson_tensor() == system.bracket.poisson_tensor()
    assert again.hamiltonian == system.hamiltonian
    assert again.bracket.casimirs() == system.bracket.casimirs()
    assert again.text == system.text
    assert pickle.loads(pickle.dumps(system)).equations == system.equations


FILE = """
name = "predators"
[bracket]
variables = ["x", "y", "z"]
tensor.x.y = "a*x*y"
tensor.y.z = "y*z"
tensor.z.x = "z*x"
casimirs = ["log(x)/a + log(y)/a + log(z)"]
[parameters]
a = 2
[hamiltonian]
expression = "x + y + z"
"""


def test_a_file_with_a_tensor(tmp_path):
    text = FILE.replace('casimirs = ["log(x)/a + log(y)/a + log(z)"]\n', "")
    (tmp_path / "system.toml").write_text(text)
    system = lp.read_system(tmp_path / "system.toml")
    x, y, z = system.variables
    assert system.equations[x] == 2 * x * y - x * z
    (casimir,) = system.bracket.casimirs()
    assert all(sp.simplify(system.bracket(casimir, v)) == 0 for v in (x, y, z))


WRONG = {
    ('tensor.x.y = "a*x*y"', 'tensor.x.y = "a*x*y +"'): "tensor.x.y",
    ('tensor.x.y = "a*x*y"', 'tensor.x.y = "b*x*y"'): "tensor.x.y",
    ('tensor.x.y = "a*x*y"', 'tensor.x.w = "a*x*y"'): "tensor.x.w",
    ('tensor.x.y = "a*x*y"', 'tensor.x.x = "a*x*y"'): "tensor.x.x",
    ('tensor.x.y = "a*x*y"', 'tensor.x.y = "a*y^2"'): "Jacobi",
    ('casimirs = ["', 'algebra = "so(3)"\ncasimirs = ["'): "algebra",
    ('variables = ["x", "y", "z"]\n', ""): "variables",
}


@pytest.mark.parametrize("change", WRONG)
def test_a_wrong_table_is_refused_with_its_key(change, tmp_path):
    text = FILE.replace('casimirs = ["log(x)/a + log(y)/a + log(z)"]', 'casimirs = ["log(x) + log(y) + a*log(z)"]')
    (tmp_path / "system.toml").write_text(text.replace(*change))
    with pytest.raises(SystemFileError, match=WRONG[change]):
        lp.read_system(tmp_path / "system.toml")


NEEDS_AN_ALGEBRA = {
    "contraction": lambda system: lp.brackets.contraction(system.bracket, [1] * system.bracket.dimension),
    "cocycles": lambda system: lp.cocycles(system.bracket),
    "cohomology": lambda system: lp.algebras.cohomology(system.bracket, degree=2),
    "splitting": lambda system: lp.integrate(system, START, t_end=1, method=lp.Splitting(step=0.1)),
    "frozen": lambda system: system.bracket.frozen(START),
    "constant part": lambda system: system.bracket.with_constant({("x", "y"): 1}),
    "argument shift": lambda system: lp.integrability.argument_shift(system.bracket, START),
    "lax": lp.integrability.search_lax_pairs,
}


@pytest.mark.parametrize("name", NEEDS_AN_ALGEBRA)
def test_what_needs_structure_constants_refuses_a_tensor_with_a_sentence(name):
    with pytest.raises((BracketError, UnsupportedFieldError, ParameterError)) as caught:
        NEEDS_AN_ALGEBRA[name](ROTOR)
    assert "formulas" in str(caught.value) or "linear" in str(caught.value)


def test_smooth_tensors_are_followed_and_reported():
    """The pendulum in c = cos q and s = sin q, against the one in q and p."""
    system = lp.System(lp.PoissonTensor(["c", "s", "p"], ROUND, casimirs=["c^2 + s^2"]), "p^2/2 - c")
    pendulum = lp.System(lp.canonical(names=["q"], momenta=["p"]), "p^2/2 - cos(q)")
    q, p = lp.integrate(pendulum, [0, 2.5], t_end=20, method=lp.Taylor(tol=1e-15)).end_state[0]
    end = lp.integrate(system, [1, 0, 2.5], t_end=20, method=lp.Taylor(tol=1e-15)).end_state[0]
    np.testing.assert_allclose(end, [np.cos(q), np.sin(q), p], atol=1e-12)
    assert lp.inspect(system).failed == ()
    unknown = lp.System(lp.PoissonTensor(["c", "s", "p"], ROUND), "p^2/2 - c")
    report = unknown.bracket.casimir_report()
    assert (report.generators, report.complete) == ((), False)
    assert "no rational functions" in report.limits
    assert lp.inspect(unknown).failed == ()


SPACE = lp.canonical(names=("x", "y", "z"))
MADE = {
    "log-canonical": lambda: lp.brackets.log_canonical([[0, 1, -1], [-1, 0, 1], [1, -1, 0]], ["x", "y", "z"]),
    "Nambu": lambda: lp.brackets.nambu("(x^2 + y^2 + z^2)/2", ["x", "y", "z"]),
    "other coordinates": lambda: lp.canonical(names=["a", "b"], angles=["b"]).in_variables(
        {"x": "a", "y": "b", "u": "p_a + a^2", "v": "p_b + cos(b)"},
        {"a": "x", "b": "y", "p_a": "u - x^2", "p_b": "v - cos(y)"},
    ),
    "product": lambda: lp.brackets.product(lp.so(3) @ lp.trivial(), lp.canonical(names=["x"], angles=["x"])),
    "Dirac": lambda: SPACE.dirac_bracket(["x^2 + y^2 + z^2 - 1", "x*p_x + y*p_y + z*p_z"]),
    "invariants": lambda: lp.canonical(2).in_invariants(
        {"x": "q1*q2 + p1*p2", "y": "q1*p2 - q2*p1", "z": "(q1^2 + p1^2 - q2^2 - p2^2)/2"},
        levels={"I": "(q1^2 + p1^2 + q2^2 + p2^2)/2"},
    ),
    "magnetic": lambda: lp.brackets.magnetic(["-x*z/4", "-y*z/4", "1 + z^2/4"], charge=40),
    "guiding centre": lambda: lp.brackets.guiding_centre(["z", "0", "1 + x"]),
    "straight guiding centre": lambda: lp.brackets.guiding_centre(["0", "0", "1 + y"], charge="e", symbols=["e"]),
    "bottle": lambda: lp.brackets.guiding_centre(["-x*z/4", "-y*z/4", "1 + z^2/4"], charge=40),
}


@pytest.mark.parametrize("kind", [pytest.param(k, marks=[pytest.mark.slow] * (k == "bottle")) for k in MADE])
def test_brackets_made_of_others_can_be_written_and_read_again(kind, tmp_path):
    system = lp.System(MADE[kind](), "cos(x)" if kind == "product" else "cos(y) + x^2*cos(2*y)")
    again = lp.read_system(lp.systems.write_system(system, tmp_path / "again.toml"))
    assert again.periods == system.periods
    for found, wanted in zip(again.equations.values(), system.equations.values(), strict=True):
        assert sp.expand(sp.fraction(sp.together(found - wanted))[0]) == 0
