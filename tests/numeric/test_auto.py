"""The method that is chosen by counted operations: what is chosen runs, and results, files and reruns name it."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError

PENDULUM = lp.System(
    lp.canonical(names=["theta1", "theta2"]),
    "(p_theta1^2 + 2*p_theta2^2 - 2*p_theta1*p_theta2*cos(theta1 - theta2))/(2*(1 + sin(theta1 - theta2)^2))"
    " - 2*cos(theta1) - cos(theta2)",
)
SYSTEMS = {
    "tape": (PENDULUM, [0.4, -0.2, 0.3, 0.5]),
    "quadratic": (lp.catalog.system("manakov-so4"), [1.0, 0.5, -0.3, 0.2, 0.7, -0.4]),
    "top": (lp.Top.twisted_kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1, "beta1": 1}),
}
LOOSE, TIGHT = 1e-4, 1e-13
of_every_kind = pytest.mark.parametrize("kind", SYSTEMS)


def chosen(kind, tol):
    system, start = SYSTEMS[kind]
    return lp.integrate(system, start, times=[0, 1], method=lp.Auto(tol=tol)).method


@of_every_kind
def test_loose_tolerances_take_runge_kutta_and_tight_ones_series(kind):
    methods = [chosen(kind, 10.0**-k) for k in range(2, 16)]
    assert [method.tol for method in methods] == [10.0**-k for k in range(2, 16)]
    names = [method.name for method in methods]
    n_loose = names.count("runge-kutta")
    assert names == ["runge-kutta"] * n_loose + ["taylor"] * (len(names) - n_loose)
    assert chosen(kind, LOOSE) == lp.RungeKutta(tol=LOOSE)
    assert chosen(kind, TIGHT) == lp.Taylor(tol=TIGHT)


@of_every_kind
@pytest.mark.parametrize("tol", [LOOSE, TIGHT])
def test_what_is_chosen_is_what_runs_and_what_a_file_says(kind, tol, tmp_path):
    system, start = SYSTEMS[kind]
    run = lp.integrate(system, start, t_end=5, method=lp.Auto(tol=tol, max_steps=10_000))
    plain = lp.integrate(system, start, t_end=5, method=run.method)
    assert type(run.method) in (lp.Taylor, lp.RungeKutta)
    assert run.method.max_steps == 10_000
    file = run.save(tmp_path / "orbit.nc")
    for other in (plain, lp.load(file), lp.rerun(file), lp.rerun(run)):
        assert other.method == run.method
        np.testing.assert_array_equal(other.state, run.state)


def test_the_text_has_the_tolerance_of_the_default_method():
    system, start = SYSTEMS["tape"]
    assert lp.integrate(system, start, times=[0, 1], method="auto").method == lp.Taylor()
    assert lp.finite_time_exponents(system, start, t_end=1, method="auto").method == lp.Taylor(tol=1e-13)


@pytest.mark.parametrize(
    "made",
    [
        lp.finite_time_exponents,
        lp.chaos.megno,
        lp.chaos.alignment,
        lp.lyapunov_spectrum,
        lp.decide,
        lp.lyapunov_exponent,
    ],
    ids=lambda function: function.__name__,
)
def test_every_run_chooses_for_its_system(made):
    system, start = SYSTEMS["tape"]
    assert made(system, start, t_end=20, method=lp.Auto(tol=LOOSE)).method == lp.RungeKutta(tol=LOOSE)


def test_where_series_are_needed_there_is_no_choice():
    system, start = SYSTEMS["tape"]
    auto, series = lp.Auto(tol=LOOSE), lp.Taylor(tol=LOOSE)
    assert lp.integrate(system, start, times=[0, 1], dense=True, method=auto).method == series
    assert lp.section(system, start, surface="theta1", t_end=20, method=auto).method == series
    assert lp.sections.first_return(system, start, surface="theta1", t_end=20, method=auto).method == series
    assert lp.sections.return_map(system, "theta1", t_end=20, method=auto).method == series


CUBIC = {
    "bracket": {"algebra": "so(3)"},
    "parameters": {"u": 1},
    "hamiltonian": {"expression": "dot(l, l)/2 + u*l1^3 + l2^2/4"},
}


def test_a_sweep_chooses_once_and_keeps_what_it_chose(tmp_path):
    given = {"system": CUBIC, "axes": {"u": [-1.0, 0.5, 1.0]}, "n_starts": 2, "t_end": 5.0}
    for tol, method in ((LOOSE, lp.RungeKutta(tol=LOOSE)), (TIGHT, lp.Taylor(tol=TIGHT))):
        sweep = lp.sweep(**given, method=lp.Auto(tol=tol), store=tmp_path / f"{tol}.zarr")
        assert (sweep.spec.method, sweep.method) == (method, str(method))
        assert lp.sweep(**given, method=lp.Auto(tol=tol), store=tmp_path / f"{tol}.zarr").n_reused == 3
        again = lp.sweep(**given, method=method)
        np.testing.assert_array_equal(again.value, sweep.value)
        assert lp.load(tmp_path / f"{tol}.zarr").spec.method == method
        np.testing.assert_array_equal(lp.rerun(tmp_path / f"{tol}.zarr").value, sweep.value)


def test_a_sweep_of_tops_has_series_whose_orbits_share_registers():
    sweep = lp.sweep(
        system=lp.Top.kovalevskaya, axes={"epsilon": [0.0, 0.5]}, n_starts=2, t_end=5.0, method=lp.Auto(tol=LOOSE)
    )
    assert sweep.spec.method == lp.Taylor(tol=LOOSE)


@pytest.mark.parametrize(
    ("options", "name"),
    [({"tol": 0.0}, "tol"), ({"tol": "x"}, "tol"), ({"tol": 1.0}, "tol"), ({"max_steps": 0}, "max_steps")],
)
def test_values_out_of_range_are_refused(options, name):
    with pytest.raises(ParameterError, match=f"{name}: wanted"):
        lp.Auto(**options)


@pytest.mark.parametrize("wrong", ["Auto", "auto ", lp.Auto, "taylor", 1])
def test_another_text_is_refused_with_the_one_that_is_meant(wrong):
    system, start = SYSTEMS["tape"]
    for run in (lp.integrate, lp.finite_time_exponents):
        with pytest.raises(ParameterError, match=r'method: wanted a method object .* or "auto"'):
            run(system, start, t_end=1, method=wrong)
    with pytest.raises(ParameterError, match="method: wanted a method object"):
        lp.sweep(system=CUBIC, axes={"u": [1.0]}, t_end=5.0, method=wrong)


def test_a_field_of_pieces_has_no_adaptive_method():
    body, start = SYSTEMS["quadratic"]
    with pytest.raises(ParameterError, match="wanted Splitting for a field given by its pieces"):
        lp.integrate(body.pieces(), start, t_end=1, method=lp.Auto(tol=LOOSE))
