"""The orbits that several tests look at, searched once."""

import pytest

import liepoisson as lp

LEVEL = {"C1": 1, "C2": "1/2", "C3": 1}


@pytest.fixture(scope="session")
def twisted_orbits():
    """Symmetric periodic orbits of the twisted Kovalevskaya top on H = C2 = 1/2, C1 = C3 = 1."""
    return lp.orbits.symmetric_periodic_orbits(lp.Top.kovalevskaya(epsilon=1), LEVEL, "1/2", threads=1, n_starts=60)


@pytest.fixture(scope="session")
def homoclinic_orbits(twisted_orbits):
    """Those homoclinic to the one with the largest growth rate."""
    return lp.orbits.symmetric_homoclinic_orbits(twisted_orbits[0], threads=1)
