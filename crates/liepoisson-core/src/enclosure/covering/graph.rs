//! The graph of the edges: two loops through one set.

use super::{Check, Edge, Place, Refusal};

/// A loop: numbers of edges, in their order, from the first set back to it.
pub type Loop = Vec<usize>;

/// The loop of the periodic orbit, with fewer sets, and the excursion.
///
/// Every set must be in one of them, and only the first one in both; every set but this has one edge in and one out.
///
/// # Errors
/// The edges form anything else.
pub fn loops(edges: &[Edge], n_sets: usize) -> Result<[Loop; 2], Refusal> {
    let refused = |place, wanted| Err(Refusal::new(Check::Graph, place, wanted));
    if edges.is_empty() {
        return refused(Place::Everywhere, "edges");
    }
    for (number, edge) in edges.iter().enumerate() {
        if edge.from >= n_sets || edge.to >= n_sets {
            return refused(Place::Edge(number), "the numbers of sets that are there");
        }
        if !(edge.time > 0.0 && edge.time.is_finite()) {
            return refused(Place::Edge(number), "a positive finite time");
        }
    }
    for set in 0..n_sets {
        let wanted = if set == 0 { 2 } else { 1 };
        let n_out = edges.iter().filter(|edge| edge.from == set).count();
        let n_in = edges.iter().filter(|edge| edge.to == set).count();
        if (n_out, n_in) != (wanted, wanted) {
            return refused(
                Place::Set(set),
                "two edges out of and into the first set, one out of and into every other",
            );
        }
    }
    let starts: Vec<usize> = (0..edges.len()).filter(|&number| edges[number].from == 0).collect();
    let mut found: Vec<Loop> = starts.into_iter().map(|start| follow(edges, start)).collect();
    // what is left after two loops through the first set would be a loop of its own
    if found.iter().map(Vec::len).sum::<usize>() != edges.len() {
        return refused(Place::Everywhere, "two loops through the first set that contain all edges");
    }
    found.sort_by_key(Vec::len);
    match <[Loop; 2]>::try_from(found) {
        Ok([first, second]) if first.len() < second.len() => Ok([first, second]),
        _ => refused(Place::Everywhere, "an excursion through more sets than the periodic orbit"),
    }
}

/// The edges from the first set back to it. Since each other set has one edge in and one out, it comes back.
fn follow(edges: &[Edge], start: usize) -> Loop {
    let mut path = vec![start];
    while edges[path[path.len() - 1]].to != 0 && path.len() <= edges.len() {
        let at = edges[path[path.len() - 1]].to;
        match edges.iter().position(|edge| edge.from == at) {
            Some(next) => path.push(next),
            None => break,
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(pairs: &[(usize, usize)]) -> Vec<Edge> {
        pairs.iter().map(|&(from, to)| Edge { from, to, time: 1.0, is_reflected: false }).collect()
    }

    #[test]
    fn two_loops_through_the_first_set_are_found_in_any_order() {
        let shuffled = edges(&[(3, 4), (1, 0), (0, 2), (2, 3), (0, 1), (4, 0)]);
        assert_eq!(loops(&shuffled, 5), Ok([vec![4, 1], vec![2, 3, 0, 5]]));
        assert_eq!(loops(&edges(&[(0, 0), (0, 1), (1, 0)]), 2), Ok([vec![0], vec![1, 2]]));
    }

    #[test]
    fn every_other_list_of_edges_is_refused() {
        let good = [(0, 1), (1, 0), (0, 2), (2, 3), (3, 4), (4, 0)];
        assert!(loops(&edges(&good), 5).is_ok());
        let mut lists: Vec<Vec<(usize, usize)>> = vec![vec![]];
        for left_out in 0..good.len() {
            lists.push(good.iter().enumerate().filter(|&(k, _)| k != left_out).map(|(_, &edge)| edge).collect());
        }
        for target in 0..5 {
            for changed in 0..good.len() {
                let mut list = good.to_vec();
                list[changed].1 = target;
                if target != good[changed].1 {
                    lists.push(list);
                }
            }
        }
        lists.push([good.as_slice(), &[(0, 1)]].concat()); // an edge twice
        lists.push(vec![(0, 1), (1, 0), (2, 3), (3, 2)]); // a loop apart
        lists.push(vec![(0, 1), (1, 0), (0, 2), (2, 0), (3, 4), (4, 3)]);
        lists.push(vec![(0, 1), (1, 0), (0, 2), (2, 0)]); // loops of one length
        lists.push(vec![(0, 1), (1, 0), (0, 2), (2, 3), (3, 9), (4, 0)]); // no such set
        for list in lists {
            assert!(loops(&edges(&list), 5).is_err(), "{list:?}");
        }
        for time in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut list = edges(&good);
            list[2].time = time;
            assert_eq!(loops(&list, 5).unwrap_err().place, Place::Edge(2));
        }
        let two_apart = loops(&edges(&[(0, 1), (1, 0), (0, 2), (2, 0)]), 3);
        assert!(two_apart.is_err());
    }
}
