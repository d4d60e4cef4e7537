"""What the reductions of Lagrange tops share: which tops they take, the conserved l3, and the cyclic angle psi."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import as_float, is_zero, to_sympy
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.numbers import as_array
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.inputs.arrays import Array
from liepoisson.model.charts.leaf_constants import COMPONENTS, refuse
from liepoisson.model.top_parameters import TopParameters
from liepoisson.portable import linear

if TYPE_CHECKING:
    from sympy import Expr


def check_lagrange(top: TopParameters) -> None:
    """Refuse tops without a symmetry axis.

    Raises:
        ParameterError: the first two moments differ, or a or b is not along the third axis.
    """
    first, second, _ = (to_sympy(value) for value in top.inertia)
    off_axis = [value for vector in (top.a, top.b) for value in vector[:2] if not is_zero(value)]
    if first != second or off_axis:
        raise ParameterError(
            "the reduction needs a Lagrange top: I1 = I2 and a, b along the third axis; got "
            f"{top.describe()}. Use EulerChart for other tops."
        )


def conserved_l3(l3: Parameter | None, state: ArrayLike | None, *, symbolic: bool) -> Any:
    """The value of l3: as given, from the state, or a symbol.

    Raises:
        ParameterError: it is given twice, or missing beside a leaf.
    """
    if state is not None and l3 is not None:
        raise ParameterError("l3 is known from the state; got both. Leave l3 out.")
    if state is not None:
        return to_sympy(read_parameter(float(as_array(state, "state", COMPONENTS)[2]), "l3"))
    if l3 is None and not symbolic:
        raise ParameterError("the reduction needs l3 beside the leaf; got none. Give l3=, or a state with state=.")
    return to_sympy(read_parameter("l3" if l3 is None else l3, "l3"))


def cyclic_angle(within: Array, given: ArrayLike | None, shape: tuple[int, ...]) -> Array:
    """The angle psi: the last component of the states, or as given beside them.

    Raises:
        ParameterError: neither or both.
        ShapeError: another shape.
    """
    if (given is None) == (within.shape[-1] == 0):
        raise ParameterError(
            "the state in the body needs psi once; got it "
            + ("not at all. Give psi=, or reduce with_cyclic_angle=True." if given is None else "twice. Leave psi out.")
        )
    if given is None:
        return within[..., 0]
    angle = as_array(given, "psi")
    try:
        return np.broadcast_to(angle, shape)
    except ValueError:
        raise ShapeError(f"psi must have shape {shape}, one for each state; got shape {angle.shape}.") from None


def check_l3(states: Array, l3: Expr) -> None:
    """Refuse states with another l3 than that of the reduction.

    Raises:
        ChartError: with the condition "l3".
    """
    wanted, l = as_float(l3, "l3"), states[..., :3]
    size = 1e-8 * (linear.norm(l, axis=-1) + abs(wanted) + 1e-300)
    hint = "Reduce with state=state for that state."
    refuse(np.abs(l[..., 2] - wanted) > size, l[..., 2], "l3", f"l3 = {wanted:.9g}", quantity="l3", hint=hint)
