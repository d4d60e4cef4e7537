import cmath
import math
from fractions import Fraction
from itertools import combinations

import pytest
import sympy as sp

from liepoisson.errors import ParameterError
from liepoisson.structure.lie.sine_algebra import sine_names
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import sine, sine_energy, sine_modes


@pytest.mark.parametrize("N", [3, 5, pytest.param(7, marks=pytest.mark.thorough)])
def test_the_addition_theorem_is_the_jacobi_identity(N):
    assert sine(N).jacobi_residuals() == {}


@pytest.mark.thorough
@pytest.mark.parametrize("N", [3, 5])
def test_a_wrong_sine_breaks_jacobi(N):
    brackets = sine(N).brackets
    for pair in list(brackets)[::101]:
        row = brackets[pair]
        k = min(row)
        for wrong in (-row[k], row[k] * sp.Rational(10**9 + 1, 10**9)):
            changed = {**brackets, pair: {**row, k: wrong}}
            assert LieAlgebra.from_brackets(N * N - 1, changed, check=False).jacobi_residuals()


def centred(n, N):
    return tuple((k + N // 2) % N - N // 2 for k in n)


def zeitlin(w, N):
    """The equation of Zeitlin (1991), w_n' = N/(2 pi) sum_k sin(2 pi (n x k)/N) w_(n+k) w_(-k)/|k|^2, as printed."""
    result = {}
    for n in w:
        terms = (
            math.sin(2 * math.pi * (n[0] * k[1] - n[1] * k[0]) / N)
            * w.get(centred((n[0] + k[0], n[1] + k[1]), N), 0)
            * w[centred((-k[0], -k[1]), N)]
            / (k[0] ** 2 + k[1] ** 2)
            for k in w
        )
        result[n] = N / (2 * math.pi) * sum(terms)
    return result


def velocity(algebra, x, gradient):
    """x_i' = -c_ij^k x_k dH/dx_j in floating point."""
    result = [0.0] * algebra.dimension
    for (i, j), row in algebra.brackets.items():
        for k, c in row.items():
            result[i] -= float(c) * x[k] * gradient[j]
            result[j] += float(c) * x[k] * gradient[i]
    return result


@pytest.mark.parametrize("N", [3, 5])
def test_the_coordinates_obey_the_equation_of_zeitlin(N):
    modes = sine_modes(N)
    x = [math.cos(1.0 + 3 * i * i) for i in range(N * N - 1)]
    w = {}
    for r, (n1, n2) in enumerate(modes):
        w[n1, n2] = complex(x[2 * r], x[2 * r + 1])
        w[-n1, -n2] = w[n1, n2].conjugate()
    expected = zeitlin(w, N)
    found = velocity(sine(N), x, [2 * float(h) * v for h, v in zip(sine_energy(N), x, strict=True)])
    for r, mode in enumerate(modes):
        assert cmath.isclose(complex(found[2 * r], found[2 * r + 1]), expected[mode], rel_tol=1e-12, abs_tol=1e-13)


def test_the_smallest_truncation_has_known_values():
    # w_(1,0) = 1, w_(0,1) = 1/2, w_(1,1) = 1/4: H = 1 + 1/4 + 1/32, and every sine is sqrt(3)/2 up to sign.
    assert sine_modes(3) == [(1, 0), (0, 1), (1, 1), (1, -1)]
    x = [Fraction(v) for v in (1, 0, "1/2", 0, "1/4", 0, 0, 0)]
    assert sum(h * v * v for h, v in zip(sine_energy(3), x, strict=True)) == Fraction(41, 32)
    gradient = [2 * h * v for h, v in zip(sine_energy(3), x, strict=True)]
    found = velocity(sine(3), [float(v) for v in x], [float(v) for v in gradient])
    # 3/(2 pi) sqrt(3)/2 = 0.41349667; the rates are 1/16, -1/8, 0 and 1/16 of it.
    scale = 3 / (2 * math.pi) * math.sqrt(3) / 2
    assert found[::2] == pytest.approx([scale / 16, -scale / 8, 0, scale / 16], abs=1e-15)
    assert found[::2] == pytest.approx([0.025843542, -0.0516870839, 0, 0.025843542], abs=1e-9)
    assert found[1::2] == pytest.approx([0] * 4, abs=1e-15)


@pytest.mark.parametrize("N", [3, 5])
def test_the_real_form_is_compact_and_keeps_the_enstrophy(N):
    algebra = sine(N)
    assert algebra.killing_signature() == (0, N * N - 1, 0)
    # The sum of squares is a Casimir iff c_ij^k = -c_ik^j.
    for i, j in combinations(range(algebra.dimension), 2):
        for k, c in algebra.brackets.get((i, j), {}).items():
            other = algebra.brackets[min(i, k), max(i, k)][j]
            assert c + (other if i < k else -other) == 0


def test_it_is_semisimple_of_rank_two_for_three():
    algebra = sine(3)
    assert algebra.is_semisimple
    assert [ideal.dimension for ideal in algebra.derived_series()] == [8]
    assert algebra.centre().dimension == 0


@pytest.mark.thorough
def test_the_mean_field_limit_is_the_ideal_fluid():
    # {w_m, w_n} -> (m x n) w_(m+n): for m = (1, 0), n = (0, 1) the constant of c_m, c_n along c_(m+n) tends to -1/2.
    def constant(N):
        place = {mode: 2 * r for r, mode in enumerate(sine_modes(N))}
        return float(sine(N).brackets[place[1, 0], place[0, 1]][place[1, 1]])

    errors = [abs(constant(N) + 0.5) for N in (3, 5, 9)]
    assert errors[0] > 2 * errors[1] > 4 * errors[2] > 0


def test_the_coordinates_are_named_after_their_mode():
    names = sine(5).basis_names
    assert names[:8] == ("c10", "s10", "c01", "s01", "c11", "s11", "c1m1", "s1m1")
    assert len(set(names)) == 24
    assert all(f"w{name}".isidentifier() for name in names)


def test_the_coordinates_of_large_truncations_stay_distinct():
    names = sine_names(21)
    assert names[:2] == ("c1_0", "s1_0")
    assert len(set(names)) == 440


@pytest.mark.thorough
@pytest.mark.parametrize("N", [3, 5, 11])
def test_there_are_few_distinct_constants(N):
    values = {c for row in sine(N).brackets.values() for c in row.values()}
    expected = {sign * sp.Rational(N, 4) * sp.sin(2 * sp.pi * k / N) / sp.pi for k in range(1, N) for sign in (1, -1)}
    assert values == expected
    assert len(values) == N - 1


@pytest.mark.parametrize("N", [2, 4, 10])
def test_even_truncations_are_refused(N):
    with pytest.raises(ParameterError, match=r"odd|>= 3"):
        sine(N)
