"""Polynomials on an invariant level set."""

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability.derivation import derivation_of
from liepoisson.integrability.level import level_of

SYSTEM = lp.catalog.system("kovalevskaya")


def level(*texts):
    zeros = [SYSTEM.expression(text) for text in texts]
    flow, polynomials = derivation_of(SYSTEM, *zeros)
    return flow, level_of(flow, polynomials)


CASIMIRS = "l1*alpha1 + l2*alpha2 + l3*alpha3 - 1/2", "alpha1^2 + alpha2^2 + alpha3^2 - 1"


@pytest.mark.parametrize("function", ["l1^2*alpha3^3", "alpha1^4 + l3", "l1*l2*alpha1^2*alpha3^2", "1"])
def test_remainders_are_those_of_sympy(function):
    flow, where = level(*CASIMIRS)
    polynomial = derivation_of(SYSTEM, SYSTEM.expression(function))[1][0]
    remainder = flow.expression(where.remainder(polynomial))
    basis = sp.groebner([SYSTEM.expression(c) for c in CASIMIRS], *SYSTEM.variables, order="grevlex")
    assert sp.expand(remainder - basis.reduce(SYSTEM.expression(function))[1]) == 0
    assert all(where.is_standard(m) for m in where.remainder(polynomial))


def test_functions_that_vanish_there_have_no_remainder():
    _, where = level(*CASIMIRS)
    product = derivation_of(SYSTEM, SYSTEM.expression(f"({CASIMIRS[0]})*l3 + ({CASIMIRS[1]})*alpha1"))[1][0]
    assert where.remainder(product) == {}


def test_all_of_phase_space_leaves_polynomials_as_they_are():
    _, where = level()
    polynomial = derivation_of(SYSTEM, SYSTEM.hamiltonian)[1][0]
    assert where.remainder(polynomial) == polynomial


@pytest.mark.parametrize(
    ("texts", "words"),
    [(("l1",), "not invariant"), (("1",), "contradict"), ((CASIMIRS[1], f"{CASIMIRS[1]} - 1"), "contradict")],
)
def test_levels_that_are_none(texts, words):
    with pytest.raises(ParameterError, match=words):
        level(*texts)
