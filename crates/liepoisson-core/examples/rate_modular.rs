//! Seconds for the polynomial first integrals of a top modulo 2^61 - 1: the null space of `D = x'.grad` on monomials.
//!
//! `cargo run --release --example rate_modular -- degree|weight <number> [low|high|lex|revlex]`: all monomials of at most a
//! degree, for I = (2, 3, 5), a = (1, 2, 3), b = (3, -1, 2), or all of a weight, for I = (2, 2, 1), a = (-1, 0, 0), b = 0;
//! columns ordered by degree, low or high first, or lexicographically.
//!
//! Low degrees first, on one core of a Xeon at 2.3 GHz: degree 5, 6, 7, 8, 9 in 0.006, 0.04, 0.2, 1, 4.4 s, weight 12, 14, 16,
//! 18 in 0.015, 0.08, 0.3, 1.3 s. High degrees first take up to eight times as long. Side by side on a busy machine: degree 5,
//! 6 and weight 12 in 0.012, 0.11, 0.023 s here, and in 9.3, 93, 20 s by FLINT's dense null space.

use liepoisson_core::ensemble::Control;
use liepoisson_core::modular::{Matrix, null_space};
use std::collections::HashMap;
use std::time::Instant;

type Monomial = [u8; 9];

const PRIME: u64 = (1 << 61) - 1;

/// The field `l' = l x omega + alpha x a + beta x b` and so on, times a number that clears the denominators of 1 / I.
fn field(inertia: [i64; 3], a: [i64; 3], b: [i64; 3]) -> Vec<Vec<(Monomial, i64)>> {
    let common: i64 = inertia.iter().product();
    let mut field = vec![HashMap::<Monomial, i64>::new(); 9];
    let mut add = |component: usize, factors: &[usize], coefficient: i64| {
        let mut monomial = [0; 9];
        factors.iter().for_each(|&factor| monomial[factor] += 1);
        *field[component].entry(monomial).or_default() += coefficient;
    };
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for (first, sign) in [((j, k), 1), ((k, j), -1)] {
            let (u, v) = first;
            for vector in [0, 3, 6] {
                add(vector + i, &[vector + u, v], sign * common / inertia[v]);
            }
            add(i, &[3 + u], sign * common * a[v]);
            add(i, &[6 + u], sign * common * b[v]);
            add(3 + i, &[6 + u], sign * common * a[v]);
        }
    }
    field.into_iter().map(|terms| terms.into_iter().filter(|term| term.1 != 0).collect()).collect()
}

/// All monomials whose weight is at most `left`, in the components from `component` on.
fn monomials(component: usize, left: usize, weights: &[usize; 9], monomial: &mut Monomial, all: &mut Vec<Monomial>) {
    if component == 9 {
        all.push(*monomial);
        return;
    }
    for power in 0..=left / weights[component] {
        monomial[component] = power as u8;
        monomials(component + 1, left - power * weights[component], weights, monomial, all);
    }
    monomial[component] = 0;
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let what = arguments.first().map_or("degree", String::as_str);
    let number: usize = arguments.get(1).map_or(6, |text| text.parse().expect("a degree or weight"));
    let order = arguments.get(2).map_or("low", String::as_str);
    let mut columns = Vec::new();
    let (weights, field) = match what {
        "degree" => ([1; 9], field([2, 3, 5], [1, 2, 3], [3, -1, 2])),
        _ => ([1, 1, 1, 2, 2, 2, 3, 3, 3], field([2, 2, 1], [-1, 0, 0], [0, 0, 0])),
    };
    monomials(0, number, &weights, &mut [0; 9], &mut columns);
    if what != "degree" {
        let weight =
            |m: &Monomial| m.iter().zip(weights).map(|(&power, weight)| usize::from(power) * weight).sum::<usize>();
        columns.retain(|monomial| weight(monomial) == number);
    }
    let degree = |m: &Monomial| m.iter().map(|&power| i64::from(power)).sum::<i64>();
    match order {
        "low" => columns.sort_by_key(|m| (degree(m), *m)),
        "high" => columns.sort_by_key(|m| (-degree(m), *m)),
        "lex" => columns.sort(),
        _ => columns.sort_by_key(|m| std::cmp::Reverse(*m)),
    }
    let mut rows: HashMap<Monomial, Vec<(u32, i64)>> = HashMap::new();
    for (column, monomial) in columns.iter().enumerate() {
        for component in (0..9).filter(|&component| monomial[component] > 0) {
            for (factor, coefficient) in &field[component] {
                let mut image: Monomial = std::array::from_fn(|i| monomial[i] + factor[i]);
                image[component] -= 1;
                let entry = (column as u32, coefficient * i64::from(monomial[component]));
                rows.entry(image).or_default().push(entry);
            }
        }
    }
    let mut rows: Vec<_> = rows.into_iter().collect();
    rows.sort();
    let (mut starts, mut indices, mut residues) = (vec![0], Vec::new(), Vec::new());
    for (_, row) in &rows {
        indices.extend(row.iter().map(|entry| entry.0));
        residues.extend(row.iter().map(|entry| entry.1.rem_euclid(PRIME as i64) as u64));
        starts.push(indices.len() as u64);
    }
    let matrix = Matrix { starts: &starts, columns: &indices, residues: &residues, n_columns: columns.len() };
    let start = Instant::now();
    let space = null_space(&matrix, PRIME, None, &Control::default(), |_| ()).expect("a matrix and a prime");
    let seconds = start.elapsed().as_secs_f64();
    let (n_entries, n_rows) = (indices.len(), rows.len());
    println!(
        "{what} {number} {order}: {n_rows} rows, {} columns, {n_entries} entries, rank {}, nullity {}, {} entries in the \
         basis, {seconds:.3} s",
        columns.len(),
        space.rank,
        space.free.len(),
        space.basis.map_or(0, |basis| basis.columns.len()),
    );
}
