"""Equations in vector notation: as the paper prints them, and equal to J grad H."""

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.formula.styles import NAMES
from liepoisson.report.printing import Cross
from liepoisson.report.vector_equations import vector_equations
from liepoisson.structure.extensions import leibniz
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import so, su

inertia, a, b = sp.symbols("I1:4"), sp.Matrix(sp.symbols("a1:4")), sp.Matrix(sp.symbols("b1:4"))


def top(bracket):
    l, alpha, beta = bracket.fields.values()
    return sum(l[i] ** 2 / (2 * inertia[i]) for i in range(3)) + a.dot(alpha) + b.dot(beta)


def printed(bracket, hamiltonian):
    return [f"{field}' = {formula.write(NAMES)}" for field, formula in vector_equations(bracket, hamiltonian).rows]


def test_the_twisted_top_reads_as_in_the_paper():
    bracket = so(3) @ leibniz(3, "epsilon")
    assert printed(bracket, top(bracket)) == [
        "l' = l × omega + alpha × a + beta × b",
        "alpha' = alpha × omega + epsilon beta × a",
        "beta' = beta × omega",
    ]
    ((name, definition),) = vector_equations(bracket, top(bracket)).definitions
    assert (name, definition.plain) == ("omega", "I^-1 l")


def test_a_sign_in_the_extension_or_the_algebra_shows():
    """The equations follow the bracket: they are derived, not quoted."""
    flipped = so(3) @ leibniz(3, -sp.Symbol("epsilon"))
    assert printed(flipped, top(flipped))[1] == "alpha' = alpha × omega - epsilon beta × a"
    c = [[[-v for v in row] for row in plane] for plane in so(3).structure_constants]
    reversed_ = LieAlgebra(c) @ leibniz(3, "epsilon")
    assert printed(reversed_, top(reversed_))[0] == "l' = -l × omega - alpha × a - beta × b"


def test_so21_has_a_cross_product_of_its_own():
    bracket = so(2, 1) @ leibniz(3, "epsilon")
    assert printed(bracket, top(bracket))[1] == "alpha' = alpha × omega + epsilon beta × a"
    product = vector_equations(bracket, top(bracket)).product
    assert [component.plain for component in product] == ["u2*v3 + u3*v2", "-u1*v3 - u3*v1", "u1*v2 - u2*v1"]
    assert vector_equations(so(3) @ leibniz(1), sp.Symbol("l1")).product is None
    without = su(3) @ leibniz(1)  # a cross product: it has component equations
    assert vector_equations(without, without.variables[0] ** 2) is None


monomials = st.lists(
    st.tuples(st.integers(-3, 3), st.lists(st.integers(0, 8), min_size=1, max_size=3)), min_size=1, max_size=5
)


@settings(max_examples=15)
@given(monomials, st.sampled_from([so(3), so(2, 1), su(2)]))
def test_products_written_out_are_the_hamiltonian_vector_field(terms, algebra):
    """Each u x v replaced by -c_ij^k v_j u_k gives J grad H, for any polynomial Hamiltonian."""
    bracket = algebra @ leibniz(3, sp.Rational(2, 3))
    x = bracket.variables
    hamiltonian = sp.Add(*[weight * sp.Mul(*[x[i] for i in factors]) for weight, factors in terms])
    equations = vector_equations(bracket, hamiltonian)
    named = dict(equations.definitions)
    fields = bracket.fields
    c = algebra.structure_constants

    def vector(name):
        if name in fields:
            return list(fields[name])
        if isinstance(named[name], tuple):
            return [component.expression for component in named[name]]
        sums = [(named[name].expression.coeff(symbol), fields[atom.u]) for symbol, atom in named[name].atoms.items()]
        return list(sum((factor * column for factor, column in sums), sp.zeros(3, 1)))

    def cross(u, v):
        # The constants of su(2) are twice those of so(3), its cross product is the same.
        scale = abs(c[0][1][2])
        sums = [
            -sum(sp.Rational(c[i][j][k] / scale) * v[j] * u[k] for j in range(3) for k in range(3)) for i in range(3)
        ]
        return sp.Matrix(sums)

    derived = bracket.vector_field(hamiltonian)
    for mu, (_, formula) in enumerate(equations.rows):
        total = sp.zeros(3, 1)
        for symbol, atom in formula.atoms.items():
            assert isinstance(atom, Cross)
            total += formula.expression.coeff(symbol) * cross(vector(atom.u), vector(atom.v))
        for component, wanted in zip(total, derived[3 * mu : 3 * mu + 3], strict=True):
            assert sp.expand(component - wanted) == 0
