//! Poisson brackets by their terms: structure constants, or functions of the state; and brackets that have names.

use super::refusal::Refusal;
use super::scope::Coordinates;

/// Degrees of freedom, fields and coordinates at most.
const MOST: usize = 100;

const MOST_COORDINATES: usize = 10_000;

/// Coordinates of a bracket that is checked for Jacobi's identity.
const MOST_CHECKED: usize = 40;

/// A term of `{x_i, x_j}`, `i < j`.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The first coordinate.
    pub i: usize,
    /// The second coordinate.
    pub j: usize,
    /// The coordinate in the term; `None` for a constant one.
    pub m: Option<usize>,
    /// The coefficient, a formula in parameters; with `m = None` in a known bracket, in the coordinates, too.
    pub c: String,
}

/// A bracket `{x_i, x_j} = sum of c x_m + k`, where `k` may be any smooth function of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    pub(super) coordinates: Coordinates,
    pub(super) entries: Vec<Entry>,
    /// What is known of Jacobi's identity.
    pub(super) jacobi: Jacobi,
}

/// What is known of Jacobi's identity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Jacobi {
    /// It holds by construction.
    Known,
    /// It is to be checked, of structure constants and of constant parts.
    OfConstants,
    /// It is to be checked, of functions of the state.
    OfFunctions,
}

impl Bracket {
    /// A bracket by its terms.
    ///
    /// # Errors
    /// A coordinate that is not there, or a term of a pair that is not in order.
    pub fn new(coordinates: Coordinates, entries: Vec<Entry>) -> Result<Bracket, Refusal> {
        check_count(coordinates.names().len(), "coordinates", MOST_CHECKED)?;
        Ok(Bracket { jacobi: Jacobi::OfConstants, ..Bracket::known(coordinates, entries)? })
    }

    /// The same for a bracket whose Jacobi identity is known to hold.
    ///
    /// # Errors
    /// As [`Bracket::new`].
    pub fn known(coordinates: Coordinates, entries: Vec<Entry>) -> Result<Bracket, Refusal> {
        let n = coordinates.names().len();
        check_count(n, "coordinates", MOST_COORDINATES)?;
        for Entry { i, j, m, .. } in &entries {
            if i >= j || *j >= n || m.is_some_and(|m| m >= n) {
                return Err(Refusal::general(format!(
                    "the terms of a bracket must have coordinates i < j and m below {n}; got i = {i}, j = {j}{}. Count from 0.",
                    m.map_or_else(String::new, |m| format!(", m = {m}"))
                )));
            }
        }
        Ok(Bracket { coordinates, entries, jacobi: Jacobi::Known })
    }

    /// The canonical bracket `{q_i, p_j} = delta_ij` of so many degrees of freedom: vectors `q` and `p`.
    ///
    /// # Errors
    /// None, or more than 100.
    pub fn canonical(n: usize) -> Result<Bracket, Refusal> {
        check_count(n, "degrees of freedom", MOST)?;
        let components: Vec<String> = (1..=n).map(|k| k.to_string()).collect();
        let fields = ["q", "p"].map(|field| (field.to_owned(), components.clone()));
        Ok(Bracket::of_pairs(Coordinates::Vectors(fields.to_vec()), n))
    }

    /// The canonical bracket of named coordinates and momenta; `p_theta` of `theta` where none are given.
    ///
    /// # Errors
    /// No coordinate, more than 100, or not one momentum for each.
    pub fn canonical_of(names: &[String], momenta: Option<&[String]>) -> Result<Bracket, Refusal> {
        check_count(names.len(), "degrees of freedom", MOST)?;
        let own: Vec<String> = match momenta {
            Some(momenta) => momenta.to_vec(),
            None => names.iter().map(|name| format!("p_{name}")).collect(),
        };
        if own.len() != names.len() {
            return Err(Refusal::general(format!(
                "each coordinate has one momentum; got {} coordinates and {} momenta. Give one for each.",
                names.len(),
                own.len()
            )));
        }
        Ok(Bracket::of_pairs(Coordinates::Scalars([names, &own].concat()), names.len()))
    }

    fn of_pairs(coordinates: Coordinates, n: usize) -> Bracket {
        let entries = (0..n).map(|k| Entry { i: k, j: n + k, m: None, c: "1".to_owned() }).collect();
        Bracket { coordinates, entries, jacobi: Jacobi::Known }
    }

    /// The bracket of so(3) with the semidirect product of `n - 1` vectors: the rigid body, the heavy top on e(3), the charged
    /// heavy top.
    ///
    /// # Errors
    /// No field, or more than 100.
    pub fn semidirect(n: usize) -> Result<Bracket, Refusal> {
        Bracket::leibniz(n, "0")
    }

    /// The bracket of so(3) with the Leibniz extension of order `n`, `e_a e_b = epsilon e_(a+b)`: the twisted top for `n = 3`.
    ///
    /// # Errors
    /// No field, or more than 100.
    pub fn leibniz(n: usize, epsilon: &str) -> Result<Bracket, Refusal> {
        check_count(n, "fields", MOST)?;
        let components: Vec<String> = (1..=3).map(|k| k.to_string()).collect();
        let name = |k: usize| {
            if n <= 3 { ["l", "alpha", "beta"][k].to_owned() } else { format!("x{k}") }
        };
        let fields: Vec<_> = (0..n).map(|k| (name(k), components.clone())).collect();
        let mut entries = vec![];
        for a in 0..n {
            for b in (a..n).filter(|b| a + b < n) {
                let strength = if a == 0 { "1" } else { epsilon };
                if strength != "0" {
                    add_products(&mut entries, a, b, strength);
                }
            }
        }
        Ok(Bracket { coordinates: Coordinates::Vectors(fields), entries, jacobi: Jacobi::Known })
    }

    /// The minus Lie-Poisson bracket of a Lie algebra, `{x_i, x_j} = - sum of c x_k`, of constants `(i, j, k, c)` with
    /// `[e_i, e_j] = sum of c e_k`, `i < j`.
    ///
    /// # Errors
    /// As [`Bracket::new`].
    pub fn lie_poisson(
        coordinates: Coordinates,
        constants: &[(usize, usize, usize, String)],
    ) -> Result<Bracket, Refusal> {
        let entry =
            |(i, j, k, c): &(usize, usize, usize, String)| Entry { i: *i, j: *j, m: Some(*k), c: format!("-({c})") };
        Bracket::new(coordinates, constants.iter().map(entry).collect())
    }

    /// The bracket of a Poisson tensor, whose entries `{x_i, x_j}`, `i < j`, may be any smooth functions of the state.
    ///
    /// # Errors
    /// As [`Bracket::new`].
    pub fn tensor(coordinates: Coordinates, functions: &[(usize, usize, String)]) -> Result<Bracket, Refusal> {
        let entry = |(i, j, c): &(usize, usize, String)| Entry { i: *i, j: *j, m: None, c: c.clone() };
        let bracket = Bracket::new(coordinates, functions.iter().map(entry).collect())?;
        Ok(Bracket { jacobi: Jacobi::OfFunctions, ..bracket })
    }

    /// The coordinates, as formulas call them.
    pub fn coordinates(&self) -> &Coordinates {
        &self.coordinates
    }
}

/// `{x_(a,i), x_(b,j)} = - strength sum of epsilon_ijk x_(a+b,k)`, for the pairs of coordinates that are in order.
fn add_products(entries: &mut Vec<Entry>, a: usize, b: usize, strength: &str) {
    for (i, j, k, is_even) in
        [(0, 1, 2, true), (1, 2, 0, true), (2, 0, 1, true), (1, 0, 2, false), (2, 1, 0, false), (0, 2, 1, false)]
    {
        let (row, column) = (3 * a + i, 3 * b + j);
        if row < column {
            let c = if is_even { format!("-({strength})") } else { strength.to_owned() };
            entries.push(Entry { i: row, j: column, m: Some(3 * (a + b) + k), c });
        }
    }
}

fn check_count(n: usize, what: &str, most: usize) -> Result<(), Refusal> {
    if (1..=most).contains(&n) {
        return Ok(());
    }
    Err(Refusal::general(format!("the number of {what} must be from 1 to {most}; got {n}.")))
}
