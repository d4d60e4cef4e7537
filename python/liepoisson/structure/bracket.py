r"""Lie-Poisson brackets of g (x) A, $\{f, g\} = -\langle x, [df, dg] \rangle + c(df, dg)$.

The constant part c is zero for the Lie-Poisson bracket proper; any 2-cocycle of the Lie algebra gives another one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, Self, cast

from liepoisson.algebra.exact_numbers import exact, substituted, symbols_of, to_sympy
from liepoisson.errors import BracketError
from liepoisson.facades import function_of
from liepoisson.formula.parameters import Parameter, values_of_symbols
from liepoisson.formula.tensors import read_names
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.names import check_name, check_not_reserved, check_title
from liepoisson.inputs.refusals import not_a
from liepoisson.structure.constant_part import read_constant, with_linear_part_at
from liepoisson.structure.coordinates import Coordinates, read_function
from liepoisson.structure.extension import Extension
from liepoisson.structure.lie_algebra import LieAlgebra

if TYPE_CHECKING:
    from sympy import Expr, Matrix, Symbol

    from liepoisson.algebra.exact_numbers import Coefficient, Exact
    from liepoisson.algebra.rational_polynomials import RationalPolynomial
    from liepoisson.structure.casimirs import CasimirReport, KnownCasimirs
    from liepoisson.structure.certificates import CasimirCertificate, JacobiCertificate, RankCertificate
    from liepoisson.structure.derivations import Constant, Derivation, Scaling
    from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor, PoissonMatrix
    from liepoisson.structure.poisson.semi_invariants import SemiInvariant
    from liepoisson.structure.poisson.tensor_entries import TensorEntries
    from liepoisson.structure.strata import Stratum
    from liepoisson.structure.trace_casimirs import TraceCasimirs


@explains_its_methods
class Bracket(Coordinates):
    r"""The (minus) Lie-Poisson bracket on the dual of g (x) A.

    With $x_\lambda$ the field of the basis element $e_\lambda$ of A,

    $$\{f, g\} = -\sum_{\lambda\mu\nu} W_\lambda{}^{\mu\nu}\, \langle x_\lambda,
      [\partial_{x_\mu} f, \partial_{x_\nu} g] \rangle .$$

    Written `algebra @ extension`.  `so(3) @ leibniz(3, epsilon)` is the bracket of the twisted top,
    `so(3) @ semidirect(3)` that of the charged heavy top.

    A constant part $c_{ij}$ is added to $\{x_i, x_j\}$, `(so(3) @ trivial()).with_constant({("l1", "l2"): "k"})`.  It
    must be a 2-cocycle, $c([x, y], z) + c([y, z], x) + c([z, x], y) = 0$, which is decided exactly.  Canonical brackets
    (`liepoisson.structure.canonical_bracket`) consist of it alone.

    Example:
        >>> bracket = lp.so(3) @ lp.leibniz(3, "epsilon")
        >>> bracket.casimirs()[0]
        alpha1**2 + alpha2**2 + alpha3**2 + 2*beta1*epsilon*l1 + 2*beta2*epsilon*l2 + 2*beta3*epsilon*l3

    Args:
        algebra: The Lie algebra g.
        extension: The commutative algebra A.
        field_names: One name per field, in place of those of the extension.
        constant: The constant part by pairs of coordinates, by name or number, each pair in one order only.
        casimirs: Known Casimirs, a list or a mapping from names, which are not kept: they are C1, C2, ... in this
            order, before those that a search finds.
        name: How it is printed; by default by the names of g and A.
        check: Verify that the constant part is a 2-cocycle.  Switch this off only to study what goes wrong.

    Attributes:
        algebra: The Lie algebra g.
        extension: The commutative algebra A.
        constant_rows: The constant part as it is kept, before SymPy is asked for it.

    Raises:
        CocycleError: the constant part is no 2-cocycle; the error names the three coordinates.
        BracketError: a coordinate and a parameter, or a coordinate and a field, have the same name, or a function is no
            Casimir.
        ParameterError: a name is none that a user may choose (`liepoisson.inputs.names`), `algebra` is not a LieAlgebra
            or `extension` not an Extension.
        ShapeError: not one name per field.

    References: Thiffeault and Morrison (2001), equations for the two brackets; Thiffeault and Morrison (2000).
    """

    has_algebra: ClassVar[bool] = True
    """Whether the bracket is given by `algebra` and `extension`; a `PoissonTensor` is given by formulas."""

    given_casimirs: tuple[Expr, ...] = ()
    """The Casimirs that the caller gave, checked."""

    def __init__(
        self,
        algebra: LieAlgebra,
        extension: Extension,
        field_names: Sequence[str] | None = None,
        *,
        constant: Mapping[tuple[str | int, str | int], Parameter] | None = None,
        casimirs: Sequence[str | Expr] | Mapping[str, str | Expr] = (),
        name: str | None = None,
        check: bool = True,
    ) -> None:
        _check_type(algebra, LieAlgebra, "algebra", "so(3)")
        _check_type(extension, Extension, "extension", 'leibniz(3, "epsilon")')
        self.algebra = algebra
        self.extension = extension if field_names is None else _renamed(extension, field_names)
        names = self.coordinate_names
        if len(names) < self.dimension:
            raise BracketError(f"coordinates must have distinct names; got {sorted(names)}. Rename the fields.")
        _check_field_names(self.field_names, names.difference(self.field_names if self.has_scalar_fields else ()))
        self.constant_rows: dict[tuple[int, int], Coefficient] = read_constant(constant, self.coordinate_names_in_order)
        self._name = name if name is None else check_title(name, "the name of a bracket", None)
        self.check_parameter_names(self.symbols)
        if self.constant_rows and check:
            from liepoisson.structure.certificates import check_cocycle, is_cocycle

            if self.is_rational or not is_cocycle(self.dimension, self.kept_entries()):
                check_cocycle(self.tensor, self.coordinate_names_in_order)
        if not isinstance(casimirs, tuple) or casimirs:
            self.given_casimirs = function_of("Bracket.with_casimirs")(self, casimirs)

    def with_constant(
        self, constant: Mapping[tuple[str | int, str | int], Parameter], *, check: bool = True
    ) -> Bracket:
        r"""The bracket with this constant part in place of its own, $\{f, g\} + c(df, dg)$.

        `(so(3) @ trivial()).with_constant({("l1", "l2"): "k"})` has $\{\ell_1, \ell_2\} = -\ell_3 + k$.

        Args:
            constant: $c_{ij}$, exact, by pairs of coordinates, by name or number; each pair in one order only.
            check: Verify that it is a 2-cocycle.  Switch this off only to study what goes wrong.

        Raises:
            CocycleError: it is no 2-cocycle, so that the Jacobi identity fails; the error names the three coordinates.
            BracketError: a coordinate is unknown, a pair is given twice or with itself, or a parameter is named like a
                coordinate.
            ParameterError: an entry is not exact.
        """
        made = Bracket(self.algebra, self.extension, self.field_names, constant=constant, check=check)
        made.angles = self.angles
        return made

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

    def translated(self, point: Sequence[Parameter]) -> Bracket:
        r"""The same bracket in the coordinates $y = x - x_0$: its constant part grows by $J(x_0)$, a coboundary.

        Args:
            point: $x_0$, N exact numbers or names.

        Raises:
            ShapeError: not N numbers.
            ParameterError: a component is not exact.
        """
        return self.with_constant(with_linear_part_at(self.constant, self.entries(), self._read_components(point)))

    def frozen(self, point: Sequence[Parameter]) -> Bracket:
        r"""The constant bracket $\{x_i, x_j\} = J_{ij}(x_0)$, which is compatible with this one: frozen at $x_0$.

        Args:
            point: $x_0$, N exact numbers or names.

        Raises:
            ShapeError: not N numbers.
            ParameterError: a component is not exact.

        References: [marsden1999], section 10.1.
        """
        constant = with_linear_part_at(self.constant, self.entries(), self._read_components(point))
        algebra = LieAlgebra.from_brackets(
            self.algebra.dimension, {}, f"abelian({self.algebra.dimension})", self.algebra.basis_names, check=False
        )
        made = Bracket(algebra, self.extension, constant=constant, name=f"{self!r}, frozen")
        made.angles = self.angles
        return made

    def coboundary(self) -> tuple[Expr, ...] | None:
        r"""A point $\xi$ with $c_{ij} = \sum_m c_{ij}{}^m \xi_m$, shape (N,), or None if there is none.

        The constant part is then removed by the translation $x \mapsto x + \xi$; on a semisimple algebra there always
        is one (Whitehead's lemma).  Zero if there is no constant part.
        """
        from liepoisson.structure.poisson.poisson_tensor import potential_of_constant_part

        found = potential_of_constant_part(self.tensor)
        return None if found is None else tuple(to_sympy(value) for value in found)

    def rename(self, *field_names: str) -> Bracket:
        """The same bracket with other names for its fields, one by one.

        Example:
            >>> (lp.so(3) @ lp.leibniz(2)).rename("m", "p").field_names
            ('m', 'p')

        Raises:
            ShapeError: not one name per field.
            BracketError: two coordinates, or a coordinate and a parameter or a field, would have the same name.
            ParameterError: a name is not an identifier.
        """
        constant: Any = self.constant_rows
        made = Bracket(self.algebra, self.extension, field_names, constant=constant, check=False)
        new = dict(zip(self.coordinate_names_in_order, made.coordinate_names_in_order, strict=True))
        made.angles = tuple(new[name] for name in self.angles)
        if self.given_casimirs:
            renamed: Any = dict(zip(self.variables, made.variables, strict=True))
            made.given_casimirs = tuple(cast("Expr", one.xreplace(renamed)) for one in self.given_casimirs)
        return made

    def plus(self) -> Bracket:
        r"""The plus bracket, $\{f, g\} = +\langle x, [df, dg] \rangle + c(df, dg)$; the constant part stays.

        It is the minus bracket of the opposite algebra, $[x, y]' = -[x, y]$, and has the same Casimirs where there is
        no constant part.  $x \mapsto -x$ takes one to the other.

        Example:
            >>> minus = lp.so(3) @ lp.trivial()
            >>> l1, l2, l3 = minus.variables
            >>> minus(l1, l2), minus.plus()(l1, l2)
            (-l3, l3)

        References: [marsden1999], section 10.1.
        """
        opposite, constant = self.algebra.opposite(), cast("Any", self.constant_rows)
        made = Bracket(opposite, self.extension, constant=constant, check=False)
        made._name = f"{self!r}, plus"
        made.given_casimirs = self.given_casimirs if not self.constant_rows else ()
        made.angles = self.angles
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
        made.given_casimirs = function_of("Bracket.with_casimirs")(self, casimirs, symbols)
        return made

    @cached_property
    def constant(self) -> dict[tuple[int, int], Exact]:
        """The entries of the constant part that are not zero, by (i, j) with i < j, counted from 0."""
        return {pair: exact(value) for pair, value in self.constant_rows.items()}

    @property
    def dimension(self) -> int:
        """Number N of coordinates, dim g times dim A."""
        return self.algebra.dimension * self.extension.dimension

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields, one per basis element of A."""
        return self.extension.field_names

    @property
    def field_lengths(self) -> tuple[int, ...]:
        """Number of components of each field: dim g for all of them."""
        return (self.algebra.dimension,) * self.extension.dimension

    @cached_property
    def coordinate_names_in_order(self) -> tuple[str, ...]:
        """Names of the coordinates, field by field; asking for them does not import SymPy."""
        return tuple(field + base for field, base in product(self.field_names, self.algebra.basis_names))

    @property
    def symbols(self) -> set[str]:
        """Names of the parameters kept symbolic."""
        own = {name for value in self.constant_rows.values() for name in symbols_of(value)}
        return self.algebra.symbols | self.extension.symbols | own

    @property
    def has_scalar_fields(self) -> bool:
        """Whether each field is one coordinate with its own name, as theta and p_theta of a canonical bracket."""
        return self.algebra.basis_names == ("",)

    @property
    def vectors(self) -> Mapping[str, Sequence[str]]:
        """The fields that are vectors, with the names of their components: {"l": ("1", "2", "3")} for l1, l2, l3."""
        return {} if self.has_scalar_fields else dict.fromkeys(self.field_names, self.algebra.basis_names)

    def entries(self) -> tuple[tuple[int, int, int, Exact], ...]:
        r"""The linear part as sparse data: all (i, j, m, c) with i < j, $\{x_i, x_j\} = \sum c\,x_m$ and c nonzero.

        The constant part is `constant`.  The coefficients are Fractions if all structure constants are; SymPy is not
        imported then.
        """
        return tuple(term for term in self._terms if term[0] < term[1])

    def kept_entries(self) -> tuple[tuple[int, int, int | None, Coefficient], ...]:
        """The linear and the constant part as they are kept, before SymPy is asked for them; m is None for the latter.

        All (i, j, m, c) with i < j, as in `entries`.
        """
        linear = (term for term in self._kept_terms if term[0] < term[1])
        return (*linear, *((i, j, None, c) for (i, j), c in self.constant_rows.items()))

    @property
    def is_rational(self) -> bool:
        """Whether the bracket is linear, and all structure constants and the constant part are rational numbers."""
        return self.is_linear and all(isinstance(c, Fraction) for *_, c in self.kept_entries())

    @property
    def is_linear(self) -> bool:
        r"""Whether $\{x_i, x_j\}$ is of degree at most one, so that `entries` and `constant` are all of it."""
        return True

    def terms(self) -> tuple[tuple[int, int, int | None, Exact], ...]:
        r"""All terms (i, j, m, c) of $\{x_i, x_j\}$, i < j: $c\,x_m$, and c where m is None.

        These are `entries` and `constant`; where the bracket is not linear c is the function $J_{ij}(x)$ itself.
        """
        return (*self.entries(), *((i, j, None, c) for (i, j), c in self.constant.items()))

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
        from liepoisson.structure.casimirs import rank_certificate

        return rank_certificate(self)

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

    def _known_casimirs(self, degree: int | None) -> KnownCasimirs:
        if degree not in self._casimirs:
            from liepoisson.structure.casimirs import KnownCasimirs

            kind: Any = function_of("Bracket.given_casimirs") if self.given_casimirs else KnownCasimirs
            self._casimirs[degree] = kind.of(self, degree)
        return self._casimirs[degree]

    @cached_property
    def trace_casimirs(self) -> TraceCasimirs | None:
        r"""The Casimirs in closed form as traces $\operatorname{tr} X^k$, and Pfaffians; None where none is known.

        `casimirs` returns them where a search for polynomials could not end, see
        `liepoisson.structure.trace_casimirs.replaces_search`.
        """
        from liepoisson.structure.trace_casimirs import trace_casimirs

        return trace_casimirs(self)

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
        return function_of("Bracket.casimir_certificate")(self, function, symbols)

    def casimir_report(self, degree: int | None = None) -> CasimirReport:
        """The Casimirs with proofs of their number, completeness, and the parameter values where more appear.

        Args:
            degree: As for `casimirs`.

        Raises:
            ParameterError: the degree is not a positive integer, or too large for the search.
        """
        if self.given_casimirs:
            return function_of("Bracket.casimir_report")(self, degree)
        from liepoisson.structure.casimirs import casimir_report

        return casimir_report(self, degree)

    def strata(self) -> list[Stratum]:
        """The sets on which the rank is constant or generic, from the open one down to the origin."""
        from liepoisson.structure.strata import strata

        return strata(self)

    def derivations(self) -> list[Derivation]:
        """A basis of the derivations of A that keep the constant part: linear symmetries that act on the fields."""
        from liepoisson.structure.derivations import Names, derivations

        return derivations(self.extension, self.constants_of_fields, Names(self.field_names, self.symbols))

    def scalings(self) -> list[Scaling]:
        """Scalings of fields that change nothing but the values of symbolic parameters."""
        from liepoisson.structure.derivations import scalings

        return scalings(self.extension, self.constants_of_fields, self.field_names)

    @property
    def constants_of_fields(self) -> list[Constant]:
        """The constant part by fields and components, both orders."""
        n = self.algebra.dimension
        terms = [(divmod(i, n), divmod(j, n), c) for (i, j), c in self.constant.items()]
        return [entry for i, j, c in terms for entry in ((i, j, c), (j, i, -c))]

    def in_variables(
        self, variables: Mapping[str, str | Expr], inverse: Mapping[str, str | Expr], *, check: bool = True
    ) -> Bracket:
        r"""The same bracket in other coordinates y(x).

        $$\{y_a, y_b\} = \sum_{ij} \partial_i y_a\, J_{ij}\, \partial_j y_b .$$

        It is a `PoissonTensor`, whose Casimirs are those of this bracket, in the new coordinates.  Where this bracket
        has angles the new coordinates must be functions on their circles, or angles that go round once.

        Example:
            >>> bent = lp.canonical(1).in_variables({"x": "q1", "y": "p1 + q1^2"}, {"q1": "x", "p1": "y - x^2"})
            >>> bent.poisson_tensor()
            Matrix([
            [ 0, 1],
            [-1, 0]])

        Args:
            variables: The new coordinates, as functions of the old ones.
            inverse: The old coordinates, as functions of the new ones.
            check: Verify the Jacobi identity of the result, which it has if this is a Poisson bracket.

        Raises:
            BracketError: the functions are not inverse to each other, a coordinate is missing, a new one is neither a
                function on the circles of the angles nor an angle, or the bracket has time.
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: a name is none that a user may choose.
        """
        return function_of("Bracket.in_variables")(self, variables, inverse, check=check)

    def in_invariants(
        self, invariants: Mapping[str, str | Expr], *, levels: Mapping[str, str | Expr] | None = None
    ) -> Bracket:
        r"""The bracket of functions that are closed under it, such as the invariants of a symmetry: Poisson reduction.

        $$\{f_a, f_b\} = P_{ab}(f_1, \dots, f_k) .$$

        It is a `PoissonTensor` in the functions as coordinates.  That each bracket is a polynomial in them is decided
        exactly, and it is computed, by a Gröbner basis; a denominator may be a polynomial in them, too.  Relations
        between the functions, such as $w_1^2 + w_2^2 + w_3^2 = w_0^2$, are Casimirs of the result, whose value is 0 on
        states that come from here; so are Casimirs of this bracket that are functions of the invariants.

        Example:
            >>> plane = lp.canonical(2).in_invariants(
            ...     {"r": "q1^2 + q2^2", "s": "q1*p1 + q2*p2", "p": "p1^2 + p2^2"}, levels={"L": "q1*p2 - q2*p1"}
            ... )
            >>> plane.poisson_tensor()
            Matrix([
            [   0, 2*r, 4*s],
            [-2*r,   0, 2*p],
            [-4*s, -2*p, 0]])
            >>> plane.casimirs()
            [L**2 - p*r + s**2]

        Args:
            invariants: The functions by the names of the new coordinates, polynomials or rational functions with
                rational coefficients.
            levels: Components of the momentum map that are constant on the reduced phase space, by name: functions
                whose brackets with all invariants are 0.  They are symbolic parameters of the result.

        Raises:
            BracketError: a bracket of two functions is no polynomial in them, the Jacobi identity holds only where
                their relations do, a level does not commute with an invariant, an invariant is neither a function on
                the circles of the angles nor an angle, the bracket has time, or it was not decided within its limits.
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: a name is none that a user may choose, or a function is not rational.

        References: [marsden1999], section 10.5; [cox2015], section 7.3.
        """
        return function_of("Bracket.in_invariants")(self, invariants, levels=levels)

    def dirac_bracket(
        self, constraints: Sequence[str | Expr] | Mapping[str, str | Expr], *, symbols: Sequence[str] = ()
    ) -> Bracket:
        r"""The Dirac bracket of constraints of second class, in the same coordinates.

        $$\{f, g\}_D = \{f, g\} - \sum_{ab} \{f, \phi_a\}\, (C^{-1})_{ab}\, \{\phi_b, g\}, \qquad
          C_{ab} = \{\phi_a, \phi_b\} .$$

        It is a `PoissonTensor`, defined where the determinant of C does not vanish.  Its Casimirs are the constraints,
        in their order, and those of this bracket.  Motion that begins where the constraints vanish stays there; a
        Hamiltonian has the same values as before.

        That the determinant does not vanish identically on any part of the set of the constraints is decided for
        rational functions with rational coefficients; for others it is tried at states of this set in 50 digits.

        Example:
            >>> sphere = lp.canonical(names=("x", "y", "z")).dirac_bracket(
            ...     ["x^2 + y^2 + z^2 - 1", "x*p_x + y*p_y + z*p_z"]
            ... )
            >>> sphere.poisson_tensor()[0, 3]
            (y**2 + z**2)/(x**2 + y**2 + z**2)

        Args:
            constraints: The functions phi that vanish, a list or a mapping from names.
            symbols: Names in them that stay symbolic and are taken as generic, besides those of the bracket.

        Raises:
            ConstraintError: a combination of them is first class; the error names it.
            BracketError: they contradict each other, their gradients are dependent where they vanish, one is constant,
                the bracket has time, or whether they are of second class was not decided.
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: no list of functions, or one is no function on the circle of an angle.

        References: Dirac, Canad. J. Math. 2 (1950) 129; [marsden1999], section 8.5.
        """
        return function_of("Bracket.dirac_bracket")(self, constraints, symbols=symbols)

    def substitute(self, values: Mapping[str, Coefficient]) -> Bracket:
        """The same bracket with values for some of its symbols.

        Raises:
            ParameterError: not a mapping from names, or symbols, to exact values, or a name is none of them.
        """
        values = values_of_symbols(values, self.symbols)
        if not values:
            return self
        algebra = self.algebra.substitute({s: value for s, value in values.items() if s in self.algebra.symbols})
        extension = self.extension.substitute({s: value for s, value in values.items() if s in self.extension.symbols})
        constant: Any = {pair: substituted(value, values) for pair, value in self.constant_rows.items()}
        made = Bracket(algebra, extension, constant=constant, name=self._name, check=False)
        made.angles = self.angles
        made.given_casimirs = tuple(to_sympy(substituted(one, values)) for one in self.given_casimirs)
        return made

    def __add__(self, other: object) -> NoReturn:
        """Brackets are not added; their parts are.

        Raises:
            BracketError: always; the message says how a sum is written.
        """
        raise BracketError(
            f"a bracket cannot be added to another object; got {self!r} + {other!r:.60}. Add the algebras, "
            "(so(3) + so(3)) @ trivial(), the extensions, so(3) @ (trivial() + trivial()), or count the pairs, "
            "canonical(2)."
        )

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: the definition; everything else is derived again when it is asked for."""
        definition = {"algebra": self.algebra, "extension": self.extension}
        names = ("coefficients", "angles", "given_casimirs")
        own = {name: value for name in names if (value := getattr(self, name))}
        return {**definition, "constant_rows": self.constant_rows, "_name": self._name, **own}

    def _repr_latex_(self) -> str | None:
        """What a notebook shows: the Poisson tensor, up to 12 coordinates."""
        return function_of("Bracket._repr_latex_")(self)

    def __repr__(self) -> str:
        if self._name is not None:
            return self._name
        return f"{self.algebra.name} ⊗ {self.extension.name}{' + constant part' if self.constant_rows else ''}"

    @cached_property
    def tensor(self) -> LinearPoissonTensor:
        """The Poisson tensor as sparse exact data, for computations that do not need SymPy."""
        from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor

        return LinearPoissonTensor.of(self.dimension, self._all_terms, self.algebra.dimension)

    @cached_property
    def formulas(self) -> TensorEntries:
        """The entries as expressions in the coordinates."""
        from liepoisson.structure.poisson.tensor_entries import TensorEntries

        upper = {(i, j): entry for (i, j), entry in self._matrix.entries.items() if i < j}
        return TensorEntries(self.variables, upper)

    @cached_property
    def _all_terms(self) -> tuple[tuple[int, int, int, Exact], ...]:
        """The terms of J, with `CONSTANT` for m in the constant part."""
        from liepoisson.structure.poisson.poisson_tensor import CONSTANT

        constant = ((i, j, CONSTANT, c) for (i, j), c in self.constant.items())
        return (*self._terms, *(term for i, j, m, c in constant for term in ((i, j, m, c), (j, i, m, -c))))

    @cached_property
    def _terms(self) -> tuple[tuple[int, int, int, Exact], ...]:
        """All (i, j, m, c) with sum_m c x_m the linear part of J_ij, both orders of i and j."""
        kept: Any = self._kept_terms
        if all(isinstance(c, Fraction) for *_, c in kept):
            return tuple(kept)
        known = {c: to_sympy(c) for *_, c in kept}
        return tuple((i, j, m, known[c]) for i, j, m, c in kept)

    @cached_property
    def _kept_terms(self) -> list[tuple[int, int, int, Coefficient]]:
        """The same before SymPy is asked for them."""
        from liepoisson.structure.poisson.poisson_tensor import linear_terms

        return linear_terms(self.algebra.dimension, self.algebra.rows, self.extension.rows)

    @cached_property
    def _matrix(self) -> PoissonMatrix:
        from liepoisson.structure.poisson.poisson_tensor import PoissonMatrix

        return PoissonMatrix(self.variables, self._terms, self.constant)

    @cached_property
    def _casimirs(self) -> dict[int | None, KnownCasimirs]:
        return {}

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
        from liepoisson.structure.trace_casimirs import modulo_casimirs

        return modulo_casimirs(expression, self)


def _renamed(extension: Extension, field_names: Sequence[str]) -> Extension:
    """The extension with other field names."""
    return extension.rename(*read_names(field_names, "field_names", extension.field_names))


def _check_field_names(fields: tuple[str, ...], coordinates: set[str]) -> None:
    """Refuse fields that no formula could name, and those whose name is that of a coordinate of another field."""
    for name in fields:
        check_name(name, "a field name")
    for name in coordinates:
        check_not_reserved(name, "the name of a coordinate")
    if clash := sorted(coordinates.intersection(fields)):
        raise BracketError(
            f"a name must stand for one thing; {', '.join(clash)} would be a field and a coordinate of another field. "
            "Rename one of the fields."
        )


def _check_type(value: object, wanted: type, name: str, example: str) -> None:
    if not isinstance(value, wanted):
        article = "an" if wanted is Extension else "a"
        raise not_a(f"{article} {wanted.__name__}", value, name, f"try {example}")
