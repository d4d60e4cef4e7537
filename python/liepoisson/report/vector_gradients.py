r"""Gradients in vector notation by the chain rule.

Where $H = F(s_1, s_2, \ldots)$ depends on a field x only through recognised scalars $|x|^2$, $a\cdot x$,
$x\cdot I^{-1}x$, ..., $\partial H/\partial x = \sum_k (\partial F/\partial s_k)\,\partial s_k/\partial x$ is a sum of
vectors: of $\sqrt{1 + x\cdot I^{-1}x}$ it is $I^{-1}x / \sqrt{1 + x\cdot I^{-1}x}$.  The derivative of
each scalar is compared with that of its components, and that H is this function of them is known from its formula.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from liepoisson.report.printing import Atom, Cross, Dot, Form, Formula, Image, Itself, Shifted, Square, Triple
from liepoisson.report.vector_notation import VectorNotation

if TYPE_CHECKING:
    from sympy import Expr


def vector_gradient(notation: VectorNotation, hamiltonian: Expr, field: str) -> Formula | None:
    r"""The vector $\partial H/\partial x$ of one field, or None where H is not recognised as a function of scalars.

    Args:
        notation: Of the phase space.
        hamiltonian: In components.
        field: The name of x.
    """
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
