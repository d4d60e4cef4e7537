"""System files: a bracket and a Hamiltonian in TOML, with exact numbers.

    name = "my top"
    [bracket]
    algebra   = "so(3)"                    # or structure_constants = [[[...]]], or matrices = [[[...]]]
    extension = "leibniz(3, epsilon)"      # or W = [[[...]]]; one field if left out
    variables = ["l", "alpha", "beta"]
    constant.l1.l2 = "k"                   # a constant part, if there is one: k is added to {l1, l2}
    [parameters]                           # numbers ("1/3", 0.1 and "sqrt(2)/2" are exact), vectors, matrices
    I = [2, 2, 1]
    symbols = ["epsilon", "a[3]"]          # parameters without a value, vectors with their length
    [hamiltonian]
    expression = "dot(l, inv(I)*l)/2 + dot(a, alpha)"
    period = "2*pi/w"                      # if the formula depends on time t, and repeats itself

A canonical bracket is written instead of an algebra:

    [bracket]
    canonical = 2                          # {q_i, p_i} = 1 for q1, q2, p1, p2
    canonical = ["theta", "phi"]           # or by names; momenta p_theta, p_phi, or momenta = ["u", "v"]
    angles = ["theta"]                     # coordinates of this or any other bracket modulo 2 pi, if there are
    [quadratures]                          # further components of the state, if there are, with their rates
    psi = "p_theta - cos(theta)"

A bracket that is not linear is given by the formulas of its Poisson tensor:

    [bracket]
    variables = ["x", "y", "z"]
    tensor.x.y = "a*x*y"                   # {x, y} = a x y
    tensor.y.z = "y*z"
    tensor.x.z = "-z*x"
    casimirs = ["..."]                     # if some are known; they are checked

That of a charge in a magnetic field, or of its guiding centre, is given by the field, of which div B = 0 is checked;
the tensor follows from it:

    [bracket]
    guiding_centre = ["0", "0", "1 + y"]   # or magnetic = [...], three formulas or one for a plane
    charge = 40                            # 1 if left out
    mass = 1                               # 1 if left out
    variables = ["x", "y", "z", "u"]       # these if left out

and, where they are known, a source, a description, integrals and reference values:

    [integrals]
    P = "l3"
    K = {expression = "...", on = "dot(l, alpha) = 0", source = "..."}
    [[reference]]
    state = {l = [1, 2, 3], alpha = [0, 0, 1], beta = [0, 0, 0]}   # or all components in one list
    quantity = "H"
    value = "7/2"

Damping that keeps the geometry is a further table, and the file then describes a damped system:

    [damping]
    kind = "double bracket"                # or "metriplectic"
    rate = "gamma"                         # a number or a formula; its parameters are below [parameters], too
    metric = [1, 1, 1, 0, 0, 0]            # a diagonal or a matrix, or "killing"; the identity if left out
    entropy = "C1"                         # of a metriplectic flow, with metric, or forms = [..., ...], or matrix = ...

Noise that stays on the leaf is a further table, too, and the file then describes a noisy system:

    [noise]
    noises = ["s*l1", "s*l2"]              # noise Hamiltonians; their parameters are below [parameters], too
    inverse_temperature = 2                # a number or a formula of parameters; no damping if left out

A plain vector field has its equations in the place of bracket and Hamiltonian:

    name = "Lorenz"                        # and angles = [...] here, if a coordinate is one
    [equations]
    x = "sigma*(y - x)"
    y = "x*(rho - z) - y"
    z = "x*y - beta*z"
    [parameters]
    sigma = 10
    ...

The formulas are those of `liepoisson.formula.expression`.  No text of a file is ever run as code.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, cast

from liepoisson.algebra.exact_numbers import Exact
from liepoisson.compile.typed import names_of, read_system
from liepoisson.errors import ExpressionError, ParameterError, SystemFileError, did_you_mean
from liepoisson.formula.expression import read_formula
from liepoisson.formula.parameters import GivenValue, Shape, Value, read_values
from liepoisson.formula.scope import Scope, read_declaration, shape_of
from liepoisson.formula.toml_text import TomlText
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.names import MAX_TITLE
from liepoisson.model.hamiltonian import scope_of

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket


@explains_its_methods
@dataclass(frozen=True)
class Integral:
    """A function that the file claims to be constant along the motion.

    Example:
        >>> integral = lp.catalog.entry("goryachev-chaplygin").integrals["G"]
        >>> integral.expression, integral.on
        ('l3*(l1^2 + l2^2) - 4*a1*l1*alpha3', 'dot(l, alpha) = 0')

    Attributes:
        expression: Its formula.
        on: The condition "f = g" under which it is constant (a partial integral), or None.
        source: Where it is from, or None.
    """

    expression: str
    on: str | None = None
    source: str | None = None

    @property
    def vanishing(self) -> str | None:
        """The formula that vanishes where the condition holds, or None without condition."""
        if self.on is None:
            return None
        left, _, right = (part.strip() for part in self.on.partition("="))
        return left if right in ("", "0") else f"({left}) - ({right})"


@explains_its_methods
@dataclass(frozen=True)
class Reference:
    """A value to compare with.

    Example:
        >>> value = lp.catalog.entry("kovalevskaya").references[0]
        >>> value.quantity, str(value.value), [int(component) for component in value.state]
        ('H', '19/4', [1, 2, 3, 1, 1, -1])

    Attributes:
        quantity: What has this value: "H", "C1", the name of an integral, "derivative", "lyapunov", ...
        value: A number, or several.
        state: The state, all components in the order of the coordinates, or None.
        tolerance: How far a computed value may be from it; None where it is exact.
        source: Where it is from, or None.
    """

    quantity: str
    value: Exact | tuple[Exact, ...]
    state: tuple[Exact, ...] | None = None
    tolerance: Exact | None = None
    source: str | None = None


@explains_its_methods
class EquationsFile(ABC):
    """A file with names, values of parameters and claims: what files of systems and of vector fields share.

    Those that are dataclasses say which names their formulas may use (`scope`) and what they describe (`system`).
    """

    name: str
    parameters: Mapping[str, Value]
    symbols: tuple[str, ...]
    path: str
    toml: TomlText | None

    @cached_property
    @abstractmethod
    def scope(self) -> Scope:
        """The names that the formulas of the file may use."""

    @abstractmethod
    def system(self) -> Any:
        """What the file describes."""

    @abstractmethod
    def with_constant_integrals(self) -> Self:
        """The file without those of its integrals that are not found constant, as with other values of parameters."""

    def error(self, keys: tuple[str, ...], message: str) -> SystemFileError:
        """An error about the value of a key, with its line where the text is known; to be raised."""
        return (self.toml or TomlText(self.path, "", {})).error(keys, message)

    def with_parameters(self, parameters: Mapping[str, GivenValue]) -> Self:
        """The file with other values for some parameters, and with values for symbols that had none.

        The name says which were set.  Reference values belong to the values that it had, and are left out.

        Example:
            >>> file = lp.catalog.entry("lagrange").with_parameters({"a": [0, 0, "1/2"]})
            >>> file.name, file.system().hamiltonian
            ('lagrange, a = (0, 0, 1/2)', alpha3/2 + l1**2/4 + l2**2/4 + l3**2/2)

        Args:
            parameters: Values by name, as for a `System`: numbers, vectors, matrices, each of the shape that it has in
                the file.

        Raises:
            ParameterError: not a mapping, a name that is no parameter of the file, a value that is not exact, or one of
                another shape.
        """
        values = read_values(parameters)
        known = [name for name in self.scope.shapes if name not in self.scope.scalars]
        for name, value in values.items():
            if name not in known:
                raise ParameterError(
                    f"{self.name!r} has no parameter {name!r:.60}. "
                    f"{did_you_mean(name, known)}Known: {', '.join(known) or 'none'}."
                )
            wanted, got = self.scope.shapes[name], shape_of(value)
            if wanted != got:
                raise ParameterError(f"{name} must have {_words(wanted)}; got {_words(got)}. {_example(wanted)}")
        symbols = tuple(text for text in self.symbols if read_declaration(text)[0] not in values)
        title = self.name + "".join(f", {name} = {_text(value)}" for name, value in values.items())
        changes: dict[str, Any] = {
            "name": title if len(title) <= MAX_TITLE else self.name,
            "parameters": {**self.parameters, **values},
            "symbols": symbols,
        }
        if hasattr(self, "references"):
            changes |= {"references": (), "proved": False}
        return replace(cast("Any", self), **changes)


@explains_its_methods
@dataclass(frozen=True)
class SystemFile(EquationsFile):
    """What a system file says.

    Example:
        >>> file = lp.catalog.entry("kovalevskaya")
        >>> file.hamiltonian, [str(component) for component in file.parameters["a"]]
        ('dot(l, inv(I)*l)/2 + dot(a, alpha)', ['-1', '0', '0'])
        >>> file.system().hamiltonian
        -alpha1 + l1**2/4 + l2**2/4 + l3**2/2

    Attributes:
        name: How the system is called.
        bracket: The bracket, with the names of its fields; parameters in it are symbols.
        hamiltonian: The formula of the Hamiltonian.
        period: The formula of its period in time, or None.
        parameters: Values by name: exact numbers, vectors, matrices.
        symbols: Parameters without value, as declared: "epsilon", "a[3]".
        integrals: Functions that are claimed to be constant, by name.
        references: Values to compare with.
        quadratures: Rates of components that follow the motion of a canonical system, by name.
        source: Where the system is described, or None.
        description: What it is, or None.
        path: The file, as messages call it.
        toml: Its text, in which messages find the line of a key; None if there is no such text.
        proved: Whether the integrals are constant, as the tests of the catalog or `with_constant_integrals` proved.
    """

    name: str
    bracket: Bracket
    hamiltonian: str
    period: str | None = None
    parameters: Mapping[str, Value] = field(default_factory=dict[str, Value], hash=False)
    symbols: tuple[str, ...] = ()
    integrals: Mapping[str, Integral] = field(default_factory=dict[str, Integral], hash=False)
    references: tuple[Reference, ...] = ()
    quadratures: Mapping[str, str] = field(default_factory=dict[str, str], hash=False)
    source: str | None = None
    description: str | None = None
    path: str = "system file"
    toml: TomlText | None = field(default=None, repr=False, compare=False)
    proved: bool = field(default=False, repr=False, compare=False)

    @cached_property
    def scope(self) -> Scope:
        """The names that the formulas of the file may use."""
        return scope_of(self.whole_bracket, cast("Mapping[str, Any]", self.parameters), self.symbols)

    @cached_property
    def whole_bracket(self) -> Bracket:
        """The bracket, with time and its momentum where the Hamiltonian depends on time."""
        from liepoisson.model.time_dependence import suspended

        parameters = cast("Mapping[str, Any]", self.parameters)
        return suspended(self.bracket, self.hamiltonian, parameters, self.symbols, self.period)[0]

    @property
    def formulas(self) -> dict[tuple[str, ...], str]:
        """The formulas of the Hamiltonian, the integrals and their conditions, by the keys where they stand."""
        found: dict[tuple[str, ...], str] = {("hamiltonian", "expression"): self.hamiltonian}
        for name, integral in self.integrals.items():
            found["integrals", name] = integral.expression
            if integral.vanishing is not None:
                found["integrals", name, "on"] = integral.vanishing
        found.update({("quadratures", name): rate for name, rate in self.quadratures.items()})
        return found

    def with_constant_integrals(self) -> Self:
        """The file without those of its integrals that are not found constant, as with other values of parameters.

        Integrals on an invariant set stay: `inspect` decides on them.
        """
        if not self.integrals:
            return self
        system = replace(self, integrals={})._system()  # without the warning, which comes once
        kept = {
            name: item
            for name, item in self.integrals.items()
            if item.on is not None or system.is_constant(item.expression)
        }
        return replace(self, integrals=kept, proved=True)

    def system(self) -> System:
        """The system, ready to be inspected or integrated.

        Raises:
            SystemFileError: a formula has no meaning (shapes that do not fit, a function that is not smooth, ...), or a
                parameter drops out of the bracket and the Hamiltonian.  The message names the key and the line.

        Warns:
            InertiaWarning: it is a top, and no rigid body has the moments of inertia I.
        """
        from liepoisson.model.top_parameters import warn_of_impossible_bodies

        system = self._system()
        if self.scope.shapes.get("I") == (3,) and "I" in self.parameters:
            warn_of_impossible_bodies(cast("Any", self.parameters["I"]), system)
        return system

    def _system(self) -> System:
        """The system as it is made, without a warning."""
        from liepoisson.model.polynomial_view import read_polynomial
        from liepoisson.model.system import System

        names = self.whole_bracket.coordinate_names_in_order
        for keys, text in self.formulas.items():
            try:
                if read_polynomial(text, self.scope, names) is None and not self._is_read_by_the_core(text):
                    read_formula(text, self.scope)
            except ExpressionError as error:
                raise self.error(keys, error.within_formula()) from error
        integrals = {name: item for name, item in self.integrals.items() if item.vanishing is None}
        partial = {k: (i.expression, i.vanishing) for k, i in self.integrals.items() if i.vanishing is not None}
        try:
            if self.quadratures:
                return self.canonical_system()
            system = System(
                self.bracket,
                self.hamiltonian,
                cast("Any", self.parameters),
                period=self.period,
                name=self.name,
                symbols=self.symbols,
                integrals={name: item.expression for name, item in integrals.items()},
                partial_integrals=partial,
                source=self.source,
            )
        except ParameterError as error:
            raise SystemFileError(f"{self.path}: {error}") from error
        system.integrals_are_proved = self.proved
        return system

    def _is_read_by_the_core(self, text: str) -> bool:
        """Whether the core takes a formula, as SymPy then does; where it does not, SymPy says what is wrong."""
        if self.symbols or self.quadratures:
            return False
        return read_system(names_of(self.whole_bracket), None, text, self.parameters) is not None

    def canonical_system(self) -> System:
        """The same as a `CanonicalSystem`, with its quadratures; the bracket must be canonical."""
        from liepoisson.model.canonical_system import CanonicalSystem

        integrals = {name: item.expression for name, item in self.integrals.items() if item.vanishing is None}
        names, n = self.bracket.coordinate_names_in_order, self.bracket.dimension // 2
        return CanonicalSystem(
            names[:n],
            names[n:],
            self.hamiltonian,
            parameters=cast("Any", self.parameters),
            quadratures=self.quadratures,
            angles=self.bracket.angles,
            name=self.name,
            integrals=integrals,
            source=self.source,
        )


def _text(value: Value) -> str:
    return f"({', '.join(map(_text, value))})" if isinstance(value, tuple) else str(value)


def _words(shape: Shape) -> str:
    match shape:
        case ():
            return "one number"
        case (n,):
            return f"{n} components"
        case _:
            return f"a matrix of shape {shape}"


def _example(shape: Shape) -> str:
    match shape:
        case ():
            return "Give for example 1."
        case (n,):
            return f"Give for example [{', '.join(map(str, range(1, n + 1)))}]."  # no moment of inertia is zero
        case _:
            return "Give its rows as lists."


@dataclass(frozen=True, kw_only=True)
class ExtendedFile(EquationsFile):
    """A system file with a further table, whose formulas may use parameters of their own.

    Attributes:
        name: How the whole is called.
        bare: What the file says of the system without that table.
        parameters: Values by name, those of the system and those of the table.
        symbols: Parameters without value, as declared.
        integrals: Functions that are claimed to be constant along the motion of the system without that table, by name.
        path: The file, as messages call it.
        toml: Its text, in which messages find the line of a key; None if there is no such text.
    """

    name: str
    bare: SystemFile
    parameters: Mapping[str, Value] = field(default_factory=dict[str, Value], hash=False)
    symbols: tuple[str, ...] = ()
    integrals: Mapping[str, Integral] = field(default_factory=dict[str, Integral], hash=False)
    path: str
    toml: TomlText | None = field(default=None, repr=False, compare=False)

    @cached_property
    def scope(self) -> Scope:
        """The names that the formulas of the file may use."""
        return scope_of(self.bare.whole_bracket, cast("Mapping[str, Any]", self.parameters), self.symbols)

    def with_constant_integrals(self) -> Self:
        """The file without those of its integrals that are not found constant along the motion of the system alone."""
        return replace(self, integrals=self.system_file().with_constant_integrals().integrals)

    def system_file(self) -> SystemFile:
        """What the file says of the system alone, with the values that are its own."""
        own = {*self.bare.parameters, *(read_declaration(text)[0] for text in self.bare.symbols)}
        return replace(
            self.bare,
            name=self.name,
            parameters={name: value for name, value in self.parameters.items() if name in own},
            symbols=tuple(text for text in self.symbols if read_declaration(text)[0] in own),
            integrals=self.integrals,
        )
