//! The graph of the edges: two loops through one set.

use super::{Check, Edge, Place, Refusal};

/// A loop: numbers of edges, in their order, from the common set back to it.
pub type Loop = Vec<usize>;

/// The loop of the periodic orbit, which has fewer sets, and the excursion.
///
/// Every set must be in one of them, and exactly one set in both, so that it has two edges in and two out, every other one.
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
    let degrees = |set: usize| {
        let n_out = edges.iter().filter(|edge| edge.from == set).count();
        (n_out, edges.iter().filter(|edge| edge.to == set).count())
    };
    let Some(common) = (0..n_sets).find(|&set| degrees(set) == (2, 2)) else {
        return refused(Place::Everywhere, "a set with two edges in and two out");
    };
    if let Some(set) = (0..n_sets).find(|&set| set != common && degrees(set) != (1, 1)) {
        return refused(Place::Set(set), "one edge in and one out");
    }
    let starts: Vec<usize> = (0..edges.len()).filter(|&number| edges[number].from == common).collect();
    let mut found: Vec<Loop> = starts.into_iter().map(|start| follow(edges, start)).collect();
    // what is left after two loops through the common set would be a loop of its own
    if found.iter().map(Vec::len).sum::<usize>() != edges.len() {
        return refused(Place::Everywhere, "two loops through one set that contain all edges");
    }
    found.sort_by_key(Vec::len);
    match <[Loop; 2]>::try_from(found) {
        Ok([first, second]) if first.len() < second.len() => Ok([first, second]),
        _ => refused(Place::Everywhere, "an excursion through more sets than the periodic orbit"),
    }
}

/// The edges from the common set back to it. Since each other set has one edge in and one out, it comes back.
fn follow(edges: &[Edge], start: usize) -> Loop {
    let common = edges[start].from;
    let mut path = vec![start];
    let mut at = edges[start].to;
    while at != common && path.len() <= edges.len() {
        match edges.iter().position(|edge| edge.from == at) {
            Some(next) => {
                path.push(next);
                at = edges[next].to;
            }
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
    fn two_loops_through_one_set_are_found_in_any_order() {
        let shuffled = edges(&[(3, 4), (1, 0), (0, 2), (2, 3), (0, 1), (4, 0)]);
        assert_eq!(loops(&shuffled, 5), Ok([vec![4, 1], vec![2, 3, 0, 5]]));
        assert_eq!(loops(&edges(&[(0, 0), (0, 1), (1, 0)]), 2), Ok([vec![0], vec![1, 2]]));
        assert_eq!(loops(&edges(&[(0, 2), (2, 1), (1, 2), (2, 3), (3, 0)]), 4), Ok([vec![1, 2], vec![3, 4, 0]]));
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
