r"""Extensions: commutative associative algebras A, $e_\mu e_\nu = W_\lambda{}^{\mu\nu} e_\lambda$.

A Lie-Poisson extension of a Lie algebra g is g (x) A.  The named ones are in `extensions`, the classification of the
small ones in `classification`.  References: Thiffeault and Morrison, Physica D 136 (2000) 205.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from fractions import Fraction
from functools import cached_property
from itertools import pairwise, product
from numbers import Integral
from typing import TYPE_CHECKING, Any, NoReturn, TypeAlias, cast

from liepoisson.algebra.exact_numbers import Coefficient, Exact, is_zero, substituted, symbols_of, to_sympy
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter, read_coefficient, values_of_symbols
from liepoisson.formula.tensors import Rows, Tensor3, in_sympy, of_one_kind, read_names, read_tensor
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import is_named
from liepoisson.inputs.names import check_title
from liepoisson.inputs.refusals import check_kind, not_a

if TYPE_CHECKING:
    from liepoisson.structure.classification import Classification
    from liepoisson.structure.commutative_algebra import CommutativeAlgebra, Vector

Products: TypeAlias = dict[tuple[int, int], dict[int, Exact]]
"""`products[mu, nu][lam]` with mu <= nu: the nonzero coefficients of e_mu e_nu along e_lam."""

Element: TypeAlias = tuple[Exact, ...]
"""An element of A, by its coordinates in the basis e_0, e_1, ..."""

MAX_FIELDS = 100
"""The largest dimension: J has (n dim g)^2 entries; the largest system of the literature known to us has six fields."""

_FIELD_NAMES = {1: ("l",), 2: ("l", "alpha"), 3: ("l", "alpha", "beta")}


@explains_its_methods
class Extension:
    r"""A commutative associative algebra A by its tensor, $e_\mu e_\nu = \sum_\lambda W_\lambda{}^{\mu\nu} e_\lambda$.

    Example:
        >>> lp.Extension([[[1, 0], [0, 0]], [[0, 1], [1, 0]]]).field_names
        ('l', 'alpha')

    Args:
        tensor: `W[lam][mu][nu]`, exact, shape (n, n, n).
        name: How it is printed.
        field_names: One name per basis element; l, alpha, beta up to n = 3, else x0, x1, ..., with
            as many digits for each as the last one has.
        check: Verify symmetry and associativity (the Jacobi identity of g (x) A needs both).  Switch this off only to
            study what goes wrong.

    Raises:
        ShapeError: `tensor` is not n x n x n, or `field_names` has another length.
        BracketError: not commutative or not associative; the message names the entry.
        ParameterError: n is more than 100, or an entry is not exact.
    """

    def __init__(
        self,
        tensor: Sequence[Sequence[Sequence[Parameter]]],
        name: str = "A",
        field_names: Sequence[str] | None = None,
        *,
        check: bool = True,
    ) -> None:
        W = read_tensor(tensor, "W")
        if check:
            _check_commutative(W)
        rows = _products_of(W) if check else _products_of(W) | _products_against_symmetry(W)
        self._set(len(W), rows, name, field_names, check=check)

    @classmethod
    def from_products(
        cls,
        n: int,
        products: Mapping[tuple[int, int], Mapping[int, Parameter]],
        name: str = "A",
        field_names: Sequence[str] | None = None,
        *,
        check: bool = True,
    ) -> Extension:
        r"""The extension with the given products, $e_\mu e_\nu = \sum_\lambda$ `products[mu, nu][lam]` e_lam.

        Args:
            n: Number of basis elements.
            products: By pairs (mu, nu); a pair and its reverse need not both be given, but must then agree.
            name: How it is printed.
            field_names: One name per basis element.
            check: Verify associativity.

        Raises:
            ShapeError: `products` is not a mapping from pairs to mappings, or an index is not in 0..n-1.
            BracketError: not commutative or not associative.
            ParameterError: n is not an integer from 1 to 100, or an entry is not exact.
        """
        extension = cls.__new__(cls)
        n = read_field_count(n)
        extension._set(n, read_products(n, products), name, field_names, check=check)
        return extension

    def _set(self, n: int, rows: Rows, name: str, field_names: Sequence[str] | None, *, check: bool) -> None:
        self.dimension = read_field_count(n)
        self.rows = rows
        self.name: str = check_title(name, "the name of an extension", None)
        self.field_names: tuple[str, ...] = self._read_field_names(field_names)
        if check:
            _check_associative(n, rows)

    def _read_field_names(self, given: Sequence[str] | None) -> tuple[str, ...]:
        n = self.dimension
        names = read_names(given, "field_names", _FIELD_NAMES.get(n) or _numbered(n))
        if len(names) != n:
            raise ShapeError(f"field_names must be {n} names; got {len(names)}. Give one per basis element.")
        return names

    dimension: int
    """Number n of basis elements, which is the number of fields."""

    rows: Rows
    """The nonzero products as they are kept, before SymPy is asked for them."""

    @cached_property
    def products(self) -> Products:
        """The nonzero products, sparse: `products[mu, nu][lam]` = W[lam][mu][nu] for mu <= nu."""
        return in_sympy(self.rows)

    @cached_property
    def tensor(self) -> Tensor3:
        """The tensor `W[lam][mu][nu]`, dense, shape (n, n, n)."""
        n, zero = range(self.dimension), self._zero
        return tuple(
            tuple(tuple(self.products.get((m, v), self.products.get((v, m), {})).get(k, zero) for v in n) for m in n)
            for k in n
        )

    @property
    def _zero(self) -> Exact:
        values = (value for row in self.products.values() for value in row.values())
        zero = Fraction(0)
        return zero if isinstance(next(values, zero), Fraction) else to_sympy(zero)

    @property
    def symbols(self) -> set[str]:
        """Names of the free symbols in the tensor."""
        return {name for row in self.rows.values() for value in row.values() for name in symbols_of(value)}

    def substitute(self, values: Mapping[str, Coefficient]) -> Extension:
        """The same extension with values for some of its symbols.

        Raises:
            ParameterError: not a mapping from names, or symbols, to exact values, or a name is none of them.
        """
        values = values_of_symbols(values, self.symbols)
        if not values:
            return self
        shown = ", ".join(f"{name} = {values[name]}" for name in sorted(values))
        named = f"{self.name} at {shown}"
        products: Any = {
            pair: {k: substituted(value, values) for k, value in row.items()} for pair, row in self.rows.items()
        }
        return Extension.from_products(self.dimension, products, named, self.field_names, check=False)

    def rename(self, *field_names: str) -> Extension:
        """The same extension with other names for its fields.

        Raises:
            ShapeError: not n names.
        """
        extension = copy(self)
        extension.field_names = self._read_field_names(field_names)
        return extension

    def __matmul__(self, other: Any) -> NoReturn:
        """Refused: a bracket has its Lie algebra first, `so(3) @ trivial()`."""
        raise not_a("a Lie algebra before it", other, "@", "write algebra @ extension, as in so(3) @ trivial()")

    def __add__(self, other: Extension) -> Extension:
        """The direct sum A (+) B: products between the two vanish, and g (x) (A + B) = g (x) A + g (x) B.

        The fields keep their names when these are distinct.
        """
        check_kind(other, Extension, "+", "an extension to add", "write for example trivial() + trivial()")
        n = self.dimension
        shifted = {(i + n, j + n): {k + n: value for k, value in row.items()} for (i, j), row in other.rows.items()}
        products: Any = self.rows | shifted
        names = (*self.field_names, *other.field_names)
        name = f"({_inner_name(self)} + {_inner_name(other)})"
        distinct = names if len(set(names)) == len(names) else None
        return Extension.from_products(n + other.dimension, products, name, distinct, check=False)

    def unit(self) -> Element | None:
        """The unit element of A, or None if A has none."""
        return None if self._algebra.unit is None else self._write([self._algebra.unit])[0]

    def nilradical(self) -> tuple[Element, ...]:
        """A basis of the nilpotent elements of A."""
        return self._write(self._algebra.nilradical)

    def annihilator(self) -> tuple[Element, ...]:
        """A basis of the elements whose product with every element of A is zero; empty if A has a unit."""
        return self._write(self._algebra.annihilator)

    def socle(self) -> tuple[Element, ...]:
        """A basis of the elements whose product with every nilpotent element is zero.

        Of a local algebra this is the socle: the sum of its minimal ideals.
        """
        return self._write(self._algebra.annihilator_of(self._algebra.nilradical or [(self._zero,) * self.dimension]))

    def hilbert_function(self) -> tuple[int, ...]:
        r"""$\dim m^i / m^{i+1}$ for $i = 0, 1, \dots$ and the nilradical m, with $m^0 = A$."""
        sizes = [self.dimension, *map(len, self._algebra.powers_of(self._algebra.nilradical)), 0]
        return tuple(a - b for a, b in pairwise(sizes))

    @property
    def is_unital(self) -> bool:
        """Whether A has a unit element."""
        return self._algebra.unit is not None

    @property
    def is_local(self) -> bool:
        """Whether A is a local algebra over the real numbers: unital with one maximal ideal, the nilpotent elements."""
        return self.residue_field is not None

    @property
    def residue_field(self) -> str | None:
        """`"R"` or `"C"`, the quotient of a local A by its maximal ideal; None if A is not local over the reals.

        Raises:
            ParameterError: it depends on the sign of an expression in the symbols.
        """
        algebra = self._algebra
        size = self.dimension - len(algebra.nilradical)
        if algebra.unit is None or size > 2:
            return None
        if size == 1:
            return "R"
        (component, *others) = algebra.components
        return "C" if not others and algebra.field.sign(component.discriminant) < 0 else None

    def maximal_ideals(self) -> tuple[tuple[Element, ...], ...]:
        """Bases of the maximal ideals of a unital A over the field of its entries, one for each primary component.

        Over the reals a component whose residue field is larger than the field of the entries may split further:
        `classify` shows how.
        """
        if self._algebra.unit is None:
            return ()
        components = self._algebra.components
        spans = [
            [v for other in components for v in (other.basis if other is not c else (other.powers or [[]])[0])]
            for c in components
        ]
        return tuple(self._write(self._algebra.echelon(span)) for span in spans)

    def classify(self) -> Classification:
        """The normal form of A; see `liepoisson.structure.classification.classify`."""
        from liepoisson.structure.classification import classify

        return classify(self)

    @cached_property
    def _algebra(self) -> CommutativeAlgebra:
        from liepoisson.structure.commutative_algebra import CommutativeAlgebra

        _check_associative(self.dimension, self.rows)  # an unchecked extension has no unit, ideals, ...
        return CommutativeAlgebra(self.dimension, self.products)

    def _write(self, vectors: Sequence[Vector]) -> tuple[Element, ...]:
        return tuple(tuple(self._algebra.field.write(value) for value in vector) for vector in vectors)

    def __repr__(self) -> str:
        return self.name


def _inner_name(extension: Extension) -> str:
    name = extension.name
    return name[1:-1] if name.startswith("(") and name.endswith(")") and " + " in name else name


def _products_of(W: Sequence[Sequence[Sequence[Coefficient]]]) -> Rows:
    n = len(W)
    rows = {
        (mu, nu): {lam: W[lam][mu][nu] for lam in range(n) if not is_zero(W[lam][mu][nu])}
        for mu in range(n)
        for nu in range(mu, n)
    }
    return {pair: row for pair, row in rows.items() if row}


def _products_against_symmetry(W: Sequence[Sequence[Sequence[Coefficient]]]) -> Rows:
    """The products e_mu e_nu, mu > nu, that are not those of e_nu e_mu: of tensors that are not checked."""
    n = range(len(W))
    return {
        (mu, nu): {lam: W[lam][mu][nu] for lam in n if not is_zero(W[lam][mu][nu])}
        for mu in n
        for nu in range(mu)
        if not all(is_zero(W[lam][mu][nu] - W[lam][nu][mu]) for lam in n)
    }


def _numbered(n: int) -> tuple[str, ...]:
    """Names x0, x1, ... of one length: else x1 would have a component x11, and that would be a field, too."""
    width = len(str(n - 1))
    return tuple(f"x{i:0{width}}" for i in range(n))


def read_field_count(n: object) -> int:
    """Read the number of fields.

    Raises:
        ParameterError: not an integer from 1 to 100.
    """
    if isinstance(n, bool) or not isinstance(n, Integral) or int(n) < 1:
        raise ParameterError(f"an extension needs n >= 1 fields; got n = {n!r}. Use n = 3 for the twisted top.")
    if int(n) > MAX_FIELDS:
        raise ParameterError(f"an extension has at most {MAX_FIELDS} fields here; got n = {n}. Use fewer.")
    return int(n)


def read_products(n: int, products: object) -> Rows:
    """Read products that a caller gives, `products[mu, nu][lam]`; zeros are dropped.

    Raises:
        ShapeError: not a mapping from pairs to mappings, or an index is not in 0..n-1.
        BracketError: a pair and its reverse have different products.
        ParameterError: an entry is not exact.
    """
    if not is_named(products):
        raise ShapeError(
            f"products must be a mapping; got {type(products).__name__}. Write for example {{(0, 0): {{0: 1}}}}."
        )
    read: Rows = {}
    for given, given_row in cast("Mapping[object, object]", products).items():
        (mu, nu), row = _read_pair(given, n), _read_row(given, given_row, n)
        values = {k: read_coefficient(value, f"products[{mu}, {nu}][{k}]") for k, value in row.items()}
        values = {k: value for k, value in values.items() if not is_zero(value)}
        pair = (min(mu, nu), max(mu, nu))
        known = read.setdefault(pair, values)
        if known != values and in_sympy({pair: known}) != in_sympy({pair: values}):
            raise BracketError(
                f"products must be commutative; got e_{mu} e_{nu} = {values} and for the reverse {known} "
                "(coefficient by index). Correct one of the two."
            )
    return of_one_kind({pair: row for pair, row in read.items() if row})


def _read_pair(pair: object, n: int) -> tuple[int, int]:
    if not isinstance(pair, tuple) or len(cast("tuple[object, ...]", pair)) != 2:
        raise ShapeError(f"products must be given by pairs (mu, nu); got {pair!r}. Write for example (0, 0).")
    mu, nu = (_read_index(index, n, "products") for index in cast("tuple[object, ...]", pair))
    return mu, nu


def _read_row(pair: object, row: object, n: int) -> dict[int, Parameter]:
    if not is_named(row):
        raise ShapeError(f"products[{pair}] must be a mapping lam: c; got {row!r}. Write for example {{0: 1}}.")
    given = cast("Mapping[object, Parameter]", row)
    return {_read_index(lam, n, f"products[{pair}]"): value for lam, value in given.items()}


def _read_index(index: object, n: int, name: str) -> int:
    if isinstance(index, bool) or not isinstance(index, Integral) or not 0 <= int(index) < n:
        raise ShapeError(f"the indices of {name} must be in 0..{n - 1}; got {index!r}. Count from 0.")
    return int(index)


def _check_commutative(W: Sequence[Sequence[Sequence[Coefficient]]]) -> None:
    for lam, mu, nu in product(range(len(W)), repeat=3):
        if not is_zero(W[lam][mu][nu] - W[lam][nu][mu]):
            raise BracketError(
                f"W must be symmetric, W[lam][mu][nu] = W[lam][nu][mu]; got W[{lam}][{mu}][{nu}] = {W[lam][mu][nu]} "
                f"and W[{lam}][{nu}][{mu}] = {W[lam][nu][mu]}. Correct one of the two."
            )


def _check_associative(n: int, rows: Rows) -> None:
    for mu, nu, rho in product(range(n), repeat=3):
        if mu >= rho:  # the associator of (mu, nu, rho) is minus that of (rho, nu, mu)
            continue
        checkpoint("a check of associativity")
        residual: dict[int, Any] = {}
        _add_product(residual, rows, (mu, nu), rho, 1)
        _add_product(residual, rows, (nu, rho), mu, -1)
        for lam, value in residual.items():
            if not is_zero(value):
                raise BracketError(
                    f"W must be associative; (e_{mu} e_{nu}) e_{rho} and e_{mu} (e_{nu} e_{rho}) differ by {value} "
                    f"along e_{lam}, wanted 0. Check W[{lam}][.][{rho}] and W[.][{mu}][{nu}]."
                )


def _add_product(total: dict[int, Any], rows: Any, pair: tuple[int, int], other: int, sign: int) -> None:
    """Add +-(e_mu e_nu) e_other to the total."""
    for k, first in rows.get((min(pair), max(pair)), {}).items():
        for lam, second in rows.get((min(k, other), max(k, other)), {}).items():
            term = first * second if sign > 0 else -(first * second)
            total[lam] = total[lam] + term if lam in total else term
