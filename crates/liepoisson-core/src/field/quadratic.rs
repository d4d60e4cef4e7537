//! Any quadratic field, a sparse tensor given at run time, near the speed of a kernel compiled for it.

use super::convolution::{Kernel, MOST_PRODUCTS, Series, Sums, Tile};
use super::cover::cover;
use super::{
    Bounds, Field, Instantiate, Majorant, SinglePrecision, Space, Terms, check_components, needs_remainder, over,
};
use crate::error::Error;
use crate::lanes::{Lane, Simd};

/// A field whose components are polynomials of degree two:
/// ```text
/// x_i' = constant_i + sum_j linear_ij x_j + sum_jk quadratic_ijk x_j x_k
/// ```
/// Of all pairs `j, k` the *distinct* products `x_j x_k` are expanded, once each, in tiles that share factors; their
/// coefficients enter once per order. The work of order `k` is one multiply-add for every distinct product and each of the
/// `k + 1` terms of its sum, two more for every tangent vector, and one for every nonzero entry of the tensor.
#[derive(Clone, Debug)]
pub struct Quadratic {
    n_components: usize,
    /// Odd, so that the rows of one component do not meet in one set of the cache.
    group: usize,
    constant: Vec<(usize, f64)>,
    linear: Vec<Term>,
    tiles: Vec<PlacedTile>,
    /// Where the products of the tiles enter.
    terms: Vec<Term>,
    majorant: Majorant,
    #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
    compiled: std::sync::Arc<super::tape::compiled::Compiled>,
}

/// `x_target' += coefficient * source`; the source is a component, or the number of a product in its tile.
#[derive(Clone, Copy, Debug)]
struct Term {
    target: usize,
    source: usize,
    coefficient: f64,
    /// Its number among all coefficients.
    number: usize,
}

/// Where coefficients come from: the same in all lanes, or lane by lane.
pub(super) trait Coefficients: Copy {
    /// `scale coefficient`, given that of the field that all share, and its number.
    fn scaled<V: Lane>(self, coefficient: f64, number: usize, scale: f64) -> V;
}

/// Those of the field itself.
#[derive(Clone, Copy)]
struct Shared;

impl Coefficients for Shared {
    #[inline(always)]
    fn scaled<V: Lane>(self, coefficient: f64, _number: usize, scale: f64) -> V {
        V::splat(coefficient * scale)
    }
}

/// A tile and its terms: from `first` on one for each product, then those of products that enter several components.
#[derive(Clone, Debug)]
struct PlacedTile {
    tile: Tile,
    first: usize,
    end: usize,
}

impl Quadratic {
    /// The field with these nonzero entries, given as `(i, constant_i)`, `(i, j, linear_ij)`, `(i, j, k, quadratic_ijk)`.
    ///
    /// Entries with the same indices add up, and `x_j x_k` is the same product as `x_k x_j`; what adds up to zero is left out.
    ///
    /// # Errors
    /// No components or too many, an index that is none of a component, an entry that is not finite.
    pub fn new(
        n_components: usize,
        constant: &[(usize, f64)],
        linear: &[(usize, usize, f64)],
        quadratic: &[(usize, usize, usize, f64)],
    ) -> Result<Quadratic, Error> {
        check_components(n_components)?;
        let constant = collect("constant", n_components, constant.iter().map(|&(i, c)| ([i], c)))?;
        let linear = collect("linear", n_components, linear.iter().map(|&(i, j, c)| ([i, j], c)))?;
        let by_product = |&(i, j, k, c): &(usize, usize, usize, f64)| ([j.min(k), j.max(k), i], c);
        let quadratic = collect("quadratic", n_components, quadratic.iter().map(by_product))?;
        let mut products: Vec<[usize; 2]> = quadratic.iter().map(|&([j, k, _], _)| [j, k]).collect();
        products.dedup();

        let rows = |entries: &mut dyn Iterator<Item = (usize, f64)>| {
            let mut sums = vec![0.0; n_components];
            entries.for_each(|(i, c)| sums[i] += c.abs());
            sums.into_iter().fold(0.0, f64::max)
        };
        let majorant = Majorant {
            linear: rows(&mut linear.iter().map(|&([i, _], c)| (i, c))),
            quadratic: rows(&mut quadratic.iter().map(|&([_, _, i], c)| (i, c))),
        };
        let mut terms = Vec::new();
        let tiles = cover(n_components, &products)
            .into_iter()
            .map(|tile| {
                let first = terms.len();
                let mut further = Vec::new();
                for (source, [j, k]) in tile.products().into_iter().enumerate() {
                    let product = [j.min(k), j.max(k)];
                    let at = quadratic.partition_point(|&([j, k, _], _)| [j, k] < product);
                    let entries = quadratic[at..].iter().take_while(|&&([j, k, _], _)| [j, k] == product);
                    let mut entries =
                        entries.map(|&([_, _, target], coefficient)| Term { target, source, coefficient, number: 0 });
                    terms.extend(entries.next());
                    further.extend(entries);
                }
                terms.append(&mut further);
                PlacedTile { tile, first, end: terms.len() }
            })
            .collect();
        let linear = linear.iter().map(|&([i, j], c)| Term { target: i, source: j, coefficient: c, number: 0 });
        let mut linear: Vec<Term> = linear.collect();
        for (number, term) in (constant.len()..).zip(linear.iter_mut().chain(&mut terms)) {
            term.number = number;
        }
        Ok(Quadratic {
            n_components,
            group: n_components | 1,
            constant: constant.iter().map(|&([i], c)| (i, c)).collect(),
            linear,
            tiles,
            terms,
            majorant,
            #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
            compiled: std::sync::Arc::default(),
        })
    }

    /// What runs have been computed with so far, given the instruction set: its name, or that of code compiled for it.
    pub fn kernel(&self, simd: Simd) -> &'static str {
        #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
        return self.compiled.kernel(simd);
        #[cfg(not(all(target_arch = "x86_64", target_os = "linux")))]
        simd.name()
    }
}

#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
impl super::tape::compiled::Expanded for Quadratic {
    /// Products, and where they enter.
    fn work(&self) -> usize {
        let products: usize = self.tiles.iter().map(|placed| placed.tile.products().len()).sum();
        products + self.linear.len() + self.terms.len()
    }

    fn n_kept(&self, n_tangents: usize, order: usize) -> usize {
        self.row(n_tangents) * (order + 1)
    }
}

/// Entries in the order of their indices, those with the same indices added up, without zeros.
fn collect<const D: usize>(
    name: &'static str,
    n_components: usize,
    entries: impl Iterator<Item = ([usize; D], f64)>,
) -> Result<Vec<([usize; D], f64)>, Error> {
    let mut sorted = entries.collect::<Vec<_>>();
    sorted.sort_by_key(|&(indices, _)| indices);
    let mut sums: Vec<([usize; D], f64)> = Vec::with_capacity(sorted.len());
    for (indices, value) in sorted {
        if let Some(&got) = indices.iter().find(|&&i| i >= n_components) {
            return Err(Error::ComponentIndex { name, n_components, got });
        }
        match sums.last_mut() {
            Some((last, sum)) if *last == indices => *sum += value,
            _ => sums.push((indices, value)),
        }
    }
    if let Some(&(_, got)) = sums.iter().find(|(_, sum)| !sum.is_finite()) {
        return Err(Error::ParameterNotFinite { name, got });
    }
    sums.retain(|&(_, sum)| sum != 0.0);
    Ok(sums)
}

impl Space for Quadratic {
    fn n_components(&self) -> usize {
        self.n_components
    }
}

impl Bounds for Quadratic {
    fn majorant(&self) -> Option<Majorant> {
        Some(self.majorant)
    }

    fn terms(&self, state: &[f64], rest: &[f64], to: &mut Terms) {
        to.clear(self.n_components);
        let size = |k: usize| state[k].abs() + rest[k];
        for term in &self.linear {
            to.linear[term.target] += term.coefficient.abs() * size(term.source);
        }
        for placed in &self.tiles {
            let terms = &self.terms[placed.first..placed.end];
            let products = placed.tile.products();
            for term in terms {
                let [j, k] = products[term.source];
                to.quadratic[term.target] += term.coefficient.abs() * size(j) * size(k);
            }
        }
    }
}

impl SinglePrecision for Quadratic {}

impl Instantiate for Quadratic {
    type Instance<'f> = &'f Quadratic;

    fn instantiate(&self) -> &Quadratic {
        self
    }
}

impl Field for Quadratic {
    fn group(&self) -> usize {
        self.group
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, _rows: &mut [V], _n_tangents: usize, _k: usize) {}

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        self.extend_with(Shared, rows, n_tangents, k);
    }

    #[inline(always)]
    fn expand<V: Lane>(&self, rows: &mut [V], n_tangents: usize, order: usize) {
        #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
        if self.compiled.expand(self, rows, n_tangents, order) {
            return;
        }
        for k in 0..order {
            self.extend(rows, n_tangents, k);
        }
    }

    const IS_COMPILED: bool = cfg!(all(target_arch = "x86_64", target_os = "linux"));

    #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
    #[inline(always)]
    fn run_compiled<V: Lane>(&self, code: &impl super::Straight, memory: &mut [V]) -> bool {
        self.compiled.run(self, code, memory)
    }
}

impl Quadratic {
    /// Distinct products, and nonzero entries of degree one and two.
    pub(crate) fn counts(&self) -> [f64; 2] {
        let products: usize = self.tiles.iter().map(|placed| placed.tile.products().len()).sum();
        [products, self.linear.len() + self.terms.len()].map(|count| count as f64)
    }

    /// Whether two fields differ in their coefficients only.
    pub(super) fn has_the_terms_of(&self, other: &Quadratic) -> bool {
        let indices = |field: &Quadratic| {
            let constant: Vec<usize> = field.constant.iter().map(|&(i, _)| i).collect();
            let terms = field.linear.iter().chain(&field.terms).map(|term| (term.target, term.source));
            let products: Vec<_> = field.tiles.iter().flat_map(|placed| placed.tile.products()).collect();
            (field.n_components, constant, terms.collect::<Vec<_>>(), products)
        };
        indices(self) == indices(other)
    }

    /// All coefficients, by their numbers.
    pub(super) fn coefficients(&self) -> impl Iterator<Item = f64> {
        let terms = self.linear.iter().chain(&self.terms).map(|term| term.coefficient);
        self.constant.iter().map(|&(_, value)| value).chain(terms)
    }

    /// [`Field::extend`] with coefficients from somewhere.
    #[inline(always)]
    pub(super) fn extend_with<C: Coefficients, V: Lane>(
        &self,
        coefficients: C,
        rows: &mut [V],
        n_tangents: usize,
        k: usize,
    ) {
        let row = self.row(n_tangents);
        let (known, next) = rows.split_at_mut((k + 1) * row);
        let next = &mut next[..row];
        let scale = if needs_remainder(k + 1) { 1.0 } else { 1.0 / (k + 1) as f64 };
        self.begin(coefficients, &known[k * row..], next, n_tangents, k, scale);
        let series = Series::new(known, row, self.group, k);
        for placed in &self.tiles {
            let terms = &self.terms[placed.first..placed.end];
            placed.tile.run(AddProducts { coefficients, series, terms, next, group: self.group, n_tangents, scale });
        }
        if needs_remainder(k + 1) {
            for value in next {
                *value = over(*value, k + 1);
            }
        }
    }

    /// The constant and linear parts.
    #[inline(always)]
    fn begin<C: Coefficients, V: Lane>(
        &self,
        coefficients: C,
        last: &[V],
        next: &mut [V],
        n_tangents: usize,
        k: usize,
        scale: f64,
    ) {
        for value in next.iter_mut() {
            *value = V::splat(0.0);
        }
        if k == 0 {
            for (number, &(i, value)) in self.constant.iter().enumerate() {
                next[i] = coefficients.scaled(value, number, 1.0);
            }
        }
        for term in &self.linear {
            let factor: V = coefficients.scaled(term.coefficient, term.number, scale);
            for g in 0..=n_tangents {
                let to = &mut next[g * self.group + term.target];
                *to = last[g * self.group + term.source].mul_add(factor, *to);
            }
        }
    }
}

/// Adds the products of one tile to the next row.
struct AddProducts<'r, C, V> {
    coefficients: C,
    series: Series<'r, V>,
    terms: &'r [Term],
    next: &'r mut [V],
    group: usize,
    n_tangents: usize,
    scale: f64,
}

impl<C: Coefficients, V: Lane> Kernel for AddProducts<'_, C, V> {
    #[inline(always)]
    fn run<const Q: usize, const S: usize, const A: usize>(mut self, tile: &Tile) {
        // Two sums for every product, and the factors at hand, in registers; the sums are the same, term by term, so a
        // trajectory has the same bits either way.
        // Where code is recorded, what is compiled has as many loops as its registers want.
        let is_narrow = !V::IS_RECORDED && 2 * (Q * S + A) + 2 * Q + 2 > V::REGISTERS;
        let fused = self.n_tangents > 0 && !is_narrow;
        if fused {
            let sums = self.series.of_both::<Q, S, A>(tile);
            self.add(0, &sums);
        } else {
            self.add(0, &[self.series.of_state::<Q, S, A>(tile)]);
        }
        for t in 1 + usize::from(fused)..=self.n_tangents {
            self.add(t, &[self.series.of_tangent::<Q, S, A>(tile, t)]);
        }
    }
}

impl<C: Coefficients, V: Lane> AddProducts<'_, C, V> {
    /// Adds sums of `G` groups, from number `group` on.
    #[inline(always)]
    fn add<const G: usize, const Q: usize, const S: usize, const A: usize>(
        &mut self,
        group: usize,
        sums: &[Sums<V, Q, S, A>; G],
    ) {
        let mut next =
            Next::<C, V, G>::new(&mut self.next[group * self.group..], self.group, (self.coefficients, self.scale));
        let (leading, further) = self.terms.split_at(Q * S + A);
        for p in 0..S {
            for q in 0..Q {
                let mut product = [V::splat(0.0); G];
                for g in 0..G {
                    product[g] = sums[g].shared[p][q];
                }
                next.add(product, &leading[p * Q + q]);
            }
        }
        for p in 0..A {
            let mut product = [V::splat(0.0); G];
            for g in 0..G {
                product[g] = sums[g].single[p];
            }
            next.add(product, &leading[S * Q + p]);
        }
        if !further.is_empty() {
            let mut products = [[V::splat(0.0); G]; MOST_PRODUCTS];
            for g in 0..G {
                let sums = sums[g].in_order();
                for m in 0..Q * S + A {
                    products[m][g] = sums[m];
                }
            }
            for term in further {
                next.add(products[term.source], term);
            }
        }
    }
}

/// `G` groups of the next row.
struct Next<'r, C, V, const G: usize> {
    coefficients: C,
    groups: [&'r mut [V]; G],
    scale: f64,
}

impl<'r, C: Coefficients, V: Lane, const G: usize> Next<'r, C, V, G> {
    #[inline(always)]
    fn new(mut rest: &'r mut [V], group: usize, (coefficients, scale): (C, f64)) -> Self {
        let mut groups: [&mut [V]; G] = std::array::from_fn(|_| Default::default());
        for g in 0..G {
            let (first, others) = std::mem::take(&mut rest).split_at_mut(group);
            (groups[g], rest) = (first, others);
        }
        Next { coefficients, groups, scale }
    }

    #[inline(always)]
    fn add(&mut self, product: [V; G], term: &Term) {
        let factor: V = self.coefficients.scaled(term.coefficient, term.number, self.scale);
        for g in 0..G {
            let to = &mut self.groups[g][term.target];
            *to = product[g].mul_add(factor, *to);
        }
    }
}
