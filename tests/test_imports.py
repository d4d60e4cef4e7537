"""Importing is light: heavy libraries load when they are used."""

import subprocess
import sys

import pytest

import liepoisson as lp


def loaded(program):
    heavy = ("sympy", "xarray", "matplotlib", "typer", "rich", "jinja2", "h5py", "pandas", "scipy")
    heavy += ("zarr", "dask", "distributed")
    code = f"import sys\n{program}\nprint(*[name for name in {heavy!r} if name in sys.modules])"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()


@pytest.mark.thorough
def test_an_exponent_needs_numpy_only():
    program = """
import liepoisson as lp
top = lp.Top.twisted_kovalevskaya()
growth = lp.lyapunov_exponent(top, lp.sample_states(top, 2, seed=1), t_end=1)
orbit = lp.integrate(top, growth.final_state, t=[0, 1], dense=True).at(0.5)
"""
    assert loaded(program) == []


def test_every_public_name_loads():
    for name in lp.__all__:
        assert getattr(lp, name) is not None
    assert dir(lp) == lp.__all__


def test_types_that_results_and_arguments_have_are_public():
    import typing

    growth, spec = typing.get_type_hints(lp.mean_curve), typing.get_type_hints(lp.SweepSpec)
    assert growth["return"] is lp.MeanCurve
    assert typing.get_type_hints(lp.log_fit)["return"] is lp.LogFit
    assert lp.Starts in (spec["starts"], *typing.get_args(spec["starts"]))
    assert lp.Refinement in (spec["refine"], *typing.get_args(spec["refine"]))
    assert lp.Axis in typing.get_args(spec["axes"])


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'bogus'"):
        lp.bogus  # noqa: B018
