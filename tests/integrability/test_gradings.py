"""Gradings divide the monomials into blocks that the equations do not mix."""

import pytest
from searched_systems import TOP

import liepoisson as lp
from liepoisson.integrability.derivation import (
    derivation_of,
    gradings,
    homogeneous_parts,
    in_blocks,
    n_monomials,
    n_of_weights,
    of_degree,
    of_weight,
    positive_grading,
)


def derivation(name):
    return derivation_of(lp.catalog.system(name) if isinstance(name, str) else name)[0]


@pytest.mark.parametrize("name", ["kovalevskaya", "twisted-lagrange", "clebsch", "henon-heiles", "three-wave"])
def test_the_equations_shift_weights(name):
    flow = derivation(name)
    found = gradings(flow)
    assert found
    for grading in found:
        for monomial in of_degree(len(flow.variables), 2):
            shifted = {grading.of(key) for key, _ in flow.of_monomial(monomial)}
            wanted = grading.of(monomial) + grading.shift
            assert shifted <= {wanted % grading.modulus if grading.modulus else wanted}


def test_the_weights_of_the_kovalevskaya_tops():
    assert positive_grading(gradings(derivation("kovalevskaya"))).weights == (1, 1, 1, 2, 2, 2)
    twisted = positive_grading(gradings(derivation(lp.Top.twisted_kovalevskaya())))
    assert (twisted.weights, twisted.shift) == ((1, 1, 1, 2, 2, 2, 3, 3, 3), 1)


def test_a_top_without_symmetry_has_no_positive_grading():
    assert positive_grading(gradings(derivation(TOP))) is None


def test_parts_of_an_integral_are_integrals():
    flow, (first, second) = derivation_of(
        lp.catalog.system("kovalevskaya"),
        lp.catalog.system("kovalevskaya").hamiltonian,
        lp.catalog.system("kovalevskaya").expression("C1"),
    )
    parts = homogeneous_parts({**first, **second}, gradings(flow))
    assert len(parts) > 1
    assert all(not flow(part) for part in parts.values())


def test_monomials_are_counted_as_they_are_listed():
    for degree in range(5):
        listed = list(of_degree(4, degree))
        assert len(set(listed)) == len(listed) == n_monomials(4, degree) - (n_monomials(4, degree - 1) if degree else 0)
    for weight in range(13):
        listed = list(of_weight((1, 2, 2, 3), weight))
        assert all(a + 2 * b + 2 * c + 3 * d == weight for a, b, c, d in listed)
        assert len(set(listed)) == len(listed) == n_of_weights((1, 2, 2, 3), weight)[weight]


def test_blocks_hold_every_monomial_once():
    flow = derivation("twisted-lagrange")
    monomials = list(of_degree(9, 3))
    blocks = in_blocks(iter(monomials), gradings(flow))
    assert len(blocks) > 1
    assert sorted(m for block in blocks.values() for m in block) == sorted(monomials)
