"""What the indicators refuse, and in which words."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.chaos import agreement, alignment, decide, exponents_by_energy, megno
from liepoisson.errors import LiePoissonError, ParameterError, ShapeError
from liepoisson.indicators.finite_time_fit import EnsembleReduction, Resampling, mean_curve, window_grid, window_scan
from liepoisson.indicators.fit_goodness import fit_goodness
from liepoisson.indicators.mean_error import mean_interval, proportion
from liepoisson.indicators.verdict import Rule

TOP = lp.Top.twisted_kovalevskaya()
X0 = np.ones(9)
LEAF = lp.Leaf(TOP, {"C1": 1.0, "C2": 0.2, "C3": 1.0})
TIME, CURVES = np.arange(1.0, 21.0), np.random.default_rng(0).normal(size=(4, 20))
STEEP = np.geomspace(1e119, 1e120, 30)
fit = lp.fits.finite_time_fit


def exponents(**options):
    return lp.finite_time_exponents(TOP, X0, **options)


def spectrum(**options):
    return lp.lyapunov_spectrum(TOP, X0, **({"t_end": 10} | options))


def one(**options):
    return lp.lyapunov_exponent(TOP, X0, **options)


def angles(**options):
    return alignment(TOP, X0, **({"t_end": 1} | options))


def by_energy(system=TOP, **options):
    run = {"leaf": LEAF, "energies": [0.0], "n_starts": 2, "t_end": 5.0}
    return exponents_by_energy(system, **(run | options))


def estimate(x0=X0):
    return lp.lyapunov_exponent(TOP, [x0, x0], t_end=70, block=1, transient=1)


LINE = lp.System(lp.algebras.abelian(1) @ lp.trivial(), "dot(l, l)/2")


REFUSED = [
    (exponents, ParameterError, "either t_end or times"),
    (lambda: exponents(t_end=1.0, times=[1.0]), ParameterError, "either t_end or times"),
    (lambda: exponents(t_end=-5.0), ParameterError, "positive finite time"),
    (lambda: exponents(times=[2.0, 1.0]), ParameterError, "positive increasing"),
    (lambda: exponents(times=[0.0, 1.0]), ParameterError, "positive increasing"),
    (lambda: exponents(t_end=5, tangents=np.zeros(9)), ParameterError, "tangent vector of trajectory 0"),
    (
        lambda: lp.finite_time_exponents(TOP, [X0] * 4, t_end=1, tangents=np.eye(9)[:3]),
        ShapeError,
        r"tangents must have shape \(9,\) or \(4, 9\).*got shape \(3, 9\)",
    ),
    (one, ParameterError, "wanted t_end, wanted_error, or both"),
    (lambda: one(wanted_error=np.nan), ParameterError, "wanted_error: wanted a positive number"),
    (lambda: one(t_end=100, block=20), ParameterError, "at least 64 blocks"),
    (lambda: one(t_end=1e12), ParameterError, "t_end: wanted at most 10000000 intervals"),
    (lambda: one(wanted_error=0.01, block=1e-9), ParameterError, "longer block"),
    (lambda: one(wanted_error=0.01, transient=1e300), ParameterError, "transient: wanted at most 10000000 intervals"),
    (lambda: estimate().finite_time(0.5), ParameterError, "duration: wanted a time from"),
    (lambda: estimate().quantiles([0.5, -1]), ParameterError, "q: wanted numbers from 0 to 1"),
    (lambda: estimate().histogram(0), ParameterError, "bins: wanted a whole number"),
    (lambda: estimate(np.full(9, 1e200)).quantiles(0.5), ParameterError, "trajectories with a value"),
    (lambda: estimate(np.full(9, 1e200)).histogram(), ParameterError, "trajectories with a value"),
    (lambda: spectrum(t_end=np.inf), ParameterError, "t_end: wanted a positive finite time"),
    (lambda: spectrum(interval=-1), ParameterError, "interval: wanted a positive finite time"),
    (lambda: spectrum(transient=-1), ParameterError, "transient: wanted a finite time >= 0"),
    (lambda: spectrum(t_end=1e12), ParameterError, "t_end: wanted at most 10000000 intervals"),
    (lambda: spectrum(structure="x"), ParameterError, "structure: wanted a PoissonStructure"),
    (lambda: spectrum(n_exponents=10), ParameterError, "n_exponents: wanted a whole number from 1 to 9"),
    (lambda: spectrum(covariant=True, transient=0), ParameterError, "wanted a transient > 0"),
    (lambda: spectrum(covariant=True, transient=5, n_exponents=4), ParameterError, "wanted all 9 exponents"),
    (lambda: spectrum(covariant=True, t_end=20, transient=10, interval=1e-5), ParameterError, "GiB of frames"),
    (lambda: spectrum(covariant=True, transient=5).covariant.angle(4), ParameterError, "come in pairs"),
    (lambda: spectrum(covariant=True, transient=5).covariant.angle(9), ParameterError, "wanted at most 7"),
    (
        lambda: spectrum(covariant=True, transient=5).covariant.distance_from_centre(X0, 5),
        ShapeError,
        "one at each time",
    ),
    (lambda: megno(TOP, X0, t_end=0), ParameterError, "positive finite time"),
    (lambda: megno(TOP, X0, t_end=1, n_samples=3), ParameterError, "n_samples"),
    (lambda: megno(TOP, X0, t_end=1, n_samples=2**26), ParameterError, "n_samples: wanted at most 4 GiB"),
    (lambda: megno(TOP, X0[:8], t_end=1), ShapeError, "9"),
    (lambda: angles(n_vectors=1), ParameterError, "from 2 to 9"),
    (lambda: angles(within="torus"), ParameterError, 'wanted "space", "leaf" or "energy"'),
    (lambda: angles(within="leaf", n_vectors=7), ParameterError, "has fewer than 7"),
    (lambda: angles(within="energy", n_vectors=6), ParameterError, "has fewer than 6"),
    (lambda: angles().gali(3), ParameterError, "k: wanted a whole number from 2 to 2"),
    (lambda: alignment(LINE, [1.0], t_end=10), ParameterError, "wanted one with at least 2 components"),
    (lambda: decide(LINE, [1.0], t_end=10), ParameterError, "wanted one with at least 2 components"),
    (lambda: decide(TOP, X0[:8], t_end=1), ShapeError, "9"),
    (lambda: decide(TOP, X0, t_end="long"), ParameterError, "t_end"),
    (lambda: decide(TOP, X0, t_end=10, rule=3), ParameterError, "rule: wanted a Rule"),
    (lambda: decide(TOP, X0, t_end=20).fraction("wild"), ParameterError, 'kind: wanted "regular", "chaotic"'),
    (lambda: decide(TOP, np.empty((0, 9)), t_end=10).fraction("chaotic"), ParameterError, "."),
    (lambda: agreement(None), ParameterError, "verdict: wanted what decide returns"),
    (lambda: Rule(least_time=-1), ParameterError, r"rule\.least_time"),
    (lambda: Rule(averages=np.nan), ParameterError, r"rule\.averages"),
    (lambda: Rule(megno=(5, 3)), ParameterError, "rule.megno"),
    (lambda: Rule(sali=(1e-8, 1e-4)), ParameterError, "rule.sali"),
    (lambda: Rule(growth_power=(1,)), ParameterError, "rule.growth_power"),
    (lambda: by_energy(energies=[]), ShapeError, "one or more energies"),
    (lambda: by_energy(lp.Top.kovalevskaya()), ParameterError, "leaf: wanted a leaf of the system"),
    (lambda: by_energy(lp.Top.twisted_lagrange()), ParameterError, "leaf: wanted a leaf of the system"),
    (lambda: by_energy(lp.catalog.system("manakov-so4")), ParameterError, "leaf: wanted a leaf of the system"),
    (lambda: by_energy(leaf=None), ParameterError, "leaf: wanted a Leaf"),
    (lambda: by_energy(rule=0.02), ParameterError, "rule: wanted a Rule"),
    (lambda: by_energy(n_starts=10**12), ParameterError, "n_starts: wanted a whole number from 1 to 10000000"),
    (lambda: proportion(9, 8), ParameterError, "."),
    (lambda: proportion(1, 0), ParameterError, "."),
    (lambda: proportion(1.5, 3), ParameterError, "."),
    (lambda: mean_interval([1.0, 2.0], confidence=2), ParameterError, "confidence"),
    (lambda: Resampling(confidence=0.0), ParameterError, "confidence"),
    (lambda: fit(np.ones((3, 4)), np.ones((3, 4))), ShapeError, "time must have shape"),
    (lambda: fit(TIME, CURVES.T), ShapeError, "Transpose"),
    (lambda: fit(TIME - 1, CURVES), ParameterError, "strictly increasing"),
    (lambda: fit(np.where(TIME == 7, np.nan, TIME), CURVES), ParameterError, "finite"),
    (lambda: fit(TIME, CURVES * np.nan), ParameterError, "4 did not finish"),
    (lambda: fit(TIME, CURVES[:1]), ParameterError, "at least 2 trajectories"),
    (lambda: fit("a", CURVES), LiePoissonError, "must be|wanted"),
    (lambda: fit(TIME, CURVES, window=(10, 2)), ParameterError, "start < end"),
    (lambda: fit(TIME, CURVES, window=(1, 2, 3)), ParameterError, "window"),
    (lambda: fit(TIME, CURVES, window=(2, 40)), ParameterError, "must lie inside the sample times"),
    (lambda: fit(TIME, CURVES, window=(0.5, 20)), ParameterError, "must lie inside the sample times"),
    (lambda: fit(TIME, CURVES, window=(2, 4)), ParameterError, "at least 5 sample times"),
    (lambda: fit(TIME, CURVES, window=(1, 20), confidence=95), ParameterError, "between 0 and 1"),
    (lambda: fit(TIME, CURVES, window=(1, 20), n_bootstrap=1), ParameterError, "n_bootstrap"),
    (lambda: fit(TIME, CURVES, window=(1, 20), seed=-1), ParameterError, "seed"),
    (lambda: EnsembleReduction(TIME, windows=3), LiePoissonError, "must be|wanted"),
    (lambda: window_scan(TIME, CURVES, windows=[]), ParameterError, r"wanted at least one \(start, end\); got none"),
    (lambda: window_grid(np.arange(1.0, 5.0)), ParameterError, "no window"),
    (lambda: mean_curve(TIME, CURVES).at(2000.0), ParameterError, "time must lie in"),
    (lambda: lp.fits.log_fit(STEEP, np.ones((3, 30)) / STEEP), ParameterError, "another unit of time"),
    (
        lambda: fit_goodness(TIME, np.sin(TIME) * np.ones((100, 1))),
        ParameterError,
        "trajectories that differ from each other",
    ),
    (
        lambda: fit_goodness(TIME, np.random.default_rng(0).normal(size=(30, 20))),
        ParameterError,
        "at least 60 trajectories",
    ),
]


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_what_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_the_ends_of_a_window_may_be_rounded():
    assert fit(TIME, CURVES, window=(1, 20 * (1 + 1e-12))).n_times == 20


def test_a_repr_gives_the_median_of_those_that_finished_and_counts_the_failed():
    x0 = lp.sample_states(TOP, 3, seed=1)
    x0[1] = np.nan
    growth = lp.finite_time_exponents(TOP, x0, t_end=5)
    value = np.median(growth.exponent[[0, 2], -1])
    trajectories = f"<FiniteTimeExponents of {TOP.name}: 3 trajectories (1 failed)"
    assert repr(growth) == f"{trajectories}, median exponent {value:.4g} at t = 5>"
    with np.errstate(all="raise"):  # also where nothing finished
        for kind in (lp.finite_time_exponents, lp.lyapunov_spectrum, megno, alignment):
            assert "(3 failed)" in repr(kind(TOP, x0, t_end=100, method=lp.Taylor(max_steps=1)))
