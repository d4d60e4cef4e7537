r"""Systems with damping that keeps the geometry: $\dot x = J\nabla H + F$, with F derived from the bracket."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, cast, get_args

from liepoisson.algebra.exact_numbers import substituted, to_sympy
from liepoisson.compile.typed import Names, names_of
from liepoisson.damping.damping_vector import (
    DampingVector,
    killing_metric,
    of_double_bracket,
    of_kulkarni_nomizu,
    of_lie_bracket,
    of_matrix,
    weakest,
)
from liepoisson.damping.symmetric_forms import FormLike, Known, Sign, form_entries, never_negative, read_form
from liepoisson.errors import BracketError, ExpressionError, ParameterError
from liepoisson.formula.parameters import GivenValue, Parameter, flattened, read_kept_values, read_parameter
from liepoisson.formula.scope import read_declaration
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.given import listed
from liepoisson.inputs.names import MAX_TITLE
from liepoisson.inputs.read_only import ReadOnlyDict
from liepoisson.inputs.refusals import not_a, not_a_system, shown
from liepoisson.model.free_parameter import with_values
from liepoisson.model.hamiltonian import RESERVED_NAME, is_expression, read_declarations, scope_of
from liepoisson.model.system import System
from liepoisson.model.system_text import formula_text
from liepoisson.model.vector_field import VectorField
from liepoisson.structure.given_expressions import check_real, read_expression_in, with_exact_numbers

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray
    from sympy import Expr, Matrix

    from liepoisson.formula.scope import Scope

Kind = Literal["double bracket", "metriplectic"]
KILLING = "killing"
_MOST_SHOWN = 60
"""Characters of a Casimir in a message."""


@explains_its_methods
@dataclass(frozen=True)
class Damping:
    """Damping as it was given: numbers, texts in the names of a system, or expressions.

    Example:
        >>> lp.dissipation.double_bracket(lp.catalog.system("heavy-top"), "1/10").damping
        Damping(kind='double bracket', rate='1/10', entropy=None, metric=None, forms=None, matrix=None)

    Attributes:
        kind: "double bracket" or "metriplectic".
        rate: What the damping vector is multiplied with.
        entropy: Of a metriplectic flow: the entropy, a Casimir, by name or formula.
        metric: A symmetric form, its diagonal, "killing", or None for the identity.
        forms: Of a metriplectic flow: two symmetric forms on gradients, of which the 4-bracket is the product.
        matrix: Of a metriplectic flow: the symmetric bracket itself.
    """

    kind: Kind
    rate: Any = 1
    entropy: Any = None
    metric: Any = None
    forms: Any = None
    matrix: Any = None


@explains_its_methods
@dataclass(frozen=True)
class Law:
    """What a function of the state does along the motion.

    Example:
        >>> body = lp.dissipation.double_bracket(lp.catalog.euler_top_on("so(3)", [1, 2, 3]), "1/10")
        >>> for law in body.laws:
        ...     print(law)
        H falls (proved)
        C1 is constant (proved)

    Attributes:
        quantity: Its name.
        motion: "constant", "falls" or "rises".
        known: "proved" in exact numbers; "sampled" where functions that are not rational were tried at points in 50
            digits, or a sign depends on the state and was tried at 10 states; "undecided" where it depends on
            parameters without a value.
    """

    quantity: str
    motion: Literal["constant", "falls", "rises"]
    known: Known

    def __str__(self) -> str:
        verb = "is constant" if self.motion == "constant" else self.motion
        return f"{self.quantity} {verb} ({self.known})"


@explains_its_methods
class DampedSystem(VectorField):
    r"""A Hamiltonian system with damping that keeps the geometry, $\dot x = J\nabla H + F$.

    `double_bracket` and `metriplectic` make it. Orbits, sections, exponents, sweeps and files take it like a
    `VectorField`; it also knows the system that is damped, what it keeps, and what only falls or rises.

    Example:
        >>> body = lp.dissipation.double_bracket(lp.catalog.euler_top_on("so(3)", [1, 2, 3]), "1/10")
        >>> body, list(body.invariants), list(body.falling)
        (<DampedSystem 'damped Euler top on so(3)' in l1, l2, l3>, ['C1'], ['H'])

    Args:
        undamped: The system.
        damping: What is added to its equations.
        parameters: Values of further names in the formulas of the damping.
        symbols: Further names that stay symbolic.
        name: How it is called; by default "damped ..." after the system.

    Raises:
        ParameterError: as for `double_bracket` and `metriplectic`.
        BracketError: the entropy is no Casimir.
        ShapeError: a matrix has another shape than (N, N).
        ExpressionError: a formula is not in the grammar, or a name in it is not known.

    References: [bloch1996]; [morrison2024].
    """

    _why_missing: ClassVar[str] = "; the system without damping has it: system.undamped"

    @explains_its_arguments
    def __init__(
        self,
        undamped: System,
        damping: Damping,
        parameters: Mapping[str, GivenValue] | None = None,
        *,
        symbols: Sequence[str] = (),
        name: str | None = None,
    ) -> None:
        _check_system(undamped)
        if not isinstance(damping, Damping) or damping.kind not in get_args(Kind):  # pyright: ignore[reportUnnecessaryIsInstance]
            kinds = " or ".join(map(repr, get_args(Kind)))
            raise not_a(f"a Damping of the kind {kinds}", damping, "damping", "write double_bracket(system, rate)")
        self.undamped: System = undamped
        self.damping: Damping = _kept(damping, undamped.component_names)
        values = {**undamped.values, **_own_values(undamped, parameters)}
        declared = (*undamped.as_given.symbols, *read_declarations(symbols))
        self._scope: Scope = scope_of(undamped.symbolic_bracket, values, declared)
        self._read_names: set[str] = set()
        self._flat: dict[str, Any] = flattened(read_kept_values(values))
        self.rate: Expr = self._formula(damping.rate, "rate")
        self._sign_of_rate = self._checked_rate()
        self.entropy: Expr | None = None if damping.kind == "double bracket" else self._entropy(damping.entropy)
        self._added = self._derived()
        unused = [own for own in values if own not in undamped.values and not self.is_of_damping(own)]
        if unused:
            raise ParameterError(f"parameters: {unused[0]} occurs nowhere in the damping; leave it out")
        added: Any = [self.rate * entry for entry in self._added.vector]
        rates = {str(x): v + f for (x, v), f in zip(undamped.equations.items(), added, strict=True)}
        free = {str(s) for rate in rates.values() for s in rate.free_symbols} - {*undamped.component_names}
        known = {*self._scope.shapes, *self._scope.components}
        title = f"damped {undamped.name}"
        super().__init__(
            rates,
            values,
            name=name if name is not None else title if len(title) <= MAX_TITLE else undamped.name,
            symbols=(*declared, *sorted(free - known)),
            angles=undamped.bracket.angles,
            source=undamped.source,
        )

    def _at_values(self, values: Mapping[str, GivenValue]) -> Self:
        """The same with these values of all parameters, those of the system and those of the damping."""
        own = {name: value for name, value in values.items() if name not in self.undamped.values}
        of_system: Any = flattened(read_kept_values({name: values[name] for name in self.undamped.values}))
        undamped = with_values(self.undamped, of_system)
        symbols = [text for text in self.as_given.symbols if self.is_of_damping(read_declaration(text)[0])]
        found: Any = DampedSystem(undamped, self.damping, own, symbols=symbols, name=self.name)
        return found

    def _derived(self) -> DampingVector:
        given, system = self.damping, self.undamped
        names = system.component_names
        if given.kind == "double bracket":
            self.metric = self._metric(on_velocities=True)
            return of_double_bracket(system, self.metric)
        entropy: Any = self.entropy
        if given.matrix is not None:
            return of_matrix(system, entropy, read_form(given.matrix, names, "matrix", self._formula))
        if given.forms is not None:
            sigma, mu = (
                read_form(form, names, f"forms: the {which}", self._formula)
                for form, which in zip(given.forms, ("first", "second"), strict=True)
            )
            return of_kulkarni_nomizu(system, entropy, sigma, mu)
        if not system.bracket.is_linear:
            raise BracketError(
                f"metriplectic: the 4-bracket of a Lie algebra needs a linear bracket; {system.bracket!r} is none; "
                "give forms=(sigma, mu), two symmetric matrices"
            )
        return of_lie_bracket(system, entropy, self._metric(on_velocities=False))

    metric: Matrix | None = None
    """The form g of a double bracket, with the values of the parameters, shape (N, N)."""

    def _metric(self, *, on_velocities: bool) -> Matrix:
        from sympy import eye

        given, bracket = self.damping.metric, self.undamped.bracket
        if given is None:
            return eye(bracket.dimension)
        if isinstance(given, str):
            if given.strip().lower() != KILLING:
                raise not_a('a symmetric matrix, its diagonal or "killing"', given, "metric", 'write metric="killing"')
            return killing_metric(bracket, on_velocities=on_velocities)
        return read_form(given, bracket.coordinate_names_in_order, "metric", self._formula)

    def _formula(self, given: Any, name: str) -> Expr:
        """A number or a function of the state, with the values of the parameters."""
        if isinstance(given, str):
            from liepoisson.formula.expression import read_expression

            try:
                read: Any = read_expression(given, self._scope)
            except ExpressionError as error:
                raise ExpressionError(f"{name}: {error.message}", error.text, error.position) from None
        elif is_expression(given):
            coordinates = self.undamped.component_names
            others = self._scope.numbers() - {*coordinates}
            read = with_exact_numbers(read_expression_in(given, coordinates, others, self._flat))
            check_real(read, name)
        else:
            read = to_sympy(read_parameter(given, name))
        self._read_names |= {str(symbol) for symbol in read.free_symbols}
        return to_sympy(substituted(read, self._flat))

    def is_of_damping(self, name: str) -> bool:
        """Whether a parameter occurs in the damping."""
        return any(self._scope.owner(symbol) == name for symbol in self._read_names)

    def _checked_rate(self) -> Sign:
        sign = never_negative(self.rate, self.undamped.variables)
        if sign.negative_at is not None:
            place = f", which is negative at {sign.negative_at}" if sign.negative_at else ""
            raise ParameterError(
                f"rate: wanted one that is never negative, with which damping never drives; got {self.rate}{place}; "
                "change its sign, or write its square"
            )
        return sign

    def _entropy(self, given: Any) -> Expr:
        """The entropy, which must be a Casimir.

        Raises:
            BracketError: it is none.
        """
        bracket = self.undamped.bracket
        casimirs = {f"C{k}": casimir for k, casimir in enumerate(bracket.casimirs(), start=1)}
        if isinstance(given, str) and given.strip() in casimirs:
            return casimirs[given.strip()]
        texts = {name: formula_text(casimir) for name, casimir in casimirs.items()}
        known = ", ".join(f"{name} = {text:.{_MOST_SHOWN}}" for name, text in texts.items())
        if isinstance(given, str) and RESERVED_NAME.fullmatch(given.strip()):
            raise BracketError(
                f"entropy: wanted a Casimir of {self.undamped.name}; got {given}; "
                + (f"try one of {known}" if known else "none is known: a metriplectic flow needs one")
            )
        entropy = self._formula(given, "entropy")
        certificate = bracket.casimir_certificate(entropy, symbols=sorted(map(str, entropy.free_symbols)))
        if not certificate.holds:
            short = next((text for text in texts.values() if len(text) <= _MOST_SHOWN), None)
            example = f' in coordinates, such as entropy="({short})^2"' if short else " in coordinates"
            raise BracketError(
                f"entropy: wanted a Casimir, which the motion without damping keeps; {certificate}; "
                + (
                    f'try entropy="C1", or a function of {known}{example}'
                    if known
                    else "this bracket has none that is known"
                )
            )
        if not any(bracket.gradient(entropy)):
            raise BracketError(f"entropy: wanted a Casimir that depends on the state; got {entropy}; try {known}")
        return entropy

    @property
    def parts_of_state(self) -> tuple[str, ...]:
        """The fields of the bracket."""
        return self.undamped.parts_of_state

    @property
    def vector_length(self) -> int:
        """Number of components of each field of the bracket."""
        return self.undamped.vector_length

    @cached_property
    def invariants(self) -> dict[str, Expr]:
        """What is kept: with a double bracket the Casimirs, with a metriplectic flow H; and known integrals, if so."""
        double = self.entropy is None
        found: dict[str, Expr] = {}
        for name, function in self.undamped.invariants.items():
            is_casimir = name.startswith("C") and name[1:].isdigit()
            kept = is_casimir if double else name == "H"
            if kept or (not self.rate if double and name == "H" else self.is_constant(function)):
                found[name] = function
        return ReadOnlyDict(found)

    @cached_property
    def falling(self) -> dict[str, Expr]:
        r"""What never rises: with a double bracket H, $\dot H = -\gamma|J\nabla H|_g^2$."""
        return ReadOnlyDict({"H": self.undamped.hamiltonian} if self.entropy is None and self.rate else {})

    @cached_property
    def rising(self) -> dict[str, Expr]:
        r"""What never falls: of a metriplectic flow the entropy S, $\dot S = \gamma|\nabla S|_G^2$."""
        return ReadOnlyDict({"S": self.entropy} if self.entropy is not None and self.rate else {})

    def one_way_values(self, states: ArrayLike) -> dict[str, tuple[NDArray[np.float64], int]]:
        """What only falls or rises at many states, and its sign: -1 for what falls.

        Args:
            states: Shape (..., N), dimensionless.

        Returns:
            By name an array of shape (...) and the sign.

        Raises:
            ShapeError: the last axis of `states` is not N.
            ParameterError: a parameter is symbolic.
        """
        functions = {name: (f, -1) for name, f in self.falling.items()}
        functions |= {name: (f, 1) for name, f in self.rising.items()}
        values = self._evaluate([f for f, _ in functions.values()], states)
        return {name: (found, sign) for (name, (_, sign)), found in zip(functions.items(), values, strict=True)}

    @property
    def production(self) -> Expr:
        r"""The rate at which H falls, $\gamma|J\nabla H|_g^2$, or the entropy rises, $\gamma|\nabla S|_G^2$."""
        return self.rate * self._added.production

    @cached_property
    def laws(self) -> tuple[Law, ...]:
        """What falls, rises and stays, and how that is known."""
        sign = weakest(self._added.definite, self._sign_of_rate.known)
        found = [Law(name, "falls", sign) for name in self.falling]
        found += [Law(name, "rises", sign) for name in self.rising]
        for name, function in self.invariants.items():
            known: Known = "proved"  # by `is_constant`
            if self.entropy is None and name.startswith("C") and name[1:].isdigit():
                free = sorted(str(symbol) for symbol in cast("Any", function).free_symbols)
                certificate = self.undamped.bracket.casimir_certificate(function, symbols=free)
                known = "proved" if certificate.proved else "sampled"
            elif self.entropy is not None and name == "H":
                known = self._added.degenerate
            found.append(Law(name, "constant", known))
        return tuple(found)

    def file_text(self) -> str:
        """The text of a file from which `read_system` gives the same damped system.

        Raises:
            SystemFileError: it cannot be written.
        """
        from liepoisson.damping.damped_file import damped_text

        return damped_text(self)

    def _scope_with(self, *further: str) -> Scope:
        values = cast("Mapping[str, GivenValue]", self._kept_values)
        return scope_of(self.undamped.symbolic_bracket, values, (*self._given_symbols, *further))

    @property
    def _names_of_state(self) -> Names:
        return names_of(self.undamped.bracket)

    @property
    def _given_functions(self) -> dict[str, str | Expr]:
        found: dict[str, str | Expr] = {"H": self.undamped.hamiltonian}
        return found if self.entropy is None else {**found, "S": self.entropy}

    def _check_that_parameters_occur(self, equations: Sequence[Expr]) -> None:
        """Not in the equations, in which they have their values; that they occur in what these come from is known."""

    def __str__(self) -> str:
        """The system, the damping, the equations and what is known of the motion."""
        from liepoisson.model.system_text import formula_text

        given = self.damping
        lines = [
            f"{self.name}",
            f"  bracket      {self.undamped.bracket!r}",
            f"  Hamiltonian  H = {formula_text(self.undamped.hamiltonian)}",
            f"  damping      {given.kind}, rate {formula_text(self.rate)}"
            + ("" if self.entropy is None else f", entropy S = {formula_text(self.entropy)}"),
            "  equations",
            *(f"    {x}' = {formula_text(cast('Any', rate).expand())}" for x, rate in self.equations.items()),
            "  laws",
            *(f"    {law}" for law in self.laws),
        ]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<DampedSystem {self.name!r} in {', '.join(self.component_names)}>"


@explains_its_arguments
def double_bracket(
    system: System,
    rate: Parameter = 1,
    *,
    metric: FormLike | Literal["killing"] | None = None,
    parameters: Mapping[str, GivenValue] | None = None,
    symbols: Sequence[str] = (),
    name: str | None = None,
) -> DampedSystem:
    r"""The system with double-bracket dissipation: the energy falls, and all Casimirs are kept.

    $$\dot x = J\nabla H + \gamma\,J g J\nabla H, \qquad \dot H = -\gamma\,|J\nabla H|_g^2 \le 0,$$

    since $J^T = -J$; what is added lies in the image of J, the tangent space of the leaf. For a rigid body and the
    identity g it is $\dot\ell = \ell\times\omega + \gamma\,\ell\times(\ell\times\omega)$.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> orbit = lp.integrate(lp.dissipation.double_bracket(body, "1/10"), [1, 1, 1], t_end=1000)
        >>> (orbit.end_state**2).round(9)  # on the axis of the largest moment of inertia, on its sphere
        array([[0., 0., 3.]])

    Args:
        system: The system; its Hamiltonian must not depend on time.
        rate: The rate $\gamma\ge 0$: a number, or a formula in parameters and coordinates.
        metric: The symmetric form g on velocities: a matrix of shape (N, N) or its diagonal, of numbers or formulas;
            "killing" for the inverse of minus the Killing form. The identity by default. It may be degenerate: on
            canonical coordinates, 1 for q and 0 for p gives the friction $\dot p = -\partial_q H - \gamma\dot q$.
        parameters: Values of further names in `rate` and `metric`.
        symbols: Further names that stay symbolic.
        name: How the damped system is called.

    Raises:
        ParameterError: the system is none or depends on time, the rate is negative or no number, the metric is not
            symmetric or has a negative eigenvalue, or a parameter is wrong.
        ShapeError: the metric has another shape.
        BracketError: the Killing form is degenerate.
        ExpressionError: a formula is not in the grammar, or a name in it is not known.

    References: [bloch1996].
    """
    return DampedSystem(system, Damping("double bracket", rate, metric=metric), parameters, symbols=symbols, name=name)


@explains_its_arguments
def metriplectic(
    system: System,
    entropy: str | Expr,
    rate: Parameter = 1,
    *,
    metric: FormLike | Literal["killing"] | None = None,
    forms: tuple[FormLike, FormLike] | None = None,
    matrix: FormLike | None = None,
    parameters: Mapping[str, GivenValue] | None = None,
    symbols: Sequence[str] = (),
    name: str | None = None,
) -> DampedSystem:
    r"""The metriplectic flow of a system: the energy is kept, and the entropy never falls.

    $$\dot x = J\nabla H + \gamma\,G\nabla S, \qquad G = G^T, \quad G\nabla H = 0, \qquad
    \dot H = 0, \quad \dot S = \gamma\,|\nabla S|_G^2 \ge 0.$$

    G is that of a 4-bracket, $(f, g)_H = (f, H; g, H)$: of the Lie algebra with a form,
    $(f, k; g, n) = \langle[df, dk], [dg, dn]\rangle$, where `forms` and `matrix` are left out; or the product of
    Kulkarni and Nomizu of two `forms`,
    $\sigma(f, g)\mu(k, n) - \sigma(f, n)\mu(k, g) + \mu(f, g)\sigma(k, n) - \mu(f, n)\sigma(k, g)$; or G is given.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> flow = lp.dissipation.metriplectic(body, "C1", "1/10")
        >>> print(*flow.laws, sep="; ")
        S rises (proved); H is constant (proved)
        >>> orbit = lp.integrate(flow, [1, 1, 1], t_end=1000)
        >>> (orbit.end_state**2).round(9), bool(orbit.drift["H"][0] < 1e-12)  # all energy on the third axis
        (array([[0. , 0. , 5.5]]), True)

    Args:
        system: The system; its Hamiltonian must not depend on time.
        entropy: The entropy S: a Casimir, by name ("C1") or formula.
        rate: The rate $\gamma\ge 0$: a number, or a formula in parameters and coordinates.
        metric: The form on the Lie algebra, as a matrix of shape (N, N) or its diagonal; "killing" for minus the
            Killing form. The identity by default.
        forms: Instead, two symmetric forms $\sigma$ and $\mu$ on gradients, which need no Lie algebra.
        matrix: Instead, the matrix G of formulas, shape (N, N).
        parameters: Values of further names in the formulas.
        symbols: Further names that stay symbolic.
        name: How the flow is called.

    Raises:
        ParameterError: the system is none or depends on time, the rate is negative or no number, a matrix is not
            symmetric or has a negative eigenvalue, $G\nabla H$ is not zero, more than one of `metric`, `forms` and
            `matrix` is given, or a parameter is wrong.
        ShapeError: a matrix has another shape.
        BracketError: the entropy is no Casimir, or the bracket is not linear and no `forms` are given.
        ExpressionError: a formula is not in the grammar, or a name in it is not known.

    References: [morrison2024]; for the rigid body [morrison1986].
    """
    if not isinstance(entropy, str) and not is_expression(entropy):
        raise not_a("a Casimir, as a text or an expression", entropy, "entropy", 'write entropy="C1"')
    damping = Damping("metriplectic", rate, entropy, metric, forms, matrix)
    return DampedSystem(system, damping, parameters, symbols=symbols, name=name)


def _check_system(system: Any) -> None:
    if not isinstance(system, System):
        raise not_a_system(system)
    if system.clock is not None:
        raise ParameterError(
            f"system: wanted one whose energy may fall; got {system.name}, whose Hamiltonian depends on time; damp the "
            "system without the drive"
        )
    if len(system.component_names) != system.bracket.dimension:
        found = ", ".join(system.component_names[system.bracket.dimension :])
        raise ParameterError(
            f"system: wanted one whose state is a point of its phase space; {system.name} has {found} besides, found "
            "by quadrature; make it without quadratures"
        )


def _kept(damping: Damping, names: tuple[str, ...]) -> Damping:
    """The damping with its matrices as tuples: nobody changes them later, and iterators are read once.

    Raises:
        ParameterError: a matrix is given that this damping has not, or something else than a matrix.
    """
    double = damping.kind == "double bracket"
    for key in ("entropy", "forms", "matrix"):
        if double and (value := getattr(damping, key)) is not None:
            raise ParameterError(f"{key}: wanted none, as a double bracket has none; got {shown(value)}; leave it out")
    given = [key for key in ("metric", "forms", "matrix") if getattr(damping, key) is not None]
    if len(given) > 1:
        raise ParameterError(
            f"{given[0]}: wanted one of metric, forms and matrix; got {' and '.join(given)}; leave one"
        )
    if not given or isinstance(damping.metric, str):
        return damping
    form = getattr(damping, given[0])
    if given != ["forms"]:
        return replace(damping, **{given[0]: form_entries(form, names, given[0])})
    both = None if isinstance(form, str) else listed(form, "forms")
    if both is None or len(both) != 2:
        raise not_a("two symmetric matrices", form, "forms", "write for example forms=(sigma, mu)")
    places = ("forms: the first", "forms: the second")
    return replace(
        damping, forms=tuple(form_entries(one, names, which) for one, which in zip(both, places, strict=True))
    )


def _own_values(system: System, parameters: Any) -> Mapping[str, Any]:
    """The values of names that the system has not.

    Raises:
        ParameterError: a name is one of the system, with another value.
    """
    given = read_kept_values(parameters)
    for name in given:
        if name in system.values and flattened({name: given[name]}) != flattened({name: system.values[name]}):
            raise ParameterError(
                f"parameters: {name} has a value in {system.name} already, {shown(system.values[name])}; choose "
                "another name"
            )
    return given
