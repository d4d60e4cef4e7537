r"""First integrals of a system: all polynomials up to a degree or of a weight that are constant along the motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from sympy import Expr

from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.names import check_title
from liepoisson.integrability.algebraic_functions import algebraic_equations, is_algebraic
from liepoisson.integrability.derivation import real_points
from liepoisson.integrability.search import BlockCount, tidied
from liepoisson.integrability.search_problem import (
    Equations,
    SearchProblem,
    SizeAsked,
    functions_by_name,
    known_functions,
    where,
    zeros_on_level,
)
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.model.system import System
from liepoisson.report.printing import Formula
from liepoisson.structure.casimir_part import normal_form
from liepoisson.structure.trace import traces_in

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

    system: EquationsOfMotion
    degree: int | None
    weight: int | None
    weights: tuple[int, ...]
    on: tuple[Expr, ...]
    known: dict[str, Expr] = field(hash=False)
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
        level = f" on {where(self.on)}" if self.on else ""
        generic = f", for generic {', '.join(self.parameters)}" if self.parameters else ""
        of = f" in the coordinates and {', '.join(Formula(f).plain for f in self.functions)}" if self.functions else ""
        return f"polynomials {size}{of}{level}{generic}"

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
            ideal = ", modulo the ideal of these equations" if self.modulo_ideal else ""
            others = "Every other one is a polynomial in these" if self.found else "There is none"
            lines.append(
                f"proved over the complex numbers{ideal}: {others}. ({self.n_monomials} monomials in {blocks}; "
                f"{self.n_integrals} integrals, the null space modulo {self.prime}, are spanned)"
            )
        return "\n".join([*lines, *self.notes])


@shows_progress
def first_integrals(
    system: EquationsOfMotion,
    *,
    degree: int | None = None,
    weight: int | None = None,
    on: Equations = (),
    known: Mapping[str, str | Expr] | None = None,
    progress: Callable[[float], Any] | None = None,
) -> FirstIntegrals:
    r"""All polynomial first integrals up to a total degree, or of one weight.

    They are the polynomials F with $\dot F = \{F, H\} = 0$: the null vectors of $D = \sum_k\dot x_k\,\partial_k$ on
    monomials, found modulo a prime and, where they are no products of known ones, lifted and checked exactly.  A rank
    modulo a prime is at most the true one, so that "there are no others" is a proof, over the complex numbers as well.

    Example:
        >>> top = lp.Top(inertia=(2, 2, 1), a=(0, 0, -1), epsilon=1)
        >>> found = lp.integrability.first_integrals(top, degree=2)
        >>> [str(f.expression) for f in found.found]
        ['l3', 'alpha1*l1 + alpha2*l2 + alpha3*l3 - 2*beta3']

    Args:
        system: A system or vector field whose equations are polynomials in the coordinates and in fractions, square
            roots of polynomials, and exp, sin and cos of linear forms, which count as further coordinates.  Parameters
            that are symbols count as generic.
        degree: The total degree; 2 if neither it nor the weight is given.
        weight: The weight instead, for equations that are homogeneous for positive weights of the coordinates, which
            are found: (1, 2, 3) for l, alpha and beta of the twisted top with b = 0.
        on: Equations of a level set to which the search is restricted, such as "C2 = 1" or {"C2": 1}, or functions
            that vanish on it, such as "C1" or "C2 - 1": partial integrals, as that of Goryachev and Chaplygin.  The
            level must be invariant, and is the complex one.  Of one equation the squarefree part counts; with several,
            polynomials count modulo the ideal that these generate.
        known: Integrals by name, of which polynomials are not looked for; by default H and the Casimirs, and none of a
            vector field.
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
    zeros, size_asked = zeros_on_level(system, on), SizeAsked.of(degree, weight)
    if weight is None and degree is not None:  # before anything is written out
        size_asked.n_up_to_degree(len(system.variables), MOST_MONOMIALS)
    energy = system.hamiltonian if isinstance(system, System) else None
    used = _of_degree(_with_low_hamiltonian(system, given), size_asked.value)
    # of a Hamiltonian with log(x) only the gradient can be read, which tells what is independent of it
    slopes: list[Expr] = []
    if energy is not None and energy in used.values() and not is_algebraic(system, energy):
        used = {name: f for name, f in used.items() if f != energy}
        slopes = [energy.diff(x) for x in system.variables]
    equations, functions = algebraic_equations(system, *used.values(), *zeros, *slopes)
    n, derivation = len(used), equations.derivation
    on_level = [*equations.relations, *functions[n : n + len(zeros)]]
    problem = SearchProblem(equations, dict(zip(used, functions[:n], strict=True)), on_level)
    problem.check(used)
    monomials, size, weights = size_asked.monomials(derivation, problem.gradings, MOST_MONOMIALS)
    search = problem.search(problem.gradings_of_known(problem.gradings, weights))
    search.slope = tuple(functions[n + len(zeros) :])
    search.run(monomials, progress, weights)
    new = [g for g in search.generators if g.is_new]
    return FirstIntegrals(
        system=system,
        degree=size_asked.degree,
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


def _with_low_hamiltonian(system: EquationsOfMotion, known: Mapping[str, Expr]) -> dict[str, Expr]:
    """The known integrals, with what is left of H modulo known Casimirs where that has a lower degree."""
    if not isinstance(system, System):
        return dict(known)
    casimirs = {*system.bracket.casimirs()}
    if system.hamiltonian not in known.values() or not casimirs <= {*known.values()}:
        return dict(known)
    low, part = normal_form(system.bracket, system.hamiltonian)
    if low == 0 or not part.weights or not _is_of_lower_degree(low, system):
        return dict(known)
    return {name: low if f == system.hamiltonian else f for name, f in known.items()}


def _is_of_lower_degree(low: Expr, system: System) -> bool:
    """Whether a polynomial has a lower degree than H."""
    from sympy import Poly

    functions: list[Any] = [low, system.hamiltonian]
    if not all(f.is_polynomial(*system.variables) for f in functions):
        return False
    first, second = (Poly(f, *system.variables).total_degree() for f in functions)
    return first < second


def _of_degree(known: Mapping[str, Expr], degree: int) -> dict[str, Expr]:
    """The known integrals, traces of products of matrices written out; those of a higher degree are not needed."""
    used: dict[str, Expr] = {}
    for name, f in known.items():
        traces = traces_in(f)
        if all(len(trace.word) <= degree for trace in traces):
            used[name] = f.expand(trace=True) if traces else f
    return used


def named_formulas(functions: Mapping[str, Expr]) -> list[dict[str, str]]:
    """Names and expressions, as plain data."""
    return [{"name": name, "expression": Formula(f).plain} for name, f in functions.items()]


def search_record(found: FirstIntegrals) -> dict[str, Any]:
    """What a search found and proves, as plain data that JSON can write; expressions as in system files."""
    size = {"degree": found.degree} if found.weight is None else {"weight": found.weight, "weights": found.weights}
    return {
        "system": found.system.name,
        **size,
        "functions": [Formula(f).plain for f in found.functions],
        "on": [Formula(f).plain for f in found.on],
        "generic_parameters": list(found.parameters),
        "known": named_formulas(found.known),
        "found": [
            {
                "name": f.name,
                "expression": Formula(f.expression).plain,
                "degree": f.degree,
                "independent": f.is_independent,
            }
            for f in found.found
        ],
        "complete": found.complete,
        "modulo_ideal": found.modulo_ideal,
        "notes": list(found.notes),
        "proof": {
            "monomials": found.n_monomials,
            "blocks": found.n_blocks,
            "integrals": found.n_integrals,
            "prime": found.prime,
        },
    }
