"""The search for equilibria and relative equilibria, against closed forms."""

import numpy as np
import pytest

import liepoisson as lp

PERTURBATION = 1e-3


def twisted_lagrange(rng):
    I1, I3 = rng.uniform(0.8, 1.5), rng.uniform(0.5, 1.5)
    a3, epsilon = rng.uniform(0.5, 2, 2)
    return lp.Top(inertia=(I1, I1, I3), a=(0, 0, a3), epsilon=epsilon), (I1, I3, a3, epsilon)


def test_free_rigid_body_has_its_six_steady_rotations():
    """On |l| = 1: l = +-e_k with the energy 1/(2 I_k); the middle axis grows at sqrt((1/I1 - 1/I2)(1/I2 - 1/I3))."""
    body = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2 + l2^2/4 + l3^2/6")
    found = lp.equilibria(body, {"C1": 1}, n_starts=100, seed=1)
    assert len(found) == 6
    np.testing.assert_allclose([e.energy for e in found], np.repeat([1 / 6, 1 / 4, 1 / 2], 2), rtol=1e-13)
    np.testing.assert_allclose(np.abs([e.state for e in found]), np.eye(3)[[2, 2, 1, 1, 0, 0]], atol=1e-12)
    assert [e.signature for e in found] == [(2, 0, 0)] * 2 + [(1, 1, 0)] * 2 + [(0, 2, 0)] * 2
    assert [e.linear_stability for e in found] == ["stable spectrum"] * 2 + ["unstable"] * 2 + ["stable spectrum"] * 2
    np.testing.assert_allclose([e.growth_rate for e in found[2:4]], np.sqrt(1 / 2 * 1 / 6), rtol=1e-12)
    np.testing.assert_allclose([e.multipliers["C1"] for e in found], [e.energy for e in found], rtol=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["twisted-kovalevskaya", "heavy-top", "manakov-so4"])
def test_what_is_found_is_an_equilibrium_on_the_leaf_with_a_hamiltonian_spectrum(name):
    system = lp.catalog.system(name)
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=3)[0])
    found = lp.equilibria(system, leaf, n_starts=60, seed=2)
    assert found
    for e in found:
        assert leaf.contains(e.state)
        assert np.abs(system.vector_field(e.state)).max() < 1e-10
        assert e.asymmetry < 1e-10
        jacobian = system.functions.jacobian(e.state)
        basis = leaf.tangent_basis(e.state)
        direct = np.linalg.eigvals(basis.T @ jacobian @ basis)
        for symmetric in (-direct, direct.conj()):
            assert distance(direct, symmetric) < 1e-6
        # Families have defective zeros: direct eigenvalues scatter by the square root of the round-off.
        assert distance(direct, e.spectrum) < (1e-6 if e.nullity else 1e-9)


def distance(first, second):
    """The largest distance of a number in one list from the other list, relative to the largest number."""
    gaps = np.abs(first[:, None] - second[None, :])
    return max(gaps.min(axis=0).max(), gaps.min(axis=1).max()) / max(np.abs(first).max(), 1e-300)


@pytest.mark.thorough
def test_relative_equilibria_of_the_twisted_lagrange_top_are_those_of_the_formula():
    r"""l = I1 kappa beta - (a3 nu/kappa^2) e3, alpha = (eps a3 e3 - nu beta)/kappa, Omega = l3/I3 - kappa beta3."""
    rng = np.random.default_rng(4)
    e3 = np.array([0.0, 0.0, 1.0])
    for _ in range(5):
        top, (I1, I3, a3, epsilon) = twisted_lagrange(rng)
        kappa, nu = rng.uniform(0.5, 2), rng.normal()
        beta = rng.normal(size=3)
        l, alpha = I1 * kappa * beta - a3 * nu / kappa**2 * e3, (epsilon * a3 * e3 - nu * beta) / kappa
        x = np.concatenate([l, alpha, beta])
        given = lp.phase_space.equilibrium(top, x, along=("l3",))
        np.testing.assert_allclose(given.omega["l3"], l[2] / I3 - kappa * beta[2], rtol=1e-9)
        reached = lp.phase_space.equilibrium_near(top, x + PERTURBATION * rng.normal(size=9), along=("l3",))
        assert reached.residual < 1e-11
        assert np.linalg.norm(reached.state - x) < 30 * PERTURBATION
        # Seen from the frame that turns with it: the eigenvalues on the slice are among those of all nine variables.
        generator = np.kron(np.eye(3), np.cross(np.eye(3), e3).T)
        direct = np.linalg.eigvals(top.functions.jacobian(reached.state) - reached.omega["l3"] * generator)
        assert reached.asymmetry < 1e-9
        assert max(np.abs(direct - value).min() for value in reached.spectrum) < 1e-6 * np.abs(direct).max()
        # The motion turns everything about e3 at the rate Omega.
        turning = np.concatenate([np.cross(v, e3) for v in reached.state.reshape(3, 3)])
        np.testing.assert_allclose(top.vector_field(reached.state), reached.omega["l3"] * turning, atol=1e-9)


@pytest.mark.thorough
def test_stable_verdict_holds_along_orbits_and_unstable_ones_leave():
    """Stable states keep a small perturbation small for t = 100; unstable ones grow by more than 30."""
    system = lp.catalog.system("twisted-kovalevskaya")
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
    rng = np.random.default_rng(0)
    for e in lp.equilibria(system, leaf, n_starts=60):
        starts = leaf.project(e.state + 1e-6 * rng.normal(size=(4, 9)))
        orbit = lp.integrate(system, starts, times=np.linspace(0, 100, 201))
        distances = np.linalg.norm(orbit.state - e.state, axis=-1).max()
        if e.nonlinear_stability == "stable":
            assert distances < 1e-4
        elif e.growth_rate > 0.1:
            assert distances > 1e-3


@pytest.mark.parametrize(("potential", "q"), [("exp(-q)", 40), ("exp(-q)", 800), ("tanh(q)", 19)])
def test_a_state_on_a_tail_is_undecided(potential, q):
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), f"p^2/2 + {potential}")
    found = lp.phase_space.equilibrium(system, [q, 0])
    assert (found.family, found.linear_stability, found.nonlinear_stability) == ("undecided",) * 3


@pytest.mark.parametrize("error", [1e-9, 0.0])
def test_the_distance_bounds_how_far_the_equilibrium_is(error):
    """cosh(q - 1) + cosh(p) is critical at 1, where 1 + |x| = 2; the bound is at least the error, and no rough one."""
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), "cosh(q - 1) + cosh(p)")
    found = lp.phase_space.equilibrium(system, [1 + error, 0])
    assert found.family == "point"
    assert error <= 2 * found.distance <= 4 * error + 1e-12


def test_where_the_hamiltonian_is_not_real_nothing_rests():
    tensor = lp.PoissonTensor(["x", "y", "z"], {("x", "y"): "x*y", ("y", "z"): "2*y*z", ("x", "z"): "-x*z"})
    found = lp.equilibria(lp.System(tensor, "x + 2*y + z - log(x) - 3*log(y) - log(z)"), {"C1": 2}, n_starts=50)
    assert len(found) > 0
    assert all(np.isfinite(one.energy) for one in found)
