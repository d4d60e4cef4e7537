r"""Deformations of commutative algebras, $W + \sum_\alpha s^\alpha f_\alpha$ in the place of the products W."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.exact_numbers import Exact, is_zero, product_of, substituted, sum_of, symbols_of
from liepoisson.algebra.sparse_polynomials import Monomial
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import is_named, listed, named
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.cohomology.change_of_basis import Rows, identity, in_basis, inverse, multiplied
from liepoisson.structure.extension import Extension, Products

if TYPE_CHECKING:
    from sympy import Expr

Values: TypeAlias = "Parameter | Sequence[Parameter] | Mapping[str, Parameter]"
"""Values of the parameters of a deformation: one, all in order, or some by name."""


@dataclass(frozen=True, eq=False)
class ClosedForm:
    r"""A deformation by rational functions, whose series does not end: one that ends, in other variables.

    Attributes:
        inner: A deformation of the algebra in another basis, whose series ends.
        values: The values of its parameters, linear in those of the deformation.
        basis: That basis, by rows.
        maps: The maps $g_i$: the products are pulled back by $1 + \sum_i s_i g_i$.
    """

    inner: Deformation
    values: tuple[Exact, ...]
    basis: Rows
    maps: tuple[Rows, ...]

    @property
    def is_associative(self) -> bool:
        """Whether the conditions are fulfilled for all values of the parameters."""
        values = dict(zip(self.inner.parameters, self.values, strict=True))
        return all(is_zero(substituted(condition, values)) for condition in self.inner.conditions)

    def products(self, values: Mapping[str, Exact]) -> Products:
        """The products at values of the parameters, in their order."""
        found = self.inner.extension([cast("Any", substituted(value, values)) for value in self.values]).products
        rows = identity(len(self.basis))
        for value, g in zip(values.values(), self.maps, strict=True):
            rows = [
                [sum_of(old, product_of(value, new)) for old, new in zip(row, more, strict=True)]
                for row, more in zip(rows, g, strict=True)
            ]
        return in_basis(found, multiplied(inverse(self.basis), rows))


@explains_its_methods
@dataclass(frozen=True, eq=False)
class Deformation:
    """The algebras, or brackets, that cocycles begin.

    Example:
        >>> twists = lp.cocycles(lp.so(3) @ lp.semidirect(3))
        >>> general = twists.deformation(["p", "q", "r", "s"])
        >>> general.terms[1, 0, 0, 1], general.conditions  # p s in e1 e1
        ({(1, 1): {0: Fraction(-1, 1)}}, ())

    Attributes:
        given: The bracket or the extension that is deformed.
        parameters: Names of the parameters.
        terms: The products that are added, sparse, by the exponents of the parameters.
        conditions: Polynomials in the parameters: where they vanish, and only there, the products are associative.
            Empty if that is so everywhere.
        order: The highest degree in the parameters.
        ends: Whether there are no terms beyond it.
        closed_form: Where the series does not end, the rational functions whose series it is, if they were found; it
            agrees with the terms to first order.
    """

    given: Bracket | Extension
    parameters: tuple[str, ...]
    terms: Mapping[Monomial, Products]
    conditions: tuple[Expr, ...]
    order: int
    ends: bool
    closed_form: ClosedForm | None = None

    def extension(self, values: Values | None = None) -> Extension:
        """The deformed algebra.

        Args:
            values: Of the parameters; those left out stay symbolic.

        Raises:
            BracketError: there are conditions, and the values do not fulfil them.
            ParameterError: the series was not found to end, or a value is not exact or belongs to no parameter.
            ShapeError: not as many values as parameters.
        """
        if not self.ends and self.closed_form is None:
            raise ParameterError(
                f"a deformed algebra needs a series in {', '.join(self.parameters)} that ends; got one that does not "
                f"within order {self.order}. Take another cocycle of the class, or a larger order."
            )
        read = self._read(values)
        self._check(read)
        algebra = _extension_of(self.given)
        title = f"{algebra.name} deformed"
        if not self.ends and self.closed_form is not None:
            closed = self.closed_form.products(read)
            return Extension.from_products(algebra.dimension, closed, title, algebra.field_names, check=False)
        rows = {pair: dict(row) for pair, row in algebra.products.items()}
        for monomial, term in self.terms.items():
            factor: Exact = Fraction(1)
            for name, power in zip(self.parameters, monomial, strict=True):
                for _ in range(power):
                    factor = product_of(factor, read[name])
            for pair, row in term.items():
                here = rows.setdefault(pair, {})
                for k, value in row.items():
                    here[k] = sum_of(here.get(k, Fraction(0)), product_of(factor, value))
        return Extension.from_products(algebra.dimension, rows, title, algebra.field_names, check=False)

    def bracket(self, values: Values | None = None) -> Bracket:
        """The bracket of g and the deformed algebra; arguments and errors as for `extension`.

        Raises:
            ParameterError: an extension was given, and no bracket.
        """
        if not isinstance(self.given, Bracket):
            raise ParameterError(
                f"a deformed bracket needs a Lie algebra; got the extension {self.given.name} alone. Ask for the "
                "cocycles of a bracket, or write so(3) @ deformation.extension()."
            )
        made = Bracket(self.given.algebra, self.extension(values), self.given.field_names)
        return made.with_angles(self.given.angles)

    def _read(self, values: Values | None) -> dict[str, Exact]:
        kept: dict[str, Exact] = {name: read_parameter(name, name) for name in self.parameters}
        if values is None:
            return kept
        if is_named(values):
            given = named(values, "values") or {}
            for name in given:
                if name not in kept:
                    raise ParameterError(
                        f"values: wanted the parameters {', '.join(kept)}; got {name!r:.60}. Correct the name."
                    )
            return kept | {str(name): read_parameter(value, str(name)) for name, value in given.items()}
        items = listed(values, "values", list(self.parameters))
        if items is None:
            items = [values]
        if len(items) != len(self.parameters):
            raise ShapeError(
                f"values must be {len(self.parameters)}, one for each of {', '.join(self.parameters)}; got "
                f"{len(items)}. Give some of them by name."
            )
        return {name: read_parameter(value, name) for name, value in zip(self.parameters, items, strict=True)}

    def _check(self, values: Mapping[str, Exact]) -> None:
        for condition in self.conditions:
            value = substituted(condition, values)
            if not is_zero(value):
                raise BracketError(
                    f"a deformation needs values at which its conditions vanish; {condition} is {value}. Solve the "
                    "conditions, or set parameters to zero."
                )

    def __str__(self) -> str:
        names = ", ".join(self.parameters) or "no parameter"
        end = "ends" if self.ends else "is told up to" if self.closed_form else "was computed to"
        where = f", associative where {', '.join(map(str, self.conditions))} = 0" if self.conditions else ""
        return f"deformation of {self.given!r} in {names}, which {end} at order {self.order}{where}"

    def __repr__(self) -> str:
        return f"<{str(self)[0].upper()}{str(self)[1:]}>"


def _extension_of(given: Bracket | Extension) -> Extension:
    return given if isinstance(given, Extension) else given.extension


def taken_names(given: Bracket | Extension) -> set[str]:
    """Names that a parameter may not have: those of symbols and coordinates."""
    return given.symbols | ({*given.coordinate_names, *given.field_names} if isinstance(given, Bracket) else set())


def symbols_in(products: Products) -> set[str]:
    """The names of the symbols in products."""
    return {name for row in products.values() for value in row.values() for name in symbols_of(value)}


def in_words(products: Products) -> str:
    """Products as text, "e1*e1 = e2, e1*e2 = -2*e0"."""
    shown: list[str] = []
    for (i, j), row in sorted(products.items()):
        terms = [_term(value, k) for k, value in sorted(row.items())]
        shown.append(f"e{i}*e{j} = " + " + ".join(terms).replace("+ -", "- "))
    return ", ".join(shown) or "0"


def element_in_words(element: Mapping[int, Exact]) -> str:
    """An element of the algebra as text, "e2 - 2*e0"."""
    return " + ".join(_term(value, k) for k, value in sorted(element.items())).replace("+ -", "- ") or "0"


def _term(value: Exact, k: int) -> str:
    if value in (1, -1):
        return f"e{k}" if value == 1 else f"-e{k}"
    return f"({value})*e{k}" if not isinstance(value, Fraction) and value.is_Add else f"{value}*e{k}"
