"""Plain descriptions of vector fields: what the exact algebra hands to the numeric part.  Data, no code."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar, Self, TypeAlias, cast

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_methods

Vector3: TypeAlias = tuple[float, float, float]
Instruction: TypeAlias = tuple[str, tuple[int, ...], tuple[float, ...]]
"""Name, registers that are read, numbers: one line of a tape."""
Piece: TypeAlias = tuple[tuple[tuple[int, float], ...], tuple[float, ...], tuple[tuple[int, int, float], ...]]
"""Linear form, derivative as a polynomial, matrix: one piece of a Hamiltonian."""


class PlainField:
    """What all descriptions share: each can be integrated as it is, like a system."""

    kind: ClassVar[str]

    @property
    def name(self) -> str:
        """What it is called in results."""
        return f"{self.kind} field"

    def field(self) -> Self:
        """The description itself, as a system gives its own."""
        return self


@explains_its_methods
@dataclass(frozen=True)
class TopField(PlainField):
    r"""The charged or twisted top with diagonal inertia.

    With $x = (\ell, \alpha, \beta)$ and $\omega_i = \ell_i / I_i$,

    $$\dot\ell = \ell\times\omega + \alpha\times a + \beta\times b,\quad
      \dot\alpha = \alpha\times\omega + \epsilon\,\beta\times a,\quad
      \dot\beta = \beta\times\omega .$$

    Source: Thiffeault and Morrison (2001), equations of the section "The twisted top".

    Example:
        >>> lp.Top.twisted_kovalevskaya().field()
        TopField(inertia=(2.0, 2.0, 1.0), a=(-1.0, 0.0, 0.0), b=(0.0, 0.0, 0.0), epsilon=1.0)
    """

    kind: ClassVar[str] = "top"

    inertia: Vector3
    a: Vector3
    b: Vector3
    epsilon: float

    def __post_init__(self) -> None:
        """Keeps plain numbers of its own."""
        for name in ("inertia", "a", "b"):
            object.__setattr__(self, name, tuple(float(value) for value in getattr(self, name)))
        object.__setattr__(self, "epsilon", float(self.epsilon))

    @property
    def n_components(self) -> int:
        """Dimension of the state, 9."""
        return 9


@explains_its_methods
@dataclass(frozen=True)
class QuadraticField(PlainField):
    r"""Any field of degree at most two, as sparse tensors: $\dot x_i = c_i + L_{ij} x_j + Q_{ijk} x_j x_k$.

    Every Lie-Poisson system with a quadratic Hamiltonian has such a field.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 4])
        >>> body.field().quadratic  # the first is -l2*l3/4
        ((0, 1, 2, -0.25), (1, 0, 2, 0.75), (2, 0, 1, -0.5))

    Attributes:
        n_components: Dimension of the state.
        constant: Entries (i, c).
        linear: Entries (i, j, c).
        quadratic: Entries (i, j, k, c) with j <= k; each product occurs once.
    """

    kind: ClassVar[str] = "quadratic"

    n_components: int
    constant: tuple[tuple[int, float], ...]
    linear: tuple[tuple[int, int, float], ...]
    quadratic: tuple[tuple[int, int, int, float], ...]

    def __post_init__(self) -> None:
        """Checks the entries, and adds up those of one product."""
        n = _count(self.n_components)
        object.__setattr__(self, "constant", _entries(self.constant, n, 1, "constant"))
        object.__setattr__(self, "linear", _entries(self.linear, n, 2, "linear"))
        object.__setattr__(self, "quadratic", _entries(self.quadratic, n, 3, "quadratic"))


@explains_its_methods
@dataclass(frozen=True)
class TapeField(PlainField):
    r"""Any smooth field, as a straight line of elementary operations.

    Registers 0 to n - 1 hold the state; instruction m writes register n + m and reads earlier ones only.  With a, b the
    registers that it reads and c its numbers, an instruction is one of

    - `linear`: $c_{\rm last} + \sum_i c_i r_i$;
    - `product`: a b;  `quotient`: a / b;  `power`: $a^c$ with a real exponent;
    - `sqrt`, `exp`, `log`, `sin`, `cos`, `sinh`, `cosh`, `tanh`, `asin`, `acos`, `atan`.

    Example:
        >>> pendulum = lp.System(lp.canonical(1, names=["theta"]), "p_theta^2/2 - cos(theta)")
        >>> field = pendulum.field()
        >>> field.instructions, field.outputs  # registers 2 and 3 are sin(theta) and its negative
        ((('sin', (0,), ()), ('linear', (2,), (-1.0, 0.0))), (1, 3))

    Attributes:
        n_components: Dimension of the state.
        instructions: (name, registers, numbers), in the order of execution.
        outputs: The register of each component of the time derivative.
        size_limits: The largest size with which each component counts in the size of the state that tolerances are
            relative to, None without limit: a turn of an angle; 0 for time and its momentum, which are the last
            components and in whose units the others are not; the error of the momentum is relative to its own size.
            Empty: all count as they are.
    """

    kind: ClassVar[str] = "tape"

    n_components: int
    instructions: tuple[Instruction, ...]
    outputs: tuple[int, ...]
    size_limits: tuple[float | None, ...] = ()

    def __post_init__(self) -> None:
        """Checks names, registers and numbers."""
        _check_lines(self)
        limits = tuple(_items(self.size_limits, "size_limits"))
        object.__setattr__(self, "size_limits", tuple(x if x is None else _number(x, "size_limits") for x in limits))


@dataclass(frozen=True)
class TapeFunction:
    """Functions on phase space, as a straight line of the operations of a `TapeField`; as many outputs as functions.

    Attributes:
        n_components: Dimension of the state.
        instructions: (name, registers, numbers), in the order of execution.
        outputs: The register of each function.
        guard: For a surface of section the register of a function that is positive on it: of the zeros of the first
            output only those with this belong to the surface.  None: all do.
    """

    n_components: int
    instructions: tuple[Instruction, ...]
    outputs: tuple[int, ...]
    guard: int | None = None

    def __post_init__(self) -> None:
        """Checks names, registers and numbers."""
        _check_lines(self)
        if self.guard is not None:
            _index(self.guard, self.n_components + len(self.instructions), "guard")

    @property
    def with_guard(self) -> TapeFunction:
        """The functions with the guard as the second of them, as the core takes a surface; themselves without one."""
        first, *others = self.outputs
        guard = () if self.guard is None else (self.guard,)
        return TapeFunction(self.n_components, self.instructions, (first, *guard, *others))


@explains_its_methods
@dataclass(frozen=True)
class PiecesField(PlainField):
    r"""A Lie-Poisson system by the pieces of its Hamiltonian, each with a known flow.

    A piece is a function of one linear form, $F(y)$ with $y = \xi\cdot x$.  It keeps y, and since the bracket is linear
    its field is $F'(y)\,Mx$ with a constant matrix M, $M_{ik} = \sum_j c_{ij}^k\xi_j$; so it flows by $\exp(tF'(y)M)$.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> [form for form, derivative, matrix in body.pieces().pieces]  # H is a sum of functions of l1, l2 and l3
        [((0, 1.0),), ((1, 1.0),), ((2, 1.0),)]

    Attributes:
        n_components: Dimension of the state.
        pieces: (form, derivative, matrix): entries (i, c) of $\xi$; coefficients of $F'$ as a polynomial in y, lowest
            first; entries (i, k, c) of M.
    """

    kind: ClassVar[str] = "pieces"

    n_components: int
    pieces: tuple[Piece, ...]

    def __post_init__(self) -> None:
        """Checks the entries."""
        n, pieces = _count(self.n_components), _items(self.pieces, "pieces")
        object.__setattr__(self, "pieces", tuple(_piece(piece, n) for piece in pieces))


Field: TypeAlias = TopField | QuadraticField | TapeField | PiecesField


def with_size_limits(field: Field, limits: tuple[float | None, ...]) -> Field:
    """The field with limits of the sizes of its components, if there are any; one of degree two as a tape."""
    if not limits:
        return field
    if isinstance(field, QuadraticField):
        field = _as_tape(field)
    return replace(field, size_limits=limits) if isinstance(field, TapeField) else field


def _as_tape(field: QuadraticField) -> TapeField:
    n, pairs = field.n_components, sorted({(j, k) for _, j, k, _ in field.quadratic})
    products: list[Instruction] = [("product", pair, ()) for pair in pairs]
    sums: list[Instruction] = []
    for component in range(n):
        terms = [(j, c) for i, j, c in field.linear if i == component]
        terms += [(n + pairs.index((j, k)), c) for i, j, k, c in field.quadratic if i == component]
        constant = sum(c for i, c in field.constant if i == component)
        sums.append(("linear", tuple(j for j, _ in terms), (*(c for _, c in terms), float(constant))))
    first = n + len(products)
    return TapeField(n, (*products, *sums), tuple(range(first, first + n)))


def at_rest(field: Field, component: int) -> Field:
    """The field with one component that does not move; it must be no field of a top, and not given by its pieces."""
    if isinstance(field, TapeField):
        outputs = [*field.outputs]
        outputs[component] = field.n_components + len(field.instructions)
        return replace(field, instructions=(*field.instructions, ("linear", (), (0.0,))), outputs=tuple(outputs))
    assert isinstance(field, QuadraticField), field
    constant, linear, quadratic = (
        tuple(entry for entry in entries if entry[0] != component)
        for entries in (field.constant, field.linear, field.quadratic)
    )
    return replace(field, constant=constant, linear=linear, quadratic=quadratic)


def record_of(field: Field) -> dict[str, Any]:
    """The field as plain data that JSON can write, with its kind."""
    record = asdict(field)
    if not record.get("size_limits", True):
        del record["size_limits"]
    return {"kind": field.kind, **record}


def field_of(record: Mapping[str, Any]) -> Field:
    """The field that `record_of` has written.

    Raises:
        KeyError, TypeError, ValueError: `record_of` did not write it.
    """
    kind = record["kind"]
    if kind == "top":
        inertia, a, b = (_triple(record[name], name) for name in ("inertia", "a", "b"))
        return TopField(inertia=inertia, a=a, b=b, epsilon=_number(record["epsilon"], "epsilon"))
    if kind == "quadratic":
        return QuadraticField(*(record[name] for name in ("n_components", "constant", "linear", "quadratic")))
    if kind == "tape":
        lines = (record[name] for name in ("n_components", "instructions", "outputs"))
        return TapeField(*lines, size_limits=record.get("size_limits", ()))
    if kind == "pieces":
        return PiecesField(record["n_components"], record["pieces"])
    raise ValueError(f"kind of field: wanted top, quadratic, tape or pieces; got {kind!r:.60}")


def _count(value: Any) -> int:
    if type(value) is not int or value < 1:
        raise ParameterError(f"n_components: wanted a whole number >= 1; got {value!r:.60}; count the components")
    return value


def _items(values: Any, name: str) -> Sequence[Any]:
    if not isinstance(values, (list, tuple)):
        raise ParameterError(f"{name}: wanted a sequence of entries; got {values!r:.60}; write a tuple of tuples")
    return cast("Sequence[Any]", values)


def _index(value: Any, end: int, name: str) -> int:
    if type(value) is not int or not 0 <= value < end:
        raise ParameterError(f"{name}: wanted an index from 0 to {end - 1}; got {value!r:.60}; they count from 0")
    return value


def _number(value: Any, name: str) -> float:
    if type(value) not in (int, float) or not math.isfinite(value):
        raise ParameterError(f"{name}: wanted a finite number; got {value!r:.60}; check the parameters")
    return float(value)


def _triple(values: Any, name: str) -> Vector3:
    items = _items(values, name)
    if len(items) != 3:
        raise ParameterError(f"{name}: wanted three numbers; got {values!r:.60}; give all components")
    first, second, third = (_number(value, name) for value in items)
    return first, second, third


def _entries(values: Any, n: int, n_indices: int, name: str) -> tuple[Any, ...]:
    """Entries (i, j, ..., c), one for each component and product; factors in increasing order."""
    sums: dict[tuple[int, ...], float] = {}
    for entry in _items(values, name):
        items = _items(entry, name)
        if len(items) != n_indices + 1:
            raise ParameterError(f"{name}: wanted entries of {n_indices} indices and a number; got {entry!r:.60}")
        indices = [_index(i, n, name) for i in items[:-1]]
        key = (indices[0], *sorted(indices[1:]))
        sums[key] = sums.get(key, 0.0) + _number(items[-1], name)
    return tuple((*key, value) for key, value in sums.items())


def _check_lines(tape: TapeField | TapeFunction) -> None:
    """Checks instructions and outputs and keeps them as tuples; operands of each name are checked by the core."""
    n, lines = _count(tape.n_components), _items(tape.instructions, "instructions")
    instructions = tuple(_instruction(line, n + m) for m, line in enumerate(lines))
    outputs = tuple(_index(r, n + len(lines), "outputs") for r in _items(tape.outputs, "outputs"))
    object.__setattr__(tape, "instructions", instructions)
    object.__setattr__(tape, "outputs", outputs)


def _instruction(line: Any, end: int) -> Instruction:
    parts = _items(line, "instructions")
    if len(parts) != 3 or not isinstance(parts[0], str):
        raise ParameterError(f"instructions: wanted (name, registers, numbers); got {line!r:.60}; write all three")
    name = parts[0]
    registers = tuple(_index(r, end, name) for r in _items(parts[1], name))
    return name, registers, tuple(_number(c, name) for c in _items(parts[2], name))


def _piece(piece: Any, n: int) -> Piece:
    parts = _items(piece, "pieces")
    if len(parts) != 3:
        raise ParameterError(f"pieces: wanted (form, derivative, matrix); got {piece!r:.60}; write all three")
    form, matrix = (_entries_as_given(part, n, count) for part, count in zip(parts[::2], (1, 2), strict=True))
    derivative = tuple(_number(c, "pieces") for c in _items(parts[1], "pieces"))
    return form, derivative, matrix


def _entries_as_given(values: Any, n: int, n_indices: int) -> tuple[Any, ...]:
    """Entries (i, ..., c) of a form or a matrix."""
    entries: list[tuple[Any, ...]] = []
    for entry in _items(values, "pieces"):
        items = _items(entry, "pieces")
        if len(items) != n_indices + 1:
            raise ParameterError(f"pieces: wanted entries of {n_indices} indices and a number; got {entry!r:.60}")
        entries.append((*(_index(i, n, "pieces") for i in items[:-1]), _number(items[-1], "pieces")))
    return tuple(entries)
