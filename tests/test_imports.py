"""Importing is light: heavy libraries load when they are used."""

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path

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


def imported_for_types():
    """Module by public name, as the types of the package's `__init__` have them: the second list of the names."""
    tree = ast.parse(Path(lp.__file__).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    imports = [node for node in block.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: node.module for node in imports for alias in node.names}


def test_every_public_name_is_the_object_that_its_types_promise():
    homes = imported_for_types()
    assert set(homes) == set(lp.__all__) - {"__version__"}
    for name, home in homes.items():
        if home == "liepoisson":
            assert getattr(lp, name) is import_module(f"liepoisson.{name}")
        else:
            assert getattr(lp, name) is vars(import_module(home))[name], name
            assert getattr(lp, name).__name__ == name
    assert dir(lp) == sorted(lp.__all__)


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
