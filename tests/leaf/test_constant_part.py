"""Leaves, equilibria, samples, sections and exponents on brackets with a constant part."""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.equilibrium.critical_points import HamiltonianFields
from liepoisson.equilibrium.euler_characteristic import euler_characteristic
from liepoisson.errors import LeafError, ParameterError
from liepoisson.indicators.structural_zeros import poisson_structure

K = np.array([1 / 2, 1 / 3, 1 / 4])
CARRIER = lp.catalog.system("gyrostat")
BODY = lp.catalog.system("zhukovsky-volterra-gyrostat")
HENON_HEILES = lp.catalog.system("henon-heiles")
WELL = lp.System(lp.canonical(2), "(dot(p, p) + dot(q, q))/2 + q1^2*q2^2", name="well")


def twisted():
    """The twisted top in translated coordinates, and x0."""
    x0 = np.array([0.5, -0.25, 1, 0.5, 0, -0.5, 0.25, 1, 0])
    top = lp.Top(inertia=(1, 2, 3), a=(0, 0, 1), epsilon="1/2")
    exact = [sp.Rational(float(v)) for v in x0]
    there = {x: x + v for x, v in zip(top.variables, exact, strict=True)}
    moved = lp.System(top.bracket.translated(exact), top.hamiltonian.subs(there, simultaneous=True), name="moved top")
    return top, moved, x0


def test_the_poisson_tensor_and_its_derivative():
    """J at zero is the constant part; what is computed by steps agrees with the derivatives of J grad H."""
    x = np.array([0.3, -1.2, 0.7])
    tensor = CARRIER.functions.poisson_tensor
    np.testing.assert_allclose(tensor(np.zeros(3))[0, 1], -1 / 4)
    np.testing.assert_allclose(tensor(x) - tensor(np.zeros(3)), BODY.functions.poisson_tensor(x), atol=1e-15)
    fields = HamiltonianFields(CARRIER, [CARRIER.functions.energy])
    np.testing.assert_allclose(fields.poisson(x), tensor(x), atol=1e-15)
    np.testing.assert_allclose(fields.fields(x)[:, 0], CARRIER.vector_field(x), atol=1e-15)
    np.testing.assert_allclose(fields.derivatives(x)[..., 0], CARRIER.functions.jacobian(x), atol=1e-15)


@pytest.mark.thorough
def test_a_translated_top_moves_as_the_top():
    top, moved, x0 = twisted()
    start, t = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4]), np.linspace(0, 10, 5)
    orbit = lp.integrate(moved, start - x0, times=t)
    np.testing.assert_allclose(orbit.state[0] + x0, lp.integrate(top, start, times=t).state[0], atol=1e-12)
    ours, theirs = lp.Leaf.through(moved, start - x0), lp.Leaf.through(top, start)
    assert (
        (ours.rank, ours.is_regular, ours.caution) == (theirs.rank, theirs.is_regular, theirs.caution) == (6, True, "")
    )
    np.testing.assert_array_equal(ours.contains(orbit.state[0]), True)
    assert not ours.contains(orbit.state[0, 0] + 0.01)
    assert lp.Leaf(moved, ours.casimirs).residual(start - x0) < 1e-12


def test_a_tape_has_the_constant_part():
    tape = lp.System(CARRIER.bracket, f"({CARRIER.hamiltonian})^(3/2)".replace("**", "^"))
    assert isinstance(tape.field(), lp.fields.TapeField)
    x = np.array([0.3, -1.2, 0.7])
    step = 1e-4
    orbit = lp.integrate(tape, x, times=[0, step]).state[0, 1]
    np.testing.assert_allclose((orbit - x) / step, tape.vector_field(x), atol=1e-3)
    wanted = 1.5 * np.sqrt(CARRIER.functions.energy(x)) * CARRIER.vector_field(x)
    np.testing.assert_allclose(tape.vector_field(x), wanted, atol=1e-13)


@pytest.mark.thorough
def test_the_equilibria_of_the_gyrostat_are_those_of_the_body_moved():
    """M + k is along omega; on a sphere the signs sum to 2, which is checked."""
    state = np.array([0.5, 1.5, -1.0])
    ours, theirs = (lp.equilibria(s, lp.Leaf.through(s, x)) for s, x in ((CARRIER, state), (BODY, state + K)))
    assert ours.euler_characteristic == 2
    assert len(ours) == len(theirs) == 4
    for mine, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(mine.state + K, other.state, atol=1e-9)
        assert mine.energy == pytest.approx(other.energy)
        assert mine.linear_stability == other.linear_stability
        assert mine.signature == other.signature
        assert mine.growth_rate == pytest.approx(other.growth_rate, abs=1e-9)
        assert np.cross(mine.state + K, mine.state / [1, 2, 2.5]) == pytest.approx(np.zeros(3), abs=1e-9)


@pytest.mark.parametrize(("algebra", "characteristic"), [(lp.so(3), 2), (lp.so(4), 4), (lp.su(3), 6)])
def test_orbits_have_the_characteristic_of_those_without_a_constant_part(algebra, characteristic):
    moved = (algebra @ lp.trivial()).translated([(-1) ** k * (9 + k) for k in range(algebra.dimension)])
    system = lp.System(moved, " + ".join(f"{k + 1}*{x}^2" for k, x in enumerate(moved.coordinate_names_in_order)))
    state = np.random.default_rng(1).standard_normal(algebra.dimension)
    assert euler_characteristic(lp.Leaf.through(system, state)) == characteristic


@pytest.mark.thorough
def test_the_origin_of_canonical_coordinates_is_a_state_like_others():
    moved = HENON_HEILES.hamiltonian.subs({x: x - 2 for x in HENON_HEILES.variables}, simultaneous=True)
    elsewhere = lp.System(HENON_HEILES.bracket, moved)
    here, there = (
        lp.phase_space.equilibrium(HENON_HEILES, np.zeros(4)),
        lp.phase_space.equilibrium(elsewhere, np.full(4, 2.0)),
    )
    for found in (here, there):
        assert found.signature == (4, 0, 0)
        assert found.frequencies == pytest.approx([1, 1])
        assert found.residual < 1e-14
    assert len(lp.equilibria(elsewhere, lp.Leaf(elsewhere, {}))) == 4
    assert lp.Leaf(WELL, {}).energy_range() == (pytest.approx(0, abs=1e-12), np.inf)
    assert lp.Leaf.through(WELL, np.zeros(4)).energy_range() == (pytest.approx(0, abs=1e-12), np.inf)
    with pytest.raises(ParameterError, match="must be an equilibrium"):
        lp.phase_space.equilibrium(HENON_HEILES, [0.1, 0, 0, 0])


@pytest.mark.thorough
def test_relative_equilibria_of_a_rotation():
    """H = (p^2 + r^4)/2 with the angular momentum L: circles with Omega^2 = 2 r^2."""
    system = lp.System(lp.canonical(2), "dot(p, p)/2 + dot(q, q)^2/2", integrals={"L": "q1*p2 - q2*p1"})
    (found,) = lp.equilibria(system, lp.Leaf.through(system, [1.0, 0, 0, 1]), along=("L",), values={"L": 1})
    r = np.linalg.norm(found.state[:2])
    assert abs(found.omega["L"]) == pytest.approx(np.sqrt(2) * r)
    assert r**3 * np.sqrt(2) == pytest.approx(1)
    assert found.nonlinear_stability == "stable"
    # epicyclic frequency: V'' + 3 Omega^2 = 6 r^2 + 6 r^2
    assert found.frequencies == pytest.approx([np.sqrt(12) * r])


@pytest.mark.thorough
def test_samples_have_the_liouville_measure():
    """In the well H = |z|^2/2 the fraction of H < E is (E/E0)^2, and q1^2 has the mean E0/3."""
    harmonic = lp.System(lp.canonical(2), "(dot(p, p) + dot(q, q))/2")
    x = lp.Leaf(harmonic, {}).sample(4000, seed=3, energy_below=2.0)
    energy = harmonic.functions.energy(x)
    assert energy.max() <= 2.0
    assert np.mean(energy < 1.0) == pytest.approx(0.25, abs=0.05)
    assert (x**2).mean(axis=0) == pytest.approx(np.full(4, 2 / 3), abs=0.06)
    shell = lp.Leaf(harmonic, {}).sample(4000, seed=3, energy=2.0)
    assert harmonic.functions.energy(shell) == pytest.approx(np.full(4000, 2.0))
    assert (shell**2).mean(axis=0) == pytest.approx(np.ones(4), abs=0.08)
    with pytest.raises(LeafError, match="not bounded"):
        lp.Leaf(HENON_HEILES, {}).sample(4, seed=1)


def test_sections_of_henon_heiles_lie_on_their_energy():
    starts = lp.sections.section_starts(lp.Leaf(HENON_HEILES, {}), "x", energy=1 / 12, n_starts=40, seed=1, direction=1)
    inside = starts[np.abs(starts[:, 1]) < 0.6][:4]
    section = lp.section(HENON_HEILES, inside, surface="x", direction=1, n_crossings=10, t_end=200.0)
    assert np.abs(HENON_HEILES.functions.energy(section.state) - 1 / 12).max() < 1e-13


def test_zeros_and_pairs_of_a_spectrum():
    """One Casimir and a plane for the gyrostat: all three vanish.  Two for Henon-Heiles, with pairs."""
    gyrostat = poisson_structure(CARRIER, np.array([[0.5, 1.5, -1.0], -K]))
    assert gyrostat.corank.tolist() == [1, 3]
    assert gyrostat.n_zeros.tolist()[0] == 3
    assert gyrostat.is_regular.tolist() == [True, False]
    chaotic = poisson_structure(HENON_HEILES, np.array([[0, -0.25, 0.42, 0.0]]))
    assert (chaotic.n_zeros[0], chaotic.corank[0]) == (2, 0)
    toda = lp.catalog.system("toda")
    assert poisson_structure(toda, np.array([[0.1, 0.4, -0.2, 1, -0.5, 0.3]])).n_zeros[0] == 6


@pytest.mark.thorough
def test_a_file_of_results_repeats_its_system(tmp_path):
    for system, start in ((CARRIER, [0.5, 1.5, -1.0]), (HENON_HEILES, [0, -0.25, 0.42, 0.1])):
        orbit = lp.integrate(system, start, times=np.linspace(0, 5, 4))
        orbit.save(tmp_path / "orbit.nc")
        again = lp.rerun(tmp_path / "orbit.nc")
        np.testing.assert_array_equal(again.state, orbit.state)
        assert again.components == orbit.components


def test_a_system_with_quadratures_has_no_leaves():
    system = lp.systems.CanonicalSystem(["x"], ["p"], "(x^2 + p^2)/2", quadratures={"area": "x*x"})
    with pytest.raises(ParameterError, match="area besides, found by quadrature"):
        lp.Leaf(system, {})
    assert system.is_constant("x^2 + p^2")
    assert system.derivative("area - x*p") != 0
    assert sp.expand(system.derivative("2*area + x*p") - sp.Symbol("x") ** 2 - sp.Symbol("p") ** 2) == 0
    plain = lp.systems.CanonicalSystem(["x"], ["p"], "(x^2 + p^2)/2 + x^4")
    assert len(lp.equilibria(plain, lp.Leaf(plain, {}))) == 1


def test_sweeps_tell_brackets_with_different_constants_apart():
    from liepoisson.sweeps.identity import system_record

    one = (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): 1})
    records = [system_record(lp.System(b, "dot(l, l)/2 + l1")) for b in (one, one.with_constant({("l1", "l2"): 2}))]
    assert records[0] != records[1]
    assert "constant part of the bracket" not in system_record(BODY)


@pytest.mark.thorough
def test_parameters_of_canonical_files_and_of_constant_parts_are_swept():
    of_gravity = lp.sweep(
        system="double-pendulum", axes={"g": [0.5, 1.0]}, quantity="chaotic_fraction", n_starts=4, t_end=50, seed=1
    )
    assert of_gravity.points.shape == (2, 1)
    of_rotor = lp.sweep(
        system="gyrostat", axes={"k1": [0.5, 2.0]}, quantity="chaotic_fraction", n_starts=8, t_end=100, seed=1
    )
    assert of_rotor.chaotic_fraction.tolist() == [0, 0]  # integrable
    with pytest.raises(ParameterError, match="theta1"):
        lp.sweep(system="double-pendulum", axes={"theta1": [0.5]}, quantity="chaotic_fraction", n_starts=4, t_end=50)
