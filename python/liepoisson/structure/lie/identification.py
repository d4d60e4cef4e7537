r"""Which real Lie algebra of dimension four or less an algebra is, by its name and parameters.

The nilradical N and the matrix M of ad x on it, x outside of it, decide; M is given up to conjugation and a factor.
Dimension three: N = R^2, and M is a matrix of order two.  Dimension four:

* N of dimension 4: nilpotent, and the dimension of [g, g] decides;
* N = R^3: the eigenvalues of M and their Jordan blocks;
* N Heisenberg's algebra with the centre z: the eigenvalues and Jordan blocks of M on N / z, as M is their sum on z;
* N = R^2: two elements act on it like the numbers R + R, or C;
* not solvable: the Levi factor is of dimension three, its Killing form decides, and the radical is a summand.

References: Mubarakzyanov (1963); [pswz1976].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.echelon import Echelon, Vector
from liepoisson.algebra.exact_numbers import Exact, is_zero, to_sympy
from liepoisson.algebra.matrices import characteristic_polynomial
from liepoisson.algebra.real_fields import RealField, RealRationals, real_field
from liepoisson.errors import ParameterError, TimeLimitError
from liepoisson.formula.scalars import as_deadline
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.deadline import SEARCH_LIMIT, checkpoint
from liepoisson.inputs.refusals import check_kind
from liepoisson.structure.lie import levi
from liepoisson.structure.lie.lie_structure import LieStructure
from liepoisson.structure.lie.low_dimensional import low_dimensional
from liepoisson.structure.lie_algebra import LieAlgebra

if TYPE_CHECKING:
    from sympy import Expr

_BIANCHI = {
    "3A1": "I", "A3,1": "II", "A2+A1": "III", "A3,2": "IV", "A3,3": "V", "A3,4": "VI", "A3,5": "VI", "A3,6": "VII",
    "A3,7": "VII", "A3,8": "VIII", "A3,9": "IX",
}  # fmt: skip


@explains_its_methods
@dataclass(frozen=True)
class Identification:
    """The name of a real Lie algebra of dimension four or less.

    Example:
        >>> found = lp.algebras.identify(lp.algebras.bianchi("VI", 3))
        >>> print(found)
        A3,5 with a = 1/2: Bianchi VI

    Attributes:
        name: The name that `low_dimensional` takes; None where it is undecided.
        parameters: The values of its parameters a and b.
        reason: Why it is undecided, or "".
    """

    name: str | None
    parameters: dict[str, Exact] = field(default_factory=dict[str, Exact], hash=False)
    reason: str = ""

    @property
    def bianchi(self) -> str | None:
        """Bianchi's type in dimension three, "I" to "IX"."""
        return None if self.name is None else _BIANCHI.get(self.name)

    @property
    def algebra(self) -> LieAlgebra:
        """The algebra of the table.

        Raises:
            ParameterError: the name is undecided.
        """
        if self.name is None:
            raise ParameterError(f"wanted an algebra with a known name; got one that is undecided: {self.reason}.")
        parameters: Any = self.parameters
        return low_dimensional(self.name, **parameters)

    def __str__(self) -> str:
        if self.name is None:
            return f"undecided: {self.reason}"
        values = ", ".join(f"{key} = {value}" for key, value in self.parameters.items())
        return self.name + (f" with {values}" if values else "") + (f": Bianchi {self.bianchi}" if self.bianchi else "")


@explains_its_arguments
def identify(algebra: LieAlgebra, *, time_limit: float = SEARCH_LIMIT) -> Identification:
    r"""The name of an algebra in the table of `low_dimensional`: two are isomorphic if and only if they have the same.

    Example:
        >>> twisted = lp.LieAlgebra.from_brackets(3, {(0, 1): {2: 2}, (1, 2): {0: 3}, (0, 2): {1: 5}})
        >>> print(lp.algebras.identify(twisted))
        A3,8: Bianchi VIII

    Args:
        algebra: Up to four dimensions, without symbols.
        time_limit: Seconds; one operation of SymPy in a field of high degree may take some more.

    Returns:
        The name and the parameters, exact; undecided where symbols are left, where SymPy has no exact field, and where
        the time has passed, with what was under way.

    Raises:
        ParameterError: it is not a Lie algebra, or has more than four dimensions.
    """
    check_kind(algebra, LieAlgebra, "algebra", "a Lie algebra", 'try algebras.bianchi("IX")')
    if algebra.dimension > 4:
        raise ParameterError(
            f"algebra: wanted at most four dimensions, in which all algebras have names; got {algebra.dimension}; its "
            "levi_factor() and nilradical() say what it is made of"
        )
    if algebra.symbols:
        shown = ", ".join(sorted(algebra.symbols))
        return Identification(None, reason=f"the name depends on {shown}; substitute values")
    try:
        with as_deadline(time_limit).running():
            name, parameters = _identified(algebra)
    except (ParameterError, TimeLimitError) as error:  # SymPy has no exact field, or cannot count roots in it
        return Identification(None, reason=str(error))
    return Identification(name, {key: _written(value) for key, value in parameters.items()})


_DIGITS = 50
"""Of comparisons between eigenvalues that are known to differ."""

_Answer = tuple[str, dict[str, Any]]


def _identified(algebra: LieAlgebra) -> _Answer:
    n = algebra.dimension
    checkpoint("the proof that the algebra is solvable or not")
    if algebra.is_abelian:
        return ("A1" if n == 1 else f"{n}A1"), {}
    if not algebra.is_solvable:
        positive = algebra.killing_signature()[0] > 0
        return ("A3,8" if positive else "A3,9") + ("" if n == 3 else "+A1"), {}
    if n == 2:
        return "A2", {}
    if algebra.is_nilpotent:
        return ("A4,1" if algebra.derived_series()[1].dimension == 2 else "A3,1" + ("" if n == 3 else "+A1")), {}
    return _solvable(LieStructure(n, algebra.brackets))


def _solvable(g: LieStructure) -> _Answer:
    """A solvable algebra of dimension three or four that is not nilpotent."""
    checkpoint("the search for the nilradical")
    N = levi.nilradical(g)
    matrices, field = _matrices(g, N)
    blocks = [_Block.of(m, field) for m in matrices] if len(N) == 2 else []
    if blocks and g.dimension == 3:
        return _planar(blocks[0], "")
    if blocks:
        split = next(block for block in blocks if not block.is_scalar)
        return ("2A2" if split.sign > 0 else "A4,12"), {}
    centre = _centre(g, N)
    if len(centre) == 3:
        return _spatial(matrices[0], field)
    return _over_heisenberg(_Block.of(_on_quotient(g, N, centre), field))


# Matrices of order two


@dataclass(frozen=True)
class _Block:
    """A matrix of order two: its trace and determinant, the sign of its discriminant, and whether it is scalar."""

    trace: Any
    determinant: Any
    sign: int
    is_scalar: bool
    field: RealField

    @classmethod
    def of(cls, m: Sequence[Sequence[Any]], field: RealField) -> _Block:
        t, d = m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]
        return cls.with_invariants(t, d, field, not m[0][1] and not m[1][0] and m[0][0] == m[1][1])

    @classmethod
    def with_invariants(cls, t: Any, d: Any, field: RealField, is_scalar: bool = False) -> _Block:
        disc = t * t - field.number(4) * d
        return cls(t, d, field.sign(disc) if disc else 0, is_scalar, field)

    @property
    def ratio(self) -> Any:
        """The smaller real eigenvalue by the larger one; -1 where they are opposite to each other."""
        if not self.trace:
            return to_sympy(Fraction(-1))
        larger, smaller = self.roots if self.field.sign(self.trace) > 0 else reversed(self.roots)
        return _ratio(smaller, larger)

    @property
    def slope(self) -> Any:
        """Real part by imaginary part of complex eigenvalues, not negative."""
        t = self.trace if self.field.sign(self.trace) > 0 else -self.trace
        return _ratio(self._write(t), self.width)

    @property
    def roots(self) -> tuple[Any, Any]:
        """Real eigenvalues, the larger one first."""
        t = self._write(self.trace)
        return (t + self.width) / 2, (t - self.width) / 2

    @property
    def width(self) -> Any:
        """The positive square root of the discriminant, or of its opposite."""
        from sympy import sqrt

        checkpoint(f"the square root of a discriminant over {self.field.name}")
        disc = self.trace * self.trace - self.field.number(4) * self.determinant
        factor, radicand = self.field.extract_square(disc if self.sign > 0 else -disc)
        factor = factor if self.field.sign(factor) > 0 else -factor
        root: Any = sqrt(self._write(radicand))
        return self._write(factor) * root

    def _write(self, value: Any) -> Any:
        return to_sympy(self.field.write(value))


def _planar(block: _Block, summand: str) -> _Answer:
    """The algebra of dimension three with the matrix on the plane, plus a summand."""
    if not block.determinant:
        return ("A2+A1" if not summand else "A2+2A1"), {}
    if block.sign < 0:
        return (f"A3,7{summand}", {"a": block.slope}) if block.trace else (f"A3,6{summand}", {})
    if block.sign == 0:
        return ("A3,3" if block.is_scalar else "A3,2") + summand, {}
    return (f"A3,5{summand}", {"a": block.ratio}) if block.trace else (f"A3,4{summand}", {})


def _over_heisenberg(block: _Block) -> _Answer:
    """Dimension four with Heisenberg's algebra as nilradical."""
    if not block.trace:
        return ("A4,8" if block.sign > 0 else "A4,10"), {}
    if block.sign < 0:
        return "A4,11", {"a": block.slope}
    if block.sign == 0:
        return ("A4,9", {"b": to_sympy(Fraction(1))}) if block.is_scalar else ("A4,7", {})
    return "A4,9", {"b": block.ratio}


# Matrices of order three


def _spatial(m: list[list[Any]], field: RealField) -> _Answer:
    """Dimension four with the nilradical R^3, on which x acts by a matrix that is not nilpotent."""
    checkpoint(f"the search for eigenvalues of ad x on the nilradical over {field.name}")
    polynomial = characteristic_polynomial(m, field.number)[::-1]
    factors = field.factors(polynomial)
    linear = [-f[1] for f in factors if len(f) == 2]
    largest = max(factors, key=len)
    if len(largest) == 4:
        return _irreducible(largest, field)
    if len(largest) == 3:
        (r,) = linear
        block = _Block.with_invariants(-largest[1], largest[2], field)
        if not r:
            return _planar(block, "+A1")
        root = to_sympy(field.write(r))
        return _of_pair(root, block) if block.sign < 0 else _of_three([root, *block.roots])
    if len(linear) == 3:
        if not all(linear):
            x, y = (r for r in linear if r)
            return _planar(_Block.with_invariants(x + y, x * y, field), "+A1")
        return _of_three([to_sympy(field.write(r)) for r in linear])
    return _with_multiple_root(m, linear, field)


def _with_multiple_root(m: list[list[Any]], roots: list[Any], field: RealField) -> _Answer:
    """Two different eigenvalues, or one, all in the field."""
    kernels = [_kernel(m, r, field) for r in roots]
    if len(roots) == 1:
        name = {3: "A4,5", 2: "A4,2", 1: "A4,4"}[kernels[0]]
        one = to_sympy(Fraction(1))
        return name, {"A4,5": {"a": one, "b": one}, "A4,2": {"a": one}, "A4,4": {}}[name]
    trace = m[0][0] + m[1][1] + m[2][2]
    double, simple = roots if trace == roots[0] + roots[0] + roots[1] else reversed(roots)
    is_diagonal = sum(kernels) == 3
    if not simple:
        return ("A3,3+A1" if is_diagonal else "A3,2+A1"), {}
    if not double:
        return ("A2+2A1" if is_diagonal else "A4,3"), {}
    twice, once = to_sympy(field.write(double)), to_sympy(field.write(simple))
    return _of_three([twice, twice, once]) if is_diagonal else ("A4,2", {"a": _ratio(once, twice)})


def _irreducible(polynomial: Sequence[Any], field: RealField) -> _Answer:
    """Three real eigenvalues, or one, that are roots of an irreducible cubic polynomial with rational coefficients."""
    from sympy import Dummy, Poly, sqrt

    if not isinstance(field, RealRationals):
        raise ParameterError(
            f"the eigenvalues of ad x on the nilradical are roots of an irreducible cubic polynomial over {field.name}"
        )
    cubic: Any = Poly.from_list([to_sympy(c) for c in polynomial], Dummy("x"))
    real: list[Any] = cubic.real_roots()
    if len(real) == 3:
        return _of_three(real)
    # x^3 + p x^2 + q x + s = (x - r) (x^2 + (p + r) x + q + r (p + r))
    r, p, q = real[0], to_sympy(polynomial[1]), to_sympy(polynomial[2])
    t, d = -(p + r), q + r * (p + r)
    return _normal_pair(r, t, sqrt(4 * d - t * t))


def _of_pair(r: Any, block: _Block) -> _Answer:
    return _normal_pair(r, to_sympy(block.field.write(block.trace)), block.width)


def _normal_pair(r: Any, t: Any, width: Any) -> _Answer:
    """A real eigenvalue, and (t +- i width)/2: with b >= 0, and a > 0 where b = 0."""
    flip = t.evalf(_DIGITS) < 0 or (is_zero(t) and r.evalf(_DIGITS) < 0)
    sign = -1 if flip else 1
    return "A4,6", {"a": _ratio(sign * 2 * r, width), "b": _ratio(sign * t, width)}


def _of_three(values: list[Any]) -> _Answer:
    """Real eigenvalues other than 0: the ratios to one of the largest, with the largest b, then a."""
    candidates: list[tuple[Any, Any]] = []
    for k, v in enumerate(values):
        ratios = [_ratio(w, v) for j, w in enumerate(values) if j != k]
        if all(is_zero(abs(x) - 1) or abs(x).evalf(_DIGITS) < 1 for x in ratios):
            ratios.sort(key=lambda x: x.evalf(_DIGITS))
            candidates.append((ratios[1], ratios[0]))
    b, a = max(candidates, key=lambda pair: tuple(x.evalf(_DIGITS) for x in pair))
    return "A4,5", {"a": a, "b": b}


def _ratio(x: Any, y: Any) -> Any:
    from sympy import radsimp

    checkpoint("the ratio of two eigenvalues")
    quotient: Any = x / y
    return radsimp(quotient)


def _kernel(m: list[list[Any]], r: Any, field: RealField) -> int:
    rows = [{c: x - r if c == k else x for c, x in enumerate(row)} for k, row in enumerate(m)]
    return len(m) - len(Echelon(field, [{c: x for c, x in row.items() if x} for row in rows]))


# Matrices of ad x


def _matrices(g: LieStructure, N: list[Vector]) -> tuple[list[list[list[Any]]], RealField]:
    """The matrices of ad e_k on the nilradical for the basis elements that complete it."""
    outside = [k for k in range(g.dimension) if k not in {min(v) for v in N}]
    exact = [_matrix(g, {k: g.field.one}, N, []) for k in outside]
    checkpoint("the search for the number field of the entries of ad x on the nilradical")
    field = real_field(c for m in exact for row in m for c in row)
    return [[[field.read(c) for c in row] for row in m] for m in exact], field


def _on_quotient(g: LieStructure, N: list[Vector], centre: list[Vector]) -> list[list[Any]]:
    """The matrix on N modulo its centre."""
    (k,) = [k for k in range(g.dimension) if k not in {min(v) for v in N}]
    span = Echelon(g.field, centre)
    exact = _matrix(g, {k: g.field.one}, [v for v in N if span.insert(v)], centre)
    field = real_field(c for row in exact for c in row)
    return [[field.read(c) for c in row] for row in exact]


def _matrix(g: LieStructure, x: Vector, basis: list[Vector], modulo: list[Vector]) -> list[list[Exact]]:
    """The matrix of ad x on a basis, modulo a subspace; its columns are images."""
    end, n = g.dimension, len(basis)
    span = Echelon(g.field, modulo)
    for a, v in enumerate(basis):
        span.insert({**v, end + a: g.field.one})
    images = [span.reduce(g.bracket(x, v)) for v in basis]
    zero: Exact = Fraction(0)
    return [[g.field.write(-image[end + r], 1) if end + r in image else zero for image in images] for r in range(n)]


def _centre(g: LieStructure, N: list[Vector]) -> list[Vector]:
    """The elements of N that commute with N."""
    equations = Echelon(g.field)
    for v in N:
        components: dict[int, Vector] = {}
        for a, u in enumerate(N):
            for k, c in g.bracket(u, v).items():
                components.setdefault(k, {})[a] = c
        for row in components.values():
            equations.insert(row)
    found: list[Vector] = []
    for vector in equations.null_space(len(N)):
        total: Vector = {}
        for a, c in vector.items():
            for k, value in N[a].items():
                total[k] = total[k] + c * value if k in total else c * value
        found.append({k: value for k, value in total.items() if not g.field.vanishes(value)})
    return found


def _written(value: Expr) -> Exact:
    number: Any = value
    return Fraction(int(number.p), int(number.q)) if number.is_Rational else number
