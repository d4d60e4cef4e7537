"""What a caller may get wrong, what must come out as a plain number, and results in one line."""

import json

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LiePoissonError, ParameterError, ShapeError, UnknownNameError
from liepoisson.indicators.finite_time_fit import EnsembleReduction, Resampling

TOP = lp.Top.twisted_kovalevskaya()
X0 = [0.1] * 9
TIME = np.arange(1.0, 21.0)
CURVES = np.random.default_rng(0).normal(size=(4, 20))


def exponent(x0=X0, system=TOP, **options):
    if "times" not in options:
        options.setdefault("t_end", 1)
    return lp.finite_time_exponents(system, x0, **options)


# The integer of 5000 digits has no repr.
BAD_NUMBERS = ["abc", "5 s", [1, 2], 10**400, 10**5000, True, 1j, np.complex128(1), np.datetime64(1, "s"), object()]


@pytest.mark.parametrize("t_end", BAD_NUMBERS, ids=range(len(BAD_NUMBERS)))
def test_a_last_time_is_one_number(t_end):
    with pytest.raises(ParameterError, match=r"t_end: wanted a positive finite time; got .{1,80}; give"):
        exponent(t_end=t_end)


@pytest.mark.parametrize("bad", ["a", None, 1.5, -1, True, np.float64(2)])
@pytest.mark.parametrize("name", ["seed", "first"])
def test_seed_and_first_are_whole_numbers(name, bad):
    with pytest.raises(ParameterError, match=f"{name}: wanted a whole number"):
        exponent(**{name: bad})
    with pytest.raises(ParameterError, match=f"{name}: wanted a whole number"):
        lp.sample_states(TOP, 2, **{"seed": 1, name: bad})


@pytest.mark.thorough
def test_seed_and_first_are_bounded():
    with pytest.raises(ParameterError, match="first: wanted"):
        exponent(first=2**63 - 1)
    with pytest.raises(ParameterError, match="seed: wanted"):
        exponent(seed=2**128)
    assert exponent(first=2**63 - 2).dataset.trajectory.to_numpy()[0] == 2**63 - 2


@pytest.mark.parametrize("bad", [2.0, "2", None, -1])
def test_a_number_of_states_is_whole(bad):
    with pytest.raises(ParameterError, match="n_starts: wanted a whole number"):
        lp.sample_states(TOP, bad, seed=1)


@pytest.mark.parametrize("bad", [["cube"], None, {}, "balls"])
def test_an_ensemble_is_a_name(bad):
    with pytest.raises((ParameterError, UnknownNameError), match=r"ensemble: wanted (one of|a text)"):
        lp.sample_states(TOP, 1, seed=1, ensemble=bad)


@pytest.mark.parametrize("bad", ["4", float("nan"), 2**80, 1.5, 0, True])
def test_threads_are_a_whole_number(bad):
    with pytest.raises(ParameterError, match="threads: wanted a whole number"):
        exponent(threads=bad)


@pytest.mark.parametrize("bad", ["taylor", 5, lp.Taylor, 0, ""])
def test_a_method_is_a_method_object(bad):
    with pytest.raises(ParameterError, match="method: wanted a method object"):
        exponent(method=bad)
    with pytest.raises(ParameterError, match="method: wanted a method object"):
        lp.integrate(TOP, X0, times=[0, 1], method=bad)


@pytest.mark.parametrize("bad", [None, lp.Top, 5, "top"])
def test_a_system_is_an_object_with_a_field(bad):
    for call in (
        lambda: exponent(system=bad),
        lambda: lp.integrate(bad, X0, times=[0, 1]),
        lambda: lp.sample_states(bad, 1, seed=1),
    ):
        with pytest.raises(ParameterError, match="system: wanted a system"):
            call()


MEANINGLESS = [
    np.array(X0) + 0j,
    np.zeros(9, "m8[s]"),
    np.zeros(9, "M8[s]"),
    np.ma.masked_array(X0, mask=[True] + [False] * 8),
]


@pytest.mark.parametrize("bad", MEANINGLESS, ids=["complex", "timedelta", "datetime", "masked"])
def test_arrays_that_would_lose_their_meaning_are_refused(bad):
    for call in (
        lambda: exponent(bad),
        lambda: exponent(tangents=bad),
        lambda: exponent(times=bad),
        lambda: lp.integrate(TOP, bad, times=[0, 1]),
        lambda: lp.integrate(TOP, X0, times=bad),
        lambda: lp.integrate(TOP, X0, times=[0, 1], tangents=[bad] if bad.dtype.kind != "f" else bad[np.newaxis]),
        lambda: TOP.vector_field(bad),
    ):
        with pytest.raises(ParameterError, match=r"real numbers; got (a masked array|an array of)"):
            call()


def test_exact_numbers_may_be_written_as_texts():
    exact, inexact = (
        ["1/3", 0, "sqrt(2)/2", 0, 0, 1, "1e-1", "-pi", 2.5],
        [1 / 3, 0, 2**0.5 / 2, 0, 0, 1, 0.1, -np.pi, 2.5],
    )
    assert (
        lp.integrate(TOP, exact, times=[0, "1/2"]).state.tolist()
        == lp.integrate(TOP, inexact, times=[0, 0.5]).state.tolist()
    )
    assert exponent(t_end="7/2").time[-1] == 3.5
    assert lp.Taylor(tol="1e-9").tol == 1e-9
    with pytest.raises(ShapeError, match=r"starts: wanted an array of numbers; sqrt: .*needs its arguments"):
        lp.integrate(TOP, ["sqrt", *exact[1:]], times=[0, 1])


def test_arrays_of_something_else_are_refused():
    for x0 in ([[10**400] * 9], ["x"] * 9, np.array(["1"] * 9), "a", object()):
        with pytest.raises(ShapeError, match="starts: wanted an array of numbers"):
            exponent(x0)
        with pytest.raises(ShapeError, match="states: wanted an array of numbers"):
            TOP.vector_field(x0)
    with pytest.raises(ShapeError, match="tangents: wanted an array of numbers"):
        lp.integrate(TOP, X0, times=[0, 1], tangents="a")
    with pytest.raises(ShapeError, match="times: wanted an array of numbers"):
        lp.integrate(TOP, X0, times=[0, 1], dense=True).at("a")


def test_there_is_one_tangent_vector_for_all_or_for_each():
    with pytest.raises(ShapeError, match=r"tangents must have shape \(9,\) or \(4, 9\).*got shape \(3, 9\)"):
        exponent([X0] * 4, tangents=np.eye(9)[:3])


@pytest.mark.parametrize("window", [3, ("1", "x"), (1, 2, 3), "ab", (5, 1), (1, float("inf"))])
def test_a_window_is_two_numbers(window):
    with pytest.raises(ParameterError, match=r"window"):
        lp.fits.finite_time_fit(TIME, CURVES, window=window)


@pytest.mark.parametrize(
    "options",
    [{"n_bootstrap": 2.5}, {"n_bootstrap": 1}, {"confidence": "a"}, {"confidence": 1}, {"seed": -1}, {"seed": "a"}],
)
def test_resampling_is_checked(options):
    (name,) = options
    with pytest.raises(ParameterError, match=name):
        lp.fits.finite_time_fit(TIME, CURVES, window=(1, 20), **options)


def test_fits_refuse_what_is_not_a_curve():
    for call in (
        lambda: lp.fits.finite_time_fit("a", CURVES),
        lambda: lp.fits.finite_time_fit(TIME, "a", window=(1, 20)),
        lambda: EnsembleReduction(TIME, windows=3),
    ):
        with pytest.raises(LiePoissonError, match=r"must be|wanted"):
            call()


@pytest.mark.thorough
def test_numbers_of_numpy_become_plain_ones_and_can_be_saved(tmp_path):
    method = lp.Taylor(tol=np.float32(1e-10), order=np.int64(20), max_steps=np.int32(1000))
    assert [type(v) for v in (method.tol, method.order, method.max_steps)] == [float, int, int]
    growth = exponent(seed=np.int64(5), first=np.int64(3), method=method)
    assert (type(growth.seed), type(growth.first)) == (int, int)
    attributes = lp.load(growth.save(tmp_path / "growth.nc")).dataset.attrs
    run = json.loads(attributes["run"])
    assert [run[name] for name in ("seed", "first", "time_limit")] == [5, 3, 3600.0]
    assert json.loads(attributes["method"])["order"] == 20
    resampling = Resampling(np.int64(10), np.float32(0.5), np.int64(1))
    values = (resampling.n_bootstrap, resampling.confidence, resampling.seed)
    assert [type(v) for v in values] == [int, float, int]


@pytest.mark.parametrize(
    ("name", "bad"),
    [("tol", "a"), ("tol", None), ("order", 2.5), ("order", "a")]
    + [("max_steps", bad) for bad in (2**70, float("nan"), None, 1.5)],
)
def test_a_method_has_numbers_of_the_right_kind(name, bad):
    with pytest.raises(ParameterError, match=f"{name}: wanted"):
        lp.Taylor(**{name: bad})


def results(x0):
    """One result of each kind that holds arrays; those of ensembles with as many members as starts."""
    leaf, growth = lp.Leaf.through(TOP, X0), lp.finite_time_exponents(TOP, x0, times=[1, 2, 3])
    return {
        "Orbit": lp.integrate(TOP, x0, times=[0, 1, 2]),
        "FiniteTimeExponents": growth,
        "MeanCurve": lp.results.MeanCurve(*[TIME] * 5, confidence=0.95, n_members=4, n_excluded=1),
        "Spectrum": lp.lyapunov_spectrum(TOP, x0, t_end=10),
        "Megno": lp.chaos.megno(TOP, x0, t_end=2),
        "Alignment": lp.chaos.alignment(TOP, x0, t_end=2),
        "FrequencyDrift": lp.chaos.frequency_drift(TOP, x0, observable="l1", t_end=10, n_samples=16),
        "Verdict": lp.decide(TOP, x0, t_end=2),
        "FirstReturn": lp.sections.first_return(TOP, x0, surface="l3", t_end=5),
        "EnergyProfile": lp.chaos.exponents_by_energy(TOP, leaf=leaf, energies=[1, 2], n_starts=2, t_end=1),
    }


@pytest.mark.thorough
@pytest.mark.parametrize("n", [1, 3])
def test_the_repr_of_a_result_is_one_short_line_with_its_system(n):
    for kind, result in results(lp.sample_states(TOP, n, seed=1)).items():
        text = repr(result)
        of = "" if kind in ("FirstReturn", "MeanCurve") else f" of {TOP.name}"
        assert text.startswith(f"<{kind}{of}: ")
        assert text.endswith(">")
        assert "\n" not in text
        assert len(text) < 200, text
        assert "nan" not in text, text


def test_a_repr_gives_the_median_of_those_that_finished_and_counts_the_failed():
    x0 = lp.sample_states(TOP, 3, seed=1)
    x0[1] = np.nan
    growth = lp.finite_time_exponents(TOP, x0, t_end=5)
    value = np.median(growth.exponent[[0, 2], -1])
    assert (
        repr(growth)
        == f"<FiniteTimeExponents of {TOP.name}: 3 trajectories (1 failed), median exponent {value:.4g} at t = 5>"
    )
    orbit = lp.integrate(TOP, x0[0], times=np.linspace(0, 2, 5), tangents=np.eye(9)[:2])
    assert repr(orbit) == f"<Orbit of {TOP.name}: 1 trajectory, 5 times, t = 0 to 2, 2 tangent vectors each>"
    nowhere = lp.sections.first_return(TOP, x0, surface="l3 - 100", t_end=1)
    assert repr(nowhere) == "<FirstReturn: 0 of 3 states returned, no time>"


def test_a_repr_holds_where_nothing_finished():
    x0 = lp.sample_states(TOP, 2, seed=1)
    with np.errstate(all="raise"):
        for result in (
            lp.finite_time_exponents(TOP, x0, t_end=100, method=lp.Taylor(max_steps=1)),
            lp.lyapunov_spectrum(TOP, x0, t_end=100, method=lp.Taylor(max_steps=1)),
            lp.chaos.megno(TOP, x0, t_end=100, method=lp.Taylor(max_steps=1)),
            lp.chaos.alignment(TOP, x0, t_end=100, method=lp.Taylor(max_steps=1)),
        ):
            assert "2 trajectories (2 failed), " in repr(result) or "of 2 trajectories (2 failed)" in repr(result)


def test_masked_arrays_without_masked_entries_are_arrays():
    x = np.array(X0)
    for given in (np.ma.array(x), np.ma.array(x, mask=np.zeros(9, bool)), [np.ma.array(x), np.ma.array(x)]):
        np.testing.assert_array_equal(lp.integrate(TOP, given, times=[0, 1]).state[:, 0], np.atleast_2d(given))
