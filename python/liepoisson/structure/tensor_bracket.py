r"""Poisson brackets that are given by formulas, $\{x_i, x_j\} = J_{ij}(x)$, linear or not.

A `PoissonTensor` is a `Bracket` without a Lie algebra: each coordinate is a field of its own, as those of a canonical
bracket are, and what needs structure constants is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from math import comb
from typing import TYPE_CHECKING, Any, ClassVar, cast

from liepoisson.algebra.exact_numbers import (
    Coefficient,
    Exact,
    is_zero,
    substituted,
    symbols_of,
    to_sympy,
)
from liepoisson.errors import BracketError, JacobiError, ParameterError, ShapeError
from liepoisson.formula.parameters import GivenValue, Parameter, values_of_symbols
from liepoisson.formula.scope import Scope
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import is_named
from liepoisson.inputs.names import check_title
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.constant_part import read_pair
from liepoisson.structure.given_expressions import (
    is_finite_and_real,
)
from liepoisson.structure.given_functions import (
    check_distinct,
    listed_functions,
    read_function,
    read_variables,
    scope_with,
)
from liepoisson.structure.poisson.casimir_check import checked_casimirs
from liepoisson.structure.poisson.tensor_entries import N_POINTS, TensorEntries

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.structure.casimirs import CasimirReport
    from liepoisson.structure.certificates import JacobiCertificate, RankCertificate
    from liepoisson.structure.locus import Stratum
    from liepoisson.structure.magnetic_field import MagneticField
    from liepoisson.structure.poisson.poisson_tensor import PoissonMatrix


@explains_its_methods
class PoissonTensor(Bracket):
    r"""A Poisson bracket by the formulas of its tensor, $\{x_i, x_j\} = J_{ij}(x)$, $\dot x = J(x)\nabla H(x)$.

    The entries are polynomials, rational functions or other smooth functions of the coordinates, in the grammar of
    `liepoisson.formula.expression`.  That they obey the Jacobi identity,

    $$\sum_m \partial_m J_{ij}\, J_{mk} + \text{cyclic} = 0,$$

    is decided exactly for rational entries.  For others it is proved where it follows without relations between
    functions, such as $\sin^2 + \cos^2 = 1$, and else tried at 10 random points in decimals; `jacobi` says which.

    Example:
        >>> entries = {("x", "y"): "x*y", ("y", "z"): "y*z", ("z", "x"): "z*x"}
        >>> bracket = lp.PoissonTensor(["x", "y", "z"], entries)
        >>> bracket.jacobi, bracket.casimirs()
        ('proved', [x*y*z])
        >>> lp.System(bracket, "x + y + z").equations
        {x: x*y - x*z, y: -x*y + y*z, z: x*z - y*z}

    Args:
        variables: Names of the coordinates.
        entries: $J_{ij}$ by pairs of coordinates, by name or number: texts, numbers or SymPy expressions. A pair may be
            given in both orders, if these agree.
        parameters: Values of other names in the texts: numbers, vectors or matrices.
        symbols: Names that stay symbolic and are taken as generic; a vector with its length, as in "a[3]".
        casimirs: Known Casimirs, a list or a mapping from names, which are not kept: they are C1, C2, ... in this
            order.
        angles: The coordinates that are angles, modulo $2\pi$, in which the entries must be periodic.
        name: How it is printed.
        check: Verify the Jacobi identity.  Switch this off only to study what goes wrong.

    Raises:
        BracketError: a coordinate is unknown, a pair is one of a coordinate with itself, both orders of a pair
            disagree, a function is no Casimir, a parameter has the name of a coordinate in it, or an angle is no
            coordinate.
        JacobiError: the Jacobi identity fails; the error names the three coordinates and the residual.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        ParameterError: a name is none that a user may choose, an entry is none of these, not finite and real, not
            smooth, or not periodic in an angle.
        ShapeError: the variables are no sequence of names.

    References: [marsden1999], sections 10.1 and 10.5; Weinstein, J. Differential Geom. 18 (1983) 523.
    """

    has_algebra: ClassVar[bool] = False

    given_casimirs: tuple[Expr, ...] = ()

    origin: MagneticField | None = None
    """The magnetic field that it was made of, if it was."""

    def __init__(
        self,
        variables: Sequence[str],
        entries: Mapping[tuple[str | int, str | int], str | Parameter],
        parameters: Mapping[str, GivenValue] | None = None,
        *,
        symbols: Sequence[str] = (),
        casimirs: Sequence[str | Expr] | Mapping[str, str | Expr] = (),
        angles: Sequence[str] = (),
        name: str | None = None,
        check: bool = True,
    ) -> None:
        names = read_variables(variables)
        scope = scope_with(names, parameters, symbols)
        title = name if name is None else check_title(name, "the name of a bracket", None)
        self._define(names, _read_entries(entries, names, scope), title)
        self._jacobi = self._checked_jacobi() if check else "not checked"
        functions = listed_functions(casimirs, "casimirs", '["x*y*z"]')
        self.given_casimirs = checked_casimirs(self, [read_function(one, scope, "a Casimir") for one in functions])
        self.angles = self.with_angles(angles).angles

    def _define(self, names: tuple[str, ...], formulas: Mapping[tuple[int, int], Expr], name: str | None) -> None:
        self.coordinate_names_in_order = names
        self.formulas = TensorEntries(self.variables, dict(sorted(formulas.items())))
        self._name = name
        self._jacobi = "not checked"
        if self.is_linear:
            self.constant_rows = {(i, j): c for i, j, m, c in self.formulas.linear_terms if m is None}

    @property
    def jacobi(self) -> str:
        """How the Jacobi identity is known: "proved", or "sampled" at random points; "not checked" if it was not."""
        return self._jacobi

    @property
    def dimension(self) -> int:
        """Number N of coordinates."""
        return len(self.coordinate_names_in_order)

    @property
    def field_names(self) -> tuple[str, ...]:
        """The coordinates, each a field of its own."""
        return self.coordinate_names_in_order

    @property
    def field_lengths(self) -> tuple[int, ...]:
        """One component each."""
        return (1,) * self.dimension

    @property
    def has_scalar_fields(self) -> bool:
        """Each coordinate has its own name."""
        return True

    @property
    def vectors(self) -> Mapping[str, Sequence[str]]:
        """None: each coordinate is a field of its own."""
        return {}

    @property
    def is_linear(self) -> bool:
        """Whether all entries are polynomials of degree at most one."""
        degree = self.formulas.degree
        return degree is not None and degree <= 1

    @property
    def symbols(self) -> set[str]:
        """Names of the parameters kept symbolic, in the entries and the given Casimirs."""
        functions = [*self.formulas.entries.values(), *self.given_casimirs]
        own = {str(s) for function in functions for s in function.free_symbols}
        return own.difference(self.coordinate_names_in_order)

    def entries(self) -> tuple[tuple[int, int, int, Exact], ...]:
        r"""The linear part of a linear bracket as sparse data, as for a `Bracket`.

        Raises:
            BracketError: the bracket is not linear; `formulas` has its entries.
        """
        if not self.is_linear:
            raise self._refusal("structure constants")
        return tuple((i, j, m, c) for i, j, m, c in self.formulas.linear_terms if m is not None)

    def terms(self) -> tuple[tuple[int, int, int | None, Exact], ...]:
        r"""All terms (i, j, m, c) of $\{x_i, x_j\}$, i < j; where the bracket is not linear (i, j, None, J_ij(x))."""
        if self.is_linear:
            return super().terms()
        return tuple((i, j, None, entry) for (i, j), entry in self.formulas.entries.items())

    def kept_entries(self) -> tuple[tuple[int, int, int | None, Exact], ...]:
        """The same as `terms`: formulas are SymPy's."""
        return self.terms()

    def rename(self, *field_names: str) -> PoissonTensor:
        """The same bracket with other names for its coordinates, one by one.

        Raises:
            ShapeError: not one name per coordinate.
            BracketError: a coordinate and a parameter would have the same name, or the bracket has time.
            ParameterError: a name is not an identifier.
        """
        from sympy import Symbol

        self.check_without_time("a bracket with other names")
        names = read_variables(field_names)
        if len(names) != self.dimension:
            raise ShapeError(f"wanted {self.dimension} names, one per coordinate; got {len(names)}. Name all of them.")
        check_distinct(names, self.symbols)
        known: Any = dict(zip(self.variables, map(Symbol, names), strict=True))
        made = self._mapped(names, lambda f: f.xreplace(known))
        made.angles = tuple(str(known[x]) for x in self.variables if str(x) in self.angles)
        return made

    def substitute(self, values: Mapping[str, Coefficient]) -> PoissonTensor:
        """The same bracket with values for some of its symbols.

        Raises:
            BracketError: a value depends on a coordinate.
            ParameterError: not a mapping from names, or symbols, to exact values, a name is none of them, or an entry
                or a Casimir is not finite and real.
        """
        read = values_of_symbols(values, self.symbols)
        if not read:
            return self
        check_distinct(self.coordinate_names_in_order, set[str]().union(*map(symbols_of, read.values())))
        found = self._mapped(self.coordinate_names_in_order, lambda f: to_sympy(substituted(f, read)))
        if not all(map(is_finite_and_real, [*found.formulas.entries.values(), *found.given_casimirs])):
            raise ParameterError(
                f"values: wanted some with which all entries are finite and real; got {values!r:.100}. Give others."
            )
        return found

    def _mapped(self, names: tuple[str, ...], change: Any) -> PoissonTensor:
        entries = {pair: change(entry) for pair, entry in self.formulas.entries.items()}
        casimirs = [change(casimir) for casimir in self.given_casimirs]
        origin = None if self.origin is None else self.origin.mapped(change)
        made = tensor_of(names, entries, casimirs=casimirs, jacobi=self._jacobi, name=self._name, origin=origin)
        made.angles = self.angles
        return made

    # What is proved about it

    def jacobi_residuals(self) -> dict[tuple[Symbol, Symbol, Symbol], Expr]:
        r"""$\{\{x_i, x_j\}, x_k\}$ + cyclic for all i < j < k with a term; zero throughout if this is a bracket."""
        from sympy import S

        x = self.variables
        found: dict[tuple[Symbol, Symbol, Symbol], Expr] = {}
        for i, j, k in self.formulas.triples():
            terms = ((x[i], x[j], x[k]), (x[j], x[k], x[i]), (x[k], x[i], x[j]))
            total: Any = sum((self(self(u, v), w) for u, v, w in terms), S.Zero)
            found[x[i], x[j], x[k]] = total.cancel() if self.formulas.is_rational else total
        return found

    def jacobi_certificate(self) -> JacobiCertificate:
        """The Jacobi identity for all triples of coordinates, computed now from the entries; antisymmetric they are.

        Of a bracket that was made of a magnetic field it is computed from this field, div B = 0.
        """
        if self.origin is not None:
            return self.origin.jacobi_certificate(self.variables, comb(self.dimension, 3))
        from liepoisson.structure.certificates import Failure, JacobiCertificate

        n_triples, open_ones = comb(self.dimension, 3), 0
        method = {0: "there are no triples of coordinates", 1: "the one triple of coordinates"}.get(
            n_triples, f"all {n_triples} triples of coordinates"
        )
        for triple in self.formulas.triples():
            names = tuple(self.coordinate_names_in_order[k] for k in triple)
            residual = self.formulas.jacobi_residual(triple)
            if residual is None:
                open_ones += 1
                if (value := self.formulas.jacobi_fails_at_a_point(triple)) is not None:
                    return JacobiCertificate(False, n_triples, f"computed: {method}", (Failure(names, value),))
            elif residual != 0:
                return JacobiCertificate(False, n_triples, f"computed: {method}", (Failure(names, residual),))
        if open_ones:
            tried = f"tried: {open_ones} of {n_triples} triples at {N_POINTS} random points in decimals"
            return JacobiCertificate(True, n_triples, tried, n_points=N_POINTS)
        return JacobiCertificate(True, n_triples, f"computed: {method}")

    def _checked_jacobi(self) -> str:
        certificate = self.jacobi_certificate()
        if not certificate.holds:
            failure = certificate.failures[0]
            raise JacobiError(failure.coordinates, str(failure.residual))
        return "proved" if certificate.proved else "sampled"

    def rank(self, point: Sequence[Parameter] | None = None) -> int:
        """The rank of the Poisson tensor, the dimension of the symplectic leaf.

        Args:
            point: N exact numbers; parameters that the bracket keeps symbolic are generic.  None: the rank at a random
                point, which bounds the generic rank from below and almost surely equals it; `rank_certificate` proves
                it for rational entries.

        Raises:
            ShapeError: not N numbers.
            ParameterError: a component is not exact, or a symbol, or an entry is not defined there.
        """
        return self.formulas.lower_rank if point is None else self.formulas.rank_at(self._read_point(point))

    def rank_certificate(self) -> RankCertificate:
        """The generic rank: at one point, and by elimination over the field that the entries generate."""
        from liepoisson.structure.certificates import RankCertificate

        lower, N = self.formulas.lower_rank, self.dimension
        even = N - N % 2
        if lower == even:
            return RankCertificate(
                lower, even, N, f"J has rank {lower} at one point, and no antisymmetric one has more"
            )
        method = f"J has rank {lower} at one point; elimination over the field of its entries bounds it from above"
        return RankCertificate(lower, min(even, self.formulas.upper_rank), N, method)

    def casimir_report(self, degree: int | None = None) -> CasimirReport:
        """The Casimirs with proofs of their number and completeness.

        Args:
            degree: As for `casimirs`.

        Raises:
            ParameterError: the degree is not a positive integer, or too large for the search.
            BracketError: a degree is given, and the entries are not rational functions, of which none is searched.
        """
        from liepoisson.structure.tensor_leaves import casimir_report

        return casimir_report(self, degree)

    def _known_casimirs(self, degree: int | None) -> Any:
        if degree not in self._casimirs:
            from liepoisson.structure.tensor_leaves import TensorCasimirs

            self._casimirs[degree] = cast("Any", TensorCasimirs.of(self, degree))
        return self._casimirs[degree]

    def rational_casimirs(self, degree: int) -> list[Expr]:
        r"""Independent Casimirs P/Q with P and Q of at most a degree, Q a product of functions that are normal.

        A function F is normal where $\{x_i, F\} = \lambda_i F$ with polynomials $\lambda_i$: the coordinates of a
        log-canonical bracket are.  Those that are looked for are the factors of the entries; P may be any polynomial
        with the same $\lambda_i$ as Q.  So Casimirs with other denominators are not found; of a linear bracket they
        are, as of any `Bracket`.

        Args:
            degree: The highest degree of P and Q.

        Raises:
            BracketError: the entries are not rational functions.
            ParameterError: the degree is not a positive integer, or too large for the search.
        """
        if self.is_linear:
            return super().rational_casimirs(degree)
        from liepoisson.structure.tensor_leaves import rational_casimirs

        return rational_casimirs(self, degree)

    def strata(self) -> list[Stratum]:
        r"""Sets on which the rank is constant or generic, the open one first.

        Of a log-canonical tensor, $J_{ij} = c_{ij} x_i x_j$, these are all sets where some coordinates vanish and the
        others do not, up to 6 coordinates: the rank there is that of c without the rows and columns of the former.  Of
        any other that is polynomial with rational numbers they are the sets where Pfaffians of one size vanish and
        those of the next do not all.  Else, and beyond the limits of algebra, it is the open one alone, "everywhere"
        if J is constant.
        """
        from liepoisson.structure.tensor_leaves import strata

        return strata(self)

    @cached_property
    def tensor(self) -> Any:
        """The tensor as sparse exact data; of rational entries times their common denominator.

        Raises:
            BracketError: the entries are no rational functions.
        """
        if self.is_linear:
            from liepoisson.structure.poisson.poisson_tensor import CONSTANT, LinearPoissonTensor

            terms = [(i, j, CONSTANT if m is None else m, c) for i, j, m, c in self.formulas.linear_terms]
            both = (term for i, j, m, c in terms for term in ((i, j, m, c), (j, i, m, -c)))
            return LinearPoissonTensor.of(self.dimension, both)
        if self.formulas.cleared is None:
            raise BracketError(
                f"wanted entries that are rational functions of the coordinates; got those of {self!r}, of which no "
                "Casimirs are searched. Give those that are known, casimirs=[...]."
            )
        return self.formulas.cleared

    @cached_property
    def _matrix(self) -> PoissonMatrix:
        from liepoisson.structure.poisson.poisson_tensor import PoissonMatrix

        return PoissonMatrix(self.variables, (), self.formulas.entries)

    def coboundary(self) -> tuple[Expr, ...] | None:
        r"""A translation that removes the constant part of a linear bracket, as for a `Bracket`.

        Raises:
            BracketError: the bracket is not linear.
        """
        if not self.is_linear:
            raise self._refusal("a constant part")
        return super().coboundary()

    def _refusal(self, what: str) -> BracketError:
        return BracketError(
            f"wanted a bracket that is given by a Lie algebra, for its {what}; got {self!r}, which is given by "
            "formulas. This is not available for it; write it as algebra @ extension if it is linear."
        )

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: the definition; everything else is derived again when it is asked for."""
        kept = (
            "coordinate_names_in_order",
            "formulas",
            "_name",
            "_jacobi",
            "given_casimirs",
            "constant_rows",
            "coefficients",
            "angles",
            "origin",
        )
        return {name: value for name, value in self.__dict__.items() if name in kept}

    def __repr__(self) -> str:
        return self._name or f"PoissonTensor({', '.join(self.coordinate_names_in_order)})"

    if not TYPE_CHECKING:  # for type checkers a bracket has them

        def __getattr__(self, name: str) -> object:
            """The refusal of what only a bracket of a Lie algebra has."""
            if name in ("algebra", "extension", "constant"):
                raise self._refusal("constant part" if name == "constant" else name)
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}", name=name, obj=self)


def tensor_of(
    names: tuple[str, ...],
    entries: Mapping[tuple[int, int], Expr],
    *,
    casimirs: Sequence[Expr] = (),
    jacobi: str | None = None,
    name: str | None = None,
    are_nonzero: bool = False,
    origin: MagneticField | None = None,
) -> PoissonTensor:
    """A tensor of entries and Casimirs that have been derived; `jacobi` is what is known, else it is checked."""
    made: Any = PoissonTensor.__new__(PoissonTensor)
    kept = entries if are_nonzero else {pair: entry for pair, entry in entries.items() if not is_zero(entry)}
    made._define(names, kept, name)
    made._jacobi = jacobi or made._checked_jacobi()
    made.given_casimirs = tuple(casimirs)
    made.origin = origin
    return cast("PoissonTensor", made)


def _read_entries(given: Any, names: tuple[str, ...], scope: Scope) -> dict[tuple[int, int], Expr]:
    """The nonzero entries by (i, j) with i < j."""
    if not is_named(given):
        raise ParameterError(
            f"entries must be a mapping from pairs of coordinates to formulas; got {given!r:.60}. Write for example "
            f'{{("{names[0]}", "{names[-1]}"): "{names[0]}*{names[-1]}"}}.'
        )
    found: dict[tuple[int, int], Any] = {}
    for pair, value in given.items():
        i, j = read_pair(pair, names, "a Poisson tensor")
        entry: Any = read_function(value, scope, f"{{{names[i]}, {names[j]}}}")
        if i == j:
            raise BracketError(
                f"a Poisson tensor is antisymmetric, and the bracket of a coordinate with itself is 0; got "
                f"{{{names[i]}, {names[i]}}} = {entry!s:.60}. Remove the entry."
            )
        key, entry = (min(i, j), max(i, j)), entry if i < j else -entry
        if key in found and not is_zero(found[key] - entry):
            raise BracketError(
                f"a Poisson tensor is antisymmetric; got {{{names[key[0]]}, {names[key[1]]}}} = {found[key]!s:.60} and "
                f"{{{names[key[1]]}, {names[key[0]]}}} = {-entry!s:.60}. Give one of them, or correct it."
            )
        found[key] = entry
    return {pair: entry for pair, entry in sorted(found.items()) if not is_zero(entry)}
