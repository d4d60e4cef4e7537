r"""Compatible brackets, their pencils, and the functions in involution that a pencil gives.

Two Poisson brackets are compatible if $\{\,,\}_1 + t\{\,,\}_2$ is one for all t.  A Casimir of the pencil,
$C_t = f_0 + t f_1 + \dots$, is a Lenard chain: $J_1\nabla f_0 = 0$, $J_1\nabla f_k = -J_2\nabla f_{k-1}$, and the
functions of all chains commute with each other in both brackets.  With the bracket frozen at a, $J_2 = J(a)$, these are
the shifted Casimirs $C(x + ta)$ of Mishchenko and Fomenko.

There are at most (N + corank)/2 independent functions in involution.  A family with so many is complete: it makes each
of its functions an integrable Hamiltonian.

References: [mishchenko1978b]; Magri (1978); Bolsinov (1991).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import Any, cast

from sympy import Expr, Poly, Symbol

from liepoisson.algebra.exact_numbers import symbols_of, to_sympy
from liepoisson.algebra.linear_algebra import rank_mod
from liepoisson.algebra.sparse_polynomials import (
    Polynomial,
    add_multiple,
    along,
    derivative,
    gradient_at,
    multiply,
)
from liepoisson.errors import CompatibilityError, ParameterError
from liepoisson.formula.parameters import Parameter, read_new_symbol, read_parameter
from liepoisson.formula.scalars import as_deadline
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import SEARCH_LIMIT, checkpoint
from liepoisson.inputs.given import listed
from liepoisson.inputs.names import free_name
from liepoisson.inputs.refusals import check_kind
from liepoisson.integrability.derivation import derivation_of_rates
from liepoisson.integrability.search import modular, random_point, residues_of
from liepoisson.report.printing import Formula
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.extension import Extension
from liepoisson.structure.lie_algebra import LieAlgebra


@dataclass(frozen=True, eq=False, repr=False)
class Involution:
    r"""Functions that commute with each other in two compatible brackets.

    Example:
        >>> shifted = lp.integrability.argument_shift(lp.so(3) @ lp.trivial(), [1, 2, 3])
        >>> [str(f) for f in shifted.functions.values()], shifted.is_complete
        (['l1**2 + l2**2 + l3**2', '2*l1 + 4*l2 + 6*l3'], True)

    Attributes:
        bracket: The first bracket.
        other: The second one.
        chains: The Lenard chains: the coefficients of 1, t, t^2, ... of each Casimir of the pencil.
        n_independent: How many of the functions are independent, at a random point modulo a prime; proved.
        n_complete: How many there are at most, (N + corank)/2.
    """

    bracket: Bracket
    other: Bracket
    chains: tuple[tuple[Expr, ...], ...]
    n_independent: int
    n_complete: int

    @property
    def functions(self) -> dict[str, Expr]:
        """The functions by name: F1_0, F1_1, ... of the first chain, without constants."""
        variables = {*self.bracket.variables}
        return {
            f"F{k}_{power}": f
            for k, chain in enumerate(self.chains, start=1)
            for power, f in enumerate(chain)
            if f.free_symbols & variables
        }

    @property
    def is_complete(self) -> bool:
        """Whether it is proved that there are no more independent functions that commute with all of these."""
        return self.n_independent == self.n_complete

    def __repr__(self) -> str:
        state = "complete" if self.is_complete else f"{self.n_complete} would be complete"
        return f"<Involution on {self.bracket!r}: {self.n_independent} independent functions, {state}>"

    def __str__(self) -> str:
        """The functions, and what is proved."""
        lines = [f"{name} = {Formula(f).plain}" for name, f in self.functions.items()]
        lines.append(f"in involution, in both brackets: proved; {self.n_independent} independent functions")
        lines.append("complete" if self.is_complete else f"not complete: there may be {self.n_complete}")
        return "\n".join(lines)


@explains_its_arguments
def pencil(first: Bracket, second: Bracket, parameter: str = "t") -> Bracket:
    r"""The pencil of two compatible brackets, $\{\,,\}_1 + t\,\{\,,\}_2$.

    Example:
        >>> bracket = lp.so(3) @ lp.trivial()
        >>> lp.integrability.pencil(bracket, bracket.frozen([0, 0, 1])).casimirs()
        [l1**2 + l2**2 + l3**2 + 2*l3*t]

    Args:
        first: A bracket.
        second: A bracket of the same coordinates, with the same extension, or with the same Lie algebra.
        parameter: The name of t.

    Raises:
        CompatibilityError: they are not compatible; it names three coordinates at which the Jacobi identity fails.
        ParameterError: they have other coordinates, or both the algebras and the extensions differ.
    """
    check_kind(first, Bracket, "first", "a Bracket", "so(3) @ trivial()")
    check_kind(second, Bracket, "second", "a Bracket", "bracket.frozen([0, 0, 1])")
    taken = first.symbols | second.symbols | first.coordinate_names | {*first.field_names}
    if first.coordinate_names_in_order != second.coordinate_names_in_order:
        names = [", ".join(b.coordinate_names_in_order) for b in (first, second)]
        raise ParameterError(
            f"second: wanted a bracket of the coordinates {names[0]:.80}; got {names[1]:.80}. Rename its fields"
        )
    t = Symbol(read_new_symbol(parameter, "parameter", taken))
    algebra, extension = first.algebra, first.extension
    if extension.products == second.extension.products or not second.algebra.brackets:
        sums = _sum(first.algebra.brackets, second.algebra.brackets, t)
        algebra = LieAlgebra.from_brackets(
            algebra.dimension, sums, f"{algebra.name} + {t} {second.algebra.name}", algebra.basis_names, check=False
        )
    elif algebra.brackets == second.algebra.brackets:
        sums = _sum(extension.products, second.extension.products, t)
        extension = Extension.from_products(
            extension.dimension,
            sums,
            f"{extension.name} + {t} {second.extension.name}",
            extension.field_names,
            check=False,
        )
    else:
        raise ParameterError(
            "second: wanted a bracket with the same Lie algebra or the same extension as the first; got "
            f"{second!r} beside {first!r}"
        )
    constant = {
        pair: to_sympy(first.constant.get(pair, Fraction(0))) + t * to_sympy(second.constant.get(pair, Fraction(0)))
        for pair in first.constant.keys() | second.constant.keys()
    }
    found = Bracket(algebra, extension, constant=cast("Any", constant), check=False)
    jacobi = found.jacobi_certificate()
    if not jacobi.holds:
        failure = jacobi.failures[0]
        raise CompatibilityError(failure.coordinates, str(Formula(failure.residual).plain))
    return found.with_angles([name for name in found.coordinate_names_in_order if name in first.angles + second.angles])


def _sum(first: Mapping[Any, Mapping[int, Any]], second: Mapping[Any, Mapping[int, Any]], t: Any) -> dict[Any, Any]:
    zero = Fraction(0)
    return {
        pair: {
            k: to_sympy(first.get(pair, {}).get(k, zero)) + t * to_sympy(second.get(pair, {}).get(k, zero))
            for k in first.get(pair, {}).keys() | second.get(pair, {}).keys()
        }
        for pair in first.keys() | second.keys()
    }


@explains_its_arguments
def lenard_chains(first: Bracket, second: Bracket, *, time_limit: float = SEARCH_LIMIT) -> Involution:
    r"""The functions in involution that the Casimirs of a pencil of brackets give, by powers of its parameter.

    Example:
        >>> so3 = lp.so(3)
        >>> B = lp.LieAlgebra.from_brackets(3, {(0, 1): {2: 3}, (1, 2): {0: 1}, (0, 2): {1: -2}})
        >>> found = lp.integrability.lenard_chains(so3 @ lp.trivial(), B @ lp.trivial())
        >>> [str(f) for f in found.functions.values()]
        ['l1**2 + l2**2 + l3**2', 'l1**2 + 2*l2**2 + 3*l3**2']

    Args:
        first: A bracket.
        second: A compatible bracket of the same coordinates.
        time_limit: Seconds.

    Raises:
        CompatibilityError: the brackets are not compatible.
        ParameterError: as for `pencil`.
        TimeLimitError: the time was over.
    """
    with as_deadline(time_limit).running():
        check_kind(first, Bracket, "first", "a Bracket", "so(3) @ trivial()")
        check_kind(second, Bracket, "second", "a Bracket", "bracket.frozen([0, 0, 1])")
        name = free_name("t", first.symbols | second.symbols | first.coordinate_names)
        casimirs = pencil(first, second, name).casimirs()
        return _involution(first, second, casimirs, Symbol(name))


@explains_its_arguments
def argument_shift(bracket: Bracket, point: Sequence[Parameter], *, time_limit: float = SEARCH_LIMIT) -> Involution:
    r"""The shifted Casimirs of a bracket: the coefficients of the powers of t in $C(x + ta)$, in involution.

    Example:
        >>> top = lp.so(3) @ lp.semidirect(2)
        >>> shifted = lp.integrability.argument_shift(top, [0, 0, 1, 0, 0, 2])
        >>> len(shifted.functions), shifted.is_complete
        (4, True)

    Args:
        bracket: A bracket.
        point: a, N exact numbers.
        time_limit: Seconds.

    Raises:
        ShapeError: not N numbers.
        ParameterError: a component is not exact, or the bracket has no Casimirs.
        TimeLimitError: the time was over.

    References: [mishchenko1978b].
    """
    check_kind(bracket, Bracket, "bracket", "a Bracket", "so(4) @ trivial()")
    linear = Bracket(bracket.algebra, bracket.extension, bracket.field_names)
    items = listed(point, "point", bracket.coordinate_names_in_order)  # read once: it may be a generator
    frozen = linear.frozen(point if items is None else items)
    components = [read_parameter(item, "point") for item in items or ()]
    with as_deadline(time_limit).running():
        taken = bracket.symbols | bracket.coordinate_names | {name for a in components for name in symbols_of(a)}
        t = Symbol(free_name("t", taken))
        shift = dict(zip(bracket.variables, components, strict=True))
        moved: Any = {x: x + t * to_sympy(a) for x, a in shift.items()}
        casimirs = [cast("Any", c).expand(trace=True).subs(moved, simultaneous=True) for c in bracket.casimirs()]
        return _involution(bracket, frozen, casimirs, t)


def _involution(first: Bracket, second: Bracket, casimirs: Sequence[Any], t: Symbol) -> Involution:
    chains: list[tuple[Expr, ...]] = []
    for casimir in casimirs:
        checkpoint("the chains of a pencil")
        top = casimir.expand(trace=True).together().as_numer_denom()[0].expand()
        reduced = cast("Any", Poly(top, *first.variables)).primitive()[1].as_expr()  # no factor that depends on t alone
        chains.append(tuple(reversed(cast("Any", Poly(reduced, t)).all_coeffs())))
    if not chains:
        raise ParameterError(f"bracket: wanted one with Casimirs; got {first!r}, of which none is known")
    variables = first.variables
    functions = [f for chain in chains for f in chain if f.free_symbols & {*variables}]
    n = len(variables)
    entries = [_entries(bracket) for bracket in (first, second)]
    given = [*functions, *(e for matrix in entries for e in matrix.values())]
    derivation, read = derivation_of_rates(variables, [t * 0 for _ in variables], given)
    fields, rest = read[: len(functions)], iter(read[len(functions) :])
    matrices = [{pair: next(rest) for pair in matrix} for matrix in entries]
    for matrix in matrices:
        slopes = [_vector_field(f, matrix, n) for f in fields]
        for i, j in combinations(range(len(fields)), 2):
            assert not along(fields[i], slopes[j]), "functions of a pencil commute"
    residues = residues_of(derivation.field, fields)
    point = random_point(n, residues)
    rank = rank_mod([gradient_at(modular(f, residues), point) for f in fields], n, residues.p)
    return Involution(first, second, tuple(chains), rank, (n + first.corank()) // 2)


def _entries(bracket: Bracket) -> dict[tuple[int, int], Any]:
    """The entries of the Poisson tensor above the diagonal."""
    found: dict[tuple[int, int], Any] = {pair: to_sympy(c) for pair, c in bracket.constant.items()}
    for i, j, m, c in bracket.entries():
        found[i, j] = found.get((i, j), 0) + to_sympy(c) * bracket.variables[m]
    return found


def _vector_field(function: Polynomial, matrix: Mapping[tuple[int, int], Polynomial], n: int) -> list[Polynomial]:
    rates: list[Polynomial] = [{} for _ in range(n)]
    for (i, j), entry in matrix.items():
        checkpoint("brackets of the functions of a pencil")
        add_multiple(rates[i], multiply(entry, derivative(function, j)), 1)
        add_multiple(rates[j], multiply(entry, derivative(function, i)), -1)
    return rates
