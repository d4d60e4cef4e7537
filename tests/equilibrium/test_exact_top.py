"""Which systems the algebra of equilibria takes for tops: by their bracket and equations, in 9, 6 and 3 components."""

import pytest
import sympy as sp
from flint import fmpq

import liepoisson as lp
from liepoisson.equilibrium.heavy_equilibria import exact_top

HEAVY = "l1^2/4 + l2^2/3 + l3^2/2 + 3/5*alpha1 + 4/5*alpha3"


def numbers(top):
    return [list(map(str, vector)) for vector in (top.inertia, top.a, top.b)] + [str(top.epsilon)]


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
    ("extension", "hamiltonian"),
    [
        (lp.leibniz(2), f"{HEAVY} + l1*l2/7"),
        (lp.leibniz(2), f"{HEAVY} + l3/7"),
        (lp.leibniz(2), "l1^2/2 + l2^2/2 + alpha1"),
        (lp.leibniz(1), "l1^2/2 + l2^2/4 + l1*l2"),
        (lp.leibniz(1), "l1^4 + l2^2"),
    ],
)
def test_other_hamiltonians_are_no_tops(extension, hamiltonian):
    assert exact_top(lp.System(lp.so(3) @ extension, hamiltonian)) is None


@pytest.mark.parametrize(
    "system",
    [
        *map(
            lp.catalog.system, ("kirchhoff", "kovalevskaya-gyrostat", "zhukovsky-volterra-gyrostat", "so21-heavy-top")
        ),
        lp.Top(inertia=(1, 2, sp.sqrt(5)), a=(1, 0, 0), epsilon=1),
        lp.System(lp.algebras.heisenberg(1) @ lp.leibniz(2), lambda l, m: l[0] ** 2 + l[1] ** 2 / 3 + l[2] ** 2 / 5),
        lp.System(lp.so(3) @ lp.trivial(), "l1^2 + l2^2/3 + s*l3^2", symbols=["s"]),
    ],
    ids=str,
)
def test_other_systems_are_no_tops(system):
    assert exact_top(system) is None


@pytest.mark.parametrize("n", [2, 3])
def test_only_moments_of_one_sign_make_the_kinetic_energy_definite(n):
    for signs, expected in {"+++": True, "---": True, "++-": False, "-+-": False}.items():
        kinetic = "".join(f"{sign} {k}*l{k}^2" for k, sign in enumerate(signs, start=1))
        top = exact_top(lp.System(lp.so(3) @ lp.leibniz(n), f"{kinetic} + alpha1"))
        assert top.is_definite is expected
