r"""Particular solutions: curves on which the state is a rational function of s, $\dot s = p(s)$, and perhaps a root y.

Two kinds are checked exactly, by substitution into the equations of motion:

- **rational**: the state is rational in s, and so is $\dot s$; with $\dot s = \kappa s$ it is rational in
  $e^{\kappa t}$, as separatrices are;
- **with a root**: the state is rational in s and $y$, $y^2 = Q(s)$, and $\dot s = c(s)\,y$: elliptic functions of time
  where Q has degree 3 or 4.

They are found on invariant planes: where all but a few coordinates vanish (coordinate planes), or on the fixed sets of
symmetries.  On such a plane the motion has one degree of freedom if the integrals leave $\dot z^2 = Q(z)$ for one
coordinate z.  At an equilibrium $Q = \zeta^2(r_0 + r_1\zeta + r_2\zeta^2)$ with $\zeta = z - z_0$; for $r_0 = \kappa^2$
the separatrix is, with $x = e^{\kappa t}$,

$$ \zeta = \frac{x}{A x^2 - \frac{r_1}{2 r_0}\,x + B}, \qquad 16\,r_0^2 A B = r_1^2 - 4 r_0 r_2 . $$
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, combinations, count, islice, product
from math import isqrt
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.sparse_polynomials import value_at
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import is_data_set, is_named, listed, named
from liepoisson.inputs.refusals import shown
from liepoisson.report.printing import Formula
from liepoisson.structure.casimir_part import normal_form

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.model.system import System

MOST_COORDINATES = 12
"""Of systems with more, coordinate planes are not searched: there are 2^N."""

_LARGEST_PLANE = 4
"""Dimension of the largest plane on which the motion may have one degree of freedom, constants included."""

_PER_PLANE = 1
"""Separatrices of one plane: others often follow by scaling."""

_GRID = ("0", "-1", "1", "-2", "2", "-3", "3", "-4", "4", "-1/2", "1/2")
"""Coordinates of the equilibria that are tried."""


@dataclass(frozen=True, eq=False, repr=False)
class ParticularSolution:
    r"""A curve that is a solution, verified by substitution.

    Attributes:
        system: The system.
        variable: s.
        rate: The derivative of s by time, a function of s and y.
        state: The state as functions of s and y, by name.
        root: y and $Q = y^2$; None where the state is rational in s.
        origin: How it was found.
    """

    system: System
    variable: Symbol
    rate: Expr
    state: dict[str, Expr]
    root: tuple[Symbol, Expr] | None
    origin: str

    def __eq__(self, other: object) -> bool:
        """Whether it is the same curve, found in the same way, of the same equations."""
        if not isinstance(other, ParticularSolution):
            return NotImplemented
        mine, its = ((s.variable, s.rate, s.state, s.root, s.origin) for s in (self, other))
        return mine == its and self.system.equations == other.system.equations

    def __hash__(self) -> int:
        return hash((self.variable, self.rate, *self.state.values()))

    @property
    def vector(self) -> tuple[Expr, ...]:
        """The state in the order of the coordinates."""
        return tuple(self.state.values())

    @property
    def kind(self) -> str:
        """What functions of time these are, as far as it is told from the rate."""
        if self.root is not None:
            return f"algebraic in {self.variable} and {self.root[0]}"
        power: Any = (self.rate / self.variable).cancel()
        return f"rational in exp({power}*t)".replace("1*t", "t") if power.is_number else f"rational in {self.variable}"

    def __repr__(self) -> str:
        return f"<ParticularSolution of {self.system.name}: {self}>"

    def __str__(self) -> str:
        moving = [f"{name} = {Formula(f).plain}" for name, f in self.state.items() if f != 0]
        zeros = [name for name, f in self.state.items() if f == 0]
        root = f", {self.root[0]}^2 = {Formula(self.root[1]).plain}" if self.root else ""
        rest = f"; {', '.join(zeros)} = 0" if zeros else ""
        return f"{', '.join(moving)}{rest}; {self.variable}' = {Formula(self.rate).plain}{root}"


@explains_its_arguments
def particular_solution(
    system: System,
    state: Mapping[str, Any] | Sequence[Any],
    *,
    variable: Symbol,
    rate: Any,
    root: tuple[Symbol, Any] | None = None,
) -> ParticularSolution:
    r"""A solution that is given as functions of a variable, verified exactly.

    Example:
        >>> import sympy
        >>> x = sympy.Symbol("x")
        >>> pendulum = lp.System(lp.canonical(names=("q",)), "p_q^2/2 + q^2/2 - q^3/3", name="cubic oscillator")
        >>> q = 1 - 6 * x / (1 + x) ** 2
        >>> lp.integrability.particular_solution(pendulum, [q, x * q.diff(x)], variable=x, rate=x).kind
        'rational in exp(t)'

    Args:
        system: The system.
        state: The coordinates as functions of the variable, rational with rational coefficients, by name (those that
            are left out are zero) or in their order; SymPy expressions or texts.
        variable: The symbol s.
        rate: The derivative of s by time.
        root: A symbol y that may occur, too, and the function Q of s with $y^2 = Q$; the rate is then a multiple of y.

    Raises:
        ExpressionError: a text is no formula.
        ParameterError: the system is not polynomial with rational coefficients, a function is not of this kind, or
            the curve is no solution; the message says what remains of which equation.
        ShapeError: the state has not as many functions as there are coordinates.
    """
    return _verified(system, _components(system, state), variable, rate, root=root, origin="given")


@explains_its_arguments
def particular_solutions(system: System, *, most: int = 4) -> tuple[ParticularSolution, ...]:
    """Solutions on invariant planes with one degree of freedom: separatrices first, then elliptic ones.

    Example:
        >>> found = lp.integrability.particular_solutions(lp.Top.twisted_kovalevskaya(), most=1)[0]
        >>> found.origin, found.kind
        ('a separatrix on the invariant plane of l2, alpha1, alpha3', 'rational in exp(1/2*t)')

    Args:
        system: A system with polynomial equations and rational coefficients.
        most: So many at most.

    Raises:
        ParameterError: the equations are not polynomial, or have coefficients that are not rational.
    """
    return tuple(islice(solutions_on_planes(system), as_count(most, "most", least=1)))


def solutions_on_planes(system: System) -> Iterator[ParticularSolution]:
    """The same, one after the other as they are found.

    Raises:
        ParameterError: the equations are not polynomial, or have coefficients that are not rational.
    """
    check_polynomial(system)
    planes = [(plane, _Restricted(system, plane)) for plane in invariant_planes(system)]
    for plane, field in planes:
        checkpoint("the search for particular solutions")
        yield from islice(_separatrices(system, plane, field), _PER_PLANE)
    for plane, field in planes:
        checkpoint("the search for particular solutions")
        yield from islice(_elliptic(system, plane, field), 1)


@dataclass(frozen=True)
class Plane:
    """An invariant linear subspace x = sum c_k v_k.

    Attributes:
        basis: The vectors v_k, with integer components and disjoint supports.
        origin: How it was found.
    """

    basis: tuple[tuple[int, ...], ...]
    origin: str


def invariant_planes(system: System) -> tuple[Plane, ...]:
    """Invariant linear subspaces of dimension 2 to 4 on which something moves, the smallest first.

    They are the coordinate planes and the fixed sets of those symmetries that are signed permutations and keep the
    direction of time.
    """
    from liepoisson.model.discrete_symmetries import discrete_symmetries

    n = len(system.variables)
    found: dict[tuple[tuple[int, ...], ...], str] = {}
    if n <= MOST_COORDINATES:
        supports = [[frozenset(i for i, power in enumerate(m) if power) for m in terms] for terms in _terms(system)]
        for size in range(2, _LARGEST_PLANE + 1):
            checkpoint("the search for invariant planes")
            for kept in combinations(range(n), size):
                here = frozenset(kept)
                if any(support <= here for i in range(n) if i not in here for support in supports[i]):
                    continue
                if any(support <= here for i in kept for support in supports[i]):
                    basis = tuple(tuple(int(i == k) for i in range(n)) for k in kept)
                    names = ", ".join(system.component_names[k] for k in kept)
                    found[basis] = f"the invariant plane of {names}"
    try:
        symmetries = discrete_symmetries(system, most=200).found
    except ParameterError:
        symmetries = ()
    for one in symmetries:
        if not one.reverses_time and 2 <= len(one.fixed_space) <= _LARGEST_PLANE:
            found.setdefault(one.fixed_space, f"the fixed set of the symmetry {one.text}")
    ordered = sorted(found.items(), key=lambda item: (len(item[0]), sum(map(abs, sum(item[0], ())))))
    return tuple(Plane(basis, origin) for basis, origin in ordered)


def check_polynomial(system: System) -> None:
    """Refuse what is no polynomial vector field with rational coefficients.

    Raises:
        ParameterError: it is not.
    """
    from sympy import QQ, Poly
    from sympy.polys.polyerrors import PolynomialError

    if len(system.variables) != system.bracket.dimension:
        raise ParameterError(f"system: {system.name} has components found by quadrature; make it without quadratures")
    for x, rate in system.equations.items():
        expression: Any = rate
        if extra := sorted(map(str, expression.free_symbols - set(system.variables))):
            raise ParameterError(
                f"system: wanted numbers for all parameters; {extra[0]} of {system.name} is a symbol; give its value"
            )
        try:
            Poly(expression, *system.variables, domain=QQ)
        except (PolynomialError, ValueError, TypeError):
            raise ParameterError(
                f"system: wanted polynomial equations with rational coefficients; the rate of {x} in {system.name} is "
                f"{shown(Formula(expression).plain)}; coordinates in which it is a polynomial may exist"
            ) from None
        except Exception as error:  # SymPy's CoercionFailed is of several kinds
            if type(error).__name__ != "CoercionFailed":
                raise
            raise ParameterError(
                f"system: wanted rational coefficients; the rate of {x} in {system.name} is "
                f"{shown(Formula(expression).plain)}; scale the coordinates"
            ) from None


def _terms(system: System) -> list[list[tuple[int, ...]]]:
    from sympy import Poly

    return [list(Poly(e, *system.variables).monoms()) if e != 0 else [] for e in system.equations.values()]


def _components(system: System, state: Mapping[str, Any] | Sequence[Any]) -> list[Any]:
    names = system.component_names
    if is_named(state):
        given = named(state, "state") or {}
        if wrong := [str(k) for k in given if k not in names]:
            raise ParameterError(f"state: {wrong[0]} is no coordinate; they are {', '.join(names)}")
        if is_data_set(state) and (missing := [name for name in names if name not in given]):
            raise ParameterError(
                f"state: wanted all of {', '.join(names)}; got none for {', '.join(missing)}. Give it."
            )
        return [given.get(name, 0) for name in names]
    found = listed(state, "state", names)
    if found is None or len(found) != len(names):
        got = shown(state) if found is None else len(found)
        raise ShapeError(f"state must have {len(names)} functions ({', '.join(names)}); got {got}.")
    return found


def _verified(
    system: System, state: Sequence[Any], variable: Any, rate: Any, *, root: tuple[Any, Any] | None, origin: str
) -> ParticularSolution:
    """A solution, after it was put into the equations."""
    from sympy import QQ, Symbol

    from liepoisson.integrability.galois.linear_systems import exact_expression

    check_polynomial(system)
    if not isinstance(variable, Symbol):
        raise ParameterError(f"variable: wanted a SymPy symbol; got {shown(variable)}")
    if root is not None:
        if not isinstance(root, (tuple, list)) or len(root) != 2 or not isinstance(root[0], Symbol):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise ParameterError(f"root: wanted a SymPy symbol y and y^2, as (y, 1 - x**2); got {shown(root)}")
        root = (root[0], exact_expression(root[1], [variable], "root"))
    arithmetic = Arithmetic(variable, root, QQ)
    symbols = [variable] if root is None else [variable, root[0]]

    def read(given: Any, where: str) -> tuple[Any, Any]:
        return arithmetic.read(exact_expression(given, symbols, where), where)

    values = [read(f, f"state: {name}") for name, f in zip(system.component_names, state, strict=True)]
    speed = read(rate, "rate")
    if not any(speed):
        raise ParameterError("rate: wanted a function that is not zero; the variable must move")
    if root is not None and speed[0]:
        raise ParameterError(f"rate: wanted a multiple of {root[0]}, c(s) {root[0]}; got {shown(str(rate))}")
    powers = [arithmetic.powers(v, d) for v, d in zip(values, _degrees(system), strict=True)]
    for k, (x, equation) in enumerate(system.equations.items()):
        left = arithmetic.rate(values[k], speed)
        right = arithmetic.at(equation, system.variables, powers)
        rest = arithmetic.minus(left, right)
        if any(rest):
            raise ParameterError(
                f"state: this curve is no solution; d{x}/dt less its right-hand side is "
                f"{shown(str(arithmetic.text(rest)))} and not 0"
            )
    if not any(any(arithmetic.rate(v, speed)) for v in values):
        raise ParameterError("state: wanted a curve; this is an equilibrium")
    written = {name: arithmetic.text(v) for name, v in zip(system.component_names, values, strict=True)}
    kept = None if root is None else (root[0], arithmetic.text((arithmetic.square, arithmetic.zero)))
    return ParticularSolution(system, variable, arithmetic.text(speed), written, kept, origin)


def _degrees(system: System) -> list[int]:
    found = [1] * len(system.variables)
    for terms in _terms(system):
        for m in terms:
            found = [max(a, b) for a, b in zip(found, m, strict=True)]
    return found


class Arithmetic:
    """Functions f + g y of s, where f and g are rational and y^2 = Q, as pairs (f, g)."""

    def __init__(self, variable: Any, root: tuple[Any, Any] | None, numbers: Any) -> None:
        from liepoisson.integrability.galois.linear_systems import rational_function

        self.field = numbers.frac_field(variable)
        self.s = self.field.gens[0]
        self.zero, self.one = self.field.zero, self.field.one
        self.root = None if root is None else root[0]
        self.square = self.zero if root is None else rational_function(root[1], self.field)
        if root is not None and not self.square:
            raise ParameterError(f"root: wanted a function that is not zero for {root[0]}^2; got 0")

    def read(self, expression: Any, where: str) -> tuple[Any, Any]:
        """A SymPy expression as such a function."""
        from sympy import Poly
        from sympy.polys.polyerrors import PolynomialError

        from liepoisson.integrability.galois.linear_systems import rational_function

        try:
            if self.root is None or not expression.has(self.root):
                return rational_function(expression, self.field), self.zero
            total = (self.zero, self.zero)
            for (k,), c in Poly(expression, self.root).terms():
                total = self.plus(
                    total, self.times((rational_function(c, self.field), self.zero), self.power_of_root(k))
                )
            return total
        except (ParameterError, PolynomialError) as error:
            kinds = f" and {self.root}" if self.root is not None else ""
            raise ParameterError(
                f"{where}: wanted a rational function of {self.field.symbols[0]}{kinds} with rational coefficients; "
                f"got {shown(str(expression))}"
            ) from error

    def power_of_root(self, k: int) -> tuple[Any, Any]:
        """y^k."""
        return (self.zero, self.square ** (k // 2)) if k % 2 else (self.square ** (k // 2), self.zero)

    def plus(self, a: tuple[Any, Any], b: tuple[Any, Any]) -> tuple[Any, Any]:
        """A + b."""
        return a[0] + b[0], a[1] + b[1]

    def minus(self, a: tuple[Any, Any], b: tuple[Any, Any]) -> tuple[Any, Any]:
        """A - b."""
        return a[0] - b[0], a[1] - b[1]

    def times(self, a: tuple[Any, Any], b: tuple[Any, Any]) -> tuple[Any, Any]:
        """A b."""
        return a[0] * b[0] + a[1] * b[1] * self.square, a[0] * b[1] + a[1] * b[0]

    def rate(self, a: tuple[Any, Any], speed: tuple[Any, Any]) -> tuple[Any, Any]:
        """The derivative by time, y' = Q' s' / (2 y)."""
        slope = (a[0].diff(self.s), a[1].diff(self.s))
        if a[1]:
            slope = (slope[0], slope[1] + a[1] * self.square.diff(self.s) / (2 * self.square))
        return self.times(slope, speed)

    def powers(self, a: tuple[Any, Any], most: int) -> list[tuple[Any, Any]]:
        """1, a, ..., a^most."""
        found = [(self.one, self.zero)]
        for _ in range(most):
            found.append(self.times(found[-1], a))
        return found

    def at(self, polynomial: Any, variables: Sequence[Any], powers: list[list[tuple[Any, Any]]]) -> tuple[Any, Any]:
        """A polynomial in the coordinates on the curve."""
        from sympy import QQ, Poly

        total = (self.zero, self.zero)
        if polynomial == 0:
            return total
        for m, c in Poly(polynomial, *variables, domain=QQ).rep.to_dict().items():
            term = (self.field(c), self.zero)
            for k, power in enumerate(m):
                if power:
                    term = self.times(term, powers[k][power])
            total = self.plus(total, term)
        return total

    def text(self, a: tuple[Any, Any]) -> Any:
        """As a SymPy expression, factored."""
        from sympy import factor

        value: Any = factor(a[0].as_expr())
        return value if self.root is None or not a[1] else value + factor(a[1].as_expr()) * self.root


@dataclass(frozen=True)
class _Reduction:
    """z' = y, y^2 = Q(z), and the coordinates of a plane as functions of z and y."""

    z: Any
    y: Any
    square: Any
    coordinates: tuple[Any, ...]


def _separatrices(system: System, plane: Plane, field: _Restricted) -> Iterator[ParticularSolution]:
    """Separatrices of the equilibria with small rational coordinates."""
    levels: set[Any] = set()
    for point in field.saddles():
        if (reduction := field.reduced(point)) is None:
            continue
        key = (reduction.square, reduction.coordinates)
        if key not in levels:
            levels.add(key)
            yield from _separatrix(system, plane, field, reduction, point)


def _separatrix(
    system: System, plane: Plane, field: _Restricted, reduction: _Reduction, point: Sequence[Any]
) -> Iterator[ParticularSolution]:
    from sympy import Poly, Rational, sqrt

    x = _new_symbol(system, "x", "u", "sigma")
    z0 = point[field.coordinates.index(reduction.z)]
    moved = Poly(reduction.square.subs(reduction.z, reduction.z + z0), reduction.z)
    c = [moved.coeff_monomial(reduction.z**k) for k in range(5)]
    if moved.degree() > 4 or c[0] != 0 or c[1] != 0 or (c[3] == 0 and c[4] == 0):
        return
    r0, r1, r2 = c[2], c[3], c[4]
    kappa: Any = sqrt(r0)
    if not (kappa.is_Rational and kappa > 0):
        return
    ab = (r1**2 - 4 * r0 * r2) / (16 * r0**2)
    side: Any = sqrt(ab)
    A, B = (side, side) if side.is_Rational and side else (Rational(1), ab)
    zeta = x / (A * x**2 - r1 / (2 * r0) * x + B)
    z = z0 + zeta
    speed = kappa * x * zeta.diff(x)
    values = [f.subs({reduction.z: z, reduction.y: speed}, simultaneous=True) for f in reduction.coordinates]
    state = [sum(v[i] * f for v, f in zip(plane.basis, values, strict=True)) for i in range(len(system.variables))]
    origin = f"a separatrix on {plane.origin}"
    yield _verified(system, state, x, kappa * x, root=None, origin=origin)


def _elliptic(system: System, plane: Plane, field: _Restricted) -> Iterator[ParticularSolution]:
    """A solution with an elliptic curve, through a state with small coordinates."""
    from sympy import Poly, Rational, degree

    s, y = _new_symbol(system, "s", "u", "sigma"), _new_symbol(system, "y", "w", "root")
    for point in ((1, 2, 3, 5), (2, -1, 1, 3), (1, 1, 2, 1)):
        at = [Rational(c) for c in point[: len(plane.basis)]]
        reduction = field.reduced(at)
        if reduction is None:
            continue
        square = reduction.square.subs(reduction.z, s)
        if degree(square, s) not in (3, 4) or not Poly(square, s).is_sqf:
            continue
        values = [f.subs({reduction.z: s, reduction.y: y}, simultaneous=True) for f in reduction.coordinates]
        state = [sum(v[i] * f for v, f in zip(plane.basis, values, strict=True)) for i in range(len(system.variables))]
        yield _verified(system, state, s, y, root=(y, square), origin=f"an elliptic solution on {plane.origin}")


class _Restricted:
    """The equations and integrals on an invariant plane."""

    def __init__(self, system: System, plane: Plane) -> None:
        from sympy import symbols

        self.coordinates: tuple[Any, ...] = symbols(f"c1:{len(plane.basis) + 1}")
        places = [
            sum(v[i] * c for v, c in zip(plane.basis, self.coordinates, strict=True))
            for i in range(len(system.variables))
        ]
        at = dict(zip(system.variables, places, strict=True))
        equations: list[Any] = list(system.equations.values())
        full: list[Any] = [e.subs(at, simultaneous=True).expand() for e in equations]
        first = [next(i for i, entry in enumerate(v) if entry) for v in plane.basis]
        self.rates = [full[i] / v[i] for i, v in zip(first, plane.basis, strict=True)]
        known: list[Any] = [normal_form(system.bracket, system.hamiltonian)[0], *system.bracket.casimirs()]
        functions = [f for f in known if f.is_polynomial(*system.variables)]
        self.integrals = [g for f in functions if (g := f.subs(at, simultaneous=True).expand()).free_symbols]
        self.fixed = [c for c, rate in zip(self.coordinates, self.rates, strict=True) if rate == 0]

    def saddles(self) -> Iterator[tuple[Any, ...]]:
        """Equilibria on a grid with two real eigenvalues that are rational, the others zero.

        Multiples of a point are tried, too: the square of the eigenvalue is often proportional to them.
        """
        from sympy import Poly, Rational

        grid = [Fraction(c) for c in _GRID]
        rates = [_terms_of(rate, self.coordinates) for rate in self.rates]
        slopes = [[Poly(rate, *self.coordinates).diff(c).as_expr() for c in self.coordinates] for rate in self.rates]
        jacobian = [[_terms_of(slope, self.coordinates) for slope in row] for row in slopes]
        fixed = [self.coordinates.index(c) for c in self.fixed]
        order = {c: k for k, c in enumerate(grid)}
        for point in sorted(product(grid, repeat=len(self.coordinates)), key=lambda p: sum(order[c] for c in p)):
            if any(point[k] == 0 for k in fixed):  # it lies on a smaller plane
                continue
            if any(value_at(one, point) for one in rates):
                continue
            squared = _trace_of_square(jacobian, point) / 2
            if squared <= 0:
                continue
            for factor in (Fraction(1), squared, 1 / squared):
                multiple = tuple(factor * c for c in point)
                here = _trace_of_square(jacobian, multiple) / 2
                if _is_square(here) and not any(value_at(one, multiple) for one in rates):
                    yield tuple(Rational(c.numerator, c.denominator) for c in multiple)
                    break

    def reduced(self, point: Sequence[Any]) -> _Reduction | None:
        """One coordinate z with z'^2 = Q(z) on the level of the integrals through a point."""
        from sympy import Poly, Symbol, solve

        constants = {c: point[self.coordinates.index(c)] for c in self.fixed}
        level = [f - f.subs(dict(zip(self.coordinates, point, strict=True))) for f in self.integrals]
        level = [f.subs(constants) for f in level]
        active = [c for c in self.coordinates if c not in constants]
        y = Symbol("y")
        for z in active:
            rate = self.rates[self.coordinates.index(z)].subs(constants)
            others = [c for c in active if c != z]
            if not others or rate.has(z) or Poly(rate, *others).total_degree() != 1:
                continue
            first = next(c for c in others if rate.has(c))
            known = {first: solve(rate - y, first)[0]}
            rest = [c for c in others if c != first]
            left = [f.subs(known).expand() for f in level]
            for c in rest:
                linear = next(
                    (f for f in left if f.has(c) and Poly(f, c).degree() == 1 and not Poly(f, c).LC().free_symbols),
                    None,
                )
                if linear is None:
                    break
                value = solve(linear, c)[0]
                known = {k: v.subs(c, value) for k, v in known.items()} | {c: value}
                left = [f.subs(c, value).expand() for f in left]
            else:
                relation = next((f for f in left if f.has(y)), None)
                if relation is None or relation.free_symbols - {z, y}:
                    continue
                powers = Poly(relation, y)
                if powers.degree() != 2 or powers.coeff_monomial(y) != 0 or powers.LC().free_symbols:
                    continue
                square = (-powers.coeff_monomial(1) / powers.LC()).expand()
                values = {z: z, **known, **constants}
                return _Reduction(z, y, square, tuple(values[c] for c in self.coordinates))
        return None


def _new_symbol(system: System, *names: str) -> Any:
    """A symbol that is no coordinate."""
    from sympy import Symbol

    further = (f"{names[0]}_{k}" for k in count(1))
    return Symbol(next(name for name in chain(names, further) if name not in system.component_names))


Terms: TypeAlias = list[tuple[tuple[int, ...], Fraction]]


def _terms_of(polynomial: Any, variables: Sequence[Any]) -> Terms:
    from sympy import Poly

    if polynomial == 0:
        return []
    return [(m, Fraction(int(c.p), int(c.q))) for m, c in Poly(polynomial, *variables).terms()]


def _trace_of_square(jacobian: list[list[Terms]], point: Sequence[Fraction]) -> Fraction:
    matrix = [[value_at(entry, point) for entry in row] for row in jacobian]
    places = range(len(matrix))
    return sum((matrix[i][j] * matrix[j][i] for i in places for j in places), Fraction(0))


def _is_square(value: Fraction) -> bool:
    """Whether a rational number is the square of a positive one."""
    return value > 0 and all(isqrt(n) ** 2 == n for n in (value.numerator, value.denominator))
