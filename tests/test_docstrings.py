"""Every public name has an example in its docstring, which runs and prints what stands there."""

import doctest
import inspect
import pickle
import re
import tempfile
from functools import cache, wraps
from types import ModuleType

import matplotlib as mpl
import numpy as np
import pytest

import liepoisson as lp

SLOW = {
    "integrability.galois_obstruction", "integrability.variational_equations", "plot.save_figure",
    "proofs.find_certificate", "proofs.prove_chaos", "results.PreciseMidpoint",
}  # fmt: skip
"""Examples that take more than a second."""

SHARED = (
    "chaos.exponents_by_energy", "phase_space.equilibrium_family", "proofs.find_certificate", "tori.diagram",
    "tori.molecule", "tori.regions",
)  # fmt: skip
"""Long calls that the examples of a function, of its result, of the parts of it and of its figure have in common."""


def public_values():
    """Every public name with its value, but for chapters, errors, warnings and the version."""
    chapters = {name: module for name in lp.__all__ if isinstance(module := getattr(lp, name), ModuleType)}
    for chapter, module in {"": lp, **chapters}.items():
        for name in module.__all__:
            value = getattr(module, name)
            is_error = isinstance(value, type) and issubclass(value, Exception)
            if not is_error and not isinstance(value, ModuleType) and name != "__version__":
                yield f"{chapter}.{name}".lstrip("."), value


def once(values):
    """Each value under its first name only: those of the top level are in chapters, too."""
    seen = set()
    for name, value in values:
        if id(value) not in seen:
            seen.add(id(value))
            yield name, value


PUBLIC = dict(public_values())
EXAMPLES = {name: text for name, value in once(PUBLIC.items()) if ">>>" in (text := value.__doc__ or "")}


@cache
def made_once(name):
    """A function that is not called again with the same arguments: what it returns does not change."""
    function, known = PUBLIC[name], {}

    @wraps(function)
    def remembered(*given, **options):
        key = pickle.dumps((given, options))
        if key not in known:
            known[key] = function(*given, **options)
        return known[key]

    return remembered


@pytest.fixture
def shared_calls(monkeypatch):
    for name in SHARED:
        chapter, _, function = name.rpartition(".")
        monkeypatch.setattr(getattr(lp, chapter), function, made_once(name))


@pytest.fixture
def nothing_stays(monkeypatch, tmp_path):
    """Files of an example go to a folder of the test, and no window is opened."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    mpl.use("Agg")


@pytest.mark.usefixtures("nothing_stays", "shared_calls")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.thorough] if name in SLOW else []) for name in EXAMPLES]
)
def test_an_example_prints_what_it_says(name):
    example = doctest.DocTestParser().get_doctest(EXAMPLES[name], {"lp": lp, "np": np}, name, None, None)
    if "lp.view(" in EXAMPLES[name]:
        pytest.importorskip("anywidget")
    told = []
    doctest.DocTestRunner(verbose=False).run(example, out=told.append)
    assert not told, "".join(told)


def test_every_public_name_has_an_example():
    missing = [name for name, value in PUBLIC.items() if ">>>" not in (value.__doc__ or "")]
    assert not missing, f"no example in the docstring of {', '.join(missing)}"


@pytest.mark.parametrize("name", [name for name, value in PUBLIC.items() if "    Args:\n" in (value.__doc__ or "")])
def test_every_argument_is_described(name):
    """Also those that many functions share, whose sentences are put into the docstring."""
    entries = re.findall(r"^ *\**(\w+(?:, \w+)*): ", PUBLIC[name].__doc__.partition("Args:\n")[2], re.MULTILINE)
    described = {name for entry in entries for name in entry.split(", ")}
    missing = set(inspect.signature(PUBLIC[name]).parameters) - described
    assert not missing, f"{', '.join(sorted(missing))} of {name}"


def test_the_slow_examples_are_there():
    assert set(EXAMPLES) >= SLOW
