"""The matrix that is made in arrays is that of the derivation, term by term."""

import numpy as np
import pytest
from searched_systems import TOP

import liepoisson as lp
from liepoisson.algebra.linear_algebra import nullspace_mod
from liepoisson.integrability import search
from liepoisson.integrability.derivation import derivation_of, of_degree, of_weight
from liepoisson.integrability.search import modular_nullity

CASES = {
    "top": (TOP, [m for d in (1, 2) for m in of_degree(9, d)]),
    "kovalevskaya": (lp.Top.twisted_kovalevskaya(), list(of_weight((1, 1, 1, 2, 2, 2, 3, 3, 3), 8))),
    "roots": (lp.Top(inertia=(1, 2, "sqrt(2)"), a=(1, 0, "sqrt(3)"), epsilon=1), list(of_degree(9, 2))),
    "symbols": (lp.catalog.system("heavy-top"), [m for d in (1, 2) for m in of_degree(6, d)]),
}


@pytest.mark.parametrize("name", CASES)
def test_the_dimension_is_that_of_the_matrix_written_out(name):
    system, monomials = CASES[name]
    flow = derivation_of(system)[0]
    residues = flow.field.residues(seed=1)
    rows = {}
    for column, monomial in enumerate(monomials):
        for key, value in flow({monomial: flow.field.one}).items():
            rows.setdefault(key, {})[column] = residues(value)
    wanted = len(nullspace_mod(list(rows.values()), len(monomials), residues.p))
    assert modular_nullity(flow, residues, monomials) == wanted > 0


def test_large_residues_times_powers_do_not_overflow():
    """-2/3 has a residue of 61 bits.  Integrals of the round oscillator: z^m conj(z)^n, |m| = |n|, of two complex z."""
    system = lp.System(lp.canonical(2), "(p1^2 + q1^2 + p2^2 + q2^2)/3", name="oscillator")
    flow = derivation_of(system)[0]
    residues = flow.field.residues(seed=1)
    assert modular_nullity(flow, residues, list(of_degree(4, 14))) == (14 // 2 + 1) ** 2


def test_no_terms_no_rows():
    flow = derivation_of(lp.System(lp.canonical(1), "0", name="nothing"))[0]
    assert modular_nullity(flow, flow.field.residues(seed=1), list(of_degree(2, 3))) == 4


def test_monomials_of_many_coordinates_get_different_numbers(monkeypatch):
    rows = np.random.default_rng(0).integers(0, 5, (200, 40))
    rows[100:] = rows[:100]
    for largest in (search._LARGEST_KEY, 1000):
        monkeypatch.setattr(search, "_LARGEST_KEY", largest)
        numbers = search._numbered(rows)
        assert (numbers[:100] == numbers[100:]).all()
        assert sorted(set(numbers.tolist())) == list(range(100))
