r"""Canonical brackets, $\{q_i, p_j\} = \delta_{ij}$: a constant part and nothing else, one leaf, no Casimirs.

$$\dot q_i = \partial H/\partial p_i, \qquad \dot p_i = -\partial H/\partial q_i .$$
"""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Integral
from typing import Any

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed_names
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.extension import Extension
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import abelian

MOST_DEGREES = 100
"""Degrees of freedom of the largest canonical bracket."""


@explains_its_arguments
def canonical(
    n: int | None = None,
    *,
    names: Sequence[str] | None = None,
    momenta: Sequence[str] | None = None,
    angles: Sequence[str] = (),
) -> Bracket:
    r"""The canonical bracket of n degrees of freedom, $\{q_i, p_j\} = \delta_{ij}$.

    Without names there are two vectors, q with the components q1, ..., qn and p with p1, ..., pn.  With names each
    coordinate and each momentum is a scalar of its own.

    Example:
        >>> bracket = lp.canonical(2)
        >>> bracket.coordinate_names_in_order
        ('q1', 'q2', 'p1', 'p2')
        >>> bracket(*bracket.variables[::2])
        1

    Args:
        n: Degrees of freedom, 1 to 100; may be left out where names are given.
        names: Names of the coordinates.
        momenta: Names of the momenta, in the order of the coordinates; p_theta for theta by default.
        angles: The coordinates that are angles, modulo $2\pi$.  A Hamiltonian must be periodic in them.

    Raises:
        ParameterError: n is not in the range, or a name is none that a user may choose.
        ShapeError: not one name per coordinate, or not one momentum for each, or the angles are no sequence of names.
        BracketError: a name is given twice, or an angle is no coordinate.
    """
    coordinates = None if names is None else _names(names, "names")
    if momenta is not None and coordinates is None:
        raise ShapeError("momenta belong to coordinates; got momenta without names. Give names=, too.")
    size = len(coordinates) if n is None and coordinates is not None else n
    if isinstance(size, bool) or not isinstance(size, Integral) or not 1 <= int(size) <= MOST_DEGREES:
        raise ParameterError(
            f"the number of degrees of freedom must be an integer from 1 to {MOST_DEGREES}; got {size!r:.40}. Write "
            'canonical(2), or canonical(names=("x", "y")).'
        )
    size = int(size)
    if coordinates is None:
        constant: dict[Any, int] = {(k, size + k): 1 for k in range(size)}
        vectors = Bracket(abelian(size), _without_products(("q", "p")), constant=constant, name=f"canonical({size})")
        return vectors.with_angles(angles)
    ordered = _with_momenta(coordinates, momenta)
    if len(coordinates) != size or len(ordered) != 2 * size:
        raise ShapeError(
            f"a canonical bracket needs {size} coordinates and one momentum for each; got {len(coordinates)} and "
            f"{len(ordered) - len(coordinates)} names. Correct one of them."
        )
    constant = {(k, size + k): 1 for k in range(size)}
    title = f"canonical bracket of {', '.join(ordered)}"
    return Bracket(_scalar(), _without_products(ordered), constant=constant, name=title).with_angles(angles)


def _with_momenta(coordinates: tuple[str, ...], momenta: Sequence[str] | None) -> tuple[str, ...]:
    own = tuple(f"p_{name}" for name in coordinates) if momenta is None else _names(momenta, "momenta")
    return (*coordinates, *own)


def _without_products(fields: tuple[str, ...]) -> Extension:
    """Fields whose products vanish: nothing of the bracket is linear."""
    return Extension.from_products(len(fields), {}, "without products", fields)


def _scalar() -> LieAlgebra:
    """The abelian algebra of dimension one whose coordinate is called like its field."""
    return LieAlgebra.from_brackets(1, {}, "abelian(1)", ("",), check=False)


def _names(given: Sequence[str], what: str) -> tuple[str, ...]:
    items = listed_names(given, what)
    if not items or not all(isinstance(item, str) for item in items):
        raise ShapeError(f'{what} must be a sequence of names; got {given!r:.60}. Write for example ("x", "y").')
    return tuple(map(str, items))
