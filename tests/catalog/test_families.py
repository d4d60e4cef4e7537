"""Families of systems: their integrals, their relation to the catalog's systems, their errors."""

from fractions import Fraction

import numpy as np
import pytest
from sympy import Matrix, Symbol

import liepoisson as lp
from liepoisson import catalog


def same_equations(first, second):
    """Equations of two systems, coordinate by coordinate; their names may differ."""
    renamed = dict(zip(second.variables, first.variables, strict=True))
    wanted = [right.subs(renamed, simultaneous=True) for right in second.equations.values()]
    return all((a - b).expand() == 0 for a, b in zip(first.equations.values(), wanted, strict=True))


@pytest.mark.parametrize("n", [3, 4, 5])
def test_manakov_tops_have_commuting_integrals(n):
    top = catalog.manakov(n)
    assert len(top.integrals) == max(0, n - 3)
    functions = [top.hamiltonian, *top.integrals.values()]
    assert all(top.bracket(f, g) == 0 for f in functions for g in functions)
    gradients = Matrix(functions).jacobian(top.variables).subs({x: k + 1 for k, x in enumerate(top.variables)})
    assert gradients.rank() == len(functions)


def test_the_manakov_top_of_so3_is_eulers():
    """In three dimensions the moment of the plane 23 is J2 + J3: that of the axis 1."""
    J = (1, 2, 4)
    assert same_equations(catalog.manakov(3, J), catalog.euler_top_on("so(3)", (6, 5, 3)))


def test_the_manakov_top_of_so4_is_the_catalogs():
    top = catalog.manakov(4)
    assert same_equations(top, catalog.system("manakov-so4"))
    K = catalog.system("manakov-so4").integrals["K"]
    assert top.is_constant(K)
    assert top.bracket(K, top.integrals["K3"]) == 0


@pytest.mark.thorough
@pytest.mark.parametrize("n", [2, 3, 4])
def test_su_tops_have_commuting_integrals_and_contain_manakovs(n):
    top = catalog.su_top(n)
    functions = [top.hamiltonian, *top.integrals.values()]
    assert len(top.integrals) == n - 1 + max(0, n - 3)
    assert all(top.bracket(f, g) == 0 for f in functions for g in functions)
    if n == 4:
        m = n * (n - 1) // 2
        real = dict.fromkeys(top.variables[m:], 0)
        manakov = catalog.manakov(n)
        renamed = dict(zip(top.variables[:m], manakov.variables, strict=True))
        restricted = [right.subs(real).subs(renamed) for right in top.equations.values()]
        assert all((a - b).expand() == 0 for a, b in zip(restricted, manakov.equations.values(), strict=False))
        assert all(right == 0 for right in restricted[m:])


@pytest.mark.parametrize("N", [3, 5])
def test_zeitlins_truncations_are_the_catalogs(N):
    family, file = catalog.zeitlin(N), catalog.system(f"zeitlin-{N}")
    assert family.variables == file.variables
    assert (family.hamiltonian - file.hamiltonian).expand() == 0


def test_reduced_mhd_is_the_catalogs():
    family, file = catalog.reduced_mhd(3), catalog.system("reduced-mhd-3")
    assert family.variables == file.variables
    assert (family.hamiltonian - file.hamiltonian).expand() == 0


def test_leibniz_tops_of_low_order_are_the_known_tops():
    inertia, a = (1, 1, Fraction(1, 2)), (0, 0, 1)
    heavy, twisted = catalog.system("lagrange"), catalog.system("twisted-lagrange")
    assert same_equations(catalog.leibniz_top(2, inertia, [a]), heavy)
    assert same_equations(catalog.leibniz_top(3, inertia, [a]), twisted)
    assert same_equations(catalog.leibniz_top(5, inertia, [a]), catalog.system("leibniz-lagrange-5"))
    assert same_equations(catalog.heavy_top_on("so(3)", inertia, a), heavy)
    assert same_equations(catalog.twisted_top_on("so(3)", inertia, a), twisted)
    assert same_equations(catalog.twisted_top_on("so(2,1)", inertia, a), catalog.system("so21-twisted-top"))


def test_symbolic_parameters_are_kept():
    top = catalog.leibniz_top(3, ("I1", "I1", "I3"), [(0, 0, "a3"), (0, 0, "b3")], "epsilon")
    assert Symbol("epsilon") in top.bracket.casimirs()[0].free_symbols
    assert top.is_constant(top.variables[2])  # the third component of l


def by_fourier_series(w):
    """Velocity on a grid over the torus, and the rate of the vorticity w by Euler's equation."""
    k = np.fft.fftfreq(len(w), 1 / len(w))
    k1, k2 = np.meshgrid(k, k, indexing="xy")
    square = np.where(k1**2 + k2**2 > 0, k1**2 + k2**2, 1.0)

    def slope(f, along):
        return np.fft.ifft2(1j * along * np.fft.fft2(f)).real

    stream = np.fft.ifft2(np.fft.fft2(w) / square).real
    u, v = slope(stream, k2), -slope(stream, k1)
    return u, v, -(u * slope(w, k1) + v * slope(w, k2))


@pytest.mark.thorough
@pytest.mark.parametrize(("n", "error"), [(5, 0.243), (9, 0.079), pytest.param(13, 0.0385, marks=pytest.mark.slow)])
def test_the_truncation_is_as_far_from_eulers_equation_as_the_page_says(n, error):
    fluid = lp.catalog.zeitlin(n)
    start = {"wc10": 0.5, "ws01": 0.3, "wc11": 0.2, "ws1m1": -0.4}
    orbit = lp.integrate(fluid, start, times=[0, 1e-3], dense=True)
    rates = orbit.series[0][1][0, 1]  # the first power of the time
    w, rate = lp.catalog.vorticity([orbit.state[0, 0], rates], 48)
    u, v, wanted = by_fourier_series(w)
    assert np.sqrt(np.mean((rate - wanted) ** 2) / np.mean(wanted**2)) == pytest.approx(error, abs=0.0005)
    assert np.mean(u**2 + v**2) / 2 == pytest.approx(fluid.functions.energy(orbit.state[0, 0]), rel=1e-12)
    assert n * np.mean(w**2) == pytest.approx(orbit.invariants["C1"][0, 0], rel=1e-12)
