"""Every kind of result can be pickled and copied, says the same afterwards, and can be in a set."""

import copy
import dataclasses
import inspect
import pickle

import pytest
import sympy as sp

import liepoisson as lp

OF, ENTRY = lp.integrability, lp.catalog.system
TOP = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha1", symbols=["J", "a"])
LAX = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, inv(I)*l)/2 + a3*alpha3", symbols=["I[3]", "a3"])


def lax_pair():
    return OF.search_lax_pairs(ENTRY("lagrange"), degree=2).pairs[0]


def linear_system():
    s = sp.Symbol("s")
    return OF.linear_system(sp.Matrix([[1 / (2 * s), 1], [0, 1 / (s - 1)]]), s)


def used(system):
    """A linear system that has derived what it keeps."""
    assert system.singular_points
    return system


EXACT = {
    "CurveComponent": lambda: lax_pair().spectral_curve().components[0],
    "DiscreteSymmetries": lambda: lp.systems.discrete_symmetries(ENTRY("henon-heiles")),
    "FirstIntegral": lambda: OF.first_integrals(ENTRY("lagrange"), degree=1).found[0],
    "FirstIntegrals": lambda: OF.first_integrals(ENTRY("lagrange"), degree=1),
    "IntegrabilityReport": lambda: OF.integrability_report(ENTRY("lagrange"), degree=1),
    "IntegrableFamilies": lambda: OF.integrable_families(TOP, degree=1),
    "IntegralScan": lambda: OF.scan_integrals(TOP, axes={"J": [1, 2], "a": [0, 1]}, degree=1, threads=1),
    "LaxFamilies": lambda: OF.lax_families(LAX, nonzero=["a3"], positive=["I1", "I2", "I3"]),
    "LaxIntegrals": lambda: lax_pair().integrals(),
    "LaxPair": lax_pair,
    "LaxSearch": lambda: OF.search_lax_pairs(ENTRY("lagrange"), degree=2),
    "PainleveTest": lambda: OF.painleve_test(ENTRY("henon-heiles-kdv")),
    "SpectralCurve": lambda: lax_pair().spectral_curve(),
    "DarbouxPolynomials": lambda: OF.darboux_polynomials(ENTRY("rattleback"), degree=1),
    "GaloisObstruction": lambda: OF.galois_obstruction(ENTRY("henon-heiles")),
    "LinearSystem": lambda: used(linear_system()),
    "Monodromy": lambda: OF.monodromy(linear_system(), [0.5, 0.5j, -0.5, -0.5j]),
    "ParticularSolution": lambda: OF.particular_solutions(ENTRY("henon-heiles"))[0],
    "Page": lambda: lp.laboratory.page_of(ENTRY("toda")),
}
"""Results of the exact algebra; those with arrays are in test_results_own_their_numbers.py."""


@pytest.mark.thorough
@pytest.mark.parametrize("kind", EXACT)
def test_a_result_can_be_pickled_and_copied(kind):
    result = EXACT[kind]()
    for other in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result), copy.copy(result)):
        assert type(other) is type(result)
        assert (repr(other), str(other)) == (repr(result), str(result))
        assert can_be_in_a_set(result, other)


def can_be_in_a_set(value, other):
    """Whether a value is equal to itself and found in a set, and has the hash of what it is equal to."""
    return value == value and value in {value} and (value != other or hash(value) == hash(other))  # noqa: PLR0124


RECORDS = {
    "Citation": lambda: lp.cite(ENTRY("toda")),
    "DiscreteSymmetry": lambda: lp.systems.discrete_symmetries(ENTRY("henon-heiles")).reversers[0],
    "CasimirReport": ENTRY("lagrange").bracket.casimir_report,
    "Equilibria": lambda: lp.equilibria(ENTRY("henon-heiles"), {}),
    "Estimate": lambda: lp.results.Estimate(1, 0.1, 0.9, 1.1),
    "Starts": lambda: lp.sweeps.Starts(casimirs={"C1": 1}),
    "SweepSpec": lambda: lp.sweeps.SweepSpec(
        "twisted-top", axes=(lp.sweeps.Axis("epsilon", (0, 1)),), t_end=9, parameters={"a": [1, 0, 0]}
    ),
    "SystemFile": lambda: lp.catalog.entry("kovalevskaya"),
    "Taylor": lp.Taylor,
}


@pytest.mark.parametrize("kind", RECORDS)
def test_a_record_can_be_in_a_set(kind):
    value, other = RECORDS[kind](), RECORDS[kind]()
    assert type(value).__name__ == kind
    assert can_be_in_a_set(value, other)
    assert can_be_in_a_set(value, copy.copy(value))


def public_classes():
    for chapter in lp.__all__:
        module = getattr(lp, chapter)
        if inspect.ismodule(module):
            yield from (value for name in module.__all__ if inspect.isclass(value := getattr(module, name)))


def test_no_public_class_has_a_hash_of_what_has_none():
    """Records with arrays are equal to themselves alone: numbers of two runs are compared within bounds."""
    words = ("Array", "dict", "Mapping", "list", "set[")
    wrong = {
        f"{value.__name__}.{field.name}"
        for value in public_classes()
        if dataclasses.is_dataclass(value) and value.__dataclass_params__.eq
        for field in dataclasses.fields(value)
        if field.compare and field.hash is not False and any(word in str(field.type) for word in words)
    }
    assert not wrong
    assert not {value.__name__ for value in public_classes() if value.__hash__ is None}


def test_flint_s_numbers_are_copied_exactly():
    from flint import fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpq_poly, fmpz_mat, fmpz_poly

    from liepoisson.algebra.flint_pickles import register

    register()
    context = fmpq_mpoly_ctx.get(["x", "y"], "degrevlex")
    polynomial = context.gen(0) ** 2 - context.gen(1) / 3
    exact = [
        fmpq_poly([fmpq(1, 3), 2]),
        fmpz_poly([1, -2]),
        fmpq_mat([[fmpq(1, 2), 0]]),
        fmpz_mat([[1], [2]]),
        polynomial,
    ]
    for make in (lambda value: pickle.loads(pickle.dumps(value)), copy.deepcopy):
        assert all(make(value) == value for value in exact)
        assert make(context) is context


def test_copies_of_curves_systems_and_balls():
    curve, system, turn = EXACT["ParticularSolution"](), used(linear_system()), EXACT["Monodromy"]()
    for make in (lambda value: pickle.loads(pickle.dumps(value)), copy.deepcopy):
        assert (make(curve), hash(make(curve))) == (curve, hash(curve))
        assert (make(system).matrix, make(system).singular_points) == (system.matrix, system.singular_points)
    again = pickle.loads(pickle.dumps(turn))
    assert all(its.contains(mine) for mine, its in zip(turn.balls.entries(), again.balls.entries(), strict=True))
    assert again.error < 2 * turn.error
