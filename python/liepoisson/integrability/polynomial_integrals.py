r"""First integrals of a system: all polynomials up to a degree or of a weight that are constant along the motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, count
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.exact_numbers import is_sympy, to_sympy
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import read_parameter
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_arguments, shows_progress
from liepoisson.inputs.given import by_name, listed, named
from liepoisson.inputs.names import check_title
from liepoisson.inputs.refusals import not_a, shown
from liepoisson.integrability.algebraic_functions import algebraic_equations, is_algebraic
from liepoisson.integrability.derivation import (
    Derivation,
    Exponents,
    Grading,
    derivation_of,
    gradings,
    n_monomials,
    n_of_weight,
    of_degree,
    of_weight,
    positive_grading,
)
from liepoisson.integrability.level import level_of, real_points, squarefree
from liepoisson.integrability.search import BlockCount, Generator, Search
from liepoisson.report.printing import Formula

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.formula.parameters import Parameter
    from liepoisson.model.system import System

Equations: TypeAlias = "str | Expr | Sequence[str | Expr] | Mapping[str, Parameter]"
"""Equations of a level set: texts or functions that vanish, one or several, or values by name."""

_LARGEST_WEIGHT = 10_000
MOST_MONOMIALS = 100_000
"""Monomials of the largest search that is begun; 92 000 of a top without gradings take half a minute and 0.5 GB."""


@dataclass(frozen=True)
class FirstIntegral:
    """An integral that was found.

    Example:
        >>> found = lp.integrability.first_integrals(lp.catalog.system("lagrange"), degree=1).found[0]
        >>> found.name, str(found.expression), found.is_independent
        ('F1', 'l3', True)

    Attributes:
        name: F1, F2, ...
        expression: It, with the smallest whole coefficients if they are rational.
        degree: Its total degree.
        is_independent: Whether it is functionally independent of the known integrals and those found before it.  Others
            are functions of these, though no polynomials in them.
    """

    name: str
    expression: Expr
    degree: int
    is_independent: bool


@dataclass(frozen=True, repr=False)
class FirstIntegrals:
    """What a search for polynomial first integrals found, and what it proves.

    Example:
        >>> found = lp.integrability.first_integrals(lp.catalog.system("kovalevskaya"), degree=4)
        >>> [str(integral.expression) for integral in found.found], found.complete
        (['8*alpha1*l1**2 - 8*alpha1*l2**2 + 16*alpha2*l1*l2 - 16*alpha3**2 + l1**4 + 2*l1**2*l2**2 + l2**4'], True)

    Attributes:
        system: The system.
        degree: The total degree up to which was searched, or None.
        weight: The weight, or None.
        weights: The weights of the coordinates, if a weight was given.
        on: Functions that vanish on the level set that was searched; empty for all of phase space.
        known: The integrals that were known, by name.
        found: Those that were found and are no polynomials in the known ones, lowest degree first.
        n_monomials: Number of monomials of the search.
        n_blocks: Number of blocks, between which the equations do not mix.
        n_integrals: Dimension of the space of integrals, not counting constants.
        complete: Whether it is proved that there are no others.
        prime: The prime modulo which null spaces were bounded.
        parameters: Names of the parameters for whose generic values this holds; empty where all are numbers.
        functions: Functions of the coordinates, such as sqrt(x^2 + y^2), in which the polynomials are, besides the
            coordinates.
    """

    system: System
    degree: int | None
    weight: int | None
    weights: tuple[int, ...]
    on: tuple[Expr, ...]
    known: dict[str, Expr]
    found: tuple[FirstIntegral, ...]
    n_monomials: int
    n_blocks: int
    n_integrals: int
    complete: bool
    prime: int
    parameters: tuple[str, ...] = ()
    functions: tuple[Expr, ...] = ()
    counts: tuple[BlockCount, ...] = field(default=(), repr=False)

    @property
    def independent(self) -> tuple[FirstIntegral, ...]:
        """The integrals found that are functionally independent of the known ones and of each other."""
        return tuple(f for f in self.found if f.is_independent)

    @property
    def scope(self) -> str:
        """Which polynomials were searched, in words."""
        size = f"up to degree {self.degree}" if self.weight is None else f"of weight {self.weight}"
        where = f" on {', '.join(f'{Formula(f).plain} = 0' for f in self.on)}" if self.on else ""
        generic = f", for generic {', '.join(self.parameters)}" if self.parameters else ""
        of = f" in the coordinates and {', '.join(Formula(f).plain for f in self.functions)}" if self.functions else ""
        return f"polynomials {size}{of}{where}{generic}"

    @property
    def modulo_ideal(self) -> bool:
        """Whether functions count as zero on the level only if they are combinations of its equations.

        Of one equation those are all functions that vanish on the complex level; of several there may be more.
        """
        return bool(self.on) and len(self.on) + len(self.functions) > 1

    @property
    def notes(self) -> tuple[str, ...]:
        """What else is to be known of the level: at which real points a sum of squares vanishes."""
        vanishing = [(f, real_points(f, self.system.variables)) for f in self.on]
        return tuple(
            f"on the complex level {Formula(f).plain} = 0; at its real points {' = '.join(map(str, names))} = 0, which "
            "can be given instead"
            for f, names in vanishing
            if names and f not in names
        )

    def __repr__(self) -> str:
        n = len(self.found)
        what = f"{n} new integral{'s' * (n != 1)}" if n else "no new integral"
        state = "" if self.complete else ", incomplete"
        return f"<FirstIntegrals of {self.system.name}: {what} among {self.scope}{state}>"

    def __str__(self) -> str:
        """The integrals, and what is proved."""
        lines = [f"{self.system.name}: first integrals among {self.scope}"]
        lines.append(f"known: {', '.join(self.known) or 'none'}")
        for integral in self.found:
            note = "" if integral.is_independent else "   (depends on the others)"
            lines.append(f"{integral.name} = {Formula(integral.expression).plain}{note}")
        if not self.complete:
            lines.append("not proved that these are all: there may be others" if self.found else "none was found")
            lines.append(f"incomplete: modulo {self.prime} the null space is larger than what known integrals span")
        else:
            if not self.found:
                lines.append("no others than polynomials in the known ones")
            blocks = f"{self.n_blocks} block{'s' * (self.n_blocks != 1)}"
            where = ", modulo the ideal of these equations" if self.modulo_ideal else ""
            others = "Every other one is a polynomial in these" if self.found else "There is none"
            lines.append(
                f"proved over the complex numbers{where}: {others}. ({self.n_monomials} monomials in {blocks}; "
                f"{self.n_integrals} integrals, the null space modulo {self.prime}, are spanned)"
            )
        return "\n".join([*lines, *self.notes])


@explains_its_arguments
@shows_progress
def first_integrals(
    system: System,
    *,
    degree: int | None = None,
    weight: int | None = None,
    on: Equations = (),
    known: Mapping[str, str | Expr] | None = None,
    progress: Callable[[float], Any] | None = None,
) -> FirstIntegrals:
    r"""All polynomial first integrals up to a total degree, or of one weight.

    They are the polynomials F with $\{F, H\} = 0$: the null vectors of $D = \sum_k\dot x_k\,\partial_k$ on monomials,
    found modulo a prime and, where they are no products of known ones, lifted and checked exactly.  A rank modulo a
    prime is at most the true one, so that "there are no others" is a proof, over the complex numbers as well.

    Example:
        >>> top = lp.Top(inertia=(2, 2, 1), a=(0, 0, -1), epsilon=1)
        >>> found = lp.integrability.first_integrals(top, degree=2)
        >>> [str(f.expression) for f in found.found]
        ['l3', 'alpha1*l1 + alpha2*l2 + alpha3*l3 - 2*beta3']

    Args:
        system: A system whose equations are polynomials in the coordinates and in fractions, square roots of
            polynomials, and exp, sin and cos of linear forms, which count as further coordinates.  Parameters that are
            symbols count as generic.
        degree: The total degree; 2 if neither it nor the weight is given.
        weight: The weight instead, for equations that are homogeneous for positive weights of the coordinates, which
            are found: (1, 2, 3) for l, alpha and beta of the twisted top with b = 0.
        on: Equations of a level set to which the search is restricted, such as "C2 = 1" or {"C2": 1}, or functions
            that vanish on it, such as "C1" or "C2 - 1": partial integrals, as that of Goryachev and Chaplygin.  The
            level must be invariant, and is the complex one.  Of one equation the squarefree part counts; with several,
            polynomials count modulo the ideal that these generate.
        known: Integrals by name, of which polynomials are not looked for; by default H and the Casimirs.
        progress: As for `integrate`.

    Raises:
        ParameterError: The equations are no polynomials, a known integral is none, the level is not invariant, there is
            no positive grading for a weight, or the search is too large.
        ExpressionError: A text cannot be read.
    """
    given = known_functions(system)
    if known is not None:
        given = {
            check_title(name, "known: the name of an integral"): system.expression(f)
            for name, f in functions_by_name(known).items()
        }
    zeros = zeros_on_level(system, on)
    if weight is None and degree is not None:  # before anything is written out
        _n_up_to(len(system.variables), as_count(degree, "degree", least=1))
    used = _of_degree(given, as_count(*_size_asked(degree, weight), least=1))
    # of a Hamiltonian with log(x) only the gradient can be read, which tells what is independent of it
    slopes: list[Expr] = []
    if system.hamiltonian in used.values() and not is_algebraic(system, system.hamiltonian):
        used = {name: f for name, f in used.items() if f != system.hamiltonian}
        slopes = [system.hamiltonian.diff(x) for x in system.variables]
    equations, functions = algebraic_equations(system, *used.values(), *zeros, *slopes)
    derivation, known_polynomials = equations.derivation, functions[: len(used)]
    slope = tuple(functions[len(used) + len(zeros) :])
    relations = level_of(derivation, equations.relations)
    for (name, expression), polynomial in zip(used.items(), known_polynomials, strict=True):
        if rate := relations.remainder(derivation(polynomial)):
            raise ParameterError(
                f"known: wanted integrals; got {name} = {shown(expression)}, whose derivative "
                f"{shown(equations.expression(rate))} is not zero"
            )
    zero_polynomials = [*equations.relations, *functions[len(used) : len(used) + len(zeros)]]
    level = level_of(derivation, zero_polynomials)
    found = gradings_of_level(derivation, zero_polynomials)
    monomials, size, weights = _asked(derivation, found, degree, weight)
    found = gradings_of_known(found, known_polynomials, weights)
    remainders = [level.remainder(polynomial) for polynomial in known_polynomials]
    generators = [Generator(n, r, is_new=False) for n, r in zip(used, remainders, strict=True) if any(map(any, r))]
    search = Search(derivation, found, level, tuple(z for z in zero_polynomials if z), generators, slope)
    search.run(monomials, progress, weights)
    new = [g for g in search.generators if g.is_new]
    return FirstIntegrals(
        system=system,
        degree=None if weight is not None else (2 if degree is None else degree),
        weight=weight,
        weights=weights,
        on=tuple(zeros),
        known=given,
        found=tuple(
            FirstIntegral(g.name, equations.expression(tidied(g.polynomial)), g.degree, g.is_independent) for g in new
        ),
        functions=tuple(equations.functions.values()),
        n_monomials=size,
        n_blocks=len(search.counts),
        n_integrals=sum(c.nullity for c in search.counts),
        complete=search.complete,
        prime=search.residues.p,
        parameters=tuple(str(s) for s in derivation.field.parameters if s.is_Symbol),
        counts=tuple(search.counts),
    )


def read_search(
    system: System, known: Mapping[str, str | Expr] | None, on: Equations
) -> tuple[dict[str, Expr], list[Expr], Derivation, list[Polynomial], list[Polynomial]]:
    """The known integrals and the functions that vanish on the level, the equations, and both as polynomials.

    Raises:
        ParameterError: the equations are no polynomials, or a known integral is none.
    """
    given = (
        known_functions(system)
        if known is None
        else {name: system.expression(f) for name, f in functions_by_name(known).items()}
    )
    zeros = zeros_on_level(system, on)
    derivation, functions = derivation_of(system, *given.values(), *zeros)
    known_polynomials, zero_polynomials = functions[: len(given)], functions[len(given) :]
    for (name, expression), polynomial in zip(given.items(), known_polynomials, strict=True):
        if derivation(polynomial):
            raise ParameterError(
                f"known: wanted integrals; got {name} = {shown(expression)}, whose derivative "
                f"{shown(derivation.expression(derivation(polynomial)))} is not zero"
            )
    return given, zeros, derivation, known_polynomials, zero_polynomials


def functions_by_name(known: object, what: str = "known") -> dict[str, Any]:
    """Functions of the state by name.

    Raises:
        ParameterError: they have no names.
    """
    return by_name(known, what, "functions", '{"K": "l3"}')


def known_functions(system: System) -> dict[str, Expr]:
    """H and the Casimirs."""
    return {"H": system.hamiltonian} | {f"C{k}": c for k, c in enumerate(system.bracket.casimirs(), start=1)}


def _size_asked(degree: int | None, weight: int | None) -> tuple[Any, str]:
    """The weight or the degree, and its name; degree 2 if neither is given."""
    return (weight, "weight") if weight is not None else (2 if degree is None else degree, "degree")


def equations_of(system: System, on: Equations) -> tuple[str | Expr, ...]:
    """Equations as a caller gives them: one, several, or values by name, of which "C1 = 1" is made.

    Raises:
        ParameterError: they are none of these, or a value is not exact.
    """
    if isinstance(on, str) or is_sympy(on):
        return (cast("str | Expr", on),)
    if (values := named(on, "on")) is None:
        if (items := listed(on, "on")) is None:
            name = "C1" if system.bracket.casimirs() else "H"
            raise not_a("a sequence of equations", on, "on", f'write on="{name} = 0" or on={{"{name}": 0}}')
        return tuple(items)
    exact = {name: read_parameter(value, f"on: {name}") for name, value in values.items()}
    return tuple(
        f"{name} = {value}" if isinstance(name, str) else name - to_sympy(value) for name, value in exact.items()
    )


def zeros_on_level(system: System, on: Equations) -> list[Expr]:
    """The functions that vanish where some equations hold: f for "f = 0" and for f alone, H and C1 by name.

    Raises:
        ParameterError: an equation holds everywhere.
        ExpressionError: a text cannot be read.
    """
    zeros: list[Expr] = []
    for equation in equations_of(system, on):
        if isinstance(equation, str):
            left, sign, right = equation.partition("=")
            zero: Any = system.function_of_invariants(left)
            zero = zero - system.function_of_invariants(right) if sign else zero
        else:
            zero = system.expression(equation)
        if zero.expand() == 0:
            raise ParameterError(
                f"on: wanted equations of a level set; {shown(equation)} holds everywhere; leave it out"
            )
        real_points(zero, system.variables)
        zeros.append(squarefree(zero, system.variables))
    return zeros


def _of_degree(known: Mapping[str, Expr], degree: int) -> dict[str, Expr]:
    """The known integrals, traces of products of matrices written out; those of a higher degree are not needed."""
    from liepoisson.structure.trace import traces_in

    used: dict[str, Expr] = {}
    for name, f in known.items():
        traces = traces_in(f)
        if all(len(trace.word) <= degree for trace in traces):
            used[name] = f.expand(trace=True) if traces else f
    return used


def gradings_of_level(derivation: Derivation, zeros: Sequence[Polynomial]) -> tuple[Grading, ...]:
    """The gradings in which the equations of the level are homogeneous."""
    return tuple(g for g in gradings(derivation) if all(len({g.of(m) for m in zero}) <= 1 for zero in zeros))


def gradings_of_known(
    found: Sequence[Grading], known: Sequence[Polynomial], weights: tuple[int, ...]
) -> tuple[Grading, ...]:
    """The gradings in which the known integrals are homogeneous, and that of the weights by which is searched, if any.

    In others the parts of an integral are integrals, too, but need not be polynomials in the known ones.
    """
    kept = tuple(g for g in found if all(len({g.of(m) for m in f}) <= 1 for f in known))
    return (*kept, Grading(weights, 0)) if weights else kept


def _asked(
    derivation: Derivation, found: Sequence[Grading], degree: int | None, weight: int | None
) -> tuple[Iterator[Exponents], int, tuple[int, ...]]:
    """The monomials of the search, their number, and the weights of the coordinates."""
    n = len(derivation.variables)
    if weight is None:
        d = 2 if degree is None else as_count(degree, "degree", least=1)
        size = _n_up_to(n, d)
        return chain.from_iterable(of_degree(n, k) for k in range(1, d + 1)), size, ()
    if degree is not None:
        raise ParameterError(f"wanted a degree or a weight; got both, {degree} and {weight}; leave one out")
    w = as_count(weight, "weight", least=1)
    grading = positive_grading(found)
    if grading is None:
        raise ParameterError(
            "weight: wanted equations that are homogeneous for positive weights of the coordinates; these are not; "
            "give a degree instead"
        )
    size = n_of_weight(grading.weights, w) if w <= _LARGEST_WEIGHT else None
    if size is None or size > MOST_MONOMIALS:
        raise ParameterError(
            f"weight: wanted at most {MOST_MONOMIALS:,} monomials, of a weight up to {_LARGEST_WEIGHT:,}; got {w}"
            f"{'' if size is None else f', with {size:,}'}; take a smaller weight"
        )
    return of_weight(grading.weights, w), size, grading.weights


def _n_up_to(n: int, degree: int) -> int:
    """How many monomials of n coordinates have at most this degree, without 1.

    Raises:
        ParameterError: more than are searched.
    """
    size = n_monomials(n, degree) - 1
    if size > MOST_MONOMIALS:
        fits = next(k for k in count() if n_monomials(n, k + 1) > MOST_MONOMIALS)
        raise ParameterError(
            f"degree: wanted at most {fits}, with {n_monomials(n, fits):,} monomials in {n} coordinates; got {degree}, "
            f"with {size:,}. Take degree={fits}, or search by weight where the equations are homogeneous"
        )
    return size


def tidied(polynomial: Polynomial) -> Polynomial:
    """With whole coefficients without a common factor, the leading one positive, where they are rational."""
    from fractions import Fraction
    from math import gcd, lcm

    values = list(polynomial.values())
    if not all(isinstance(v, Fraction) for v in values):
        return polynomial
    scale = Fraction(lcm(*(v.denominator for v in values)))
    whole = {m: v * scale for m, v in polynomial.items()}
    common = gcd(*(int(v) for v in whole.values()))
    sign = -1 if whole[max(whole, key=lambda m: (sum(m), m))] < 0 else 1
    return {m: v * sign / common for m, v in whole.items()}
