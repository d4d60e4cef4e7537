"""The magnetic field that a bracket was made of, from which it is made again: what files and copies keep of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from liepoisson.algebra.exact_numbers import is_zero

if TYPE_CHECKING:
    from sympy import Expr


@dataclass(frozen=True)
class MagneticField:
    """A field B, a charge and a mass, and whether the bracket is that of a charge or of its guiding centre.

    Attributes:
        kind: The function of `magnetic_brackets` that made the bracket.
        components: B, in the places.
        charge: e.
        mass: m.
    """

    kind: Literal["magnetic", "guiding_centre"]
    components: tuple[Expr, ...]
    charge: Expr
    mass: Expr

    def mapped(self, change: Callable[[Any], Any]) -> MagneticField | None:
        """The same with other names, or with values for symbols; None where a component vanishes that did not.

        A field along one axis has b along this axis, whatever its sign, so that the bracket of a field that comes to
        lie along one is not the one that is made of this field.
        """
        components = tuple(map(change, self.components))
        if [is_zero(one) for one in components] != [is_zero(one) for one in self.components]:
            return None
        return MagneticField(self.kind, components, change(self.charge), change(self.mass))
