r"""Which integrals survive a deformation of a bracket or of a Hamiltonian, and what stops the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, cast

from sympy import Add, Expr, Mul, Symbol

from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.ideals.limits import NotDecidedError
from liepoisson.algebra.sparse_polynomials import Polynomial, rational_to_sympy, whole_expression
from liepoisson.algebra.sparse_polynomials import expression as expression_of
from liepoisson.errors import TimeLimitError
from liepoisson.formula.scalars import as_count, as_deadline
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import SEARCH_LIMIT
from liepoisson.inputs.refusals import counted
from liepoisson.integrability.deforming.conditions import OnParameters, Parametric, ParametricEquations
from liepoisson.integrability.deforming.family import Family, Starts, family_of
from liepoisson.integrability.deforming.orders import Functional, OrderEquations, Solved
from liepoisson.integrability.search_problem import SizeAsked, where
from liepoisson.model.system import System
from liepoisson.report.printing import Formula


@dataclass(frozen=True, eq=False, repr=False)
class DeformedIntegral:
    r"""An integral at 0 with its corrections, $F = F_0 + \epsilon F_1 + \dots$.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + alpha3 + k*alpha1", symbols=["k"])
        >>> (axis,) = lp.deformations(top, parameter="k", integrals={"l3": "l3"}, weight=1).integrals
        >>> str(axis.function), axis.is_exact
        ('k*l1 + l3', True)

    Attributes:
        start: $F_0$, in the names of known integrals at 0.
        function: F, in the coordinates and the parameters.
        order: The order in the parameter up to which it is an integral; None if it is one exactly.
    """

    start: Expr
    function: Expr
    order: int | None

    @property
    def is_exact(self) -> bool:
        """Whether F is an integral for all values of the parameter."""
        return self.order is None

    def __repr__(self) -> str:
        state = "exactly" if self.is_exact else f"to order {self.order}"
        return f"<DeformedIntegral {Formula(self.start).plain}, {state}: {Formula(self.function).plain}>"


@dataclass(frozen=True, eq=False, repr=False)
class Obstruction:
    r"""A proof that an integral at 0 has no correction of an order, also if polynomials in H and in Casimirs are added.

    $F_1, F_2, \dots$ are any polynomials, or where a degree was given, those of at most this degree.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, inv(I)*l)/2 + alpha3 + k*alpha1", {"I": [2, 2, 1]},
        ...                 symbols=["k"])
        >>> (axis,) = lp.deformations(top, parameter="k", integrals={"l3": "l3"}, weight=1).obstructions
        >>> axis.order, axis.functional
        (1, {alpha2*k: -1, k*l2*l3: 2})

    Attributes:
        start: $F_0$, in the names of known integrals at 0.
        function: $F_0$ in the coordinates.
        weights: The weights of $F_0$ in the gradings of the equations.
        order: The first order in which there is none.
        functional: A number for each monomial in the coordinates and the parameter: it maps the derivatives of every
            correction of these weights, and of polynomials in H and in Casimirs, to 0.
        value: What it maps the derivative of $F_0$ to, not 0.
        n_corrections: How many monomials corrections have.
    """

    start: Expr
    function: Expr
    weights: tuple[int, ...]
    order: int
    functional: dict[Expr, Expr]
    value: Expr
    n_corrections: int

    def __repr__(self) -> str:
        name = Formula(self.start).plain
        return f"<Obstruction of {name}, weights {self.weights}: no correction of order {self.order}>"


@dataclass(frozen=True, eq=False, repr=False)
class DeformationCase:
    """Values of several parameters for which an integral survives.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2)/4 + l3^2/2 + alpha3 + k1*l1 + k3*l3",
        ...                 symbols=["k1", "k3"])
        >>> lp.deformations(top, parameter=["k1", "k3"], integrals={"l3": "l3"}, weight=1).cases
        (<DeformationCase of l3: k1 = 0>,)

    Attributes:
        start: $F_0$, in the names of known integrals at 0.
        conditions: Polynomials in the parameters that vanish; none where it survives for all.
        function: F, in the coordinates, the parameters and coefficients that the conditions have, too.
        is_exact: Whether it is proved that F is an integral wherever the conditions hold.
        dimension: The dimension of the set of parameters, with the further coefficients.
    """

    start: Expr
    conditions: tuple[Expr, ...]
    function: Expr
    is_exact: bool
    dimension: int

    def __repr__(self) -> str:
        words = where(self.conditions) or "all parameters"
        state = "" if self.is_exact else ", not to all orders"
        return f"<DeformationCase of {Formula(self.start).plain}: {words}{state}>"


@dataclass(frozen=True, eq=False, repr=False)
class Deformations:
    """What is left of some integrals when a system is deformed.

    Example:
        >>> top = lp.System(lp.so(3) @ lp.leibniz(3, "epsilon"), "dot(l, inv(I)*l)/2 + alpha3", {"I": [2, 2, 1]})
        >>> found = lp.deformations(top, parameter="epsilon", weight=3)
        >>> [str(f.function) for f in found.integrals]
        ['l3', 'alpha1*l1 + alpha2*l2 + alpha3*l3 + 2*beta3*epsilon']

    Attributes:
        system: The system.
        parameters: The names of the parameters.
        known: Integrals at 0, by name.
        trivial: Those that have corrections of all orders: H and the limits of Casimirs; polynomials in them do not
            count below.
        degree: The degree of $F_0$, or None.
        weight: The weight of $F_0$, or None.
        weights: The weights of the coordinates and of the parameters, if a weight was given.
        order: The highest order of corrections.
        integrals: What survives, to the highest order or exactly; one parameter only.
        obstructions: What does not; one parameter only.
        cases: For which values of several parameters something survives.
        conditions: For several parameters, the conditions of each order, for each block of integrals.
        hamiltonian_terms: The terms of a change of the Hamiltonian that decide for all polynomial changes; empty if
            there is none to look at, None if this is not known.
        n_starts: How many products of known integrals were looked at, without polynomials in the trivial ones.
        left: What was not decided, in words.
    """

    system: System
    parameters: tuple[str, ...]
    known: dict[str, Expr]
    trivial: dict[str, Expr]
    degree: int | None
    weight: int | None
    weights: dict[str, int]
    order: int
    integrals: tuple[DeformedIntegral, ...]
    obstructions: tuple[Obstruction, ...]
    cases: tuple[DeformationCase, ...]
    conditions: tuple[tuple[Expr, ...], ...]
    hamiltonian_terms: tuple[Expr, ...] | None
    n_starts: int
    left: tuple[str, ...] = field(default=())

    @property
    def exact(self) -> tuple[DeformedIntegral, ...]:
        """Those that are integrals for all values of the parameter."""
        return tuple(f for f in self.integrals if f.is_exact)

    def __repr__(self) -> str:
        names = ", ".join(self.parameters)
        size = f"weight {self.weight}" if self.degree is None else f"degree {self.degree}"
        what = (
            f"{counted(len(self.integrals), 'integral survives', 'integrals survive')}, "
            f"{counted(len(self.obstructions), 'obstruction')}"
            if len(self.parameters) == 1
            else counted(len(self.cases), "case")
        )
        return f"<Deformations of {self.system.name} in {names}, up to {size}: {what}>"

    def __str__(self) -> str:
        """What survives, and what does not."""
        size = f"weight {self.weight}" if self.degree is None else f"degree {self.degree}"
        lines = [f"{self.system.name} near {' = '.join(self.parameters)} = 0: integrals up to {size}"]
        lines.append(f"known at 0: {', '.join([*self.trivial, *self.known])}; not counted: {', '.join(self.trivial)}")
        bound = "" if self.degree is None else f" of degree up to {self.degree}"
        for f in self.integrals:
            state = "an integral for all values" if f.is_exact else f"an integral to order {f.order}"
            lines.append(f"{Formula(f.start).plain} + ... = {Formula(f.function).plain}: {state}")
        for o in self.obstructions:
            lines.append(f"{Formula(o.start).plain}: no correction{bound} of order {o.order}: proved")
        for case in self.cases:
            state = "" if case.is_exact else " (not to all orders)"
            values = f"if {where(case.conditions)}" if case.conditions else "for all values"
            lines.append(f"{Formula(case.start).plain} survives {values}{state}")
        if len(self.parameters) > 1 and not self.cases:
            lines.append("nothing survives" if not self.left else "nothing that was decided survives")
        if not self.integrals and self.obstructions:
            lines.append(f"nothing survives{bound and f' with corrections{bound}'}{self._of_hamiltonian}")
        return "\n".join([*lines, *self.left])

    @property
    def _of_hamiltonian(self) -> str:
        if self.hamiltonian_terms is None:
            return ", with the Hamiltonian as it is"
        if not self.hamiltonian_terms:
            return ", whatever polynomial is added to the Hamiltonian in first order"
        terms = ", ".join(Formula(t).plain for t in self.hamiltonian_terms)
        return f"; of changes of the Hamiltonian only those by {terms} are left to look at"


@explains_its_arguments
def deformations(
    system: System,
    *,
    parameter: str | Sequence[str] = "epsilon",
    integrals: Mapping[str, str | Expr] | None = None,
    degree: int | None = None,
    weight: int | None = None,
    order: int = 4,
    time_limit: float = SEARCH_LIMIT,
) -> Deformations:
    r"""Which integrals at the value 0 of a parameter survive when the parameter is not 0?

    For one parameter $F_0 + \epsilon F_1 + \epsilon^2 F_2 + \dots$ is sought, where $F_0$ is any combination of
    products of integrals at 0, up to a weight or a degree.  With a weight $F_1, F_2, \dots$ are any polynomials; with a
    degree they are those of at most this degree.
    What has no correction has an obstruction, with a proof.  Polynomials in the Hamiltonian and in limits of Casimirs
    survive, but for a limit of the degree, and are not counted; they may be added to $F_0$.

    For several parameters the corrections are polynomials in them, and the answer is for which values there are some:
    `cases`, to all orders where the weights of coordinates and parameters are positive.  A change of the Hamiltonian is
    looked for with further parameters: "H + k1*l1 + k2*l2".

    Example:
        >>> top = lp.System(lp.so(3) @ lp.leibniz(3, "epsilon"), "dot(l, inv(I)*l)/2 - alpha1", {"I": [2, 2, 1]})
        >>> found = lp.deformations(top, parameter="epsilon", weight=4)
        >>> found.integrals, [str(o.start) for o in found.obstructions]
        ((), ['l.alpha', 'K'])

    Args:
        system: A system whose equations are polynomials in the coordinates and the parameters.  Other symbols count as
            generic.
        parameter: The parameter, or several.
        integrals: Integrals at 0 by name, besides H and the Casimirs; by default those that are known for this system.
        degree: The total degree of $F_0$ and of its corrections.
        weight: The largest weight of $F_0$ instead; 4 if neither it nor the degree is given.  The weights are those of
            the coordinates in which the parameter has the weight 0, if there are such.
        order: The highest order of corrections.
        time_limit: Seconds.

    Raises:
        ParameterError: the parameter is no symbol of the system, a function is no integral at 0, the equations are no
            polynomials or have no positive weights for a weight, or the search is too large.
        TimeLimitError: the time was over before anything was decided.
    """
    asked = SizeAsked.of(degree, 4 if degree is None and weight is None else weight)
    highest = as_count(order, "order", least=1, most=50)
    with as_deadline(time_limit).running():
        family = family_of(system, parameter, integrals, by_degree=asked.weight is None)
        family.check(asked.value, highest)
        found = _Found(replace(family, largest_degree=asked.value), highest)
        while starts := found.next_block(asked.value):
            found.look_at(starts)
    return found.result(asked)


class _Found:
    """What was found so far."""

    def __init__(self, family: Family, highest: int) -> None:
        self.given, self.family, self.highest = family, family, highest
        self.seen: set[tuple[int, ...]] = set()
        self.integrals: list[DeformedIntegral] = []
        self.obstructions: list[Obstruction] = []
        self.cases: list[DeformationCase] = []
        self.survivors: list[tuple[str, list[OnParameters]]] = []
        self.conditions: list[tuple[Expr, ...]] = []
        self.left: list[str] = []
        self.n_starts = 0
        self._blocks: list[Starts] | None = None

    def next_block(self, most: int) -> Starts | None:
        """The lightest block that was not looked at; of what survives in others, polynomials are trivial."""
        blocks = [b for b in self._starts(most) if b.others and b.label not in self.seen]
        return min(blocks, key=lambda b: (min(s.weight for s in b.others), b.label), default=None)

    def _starts(self, most: int) -> list[Starts]:
        if self._blocks is None:
            self._blocks = self.family.starts(most)
        return self._blocks

    def _survives(self, polynomial: Any) -> None:
        self.family, self._blocks = self.family.with_trivial(polynomial), None

    def look_at(self, starts: Starts) -> None:
        """One block of products of known integrals."""
        self.seen.add(starts.label)
        try:
            if len(self.family.parameters) == 1:
                self._one_parameter(starts)
            else:
                self._several(starts)
        except (TimeLimitError, NotDecidedError) as error:
            if not self.n_starts:
                raise
            names = ", ".join(Formula(s.name).plain for s in starts.others)
            self.left.append(f"not decided: {names} ({error})")
        self.n_starts += len(starts.others)

    def _one_parameter(self, starts: Starts) -> None:
        last = self.family.last_order(starts)
        highest = self.highest if last is None else max(1, min(self.highest, last))
        equations = OrderEquations(self.family, starts, highest)
        stopped: set[int] = set()
        solved = equations.solve(1)
        self._obstruct(starts, solved, 1, stopped)
        for order in range(2, highest + 1):
            if len(stopped) == len(starts.others):
                break
            solved = equations.solve(order)
            self._obstruct(starts, solved, order, stopped)
        if len(stopped) == len(starts.others):
            return
        exact = equations.solve(None)
        if last is not None and last <= self.highest:  # all orders: what is stopped after the last one
            self._obstruct(starts, exact, last + 1, stopped)
        closed = {max(vector) for vector, _ in exact.solutions}
        for vector, function in exact.solutions:
            if not self._is_trivial(starts, beginning := self.family.of_order(function, 0)):
                self.integrals.append(self._deformed(starts, vector, function, None))
                self._survives(beginning)
        for vector, function in solved.solutions:
            if max(vector) not in closed and max(vector) not in stopped:
                self.integrals.append(self._deformed(starts, vector, function, highest))

    def _is_trivial(self, starts: Starts, polynomial: Polynomial) -> bool:
        """Whether a start of a block is a polynomial in what survives."""
        blocks = self._starts(max(s.weight for s in starts.everything))
        known = (s.polynomial for block in blocks if block.label == starts.label for s in block.trivial)
        return not Echelon(self.family.derivation.field, known).insert(polynomial)

    def _deformed(
        self, starts: Starts, vector: dict[int, Any], function: dict[Any, Any], order: int | None
    ) -> DeformedIntegral:
        derivation = self.family.derivation
        if order is None:
            assert not derivation(function), "an exact solution"
        return DeformedIntegral(
            self._named(starts, vector), cast("Any", derivation.expression(function)).expand(), order
        )

    def _named(self, starts: Starts, vector: Mapping[int, Any]) -> Expr:
        given = starts.everything
        to_sympy = self.family.derivation.field.to_sympy
        return Add(*(Mul(to_sympy(c), given[k].name) for k, c in vector.items()))

    def _obstruct(self, starts: Starts, solved: Solved, order: int, stopped: set[int]) -> None:
        derivation = self.family.derivation
        for k, functional in zip(solved.missing, solved.functionals, strict=True):
            if k in stopped:
                continue
            stopped.add(k)
            self.obstructions.append(
                Obstruction(
                    starts.everything[k].name,
                    derivation.expression(starts.everything[k].polynomial),
                    starts.label,
                    order,
                    self._written(functional),
                    derivation.field.to_sympy(derivation.field.one),
                    solved.n_corrections,
                )
            )

    def _written(self, functional: Functional) -> dict[Expr, Expr]:
        derivation = self.family.derivation
        one = derivation.field.one
        return {derivation.expression({m: one}): derivation.field.to_sympy(c) for m, c in functional.items()}

    def _several(self, starts: Starts) -> None:
        equations = ParametricEquations(self.family, starts, self.highest)
        conditions = equations.solve()
        symbols = [Symbol(name) for name in conditions.names]
        for part in conditions.by_order:
            self.conditions.append(tuple(whole_expression(p.terms(), symbols) for p in part))
        coefficients = [Symbol(name) for name in equations.coefficients] or [1]
        start = Add(*(Mul(c, s.name) for c, s in zip(coefficients, starts.others, strict=True)))
        names = {str(s) for one in starts.others for s in one.name.free_symbols} - self.family.trivial.keys()
        found = [(part, *equations.plain(part, function)) for part, function in equations.cases(conditions)]
        for component, equal, function, n_free in sorted(found, key=lambda one: len(one[1])):
            if all(
                any(name == other and equations.contains(component, there) for other, there in self.survivors)
                for name in names
            ):
                continue  # a polynomial in integrals that survive there
            is_exact = equations.holds(function, component)
            if is_exact and isinstance(start, Symbol) and (there := equations.on_parameters(equal)) is not None:
                self.survivors.append((str(start), there))
                if not there:
                    self._survives(starts.others[0].polynomial)
            self.cases.append(
                DeformationCase(
                    start,
                    tuple(whole_expression(p.terms(), symbols) for p in equal),
                    self._expression(function, symbols),
                    is_exact,
                    component.dimension - n_free,
                )
            )

    def _expression(self, function: Parametric, symbols: Sequence[Symbol]) -> Expr:
        terms = (((*m, *map(int, q)), c) for m, p in function.items() for q, c in p.terms())
        return expression_of(terms, (*self.family.system.variables, *symbols), rational_to_sympy)

    def result(self, asked: SizeAsked) -> Deformations:
        """The answer."""
        family, derivation = self.given, self.given.derivation
        terms = family.hamiltonian_terms
        variables = derivation.variables
        what = "degree" if asked.weight is None else "weight"
        heavier = [
            f"not looked at: {name}, of {what} {size}"
            for name, f in family.known.items()
            if name not in family.trivial and (size := family.weight(f)) > asked.value
        ]
        weights = dict(zip(map(str, variables), family.positive.weights, strict=True)) if family.positive else {}
        return Deformations(
            system=family.system,
            parameters=tuple(map(str, family.parameters)),
            known={name: derivation.expression(f) for name, f in family.known.items()},
            trivial={name: derivation.expression(f) for name, f in family.trivial.items()},
            degree=asked.degree,
            weight=asked.weight,
            weights=weights,
            order=self.highest,
            integrals=tuple(self.integrals),
            obstructions=tuple(self.obstructions),
            cases=tuple(self.cases),
            conditions=tuple(self.conditions),
            hamiltonian_terms=None
            if terms is None
            else tuple(Mul(*(x**k for x, k in zip(family.system.variables, m, strict=True) if k)) for m in terms[0]),
            n_starts=self.n_starts,
            left=(*self.left, *heavier),
        )
