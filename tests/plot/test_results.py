"""Every result is drawn by one function, which says so where something is no result."""

import inspect
import json
from fractions import Fraction

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure

import liepoisson as lp
from liepoisson.plot.results import _FIGURES
from public_calls import RUNS, keys_made, result_of, rows

TOP = lp.Top.kovalevskaya("1/2")
SYMMETRY = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2 + l2^2 + J*l3^2 + a*alpha1", symbols=["J", "a"])
STARTS = lp.sample_states(TOP, 4, seed=1)


@pytest.mark.thorough
def test_results_are_drawn_and_leave_the_settings_alone(tmp_path):
    before = json.dumps(dict(mpl.rcParams), default=str)
    shown = {kind: result_of(key) for kind, key in keys_made().items()}
    for kind, result in shown.items():
        figure = lp.plot.draw(result)
        assert isinstance(figure, Figure), kind
        figure.savefig(tmp_path / "figure.png", dpi=50)
        assert (tmp_path / "figure.png").stat().st_size > 4_000, kind
        drawn = [artist for ax in figure.axes for artist in (*ax.lines, *ax.collections, *ax.images)]
        assert drawn, kind
        plt.close("all")
    assert json.dumps(dict(mpl.rcParams), default=str) == before
    assert _FIGURES.keys() <= RUNS.keys()
    verdict = shown["verdict"]
    points = [line.get_ydata() for line in lp.plot.draw(verdict).axes[0].lines if line.get_marker() == "."]
    np.testing.assert_allclose(sorted(np.concatenate(points)), sorted(verdict.mean_megno))


@pytest.mark.parametrize(
    ("kind", "drawn"),
    [("megno", ("$t$", "MEGNO")), ("frequency drift", ("trajectory", "share of the power at high frequencies"))],
)
def test_a_kind_without_a_figure_of_its_own_is_drawn_by_its_labels(monkeypatch, kind, drawn):
    monkeypatch.delitem(_FIGURES, kind)
    result = result_of(keys_made()[kind])
    (axes,) = lp.plot.draw(result).axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == drawn
    values = {"megno": "megno", "frequency drift": "high_power"}[kind]
    wanted = np.atleast_2d(getattr(result, values))
    np.testing.assert_array_equal([line.get_ydata() for line in axes.lines], wanted)
    plt.close("all")


def test_first_passages_are_drawn_as_the_share_that_has_passed():
    result = result_of(keys_made()["first passages"])
    ((line,),) = (axes.lines for axes in lp.plot.draw(result).axes)
    times, share = line.get_data()
    passed = result.time[:, None] <= times  # a NaN has not passed
    np.testing.assert_allclose(share, [row.mean() for row in passed.T])
    plt.close("all")


def test_a_scan_marks_the_points_with_further_integrals():
    scan = lp.integrability.scan_integrals(SYMMETRY, axes={"J": [1, "3/2"], "a": [0, 1]}, degree=2)
    lines = {line.get_label(): line.get_xydata() for line in lp.plot.draw(scan).axes[0].lines}
    # J = 1, a = 0 is the spherical top without gravity: l1, l2, l3 and |l|^2; J = 3/2, a = 0 keeps l3 (Lagrange, free).
    assert {"1", "none (proved)"} & lines.keys()
    for k, point in enumerate(scan.value):
        name = str(scan.n_further[k]) if scan.n_further[k] else "none (proved)"
        assert [float(Fraction(v)) for v in point] in lines[name].tolist()
    plt.close("all")


WRONG = (3, "text", None, object(), np.zeros(3), [1, 2], {"a": 1}, 1j, b"bytes", True, lp.so(3), lp.Top)
NUMBERS = {"exponent_distribution", "sleeping_diagram"}
"""Functions that draw numbers."""


def calls():
    """What each function draws first, and a call of those that take several values with each of their arguments."""
    for name in lp.plot.__all__:
        parameters = inspect.signature(getattr(lp.plot, name)).parameters.values()
        needed = [one.name for one in parameters if one.default is one.empty and one.kind is not one.VAR_KEYWORD]
        if needed:
            yield name, needed, {}
    for key, row in rows().items():
        if key.startswith("plot."):
            name = key.split(":")[0].removeprefix("plot.")
            for argument, one in inspect.signature(row.function).parameters.items():
                if one.kind is not one.VAR_KEYWORD:
                    yield name, [argument], row.arguments


@pytest.mark.filterwarnings("ignore")
def test_every_function_refuses_a_wrong_object_in_its_own_words(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # "text" is the name of a file
    wrong, drawn = [], set()
    with mpl.rc_context():
        for name, arguments, others in calls():
            for value in WRONG:
                try:
                    getattr(lp.plot, name)(**others | dict.fromkeys(arguments, value))
                    drawn |= set() if others else {name}
                except lp.errors.LiePoissonError as error:
                    if others and "which has no '" in str(error):  # an option is told what it must be
                        wrong.append(f"{name}({', '.join(arguments)}={value!r:.40}): {error}")
                except Exception as error:
                    wrong.append(f"{name}({', '.join(arguments)}={value!r:.40}): {type(error).__name__}: {error}")
                plt.close("all")
    assert not wrong, "\n".join(wrong)
    assert drawn <= NUMBERS


def test_a_figure_is_saved_under_a_text_or_a_path(tmp_path):
    figure = lp.plot.orbit(lp.integrate(TOP, STARTS[0], t_end=5))
    written = [lp.plot.save_figure(figure, stem, formats=["svg"]) for stem in (f"{tmp_path}/one", tmp_path / "two")]
    assert [path.name for (path,) in written] == ["one.svg", "two.svg"]
