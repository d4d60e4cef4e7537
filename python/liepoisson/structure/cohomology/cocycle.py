r"""A symmetric 2-cocycle of a commutative algebra: the twist $W + t f$ to first order, and what becomes of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact, ExactMatrix, is_zero, product_of, sum_of, to_sympy
from liepoisson.errors import CocycleError, ObstructionError, ParameterError
from liepoisson.formula.parameters import Parameter, read_new_symbol, read_parameter, read_symbol
from liepoisson.formula.tensors import Tensor3
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.names import free_name
from liepoisson.inputs.refusals import check_kind
from liepoisson.structure.automorphisms import Automorphism
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.cohomology.change_of_basis import identity, inverse, multiplied
from liepoisson.structure.cohomology.commutative_complex import Cochain, CommutativeComplex, Map, Trilinear, combined
from liepoisson.structure.cohomology.deformed_algebra import (
    Deformation,
    element_in_words,
    in_words,
    symbols_in,
    taken_names,
)
from liepoisson.structure.cohomology.mending import Mended, mended_along
from liepoisson.structure.derivations import arrows
from liepoisson.structure.extension import Extension, Products

if TYPE_CHECKING:
    from liepoisson.structure.cohomology.twist_orbits import TwistForm
    from liepoisson.structure.cohomology.twists import Twists


@explains_its_methods
@dataclass(frozen=True, eq=False)
class Obstruction:
    r"""Why a cocycle begins no deformation: the class of its square in the cohomology of degree three.

    Example:
        >>> lp.cocycles(lp.Extension.from_products(2, {})).cocycle({(0, 0): {1: 1}, (0, 1): {0: 1}}).obstruction().text
        'order 2: the residual for (e_0, e_0, e_1) is -e1'

    Attributes:
        order: The power of the parameter at which associativity fails.
        triple: Three basis elements at which it does.
        residual: What is left of $(a b) c - a (b c)$ for them, modulo all further terms: an element, by coordinates.
        is_proved: Whether no choice of the lower terms helps; beyond order three that is not always decided.
    """

    order: int
    triple: tuple[int, int, int]
    residual: Mapping[int, Exact]
    is_proved: bool

    @property
    def text(self) -> str:
        """The obstruction in words."""
        place = ", ".join(f"e_{k}" for k in self.triple)
        return f"order {self.order}: the residual for ({place}) is {element_in_words(self.residual)}"

    def error(self) -> ObstructionError:
        """The error of a deformation that fails by it."""
        triple = tuple(f"e_{k}" for k in self.triple)
        return ObstructionError(self.order, triple, element_in_words(self.residual), is_proved=self.is_proved)


@explains_its_methods
@dataclass(frozen=True, eq=False)
class ChangeOfVariables:
    r"""The change of fields that undoes a coboundary: $1 + \sum_k t^k \psi_k$, or the inverse of such a map.

    Example:
        >>> twists = lp.cocycles(lp.so(3) @ lp.leibniz(3))
        >>> change = twists.cocycle({(1, 1): {2: 1}}).change_of_variables()
        >>> change.text, change.is_exact
        ('beta -> (epsilon + 1)*beta', True)

    Attributes:
        matrices: $\psi_1, \psi_2, \dots$; field mu goes to the sum of `matrices[k][mu][nu]` times field nu.
        is_inverse: Whether it is the inverse of the map with these.
        is_exact: Whether the deformed bracket goes to the bracket for every t, where the map is defined; else only up
            to the next power of t.
        parameter: The name of t.
        text: The change to first order.
    """

    matrices: tuple[ExactMatrix, ...]
    is_inverse: bool
    is_exact: bool
    parameter: str
    text: str

    def map(self, value: Parameter | None = None) -> Automorphism:
        """The linear map of fields; it takes the deformed bracket to the bracket.

        Args:
            value: Of t, which stays symbolic if left out.
        """
        t = read_parameter(self.parameter if value is None else value, self.parameter)
        rows = identity(len(self.matrices[0]))
        factor: Exact = Fraction(1)
        for matrix in self.matrices:
            factor = product_of(factor, t)
            rows = [
                [sum_of(old, product_of(factor, new)) for old, new in zip(row, more, strict=True)]
                for row, more in zip(rows, matrix, strict=True)
            ]
        return Automorphism(cast("Any", inverse(rows) if self.is_inverse else rows))


@explains_its_methods
@dataclass(frozen=True, eq=False)
class Cocycle:
    r"""A symmetric cochain f with $a f(b, c) - f(ab, c) + f(a, bc) - f(a, b) c = 0$.

    Combinations are written `2*f - g`, `f/2`, `sum(twists.basis)`.  Cocycles are equal if they have the same values.

    Example:
        >>> f, *_ = lp.cocycles(lp.so(3) @ lp.semidirect(3)).basis
        >>> f.products, f.is_coboundary, f.bracket("epsilon").extension.classify().name
        ({(1, 1): {2: Fraction(1, 1)}}, False, 'R[x]/(x^3)')

    Attributes:
        twists: The cocycles that it is one of.
        products: $f(e_\mu, e_\nu) = \sum_\lambda$ `products[mu, nu][lam]` e_lam, the nonzero ones for mu <= nu.
    """

    twists: Twists
    products: Products

    @property
    def tensor(self) -> Tensor3:
        """`f[lam][mu][nu]`, dense, shape (n, n, n)."""
        n = self.twists.extension.dimension
        zero: Exact = Fraction(0)
        return tuple(
            tuple(tuple(self.products.get((min(m, v), max(m, v)), {}).get(k, zero) for v in range(n)) for m in range(n))
            for k in range(n)
        )

    def __eq__(self, other: object) -> bool:
        """Whether both have the same values, in one algebra."""
        if not isinstance(other, Cocycle):
            return NotImplemented
        return self.products == other.products and self.twists.extension.products == other.twists.extension.products

    def __hash__(self) -> int:
        return hash(tuple((pair, *sorted(row.items())) for pair, row in sorted(self.products.items())))

    def __add__(self, other: Cocycle) -> Cocycle:
        """The sum of two cocycles of one algebra."""
        return self._plus(other, Fraction(1))

    def __radd__(self, other: object) -> Cocycle:
        """The sum with nothing, with which `sum` begins."""
        return self if isinstance(other, int) and other == 0 else self._plus(cast("Any", other), Fraction(1))

    def __sub__(self, other: Cocycle) -> Cocycle:
        """The difference."""
        return self._plus(other, Fraction(-1))

    def __neg__(self) -> Cocycle:
        """The cocycle with the other sign."""
        return self * -1

    def __mul__(self, factor: Parameter) -> Cocycle:
        """A multiple, by a number or a name."""
        c = read_parameter(factor, "a factor of a cocycle")
        scaled = {pair: {k: product_of(c, v) for k, v in row.items()} for pair, row in self.products.items()}
        return Cocycle(self.twists, _without_zeros(scaled))

    __rmul__ = __mul__

    def __truediv__(self, divisor: Parameter) -> Cocycle:
        """A fraction, by a number or a name."""
        d = read_parameter(divisor, "a divisor of a cocycle")
        if is_zero(d):
            raise ParameterError("a divisor of a cocycle must not be 0; got 0. Divide by another number.")
        return self * (1 / d)

    def _plus(self, other: Cocycle, sign: Fraction) -> Cocycle:
        check_kind(other, Cocycle, "+", "a cocycle", "add cocycles of one algebra, as in 2*f - g")
        if other.twists.extension.products != self.twists.extension.products:
            raise ParameterError(
                f"cocycles are added if they are of one algebra; got {self.twists.extension.name} and "
                f"{other.twists.extension.name}. Write both for the same algebra."
            )
        total = {pair: dict(row) for pair, row in self.products.items()}
        for pair, row in other.products.items():
            here = total.setdefault(pair, {})
            for k, value in row.items():
                here[k] = sum_of(here.get(k, Fraction(0)), product_of(sign, value))
        return Cocycle(self.twists, _without_zeros(total))

    @cached_property
    def _read(self) -> tuple[CommutativeComplex, Cochain]:
        """The normalised cochains over a field that contains its values, and its values there."""
        complex_ = self.twists.complex_over(value for row in self.products.values() for value in row.values())
        read = complex_.field.read
        return complex_, {(*pair, k): read(value) for pair, row in self.products.items() for k, value in row.items()}

    @cached_property
    def in_cochains(self) -> tuple[CommutativeComplex, Cochain]:
        """It as one of the normalised cochains, or of all if f(1, .) is not zero."""
        complex_, f = self._read
        return (complex_, complex_.restricted(f)) if complex_.is_normalised(f) else (complex_.plain, f)

    @cached_property
    def _class(self) -> tuple[list[Any], Map]:
        complex_, f = self._read
        one = complex_.field.one
        # f(1, b) = f(1, 1) b for a cocycle: what multiplication by f(1, 1) makes is taken away first.
        multiplication = {} if complex_.is_normalised(f) else complex_.multiplication_by(complex_.at_unit(f))
        rest = combined([(one, f), (-one, complex_.plain.of_map(multiplication))])
        values, g = complex_.coordinates(complex_.restricted(rest))
        return values, combined([(one, g), (one, multiplication)])

    def check(self) -> None:
        """Refuse a cochain that is no cocycle.

        Raises:
            CocycleError: it is none; the error names three basis elements.
        """
        complex_, f = self.in_cochains
        if residual := complex_.of_cochain(f):
            triple, element = first_residual(complex_, residual)
            raise CocycleError(tuple(f"e_{k}" for k in triple), element_in_words(element), of_algebra=True)

    @property
    def coordinates(self) -> tuple[Exact, ...]:
        """The coefficients of its class in the basis."""
        field = self.in_cochains[0].field
        return tuple(field.write(value) for value in self._class[0])

    @property
    def is_coboundary(self) -> bool:
        r"""Whether $f = \delta g$ for a linear map g: a change of variables undoes it, to first order."""
        return not any(self._class[0])

    @property
    def representative(self) -> Cocycle:
        """The cocycle of the same class that is a combination of the basis."""
        return self.twists.combination(self.coordinates)

    def coboundary_map(self) -> ExactMatrix:
        r"""A linear map g such that f is its `representative` plus $\delta g$; row mu is $g(e_\mu)$."""
        return self._written(self._class[1])

    def _written(self, g: Map) -> ExactMatrix:
        complex_ = self.in_cochains[0]
        n, field = range(complex_.dimension), complex_.field
        return tuple(tuple(field.write(g.get((i, k), field.zero)) for k in n) for i in n)

    def obstruction(self, order: int | None = None) -> Obstruction | None:
        """The first obstruction to a deformation that begins with it, or None if there is none.

        Args:
            order: The largest power of the parameter that is looked at where the series does not end before; twice the
                dimension if left out.
        """
        if self.is_coboundary:
            return None
        found = self._mended(self.twists.most(order))
        for (k,), residual in found.residuals.items():
            triple, element = first_residual(self.in_cochains[0], residual)
            return Obstruction(k, triple, element, not found.is_free)
        return None

    def _mended(self, most: int) -> Mended:
        if most not in self._orders:
            self._orders[most] = mended_along(*self.in_cochains, most)
        return self._orders[most]

    @cached_property
    def _orders(self) -> dict[int, Mended]:
        return {}

    def deformation(self, parameter: str | None = None, *, order: int | None = None) -> Deformation:
        r"""The products $W + t f + t^2 f_2 + \dots$ that are associative at every order.

        The higher terms have no part in the span of the cocycles, unless the next order asks for one.

        Args:
            parameter: The name of t; epsilon, if no symbol is called so.
            order: Where to stop if the series does not end; twice the dimension if left out.

        Raises:
            ObstructionError: there are no such products.
        """
        if (obstruction := self.obstruction(order)) is not None:
            raise obstruction.error()
        from liepoisson.structure.cohomology.twists import closed_form

        found, complex_ = self._mended(self.twists.most(order)), self.in_cochains[0]
        terms = {monomial: self.twists.written(complex_, term) for monomial, term in found.terms.items()}
        name = self._parameter(parameter)
        closed = None if found.ends else closed_form(self.twists, [self], [name])
        if closed is not None and not closed.is_associative:  # the straight line of classes is obstructed
            closed = None
        return Deformation(self.twists.given, (name,), terms, (), found.order, found.ends, closed)

    def _parameter(self, parameter: str | None) -> str:
        taken = taken_names(self.twists.given) | symbols_in(self.products)
        if parameter is None:
            return free_name("epsilon", taken)
        return read_new_symbol(parameter, "parameter", taken)

    def _value(self, parameter: Parameter | None) -> tuple[str, Parameter]:
        """The name of the parameter, and its value."""
        if parameter is None or (isinstance(parameter, str) and read_symbol(parameter, "parameter") is not None):
            name = self._parameter(parameter if isinstance(parameter, str) else None)
            return name, name
        return self._parameter(None), parameter

    def extension(self, parameter: Parameter | None = None) -> Extension:
        """The deformed algebra.

        Args:
            parameter: The name or the value of t; the name is epsilon if left out.

        Raises:
            ObstructionError: there is none.
            ParameterError: the series in t was not found to end.
        """
        name, value = self._value(parameter)
        return self.deformation(name).extension([value])

    def bracket(self, parameter: Parameter | None = None) -> Bracket:
        """The bracket of g and the deformed algebra; argument and errors as for `extension`."""
        name, value = self._value(parameter)
        return self.deformation(name).bracket([value])

    def change_of_variables(self) -> ChangeOfVariables:
        """The change of fields that undoes a coboundary: it takes the deformed bracket to the bracket.

        Raises:
            ParameterError: it is no coboundary.
        """
        if not self.is_coboundary:
            raise ParameterError(
                f"a change of variables undoes coboundaries; got a cocycle whose class has the coordinates "
                f"({', '.join(map(str, self.coordinates))}). Subtract its representative."
            )
        matrices, is_inverse, is_exact = self._undone()
        name, sign = self._parameter(None), -1 if is_inverse else 1
        first: list[list[Any]] = [
            [int(i == j) + sign * to_sympy(read_parameter(name, name)) * to_sympy(value) for j, value in enumerate(row)]
            for i, row in enumerate(matrices[0])
        ]
        return ChangeOfVariables(matrices, is_inverse, is_exact, name, arrows(self.twists.extension.field_names, first))

    def _undone(self) -> tuple[tuple[ExactMatrix, ...], bool, bool]:
        """The maps of a change of variables, whether it is the inverse of what they make, and whether it is exact."""
        most, complex_ = self.twists.most(None), self.in_cochains[0]
        found = self._mended(most)
        if not found.ends and (closed := self.deformation().closed_form) is not None:
            (g,), basis = closed.maps, closed.basis
            return (tuple(map(tuple, multiplied(inverse(basis), multiplied(g, basis)))),), True, True
        if found.residuals:  # the line in this class is obstructed, though another curve in it is not
            return (self._written(complex_.reduced(self.in_cochains[1])[1]),), False, False
        terms = {k: term for (k,), term in found.terms.items()}
        maps, is_exact = _undoing(complex_, terms, most)
        if not is_exact and (back := _straightening(complex_, terms, most)):
            return tuple(self._written(g) for g in back), True, found.ends
        return tuple(self._written(g) for g in maps or [{}]), False, is_exact and found.ends

    @property
    def orbit_dimension(self) -> int:
        """The dimension of the orbit of its class under the automorphisms of the algebra.

        That of the tangent space: the classes of $D f(a, b) - f(D a, b) - f(a, D b)$ for all derivations D.
        """
        return self.twists.orbit_dimension(self)

    def normal_form(self) -> TwistForm:
        """The orbit of its class under the automorphisms of the algebra, and the way to the representative of this.

        Raises:
            ParameterError: the orbits are not known for this algebra, or there are symbols.
        """
        from liepoisson.structure.cohomology.twist_orbits import normal_form

        return normal_form(self)

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: the definition."""
        return {"twists": self.twists, "products": self.products}

    def __str__(self) -> str:
        return in_words(self.products)

    def __repr__(self) -> str:
        return f"<Cocycle {self}>"


def first_residual(complex_: CommutativeComplex, residual: Trilinear) -> tuple[tuple[int, int, int], dict[int, Exact]]:
    """The first triple at which something is left over, and what it is."""
    a, b, c, _ = min(residual)
    write = complex_.field.write
    return (a, b, c), {key[3]: write(value, 2) for key, value in residual.items() if key[:3] == (a, b, c)}


def _undoing(complex_: CommutativeComplex, terms: Mapping[int, Cochain], most: int) -> tuple[list[Map], bool]:
    r"""Maps $\psi_k$ such that $1 + \sum t^k \psi_k$ takes products to deformed ones, and whether it does so exactly.

    $\psi(a b) = \psi(a) * \psi(b)$ at order k is $\delta\psi_k = -S_k$, where $S_k$ has the terms of lower order.
    """
    one, maps = complex_.field.one, dict[int, Map]()
    last, degree = 0, max(terms, default=0)
    for k in range(1, 2 * most + 1):
        if k > 2 * last + degree and k > 1:
            return [maps.get(j, {}) for j in range(1, last + 1)], True
        total: list[tuple[Any, Cochain]] = []
        for order, f in [(0, None), *terms.items()]:
            for i in range(k - order + 1):
                j = k - order - i
                if (order == 0 and k in (i, j)) or (i and i not in maps) or (j and j not in maps):
                    continue
                total.append((one, complex_.substituted(f, maps.get(i) if i else None, maps.get(j) if j else None)))
        remainder, g = complex_.reduced(combined(total))
        if remainder:
            break
        if g:
            maps[k] = {key: -value for key, value in g.items()}
            last = k
    return [maps.get(j, {}) for j in range(1, last + 1)], False


def _straightening(complex_: CommutativeComplex, terms: Mapping[int, Cochain], most: int) -> list[Map] | None:
    r"""Maps $\phi_k$ such that $1 + \sum t^k \phi_k$ takes deformed products to products, if these end."""
    one, maps = complex_.field.one, dict[int, Map]()
    last, degree = 0, max(terms, default=0)
    for k in range(1, 2 * most + 2):
        if k > max(2 * last, last + degree):
            return [maps.get(j, {}) for j in range(1, last + 1)]
        total: list[tuple[Any, Cochain]] = []
        for order, f in terms.items():
            if order == k:
                total.append((one, f))
            elif k - order in maps:
                total.append((one, complex_.applied(maps[k - order], f)))
        for i in range(1, k):
            if i in maps and k - i in maps:
                total.append((-one, complex_.substituted(None, maps[i], maps[k - i])))
        remainder, g = complex_.reduced(combined(total))
        if remainder:
            return None
        if g:
            maps[k], last = g, k
    return None


def _without_zeros(products: Mapping[tuple[int, int], Mapping[int, Exact]]) -> Products:
    found = {pair: {k: value for k, value in row.items() if not is_zero(value)} for pair, row in products.items()}
    return {pair: row for pair, row in found.items() if row}
