r"""Brackets of a charged particle in a magnetic field B(x): of its place and velocity, and of its guiding centre.

Both are brackets if and only if div B = 0, which is decided for rational fields, proved for others where no relation
between functions is needed, and else tried at random points in decimals.  The first has the cyclic sum
$(e/m^3)\,\mathrm{div} B$ for the three velocities.  The second is the inverse of the closed form
$d((e A + m u\,b)\cdot dX)$, $B = \mathrm{curl} A$.

References: Souriau, Structure des systèmes dynamiques (1970); Littlejohn, J. Plasma Phys. 29 (1983) 111; Cary and
Brizard, Rev. Mod. Phys. 81 (2009) 693, section III.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.errors import BracketError, JacobiError, ShapeError
from liepoisson.formula.parameters import GivenValue, Parameter
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed
from liepoisson.structure.given_functions import read_function, read_variables, scope_with
from liepoisson.structure.magnetic_field import MagneticField
from liepoisson.structure.tensor_bracket import PoissonTensor, tensor_of

if TYPE_CHECKING:
    from sympy import Expr

_EVEN = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


@explains_its_arguments
def magnetic(
    field: Sequence[str | Expr],
    variables: Sequence[str] = ("x", "y", "z", "v_x", "v_y", "v_z"),
    parameters: Mapping[str, GivenValue] | None = None,
    *,
    charge: Parameter = 1,
    mass: Parameter = 1,
    symbols: Sequence[str] = (),
) -> PoissonTensor:
    r"""The bracket of a charged particle in a magnetic field, in its place x and velocity v.

    $$\{x_i, v_j\} = \delta_{ij}/m, \qquad \{v_i, v_j\} = (e/m^2)\,\epsilon_{ijk}\,B_k(x) .$$

    With $H = m v^2/2 + e\,\Phi(x)$ the equations are $\dot x = v$, $m\dot v = e\,(v\times B - \nabla\Phi)$; no vector
    potential is needed.  A field of one component is perpendicular to a plane, with four coordinates x, y, v_x, v_y.

    Example:
        >>> bracket = lp.brackets.magnetic(["0", "0", "B"], symbols=["B"])
        >>> lp.System(bracket, "(v_x^2 + v_y^2 + v_z^2)/2").equations
        {x: v_x, y: v_y, z: v_z, v_x: B*v_y, v_y: -B*v_x, v_z: 0}

    Args:
        field: B, formulas in the places.
        variables: Names of the places, and then of the velocities.
        parameters: Values of other names.
        charge: e, a number or the name of a parameter.
        mass: m, positive, a number or the name of a parameter.
        symbols: Names that stay symbolic.

    Raises:
        JacobiError: the divergence of B is not zero, so that the Jacobi identity fails for the velocities.
        ShapeError: B has not three components, or one, or not two names for each coordinate of space.
        BracketError: a field depends on velocities.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        ParameterError: a name is none that a user may choose, or the mass is not positive.

    References: Souriau, Structure des systèmes dynamiques (1970).
    """
    items = _components(field)
    given: Sequence[str] = variables
    if len(items) == 1 and given == ("x", "y", "z", "v_x", "v_y", "v_z"):
        given = ("x", "y", "v_x", "v_y")
    names = read_variables(given)
    n = 2 if len(items) == 1 else 3
    if len(names) != 2 * n:
        raise ShapeError(
            f"variables must be {2 * n} names, of {n} places and then of their velocities; got {len(names)}."
        )
    scope = scope_with(names, parameters, symbols)
    e, m = (cast("Any", read_function(one, scope, what)) for one, what in ((charge, "charge"), (mass, "mass")))
    B = _field(items, names, n, scope)
    x, origin = _symbols(names), MagneticField("magnetic", tuple(B), e, m)
    entries: dict[tuple[int, int], Any] = {(i, n + i): 1 / m for i in range(n)}
    if n == 2:
        entries[2, 3] = e / m**2 * B[0]
        return tensor_of(names, entries, jacobi="proved", origin=origin)
    how = _divergence(origin, x, names[3:], e / m**3)
    entries |= {(3, 4): e / m**2 * B[2], (4, 5): e / m**2 * B[0], (3, 5): -e / m**2 * B[1]}
    return tensor_of(names, entries, jacobi=how, origin=origin)


@explains_its_arguments
def guiding_centre(
    field: Sequence[str | Expr],
    variables: Sequence[str] = ("x", "y", "z", "u"),
    parameters: Mapping[str, GivenValue] | None = None,
    *,
    charge: Parameter = 1,
    mass: Parameter = 1,
    symbols: Sequence[str] = (),
) -> PoissonTensor:
    r"""Littlejohn's bracket of the guiding centre of a charged particle, in its place X and velocity u along the field.

    With $b = B/|B|$, $B^* = B + (m/e)\,u\,\mathrm{curl}\,b$ and $B^*_\parallel = b\cdot B^*$

    $$\{X_i, X_j\} = -\frac{\epsilon_{ijk}\,b_k}{e B^*_\parallel}, \qquad
      \{X_i, u\} = \frac{B^*_i}{m B^*_\parallel} .$$

    With $H = m u^2/2 + \mu|B| + e\,\Phi$ and the magnetic moment $\mu = m v_\perp^2/(2|B|)$ it follows the mean motion
    of a particle to first order in its radius of gyration, $m v_\perp/(e|B|)$, over times in which it gyrates often.
    A field along one axis alone has $b$ along that axis, whatever its sign.

    Example:
        >>> bracket = lp.brackets.guiding_centre(["0", "0", "1 + y"])
        >>> lp.System(bracket, "u^2/2 + mu*(1 + y)", {"mu": 2}).equations
        {x: -2/(y + 1), y: 0, z: u, u: 0}

    Args:
        field: B, three formulas in the places.
        variables: Names of the places, and of the velocity along the field.
        parameters: Values of other names.
        charge: e, a number or the name of a parameter, not zero.
        mass: m, positive, a number or the name of a parameter.
        symbols: Names that stay symbolic.

    Raises:
        JacobiError: the divergence of B is not zero, so that the Jacobi identity fails for the places.
        ShapeError: B has not three components, or there are not four names.
        BracketError: B is zero, or depends on the velocity.
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        ParameterError: a name is none that a user may choose, the mass is not positive, or
            the charge is zero.

    References: Littlejohn, J. Plasma Phys. 29 (1983) 111; Cary and Brizard, Rev. Mod. Phys. 81 (2009) 693.
    """
    from sympy import sqrt

    items, names = _components(field), read_variables(variables)
    if len(items) != 3:
        raise ShapeError(f"field must have three components; got {len(items)}. Give zeros, too.")
    if len(names) != 4:
        raise ShapeError(f"variables must be four names, of three places and of the velocity; got {len(names)}.")
    scope = scope_with(names, parameters, symbols)
    e, m = (cast("Any", read_function(one, scope, what)) for one, what in ((charge, "charge"), (mass, "mass")))
    B = _field(items, names, 3, scope)
    *x, u = _symbols(names)
    occurring = [one for one in B if not is_zero(one)]
    if not occurring:
        raise BracketError("a guiding centre needs a magnetic field; got B = 0. Take lp.brackets.magnetic.")
    origin = MagneticField("guiding_centre", tuple(B), e, m)
    how = _divergence(origin, x, names[:3], -m / e**2)
    s = occurring[0] if len(occurring) == 1 else sqrt(_short(sum(one**2 for one in B)))
    S, curl = _short(s**2), [_short(B[k].diff(x[j]) - B[j].diff(x[k])) for _, j, k in _EVEN]
    slopes = [_short(S.diff(v)) for v in x]
    # s curl b, and s times B*_parallel
    turn = [_short(curl[i] - (slopes[j] * B[k] - slopes[k] * B[j]) / (2 * S)) for i, j, k in _EVEN]
    along = S + m / e * u * _short(sum(B[i] * curl[i] for i in range(3))) / s
    entries: dict[tuple[int, int], Any] = {
        (i, 3): _short((s * B[i] + m / e * u * turn[i]) / (m * along)) for i in range(3)
    }
    for i, j, k in _EVEN:
        entry = _short(B[k] / (e * along))
        entries[min(i, j), max(i, j)] = -entry if i < j else entry
    kept = {pair: entry for pair, entry in entries.items() if entry != 0}
    return tensor_of(names, kept, jacobi=how, are_nonzero=True, origin=origin)


def _components(field: Any) -> list[Any]:
    items = listed(field, "field")
    if items is None or len(items) not in (1, 3):
        raise ShapeError(
            f'field must be three formulas, or one for a plane; got {field!r:.60}. Write for example ["0", "0", "B"].'
        )
    return items


def _field(items: Sequence[Any], names: tuple[str, ...], n: int, scope: Any) -> list[Any]:
    B: list[Any] = [read_function(one, scope, f"B_{k + 1}") for k, one in enumerate(items)]
    velocities = {str(s) for one in B for s in one.free_symbols} & {*names[n:]}
    if velocities:
        raise BracketError(f"a magnetic field must depend on the place alone; got {min(velocities)} in it.")
    return B


def _symbols(names: Sequence[str]) -> list[Any]:
    from sympy import Symbol

    return [Symbol(name) for name in names]


def _divergence(field: MagneticField, x: Sequence[Any], names: Sequence[str], factor: Any) -> str:
    """How it is known that div B = 0, "proved" or "sampled"; `factor` is that of div B in the cyclic sum of `names`.

    Raises:
        JacobiError: it is not zero.
    """
    certificate = field.jacobi_certificate(x, 1)
    if certificate.holds:
        return "proved" if certificate.proved else "sampled"
    shown, size = _short(factor * cast("Any", certificate.failures[0].residual)), _short(factor)
    what = "div B" if size == 1 else f"{size} div B"
    raise JacobiError(tuple(names), str(shown), f"It is {what}, and a magnetic field has div B = 0")


def _short(expression: Any) -> Any:
    """A quotient without common factors where that is a matter of polynomials."""
    symbols = sorted(expression.free_symbols, key=str)
    return expression.cancel() if expression.is_rational_function(*symbols) else expression
