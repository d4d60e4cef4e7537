"""Real zeros of quadratic polynomials, against values on a grid and signs of eigenvalues."""

import random
from itertools import product

import numpy as np
import pytest
import sympy
from flint import fmpq, fmpq_mpoly_ctx

from liepoisson.algebra.ideals.signs import vanishing_squares

CONTEXT = fmpq_mpoly_ctx.get(["a", "b", "c"], "degrevlex")
A, B, C = CONTEXT.gens()


@pytest.mark.parametrize(
    ("p", "parts"),
    [
        (A**2 + A * B + B**2, [A + B / 2, B]),  # (a + b/2)^2 + 3 b^2/4
        (A**2 - A + B**2 + 1, [1]),  # (a - 1/2)^2 + b^2 + 3/4
        (A**2 - 2 * A * B + B**2 + 1, [1]),
        (-(A**2) + 2 * A - 1 - B**2, [A - 1, B]),
        (A**4 + A**2 * B**2 + B**4, [A**2 + B**2 / 2, B**2]),
        (A**2 - 2 * A * B + B**2 - 2, None),
        (A**2 + B**2 - 1, None),
        (A * B - 1, None),
        (A**2 - B, None),
        (A**2 + C, None),
        (A**3 + B**3, None),
        (A, None),
    ],
)
def test_polynomials_whose_squares_are_completed_by_hand(p, parts):
    found = vanishing_squares(p)
    assert (found if found is None else [q - r for q, r in zip(found, parts, strict=True)]) == (
        None if parts is None else [0] * len(parts)
    )


@pytest.mark.parametrize("seed", range(30))
def test_signs_are_those_of_the_eigenvalues_of_the_form(seed):
    """q = (x, 1) S (x, 1)^T has no real zero if S is definite, and a proper zero set if it is semidefinite.

    If S is indefinite it takes both signs on vectors (x, t), and so for t = 1, as t = 0 is no open set.
    """
    rng = random.Random(seed)
    monomials = [x * y for x, y in product((A, B, C, CONTEXT.constant(1)), repeat=2)]
    if seed % 2:
        p = sum((rng.choice((-2, -1, 0, 0, 1, 2)) * m for m in monomials), CONTEXT.constant(0))
    else:  # a sum of squares
        forms = [sum((rng.choice((-1, 0, 1)) * x for x in (A, B, C, 1)), CONTEXT.constant(0)) for _ in range(3)]
        p = sum((rng.choice((0, 1, 3)) * f * f for f in forms), CONTEXT.constant(0))
    if p.total_degree() < 2:
        return
    found = vanishing_squares(p)
    gens = sympy.symbols("a b c")
    h = sympy.Symbol("h")
    form = sympy.sympify(str(p).replace("^", "**")).as_poly(*gens).homogenize(h).as_expr()
    eigenvalues = np.linalg.eigvalsh(np.array(sympy.hessian(form, (*gens, h)), dtype=float))
    signs = {bool(v > 0) for v in eigenvalues if abs(v) > 1e-9}
    assert (found is not None) == (len(signs) == 1)
    if found is None:
        return
    for point in product((-2, -1, 0, 1, 2), repeat=3):
        at = dict(zip("abc", map(fmpq, point), strict=True))
        values = [q.subs(at) if not q.is_constant() else q for q in (p, *found)]
        assert (values[0] == 0) == all(v == 0 for v in values[1:])
