r"""Equations of motion in vector notation, derived from the bracket.

For a three-dimensional Lie algebra with an invariant diagonal metric, and $v_\nu = \partial H/\partial x_\nu$,

$$\dot x_\mu = \sum_{\lambda\nu} W_\lambda{}^{\mu\nu}\, x_\lambda \times v_\nu ,\qquad
  (x \times v)_i = -c_{ij}^k\, v_j\, x_k ,$$

which is the usual cross product for so(3).  The sum is expanded and compared with $J\nabla H$ before it is printed.

Where $H = F(s_1, s_2, \ldots)$ depends on a field x only through recognised scalars $|x|^2$, $a\cdot x$,
$x\cdot I^{-1}x$, ..., $\partial H/\partial x = \sum_k (\partial F/\partial s_k)\,\partial s_k/\partial x$ is a sum of
vectors: of $\sqrt{1 + x\cdot I^{-1}x}$ it is $I^{-1}x / \sqrt{1 + x\cdot I^{-1}x}$.  The derivative of
each scalar is compared with that of its components, and that H is this function of them is known from its formula.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.report.printing import (
    Atom,
    Cross,
    Dot,
    Form,
    Formula,
    Gradient,
    Image,
    Itself,
    Shifted,
    Square,
    Triple,
    Vector,
)
from liepoisson.report.vector_notation import VectorNotation

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket


def vector_gradient(notation: VectorNotation, hamiltonian: Expr, field: str) -> Formula | None:
    r"""The vector $\partial H/\partial x$ of a field x, or None where H is not recognised as a function of scalars."""
    from sympy import Dummy, S

    scalar = notation.formula(hamiltonian)
    expression: Any = scalar.expression
    if not scalar.atoms or expression.has(*notation.fields[field]):
        return None
    total, vectors = S.Zero, dict[Atom, Any]()
    for symbol, atom in scalar.atoms.items():
        for factor, vector in _derivative(atom, field):
            named = vectors.setdefault(vector, Dummy("vector"))
            total += factor * expression.diff(symbol) * named
    atoms = {**scalar.atoms, **{symbol: vector for vector, symbol in vectors.items()}}
    used = {symbol: atom for symbol, atom in atoms.items() if total.has(symbol)}
    formula = Formula(total, used, notation.coordinates)
    proved = all(_is_derivative(atom, field, notation, hamiltonian) for atom in scalar.atoms.values())
    return formula if vectors and proved else None


def _derivative(atom: Atom, field: str) -> Iterator[tuple[int, Atom]]:
    """The derivative of a scalar along a field, as multiples of vectors; of a shifted field it is that of the field."""
    match atom:
        case Square(Shifted(x, _, _) as moved) if x == field:
            yield 2, Itself(moved)
        case Square(u) if u == field:
            yield 2, Itself(u)
        case Dot(u, v):
            yield from ((1, Itself(b)) for a, b in ((u, v), (v, u)) if a == field)
        case Form(u, matrix, power, v):
            yield from ((1, Image(matrix, power, b)) for a, b in ((u, v), (v, u)) if a == field)
        case Triple(u, v, w):
            turns = ((u, v, w), (v, w, u), (w, u, v))
            yield from ((1, Cross(b, c)) for a, b, c in turns if a == field)
        case _:
            pass


def _is_derivative(atom: Atom, field: str, notation: VectorNotation, hamiltonian: Expr) -> bool:
    """Whether the vectors of `_derivative` add up to the derivative in components; polynomials decide this."""
    names = notation.vectors(hamiltonian)
    scalar = notation.meaning(atom, hamiltonian)
    columns = [(factor, _column(v, names, notation, hamiltonian)) for factor, v in _derivative(atom, field)]
    return all(
        (sum(factor * column[i] for factor, column in columns) - scalar.diff(x)).expand() == 0
        for i, x in enumerate(notation.fields[field])
    )


def _column(atom: Atom, names: dict[str, list[Any]], notation: VectorNotation, hamiltonian: Expr) -> list[Any]:
    """A vector in components."""
    match atom:
        case Itself(Shifted(x, sign, r)):
            return [c + sign * s for c, s in zip(names[x], names[r], strict=True)]
        case Itself(str(u)):
            return names[u]
        case Image(matrix, power, str(u)) if matrix in names:
            return [entry**power * c for entry, c in zip(names[matrix], names[u], strict=True)]
        case Image(matrix, _, str(u)):
            rows = notation.parameter_matrices(hamiltonian)[matrix]
            return [sum(entry * c for entry, c in zip(row, names[u], strict=True)) for row in rows]
        case Cross(str(u), str(v)):
            (a, b, c), (d, e, f) = names[u], names[v]
            return [b * f - c * e, c * d - a * f, a * e - b * d]
        case _:
            raise AssertionError(f"{atom} is not a vector of fields and parameters")


Definition = Formula | tuple[Formula, ...]
"""What a name stands for: a vector expression, or its components."""


@dataclass(frozen=True)
class VectorEquations:
    """The equations of motion, one per field."""

    rows: tuple[tuple[str, Formula], ...]  # field and right-hand side
    definitions: tuple[tuple[Vector, Definition], ...]  # vectors that occur in the right-hand sides and what they are
    # components of u x v where it is not the usual cross product, in symbols u1, ..., v3
    product: tuple[Formula, ...] | None


def vector_equations(bracket: Bracket, hamiltonian: Expr) -> VectorEquations | None:
    """The equations of motion in vector notation, or None where the algebra has no cross product."""
    if not bracket.has_algebra or bracket.algebra.dimension != 3:
        return None
    notation = VectorNotation(bracket)
    if notation.metric is None:
        return None
    return _Equations(bracket, hamiltonian, notation).result()


class _Equations:
    """Collects the gradients of H and the products that they enter."""

    def __init__(self, bracket: Bracket, hamiltonian: Expr, notation: VectorNotation) -> None:
        self.bracket = bracket
        self.hamiltonian = hamiltonian
        self.notation = notation
        self.parameters = notation.parameter_vectors(hamiltonian)
        self.vectors: dict[Vector, Sequence[Any]] = {**notation.fields, **self.parameters}
        self.definitions: dict[Vector, Definition] = {}
        taken = {*notation.fields, *(str(symbol) for symbol in hamiltonian.free_symbols), *self.parameters}
        self.omega: Vector | None = None if "omega" in taken else "omega"

    def result(self) -> VectorEquations | None:
        names = self.notation.field_names
        gradients = [self._gradient(name) for name in names]
        rows = [self._row(mu, gradients) for mu in range(len(names))]
        if not self._equal_to_the_field(rows):
            return None
        formulas = tuple((name, self._formula(row)) for name, row in zip(names, rows, strict=True))
        used = {atom.v for _, formula in formulas for atom in formula.atoms.values() if isinstance(atom, Cross)}
        kept = tuple((name, value) for name, value in self.definitions.items() if name in used)
        return VectorEquations(formulas, kept, None if self.notation.is_euclidean else self._product())

    def cross(self, u: Sequence[Any], v: Sequence[Any]) -> list[Any]:
        """The product u x v, from the structure constants and divided by the factor that `_row` takes out."""
        from sympy import S

        total = [S.Zero] * 3
        for i, j, k, c in self._constants:
            total[i] -= c * v[j] * u[k]
        return [component / self._factor for component in total]

    @property
    def _constants(self) -> list[tuple[int, int, int, Any]]:
        constants = self.bracket.algebra.structure_constants
        return [(i, j, k, to_sympy(constants[i][j][k])) for i, j, k in product(range(3), repeat=3)]

    @property
    def _factor(self) -> Any:
        """The s in [e1, e2] = s e3, so that u x v is the usual cross product for so(3) whatever s is."""
        metric = self.notation.metric or (1, 1, 1)
        return to_sympy(self.bracket.algebra.structure_constants[0][1][2]) * metric[2]

    def _gradient(self, field: str) -> list[tuple[Any, Vector]]:
        """The derivative of H along a field as a combination of named vectors."""
        from sympy import S

        given = [self.hamiltonian.diff(x) for x in self.notation.fields[field]]
        column = [component.expand() for component in given]
        if all(component == 0 for component in column):
            return []
        found, rest = self._take_out_vectors(column)
        if all(component == 0 for component in rest):
            return found
        own = self.notation.fields[self.notation.field_names[0]]
        slopes = [component / x for component, x in zip(rest, own, strict=True)]
        if field == self.notation.field_names[0] and self.omega and not any(map(self._has_variables, slopes)):
            self._define(self.omega, rest)
            return [(S.One, self.omega), *found]
        name = Gradient(field)
        self._define(name, given, field)
        return [(S.One, name)]

    def _take_out_vectors(self, column: list[Any]) -> tuple[list[tuple[Any, Vector]], list[Any]]:
        """Multiples of fields and of parameter vectors in a column, and what is left of it."""
        found: list[tuple[Any, Vector]] = []
        # The gradient of a function lies in the algebra, a field in its dual: the same only for a Euclidean metric.
        fields = self.notation.fields if self.notation.is_euclidean else {}
        for name, vector in [*fields.items(), *self.parameters.items()]:
            factor = column[0].coeff(vector[0])
            rest = [(c - factor * component).expand() for c, component in zip(column, vector, strict=True)]
            if factor != 0 and not self._has_variables(factor) and not any(c.has(*vector) for c in [factor, *rest]):
                found.append((factor, name))
                column = rest
        return found, column

    def _has_variables(self, expression: Expr) -> bool:
        return expression.has(*self.notation.variables)

    def _define(self, name: Vector, column: Sequence[Any], gradient_along: str | None = None) -> None:
        self.vectors[name] = column
        written = self._image(column)
        if written is None and gradient_along is not None:
            written = vector_gradient(self.notation, self.hamiltonian, gradient_along)
        self.definitions[name] = written or tuple(self.notation.components(c) for c in column)

    def _image(self, column: Sequence[Any]) -> Formula | None:
        """The column as a sum of vectors, each perhaps multiplied by D or D^-1 with a diagonal matrix of parameters."""
        from sympy import Dummy, S

        total, atoms = S.Zero, dict[Any, Atom]()
        rest = [component.expand() for component in column]
        for name, vector in [*self.notation.fields.items(), *self.parameters.items()]:
            slopes = [component.coeff(x) for component, x in zip(rest, vector, strict=True)]
            factor, atom = self._multiple(slopes, name)
            if atom is not None:
                rest = [(c - d * x).expand() for c, d, x in zip(rest, slopes, vector, strict=True)]
                symbol = Dummy("image")
                atoms[symbol] = atom
                total += factor * symbol
        return Formula(total, atoms, self.notation.coordinates) if atoms and not any(rest) else None

    def _multiple(self, slopes: Sequence[Any], name: str) -> tuple[Any, Atom | None]:
        """A diagonal matrix applied to a vector: as a number times D^{+-1} times the vector."""
        if 0 in slopes or any(map(self._has_variables, slopes)):
            return 0, None
        if len(set(slopes)) == 1:
            return slopes[0], Itself(name)
        for (matrix, entries), power in product(self.parameters.items(), (1, -1)):
            factors = {(d / entry**power).cancel() for d, entry in zip(slopes, entries, strict=True)}
            if len(factors) == 1 and not (factor := factors.pop()).has(*entries):
                return factor, Image(matrix, power, name)
        return 0, None

    def _row(self, mu: int, gradients: Sequence[list[tuple[Any, Vector]]]) -> dict[Cross, Any]:
        """The products in the time derivative of one field, with their coefficients."""
        row: dict[Cross, Any] = {}
        W, names = self.bracket.extension.tensor, self.notation.field_names
        for lam, nu in product(range(len(names)), repeat=2):
            weight = to_sympy(W[lam][mu][nu]) * self._factor
            for factor, vector in gradients[nu] if weight != 0 else ():
                self._add(row, names[lam], vector, (weight * factor).expand())
        return {cross: value for cross, value in row.items() if value != 0}

    def _add(self, row: dict[Cross, Any], u: str, v: Vector, value: Any) -> None:
        if u == v:
            return
        if isinstance(v, str) and Cross(v, u) in row:
            row[Cross(v, u)] -= value
        else:
            row[Cross(u, v)] = row.get(Cross(u, v), 0) + value

    def _equal_to_the_field(self, rows: Sequence[dict[Cross, Any]]) -> bool:
        derived = self.bracket.vector_field(self.hamiltonian)
        for mu, row in enumerate(rows):
            total = [sum(column) for column in zip(*(self._components(c, k) for c, k in row.items()), strict=True)]
            for component, wanted in zip(total or [0, 0, 0], derived[3 * mu : 3 * mu + 3], strict=True):
                if not is_zero(wanted - component):
                    return False
        return True

    def _components(self, cross: Cross, factor: Any) -> list[Any]:
        return [factor * c for c in self.cross(self.vectors[cross.u], self.vectors[cross.v])]

    def _formula(self, row: dict[Cross, Any]) -> Formula:
        from sympy import Dummy, S

        symbols = {cross: Dummy("cross") for cross in row}
        expression = sum((row[cross] * symbol for cross, symbol in symbols.items()), S.Zero)
        return Formula(expression, {symbol: cross for cross, symbol in symbols.items()}, self.notation.coordinates)

    def _product(self) -> tuple[Formula, ...]:
        from sympy import symbols

        return tuple(Formula(c) for c in self.cross(symbols("u1:4"), symbols("v1:4")))
