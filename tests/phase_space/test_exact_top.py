"""Which systems the algebra of equilibria takes for tops: by their bracket and equations, in 9, 6 and 3 components."""

import pytest
import sympy as sp
from flint import fmpq

import liepoisson as lp
from liepoisson.equilibrium.heavy_equilibria import exact_top

HEAVY = "l1^2/4 + l2^2/3 + l3^2/2 + 3/5*alpha1 + 4/5*alpha3"


def numbers(top):
    return [list(map(str, vector)) for vector in (top.inertia, top.a, top.b)] + [str(top.epsilon)]


@pytest.mark.parametrize("name", ["heavy-top", "lagrange", "kovalevskaya", "goryachev-chaplygin"])
def test_six_components_have_the_parameters_of_the_file(name):
    system = lp.catalog.system(name)
    expected = {
        "heavy-top": [["2", "3/2", "1"], ["3/5", "0", "4/5"]],
        "lagrange": [["1", "1", "1/2"], ["0", "0", "1"]],
        "kovalevskaya": [["2", "2", "1"], ["-1", "0", "0"]],
        "goryachev-chaplygin": [["4", "4", "1"], ["1", "0", "0"]],
    }
    assert numbers(exact_top(system)) == [*expected[name], ["0"] * 3, "0"]


@pytest.mark.parametrize("extension", [lp.semidirect(2), lp.leibniz(2), lp.leibniz(2, "7/3")])
def test_it_is_recognised_by_its_equations_and_not_by_its_name_or_its_hamiltonian(extension):
    plain = lp.System(lp.so(3) @ extension, HEAVY, name="nothing")
    with_casimirs = lp.System(lp.so(3) @ extension, f"{HEAVY} + dot(alpha, alpha)^2 - 3*dot(l, alpha)")
    assert numbers(exact_top(plain)) == [["2", "3/2", "1"], ["3/5", "0", "4/5"], ["0"] * 3, "0"]
    assert exact_top(with_casimirs) == exact_top(plain)


def test_three_components_give_moments_that_differ_as_those_of_the_body_do():
    """Only the differences of the 1/I are in the equations; they may be shifted to be positive."""
    for hamiltonian, differences in {
        "l1^2/2 + l2^2/4 + l3^2/6": (fmpq(-1, 2), fmpq(-1, 6)),
        "l1^2/2 - l2^2/4 + dot(l, l)^2": (fmpq(-3, 2), fmpq(1, 2)),
        "-dot(l, l)": (fmpq(0), fmpq(0)),
    }.items():
        top = exact_top(lp.System(lp.so(3) @ lp.trivial(), hamiltonian))
        assert min(top.inertia) > 0
        assert (1 / top.inertia[1] - 1 / top.inertia[0], 1 / top.inertia[2] - 1 / top.inertia[1]) == differences
        assert numbers(top)[1:] == [["0"] * 3, ["0"] * 3, "0"]


@pytest.mark.parametrize(
    "name",
    ["kirchhoff", "clebsch", "neumann", "kovalevskaya-gyrostat", "zhukovsky-volterra-gyrostat", "so21-heavy-top"],
)
def test_other_systems_of_the_catalogue_are_no_tops(name):
    assert exact_top(lp.catalog.system(name)) is None


@pytest.mark.parametrize(
    ("extension", "hamiltonian"),
    [
        (lp.leibniz(2), f"{HEAVY} + l1*l2/7"),
        (lp.leibniz(2), f"{HEAVY} + l3/7"),
        (lp.leibniz(2), f"{HEAVY} + sqrt(1 + alpha1^2)"),
        (lp.leibniz(2), "l1^2/2 + l2^2/2 + alpha1"),
        (lp.leibniz(2), f"{HEAVY} + (l1 + l2 + l3 + alpha1 + alpha2 + alpha3)^6"),
        (lp.leibniz(1), "l1^2/2 + l2^2/4 + l1*l2"),
        (lp.leibniz(1), "l1^2/2 + l2^2/4 + l3"),
        (lp.leibniz(1), "l1^4 + l2^2"),
    ],
)
def test_other_hamiltonians_are_no_tops(extension, hamiltonian):
    assert exact_top(lp.System(lp.so(3) @ extension, hamiltonian)) is None


@pytest.mark.parametrize("algebra", [lp.so(2, 1), lp.algebras.heisenberg(1)])
@pytest.mark.parametrize("n", [1, 2])
def test_other_algebras_are_no_tops(algebra, n):
    system = lp.System(algebra @ lp.leibniz(n), lambda l, *fields: l[0] ** 2 + l[1] ** 2 / 3 + l[2] ** 2 / 5)
    assert exact_top(system) is None


def test_irrational_parameters_are_refused():
    for root in (sp.sqrt(2), sp.Symbol("s")):
        for n in (1, 2, 3):
            system = lp.System(
                lp.so(3) @ lp.leibniz(n),
                lambda l, *fields, c=root: l[0] ** 2 + l[1] ** 2 / 3 + c * l[2] ** 2,
                symbols=["s"],
            )
            assert exact_top(system) is None
    assert exact_top(lp.Top(inertia=(1, 2, 2.5), a=(1, 0, 0), epsilon=0.5)).epsilon == fmpq(1, 2)


@pytest.mark.parametrize("n", [2, 3])
def test_only_moments_of_one_sign_make_the_kinetic_energy_definite(n):
    for signs, expected in {"+++": True, "---": True, "++-": False, "-+-": False}.items():
        kinetic = "".join(f"{sign} {k}*l{k}^2" for k, sign in enumerate(signs, start=1))
        top = exact_top(lp.System(lp.so(3) @ lp.leibniz(n), f"{kinetic} + alpha1"))
        assert top.is_definite is expected
