"""Methods as data: their ranges."""

import dataclasses
import json
from typing import Literal, get_args, get_origin, get_type_hints

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.numeric.methods import CHOICES, METHODS, method_of, method_record


def example(kind):
    """A method of this kind, with options that it must be given."""
    needed = {field.name for field in dataclasses.fields(kind) if field.default is dataclasses.MISSING}
    return kind(**{"step": 0.125} if needed else {})


EXAMPLES = [
    *map(example, METHODS.values()),
    lp.Taylor(tol=1e-9, order=12, precision="mixed", max_steps=77),
    lp.RungeKutta(tol=1e-5, precision="single"),
    lp.RungeKutta(step=0.25, compensated=True),
    lp.Splitting(step=0.5, order=8),
    lp.Splitting(step=0.5, precision="single"),
    lp.Gauss(step=0.125, order=2),
]


def another(kind, name):
    """A value of an option other than its default, by its type: of words the last."""
    given = get_type_hints(kind)[name]
    values = {float: 0.05, int: 6, bool: True}
    return get_args(given)[-1] if get_origin(given) is Literal else values[(get_args(given) or (given,))[0]]


def tops_for(method):
    """Tops to which the method applies."""
    if method.name == "lagrange-map":
        return [lp.Top.twisted_lagrange()]
    general = lp.Top.twisted(inertia=(1.3, 0.9, 2.1), a=(0.4, -0.9, 0.3), b=(-0.2, 0.5, 0.8), epsilon=0.7)
    return [lp.Top.twisted_kovalevskaya(), general]


def test_methods_have_their_names():
    assert all(name == kind.name for name, kind in CHOICES.items())
    assert {name for name in dir(lp.methods) if isinstance(getattr(lp.methods, name), type)} == {
        kind.__name__ for kind in CHOICES.values()
    }


@pytest.mark.parametrize(
    ("name", "option"), [(name, field.name) for name, kind in METHODS.items() for field in dataclasses.fields(kind)]
)
def test_a_record_of_a_method_has_all_its_options(name, option):
    kind = METHODS[name]
    needed = {field.name for field in dataclasses.fields(kind) if field.default is dataclasses.MISSING}
    given = {name: another(kind, name) for name in needed | {option}}
    method = kind(**given)
    record = json.loads(json.dumps(method_record(method)))
    assert record["name"] == name
    assert given.items() <= record.items()
    assert method_of(record) == method


@pytest.mark.parametrize("method", EXAMPLES, ids=str)
def test_every_method_survives_its_record_and_follows_the_same_orbit(method):
    assert method_of(json.loads(json.dumps(method_record(method)))) == method
    top = tops_for(method)[0]
    x0 = lp.sample_states(top, 3, seed=5)
    exact = lp.integrate(top, x0, times=[0, 0.7, 2]).state
    orbit = lp.integrate(top, x0, times=[0, 0.7, 2], method=method, tangents=[[1.0, *[0.0] * 8]])
    assert (orbit.outcome == "finished").all()
    # coarse steps on purpose: this finds wrong equations and wrong times, not small errors
    assert np.abs(orbit.state - exact).max() < (1e-3 if hasattr(method, "tol") else 2e-2)


@pytest.mark.parametrize(
    "method",
    [
        *(kind(step=0.2) for kind in METHODS.values() if "step" in get_type_hints(kind)),
        *(kind(step=0.2, order=order) for kind in (lp.Splitting, lp.Gauss) for order in (2, 6, 8)),
    ],
    ids=str,
)
def test_the_error_of_equal_steps_falls_by_their_order(method):
    """From a step to half of it: by the power of two that the run names, for the state and a tangent vector."""
    for top in tops_for(method):
        run = {"starts": lp.sample_states(top, 3, seed=5), "times": [0, 3.2], "tangents": np.eye(9)[:1]}
        exact = lp.integrate(top, **run)
        first, second = (lp.integrate(top, method=dataclasses.replace(method, step=step), **run) for step in (0.2, 0.1))
        for name in ("state", "tangent"):
            before, after = (np.abs(getattr(one, name) - getattr(exact, name)).max() for one in (first, second))
            assert after > 1e-12, "round-off"
            assert np.log2(before / after) == pytest.approx(first.order, abs=0.1)  # 0.08 was seen


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
