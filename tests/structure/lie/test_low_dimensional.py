"""All real Lie algebras of dimension four and less: the table, and the name of an algebra."""

from contextlib import suppress
from fractions import Fraction
from itertools import product
from random import Random

import numpy as np
import pytest
import sympy as sp
from random_bases import bases

import liepoisson as lp
from liepoisson.algebra.real_fields import real_field
from liepoisson.algebras import bianchi, derivations_of, identify, low_dimensional, low_dimensional_casimirs
from liepoisson.errors import ParameterError
from liepoisson.inputs import deadline
from liepoisson.structure.lie import identification
from liepoisson.structure.lie.low_dimensional import NAMES

half, third, root = Fraction(1, 2), Fraction(1, 3), sp.sqrt(2) / 2
VALUES = {
    "A3,5": [{"a": half}, {"a": -3 * third / 2}, {"a": root}],
    "A3,7": [{"a": 2}, {"a": third}],
    "A4,2": [{"a": -3}, {"a": 1}, {"a": -1}, {"a": half}],
    "A4,5": [
        {"a": -half, "b": third}, {"a": 1, "b": 1}, {"a": -1, "b": 1}, {"a": -1, "b": half}, {"a": half, "b": half},
        {"a": half, "b": 1}, {"a": -1, "b": root},
    ],
    "A4,6": [{"a": -2, "b": third}, {"a": 2, "b": 0}, {"a": 1, "b": 1}],
    "A4,9": [{"b": half}, {"b": 0}, {"b": 1}, {"b": -half}],
    "A4,11": [{"a": 3}],
}  # fmt: skip
ROWS = [
    (name, values)
    for name in NAMES
    for values in next((rows for part, rows in VALUES.items() if part in name.split("+")), [{}])
]


@pytest.mark.parametrize(("name", "values"), ROWS)
def test_the_casimirs_of_the_paper_are_casimirs_and_all_there_are(name, values):
    algebra = low_dimensional(name, **values)
    assert not algebra.jacobi_residuals()
    bracket = algebra @ lp.trivial()
    casimirs = low_dimensional_casimirs(name, **values)
    assert all(bracket.casimir_certificate(casimir).proved for casimir in casimirs)
    known = bracket.with_casimirs(casimirs)
    assert known.n_unknown_casimirs == 0
    assert len(casimirs) == bracket.corank()
    assert not any(bracket.is_casimir(casimir + bracket.variables[-1] ** 2) for casimir in casimirs if len(name) == 4)


@pytest.mark.parametrize(("name", "values"), ROWS)
def test_an_algebra_of_the_table_has_its_name_in_every_basis(name, values):
    algebra = low_dimensional(name, **values)
    for one in [algebra, *bases(algebra, 2)]:
        found = identify(one)
        assert found.name == name
        assert found.parameters.keys() == values.keys()
        assert all(sp.simplify(found.parameters[key] - value) == 0 for key, value in values.items())


def spectrum(algebra):
    """The eigenvalues of ad x, x generic, up to a real factor: invariant where the nilradical has codimension one."""
    n, ad = algebra.dimension, np.array(algebra.adjoint_representation(), dtype=float)
    values = np.linalg.eigvals(np.tensordot([0.37, -0.61, 0.83, 1.29][:n], ad, 1))
    scale = max(abs(values))
    both = [sorted((round(v.real, 6) + 0.0, round(v.imag, 6) + 0.0) for v in sign * values / scale) for sign in (1, -1)]
    return tuple(max(both))


def numbers(algebra):
    """What two isomorphic algebras have in common."""
    series = [ideal.dimension for ideal in (*algebra.derived_series(), *algebra.lower_central_series())]
    own = (algebra.dimension, *series, algebra.centre().dimension, derivations_of(algebra).dimension)
    codimension = algebra.dimension - algebra.nilradical().dimension
    return own, algebra.killing_signature(), spectrum(algebra) if algebra.is_solvable and codimension == 1 else None


@pytest.mark.thorough
def test_no_two_algebras_of_the_table_are_isomorphic():
    found = [numbers(low_dimensional(name, **values)) for name, values in ROWS]
    assert len({*found}) == len(ROWS)


GRID = [Fraction(k, 2) for k in range(-4, 5)]


@pytest.mark.parametrize("name", VALUES)
def test_each_algebra_of_a_family_has_one_value_of_its_parameters(name):
    """No two points of a grid have one spectrum, as A4,5 with -1 and b or -b, and A4,6 with a or -a and 0 would."""
    keys = [*VALUES[name][0]]
    taken = {}
    for values in product(GRID, repeat=len(keys)):
        with suppress(ParameterError):
            algebra = low_dimensional(name, **dict(zip(keys, values, strict=True)))
            taken.setdefault(spectrum(algebra), []).append(values)
    assert [values for values in taken.values() if len(values) > 1] == []
    assert taken


BIANCHI = {
    ("I", None): "3A1", ("II", None): "A3,1", ("III", None): "A2+A1", ("IV", None): "A3,2", ("V", None): "A3,3",
    ("VI", 0): "A3,4", ("VI", 1): "A2+A1", ("VI", 3): "A3,5", ("VII", 0): "A3,6", ("VII", 2): "A3,7",
    ("VIII", None): "A3,8", ("IX", None): "A3,9",
}  # fmt: skip


@pytest.mark.parametrize(("kind", "a"), BIANCHI)
def test_bianchi_types_have_their_names(kind, a):
    r"""$\mathrm{VI}_h$ has ad x with the eigenvalues a + 1 and a - 1, $\mathrm{VII}_h$ with a + i and a - i."""
    found = identify(bianchi(kind, a))
    assert found.name == BIANCHI[kind, a]
    assert found.bianchi == ("III" if (kind, a) == ("VI", 1) else kind)
    if found.parameters:
        assert found.parameters == {"a": Fraction(a - 1, a + 1) if kind == "VI" else a}


def acting(matrix):
    """R^3 with one element that acts on it: ad e_4 = -M."""
    brackets = {(i, 3): {k: matrix[k][i] for k in range(3)} for i in range(3)}
    return lp.LieAlgebra.from_brackets(4, brackets)


@pytest.mark.parametrize(
    ("matrix", "name", "wanted"),
    [
        ([[0, 2, 0], [1, 0, 0], [0, 0, 1]], "A4,5", (-1, 2**-0.5)),  # sqrt(2), -sqrt(2), 1
        ([[0, -2, 0], [1, 1, 0], [0, 0, 3]], "A4,6", (6 / 7**0.5, 1 / 7**0.5)),  # (1 +- i sqrt(7))/2, 3
        ([[0, 0, -1], [1, 0, 3], [0, 1, 0]], "A4,5", (-0.8152074690959046, -0.18479253090409537)),  # x^3 - 3x + 1
        ([[0, 2, 0], [1, 0, 0], [0, 0, 0]], "A3,4+A1", ()),
        ([[0, 1, 0], [0, 0, 0], [0, 0, 5]], "A4,3", ()),
    ],
)
def test_eigenvalues_may_be_irrational(matrix, name, wanted):
    found = identify(acting(matrix))
    assert found.name == name
    assert [float(found.parameters[key]) for key in sorted(found.parameters)] == pytest.approx(wanted, abs=1e-14)


def check_name(algebra):
    """The algebra of the name and the values that are found has the same invariants, and the same eigenvalues."""
    found = identify(algebra)
    kept = {key: float(value) for key, value in found.parameters.items()}
    again = low_dimensional(found.name, **{key: sp.nsimplify(value, rational=True) for key, value in kept.items()})
    own, form, values = numbers(algebra)
    assert numbers(again)[:2] == (own, form)
    if values is not None:
        assert np.allclose(sorted(numbers(again)[2]), sorted(values), atol=2e-4)  # double eigenvalues lose digits


@pytest.mark.parametrize("seed", range(25))
def test_a_random_matrix_on_r3_is_found_with_its_eigenvalues(seed):
    random = Random(seed)
    entries = [[random.choice((0, 0, 0, 1, -1, 2)) for _ in range(3)] for _ in range(3)]
    algebra = acting(entries)
    check_name(algebra)


@pytest.mark.parametrize("seed", range(25))
def test_a_random_derivation_of_heisenbergs_algebra_is_found_with_its_eigenvalues(seed):
    """[p, q] = z and x acts by a matrix on p and q, by its trace on z, and by any multiples of z."""
    random = Random(seed)
    a, b, c, d, s, t = (random.randint(-2, 2) for _ in range(6))
    brackets = {(0, 1): {2: 1}, (3, 0): {0: a, 1: c, 2: s}, (3, 1): {0: b, 1: d, 2: t}, (3, 2): {2: a + d}}
    algebra = lp.LieAlgebra.from_brackets(4, brackets)
    check_name(algebra)


@pytest.mark.thorough
def test_there_are_no_others_in_dimension_three():
    r"""Over $\mathbb F_3$: the tensors that obey Jacobi are as many as $\sum_g |GL_3| / |\mathrm{Aut}\, g|$.

    The analogue of the table: 3A1, A3,1, A2+A1, A3,2, A3,3, A3,4; $x^2 - t x + d$ irreducible up to the sign of t, with
    (t, d) = (0, 1), (1, -1), in the place of A3,6 and A3,7; one simple algebra, as quadratic forms are equivalent up to
    factors; no A3,5, as there is no a other than 0, 1, -1.
    """
    p = 3
    pairs = [(0, 1), (0, 2), (1, 2)]

    def constants(rows):
        c = np.zeros((len(rows), 3, 3, 3), dtype=np.int64)
        for k, (i, j) in enumerate(pairs):
            c[:, i, j], c[:, j, i] = rows[:, 3 * k : 3 * k + 3], -rows[:, 3 * k : 3 * k + 3]
        return c

    c = constants(np.array(np.meshgrid(*[range(p)] * 9, indexing="ij")).reshape(9, -1).T)
    nested = np.einsum("nijs,nskm->nijkm", c, c)  # [[e_i, e_j], e_k]
    cyclic = (nested + nested.transpose(0, 2, 3, 1, 4) + nested.transpose(0, 3, 1, 2, 4)) % p
    n_tensors = int((cyclic.reshape(len(c), -1) == 0).all(axis=1).sum())

    matrices = np.array(np.meshgrid(*[range(p)] * 9, indexing="ij")).reshape(9, -1).T.reshape(-1, 3, 3)
    invertible = matrices[np.round(np.linalg.det(matrices)).astype(int) % p != 0]
    named = ["3A1", "A3,1", "A2+A1", "A3,2", "A3,3", "A3,4", "A3,9"]
    tensors = [np.array(low_dimensional(name).structure_constants, dtype=int) for name in named]
    for t, d in ((0, 1), (1, -1)):  # e_3 acts by the companion matrix
        rows = np.array([[0, 0, 0, 0, 1, 0, -d, t, 0]])
        tensors.append(constants(rows)[0])
    orbits = 0
    for one in tensors:
        left = np.einsum("gip,gjq,pqk->gijk", invertible, invertible, one)
        right = np.einsum("ijs,gsk->gijk", one, invertible)
        automorphisms = int((((left - right) % p).reshape(len(invertible), -1) == 0).all(axis=1).sum())
        orbits += len(invertible) // automorphisms
    assert orbits == n_tensors


def test_parameters_of_an_irreducible_cubic_are_those_of_its_eigenvalues():
    """The roots of x^3 - 2: 2^(1/3) and 2^(1/3) (-1 +- i sqrt(3))/2, so b = 1/sqrt(3), a = -2/sqrt(3) after a sign."""
    found = identify(acting([[0, 0, 2], [1, 0, 0], [0, 1, 0]]))
    assert found.name == "A4,6"
    assert float(found.parameters["b"]) == pytest.approx(3**-0.5)
    assert float(found.parameters["a"]) == pytest.approx(-2 * 3**-0.5)


def test_what_is_undecided_says_why():
    found = identify(bianchi("VI", "a"))
    assert (found.name, found.reason) == (None, "the name depends on a; substitute values")
    with pytest.raises(ParameterError, match="undecided"):
        _ = found.algebra
    assert identify(low_dimensional("A4,9", b=half)).algebra.brackets == low_dimensional("A4,9", b=half).brackets


def test_what_the_time_ended_is_undecided_and_says_what_was_under_way(monkeypatch):
    """The time passes while the number field is made."""
    is_late = []

    def slow(values):
        is_late.append(True)
        return real_field(values)

    basis = sp.Matrix([[1, 2, 0], [0, 1, 3], [1, 1, 1]])
    algebra = acting((basis * sp.diag(sp.sqrt(2), 1, 3) * basis.inv()).tolist())
    assert identify(algebra).name == "A4,5"
    monkeypatch.setattr(identification, "real_field", slow)
    monkeypatch.setattr(deadline.time, "monotonic", lambda: 100.0 if is_late else 0.0)
    found = identify(algebra, time_limit=60)
    under_way = "the search for eigenvalues of ad x on the nilradical over Q(sqrt(2)) was under way"
    assert (found.name, found.reason) == (None, f"the time limit has passed: {under_way}. Give a larger time_limit")


def test_a_parameter_may_stay_a_name():
    bracket = low_dimensional("A3,7", "a") @ lp.trivial()
    (casimir,) = low_dimensional_casimirs("A3,7", "a")
    assert bracket.casimir_certificate(casimir).proved
    assert bracket.with_casimirs([casimir]).substitute({"a": 1}).n_unknown_casimirs == 0


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: low_dimensional("A4,13"), "did you mean A4,3"),
        (lambda: low_dimensional("A4,1", 2), "a: wanted none for A4,1; got 2"),
        (lambda: low_dimensional("A3,5"), r"a: wanted a number for A3,5, 0 < \|a\| < 1; got none"),
        (lambda: low_dimensional("A3,5", 1), r"0 < \|a\| < 1 for A3,5; got '1'"),
        (lambda: low_dimensional("A4,5", 1, half), "-1 <= a <= b, a != 0 for A4,5"),
        (lambda: low_dimensional_casimirs("A4,9", b=-1), "-1 < b <= 1 for A4,9"),
        (lambda: identify(lp.so(4)), "at most four dimensions.* got 6"),
        (lambda: identify(3), "wanted a Lie algebra; got 3"),
    ],
)
def test_refusals(call, words):
    with pytest.raises(ParameterError, match=words):
        call()


def test_signs_of_algebraic_numbers_tell_so3_from_sl2():
    """A basis of sl(2, R) with the Killing form of diag(1, -1) and E12, E21, of signature (2, 1), in other units."""
    r = sp.sqrt(2)
    e, f = sp.Matrix([[0, 1], [0, 0]]), sp.Matrix([[0, 0], [1, 0]])
    split = lp.LieAlgebra.from_matrices([sp.diag(r, -r), sp.sqrt(3) * e, f])
    compact = lp.LieAlgebra.from_brackets(3, {(0, 1): {2: r}, (1, 2): {0: 1 + r}, (2, 0): {1: sp.sqrt(3)}})
    assert split.killing_signature() == (2, 1, 0)
    assert identify(split).name == "A3,8"
    assert compact.killing_signature() == (0, 3, 0)
    assert identify(compact).name == "A3,9"


def test_symbols_leave_a_signature_open():
    scaled = lp.LieAlgebra.from_brackets(3, {(0, 1): {2: "k"}, (1, 2): {0: 1}, (2, 0): {1: 1}})
    with pytest.raises(ParameterError, match=r"symbols k\. Give values to them"):
        scaled.killing_signature()
