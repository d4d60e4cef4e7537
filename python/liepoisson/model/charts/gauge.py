"""Gauges of the Euler chart: the two space-fixed unit vectors along beta and along the rest of alpha."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from liepoisson.algebra.exact_numbers import Exact, is_zero, to_sympy
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Parameter, read_vector
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.given import listed

Given: TypeAlias = "str | tuple[Sequence[Parameter], Sequence[Parameter]]"
"""A gauge as a caller writes it: "e3, e1", or a pair of vectors."""

ORTHONORMAL = 1e-14
"""How far scalar products of vectors given as floats may be from 0 and 1: some roundings."""

_AXES = {"e1": (1, 0, 0), "e2": (0, 1, 0), "e3": (0, 0, 1)}
_AXIS_NAMES: dict[tuple[Any, ...], str] = {axis: name for name, axis in _AXES.items()}


@dataclass(frozen=True)
class Gauge:
    """Two constant orthonormal vectors in space.

    Attributes:
        parallel: Along beta, exact.
        perpendicular: Along the part of alpha that is perpendicular to beta, exact.
    """

    parallel: tuple[Exact, Exact, Exact]
    perpendicular: tuple[Exact, Exact, Exact]

    @classmethod
    def read(cls, given: Given) -> Gauge:
        """A gauge from its name or from two vectors.

        Raises:
            ParameterError: unknown axes, or vectors that are not orthonormal.
            ShapeError: vectors that do not have three components.
        """
        names = [part.strip() for part in given.split(",")] if isinstance(given, str) else []
        pair: Any = [_AXES.get(name) for name in names] if isinstance(given, str) else given
        pair = listed(pair, "gauge")
        if pair is None or len(pair) != 2 or any(vector is None for vector in pair):
            raise ParameterError(
                'gauge must be two of the axes e1, e2, e3, as in "e3, e1" (along beta, along the rest of alpha), or a '
                f"pair of orthonormal vectors; got {given!r:.60}."
            )
        gauge = cls(read_vector(pair[0], "gauge", "(e1, e2, e3)"), read_vector(pair[1], "gauge", "(f1, f2, f3)"))
        gauge._check()
        return gauge

    def __str__(self) -> str:
        return ", ".join(_AXIS_NAMES.get(v, f"({', '.join(map(str, v))})") for v in (self.parallel, self.perpendicular))

    def columns(self) -> tuple[Any, Any]:
        """Both vectors as SymPy columns."""
        from sympy import Matrix

        first, second = (Matrix([to_sympy(c) for c in v]) for v in (self.parallel, self.perpendicular))
        return first, second

    def triad(self) -> Array:
        """The space-fixed frame with columns (perpendicular, parallel x perpendicular, parallel), shape (3, 3)."""
        parallel, perpendicular = (np.array(v, dtype=np.float64) for v in (self.parallel, self.perpendicular))
        return np.stack([perpendicular, np.cross(parallel, perpendicular), parallel], axis=-1)

    def _check(self) -> None:
        e, f = self.columns()
        products = {"e_par.e_par": (e.dot(e), 1), "e_perp.e_perp": (f.dot(f), 1), "e_par.e_perp": (e.dot(f), 0)}
        for name, (value, wanted) in products.items():
            residual = value - wanted
            if not is_zero(residual) and not (residual.is_number and abs(float(residual)) <= ORTHONORMAL):
                raise ParameterError(
                    f"gauge must be two orthonormal vectors (e_par, e_perp); got {name} = {value!s:.40}. "
                    "Give exact numbers such as (3/5, 4/5, 0), or normalise them."
                )
