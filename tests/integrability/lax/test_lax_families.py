"""The parameters for which there are Lax pairs: the conditions of Lagrange and Manakov, found and proved."""

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError

lax_families = lp.integrability.lax_families
MOMENTS = ["I1", "I2", "I3"]


def heavy(bracket, *a):
    energy = "dot(l, inv(I)*l)/2 + " + " + ".join(f"{name}*alpha{name[1]}" for name in a)
    return lp.System(bracket, energy, symbols=["I[3]", *a])


def without_partner(family):
    return [str(c) for c in family.conditions if not any(str(s).startswith("B") for s in c.free_symbols)]


def test_the_condition_of_lagrange_is_found():
    found = lax_families(heavy(lp.so(3) @ lp.semidirect(2), "a3"), nonzero=["a3"], positive=MOMENTS)
    assert found.complete
    [family] = found.families
    assert without_partner(family) == ["I1 - I2"]
    assert family.pair.integrals().is_complete
    assert "for no other real parameters is there one: proved" in str(found)


@pytest.mark.parametrize("degree", [1, 2])
def test_the_twisted_top_needs_degree_three(degree):
    tops = heavy(lp.so(3) @ lp.leibniz(3, 1), "a3")
    assert not lax_families(tops, degree=degree, nonzero=["a3"], positive=MOMENTS).families


@pytest.mark.thorough
def test_the_twisted_top_has_a_pair_if_its_axis_carries_the_centre_or_it_is_a_ball():
    tops = heavy(lp.so(3) @ lp.leibniz(3, "epsilon"), "a1", "a3")
    found = lax_families(tops, degree=3, nonzero=["epsilon", "a3"], positive=MOMENTS)
    assert found.complete
    for family in found.families:
        at = {sp.Symbol(name): value for name, value in family.example.items()}
        assert all(c.subs(at) == 0 for c in family.conditions if c.free_symbols <= set(at))
        moments = [family.example[name] for name in MOMENTS]
        assert len(set(moments)) == 1 or (moments[0] == moments[1] and family.example["a1"] == 0)
        assert family.pair.integrals().is_complete
    assert {len({f.example[name] for name in MOMENTS}) for f in found.families} == {1, 2}


@pytest.mark.thorough
def test_the_condition_of_manakov_is_found():
    names = "abcdef"
    energy = "(a*M12^2 + b*M13^2 + c*M14^2 + d*M23^2 + e*M24^2 + f*M34^2)/2"
    tops = lp.System(lp.so(4) @ lp.trivial().rename("M"), energy, symbols=list(names))
    found = lax_families(tops, degree=1, form="diagonal", positive=list(names))
    assert found.complete
    generic = found.families[0]
    assert generic.pair.integrals().is_complete
    # elimination of B leaves one equation in the coefficients, which a body in four dimensions satisfies
    unknown = sp.symbols("B2 B3")
    equations = [q for q in generic.conditions if len(q.free_symbols) > 1]
    [solution] = sp.solve([q for q in equations if q.free_symbols & set(unknown)][:2], unknown, dict=True)
    [condition] = [q for q in (sp.factor(q.subs(solution)) for q in equations) if q != 0]
    body = {sp.Symbol(x): sp.Rational(1, s) for x, s in zip(names, (3, 4, 5, 5, 6, 7), strict=True)}
    assert condition.subs(body) == 0
    assert condition.subs(body | {sp.Symbol("f"): 1}) != 0


@pytest.mark.parametrize(
    ("system", "options", "words"),
    [
        (lambda: lp.catalog.system("lagrange"), {}, "call search_lax_pairs"),
        (lambda: heavy(lp.so(3) @ lp.semidirect(2), "a3"), {"nonzero": ["a2"]}, "nonzero: wanted names of"),
        (lambda: lp.System(lp.so(3) @ lp.trivial(), "sin(k)*l3^2", symbols=["k"]), {}, "polynomial equations"),
    ],
)
def test_what_is_not_searched_is_refused(system, options, words):
    with pytest.raises(ParameterError, match=words):
        lax_families(system(), **options)


def test_parameters_may_be_called_like_components_of_b():
    names = ["B1", "B_1", "B__1"]
    body = lp.System(lp.so(3) @ lp.trivial(), "B1*l1^2 + B_1*l2^2 + B__1*l3^2", symbols=names)
    found = lp.integrability.lax_families(body, degree=1, form="diagonal")
    assert found.complete
    assert not {str(s) for case in found.families for c in case.conditions for s in c.free_symbols} & {"B2", "B_2"}
