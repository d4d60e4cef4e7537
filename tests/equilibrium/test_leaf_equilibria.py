"""The search for equilibria and relative equilibria, against closed forms."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError, ShapeError

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
def test_spherical_pendulum_hangs_and_stands():
    """l.alpha = 0, |alpha| = 1: hanging with the frequency sqrt(a3/I1) twice, standing with that growth rate."""
    pendulum = lp.Top.heavy(inertia=(2, 2, 1), a=(0, 0, 3))
    leaf = lp.Leaf.through(pendulum, [1, 0, 0, 0, 0, 1, 0, 0, 0])
    assert leaf.rank == 4
    down, up = lp.equilibria(pendulum, leaf, n_starts=60)
    np.testing.assert_allclose(down.state, [0, 0, 0, 0, 0, -1, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(up.state, [0, 0, 0, 0, 0, 1, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(down.frequencies, np.sqrt([1.5, 1.5]), rtol=1e-12)
    np.testing.assert_allclose(up.growth_rate, np.sqrt(1.5), rtol=1e-12)
    assert (down.nonlinear_stability, up.nonlinear_stability) == ("stable", "no conclusion")


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["kovalevskaya", "twisted-kovalevskaya", "heavy-top", "clebsch", "manakov-so4"])
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
def test_multipliers_solve_the_lagrange_equations():
    system = lp.catalog.system("twisted-kovalevskaya")
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
    for e in lp.equilibria(system, leaf, n_starts=40):
        slope = system.functions.energy.gradient(e.state)
        for name, casimir in system.functions.casimirs.items():
            slope = slope - e.multipliers[name] * casimir.gradient(e.state)
        assert np.abs(slope).max() < 1e-9


@pytest.mark.thorough
def test_circles_of_equilibria_are_listed_once():
    """The lowest states of this leaf are tilted; the symmetry of the top turns one into a circle of them."""
    top = lp.catalog.system("twisted-lagrange")
    leaf = lp.Leaf.through(top, lp.sample_states(top, 1, seed=1)[0])
    found = lp.equilibria(top, leaf)
    lowest, *others = found
    assert lowest.nullity == 1
    assert lowest.family == "circle"
    assert lowest.signature == (5, 0, 1)
    assert len(others) == 2
    assert found.proved
    assert "with the families" in found.completeness


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
def test_every_relative_equilibrium_of_a_level_set_has_the_form_of_the_formula():
    """Solve the formula for kappa and nu from the state: (l, e3, beta) and (alpha, e3, beta) fix them."""
    rng = np.random.default_rng(5)
    top, (I1, _, a3, epsilon) = twisted_lagrange(rng)
    x = rng.normal(size=9)
    found = lp.equilibria(top, lp.Leaf.through(top, x), along=("l3",), values={"l3": x[2]}, n_starts=80)
    tilted = [e for e in found if np.linalg.norm(e.state[6:8]) > 1e-6]
    assert tilted
    for e in tilted:
        l, alpha, beta = e.state.reshape(3, 3)
        kappa = l[:2] @ beta[:2] / (I1 * beta[:2] @ beta[:2])
        nu = (I1 * kappa * beta[2] - l[2]) * kappa**2 / a3
        np.testing.assert_allclose(l[:2], I1 * kappa * beta[:2], atol=1e-8)
        np.testing.assert_allclose(alpha, (epsilon * a3 * np.eye(3)[2] - nu * beta) / kappa, atol=1e-8)
        np.testing.assert_allclose(e.state[2], x[2], rtol=1e-9)


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


@pytest.mark.slow
def test_same_seed_gives_the_same_list():
    system = lp.catalog.system("clebsch")
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
    first, second = (lp.equilibria(system, leaf, n_starts=8, seed=9) for _ in range(2))
    assert [(e.energy, e.n_found) for e in first] == [(e.energy, e.n_found) for e in second]


@pytest.mark.thorough
def test_the_list_depends_on_the_leaf_and_not_on_the_state_it_was_made_from():
    system = lp.catalog.system("twisted-kovalevskaya")
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
    elsewhere = lp.Leaf(system, leaf.casimirs)
    assert np.abs(leaf.state - elsewhere.state).max() > 0.1
    lists = [lp.equilibria(system, given, n_starts=20) for given in (leaf, leaf.casimirs, elsewhere)]
    for found in lists:
        assert [e.n_found for e in found] == [e.n_found for e in lists[0]]
        np.testing.assert_allclose([e.state for e in found], [e.state for e in lists[0]], atol=1e-9)
    assert 1 <= sum(e.n_found for e in lists[0]) <= 20


def test_a_relative_equilibrium_without_integrals_is_an_equilibrium():
    e = lp.phase_space.equilibrium_near(lp.Top.kovalevskaya(), [0.01, 0, 0, -1, 0, 0, 0, 0, 0.02])
    assert e.omega == {}
    assert np.abs(e.system.vector_field(e.state)).max() < 1e-10


def test_refusals():
    top = lp.Top.twisted_lagrange()
    x = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    with pytest.raises(ParameterError, match="l1 is not constant"):
        lp.phase_space.equilibrium_near(top, x, along=("l1",))
    with pytest.raises(ParameterError, match="Write"):
        lp.phase_space.equilibrium_near(top, x, along="l3")
    with pytest.raises(ParameterError, match="values must give"):
        lp.equilibria(top, lp.Leaf.through(top, x), along=("l3",))
    for values in (3, [1], {"l3": np.nan}, {"l3": 1, "P": 1}):
        with pytest.raises(ParameterError, match="values must give"):
            lp.equilibria(top, lp.Leaf.through(top, x), along=("l3",), values=values)
    with pytest.raises(ParameterError, match="a finite number"):
        lp.equilibria(top, lp.Leaf.through(top, x), along=("l3",), values={"l3": "a"})
    for leaf in (None, 3, [1, 0, 1]):
        with pytest.raises(ParameterError, match="leaf must be a Leaf"):
            lp.equilibria(top, leaf)
    with pytest.raises(ParameterError, match="n_starts"):
        lp.equilibria(top, lp.Leaf.through(top, x), n_starts=0)
    with pytest.raises(ParameterError, match="most_starts"):
        lp.equilibria(top, lp.Leaf.through(top, x), most_starts=0)
    with pytest.raises(ParameterError, match="leaf must be one of"):
        lp.equilibria(lp.Top.kovalevskaya(), lp.Leaf.through(top, x))
    with pytest.raises(LeafError):
        lp.equilibria(top, {"C1": 1, "C2": 0, "C3": -1})
    with pytest.raises(ShapeError):
        lp.phase_space.equilibrium_near(top, [1, 2, 3])


def test_origin_is_a_leaf_of_its_own():
    top = lp.Top.twisted_lagrange()
    (only,) = lp.equilibria(top, lp.Leaf.through(top, np.zeros(9)), n_starts=3)
    assert only.spectrum.shape == (0,)
    assert only.nonlinear_stability == "stable"


PLANE = ("x", "y"), ("px", "py")


def in_plane(potential):
    return lp.System(lp.canonical(names=PLANE[0], momenta=PLANE[1]), f"(px^2 + py^2)/2 + {potential}")


def on_sphere(hamiltonian):
    return lp.System(lp.so(3) @ lp.trivial(), hamiltonian)


def test_a_polynomial_of_high_degree_is_undecided_where_it_is_only_flat():
    """dV/dx = 2x(y^8 + 10 x^18) and dV/dy = 8 x^2 y^7 + 20 y^19 vanish together at the origin only."""
    found = lp.equilibria(in_plane("x^2*y^8 + y^20 + x^20"), {}, n_starts=30, seed=1)
    assert {e.family for e in found} == {"undecided"}
    assert lp.phase_space.equilibrium(found.leaf.system, np.zeros(4)).signature == (2, 0, 2)  # in exact numbers


@pytest.mark.parametrize("hamiltonian", ["exp(-(l1 - l2)^4*200)", "exp(-1000*(l3 - 1)^2)"])
def test_slopes_whose_squares_are_below_the_doubles_are_slopes(hamiltonian):
    """l' = l x grad H = 0 only where grad H, along (1, -1, 0) or e3, is parallel to l or zero: l1 = l2, or a pole."""
    found = lp.equilibria(on_sphere(hamiltonian), {"C1": 1}, n_starts=8, seed=1)
    for state in (one.state for one in found if one.family != "undecided"):
        on_circle = abs(state[0] - state[1]) < 1e-6 and "l1" in hamiltonian
        along = abs(abs(state[2]) - 1) < 1e-9 if "l3" in hamiltonian else abs(state[0] + state[1]) < 1e-9
        assert on_circle or along


@pytest.mark.parametrize("slope", [1e-2, 1e-7, 1e-8, 1e-12, 1e-20])
def test_a_small_perturbation_is_no_unit_of_length(slope):
    """The strict minimum of cosh x + 2 cosh y - d y is at sinh y = d/2, and its second variation is definite."""
    (found,) = lp.equilibria(in_plane(f"cosh(x) + 2*cosh(y) - {slope}*y"), {}, n_starts=30, seed=1)
    assert found.state == pytest.approx([0, np.arcsinh(slope / 2), 0, 0], abs=1e-15)
    assert found.signature == (4, 0, 0)
    assert found.frequencies == pytest.approx([1, np.sqrt(2)], rel=1e-4)


def test_a_perturbed_pendulum_stands_unstably():
    line = lp.canonical(names=("q",), momenta=("p",))
    for potential, rate in (
        ("-cos(q) + 1e-15*q", 1),
        ("exp(-q^2) + 1e-30*q", np.sqrt(2)),
        ("-q^2/2 + q^4/4 + 1e-15*q", 1),
    ):
        found = lp.equilibria(lp.System(line, f"p^2/2 + {potential}"), {}, n_starts=30, seed=1)
        standing = [one for one in found if one.linear_stability == "unstable"]
        assert standing
        assert {one.signature for one in standing} == {(1, 1, 0)}
        assert [one.growth_rate for one in standing] == pytest.approx([rate] * len(standing))
    hanging = lp.phase_space.equilibrium(lp.System(line, "p^2/2 - cos(q - 1e-6)"), [1e-6, 0])
    assert hanging.signature == (2, 0, 0)


def test_a_saddle_beside_the_origin_is_found_from_nearby():
    found = lp.phase_space.equilibrium_near(in_plane("-cos(x) + cos(y) + 1e-9*x"), [0.1, 0.1, 0, 0])
    assert found.state == pytest.approx([-np.arcsin(1e-9), 0, 0, 0], abs=1e-16)
    assert found.signature == (3, 1, 0)


@pytest.mark.parametrize(
    ("potential", "q"), [("exp(-q)", 40), ("exp(-q)", 800), ("tanh(q)", 19), ("exp(-cosh(q))", 8), ("1/(1 + q^2)", 1e6)]
)
def test_a_state_on_a_tail_is_undecided(potential, q):
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), f"p^2/2 + {potential}")
    found = lp.phase_space.equilibrium(system, [q, 0])
    assert (found.family, found.linear_stability, found.nonlinear_stability) == ("undecided",) * 3
    assert "undecided: the equations hold to 1e-8" in repr(found)


def test_a_state_beside_a_flat_equilibrium_is_undecided_and_the_exact_one_is_degenerate():
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), "p^2/2 + (q - 1)^20")
    assert lp.phase_space.equilibrium(system, [1.1, 0]).family == "undecided"
    exact = lp.phase_space.equilibrium(system, [1, 0])
    assert (exact.signature, exact.linear_stability) == ((1, 0, 1), "degenerate")


@pytest.mark.parametrize("error", [1e-9, 1e-12, 0.0])
def test_the_distance_bounds_how_far_the_equilibrium_is(error):
    """cosh(q - 1) + cosh(p) is critical at 1, where 1 + |x| = 2; the bound is at least the error, and no rough one."""
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), "cosh(q - 1) + cosh(p)")
    found = lp.phase_space.equilibrium(system, [1 + error, 0])
    assert found.family == "point"
    assert error <= 2 * found.distance <= 4 * error + 1e-12
