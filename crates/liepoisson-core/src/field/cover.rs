//! Which tiles form a given set of products: a greedy cover, chosen once for a field.

use super::convolution::{SHAPES, Shape, Tile};
use std::collections::BTreeMap;

/// Tiles that form each of `products` (pairs of components, in either order) exactly once.
///
/// Tiles that share columns follow one another, so that these stay in the nearest cache.
pub(super) fn cover(n_components: usize, products: &[[usize; 2]]) -> Vec<Tile> {
    let mut open = Open::new(n_components, products);
    let mut tiles = Vec::new();
    while let Some(columns) = open.best_columns() {
        for (rows, shared) in open.panel(&columns).tiles() {
            let tile = Tile::new(&columns, &rows, shared, n_components);
            open.close(&tile);
            tiles.push(tile);
        }
    }
    tiles
}

/// The products that are not covered yet, as a symmetric relation between components.
struct Open {
    /// For each component the others with which its product is wanted, in ascending order: memory for the products that
    /// there are, not for all pairs of components.
    partners: Vec<Vec<usize>>,
}

/// The rows that a choice of columns offers: with all of them, and with the first alone.
struct Panel {
    columns: usize,
    shared: Vec<usize>,
    single: Vec<usize>,
}

impl Open {
    fn new(n: usize, products: &[[usize; 2]]) -> Open {
        let mut partners = vec![Vec::new(); n];
        for &[i, j] in products {
            partners[i].push(j);
            partners[j].push(i);
        }
        for others in &mut partners {
            others.sort_unstable();
            others.dedup();
        }
        Open { partners }
    }

    fn wants(&self, i: usize, j: usize) -> bool {
        self.partners[i].binary_search(&j).is_ok()
    }

    fn close(&mut self, tile: &Tile) {
        for [i, j] in tile.products() {
            debug_assert!(self.wants(i, j), "a product is formed once");
            for (i, j) in [(i, j), (j, i)] {
                if let Ok(at) = self.partners[i].binary_search(&j) {
                    self.partners[i].remove(at);
                }
            }
        }
    }

    /// The component with most open products, alone or with the one or two that share most partners with it, whichever
    /// costs least for each product; none when all are covered. Of several that are equal the first is taken.
    fn best_columns(&self) -> Option<Vec<usize>> {
        let degree = |i: usize| self.partners[i].len();
        let first = (0..self.partners.len()).rev().max_by_key(|&i| degree(i)).filter(|&i| degree(i) > 0)?;
        let mut columns = vec![first];
        let mut best = (self.panel(&columns).cost_per_product(), columns.clone());
        // the rows that all columns so far share
        let mut rows = self.partners[first].clone();
        while columns.len() < 3 {
            let mut common = BTreeMap::new();
            for &i in rows.iter().flat_map(|&row| &self.partners[row]).filter(|i| !columns.contains(i)) {
                *common.entry(i).or_insert(0_usize) += 1;
            }
            let Some((&next, _)) = common.iter().rev().max_by_key(|entry| entry.1) else {
                break;
            };
            columns.push(next);
            rows.retain(|&row| self.wants(next, row));
            let cost = self.panel(&columns).cost_per_product();
            if cost < best.0 {
                best = (cost, columns.clone());
            }
        }
        Some(best.1)
    }

    fn panel(&self, columns: &[usize]) -> Panel {
        // A column is no shared row: its products with two columns would be formed twice.
        let is_shared = |row: usize| !columns.contains(&row) && columns.iter().all(|&column| self.wants(column, row));
        let rows = || self.partners[columns[0]].iter().copied();
        let (shared, single) = if columns.len() == 1 {
            (Vec::new(), rows().collect())
        } else {
            (rows().filter(|&row| is_shared(row)).collect(), rows().filter(|&row| !is_shared(row)).collect())
        };
        Panel { columns: columns.len(), shared, single }
    }
}

impl Panel {
    /// Shapes that use up the shared rows, with single rows where a shape has room for them.
    fn shapes(&self) -> Vec<Shape> {
        let (mut shared, mut single) = (self.shared.len(), self.single.len());
        let mut shapes = Vec::new();
        let fits = |shape: &Shape, shared: usize, single: usize| {
            shape.columns == self.columns && shape.shared <= shared && shape.single <= single
        };
        let per_product = |shape: &Shape| shape.cost() / shape.n_products() as f64;
        loop {
            let best = SHAPES
                .iter()
                .filter(|shape| fits(shape, shared, single))
                .min_by(|a, b| per_product(a).total_cmp(&per_product(b)));
            let Some(&best) = best else { return shapes };
            shared -= best.shared;
            single -= best.single;
            shapes.push(best);
        }
    }

    fn cost_per_product(&self) -> f64 {
        let shapes = self.shapes();
        let cost: f64 = shapes.iter().map(|shape| shape.cost()).sum();
        cost / shapes.iter().map(|shape| shape.n_products()).sum::<usize>() as f64
    }

    /// Rows of each tile, and how many of them are shared.
    fn tiles(&self) -> Vec<(Vec<usize>, usize)> {
        let (mut shared, mut single) = (self.shared.as_slice(), self.single.as_slice());
        let mut tiles = Vec::new();
        for shape in self.shapes() {
            let (these, others) = shared.split_at(shape.shared);
            let (alone, rest) = single.split_at(shape.single);
            (shared, single) = (others, rest);
            tiles.push(([these, alone].concat(), shape.shared));
        }
        tiles
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The products that tiles form, each as (smaller, larger), sorted.
    fn formed(tiles: &[Tile]) -> Vec<[usize; 2]> {
        let mut formed: Vec<[usize; 2]> =
            tiles.iter().flat_map(Tile::products).map(|[i, j]| [i.min(j), i.max(j)]).collect();
        formed.sort_unstable();
        formed
    }

    proptest! {
        #[test]
        fn every_product_is_formed_exactly_once(
            n in 1..40_usize, pairs in proptest::collection::vec((0..40_usize, 0..40_usize), 0..400)
        ) {
            let mut products: Vec<[usize; 2]> =
                pairs.iter().map(|&(i, j)| [(i % n).min(j % n), (i % n).max(j % n)]).collect();
            products.sort_unstable();
            products.dedup();
            prop_assert_eq!(formed(&cover(n, &products)), products);
        }
    }

    #[test]
    fn products_of_a_large_dense_field_fill_their_tiles() {
        let products: Vec<[usize; 2]> = (0..120).flat_map(|i| (i..120).map(move |j| [i, j])).collect();
        let tiles = cover(120, &products);
        assert_eq!(formed(&tiles), products);
        // measured: 10.2 products in a tile, of at most 12
        let mean = products.len() as f64 / tiles.len() as f64;
        assert!(mean > 10.0, "{mean} products in a tile");
    }

    /// l2 l3, l3 l1, l1 l2 and the products of alpha x l and beta x l: 15 in two tiles.
    #[test]
    fn twisted_top_needs_two_tiles() {
        let mut products = vec![[0, 1], [0, 2], [1, 2]];
        for field in [3, 6] {
            products.extend((0..3).flat_map(|i| (0..3).filter(move |&j| j != i).map(move |j| [j, field + i])));
        }
        assert_eq!(cover(9, &products).len(), 2);
    }
}
