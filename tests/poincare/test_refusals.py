"""What sections refuse, and in which words."""

from functools import partial

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.compile.field import TapeFunction, TopField
from liepoisson.errors import ExpressionError, LeafError, ParameterError, ShapeError
from liepoisson.poincare.surfaces import section_state

TOP, KOVALEVSKAYA, OSCILLATOR = (
    lp.Top.twisted_kovalevskaya(),
    lp.catalog.system("kovalevskaya"),
    lp.catalog.system("henon-heiles"),
)
SURFACE = lp.sections.good_surface(TOP)
X0 = lp.sample_states(TOP, 1, seed=1)
LEAF = lp.Leaf.through(TOP, [0.3, -0.5, 0.4, 0.6, 0.2, -0.3, 0.5, 0.1, 0.8])
SMALL = lp.Leaf(KOVALEVSKAYA, {"C1": 0.5, "C2": 1})
AT_REST = lp.Leaf(lp.System(lp.so(3) @ lp.trivial(), "dot(l, l)"), {"C1": 1})
OUT_OF_REACH = r"^states on .* the energy lies between .* -9 was asked for\.$"
good_surface = lp.sections.good_surface


def section(system=TOP, x0=X0, **options):
    return lp.section(system, x0, **({"surface": "l3", "t_end": 1} | options))


def starts(leaf=LEAF, surface=SURFACE, **options):
    return lp.sections.section_starts(leaf, surface, **({"energy": 1.0, "n_starts": 3, "seed": 1} | options))


def folded(system=OSCILLATOR, **options):
    return section(
        system, lp.sample_states(system, 2, seed=1) / 4, surface=system.component_names[0], t_end=20, **options
    )


REFUSED = [
    (partial(section, surface="l3 + nothing"), ExpressionError, "nothing"),
    *((partial(section, surface=bad), ParameterError, "surface: wanted a function of the state") for bad in (None, 3)),
    *((partial(section, surface=bad), ParameterError, "constant on each leaf") for bad in ("0", "1")),
    *((partial(section, surface=bad), ParameterError, "its bracket with every component is zero")
      for bad in ("dot(beta, beta) - 1", "exp(dot(alpha, beta)) - 2")),
    *((partial(make, LEAF, bad, **options), ParameterError, "its bracket with (every component|H) is zero")
      for make, options in ((lp.sections.section_starts, {"energy": 1, "n_starts": 2}),
                            (lp.sections.section_state, {"energy": 1, "coordinates": {}}))
      for bad in ("dot(beta, beta) - 1", "H", TOP.hamiltonian - 1)),
    (partial(section, surface="atan2(l1, l2)"), ParameterError, r"atan2 jumps by 2\*pi; try sin\(c\)\*x"),
    (partial(KOVALEVSKAYA.expression, "atan2(0, 0)"), ExpressionError, "has no angle"),
    (partial(lp.System, KOVALEVSKAYA.bracket, "atan2(l1, l2)"), ExpressionError, r"atan2 jumps by 2\*pi"),
    *((partial(KOVALEVSKAYA.expression, text), ExpressionError, words)
      for text, words in (("atan2(l1)", "two scalars"), ("atan2(l, l1)", "two scalars"))),
    *((partial(section, direction=bad), ParameterError, "direction") for bad in (2, True, "up", np.ones(2))),
    *((partial(section, t_end=bad), ParameterError, "t_end") for bad in (0, np.inf)),
    (partial(section, n_crossings=0), ParameterError, "n_crossings"),
    *((partial(section, keep=bad), ParameterError, "keep") for bad in ("l1", ())),
    (partial(section, keep=[1]), ParameterError, "keep: wanted a function"),
    (partial(section, keep=1), ParameterError, "keep: wanted a sequence"),
    (partial(section, method=lp.RungeKutta()), ParameterError, "Taylor"),
    (partial(section, method=lp.Taylor(precision="mixed")), ParameterError, "double precision"),
    (partial(section, start_side=2), ParameterError, "start_side"),
    (partial(section, start_side=[1, 1]), ShapeError, "start_side"),
    (partial(section, surface=TapeFunction(3, (), (0,))), ShapeError, "9 components"),
    (partial(section, surface=TapeFunction(9, (), ())), ParameterError, "one output"),
    (partial(section, surface=TapeFunction(9, (), (0, 1)), keep=("a", "b")), ParameterError, "1 further"),
    (partial(section, TopField((2, 2, 1), (-1, 0, 0), (0, 0, 0), 1.0)), ParameterError, "wanted a TapeFunction"),
    (lambda: section().go_on(t_end=1, starts=X0), ParameterError, "other arguments than starts"),
    (lambda: folded(keep=["y", "p_y"]).is_folded(), ParameterError, "of which it is not known"),
    (lambda: folded(TOP).is_folded(), ParameterError, "got one of dimension 4"),
    (partial(lp.sections.first_return, TOP, np.zeros(5), surface="l3", t_end=1), ShapeError, "9 components"),
    (partial(good_surface, lp.Top(inertia=(2, 2, 1), a=(0, 0, 0), b=(1, 0, 0), epsilon=1)), ParameterError, "constant"),
    (partial(good_surface, lp.catalog.system("manakov-so4")), ParameterError, "time derivative of a bounded function"),
    (partial(lp.sections.default_surface, AT_REST), ParameterError, "every state is an equilibrium"),
    (partial(starts, direction=2), ParameterError, "direction"),
    (partial(starts, direction=np.ones(2), spread=True), ParameterError, "direction"),
    (partial(starts, seed=-1), ParameterError, "seed"),
    (partial(starts, surface="beta1 - 5"), LeafError, "converged from 0 of 192 guesses, 0 %"),
    *((partial(starts, energy=bad, spread=spread), ParameterError, "energy")
      for bad in (None, np.nan, "x") for spread in (False, True)),
    (partial(section_state, LEAF, SURFACE, None, {"l3": 0.2}), ParameterError, "energy"),
    (partial(section_state, LEAF, SURFACE, 1.5, {"l3": np.nan}), ParameterError, "finite"),
    (partial(section_state, LEAF, SURFACE, 1.5, {"beta1": 7}), LeafError, r"beta1 = 7.*least residual .* 65 guesses"),
    (partial(section_state, LEAF, SURFACE, 1.5, {"beta1": 7}, guess=LEAF.state), LeafError, "from 1 guess "),
    (partial(section_state, SMALL, "l3", -9, {"alpha1": 0.2}), LeafError, OUT_OF_REACH),
    *((partial(starts, SMALL, "l3", energy=-9, spread=spread), LeafError, OUT_OF_REACH) for spread in (False, True)),
    (partial(SMALL.project, SMALL.state, energy=-9, surface="l3"), LeafError, OUT_OF_REACH),
    (partial(SMALL.sample, 3, seed=2, energy=-9), LeafError, OUT_OF_REACH),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_what_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call()
