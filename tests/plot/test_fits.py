"""Fits are drawn with their data, curves and residuals."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError

SPRING = lp.System(lp.canonical(1, names=["q"]), "p_q^2/2 + k*q^2/2", {"k": 1})
T = np.linspace(0, 3, 7)
TABLE = {"t": [*T, *T], "q": [*np.cos(T), *np.sin(T)], "p_q": [*-np.sin(T), *np.cos(T)], "run": ["u"] * 7 + ["v"] * 7}
TABLE["q"][3] = np.nan
FIT = lp.fits.orbit_fit(SPRING, lp.fits.Observations(TABLE, run="run", errors=0.1), ["k", "q"])


def test_a_figure_has_data_curves_and_residuals_of_each_observable_and_run():
    figure = lp.plot.draw(FIT)
    assert [axes.get_ylabel() for axes in figure.axes] == ["$q$", "$p_{q}$", *[r"residual / $\sigma$"] * 2]
    above = figure.axes[0]
    first, second = (bars.lines[0].get_xydata() for bars in above.containers)
    np.testing.assert_allclose(first, np.stack([T, np.cos(T)], axis=1)[T[3] != T], atol=1e-12)
    np.testing.assert_allclose(second, np.stack([T, np.sin(T)], axis=1), atol=1e-12)
    assert above.get_legend_handles_labels()[1] == ["run u", "run v"]
    assert figure.get_suptitle().startswith("Hamiltonian system\n$k$ = 1.00 ± 0.0")
    assert lp.plot.orbit_fit(FIT, title="").get_suptitle() == ""


def test_what_has_no_trajectory_is_refused():
    falls = lp.VectorField({"x": "k*x^2"}, {"k": 10})
    lost = lp.fits.orbit_fit(falls, {"t": [0.0, 1.5], "x": [1.0, 2.0]}, ["k"], start_time=-1, starts=[1])
    assert lost.ending == "no trajectory"
    with pytest.raises(ParameterError, match="got one that has none"):
        lp.plot.orbit_fit(lost)
    with pytest.raises(ParameterError, match="fit: wanted what orbit_fit returned"):
        lp.plot.orbit_fit(SPRING)
