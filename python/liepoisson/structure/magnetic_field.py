"""The magnetic field that a bracket was made of, from which it is made again: what files and copies keep of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.errors import ParameterError
from liepoisson.structure.certificates import Failure, JacobiCertificate
from liepoisson.structure.poisson.tensor_entries import N_POINTS, TensorEntries

if TYPE_CHECKING:
    from sympy import Expr, Symbol


@dataclass(frozen=True)
class MagneticField:
    """A field B, a charge and a mass, and whether the bracket is that of a charge or of its guiding centre.

    Attributes:
        kind: The function of `magnetic_brackets` that made the bracket.
        components: B, in the places.
        charge: e.
        mass: m.

    Raises:
        ParameterError: the mass is not positive, or a guiding centre has no charge.
    """

    kind: Literal["magnetic", "guiding_centre"]
    components: tuple[Expr, ...]
    charge: Expr
    mass: Expr

    def __post_init__(self) -> None:
        """Refuses what no particle has; symbols are taken."""
        if is_zero(self.mass) or self.mass.is_negative:
            raise ParameterError(f"mass: wanted a positive number; got {self.mass}; try mass=1")
        if self.kind == "guiding_centre" and is_zero(self.charge):
            raise ParameterError(f"charge: wanted a number other than 0; got {self.charge}; try charge=1")

    def mapped(self, change: Callable[[Any], Any]) -> MagneticField | None:
        """The same with other names, or with values for symbols; None where a component vanishes that did not.

        A field along one axis has b along this axis, whatever its sign, so that the bracket of a field that comes to
        lie along one is not the one that is made of this field.
        """
        components = tuple(map(change, self.components))
        if [is_zero(one) for one in components] != [is_zero(one) for one in self.components]:
            return None
        return MagneticField(self.kind, components, change(self.charge), change(self.mass))

    def jacobi_certificate(self, variables: Sequence[Symbol], n_triples: int) -> JacobiCertificate:
        r"""The Jacobi identity of the bracket by div B = 0, which is decided now.

        That is the identity of $\{x_i, v_j\} = \delta_{ij}$, $\{v_i, v_j\} = \epsilon_{ijk} B_k$, whose one cyclic sum
        that could fail is div B.
        """
        from sympy import Dummy, S

        follows = f"div B = 0, from which it follows for all {n_triples} triples of coordinates"
        if len(self.components) == 1:
            return JacobiCertificate(True, n_triples, f"computed: {follows}")
        B: Any = self.components
        entries: dict[tuple[int, int], Any] = {(i, 3 + i): S.One for i in range(3)}
        entries |= {(3, 4): B[2], (4, 5): B[0], (3, 5): -B[1]}
        places = variables[:3]
        unit = TensorEntries((*places, *(Dummy() for _ in places)), {p: f for p, f in entries.items() if f != 0})
        residual = unit.jacobi_residual((3, 4, 5))
        is_tried = residual is None
        if is_tried:
            residual = unit.jacobi_fails_at_a_point((3, 4, 5))
        if residual is not None and residual != 0:
            total: Any = sum(one.diff(x) for one, x in zip(B, places, strict=True))
            return JacobiCertificate(False, n_triples, "computed: div B", (Failure(("div B",), total),))
        if is_tried:
            tried = f"tried: at {N_POINTS} random points in decimals {follows}"
            return JacobiCertificate(True, n_triples, tried, n_points=N_POINTS)
        return JacobiCertificate(True, n_triples, f"computed: {follows}")
