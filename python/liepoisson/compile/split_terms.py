r"""From a Hamiltonian to pieces with known flows, for splitting methods.

A function of one linear form, $F(y)$ with $y = \xi\cdot x$, keeps y along its own flow, and a Lie-Poisson bracket is
linear in the state, so that flow is $\exp(tF'(y)\,M)$ with $M_{ik} = \sum_j c_{ij}^k\xi_j$.  Every polynomial is a sum
of such pieces: a quadratic form by completing squares, and a product by polarisation,

$$y_1\cdots y_d = \frac{1}{2^{d-1}d!}\sum_{\sigma_2,\dots,\sigma_d=\pm1}\sigma_2\cdots\sigma_d\,
  (y_1+\sigma_2y_2+\dots+\sigma_dy_d)^d .$$

Sources: McLachlan, Phys. Rev. Lett. 71 (1993) 3043 (splitting into such pieces).
"""

from __future__ import annotations

import math
from collections import defaultdict
from fractions import Fraction
from itertools import combinations, combinations_with_replacement, product
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.exact_numbers import as_coefficient
from liepoisson.algebra.rational_polynomials import RationalPolynomial
from liepoisson.algebra.rounded import rational
from liepoisson.compile.field import Piece, PiecesField
from liepoisson.compile.lowering import check_numeric
from liepoisson.errors import UnsupportedFieldError

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket

MOST_PIECES = 1000
"""Pieces beyond this number would make a step longer than any other method needs."""

Polynomial: TypeAlias = "dict[tuple[int, ...], Fraction]"
"""Coefficients by monomial; a monomial is the sorted tuple of the indices of its factors."""
Form: TypeAlias = "tuple[tuple[int, Fraction], ...]"
"""A linear form: (component, coefficient), in the order of the components."""
Powers: TypeAlias = "dict[Form, dict[int, Fraction]]"
"""Polynomials in linear forms: coefficient of each power of each form."""


def pieces_of(bracket: Bracket, hamiltonian: Expr | RationalPolynomial) -> PiecesField:
    """The Hamiltonian as a sum of functions of one linear form each.

    Raises:
        ParameterError: a parameter is symbolic, or a coefficient does not fit into a double.
        UnsupportedFieldError: the Hamiltonian depends on time, is not a polynomial, or needs more than 1000 pieces; or
            the bracket is not linear or has a constant part, so that the flow of a piece is not linear in the state.
    """
    powers = _powers_of(bracket, hamiltonian)
    if len(powers) > MOST_PIECES:
        raise UnsupportedFieldError(
            f"splitting: wanted a Hamiltonian of at most {MOST_PIECES} pieces; got {len(powers)}; use the Taylor method"
        )
    return PiecesField(bracket.dimension, tuple(_piece(bracket, form, terms) for form, terms in powers.items()))


def commuting_pieces_of(bracket: Bracket, hamiltonian: Expr | RationalPolynomial) -> tuple[Piece, ...]:
    """The same for a Hamiltonian that must flow exactly: pieces whose linear forms commute, so that their flows do.

    Pieces whose form is a Casimir move nothing and are left out.

    Raises:
        ParameterError, UnsupportedFieldError: as for `pieces_of`; also if two of the forms do not commute.
    """
    powers = _powers_of(bracket, hamiltonian)
    moving = {form: rows for form in powers if (rows := _generator(bracket, form))}
    for (first, _), (second, rows) in combinations(moving.items(), 2):
        image: defaultdict[int, Fraction] = defaultdict(Fraction)
        for (i, k), c in rows.items():
            image[k] += dict(first).get(i, 0) * c
        if any(image.values()):
            one, other = (_written(bracket, form) for form in (first, second))
            raise UnsupportedFieldError(
                f"splitting: wanted a sum of functions of linear forms that commute, since its flow is then exact; got "
                f"one of {one} and {other}, whose bracket is not zero; give the parts that commute as Hamiltonians of "
                "their own"
            )
    return tuple(_piece(bracket, form, powers[form]) for form in moving)


def _written(bracket: Bracket, form: Form) -> str:
    return " + ".join(f"{c}*{bracket.variables[i]}" if c != 1 else str(bracket.variables[i]) for i, c in form)


def _powers_of(bracket: Bracket, hamiltonian: Expr | RationalPolynomial) -> Powers:
    """A Hamiltonian as powers of linear forms, with a bracket for which their flows are linear."""
    if bracket.clock is not None:
        raise UnsupportedFieldError(
            f"splitting: wanted a Hamiltonian without time; got one that depends on {bracket.clock}; use the Taylor or "
            "a Gauss method"
        )
    if not bracket.is_linear or bracket.constant:
        got = f"{bracket!r}, which has a constant part" if bracket.is_linear else repr(bracket)
        raise UnsupportedFieldError(
            f"splitting: wanted a bracket that is linear in the state; got {got}; use the Taylor or a Gauss method"
        )
    if isinstance(hamiltonian, RationalPolynomial):
        return powers_of_forms(hamiltonian.expanded)
    check_numeric(bracket, hamiltonian)
    return powers_of_forms(_polynomial(bracket, hamiltonian))


def powers_of_forms(energy: Polynomial) -> Powers:
    """A polynomial as a sum of powers of linear forms; the constant term is left out."""
    powers: Powers = defaultdict(dict)
    linear = tuple((*monomial, c) for monomial, c in sorted(energy.items()) if len(monomial) == 1)
    if linear:
        _add_power(powers, linear, 1, Fraction(1))
    for form, c in _squares({monomial: c for monomial, c in energy.items() if len(monomial) == 2}):
        _add_power(powers, form, 2, c)
    roots = {degree: _root(energy, degree) for degree in {len(monomial) for monomial in energy} - {0, 1, 2}}
    for monomial, c in sorted(energy.items()):
        degree = len(monomial)
        if degree <= 2:
            continue
        if (root := roots[degree]) is not None:
            if monomial == (root[0][0],) * degree:
                _add_power(powers, root, degree, c)
            continue
        if len(set(monomial)) == 1:
            _add_power(powers, ((monomial[0], Fraction(1)),), degree, c)
            continue
        weight = c / (2 ** (degree - 1) * math.factorial(degree))
        for signs in product((1, -1), repeat=degree - 1):
            _add_power(powers, _sum(monomial, (1, *signs)), degree, weight * math.prod(signs))
    if linear and linear != (unit := _form(dict(linear), linear[0][1])) and unit in powers:
        powers[unit][1] = powers.pop(linear)[1] * linear[0][1]
    return {form: kept for form, terms in powers.items() if (kept := {d: c for d, c in terms.items() if c})}


def _root(energy: Polynomial, degree: int) -> Form | None:
    r"""The form y, with first coefficient 1, for which the terms of degree d add up to $c\,y^d$, if there is one.

    In $c(x_i + \sum_j a_jx_j)^d$ with the first variable $x_i$, those of $x_i^d$ and $x_i^{d-1}x_j$ are c and $cda_j$.
    """
    part = {monomial: c for monomial, c in energy.items() if len(monomial) == degree}
    i = min(monomial[0] for monomial in part)
    c = part.get((i,) * degree)
    if c is None:
        return None
    row = {i: Fraction(1)} | {m[-1]: a / (degree * c) for m, a in part.items() if m[-2] == i != m[-1]}
    n_terms = 0
    for monomial in combinations_with_replacement(sorted(row), degree):
        n_ways = math.factorial(degree) // math.prod(math.factorial(monomial.count(j)) for j in set(monomial))
        if part.get(monomial) != c * n_ways * math.prod(row[j] for j in monomial):
            return None
        n_terms += 1
    return tuple(sorted(row.items())) if n_terms == len(part) else None


def _squares(quadratic: Polynomial) -> list[tuple[Form, Fraction]]:
    """A quadratic form as a sum of multiples of squares of linear forms: completing squares, exactly."""
    rows: defaultdict[int, dict[int, Fraction]] = defaultdict(dict)  # of the symmetric matrix S in x.S x / 2
    for (i, j), c in quadratic.items():
        rows[i][j] = rows[i].get(j, Fraction(0)) + (2 * c if i == j else c)
        if i != j:
            rows[j][i] = rows[i][j]
    squares: list[tuple[Form, Fraction]] = []
    while rows := defaultdict(dict, {i: row for i, given in rows.items() if (row := _without_zeros(given))}):
        # variables that stand alone first: their forms are the coordinates themselves
        pivot = min((i for i in rows if i in rows[i]), key=lambda i: (len(rows[i]), i), default=None)
        if pivot is not None:
            # x.S x / 2 = (S_i.x)^2 / (2 S_ii) + rest
            row = dict(rows[pivot])
            scale = row[pivot]
            squares.append((_form(row, scale), scale / 2))
            _subtract(rows, row, row, 1 / scale)
            continue
        # no squares at all: x.S x / 2 = (S_i.x)(S_j.x) / S_ij + rest, and p q = ((p + q)^2 - (p - q)^2) / 4
        i = min(rows)
        j = min(rows[i])
        first, second, scale = dict(rows[i]), dict(rows[j]), rows[i][j]
        for sign in (1, -1):
            keys = sorted(first.keys() | second.keys())
            both = {k: first.get(k, Fraction(0)) + sign * second.get(k, Fraction(0)) for k in keys}
            squares.append((_form(_without_zeros(both), Fraction(1)), sign / (4 * scale)))
        _subtract(rows, first, second, 1 / scale)
        _subtract(rows, second, first, 1 / scale)
    return squares


def _subtract(
    rows: dict[int, dict[int, Fraction]], first: dict[int, Fraction], second: dict[int, Fraction], scale: Fraction
) -> None:
    """S <- S - scale * first second^T."""
    for i, p in first.items():
        for j, q in second.items():
            rows[i][j] = rows[i].get(j, Fraction(0)) - scale * p * q


def _without_zeros(row: dict[int, Fraction]) -> dict[int, Fraction]:
    return {j: c for j, c in row.items() if c}


def _form(row: dict[int, Fraction], scale: Fraction) -> Form:
    return tuple((j, c / scale) for j, c in sorted(row.items()))


def _sum(monomial: tuple[int, ...], signs: tuple[int, ...]) -> Form:
    row: dict[int, Fraction] = {}
    for i, sign in zip(monomial, signs, strict=True):
        row[i] = row.get(i, Fraction(0)) + sign
    return _form(_without_zeros(row), Fraction(1))


def _add_power(powers: Powers, form: Form, degree: int, c: Fraction) -> None:
    """Adds c times a power of a form; forms that are multiples of one another are one form."""
    if not form:
        return
    scale = form[0][1] if degree > 1 else Fraction(1)
    unit = tuple((i, entry / scale) for i, entry in form)
    terms = powers.setdefault(unit, {})
    terms[degree] = terms.get(degree, Fraction(0)) + c * scale**degree


def _polynomial(bracket: Bracket, hamiltonian: Expr) -> Polynomial:
    """Coefficients by monomial, whatever the degree."""
    from sympy import PolynomialError, poly

    try:
        polynomial: Any = poly(hamiltonian, *bracket.variables)
    except PolynomialError:
        polynomial = None
    if polynomial is None or any(c.free_symbols for c in polynomial.coeffs()):
        raise UnsupportedFieldError(
            f"splitting: wanted a Hamiltonian that is a polynomial in the state; got {hamiltonian!s:.60}; use the "
            "Taylor method"
        )
    energy: Polynomial = {}
    for exponents, coefficient in polynomial.terms():
        monomial = tuple(i for i, exponent in enumerate(exponents) for _ in range(exponent))
        energy[monomial] = rational(coefficient)
    return energy


def _piece(bracket: Bracket, form: Form, terms: dict[int, Fraction]) -> Piece:
    """Form, derivative and matrix of one piece."""
    derivative = [Fraction(0)] * max(terms)
    for degree, c in terms.items():
        derivative[degree - 1] += degree * c
    number = "a coefficient of a piece of the Hamiltonian"
    return (
        tuple((i, as_coefficient(c, number)) for i, c in form),
        tuple(as_coefficient(c, number) for c in derivative),
        tuple((i, k, as_coefficient(c, number)) for (i, k), c in sorted(_generator(bracket, form).items())),
    )


def _generator(bracket: Bracket, form: Form) -> dict[tuple[int, int], Fraction]:
    """The matrix of the field of a linear form, without zeros."""
    coefficients = dict(form)
    matrix: defaultdict[tuple[int, int], Fraction] = defaultdict(Fraction)
    for i, j, k, c in bracket.entries():
        value = rational(c)
        matrix[i, k] += value * coefficients.get(j, 0)
        matrix[j, k] -= value * coefficients.get(i, 0)
    return {place: c for place, c in matrix.items() if c}
