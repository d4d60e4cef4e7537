import cmath
import math

import pytest

from liepoisson.structure.lie.sine_algebra import sine_names
from liepoisson.structure.lie_algebras import sine, sine_energy, sine_modes


@pytest.mark.parametrize("N", [3, 5])
def test_the_addition_theorem_is_the_jacobi_identity_and_the_real_form_is_compact(N):
    algebra = sine(N)
    assert algebra.jacobi_residuals() == {}
    assert algebra.killing_signature() == (0, N * N - 1, 0)


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


def test_the_coordinates_are_named_after_their_mode():
    names = sine(5).basis_names
    assert names[:8] == ("c10", "s10", "c01", "s01", "c11", "s11", "c1m1", "s1m1")
    assert len(set(names)) == 24
    assert all(f"w{name}".isidentifier() for name in names)
    assert len(set(sine_names(21))) == 440
