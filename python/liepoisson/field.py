"""Plain descriptions of vector fields: what the exact wing hands to the numeric wing.  Data, no code."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Self, TypeAlias

Vector3: TypeAlias = tuple[float, float, float]
Instruction: TypeAlias = tuple[str, tuple[int, ...], tuple[float, ...]]
"""Name, registers that are read, numbers: one line of a tape."""


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


@dataclass(frozen=True)
class TopField(PlainField):
    r"""The charged or twisted top with diagonal inertia.

    With $x = (\ell, \alpha, \beta)$ and $\omega_i = \ell_i / I_i$,

    $$\dot\ell = \ell\times\omega + \alpha\times a + \beta\times b,\quad
      \dot\alpha = \alpha\times\omega + \epsilon\,\beta\times a,\quad
      \dot\beta = \beta\times\omega .$$

    Source: Thiffeault and Morrison (2001), equations of the section "The twisted top".
    """

    kind: ClassVar[str] = "top"

    inertia: Vector3
    a: Vector3
    b: Vector3
    epsilon: float

    @property
    def n_components(self) -> int:
        """Dimension of the state, 9."""
        return 9


@dataclass(frozen=True)
class QuadraticField(PlainField):
    r"""Any field of degree at most two, as sparse tensors: $\dot x_i = c_i + L_{ij} x_j + Q_{ijk} x_j x_k$.

    Every Lie-Poisson system with a quadratic Hamiltonian has such a field.

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


@dataclass(frozen=True)
class TapeField(PlainField):
    r"""Any smooth field, as a straight line of elementary operations.

    Registers 0 to n - 1 hold the state; instruction m writes register n + m and reads earlier ones only.  With a, b the
    registers that it reads and c its numbers, an instruction is one of

    - `linear`: $c_{\rm last} + \sum_i c_i r_i$;
    - `product`: a b;  `quotient`: a / b;  `power`: $a^c$ with a real exponent;
    - `sqrt`, `exp`, `log`, `sin`, `cos`, `sinh`, `cosh`, `tanh`, `asin`, `acos`, `atan`.

    Attributes:
        n_components: Dimension of the state.
        instructions: (name, registers, numbers), in the order of execution.
        outputs: The register of each component of the time derivative.
    """

    kind: ClassVar[str] = "tape"

    n_components: int
    instructions: tuple[Instruction, ...]
    outputs: tuple[int, ...]


Field: TypeAlias = TopField | QuadraticField | TapeField


def record_of(field: Field) -> dict[str, Any]:
    """The field as plain data that JSON can write, with its kind."""
    return {"kind": field.kind, **asdict(field)}


def field_of(record: Mapping[str, Any]) -> Field:
    """The field that `record_of` has written.

    Raises:
        KeyError, TypeError, ValueError: the record is not one of ours.
    """
    kind = record["kind"]
    if kind == "top":
        inertia, a, b = (_triple(record[name], name) for name in ("inertia", "a", "b"))
        return TopField(inertia=inertia, a=a, b=b, epsilon=_number(record["epsilon"], "epsilon"))
    if kind == "quadratic":
        n = _count(record["n_components"])
        (constant, linear, quadratic) = (record[name] for name in ("constant", "linear", "quadratic"))
        return QuadraticField(
            n,
            tuple((_index(i, n), _number(c, "constant")) for i, c in constant),
            tuple((_index(i, n), _index(j, n), _number(c, "linear")) for i, j, c in linear),
            tuple((_index(i, n), _index(j, n), _index(k, n), _number(c, "quadratic")) for i, j, k, c in quadratic),
        )
    if kind == "tape":
        n = _count(record["n_components"])
        end = n + len(record["instructions"])
        instructions = tuple(
            (str(name), tuple(_index(r, n + m) for r in registers), tuple(_number(c, str(name)) for c in numbers))
            for m, (name, registers, numbers) in enumerate(record["instructions"])
        )
        return TapeField(n, instructions, tuple(_index(r, end) for r in record["outputs"]))
    raise ValueError(f"kind of field: wanted top, quadratic or tape; got {kind!r:.60}")


def _count(value: Any) -> int:
    if type(value) is not int or value < 1:
        raise ValueError(f"n_components: wanted a whole number >= 1; got {value!r:.60}")
    return value


def _index(value: Any, end: int) -> int:
    if type(value) is not int or not 0 <= value < end:
        raise ValueError(f"wanted an index from 0 to {end - 1}; got {value!r:.60}")
    return value


def _number(value: Any, name: str) -> float:
    if type(value) not in (int, float) or not math.isfinite(value):
        raise ValueError(f"{name}: wanted a finite number; got {value!r:.60}")
    return float(value)


def _triple(values: Any, name: str) -> Vector3:
    if not isinstance(values, (list, tuple)) or len(values) != 3:  # pyright: ignore[reportUnknownArgumentType]
        raise ValueError(f"{name}: wanted three numbers; got {values!r:.60}")
    first, second, third = (_number(value, name) for value in values)
    return first, second, third
