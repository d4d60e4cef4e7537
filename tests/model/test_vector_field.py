"""Plain vector fields: the bits of systems with the same equations, what is read, what is refused, files."""

import pickle
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.compile.field import QuadraticField, TapeField
from liepoisson.compile.lowering import field_of_equations
from liepoisson.errors import ExpressionError, ParameterError, SystemFileError

RATES = {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"}
LORENZ = lp.VectorField(RATES, {"sigma": 10, "rho": 28, "beta": "8/3"}, name="Lorenz", source="Lorenz (1963)")
HENON = lp.catalog.system("henon-heiles")
OF_HENON = lp.VectorField({"x": "p_x", "y": "p_y", "p_x": "-x - 2*x*y", "p_y": "-y - x^2 + y^2"})
PENDULUM = lp.System(lp.canonical(names=["theta"]), "p_theta^2/2 - g*cos(theta)", {"g": "9/10"})
OF_PENDULUM = lp.VectorField({"theta": "p_theta", "p_theta": "-g*sin(theta)"}, {"g": "9/10"})
X = [1.0, 1.0, 20.0]


@pytest.mark.parametrize("method", [lp.Taylor(), lp.RungeKutta(step=0.05), lp.Gauss(step=0.05)])
@pytest.mark.parametrize(
    ("system", "same", "start"),
    [(HENON, OF_HENON, [0.0, 0.1, 0.3, 0.1]), (PENDULUM, OF_PENDULUM, [2.0, 0.3])],
    ids=["quadratic", "tape"],
)
def test_a_hamiltonian_system_as_a_vector_field_has_the_same_bits(system, same, start, method):
    assert same.field() == system.field()
    runs = [lp.integrate(one, start, times=np.linspace(0, 20, 41), method=method) for one in (system, same)]
    assert np.array_equal(*(run.state for run in runs))
    crossings = [lp.section(one, start, surface=system.component_names[0], t_end=30) for one in (system, same)]
    assert len(crossings[0].time) > 5
    assert np.array_equal(*(points.state for points in crossings))


@pytest.mark.thorough
def test_the_numbers_of_a_quadratic_field_are_those_that_the_core_rounds():
    rng = np.random.default_rng(5)
    names = ["u", "v", "w"]
    products = ["1", *names, *(f"{a}*{b}" for k, a in enumerate(names) for b in names[k:])]
    for _ in range(5):
        numbers = rng.integers(-(10**15), 10**15, (3, len(products), 2))
        texts = [
            " + ".join(f"{a}/{abs(b) + 1}*{m}" for (a, b), m in zip(row, products, strict=True)) for row in numbers
        ]
        field = lp.VectorField(dict(zip(names, texts, strict=True)))
        assert isinstance(field.field(), QuadraticField)
        assert field.field() == field_of_equations(field.variables, list(field.equations.values()))


@pytest.mark.parametrize(
    ("rates", "values", "kind"),
    [
        ({"u": "v - k*u", "v": "-sin(u)*exp(-v^2)"}, {"k": "1/7"}, TapeField),
        ({"u": "v^3 - u", "v": "-u/(1 + v^2)"}, {}, TapeField),
        ({"u": "v^2 - k*u", "v": "k*u*v"}, {"k": "sqrt(2)"}, QuadraticField),
        ({"u": "v - k*u", "v": "-sin(k*u)"}, {"k": "sqrt(2)"}, TapeField),
        ({"u": "pi*v - u", "v": "-u^3/u"}, {}, QuadraticField),
        ({"u": "pi*v - u", "v": "-u^3"}, {}, TapeField),
        ({"u": "c2*v", "v": "-M12*u + M11"}, {"c": [1, 2], "M": [[3, 4], [5, 6]]}, QuadraticField),
        ({"u": sp.Symbol("v") * sp.Symbol("k"), "v": "-u"}, {"k": 3}, QuadraticField),
    ],
)
def test_an_orbit_has_the_slope_that_the_formulas_say(rates, values, kind):
    field = lp.VectorField(rates, values)
    assert isinstance(field.field(), kind)
    start = [0.3, -0.7]
    names = {str(x): a for x, a in zip(field.variables, start, strict=True)}
    wanted = [float(e.subs(names)) for e in field.equations.values()]
    assert np.allclose(field.vector_field(start), wanted, rtol=1e-14)
    h = 1e-3
    ends = [lp.integrate(field, start, times=[0.0, t]).state[0, 1] for t in (h, -h)]
    # a central difference: its error is h^2/6 times third derivatives of order 10
    assert np.allclose((ends[0] - ends[1]) / (2 * h), wanted, atol=1e-5)


@pytest.mark.thorough
def test_the_divergence_and_the_derivatives_of_functions_are_exact():
    x, y, z = LORENZ.variables
    assert LORENZ.divergence == sp.Rational(-41, 3)
    assert LORENZ.derivative("x*z") == sp.expand(10 * (y - x) * z + x * (x * y - sp.Rational(8, 3) * z))
    assert sp.simplify(LORENZ.derivative("log(x)") - 10 * (y - x) / x) == 0
    assert HENON.divergence == 0


def test_given_integrals_are_claims_that_are_proved():
    rates = {"x": "y*z", "y": "-2*x*z", "z": "x*y"}
    field = lp.VectorField(rates, integrals={"E": "2*x^2 + y^2", "K": "x^2 - z^2"})
    assert field.invariants == {"E": field.expression("2*x^2 + y^2"), "K": field.expression("x^2 - z^2")}
    run = lp.integrate(field, [1, 0.5, 0.2], t_end=50)
    assert all(change.max() < 1e-13 for change in run.drift.values())
    assert [*run.drift] == ["E", "K"]
    wrong = lp.VectorField(rates, integrals={"E": "x^2 + y^2"})
    with pytest.raises(ParameterError, match="the integral E must be constant along the motion"):
        _ = wrong.invariants
    with pytest.raises(ParameterError, match="got 'x\\^2 - z\\^2', which is constant along each orbit"):
        lp.section(field, [1, 0.5, 0.2], surface="x^2 - z^2", t_end=1)


FIELDS = [
    LORENZ,
    OF_PENDULUM,
    lp.VectorField({"x": "y + k", "y": "-x"}, {"k": "sqrt(2)/3"}, integrals={"E": "x^2 + y^2 + 2*k*y"}),
    lp.VectorField({"x": "a2*y", "y": "-x*h"}, {"a": [1, "1/3"]}, symbols=["h"]),
    lp.VectorField({"x": sp.sin(sp.Symbol("y")), "y": -sp.Symbol("x") / 3}),
]


@pytest.mark.parametrize("field", FIELDS, ids=range(len(FIELDS)))
def test_a_file_gives_the_same_vector_field(field, tmp_path):
    path = lp.systems.write_system(field, tmp_path / "field.toml")
    found = lp.read_system(path)
    assert isinstance(found, lp.VectorField)
    assert (found.name, found.source, found.parameters) == (field.name, field.source, field.parameters)
    assert found.equations == field.equations
    assert found.integrals == field.integrals
    assert found.text == field.text
    again = pickle.loads(pickle.dumps(field))
    assert again.equations == field.equations


@pytest.mark.thorough
def test_saved_runs_load_with_the_vector_field_and_run_again(tmp_path):
    runs = {
        "orbit": lp.integrate(LORENZ, X, t_end=3),
        "section": lp.section(LORENZ, X, surface="z - 27", t_end=5),
        "spectrum": lp.lyapunov_spectrum(LORENZ, X, t_end=3),
        "exponent": lp.lyapunov_exponent(LORENZ, X, t_end=5),
    }
    for name, run in runs.items():
        path = run.save(tmp_path / f"{name}.nc")
        assert lp.load(path).system.text == LORENZ.text
        again = lp.rerun(path)
        assert np.array_equal(again.end_state, run.end_state)
        assert np.array_equal(again.time, run.time)


REFUSED = [
    (lambda: lp.VectorField({}), ParameterError, "wanted the rate of each coordinate"),
    (lambda: lp.VectorField(["y", "-x"]), ParameterError, "wanted a mapping from names to rates"),
    (
        lambda: lp.VectorField({"x": 1}),
        ParameterError,
        'the rate of x: wanted a text or an expression; got 1; write "1"',
    ),
    (lambda: lp.VectorField({"x y": "1"}), ParameterError, "the name of a coordinate must consist of letters"),
    (lambda: lp.VectorField({"sin": "1"}), ParameterError, "must not be that of a function"),
    (lambda: lp.VectorField({"x": "y"}), ExpressionError, "the rate of x: the name 'y' is unknown"),
    (lambda: lp.VectorField({"x": "sin(t)"}), ExpressionError, 'make it a coordinate: {"t": "1"}'),
    (lambda: lp.VectorField({"x": "abs(x)"}), ExpressionError, "the rate of x: "),
    (lambda: lp.VectorField({"x": "atan2(x, 1)"}), ExpressionError, "the rate of x: "),
    (lambda: lp.VectorField({"x": "__import__('os').system('true')"}), ExpressionError, "the rate of x: "),
    (lambda: lp.VectorField({"x": "x.real"}), ExpressionError, "the rate of x: "),
    (lambda: lp.VectorField({"x": "k*x"}, {"k": 1, "m": 2}), ParameterError, "'m' occurs in none. Known there: k"),
    (lambda: lp.VectorField({"x": "(k - k)*x"}, {"k": 1}), ParameterError, "'k' occurs in none"),
    (lambda: lp.VectorField({"x": "x"}, {"x": 1}), ParameterError, "'x' is given twice"),
    (lambda: lp.VectorField({"x": "k*x"}, {"k": "x"}), ParameterError, "k = x, and x is a coordinate"),
    (lambda: lp.VectorField({"x": "k*x"}, {"k": float("nan")}), ParameterError, "k"),
    (lambda: lp.VectorField({"x": "sqrt(-k)*x"}, {"k": 1}), ExpressionError, "must be finite and real"),
    (
        lambda: lp.VectorField({"x": sp.sqrt(-2) * sp.Symbol("x")}),
        ParameterError,
        "the rate of x must be finite and real",
    ),
    (lambda: lp.VectorField({"x": "y", "y": "-x"}, integrals={"H": "x"}), ParameterError, "must not be named H"),
    (lambda: lp.VectorField({"x": "y", "y": "-h*x"}, symbols=["h"]).field(), ParameterError, "got none for h"),
    (lambda: lp.VectorField({"x": sp.Symbol("u")}), ParameterError, "must consist of coordinates and declared"),
]


@pytest.mark.parametrize(("call", "kind", "words"), REFUSED, ids=range(len(REFUSED)))
def test_what_is_no_vector_field_is_refused(call, kind, words):
    with pytest.raises(kind) as refusal:
        call()
    assert words in str(refusal.value)


UNBRACKETED = {
    "Leaf": lambda: lp.Leaf(LORENZ, {}),
    "inspect": lambda: lp.inspect(LORENZ),
    "equilibria": lambda: lp.equilibria(LORENZ, {}),
    "equilibrium": lambda: lp.phase_space.equilibrium(LORENZ, [0, 0, 0]),
    "find_start": lambda: lp.phase_space.find_start(LORENZ, guess=X),
    "periodic_orbit": lambda: lp.orbits.periodic_orbit(LORENZ, X, period=1),
    "periodic_orbits": lambda: lp.orbits.periodic_orbits(LORENZ, {}, energy=1),
    "return_map": lambda: lp.sections.return_map(LORENZ, "z - 27", t_end=10),
    "discrete_symmetries": lambda: lp.systems.discrete_symmetries(LORENZ),
    "integrability_report": lambda: lp.integrability.integrability_report(LORENZ),
    "certificate": lambda: lp.integrability.certificate(LORENZ, {"K": "x"}),
    "integrable_families": lambda: lp.integrability.integrable_families(LORENZ, degree=2),
    "deformations": lambda: lp.deformations(LORENZ, parameter="epsilon"),
    "search_lax_pairs": lambda: lp.integrability.search_lax_pairs(LORENZ),
    "galois_obstruction": lambda: lp.integrability.galois_obstruction(LORENZ),
    "PhaseFunction": lambda: LORENZ.functions.energy,
    "bracket": lambda: LORENZ.bracket,
    "hamiltonian": lambda: LORENZ.hamiltonian,
}


@pytest.mark.parametrize("name", UNBRACKETED)
def test_what_needs_a_bracket_says_that_there_is_none(name):
    kind = AttributeError if name in {"PhaseFunction", "bracket", "hamiltonian"} else ParameterError
    with pytest.raises(kind, match="a vector field has no bracket; what needs energies, Casimirs"):
        UNBRACKETED[name]()


def test_splitting_and_vectors_on_leaves_are_refused_in_their_own_words():
    with pytest.raises(ParameterError, match="Splitting wants the pieces of a Hamiltonian"):
        lp.integrate(LORENZ, X, t_end=1, method=lp.Splitting(step=0.1))
    with pytest.raises(ParameterError, match='within: wanted a system with a bracket for "leaf"'):
        lp.chaos.alignment(LORENZ, X, t_end=1, within="leaf")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[equations]\nx = "y"\n', "the name 'y' is unknown"),
        ("[equations]\nx = 3\n", "wanted a text in quotes"),
        ("equations = 3\n", "wanted a table"),
        ('[equations]\nx = "1"\n[bracket]\ncanonical = 1\n', "A vector field has none: remove it."),
        ('[equations]\nx = "1"\n[parameters]\nk = 1\n', "'k' occurs in none"),
    ],
)
def test_a_file_that_describes_no_vector_field_is_refused_with_its_place(text, words, tmp_path):
    path = tmp_path / "field.toml"
    path.write_text(text)
    with pytest.raises(SystemFileError) as refusal:
        lp.read_system(path)
    assert words in str(refusal.value)
    assert "field.toml" in str(refusal.value)


def test_a_system_file_is_no_vector_field_and_says_so(tmp_path):
    path = lp.systems.write_system(LORENZ, tmp_path / "lorenz.toml")
    with pytest.raises(
        SystemFileError,
        match=r"line \d+: equations: wanted a bracket and a Hamiltonian; got equations\. A vector field has no bracket",
    ):
        lp.systems.read_system_file(path)


def test_parameters_are_exact_and_cannot_be_changed():
    assert LORENZ.parameters == {"sigma": 10, "rho": 28, "beta": Fraction(8, 3)}
    with pytest.raises(TypeError, match="make a system with others"):
        LORENZ.parameters["beta"] = Fraction(3)
