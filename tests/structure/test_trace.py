"""Traces stay traces: derivatives, values and printing without expanding."""

import pickle

import numpy as np
import pytest
import sympy as sp

from liepoisson.structure.extensions import leibniz, trivial
from liepoisson.structure.lie_algebras import gl, sine, so, su
from liepoisson.structure.trace import Trace, abbreviated


def matrix_su(n, x):
    """X_jk = s_jk - i a_jk off the diagonal, written down from the definition."""
    X = np.zeros((n, n), dtype=complex)
    pairs = [(j, k) for j in range(n) for k in range(j + 1, n)]
    for m, (j, k) in enumerate(pairs):
        X[j, k] = x[len(pairs) + m] - 1j * x[m]
        X[k, j] = X[j, k].conj()
    # h_k = (X_kk - X_k+1,k+1)/2 and a trace of zero
    diagonal = np.linalg.solve(np.vstack([np.eye(n)[:-1] - np.eye(n)[1:], np.ones(n)]), [*(2 * x[2 * len(pairs) :]), 0])
    return X + np.diag(diagonal)


def matrix_sine(N, x):
    """W = sum w_n T_n over all n, T_n = omega^(n1 n2/2) g^n1 h^n2 with omega = exp(4 pi i/N)."""
    from liepoisson.structure.lie_algebras import sine_modes

    omega = np.exp(4j * np.pi / N)
    h, g = np.diag(omega ** np.arange(N)), np.roll(np.eye(N), 1, axis=0)
    W = np.zeros((N, N), dtype=complex)
    for r, (n1, n2) in enumerate(sine_modes(N)):
        w = x[2 * r] + 1j * x[2 * r + 1]
        T = np.exp(2j * np.pi * n1 * n2 / N) * np.linalg.matrix_power(g, n1 % N) @ np.linalg.matrix_power(h, n2 % N)
        W += w * T + (w * T).conj().T
    return W


@pytest.mark.parametrize(
    ("algebra", "matrix"),
    [(su(3), lambda x: matrix_su(3, x)), (su(4), lambda x: matrix_su(4, x)), (sine(5), lambda x: matrix_sine(5, x))],
    ids=["su3", "su4", "sine5"],
)
def test_values_are_traces_of_powers(algebra, matrix):
    x = np.random.default_rng(1).standard_normal(algebra.dimension)
    X = matrix(x)
    assert np.allclose(X, X.conj().T)
    bracket = algebra @ trivial()
    traces = bracket.trace_casimirs.generators
    values = sp.lambdify(bracket.variables, list(traces))(*x)
    powers = [np.trace(np.linalg.matrix_power(X, trace.word.__len__())).real for trace in traces]
    np.testing.assert_allclose(values, powers, rtol=1e-12)


@pytest.mark.parametrize("algebra", [su(3), so(4), gl(2), sine(3)], ids=str)
def test_expansion_is_on_request_and_keeps_the_value(algebra):
    bracket = algebra @ trivial()
    for trace in bracket.trace_casimirs.generators:
        if not isinstance(trace, Trace):
            continue
        assert trace.expand() == trace
        written = trace.expand(trace=True)
        assert written.is_polynomial(*bracket.variables)
        x = np.random.default_rng(3).standard_normal(bracket.dimension)
        both = sp.lambdify(bracket.variables, [trace, written])(*x)
        assert both[0] == pytest.approx(both[1], rel=1e-12)


def test_derivatives_are_those_of_the_expansion():
    bracket = su(3) @ leibniz(2)
    l, alpha = bracket.variables[0], bracket.variables[9]
    for trace in bracket.trace_casimirs.generators:
        for difference in (
            trace.diff(l).expand(trace=True) - trace.expand(trace=True).diff(l),
            trace.diff(l, alpha).expand(trace=True) - trace.expand(trace=True).diff(l, alpha),
        ):
            assert difference.expand() == 0


def test_printing():
    C1, C2, _, _ = (su(3) @ leibniz(2)).trace_casimirs.generators
    assert (str(C1), str(C2)) == ("tr(l*alpha)", "tr(alpha**2)")
    assert sp.latex(C2) == r"\operatorname{tr}\left(\boldsymbol{\alpha}^{2}\right)"
    assert sp.pretty(C2) == "tr(alpha**2)"


def test_exact_values_copies_and_abbreviations():
    bracket = gl(2) @ trivial()
    first, second = bracket.trace_casimirs.generators
    point = dict(zip(bracket.variables, map(sp.Rational, ("1/2", "2", "3", "-5")), strict=True))
    assert (first.subs(point), second.subs(point)) == (sp.Rational(-9, 2), sp.Rational(1, 4) + 2 * 6 + 25)
    x = sp.Symbol("x")
    inserted = second.subs(bracket.variables[0], x**2)
    assert (inserted.diff(x).expand(trace=True) - inserted.expand(trace=True).diff(x)).expand() == 0
    copy = pickle.loads(pickle.dumps(second))
    assert (copy, hash(copy)) == (second, hash(second))
    short, meaning = abbreviated(second**2 + 1)
    assert not short.has(Trace)
    assert short.xreplace(meaning) == second**2 + 1
