"""Every system of the catalog is what it says: proofs of its integrals, equations against those written by hand."""

import random
from fractions import Fraction
from functools import cache
from itertools import chain, combinations

import numpy as np
import pytest
from equations_by_hand import EQUATIONS
from scipy.integrate import quad
from sympy import Matrix, Pow, Rational, Symbol, groebner, numer, together

import liepoisson as lp
from liepoisson import catalog
from liepoisson.errors import ParameterError, ShapeError, UnknownNameError
from liepoisson.model.system_file_reader import parse_system_file

NAMES = catalog.names()
SYMBOLIC = ("cubic-top-complex", "cubic-top-double", "cubic-top-split", "twisted-top")
NUMBERS = tuple(name for name in NAMES if name not in SYMBOLIC)

WITH_SINES = ("reduced-mhd-3", "zeitlin-3", "zeitlin-5")  # structure constants that are no rational numbers
TRANSCENDENTAL = ("double-pendulum", "spring-pendulum", "toda")  # rates that are none

# Not known to be integrable, or known not to be; all others have a complete set of integrals.
NOT_INTEGRABLE = (
    "charged-heavy-top",
    "cubic-top-complex",
    "cubic-top-double",
    "cubic-top-split",
    "double-pendulum",
    "heavy-top",
    "henon-heiles",
    "kirchhoff-ellipsoid",
    "leibniz-top-4",
    "lotka-volterra-4",
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


def test_every_file_is_listed_under_its_own_name():
    assert set(NAMES) == {*EQUATIONS, *SYMBOLIC}, "a system without equations written by hand, or the other way round"
    assert list(NAMES) == sorted(NAMES)
    for name in NAMES:
        entry = catalog.entry(name)
        assert entry.name == name == name.lower()
        assert len(entry.source) > 20, name
        assert entry.description, name
        assert entry.references, name


def by_hand(name, state):
    n = system(name).bracket.field_lengths[0]
    return list(chain(*EQUATIONS[name](*(state[k : k + n] for k in range(0, len(state), n)))))


@pytest.mark.thorough
@pytest.mark.parametrize("name", NUMBERS)
def test_equations_are_those_written_by_hand(name):
    """Exactly where they are rational; sums of some fifty terms of size 10^2 in another order elsewhere."""
    for seed in (0, 1):
        state = random_state(name, seed)
        if name in (*WITH_SINES, *TRANSCENDENTAL):
            numbers = [float(x) / 3 for x in state]
            assert system(name).vector_field(numbers) == pytest.approx(by_hand(name, numbers), rel=1e-12, abs=1e-11)
        else:
            found = [value(right, name, state) for right in system(name).equations.values()]
            assert found == [Rational(x.numerator, x.denominator) for x in by_hand(name, state)]


@pytest.mark.parametrize("name", [name for name in NAMES if all_integrals(name)])
def test_integrals_are_constant_and_commute(name):
    here = system(name)
    pairs = [*combinations(all_integrals(name).values(), 2)]
    commute = [
        vanishes(here.bracket(first, second), at if there is None else there, here.variables)
        for (first, at), (second, there) in pairs
    ]
    assert all(commute) is (name not in SUPERINTEGRABLE)  # of more than half the dimension not all can commute
    texts = [item.expression for item in catalog.entry(name).integrals.values()]
    for text in (*texts, here.component_names[0] + "^2"):  # a text may be decided without SymPy
        assert here.is_constant(text) is here.is_constant(here.expression(text))
    for key, (integral, condition) in all_integrals(name).items():
        assert vanishes(here.bracket(integral, here.hamiltonian), condition, here.variables), key
        if condition is not None:  # a partial integral is none elsewhere, and its set is invariant
            assert not vanishes(here.bracket(integral, here.hamiltonian), None, here.variables), key
            assert vanishes(here.bracket(condition, here.hamiltonian), condition, here.variables), key


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


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_every_system_takes_its_own_values_again_and_is_the_same(name):
    """Values by name, as the entry has them; and what still has none keeps its symbol."""
    entry = catalog.entry(name)
    again = catalog.system(name, entry.parameters)
    assert again.values == system(name).values
    assert again.equations == system(name).equations
    assert list(again.integrals) == list(system(name).integrals)


def test_other_values_are_the_same_system_as_one_that_is_typed(tmp_path):
    other = catalog.system("heavy-top", {"I": (1, "3/2", 2), "a": np.array([0.5, 0, 1])})
    typed = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2/2 + l2^2/3 + l3^2/4 + alpha1/2 + alpha3")
    assert other.equations == typed.equations
    assert other.name == "heavy-top, I = (1, 3/2, 2), a = (1/2, 0, 1)"
    part = catalog.system("twisted-top", {"epsilon": 2, "a": [0, 0, "k"]})
    symbols = {str(symbol) for symbol in part.hamiltonian.free_symbols} - set(part.component_names)
    assert symbols == {"I1", "I2", "I3", "b1", "b2", "b3", "k"}
    # an integral that is not constant with other values is left out
    assert "K" in catalog.system("manakov-so4", {"J": (1, 2, 3, "7/2")}).invariants
    assert list(catalog.system("kovalevskaya", {"I": (1, 2, 3)}).invariants) == ["H", "C1", "C2"]
    assert catalog.entry("kovalevskaya").with_parameters({"I": (1, 2, 3)}).references == ()


MATRIX = parse_system_file(
    '[bracket]\nalgebra = "so(3)"\n[parameters]\nA = [[1, 0, 0], [0, 2, 0], [0, 0, 3]]\n[hamiltonian]\n'
    'expression = "dot(l, A*l)"\n'
)


def test_a_matrix_keeps_its_shape():
    l1, l2, l3 = MATRIX.bracket.variables
    found = MATRIX.with_parameters({"A": np.diag([3, 2, 1])}).system()
    assert found.hamiltonian == 3 * l1**2 + 2 * l2**2 + l3**2


def given(**values):
    return lambda: catalog.system("twisted-top", values)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: catalog.system("kowalevskaya"), UnknownNameError, "Did you mean kovalevskaya"),
        (lambda: catalog.entry(""), UnknownNameError, "Known: .*twisted-top"),
        (given(epsilom=1), ParameterError, "no parameter 'epsilom'. Did you mean epsilon.*Known: epsilon, I, a, b"),
        (given(l=1), ParameterError, "'twisted-top' has no parameter 'l'"),
        (given(I1=1), ParameterError, "'twisted-top' has no parameter 'I1'. Did you mean I"),
        (given(a=1), ParameterError, r"a must have 3 components; got one number. Give for example \[1, 2, 3\]"),
        (given(a=[[1, 0, 0]]), ParameterError, r"a must have 3 components; got a matrix of shape \(1, 3\)"),
        (given(epsilon=(1, 2)), ParameterError, "epsilon must have one number; got 2 components. Give for example 1"),
        *((given(epsilon=bad), ParameterError, "epsilon") for bad in (float("nan"), "__import__('os')", None)),
        *((lambda p=p: catalog.system("twisted-top", p), ParameterError, "must be a mapping from names to values")
          for p in ([1, 2], "epsilon=1", {1: 2})),
        (lambda: MATRIX.with_parameters({"A": [1, 2, 3]}), ParameterError, r"shape \(3, 3\); got 3 .* Give its rows"),
        (lambda: catalog.manakov(4, (1, 2, 3)), ShapeError, "J must be 4 numbers.*got 3"),
        (lambda: catalog.euler_top_on("so(3)", (1, 2)), ShapeError, "inertia must be 3 numbers.*got 2"),
        (lambda: catalog.euler_top_on("so(3)", (1, 2, 0)), ParameterError, "inertia|I3"),
        (lambda: catalog.leibniz_top(2, (1, 1, 1), [(0, 0, 1), (1, 0, 0)]), ShapeError, "at most 1"),
        (lambda: catalog.zeitlin(4), ParameterError, "odd"),
        (lambda: catalog.vorticity(np.zeros(9)), ShapeError, r"N\^2 - 1"),
        *((lambda n=n: catalog.toda(n), ParameterError, "from 3 to 100") for n in (2, 101, 2.5, True)),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()
