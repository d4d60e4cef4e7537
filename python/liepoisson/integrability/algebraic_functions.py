r"""Equations with roots, exponentials and trigonometric functions as polynomial equations in more variables.

A function y of the coordinates becomes a variable, whose rate follows from the chain rule, and satisfies a relation:

* $r = \sqrt p$ and $u = 1/r$: $r^2 = p$, $ur = 1$ and $\dot r = u\dot p/2$, for polynomials p in the coordinates;
* $u = 1/B$: $uB = 1$ and $\dot u = -u^2\dot B$, where B may contain other new variables;
* $e_j = \exp f_j$: $\dot e_j = e_j\dot f_j$, for linear forms with rational coefficients; the integer relation of the
  forms, if there is one, is one of products of the $e_j$; where there are several, the $f_j$ are a basis of the lattice
  of the forms and its opposites;
* $s = \sin f$, $c = \cos f$: $s^2 + c^2 = 1$, $\dot s = c\dot f$, $\dot c = -s\dot f$, for a basis of the lattice of
  such forms.

These are all relations: polynomials in coordinates and new variables that agree as functions differ by an element of
the ideal of the relations.  For roots this holds since no product of some of the p is a square, which is tested;
exponentials of forms that are linearly independent over the rationals are algebraically independent over algebraic
functions; and an inverse is a localisation.  So a search on the level set of the relations counts functions.

References: [ax1971] for exponentials; [sturmfels1996], chapter 4, for the relations of products.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from math import gcd, lcm
from typing import Any, NoReturn, cast

from flint import fmpq_mat, fmpz_mat
from sympy import (
    Add,
    Dummy,
    Expr,
    Mul,
    Poly,
    Pow,
    Symbol,
    cos,
    cosh,
    cot,
    coth,
    csc,
    csch,
    default_sort_key,
    exp,
    expand,
    expand_trig,
    factor_list,
    log,
    pi,
    prod,
    sec,
    sech,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)

from liepoisson.algebra.coefficients import check_degree
from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.number_fields import Element, as_fmpq, as_fraction
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.refusals import shown
from liepoisson.integrability.derivation import (
    Derivation,
    Exponents,
    Level,
    derivation_of,
    derivation_of_rates,
    level_of,
)
from liepoisson.model.equations_of_motion import EquationsOfMotion

_MOST_ROOTS = 5
"""Products of all subsets of more roots are not tested."""

_MOST_TURNS = 100
"""The sine of a multiple of an angle is a polynomial of as high a degree in those of the angle."""

OTHER_TOOLS = (
    "Searches for integrals take polynomials, fractions, square roots of polynomials, and exp, sin, cos, tan, sinh, "
    "cosh and tanh of linear forms with rational coefficients; sections, exponents and `decide` take any smooth system"
)

Form = tuple[Fraction, ...]
"""A linear form in the coordinates, by its coefficients."""


@dataclass(frozen=True)
class AlgebraicEquations:
    """Equations of a system that are polynomials in the coordinates and in some functions of them."""

    derivation: Derivation  # the equations; its variables are the coordinates and one for each function
    functions: dict[Symbol, Expr]  # the functions by their variables
    relations: tuple[Polynomial, ...]  # polynomials in all variables that vanish

    @cached_property
    def level(self) -> Level:
        """The level set of the relations: remainders on it agree where functions do."""
        return level_of(self.derivation, self.relations)

    def expression(self, polynomial: Mapping[Exponents, Element]) -> Expr:
        """A polynomial in all variables as a function of the coordinates."""
        return cast("Expr", self.derivation.expression(polynomial).xreplace(self.functions))


def algebraic_equations(system: EquationsOfMotion, *functions: Expr) -> tuple[AlgebraicEquations, list[Polynomial]]:
    """The equations of a system, and functions, in as many more variables as are needed; none for polynomials."""
    x = system.variables
    rates = list(system.equations.values())
    if all(e.is_polynomial(*x) for e in (*rates, *functions)):
        derivation, polynomials = derivation_of(system, *functions)
        return AlgebraicEquations(derivation, {}, ()), polynomials
    reader = _Reader(x)
    polynomials = reader.read([*rates, *functions])
    rates, given = reader.rates(polynomials[: len(x)]), polynomials[len(x) :]
    names = [*x, *reader.functions]
    derivation, read = derivation_of_rates(names, rates, [*reader.relations, *given])
    n = len(reader.relations)
    return AlgebraicEquations(derivation, reader.functions, tuple(read[:n])), read[n:]


def is_algebraic(system: EquationsOfMotion, function: Expr) -> bool:
    """Whether a function can be read along with the equations: log(x) cannot, though its derivatives may."""
    if not function.has(log):
        return True
    try:
        algebraic_equations(system, function)
    except ParameterError:
        return False
    return True


@dataclass
class _Reader:
    """Makes new variables for the functions that occur, with their relations."""

    coordinates: tuple[Symbol, ...]
    functions: dict[Any, Any] = field(default_factory=dict[Any, Any])
    relations: list[Any] = field(default_factory=list[Any])
    _roots: dict[Any, tuple[Any, Any]] = field(default_factory=dict[Any, tuple[Any, Any]])
    _inverses: dict[Any, Any] = field(default_factory=dict[Any, Any])
    _exponentials: dict[Form, Any] = field(default_factory=dict[Form, Any])
    _angles: list[tuple[Form, Any, Any]] = field(default_factory=list[tuple[Form, Any, Any]])

    def read(self, expressions: Sequence[Any]) -> list[Any]:
        """Functions of the coordinates as polynomials in all variables."""
        written = [_in_exp_sin_cos(e) for e in expressions]
        self._add_roots(written)
        self._add_exponentials(written)
        self._add_angles(written)
        return [self._polynomial(e).expand() for e in written]

    def rates(self, of_coordinates: Sequence[Any]) -> list[Any]:
        """The rates of all variables, by the chain rule."""
        known: dict[Any, Any] = dict(zip(self.coordinates, of_coordinates, strict=True))

        def along(function: Any) -> Any:
            return sum((function.diff(z) * rate for z, rate in known.items()), 0 * function)

        for base, (r, u) in self._roots.items():
            half = along(base) / 2
            known |= {r: half * u, u: -half * u**3}
        for form, e in self._exponentials.items():
            known[e] = e * along(self._written(form))
        for form, s, c in self._angles:
            rate = along(self._written(form))
            known |= {s: c * rate, c: -s * rate}
        for factor, u in self._inverses.items():
            if u in self.functions and u not in known:
                known[u] = -(u**2) * along(factor)
        return [expand(known[z]) for z in (*self.coordinates, *self.functions)]

    def _polynomial(self, expression: Any) -> Any:
        checkpoint("reading functions as polynomials")
        x = set(self.coordinates)
        if not expression.free_symbols & x or expression.is_polynomial(*self.coordinates):
            return expression
        if expression.is_Add or expression.is_Mul:
            return expression.func(*map(self._polynomial, expression.args))
        if isinstance(expression, exp):
            return self._exponential(self._form(expression.args[0])[0])
        if isinstance(expression, (sin, cos)):
            return self._expanded(expression)
        if expression.is_Pow and expression.exp.is_Integer:
            base = self._polynomial(expression.base)
            return base**expression.exp if expression.exp > 0 else self._inverse(base) ** (-expression.exp)
        if expression.is_Pow and (2 * expression.exp).is_Integer:
            content, base = _primitive(expression.base, self.coordinates)
            root, inverse = self._roots[base]
            power = int(2 * expression.exp)
            return content**expression.exp * (root**power if power > 0 else inverse ** (-power))
        self._refuse(expression)

    def _exponential(self, form: Form) -> Any:
        ray, multiple = _ray(form)
        for unit, e in self._exponentials.items():
            known, step = _ray(unit)
            if known == ray:
                return e ** int(multiple / step)
        basis = list(self._exponentials)[::2]
        powers = zip(basis, _multiples(basis, form), strict=True)
        factors: list[Any] = [self._exponentials[f if k > 0 else _opposite(f)] ** abs(k) for f, k in powers]
        return prod(factors)

    def _new(self, function: Any) -> Symbol:
        symbol = Dummy(f"y{len(self.functions) + 1}")
        self.functions[symbol] = function
        return symbol

    def _inverse(self, base: Any) -> Any:
        """One over a polynomial in all variables, by an inverse for each of its factors."""
        content, factors = cast("tuple[Any, Any]", factor_list(base.expand(), *self.coordinates, *self.functions))
        total: Any = 1 / content
        for factor, power in factors:
            if factor not in self._inverses:
                self._inverses[factor] = self._new(1 / factor.xreplace(self.functions))
                self.relations.append(self._inverses[factor] * factor - 1)
            total *= self._inverses[factor] ** power
        return total

    def _expanded(self, expression: Any) -> Any:
        """The sine or cosine of a form, in those of the basis."""
        form, constant = self._form(expression.args[0], turns=True)
        multiples = _multiples([f for f, _, _ in self._angles], form)
        if (largest := sum(map(abs, multiples))) > _MOST_TURNS:
            raise ParameterError(
                f"wanted sines and cosines of at most {_MOST_TURNS} times a common form; got {shown(expression)}, of "
                f"{largest} times one: a polynomial of this degree. {OTHER_TOOLS}"
            )
        angles = [Dummy() for _ in multiples]
        angle = sum((n * a for n, a in zip(multiples, angles, strict=True)), constant)
        values: dict[Any, Any] = {}
        for a, (_, s, c) in zip(angles, self._angles, strict=True):
            values |= {sin(a): s, cos(a): c}
        return expand_trig(expression.func(angle)).xreplace(values)

    def _form(self, argument: Any, *, turns: bool = False) -> tuple[Form, Any]:
        """The coefficients of a linear form, and a constant, which may be a rational multiple of pi if it turns."""
        if not argument.is_polynomial(*self.coordinates):
            self._refuse(argument)
        polynomial = Poly(argument, *self.coordinates)
        if polynomial.total_degree() > 1:
            self._refuse(argument)
        values = [polynomial.coeff_monomial(x) for x in self.coordinates]
        constant = polynomial.coeff_monomial(1)
        if not all(v.is_Rational for v in values) or not (constant == 0 or (turns and (constant / pi).is_Rational)):
            self._refuse(argument)
        return tuple(as_fraction(v) for v in values), constant

    def _refuse(self, expression: Any) -> NoReturn:
        raise ParameterError(
            f"wanted a polynomial in {', '.join(map(str, self.coordinates))} and in roots, exponentials and "
            f"trigonometric functions; got {shown(expression)}. {OTHER_TOOLS}"
        )

    def _add_roots(self, expressions: Iterable[Any]) -> None:
        bases: list[Any] = []
        powers = {p for e in expressions for p in e.atoms(Pow) if p.free_symbols & set(self.coordinates)}
        for power in sorted(powers, key=default_sort_key):
            if power.exp.is_Integer or not (2 * power.exp).is_Integer:
                continue
            if not power.base.is_polynomial(*self.coordinates):
                self._refuse(power)
            base = _primitive(power.base, self.coordinates)[1]
            if base not in bases:
                bases.append(base)
        if len(bases) > _MOST_ROOTS:
            raise ParameterError(f"wanted at most {_MOST_ROOTS} different roots; got {len(bases)}. {OTHER_TOOLS}")
        for n in range(1, len(bases) + 1):
            for chosen in combinations(bases, n):
                check_degree(chosen)
                product: Any = Poly(prod(chosen), *self.coordinates, extension=True)
                if all(m % 2 == 0 for _, m in product.sqf_list()[1]):
                    raise ParameterError(
                        "wanted roots of which no product is a polynomial up to its sign; got "
                        f"{', '.join(str(sqrt(p)) for p in chosen)}. Write one by the others"
                    )
        for base in bases:
            r, u = self._new(sqrt(base)), self._new(1 / sqrt(base))
            self._roots[base] = r, u
            self._inverses |= {r: u, base: u**2}
            self.relations += [r**2 - base, u * r - 1]

    def _add_exponentials(self, expressions: Iterable[Any]) -> None:
        arguments = {f.args[0] for e in expressions for f in e.atoms(exp) if f.free_symbols & set(self.coordinates)}
        rays: dict[Form, list[Fraction]] = {}
        for argument in sorted(arguments, key=str):
            form, power = _ray(self._form(argument)[0])
            rays.setdefault(form, []).append(power)
        units = [tuple(_common(powers) * c for c in form) for form, powers in rays.items()]
        relations = _relations(units)
        if len(relations) > 1:
            # many exponentials of few forms satisfy many relations; powers of these, negative ones too, one each
            units = [one for form in _lattice_basis(units) for one in (form, _opposite(form))]
        self._exponentials = {unit: self._new(exp(self._written(unit))) for unit in units}
        symbols = list(self._exponentials.values())
        if len(relations) > 1:
            self.relations += [e * inverse - 1 for e, inverse in zip(symbols[::2], symbols[1::2], strict=True)]
        else:
            self.relations += [_binomial(multiples, symbols) for multiples in relations]

    def _add_angles(self, expressions: Iterable[Any]) -> None:
        found = {f.args[0] for e in expressions for f in e.atoms(sin, cos) if f.free_symbols & set(self.coordinates)}
        forms = [self._form(argument, turns=True)[0] for argument in sorted(found, key=str)]
        if not forms:
            return
        for form in _lattice_basis(forms):
            s, c = self._new(sin(self._written(form))), self._new(cos(self._written(form)))
            self._angles.append((form, s, c))
            self.relations.append(s**2 + c**2 - 1)

    def _written(self, form: Form) -> Any:
        return sum(to_sympy(c) * x for c, x in zip(form, self.coordinates, strict=True))


def _in_exp_sin_cos(expression: Any) -> Any:
    def ratio(f: Any) -> Any:
        return sin(f) / cos(f)

    for function in (sinh, cosh, tanh, coth, sech, csch):
        expression = expression.replace(function, lambda f, function=function: function(f).rewrite(exp))
    for function, written in (
        (tan, ratio),
        (cot, lambda f: 1 / ratio(f)),
        (sec, lambda f: 1 / cos(f)),
        (csc, lambda f: 1 / sin(f)),
    ):
        expression = expression.replace(function, written)
    return expression.replace(lambda e: e.is_Mul and e.has(exp), _with_one_exponential)


def _with_one_exponential(product: Any) -> Any:
    r"""A product with $e^{f + g}$ for $e^f e^g$, into which SymPy expands it: one variable, and no relation."""
    exponents: list[Any] = [f.args[0] for f in product.args if isinstance(f, exp)]
    return Mul(*(f for f in product.args if not isinstance(f, exp)), exp(Add(*exponents)))


def _primitive(base: Any, coordinates: Sequence[Any]) -> tuple[Any, Any]:
    """A positive rational number times an expanded polynomial whose coefficients have no common factor."""
    content, primitive = Poly(base, *coordinates).primitive()
    return (content, primitive.as_expr()) if content.is_Rational and content > 0 else (content * 0 + 1, base.expand())


def _common(values: Sequence[Fraction]) -> Fraction:
    """The largest number of which all are whole multiples."""
    return Fraction(gcd(*(v.numerator for v in values)), lcm(*(v.denominator for v in values)))


def _ray(form: Form) -> tuple[Form, Fraction]:
    """The smallest form with whole coefficients in the same direction, and its multiple."""
    scale = _common(form)
    return tuple(c / scale for c in form), scale


def _opposite(form: Form) -> Form:
    return tuple(-c for c in form)


def _lattice_basis(forms: Sequence[Form]) -> list[Form]:
    """Short forms of which all these are sums with whole coefficients."""
    scale = lcm(*(c.denominator for f in forms for c in f))
    lattice = fmpz_mat([[int(c * scale) for c in f] for f in forms]).hnf()
    rows = fmpz_mat(lattice.tolist()[: lattice.rank()]).lll()
    basis: list[Form] = []
    for row in rows.tolist():
        sign = -1 if next(c for c in row if c) < 0 else 1
        basis.append(tuple(sign * Fraction(int(c), scale) for c in row))
    return basis


def _multiples(basis: Sequence[Form], form: Form) -> list[int]:
    """The whole coefficients of a form in a basis of the lattice."""
    rows = [[as_fmpq(c) for c in f] for f in (*basis, form)]
    reduced, rank = fmpq_mat([list(column) for column in zip(*rows, strict=True)]).rref()
    return [int(reduced[k, rank].p) for k in range(rank)]


def _relations(forms: Sequence[Form]) -> list[list[int]]:
    """A basis of the whole numbers with which the forms add up to zero."""
    if not forms:
        return []
    m, n = len(forms), len(forms[0])
    scale = lcm(*(c.denominator for f in forms for c in f))
    # unimodular operations on rows: those that make the left part vanish are a basis of the lattice of relations
    rows = [[int(c * scale) for c in f] + [int(i == k) for k in range(m)] for i, f in enumerate(forms)]
    return [[int(k) for k in row[n:]] for row in fmpz_mat(rows).hnf().tolist() if not any(row[:n])]


def _binomial(multiples: Sequence[int], symbols: Sequence[Any]) -> Any:
    """What vanishes if this sum of forms does; if no other does, all relations are its multiples [sturmfels1996]."""
    pairs = [(y, int(k)) for y, k in zip(symbols, multiples, strict=True)]
    positive: Any = prod(y**k for y, k in pairs if k > 0)
    negative: Any = prod(y**-k for y, k in pairs if k < 0)
    return positive - negative
