"""Settings shared by all tests."""

import gc
import os
import pickle
import shutil
import signal
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Random examples that are the same in every run, so that a red build can be repeated; no time limit for one example,
# since the machines that run the tests are shared.
settings.register_profile("liepoisson", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("liepoisson")

ROOT = Path(__file__).parents[1]

LONGEST = (
    "tests/test_docs.py", "tests/portable/test_portable.py", "tests/web/test_systems.py",
    "tests/web/test_numbers_of_the_page.py",
)  # fmt: skip
"""The files that take longest at once, the longest first: pages, processes, browsers (measured now and then).

Workers that share the files take these first, so that none is left with one of them at the end. A file that is missing
here runs later, nothing else.
"""


QUICK_FOLDERS = ("laws",)
"""Folders that the quick tests take whole; see `--quick`."""


def pytest_addoption(parser):
    words = "those of `make check`: tests/*.py, tests/laws, all test_refusals.py, and the first test of each other file"
    parser.addoption("--quick", action="store_true", help=words)


def quick(items):
    """The quick ones: layers, imports, names, laws and refusals, and one known answer of every module."""
    begun = set()
    for item in items:
        if item.get_closest_marker("slow") or item.get_closest_marker("thorough"):
            continue
        is_whole = item.path.parent == ROOT / "tests" or item.path.name == "test_refusals.py"
        if is_whole or item.path.parent.name in QUICK_FOLDERS or item.path not in begun:
            yield item
        begun.add(item.path)


def pytest_configure(config):
    # With `--dist loadfile` files would start by their numbers of tests, and those with few long tests come last.
    config.option.loadscopereorder = False
    # A shell starts "command &" with Ctrl-C ignored, and children inherit that; the tests of Ctrl-C need it heard.
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Without a search for garbage: thousands of tests are made, and all are kept."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()
        gc.set_threshold(100_000, 20, 100)  # tests that read all sources spent half of their time in the search


def pytest_collection_modifyitems(config, items):
    rank = {name: k for k, name in enumerate(LONGEST)}
    items.sort(key=lambda item: rank.get(item.nodeid.partition("::")[0], len(rank)))
    if config.getoption("quick"):
        chosen = {id(item) for item in quick(items)}
        config.hook.pytest_deselected(items=[item for item in items if id(item) not in chosen])
        items[:] = [item for item in items if id(item) in chosen]


@pytest.fixture(scope="module", autouse=True)
def nothing_is_left_behind():
    """Tests write into temporary folders: none leaves anything in that in which they run, but cargo its own folder."""
    before = {*ROOT.iterdir(), ROOT / "target"}
    yield
    left = sorted(path.name for path in set(ROOT.iterdir()) - before if not path.name.startswith("."))
    assert not left, f"tests left {', '.join(left)} in {ROOT}; let them write below tmp_path"


@pytest.fixture
def shaken_body(tmp_path):
    """A file of a system with noise, body.toml in the folder of the test."""
    return shutil.copy(ROOT / "tests" / "data" / "shaken-body.toml", tmp_path / "body.toml")


@pytest.fixture(scope="session")
def shared_by_workers(tmp_path_factory):
    """What a function computes, under a name: once for all workers of pytest-xdist, the others wait for its pickle."""

    def shared(name, compute):
        if "PYTEST_XDIST_WORKER" not in os.environ:
            return compute()
        folder = tmp_path_factory.getbasetemp().parent  # that of the run; each worker has one in it
        done = folder / f"{name}.pickle"
        try:
            (folder / f"{name}.begun").mkdir()
        except FileExistsError:
            while not done.exists():  # if the worker that computes it dies, the limit of time of the test ends this
                time.sleep(0.1)
            return pickle.loads(done.read_bytes())
        try:
            found = compute()
            written = folder / f"{name}.written"
            written.write_bytes(pickle.dumps(found))
            written.replace(done)
        except BaseException:
            (folder / f"{name}.begun").rmdir()
            raise
        return found

    return shared
