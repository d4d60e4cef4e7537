"""The theorem: both arithmetics accept what is shipped, both refuse every control, and agree within their margins."""

import copy
import json
import random
from fractions import Fraction
from math import prod

import pytest

import liepoisson as lp
from liepoisson.algebra.sparse_polynomials import along
from liepoisson.errors import CertificateError, LiePoissonError, MissingFileError, ParameterError
from liepoisson.proofs.certificate import read_certificate
from liepoisson.proofs.interval_checker import check_in_intervals
from liepoisson.proofs.polynomial_field import polynomial_field
from liepoisson.proofs.theorem import is_regular, keeps_bracket


def test_the_printed_equations_are_those_of_the_paper(twisted):
    """Equations (4) to (6): l' = l x omega + alpha x a, alpha' = alpha x omega + eps beta x a, beta' = beta x omega,
    with omega = (l1/2, l2/2, l3), a = (-1, 0, 0), b = 0 and eps = 1, written out by hand.
    """
    assert twisted.equations == (
        "dl1/dt = l2*l3/2",
        "dl2/dt = -alpha3 - l1*l3/2",
        "dl3/dt = alpha2",
        "dalpha1/dt = alpha2*l3 - alpha3*l2/2",
        "dalpha2/dt = alpha3*l1/2 - alpha1*l3 - beta3",
        "dalpha3/dt = alpha1*l2/2 + beta2 - alpha2*l1/2",
        "dbeta1/dt = beta2*l3 - beta3*l2/2",
        "dbeta2/dt = beta3*l1/2 - beta1*l3",
        "dbeta3/dt = beta1*l2/2 - beta2*l1/2",
    )
    rng = random.Random(2)
    for _ in range(5):
        l, alpha, beta = ([Fraction(rng.randint(-9, 9), 7) for _ in range(3)] for _ in range(3))
        omega, a = [l[0] / 2, l[1] / 2, l[2]], [Fraction(-1), Fraction(0), Fraction(0)]
        wanted = [
            *map(sum, zip(cross(l, omega), cross(alpha, a), strict=True)),
            *map(sum, zip(cross(alpha, omega), cross(beta, a), strict=True)),
            *cross(beta, omega),
        ]
        assert [value(rate, [*l, *alpha, *beta]) for rate in twisted.rates] == wanted


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def value(terms, x):
    total = Fraction(0)
    for exponents, coefficient in terms.items():
        total += coefficient * prod((v**e for v, e in zip(x, exponents, strict=True)), start=Fraction(1))
    return total


def test_the_level_is_regular_and_a_critical_one_is_not(twisted):
    level = {"H": Fraction(1, 2), "C1": Fraction(1), "C2": Fraction(1, 2), "C3": Fraction(1)}
    assert is_regular(twisted, level)
    # l = 0, alpha = (x, 0, 0), beta = (1, 0, 0) is an equilibrium: l' = 0, alpha' = beta x a = 0
    critical = {"H": Fraction(-3), "C1": Fraction(9), "C2": Fraction(3), "C3": Fraction(1)}
    assert not is_regular(twisted, critical)


def test_constants_of_motion_have_no_rate_and_others_have_theirs(twisted):
    assert not any(along(f, twisted.rates) for f in twisted.constants.values())
    alpha_squared = {tuple(2 * (k == i) for k in range(9)): Fraction(1) for i in (3, 4, 5)}
    # d|alpha|^2/dt = 2 alpha.(beta x a) = 2 (beta2 alpha3 - beta3 alpha2) for a = (-1, 0, 0)
    products = [((4, 8), -2), ((5, 7), 2)]
    wanted = {tuple(int(k in pair) for k in range(9)): Fraction(c) for pair, c in products}
    assert along(alpha_squared, twisted.rates) == wanted


def test_a_rotation_keeps_the_bracket_and_a_reverser_does_not():
    bracket = lp.Top.twisted_kovalevskaya().bracket
    assert keeps_bracket(bracket, [1, -1, -1] * 3)
    assert not keeps_bracket(bracket, [1, -1, 1] * 3)
    assert not keeps_bracket(bracket, [1, -1, -1] * 2)
    # l1 and l2 do not commute, and a rotation by pi about the first axis changes the sign of one of them
    assert not keeps_bracket(bracket.with_constant({("l1", "l2"): 1}), [1, -1, -1] * 3)


def test_a_symmetry_that_does_not_keep_the_bracket_is_refused(altered, monkeypatch):
    monkeypatch.setattr("liepoisson.proofs.theorem.keeps_bracket", lambda bracket, signs: False)
    with pytest.raises(CertificateError, match="does not keep the bracket"):
        lp.proofs.prove_chaos(lp.Top.twisted_kovalevskaya(), read_certificate(altered), arithmetics=["intervals"])


def test_intervals_accept_what_is_shipped(shipped, twisted):
    margins = check_in_intervals(read_certificate(shipped), twisted)
    assert margins.expansion > 1.2
    assert margins.contraction < 0.9
    assert 0.0479 < margins.entropy < 0.0481
    first, second = margins.rotations
    assert first.lower < 0.716818090706 < first.upper < second.lower < 0.716818103117 < second.upper


def test_the_theorem_is_printed_with_its_margins():
    proof = lp.proofs.prove_chaos(lp.Top.twisted_kovalevskaya(), arithmetics=["intervals"])
    text = str(proof)
    assert "entropy of the flow is greater than 0.0480" in text
    assert "dalpha2/dt = alpha3*l1/2 - alpha1*l3 - beta3" in text
    assert "Not proved" in text
    assert "The level is regular" in text


@pytest.mark.slow
def test_both_arithmetics_accept_what_is_shipped():
    proof = lp.proofs.prove_chaos(lp.Top.twisted_kovalevskaya())
    assert [m.arithmetic for m in proof.margins] == ["intervals", "Arb balls"]
    first, second = proof.margins
    assert first.rotations[0].upper < second.rotations[1].lower


def test_what_cannot_be_proved_is_refused(tmp_path, altered):
    with pytest.raises(CertificateError, match="no certificate is shipped"):
        lp.proofs.prove_chaos(lp.Top.kovalevskaya())
    with pytest.raises(MissingFileError):
        lp.proofs.prove_chaos(lp.Top.twisted_kovalevskaya(), tmp_path / "none.json")
    with pytest.raises(ParameterError, match="arithmetics"):
        lp.proofs.prove_chaos(lp.Top.twisted_kovalevskaya(), arithmetics=["doubles"])
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(altered))
    with pytest.raises(CertificateError, match="another system"):
        lp.proofs.prove_chaos(lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), epsilon="0.999"), path)


def test_random_alterations_that_are_accepted_do_not_move_the_margins(shipped, twisted):
    """Alterations far below the size of the sets are accepted, large ones are refused; 12 of each, seed 3."""
    rng = random.Random(3)
    for size, accepted in ((1e-13, True), (1e-2, False)):
        for _ in range(3):
            data = copy.deepcopy(shipped)
            center = data["sets"][rng.randrange(27)]["center"]
            place = rng.choice([k for k in range(9) if float.fromhex(center[k])])
            center[place] = (float.fromhex(center[place]) + size).hex()
            if accepted:
                assert check_in_intervals(read_certificate(data), twisted).expansion > 1.2
            else:
                with pytest.raises(LiePoissonError):
                    check_in_intervals(read_certificate(data), twisted)


@pytest.mark.parametrize("constant", ["H", "C1", "C2", "C3"])
def test_a_level_that_is_changed_a_little_is_refused(altered, twisted, constant):
    altered["level"][constant] = str(Fraction(altered["level"][constant]) + Fraction(1, 10**6))
    with pytest.raises(LiePoissonError, match="not on the level"):
        check_in_intervals(read_certificate(altered), twisted)


def test_a_center_off_the_level_is_refused(altered, twisted):
    center = altered["sets"][5]["center"]
    center[0] = (float.fromhex(center[0]) + 1e-9).hex()
    with pytest.raises(LiePoissonError, match="not on the level"):
        check_in_intervals(read_certificate(altered), twisted)


def test_systems_with_other_numbers_are_refused():
    with pytest.raises(ParameterError, match="rational"):
        polynomial_field(lp.Top(inertia=("sqrt(2)", 2, 1), a=(-1, 0, 0), epsilon=1))
