"""Functions that are, or are not, Casimirs; those that a caller gives; the plus bracket."""

import pickle
from random import Random

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import BracketError, ExpressionError, ParameterError

TOP = lp.so(3) @ lp.leibniz(3, "epsilon")
SPIRAL = lp.algebras.bianchi("IV") @ lp.trivial()  # {l1, l2} = l2 - l3, {l1, l3} = l3
EXPONENTIAL = "l3*exp(l2/l3)"  # {l1, .} = l3 exp + l3 exp ((l2 - l3)/l3 - l2/l3) = 0


@pytest.mark.parametrize(
    ("bracket", "function", "holds"),
    [
        (TOP, "dot(alpha, alpha) + 2*epsilon*dot(l, beta)", True),
        (TOP, "dot(alpha, alpha) + epsilon*dot(l, beta)", False),
        (TOP, "dot(beta, beta)/dot(alpha, beta)^2", True),
        (TOP, "dot(beta, l)", False),
        (TOP, "7", True),
        (SPIRAL, EXPONENTIAL, True),
        (SPIRAL, "l3*exp(-l2/l3)", False),
        (lp.algebras.bianchi("VII") @ lp.trivial(), "sqrt(l2^2 + l3^2)", True),
        (lp.PoissonTensor(["x", "y"], {}), "sin(x)*y", True),
        (lp.PoissonTensor(["x", "y", "z"], {("x", "y"): "x*y", ("y", "z"): "y*z", ("z", "x"): "z*x"}), "x*y*z", True),
        (lp.PoissonTensor(["x", "y", "z"], {("x", "y"): "x*y", ("y", "z"): "y*z", ("z", "x"): "z*x"}), "x*y/z", False),
        (lp.canonical(2), "q1 - q2", False),
        (lp.algebras.bianchi("V") @ lp.trivial(), "(l2 - l3)/(l2 + l3)", True),
    ],
)
def test_functions_are_decided_exactly(bracket, function, holds):
    certificate = bracket.casimir_certificate(function)
    assert (certificate.holds, bracket.is_casimir(function)) == (holds, holds)
    for name, residual in certificate.residual.items():
        x = bracket.variables[bracket.coordinate_names_in_order.index(name)]
        assert sp.simplify(bracket(x, certificate.function) - residual) == 0
    if holds or function in {"q1 - q2", "dot(beta, l)", "x*y/z"}:
        assert certificate.proved
    assert certificate.holds is not bool(certificate.residual)


@pytest.mark.thorough
def test_what_hides_relations_is_tried_at_points_and_says_so():
    """log(2 x) - log(x) is a constant, which rational functions of the two logarithms do not know."""
    bracket = lp.so(3) @ lp.trivial()
    hidden = sp.log(2 * bracket.variables[0]) - sp.log(bracket.variables[0])
    r, u = sp.sqrt(sum(x**2 for x in bracket.variables)), bracket.variables[0] ** 2
    for one in (hidden, sp.sqrt(r**2 + u) * sp.sqrt(r**2 - u) - sp.sqrt((r**2 + u) * (r**2 - u))):
        certificate = bracket.casimir_certificate(one)
        assert certificate.holds
        assert certificate.proved or "tried at" in certificate.method
    wrong = bracket.casimir_certificate(sp.sqrt(r**2 + u) * sp.sqrt(r**2 - u))
    assert not wrong.holds


@pytest.mark.parametrize("seed", range(5))
def test_a_function_of_casimirs_is_one_and_a_disturbed_one_is_none(seed):
    random = Random(seed)
    bracket = random.choice([TOP.substitute({"epsilon": 2}), lp.so(4) @ lp.trivial(), lp.algebras.se(3) @ lp.trivial()])
    casimirs = bracket.casimirs()
    f = sum(random.randint(1, 5) * c ** random.randint(1, 2) for c in casimirs) / (1 + casimirs[0] ** 2)
    assert bracket.is_casimir(f)
    assert bracket.is_casimir(sp.exp(f))
    assert not bracket.is_casimir(f + random.choice(bracket.variables))


def test_given_casimirs_complete_those_that_are_found():
    known = SPIRAL.with_casimirs({"C": EXPONENTIAL})
    assert [str(c) for c in known.casimirs()] == ["l3*exp(l2/l3)"]
    assert (SPIRAL.n_unknown_casimirs, known.n_unknown_casimirs) == (1, 0)
    report = known.casimir_report()
    assert (report.complete, report.verified, report.method) == (True, True, "given")
    assert pickle.loads(pickle.dumps(known)).casimirs() == known.casimirs()
    assert [str(c) for c in known.rename("m").casimirs()] == ["m3*exp(m2/m3)"]
    other = lp.brackets.Bracket(lp.algebras.bianchi("IV"), lp.trivial(), casimirs=[EXPONENTIAL])
    assert other.casimirs() == known.casimirs()
    sums = (lp.algebras.bianchi("IV") + lp.so(3)) @ lp.trivial()
    found = sums.with_casimirs([EXPONENTIAL]).casimirs()
    assert [str(c) for c in found] == ["l3*exp(l2/l3)", "l4**2 + l5**2 + l6**2"]


def test_a_given_casimir_is_kept_along_orbits_and_in_files(tmp_path):
    system = lp.System(SPIRAL.with_casimirs([EXPONENTIAL]), "(l1^2 + 2*l2^2 + l3^2)/2")
    run = lp.integrate(system, [1.0, 0.2, 0.5], t_end=3)
    values = [x[2] * np.exp(x[1] / x[2]) for x in ([1.0, 0.2, 0.5], run.end_state[0])]
    assert values[1] == pytest.approx(values[0], rel=1e-12)
    path = tmp_path / "spiral.toml"
    path.write_text(system.text, encoding="utf-8")
    again = lp.read_system(path)
    assert again.bracket.casimirs() == system.bracket.casimirs()


def test_parameters_of_given_casimirs_are_substituted():
    bracket = lp.algebras.bianchi("VI", "a") @ lp.trivial()  # l2 + l3 and l3 - l2 have the weights a + 1 and a - 1
    known = bracket.with_casimirs(["(a - 1)*log(l2 + l3) - (a + 1)*log(l3 - l2)"])
    assert known.n_unknown_casimirs == 0
    assert known.substitute({"a": 0}).is_casimir(known.substitute({"a": 0}).casimirs()[0])


def test_the_plus_bracket_has_the_other_sign_and_the_same_casimirs():
    for bracket in (TOP, lp.algebras.se(3) @ lp.semidirect(2), SPIRAL.with_casimirs([EXPONENTIAL])):
        plus = bracket.plus()
        assert plus.poisson_tensor() == -bracket.poisson_tensor()
        assert plus.jacobi_certificate().holds
        assert all(plus.is_casimir(c) for c in bracket.casimirs())
        assert plus.plus().poisson_tensor() == bracket.poisson_tensor()
    affine = (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): "k"}).plus()
    assert str(affine(*affine.variables[:2])) == "k + l3"


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: TOP.with_casimirs(["dot(l, l)"]), BracketError, r"J grad C = 0; got .* is no Casimir: \{"),
        (
            lambda: lp.PoissonTensor(["x", "y"], {("x", "y"): "x"}, casimirs=["y"]),
            BracketError,
            r"is no Casimir: \{x, ",
        ),
        (lambda: TOP.with_casimirs(["3"]), BracketError, "depend on the coordinates; got 3"),
        (lambda: TOP.with_casimirs("dot(l, l)"), ParameterError, "casimirs must be a list of functions"),
        (lambda: TOP.is_casimir("dot(l, k)"), ExpressionError, "k"),
        (lambda: TOP.is_casimir("k*beta1", symbols="k"), ParameterError, "symbols"),
        (lambda: TOP.is_casimir(sp.Symbol("L1")), ParameterError, "like l1 and none"),
        (lambda: TOP.is_casimir(None), ParameterError, "function on phase space"),
        (lambda: lp.PoissonTensor(["x", "y"], {("x", "y"): "exp(x)"}).plus(), BracketError, "given by a Lie algebra"),
    ],
)
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()
