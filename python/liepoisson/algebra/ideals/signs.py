"""Signs of polynomials that can be read off their terms or their squares, for real values of the variables."""

from __future__ import annotations

from collections.abc import Collection

from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.quadratic_forms import vanishing_squares


def definite_terms(p: Poly, positive: Collection[int] = ()) -> list[Poly] | None:
    """The terms of a polynomial without their powers, if all of them have one sign and so vanish together.

    A term has a sign if every power in it is even or that of a positive variable. Positive variables are left out, as
    they do not vanish, and a single term is not taken apart, unless it never vanishes.

    Args:
        p: A polynomial over the rationals.
        positive: Numbers of the variables that are positive; all others are real.
    """
    context = p.context()
    signs: set[bool] = set()
    terms: list[Poly] = []
    for monomial, c in p.terms():
        signs.add(c > 0)
        powers = [int(k) for k in monomial]
        if len(signs) > 1 or any(k % 2 and v not in positive for v, k in enumerate(powers)):
            return None
        bases = tuple(int(bool(k) and v not in positive) for v, k in enumerate(powers))
        terms.append(context.from_dict({bases: 1}))
    return terms if len(terms) > 1 or all(t.is_constant() for t in terms) else None


def vanishing_parts(p: Poly, positive: Collection[int] = ()) -> list[Poly] | None:
    """Polynomials that vanish together where this one does, if its terms or completed squares show it.

    They have smaller degree, or are fewer terms; one of them is a constant if there is no real zero.
    """
    terms = definite_terms(p, positive)
    return terms if terms is not None else vanishing_squares(p)


def never_vanishes(p: Poly, positive: Collection[int] = ()) -> bool:
    """Whether the terms or the squares of a polynomial show that it has no real zero."""
    parts = vanishing_parts(p, positive)
    return parts is not None and any(t.is_constant() for t in parts)
