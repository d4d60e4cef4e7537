"""The orbits that several tests look at, searched once."""

import pytest

import liepoisson as lp

LEVEL = {"C1": 1, "C2": "1/2", "C3": 1}


@pytest.fixture(scope="session")
def twisted_orbits(shared_by_workers):
    """Symmetric periodic orbits of the twisted Kovalevskaya top on H = C2 = 1/2, C1 = C3 = 1."""
    top = lp.Top.kovalevskaya(epsilon=1)
    return shared_by_workers(
        "twisted_orbits", lambda: lp.orbits.symmetric_periodic_orbits(top, LEVEL, "1/2", threads=1, n_starts=60)
    )


@pytest.fixture(scope="session")
def homoclinic_orbits(twisted_orbits, shared_by_workers):
    """Those homoclinic to the one with the largest growth rate."""
    return shared_by_workers(
        "homoclinic_orbits", lambda: lp.orbits.symmetric_homoclinic_orbits(twisted_orbits[0], threads=1)
    )
