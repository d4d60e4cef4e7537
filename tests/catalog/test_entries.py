"""Every system of the catalog is what it says: proofs of its integrals, equations against those written by hand."""

import random
import subprocess
import sys
from fractions import Fraction
from functools import cache
from itertools import chain, combinations

import numpy as np
import pytest
from equations_by_hand import EQUATIONS
from scipy.integrate import quad
from sympy import Add, Matrix, Poly, Pow, Rational, Symbol, groebner, numer, sqrt, together

import liepoisson as lp
from liepoisson import catalog
from liepoisson.compile.field import QuadraticField, TapeField, TopField
from liepoisson.errors import ParameterError, UnknownNameError

NAMES = catalog.names()
SYMBOLIC = ("twisted-top",)
NUMBERS = tuple(name for name in NAMES if name not in SYMBOLIC)

WITH_SINES = ("reduced-mhd-3", "zeitlin-3", "zeitlin-5")  # structure constants that are no rational numbers
TRANSCENDENTAL = ("double-pendulum", "spring-pendulum", "toda")  # rates that are none

# Not known to be integrable, or known not to be; all others have a complete set of integrals.
NOT_INTEGRABLE = (
    "charged-heavy-top",
    "double-pendulum",
    "heavy-top",
    "henon-heiles",
    "kirchhoff-ellipsoid",
    "leibniz-top-4",
    "reduced-mhd-3",
    "spring-pendulum",
    "twisted-kovalevskaya",
    "twisted-top",
    "zeitlin-3",
    "zeitlin-5",
)
SUPERINTEGRABLE = ("kepler-on-the-sphere",)  # more integrals than can commute


@cache
def system(name):
    return catalog.system(name)


def all_integrals(name):
    """(integral, function that vanishes where it is one, or None) by name."""
    found = {key: (value, None) for key, value in system(name).integrals.items()}
    return found | system(name).partial_integrals


def vanishes(expression, condition, variables):
    """Whether an algebraic expression is zero wherever the condition is: decided by a Groebner basis.

    A square root of a polynomial is a new variable r with r^2 equal to that polynomial.
    """
    r, relations = Symbol("r"), [] if condition is None else [condition]
    radicands = {power.base for power in expression.atoms(Pow) if power.exp.is_Rational and power.exp.q == 2}
    for base in radicands:
        relations.append(r**2 - base)
        expression = expression.replace(
            lambda part, base=base: part.is_Pow and part.base == base and not part.exp.is_integer,
            lambda part: r ** (2 * part.exp),
        )
    assert len(radicands) <= 1
    polynomial = numer(together(expression)).expand()
    if not relations:
        return polynomial == 0
    return groebner(relations, r, *variables, order="grevlex").contains(polynomial)


def random_state(name, seed):
    draw, bracket = random.Random(f"{name}{seed}"), system(name).bracket
    state = [Fraction(draw.randint(-9, 9), draw.randint(1, 5)) for _ in range(bracket.dimension)]
    if name == "kepler-on-the-sphere":
        state[3:5] = [3 * state[5], 4 * state[5]] if state[5] else [Fraction(3), Fraction(4)]
    return state


def value(expression, name, state):
    exact = [Rational(x.numerator, x.denominator) for x in state]
    return expression.subs(dict(zip(system(name).variables, exact, strict=True)))


@pytest.mark.thorough
def test_every_file_is_listed_under_its_own_name():
    assert set(NAMES) == {*EQUATIONS, *SYMBOLIC}, "a system without equations written by hand, or the other way round"
    assert list(NAMES) == sorted(NAMES)
    for name in NAMES:
        entry = catalog.entry(name)
        assert entry.name == name == name.lower()
        assert len(entry.source) > 20, name
        assert entry.description, name
        assert entry.references, name


def test_listing_the_catalog_loads_nothing_beyond_the_package():
    show = "print(sorted({'numpy', 'sympy', 'flint', 'xarray'} & set(sys.modules)))"
    listing = "from liepoisson import catalog; catalog.names(); catalog.path('clebsch')"
    package, catalog_too = (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        for code in (f"import sys, liepoisson; {show}", f"import sys; {listing}; {show}")
    )
    assert catalog_too == package


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(UnknownNameError, match="Did you mean kovalevskaya"):
        catalog.system("kowalevskaya")
    with pytest.raises(UnknownNameError, match=r"Known: .*twisted-top"):
        catalog.entry("")


@pytest.mark.parametrize("name", NAMES)
def test_jacobi_holds(name):
    assert system(name).bracket.jacobi_certificate().holds


def by_hand(name, state):
    n = system(name).bracket.algebra.dimension
    return list(chain(*EQUATIONS[name](*(state[k : k + n] for k in range(0, len(state), n)))))


@pytest.mark.thorough
@pytest.mark.parametrize("name", [name for name in NUMBERS if name not in (*WITH_SINES, *TRANSCENDENTAL)])
def test_equations_are_those_written_by_hand(name):
    for state in (random_state(name, 0), random_state(name, 1)):
        for (component, right), wanted in zip(system(name).equations.items(), by_hand(name, state), strict=True):
            assert value(right, name, state) == Rational(wanted.numerator, wanted.denominator), (
                f"{component}' at {state}"
            )


@pytest.mark.thorough
@pytest.mark.parametrize("name", WITH_SINES)
def test_equations_are_zeitlins_sums(name):
    state = [float(x) for x in random_state(name, 0)]
    # Sums of some fifty terms of size 10^2, in another order: measured below 2e-13.
    assert system(name).vector_field(state) == pytest.approx(by_hand(name, state), abs=1e-11)


@pytest.mark.parametrize("name", TRANSCENDENTAL)
def test_rates_that_are_no_rational_functions_are_those_written_by_hand(name):
    for seed in (0, 1):
        state = [float(x) / 3 for x in random_state(name, seed)]
        wanted = by_hand(name, state)
        assert system(name).vector_field(state) == pytest.approx(wanted, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", [name for name in NAMES if all_integrals(name)])
def test_integrals_are_constant(name):
    here = system(name)
    for key, (integral, condition) in all_integrals(name).items():
        assert vanishes(here.bracket(integral, here.hamiltonian), condition, here.variables), key
        if condition is not None:  # a partial integral is none elsewhere, and its set is invariant
            assert not vanishes(here.bracket(integral, here.hamiltonian), None, here.variables), key
            assert vanishes(here.bracket(condition, here.hamiltonian), condition, here.variables), key


def pairs_of_integrals(name):
    return [*combinations(all_integrals(name).values(), 2)]


INTEGRABLE = tuple(name for name in NAMES if name not in (*NOT_INTEGRABLE, *SUPERINTEGRABLE))
# With one integral besides H there is no pair: that it commutes with H is the test of constancy.
WITH_PAIRS = (
    "charged-lagrange",
    "charged-twisted-lagrange",
    "compressible-reduced-mhd",
    "leibniz-lagrange-4",
    "leibniz-lagrange-5",
)
WITH_PAIRS += ("so21-twisted-top", "three-wave", "toda", "twisted-lagrange")
WITH_PAIRS += ("two-field-kovalevskaya", "two-field-spherical")


def test_systems_of_three_degrees_of_freedom_have_pairs_of_integrals():
    assert tuple(name for name in INTEGRABLE if pairs_of_integrals(name)) == WITH_PAIRS


@pytest.mark.parametrize("name", WITH_PAIRS)
def test_integrals_commute(name):
    here = system(name)
    for (first, at), (second, there) in pairs_of_integrals(name):
        assert vanishes(here.bracket(first, second), at if there is None else there, here.variables)


@pytest.mark.parametrize("name", SUPERINTEGRABLE)
def test_integrals_beyond_half_the_dimension_do_not_all_commute(name):
    here = system(name)
    brackets = [here.bracket(first, second) for (first, _), (second, _) in pairs_of_integrals(name)]
    assert not all(vanishes(bracket, None, here.variables) for bracket in brackets)


@pytest.mark.parametrize("name", [name for name in NAMES if name not in NOT_INTEGRABLE])
def test_integrable_systems_have_enough_independent_integrals(name):
    """dim - rank/2 functions: the Casimirs, H, and half a leaf's dimension less one more."""
    here = system(name)
    state = catalog.entry(name).references[0].state
    assert all(value(on, name, state) == 0 for _, on in here.partial_integrals.values()), "start on the invariant set"
    functions = [
        here.hamiltonian,
        *here.bracket.casimirs(),
        *(integral for integral, _ in all_integrals(name).values()),
    ]
    gradients = [[value(f.diff(x), name, state) for x in here.variables] for f in functions]
    tensor = here.bracket.poisson_tensor()
    rank, generic = (
        tensor.applyfunc(lambda x, at=at: value(x, name, at)).rank() for at in (state, random_state(name, 0))
    )
    extra = 1 if name in SUPERINTEGRABLE else 0
    assert rank == generic
    assert Matrix(gradients).rank() == here.bracket.dimension - rank // 2 + extra


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "reference"),
    [(name, r) for name in NAMES for r in catalog.entry(name).references if r.quantity != "lyapunov"],
)
def test_reference_values(name, reference):
    here, state = system(name), reference.state
    if reference.quantity == "derivative":
        got, wanted = [value(right, name, state) for right in here.equations.values()], reference.value
    else:
        functions = {"H": here.hamiltonian} | {key: integral for key, (integral, _) in all_integrals(name).items()}
        if reference.quantity.startswith("C") and reference.quantity not in functions:
            functions |= {f"C{k}": casimir for k, casimir in enumerate(here.bracket.casimirs(), 1)}
        got, wanted = [value(functions[reference.quantity], name, state)], (reference.value,)
    for mine, printed in zip(got, wanted, strict=True):
        assert abs(mine - Rational(str(printed))) <= (reference.tolerance or 0), f"{mine} instead of {printed}"


@pytest.mark.thorough
@pytest.mark.parametrize("name", NUMBERS)
def test_orbits_keep_what_is_constant(name):
    here = system(name)
    start = [float(x) for x in catalog.entry(name).references[0].state]
    orbit = lp.integrate(here, start, times=[0, 1, 2])
    assert orbit.outcome[0] == "finished"
    functions = [here.hamiltonian, *(integral for integral, _ in all_integrals(name).values())]
    if here.bracket.dimension <= 15:  # Casimirs of larger algebras take long to find
        functions += here.bracket.casimirs()
    for function in functions:
        first, *later = (evaluated(function, here.variables, state) for state in orbit.state[0])
        largest = max(abs(term) for term in first[1])
        assert max(abs(total - first[0]) for total, _ in later) < 1e-12 * max(1.0, largest), function


def evaluated(function, variables, state):
    """The value, and those of the terms that it is a sum of: round-off is of the size of the largest."""
    numbers = dict(zip(variables, map(float, state), strict=True))
    terms = [float(term.subs(numbers)) for term in Add.make_args(function.expand())]
    return sum(terms), terms


def test_the_kernel_is_chosen_by_the_equations():
    """A top in a file gets the kernel of tops; another algebra or number of fields, or a root, are other kinds."""
    expected = {
        "twisted-kovalevskaya": TopField,
        "charged-lagrange": TopField,
        "manakov-so4": QuadraticField,
        "so21-twisted-top": QuadraticField,
        "kepler-on-the-sphere": TapeField,
        "goryachev": TapeField,
    }
    for name, kind in expected.items():
        assert isinstance(system(name).field(), kind), name


@pytest.mark.thorough
def test_the_exponent_of_the_twisted_kovalevskaya_top_is_the_printed_one():
    reference = next(r for r in catalog.entry("twisted-kovalevskaya").references if r.quantity == "lyapunov")
    top = system("twisted-kovalevskaya")
    starts = lp.sample_states(top, 2000, seed=1, ensemble="unit-vectors")
    growth = lp.finite_time_exponents(top, starts, times=np.arange(5.0, 201.0, 5.0), seed=2)
    fit = lp.fits.finite_time_fit(growth.time, growth.exponent, window=(20.0, 200.0), n_bootstrap=50)
    assert fit.estimates["lambda"].standard_error < 0.003
    assert fit.estimates["lambda"].value == pytest.approx(float(reference.value), abs=float(reference.tolerance))


def test_the_ellipsoid_has_the_added_masses_of_its_shape():
    """Lamb: M_i = 1 + alpha_i/(2 - alpha_i) and the like for the moments, from elliptic integrals; mass 1."""
    axes = (1.5, 1.0, 0.75)
    squares = [axis**2 for axis in axes]

    def alpha(k):
        weight = lambda t: 1 / ((squares[k] + t) * np.sqrt(np.prod([s + t for s in squares])))  # noqa: E731
        return np.prod(axes) * quad(weight, 0, np.inf, epsabs=1e-13, epsrel=1e-13)[0]

    alphas = [alpha(k) for k in range(3)]
    parameters = catalog.entry("kirchhoff-ellipsoid").parameters
    assert sum(alphas) == pytest.approx(2, abs=1e-10)
    for k in range(3):
        j, i = squares[(k + 1) % 3], squares[(k + 2) % 3]
        beta, gamma = alphas[(k + 1) % 3], alphas[(k + 2) % 3]
        added = (j - i) ** 2 * (gamma - beta) / (2 * (j - i) + (j + i) * (beta - gamma)) / 5
        assert float(parameters["M"][k]) == pytest.approx(1 + alphas[k] / (2 - alphas[k]), abs=1e-9)
        assert float(parameters["I"][k]) == pytest.approx((j + i) / 5 + added, abs=1e-9)


def test_the_invariant_of_the_rattleback_is_a_casimir():
    here = system("rattleback")
    x1, x2, _ = here.variables
    assert here.bracket.casimirs() == [x1 * x2**4]
    assert not here.integrals


def test_the_cavity_belongs_to_a_symmetric_body():
    r"""$(A, B; B, C) = (I + r, -q; -q, r)^{-1}$ per axis, $r = M(b_j^2 + b_k^2)/5$, $q = 2M b_j b_k/5$."""
    M, b, inertia = 5, (2, 2, 1), (3, 3, 4)
    values = system("poincare-ellipsoidal-cavity").values
    for i in range(3):
        b_j, b_k = b[(i + 1) % 3], b[(i + 2) % 3]
        r, q = Fraction(M * (b_j**2 + b_k**2), 5), Fraction(2 * M * b_j * b_k, 5)
        A, B, C = (values[name][i] for name in "ABC")
        assert ((inertia[i] + r) * A - q * B, (inertia[i] + r) * B - q * C) == (1, 0)
        assert (r * B - q * A, r * C - q * B) == (0, 1)


def test_steklov_and_lyapunov_are_integrals_of_each_other():
    steklov, lyapunov = system("steklov"), system("lyapunov")
    assert steklov.integrals["K"].expand() == (2 * lyapunov.hamiltonian).expand()
    assert lyapunov.integrals["K"].expand() == (2 * steklov.hamiltonian).expand()


def test_a_wrong_integral_is_noticed():
    here = system("kovalevskaya")
    wrong = here.integrals["K"] + here.variables[0]
    assert not vanishes(here.bracket(wrong, here.hamiltonian), None, here.variables)
    on = system("goryachev-chaplygin").partial_integrals["G"][1]
    assert not vanishes(here.bracket(wrong, here.hamiltonian), on, here.variables)
    l1, alpha1, alpha2 = here.variables[0], *here.variables[3:5]
    root = sqrt(alpha1**2 + alpha2**2)
    assert vanishes(l1 / root - l1 * root / (alpha1**2 + alpha2**2), None, here.variables)
    assert not vanishes(l1 / root - l1 * root, None, here.variables)
    assert Poly(on, *here.variables).total_degree() == 2


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_every_system_takes_its_own_values_again_and_is_the_same(name):
    """Values by name, as the entry has them; and what still has none keeps its symbol."""
    entry = catalog.entry(name)
    again = catalog.system(name, entry.parameters)
    assert again.values == system(name).values
    assert again.equations == system(name).equations
    assert list(again.integrals) == list(system(name).integrals)


def test_other_values_are_the_same_system_as_one_that_is_typed():
    other = catalog.system("heavy-top", {"I": (1, "3/2", 2), "a": np.array([0.5, 0, 1])})
    bracket = lp.so(3) @ lp.semidirect(2)
    typed = lp.System(bracket, "l1^2/2 + l2^2/3 + l3^2/4 + alpha1/2 + alpha3")
    assert other.equations == typed.equations
    assert other.name == "heavy-top, I = (1, 3/2, 2), a = (1/2, 0, 1)"
    assert lp.integrate(other, {"l": (1, 1, 1), "alpha": (1, 0, 0)}, times=[0, 1]).outcome == "finished"


def test_some_values_leave_the_others():
    part = catalog.system("twisted-top", {"epsilon": 2, "a": [0, 0, "k"]})
    assert {str(symbol) for symbol in part.hamiltonian.free_symbols} - set(part.component_names) == {
        *("I1", "I2", "I3"),
        *("b1", "b2", "b3", "k"),
    }
    assert catalog.system("kovalevskaya", {}).equations == system("kovalevskaya").equations


def test_an_integral_that_is_not_constant_with_other_values_is_left_out():
    assert "K" in catalog.system("manakov-so4", {"J": (1, 2, 3, "7/2")}).invariants
    assert list(catalog.system("kovalevskaya", {"I": (1, 2, 3)}).invariants) == ["H", "C1", "C2"]
    assert catalog.entry("kovalevskaya").with_parameters({"I": (1, 2, 3)}).references == ()


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"epsilom": 1}, "'twisted-top' has no parameter 'epsilom'. Did you mean epsilon.*Known: epsilon, I, a, b"),
        ({"l": 1}, "'twisted-top' has no parameter 'l'"),
        ({"I1": 1}, "'twisted-top' has no parameter 'I1'. Did you mean I"),
        ({"a": 1}, r"a must have 3 components; got one number. Give for example \[1, 2, 3\]"),
        ({"a": (1, 0)}, "a must have 3 components; got 2 components"),
        ({"a": [[1, 0, 0]]}, r"a must have 3 components; got a matrix of shape \(1, 3\)"),
        ({"epsilon": (1, 2)}, "epsilon must have one number; got 2 components. Give for example 1"),
        ({"epsilon": float("nan")}, "epsilon"),
        ({"epsilon": "__import__('os')"}, "epsilon"),
        ({"epsilon": None}, "epsilon"),
        ([1, 2], "parameters must be a mapping from names to values"),
        ("epsilon=1", "parameters must be a mapping from names to values"),
        ({1: 2}, "parameters must be a mapping from names to values"),
    ],
)
def test_values_that_are_none_are_refused(parameters, words):
    with pytest.raises(ParameterError, match=words):
        catalog.system("twisted-top", parameters)


def test_a_matrix_keeps_its_shape(tmp_path):
    path = tmp_path / "matrix.toml"
    text = '[bracket]\nalgebra = "so(3)"\n[parameters]\nA = [[1, 0, 0], [0, 2, 0], [0, 0, 3]]\n[hamiltonian]\n'
    path.write_text(text + 'expression = "dot(l, A*l)"\n')
    file = lp.systems.read_system_file(path)
    l1, l2, l3 = file.bracket.variables
    assert file.with_parameters({"A": np.diag([3, 2, 1])}).system().hamiltonian == 3 * l1**2 + 2 * l2**2 + l3**2
    with pytest.raises(
        ParameterError, match=r"A must have a matrix of shape \(3, 3\); got 3 components. Give its rows"
    ):
        file.with_parameters({"A": [1, 2, 3]})


@pytest.mark.thorough
@pytest.mark.parametrize("name", [name for name in NAMES if catalog.entry(name).integrals])
def test_a_text_and_its_expression_are_constant_or_not_together(name):
    """A text may be decided without SymPy; partial integrals are no integrals of all orbits, by either way."""
    texts = [item.expression for item in catalog.entry(name).integrals.values()]
    for text in (*texts, system(name).component_names[0] + "^2"):
        assert system(name).is_constant(text) is system(name).is_constant(system(name).expression(text)), text
