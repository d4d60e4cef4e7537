r"""Families of systems: bodies in n dimensions, truncated fluids, tops on any algebra and of any order.

Each function gives a `System` with its source and the integrals that are known for the whole family.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from numbers import Integral
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_kind

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from liepoisson.formula.parameters import Parameter
    from liepoisson.inputs.arrays import Array
    from liepoisson.model.system import System
    from liepoisson.structure.lie_algebra import LieAlgebra

Pairs: TypeAlias = "Mapping[tuple[int, int], Any]"
"""Quadratic functions of the state by pairs of indices j < k, counted from 0."""

_EULER = (
    "V. Arnold, Sur la géométrie différentielle des groupes de Lie de dimension infinie et ses applications à "
    "l'hydrodynamique des fluides parfaits, Annales de l'Institut Fourier 16 (1966) 319"
)
_EXTENSIONS = (
    "J.-L. Thiffeault and P. J. Morrison, Classification and Casimir invariants of Lie-Poisson brackets, "
    "Physica D 136 (2000) 205, arXiv:math-ph/9904010"
)


@explains_its_arguments
def manakov(n: int, J: Sequence[Parameter] | None = None) -> System:
    r"""The free rigid body in n dimensions, $\dot M = [M, \Omega]$, $M_{ij} = (J_i + J_j)\,\Omega_{ij}$, on so(n).

    Known integrals: $K_k = \sum_{i<j} M_{ij}^2 \sum_{p+q=k-2} J_i^{2p} J_j^{2q}$, k = 3, ..., n - 1, which are the
    quadratic coefficients of $\operatorname{tr}(M + \lambda J^2)^k$ up to a factor.  (k = 2 is a Casimir; H and the
    $K_k$ span that of k = n.  For n > 4 there are integrals of higher degree, which are not listed.)

    Example:
        >>> body = lp.catalog.manakov(5)
        >>> body.bracket.rank()
        8
        >>> {name: body.is_constant(integral) for name, integral in body.integrals.items()}
        {'K3': True, 'K4': True}

    Args:
        n: Dimension of the space, n >= 3.
        J: The n moments of the body's mass, with nonzero sums $J_i + J_j$; 1, ..., n if left out.

    Raises:
        ShapeError: `J` does not have n entries.
        ParameterError: n is too small or too large, or an entry is not exact.

    References: Manakov (1976); Ratiu (1980).
    """
    from liepoisson.model.system import System
    from liepoisson.structure.extensions import trivial
    from liepoisson.structure.lie_algebras import so

    bracket = so(n) @ trivial().rename("M")
    moments = _moments(J, n, "J")
    check_names(bracket, moments)
    pairs = list(combinations(range(n), 2))
    # The basis of so(3) is that of the cross product: its axes 1, 2, 3 are the planes 23, 13, 12.
    squares = [x**2 for x in (reversed(bracket.variables) if n == 3 else bracket.variables)]
    energy, integrals = _difference_quotients(dict(zip(pairs, squares, strict=True)), moments)
    return System(
        bracket,
        energy,
        name=f"Manakov top of so({n})",
        integrals=integrals,
        source="S. V. Manakov, Note on the integration of Euler's equations of the dynamics of an n-dimensional rigid "
        "body, Functional Analysis and its Applications 10 (1976) 328",
    )


@explains_its_arguments
def su_top(n: int, J: Sequence[Parameter] | None = None) -> System:
    r"""Manakov's top continued to su(n): $H = \tfrac12 \sum_{j<k} (a_{jk}^2 + s_{jk}^2)/(J_j + J_k)$.

    A sectional operator of Mishchenko and Fomenko.  Known integrals: the coordinates $h_k$ of the diagonal, and
    $K_k = \sum_{i<j} (a_{ij}^2 + s_{ij}^2) \sum_{p+q=k-2} J_i^{2p} J_j^{2q}$, k = 3, ..., n - 1.  For s = h = 0 it is
    `manakov(n, J)`.

    Example:
        >>> top = lp.catalog.su_top(3)
        >>> list(top.invariants)
        ['H', 'C1', 'C2', 'h1', 'h2']
        >>> lp.integrability.integrability_report(top).verdict
        'integrable'

    Args:
        n: Size of the matrices, n >= 2.
        J: n numbers with nonzero sums $J_j + J_k$; 1, ..., n if left out.

    Raises:
        ShapeError: `J` does not have n entries.
        ParameterError: n is too small or too large, or an entry is not exact.

    References: Mishchenko and Fomenko (1978).
    """
    from liepoisson.model.system import System
    from liepoisson.structure.extensions import trivial
    from liepoisson.structure.lie_algebras import su

    bracket = su(n) @ trivial().rename("x")
    moments = _moments(J, n, "J")
    check_names(bracket, moments)
    pairs = list(combinations(range(n), 2))
    x, m = bracket.variables, len(pairs)
    squares = {pair: x[r] ** 2 + x[m + r] ** 2 for r, pair in enumerate(pairs)}
    energy, integrals = _difference_quotients(squares, moments)
    diagonal: dict[str, Any] = {f"h{k + 1}": value for k, value in enumerate(x[2 * m :])}
    return System(
        bracket,
        energy,
        name=f"Manakov top of su({n})",
        integrals=diagonal | integrals,
        source="A. S. Mishchenko and A. T. Fomenko, Euler equations on finite-dimensional Lie groups, "
        "Mathematics of the USSR-Izvestiya 12 (1978) 371",
    )


@explains_its_arguments
def zeitlin(N: int) -> System:
    r"""Euler's equation of the ideal fluid on the torus, truncated to su(N) for odd N: the sine algebra.

    $\dot w_n = \frac{N}{2\pi}\sum_k \sin(2\pi\, n\times k/N)\, w_{n+k} w_{-k}/|k|^2$, indices modulo N; the coordinates
    are the real and imaginary parts wc10, ws10, ... of $w_n$, $H = \tfrac12\sum_n |w_n|^2/|n|^2$.  The vorticity is
    $\omega(x) = -\sum_n w_n e^{in\cdot x}$, positive where the fluid turns counterclockwise; `vorticity` adds it up.

    Example:
        >>> fluid = lp.catalog.zeitlin(3)
        >>> fluid.component_names
        ('wc10', 'ws10', 'wc01', 'ws01', 'wc11', 'ws11', 'wc1m1', 'ws1m1')
        >>> fluid.bracket.casimir_report().degrees  # the enstrophy, and a cubic one
        (2, 3)

    Raises:
        ParameterError: N is not an odd integer from 3 on.

    References: Zeitlin (1991).
    """
    from sympy import S

    from liepoisson.algebra.exact_numbers import to_sympy
    from liepoisson.model.system import System
    from liepoisson.structure.extensions import trivial
    from liepoisson.structure.lie.sine_algebra import sine_energy
    from liepoisson.structure.lie_algebras import sine

    bracket = sine(N) @ trivial().rename("w")
    terms = (to_sympy(h) * x**2 for h, x in zip(sine_energy(N), bracket.variables, strict=True))
    return System(
        bracket,
        sum(terms, S.Zero),
        name=f"Zeitlin's truncation to su({N})",
        source="V. Zeitlin, Finite-mode analogs of 2D ideal hydrodynamics: coadjoint orbits and local canonical "
        "structure, Physica D 49 (1991) 353",
    )


@explains_its_arguments
def vorticity(states: ArrayLike, n_points: int = 64) -> Array:
    r"""The vorticity of states of `zeitlin(N)` on the torus, $\omega(x) = -\sum_n w_n e^{in\cdot x}$ over n and -n.

    With this sign $\dot\omega = -u\cdot\nabla\omega$, where u is the flow that turns counterclockwise around
    positive vorticity; the truncation has sines in the place of their arguments.

    Example:
        >>> fluid = lp.catalog.zeitlin(5)
        >>> wave = np.eye(24)[fluid.component_names.index("wc10")]
        >>> lp.catalog.vorticity(wave, n_points=6)[0].round(9)  # -2 cos x
        array([-2., -1.,  1.,  2.,  1., -1.])

    Args:
        states: Shape (..., N^2 - 1).
        n_points: Points along each axis, from 0 to 2 pi without the end.

    Returns:
        Shape (..., n_points, n_points): y along the last axis but one, x along the last.

    Raises:
        ShapeError: the last axis is not that of a truncation to su(N), N odd.
    """
    import numpy as np

    from liepoisson.formula.scalars import as_array, as_count
    from liepoisson.portable import elementary
    from liepoisson.structure.lie.sine_algebra import sine_modes

    n_points = as_count(n_points, "n_points", least=1)
    x = as_array(states, "states")
    n = round((x.shape[-1] + 1) ** 0.5) if x.ndim else 0
    if n < 3 or n % 2 == 0 or n * n - 1 != x.shape[-1]:
        raise ShapeError(f"states must have N^2 - 1 components, N odd; got shape {x.shape}. Pass those of zeitlin(N).")
    at = 2 * np.pi * np.arange(n_points) / n_points
    waves = elementary.exp(1j * np.arange(-(n // 2), n // 2 + 1)[:, None] * at)
    modes = np.array(sine_modes(n)) + n // 2
    coefficients = np.zeros((*x.shape[:-1], n, n), dtype=np.complex128)
    coefficients[..., modes[:, 0], modes[:, 1]] = x[..., 0::2] + 1j * x[..., 1::2]
    return -2.0 * np.einsum("...mn,mx,ny->...yx", coefficients, waves, waves, optimize=True).real


@explains_its_arguments
def reduced_mhd(N: int) -> System:
    r"""Low-beta reduced magnetohydrodynamics on the torus, truncated to su(N) for odd N.

    The fields are vorticity w and magnetic flux psi, named as in `zeitlin(N)`; the bracket is semidirect and
    $H = \tfrac12\sum_n (|w_n|^2/|n|^2 + |n|^2 |\psi_n|^2)$.

    Example:
        >>> plasma = lp.catalog.reduced_mhd(3)
        >>> plasma.bracket.extension.name, plasma.bracket.casimir_report().degrees
        ('semidirect(2)', (2, 2, 3, 3))

    Raises:
        ParameterError: N is not an odd integer from 3 on.

    References: Morrison and Hazeltine (1984); Zeitlin (2005).
    """
    from sympy import S

    from liepoisson.algebra.exact_numbers import to_sympy
    from liepoisson.model.system import System
    from liepoisson.structure.extensions import semidirect
    from liepoisson.structure.lie.sine_algebra import sine_energy
    from liepoisson.structure.lie_algebras import sine

    bracket = sine(N) @ semidirect(2).rename("w", "psi")
    weights = [to_sympy(h) for h in sine_energy(N)]
    w, psi = bracket.variables[: len(weights)], bracket.variables[len(weights) :]
    terms = (h * x**2 + y**2 / h for h, x, y in zip(weights, w, psi, strict=True))
    return System(
        bracket,
        sum(terms, S.Zero),
        name=f"reduced magnetohydrodynamics on su({N})",
        source="P. J. Morrison and R. D. Hazeltine, Hamiltonian formulation of reduced magnetohydrodynamics, "
        "Physics of Fluids 27 (1984) 886; V. Zeitlin, Physics Letters A 339 (2005) 316",
    )


@explains_its_arguments
def leibniz_top(
    n: int, inertia: Sequence[Parameter], vectors: Sequence[Sequence[Parameter]], epsilon: Parameter = 1
) -> System:
    r"""The top on so(3) with the Leibniz extension of order n.

    $H = \tfrac12\,\ell\cdot I^{-1}\ell + \sum_{k\ge1} a_k\cdot x_k$, with the fields $x_0 = \ell, x_1, \dots, x_{n-1}$.

    n = 2 is the heavy top, n = 3 the twisted top.

    Example:
        >>> top = lp.catalog.leibniz_top(4, [1, 1, 2], [[0, 0, 1]])  # symmetric, with four fields
        >>> top.parts_of_state, top.is_constant("x03")
        (('x0', 'x1', 'x2', 'x3'), True)

    Args:
        n: Number of fields.
        inertia: Principal moments of inertia, nonzero.
        vectors: Constant vectors $a_1, a_2, \dots$ that couple to $x_1, x_2, \dots$; at most n - 1.
        epsilon: Strength of the cocycle.

    Raises:
        ShapeError: a vector does not have 3 components, or there are n or more vectors.
        ParameterError: a parameter is not exact, or n is too small.

    References: Thiffeault and Morrison (2000, 2001); Musso, Petrera, Ragnisco and Satta (2005).
    """
    from liepoisson.inputs.given import sequence
    from liepoisson.structure.extensions import leibniz
    from liepoisson.structure.lie_algebras import so

    given = sequence(vectors, "vectors", "vectors", "[[0, 0, 1]]")
    named = {f"vectors[{k}]": vector for k, vector in enumerate(given)}
    return _top(so(3) @ leibniz(n, epsilon), inertia, named, f"Leibniz top of order {n}", _EXTENSIONS)


@explains_its_arguments
def euler_top_on(algebra: LieAlgebra | str, inertia: Sequence[Parameter]) -> System:
    r"""Euler's top on any Lie algebra: $H = \tfrac12 \sum_i \ell_i^2/I_i$.

    Example:
        >>> body = lp.catalog.euler_top_on("so(2,1)", [1, 2, 3])
        >>> body.equations
        {l1: 5*l2*l3/6, l2: -4*l1*l3/3, l3: -l1*l2/2}
        >>> body.bracket.casimirs()
        [l1**2 + l2**2 - l3**2]

    Args:
        algebra: The algebra, or its name as in a system file: "so(2,1)", "su(3)".
        inertia: One nonzero moment per dimension of the algebra.

    Raises:
        ShapeError: another number of moments.
        ParameterError: a moment is not exact or zero.

    References: Arnold (1966).
    """
    from liepoisson.structure.extensions import trivial

    return _top(_algebra(algebra) @ trivial(), inertia, {}, f"Euler top on {algebra}", _EULER)


@explains_its_arguments
def heavy_top_on(algebra: LieAlgebra | str, inertia: Sequence[Parameter], a: Sequence[Parameter]) -> System:
    r"""The heavy top on any Lie algebra: the semidirect extension, $H = \tfrac12 \sum_i \ell_i^2/I_i + a\cdot\alpha$.

    Arguments and errors are those of `euler_top_on`; `a` has one component per dimension of the algebra.

    Example:
        >>> top = lp.catalog.heavy_top_on("so(2,1)", [1, 1, 2], [0, 0, 1])
        >>> top.is_constant("l3"), top.is_casimir("alpha1^2 + alpha2^2 - alpha3^2")
        (True, True)
    """
    from liepoisson.structure.extensions import semidirect

    return _top(_algebra(algebra) @ semidirect(2), inertia, {"a": a}, f"heavy top on {algebra}", _EXTENSIONS)


@explains_its_arguments
def twisted_top_on(
    algebra: LieAlgebra | str,
    inertia: Sequence[Parameter],
    a: Sequence[Parameter],
    b: Sequence[Parameter] | None = None,
    epsilon: Parameter = 1,
) -> System:
    r"""The twisted top on any Lie algebra, $H = \tfrac12 \sum_i \ell_i^2/I_i + a\cdot\alpha + b\cdot\beta$.

    Arguments and errors are those of `heavy_top_on`; epsilon = 0 is the charged heavy top.

    Example:
        >>> top = lp.catalog.twisted_top_on("so(3)", [2, 2, 1], [-1, 0, 0])
        >>> top.equations == lp.Top.twisted_kovalevskaya().equations
        True
    """
    from liepoisson.structure.extensions import leibniz

    vectors = {"a": a} if b is None else {"a": a, "b": b}
    return _top(_algebra(algebra) @ leibniz(3, epsilon), inertia, vectors, f"twisted top on {algebra}", _EXTENSIONS)


@explains_its_arguments
def cubic_top(
    cubic: Sequence[Parameter],
    inertia: Sequence[Parameter],
    a: Sequence[Parameter],
    b: Sequence[Parameter] | None = None,
) -> System:
    r"""The top in two fields on so(3) (x) A, A the algebra of a binary cubic: any twist of the charged heavy top.

    $H = \tfrac12\,\ell\cdot I^{-1}\ell + a\cdot\alpha + b\cdot\beta$ with the bracket of
    `extensions.binary_cubic`.  The cubic (0, 0, 0, 0) gives the charged heavy top, (-epsilon, 0, 0, 0) the twisted
    top.  Another choice of $e_1$ and $e_2$ modulo the unit adds terms $k\cdot\ell$ to H: rotors.

    Example:
        >>> top = lp.catalog.cubic_top((0, 1, -1, 0), ["I1", "I2", "I3"], ["a1", 0, 0], [0, "b2", 0])
        >>> top.equations[top.variables[0]], top.equations[top.variables[5]]
        (-b2*beta3 + l2*l3/I3 - l2*l3/I2, -a1*alpha2 + alpha1*l2/I2 - alpha2*l1/I1)
        >>> twisted = lp.catalog.cubic_top((-1, 0, 0, 0), [2, 2, 1], [-1, 0, 0])
        >>> twisted.equations == lp.Top.twisted_kovalevskaya().equations
        True

    Args:
        cubic: The coefficients of $X^3, X^2Y, XY^2, Y^3$.
        inertia: Principal moments of inertia, nonzero.
        a: The constant vector that couples to alpha.
        b: The constant vector that couples to beta; none if left out.

    Raises:
        ShapeError: not four coefficients, or a vector does not have 3 components.
        ParameterError: a parameter is not exact.

    References: Delone and Faddeev (1964); Thiffeault and Morrison (2000, 2001).
    """
    from liepoisson.structure.extensions import binary_cubic
    from liepoisson.structure.lie_algebras import so

    coefficients = read_numbers(cubic, 4, "cubic", "c")
    bracket = so(3) @ binary_cubic(*coefficients)
    vectors = {"a": a} if b is None else {"a": a, "b": b}
    return _top(bracket, inertia, vectors, f"top of the {bracket.extension.name}", _EXTENSIONS)


@explains_its_arguments
def toda(n: int, *, closed: bool = True) -> System:
    r"""The Toda lattice of n particles, $H = \tfrac12\sum p_k^2 + \sum e^{q_k - q_{k+1}}$, with n integrals.

    They are the traces of powers of the Lax matrix L with $L_{kk} = p_k$ and $L_{k,k+1} = L_{k+1,k} =
    e^{(q_k - q_{k+1})/2}$: $P = \operatorname{tr} L$ and $T_k = \operatorname{tr} L^k$, $k = 3, \dots, n$
    ($\operatorname{tr} L^2 = 2H$).  They commute.

    Example:
        >>> chain = lp.catalog.toda(3, closed=False)
        >>> chain.hamiltonian
        p1**2/2 + p2**2/2 + p3**2/2 + exp(q1 - q2) + exp(q2 - q3)
        >>> {name: chain.is_constant(integral) for name, integral in chain.integrals.items()}
        {'P': True, 'T3': True}

    Args:
        n: Particles, 3 to 100 on a ring, 2 to 100 on a line.  Integrals are written out up to n = 8.
        closed: Whether the last particle is joined to the first: the lattice on a ring, else on a line.

    Raises:
        ParameterError: n is not in the range.

    References: Toda (1967); [henon1974], [flaschka1974].
    """
    from liepoisson.model.system import System
    from liepoisson.structure.canonical_bracket import canonical

    least = 3 if closed else 2
    if isinstance(n, bool) or not isinstance(n, Integral) or not least <= int(n) <= _MOST_PARTICLES:
        raise ParameterError(
            f"the number of particles must be an integer from {least} to {_MOST_PARTICLES}; got {n!r:.40}. Take "
            "another."
        )
    n = int(n)
    from sympy import S, exp

    bracket = canonical(n)
    q, p = (list(column) for column in bracket.fields.values())
    pairs = [(k, (k + 1) % n) for k in range(n if closed else n - 1)]
    springs = [exp(q[i] - q[j]) for i, j in pairs]
    energy = sum((c**2 for c in p), S.Zero) / 2 + sum(springs, S.Zero)
    traces = _traces_of_lax_matrix(q, p, pairs) if n <= _MOST_WRITTEN else {}
    integrals = {"P": sum(p, S.Zero)} | {f"T{k}": trace for k, trace in traces.items() if k > _QUADRATIC}
    shape = "ring" if closed else "line"
    return System(bracket, energy, name=f"Toda lattice of {n} on a {shape}", integrals=integrals, source=_TODA)


_MOST_PARTICLES, _MOST_WRITTEN, _QUADRATIC = 100, 8, 2
_TODA = (
    "M. Toda, J. Phys. Soc. Japan 22 (1967) 431; M. Hénon, Phys. Rev. B 9 (1974) 1921; H. Flaschka, Phys. Rev. B 9 "
    "(1974) 1924"
)


def _traces_of_lax_matrix(q: Sequence[Any], p: Sequence[Any], pairs: Sequence[tuple[int, int]]) -> dict[int, Any]:
    """The traces of the powers of L, by exponent; products of springs are exponentials of differences."""
    from sympy import Matrix, exp, zeros

    n = len(q)
    L: Any = zeros(n, n)
    for k in range(n):
        L[k, k] = p[k]
    for i, j in pairs:
        L[i, j] = L[j, i] = exp((q[i] - q[j]) / 2)
    power: Any = Matrix(L)
    traces: dict[int, Any] = {1: power.trace()}
    for k in range(2, n + 1):
        power = (power * L).expand()
        traces[k] = power.trace().expand()
    return traces


@explains_its_arguments
def henon_heiles(A: Parameter = 1, B: Parameter = 1, C: Parameter = 1) -> System:
    r"""Hénon and Heiles' system, $H = \tfrac12(p_x^2 + p_y^2 + Ax^2 + By^2) + x^2 y - \tfrac C3 y^3$.

    It is integrable for C = -1 and A = B (Sawada-Kotera), for C = -6 (KdV), and for C = -16 and B = 16 A
    (Kaup-Kupershmidt); the integral of these cases is then known, as K.

    Example:
        >>> kdv = lp.catalog.henon_heiles(C=-6)
        >>> {name: kdv.is_constant(integral) for name, integral in kdv.integrals.items()}
        {'K': True}
        >>> list(lp.catalog.henon_heiles().integrals)
        []

    Args:
        A: Square of the frequency of x.
        B: Square of the frequency of y.
        C: Strength of the cubic term.

    Raises:
        ParameterError: one of them is not exact.

    References: Hénon and Heiles (1964); Conte, Musette and Verhoeven (2005), for the cases.
    """
    from liepoisson.model.system import System
    from liepoisson.structure.canonical_bracket import canonical

    values = {"A": A, "B": B, "C": C}
    a, b, c = read_numbers(list(values.values()), 3, "A, B, C")
    integrals: dict[str, str] = {}
    if c == -1 and (a - b).equals(0):
        integrals = {"K": "p_x*p_y + A*x*y + x*y^2 + x^3/3"}
    elif c == -6:
        integrals = {"K": "x^4 + 4*x^2*y^2 + 4*p_x*(p_y*x - p_x*y) + 4*A*x^2*y + (4*A - B)*(p_x^2 + A*x^2)"}
    elif c == -16 and (16 * a - b).equals(0):
        integrals = {"K": "3*p_x^4 + 6*(A + 2*y)*x^2*p_x^2 - 4*x^3*p_x*p_y - 4*x^4*(A*y + y^2) + 3*A^2*x^4 - 2*x^6/3"}
    energy = "(p_x^2 + p_y^2 + A*x^2 + B*y^2)/2 + x^2*y - C*y^3/3"
    source = "M. Hénon, C. Heiles, Astronomical Journal 69 (1964) 73"
    name = f"Hénon-Heiles system, A = {a}, B = {b}, C = {c}"
    return System(canonical(names=("x", "y")), energy, values, name=name, integrals=integrals, source=source)


def _algebra(algebra: LieAlgebra | str) -> LieAlgebra:
    if not isinstance(algebra, str):
        from liepoisson.structure.lie_algebra import LieAlgebra

        check_kind(algebra, LieAlgebra, "algebra", "a Lie algebra or its name", 'write for example "so(3)"')
        return algebra
    from liepoisson.model.constructors import read_algebra

    return read_algebra(algebra)


def _top(
    bracket: Any, inertia: Sequence[Parameter], vectors: Mapping[str, Sequence[Parameter]], name: str, source: str
) -> System:
    """The system with kinetic energy of the first field and constant vectors that couple to the next ones."""
    from sympy import S

    from liepoisson.model.hamiltonian import symbols_in
    from liepoisson.model.system import System

    n, fields = bracket.algebra.dimension, list(bracket.fields.values())
    if len(vectors) >= len(fields):
        raise ShapeError(
            f"vectors must be at most {len(fields) - 1}, one per field after the first; got {len(vectors)}. Leave out "
            "the others."
        )
    moments = read_numbers(inertia, n, "inertia", "I")
    check_divisors(moments, "moments of inertia")
    read = {letter: read_numbers(vector, n, letter) for letter, vector in vectors.items()}
    check_names(bracket, [*moments, *(c for vector in read.values() for c in vector)])
    energy = sum((x**2 / (2 * moment) for x, moment in zip(fields[0], moments, strict=True)), S.Zero)
    for field, vector in zip(fields[1:], read.values(), strict=False):
        energy += sum((c * x for c, x in zip(vector, field, strict=True)), S.Zero)
    symbols = symbols_in(energy, bracket.coordinate_names)
    return System(bracket, energy, name=name, source=source, symbols=symbols)


def _difference_quotients(squares: Pairs, J: list[Any]) -> tuple[Any, dict[str, Any]]:
    r"""$\tfrac12\sum q_{jk}/(J_j + J_k)$ and the $K_k = \sum q_{jk} \sum_{p+q=k-2} J_j^{2p} J_k^{2q}$, 2 < k < n."""
    from sympy import S

    check_divisors([J[j] + J[k] for j, k in squares], "sums J[j] + J[k]")
    energy = sum((square / (2 * (J[j] + J[k])) for (j, k), square in squares.items()), S.Zero)
    integrals = {
        f"K{degree}": sum(
            (
                q * J[j] ** (2 * p) * J[k] ** (2 * (degree - 2 - p))
                for (j, k), q in squares.items()
                for p in range(degree - 1)
            ),
            S.Zero,
        )
        for degree in range(3, len(J))
    }
    return energy, integrals


def _moments(values: Sequence[Parameter] | None, n: int, name: str) -> list[Any]:
    return read_numbers(range(1, n + 1) if values is None else values, n, name)


def read_numbers(values: Sequence[Parameter], n: int, name: str, letter: str | None = None) -> list[Any]:
    """Exact numbers (or names), as SymPy expressions; labels are the letter with numbers from 1."""
    from liepoisson.algebra.exact_numbers import to_sympy
    from liepoisson.formula.parameters import read_parameter
    from liepoisson.inputs.given import listed

    items = listed(values, name, [f"{letter or name}{k + 1}" for k in range(n)])
    if items is None or len(items) != n:
        got = repr(values) if items is None else f"{len(items)} of them"
        raise ShapeError(f"{name} must be {n} numbers, one per component; got {got}. Give {n}.")
    return [to_sympy(read_parameter(value, f"{name}[{k + 1}]")) for k, value in enumerate(items)]


def check_names(bracket: Any, values: Sequence[Any]) -> None:
    """Refuse symbols that are named like a coordinate: they would become one.

    Raises:
        BracketError: there is such a name.
    """
    from liepoisson.algebra.exact_numbers import to_sympy

    bracket.check_parameter_names({str(symbol) for value in values for symbol in to_sympy(value).free_symbols})


def check_divisors(values: list[Any], what: str) -> None:
    """Refuse values by which the energy is divided where one is zero."""
    if zero := [k + 1 for k, value in enumerate(values) if value.is_zero]:
        raise ParameterError(
            f"the {what} must not vanish, the energy is divided by them; number {zero[0]} does. Change it."
        )
