r"""A name such as C1 is one function of the state, whatever function, command or file is asked for its value."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.cli.options import Where
from liepoisson.cli.starts import find_start
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
@settings(deadline=None, max_examples=10, derandomize=True)
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
    check(find_start(top, Where(start=given[0], leaf=given[1])).leaf.casimirs.values())
    energy = float(top.functions.energy(x))
    by_state, by_values = lp.phase_space.bounds(top, x), lp.phase_space.bounds(top, leaf=values, energy=energy)
    for name in ("l", "alpha", "beta", "omega"):
        assert getattr(by_values, name) == pytest.approx(getattr(by_state, name), rel=1e-6)
