"""The examples in docstrings of public names run and print what stands there."""

import doctest
from types import ModuleType

import numpy as np
import pytest

import liepoisson as lp


def with_examples():
    chapters = {name: module for name in lp.__all__ if isinstance(module := getattr(lp, name), ModuleType)}
    for chapter, module in {"": lp, **chapters}.items():
        for name in module.__all__:
            if ">>>" in (text := getattr(module, name).__doc__ or ""):
                yield f"{chapter}.{name}".lstrip("."), text


EXAMPLES = dict(with_examples())


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_prints_what_it_says(name):
    example = doctest.DocTestParser().get_doctest(EXAMPLES[name], {"lp": lp, "np": np}, name, None, None)
    if "lp.view(" in EXAMPLES[name]:
        pytest.importorskip("anywidget")
    told = []
    doctest.DocTestRunner(verbose=False).run(example, out=told.append)
    assert not told, "".join(told)


@pytest.mark.parametrize(
    "name",
    [
        "Bracket", "Extension", "LieAlgebra", "System", "Top", "canonical", "decide", "equilibria",
        "finite_time_exponents", "inspect", "integrate", "lyapunov_spectrum", "sample_states", "section", "sweep",
        "view",
    ],
)  # fmt: skip
def test_what_most_people_need_has_an_example(name):
    assert name in EXAMPLES
