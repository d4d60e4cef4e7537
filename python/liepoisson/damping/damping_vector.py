r"""The vector that damping adds to $J\nabla H$, derived from the bracket.

**Double bracket** [bloch1996]: with a symmetric form g on velocities,

$$F = \gamma\, J g J\nabla H, \qquad \dot H = -\gamma\,|J\nabla H|_g^2 \le 0 .$$

F lies in the image of J, so all Casimirs are kept.  On so(3)* it is $\gamma\,\ell\times(\ell\times\omega)$ for the
identity g.

**Metriplectic**: with a Casimir S as entropy and a symmetric bracket G that H is degenerate for,

$$F = \gamma\, G\nabla S, \qquad G\nabla H = 0, \qquad \dot H = 0, \quad \dot S = \gamma\,|\nabla S|_G^2 \ge 0 .$$

G comes from a 4-bracket, $(f, g)_H = (f, H; g, H)$ [morrison2024]: that of a Lie algebra with a form on it,

$$(f, k; g, n) = \langle [df, dk], [dg, dn] \rangle ,$$

or the product of Kulkarni and Nomizu of two symmetric forms $\sigma$ and $\mu$ on gradients, with which

$$G = \sigma\,\mu(H, H) + \mu\,\sigma(H, H) - \sigma H\,(\mu H)^T - \mu H\,(\sigma H)^T ,$$

or it is a matrix of formulas, which is checked.  With semi-definite forms the first two are semi-definite: for
$\sigma = \sum aa^T$, $\mu = \sum bb^T$ the second is $\sum cc^T$ with $c = a\,(b\cdot H) - b\,(a\cdot H)$.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.decimals import refuse_sizes, vanishes_at_all
from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.damping.symmetric_forms import Known, Sign, points, semidefinite
from liepoisson.errors import BracketError, ParameterError

if TYPE_CHECKING:
    from sympy import Expr, Matrix

    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket


@dataclass(frozen=True)
class DampingVector:
    r"""What damping adds to the equations, and what is known of it.

    Attributes:
        vector: Its components, without the rate.
        production: What the rate is multiplied with in the rate of H (a double bracket, with the sign minus) or of the
            entropy.
        definite: Whether that is known never to be negative, where the rate is not.
        degenerate: Whether $G\nabla H = 0$ is known; of a double bracket, which needs it not, "proved".
    """

    vector: tuple[Expr, ...]
    production: Expr
    definite: Known
    degenerate: Known = "proved"


def of_double_bracket(system: System, metric: Matrix) -> DampingVector:
    r"""$J g J\nabla H$, each product as it stands.

    Raises:
        ParameterError: the metric has a negative eigenvalue.
    """
    from sympy import Matrix

    velocity: Any = Matrix(system.bracket.vector_field(system.hamiltonian))
    lowered = metric * velocity
    definite = refused_if_negative(semidefinite(metric, system.variables), "metric")
    return DampingVector(tuple(system.bracket.poisson_tensor() * lowered), (velocity.T * lowered)[0], definite)


def of_lie_bracket(system: System, entropy: Expr, metric: Matrix) -> DampingVector:
    r"""$G\nabla S$ with $G = A g A^T$, $A_{im} = \sum_k c_{ik}^m\,\partial_k H$.

    Raises:
        ParameterError: the metric has a negative eigenvalue.
    """
    from sympy import Matrix, zeros

    n = system.bracket.dimension
    h, A = system.bracket.gradient(system.hamiltonian), zeros(n, n)
    for i, j, m, c in system.bracket.entries():
        A[i, m] += c * h[j]
        A[j, m] -= c * h[i]
    turned: Any = A.T * Matrix(system.bracket.gradient(entropy))
    lowered = metric * turned
    definite = refused_if_negative(semidefinite(metric, system.variables), "metric")
    return DampingVector(tuple(A * lowered), (turned.T * lowered)[0], definite)


def of_kulkarni_nomizu(system: System, entropy: Expr, sigma: Matrix, mu: Matrix) -> DampingVector:
    r"""$G\nabla S$ with the product of two symmetric forms.

    Raises:
        ParameterError: a form has a negative eigenvalue.
    """
    from sympy import Matrix

    h, s = (Matrix(system.bracket.gradient(f)) for f in (system.hamiltonian, entropy))
    signs: list[Known] = [
        refused_if_negative(semidefinite(form, system.variables), f"forms: the {which}")
        for form, which in ((sigma, "first"), (mu, "second"))
    ]
    (sh, mh), (ss, ms) = ((sigma * h, mu * h), (sigma * s, mu * s))
    product: Any = ss * h.dot(mh) + ms * h.dot(sh) - sh * mh.dot(s) - mh * sh.dot(s)
    return DampingVector(tuple(product), s.dot(product), weakest(*signs))


def of_matrix(system: System, entropy: Expr, G: Matrix) -> DampingVector:
    r"""$G\nabla S$ with a symmetric matrix of formulas, for which H must be degenerate.

    Raises:
        ParameterError: $G\nabla H$ is not zero, or G has a negative eigenvalue.
    """
    from sympy import Add, Matrix

    h, s = (system.bracket.gradient(f) for f in (system.hamiltonian, entropy))
    rows: list[list[Any]] = G.tolist()
    degenerate: Known = "proved"
    for name, row in zip(system.component_names, rows, strict=True):
        products = [entry * slope for entry, slope in zip(row, h, strict=True)]
        left: Any = Add(*products)
        if is_zero(left):
            continue
        if left.is_rational_function(*left.free_symbols) or not _vanishes_at_points(products, system):
            raise ParameterError(
                f"matrix: wanted a symmetric bracket G with G grad H = 0, so that H is kept; component {name} of "
                f"G grad H is {left!s:.100}; leave matrix out, or give forms=(sigma, mu), from which such a G is "
                "derived"
            )
        degenerate = "sampled"
    product: Any = G * Matrix(s)
    definite = refused_if_negative(semidefinite(G, system.variables), "matrix")
    return DampingVector(tuple(product), Matrix(s).dot(product), definite, degenerate)


def killing_metric(bracket: Bracket, *, on_velocities: bool) -> Matrix:
    """Minus the Killing form of the Lie algebra of all coordinates; on velocities, its inverse.

    Raises:
        BracketError: the bracket is not linear, or the form has no inverse where one is needed.
    """
    from sympy import zeros

    if not bracket.is_linear:
        raise BracketError(f'metric: "killing" needs a Lie algebra; {bracket!r} is not linear; give a matrix')
    n = bracket.dimension
    adjoint = [zeros(n, n) for _ in range(n)]
    for i, j, m, c in bracket.entries():
        adjoint[i][m, j] += c
        adjoint[j][m, i] -= c
    form: Any = zeros(n, n)
    for i in range(n):
        for j in range(i + 1):
            form[i, j] = form[j, i] = -(adjoint[i] * adjoint[j]).trace()
    if not on_velocities:
        return form
    if form.det() == 0:
        raise BracketError(
            f'metric: "killing" needs a semisimple Lie algebra; the Killing form of {bracket!r} is degenerate; leave '
            "metric out, for the identity, or give a matrix"
        )
    return form.inv()


def refused_if_negative(sign: Sign, name: str) -> Known:
    """How it is known that there is no negative eigenvalue.

    Raises:
        ParameterError: there is one.
    """
    if sign.negative_at is None:
        return sign.known
    place = f" at {sign.negative_at}" if sign.negative_at else ""
    raise ParameterError(
        f"{name}: wanted a semi-definite matrix, with which damping never drives; got one with a negative eigenvalue"
        f"{place}; change signs, or leave {name.partition(':')[0]} out"
    )


def weakest(*known: Known) -> Known:
    """What is known of all together."""
    order: tuple[Known, ...] = ("undecided", "sampled", "proved")
    return min(known, key=order.index)


def _vanishes_at_points(products: Sequence[Expr], system: System) -> bool:
    """Whether a sum is round-off beside its terms at all points where it has a value, of which there must be one."""
    if any(product.free_symbols - {*system.variables} for product in products):
        return False
    if not vanishes_at_all(products, points(system.variables)):
        return False
    refuse_sizes(products, "matrix")
    return True
