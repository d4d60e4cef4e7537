"""Pickles and copies of FLINT's polynomials and matrices over the rationals and of Arb's balls.

python-flint cannot make them.

A module whose objects are kept in results registers them with `copyreg`, which `pickle` and `copy` ask.  A
polynomial in several variables keeps their names and their order.
"""

from __future__ import annotations

import copyreg
from typing import Any

from flint import acb, acb_mat, arb, fmpq_mat, fmpq_mpoly, fmpq_mpoly_ctx, fmpq_poly, fmpz_mat, fmpz_poly


def _polynomial(value: fmpq_poly | fmpz_poly) -> tuple[Any, tuple[Any, ...]]:
    return type(value), (value.coeffs(),)


def _matrix(value: fmpq_mat | fmpz_mat) -> tuple[Any, tuple[Any, ...]]:
    return type(value), (value.nrows(), value.ncols(), value.entries())


def _context(value: fmpq_mpoly_ctx) -> tuple[Any, tuple[Any, ...]]:
    return fmpq_mpoly_ctx.get, (value.names(), value.ordering())


def _in_variables(value: fmpq_mpoly) -> tuple[Any, tuple[Any, ...]]:
    return _from_terms, (value.context(), value.to_dict())


def _from_terms(context: fmpq_mpoly_ctx, terms: dict[tuple[int, ...], Any]) -> fmpq_mpoly:
    return context.from_dict(terms)


def _ball(value: arb) -> tuple[Any, tuple[Any, ...]]:
    if not value.is_finite():
        return arb, (str(value.mid()), str(value.rad()))
    return _from_powers, tuple(tuple(map(int, part.man_exp())) for part in (value.mid(), value.rad()))


def _from_powers(mid: tuple[int, int], rad: tuple[int, int]) -> arb:
    return arb(arb(mid), arb(rad))


def _complex_ball(value: acb) -> tuple[Any, tuple[Any, ...]]:
    return acb, (value.real, value.imag)


def _matrix_of_balls(value: acb_mat) -> tuple[Any, tuple[Any, ...]]:
    return type(value), (value.tolist(),)


def register() -> None:
    """Tell `copyreg` of them; done again it changes nothing."""
    copyreg.pickle(fmpq_poly, _polynomial)
    copyreg.pickle(fmpz_poly, _polynomial)
    copyreg.pickle(fmpq_mat, _matrix)
    copyreg.pickle(fmpz_mat, _matrix)
    copyreg.pickle(fmpq_mpoly_ctx, _context)
    copyreg.pickle(fmpq_mpoly, _in_variables)
    copyreg.pickle(arb, _ball)
    copyreg.pickle(acb, _complex_ball)
    copyreg.pickle(acb_mat, _matrix_of_balls)
