"""Hints of messages: the nearest known name, and where a name would have been right."""

import pytest

import liepoisson as lp
from liepoisson.errors import MissingFileError, UnknownNameError, did_you_mean


def test_the_nearest_name_is_asked_for_whatever_the_case_of_its_letters():
    assert did_you_mean("kovalevskaia", ["lagrange", "kovalevskaya"]) == "Did you mean kovalevskaya? "
    assert did_you_mean("Splitting", ["taylor", "splitting"]) == "Did you mean splitting? "
    assert did_you_mean("xyz", ["lagrange"]) == ""
    assert did_you_mean(3, ["lagrange"]) == ""


@pytest.mark.parametrize("name", ["I", "epsilon", "sine", "p", "cosine"])
def test_no_name_is_taken_for_a_function_or_a_constant(name):
    """A name that is written without arguments is no function, and no constant is meant by some of its letters."""
    with pytest.raises(lp.errors.ExpressionError, match=f"{name}' is unknown") as caught:
        lp.System(lp.so(3) @ lp.trivial(), f"2*{name}*l1")
    assert "Did you mean" not in str(caught.value)
    with pytest.raises(lp.errors.ShapeError, match=f"the name '{name}' is unknown.* Known is pi"):
        lp.proofs.Box([f"2*{name}"], [1])


def test_a_component_beyond_the_last_is_not_taken_for_its_vector():
    with pytest.raises(lp.errors.ExpressionError, match=r"'l4' is unknown. l has 3 components. Known"):
        lp.System(lp.so(3) @ lp.trivial(), "l4")
    with pytest.raises(lp.errors.ExpressionError, match=r"'l0' is unknown. l has 3 components. Known"):
        lp.System(lp.so(3) @ lp.trivial(), "l0")


@pytest.mark.parametrize(
    ("call", "error", "hint"),
    [
        (lambda: lp.catalog.system("Kovalevskaia"), UnknownNameError, "Did you mean kovalevskaya"),
        (lambda: lp.sample_states(lp.Top.kovalevskaya(), 1, ensemble="cubes"), UnknownNameError, "Did you mean cube"),
        (lambda: lp.sweeps.Starts(ensemble="gausian"), UnknownNameError, "Did you mean gaussian"),
        (lambda: lp.read_system("gyrostat"), MissingFileError, r'lp\.catalog\.system\("gyrostat"\)'),
        (lambda: lp.read_system("gyrostat.toml"), MissingFileError, r"Check the path\.$"),
        (
            lambda: lp.System(lp.Bracket(lp.algebras.se(3), lp.extensions.trivial()), "lt4 + dot(l, l)"),
            lp.errors.ExpressionError,
            r"Did you mean lt3\? Known are l, pi; components lr1, lr2, lr3, lt1, lt2, lt3",
        ),
    ],
)
def test_a_mistyped_name_is_followed_by_the_right_one(call, error, hint):
    with pytest.raises(error, match=hint):
        call()


SE2 = lp.algebras.se(2) @ lp.trivial()
TWO_FIELDS = lp.so(3) @ lp.semidirect(2)
TOP = lp.Top.kovalevskaya()


class OnlyAField:
    """What is enough to integrate."""

    name = "own"

    def field(self):
        return TOP.field()


SEARCHES = [
    lambda system: lp.integrability.first_integrals(system, degree=1),
    lambda system: lp.integrability.darboux_polynomials(system, degree=1),
    lp.integrability.integrability_report,
    lp.integrability.integrable_families,
    lp.integrability.galois_obstruction,
    lp.integrability.painleve_test,
    lambda system: lp.integrability.scan_integrals(system, axes={"k": [1]}, degree=1),
    lp.integrability.search_lax_pairs,
    lambda system: lp.integrability.lax_pair(system, L="l", M="l"),
    lambda system: lp.integrability.certificate(system, {"H": "l1"}),
    lp.proofs.prove_chaos,
]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: lp.System(lp.algebras.se(2), "l1"), r"wanted a Bracket; got se\(2\); .*write se\(2\) @ trivial\(\)$"),
        (lambda: lp.System(lp.algebras.se(3), "l1"), r"so\(3\) @ semidirect\(2\), the same with two vectors"),
        (lambda: lp.System(lp.trivial(), "l1"), r"write so\(3\) @ extension"),
        (
            lambda: lp.System(lp.algebras.se(3) @ lp.trivial(), "dot(m, p)"),
            r"Write so\(3\) @ semidirect\(2\) for se\(3\)",
        ),
        (lambda: lp.System(SE2.rename("x"), "x1"), r"Did you mean xr\?"),
        (lambda: lp.System(SE2.rename("x"), "x3"), r"Did you mean xt2\?"),
        (lambda: lp.System(TWO_FIELDS, "dot(m, p)"), r'Other names: bracket\.rename\("m", "p"\)'),
        (lambda: lp.System(TWO_FIELDS, "cos(t)*l1"), "Systems are autonomous: no formula depends on time"),
        (lambda: lp.System(TWO_FIELDS, "dot(l, A*l)", {"A": [1, 2, 3]}), r"or diag\(u\)\*v"),
        (lambda: lp.integrate(TOP, [1, 2], t_end=1), r"got shape \(2,\)\. The components are l1, l2, l3, alpha1"),
        (lambda: lp.orbits.rod(lp.Top.lagrange(), [1, 2], length=1), "The components are l1, l2, l3, alpha1"),
        (lambda: lp.integrate(TWO_FIELDS, [1], t_end=1), r"write System\(bracket, hamiltonian\)"),
        (lambda: lp.integrate(lp.so(3), [1], t_end=1), r"write System\(algebra @ trivial\(\), hamiltonian\)"),
        (lambda: lp.integrate("kovalevskaya", [1], t_end=1), r"catalog\.system"),
        (lambda: lp.integrate(lp.Top, [1], t_end=1), "call it to make one"),
        (lambda: lp.inspect(TOP.field()), "a field does not know its bracket"),
        (lambda: lp.inspect(TWO_FIELDS), r"write System\(bracket, hamiltonian\)"),
        (lambda: lp.inspect(3), "wanted a system"),
        *((lambda search=search: search(TOP.field()), "a field does not know its bracket") for search in SEARCHES),
        *((lambda search=search: search(TWO_FIELDS), r"write System\(bracket, hamiltonian\)") for search in SEARCHES),
        *((lambda search=search: search(OnlyAField()), "a vector field only; the equations") for search in SEARCHES),
        (lambda: lp.trivial() @ lp.so(3), r"write algebra @ extension, as in so\(3\) @ trivial\(\)"),
        (lambda: lp.so(3) @ lp.so(3), r"extension: wanted an Extension; got so\(3\); try leibniz"),
        (lambda: lp.Bracket("so(3)", lp.trivial()), r"algebra: wanted a LieAlgebra; got 'so\(3\)'; try so\(3\)"),
        (lambda: lp.so(3) + 3, "wanted a Lie algebra to add; got 3"),
        (lambda: lp.trivial() + 3, "wanted an extension to add; got 3"),
        (lambda: TWO_FIELDS.substitute(3), "values: wanted a mapping from names to values; got 3"),
        (lambda: lp.sections.good_surface(3), "wanted a system"),
        (lambda: lp.sections.section_starts(3, "l1", energy=1, n_starts=2), "leaf: wanted a Leaf; got 3"),
        (lambda: lp.sections.default_surface(TOP), "leaf: wanted a Leaf"),
        (lambda: lp.plot.orbit(3), "wanted what integrate returns; got 3"),
        (lambda: lp.so(3).substitute(3), "values: wanted a mapping"),
        (lambda: lp.trivial().substitute(3), "values: wanted a mapping"),
        (lambda: lp.plot.convergence(3), "got 3, which has no 'exponent'; convergence wants another kind of thing"),
        (lambda: lp.orbits.chart_orbit(3, [1] * 9, times=[0, 1]), "chart: got 3, which has no 'system'"),
        (lambda: lp.algebras.semidirect_sum(3, [[[1]]]), "got 3, which has no 'dimension'"),
        (lambda: lp.plot.section(3), "wanted what section returns; got 3"),
    ],
)
def test_a_wrong_call_is_told_what_to_write(call, message):
    with pytest.raises(lp.errors.LiePoissonError, match=message):
        call()


@pytest.mark.parametrize(
    ("module", "name", "message"),
    [
        (lp.catalog, "sytem", "did you mean system"),
        (lp.catalog, "henon_heiles_kdv", r'write liepoisson\.catalog\.system\("henon-heiles-kdv"\)'),
        (lp.plot, "spectrun", "did you mean spectrum"),
        (lp, "toda", r"it is liepoisson\.catalog\.toda"),
        (lp, "tode", r"did you mean liepoisson\.catalog\.toda"),
        (lp.chaos, "time_scale", r"it is liepoisson\.orbits\.time_scale"),
        (lp.chaos, "integrate", r"it is liepoisson\.integrate"),
    ],
)
def test_a_name_in_another_chapter_is_found(module, name, message):
    with pytest.raises(AttributeError, match=message):
        getattr(module, name)
    assert not hasattr(module, "__no_such_name__")


def test_a_typing_error_in_a_formula_has_a_short_traceback():
    with pytest.raises(lp.errors.ExpressionError) as caught:
        lp.System(TWO_FIELDS, "dot(l, l")
    assert len(caught.traceback) <= 2  # this line, and the one that explains wrong calls
    assert caught.value.__cause__ is None
