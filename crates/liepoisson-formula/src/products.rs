//! Products as multiplications and divisions of two registers, shared as far as several products have them in common.
//!
//! A product is a list of factors that multiply or divide. The pair of factors that stands in most products is made a factor
//! of its own, again and again, as long as one stands in two: `a/d` among them, so that a quotient that exists is multiplied
//! further rather than its divisor squared.

use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// Pairs of factors that are looked at; of more, only equal products are shared.
const MOST_PAIRS: usize = 500_000;

/// A factor: its number, and whether it divides.
pub(super) type Factor = (usize, bool);

/// How a new factor is made of two others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Made {
    Product(usize, usize),
    /// The first over the second.
    Quotient(usize, usize),
    /// One over the factor.
    Reciprocal(usize),
}

/// Products in terms of new factors, which have the numbers after the given ones.
pub(super) struct Shared {
    /// How each new factor is made.
    pub(super) made: Vec<Made>,
    /// The factor that each product is.
    pub(super) products: Vec<usize>,
}

type Pair = (Factor, Factor);

/// Writes products, none of which is empty, of factors `0..n_factors`.
pub(super) fn shared(n_factors: usize, products: &[Vec<Factor>]) -> Shared {
    let mut sharing = Sharing {
        n_factors,
        products: products.to_vec(),
        places: BTreeMap::new(),
        heap: BinaryHeap::new(),
        made: vec![],
        known: BTreeMap::new(),
    };
    let n_pairs: usize = products.iter().map(|factors| factors.len() * factors.len() / 2).sum();
    for k in 0..products.len() {
        sharing.products[k].sort_unstable();
        if n_pairs <= MOST_PAIRS {
            sharing.enter(k);
        }
    }
    while let Some((count, std::cmp::Reverse(pair))) = sharing.heap.pop() {
        let places = sharing.places.get(&pair).map_or(0, BTreeSet::len);
        if places == count && count > 1 {
            sharing.replace(pair);
        } else if places > 1 {
            sharing.heap.push((places, std::cmp::Reverse(pair)));
        }
    }
    let products = (0..products.len()).map(|k| sharing.finish(k)).collect();
    Shared { made: sharing.made, products }
}

struct Sharing {
    n_factors: usize,
    products: Vec<Vec<Factor>>,
    /// The products in which a pair of factors stands.
    places: BTreeMap<Pair, BTreeSet<usize>>,
    /// Pairs by the number of their places; entries may be out of date.
    heap: BinaryHeap<(usize, std::cmp::Reverse<Pair>)>,
    made: Vec<Made>,
    known: BTreeMap<Made, usize>,
}

impl Sharing {
    fn pairs(&self, product: usize) -> BTreeSet<Pair> {
        let factors = &self.products[product];
        let mut pairs = BTreeSet::new();
        for (i, &first) in factors.iter().enumerate() {
            // a factor over itself does not occur, and two that divide are looked at only side by side
            pairs.extend(factors[i + 1..].iter().map(|&second| (first, second)));
        }
        pairs
    }

    fn enter(&mut self, product: usize) {
        for pair in self.pairs(product) {
            let places = self.places.entry(pair).or_default();
            places.insert(product);
            if places.len() > 1 {
                self.heap.push((places.len(), std::cmp::Reverse(pair)));
            }
        }
    }

    fn leave(&mut self, product: usize) {
        for pair in self.pairs(product) {
            if let Some(places) = self.places.get_mut(&pair) {
                places.remove(&product);
            }
        }
    }

    /// Makes a pair one factor wherever it stands.
    fn replace(&mut self, pair: Pair) {
        let new = self.joined(pair);
        let places: Vec<usize> = self.places.remove(&pair).into_iter().flatten().collect();
        for product in places {
            self.leave(product);
            while let Some(rest) = without(&self.products[product], pair) {
                self.products[product] = rest;
                self.products[product].push(new);
            }
            self.products[product].sort_unstable();
            self.enter(product);
        }
    }

    /// The factor that a pair is.
    fn joined(&mut self, ((a, a_divides), (b, b_divides)): Pair) -> Factor {
        match (a_divides, b_divides) {
            (false, false) => (self.make(Made::Product(a, b)), false),
            (true, true) => (self.make(Made::Product(a, b)), true),
            (false, true) => (self.make(Made::Quotient(a, b)), false),
            (true, false) => (self.make(Made::Quotient(b, a)), false),
        }
    }

    fn make(&mut self, made: Made) -> usize {
        let next = self.n_factors + self.made.len();
        let number = *self.known.entry(made).or_insert(next);
        if number == next {
            self.made.push(made);
        }
        number
    }

    /// The factor that a whole product is: what multiplies, over what divides.
    fn finish(&mut self, product: usize) -> usize {
        let factors = self.products[product].clone();
        let mut whole = |divides: bool| {
            let mut own: Vec<usize> =
                factors.iter().filter(|factor| factor.1 == divides).map(|factor| factor.0).collect();
            // two by two, so that long products are not nested as deep as they are long
            while own.len() > 1 {
                let join = |pair: &[usize]| match *pair {
                    [a, b] => self.make(Made::Product(a.min(b), a.max(b))),
                    _ => pair[0],
                };
                own = own.chunks(2).map(join).collect();
            }
            own.first().copied()
        };
        match (whole(false), whole(true)) {
            (Some(over), Some(under)) => self.make(Made::Quotient(over, under)),
            (Some(over), None) => over,
            (None, Some(under)) => self.make(Made::Reciprocal(under)),
            (None, None) => unreachable!("a product has a factor"),
        }
    }
}

/// The factors without one occurrence of a pair; `None` if it does not stand there.
fn without(factors: &[Factor], (first, second): Pair) -> Option<Vec<Factor>> {
    let mut rest = factors.to_vec();
    for factor in [second, first] {
        let place = rest.iter().rposition(|&own| own == factor)?;
        rest.remove(place);
    }
    Some(rest)
}

#[cfg(test)]
mod tests {
    use super::{Made, shared};

    #[test]
    fn what_two_products_have_in_common_is_made_once() {
        // a b c, a b d, (a b)^2 / e^2, b a / e with a .. e = 0 .. 4
        let on = |k| (k, false);
        let under = |k| (k, true);
        let products = [
            vec![on(0), on(1), on(2)],
            vec![on(0), on(1), on(3)],
            vec![on(0), on(0), on(1), on(1), under(4), under(4)],
            vec![on(0), on(1), under(4)],
        ];
        let found = shared(5, &products);
        // a b, (a b) / e, then one product more for each of the first three
        assert_eq!(found.made[..2], [Made::Product(0, 1), Made::Quotient(5, 4)]);
        assert_eq!(found.made.len(), 5);
        assert_eq!(found.products[3], 6);
        assert!(found.made.contains(&Made::Product(6, 6)));
    }

    #[test]
    fn a_reciprocal_is_one_division() {
        let found = shared(2, &[vec![(0, true)], vec![(0, true), (1, true)]]);
        assert_eq!(found.made, [Made::Reciprocal(0), Made::Product(0, 1), Made::Reciprocal(3)]);
    }
}
