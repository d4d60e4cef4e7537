"""First integrals: those of the literature are found without a hint, and where there are none it is proved."""

from dataclasses import replace

import pytest
import sympy as sp
from searched_systems import TOP, is_polynomial_in, toda

import liepoisson as lp
from liepoisson.cli.integrals import latex_lines
from liepoisson.errors import ParameterError
from liepoisson.integrability.polynomial_integrals import search_record
from liepoisson.integrability.search_problem import zeros_on_level

first_integrals = lp.integrability.first_integrals
entry = lp.catalog.system


def generators(found):
    return [*found.known.values(), *(f.expression for f in found.found)]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "scope", "degrees"),
    [
        ("twisted-lagrange", {"degree": 2}, [1, 2]),
        ("charged-twisted-lagrange", {"degree": 2}, [1, 2]),
        ("kovalevskaya", {"weight": 4}, [4]),
        ("kovalevskaya", {"degree": 4}, [4]),
        ("two-field-kovalevskaya", {"degree": 4}, [4, 4]),
        ("clebsch", {"degree": 2}, [2]),
        ("steklov", {"degree": 2}, [2]),
        ("manakov-so4", {"degree": 2}, [2]),
        ("henon-heiles-kdv", {"degree": 4}, [4]),
        ("henon-heiles-sawada-kotera", {"degree": 3}, [3]),
        ("henon-heiles-kaup-kupershmidt", {"degree": 6}, [6]),
        ("three-wave", {"degree": 2}, [2, 2]),
    ],
)
def test_integrals_of_the_literature_are_found_without_a_hint(name, scope, degrees):
    system = entry(name)
    found = first_integrals(system, **scope)
    assert set(found.known) == {"H", *(f"C{k + 1}" for k in range(len(system.bracket.casimirs())))}
    assert found.complete
    for f in found.found:
        assert sp.expand(system.derivative(f.expression)) == 0
        assert f.expression.free_symbols <= set(system.variables)
    if "degree" in scope:
        assert [f.degree for f in found.independent] == degrees
        assert all(is_polynomial_in(sp.expand(k), generators(found), system) for k in system.integrals.values())


@pytest.mark.parametrize(
    ("hamiltonian", "degree", "wanted"),
    [
        ("(p1^2 + q1^2)/2 + (p2^2 + 2*q2^2)/2", 2, ["p1^2 + q1^2"]),
        ("(p1^2 + q1^2)/2 + (p2^2 + 2*q2^2)/2 + q1^4", 4, ["p2^2 + 2*q2^2"]),
        ("p1^2/2 + q1^4 + p2^2/2 + q2^4 + q2^6", 4, ["p1^2 + 2*q1^4"]),
        ("p1^2/2 + q1^4 + p2^2/2 + q2^4 + q2^6", 3, []),
    ],
)
def test_parts_of_a_separable_energy_are_integrals(hamiltonian, degree, wanted):
    system = lp.System(lp.canonical(names=("q1", "q2"), momenta=("p1", "p2")), hamiltonian)
    found = first_integrals(system, degree=degree)
    assert found.complete
    assert [sp.expand(f.expression - system.expression(w)) for f, w in zip(found.found, wanted, strict=True)] == [
        0 for _ in wanted
    ]
    assert all(f.is_independent for f in found.found)


def test_parts_by_weight():
    x = lp.canonical(names=("q1", "q2"))
    system = lp.System(x, "p_q1^2/2 + q1^4 + p_q2^2/2 + 3*q2^4")
    for weight, n in ((2, 0), (4, 1), (5, 0)):
        found = first_integrals(system, weight=weight)
        assert (found.complete, len(found.found)) == (True, n)


def test_momenta_of_symmetric_tops_are_found_as_they_are():
    found = first_integrals(entry("twisted-lagrange"), degree=2)
    assert [str(f.expression) for f in found.found] == ["l3", "alpha1*l1 + alpha2*l2 + alpha3*l3 + beta3"]


def test_the_toda_lattice_has_a_cubic_integral():
    system = toda()
    found = first_integrals(system, degree=3)
    a1, a2, b1, b2, b3 = system.variables
    assert [f.expression for f in found.found] == [a1**2 * b3 + a2**2 * b1 - b1 * b2 * b3]


def test_a_partial_integral_is_found_on_its_level_and_nowhere_else():
    system = entry("goryachev-chaplygin")
    claimed, level = system.partial_integrals["G"]
    found = first_integrals(system, degree=3, on=("C1",))
    assert found.on == (level,)
    assert [sp.expand(claimed - f.expression) for f in found.found] == [0]
    assert found.complete
    assert not first_integrals(system, degree=3).found


def test_an_inhomogeneous_level():
    """On C2 = 1 polynomials are counted modulo |alpha|^2 - 1: 27 monomials less alpha_3^2, and no integral is new."""
    found = first_integrals(entry("kovalevskaya"), degree=2, on="C2 = 1")
    assert not found.found
    assert found.complete
    assert found.n_integrals == 2  # H and C1


@pytest.mark.thorough
@pytest.mark.parametrize("weight", range(1, 13))
def test_the_twisted_kovalevskaya_top_has_no_integral_up_to_weight_12(weight):
    found = first_integrals(lp.Top.twisted_kovalevskaya(), weight=weight)
    assert found.weights == (1, 1, 1, 2, 2, 2, 3, 3, 3)
    assert not found.found
    assert found.complete
    # the products of H, C1, C2, C3, of weights 2, 4, 5, 6
    s = sp.Symbol("s")
    count = sp.series(1 / ((1 - s**2) * (1 - s**4) * (1 - s**5) * (1 - s**6)), s, 0, weight + 1).removeO()
    assert found.n_integrals == count.coeff(s, weight)


@pytest.mark.parametrize(("epsilon", "integrals"), [(0, ["alpha1*l1 + alpha2*l2 + alpha3*l3"]), (1, [])])
def test_other_moments_than_those_of_kovalevskaya(epsilon, integrals):
    """Of the heavy top only l.alpha is constant, which is no Casimir among nine coordinates."""
    found = first_integrals(lp.Top(inertia=(1, 1, 2), a=(-1, 0, 0), epsilon=epsilon), degree=4)
    assert list(found.known) == ["H", "C1", "C2", "C3"]
    assert [str(f.expression) for f in found.found] == integrals
    assert found.complete


def test_a_generic_top_has_no_integral_up_to_degree_6():
    found = first_integrals(TOP, degree=6)
    assert (found.n_monomials, found.n_blocks, found.found, found.complete) == (5004, 1, (), True)
    assert found.n_integrals == 34  # products of one to three of H, C1, C2, C3


def test_parameters_that_are_symbols_are_generic():
    found = first_integrals(entry("twisted-top"), degree=2)
    assert set(found.parameters) == {"I1", "I2", "I3", "a1", "a2", "a3", "b1", "b2", "b3", "epsilon"}
    assert not found.found
    assert "for generic" in found.scope


def test_parts_of_known_integrals_are_not_known():
    """2 H - C1 = l3^2 + 2 l3 is a polynomial in l3, but l3 is none in H and C1, although the equations have a grading
    with weights (1, 1, 0), in which the parts of H and C1 are integrals.
    """
    gyrostat = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + l2^2 + 2*l3^2)/2 + l3", name="gyrostat")
    for degree in (1, 2, 3):
        found = first_integrals(gyrostat, degree=degree)
        assert [(str(f.expression), f.is_independent) for f in found.found] == [("l3", False)]
        assert found.complete


def test_known_integrals_are_left_out():
    system = entry("clebsch")
    assert first_integrals(system, degree=2).found
    known = {"H": system.hamiltonian, "C1": "C1", "C2": "C2", "K": system.integrals["K"]}
    assert not first_integrals(system, degree=2, known=known).found


def test_an_integral_that_depends_on_others_is_marked():
    """With only the square of an integral known, the integral itself is new but not independent."""
    system = entry("twisted-lagrange")
    found = first_integrals(system, degree=1, known={"square": "l3^2"})
    assert [(str(f.expression), f.is_independent) for f in found.found] == [("l3", False)]


def test_irrational_coefficients():
    top = lp.Top(inertia=(1, 1, "sqrt(2)"), a=(0, 0, "sqrt(3)"), epsilon="sqrt(2)")
    found = first_integrals(top, degree=2)
    assert found.complete
    assert len(found.independent) == 2
    assert all(sp.simplify(sp.expand(top.derivative(f.expression))) == 0 for f in found.found)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: first_integrals(lp.System(lp.canonical(2), "dot(p, p)/2 + q1*log(q2)")),
            "wanted a polynomial in q1, q2, p1, p2",
        ),
        (lambda: first_integrals(entry("clebsch"), degree=40), "degree: wanted at most 16"),
        (lambda: first_integrals(entry("clebsch"), degree=0), "degree"),
        (lambda: first_integrals(entry("clebsch"), degree=2, weight=2), "got both"),
        (lambda: first_integrals(entry("henon-heiles"), weight=4), "homogeneous for positive weights"),
        (lambda: first_integrals(entry("kovalevskaya"), weight=400), "weight: wanted at most"),
        (lambda: first_integrals(entry("clebsch"), known={"x": "m1"}), "known: wanted integrals; got x = m1"),
        (lambda: first_integrals(entry("clebsch"), on="m1"), "orbits do not leave"),
        (lambda: first_integrals(entry("clebsch"), on=("C1 = 0", "C1 = 1")), "contradict each other"),
    ],
)
def test_what_cannot_be_searched_is_refused(call, words):
    with pytest.raises(ParameterError, match=words.replace("(", r"\(")):
        call()


def test_what_is_printed():
    found = first_integrals(entry("kovalevskaya"), weight=4)
    assert repr(found) == "<FirstIntegrals of kovalevskaya: 1 new integral among polynomials of weight 4>"
    lines = str(found).splitlines()
    assert lines[1] == "known: H, C1, C2"
    assert lines[2].startswith("F1 = ")
    assert sp.expand(entry("kovalevskaya").expression(lines[2][5:]) - found.found[0].expression) == 0
    assert "Every other one is a polynomial in these" in lines[3]


PRIME = 2**61 - 1


@pytest.mark.parametrize(
    "coefficients",
    [
        # log 6 = log 2 + log 3, sin^2 + cos^2 = 1, cosh^2 - sinh^2 = 1, 4 atan(1/5) - atan(1/239) = pi/4 (Machin): the
        # moments of l1 and l2 are equal, l3 is an integral
        ("log(6)", "log(2) + log(3)"),
        ("sin(1)^2 + cos(1)^2", "1"),
        ("cosh(1)^2 - sinh(1)^2", "1"),
        ("4*atan(1/5) - atan(1/239)", "pi/4"),
    ],
)
def test_nothing_is_proved_where_relations_between_numbers_may_hide(coefficients):
    first, second = coefficients
    system = lp.System(lp.so(3) @ lp.semidirect(2), f"({first})*l1^2 + ({second})*l2^2 + 3*l3^2 + alpha3")
    for search in (lp.integrability.first_integrals, lp.integrability.integrability_report):
        with pytest.raises(ParameterError, match=r"relations may hide.* Write a symbol for each"):
            search(system, degree=1)
    family = lp.System(
        lp.so(3) @ lp.semidirect(2), f"J*({first})*l1^2 + ({second})*l2^2 + l3^2 + alpha3", symbols=["J"]
    )
    with pytest.raises(ParameterError, match="relations may hide"):
        lp.integrability.integrable_families(family, degree=1)


def test_one_transcendental_number_is_no_parameter():
    bracket = lp.so(3) @ lp.semidirect(2)
    found = first_integrals(lp.System(bracket, "pi*(l1^2 + l2^2) + 3*l3^2 + alpha3"), degree=1)
    assert ([str(f.expression) for f in found.found], found.complete, found.parameters) == (["l3"], True, ())
    with pytest.raises(ParameterError, match="rational numbers"):
        lp.integrability.integrable_families(lp.System(bracket, "pi*l1^2 + J*l2^2 + alpha3", symbols=["J"]), degree=1)


@pytest.mark.parametrize(
    ("hamiltonian", "n"),
    [
        # separable: the energy of each coordinate, and H is their sum
        (f"p1^2/2 + p2^2/2 + q1^2/{PRIME} + q2^2", 1),
        (f"p1^2/2 + p2^2/2 + {PRIME}*q1^2 + q2^2", 1),
        # modulo the prime it separates, in fact it does not
        (f"p1^2/2 + p2^2/2 + {PRIME}*q1^2*q2 + q1^2 + q2^2", 0),
    ],
)
def test_coefficients_that_vanish_modulo_a_prime(hamiltonian, n):
    system = lp.System(lp.canonical(2), hamiltonian)
    found = first_integrals(system, degree=2)
    assert (found.complete, len(found.found)) == (True, n)
    assert found.prime != PRIME
    assert lp.integrability.integrability_report(system, degree=2).verdict == (
        "integrable" if n else "no further polynomial integral"
    )


def test_nothing_is_proved_where_a_difference_of_coefficients_vanishes_modulo_the_prime():
    """The angular momentum is an integral modulo the prime only; the energy of a coordinate, which is one, is found."""
    system = lp.System(lp.canonical(2), f"p1^2/2 + p2^2/2 + {PRIME + 1}*q1^2 + q2^2")
    found = first_integrals(system, degree=2)
    assert (found.complete, len(found.found)) == (False, 1)
    assert lp.integrability.integrability_report(system, degree=2).verdict == "integrable"


def test_what_is_not_proved_is_said_everywhere():
    found = replace(first_integrals(lp.catalog.system("henon-heiles"), degree=2), complete=False)
    assert "no others" not in str(found)
    assert "incomplete" in str(found)
    assert "incomplete" in repr(found)
    assert any("incomplete" in line for line in latex_lines(found))
    assert search_record(found)["complete"] is False


@pytest.mark.parametrize("name", ["H", "C1 - 1", "C2-1", "C2 = H", "2*C1 + l1 - l1 = K"])
def test_levels_name_the_invariants(name):
    system = lp.catalog.system("kovalevskaya")
    zeros = zeros_on_level(system, name)
    known = system.invariants
    left, _, right = name.partition("=")
    names = {sp.Symbol(n): f for n, f in known.items()}
    assert sp.expand(zeros[0] - (sp.sympify(left, {}) - sp.sympify(right or "0", {})).xreplace(names)) == 0


@pytest.mark.parametrize("equation", ["0 = 0", "C1 = C1", "l1 - l1"])
def test_equations_that_hold_everywhere_are_refused(equation):
    with pytest.raises(ParameterError, match="holds everywhere"):
        first_integrals(lp.catalog.system("kovalevskaya"), on=equation)


def test_names_of_integrals_are_not_given_twice():
    found = first_integrals(lp.catalog.system("kovalevskaya"), degree=2, known={"F1": "H"})
    assert [f.name for f in found.found] == ["F2", "F3"]
    with pytest.raises(ParameterError, match="the name of an integral"):
        first_integrals(lp.catalog.system("kovalevskaya"), degree=2, known={"F\n1": "H"})


def test_parts_of_known_integrals_are_not_listed_twice():
    # H = l2 + (l1^2 + l3^2) and C1 = l2^2 + (l1^2 + l3^2) fall into parts: l2 and H give all of them
    found = first_integrals(lp.System(lp.so(3) @ lp.trivial(), "l3^2 + l2 + l1^2"), degree=2)
    assert [str(f.expression) for f in found.found] == ["l2"]


@pytest.mark.parametrize("scope", [{"degree": 10**9}, {"weight": 10**9}])
def test_sizes_without_end_are_refused_at_once(scope):
    with pytest.raises(ParameterError, match="wanted at most"):
        first_integrals(entry("kovalevskaya"), **scope)
