"""What the search and the verdicts of equilibria refuse, and in which words."""

from functools import partial

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError, ShapeError
from liepoisson.phase_space import equilibrium, equilibrium_near, sleeping_top

TOP, LAGRANGE, KOVALEVSKAYA = lp.Top.twisted_lagrange(), lp.Top.lagrange(), lp.Top.twisted_kovalevskaya()
LEAF, ZERO = lp.Leaf.through(TOP, [1, 0, 0, 0, 1, 0, 0, 0, 1]), np.zeros(9)
STANDING, LEANING = [0, 0, 1, 0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0, 0, 0, 0]
ENERGY = "(dot(l, l) + l3^2)/2 + alpha3"
SMALL = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + 2*l2^2 + 3*l3^2)/2 + (alpha1 + 3*alpha3/10)/10^15")
along_l3 = partial(lp.equilibria, TOP, LEAF, along=("l3",))

REFUSED = [
    *((partial(call, bad, ZERO), ParameterError, "wanted a system")
      for call in (equilibrium, equilibrium_near, lp.equilibria) for bad in (None, "kovalevskaya", lp.Top)),
    (partial(equilibrium, LAGRANGE, LEANING), ParameterError, r"\|x'\| = 1 there\. equilibrium_near"),
    (partial(equilibrium, LAGRANGE, LEANING, along=("l3",)), ParameterError, "of which 1 is not a motion"),
    *((partial(equilibrium, LAGRANGE, STANDING, tol=bad), ParameterError, "tol: wanted a finite number")
      for bad in (np.inf, -1, "a")),
    (partial(equilibrium_near, TOP, [1, 2, 3]), ShapeError, "."),
    *((partial(call, KOVALEVSKAYA, np.full(9, 1e-200)), ParameterError, "component of at least 1e-100")
      for call in (equilibrium, equilibrium_near)),
    # along: a Casimir moves nothing, and relative to H, or to 2 H - C1, every state is at rest
    *((partial(equilibrium, TOP, ZERO, along=bad), ParameterError, "along must be a sequence of integrals")
      for bad in (None, [1], {"l3"})),
    *((partial(equilibrium, TOP, ZERO, along=(name,)), ParameterError, "is a Casimir") for name in ("C1", "C3")),
    *((partial(equilibrium, TOP, ZERO, along=(name,)), ParameterError, "is the motion itself")
      for name in ("H", f"-3*({ENERGY}) + dot(alpha, beta)")),
    (partial(equilibrium_near, TOP, ZERO, along=("l1",)), ParameterError, "l1 is not constant"),
    (partial(equilibrium_near, TOP, ZERO, along="l3"), ParameterError, "Write"),
    *((partial(along_l3, **bad), ParameterError, "values must give")
      for bad in ({}, {"values": 3}, {"values": {"l3": np.nan}}, {"values": {"l3": 1, "P": 1}})),
    (partial(along_l3, values={"l3": "a"}), ParameterError, "a finite number"),
    # leaves
    *((partial(lp.equilibria, TOP, bad), ParameterError, "leaf must be a Leaf") for bad in (None, [1, 0, 1])),
    *((partial(lp.equilibria, other, LEAF), ParameterError, "leaf must be one of")
      for other in (lp.Top.kovalevskaya(), lp.Top.twisted_kovalevskaya(epsilon=2))),
    (partial(lp.equilibria, TOP, {"C1": 1, "C2": 0, "C3": -1}), LeafError, "."),
    (partial(lp.equilibria, TOP, LEAF, n_starts=0), ParameterError, "n_starts"),
    (partial(lp.equilibria, TOP, LEAF, most_starts=0), ParameterError, "most_starts"),
    (lambda: lp.equilibria(SMALL, lp.Leaf(SMALL, {"C1": 1e30, "C2": 0.3e15})), LeafError, "range of numbers"),
    # sleeping tops
    (partial(sleeping_top, KOVALEVSKAYA, l3=1, alpha3=1), ParameterError, "I1 = I2"),
    (partial(sleeping_top, lp.catalog.system("manakov-so4"), l3=1, alpha3=1), ParameterError, "nine variables"),
    (partial(sleeping_top, LAGRANGE, l3=1, alpha3=0), ParameterError, "must not be zero"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_what_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_a_leaf_of_one_state_has_a_stable_equilibrium():
    for call in (equilibrium, equilibrium_near):
        found = call(TOP, ZERO, along=("l3",))
        assert (found.spectrum.shape, found.signature, found.nonlinear_stability) == ((0,), (0, 0, 0), "stable")
