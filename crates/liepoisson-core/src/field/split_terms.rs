//! Any Hamiltonian that is a sum of functions of one linear form each: every split term has a flow in closed form.

use super::{Space, check_components};
use crate::error::Error;

/// A split term `F(y)` of a Hamiltonian, with the linear form `y = xi.x`.
///
/// A bracket `{x_i, x_j} = sum_k c_ij^k x_k` makes of it `x' = F'(y) M x` with `M_ik = sum_j c_ij^k xi_j`. The form is
/// constant along its own flow, which is therefore `exp(t F'(y) M)`. Every quadratic Hamiltonian is a sum of such split terms:
/// squares of linear forms, and one linear form.
#[derive(Clone, Debug, PartialEq)]
pub struct Ridge {
    /// `xi`: component, number.
    pub form: Vec<(usize, f64)>,
    /// `M`: row, column, number; entries of the same place are added.
    pub generator: Vec<(usize, usize, f64)>,
    /// Coefficients of the polynomial `F'`, the constant one first.
    pub derivative: Vec<f64>,
}

impl Ridge {
    /// The split term with this form and `F'` for the bracket whose entries `(i, j, k, c)` mean that c is a part of `c_ij^k`.
    pub fn of_bracket(bracket: &[(usize, usize, usize, f64)], form: Vec<(usize, f64)>, derivative: Vec<f64>) -> Ridge {
        let generator = bracket
            .iter()
            .flat_map(|&(i, j, k, c)| {
                form.iter().filter(move |entry| entry.0 == j).map(move |entry| (i, k, c * entry.1))
            })
            .collect();
        Ridge { form, generator, derivative }
    }
}

/// A Hamiltonian that is a sum of [`Ridge`] functions, with a bracket that is linear in the state.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitTerms {
    pub(crate) n_components: usize,
    pub(crate) ridges: Vec<Prepared>,
}

/// A split term and what its flow has to know of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Prepared {
    pub(crate) ridge: Ridge,
    /// Largest sum of absolute values in a row of M, a bound for `|M x| / |x|` in the largest component.
    pub(crate) norm: f64,
    /// Powers of M from this one upwards are zero; none if there is no such power.
    pub(crate) nilpotent_from: Option<usize>,
}

impl SplitTerms {
    /// The sum of some split terms on a space of `n_components` dimensions. The first is the outermost in a composition.
    ///
    /// That the generators belong to one bracket is not checked.
    ///
    /// # Errors
    /// No components or too many, an index beyond them, a number that is not finite.
    pub fn new(n_components: usize, ridges: Vec<Ridge>) -> Result<SplitTerms, Error> {
        check_components(n_components)?;
        let mut prepared = Vec::with_capacity(ridges.len());
        for ridge in ridges {
            check_indices("form", n_components, ridge.form.iter().map(|entry| entry.0))?;
            check_indices("generator", n_components, ridge.generator.iter().flat_map(|entry| [entry.0, entry.1]))?;
            check_numbers("form", ridge.form.iter().map(|entry| entry.1))?;
            check_numbers("generator", ridge.generator.iter().map(|entry| entry.2))?;
            check_numbers("derivative", ridge.derivative.iter().copied())?;
            prepared.push(Prepared::new(n_components, ridge));
        }
        Ok(SplitTerms { n_components, ridges: prepared })
    }
}

impl Space for SplitTerms {
    fn n_components(&self) -> usize {
        self.n_components
    }
}

impl Prepared {
    fn new(n: usize, ridge: Ridge) -> Prepared {
        let mut sums = vec![0.0; n];
        for &(row, _, value) in &ridge.generator {
            sums[row] += value.abs();
        }
        let norm = sums.into_iter().fold(0.0, f64::max);
        let nilpotent_from = nilpotent_from(n, &ridge.generator);
        Prepared { ridge, norm, nilpotent_from }
    }
}

/// The first power of a matrix that vanishes for whatever numbers stand in the places of its entries: one more than the
/// length of the longest path through them, if they form no cycle.
///
/// Rows are passed in an order in which all that lead to one come before it; those on a cycle never have their turn.
fn nilpotent_from(n: usize, entries: &[(usize, usize, f64)]) -> Option<usize> {
    let mut entries: Vec<(usize, usize)> =
        entries.iter().filter(|entry| entry.2 != 0.0).map(|&(row, column, _)| (row, column)).collect();
    entries.sort_unstable();
    let mut awaited = vec![0_usize; n];
    entries.iter().for_each(|&(_, column)| awaited[column] += 1);
    let mut length = vec![0_usize; n];
    let mut ready: Vec<usize> = (0..n).filter(|&row| awaited[row] == 0).collect();
    let (mut passed, mut longest) = (0, 0);
    while let Some(row) = ready.pop() {
        passed += 1;
        longest = longest.max(length[row]);
        let first = entries.partition_point(|entry| entry.0 < row);
        for &(_, column) in entries[first..].iter().take_while(|entry| entry.0 == row) {
            length[column] = length[column].max(length[row] + 1);
            awaited[column] -= 1;
            if awaited[column] == 0 {
                ready.push(column);
            }
        }
    }
    (passed == n).then_some(longest + 1)
}

fn check_indices(
    name: &'static str,
    n_components: usize,
    mut indices: impl Iterator<Item = usize>,
) -> Result<(), Error> {
    match indices.find(|&index| index >= n_components) {
        Some(got) => Err(Error::ComponentIndex { name, n_components, got }),
        None => Ok(()),
    }
}

fn check_numbers(name: &'static str, mut numbers: impl Iterator<Item = f64>) -> Result<(), Error> {
    match numbers.find(|number| !number.is_finite()) {
        Some(got) => Err(Error::ParameterNotFinite { name, got }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nilpotency_is_read_off_the_places_of_the_entries() {
        assert_eq!(nilpotent_from(3, &[]), Some(1));
        assert_eq!(nilpotent_from(3, &[(0, 1, 1.0), (1, 2, -2.0)]), Some(3));
        assert_eq!(nilpotent_from(3, &[(0, 1, 1.0), (1, 0, -1.0)]), None);
        assert_eq!(nilpotent_from(3, &[(0, 1, 1.0), (1, 0, 0.0)]), Some(2));
        assert_eq!(nilpotent_from(3, &[(2, 2, 1.0)]), None);
        assert_eq!(nilpotent_from(4, &[(0, 1, 1.0), (0, 1, 1.0), (0, 3, 1.0), (3, 1, 1.0)]), Some(3));
    }

    #[test]
    fn a_large_matrix_with_a_cycle_is_looked_at_once() {
        // entry by entry and power by power this was 10^12 operations
        let n = 1_000_000;
        let ring: Vec<(usize, usize, f64)> = (0..n).map(|i| (i, (i + 1) % n, 1.0)).collect();
        assert_eq!(nilpotent_from(n, &ring), None);
        assert_eq!(nilpotent_from(n, &ring[1..]), Some(n));
    }
}
