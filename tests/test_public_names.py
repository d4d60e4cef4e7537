"""One word for one thing: the page of public names is up to date, and no argument has a synonym for a name."""

import importlib.util
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"

SYNONYMS = {
    "starts": {"x0", "initial", "initial_state", "initial_states", "y0"},
    "guess": {"x_guess", "initial_guess"},
    "times": {"t", "ts", "t_eval"},
    "t_end": {"t_window", "t_max", "tmax", "tspan", "t_span", "end_time", "final_time", "T"},
    "n_starts": {"n_orbits", "n_members", "count_of_starts", "size_of_ensemble"},
    "seed": {"rng", "random_state", "random_seed"},
    "time_limit": {"timeout", "max_time", "limit"},
    "progress": {"callback", "on_progress", "listen"},
    "threads": {"n_threads", "num_threads", "workers", "n_jobs"},
    "energy": {"E", "e", "energy_value", "h0"},
    "leaf": {"orbit_of", "leaf_values"},
    "tol": {"rtol", "atol", "eps"},
    "step": {"h", "dt", "step_size"},
    "path": {"file", "filename", "fname"},
    "system": {"sys", "model"},
}
"""What would say the same as an argument that there is."""

ALGEBRAIC = {"algebras", "brackets", "extensions", "catalog"}
"""Chapters where n is a dimension or a number of degrees of freedom, as in so(n)."""


@pytest.fixture(scope="module")
def names():
    spec = importlib.util.spec_from_file_location("public_names", DOCS / "public_names.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_what_the_package_says(names):
    assert names.PAGE.read_text(encoding="utf-8") == names.page(), "run `python docs/public_names.py`"
    for path, text in names.stubs().items():
        assert path.read_text(encoding="utf-8") == text, "run `python docs/public_names.py`"


def test_no_argument_has_a_second_name(names):
    found = [
        f"{function}({argument}=): say {word}"
        for function, arguments in names.callables().items()
        for argument in arguments
        for word, others in SYNONYMS.items()
        if argument in others or (argument == "n" and word == "n_starts" and function.split(".")[0] not in ALGEBRAIC)
    ]
    assert found == []


def test_every_random_thing_has_a_seed_with_a_default(names):
    import inspect

    without = [
        f"{chapter}.{name}"
        for chapter, module in names.chapters().items()
        for name in module.__all__
        if not names.is_result(chapter, getattr(module, name))
        and "seed" in names.arguments(getattr(module, name))
        and inspect.signature(getattr(module, name)).parameters["seed"].default is inspect.Parameter.empty
    ]
    assert without == []
