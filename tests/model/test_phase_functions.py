"""Functions on phase space as functions of arrays."""

import numpy as np
import pytest
from flint import arb

import liepoisson as lp
from liepoisson.algebra.ideals.certified_roots import precision


def test_balls_have_the_values_of_doubles_and_slopes_beyond_their_range():
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), "p^2/2 + tanh(q^3)/3 + sqrt(q)*cos(pi*p) - log(q)")
    function, state = system.functions.energy, np.array([1.3, 0.7])
    with precision(300):
        point = [arb(x) for x in state.tolist()]
        assert float(function.value_in_balls(point)) == pytest.approx(float(function(state)), rel=1e-14)
        slopes = [float(slope) for slope in function.gradient_in_balls(point)]
        assert slopes == pytest.approx(function.gradient(state).tolist(), rel=1e-13)
        assert not function.value_in_balls([arb(-1), arb(0)]).is_finite()
        tail = lp.System(lp.canonical(names=("q",), momenta=("p",)), "p + tanh(q^3)").functions.energy
        slope, _ = tail.gradient_in_balls([arb(100), arb(0)])
        assert slope > 0  # 3e4/cosh(1e6)^2
        assert abs(slope.log() + 2e6 - np.log(12e4)) < 1e-9
