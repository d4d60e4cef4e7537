"""First integrals: those of the literature are found without a hint, and where there are none it is proved."""

import pytest
import sympy as sp
from searched_systems import TOP

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability.search_problem import zeros_on_level

first_integrals = lp.integrability.first_integrals
entry = lp.catalog.system


@pytest.mark.thorough
@pytest.mark.parametrize("weight", [4, 11, 12])
def test_the_twisted_kovalevskaya_top_has_no_integral_up_to_weight_12(weight):
    found = first_integrals(lp.Top.twisted_kovalevskaya(), weight=weight)
    assert found.weights == (1, 1, 1, 2, 2, 2, 3, 3, 3)
    assert not found.found
    assert found.complete
    # the products of H, C1, C2, C3, of weights 2, 4, 5, 6
    s = sp.Symbol("s")
    count = sp.series(1 / ((1 - s**2) * (1 - s**4) * (1 - s**5) * (1 - s**6)), s, 0, weight + 1).removeO()
    assert found.n_integrals == count.coeff(s, weight)


def test_a_generic_top_has_no_integral_up_to_degree_6():
    found = first_integrals(TOP, degree=6)
    assert (found.n_monomials, found.n_blocks, found.found, found.complete) == (5004, 1, (), True)
    assert found.n_integrals == 34  # products of one to three of H, C1, C2, C3


def test_an_integral_that_depends_on_others_is_marked():
    """With only the square of an integral known, the integral itself is new but not independent."""
    system = entry("twisted-lagrange")
    found = first_integrals(system, degree=1, known={"square": "l3^2"})
    assert [(str(f.expression), f.is_independent) for f in found.found] == [("l3", False)]


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
        (lambda: first_integrals(entry("kovalevskaya"), weight=10**9), "weight: wanted at most"),
        (lambda: first_integrals(entry("kovalevskaya"), on="C1 = C1"), "holds everywhere"),
        (lambda: first_integrals(entry("kovalevskaya"), known={"F\n1": "H"}), "the name of an integral"),
        (lambda: first_integrals(entry("clebsch"), known={"x": "m1"}), "known: wanted integrals; got x = m1"),
        (lambda: first_integrals(entry("clebsch"), on="m1"), "orbits do not leave"),
        (lambda: first_integrals(entry("clebsch"), on=("C1 = 0", "C1 = 1")), "contradict each other"),
    ],
)
def test_what_cannot_be_searched_is_refused(call, words):
    with pytest.raises(ParameterError, match=words.replace("(", r"\(")):
        call()


PRIME = 2**61 - 1


@pytest.mark.parametrize(
    "coefficients",
    [
        ("log(6)", "log(2) + log(3)"),
        ("4*atan(1/5) - atan(1/239)", "pi/4"),  # Machin
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


@pytest.mark.parametrize("name", ["C2-1", "2*C1 + l1 - l1 = K"])
def test_levels_name_the_invariants(name):
    system = lp.catalog.system("kovalevskaya")
    zeros = zeros_on_level(system, name)
    known = system.invariants
    left, _, right = name.partition("=")
    names = {sp.Symbol(n): f for n, f in known.items()}
    assert sp.expand(zeros[0] - (sp.sympify(left, {}) - sp.sympify(right or "0", {})).xreplace(names)) == 0
