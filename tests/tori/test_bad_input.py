"""What `lp.tori` refuses, by name: numbers, shapes, leaves of other dimensions, integrals beside a map."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LeafError, LiePoissonError, ParameterError

PENDULUM = lp.catalog.system("spherical-pendulum")
LEAF = lp.Leaf(PENDULUM, {"C1": 0, "C2": 1})
QUARTIC = lp.System(lp.canonical(names=["q"]), "p_q^2/2 + q^4/4")
TOP = lp.Top.twisted_lagrange()
DIAGRAM = lp.tori.lagrange_diagram(lp.Leaf(TOP, {"C1": 0.5, "C2": 0.2, "C3": 1}))


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: lp.tori.diagram(LEAF, energy_max=np.nan), "energy_max"),
        (lambda: lp.tori.diagram(LEAF, n_starts=0), "n_starts"),
        (lambda: lp.tori.molecule(LEAF, np.nan), "energy"),
        (lambda: lp.tori.diagram(LEAF, spread=1e300), "spread"),
        (lambda: lp.tori.critical_states(LEAF, spread=1e300), "spread"),
        (lambda: lp.tori.diagram(DIAGRAM.leaf, at={"l3": 0.3}, n_starts=5, spread=1e-300), "spread"),
        (lambda: lp.tori.regions(lp.tori.diagram(LEAF, energy_max=2, n_starts=5), spread=np.nan), "spread"),
        (lambda: lp.tori.regions(lp.tori.diagram(LEAF, energy_max=2, n_starts=5), spread="x"), "spread"),
        (lambda: lp.tori.period_lattice(QUARTIC, [1e200, 0]), "state"),
        (lambda: DIAGRAM.boundary(0.5, 1), "n_points"),
        (lambda: DIAGRAM.boundary(np.nan), "l3"),
        (lambda: DIAGRAM.boundary("a"), "l3"),
        (lambda: DIAGRAM.depth([np.nan, 0, 0]), "values"),
        (lambda: lp.tori.lagrange_lattice(DIAGRAM, [np.nan, 0, 0]), "values"),
        (lambda: lp.tori.lagrange_lattice(DIAGRAM, [1e200, 0, 0]), "values"),
        (lambda: lp.tori.lagrange_lattice(DIAGRAM, [1e30, 0, 0]), "values"),
        (lambda: lp.tori.lagrange_actions(DIAGRAM, [np.inf, 0, 0]), "values"),
        (lambda: lp.tori.lagrange_monodromy(DIAGRAM, [[[3, 0.5, 0.2], [np.nan, 0, 0], [3, 0.5, 0.2]]]), "loops"),
        (lambda: lp.tori.lagrange_diagram(lp.Leaf(TOP, {"C1": 1e200, "C2": 0.2, "C3": 1})), "leaf"),
    ],
)
def test_a_wrong_number_is_refused_by_name(call, argument):
    with pytest.raises(LiePoissonError, match=f"^{argument}: "):
        call()


@pytest.mark.parametrize(
    ("system", "state"),
    [(lp.catalog.system("lagrange"), [0.3, 0.4, 1, 0, 0, 0]), (TOP, [0.3, 0.4, 1, 0.1, 0.2, 1, 0, 0, 0])],
)
def test_a_singular_leaf_is_refused(system, state):
    """alpha = 0 has the dimension 2, beta = 0 of the twisted top 4."""
    leaf = lp.Leaf.through(system, state)
    for call in (
        lp.tori.critical_states,
        lp.tori.diagram,
        lambda one: lp.tori.fibre(one, [1.0] * (leaf.rank // 2 + 1)),
    ):
        with pytest.raises(LeafError, match="wanted one of dimension"):
            call(leaf)


def test_a_map_has_its_own_integrals():
    momentum = lp.tori.momentum_map(PENDULUM)
    loop = [[0, 0.2], [0.5, 0.2], [0.5, -0.2]]
    for call in (
        lambda: lp.tori.period_lattice(momentum, [0, 1.3, 0, 0.8, 0, 0.6], integrals=["l3^2"]),
        lambda: lp.tori.monodromy(momentum, [0, 1.3, 0, 0.8, 0, 0.6], loop, integrals=["l3^2"]),
    ):
        with pytest.raises(ParameterError, match="has its own"):
            call()


def test_names_of_users_replace_no_column():
    """Coordinates and integrals may be called as the columns are."""
    system = lp.System(lp.canonical(names=["rank", "type"]), "(p_rank^2 + rank^2)/2 + (p_type^2 + 2*type^2)/2")
    momentum = lp.tori.momentum_map(system, ["(p_rank^2 + rank^2)/2"])
    found = lp.tori.critical_states(lp.Leaf(system, {}), momentum=momentum, n_starts=5)
    table = found.to_dataframe()
    assert table["rank"].tolist() == found.rank.tolist()
    assert table["type"].tolist() == found.type.tolist()
    np.testing.assert_array_equal(table["x_rank"], found.states[:, 0])
    assert len(table.columns) == 2 + 2 + 4


@pytest.mark.parametrize("size", [1e3, 1e5, 1e7])
def test_values_that_doubles_do_not_resolve_are_refused(size):
    """A Casimir in H leaves 1e-16 of its size of each value: one torus, or a refusal."""
    system = lp.System(lp.so(3) @ lp.semidirect(2), f"dot(l, l)/2 + alpha3 + {size:.0f}*dot(alpha, alpha)")
    leaf, momentum = lp.Leaf(system, {"C1": 0, "C2": 1}), lp.tori.momentum_map(system, ["l3"])
    if size < 1e4:
        assert lp.tori.fibre(leaf, [size + 0.5, 0.3], momentum=momentum, n_states=20).n_tori == 1
        assert lp.tori.molecule(leaf, size + 0.5, momentum=momentum, n_starts=20).families.tolist() == [[0, 1]]
        return
    for call in (
        lambda: lp.tori.fibre(leaf, [size + 0.5, 0.3], momentum=momentum),
        lambda: lp.tori.diagram(leaf, momentum=momentum),
        lambda: lp.tori.molecule(leaf, size + 0.5, momentum=momentum),
    ):
        with pytest.raises(ParameterError, match="doubles do not resolve"):
            call()
