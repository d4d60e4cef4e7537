"""Settings shared by all tests."""

from collections import defaultdict

import pytest
from hypothesis import HealthCheck, settings

# Random examples that are the same in every run, so that a red build can be repeated; no time limit for one example,
# since the machines that run the tests are shared.
settings.register_profile("liepoisson", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("liepoisson")


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config):
    """With several workers, tests that share a set-up run on one of them, and it is computed once."""
    if getattr(config.option, "numprocesses", None) and config.option.dist in {"no", "load"}:
        config.option.dist = "loadgroup"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """One group for all tests of a fixture that lives longer than a test."""
    users = defaultdict(list)
    for item in items:
        for name in item.fixturenames:
            for fixture in item._fixtureinfo.name2fixturedefs.get(name, ()):
                if fixture.scope in {"module", "session"} and fixture.baseid.startswith("tests"):
                    users[f"{fixture.baseid}::{name}"].append(item)
    for fixture, those in sorted(users.items(), key=lambda entry: -len(entry[1])):
        for item in those:
            if item.get_closest_marker("xdist_group") is None:
                item.add_marker(pytest.mark.xdist_group(fixture))
