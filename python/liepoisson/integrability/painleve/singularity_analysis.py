r"""The Kovalevskaya-Painlevé test: are the singularities of solutions in complex time poles?

A solution with a movable singularity at $\tau = t - t_0 = 0$ is looked for as $x_i = \tau^{-g_i}(c_i + \dots)$ with
the leading terms of a **balance**.  The **Kovalevskaya exponents** of the balance are the orders at which free
constants may enter.  Where all solutions are single-valued, each balance has whole exponents, no Jordan blocks, and
series without logarithms.

References: [lyapunov1894]; [ablowitz1980]; [yoshida1983]; [adler1989]; [goriely2001], chapter 3.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from re import findall
from typing import Any, Literal, TypeAlias

from sympy import Expr, Symbol

from liepoisson.algebra.function_fields import polynomial_at
from liepoisson.algebra.ideals.components import Assumptions, Component, components
from liepoisson.algebra.ideals.coordinate_ring import CoordinateRing, DivisionError, Resolvent
from liepoisson.algebra.ideals.groebner import new_name
from liepoisson.algebra.ideals.limits import Budget, Limits, NotDecidedError
from liepoisson.algebra.ideals.operations import radical_contains
from liepoisson.algebra.matrices import characteristic_polynomial
from liepoisson.errors import ParameterError, TimeLimitError
from liepoisson.formula.parameters import read_parameter
from liepoisson.formula.scalars import MOST, as_deadline
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import SEARCH_LIMIT
from liepoisson.inputs.given import listed, named
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.algebraic_functions import algebraic_equations
from liepoisson.integrability.derivation import Derivation, derivation_of_rates
from liepoisson.integrability.painleve.balance import Balance, as_record, obstructions_of
from liepoisson.integrability.painleve.expansion import Expansion, OverField, OverRing, expand, exponents_of
from liepoisson.integrability.painleve.generic_points import GenericPoint, generic_points, of_family, random_points
from liepoisson.integrability.painleve.quasi_homogeneous import (
    LocalField,
    QuasiHomogeneous,
    excess,
    inequalities,
    maximal_weights,
)
from liepoisson.io.display import as_text
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.report.printing import Formula

Verdict: TypeAlias = Literal["passes", "passes weakly", "fails", "undecided", "no balances"]

SCOPE: dict[Verdict, str] = {
    "passes": (
        "all exponents are whole and all series found are free of logarithms. This is necessary for single-valued "
        "solutions and proves neither that they are, nor that the system is integrable"
    ),
    "passes weakly": (
        "all series found are free of logarithms, in powers of roots of t: finitely many branches at each singularity. "
        "Not all solutions are single-valued in these coordinates; nothing is said on integrability"
    ),
    "fails": (
        "not all solutions are single-valued functions of complex time. This proves nothing on integrability by "
        "integrals that are themselves multi-valued"
    ),
    "undecided": "no obstruction was found, and not everything was decided; see what is left",
    "no balances": "no solutions with singularities of this kind: the test says nothing",
}

_SIMPLE_DEGREE = 2
"""Degree of the field of a family up to which it is parametrised; others are treated in their coordinate rings."""

Weights: TypeAlias = "Mapping[str, Any] | Sequence[Any]"


@dataclass(frozen=True, repr=False)
class PainleveTest:
    """What the test of Kovalevskaya and Painlevé says of a system.

    Example:
        >>> found = lp.integrability.painleve_test(lp.catalog.system("henon-heiles"))
        >>> found.verdict, found.complete, len(found.balances)
        ('fails', True, 2)

    Attributes:
        system: The system.
        variables: The coordinates of the polynomial equations that were tested, and variables for functions of them.
        functions: The functions that variables stand for, by their names; empty for polynomial equations.
        weights: The choices of the orders of poles, each one order for each coordinate.
        balances: All balances for these weights.
        special: Conditions on symbols of the system under which there are other balances, which were not looked at.
        left: What was not decided; empty if nothing is.
    """

    system: EquationsOfMotion
    variables: tuple[Symbol, ...]
    functions: dict[str, Expr] = field(hash=False)
    weights: tuple[tuple[Fraction, ...], ...]
    balances: tuple[Balance, ...]
    special: tuple[str, ...]
    left: tuple[str, ...]

    @property
    def verdict(self) -> Verdict:
        """The verdict; `scope` says what it means."""
        found = {balance.status for balance in self.balances}
        if "fails" in found:
            return "fails"
        if "undecided" in found or self.left:
            return "undecided"
        if not self.balances:
            return "no balances"
        return "passes weakly" if "passes weakly" in found else "passes"

    @property
    def complete(self) -> bool:
        """Whether everything was decided."""
        return not self.left and all(balance.status != "undecided" for balance in self.balances)

    @property
    def scope(self) -> str:
        """What the verdict means, in words."""
        text = SCOPE[self.verdict]
        if self.verdict in {"passes", "passes weakly"} and not any(b.is_principal for b in self.balances):
            text += ". No series has the constants of a general solution, whose singularities may be of another kind"
        if any(balance.is_negative for balance in self.balances) and self.verdict.startswith("passes"):
            text += ". Negative exponents besides -1 were tested on the variational equation alone"
        if self.functions:
            text += ". The variables stand for functions of the coordinates, which may branch though these do not"
        if self.derived_from_symbols:
            text += ". For general values of the symbols"
        return text

    @property
    def derived_from_symbols(self) -> bool:
        """Whether the system has symbols, for general values of which the verdict holds."""
        return any(balance.symbols for balance in self.balances)

    def __repr__(self) -> str:
        n = len(self.balances)
        return f"<PainleveTest of {self.system.name}: {self.verdict}, {n} balance{'s' * (n != 1)}>"

    def __str__(self) -> str:
        """The balances with their exponents, and the verdict with its scope."""
        lines = [f"{self.system.name}: Kovalevskaya-Painlevé test"]
        if self.functions:
            lines.append(f"with {', '.join(f'{name} = {Formula(f).plain}' for name, f in self.functions.items())}")
        number = 0
        for weights in self.weights:
            lines.append(f"orders of poles: {_words(self.variables, weights)}")
            for balance in self.balances:
                if balance.weights == weights:
                    number += 1
                    lines.append(f"{number}. {balance}")
        if not self.balances:
            lines.append("no balances")
        lines += [f"not looked at: balances for {text}" for text in self.special]
        lines += [f"left: {text}" for text in self.left]
        return "\n".join([*lines, f"verdict: {self.verdict}", f"{self.scope}."])

    def _repr_html_(self) -> str:
        """What a notebook shows: the text."""
        return as_text(str(self))


def _words(variables: Sequence[Symbol], weights: Sequence[Fraction]) -> str:
    groups: dict[Fraction, list[str]] = {}
    for v, w in zip(variables, weights, strict=True):
        groups.setdefault(w, []).append(str(v))
    return "; ".join(f"{w} for {', '.join(names)}" for w, names in groups.items())


@shows_progress
def painleve_test(
    system: EquationsOfMotion,
    *,
    weights: Weights | None = None,
    time_limit: float = SEARCH_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> PainleveTest:
    r"""The Kovalevskaya-Painlevé test: balances, exponents, resonances, logarithms, and the verdict.

    For a polynomial vector field, $x_i = \tau^{-g_i}\sum_k c_i^{(k)}\tau^k$ with $\tau = t - t_0$. All balances for the
    maximal orders g are found exactly, families of balances as families; exponents are the eigenvalues of
    $K = \partial\hat f/\partial x(c) + \operatorname{diag}(g)$, $\hat f$ being the dominant part of the equations. At
    each rational exponent the dimension of the kernel is compared with the multiplicity, and at positive ones the
    series is computed, with symbols for its free constants.

    Example:
        >>> found = lp.integrability.painleve_test(lp.catalog.system("henon-heiles-kdv"))
        >>> [list(map(int, balance.exponents)) for balance in found.balances], found.verdict
        ([[-1, 1, 4, 6], [-3, -1, 6, 8]], 'passes')

    Args:
        system: A system or vector field with rational numbers, and perhaps symbols, in its equations. Where these
            contain roots, exponentials or trigonometric functions, variables stand for them as in `first_integrals`.
        weights: Orders of poles, by name of the coordinate or in the order of the state; by default all maximal ones.
        time_limit: Seconds after which what is left is named; the balances that were found are in the result.
        progress: As for `integrate`.

    Raises:
        TimeLimitError: there was no time to read the equations.
        ParameterError: numbers in the equations are not rational, the equations contain other functions, weights do not
            fit them, or there are too many choices of weights.
    """
    deadline, listen = as_deadline(time_limit), progress or (lambda _: None)
    with deadline.running():
        derivation, functions = _equations(system)
        analysis = _Analysis(Limits(work=max(1, int(min(deadline.seconds * 1e6, MOST)))).budget())
        try:
            chosen = maximal_weights(derivation) if weights is None else (_read(weights, derivation),)
        except TimeLimitError as error:
            chosen = ()
            analysis.left.append(f"balances with the orders of leading terms, which are not known: {error}")
        for k, one in enumerate(chosen):
            analysis.run(QuasiHomogeneous.of(derivation, one), lambda f, k=k: listen((k + f) / len(chosen)))
    return PainleveTest(
        system=system,
        variables=derivation.variables,
        functions=functions,
        weights=chosen,
        balances=tuple(analysis.balances),
        special=tuple(dict.fromkeys(analysis.special)),
        left=tuple(analysis.left),
    )


def _equations(system: EquationsOfMotion) -> tuple[Derivation, dict[str, Expr]]:
    """The polynomial equations that are tested."""
    found, _ = algebraic_equations(system)
    derivation = found.derivation
    field = derivation.field
    ring: Any = getattr(field.domain, "domain", None)
    if not field.is_rational and not (field.parameters and (ring.is_QQ or ring.is_ZZ)):
        raise ParameterError(
            f"painleve_test: wanted rational numbers and symbols in the equations; got {system.name} with "
            f"{', '.join(map(str, field.parameters)) or 'irrational ones'}; give rational values, or a symbol for each"
        )
    if any(not s.is_Symbol for s in field.parameters):
        raise ParameterError(
            f"painleve_test: wanted rational numbers and symbols in the equations of {system.name}; got "
            f"{', '.join(str(s) for s in field.parameters if not s.is_Symbol)}; write a symbol for each"
        )
    if not found.functions:
        return derivation, {}
    # coordinates that only occur in functions follow the others by quadrature
    used = {k for component in derivation.components for m in component for k, power in enumerate(m) if power}
    kept = [k for k, v in enumerate(derivation.variables) if k in used or v in found.functions]
    # variables that stand for functions have names, too
    taken = list(map(str, system.variables))
    written: dict[Any, Any] = {v: Symbol(new_name(taken, v.name)) for v in found.functions}
    rates: list[Any] = [derivation.expression(derivation.components[k]).xreplace(written) for k in kept]
    variables = [written.get(v, v) for k, v in enumerate(derivation.variables) if k in kept]
    smaller, _ = derivation_of_rates(variables, rates)
    return smaller, {str(written[v]): f for v, f in found.functions.items()}


def _read(weights: Weights, derivation: Derivation) -> tuple[Fraction, ...]:
    """Weights that a caller gives, checked."""
    names = list(map(str, derivation.variables))
    wanted = f"weights: wanted one for each of {', '.join(names)}"
    if (by_name := named(weights, "weights")) is not None:
        if set(by_name) != set(names):
            raise ParameterError(f"{wanted}; got {shown(', '.join(map(str, by_name)))}")
        given = [by_name[name] for name in names]
    else:
        given = listed(weights, "weights") or []
        if len(given) != len(names):
            raise ParameterError(f"{wanted}; got {shown(weights)}")
    try:
        numbers = [read_parameter(w, "weights") for w in given]
    except ParameterError as error:
        raise ParameterError(f"{wanted}, rational numbers; got {shown(given)}") from error
    read = tuple(w for w in numbers if isinstance(w, Fraction))
    if len(read) < len(numbers):
        raise ParameterError(f"{wanted}, rational numbers; got {shown(given)}")
    if any(w < 0 for w in read):
        raise ParameterError(f"{wanted}, none negative; got {shown(weights)}; a coordinate without a pole has 0")
    if (found := excess(inequalities(derivation), read)) > 1:
        raise ParameterError(
            "weights: wanted orders of poles g with weight(term) <= g + 1 for each term of the rate of a coordinate; "
            f"got a term that exceeds its coordinate by {found}; leave them out for all that fit"
        )
    return read


class _Analysis:
    """Finds the balances for one choice of weights after the other."""

    def __init__(self, budget: Budget) -> None:
        self.budget = budget
        self.balances: list[Balance] = []
        self.special: list[str] = []
        self.left: list[str] = []

    def run(self, system: QuasiHomogeneous, listen: Callable[[float], Any]) -> None:
        """Test all balances for the weights of a system."""
        words = _words(system.derivation.variables, system.weights)
        half = Budget(Limits(max(1, self.budget.limits.work // 2), self.budget.limits.degree))
        try:
            parts = components(system.indicial_equations(), Assumptions(system.denominators), half)
        except (NotDecidedError, TimeLimitError) as error:
            self.left.append(f"balances with the orders {words}: {error}")
            return
        singular = [part for part in parts if not self._is_regular(part, system)]
        for k, part in enumerate(sorted(singular, key=lambda part: (part.degree, str(part.equations)))):
            listen(k / len(singular))
            self._test_part(part, system)

    def _is_regular(self, part: Component, system: QuasiHomogeneous) -> bool:
        """Whether no coordinate has a pole."""
        gens = system.context.gens()
        return all(radical_contains(part.basis, gens[k], self.budget) for k, g in enumerate(system.weights) if g)

    def _test_part(self, part: Component, system: QuasiHomogeneous) -> None:
        equations = tuple(str(p) for p in part.equations)
        described = ", ".join(f"{e} = 0" for e in equations[:6]) + (", ..." if len(equations) > 6 else "")
        try:
            tested = self._balances(part, system, equations)
        except (NotDecidedError, TimeLimitError) as error:
            self.left.append(f"the balances {described}: {error}")
            return
        if not tested and system.parameter_names:
            names = set(map(str, system.derivation.variables))
            conditions = [e for e in equations if not names & set(findall(r"[^\W\d]\w*", e))]
            self.special.append(", ".join(f"{e} = 0" for e in conditions) or described)
        self.balances += tested

    def _balances(self, part: Component, system: QuasiHomogeneous, equations: tuple[str, ...]) -> list[Balance]:
        """The balances of a component of the solutions of the indicial equations."""
        if not part.dimension or system.parameter_names:
            return self._of_points(generic_points(part, system.parameter_names, self.budget), part, system, equations)
        try:
            return self._of_points(generic_points(part, (), self.budget, most=_SIMPLE_DEGREE), part, system, equations)
        except NotDecidedError:
            pass
        names = [name for name, g in zip(system.context.names(), system.weights, strict=False) if g]
        try:
            whole = of_family(part, names, self.budget)
            return [self._tested(whole, part, system, equations)]
        except (_NotConstantError, DivisionError):
            # exponents that vary along a family: at a random member they show that solutions branch
            samples = random_points(part.basis, self.budget)
            found = self._of_points(samples, part, system, equations)
            if any(balance.status == "fails" for balance in found):
                return found
        return self._of_points(generic_points(part, (), self.budget), part, system, equations)

    def _of_points(
        self, points: Sequence[GenericPoint], part: Component, system: QuasiHomogeneous, equations: tuple[str, ...]
    ) -> list[Balance]:
        names = [name for name, g in zip(system.context.names(), system.weights, strict=False) if g]
        singular = [p for p in points if any(p.values[name] for name in names)]
        return [self._tested(p, part, system, equations) for p in singular]

    def _tested(
        self, point: GenericPoint, part: Component, system: QuasiHomogeneous, equations: tuple[str, ...]
    ) -> Balance:
        """One balance, or one family, with what the test says."""
        field = point.field
        names = system.context.names()
        values = [point.values[name] for name in names[: system.n]]
        local = LocalField.of(system, field, point.values)
        assert not any(polynomial_at(e, point.values, field) for e in system.indicial_equations()), equations
        matrix = local.kovalevskaya_matrix(values)
        characteristic = characteristic_polynomial(matrix, field.number)
        ring = field if isinstance(field, CoordinateRing) else None
        if ring is not None and any(field.rational(c) is None for c in characteristic):
            raise _NotConstantError
        exponents = exponents_of(characteristic, field)
        # a part of a component may be of smaller dimension
        dimension = ring.basis.dimension if ring else len(field.parameters) if point.is_generic else part.dimension
        dimension -= len(system.parameter_names)
        left = "" if point.is_generic else "a random member of the family was tested, and the others are not decided"
        series: Expansion | None = None
        if ring is None or exponents.all_rational:
            equations_of_order = (
                OverField(matrix, field)
                if ring is None or point.sample is None
                else OverRing(
                    ring, Resolvent(matrix, exponents.rational, ring), point.sample.values, point.sample.field
                )
            )
            try:
                series = expand(local, values, equations_of_order, exponents)
            except TimeLimitError:
                left = "the series: the time limit was reached"
        resonances = () if series is None else tuple(series.resonances)
        family = tuple(name for name in names[: system.n] if name in field.parameters)
        if len(family) < dimension:
            family = tuple(f"parameter {k + 1}" for k in range(dimension))
        return Balance(
            variables=system.derivation.variables,
            weights=system.weights,
            equations=equations,
            family=family,
            n_conjugates=field.degree,
            kovalevskaya=exponents,
            resonances=resonances,
            is_generic=point.is_generic,
            obstructions=obstructions_of(exponents, resonances, dimension),
            left=left,
            _point=tuple(values),
            _field=field,
            _parameters=system.parameter_names,
            _expansion=series,
        )


class _NotConstantError(Exception):
    """Exponents depend on the member of a family."""


def record(found: PainleveTest) -> dict[str, Any]:
    """The result as data that JSON can write."""
    return {
        "system": found.system.name,
        "functions": {name: Formula(f).plain for name, f in found.functions.items()},
        "weights": [{str(v): str(w) for v, w in zip(found.variables, one, strict=True)} for one in found.weights],
        "balances": [as_record(balance) for balance in found.balances],
        "special": list(found.special),
        "left": list(found.left),
        "verdict": found.verdict,
        "scope": found.scope,
    }
