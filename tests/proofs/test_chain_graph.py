"""The graph of a certificate is two loops through one set, and nothing else."""

import pytest

from liepoisson.errors import EnclosureError
from liepoisson.proofs.certificate import chain_graph

GOOD = [(0, 1, False), (1, 0, True), (0, 2, False), (2, 3, False), (3, 4, False), (4, 0, True)]


def test_two_loops_are_found_in_any_order_of_the_edges():
    graph = chain_graph(5, GOOD)
    assert (graph.start, graph.other, graph.middle) == (0, 1, 3)
    assert graph.short == (0, 1)
    assert graph.long == (2, 3, 4, 5)
    backward = chain_graph(5, GOOD[::-1])
    assert (backward.start, backward.other, backward.middle) == (0, 1, 3)


@pytest.mark.parametrize(
    "edges",
    [
        [],
        GOOD[:-1],
        GOOD[1:],
        [*GOOD, GOOD[0]],
        [*GOOD[:2], (0, 2, False), (2, 0, True)],  # an excursion of two edges
        [*GOOD[:3], (2, 4, False), *GOOD[4:]],  # to the wrong set
        [(0, 1, False), (1, 0, False), *GOOD[2:]],  # without the symmetry
        [(0, 1, True), (1, 0, True), *GOOD[2:]],  # with it twice
        [*GOOD[:2], (0, 2, True), *GOOD[3:]],
        [(0, 1, False), (1, 0, True), (0, 1, False), (1, 0, True)],
    ],
)
def test_another_graph_is_refused(edges):
    with pytest.raises(EnclosureError, match="graph"):
        chain_graph(5, edges)


def test_a_loop_apart_from_the_others_is_refused():
    with pytest.raises(EnclosureError, match="graph"):
        chain_graph(7, [*GOOD, (5, 6, False), (6, 5, True)])
