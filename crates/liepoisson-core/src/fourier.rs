//! Discrete Fourier transforms of a power of two samples (Cooley and Tukey 1965), with the same bits on every processor.

/// Replaces samples `x_j` by `sum_j x_j exp(-2 pi i j k / n)`.
///
/// # Panics
/// If the number of samples is no power of two.
pub fn transform(samples: &mut [[f64; 2]]) {
    let n = samples.len();
    assert!(n.is_power_of_two(), "a power of two samples");
    let turns: Vec<[f64; 2]> = (0..n / 2)
        .map(|k| {
            let (sine, cosine) = libm::sincos(-std::f64::consts::TAU * k as f64 / n as f64);
            [cosine, sine]
        })
        .collect();
    for k in 1..n {
        let reversed = k.reverse_bits() >> (usize::BITS - n.trailing_zeros());
        if k < reversed {
            samples.swap(k, reversed);
        }
    }
    let mut half = 1;
    while half < n {
        for block in samples.chunks_exact_mut(2 * half) {
            let (first, second) = block.split_at_mut(half);
            for (k, (a, b)) in first.iter_mut().zip(second).enumerate() {
                let [c, s] = turns[k * (n / (2 * half))];
                let turned = [b[0] * c - b[1] * s, b[0] * s + b[1] * c];
                *b = [a[0] - turned[0], a[1] - turned[1]];
                *a = [a[0] + turned[0], a[1] + turned[1]];
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transform_is_the_sum() {
        for n in [1_usize, 2, 8, 64] {
            let given: Vec<[f64; 2]> =
                (0..n).map(|j| [libm::sin(3.0 * j as f64 + 1.0), libm::cos((j * j) as f64)]).collect();
            let mut found = given.clone();
            transform(&mut found);
            for (k, value) in found.iter().enumerate() {
                let mut sum = [0.0; 2];
                for (j, x) in given.iter().enumerate() {
                    let (s, c) = libm::sincos(-std::f64::consts::TAU * ((j * k) % n) as f64 / n as f64);
                    sum = [sum[0] + x[0] * c - x[1] * s, sum[1] + x[0] * s + x[1] * c];
                }
                assert!((value[0] - sum[0]).abs() + (value[1] - sum[1]).abs() < 1e-13 * n as f64, "{value:?} {sum:?}");
            }
        }
    }
}
