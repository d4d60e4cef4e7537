"""The catalog's systems on brackets that are not linear: solutions in closed form, closed orbits, integrals."""

import numpy as np
import sympy as sp
from scipy.special import ellipj, ellipk

import liepoisson as lp
from liepoisson import catalog


def test_the_sklyanin_top_turns_as_eulers():
    """S1' = 4 S2 S3, S2' = -6 S3 S1, S3' = 2 S1 S2: S1 = a cn(w t), S2 = -b sn(w t), S3 = c dn(w t)."""
    top = catalog.system("sklyanin")
    # a w = 4 b c, b w = 6 a c, c w k^2 = 2 a b
    c, k2 = 1.0, 0.5
    w = np.sqrt(24) * c
    a = np.sqrt(k2 * c * w / (2 * np.sqrt(1.5)))
    b = np.sqrt(1.5) * a
    times = np.linspace(0, 3, 13)
    sn, cn, dn, _ = ellipj(w * times, k2)
    run = lp.integrate(top, [0.7, a, 0, c], times=times, method=lp.Taylor(tol=1e-15))
    np.testing.assert_allclose(run.state[0], np.stack([0.7 + 0 * sn, a * cn, -b * sn, c * dn], 1), atol=1e-11)
    period = lp.integrate(top, [0.7, a, 0, c], t_end=4 * ellipk(k2) / w).end_state[0]
    np.testing.assert_allclose(period, [0.7, a, 0, c], atol=1e-10)


def test_the_two_casimirs_of_the_sklyanin_bracket_are_those_of_the_file():
    bracket = catalog.system("sklyanin").bracket
    S0, S1, S2, S3 = bracket.variables
    assert bracket.casimirs() == [S1**2 + S2**2 + S3**2, S0**2 + S1**2 + 2 * S2**2 + 4 * S3**2]
    assert (bracket.jacobi, bracket.rank(), bracket.n_unknown_casimirs) == ("proved", 2, 0)


def test_three_species_return():
    """On a leaf of dimension two orbits close: the state comes back to the section that it left."""
    system = catalog.system("lotka-volterra-3")
    for start in ([1.0, 2.0, 4.0], [0.2, 1.0, 1.1]):
        points = lp.section(system, start, surface=f"x - {start[0]}", direction=0, t_end=40)
        back = np.abs(points.state - start).max(axis=1)
        assert (back < 1e-9).sum() >= 2, back


def test_the_volterra_lattice_is_integrable_and_the_chain_of_four_is_not_known_to_be():
    ring = catalog.system("volterra-lattice-5")
    assert ring.bracket.rank() == 4
    (K,) = ring.integrals.values()
    assert ring.bracket(K, ring.hamiltonian).expand() == 0
    run = lp.integrate(ring, [1, 2, 3, 5, 7], t_end=20, method=lp.Taylor(tol=1e-15))
    values = sp.lambdify(ring.variables, K)(*run.state[0].T)
    assert np.ptp(values) < 1e-10
    chain = catalog.system("lotka-volterra-4")
    assert (chain.bracket.rank(), chain.bracket.casimirs()) == (4, [])
    np.testing.assert_allclose(chain.vector_field([1, 1, 1, 1]), 0, atol=1e-15)
