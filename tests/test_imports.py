"""Importing is light: heavy libraries load when they are used."""

import ast
import pkgutil
import subprocess
import sys
import types
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
growth = lp.finite_time_exponents(top, lp.sample_states(top, 2, seed=1), t_end=1)
orbit = lp.integrate(top, growth.end_state, times=[0, 1], dense=True).at(0.5)
"""
    assert loaded(program) == []


CHAPTERS = [name for name in lp.__all__ if isinstance(getattr(lp, name), types.ModuleType)]
"""All but `catalog`, `errors` and `plot` are made of a stub alone."""


def stub_of(module):
    """Module by public name, as the stub of a module has them, which is what type checkers read."""
    tree = ast.parse(Path(module.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    assert len(tree.body) == len(imports)
    assert all(alias.asname == alias.name for node in imports for alias in node.names)
    return {alias.name: node.module for node in imports for alias in node.names}


@pytest.mark.parametrize("chapter", [None, *(name for name in CHAPTERS if name not in {"catalog", "errors", "plot"})])
def test_every_public_name_is_the_object_that_its_stub_promises(chapter):
    module = lp if chapter is None else getattr(lp, chapter)
    homes = stub_of(module)
    assert dir(module) == sorted(homes) == module.__all__
    for name, home in homes.items():
        if home == "liepoisson":
            assert getattr(module, name) is import_module(f"liepoisson.{name}")
        else:
            assert getattr(module, name) is vars(import_module(home))[name], name
            assert name == "__version__" or getattr(module, name).__name__ == name


def test_the_top_level_is_short_and_repeats_names_of_chapters():
    """New names go into chapters; each is in one chapter, and the top level repeats the most used."""
    homes = {name: chapter for chapter in CHAPTERS for name in getattr(lp, chapter).__all__ if chapter != "plot"}
    n_names = sum(len(getattr(lp, chapter).__all__) for chapter in CHAPTERS if chapter != "plot")
    assert len(homes) == n_names
    short = set(lp.__all__) - set(CHAPTERS) - {"__version__"}
    assert len(short) <= 35
    assert short <= set(homes)


def test_no_module_hides_a_public_name():
    """Importing `liepoisson.phase_space.leaf` sets `leaf` in the chapter; only `plot` imports its modules at once."""
    for module in (lp, *(getattr(lp, name) for name in CHAPTERS if name != "plot")):
        inside = {info.name for info in pkgutil.iter_modules(getattr(module, "__path__", ()))}
        assert inside & set(module.__all__) <= set(CHAPTERS), module.__name__


def test_types_that_results_and_arguments_have_are_public():
    import typing

    growth, spec = typing.get_type_hints(lp.fits.mean_curve), typing.get_type_hints(lp.sweeps.SweepSpec)
    assert growth["return"] is lp.results.MeanCurve
    assert typing.get_type_hints(lp.fits.log_fit)["return"] is lp.results.LogFit
    assert lp.sweeps.Starts in (spec["starts"], *typing.get_args(spec["starts"]))
    assert lp.sweeps.Refinement in (spec["refine"], *typing.get_args(spec["refine"]))
    assert lp.sweeps.Axis in typing.get_args(spec["axes"])


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'bogus'"):
        lp.bogus  # noqa: B018
    with pytest.raises(AttributeError, match="did you mean integrate"):
        lp.integrat  # noqa: B018
    with pytest.raises(AttributeError, match=r"it is liepoisson\.results\.Orbit"):
        lp.Orbit  # noqa: B018
