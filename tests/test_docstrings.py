"""Every public name has an example in its docstring, which runs and prints what stands there."""

import doctest
import tempfile
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


@pytest.fixture
def nothing_stays(monkeypatch, tmp_path):
    """Files of an example go to a folder of the test, and no window is opened."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    mpl.use("Agg")


@pytest.mark.usefixtures("nothing_stays")
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
