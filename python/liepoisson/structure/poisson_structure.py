r"""What follows from a Poisson tensor J, linear or not: brackets, vector fields, and what is proved about them.

$$\{f, g\} = \nabla f \cdot J \nabla g, \qquad \dot x = J \nabla H .$$
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

from liepoisson.facades import function_of
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.deadline import checkpoint
from liepoisson.structure.coordinates import Coordinates, read_function

if TYPE_CHECKING:
    from sympy import Expr, Matrix, Symbol

    from liepoisson.algebra.exact_numbers import Exact
    from liepoisson.algebra.rational_polynomials import RationalPolynomial
    from liepoisson.formula.parameters import Parameter
    from liepoisson.structure.certificates import CasimirCertificate, JacobiCertificate, RankCertificate
    from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor, PoissonMatrix
    from liepoisson.structure.poisson.semi_invariants import SemiInvariant
    from liepoisson.structure.poisson.tensor_entries import TensorEntries


@explains_its_methods
class PoissonStructure(Coordinates):
    """Coordinates with a Poisson tensor; a `Bracket` says how it is given."""

    given_casimirs: tuple[Expr, ...] = ()
    """The Casimirs that the caller gave, checked."""

    @property
    @abstractmethod
    def is_linear(self) -> bool:
        r"""Whether $\{x_i, x_j\}$ is of degree at most one."""

    @abstractmethod
    def entries(self) -> tuple[tuple[int, int, int, Exact], ...]:
        r"""The linear part as sparse data: all (i, j, m, c) with i < j, $\{x_i, x_j\} = \sum c\,x_m$."""

    @cached_property
    @abstractmethod
    def tensor(self) -> LinearPoissonTensor:
        """The Poisson tensor as sparse exact data, for computations that do not need SymPy."""

    @cached_property
    @abstractmethod
    def formulas(self) -> TensorEntries:
        """The entries as expressions in the coordinates."""

    @cached_property
    @abstractmethod
    def _matrix(self) -> PoissonMatrix: ...

    @cached_property
    @abstractmethod
    def _all_terms(self) -> tuple[tuple[int, int, int, Exact], ...]: ...

    @abstractmethod
    def _known_casimirs(self, degree: int | None) -> Any: ...

    def with_angles(self, angles: Sequence[str]) -> Self:
        r"""The same bracket, of which these coordinates are angles: points of a circle, modulo $2\pi$.

        Hamiltonians must then be periodic in them; sections of an angle are taken modulo a turn, and averages and
        verdicts are those of functions on the circle.

        Example:
            >>> lp.canonical(names=["theta"]).with_angles(["theta"]).angles
            ('theta',)

        Args:
            angles: Names of coordinates on which the brackets of coordinates do not depend, or only periodically.

        Raises:
            ShapeError: not a sequence of names.
            BracketError: a name is that of no coordinate, or is given twice.
            ParameterError: a bracket of two coordinates, or a given Casimir, is not periodic in an angle.
        """
        from liepoisson.structure.circles import check_casimirs_on_circles, check_on_circles, read_angles, turn

        made = copy(self)
        made.angles = read_angles(angles, self.coordinate_names_in_order)
        if made.angles and not (self.is_linear and not self.entries()):
            names, J = self.coordinate_names_in_order, self.poisson_tensor()
            pairs = ((i, j) for j in range(self.dimension) for i in range(j))
            periods: Any = {str(x): (x, turn()) for x in made.angle_variables}
            functions: Any = ((f"{{{names[i]}, {names[j]}}}", J[i, j]) for i, j in pairs)
            check_on_circles(functions, periods, "Leave {name} out of angles.")
        check_casimirs_on_circles(made, made.given_casimirs)
        return made

    def with_casimirs(
        self, casimirs: Sequence[str | Expr] | Mapping[str, str | Expr], *, symbols: Sequence[str] = ()
    ) -> Self:
        """The same bracket with these known Casimirs in place of its own.

        Example:
            >>> bracket = lp.algebras.bianchi("IV") @ lp.trivial()  # {l1, l2} = l2 - l3, {l1, l3} = l3
            >>> bracket.with_casimirs(["l3*exp(l2/l3)"]).n_unknown_casimirs
            0

        Args:
            casimirs: The functions.
            symbols: Names in them that stay symbolic, besides those of the bracket.

        Raises:
            BracketError: a function is no Casimir.
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: a function is neither a text nor an expression, or not periodic in an angle.
        """
        made = copy(self)
        made.given_casimirs = function_of("PoissonStructure.with_casimirs")(self, casimirs, symbols)
        return made

    def poisson_tensor(self) -> Matrix:
        r"""The matrix $J_{ij}(x) = \{x_i, x_j\}$, of degree at most one in x where J is linear, shape (N, N)."""
        return self._matrix.matrix.copy()

    def __call__(self, f: Expr, g: Expr) -> Expr:
        r"""The bracket $\{f, g\} = \nabla f \cdot J \nabla g$, expanded.

        Raises:
            ParameterError: f or g is no expression, or has a part that is like a coordinate and none, such as L1.
        """
        from sympy import S, expand

        checkpoint("a Poisson bracket")
        slopes = self.gradient(f)
        if not any(slopes):
            return S.Zero
        return expand(sum((df * v for df, v in zip(slopes, self.vector_field(g), strict=True)), S.Zero))

    def gradient(self, f: Expr) -> list[Expr]:
        """The derivatives of a function, without the traces that are Casimirs.

        Raises:
            ParameterError: f is no expression, or has a part that is like a coordinate and none.
        """
        from sympy import S

        expression, casimirs = self._modulo_casimirs(read_function(self, f, "a function on phase space"))
        occurring = expression.free_symbols
        slopes: list[Any] = [expression.diff(v) if v in occurring else S.Zero for v in self.variables]
        return [slope.xreplace(casimirs) for slope in slopes] if casimirs else slopes

    def _modulo_casimirs(self, expression: Expr) -> tuple[Expr, dict[Any, Expr]]:
        """The function without the traces that are Casimirs, whose gradients J annihilates."""
        return function_of("PoissonStructure.gradient")(expression, self)

    def vector_field(self, hamiltonian: Expr) -> tuple[Expr, ...]:
        r"""The right-hand side of $\dot x = \{x, h\} = J \nabla h$, one expression per coordinate, expanded.

        Where J is constant, as in canonical coordinates, only polynomials are expanded.

        Raises:
            ParameterError: h is no expression, or has a part that is like a coordinate and none, such as L1.
        """
        return self._matrix.times(self.gradient(hamiltonian))

    def jacobi_residuals(self) -> dict[tuple[Symbol, Symbol, Symbol], Expr]:
        r"""$\{\{x_i, x_j\}, x_k\}$ + cyclic for all i < j < k: zero throughout if this is a Poisson bracket.

        Writes out every residual; `jacobi_certificate` is much faster.
        """
        return self._matrix.jacobi_residuals()

    def jacobi_certificate(self) -> JacobiCertificate:
        """Antisymmetry and the Jacobi identity for all triples of coordinates, computed now from the entries."""
        from liepoisson.structure.certificates import jacobi_certificate

        return jacobi_certificate(self.tensor, self.coordinate_names_in_order)

    def rank(self, point: Sequence[Parameter] | None = None) -> int:
        """The rank of the Poisson tensor, the dimension of the symplectic leaf.

        Args:
            point: N exact numbers; parameters that the bracket keeps symbolic are generic.  None: the rank at a random
                point, which bounds the generic rank from below and almost surely equals it; `rank_certificate` says
                whether this is proved.

        Raises:
            ShapeError: not N numbers.
            ParameterError: a component is not exact, or a symbol.
        """
        if point is None:
            return self.tensor.rank_at_a_point
        from liepoisson.structure.certificates import rank_at

        return rank_at(self.dimension, self._all_terms, self._read_point(point))

    def corank(self, point: Sequence[Parameter] | None = None) -> int:
        """The number of coordinates minus the rank; arguments as for `rank`."""
        return self.dimension - self.rank(point)

    def rank_certificate(self) -> RankCertificate:
        """The generic rank between two proved bounds: J at one point, and the independent Casimirs found."""
        return function_of("PoissonStructure.rank_certificate")(self)

    def casimirs(self, degree: int | None = None) -> list[Expr]:
        r"""Generators of the polynomial Casimirs: those of each degree modulo products of the lower ones.

        They are called C1, C2, ... everywhere, in this order.  Symbolic parameters are taken as generic.  For
        `so(3) @ leibniz(3, epsilon)`: $|\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $\alpha\cdot\beta$, $|\beta|^2$.

        Each has the coefficient 1 at its leading monomial: that of the latest fields, and among these of the first
        coordinates.  Nothing else is multiplied or cleared, so that values inserted for symbols give the generators of
        the bracket with these values, except where `casimir_report` names a jump.

        They are expanded where linear algebra on all monomials finds them.  For so(n), su(n), sl(n), gl(n) and the sine
        algebra beyond its limits they are traces, $\operatorname{tr} X^k$: SymPy expressions that are differentiated,
        substituted and evaluated as they are, and written out by `.expand(trace=True)` only.  The matrix X, the order
        and the normalisation are those of `liepoisson.structure.trace_casimirs`.

        The list may be incomplete: `n_unknown_casimirs` says how many are missing.

        Args:
            degree: Find all up to this degree.  None: raise the degree until as many independent ones are found as the
                corank allows, or until the size limit stated in `casimir_report`, which also says what is proved.

        Raises:
            ParameterError: the degree is not a positive integer, or too large for the search.
        """
        return list(self._known_casimirs(degree).expressions)

    def rational_casimirs(self, degree: int) -> list[Expr]:
        r"""Independent Casimirs P/Q with polynomials P and Q of at most a degree, those with Q = 1 first.

        P and Q are semi-invariants of one weight, see `semi_invariants`; all are functions of those that are found, as
        far as weights lie in the field of the structure constants.

        Example:
            >>> (lp.algebras.bianchi("V") @ lp.trivial()).rational_casimirs(1)
            [l3/l2]

        Args:
            degree: The highest degree of P and Q.

        Raises:
            ParameterError: the degree is not a positive integer, or too large for the search, or there is no exact
                field of real numbers that contains the structure constants.
        """
        from liepoisson.structure.poisson.semi_invariants import rational_casimirs

        return rational_casimirs(self.formulas, degree)

    def semi_invariants(self, degree: int) -> list[SemiInvariant]:
        r"""The polynomials F with $\{x_i, F\} = \lambda_i F$ up to a degree that are no sums of products of others.

        The $\lambda_i$ are numbers.  Casimirs are those with $\lambda = 0$.

        Args:
            degree: The highest degree of F.

        Raises:
            ParameterError: the degree is not a positive integer, or too large for the search, or there is no exact
                field of real numbers that contains the structure constants.
        """
        from liepoisson.structure.poisson.semi_invariants import semi_invariants

        return semi_invariants(self.formulas, degree)

    def polynomial_casimirs(self) -> tuple[RationalPolynomial, ...] | None:
        """The same for all degrees without SymPy; None if a coefficient is no rational number, and for traces."""
        return self._known_casimirs(None).polynomials

    @property
    def n_unknown_casimirs(self) -> int:
        """How many independent Casimirs are missing in `casimirs()`: 0 if every one is a function of them."""
        return self.corank() - self._known_casimirs(None).independent

    def is_casimir(self, function: str | Expr, *, symbols: Sequence[str] = ()) -> bool:
        r"""Whether $\{x_i, C\} = 0$ for all coordinates; `casimir_certificate` says how it is known.

        Args:
            function: A text in the grammar, or an expression.
            symbols: Names in it that stay symbolic, besides those of the bracket.

        Raises:
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: it is neither, has a part that is like a coordinate and none, or has to be tried at points
                and is defined at none.
        """
        return self.casimir_certificate(function, symbols=symbols).holds

    def casimir_certificate(self, function: str | Expr, *, symbols: Sequence[str] = ()) -> CasimirCertificate:
        """Whether a function is a Casimir, decided exactly where algebra can, else tried at random points.

        Args:
            function: A text in the grammar, or an expression.
            symbols: Names in it that stay symbolic, besides those of the bracket.

        Raises:
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: it is neither, has a part that is like a coordinate and none, or has to be tried at points
                and is defined at none.
        """
        return function_of("PoissonStructure.casimir_certificate")(self, function, symbols)
