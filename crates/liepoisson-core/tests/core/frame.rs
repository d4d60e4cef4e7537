//! Orthonormal frames: Q R is the matrix, Q is orthonormal, R has a positive diagonal; known answers in whole numbers.

use crate::common::*;
use liepoisson_core::analysis::frame::orthonormalise;
use liepoisson_core::lanes::Simd;
use proptest::prelude::*;

fn factors(matrix: &[f64], n_rows: usize, n_columns: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut frame, mut triangle) = (matrix.to_vec(), vec![f64::NAN; n_columns * n_columns]);
    orthonormalise(Simd::widest(), &mut frame, n_rows, n_columns, &mut triangle);
    (frame, triangle)
}

fn defects(matrix: &[f64], n_rows: usize, n_columns: usize) -> (f64, f64) {
    let (q, r) = factors(matrix, n_rows, n_columns);
    let (mut product, mut gram) = (0.0f64, 0.0f64);
    for i in 0..n_rows {
        for j in 0..n_columns {
            let sum: f64 = (0..n_columns).map(|k| q[i * n_columns + k] * r[k * n_columns + j]).sum();
            product = product.max((sum - matrix[i * n_columns + j]).abs());
        }
    }
    for j in 0..n_columns {
        assert!(r[j * n_columns + j] >= 0.0);
        assert!((0..j).all(|k| r[j * n_columns + k] == 0.0));
        for k in 0..n_columns {
            let sum: f64 = (0..n_rows).map(|i| q[i * n_columns + j] * q[i * n_columns + k]).sum();
            gram = gram.max((sum - f64::from(u8::from(j == k))).abs());
        }
    }
    (product, gram)
}

proptest! {
    /// Measured: 3e-15 and 9e-16.
    #[test]
    fn product_is_the_matrix_and_the_frame_is_orthonormal(
        n_columns in 1usize..=9,
        more in 0usize..4,
        entries in prop::collection::vec(-1.0f64..1.0, 13 * 9),
        exponent in -140i32..140,
    ) {
        let (n_rows, unit) = (n_columns + more, 10.0f64.powi(exponent));
        let matrix: Vec<f64> = entries[..n_rows * n_columns].iter().map(|x| x * unit).collect();
        let (product, gram) = defects(&matrix, n_rows, n_columns);
        prop_assert!(product <= 1e-14 * unit && gram <= 1e-14, "{product:e} {gram:e}");
    }
}

proptest! {
    #[test]
    fn bits_do_not_depend_on_the_width_of_registers(
        n_columns in 1usize..=20,
        more in 0usize..4,
        entries in prop::collection::vec(prop_oneof![Just(0.0), -1.0f64..1.0], 23 * 20),
    ) {
        let n_rows = n_columns + more;
        let results = everywhere(|simd, _| {
            let (mut frame, mut triangle) = (entries[..n_rows * n_columns].to_vec(), vec![f64::NAN; n_columns * n_columns]);
            orthonormalise(simd, &mut frame, n_rows, n_columns, &mut triangle);
            (bits(&frame), bits(&triangle))
        });
        for other in &results[1..] {
            prop_assert_eq!(&results[0], other);
        }
    }
}

/// (3, 4) has length 5; what is left of (1, 7) is (-3, 4)/5 times 5, as (1, 7).(3, 4)/5 = 31/5 and 50 - (31/5)^2 = (17/5)^2.
#[test]
fn known_factors_of_a_matrix_of_order_two() {
    let (q, r) = factors(&[3.0, 1.0, 4.0, 7.0], 2, 2);
    for (found, wanted) in q.iter().zip([0.6, -0.8, 0.8, 0.6]).chain(r.iter().zip([5.0, 6.2, 0.0, 3.4])) {
        assert!((found - wanted).abs() < 1e-15, "{found} {wanted}");
    }
}

/// Equal and vanishing columns leave nothing, and the frame is orthonormal all the same.
#[test]
fn dependent_columns_have_no_length_left() {
    let matrix = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let (product, gram) = defects(&matrix, 3, 3);
    assert!(product < 1e-15 && gram < 1e-15);
    let (_, r) = factors(&matrix, 3, 3);
    assert_eq!([r[4], r[8]], [0.0, 0.0]);
}

/// The largest doubles do not overflow.
#[test]
fn large_columns_are_scaled() {
    let (_, r) = factors(&[1e300, 0.0, 1e300, 1.0], 2, 2);
    assert!((r[0] / 1e300 - 2.0f64.sqrt()).abs() < 1e-15);
}
