r"""Lie-Poisson brackets of g (x) A, $\{f, g\} = -\langle x, [df, dg] \rangle + c(df, dg)$.

The constant part c is zero for the Lie-Poisson bracket proper; any 2-cocycle of the Lie algebra gives another one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, cast

from liepoisson.algebra.exact_numbers import exact, substituted, symbols_of, to_sympy
from liepoisson.errors import BracketError
from liepoisson.facades import function_of
from liepoisson.formula.parameters import Parameter, values_of_symbols
from liepoisson.formula.tensors import read_names
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.names import check_name, check_not_reserved, check_title
from liepoisson.inputs.refusals import not_a
from liepoisson.structure.constant_part import read_constant, with_linear_part_at
from liepoisson.structure.extension import Extension
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.reductions import Reductions

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.algebra.exact_numbers import Coefficient, Exact
    from liepoisson.structure.casimirs import CasimirReport, KnownCasimirs
    from liepoisson.structure.derivations import Constant, Derivation, Scaling
    from liepoisson.structure.locus import Stratum
    from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor, PoissonMatrix
    from liepoisson.structure.poisson.tensor_entries import TensorEntries
    from liepoisson.structure.trace_casimirs import TraceCasimirs


@explains_its_methods
class Bracket(Reductions):
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
            self.given_casimirs = self.with_casimirs(casimirs).given_casimirs

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
        return function_of("Bracket.strata")(self)

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
