r"""Linear symmetries of brackets that act on the fields: maps, derivations and scalings of the algebra A.

A linear map $x_\mu \mapsto \sum_\nu P_{\mu\nu} x_\nu$ of fields takes the bracket of g (x) A to that of g (x) A' if and
only if (unless g is abelian; a constant part must be taken to that of the other besides)

$$\sum_{\alpha\beta} P_{\mu\alpha} P_{\nu\beta} W_\lambda{}^{\alpha\beta}
  = \sum_\kappa W'_\kappa{}^{\mu\nu} P_{\kappa\lambda} .$$

For the twisted top these are $\alpha \mapsto \alpha + d\beta$, and $\alpha \mapsto s\alpha$,
$\beta \mapsto u\beta$, which takes epsilon to $\epsilon s^2/u$.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import gcd, lcm
from typing import TYPE_CHECKING, Any

from liepoisson.calls import explains_its_methods
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.exact.linear.coefficients import Coefficients
from liepoisson.exact.linear.linear_algebra import nullspace
from liepoisson.exact.names import free_name
from liepoisson.exact.parameters import (
    Exact,
    Parameter,
    as_expression,
    is_zero,
    read_parameter,
    symbols_of,
    to_sympy,
)
from liepoisson.given import listed

if TYPE_CHECKING:
    from sympy import Expr, Matrix

    from liepoisson.exact.bracket import Bracket
    from liepoisson.exact.extension import Extension


@explains_its_methods
class Automorphism:
    """A linear map of the fields, the same for all components.

    Example:
        >>> bracket = lp.so(3) @ lp.semidirect(3)
        >>> swap = lp.brackets.Automorphism([[1, 0, 0], [0, 0, 1], [0, 1, 0]])
        >>> swap.describe(bracket), swap.is_poisson(bracket), swap.is_poisson(lp.so(3) @ lp.leibniz(3))
        ('alpha -> beta, beta -> alpha', True, False)

    Args:
        matrix: P, exact, shape (n, n): field mu goes to the sum of P[mu][nu] times field nu.

    Raises:
        ShapeError: the matrix is not square.
        ParameterError: an entry is not exact.
    """

    def __init__(self, matrix: Sequence[Sequence[Parameter]]) -> None:
        rows = [listed(row, "matrix") for row in listed(matrix, "matrix") or []]
        if not rows or any(row is None or len(row) != len(rows) for row in rows):
            raise ShapeError(f"matrix must have shape (n, n), one row per field; got {matrix!r}.")
        self.matrix: tuple[tuple[Exact, ...], ...] = tuple(
            tuple(read_parameter(value, f"matrix[{i}][{j}]") for j, value in enumerate(row or []))
            for i, row in enumerate(rows)
        )

    def is_poisson(self, source: Bracket, target: Bracket | None = None) -> bool:
        """Whether this takes the bracket of the source to that of the target, decided entry by entry of W.

        Args:
            source: Bracket of the states that are mapped.
            target: Bracket of their images; that of the source if left out.

        Raises:
            ParameterError: the two have different Lie algebras.
            ShapeError: the matrix does not have one row per field.
        """
        image = source if target is None else target
        self._check(source)
        self._check(image)
        if source.algebra is not image.algebra and source.algebra.brackets != image.algebra.brackets:
            raise ParameterError(
                f"both brackets must have the same Lie algebra; got {source.algebra!r} and {image.algebra!r}."
            )
        if not self._keeps_constant_parts(source, image):
            return False
        return not source.algebra.brackets or not any(self.residuals(source.extension, image.extension).values())

    def _keeps_constant_parts(self, source: Bracket, target: Bracket) -> bool:
        """Whether the constant part of the one becomes that of the other."""
        if not source.constant and not target.constant:
            return True
        from sympy import Add

        P, n = [[to_sympy(value) for value in row] for row in self.matrix], source.algebra.dimension
        sums: dict[tuple[int, int], list[Any]] = {}
        for (a, i), (b, j), c in _constants(source):
            for mu, nu in product(range(len(P)), repeat=2):
                sums.setdefault((mu * n + i, nu * n + j), []).append(P[mu][a] * P[nu][b] * to_sympy(c))
        for (mu, i), (nu, j), c in _constants(target):
            sums.setdefault((mu * n + i, nu * n + j), []).append(-to_sympy(c))
        return all(is_zero(Add(*terms)) for terms in sums.values())

    def residuals(self, source: Extension, target: Extension) -> dict[tuple[int, int, int], Expr]:
        """The difference of the two sides of the condition, by (lam, mu, nu); zero for a homomorphism."""
        from sympy import Add, simplify

        P = [[to_sympy(value) for value in row] for row in self.matrix]
        first = [(a, b, k, to_sympy(w)) for a, b, k, w in _products(source)]
        second = [(m, v, k, to_sympy(w)) for m, v, k, w in _products(target)]
        n = range(len(P))
        return {
            (lam, mu, nu): simplify(
                Add(
                    *(P[mu][a] * P[nu][b] * w for a, b, k, w in first if k == lam),
                    *(-w * P[k][lam] for m, v, k, w in second if (m, v) == (mu, nu)),
                )
            )
            for lam, mu, nu in product(n, repeat=3)
        }

    def apply(self, expression: Expr, bracket: Bracket) -> Expr:
        """The function after the map: every field replaced by its image.

        Args:
            expression: A function of `bracket.variables`.
            bracket: Says which coordinates make up the fields.

        Raises:
            ParameterError: it is no expression, or has a part that is like a coordinate and none.
        """
        from liepoisson.exact.bracket import read_function

        self._check(bracket)
        fields: list[Any] = list(bracket.fields.values())
        images: list[Any] = [
            sum((to_sympy(p) * f for p, f in zip(row, fields, strict=True)), 0 * fields[0]) for row in self.matrix
        ]
        flat = [component for image in images for component in image]
        function: Any = read_function(bracket, expression, "expression")
        image: Any = function.subs(dict(zip(bracket.variables, flat, strict=True)), simultaneous=True)
        return image

    def describe(self, bracket: Bracket) -> str:
        """The map in words, for example "alpha -> alpha + d*beta"."""
        return _arrows(bracket, [[to_sympy(value) for value in row] for row in self.matrix])

    def _check(self, bracket: Bracket) -> None:
        if len(self.matrix) != bracket.extension.dimension:
            raise ShapeError(f"matrix must have {bracket.extension.dimension} rows; got {len(self.matrix)}.")


@explains_its_methods
@dataclass(frozen=True)
class Derivation:
    r"""An infinitesimal symmetry: $D(e_\mu e_\nu) = D(e_\mu) e_\nu + e_\mu D(e_\nu)$.

    Example:
        >>> [(one.kind, one.text) for one in (lp.so(3) @ lp.leibniz(3)).derivations()]
        [('grading', 'alpha -> s*alpha, beta -> s^2*beta'), ('nilpotent', 'alpha -> alpha + d*beta')]

    Attributes:
        matrix: $D(e_\mu) = \sum_\nu$ `matrix[mu][nu]` $e_\nu$; the field mu moves with the same combination of fields.
        kind: "grading" (diagonal), "nilpotent" or "general".
        text: The one-parameter group in words ("alpha -> alpha + d*beta"), or the vector field of a general one.
    """

    matrix: tuple[tuple[Exact, ...], ...]
    kind: str
    text: str

    @property
    def weights(self) -> tuple[Exact, ...] | None:
        """The weights of the fields, for a grading."""
        return tuple(self.matrix[k][k] for k in range(len(self.matrix))) if self.kind == "grading" else None

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Scaling:
    r"""Fields multiplied by powers of a number s take the bracket to the one with other values of its parameters.

    Attributes:
        weights: Field mu goes to $s^{w_\mu} x_\mu$.
        parameters: The parameter p goes to $s^{k} p$ with k = `parameters[p]`.
        text: In words, for example "beta -> s*beta takes epsilon to epsilon/s".
    """

    weights: tuple[int, ...]
    parameters: Mapping[str, int]
    text: str

    def __str__(self) -> str:
        return self.text


def derivations(bracket: Bracket) -> list[Derivation]:
    """A basis of the derivations of A, gradings with the simplest weights first (exact null space)."""
    A = bracket.extension
    n, terms = A.dimension, _products(A)
    constants = _constants(bracket)
    field = Coefficients.containing(value for *_, value in (*terms, *constants))
    rows: dict[tuple[object, ...], dict[int, Any]] = {}

    def add(key: tuple[object, ...], column: int, value: Any) -> None:
        row = rows.setdefault(key, {})
        row[column] = row[column] + value if column in row else value

    for mu, nu, lam, w in terms:
        value = field.read(w)
        for k in range(n):
            add((mu, nu, k), lam * n + k, value)  # D(e_mu e_nu)
            add((k, nu, lam), k * n + mu, -value)  # D(e_k) e_nu, with e_mu a part of D(e_k)
            add((mu, k, lam), k * n + nu, -value)  # e_mu D(e_k)
    for first, second, c in constants:
        value = field.read(c)
        for k in range(n):
            add(((k, first[1]), second), k * n + first[0], value)  # c(D e_k, .)
            add((first, (k, second[1])), k * n + second[0], value)  # c(., D e_k)
    matrix = [{c: v for c, v in row.items() if v} for row in rows.values()]
    vectors = nullspace(matrix, n * n, field).vectors
    found = [
        _derivation(
            bracket, [[field.to_sympy(v[i * n + j]) if i * n + j in v else 0 for j in range(n)] for i in range(n)]
        )
        for v in vectors
    ]
    return sorted(found, key=lambda d: ("grading", "nilpotent", "general").index(d.kind))


def scalings(bracket: Bracket) -> list[Scaling]:
    """A basis of the scalings of fields under which every product of A keeps its form.

    A product whose coefficient is a rational multiple of one parameter may be rescaled with this parameter; all the
    other products must stay as they are.
    """
    A = bracket.extension
    n, rationals = A.dimension, Coefficients()
    constants = [((first[0], 1), (second[0], 1), c) for first, second, c in _constants(bracket)]
    names = sorted({name for *_, c in constants for name in symbols_of(c)} | A.symbols)
    rows: list[dict[int, Any]] = []
    products = [((mu, 1), (nu, 1), (lam, -1), w) for mu, nu, lam, w in _products(A)]
    for *signs, w in [*products, *constants]:
        row: dict[int, int] = {}
        for k, sign in signs:
            row[k] = row.get(k, 0) - sign  # the coefficient goes to s^(w_mu + w_nu - w_lam) times itself
        parameter = _single_parameter(w)
        if parameter is None and not isinstance(w, Fraction) and w.free_symbols:
            return []
        if parameter is not None:
            row[n + names.index(parameter)] = 1
        rows.append({k: rationals.number(v) for k, v in row.items() if v})
    found = []
    for vector in nullspace(rows, n + len(names), rationals).vectors:
        integer = _integers([vector.get(k, Fraction(0)) for k in range(n + len(names))])
        powers = dict(zip(names, integer[n:], strict=True))
        found.append(Scaling(tuple(integer[:n]), powers, _scaling_text(bracket, integer[:n], powers)))
    return found


def _products(A: Extension) -> list[tuple[int, int, int, Exact]]:
    """All (mu, nu, lam, w) with w the nonzero coefficient of e_mu e_nu along e_lam, both orders."""
    W, n = A.tensor, range(A.dimension)
    return [(m, v, k, W[k][m][v]) for m, v, k in product(n, repeat=3) if not is_zero(W[k][m][v])]


def _constants(bracket: Bracket) -> list[tuple[tuple[int, int], tuple[int, int], Exact]]:
    """The constant part, both orders: (field, component), (field, component), value."""
    n = bracket.algebra.dimension
    terms = [(divmod(i, n), divmod(j, n), c) for (i, j), c in bracket.constant.items()]
    return [entry for i, j, c in terms for entry in ((i, j, c), (j, i, -c))]


def _single_parameter(w: Exact) -> str | None:
    """The name of the parameter of which w is a rational multiple."""
    if isinstance(w, Fraction):
        return None
    factor, rest = w.as_coeff_Mul()
    return str(rest) if rest.is_Symbol and factor.is_Rational else None


def _derivation(bracket: Bracket, entries: list[list[Any]]) -> Derivation:
    from sympy import Matrix, Symbol, eye, factorial

    n = len(entries)
    entries = _scaled(entries)
    D: Matrix = Matrix(entries)
    exact = tuple(tuple(read_parameter(value, "D") for value in row) for row in entries)
    if D.is_diagonal():
        weights = [entries[k][k] for k in range(n)]
        scaled = [f"{name} -> {_power(w)}*{name}" for name, w in zip(bracket.field_names, weights, strict=True) if w]
        return Derivation(exact, "grading", ", ".join(scaled))
    if (D**n).is_zero_matrix:
        d = Symbol(free_name("d", {*bracket.symbols, *bracket.field_names}))
        flow: Any = eye(n)
        for k in range(1, n):
            flow += (d * D) ** k / factorial(k)
        return Derivation(exact, "nilpotent", _arrows(bracket, flow.tolist()))
    return Derivation(exact, "general", _arrows(bracket, entries, " moves with ", identity=False))


def _scaled(entries: list[list[Any]]) -> list[list[Any]]:
    """A multiple with coprime integers, the first of them positive, if all entries are rational."""
    from sympy import Rational

    flat: list[Any] = [Rational(value) if value == 0 else value for row in entries for value in row]
    if not all(value.is_Rational for value in flat):
        return entries
    integer = _integers([Fraction(int(value.p), int(value.q)) for value in flat])
    return [integer[k : k + len(entries)] for k in range(0, len(integer), len(entries))]


def _arrows(bracket: Bracket, rows: list[list[Any]], arrow: str = " -> ", identity: bool = True) -> str:
    """Which fields go where; fields that stay (or do not move) are left out."""
    names = bracket.field_names
    moved: list[str] = []
    for k, row in enumerate(rows):
        order = sorted((i for i, c in enumerate(row) if c != 0), key=lambda i: i != k)  # the field itself comes first
        terms = [_term(as_expression(row[i], "an entry"), names[i]) for i in order]
        if terms != ([names[k]] if identity else []):
            moved.append(f"{names[k]}{arrow}" + (" + ".join(terms).replace("+ -", "- ") or "0"))
    return ", ".join(moved) or "every field stays as it is"


def _term(coefficient: Any, name: str) -> str:
    if coefficient in (1, -1):
        return name if coefficient == 1 else f"-{name}"
    text = str(coefficient).replace("**", "^")
    return f"({text})*{name}" if coefficient.is_Add else f"{text}*{name}"


def _power(exponent: object) -> str:
    return "s" if exponent == 1 else f"s^{exponent}" if str(exponent).isdigit() else f"s^({exponent})"


def _integers(values: list[Fraction]) -> list[int]:
    """The smallest integer multiple, its first nonzero number positive."""
    first = next((value for value in values if value), Fraction(1))
    scale = Fraction(lcm(*(value.denominator for value in values)), 1)
    content = gcd(*(int(value * scale) for value in values)) or 1
    return [int(value * scale / content) * (1 if first > 0 else -1) for value in values]


def _scaling_text(bracket: Bracket, weights: list[int], parameters: Mapping[str, int]) -> str:
    fields = [f"{name} -> {_power(w)}*{name}" for name, w in zip(bracket.field_names, weights, strict=True) if w]
    changed = [f"{name} to {_power(k)}*{name}" for name, k in parameters.items() if k]
    return ", ".join(fields) + (" takes " + ", ".join(changed) if changed else " changes nothing else")
