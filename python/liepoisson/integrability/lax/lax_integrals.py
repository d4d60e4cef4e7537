r"""The integrals of a Lax pair: coefficients of $\det(w - L(z))$, each verified, and what each of them is.

A coefficient with complex values gives its real and its imaginary part. Every one is verified by the equations of
motion, although the Lax equation implies it. A function is a Casimir if its Hamiltonian vector field vanishes. Others
are written as polynomials in H, the Casimirs and the coefficients before them, where they are such; what remains is
independent of these, or a function of them that is no polynomial.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from liepoisson.integrability.algebraic_functions import algebraic_equations
from liepoisson.integrability.completeness import are_in_involution, as_polynomials, fields_rank
from liepoisson.integrability.level import level_of
from liepoisson.integrability.search import next_name
from liepoisson.report.printing import Formula
from liepoisson.structure.trace import traces_in

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.integrability.lax.pair import LaxPair
    from liepoisson.model.system import System


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
    casimirs = enumerate(system.bracket.casimirs(), start=1)
    known = {"H": system.hamiltonian} | {f"C{k}": c for k, c in casimirs if not traces_in(c)}
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
    from liepoisson.model.hamiltonian import symbols_in
    from liepoisson.model.system import System

    if system.hamiltonian.is_polynomial(*system.variables):
        return system
    symbols = symbols_in(system.hamiltonian, system.component_names)
    return System(system.bracket, system.hamiltonian.expand(), name=system.name, symbols=symbols)


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
    from sympy import Symbol

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
    from sympy import Poly

    return Poly(f, *system.variables).total_degree() if f.is_polynomial(*system.variables) else Poly(f).total_degree()


def _check_that_they_are_constant(system: System, found: list[tuple[str, Expr]]) -> None:
    equations, polynomials = algebraic_equations(system, *(f for _, f in found))
    level = level_of(equations.derivation, equations.relations)
    for (place, f), polynomial in zip(found, polynomials, strict=True):
        if level.remainder(rate := equations.derivation(polynomial)):  # cannot be where the Lax equation holds
            raise AssertionError(f"{place}: {f} is not constant, its rate is {equations.derivation.expression(rate)}")
