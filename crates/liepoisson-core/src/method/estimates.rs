//! Logarithms and powers that choose steps: a few digits, no branch, the same bits everywhere.

/// 2^52: added to a whole number below it, it leaves that number in the lowest bits.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// `log2 x` of a positive number to 2e-5, without a branch; of zero a number below -1000, of infinity one above 1000.
#[inline(always)]
pub(super) fn log2_estimate(x: f64) -> f64 {
    const TWO_OVER_LN_2: f64 = 2.0 / std::f64::consts::LN_2;
    let bits = x.to_bits();
    let exponent = f64::from_bits((bits >> 52) | WHOLE.to_bits()) - (WHOLE + 1023.0);
    let mantissa = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    // artanh series in s = (m - 1)/(m + 1), which is at most 1/3
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    exponent + TWO_OVER_LN_2 * s * (1.0 + s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0))))
}

/// `2^y` to 2e-5, for `y` clipped to [-1000, 1000]; NaN for NaN.
#[inline(always)]
pub(super) fn exp2_estimate(y: f64) -> f64 {
    let y = y.clamp(-1000.0, 1000.0) + 1000.0;
    let whole = y.floor();
    let z = (y - whole) * std::f64::consts::LN_2;
    let fraction =
        1.0 + z * (1.0 + z * (1.0 / 2.0 + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z / 720.0)))));
    fraction * f64::from_bits((whole + (WHOLE + 23.0)).to_bits() << 52)
}

/// 2^23, as [`WHOLE`] in single precision.
const WHOLE_SINGLE: f32 = 8_388_608.0;

/// [`log2_estimate`] in single precision, to 2e-5; of what is smaller than a normal number the logarithm of one or a little less.
#[inline(always)]
pub(super) fn log2_estimate_single(x: f32) -> f32 {
    const TWO_OVER_LN_2: f32 = 2.0 / std::f32::consts::LN_2;
    let bits = x.to_bits();
    let exponent = f32::from_bits((bits >> 23) | WHOLE_SINGLE.to_bits()) - (WHOLE_SINGLE + 127.0);
    let mantissa = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000);
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    exponent + TWO_OVER_LN_2 * s * (1.0 + s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0))))
}

/// [`exp2_estimate`] in single precision, to 2e-5, for `y` clipped to [-60, 60].
#[inline(always)]
pub(super) fn exp2_estimate_single(y: f32) -> f32 {
    let y = y.clamp(-60.0, 60.0) + 60.0;
    let whole = y.floor();
    let z = (y - whole) * std::f32::consts::LN_2;
    let fraction =
        1.0 + z * (1.0 + z * (1.0 / 2.0 + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z * (1.0 / 720.0))))));
    fraction * f32::from_bits((whole + (WHOLE_SINGLE + 67.0)).to_bits() << 23)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn estimates_of_logarithm_and_power_are_good_to_2e_5(y in -900.0..900.0_f64) {
            let x = libm::exp2(y);
            prop_assert!((log2_estimate(x) - y).abs() < 2e-5, "{} {}", log2_estimate(x), y);
            prop_assert!((exp2_estimate(y) / x - 1.0).abs() < 2e-5, "{} {}", exp2_estimate(y), x);
        }
    }

    proptest! {
        #[test]
        fn estimates_in_single_precision_are_good_to_2e_5(y in -59.0..59.0_f32) {
            let x = libm::exp2f(y);
            prop_assert!((log2_estimate_single(x) - y).abs() < 2e-5, "{} {}", log2_estimate_single(x), y);
            prop_assert!((exp2_estimate_single(y) / x - 1.0).abs() < 2e-5, "{} {}", exp2_estimate_single(y), x);
        }
    }

    #[test]
    fn estimates_stay_finite_at_the_ends() {
        assert!((-127.5..-125.0).contains(&log2_estimate_single(1e-40)) && log2_estimate_single(f32::INFINITY) > 127.0);
        assert!(exp2_estimate_single(1e9).is_finite() && exp2_estimate_single(-1e9) > 0.0);
        assert!(exp2_estimate_single(f32::NAN).is_nan());
        assert!(log2_estimate(0.0) < -1000.0);
        assert!(log2_estimate(f64::INFINITY) > 1000.0);
        assert!(exp2_estimate(1e9).is_finite() && exp2_estimate(-1e9) > 0.0);
    }
}
