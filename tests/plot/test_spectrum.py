"""The figure of a spectrum: what it draws, what it refuses."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.indicators.spectrum import lyapunov_spectrum
from liepoisson.plot.indicators import spectrum as draw

TOP = lp.Top.twisted_kovalevskaya()


def test_curves_and_points_are_those_of_the_trajectory():
    result = lyapunov_spectrum(TOP, lp.sample_states(TOP, 2, seed=1), t_end=100)
    left, right = draw(result, trajectory=1).axes
    curves = [line.get_ydata() for line in left.lines if len(line.get_ydata()) == len(result.time)]
    assert np.array_equal(np.transpose(curves), result.exponent[1])
    mirrored = next(line for line in right.lines if line.get_markerfacecolor() == "none")
    assert np.array_equal(mirrored.get_ydata(), -result.end_exponent[1, ::-1])
    assert left.get_xlabel() == "$t$"
    assert right.get_xlabel() == "$k$"


def test_a_trajectory_without_values_is_refused():
    result = lyapunov_spectrum(TOP, np.array([np.ones(9), np.full(9, 1e200)]), t_end=20)
    draw(result, enlarged=False)
    with pytest.raises(ParameterError, match="ended with 'not finite'"):
        draw(result, trajectory=1)
    with pytest.raises(ParameterError, match="result: wanted what lyapunov_spectrum returns"):
        draw(3)
    with pytest.raises(ParameterError, match="a number from 0 to 1"):
        draw(result, trajectory="x")
    with pytest.raises(ParameterError, match="a number from 0 to 1"):
        draw(result, trajectory=2)
