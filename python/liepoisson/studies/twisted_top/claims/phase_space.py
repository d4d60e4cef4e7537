"""Tops with symbolic parameters on the phase space of a given bracket, and ranks of matrices at exact points."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from liepoisson.formula.parameters import Column, Parameter
from liepoisson.studies.twisted_top.claims.model import Context

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket

# A point at which nothing special happens: small integers without relations between the three vectors.
GENERIC_POINT = (1, 2, -1, 3, 1, 2, 2, -1, 1)


@dataclass(frozen=True)
class SymbolicTop:
    """The Hamiltonian of the paper on the phase space of a bracket; all parameters are SymPy objects."""

    bracket: Bracket
    inertia: Column
    a: Column
    b: Column
    epsilon: Any

    @property
    def vectors(self) -> tuple[Column, Column, Column]:
        """The columns l, alpha, beta."""
        l, alpha, beta = self.bracket.fields.values()
        return l, alpha, beta

    @property
    def omega(self) -> Column:
        """Angular velocity, the inverse inertia times l."""
        return column(*(l / moment for l, moment in zip(self.vectors[0], self.inertia, strict=True)))

    @property
    def hamiltonian(self) -> Any:
        """Kinetic energy plus the potentials of the two fields."""
        l, alpha, beta = self.vectors
        return l.dot(self.omega) / 2 + self.a.dot(alpha) + self.b.dot(beta)

    @property
    def casimirs(self) -> tuple[Expr, Expr, Expr]:
        """C1, C2, C3 as the paper prints them."""
        l, alpha, beta = self.vectors
        return alpha.dot(alpha) + 2 * self.epsilon * l.dot(beta), alpha.dot(beta), beta.dot(beta)

    def rate(self, f: Any) -> Any:
        """The time derivative {f, H}; of a matrix entry by entry."""
        from sympy.matrices import MatrixBase

        if isinstance(f, MatrixBase):
            return f.applyfunc(self.rate)
        return self.bracket(f, self.hamiltonian)


def symbolic_top(
    context: Context,
    *,
    inertia: Sequence[Any] = ("I1", "I2", "I3"),
    a: Sequence[Any] = ("a1", "a2", "a3"),
    b: Sequence[Any] = ("b1", "b2", "b3"),
    epsilon: Parameter = "epsilon",
) -> SymbolicTop:
    """A top with the bracket of the context; parameters are names (kept symbolic) or exact numbers."""
    from liepoisson.algebra.exact_numbers import to_sympy
    from liepoisson.formula.parameters import read_parameter

    moments, mass, charge = (
        column(*(to_sympy(read_parameter(v, "parameter")) for v in vector)) for vector in (inertia, a, b)
    )
    return SymbolicTop(context.bracket(epsilon), moments, mass, charge, to_sympy(read_parameter(epsilon, "epsilon")))


def lagrange_top(context: Context, *, charged: bool = False, epsilon: Parameter = "epsilon") -> SymbolicTop:
    """I1 = I2 and a on the axis; b = 0, or on the axis too."""
    b3 = "b3" if charged else 0
    return symbolic_top(context, inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), b=(0, 0, b3), epsilon=epsilon)


def column(*entries: Any) -> Column:
    """A SymPy column of the entries."""
    from sympy import Matrix

    return Matrix(entries)


def substitution(coordinates: Iterable[Any], values: Iterable[Any]) -> dict[Any, Any]:
    """A dictionary for `subs`, coordinate by coordinate."""
    return dict(zip(coordinates, values, strict=True))


def poisson_map_residual(bracket: Bracket, images: Column, target: Bracket) -> Any:
    """D J D^T - J' o Phi for a map into the phase space of `target`, given by its images: zero if it is Poisson."""
    x: Any = column(*bracket.variables)
    D = images.jacobian(x)
    image: Any = target.poisson_tensor()
    there = image.subs(substitution(target.variables, images), simultaneous=True)
    return D * bracket.poisson_tensor() * D.T - there


def rank_at(bracket: Bracket, point: Sequence[Any]) -> int:
    """Rank of the Poisson tensor at an exact point, the dimension of the symplectic leaf through it."""
    tensor: Any = bracket.poisson_tensor()
    return int(tensor.subs(substitution(bracket.variables, point)).rank())


def at_generic_parameters(functions: Iterable[Any], variables: Iterable[Any]) -> list[Any]:
    """The functions with a different prime for each parameter, the same in all of them."""
    from sympy import prime

    functions = list(functions)
    free = sorted({s for f in functions for s in f.free_symbols} - set(variables), key=str)
    values = {symbol: prime(k + 2) for k, symbol in enumerate(free)}
    return [f.subs(values) for f in functions]
