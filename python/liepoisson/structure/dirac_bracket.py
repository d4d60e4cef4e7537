r"""The Dirac bracket of constraints, in the coordinates of the bracket that they are imposed on.

$$\{f, g\}_D = \{f, g\} - \sum_{ab} \{f, \phi_a\}\, (C^{-1})_{ab}\, \{\phi_b, g\}, \qquad
  C_{ab} = \{\phi_a, \phi_b\} .$$

It obeys the Jacobi identity wherever the determinant of C does not vanish, not only where the constraints do, and both
the constraints and the Casimirs of the first bracket are Casimirs of it: that is Dirac's theorem, so that nothing is
sampled where nothing was before.

References: Dirac, Canad. J. Math. 2 (1950) 129; [marsden1999], section 8.5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.errors import BracketError, ConstraintError, ParameterError
from liepoisson.formula.parameters import GivenValue
from liepoisson.inputs.deadline import checkpoint
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.circles import check_on_circles, turn
from liepoisson.structure.constraint_surface import ConstraintSurface
from liepoisson.structure.given_functions import listed_functions, read_function, scope_of
from liepoisson.structure.poisson.pfaffians import pfaffian_of
from liepoisson.structure.tensor_bracket import PoissonTensor, tensor_of
from liepoisson.structure.tensor_sources import entries_of, known_casimirs

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.formula.scope import Scope

_ON_LINES = (
    "Write it by sines and cosines, sin({name}) for {name}, or take a bracket where {name} is no angle, "
    "bracket.with_angles([])."
)
"""What to do about a constraint that is no function on the circles of the bracket."""


def dirac_bracket(
    bracket: Bracket,
    constraints: Sequence[str | Expr] | Mapping[str, str | Expr],
    parameters: Mapping[str, GivenValue] | None,
    *,
    symbols: Sequence[str],
) -> PoissonTensor:
    """The Dirac bracket; see `Bracket.dirac_bracket`."""
    bracket.check_without_time("a Dirac bracket")
    scope = scope_of(bracket.coordinate_names_in_order, bracket.symbols, symbols, parameters)
    functions = _read(constraints, bracket, scope)
    entries, x = entries_of(bracket), bracket.variables
    gradients = [[f.diff(v) for v in x] for f in functions]
    field = Coefficients.containing([*x, *entries.values(), *(slope for row in gradients for slope in row)])
    read = {pair: field.read(entry) for pair, entry in entries.items()}
    slopes = [{i: field.read(slope) for i, slope in enumerate(row) if slope != 0} for row in gradients]
    images = [_image(own, read, field) for own in slopes]
    C = [[_paired(image, own, field) for own in slopes] for image in images]
    ConstraintSurface(
        x,
        tuple(functions),
        tuple(tuple(row) for row in gradients),
        tuple(tuple(field.to_sympy(c) for c in row) for row in C),
        entries,
    ).check_second_class()
    minors, whole = _adjugate(C, field)
    found: dict[tuple[int, int], Any] = {}
    for i in range(len(x)):
        checkpoint("the entries of a Dirac bracket")
        row = [
            sum((images[a][i] * c for a, c in enumerate(column) if i in images[a] and c), field.zero)
            for column in zip(*minors, strict=True)
        ]
        for j in range(i + 1, len(x)):
            total = sum((c * image[j] for c, image in zip(row, images, strict=True) if c and j in image), field.zero)
            if entry := (read.get((i, j), field.zero) + total / whole if total else read.get((i, j))):
                found[i, j] = field.to_sympy(entry)
    known = bracket.jacobi if isinstance(bracket, PoissonTensor) else "proved"
    casimirs = [*functions, *known_casimirs(bracket)]
    made = tensor_of(bracket.coordinate_names_in_order, found, casimirs=casimirs, jacobi=known, are_nonzero=True)
    made.angles = bracket.angles
    return made


def _image(slopes: Mapping[int, Any], entries: Mapping[tuple[int, int], Any], field: Coefficients) -> dict[int, Any]:
    r"""The brackets $\{\phi, x_k\}$ that are not zero."""
    found: dict[int, Any] = {}
    for (i, j), entry in entries.items():
        if i in slopes:
            found[j] = found.get(j, field.zero) + slopes[i] * entry
        if j in slopes:
            found[i] = found.get(i, field.zero) - slopes[j] * entry
    return {k: value for k, value in found.items() if value}


def _paired(image: Mapping[int, Any], slopes: Mapping[int, Any], field: Coefficients) -> Any:
    return sum((value * slopes[k] for k, value in image.items() if k in slopes), field.zero)


def _adjugate(C: list[list[Any]], field: Coefficients) -> tuple[list[list[Any]], Any]:
    r"""The inverse of an antisymmetric matrix as its numerators and the Pfaffian, without a division.

    $(C^{-1})_{ab} = (-1)^{a+b}\,\mathrm{Pf}(C_{\hat a\hat b})/\mathrm{Pf}(C)$ for a < b.

    Raises:
        ConstraintError: the Pfaffian is zero, or there is none.
    """
    m = len(C)
    pfaffian = pfaffian_of(lambda a, b: C[a][b], zero=field.zero, one=field.one)
    every = tuple(range(m))
    whole = pfaffian(every) if m % 2 == 0 else field.zero
    if not whole:
        raise ConstraintError("", "everywhere")
    minors = [[field.zero] * m for _ in C]
    for a in range(m):
        for b in range(a + 1, m):
            minor = pfaffian(tuple(c for c in every if c not in (a, b)))
            minors[a][b], minors[b][a] = (-minor, minor) if (a + b) % 2 else (minor, -minor)
    for a in range(m):  # from this follows that the constraints are Casimirs
        for b in range(m):
            total = sum((C[a][c] * minors[c][b] for c in range(m)), field.zero)
            assert field.vanishes(total - whole * field.number(int(a == b))), "the inverse of {phi_a, phi_b} is wrong"
    return minors, whole


def _read(given: Any, bracket: Bracket, scope: Scope) -> list[Expr]:
    items = listed_functions(given, "constraints", '["q1^2 + q2^2 - 1", "q1*p1 + q2*p2"]')
    if not items:
        raise ParameterError("constraints must be at least two functions; got none. A bracket without is the same.")
    functions = [read_function(one, scope, "a constraint") for one in items]
    for function in functions:
        if not function.free_symbols & {*bracket.variables}:
            raise BracketError(f"a constraint must depend on the coordinates; got {function}. Leave it out.")
    circles: Any = {str(x): (x, turn()) for x in bracket.angle_variables}
    check_on_circles((("a constraint", function) for function in functions), circles, _ON_LINES)
    return functions
