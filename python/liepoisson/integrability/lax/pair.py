r"""Lax pairs: $\dot L = [L, M]$ along the motion, identically in a spectral parameter z.

The equations of motion are derived from bracket and Hamiltonian. L and M are matrices, or elements L(z), M(z) of the
Lie algebra of the bracket with coefficients that are functions on phase space; the commutator is then that of the
algebra, and the adjoint representation makes matrices of them.

Then the eigenvalues of L are constant, and the coefficients of $\det(w - L(z))$ are integrals [lax1968].  A coefficient
with complex values gives its real and its imaginary part. Every one is verified by the equations of motion, although
the Lax equation implies it. A function is a Casimir if its Hamiltonian vector field vanishes. Others are written as
polynomials in H, the Casimirs and the coefficients before them, where they are such; what remains is independent of
these, or a function of them that is no polynomial.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any

from sympy import Add, Expr, ImmutableMatrix, Matrix, Poly, S, Symbol

from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.catalog import entry, names
from liepoisson.catalog.lax_pairs import LAX_PAIRS, MADE
from liepoisson.catalog.unital_tops import KovalevskayaTop, LagrangeTop, unital_top
from liepoisson.errors import LaxPairError, ParameterError, ShapeError, UnknownNameError, did_you_mean
from liepoisson.formula.parameters import GivenValue, read_values
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.refusals import check_kind, shown
from liepoisson.integrability.algebraic_functions import algebraic_equations
from liepoisson.integrability.completeness import are_in_involution, as_polynomials, fields_rank
from liepoisson.integrability.lax.entries import Element, EntryArithmetic, read_entries, spectral_symbol
from liepoisson.integrability.search import next_name
from liepoisson.integrability.search_problem import known_functions, with_hamiltonian
from liepoisson.model.system import System
from liepoisson.report.printing import Formula
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.trace import traces_in

if TYPE_CHECKING:
    from liepoisson.integrability.lax.spectral_curve import SpectralCurve

_MOST_SHOWN = 400
"""Characters of a residual in a message."""


@explains_its_methods
class LaxPair:
    r"""A Lax pair of a system that has been verified, $\dot L = [L, M] = LM - ML$; `lax_pair` makes one.

    Example:
        >>> pair = lp.integrability.known_lax_pair("lagrange")
        >>> pair.size, pair.L[0, 1], pair.M[0, 1]
        (3, -alpha3 - l3*z - z**2, -2*l3 - z)

    Attributes:
        system: The system.
        spectral: The spectral parameter; None if there is none.
        elements: L and M as elements of the Lie algebra of the bracket, by components, if they were given so.
        source: Where the pair is described; None if nothing was said.
    """

    def __init__(
        self,
        system: System,
        entries: tuple[Any, Any],
        spectral: Symbol | None,
        elements: tuple[tuple[Expr, ...], tuple[Expr, ...]] | None,
        source: str | None,
    ) -> None:
        self.system, self.spectral, self.elements, self.source = system, spectral, elements, source
        self._matrices: tuple[Any, Any] = (ImmutableMatrix(entries[0]), ImmutableMatrix(entries[1]))

    @property
    def L(self) -> Matrix:
        """The matrix whose eigenvalues are constant."""
        return self._matrices[0]

    @property
    def M(self) -> Matrix:
        """Its partner."""
        return self._matrices[1]

    @property
    def size(self) -> int:
        """The number of rows of L."""
        return int(self.L.rows)

    @cached_property
    def arithmetic(self) -> EntryArithmetic:
        """The exact arithmetic of the entries of L."""
        return EntryArithmetic(list(self._matrices[0]))

    @cached_property
    def characteristic(self) -> tuple[Element, ...]:
        r"""The coefficients of $\det(w - L)$, that of $w^n$ first, as elements of `arithmetic`."""
        rows = [[self.arithmetic.read(e) for e in row] for row in self.L.tolist()]
        return tuple(self.arithmetic.characteristic_coefficients(rows))

    @cached_property
    def characteristic_polynomial(self) -> Expr:
        r"""$\det(w - L(z))$ as an expression in w, the spectral parameter and the coordinates."""
        w, n = Symbol("w"), self.size
        terms: list[Any] = [
            (self.arithmetic.write(c) * w ** (n - k)).expand() for k, c in enumerate(self.characteristic)
        ]
        return Add(*terms)

    @cached_property
    def _integrals(self) -> LaxIntegrals:
        return lax_integrals(self)

    def integrals(self) -> LaxIntegrals:
        r"""The coefficients of $\det(w - L(z))$, sorted into Casimirs, functions of H and Casimirs, and others.

        Each is verified to be constant along the motion, in exact arithmetic.
        """
        return self._integrals

    def spectral_curve(self, point: Mapping[str, Any] | Sequence[Any] | None = None, *, seed: int = 0) -> SpectralCurve:
        r"""The curve $\det(w - L(z)) = 0$ at one state, its components and their genus.

        Args:
            point: Rational values of the coordinates, in the order of the state or by name, with those of parameters
                that are symbols; small random ones if left out.
            seed: Draws the state.

        Raises:
            ParameterError: there is no spectral parameter, or a value is missing or not rational.
        """
        from liepoisson.integrability.lax.spectral_curve import spectral_curve

        return spectral_curve(self, point, seed=seed)

    def __repr__(self) -> str:
        where = f"spectral parameter {self.spectral}" if self.spectral is not None else "no spectral parameter"
        return f"<LaxPair of {self.system.name}: {self.size} x {self.size}, {where}: verified>"

    def __str__(self) -> str:
        """L and M, and what was verified."""
        lines = [f"{self.system.name}: dL/dt = [L, M], verified exactly"]
        if self.elements is not None:
            parts = zip("LM", self.elements, strict=True)
            of = self.system.bracket.algebra.name
            return "\n".join([*lines, *(f"{name} in {of}: {_listed(element)}" for name, element in parts)])
        for name, matrix in (("L", self.L), ("M", self.M)):
            lines += [f"{name} =", *(f"  {_listed(row)}" for row in matrix.tolist())]
        return "\n".join(lines)


def _listed(entries: Sequence[Expr]) -> str:
    return f"[{', '.join(Formula(e).plain for e in entries)}]"


@explains_its_arguments
def lax_pair(system: System, L: Any, M: Any, *, spectral: str | None = "z", source: str | None = None) -> LaxPair:
    r"""A Lax pair of a system, verified: $\dot L = [L, M]$ holds along the motion, identically in z.

    With $[L, M] = LM - ML$, or the bracket of the algebra. Where $\dot L = [M, L]$ holds instead, the error says so.

    Example:
        >>> top = lp.catalog.system("lagrange")
        >>> pair = lp.integrability.lax_pair(top, "I1*a*z^2 + l*z + alpha", "inv(I)*l + a*z")
        >>> print(pair.characteristic_polynomial.factor().args[0])
        w

    Args:
        system: Bracket and Hamiltonian.
        L: A square matrix: rows of numbers, SymPy expressions or texts, or a SymPy matrix. Or an element of the Lie
            algebra of the bracket: its components, or one text such as "z*l + alpha". Entries are polynomials in z and
            1/z, in the coordinates, in parameters and their inverses; `i` is the imaginary unit.
        M: The same.
        spectral: The name of the spectral parameter; None if there is none.
        source: Where the pair is described.

    Raises:
        LaxPairError: the equation fails; with the entry and the residual.
        ShapeError: L and M are not square matrices of one size, or elements of the algebra.
        ExpressionError: a text cannot be read.
        ParameterError: the name of the spectral parameter means something else, or L is no polynomial in z and 1/z.

    References: [lax1968].
    """
    z = spectral_symbol(system, spectral)
    first: Any = read_entries(system, L, z, "L")
    second: Any = read_entries(system, M, z, "M")
    kinds = [isinstance(given[0], list) for given in (first, second)]
    if kinds[0] != kinds[1] or len(first) != len(second):
        sizes = [
            f"{len(g)} x {len(g)}" if is_matrix else f"a vector of {len(g)}"
            for g, is_matrix in zip((first, second), kinds, strict=True)
        ]
        raise ShapeError(
            f"L and M: wanted two matrices of one size, or two elements of the algebra; got {sizes[0]} and {sizes[1]}"
        )
    _check_powers(chain(*first) if kinds[0] else first, z)
    if kinds[0]:
        _verify(system, first, second, lambda a, b, arithmetic: arithmetic.commutator(a, b))
        return LaxPair(system, (first, second), z, None, source)
    algebra = system.bracket.algebra
    _verify(system, [first], [second], lambda a, b, arithmetic: [_algebra_bracket(algebra, a[0], b[0], arithmetic)])
    elements: Any = (tuple(first), tuple(second))
    matrices = adjoint_matrix(algebra, elements[0]), adjoint_matrix(algebra, elements[1])
    return LaxPair(system, matrices, z, elements, source)


def _check_powers(entries: Iterable[Any], z: Symbol | None) -> None:
    """Refuse an L that is no polynomial in z and 1/z: its coefficients could not be read off."""
    for e in entries:
        for term in Add.make_args(e):
            if z is None or not term.has(z):
                continue
            base, power = term.as_independent(z, as_Add=False)[1].as_base_exp()
            if base != z or not power.is_Integer:
                raise ParameterError(
                    f"L: wanted polynomials in {z} and 1/{z}; got {shown(str(e))}; multiply L by its denominator, "
                    "a function of the spectral parameter alone"
                )


def adjoint_matrix(algebra: LieAlgebra, element: Sequence[Expr]) -> list[list[Any]]:
    """The matrix of x -> [element, x]."""
    n = algebra.dimension
    rows: list[list[Any]] = [[S.Zero] * n for _ in range(n)]
    for (i, j), values in algebra.brackets.items():
        for k, c in values.items():
            rows[k][j] += to_sympy(c) * element[i]
            rows[k][i] -= to_sympy(c) * element[j]
    return rows


def _algebra_bracket(
    algebra: LieAlgebra, a: Sequence[Element], b: Sequence[Element], arithmetic: EntryArithmetic
) -> list[Element]:
    found = [arithmetic.number(0)] * algebra.dimension
    for (i, j), values in algebra.brackets.items():
        for k, c in values.items():
            found[k] = found[k] + arithmetic.read(to_sympy(c)) * (a[i] * b[j] - a[j] * b[i])
    return found


def _verify(system: System, first: Any, second: Any, bracket: Any) -> None:
    """Refuse what is no Lax pair; rows of entries of both, and how two such are multiplied."""
    rates = [[Add(*(e.diff(x) * rate for x, rate in system.equations.items())).expand() for e in row] for row in first]
    structure = [to_sympy(c) for values in system.bracket.algebra.brackets.values() for c in values.values()]
    arithmetic = EntryArithmetic([*chain(*first), *chain(*second), *chain(*rates), *structure])
    read: list[Any] = [[[arithmetic.read(e) for e in row] for row in rows] for rows in (first, second, rates)]
    products = bracket(read[0], read[1], arithmetic)
    residual = [[r - p for r, p in zip(*rows, strict=True)] for rows in zip(read[2], products, strict=True)]
    wrong = [(i, j) for i, row in enumerate(residual) for j, e in enumerate(row) if not arithmetic.vanishes(e)]
    if not wrong:
        return
    i, j = wrong[0]
    reversed_ = all(
        arithmetic.vanishes(r + p) for rows in zip(read[2], products, strict=True) for r, p in zip(*rows, strict=True)
    )
    text = Formula(arithmetic.write(residual[i][j])).plain
    text = text if len(text) <= _MOST_SHOWN else f"{text[:_MOST_SHOWN]}..."
    entry = (i + 1, j + 1) if len(first) > 1 or len(first[0]) == 1 else (j + 1,)
    raise LaxPairError(entry, text, len(wrong), reverses=reversed_)


@explains_its_arguments
def known_lax_pair(system: str | System, *, parameters: Mapping[str, GivenValue] | None = None) -> LaxPair:
    """The Lax pair of a system of the catalog, or of a symmetric top on any unital algebra; verified.

    Example:
        >>> pair = lp.integrability.known_lax_pair("kovalevskaya")
        >>> pair.integrals().coefficients[0].formula
        8*H
        >>> lp.integrability.known_lax_pair(lp.catalog.lagrange_top(lp.leibniz(4), [0, 1, 0, 0])).L[0, 1]
        -x03*z**3 - x13*z**2 - x23*z - x33 - z**4

    Args:
        system: The name of the system; or a system with the Hamiltonian of `catalog.lagrange_top`.
        parameters: Values in the place of those of the catalog.

    Raises:
        UnknownNameError: there is no such system, or the package has no Lax pair of it; the message lists those it has.
        ParameterError: a system that is no such top, or parameters for a system that is given itself.
        LaxPairError: the pair is none for these parameters.
    """
    if isinstance(system, System):
        if parameters is not None:
            raise ParameterError("parameters: wanted none beside a system, which has its own; got some; leave them out")
        if (pair := _of_unital_top(system)) is not None:
            return pair
        raise ParameterError(
            "system: wanted the name of a system of the catalog, or a top as catalog.lagrange_top and "
            f"catalog.kovalevskaya_top make them; got {system.name}; look for a pair with search_lax_pairs"
        )
    check_kind(system, str, "system", "the name of a system of the catalog, or a top", 'write "kovalevskaya"')
    if system not in (*LAX_PAIRS, *MADE):
        what = "has no Lax pair in the package" if system in names() else "is no system of the catalog"
        known = (*LAX_PAIRS, *MADE)
        raise UnknownNameError(
            f"{system!r} {what}. {did_you_mean(system, known)}There are those of {', '.join(known)}."
        )
    file = entry(system)
    found = replace(file, parameters={**file.parameters, **read_values(parameters)}).system()
    texts = LAX_PAIRS.get(system)
    if texts is None:
        return known_lax_pair(found)
    return lax_pair(found, texts.L, texts.M, source=texts.source)


def _of_unital_top(system: System) -> LaxPair | None:
    """The pair of Lagrange's or Kovalevskaya's top on a unital algebra; None for other systems."""
    top = unital_top(system)
    if top is None:
        return None
    z = spectral_symbol(system, "z")
    if (lagrange := LagrangeTop(top)).holds:
        return lax_pair(system, *lagrange.lax_entries(z), source="musso2005")
    if (kovalevskaya := KovalevskayaTop(top)).holds:
        return lax_pair(system, *kovalevskaya.lax_entries(z), source="bobenko1989")
    return None


@dataclass(frozen=True)
class LaxIntegral:
    """One coefficient of the characteristic polynomial, or its real or imaginary part.

    Example:
        >>> found = lp.integrability.known_lax_pair("kovalevskaya").integrals()
        >>> [(one.kind, one.formula) for one in found.coefficients[:3]]
        [('known', 8*H), ('Casimir', -2*C2), ('integral', None)]

    Attributes:
        place: Where it stands: "w z^2", with "real part" or "imaginary part" behind it if it has both.
        expression: The function on phase space.
        kind: "Casimir"; "known", a polynomial in what the formula names; "integral", independent of H, the Casimirs and
            the integrals before it; "dependent", a function of these that is no polynomial in them of its degree.
        name: F1, F2, ... of an integral or a dependent function; empty for others.
        formula: It as a polynomial in H, the Casimirs C1, C2, ... and the integrals before it; None if it is none.
    """

    place: str
    expression: Expr
    kind: str
    name: str
    formula: Expr | None


@dataclass(frozen=True, repr=False)
class LaxIntegrals:
    """What a Lax pair says about integrability.

    Example:
        >>> found = lp.integrability.known_lax_pair("lagrange").integrals()
        >>> found.n_independent, found.rank, found.in_involution, found.is_complete
        (2, 4, True, True)

    Attributes:
        system: The system.
        coefficients: The coefficients that are no numbers, by degree.
        rank: Dimension of a generic leaf.
        n_independent: How many of the coefficients are independent on a generic leaf: the rank of their Hamiltonian
            vector fields at a random point, which is proved to be at least this.
        has_energy: Whether H is, near a generic point, a function of the coefficients: with it the same rank is found.
        in_involution: Whether all coefficients commute with each other; proved.
    """

    system: System
    coefficients: tuple[LaxIntegral, ...]
    rank: int
    n_independent: int
    has_energy: bool
    in_involution: bool

    @property
    def casimirs(self) -> tuple[LaxIntegral, ...]:
        """The coefficients that are Casimirs."""
        return tuple(c for c in self.coefficients if c.kind == "Casimir")

    @property
    def integrals(self) -> dict[str, Expr]:
        """The integrals that are independent of H, the Casimirs and each other, by name."""
        return {c.name: c.expression for c in self.coefficients if c.kind == "integral"}

    @property
    def is_complete(self) -> bool:
        """Whether they prove that the system is integrable in the sense of Liouville."""
        return self.in_involution and 2 * self.n_independent >= self.rank

    def __repr__(self) -> str:
        enough = "enough" if self.is_complete else "not enough"
        return (
            f"<LaxIntegrals of {self.system.name}: {len(self.coefficients)} coefficients, {self.n_independent} "
            f"independent on leaves of dimension {self.rank}: {enough} for Liouville integrability>"
        )

    def __str__(self) -> str:
        """The coefficients, what each is, and what they prove together."""
        lines = [f"{self.system.name}: coefficients of det(w - L), all constant: proved"]
        width = max((len(c.place) for c in self.coefficients), default=0)
        for c in self.coefficients:
            what = Formula(c.expression if c.formula is None else c.formula).plain
            named = f"{c.name} = " if c.name else ""
            note = {"Casimir": "   (Casimir)", "dependent": "   (depends on the others)"}.get(c.kind, "")
            lines.append(f"{c.place:{width}}   {named}{what}{note}")
        commuting = "commute with each other" if self.in_involution else "do not all commute"
        energy = "H is a function of them" if self.has_energy else "H is no function of them"
        lines.append(f"{self.n_independent} independent on leaves of dimension {self.rank}; they {commuting}; {energy}")
        if self.is_complete:
            lines.append("Liouville integrable: proved")
        return "\n".join(lines)


def lax_integrals(pair: LaxPair) -> LaxIntegrals:
    """The coefficients of the characteristic polynomial of a Lax pair, sorted."""
    system = _with_single_exponentials(pair.system)
    found = [(place, f) for place, f in _coefficients(pair) if f.free_symbols & set(system.variables)]
    found.sort(key=lambda item: _degree(item[1], system))
    functions = [f for _, f in found]
    _check_that_they_are_constant(system, [(place, f.expand()) for place, f in found])
    known = {name: f for name, f in known_functions(system).items() if name == "H" or not traces_in(f)}
    independent: dict[str, Expr] = {}
    sorted_: list[LaxIntegral] = []
    for place, f in found:
        plain = f.expand()
        one = _sorted_one(system, plain, known, independent)
        sorted_.append(replace(one, place=place, expression=f))
        if one.name:
            known[one.name] = plain
        if one.kind == "integral":
            independent[one.name] = plain
    moving = [c.expression.expand() for c in sorted_ if c.kind != "Casimir"]
    n = fields_rank(system, moving)
    return LaxIntegrals(
        pair.system,
        tuple(sorted_),
        system.bracket.rank(),
        n,
        bool(functions) and fields_rank(system, [*moving, system.hamiltonian]) == n,
        are_in_involution(system, [f for name, f in known.items() if name.startswith("F")]),
    )


def _with_single_exponentials(system: System) -> System:
    """The system with exp(x)*exp(-y) for exp(x - y), so that all functions are in the same exponentials."""
    if system.hamiltonian.is_polynomial(*system.variables):
        return system
    return with_hamiltonian(system, system.hamiltonian.expand())


def _sorted_one(
    system: System,
    f: Expr,
    known: Mapping[str, Expr],
    independent: Mapping[str, Expr],
) -> LaxIntegral:
    casimirs = {name: c for name, c in known.items() if name.startswith("C")}
    if not fields_rank(system, [f]) and not any(e.expand() for e in system.bracket.vector_field(f)):
        return LaxIntegral("", f, "Casimir", "", _formula(system, f, casimirs))
    if (formula := _formula(system, f, known)) is not None:
        return LaxIntegral("", f, "known", "", formula)
    name = next_name(known, system.component_names)
    others = [system.hamiltonian, *independent.values()]
    is_new = fields_rank(system, [*others, f]) > len(others)
    return LaxIntegral("", f, "integral" if is_new else "dependent", name, None)


def _formula(system: System, f: Expr, generators: Mapping[str, Expr]) -> Expr | None:
    written = as_polynomials(system, [f], {Symbol(name): g for name, g in generators.items()})
    return None if written is None else written[0]


def _coefficients(pair: LaxPair) -> Iterator[tuple[str, Expr]]:
    """The coefficients of powers of w and z, real and imaginary parts apart."""
    arithmetic, n = pair.arithmetic, pair.size
    for k, in_z in enumerate(pair.characteristic[1:], start=1):
        split = {0: in_z} if pair.spectral is None else arithmetic.by_power(in_z, pair.spectral)
        for power, element in sorted(split.items(), reverse=True):
            factors = [_power("w", n - k), _power(str(pair.spectral), power)]
            place = " ".join(filter(None, factors)) or "1"
            parts = [arithmetic.write(part) for part in arithmetic.parts(element)]
            for name, part in zip(("real", "imaginary"), parts, strict=True):
                if part != 0:
                    yield (f"{place}, {name} part" if parts[1] != 0 else place), part


def _power(name: str, exponent: int) -> str:
    return "" if not exponent else name if exponent == 1 else f"{name}^{exponent}"


def _degree(f: Any, system: System) -> int:
    return Poly(f, *system.variables).total_degree() if f.is_polynomial(*system.variables) else Poly(f).total_degree()


def _check_that_they_are_constant(system: System, found: list[tuple[str, Expr]]) -> None:
    equations, polynomials = algebraic_equations(system, *(f for _, f in found))
    for (place, f), polynomial in zip(found, polynomials, strict=True):  # it follows from the Lax equation
        assert not equations.level.remainder(equations.derivation(polynomial)), f"{place}: {f} is not constant"
