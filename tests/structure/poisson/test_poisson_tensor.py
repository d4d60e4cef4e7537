import pytest
import sympy as sp

from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import se, sine, so, su
from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor

# Brackets and the ranks of their generic leaves: dimension minus number of Casimirs.
RANKS = {
    "free rigid body": (so(3) @ trivial(), 2),
    "heavy top": (so(3) @ semidirect(2), 4),
    "twisted top": (so(3) @ leibniz(3, "epsilon"), 6),
    "underwater vehicle": (se(3) @ trivial(), 4),
    "su(3)": (su(3) @ trivial(), 6),
    "Zeitlin's fluid on su(3)": (sine(3) @ trivial(), 6),
}


@pytest.mark.parametrize(("bracket", "rank"), RANKS.values(), ids=RANKS)
def test_the_rank_at_a_point_is_that_of_the_generic_leaf(bracket, rank):
    assert bracket.tensor.generic_rank.rank == bracket.tensor.rank_at_a_point == rank
    assert len(bracket.tensor.generic_rank.point) == bracket.dimension


def test_the_rank_is_found_without_images_modulo_primes():
    # x' = (a log(2) + sqrt(a)) y: a field that SymPy only simplifies in.
    a = sp.Symbol("a", positive=True)
    c = a * sp.log(2) + sp.sqrt(a)
    tensor = LinearPoissonTensor.of(3, [(0, 1, 2, c), (1, 0, 2, -c)])
    assert tensor.generic_rank is None
    assert tensor.rank_at_a_point == 2


def test_where_beta_vanishes_the_twisted_top_is_a_heavy_top():
    twisted, heavy = (so(3) @ leibniz(3)).tensor, (so(3) @ semidirect(2)).tensor
    assert twisted.restricted(range(6)).rows == heavy.rows
    # The coordinates (l, beta) have the same brackets; in another order they do not.
    assert twisted.restricted([0, 1, 2, 6, 7, 8]).rows == heavy.rows
    assert twisted.restricted([6, 7, 8, 0, 1, 2]).rows != heavy.rows
