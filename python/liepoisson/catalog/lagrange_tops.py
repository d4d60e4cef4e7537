r"""Lagrange's top on every unital algebra: the system, its integrals, its Lax pair.

With $x_p = \sum_\mu p_\mu x_\mu$ for $p \in A$, and $\ell = x_1$ the field of the unit, the top has

$$H = \tfrac12\,\ell\cdot\omega + e_3\cdot x_c, \qquad \omega = (\ell_1/I_1, \ell_2/I_1, \ell_3/I_3), \qquad
\dot x_p = x_p\times\omega + x_{pc}\times e_3,$$

and with $L(z) = e_3 + x_{(z - I_1 c)^{-1}}$ that is $\dot L = L\times(\omega + z\,e_3/I_1)$, since
$I_1 c\,(z - I_1 c)^{-1} = z\,(z - I_1 c)^{-1} - 1$ and $\ell - I_1\omega$ is parallel to $e_3$.  So the coefficients of
$|L|^2 = 1 + 2\,(\ell_3/z + I_1 P_1/z^2 + I_1^2 P_2/z^3 + \dots)$ are integrals,

$$P_k = (x_{c^k})_3\, I_1^{\,} + \tfrac12\sum_{i+j=k-1} x_{c^i}\cdot x_{c^j}.$$
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import is_zero, read_number, to_sympy
from liepoisson.catalog.families import check_divisors, read_numbers
from liepoisson.errors import BracketError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_kind

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.formula.parameters import Parameter
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.extension import Extension

_AXIS = 2
"""Of the third component."""


@explains_its_arguments
def lagrange_top(
    extension: Extension, element: Sequence[Parameter], transverse: Parameter = 1, axial: Parameter = "1/2"
) -> System:
    r"""The symmetric top whose axis is coupled to an element c of a unital algebra A, on so(3) (x) A.

    $H = \tfrac12(\ell_1^2 + \ell_2^2)/I_1 + \tfrac12\ell_3^2/I_3 + (x_c)_3$, where $x_c = \sum_\mu c_\mu x_\mu$ and
    $\ell = x_1$ is the field of the unit.  Integrals, besides H and the Casimirs, are $\ell_3$ and

    $$P_k = I_1\,(x_{c^k})_3 + \tfrac12\sum_{i+j=k-1} x_{c^i}\cdot x_{c^j}, \qquad k = 2, \dots, m - 1,$$

    with the degree m of the minimal polynomial $f = \sum_i f_i z^i$ of c; and those of
    $P_{m+j} = \tfrac12\sum_i f_i \sum_{p+q=i+j-1} x_{c^p}\cdot x_{c^q}$, $j < m$, that are no Casimirs.  They commute.
    If $1, c, c^2, \dots$ span A, the top is Liouville integrable.  `known_lax_pair` gives its Lax pair.

    Example:
        >>> top = lp.catalog.lagrange_top(lp.extensions.binary_cubic(0, 1, -1, 0), [0, "a3", "b3"], "I1", "I3")
        >>> top.integrals["P2"]
        I1*a3**2*alpha3 + I1*b3**2*beta3 + a3*alpha1*l1 + a3*alpha2*l2 + a3*alpha3*l3 + b3*beta1*l1 + b3*beta2*l2 + b3*beta3*l3
        >>> top.is_constant("P2"), lp.integrability.known_lax_pair(top).integrals().is_complete
        (True, True)

    Args:
        extension: The algebra A.
        element: The coordinates of c in the basis of A; the part along the unit is a rotor on the axis.
        transverse: The moment of inertia $I_1 = I_2$.
        axial: The moment of inertia $I_3$ about the axis.

    Raises:
        BracketError: A has no unit.
        ShapeError: c does not have as many coordinates as A has basis elements.
        ParameterError: a parameter is not exact, or a moment is zero.

    References: [ratiu1982]; [musso2005], for truncated polynomials.
    """
    from sympy import S

    from liepoisson.model.hamiltonian import symbols_in
    from liepoisson.model.system import System
    from liepoisson.structure.extension import Extension
    from liepoisson.structure.lie_algebras import so

    check_kind(extension, Extension, "extension", "an algebra", "write for example lp.leibniz(3)")
    if not extension.is_unital:
        raise BracketError(
            f"extension: wanted an algebra with a unit, whose field is the angular momentum; {extension.name} has "
            "none. Add one"
        )
    c = read_numbers(element, extension.dimension, "element", "c")
    moments = read_numbers([transverse, axial], 2, "moments")
    check_divisors(moments, "moments of inertia")
    bracket = so(3) @ extension
    top = AxialTop(bracket, tuple(c), (1 / moments[0], 1 / moments[1]))
    l = top.field(top.powers[0])
    energy = (l[0] ** 2 + l[1] ** 2) / (2 * moments[0]) + l[2] ** 2 / (2 * moments[1])
    energy += sum((k * x[_AXIS] for k, x in zip(c, bracket.fields.values(), strict=True)), S.Zero)
    plain = System(bracket, energy, symbols=symbols_in(energy, bracket.coordinate_names))
    integrals = {"l3": l[_AXIS]} | {name: f for name, f in top.integrals.items() if not plain.is_casimir(f)}
    return System(
        bracket,
        energy,
        name=f"Lagrange top on {extension.name}",
        symbols=plain.as_given.symbols,
        integrals=integrals,
        source="T. Ratiu and P. van Moerbeke, The Lagrange rigid body motion, Annales de l'Institut Fourier 32 (1982) "
        "211; F. Musso, M. Petrera, O. Ragnisco and G. Satta, arXiv:math-ph/0503002 (2005)",
    )


@dataclass(frozen=True)
class AxialTop:
    """A symmetric top whose axis is coupled to one element of the algebra.

    Attributes:
        bracket: That of so(3) (x) A, A with unit.
        element: The coordinates of c.
        rates: $1/I_1$ and $1/I_3$.
    """

    bracket: Bracket
    element: tuple[Any, ...]
    rates: tuple[Any, Any]

    @property
    def transverse(self) -> Any:
        """The moment of inertia across the axis."""
        return 1 / self.rates[0]

    @cached_property
    def _solved(self) -> tuple[list[tuple[Any, ...]], list[Any]]:
        """The powers of c, twice as many as the degree of its minimal polynomial, and this."""
        from liepoisson.algebra.real_fields import real_field
        from liepoisson.structure.commutative_algebra import CommutativeAlgebra

        extension = self.bracket.extension
        given = [read_number(value, "element") for value in self.element]
        field = real_field([*given, *(v for row in extension.products.values() for v in row.values())])
        algebra = CommutativeAlgebra(extension.dimension, extension.products, field)
        c = tuple(map(field.read, given))
        polynomial = algebra.minimal_polynomial(c)
        powers = [algebra.unit or c]
        for _ in range(2 * len(polynomial)):
            powers.append(algebra.multiply(powers[-1], c))
        write = lambda value: to_sympy(field.write(value))  # noqa: E731
        return [tuple(map(write, power)) for power in powers], [write(f) for f in polynomial]

    @property
    def powers(self) -> list[tuple[Any, ...]]:
        r"""$1, c, c^2, \dots$ by their coordinates."""
        return self._solved[0]

    @property
    def minimal(self) -> list[Any]:
        """The coefficients of the minimal polynomial of c, the constant one first."""
        return self._solved[1][::-1]

    def field(self, element: Sequence[Any]) -> tuple[Any, Any, Any]:
        """The vector of an element of A."""
        fields = list(self.bracket.fields.values())
        x, y, z = (sum(p * x[i] for p, x in zip(element, fields, strict=True)).expand() for i in range(3))
        return x, y, z

    @cached_property
    def integrals(self) -> dict[str, Expr]:
        """P_k, k = 2, ..., 2 m - 1, by name; from k = m on without the terms that are linear."""
        m = len(self.minimal) - 1
        found = {k: self.transverse * self.field(self.powers[k])[_AXIS] + self._products(k) for k in range(2, m)}
        found |= {m + j: sum(f * self._products(i + j) for i, f in enumerate(self.minimal)) for j in range(m)}
        return {f"P{k}": f.expand() for k, f in found.items()}

    def _products(self, k: int) -> Any:
        r"""$\tfrac12\sum_{i+j=k-1} x_{c^i}\cdot x_{c^j}$"""
        from sympy import S

        x = [self.field(power) for power in self.powers[:k]]
        return sum((u * v for i in range(k) for u, v in zip(x[i], x[k - 1 - i], strict=True)), S.Zero) / 2

    def lax_entries(self, spectral: Any) -> tuple[list[Any], list[Any]]:
        """L and M of the Lax pair as elements of so(3); L is multiplied by the minimal polynomial of I1 c in z."""
        I1, m = self.transverse, len(self.minimal) - 1
        polynomial = [f * I1 ** (m - i) for i, f in enumerate(self.minimal)]
        L: list[Any] = [0, 0, sum(f * spectral**i for i, f in enumerate(polynomial))]
        for i, f in enumerate(polynomial):
            for j in range(i):
                x = self.field(self.powers[i - 1 - j])
                L = [e + f * spectral**j * I1 ** (i - 1 - j) * x[k] for k, e in enumerate(L)]
        l, (across, along) = self.field(self.powers[0]), self.rates
        return L, [across * l[0], across * l[1], along * l[2] + across * spectral]


def axial_top(system: System) -> AxialTop | None:
    """The system as a symmetric top whose axis is coupled to an element of A; None if it is none."""
    from sympy import Poly, S

    from liepoisson.structure.lie_algebras import so

    bracket, H = system.bracket, system.hamiltonian
    if bracket.constant or bracket.algebra.brackets != so(3).brackets or not H.is_polynomial(*system.variables):
        return None
    unit = bracket.extension.unit()
    if unit is None:
        return None
    linear = Poly(H, *system.variables)
    element = [linear.coeff_monomial(x[_AXIS]) for x in bracket.fields.values()]
    probe = AxialTop(bracket, tuple(element), (S.One, S.One))
    l = probe.field(probe.powers[0])
    k = next(k for k, u in enumerate(unit) if not is_zero(u))
    twice = [2 * linear.coeff_monomial(x**2) / to_sympy(unit[k]) ** 2 for x in list(bracket.fields.values())[k]]
    kinetic = sum(value * x**2 for value, x in zip(twice, l, strict=True)) / 2
    potential = sum(c * x[_AXIS] for c, x in zip(element, bracket.fields.values(), strict=True))
    if (twice[0] - twice[1]).equals(0) and not twice[0].is_zero and (H - kinetic - potential).expand() == 0:
        return AxialTop(bracket, tuple(element), (twice[0], twice[2]))
    return None
