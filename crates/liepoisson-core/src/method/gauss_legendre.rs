//! Coefficients of the Gauss collocation methods with one to four stages.
//!
//! With the zeros `c_i` of the Legendre polynomial of degree `s`, moved to `[0, 1]`, and Lagrange's polynomials `l_j` of these
//! nodes: `a_ij` is the integral of `l_j` from 0 to `c_i`, `b_j` that from 0 to 1. Computed to 60 digits.
//!
//! # References
//! Hairer, Lubich and Wanner, *Geometric Numerical Integration*, 2nd ed. (2006), sections II.1.3 and IV.2.1.
#![allow(clippy::excessive_precision)]

use super::variational::Term;

/// One of the methods.
#[derive(Debug)]
pub(super) struct Collocation {
    /// `a_ij`, row by row.
    pub(super) stages: &'static [&'static [Term]],
    /// `b_j`; where a double does not hold it, first what it leaves out: the same rounding error in each step would add up.
    pub(super) weights: &'static [Term],
    /// `l_j(1 + c_i)`: the rates of one step, continued, are the first guess of those of the next.
    pub(super) continuation: &'static [&'static [Term]],
}

/// With 1, 2, 3 and 4 stages.
pub(super) const COLLOCATIONS: [Collocation; 4] = [
    Collocation { stages: &[&[(0, 0.5)]], weights: &[(0, 1.0)], continuation: &[&[(0, 1.0)]] },
    Collocation {
        stages: &[&[(0, 0.25), (1, -0.038675134594812882255)], &[(0, 0.53867513459481288225), (1, 0.25)]],
        weights: &[(0, 0.5), (1, 0.5)],
        continuation: &[
            &[(0, -0.73205080756887729353), (1, 1.7320508075688772935)],
            &[(0, -1.7320508075688772935), (1, 2.7320508075688772935)],
        ],
    },
    Collocation {
        stages: &[
            &[(0, 0.13888888888888888889), (1, -0.035976667524938903456), (2, 0.0097894440153083260496)],
            &[(0, 0.30026319498086459244), (1, 0.22222222222222222222), (2, -0.02248541720308681466)],
            &[(0, 0.26798833376246945173), (1, 0.4804211119693833479), (2, 0.13888888888888888889)],
        ],
        weights: &[
            (0, -1.23358e-17),
            (1, 2.46716e-17),
            (2, -1.23358e-17),
            (0, 0.27777777777777777778),
            (1, 0.44444444444444444444),
            (2, 0.27777777777777777778),
        ],
        continuation: &[
            &[(0, 0.46034998712591644815), (1, -1.5026888717234441531), (2, 2.0423388845975277049)],
            &[(0, 2.0423388845975277049), (1, -5.6666666666666666667), (2, 4.6243277820691389617)],
            &[(0, 4.6243277820691389617), (1, -11.83064446160988918), (2, 8.2063166795407502185)],
        ],
    },
    Collocation {
        stages: &[
            &[
                (0, 0.086963711284363464343),
                (1, -0.026604180084998793313),
                (2, 0.012627462689404724515),
                (3, -0.0035551496857956831569),
            ],
            &[
                (0, 0.18811811749986807165),
                (1, 0.16303628871563653566),
                (2, -0.027880428602470895224),
                (3, 0.0067355005945381555154),
            ],
            &[
                (0, 0.16719192197418877317),
                (1, 0.35395300603374396654),
                (2, 0.16303628871563653566),
                (3, -0.014190694931141142964),
            ],
            &[
                (0, 0.17748257225452261184),
                (1, 0.3134451147418683468),
                (2, 0.35267675751627186463),
                (3, 0.086963711284363464343),
            ],
        ],
        weights: &[
            (0, 3.83017e-18),
            (1, 2.39254e-17),
            (2, 2.39254e-17),
            (3, 3.83017e-18),
            (0, 0.17392742256872692869),
            (1, 0.32607257743127307131),
            (2, 0.32607257743127307131),
            (3, 0.17392742256872692869),
        ],
        continuation: &[
            &[
                (0, -0.30434753228963353155),
                (1, 1.0425440204501055979),
                (2, -1.9298963902970090161),
                (3, 2.1916999021365369498),
            ],
            &[
                (0, -1.9563426110812630434),
                (1, 6.2464276146547676179),
                (2, -9.4640124407666893484),
                (3, 6.1739274371931847739),
            ],
            &[
                (0, -7.352359801851610409),
                (1, 22.244205449220565329),
                (2, -29.806813631562519579),
                (3, 15.914967984193564659),
            ],
            &[
                (0, -14.97189291059041293),
                (1, 44.096131818793828184),
                (2, -55.988972457400800747),
                (3, 27.864733549197385493),
            ],
        ],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Row `i` as dense numbers.
    fn dense(terms: &[Term], n: usize) -> Vec<f64> {
        (0..n).map(|j| terms.iter().filter(|term| term.0 == j).map(|term| term.1).sum()).collect()
    }

    /// `sum_j b_j c_j^(q-1) = 1/q` for `q <= 2s`, `sum_j a_ij c_j^(q-1) = c_i^q / q` for `q <= s`.
    #[test]
    fn coefficients_integrate_powers() {
        for (n, method) in (1..).zip(&COLLOCATIONS) {
            let weights = dense(method.weights, n);
            let stages: Vec<_> = method.stages.iter().map(|row| dense(row, n)).collect();
            let nodes: Vec<f64> = stages.iter().map(|row| row.iter().sum()).collect();
            let moment = |row: &[f64], q: i32| (0..n).map(|j| row[j] * nodes[j].powi(q - 1)).sum::<f64>();
            for q in 1..=2 * n as i32 {
                let error = moment(&weights, q) - 1.0 / f64::from(q);
                assert!(error.abs() < 2.0 * f64::EPSILON, "{n} stages, power {q}: {error:e}");
            }
            for (row, node) in stages.iter().zip(&nodes) {
                for q in 1..=n as i32 {
                    let error = moment(row, q) - node.powi(q) / f64::from(q);
                    assert!(error.abs() < 2.0 * f64::EPSILON, "{n} stages, power {q}: {error:e}");
                }
            }
        }
    }

    /// `b_i a_ij + b_j a_ji = b_i b_j` (Cooper's condition), to the rounding of the products, which are below 1/4.
    #[test]
    fn quadratic_invariants_are_kept() {
        for (n, method) in (1..).zip(&COLLOCATIONS) {
            let b = dense(method.weights, n);
            let a: Vec<_> = method.stages.iter().map(|row| dense(row, n)).collect();
            for i in 0..n {
                for j in 0..n {
                    let defect = b[i] * a[i][j] + b[j] * a[j][i] - b[i] * b[j];
                    assert!(defect.abs() <= f64::EPSILON / 4.0, "{n} stages, {i} {j}: {defect:e}");
                }
            }
        }
    }

    /// A polynomial of degree `s - 1` is continued exactly.
    #[test]
    fn continuation_is_exact_for_polynomials() {
        for (n, method) in (1..).zip(&COLLOCATIONS) {
            let nodes: Vec<f64> = method.stages.iter().map(|row| row.iter().map(|term| term.1).sum()).collect();
            for (i, row) in method.continuation.iter().enumerate() {
                for q in 0..n {
                    let continued: f64 = row.iter().map(|&(j, e)| e * nodes[j].powi(q)).sum();
                    let error = continued - (1.0 + nodes[i]).powi(q);
                    assert!(error.abs() < 1e-13, "{n} stages, power {q}: {error:e}");
                }
            }
        }
    }
}
