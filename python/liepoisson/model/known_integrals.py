r"""Known integrals of tops, chosen by exact conditions on the parameters.

Conditions are decided exactly; a symbolic parameter counts as generic.  Throughout, $\omega = I^{-1}\ell$, the fields
$\alpha$, $\beta$ see the vectors a, b, and the equations are those of `liepoisson.compile.field.TopField`.

References: Thiffeault and Morrison (2001) for P; Kowalewski (1889); Bobenko, Reyman and Semenov-Tian-Shansky (1989) for
the top in two fields.  Each one is verified in the tests by exact differentiation along the derived field.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.algebra.rational_polynomials import RationalPolynomial
from liepoisson.formula.parameters import Column
from liepoisson.model.top_parameters import Scalar, TopNumbers, TopParameters, Triple

if TYPE_CHECKING:
    from sympy import Expr

Integrals: TypeAlias = "dict[str, Scalar]"


def known_integrals(top: TopParameters, l: Column, alpha: Column, beta: Column) -> dict[str, Expr]:
    """The integrals that are known for this top besides H and the Casimirs, by name.

    Args:
        top: Exact parameters.
        l: Angular momentum, 3 x 1.
        alpha: First field, 3 x 1.
        beta: Second field, 3 x 1.
    """
    return _integrals(top.numbers(to_sympy), Triple(*l), Triple(*alpha), Triple(*beta))


def known_polynomials(top: TopParameters) -> dict[str, RationalPolynomial] | None:
    """The same as rational polynomials in the nine coordinates, without SymPy; None if a parameter is irrational."""
    if not all(isinstance(value, Fraction) for value in (*top.inertia, *top.a, *top.b, top.epsilon)):
        return None
    x = [RationalPolynomial.coordinate(k) for k in range(9)]
    return _integrals(top.numbers(lambda value: value), Triple(*x[:3]), Triple(*x[3:6]), Triple(*x[6:]))


def _integrals(top: TopNumbers, l: Triple, alpha: Triple, beta: Triple) -> Integrals:
    found: Integrals = {}
    for case in (_free, _single_field, _axisymmetric, _kovalevskaya, _spherical):
        found |= case(top, l, alpha, beta)
    return found


def _free(top: TopNumbers, l: Triple, alpha: Triple, beta: Triple) -> Integrals:
    """No torque: the length of l and its components along the two fields, which are fixed in space."""
    if not (_vanishes(top.a) and _vanishes(top.b)):
        return {}
    return {"l.l": l.dot(l), "l.alpha": l.dot(alpha), "l.beta": l.dot(beta)}


def _single_field(top: TopNumbers, l: Triple, alpha: Triple, beta: Triple) -> Integrals:
    """The torque is that of one field fixed in space: l along this field."""
    if _vanishes(top.a):
        return {"l.beta": l.dot(beta)}
    if is_zero(top.epsilon) and (ratio := _ratio(top)) is not None:
        name = "l.alpha" if ratio == 0 else "l.gamma"
        return {name: l.dot(alpha + ratio * beta)}
    return {}


def _axisymmetric(top: TopNumbers, l: Triple, alpha: Triple, beta: Triple) -> Integrals:
    r"""Lagrange: $I_i = I_j$ and a, b along axis k: $\ell_k$, and P or, with charge, P'.

    $P = \ell\cdot\alpha + \epsilon I_i a_k \beta_k$ (b = 0), $P' = \ell\cdot(a_k\alpha + b_k\beta)
    + \epsilon a_k^2 I_i \beta_k$.
    """
    found: Integrals = {}
    for k, i, j in _axes():
        on_axis = all(is_zero(vector[m]) for vector in (top.a, top.b) for m in (i, j))
        if not (_equal_moments(top, i, j) and on_axis):
            continue
        found[f"l{k + 1}"] = l[k]
        inertia, a_k, b_k, eps = top.inertia[i], top.a[k], top.b[k], top.epsilon
        if is_zero(top.a[k]) or is_zero(top.epsilon):  # without twist these are l.alpha and l.gamma, there already
            continue
        if is_zero(top.b[k]):
            found["P"] = l.dot(alpha) + eps * inertia * a_k * beta[k]
        else:
            found["P'"] = l.dot(a_k * alpha + b_k * beta) + eps * a_k**2 * inertia * beta[k]
    return found


def _kovalevskaya(top: TopNumbers, l: Triple, alpha: Triple, beta: Triple) -> Integrals:
    r"""Kovalevskaya: $I = (2\kappa, 2\kappa, \kappa)$, a and b equatorial, and no twist ($\epsilon = 0$ or a = 0).

    $K = |\xi|^2$, $\xi = (\omega_1 + i\omega_2)^2 - [(a_1 + i a_2)(\alpha_1 + i\alpha_2)
    + (b_1 + i b_2)(\beta_1 + i\beta_2)]/\kappa$, which obeys $\dot\xi = -i\omega_3\xi$.  With a not parallel to b
    there is also G, of degree two in l, which would be $|a|^2(\ell\cdot\gamma)^2$ if there were one field $\gamma$.
    """
    if not (is_zero(top.epsilon) or _vanishes(top.a)) or (_vanishes(top.a) and _vanishes(top.b)):
        return {}
    found: Integrals = {}
    for k, i, j in _axes():
        kappa = top.inertia[k]
        twice = is_zero(top.inertia[i] - 2 * kappa) and _equal_moments(top, i, j)
        if not (twice and is_zero(top.a[k]) and is_zero(top.b[k])):
            continue
        a_i, a_j, b_i, b_j = top.a[i], top.a[j], top.b[i], top.b[j]
        first, second = a_i * alpha + b_i * beta, a_j * alpha + b_j * beta
        w_i, w_j = l[i] / (2 * kappa), l[j] / (2 * kappa)
        real = w_i**2 - w_j**2 - (first[i] - second[j]) / kappa
        imaginary = 2 * w_i * w_j - (first[j] + second[i]) / kappa
        found["K"] = real**2 + imaginary**2
        if not is_zero(a_i * b_j - a_j * b_i):
            potential = first[i] * second.dot(second) + second[j] * first.dot(first)
            potential -= (first[j] + second[i]) * first.dot(second)
            triple = l[k] * l.dot(first.cross(second))
            found["G"] = l.dot(first) ** 2 + l.dot(second) ** 2 + 2 * triple + 4 * kappa * potential
    return found


def _spherical(top: TopNumbers, l: Triple, alpha: Triple, beta: Triple) -> Integrals:
    r"""All moments equal: l.a (or l.b) and P for one field, S and T for two fields without twist.

    The latter is a Neumann system on $S^3$.  With $M = \alpha a^T + \beta b^T$,
    $S = \ell\cdot M^T\ell + 2I\,(a\times b)\cdot(\alpha\times\beta)$ and
    $T = |M\ell|^2 + |M^T\ell|^2 + 2\,\ell\cdot(a\times b)\;\ell\cdot(\alpha\times\beta)
    + 4I[\mathrm{tr}M\,\mathrm{tr}(M^TM) - \mathrm{tr}(MM^TM)]$.
    """
    if not (_equal_moments(top, 0, 1) and _equal_moments(top, 1, 2)) or (_vanishes(top.a) and _vanishes(top.b)):
        return {}
    moment, a, b, eps = top.inertia[0], top.a, top.b, top.epsilon
    if _vanishes(top.a):
        return {"l.b": l.dot(b)}
    if (ratio := _ratio(top)) is not None:
        name = "P" if ratio == 0 else "P'"
        if _along_an_axis(top):  # l_k and P are there already, as those of the symmetric top
            return {}
        found = {"l.a": l.dot(a)}
        if not is_zero(top.epsilon):  # without twist it is l.alpha or l.gamma, there already
            found[name] = l.dot(alpha + ratio * beta) + eps * moment * a.dot(beta)
        return found
    if not is_zero(top.epsilon):
        return {}
    rows = [alpha[i] * a + beta[i] * b for i in range(3)]
    columns = [Triple(*(row[j] for row in rows)) for j in range(3)]
    Ml, Mtl = (Triple(*(vector.dot(l) for vector in vectors)) for vectors in (rows, columns))
    normals = a.cross(b), alpha.cross(beta)
    S = l.dot(Mtl) + 2 * moment * normals[0].dot(normals[1])
    traces = rows[0][0] + rows[1][1] + rows[2][2], sum(column.dot(column) for column in columns)
    products = [Triple(*(row.dot(other) for other in rows)) for row in rows]
    trace = traces[0] * traces[1] - sum(products[i].dot(columns[i]) for i in range(3))
    T = Ml.dot(Ml) + Mtl.dot(Mtl) + 2 * l.dot(normals[0]) * l.dot(normals[1]) + 4 * moment * trace
    return {"S": S, "T": T}


def _axes() -> tuple[tuple[int, int, int], ...]:
    """(axis, and the two others in cyclic order), the third axis first."""
    return (2, 0, 1), (0, 1, 2), (1, 2, 0)


def _vanishes(vector: Triple) -> bool:
    return all(is_zero(value) for value in vector)


def _equal_moments(top: TopNumbers, i: int, j: int) -> bool:
    return is_zero(top.inertia[i] - top.inertia[j])


def _along_an_axis(top: TopNumbers) -> bool:
    return sum(not is_zero(value) for value in top.a) == 1


def _ratio(top: TopNumbers) -> Scalar | None:
    """The number d in b = d a for a nonzero a, or None if b is not parallel to a."""
    if not _vanishes(top.a.cross(top.b)):
        return None
    k = next(k for k in range(3) if not is_zero(top.a[k]))
    ratio = top.b[k] / top.a[k]
    return ratio if isinstance(ratio, Fraction) else ratio.simplify()
