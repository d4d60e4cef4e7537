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


def test_the_figure_says_what_it_shows():
    result = lyapunov_spectrum(TOP, lp.sample_states(TOP, 2, seed=1), t_end=100)
    figure = draw(result, trajectory=1)
    assert figure.axes[0].get_title(loc="left").split("\n")[-1] == "trajectory 1, one of 2"
    (legend,) = figure.legends
    said = [text.get_text() for text in legend.get_texts()]
    assert said[:3] == [
        r"$\lambda_{1}$, $\lambda_{9}$",
        r"$\lambda_{2}$, $\lambda_{8}$",
        r"$\lambda_{3}$ to $\lambda_{7}$",
    ]
    assert any("consistent with zero" in words for words in said)
    assert any("mirror images" in words for words in said)
    part = draw(lyapunov_spectrum(TOP, lp.sample_states(TOP, 1, seed=1), t_end=100, n_exponents=2))
    assert "trajectory" not in part.axes[0].get_title(loc="left")
    said = [text.get_text() for text in part.legends[0].get_texts()]
    assert said[:2] == [r"$\lambda_{1}$", r"$\lambda_{2}$"], "the first two of nine are no partners"
    assert not any("mirror" in words for words in said)


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
