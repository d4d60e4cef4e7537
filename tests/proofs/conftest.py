"""The shipped certificate, and copies of it with one thing changed."""

import copy
import json
from importlib.resources import files

import pytest

import liepoisson as lp
from liepoisson.proofs.polynomial_field import polynomial_field


@pytest.fixture(scope="session")
def shipped():
    return json.loads(files("liepoisson.proofs").joinpath("twisted_kovalevskaya.json").read_text(encoding="utf-8"))


@pytest.fixture
def altered(shipped):
    return copy.deepcopy(shipped)


@pytest.fixture(scope="session")
def twisted():
    return polynomial_field(lp.Top.twisted_kovalevskaya())
