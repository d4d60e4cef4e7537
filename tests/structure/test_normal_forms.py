from itertools import product

import flint
import pytest

from liepoisson.structure.classification import classify
from liepoisson.structure.extension import Extension
from liepoisson.structure.normal_forms import (
    complex_name,
    complex_truncated_polynomials,
    normal_form_named,
    normal_forms,
    null_square,
    truncated_polynomials,
)

FORMS = [form for n in range(1, 6) for form in normal_forms(n)]

# Corank of so(3) (x) A where it is not dim A.  For A a Frobenius algebra (socle of dimension one) the index of
# g (x) A is dim A times the index of g (Raïs and Tauvel for truncated polynomials); with m^2 = 0 the n - 1 >= 2
# passive vectors give J rank six, so the corank is 3 n - 6.
CORANK = {
    "R[x,y,z]/(x,y,z)^2": 6,
    "R[x,y,z,t]/(x,y,z,t)^2": 9,
    "R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)": 7,
}


def corank(extension, seed):
    """Corank of J = -sum W_lam^{mu nu} c_ij^k x_lam,k at a pseudo-random integer point: the generic one or larger."""
    n, W = extension.dimension, extension.tensor
    x = [[(seed * (17 * k + 3) ** 2 + 29 * lam**3 + 7 * k * lam) % 101 - 50 for k in range(3)] for lam in range(n)]
    J = flint.fmpq_mat(3 * n, 3 * n)
    for mu, nu, lam in product(range(n), repeat=3):
        for i, j, k in product(range(3), repeat=3):
            entry = W[lam][mu][nu] * ((i - j) * (j - k) * (k - i) // 2) * x[lam][k]
            J[3 * mu + i, 3 * nu + j] -= flint.fmpq(entry.numerator, entry.denominator)
    return 3 * n - J.rank()


def test_there_are_1_1_2_5_12_real_and_1_1_2_4_9_complex_forms():
    assert [len(normal_forms(n)) for n in range(1, 6)] == [1, 1, 2, 5, 12]
    assert [len({complex_name(form.name) for form in normal_forms(n)}) for n in range(1, 6)] == [1, 1, 2, 4, 9]
    assert len({form.name for form in FORMS}) == len(FORMS)


@pytest.mark.parametrize("form", FORMS, ids=repr)
def test_each_is_commutative_associative_and_local(form):
    Extension(form.tensor)  # raises if not
    n = form.dimension
    assert form.unit() == (1,) + (0,) * (n - 1)
    assert form.residue_field == "R"
    # The basis is adapted: the nilradical is spanned by all but the unit.
    assert {tuple(v) for v in form.nilradical()} == {tuple(int(i == k) for i in range(n)) for k in range(1, n)}


def invariants(form):
    (factor,) = classify(form).factors
    return factor.hilbert_function, factor.socle_dimension, factor.signature


def test_no_two_are_isomorphic():
    """Over C the rank of the deciding quadratic form is all that remains of its signature."""
    found = [(form, *invariants(form)) for form in FORMS]
    assert len({tuple(values) for _, *values in found}) == len(FORMS)
    complex_forms = {(form.dimension, h, s, sum(signature or ())): set() for form, h, s, signature in found}
    for form, h, s, signature in found:
        complex_forms[form.dimension, h, s, sum(signature or ())].add(complex_name(form.name))
    assert all(len(names) == 1 for names in complex_forms.values())
    assert len(complex_forms) == 1 + 1 + 2 + 4 + 9


@pytest.mark.parametrize("form", FORMS, ids=repr)
def test_corank_on_so3(form):
    wanted = CORANK.get(form.name, form.dimension)
    assert min(corank(form, seed) for seed in (1, 2)) == wanted
    if len(form.socle()) == 1:
        assert wanted == form.dimension


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_families_go_on(n):
    for form in (truncated_polynomials(n), null_square(n)):
        assert Extension(form.tensor).dimension == n  # which it raises if it is none
        assert classify(form).name == form.name
    assert truncated_polynomials(n).hilbert_function() == (1,) * n
    form = complex_truncated_polynomials(n)
    assert (Extension(form.tensor).dimension, form.residue_field) == (2 * n, "C")
    assert normal_form_named("R[x]/(x^3)").tensor == normal_forms(3)[0].tensor
