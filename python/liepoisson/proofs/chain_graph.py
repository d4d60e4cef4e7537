"""The graph of a certificate: two loops through one set, a short one along gamma and a long one, the excursion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from liepoisson.errors import EnclosureError


@dataclass(frozen=True)
class ChainGraph:
    """Two loops through one set, as numbers of edges in their order.

    Attributes:
        start: Number of the set in which the loops meet, p_a.
        other: Number of the other set of the short loop, p_b.
        short: Edges of the short loop, p_a -> p_b -> p_a.
        long: Edges of the excursion, p_a -> q_1 -> ... -> p_a.
        middle: Number of the set half-way along the excursion.
        middle_edge: Place in `long` of the edge that ends in the middle set.
    """

    start: int
    other: int
    short: tuple[int, ...]
    long: tuple[int, ...]
    middle: int
    middle_edge: int


def chain_graph(n_sets: int, edges: Sequence[tuple[int, int, bool]]) -> ChainGraph:
    """The loops of a list of edges, each (from, to, symmetry).

    Raises:
        EnclosureError: the edges are not two loops through one set, of which one has two edges and each carries the
            symmetry an odd number of times.
    """
    leaving: dict[int, list[int]] = {k: [] for k in range(n_sets)}
    arriving = dict.fromkeys(range(n_sets), 0)
    for number, (source, target, _) in enumerate(edges):
        leaving[source].append(number)
        arriving[target] += 1
    branching = [k for k in range(n_sets) if len(leaving[k]) == 2 and arriving[k] == 2]
    if len(branching) != 1 or any(
        len(leaving[k]) != 1 or arriving[k] != 1 for k in range(n_sets) if k not in branching
    ):
        raise EnclosureError(
            "the graph: wanted two loops that meet in one set and pass once through each other set; got another graph"
        )
    start = branching[0]
    loops: list[tuple[int, ...]] = []
    for first in leaving[start]:
        loop, place = [first], edges[first][1]
        while place != start:
            loop.append(leaving[place][0])
            place = edges[loop[-1]][1]
        loops.append(tuple(loop))
    loops.sort(key=len)
    short, long = loops
    if sum(map(len, loops)) != len(edges) or len(short) != 2 or len(long) < 4:
        raise EnclosureError("the graph: wanted a loop of two edges and one of four or more through one set")
    for loop, what in ((short, "short"), (long, "long")):
        if sum(edges[e][2] for e in loop) % 2 != 1:
            raise EnclosureError(f"the graph: the {what} loop must carry the symmetry an odd number of times")
    middle_edge = (len(long) - 1) // 2
    return ChainGraph(start, edges[short[0]][1], short, long, edges[long[middle_edge]][1], middle_edge)
