"""Solutions on invariant planes, verified by substitution, and their variational equations."""

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ExpressionError, ParameterError, ShapeError
from liepoisson.integrability import particular_solution, particular_solutions, variational_equations
from liepoisson.integrability.galois.linear_systems import derivative, linear_system
from liepoisson.integrability.galois.solutions import Arithmetic, invariant_planes
from liepoisson.integrability.galois.variational import flag, rational_solutions

x, s, y = sp.symbols("x s y")
TWISTED = lp.Top.twisted_kovalevskaya()
Z = 4 * x / (1 + x**2)
PENDULUM = {"l3": Z, "alpha1": Z**2 / 2 - 1, "alpha2": x * Z.diff(x)}
CUBIC = lp.System(lp.canonical(names=("q",)), "p_q^2/2 + q^2/2 - q^3/3", name="cubic oscillator")


def column(solution, expressions):
    """A column of functions on a solution as rational functions."""
    arithmetic = Arithmetic(solution.variable, solution.root)
    return [arithmetic.read(sp.sympify(e), "") for e in expressions]


def test_planes_of_the_twisted_top():
    origins = [plane.origin for plane in invariant_planes(TWISTED)]
    assert "the invariant plane of l3, alpha1, alpha2" in origins
    assert "the invariant plane of l3, alpha1, alpha2, beta3" in origins
    assert not any("l1, alpha" in origin for origin in origins)


def test_the_separatrix_is_found_and_is_the_pendulum():
    found = {s.origin: s for s in particular_solutions(TWISTED)}
    separatrix = found["a separatrix on the invariant plane of l3, alpha1, alpha2"]
    u = separatrix.variable
    assert sp.cancel(separatrix.state["l3"].subs(u, x) - Z) == 0
    assert separatrix.kind == "rational in exp(t)"


def test_one_sign_changed_is_no_solution():
    particular_solution(TWISTED, PENDULUM, variable=x, rate=x)
    with pytest.raises(ParameterError, match="no solution"):
        particular_solution(TWISTED, PENDULUM | {"alpha2": -x * Z.diff(x)}, variable=x, rate=x)
    with pytest.raises(ParameterError, match="no solution"):
        particular_solution(TWISTED, PENDULUM, variable=x, rate=-x)


@pytest.mark.parametrize(
    ("system", "state", "options", "error", "words"),
    [
        (TWISTED, {"l4": x}, {}, ParameterError, "no coordinate"),
        (TWISTED, [x, 0], {}, ShapeError, "9 functions"),
        (TWISTED, {"l3": sp.exp(x)}, {}, ParameterError, "l3: wanted a rational function of x"),
        (TWISTED, {"alpha1": 1}, {}, ParameterError, "equilibrium"),
        (TWISTED, PENDULUM, {"rate": 0}, ParameterError, "must move"),
        (TWISTED, PENDULUM, {"root": (y, x)}, ParameterError, "multiple of y"),
        (TWISTED, PENDULUM, {"variable": "x"}, ParameterError, "SymPy symbol"),
        (
            lp.System(lp.canonical(names=("q",)), "p_q^2/2 + k*q^2", symbols=["k"], name="spring"),
            [x, 0],
            {},
            ParameterError,
            "k of spring is a symbol",
        ),
    ],
)
def test_what_is_no_solution_is_refused(system, state, options, error, words):
    with pytest.raises(error, match=words):
        particular_solution(system, state, **({"variable": x, "rate": x} | options))


CODE = "__import__('pathlib').Path('ran').touch()"


@pytest.mark.parametrize("arguments", [{"state": [CODE, 0]}, {"rate": CODE}, {"root": (y, CODE)}])
def test_texts_are_never_run(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ExpressionError):
        particular_solution(CUBIC, **({"state": [x, 0], "variable": x, "rate": x} | arguments))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("k", [0, 4])
def test_the_field_solves_the_variational_equations_and_differentials_are_integrals(k):
    found = particular_solutions(TWISTED, most=6)
    solution = found[k]
    equations = variational_equations(TWISTED, solution)
    at = dict(zip(TWISTED.variables, solution.vector, strict=True))
    field = column(solution, [sp.sympify(e).subs(at) for e in TWISTED.equations.values()])
    # of the pair (f, g) of f + g y, the component is f or g, with what the equations are written for
    chosen = [[pair[1 if "/" in name else 0]] for pair, name in zip(field, equations.names, strict=True)]
    vector = sp.polys.matrices.DomainMatrix(chosen, (9, 1), equations.entries.domain)
    residual = derivative(vector) - equations.entries * vector
    if solution.root is None or all(
        not pair[0 if "/" in n else 1] for pair, n in zip(field, equations.names, strict=True)
    ):
        assert residual.to_Matrix() == sp.zeros(9, 1)
    if solution.root is None:
        for f in (TWISTED.hamiltonian, *TWISTED.bracket.casimirs()):
            slopes = [[pair[0] for pair in column(solution, [f.diff(v).subs(at) for v in TWISTED.variables])]]
            row = sp.polys.matrices.DomainMatrix(slopes, (1, 9), equations.entries.domain)
            assert (derivative(row) + row * equations.entries).to_Matrix() == sp.zeros(1, 9), f


def test_a_system_without_a_reverser_is_doubled():
    top = lp.Top(inertia=(2, 3, 4), a=(1, 2, 0), epsilon=1)
    elliptic = next(s for s in particular_solutions(top) if s.root)
    equations = variational_equations(top, elliptic)
    assert equations.n == 18
    assert equations.local(equations.singular_points[0]).exponents.neat_power == 2


def test_rational_solutions_are_found_and_only_these():
    system = linear_system(sp.Matrix([[1 / s, 1], [0, -2 / (s - 1)]]), s)  # s, and (s ln.., 1/(s-1)^2)
    found = rational_solutions(system)
    assert len(found) == 1
    assert sp.cancel(found[0].to_Matrix()[0] / s).is_number
    assert len(rational_solutions(linear_system(sp.diag(3 / s, -2 / (s - 1)), s))) == 2
    assert rational_solutions(linear_system(sp.Matrix([[sp.Rational(1, 2) / s]]), s)) == ()


def test_flags_are_invariant_and_as_fine_as_the_means():
    equations = variational_equations(TWISTED, particular_solution(TWISTED, PENDULUM, variable=x, rate=x))
    block = equations.part(equations.summands[0])
    found = flag(block)
    assert found.sizes == (1, 2, 1, 1)
    entries = found.triangular.matrix
    assert entries[1:, 0] == sp.zeros(4, 1)
    assert entries[3:, :3] == sp.zeros(2, 3)
    assert not found.triangular.singular_points[2:], "no new singular points"
