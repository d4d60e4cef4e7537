"""Figures: their data, labels and files; pixels are looked at by eye."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import liepoisson as lp
from liepoisson import plot
from liepoisson.errors import OutputError, ShapeError
from liepoisson.indicators.finite_time_fit import finite_time_fit, mean_curve, window_scan
from liepoisson.plot.style import new_figure

TIME = np.geomspace(1, 500, 120)


@pytest.fixture
def growth():
    generator = np.random.default_rng(1)
    exponent = 0.12 + 0.1 * generator.standard_normal((200, 1)) / np.sqrt(TIME) + 0.4 / TIME
    return SimpleNamespace(time=TIME, exponent=exponent)


@pytest.mark.thorough
def test_convergence_shows_the_mean_its_band_and_the_fit(growth):
    fit = finite_time_fit(growth.time, growth.exponent)
    ax = plot.convergence(growth, fit=fit, label="twisted")
    curve = mean_curve(growth.time, growth.exponent)
    np.testing.assert_allclose(ax.lines[0].get_ydata(), curve.mean)
    band, spread = sorted((c.get_paths()[0].vertices for c in ax.collections), key=lambda v: np.ptp(v[:, 1]))
    assert band[:, 1].min() == pytest.approx(curve.low.min())
    assert band[:, 1].max() == pytest.approx(curve.high.max())
    assert spread[:, 1].max() == pytest.approx(np.quantile(growth.exponent, 0.95, axis=0).max())
    solid = ax.lines[1]
    assert (solid.get_xdata()[0], solid.get_xdata()[-1]) == pytest.approx(fit.window)
    np.testing.assert_allclose(solid.get_ydata(), fit.curve(solid.get_xdata()))
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert texts[0] == "twisted"
    assert f"{fit.lambda_:.4f}" in texts[1]
    assert ax.get_xscale() == "log"
    assert ax.get_xlabel() == "$t$"


def test_convergence_refuses_curves_of_the_wrong_shape(growth):
    with pytest.raises(ShapeError, match="Transpose"):
        plot.convergence(SimpleNamespace(time=growth.time, exponent=growth.exponent.T))


def test_distribution_is_a_probability_density():
    values = np.random.default_rng(2).normal(0.12, 0.02, 5000)
    values[7] = np.nan
    ax = plot.exponent_distribution(values, bins=40, label="members")
    x, y = ax.lines[0].get_data()
    assert np.trapezoid(y, x) == pytest.approx(1.0)
    assert np.trapezoid(x * y, x) == pytest.approx(np.nanmean(values), abs=5e-4)
    assert ax.get_legend().get_texts()[0].get_text() == "members"


def test_window_scan_shows_each_fit_with_its_interval(growth):
    fits = window_scan(growth.time, growth.exponent)
    ax = plot.window_scan(fits, reference=0.122)
    shown = np.concatenate([np.asarray(container[0].get_ydata()) for container in ax.containers])
    np.testing.assert_allclose(sorted(shown), sorted(fit.lambda_ for fit in fits))
    bars = np.concatenate([np.array(container[2][0].get_segments()) for container in ax.containers])
    np.testing.assert_allclose(sorted(bars[:, 0, 1]), sorted(fit.intervals["lambda"][0] for fit in fits))
    np.testing.assert_allclose(sorted(bars[:, 1, 1]), sorted(fit.intervals["lambda"][1] for fit in fits))
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert texts == ["as printed", *(f"to $t = {end:g}$" for end in sorted({fit.window[1] for fit in fits}))]


def test_house_style_keeps_the_interactive_mode_that_the_first_figure_of_a_notebook_turns_on(monkeypatch):
    import matplotlib as mpl

    monkeypatch.setitem(mpl.rcParams, "interactive", False)
    with plot.house_style():
        mpl.interactive(True)
    assert mpl.is_interactive()
    with plot.house_style():
        mpl.interactive(False)
    assert not mpl.is_interactive()


@pytest.mark.thorough
def test_a_figure_is_saved_as_three_files_that_do_not_change(growth, tmp_path):
    def save(name):
        with plot.house_style():
            figure = new_figure(4, 3)
            plot.convergence(growth, label="twisted", ax=figure.add_subplot())
        (tmp_path / name).mkdir()
        return plot.save_figure(figure, tmp_path / name / "growth")

    first, second = save("first"), save("second")
    assert [path.suffix for path in first] == [".png", ".svg", ".pdf"]
    for one, other in zip(first, second, strict=True):
        assert one.read_bytes() == other.read_bytes(), one
    assert first[0].read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in first[1].read_bytes()
    assert b"STIXGeneral" in first[2].read_bytes()


def test_a_figure_is_laid_out_at_the_resolution_of_its_file_and_keeps_its_own(tmp_path):
    """Texts that are measured at another resolution would be typeset twice."""
    import matplotlib.pyplot as plt

    with plot.house_style():
        figure = new_figure(4, 3)
        figure.add_subplot().set_xlabel("$x^2$")
        engine, seen = figure.get_layout_engine(), []
        execute = engine.execute
        engine.execute = lambda fig: (seen.append(fig.dpi), execute(fig))
        own = figure.dpi
        (path,) = plot.save_figure(figure, tmp_path / "small", formats=["png"])
        assert (seen, figure.dpi) == ([plt.rcParams["savefig.dpi"]], own)
    assert plt.imread(path).shape[:2] == (3 * seen[0], 4 * seen[0])


def test_a_figure_that_cannot_be_written_is_refused_like_every_file(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"could not write .*figure\.svg"):
        plot.save_figure(new_figure(4, 3), tmp_path / "file" / "figure", formats=["svg"])
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_bands_and_levels_are_named_in_a_figure_by_default():
    system = lp.catalog.system("heavy-top")
    start = lp.phase_space.find_start(system, leaf={"C1": 0.3, "C2": 1}, energy=1.5).state
    starts = lp.integrate(system, start, times=[0, 1, 2, 3]).state[0]  # of one level
    growth = lp.finite_time_exponents(system, starts, t_end=10)
    ax = plot.convergence(growth)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        "mean",
        "middle 90% of the orbits",
        "95% interval of the mean",
    ]
    assert ax.get_title(loc="left") == "heavy-top\n$H$ = $1.5$, $C_{1}$ = $0.3$, $C_{2}$ = $1$"
    mixed = lp.finite_time_exponents(system, lp.sample_states(system, 3, seed=1), t_end=10)
    assert plot.convergence(mixed).get_title(loc="left") == "heavy-top\n3 levels of $H$, $C_{1}$, $C_{2}$"
    assert plot.orbit(lp.integrate(system, starts, t_end=1), trajectory=2).get_suptitle() == ax.get_title(loc="left")


def test_a_curve_of_another_system_leaves_no_false_title():
    tops = lp.Top.kovalevskaya(), lp.Top.lagrange()
    first, second = (lp.finite_time_exponents(top, lp.sample_states(top, 1, seed=1), t_end=50) for top in tops)
    ax = lp.plot.convergence(first)
    whole = ax.get_title(loc="left")
    lp.plot.convergence(first, ax=ax)
    assert ax.get_title(loc="left") == whole
    assert whole.startswith("Kovalevskaya")
    lp.plot.convergence(second, ax=ax)
    assert "Kovalevskaya" not in ax.get_title(loc="left")
