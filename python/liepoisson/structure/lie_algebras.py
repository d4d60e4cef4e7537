r"""The Lie algebras with a name: rotations, linear groups, motions of space and time, Bianchi's, Heisenberg, sine.

All but the sine algebra have integer structure constants.  They are commutators of matrices (or act on vectors by
matrices), so that the Jacobi identity holds by construction; the tests verify it all the same.

A representation of an algebra by matrices makes a semidirect sum.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, permutations
from numbers import Integral
from typing import Any, TypeAlias

from liepoisson.algebra.exact_numbers import Exact
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.formula.tensors import read_names
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_choice, shown
from liepoisson.structure.lie.matrix_family import MatrixFamily
from liepoisson.structure.lie_algebra import MAX_DIMENSION, LieAlgebra, joined_names

__all__ = [
    "ALGEBRAS",
    "abelian",
    "affine",
    "bianchi",
    "galilei",
    "gl",
    "heisenberg",
    "poincare",
    "se",
    "sine",
    "sl",
    "so",
    "su",
]

_Entries: TypeAlias = dict[tuple[int, int], complex]
"""A matrix by its nonzero entries; small Gaussian integers, which are exact as Python's complex numbers."""

_Coordinates: TypeAlias = Callable[[_Entries], Mapping[int, float]]
"""Reads the coordinates of a matrix of the algebra."""


@explains_its_arguments
def so(n: int, q: int = 0) -> LieAlgebra:
    r"""The Lie algebra of rotations in n dimensions, or of a metric with n positive and q negative signs.

    so(3) is the cross product, $[e_i, e_j] = \varepsilon_{ijk} e_k$, and so(2, 1) is $[e_i, e_j] = \varepsilon_{ijk}
    \eta_k e_k$ with $\eta = \operatorname{diag}(1, 1, -1)$; both have the basis "1", "2", "3".  Otherwise the basis is
    $E_{ij} = (e_i e_j^T - e_j e_i^T)\,\eta$, i < j, with names "12", "13", ..., and $[X, Y] = XY - YX$: for so(n) the
    equations of H(M), $M = \sum M_{ij} E_{ij}$, are $\dot M = [M, \Omega]$, $\Omega_{ij} = \partial H/\partial M_{ij}$.

    Example:
        >>> [str(casimir) for casimir in (lp.so(4) @ lp.trivial()).casimirs()]  # the last one is the Pfaffian
        ['l12**2 + l13**2 + l14**2 + l23**2 + l24**2 + l34**2', 'l12*l34 - l13*l24 + l14*l23']

    Args:
        n: Number of positive signs of the metric.
        q: Number of negative signs, which come last.

    Raises:
        ParameterError: not integers with n >= 0, q >= 0, n + q >= 2, or more than 1000 dimensions.
    """
    n, q = read_sizes("so", (n, q), at_least=0)
    size = n + q
    _check_size("so", size * (size - 1) // 2, size >= 2, f"so({n}, {q})" if q else f"so({n})", "n + q >= 2")
    name = f"so({n},{q})" if q else f"so({n})"
    eta = [1] * n + [-1] * q
    if size == 3:
        cyclic = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        brackets = {(min(i, j), max(i, j)): {k: eta[k] * (1 if i < j else -1)} for i, j, k in cyclic}
        algebra = LieAlgebra.from_brackets(3, brackets, name, check=False)
        algebra.family = MatrixFamily("so", 3)
        return algebra
    pairs = list(combinations(range(size), 2))
    basis: list[_Entries] = [{(i, j): eta[j], (j, i): -eta[i]} for i, j in pairs]
    place = {pair: k for k, pair in enumerate(pairs)}

    def coordinates(matrix: _Entries) -> dict[int, float]:
        return {place[i, j]: eta[j] * value.real for (i, j), value in matrix.items() if i < j}

    return _of_matrices(basis, coordinates, name, index_names("", pairs, size), MatrixFamily("so", size, tuple(basis)))


@explains_its_arguments
def su(n: int) -> LieAlgebra:
    r"""The Lie algebra of unitary matrices of determinant one: antihermitian, traceless, with a rational basis.

    For j < k: $A_{jk} = E_{jk} - E_{kj}$ ("a12", ...), then $S_{jk} = i(E_{jk} + E_{kj})$ ("s12", ...), then
    $H_k = i(E_{kk} - E_{k+1,k+1})$ ("h1", ...).

    Example:
        >>> bracket = lp.su(3) @ lp.trivial()
        >>> bracket.rank(), bracket.casimir_report().degrees
        (6, (2, 3))

    Raises:
        ParameterError: n is not an integer from 2 to 31.
    """
    (n,) = read_sizes("su", (n,), at_least=2)
    _check_size("su", n * n - 1)
    pairs = list(combinations(range(n), 2))
    place, m = {pair: k for k, pair in enumerate(pairs)}, len(pairs)
    basis: list[_Entries] = [{(j, k): 1, (k, j): -1} for j, k in pairs]
    basis += [{(j, k): 1j, (k, j): 1j} for j, k in pairs]
    basis += [{(k, k): 1j, (k + 1, k + 1): -1j} for k in range(n - 1)]

    def coordinates(matrix: _Entries) -> dict[int, float]:
        found: dict[int, float] = {}
        for (j, k), value in matrix.items():
            if j < k:
                found |= {place[j, k]: value.real, m + place[j, k]: value.imag}
        return found | _diagonal_coordinates({k: v.imag for (j, k), v in matrix.items() if j == k}, 2 * m, n)

    names = index_names("a", pairs, n) + index_names("s", pairs, n) + tuple(f"h{k + 1}" for k in range(n - 1))
    return _of_matrices(basis, coordinates, f"su({n})", names, MatrixFamily("su", n, tuple(basis)))


@explains_its_arguments
def sl(n: int) -> LieAlgebra:
    r"""The Lie algebra of traceless real matrices: $E_{ij}$, i != j ("e12", ...), $E_{kk} - E_{k+1,k+1}$ ("h1", ...).

    Example:
        >>> (lp.sl(2) @ lp.trivial()).casimirs()  # minus the determinant
        [le12*le21 + lh1**2/4]
        >>> lp.sl(2).killing_signature() == lp.so(2, 1).killing_signature()
        True

    Raises:
        ParameterError: n is not an integer from 2 to 31.
    """
    (n,) = read_sizes("sl", (n,), at_least=2)
    _check_size("sl", n * n - 1)
    pairs = list(permutations(range(n), 2))
    place, m = {pair: k for k, pair in enumerate(pairs)}, len(pairs)
    basis: list[_Entries] = [{pair: 1} for pair in pairs]
    basis.extend({(k, k): 1, (k + 1, k + 1): -1} for k in range(n - 1))

    def coordinates(matrix: _Entries) -> dict[int, float]:
        found: dict[int, float] = {place[i, j]: value.real for (i, j), value in matrix.items() if i != j}
        return found | _diagonal_coordinates({k: v.real for (j, k), v in matrix.items() if j == k}, m, n)

    names = index_names("e", pairs, n) + tuple(f"h{k + 1}" for k in range(n - 1))
    return _of_matrices(basis, coordinates, f"sl({n})", names, MatrixFamily("sl", n, tuple(basis)))


@explains_its_arguments
def gl(n: int) -> LieAlgebra:
    r"""The Lie algebra of real matrices: $[E_{ij}, E_{kl}] = \delta_{jk} E_{il} - \delta_{il} E_{kj}$, "11", "12", ...

    Example:
        >>> (lp.algebras.gl(2) @ lp.trivial()).casimirs()  # trace and determinant
        [l11 + l22, l11*l22 - l12*l21]

    Raises:
        ParameterError: n is not an integer from 1 to 31.
    """
    (n,) = read_sizes("gl", (n,), at_least=1)
    _check_size("gl", n * n)
    pairs = [(i, j) for i in range(n) for j in range(n)]

    def coordinates(matrix: _Entries) -> dict[int, float]:
        return {i * n + j: value.real for (i, j), value in matrix.items()}

    basis: list[_Entries] = [{pair: 1} for pair in pairs]
    return _of_matrices(basis, coordinates, f"gl({n})", index_names("", pairs, n), MatrixFamily("gl", n, tuple(basis)))


@explains_its_arguments
def se(n: int) -> LieAlgebra:
    r"""The Lie algebra of Euclidean motions: rotations "r...", then translations "t1", ..., "tn".

    For n = 3: $[r_i, r_j] = \varepsilon_{ijk} r_k$, $[r_i, t_j] = \varepsilon_{ijk} t_k$, $[t_i, t_j] = 0$.  For n = 2:
    $[r, t_1] = t_2$, $[r, t_2] = -t_1$.  Otherwise the rotations are the $E_{ij}$ of so(n), "r12", "r13", ...

    Example:
        >>> [str(casimir) for casimir in (lp.algebras.se(3) @ lp.trivial()).casimirs()]  # those of the heavy top
        ['lr1*lt1 + lr2*lt2 + lr3*lt3', 'lt1**2 + lt2**2 + lt3**2']

    Raises:
        ParameterError: n is not an integer from 2 to 44.
    """
    (n,) = read_sizes("se", (n,), at_least=2)
    _check_size("se", n * (n + 1) // 2)
    rotations, planes, names = _rotations(n, "r")
    brackets = {**rotations.brackets, **_rotated(planes, rotations.dimension)}
    names += tuple(f"t{k + 1}" for k in range(n))
    return LieAlgebra.from_brackets(rotations.dimension + n, brackets, f"se({n})", names, check=False)


def _rotations(n: int, prefix: str) -> tuple[LieAlgebra, list[tuple[int, int]], tuple[str, ...]]:
    """so(n), the planes of its basis, and names: the rotation of the plane (i, j) maps e_j to e_i and e_i to -e_j."""
    algebra = so(n)
    planes = {2: [(1, 0)], 3: [(2, 1), (0, 2), (1, 0)]}.get(n) or list(combinations(range(n), 2))
    return algebra, planes, (prefix,) if n == 2 else tuple(f"{prefix}{name}" for name in algebra.basis_names)


def _rotated(planes: list[tuple[int, int]], start: int) -> dict[tuple[int, int], dict[int, int]]:
    """The brackets of rotations with the components of a vector, which begin at a place of the basis."""
    return {
        (k, start + b): {start + a: sign} for k, (i, j) in enumerate(planes) for a, b, sign in ((i, j, 1), (j, i, -1))
    }


@explains_its_arguments
def poincare(n: int, kappa: Parameter = 1) -> LieAlgebra:
    r"""The Poincaré algebra of n space dimensions: basis "J...", "K1", ..., "P1", ..., "H".

    Rotations J, boosts K, translations P of space and H of time: $[K_i, P_j] = \kappa\,\delta_{ij} H$,
    $[K_i, H] = P_i$, $[K_i, K_j] = -\kappa\,\varepsilon_{ijk} J_k$ for n = 3, with $\kappa = 1/c^2$; the rotations act
    on J, K and P as in `se`, whose basis and signs they have.  For $\kappa = 0$ this is `galilei(n)`, and for
    $\kappa < 0$ it is isomorphic to se(n + 1).

    Example:
        >>> lorentz = lp.algebras.poincare(3)
        >>> lorentz.basis_names
        ('J1', 'J2', 'J3', 'K1', 'K2', 'K3', 'P1', 'P2', 'P3', 'H')
        >>> [str(casimir) for casimir in (lorentz @ lp.trivial()).casimirs(2)]  # minus the square of the mass
        ['-lH**2 + lP1**2 + lP2**2 + lP3**2']

    Args:
        n: Dimensions of space; there is one of time.
        kappa: $1/c^2$, exact.

    Raises:
        ParameterError: n is not an integer from 2 to 42, or kappa is not exact.

    References: Bacry and Lévy-Leblond, J. Math. Phys. 9 (1968) 1605.
    """
    (n,) = read_sizes("poincare", (n,), at_least=2)
    _check_size("poincare", (n + 1) * (n + 2) // 2)
    value = read_parameter(kappa, "kappa")
    return _kinematical(n, value, f"poincare({n})" if value == 1 else f"poincare({n}, {value})")


@explains_its_arguments
def galilei(n: int) -> LieAlgebra:
    r"""The Galilei algebra of n space dimensions: rotations "J...", boosts "K1", ..., translations "P1", ..., and "H".

    $[K_i, H] = P_i$, $[K_i, P_j] = [K_i, K_j] = 0$; the rotations act on K and P as in `se`.  Its central extension
    $[K_i, P_j] = \delta_{ij} M$ by the mass is Bargmann's algebra: see `central_extension`.

    Example:
        >>> (lp.algebras.galilei(3) @ lp.trivial()).corank()
        2

    Args:
        n: Dimensions of space; there is one of time.

    Raises:
        ParameterError: n is not an integer from 2 to 42.

    References: Bargmann, Annals of Math. 59 (1954) 1; Lévy-Leblond (1963).
    """
    (n,) = read_sizes("galilei", (n,), at_least=2)
    _check_size("galilei", (n + 1) * (n + 2) // 2)
    return _kinematical(n, Fraction(0), f"galilei({n})")


def _kinematical(n: int, kappa: Exact, name: str) -> LieAlgebra:
    r"""Rotations, boosts and translations of space and time, as matrices: $K_i = e_i e_t^T + \kappa\,e_t e_i^T$.

    Then $[K_i, K_j] = \kappa\,(e_i e_j^T - e_j e_i^T)$, a rotation of the plane (i, j).
    """
    rotations, planes, names = _rotations(n, "J")
    boosts = rotations.dimension
    shifts, time = boosts + n, boosts + 2 * n
    brackets: dict[tuple[int, int], Mapping[int, Parameter]] = {**rotations.brackets}
    for start in (boosts, shifts):
        brackets |= _rotated(planes, start)
    for i in range(n):
        brackets[boosts + i, time] = {shifts + i: 1}
        brackets[boosts + i, shifts + i] = {time: kappa}
    for k, (i, j) in enumerate(planes):
        brackets[boosts + i, boosts + j] = {k: kappa}
    names += (*(f"K{k + 1}" for k in range(n)), *(f"P{k + 1}" for k in range(n)), "H")
    return LieAlgebra.from_brackets(time + 1, brackets, name, names, check=False)


_BIANCHI = {
    "I": (0, 0, 0, 0), "II": (1, 0, 0, 0), "III": (0, 1, -1, 1), "IV": (0, 0, 1, 1), "V": (0, 0, 0, 1),
    "VI": (0, 1, -1, None), "VII": (0, 1, 1, None), "VIII": (1, 1, -1, 0), "IX": (1, 1, 1, 0),
}  # fmt: skip
"""The numbers n_1, n_2, n_3 and a of each type; None where a is free."""


@explains_its_arguments
def bianchi(kind: str, a: Parameter | None = None) -> LieAlgebra:
    r"""The three-dimensional real Lie algebras, Bianchi's types I to IX.

    $[e_1, e_2] = -a\,e_2 + n_3 e_3$, $[e_2, e_3] = n_1 e_1$, $[e_3, e_1] = n_2 e_2 + a\,e_3$ with

    | type | I | II | III | IV | V | VI | VII | VIII | IX |
    |---|---|---|---|---|---|---|---|---|---|
    | $n_1, n_2, n_3$ | 0 0 0 | 1 0 0 | 0 1 -1 | 0 0 1 | 0 0 0 | 0 1 -1 | 0 1 1 | 1 1 -1 | 1 1 1 |
    | a | 0 | 0 | 1 | 1 | 1 | any | any | 0 | 0 |

    So II is Heisenberg's algebra, VI with a = 0 that of motions of a plane with one space and one time, VII with a = 0
    se(2), VIII sl(2) and IX so(3).  The parameter h of $\mathrm{VI}_h$ is $-a^2$, that of $\mathrm{VII}_h$ is $a^2$;
    III is $\mathrm{VI}_{-1}$.

    Example:
        >>> print(lp.algebras.cohomology(lp.algebras.bianchi("VI", "a"), 2))
        H^2(bianchi(VI, a), trivial) has dimension 0; a = -1: dimension 1; a = 0: dimension 1; a = 1: dimension 1

    Args:
        kind: "I", ..., "IX".
        a: The parameter of VI and VII, exact; 0 if left out.

    Raises:
        ParameterError: no such type, one without parameter is given one, or a is not exact.

    References: Bianchi (1898); Ellis and MacCallum, Commun. Math. Phys. 12 (1969) 108.
    """
    check_choice(kind, "kind", _BIANCHI)
    n1, n2, n3, fixed = _BIANCHI[kind]
    if fixed is not None and a is not None:
        raise ParameterError(f'a: wanted none for type {kind}; got {shown(a)}; only "VI" and "VII" have a parameter')
    value = Fraction(fixed) if fixed is not None else read_parameter(0 if a is None else a, "a")
    brackets: dict[tuple[int, int], dict[int, Parameter]] = {
        (0, 1): {1: -value, 2: n3}, (1, 2): {0: n1}, (0, 2): {1: -n2, 2: -value},
    }  # fmt: skip
    name = f"bianchi({kind})" if fixed is not None or value == 0 else f"bianchi({kind}, {value})"
    return LieAlgebra.from_brackets(3, brackets, name, check=False)


@explains_its_arguments
def heisenberg(n: int) -> LieAlgebra:
    r"""The Heisenberg algebra of n degrees of freedom: $[q_i, p_i] = c$; basis "q1", ..., "p1", ..., "c".

    Example:
        >>> bracket = lp.algebras.heisenberg(2) @ lp.trivial()
        >>> bracket.rank(), bracket.casimirs()  # the centre
        (4, [lc])

    Raises:
        ParameterError: n is not an integer from 1 to 499.
    """
    (n,) = read_sizes("heisenberg", (n,), at_least=1)
    _check_size("heisenberg", 2 * n + 1)
    names = (*(f"q{i + 1}" for i in range(n)), *(f"p{i + 1}" for i in range(n)), "c")
    brackets = {(i, n + i): {2 * n: 1} for i in range(n)}
    return LieAlgebra.from_brackets(2 * n + 1, brackets, f"heisenberg({n})", names, check=False)


@explains_its_arguments
def affine(n: int) -> LieAlgebra:
    r"""The Lie algebra of affine maps of $\mathbb R^n$, gl(n) acting on vectors: "a11", "a12", ..., "b1", ..., "bn".

    affine(1) is the algebra of $x \mapsto ax + b$ with the basis "a", "b": $[a, b] = b$.

    Example:
        >>> line = lp.algebras.affine(1)
        >>> line.basis_names, [int(number) for number in line.bracket([1, 0], [0, 1])]
        (('a', 'b'), [0, 1])
        >>> line.is_solvable, line.is_nilpotent
        (True, False)

    Raises:
        ParameterError: n is not an integer from 1 to 31.
    """
    (n,) = read_sizes("affine", (n,), at_least=1)
    _check_size("affine", n * (n + 1))
    linear = gl(n)
    # E_ij maps e_j to e_i and the other basis vectors to zero.
    action = {(i * n + j, n * n + j): {n * n + i: 1} for i in range(n) for j in range(n)}
    names = ("a",) if n == 1 else tuple(f"a{name}" for name in linear.basis_names)
    names += ("b",) if n == 1 else tuple(f"b{k + 1}" for k in range(n))
    brackets = {**linear.brackets, **action}
    return LieAlgebra.from_brackets(n * (n + 1), brackets, f"affine({n})", names, check=False)


@explains_its_arguments
def abelian(n: int) -> LieAlgebra:
    """The abelian algebra: all brackets vanish.

    Example:
        >>> lp.System(lp.algebras.abelian(2) @ lp.trivial(), "l1^2 + l2").equations  # every function is a Casimir
        {l1: 0, l2: 0}

    Raises:
        ParameterError: n is not an integer from 1 to 1000.
    """
    (n,) = read_sizes("abelian", (n,), at_least=1)
    _check_size("abelian", n)
    return LieAlgebra.from_brackets(n, {}, f"abelian({n})", check=False)


@explains_its_arguments
def sine(N: int) -> LieAlgebra:
    r"""Zeitlin's sine algebra for odd N, isomorphic to su(N): the truncated bracket of two-dimensional ideal flow.

    The Fourier coefficients of the vorticity, $w_n = c_n + i s_n$ with $w_{-n} = \overline{w_n}$, obey
    $\{w_m, w_n\} = \frac{N}{2\pi} \sin(2\pi\, m \times n/N)\, w_{m+n}$, indices modulo N.  The basis is the real form
    with coordinates $c_n, s_n$ ("c10", "s10", "c01", ..., "c1m1" for n = (1, -1)), one n of each pair (n, -n), in the
    order of `sine_modes(N)`.  The structure constants are $\pm\frac{N}{4\pi} \sin(2\pi k/N)$: numbers of the real
    subfield of $\mathbb Q(\zeta_{4N})$, divided by pi.  `sine_energy(N)` has the coefficients of the kinetic energy.

    Example:
        >>> lp.algebras.sine(3).killing_signature(), lp.su(3).killing_signature()  # both are compact
        ((0, 8, 0), (0, 8, 0))
        >>> lp.algebras.sine(3).basis_names
        ('c10', 's10', 'c01', 's01', 'c11', 's11', 'c1m1', 's1m1')

    Raises:
        ParameterError: N is not an odd integer from 3 to 31.

    References: Fairlie, Fletcher and Zachos (1989); Zeitlin (1991).
    """
    from liepoisson.structure.lie.sine_algebra import sine_brackets, sine_names

    (size,) = read_sizes("sine", (N,), at_least=3)
    _check_size("sine", size * size - 1)
    if size % 2 == 0:
        raise ParameterError(
            f"sine(N) needs an odd N, so that no mode is its own opposite; got N = {size}. Take {size - 1}."
        )
    brackets: Any = sine_brackets(size)
    algebra = LieAlgebra.from_brackets(size**2 - 1, brackets, f"sine({size})", sine_names(size), check=False)
    algebra.family = MatrixFamily("sine", size)
    return algebra


ALGEBRAS: dict[str, Callable[..., LieAlgebra]] = {
    "abelian": abelian,
    "affine": affine,
    "galilei": galilei,
    "gl": gl,
    "heisenberg": heisenberg,
    "poincare": poincare,
    "se": se,
    "sine": sine,
    "sl": sl,
    "so": so,
    "su": su,
}
"""The constructors by the name that system files use; each takes one integer, `so` and `poincare` may take two."""


def read_sizes(name: str, sizes: tuple[object, ...], at_least: int) -> tuple[int, ...]:
    """Read sizes, of whatever integer type (NumPy's and SymPy's, too), and refuse those below a least value.

    Raises:
        ParameterError: one of them is not an integer, or too small.
    """
    read: list[int] = []
    for size in sizes:
        if isinstance(size, bool) or not isinstance(size, Integral) or int(size) < at_least:
            raise ParameterError(
                f"{name}(n) needs an integer n >= {at_least}; got {size!r}. Write for example {name}(3)."
            )
        read.append(int(size))
    return tuple(read)


def _check_size(name: str, dimension: int, wide_enough: bool = True, got: str = "", wanted: str = "") -> None:
    if not wide_enough:
        raise ParameterError(f"{name} needs {wanted}; got {got}. Write for example {name}(3).")
    if dimension > MAX_DIMENSION:
        raise ParameterError(
            f"{name}(n) is available up to {MAX_DIMENSION} dimensions; got an n that needs {dimension}. "
            "Take a smaller n."
        )


def index_names(prefix: str, pairs: list[tuple[int, int]], n: int) -> tuple[str, ...]:
    """Names such as "12" of index pairs, counted from 1 in the names; "1_10" where an index has two digits."""
    separators = ["_" if max(i, j) >= 9 and n >= 10 else "" for i, j in pairs]
    return tuple(f"{prefix}{i + 1}{s}{j + 1}" for (i, j), s in zip(pairs, separators, strict=True))


def _diagonal_coordinates(diagonal: dict[int, float], start: int, n: int) -> dict[int, float]:
    """The coordinates of a traceless diagonal along $E_{kk} - E_{k+1,k+1}$: its partial sums."""
    found: dict[int, float] = {}
    total = 0.0
    for k in range(n - 1 if diagonal else 0):
        total += diagonal.get(k, 0)
        found[start + k] = total
    return found


def _of_matrices(
    basis: list[_Entries], coordinates: _Coordinates, name: str, names: tuple[str, ...], family: MatrixFamily
) -> LieAlgebra:
    """The algebra of the commutators XY - YX of matrices whose coordinates are known in closed form."""
    having: dict[int, set[int]] = {}
    for k, matrix in enumerate(basis):
        for pair in matrix:
            for index in pair:
                having.setdefault(index, set()).add(k)
    brackets: dict[tuple[int, int], dict[int, Fraction]] = {}
    for i, matrix in enumerate(basis):
        # Matrices without a common index commute.
        for j in sorted(set[int]().union(*(having[index] for pair in matrix for index in pair))):
            if j > i:
                row = coordinates(_commutator(matrix, basis[j]))
                brackets[i, j] = {k: Fraction(int(c)) for k, c in row.items()}
    algebra = LieAlgebra.from_brackets(len(basis), brackets, name, names, check=False)
    algebra.family = family
    return algebra


def _commutator(x: _Entries, y: _Entries) -> _Entries:
    result: _Entries = {}
    for sign, left, right in ((1, x, y), (-1, y, x)):
        for (i, j), a in left.items():
            for (k, l), b in right.items():
                if j == k:
                    result[i, l] = result.get((i, l), 0) + sign * a * b
    return result


@explains_its_arguments
def semidirect_sum(
    algebra: LieAlgebra,
    representation: Sequence[object],
    name: str | None = None,
    module_names: Sequence[str] | None = None,
) -> LieAlgebra:
    r"""The semidirect sum $g \ltimes V$: $[e_i, v] = \rho_i v$, $[V, V] = 0$; the basis of g first.

    Example:
        >>> so3 = lp.so(3)
        >>> motions = lp.algebras.semidirect_sum(so3, so3.adjoint_representation())  # so(3) acts on vectors
        >>> motions.brackets == lp.algebras.se(3).brackets
        True

    Args:
        algebra: The Lie algebra g.
        representation: The matrices $\rho_i$ on V, exact, shape (dim g, dim V, dim V); complex ones act on the real
            space of twice the dimension, real parts first.
        name: How it is printed.
        module_names: Names of the basis of V; "v1", "v2", ... if left out.

    Raises:
        ShapeError: not one square matrix per basis element of g.
        BracketError: not a representation; the message names the pair $[\rho_i, \rho_j] \ne c_{ij}^k \rho_k$.
        ParameterError: an entry is not exact.
    """
    columns = read_representation(algebra, representation)
    n, m = algebra.dimension, len(columns[0])
    action = {
        (i, n + j): {n + k: c for k, c in column.items()}
        for i, rho in enumerate(columns)
        for j, column in enumerate(rho)
        if column
    }
    given = read_names(module_names, "module_names", tuple(f"v{j + 1}" for j in range(m)))
    names = joined_names(algebra.basis_names, given)
    sum_name = f"{algebra.name} ⋉ R^{m}" if name is None else name
    return LieAlgebra.from_brackets(n + m, {**algebra.brackets, **action}, sum_name, names, check=False)


def read_representation(algebra: LieAlgebra, matrices: Sequence[object]) -> list[list[dict[int, Exact]]]:
    r"""The columns of the matrices $\rho_i$, sparse, after a check that $[\rho_i, \rho_j] = c_{ij}^k \rho_k$.

    Raises:
        ShapeError: not one square matrix per basis element, all of one size.
        BracketError: not a representation; the message names the pair.
    """
    from liepoisson.algebra.coefficients import Coefficients
    from liepoisson.structure.lie.sparse_matrices import add_multiple, commutator, entries_of, in_field, read_matrices

    read, size = read_matrices(matrices, "representation")
    if len(read) != algebra.dimension:
        raise ShapeError(
            f"representation must be {algebra.dimension} matrices, one per basis element of {algebra.name}; "
            f"got {len(read)}."
        )
    constants = [c for row in algebra.brackets.values() for c in row.values()]
    field = Coefficients.containing([*constants, *entries_of(read)])
    basis = [in_field(matrix, field) for matrix in read]
    for i, j in combinations(range(algebra.dimension), 2):
        left = commutator(basis[i], basis[j], field)
        for k, c in algebra.brackets.get((i, j), {}).items():
            add_multiple(left, basis[k], -field.read(c))
        for r, row in sorted(left.items()):
            for c, value in sorted(row.items()):
                if not field.vanishes(value):
                    raise BracketError(
                        f"representation must obey [rho_i, rho_j] = c_ij^k rho_k; it fails for (i, j) = ({i}, {j}): "
                        f"the difference has the entry {field.write(value, 2)} at ({r}, {c}) instead of 0. "
                        "Check these two matrices and those of their bracket."
                    )
    return [[{k: row[j] for k, row in matrix.items() if j in row} for j in range(size)] for matrix in read]
