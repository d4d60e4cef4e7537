"""Methods as data: their ranges."""

import dataclasses
import json

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.numeric.methods import METHODS, method_of, method_record, precisions


@pytest.mark.parametrize("tol", [0.0, -1.0, 1e-17, 0.5, float("nan")])
def test_tolerance_out_of_range_is_refused(tol):
    with pytest.raises(ParameterError, match="tol: wanted a number from"):
        lp.Taylor(tol=tol)


@pytest.mark.parametrize("order", [1, 65, -3])
def test_order_out_of_range_is_refused(order):
    with pytest.raises(ParameterError, match="order: wanted a whole number"):
        lp.Taylor(order=order)


def test_a_budget_of_no_steps_is_refused():
    with pytest.raises(ParameterError, match="max_steps"):
        lp.Taylor(max_steps=0)


def test_a_given_order_is_used():
    assert lp.integrate(lp.Top.kovalevskaya(), [0.1] * 9, times=[0, 1], method=lp.Taylor(order=31)).order == 31


EXAMPLES = [  # one of each kind at least
    lp.Taylor(),
    lp.Taylor(tol=1e-9, order=12, precision="mixed", max_steps=77),
    lp.RungeKutta(),
    lp.RungeKutta(tol=1e-5, precision="single"),
    lp.RungeKutta(step=0.25, compensated=True),
    lp.Splitting(step=0.5, order=8),
    lp.Splitting(step=0.5, precision="single"),
    lp.Gauss(step=0.125, order=2),
    lp.methods.LagrangeMap(step=0.125),
]
VALUES = {"tol": 3e-9, "step": 0.3, "order": 6, "compensated": True, "max_steps": 7}
"""Of options, other than their defaults; of a precision it is the last."""


def top_for(method):
    """A top to which the method applies."""
    is_map = isinstance(method, lp.methods.LagrangeMap)
    return lp.Top.twisted_lagrange() if is_map else lp.Top.twisted_kovalevskaya()


def test_all_methods_are_tried_here():
    assert {type(method) for method in EXAMPLES} == set(METHODS.values())
    assert all(name == kind.name for name, kind in METHODS.items())
    assert {name for name in dir(lp.methods) if isinstance(getattr(lp.methods, name), type)} == {
        kind.__name__ for kind in METHODS.values()
    }


@pytest.mark.parametrize(
    ("name", "option"), [(name, field.name) for name, kind in METHODS.items() for field in dataclasses.fields(kind)]
)
def test_a_record_of_a_method_has_all_its_options(name, option):
    kind = METHODS[name]
    values = VALUES | {"precision": precisions(kind)[-1]}
    needed = {field.name for field in dataclasses.fields(kind) if field.default is dataclasses.MISSING}
    given = {name: values[name] for name in needed | {option}}
    method = kind(**given)
    record = json.loads(json.dumps(method_record(method)))
    assert record["name"] == name
    assert given.items() <= record.items()
    assert method_of(record) == method


@pytest.mark.parametrize("method", EXAMPLES, ids=str)
def test_a_method_survives_its_record(method):
    assert method_of(json.loads(json.dumps(method_record(method)))) == method


@pytest.mark.parametrize("method", EXAMPLES, ids=str)
def test_every_method_follows_the_same_orbit(method):
    top = top_for(method)
    x0 = lp.sample_states(top, 3, seed=5)
    exact = lp.integrate(top, x0, times=[0, 0.7, 2]).state
    orbit = lp.integrate(top, x0, times=[0, 0.7, 2], method=method, tangents=[[1.0, *[0.0] * 8]])
    assert (orbit.outcome == "finished").all()
    # coarse steps on purpose: this finds wrong equations and wrong times, not small errors
    assert np.abs(orbit.state - exact).max() < (1e-3 if hasattr(method, "tol") else 2e-2)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: lp.RungeKutta(tol=1e-8, step=0.1), "got both"),
        (lambda: lp.RungeKutta(tol=9e-7, precision="single"), "from 9.6e-7"),
        (lambda: lp.RungeKutta(precision="mixed"), 'wanted "double" or "single"'),
        (lambda: lp.Taylor(precision="single"), 'wanted "double" or "mixed"'),
        (lambda: lp.Splitting(step=0), "step: wanted a positive number"),
        (lambda: lp.Splitting(step=float("nan")), "step: wanted a positive number"),
        (lambda: lp.Splitting(step=0.1, order=5), "order: wanted 2, 4, 6 or 8"),
        (lambda: lp.Gauss(step="a"), "step: wanted a positive number"),
        (lambda: lp.RungeKutta(compensated=True, precision="single"), "compensated"),
    ],
)
def test_parameters_out_of_range_are_refused(make, message):
    with pytest.raises(ParameterError, match=message):
        make()


def test_methods_that_do_not_apply_say_what_does():
    manakov = lp.catalog.system("manakov-so4")
    x0 = lp.sample_states(manakov, 2, seed=1)
    with pytest.raises(ParameterError, match="which is for tops"):
        lp.integrate(manakov, x0, times=[0, 1], method=lp.Taylor(tol=1e-8, precision="mixed"))
    with pytest.raises(ParameterError, match="give the system that the field is from, or try Taylor"):
        lp.integrate(manakov.field(), x0, times=[0, 1], method=lp.Splitting(step=0.1))
    with pytest.raises(ParameterError, match="wanted Splitting for a field given by its pieces"):
        lp.integrate(manakov.pieces(), x0, times=[0, 1], method=lp.Taylor())
    with pytest.raises(ParameterError, match="wanted the Taylor method, which has power series"):
        lp.integrate(manakov, x0, times=[0, 1], method=lp.RungeKutta(), dense=True)


def test_splitting_of_any_polynomial_hamiltonian_keeps_casimirs():
    manakov = lp.catalog.system("manakov-so4")
    x0 = lp.sample_states(manakov, 4, seed=1)
    orbit = lp.integrate(manakov, x0, times=[0, 50], method=lp.Splitting(step=0.05, order=4))
    exact = lp.integrate(manakov, x0, times=[0, 50])
    assert orbit.field == manakov.pieces()
    assert np.abs(orbit.state - exact.state).max() < 1e-3
    for name, values in manakov.invariant_values(orbit.state).items():
        if name.startswith("C"):
            # 1000 steps with 40 to 80 flows each, a few units of round-off a flow
            assert np.abs(values[:, 1] - values[:, 0]).max() < 1e-11, name


@pytest.mark.thorough
def test_a_run_with_any_method_can_be_repeated_from_its_file(tmp_path):
    for k, method in enumerate(EXAMPLES):
        top = top_for(method)
        x0 = lp.sample_states(top, 3, seed=5)
        growth = lp.finite_time_exponents(top, x0, times=[1, 2], method=method)
        again = lp.rerun(growth.save(tmp_path / f"{k}.nc"))
        assert again.method == method
        assert again.exponent.tobytes() == growth.exponent.tobytes()


@pytest.mark.parametrize("top", [lp.Top.kovalevskaya(), lp.Top.twisted_lagrange()], ids=["Kovalevskaya", "Lagrange"])
@pytest.mark.parametrize("tol", [1e-8, 1e-9])
def test_tangent_vectors_of_regular_orbits_do_not_grow_exponentially_in_mixed_precision(top, tol):
    """On tori they grow as t.  What each step leaves out adds up: cut at sqrt(tol), logarithms were off by 1 to 70."""
    starts, times = lp.sample_states(top, 16, seed=4), [2000.0]
    exact, mixed = (
        lp.finite_time_exponents(top, starts, times=times, seed=4, method=method).exponent[:, -1] * times[0]
        for method in (lp.Taylor(), lp.Taylor(tol=tol, precision="mixed"))
    )
    assert np.median(np.abs(mixed - exact)) < 0.03
    assert np.abs(mixed - exact).max() < 0.3
