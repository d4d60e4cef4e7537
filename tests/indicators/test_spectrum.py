"""Lyapunov spectra: known answers, the structure that the bracket prescribes, errors, pieces, failures."""

from dataclasses import replace

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators.spectrum import lyapunov_spectrum
from liepoisson.indicators.structural_zeros import RATIO_LIMIT, keeps_volume, poisson_structure
from liepoisson.indicators.tangent_frames import orthonormal_frames

TOP = lp.Top.twisted_kovalevskaya()


class BareField:
    """A field without a bracket."""

    name = "bare"

    def field(self):
        return TOP.field()


def test_a_linear_hamiltonian_flow_has_its_eigenvalues():
    """H = (p1^2 - 2 q1^2)/2 + q2 p2/3 has the eigenvalues +-sqrt 2 and +-1/3."""
    saddle = lp.systems.CanonicalSystem(["q1", "q2"], ["p1", "p2"], "(p1^2 - 2*q1^2)/2 + q2*p2/3")
    spectrum = lyapunov_spectrum(saddle, np.zeros(4), t_end=400, transient=100)
    expected = [np.sqrt(2), 1 / 3, -1 / 3, -np.sqrt(2)]
    # after the transient the frame is that of the invariant flag, so the rates are the eigenvalues but for rounding,
    # and that is 1e-16 times the ratio of stretchings, exp(5 * 2 sqrt 2) = 1e6, in each interval
    assert np.abs(spectrum.end_exponent[0] - expected).max() < 1e-9
    assert spectrum.error.max() < 1e-9


@pytest.mark.parametrize("unit", [1e-18, 1.0])
def test_exponents_of_an_equilibrium_do_not_depend_on_the_unit_of_l(unit):
    """The same top with l in units of its own: moments and a are multiplied by the unit, l = 0 all the same."""
    top = lp.Top.heavy(inertia=(2 * unit, 2 * unit, unit), a=(-unit, 0, 0))
    upright = np.zeros(9)
    upright[3] = -2.0
    found = lyapunov_spectrum(top, upright, t_end=1000, transient=200).end_exponent[0]
    assert (np.diff(found) <= 1e-6).all()
    # the zeros of Jordan blocks turn like 1/t, and where the transient leaves them depends on the frame at first
    assert found == pytest.approx([np.sqrt(2), 1, *[0] * 5, -1, -np.sqrt(2)], abs=1e-2)
    one = lp.lyapunov_exponent(top, upright, t_end=1000, transient=200)
    assert one.exponent[0] == pytest.approx(np.sqrt(2), abs=1e-6)


@pytest.mark.parametrize(
    "system",
    [lp.Top.free_rigid_body((3, 2, 1)), lp.Top.twisted_lagrange(), lp.catalog.system("manakov-so4")],
    ids=["free", "twisted-lagrange", "so4"],
)
def test_all_exponents_of_an_integrable_system_vanish(system):
    x0 = lp.sample_states(system, 3, seed=1)
    spectrum = lyapunov_spectrum(system, x0, t_end=1000)
    assert (np.abs(spectrum.end_exponent).max(axis=1) < spectrum.residuals.zero_threshold).all()
    assert spectrum.structure is not None
    assert (spectrum.structure.n_zeros == x0.shape[1]).all()


@pytest.mark.thorough
def test_a_generic_twisted_orbit_has_five_zeros_and_two_pairs():
    """Measured for 100 starts at t = 1e4: zeros at most 1.5e-3, pairs within 9.4e-4."""
    x0 = lp.sample_states(TOP, 6, seed=1)
    spectrum = lyapunov_spectrum(TOP, x0, t_end=1000, transient=100)
    residuals = spectrum.residuals
    assert (spectrum.structure.n_zeros == 5).all()
    assert (residuals.zeros_below_threshold == 1.0).all()
    assert np.abs(residuals.sum).max() < 1e-14  # the field has no divergence; a sum of logarithms to round-off
    assert np.abs(residuals.pairing).max() < 10 / 1000  # a bounded change of the logarithms, over t
    assert (spectrum.end_exponent[:, 0] > residuals.zero_threshold).all()
    assert "for 6 of 6 trajectories" in spectrum.check()


def test_the_zeros_that_are_checked_are_the_middle_ones_not_those_nearest_to_zero():
    """A fault that moves a zero: (3, 2, 1, 1, 1, 0, 0, -2, -3)/10 has the middle (1, 1, 1, 0, 0)/10, in this order."""
    spectrum = lyapunov_spectrum(TOP, lp.sample_states(TOP, 1, seed=1), t_end=1000)
    faulty = np.array([[2, 3, 1, 0, 1, 0, 1, -2, -3]]) / 10
    changed = replace(spectrum, exponent=np.repeat(faulty[:, None], len(spectrum.time), axis=1))
    assert np.array_equal(changed.residuals.zeros, [[0.1, 0.1, 0.1, 0, 0]])
    assert changed.residuals.zeros_below_threshold == pytest.approx([0.4])


def test_structural_zeros_count_casimirs_and_integrals_twice():
    x0 = lp.sample_states(TOP, 2, seed=3)
    counts = {
        "charged": (lp.Top.charged_heavy((1, 2, 3), (1, 0, 1), (0, 1, 0)), 3 + 2),
        "kovalevskaya": (lp.Top.kovalevskaya(), 3 + 6),  # H, K and l.alpha in involution
        "twisted-lagrange": (lp.Top.twisted_lagrange(), 3 + 6),  # H, l3, P
    }
    for name, (top, expected) in counts.items():
        structure = poisson_structure(top, x0)
        assert structure is not None
        assert (structure.n_zeros == expected).all(), (name, structure.n_zeros, expected)
        assert (structure.corank == 3).all()


def test_on_a_leaf_of_lower_rank_pairs_are_not_claimed():
    low = np.array([[0.3, -0.2, 0.9, 1.0, 0.2, -0.4, 0, 0, 0]])  # beta = 0: rank 4
    structure = poisson_structure(TOP, low)
    assert structure is not None
    assert (structure.corank[0], structure.is_regular[0]) == (5, False)
    spectrum = lyapunov_spectrum(TOP, low, t_end=100)
    assert np.isnan(spectrum.residuals.pairing).all()
    assert np.isnan(spectrum.residuals.zeros).all()
    assert "lower rank" in spectrum.check()


def test_the_first_exponent_is_that_of_lyapunov_exponent():
    x0 = lp.sample_states(TOP, 4, seed=3)
    one = lyapunov_spectrum(TOP, x0, t_end=60, n_exponents=2, seed=7, first=300)
    growth = lp.finite_time_exponents(TOP, x0, times=one.time, seed=7, first=300)
    # other steps, so that the orbits differ by 1e-13 exp(0.15 * 60) = 1e-9
    assert np.abs(one.exponent[:, :, 0] - growth.exponent).max() < 1e-8


def test_frames_are_orthonormal_and_depend_on_the_seed():
    frames = orthonormal_frames(9, 9, 300, seed=1)
    assert np.abs(np.swapaxes(frames, 1, 2) @ frames - np.eye(9)).max() < 1e-14
    assert np.array_equal(frames[256:], orthonormal_frames(9, 9, 44, seed=1, first=256))
    assert np.abs(frames - orthonormal_frames(9, 9, 300, seed=2)).max() > 0.1
    # blocks of 256 trajectories have streams of their own: two planes in nine dimensions share no line
    planes = orthonormal_frames(9, 2, 257, seed=1)
    assert np.linalg.svd(np.hstack([planes[0], planes[256]]), compute_uv=False)[-1] > 1e-3


@pytest.mark.parametrize("unit", [1e-9, 1.0])
def test_keeping_the_volume_knows_no_unit_of_time(unit):
    """H and t -> H/unit and t unit; div f is 1/unit or 0."""
    taylor = lp.Taylor(tol=1e-13)
    for system, keeps in ((lp.System(lp.algebras.affine(1) @ lp.trivial(), f"la/({unit:g})"), False),
                          (lp.Top.heavy(inertia=(2 * unit, 2 * unit, unit), a=(-1 / unit, 0, 0)), True)):  # fmt: skip
        states = lp.sample_states(system, 4, seed=1)
        assert keeps_volume(system.field(), states, time=5 * unit, method=taylor) is keeps


def test_a_field_without_a_bracket_has_no_structure_and_few_exponents_no_sum():
    x0 = lp.sample_states(TOP, 1, seed=1)
    assert "no Poisson tensor" in lyapunov_spectrum(BareField(), x0, t_end=20).check()
    few = lyapunov_spectrum(TOP, x0, t_end=20, interval=5, n_exponents=3)
    assert few.exponent.shape == (1, 4, 3)
    assert "only 3 of 9 exponents" in few.check()


def test_too_long_an_interval_is_told():
    spectrum = lyapunov_spectrum(TOP, lp.sample_states(TOP, 2, seed=1), t_end=400, interval=200)
    assert spectrum.largest_ratio.max() > RATIO_LIMIT
    assert "or a shorter one" in spectrum.check()


SPIRAL = lp.VectorField({"x": "y", "y": "-x", "z": "-40*z"})


@pytest.mark.parametrize(("interval", "advised"), [(1, "0.5"), (4, "0.5"), (50, "1")])
def test_an_exponent_that_round_off_hides_is_not_known(interval, advised):
    """Exponents 0, 0, -40: stretchings differ by exp(40 interval), at last beyond 1e308; 18.4/40 = 0.46 is advised."""
    options = {"t_end": 200, "transient": 100, "covariant": True}
    spectrum = lyapunov_spectrum(SPIRAL, [1, 0, 1], interval=interval, **options)
    assert spectrum.outcome.tolist() == ["finished"]
    np.testing.assert_allclose(spectrum.end_exponent[0, :2], 0, atol=1e-12)
    assert np.isnan(spectrum.exponent[0, :, 2]).all()
    assert np.isnan(spectrum.error[0, 2])
    assert np.isnan(spectrum.covariant.vector).all()
    assert "only 2 of 3 exponents" in spectrum.check()
    assert f"take interval={advised} or a shorter one" in spectrum.check()
    known = lyapunov_spectrum(SPIRAL, [1, 0, 1], interval=0.4, **options)
    np.testing.assert_allclose(known.end_exponent[0], [0, 0, -40], atol=1e-9)
    assert np.isfinite(known.covariant.vector).all()
    assert "interval" not in known.check()


def test_what_round_off_hides_before_the_averages_does_not_matter():
    """z falls from 10^6 to 1, its neighbours by f(z)/f(10^6), less than 1e-18 of that; at the end like exp(-2 t)."""
    field = lp.VectorField({"x": "y", "y": "-x", "z": "-(z - 1)*(1 + z^2)"})
    spectrum = lyapunov_spectrum(field, [1, 0, 1e6], t_end=50, transient=20, interval=2)
    np.testing.assert_allclose(spectrum.end_exponent[0], [0, 0, -2], atol=1e-6)


def test_a_natural_time_that_is_not_known_is_told():
    """q'' = 4 q^3 from 1 is infinite at t = 0.93, long before 32 natural times are over."""
    spectrum = lyapunov_spectrum(lp.System(lp.canonical(1), "p1^2/2 - q1^4"), [1, 0], t_end=0.5)
    assert np.isnan(spectrum.time_scale).all()
    assert "the natural time T of the orbit is not known" in spectrum.check()
