from fractions import Fraction

import pytest
import sympy as sp

from liepoisson.algebra.coefficients import Coefficients

s, t = sp.symbols("s t")
VALUES = {
    "rational": [Fraction(1, 2), Fraction(-3)],
    "over pi": [sp.sin(2 * sp.pi / 7) / sp.pi, 3 / sp.pi],
    "roots": [sp.sqrt(2), sp.sqrt(3) + 1],
    "cube roots": [sp.cbrt(2), sp.cbrt(4) + 1],
    "symbols": [s, (s + t) / (s - 1)],
    "roots and symbols": [sp.sqrt(2) * s, t],
    "other": [sp.cbrt(2), sp.log(3)],
}
UNDECIDED = {"other"}


@pytest.mark.parametrize("name", VALUES)
def test_values_are_read_and_written_back(name):
    values = VALUES[name]
    field = Coefficients.containing(values)
    a, b = (field.read(value) for value in values)
    for value in values:
        assert sp.simplify(field.to_sympy(field.read(value), 1) - value) == 0
    assert sp.simplify(field.to_sympy(a * b + a * a, 2) - (values[0] * values[1] + values[0] ** 2)) == 0
    assert sp.simplify(field.to_sympy(a / b) - sp.sympify(values[0]) / values[1]) == 0
    assert field.vanishes(a * b - b * a)
    assert not field.vanishes(a - b)
    assert field.decides == (name not in UNDECIDED)


@pytest.mark.parametrize("name", VALUES)
def test_rational_numbers_are_in_every_field(name):
    field = Coefficients.containing(VALUES[name])
    assert field.to_sympy(field.number(Fraction(2, 3))) == sp.Rational(2, 3)
    assert field.to_sympy(field.one) == 1
    assert not field.number(0)


def test_rational_values_are_fractions_however_they_are_given():
    field = Coefficients.containing([Fraction(1, 3), sp.Rational(1, 2)])
    assert field.is_rational
    assert field.read(sp.Rational(1, 2)) == Fraction(1, 2)
    assert isinstance(field.write(field.read(sp.Integer(2))), Fraction)


def test_a_common_power_of_pi_is_set_aside():
    field = Coefficients.containing([sp.sqrt(2) / sp.pi**2, sp.S.Zero, 1 / sp.pi**2])
    assert field.is_cyclotomic
    assert field.scale == sp.pi**-2
    root = field.read(sp.sqrt(2) / sp.pi**2)
    assert field.to_sympy(root * root, 2) == 2 / sp.pi**4
    assert field.to_sympy(root * root) == 2


def test_different_powers_of_pi_stay_apart():
    field = Coefficients.containing([sp.pi, sp.S.One])
    assert not field.is_cyclotomic
    assert field.to_sympy(field.read(sp.pi) * field.read(sp.pi) - field.one) == sp.pi**2 - 1


def test_symbols_are_parameters():
    assert set(Coefficients.containing(VALUES["roots and symbols"]).parameters) == {s, t}
    assert Coefficients.containing(VALUES["roots"]).parameters == ()
    assert Coefficients().parameters == ()


def test_hidden_relations_vanish():
    field = Coefficients.containing([sp.sin(s), sp.cos(s)])
    sine, cosine = field.read(sp.sin(s)), field.read(sp.cos(s))
    assert not field.decides
    assert field.vanishes(sine * sine + cosine * cosine - field.one)
    assert not field.vanishes(sine * sine - cosine * cosine)


def test_hidden_relations_between_numbers_vanish():
    # log 6 = log 2 + log 3, three independent generators for SymPy.
    field = Coefficients.containing([sp.log(2), sp.log(3), sp.log(6)])
    two, three, six = (field.read(sp.log(n)) for n in (2, 3, 6))
    assert not field.decides
    assert field.vanishes(six - two - three)
    assert not field.vanishes(six - two)


@pytest.mark.parametrize("number", [sp.pi, sp.E, sp.log(2), sp.sin(1), sp.exp(2), sp.atan(sp.Rational(1, 5))])
def test_one_transcendental_number_has_no_hidden_relations(number):
    # Hermite and Lindemann: it satisfies no algebraic equation, so that Q(number) is a field of rational functions
    assert Coefficients.containing([number, sp.S.One]).decides
    assert Coefficients.containing([number, s]).decides


@pytest.mark.parametrize(
    "values", [[sp.pi, sp.E], [sp.E, sp.sqrt(sp.E)], [sp.EulerGamma], [sp.exp(s), s], [sp.zeta(3)]]
)
def test_numbers_of_which_less_is_known_are_not_decided(values):
    assert not Coefficients.containing([*values, sp.S.One]).decides


@pytest.mark.parametrize("name", ["rational", "over pi", "roots", "cube roots", "symbols"])
def test_each_prime_has_another_homomorphism(name):
    field = Coefficients.containing(VALUES[name])
    a, b = (field.read(value) for value in VALUES[name])
    images = [field.residues(seed=1, skipped=k) for k in range(3)]
    assert len({image.p for image in images}) == 3
    for image in images:
        assert image(a * b - a) == (image(a) * image(b) - image(a)) % image.p
