r"""A name such as C1 is one function of the state, whatever function, command or file is asked for its value."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.cli.starts import find_start
from liepoisson.errors import ParameterError
from liepoisson.model.charts.leaf_constants import LeafConstants
from liepoisson.sweeps.starts import TopRows, system_functions

EPSILONS = st.one_of(
    st.sampled_from([0, 0.5, 0.51, 0.8, 1 / 3, -1 / 3, 0.1 + 0.2, 1, 7.25]),
    st.floats(-2, 2).map(lambda v: round(v, 6)),
)
NUMBERS = st.floats(-2, 2).map(lambda v: round(v, 4))
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)


def top_of(epsilon, a=(0.5, -0.2, 0.9), b=(0.3, 0.4, -0.2)):
    return lp.Top(inertia=(1.5, 1.1, 0.8), a=a, b=b, epsilon=epsilon)


def documented(epsilon, x):
    l, alpha, beta = np.reshape(x, (3, 3))
    return np.array([alpha @ alpha + 2 * float(epsilon) * l @ beta, alpha @ beta, beta @ beta])


@pytest.mark.thorough
@settings(deadline=None, max_examples=25, derandomize=True)
@given(EPSILONS, VECTORS, VECTORS, VECTORS)
def test_all_places_give_the_same_numbers(epsilon, l, alpha, beta):
    alpha, beta = np.add(alpha, (0.5, 3, 0)), np.add(beta, (0, 0, 3))  # beta is not zero, and they are not parallel
    top, x = top_of(epsilon), np.concatenate([l, alpha, beta])
    wanted = documented(epsilon, x)
    size = 1e-12 * (1 + np.abs(x).max()) ** 2 * (1 + abs(epsilon))
    values = {f"C{k}": value for k, value in enumerate(wanted.tolist(), start=1)}

    def check(found):
        np.testing.assert_allclose(np.array([float(v) for v in found]), wanted, rtol=0, atol=size)

    symbolic = lp.Top(inertia=("I1", "I2", "I3"), a=("a1", "a2", "a3"), epsilon="epsilon")
    at = {"epsilon": epsilon, **dict(zip(map(str, top.variables), x, strict=True))}
    check([top.invariants[name].subs(dict(zip(top.variables, x, strict=True))) for name in values])
    check([symbolic.invariants[name].subs(at) for name in values])
    check([top.invariant_values(x)[name] for name in values])
    check([top.functions.casimirs[name](x) for name in values])
    check([lp.Leaf.through(top, x).casimirs[name] for name in values])
    check(lp.Leaf(top, values).casimirs.values())
    check(documented(epsilon, lp.Leaf(top, values).state))
    check(TopRows.of([top.field()], 1).functions(tuple(values))(x[None], np.arange(1))[0][0])
    check(system_functions(top, tuple(values))(x[None], np.arange(1))[0][0])
    check(LeafConstants.of(top, top.top_parameters, None, values).casimirs)
    check(LeafConstants.of(top, top.top_parameters, x).casimirs)
    given = [",".join(map(repr, x.tolist()))], [f"{name}={value!r}" for name, value in values.items()]
    check(find_start(top, start=given[0], leaf=given[1]).leaf.casimirs.values())
    energy = float(top.functions.energy(x))
    by_state, by_values = lp.phase_space.bounds(top, x), lp.phase_space.bounds(top, leaf=values, energy=energy)
    for name in ("l", "alpha", "beta", "omega"):
        assert getattr(by_values, name) == pytest.approx(getattr(by_state, name), rel=1e-6)


@pytest.mark.thorough
@pytest.mark.parametrize("epsilon", [0.8, -1 / 3, 0.1 + 0.2])
def test_states_drawn_or_charted_by_values_have_them(epsilon):
    top = top_of(epsilon)
    values = {"C1": 1.3, "C2": 0.4, "C3": 1.44}
    wanted = np.array([*values.values()])

    def check(states):
        for state in np.reshape(states, (-1, 9)):
            np.testing.assert_allclose(documented(epsilon, state), wanted, rtol=1e-11, atol=1e-11)

    leaf = lp.Leaf(top, values)
    check(leaf.sample(20, seed=1, energy_below=2.0))
    check(leaf.project(np.arange(1.0, 10.0)))
    euler = lp.charts.EulerChart(top, leaf=values)
    check(euler.to_body(np.array([0.3, 0.5, 1.2, -np.sign(epsilon) * 0.5, 0.4, 0.1])))
    constants = lp.charts.QuaternionChart(top, leaf=values).leaf
    np.testing.assert_allclose([float(c) for c in constants.casimirs], wanted, rtol=1e-14)
    for sampling in ("newton", "liouville"):
        starts = {**values, "energy": 2.0} | ({"sampling": "liouville"} if sampling == "liouville" else {})
        seen = []
        lp.sweep(
            system=top_of,
            axes={"epsilon": [epsilon]},
            starts=starts,
            n_starts=4,
            t_end=1.0,
            quantity=lambda system, x0, seen=seen, **_: seen.extend(x0) or np.zeros(len(x0)),
        )
        assert len(seen) == 4
        check(np.array(seen))


@pytest.mark.thorough
@pytest.mark.parametrize("epsilon", [0.8, -1 / 3, 0.51])
def test_bounds_by_values_are_bounds(epsilon):
    top, values, energy = top_of(epsilon), {"C1": 1.3, "C2": 0.4, "C3": 1.44}, 2.0
    l, alpha, beta = np.moveaxis(lp.Leaf(top, values).sample(2000, seed=2, energy=energy).reshape(-1, 3, 3), 1, 0)
    found = lp.phase_space.bounds(top, leaf=values, energy=energy)
    for vectors, bound in ((l, found.l), (alpha, found.alpha), (beta, found.beta), (l / [1.5, 1.1, 0.8], found.omega)):
        assert np.linalg.norm(vectors, axis=-1).max() <= bound


@pytest.mark.parametrize("epsilon", [0.5, 0.8, 1 / 3])
def test_leaves_are_continuous_in_epsilon(epsilon):
    values = {"C1": 1, "C2": 0.2, "C3": 1}
    here, near = (lp.Leaf(top_of(e), values).state for e in (epsilon, epsilon + 1e-9))
    np.testing.assert_allclose(here, near, atol=1e-6)


def test_long_fractions_cost_no_more_than_short_ones():
    """1/3 as a double is 3333333333333333/10^16: the same formulas, with coefficients of the same size."""
    long, short = top_of(1 / 3), top_of("1/3")
    for first, second in zip(long.bracket.casimirs(), short.bracket.casimirs(), strict=True):
        found = [(abs(float(c)), m) for m, c in first.as_coefficients_dict().items()]
        assert [m for _, m in found] == list(second.as_coefficients_dict())
        assert max(c for c, _ in found) <= 1


@pytest.mark.thorough
def test_the_range_of_the_energy_does_not_depend_on_the_digits_of_epsilon():
    """A search by steepest descent: with C1 times 5e15 it stopped early, and gave an unbounded energy a maximum."""
    (low, high), (near, infinite) = (
        lp.Leaf(top_of(epsilon), {"C1": 1, "C2": 0.1, "C3": 1}).energy_range() for epsilon in (1 / 3, 0.3334)
    )
    assert low == pytest.approx(near, abs=2e-3)
    assert high == infinite == np.inf


def test_values_are_refused_for_brackets_that_only_share_the_equations():
    """A free body: any extension with the unit e_0 gives the equations of a top, here with other Casimirs."""
    products = {**{(0, k): {k: 1} for k in range(3)}, (1, 1): {1: 1}}
    bracket = lp.so(3) @ lp.Extension.from_products(3, products, field_names=("l", "alpha", "beta"))
    free = lp.System(bracket, lambda l, alpha, beta: l.dot(l) / 2)
    assert free.top_parameters is not None
    values = {"C1": 1, "C2": 1, "C3": 1}
    with pytest.raises(ParameterError, match=r"but the bracket"):
        lp.phase_space.bounds(free, leaf=values, energy=1.0)
    with pytest.raises(ParameterError, match=r"but the bracket"):
        lp.charts.EulerChart(free, leaf=values)
