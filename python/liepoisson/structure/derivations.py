r"""Infinitesimal symmetries and scalings of the fields of a bracket: derivations and gradings of the algebra A.

For the twisted top these are $\alpha \mapsto \alpha + d\beta$, and $\alpha \mapsto s\alpha$,
$\beta \mapsto u\beta$, which takes epsilon to $\epsilon s^2/u$.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import gcd, lcm
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Exact, ExactMatrix, as_expression, is_zero, symbols_of
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.formula.parameters import read_parameter
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.names import free_name

if TYPE_CHECKING:
    from sympy import Matrix

    from liepoisson.structure.extension import Extension

Constant: TypeAlias = "tuple[tuple[int, int], tuple[int, int], Exact]"
"""A term of the constant part: (field, component), (field, component), value; both orders are given."""


class Names(NamedTuple):
    """The names of the fields, and of the symbols that are taken."""

    fields: Sequence[str]
    symbols: Collection[str]


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

    matrix: ExactMatrix
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


def derivations(A: Extension, constants: Sequence[Constant], names: Names) -> list[Derivation]:
    """A basis of the derivations of A, gradings with the simplest weights first (exact null space)."""
    n, terms = A.dimension, products(A)
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
            names, [[field.to_sympy(v[i * n + j]) if i * n + j in v else 0 for j in range(n)] for i in range(n)]
        )
        for v in vectors
    ]
    return sorted(found, key=lambda d: ("grading", "nilpotent", "general").index(d.kind))


def scalings(A: Extension, constants: Sequence[Constant], fields: Sequence[str]) -> list[Scaling]:
    """A basis of the scalings of fields under which every product of A keeps its form.

    A product whose coefficient is a rational multiple of one parameter may be rescaled with this parameter; all the
    other products must stay as they are.
    """
    n, rationals = A.dimension, Coefficients()
    signed = [((first[0], 1), (second[0], 1), c) for first, second, c in constants]
    names = sorted({name for *_, c in constants for name in symbols_of(c)} | A.symbols)
    rows: list[dict[int, Any]] = []
    of_products = [((mu, 1), (nu, 1), (lam, -1), w) for mu, nu, lam, w in products(A)]
    for *signs, w in [*of_products, *signed]:
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
        found.append(Scaling(tuple(integer[:n]), powers, _scaling_text(fields, integer[:n], powers)))
    return found


def products(A: Extension) -> list[tuple[int, int, int, Exact]]:
    """All (mu, nu, lam, w) with w the nonzero coefficient of e_mu e_nu along e_lam, both orders."""
    W, n = A.tensor, range(A.dimension)
    return [(m, v, k, W[k][m][v]) for m, v, k in product(n, repeat=3) if not is_zero(W[k][m][v])]


def _single_parameter(w: Exact) -> str | None:
    """The name of the parameter of which w is a rational multiple."""
    if isinstance(w, Fraction):
        return None
    factor, rest = w.as_coeff_Mul()
    return str(rest) if rest.is_Symbol and factor.is_Rational else None


def _derivation(names: Names, entries: list[list[Any]]) -> Derivation:
    from sympy import Matrix, Symbol, eye, factorial

    n = len(entries)
    entries = _scaled(entries)
    D: Matrix = Matrix(entries)
    exact = tuple(tuple(read_parameter(value, "D") for value in row) for row in entries)
    if D.is_diagonal():
        weights = [entries[k][k] for k in range(n)]
        scaled = [f"{name} -> {_power(w)}*{name}" for name, w in zip(names.fields, weights, strict=True) if w]
        return Derivation(exact, "grading", ", ".join(scaled))
    if (D**n).is_zero_matrix:
        d = Symbol(free_name("d", {*names.symbols, *names.fields}))
        flow: Any = eye(n)
        for k in range(1, n):
            flow += (d * D) ** k / factorial(k)
        return Derivation(exact, "nilpotent", arrows(names.fields, flow.tolist()))
    return Derivation(exact, "general", arrows(names.fields, entries, " moves with ", identity=False))


def _scaled(entries: list[list[Any]]) -> list[list[Any]]:
    """A multiple with coprime integers, the first of them positive, if all entries are rational."""
    from sympy import Rational

    flat: list[Any] = [Rational(value) if value == 0 else value for row in entries for value in row]
    if not all(value.is_Rational for value in flat):
        return entries
    integer = _integers([Fraction(int(value.p), int(value.q)) for value in flat])
    return [integer[k : k + len(entries)] for k in range(0, len(integer), len(entries))]


def arrows(names: Sequence[str], rows: list[list[Any]], arrow: str = " -> ", identity: bool = True) -> str:
    """Which fields go where; fields that stay (or do not move) are left out."""
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


def _scaling_text(names: Sequence[str], weights: list[int], parameters: Mapping[str, int]) -> str:
    fields = [f"{name} -> {_power(w)}*{name}" for name, w in zip(names, weights, strict=True) if w]
    changed = [f"{name} to {_power(k)}*{name}" for name, k in parameters.items() if k]
    return ", ".join(fields) + (" takes " + ", ".join(changed) if changed else " changes nothing else")
