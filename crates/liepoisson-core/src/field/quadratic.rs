//! Any quadratic field, a sparse tensor given at run time, near the speed of a kernel compiled for it.

use super::compiled::{Compile, Compiled};
use super::convolution::{Known, Panel, panels};
use super::{
    Bounds, Field, Instantiate, Majorant, SinglePrecision, Space, Straight, Terms, check_components, over_uniformly,
};
use crate::error::Error;
use crate::lanes::{Lane, Simd};
use std::ops::Range;

/// A field whose components are polynomials of degree two:
/// ```text
/// x_i' = constant_i + sum_j linear_ij x_j + sum_jk quadratic_ijk x_j x_k
/// ```
/// Of all pairs `j, k` the *distinct* products `x_j x_k` are expanded, once each, in panels that share a factor; their coefficients
/// enter once per order. The work of order `k` is one multiply-add for every distinct product and each of the `k + 1` terms of its
/// sum, half of them for a square, two more for every tangent vector, and one for every nonzero entry of the tensor.
#[derive(Clone, Debug)]
pub struct Quadratic {
    n_components: usize,
    panels: Vec<Panel>,
    n_products: usize,
    /// What each component's derivative is the sum of.
    outputs: Vec<Output>,
    /// The entries of degree one and two, component by component.
    terms: Vec<Term>,
    majorant: Majorant,
    compiled: Compiled,
}

/// The derivative of a component: where its terms are.
#[derive(Clone, Debug)]
struct Output {
    constant: Option<f64>,
    linear: Range<usize>,
    products: Range<usize>,
}

/// `coefficient * source`; the source is a component, or the number of a product.
#[derive(Clone, Copy, Debug)]
struct Term {
    source: usize,
    coefficient: f64,
}

/// Where coefficients come from: the same in all lanes, or lane by lane.
pub(super) trait Coefficients: Copy {
    /// A coefficient, given that of the field that all share, and its number.
    fn of<V: Lane>(self, coefficient: f64, number: usize) -> V;
}

/// Those of the field itself.
#[derive(Clone, Copy)]
struct Shared;

impl Coefficients for Shared {
    #[inline(always)]
    fn of<V: Lane>(self, coefficient: f64, _number: usize) -> V {
        V::splat(coefficient)
    }
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
        let panels = panels(n_components, &products);
        let mut numbers = vec![0; products.len()];
        for (number, [j, k]) in panels.iter().flat_map(Panel::products).enumerate() {
            let at = products.binary_search(&[j.min(k), j.max(k)]).expect("panels have the products of the field");
            numbers[at] = number;
        }
        let number_of = |product: [usize; 2]| numbers[products.binary_search(&product).expect("as above")];
        let mut of_products: Vec<(usize, Term)> = quadratic
            .iter()
            .map(|&([j, k, i], coefficient)| (i, Term { source: number_of([j, k]), coefficient }))
            .collect();
        of_products.sort_by_key(|&(target, term)| (target, term.source));
        let (mut terms, mut outputs) = (vec![], vec![]);
        let (mut constants, mut linear) = (constant.into_iter().peekable(), linear.into_iter().peekable());
        let mut of_products = of_products.into_iter().peekable();
        for i in 0..n_components {
            let constant = constants.next_if(|&([target], _)| target == i).map(|(_, value)| value);
            let first = terms.len();
            while let Some(([_, source], coefficient)) = linear.next_if(|&([target, _], _)| target == i) {
                terms.push(Term { source, coefficient });
            }
            let middle = terms.len();
            while let Some((_, term)) = of_products.next_if(|&(target, _)| target == i) {
                terms.push(term);
            }
            outputs.push(Output { constant, linear: first..middle, products: middle..terms.len() });
        }
        Ok(Quadratic {
            n_components,
            panels,
            n_products: products.len(),
            outputs,
            terms,
            majorant,
            compiled: Compiled::default(),
        })
    }

    /// What runs have been computed with so far, given the instruction set: its name, or that of code compiled for it.
    pub fn kernel(&self, simd: Simd) -> &'static str {
        self.compiled.kernel(simd)
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
        let products: Vec<f64> = self.products().map(|[j, k]| size(j) * size(k)).collect();
        for (i, output) in self.outputs.iter().enumerate() {
            for term in &self.terms[output.linear.clone()] {
                to.linear[i] += term.coefficient.abs() * size(term.source);
            }
            for term in &self.terms[output.products.clone()] {
                to.quadratic[i] += term.coefficient.abs() * products[term.source];
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
        self.n_components
    }

    fn registers(&self, n_tangents: usize, order: usize) -> usize {
        self.row(n_tangents) * (order + 1) + 2 * self.n_products * (1 + n_tangents)
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, _rows: &mut [V], _n_tangents: usize, _k: usize) {}

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        self.extend_with(Shared, rows, n_tangents, k);
    }

    #[inline(always)]
    fn expand<V: Lane>(&self, rows: &mut [V], n_tangents: usize, order: usize) {
        if self.compiled.expand(self, rows, n_tangents, order) {
            return;
        }
        for k in 0..order {
            self.extend(rows, n_tangents, k);
        }
    }

    const IS_COMPILED: bool = Compiled::IS_POSSIBLE;

    #[inline(always)]
    fn run_compiled<V: Lane>(&self, code: &impl Straight, memory: &mut [V]) -> bool {
        self.compiled.run(self.n_operations(), code, memory)
    }
}

impl Compile for Quadratic {
    fn n_operations(&self) -> usize {
        self.n_products + self.terms.len()
    }

    fn n_kept(&self, n_tangents: usize, n_orders: usize) -> usize {
        self.row(n_tangents) * n_orders
    }

    fn bases(&self, n_tangents: usize, k: usize) -> [usize; 3] {
        [0, k, k / 2].map(|order| order * self.row(n_tangents))
    }
}

impl Quadratic {
    /// Distinct products, and nonzero entries of degree one and two.
    pub(crate) fn counts(&self) -> [usize; 2] {
        [self.n_products, self.terms.len()]
    }

    /// The two factors of each product.
    fn products(&self) -> impl Iterator<Item = [usize; 2]> {
        self.panels.iter().flat_map(Panel::products)
    }

    /// Whether two fields differ in their coefficients only.
    pub(super) fn has_the_terms_of(&self, other: &Quadratic) -> bool {
        let indices = |field: &Quadratic| {
            let outputs = field.outputs.iter();
            let outputs = outputs.map(|o| (o.constant.is_some(), o.linear.clone(), o.products.clone()));
            let sources: Vec<usize> = field.terms.iter().map(|term| term.source).collect();
            (outputs.collect::<Vec<_>>(), sources, field.products().collect::<Vec<_>>())
        };
        indices(self) == indices(other)
    }

    /// All coefficients, by their numbers: those of the terms, then the constants.
    pub(super) fn coefficients(&self) -> impl Iterator<Item = f64> {
        let constants = self.outputs.iter().map(|output| output.constant.unwrap_or(0.0));
        self.terms.iter().map(|term| term.coefficient).chain(constants)
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
        let n_orders = (rows.len() - self.registers(n_tangents, 0)) / row + 1;
        let (rows, work) = rows.split_at_mut(row * n_orders);
        let (known, next) = rows.split_at_mut((k + 1) * row);
        let series = Known::new(known, (self.n_components, self.n_products), n_tangents, (k, n_orders));
        for panel in &self.panels {
            panel.extend(&series, work);
        }
        let (last, next) = (&known[k * row..], &mut next[..row]);
        let mut group = 0;
        while group <= n_tangents {
            group += match n_tangents - group {
                0 => self.write::<C, V, 1>(coefficients, last, work, (group, k), next),
                _ => self.write::<C, V, 2>(coefficients, last, work, (group, k), next),
            };
        }
    }

    /// The next coefficients of `G` groups, the first of which is given with the order; how many these are.
    #[inline(always)]
    fn write<C: Coefficients, V: Lane, const G: usize>(
        &self,
        coefficients: C,
        last: &[V],
        work: &[V],
        (group, k): (usize, usize),
        next: &mut [V],
    ) -> usize {
        let (n, n_products) = (self.n_components, self.n_products);
        let (mut components, mut products) = ([last; G], [work; G]);
        for g in 0..G {
            components[g] = &last[(group + g) * n..][..n];
            products[g] = &work[(group + g) * n_products..][..n_products];
        }
        for (i, output) in self.outputs.iter().enumerate() {
            let mut sums = [V::splat(0.0); G];
            let (mut linear, mut quadratic) = (output.linear.clone(), output.products.clone());
            if let Some(constant) = output.constant
                && k == 0
                && group == 0
            {
                sums[0] = coefficients.of(constant, self.terms.len() + i);
            } else if let Some(number) = linear.next() {
                self.multiply(coefficients, number, &components, &mut sums);
            } else if let Some(number) = quadratic.next() {
                self.multiply(coefficients, number, &products, &mut sums);
            }
            for number in linear {
                self.add(coefficients, number, &components, &mut sums);
            }
            for number in quadratic {
                self.add(coefficients, number, &products, &mut sums);
            }
            for g in 0..G {
                next[(group + g) * n + i] = over_uniformly(sums[g], k + 1);
            }
        }
        G
    }

    /// The first term of a sum.
    #[inline(always)]
    fn multiply<C: Coefficients, V: Lane, const G: usize>(
        &self,
        coefficients: C,
        number: usize,
        values: &[&[V]; G],
        sums: &mut [V; G],
    ) {
        let Term { source, coefficient } = self.terms[number];
        let coefficient: V = coefficients.of(coefficient, number);
        for g in 0..G {
            sums[g] = values[g][source].mul(coefficient);
        }
    }

    /// Another one.
    #[inline(always)]
    fn add<C: Coefficients, V: Lane, const G: usize>(
        &self,
        coefficients: C,
        number: usize,
        values: &[&[V]; G],
        sums: &mut [V; G],
    ) {
        let Term { source, coefficient } = self.terms[number];
        let coefficient: V = coefficients.of(coefficient, number);
        for g in 0..G {
            sums[g] = values[g][source].mul_add(coefficient, sums[g]);
        }
    }
}
