"""Figures of indicators: the curves, their labels, the lines of reference."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators.alignment import alignment
from liepoisson.indicators.megno import megno
from liepoisson.plot.indicators import indicators

TOP = lp.Top.twisted_kovalevskaya()


@pytest.fixture(scope="module")
def results():
    x0 = lp.sample_states(TOP, 3, seed=1)
    return megno(TOP, x0, t_end=100), alignment(TOP, x0, t_end=100)


def test_panels_show_growth_megno_and_sali(results):
    growth, angle = results
    axes = indicators(growth, angle)
    for ax, x, curves in zip(
        axes, (growth.time, growth.time, angle.time), (growth.log_growth, growth.mean, angle.sali), strict=True
    ):
        for k in range(3):
            np.testing.assert_array_equal(ax.lines[k].get_xdata(), x)
            np.testing.assert_array_equal(ax.lines[k].get_ydata(), curves[k])
        assert ax.get_xscale() == "log"
        assert ax.get_xlim() == (max(growth.time[0], angle.time[0]), 100)
    scale = "\n(linear to 10, then log)"
    assert [ax.get_ylabel() for ax in axes] == [rf"$\ln|v(t)|${scale}", rf"$\overline{{Y}}(t)${scale}", "SALI"]
    for ax, thresholds in ((axes[1], [3.0, 5.0]), (axes[2], [1e-4, 1e-8])):
        assert [line.get_ydata()[0] for line in ax.lines[4:]] == thresholds
        assert all(line.get_linewidth() == 0.5 for line in ax.lines[4:])
    assert (axes[1].lines[3].get_ydata()[0], axes[2].lines[3].get_ydata()[0]) == (2.0, 1e-16)
    assert axes[0].get_legend() is None


@pytest.mark.thorough
def test_members_labels_and_a_time(results):
    axes = indicators(*results, members=[2, 0], labels=["two", "zero"], decided_at=50)
    np.testing.assert_array_equal(axes[2].lines[0].get_ydata(), results[1].sali[2])
    assert [text.get_text() for text in axes[0].get_legend().get_texts()] == ["two", "zero", r"$\ln(t/t_0)$"]
    assert all(ax.lines[-1].get_xdata()[0] == 50 for ax in axes)
    assert axes[0].lines[0].get_color() == axes[2].lines[0].get_color()
