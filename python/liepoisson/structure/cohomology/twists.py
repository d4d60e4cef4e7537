r"""Every way to twist a commutative algebra: symmetric 2-cocycles modulo coboundaries, exactly.

A Lie-Poisson bracket of g (x) A is deformed to first order by a symmetric cocycle f of A, $W + t f$; coboundaries are
what changes of variables do.  The classes are Harrison's cohomology $H^2(A, A)$.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import groupby
from numbers import Integral
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.exact_numbers import Exact, product_of, sum_of, to_sympy
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.algebra.ideals.polynomial_system import PolynomialSystem
from liepoisson.algebra.linear_algebra import rank
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, read_parameter, read_symbol
from liepoisson.formula.scalars import as_deadline
from liepoisson.formula.tensors import in_sympy
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.deadline import SEARCH_LIMIT
from liepoisson.inputs.given import listed
from liepoisson.inputs.names import free_name
from liepoisson.inputs.refusals import not_a
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.casimirs import special_values
from liepoisson.structure.cohomology.change_of_basis import in_basis
from liepoisson.structure.cohomology.cocycle import Cocycle
from liepoisson.structure.cohomology.commutative_complex import Cochain, CommutativeComplex
from liepoisson.structure.cohomology.deformed_algebra import ClosedForm, Deformation, symbols_in, taken_names
from liepoisson.structure.cohomology.mending import Mended, mended
from liepoisson.structure.extension import Extension, Products, read_products

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.cohomology.twist_orbits import TwistOrbits


_CHEAP = Limits(work=2_000_000)
"""About two seconds: 52 conditions of 16 parameters take 0.2 s, 83 of 36 are left as they are."""


class ExceptionalTwists(NamedTuple):
    """Values of parameters of the algebra at which its cohomology is another.

    Attributes:
        condition: For example "epsilon = 0".
        twists: The cocycles there.
    """

    condition: str
    twists: Twists


@explains_its_methods
@dataclass(frozen=True, eq=False)
class Twists:
    r"""The symmetric cocycles of a commutative algebra, $f: A \times A \to A$, modulo coboundaries.

    Example:
        >>> twists = lp.cocycles(lp.semidirect(3))
        >>> twists.dimension, twists.cocycle_dimension, twists.coboundary_dimension
        (4, 9, 5)
        >>> print(*twists.basis, sep="; ")
        e1*e1 = e2; e1*e2 = e2; e2*e2 = e1; e2*e2 = e2

    Attributes:
        given: The bracket or the extension that was asked about.
        extension: The algebra A.
    """

    given: Bracket | Extension
    extension: Extension

    @cached_property
    def basis(self) -> tuple[Cocycle, ...]:
        """Representatives of a basis of the classes.

        Each has the coefficient 1 at its first place, where no coboundary and no other one has any, and
        $f(1, b) = 0$ where A has a unit.
        """
        return tuple(Cocycle(self, self.written(self._complex, f)) for f in self._complex.basis)

    @property
    def coboundary_dimension(self) -> int:
        """The dimension of the space of coboundaries, $n^2$ minus that of the derivations."""
        return self._complex.n_coboundaries

    @property
    def dimension(self) -> int:
        """The dimension of the space of classes."""
        return len(self.basis)

    @property
    def cocycle_dimension(self) -> int:
        """The dimension of the space of cocycles."""
        return self.dimension + self.coboundary_dimension

    @property
    def derivation_dimension(self) -> int:
        """The dimension of the space of derivations of A."""
        return self.extension.dimension**2 - self.coboundary_dimension

    @property
    def is_rigid(self) -> bool:
        """Whether there is no class but zero: then every deformation is a change of variables."""
        return not self.basis

    def cocycle(self, products: Mapping[tuple[int, int], Mapping[int, Parameter]]) -> Cocycle:
        r"""The cocycle with $f(e_\mu, e_\nu) = \sum_\lambda$ `products[mu, nu][lam]` e_lam.

        Args:
            products: By pairs (mu, nu); a pair and its reverse need not both be given.

        Raises:
            CocycleError: it is no cocycle; the error names three basis elements and what is left.
            ShapeError: not a mapping from pairs to mappings, or an index is out of range.
            ParameterError: an entry is not exact.
        """
        found = Cocycle(self, in_sympy(read_products(self.extension.dimension, products)))
        found.check()
        return found

    def combination(self, coefficients: Sequence[Parameter]) -> Cocycle:
        """The combination of the basis with these coefficients, numbers or names.

        Raises:
            ShapeError: not one coefficient for each.
            ParameterError: a coefficient is not exact.
        """
        items = listed(coefficients, "coefficients")
        if items is None or len(items) != self.dimension:
            got = repr(coefficients) if items is None else f"{len(items)}"
            raise ShapeError(
                f"coefficients must be {self.dimension} numbers or names; got {got:.60}. Give one for each."
            )
        total: dict[tuple[int, int], dict[int, Exact]] = {}
        for k, (given, f) in enumerate(zip(items, self.basis, strict=True)):
            c = read_parameter(given, f"coefficients[{k}]")
            for pair, row in f.products.items():
                here = total.setdefault(pair, {})
                for lam, value in row.items():
                    here[lam] = sum_of(here.get(lam, Fraction(0)), product_of(c, value))
        return Cocycle(self, in_sympy(read_products(self.extension.dimension, total)))

    def deformation(
        self, parameters: Sequence[str] | None = None, *, order: int | None = None, time_limit: float = SEARCH_LIMIT
    ) -> Deformation:
        r"""The general deformation $W + \sum_i s_i f_i + \dots$ with one parameter for each class.

        Its `conditions` are the obstructions: polynomials in the parameters, which vanish where it is associative.
        Rational ones that follow from those of lower degree are left out, if some seconds decide that.
        Every small deformation of A is one of these, up to a change of variables (Kuranishi's family).

        Args:
            parameters: Their names; s1, s2, ... if left out.
            order: Where to stop if the series does not end; twice the dimension if left out.
            time_limit: Seconds.

        Raises:
            ParameterError: a name is taken, or none.
            ShapeError: not one name for each class.
            TimeLimitError: the time limit has passed.

        References: Nijenhuis and Richardson, Bull. Amer. Math. Soc. 72 (1966) 1.
        """
        names = self._names(parameters)
        with as_deadline(time_limit).running():
            found = self._general(names, order)
            if found.ends or (closed := closed_form(self, self.basis, names)) is None:
                return found
            inner: Any = dict(zip(closed.inner.parameters, map(to_sympy, closed.values), strict=True))
            conditions = tuple(p.subs(inner, simultaneous=True).expand() for p in closed.inner.conditions)
        return replace(found, conditions=conditions, closed_form=closed)

    def _general(self, names: tuple[str, ...], order: int | None = None) -> Deformation:
        """The same as a series alone."""
        complex_ = self._complex
        first: dict[tuple[int, ...], Cochain] = {
            tuple(int(i == k) for i in range(self.dimension)): f for k, f in enumerate(complex_.basis)
        }
        found = mended(complex_, first, self.most(order))
        terms = {monomial: self.written(complex_, term) for monomial, term in found.terms.items()}
        conditions = _conditions(found, complex_.field, names)
        return Deformation(self.given, names, terms, conditions, found.order, found.ends)

    def conditions(
        self, parameters: Sequence[str] | None = None, *, order: int | None = None, time_limit: float = SEARCH_LIMIT
    ) -> tuple[Expr, ...]:
        """The obstructions: polynomials in the coefficients of the basis; arguments and errors as for `deformation`.

        Where they vanish the combination begins a deformation.  None: every class does.
        """
        return self.deformation(parameters, order=order, time_limit=time_limit).conditions

    def _names(self, parameters: Sequence[str] | None) -> tuple[str, ...]:
        taken = taken_names(self.given)
        given: Any = [f"s{k}" for k in range(1, self.dimension + 1)] if parameters is None else parameters
        names = listed(given, "parameters")
        if names is None or len(names) != self.dimension:
            got = repr(parameters) if names is None else f"{len(names)}"
            raise ShapeError(f"parameters must be {self.dimension} names; got {got:.60}. Give one for each class.")
        for name in names:
            if read_symbol(name, "parameters") is None or name in taken or names.count(name) > 1:
                raise ParameterError(
                    f"parameters: wanted different names that nothing has yet; got {name!r:.60}. Take another one."
                )
        return tuple(names)

    @cached_property
    def exceptional(self) -> tuple[ExceptionalTwists, ...]:
        """Values of the symbols in W at which the cohomology has another dimension."""
        return self._special[0]

    @cached_property
    def examined(self) -> tuple[str, ...]:
        """All values that had to be looked at; elsewhere the generic answer holds."""
        return self._special[1]

    @cached_property
    def undecided(self) -> tuple[str, ...]:
        """Conditions on several symbols that were not looked at."""
        return self._special[2]

    @cached_property
    def _special(self) -> tuple[tuple[ExceptionalTwists, ...], tuple[str, ...], tuple[str, ...]]:
        field = self._complex.field
        if not field.parameters:
            return (), (), ()
        values, undecided = special_values(self._complex.pivots, field)
        cases: list[ExceptionalTwists] = []
        for condition, substitution in values:
            try:
                there = _cocycles(self.given.substitute(substitution))
            except ParameterError:
                continue  # W has a pole there
            if (there.dimension, there.coboundary_dimension) != (self.dimension, self.coboundary_dimension):
                cases.append(ExceptionalTwists(condition, there))
        return tuple(cases), tuple(condition for condition, _ in values), undecided

    def orbit_dimension(self, f: Cocycle) -> int:
        """The dimension of the orbit of a class under the automorphisms of A; see `Cocycle.orbit_dimension`."""
        complex_, cochain = f.representative.in_cochains
        classes = [complex_.coordinates(complex_.moved(D, cochain))[0] for D in complex_.derivations]
        return rank([{k: v for k, v in enumerate(row) if v} for row in classes], complex_.field)

    def orbits(self) -> TwistOrbits:
        """The orbits of the classes under the automorphisms of A, with representatives.

        Known for R[x,y]/(x,y)^2, whose classes are the binary cubics, for R[x]/(x^n) and C[x]/(x^n), for direct sums of
        these, and where there is no class; for other algebras the answer says that it is not decided.

        Raises:
            ParameterError: the symbols in W leave open what A is.
        """
        return self._orbits

    @cached_property
    def _orbits(self) -> TwistOrbits:
        from liepoisson.structure.cohomology.twist_orbits import orbits

        return orbits(self)

    @cached_property
    def _complex(self) -> CommutativeComplex:
        return self.complex_over(())

    def complex_over(self, values: Iterable[Exact]) -> CommutativeComplex:
        """The normalised cochains over a field that contains some values besides the products."""
        own = [value for row in self.extension.products.values() for value in row.values()]
        others = frozenset(values)
        if all(isinstance(value, Fraction) for value in (*own, *others)):
            others = frozenset[Exact]()
        if others not in self._known:
            field = Coefficients.containing([*own, *sorted(others, key=str)])
            self._known[others] = CommutativeComplex.of(self.extension.dimension, self.extension.products, field)
        return self._known[others]

    @cached_property
    def _known(self) -> dict[frozenset[Exact], CommutativeComplex]:
        return {}

    def written(self, complex_: CommutativeComplex, f: Cochain) -> Products:
        """A cochain as products of basis elements."""
        found: Products = {}
        for (i, j, k), value in sorted(complex_.with_unit(f).items(), key=lambda entry: entry[0]):
            found.setdefault((i, j), {})[k] = complex_.field.write(value, 1)
        return found

    def most(self, order: int | None) -> int:
        """The order at which a series is given up.

        With a grading, a term of order k has a weight of at least k times the least one w of a class, and at most
        that of the products of the two last elements.  For R[x]/(x^n) w is 2, twice that of x, and the series end at
        order n - 1 at the latest; twice the dimension leaves room for w = 1.
        """
        if order is None:
            return 2 * self.extension.dimension
        given: Any = order
        if isinstance(given, bool) or not isinstance(given, Integral) or int(given) < 1:
            raise ParameterError(f"order must be an integer of at least 1; got {order!r:.60}. Leave it out.")
        return int(given)

    def __len__(self) -> int:
        return self.dimension

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: the definition; everything else is derived again when it is asked for."""
        return {"given": self.given, "extension": self.extension}

    def __str__(self) -> str:
        lines = [f"{self.extension.name}: {self.dimension} classes of twists, {self.cocycle_dimension} cocycles"]
        lines += [f"  {f}" for f in self.basis]
        lines += [f"  {case.condition}: {case.twists.dimension} classes" for case in self.exceptional]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<Twists of {self.extension.name}, {self.dimension} classes>"


def closed_form(twists: Twists, first: Sequence[Cocycle], names: Sequence[str]) -> ClosedForm | None:
    """A deformation with these terms of first order, from one of the normal form of A whose series ends.

    In a basis that has nothing to do with the algebra, its grading by powers of generators is hidden, and series
    need not end; in that of the normal form they do.  What is left of each cocycle there is a coboundary.
    """
    from liepoisson.structure.classification import classify

    try:
        found = classify(twists.extension)
    except ParameterError:  # more fields than are classified, or a sign of symbols
        return None
    if found.normal_form is None or found.change_of_basis is None:
        return None
    there, rows = _cocycles(found.normal_form), found.change_of_basis
    moved = [there.cocycle(cast("Any", in_basis(f.products, rows))) for f in first]
    taken = {*names, *twists.extension.symbols, *(s for f in first for s in symbols_in(f.products))}
    inner = there._general(tuple(free_name(f"s{k + 1}", taken) for k in range(there.dimension)))  # pyright: ignore[reportPrivateUsage]
    if not inner.ends:
        return None
    values: list[Exact] = [Fraction(0)] * there.dimension
    for name, f in zip(names, moved, strict=True):
        s = read_parameter(name, name)
        values = [sum_of(old, product_of(s, c)) for old, c in zip(values, f.coordinates, strict=True)]
    return ClosedForm(inner, tuple(values), rows, tuple(f.coboundary_map() for f in moved))


def _conditions(found: Mended, field: Coefficients, names: Sequence[str]) -> tuple[Expr, ...]:
    """The residuals as independent polynomials in the parameters."""
    from sympy import Add, Mul, Symbol

    by_place: dict[Any, dict[Any, Any]] = {}
    for monomial, residual in found.residuals.items():
        for place, value in residual.items():
            by_place.setdefault(place, {})[sum(monomial), tuple(-k for k in monomial)] = value
    symbols = [Symbol(name) for name in names]
    echelon = Echelon(field, sorted(by_place.values(), key=len))
    conditions = [
        Add(
            *(
                Mul(to_sympy(field.write(value)), *(s**-k for s, k in zip(symbols, powers, strict=True)))
                for (_, powers), value in row.items()
            )
        )
        for row in echelon.basis()
    ]
    return tuple(_without_multiples(conditions, symbols) if field.is_rational else conditions)


def _without_multiples(conditions: Sequence[Expr], symbols: Sequence[Any]) -> Sequence[Expr]:
    """The conditions that do not follow from those that begin with a lower degree, or all, if that takes too long."""
    from sympy import Poly

    def lowest(condition: Any) -> int:
        return min(map(sum, Poly(condition, *symbols).monoms()))

    kept: list[Expr] = []
    try:
        for _, group in groupby(sorted(conditions, key=lowest), key=lowest):
            known = PolynomialSystem.of(kept, symbols, limits=_CHEAP)
            kept += [p for p in list(group) if not kept or not known.groebner().contains(known.read(p))]
    except NotDecidedError:
        return conditions
    return kept


@explains_its_arguments
def cocycles(given: Bracket | Extension, *, time_limit: float = SEARCH_LIMIT) -> Twists:
    r"""Every way to twist a bracket of g (x) A, or an algebra A: symmetric 2-cocycles modulo coboundaries.

    Example:
        >>> bracket = lp.so(3) @ lp.semidirect(3)  # the charged heavy top
        >>> twists = lp.cocycles(bracket)
        >>> twists.dimension
        4
        >>> twists.basis[0].bracket("epsilon").casimirs() == (lp.so(3) @ lp.leibniz(3, "epsilon")).casimirs()
        True

    Args:
        given: The bracket or the extension.  Symbols in the products are generic; `exceptional` has the values at
            which the answer is another.
        time_limit: Seconds.

    Raises:
        ParameterError: neither a bracket nor an extension.
        BracketError: the products are not associative, or the bracket has a constant part.
        TimeLimitError: the time limit has passed.

    References: Harrison, Trans. Amer. Math. Soc. 104 (1962) 191; Gerstenhaber, Ann. of Math. 79 (1964) 59.
    """
    if not isinstance(given, (Bracket, Extension)):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise not_a("a Bracket or an Extension", given, "given", "write for example so(3) @ semidirect(3)")
    if isinstance(given, Bracket) and given.constant:
        raise BracketError(
            f"given: wanted a bracket without constant part; got {given!r}. Twists change the products of its "
            "extension: give bracket.extension."
        )
    with as_deadline(time_limit).running():
        found = _cocycles(given)
        assert len(found.basis) == found.dimension  # computed within the limit
    return found


def _cocycles(given: Bracket | Extension) -> Twists:
    extension = given if isinstance(given, Extension) else given.extension
    n, products = extension.dimension, extension.products
    return Twists(given, Extension.from_products(n, products, extension.name, extension.field_names))
