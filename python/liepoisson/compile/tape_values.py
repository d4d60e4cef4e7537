"""The values of functions that are given as straight lines of operations, at many states."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from liepoisson.compile.field import TapeFunction
from liepoisson.inputs.arrays import Array
from liepoisson.portable import elementary

_OPERATIONS: dict[str, Callable[..., Any]] = {
    "product": np.multiply,
    "quotient": np.divide,
    "power": elementary.power,
    "sqrt": np.sqrt,
    "exp": elementary.exp,
    "log": elementary.log,
    "sin": elementary.sin,
    "cos": elementary.cos,
    "sinh": elementary.sinh,
    "cosh": elementary.cosh,
    "tanh": elementary.tanh,
    "asin": elementary.arcsin,
    "acos": elementary.arccos,
    "atan": elementary.arctan,
}


@np.errstate(all="ignore")
def values_of_tape(tape: TapeFunction, states: Array) -> Array:
    """The outputs of a tape, shape (..., output); NaN where an operation has no value.

    Args:
        tape: The functions.
        states: Shape (..., component).
    """
    registers = list(np.moveaxis(states, -1, 0))
    for name, operands, numbers in tape.instructions:
        inputs = [registers[k] for k in operands]
        if name == "linear":
            value = np.full(states.shape[:-1], numbers[-1])
            for factor, register in zip(numbers, inputs, strict=False):
                value = value + factor * register
        else:
            value = _OPERATIONS[name](*inputs, *numbers)
        registers.append(value)
    return np.stack([registers[k] for k in tape.outputs], axis=-1)


def has_partial_operations(tape: TapeFunction) -> bool:
    """Whether an operation has no value at some number: a root, a logarithm, an inverse sine."""
    return any(
        name in ("sqrt", "log", "asin", "acos") or (name == "power" and not numbers[0].is_integer())
        for name, _, numbers in tape.instructions
    )
