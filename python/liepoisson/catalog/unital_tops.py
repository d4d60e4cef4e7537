r"""Lagrange's and Kovalevskaya's tops on every unital algebra: the systems, their integrals, their Lax pairs.

For $p \in A$ let $x_p = \sum_\mu p_\mu x_\mu$; $\ell = x_1$ belongs to the unit.  A top is coupled to elements $c_k$
of A by its three axes, $H = \tfrac12\,\ell\cdot I^{-1}\ell + \sum_k e_k\cdot x_{c_k}$, and with the bracket of
so(3) (x) A

$$\dot x_p = x_p\times\omega + \sum_k x_{p c_k}\times e_k, \qquad \omega = I^{-1}\ell.$$

**Lagrange**, $I_1 = I_2$ and $c_1 = c_2 = 0$, $c_3 = c$: since $\ell - I_1\omega$ is parallel to $e_3$ and
$I_1 c\,(z - I_1 c)^{-1} = z\,(z - I_1 c)^{-1} - 1$,

$$L(z) = e_3 + x_{(z - I_1 c)^{-1}}, \qquad \dot L = L\times(\omega + z\,e_3/I_1),$$
$$|L|^2 = 1 + 2\,(\ell_3/z + I_1 P_1/z^2 + I_1^2 P_2/z^3 + \dots), \qquad
P_k = I_1\,(x_{c^k})_3 + \tfrac12\sum_{i+j=k-1} x_{c^i}\cdot x_{c^j}.$$

**Kovalevskaya**, $I = (2, 2, 1)$ and $c_1 = x$, $c_2 = y$, $c_3 = k$ a number, with $u = x + iy$, $w = x^2 + y^2$.
If $u^2 = s$ is a complex number, then $\xi = (\omega_1 + i\omega_2)^2 - (x_u)_1 - i\,(x_u)_2 + s$ has
$\dot\xi = -i\ell_3\,\xi$ for k = 0, and for all k

$$K = |\xi|^2 + 2k\,\big(2\,(x_x)_3\,\omega_1 + 2\,(x_y)_3\,\omega_2
  - (\ell_3 + 2k)(\omega_1^2 + \omega_2^2) - (x_w)_3\big)$$

is an integral.  The Lax pair is one of so(3, 2), matrices with blocks of three and two rows: with
$S = \begin{pmatrix}\Re s & \Im s\\ \Im s & -\Re s\end{pmatrix}$, $N = \tfrac12(z - S/z)$, the matrix E of the columns
$e_1, e_2$, and $J = \begin{pmatrix}0 & -1\\ 1 & 0\end{pmatrix}$

$$L = \begin{pmatrix} \widehat{x_f} & P\\ P^T & -(\ell_3 + 2k)\det N\, J\end{pmatrix}, \quad
M = \begin{pmatrix}\widehat\omega + k\,\hat e_3 & E N\\ N E^T & 0\end{pmatrix}, \quad
f = \tfrac14(z^2 + |s|^2/z^2) - \tfrac12 w, \quad P = \det N\,E\,(z + S/z) - (x_x, x_y)\,N.$$
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.exact_numbers import read_number, to_sympy
from liepoisson.catalog.families import check_divisors, check_names, read_numbers
from liepoisson.errors import BracketError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_kind

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.formula.parameters import Parameter
    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.commutative_algebra import CommutativeAlgebra
    from liepoisson.structure.extension import Extension

Element: TypeAlias = "tuple[Any, ...]"
"""An element of A, by its coordinates as SymPy expressions."""

_KOVALEVSKAYA = (
    "A. I. Bobenko, A. G. Reyman and M. A. Semenov-Tian-Shansky, The Kowalewski top 99 years later, Communications in "
    "Mathematical Physics 122 (1989) 321, for two fields; I. V. Komarov, Kowalewski basis for the hydrogen atom, "
    "Theoretical and Mathematical Physics 47 (1981) 320, for so(4) and so(3,1)"
)
_LAGRANGE = (
    "T. Ratiu and P. van Moerbeke, The Lagrange rigid body motion, Annales de l'Institut Fourier 32 (1982) 211; F. "
    "Musso, M. Petrera, O. Ragnisco and G. Satta, arXiv:math-ph/0503002 (2005)"
)


@explains_its_arguments
def lagrange_top(
    extension: Extension, element: Sequence[Parameter], transverse: Parameter = 1, axial: Parameter = "1/2"
) -> System:
    r"""The symmetric top whose axis is coupled to an element c of a unital algebra A, on so(3) (x) A.

    $H = \tfrac12(\ell_1^2 + \ell_2^2)/I_1 + \tfrac12\ell_3^2/I_3 + (x_c)_3$, where $x_c = \sum_\mu c_\mu x_\mu$ and
    $\ell = x_1$ is the field of the unit.  Integrals, besides H and the Casimirs, are $\ell_3$ and

    $$P_k = I_1\,(x_{c^k})_3 + \tfrac12\sum_{i+j=k-1} x_{c^i}\cdot x_{c^j}, \qquad k = 2, \dots, m - 1,$$

    with the degree m of the minimal polynomial $\sum_i f_i z^i$ of c; and those of
    $P_{m+j} = \tfrac12\sum_i f_i \sum_{p+q=i+j-1} x_{c^p}\cdot x_{c^q}$, $j < m$, that are no Casimirs.  They commute.
    If $1, c, c^2, \dots$ span A, the top is Liouville integrable.  `known_lax_pair` gives its Lax pair.  Where the unit
    is not $e_0$, $P_0 = I_1\ell_3$ stands for $\ell_3$.

    Example:
        >>> top = lp.catalog.lagrange_top(lp.leibniz(3), [0, "a3", 0], "I1", "I3")
        >>> top.integrals["P2"]
        I1*a3**2*beta3 + a3*alpha1*l1 + a3*alpha2*l2 + a3*alpha3*l3
        >>> lp.integrability.known_lax_pair(top).integrals().is_complete
        True

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

    c = _read_element(extension, element, "element", "c")
    moments = read_numbers([transverse, axial], 2, "moments")
    check_divisors(moments, "moments of inertia")
    inverse = tuple(1 / moment for moment in moments)
    none = (S.Zero,) * extension.dimension
    top = UnitalTop(_bracket(extension), (inverse[0], *inverse), (none, none, c))
    plain = top.system("Lagrange top", {}, _LAGRANGE)
    found = {name: f for name, f in LagrangeTop(top).integrals.items() if not plain.is_casimir(f)}
    # where the unit is no element of the basis, l3 is the name of another function
    axial_part = (
        {"l3": top.momentum[2]} if top.unit[0] == 1 and not any(top.unit[1:]) else {"P0": moments[0] * top.momentum[2]}
    )
    return top.system("Lagrange top", axial_part | found, _LAGRANGE)


@explains_its_arguments
def kovalevskaya_top(
    extension: Extension, first: Sequence[Parameter], second: Sequence[Parameter], rotor: Parameter = 0
) -> System:
    r"""Kovalevskaya's top on so(3) (x) A, coupled to two elements x, y of a unital algebra A by its equator.

    $H = \tfrac14(\ell_1^2 + \ell_2^2) + \tfrac12\ell_3^2 + (x_x)_1 + (x_y)_2 + k\,\ell_3$, where
    $x_p = \sum_\mu p_\mu x_\mu$ and $\ell = x_1$ is the field of the unit.  If $(x + iy)^2$ is a complex number s, that
    is $x^2 - y^2$ and $xy$ are multiples of the unit, there is the integral

    $$K = \big|(\omega_1 + i\omega_2)^2 - (x_{x + iy})_1 - i\,(x_{x + iy})_2 + s\big|^2$$

    for k = 0, with $\omega = (\ell_1/2, \ell_2/2, \ell_3)$, and one with further terms for other k
    (`liepoisson.catalog.unital_tops`); `known_lax_pair` gives a Lax pair.  Such are the tops of one and of two fields,
    those of so(4) and so(3, 1), and twists of two and three fields.
    Otherwise the system has no known integrals.

    Example:
        >>> top = lp.catalog.kovalevskaya_top(lp.extensions.binary_cubic(0, 1, 0, 1), [0, 1, 0], [0, 0, 1])
        >>> list(top.invariants), list(lp.catalog.kovalevskaya_top(lp.leibniz(3), [0, 1, 0], [0, 0, 1]).invariants)
        (['H', 'C1', 'C2', 'C3', 'K'], ['H', 'C1', 'C2', 'C3'])
        >>> lp.integrability.known_lax_pair(top).integrals().is_complete
        True

    Args:
        extension: The algebra A.
        first: The coordinates of x in the basis of A.
        second: The coordinates of y.
        rotor: The angular velocity k that a rotor along the third axis adds.

    Raises:
        BracketError: A has no unit.
        ShapeError: x or y does not have as many coordinates as A has basis elements.
        ParameterError: a parameter is not exact.

    References: [bobenko1989]; [komarov1981], for so(4) and so(3, 1).
    """
    from sympy import S

    x, y = _read_element(extension, first, "first", "x"), _read_element(extension, second, "second", "y")
    (k,) = read_numbers([rotor], 1, "rotor")
    bracket = _bracket(extension)
    top = UnitalTop(bracket, (S.Half, S.Half, S.One), (x, y, (S.Zero,) * extension.dimension))
    top = UnitalTop(bracket, top.rates, (x, y, tuple(k * u for u in top.unit)))
    own = KovalevskayaTop(top)
    return top.system("Kovalevskaya top", {"K": own.integral} if own.square is not None else {}, _KOVALEVSKAYA)


def _read_element(extension: Extension, given: Sequence[Parameter], name: str, letter: str) -> Element:
    from liepoisson.structure.extension import Extension

    check_kind(extension, Extension, "extension", "an algebra", "write for example lp.leibniz(3)")
    if not extension.is_unital:
        raise BracketError(
            f"extension: wanted an algebra with a unit, whose field is the angular momentum; {extension.name} has "
            "none. Add one"
        )
    return tuple(read_numbers(given, extension.dimension, name, letter))


def _bracket(extension: Extension) -> Bracket:
    from liepoisson.structure.lie_algebras import so

    return so(3) @ extension


@dataclass(frozen=True)
class UnitalTop:
    """A top on so(3) (x) A whose three axes are coupled to elements of A.

    Attributes:
        bracket: That of so(3) (x) A, A with unit.
        rates: The inverse moments of inertia.
        elements: $c_1, c_2, c_3$.
    """

    bracket: Bracket
    rates: tuple[Any, Any, Any]
    elements: tuple[Element, Element, Element]

    def __post_init__(self) -> None:
        """Refuses parameters that are named like coordinates."""
        check_names(self.bracket, [*self.rates, *(value for element in self.elements for value in element)])

    @cached_property
    def algebra(self) -> CommutativeAlgebra:
        """The algebra A over a field that contains the coordinates of the elements."""
        from liepoisson.algebra.real_fields import real_field
        from liepoisson.structure.commutative_algebra import CommutativeAlgebra

        extension = self.bracket.extension
        values = [read_number(value, "element") for element in self.elements for value in element]
        field = real_field([*values, *(v for row in extension.products.values() for v in row.values())])
        return CommutativeAlgebra(extension.dimension, extension.products, field)

    def read(self, element: Element) -> tuple[Any, ...]:
        """An element in the arithmetic of `algebra`."""
        return tuple(self.algebra.field.read(read_number(value, "element")) for value in element)

    def write(self, element: Sequence[Any]) -> Element:
        """An element of `algebra` as expressions."""
        return tuple(to_sympy(self.algebra.field.write(value)) for value in element)

    @cached_property
    def unit(self) -> Element:
        """The unit."""
        assert self.algebra.unit is not None
        return self.write(self.algebra.unit)

    def product(self, first: Element, second: Element) -> Element:
        """The product of two elements."""
        return self.write(self.algebra.multiply(self.read(first), self.read(second)))

    def vector(self, element: Sequence[Any]) -> tuple[Any, Any, Any]:
        """The vector $x_p$ of an element."""
        from sympy import S

        fields = list(self.bracket.fields.values())
        x, y, z = (sum((p * x[i] for p, x in zip(element, fields, strict=True)), S.Zero).expand() for i in range(3))
        return x, y, z

    @cached_property
    def momentum(self) -> tuple[Any, Any, Any]:
        """The angular momentum."""
        return self.vector(self.unit)

    @property
    def omega(self) -> list[Any]:
        """The angular velocity."""
        return [rate * x for rate, x in zip(self.rates, self.momentum, strict=True)]

    @property
    def hamiltonian(self) -> Any:
        """The Hamiltonian."""
        kinetic = sum(rate * x**2 for rate, x in zip(self.rates, self.momentum, strict=True)) / 2
        return kinetic + sum(self.vector(element)[k] for k, element in enumerate(self.elements))

    def system(self, name: str, integrals: dict[str, Expr], source: str) -> System:
        """The system, with integrals."""
        from liepoisson.model.hamiltonian import symbols_in
        from liepoisson.model.system import System

        return System(
            self.bracket,
            self.hamiltonian,
            name=f"{name} on {self.bracket.extension.name}",
            symbols=symbols_in(self.hamiltonian, self.bracket.coordinate_names),
            integrals=integrals,
            source=source,
        )


def unital_top(system: System) -> UnitalTop | None:
    """A system as a top whose axes are coupled to elements of A; None if it is none."""
    from sympy import Poly

    from liepoisson.structure.lie_algebras import so

    bracket, H = system.bracket, system.hamiltonian
    unit = None if bracket.constant or bracket.algebra.brackets != so(3).brackets else bracket.extension.unit()
    if unit is None or not H.is_polynomial(*system.variables):
        return None
    fields, terms = list(bracket.fields.values()), Poly(H, *system.variables)
    first, second, third = (tuple(terms.coeff_monomial(x[k]) for x in fields) for k in range(3))
    n, weight = next((n, to_sympy(u)) for n, u in enumerate(unit) if u)
    one, two, three = (2 * terms.coeff_monomial(x**2) / weight**2 for x in fields[n])
    top = UnitalTop(bracket, (one, two, three), (first, second, third))
    return top if (H - top.hamiltonian).expand() == 0 else None


@dataclass(frozen=True)
class LagrangeTop:
    """What belongs to a symmetric top whose axis alone is coupled.

    Attributes:
        top: The top.
    """

    top: UnitalTop

    @property
    def holds(self) -> bool:
        """Whether the top is such a one."""
        rates, (first, second, _) = self.top.rates, self.top.elements
        return not any((*first, *second)) and not rates[0].is_zero and (rates[0] - rates[1]).equals(0)

    @cached_property
    def minimal(self) -> list[Any]:
        """The coefficients of the minimal polynomial of c, the constant one first."""
        top = self.top
        return list(top.write(top.algebra.minimal_polynomial(top.read(top.elements[2]))))[::-1]

    @cached_property
    def vectors(self) -> list[tuple[Any, Any, Any]]:
        r"""The vectors of $1, c, c^2, \dots$, twice as many as the degree of the minimal polynomial."""
        power, found = self.top.unit, list[tuple[Any, Any, Any]]()
        for _ in range(2 * len(self.minimal) - 2):
            found.append(self.top.vector(power))
            power = self.top.product(power, self.top.elements[2])
        return found

    @cached_property
    def integrals(self) -> dict[str, Expr]:
        """P_k, k = 2, ..., 2 m - 1, by name; from k = m on the combinations without linear terms."""
        m, moment = len(self.minimal) - 1, 1 / self.top.rates[0]
        found = {k: moment * self.vectors[k][2] + self._products(k) for k in range(2, m)}
        found |= {m + j: sum(f * self._products(i + j) for i, f in enumerate(self.minimal)) for j in range(m)}
        return {f"P{k}": f.expand() for k, f in found.items()}

    def _products(self, k: int) -> Any:
        r"""The sum $\tfrac12\sum_{i+j=k-1} x_{c^i}\cdot x_{c^j}$."""
        from sympy import S

        pairs = [zip(self.vectors[i], self.vectors[k - 1 - i], strict=True) for i in range(k)]
        return sum((u * v for pair in pairs for u, v in pair), S.Zero) / 2

    def lax_entries(self, z: Any) -> tuple[list[Any], list[Any]]:
        """L and M as elements of so(3); L is multiplied by the minimal polynomial of I1 c in z."""
        moment, m = 1 / self.top.rates[0], len(self.minimal) - 1
        polynomial = [f * moment ** (m - i) for i, f in enumerate(self.minimal)]
        entries: list[Any] = [0, 0, sum(f * z**i for i, f in enumerate(polynomial))]
        for i, f in enumerate(polynomial):
            for j in range(i):  # (z^i - b^i)/(z - b) for b = I1 c
                term = f * z**j * moment ** (i - 1 - j)
                entries = [e + term * x for e, x in zip(entries, self.vectors[i - 1 - j], strict=True)]
        one, two, three = self.top.omega
        return entries, [one, two, three + z / moment]


@dataclass(frozen=True)
class KovalevskayaTop:
    """What belongs to a top with I = (2, 2, 1) that is coupled by its equator.

    Attributes:
        top: The top.
    """

    top: UnitalTop

    @property
    def holds(self) -> bool:
        """Whether the top is such a one, with its integral."""
        across, _, along = self.top.rates
        equal = all(
            (rate - value).equals(0) for rate, value in zip(self.top.rates, (along / 2, along / 2, 1), strict=True)
        )
        return bool(equal and across) and self.rotor is not None and self.square is not None

    def _number(self, element: Element) -> Any:
        """The number of which an element is the multiple of the unit; None if it is none."""
        n = next(n for n, u in enumerate(self.top.unit) if u != 0)
        number = element[n] / self.top.unit[n]
        return number if all((p - number * u).equals(0) for p, u in zip(element, self.top.unit, strict=True)) else None

    @cached_property
    def rotor(self) -> Any:
        """The number k; None if the third axis is coupled to another element than a number."""
        return self._number(self.top.elements[2])

    @cached_property
    def _squares(self) -> tuple[Element, Element, Element]:
        x, y, _ = self.top.elements
        return self.top.product(x, x), self.top.product(x, y), self.top.product(y, y)

    @cached_property
    def square(self) -> tuple[Any, Any] | None:
        """The real and the imaginary part of s = (x + iy)^2; None if that is no number."""
        xx, xy, yy = self._squares
        parts = (self._number(tuple(p - q for p, q in zip(xx, yy, strict=True))), self._number(xy))
        return None if parts[0] is None or parts[1] is None else (parts[0], 2 * parts[1])

    @cached_property
    def _norm(self) -> tuple[Any, Any, Any]:
        """The vector of w."""
        xx, _, yy = self._squares
        return self.top.vector([p + q for p, q in zip(xx, yy, strict=True)])

    @cached_property
    def integral(self) -> Expr:
        """K."""
        assert self.square is not None
        (first, second, _), k = self.top.omega, self.rotor
        X, Y = (self.top.vector(element) for element in self.top.elements[:2])
        real = first**2 - second**2 - X[0] + Y[1] + self.square[0]
        imaginary = 2 * first * second - X[1] - Y[0] + self.square[1]
        further = (
            2 * (X[2] * first + Y[2] * second) - (self.top.momentum[2] + 2 * k) * (first**2 + second**2) - self._norm[2]
        )
        return real**2 + imaginary**2 + 2 * k * further

    def lax_entries(self, z: Any) -> tuple[list[list[Any]], list[list[Any]]]:
        """L and M as matrices of so(3, 2), L times 4 z^2 where s is not 0."""
        from sympy import Matrix, eye, zeros

        assert self.square is not None
        (a, b), k = self.square, self.rotor
        S, norm = Matrix([[a, b], [b, -a]]), a**2 + b**2
        N = (z * eye(2) - S / z) / 2
        determinant = (z**2 - norm / z**2) / 4
        E = Matrix([[1, 0], [0, 1], [0, 0]])
        X, Y = (Matrix(self.top.vector(element)) for element in self.top.elements[:2])
        f = [(z**2 + norm / z**2) / 4 * p - q / 2 for p, q in zip(self.top.momentum, self._norm, strict=True)]
        P = determinant * E * (z * eye(2) + S / z) - Matrix.hstack(X, Y) * N
        L, M = zeros(5), zeros(5)
        L[:3, :3], L[:3, 3:], L[3:, :3] = _hat(f), P, P.T
        L[4, 3] = -(self.top.momentum[2] + 2 * k) * determinant
        L[3, 4] = -L[4, 3]
        one, two, three = self.top.omega
        M[:3, :3], M[:3, 3:], M[3:, :3] = _hat((one, two, three + k)), E * N, (E * N).T
        return L.expand().tolist(), M.expand().tolist()


def _hat(v: Sequence[Any]) -> Any:
    """The matrix of the cross product with a vector."""
    from sympy import Matrix

    return Matrix([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
